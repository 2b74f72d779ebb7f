"""Page of the BiSS and SSI master settings for the order codes of a family."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from math import prod
from typing import Annotated, Any, TypedDict

from ...masters.places import MasterDevice, Place, place_words
from ...masters.sheet import Group, GroupSheets, Master, Refusal, Setting, Sheet, records_of, sheets_of
from ...masters.text import (
    bound_in_words,
    cited,
    condition_text,
    condition_texts,
    facts,
    legend,
    refusal_text,
    standing_mark,
)
from ...model import Device, Interface
from ...say.markdown import code, joined, link_list, text
from .fact_tables import document_rows
from .order_code_tables import order_codes
from .page_links import link_to_erratum

Row = tuple[str, ...]
Table = dict[str, Any]


#: Groups of order codes, each with its rows, which are keyed by setting.
Columns = Sequence[tuple[Group, Mapping[Any, Row]]]
#: Settings of one master for each group.
GroupSettings = Sequence[tuple[Group, Sheet]]


def has_masters(device: Device) -> bool:
    """Return whether an order code of the family has settings for masters."""
    return any(map(partial(_has_records, device), device.interfaces))


def _has_records(device: Device, interface: Interface) -> bool:
    return next(records_of(device, interface), None) is not None


class MastersPage(TypedDict):
    device: Annotated[Device, "the family"]
    legend: Annotated[str, "meaning of the marks on the page"]
    interfaces: Annotated[list[dict[str, Any]], "interfaces that masters support, with the settings of each master"]


def page_values(device: Device, masters: Sequence[Master]) -> MastersPage:
    interface_sheets = sheets_of(device, masters)
    sheets: list[Sheet] = []
    for group_sheets in interface_sheets:
        for _, master_sheets in group_sheets.sheets:
            sheets += master_sheets
    return {
        "device": device,
        "legend": text(legend(masters, sheets, with_places=True)),
        "interfaces": [_interface_section(device, group_sheets) for group_sheets in interface_sheets],
    }


def _interface_section(device: Device, group_sheets: GroupSheets) -> dict[str, Any]:
    interface, groups = group_sheets.interface, group_sheets.groups
    common_rows, tables = _common_rows_and_tables([(group, _fact_rows(group)) for group in groups])
    order_code_rows = [] if tables else [("Order codes", _codes_label(groups))]
    master_sections = []
    unsupporting_masters = []
    for master, sheets in group_sheets.sheets:
        if interface.name in master.takes:
            master_sections.append(_master_section(master, list(zip(groups, sheets, strict=True))))
        else:
            unsupporting_masters.append(text(master.title))
    return {
        "title": interface.title,
        "anchor": interface.name,
        "facts": [*order_code_rows, *((text(name), value) for name, value in common_rows)],
        "tables": tables,
        "cable_errata": _links_to_errata(device, groups[0].record.cables.errata),
        "notes": list(dict.fromkeys(text(note) for group in groups for note in group.record.notes)),
        "masters": master_sections,
        "silent": unsupporting_masters,
    }


def _links_to_errata(device: Device, names: Collection[str]) -> str:
    """Return links to the errata with these names."""
    return link_list(link_to_erratum(device, erratum) for erratum in device.errata if erratum.name in names)


def _fact_rows(group: Group) -> dict[Any, Row]:
    return {name: (name, text(value)) for name, value in facts(group.record)}


def _common_rows_and_tables(columns: Columns) -> tuple[list[Row], list[Table]]:
    """Return the rows common to all groups, and tables of the other rows, with a separate table for the supply.

    Each column is a group with its rows by key. The first cell of a row is its name, the second its value.
    """
    keys = dict.fromkeys(key for _, rows in columns for key in rows)
    common_rows: list[Row] = []
    differing_keys, supply_keys = [], []
    for key in keys:
        different_rows = {rows.get(key) for _, rows in columns}
        row = different_rows.pop()
        if row is not None and not different_rows:
            common_rows.append(row)
        elif _follows_supply(key, columns):
            supply_keys.append(key)
        else:
            differing_keys.append(key)
    tables = [_table_of_differences(keys, columns) for keys in (differing_keys, supply_keys) if keys]
    return common_rows, tables


def _follows_supply(key: Any, columns: Columns) -> bool:
    """Return whether all groups with the same supply have the same row."""
    rows_by_supply: dict[tuple[int | None, int | None], set[Row | None]] = {}
    for group, rows in columns:
        numbers = group.record.numbers
        rows_by_supply.setdefault((numbers["supply_min_mv"], numbers["supply_max_mv"]), set()).add(rows.get(key))
    return all(len(rows) == 1 for rows in rows_by_supply.values())


def _table_of_differences(keys: Sequence[Any], columns: Columns) -> Table:
    """Return the column heads, and one row for all groups that have the same values."""
    heads = [_row_name(key, columns) for key in keys]
    groups_by_cells: dict[Row, list[Group]] = {}
    for group, rows in columns:
        cells = tuple(_value_cell(key, rows) for key in keys)
        groups_by_cells.setdefault(cells, []).append(group)
    return {
        "head": ["Order codes", *heads],
        "rows": [[_codes_label(groups), *cells] for cells, groups in groups_by_cells.items()],
    }


def _row_name(key: Any, columns: Columns) -> str:
    return next(rows[key][0] for _, rows in columns if key in rows)


def _value_cell(key: Any, rows: Mapping[Any, Row]) -> str:
    return rows[key][1] if key in rows else "–"


def _codes_label(groups: Sequence[Group]) -> str:
    """Return the order codes of all groups, with the answers unless every choice is included."""
    device = groups[0].device
    codes_by_answers: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for group in groups:
        codes_by_answers.setdefault(tuple(group.record.answers.items()), []).extend(group.codes)
    record_answers = groups[0].record.answers
    alternatives = [alternative for alternative in device.alternatives if alternative.name in record_answers]
    choice_count = prod(len(alternative.answers) for alternative in alternatives)
    different_codes = {frozenset(codes) for codes in codes_by_answers.values()}
    if len(codes_by_answers) == choice_count and len(different_codes) == 1:
        return order_codes(device, next(iter(codes_by_answers.values())))
    labels = []
    for answers, codes in codes_by_answers.items():
        with_answers = [f"with {code(f'{name}={answer}')}" for name, answer in answers]
        labels.append(" ".join([order_codes(device, codes), *with_answers]))
    return joined(labels)


def _master_section(master: Master, sheets: GroupSettings) -> dict[str, Any]:
    accepted_sheets = [(group, sheet) for group, sheet in sheets if not sheet.refusals]
    columns = [(group, _setting_rows(sheet)) for group, sheet in accepted_sheets]
    common_rows, tables = _common_rows_and_tables(columns)
    return {
        "name": master.name,
        "title": text(master.title),
        "settings": common_rows,
        "tables": tables,
        "row_notes": _row_notes(columns, {row[0] for row in common_rows}),
        "refused": list(_refusal_lines(sheets)),
        "places": list(_place_rows(accepted_sheets)),
        "notes": list(_further_notes(accepted_sheets)),
        "documents": document_rows(master.documents),
    }


def _setting_rows(sheet: Sheet) -> dict[Any, Row]:
    """Return the row of each setting, keyed by its name and place."""
    return {(setting.name, setting.at): _setting_row(setting, sheet) for setting in sheet.settings}


def _setting_row(setting: Setting, sheet: Sheet) -> Row:
    """Return a row of name with place, value, note, source."""
    name = text(setting.name) + (f" ({text(setting.at)})" if setting.at else "")
    value = text(setting.text)
    if setting.value is not None:
        value = f"{bound_in_words(setting)}{code(setting.text)}{_spaced_mark(setting)}"
    note = " ".join(filter(None, [setting.note, *condition_texts(setting, sheet)]))
    return name, value, text(note), text(cited(setting.source))


def _place_rows(group_sheets: GroupSettings) -> Iterator[Row]:
    """Yield the places of each setting and of each value that a condition needs, once for all order codes."""
    setting_places: dict[tuple[str, str], tuple[Sequence[Place], str, Sequence[MasterDevice]]] = {}
    for _, sheet in group_sheets:
        devices = sheet.master.devices
        for setting in sheet.settings:
            setting_places.setdefault((setting.name, setting.at), (setting.places, setting.text, devices))
        for rule in sheet.writing:
            for write in (*rule.needs, *rule.then):
                setting_places.setdefault((write.title, ""), (write.places, write.text, devices))
    for (name, _), (places, value, master_devices) in setting_places.items():
        for words in place_words(places, value, master_devices):
            location = ": ".join(filter(None, (words.devices, words.location or "not given")))
            unit = {"": "unit not given", "none": ""}.get(words.unit, words.unit)
            data = ", ".join(filter(None, (words.type or "type not given", unit, words.range)))
            source = f"{words.source}{words.mark}"
            yield tuple(map(text, (name, location, data, words.default or "not given", source)))


def _refusal_text(refusal: Refusal) -> str:
    source = f" \\[{text(cited(refusal.source))}\\]" if refusal.source else ""
    return f"{text(refusal.reason)}{_spaced_mark(refusal)}{source}"


def _spaced_mark(rule: Setting | Refusal) -> str:
    """Return the mark of a rule, which is outside the text to copy."""
    rule_mark = text(standing_mark(rule))
    return f" {rule_mark}" if rule_mark else ""


def _row_notes(columns: Columns, common_names: set[str]) -> list[str]:
    """Return the notes and sources of settings that differ between order codes."""
    rows = [row for _, setting_rows in columns for row in setting_rows.values() if row[0] not in common_names]
    notes = dict.fromkeys(f"{name}: {note}" for name, _, note, _ in rows if note)
    sources = dict.fromkeys(f"{name} \\[{source}\\]" for name, _, _, source in rows)
    return [*notes, f"Sources: {', '.join(sources)}"]


def _further_notes(group_sheets: GroupSettings) -> Iterator[str]:
    """Yield further notes, with the order codes unless a note applies to all of them."""
    groups_by_note: dict[str, list[Group]] = {}
    for group, sheet in group_sheets:
        gaps = (refusal_text(gap) for gap in sheet.gaps)
        for note in (*gaps, *(condition_text(rule) for rule in sheet.shared_writing), *sheet.notes):
            groups_by_note.setdefault(text(note), []).append(group)
    for note, groups in groups_by_note.items():
        applies_to_all = len(groups) == len(group_sheets)
        yield note if applies_to_all else f"{_codes_label(groups)}: {note}"


def _refusal_lines(sheets: GroupSettings) -> Iterator[str]:
    """Yield the order codes that the master cannot use, with the reasons."""
    groups_by_reasons: dict[str, list[Group]] = {}
    for group, sheet in sheets:
        if sheet.refusals:
            reasons = " ".join(map(_refusal_text, sheet.refusals))
            groups_by_reasons.setdefault(reasons, []).append(group)
    for reasons, groups in groups_by_reasons.items():
        yield f"{_codes_label(groups)}: {reasons}"
