"""Common mistakes with a frame that is one number: BiSS, or any other bits with a CRC at the end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..model import Answer, Crc, Device, Flag, Kind, Number, PlacedLayout, Unused, Variant, choices
from ..model.record import dataclass
from ..reference.bits import binary_to_gray, gray_to_binary, reflect
from .tries import NOT_INVERTED, BitText, Try, covered_number, fixed_bits, likelihood, other_codes, read_as

#: Polynomials, including their top bit, that BiSS masters offer: those of the Microchip dsPIC33A by length, and 0x97,
#: which Beckhoff names next to 0x43.
POLYNOMIALS = (0x190D9, 0x12F, 0x89, 0x97, 0x43, 0x25, 0x13, 0xB)
#: A kind of mistake, its text, and the CRC of a frame with that mistake.
OtherCrc = tuple[str, str, Crc]


@dataclass(frozen=True, slots=True)
class FrameOffset:
    """Bits that do not begin and end with the frame.

    ``front`` are extra bits before the frame (``?`` is any bit), ``missing`` are missing first bits of the frame,
    ``lost`` is the number of missing last bits, and ``behind`` is the number of extra bits after it.
    """

    kind: str
    text: str
    front: str = ""
    missing: str = ""
    lost: int = 0
    behind: int = 0

    @property
    def longer(self) -> int:
        return len(self.front) - len(self.missing) - self.lost + self.behind


SLIPS = (
    FrameOffset(
        "first_bit_missing",
        "started one clock late: the first bit (0) is missing, and an extra bit follows",
        missing="0",
        behind=1,
    ),
    FrameOffset(
        "first_bit_missing",
        "started one clock late: the first bit (1) is missing, and an extra bit follows",
        missing="1",
        behind=1,
    ),
    FrameOffset(
        "bits_in_front",
        "started one clock early: an extra bit such as CDS is in front, and the last bit is missing",
        front="?",
        lost=1,
    ),
    FrameOffset(
        "bits_in_front",
        "started two clocks early: start bit and CDS are in front, and the last two bits are missing",
        front="1?",
        lost=2,
    ),
    FrameOffset("bits_in_front", "an extra bit in front, such as CDS", front="?"),
    FrameOffset("bits_behind", "an extra bit at the end, such as the stop bit", behind=1),
    FrameOffset("bits_in_front", "two extra bits in front: start bit and CDS", front="1?"),
    FrameOffset(
        "bits_in_front",
        "an extra bit in front, such as CDS, and one at the end, such as the stop bit",
        front="?",
        behind=1,
    ),
    FrameOffset("bits_behind", "two extra bits at the end", behind=2),
    FrameOffset("first_bit_missing", "the first bit (0) is missing", missing="0"),
    FrameOffset("first_bit_missing", "the first bit (1) is missing", missing="1"),
    FrameOffset("last_bits_missing", "the last bit is missing", lost=1),
    FrameOffset("last_bits_missing", "the last two bits are missing", lost=2),
)


def tries(device: Device, variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield every single mistake that could have turned a valid frame into ``text``.

    If the CRC covers only a part of the frame, only other parameters of the CRC and inverted frames are tried.
    ``placed`` is the layout of the expected frame. A number without leading zeros may have any length from its first 1
    on. If it can have the right length, other lengths are tried only if they lead to another frame.
    """
    expected = placed.bits
    lengths = {text.bits} if text.exact or text.bits > expected else {expected, expected - 1}
    lengths = {length for length in lengths if length >= text.bits}
    if expected in lengths:
        yield from _computed_otherwise(placed, crc, text.number)
        yield from _whole_frame_tries(placed, crc, text.number)
    if placed.covers_part:
        return
    for length in sorted(lengths, reverse=True):
        slips = [slip for slip in SLIPS if slip.longer == length - expected]
        yield from (_offset_try(placed, crc, slip, text.number, length) for slip in slips)
    yield from _without_status(placed, crc, text)
    yield from other_answers(device, variant, placed, crc, text)
    yield from _other_polynomials(placed, crc, text)
    yield from _bytes_reversed(placed, crc, text)
    yield from other_codes(device, variant, placed, crc, text)


