# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Register access over BiSS C: control frames for masters and slaves.

A BiSS frame carries one bit of control data each way: CDM from the master, the inverse of the level of MA during the
timeout, and CDS from the slave, after the start bit. The bits of successive frames form a control frame, which reads
or writes registers:

==== ================================= ==================================================================
step CDM                               CDS, the answers to these bits
==== ================================= ==================================================================
1    at least 14 zeros                 0
2    S = 1, CTS = 1, ID2..0, ADR6..0,  IDL0..15: each slave takes the first bit that is still 0 as its ID
     CRC3..0                           (there are 8 IDs)
3    R W: 10 to read, 01 to write      the same R W. An inverted W refuses the register
4    S = 1                             S = 1, or 0 while the slave is busy. The master then sends S again
5    DATA7..0, CRC3..0 to write, 12    DATA7..0, CRC3..0: the byte read, or the byte received
     zeros to read
6    P = 0                             P = 0, or 1 to refuse the next register
7    S = 1 as in 4 for the next
     register, or 0 to end
==== ================================= ==================================================================

CDS comes early in a frame and CDM at its end, so the answer to a bit comes in the next frame. The CRC is x^4 + x + 1,
start value 0, inverted, over CTS, ID and ADR, or over a byte of data. S, R, W, P and IDL are not protected by a CRC.
Therefore:

* A write that no slave understood looks like a refused one: the bits R and W come back as 00.
* If the slave's S bit is lost on its way to the master, master and slave stay out of step by one bit. A byte read then
  fails its CRC. A byte written is not stored, but values whose CRC ends in 0 (half of all values) are echoed as if they
  had been stored. Read back what you write.
* An incomplete byte can be stored: if a write is aborted within a byte, the slave can store the bits that it has
  received, followed by zeros, if the CRC of that value is 0 (one in 68 combinations of bit position and value). Write
  such a register again, and take special care if any value in it starts an action.

Source: "BiSS Interface, Protocol Description (BiSS C)", Rev C6, iC-Haus, pages 9 to 14 and 18. Three details come from
two published masters: the CRC covers CTS, each answer comes in the frame described above, and P comes before another
S. The masters are lenzencoders/BISS-C (BiSS_C_Master/lib/BiSS_C_Master) and TexasInstruments/motor-control-sdk
(source/position_sense/bissc). Two details are inferred: the end of a chain that has ID 0, and the reaction of a slave
to a corrupted byte or to R W = 00 or 11. Not yet tested on hardware. Commands (CTS = 0) are not covered: a
:class:`Slave` ignores them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from operator import index
from typing import Final

from .codec import Data, as_bytes, check_width, whole_number
from .errors import ConstantError, CrcError, LengthError, RangeError

__all__ = [
    "IDS",
    "REGISTERS",
    "ZEROS",
    "AccessError",
    "Answer",
    "Master",
    "Outcome",
    "RegisterBus",
    "Request",
    "Slave",
    "Wants",
    "crc",
    "decode_byte",
    "encode_byte",
]

#: Number of zeros that precede a control frame, and that end one at any time.
ZEROS: Final = 14
#: Number of bits of a control frame after S up to the CRC of the address, up to W, and of a byte with its CRC.
ADDRESS_BITS: Final = 15
HEADER_BITS: Final = 17
BYTE_BITS: Final = 12
#: Number of IDs that slaves can take. ID 0 is the only slave, or the last of a chain, whose SLI is 0.
IDS: Final = 8
#: Number of registers that one control frame can reach: 00h to 3Fh or 40h to 7Fh.
REGISTERS: Final = 64

#: The bits R W S of a request as a word, in bits 16 to 14: 101 to read, 011 to write.
_READ_REQUEST_BITS: Final = 0x00014000
_WRITE_REQUEST_BITS: Final = 0x0000C000


#: Numbers of bits: of CTS, ID and ADR, of a CRC, of an answer up to W, and of a request or an answer as a word.
HEAD_BITS: Final = 11
CRC_BITS: Final = 4
_ECHO_BITS: Final = 18
_WORD_BITS: Final = 32
#: The bits R W of an access.
_READ_BITS: Final = 0b10
_WRITE_BITS: Final = 0b01
#: Answers up to W that are all 1.
_ALL_ONES: Final = 0x3FFFF


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


