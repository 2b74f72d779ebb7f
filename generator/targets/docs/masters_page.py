"""Pages of the BiSS and SSI master settings for the order codes of a family, one for each interface."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from math import prod
from typing import Annotated, Any, TypedDict

from ...masters.groups import CodesWithSameSettings, GroupSheets, records_of, sheets_of
from ...masters.sheet import Master, MasterRefusal, Setting, SettingsSheet
from ...masters.text import (
    cited,
    condition_text,
    condition_texts,
    legend_of_marks,
    record_facts,
    refusal_text,
    standing_mark,
)
from ...model import Device, Interface, first_or_raise
from ...say.evidence import grade_below_manual
from ...say.markdown import code_span, escape, join_filled, link_list, markdown_link
from ...say.text import Statement
from .fact_tables import document_rows
from .order_code_tables import order_codes
from .page_links import link_to_erratum

Row = tuple[str, ...]
Table = dict[str, Any]


#: Groups of order codes, each with its rows by the name of the fact. A row consists of the name and the value.
Columns = Sequence[tuple[CodesWithSameSettings, Mapping[Any, Row]]]
#: Settings of one master for each group.
GroupSettings = Sequence[tuple[CodesWithSameSettings, SettingsSheet]]


def kinds_with_masters(device: Device) -> list[str]:
    """Return the kinds of interface for which an order code of the family has settings for masters."""
    return [interface.name for interface in device.interfaces if _has_records(device, interface)]


def _has_records(device: Device, interface: Interface) -> bool:
    return next(records_of(device, interface), None) is not None


class MastersPage(TypedDict):
    device: Annotated[Device, "the family"]
    evidence: Annotated[list[Statement], "grade of the evidence, unless the whole manual was read"]
    legend: Annotated[str, "meaning of the marks on the page"]
    example: Annotated[str, "an order code that masters support"]
    part: Annotated[dict[str, Any], "facts of the interface, with the settings of each master"]


def file_name(device: Device, interface_name: str) -> str:
    """Return the name of the page with the master settings of an interface."""
    return f"{device.name}-{interface_name}-masters.md"


def page_links(device: Device) -> list[str]:
    """Return a link to the page of each interface that has settings for masters."""
    kinds = kinds_with_masters(device)
    return [markdown_link(device.interface(kind).title, file_name(device, kind)) for kind in kinds]


def page_values(device: Device, interface_name: str, masters: Sequence[Master]) -> MastersPage:
    """Return the values of the page with the settings of all masters for an interface, which has such settings."""
    interface_sheets = sheets_of(device, masters)
    group_sheets = first_or_raise(
        (group for group in interface_sheets if group.interface.name == interface_name), f"sheets of {interface_name}"
    )
    sheets: list[SettingsSheet] = []
    for _, master_sheets in group_sheets.sheets:
        sheets += master_sheets
    return {
        "device": device,
        "example": group_sheets.groups[0].codes[0],
        "evidence": list(grade_below_manual(device)),
        "legend": escape(legend_of_marks(masters, sheets, with_places=False)),
        "part": _interface_section(device, group_sheets),
    }


def _interface_section(device: Device, group_sheets: GroupSheets) -> dict[str, Any]:
    """Return the facts that masters need over an interface, and the settings of each master.

    ``tables`` contains the facts that differ between order codes. ``silent`` lists the masters without this interface.
    """
    interface = group_sheets.interface
    # Each group is a record of facts with the order codes that share it. A master has a sheet for each group.
    groups = group_sheets.groups
    common_rows, tables = _common_rows_and_tables([(group, _fact_rows(group)) for group in groups])
    order_code_rows = [] if tables else [("Order codes", _codes_label(groups))]
    master_sections = []
    unsupporting_masters = []
    for master, sheets in group_sheets.sheets:
        if interface.name in master.takes:
            master_sections.append(_master_section(master, list(zip(groups, sheets, strict=True))))
        else:
            unsupporting_masters.append(escape(master.title))
    return {
        "title": interface.title,
        "anchor": interface.name,
        "facts": [*order_code_rows, *((escape(name), value) for name, value in common_rows)],
        "tables": tables,
        "cable_errata": _links_to_errata(device, groups[0].record.cables.errata),
        "notes": list(dict.fromkeys(escape(note) for group in groups for note in group.record.notes)),
        "masters": master_sections,
        "links": [
            markdown_link(section["title"], f"#{interface.name}-{section['name']}") for section in master_sections
        ],
        "silent": unsupporting_masters,
    }


def _links_to_errata(device: Device, names: Collection[str]) -> str:
    """Return links to the errata with these names."""
    return link_list(link_to_erratum(device, erratum) for erratum in device.errata if erratum.name in names)


def _fact_rows(group: CodesWithSameSettings) -> dict[Any, Row]:
    return {name: (name, escape(value)) for name, value in record_facts(group.record)}


def _common_rows_and_tables(columns: Columns) -> tuple[list[Row], list[Table]]:
    """Return the rows common to all groups, and tables of the other rows: one for rows that depend only on the supply.

    Each column is a group with its rows by key. The first cell of a row is its name, the second its value.
    """
    setting_keys: dict[Any, None] = {}
    for _, rows_of_group in columns:
        setting_keys |= dict.fromkeys(rows_of_group)
    common_rows: list[Row] = []
    differing_keys: list[Any] = []
    supply_keys: list[Any] = []
    for setting_key in setting_keys:
        first_row, *other_rows = [rows_of_group.get(setting_key) for _, rows_of_group in columns]
        is_common = all(row == first_row for row in other_rows)
        if first_row is not None and is_common:
            common_rows.append(first_row)
        elif _follows_supply(setting_key, columns):
            supply_keys.append(setting_key)
        else:
            differing_keys.append(setting_key)
    tables = [_table_of_differences(table_keys, columns) for table_keys in (differing_keys, supply_keys) if table_keys]
    return common_rows, tables


def _follows_supply(fact_key: Any, columns: Columns) -> bool:
    """Return whether all groups with the same supply have the same row."""
    rows_by_supply: dict[tuple[int | None, int | None], set[Row | None]] = {}
    for group, rows in columns:
        numbers = group.record.numbers
        supply = (numbers["supply_min_mv"], numbers["supply_max_mv"])
        rows_by_supply.setdefault(supply, set()).add(rows.get(fact_key))
    return all(len(rows) == 1 for rows in rows_by_supply.values())


def _table_of_differences(keys: Sequence[Any], columns: Columns) -> Table:
    """Return the column heads, and one row for all groups with the same values.

    A group without a value has a dash.
    """
    heads = [_row_name(key, columns) for key in keys]
    groups_by_cells: dict[Row, list[CodesWithSameSettings]] = {}
    for group, rows in columns:
        cells = tuple(_value_cell(key, rows) for key in keys)
        groups_by_cells.setdefault(cells, []).append(group)
    return {
        "head": ["Order codes", *heads],
        "rows": [[_codes_label(groups), *cells] for cells, groups in groups_by_cells.items()],
    }


def _row_name(fact_key: Any, columns: Columns) -> str:
    """Return the name of a fact: the first cell of its row in the first group that has it."""
    name, _ = next(rows[fact_key] for _, rows in columns if fact_key in rows)
    return name


def _value_cell(fact_key: Any, rows: Mapping[Any, Row]) -> str:
    """Return the value of a fact, or a dash if the group lacks it."""
    if fact_key not in rows:
        return "–"
    _, value = rows[fact_key]
    return value


def _codes_label(groups: Sequence[CodesWithSameSettings]) -> str:
    """Return the order codes of all groups, with the answers: ``X-24 with `order=swapped` ``.

    Answers are left out if the groups have the same order codes for every combination of answers.
    """
    device = groups[0].device
    codes_by_answers: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for group in groups:
        codes_by_answers.setdefault(tuple(group.record.answers.items()), []).extend(group.codes)
    record_answers = groups[0].record.answers
    alternatives = [alternative for alternative in device.alternatives if alternative.name in record_answers]
    number_of_combinations = prod(len(alternative.answers) for alternative in alternatives)
    different_codes = {frozenset(codes) for codes in codes_by_answers.values()}
    has_all_combinations = len(codes_by_answers) == number_of_combinations
    if has_all_combinations and len(different_codes) == 1:
        return order_codes(device, next(iter(codes_by_answers.values())))
    labels = []
    for answers, codes in codes_by_answers.items():
        with_answers = [f"with {code_span(f'{question_name}={answer}')}" for question_name, answer in answers]
        labels.append(" ".join([order_codes(device, codes), *with_answers]))
    return join_filled(labels)


def _master_section(master: Master, sheets: GroupSettings) -> dict[str, Any]:
    """Return the settings of one master for all groups of order codes.

    It lists the documents whose keys are in the texts.
    """
    accepted_sheets = [(group, sheet) for group, sheet in sheets if not sheet.refusals]
    refused = list(_refusal_lines(sheets))
    notes = [*_setting_notes(accepted_sheets), *_further_notes(accepted_sheets)]
    cited_texts = "\n".join([*refused, *notes])
    documents = [document for document in master.documents if re.search(rf"\b{document.key}\b", cited_texts)]
    return {
        "name": master.name,
        "title": escape(master.title),
        "settings": " · ".join(_setting_names(accepted_sheets)),
        "refused": refused,
        "notes": notes,
        "documents": document_rows(documents),
    }


def _setting_names(group_sheets: GroupSettings) -> list[str]:
    """Return the names of all settings, in the order of the description of the master."""
    return list(dict.fromkeys(escape(setting.name) for _, sheet in group_sheets for setting in sheet.settings))


def _setting_notes(group_sheets: GroupSettings) -> Iterator[str]:
    """Yield the notes on settings and their conditions, with the order codes unless a note applies to all of them."""
    groups_by_note: dict[str, list[CodesWithSameSettings]] = {}
    for group, sheet in group_sheets:
        notes = filter(None, (_setting_note(setting, sheet) for setting in sheet.settings))
        for note in dict.fromkeys(notes):
            groups_by_note.setdefault(note, []).append(group)
    return _with_order_codes(groups_by_note, len(group_sheets))


def _setting_note(setting: Setting, sheet: SettingsSheet) -> str:
    """Return the note on a setting with its conditions and its source, or "" without a note and conditions."""
    note = escape(" ".join(filter(None, [setting.note, *condition_texts(setting, sheet)])))
    source = f" \\[{escape(cited(setting.source))}\\]"
    # The last condition may have the same source.
    return f"{escape(setting.name)}: {note.removesuffix(source)}{source}" if note else ""


def _with_order_codes(groups_by_note: Mapping[str, Sequence[CodesWithSameSettings]], group_count: int) -> Iterator[str]:
    """Yield each note, after its order codes unless it applies to all groups."""
    for note, groups in groups_by_note.items():
        yield note if len(groups) == group_count else f"{_codes_label(groups)}: {note}"


def _refusal_text(refusal: MasterRefusal) -> str:
    source = f" \\[{escape(cited(refusal.source))}\\]" if refusal.source else ""
    return f"{escape(refusal.reason)}{_spaced_mark(refusal)}{source}"


def _spaced_mark(rule: Setting | MasterRefusal) -> str:
    """Return the mark of a rule, which is outside the text to copy."""
    rule_mark = escape(standing_mark(rule))
    return f" {rule_mark}" if rule_mark else ""


def _further_notes(group_sheets: GroupSettings) -> Iterator[str]:
    """Yield the notes that belong to no single setting, with the order codes unless one applies to all.

    They are about gaps in the description of the master, about conditions for several settings, or of the sheet.
    """
    groups_by_note: dict[str, list[CodesWithSameSettings]] = {}
    for group, sheet in group_sheets:
        gaps = (refusal_text(gap) for gap in sheet.gaps)
        for note in (*gaps, *(condition_text(rule) for rule in sheet.shared_writing), *sheet.notes):
            groups_by_note.setdefault(escape(note), []).append(group)
    return _with_order_codes(groups_by_note, len(group_sheets))


def _refusal_lines(sheets: GroupSettings) -> Iterator[str]:
    """Yield the order codes that the master cannot use, with the reasons. Codes with the same reasons share a line."""
    groups_by_reasons: dict[str, list[CodesWithSameSettings]] = {}
    for group, sheet in sheets:
        if sheet.refusals:
            reasons = " ".join(map(_refusal_text, sheet.refusals))
            groups_by_reasons.setdefault(reasons, []).append(group)
    for reasons, groups in groups_by_reasons.items():
        yield f"{_codes_label(groups)}: {reasons}"
