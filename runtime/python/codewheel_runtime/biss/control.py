# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Control frames of BiSS C: their lengths, CRCs and heads, and the outcome of an access."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from operator import index
from typing import Final

from ..codec import check_width, whole_number
from ..errors import CrcError, LengthError

#: Number of zeros that must precede a control frame, and that end a control frame at any time.
ZEROS: Final = 14
#: Number of bits after S up to the CRC of the address, after S up to W, and in a byte with its CRC.
HEAD_AND_CRC_BITS: Final = 15
HEADER_BITS: Final = 17
BYTE_BITS: Final = 12
#: Number of IDs that slaves can take. ID 0 is the only slave, or the last slave in a chain, whose SLI is 0.
IDS: Final = 8
#: Number of registers that one control frame can reach: 00h to 3Fh or 40h to 7Fh.
REGISTERS: Final = 64
#: Number of bits in CTS, ID and ADR together, and in a CRC.
HEAD_BITS: Final = 11
CRC_BITS: Final = 4


class Outcome(Enum):
    """State or result of an access."""

    IDLE = "no access was started"
    RUNNING = "the access is running"
    DONE = "the access succeeded"
    REFUSED = "the register is protected or not implemented, or the write was not understood"
    NO_ANSWER = "no slave has this ID, or CDS never changes"
    BUSY = "the slave was busy for more frames than allowed"
    BAD_CRC = "the byte read has a CRC error"
    BAD_ECHO = "R W or a byte was echoed wrongly, and may have been written"
    ABORTED = "the caller aborted the access"


def crc(value: int, bits: int) -> int:
    """Compute the CRC of control data.

    Args:
        value: Control data, with the highest bit sent first.
        bits: Number of bits. Higher bits of ``value`` are ignored.

    Returns:
        The 4-bit CRC, inverted as it is sent.
    """
    value = index(value)
    register = 0
    # The bits pass through a shift register of 4 bits, the highest bit first.
    for bit in range(bits - 1, -1, -1):
        feedback = ((register >> 3) ^ (value >> bit)) & 1
        # The polynomial x^4 + x + 1 without its highest term is 0b0011.
        register = ((register << 1) & 0xF) ^ (feedback * 0x3)
    # The CRC is sent inverted.
    return register ^ 0xF


def bit_at(bits: int, place: int) -> int:
    """Return bit ``place`` of a number. The lowest bit is at place 0."""
    return (bits >> place) & 1


def append_bit(bits: int, bit: int) -> int:
    """Append a bit to the bits received so far, as the lowest bit."""
    return (bits << 1) | bit


@dataclass(frozen=True)
class ControlHead:
    """First bits of a control frame: CTS, ID2..0 and ADR6..0.

    Attributes:
        is_register_access: CTS. False for a command.
        slave_id: ID of the slave.
        address: Address of the register.
    """

    is_register_access: bool
    slave_id: int
    address: int

    @classmethod
    def decode(cls, bits: int) -> ControlHead:
        """Split the 11 bits of the head: CTS in bit 10, the ID in bits 9 to 7, and the address in bits 6 to 0."""
        return cls(is_register_access=bool(bit_at(bits, 10)), slave_id=(bits >> 7) & 0x7, address=bits & 0x7F)

    @classmethod
    def decode_with_crc(cls, bits: int) -> ControlHead | None:
        """Split the 11 bits of the head, and check the 4-bit CRC that follows them.

        Return None if the CRC is wrong.
        """
        head_bits = bits >> CRC_BITS
        received_crc = bits & 0xF
        is_correct = received_crc == crc(head_bits, HEAD_BITS)
        return cls.decode(head_bits) if is_correct else None


def encode_byte(value: int) -> int:
    """Append its CRC to a data byte.

    Args:
        value: The byte.

    Returns:
        The byte and its CRC, 12 bits.

    Raises:
        RangeError: ``value`` is not 0 to 255.
    """
    value = check_width("value", value, 8)
    return (value << 4) | crc(value, 8)


def decode_byte(bits: int) -> int:
    """Check the CRC of a data byte.

    Args:
        bits: The byte and its CRC, 12 bits.

    Returns:
        The byte.

    Raises:
        LengthError: There are more than 12 bits, or the number is negative.
        CrcError: The CRC does not match.
    """
    bits = whole_number("bits", bits)
    if not 0 <= bits < (1 << BYTE_BITS):
        raise LengthError(BYTE_BITS, bits.bit_length(), "bits")
    value = bits >> CRC_BITS
    received_crc = bits & 0xF
    computed_crc = crc(value, 8)
    if received_crc != computed_crc:
        raise CrcError(received_crc, computed_crc)
    return value


class Phase(Enum):
    """Position of a state machine within a control frame."""

    WAIT = "outside: waiting for 14 zeros, then for S"
    HEADER = "steps 2 and 3"
    START = "step 4"
    BYTE = "steps 5 and 6"
