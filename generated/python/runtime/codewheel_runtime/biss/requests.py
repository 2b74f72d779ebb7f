# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Register requests that are sent as whole words, and the answers to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ..codec import check_width, whole_number
from ..errors import ConstantError, CrcError, LengthError
from .control import HEAD_BITS, ZEROS, ControlHead, Outcome, bit_at, crc, decode_byte, encode_byte

#: Number of bits in the answers up to W, and in a request or answer that is sent as a word.
_ECHO_BITS: Final = 18
_WORD_BITS: Final = 32
#: The bits R W S of a request as a word, in bits 16 to 14: 101 to read, 011 to write.
_READ_REQUEST_BITS: Final = 0x00014000
_WRITE_REQUEST_BITS: Final = 0x0000C000
#: The bits R and W of an access.
_READ_BITS: Final = 0b10
_WRITE_BITS: Final = 0b01
#: The answers up to W if all of them are 1.
_ALL_ONES: Final = 0x3FFFF


@dataclass(frozen=True)
class Request:
    """Access to one register.

    Attributes:
        slave_id: ID of the slave, 0 to 7.
        address: Address of the register, 00h to 7Fh.
        value: Byte to write, or None to read.
    """

    slave_id: int
    address: int
    value: int | None = None

    def encode(self) -> int:
        """Encode the access as a word, in the layout of TI's masters.

        Returns:
            The 32 bits that a master sends after the first S, with the first one most significant: CTS, ID2..0,
            ADR6..0, CRC3..0, R, W, S, then DATA7..0, CRC3..0 or 12 zeros, P, and one more zero.

        Raises:
            RangeError: The ID, the address or the value is out of range.
        """
        slave_id = check_width("slave_id", self.slave_id, 3)
        address = check_width("address", self.address, 7)
        # The comment in decode() shows the places of these bits. CTS is 1.
        head_bits = (1 << 10) | (slave_id << 7) | address
        access_bits = _READ_REQUEST_BITS
        if self.value is not None:
            access_bits = _WRITE_REQUEST_BITS | (encode_byte(self.value) << 2)
        return (head_bits << 21) | (crc(head_bits, HEAD_BITS) << 17) | access_bits

    @classmethod
    def decode(cls, word: int) -> Request:
        """Decode a word with the layout of ``encode``.

        Args:
            word: The 32 bits, with the first one most significant.

        Returns:
            The access.

        Raises:
            LengthError: There are more than 32 bits.
            CrcError: One of the two CRCs does not match.
            ConstantError: CTS or S is 0, R W is neither 10 nor 01, or the zeros at the end are not all 0.
        """
        word = whole_number("word", word)
        if not 0 <= word < (1 << _WORD_BITS):
            raise LengthError(_WORD_BITS, word.bit_length(), "bits")
        # bit  31   30..28  27..21  20..17  16..14  13..6  5..2  1..0
        #      CTS  ID      ADR     CRC     R W S   DATA   CRC   P and 0
        #      `------- head ----'
        # To read, bits 13 to 0 are all 0.
        head_bits = word >> 21
        head = ControlHead.decode(head_bits)
        received_crc = (word >> 17) & 0xF
        computed_crc = crc(head_bits, HEAD_BITS)
        if received_crc != computed_crc:
            raise CrcError(received_crc, computed_crc)
        access_bits = word & (_READ_REQUEST_BITS | _WRITE_REQUEST_BITS)
        is_write = access_bits == _WRITE_REQUEST_BITS
        value = decode_byte((word >> 2) & 0xFFF) if is_write else None
        if not head.is_register_access:
            raise ConstantError("CTS", 0, 1)
        if access_bits not in (_READ_REQUEST_BITS, _WRITE_REQUEST_BITS):
            raise ConstantError("R W S", access_bits >> 14, _READ_REQUEST_BITS >> 14)
        # In a write, they follow the byte and its CRC, and in a read R W S.
        trailing_zeros = word & (0x3 if is_write else 0x3FFF)
        if trailing_zeros:
            raise ConstantError("the zeros at the end", trailing_zeros, 0)
        return cls(head.slave_id, head.address, value)

    def bits(self) -> tuple[int, ...]:
        """Return the CDM bits of the whole access, one for each BiSS frame, for a slave that is never busy."""
        word = self.encode()
        word_bits = tuple(bit_at(word, place) for place in reversed(range(_WORD_BITS)))
        start_bit = (1,)
        return (0,) * ZEROS + start_bit + word_bits

    def _check_echo(self, answer_bits: int) -> Outcome:
        """Return the outcome from the 18 answers to the header, IDL0 in bit 17 to W in bit 0.

        The outcome is RUNNING if the slave accepts the access.
        """
        # The first answers are the IDL bits, in the order of the IDs: a 1 shows that a slave has taken the ID.
        has_taken_id = bit_at(answer_bits, _ECHO_BITS - 1 - self.slave_id)
        never_changes = answer_bits == _ALL_ONES
        if never_changes or not has_taken_id:
            return Outcome.NO_ANSWER
        # R and W, the last two answers:   accepted   refused (W inverted)
        #                        to read   10         11
        #                        to write  01         00
        accepted_bits = _READ_BITS if self.value is None else _WRITE_BITS
        refused_bits = accepted_bits ^ 0b01
        access_bits = answer_bits & 0b11
        if access_bits == accepted_bits:
            return Outcome.RUNNING
        if access_bits == refused_bits:
            return Outcome.REFUSED
        # Only a read gets here with the bits 00.
        return Outcome.NO_ANSWER if access_bits == 0 else Outcome.BAD_ECHO

    def _check_data(self, answer_bits: int) -> tuple[Outcome, int | None]:
        """Return the outcome from the 12 answers to DATA and its CRC, and the byte that was read.

        The byte is None for a write, and after a CRC error. A write has succeeded if the slave has echoed the byte and
        its CRC.
        """
        if self.value is not None:
            is_repeated = answer_bits == encode_byte(self.value)
            outcome = Outcome.DONE if is_repeated else Outcome.BAD_ECHO
            return outcome, None
        try:
            return Outcome.DONE, decode_byte(answer_bits)
        except CrcError:
            return Outcome.BAD_CRC, None


