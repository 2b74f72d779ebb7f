"""The result of comparing two readings: how often each fact was read, and the disagreements."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

from ..language.document import Path
from .reading import FactClass


class HowOftenRead(IntEnum):
    """How often a fact was read from the manual, best first. For a place with several facts, the worst applies."""

    TWICE = 0
    DECIDED = 1
    EXPLAINED = 2
    ONCE = 3
    DIFFERENTLY = 4


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A fact with different values in the spec and in the second reading.

    A place is empty if a reading does not state the fact. ``nearest_place`` is then the place in the spec where it
    should be. ``is_name`` is set if the values are names of the same item, and ``resized_frame`` contains the words for
    a frame whose length differs. ``order_codes`` contains the codes with different values, or none if all codes have
    them.
    """

    fact_class: FactClass
    description: str
    spec_value: str
    second_value: str
    spec_place: Path
    second_place: Path
    nearest_place: Path = ()
    is_name: bool = False
    resized_frame: str = ""
    order_codes: frozenset[str] = frozenset()

    @property
    def spec_place_or_nearest(self) -> Path:
        """The place in the spec, or the place where the spec would state the fact."""
        return self.spec_place or self.nearest_place


@dataclass(slots=True)
class Comparison:
    """The result of comparing two readings: how often each fact of the spec was read, and the disagreements.

    Facts are identified by their class and place. ``has_names_of_spec`` is set if the second reading uses the names of
    the spec.
    """

    read_by_place: dict[tuple[FactClass, Path], HowOftenRead] = field(default_factory=dict)
    disagreements: list[Disagreement] = field(default_factory=list)
    has_names_of_spec: bool = False

    def count_fact(self, fact_class: FactClass, spec_place: Path, read: HowOftenRead) -> None:
        """Remember how often a fact of the spec was read. If several facts have this place, the worst count remains."""
        key = fact_class, spec_place
        self.read_by_place[key] = max(read, self.read_by_place.get(key, HowOftenRead.TWICE))

    def add_disagreement(self, disagreement: Disagreement) -> None:
        """Add a disagreement once, and count its fact as read differently if the spec has it."""
        if disagreement.spec_place:
            self.count_fact(disagreement.fact_class, disagreement.spec_place, HowOftenRead.DIFFERENTLY)
        if disagreement not in self.disagreements:
            self.disagreements.append(disagreement)
