"""Facts about interfaces and registers: frames, clocks, times, ports, data IDs, and the limits of registers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import accumulate

from ..language.document import Path
from ..model import (
    Alarm,
    Biss,
    Connector,
    Constant,
    ControlField,
    Edition,
    Flag,
    Interface,
    Layout,
    Manual,
    PlacedField,
    Register,
    RegisterMeaning,
    Rs485,
    Spi,
    Ssi,
    Timing,
)
from ..model.registers import bounded
from ..say.names_and_places import bits
from ..say.names_and_places import bits as bit_text
from .frame_bits import word
from .reading import (
    NOTHING,
    Fact,
    Facts,
    Key,
    Reading,
    Sort,
    as_delivered,
    in_hex,
    interface_label,
    plain,
    register_text,
)
from .stated import Subject
from .texts import numbers_in


def add_registers(reading: Reading, facts: Facts) -> None:
    """Add every register, its bits, and its behaviour."""
    for register in reading.device.registers:
        key, place = reading.key_of(register), ("registers", register.name)
        subject = Subject(reading, key, place, register_text(register), register.interface)
        facts.add(_facts(subject, register))
        _add_names(subject, register, facts)
        facts.derived[Sort.POSITION] += len(register.layout.joins)
        facts.words[key] = word(subject, register.layout, register)


def _add_names(subject: Subject, register: Register, facts: Facts) -> None:
    """Add the names that a register refers to: the field with limits, and the field that opens it."""
    description, place = f"field that the limits of {subject.description} apply to", (*subject.place, "limits_of")
    facts.call(("bounded",), Fact(Sort.LIMIT, subject.key, register.limits_of, description, place))
    if register.opened_by:
        name, description = register.opened_by_field or NOTHING, f"field that opens {subject.description}"
        place = (*subject.place, "opened_by")
        facts.call(("opener",), Fact(Sort.BEHAVIOUR, subject.key, name, description, place))


def _facts(subject: Subject, register: Register) -> Iterator[Fact]:
    length = f"{register.length} byte{'s' * (register.length != 1)}"
    yield subject.existence(Sort.ADDRESS, length, at="address", name=register.name)
    yield from subject.stated_facts(register, without=("byte_order",) if register.length == 1 else ())
    default = as_delivered(register)
    if default is not None:
        place = (*subject.place, "fields" if register.default is None else "default")
        yield subject.fact(Sort.DEFAULT, "default", in_hex(default), "default", place)
    if register.opened_by:
        yield subject.fact(Sort.BEHAVIOUR, "opened_by", _opened_by(subject.reading, register), "opener")
    yield from _limits(subject, register)


def _opened_by(reading: Reading, register: Register) -> str:
    opener = reading.register(register.opened_by)
    if opener is None:
        return register.opened_by
    for field in opener.layout.fields:
        value = next((value for value in field.values if value.name == register.opened_by_value), None)
        if value is not None and register.opened_by_field in ("", field.name):
            return f"{in_hex(value.value)} in {register_text(opener)} {reading.bits_of(opener.interface, field)}"
    return register_text(opener)


def _limits(subject: Subject, register: Register) -> Iterator[Fact]:
    """Yield the limits of each meaning, and the bits that they apply to."""
    reading = subject.reading
    limited_parts: list[Register | RegisterMeaning] = [register, *register.meanings]
    if any(limited_part.min is not None or limited_part.max is not None for limited_part in limited_parts):
        place = reading.first_existing((*subject.place, "limits_of"), subject.place)
        description = f"bits that the limits of {subject.description} apply to"
        value = {case: _bounded(register, parameters) for case, parameters in reading.cases(register.interface).items()}
        yield Fact(Sort.LIMIT, (*subject.key, "bounded"), value, description, place, subject.key)
    for meaning in register.meanings:
        description = f"{subject.description} while {reading.state(meaning.when, meaning.value)}"
        yield from subject.inside((description,), ("meanings", meaning.name), description).stated_facts(meaning)


def _bounded(register: Register, parameters: Mapping[str, int]) -> str:
    """Return the bits of a register that its limits apply to."""
    names = register.layout.names_in(bounded(register))
    fields = register.layout.place(parameters).find_fields(names)
    return " and ".join(bits(field.high, field.low) for field in fields) or "all bits"


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
        request_constants = _marks(interface)
        for layout in interface.layouts:
            _add_frames(reading, interface, layout, request_constants.get(layout.name, -1), facts)
            facts.derived[Sort.POSITION] += len(layout.joins)
        facts.add(_of_interface(reading, interface))
        facts.add(timings(interface.timings, interface.name, ("interfaces", interface.name, "timings")))
    facts.add(timings(reading.device.timings, "", ("timings",)))


def _marks(interface: Interface) -> dict[str, str]:
    """Return what identifies the frames of exchanges, by their names: the constants of the request."""
    request_constants: dict[str, str] = {}
    layouts = {layout.name: layout for layout in interface.layouts}
    for exchange in interface.exchanges if isinstance(interface, (Rs485, Spi)) else ():
        fields = layouts[exchange.request].fields
        constants = [(field.low, field.kind.value) for field in fields if isinstance(field.kind, Constant)]
        constants_text = ", ".join(f"{in_hex(value)} from bit {low.render()}" for low, value in constants)
        request_constants[exchange.request] = constants_text
        request_constants.setdefault(exchange.reply, constants_text)
    return request_constants


def _add_frames(reading: Reading, interface: Interface, layout: Layout, identity: str | int, facts: Facts) -> None:
    """Add each frame with this layout. ``identity`` identifies it if it has no selector."""
    owner: Path = ("interfaces", interface.name, "layouts", layout.name)
    for value in layout.selects or (identity,):
        key: Key = ("frame", interface.name, layout.sender, layout.channel or 0, value)
        frame = Subject(reading, key, owner, f"'{layout.name}'", interface.name)
        facts.add(_of_frame(frame, layout))
        facts.words[key] = word(frame, layout)
        for field in layout.fields:
            if field.group:
                bits = reading.bits_of(interface.name, field)
                description, place = f"group of {bits} of {frame.description}", reading.field_place(owner, field)
                facts.call(
                    ("group", interface.name), Fact(Sort.POSITION, (*key, bits), field.group, description, place)
                )


def _of_frame(frame: Subject, layout: Layout) -> Iterator[Fact]:
    reading, owner = frame.reading, frame.place
    yield from frame.present(Sort.POSITION, layout, f"sent by the {layout.sender}", at="name")
    place = reading.first_existing((*owner, "carried_as"), owner)
    yield frame.fact(Sort.POSITION, "carried", layout.carried_as, "units", place)
    has_several_bytes, is_stated = layout.widest > _BYTE, reading.document.has((*owner, "byte_order"))
    if layout.in_bytes and (has_several_bytes or is_stated):
        place = (*owner, "byte_order") if is_stated else owner
        yield frame.fact(Sort.BYTE_ORDER, "order", layout.byte_order, "byte order", place, mild=not has_several_bytes)
    lengths = {case: str(layout.bits.value(parameters)) for case, parameters in reading.cases(frame.interface).items()}
    yield frame.fact(Sort.POSITION, "length", lengths, "bits", owner)
    yield from _combinations(frame, layout)


def _combinations(frame: Subject, layout: Layout) -> Iterator[Fact]:
    """Yield the verdicts of combinations of values, which are identified by their bits."""
    if not layout.combinations:
        return
    signs = {sign.flag.name: sign for sign in layout.signs}
    parameters = next(iter(frame.reading.cases(frame.interface).values()), {})
    placed = {placed_field.name: placed_field for placed_field in layout.place(parameters).fields}
    for combination in layout.combinations:
        conditions = ((placed[name], value) for name, value in signs[combination.name].conditions)
        values = ", ".join(sorted(_condition(field, value) for field, value in conditions))
        path = ("combinations", combination.name)
        subject = frame.inside(("combination", values), path, f"the combination of {values} in {frame.description}")
        yield subject.existence(Sort.VERDICT, combination.makes_position.value, "makes_position")
        yield from subject.stated_facts(combination)


def _condition(field: PlacedField, value: int) -> str:
    """Return the bits of a field, and their value in a combination."""
    is_low = isinstance(field.field.kind, Flag) and field.field.kind.active_low
    return f"{bit_text(field.high, field.low)} = {value ^ is_low}"


def _of_interface(reading: Reading, interface: Interface) -> Iterator[Fact]:
    owner: Path = ("interfaces", interface.name)
    whole = Subject(reading, ("interface", interface.name), owner, interface.short, interface.name, (), " over ")
    yield from whole.stated_facts(interface)
    for name, joint in _PARTS.items():
        if part := getattr(interface, name, None):
            yield from replace(whole, key=(name, interface.name), place=(*owner, name), joint=joint).stated_facts(part)
    match interface:
        case Ssi():
            for index, cable in enumerate(interface.cable_lengths):
                description = f"clock for a cable shorter than {cable.shorter_than_m} m"
                place, key = (*owner, "cable_lengths", index, "below_hz"), ("cable", "ssi", cable.shorter_than_m)
                yield Fact(Sort.CLOCK, key, f"below {cable.below_hz} Hz", description, place)
        case Biss():
            for index, printed in enumerate(interface.timeout.printed if interface.timeout is not None else ()):
                place, key = (*owner, "timeout", "printed", index, "timeout_ns"), ("timeout", "at", printed.clock_hz)
                yield Fact(
                    Sort.TIME, key, f"{printed.timeout_ns} ns", f"time-out over BiSS at {printed.clock_hz} Hz", place
                )
            offsets = accumulate((control_field.bits for control_field in interface.control_data), initial=0)
            for field, offset in zip(interface.control_data, offsets, strict=False):
                yield from _control(reading, field, offset)
        case Rs485():
            yield from _rs485(reading, interface)
            yield from _exchanges(interface)
        case Spi():
            yield from _exchanges(interface)


def _control(reading: Reading, control_field: ControlField, offset: int) -> Iterator[Fact]:
    """Yield the facts of a field of the control frame, starting at a bit of the frame."""
    place: Path = ("interfaces", "biss", "control_data", "fields", control_field.name)
    subject = Subject(reading, ("control", offset), place, f"field of the control frame from bit {offset + 1}")
    yield from subject.present(Sort.POSITION, control_field, f"{control_field.bits} bits")
    for named_value in control_field.values:
        description = f"value {in_hex(named_value.value)} of {subject.description}"
        value_subject = subject.inside(("value", named_value.value), ("values", named_value.name), description)
        yield from value_subject.present(Sort.VALUE, named_value, "named")
    if control_field.crc:
        crc = replace(
            subject.inside(("crc",), (), "the control frame's CRC over BiSS"), place=("crcs", control_field.crc)
        )
        yield from crc.stated_facts(reading.device.crc(control_field.crc))


def _rs485(reading: Reading, interface: Rs485) -> Iterator[Fact]:
    owner: Path = ("interfaces", interface.name)
    for data_id in interface.data_ids:
        subject = Subject(
            reading, ("data id", data_id.id), (*owner, "data_ids", data_id.name), f"data ID {data_id.id:X}"
        )
        yield from subject.present(Sort.VALUE, data_id, f"control field {in_hex(data_id.control)}", at="control")
    for index, access in enumerate(interface.memory_access):
        description = f"reply to a {access.access} while the busy flag is {access.busy}"
        value = f"address {plain(access.address)}, data {plain(access.data)}"
        yield Fact(
            Sort.SETTING, ("memory", access.access, access.busy), value, description, (*owner, "memory_access", index)
        )


def _exchanges(interface: Rs485 | Spi) -> Iterator[Fact]:
    request_constants = _marks(interface)
    for index, exchange in enumerate(interface.exchanges):
        key: Key = ("exchange", interface.name, request_constants[exchange.request])
        value = f"{exchange.purpose}, {'with' if exchange.reply else 'without'} a reply"
        value += f", words of {exchange.word_bits.render()} bits" if exchange.word_bits is not None else ""
        place = ("interfaces", interface.name, "exchanges", index)
        yield Fact(
            Sort.SETTING, key, value, f"request with {request_constants[exchange.request] or 'no constant'}", place
        )


def timings(printed_timings: tuple[Timing, ...], interface: str, owner: Path) -> Iterator[Fact]:
    """Yield timings, identified by their printed symbols, or by their numbers if they have none."""
    interface_text = f" over {interface_label(interface)}" if interface else ""
    for timing in printed_timings:
        bounds = {name: getattr(timing, name) for name in ("at_least_us", "typical_us", "at_most_us")}
        times = {name: f"{value} µs" for name, value in bounds.items() if value is not None}
        place = (*owner, timing.name)
        if timing.symbol:
            symbol = plain(timing.symbol).replace(" ", "")
            for name, value in times.items():
                description = f"time {timing.symbol}{interface_text}, '{name}'"
                yield Fact(
                    Sort.TIME, ("time", interface, symbol, name), value, description, (*place, name), name=timing.name
                )
        else:
            text = ", ".join(f"{name.removesuffix('_us').replace('_', ' ')} {value}" for name, value in times.items())
            yield Fact(Sort.TIME, ("time", interface, text), text, f"a time{interface_text}", place, name=timing.name)


def surroundings(reading: Reading) -> Iterator[Fact]:
    """Yield all facts other than data."""
    yield from _connectors(reading)
    for alarm in reading.device.alarms:
        for place in _bits_of(reading, alarm):
            subject = Subject(reading, ("alarm", place), ("alarms", alarm.name), f"the alarm '{alarm.name}'")
            yield replace(subject.existence(Sort.ALARM, "present", name=alarm.name), description=f"alarm at {place}")
            yield from subject.stated_facts(alarm)
    for number, hardware_input in enumerate(reading.device.inputs, 1):
        subject = Subject(reading, ("input", number), ("inputs", hardware_input.name), f"input {number}")
        yield from subject.present(Sort.INPUT, hardware_input)
    yield from _history(reading, reading.device.manual)
    yield from _characteristics(reading)
    yield from _tables(reading)
    yield from _leds(reading)


def _connectors(reading: Reading) -> Iterator[Fact]:
    """Yield every contact, by interface, number of its connector or cable, and pin or colour."""
    counts: Counter[tuple[str, str]] = Counter()
    for connector in reading.device.connectors:
        for interface in connector.interfaces or ("",):
            counts[interface, connector.kind] += 1
            yield from _contacts(reading, connector, interface, counts[interface, connector.kind])


def _contacts(reading: Reading, connector: Connector, interface: str, number: int) -> Iterator[Fact]:
    """Yield a connector or cable of an interface, and its contacts."""
    description = f"{connector.kind} {number}" + (f" for {interface_label(interface)}" if interface else "")
    key: Key = ("connector", interface, connector.kind, number)
    owner = Subject(reading, key, ("connectors", connector.name), description)
    yield owner.existence(Sort.PIN, "present", name=connector.name)
    for contact in connector.contacts:
        place: Path = (*owner.place, "contacts", contact.contact)
        description = f"contact {contact.contact} of {owner.description}"
        subject = Subject(reading, (*owner.key, plain(contact.contact)), place, description, joint=" with ")
        # Two readers differ in capitals and blanks, but not in the sign of a signal.
        signal = "".join(contact.signal.casefold().split())
        yield subject.existence(Sort.PIN, signal, at="signal", under=owner.key)
        yield from subject.stated_facts(contact)


def _bits_of(reading: Reading, alarm: Alarm) -> Iterator[str]:
    """Yield the places of the bits of an alarm, in words without names."""
    register = reading.register(alarm.register) if alarm.register else None
    if register is not None:
        yield reading.bits_at(f"{alarm.register}.{alarm.field}") if alarm.field else register_text(register)
    for interface, layout in reading.device.layouts():
        for field in layout.fields:
            if alarm.group and (field.group, field.name) == (alarm.group, alarm.field):
                places = reading.bits_in_frames(interface.name, layout, field)
                yield from (f"{place} over {interface.short}" for place in places)


def _history(reading: Reading, manual: Manual) -> Iterator[Fact]:
    """Yield the editions that were read, and the manual's revisions."""
    editions: list[tuple[Path, Manual | Edition]] = [(("manual",), manual)]
    editions += [(("manual", "editions", edition.revision), edition) for edition in manual.editions]
    for place, edition in editions:
        subject = Subject(reading, ("edition", edition.language), place, f"the edition '{edition.language}'")
        description = f"revision of {subject.description}"
        yield replace(subject.existence(Sort.HISTORY, edition.revision, at="revision"), description=description)
        yield from subject.stated_facts(edition)
    for row in manual.history:
        key, place = ("revision", row.revision), ("manual", "history", row.revision)
        yield from Subject(reading, key, place, f"revision {row.revision}").present(Sort.HISTORY, row, "listed")


