"""Compare two readings fact by fact: equal facts, different facts, and facts that only the first has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import partial
from itertools import chain

from ..changes.pairs import by_key
from ..language.problems import Path
from ..say.numbers import first_of
from ..say.place import bits
from .cited import NUMBERS
from .fact import NOTHING, Bit, Case, Fact, Facts, Key, Names, Placed, Sort, Value, Word
from .frame_bits import continues, run
from .mistaken_names import are_settled, mistaken
from .reading import same_name

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
    near: Path = ()


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

    def differ(self, found: Disagreement) -> None:
        """Add a disagreement, once."""
        if found.place:
            self.note(found.sort, found.place, Read.OTHERWISE)
        if found not in self.disagreements:
            self.disagreements.append(found)


def compare(spec: Facts, second: Facts) -> Comparison:
    """Compare the facts of a spec with those of its second reading."""
    made = Comparison(settled=are_settled(spec, second))
    near = partial(_near, made, spec, second)
    facts = _compare_facts(made, spec.facts, second.facts | dict(_by_path(spec, second)), near)
    for found in chain(facts, _codes_differ(spec, second), _compare_names(made, spec.names, second.names)):
        made.differ(found)
    for key, word in spec.words.items():
        orders = {str(fact.value) for each in (spec, second) if (fact := each.facts.get((*key, "order")))}
        # Of frames with different byte orders, only that is reported.
        if len(orders) < 2:
            _compare_words(made, word, second.words.get(key))
    _mark(made, spec, second)
    return made


def _near(made: Comparison, spec: Facts, second: Facts, fact: Fact) -> Path | None:
    """Return the place where the spec would state a fact of the second reading, or None if the spec may lack it.

    This is its subject, or the only item of the same kind that the second reading lacks, or the list of such items.
    """
    # Missing order codes are reported together.
    if fact.key[0] == "code" or (fact.mild and not (made.settled and fact.key[0] in _OWN)):
        return None
    if fact.under:
        # If the subject is missing, only that is reported.
        return spec.facts[fact.under].place if fact.under in spec.facts else None
    alike = (item for key, item in spec.facts.items() if item.sort is fact.sort and key[:2] == fact.key[:2])
    alone = [item for item in alike if not item.under and item.key not in second.facts]
    return alone[0].place if len(alone) == 1 else _container(fact.place)


def _container(place: Path) -> Path:
    """Return the nearest list or map around a place that exists in any spec."""
    if place[0] in ("interfaces", "manual"):
        return place[:3] if len(place) > 2 and isinstance(place[2], str) else place[:2]
    return place[:1]


def _by_path(spec: Facts, second: Facts) -> Iterator[tuple[Key, Fact]]:
    """Yield the facts that the second reading gives by paths: numbers in texts, and sections."""
    paths = {_dotted(fact.place): fact for fact in spec.facts.values() if fact.sort in _WORDS}
    for path, (value, place) in second.found.items():
        own = paths.get(path) or Fact(Sort.TEXT, (NUMBERS, path), "", f"numbers in {path}", ())
        yield own.key, replace(own, value=value, place=place)
    for key, fact in spec.facts.items():
        if fact.sort is Sort.SECTION and _dotted(fact.place) not in second.found:
            around = (_dotted(fact.place[:end]) for end in range(len(fact.place), 0, -1))
            if sections := next((second.sections[path] for path in around if path in second.sections), None):
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


def _codes_differ(spec: Facts, second: Facts) -> Iterator[Disagreement]:
    """Yield one disagreement for all order codes that only the spec has, and one for those that it lacks."""
    own, other = ({key: item for key, item in each.facts.items() if key[0] == "code"} for each in (spec, second))
    for mine, theirs in ((own, other), (other, own)):
        alone = [fact for key, fact in mine.items() if key not in theirs]
        if alone and theirs:
            fact, known = alone[0], next(iter(theirs.values()))
            what = fact.what + (f" and of {len(alone) - 1} more" if len(alone) > 1 else "")
            if mine is own:
                yield Disagreement(fact.sort, what, _shown(fact.value), NOTHING, fact.place, known.place)
            else:
                yield _lacking(replace(fact, what=what), known.place)


def _lacking(fact: Fact, near: Path) -> Disagreement:
    """Return the disagreement on a fact that only the second reading has."""
    return Disagreement(fact.sort, fact.what, NOTHING, _shown(fact.value), (), fact.place, near)


def _compare_names(made: Comparison, spec: Mapping[Key, Names], second: Mapping[Key, Names]) -> Iterator[Disagreement]:
    for kind, names in spec.items():
        for own, other in mistaken(names, second.get(kind, {}), made.settled):
            yield Disagreement(own.sort, own.what, f"'{own.value}'", f"'{other.value}'", own.place, other.place)


def _shown(value: Value) -> str:
    return value if isinstance(value, str) else next(iter(value.values()), NOTHING)


def _everywhere(value: Value) -> Value:
    """Return the common value if all cases have the same one, otherwise all values."""
    found = {value} if isinstance(value, str) else set(value.values())
    return found.pop() if len(found) == 1 else value


def _compare_facts(
    made: Comparison, own: Mapping[Key, Fact], other: Mapping[Key, Fact], near: Callable[[Fact], Path | None]
) -> Iterator[Disagreement]:
    """Compare facts by their keys. ``near`` returns the place of one that the spec lacks, or None if it may do so."""
    for key, theirs, fact in by_key(other, own):
        if fact is not None and not fact.implied:
            if theirs is not None:
                yield from _compare_values(made, fact, theirs)
            elif key[0] not in _OWN:
                made.note(fact.sort, fact.place, Read.ONCE)
        elif theirs is not None and not theirs.implied:
            place = near(theirs) if fact is None else fact.place
            if place is not None:
                yield _lacking(theirs, place)


def _compare_values(made: Comparison, fact: Fact, other: Fact) -> Iterator[Disagreement]:
    own, theirs = _everywhere(fact.value), _everywhere(other.value)
    places = fact.place, other.place
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
        yield Disagreement(fact.sort, fact.what + _with(wrong), *values, *places)
    made.note(fact.sort, fact.place, Read.ONCE if missing else Read.TWICE)


def _with(cases: list[Case]) -> str:
    """Return the text on the order codes and the state of the registers."""
    state = cases[0][1]
    held = f" while {state}" if state else ""
    codes = dict.fromkeys(code for code, _ in cases)
    return f", for {first_of([*codes], 1)}{held}"


def _compare_words(made: Comparison, word: Word, other: Word | None) -> None:
    """Compare a frame or register in every case. Each difference is reported for the first case that shows it."""
    others = other.cases if other is not None else {}
    whole = other.everywhere if other is not None and word.everywhere is not None else None
    alike: dict[tuple[int, int], list[Disagreement]] = {}
    # A disagreement is the same in other cases if it has the same places, class, and number among those with these.
    told: dict[tuple[Path, Path, Sort, int], tuple[Disagreement, list[Case]]] = {}
    for case, placed in word.cases.items():
        theirs = whole or others.get(case)
        if theirs is None:
            if not case[1] or placed is not word.cases.get((case[0], "")):
                _note_all(made, placed)
            continue
        same = id(placed), id(theirs)
        if same not in alike:
            alike[same] = list(_in_case(made, word, placed, theirs))
        counts: Counter[tuple[Path, Path, Sort]] = Counter()
        for found in alike[same]:
            kind = found.place, found.second, found.sort
            counts[kind] += 1
            told.setdefault((*kind, counts[kind]), (found, []))[1].append(case)
    for found, cases in told.values():
        is_everywhere = len(cases) == len(word.cases)
        made.differ(found if is_everywhere else replace(found, what=found.what + _with(cases)))


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
        yield Disagreement(Sort.POSITION, what, run(mine), run(theirs), mine[0].place, theirs[0].place)
    for one, two in zip(own.bits, other.bits, strict=True):
        if _alike(one, two):
            made.note(Sort.POSITION, one.place, Read.TWICE)
    for span, properties in own.fields.items():
        near = next((fact.place for fact in properties.values()), word.place)
        yield from _compare_facts(made, properties, other.fields.get(span, {}), partial(_unless_mild, near))
    yield from _compare_names(made, own.names, other.names)


def _unless_mild(near: Path, fact: Fact) -> Path | None:
    return None if fact.mild else near


def _alike(one: Bit, other: Bit) -> bool:
    return (one.part, one.weight, one.fixed) == (other.part, other.weight, other.fixed)


def _runs(own: tuple[Bit, ...], other: tuple[Bit, ...]) -> list[tuple[int, int]]:
    """Return ranges of different bits, grouped if they differ in the same way."""
    found: list[tuple[int, int]] = []
    for index in range(len(own) - 1, -1, -1):
        if _alike(own[index], other[index]):
            continue
        if found and found[-1][1] == index + 1 and all(continues(*side[index : index + 2]) for side in (own, other)):
            found[-1] = found[-1][0], index
        else:
            found.append((index, index))
    return found
