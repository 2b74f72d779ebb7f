"""SPI interface of a virtual encoder: words that go both ways at once, and registers as whole numbers."""

from __future__ import annotations

from ..model import Exchange, Flag, Layout, Spi, member_named
from ..reference import codec
from .encoder import VirtualEncoder
from .faults import disturbed


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
