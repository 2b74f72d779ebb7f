"""Public test vectors from sources other than the encoders' manuals, for everyone with the same CRC, words or parity.

They are part of the self-test of the C headers. Tests compare them with ``tests/vectors.json``, which has the sources.
"""

from __future__ import annotations

from ..model import Crc
from ..model.record import dataclass

_BRIDGE = "timonburkard/BiSS_Bridge: 2_hdl/tb/tb_data_checker.vhd"
_EXTRACT = "mjbots/moteus: fw/test/bissc_extract_test.cc"
_TI = "TexasInstruments/motor-control-sdk: bissc_hex_control_commands.png"


@dataclass(frozen=True, slots=True)
class PublicVector:
    """A word and its CRC. The word begins with its first 1 bit."""

    title: str
    data: int
    crc: int
    source: str


def _single_cycle(title: str, position: int, flags: int, crc: int) -> PublicVector:
    """Return the vector for a position of 22 bits and two flags, error and warning."""
    return PublicVector(title, position << 2 | flags, crc, _BRIDGE)


_CRC_6 = (
    _single_cycle("22 bits, all zeros", 0, 3, 58),
    _single_cycle("22 bits, all ones", 4194303, 3, 47),
    _single_cycle("22 bits, pattern 1", 1193046, 3, 53),
    _single_cycle("22 bits, pattern 2", 2870767, 3, 16),
    _single_cycle("22 bits, pattern 3", 1393441, 3, 54),
    _single_cycle("22 bits, pattern 4", 4119738, 3, 24),
    _single_cycle("22 bits, captured", 192458, 3, 28),
    _single_cycle("22 bits, error active", 74565, 1, 11),
    _single_cycle("22 bits, warning active", 74565, 2, 14),
    PublicVector("16 bits", 0x1234, 7, _EXTRACT),
)
_CRC_4 = (PublicVector("data byte 40h", 0x40, 8, _TI), PublicVector("data byte 06h", 0x06, 5, _TI))

#: The first byte of a T-format request, by data ID.
CONTROL_FIELDS = {0: 0x02, 1: 0x8A, 2: 0x92, 3: 0x1A, 6: 0x32, 7: 0xBA, 8: 0xC2, 12: 0x62, 13: 0xEA, 5: 0x2A, 10: 0x52}


def vectors_of(crc: Crc) -> tuple[PublicVector, ...]:
    """Return the vectors for a CRC with these parameters if it is one of the two BiSS CRCs (6 or 4 bits, inverted)."""
    if crc.init or crc.xorout != crc.mask or crc.refin or crc.refout:
        return ()
    return {(6, 0x03): _CRC_6, (4, 0x03): _CRC_4}.get((crc.width, crc.poly), ())
