"""Rules for facts that decide whether a position is usable: values, combinations of fields, and answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import INTERFACES, Verdict
from ..document import Path
from ..keys_of_fields import WrittenCombination, WrittenField
from ..keys_of_order_codes import WrittenAlternative
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted, suggest_word
from .flags import names_error
from .parts import (
    FieldList,
    FieldOwner,
    Groups,
    by_name,
    constant_width,
    field_lists,
    fields_by_name,
    layouts_of_interfaces,
    position_names,
    readable_names,
    value_names,
    with_groups_expanded,
)
from .shapes import MOST_RESERVED_BITS, RESERVED

#: Verdicts, the most severe first.
_WORST_FIRST = [verdict.value for verdict in Verdict]
_FLAG_WORDS = ("active", "inactive")
FieldsByName = Mapping[str, WrittenField]


def check_value_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that named values have ``makes_position``, the verdict on the position, only in frames with a position.

    There, a value that is named as an error must have one. A group of fields belongs to such a frame if a frame with a
    position uses it.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    paths_with_position = set()
    groups_with_position: set[str] = set()
    for frame in layouts_of_interfaces(spec):
        if _has_position(spec, frame, group_by_name):
            paths_with_position.add(frame.owner.path)
            groups_with_position.update(field.use for field in frame.fields)
    for field_list in field_lists(spec):
        if field_list.owner_kind is FieldOwner.GROUP:
            frame_has_position = field_list.name in groups_with_position
        else:
            frame_has_position = field_list.owner.path in paths_with_position
        for field in field_list.fields:
            _check_verdicts_of_values(field_list, field, frame_has_position=frame_has_position, report=report)


def _check_verdicts_of_values(
    field_list: FieldList, field: WrittenField, frame_has_position: bool, report: DocumentReport
) -> None:
    """Report each named value of a field that has a verdict on the position but cannot, or is an error without one.

    ``frame_has_position`` is True if the frame of the field contains the position.
    """
    for name, value in field.values.items():
        if value.makes_position:
            obstacle = _obstacle_to_verdict(field_list, field, frame_has_position)
            if obstacle:
                report.add("value-verdict", value.path_of("makes_position"), obstacle, at_key=True)
        elif frame_has_position and names_error(name, value.printed_name):
            message = (
                f"{quoted(name)} is in a frame that contains the position; set 'makes_position' to the"
                " verdict on the position while the field has this value:"
                " not_usable, usable_with_warning or usable"
            )
            report.add("makes-position-missing", value.path, message)


def _obstacle_to_verdict(field_list: FieldList, field: WrittenField, frame_has_position: bool) -> str:
    """Return the reason that no value of a field can have a verdict, and the fix. Empty if the values can have one.

    ``frame_has_position`` is True if the frame of the field contains the position.
    """
    name = quoted(field.name)
    if not frame_has_position:
        return f"{_reason_without_verdict(field_list)}; remove 'makes_position'"
    if field.name in field_list.selectors:
        return f"{name} identifies the frame, so it cannot decide the verdict on the position; use another field"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field with a verdict has the same width for all"
    return ""


def _reason_without_verdict(field_list: FieldList) -> str:
    """Return the reason that fields of a register, group or layout without a position have no verdict on a position."""
    owner = quoted(field_list.name or FieldOwner.CONTROL.value)  # Only the control data are unnamed.
    match field_list.owner_kind:
        case FieldOwner.REGISTER | FieldOwner.CONTROL:
            return f"{owner} is not a frame, so no value in it has a verdict on the position"
        case FieldOwner.GROUP:
            return f"no frame of the encoder with a position uses {owner}"
        case FieldOwner.LAYOUT:
            if field_list.is_from_encoder:
                return f"{owner} does not contain the position"
            return f"{owner} is sent by the master"


def _has_position(spec: WrittenSpec, field_list: FieldList, group_by_name: Groups) -> bool:
    """Return True for a frame that the encoder sends and that contains the position or a part of it.

    The position is a field, or a number joined from several fields.
    """
    if not field_list.is_from_encoder:
        return False
    names = {*fields_by_name(field_list, group_by_name), *field_list.joins}
    return not names.isdisjoint(position_names(spec, field_list.interface))


def check_combinations(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that combinations are in frames with a position, that their conditions exist, and that each can decide.

    A combination is a verdict on the position that applies while several fields have certain values. It never decides
    if one of these values, or a combination of some of them, already has the same verdict or a more severe one.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for frame in layouts_of_interfaces(spec):
        listed_combinations = frame.layout.combinations if frame.layout is not None else ()
        if listed_combinations and not _has_position(spec, frame, group_by_name):
            problem = f"{_reason_without_verdict(frame)}; remove 'combinations'"
            report.add("combination", frame.owner.path_of("combinations"), problem, at_key=True)
            continue
        field_by_name = fields_by_name(frame, group_by_name)
        for index, combination in enumerate(listed_combinations):
            is_valid = _has_valid_conditions(frame, field_by_name, combination, report)
            if not is_valid:
                continue  # Its conditions are reported, and there may be no verdicts to compare.
            earlier_combinations = listed_combinations[:index]
            later_combinations = listed_combinations[index + 1 :]
            verdicts_of_conditions = [
                *_verdicts_of_conditions(frame, field_by_name, combination),
                *_verdicts_of_smaller_combinations(combination, earlier_combinations, later_combinations),
            ]
            _report_if_never_deciding(combination, verdicts_of_conditions, report)


def check_report_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that decoders have a unique name for each report of a frame.

    Values with a verdict on the position and combinations of values are reported under names of their own, which must
    differ from the names of fields.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for frame in layouts_of_interfaces(spec):
        used_names = set(readable_names(frame, group_by_name))
        for path, name in _names_of_reports(frame, group_by_name):
            if name in used_names:
                problem = (
                    f"this frame already has {quoted(name)}, which is also the name of this report; rename one of them"
                )
                report.add("duplicate-name", path, problem)
            used_names.add(name)


def _names_of_reports(field_list: FieldList, group_by_name: Groups) -> Iterator[tuple[Path, str]]:
    """Yield the name under which decoders report each value with a verdict and each combination, with its path.

    The value ``low`` of the field ``battery`` is reported as ``battery_low``.
    """
    paths_of_included_groups = {field.path for field in field_list.fields if field.use}
    for field_path, field in with_groups_expanded(field_list, group_by_name):
        for name, value in field.values.items():
            if value.has("makes_position"):
                # A value in a group is reported at the use of the group.
                path = field_path if field_path in paths_of_included_groups else value.path
                yield path, f"{field.name}_{name}"
    if field_list.layout is not None:
        for combination in field_list.layout.combinations:
            yield combination.path_of("name"), combination.name


def _has_valid_conditions(
    field_list: FieldList, field_by_name: FieldsByName, combination: WrittenCombination, report: DocumentReport
) -> bool:
    """Return True if all fields and values in the conditions of a combination exist and can be combined.

    Otherwise, the problems are reported. A combination with a single condition is one, because the flag or value of the
    condition can have the verdict itself.
    """
    problems_before = len(report)
    for field_name, value in combination.when.items():
        condition_path = (*combination.path_of("when"), field_name)
        if field_name not in field_by_name:
            hint = suggest_word(field_name, field_by_name)
            problem = f"there is no field {quoted(field_name)} in this frame{hint}"
            report.add("undefined-reference", condition_path, problem, at_key=True)
            continue
        field = field_by_name[field_name]
        obstacle = _obstacle_to_combination(field_list, field_name, field)
        known_values = _values_in_conditions(field)
        if obstacle:
            report.add("combination", condition_path, obstacle, at_key=True)
        elif value not in known_values:
            problem = f"{quoted(field_name)} has no value {quoted(value)}{suggest_word(value, known_values)}"
            report.add("undefined-reference", condition_path, problem)
    are_conditions_valid = len(report) == problems_before
    if are_conditions_valid and len(combination.when) == 1:
        (field_name,) = combination.when
        is_flag = field_by_name[field_name].is_flag
        verdict_place = f"the flag {quoted(field_name)}" if is_flag else f"the value of {quoted(field_name)}"
        problem = (
            f"{quoted(combination.name)} has only one condition; write 'makes_position' at {verdict_place} instead"
        )
        report.add("combination", combination.path_of("when"), problem)
    return len(report) == problems_before


def _obstacle_to_combination(field_list: FieldList, field_name: str, field: WrittenField) -> str:
    """Return the reason that a combination of values cannot contain this field, and the fix. Empty if it can."""
    name = quoted(field_name)
    if not field.is_flag and not value_names(field):
        return f"{name} is neither a flag nor a field with 'values'; give names to its values with 'values'"
    if field.has("only"):
        return f"the manual explains {name} only for some order codes; a combination applies to all of them"
    if field_name in field_list.selectors:
        return f"{name} identifies the frame, so it has the same value in all of them; remove it"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field in a combination has the same for all"
    return ""


def _values_in_conditions(field: WrittenField) -> list[str]:
    """Return the names of the values that a condition can require of a field.

    These are ``active`` and ``inactive`` for a flag, and the named values of another field. If the key ``others`` gives
    a meaning to the numbers without a name, a narrow field also has a value such as ``reserved_5`` for each of them.
    """
    if field.is_flag:
        return list(_FLAG_WORDS)
    names = value_names(field)
    width = constant_width(field)
    if field.has("others") and width is not None and width <= MOST_RESERVED_BITS:
        listed_numbers = {value.value for value in field.values.values() if value.is_valid("value")}
        other_numbers = [number for number in range(1 << width) if number not in listed_numbers]
        names += [f"{RESERVED}_{number}" for number in other_numbers]
    return names


def _report_if_never_deciding(
    combination: WrittenCombination, verdicts_of_conditions: Iterable[tuple[str, str]], report: DocumentReport
) -> None:
    """Report a combination of values if some of its values already have the same verdict or a more severe one.

    ``verdicts_of_conditions`` contains a text that names these values, and their verdict or an empty string:
    ``("'battery' alone", "not_usable")``.
    """
    for condition_text, verdict in verdicts_of_conditions:
        if verdict and _is_at_least_as_severe(verdict, combination.makes_position):
            problem = (
                f"{quoted(combination.name)} never decides, since {condition_text} already makes the position {verdict}"
            )
            report.add("combination", combination.path_of("makes_position"), f"{problem}; remove the combination")
            return


def _is_at_least_as_severe(verdict: str, other_verdict: str) -> bool:
    """Return True if the first verdict on a position is the same as the second, or more severe."""
    return _WORST_FIRST.index(verdict) <= _WORST_FIRST.index(other_verdict)


def _verdicts_of_conditions(
    field_list: FieldList, field_by_name: FieldsByName, combination: WrittenCombination
) -> Iterator[tuple[str, str]]:
    """Yield a text that names each flag or value of a combination, with the verdict that it has by itself.

    The verdict is empty if there is none. An inactive flag has no verdict and is omitted.
    """
    for name, value_name in combination.when.items():
        field = field_by_name[name]
        condition_text = f"{quoted(name)} alone"
        if not field.is_flag:
            value = field.values.get(value_name)
            verdict_of_value = value.makes_position if value is not None else ""
            yield condition_text, verdict_of_value
        elif value_name == "active":
            default_verdict = INTERFACES[field_list.interface].flags.get(name, "")
            yield condition_text, field.makes_position or default_verdict


def _verdicts_of_smaller_combinations(
    combination: WrittenCombination,
    earlier_combinations: Sequence[WrittenCombination],
    later_combinations: Sequence[WrittenCombination],
) -> Iterator[tuple[str, str]]:
    """Yield the quoted name and the verdict of each other combination that applies whenever this one does.

    The other combinations of the frame are listed before or after this one. A later combination that is equal is
    omitted, so that only the second of two equal ones is reported.
    """
    for earlier_combination in earlier_combinations:
        if _applies_whenever(earlier_combination, combination):
            yield quoted(earlier_combination.name), earlier_combination.makes_position
    for later_combination in later_combinations:
        has_same_verdict = later_combination.makes_position == combination.makes_position
        is_equal = has_same_verdict and later_combination.when == combination.when
        if _applies_whenever(later_combination, combination) and not is_equal:
            yield quoted(later_combination.name), later_combination.makes_position


def _applies_whenever(other_combination: WrittenCombination, combination: WrittenCombination) -> bool:
    """Return True if all conditions of the first combination, at least two, are also conditions of the second."""
    conditions = other_combination.when.items()
    return len(conditions) > 1 and conditions <= combination.when.items()


def check_default_answers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a question with a default answer lists it first, and that the answers set one parameter.

    The default answer sets the parameter to 0, and each other answer to 1. At least one flag must list the parameter in
    ``makes_position_if``, with the verdict on the position that applies while the parameter is 1.
    """
    parameters_of_verdicts: set[str] = set()
    for field_list in field_lists(spec):
        for field in field_list.fields:
            parameters_of_verdicts.update(field.makes_position_if)
    for alternative in spec.alternatives:
        default_answer = alternative.default
        if not default_answer:
            continue
        first_answer, *_ = alternative.values
        default_path = alternative.path_of("default")
        if default_answer != first_answer:
            problem = f"the default {quoted(default_answer)} is not the first answer of {quoted(alternative.name)}"
            report.add("alternative-default", default_path, f"{problem}; write {quoted(first_answer)}")
            continue
        _check_numbers_of_answers(alternative, report)
        # If there are several parameters, which are already reported, only the first one is checked.
        parameter, *_ = alternative.values[first_answer].sets
        if parameter not in parameters_of_verdicts:
            problem = f"no flag has {quoted(parameter)} in 'makes_position_if', so the answer changes nothing"
            report.add("alternative-default", default_path, f"{problem}; add it to a flag, or remove 'default'")


