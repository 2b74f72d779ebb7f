"""Registers with their fields, meanings and limits, and procedures, whose steps a master or a person carries out."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import ClassVar

from .expressions import Expression
from .interfaces import INTERFACES
from .kinds import Value
from .layout import Layout, PlacedLayout
from .manual import Sources
from .record import dataclass


@dataclass(frozen=True, slots=True)
class FieldGroup:
    """Fields that several layouts share. Each of these fields refers to the group by name."""

    name: str
    printed_name: str
    names: Mapping[str, str]
    bits: int
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class RegisterMeaning:
    """One meaning of a register, valid while the field ``when`` (``register.field``) has the value named ``value``."""

    name: str
    when: str
    value: str
    min: Expression | None
    max: Expression | None
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Register:
    """A register of ``length`` bytes, starting at ``address``. ``layout`` contains its fields."""

    name: str
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    interface: str
    address: int
    length: int
    access: str
    byte_order: str
    default: int | None
    min: Expression | None
    max: Expression | None
    limits_of: str
    opened_by: str
    opened_by_value: str
    clears_itself: bool
    wait_at_least_ms: int | None
    volatile: bool
    layout: Layout
    note: str
    source: Sources
    above_max: str = ""
    write_clears: tuple[str, ...] = ()
    meanings: tuple[RegisterMeaning, ...] = ()
    reserved: str = ""
    bank: int | None = None
    opened_by_field: str = ""

    @property
    def is_accessed_whole(self) -> bool:
        """True if all bytes have the same address, so that they are read or written at once."""
        return not INTERFACES[self.interface].byte_addresses

    def address_of(self, byte: int) -> int:
        """Return the address of a byte, counted from 0."""
        return self.address if self.is_accessed_whole else self.address + byte

    @property
    def last_address(self) -> int:
        return self.address_of(self.length - 1)

    @property
    def readable(self) -> bool:
        return self.access != "write_only"

    @property
    def writable(self) -> bool:
        return self.access != "read_only"

    @property
    def values(self) -> tuple[Value, ...]:
        """Named values of a register whose only field is a choice, or none."""
        return self.layout.fields[0].values if len(self.layout.fields) == 1 else ()

    def bytes_of(self, content: int) -> bytes:
        """Return a value as bytes in ascending order of address."""
        return content.to_bytes(self.length, "little" if self.byte_order == "low_byte_first" else "big")

    def default_bytes(self) -> bytes | None:
        return None if self.default is None else self.bytes_of(self.default)


def name_with_limits(register: Register) -> str:
    """Return the name of the limited field or join, or an empty string if the limits apply to the whole register.

    It is ``limits_of`` if that is a field or join. Otherwise it is the only field, if there is only one.
    """
    names = register.layout.member_names
    if register.limits_of in names:
        return register.limits_of
    if len(names) != 1:
        return ""
    (only_name,) = names
    return only_name


def bounded_width(register: Register, placed_layout: PlacedLayout) -> int:
    """Return the width of the field or join of a register to which its limits apply, or of the whole register."""
    _, width_of_field = placed_layout.lowest_bit_and_width_of(name_with_limits(register))
    # The width is 0 if the limits apply to the whole register.
    return width_of_field or 8 * register.length


def numbers_that_fit(register: Register, placed_layout: PlacedLayout) -> tuple[int, int]:
    """Return the lowest and the highest number that fit in the part of a register to which its limits apply.

    With 8 bits, these are -128 and 127 for a signed field, and 0 and 255 otherwise.
    """
    bit_count = bounded_width(register, placed_layout)
    # None for a join or a whole register, which are never signed.
    limited_field = placed_layout.find_field(name_with_limits(register))
    if limited_field is not None and limited_field.field.number.signed:
        return -(1 << (bit_count - 1)), (1 << (bit_count - 1)) - 1
    return 0, (1 << bit_count) - 1


def value_bounds(
    register: Register,
    placed_layout: PlacedLayout,
    limits: tuple[Expression | None, Expression | None],
    parameters: Mapping[str, int],
) -> tuple[int, int]:
    """Return the lowest and highest value that may be written, from ``limits`` or otherwise from the width.

    ``zero_means`` of the field, the number for which a stored zero stands, may be higher than the width allows.
    """
    lowest, highest = numbers_that_fit(register, placed_layout)
    limited_field = placed_layout.find_field(name_with_limits(register))
    if limited_field is not None:
        highest = max(highest, limited_field.field.number.zero_means)
    lower_limit, upper_limit = limits
    if lower_limit is not None:
        lowest = lower_limit.value(parameters)
    if upper_limit is not None:
        highest = upper_limit.value(parameters)
    return lowest, highest


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


#: The number of a step in a text: ``1. `` and ``2. `` in ``1. Stop the shaft. 2. Set the preset.``
_NUMBER_IN_LIST = re.compile(r"(?:^|(?<=\s))(\d{1,3})\.\s+")
#: Lowest number of steps that make a list.
_FEWEST_LISTED_STEPS = 3


def steps_of(text: str) -> tuple[str, ...]:
    """Return the text before the first numbered step in a text, then the text of each step.

    If the text contains no steps that are numbered from 1, the result contains only the text.
    """
    number_matches = list(_NUMBER_IN_LIST.finditer(text))
    numbers = [int(number_match[1]) for number_match in number_matches]
    are_numbers_of_steps = numbers == list(range(1, len(numbers) + 1))
    if not numbers or not are_numbers_of_steps:
        return (text,)
    step_texts = [text[: number_matches[0].start()].strip()]
    step_ends = [*(number_match.start() for number_match in number_matches[1:]), len(text)]
    for number_match, end in zip(number_matches, step_ends, strict=True):
        step_texts.append(text[number_match.end() : end].strip())
    return tuple(step_texts)


def has_steps(characteristic_value: str) -> bool:
    """Return True if a text contains enough numbered steps to be shown as a list."""
    return len(steps_of(characteristic_value)) > _FEWEST_LISTED_STEPS
