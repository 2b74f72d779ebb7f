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
    return any(True for interface in device.interfaces for _ in records_of(device, interface))


class MastersPage(TypedDict):
    device: Annotated[Device, "the family"]
    legend: Annotated[str, "meaning of the marks on the page"]
    interfaces: Annotated[list[dict[str, Any]], "interfaces that masters support, with the settings of each master"]


def page_values(device: Device, masters: Sequence[Master]) -> MastersPage:
    parts = [
        (
            group_sheets.interface,
            group_sheets.groups,
            [(master, list(zip(group_sheets.groups, sheets, strict=True))) for master, sheets in group_sheets.sheets],
        )
        for group_sheets in sheets_of(device, masters)
    ]
    sheets = [sheet for _, _, master_sheets in parts for _, rows in master_sheets for _, sheet in rows]
    return {
        "device": device,
        "legend": text(legend(masters, sheets, with_places=True)),
        "interfaces": [_interface(device, *part) for part in parts],
    }


def _interface(
    device: Device, interface: Interface, groups: Sequence[Group], sheets_by_master: Sequence[tuple[Master, Told]]
) -> dict[str, Any]:
    common_rows, tables = _split(
        [(group, [(name, (name, text(value))) for name, value in facts(group.record)]) for group in groups]
    )
    codes = [] if tables else [("Order codes", _label(groups))]
    return {
        "title": interface.title,
        "anchor": interface.name,
        "facts": [*codes, *((text(name), value) for name, value in common_rows)],
        "tables": tables,
        "cable_errata": ", ".join(to_erratum(device, name) for name in groups[0].record.cables.errata),
        "notes": list(dict.fromkeys(text(note) for group in groups for note in group.record.notes)),
        "masters": [_master(master, sheets) for master, sheets in sheets_by_master if interface.name in master.takes],
        "silent": [text(master.title) for master, _ in sheets_by_master if interface.name not in master.takes],
    }


def _split(columns: Columns) -> tuple[list[Row], list[Table]]:
    """Return the rows common to all groups, and tables of the other rows, with a separate table for the supply.

    Each column is a group with its rows by key. The first cell of a row is its name, the second its value.
    """
    keys = list(dict.fromkeys(key for _, rows in columns for key, _ in rows))
    by_key = [(group, dict(rows)) for group, rows in columns]
    common_rows, differing_keys = [], []
    for key in keys:
        key_rows = {rows.get(key) for _, rows in by_key}
        common_row = key_rows.pop()
        if key_rows or common_row is None:
            differing_keys.append(key)
        else:
            common_rows.append(common_row)
    by_supply = [key for key in differing_keys if _follows_supply(key, by_key)]
    parts = ([key for key in differing_keys if key not in by_supply], by_supply)
    return common_rows, [_table(keys, by_key) for keys in parts if keys]


def _follows_supply(key: Any, columns: Sequence[tuple[Group, dict[Any, Row]]]) -> bool:
    rows_by_supply: dict[tuple[int | None, int | None], set[Row | None]] = {}
    for group, rows in columns:
        numbers = group.record.numbers
        rows_by_supply.setdefault((numbers["supply_min_mv"], numbers["supply_max_mv"]), set()).add(rows.get(key))
    return all(len(rows) == 1 for rows in rows_by_supply.values())


def _table(keys: Sequence[Any], columns: Sequence[tuple[Group, dict[Any, Row]]]) -> Table:
    """Return the column heads, and one row for all groups that have the same values."""
    heads = [next(rows[key][0] for _, rows in columns if key in rows) for key in keys]
    groups_by_cells: dict[Row, list[Group]] = {}
    for group, rows in columns:
        groups_by_cells.setdefault(tuple(rows[key][1] if key in rows else "–" for key in keys), []).append(group)
    return {
        "head": ["Order codes", *heads],
        "rows": [[_label(groups), *cells] for cells, groups in groups_by_cells.items()],
    }


