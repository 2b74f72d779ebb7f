"""Rules for facts that decide whether a position is usable: values, combinations of fields, and alternatives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import INTERFACES, Verdict
from ..document import Path
from ..problems import DocumentReport, quoted, suggest_word
from ..written_codes import WrittenAlternative
from ..written_layouts import WrittenCombination, WrittenField
from ..written_parts import WrittenSpec
from .bits import names_error
from .parts import (
    FieldList,
    FieldOwner,
    Groups,
    by_name,
    constant_width,
    field_lists,
    field_names,
    layouts_of_interfaces,
    position_names,
    readable_names,
    value_names,
    with_groups_expanded,
)
from .shapes import MOST_RESERVED_BITS, RESERVED

#: Verdicts, worst first.
_WORST_FIRST = [verdict.value for verdict in Verdict]
_FLAG_WORDS = ("active", "inactive")
Fields = Mapping[str, WrittenField]


def check_value_verdicts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a value has a verdict only where a frame with a position has it, and that an error has one there.

    A group is in such a frame if one of them uses it. An error is a value named as an error.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    position_frames = [
        field_list for field_list in layouts_of_interfaces(spec) if _has_position(spec, field_list, groups)
    ]
    position_paths = {field_list.owner.path for field_list in position_frames}
    used_groups = {field.use for field_list in position_frames for field in field_list.fields}
    for field_list in field_lists(spec):
        is_group = field_list.kind is FieldOwner.GROUP
        has_verdict = field_list.name in used_groups if is_group else field_list.owner.path in position_paths
        for field in field_list.fields:
            _check_verdicts_of_values(field_list, field, has_verdict, report)


def _check_verdicts_of_values(
    fields: FieldList, field: WrittenField, has_verdict: bool, report: DocumentReport
) -> None:
    """Report a value of a field that has a verdict and cannot have one, or is an error and has none.

    ``has_verdict`` is True if the frame of the field contains the position.
    """
    for name, value in field.values.items():
        if value.makes_position:
            problem = _no_verdict(fields, field, has_verdict)
            if problem:
                report.add("value-verdict", value.place_of("makes_position"), problem, at_key=True)
        elif has_verdict and names_error(name, value.printed_name):
            problem = f"{quoted(name)} is in a frame that contains the position; set 'makes_position' to the"
            problem += " verdict on the position while the field has this value:"
            remedy = "not_usable, usable_with_warning or usable"
            report.add("makes-position-missing", value.path, f"{problem} {remedy}")


def _no_verdict(fields: FieldList, field: WrittenField, has_verdict: bool) -> str:
    """Return the reason that a value of a field cannot have a verdict, and the fix. Empty if it can."""
    name = quoted(field.name)
    if not has_verdict:
        return f"{_reason_without_verdict(fields)}; remove 'makes_position'"
    if field.name in fields.selectors:
        return f"{name} identifies the frame, so it cannot decide the verdict on the position; use another field"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field with a verdict has the same width for all"
    return ""


def _reason_without_verdict(fields: FieldList) -> str:
    """Return the reason that a list of fields has no verdict on a position."""
    owner = quoted(fields.name or FieldOwner.CONTROL.value)  # Only the control data are unnamed.
    match fields.kind:
        case FieldOwner.REGISTER | FieldOwner.CONTROL:
            return f"{owner} is not a frame, so no value in it has a verdict on the position"
        case FieldOwner.GROUP:
            return f"no frame of the encoder with a position uses {owner}"
        case FieldOwner.LAYOUT:
            return f"{owner} {'does not contain the position' if fields.is_from_encoder else 'is sent by the master'}"


def _has_position(spec: WrittenSpec, fields: FieldList, groups: Groups) -> bool:
    """Return True for a frame of the encoder that contains the position, a field that is joined to it, or the join."""
    if not fields.is_from_encoder:
        return False
    names = {*field_names(fields, groups), *fields.joins}
    return not names.isdisjoint(position_names(spec, fields.interface))


def check_combinations(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that combinations are in frames with a position, that their conditions exist, and that each can decide.

    A combination gives the verdict while several fields have certain values. It never decides if one of its conditions,
    or a combination with some of them, already gives the same verdict or a worse one.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    for frame in layouts_of_interfaces(spec):
        listed_combinations = frame.layout.combinations if frame.layout is not None else ()
        if listed_combinations and not _has_position(spec, frame, groups):
            problem = f"{_reason_without_verdict(frame)}; remove 'combinations'"
            report.add("combination", frame.owner.place_of("combinations"), problem, at_key=True)
            continue
        fields_by_name = field_names(frame, groups)
        for index, combination in enumerate(listed_combinations):
            if not _check_conditions(frame, fields_by_name, combination, report):
                continue  # Its conditions are reported elsewhere, and there may be no verdicts to compare.
            # A combination decides only if no part of it makes the position at least as bad by itself.
            earlier_combinations = listed_combinations[:index]
            later_combinations = listed_combinations[index + 1 :]
            verdicts_of_parts = [
                *_own_verdicts(frame, fields_by_name, combination),
                *_verdicts_of_parts(combination, earlier_combinations, later_combinations),
            ]
            _check_can_decide(combination, verdicts_of_parts, report)


def check_report_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the reports of values with a verdict and of combinations have names that are unique in the frame."""
    groups = by_name(spec.with_invalid_parts.field_groups)
    for frame in layouts_of_interfaces(spec):
        used_names = set(readable_names(frame, groups))
        for path, name in _report_names(frame, groups):
            if name in used_names:
                problem = (
                    f"this frame already has {quoted(name)}, which is also the name of this report; rename one of them"
                )
                report.add("duplicate-name", path, problem)
            used_names.add(name)