@dataclass(frozen=True)
class Answer:
    """Result of a request that was sent as a whole word.

    Attributes:
        outcome: Result of the access.
        slaves: Number of slaves that have taken an ID, 9 for more than 8.
        value: Byte that was read, otherwise None.
    """

    outcome: Outcome
    slaves: int
    value: int | None = None

    @classmethod
    def decode(cls, request: Request, cds: int) -> Answer:
        """Decode the CDS bits of the 32 frames in which the word of a request was sent.

        This function is for masters that send a whole word before they look at the answer. Such masters cannot wait
        for a busy slave.

        Args:
            request: The request.
            cds: The CDS bits, with the first one most significant: IDL0..15, R, W, S, DATA7..0, CRC3..0, P.

        Returns:
            The result.

        Raises:
            LengthError: There are more than 32 bits.
            RangeError: An attribute of the request is out of range.
        """
        request.encode()
        cds = whole_number("cds", cds)
        if not 0 <= cds < (1 << _WORD_BITS):
            raise LengthError(_WORD_BITS, cds.bit_length(), "bits")
        # bit  31..16   15  14  13  12..5  4..1  0
        #      IDL0..15  R   W   S  DATA   CRC   P
        slaves = count_slaves(cds >> 16)
        echo = request._check_echo(cds >> 14)
        if echo is not Outcome.RUNNING:
            return cls(echo, slaves)
        start_bit = bit_at(cds, 13)
        if not start_bit:
            return cls(Outcome.BUSY, slaves)
        outcome, value = request._check_data((cds >> 1) & 0xFFF)
        return cls(outcome, slaves, value)


def count_slaves(id_lock_bits: int) -> int:
    """Return how many slaves have taken an ID, according to the 16 bits IDL0 (bit 15) to IDL15 (bit 0).

    Three slaves are ``0b1110_0000_0000_0000``. A result of 9 means more than 8.
    """
    # Slaves take IDs from 0 on, so their number is the number of 1 bits before the first 0. In the inverted bits, the
    # first 0 is the highest 1.
    inverted_bits = ~id_lock_bits & 0xFFFF
    leading_ones = 16 - inverted_bits.bit_length()
    return min(leading_ones, 9)
