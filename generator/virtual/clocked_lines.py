"""BiSS and SSI interfaces of a virtual encoder, clock by clock, and their levels as bytes for a socket.

Source of the protocol: "BiSS Interface, Protocol Description (BiSS C)", Rev C6, iC-Haus, pages 3 to 14.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Generator
from functools import cached_property

from ..model import Crc, Layout, channel_frame
from ..reference.bits_and_values import compute_bits
from .encoder import VirtualEncoder
from .simulation_options import BUSY_S, word_with_fault

#: Bytes that the master sends to wait for the timeout, and to set the clock low and high.
TIMEOUT, CLOCK = b"TC"


class ByLevels(ABC):
    """Line whose master sends bytes that control the clock: ``0`` and ``1`` set its level, and ``C`` sets 0 and then 1.

    ``T`` lets the timeout pass. The line answers each byte with the resulting level of the data line, ``0`` or ``1``.
    Other bytes are ignored.
    """

    def __init__(self) -> None:
        self._levels = bytearray()

    @abstractmethod
    def clock(self, level: int) -> int:
        """Set the level of the clock, and return the level of the data line."""

    @abstractmethod
    def timeout(self) -> int:
        """Let the timeout pass, and return the level of the data line."""

    def receive(self, data: bytes) -> None:
        """Receive bytes from the master, and store the level of the data line after each of them."""
        for byte in data:
            if byte in b"01":  # The lowest bit of the character is the level.
                self._levels.append(ord("0") + self.clock(byte & 1))
            elif byte == CLOCK:
                self.clock(0)
                self._levels.append(ord("0") + self.clock(1))
            elif byte == TIMEOUT:
                self._levels.append(ord("0") + self.timeout())

    def send(self) -> bytes:
        """Return the stored levels of the data line as bytes ``0`` and ``1``, and discard them."""
        data = bytes(self._levels)
        self._levels.clear()
        return data

    def due(self) -> float | None:
        """Return None, because every answer is available at once."""
        return None


#: Number of zeros after which a control frame can start, and number of zeros that abort one.
ZEROS = 14
#: CRC of control data: x^4 + x + 1, inverted.
_CONTROL_CRC = Crc(name="control", width=4, poly=0x3, init=0, refin=False, refout=False, xorout=0xF, source=())
#: Smallest and largest delay of the start bit in clocks, by fault.
_CLOCKS_LATE = {"late": (1, 8), "busy": (9, 40)}


class BissLine(ByLevels):
    """BiSS line with one encoder, which has the ID 0.

    Args:
        encoder: The encoder.
        acknowledge: Number of zeros before the start bit.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder, acknowledge: int = 3) -> None:
        if encoder.variant.interface != "biss":
            raise ValueError(f"{encoder.variant.code} has no BiSS")
        super().__init__()
        self.encoder = encoder
        self.acknowledge = acknowledge
        #: The answer to the control frame that the master sends, bit by bit.
        self._control_frame: Generator[int, int, int] | None = None
        self._cdm_zeros = 0
        self._ma = 1
        self._cdm = 0
        #: Rising edges of MA in this cycle, and its bits.
        self._rising_edges = 0
        self._cycle_bits: list[int] = []

    @property
    def bits(self) -> int:
        """Number of bits of the single cycle data, CRCs included."""
        return sum(self.encoder.place(layout).bits for layout in self._channel_layouts)

    @cached_property
    def _channel_layouts(self) -> tuple[Layout, ...]:
        """The layouts of the data channels of a frame, in the order in which they are sent. Most frames have one."""
        frame = channel_frame(self.encoder.device.interface("biss"))
        return frame.layouts if frame is not None else self.encoder.layouts(sender="encoder")[:1]

    def _compose_word(self) -> int:
        """Return the current single cycle data, which consist of the frames of all data channels, one after another."""
        word = 0
        for layout in self._channel_layouts:
            word = (word << self.encoder.place(layout).bits) | self.encoder.frame(layout)
        return word

    def frame(self) -> int:
        """Return the current single cycle data. The first bit sent is the most significant."""
        _, single_cycle_data = self.exchange(cdm=0)
        return single_cycle_data

    def exchange(self, cdm: int) -> tuple[int, int]:
        """Carry out one cycle.

        Args:
            cdm: CDM bit of the previous cycle.

        Returns:
            The CDS bit of this cycle, and its single cycle data.
        """
        cycle_bits = self.cycle(cdm)
        # The start bit is the first 1 after the acknowledge. It can be late. If the line stays low, there is none.
        has_start_bit = 1 in cycle_bits[self.acknowledge :]
        start_index = cycle_bits.index(1, self.acknowledge) if has_start_bit else self.acknowledge
        cds_index = start_index + 1
        first_data_index = cds_index + 1
        data_bits = cycle_bits[first_data_index : first_data_index + self.bits]
        single_cycle_data = int("".join(map(str, data_bits)), 2)
        return cycle_bits[cds_index], single_cycle_data

    def cycle(self, cdm: int) -> list[int]:
        """Return the bits of a cycle from the second rising edge of MA: acknowledge, start, CDS, data, stop.

        ``cdm`` is the CDM bit of the previous cycle. A fault is drawn at random, and may change the bits.
        """
        encoder = self.encoder
        faults = self.encoder.faults
        fault = faults.draw()
        cds = self._exchange_control_bit(cdm)
        word = self._compose_word()
        data_bits = [(word >> shift) & 1 for shift in reversed(range(self.bits))]
        fewest_late, most_late = _CLOCKS_LATE.get(fault, (0, 0))
        late_clocks = faults.random.randint(fewest_late, most_late)
        acknowledge_bits = [0] * (self.acknowledge + late_clocks)
        start_bit, stop_bit = 1, 0
        cycle_bits = [*acknowledge_bits, start_bit, cds, *data_bits, stop_bit]
        cycle_bits = self._bits_with_fault(fault, cycle_bits, data_bits)
        if fault in ("restart", "brownout"):
            encoder.restart()
            self._control_frame = None
        elif fault == "busy":
            encoder.be_busy(BUSY_S)
        return cycle_bits

    def _bits_with_fault(self, fault: str, cycle_bits: list[int], data_bits: list[int]) -> list[int]:
        """Return the bits of a cycle as the master reads them with a fault, or unchanged for other faults.

        ``data_bits`` are the bits of the single cycle data, which are a part of the cycle.
        """
        faults = self.encoder.faults
        if fault == "low":
            return [0] * len(cycle_bits)
        if fault in ("high", "lost", "restart") or self.encoder.is_off():
            return [1] * len(cycle_bits)
        if fault == "flip":
            # Any bit from the CDS bit to the last bit before the stop bit.
            inverted_index = faults.random.randrange(self.acknowledge + 1, len(cycle_bits) - 1)
            bits_with_flip = list(cycle_bits)
            bits_with_flip[inverted_index] ^= 1
            return bits_with_flip
        if fault in ("short", "brownout"):
            # At least one of the lost bits is 0, so that the frame differs.
            indices_of_zeros = [index for index, data_bit in enumerate(data_bits) if data_bit == 0]
            last_zero = indices_of_zeros[-1] if indices_of_zeros else 0
            # In the cycle, the start bit and CDS precede the data.
            last_zero_in_cycle = self.acknowledge + 2 + last_zero
            first_lost = faults.random.randint(self.acknowledge, last_zero_in_cycle)
            return cycle_bits[:first_lost] + [1] * (len(cycle_bits) - first_lost)
        return cycle_bits

    def clock(self, ma: int) -> int:
        """Set the level of the clock line MA, and return the resulting level of the data line SLO.

        The first rising edge after a timeout begins a cycle. SLO is 0 after the last bit.
        """
        is_rising_edge = ma and not self._ma
        if is_rising_edge:
            self._rising_edges += 1
            if self._rising_edges == 1:
                self._cycle_bits = self.cycle(self._cdm)
        self._ma = ma
        # The first bit of the cycle comes with the second rising edge.
        bit_index = self._rising_edges - 2
        is_idle = bit_index < 0
        if is_idle:
            return 1
        is_after_cycle = bit_index >= len(self._cycle_bits)
        return 0 if is_after_cycle else self._cycle_bits[bit_index]

    def timeout(self) -> int:
        """End the cycle with a timeout, and return 1, the idle level of SLO. The CDM bit is the inverse of MA."""
        self._cdm = 1 - self._ma
        self._rising_edges = 0
        return 1

    def _exchange_control_bit(self, cdm: int) -> int:
        """Receive the CDM bit of the previous cycle, and return the CDS bit of the current cycle.

        A control frame consists of one CDM bit and one CDS bit per cycle. 14 zeros abort it, and the first 1 after them
        begins the next one. CDS is 0 between control frames.
        """
        may_start = self._cdm_zeros >= ZEROS
        self._cdm_zeros = 0 if cdm else self._cdm_zeros + 1
        if self._cdm_zeros >= ZEROS:
            self._control_frame = None
        elif self._control_frame is not None:
            try:
                return self._control_frame.send(cdm)
            except StopIteration as end_of_frame:
                # The generator returns the last CDS bit of the control frame.
                self._control_frame = None
                return int(end_of_frame.value)
        elif cdm and may_start:
            self._control_frame = self._answer_control_frame()
            return next(self._control_frame)
        return 0

    def _delay_start_bit(self) -> Generator[int, int, int]:
        """Yield 0 in place of a start bit while the encoder is busy. Return the last CDM bit: 0 if the master ends."""
        cdm = 1
        while cdm and self.encoder.is_busy():
            cdm = yield 0
        return cdm

    def _answer_control_frame(self) -> Generator[int, int, int]:
        """Answer one control frame: yield CDS bits, receive the next CDM bit for each, and return the last CDS bit.

        The frame reads or writes registers. Its head contains the address, and is followed by a read bit and a write
        bit. Then bytes at consecutive addresses are transmitted as long as the master sends another start bit.
        """
        memory = self.encoder.memory
        read_bit, head = yield from _receive_head()
        # 4 bits for CTS and the slave ID, 7 bits of the address, 4 bits of the CRC over them.
        covered_by_crc, received_crc = head >> 4, head & 0xF
        cts_and_id, address = covered_by_crc >> 7, covered_by_crc & 0x7F
        is_for_this_encoder = cts_and_id == 0b1000  # CTS = 1 accesses registers, and this encoder has the ID 0.
        is_crc_correct = received_crc == compute_bits(_CONTROL_CRC, covered_by_crc, 11)
        if not is_for_this_encoder or not is_crc_correct:
            return 0
        write_bit = yield read_bit
        if read_bit == write_bit:  # neither a read nor a write
            return write_bit
        is_accessible = memory.writable if write_bit else memory.readable
        # The encoder rejects an access by sending the write bit inverted.
        if not is_accessible(address):
            return 1 - write_bit
        cdm = yield write_bit
        while cdm:
            cdm = yield from self._delay_start_bit()
            if not cdm:
                return 0
            if write_bit:
                cdm, is_valid = yield from self._write_byte(address)
                if not is_valid:
                    return cdm
            else:
                cdm = yield from self._read_byte(address)
            stop_bit = cdm  # 1 ends the access. 0 announces the start bit of another byte.
            is_last_of_bank = address & 0x3F == 0x3F  # A bank has 64 bytes.
            if stop_bit or is_last_of_bank or not is_accessible(address + 1):
                return 1
            address += 1
            cdm = yield 0
        return 0

    def _write_byte(self, address: int) -> Generator[int, int, tuple[int, bool]]:
        """Receive a byte and its CRC in CDM bits, and write the byte to a register if the CRC is correct.

        CDS echoes each CDM bit, one cycle later. Return the next CDM bit and True. After a wrong CRC, return the last
        bit of the CRC, which CDS must still echo, and False.
        """
        # After the start bit, the first bit of the byte.
        cdm = yield 1
        byte_and_crc = cdm
        # The other 7 bits of the byte, and 4 bits of its CRC.
        for _ in range(11):
            cdm = yield cdm
            byte_and_crc = (byte_and_crc << 1) | cdm
        byte, received_crc = byte_and_crc >> 4, byte_and_crc & 0xF
        if received_crc != compute_bits(_CONTROL_CRC, byte, 8):
            return cdm, False
        self.encoder.memory.write(address, byte)
        cdm = yield cdm
        return cdm, True

    def _read_byte(self, address: int) -> Generator[int, int, int]:
        """Send a start bit, the byte of a register, and its CRC as CDS bits. Return the next CDM bit."""
        byte = self.encoder.memory.read(address) or 0
        byte_and_crc = (byte << 4) | compute_bits(_CONTROL_CRC, byte, 8)
        cdm = yield 1
        for shift in reversed(range(12)):
            cdm = yield (byte_and_crc >> shift) & 1
        return cdm


