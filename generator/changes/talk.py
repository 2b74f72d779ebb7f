"""Compare communication: interfaces, frames, registers, CRCs and procedures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields as members_of
from dataclasses import replace
from typing import Any

from ..model import Biss, Crc, CrcValue, Device, Interface, Procedure, Register, Rs485, Step, Timing
from ..say.place import register_at
from . import frames, known, names
from .change import Change, Thing
from .compare import members
from .pairs import Pair
from .shown import arrow, plain, shown
from .sides import Sides

_CAN_READ, _CAN_WRITE = ("read_only", "read_write"), ("write_only", "read_write")


def interfaces(sides: Sides) -> Iterator[Change]:
    for pair in known.named(sides.old.interfaces, sides.new.interfaces, known.nothing):
        item = pair.new or pair.old
        assert item is not None
        thing = Thing(f"interfaces.{item.name}", item.short, item.name)
        yield from sides.presence("interface", thing, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from _interface(sides, thing, pair.old, pair.new)


def _interface(sides: Sides, thing: Thing, old: Interface, new: Interface) -> Iterator[Change]:
    yield from members(sides, thing, old, new)
    if not isinstance(new, Rs485) and not isinstance(old, Rs485):
        yield from members(sides, thing.inside("clock", thing.label), old.clock, new.clock)
    if isinstance(new, Rs485) and isinstance(old, Rs485):
        yield from members(sides, thing.inside("port", thing.label), old.port, new.port)
    for data_id in known.data_ids(old, new):
        item = data_id.new or data_id.old
        assert item is not None
        place = names.data_id(sides.new, new.name, item)
        place = place if data_id.old is None else replace(place, c=names.data_id(sides.old, new.name, data_id.old).c)
        yield from sides.presence("data-id", place, data_id.old, data_id.new)
        if data_id.old is not None and data_id.new is not None:
            yield from members(sides, replace(place, c="", python=""), data_id.old, data_id.new)
    yield from _control(sides, thing, old, new)
    yield from timings(sides, thing, known.timings(old.timings, new.timings))
    for pair in known.layouts(sides, old, new):
        layout = pair.old or pair.new
        assert layout is not None
        place = names.frame(sides.new if pair.old is None else sides.old, new.name, layout)
        if pair.new is not None:
            now = names.frame(sides.new, new.name, pair.new)
            place = replace(place, label=now.label, path=now.path)
        yield from sides.presence("frame", _called(place, pair.old), pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            place = replace(place, c="", python="")
            yield from frames.layout(sides, place, pair.old, pair.new, pair.new.name)
            was = {sides.to_new("decision", item.name) for item in sides.old.alternatives_of(pair.old)}
            needed = {item.name for item in sides.new.alternatives_of(pair.new)}
            yield from _decisions(sides, place, was, needed)


def _called(thing: Thing, old: object) -> Thing:
    """Return the thing, without its names in code if it is new."""
    return thing if old is not None else replace(thing, c="", python="")


def _decisions(sides: Sides, place: Thing, was: set[str], now: set[str]) -> Iterator[Change]:
    inner = replace(place, path=f"{place.path}.alternatives")
    for name in sorted(was - now):
        yield sides.change("frame-decision", inner, f": no longer needs the decision {name}", name, None)
    for name in sorted(now - was):
        yield sides.change("frame-decision", inner, f": needs the decision {name}", None, name)


def _control(sides: Sides, thing: Thing, old: Interface, new: Interface) -> Iterator[Change]:
    if not (isinstance(old, Biss) and isinstance(new, Biss)):
        return
    for pair in known.control_fields(old, new):
        item = pair.new or pair.old
        assert item is not None
        place = thing.inside(f"control_data.{item.name}", f"control frame: field {item.name}")
        yield from sides.presence("control-field", place, pair.old, pair.new)
        if pair.old is None or pair.new is None:
            continue
        yield from members(sides, place, pair.old, pair.new)
        for value in known.named(pair.old.values, pair.new.values, lambda part: part.value):
            part = value.new or value.old
            assert part is not None
            inner = place.inside(part.name, f"control frame: {item.name}: value {part.name}")
            yield from sides.presence("value", inner, value.old, value.new)
            if value.old is not None and value.new is not None:
                yield from members(sides, inner, value.old, value.new)


def timings(sides: Sides, thing: Thing, found: list[Pair[Timing]]) -> Iterator[Change]:
    """Compare times of an interface or of the device."""
    for pair in found:
        item = pair.new or pair.old
        assert item is not None
        path = f"{thing.path}.timings.{item.name}" if thing.path else f"timings.{item.name}"
        place = Thing(path, f"{thing.label} time {item.name}".strip(), thing.interface)
        yield from sides.presence("timing", place, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, place, pair.old, pair.new)


def registers(sides: Sides) -> Iterator[Change]:
    for pair in known.registers(sides):
        item = pair.old or pair.new
        assert item is not None
        label = f"{register_at(item)} {(pair.new or item).name}"
        place = names.register(sides.old if pair.old is not None else sides.new, item, label)
        yield from sides.presence("register", _called(place, pair.old), pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from _register(sides, names.register(sides.new, pair.new, label), pair.old, pair.new)


def _register(sides: Sides, place: Thing, old: Register, new: Register) -> Iterator[Change]:
    bare = replace(place, c="", python="")
    yield from members(sides, bare, old, new, new.name)
    if old.access != new.access:
        lost = any(old.access in can and new.access not in can for can in (_CAN_READ, _CAN_WRITE))
        access = f": {_words(old.access)} → {_words(new.access)}"
        inner = replace(place if lost else bare, path=f"{place.path}.access")
        yield sides.change("access-lost" if lost else "access-gained", inner, access, old.access, new.access)
    for pair in known.named(old.meanings, new.meanings, lambda item: (item.when, item.value)):
        item = pair.new or pair.old
        assert item is not None
        inner = bare.inside(item.name, f"{place.label}: meaning {item.name}")
        yield from sides.presence("meaning", inner, pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, inner, pair.old, pair.new)
    # The bits of a register follow from its length in bytes, which is compared separately.
    layout = replace(old.layout, **{name: getattr(new.layout, name) for name in ("name", "bits", "byte_order", "note")})
    layout = replace(layout, **{name: getattr(new.layout, name) for name in ("printed_name", "source")})
    yield from frames.layout(sides, bare, layout, new.layout, new.name)


def _words(access: str) -> str:
    return access.replace("_", " ")


def crcs(sides: Sides) -> Iterator[Change]:
    for pair in known.crcs(sides.old.crcs, sides.new.crcs):
        item = pair.old or pair.new
        assert item is not None
        device = sides.old if pair.old is not None else sides.new
        place = names.crc(device, item, _interface_of(device, item))
        if pair.new is not None:
            place = replace(place, label=f"CRC {pair.new.name}", path=f"crcs.{pair.new.name}")
        yield from sides.presence("crc", _called(place, pair.old), pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from members(sides, replace(place, c="", python=""), pair.old, pair.new)


def _interface_of(device: Device, crc: Crc) -> str:
    """Return the only interface whose frames have a CRC, or "" if there are several."""
    found = set()
    for interface in device.interfaces:
        kinds = [field.kind for layout in interface.layouts for field in layout.fields]
        used = {kind.crc for kind in kinds if isinstance(kind, CrcValue)}
        if isinstance(interface, Biss):
            used |= {item.crc for item in interface.control_data}
        if crc.name in used:
            found.add(interface.name)
    return found.pop() if len(found) == 1 else ""


def procedures(sides: Sides) -> Iterator[Change]:
    for pair in known.procedures(sides):
        item = pair.old or pair.new
        assert item is not None
        place = names.procedure(sides.old if pair.old is not None else sides.new, item)
        if pair.new is not None:
            place = replace(place, label=f"procedure {pair.new.name}", path=f"procedures.{pair.new.name}")
        yield from sides.presence("procedure", _called(place, pair.old), pair.old, pair.new)
        if pair.old is not None and pair.new is not None:
            yield from _procedure(sides, place, pair.old, pair.new)


def _argument(name: str, of: str, meant_as: str) -> str:
    """Return an argument with the register that takes it."""
    return f"{name} for {of}" + (f" as {meant_as}" if meant_as else "")


def _procedure(sides: Sides, place: Thing, old: Procedure, new: Procedure) -> Iterator[Change]:
    bare = replace(place, c="", python="")
    yield from members(sides, bare, old, new)
    was = [(item.name, sides.to_new("register", item.of), item.meant_as) for item in old.arguments]
    now = [(item.name, item.of, item.meant_as) for item in new.arguments]
    if was != now:
        has_other_names = [item[0] for item in was] != [item[0] for item in now]
        texts = [[item[0] if has_other_names else _argument(*item) for item in each] for each in (was, now)]
        said = f": arguments {shown(texts[0])} → {shown(texts[1])}"
        yield sides.change("procedure-arguments", replace(place, path=f"{place.path}.arguments"), said, was, now)
    elif [item.meaning for item in old.arguments] != [item.meaning for item in new.arguments]:
        yield sides.change("words", bare.inside("arguments", place.label), ": arguments", old.arguments, new.arguments)
    inner = replace(bare, path=f"{place.path}.steps")
    before = [known.step_in_new(sides, step) for step in old.steps]
    after = [known.bare(step) for step in new.steps]
    if before != after:
        yield sides.change("procedure-steps", inner, _steps(before, after), before, after)
    elif [step.meaning for step in old.steps] != [step.meaning for step in new.steps]:
        yield sides.change("words", inner, ": steps", old.steps, new.steps)
    elif old.steps != new.steps and [step.source for step in old.steps] != [step.source for step in new.steps]:
        yield sides.change("source", inner, ": steps", None, None)


def _steps(before: list[Step], after: list[Step]) -> str:
    if len(before) != len(after):
        return f": {len(before)} steps → {len(after)} steps"
    at = [index + 1 for index, pair in enumerate(zip(before, after, strict=True)) if pair[0] != pair[1]]
    details = {_step(*pair) for pair in zip(before, after, strict=True) if pair[0] != pair[1]}
    steps = f": step{'s' * (len(at) > 1)} {', '.join(map(str, at))}"
    return f"{steps}: {details.pop()}" if len(details) == 1 else f"{steps} differ"


def _step(old: Step, new: Step) -> str:
    """Describe the difference between two steps."""
    if type(old) is not type(new):
        return f"{old.do} → {new.do}"
    names = [item.name for item in members_of(new) if getattr(old, item.name) != getattr(new, item.name)]
    return ", ".join(_part(name, plain(getattr(old, name)), plain(getattr(new, name))) for name in names)


def _part(name: str, old: Any, new: Any) -> str:
    if name == "microseconds":
        return f"pause {arrow(old, new, 'us')}"
    return f"{name.replace('_', ' ')} {arrow(old, new)}"
