"""Targets: what makes files of the devices that the specs describe. This is all that the author of one needs to know.

A target is a ``Target``. It gets the whole library and gives the text of every file by its path; it touches no disk.
Ours lie in the folders beside this file. A package of yours adds one by an entry point of the group
``codewheel.targets`` that leads to its ``Target``. It is then like ours, except that it runs only when asked for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from ..language.problems import Path as Place
from ..model import Biss, Device, Manufacturer
from ..render import Templates

_NAME = re.compile(r"[a-z][a-z0-9_-]*")


@dataclass(frozen=True)
class Library:
    """The devices to make files of.

    Attributes:
        devices: Every device that the specs describe, in order of name.
        own_templates: The folder of the user's templates for this target, to be handed to ``Templates.render``.
    """

    devices: tuple[Device, ...]
    own_templates: Path | None = None

    def by_manufacturer(self) -> list[tuple[Manufacturer, tuple[Device, ...]]]:
        """The devices of each manufacturer, in order of name."""
        makers = {device.manufacturer.name: device.manufacturer for device in self.devices}
        return [
            (maker, tuple(item for item in self.devices if item.manufacturer.name == name))
            for name, maker in sorted(makers.items())
        ]


def has_biss(devices: Iterable[Device]) -> bool:
    """Whether any of these devices speaks BiSS, so that what all BiSS encoders share is of use."""
    return any(device.over(Biss) is not None for device in devices)


class TargetError(ValueError):
    """Stops a target: one line says what it cannot express, and ``place`` where that stands in a spec."""

    def __init__(self, message: str, place: Place = ()) -> None:
        super().__init__(message)
        self.place = place


@dataclass(frozen=True)
class TargetProblem:
    """Something in a spec that a target cannot express; it is shown with file, line and column, as every problem is.

    Attributes:
        device: The device whose spec is at fault.
        rule: A stable name that begins with the target's, such as ``c-name``.
        place: The keys that lead to the fault, with names for items of lists: ``("registers", "preset", "length")``.
        message: What is wrong and what would be right, in one line. ``{line}`` stands for the line of ``other``.
        other: A second place in the same spec, of which the message speaks.
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
        name: Small letters, digits, hyphens and underscores.
        summary: One line for ``--help``.
        default: The value where the user gives none.
        values: All values that can be given. Without any, every text can; ``files`` raises ``TargetError`` for a wrong
            one.

    Raises:
        ValueError: The default is none of the values.
    """

    name: str
    summary: str
    default: str
    values: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.values and self.default not in self.values:
            raise ValueError(f"the default of the option '{self.name}' is none of its values")


#: The value of every option of a target, by its name.
Options = Mapping[str, str]
NO_OPTIONS: Options = MappingProxyType({})


@dataclass(frozen=True)
class Target:
    """An output.

    Attributes:
        name: What ``--target`` takes, the name of the entry point, and the folder of the output: small letters, digits,
            hyphens and underscores. The names of ours are taken.
        summary: One line for ``--help``.
        files: Gives the text of each file by its path, which begins with the name and a slash. It gets every option.
            A ``TargetError`` ends the run with its message; any other exception does so with the place where it arose.
        problems: Gives what the target cannot express. It is asked before ``files``, and by ``check --target``, and
            sees only devices in whose specs nothing else is wrong.
        options: The settings.
        templates: The templates, so that ``--templates`` and the page of templates know them.

    Raises:
        ValueError: A name cannot be one.
    """

    name: str
    summary: str
    files: Callable[[Library, Options], Mapping[str, str]]
    problems: Callable[[Library], Iterable[TargetProblem]] = lambda library: ()
    options: tuple[Option, ...] = ()
    templates: Templates | None = None

    def __post_init__(self) -> None:
        for name in (self.name, *(option.name for option in self.options)):
            if not _NAME.fullmatch(name):
                raise ValueError(f"'{name}' is no name of a target or option; it needs small letters, digits, - and _")
