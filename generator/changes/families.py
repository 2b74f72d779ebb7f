"""Compare two libraries, family by family."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

from ..model import Device
from .change import Change, Thing
from .compare import section
from .counterparts import note_all
from .family_pair import FamilyPair
from .interfaces import interfaces, timings
from .order_codes import family, order_codes, quantities, supply
from .pairs import Pair, paired
from .registers import procedure, register
from .surroundings import contacts, displayed


def compare(old: Sequence[Device], new: Sequence[Device]) -> list[Change]:
    """Return all changes of all families, by family name and then by descending impact.

    A missing family was renamed if a new one has the same order codes, or if there is only one of each.
    """
    found: list[Change] = []
    pairs = paired(old, new, lambda item: frozenset(variant.code for variant in item.variants))
    if len(old) == len(new) == 1:
        pairs = [Pair(old[0], new[0])]
    for pair in sorted(pairs, key=lambda pair: pair.item.name):
        if pair.old is None or pair.new is None:
            names = (each and each.name for each in (pair.old, pair.new))
            thing = Thing("", f"family {pair.item.name}")
            found += FamilyPair(pair.item, pair.item).presence("family", thing, *names)
        else:
            found += compare_family(pair.old, pair.new)
    return found


def compare_family(old: Device, new: Device) -> list[Change]:
    """Return all changes of a family, by descending impact."""
    both = FamilyPair(old, new)
    note_all(both)
    found = list(
        _merged(
            chain(
                family(both),
                order_codes(both),
                quantities(both),
                section(both, "crc"),
                interfaces(both),
                section(both, "register", register),
                section(both, "alarm"),
                section(both, "procedure", procedure),
                timings(both, Thing("", ""), old.timings, new.timings),
                supply(both, Thing("", ""), old.supply, new.supply),
                section(both, "connector", contacts),
                section(both, "input"),
                displayed(both),
            )
        )
    )
    if not found and _bare(old) != _bare(new):
        thing = Thing("", f"family {new.name}")
        found.append(both.change("order", thing, ": different order, same facts", None, None))
    return sorted(found, key=lambda change: -change.impact)


def _bare(device: Device) -> Device:
    """Return a family without data about the spec itself: number of readings, history and version."""
    maker = replace(device.manufacturer, version="")
    return replace(device, times_read=None, releases=(), manufacturer=maker)


def _merged(changes: Iterable[Change]) -> Iterator[Change]:
    """Return each change once. Changes of a field group in many frames are reported for the group."""
    found: dict[tuple[str, str], Change] = {}
    for change in changes:
        key = (change.rule.name, change.text if change.impact > 1 else change.path)
        first = found.setdefault(key, change)
        if first is not change:
            codes = tuple(dict.fromkeys((*first.codes, *change.codes)))
            if codes != first.codes:
                found[key] = replace(first, codes=codes, reach=f"{first.reach}; {change.reach}")
    yield from found.values()
