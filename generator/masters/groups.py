"""Group the order codes of a family by their settings, and compute the settings of every master for each group.

A sheet lists the settings of one master for one order code, or the reasons why the master cannot use it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from ..model import Device, Interface, Variant, answer_combinations
from ..model.record import dataclass
from .frame_parts import NoRecord
from .record import EncoderFacts, Undecided, record
from .sheet import Master, SettingsSheet, sheet


@dataclass(frozen=True, slots=True)
class CodesWithSameSettings:
    """Order codes that have the same settings in every master."""

    device: Device
    codes: tuple[str, ...]
    record: EncoderFacts


def order_code_groups(device: Device, interface: Interface) -> list[CodesWithSameSettings]:
    """Return the order codes of an interface in groups that have the same settings in every master.

    Two order codes are in the same group if their facts, such as widths and clocks, are equal. An order code whose
    frame depends on a question that the manual leaves open is in one group for each answer.
    """
    records_by_facts: dict[str, list[EncoderFacts]] = {}
    for code_record in records_of(device, interface):
        facts_without_code = repr(replace(code_record, code=""))
        records_by_facts.setdefault(facts_without_code, []).append(code_record)
    return [_build_group(device, records) for records in records_by_facts.values()]


def _build_group(device: Device, records: Sequence[EncoderFacts]) -> CodesWithSameSettings:
    """Return the group of the order codes to which these records, which are equal apart from the code, belong."""
    codes = tuple(code_record.code for code_record in records)
    return CodesWithSameSettings(device, codes, record=records[0])


@dataclass(frozen=True, slots=True)
class GroupSheets:
    """The sheets of each master for the groups of one interface, in the order of the groups."""

    interface: Interface
    groups: tuple[CodesWithSameSettings, ...]
    sheets: tuple[tuple[Master, tuple[SettingsSheet, ...]], ...]


def sheets_of(device: Device, masters: Sequence[Master]) -> tuple[GroupSheets, ...]:
    """Return the settings of each master for the order codes of a family, by interface.

    Interfaces without an order code that masters can read are omitted. The results for the last 32 families are cached,
    because both the pages and the master files need them.
    """
    master_ids = tuple(map(id, masters))
    for family_sheets in _SHEETS_OF_LAST_FAMILIES:
        if family_sheets.device is device and family_sheets.master_ids == master_ids:
            return family_sheets.sheets
    sheets = tuple(_compute_sheets(device, masters))
    _SHEETS_OF_LAST_FAMILIES.append(_FamilySheets(device=device, master_ids=master_ids, sheets=sheets))
    return sheets


class _FamilySheets(NamedTuple):
    """Sheets of a family for the masters with these identities."""

    device: Device
    master_ids: tuple[int, ...]
    sheets: tuple[GroupSheets, ...]


#: Cached sheets of the last families. Families are compared by identity, because comparing their members would take
#: longer than computing the sheets.
_SHEETS_OF_LAST_FAMILIES: deque[_FamilySheets] = deque(maxlen=32)


def _compute_sheets(device: Device, masters: Sequence[Master]) -> Iterator[GroupSheets]:
    """Yield the sheets of each master for the groups of each interface that masters can read."""
    for interface in device.interfaces:
        groups = tuple(order_code_groups(device, interface))
        if groups:
            master_sheets = tuple((master, _sheets_for(master, groups)) for master in masters)
            yield GroupSheets(interface, groups, master_sheets)


def _sheets_for(master: Master, groups: Sequence[CodesWithSameSettings]) -> tuple[SettingsSheet, ...]:
    """Return the sheet of one master for each group of order codes."""
    return tuple(sheet(master, group.record) for group in groups)


def records_of(device: Device, interface: Interface) -> Iterator[EncoderFacts]:
    """Yield the facts about each listed order code of an interface that masters need.

    An order code whose frame depends on a question that the manual leaves open is yielded once for each answer. Order
    codes whose position no master can read are omitted.
    """
    for variant in device.variants_over(interface.name):
        with suppress(NoRecord):
            for code_record in _records_by_answers(device, variant):
                if not code_record.obstacle:
                    yield code_record


def _records_by_answers(device: Device, variant: Variant) -> Iterator[EncoderFacts]:
    """Yield the facts about an order code, once for each answer to questions on which its frame depends.

    If its frame depends on no question, they are yielded once.

    Raises:
        NoRecord: There are no master settings for this order code.
    """
    try:
        yield record(device, variant)
    except Undecided as error:
        deciding_alternatives = device.alternatives_of(error.layout)
        for answers, _ in answer_combinations(deciding_alternatives):
            pairs = zip(deciding_alternatives, answers, strict=True)
            chosen_answers = {alternative.name: answer.name for alternative, answer in pairs}
            yield record(device, variant, answers=chosen_answers)
