"""Other readings of a valid frame whose position looks wrong, where nothing in the layout can contradict the frame.

They do not explain an error: every valid frame has them. The script of the decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, PlacedLayout, Variant
from ..reference import codec
from ..reference.bits import gray_to_binary, to_gray
from .tries import fixed_bits

#: Text of each reading, in the order in which they are listed.
READINGS = (
    "if it was read one clock early",
    "if it was read one clock late",
    "if it is sent in Gray code",
    "if it is not sent in Gray code",
    "if the bytes are swapped",
)
#: Name of the position of an encoder whose counts are not known.
_POSITION = "position"


def position_name(device: Device, variant: Variant) -> str:
    """Return the name of the position, which an encoder in one line has even if it does not state its counts."""
    measurement = device.measurement_of(variant.interface)
    return measurement.of if measurement is not None else _POSITION


def other_positions(device: Device, variant: Variant, decoded: codec.Decoded) -> list[tuple[str, int]]:
    """Return other readings of the position with their texts, or nothing if a CRC or an error contradicts them."""
    placed = decoded.layout
    if placed is None or placed.layout.in_bytes or placed.layout.sender != "encoder":
        return []
    if decoded.problems or decoded.crc is not None:
        return []
    name = position_name(device, variant)
    position = decoded.values.get(name)
    # Only a count has other readings, not a text or a flag.
    if not isinstance(position, int) or isinstance(position, bool):
        return []
    readings: list[tuple[str, int]] = []
    frames = _frames_without_mistake(placed, name, decoded.number)
    for text, frame in zip(READINGS, frames, strict=True):
        if frame is None:
            continue
        other_position = codec.decode(device, placed, frame).values[name]
        if isinstance(other_position, int) and other_position != position:
            readings.append((text, other_position))
    return readings


def _frames_without_mistake(placed: PlacedLayout, name: str, number: int) -> Iterator[int | None]:
    """Yield the frame without each mistake in ``READINGS``, or None if it cannot have the mistake.

    ``name`` is the name of the position.
    """
    yield _read_one_clock_later(placed, number)
    yield number >> 1
    low, width = placed.place_of(name)
    position = number >> low & ((1 << width) - 1)
    without_position = number ^ position << low
    if placed.gray:
        yield None
        yield to_gray(placed, number)
    else:
        yield without_position | gray_to_binary(position) << low
        yield None
    if placed.bits % 8 == 0:
        yield int.from_bytes(number.to_bytes(placed.bits // 8, "little"), "big")
    else:
        yield None


def _read_one_clock_later(placed: PlacedLayout, number: int) -> int:
    """Return the frame with its missing last bit: the one with which constants and parity are right, or 0."""
    with_zero = number << 1 & ((1 << placed.bits) - 1)
    _, is_zero_right = fixed_bits(placed, with_zero)
    _, is_one_right = fixed_bits(placed, with_zero | 1)
    return with_zero | 1 if is_one_right and not is_zero_right else with_zero
