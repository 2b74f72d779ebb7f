"""Compare two libraries, family by family."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

from ..model import Device
from .change import Change, Subject
from .compare import compare_section
from .counterparts import note_all
from .family_pair import FamilyPair
from .interfaces import contacts, displayed, interfaces, timings
from .order_codes import family, order_codes, quantities, supply
from .pairs import Pair, paired
from .registers import procedure, register


def compare(old: Sequence[Device], new: Sequence[Device]) -> list[Change]:
    """Return all changes of all families, by family name and then by descending impact.

    A missing family was renamed if a new one has the same order codes, or if there is only one of each.
    """
    changes: list[Change] = []
    pairs = paired(old, new, lambda device: frozenset(variant.code for variant in device.variants))
    if len(old) == len(new) == 1:
        pairs = [Pair(old[0], new[0])]
    for pair in sorted(pairs, key=lambda pair: pair.item.name):
        if pair.old is None or pair.new is None:
            names = (device and device.name for device in (pair.old, pair.new))
            subject = Subject("", f"family {pair.item.name}")
            changes += FamilyPair(pair.item, pair.item).presence("family", subject, *names)
        else:
            changes += compare_family(pair.old, pair.new)
    return changes


def compare_family(old: Device, new: Device) -> list[Change]:
    """Return all changes of a family, by descending impact."""
    family_pair = FamilyPair(old, new)
    note_all(family_pair)
    changes = list(
        _merge_repeated(
            chain(
                family(family_pair),
                order_codes(family_pair),
                quantities(family_pair),
                compare_section(family_pair, "crc"),
                interfaces(family_pair),
                compare_section(family_pair, "register", register),
                compare_section(family_pair, "alarm"),
                compare_section(family_pair, "procedure", procedure),
                timings(family_pair, Subject("", ""), old.timings, new.timings),
                supply(family_pair, Subject("", ""), old.supply, new.supply),
                compare_section(family_pair, "connector", contacts),
                compare_section(family_pair, "input"),
                displayed(family_pair),
            )
        )
    )
    if not changes and _without_spec_data(old) != _without_spec_data(new):
        subject = Subject("", f"family {new.name}")
        changes.append(family_pair.change("order", subject, ": different order, same facts", None, None))
    return sorted(changes, key=lambda change: -change.impact)


def _without_spec_data(device: Device) -> Device:
    """Return a family without data about the spec itself: number of readings, history and version."""
    maker = replace(device.manufacturer, version="")
    return replace(device, times_read=None, releases=(), manufacturer=maker)


def _merge_repeated(changes: Iterable[Change]) -> Iterator[Change]:
    """Return each change once. Changes of a field group in many frames are reported for the group."""
    merged: dict[tuple[str, str], Change] = {}
    for change in changes:
        key = (change.rule.name, change.text if change.impact > 1 else change.path)
        earlier_change = merged.setdefault(key, change)
        if earlier_change is not change:
            codes = tuple(dict.fromkeys((*earlier_change.codes, *change.codes)))
            if codes != earlier_change.codes:
                merged[key] = replace(earlier_change, codes=codes, reach=f"{earlier_change.reach}; {change.reach}")
    yield from merged.values()
