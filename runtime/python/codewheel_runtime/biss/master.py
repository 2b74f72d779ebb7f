# Licence 0BSD: you may use, change and distribute this file without any condition.
"""BiSS master for register access bit by bit, and the registers of a slave on a bus."""

from __future__ import annotations

from collections.abc import Callable

from ..codec import Data, as_bytes, whole_number
from ..errors import RangeError
from .control import BYTE_BITS, HEADER_BITS, REGISTERS, ZEROS, Outcome, Phase, append_bit, bit_at, encode_byte
from .requests import Request, count_slaves


class Master:
    """BiSS C master for register access.

    Start an access with :meth:`read` or :meth:`write`. Then call :meth:`next` once in every BiSS frame, between its
    CDS bit and its timeout, until ``outcome`` is no longer RUNNING. Keep calling it while frames are sent, because it
    counts the zeros that are required between two accesses. An access to one register takes at most 46 frames. Each
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
        self._phase = Phase.WAIT
        #: One request for each register of the access.
        self._register_requests: tuple[Request, ...] = ()
        #: Number of zeros that were sent since the last 1.
        self._zeros = 0
        #: Number of CDS bits in ``_answer_bits``.
        self._bit_count = 0
        #: Number of successive frames in which the slave was busy, and the allowed number.
        self._busy_count = 0
        self._busy_limit = 0
        #: CDM bits in this phase, with the first one highest: CTS to W, or a byte and its CRC.
        self._bits_to_send = 0
        #: CDS bits in this phase, with the last one in bit 0.
        self._answer_bits = 0

    def read(self, address: int, count: int = 1, *, slave_id: int = 0, busy_limit: int) -> None:
        """Start to read registers. An access in progress is aborted.

        Args:
            address: Address of the first register, 00h to 7Fh.
            count: Number of registers.
            slave_id: ID of the slave, 0 to 7.
            busy_limit: Maximum number of successive frames in which the slave may be busy. Choose the number of frames
                that takes 20 ms.

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
            busy_limit: Maximum number of successive frames in which the slave may be busy. Choose the number of frames
                that takes 20 ms.

        Raises:
            RangeError: The ID or the address is out of range, ``data`` is empty, or the registers extend beyond 3Fh or
                7Fh. An access in progress then continues.
        """
        self._begin_frame(slave_id, address, list(as_bytes(data)), busy_limit)

    def _begin_frame(self, slave_id: int, address: int, values: list[int | None], busy_limit: int) -> None:
        """Begin a control frame for an access, and forget the previous access except for the number of zeros sent.

        ``values`` contains the byte to write to each register, starting at ``address``, or None to read the register.
        Raises RangeError, before anything is changed, if the ID or the address is out of range, or if the registers
        extend beyond 3Fh or 7Fh.
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
        self._phase = Phase.WAIT
        self._register_requests = tuple(Request(slave_id, address + index, value) for index, value in enumerate(values))
        self._busy_limit = busy_limit
        # The highest 17 of 32 bits: CTS to W.
        self._bits_to_send = first_word >> 15

    def abort(self) -> None:
        """Abort the access by sending zeros. An aborted write can store a different value, as described above."""
        if self.outcome is Outcome.RUNNING:
            self.outcome = Outcome.ABORTED
        self._phase = Phase.WAIT

    def next(self, cds: int) -> int:
        """Advance by one BiSS frame.

        Args:
            cds: The CDS bit of this frame.

        Returns:
            The CDM bit of this frame. MA carries its inverse during the timeout.
        """
        # A pin may be read as a bool or as a NumPy byte, into which the collected bits would not fit.
        cds = int(cds & 1)
        if self._phase is Phase.HEADER:
            cdm = self._follow_header(cds)
        elif self._phase is Phase.START:
            cdm = self._follow_start(cds)
        elif self._phase is Phase.BYTE:
            cdm = self._follow_byte(cds)
        else:
            # Outside a control frame, the master sends zeros. After 14 of them, the start bit S = 1 begins an access.
            cdm = int(self.outcome is Outcome.RUNNING and self._zeros >= ZEROS)
            if cdm:
                self._phase = Phase.HEADER
        self._zeros = 0 if cdm else self._zeros + 1
        return cdm

    def _end_access(self, outcome: Outcome) -> int:
        """End the access with this outcome, and return the CDM bit 0, which ends the control frame."""
        self.outcome = outcome
        self._phase = Phase.WAIT
        return 0

    def _follow_header(self, cds: int) -> int:
        """Process the answer to the bit that was sent last, and return the next bit of the header.

        The master has sent the start bit S before. The header consists of CTS, ID, ADR, their CRC, R and W, and its
        first bit is the highest of ``_bits_to_send``. The slaves answer S and each bit of the header.
        """
        self._answer_bits = append_bit(self._answer_bits, cds)
        self._bit_count += 1
        # The first answer belongs to S.
        sent_header_bits = self._bit_count - 1
        if sent_header_bits < HEADER_BITS:
            return bit_at(self._bits_to_send, HEADER_BITS - 1 - sent_header_bits)
        return self._finish_header()

    def _finish_header(self) -> int:
        """Check all answers to the header, and return the next CDM bit: S, or 0 to end the control frame.

        The control frame ends if the answers do not accept the access.
        """
        # The last two answers are the echo of R and W. Those before are the IDL bits, which count the slaves.
        id_lock_bits = self._answer_bits >> 2
        self.slaves = count_slaves(id_lock_bits)
        # The header belongs to the first register.
        first_request = self._register_requests[0]
        outcome = first_request._check_echo(self._answer_bits)
        return self._request_register() if outcome is Outcome.RUNNING else self._end_access(outcome)

    def _request_register(self) -> int:
        """Return the CDM bit S = 1, which requests a register from the slave, and start waiting for the answer."""
        self._phase = Phase.START
        self._busy_count = 0
        return 1

    def _follow_start(self, cds: int) -> int:
        """Process an answer to S, and return the next CDM bit: S = 1 again while the slave is busy, then DATA7.

        An answer of 0 means that the slave is busy. After more than ``_busy_limit`` such answers, the access ends.
        DATA7 is the first bit of the byte, and 0 in a read.
        """
        if not cds:
            if self._busy_count >= self._busy_limit:
                return self._end_access(Outcome.BUSY)
            self._busy_count += 1
            return 1
        self._phase = Phase.BYTE
        self._bit_count = self._answer_bits = 0
        value = self._register_requests[self.done].value
        self._bits_to_send = 0 if value is None else encode_byte(value)
        return bit_at(self._bits_to_send, BYTE_BITS - 1)

    def _follow_byte(self, cds: int) -> int:
        """Process an answer to a byte, and return the next CDM bit: DATA6..0, their CRC, P, and S if one follows.

        In a read, DATA and CRC are zeros, and the answers to them form the byte. P is always 0.
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
        request = self._register_requests[self.done]
        outcome, value_read = request._check_data(self._answer_bits)
        if outcome is not Outcome.DONE:
            return self._end_access(outcome)
        if value_read is not None:
            self.data += bytes([value_read])
        self.done += 1
        is_last = self.done == len(self._register_requests)
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
        busy_limit: Maximum number of successive frames in which the slave may be busy. Choose the number of frames
            that takes 20 ms.
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
