"""Facts about interfaces: frames, clocks, times, ports, data IDs, the control frame."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import Path
from ..model import Biss, ControlField, Interface, Layout, Rs485, Ssi, Timeout, Timing
from .aspects import Aspects, crc_aspects
from .fact import Fact, Facts, Key, Name, Sort
from .printed import plain, printed_names
from .reading import Reading, at, in_hex, over
from .words import word

#: Width of a frame without byte order, even if a reader states one.
_BYTE = 8


def add_interfaces(reading: Reading, facts: Facts) -> None:
    """Add the facts of all interfaces, and the timings of the device."""
    for interface in reading.device.interfaces:
        for layout in interface.layouts:
            _add_frames(reading, interface, layout, facts)
            facts.follows(Sort.POSITION, len(layout.joins))
        facts.add(_of_interface(reading, interface))
        facts.add(timings(interface.timings, interface.name, ("interfaces", interface.name, "timings")))
    facts.add(timings(reading.device.timings, "", ("timings",)))


def frame_keys(interface: Interface, layout: Layout) -> Iterator[tuple[Key, str]]:
    """Yield a key for each frame with this layout, and its name in messages."""
    here: Key = ("frame", interface.name, layout.sender, layout.channel or 0)
    for value in layout.selects:
        yield (*here, value), f"'{layout.name}'"
    if not layout.selects:
        yield (*here, -1), f"'{layout.name}'"


def _add_frames(reading: Reading, interface: Interface, layout: Layout, facts: Facts) -> None:
    owner: Path = ("interfaces", interface.name, "layouts", layout.name)
    for key, what in frame_keys(interface, layout):
        facts.add(_of_frame(reading, layout, key, what, owner))
        aspects = Aspects(reading, owner, interface.name)
        facts.words[key] = word(reading, layout, key, what, aspects)
        for item in layout.fields:
            if item.group:
                place = reading.field_place(owner, item)
                name = Name(
                    Sort.POSITION, item.group, f"group of {reading.bits_of(interface.name, item)} of {what}", place
                )
                facts.call(("group", interface.name), (*key, reading.bits_of(interface.name, item)), name)


def _of_frame(reading: Reading, layout: Layout, key: Key, what: str, owner: Path) -> Iterator[Fact]:
    yield Fact(Sort.POSITION, key, f"sent by the {layout.sender}", what, (*owner, "name"), name=layout.name)
    place = reading.first((*owner, "carried_as"), owner)
    yield Fact(Sort.POSITION, (*key, "carried"), layout.carried_as, f"units of {what}", place, key)
    several, stated = layout.widest > _BYTE, reading.has((*owner, "byte_order"))
    if layout.in_bytes and (several or stated):
        place, order = (*owner, "byte_order") if stated else owner, layout.byte_order
        yield Fact(Sort.BYTE_ORDER, (*key, "order"), order, f"byte order of {what}", place, key, mild=not several)
    cases = reading.cases(key[1] if isinstance(key[1], str) else "")
    lengths = {case: str(layout.bits.value(parameters)) for case, parameters in cases.items()}
    yield Fact(Sort.POSITION, (*key, "length"), lengths, f"bits of {what}", owner, key)
    for language, text in printed_names(reading, layout.printed_name, {}):
        place = reading.name_place(owner, language)
        yield Fact(Sort.PRINTED, (*key, "name", language), text, f"printed name of {what}", place, key, mild=True)


def _of_interface(reading: Reading, interface: Interface) -> Iterator[Fact]:
    owner: Path = ("interfaces", interface.name)
    match interface:
        case Ssi():
            yield from _ssi(interface, owner)
        case Biss():
            yield from _biss(reading, interface, owner)
        case Rs485():
            yield from _rs485(interface, owner)


def _clock(interface: Ssi | Biss, owner: Path) -> Iterator[Fact]:
    for name, value, what in (
        ("min_hz", interface.clock.min_hz, "lowest clock"),
        ("max_hz", interface.clock.max_hz, "highest clock"),
    ):
        key = ("clock", interface.name, name)
        yield Fact(Sort.CLOCK, key, f"{value} Hz", f"{what} over {interface.short}", (*owner, "clock", name))


def _ssi(interface: Ssi, owner: Path) -> Iterator[Fact]:
    yield from _clock(interface, owner)
    end = interface.alignment.end
    yield Fact(Sort.POSITION, ("alignment",), end, "alignment of the SSI word", (*owner, "alignment"))
    if interface.output_code is not None:
        code = interface.output_code.code
        yield Fact(Sort.SETTING, ("output code",), code, "output code over SSI", (*owner, "output_code"))
    for index, item in enumerate(interface.cable_lengths):
        what = f"clock for a cable shorter than {item.shorter_than_m} m"
        key = ("cable", interface.name, item.shorter_than_m)
        place = (*owner, "cable_lengths", index, "below_hz")
        yield Fact(Sort.CLOCK, key, f"below {item.below_hz} Hz", what, place)


def _biss(reading: Reading, interface: Biss, owner: Path) -> Iterator[Fact]:
    yield from _clock(interface, owner)
    if interface.description_file:
        place = (*owner, "description_file")
        yield Fact(Sort.PRINTED, ("description file",), interface.description_file, "description file", place)
    if interface.bank_select:
        register = reading.register(interface.bank_select)
        value = at(register) if register is not None else interface.bank_select
        yield Fact(Sort.ADDRESS, ("bank select",), value, "register that selects the bank", (*owner, "bank_select"))
    if interface.network is not None:
        place = (*owner, "network")
        several = str(interface.network.multiple_slaves).lower()
        topology = interface.network.topology
        yield Fact(Sort.SETTING, ("network", "topology"), topology, "topology of the network", (*place, "topology"))
        yield Fact(Sort.SETTING, ("network", "slaves"), several, "several slaves", (*place, "multiple_slaves"))
    if interface.timeout is not None:
        yield from _timeout(interface.timeout, (*owner, "timeout"))
    offset = 0
    for item in interface.control_data:
        yield from _control(reading, item, offset, (*owner, "control_data", "fields", item.name))
        offset += item.bits


def _timeout(timeout: Timeout, owner: Path) -> Iterator[Fact]:
    told: list[tuple[str, str | None]] = [("rule", timeout.rule)]
    for name, number, unit in (
        ("half_clock_periods", timeout.half_clock_periods, "half periods"),
        ("at_most_ns", timeout.at_most_ns, "ns"),
        ("typical_ns", timeout.typical_ns, "ns"),
    ):
        told.append((name, f"{number} {unit}" if number is not None else None))
    for name, value in told:
        if value is not None:
            yield Fact(Sort.TIME, ("timeout", name), value, f"time-out over BiSS, '{name}'", (*owner, name))
    for index, item in enumerate(timeout.printed):
        what = f"time-out over BiSS at {item.clock_hz} Hz"
        place = (*owner, "printed", index, "timeout_ns")
        yield Fact(Sort.TIME, ("timeout", "at", item.clock_hz), f"{item.timeout_ns} ns", what, place)


def _control(reading: Reading, item: ControlField, offset: int, owner: Path) -> Iterator[Fact]:
    """Yield the facts of a field of the control frame, starting at a bit of the frame."""
    key: Key = ("control", offset)
    what = f"field of the control frame from bit {offset + 1}"
    yield Fact(Sort.POSITION, key, f"{item.bits} bits", what, owner, name=item.name)
    for value in item.values:
        place = (*owner, "values", value.name)
        named = f"value {in_hex(value.value)} of {what}"
        yield Fact(Sort.VALUE, (*key, "value", value.value), "named", named, place, key, name=value.name)
        for language, text in printed_names(reading, value.printed_name, value.names):
            name = (*key, "value", value.value, language)
            printed = reading.name_place(place, language)
            yield Fact(Sort.PRINTED, name, text, f"printed name of {named}", printed, key, mild=True)
    for language, text in printed_names(reading, item.printed_name, item.names):
        printed = reading.name_place(owner, language)
        yield Fact(Sort.PRINTED, (*key, language), text, f"printed name of {what}", printed, key, mild=True)
    if item.crc:
        for about, aspect in crc_aspects(reading.device.crc(item.crc), "biss", "the control frame's CRC"):
            yield Fact(aspect.sort, (*key, about), aspect.value, aspect.what, aspect.place, key)


def _rs485(interface: Rs485, owner: Path) -> Iterator[Fact]:
    port, place = interface.port, (*owner, "port")
    yield Fact(Sort.CLOCK, ("port", "baud"), str(port.baud), "baud rate", (*place, "baud"))
    told = {"data_bits": port.data_bits, "parity": port.parity, "stop_bits": port.stop_bits}
    for name, value in {**told, "flow_control": port.flow_control}.items():
        yield Fact(Sort.SETTING, ("port", name), str(value), f"'{name}' of the port", (*place, name))
    for item in interface.data_ids:
        here, key = (*owner, "data_ids", item.name), ("data id", item.id)
        what = f"data ID {item.id:X}"
        yield Fact(Sort.VALUE, key, f"control field {in_hex(item.control)}", what, (*here, "control"), name=item.name)
        yield Fact(Sort.SETTING, (*key, "purpose"), item.purpose, f"purpose of {what}", (*here, "purpose"), key)
    for index, access in enumerate(interface.memory_access):
        what = f"reply to a {access.access} while the busy flag is {access.busy}"
        place = (*owner, "memory_access", index)
        value = f"address {plain(access.address)}, data {plain(access.data)}"
        yield Fact(Sort.SETTING, ("memory", access.access, access.busy), value, what, place)


def timings(found: tuple[Timing, ...], interface: str, owner: Path) -> Iterator[Fact]:
    """Yield timings, identified by their printed symbols, or by their numbers if they have none."""
    through = f" over {over(interface)}" if interface else ""
    for item in found:
        bounds = {"at_least_us": item.at_least_us, "typical_us": item.typical_us, "at_most_us": item.at_most_us}
        told = {name: value for name, value in bounds.items() if value is not None}
        if item.symbol:
            for name, value in told.items():
                key = ("time", interface, plain(item.symbol).replace(" ", ""), name)
                what = f"time {item.symbol}{through}, '{name}'"
                yield Fact(Sort.TIME, key, f"{value} µs", what, (*owner, item.name, name), name=item.name)
        else:
            words = {name.removesuffix("_us").replace("_", " "): value for name, value in told.items()}
            text = ", ".join(f"{bound} {value} µs" for bound, value in words.items())
            yield Fact(
                Sort.TIME, ("time", interface, text), text, f"a time{through}", (*owner, item.name), name=item.name
            )
