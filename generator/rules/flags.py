"""Rules on flags: what each makes of the position that stands in the same frame."""

from __future__ import annotations

from collections.abc import Iterator

from ..problems import DocumentReport, Path, quoted, suggestion
from ..fields import BISS_FLAGS
from .walk import Fields, Spec, by_name, field_lists, field_names, items, layouts, mapping


def makes_position_missing(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """A flag that comes with a position says what the position is worth while it is active."""
    groups = by_name(raw, "field_groups")
    for fields in layouts(spec):
        has_position = not _position_names(spec, fields.interface).isdisjoint(field_names(fields, groups))
        if fields.owner.get("from") != "encoder" or not has_position:
            continue
        for path, field in _with_groups(fields, spec):
            if "active" in field and "makes_position" not in field and "name" in field:
                if fields.interface == "biss" and field["name"] in BISS_FLAGS:
                    continue
                wrong = f"{quoted(field['name'])} comes in a frame with the position; say what the position is worth"
                right = "with 'makes_position': not_usable, usable_with_warning or usable"
                report.add("makes-position-missing", path, f"{wrong} while it is active, {right}")


def flag_sums(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """The flags that another one sums up exist."""
    every = (field for fields in field_lists(raw) for _, field in fields)
    flags = [field["name"] for field in every if "active" in field and _has_name(field)]
    for fields in field_lists(spec):
        for path, field in fields:
            known = [name for name in dict.fromkeys(flags) if name != field.get("name")]
            for index, name in enumerate(field.get("sums_up", ())):
                if name not in known:
                    wrong = f"there is no other flag {quoted(name)}{suggestion(name, known, 'known are')}"
                    report.add("undefined-reference", (*path, "sums_up", index), wrong)


def _has_name(field: Spec) -> bool:
    return isinstance(field.get("name"), str)


def _position_names(spec: Spec, interface: str) -> set[str]:
    """The fields and joins that are the position or a part of it: what is measured, else those named ``position``."""
    measurement = mapping(spec, "interfaces", interface, "measurement") or mapping(spec, "measurement")
    of = measurement.get("of", "position")
    joins = (mapping(fields.owner, "join") for fields in layouts(spec) if fields.interface == interface)
    return {of}.union(*(join.get(of, ()) for join in joins))


def _with_groups(fields: Fields, spec: Spec) -> Iterator[tuple[Path, Spec]]:
    """The fields, each with its own path; those of a group with their path inside the group."""
    groups = {group["name"]: (path, group) for path, group in items(spec, "field_groups")}
    for path, field in fields:
        if field.get("use") in groups:
            start, group = groups[field["use"]]
            yield from (((*start, *below), inner) for below, inner in items(group, "fields"))
        else:
            yield path, field