def _characteristics(reading: Reading) -> Iterator[Fact]:
    """Yield every characteristic by its name, with its quantities in the order of the text."""
    for characteristic in reading.device.characteristics:
        key, place = ("characteristic", characteristic.name), ("characteristics", characteristic.name)
        subject = Subject(reading, key, place, f"the characteristic '{characteristic.name}'")
        yield from subject.present(Sort.CHARACTERISTIC, characteristic)
        for index, value in enumerate(characteristic.values):
            description = f"{value.quantity} {index + 1} of {subject.description}"
            yield from subject.inside((index,), ("values", index), description).stated_facts(value)


def _tables(reading: Reading) -> Iterator[Fact]:
    """Yield every table by its name, with the numbers in its cells by row and column."""
    for table in reading.device.tables:
        subject = Subject(reading, ("table", table.name), ("tables", table.name), f"the table '{table.name}'")
        yield from subject.present(Sort.TABLE, table, f"{len(table.rows)} rows")
        for number, row in enumerate(table.rows):
            for column, cell in enumerate(row):
                if numbers := numbers_in(cell):
                    place, noun = (*subject.place, "rows", number, column), f"row {number + 1}, column {column + 1}"
                    yield subject.fact(Sort.TABLE, f"{number} {column}", numbers, noun, place)


def _leds(reading: Reading) -> Iterator[Fact]:
    """Yield every LED by its name, with its states in the order of the manual."""
    for led in reading.device.leds:
        owner = Subject(reading, ("led", led.name), ("leds", led.name), f"the LED '{led.name}'")
        yield owner.existence(Sort.LED, f"{len(led.states)} states", name=led.name)
        for number, state in enumerate(led.states):
            subject = owner.inside((number,), ("states", number), f"state {number + 1} of {owner.description}")
            yield subject.fact(Sort.LED, "state", state.state.casefold(), "words")
            yield from subject.stated_facts(state)
