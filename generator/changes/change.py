"""A change, what it is about, its impact on users by output, and the version that follows from changes.

Breaking changes and changes of behaviour raise the first number, compatible ones the second, and wording the third. A
change of behaviour counts as breaking, since an update must not silently change positions. Before 1.0.0 each is one
place lower: the second number marks breaking changes and changes of behaviour, the third the rest. Only the
manufacturer's file can move a package to 1.0.0.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Any

from ..model import Device, Manufacturer


class Impact(IntEnum):
    """Effort that a change causes for users, in ascending order."""

    NONE = 0
    #: Words, sources and other facts that no code depends on.
    DOCUMENTATION = 1
    #: Additions. Everything else is unchanged.
    COMPATIBLE = 2
    #: Code still builds, but sends, reads, accepts or rejects something else.
    BEHAVIOUR = 3
    #: Code that uses it no longer builds, or asks for something that no longer exists.
    BREAKING = 4

    @property
    def word(self) -> str:
        return self.name.lower()


#: The impacts that a user can name, lowest first.
IMPACTS = tuple(impact.word for impact in Impact if impact)
#: The outputs, in the order of reports.
OUTPUTS = ("c", "python", "xml", "pages")
TITLES = {"c": "C", "python": "Python", "xml": "XML", "pages": "pages"}


@dataclass(frozen=True, slots=True)
class Rule:
    """A kind of change.

    ``impacts`` contains one impact for each of ``OUTPUTS``. ``when`` describes the change, ``why`` justifies the
    impact.
    """

    name: str
    impacts: tuple[Impact, Impact, Impact, Impact]
    when: str
    why: str

    @property
    def impact(self) -> Impact:
        """Highest impact on any output."""
        return max(self.impacts)

    @property
    def is_renaming(self) -> bool:
        return self.name.endswith("-renamed")

    @property
    def word(self) -> str:
        """Word in the first column of the text."""
        return "renamed" if self.is_renaming else self.impact.word


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


_VERSION = re.compile(r"(\d+)\.(\d+)\.(\d+)")


@dataclass(frozen=True, slots=True)
class Package:
    """Versions of a manufacturer's package: ``old`` and ``stated`` are from the specs, ``due`` is from the changes."""

    maker: str
    name: str
    old: str
    stated: str
    due: str

    @property
    def new(self) -> str:
        """New version: the stated one if that is high enough."""
        return self.stated if self.is_enough else self.due

    @property
    def is_enough(self) -> bool:
        return _numbers(self.stated) >= _numbers(self.due)


def due_version(version: str, impact: Impact) -> str:
    """Return the lowest version after ``version`` for changes of at most this impact."""
    numbers = _numbers(version)
    if not impact or not numbers:
        return version
    is_stable = numbers[0] > 0
    if impact >= Impact.BEHAVIOUR:
        index = 0 if is_stable else 1
    else:
        index = 1 if is_stable and impact is Impact.COMPATIBLE else 2
    raised = [*numbers[:index], numbers[index] + 1, 0, 0][:3]
    return ".".join(map(str, raised))


def packages(old: Sequence[Device], new: Sequence[Device], changes: Collection[Change]) -> list[Package]:
    """Return the packages of manufacturers on both sides, with the versions that follow from the changes."""
    old_makers, new_makers = _makers(old), _makers(new)
    compared_packages = []
    for name, maker in new_makers.items():
        if name in old_makers:
            families = {device.name for device in (*old, *new) if device.manufacturer.name == name}
            impact = max((change.impact for change in changes if change.family in families), default=Impact.NONE)
            version = old_makers[name].version
            compared_packages.append(
                Package(name, maker.python_package, version, maker.version, due_version(version, impact))
            )
    return compared_packages


def _makers(devices: Sequence[Device]) -> dict[str, Manufacturer]:
    return {device.manufacturer.name: device.manufacturer for device in devices}


def _numbers(version: str) -> tuple[int, ...]:
    match = _VERSION.fullmatch(version)
    return tuple(map(int, match.groups())) if match is not None else ()
