"""Facts about interfaces: frames, clocks, times, ports, data IDs, the control frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate

from ..language.problems import Path
from ..model import Biss, Constant, ControlField, Flag, Interface, Layout, PlacedField, Rs485, Spi, Ssi, Timing
from ..say.place import bits as bit_text
from .fact import Fact, Facts, Key, Sort
from .frame_bits import word
from .reading import Reading, in_hex, over, plain
from .stated import Subject

#: Width of a frame without byte order, even if a reader states one.
_BYTE = 8
#: Parts of interfaces, with the words between a fact about them and the name of the interface.
_PARTS = {
    "clock": " over ",
    "network": " of the network over ",
    "timeout": " of the time-out over ",
    "port": " of the port over ",
}


def add_interfaces(reading: Reading, facts: Facts) -> None:
    """Add the facts of all interfaces, and the timings of the device."""
    for interface in reading.device.interfaces:
        marks = _marks(interface)
        for layout in interface.layouts:
            _add_frames(reading, interface, layout, marks.get(layout.name, -1), facts)
            facts.derived[Sort.POSITION] += len(layout.joins)
        facts.add(_of_interface(reading, interface))
        facts.add(timings(interface.timings, interface.name, ("interfaces", interface.name, "timings")))
    facts.add(timings(reading.device.timings, "", ("timings",)))


def _marks(interface: Interface) -> dict[str, str]:
    """Return what identifies the frames of exchanges, by their names: the constants of the request."""
    found: dict[str, str] = {}
    layouts = {item.name: item for item in interface.layouts}
    for item in interface.exchanges if isinstance(interface, (Rs485, Spi)) else ():
        fields = layouts[item.request].fields
        constants = [(field.low, field.kind.value) for field in fields if isinstance(field.kind, Constant)]
        mark = ", ".join(f"{in_hex(value)} from bit {low.render()}" for low, value in constants)
        found[item.request] = mark
        found.setdefault(item.reply, mark)
    return found


def _add_frames(reading: Reading, interface: Interface, layout: Layout, mark: str | int, facts: Facts) -> None:
    """Add each frame with this layout. ``mark`` identifies it if it has no selector."""
    owner: Path = ("interfaces", interface.name, "layouts", layout.name)
    for value in layout.selects or (mark,):
        key: Key = ("frame", interface.name, layout.sender, layout.channel or 0, value)
        frame = Subject(reading, key, owner, f"'{layout.name}'", interface.name)
        facts.add(_of_frame(frame, layout))
        facts.words[key] = word(frame, layout)
        for item in layout.fields:
            if item.group:
                bits = reading.bits_of(interface.name, item)
                what, place = f"group of {bits} of {frame.what}", reading.field_place(owner, item)
                facts.call(("group", interface.name), Fact(Sort.POSITION, (*key, bits), item.group, what, place))


def _of_frame(frame: Subject, layout: Layout) -> Iterator[Fact]:
    reading, owner = frame.reading, frame.place
    yield from frame.present(Sort.POSITION, layout, f"sent by the {layout.sender}", at="name")
    place = reading.first((*owner, "carried_as"), owner)
    yield frame.fact(Sort.POSITION, "carried", layout.carried_as, "units", place)
    several, is_stated = layout.widest > _BYTE, reading.document.has((*owner, "byte_order"))
    if layout.in_bytes and (several or is_stated):
        place = (*owner, "byte_order") if is_stated else owner
        yield frame.fact(Sort.BYTE_ORDER, "order", layout.byte_order, "byte order", place, mild=not several)
    lengths = {case: str(layout.bits.value(each)) for case, each in reading.cases(frame.interface).items()}
    yield frame.fact(Sort.POSITION, "length", lengths, "bits", owner)
    yield from _combinations(frame, layout)


def _combinations(frame: Subject, layout: Layout) -> Iterator[Fact]:
    """Yield the verdicts of combinations of values, which are identified by their bits."""
    signs = {sign.flag.name: sign for sign in layout.signs}
    parameters = next(iter(frame.reading.cases(frame.interface).values()), {})
    placed = {item.name: item for item in layout.place(parameters).fields} if layout.combinations else {}
    for item in layout.combinations:
        conditions = ((placed[name], value) for name, value in signs[item.name].conditions)
        values = ", ".join(sorted(_condition(field, value) for field, value in conditions))
        path = ("combinations", item.name)
        subject = frame.inside(("combination", values), path, f"the combination of {values} in {frame.what}")
        yield subject.first(Sort.VERDICT, item.makes_position.value, "makes_position")
        yield from subject.stated(item)


def _condition(field: PlacedField, value: int) -> str:
    """Return the bits of a field, and their value in a combination."""
    is_low = isinstance(field.field.kind, Flag) and field.field.kind.active_low
    return f"{bit_text(field.high, field.low)} = {value ^ is_low}"


def _of_interface(reading: Reading, interface: Interface) -> Iterator[Fact]:
    owner: Path = ("interfaces", interface.name)
    whole = Subject(reading, ("interface", interface.name), owner, interface.short, interface.name, (), " over ")
    yield from whole.stated(interface)
    for name, joint in _PARTS.items():
        if part := getattr(interface, name, None):
            yield from replace(whole, key=(name, interface.name), place=(*owner, name), joint=joint).stated(part)
    match interface:
        case Ssi():
            for index, cable in enumerate(interface.cable_lengths):
                what = f"clock for a cable shorter than {cable.shorter_than_m} m"
                place, key = (*owner, "cable_lengths", index, "below_hz"), ("cable", "ssi", cable.shorter_than_m)
                yield Fact(Sort.CLOCK, key, f"below {cable.below_hz} Hz", what, place)
        case Biss():
            for index, item in enumerate(interface.timeout.printed if interface.timeout is not None else ()):
                place, key = (*owner, "timeout", "printed", index, "timeout_ns"), ("timeout", "at", item.clock_hz)
                yield Fact(Sort.TIME, key, f"{item.timeout_ns} ns", f"time-out over BiSS at {item.clock_hz} Hz", place)
            offsets = accumulate((item.bits for item in interface.control_data), initial=0)
            for field, offset in zip(interface.control_data, offsets, strict=False):
                yield from _control(reading, field, offset)
        case Rs485():
            yield from _rs485(reading, interface)
            yield from _exchanges(interface)
        case Spi():
            yield from _exchanges(interface)


def _control(reading: Reading, item: ControlField, offset: int) -> Iterator[Fact]:
    """Yield the facts of a field of the control frame, starting at a bit of the frame."""
    place: Path = ("interfaces", "biss", "control_data", "fields", item.name)
    field = Subject(reading, ("control", offset), place, f"field of the control frame from bit {offset + 1}")
    yield from field.present(Sort.POSITION, item, f"{item.bits} bits")
    for each in item.values:
        what = f"value {in_hex(each.value)} of {field.what}"
        value = field.inside(("value", each.value), ("values", each.name), what)
        yield from value.present(Sort.VALUE, each, "named")
    if item.crc:
        crc = replace(field.inside(("crc",), (), "the control frame's CRC over BiSS"), place=("crcs", item.crc))
        yield from crc.stated(reading.device.crc(item.crc))


def _rs485(reading: Reading, interface: Rs485) -> Iterator[Fact]:
    owner: Path = ("interfaces", interface.name)
    for item in interface.data_ids:
        subject = Subject(reading, ("data id", item.id), (*owner, "data_ids", item.name), f"data ID {item.id:X}")
        yield from subject.present(Sort.VALUE, item, f"control field {in_hex(item.control)}", at="control")
    for index, access in enumerate(interface.memory_access):
        what = f"reply to a {access.access} while the busy flag is {access.busy}"
        value = f"address {plain(access.address)}, data {plain(access.data)}"
        yield Fact(Sort.SETTING, ("memory", access.access, access.busy), value, what, (*owner, "memory_access", index))


def _exchanges(interface: Rs485 | Spi) -> Iterator[Fact]:
    marks = _marks(interface)
    for index, item in enumerate(interface.exchanges):
        key: Key = ("exchange", interface.name, marks[item.request])
        value = f"{item.purpose}, {'with' if item.reply else 'without'} a reply"
        value += f", words of {item.word_bits.render()} bits" if item.word_bits is not None else ""
        place = ("interfaces", interface.name, "exchanges", index)
        yield Fact(Sort.SETTING, key, value, f"request with {marks[item.request] or 'no constant'}", place)


def timings(found: tuple[Timing, ...], interface: str, owner: Path) -> Iterator[Fact]:
    """Yield timings, identified by their printed symbols, or by their numbers if they have none."""
    through = f" over {over(interface)}" if interface else ""
    for item in found:
        bounds = {name: getattr(item, name) for name in ("at_least_us", "typical_us", "at_most_us")}
        given = {name: f"{value} µs" for name, value in bounds.items() if value is not None}
        place = (*owner, item.name)
        if item.symbol:
            symbol = plain(item.symbol).replace(" ", "")
            for name, value in given.items():
                what = f"time {item.symbol}{through}, '{name}'"
                yield Fact(Sort.TIME, ("time", interface, symbol, name), value, what, (*place, name), name=item.name)
        else:
            text = ", ".join(f"{name.removesuffix('_us').replace('_', ' ')} {value}" for name, value in given.items())
            yield Fact(Sort.TIME, ("time", interface, text), text, f"a time{through}", place, name=item.name)
