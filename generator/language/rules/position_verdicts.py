"""Rules for facts that decide whether a position is usable: values, combinations of fields, and alternatives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import INTERFACES, Verdict
from ..document import Path
from ..problems import DocumentReport, quoted, suggestion
from .bits import names_error, position_names
from .shapes import RESERVED
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
    judged = [fields for fields in layouts(spec) if _has_position(spec, fields, groups)]
    used_groups = {field.get("use") for fields in judged for _, field in fields}
    for fields in field_lists(spec):
        is_judged = fields.owner.get("name") in used_groups if fields.kind is Has.GROUP else fields in judged
        selectors = mapping(fields.owner, "when")
        for path, field in fields:
            for name, value in mapping(field, "values").items():
                place = (*path, "values", name)
                if "makes_position" in value:
                    problem = _no_verdict(fields, field, is_judged, field.get("name") in selectors)
                    if problem:
                        report.add("value-verdict", (*place, "makes_position"), problem, at_key=True)
                elif is_judged and names_error(name, value):
                    problem = f"{quoted(name)} is in a frame that contains the position; set 'makes_position' to the"
                    problem += " verdict on the position while the field has this value:"
                    remedy = "not_usable, usable_with_warning or usable"
                    report.add("makes-position-missing", place, f"{problem} {remedy}")


def _no_verdict(fields: Fields, field: Spec, is_judged: bool, is_selector: bool) -> str:
    """Return the reason that a value of a field cannot have a verdict, and the fix. Empty if it can."""
    name = quoted(field.get("name", ""))
    if not is_judged:
        return f"{_reason_without_verdict(fields)}; leave 'makes_position' out"
    if is_selector:
        return f"{name} identifies the frame, so it cannot decide the verdict on the position; use another field"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field with a verdict has the same width for all"
    return ""


def _reason_without_verdict(fields: Fields) -> str:
    """Return the reason that a list of fields has no verdict on a position."""
    owner = quoted(fields.owner.get("name", "control_data"))
    match fields.kind:
        case Has.REGISTER | Has.CONTROL:
            return f"{owner} is not a frame, so no value in it has a verdict on the position"
        case Has.GROUP:
            return f"no frame of the encoder with a position uses {owner}"
        case Has.LAYOUT:
            has_encoder = fields.owner.get("from") == "encoder"
            return f"{owner} {'does not contain the position' if has_encoder else 'is sent by the master'}"


def _has_position(spec: Spec, fields: Fields, groups: Mapping[str, Spec]) -> bool:
    """Return True for a frame of the encoder that contains the position or a part of it."""
    names = {*field_names(fields, groups), *mapping(fields.owner, "join")}
    return fields.owner.get("from") == "encoder" and not position_names(spec, fields.interface).isdisjoint(names)


def combinations(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check combinations: their fields and values exist, and each of them can decide."""
    groups = by_name(raw, "field_groups")
    for fields in layouts(spec):
        inner = field_names(fields, groups)
        entries = [((*fields.path, *path), combination) for path, combination in items(fields.owner, "combinations")]
        if entries and not _has_position(spec, fields, groups):
            problem = f"{_reason_without_verdict(fields)}; leave 'combinations' out"
            report.add("combination", (*fields.path, "combinations"), problem, at_key=True)
            continue
        for index, (combination_path, combination) in enumerate(entries):
            if _check_conditions(fields, inner, combination_path, combination, report):
                earlier_combinations, later_combinations = entries[:index], entries[index + 1 :]
                verdicts = [
                    *_own_verdicts(fields, inner, combination),
                    *_verdicts_of_parts(combination, earlier_combinations, later_combinations),
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
    group_paths = {path for path, field in fields if "use" in field}
    for path, field in expanded(fields, groups):
        for name, value in mapping(field, "values").items():
            if isinstance(value, dict) and "makes_position" in value:
                yield path if path in group_paths else (*path, "values", name), f"{field.get('name')}_{name}"
    for path, combination in items(fields.owner, "combinations"):
        yield (*fields.path, *path, "name"), combination["name"]


def _check_conditions(
    fields: Fields, inner: Mapping[str, Spec], combination_path: Path, combination: Spec, report: DocumentReport
) -> bool:
    """Report conditions on fields or values that do not exist or cannot be combined. Return True if there are none."""
    problems_before = len(report)
    for name, value in combination["when"].items():
        place = (*combination_path, "when", name)
        if name not in inner:
            problem = f"there is no field {quoted(name)} in this frame{suggestion(name, inner)}"
            report.add("undefined-reference", place, problem, at_key=True)
            continue
        problem = _no_condition(fields, name, inner[name])
        known_values = _words_of(inner[name])
        if problem:
            report.add("combination", place, problem, at_key=True)
        elif value not in known_values:
            problem = f"{quoted(name)} has no value {quoted(value)}{suggestion(value, known_values)}"
            report.add("undefined-reference", place, problem)
    if len(combination["when"]) == 1 and len(report) == problems_before:
        (name,) = combination["when"]
        owner = f"the flag {quoted(name)}" if "active" in inner[name] else f"the value of {quoted(name)}"
        problem = f"{quoted(combination['name'])} has only one condition; write 'makes_position' at {owner} instead"
        report.add("combination", (*combination_path, "when"), problem)
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
    numbers = {value.get("value") for value in mapping(field, "values").values()}
    width = constant_width(field) or 0
    other_numbers = range(1 << width) if "others" in field and width <= 4 else range(0)
    return [*mapping(field, "values"), *(f"{RESERVED}_{number}" for number in other_numbers if number not in numbers)]


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


def _own_verdicts(fields: Fields, inner: Mapping[str, Spec], combination: Spec) -> Iterator[tuple[str, str]]:
    """Yield the verdict of each flag and value of a combination by itself. It is empty if there is none."""
    for name, value in combination["when"].items():
        field = inner[name]
        if "active" not in field:
            yield f"{quoted(name)} alone", str(mapping(field, "values", value).get("makes_position", ""))
        elif value == "active":
            default = INTERFACES[fields.interface].flags.get(name, "")
            yield f"{quoted(name)} alone", str(field.get("makes_position", default))


def _verdicts_of_parts(
    combination: Spec, earlier_combinations: Items, later_combinations: Items
) -> Iterator[tuple[str, str]]:
    """Yield the verdicts of other combinations that always apply when this one does."""
    for is_earlier, other_combinations in ((True, earlier_combinations), (False, later_combinations)):
        for _, other_combination in other_combinations:
            is_same = (
                other_combination["when"] == combination["when"]
                and other_combination["makes_position"] == combination["makes_position"]
            )
            is_part = (
                len(other_combination["when"]) > 1 and other_combination["when"].items() <= combination["when"].items()
            )
            if is_part and (is_earlier or not is_same):
                yield quoted(other_combination["name"]), other_combination["makes_position"]


def default_answers(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a default is the first answer, and that the answers set one parameter, to 0 or 1, that a flag uses."""
    used = {name for fields in field_lists(spec) for _, field in fields for name in mapping(field, "makes_position_if")}
    for path, alternative in items(spec, "alternatives"):
        if "default" not in alternative:
            continue
        answers, default = mapping(alternative, "values"), alternative["default"]
        first_answer = next(iter(answers))
        if default != first_answer:
            problem = f"the default {quoted(default)} is not the first answer of {quoted(alternative['name'])}"
            report.add("alternative-default", (*path, "default"), f"{problem}; write {quoted(first_answer)}")
            continue
        _check_settings(path, alternative, report)
        parameter = next(iter(mapping(answers, first_answer, "sets")))
        if parameter not in used:
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


def _no_other_verdict(fields: Fields, field: Spec, verdict: str) -> str:
    """Return the reason that a flag has no other verdict, and the fix. Empty if it has one."""
    name, interface = quoted(field["name"]), INTERFACES.get(fields.interface)
    implied = interface.flags.get(field["name"], "") if interface is not None else ""
    default = field.get("makes_position", implied)
    if fields.kind in (Has.REGISTER, Has.CONTROL):
        return f"{name} is not in a frame, so it has no verdict on a position; remove 'makes_position_if'"
    if default not in ("not_usable", "usable_with_warning"):
        default_text = f"{quoted(default)}, which is not reported" if default else "no verdict"
        remedy = "write 'makes_position: not_usable' or usable_with_warning"
        return f"without a choice, {name} has {default_text}; {remedy}"
    if default == verdict:
        return f"with both answers, {name} makes the position {quoted(verdict)}; give one of them another verdict"
    return ""
