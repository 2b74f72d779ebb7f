# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds BiSS register accesses in the CDS and CDM bits of a capture."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from ..biss.control import (
    BYTE_BITS,
    CRC_BITS,
    HEAD_AND_CRC_BITS,
    HEADER_BITS,
    ZEROS,
    ControlHead,
    Outcome,
    append_bit,
    decode_byte,
)
from ..biss.requests import Request
from ..errors import CrcError
from ..packages import load

np: Any = load("numpy")

_LOST_CYCLE = "a cycle of the access was lost"
_ENDED_WITHIN_ACCESS = "the capture ends within the access"


class ControlBits(NamedTuple):
    """Time, CDS bit and CDM bit of each BiSS cycle. A lost cycle has the CDS bit -1."""

    times: Any
    cds: Any
    cdm: Any


class Access(NamedTuple):
    """Access by the master to one register.

    Attributes:
        time: Time of the cycle in which the control frame begins, in seconds or in samples.
        slave_id: ID of the slave, 0 to 7.
        address: Address of the register.
        is_write: True for a write. False for a read, and for an access that ends before its kind is known.
        value: Byte that was read or written. None if it was not transmitted or has a CRC error.
        done: True if the access succeeded.
        result: Description of the result.
    """

    time: float
    slave_id: int
    address: int
    is_write: bool
    value: int | None
    done: bool
    result: str

    def __str__(self) -> str:
        text = "write" if self.is_write else "read"
        text += f" {self.address:02X}h"
        if self.slave_id:
            text += f" of slave {self.slave_id}"
        if self.value is not None:
            sign = "=" if self.is_write else "->"
            text += f" {sign} {self.value:#04x}"
        if not self.done:
            text += f": {self.result}"
        return text


