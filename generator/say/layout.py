"""Sentences that describe a frame, its CRC and the range of its position, and the places and labels of its fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import (
    Alternative,
    Combination,
    Constant,
    Crc,
    Device,
    Field,
    Interface,
    Join,
    Layout,
    LayoutRange,
    Measurement,
    Parity,
    Rs485,
    Sign,
    Unused,
    answer_combinations,
)
from ..model.expressions import Expression
from . import count_with_unit
from .errata import answer_names, deciding_alternatives, describe_erratum, errata_affecting, needed_answers
from .names_and_evidence import bits, conditions_text
from .text import (
    VERDICT_CLAUSES,
    Amount,
    CodeText,
    Statement,
    TextPart,
    as_sentence,
    join_groups,
    list_parts,
    spec_text,
    statement,
)


def describe_head(
    interface: Interface, layout: Layout, name: TextPart, alternatives: Sequence[Alternative] = ()
) -> Statement:
    """Return a sentence with the frame's ``name``, its sender, its interface and its length.

    If only the answers to ``alternatives`` (questions that the manual leaves open) decide the length, each possible
    length is followed by its answers.
    """
    channel = f", data channel {layout.channel}" if layout.channel is not None else ""
    sender_text = f", sent by the {layout.sender} over {interface.title}{channel}: "
    return statement(name, sender_text, *describe_size(layout, alternatives), source=layout.source)


def describe_size(layout: Layout, alternatives: Sequence[Alternative] = ()) -> tuple[TextPart, ...]:
    """Return the length and the transmission order of a frame as parts of a statement.

    For example ``25 bits, most significant bit first``, ``4 bytes, low byte first``, or ``45 bits in 6 bytes, …``.
    If the length depends on the answers to ``alternatives``, it is given for each of them: ``25 (a) or 26 (b) bits``.
    """
    if not layout.in_bytes:
        return *_number_of_bits(layout, alternatives), " bits, most significant bit first"
    length_text = count_with_unit(layout.widest // 8, "byte")
    if layout.widest > 8:
        length_text += f", {layout.byte_order.replace('_', ' ')}"
    # The encoder may send fewer bits than the bytes hold.
    if layout.sent_bits != layout.bits:
        return layout.sent_bits, f" bits in {length_text}"
    return (length_text,)


def _number_of_bits(layout: Layout, alternatives: Sequence[Alternative]) -> Iterator[TextPart]:
    """Yield the number of bits in a frame as parts of a statement.

    If only the answers to ``alternatives`` decide it, each possible number is followed by the names of its answers:
    ``25 (a) or 26 (b)``. Otherwise, it is an expression such as ``position_bits + 8``.
    """
    deciding_questions = deciding_alternatives(alternatives, set(layout.bits.parameters))
    if not deciding_questions:
        yield layout.bits
        return
    lengths_and_answers: list[list[TextPart]] = []
    for answers, answered_parameters in answer_combinations(deciding_questions):
        bit_count = layout.bits.value(answered_parameters)
        lengths_and_answers.append([f"{bit_count} (", *answer_names(answers), ")"])
    yield from join_groups(lengths_and_answers, " or ")


def describe_layout(device: Device, interface: Interface, frame: Layout) -> Iterator[Statement]:
    """Yield all statements about a frame except its name, sender and length."""
    yield from spec_text(frame.printed_name, label="In the manual")
    yield from describe_layout_facts(interface, frame)
    yield from needed_answers(device, frame)
    yield from spec_text(frame.note)
    yield from errata_of(device, interface, frame)


def errata_of(device: Device, interface: Interface, frame: Layout) -> Iterator[Statement]:
    """Yield the errata about a frame as a whole."""
    yield from map(describe_erratum, errata_affecting(device, f"interfaces.{interface.name}.{frame.name}"))


def has_excess(layout: Layout) -> bool:
    """Return whether a number is added to the position before it is sent in Gray code (Gray excess)."""
    return layout.gray_excess is not None and layout.gray_excess != Expression(0)


def _has_parity_over_gray(layout: Layout) -> bool:
    """Return whether a parity bit covers a field that can be in Gray code."""
    names_of_gray_fields = set(layout.field_names_of(layout.gray_of))
    for field in layout.fields:
        if isinstance(field.kind, Parity) and not names_of_gray_fields.isdisjoint(field.kind.of):
            return True
    return False


def _excess_number_or_parameter(layout: Layout) -> str | CodeText:
    """Return the number, or the parameter with the number, that is added to the position before it is Gray-coded.

    The number is ``0`` if nothing is added.
    """
    excess = layout.gray_excess or Expression(0)
    return str(excess.constant) if excess.is_constant else CodeText(excess.render())


def describe_layout_facts(interface: Interface, layout: Layout) -> Iterator[Statement]:
    """Yield the facts about a frame as a whole, as far as it has them.

    These are its selector values, its Gray code, its bits without a field, the numbers that consist of several fields,
    and the combinations of values that decide the verdict on the position.
    """
    yield from describe_selector(interface, layout)
    yield from _gray_code_facts(layout)
    if _has_parity_over_gray(layout):
        yield statement("A parity bit covers the bits as they are sent, before Gray code is converted")
    if layout.gaps:
        yield statement(f"Bits without a field are {layout.gaps}")
    yield from describe_joins(layout)
    combination_by_name = {combination.name: combination for combination in layout.combinations}
    # A sign is a set of field values that decides the verdict. The signs of combinations have their names.
    for sign in layout.signs:
        if sign.flag.name in combination_by_name:
            yield describe_combination(layout, sign, combination_by_name[sign.flag.name])


def _gray_code_facts(layout: Layout) -> Iterator[Statement]:
    """Yield which number of a frame is in Gray code, when it is, and what is added to it before it is sent.

    Nothing is yielded for a frame without Gray code.
    """
    number_name = CodeText(layout.gray_of)
    added_number = _excess_number_or_parameter(layout)
    # ``gray_when`` is the parameter that selects Gray code, and is empty if the code never changes.
    if layout.gray_when:
        parameter = CodeText(layout.gray_when)
        yield statement(number_name, " is in Gray code while ", parameter, " is 1, and in binary while it is 0")
        if has_excess(layout):
            yield statement("In Gray code, ", added_number, " is added to it before it is sent (Gray excess)")
    elif has_excess(layout):
        yield statement(number_name, " is in Gray excess: it is sent in Gray code after ", added_number, " is added")
    elif layout.gray_of:
        yield statement(number_name, " is in Gray code")


def describe_combination(layout: Layout, sign: Sign, combination: Combination) -> Statement:
    """Return the verdict on the position while several fields have certain values, with the meaning, remedy and note.

    An example is ``While a is 1 and b is 0, the position is not usable: …``. ``sign.conditions`` are pairs of a field
    name and its value.
    """
    fields_and_values = [(layout.field(name), value) for name, value in sign.conditions]
    conditions = conditions_text(fields_and_values)
    manual_texts = (combination.meaning, combination.remedy, combination.note)
    manual_sentences = [as_sentence(manual_text) for manual_text in manual_texts if manual_text]
    # A statement has no full stop at its end.
    description = " ".join(manual_sentences).removesuffix(".")
    return statement(
        "While ",
        *conditions.parts,
        f", {VERDICT_CLAUSES[combination.makes_position]}: ",
        description,
        label=combination.name,
        source=combination.source,
    )


def describe_selector(interface: Interface, layout: Layout) -> Iterator[Statement]:
    """Yield the values of the selector field that identify the frame, such as ``Its data_id is 0 (position) or 1``.

    Values are in hexadecimal, and followed by the names of data IDs. Nothing is yielded for a frame without a selector.
    """
    if not layout.selects:
        return
    name_by_data_id: dict[int, str] = {}
    if isinstance(interface, Rs485):
        name_by_data_id = {data_id.id: data_id.name for data_id in interface.data_ids}
    selector_values = []
    for value in layout.selects:
        name_in_parentheses = f" ({name_by_data_id[value]})" if value in name_by_data_id else ""
        selector_values.append(f"{value:X}{name_in_parentheses}")
    yield statement("Its ", CodeText(layout.selector), " is ", *list_parts(selector_values, " or "))


def describe_joins(layout: Layout) -> Iterator[Statement]:
    """Yield a statement for each number that consists of several fields, or of one field with a different name."""
    for joined_number in layout.joins:
        is_one_field = joined_number.fields == (joined_number.name,)
        if not is_one_field:
            yield describe_join(joined_number)


def describe_join(joined_number: Join) -> Statement:
    """Return the fields that form a number, ``position consists of turns and steps, …``, or the one that equals it."""
    listed_names = list_parts([CodeText(name) for name in joined_number.fields])
    if len(joined_number.fields) == 1:
        return statement(CodeText(joined_number.name), " is the same as ", *listed_names)
    return statement(CodeText(joined_number.name), " consists of ", *listed_names, ", most significant part first")


def as_one_number(parts: str) -> str:
    """Return the phrase for several parts that form one number. ``parts`` lists them."""
    return f"{parts} as one number"


def describe_crc(device: Device, checksum: Crc) -> Iterator[Statement]:
    """Yield all statements about a CRC: its parameters, its note and its errata."""
    yield describe_crc_head(device, checksum)
    yield from spec_text(checksum.note)
    yield from map(describe_erratum, errata_affecting(device, f"crcs.{checksum.name}"))


def describe_crc_head(device: Device, checksum: Crc) -> Statement:
    """Return one sentence with the name, the width and the parameters of a CRC."""
    width_text = count_with_unit(checksum.width, "bit")
    parameters = crc_parameters(device, checksum)
    return statement(f"CRC {checksum.name} of {width_text}: {parameters}", source=checksum.source)


def crc_parameters(device: Device, checksum: Crc) -> str:
    """Return the polynomial, start value, reflection and final XOR of a CRC, separated by commas."""
    start_value = f"0x{checksum.init:X}" if checksum.init else "0"
    parameter_texts = [
        checksum.polynomial,
        f"start value {start_value}",
        crc_reflected(device, checksum),
        crc_sent(checksum),
    ]
    return ", ".join(text for text in parameter_texts if text)


def crc_reflected(device: Device, checksum: Crc) -> str:
    """Return which sides of a CRC are reflected, such as ``input and output reflected``, or "" if neither is."""
    reflected_sides = []
    if device.reflects_input(checksum):
        reflected_sides.append("input")
    if checksum.refout:
        reflected_sides.append("output")
    return f"{' and '.join(reflected_sides)} reflected" if reflected_sides else ""


def crc_sent(checksum: Crc) -> str:
    """Return how a CRC is sent: ``sent inverted``, ``sent after an XOR with 0x…``, or ``sent unchanged``."""
    if checksum.xorout == checksum.mask:
        return "sent inverted"
    return f"sent after an XOR with 0x{checksum.xorout:X}" if checksum.xorout else "sent unchanged"


def crc_inverted(checksum: Crc) -> str:
    """Return in short how a CRC is sent: ``inverted``, ``XOR 0x…`` or ``not inverted``."""
    if checksum.xorout == checksum.mask:
        return "inverted"
    return f"XOR {checksum.xorout:#X}" if checksum.xorout else "not inverted"


#: Color class of values without their own class.
DATA = "data"


def box_colour(field: Field) -> str:
    """Return the color class of a field in pictures. Similar kinds of fields share a class."""
    return field.kind.role


def is_reserved(field: Field) -> bool:
    """Return whether a field is unused and has no name in the manual."""
    return isinstance(field.kind, Unused) and not field.printed_name


def box_label(field: Field) -> str:
    """Return the text for the box of a field in a picture: its name as words, such as ``status error``.

    A constant also has its value, as in ``mode = 1``. The text for zeros without a name in the manual is ``unused`` or,
    if they are a constant or padding, ``0``.
    """
    match field.kind:
        case Unused(value=value) if not field.printed_name and value == 0:
            return "unused"
        case Constant(value=value, padding_of=padded_field):
            value_text = f"{value:X}h" if value > 9 else f"{value}"
            # ``padding_of`` is the name of the field that the constant pads. It is empty for any other constant.
            is_unnamed = bool(padded_field) or not field.printed_name
            if value == 0 and is_unnamed:
                return value_text
            return f"{name_as_words(field.name)} = {value_text}"
        case _:
            return name_as_words(field.name)


def name_as_words(name: str) -> str:
    """Return a name from a spec with spaces in place of underscores."""
    return name.replace("_", " ")


def describe_measurement(measurement: Measurement) -> Statement:
    """Return the resolution and the range of a position, as far as the spec states them.

    The resolution is the counts per revolution and the number of revolutions, or the length of a count. The range is
    the total number of counts and the highest position.
    """
    quantity_parts: list[tuple[TextPart, ...]] = []
    if measurement.counts_per_turn is not None:
        quantity_parts.append((Amount(measurement.counts_per_turn, "counts"), " per revolution"))
    if measurement.turns is not None:
        quantity_parts.append((Amount(measurement.turns, "revolutions"),))
    if measurement.step_um is not None:
        quantity_parts.append((Amount(measurement.step_um, "µm"), " per count"))
    if measurement.step_nm is not None and measurement.per_counts is None:
        quantity_parts.append((Amount(measurement.step_nm, "nm"), " per count"))
    if measurement.step_nm is not None and measurement.per_counts is not None:
        step_length = Amount(measurement.step_nm, "nm")
        step_counts = Amount(measurement.per_counts, "counts")
        quantity_parts.append((step_length, " per ", step_counts))
    if measurement.modulus is not None:
        quantity_parts.append((Amount(measurement.modulus, "counts"), " in total"))
    if measurement.highest is not None:
        quantity_parts.append(("maximum ", measurement.highest))
    return statement(*join_groups(quantity_parts), source=measurement.source)


def describe_position_range(layout_range: LayoutRange) -> Statement:
    """Return the range of the position in one frame: that it never wraps, or its revolutions, counts and maximum."""
    if not layout_range.wraps:
        return statement("never wraps around", source=layout_range.source)
    quantity_parts: list[tuple[TextPart, ...]] = []
    if layout_range.turns is not None:
        quantity_parts.append((Amount(layout_range.turns, "revolutions"),))
    if layout_range.modulus is not None:
        quantity_parts.append((Amount(layout_range.modulus, "counts"), " in total"))
    if layout_range.highest is not None:
        quantity_parts.append(("maximum ", layout_range.highest))
    return statement(*join_groups(quantity_parts), source=layout_range.source)


def own_ranges(device: Device, interface: str) -> Iterator[tuple[str, LayoutRange]]:
    """Yield the name of each frame of an interface whose position has a range of its own, with that range."""
    for layout in device.interface(interface).layouts:
        if layout.position_range is not None:
            yield layout.name, layout.position_range


def frame_bytes(layout: Layout, bit_count: int, highest_bit: int, lowest_bit: int) -> str:
    """Return the bytes of a frame that contain some bits, such as ``byte 1, bits 7:1`` or ``bytes 2 to 4``.

    The frame has ``bit_count`` bits. ``highest_bit`` and ``lowest_bit`` are the highest and lowest of these bits in the
    frame as one number. Bytes are counted from 0 in the order sent. If the bits fill several bytes only in part, the
    result has their numbers in the whole frame.
    """
    first_byte, last_byte = _first_and_last_byte(layout, bit_count, highest_bit, lowest_bit)
    # From the lowest bit of a byte to the highest bit of a byte.
    are_whole_bytes = lowest_bit % 8 == 0 and highest_bit % 8 == 7
    if are_whole_bytes:
        return f"byte {first_byte}" if first_byte == last_byte else f"bytes {first_byte} to {last_byte}"
    if first_byte == last_byte:
        return f"byte {first_byte}, {bits(highest_bit % 8, lowest_bit % 8)}"
    return f"{bits(highest_bit, lowest_bit)} of the frame as one number"


def _first_and_last_byte(layout: Layout, bit_count: int, highest_bit: int, lowest_bit: int) -> tuple[int, int]:
    """Return the first and the last byte sent that have these bits of a frame of ``bit_count`` bits."""
    lowest_byte, highest_byte = lowest_bit // 8, highest_bit // 8
    if layout.byte_order == "low_byte_first":
        return lowest_byte, highest_byte
    # The byte with the highest bits is sent first.
    last_byte_of_frame = bit_count // 8 - 1
    return last_byte_of_frame - highest_byte, last_byte_of_frame - lowest_byte


def bit_place(layout: Layout, bit_count: int, highest_bit: int, lowest_bit: int) -> str:
    """Return the position of a field in short: ``46:31``, or ``byte 2.7:4`` for bits 7 to 4 of byte 2.

    ``highest_bit`` and ``lowest_bit`` are its highest and lowest bit in the frame as one number of ``bit_count`` bits.
    The first byte is byte 0. ``bytes 1.3-2.7`` means from bit 3 of byte 1 to bit 7 of byte 2.
    """
    is_one_bit = highest_bit == lowest_bit
    if not layout.in_bytes:
        return f"{highest_bit}" if is_one_bit else f"{highest_bit}:{lowest_bit}"
    first_byte, last_byte = _first_and_last_byte(layout, bit_count, highest_bit, lowest_bit)
    if first_byte != last_byte:
        # From the lowest bit of a byte to the highest bit of a byte.
        are_whole_bytes = lowest_bit % 8 == 0 and highest_bit % 8 == 7
        if are_whole_bytes:
            return f"bytes {first_byte}-{last_byte}"
        first_bit, last_bit = (
            (lowest_bit, highest_bit) if layout.byte_order == "low_byte_first" else (highest_bit, lowest_bit)
        )
        return f"bytes {first_byte}.{first_bit % 8}-{last_byte}.{last_bit % 8}"
    fills_byte = highest_bit - lowest_bit == 7
    if fills_byte:
        return f"byte {first_byte}"
    place_in_byte = f"byte {first_byte}.{highest_bit % 8}"
    return place_in_byte if is_one_bit else f"{place_in_byte}:{lowest_bit % 8}"


def field_place(layout: Layout, field: Field, alternatives: Sequence[Alternative] = ()) -> Iterator[TextPart]:
    """Yield the location of a field with its padding: in bytes for a frame that consists of bytes, otherwise in bits.

    If only the answers to ``alternatives`` (questions that the manual leaves open) decide the location, each possible
    location is followed by its answers. If other parameters decide it, only the lowest bit is given, as an expression.
    """
    width_with_padding = Expression(field.container) if field.container else field.width
    highest_bit = field.low + width_with_padding - Expression(1)
    deciding_parameters = {*field.low.parameters, *highest_bit.parameters}
    deciding_questions = deciding_alternatives(alternatives, deciding_parameters)
    if deciding_parameters and not deciding_questions:
        yield from ("starting at bit ", field.low)
        return
    places_and_answers: list[list[TextPart]] = []
    # If no alternative decides, there is one combination, without answers.
    for answers, answered_parameters in answer_combinations(deciding_questions):
        highest_bit_number = highest_bit.value(answered_parameters)
        lowest_bit_number = field.low.value(answered_parameters)
        answers_in_parentheses: list[TextPart] = [" (", *answer_names(answers), ")"] if answers else []
        places_and_answers.append([_place_text(layout, highest_bit_number, lowest_bit_number), *answers_in_parentheses])
    yield from join_groups(places_and_answers, " or ")


def _place_text(layout: Layout, highest_bit: int, lowest_bit: int) -> str:
    """Return a range of bits as text: ``byte 1, bits 7:1``, ``bits 46:31``, or ``absent`` if it has no bits."""
    if highest_bit < lowest_bit:
        return "absent"
    # A register has no sender. Its bits are always numbered as bits of one number.
    is_frame = bool(layout.sender)
    if layout.in_bytes and is_frame:
        return frame_bytes(layout, layout.widest, highest_bit, lowest_bit)
    return bits(highest_bit, lowest_bit)
