"""SSI: a word that is clocked out bit by bit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..facts import Sources
from ..record import dataclass
from .common import Clock, Common, Signals


@dataclass(frozen=True, slots=True)
class Alignment:
    """End of the word that is aligned with the clocks: ``msb_left`` or ``lsb_right``."""

    end: str
    source: Sources


@dataclass(frozen=True, slots=True)
class OutputCode:
    """Position encoding as stated in the manual: ``binary``, ``gray`` or ``by_order_code``."""

    code: str
    source: Sources


@dataclass(frozen=True, slots=True)
class CableLength:
    """Clock limit in Hz, exclusive, for cables shorter than a length in metres."""

    shorter_than_m: int
    below_hz: int
    source: Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class Ssi(Common):
    name: ClassVar[str] = "ssi"
    title: ClassVar[str] = "SSI"
    short: ClassVar[str] = "SSI"

    clock: Clock
    alignment: Alignment
    output_code: OutputCode | None
    signals: str
    cable_lengths: tuple[CableLength, ...]

    def facts(self) -> Iterator[Clock | CableLength | Signals | Alignment | OutputCode]:
        """Yield the facts needed for set-up, in order of importance."""
        yield self.clock
        yield from self.cable_lengths
        if self.signals:
            yield Signals(self.signals, self.source)
        yield self.alignment
        if self.output_code is not None:
            yield self.output_code
