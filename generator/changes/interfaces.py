"""Compare interfaces with their settings, times, data IDs and frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Biss, ControlField, Interface, Layout, LayoutRange, Rs485, Timing
from .change import Change, Thing
from .compare import compared, members, things
from .family_pair import FamilyPair
from .fields import layout
from .pairs import paired


def interfaces(both: FamilyPair) -> Iterator[Change]:
    for pair in paired(both.old.interfaces, both.new.interfaces):
        thing = Thing(f"interfaces.{pair.item.name}", pair.item.short, pair.item.name)
        yield from compared(both, "interface", thing, pair, _interface)


def _interface(both: FamilyPair, thing: Thing, old: Interface, new: Interface) -> Iterator[Change]:
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        yield from members(both, thing.inside("port", thing.label), old.port, new.port)
        yield from things(both, "data-id", old.data_ids, new.data_ids, thing.inside("data_ids", "data ID"))
    elif not isinstance(new, Rs485) and not isinstance(old, Rs485):
        yield from members(both, thing.inside("clock", thing.label), old.clock, new.clock)
    if isinstance(old, Biss) and isinstance(new, Biss):
        place = thing.inside("control_data", "control frame: field")
        yield from things(both, "control-field", old.control_data, new.control_data, place, _control_values)
    yield from timings(both, thing, old.timings, new.timings)
    yield from things(both, "frame", old.layouts, new.layouts, thing.inside("layouts", "frame"), _frame)


def _frame(both: FamilyPair, thing: Thing, old: Layout, new: Layout) -> Iterator[Change]:
    place = thing.unnamed
    yield from layout(both, place, old, new)
    yield from _position_range(both, place, old.position_range, new.position_range)
    was = {both.to_new("decision", item.name) for item in both.old.alternatives_of(old)}
    needed = {item.name for item in both.new.alternatives_of(new)}
    inner = place.inside("alternatives", place.label)
    for name in sorted(was - needed):
        yield both.change("frame-decision", inner, f": no longer needs the decision {name}", name, None)
    for name in sorted(needed - was):
        yield both.change("frame-decision", inner, f": needs the decision {name}", None, name)


def _position_range(
    both: FamilyPair, thing: Thing, old: LayoutRange | None, new: LayoutRange | None
) -> Iterator[Change]:
    """Compare the ranges of a position in one frame. Without its own range, a frame has that of the interface."""
    place = thing.inside("position_range", f"{thing.label}: position range")
    if old is not None and new is not None:
        yield from members(both, place, old, new)
    elif old is not new:
        yield from both.presence("measurement", place, old, new)


def _control_values(both: FamilyPair, thing: Thing, old: ControlField, new: ControlField) -> Iterator[Change]:
    place = replace(thing, label=f"control frame: {new.name}: value")
    yield from things(both, "value", old.values, new.values, place)


def timings(both: FamilyPair, thing: Thing, olds: tuple[Timing, ...], news: tuple[Timing, ...]) -> Iterator[Change]:
    """Compare times of an interface or of the device."""
    yield from things(both, "timing", olds, news, thing.inside("timings", f"{thing.label} time".strip()))