def as_sent(placed: PlacedLayout, crc: Crc, number: int) -> Try:
    """Return a try of the frame as sent, to which the caller adds the mistake."""
    fixed, are_right = fixed_bits(placed, number)
    try_as_sent = Try("", "", crc, *covered_number(placed, number), number & crc.mask, crc.width)
    return replace(try_as_sent, fixed=fixed if are_right else 0, likelihood=likelihood(placed, number))


def _offset_try(placed: PlacedLayout, crc: Crc, slip: FrameOffset, number: int, length: int) -> Try:
    body_bits = length - len(slip.front) - slip.behind
    body = number >> slip.behind
    starts = [bit for bit in range(len(slip.front)) if slip.front[bit] == "1"]
    holds = all(body >> (body_bits + len(slip.front) - 1 - bit) & 1 for bit in starts)
    frame = (int(slip.missing or "0", 2) << body_bits | body & ((1 << body_bits) - 1)) << slip.lost
    return read_as(slip.kind, slip.text, placed, crc, frame, slip.lost, len(starts), holds)


def _computed_otherwise(placed: PlacedLayout, crc: Crc, number: int) -> Iterator[Try]:
    """Yield tries of the frame as sent with another CRC."""
    try_as_sent = as_sent(placed, crc, number)
    for kind, description, other_crc in other_crcs(crc):
        yield replace(try_as_sent, kind=kind, text=description, crc=other_crc)
    if placed.covers_part:
        return
    yield from _status_otherwise(try_as_sent, placed, number)
    yield from _position_otherwise(try_as_sent, placed, number)
    yield from _start_bits_in_crc(try_as_sent)
    description = "the bits of the CRC are in reverse order"
    yield replace(try_as_sent, kind="crc_reversed", text=description, received=reflect(try_as_sent.received, crc.width))


def _status_otherwise(try_as_sent: Try, placed: PlacedLayout, number: int) -> Iterator[Try]:
    """Yield tries in which the CRC does not cover error and warning, or they were inverted."""
    status, width = _status_mask(placed), try_as_sent.crc.width
    if not status:
        return
    data, bits = _without_bits(try_as_sent.data, try_as_sent.bits, status >> width)
    description = "the CRC covers only the bits before error and warning"
    yield replace(try_as_sent, kind="status_left_out", text=description, data=data, bits=bits)
    description = "error and warning were converted to active high"
    inverted = number ^ status
    yield replace(
        try_as_sent,
        kind="status_turned",
        text=description,
        data=inverted >> width,
        likelihood=likelihood(placed, inverted),
    )


def _position_otherwise(try_as_sent: Try, placed: PlacedLayout, number: int) -> Iterator[Try]:
    """Yield tries in which the position is in Gray code but the CRC covers binary, or vice versa."""
    low, width = _position(placed)
    if not width:
        return
    position = number >> low & ((1 << width) - 1)
    other_bits = number ^ position << low
    for converted, description in (
        (gray_to_binary(position), "the CRC covers the position in binary, but here it is in Gray code"),
        (binary_to_gray(position), "the CRC covers the position in Gray code, but here it is already binary"),
    ):
        yield replace(
            try_as_sent,
            kind="other_code",
            text=description,
            data=(other_bits | converted << low) >> try_as_sent.crc.width,
        )


