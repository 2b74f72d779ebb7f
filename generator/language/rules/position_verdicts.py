"""Rules for facts that decide whether a position is usable: values, combinations of fields, and alternatives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import INTERFACES, Verdict
from ..document import Path
from ..problems import DocumentReport, quoted, suggestion
from .bits import names_error, position_names
from .shapes import MOST_RESERVED_BITS, RESERVED
from .values import constant_width
from .walk import (
    Fields,
    Has,
    Spec,
    by_name,
    expanded,
    field_lists,
    field_names,
    items,
    layouts,
    mapping,
    readable_names,
)

#: Verdicts, worst first.
_WORST_FIRST = [verdict.value for verdict in Verdict]
_FLAG_WORDS = ("active", "inactive")
#: Combinations with their paths.
Items = Sequence[tuple[Path, Spec]]


def value_verdicts(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a named value has a verdict only in a frame with a position, and that an error has one there."""
    groups = by_name(raw, "field_groups")
    position_frames = [fields for fields in layouts(spec) if _has_position(spec, fields, groups)]
    used_groups = set()
    for fields in position_frames:
        used_groups |= {field.get("use") for _, field in fields}
    for fields in field_lists(spec):
        if fields.kind is Has.GROUP:
            has_verdict = fields.owner.get("name") in used_groups
        else:
            has_verdict = fields in position_frames
        for path, field in fields:
            _check_verdicts_of_values(fields, path, field, has_verdict, report)


def _check_verdicts_of_values(
    fields: Fields, path: Path, field: Spec, has_verdict: bool, report: DocumentReport
) -> None:
    """Check the verdicts of the values of a field. ``has_verdict`` is set if its frame has a verdict on a position."""
    for name, value in mapping(field, "values").items():
        value_path = (*path, "values", name)
        if "makes_position" in value:
            problem = _no_verdict(fields, field, has_verdict)
            if problem:
                report.add("value-verdict", (*value_path, "makes_position"), problem, at_key=True)
        elif has_verdict and names_error(name, value):
            problem = f"{quoted(name)} is in a frame that contains the position; set 'makes_position' to the"
            problem += " verdict on the position while the field has this value:"
            remedy = "not_usable, usable_with_warning or usable"
            report.add("makes-position-missing", value_path, f"{problem} {remedy}")


def _no_verdict(fields: Fields, field: Spec, has_verdict: bool) -> str:
    """Return the reason that a value of a field cannot have a verdict, and the fix. Empty if it can."""
    name = quoted(field.get("name", ""))
    if not has_verdict:
        return f"{_reason_without_verdict(fields)}; leave 'makes_position' out"
    is_selector = field.get("name") in mapping(fields.owner, "when")
    if is_selector:
        return f"{name} identifies the frame, so it cannot decide the verdict on the position; use another field"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field with a verdict has the same width for all"
    return ""


def _reason_without_verdict(fields: Fields) -> str:
    """Return the reason that a list of fields has no verdict on a position."""
    owner = quoted(fields.owner.get("name", Has.CONTROL.value))  # Only the control data have no name.
    match fields.kind:
        case Has.REGISTER | Has.CONTROL:
            return f"{owner} is not a frame, so no value in it has a verdict on the position"
        case Has.GROUP:
            return f"no frame of the encoder with a position uses {owner}"
        case Has.LAYOUT:
            is_from_encoder = fields.owner.get("from") == "encoder"
            return f"{owner} {'does not contain the position' if is_from_encoder else 'is sent by the master'}"


def _has_position(spec: Spec, fields: Fields, groups: Mapping[str, Spec]) -> bool:
    """Return True for a frame of the encoder that contains the position or a part of it."""
    if fields.owner.get("from") != "encoder":
        return False
    names = {*field_names(fields, groups), *mapping(fields.owner, "join")}
    return not names.isdisjoint(position_names(spec, fields.interface))


