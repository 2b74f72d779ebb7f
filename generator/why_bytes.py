"""The usual mistakes with a frame of bytes, as RS-485 carries them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .codec import number_from_bytes, number_to_bytes
from .model import Crc, Device, PlacedLayout, Variant
from .why_bits import POLYNOMIALS
from .why_tries import Try, fixed_bits, usual

#: More bytes before or after a frame are another matter than a request that is heard back.
_MOST_MORE = 4


def tries(device: Device, variant: Variant, sender: str, given: PlacedLayout | None, data: bytes) -> Iterator[Try]:
    """Every single mistake that could have made ``data`` of a sound frame of the sender; by ``given``, if that is not None, they are one."""
    layouts = [item for item in device.interface(variant.interface).layouts if item.sender == sender and item.carried_as == "bytes"]
    for placed in (item.place(variant.parameters) for item in layouts):
        field = placed.layout.crc_field
        if field is None or device.crc(field.crc).width != 8:
            continue
        crc = device.crc(field.crc)
        if given is not None and given.name == placed.name and 8 * len(data) == placed.bits:
            yield from _computed_otherwise(placed, crc, data)
        yield from _moved(placed, crc, data)


def _computed_otherwise(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """The frame is as it was sent; the CRC is another one."""
    number = number_from_bytes(placed.layout, data)
    fixed, right = fixed_bits(placed, number)
    bits = 8 * len(data) - 8
    same = Try("", "", crc, int.from_bytes(data[:-1], "big"), bits, data[-1], crc.width, True, fixed=fixed if right else 0, usual=usual(placed, number))
    turned = "the CRC is inverted" if not crc.xorout else "the CRC is not inverted"
    # With x^8 + 1 a start value only adds itself to the result.
    also = f", or starts with {crc.mask ^ crc.init:#x}, which is the same here" if crc.form == "xor" else ""
    yield replace(same, kind="crc_not_inverted", text=turned + also, crc=replace(crc, xorout=crc.xorout ^ crc.mask))
    for start in () if crc.form == "xor" else sorted({0, crc.mask} - {crc.init}):
        yield replace(same, kind="start_value", text=f"the CRC starts with {start:#x}", crc=replace(crc, init=start))
    without = int.from_bytes(data[1:-1], "big")
    yield replace(same, kind="first_byte_left_out", text="the CRC is over the bytes after the first", data=without, bits=bits - 8)
    for polynomial in POLYNOMIALS:
        if polynomial.bit_length() == 9:
            for reflected in (False, True):
                order = "least" if reflected else "most"
                other = replace(crc, poly=polynomial & 0xFF, refin=reflected, refout=reflected)
                yield replace(same, kind="other_polynomial", text=f"the polynomial is {polynomial:#x}, {order} significant bit first", crc=other)


def _moved(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """The bytes do not begin and end where the frame does, or are inverted."""
    size = placed.bits // 8
    more = len(data) - size
    if 0 < more <= _MOST_MORE:
        plural = f"{more} bytes" if more > 1 else "a byte"
        yield _read_as("bytes_in_front", f"{plural} in front of the frame, such as the request heard back", placed, crc, data[more:])
        yield _read_as("bytes_behind", f"{plural} behind the frame", placed, crc, data[:size])
    if more in (-1, 0):
        for first in _first_bytes(placed):
            behind = "" if more else ", and a byte follows the frame"
            yield _read_as("first_byte_lost", f"the first byte, {first:02X}, is missing{behind}", placed, crc, bytes([first, *data[: size - 1]]))
    if more == 0:
        yield _read_as("all_inverted", "every bit is inverted", placed, crc, bytes(byte ^ 0xFF for byte in data))


def _read_as(kind: str, words: str, placed: PlacedLayout, crc: Crc, data: bytes) -> Try:
    number = number_from_bytes(placed.layout, data)
    fixed, holds = fixed_bits(placed, number)
    return Try(
        kind, words, crc, int.from_bytes(data[:-1], "big"), 8 * len(data) - 8, data[-1], crc.width, True,
        demanded=fixed, holds=holds, usual=usual(placed, number), number=number, placed=placed,
    )


def _first_bytes(placed: PlacedLayout) -> Iterator[int]:
    """What a frame of this layout can begin with, where its first byte holds nothing but what tells the layout."""
    first = number_from_bytes(placed.layout, bytes([0xFF, *bytes(placed.bits // 8 - 1)]))
    inside = [item for item in placed.fields if first >> item.low & item.mask]
    if any(item.field.kind not in ("constant", "parity") and item.name != placed.layout.selector for item in inside):
        return
    for selected in placed.layout.selects:
        number = 0
        for item in inside:
            number |= (selected if item.name == placed.layout.selector else item.field.constant) << item.low
        for item in inside:
            of = placed.field(item.field.parity_of) if item.field.kind == "parity" else None
            if of is not None:
                number |= ((number >> of.low & of.mask).bit_count() & 1) << item.low
        yield number_to_bytes(placed.layout, number, placed.bits)[0]