def _receive_head() -> Generator[int, int, tuple[int, int]]:
    """Receive the head of a control frame, as a number of 15 bits: CTS (1), slave ID (3), address (7), and CRC (4).

    CDS answers the start bit with 1. Return the next CDM bit, which is the read bit, and the head.
    """
    cdm = yield 1
    head = 0
    for _ in range(15):
        head = (head << 1) | cdm
        cdm = yield 0
    return cdm, head


class SsiLine(ByLevels):
    """SSI line with one encoder.

    Args:
        encoder: The encoder.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder) -> None:
        if encoder.variant.interface != "ssi":
            raise ValueError(f"{encoder.variant.code} has no SSI")
        self.encoder = encoder
        super().__init__()
        #: The bits of the word that are still to be sent, and their number, which is -1 before the first clock.
        self._word, self._bits_left = 0, -1
        self._clock_level = self._data_level = 1

    @property
    def bits(self) -> int:
        """Number of bits of a word."""
        return self.encoder.place(self._frame_layout).bits

    @property
    def _frame_layout(self) -> Layout:
        return self.encoder.layouts(sender="encoder")[0]

    @property
    def _is_not_ready(self) -> bool:
        """True if the encoder holds the data line low because it is busy and has no flag to report this."""
        encoder = self.encoder
        return encoder.is_busy() and not encoder.is_off() and not encoder.reports_busy

    def word(self) -> int:
        """Return the current word, which a fault can change. The first bit sent is the most significant."""
        fault = self.encoder.faults.draw()
        if fault == "busy":
            self.encoder.be_busy(BUSY_S)
        word = 0 if self._is_not_ready else self.encoder.frame(self._frame_layout)
        return word_with_fault(self.encoder, fault, word, self.bits)

    def clock(self, level: int) -> int:
        """Set the level of the clock, and return the level of the data line. Zeros follow the word."""
        is_rising_edge = level and not self._clock_level
        if is_rising_edge:
            if self._bits_left < 0:
                self._word = self.word()
                self._bits_left = self.bits
            if self._bits_left > 0:
                self._bits_left -= 1
            self._data_level = (self._word >> self._bits_left) & 1
            # Remove the bit that is sent, so that zeros follow the last bit.
            mask_of_unsent_bits = (1 << self._bits_left) - 1
            self._word &= mask_of_unsent_bits
        self._clock_level = level
        return self._data_level

    def timeout(self) -> int:
        """End the word with a pause, and return the level of the data line: high, or low if the encoder is busy."""
        self._bits_left = -1
        self._data_level = int(not self._is_not_ready)
        return self._data_level
