"""BiSS C-mode: single cycle data, and register access with one bit per frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from types import MappingProxyType
from typing import ClassVar

from ..facts import Sources
from ..kinds import Value
from ..record import dataclass
from .common import Clock, Common, Signals


@dataclass(frozen=True, slots=True)
class Network:
    topology: str
    multiple_slaves: bool
    source: Sources


@dataclass(frozen=True, slots=True)
class PrintedTimeout:
    """Time-out given in the manual for one clock frequency."""

    clock_hz: int
    timeout_ns: int


@dataclass(frozen=True, slots=True)
class Timeout:
    """Time-out after a frame. ``rule`` is ``follows_clock`` or ``fixed``."""

    rule: str
    half_clock_periods: int | None
    at_most_ns: int | None
    typical_ns: int | None
    printed: tuple[PrintedTimeout, ...]
    source: Sources


@dataclass(frozen=True, slots=True)
class Profile:
    """Encoder profile that the manual names."""

    text: str
    source: Sources


@dataclass(frozen=True, slots=True)
class DescriptionFile:
    """File that describes the encoder to a master."""

    text: str
    source: Sources


@dataclass(frozen=True, slots=True)
class BankSelect:
    """Register that selects the bank of the banked addresses."""

    register: str
    source: Sources


@dataclass(frozen=True, slots=True)
class ControlField:
    """A field of the control frame. The manual does not give the complete layout of that frame."""

    name: str
    printed_name: str
    bits: int
    values: tuple[Value, ...]
    crc: str
    meaning: str
    source: Sources
    names: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True, kw_only=True)
class Biss(Common):
    name: ClassVar[str] = "biss"
    title: ClassVar[str] = "BiSS C-mode"
    short: ClassVar[str] = "BiSS"
    has_channels: ClassVar[bool] = True
    #: The first half of the addresses is banked (protocol description, p. 14).
    highest_address: ClassVar[int] = 0x7F
    highest_in_bank: ClassVar[int] = 0x3F
    flags: ClassVar[Mapping[str, str]] = MappingProxyType({"error": "not_usable", "warning": "usable_with_warning"})

    clock: Clock
    signals: str
    profile: str
    description_file: str
    bank_select: str
    network: Network | None
    timeout: Timeout | None
    control_data: tuple[ControlField, ...]
    control_data_note: str

    def facts(self) -> Iterator[Clock | Signals | Profile | DescriptionFile | BankSelect | Network | Timeout]:
        """Yield the facts needed for set-up, in order of importance."""
        yield self.clock
        if self.signals:
            yield Signals(self.signals, self.source)
        if self.profile:
            yield Profile(self.profile, self.source)
        if self.description_file:
            yield DescriptionFile(self.description_file, self.source)
        if self.bank_select:
            yield BankSelect(self.bank_select, self.source)
        if self.network is not None:
            yield self.network
        if self.timeout is not None:
            yield self.timeout
