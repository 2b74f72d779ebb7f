"""What a reading states, one fact at a time, under keys without names: two readers name things differently."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum

from ..language.problems import Path

#: The value of what a reading does not have.
NOTHING = "nothing"


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
class Name:
    """What a reader calls a thing: ``what`` is the thing in messages, ``place`` where the spec names it."""

    sort: Sort
    name: str
    what: str
    place: Path


#: What things of one kind are called, by what tells them apart without names.
Names = dict[Key, Name]


@dataclass(frozen=True, slots=True)
class Fact:
    """``what`` is its name in messages, ``place`` where the spec states it.

    ``under`` is the key of the fact without which this one cannot be, such as the register of a default. A ``mild`` one
    may be missing from the other reading, as a printed name of another language is. ``name`` is what the reader calls
    the thing whose first fact this is.
    """

    sort: Sort
    key: Key
    value: Value
    what: str
    place: Path
    under: Key = ()
    mild: bool = False
    name: str = ""


@dataclass(frozen=True, slots=True)
class Aspect:
    """What is said of a field beside its bits, such as a named value.

    ``what`` is followed by the bits in messages, unless it stands ``alone``. One that is ``implied`` follows from
    something else; a reader may state it all the same, and then the other has to as well.
    """

    sort: Sort
    value: str
    what: str
    place: Path
    mild: bool = False
    alone: bool = False
    implied: bool = False


@dataclass(frozen=True, slots=True)
class Bit:
    """What a bit is: ``bit 5 of a number``; ``fixed`` is its value where it has always the same."""

    part: str
    weight: int | None
    fixed: int | None
    place: Path


@dataclass(frozen=True, slots=True)
class Placed:
    """A word as it is in one case: its bits, the lowest first, and what is said of the fields by low bit and width.

    ``names`` are those of the fields, and of the values of each field.
    """

    bits: tuple[Bit, ...]
    fields: Mapping[tuple[int, int], Mapping[str, Aspect]]
    names: Mapping[Key, Names]


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
    """All that a reading states; ``derived`` counts what it states and what follows from the rest.

    ``names`` are those of things of one kind, over one interface where they belong to one.
    """

    facts: dict[Key, Fact] = field(default_factory=dict)
    words: dict[Key, Word] = field(default_factory=dict)
    derived: dict[Sort, int] = field(default_factory=dict)
    names: dict[Key, Names] = field(default_factory=dict)

    def add(self, found: Iterator[Fact]) -> None:
        """Takes in facts; where a key comes again, each time as the next of its kind."""
        for item in found:
            key, again = item.key, 1
            while key in self.facts:
                again += 1
                key = (*item.key, again)
            self.facts[key] = item
            if item.name:
                owner = item.place[: item.place.index(item.name) + 1]
                self.call(_kind(key), key, Name(item.sort, item.name, f"name of {item.what}", (*owner, "name")))

    def call(self, kind: Key, key: Key, name: Name) -> None:
        """Takes in the name of a thing."""
        self.names.setdefault(kind, {}).setdefault(key, name)

    def follows(self, sort: Sort, count: int = 1) -> None:
        """Counts facts that follow from others."""
        self.derived[sort] = self.derived.get(sort, 0) + count


#: Things that have names of their own over each interface; their keys have it in the second place.
_BY_INTERFACE = frozenset(("connector", "frame", "procedure", "register", "time"))


def _kind(key: Key) -> Key:
    return key[:2] if key[0] in _BY_INTERFACE else key[:1]
