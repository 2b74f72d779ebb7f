"""Targets: functions from the library of devices to files.

A target gets the whole library and gives the text of every file under its path in the output folder. It touches no disk and computes no
bit position. Others can add one by the entry point group ``codewheel.targets``.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from ..model import Device, Manufacturer
from ..problems import Path as Place

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


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

#: Our targets, by name: the folder of templates that each uses.
BUILT_IN = {"python": "python", "c": "c", "biss": "biss", "docs": "markdown"}


def target(name: str) -> Target:
    """The target of that name, ours or a registered one.

    Raises:
        LookupError: There is no such target.
        TargetError: It is registered and cannot be loaded.
    """
    if name in BUILT_IN:
        found: Target = import_module(f"{__name__}.{name}").generate
        return found
    registered = _registered()
    if name not in registered:
        raise LookupError(name)
    return _guarded(name, registered[name])


def target_names() -> list[str]:
    """The names of all targets, ours and registered ones."""
    return [*BUILT_IN, *_registered()]


def fault_of(files: object) -> str:
    """What keeps ``files`` from being text by path, or nothing."""
    if not isinstance(files, Mapping):
        return f"this is {_kind(files)}"
    for path, text in files.items():
        if not isinstance(path, str) or not isinstance(text, str):
            return f"{path!r} is {_kind(text)}" if isinstance(path, str) else f"{path!r} is no path"
        try:
            (path + text).encode()
        except UnicodeEncodeError as error:
            return f"{path!r} holds U+{ord(error.object[error.start]):04X}, which is no character"
    return ""


def _kind(value: object) -> str:
    return "nothing" if value is None else type(value).__name__


def _registered() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points

    return {entry.name: entry for entry in entry_points(group="codewheel.targets")}


def _guarded(name: str, entry: EntryPoint) -> Target:
    """A registered target, whose faults become errors of one line."""
    try:
        made = entry.load()
    except Exception as error:
        raise TargetError(f"the target '{name}' cannot be loaded: {_told(error)}") from None

    def guarded(library: Library) -> Mapping[str, str]:
        try:
            files: Mapping[str, str] = made(library)
        except TargetError:
            raise
        except Exception as error:
            raise TargetError(f"the target '{name}' fails: {_told(error)}") from None
        if fault := fault_of(files):
            raise TargetError(f"the target '{name}' has to give text by path; {fault}")
        return files

    return guarded


def _told(error: Exception) -> str:
    """An error of another's code in one line, with the place where it came about."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {' '.join(str(error).split())}{place}"


def problems_of(name: str, library: Library) -> Iterable[TargetProblem]:
    """What the target of that name cannot do with these devices: what the function ``problems`` of its module says."""
    module = import_module(f"{__name__}.{name}") if name in BUILT_IN else None
    found: Problems | None = getattr(module, "problems", None)
    return found(library) if found is not None else ()