class Wants(Enum):
    """Request from a slave to the program that runs it. The slave is busy until the request is fulfilled."""

    NOTHING = "nothing"
    BYTE = "the byte of the register at the address: call give()"
    STORE = "the value to be stored at the address: call stored()"


def crc(value: int, bits: int) -> int:
    """Compute the CRC of control data.

    Args:
        value: Control data, the highest bit sent first.
        bits: Number of bits. Any higher bits of ``value`` are ignored.

    Returns:
        The CRC, 4 bits, inverted as it is sent.
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
    """Return the bits received so far with one more bit, which becomes the lowest bit."""
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
        """Split the 11 bits of the head and check the CRC of 4 bits that follows them.

        Return None if the CRC is wrong.
        """
        head_bits = bits >> CRC_BITS
        received_crc = bits & 0xF
        is_correct = received_crc == crc(head_bits, HEAD_BITS)
        return cls.decode(head_bits) if is_correct else None


def encode_byte(value: int) -> int:
    """Append the CRC to a byte of data.

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
    """Check the CRC of a byte of data.

    Args:
        bits: The byte and its CRC, 12 bits.

    Returns:
        The byte.

    Raises:
        LengthError: There are more than 12 bits, or the number is negative.
        CrcError: The CRC does not match.
    """
    bits = whole_number("bits", bits)
    if not 0 <= bits < 1 << BYTE_BITS:
        raise LengthError(BYTE_BITS, bits.bit_length(), "bits")
    value = bits >> CRC_BITS
    received_crc = bits & 0xF
    computed_crc = crc(value, 8)
    if received_crc != computed_crc:
        raise CrcError(received_crc, computed_crc)
    return value


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
        if not 0 <= word < 1 << _WORD_BITS:
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
        # These are the two bits after the byte and its CRC in a write, and all 14 bits after R W S in a read.
        trailing_mask = 0x3 if is_write else 0x3FFF
        trailing_zeros = word & trailing_mask
        if trailing_zeros:
            raise ConstantError("the zeros at the end", trailing_zeros, 0)
        return cls(head.slave_id, head.address, value)

    def bits(self) -> tuple[int, ...]:
        """Return the CDM bits of the whole access, one for each BiSS frame, for a slave that is never busy."""
        word = self.encode()
        word_bits = tuple(bit_at(word, place) for place in reversed(range(_WORD_BITS)))
        start_bit = (1,)
        return (0,) * ZEROS + start_bit + word_bits

    def _check_echo(self, answers: int) -> Outcome:
        """Return the outcome of the 18 answers to the header, from IDL0 in bit 17 to W in bit 0.

        The outcome is RUNNING if the slave accepts the access.
        """
        # The first answers are the IDL bits, in the order of the IDs: a 1 shows that a slave has taken the ID.
        has_taken_id = bit_at(answers, _ECHO_BITS - 1 - self.slave_id)
        never_changes = answers == _ALL_ONES
        if never_changes or not has_taken_id:
            return Outcome.NO_ANSWER
        # R and W, the last two answers:   accepted   refused (W inverted)
        #                        to read   10         11
        #                        to write  01         00
        accepted_bits = _READ_BITS if self.value is None else _WRITE_BITS
        refused_bits = accepted_bits ^ 0b01
        access_bits = answers & 0b11
        if access_bits == accepted_bits:
            return Outcome.RUNNING
        if access_bits == refused_bits:
            return Outcome.REFUSED
        # Only a read gets here with the bits 00.
        return Outcome.NO_ANSWER if access_bits == 0 else Outcome.BAD_ECHO

    def _check_data(self, answers: int) -> tuple[Outcome, int | None]:
        """Return the outcome of the 12 answers to DATA and its CRC, and the byte that was read.

        The byte is None for a write, and after a CRC error. A write has succeeded if the slave has echoed the byte and
        its CRC.
        """
        if self.value is not None:
            is_repeated = answers == encode_byte(self.value)
            outcome = Outcome.DONE if is_repeated else Outcome.BAD_ECHO
            return outcome, None
        try:
            return Outcome.DONE, decode_byte(answers)
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

        This function is for masters that send a whole word before they look at the answer. They cannot wait for a busy
        slave.

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
        if not 0 <= cds < 1 << _WORD_BITS:
            raise LengthError(_WORD_BITS, cds.bit_length(), "bits")
        # bit  31..16   15  14  13  12..5  4..1  0
        #      IDL0..15  R   W   S  DATA   CRC   P
        slaves = _count_slaves(cds >> 16)
        echo = request._check_echo(cds >> 14)
        if echo is not Outcome.RUNNING:
            return cls(echo, slaves)
        start_bit = bit_at(cds, 13)
        if not start_bit:
            return cls(Outcome.BUSY, slaves)
        outcome, value = request._check_data((cds >> 1) & 0xFFF)
        return cls(outcome, slaves, value)


