"""How the example programs print the members of a struct with ``printf``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from ...model import Value
from ...model.record import dataclass
from ...plan.operations import FieldToDecode
from ...plan.values import ActiveFlag, DecimalDigits, Latin1Text, NamedChoice, TwosComplement
from ...say.names_and_evidence import title_of
from .comments import ascii_text
from .names import c_name

#: Maximum number of characters of explanation after a number.
_LONGEST_EXPLANATION = 40


@dataclass(frozen=True, slots=True)
class PrintedMember:
    """A member as the program prints it: its name, the ``form`` and arguments for ``printf``.

    ``value_names`` explains its named values, or is empty.
    """

    name: str
    form: str
    arguments: str
    value_names: str = ""


def printed_members(part: FieldToDecode, variable: str) -> Iterator[PrintedMember]:
    """Yield the members that a field fills in the struct ``variable``, as ``printf`` prints them.

    A number whose decimal digits are members, too, fills several members.
    """
    name = part.field.name
    member = f"{variable}.{c_name(name)}"
    match part.meaning:
        case Latin1Text():
            yield PrintedMember(name, form="%.*s", arguments=f"(int)sizeof({member}), {member}")
        case ActiveFlag():
            yield PrintedMember(name, form="%s", arguments=f'{member} ? "yes" : "no"')
        case TwosComplement():
            yield PrintedMember(name, form="%lld", arguments=f"(long long){member}")
        case NamedChoice(values):
            yield replace(printed_number(name, variable), value_names=_value_meanings(values))
        case DecimalDigits(digit_runs):
            yield printed_number(name, variable)
            for digit_run in digit_runs:
                yield printed_number(digit_run.name, variable)
        case _:
            yield printed_number(name, variable)


def printed_number(name: str, variable: str) -> PrintedMember:
    """Return an unsigned member of the struct ``variable``, as ``printf`` prints it."""
    return PrintedMember(name, form="%llu", arguments=f"(unsigned long long){variable}.{c_name(name)}")


def _value_meanings(values: Iterable[Value]) -> str:
    """Return the meanings of the values, such as ``0 off, 1 on``, or an empty string if the line would be too long."""
    meanings = ", ".join(f"{value.value} {ascii_text(title_of(value))}" for value in values)
    return meanings if len(meanings) <= _LONGEST_EXPLANATION else ""
