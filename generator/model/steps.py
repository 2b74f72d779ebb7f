"""Procedures: steps that a master carries out, or a person by hand."""

from __future__ import annotations

import re
from typing import ClassVar

from .documents import (
    Sources,
)
from .record import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class _Step:
    meaning: str = ""
    source: Sources = ()


@dataclass(frozen=True, slots=True)
class WriteStep(_Step):
    """Write ``value`` to the whole register. If it is None, write the argument ``value_name``."""

    do: ClassVar[str] = "write"
    register: str
    value_name: str
    value: int | None


@dataclass(frozen=True, slots=True)
class ModifyStep(_Step):
    """Write ``value`` to one field and keep the other fields as read.

    If it is None, write the argument ``value_name``.
    """

    do: ClassVar[str] = "write"
    register: str
    field: str
    value_name: str
    value: int | None


@dataclass(frozen=True, slots=True)
class ReadStep(_Step):
    """Read the register or, if ``field`` is not empty, that field."""

    do: ClassVar[str] = "read"
    register: str
    field: str = ""


@dataclass(frozen=True, slots=True)
class PollStep(_Step):
    """Read the register until ``field`` is ``value``."""

    do: ClassVar[str] = "poll"
    register: str
    field: str
    value: int


@dataclass(frozen=True, slots=True)
class WaitStep(_Step):
    """Wait ``microseconds``."""

    do: ClassVar[str] = "wait"
    microseconds: int


@dataclass(frozen=True, slots=True)
class SendStep(_Step):
    """Send the bytes ``request`` to ask for ``data_id``, ``times`` times, ``microseconds`` apart.

    ``in_succession`` is true if no other request may be sent between them.
    """

    do: ClassVar[str] = "send"
    data_id: str
    request: bytes
    times: int = 1
    microseconds: int = 0
    in_succession: bool = False


RegisterStep = WriteStep | ModifyStep | ReadStep | PollStep
#: ``do`` is the keyword in the spec language, used for reading and printing only.
Step = RegisterStep | WaitStep | SendStep


@dataclass(frozen=True, slots=True)
class Argument:
    """A value that the caller passes to a procedure, for the register ``of``.

    ``meant_as`` is the name of the register's meaning if it has several.
    """

    name: str
    of: str
    meaning: str
    meant_as: str = ""


@dataclass(frozen=True, slots=True)
class Procedure:
    name: str
    title: str
    interface: str
    arguments: tuple[Argument, ...]
    precondition: str
    steps: tuple[Step, ...]
    result: str
    note: str
    source: Sources

    @property
    def registers(self) -> frozenset[str]:
        """Registers that the steps read or write."""
        return frozenset(step.register for step in self.steps if isinstance(step, RegisterStep))


_NUMBER_IN_LIST = re.compile(r"(?:^|(?<=\s))(\d{1,3})\.\s+")
#: Lowest number of steps that make a list.
_FEWEST_LISTED_STEPS = 3


def steps_of(characteristic_value: str) -> tuple[str, ...]:
    """Return the text before the first numbered step in a text, then the text of each step.

    If the text contains no steps that are numbered from 1, the result contains only the text.
    """
    matches = list(_NUMBER_IN_LIST.finditer(characteristic_value))
    numbers = [int(match[1]) for match in matches]
    are_numbers_of_steps = numbers == list(range(1, len(numbers) + 1))
    if not numbers or not are_numbers_of_steps:
        return (characteristic_value,)
    texts = [characteristic_value[: matches[0].start()].strip()]
    ends_of_steps = [*(match.start() for match in matches[1:]), len(characteristic_value)]
    for match, end in zip(matches, ends_of_steps, strict=True):
        texts.append(characteristic_value[match.end() : end].strip())
    return tuple(texts)


def has_steps(characteristic_value: str) -> bool:
    """Return True if a text contains enough numbered steps to be shown as a list."""
    return len(steps_of(characteristic_value)) > _FEWEST_LISTED_STEPS
