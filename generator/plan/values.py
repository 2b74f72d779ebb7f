"""Choose language-independent operations that convert a field's bits to a value, each with its inverse.

This is the only module between the model and the outputs that looks at kinds. Each output has an exhaustive match over
these operations, so mypy reports every output that lacks a new one.
"""

from __future__ import annotations

from ..model import Digits, Field, Value
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Flag, Number, Parity, Text, Unused
from ..model.never import assert_never
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class Raw:
    """An unsigned number: the bits as they are. The inverse rejects a number that is too wide."""


@dataclass(frozen=True, slots=True)
class TwosComplement:
    """A signed number in two's complement. The inverse rejects a number that does not fit."""


@dataclass(frozen=True, slots=True)
class ZeroMeans:
    """An unsigned number, except that the value is ``number`` if all bits are 0.

    The inverse writes 0 for ``number`` if that does not fit, and rejects 0.
    """

    number: int


@dataclass(frozen=True, slots=True)
class Active:
    """Boolean that is true if the bit is 1 or, with ``low``, if it is 0. The inverse writes the bit."""

    low: bool


@dataclass(frozen=True, slots=True)
class Named:
    """One of the named ``values``. The inverse rejects any other."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class DigitRuns:
    """An unsigned number, shown as ``runs`` of decimal digits. The inverse joins the runs."""

    runs: tuple[Digits, ...]


@dataclass(frozen=True, slots=True)
class Characters:
    """Latin-1 characters, one per byte, the first in the most significant byte. The inverse rejects other lengths."""


Meaning = Raw | TwosComplement | ZeroMeans | Active | Named | DigitRuns | Characters


def is_number(meaning: Meaning) -> bool:
    """Return whether the value is a single number, not a Boolean, a name, runs of digits or a string."""
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

    Constants, unused bits, CRCs and parity bits have no value of their own. Their bits are a number.
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
    """Return the width in bits of the largest number that the field can represent."""
    match meaning_of(field):
        case ZeroMeans(number):
            return max(field.widest, number.bit_length())
        case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
            return field.widest
        case never:
            assert_never(never)
