"""One change, and the two families that are held against each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .impact import OUTPUTS, Impact, Rule


@dataclass(frozen=True, slots=True)
class Change:
    """One difference: ``text`` says it; ``old`` and ``new`` are plain data, None where there is nothing.

    ``codes`` are the order codes that it reaches, ``reach`` says which these are, and ``names`` has what it is called
    in an output where it has a name there.
    """

    family: str
    rule: Rule
    path: str
    text: str
    old: Any
    new: Any
    codes: tuple[str, ...]
    reach: str
    names: Mapping[str, str]

    @property
    def impact(self) -> Impact:
        return self.rule.impact

    def reached(self, impact: Impact) -> list[str]:
        """The outputs in which it has this impact."""
        return [name for name, found in zip(OUTPUTS, self.rule.impacts, strict=True) if found is impact]


@dataclass(frozen=True, slots=True)
class Thing:
    """What a change is about: its path in the spec, how a sentence calls it, the order codes that it concerns.

    ``interface`` is empty for what all order codes have.
    """

    path: str
    label: str
    interface: str = ""
    c: str = ""
    python: str = ""

    def inside(self, path: str, label: str) -> Thing:
        """Something inside of it."""
        return Thing(f"{self.path}.{path}", label, self.interface, self.c, self.python)
