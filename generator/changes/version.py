"""Derive the version from changes, by Semantic Versioning.

Breaking changes and changes of behaviour raise the first number, compatible ones the second, and wording the third. A
change of behaviour counts as breaking, since an update must not silently change positions. Before 1.0.0 each is one
place lower: the second number marks breaking changes and changes of behaviour, the third the rest. Only the
manufacturer's file can move a package to 1.0.0.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from ..model import Device
from .change import Change
from .impact import Impact

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


def due(version: str, impact: Impact) -> str:
    """Return the lowest version after ``version`` for changes of at most this impact."""
    numbers = _numbers(version)
    if not impact or not numbers:
        return version
    place = 0 if impact >= Impact.BEHAVIOUR else 1 if impact is Impact.COMPATIBLE else 2
    if numbers[0] == 0:
        place = 1 if place == 0 else 2
    raised = [*numbers[:place], numbers[place] + 1, 0, 0][:3]
    return ".".join(map(str, raised))


def packages(old: Sequence[Device], new: Sequence[Device], changes: Collection[Change]) -> list[Package]:
    """Return the packages of manufacturers on both sides, with the versions that follow from the changes."""
    before, after = ({item.manufacturer.name: item.manufacturer for item in devices} for devices in (old, new))
    found = []
    for name, maker in after.items():
        if name in before:
            families = {item.name for item in (*old, *new) if item.manufacturer.name == name}
            impact = max((item.impact for item in changes if item.family in families), default=Impact.NONE)
            version = before[name].version
            found.append(Package(name, maker.python_package, version, maker.version, due(version, impact)))
    return found


def _numbers(version: str) -> tuple[int, ...]:
    match = _VERSION.fullmatch(version)
    return tuple(map(int, match.groups())) if match is not None else ()
