"""The version that follows from changes.

By Semantic Versioning: what breaks or behaves otherwise raises the first number, what is compatible the second, and
words the third. A change of behaviour counts as one that breaks, since nobody should come by another position by an
update that he did not read. Before 1.0.0 each is one place lower: the second number for what breaks or behaves
otherwise, the third for the rest. Nothing leads to 1.0.0 but its maker's word.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..model import Device
from .change import Change
from .impact import Impact

_VERSION = re.compile(r"(\d+)\.(\d+)\.(\d+)")


@dataclass(frozen=True, slots=True)
class Package:
    """The generated package of a manufacturer: ``old`` and ``stated`` are what the specs say, ``due`` what follows."""

    maker: str
    name: str
    old: str
    stated: str
    due: str

    @property
    def new(self) -> str:
        """The version that it is to have: the stated one, if that is enough."""
        return self.stated if self.is_enough else self.due

    @property
    def is_enough(self) -> bool:
        return _numbers(self.stated) >= _numbers(self.due)


def due(version: str, impact: Impact) -> str:
    """The lowest version after ``version`` for changes of this impact at most."""
    numbers = _numbers(version)
    if not impact or not numbers:
        return version
    place = 0 if impact >= Impact.BEHAVIOUR else 1 if impact is Impact.COMPATIBLE else 2
    if numbers[0] == 0:
        place = 1 if place == 0 else 2
    raised = [*numbers[:place], numbers[place] + 1, 0, 0][:3]
    return ".".join(map(str, raised))


def packages(old: Sequence[Device], new: Sequence[Device], changes: Iterable[Change]) -> list[Package]:
    """The packages of the makers that are on both sides, with the version that follows from their families' changes."""
    found = list(changes)
    makers = {device.manufacturer.name: device.manufacturer for device in old}
    made = {}
    for device in new:
        maker = device.manufacturer
        before = makers.get(maker.name)
        if before is None or maker.name in made:
            continue
        families = {item.name for item in (*old, *new) if item.manufacturer.name == maker.name}
        impact = max((change.impact for change in found if change.family in families), default=Impact.NONE)
        needed = due(before.version, impact)
        made[maker.name] = Package(maker.name, maker.python_package, before.version, maker.version, needed)
    return list(made.values())


def _numbers(version: str) -> tuple[int, ...]:
    match = _VERSION.fullmatch(version)
    return tuple(map(int, match.groups())) if match is not None else ()
