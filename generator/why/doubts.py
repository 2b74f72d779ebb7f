"""Other readings of a valid frame whose position looks wrong, where nothing in the layout can contradict the frame.

They do not explain an error: every valid frame has them. The script of the decode page follows the same rules.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, PlacedLayout, Variant
from ..reference import codec
from ..reference.bits import binary_to_gray, gray_to_binary
from .tries import fixed_bits

#: Text of each reading, in the order in which they are listed.
READINGS = (
    "if it was read one clock early",
    "if it was read one clock late",
    "if it is sent in Gray code",
    "if it is not sent in Gray code",
    "if the bytes are swapped",
)


def other_positions(device: Device, variant: Variant, decoded: codec.Decoded) -> list[tuple[str, int]]:
    """Return other readings of the position with their texts, or nothing if a CRC or an error contradicts them."""
    placed = decoded.layout
    measurement = device.measurement_of(variant.interface)
    if placed is None or placed.layout.in_bytes or placed.layout.sender != "encoder" or measurement is None:
        return []
    position = decoded.values.get(measurement.of)
    if decoded.problems or decoded.crc is not None or not isinstance(position, int) or isinstance(position, bool):
        return []
    readings: list[tuple[str, int]] = []
    for text, frame in zip(READINGS, _frames(placed, measurement.of, decoded.number), strict=True):
        value = codec.decode(device, placed, frame).values[measurement.of] if frame is not None else position
        if isinstance(value, int) and value != position:
            readings.append((text, value))
    return readings


def _frames(placed: PlacedLayout, name: str, number: int) -> Iterator[int | None]:
    """Yield the frame without each mistake, or None if it cannot have the mistake."""
    mask = (1 << placed.bits) - 1
    early = number << 1 & mask
    yield next((frame for frame in (early, early | 1) if fixed_bits(placed, frame)[1]), early)
    yield number >> 1
    low, width = placed.place_of(name)
    position = number >> low & ((1 << width) - 1)
    others = number ^ position << low
    yield None if placed.gray else others | gray_to_binary(position) << low
    yield others | binary_to_gray(position) << low if placed.gray else None
    is_of_bytes = placed.bits % 8 == 0
    yield int.from_bytes(number.to_bytes(placed.bits // 8, "little"), "big") if is_of_bytes else None