def combinations(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check combinations: their fields and values exist, and each of them can decide."""
    groups = by_name(raw, "field_groups")
    for fields in layouts(spec):
        listed_combinations = list(items(fields.owner, "combinations"))
        if listed_combinations and not _has_position(spec, fields, groups):
            problem = f"{_reason_without_verdict(fields)}; leave 'combinations' out"
            report.add("combination", (*fields.path, "combinations"), problem, at_key=True)
            continue
        fields_by_name = field_names(fields, groups)
        for index, (path, combination) in enumerate(listed_combinations):
            combination_path = (*fields.path, *path)
            if not _check_conditions(fields, fields_by_name, combination_path, combination, report):
                continue
            verdicts = [
                *_own_verdicts(fields, fields_by_name, combination),
                *_verdicts_of_parts(combination, listed_combinations[:index], listed_combinations[index + 1 :]),
            ]
            _check_can_decide(combination_path, combination, verdicts, report)


def report_names(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that values with a verdict and combinations have other names than the fields of the frame."""
    groups = by_name(raw, "field_groups")
    for fields in layouts(spec):
        used_names = set(readable_names(fields, groups))
        for path, name in _report_names(fields, groups):
            if name in used_names:
                problem = (
                    f"this frame already has {quoted(name)}, which is also the name of this report; rename one of them"
                )
                report.add("duplicate-name", path, problem)
            used_names.add(name)


def _report_names(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, str]]:
    """Yield the names of the reports of values and combinations, each with its path."""
    use_paths = {path for path, field in fields if "use" in field}
    for path, field in expanded(fields, groups):
        for name, value in mapping(field, "values").items():
            if isinstance(value, dict) and "makes_position" in value:
                # A value in a group is reported at the use of the group.
                value_path = path if path in use_paths else (*path, "values", name)
                yield value_path, f"{field.get('name')}_{name}"
    for path, combination in items(fields.owner, "combinations"):
        yield (*fields.path, *path, "name"), combination["name"]


def _check_conditions(
    fields: Fields, fields_by_name: Mapping[str, Spec], path: Path, combination: Spec, report: DocumentReport
) -> bool:
    """Report conditions on fields or values that do not exist or cannot be combined. Return True if there are none."""
    problems_before = len(report)
    for name, value in combination["when"].items():
        condition_path = (*path, "when", name)
        if name not in fields_by_name:
            problem = f"there is no field {quoted(name)} in this frame{suggestion(name, fields_by_name)}"
            report.add("undefined-reference", condition_path, problem, at_key=True)
            continue
        field = fields_by_name[name]
        problem = _no_condition(fields, name, field)
        known_values = _words_of(field)
        if problem:
            report.add("combination", condition_path, problem, at_key=True)
        elif value not in known_values:
            problem = f"{quoted(name)} has no value {quoted(value)}{suggestion(value, known_values)}"
            report.add("undefined-reference", condition_path, problem)
    if len(combination["when"]) == 1 and len(report) == problems_before:
        (name,) = combination["when"]
        place = f"the flag {quoted(name)}" if "active" in fields_by_name[name] else f"the value of {quoted(name)}"
        problem = f"{quoted(combination['name'])} has only one condition; write 'makes_position' at {place} instead"
        report.add("combination", (*path, "when"), problem)
    return len(report) == problems_before


def _no_condition(fields: Fields, name: str, field: Spec) -> str:
    """Return the reason that a combination cannot contain a field, and the fix. Empty if it can."""
    if "active" not in field and not mapping(field, "values"):
        return f"{quoted(name)} is neither a flag nor a field with 'values'; give names to its values with 'values'"
    if "only" in field:
        return f"the manual explains {quoted(name)} only for some order codes; a combination applies to all of them"
    if name in mapping(fields.owner, "when"):
        return f"{quoted(name)} identifies the frame, so it has the same value in all of them; leave it out"
    if constant_width(field) is None:
        return f"the width of {quoted(name)} depends on the order code; a field in a combination has the same for all"
    return ""


def _words_of(field: Spec) -> list[str]:
    """Return the possible values of a field in a condition."""
    if "active" in field:
        return list(_FLAG_WORDS)
    values = mapping(field, "values")
    words = list(values)
    width = constant_width(field)
    if "others" in field and width is not None and width <= MOST_RESERVED_BITS:
        listed_numbers = {value.get("value") for value in values.values()}
        other_numbers = [number for number in range(1 << width) if number not in listed_numbers]
        words += [f"{RESERVED}_{number}" for number in other_numbers]
    return words


def _check_can_decide(
    combination_path: Path, combination: Spec, verdicts: Iterable[tuple[str, str]], report: DocumentReport
) -> None:
    """Report a combination that never decides, since a part of it already has the same verdict or a worse one."""
    for part_text, verdict in verdicts:
        if verdict and _WORST_FIRST.index(verdict) <= _WORST_FIRST.index(combination["makes_position"]):
            problem = (
                f"{quoted(combination['name'])} never decides, since {part_text} already makes the position {verdict}"
            )
            report.add("combination", (*combination_path, "makes_position"), f"{problem}; leave the combination out")
            return


def _own_verdicts(fields: Fields, fields_by_name: Mapping[str, Spec], combination: Spec) -> Iterator[tuple[str, str]]:
    """Yield the verdict of each flag and value of a combination by itself. It is empty if there is none."""
    for name, value in combination["when"].items():
        field = fields_by_name[name]
        if "active" not in field:
            yield f"{quoted(name)} alone", str(mapping(field, "values", value).get("makes_position", ""))
        elif value == "active":
            default_verdict = INTERFACES[fields.interface].flags.get(name, "")
            yield f"{quoted(name)} alone", str(field.get("makes_position", default_verdict))


