"""Compare two readings fact by fact: equal facts, different facts, and facts that only the first has."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import partial
from typing import Any

from ..changes.pairs import paired
from ..language.problems import Path
from ..say.numbers import first_of
from .cited import NUMBERS
from .fact import NOTHING, Bit, Case, Fact, Facts, Key, Names, Placed, Sort, Value, Word
from .frame_bits import continues, run
from .mistaken_names import are_settled, mistaken
from .printed_names import same_name
from .reading import bits

#: Items that each reader defines as needed, so that none is missing if the other has a different set.
_OWN = frozenset(("parameter",))
#: Classes of facts in words, which a second reading can also give by their paths.
_WORDS = frozenset((Sort.TEXT, Sort.SECTION))


class Read(IntEnum):
    """How often a fact was read, best first. For a place with several facts, the worst applies."""

    TWICE = 0
    DECIDED = 1
    EXPLAINED = 2
    ONCE = 3
    OTHERWISE = 4


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A fact with different values in the readings. ``place`` is in the spec, ``second`` in the second reading.

    A place is empty if a reading lacks the fact. ``near`` is then the place where it would be.
    """

    sort: Sort
    what: str
    used: str
    other: str
    place: Path
    second: Path
    near: Path
    codes: int = 0


@dataclass(slots=True)
class Comparison:
    """The result: each place of the spec by class and how often it was read, and the disagreements.

    ``settled`` is set if the second reading uses the names of the spec.
    """

    read: dict[tuple[Sort, Path], Read] = field(default_factory=dict)
    disagreements: list[Disagreement] = field(default_factory=list)
    settled: bool = False

    def note(self, sort: Sort, place: Path, read: Read) -> None:
        """Count a fact of the spec."""
        key = sort, place
        self.read[key] = max(read, self.read.get(key, Read.TWICE))


def compare(spec: Facts, second: Facts) -> Comparison:
    """Compare the facts of a spec with those of its second reading."""
    made = Comparison(settled=are_settled(spec, second))

    def near(fact: Fact) -> Path | None:
        # Missing order codes are reported together.
        is_free = fact.key[0] == "code" or (fact.mild and not (made.settled and fact.key[0] in _OWN))
        # If the subject is missing, only that is reported.
        has_holder = not fact.under or fact.under in spec.facts
        return _near(fact, spec, second) if has_holder and not is_free else None

    for found in _compare_facts(made, spec.facts, second.facts | dict(_by_path(spec, second)), near):
        _differ(made, found)
    for found in _codes_differ(spec, second):
        _differ(made, found)
    for found in _compare_names(made, spec.names, second.names):
        _differ(made, found)
    for key, word in spec.words.items():
        if _same_order(spec.facts.get((*key, "order")), second.facts.get((*key, "order"))):
            _compare_words(made, word, second.words.get(key))
    _mark(made, spec, second)
    return made


def _by_path(spec: Facts, second: Facts) -> Iterator[tuple[Key, Fact]]:
    """Yield the facts that the second reading gives by paths: numbers in texts, and sections."""
    paths = {_dotted(fact.place): fact for fact in spec.facts.values() if fact.sort in _WORDS}
    for path, (value, place) in second.found.items():
        own = paths.get(path) or Fact(Sort.TEXT, (NUMBERS, path), "", f"numbers in {path}", ())
        yield own.key, replace(own, value=value, place=place)
    for key, fact in spec.facts.items():
        steps = fact.place
        if fact.sort is Sort.SECTION and _dotted(steps) not in second.found:
            path = next(
                (path for end in range(len(steps), 0, -1) if (path := _dotted(steps[:end])) in second.sections), ""
            )
            if path:
                sections = second.sections[path]
                yield key, replace(fact, value=", ".join(sorted(sections)), place=("sections", sections[0]))


def _dotted(place: Path) -> str:
    return ".".join(map(str, place))


def _mark(made: Comparison, spec: Facts, second: Facts) -> None:
    """Count facts that no manual prints as decided, and texts of which only a name was compared as read once."""
    for (sort, place), read in made.read.items():
        path = _dotted(place)
        if read is not Read.TWICE:
            continue
        is_name = sort is Sort.CHARACTERISTIC and len(place) == 2 and (NUMBERS, *place, "value") not in spec.facts
        if is_name or (sort in _WORDS and path in second.found):
            made.read[sort, place] = Read.ONCE
        elif sort not in _WORDS and any(
            sort.value == item or f"{path}.".startswith(f"{item}.") for item in second.decided
        ):
            made.read[sort, place] = Read.DECIDED


