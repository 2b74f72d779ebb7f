"""Common mistakes with a frame that is one number: BiSS, or any other bits with a CRC at the end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import prod

from ..model import Answer, Crc, Device, Flag, Kind, Number, PlacedLayout, Unused, Variant, choices
from ..model.known_crcs import KNOWN_CRCS
from ..reference.bits import binary_to_gray, gray_to_binary, reflect
from .recordings import LINES, FrameOffset, line_name, recorded_bits, recording_tries, window_tries
from .texts import START_BITS, TEXTS
from .tries import (
    ACTIVE,
    IDLE,
    NOT_INVERTED,
    BitText,
    Try,
    covered_number,
    fixed_bits,
    likelihood,
    other_codes,
    read_as,
)

#: Polynomials, including their top bit, that BiSS masters offer.
POLYNOMIALS = tuple(known.polynomial for known in KNOWN_CRCS if known.in_masters)
#: A kind of mistake, its text, and the CRC of a frame with that mistake.
OtherCrc = tuple[str, str, Crc]


def tries(device: Device, variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield every single mistake that could have turned a valid frame into ``text``.

    If the CRC covers only a part of the frame, only other parameters of the CRC, and inverted and moved frames, are
    tried. ``placed`` is the layout of the expected frame. A number without leading zeros may have any length from its
    first 1 on. If it can have the right length, other lengths are tried only if they lead to another frame.
    """
    if placed.bits in _lengths(placed, text):
        yield from _other_crc_tries(placed, crc, text.number)
    yield from rearranged_frames(placed, crc, text)
    yield from moved_frames(device, variant, placed, crc, text)
    if placed.covers_part:
        return
    yield from _without_status(placed, crc, text)
    yield from other_answers(device, variant, placed, text)
    yield from _other_polynomials(placed, crc, text)
    yield from other_codes(device, variant, placed, text)


def _lengths(placed: PlacedLayout, text: BitText) -> list[int]:
    """Return the lengths that the text may have, longest first."""
    is_known = text.exact or text.bits > placed.bits
    lengths = [text.bits] if is_known else [placed.bits, placed.bits - 1]
    return [length for length in lengths if length >= text.bits]


def moved_frames(
    device: Device, variant: Variant, placed: PlacedLayout, crc: Crc | None, text: BitText
) -> Iterator[Try]:
    """Yield tries with bits around the frame, or without its first or last bits.

    The frame is searched at every bit only if no rule of the line finds it.
    """
    line = LINES.get(line_name(device.interface(variant.interface)))
    if line is None:
        return
    received = recorded_bits(text, placed.bits)
    tries_by_rule: list[Try] = []
    for length in _lengths(placed, text):
        for offset in line.slips:
            if placed.bits + offset.longer == length:
                tries_by_rule.append(_offset_try(placed, crc, offset, text.number, length))
    tries_by_rule += recording_tries(line, placed, crc, received)
    yield from tries_by_rule
    if crc is not None and not any(attempt.fits for attempt in tries_by_rule):
        yield from window_tries(placed, crc, received)


def as_sent(placed: PlacedLayout, crc: Crc, number: int) -> Try:
    """Return a try of the frame as sent, to which the caller adds the mistake."""
    fixed, are_right = fixed_bits(placed, number)
    covered_data, covered_bits = covered_number(placed, number)
    return Try(
        kind="",
        text="",
        crc=crc,
        data=covered_data,
        bits=covered_bits,
        received=number & crc.mask,
        known_bits=crc.width,
        fixed=fixed if are_right else 0,
        likelihood=likelihood(placed, number),
    )


def _offset_try(placed: PlacedLayout, crc: Crc | None, offset: FrameOffset, number: int, length: int) -> Try:
    """Return a try in which the ``length`` bits of ``number`` do not begin and end with the frame.

    The bits are, from the first one received: bits before the frame, the received part of the frame, bits after it.
    """
    front_length = len(offset.front)
    received_length = length - front_length - offset.behind
    front_and_received = number >> offset.behind
    received_part = front_and_received & ((1 << received_length) - 1)
    front_bits = front_and_received >> received_length
    start_bits = _bits_at(offset.front, "1", front_bits)
    missing_first_bits = int(offset.missing or "0", 2)
    # The missing last bits are 0 here. ``read_as`` knows from ``lost`` that they were not received.
    frame = (missing_first_bits << received_length | received_part) << offset.lost
    attempt = read_as(
        offset.kind,
        offset.text.format(offset.missing),
        placed,
        crc,
        frame,
        lost=offset.lost,
        demanded=len(start_bits),
        holds=all(start_bits),
    )
    front_likelihood = prod(ACTIVE if bit else IDLE for bit in _bits_at(offset.front, "~", front_bits))
    return replace(attempt, template=offset.text, likelihood=attempt.likelihood * front_likelihood)