def _verdicts_of_parts(
    combination: Spec, earlier_combinations: Items, later_combinations: Items
) -> Iterator[tuple[str, str]]:
    """Yield the verdicts of other combinations that always apply when this one does."""
    for _, earlier in earlier_combinations:
        if _is_part(earlier, combination):
            yield quoted(earlier["name"]), earlier["makes_position"]
    for _, later in later_combinations:
        # Of two equal combinations, the second one is reported.
        is_equal = later["when"] == combination["when"] and later["makes_position"] == combination["makes_position"]
        if _is_part(later, combination) and not is_equal:
            yield quoted(later["name"]), later["makes_position"]


def _is_part(other_combination: Spec, combination: Spec) -> bool:
    """Return True if the conditions of another combination are among those of this one."""
    conditions = other_combination["when"].items()
    return len(conditions) > 1 and conditions <= combination["when"].items()


def default_answers(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a default is the first answer, and that the answers set one parameter, to 0 or 1, that a flag uses."""
    used_by_flags: set[str] = set()
    for fields in field_lists(spec):
        for _, field in fields:
            used_by_flags.update(mapping(field, "makes_position_if"))
    for path, alternative in items(spec, "alternatives"):
        if "default" not in alternative:
            continue
        answers, default = mapping(alternative, "values"), alternative["default"]
        first_answer, *_ = answers
        if default != first_answer:
            problem = f"the default {quoted(default)} is not the first answer of {quoted(alternative['name'])}"
            report.add("alternative-default", (*path, "default"), f"{problem}; write {quoted(first_answer)}")
            continue
        _check_settings(path, alternative, report)
        parameter, *_ = mapping(answers, first_answer, "sets")
        if parameter not in used_by_flags:
            problem = f"no flag has {quoted(parameter)} in 'makes_position_if', so the answer changes nothing"
            report.add("alternative-default", (*path, "default"), f"{problem}; add it to a flag, or remove 'default'")


def _check_settings(path: Path, alternative: Spec, report: DocumentReport) -> None:
    """Check that the default sets the only parameter to 0, and that the other answers set it to 1."""
    for index, (name, answer) in enumerate(alternative["values"].items()):
        sets_path, settings = (*path, "values", name, "sets"), answer["sets"]
        if len(settings) > 1:
            problem = f"{quoted(alternative['name'])} has a default, so its answers set one parameter"
            report.add("alternative-default", sets_path, f"{problem}; keep one, or remove 'default'")
            return
        for parameter, value in settings.items():
            expected = int(index > 0)
            if value != expected:
                owner = "the default" if index == 0 else "an answer other than the default"
                problem = f"{quoted(name)} sets {quoted(parameter)} to {value}, but {owner} sets it to {expected}"
                report.add("alternative-default", (*sets_path, parameter), f"{problem}; write {expected}")


def verdicts_by_answer(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the other verdict of a flag differs, and that it belongs to an alternative with a default."""
    parameters, alternatives = mapping(raw, "parameters"), by_name(raw, "alternatives")
    optional = {name for name, alternative in alternatives.items() if "default" in alternative}
    for fields in field_lists(spec):
        for path, field in fields:
            for parameter, verdict in mapping(field, "makes_position_if").items():
                verdict_path = (*path, "makes_position_if", parameter)
                if mapping(parameters, parameter).get("alternative") not in optional:
                    reason = f"{quoted(parameter)} is not a parameter of an alternative with a default"
                    report.add("verdict-choice", verdict_path, f"{reason}; give it 'alternative' with the name of one")
                    continue
                problem = _no_other_verdict(fields, field, verdict)
                if problem:
                    report.add("verdict-choice", verdict_path, problem)


def _no_other_verdict(fields: Fields, field: Spec, other_verdict: str) -> str:
    """Return the reason that a flag cannot have another verdict, and the fix. Empty if it can."""
    name = quoted(field["name"])
    if fields.kind in (Has.REGISTER, Has.CONTROL):
        return f"{name} is not in a frame, so it has no verdict on a position; remove 'makes_position_if'"
    interface = INTERFACES.get(fields.interface)
    verdict_of_interface = interface.flags.get(field["name"], "") if interface is not None else ""
    verdict = field.get("makes_position", verdict_of_interface)
    if verdict not in ("not_usable", "usable_with_warning"):
        verdict_text = f"{quoted(verdict)}, which is not reported" if verdict else "no verdict"
        remedy = "write 'makes_position: not_usable' or usable_with_warning"
        return f"without a choice, {name} has {verdict_text}; {remedy}"
    if verdict == other_verdict:
        return f"with both answers, {name} makes the position {quoted(verdict)}; give one of them another verdict"
    return ""
