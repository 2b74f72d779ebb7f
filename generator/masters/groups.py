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
from .encoder_facts import EncoderFacts, Undecided
from .frame_parts import NoMasterSettings
from .order_code_facts import facts_of_order_code
from .sheet import Master, SettingsSheet, sheet


@dataclass(frozen=True, slots=True)
class CodesWithSameSettings:
    """Order codes that have the same settings in every master."""

    device: Device
    codes: tuple[str, ...]
    facts: EncoderFacts


def order_code_groups(device: Device, interface: Interface) -> list[CodesWithSameSettings]:
    """Return the order codes of an interface in groups that have the same settings in every master.

    Two order codes are in the same group if their facts, such as widths and clocks, are equal. An order code whose
    frame depends on a question that the manual leaves open is in one group for each answer.
    """
    facts_by_text: dict[str, list[EncoderFacts]] = {}
    for code_facts in facts_of_order_codes(device, interface):
        text_without_code = repr(replace(code_facts, code=""))
        facts_by_text.setdefault(text_without_code, []).append(code_facts)
    return [_build_group(device, equal_facts) for equal_facts in facts_by_text.values()]


def _build_group(device: Device, equal_facts: Sequence[EncoderFacts]) -> CodesWithSameSettings:
    """Return the group of the order codes with these facts, which are equal apart from the order code."""
    codes = tuple(code_facts.code for code_facts in equal_facts)
    return CodesWithSameSettings(device, codes, facts=equal_facts[0])


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
    return tuple(sheet(master, group.facts) for group in groups)


def facts_of_order_codes(device: Device, interface: Interface) -> Iterator[EncoderFacts]:
    """Yield the facts about each listed order code of an interface that masters need.

    An order code whose frame depends on a question that the manual leaves open is yielded once for each answer. Order
    codes whose position no master can read are omitted.
    """
    for variant in device.variants_over(interface.name):
        with suppress(NoMasterSettings):
            for code_facts in _facts_by_answers(device, variant):
                if not code_facts.obstacle:
                    yield code_facts


def _facts_by_answers(device: Device, variant: Variant) -> Iterator[EncoderFacts]:
    """Yield the facts about an order code, once for each answer to questions on which its frame depends.

    If its frame depends on no question, they are yielded once.

    Raises:
        NoMasterSettings: There are no master settings for this order code.
    """
    try:
        yield facts_of_order_code(device, variant)
    except Undecided as error:
        deciding_alternatives = device.alternatives_of(error.layout)
        for answers, _ in answer_combinations(deciding_alternatives):
            pairs = zip(deciding_alternatives, answers, strict=True)
            chosen_answers = {alternative.name: answer.name for alternative, answer in pairs}
            yield facts_of_order_code(device, variant, answers=chosen_answers)