def _report_names(fields: FieldList, groups: Groups) -> Iterator[tuple[Path, str]]:
    """Yield the names of the reports of a frame, each with its path.

    A value with a verdict is reported as ``field_value``, and a combination under its own name.
    """
    use_paths = {field.path for field in fields.fields if field.use}
    for field_path, field in with_groups_expanded(fields, groups):
        for name, value in field.values.items():
            if value.has("makes_position"):
                # A value in a group is reported at the use of the group.
                path = field_path if field_path in use_paths else value.path
                yield path, f"{field.name}_{name}"
    for combination in fields.layout.combinations if fields.layout is not None else ():
        yield combination.place_of("name"), combination.name


def _check_conditions(
    fields: FieldList, fields_by_name: Fields, combination: WrittenCombination, report: DocumentReport
) -> bool:
    """Report conditions on fields or values that do not exist or cannot be combined. Return True if there are none.

    A single condition is reported too, because its verdict belongs to the flag or the value.
    """
    problems_before = len(report)
    for field_name, value in combination.when.items():
        condition_path = (*combination.place_of("when"), field_name)
        if field_name not in fields_by_name:
            problem = f"there is no field {quoted(field_name)} in this frame{suggest_word(field_name, fields_by_name)}"
            report.add("undefined-reference", condition_path, problem, at_key=True)
            continue
        field = fields_by_name[field_name]
        problem = _obstacle_to_combination(fields, field_name, field)
        known_values = _words_of(field)
        if problem:
            report.add("combination", condition_path, problem, at_key=True)
        elif value not in known_values:
            problem = f"{quoted(field_name)} has no value {quoted(value)}{suggest_word(value, known_values)}"
            report.add("undefined-reference", condition_path, problem)
    if len(combination.when) == 1 and len(report) == problems_before:
        (field_name,) = combination.when
        is_flag = fields_by_name[field_name].is_flag
        verdict_place = f"the flag {quoted(field_name)}" if is_flag else f"the value of {quoted(field_name)}"
        problem = (
            f"{quoted(combination.name)} has only one condition; write 'makes_position' at {verdict_place} instead"
        )
        report.add("combination", combination.place_of("when"), problem)
    return len(report) == problems_before


