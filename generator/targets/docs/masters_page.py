"""Page of the BiSS and SSI master settings for the order codes of a family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import prod
from typing import Annotated, Any, TypedDict

from ...masters.groups import Group, records_of, sheets_of
from ...masters.places import Device as MasterDevice
from ...masters.places import Place, place_words
from ...masters.sheet import Master, Refusal, Setting, Sheet
from ...masters.text import bound, cited, condition, conditions, facts, legend, mark
from ...model import Device, Interface
from ...say.markdown import code, joined, text
from .fact_tables import document_rows
from .order_code_patterns import order_codes
from .page_links import to_erratum

Row = tuple[str, ...]
Table = dict[str, Any]


#: Groups with their rows, which are keyed by setting.
Columns = Sequence[tuple[Group, Sequence[tuple[Any, Row]]]]
#: Settings of one master for each group.
Told = Sequence[tuple[Group, Sheet]]


def has_masters(device: Device) -> bool:
    return any(True for item in device.interfaces for _ in records_of(device, item))


class MastersPage(TypedDict):
    device: Annotated[Device, "the family"]
    legend: Annotated[str, "meaning of the marks on the page"]
    interfaces: Annotated[list[dict[str, Any]], "interfaces that masters support, with the settings of each master"]


def page_values(device: Device, masters: Sequence[Master]) -> MastersPage:
    parts = [
        (
            item.interface,
            item.groups,
            [(master, list(zip(item.groups, sheets, strict=True))) for master, sheets in item.sheets],
        )
        for item in sheets_of(device, masters)
    ]
    sheets = [found for _, _, told in parts for _, rows in told for _, found in rows]
    return {
        "device": device,
        "legend": text(legend(masters, sheets, with_places=True)),
        "interfaces": [_interface(device, *part) for part in parts],
    }


def _interface(
    device: Device, interface: Interface, groups: Sequence[Group], told: Sequence[tuple[Master, Told]]
) -> dict[str, Any]:
    same, tables = _split(
        [(group, [(name, (name, text(value))) for name, value in facts(group.record)]) for group in groups]
    )
    codes = [] if tables else [("Order codes", _label(groups))]
    return {
        "title": interface.title,
        "anchor": interface.name,
        "facts": [*codes, *((text(name), value) for name, value in same)],
        "tables": tables,
        "cable_errata": ", ".join(to_erratum(device, name) for name in groups[0].record.cables.errata),
        "notes": list(dict.fromkeys(text(note) for group in groups for note in group.record.notes)),
        "masters": [_master(master, sheets) for master, sheets in told if interface.name in master.takes],
        "silent": [text(master.title) for master, _ in told if interface.name not in master.takes],
    }


def _split(columns: Columns) -> tuple[list[Row], list[Table]]:
    """Return the rows common to all groups, and tables of the other rows, with a separate table for the supply.

    Each column is a group with its rows by key. The first cell of a row is its name, the second its value.
    """
    keys = list(dict.fromkeys(key for _, rows in columns for key, _ in rows))
    by_key = [(group, dict(rows)) for group, rows in columns]
    same, other = [], []
    for key in keys:
        found = {rows.get(key) for _, rows in by_key}
        only = found.pop()
        if found or only is None:
            other.append(key)
        else:
            same.append(only)
    by_supply = [key for key in other if _follows_supply(key, by_key)]
    parts = ([key for key in other if key not in by_supply], by_supply)
    return same, [_table(keys, by_key) for keys in parts if keys]


def _follows_supply(key: Any, columns: Sequence[tuple[Group, dict[Any, Row]]]) -> bool:
    found: dict[tuple[int | None, int | None], set[Row | None]] = {}
    for group, rows in columns:
        numbers = group.record.numbers
        found.setdefault((numbers["supply_min_mv"], numbers["supply_max_mv"]), set()).add(rows.get(key))
    return all(len(rows) == 1 for rows in found.values())


def _table(keys: Sequence[Any], columns: Sequence[tuple[Group, dict[Any, Row]]]) -> Table:
    """Return the column heads, and one row for all groups that have the same values."""
    heads = [next(rows[key][0] for _, rows in columns if key in rows) for key in keys]
    found: dict[Row, list[Group]] = {}
    for group, rows in columns:
        found.setdefault(tuple(rows[key][1] if key in rows else "–" for key in keys), []).append(group)
    return {"head": ["Order codes", *heads], "rows": [[_label(groups), *cells] for cells, groups in found.items()]}


def _label(groups: Sequence[Group]) -> str:
    """Return the order codes of all groups, with the answers unless every choice is included."""
    device = groups[0].device
    found: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for group in groups:
        found.setdefault(tuple(group.record.answers.items()), []).extend(group.codes)
    ways = prod(len(item.answers) for item in device.alternatives if item.name in groups[0].record.answers)
    if len(found) == ways and len({frozenset(codes) for codes in found.values()}) == 1:
        return order_codes(device, next(iter(found.values())))
    return joined(
        " ".join((order_codes(device, codes), *(f"with {code(f'{name}={answer}')}" for name, answer in answers)))
        for answers, codes in found.items()
    )


def _master(master: Master, sheets: Told) -> dict[str, Any]:
    taken = [(group, item) for group, item in sheets if not item.refusals]
    columns = [
        (group, [((item.name, item.at), _row(item, found)) for item in found.settings]) for group, found in taken
    ]
    same, tables = _split(columns)
    return {
        "name": master.name,
        "title": text(master.title),
        "settings": same,
        "tables": tables,
        "row_notes": _row_notes(columns, {row[0] for row in same}),
        "refused": list(_refused(sheets)),
        "places": list(_places(taken)),
        "notes": list(_notes(taken)),
        "documents": document_rows(master.documents),
    }


def _row(item: Setting, sheet: Sheet) -> Row:
    """Return a row of name with place, value, note, source."""
    name = text(item.name) + (f" ({text(item.at)})" if item.at else "")
    value = bound(item) + code(item.text) + _mark(item) if item.value is not None else text(item.text)
    return name, value, text(" ".join(filter(None, [item.note, *conditions(item, sheet)]))), text(cited(item.source))


def _places(taken: Told) -> Iterator[Row]:
    """Yield the places of each setting and of each value that a condition needs, once for all order codes."""
    found: dict[tuple[str, str], tuple[Sequence[Place], str, Sequence[MasterDevice]]] = {}
    for _, item in taken:
        devices = item.master.devices
        for setting in item.settings:
            found.setdefault((setting.name, setting.at), (setting.places, setting.text, devices))
        for rule in item.writing:
            for write in (*rule.needs, *rule.then):
                found.setdefault((write.title, ""), (write.places, write.text, devices))
    for (name, _), places in found.items():
        for words in place_words(*places):
            place = ": ".join(filter(None, (words.devices, words.location or "not given")))
            unit = {"": "unit not given", "none": ""}.get(words.unit, words.unit)
            data = ", ".join(filter(None, (words.type or "type not given", unit, words.range)))
            source = f"{words.source}{words.mark}"
            yield tuple(map(text, (name, place, data, words.default or "not given", source)))


def _source(reason: Refusal) -> str:
    return f" \\[{text(cited(reason.source))}\\]" if reason.source else ""


def _mark(rule: Setting | Refusal) -> str:
    """Return the mark of a rule, which is outside the text to copy."""
    found = text(mark(rule))
    return f" {found}" if found else ""


def _row_notes(columns: Columns, same: set[str]) -> list[str]:
    """Return the notes and sources of settings that differ between order codes."""
    rows = [row for _, found in columns for _, row in found if row[0] not in same]
    notes = dict.fromkeys(f"{name}: {note}" for name, _, note, _ in rows if note)
    sources = dict.fromkeys(f"{name} \\[{source}\\]" for name, _, _, source in rows)
    return [*notes, f"Sources: {', '.join(sources)}"]


def _notes(taken: Told) -> Iterator[str]:
    """Yield further notes, with the order codes unless a note applies to all of them."""
    found: dict[str, list[Group]] = {}
    for group, item in taken:
        for note in (*(condition(rule) for rule in item.shared_writing), *item.notes):
            found.setdefault(text(note), []).append(group)
    for note, groups in found.items():
        yield note if len(groups) == len(taken) else f"{_label(groups)}: {note}"


def _refused(sheets: Told) -> Iterator[str]:
    found: dict[str, list[Group]] = {}
    for group, item in sheets:
        if item.refusals:
            reasons = " ".join(f"{text(reason.reason)}{_mark(reason)}{_source(reason)}" for reason in item.refusals)
            found.setdefault(reasons, []).append(group)
    for reasons, groups in found.items():
        yield f"{_label(groups)}: {reasons}"
