"""Pages with the BiSS and SSI master settings for the order codes of a family, one page for each interface."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from math import prod
from typing import Annotated, Any, TypedDict

from ...masters.groups import CodesWithSameSettings, GroupSheets, facts_of_order_codes, sheets_of
from ...masters.sheet import Master, MasterRefusal, Setting, SettingsSheet
from ...masters.text import (
    cited,
    condition_text,
    condition_texts,
    facts_in_words,
    legend_of_marks,
    refusal_text,
    standing_mark,
)
from ...model import Device, Interface, first_or_raise
from ...say.names_and_evidence import grade_below_manual
from ...say.text import Statement, code_span, escape, join_filled, link_list, markdown_link
from .fact_tables import document_rows
from .links_and_errata import link_to_erratum
from .order_code_tables import order_codes

Row = tuple[str, ...]
Table = dict[str, Any]


#: Groups of order codes with their facts. Each fact is a row of name and value, and its key is the name of the fact.
GroupFacts = Sequence[tuple[CodesWithSameSettings, Mapping[str, Row]]]
#: Groups of order codes with their settings for one master.
GroupSettings = Sequence[tuple[CodesWithSameSettings, SettingsSheet]]


def interfaces_with_masters(device: Device) -> list[str]:
    """Return the names of the interfaces over which order codes of the family have settings for masters."""
    return [interface.name for interface in device.interfaces if _has_records(device, interface)]


def _has_records(device: Device, interface: Interface) -> bool:
    """Return whether an order code has the facts that masters need over an interface."""
    return next(facts_of_order_codes(device, interface), None) is not None


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
    links = []
    for interface_name in interfaces_with_masters(device):
        title = device.interface(interface_name).title
        links.append(markdown_link(title, file_name(device, interface_name)))
    return links


def page_values(device: Device, interface_name: str, masters: Sequence[Master]) -> MastersPage:
    """Return the values of the page with the settings of all masters for an interface that has such settings."""
    sheets_of_interface = (
        all_sheets for all_sheets in sheets_of(device, masters) if all_sheets.interface.name == interface_name
    )
    group_sheets = first_or_raise(sheets_of_interface, f"sheets of {interface_name}")
    all_sheets: list[SettingsSheet] = []
    for _, master_sheets in group_sheets.sheets:
        all_sheets += master_sheets
    return {
        "device": device,
        "example": group_sheets.groups[0].codes[0],
        "evidence": list(grade_below_manual(device)),
        "legend": escape(legend_of_marks(masters, all_sheets, with_places=False)),
        "part": _interface_section(device, group_sheets),
    }


def _interface_section(device: Device, group_sheets: GroupSheets) -> dict[str, Any]:
    """Return the facts that masters need over an interface, and a section for each master that supports it.

    ``facts`` are the same for all order codes, and ``tables`` contain the facts that differ between them.
    """
    interface = group_sheets.interface
    # A group has order codes that share all facts. Each master has a sheet of settings for each group.
    groups = group_sheets.groups
    common_rows, tables = _common_rows_and_tables([(group, _fact_rows(group)) for group in groups])
    order_code_rows = [] if tables else [("Order codes", _codes_label(groups))]
    master_sections = []
    unsupporting_masters = []
    for master, sheets in group_sheets.sheets:
        if interface.name in master.supported_interfaces:
            groups_and_sheets = list(zip(groups, sheets, strict=True))
            master_sections.append(_master_section(master, groups_and_sheets))
        else:
            unsupporting_masters.append(escape(master.title))
    master_links = [
        markdown_link(section["title"], f"#{interface.name}-{section['name']}") for section in master_sections
    ]
    # Each note once, in the order of the groups.
    notes = dict.fromkeys(escape(note) for group in groups for note in group.facts.notes)
    return {
        "title": interface.title,
        "anchor": interface.name,
        "facts": [*order_code_rows, *((escape(name), value) for name, value in common_rows)],
        "tables": tables,
        "cable_errata": _links_to_errata(device, groups[0].facts.cable_table.errata),
        "notes": list(notes),
        "masters": master_sections,
        "links": master_links,
        "unsupporting_masters": unsupporting_masters,
    }


def _links_to_errata(device: Device, names: Collection[str]) -> str:
    """Return links to the errata with these names."""
    return link_list(link_to_erratum(device, erratum) for erratum in device.errata if erratum.name in names)


def _fact_rows(group: CodesWithSameSettings) -> dict[str, Row]:
    """Return a row of name and value for each fact about a group of order codes, by the name of the fact."""
    return {name: (name, escape(value)) for name, value in facts_in_words(group.facts)}


def _common_rows_and_tables(group_facts: GroupFacts) -> tuple[list[Row], list[Table]]:
    """Return the facts that all groups of order codes share, and tables of the facts that differ between them.

    Facts that depend only on the supply have a table of their own.
    """
    fact_names: dict[str, None] = {}
    for _, row_by_fact in group_facts:
        fact_names |= dict.fromkeys(row_by_fact)
    common_rows: list[Row] = []
    differing_facts: list[str] = []
    facts_by_supply: list[str] = []
    for fact_name in fact_names:
        first_row, *other_rows = [row_by_fact.get(fact_name) for _, row_by_fact in group_facts]
        is_common = all(row == first_row for row in other_rows)
        if first_row is not None and is_common:
            common_rows.append(first_row)
        elif _depends_only_on_supply(fact_name, group_facts):
            facts_by_supply.append(fact_name)
        else:
            differing_facts.append(fact_name)
    difference_tables = [
        _table_of_differences(names, group_facts) for names in (differing_facts, facts_by_supply) if names
    ]
    return common_rows, difference_tables


def _depends_only_on_supply(fact_name: str, group_facts: GroupFacts) -> bool:
    """Return whether all groups of order codes with the same supply have the same value of a fact."""
    rows_by_supply: dict[tuple[int | None, int | None], set[Row | None]] = {}
    for group, row_by_fact in group_facts:
        numbers = group.facts.numbers
        supply_limits = (numbers["supply_min_mv"], numbers["supply_max_mv"])
        rows_by_supply.setdefault(supply_limits, set()).add(row_by_fact.get(fact_name))
    return all(len(different_rows) == 1 for different_rows in rows_by_supply.values())


def _table_of_differences(fact_names: Sequence[str], group_facts: GroupFacts) -> Table:
    """Return a table with a column for each of these facts, and a row for all groups that have the same values.

    A group without a value has a dash.
    """
    groups_by_cells: dict[Row, list[CodesWithSameSettings]] = {}
    for group, row_by_fact in group_facts:
        cells = tuple(_value_cell(fact_name, row_by_fact) for fact_name in fact_names)
        groups_by_cells.setdefault(cells, []).append(group)
    return {
        "head": ["Order codes", *fact_names],
        "rows": [[_codes_label(groups), *cells] for cells, groups in groups_by_cells.items()],
    }


def _value_cell(fact_name: str, row_by_fact: Mapping[str, Row]) -> str:
    """Return the value of a fact, or a dash if the group of order codes does not have this fact."""
    if fact_name not in row_by_fact:
        return "–"
    _, value = row_by_fact[fact_name]
    return value


def _codes_label(groups: Sequence[CodesWithSameSettings]) -> str:
    """Return the order codes of several groups, with the answers to open questions: ``X-24 with `order=swapped` ``.

    The answers are omitted if the groups have the same order codes for every combination of answers.
    """
    device = groups[0].device
    # Answers as pairs of a question and its answer.
    codes_by_answers: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for group in groups:
        answers = tuple(group.facts.answers.items())
        codes_by_answers.setdefault(answers, []).extend(group.codes)
    answered_questions = groups[0].facts.answers.keys()
    alternatives = [alternative for alternative in device.alternatives if alternative.name in answered_questions]
    combination_count = prod(len(alternative.answers) for alternative in alternatives)
    has_all_combinations = len(codes_by_answers) == combination_count
    different_codes = {frozenset(codes) for codes in codes_by_answers.values()}
    if has_all_combinations and len(different_codes) == 1:
        common_codes = next(iter(codes_by_answers.values()))
        return order_codes(device, common_codes)
    codes_and_answers = []
    for answers, codes in codes_by_answers.items():
        codes_text = order_codes(device, codes)
        for question, answer in answers:
            codes_text += f" with {code_span(f'{question}={answer}')}"
        codes_and_answers.append(codes_text)
    return join_filled(codes_and_answers)


def _master_section(master: Master, groups_and_sheets: GroupSettings) -> dict[str, Any]:
    """Return the section about one master: its settings, notes, unsupported order codes, and the documents it cites."""
    # The reasons why the master does not support the order codes of a group are the refusals of its sheet.
    supported_sheets = [(group, sheet) for group, sheet in groups_and_sheets if not sheet.refusals]
    refusal_lines = list(_refusal_lines(groups_and_sheets))
    notes = [*_setting_notes(supported_sheets), *_further_notes(supported_sheets)]
    # A document is listed if its key, such as "M1", is in the texts.
    texts_with_sources = "\n".join([*refusal_lines, *notes])
    documents = [document for document in master.documents if re.search(rf"\b{document.key}\b", texts_with_sources)]
    return {
        "name": master.name,
        "title": escape(master.title),
        "settings": " · ".join(_setting_names(supported_sheets)),
        "refused": refusal_lines,
        "notes": notes,
        "documents": document_rows(documents),
    }


def _setting_names(group_sheets: GroupSettings) -> list[str]:
    """Return the names of all settings of a master, each once, in the order of the master's description."""
    return list(dict.fromkeys(escape(setting.name) for _, sheet in group_sheets for setting in sheet.settings))