def _key(item: tuple[Any, Any]) -> Any:
    """Return the key of a fact, which identifies it in both readings."""
    return item[0]


def _codes_alone(own: Facts, other: Facts) -> tuple[Fact, str, Path] | None:
    """Return the first order code that only one reading has, the text for all such codes, and the other's place."""
    alone = [fact for key, fact in own.facts.items() if key[0] == "code" and key not in other.facts]
    known = [fact for key, fact in other.facts.items() if key[0] == "code"]
    if not alone or not known:
        return None
    return alone[0], alone[0].what + (f" and of {len(alone) - 1} more" if len(alone) > 1 else ""), known[0].place


def _codes_differ(spec: Facts, second: Facts) -> Iterator[Disagreement]:
    """Yield one disagreement for all order codes that only the spec has, and one for those that it lacks."""
    if found := _codes_alone(spec, second):
        fact, what, place = found
        yield Disagreement(Sort.ORDER_CODE, what, _shown(fact.value), NOTHING, fact.place, place, ())
    if found := _codes_alone(second, spec):
        fact, what, near = found
        yield Disagreement(Sort.ORDER_CODE, what, NOTHING, _shown(fact.value), (), fact.place, near)


def _compare_names(made: Comparison, spec: Mapping[Key, Names], second: Mapping[Key, Names]) -> Iterator[Disagreement]:
    for kind, names in spec.items():
        for own, other in mistaken(names, second.get(kind, {}), made.settled):
            yield Disagreement(own.sort, own.what, f"'{own.name}'", f"'{other.name}'", own.place, other.place, ())


def _same_order(own: Fact | None, other: Fact | None) -> bool:
    """Return True if two frames can be compared bit by bit. Otherwise only their different byte order is reported."""
    return own is None or other is None or own.value == other.value


def _near(fact: Fact, spec: Facts, second: Facts) -> Path:
    """Return the place where the spec would state the fact.

    This is its subject, or the only item of the same kind that the second reading lacks, or the list of such items.
    """
    if fact.under:
        return spec.facts[fact.under].place
    alike = (item for key, item in spec.facts.items() if item.sort is fact.sort and key[:2] == fact.key[:2])
    alone = [item for item in alike if not item.under and item.key not in second.facts]
    return alone[0].place if len(alone) == 1 else _container(fact.place)


def _container(place: Path) -> Path:
    """Return the nearest list or map around a place that exists in any spec."""
    if place[0] in ("interfaces", "manual"):
        return place[:3] if len(place) > 2 and isinstance(place[2], str) else place[:2]
    return place[:1]


def _shown(value: Value) -> str:
    return value if isinstance(value, str) else next(iter(value.values()), NOTHING)


def _differ(made: Comparison, found: Disagreement) -> None:
    if found.place:
        made.note(found.sort, found.place, Read.OTHERWISE)
    if found not in made.disagreements:
        made.disagreements.append(found)


def _everywhere(value: Value) -> Value:
    """Return the common value if all cases have the same one, otherwise all values."""
    found = {value} if isinstance(value, str) else set(value.values())
    return found.pop() if len(found) == 1 else value


def _compare_facts(
    made: Comparison, own: Mapping[Key, Fact], other: Mapping[Key, Fact], near: Callable[[Fact], Path | None]
) -> Iterator[Disagreement]:
    """Compare facts by their keys. ``near`` returns the place of one that the spec lacks, or None if it may do so."""
    for pair in paired(list(own.items()), list(other.items()), name=_key):
        key, fact = pair.first
        theirs = pair.new[1] if pair.new is not None else None
        if pair.old is None:
            place = near(fact) if not fact.implied else None
            if place is not None:
                yield Disagreement(fact.sort, fact.what, NOTHING, _shown(fact.value), (), fact.place, place)
        elif fact.implied:
            if theirs is not None and not theirs.implied:
                yield Disagreement(fact.sort, fact.what, NOTHING, _shown(theirs.value), (), theirs.place, fact.place)
        elif theirs is not None:
            yield from _compare_values(made, fact, theirs)
        elif key[0] not in _OWN:
            made.note(fact.sort, fact.place, Read.ONCE)