def _obstacle_to_combination(fields: FieldList, field_name: str, field: WrittenField) -> str:
    """Return the reason that a combination cannot contain a field, and the fix. Empty if it can."""
    name = quoted(field_name)
    if not field.is_flag and not value_names(field):
        return f"{name} is neither a flag nor a field with 'values'; give names to its values with 'values'"
    if field.has("only"):
        return f"the manual explains {name} only for some order codes; a combination applies to all of them"
    if field_name in fields.selectors:
        return f"{name} identifies the frame, so it has the same value in all of them; remove it"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field in a combination has the same for all"
    return ""


def _words_of(field: WrittenField) -> list[str]:
    """Return the possible values of a field in a condition.

    These are ``active`` and ``inactive`` for a flag, and the names of values for another field. If ``others`` gives a
    meaning to the unlisted numbers, a narrow field also has ``reserved_5`` and the like for each of them.
    """
    if field.is_flag:
        return list(_FLAG_WORDS)
    value_words = value_names(field)
    width = constant_width(field)
    if field.has("others") and width is not None and width <= MOST_RESERVED_BITS:
        listed_numbers = {value.value for value in field.values.values() if value.is_valid("value")}
        other_numbers = [number for number in range(1 << width) if number not in listed_numbers]
        value_words += [f"{RESERVED}_{number}" for number in other_numbers]
    return value_words


def _check_can_decide(
    combination: WrittenCombination, verdicts: Iterable[tuple[str, str]], report: DocumentReport
) -> None:
    """Report a combination that never decides, since a part of it already has the same verdict or a worse one.

    ``verdicts`` contains the text for each part and its verdict: ``("'battery' alone", "not_usable")``.
    """
    for part_text, verdict in verdicts:
        is_as_bad = bool(verdict) and _WORST_FIRST.index(verdict) <= _WORST_FIRST.index(combination.makes_position)
        if is_as_bad:
            problem = (
                f"{quoted(combination.name)} never decides, since {part_text} already makes the position {verdict}"
            )
            report.add("combination", combination.place_of("makes_position"), f"{problem}; remove the combination")
            return


def _own_verdicts(
    fields: FieldList, fields_by_name: Fields, combination: WrittenCombination
) -> Iterator[tuple[str, str]]:
    """Yield the verdict of each flag and value of a combination by itself, with a text that names it.

    The verdict is empty if there is none. An inactive flag has no verdict and is omitted.
    """
    for name, value_name in combination.when.items():
        field = fields_by_name[name]
        if not field.is_flag:
            value = field.values.get(value_name)
            yield f"{quoted(name)} alone", value.makes_position if value is not None else ""
        elif value_name == "active":
            default_verdict = INTERFACES[fields.interface].flags.get(name, "")
            yield f"{quoted(name)} alone", field.makes_position or default_verdict


def _verdicts_of_parts(
    combination: WrittenCombination,
    earlier_combinations: Sequence[WrittenCombination],
    later_combinations: Sequence[WrittenCombination],
) -> Iterator[tuple[str, str]]:
    """Yield the name and the verdict of each other combination that always applies when this one does."""
    for earlier in earlier_combinations:
        if _is_part(earlier, combination):
            yield quoted(earlier.name), earlier.makes_position
    for later in later_combinations:
        # Of two equal combinations, the second one is reported.
        is_equal = later.when == combination.when and later.makes_position == combination.makes_position
        if _is_part(later, combination) and not is_equal:
            yield quoted(later.name), later.makes_position


def _is_part(other_combination: WrittenCombination, combination: WrittenCombination) -> bool:
    """Return True if all conditions of another combination, at least two, are also conditions of ``combination``."""
    conditions = other_combination.when.items()
    return len(conditions) > 1 and conditions <= combination.when.items()


