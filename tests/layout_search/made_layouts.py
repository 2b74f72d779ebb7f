"""Twenty layouts, and an encoder of frames that shares nothing with codewheel."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Made:
    """A layout: its line, the width of its position, and the function that returns the bits of a frame."""

    line: str
    width: int
    encode: Callable[[int, random.Random], str]


def shift_register(bits: str, width: int, polynomial: int, start: int, inverted: bool) -> str:
    """Return the CRC of bits: a shift register that is fed one bit after the other, highest bit first."""
    register = [int(bit) for bit in f"{start:0{width}b}"]
    taps = [int(bit) for bit in f"{polynomial & ((1 << width) - 1):0{width}b}"]
    for bit in bits:
        feedback = register[0] ^ int(bit)
        register = [old ^ (feedback & tap) for old, tap in zip([*register[1:], 0], taps, strict=True)]
    return "".join(str(bit ^ inverted) for bit in register)


def gray_code(bits: str) -> str:
    """Return the Gray code of a binary number: each bit is compared with the one in front of it."""
    return bits[0] + "".join(str(int(one != other)) for one, other in itertools.pairwise(bits))


def made(line: str, width: int, fields: Sequence[str], crc: tuple[int, int, int, bool] | None = None) -> Made:
    """Return a layout of fields: ``p`` the position, ``g`` in Gray code, ``o``/``e`` parity, else constant bits."""

    def encode(position: int, random_numbers: random.Random) -> str:
        number = f"{position % (1 << width):0{width}b}"
        pieces = {"p": number, "g": gray_code(number)}
        pieces["r"] = f"{random_numbers.getrandbits(8):08b}"
        texts = [pieces.get(field, field) for field in fields]
        ones = "".join(text for text in texts if text not in ("o", "e")).count("1")
        parities = {"e": str(ones % 2), "o": str(1 - ones % 2)}
        body = "".join(parities.get(text, text) for text in texts)
        return body + (shift_register(body, *crc) if crc is not None else "")

    return Made(line, width, encode)


LAYOUTS = (
    made("biss:position=22,error,warning,crc=6:0x43", 22, ["p", "11"], (6, 0x43, 0, True)),
    made("biss:position=32,error,warning,crc=6:0x43", 32, ["p", "11"], (6, 0x43, 0, True)),
    made("biss:zero=2,position=24,error,crc=6:0x43", 24, ["00", "p", "1"], (6, 0x43, 0, True)),
    made("biss:position=18,error,warning,crc=6:0x43:plain", 18, ["p", "11"], (6, 0x43, 0, False)),
    made("biss:position=36,error,warning,crc=16:0x190d9", 36, ["p", "11"], (16, 0x190D9, 0, True)),
    made("biss:position=26,error,warning,crc=5:0x25", 26, ["p", "11"], (5, 0x25, 0, True)),
    made("biss:position=19,zero=3,error,warning,crc=7:0x89", 19, ["p", "000", "11"], (7, 0x89, 0, True)),
    made("biss,gray:position=17,error,warning,crc=6:0x43", 17, ["g", "11"], (6, 0x43, 0, True)),
    made("biss,gray:position=25,error,warning,crc=8:0x12f", 25, ["g", "11"], (8, 0x12F, 0, True)),
    made("biss:position=20,error,warning,crc=4:0x13", 20, ["p", "11"], (4, 0x13, 0, True)),
    made("biss:position=16,warning,error,crc=16:0x11021:0x1:plain", 16, ["p", "11"], (16, 0x11021, 1, False)),
    made("ssi:position=25", 25, ["p"]),
    made("ssi,gray:position=25", 25, ["g"]),
    made("ssi,gray:position=13,zero=1", 13, ["g", "0"]),
    made("ssi:position=24,parity=even", 24, ["p", "e"]),
    made("ssi:position=21,error=high,crc=8:0x107", 21, ["p", "0"], (8, 0x107, 0, False)),
    made("spi:position=14,status=4,crc=6:0x43", 14, ["p", "0000"], (6, 0x43, 0, False)),
    made("spi:parity=even,error=high,position=14", 14, ["e", "0", "p"]),
    made("spi:position=18,unused=6,crc=8:0x197:inverted", 18, ["p", "101101"], (8, 0x197, 0, True)),
    made(
        "spi:head=4:0xa,position=21,zero=3,crc=8:0x11d:0xff:inverted", 21, ["1010", "p", "000"], (8, 0x11D, 0xFF, True)
    ),
)


def turning(count: int, width: int, random_numbers: random.Random) -> list[int]:
    """Return positions of a shaft that is turned by hand through most of the range: its speed varies."""
    speed = (1 << width) / count * random_numbers.uniform(0.4, 0.9) * random_numbers.choice([1, -1])
    position = float(random_numbers.getrandbits(width))
    positions = []
    for _ in range(count):
        positions.append(round(position) % (1 << width))
        position += speed * random_numbers.uniform(0.6, 1.4)
    return positions
