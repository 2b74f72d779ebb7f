"""The facts of a reading, under keys without names, because two readers use different names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from ..language.document import Path

#: Value shown for a fact that a reading does not have.
NOTHING = "nothing"


class Sort(Enum):
    """Classes of facts, in the order of display."""

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
    CHARACTERISTIC = "characteristic"
    TABLE = "table"
    LED = "LED"
    TEXT = "number in a text"
    SECTION = "cited section"
    CONTENTS = "contents"

    @property
    def is_needed(self) -> bool:
        """True if an error in this class corrupts a position or a transfer, so that it must be read twice."""
        return self in _NEEDED


_NEEDED = frozenset(list(Sort)[: list(Sort).index(Sort.VALUE)])

#: Key that identifies a fact within its family, without names.
Key = tuple[str | int, ...]
#: An order code, and the state of a register, which is empty for the factory defaults.
Case = tuple[str, str]
#: A value as shown in messages: one, or one for each case.
Value = str | Mapping[Case, str]


@dataclass(frozen=True, slots=True)
class Fact:
    """A fact. ``description`` is its name in messages, ``place`` its place in the spec.

    ``under`` is the key of the fact that this one depends on, such as the register of a default. A ``mild`` fact may be
    missing from the other reading, such as a printed name in another language. ``name`` is the reader's name of the
    item whose first fact this is. An ``implied`` fact follows from another one. If one reader still states it, the
    other must, too.
    """

    sort: Sort
    key: Key
    value: Value
    description: str
    place: Path
    under: Key = ()
    mild: bool = False
    name: str = ""
    implied: bool = False


#: Facts about the names that a reader gives to items of one kind.
Names = dict[Key, Fact]


@dataclass(frozen=True, slots=True)
class Bit:
    """Meaning of a bit, such as ``bit 5 of a number``. ``fixed`` is its value if it is constant."""

    part: str
    weight: int | None
    fixed: int | None
    place: Path


@dataclass(frozen=True, slots=True)
class WordCase:
    """A word in one case: its bits, lowest first, and the properties of its fields by low bit and width.

    ``names`` contains the names of the fields, and of the values of each field.
    """

    bits: tuple[Bit, ...]
    fields: Mapping[tuple[int, int], Mapping[Key, Fact]]
    names: Mapping[Key, Names]


@dataclass(frozen=True, slots=True)
class Word:
    """A frame or a register, bit by bit, in each case."""

    description: str
    place: Path
    cases: Mapping[Case, WordCase]

    @property
    def everywhere(self) -> WordCase | None:
        """The word if it is the same in every case, so that it can be compared independently of the order codes."""
        distinct = {id(placed): placed for placed in self.cases.values()}
        return next(iter(distinct.values())) if len(distinct) == 1 else None


@dataclass(slots=True)
class Facts:
    """All facts of a reading. ``derived`` counts the facts that follow from others.

    ``names`` contains the names of items of one kind, by interface if they belong to one. A second reading can give
    the numbers of a text in ``printed_numbers`` by its path, and the sections of everything under a path in
    ``sections``. ``decided`` contains the paths and classes of facts that no manual prints.
    """

    facts: dict[Key, Fact] = field(default_factory=dict)
    words: dict[Key, Word] = field(default_factory=dict)
    derived: Counter[Sort] = field(default_factory=Counter)
    names: dict[Key, Names] = field(default_factory=dict)
    printed_numbers: Mapping[str, tuple[str, Path]] = field(default_factory=dict)
    sections: Mapping[str, Sequence[str]] = field(default_factory=dict)
    decided: Sequence[str] = ()

    def add(self, facts: Iterator[Fact]) -> None:
        """Add facts. A repeated key gets the next number of its kind."""
        for fact in facts:
            key, count = fact.key, 1
            while key in self.facts:
                count += 1
                key = (*fact.key, count)
            self.facts[key] = fact
            if fact.name:
                owner = fact.place[: fact.place.index(fact.name) + 1]
                self.call(
                    key[: 2 if key[0] in _BY_INTERFACE else 1],
                    Fact(fact.sort, key, fact.name, f"name of {fact.description}", (*owner, "name")),
                )

    def call(self, kind: Key, name: Fact) -> None:
        """Add the name of an item."""
        self.names.setdefault(kind, {}).setdefault(name.key, name)


#: Items with separate names for each interface, which is the second element of their keys.
_BY_INTERFACE = frozenset(("connector", "frame", "procedure", "register", "time"))


#: Share of equal names from which the second reading is assumed to use the names of the spec.
_SETTLED = 0.9


def are_settled(spec: Facts, second: Facts) -> bool:
    """Return True if the second reading uses the names of the spec, so that any different name is a mistake."""
    count, equal_count = 0, 0
    for own_names, other_names in _common_names(spec, second):
        for key in own_names.keys() & other_names.keys():
            count += 1
            equal_count += own_names[key].value == other_names[key].value
    return equal_count >= _SETTLED * count


def _common_names(spec: Facts, second: Facts) -> Iterator[tuple[Names, Names]]:
    """Yield the names of each kind that both readings have, those of fields for the first case of each word."""
    for kind in spec.names.keys() & second.names.keys():
        yield spec.names[kind], second.names[kind]
    for key in spec.words.keys() & second.words.keys():
        own_cases, other_cases = spec.words[key].cases, second.words[key].cases
        case = next((case for case in own_cases if case in other_cases), None)
        if case is not None:
            kinds = own_cases[case].names.keys() & other_cases[case].names.keys()
            yield from ((own_cases[case].names[kind], other_cases[case].names[kind]) for kind in kinds)


def mistaken_pairs(own_names: Names, other_names: Names, settled: bool) -> Iterator[tuple[Fact, Fact]]:
    """Yield pairs of different names of one item if one must be a mistake.

    This is the case if the other reader uses the name for another item, if the two differ in one letter, or if all
    names are ``settled``.
    """
    used_names = {name.value for name in other_names.values()}
    for key, own_name in own_names.items():
        other_name = other_names.get(key)
        if other_name is None or other_name.value == own_name.value:
            continue
        if settled or own_name.value in used_names or _is_misspelling(str(own_name.value), str(other_name.value)):
            yield own_name, other_name


def _is_misspelling(name: str, other_name: str) -> bool:
    """Return True if two different names differ by one extra, missing or wrong letter, or two swapped ones."""
    short, long = sorted((name, other_name), key=len)
    if len(short) < len(long):
        return any(long[:index] + long[index + 1 :] == short for index in range(len(long)))
    differing = [index for index, letters in enumerate(zip(name, other_name, strict=True)) if letters[0] != letters[1]]
    first, end = differing[0], differing[-1] + 1
    return end - first == 1 or (end - first == 2 and name[first:end] == other_name[first:end][::-1])