def _count_slaves(idl: int) -> int:
    """Return how many slaves have taken an ID, according to the 16 bits IDL0 (bit 15) to IDL15 (bit 0).

    Three slaves are ``0b1110_0000_0000_0000``. A result of 9 means more than 8.
    """
    # Slaves take IDs from 0 on, so their number is the number of 1 bits before the first 0. In the inverted bits, the
    # first 0 is the highest 1.
    inverted = ~idl & 0xFFFF
    leading_ones = 16 - inverted.bit_length()
    return min(leading_ones, 9)


class _Phase(Enum):
    """Position of a state machine within a control frame."""

    WAIT = "outside: waiting for 14 zeros, then for S"
    HEADER = "steps 2 and 3"
    START = "step 4"
    BYTE = "steps 5 and 6"


class Master:
    """BiSS C master for register access.

    Start an access with :meth:`read` or :meth:`write`. Then call :meth:`next` once in every BiSS frame, between its
    CDS bit and its timeout, until ``outcome`` is no longer RUNNING. Continue to call it while frames are sent, because
    it counts the zeros that are required between two accesses. An access to one register takes at most 46 frames. Each
    further register adds 14 frames, and each frame in which the slave is busy adds one.

    Attributes:
        outcome: State or result of the access.
        slaves: Number of slaves that have taken an ID, 9 for more than 8. It is known after the header.
        done: Number of bytes that were read or written.
        data: Bytes that were read.
    """

    def __init__(self) -> None:
        self.outcome = Outcome.IDLE
        self.slaves = 0
        self.done = 0
        self.data = b""
        self._phase = _Phase.WAIT
        #: One request for each register of the access.
        self._requests: tuple[Request, ...] = ()
        #: Number of zeros that were sent since the last 1.
        self._zeros = 0
        #: Number of CDS bits in ``_answer_bits``.
        self._bit_count = 0
        #: Number of successive frames in which the slave was busy, and the allowed number.
        self._busy_count = 0
        self._busy_limit = 0
        #: CDM bits of this phase, the first one highest: CTS to W, or a byte and its CRC.
        self._bits_to_send = 0
        #: CDS bits of this phase, the last one in bit 0.
        self._answer_bits = 0

    def read(self, address: int, count: int = 1, *, slave_id: int = 0, busy_limit: int) -> None:
        """Start to read registers. An access in progress is aborted.

        Args:
            address: Address of the first register, 00h to 7Fh.
            count: Number of registers.
            slave_id: ID of the slave, 0 to 7.
            busy_limit: Maximum number of successive frames in which the slave may be busy. Choose the number that takes
                20 ms.

        Raises:
            RangeError: The ID or the address is out of range, ``count`` is not 1 or more, or the registers extend
                beyond 3Fh or 7Fh. An access in progress then continues.
        """
        # A value of None reads a register. For a larger count, one register more than allowed is enough for the error.
        register_count = min(whole_number("count", count), REGISTERS + 1)
        values: list[int | None] = [None] * register_count
        self._begin_frame(slave_id, address, values, busy_limit)

    def write(self, address: int, data: Data, *, slave_id: int = 0, busy_limit: int) -> None:
        """Start to write registers. An access in progress is aborted.

        Args:
            address: Address of the first register, 00h to 7Fh.
            data: Bytes to write to ascending addresses.
            slave_id: ID of the slave, 0 to 7.
            busy_limit: Maximum number of successive frames in which the slave may be busy. Choose the number that takes
                20 ms.

        Raises:
            RangeError: The ID or the address is out of range, ``data`` is empty, or the registers extend beyond 3Fh or
                7Fh. An access in progress then continues.
        """
        self._begin_frame(slave_id, address, list(as_bytes(data)), busy_limit)

    def _begin_frame(self, slave_id: int, address: int, values: list[int | None], busy_limit: int) -> None:
        """Begin a control frame for an access, and forget the previous access, except how many zeros were sent.

        ``values`` has the byte to write for each register from ``address`` on, or None to read it. Raises RangeError,
        before anything is changed, if the ID or the address is out of range, or if the registers extend beyond 3Fh or
        7Fh.
        """
        slave_id = whole_number("slave_id", slave_id)
        address = whole_number("address", address)
        first_value = values[0] if values else None
        first_word = Request(slave_id, address, first_value).encode()
        # The access ends at 3Fh or 7Fh.
        count_limit = REGISTERS - address % REGISTERS
        if not 0 < len(values) <= count_limit:
            raise RangeError("the number of registers", len(values), f"1 to {count_limit} from address {address:02X}h")
        self.outcome = Outcome.RUNNING
        self.slaves = 0
        self.done = 0
        self.data = b""
        self._bit_count = self._answer_bits = 0
        self._phase = _Phase.WAIT
        self._requests = tuple(Request(slave_id, address + index, value) for index, value in enumerate(values))
        self._busy_limit = busy_limit
        # The highest 17 of 32 bits: CTS to W.
        self._bits_to_send = first_word >> 15

    def abort(self) -> None:
        """Abort the access by sending zeros. An aborted write can store a different value, as described above."""
        if self.outcome is Outcome.RUNNING:
            self.outcome = Outcome.ABORTED
        self._phase = _Phase.WAIT

    def next(self, cds: int) -> int:
        """Advance by one BiSS frame.

        Args:
            cds: The CDS bit of this frame.

        Returns:
            The CDM bit of this frame. MA carries its inverse during the timeout.
        """
        # A pin may be read as a bool or as a NumPy byte, into which the collected bits would not fit.
        cds = int(cds & 1)
        if self._phase is _Phase.HEADER:
            cdm = self._follow_header(cds)
        elif self._phase is _Phase.START:
            cdm = self._follow_start(cds)
        elif self._phase is _Phase.BYTE:
            cdm = self._follow_byte(cds)
        else:
            # Outside a control frame, the master sends zeros. After 14 of them, the start bit S = 1 begins an access.
            cdm = int(self.outcome is Outcome.RUNNING and self._zeros >= ZEROS)
            if cdm:
                self._phase = _Phase.HEADER
        self._zeros = 0 if cdm else self._zeros + 1
        return cdm

    def _end_access(self, outcome: Outcome) -> int:
        """End the access with this outcome, and return the CDM bit 0, which ends the control frame."""
        self.outcome = outcome
        self._phase = _Phase.WAIT
        return 0

    def _follow_header(self, cds: int) -> int:
        """Take an answer to the header, and return its next CDM bit: CTS, ID, ADR, their CRC, R and W in turn.

        The bit after W is S. If the answers do not accept the access, this bit is 0 and ends the control frame.
        """
        self._answer_bits = append_bit(self._answer_bits, cds)
        self._bit_count += 1
        if self._bit_count <= HEADER_BITS:
            # The first call, with one answer, returns CTS, the highest bit.
            return bit_at(self._bits_to_send, HEADER_BITS - self._bit_count)
        # R and W, the last two answers, follow the IDL bits.
        idl = self._answer_bits >> 2
        self.slaves = _count_slaves(idl)
        # The header belongs to the first register.
        first_request = self._requests[0]
        echo = first_request._check_echo(self._answer_bits)
        if echo is not Outcome.RUNNING:
            return self._end_access(echo)
        return self._request_register()

    def _request_register(self) -> int:
        """Return the CDM bit S = 1, which asks the slave to look up a register, and start waiting for its answer."""
        self._phase = _Phase.START
        self._busy_count = 0
        return 1

    def _follow_start(self, cds: int) -> int:
        """Take an answer to S, and return the next CDM bit: S = 1 again while the slave is busy, then DATA7.

        An answer of 0 means that the slave is busy. After more than ``_busy_limit`` such answers, the access ends.
        DATA7 is the first bit of the byte, and 0 in a read.
        """
        if not cds:
            if self._busy_count >= self._busy_limit:
                return self._end_access(Outcome.BUSY)
            self._busy_count += 1
            return 1
        self._phase = _Phase.BYTE
        self._bit_count = self._answer_bits = 0
        value = self._requests[self.done].value
        self._bits_to_send = 0 if value is None else encode_byte(value)
        return bit_at(self._bits_to_send, BYTE_BITS - 1)

    def _follow_byte(self, cds: int) -> int:
        """Take an answer to a byte, and return the next CDM bit: DATA6..0, their CRC, P, and S if a register follows.

        In a read, DATA and CRC are zeros, and the answers to them are the byte. P is always 0.
        """
        has_sent_p = self._bit_count == BYTE_BITS
        if has_sent_p:
            # This is the answer to P: 1 refuses the next register.
            is_refused = bool(cds)
            return self._end_access(Outcome.REFUSED) if is_refused else self._request_register()
        self._answer_bits = append_bit(self._answer_bits, cds)
        self._bit_count += 1
        if self._bit_count < BYTE_BITS:
            return bit_at(self._bits_to_send, BYTE_BITS - 1 - self._bit_count)
        request = self._requests[self.done]
        outcome, value_read = request._check_data(self._answer_bits)
        if outcome is not Outcome.DONE:
            return self._end_access(outcome)
        if value_read is not None:
            self.data += bytes([value_read])
        self.done += 1
        is_last = self.done == len(self._requests)
        if is_last:
            # The answer to its P does not matter, because it concerns a register that was not requested.
            return self._end_access(Outcome.DONE)
        # P is 0.
        return 0