def _setting_notes(group_sheets: GroupSettings) -> Iterator[str]:
    """Yield the notes on settings, with their conditions. Notes that apply only to some order codes name these."""
    groups_by_note: dict[str, list[CodesWithSameSettings]] = {}
    for group, sheet in group_sheets:
        notes = [_setting_note(setting, sheet) for setting in sheet.settings]
        # Equal notes of several settings count once.
        for note in dict.fromkeys(notes):
            if note:
                groups_by_note.setdefault(note, []).append(group)
    return _with_order_codes(groups_by_note, len(group_sheets))


def _setting_note(setting: Setting, sheet: SettingsSheet) -> str:
    """Return the note on a setting with its conditions and its source, or "" if it has neither note nor conditions."""
    note = escape(join_filled([setting.note, *condition_texts(setting, sheet)], " "))
    if not note:
        return ""
    source = f" \\[{escape(cited(setting.source))}\\]"
    # If the last condition has the same source, it is cited only once.
    return f"{escape(setting.name)}: {note.removesuffix(source)}{source}"


def _with_order_codes(groups_by_note: Mapping[str, Sequence[CodesWithSameSettings]], group_count: int) -> Iterator[str]:
    """Yield each note. If it does not apply to all ``group_count`` groups, its order codes follow."""
    for note, groups in groups_by_note.items():
        yield note if len(groups) == group_count else f"{note} This applies to {_codes_label(groups)}."


