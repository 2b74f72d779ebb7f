"""Counts of how often each fact of the specs was read, by class, and the facts that need a second reading."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple
from functools import cached_property

from ..language.document import Document
from ..language.problems import Path
from ..loading.library import Family
from ..model import TimesRead
from ..model.record import dataclass
from .compare import Comparison, Read
from .fact import Sort


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
