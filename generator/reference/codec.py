"""Encode and decode using only the model, for the command line and as a reference for testing all generated codecs."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import (
    Constant,
    CrcValue,
    Decimal,
    Device,
    Fault,
    Join,
    Parity,
    PlacedChannels,
    PlacedField,
    PlacedLayout,
    Unused,
    Variant,
    number_from_bytes,
)
from ..say import count_with_unit, frame_texts
from ..say.layout import as_one_number
from .bits_and_values import EncodeError as EncodeError
from .bits_and_values import Values as Values
from .bits_and_values import (
    bits_of_field,
    checked_number,
    compute,
    documented_bits,
    encode_digits,
    encode_value,
    from_binary,
    join_value,
    parity_bit,
    to_binary,
    unused_bits,
    value_and_meaning,
)
from .bits_and_values import number_of_text as number_of_text
from .findings import (
    CrcResult as CrcResult,
)
from .findings import (
    DecodedField as DecodedField,
)
from .findings import (
    DecodedFrame as DecodedFrame,
)
from .findings import (
    FrameProblem as FrameProblem,
)
from .findings import (
    problems_of_digits,
    problems_of_position,
    problems_of_value,
    problems_with_other_fields,
    range_message,
)

#: Name of the number that holds the unused bits of a decoded frame.
UNUSED = "unused"


def select_layout(
    device: Device, variant: Variant, sender: str, data: bytes
) -> tuple[PlacedLayout | None, tuple[FrameProblem, ...]]:
    """Find the layout of the frame ``data`` from ``sender``. Return it without problems, or None and the problem.

    Frames of several layouts have a selector, a field that identifies the layout by its value. The result is the first
    layout of the sender that has this value, or the first one without a selector.
    """
    layouts = [layout for layout in device.interface(variant.interface).layouts if layout.sender == sender]
    if not layouts:
        message = f"the {sender} sends no frames on this interface"
        return None, (FrameProblem(Fault.RANGE, field="", message=message),)
    valid_selector_values: list[int] = []
    for layout in layouts:
        placed_layout = layout.place(variant.parameters)
        if not layout.selector:
            return placed_layout, ()
        valid_selector_values.extend(layout.selects)
        if _selector_value(placed_layout, data) in layout.selects:
            return placed_layout, ()
    first_layout = layouts[0]  # The selector is at the same place in all layouts of the sender.
    selector_value = _selector_value(first_layout.place(variant.parameters), data)
    if selector_value is None:
        length_text = count_with_unit(len(data), "byte")
        message = frame_texts.too_few_bytes_message(length_text)
        return None, (FrameProblem(Fault.LENGTH, field="", message=message),)
    valid_values_text = ", ".join(f"{value:X}" for value in sorted(valid_selector_values))
    message = frame_texts.no_frame_message(first_layout.selector, f"{selector_value:X}", valid_values_text)
    return None, (FrameProblem(Fault.RANGE, field=first_layout.selector, message=message),)


def _selector_value(placed_layout: PlacedLayout, data: bytes) -> int | None:
    """Return the value of the selector, the field that identifies the layout of a frame.

    Return None if ``data`` ends before it, or if the order code has no selector. The bytes after the selector are
    ignored, so the frame may be incomplete or too long.
    """
    selector = placed_layout.find_field(placed_layout.layout.selector)
    if selector is None:
        return None
    if placed_layout.layout.byte_order == "low_byte_first":
        # The bytes up to the one with the highest bit of the selector.
        needed_byte_count = selector.highest_bit // 8 + 1
        ignored_low_bit_count = 0
    else:
        # The bytes up to the one with its lowest bit. The ignored bytes are the low bits of the frame.
        needed_byte_count = (placed_layout.bits - selector.lowest_bit + 7) // 8
        ignored_low_bit_count = placed_layout.bits - 8 * needed_byte_count
    if len(data) < needed_byte_count:
        return None
    number = number_from_bytes(placed_layout.layout, data[:needed_byte_count])
    lowest_bit_in_number = selector.lowest_bit - ignored_low_bit_count
    return (number >> lowest_bit_in_number) & selector.mask


def decode_bytes(device: Device, variant: Variant, sender: str, data: bytes) -> DecodedFrame:
    """Decode a frame of whole bytes whose selector field identifies the layout."""
    placed_layout, problems = select_layout(device, variant, sender, data)
    if placed_layout is None:
        return DecodedFrame(layout=None, number=0, fields=(), crc=None, problems=problems)
    return decode_placed(device, placed_layout, data)


def decode_placed(device: Device, placed_layout: PlacedLayout, data: bytes) -> DecodedFrame:
    """Decode a frame of whole bytes with a known layout."""
    number = number_from_bytes(placed_layout.layout, data)
    if 8 * len(data) != placed_layout.bits:
        needed_length = count_with_unit(placed_layout.bits // 8, "byte")
        return _result_of_wrong_length(placed_layout, number, needed_length=needed_length, actual_length=len(data))
    return decode(device, placed_layout, number)


def decode_bits(device: Device, placed_layout: PlacedLayout, number: int, bits: int) -> DecodedFrame:
    """Decode a frame of this many bits with a known layout."""
    if bits != placed_layout.bits:
        return _result_of_wrong_length(
            placed_layout, number, needed_length=f"{placed_layout.bits} bits", actual_length=bits
        )
    return decode(device, placed_layout, number)


def _result_of_wrong_length(
    placed_layout: PlacedLayout, frame: int, *, needed_length: str, actual_length: int
) -> DecodedFrame:
    """Return the result for a frame of the wrong length: one problem and no fields.

    ``needed_length`` is a text such as ``24 bits``, and ``actual_length`` the number in the same unit.
    """
    message = frame_texts.wrong_length_message(placed_layout.name, needed_length, f"{actual_length}")
    problem = FrameProblem(Fault.LENGTH, field="", message=message)
    return DecodedFrame(layout=placed_layout, number=frame, fields=(), crc=None, problems=(problem,))


def decode(device: Device, placed_layout: PlacedLayout, number: int) -> DecodedFrame:
    """Decode the frame ``number``, as it is sent, into its fields and its CRC, and find all errors.

    Errors are sorted in the order of ``Fault``. A number with too many bits is reported as a wrong length.
    """
    has_too_many_bits = number >> placed_layout.bits != 0
    if has_too_many_bits:
        actual_length = number.bit_length()
        return _result_of_wrong_length(
            placed_layout, number, needed_length=f"{placed_layout.bits} bits", actual_length=actual_length
        )
    problems: list[FrameProblem] = []
    fields: list[DecodedField] = []
    binary_number = to_binary(placed_layout, number)
    for placed_field in placed_layout.fields:
        sent_value = bits_of_field(placed_field, number)
        binary_value = bits_of_field(placed_field, binary_number)
        problems += problems_of_value(placed_field.field, binary_value)
        problems += problems_with_other_fields(placed_layout, placed_field, sent_value, number)
        fields += _decode_field(placed_field, sent_value, binary_value)
    problems += problems_of_position(device, placed_layout, binary_number)
    problems += problems_of_digits(device, placed_layout, number, binary_number)
    crc = _decode_crc(device, placed_layout, number)
    if crc is not None and not crc.ok:
        problems.append(_problem_of_crc(placed_layout, crc))
    fields += [_decode_join(placed_layout, join, number, binary_number) for join in placed_layout.layout.joins]
    if placed_layout.layout.has_unused:
        differing_bits = unused_bits(placed_layout, number)
        meaning = "unused bits that differ from the manual"
        fields.append(_computed_field(UNUSED, raw=differing_bits, value=differing_bits, meaning=meaning))
    order_of_faults = list(Fault)
    problems.sort(key=lambda problem: order_of_faults.index(problem.fault))
    return DecodedFrame(layout=placed_layout, number=number, fields=tuple(fields), crc=crc, problems=tuple(problems))


def _decode_crc(device: Device, placed_layout: PlacedLayout, frame: int) -> CrcResult | None:
    """Return the CRC in ``frame`` together with the CRC computed from its other bits, or None if it has no CRC."""
    placed_field = placed_layout.crc_field
    crc = device.crc_of(placed_layout)
    if placed_field is None or crc is None:
        return None
    received_crc = bits_of_field(placed_field, frame)
    computed_crc = compute(crc, placed_layout, frame)
    return CrcResult(crc.name, received=received_crc, computed=computed_crc, width=crc.width)


def _problem_of_crc(placed_layout: PlacedLayout, wrong_crc: CrcResult) -> FrameProblem:
    """Return the error for a wrong CRC. The message says if its bytes are only exchanged."""
    field_name = placed_layout.crc_field.name if placed_layout.crc_field is not None else ""
    received, computed = f"{wrong_crc.received:#04x}", f"{wrong_crc.computed:#04x}"
    if wrong_crc.has_exchanged_bytes:
        message = frame_texts.exchanged_crc_bytes_message(received, computed)
    else:
        message = frame_texts.wrong_crc_message(received, computed)
    return FrameProblem(Fault.CRC, field=field_name, message=message)


def _decode_join(placed_layout: PlacedLayout, join: Join, frame: int, binary_frame: int) -> DecodedField:
    """Return the number that several fields form together, such as multiturn and singleturn, as an additional field.

    ``frame`` is the frame as it is sent, and ``binary_frame`` is the frame with its Gray code converted to binary.
    """
    field_names = " and ".join(field.name for field in placed_layout.find_fields(join.fields))
    meaning = as_one_number(field_names) if len(join.fields) > 1 else ""
    value = join_value(placed_layout, join, binary_frame)
    raw = join_value(placed_layout, join, frame) if placed_layout.gray else value
    return _computed_field(join.name, raw=raw, value=value, meaning=meaning)


def _computed_field(name: str, raw: int, value: int, meaning: str) -> DecodedField:
    """Return a field that is computed from several other fields.

    It has no bit positions of its own, so ``high`` and ``low`` are -1.
    """
    return DecodedField(name, raw=raw, value=value, unit="", meaning=meaning, high=-1, low=-1)


def _decode_field(placed_field: PlacedField, sent_value: int, binary_value: int) -> Iterator[DecodedField]:
    """Yield a decoded field, followed by each named group of decimal digits in it, such as year and week.

    ``sent_value`` are its bits as they are sent, possibly in Gray code. ``binary_value`` is the same value in binary.
    """
    field = placed_field.field
    value, meaning = value_and_meaning(field, binary_value, placed_field.width)
    yield DecodedField(
        name=field.name,
        raw=sent_value,
        value=value,
        unit=field.unit,
        meaning=meaning,
        high=placed_field.highest_bit,
        low=placed_field.lowest_bit,
        scale=field.scale,
    )
    for digit_group in field.runs:
        # In 1234, the digits 34 have divisor 1 and modulus 100, and the digits 12 have divisor 100 and modulus 100.
        digits = binary_value // digit_group.divisor % digit_group.modulus
        yield DecodedField(
            name=digit_group.name,
            raw=digits,
            value=digits,
            unit="",
            meaning=digit_group.meaning,
            high=placed_field.highest_bit,
            low=placed_field.lowest_bit,
        )


def encode(device: Device, placed_layout: PlacedLayout, values: Values) -> int:
    """Encode the values of fields, by name, and return the frame as it is sent.

    Constants, parity bits and the CRC are added. The value of a join, a number that several fields form, can replace
    the values of these fields. Unused bits are sent as in the manual, except those that are 1 in the value ``unused``,
    which are inverted.

    Raises:
        EncodeError: A value is missing, unknown, or does not fit.
    """
    field_values = dict(values)
    for join in placed_layout.layout.joins:
        if join.name in field_values:
            joined_value = checked_number(field_values.pop(join.name))
            field_values |= _split_join(placed_layout, join, joined_value, field_values)
    frame_bits = _encode_fields(device, placed_layout, field_values)
    if placed_layout.layout.unused:
        inverted_bits = checked_number(field_values.pop(UNUSED, 0))
        frame_bits |= _encode_unused(placed_layout, inverted_bits)
    _check_names(placed_layout, field_values)
    # Parity bits and CRC are computed from the bits as they are sent, in Gray code. The CRC also covers parity bits.
    frame_bits = from_binary(placed_layout, frame_bits)
    for placed_field in placed_layout.fields:
        kind = placed_field.field.kind
        if isinstance(kind, Parity):
            correct_bit = parity_bit(placed_layout, kind, frame_bits)
            frame_bits |= correct_bit << placed_field.lowest_bit
    crc_field = placed_layout.crc_field
    crc = device.crc_of(placed_layout)
    if crc_field is not None and crc is not None:
        frame_bits |= compute(crc, placed_layout, frame_bits) << crc_field.lowest_bit
    return frame_bits


def _encode_fields(device: Device, placed_layout: PlacedLayout, values: Values) -> int:
    """Return the bits of all fields at their positions in the frame. Parity, CRC and unused bits are still 0.

    Raises:
        EncodeError: A value is missing or does not fit, or the position is outside the range of this encoder.
    """
    frame_bits = 0
    position_range = device.range_in(placed_layout.layout)
    for placed_field in placed_layout.fields:
        frame_bits |= _encode_field(placed_layout, placed_field, values) << placed_field.lowest_bit
    problem = range_message(position_range, placed_layout, frame_bits) if position_range is not None else ""
    if problem:
        raise EncodeError(problem)
    return frame_bits


def _check_names(placed_layout: PlacedLayout, values: Values) -> None:
    """Check that each value belongs to a field of the layout.

    Values of fields that other order codes have, but this one does not, must be 0.

    Raises:
        EncodeError: A name is unknown, or this order code has no such field.
    """
    known_names: set[str] = set()
    for field in placed_layout.layout.fields:
        known_names.add(field.name)
        known_names.update(digit_group.name for digit_group in field.runs)
    for name in values:
        if name not in known_names:
            raise EncodeError(f"there is no field '{name}' in {placed_layout.name}")
    for field in placed_layout.layout.fields:
        # The layout has the fields of all order codes. ``placed_layout`` has only those of this order code.
        has_nonzero_value = bool(values.get(field.name))
        if has_nonzero_value and placed_layout.find_field(field.name) is None:
            raise EncodeError(f"{field.name} {values[field.name]} does not fit: this order code has no such field")


def _encode_unused(placed_layout: PlacedLayout, inverted_bits: int) -> int:
    """Return the unused bits at their positions in the frame: as in the manual, with some of them inverted.

    In ``inverted_bits``, all unused fields are packed into one number, in which the bits to invert are 1.

    Raises:
        EncodeError: ``inverted_bits`` has bits that belong to no unused field.
    """
    frame_bits = 0
    bits_of_no_field = inverted_bits
    # The lowest bit of a field is ``low_in_unused`` in ``inverted_bits``, and ``placed_field.low`` in the frame.
    for placed_field, low_in_unused in placed_layout.unused:
        inverted_in_field = (inverted_bits >> low_in_unused) & placed_field.mask
        sent_bits = documented_bits(placed_field) ^ inverted_in_field
        frame_bits |= sent_bits << placed_field.lowest_bit
        bits_of_no_field &= ~(placed_field.mask << low_in_unused)
    if bits_of_no_field:
        raise EncodeError(
            f"'{UNUSED}' has the bits {bits_of_no_field:#x}, which are not unused bits of {placed_layout.name}"
        )
    return frame_bits


def _split_join(placed_layout: PlacedLayout, join: Join, joined_value: int, values: Values) -> dict[str, int]:
    """Split a joined number into the values of the fields that form it, and return them by name.

    Fields that this order code lacks are 0.

    Raises:
        EncodeError: The number does not fit in the fields, or ``values`` contains a different value for one of them.
    """
    value_by_field: dict[str, int] = {}
    remaining_bits = joined_value
    least_significant_first = reversed(join.fields)
    for name in least_significant_first:
        placed_field = placed_layout.find_field(name)
        width = placed_field.width if placed_field is not None else 0
        value_by_field[name] = remaining_bits & ((1 << width) - 1)
        remaining_bits >>= width
    if remaining_bits or joined_value < 0:
        raise EncodeError(f"{join.name} {joined_value} does not fit")
    for name, value in value_by_field.items():
        is_different = name in values and values[name] != value
        if is_different:
            raise EncodeError(f"{join.name} and its fields disagree")
    return value_by_field


def _encode_field(placed_layout: PlacedLayout, placed_field: PlacedField, values: Values) -> int:
    """Return the bits of one field as a number. CRC, parity and unused bits are 0 here, and are added later.

    Constants, and selectors with a single valid value, need no value in ``values``.

    Raises:
        EncodeError: The value of the field is missing, or does not fit.
    """
    name = placed_field.name
    kind = placed_field.field.kind
    if isinstance(kind, Constant):
        return kind.value
    if isinstance(kind, (Unused, CrcValue, Parity)):
        return 0
    if isinstance(kind, Decimal) and name not in values:
        # The values contain its groups of digits under their own names instead.
        return encode_digits(kind, values)
    if name not in values:
        is_selector = name == placed_layout.layout.selector
        if is_selector and len(placed_layout.layout.selects) == 1:
            return placed_layout.layout.selects[0]
        raise EncodeError(f"'{name}' is missing")
    field_bits = encode_value(kind, placed_field, values[name])
    highest = placed_field.mask
    if not 0 <= field_bits <= highest:
        raise EncodeError(frame_texts.too_wide_message(name, f"{field_bits}", f"{placed_field.width}"))
    return field_bits


def decode_channels(device: Device, frame: PlacedChannels, number: int) -> tuple[DecodedFrame, ...]:
    """Split the frame ``number`` into its data channels, decode each of them, and return the results.

    ``number`` must not have more bits than the frame.
    """
    decoded_channels = []
    for placed_layout, channel_bits in zip(frame.channels, frame.split(number), strict=True):
        decoded_channels.append(decode(device, placed_layout, channel_bits))
    return tuple(decoded_channels)
