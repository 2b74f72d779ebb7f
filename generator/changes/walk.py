"""Compare two libraries, family by family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..model import Device
from . import around, known, talk
from .change import Change, Thing
from .sides import Sides


def compare(old: Sequence[Device], new: Sequence[Device]) -> list[Change]:
    """Return all changes of all families, by family name and then by descending impact.

    A missing family was renamed if a new one has the same order codes, or if there is only one of each.
    """
    found: list[Change] = []
    for before, after in sorted(_pairs(old, new), key=_name):
        if before is None or after is None:
            found += _alone(before, after)
        else:
            found += compare_family(before, after)
    return found


def compare_family(old: Device, new: Device) -> list[Change]:
    """Return all changes of a family, by descending impact."""
    sides = Sides(old, new)
    known.note_all(sides)
    walks = (
        around.family,
        around.order_codes,
        around.quantities,
        talk.crcs,
        talk.interfaces,
        talk.registers,
        around.alarms,
        talk.procedures,
        lambda both: talk.timings(both, Thing("", ""), known.timings(old.timings, new.timings)),
        around.wiring,
        around.told,
    )
    found = list(_merged(change for walk in walks for change in walk(sides)))
    if not found and _bare(old) != _bare(new):
        thing = Thing("", f"family {new.name}")
        found.append(sides.change("order", thing, ": different order, same facts", None, None))
    return sorted(found, key=lambda change: -change.impact)


def _bare(device: Device) -> Device:
    """Return a family without data about the spec itself: number of readings, history and version."""
    maker = replace(device.manufacturer, version="")
    return replace(device, times_read=None, releases=(), manufacturer=maker)


def _pairs(old: Sequence[Device], new: Sequence[Device]) -> Iterator[tuple[Device | None, Device | None]]:
    before, after = ({item.name: item for item in devices} for devices in (old, new))
    left = [item for item in old if item.name not in after]
    fresh = [item for item in new if item.name not in before]
    for device in old:
        if device.name in after:
            yield device, after[device.name]
    for device in list(left):
        codes = {item.code for item in device.variants}
        other = next((item for item in fresh if {variant.code for variant in item.variants} == codes), None)
        if other is None and len(old) == len(new) == 1:
            other = fresh[0]
        if other is not None:
            yield device, other
            left.remove(device)
            fresh.remove(other)
    yield from ((device, None) for device in left)
    yield from ((None, device) for device in fresh)


def _name(pair: tuple[Device | None, Device | None]) -> str:
    return next(item.name for item in reversed(pair) if item is not None)


def _alone(old: Device | None, new: Device | None) -> Iterator[Change]:
    device = new or old
    assert device is not None
    sides = Sides(device, device)
    rule, how = ("family-new", " is new") if old is None else ("family-gone", " is gone")
    names = (None, device.name) if old is None else (device.name, None)
    yield sides.change(rule, Thing("", f"family {device.name}"), how, *names)


def _merged(changes: Iterator[Change]) -> Iterator[Change]:
    """Return each change once. Changes of a field group in many frames are reported for the group."""
    found: dict[tuple[str, str], Change] = {}
    for change in changes:
        key = (change.rule.name, change.text if change.impact > 1 else change.path)
        known_one = found.setdefault(key, change)
        if known_one is not change:
            codes = tuple(dict.fromkeys((*known_one.codes, *change.codes)))
            if codes != known_one.codes:
                found[key] = replace(known_one, codes=codes, reach=f"{known_one.reach}; {change.reach}")
    yield from found.values()
