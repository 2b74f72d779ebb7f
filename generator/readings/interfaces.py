"""Facts about interfaces: frames, their data channels, clocks, times, ports and data IDs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..language.document import Path
from ..model import (
    Biss,
    Constant,
    ControlField,
    Field,
    Flag,
    Interface,
    Layout,
    PlacedField,
    Rs485,
    Spi,
    Ssi,
    Timing,
    channel_frame,
)
from ..model.order_codes import Restricted, applies_to_code, repeated_names
from ..say.names_and_evidence import bits
from .bits_and_registers import word_bits
from .reading import (
    CodeAndState,
    ComparedFact,
    ComparedFacts,
    FactClass,
    FactKey,
    FactValue,
    SpecReading,
    comparable_text,
    in_hex,
    interface_label,
)
from .stated import FactSubject


def channel_facts(reading: SpecReading, interface: Biss) -> Iterator[ComparedFact]:
    """Yield facts about a BiSS frame with several data channels: their order, and the bits that decoders compare.

    Channels are identified by their numbers: ``1, 2``.
    """
    frame = channel_frame(interface)
    if frame is None:
        return
    channels_place: Path = ("interfaces", interface.name, "channels")
    yield ComparedFact(
        fact_class=FactClass.POSITION,
        key=("channels", "order"),
        value=", ".join(f"{layout.channel}" for layout in frame.layouts),
        description="order of the data channels in a frame",
        path_in_file=(*channels_place, "order"),
    )
    for compared in frame.compared:
        bits_by_case: dict[CodeAndState, str] = {}
        for case, parameters in reading.cases(interface.name).items():
            placed_layout = compared.layout.place(parameters)
            compared_field = placed_layout.field(compared.name)
            number_of_compared_bits = frame.compared_bits.value(parameters)
            # The highest bits of the field are compared.
            lowest_compared_bit = compared_field.highest_bit + 1 - number_of_compared_bits
            bits_by_case[case] = bits(compared_field.highest_bit, lowest_compared_bit)
        channel = compared.layout.channel or 0
        yield ComparedFact(
            fact_class=FactClass.POSITION,
            key=("channels", "compared", channel),
            value=bits_by_case,
            description=f"compared bits of data channel {channel}",
            path_in_file=(*channels_place, "compared", compared.layout.name),
        )


#: Identity of a frame that has no selector and belongs to no exchange.
_NOT_EXCHANGED = -1
#: Parts of interfaces, with the words between a fact about them and the name of the interface.
_JOINT_BY_PART = {
    "clock": " over ",
    "network": " of the network over ",
    "timeout": " of the timeout over ",
    "channels": " of the data channels over ",
    "port": " of the port over ",
}


def add_interfaces(reading: SpecReading, facts: ComparedFacts) -> None:
    """Add the facts of all interfaces, and the timings of the device."""
    for interface in reading.device.interfaces:
        constants_by_frame = _exchange_constants(interface)
        for layout in interface.layouts:
            identity = constants_by_frame.get(layout.name, _NOT_EXCHANGED)
            _add_frames(reading, interface, layout, identity=identity, facts=facts)
            # The bits of a joined number follow from its fields.
            facts.derived[FactClass.POSITION] += len(layout.joins)
        facts.add(_interface_facts(reading, interface))
        timings_path: Path = ("interfaces", interface.name, "timings")
        facts.add(timings(interface.timings, interface=interface.name, owner=timings_path))
    facts.add(timings(reading.device.timings, interface="", owner=("timings",)))


def _exchange_constants(interface: Interface) -> dict[str, str]:
    """Return the constants in the request of each exchange, by the names of its request and its reply.

    They identify an exchange without names, because readers choose different names: ``{"request": "0x1A from bit 0"}``.
    If the interface has no exchanges, the map is empty.
    """
    constants_by_frame: dict[str, str] = {}
    if not isinstance(interface, (Rs485, Spi)):
        return constants_by_frame
    layouts = {layout.name: layout for layout in interface.layouts}
    for exchange in interface.exchanges:
        fields = layouts[exchange.request].fields
        constant_texts: list[str] = []
        for field in fields:
            if isinstance(field.kind, Constant):
                constant_texts.append(f"{in_hex(field.kind.value)} from bit {field.low.render()}")
        constants_text = ", ".join(constant_texts)
        constants_by_frame[exchange.request] = constants_text
        # A reply to several requests is identified by the first request.
        constants_by_frame.setdefault(exchange.reply, constants_text)
    return constants_by_frame


def _add_frames(
    reading: SpecReading, interface: Interface, layout: Layout, identity: str | int, facts: ComparedFacts
) -> None:
    """Add the facts about a frame for each value that selects this layout.

    A layout without a selector is one frame, identified by ``identity``: the constants in the request of its exchange,
    or -1 if it belongs to no exchange.
    """
    path_in_file: Path = ("interfaces", interface.name, "layouts", layout.name)
    for frame_identity in layout.selects or (identity,):
        key: FactKey = ("frame", interface.name, layout.sender, layout.channel or 0, frame_identity)
        frame_subject = FactSubject(
            reading, key=key, path_in_file=path_in_file, description=f"'{layout.name}'", interface=interface.name
        )
        facts.add(_frame_facts(frame_subject, layout))
        facts.words[key] = word_bits(frame_subject, layout)
        for field in layout.fields:
            if field.group:
                facts.add_name(("group", interface.name), _group_name(frame_subject, field))


def _group_name(frame: FactSubject, field: Field) -> ComparedFact:
    """Return the fact that a field of a frame belongs to a group with a certain name."""
    bits_text = frame.reading.bits_of(frame.interface, field)
    return ComparedFact(
        fact_class=FactClass.POSITION,
        key=(*frame.key, bits_text),
        value=field.group,
        description=f"group of {bits_text} of {frame.description}",
        path_in_file=frame.reading.field_path(frame.path_in_file, field),
    )


def _frame_facts(frame: FactSubject, layout: Layout) -> Iterator[ComparedFact]:
    """Yield the facts about a frame as a whole: its sender, byte order, length and combinations of values.

    A frame of one byte needs no byte order, so the readings do not disagree if only one of them states it.
    """
    reading = frame.reading
    yield from frame.facts_of_part(FactClass.POSITION, layout, value=f"sent by the {layout.sender}", at="name")
    carried_as_path = reading.first_existing((*frame.path_in_file, "carried_as"), frame.path_in_file)
    yield frame.detail_fact(
        FactClass.POSITION, name="carried", value=layout.carried_as, noun="units", path_in_file=carried_as_path
    )
    has_several_bytes = layout.widest > 8
    is_stated = reading.document.has((*frame.path_in_file, "byte_order"))
    if layout.in_bytes and (has_several_bytes or is_stated):
        byte_order_path = (*frame.path_in_file, "byte_order") if is_stated else frame.path_in_file
        may_be_missing = not has_several_bytes
        yield frame.detail_fact(
            FactClass.BYTE_ORDER,
            name="order",
            value=layout.byte_order,
            noun="byte order",
            path_in_file=byte_order_path,
            may_be_missing=may_be_missing,
        )
    # A case is an order code, with a state of the registers that change the frame.
    length_by_case: dict[CodeAndState, str] = {}
    for case, parameters in reading.cases(frame.interface).items():
        length_by_case[case] = str(layout.bits.value(parameters))
    yield frame.detail_fact(
        FactClass.POSITION, name="length", value=length_by_case, noun="bits", path_in_file=frame.path_in_file
    )
    yield from _combination_facts(frame, layout)


def _combination_facts(frame: FactSubject, layout: Layout) -> Iterator[ComparedFact]:
    """Yield the verdict and the other facts of each combination of field values in a frame.

    A combination is identified by its bits for the first order code: ``bit 3 = 1, bits 7:4 = 0``.
    """
    if not layout.combinations:
        return
    sign_by_name = {sign.flag.name: sign for sign in layout.signs}
    first_parameters = next(iter(frame.reading.cases(frame.interface).values()), {})
    placed_fields = {placed_field.name: placed_field for placed_field in layout.place(first_parameters).fields}
    for combination in layout.combinations:
        # The conditions are pairs of a field's name and its value. The value of an active flag is 1.
        field_values = sign_by_name[combination.name].conditions
        condition_texts = [_condition_text(placed_fields[name], value) for name, value in field_values]
        conditions = ", ".join(sorted(condition_texts))
        subject = frame.inside(
            key=("combination", conditions),
            path_in_file=("combinations", combination.name),
            description=f"the combination of {conditions} in {frame.description}",
        )
        yield subject.existence_fact(FactClass.VERDICT, value=combination.makes_position.value, at="makes_position")
        yield from subject.stated_facts(combination)


def _condition_text(field: PlacedField, needed_value: int) -> str:
    """Return the bits of a field and the value that they must have: ``bit 3 = 0``.

    For a flag, ``needed_value`` is 1 if it must be active. The bit of an active-low flag has the opposite value.
    """
    is_active_low = isinstance(field.field.kind, Flag) and field.field.kind.active_low
    bit_value = 1 - needed_value if is_active_low else needed_value
    return f"{bits(field.highest_bit, field.lowest_bit)} = {bit_value}"


def _interface_facts(reading: SpecReading, interface: Interface) -> Iterator[ComparedFact]:
    """Yield the facts about an interface other than its frames, such as its clock, its port and its exchanges."""
    path_in_file: Path = ("interfaces", interface.name)
    interface_subject = FactSubject(
        reading,
        key=("interface", interface.name),
        path_in_file=path_in_file,
        description=interface.short,
        interface=interface.name,
        depends_on=(),
        joint=" over ",
    )
    yield from interface_subject.stated_facts(interface)
    for name, joint in _JOINT_BY_PART.items():
        subject = replace(
            interface_subject, key=(name, interface.name), path_in_file=(*path_in_file, name), joint=joint
        )
        # No interface has all of these parts. A part may depend on the order code, as in ``clocks_by_code``.
        part = getattr(interface, name, None)
        parts_by_code = getattr(interface, f"{name}s_by_code", ())
        if part:
            yield from subject.stated_facts(part)
        elif parts_by_code:
            yield from subject.stated_facts_by_code(parts_by_code)
    match interface:
        case Ssi():
            yield from _cable_clocks(reading, interface)
        case Biss():
            yield from _biss_facts(reading, interface)
            yield from channel_facts(reading, interface)
        case Rs485():
            yield from _rs485_facts(reading, interface)
            yield from _exchange_facts(interface)
        case Spi():
            yield from _exchange_facts(interface)


def _cable_clocks(reading: SpecReading, interface: Ssi) -> Iterator[ComparedFact]:
    """Yield a fact for each cable length: its highest clock, such as ``below 400000 Hz``.

    If the clock depends on the order code, the value is a map with the text for each code.
    """
    # The place of the fact is the first row for this length.
    first_index_by_length: dict[int, int] = {}
    for index, cable in enumerate(interface.cable_lengths):
        first_index_by_length.setdefault(cable.shorter_than_m, index)
    for length, index in first_index_by_length.items():
        rows = [row for row in interface.cable_lengths if row.shorter_than_m == length]
        rows_with_texts = [(row, f"{row.limit_words} {row.limit_hz} Hz") for row in rows]
        yield ComparedFact(
            fact_class=FactClass.CLOCK,
            key=("cable", "ssi", length),
            value=_value_by_code(reading, interface.name, rows_with_texts),
            description=f"clock for a cable shorter than {length} m",
            path_in_file=("interfaces", interface.name, "cable_lengths", index, rows[0].limit_key),
        )


def _value_by_code(
    reading: SpecReading, interface: str, rows_with_texts: Sequence[tuple[Restricted, str]]
) -> FactValue:
    """Return the text of the only row, or a map with the text for each order code if rows apply to different codes."""
    first_row, first_text = rows_with_texts[0]
    if len(rows_with_texts) == 1 and not first_row.only:
        return first_text
    values: dict[CodeAndState, str] = {}
    for case in reading.cases(interface):
        for row, row_text in rows_with_texts:
            if applies_to_code(row.only, case.code):
                values[case] = row_text
    return values


def _biss_facts(reading: SpecReading, interface: Biss) -> Iterator[ComparedFact]:
    """Yield the printed BiSS timeouts, each identified by its clock, and the fields of the control frame.

    A field of the control frame is identified by the number of bits that are sent before it.
    """
    for timeout in interface.timeouts:
        for index, printed in enumerate(timeout.printed):
            row_with_text = (timeout, f"{printed.timeout_ns} ns")
            yield ComparedFact(
                fact_class=FactClass.TIME,
                key=("timeout", "at", printed.clock_hz),
                value=_value_by_code(reading, interface.name, [row_with_text]),
                description=f"timeout over BiSS at {printed.clock_hz} Hz",
                path_in_file=("interfaces", interface.name, "timeout", "printed", index, "timeout_ns"),
            )
    bits_before = 0
    for control_field in interface.control_data:
        yield from _control_field_facts(reading, control_field, offset=bits_before)
        bits_before += control_field.bits


def _control_field_facts(reading: SpecReading, control_field: ControlField, offset: int) -> Iterator[ComparedFact]:
    """Yield the facts about a field of the BiSS control frame: its bits, its values and its CRC.

    ``offset`` is the number of bits that are sent before the field.
    """
    path_in_file: Path = ("interfaces", "biss", "control_data", "fields", control_field.name)
    subject = FactSubject(
        reading,
        key=("control", offset),
        path_in_file=path_in_file,
        description=f"field of the control frame from bit {offset + 1}",
    )
    yield from subject.facts_of_part(FactClass.POSITION, control_field, value=f"{control_field.bits} bits")
    for named_value in control_field.values:
        description = f"value {in_hex(named_value.value)} of {subject.description}"
        value_subject = subject.inside(
            key=("value", named_value.value), path_in_file=("values", named_value.name), description=description
        )
        yield from value_subject.facts_of_part(FactClass.VALUE, named_value, value="named")
    if control_field.crc:
        # The parameters of a CRC are in the list ``crcs`` of the spec.
        crc_subject = subject.inside(key=("crc",), path_in_file=(), description="the control frame's CRC over BiSS")
        crc_subject = replace(crc_subject, path_in_file=("crcs", control_field.crc))
        yield from crc_subject.stated_facts(reading.device.crc(control_field.crc))


def _rs485_facts(reading: SpecReading, interface: Rs485) -> Iterator[ComparedFact]:
    """Yield the data IDs of an RS-485 interface, and the contents of replies to memory accesses.

    A data ID is identified by its number, ``("data id", 3)``, and has the value ``control field 0x1A``. A reply is
    identified by the access and the busy flag, ``("memory", "read", 1)``, and has the value ``address as sent, data
    0``.
    """
    path_in_file: Path = ("interfaces", interface.name)
    for data_id in interface.data_ids:
        id_path = (*path_in_file, "data_ids", data_id.name)
        subject = FactSubject(
            reading, key=("data id", data_id.id), path_in_file=id_path, description=f"data ID {data_id.id:X}"
        )
        yield from subject.facts_of_part(
            FactClass.VALUE, data_id, value=f"control field {in_hex(data_id.control)}", at="control"
        )
    for index, access in enumerate(interface.memory_access):
        yield ComparedFact(
            fact_class=FactClass.SETTING,
            key=("memory", access.access, access.busy),
            value=f"address {comparable_text(access.address)}, data {comparable_text(access.data)}",
            description=f"reply to a {access.access} while the busy flag is {access.busy}",
            path_in_file=(*path_in_file, "memory_access", index),
        )


def _exchange_facts(interface: Rs485 | Spi) -> Iterator[ComparedFact]:
    """Yield a fact for each exchange of a request and a reply, such as ``read, with a reply, words of 8 bits``.

    An exchange is identified by the constants in its request: ``0x1A from bit 0``.
    """
    constants_by_frame = _exchange_constants(interface)
    for index, exchange in enumerate(interface.exchanges):
        constants = constants_by_frame[exchange.request]
        with_or_without = "with" if exchange.reply else "without"
        exchange_text = f"{exchange.purpose}, {with_or_without} a reply"
        if exchange.word_bits is not None:
            exchange_text += f", words of {exchange.word_bits.render()} bits"
        yield ComparedFact(
            fact_class=FactClass.SETTING,
            key=("exchange", interface.name, constants),
            value=exchange_text,
            description=f"request with {constants or 'no constant'}",
            path_in_file=("interfaces", interface.name, "exchanges", index),
        )


def _time_by_bound(timing: Timing) -> dict[str, str]:
    """Return the bounds of a timing by their keys, such as ``{"at_least_us": "16 µs"}``."""
    time_by_bound: dict[str, str] = {}
    for bound in ("at_least_us", "typical_us", "at_most_us"):
        microseconds = getattr(timing, bound)
        if microseconds is not None:
            time_by_bound[bound] = f"{microseconds} µs"
    return time_by_bound


def timings(printed_timings: tuple[Timing, ...], interface: str, owner: Path) -> Iterator[ComparedFact]:
    """Yield a fact for each bound of a timing with a symbol such as tm, and one fact for a timing without a symbol.

    The symbol and the bound identify a fact: ``("time", "ssi", "tm", "at_least_us")``. A timing without a symbol is
    identified by its numbers: ``("time", "ssi", "at least 16 µs, at most 32 µs")``. ``interface`` is "" for timings of
    the device.
    """
    interface_text = f" over {interface_label(interface)}" if interface else ""
    shared_names = repeated_names(printed_timings)
    for index, timing in enumerate(printed_timings):
        time_by_bound = _time_by_bound(timing)
        # Times for different order codes may have the same name, which then does not identify one of them.
        name = "" if timing.name in shared_names else timing.name
        path_in_file = (*owner, name or index)
        if not timing.symbol:
            bound_words = {bound: bound.removesuffix("_us").replace("_", " ") for bound in time_by_bound}
            times_text = ", ".join(f"{bound_words[bound]} {time}" for bound, time in time_by_bound.items())
            key: FactKey = ("time", interface, times_text)
            yield ComparedFact(
                fact_class=FactClass.TIME,
                key=key,
                value=times_text,
                description=f"a time{interface_text}",
                path_in_file=path_in_file,
                name=name,
                name_path=(*path_in_file, "name"),
            )
            continue
        symbol = comparable_text(timing.symbol).replace(" ", "")
        for bound_name, bound_time in time_by_bound.items():
            yield ComparedFact(
                fact_class=FactClass.TIME,
                key=("time", interface, symbol, bound_name),
                value=bound_time,
                description=f"time {timing.symbol}{interface_text}, '{bound_name}'",
                path_in_file=(*path_in_file, bound_name),
                name=name,
                name_path=(*path_in_file, "name"),
            )
