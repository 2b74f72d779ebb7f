# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Interfaces and families of encoders, the reports in their frames, and verdicts on positions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from enum import Enum
from functools import cached_property
from typing import NamedTuple, TypeVar

_Value = TypeVar("_Value")


class ReadOnly(Mapping[str, _Value]):
    """Read-only mapping. Unlike a MappingProxyType, it can be copied and pickled."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, _Value]) -> None:
        self._items = dict(items)

    def __getitem__(self, key: str) -> _Value:
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __repr__(self) -> str:
        return repr(self._items)


class Interface(Enum):
    """Interface of an encoder."""

    SSI = "ssi"
    BISS = "biss"
    RS485 = "rs485"
    SPI = "spi"

    @property
    def title(self) -> str:
        """Name as it is usually printed."""
        return {"ssi": "SSI", "biss": "BiSS", "rs485": "RS-485", "spi": "SPI"}[self.value]


class Movement(Enum):
    """Quantity that an encoder measures: an angle (rotary) or a length (linear)."""

    ROTARY = "rotary"
    LINEAR = "linear"


class Family(NamedTuple):
    """Encoder family.

    Attributes:
        name: Name of the family's module.
        title: Title of the family.
        movement: Rotary or linear.
        manufacturer: Name of the manufacturer.
    """

    name: str
    title: str
    movement: Movement
    manufacturer: str


class Verdict(Enum):
    """Verdict on the position of a frame, from worst to best."""

    NOT_USABLE = "not_usable"
    """The position is or may be wrong, frozen or 0."""
    UNKNOWN = "unknown"
    """The frame does not say whether the position is usable."""
    USABLE_WITH_WARNING = "usable_with_warning"
    """The position can be used, but the encoder needs attention."""
    USABLE = "usable"
    """The position can be used. The encoder reports no problem."""


class Report(NamedTuple):
    """Encoder report in a frame: an active flag, or unused bits that differ from the manual.

    Attributes:
        name: Name of the report.
        printed_name: Name in the manual.
        meaning: Meaning of the report.
        remedy: Remedy, if the manual gives one.
        makes_position: Verdict on the position that results from this report, or None if the frame has no position. The
            ``verdict`` of a frame combines all its reports.
        source: Section and page of the manual.
    """

    name: str
    printed_name: str
    meaning: str
    remedy: str = ""
    makes_position: Verdict | None = None
    source: str = ""


class Reports(Mapping[str, Report]):
    """All reports of a family by name, created on first access because most frames report nothing."""

    def __init__(self, make: Callable[[], tuple[Report, ...]]) -> None:
        self._make = make

    @cached_property
    def _items(self) -> dict[str, Report]:
        return {report.name: report for report in self._make()}

    def __reduce__(self) -> tuple[object, ...]:
        # Copies and pickles contain the reports, because functions of a module without a name cannot be pickled.
        return ReadOnly, (self._items,)

    def __getitem__(self, key: str) -> Report:
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __repr__(self) -> str:
        return repr(self._items)
