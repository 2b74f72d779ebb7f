"""Frames with one planted mistake each. The encoder's side is written bit by bit, independent of codewheel.

Frames are texts of ``0`` and ``1``, first bit sent first. Widths come from the manuals.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise


@dataclass(frozen=True)
class Encoder:
    """A BiSS frame: ``zeros`` above the position, ``position`` bits, ``below`` zeros, error and warning, CRC 6.

    ``other_codes`` are order codes of the family with other lengths of the frame.
    """

    code: str
    zeros: int
    position: int
    below: int = 0
    has_status: bool = True
    other_codes: tuple[tuple[str, int], ...] = ()

    @property
    def bits(self) -> int:
        return self.zeros + self.position + self.below + 2 + 6


AMM5 = (
    ("AMM5A17/1SC1", 17),
    ("AMM5A21/1SC1", 21),
    ("AMM5A23/1SC1", 23),
    ("AMM5A17/65KSC1", 33),
    ("AMM5A21/65KSC1", 37),
    ("AMM5A23/65KSC1", 39),
)
ASC85 = tuple((f"ASC85{bits}/SC1", bits) for bits in range(20, 26))


def _family(codes: tuple[tuple[str, int], ...], below: int) -> list[Encoder]:
    """Return an encoder for each order code with its bits, which knows the other codes."""
    encoders = []
    for code, bits in codes:
        other_codes = tuple(row for row in codes if row[0] != code)
        encoders.append(Encoder(code, zeros=0, position=bits, below=below, other_codes=other_codes))
    return encoders


ENCODERS = (
    *_family(AMM5, below=0),
    *_family(ASC85, below=1),
    Encoder("SMA21-SC4-0050", 4, 20, other_codes=(("SMA21-SC1-0001", 25),)),
    Encoder("SMA21-SC4-0005", 1, 23, other_codes=(("SMA21-SC1-0001", 25),)),
    # Of four shapes of 32 bits only the one without zeros above the position fits.
    Encoder("SMA21-SC4-0001", 0, 25, other_codes=(("SMA21-SC1-0002", 24),)),
    Encoder("AM3616/4096-I7", 0, 36, has_status=False),
)


@dataclass(frozen=True)
class Plant:
    """A frame with a mistake: the order code that the user gives, the typed text, and the expected explanation."""

    code: str
    text: str
    kind: str
    words: str = ""


def crc(data: str, polynomial: int = 0x43, start: str = "", invert: bool = True) -> str:
    """The CRC by long division, as on paper: ``polynomial`` has its top bit, ``start`` is added to the first bits."""
    width = polynomial.bit_length() - 1
    divisor = [int(bit) for bit in f"{polynomial:b}"]
    remainder = [int(bit) for bit in data] + [0] * width
    for place, first in enumerate(start):
        remainder[place] ^= int(first)
    for place in range(len(data)):
        if remainder[place]:
            for offset, bit in enumerate(divisor):
                remainder[place + offset] ^= bit
    return "".join(str(bit ^ invert) for bit in remainder[len(data) :])


def random_bits(source: random.Random, bits: int) -> str:
    return "".join(source.choice("01") for _ in range(bits))


def inverted(text: str) -> str:
    return text.translate(str.maketrans("01", "10"))


def gray(position: str) -> str:
    """Each bit is the change from the one before."""
    return "".join(str(int(bit != next_bit)) for bit, next_bit in pairwise("0" + position))


def binary(position: str) -> str:
    """Each bit is the sum of all before it."""
    return "".join(str(position[: place + 1].count("1") % 2) for place in range(len(position)))


def status(encoder: Encoder, source: random.Random) -> str:
    """Return error and warning, active low. Nine of ten frames have no active status bit."""
    return random_bits(source, 2) if encoder.has_status and source.random() < 0.1 else "11"


def position_and_status(encoder: Encoder, source: random.Random) -> tuple[str, str]:
    """Return the bits before the status bits, and the status bits."""
    return "0" * encoder.zeros + random_bits(source, encoder.position) + "0" * encoder.below, status(encoder, source)


def valid_frame(encoder: Encoder, source: random.Random) -> str:
    data = "".join(position_and_status(encoder, source))
    return data + crc(data)


Maker = Callable[[Encoder, random.Random], Iterator[Plant]]


def _plant(encoder: Encoder, bits: str, kind: str, words: str = "") -> Plant:
    return Plant(encoder.code, "0b" + bits, kind, words)


def not_inverted(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    frame = valid_frame(encoder, source)
    yield _plant(encoder, frame[:-6] + inverted(frame[-6:]), "crc_not_inverted")


def status_left_out(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    position, flags = position_and_status(encoder, source)
    yield _plant(encoder, position + flags + crc(position), "status_left_out")


def status_not_sent(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    position, _ = position_and_status(encoder, source)
    yield _plant(encoder, position + crc(position), "status_not_sent", "covers the rest")
    yield _plant(encoder, position + crc(position + "11"), "status_not_sent", "were inactive")


def other_answer(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The 0 bit below the position is not sent, as in a public driver: 33 bits instead of 34 for 25 bits.
    Or the reader sends one more clock."""
    if encoder.below:
        position, flags = position_and_status(encoder, source)
        data = position[: -encoder.below] + flags
        yield _plant(encoder, data + crc(data), "other_answer", "zero_bit=left_out")
        yield _plant(encoder, data + crc(data) + "0", "other_answer", "too long")


