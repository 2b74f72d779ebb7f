"""RS-485, with requests and replies: similar to those of Tamagawa's T-format, or any others."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..facts import Sources
from ..record import dataclass
from .common import Common, Exchange


@dataclass(frozen=True, slots=True)
class Port:
    """Settings of the serial port."""

    baud: int
    data_bits: int
    parity: str
    stop_bits: int
    flow_control: str
    source: Sources


@dataclass(frozen=True, slots=True)
class DataId:
    """Data that a request can ask for. ``control`` is the first byte of the request and of the reply."""

    name: str
    id: int
    control: int
    purpose: str
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class MemoryAccess:
    """Meaning of the busy flag in a reply to a memory access."""

    access: str
    busy: int
    address: str
    data: str
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class Rs485(Common):
    """Requests and replies. Those of the T-format have ``data_ids``, all others ``exchanges``."""

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
