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

from ..model import Device, Manufacturer
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