class AccessError(RuntimeError):
    """Error of an access to registers.

    Attributes:
        outcome: Result of the access.
        address: Address of the first register.
    """

    def __init__(self, outcome: Outcome, address: int) -> None:
        super().__init__(outcome, address)
        self.outcome = outcome
        self.address = address

    def __str__(self) -> str:
        return f"access to registers from {self.address:02X}h failed: {self.outcome.value}"


class RegisterBus:
    """Registers of one slave, for ``run`` and for programs that read and write bytes.

    Args:
        exchange: Function that carries out one BiSS frame. It takes the CDM bit of the previous frame, whose inverse MA
            carries during the timeout, and returns the CDS bit of this frame, alone or as the first member of a tuple.
        slave_id: ID of the slave, 0 to 7.
        busy_limit: Maximum number of successive frames in which the slave may be busy. Choose the number that takes
            20 ms.
    """

    def __init__(
        self, exchange: Callable[[int], int | tuple[int, ...]], *, slave_id: int = 0, busy_limit: int = 0
    ) -> None:
        self.slave_id = slave_id
        self.busy_limit = busy_limit
        self._exchange = exchange
        self._master = Master()
        self._cdm = 0

    def read(self, address: int, length: int, /) -> bytes:
        """Read registers.

        Args:
            address: Address of the first register, 00h to 7Fh.
            length: Number of registers.

        Returns:
            Their bytes.

        Raises:
            AccessError: The registers could not be read.
            RangeError: The ID or the address is out of range, or the registers extend beyond 3Fh or 7Fh.
        """
        self._master.read(address, length, slave_id=self.slave_id, busy_limit=self.busy_limit)
        self._finish_access(address)
        return self._master.data

    def write(self, address: int, data: Data, /) -> None:
        """Write registers.

        Args:
            address: Address of the first register, 00h to 7Fh.
            data: Bytes to write to ascending addresses.

        Raises:
            AccessError: The access failed. Some or all of the registers may have been written.
            RangeError: The ID or the address is out of range, or the registers extend beyond 3Fh or 7Fh.
        """
        self._master.write(address, data, slave_id=self.slave_id, busy_limit=self.busy_limit)
        self._finish_access(address)

    def _finish_access(self, address: int) -> None:
        """Carry out BiSS frames until the access that begins at an address ends.

        Raises AccessError if the access fails.
        """
        while self._master.outcome is Outcome.RUNNING:
            received = self._exchange(self._cdm)
            cds = received[0] if isinstance(received, tuple) else received
            self._cdm = self._master.next(cds)
        if self._master.outcome is not Outcome.DONE:
            raise AccessError(self._master.outcome, address)


