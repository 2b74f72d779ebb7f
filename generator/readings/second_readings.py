"""Second readings: find, read, check and compare them with a spec, and count how often each fact was read."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from functools import cached_property
from pathlib import Path as File

from ..language.check import check_second
from ..language.document import Document, Path
from ..language.files import second_reading_path
from ..language.problems import ProblemReport, joined_lines, quoted
from ..language.read import read_document
from ..loading.device import build_device
from ..loading.overlays import Family
from ..model import Manufacturer, TimesRead
from ..model.record import dataclass
from . import bits_and_registers, interfaces, order_codes, stated, surroundings
from .compare_readings import compare
from .disagreements import Comparison, Disagreement, DisagreementsWithOneCause, HowOftenRead, group_by_cause
from .reading import NOTHING, ComparedFacts, FactClass, SpecReading


def facts_of(reading: SpecReading) -> ComparedFacts:
    """Return all facts of a reading that can be compared with another reading.

    Facts under ``decided`` are printed in no manual. Only a second reading has such a list.
    """
    facts = ComparedFacts()
    order_codes.add_codes(reading, facts)
    interfaces.add_interfaces(reading, facts)
    bits_and_registers.add_registers(reading, facts)
    facts.add(surroundings.procedures(reading))
    facts.add(surroundings.surroundings(reading))
    facts.add(surroundings.content_facts(reading))
    facts.add(stated.text_facts(reading))
    facts.printed_numbers = stated.printed_numbers_by_path(reading)
    facts.sections = stated.sections_by_path(reading)
    facts.decided = reading.document.data.get("decided", ())
    return facts


@dataclass(frozen=True)
class Coverage:
    """How often the facts of a family were read.

    Attributes:
        family: The family, without overlays.
        outcome: Comparison of its spec with its second reading.
        derived: Number of facts of each class that follow from other facts and are not read.
    """

    family: Family
    outcome: Comparison
    derived: Mapping[FactClass, int]

    @property
    def spec(self) -> Document:
        return self.family.document

    @cached_property
    def counts(self) -> Mapping[FactClass, TimesRead]:
        """Numbers of facts of each class that were read twice, once and so on."""
        return {fact_class: self._count_times_read(fact_class) for fact_class in FactClass}

    def _count_times_read(self, fact_class: FactClass) -> TimesRead:
        """Return how many facts of a class were read how often. Facts that were read differently are not counted."""
        how_often_by_fact = self.outcome.how_often_read_by_fact.items()
        how_often_of_class = [
            how_often_read for (class_of_fact, _), how_often_read in how_often_by_fact if class_of_fact is fact_class
        ]
        return TimesRead(
            twice=how_often_of_class.count(HowOftenRead.TWICE),
            explained=how_often_of_class.count(HowOftenRead.EXPLAINED),
            decided=how_often_of_class.count(HowOftenRead.DECIDED),
            once=how_often_of_class.count(HowOftenRead.ONCE),
            derived=self.derived.get(fact_class, 0),
        )

    @property
    def total(self) -> TimesRead:
        """The same numbers for all classes together."""
        return add_counts(self.counts.values())

    @cached_property
    def once(self) -> Sequence[tuple[FactClass, Path]]:
        """Facts that were read once, in the order of the file."""
        facts_read_once = [
            fact for fact, read in self.outcome.how_often_read_by_fact.items() if read is HowOftenRead.ONCE
        ]
        return sorted(facts_read_once, key=self._order_in_file)

    def _order_in_file(self, fact: tuple[FactClass, Path]) -> tuple[tuple[int, int], str]:
        """Return line, column and class of a fact, by which facts are sorted."""
        fact_class, path_in_file = fact
        return self.spec.position(path_in_file), fact_class.value

    @property
    def lacking(self) -> list[tuple[FactClass, Path]]:
        """Facts that must be read twice but were read once."""
        return [(fact_class, path_in_file) for fact_class, path_in_file in self.once if fact_class.is_needed]


def add_counts(counts: Iterable[TimesRead]) -> TimesRead:
    """Return the sum of several counts."""
    all_counts = list(counts)
    return TimesRead(
        twice=sum(count.twice for count in all_counts),
        explained=sum(count.explained for count in all_counts),
        decided=sum(count.decided for count in all_counts),
        once=sum(count.once for count in all_counts),
        derived=sum(count.derived for count in all_counts),
    )


RULE = "readings-disagree"
#: A number, and a value with its unit.
_NUMBER_IN_TEXT = re.compile(r"(?<![\w.,])\d+(?:,\d{3})*(?:\.\d+)?(?![\d,.]*\d)")
_QUANTITY_IN_TEXT = re.compile(rf"({_NUMBER_IN_TEXT.pattern}) ([µmn]?s|[kM]?Hz|m?V)(?!\w)")
_ADVICE_TO_CHECK = "check the manual; if it prints both, add an erratum with both under 'readings'"

_ADVICE_ON_TEXT = "remove entries for texts that the spec no longer has"


@dataclass(frozen=True)
class SecondReading:
    """The second reading of a family, by another reader of its manual. Without ``facts`` if the file has problems."""

    document: Document
    facts: ComparedFacts | None


#: Function that reads the second reading of a family, if it has one, and adds its problems to the report.
Reader = Callable[[Family, ProblemReport], SecondReading | None]


def read_beside(family: Family, report: ProblemReport) -> SecondReading | None:
    """Return the second reading next to the spec of a family, or None if there is no file or it cannot be read.

    Problems of the file are added to ``report``.
    """
    file = second_reading_path(File(family.document.file))
    document = read_document(file, report) if file.is_file() else None
    return second_of(document, family.device.manufacturer, report) if document is not None else None


def second_of(document: Document, manufacturer: Manufacturer, report: ProblemReport) -> SecondReading:
    """Return the second reading in a document, without facts if the document has problems.

    The problems are added to ``report``.
    """
    # A device can be built in spite of some problems, so new problems are counted.
    problem_count_before = len(report)
    valid_data = check_second(document, report)
    device = build_device(valid_data, manufacturer, report.for_document(document)) if valid_data is not None else None
    has_new_problems = len(report) != problem_count_before
    if device is None or has_new_problems:
        return SecondReading(document, facts=None)
    return SecondReading(document, facts_of(SpecReading(device, document)))


def comparable_specs(families: Iterable[Family], report: ProblemReport) -> frozenset[str]:
    """Return the spec files that can be compared with second readings: those without faults in the report so far."""
    valid_families = (family for family in families if not report.faults((family.without_overlays or family).document))
    return frozenset(family.document.file for family in valid_families)


def compare_readings(
    families: Iterable[Family], valid_files: Collection[str], report: ProblemReport, read: Reader = read_beside
) -> list[Coverage]:
    """Compare each family with its second reading, report the differences, and return the coverage.

    Derived families are left out, and so are families without a second reading, and families with problems in one of
    the two files. A second reading is checked even if its spec has problems.

    Args:
        families: The families.
        valid_files: The spec files without problems.
        report: The differences and the problems of second readings are added to it.
        read: Returns the second reading of a family.
    """
    coverages = []
    for loaded_family in families:
        # A reader reads only the manual, so the family is compared without overlays.
        family = loaded_family.without_overlays or loaded_family
        is_derived = bool(family.device.base)
        second = read(family, report) if not is_derived else None
        if second is None or second.facts is None or family.document.file not in valid_files:
            continue
        facts = facts_of(SpecReading(family.device, family.document))
        outcome = compare(facts, second.facts)
        explain(family.document, second.document, outcome, report)
        coverages.append(Coverage(family, outcome, facts.derived))
    return coverages


def explain(spec: Document, second: Document, outcome: Comparison, report: ProblemReport) -> None:
    """Count the disagreements explained by errata of the spec, and report the remaining disagreements, each once.

    An erratum can list two values under ``readings``, for example if the manual prints 5 ms in one section and 10 ms in
    another. It explains a disagreement between exactly these values at a place that it affects. An erratum that
    explains nothing is also reported.
    """
    explanations = list(_explained_differences(spec))
    used_explanations: set[Path] = set()
    unexplained: list[Disagreement] = []
    for disagreement in outcome.disagreements:
        matching_explanations = [explanation for explanation in explanations if explanation.explains(disagreement)]
        if not matching_explanations:
            unexplained.append(disagreement)
            continue
        used_explanations.update(explanation.path_in_file for explanation in matching_explanations)
        # A fact that the spec lacks is counted at its place in the second reading.
        counted_path = disagreement.path_in_spec or ("second", *disagreement.path_in_second)
        outcome.how_often_read_by_fact[disagreement.fact_class, counted_path] = HowOftenRead.EXPLAINED
    for disagreements in group_by_cause(unexplained):
        _report_disagreements(disagreements, spec, second, report)
    for explanation in explanations:
        _check_explanation(explanation, spec, report, is_used=explanation.path_in_file in used_explanations)


@dataclass(frozen=True)
class _Explanation:
    """Two values of a fact, of which an erratum explains why the two readings differ.

    ``path_in_file`` is the place of the pair in the spec, and ``printed`` the erratum's text.
    """

    path_in_file: Path
    printed: str
    affected_paths: Sequence[str]
    second_value: str
    spec_value: str

    @property
    def erratum_place(self) -> Path:
        """Place of the erratum in the spec: ``("errata", 3)`` for the pair at ``("errata", 3, "readings", 0)``."""
        return self.path_in_file[:2]

    def explains(self, disagreement: Disagreement) -> bool:
        """Return whether a disagreement is between exactly these two values, at a place that the erratum affects.

        For a fact that the spec lacks, the nearest place in the spec counts.
        """
        if (self.second_value, self.spec_value) != (disagreement.second_value, disagreement.spec_value):
            return False
        return any(touches(path, disagreement.path_in_spec_or_nearest) for path in self.affected_paths)


def _explained_differences(spec: Document) -> Iterator[_Explanation]:
    """Yield each pair of values that the errata of a spec explain, under ``readings``.

    Several pairs of an erratum are separate explanations with the same printed text and affected paths.
    """
    for erratum_index, erratum in enumerate(spec.data.get("errata", ())):
        for pair_index, pair in enumerate(erratum.get("readings", ())):
            yield _Explanation(
                path_in_file=("errata", erratum_index, "readings", pair_index),
                printed=erratum["printed"],
                affected_paths=erratum.get("affects", ()),
                second_value=pair["second"],
                spec_value=pair["used"],
            )


def _report_disagreements(
    disagreements: DisagreementsWithOneCause, spec: Document, second: Document, report: ProblemReport
) -> None:
    """Report disagreements with one cause as one problem, for the first of them, with the lines of the others.

    The problem is in the spec, or in the second reading if only that has the fact.
    """
    first = disagreements.first_disagreement
    path_in_spec = first.path_in_spec_or_nearest
    others_text = _others_text(disagreements, spec, second)
    advice = _ADVICE_ON_TEXT if disagreements.is_text_without_spec else _ADVICE_TO_CHECK
    is_only_in_second = first.spec_value == NOTHING
    if is_only_in_second:
        both_values = f"{first.second_value} here, {first.spec_value} in {_file_and_line(spec, path_in_spec)}"
        report.add(RULE, second, first.path_in_second, f"{first.description}: {both_values}{others_text}; {advice}")
    else:
        both_values = f"{first.spec_value} here, {first.second_value} in {_file_and_line(second, first.path_in_second)}"
        report.add(RULE, spec, path_in_spec, f"{first.description}: {both_values}{others_text}; {advice}")


def _file_and_line(document: Document, path_in_file: Path) -> str:
    """Return the file of a place, with its line if the file has the place or its section: ``tv62.yaml:127``."""
    file_name = File(document.file).name
    if not path_in_file or not document.has(path_in_file[:1]):
        return file_name
    line, _ = document.position(path_in_file)
    return f"{file_name}:{line}"


def _others_text(disagreements: DisagreementsWithOneCause, spec: Document, second: Document) -> str:
    """Return how many other disagreements have the same cause, and where, or "" if there are none.

    For example ``, and 3 more with the same cause in lines 12 and 15``. Lines of the second reading come with its name:
    ``line 30 of x24.second.yaml``.
    """
    first_disagreement = disagreements.first_disagreement
    first_paths = first_disagreement.path_in_spec, first_disagreement.path_in_second
    # A disagreement at the same two places, such as one contact for both interfaces, is not counted again.
    other_disagreements = [
        other for other in disagreements.others if (other.path_in_spec, other.path_in_second) != first_paths
    ]
    if not other_disagreements:
        return ""
    spec_lines: set[int] = set()
    second_lines: set[int] = set()
    for other in other_disagreements:
        if other.spec_value == NOTHING:
            line, _ = second.position(other.path_in_second)
            second_lines.add(line)
        else:
            line, _ = spec.position(other.path_in_spec_or_nearest)
            spec_lines.add(line)
    line_texts: list[str] = []
    for lines, owner in ((spec_lines, ""), (second_lines, f" of {File(second.file).name}")):
        if lines:
            noun = "line" if len(lines) == 1 else "lines"
            line_texts.append(f"{noun} {joined_lines([str(line) for line in sorted(lines)])}{owner}")
    return f", and {len(other_disagreements)} more with the same cause in {', '.join(line_texts)}"


def _check_explanation(explanation: _Explanation, spec: Document, report: ProblemReport, *, is_used: bool) -> None:
    """Report an erratum that explains no disagreement, or whose printed text contradicts the second reading.

    In the second case, the text contains values with the unit of the second reading, but not its number.
    """
    second_value = explanation.second_value
    if not is_used:
        both_values = f"{quoted(second_value)} in the second reading and {quoted(explanation.spec_value)} here"
        message = f"no fact affected by this erratum is {both_values}; correct or remove it"
        report.add("readings-unused", spec, explanation.path_in_file, message)
    elif _prints_other_number(explanation.printed, second_value):
        message = f"the printed text has other values than {second_value}, which the second reading has; correct it"
        report.add("readings-unused", spec, (*explanation.erratum_place, "printed"), message)


def _prints_other_number(printed_text: str, value_with_unit: str) -> bool:
    """Return whether a text contains other values with the unit of a value such as ``5 ms``, but not this value.

    The result is False for a value without a unit.
    """
    quantity = _QUANTITY_IN_TEXT.fullmatch(value_with_unit)
    if quantity is None:
        return False
    number, unit = quantity.groups()
    units_in_text = {text_unit for _, text_unit in _QUANTITY_IN_TEXT.findall(printed_text)}
    if unit not in units_in_text:
        return False
    return _parse_number(number) not in map(_parse_number, _NUMBER_IN_TEXT.findall(printed_text))


def _parse_number(number_text: str) -> Decimal:
    """Return the number that a text such as ``1,000.5`` represents."""
    return Decimal(number_text.replace(",", ""))


#: Keys of lists and maps that a path of an erratum omits.
_KEYS_LEFT_OUT_OF_PATHS = frozenset(
    "layouts fields values contacts timings parts steps arguments meanings data_ids".split()
)


def touches(affected_path: str, path_in_file: Path) -> bool:
    """Return whether an erratum that affects a path touches a place: the same place, a parent or a child.

    ``registers.mode`` touches ``("registers", "mode", "fields", "speed")``. Indices and some keys are not in paths.
    """
    remaining_names = affected_path.split(".")
    for step in path_in_file:
        is_inside_path = not remaining_names
        if is_inside_path:
            break
        if step == remaining_names[0]:
            remaining_names = remaining_names[1:]
        elif not isinstance(step, int) and step not in _KEYS_LEFT_OUT_OF_PATHS:
            return False
    # No step differs. If names remain, the path is a part of the place.
    return True
