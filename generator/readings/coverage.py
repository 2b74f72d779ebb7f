"""Counts of how often each fact of the specs was read, by class, and the facts that need a second reading."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple

from ..language.document import Document
from ..language.problems import Path
from ..model import TimesRead
from ..model.record import dataclass
from .compare import Comparison, Read
from .fact import Sort
from .second_readings import Readings

NOT_READ = TimesRead(0, 0, 0, 0, 0)


@dataclass(frozen=True)
class Coverage:
    """Readings of the facts of one family. ``once`` lists the facts that were read once, in the order of the file."""

    family: str
    spec: Document
    counts: Mapping[Sort, TimesRead]
    once: Sequence[tuple[Sort, Path]]

    @property
    def total(self) -> TimesRead:
        """Counts of all classes together."""
        return added(self.counts.values())

    @property
    def lacking(self) -> list[tuple[Sort, Path]]:
        """Facts that must be read twice but were read once."""
        return [item for item in self.once if item[0].is_needed]


def coverage_of(readings: Iterable[Readings]) -> list[Coverage]:
    """Return the coverage of each family whose readings could be compared."""
    return [_of_family(item, item.outcome) for item in readings if item.outcome is not None]


def added(counts: Iterable[TimesRead]) -> TimesRead:
    """Return the sum of several counts."""
    return TimesRead(*map(sum, zip(*map(astuple, (NOT_READ, *counts)), strict=True)))


def _of_family(readings: Readings, outcome: Comparison) -> Coverage:
    spec = readings.family.document
    counts = {sort: _count(sort, outcome, readings.derived.get(sort, 0)) for sort in Sort}
    once = [item for item, read in outcome.read.items() if read is Read.ONCE]
    once.sort(key=lambda item: (spec.position(item[1]), item[0].value))
    return Coverage(readings.family.device.name, spec, counts, once)


def _count(sort: Sort, outcome: Comparison, derived: int) -> TimesRead:
    found = [read for (other, _), read in outcome.read.items() if other is sort]
    twice, explained, decided, once = map(found.count, (Read.TWICE, Read.EXPLAINED, Read.DECIDED, Read.ONCE))
    return TimesRead(twice, explained, decided, once, derived)