def _bits_at(pattern: str, mark: str, front: int) -> list[int]:
    """Return the bits before the frame that have a mark in the pattern, whose first bit is the first one received."""
    last_to_first = enumerate(reversed(pattern))
    return [front >> position & 1 for position, expected in last_to_first if expected == mark]


def _other_crc_tries(placed: PlacedLayout, crc: Crc, number: int) -> Iterator[Try]:
    """Yield tries of the frame as sent with another CRC."""
    try_as_sent = as_sent(placed, crc, number)
    for kind, description, other_crc in other_crcs(crc):
        yield replace(try_as_sent, kind=kind, text=description, crc=other_crc)
    reversed_crc = reflect(try_as_sent.received, crc.width)
    yield replace(try_as_sent, kind="crc_reversed", text=TEXTS["crc_reversed"], received=reversed_crc)
    if placed.covers_part:
        return
    yield from _status_otherwise(try_as_sent, placed, number)
    yield from _position_otherwise(try_as_sent, placed, number)
    yield from _start_bits_in_crc(try_as_sent)


def _status_otherwise(try_as_sent: Try, placed: PlacedLayout, number: int) -> Iterator[Try]:
    """Yield tries in which the CRC does not cover error and warning, or they were inverted."""
    status_mask, crc_bits = _status_mask(placed), try_as_sent.known_bits
    if not status_mask:
        return
    data, bits = _without_bits(try_as_sent.data, try_as_sent.bits, status_mask >> crc_bits)
    yield replace(try_as_sent, kind="status_left_out", text=TEXTS["status_left_out"], data=data, bits=bits)
    inverted = number ^ status_mask
    yield replace(
        try_as_sent,
        kind="status_turned",
        text=TEXTS["status_turned"],
        data=inverted >> crc_bits,
        likelihood=likelihood(placed, inverted),
    )


def _position_otherwise(try_as_sent: Try, placed: PlacedLayout, number: int) -> Iterator[Try]:
    """Yield tries in which the position is in Gray code but the CRC covers binary, or vice versa."""
    low, width = _position(placed)
    if not width:
        return
    position = number >> low & ((1 << width) - 1)
    without_position = number ^ position << low
    conversions = (
        (gray_to_binary(position), TEXTS["covers_binary"]),
        (binary_to_gray(position), TEXTS["covers_gray"]),
    )
    for converted_position, description in conversions:
        covered_frame = without_position | converted_position << low
        covered_data = covered_frame >> try_as_sent.known_bits
        yield replace(try_as_sent, kind="other_code", text=description, data=covered_data)


def _start_bits_in_crc(try_as_sent: Try) -> Iterator[Try]:
    """Yield tries in which the CRC also covers the bits that BiSS sends in front of the frame."""
    for front, description in START_BITS:
        yield replace(
            try_as_sent,
            kind="start_bits_in_crc",
            text=description,
            data=int(front, 2) << try_as_sent.bits | try_as_sent.data,
            bits=try_as_sent.bits + len(front),
        )


def other_crcs(crc: Crc) -> Iterator[OtherCrc]:
    """Yield the CRC with its inversion changed, with another start value, or with its polynomial reversed."""
    change = "is not inverted" if crc.xorout else "is inverted"
    yield NOT_INVERTED, f"the CRC {change}", replace(crc, xorout=crc.xorout ^ crc.mask)
    for start in sorted({0, crc.mask} - {crc.init}):
        yield "start_value", f"the start value of the CRC is {start:#x}", replace(crc, init=start)
    backwards = reflect(crc.poly_with_top_bit, crc.width + 1) & crc.mask
    description = f"the polynomial is {backwards | 1 << crc.width:#x}, written in reverse"
    yield "polynomial_reversed", description, replace(crc, poly=backwards)