def _compare_values(made: Comparison, fact: Fact, other: Fact) -> Iterator[Disagreement]:
    own, theirs = _everywhere(fact.value), _everywhere(other.value)
    places = fact.place, other.place, ()
    if isinstance(own, str) or isinstance(theirs, str):
        values = _shown(own), _shown(theirs)
        if own == theirs or (fact.sort is Sort.PRINTED and same_name(*values)):
            made.note(fact.sort, fact.place, Read.TWICE)
        else:
            yield Disagreement(fact.sort, fact.what, *values, *places)
        return
    common = [case for case in own if case in theirs]
    missing = [case for case in own if case not in theirs and not (case[1] and own[case] == own.get((case[0], "")))]
    wrong = [case for case in common if own[case] != theirs[case]]
    if wrong:
        values = own[wrong[0]], theirs[wrong[0]]
        yield Disagreement(fact.sort, fact.what + _with(wrong), *values, *places, len(wrong))
    made.note(fact.sort, fact.place, Read.ONCE if missing else Read.TWICE)


def _with(cases: list[Case]) -> str:
    """Return the text on the order codes and the state of the registers."""
    state = cases[0][1]
    held = f" while {state}" if state else ""
    codes = dict.fromkeys(code for code, _ in cases)
    return f", for {first_of([*codes], 1)}{held}"


#: Identity of a disagreement across cases: places, class, and its index among those with the same ones.
_Kind = tuple[Path, Path, Sort, int]


def _compare_words(made: Comparison, word: Word, other: Word | None) -> None:
    """Compare a frame or register in every case. Each difference is reported for the first case that shows it."""
    told: dict[_Kind, tuple[Disagreement, list[Case]]] = {}
    seen: dict[tuple[int, int], list[_Kind]] = {}
    others = other.cases if other is not None else {}
    whole = other.everywhere if other is not None and word.everywhere is not None else None
    for case, placed in word.cases.items():
        theirs = whole or others.get(case)
        if theirs is None:
            if not case[1] or placed is not word.cases.get((case[0], "")):
                _note_all(made, placed)
            continue
        same = id(placed), id(theirs)
        if same not in seen:
            seen[same] = []
            for found in _in_case(made, word, placed, theirs):
                count = sum(kind[:3] == (found.place, found.second, found.sort) for kind in seen[same])
                kind = found.place, found.second, found.sort, count
                told.setdefault(kind, (found, []))
                seen[same].append(kind)
        for kind in seen[same]:
            told[kind][1].append(case)
    every = len(word.cases)
    for found, cases in told.values():
        what = found.what + (_with(cases) if len(set(cases)) < every else "")
        _differ(made, Disagreement(found.sort, what, found.used, found.other, found.place, found.second, found.near))


def _note_all(made: Comparison, placed: Placed) -> None:
    for bit in placed.bits:
        made.note(Sort.POSITION, bit.place, Read.ONCE)
    for properties in placed.fields.values():
        for fact in properties.values():
            made.note(fact.sort, fact.place, Read.ONCE)


def _in_case(made: Comparison, word: Word, own: Placed, other: Placed) -> Iterator[Disagreement]:
    """Yield the differences in one case. Different lengths are reported with the other facts."""
    if len(own.bits) != len(other.bits):
        return
    for high, low in _runs(own.bits, other.bits):
        mine, theirs = own.bits[low : high + 1][::-1], other.bits[low : high + 1][::-1]
        what = f"{bits(high, low)} of {word.what}"
        yield Disagreement(Sort.POSITION, what, run(mine), run(theirs), mine[0].place, theirs[0].place, ())
    for one, two in zip(own.bits, other.bits, strict=True):
        if _alike(one, two):
            made.note(Sort.POSITION, one.place, Read.TWICE)
    for span, properties in own.fields.items():
        near = next((fact.place for fact in properties.values()), word.place)
        yield from _compare_facts(made, properties, other.fields.get(span, {}), partial(_if_not_mild, near))
    yield from _compare_names(made, own.names, other.names)


def _if_not_mild(near: Path, fact: Fact) -> Path | None:
    return None if fact.mild else near


def _alike(one: Bit, other: Bit) -> bool:
    return (one.part, one.weight, one.fixed) == (other.part, other.weight, other.fixed)


def _runs(own: tuple[Bit, ...], other: tuple[Bit, ...]) -> Iterator[tuple[int, int]]:
    """Yield ranges of different bits, grouped if they differ in the same way."""
    high: int | None = None
    for index in range(len(own) - 1, -1, -1):
        if _alike(own[index], other[index]):
            if high is not None:
                yield high, index + 1
            high = None
        elif high is None:
            high = index
        elif not all(
            continues(side[index + 1], side[index]) and side[index + 1].place == side[index].place
            for side in (own, other)
        ):
            yield high, index + 1
            high = index
    if high is not None:
        yield high, 0
