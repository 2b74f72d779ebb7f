"""Targets: functions from the library of devices to files.

A target gets the whole library and gives the text of every file under its path in the output folder. It touches no disk and computes no
bit position. Others can add one by the entry point group ``codewheel.targets``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from ..model import Device, Manufacturer
from ..problems import Path as Place


@dataclass(frozen=True)
class Library:
    """Every device that the specs describe, in order of name, and where a user keeps templates of their own."""

    devices: tuple[Device, ...]
    own_templates: Path | None = None

    def by_manufacturer(self) -> list[tuple[Manufacturer, tuple[Device, ...]]]:
        """The devices of each manufacturer, in order of name."""
        makers = {device.manufacturer.name: device.manufacturer for device in self.devices}
        return [(maker, tuple(item for item in self.devices if item.manufacturer.name == name)) for name, maker in sorted(makers.items())]


def has_biss(devices: Iterable[Device]) -> bool:
    """Whether any of these devices speaks BiSS, so that what all BiSS encoders share is of use."""
    return any(interface.kind == "biss" for device in devices for interface in device.interfaces)


class TargetError(ValueError):
    """A device has something that a target cannot express: one line says what, and ``place`` where in its spec."""

    def __init__(self, message: str, place: Place = ()) -> None:
        super().__init__(message)
        self.place = place


@dataclass(frozen=True)
class TargetProblem:
    """What a target cannot do with a device, at a place of its spec.

    The message is told where ``other`` is, as in `` on line 5``.
    """

    device: Device
    rule: str
    place: Place
    message: Callable[[str], str]
    other: Place = ()


Target = Callable[[Library], Mapping[str, str]]
#: What a target says of a library before it is asked for files; ``check`` tells it. A target need not have it.
Problems = Callable[[Library], Iterable[TargetProblem]]

#: Our targets, by name: the module that holds each, and the folder of the output that belongs to it.
BUILT_IN = {"python": "python", "c": "c", "biss": "biss", "docs": "docs"}


def target(name: str) -> Target:
    """The target of that name, ours or a registered one.

    Raises:
        LookupError: There is no such target.
    """
    if name in BUILT_IN:
        found: Target = import_module(f"{__name__}.{name}").generate
        return found
    from importlib.metadata import entry_points

    for entry in entry_points(group="codewheel.targets", name=name):
        registered: Target = entry.load()
        return registered
    raise LookupError(name)


def problems_of(name: str, library: Library) -> Iterable[TargetProblem]:
    """What the target of that name cannot do with these devices: what the function ``problems`` of its module says."""
    module = import_module(f"{__name__}.{name}") if name in BUILT_IN else None
    found: Problems | None = getattr(module, "problems", None)
    return found(library) if found is not None else ()
