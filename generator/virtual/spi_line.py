"""SPI of a virtual encoder: words of a master, and the words that the encoder sends at the same time."""

from __future__ import annotations

from ..model import Exchange, Flag, Layout, Spi, member_named
from ..reference import codec
from .encoder import VirtualEncoder
from .simulation_options import word_with_fault


class SpiLine:
    """SPI with one encoder.

    As bytes, each word consists of as many bytes as its bits need, most significant byte first. A chip select cannot be
    sent as bytes. If words have several lengths, the request determines where a word ends: the longest request that
    matches all received bytes applies.

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
        self._word_lengths = sorted({length.value(parameters) for length in interface.lengths}, reverse=True)
        default_length = interface.word_bits.value(parameters)
        #: Number of bits of a word that is not a known request.
        self.word_bits = default_length if default_length in self._word_lengths else self._word_lengths[-1]
        self._write_exchanges = [exchange for exchange in interface.exchanges if exchange.purpose == "write"]
        #: Address and data of a write of several words, as far as they have been received.
        self._written_fields: dict[str, int] = {}
        #: The reply that is sent with the next word, and its length, if replies are sent one word later.
        self._next_reply = 0, self.word_bits
        self._received_bytes, self._unsent_bytes = b"", b""

    def exchange(self, word: int, bits: int | None = None) -> int:
        """Receive a word, and return the word that the encoder sends at the same time. A fault can change it.

        Args:
            word: The word. Its first bit is the most significant.
            bits: Number of bits of the word. By default, ``word_bits`` of the interface, or the shortest length if no
                word has it.

        Raises:
            ValueError: The encoder has no words of this length, or the word does not fit.
        """
        word_bits = self.word_bits if bits is None else bits
        does_not_fit = word >> word_bits != 0
        if word_bits not in self._word_lengths or does_not_fit:
            lengths_text = " or ".join(map(str, sorted(self._word_lengths)))
            raise ValueError(
                f"0x{word:X} is not a word of {word_bits} bits; {self.encoder.variant.code} has {lengths_text} bits"
            )
        answer = self._answer_word(word, word_bits)
        if self.interface.exchanges and self.interface.reply == "next_word":
            previous_answer, previous_bits = self._next_reply
            self._next_reply = answer, word_bits
            # A longer word ends with zeros, and a shorter word contains only the beginning of the reply.
            if word_bits > previous_bits:
                answer = previous_answer << (word_bits - previous_bits)
            else:
                answer = previous_answer >> (previous_bits - word_bits)
        return word_with_fault(self.encoder, self.encoder.faults.draw(), answer, word_bits)

    def receive(self, data: bytes) -> None:
        """Receive bytes from the master, and answer each complete word.

        If words have several lengths, all bytes of a word must be passed in one call.
        """
        self._received_bytes += data
        while (word_bits := self._bits_of_first_word()) is not None:
            byte_count = (word_bits + 7) // 8
            word = _first_word(self._received_bytes, word_bits)
            self._received_bytes = self._received_bytes[byte_count:]
            answer = self.exchange(word, word_bits)
            self._unsent_bytes += answer.to_bytes(byte_count, "big")

    def send(self) -> bytes:
        """Return the words sent since the last call as bytes."""
        answers, self._unsent_bytes = self._unsent_bytes, b""
        return answers

    def due(self) -> float | None:
        """Return None, because every answer is available at once."""
        return None

    def _bits_of_first_word(self) -> int | None:
        """Return the number of bits of the first received word, or None if it is still incomplete.

        If words have several lengths, it is the longest with which the bytes are a valid request, or else
        ``word_bits``.
        """
        received_bits = 8 * len(self._received_bytes)
        if len(self._word_lengths) > 1:
            complete_lengths = [length for length in self._word_lengths if length <= received_bits]
            for length in complete_lengths:
                word = _first_word(self._received_bytes, length)
                if self._find_request(word, length) is not None:
                    return length
        return self.word_bits if self.word_bits <= received_bits else None

    def _answer_word(self, word: int, word_bits: int) -> int:
        """Execute the request in a word of this length, and return the reply. A write may need several words."""
        if not self.interface.exchanges:
            return self.encoder.frame(self.encoder.layouts(sender="encoder")[0])
        request_and_values = self._find_request(word, word_bits)
        if request_and_values is None:
            self._written_fields = {}
            return self._error_reply(word_bits)
        exchange, values = request_and_values
        layout = self._find_layout(exchange.reply)
        # Fields with the same name in request and reply have the same value.
        names_in_reply = {field.name for field in layout.data_fields}
        repeated_values = {name: value for name, value in values.items() if name in names_in_reply}
        if exchange.purpose not in ("read", "write"):
            return self.encoder.frame(layout, repeated_values)
        address_and_data: dict[str, int] = {name: int(values[name]) for name in ("address", "data") if name in values}
        if exchange.purpose == "write":
            self._written_fields |= address_and_data
            register_value = self._continue_write()
        else:
            address = address_and_data.get("address", -1)  # No register has the address -1.
            register_value = self.encoder.memory.read_whole(address)
        if register_value is None:
            return self._error_reply(word_bits)
        return self.encoder.frame(layout, {**repeated_values, "data": register_value})

    def _continue_write(self) -> int | None:
        """Write a register if both its address and its data have been received, and return the value of the register.

        Before the data have been received, it is the old value. Return None if the register cannot be written or read.
        """
        address = self._written_fields.get("address", -1)  # No register has the address -1.
        if self._written_fields.keys() >= {"address", "data"}:
            data = self._written_fields["data"]
            self._written_fields = {}
            if not self.encoder.memory.write_whole(address, data):
                return None
        return self.encoder.memory.read_whole(address)

    def _find_request(self, word: int, word_bits: int) -> tuple[Exchange, dict[str, int | str | bool]] | None:
        """Return the request in a word with the values of its fields, or None if the word is not a valid request.

        A write can consist of several words. After its first word, only its other words are valid.
        """
        later_words_of_write = self._write_exchanges[1:]
        write_has_begun = bool(self._written_fields)
        if write_has_begun:
            possible_exchanges = later_words_of_write
        else:
            exchanges = self.interface.exchanges
            possible_exchanges = [exchange for exchange in exchanges if exchange not in later_words_of_write]
        for exchange in possible_exchanges:
            placed_layout = self.encoder.place(self._find_layout(exchange.request))
            decoded = codec.decode_bits(self.encoder.device, placed_layout, word, word_bits)
            if not decoded.problems:
                return exchange, decoded.values
        return None

    def _error_reply(self, word_bits: int) -> int:
        """Return the reply to an invalid request of this length: all flags active, and the layout of the last reply."""
        parameters = self.encoder.variant.parameters
        exchanges_of_length: list[Exchange] = []
        for exchange in self.interface.exchanges:
            if self.interface.bits_of(exchange).value(parameters) == word_bits:
                exchanges_of_length.append(exchange)
        layout = self._find_layout(exchanges_of_length[-1].reply)
        active_flags = {field.name: True for field in layout.fields if isinstance(field.kind, Flag)}
        return self.encoder.frame(layout, active_flags)

    def _find_layout(self, name: str) -> Layout:
        """Return the layout of the interface with this name."""
        return member_named(self.interface.layouts, name, "layout over SPI")


def _first_word(data: bytes, word_bits: int) -> int:
    """Return the first word in the data, as a number. ``word_bits`` is its length.

    If the word does not fill whole bytes, the top bits of its first byte are ignored.
    """
    byte_count = (word_bits + 7) // 8
    mask = (1 << word_bits) - 1
    return int.from_bytes(data[:byte_count], "big") & mask
