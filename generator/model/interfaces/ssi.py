"""SSI: a word, clocked out bit by bit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..facts import Sources
from .common import Clock, Common, Signals


@dataclass(frozen=True, slots=True)
class Alignment:
    """Which end of the word comes with the first clock: ``msb_left`` or ``lsb_right``."""

    end: str
    source: Sources


@dataclass(frozen=True, slots=True)
class OutputCode:
    """The code of the position as printed: ``binary``, ``gray`` or ``by_order_code``."""

    code: str
    source: Sources


@dataclass(frozen=True, slots=True)
class CableLength:
    """A cable shorter than so many metres takes a clock below so many hertz."""

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
        """What has to be set or built, in order of importance."""
        yield self.clock
        yield from self.cable_lengths
        if self.signals:
            yield Signals(self.signals, self.source)
        yield self.alignment
        if self.output_code is not None:
            yield self.output_code