def _refusal_text(refusal: MasterRefusal) -> str:
    """Return the reason why a master does not support an encoder, with its mark and its source."""
    source = f" \\[{escape(cited(refusal.source))}\\]" if refusal.source else ""
    return f"{escape(refusal.reason)}{_spaced_mark(refusal)}{source}"


def _spaced_mark(rule: Setting | MasterRefusal) -> str:
    """Return the mark that says how certain a rule is, with a space in front of it, or "" without a mark."""
    rule_mark = escape(standing_mark(rule))
    return f" {rule_mark}" if rule_mark else ""


def _further_notes(group_sheets: GroupSettings) -> Iterator[str]:
    """Yield the notes that are not about a single setting. Notes that apply only to some order codes name these.

    They are about gaps in the description of the master, about conditions for several settings, or about all settings.
    """
    groups_by_note: dict[str, list[CodesWithSameSettings]] = {}
    for group, sheet in group_sheets:
        gap_notes = map(refusal_text, sheet.gaps)
        condition_notes = map(condition_text, sheet.shared_writing)
        for note in (*gap_notes, *condition_notes, *sheet.notes):
            groups_by_note.setdefault(escape(note), []).append(group)
    return _with_order_codes(groups_by_note, len(group_sheets))


def _refusal_lines(sheets: GroupSettings) -> Iterator[str]:
    """Yield the order codes that the master does not support, with the reasons. Equal reasons share a line."""
    groups_by_reasons: dict[str, list[CodesWithSameSettings]] = {}
    for group, sheet in sheets:
        if sheet.refusals:
            reasons = " ".join(map(_refusal_text, sheet.refusals))
            groups_by_reasons.setdefault(reasons, []).append(group)
    for reasons, groups in groups_by_reasons.items():
        yield f"{_codes_label(groups)}. {reasons}"