def rearranged_frames(placed: PlacedLayout, crc: Crc | None, text: BitText) -> Iterator[Try]:
    """Yield tries in which all bits are inverted, or the bits or bytes are in another order."""
    if placed.bits in _lengths(placed, text):
        other_frames = {
            "all_inverted": text.number ^ (1 << placed.bits) - 1,
            "bits_reversed": reflect(text.number, placed.bits),
        }
        if placed.bits % 8 == 0:
            other_frames["bits_reversed_in_bytes"] = reflected_bytes(text.number, placed.bits // 8)
        for kind, frame in other_frames.items():
            yield read_as(kind, TEXTS[kind], placed, crc, frame)
    yield from _bytes_moved("bytes_reversed", placed, crc, text)
    # With two bytes, this is the same.
    if placed.bits > 16:
        yield from _bytes_moved("words_swapped", placed, crc, text)


def reflected_bytes(number: int, count: int) -> int:
    """Return ``count`` bytes with the bits of each in reverse order."""
    return int.from_bytes(bytes(reflect(byte, 8) for byte in number.to_bytes(count, "big")), "big")


def _bytes_moved(kind: str, placed: PlacedLayout, crc: Crc | None, text: BitText) -> Iterator[Try]:
    """Yield a try in which the bytes of the frame, filled up with zeros, are in reverse order, or in each word."""
    unit = 16 if kind == "words_swapped" else 8
    filled_bits = (placed.bits + unit - 1) // unit * unit
    if text.number >> filled_bits:
        return
    is_whole_bytes = text.bits % 8 == 0 and text.bits in (placed.bits, filled_bits)
    if text.exact and not is_whole_bytes:
        return
    if kind == "words_swapped":
        swapped = swapped_words(text.number, filled_bits // 8)
    else:
        swapped = int.from_bytes(text.number.to_bytes(filled_bits // 8, "little"), "big")
    frame = swapped & ((1 << placed.bits) - 1)
    demanded = filled_bits - placed.bits
    yield read_as(kind, TEXTS[kind], placed, crc, frame, demanded=demanded, holds=frame == swapped)


def swapped_words(number: int, count: int) -> int:
    """Return ``count`` bytes with the two bytes of each 16-bit word swapped."""
    data = number.to_bytes(count, "big")
    swapped = bytearray(count)
    swapped[0::2], swapped[1::2] = data[1::2], data[0::2]
    return int.from_bytes(swapped, "big")


def _without_status(placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield tries in which error and warning are missing: removed after the CRC was computed, or before."""
    status_mask = _status_mask(placed)
    status_bits = status_mask.bit_count()
    bits_without_status = placed.bits - status_bits
    # The flags must be the last bits before the CRC.
    is_before_crc = status_mask >> crc.width == (1 << status_bits) - 1
    if not status_mask or not is_before_crc or not text.may_have(bits_without_status):
        return
    data, received = text.number >> crc.width, text.number & crc.mask
    frame = data << (crc.width + status_bits) | _idle_status(placed, status_mask) | received
    yield read_as("status_not_sent", TEXTS["removed_and_idle"], placed, crc, frame)
    if text.exact:  # Otherwise this is the same as a CRC over the bits before them.
        yield Try(
            kind="status_not_sent",
            text=TEXTS["removed"],
            crc=crc,
            data=data,
            bits=bits_without_status - crc.width,
            received=received,
            known_bits=crc.width,
            likelihood=likelihood(placed, frame),
            number=frame,
            placed=placed,
        )


def _idle_status(placed: PlacedLayout, status_mask: int) -> int:
    """Return the bits of error and warning while neither is active."""
    idle_bits = 0
    for placed_field in placed.fields:
        is_status = status_mask >> placed_field.low & 1
        if is_status and _is_set_when_idle(placed_field.field.kind):
            idle_bits |= placed_field.mask << placed_field.low
    return idle_bits


def _is_set_when_idle(kind: Kind) -> bool:
    if isinstance(kind, Flag):
        return kind.active_low
    # An unused status bit is 1, like an inactive flag over BiSS.
    return isinstance(kind, Unused)


def other_answers(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Iterator[Try]:
    """Yield the frame with each other answer to the open questions of the manual, complete or read one bit too long."""
    for answers, sets in choices(device.alternatives_of(placed.layout)):
        other_placed = placed.layout.place({**variant.parameters, **sets})
        crc = device.crc_of(other_placed)
        if other_placed == placed or crc is None:
            continue
        description = f"{other_placed.bits} bits, as with {' '.join(_options(device, answers))}"
        if text.may_have(other_placed.bits):
            yield read_as("other_answer", description, other_placed, crc, text.number)
        if text.may_have(other_placed.bits + 1):
            description += ", read one bit too long"
            yield read_as("other_answer", description, other_placed, crc, text.number >> 1)


def _options(device: Device, answers: Sequence[Answer]) -> Iterator[str]:
    """Yield the options of ``decode`` for the answers."""
    for alternative in device.alternatives:
        for answer in answers:
            if answer in alternative.answers:
                yield f"--choose {alternative.name}={answer.name}"


def _other_polynomials(placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield tries with data of the right length before a CRC of another length.

    The CRC is complete, truncated by a reader that expects fewer bits, or followed by zeros. The stop bit is 0, and
    with one slave the bits after it are 0 too, since the master holds SLI at 0.
    """
    data_bits = placed.bits - crc.width
    for polynomial in POLYNOMIALS:
        if polynomial == crc.poly_with_top_bit:
            continue
        other_crc = _with_polynomial(crc, polynomial)
        for length in dict.fromkeys((data_bits + other_crc.width, placed.bits)):
            if length == text.bits or (not text.exact and length > text.bits):
                yield _of_length(placed, crc, other_crc, text.number, length)


def _with_polynomial(crc: Crc, polynomial: int) -> Crc:
    """Return the CRC with another polynomial, and with start value and inversion of that width."""
    width = polynomial.bit_length() - 1
    mask = (1 << width) - 1
    init = mask if crc.init else 0
    xorout = mask if crc.xorout else 0
    return replace(crc, width=width, poly=polynomial & mask, init=init, xorout=xorout)


def _of_length(placed: PlacedLayout, crc: Crc, other_crc: Crc, number: int, length: int) -> Try:
    """Return a try in which the ``length`` bits of ``number`` are the frame's data with the CRC ``other_crc``."""
    data_bits = placed.bits - crc.width
    bits_after_data = length - data_bits
    data, after_data = number >> bits_after_data, number & ((1 << bits_after_data) - 1)
    known_crc_bits = min(other_crc.width, bits_after_data)
    zeros = max(bits_after_data - other_crc.width, 0)
    are_zero = after_data & ((1 << zeros) - 1) == 0
    fixed, are_right = fixed_bits(placed, data << crc.width)
    description = TEXTS["polynomial"].format(f"{other_crc.poly_with_top_bit:#x}", other_crc.width)
    if known_crc_bits < other_crc.width:
        description = TEXTS["bits_arrived"].format(description, known_crc_bits)
    elif zeros:
        description = TEXTS["then_zeros"].format(description)
    # In a frame of the expected length, the mistake does not move the constants, so they prove nothing.
    has_frame_length = length == placed.bits
    return Try(
        kind="other_polynomial",
        text=description,
        crc=other_crc,
        data=data,
        bits=data_bits,
        received=after_data >> zeros,
        known_bits=known_crc_bits,
        demanded=zeros + (0 if has_frame_length else fixed),
        holds=are_zero and (has_frame_length or are_right),
        fixed=zeros + (fixed if are_right else 0),
        likelihood=likelihood(placed, data << crc.width),
    )


def _status_mask(placed: PlacedLayout) -> int:
    names = [status_field.name for status_field in placed.layout.status_fields]
    return sum(placed_field.mask << placed_field.low for placed_field in placed.fields if placed_field.name in names)


def _without_bits(data: int, bits: int, mask: int) -> tuple[int, int]:
    """Remove the bits of ``mask`` from ``data``, and return the remaining bits and their number."""
    remaining = [data >> bit & 1 for bit in range(bits - 1, -1, -1) if not mask >> bit & 1]
    return int("".join(map(str, remaining)) or "0", 2), len(remaining)


def _position(placed: PlacedLayout) -> tuple[int, int]:
    """Return low bit and width of the number that a master would convert from Gray code to binary.

    This is the number in Gray code, a joined number, or else the widest one.
    """
    joins = placed.layout.joins
    if placed.layout.gray_of:
        return placed.place_of(placed.layout.gray_of)
    if joins:
        return placed.place_of(joins[0].name)
    numbers = [placed_field for placed_field in placed.fields if isinstance(placed_field.field.kind, Number)]
    if not numbers:
        return placed.place_of("")
    return placed.place_of(max(numbers, key=lambda placed_field: placed_field.width).name)
