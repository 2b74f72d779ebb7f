"""Choose language-independent operations for the meaning of a field's bits, each with its inverse.

This is the one place between the model and the outputs that looks at kinds. An output matches over these operations,
exhaustively, so that mypy names every output that does not know a new one.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..model import Digits, Field, Value
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Flag, Number, Parity, Text, Unused
from ..model.never import assert_never


@dataclass(frozen=True, slots=True)
class Raw:
    """An unsigned number: the bits as they are. The inverse refuses a number that is wider."""


@dataclass(frozen=True, slots=True)
class TwosComplement:
    """A signed number in two's complement. The inverse refuses a number that does not fit."""


@dataclass(frozen=True, slots=True)
class ZeroMeans:
    """An unsigned number, where zero bits mean ``number``.

    The inverse writes 0 for ``number`` if it does not fit, and refuses 0.
    """

    number: int


@dataclass(frozen=True, slots=True)
class Active:
    """Truth value that is true if the bit is 1, or with ``low`` if it is 0. The inverse writes the bit."""

    low: bool


@dataclass(frozen=True, slots=True)
class Named:
    """One of the named ``values``. The inverse refuses any other."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class DigitRuns:
    """An unsigned number, shown as ``runs`` of decimal digits. The inverse puts the runs together."""

    runs: tuple[Digits, ...]


@dataclass(frozen=True, slots=True)
class Characters:
    """Characters in Latin-1, one a byte, the first in the most significant byte. The inverse refuses other lengths."""


Meaning = Raw | TwosComplement | ZeroMeans | Active | Named | DigitRuns | Characters


def is_number(meaning: Meaning) -> bool:
    """Return whether the value is one number: neither a truth value, a name, runs of digits, nor a text."""
    match meaning:
        case Raw() | TwosComplement() | ZeroMeans():
            return True
        case Active() | Named() | DigitRuns() | Characters():
            return False
        case _:
            assert_never(meaning)


def is_named(meaning: Meaning) -> bool:
    """Return whether the value is one of several names."""
    match meaning:
        case Named():
            return True
        case Raw() | TwosComplement() | ZeroMeans() | Active() | DigitRuns() | Characters():
            return False
        case _:
            assert_never(meaning)


def meaning_of(field: Field) -> Meaning:
    """Return the meaning of the bits of a field.

    Constants, unused bits, CRCs and parity bits have no value of their own: their bits are a number.
    """
    match field.kind:
        case Number(signed=True):
            return TwosComplement()
        case Number(zero_means=number) if number:
            return ZeroMeans(number)
        case Number() | Constant() | Unused() | CrcValue() | Parity():
            return Raw()
        case Flag(active_low=low):
            return Active(low)
        case Choice(values):
            return Named(values)
        case Decimal(runs):
            return DigitRuns(runs)
        case Text():
            return Characters()
        case _:
            assert_never(field.kind)


def widest_value(field: Field) -> int:
    """Return the number of bits of the widest number that the field can mean."""
    match meaning_of(field):
        case ZeroMeans(number):
            return max(field.widest, number.bit_length())
        case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
            return field.widest
        case other:
            assert_never(other)
