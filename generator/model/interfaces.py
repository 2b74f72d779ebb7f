"""Interfaces, each with its names and the facts that a manual gives about it.

They are part of the model. A device has interfaces, and an interface has layouts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from types import MappingProxyType
from typing import ClassVar, Literal, TypeVar, get_args

from .expressions import Expression
from .facts import (
    Timing,
)
from .interface_parts import CableLength, ChannelFrame, Clock, DataChannels, Timeout, frame_of_channels
from .kinds import Value
from .layout import Layout
from .manual import Sources
from .measurement import Measurement
from .order_codes import Restricted, facts_for_code
from .part import Hex, Name, Phrase, Prose, key, meaning_key, name_key, part, source_key
from .record import dataclass


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
    #: True if a register has one address for each of its bytes, false if it has a single address.
    byte_addresses: ClassVar[bool] = True
    #: Flags defined by the interface itself, with the verdict on the position while each is active.
    flags: ClassVar[Mapping[str, str]] = MappingProxyType({})

    layouts: tuple[Layout, ...]
    timings: tuple[Timing, ...]
    note: str
    source: Sources
    measurement: Measurement | None


_Fact = TypeVar("_Fact", bound=Restricted)


def _common_fact(facts: Sequence[_Fact]) -> _Fact | None:
    """Return the fact that applies to all order codes, or None if there is none or they depend on the order code."""
    return facts[0] if len(facts) == 1 and not facts[0].only else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Clocked(Common):
    """An interface with a clock: one for all order codes, or several with disjoint order codes."""

    clocks: tuple[Clock, ...]

    @property
    def clock(self) -> Clock | None:
        """The clock of all order codes, or None if it depends on the order code."""
        return _common_fact(self.clocks)

    @property
    def clocks_by_code(self) -> tuple[Clock, ...]:
        """The clocks if they depend on the order code, otherwise an empty tuple."""
        return self.clocks if self.clock is None else ()

    def clock_of(self, code: str) -> Clock:
        """Return the clock of an order code. It has no limits for a code that no listed order code resembles."""
        return next(iter(facts_for_code(self.clocks, code)), Clock(source=()))


@dataclass(frozen=True, slots=True)
class Signals:
    """The electrical standard."""

    text: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Exchange:
    """A request with the frame that answers it. ``reply`` is empty if the encoder does not answer.

    ``purpose`` is ``position``, ``read``, ``write`` or ``other``. Exchanges that read or write access a register over
    SPI, with their fields ``address`` and ``data``. Several exchanges that write are the words of one write, in order.
    ``word_bits`` is the length of each of the two SPI words, or None if the length of the interface applies.
    """

    request: str
    word_bits: Expression | None
    reply: str
    purpose: str
    source: Sources


@part("Permitted connections of the encoder.")
class Network:
    topology: Literal["point_to_point", "bus"] = key("Topology of master and slave.", read="setting", data_type="name")
    multiple_slaves: bool = key("True if more than one slave may be connected.", read="setting")
    source: Sources = source_key()


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
    """A field of the control frame. The manual does not describe the complete layout of that frame."""

    name: str
    printed_name: str
    bits: int
    values: tuple[Value, ...]
    crc: str
    meaning: str
    source: Sources
    names: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True, kw_only=True)
class Biss(Clocked):
    name: ClassVar[str] = "biss"
    title: ClassVar[str] = "BiSS C-mode"
    short: ClassVar[str] = "BiSS"
    has_channels: ClassVar[bool] = True
    #: The first half of the addresses is banked (protocol description, p. 14).
    highest_address: ClassVar[int] = 0x7F
    highest_in_bank: ClassVar[int] = 0x3F
    flags: ClassVar[Mapping[str, str]] = MappingProxyType({"error": "not_usable", "warning": "usable_with_warning"})

    signals: str
    profile: str
    description_file: str
    bank_select: str
    network: Network | None
    timeouts: tuple[Timeout, ...]
    channels: DataChannels | None
    control_data: tuple[ControlField, ...]
    control_data_note: str

    def facts(
        self,
    ) -> Iterator[Clock | Signals | Profile | DescriptionFile | BankSelect | Network | Timeout | DataChannels]:
        """Yield the facts needed for set-up, in order of importance."""
        yield from self.clocks
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
        yield from self.timeouts
        if self.channels is not None:
            yield self.channels

    @property
    def timeout(self) -> Timeout | None:
        """The timeout of all order codes, or None if it is not known or depends on the order code."""
        return _common_fact(self.timeouts)

    @property
    def timeouts_by_code(self) -> tuple[Timeout, ...]:
        """The timeouts if they depend on the order code, otherwise an empty tuple."""
        return self.timeouts if self.timeout is None else ()

    def timeout_of(self, code: str) -> Timeout | None:
        """Return the timeout of an order code, or None if it is not known."""
        return next(iter(facts_for_code(self.timeouts, code)), None)


@part("Settings of the serial port.")
class Port:
    """Settings of the serial port."""

    baud: int = key("Bits per second.", minimum=1, rule="port", read="clock", noun="baud rate")
    data_bits: int = key("Data bits of a character.", minimum=5, maximum=9, rule="port", read="setting")
    parity: Literal["none", "even", "odd"] = key(
        "Parity bit of a character.", rule="port", read="setting", data_type="name"
    )
    stop_bits: int = key("Stop bits of a character.", minimum=1, maximum=2, rule="port", read="setting")
    flow_control: Literal["", "none", "hardware", "software"] = key(
        "Flow control.", default="", rule="port", read="setting", data_type="name"
    )
    source: Sources = source_key()


@part("One data ID.", data="A data ID.", identity="id control")
class DataId:
    """Data that a request can ask for. ``control`` is the first byte of the request and of the reply."""

    name: Name = name_key("Name of the data ID.")
    id: Hex = key("The data ID as a number.", minimum=0, maximum=31, rule="data-id-changed", label="number")
    control: Hex = key(
        "Byte of the control field as printed. 'check' compares it with sync code, ID and parity.",
        data="Byte of the control field.",
        minimum=0,
        maximum=255,
        rule="data-id-changed",
        label="control byte",
    )
    purpose: Literal["capture", "write", "read", "reset"] = key(
        "Effect of the request.", rule="data-id-changed", read="setting", data_type="name"
    )
    meaning: Prose = meaning_key("Meaning of the request.", default="")
    source: Sources = source_key()


@part("One row.", data="Reply of the encoder to a memory access.")
class MemoryAccess:
    """Meaning of the busy flag in a reply to a memory access."""

    access: Literal["read", "write"] = key("Kind of access: reading or writing.", data_type="name")
    busy: int = key("The busy flag of the reply.", minimum=0, maximum=1)
    address: Phrase = key("Content of the address field.")
    data: Phrase = key("Content of the data field.")
    meaning: Prose = key("Result of the request that this reply indicates.")
    source: Sources = source_key(default=())


@dataclass(frozen=True, slots=True, kw_only=True)
class Rs485(Common):
    """Requests and replies. Exchanges of the T-format have ``data_ids``, all others ``exchanges``."""

    name: ClassVar[str] = "rs485"
    title: ClassVar[str] = "RS-485"
    short: ClassVar[str] = "RS-485"
    carried_as: ClassVar[str] = "bytes"

    port: Port
    data_ids: tuple[DataId, ...]
    memory_access: tuple[MemoryAccess, ...]
    exchanges: tuple[Exchange, ...]

    def facts(self) -> Iterator[Port]:
        """Yield the settings."""
        yield self.port


@dataclass(frozen=True, slots=True)
class WordFormat:
    """Words in SPI mode 0 to 3, with the number of bits in ``lengths``. ``reply`` is ``same_word`` or ``next_word``."""

    lengths: tuple[Expression, ...]
    mode: int
    reply: str
    source: Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class Spi(Clocked):
    name: ClassVar[str] = "spi"
    title: ClassVar[str] = "SPI"
    short: ClassVar[str] = "SPI"
    byte_addresses: ClassVar[bool] = False

    mode: int
    word_bits: Expression
    reply: str
    exchanges: tuple[Exchange, ...]

    def facts(self) -> Iterator[Clock | WordFormat]:
        """Yield the facts needed for set-up, in order of importance."""
        yield from self.clocks
        yield WordFormat(self.lengths, self.mode, self.reply, self.source)

    def bits_of(self, exchange: Exchange) -> Expression:
        """Return the number of bits of a request and its reply."""
        return self.word_bits if exchange.word_bits is None else exchange.word_bits

    @property
    def lengths(self) -> tuple[Expression, ...]:
        """The different numbers of bits of words, in the order of the requests."""
        return tuple(dict.fromkeys(map(self.bits_of, self.exchanges))) or (self.word_bits,)


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Ssi(Clocked):
    name: ClassVar[str] = "ssi"
    title: ClassVar[str] = "SSI"
    short: ClassVar[str] = "SSI"

    alignment: Alignment
    output_code: OutputCode | None
    signals: str
    cable_lengths: tuple[CableLength, ...]

    def facts(self) -> Iterator[Clock | CableLength | Signals | Alignment | OutputCode]:
        """Yield the facts needed for set-up, in order of importance."""
        yield from self.clocks
        yield from self.cable_lengths
        if self.signals:
            yield Signals(self.signals, self.source)
        yield self.alignment
        if self.output_code is not None:
            yield self.output_code


Interface = Ssi | Biss | Rs485 | Spi
#: Facts yielded by the method ``facts`` of an interface. An output that can show all of these can show any interface.
Fact = (
    Clock
    | CableLength
    | Signals
    | Alignment
    | OutputCode
    | Profile
    | DescriptionFile
    | BankSelect
    | Network
    | Timeout
    | DataChannels
    | Port
    | WordFormat
)
#: All interfaces by name.
INTERFACES: Mapping[str, type[Interface]] = MappingProxyType({kind.name: kind for kind in get_args(Interface)})


def channel_frame(interface: Interface) -> ChannelFrame | None:
    """Return the frame that carries several data channels over an interface, or None if there is none."""
    if not isinstance(interface, Biss) or interface.channels is None:
        return None
    return frame_of_channels(interface.channels, interface.layouts)
