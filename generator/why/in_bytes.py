"""The usual mistakes with a frame of bytes, as RS-485 carries them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Constant, Crc, Device, Parity, PlacedLayout, Variant, number_from_bytes, number_to_bytes
from ..reference.codec import parity_bit
from .in_bits import POLYNOMIALS, OtherCrc, as_sent, read_as
from .tries import NOT_INVERTED, Try

#: More bytes before or after a frame are another matter than a request that is heard back.
_MOST_MORE = 4


def tries(device: Device, variant: Variant, sender: str, given: PlacedLayout | None, data: bytes) -> Iterator[Try]:
    """Every single mistake that could have made ``data`` of a sound frame of the sender.

    By ``given``, if that is not None, they are one.
    """
    layouts = [item for item in device.interface(variant.interface).layouts if item.sender == sender and item.in_bytes]
    for placed in (item.place(variant.parameters) for item in layouts):
        crc = device.crc_of(placed.layout)
        if crc is None or crc.width != 8:
            continue
        if given is not None and given.name == placed.name and 8 * len(data) == placed.bits:
            yield from _computed_otherwise(placed, crc, data)
        yield from _moved(placed, crc, data)


def is_sound(device: Device, placed: PlacedLayout, data: bytes) -> bool:
    """Return whether the CRC and the constants of the frame are right."""
    crc = device.crc_of(placed.layout)
    return crc is not None and crc.width == 8 and _read_as("", "", placed, crc, data).fits


def _computed_otherwise(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """The frame is as it was sent; the CRC is another one."""
    same = _over_bytes(as_sent(placed, crc, number_from_bytes(placed.layout, data)), data)
    yield from (replace(same, kind=kind, text=words, crc=other) for kind, words, other in other_crcs(crc))
    without = int.from_bytes(data[1:-1], "big")
    yield replace(
        same,
        kind="first_byte_left_out",
        text="the CRC is over the bytes after the first",
        data=without,
        bits=same.bits - 8,
    )


def other_crcs(crc: Crc) -> Iterator[OtherCrc]:
    """The CRC inverted or not, with another start value, or with another polynomial of its length."""
    turned = "the CRC is inverted" if not crc.xorout else "the CRC is not inverted"
    # With x^8 + 1 a start value only adds itself to the result.
    also = f", or starts with {crc.mask ^ crc.init:#x}, which is the same here" if crc.is_xor else ""
    yield NOT_INVERTED, turned + also, replace(crc, xorout=crc.xorout ^ crc.mask)
    for start in () if crc.is_xor else sorted({0, crc.mask} - {crc.init}):
        yield "start_value", f"the CRC starts with {start:#x}", replace(crc, init=start)
    for polynomial in POLYNOMIALS:
        if polynomial.bit_length() == 9:
            for reflected in (False, True):
                words = f"the polynomial is {polynomial:#x}, {'least' if reflected else 'most'} significant bit first"
                yield "other_polynomial", words, replace(crc, poly=polynomial & 0xFF, refin=reflected, refout=reflected)


def _moved(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """The bytes do not begin and end where the frame does, or are inverted."""
    size = placed.bits // 8
    more = len(data) - size
    if 0 < more <= _MOST_MORE:
        plural = f"{more} bytes" if more > 1 else "a byte"
        words = f"{plural} in front of the frame, such as the request heard back"
        yield _read_as("bytes_in_front", words, placed, crc, data[more:])
        yield _read_as("bytes_behind", f"{plural} behind the frame", placed, crc, data[:size])
    if more in (-1, 0):
        for first in _first_bytes(placed):
            behind = "" if more else ", and a byte follows the frame"
            words = f"the first byte, {first:02X}, is missing{behind}"
            yield _read_as("first_byte_lost", words, placed, crc, bytes([first, *data[: size - 1]]))
    if more == 0:
        yield _read_as("all_inverted", "every bit is inverted", placed, crc, bytes(byte ^ 0xFF for byte in data))


def _read_as(kind: str, words: str, placed: PlacedLayout, crc: Crc, data: bytes) -> Try:
    return _over_bytes(read_as(kind, words, placed, crc, number_from_bytes(placed.layout, data)), data)


def _over_bytes(item: Try, data: bytes) -> Try:
    """The same with the CRC over the bytes, whatever their order makes of them as a number."""
    return replace(item, data=int.from_bytes(data[:-1], "big"), received=data[-1], by_bytes=True)


def _first_bytes(placed: PlacedLayout) -> Iterator[int]:
    """What a frame of this layout can begin with, where its first byte holds nothing but what tells the layout."""
    first = number_from_bytes(placed.layout, bytes([0xFF, *bytes(placed.bits // 8 - 1)]))
    inside = [item for item in placed.fields if first >> item.low & item.mask]
    selector = placed.layout.selector
    if any(not isinstance(item.field.kind, (Constant, Parity)) and item.name != selector for item in inside):
        return
    for selected in placed.layout.selects:
        number = 0
        for item in inside:
            if item.name == selector:
                number |= selected << item.low
            elif isinstance(item.field.kind, Constant):
                number |= item.field.kind.value << item.low
        for item in inside:
            if isinstance(item.field.kind, Parity):
                number |= parity_bit(placed, item.field.kind, number) << item.low
        yield number_to_bytes(placed.layout, number, placed.bits)[0]