class AccessFinder:
    """Finder of accesses. It follows the bits of successive cycles on both sides, master and slave.

    ``_follow_next_cycle`` is the method that follows the next cycle. ``_begin_time`` is the time at which the control
    frame began, and ``_is_write`` is True if it writes. ``_is_outside_frame`` is True outside a control frame.
    ``_zeros`` is the number of CDM zeros since the last 1. ``_sent_bits`` and ``_answer_bits`` are the CDM and CDS bits
    of the header or byte, the last one in bit 0, and ``_bit_count`` is the number of its cycles so far. ``_head_bits``
    contains CTS, ID and address.
    """

    def __init__(self) -> None:
        self._zeros = 0
        self._bit_count = 0
        self._sent_bits = 0
        self._answer_bits = 0
        self._follow_next_cycle = self._skip_cycle
        self._begin_time = 0.0
        self._head_bits = 0
        self._is_write, self._is_outside_frame = False, True

    def feed(self, bits: ControlBits) -> Iterator[Access]:
        """Yield the accesses that end in the cycles with these bits.

        Outside a control frame, all cycles up to the next CDM 1 are skipped in one step, because there are many of
        them.
        """
        times, cds, cdm = bits
        cycles_with_one = np.flatnonzero(cdm)
        cycle = 0
        cycle_count = len(cdm)
        while cycle < cycle_count:
            if not self._is_outside_frame:
                yield from self._follow_cycle(int(cds[cycle]), int(cdm[cycle]))
                cycle += 1
                continue
            index_in_cycles = np.searchsorted(cycles_with_one, cycle)
            if index_in_cycles == len(cycles_with_one):
                self._zeros += cycle_count - cycle
                return
            next_one = int(cycles_with_one[index_in_cycles])
            self._zeros += next_one - cycle
            # A 1 after enough zeros is the S bit of a control frame.
            if self._zeros >= ZEROS:
                self._begin_access(float(times[next_one]))
            self._zeros = 0
            cycle = next_one + 1

    def finish(self) -> Iterator[Access]:
        """Yield the access that is cut off by the end of the capture, if there is one."""
        if not self._is_outside_frame and self._has_unfinished_access():
            yield self._make_access(None, _ENDED_WITHIN_ACCESS)

    def _skip_cycle(self, cds: int, cdm: int) -> Iterator[Access]:
        """Ignore the bits of a cycle outside a control frame, and yield no access."""
        yield from ()

    def _begin_access(self, time: float) -> None:
        """Start following a control frame, whose S bit is at this time."""
        self._begin_time = time
        self._is_outside_frame = False
        self._bit_count = 0
        self._sent_bits = 0
        self._answer_bits = 0
        self._head_bits = 0
        # A header that ends before R and W counts as the header of a read.
        self._is_write = False
        self._follow_next_cycle = self._follow_header

    def _end_access(self) -> None:
        """Stop following the control frame."""
        self._is_outside_frame = True
        self._follow_next_cycle = self._skip_cycle

    def _follow_cycle(self, cds: int, cdm: int) -> Iterator[Access]:
        """Track the bits of one cycle within a control frame. Yield the access if it ends.

        A lost cycle (CDS -1) or 14 CDM zeros end the control frame. The access is then yielded if its address is
        known.
        """
        self._zeros = 0 if cdm else self._zeros + 1
        if cds < 0:
            if self._has_unfinished_access():
                yield self._make_access(None, _LOST_CYCLE)
            self._end_access()
        elif self._zeros >= ZEROS:
            if self._has_unfinished_access():
                yield self._make_access(None, Outcome.ABORTED.value)
            self._end_access()
        else:
            yield from self._follow_next_cycle(cds, cdm)

    def _has_unfinished_access(self) -> bool:
        """Return whether the address of an access has been transmitted, but its result is not known yet.

        After the last bit of a byte, the access has been yielded, and the access to the next register has not begun.
        """
        if self._follow_next_cycle == self._follow_byte:
            return self._bit_count < BYTE_BITS
        return self._follow_next_cycle != self._follow_header or self._bit_count >= HEAD_AND_CRC_BITS

    def _make_access(self, value: int | None, result: str, done: bool = False) -> Access:
        """Return the access to the transmitted ID and address, with this value and result."""
        head = ControlHead.decode(self._head_bits)
        return Access(
            time=self._begin_time,
            slave_id=head.slave_id,
            address=head.address,
            is_write=self._is_write,
            value=value,
            done=done,
            result=result,
        )

    def _follow_header(self, cds: int, cdm: int) -> Iterator[Access]:
        """Process one cycle of the header, or the cycle after it. Yield the access if the slave refuses it.

        The master sends the head (CTS, ID and address), its CRC, R and W, one bit per cycle. The slave answers each bit
        in the next cycle, so the answer to W comes in the cycle after the header.
        """
        self._bit_count += 1
        self._answer_bits = append_bit(self._answer_bits, cds)
        is_after_header = self._bit_count > HEADER_BITS
        if is_after_header:
            yield from self._finish_header(cdm)
            return
        self._sent_bits = append_bit(self._sent_bits, cdm)
        if self._bit_count == HEAD_AND_CRC_BITS:
            self._take_head()
        elif self._bit_count == HEADER_BITS:
            # The last two bits are R and W. Only one of them is 1: R for a read, W for a write.
            r_and_w = self._sent_bits & 0b11
            self._is_write = r_and_w == 0b01

    def _take_head(self) -> None:
        """Keep the head of the control frame, after its CRC has been sent.

        Commands have no registers, and a head with a CRC error reaches no slave. Stop following such control frames.
        """
        self._head_bits = self._sent_bits >> CRC_BITS
        head = ControlHead.decode_with_crc(self._sent_bits)
        if head is None or not head.is_register_access:
            self._end_access()

    def _finish_header(self, cdm: int) -> Iterator[Access]:
        """Check the answers to the header, which are now complete. Yield the access if the slave refuses it.

        The CDM bit of this cycle is 1 (S) if the master continues, or 0 if it ends the control frame without an access.
        """
        outcome = self._check_echo()
        is_refused = outcome is not Outcome.RUNNING
        if is_refused:
            yield self._make_access(None, outcome.value)
        if is_refused or not cdm:
            self._end_access()
        else:
            self._follow_next_cycle = self._follow_start

    def _check_echo(self) -> Outcome:
        """Return the outcome that the answers to the header show. It is RUNNING if the slave accepts the access."""
        head = ControlHead.decode(self._head_bits)
        # The value is not known yet. Any value turns the access into a write.
        value = 0 if self._is_write else None
        return Request(head.slave_id, head.address, value)._check_echo(self._answer_bits)

    def _follow_start(self, cds: int, cdm: int) -> Iterator[Access]:
        """Process a cycle in which the master sends S before a byte. The slave is busy until it answers with 1.

        If the master sends 0 instead, the access ends, and is yielded.
        """
        if cds:
            # This CDM bit is the first one of the byte.
            self._follow_next_cycle = self._follow_byte
            self._bit_count = 0
            self._sent_bits = cdm
            self._answer_bits = 0
        elif not cdm:
            yield self._make_access(None, Outcome.BUSY.value)
            self._end_access()

    def _follow_byte(self, cds: int, cdm: int) -> Iterator[Access]:
        """Process a cycle of a byte: eight bits, their CRC, and a bit P, after which S can start the next register.

        In a read, the slave sends the byte. In a write, the master sends it, and the slave repeats it. The access is
        yielded after the last bit of the CRC. The first CDM bit came in the cycle before, so the CDS bits of the byte
        are one cycle behind its CDM bits.
        """
        self._bit_count += 1
        is_after_p = self._bit_count > BYTE_BITS
        if is_after_p:
            self._finish_byte(cdm)
            return
        self._answer_bits = append_bit(self._answer_bits, cds)
        if self._bit_count < BYTE_BITS:
            self._sent_bits = append_bit(self._sent_bits, cdm)
            return
        # The byte and its CRC are complete. The CDM bit of this cycle is P.
        byte_and_crc = self._sent_bits if self._is_write else self._answer_bits
        value = _decode_value(byte_and_crc)
        outcome = self._judge_byte(value)
        is_done = outcome is Outcome.DONE
        yield self._make_access(value, outcome.value, done=is_done)
        # A P of 1 ends the control frame.
        if not is_done or cdm:
            self._end_access()

    def _finish_byte(self, cdm: int) -> None:
        """Process the CDM bit after P: 1 (S) to continue with the next register, or 0 to end the control frame."""
        if not cdm:
            self._end_access()
            return
        # The address is in the lowest bits of the head.
        self._head_bits += 1
        self._follow_next_cycle = self._follow_start

    def _judge_byte(self, value: int | None) -> Outcome:
        """Return the outcome of an access whose byte was transmitted. ``value`` is None if the byte has a CRC error.

        A write succeeds only if the slave has repeated the byte.
        """
        if not self._is_write:
            return Outcome.BAD_CRC if value is None else Outcome.DONE
        is_repeated = self._answer_bits == self._sent_bits
        return Outcome.DONE if is_repeated and value is not None else Outcome.BAD_ECHO


def _decode_value(bits: int) -> int | None:
    """Return the byte in 12 bits, which consist of the byte and its CRC. Return None if the CRC is wrong."""
    try:
        return decode_byte(bits)
    except CrcError:
        return None