def check_default_answers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a default is the first answer, and that the answers set one parameter that a flag uses.

    The default sets it to 0, and each other answer to 1. Flags use it in ``makes_position_if``.
    """
    used_by_flags: set[str] = set()
    for field_list in field_lists(spec):
        for field in field_list.fields:
            used_by_flags.update(field.makes_position_if)
    for alternative in spec.alternatives:
        default = alternative.default
        if not default:
            continue
        first_answer, *_ = alternative.values
        default_path = alternative.place_of("default")
        if default != first_answer:
            problem = f"the default {quoted(default)} is not the first answer of {quoted(alternative.name)}"
            report.add("alternative-default", default_path, f"{problem}; write {quoted(first_answer)}")
            continue
        _check_settings(alternative, report)
        # Of several parameters, which are reported, the first one is checked.
        parameter, *_ = alternative.values[first_answer].sets
        if parameter not in used_by_flags:
            problem = f"no flag has {quoted(parameter)} in 'makes_position_if', so the answer changes nothing"
            report.add("alternative-default", default_path, f"{problem}; add it to a flag, or remove 'default'")


def _check_settings(alternative: WrittenAlternative, report: DocumentReport) -> None:
    """Check that the answers set one parameter: the first answer, which is the default, to 0, and the others to 1.

    The caller has checked that the alternative has a default, and that it is the first answer.
    """
    for index, (name, answer) in enumerate(alternative.values.items()):
        is_default = index == 0
        sets_path = answer.place_of("sets")
        if len(answer.sets) > 1:
            problem = f"{quoted(alternative.name)} has a default, so its answers set one parameter"
            report.add("alternative-default", sets_path, f"{problem}; keep one, or remove 'default'")
            return
        for parameter, value in answer.sets.items():
            expected = 0 if is_default else 1
            if value != expected:
                problem = f"{quoted(name)} sets {quoted(parameter)} to {value}; the default answer must set it to 0"
                message = f"{problem} and every other answer to 1, so write {expected}"
                report.add("alternative-default", (*sets_path, parameter), message)


def check_verdicts_by_answer(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check the verdicts in ``makes_position_if``, which replaces ``makes_position`` for some answers.

    Each belongs to a parameter of an alternative with a default, and differs from the verdict without a choice.
    """
    alternatives_with_default = {
        name
        for name, alternative in by_name(spec.with_invalid_parts.alternatives).items()
        if alternative.has("default")
    }
    for field_list in field_lists(spec):
        for field in field_list.fields:
            for name, verdict in field.makes_position_if.items():
                verdict_path = (*field.place_of("makes_position_if"), name)
                parameter = spec.with_invalid_parts.parameters.get(name)
                if parameter is None or parameter.alternative not in alternatives_with_default:
                    reason = f"{quoted(name)} is not a parameter of an alternative with a default"
                    report.add(
                        "verdict-choice",
                        verdict_path,
                        f"{reason}; set its 'alternative' to the name of such an alternative",
                    )
                    continue
                problem = _no_other_verdict(field_list, field, verdict)
                if problem:
                    report.add("verdict-choice", verdict_path, problem)


def _no_other_verdict(fields: FieldList, field: WrittenField, other_verdict: str) -> str:
    """Return the reason that a flag cannot have another verdict for an answer, and the fix. Empty if it can."""
    name = quoted(field.name)
    if fields.kind in (FieldOwner.REGISTER, FieldOwner.CONTROL):
        return f"{name} is not in a frame, so it has no verdict on a position; remove 'makes_position_if'"
    interface = INTERFACES.get(fields.interface)
    verdict_of_interface = interface.flags.get(field.name, "") if interface is not None else ""
    verdict = field.makes_position or verdict_of_interface
    if verdict not in ("not_usable", "usable_with_warning"):
        verdict_text = f"{quoted(verdict)}, which is not reported" if verdict else "no verdict"
        remedy = "write 'makes_position: not_usable' or usable_with_warning"
        return f"without a choice, {name} has {verdict_text}; {remedy}"
    if verdict == other_verdict:
        return f"with both answers, {name} makes the position {quoted(verdict)}; give one of them another verdict"
    return ""
