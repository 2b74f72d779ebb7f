"""RS-485 and SPI interfaces of a virtual encoder: requests of a master, and the replies to them."""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ..model import DataId, Exchange, Flag, Layout, Rs485, SendStep, Spi, WaitStep, member_named, number_to_bytes
from ..reference import codec
from .encoder import VirtualEncoder
from .faults import BUSY_S, disturbed

#: Seconds after which the rest of an incomplete request is discarded.
GAP_S = 0.005
#: Durations in seconds: a line fault, and an EEPROM access for one byte.
OUTAGE_S = 0.02
EEPROM_S = 0.003
#: Number of replies that are kept for a master that does not read them.
_MOST_REPLIES = 1000
#: Tolerance in seconds of the interval between the requests of a reset.
_EARLY_S = 1e-9


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
        self._requests = {data_id.control: data_id for data_id in interface.data_ids}
        self._received = b""
        self._since = self._outage_until = 0.0
        self._outage = ""
        #: Replies with the times at which they arrive, in order, and that of the last one without extra replies.
        self._out: list[tuple[float, bytes]] = []
        self._last_due = 0.0
        self._resets: tuple[int, int, float] = (-1, 0, 0.0)
        self._eeprom: dict[int, int] = {}
        self._memory_busy_until = 0.0

    def receive(self, data: bytes) -> None:
        """Take bytes that the master sends now."""
        now = self.encoder.clock()
        if now - self._since > GAP_S:
            self._received = b""
        self._since = now
        self._received += data
        while self._received:
            request = self._request()
            if request is None:
                return
            length, values, data_id, reply = request
            request_bytes, self._received = self._received[:length], self._received[length:]
            if values is not None and not self.encoder.is_off():
                self._answer(data_id, request_bytes, values, reply)

    def _request(self) -> _ReceivedRequest | None:
        """Return the request at the start of the received bytes, or None if it is not complete."""
        candidates = [self._of_data_id()] if self._requests else list(self._of_exchanges())
        for layout, data_id, reply in filter(None, candidates):
            placed = self.encoder.place(layout)
            length = placed.bits // 8
            if len(self._received) < length:
                continue
            decoded = codec.decode_placed(self.encoder.device, placed, self._received[:length])
            values = None if decoded.problems else decoded.values
            if data_id is not None or (values is not None and self._is_for_me(layout, values)):
                return _ReceivedRequest(length, values, data_id, reply)
        longest = max(
            (self.encoder.place(candidate[0]).bits // 8 for candidate in candidates if candidate is not None), default=0
        )
        return None if len(self._received) < longest else _ReceivedRequest(1, None, None, None)

    def _of_data_id(self) -> tuple[Layout, DataId | None, Layout | None] | None:
        data_id = self._requests.get(self._received[0])
        layout = self._layout("master", data_id) if data_id is not None else None
        if data_id is None or layout is None or self.encoder.needs_answer(layout):
            return None
        return layout, data_id, self._layout("encoder", data_id)

    def _of_exchanges(self) -> Iterator[tuple[Layout, DataId | None, Layout | None]]:
        layouts = {layout.name: layout for layout in self.interface.layouts}
        for exchange in self.interface.exchanges:
            yield layouts[exchange.request], None, layouts.get(exchange.reply)

    @staticmethod
    def _is_for_me(layout: Layout, values: Mapping[str, int | str | bool]) -> bool:
        """Return whether a request has the values of this encoder, such as its address: the factory defaults."""
        return all(field.default in (None, values.get(field.name)) for field in layout.fields)

    def due(self) -> float | None:
        """Return the time in seconds at which the next bytes arrive at the master, or None if there are none."""
        return self._out[0][0] if self._out else None

    def send(self) -> bytes:
        """Return the bytes that have reached the master, each once."""
        now, data = self.encoder.clock(), b""
        while self._out and self._out[0][0] <= now:
            data += self._out.pop(0)[1]
        return data

    def _layout(self, sender: str, data_id: DataId) -> Layout | None:
        layouts = self.encoder.layouts(sender)
        return next((layout for layout in layouts if not layout.selector or data_id.id in layout.selects), None)

    def _answer(
        self, data_id: DataId | None, request: bytes, values: dict[str, int | str | bool], layout: Layout | None
    ) -> None:
        encoder, faults = self.encoder, self.encoder.faults
        now = encoder.clock()
        fault = faults.draw()
        if fault == "busy":
            encoder.be_busy(BUSY_S)
            self._memory_busy_until = max(self._memory_busy_until, now + BUSY_S)
        if fault in ("low", "high"):
            self._outage, self._outage_until = fault, now + OUTAGE_S
        reply, other_reply = self._replies(data_id, values, layout, is_second=fault == "second")
        if fault == "restart":
            encoder.restart()
            return
        silent = encoder.is_busy() and not encoder.reports_busy
        if reply and not silent:
            data = faults.damaged(fault, reply, request)
            if now < self._outage_until:
                data = bytes(len(reply)) if self._outage == "low" else b""
            delay = faults.random.uniform(0.005, 0.04) if fault == "late" else 0.0
            # The line keeps the order of replies, but extra ones can come before or after the next reply.
            self._last_due = max(now + delay, self._last_due)
            self._put(self._last_due, data)
            if fault in ("repeated", "second"):
                self._put(self._last_due + faults.gap_s(), reply if fault == "repeated" else other_reply)
        if fault == "brownout":
            encoder.restart()

    def _put(self, due: float, data: bytes) -> None:
        """Add bytes that arrive at the master at a time. If it does not read, the first ones are lost."""
        insort(self._out, (due, data), key=lambda arrival: arrival[0])
        del self._out[:-_MOST_REPLIES]

    def _replies(
        self,
        data_id: DataId | None,
        values: dict[str, int | str | bool],
        layout: Layout | None,
        *,
        is_second: bool,
    ) -> tuple[bytes, bytes]:
        """Carry out a request. Return the reply, or nothing, and that of a second encoder if there is one."""
        if layout is None or self.encoder.needs_answer(layout):
            return b"", b""
        request_values = {name: value for name, value in values.items() if name != codec.UNUSED}
        if data_id is not None and data_id.purpose in ("read", "write"):
            memory = self._memory(data_id, layout, request_values)
            if memory is None:
                return b"", b""
            request_values |= memory
        number, bits = self.encoder.frame(layout, request_values), self.encoder.place(layout).bits
        other = self.encoder.frame_of_another(layout, request_values) if is_second else number
        if data_id is not None:
            self._count(data_id)
        return number_to_bytes(layout, number, bits), number_to_bytes(layout, other, bits)

    def _memory(
        self, data_id: DataId, layout: Layout, request_values: dict[str, int | str | bool]
    ) -> dict[str, int | bool] | None:
        """Carry out an access to the EEPROM, and return the values for the reply: the busy flag, if any, and the data.

        Return None if the EEPROM is busy and the reply cannot report it.
        """
        now = self.encoder.clock()
        sent_fields = [placed_field.field for placed_field in self.encoder.place(layout).fields]
        flags = [field.name for field in sent_fields if isinstance(field.kind, Flag)][:1]
        if now < self._memory_busy_until:
            return {**dict.fromkeys(flags, True), "data": 0} if flags else None
        address = int(request_values["address"])
        if data_id.purpose == "write":
            self._eeprom[address] = int(request_values["data"])
            self._memory_busy_until = now + EEPROM_S
        return {**dict.fromkeys(flags, False), "data": self._eeprom.get(address, 0xFF)}

    def _count(self, data_id: DataId) -> None:
        """Count the requests of a reset, and carry it out after the last one."""
        now = self.encoder.clock()
        for procedure in self.encoder.device.procedures:
            for step in procedure.steps:
                if isinstance(step, SendStep) and step.request == bytes([data_id.control]):
                    control, count, last = self._resets
                    is_too_soon = now - last < step.microseconds / 1e6 - _EARLY_S
                    count = 1 if control != data_id.control or is_too_soon else count + 1
                    self._resets = (data_id.control, count % step.times, now)
                    if count >= step.times:
                        self.encoder.reset(data_id.name)
                        wait_steps = [step for step in procedure.steps if isinstance(step, WaitStep)]
                        waits = [wait_step.microseconds for wait_step in wait_steps]
                        if self.encoder.reports_busy:
                            self.encoder.be_busy(max(waits, default=0) / 1e6)
                    return
        self._resets = (-1, 0, 0.0)


class SpiLine:
    """SPI with one encoder. As bytes, each word has the bytes that hold its bits, most significant first.

    Bytes have no chip select. If words have several lengths, the request shows where a word ends. Of two requests that
    begin alike, the longer one counts if all its bytes have been received.

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
        self._writes = [exchange for exchange in interface.exchanges if exchange.purpose == "write"]
        self._written: dict[str, int] = {}
        self._next = 0, self.word_bits
        self._received, self._answers = b"", b""

    def exchange(self, word: int, bits: int | None = None) -> int:
        """Receive a word, and return the word that the encoder sends meanwhile. A fault can change it.

        Args:
            word: The word, whose first bit is the most significant.
            bits: Number of bits of the word. Default: ``word_bits`` of the interface, or the shortest length if no
                word has that one.

        Raises:
            ValueError: The encoder has no words of this length, or the word does not fit.
        """
        length = self.word_bits if bits is None else bits
        if length not in self._lengths or word >> length:
            lengths_text = " or ".join(map(str, sorted(self._lengths)))
            raise ValueError(
                f"0x{word:X} is not a word of {length} bits; {self.encoder.variant.code} has {lengths_text} bits"
            )
        answer = self._answer(word, length)
        if self.interface.exchanges and self.interface.reply == "next_word":
            (previous_answer, previous_length), self._next = self._next, (answer, length)
            # A longer word ends with zeros, and a shorter one has only the beginning of the reply.
            answer = (
                previous_answer << length - previous_length
                if length > previous_length
                else previous_answer >> previous_length - length
            )
        return disturbed(self.encoder, self.encoder.faults.draw(), answer, length)

    def receive(self, data: bytes) -> None:
        """Take bytes that the master sends. Send a word in one piece if words have several lengths."""
        self._received += data
        while (bits := self._arrived_bits()) is not None:
            size = (bits + 7) // 8
            word, self._received = self._received[:size], self._received[size:]
            number = int.from_bytes(word, "big") & (1 << bits) - 1
            self._answers += self.exchange(number, bits).to_bytes(size, "big")

    def send(self) -> bytes:
        """Return each answer once."""
        data, self._answers = self._answers, b""
        return data

    def due(self) -> float | None:
        """Return None, because the answers never wait."""
        return None

    def _arrived_bits(self) -> int | None:
        """Return the length of the first word in the received bytes, or None if it is incomplete."""
        for bits in self._lengths if len(self._lengths) > 1 else ():
            word = self._received[: (bits + 7) // 8]
            if 8 * len(word) >= bits and self._known_request(int.from_bytes(word, "big"), bits) is not None:
                return bits
        return self.word_bits if 8 * len(self._received) >= self.word_bits else None

    def _answer(self, word: int, bits: int) -> int:
        if not self.interface.exchanges:
            return self.encoder.frame(self.encoder.layouts("encoder")[0])
        request = self._request(word, bits)
        if request is None:
            return self._error(bits)
        exchange, values = request
        layout = self._layout(exchange.reply)
        access: dict[str, int] = {name: int(values[name]) for name in ("address", "data") if name in values}
        # A reply can repeat fields of its request.
        echo = {field.name: values[field.name] for field in layout.data_fields if field.name in values}
        if exchange.purpose not in ("read", "write"):
            return self.encoder.frame(layout, echo)
        if exchange.purpose == "write":
            self._written |= access
        data = self._access(exchange.purpose, access)
        return self._error(bits) if data is None else self.encoder.frame(layout, {**echo, "data": data})

    def _access(self, purpose: str, access: dict[str, int]) -> int | None:
        """Carry out an access, and return the value of the register afterwards, or None if there is no access."""
        memory, address = self.encoder.memory, (access if purpose == "read" else self._written).get("address", -1)
        if purpose == "write" and self._written.keys() >= {"address", "data"}:
            data = self._written["data"]
            self._written = {}
            if not memory.write_whole(address, data):
                return None
        return memory.read_whole(address)

    def _request(self, word: int, bits: int) -> tuple[Exchange, dict[str, int | str | bool]] | None:
        """Return the request in a word with its values, and forget a write that it does not continue."""
        request = self._known_request(word, bits)
        if request is None:
            self._written = {}
        return request

    def _known_request(self, word: int, bits: int) -> tuple[Exchange, dict[str, int | str | bool]] | None:
        """Return the request in a word with its values. The second word of a write follows the first."""
        started = bool(self._written)
        for exchange in self._writes[1:] if started else self.interface.exchanges:
            if not started and exchange in self._writes[1:]:
                continue
            placed = self.encoder.place(self._layout(exchange.request))
            decoded = codec.decode_bits(self.encoder.device, placed, word, bits)
            if not decoded.problems:
                return exchange, decoded.values
        return None

    def _error(self, bits: int) -> int:
        """Return the reply to a request of this length that is not valid, with its flags active."""
        parameters = self.encoder.variant.parameters
        lengths = [self.interface.bits_of(exchange).value(parameters) for exchange in self.interface.exchanges]
        fitting = [self.interface.exchanges[index] for index, length in enumerate(lengths) if length == bits]
        layout = self._layout(fitting[-1].reply)
        flags = {field.name: True for field in layout.fields if isinstance(field.kind, Flag)}
        return self.encoder.frame(layout, flags)

    def _layout(self, name: str) -> Layout:
        return member_named(self.interface.layouts, name, "layout over SPI")
