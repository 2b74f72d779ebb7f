"""RS-485 and SPI interfaces of a virtual encoder: requests of a master, and the replies to them."""

from __future__ import annotations

from bisect import insort
from collections.abc import Mapping
from operator import itemgetter
from typing import NamedTuple

from ..model import (
    DataId,
    Exchange,
    Flag,
    Layout,
    Procedure,
    Rs485,
    SendStep,
    Spi,
    WaitStep,
    member_named,
    number_to_bytes,
)
from ..reference import codec
from .encoder import VirtualEncoder
from .faults import BUSY_S, word_with_fault

#: Seconds after which the rest of an incomplete request is discarded.
GAP_S = 0.005
#: Durations in seconds: a line fault, and an EEPROM access for one byte.
OUTAGE_S = 0.02
EEPROM_S = 0.003
#: Number of replies that are kept for a master that does not read them.
_MOST_REPLIES = 1000
#: Seconds: tolerance of the interval between the requests of a reset, and shortest and longest delay of a late reply.
_TOLERANCE_S, _LATE_BY_S = 1e-9, (0.005, 0.04)


class _RequestFormat(NamedTuple):
    """The layout of a request, its data ID if the encoder has data IDs, and the layout of the reply if there is one."""

    layout: Layout
    data_id: DataId | None
    reply: Layout | None


class _ReceivedRequest(NamedTuple):
    """A request, or bytes to discard if there are no ``values``: the length in bytes, the data ID and the reply."""

    length: int
    values: dict[str, int | str | bool] | None
    data_id: DataId | None
    reply: Layout | None


