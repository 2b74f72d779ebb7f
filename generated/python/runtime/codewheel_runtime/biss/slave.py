# Licence 0BSD: you may use, change and distribute this file without any condition.
"""BiSS slave for register access, bit by bit."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from ..errors import CrcError
from .control import (
    BYTE_BITS,
    HEAD_AND_CRC_BITS,
    HEADER_BITS,
    IDS,
    REGISTERS,
    ZEROS,
    ControlHead,
    Phase,
    append_bit,
    bit_at,
    decode_byte,
    encode_byte,
)


class Wants(Enum):
    """Request from a slave to the program that runs it. The slave is busy until the request is fulfilled."""

    NOTHING = "nothing"
    BYTE = "the byte of the register at the address: call give()"
    STORE = "the value to be stored at the address: call stored()"


class Slave:
    """BiSS C slave, for simulators and test benches.

    Call :meth:`next` once in every BiSS frame, then check ``wants``. To answer S in time, the slave requests each
    byte before it knows whether the master will read it: after W and, for the next register, after each P. If reading a
    register has side effects, the program must allow for this.

    Attributes:
        readable: Addresses that a master may read. The slave refuses others.
        writable: Addresses that a master may write. The slave refuses others.
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
        self._phase = Phase.WAIT
        #: True once this slave has taken an IDL bit.
        self._has_taken_id = False
        #: True if the access is a write.
        self._is_write = False
        #: Byte to read and its CRC. None for a write, or until ``give`` is called.
        self._bits_to_send: int | None = None
        #: Address of the register that is read or written next.
        self._register_address = 0
        #: Number of zeros that were received since the last 1.
        self._zeros = 0
        #: Number of CDM bits of this phase in ``_received_bits``, where the last one is bit 0.
        self._bit_count = 0
        self._received_bits = 0

    def give(self, value: int) -> None:
        """Provide the byte of the register that the slave requests. This has no effect if the slave requests no byte.

        Args:
            value: The byte.

        Raises:
            RangeError: ``value`` is not 0 to 255.
        """
        byte_and_crc = encode_byte(value)
        if self.wants is Wants.BYTE:
            self.wants = Wants.NOTHING
            self._bits_to_send = byte_and_crc

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
        if self._phase is Phase.HEADER:
            return self._follow_header(cdm, upstream)
        if self._phase is Phase.START:
            return self._follow_start(cdm, upstream)
        if self._phase is Phase.BYTE:
            return self._follow_byte(cdm)
        if not cdm or not may_begin:
            return upstream
        self._phase = Phase.HEADER
        self._bit_count = self._received_bits = 0
        self.slave_id = None
        self._has_taken_id = False
        return self._answer_id_bit(upstream)

    def _may_access_register(self) -> bool:
        """Return whether the master may read the current register or, in a write, may write it."""
        return self._register_address in (self.writable if self._is_write else self.readable)

    def _request_byte(self) -> None:
        """In a read, ask the program for the byte of the current register.

        Nothing is requested if the byte is already known, or while an earlier value has not been stored.
        """
        if not self._is_write and self._bits_to_send is None and self.wants is Wants.NOTHING:
            self.wants = Wants.BYTE
            self.address = self._register_address

    def _leave_frame(self) -> None:
        """Leave the control frame, and ignore the rest of it.

        A request for a byte from the program is withdrawn, but a received value must still be stored.
        """
        self._phase = Phase.WAIT
        if self.wants is Wants.BYTE:
            self.wants = Wants.NOTHING

    def _await_start(self) -> None:
        """Wait for S, after W or P. In a read, ask the program for the byte of the current register."""
        self._phase = Phase.START
        self._bits_to_send = None
        self._request_byte()

    def _answer_id_bit(self, upstream: int) -> int:
        """Return the CDS bit in the place of an IDL bit: 1 to take this ID, otherwise the bit that arrives at SLI.

        The IDL bits represent the IDs 0, 1, 2 and so on. A slave takes the first ID that is not taken by a slave
        further from the master. ``upstream`` is the bit that arrives at SLI: 1 if such a slave has taken this ID.
        """
        is_taken = bool(upstream)
        if is_taken or self._has_taken_id or self._bit_count > IDS:
            return upstream
        self._has_taken_id = True
        # IDL8 only shows that there are more slaves than IDs.
        self.slave_id = self._bit_count if self._bit_count < IDS else None
        return 1

    def _follow_header(self, cdm: int, upstream: int) -> int:
        """Process a CDM bit of the header, and return the CDS bit that answers it.

        The answers to CTS, ID, ADR and their CRC are the IDL bits. The answers to R and W follow.
        """
        self._received_bits = append_bit(self._received_bits, cdm)
        self._bit_count += 1
        if self._bit_count <= HEAD_AND_CRC_BITS:
            cds = self._answer_id_bit(upstream)
            if self._bit_count == HEAD_AND_CRC_BITS:
                self._take_address()
            return cds
        is_r_bit = self._bit_count == HEADER_BITS - 1
        return cdm if is_r_bit else self._answer_w_bit(cdm)

    def _take_address(self) -> None:
        """Read the register address from the header. Leave the control frame if it is not for this slave.

        It is not for this slave if it is a command (CTS = 0), has a different ID, or has a CRC error.
        """
        head = ControlHead.decode_with_crc(self._received_bits)
        if head is not None and head.is_register_access and head.slave_id == self.slave_id:
            self._register_address = head.address
        else:
            self._leave_frame()

    def _answer_w_bit(self, cdm: int) -> int:
        """Return the answer to W, the bit after R: the same bit, or the inverse to refuse the register.

        R W is 10 to read and 01 to write. After other bits and after a refusal, the slave leaves the control frame.
        """
        # W is bit 0, and R was received before it.
        r_bit = bit_at(self._received_bits, 1)
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
        """Return the answer to S, with which the master requests a register: 0 while the slave is busy, otherwise 1.

        The slave is busy until the program has fulfilled its request (``wants``). If the master sends 0 instead of S,
        leave the control frame and return the bit that arrives at SLI.
        """
        if not cdm:
            self._leave_frame()
            return upstream
        self._request_byte()
        if self.wants is not Wants.NOTHING:
            return 0
        self._phase = Phase.BYTE
        self._bit_count = self._received_bits = 0
        return 1

    def _follow_byte(self, cdm: int) -> int:
        """Process a CDM bit of a byte, its CRC or P, and return the CDS bit that answers it.

        In a read, this is a bit of the byte and its CRC. In a write, it is the received bit. The answer to P is 1 to
        refuse the next register.
        """
        self._received_bits = append_bit(self._received_bits, cdm)
        self._bit_count += 1
        if self._bit_count > BYTE_BITS:
            return self._answer_p_bit(cdm)
        if self._bits_to_send is not None:
            return bit_at(self._bits_to_send, BYTE_BITS - self._bit_count)
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
            self.value = decode_byte(self._received_bits)
        except CrcError:
            self._leave_frame()
            return
        self.wants = Wants.STORE
        self.address = self._register_address
