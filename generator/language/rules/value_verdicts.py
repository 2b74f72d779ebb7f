"""Rules for named values and combinations of fields that decide the verdict on the position in the same frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import INTERFACES, Verdict
from ..problems import DocumentReport, Path, quoted, suggestion
from .flags import names_error, position_names
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
_WORST_FIRST = [item.value for item in Verdict]
_FLAG_WORDS = ("active", "inactive")
#: Combinations with their paths.
Items = Sequence[tuple[Path, Spec]]


def value_verdicts(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a named value has a verdict only in a frame with a position, and that an error has one there."""
    groups = by_name(raw, "field_groups")
    judged = [fields for fields in layouts(spec) if _has_position(spec, fields, groups)]
    used = {field.get("use") for fields in judged for _, field in fields}
    for fields in field_lists(spec):
        is_judged = fields.owner.get("name") in used if fields.kind is Has.GROUP else fields in judged
        selectors = mapping(fields.owner, "when")
        for path, field in fields:
            for name, value in mapping(field, "values").items():
                place = (*path, "values", name)
                if "makes_position" in value:
                    wrong = _no_verdict(fields, field, is_judged, field.get("name") in selectors)
                    if wrong:
                        report.add("value-verdict", (*place, "makes_position"), wrong, at_key=True)
                elif is_judged and names_error(name, value):
                    wrong = f"{quoted(name)} is in a frame that contains the position; set 'makes_position' to the"
                    wrong += " verdict on the position while the field has this value:"
                    right = "not_usable, usable_with_warning or usable"
                    report.add("makes-position-missing", place, f"{wrong} {right}")


def _no_verdict(fields: Fields, field: Spec, is_judged: bool, is_selector: bool) -> str:
    """Return the reason that a value of a field cannot have a verdict, and the fix. Empty if it can."""
    name = quoted(field.get("name", ""))
    if not is_judged:
        return f"{_where(fields)}; leave 'makes_position' out"
    if is_selector:
        return f"{name} identifies the frame, so it cannot decide the verdict on the position; use another field"
    if constant_width(field) is None:
        return f"the width of {name} depends on the order code; a field with a verdict has the same width for all"
    return ""


def _where(fields: Fields) -> str:
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
        listed = [((*fields.path, *path), item) for path, item in items(fields.owner, "combinations")]
        if listed and not _has_position(spec, fields, groups):
            wrong = f"{_where(fields)}; leave 'combinations' out"
            report.add("combination", (*fields.path, "combinations"), wrong, at_key=True)
            continue
        for index, (here, item) in enumerate(listed):
            if _check_conditions(fields, inner, here, item, report):
                earlier, later = listed[:index], listed[index + 1 :]
                verdicts = [*_own_verdicts(fields, inner, item), *_verdicts_of_parts(item, earlier, later)]
                _check_can_decide(here, item, verdicts, report)


def report_names(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that values with a verdict and combinations have other names than the fields of the frame."""
    groups = by_name(raw, "field_groups")
    for fields in layouts(spec):
        taken = set(readable_names(fields, groups))
        for path, name in _report_names(fields, groups):
            if name in taken:
                wrong = (
                    f"this frame already has {quoted(name)}, which is also the name of this report; rename one of them"
                )
                report.add("duplicate-name", path, wrong)
            taken.add(name)


def _report_names(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, str]]:
    """Yield the names of the reports of values and combinations, each with its path."""
    used = {path for path, field in fields if "use" in field}
    for path, field in expanded(fields, groups):
        for name, value in mapping(field, "values").items():
            if isinstance(value, dict) and "makes_position" in value:
                yield path if path in used else (*path, "values", name), f"{field.get('name')}_{name}"
    yield from (((*fields.path, *path, "name"), item["name"]) for path, item in items(fields.owner, "combinations"))


def _check_conditions(
    fields: Fields, inner: Mapping[str, Spec], here: Path, item: Spec, report: DocumentReport
) -> bool:
    """Report conditions on fields or values that do not exist or cannot be combined. Return True if there are none."""
    before = len(report)
    for name, value in item["when"].items():
        place = (*here, "when", name)
        if name not in inner:
            wrong = f"there is no field {quoted(name)} in this frame{suggestion(name, inner)}"
            report.add("undefined-reference", place, wrong, at_key=True)
            continue
        wrong = _no_condition(fields, name, inner[name])
        known = _words_of(inner[name])
        if wrong:
            report.add("combination", place, wrong, at_key=True)
        elif value not in known:
            wrong = f"{quoted(name)} has no value {quoted(value)}{suggestion(value, known)}"
            report.add("undefined-reference", place, wrong)
    if len(item["when"]) == 1 and len(report) == before:
        (name,) = item["when"]
        owner = f"the flag {quoted(name)}" if "active" in inner[name] else f"the value of {quoted(name)}"
        wrong = f"{quoted(item['name'])} has only one condition; write 'makes_position' at {owner} instead"
        report.add("combination", (*here, "when"), wrong)
    return len(report) == before


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
    numbers = {item.get("value") for item in mapping(field, "values").values()}
    width = constant_width(field) or 0
    others = range(1 << width) if "others" in field and width <= 4 else range(0)
    return [*mapping(field, "values"), *(f"{RESERVED}_{number}" for number in others if number not in numbers)]


def _check_can_decide(here: Path, item: Spec, verdicts: Iterable[tuple[str, str]], report: DocumentReport) -> None:
    """Report a combination that never decides, since a part of it already has the same verdict or a worse one."""
    for what, verdict in verdicts:
        if verdict and _WORST_FIRST.index(verdict) <= _WORST_FIRST.index(item["makes_position"]):
            wrong = f"{quoted(item['name'])} never decides, since {what} already makes the position {verdict}"
            report.add("combination", (*here, "makes_position"), f"{wrong}; leave the combination out")
            return


def _own_verdicts(fields: Fields, inner: Mapping[str, Spec], item: Spec) -> Iterator[tuple[str, str]]:
    """Yield the verdict of each flag and value of a combination by itself. It is empty if there is none."""
    for name, value in item["when"].items():
        field = inner[name]
        if "active" not in field:
            yield f"{quoted(name)} alone", str(mapping(field, "values", value).get("makes_position", ""))
        elif value == "active":
            default = INTERFACES[fields.interface].flags.get(name, "")
            yield f"{quoted(name)} alone", str(field.get("makes_position", default))


def _verdicts_of_parts(item: Spec, earlier: Items, later: Items) -> Iterator[tuple[str, str]]:
    """Yield the verdicts of other combinations that always apply when this one does."""
    for is_earlier, others in ((True, earlier), (False, later)):
        for _, other in others:
            is_same = other["when"] == item["when"] and other["makes_position"] == item["makes_position"]
            is_part = len(other["when"]) > 1 and other["when"].items() <= item["when"].items()
            if is_part and (is_earlier or not is_same):
                yield quoted(other["name"]), other["makes_position"]