def status_turned(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    position, flags = position_and_status(encoder, source)
    yield _plant(encoder, position + inverted(flags) + crc(position + flags), "status_turned")


def read_late(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """One clock late: the first bit is missing, and an additional bit follows the last."""
    frame = valid_frame(encoder, source)
    if not encoder.zeros:
        yield _plant(encoder, frame[1:] + "0", "first_bit_missing", f"first bit ({frame[0]})")


def first_bit_missing(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    frame = valid_frame(encoder, source)
    if not encoder.zeros:
        yield _plant(encoder, frame[1:], "first_bit_missing", f"first bit ({frame[0]})")


def read_early(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """One clock early: the CDS bit comes first, and the last bit of the CRC is missing."""
    frame = valid_frame(encoder, source)
    yield _plant(encoder, random_bits(source, 1) + frame[:-1], "bits_in_front")


def bit_in_front(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    frame = valid_frame(encoder, source)
    yield _plant(encoder, random_bits(source, 1) + frame, "bits_in_front", "an extra bit")


def start_and_cds_in_front(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    frame = valid_frame(encoder, source)
    yield _plant(encoder, "1" + random_bits(source, 1) + frame, "bits_in_front", "start bit and CDS")


def bit_behind(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    frame = valid_frame(encoder, source)
    yield _plant(encoder, frame + random_bits(source, 1), "bits_behind", "an extra bit")


def last_bit_missing(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    yield _plant(encoder, valid_frame(encoder, source)[:-1], "last_bits_missing")


def start_in_crc(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    data = "".join(position_and_status(encoder, source))
    yield _plant(encoder, data + crc("1" + data), "start_bits_in_crc", "the start bit, or")
    yield _plant(encoder, data + crc("10" + data), "start_bits_in_crc", "CDS bit of 0")
    yield _plant(encoder, data + crc("11" + data), "start_bits_in_crc", "start bit and a CDS bit of 1")


def other_code(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The position is converted to the other code between sender and reader, but the CRC is not."""
    position, flags = random_bits(source, encoder.position), status(encoder, source)
    before, behind = "0" * encoder.zeros, "0" * encoder.below
    check = crc(before + position + behind + flags)
    yield _plant(
        encoder, before + gray(position) + behind + flags + check, "other_code", "in binary, but here it is in Gray"
    )
    yield _plant(
        encoder,
        before + binary(position) + behind + flags + check,
        "other_code",
        "in Gray code, but here it is already binary",
    )


def other_polynomial(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The CRC has the length of its polynomial."""
    data = "".join(position_and_status(encoder, source))
    for polynomial in (0x190D9, 0x12F, 0x89, 0x97, 0x25, 0x13, 0xB):
        yield _plant(encoder, data + crc(data, polynomial), "other_polynomial", f"{polynomial:#x},")


def other_polynomial_in_6_bits(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The same, but the reader still expects 6 bits of CRC: the start of a longer CRC, or a shorter CRC and zeros."""
    data = "".join(position_and_status(encoder, source))
    for polynomial in (0x190D9, 0x12F, 0x89, 0x97, 0x25, 0x13, 0xB):
        yield _plant(encoder, data + (crc(data, polynomial) + "000")[:6], "other_polynomial", f"{polynomial:#x},")


def other_order_code(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The frame of another order code, with its length."""
    for order_code, width in encoder.other_codes:
        frame = valid_frame(Encoder(order_code, 0, width, encoder.below), source)
        yield _plant(encoder, frame, "other_order_code", order_code)


def other_order_code_read_on(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The same with a shorter frame and more clocks: the stop bit and the bits after it are 0."""
    for order_code, width in encoder.other_codes:
        other_encoder = Encoder(order_code, 0, width, encoder.below)
        if other_encoder.bits < encoder.bits:
            yield _plant(
                encoder, valid_frame(other_encoder, source).ljust(encoder.bits, "0"), "other_order_code", order_code
            )


def all_inverted(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    yield _plant(encoder, inverted(valid_frame(encoder, source)), "all_inverted")


def bits_reversed(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    yield _plant(encoder, valid_frame(encoder, source)[::-1], "bits_reversed")


def crc_reversed(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    frame = valid_frame(encoder, source)
    yield _plant(encoder, frame[:-6] + frame[:-7:-1], "crc_reversed")


def bytes_reversed(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    """The frame at the low end of whole bytes, as an integer of the other byte order."""
    size = (encoder.bits + 7) // 8
    data = int(valid_frame(encoder, source), 2).to_bytes(size, "big")
    yield Plant(encoder.code, "0x" + data[::-1].hex(), "bytes_reversed")


def start_value(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    data = "".join(position_and_status(encoder, source))
    yield _plant(encoder, data + crc(data, start="111111"), "start_value")


def polynomial_reversed(encoder: Encoder, source: random.Random) -> Iterator[Plant]:
    data = "".join(position_and_status(encoder, source))
    yield _plant(encoder, data + crc(data, 0b1100001), "polynomial_reversed")


#: Named after the planted mistake. The three before the last are rare, but cheap to try.
MISTAKES: tuple[Maker, ...] = (
    not_inverted,
    status_left_out,
    status_not_sent,
    status_turned,
    read_late,
    first_bit_missing,
    read_early,
    bit_in_front,
    start_and_cds_in_front,
    bit_behind,
    last_bit_missing,
    start_in_crc,
    other_code,
    other_polynomial,
    other_polynomial_in_6_bits,
    other_order_code,
    other_order_code_read_on,
    all_inverted,
    bits_reversed,
    bytes_reversed,
    crc_reversed,
    start_value,
    polynomial_reversed,
    other_answer,
)


def as_hex(plant: Plant) -> Plant:
    """Return the same frame typed as a hex number, which does not show leading zeros."""
    return Plant(plant.code, hex(int(plant.text, 0)), plant.kind, plant.words)


def reply(source: random.Random, code: str) -> bytes:
    """A reply over RS-485 with a position of 20 bits in three bytes: data ID 0 of AMM5, data ID 4 of SMA21.
    CRC 8 is the XOR of the bytes."""
    position = source.getrandbits(20).to_bytes(3, "little")
    data = b"\x02\x00" + position if code.startswith("AMM5") else b"\xa2\x00" + position + b"\x00"
    return data + bytes([_xor(data)])


def _xor(data: bytes) -> int:
    total = 0
    for byte in data:
        total ^= byte
    return total


def byte_mistakes(code: str, source: random.Random) -> Iterator[Plant]:
    frame = reply(source, code)
    data, check = frame[:-1], frame[-1]
    random_byte = bytes([source.getrandbits(8)])
    yield Plant(code, (data + bytes([check ^ 0xFF])).hex(), "crc_not_inverted", "start value is 0xff")
    yield Plant(code, (data + bytes([check ^ data[0]])).hex(), "first_byte_left_out")
    yield Plant(code, (frame[:1] + frame).hex(), "bytes_in_front")
    yield Plant(code, (frame + random_byte).hex(), "bytes_behind")
    yield Plant(code, frame[1:].hex(), "first_byte_lost")
    yield Plant(code, (frame[1:] + random_byte).hex(), "first_byte_lost")
    yield Plant(code, bytes(byte ^ 0xFF for byte in frame).hex(), "all_inverted")
    yield Plant(code, bytes(int(f"{byte:08b}"[::-1], 2) for byte in frame).hex(), "bits_reversed_in_bytes")
    yield Plant(
        code,
        (data + bytes([int(crc("".join(f"{byte:08b}" for byte in data), 0x12F, invert=False), 2)])).hex(),
        "other_polynomial",
        "most",
    )
    turned = crc("".join(f"{byte:08b}"[::-1] for byte in data), 0x12F, invert=False)
    yield Plant(code, (data + bytes([int(turned[::-1], 2)])).hex(), "other_polynomial", "least")


BYTE_CODES = ("AMM5A23/65KJP1", "SMA21-JP1-0050")
