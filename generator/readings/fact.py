"""What a reading states, one fact at a time, under keys without names: two readers name things differently."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType

from ..spec.problems import Path


class Sort(Enum):
    """The classes of facts, in the order in which they are shown."""

    POSITION = "position"
    CRC = "crc"
    ADDRESS = "address"
    BYTE_ORDER = "byte order"
    ACCESS = "access"
    DEFAULT = "default"
    LIMIT = "limit"
    CLOCK = "clock"
    TIME = "time"
    WAIT = "wait"
    VALUE = "value"
    BEHAVIOUR = "behaviour"
    VERDICT = "verdict"
    ALARM = "alarm"
    PROCEDURE = "procedure"
    ORDER_CODE = "order code"
    MEASUREMENT = "measurement"
    SETTING = "setting"
    SUPPLY = "supply"
    PIN = "pin"
    INPUT = "input"
    PRINTED = "printed name"
    HISTORY = "history"

    @property
    def is_needed(self) -> bool:
        """Whether a wrong fact of the class moves a position or breaks a transfer, so that it has to be read twice."""
        return self in _NEEDED


_NEEDED = frozenset(list(Sort)[: list(Sort).index(Sort.VALUE)])

#: What tells a fact from all others of its family, without names.
Key = tuple[str | int, ...]
#: An order code, and what a register holds at that time; empty as delivered.
Case = tuple[str, str]
#: A value as messages print it: one, or one for each case.
Value = str | Mapping[Case, str]


@dataclass(frozen=True, slots=True)
class Fact:
    """``what`` is its name in messages, ``place`` where the spec states it.

    ``under`` is the key of the fact without which this one cannot be, such as the register of a default. A ``mild`` one
    may be missing from the other reading, as a printed name of another language is.
    """

    sort: Sort
    key: Key
    value: Value
    what: str
    place: Path
    under: Key = ()
    mild: bool = False


@dataclass(frozen=True, slots=True)
class Aspect:
    """What is said of a field beside its bits, such as a named value.

    ``what`` is followed by the bits in messages, unless it stands ``alone``.
    """

    sort: Sort
    value: str
    what: str
    place: Path
    mild: bool = False
    alone: bool = False


@dataclass(frozen=True, slots=True)
class Bit:
    """What a bit is: ``bit 5 of a number``; ``fixed`` is its value where it has always the same."""

    part: str
    weight: int | None
    fixed: int | None
    place: Path


@dataclass(frozen=True, slots=True)
class Placed:
    """A word as it is in one case: its bits, the lowest first, and what is said of the fields by low bit and width."""

    bits: tuple[Bit, ...]
    fields: Mapping[tuple[int, int], Mapping[str, Aspect]]


@dataclass(frozen=True, slots=True)
class Word:
    """A frame or a register, bit by bit, in each case."""

    key: Key
    what: str
    place: Path
    cases: Mapping[Case, Placed]

    @property
    def everywhere(self) -> Placed | None:
        """What it is in every case, if that is the same; then it can be compared whatever the order codes are."""
        found = {id(placed): placed for placed in self.cases.values()}
        return next(iter(found.values())) if len(found) == 1 else None


@dataclass(slots=True)
class Facts:
    """All that a reading states; ``derived`` counts what it states and what follows from the rest."""

    facts: dict[Key, Fact] = field(default_factory=dict)
    words: dict[Key, Word] = field(default_factory=dict)
    derived: dict[Sort, int] = field(default_factory=dict)

    def add(self, found: Iterator[Fact]) -> None:
        """Takes in facts; where a key comes again, each time as the next of its kind."""
        for item in found:
            key, again = item.key, 1
            while key in self.facts:
                again += 1
                key = (*item.key, again)
            self.facts[key] = item

    def follows(self, sort: Sort, count: int = 1) -> None:
        """Counts facts that follow from others."""
        self.derived[sort] = self.derived.get(sort, 0) + count


NO_ASPECTS: Mapping[tuple[int, int], Mapping[str, Aspect]] = MappingProxyType({})
