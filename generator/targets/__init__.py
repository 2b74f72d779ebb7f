"""Targets, which generate files for the devices described by the specs. This module is the whole plug-in API.

A ``Target`` receives the whole library and returns the text of every file, keyed by path. It does not access the disk.
The built-in targets are in the folders next to this file. Another package can add a target through an entry point in
the group ``codewheel.targets`` that refers to its ``Target``. The target works like a built-in one, but runs only on
request.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..language.problems import Path as Place
from ..model import Biss, Device, Manufacturer
from ..render import Templates

_TARGET_NAME = re.compile(r"[a-z][a-z0-9_-]*")


#: Function that returns the part of an output that depends on one device, which its second argument renders.
StoredPart = Callable[[Device, Callable[[], Any]], Any]


@dataclass(frozen=True)
class Library:
    """The devices for which files are generated.

    Attributes:
        devices: The devices that the target writes, sorted by name.
        own_templates: Folder of the user's templates for this target. Pass it to ``Templates.render``.
        stored_part: Returns the part of a device from the cache, or else calls its second argument.
        only_paths: Names of devices whose files have no content, because only their number is needed.
    """

    devices: tuple[Device, ...]
    own_templates: Path | None = None
    stored_part: StoredPart = field(default=lambda device, render: render(), compare=False)
    only_paths: frozenset[str] = frozenset()

    def part(self, family: PartOf, device: Device, options: Options) -> Any:
        """Return the data of one device from the cache, or else from ``family``, the function of the target."""
        return self.stored_part(device, lambda: family(device, self, options))

    def files_of(self, family: FilesOf, device: Device, options: Options) -> dict[str, str]:
        """Return the files of one device by path, from the cache or else from ``family``, the target's function."""

        def render() -> dict[str, str]:
            files = family(device, self, options)
            if device.name in self.only_paths:
                return {path: "" for path, _ in files}
            return {path: text() for path, text in files}

        files: dict[str, str] = self.stored_part(device, render)
        return files

    def by_manufacturer(self) -> list[tuple[Manufacturer, tuple[Device, ...]]]:
        """Return each manufacturer with its devices, sorted by its name. A main manufacturer comes first."""
        return [(manufacturer, self._devices_of(manufacturer)) for manufacturer in manufacturers(self.devices)]

    def _devices_of(self, manufacturer: Manufacturer) -> tuple[Device, ...]:
        """Return the devices of one manufacturer."""
        return tuple(device for device in self.devices if device.manufacturer.name == manufacturer.name)


def manufacturers(devices: Iterable[Device]) -> list[Manufacturer]:
    """Return the manufacturers of the devices, sorted by name. A main manufacturer comes first."""
    makers = {device.manufacturer.name: device.manufacturer for device in devices}
    return sorted(makers.values(), key=lambda manufacturer: (not manufacturer.main, manufacturer.name))


def main_manufacturer(makers: Sequence[Manufacturer]) -> Manufacturer | None:
    """Return the manufacturer after which a folder with the packages of all ``makers`` is named.

    It is the only manufacturer, or the only main one. The result is None if there are several, without a single main
    one.
    """
    if len(makers) == 1:
        return makers[0]
    main_makers = [manufacturer for manufacturer in makers if manufacturer.main]
    return main_makers[0] if len(main_makers) == 1 else None


def has_biss(devices: Iterable[Device]) -> bool:
    """Return True if any of these devices has a BiSS interface."""
    return any(device.find_interface(Biss) is not None for device in devices)


class TargetError(ValueError):
    """An error that stops a target. The message is one line. ``place`` is the part of a spec that it cannot express."""

    def __init__(self, message: str, place: Place = ()) -> None:
        super().__init__(message)
        self.place = place


class OptionError(TargetError):
    """An option value that a target cannot use. The message lists the valid values. The exit code is 2."""


@dataclass(frozen=True)
class TargetProblem:
    """Part of a spec that a target cannot express. It is reported with file, line and column, like every problem.

    Attributes:
        device: Device whose spec has the problem.
        rule: Stable name that begins with the target's, such as ``c-name``.
        place: Keys that lead to the problem, with names for list items: ``("registers", "preset", "length")``.
        message: The error and how to correct it, in one line. ``{line}`` is replaced by the line of ``other``.
        other: A second place in the same spec that the message refers to.
    """

    device: Device
    rule: str
    place: Place
    message: str
    other: Place = ()


@dataclass(frozen=True)
class Option:
    """A setting of a target: ``--option <target>.<name>=<value>``.

    Attributes:
        name: Lowercase letters, digits, hyphens and underscores.
        summary: One line for ``--help``.
        default: Value if the user gives none.
        values: All valid values. If empty, any text is valid, and ``files`` raises ``OptionError`` for a wrong text.

    Raises:
        ValueError: The default is not one of the values.
    """

    name: str
    summary: str
    default: str
    values: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.values and self.default not in self.values:
            raise ValueError(f"the default of the option '{self.name}' is not one of its values")


#: Values of all options of a target, by name.
Options = Mapping[str, str]
NO_OPTIONS: Options = MappingProxyType({})
#: Function that returns a target's result for one device alone, as data that JSON can express.
PartOf = Callable[[Device, Library, Options], Any]
#: Function that yields the path of each file that a target generates for one device alone, and a function for its text.
FilesOf = Callable[[Device, Library, Options], Iterator[tuple[str, Callable[[], str]]]]


@dataclass(frozen=True)
class Target:
    """A kind of output.

    Attributes:
        name: Name for ``--target``, for the entry point and for the output folder: lowercase letters, digits, hyphens
            and underscores. The names of built-in targets are reserved.
        summary: One line for ``--help``.
        files: Function that returns the text of each file, keyed by path. Paths begin with the name and a slash. It
            receives all options. A ``TargetError`` ends the run with its message. Any other exception ends the run
            with the message and its origin.
        problems: Function that returns the parts of specs that the target cannot express. It is called before ``files``
            and by ``check --target``, and only with devices whose specs have no other problems.
        options: Settings of the target.
        templates: Templates of the target, for ``--templates`` and the page about templates.
        family: Function that returns the target's result for one device alone. ``files`` calls it through
            ``Library.part`` if the result is data that JSON can express, and through ``Library.files_of`` if it yields
            files. Of the built-in targets, results for unchanged specs come from the cache.

    Raises:
        ValueError: A name is not valid.
    """

    name: str
    summary: str
    files: Callable[[Library, Options], Mapping[str, str]]
    problems: Callable[[Library], Iterable[TargetProblem]] = lambda library: ()
    options: tuple[Option, ...] = ()
    templates: Templates | None = None
    family: PartOf | FilesOf | None = None

    @property
    def defaults(self) -> Options:
        """The default of each option, by its name."""
        return {option.name: option.default for option in self.options}

    def __post_init__(self) -> None:
        for name in (self.name, *(option.name for option in self.options)):
            if not _TARGET_NAME.fullmatch(name):
                raise ValueError(f"'{name}' cannot name a target or option; use lowercase letters, digits, - and _")
