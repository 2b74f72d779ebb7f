"""Compare two readings fact by fact, also the numbers and sources of their texts.

They are compared by their places in the file, because two readers use different words for them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import partial
from itertools import chain
from typing import Any

from ..changes.pairs import by_key
from ..language.document import Path, label_of
from ..language.schema_files import PROSE
from ..loading.from_mapping import parse_sources
from ..say.names_and_places import bits
from ..say.plain_text import first_of
from .frame_bits import continues_item, describe_bits
from .reading import (
    NOTHING,
    Bit,
    Case,
    Fact,
    Facts,
    Key,
    Names,
    Reading,
    Sort,
    Value,
    Word,
    WordCase,
    are_settled,
    mistaken_pairs,
    same_name,
)

#: First part of the keys of numbers in texts, and of cited sections.
NUMBERS, CITED = "numbers", "cited"
_UNITS = (
    r"(?:[mµ]?[VA](?:pp)?|[km]?Nm|[mckµ]?m(?:²|/s)?|[mµn]?s|min(?:ute)?s?|[kMG]?Hz|°[CF]?|%|[kM]?Ω(?:/km)?|AWG|k?g)"
)
_NUMBER = re.compile(rf"[±−+-]?(?:[^\W\d_][\w-]*)?\d[\w.,-]*(?:/s|/km|²| ?{_UNITS}(?!\w))?")
#: Maps of a second reading by path, which are not texts.
_WITHOUT = frozenset((("found",), ("sections",)))
_TEXTS = PROSE | {"printed", "used"}
_COMMA = re.compile(r"(?<=\d),(?=\d{3}(?!\d))")


def numbers_in(text: str) -> str:
    """Return the numbers in a text, each with its unit, in their order. Empty if there is none."""
    numbers = (match.rstrip(".,-").replace(" ", "").lstrip("+") for match in _NUMBER.findall(_COMMA.sub("", text)))
    return " ".join(numbers).replace("−", "-")


def contents(reading: Reading) -> Iterator[Fact]:
    """Yield the page of every section and entry in the table of contents."""
    for section, section_contents in reading.document.data["manual"].get("contents", {}).items():
        place: Path = ("manual", "contents", section)
        pages = {(*place, "page"): section_contents.get("page")}
        pages |= {(*place, "entries", name): page for name, page in section_contents.get("entries", {}).items()}
        for path, page in pages.items():
            if page is not None:
                description = f"page of {'.'.join(map(str, path[2:]))} in the contents"
                yield Fact(Sort.CONTENTS, ("contents", *path), str(page), description, path)


def texts(reading: Reading) -> Iterator[Fact]:
    """Yield the numbers in every text, and the sections that every source cites."""
    for place, text in _texts((), reading.document.data):
        if value := _compared_text(place[-1], text):
            is_source, path_text = _is_source(place[-1]), ".".join(map(str, place))
            key, description = (CITED, "section cited at") if is_source else (NUMBERS, "numbers in")
            yield Fact(
                Sort.SECTION if is_source else Sort.TEXT, (key, *place), value, f"{description} {path_text}", place
            )


def _is_source(key: str | int) -> bool:
    return key == "source" or str(key).endswith("_source")


def _compared_text(key: str | int, text: str) -> str:
    """Return what is compared of a text: its numbers, or the sections of the manual itself that a source cites."""
    if not _is_source(key):
        return numbers_in(text)
    return ", ".join(sorted({cited.section for cited in parse_sources(text) if not cited.document and cited.section}))


def by_path(reading: Reading) -> dict[str, tuple[str, Path]]:
    """Return what a second reading gives for texts and sources by their paths, with the places there."""
    numbers_and_places: dict[str, tuple[str, Path]] = {}
    for path, text in reading.document.data.get("found", {}).items():
        key = path.rpartition(".")[2]
        numbers_and_places[path] = (_compared_text(key, text), ("found", path))
    return numbers_and_places


def sections_by_path(reading: Reading) -> dict[str, list[str]]:
    """Return the sections that a second reading gives for everything under a path."""
    cited_sections: dict[str, list[str]] = {}
    for section, paths in reading.document.data.get("sections", {}).items():
        for path in paths:
            cited_sections.setdefault(path, []).append(section)
    return cited_sections


def _texts(place: Path, node: Any) -> Iterator[tuple[Path, str]]:
    """Yield every text and source, with its place by names."""
    if isinstance(node, dict):
        for key, value in node.items():
            if (*place, key) not in _WITHOUT:
                yield from _texts((*place, key), value)
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _texts((*place, label_of(value) or index), value)
    elif isinstance(node, str) and (place[-1] in _TEXTS or (place[0], place[-1]) == ("characteristics", "value")):
        yield place, node


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
    description: str
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

    def differ(self, disagreement: Disagreement) -> None:
        """Add a disagreement, once."""
        if disagreement.place:
            self.note(disagreement.sort, disagreement.place, Read.OTHERWISE)
        if disagreement not in self.disagreements:
            self.disagreements.append(disagreement)


def compare(spec: Facts, second: Facts) -> Comparison:
    """Compare the facts of a spec with those of its second reading."""
    comparison = Comparison(settled=are_settled(spec, second))
    near = partial(_nearest_place, comparison, spec, second)
    differences = _compare_facts(comparison, spec.facts, second.facts | dict(_by_path(spec, second)), near)
    for disagreement in chain(
        differences, _codes_differ(spec, second), _compare_names(comparison, spec.names, second.names)
    ):
        comparison.differ(disagreement)
    for key, word in spec.words.items():
        facts_on_order = [facts.get((*key, "order")) for facts in (spec.facts, second.facts)]
        orders = {str(fact.value) for fact in facts_on_order if fact is not None}
        # Of frames with different byte orders, only that is reported.
        if len(orders) < 2:
            _compare_words(comparison, word, second.words.get(key))
    _count_decided(comparison, spec, second)
    return comparison


def _nearest_place(comparison: Comparison, spec: Facts, second: Facts, fact: Fact) -> Path | None:
    """Return the place where the spec would state a fact of the second reading, or None if the spec may lack it.

    This is its subject, or the only item of the same kind that the second reading lacks, or the list of such items.
    """
    # Missing order codes are reported together.
    if fact.key[0] == "code" or (fact.mild and not (comparison.settled and fact.key[0] in _OWN)):
        return None
    if fact.under:
        # If the subject is missing, only that is reported.
        return spec.facts[fact.under].place if fact.under in spec.facts else None
    same_kind = (candidate for key, candidate in spec.facts.items() if key[:2] == fact.key[:2])
    similar = (candidate for candidate in same_kind if candidate.sort is fact.sort)
    candidates = [candidate for candidate in similar if not candidate.under and candidate.key not in second.facts]
    return candidates[0].place if len(candidates) == 1 else _container(fact.place)


def _container(place: Path) -> Path:
    """Return the nearest list or map around a place that exists in any spec."""
    if place[0] in ("interfaces", "manual"):
        return place[:3] if len(place) > 2 and isinstance(place[2], str) else place[:2]
    return place[:1]


def _by_path(spec: Facts, second: Facts) -> Iterator[tuple[Key, Fact]]:
    """Yield the facts that the second reading gives by paths: numbers in texts, and sections."""
    paths = {_dotted(fact.place): fact for fact in spec.facts.values() if fact.sort in _WORDS}
    for path, (value, place) in second.printed_numbers.items():
        spec_fact = paths.get(path) or Fact(Sort.TEXT, (NUMBERS, path), "", f"numbers in {path}", ())
        yield spec_fact.key, replace(spec_fact, value=value, place=place)
    for key, fact in spec.facts.items():
        if fact.sort is Sort.SECTION and _dotted(fact.place) not in second.printed_numbers:
            enclosing_paths = (_dotted(fact.place[:end]) for end in range(len(fact.place), 0, -1))
            if sections := next((second.sections[path] for path in enclosing_paths if path in second.sections), None):
                yield key, replace(fact, value=", ".join(sorted(sections)), place=("sections", sections[0]))


def _dotted(place: Path) -> str:
    return ".".join(map(str, place))


def _count_decided(comparison: Comparison, spec: Facts, second: Facts) -> None:
    """Count facts that no manual prints as decided, and texts of which only a name was compared as read once."""
    for (sort, place), read in comparison.read.items():
        path = _dotted(place)
        if read is not Read.TWICE:
            continue
        is_name = sort is Sort.CHARACTERISTIC and len(place) == 2 and (NUMBERS, *place, "value") not in spec.facts
        if is_name or (sort in _WORDS and path in second.printed_numbers):
            comparison.read[sort, place] = Read.ONCE
        elif sort not in _WORDS and _is_decided(sort, path, second.decided):
            comparison.read[sort, place] = Read.DECIDED


def _is_decided(sort: Sort, path: str, decided: Sequence[str]) -> bool:
    """Return True if ``decided`` contains the class of a fact, its path or a path above it."""
    return sort.value in decided or any(f"{path}.".startswith(f"{decided_path}.") for decided_path in decided)


def _codes_of(facts: Facts) -> dict[Key, Fact]:
    return {key: fact for key, fact in facts.facts.items() if key[0] == "code"}


def _codes_differ(spec: Facts, second: Facts) -> Iterator[Disagreement]:
    """Yield one disagreement for all order codes that only the spec has, and one for those that it lacks."""
    spec_codes, second_codes = _codes_of(spec), _codes_of(second)
    for codes, other_codes in ((spec_codes, second_codes), (second_codes, spec_codes)):
        missing = [fact for key, fact in codes.items() if key not in other_codes]
        if missing and other_codes:
            fact, known_fact = missing[0], next(iter(other_codes.values()))
            description = fact.description + (f" and of {len(missing) - 1} more" if len(missing) > 1 else "")
            if codes is spec_codes:
                yield Disagreement(
                    fact.sort, description, _value_text(fact.value), NOTHING, fact.place, known_fact.place
                )
            else:
                yield _missing_in_spec(replace(fact, description=description), known_fact.place)


def _missing_in_spec(fact: Fact, near: Path) -> Disagreement:
    """Return the disagreement on a fact that only the second reading has."""
    return Disagreement(fact.sort, fact.description, NOTHING, _value_text(fact.value), (), fact.place, near)


def _compare_names(
    comparison: Comparison, spec: Mapping[Key, Names], second: Mapping[Key, Names]
) -> Iterator[Disagreement]:
    for kind, names in spec.items():
        for own_name, other_name in mistaken_pairs(names, second.get(kind, {}), comparison.settled):
            yield Disagreement(
                own_name.sort,
                own_name.description,
                f"'{own_name.value}'",
                f"'{other_name.value}'",
                own_name.place,
                other_name.place,
            )


def _value_text(value: Value) -> str:
    return value if isinstance(value, str) else next(iter(value.values()), NOTHING)


def _common_value(value: Value) -> Value:
    """Return the common value if all cases have the same one, otherwise all values."""
    distinct = {value} if isinstance(value, str) else set(value.values())
    return distinct.pop() if len(distinct) == 1 else value


def _compare_facts(
    comparison: Comparison,
    own_facts: Mapping[Key, Fact],
    other_facts: Mapping[Key, Fact],
    near: Callable[[Fact], Path | None],
) -> Iterator[Disagreement]:
    """Compare facts by their keys. ``near`` returns the place of one that the spec lacks, or None if it may do so."""
    for key, other_fact, fact in by_key(other_facts, own_facts):
        if fact is not None and not fact.implied:
            if other_fact is not None:
                yield from _compare_values(comparison, fact, other_fact)
            elif key[0] not in _OWN:
                comparison.note(fact.sort, fact.place, Read.ONCE)
        elif other_fact is not None and not other_fact.implied:
            place = near(other_fact) if fact is None else fact.place
            if place is not None:
                yield _missing_in_spec(other_fact, place)


def _compare_values(comparison: Comparison, fact: Fact, other_fact: Fact) -> Iterator[Disagreement]:
    own_value, other_value = _common_value(fact.value), _common_value(other_fact.value)
    places = fact.place, other_fact.place
    if isinstance(own_value, str) or isinstance(other_value, str):
        values = _value_text(own_value), _value_text(other_value)
        if own_value == other_value or (fact.sort is Sort.PRINTED and same_name(*values)):
            comparison.note(fact.sort, fact.place, Read.TWICE)
        else:
            yield Disagreement(fact.sort, fact.description, *values, *places)
        return
    common = [case for case in own_value if case in other_value]
    missing = [case for case in own_value if case not in other_value and not _is_default(own_value, case)]
    differing = [case for case in common if own_value[case] != other_value[case]]
    if differing:
        values = own_value[differing[0]], other_value[differing[0]]
        yield Disagreement(fact.sort, fact.description + _cases_text(differing), *values, *places)
    comparison.note(fact.sort, fact.place, Read.ONCE if missing else Read.TWICE)


def _is_default(value: Mapping[Case, str], case: Case) -> bool:
    """Return True if a fact has the same value in a state of the registers as with the factory defaults."""
    code, state = case
    return state != "" and value[case] == value.get((code, ""))


def _cases_text(cases: list[Case]) -> str:
    """Return the text on the order codes and the state of the registers."""
    state = cases[0][1]
    while_text = f" while {state}" if state else ""
    codes = dict.fromkeys(code for code, _ in cases)
    return f", for {first_of([*codes], 1)}{while_text}"


def _compare_words(comparison: Comparison, word: Word, other_word: Word | None) -> None:
    """Compare a frame or register in every case. Each difference is reported for the first case that shows it."""
    other_cases = other_word.cases if other_word is not None else {}
    placed_everywhere = other_word.everywhere if other_word is not None and word.everywhere is not None else None
    disagreements_by_pair: dict[tuple[int, int], list[Disagreement]] = {}
    # A disagreement is the same in other cases if it has the same places, class, and number among those with these.
    first_cases: dict[tuple[Path, Path, Sort, int], tuple[Disagreement, list[Case]]] = {}
    for case, placed in word.cases.items():
        other_placed = placed_everywhere or other_cases.get(case)
        if other_placed is None:
            if not case[1] or placed is not word.cases.get((case[0], "")):
                _note_all(comparison, placed)
            continue
        pair = id(placed), id(other_placed)
        if pair not in disagreements_by_pair:
            disagreements_by_pair[pair] = list(_in_case(comparison, word, placed, other_placed))
        counts: Counter[tuple[Path, Path, Sort]] = Counter()
        for disagreement in disagreements_by_pair[pair]:
            kind = disagreement.place, disagreement.second, disagreement.sort
            counts[kind] += 1
            first_cases.setdefault((*kind, counts[kind]), (disagreement, []))[1].append(case)
    for disagreement, cases in first_cases.values():
        is_everywhere = len(cases) == len(word.cases)
        comparison.differ(
            disagreement
            if is_everywhere
            else replace(disagreement, description=disagreement.description + _cases_text(cases))
        )


def _note_all(comparison: Comparison, placed: WordCase) -> None:
    for bit in placed.bits:
        comparison.note(Sort.POSITION, bit.place, Read.ONCE)
    for properties in placed.fields.values():
        for fact in properties.values():
            comparison.note(fact.sort, fact.place, Read.ONCE)


def _in_case(
    comparison: Comparison, word: Word, own_placed: WordCase, other_placed: WordCase
) -> Iterator[Disagreement]:
    """Yield the differences in one case. Different lengths are reported with the other facts."""
    if len(own_placed.bits) != len(other_placed.bits):
        return
    for high, low in _different_ranges(own_placed.bits, other_placed.bits):
        own_bits, other_bits = own_placed.bits[low : high + 1][::-1], other_placed.bits[low : high + 1][::-1]
        description = f"{bits(high, low)} of {word.description}"
        yield Disagreement(
            Sort.POSITION,
            description,
            describe_bits(own_bits),
            describe_bits(other_bits),
            own_bits[0].place,
            other_bits[0].place,
        )
    for own_bit, other_bit in zip(own_placed.bits, other_placed.bits, strict=True):
        if _have_same_value(own_bit, other_bit):
            comparison.note(Sort.POSITION, own_bit.place, Read.TWICE)
    for span, properties in own_placed.fields.items():
        near = next((fact.place for fact in properties.values()), word.place)
        yield from _compare_facts(
            comparison, properties, other_placed.fields.get(span, {}), partial(_unless_mild, near)
        )
    yield from _compare_names(comparison, own_placed.names, other_placed.names)


def _unless_mild(near: Path, fact: Fact) -> Path | None:
    return None if fact.mild else near


def _have_same_value(bit: Bit, other_bit: Bit) -> bool:
    return (bit.part, bit.weight, bit.fixed) == (other_bit.part, other_bit.weight, other_bit.fixed)


def _different_ranges(own_bits: tuple[Bit, ...], other_bits: tuple[Bit, ...]) -> list[tuple[int, int]]:
    """Return ranges of different bits, grouped if they differ in the same way."""
    ranges: list[tuple[int, int]] = []
    for index in range(len(own_bits) - 1, -1, -1):
        if _have_same_value(own_bits[index], other_bits[index]):
            continue
        if (
            ranges
            and ranges[-1][1] == index + 1
            and all(continues_item(*side[index : index + 2]) for side in (own_bits, other_bits))
        ):
            ranges[-1] = ranges[-1][0], index
        else:
            ranges.append((index, index))
    return ranges
