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
    """Words of ``bits`` bits in SPI mode 0 to 3. ``reply`` is ``same_word`` or ``next_word``."""

    bits: Expression
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
        yield WordFormat(self.word_bits, self.mode, self.reply, self.source)
