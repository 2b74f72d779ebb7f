"""Trial of mutants: ``check`` examines each one in this process, with the documents changed in memory.

Everything that a mutant does not affect is read and computed only once: the other specs, and the other reading.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from codewheel.commands.cloze import check_sheets, read_sheet, vocabulary_of
from codewheel.commands.outputs import report_unfit_parts, targets_named
from codewheel.language.document import Document
from codewheel.language.files import packaged_masters, packaged_specs
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_specs
from codewheel.loading.library import Family, families_of
from codewheel.loading.manufacturer_rules import check_shared_facts
from codewheel.readings.compare_readings import compare
from codewheel.readings.reading import ComparedFacts, SpecReading
from codewheel.readings.second_readings import (
    Coverage,
    SecondReading,
    comparable_specs,
    compare_readings,
    explain,
    facts_of,
    read_beside,
    second_of,
)

from .effects import Effect, Outputs
from .mistakes import Change, Mutant, in_both, mutants, mutated
from .places import WORD
from .words import contradicts_a_gap

#: Rules that ``check --coverage`` adds to the rules of ``check``, for facts that are no longer read twice.
READ_ONCE = "read once"


@dataclass(frozen=True)
class Verdict:
    """Result for a mutant: the rules that reject it, or its effect on the outputs."""

    rules: tuple[str, ...]
    effect: Effect
    crash: str = ""

    @property
    def word(self) -> str:
        if self.crash:
            return "crash"
        return "refused" if self.rules else self.effect.value


class Unfit(Exception):
    """The specs already have problems before any change."""


class Trial:
    """Specs without problems, and the result of ``check`` after a change to one value in them or in a second reading.

    Raises:
        Unfit: The specs already have a problem.
    """

    def __init__(self, paths: Sequence[Path] = ()) -> None:
        report = ProblemReport()
        documents = read_specs(paths or [packaged_specs()], report)
        self.documents = [document for document in documents if packaged_masters() not in Path(document.file).parents]
        self.families = families_of(self.documents, report)
        seconds = ((family, read_beside(family, report)) for family in self.families)
        self._seconds = {family.document.file: second for family, second in seconds if second is not None}
        sheets = ((family, read_sheet(family, report)) for family in self.families)
        self._sheets = {family.document.file: sheet for family, sheet in sheets if sheet is not None}
        if report:
            raise Unfit("\n".join(problem.format() for problem in report.problems))
        self._targets = targets_named()
        self._outputs: dict[str, Outputs] = {}
        self._facts: dict[str, ComparedFacts] = {}

    @property
    def second_readings(self) -> list[Document]:
        """Return the documents of the second readings."""
        return [reading.document for reading in self._seconds.values()]

    def mutants(self, names: Sequence[str] = ()) -> list[Mutant]:
        """Return the mutants of the files with these names, or else of all specs that were read twice."""
        documents = [*self.documents, *self.second_readings]
        if names:
            wanted = [document for document in documents if Path(document.file).stem in names]
        else:
            twice = {file for family in self.families if family.document.file in self._seconds for file in family.files}
            wanted = [document for document in self.documents if document.file in twice] + self.second_readings
        return [mutant for document in wanted for mutant in mutants(document)]

    def mutants_in_both(self, mutants_of_one: Iterable[Mutant]) -> list[Mutant]:
        """Return the mutants of these whose mistake can be in the spec and in its second reading."""
        mutants_by_file = defaultdict(list)
        for mutant in mutants_of_one:
            mutants_by_file[mutant.file].append(mutant)
        specs = [family.document for family in self.families if family.document.file in self._seconds]
        return [
            mutant
            for spec in specs
            for mutant in in_both(mutants_by_file[spec.file], spec, self._seconds[spec.file].document)
        ]

    def reversed_words(self, all_mutants: Iterable[Mutant]) -> tuple[int, int]:
        """Return how many words of specs are reversed in these mutants, and for how many of them a gap asks."""
        vocabularies = {
            family.document.file: vocabulary_of(family.document)
            for family in self.families
            if family.document.file in self._sheets
        }
        found = [
            contradicts_a_gap(vocabularies[mutant.file], mutant.place.value, mutant.changes[0][1])
            for mutant in all_mutants
            if mutant.fact == WORD and mutant.file in vocabularies
        ]
        return len(found), sum(found)

    def place(self, mutant: Mutant) -> str:
        """Return the place of a mutant: its file and the path to the value."""
        document = self._document(mutant)
        return f"{Path(document.file).stem}: {document.name_path(mutant.place.path)}"

    def _document(self, mutant: Mutant) -> Document:
        documents = {document.file: document for document in (*self.second_readings, *self.documents)}
        return documents[mutant.file]

    def verdict(self, mutant: Mutant) -> Verdict:
        """Return the verdict of ``check`` on a mutant and, if the mutant passes, its effect."""
        document = self._document(mutant)
        changed = replace(document, data=mutated(document, mutant.changes), kept_indices={})
        try:
            if any(document is reading for reading in self.second_readings):
                return self._of_second(document, changed)
            return self._of_spec(document, changed, mutant.changes_in_second)
        except Exception as error:
            return Verdict((), Effect.NOTHING, f"{type(error).__name__}: {error}")

    def _of_spec(self, document: Document, changed: Document, changes_in_second: Iterable[Change] = ()) -> Verdict:
        """Return the verdict on a changed spec, next to its second reading with these changes.

        With changes in both, the sheet of words is not compared: it repeats the texts of the spec, and so the mistake.
        """
        report = ProblemReport()
        touched = [family for family in self.families if document.file in family.files]
        files = {file for family in touched for file in family.files}
        other_files = files - {document.file}
        documents = [unchanged for unchanged in self.documents if unchanged.file in other_files]
        families = families_of([*documents, changed], report)
        if not report:
            check_shared_facts(
                [changed if unchanged is document else unchanged for unchanged in self.documents], report
            )
        if not report:
            sound = comparable_specs(families, report)
            if changes_in_second:
                compare_readings(families, sound, report, partial(self._changed_second, changes_in_second))
            else:
                compare_readings(families, sound, report, self._second)
                check_sheets(families, sound, report, self._sheet)
        if not report:
            report_unfit_parts(families, self._targets, report)
        if report:
            return _refused(report)
        devices = {family.device.name: family.device for family in families}
        if set(devices) != {family.device.name for family in touched}:
            return Verdict((), Effect.CODE)
        effects = [self._outputs_of(family).effect(devices[family.device.name]) for family in touched]
        return Verdict((), max(effects, key=list(Effect).index, default=Effect.NOTHING))

    def _of_second(self, document: Document, changed: Document) -> Verdict:
        files = [file for file, reading in self._seconds.items() if reading.document is document]
        family = next(family for family in self.families if family.document.file in files)
        report = ProblemReport()
        second = second_of(changed, family.device.manufacturer, report)
        if second.facts is None:
            return _refused(report)
        if second.facts == self._seconds[family.document.file].facts:
            return Verdict((), Effect.NOTHING)
        facts = self._facts_of(family)
        outcome = compare(facts, second.facts)
        explain(family.document, changed, outcome, report)
        if report:
            return _refused(report)
        covered = Coverage(family, outcome, facts.derived)
        if covered.lacking or family.device.times_read not in (None, covered.total):
            return Verdict((READ_ONCE,), Effect.NOTHING)
        return Verdict((), Effect.READING)

    def _changed_second(self, changes: Iterable[Change], family: Family, report: ProblemReport) -> SecondReading:
        """Return the second reading of a family with these changes."""
        document = self._seconds[family.document.file].document
        changed = replace(document, data=mutated(document, changes), kept_indices={})
        return second_of(changed, family.device.manufacturer, report)

    def _second(self, family: Family, report: ProblemReport) -> SecondReading | None:
        return self._seconds.get(family.document.file)

    def _sheet(self, family: Family, report: ProblemReport) -> Document | None:
        return self._sheets.get(family.document.file)

    def _facts_of(self, family: Family) -> ComparedFacts:
        file = family.document.file
        if file not in self._facts:
            self._facts[file] = facts_of(SpecReading(family.device, family.document))
        return self._facts[file]

    def _outputs_of(self, family: Family) -> Outputs:
        name = family.device.name
        if name not in self._outputs:
            self._outputs[name] = Outputs(family.device)
        return self._outputs[name]


def _refused(report: ProblemReport) -> Verdict:
    return Verdict(tuple(sorted({problem.rule for problem in report.problems})), Effect.NOTHING)
