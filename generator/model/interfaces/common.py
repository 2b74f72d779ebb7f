"""Members that every interface has, and facts shared by several interfaces."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

from ..expressions import Expression
from ..facts import Sources, Timing
from ..layout import Layout
from ..measurement import Measurement
from ..record import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Common:
    """An interface of a device. Order codes, registers and procedures refer to it by ``name``."""

    #: The key in the spec language and in all outputs.
    name: ClassVar[str]
    #: Title for display, and the name used in sentences.
    title: ClassVar[str]
    short: ClassVar[str]
    #: Default for layouts: frames are transmitted as ``"bits"`` or ``"bytes"``.
    carried_as: ClassVar[str] = "bits"
    #: True if layouts can be sent on several data channels.
    has_channels: ClassVar[bool] = False
    #: Number of register addresses, and the number in a bank if the interface has banks.
    highest_address: ClassVar[int | None] = None
    highest_in_bank: ClassVar[int | None] = None
    #: True if a register has one address for each of its bytes, false if it has a single one.
    byte_addresses: ClassVar[bool] = True
    #: Flags defined by the interface itself, with the verdict on the position while each is active.
    flags: ClassVar[Mapping[str, str]] = MappingProxyType({})

    layouts: tuple[Layout, ...]
    timings: tuple[Timing, ...]
    note: str
    source: Sources
    measurement: Measurement | None


@dataclass(frozen=True, slots=True)
class Clock:
    """The master's clock: its limits, inclusive, each None if not known, and clocks with which encoders are read.

    ``used_hz`` has the clocks of programs and masters in ascending order. They are not limits.
    """

    min_hz: int | None
    max_hz: int | None
    used_hz: tuple[int, ...]
    source: Sources

    @property
    def fastest_hz(self) -> int:
        """Highest clock if it is known, otherwise the fastest that is in use."""
        return self.max_hz if self.max_hz is not None else max(self.used_hz)

    @property
    def has_limits(self) -> bool:
        return self.min_hz is not None or self.max_hz is not None


@dataclass(frozen=True, slots=True)
class Signals:
    """The electrical standard."""

    text: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Exchange:
    """A request with the frame that answers it. ``reply`` is empty if the encoder does not answer.

    ``purpose`` is ``position``, ``read``, ``write`` or ``other``. Those that read or write access a register over SPI,
    with their fields ``address`` and ``data``. Several that write are the words of one write, in order.
    ``word_bits`` is the length of both words over SPI, or None if it is that of the interface.
    """

    request: str
    word_bits: Expression | None
    reply: str
    purpose: str
    source: Sources
