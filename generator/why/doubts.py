"""Other readings of a valid frame that no CRC contradicts, for users whose position looks wrong.

They do not explain an error, because every valid frame has them. The script of the decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Device, Interface, PlacedLayout, Spi, Ssi, Variant
from ..reference import codec
from ..reference.bits_and_values import from_binary, gray_to_binary
from .hypotheses import TypedFrame, check_constant_bits
from .recordings import LINES, line_name, recording_hypotheses

#: Text of each reading, in the order in which they are listed.
READINGS = (
    "if it was read one clock early",
    "if it was read one clock late",
    "if it is sent in Gray code",
    "if each of its parts is sent in Gray code",
    "if it is not sent in Gray code",
    "if the bytes are swapped",
    "if every bit is inverted",
)
#: Text of the reading of an SPI word whose last bits do not fill the last byte.
LEFT_ALIGNED = "if it is left-aligned in its bytes"
#: Text of the reading of a number that has fewer digits than the frame, by a byte or more.
CUT_OFF = "if its last bits are missing, and are 0"
#: Name of the position of an encoder if the manual describes no measurement.
_POSITION_NAME = "position"


def position_name(device: Device, variant: Variant) -> str:
    """Return the name of the position in the frames of an order code, or ``position`` without a measurement."""
    measurement = device.measurement_of(variant.interface)
    return measurement.position_name if measurement is not None else _POSITION_NAME


def other_positions(
    device: Device, variant: Variant, decoded: codec.DecodedFrame, typed_frame: TypedFrame | None = None
) -> list[tuple[str, int]]:
    """Return positions that a valid frame would have if it was misread: ``[("if it is sent in Gray code", 4711)]``.

    Over SSI, leading zeros of ``typed_frame``, the number as the user typed it, may also have been received. The frame
    is then a different part of it.

    The list is empty if the frame has an error or no position, or if it has numbers whose digits are sent separately.
    If the frame has a CRC, it contains only the shifts by one clock that the CRC does not detect. Readings with the
    same position as the frame itself are omitted.
    """
    placed_layout = decoded.layout
    if placed_layout is None or placed_layout.layout.in_bytes or placed_layout.layout.sender != "encoder":
        return []
    has_digit_fields = any(field.kind.digit_code for field in placed_layout.layout.fields)
    if decoded.problems or has_digit_fields:
        return []
    position_field_name = position_name(device, variant)
    position = decoded.values.get(position_field_name)
    is_count = isinstance(position, int) and not isinstance(position, bool)
    if not is_count:
        return []
    if decoded.crc is not None:
        texts_and_frames = list(zip(READINGS, _undetected_shifts(device, placed_layout, decoded.number), strict=False))
        return _positions_in_frames(device, placed_layout, texts_and_frames, position_field_name, position)
    may_be_bytes = typed_frame is None or not typed_frame.is_length_known or typed_frame.bits % 8 == 0
    other_frames = _frames_without_mistake(
        placed_layout, position_field_name, decoded.number, may_be_bytes=may_be_bytes
    )
    texts_and_frames = [*zip(READINGS, other_frames, strict=True)]
    if typed_frame is not None:
        texts_and_frames += _recorded_frames(device, variant, placed_layout, typed_frame)
    return _positions_in_frames(device, placed_layout, texts_and_frames, position_field_name, position)


def _positions_in_frames(
    device: Device,
    placed_layout: PlacedLayout,
    texts_and_frames: Sequence[tuple[str, int | None]],
    position_name: str,
    position: object,
) -> list[tuple[str, int]]:
    """Return the text and the position of each possible frame whose position differs from ``position``."""
    readings: list[tuple[str, int]] = []
    for reading_text, other_frame in texts_and_frames:
        if other_frame is None:
            continue
        other_position = codec.decode(device, placed_layout, other_frame).values[position_name]
        if isinstance(other_position, int) and other_position != position:
            readings.append((reading_text, other_position))
    return readings


def _undetected_shifts(device: Device, placed_layout: PlacedLayout, frame: int) -> Iterator[int | None]:
    """Yield the frame as it was before it was read one clock early and one clock late, if its CRC detects neither.

    A CRC whose start value is 0 and that is not inverted is also valid for a frame that is shifted by a 0. Yield None
    for a shift that the CRC or another check detects.
    """
    crc = device.crc_of(placed_layout)
    may_miss_shift = crc is not None and crc.init == 0 and crc.xorout == 0
    for other_frame in (frame << 1, frame >> 1):
        is_undetected = may_miss_shift and not codec.decode(device, placed_layout, other_frame).problems
        yield other_frame if is_undetected else None


def _recorded_frames(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[tuple[str, int]]:
    """Yield the frames that the typed digits may contain if they are not the last digits of the frame.

    In an SSI recording with more bits than the frame, the leading zeros that the user typed may also have been
    received. Each frame comes with a text, such as ``if the word comes first, and the other clocks read 0``.
    """
    interface = device.interface(variant.interface)
    left_aligned_frame = _left_aligned_frame(interface, placed_layout, typed_frame)
    if left_aligned_frame is not None:
        yield LEFT_ALIGNED, left_aligned_frame
    cut_frame = _cut_frame(placed_layout, typed_frame)
    if cut_frame is not None:
        yield CUT_OFF, cut_frame
    has_extra_zeros = not typed_frame.is_length_known and typed_frame.digit_bits > placed_layout.bits
    if not isinstance(interface, Ssi) or not has_extra_zeros:
        return
    received_bits = f"{typed_frame.number:0{typed_frame.digit_bits}b}"
    known_frames = {typed_frame.number}
    for hypothesis in recording_hypotheses(LINES[line_name(interface)], placed_layout, None, received_bits):
        if hypothesis.fits and hypothesis.frame not in known_frames:
            known_frames.add(hypothesis.frame)
            yield f"if {hypothesis.description}", hypothesis.frame


def _left_aligned_frame(interface: Interface, placed_layout: PlacedLayout, typed_frame: TypedFrame) -> int | None:
    """Return the frame at the beginning of the bytes of an SPI word, or None if it fills them or cannot be valid."""
    extra_bits = typed_frame.digit_bits - placed_layout.bits
    if not isinstance(interface, Spi) or not typed_frame.is_bytes or not 0 < extra_bits < 8:
        return None
    frame = typed_frame.number >> extra_bits
    _, is_possible = check_constant_bits(placed_layout, frame)
    return frame if is_possible else None


def _cut_frame(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> int | None:
    """Return the frame if a number lacks its last bits, which are at least a byte, or None if it cannot be valid.

    Such a number usually lacks its leading zeros, but a program may also have read too few bytes.
    """
    if typed_frame.is_length_known or not typed_frame.digit_bits:
        return None
    missing_bits = placed_layout.bits - typed_frame.digit_bits
    if missing_bits < 8:
        return None
    return _frame_if_possible(placed_layout, typed_frame.number << missing_bits)


def _frames_without_mistake(
    placed_layout: PlacedLayout, position_name: str, frame: int, *, may_be_bytes: bool
) -> Iterator[int | None]:
    """Yield the frame as it was before each mistake in ``READINGS``, in the same order, or None if it is impossible.

    The mistakes are: reading one clock early or late, three mistakes with Gray code, swapped bytes, and inverted bits.
    A frame that is read one clock early has an extra first bit and lacks its last bit. One clock late, it is the
    reverse. The frame is None if constants or parity bits would be wrong without swapped bytes or inverted bits. With
    ``may_be_bytes``, the frame may have been received as bytes, possibly with zeros in front of it.
    """
    yield _read_one_clock_later(placed_layout, frame)
    read_one_clock_earlier = frame >> 1
    yield read_one_clock_earlier
    if placed_layout.gray:
        yield None
        yield None
        # Decoding converts from Gray code. This conversion cancels it, so the position has the bits as they are sent.
        yield from_binary(placed_layout, frame)
    else:
        yield _with_position_from_gray(placed_layout, (position_name,), frame)
        part_names = _fields_of_joined_position(placed_layout, position_name)
        yield _with_position_from_gray(placed_layout, part_names, frame) if len(part_names) > 1 else None
        yield None
    byte_count = (placed_layout.bits + 7) // 8  # rounded up
    frame_with_reversed_bytes = int.from_bytes(frame.to_bytes(byte_count, "little"), "big")
    yield _frame_if_possible(placed_layout, frame_with_reversed_bytes) if may_be_bytes else None
    yield _frame_if_possible(placed_layout, frame ^ ((1 << placed_layout.bits) - 1))


def _frame_if_possible(placed_layout: PlacedLayout, frame: int) -> int | None:
    """Return a frame, or None if it has too many bits, or if one of its constants or parity bits is wrong."""
    if frame >> placed_layout.bits:
        return None
    _, are_correct = check_constant_bits(placed_layout, frame)
    return frame if are_correct else None


def _fields_of_joined_position(placed_layout: PlacedLayout, position_name: str) -> Sequence[str]:
    """Return the names of the fields that form the position together, such as ``["multiturn", "singleturn"]``.

    The list is empty if the position is a single field.
    """
    field_names = {field.name for field in placed_layout.fields}
    for join in placed_layout.layout.joins:
        if join.name == position_name:
            return [name for name in join.fields if name in field_names]
    return []


def _with_position_from_gray(placed_layout: PlacedLayout, number_names: Sequence[str], frame: int) -> int:
    """Return the frame with the numbers of these names converted from Gray code to binary."""
    converted_frame = frame
    for name in number_names:
        lowest_bit, width = placed_layout.lowest_bit_and_width_of(name)
        number = (frame >> lowest_bit) & ((1 << width) - 1)
        frame_without_number = converted_frame ^ (number << lowest_bit)
        converted_frame = frame_without_number | (gray_to_binary(number) << lowest_bit)
    return converted_frame


def _read_one_clock_later(placed_layout: PlacedLayout, frame: int) -> int:
    """Return the frame as it would be if it had been read one clock later: without its first bit, and with a last bit.

    The last bit, which was not received, is assumed to be 1 if constants and parity are correct only with a 1, and
    otherwise 0.
    """
    frame_mask = (1 << placed_layout.bits) - 1
    with_last_0 = (frame << 1) & frame_mask
    with_last_1 = with_last_0 | 1
    _, is_0_correct = check_constant_bits(placed_layout, with_last_0)
    _, is_1_correct = check_constant_bits(placed_layout, with_last_1)
    return with_last_1 if is_1_correct and not is_0_correct else with_last_0
