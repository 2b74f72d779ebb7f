"""A change, and the thing that it is about."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from .impact import Impact, Rule


@dataclass(frozen=True, slots=True)
class Change:
    """One difference, described by ``text``. ``old`` and ``new`` are plain data, or None.

    ``codes`` are the order codes that it affects, ``reach`` describes them in words, and ``names`` contains its name in
    each output that has one.
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


@dataclass(frozen=True, slots=True)
class Subject:
    """Subject of a change: its path in the spec, its name in a sentence, and its old names in outputs.

    ``interface`` is empty if it concerns all order codes. ``scope`` is the frame or register in which to look up the
    names of fields.
    """

    path: str
    label: str
    interface: str = ""
    names: Mapping[str, str] = field(default_factory=dict)
    scope: str = ""

    def inside(self, path: str, label: str) -> Subject:
        """Return a thing inside it."""
        return replace(self, path=f"{self.path}.{path}".removeprefix("."), label=label)

    @property
    def unnamed(self) -> Subject:
        """The same thing without its names in code, for changes that keep them."""
        return replace(self, names={})