def _start_bits_in_crc(try_as_sent: Try) -> Iterator[Try]:
    for front, description in (
        (0b1, "the start bit, or a CDS bit of 1"),
        (0b10, "the start bit and a CDS bit of 0"),
        (0b11, "the start bit and a CDS bit of 1"),
    ):
        data, bits = front << try_as_sent.bits | try_as_sent.data, try_as_sent.bits + front.bit_length()
        yield replace(
            try_as_sent, kind="start_bits_in_crc", text=f"the CRC also covers {description}", data=data, bits=bits
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


def _whole_frame_tries(placed: PlacedLayout, crc: Crc, number: int) -> Iterator[Try]:
    description = "every bit is inverted, as with swapped data wires"
    yield read_as("all_inverted", description, placed, crc, number ^ (1 << placed.bits) - 1)
    yield read_as("bits_reversed", "the bits are in reverse order", placed, crc, reflect(number, placed.bits))


def _bytes_reversed(placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    size = (placed.bits + 7) // 8
    if text.number >> 8 * size or (text.exact and (text.bits not in (placed.bits, 8 * size) or text.bits % 8)):
        return
    swapped = int.from_bytes(text.number.to_bytes(size, "little"), "big")
    number, unused = swapped & ((1 << placed.bits) - 1), 8 * size - placed.bits
    description = "the bytes are in reverse order"
    yield read_as("bytes_reversed", description, placed, crc, number, demanded=unused, holds=number == swapped)


def _without_status(placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield tries in which error and warning are missing: removed after the CRC was computed, or before."""
    status = _status_mask(placed)
    short = placed.bits - status.bit_count()
    if (
        not status
        or status >> crc.width != (1 << status.bit_count()) - 1
        or not (text.bits == short if text.exact else text.bits <= short)
    ):
        return
    data, received = text.number >> crc.width, text.number & crc.mask
    status_fields = [placed_field for placed_field in placed.fields if status >> placed_field.low & 1]
    idle_fields = [placed_field for placed_field in status_fields if _is_set_when_idle(placed_field.field.kind)]
    idle = sum(placed_field.mask << placed_field.low for placed_field in idle_fields)
    frame = data << (crc.width + status.bit_count()) | idle | received
    bits = short - crc.width
    description = "error and warning were removed from the frame"
    yield read_as(
        "status_not_sent", f"{description}, and the CRC is computed as if they were inactive", placed, crc, frame
    )
    if text.exact:  # Otherwise this is the same as a CRC over the bits before them.
        description += ", and the CRC covers the rest"
        yield Try(
            "status_not_sent",
            description,
            crc,
            data,
            bits,
            received,
            crc.width,
            likelihood=likelihood(placed, frame),
            number=frame,
            placed=placed,
        )


def _is_set_when_idle(kind: Kind) -> bool:
    return kind.active_low if isinstance(kind, Flag) else isinstance(kind, Unused)


def other_answers(device: Device, variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield the frame with each other answer to the open questions of the manual, complete or read one bit too long."""
    for answers, sets in choices(device.alternatives_of(placed.layout)):
        other_placed = placed.layout.place({**variant.parameters, **sets})
        if other_placed == placed:
            continue
        description = f"{other_placed.bits} bits, as with {' '.join(_options(device, answers))}"
        for extra_bits in (0, 1):
            if (
                text.bits == other_placed.bits + extra_bits
                if text.exact
                else text.bits <= other_placed.bits + extra_bits
            ):
                longer_text = ", read one bit too long" if extra_bits else ""
                yield read_as("other_answer", description + longer_text, other_placed, crc, text.number >> extra_bits)


def _options(device: Device, answers: Sequence[Answer]) -> Iterator[str]:
    """Yield the options of ``decode`` for the answers."""
    for alternative in device.alternatives:
        yield from (f"--choose {alternative.name}={answer.name}" for answer in answers if answer in alternative.answers)


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
    data_bits, width = placed.bits - crc.width, other_crc.width
    crc_part, data = number & ((1 << (length - data_bits)) - 1), number >> (length - data_bits)
    known_bits = min(width, length - data_bits)
    zeros = max(length - data_bits - width, 0)
    fixed, are_right = fixed_bits(placed, data << crc.width)
    has_own_length = length == placed.bits
    cut = ", followed by zeros" if zeros else ""
    if known_bits < width:
        cut = f", of which only {known_bits} bits arrived"
    return Try(
        "other_polynomial",
        f"the polynomial is {other_crc.poly_with_top_bit:#x}, a {width}-bit CRC{cut}",
        other_crc,
        data,
        data_bits,
        crc_part >> zeros,
        known_bits,
        demanded=zeros + (0 if has_own_length else fixed),
        holds=(has_own_length or are_right) and not crc_part & ((1 << zeros) - 1),
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
    """Return low bit and width of the number that a master would convert from Gray code to binary."""
    chosen_name = placed.layout.gray_of or next((join.name for join in placed.layout.joins), "")
    numbers = [placed_field for placed_field in placed.fields if isinstance(placed_field.field.kind, Number)]
    return placed.place_of(
        chosen_name or (max(numbers, key=lambda placed_field: placed_field.width).name if numbers else "")
    )
