"""Other readings of a valid frame whose position looks wrong, where nothing in the layout can contradict the frame.

They do not explain an error: every valid frame has them. The script of the decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Device, PlacedLayout, Ssi, Variant
from ..reference import codec
from ..reference.bits import gray_to_binary, to_gray
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
)
#: Name of the position of an encoder whose counts are not known.
_POSITION_NAME = "position"


def position_name(device: Device, variant: Variant) -> str:
    """Return the name of the position, which is ``position`` for an encoder without a measurement."""
    measurement = device.measurement_of(variant.interface)
    return measurement.of if measurement is not None else _POSITION_NAME


def other_positions(
    device: Device, variant: Variant, decoded: codec.DecodedFrame, typed_frame: TypedFrame | None = None
) -> list[tuple[str, int]]:
    """Return other readings of the position, each with its text: ``[("if it is sent in Gray code", 4711)]``.

    Zeros in front of the typed frame may also have been received, so those recordings that SSI allows follow.

    The list is empty if a CRC or an error contradicts other readings, or if the frame has no position. Readings with
    the same position are left out.
    """
    placed_layout = decoded.layout
    if placed_layout is None or placed_layout.layout.in_bytes or placed_layout.layout.sender != "encoder":
        return []
    if decoded.problems or decoded.crc is not None:
        return []
    position_field = position_name(device, variant)
    position = decoded.values.get(position_field)
    is_count = isinstance(position, int) and not isinstance(position, bool)
    if not is_count:
        return []
    readings: list[tuple[str, int]] = []
    other_frames = _frames_without_mistake(placed_layout, position_field, decoded.number)
    texts_and_frames = [*zip(READINGS, other_frames, strict=True)]
    if typed_frame is not None:
        texts_and_frames += _recorded_frames(device, variant, placed_layout, typed_frame)
    for reading_text, other_frame in texts_and_frames:
        if other_frame is None:
            continue
        other_position = codec.decode(device, placed_layout, other_frame).values[position_field]
        if isinstance(other_position, int) and other_position != position:
            readings.append((reading_text, other_position))
    return readings


def _recorded_frames(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[tuple[str, int]]:
    """Yield the frames in a word of SSI with more typed bits than the frame, if its leading zeros were received.

    Each frame comes with a text, such as ``if the word comes first, and the other clocks read 0``.
    """
    interface = device.interface(variant.interface)
    if not isinstance(interface, Ssi) or typed_frame.exact or typed_frame.written <= placed_layout.bits:
        return
    received_bits = f"{typed_frame.number:0{typed_frame.written}b}"
    known_frames = {typed_frame.number}
    for hypothesis in recording_hypotheses(LINES[line_name(interface)], placed_layout, None, received_bits):
        if hypothesis.fits and hypothesis.frame not in known_frames:
            known_frames.add(hypothesis.frame)
            yield f"if {hypothesis.description}", hypothesis.frame


def _frames_without_mistake(placed_layout: PlacedLayout, position_name: str, frame: int) -> Iterator[int | None]:
    """Yield the frame without each mistake in ``READINGS``, in this order, or None if the mistake is impossible.

    A frame that was read early has an additional first bit and lacks its last bit. A frame that was read late is the
    reverse.
    """
    # One item for each text of ``READINGS``, in the same order.
    yield _read_one_clock_later(placed_layout, frame)
    read_one_clock_earlier = frame >> 1
    yield read_one_clock_earlier
    if placed_layout.gray:
        yield None
        yield None
        # The decoder will convert from Gray code. This undoes it, so the position consists of the bits as sent.
        yield to_gray(placed_layout, frame)
    else:
        yield _with_position_from_gray(placed_layout, (position_name,), frame)
        parts = _parts_of(placed_layout, position_name)
        yield _with_position_from_gray(placed_layout, parts, frame) if len(parts) > 1 else None
        yield None
    if placed_layout.bits % 8 == 0:
        frame_bytes = frame.to_bytes(placed_layout.bits // 8, "little")
        yield int.from_bytes(frame_bytes, "big")
    else:
        yield None


def _parts_of(placed_layout: PlacedLayout, position_name: str) -> Sequence[str]:
    """Return the names of the fields that are joined to the position: ``["multiturn", "singleturn"]``.

    The list is empty if the position is a single field.
    """
    field_names = {field.name for field in placed_layout.fields}
    for join in placed_layout.layout.joins:
        if join.name == position_name:
            return [name for name in join.fields if name in field_names]
    return []


def _with_position_from_gray(placed_layout: PlacedLayout, numbers: Sequence[str], frame: int) -> int:
    """Return the frame with each of these numbers converted from Gray code to binary."""
    for name in numbers:
        low, width = placed_layout.place_of(name)
        number = (frame >> low) & ((1 << width) - 1)
        frame_without_number = frame ^ (number << low)
        frame = frame_without_number | (gray_to_binary(number) << low)
    return frame


def _read_one_clock_later(placed_layout: PlacedLayout, frame: int) -> int:
    """Return the frame with its missing last bit, and without its first bit.

    The last bit is 1 if constants and parity are right only with a 1, and otherwise 0.
    """
    frame_mask = (1 << placed_layout.bits) - 1
    with_last_0 = (frame << 1) & frame_mask
    with_last_1 = with_last_0 | 1
    _, is_0_right = check_constant_bits(placed_layout, with_last_0)
    _, is_1_right = check_constant_bits(placed_layout, with_last_1)
    return with_last_1 if is_1_right and not is_0_right else with_last_0
