"""SPI interface of a virtual encoder: words that go both ways at once, and registers as whole numbers."""

from __future__ import annotations

from ..model import Exchange, Flag, Layout, Spi
from ..reference import codec
from .encoder import VirtualEncoder
from .faults import disturbed


class SpiLine:
    """SPI with one encoder. As bytes, each word has the bytes that hold its bits, most significant first.

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
        self.word_bits = interface.word_bits.value(encoder.variant.parameters)
        self._writes = [item for item in interface.exchanges if item.purpose == "write"]
        self._written: dict[str, int] = {}
        self._next = 0
        self._received, self._answers = b"", b""

    def exchange(self, word: int) -> int:
        """Receive a word, and return the word that the encoder sends meanwhile. A fault can change it."""
        answer = self._answer(word)
        if self.interface.exchanges and self.interface.reply == "next_word":
            answer, self._next = self._next, answer
        return disturbed(self.encoder, answer, self.word_bits)

    def receive(self, data: bytes) -> None:
        """Take bytes that the master sends."""
        size = (self.word_bits + 7) // 8
        self._received += data
        while len(self._received) >= size:
            word, self._received = self._received[:size], self._received[size:]
            self._answers += self.exchange(int.from_bytes(word, "big")).to_bytes(size, "big")

    def send(self) -> bytes:
        """Return each answer once."""
        data, self._answers = self._answers, b""
        return data

    def due(self) -> float | None:
        """Return None, because the answers never wait."""
        return None

    def _answer(self, word: int) -> int:
        if not self.interface.exchanges:
            return self.encoder.frame(self.encoder.layouts("encoder")[0])
        found = self._request(word)
        if found is None:
            return self._error()
        item, values = found
        layout = self._layout(item.reply)
        access: dict[str, int] = {name: int(values[name]) for name in ("address", "data") if name in values}
        # A reply can repeat fields of its request.
        echo = {field.name: values[field.name] for field in layout.data_fields if field.name in values}
        if item.purpose not in ("read", "write"):
            return self.encoder.frame(layout, echo)
        if item.purpose == "write":
            self._written |= access
        data = self._access(item.purpose, access)
        return self._error() if data is None else self.encoder.frame(layout, {**echo, "data": data})

    def _access(self, purpose: str, access: dict[str, int]) -> int | None:
        """Carry out an access, and return the value of the register afterwards, or None if there is no access."""
        memory, address = self.encoder.memory, (access if purpose == "read" else self._written).get("address", -1)
        if purpose == "write" and self._written.keys() >= {"address", "data"}:
            data = self._written["data"]
            self._written = {}
            if not memory.write_whole(address, data):
                return None
        return memory.read_whole(address)

    def _request(self, word: int) -> tuple[Exchange, dict[str, int | str | bool]] | None:
        """Return the request in a word with its values. The second word of a write follows the first."""
        started = bool(self._written)
        for item in self._writes[1:] if started else self.interface.exchanges:
            if not started and item in self._writes[1:]:
                continue
            place = self.encoder.place(self._layout(item.request))
            decoded = codec.decode_bits(self.encoder.device, place, word, self.word_bits)
            if not decoded.problems:
                return item, decoded.values
        self._written = {}
        return None

    def _error(self) -> int:
        """Return the reply to a request that is not valid, with its flags active."""
        layout = self._layout(self.interface.exchanges[-1].reply)
        flags = {item.name: True for item in layout.fields if isinstance(item.kind, Flag)}
        return self.encoder.frame(layout, flags)

    def _layout(self, name: str) -> Layout:
        return next(item for item in self.interface.layouts if item.name == name)