class Slave:
    """BiSS C slave, for simulators and test benches.

    Call :meth:`next` once in every BiSS frame, then check ``wants``. To answer S in time, the slave requests a byte
    before it is certain that the master reads it: after W, and after each P the byte of the following register, even if
    the master does not continue. Registers with side effects on reading must allow for that.

    Attributes:
        readable: Addresses that a master may read. Others are refused.
        writable: Addresses that a master may write. Others are refused.
        wants: Request of the slave.
        address: Address of the register in the request.
        value: Value to store.
        slave_id: ID in the last control frame, or None if this slave has taken none.
    """

    def __init__(self, readable: Iterable[int] = range(128), writable: Iterable[int] = range(128)) -> None:
        self.readable = set(readable)
        self.writable = set(writable)
        self.wants = Wants.NOTHING
        self.address = 0
        self.value = 0
        self.slave_id: int | None = None
        self._phase = _Phase.WAIT
        #: True once this slave has taken an IDL bit.
        self._has_taken_id = False
        #: True if the access is a write.
        self._is_write = False
        #: Byte to read and its CRC. None for a write, or until ``give`` is called.
        self._byte_to_send: int | None = None
        #: Address of the register that is read or written next.
        self._register_address = 0
        #: Number of zeros that were received since the last 1.
        self._zeros = 0
        #: Number of CDM bits of this phase in ``_received``, the last one in bit 0.
        self._bit_count = 0
        self._received = 0

    def give(self, value: int) -> None:
        """Provide the byte of the register that the slave requests. This has no effect if the slave requests no byte.

        Args:
            value: The byte.

        Raises:
            RangeError: ``value`` is not 0 to 255.
        """
        bits = encode_byte(value)
        if self.wants is Wants.BYTE:
            self.wants = Wants.NOTHING
            self._byte_to_send = bits

    def stored(self) -> None:
        """Confirm that the value has been stored. This has no effect if nothing is to be stored."""
        if self.wants is Wants.STORE:
            self.wants = Wants.NOTHING

    def next(self, cdm: int, upstream: int = 0) -> int:
        """Advance by one BiSS frame.

        Args:
            cdm: The CDM bit of the previous frame.
            upstream: The CDS bit that arrives at SLI in this frame, from the next slave further from the master. 0 if
                there is none.

        Returns:
            The CDS bit of this frame.
        """
        cdm = int(cdm & 1)
        upstream = int(upstream & 1)
        # A control frame begins with a 1 after enough zeros.
        may_begin = self._zeros >= ZEROS
        self._zeros = 0 if cdm else self._zeros + 1
        if self._zeros >= ZEROS:
            self._leave_frame()
            return upstream
        if self._phase is _Phase.HEADER:
            return self._follow_header(cdm, upstream)
        if self._phase is _Phase.START:
            return self._follow_start(cdm, upstream)
        if self._phase is _Phase.BYTE:
            return self._follow_byte(cdm)
        if not cdm or not may_begin:
            return upstream
        self._phase = _Phase.HEADER
        self._bit_count = self._received = 0
        self.slave_id = None
        self._has_taken_id = False
        return self._answer_id_bit(upstream)

    def _may_access_register(self) -> bool:
        """Return whether the master may read, or in a write, may write the current register."""
        return self._register_address in (self.writable if self._is_write else self.readable)

    def _request_byte(self) -> None:
        """In a read, ask the program for the byte of the current register.

        Nothing is requested if the byte is known already, or while an earlier value is not stored.
        """
        if not self._is_write and self._byte_to_send is None and self.wants is Wants.NOTHING:
            self.wants = Wants.BYTE
            self.address = self._register_address

    def _leave_frame(self) -> None:
        """Leave the control frame, and ignore the rest of it.

        A request to the program for a byte is withdrawn, but a value that was received must still be stored.
        """
        self._phase = _Phase.WAIT
        if self.wants is Wants.BYTE:
            self.wants = Wants.NOTHING

    def _await_start(self) -> None:
        """Wait for S, after W or P. In a read, ask the program for the byte of the current register."""
        self._phase = _Phase.START
        self._byte_to_send = None
        self._request_byte()

    def _answer_id_bit(self, upstream: int) -> int:
        """Return the CDS bit in the place of an IDL bit: 1 to take this ID, otherwise the bit that arrives at SLI.

        The IDL bits stand for the IDs 0, 1, 2 and so on. A slave takes the first ID that no slave further from the
        master has taken. ``upstream`` is the bit that arrives at SLI: 1 if such a slave has taken this ID.
        """
        is_taken = bool(upstream)
        if is_taken or self._has_taken_id or self._bit_count > IDS:
            return upstream
        self._has_taken_id = True
        # IDL8 only shows that there are more slaves than IDs.
        self.slave_id = self._bit_count if self._bit_count < IDS else None
        return 1

    def _follow_header(self, cdm: int, upstream: int) -> int:
        """Take a CDM bit of the header, and return the CDS bit that answers it.

        The answers to CTS, ID, ADR and their CRC are the IDL bits. The answers to R and W follow.
        """
        self._received = append_bit(self._received, cdm)
        self._bit_count += 1
        if self._bit_count <= ADDRESS_BITS:
            cds = self._answer_id_bit(upstream)
            if self._bit_count == ADDRESS_BITS:
                self._take_address()
            return cds
        is_r_bit = self._bit_count == HEADER_BITS - 1
        return cdm if is_r_bit else self._answer_w_bit(cdm)

    def _take_address(self) -> None:
        """Take the address of the register from the header. Leave the control frame if it is not for this slave.

        It is not for this slave if it is a command (CTS = 0), has a different ID, or has a CRC error.
        """
        head = ControlHead.decode_with_crc(self._received)
        if head is not None and head.is_register_access and head.slave_id == self.slave_id:
            self._register_address = head.address
        else:
            self._leave_frame()

    def _answer_w_bit(self, cdm: int) -> int:
        """Return the answer to W, the bit after R: the same bit, or the inverse to refuse the register.

        R W is 10 to read and 01 to write. After other bits and after a refusal, the slave leaves the control frame.
        """
        # W is bit 0, and R was received before it.
        r_bit = bit_at(self._received, 1)
        self._is_write = bool(cdm)
        if r_bit == cdm:
            # R W is neither 10 nor 01. It is echoed as received, to inform the master.
            self._leave_frame()
            return cdm
        if not self._may_access_register():
            self._leave_frame()
            return 1 - cdm
        self._await_start()
        return cdm

    def _follow_start(self, cdm: int, upstream: int) -> int:
        """Return the answer to S, with which the master asks for a register: 0 while the slave is busy, otherwise 1.

        The slave is busy until the program has fulfilled its request (``wants``). If the master sends 0 instead of S,
        leave the control frame and return the bit that arrives at SLI.
        """
        if not cdm:
            self._leave_frame()
            return upstream
        self._request_byte()
        if self.wants is not Wants.NOTHING:
            return 0
        self._phase = _Phase.BYTE
        self._bit_count = self._received = 0
        return 1

    def _follow_byte(self, cdm: int) -> int:
        """Take a CDM bit of a byte, its CRC or P, and return the CDS bit that answers it.

        In a read, this is a bit of the byte and its CRC. In a write, it is the received bit. The answer to P is 1 to
        refuse the next register.
        """
        self._received = append_bit(self._received, cdm)
        self._bit_count += 1
        if self._bit_count > BYTE_BITS:
            return self._answer_p_bit(cdm)
        if self._byte_to_send is not None:
            return bit_at(self._byte_to_send, BYTE_BITS - self._bit_count)
        if self._bit_count == BYTE_BITS:
            self._take_byte()
        return cdm

    def _answer_p_bit(self, cdm: int) -> int:
        """Return the answer to P, the bit after a byte: 0 if the next register can be accessed, 1 to refuse it.

        A P of 1, which masters do not send, is also answered with 1.
        """
        # A control frame cannot go beyond 3Fh or 7Fh.
        is_last = self._register_address % REGISTERS == REGISTERS - 1
        if not is_last:
            self._register_address += 1
        if cdm or is_last or not self._may_access_register():
            self._leave_frame()
            return 1
        self._await_start()
        return 0

    def _take_byte(self) -> None:
        """Ask the program to store the byte that was received. After a CRC error, leave the control frame instead.

        The echo shows the error to the master.
        """
        try:
            self.value = decode_byte(self._received)
        except CrcError:
            self._leave_frame()
            return
        self.wants = Wants.STORE
        self.address = self._register_address