def _check_numbers_of_answers(alternative: WrittenAlternative, report: DocumentReport) -> None:
    """Check that the answers to a question set one parameter: the first answer to 0, and all other answers to 1.

    The first answer is the default.
    """
    for index, (answer_name, answer) in enumerate(alternative.values.items()):
        is_default = index == 0
        sets_path = answer.path_of("sets")
        if len(answer.sets) > 1:
            problem = f"{quoted(alternative.name)} has a default, so its answers set one parameter"
            report.add("alternative-default", sets_path, f"{problem}; keep one, or remove 'default'")
            return
        expected_value = 0 if is_default else 1
        for parameter_name, value in answer.sets.items():
            if value != expected_value:
                setting = f"{quoted(answer_name)} sets {quoted(parameter_name)} to {value}"
                message = f"{setting}; the default answer must set it to 0"
                message += f" and every other answer to 1, so write {expected_value}"
                report.add("alternative-default", (*sets_path, parameter_name), message)


def check_verdicts_by_answer(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check ``makes_position_if`` of flags, which gives another verdict for an answer of the user.

    The answer is named by its parameter, which must belong to a question with a default answer. The verdict must differ
    from ``makes_position``, the verdict for the default answer.
    """
    alternative_by_name = by_name(spec.with_invalid_parts.alternatives)
    alternatives_with_default = {
        name for name, alternative in alternative_by_name.items() if alternative.has("default")
    }
    for field_list in field_lists(spec):
        for field in field_list.fields:
            for name, verdict in field.makes_position_if.items():
                verdict_path = (*field.path_of("makes_position_if"), name)
                parameter = spec.with_invalid_parts.parameters.get(name)
                if parameter is None or parameter.alternative not in alternatives_with_default:
                    reason = f"{quoted(name)} does not belong to an alternative with a default"
                    message = f"{reason}; set its 'alternative' to the name of one that has a default"
                    report.add("verdict-choice", verdict_path, message)
                    continue
                obstacle = _obstacle_to_other_verdict(field_list, field, verdict)
                if obstacle:
                    report.add("verdict-choice", verdict_path, obstacle)


def _obstacle_to_other_verdict(field_list: FieldList, field: WrittenField, other_verdict: str) -> str:
    """Return the reason that a flag cannot have another verdict for an answer of the user, and the fix.

    The result is empty if it can: if it is in a frame and has a different verdict that decoders report.
    """
    name = quoted(field.name)
    if field_list.owner_kind in (FieldOwner.REGISTER, FieldOwner.CONTROL):
        return f"{name} is not in a frame, so it has no verdict on a position; remove 'makes_position_if'"
    interface = INTERFACES.get(field_list.interface)
    verdict_of_interface = interface.flags.get(field.name, "") if interface is not None else ""
    verdict = field.makes_position or verdict_of_interface
    if verdict not in ("not_usable", "usable_with_warning"):
        verdict_text = f"{quoted(verdict)}, which is not reported" if verdict else "no verdict"
        remedy = "write 'makes_position: not_usable' or usable_with_warning"
        return f"without a choice, {name} has {verdict_text}; {remedy}"
    if verdict == other_verdict:
        return f"with both answers, {name} makes the position {quoted(verdict)}; give one of them another verdict"
    return ""


def check_equal_answers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the two answers to a question that the manual leaves open do not set the same numbers.

    Such answers would have the same effect. Questions with more answers are not checked.
    """
    for alternative in spec.alternatives:
        answers = list(alternative.values.items())
        if len(answers) != 2:
            continue
        (first_name, first_answer), (second_name, second_answer) = answers
        if first_answer.sets and first_answer.sets == second_answer.sets:
            answer_names = f"{quoted(first_name)} and {quoted(second_name)}"
            message = f"{answer_names} set the same numbers; correct one of the two answers"
            report.add("same-answers", second_answer.path_of("sets"), message)
