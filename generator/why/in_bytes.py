"""Common mistakes with a frame of bytes on RS-485: other CRCs, and bytes around the frame or missing from it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Constant, Crc, Device, Parity, PlacedLayout, Variant, number_from_bytes, number_to_bytes
from ..reference.bits import parity_bit
from .in_bits import POLYNOMIALS, OtherCrc, as_sent
from .texts import TEXTS
from .tries import NOT_INVERTED, Try, read_as

#: More extra bytes than this do not come from an echoed request.
_MOST_ECHOED_BYTES = 4


def tries_with_bytes(
    device: Device, variant: Variant, sender: str, expected: PlacedLayout | None, data: bytes
) -> Iterator[Try]:
    """Yield every single mistake that could have turned a valid frame of the sender into ``data``.

    ``expected`` is the layout of ``data``, or None if that is not known.
    """
    for layout in device.interface(variant.interface).layouts:
        if layout.sender != sender or not layout.in_bytes:
            continue
        placed = layout.place(variant.parameters)
        crc = device.crc_of(placed)
        if crc is not None and crc.width != 8:
            continue
        is_expected = expected is not None and expected.name == placed.name and 8 * len(data) == placed.bits
        if crc is not None and is_expected:
            yield from _other_crc_tries(placed, crc, data)
        yield from _moved_byte_tries(placed, crc, data)


def is_valid_in_bytes(device: Device, placed: PlacedLayout, data: bytes) -> bool:
    """Return whether the CRC and the constants of the frame are correct."""
    crc = device.crc_of(placed)
    return crc is not None and crc.width == 8 and _read_as("", "", placed, crc, data).fits


def _other_crc_tries(placed: PlacedLayout, crc: Crc, data: bytes) -> Iterator[Try]:
    """Yield tries of the frame as sent with another CRC. The last byte of ``data`` is the received CRC."""
    try_as_sent = _over_bytes(as_sent(placed, crc, number_from_bytes(placed.layout, data)), data)
    for kind, description, other_crc in other_crcs(crc):
        yield replace(try_as_sent, kind=kind, text=description, crc=other_crc)
    bytes_without_first_and_crc = data[1:-1]
    yield replace(
        try_as_sent,
        kind="first_byte_left_out",
        text=TEXTS["first_byte_left_out"],
        data=int.from_bytes(bytes_without_first_and_crc, "big"),
        bits=try_as_sent.bits - 8,
    )


def other_crcs(crc: Crc) -> Iterator[OtherCrc]:
    """Yield the CRC with its inversion changed, with another start value, or with another polynomial of its length."""
    change = "the CRC is not inverted" if crc.xorout else "the CRC is inverted"
    if crc.is_xor:
        # With x^8 + 1 a start value only adds itself to the result.
        change += f", or its start value is {crc.mask ^ crc.init:#x} (the same here)"
    yield NOT_INVERTED, change, replace(crc, xorout=crc.xorout ^ crc.mask)
    if not crc.is_xor:
        for start in sorted({0, crc.mask} - {crc.init}):
            yield "start_value", f"the start value of the CRC is {start:#x}", replace(crc, init=start)
    for polynomial in POLYNOMIALS:
        if polynomial.bit_length() == 9:
            low_bits = polynomial & 0xFF
            text = f"the polynomial is {polynomial:#x}"
            most_first = replace(crc, poly=low_bits, refin=False, refout=False)
            least_first = replace(crc, poly=low_bits, refin=True, refout=True)
            yield "other_polynomial", f"{text}, most significant bit first", most_first
            yield "other_polynomial", f"{text}, least significant bit first", least_first


def _moved_byte_tries(placed: PlacedLayout, crc: Crc | None, data: bytes) -> Iterator[Try]:
    """Yield tries in which the bytes do not begin and end with the frame, or are inverted."""

    def try_of(kind: str, description: str, frame: bytes) -> Try:
        return _read_as(kind, description, placed, crc, frame)

    frame_length = placed.bits // 8
    extra_bytes = len(data) - frame_length
    if 0 < extra_bytes <= _MOST_ECHOED_BYTES:
        counted_bytes = TEXTS["extra_bytes" if extra_bytes > 1 else "extra_byte"].format(extra_bytes)
        yield try_of("bytes_in_front", TEXTS["before"].format(counted_bytes), data[extra_bytes:])
        yield try_of("bytes_behind", TEXTS["after"].format(counted_bytes), data[:frame_length])
    is_right_length = extra_bytes == 0
    is_one_byte_short = extra_bytes == -1
    if is_right_length or is_one_byte_short:
        # With the right length, a byte that follows the frame replaces the one that is missing.
        for first_byte in _first_bytes(placed):
            description = TEXTS["byte_missing"].format(f"{first_byte:02X}")
            if is_right_length:
                description = TEXTS["and_follows"].format(description)
            frame = bytes([first_byte]) + data[: frame_length - 1]
            template = TEXTS["and_follows" if is_right_length else "byte_missing"].format(TEXTS["byte_missing"])
            yield replace(try_of("first_byte_lost", description, frame), template=template)
    if is_right_length:
        inverted_frame = bytes(byte ^ 0xFF for byte in data)
        yield try_of("all_inverted", TEXTS["bytes_inverted"], inverted_frame)


def _read_as(kind: str, description: str, placed: PlacedLayout, crc: Crc | None, data: bytes) -> Try:
    attempt = read_as(kind, description, placed, crc, number_from_bytes(placed.layout, data))
    return attempt if crc is None else _over_bytes(attempt, data)


def _over_bytes(try_as_sent: Try, data: bytes) -> Try:
    """Return the try with the CRC over the bytes as sent, independent of the byte order of the number."""
    return replace(try_as_sent, data=int.from_bytes(data[:-1], "big"), received=data[-1], by_bytes=True)


def _first_bytes(placed: PlacedLayout) -> Iterator[int]:
    """Yield the possible first bytes of a frame, if that byte only identifies the layout."""
    first_byte_mask = number_from_bytes(placed.layout, bytes([0xFF, *bytes(placed.bits // 8 - 1)]))
    first_fields = [field for field in placed.fields if first_byte_mask >> field.low & field.mask]
    selector = placed.layout.selector
    other_fields = [field for field in first_fields if field.name != selector]
    if not all(isinstance(field.field.kind, (Constant, Parity)) for field in other_fields):
        return
    for selected in placed.layout.selects:
        number = 0
        for field in first_fields:
            if field.name == selector:
                number |= selected << field.low
            elif isinstance(field.field.kind, Constant):
                number |= field.field.kind.value << field.low
        # The parity covers the other bits, so it is set last.
        for field in first_fields:
            if isinstance(field.field.kind, Parity):
                number |= parity_bit(placed, field.field.kind, number) << field.low
        yield number_to_bytes(placed.layout, number, placed.bits)[0]
