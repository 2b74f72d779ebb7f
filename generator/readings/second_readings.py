"""Second readings: find, read, check and compare them, and count how often each fact was read."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple
from decimal import Decimal
from functools import cached_property
from pathlib import Path as File

from ..language.check import check_second
from ..language.document import Document, Path
from ..language.problems import Report, joined_lines, quoted
from ..language.read import read_document
from ..language.schema_files import second_reading_path
from ..loading.device import build_device
from ..loading.overlays import Family
from ..model import Manufacturer, TimesRead
from ..model.record import dataclass
from . import interfaces, order_codes, stated, surroundings, texts
from .compare import Comparison, Disagreement, Read, compare
from .reading import NOTHING, Facts, Reading, Sort
from .related import Related, related


def facts_of(reading: Reading) -> Facts:
    """Return all facts of a reading that can be compared with those of another reader."""
    facts = Facts()
    order_codes.add_codes(reading, facts)
    interfaces.add_interfaces(reading, facts)
    interfaces.add_registers(reading, facts)
    facts.add(stated.procedures(reading))
    facts.add(surroundings.surroundings(reading))
    facts.add(texts.contents(reading))
    facts.add(texts.texts(reading))
    facts.printed_numbers, facts.sections = texts.by_path(reading), texts.sections_by_path(reading)
    facts.decided = reading.document.data.get("decided", ())
    return facts


@dataclass(frozen=True)
class Coverage:
    """Readings of the facts of a family: the comparison with its second reading, and the number of derived facts."""

    family: Family
    outcome: Comparison
    derived: Mapping[Sort, int]

    @property
    def spec(self) -> Document:
        return self.family.document

    @cached_property
    def counts(self) -> Mapping[Sort, TimesRead]:
        """Counts of each class."""
        return {sort: self._count(sort) for sort in Sort}

    def _count(self, sort: Sort) -> TimesRead:
        readings = [read for (counted_sort, _), read in self.outcome.read.items() if counted_sort is sort]
        twice, explained, decided, once = map(readings.count, (Read.TWICE, Read.EXPLAINED, Read.DECIDED, Read.ONCE))
        return TimesRead(twice, explained, decided, once, self.derived.get(sort, 0))

    @property
    def total(self) -> TimesRead:
        """Counts of all classes together."""
        return added(self.counts.values())

    @cached_property
    def once(self) -> Sequence[tuple[Sort, Path]]:
        """Facts that were read once, in the order of the file."""
        read_once = [key for key, read in self.outcome.read.items() if read is Read.ONCE]
        return sorted(read_once, key=lambda key: (self.spec.position(key[1]), key[0].value))

    @property
    def lacking(self) -> list[tuple[Sort, Path]]:
        """Facts that must be read twice but were read once."""
        return [key for key in self.once if key[0].is_needed]


def added(counts: Iterable[TimesRead]) -> TimesRead:
    """Return the sum of several counts."""
    return TimesRead(*map(sum, zip(*map(astuple, (TimesRead(0, 0, 0, 0, 0), *counts)), strict=True)))


RULE = "readings-disagree"
#: A number, and a value with its unit.
_NUMBER = re.compile(r"(?<![\w.,])\d+(?:,\d{3})*(?:\.\d+)?(?![\d,.]*\d)")
_QUANTITY = re.compile(rf"({_NUMBER.pattern}) ([µmn]?s|[kM]?Hz|m?V)(?!\w)")
_MEND = "check the manual; if it prints both, add an erratum with both under 'readings'"

_MEND_TEXT = "remove entries for texts that the spec no longer has"


@dataclass(frozen=True)
class SecondReading:
    """A second reading: its file and its facts, or no facts if it has problems."""

    document: Document
    facts: Facts | None


#: Function that reads the second reading of a family, if there is one, and adds its problems to the report.
Reader = Callable[[Family, Report], SecondReading | None]


def read_beside(family: Family, report: Report) -> SecondReading | None:
    """Read the second reading next to the spec of a family."""
    file = second_reading_path(File(family.document.file))
    document = read_document(file, report) if file.is_file() else None
    return second_of(document, family.device.manufacturer, report) if document is not None else None


def second_of(document: Document, manufacturer: Manufacturer, report: Report) -> SecondReading:
    """Return the second reading in a document, and add its problems to ``report``."""
    problems_before = len(report)
    data = check_second(document, report)
    device = build_device(data, manufacturer, report.for_document(document)) if data is not None else None
    is_valid = device is not None and len(report) == problems_before
    return SecondReading(document, facts_of(Reading(device, document)) if device is not None and is_valid else None)


def comparable_specs(families: Iterable[Family], report: Report) -> frozenset[str]:
    """Return the files of the families without problems in their facts so far, which can be compared."""
    valid_families = (family for family in families if not report.faults((family.plain or family).document))
    return frozenset(family.document.file for family in valid_families)


def compare_readings(
    families: Iterable[Family], sound: Collection[str], report: Report, read: Reader = read_beside
) -> list[Coverage]:
    """Compare each family with its second reading, report the differences, and return the coverage.

    Families without a second reading are left out. So are those in which one of the two files has problems, but a
    second reading is checked even if its spec is not ``sound``.
    """
    coverages = []
    for loaded_family in families:
        # A reader reads only the manual, so the family is compared without overlays.
        family = loaded_family.plain or loaded_family
        second = read(family, report) if not family.device.base else None
        if second is None or second.facts is None or family.document.file not in sound:
            continue
        facts = facts_of(Reading(family.device, family.document))
        outcome = compare(facts, second.facts)
        explain(family.document, second.document, outcome, report)
        coverages.append(Coverage(family, outcome, facts.derived))
    return coverages


def explain(spec: Document, second: Document, outcome: Comparison, report: Report) -> None:
    """Count the disagreements explained by errata of the spec, and report the others, each once.

    An erratum that affects the place of a disagreement explains it by exactly its two values.
    """
    explanations, used = list(_explanations(spec)), set[Path]()
    unexplained: list[Disagreement] = []
    for disagreement in outcome.disagreements:
        place, values = disagreement.place or disagreement.near, (disagreement.other, disagreement.used)
        matching = [explanation for explanation in explanations if explanation[2:] == values]
        explaining = {erratum_path for erratum_path, affected, *_ in matching if _touches_any(affected, place)}
        used |= explaining
        if explaining:
            outcome.read[disagreement.sort, disagreement.place or ("second", *disagreement.second)] = Read.EXPLAINED
        else:
            unexplained.append(disagreement)
    for disagreements in related(unexplained):
        _report_disagreements(disagreements, spec, second, report)
    _check_explanations(explanations, used, spec, report)


def _touches_any(affected: Sequence[str], place: Path) -> bool:
    return any(touches(path, place) for path in affected)


def _report_disagreements(disagreements: Related, spec: Document, second: Document, report: Report) -> None:
    """Report disagreements with one cause once: in the spec, or in the second reading if only that has the fact."""
    first = disagreements.first
    place = first.place or first.near
    others = _others_text(disagreements, spec, second)
    mend = _MEND_TEXT if disagreements.is_text_without_spec else _MEND
    if first.used == NOTHING:
        values = f"{first.other} here, {first.used} in {_place_text(spec, place)}"
        report.add(RULE, second, first.second, f"{first.description}: {values}{others}; {mend}")
    else:
        values = f"{first.used} here, {first.other} in {_place_text(second, first.second)}"
        report.add(RULE, spec, place, f"{first.description}: {values}{others}; {mend}")


def _place_text(document: Document, place: Path) -> str:
    """Return the file of a place, and its line if the file has the place or one around it."""
    file = File(document.file).name
    return f"{file}:{document.position(place)[0]}" if place and document.has(place[:1]) else file


def _others_text(disagreements: Related, spec: Document, second: Document) -> str:
    """Return the number of the other disagreements with the same cause, and their places."""
    first, others = disagreements.first, disagreements.others
    # One contact of both interfaces is one place.
    others = tuple(other for other in others if (other.place, other.second) != (first.place, first.second))
    if not others:
        return ""
    in_spec = [disagreement.place or disagreement.near for disagreement in others if disagreement.used != NOTHING]
    in_second = [disagreement.second for disagreement in others if disagreement.used == NOTHING]
    lines = dict.fromkeys(str(spec.position(place)[0]) for place in in_spec)
    places = list(dict.fromkeys(_place_text(second, place) for place in in_second))
    if lines:
        places.insert(0, f"{'line' if len(lines) == 1 else 'lines'} {joined_lines(list(lines))}")
    return f", and {len(others)} more with the same cause in {', '.join(places)}"


def _check_explanations(
    explanations: Sequence[tuple[Path, Sequence[str], str, str]], used: set[Path], spec: Document, report: Report
) -> None:
    """Report errata that explain no disagreement, or whose printed text has other values."""
    for path, _, second_value, used_value in explanations:
        values = f"{quoted(second_value)} in the second reading and {quoted(used_value)} here"
        if path not in used:
            message = f"no fact affected by this erratum is {values}; correct or remove it"
            report.add("readings-unused", spec, path, message)
        elif _lacks_number(spec.data["errata"][path[1]]["printed"], second_value):
            message = f"the printed text has other values than {second_value}, which the second reading has; correct it"
            report.add("readings-unused", spec, (*path[:2], "printed"), message)


def _explanations(spec: Document) -> Iterator[tuple[Path, Sequence[str], str, str]]:
    """Yield the two values that each erratum of a spec explains, after their place and the affected paths."""
    for number, erratum in enumerate(spec.data.get("errata", ())):
        for index, pair in enumerate(erratum.get("readings", ())):
            yield ("errata", number, "readings", index), erratum.get("affects", ()), pair["second"], pair["used"]


def _lacks_number(text: str, value: str) -> bool:
    """Return True if a value has a unit, and a text has a value with this unit, but the number nowhere."""
    quantity = _QUANTITY.fullmatch(value)
    if quantity is None or quantity[2] not in {unit for _, unit in _QUANTITY.findall(text)}:
        return False
    return _number(quantity[1]) not in map(_number, _NUMBER.findall(text))


def _number(text: str) -> Decimal:
    return Decimal(text.replace(",", ""))


#: Keys of lists and maps that a path of an erratum omits.
_LEFT_OUT = frozenset("layouts fields values contacts timings parts steps arguments meanings data_ids".split())


def touches(affected: str, place: Path) -> bool:
    """Return True if an erratum that affects a path touches a place: the same one, a parent or a child."""
    wanted, steps = affected.split("."), list(place)
    while wanted and steps:
        step = steps.pop(0)
        if step == wanted[0]:
            wanted.pop(0)
        elif not isinstance(step, int) and step not in _LEFT_OUT:
            return False
    return True
