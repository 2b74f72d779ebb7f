"""Compare interfaces with their settings, times, data IDs and frames."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Biss, ControlField, DataId, Interface, Layout, Rs485, Timing
from .change import Change, Thing
from .compare import members, things
from .counterparts import recognised
from .family_pair import FamilyPair
from .fields import layout
from .names_in_code import named_in_code
from .pairs import Pair, paired


def interfaces(both: FamilyPair) -> Iterator[Change]:
    yield from things(
        both,
        "interface",
        paired(both.old.interfaces, both.new.interfaces),
        lambda pair: Thing(f"interfaces.{pair.item.name}", pair.item.short, pair.item.name),
        _interface,
    )


def _interface(both: FamilyPair, thing: Thing, old: Interface, new: Interface) -> Iterator[Change]:
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        yield from members(both, thing.inside("port", thing.label), old.port, new.port)
        yield from things(
            both,
            "data-id",
            recognised(both, old.data_ids, new.data_ids),
            lambda pair: _data_id(both, thing, pair),
        )
    elif not isinstance(new, Rs485) and not isinstance(old, Rs485):
        yield from members(both, thing.inside("clock", thing.label), old.clock, new.clock)
    if isinstance(old, Biss) and isinstance(new, Biss):
        found = paired(old.control_data, new.control_data, lambda item: (item.bits, item.crc, len(item.values)))
        yield from things(both, "control-field", found, lambda pair: _control_field(thing, pair), _control_values)
    yield from timings(both, thing, old.timings, new.timings)
    path = f"interfaces.{new.name}.layouts"
    yield from things(
        both,
        "frame",
        recognised(both, old.layouts, new.layouts, new.name),
        lambda pair: named_in_code(both, pair, path, "frame", new.name),
        _frame,
    )


def _data_id(both: FamilyPair, thing: Thing, pair: Pair[DataId]) -> Thing:
    return named_in_code(both, pair, f"{thing.path}.data_ids", "data ID", thing.interface)


def _frame(both: FamilyPair, thing: Thing, old: Layout, new: Layout) -> Iterator[Change]:
    place = thing.unnamed
    yield from layout(both, place, old, new, new.name)
    was = {both.to_new("decision", item.name) for item in both.old.alternatives_of(old)}
    needed = {item.name for item in both.new.alternatives_of(new)}
    inner = place.inside("alternatives", place.label)
    for name in sorted(was - needed):
        yield both.change("frame-decision", inner, f": no longer needs the decision {name}", name, None)
    for name in sorted(needed - was):
        yield both.change("frame-decision", inner, f": needs the decision {name}", None, name)


def _control_field(thing: Thing, pair: Pair[ControlField]) -> Thing:
    return thing.inside(f"control_data.{pair.item.name}", f"control frame: field {pair.item.name}")


def _control_values(both: FamilyPair, thing: Thing, old: ControlField, new: ControlField) -> Iterator[Change]:
    yield from things(
        both,
        "value",
        recognised(both, old.values, new.values),
        lambda pair: thing.inside(pair.item.name, f"control frame: {new.name}: value {pair.item.name}"),
    )


def timings(both: FamilyPair, thing: Thing, olds: tuple[Timing, ...], news: tuple[Timing, ...]) -> Iterator[Change]:
    """Compare times of an interface or of the device."""
    yield from things(
        both,
        "timing",
        recognised(both, olds, news),
        lambda pair: thing.inside(f"timings.{pair.item.name}", f"{thing.label} time {pair.item.name}".strip()),
    )
