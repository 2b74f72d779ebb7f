"""The trial of mutants: ``check`` looks at each, in this process, with the documents changed in memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from codewheel.build.alike import check_alike
from codewheel.build.load import families_of, packaged_masters, packaged_specs
from codewheel.commands.check import look_at
from codewheel.commands.outputs import targets_named
from codewheel.spec.document import Document
from codewheel.spec.problems import Report
from codewheel.spec.read import read_specs

from .effects import Effect, Outputs
from .slips import Mutant, mutants, mutated


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant: the rules that refuse it, else what it does to the outputs."""

    rules: tuple[str, ...]
    effect: Effect
    crash: str = ""

    @property
    def word(self) -> str:
        return "crash" if self.crash else "refused" if self.rules else self.effect.value


class Unfit(Exception):
    """The specs have problems before anything is changed."""


class Trial:
    """Specs without a problem, and what ``check`` says when one value of them is changed.

    Raises:
        Unfit: The specs have a problem as they are.
    """

    def __init__(self, paths: Sequence[Path] = ()) -> None:
        report = Report()
        found = read_specs(paths or [packaged_specs()], report)
        self.documents = [item for item in found if packaged_masters() not in Path(item.file).parents]
        self.families = families_of(self.documents, report)
        if report:
            raise Unfit("\n".join(problem.format() for problem in report.problems))
        self._targets = targets_named()
        self.outputs = {family.device.name: Outputs(family.device) for family in self.families}

    def mutants(self, names: Sequence[str] = ()) -> list[Mutant]:
        """Every mutant of the documents, or of those whose files have one of these names."""
        wanted = (item for item in self.documents if not names or Path(item.file).stem in names)
        return [mutant for document in wanted for mutant in mutants(document)]

    def verdict(self, mutant: Mutant) -> Verdict:
        """What ``check`` says of a mutant, and if it says nothing, what comes of it."""
        document = next(item for item in self.documents if item.file == mutant.file)
        changed = replace(document, data=mutated(document, mutant), kept={})
        try:
            return self._verdict(document, changed)
        except Exception as error:
            return Verdict((), Effect.NOTHING, f"{type(error).__name__}: {error}")

    def _verdict(self, document: Document, changed: Document) -> Verdict:
        report = Report()
        touched = [family for family in self.families if document.file in family.files]
        files = {file for family in touched for file in family.files}
        documents = [item for item in self.documents if item.file in files and item is not document]
        families = families_of([*documents, changed], report)
        if not report:
            check_alike([changed if item is document else item for item in self.documents], report)
            look_at(families, self._targets, report)
        if report:
            return Verdict(tuple(sorted({problem.rule for problem in report.problems})), Effect.NOTHING)
        found = {family.device.name: family.device for family in families}
        effects = [self.outputs[family.device.name].effect(found[family.device.name]) for family in touched]
        return Verdict((), max(effects, key=list(Effect).index, default=Effect.NOTHING))
