"""CRCs of encoders and masters that are publicly known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class KnownCrc(NamedTuple):
    """A CRC by its polynomial, including the top bit, and an example of its use.

    ``in_masters`` is true if BiSS masters offer the polynomial.
    """

    polynomial: int
    use: str
    init: int = 0
    in_masters: bool = False

    @property
    def width(self) -> int:
        return self.polynomial.bit_length() - 1


#: The polynomials of masters come from the Microchip dsPIC33A by length, and 0x97, which Beckhoff names next to 0x43.
#: The others come from the encoders in ``specs/``, and from the AS5047U, whose users publish frames.
KNOWN_CRCS: Sequence[KnownCrc] = (
    KnownCrc(0x190D9, "BiSS, 16 bits", in_masters=True),
    KnownCrc(0x12F, "BiSS, 8 bits", in_masters=True),
    KnownCrc(0x89, "BiSS, 7 bits", in_masters=True),
    KnownCrc(0x97, "BiSS, 7 bits, other polynomial", in_masters=True),
    KnownCrc(0x43, "BiSS, 6 bits", in_masters=True),
    KnownCrc(0x25, "BiSS, 5 bits", in_masters=True),
    KnownCrc(0x13, "BiSS, 4 bits", in_masters=True),
    KnownCrc(0xB, "BiSS, 3 bits", in_masters=True),
    KnownCrc(0x11021, "iC-MU, 16 bits", init=1),
    KnownCrc(0x197, "encoders of RLS over SPI, 8 bits"),
    KnownCrc(0x107, "CRC-8 of ITU-T I.432.1 without its final XOR, 8 bits"),
    KnownCrc(0x11D, "SAE J1850, 8 bits", init=0xFF),
    KnownCrc(0x11D, "AS5047U of ams, 8 bits", init=0xC4),
    KnownCrc(0x12F, "0x2F of AUTOSAR, 8 bits", init=0xFF),
    KnownCrc(0x101, "XOR of all bytes, 8 bits"),
)
