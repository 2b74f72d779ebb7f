"""The order codes of a family in groups with the same settings, and the sheets of every master for each group."""

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
    """Return the order codes of an interface in groups, each once for each choice on which its frame depends.

    Order codes are in one group if their records are equal apart from the code.
    """
    records_by_facts: dict[str, list[EncoderFacts]] = {}
    for code_record in records_of(device, interface):
        facts_without_code = repr(replace(code_record, code=""))
        records_by_facts.setdefault(facts_without_code, []).append(code_record)
    return [_build_group(device, records) for records in records_by_facts.values()]


def _build_group(device: Device, records: Sequence[EncoderFacts]) -> CodesWithSameSettings:
    codes = tuple(code_record.code for code_record in records)
    return CodesWithSameSettings(device, codes, record=records[0])


@dataclass(frozen=True, slots=True)
class GroupSheets:
    """The sheets of each master for the groups of one interface, in the order of the groups."""

    interface: Interface
    groups: tuple[CodesWithSameSettings, ...]
    sheets: tuple[tuple[Master, tuple[SettingsSheet, ...]], ...]


def sheets_of(device: Device, masters: Sequence[Master]) -> tuple[GroupSheets, ...]:
    """Return the sheets of each interface whose position masters can read.

    The sheets of the last families are remembered.

    The pages and the files of the masters both need them.
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


#: Sheets of the last families.
#: Families are compared by identity, because comparing their members takes longer than making the sheets.
_SHEETS_OF_LAST_FAMILIES: deque[_FamilySheets] = deque(maxlen=32)


def _compute_sheets(device: Device, masters: Sequence[Master]) -> Iterator[GroupSheets]:
    for interface in device.interfaces:
        groups = tuple(order_code_groups(device, interface))
        if groups:
            master_sheets = tuple((master, _sheets_for(master, groups)) for master in masters)
            yield GroupSheets(interface, groups, master_sheets)


def _sheets_for(master: Master, groups: Sequence[CodesWithSameSettings]) -> tuple[SettingsSheet, ...]:
    return tuple(sheet(master, group.record) for group in groups)


def records_of(device: Device, interface: Interface) -> Iterator[EncoderFacts]:
    """Yield the records of all listed order codes of an interface, once for each choice on which the frame depends.

    Order codes whose position no master can read are left out.
    """
    for variant in device.variants_over(interface.name):
        with suppress(NoRecord):
            for code_record in _records_by_answers(device, variant):
                if not code_record.obstacle:
                    yield code_record


def _records_by_answers(device: Device, variant: Variant) -> Iterator[EncoderFacts]:
    """Yield the record of an order code, once for each choice on which its frame depends.

    Without such a choice, there is one record.

    Raises:
        NoRecord: There is none for this order code.
    """
    try:
        yield record(device, variant)
    except Undecided as error:
        deciding_alternatives = device.alternatives_of(error.layout)
        for answers, _ in answer_combinations(deciding_alternatives):
            pairs = zip(deciding_alternatives, answers, strict=True)
            chosen_answers = {alternative.name: answer.name for alternative, answer in pairs}
            yield record(device, variant, answers=chosen_answers)