class Rs485Line:
    """RS-485 line with one encoder.

    Args:
        encoder: The encoder.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder) -> None:
        interface = encoder.device.interface(encoder.variant.interface)
        if not isinstance(interface, Rs485):
            raise ValueError(f"{encoder.variant.code} has the interface {interface.short}, not RS-485")
        self.encoder, self.interface = encoder, interface
        self._data_id_by_control = {data_id.control: data_id for data_id in interface.data_ids}
        #: Bytes of a request that is not complete, and the time at which the last of them came.
        self._received = b""
        self._received_at = 0.0
        #: The fault "low" or "high" of the line, and its end.
        self._outage = ""
        self._outage_until = 0.0
        #: Replies with the times at which they arrive, in order, and the time of the last reply without extra replies.
        self._arrivals: list[tuple[float, bytes]] = []
        self._last_due = 0.0
        #: The control byte of the reset requests that came last, their number, and the time of the last one.
        self._reset_requests: tuple[int, int, float] = (-1, 0, 0.0)
        self._eeprom: dict[int, int] = {}
        self._memory_busy_until = 0.0

    def receive(self, data: bytes) -> None:
        """Take bytes that the master sends now, and answer each complete and valid request in them."""
        now = self.encoder.clock()
        if now - self._received_at > GAP_S:  # After a pause, the rest of a request does not come.
            self._received = b""
        self._received_at = now
        self._received += data
        while self._received:
            request = self._first_request()
            if request is None:
                return
            request_bytes = self._received[: request.length]
            self._received = self._received[request.length :]
            if request.values is not None and not self.encoder.is_off():
                self._answer_request(request.data_id, request_bytes, request.values, request.reply)

    def _first_request(self) -> _ReceivedRequest | None:
        """Return the request at the start of the received bytes, or None if it is not complete.

        If no request begins there, return one byte to discard, with None for its values.
        """
        request_formats = self._formats_by_data_id() if self._data_id_by_control else self._formats_of_exchanges()
        longest = 0
        for request_format in request_formats:
            placed_layout = self.encoder.place(request_format.layout)
            length = placed_layout.bits // 8
            longest = max(longest, length)  # Among the requests that can begin here.
            if len(self._received) < length:
                continue
            decoded = codec.decode_placed(self.encoder.device, placed_layout, self._received[:length])
            values = None if decoded.problems else decoded.values
            # The data ID alone identifies the request. If the rest is wrong, all of it is discarded.
            has_data_id = request_format.data_id is not None
            if has_data_id or (values is not None and self._is_for_this_encoder(request_format.layout, values)):
                return _ReceivedRequest(length, values, request_format.data_id, request_format.reply)
        if len(self._received) < longest:
            return None
        # No request begins with the first byte, so it is discarded.
        return _ReceivedRequest(length=1, values=None, data_id=None, reply=None)

    def _formats_by_data_id(self) -> list[_RequestFormat]:
        """Return the format of the request whose control byte was received first, or an empty list if there is none.

        A layout that depends on a question without an answer cannot be decoded.
        """
        data_id = self._data_id_by_control.get(self._received[0])
        layout = self._layout_with(data_id, sender="master") if data_id is not None else None
        if data_id is None or layout is None or self.encoder.needs_answer(layout):
            return []
        return [_RequestFormat(layout, data_id, reply=self._layout_with(data_id, sender="encoder"))]

    def _formats_of_exchanges(self) -> list[_RequestFormat]:
        """Return the formats of all requests of an interface without data IDs."""
        layout_by_name = {layout.name: layout for layout in self.interface.layouts}
        formats: list[_RequestFormat] = []
        for exchange in self.interface.exchanges:
            reply = layout_by_name.get(exchange.reply)
            formats.append(_RequestFormat(layout_by_name[exchange.request], data_id=None, reply=reply))
        return formats

    @staticmethod
    def _is_for_this_encoder(layout: Layout, values: Mapping[str, int | str | bool]) -> bool:
        """Return whether a request has this encoder's values, such as its address.

        Its values are the factory defaults in the layout. A field without a default can have any value.
        """
        return all(field.default in (None, values.get(field.name)) for field in layout.fields)

    def due(self) -> float | None:
        """Return the time in seconds at which the next bytes arrive at the master, or None if there are none."""
        if not self._arrivals:
            return None
        due, _ = self._arrivals[0]
        return due

    def send(self) -> bytes:
        """Return the bytes that have reached the master, each once."""
        now = self.encoder.clock()
        arrived_replies = [reply for due, reply in self._arrivals if due <= now]
        del self._arrivals[: len(arrived_replies)]
        return b"".join(arrived_replies)

    def _layout_with(self, data_id: DataId, sender: str) -> Layout | None:
        """Return the first frame of the sender that has this data ID or no selector, or None if there is none."""
        for layout in self.encoder.layouts(sender):
            if not layout.selector or data_id.id in layout.selects:
                return layout
        return None

    def _answer_request(
        self, data_id: DataId | None, request: bytes, values: dict[str, int | str | bool], layout: Layout | None
    ) -> None:
        """Carry out a request, and schedule its reply with this layout, which a fault can damage, delay or suppress."""
        encoder = self.encoder
        faults = self.encoder.faults
        now = encoder.clock()
        fault = faults.draw()
        if fault == "busy":
            encoder.be_busy(BUSY_S)
            self._memory_busy_until = max(self._memory_busy_until, now + BUSY_S)
        if fault in ("low", "high"):
            self._outage, self._outage_until = fault, now + OUTAGE_S
        reply, other_reply = self._compute_replies(data_id, values, layout, is_second=fault == "second")
        if fault == "restart":
            encoder.restart()
            return
        is_silent = encoder.is_busy() and not encoder.reports_busy
        if reply and not is_silent:
            reply_bytes = faults.damaged(fault, reply, request)
            if now < self._outage_until:
                # A line that stays high is idle, so no bytes arrive.
                zeros = bytes(len(reply))
                reply_bytes = zeros if self._outage == "low" else b""
            delay = faults.random.uniform(*_LATE_BY_S) if fault == "late" else 0.0
            # The line keeps the order of replies, but extra replies can come before or after the next reply.
            self._last_due = max(now + delay, self._last_due)
            self._put_bytes(self._last_due, reply_bytes)
            if fault in ("repeated", "second"):
                self._put_bytes(self._last_due + faults.gap_s(), reply if fault == "repeated" else other_reply)
        if fault == "brownout":
            encoder.restart()

    def _put_bytes(self, due: float, data: bytes) -> None:
        """Add bytes that reach the master at the given time. If the master does not read, the first are lost."""
        insort(self._arrivals, (due, data), key=itemgetter(0))  # by time
        del self._arrivals[:-_MOST_REPLIES]

    def _compute_replies(
        self, data_id: DataId | None, values: dict[str, int | str | bool], layout: Layout | None, *, is_second: bool
    ) -> tuple[bytes, bytes]:
        """Carry out a request. Return the reply of the encoder, and the reply of a second encoder.

        They are the same unless ``is_second`` is true. If the reply has no frame, or one that depends on an open
        question, both are empty, and nothing is carried out.
        """
        if layout is None or self.encoder.needs_answer(layout):
            return b"", b""
        request_values = {name: value for name, value in values.items() if name != codec.UNUSED}
        if data_id is not None and data_id.purpose in ("read", "write"):
            memory = self._access_memory(data_id, layout, request_values)
            if memory is None:
                return b"", b""
            request_values |= memory
        reply_number, bits = self.encoder.frame(layout, request_values), self.encoder.place(layout).bits
        other_number = self.encoder.frame_of_another(layout, request_values) if is_second else reply_number
        if data_id is not None:
            self._count_reset_request(data_id)
        return number_to_bytes(layout, reply_number, bits), number_to_bytes(layout, other_number, bits)

    def _access_memory(
        self, data_id: DataId, layout: Layout, request_values: dict[str, int | str | bool]
    ) -> dict[str, int | bool] | None:
        """Carry out an access to an EEPROM that is not busy. Return the values for the reply: the busy flag and data.

        Return None if the EEPROM is busy and the reply has no flag to report it.
        """
        now = self.encoder.clock()
        sent_fields = [placed_field.field for placed_field in self.encoder.place(layout).fields]
        flags = [field.name for field in sent_fields if isinstance(field.kind, Flag)]
        busy_flags = flags[:1]  # The first flag of such a reply, if any, reports a busy EEPROM.
        if now < self._memory_busy_until:
            return {**dict.fromkeys(busy_flags, True), "data": 0} if busy_flags else None
        address = int(request_values["address"])
        if data_id.purpose == "write":
            self._eeprom[address] = int(request_values["data"])
            self._memory_busy_until = now + EEPROM_S
        return {**dict.fromkeys(busy_flags, False), "data": self._eeprom.get(address, 0xFF)}

    def _count_reset_request(self, data_id: DataId) -> None:
        """Count the requests of a reset, and carry it out after the last one.

        Any request that is not one of a reset starts the count again.
        """
        for procedure in self.encoder.device.procedures:
            for step in procedure.steps:
                if isinstance(step, SendStep) and step.request == bytes([data_id.control]):
                    is_complete = self._is_last_request(data_id.control, step)  # It also counts the request.
                    if is_complete:
                        self._carry_out_reset(data_id, procedure)
                    return
        self._reset_requests = (-1, 0, 0.0)

    def _is_last_request(self, control: int, step: SendStep) -> bool:
        """Count a request of a reset, and return whether it is the last one.

        A request that comes too soon starts the count again.
        """
        now = self.encoder.clock()
        last_control, previous_count, last_time = self._reset_requests
        is_too_soon = now - last_time < step.microseconds / 1e6 - _TOLERANCE_S
        request_count = 1 if last_control != control or is_too_soon else previous_count + 1
        self._reset_requests = (control, request_count % step.times, now)  # After the last one, the count is 0 again.
        return request_count >= step.times

    def _carry_out_reset(self, data_id: DataId, procedure: Procedure) -> None:
        """Reset the encoder, which is then busy for the longest wait of the procedure if it reports that."""
        self.encoder.reset(data_id.name)
        waits_us = [step.microseconds for step in procedure.steps if isinstance(step, WaitStep)]
        if self.encoder.reports_busy:
            self.encoder.be_busy(max(waits_us, default=0) / 1e6)


class SpiLine:
    """SPI with one encoder. As bytes, each word consists of the bytes that hold its bits, most significant first.

    Bytes have no chip select. If words have several lengths, the request shows where a word ends. If two requests begin
    alike, the longer request counts if all its bytes have been received.

    Args:
        encoder: The encoder.

    Raises:
        ValueError: The encoder has a different interface.
    """

    def __init__(self, encoder: VirtualEncoder) -> None:
        interface = encoder.device.interface(encoder.variant.interface)
        if not isinstance(interface, Spi):
            raise ValueError(f"{encoder.variant.code} has no SPI")
        self.encoder, self.interface = encoder, interface
        parameters = encoder.variant.parameters
        self._lengths = sorted({length.value(parameters) for length in interface.lengths}, reverse=True)
        default_length = interface.word_bits.value(parameters)
        #: Bits of a word whose request is not known. Each exchange may have a length of its own.
        self.word_bits = default_length if default_length in self._lengths else self._lengths[-1]
        self._write_exchanges = [exchange for exchange in interface.exchanges if exchange.purpose == "write"]
        #: Address and data of a write whose words have not all come.
        self._written_fields: dict[str, int] = {}
        #: The word that the next one is answered with, and its length, if replies come one word later.
        self._next_reply = 0, self.word_bits
        self._received, self._answers = b"", b""

    def exchange(self, word: int, bits: int | None = None) -> int:
        """Receive a word, and return the word that the encoder sends meanwhile. A fault can change it.

        Args:
            word: The word, whose first bit is the most significant.
            bits: Bits of the word. Default: ``word_bits`` of the interface, or the shortest length if no word has it.

        Raises:
            ValueError: The encoder has no words of this length, or the word does not fit.
        """
        length = self.word_bits if bits is None else bits
        if length not in self._lengths or word >> length:
            lengths_text = " or ".join(map(str, sorted(self._lengths)))
            raise ValueError(
                f"0x{word:X} is not a word of {length} bits; {self.encoder.variant.code} has {lengths_text} bits"
            )
        answer = self._answer_word(word, length)
        if self.interface.exchanges and self.interface.reply == "next_word":
            previous_answer, previous_length = self._next_reply
            self._next_reply = answer, length
            # A longer word ends with zeros, and a shorter word contains only the beginning of the reply.
            if length > previous_length:
                answer = previous_answer << (length - previous_length)
            else:
                answer = previous_answer >> (previous_length - length)
        return word_with_fault(self.encoder, self.encoder.faults.draw(), answer, length)

    def receive(self, data: bytes) -> None:
        """Take bytes that the master sends. Send a word in one piece if words have several lengths."""
        self._received += data
        while (word_bits := self._length_of_first_word()) is not None:
            byte_count = (word_bits + 7) // 8
            word = _first_word(self._received, word_bits)
            self._received = self._received[byte_count:]
            self._answers += self.exchange(word, word_bits).to_bytes(byte_count, "big")

    def send(self) -> bytes:
        """Return each answer once."""
        answers, self._answers = self._answers, b""
        return answers

    def due(self) -> float | None:
        """Return None, because the answers never wait."""
        return None

    def _length_of_first_word(self) -> int | None:
        """Return the number of bits of the first word in the received bytes, or None if it is incomplete.

        It is the longest length with which the received bytes are a valid request, or else ``word_bits``.
        """
        if len(self._lengths) > 1:
            for length in self._lengths:
                is_complete = 8 * len(self._received) >= length
                if is_complete and self._find_request(_first_word(self._received, length), length) is not None:
                    return length
        is_complete = 8 * len(self._received) >= self.word_bits
        return self.word_bits if is_complete else None

    def _answer_word(self, word: int, length: int) -> int:
        """Carry out the request in a word of this length, and return the reply."""
        if not self.interface.exchanges:
            return self.encoder.frame(self.encoder.layouts("encoder")[0])
        request = self._find_request(word, length)
        if request is None:
            self._written_fields = {}
            return self._error_reply(length)
        exchange, values = request
        layout = self._find_layout(exchange.reply)
        # A reply can repeat fields of its request.
        repeated_values = {field.name: values[field.name] for field in layout.data_fields if field.name in values}
        if exchange.purpose not in ("read", "write"):
            return self.encoder.frame(layout, repeated_values)
        request_fields: dict[str, int] = {name: int(values[name]) for name in ("address", "data") if name in values}
        if exchange.purpose == "write":
            self._written_fields |= request_fields
            register_value = self._complete_write()
        else:
            register_value = self.encoder.memory.read_whole(request_fields.get("address", -1))  # No register has -1.
        if register_value is None:
            return self._error_reply(length)
        return self.encoder.frame(layout, {**repeated_values, "data": register_value})

    def _complete_write(self) -> int | None:
        """Carry out a write if both its address and its data have come, and return the value of the register.

        Before the data come, the value is the old one. Return None if it cannot be read, or with the data, written.
        """
        address = self._written_fields.get("address", -1)  # No register has the address -1.
        if self._written_fields.keys() >= {"address", "data"}:
            data = self._written_fields["data"]
            self._written_fields = {}
            if not self.encoder.memory.write_whole(address, data):
                return None
        return self.encoder.memory.read_whole(address)

    def _find_request(self, word: int, length: int) -> tuple[Exchange, dict[str, int | str | bool]] | None:
        """Return the request in a word with its values, or None if no possible request fits.

        A write can have several words. Once it has begun, only its later words are possible. Before, all others are.
        """
        later_words_of_write = self._write_exchanges[1:]
        if self._written_fields:
            possible_exchanges = later_words_of_write
        else:
            exchanges = self.interface.exchanges
            possible_exchanges = [exchange for exchange in exchanges if exchange not in later_words_of_write]
        for exchange in possible_exchanges:
            placed_layout = self.encoder.place(self._find_layout(exchange.request))
            decoded = codec.decode_bits(self.encoder.device, placed_layout, word, length)
            if not decoded.problems:
                return exchange, decoded.values
        return None

    def _error_reply(self, length: int) -> int:
        """Return the reply to an invalid request of this length: the last exchange's reply, with all flags active."""
        parameters = self.encoder.variant.parameters
        exchanges_of_length: list[Exchange] = []
        for exchange in self.interface.exchanges:
            if self.interface.bits_of(exchange).value(parameters) == length:
                exchanges_of_length.append(exchange)
        layout = self._find_layout(exchanges_of_length[-1].reply)
        active_flags = {field.name: True for field in layout.fields if isinstance(field.kind, Flag)}
        return self.encoder.frame(layout, active_flags)

    def _find_layout(self, name: str) -> Layout:
        return member_named(self.interface.layouts, name, "layout over SPI")


def _first_word(data: bytes, bits: int) -> int:
    """Return the first word in the data. If it is not whole bytes, the top bits of its first byte are unused."""
    byte_count, mask = (bits + 7) // 8, (1 << bits) - 1
    return int.from_bytes(data[:byte_count], "big") & mask
