"""SPI: words that go both ways at once, where each reply answers a request in the same word or in the one before."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..expressions import Expression
from ..facts import Sources
from ..record import dataclass
from .common import Clock, Common, Exchange


@dataclass(frozen=True, slots=True)
class WordFormat:
    """Words in SPI mode 0 to 3, with the number of bits in ``lengths``. ``reply`` is ``same_word`` or ``next_word``."""

    lengths: tuple[Expression, ...]
    mode: int
    reply: str
    source: Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class Spi(Common):
    name: ClassVar[str] = "spi"
    title: ClassVar[str] = "SPI"
    short: ClassVar[str] = "SPI"
    byte_addresses: ClassVar[bool] = False

    clock: Clock
    mode: int
    word_bits: Expression
    reply: str
    exchanges: tuple[Exchange, ...]

    def facts(self) -> Iterator[Clock | WordFormat]:
        """Yield the facts needed for set-up, in order of importance."""
        yield self.clock
        yield WordFormat(self.lengths, self.mode, self.reply, self.source)

    def bits_of(self, exchange: Exchange) -> Expression:
        """Return the number of bits of a request and its reply."""
        return self.word_bits if exchange.word_bits is None else exchange.word_bits

    @property
    def lengths(self) -> tuple[Expression, ...]:
        """The different numbers of bits of words, in the order of the requests."""
        return tuple(dict.fromkeys(map(self.bits_of, self.exchanges))) or (self.word_bits,)