def _label(groups: Sequence[Group]) -> str:
    """Return the order codes of all groups, with the answers unless every choice is included."""
    device = groups[0].device
    codes_by_answers: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for group in groups:
        codes_by_answers.setdefault(tuple(group.record.answers.items()), []).extend(group.codes)
    answer_count = prod(
        len(alternative.answers) for alternative in device.alternatives if alternative.name in groups[0].record.answers
    )
    if len(codes_by_answers) == answer_count and len({frozenset(codes) for codes in codes_by_answers.values()}) == 1:
        return order_codes(device, next(iter(codes_by_answers.values())))
    return joined(
        " ".join((order_codes(device, codes), *(f"with {code(f'{name}={answer}')}" for name, answer in answers)))
        for answers, codes in codes_by_answers.items()
    )


def _master(master: Master, sheets: Told) -> dict[str, Any]:
    accepted_sheets = [(group, sheet) for group, sheet in sheets if not sheet.refusals]
    columns = [
        (group, [((setting.name, setting.at), _row(setting, sheet)) for setting in sheet.settings])
        for group, sheet in accepted_sheets
    ]
    common_rows, tables = _split(columns)
    return {
        "name": master.name,
        "title": text(master.title),
        "settings": common_rows,
        "tables": tables,
        "row_notes": _row_notes(columns, {row[0] for row in common_rows}),
        "refused": list(_refused(sheets)),
        "places": list(_places(accepted_sheets)),
        "notes": list(_notes(accepted_sheets)),
        "documents": document_rows(master.documents),
    }


def _row(setting: Setting, sheet: Sheet) -> Row:
    """Return a row of name with place, value, note, source."""
    name = text(setting.name) + (f" ({text(setting.at)})" if setting.at else "")
    value = bound(setting) + code(setting.text) + _mark(setting) if setting.value is not None else text(setting.text)
    return (
        name,
        value,
        text(" ".join(filter(None, [setting.note, *conditions(setting, sheet)]))),
        text(cited(setting.source)),
    )


def _places(group_sheets: Told) -> Iterator[Row]:
    """Yield the places of each setting and of each value that a condition needs, once for all order codes."""
    setting_places: dict[tuple[str, str], tuple[Sequence[Place], str, Sequence[MasterDevice]]] = {}
    for _, sheet in group_sheets:
        devices = sheet.master.devices
        for setting in sheet.settings:
            setting_places.setdefault((setting.name, setting.at), (setting.places, setting.text, devices))
        for rule in sheet.writing:
            for write in (*rule.needs, *rule.then):
                setting_places.setdefault((write.title, ""), (write.places, write.text, devices))
    for (name, _), places in setting_places.items():
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
    rule_mark = text(mark(rule))
    return f" {rule_mark}" if rule_mark else ""


def _row_notes(columns: Columns, common_names: set[str]) -> list[str]:
    """Return the notes and sources of settings that differ between order codes."""
    rows = [row for _, setting_rows in columns for _, row in setting_rows if row[0] not in common_names]
    notes = dict.fromkeys(f"{name}: {note}" for name, _, note, _ in rows if note)
    sources = dict.fromkeys(f"{name} \\[{source}\\]" for name, _, _, source in rows)
    return [*notes, f"Sources: {', '.join(sources)}"]


def _notes(group_sheets: Told) -> Iterator[str]:
    """Yield further notes, with the order codes unless a note applies to all of them."""
    groups_by_note: dict[str, list[Group]] = {}
    for group, sheet in group_sheets:
        for note in (*(condition(rule) for rule in sheet.shared_writing), *sheet.notes):
            groups_by_note.setdefault(text(note), []).append(group)
    for note, groups in groups_by_note.items():
        yield note if len(groups) == len(group_sheets) else f"{_label(groups)}: {note}"


def _refused(sheets: Told) -> Iterator[str]:
    groups_by_reasons: dict[str, list[Group]] = {}
    for group, sheet in sheets:
        if sheet.refusals:
            reasons = " ".join(f"{text(reason.reason)}{_mark(reason)}{_source(reason)}" for reason in sheet.refusals)
            groups_by_reasons.setdefault(reasons, []).append(group)
    for reasons, groups in groups_by_reasons.items():
        yield f"{_label(groups)}: {reasons}"
