"""The kinds of fields: how the bits of a field become a value. A kind holds only the facts that no other kind has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from .facts import Sources

#: What an active flag says where the manual explains it for other order codes alone.
UNEXPLAINED = "the manual does not say what this bit means for this order code"


class Verdict(Enum):
    """Worth of the position of a valid frame, from worst to best.

    UNKNOWN: no flag of the frame says anything about it.
    C and the Python columns number the verdicts in this order. The most severe one decides, so that a warning never
    makes a position better than no information does.
    """

    NOT_USABLE = "not_usable"
    UNKNOWN = "unknown"
    USABLE_WITH_WARNING = "usable_with_warning"
    USABLE = "usable"


@dataclass(frozen=True, slots=True)
class Value:
    """A named value of a field or register."""

    name: str
    value: int
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Digits:
    """A run of decimal digits inside a number: ``number // divisor % modulus``."""

    name: str
    digits: int
    divisor: int
    modulus: int
    meaning: str


@dataclass(frozen=True, slots=True)
class Number:
    """An integer, in two's complement if ``signed``. Zero bits stand for ``zero_means``."""

    signed: bool = False
    zero_means: int = 0
    power_of_two: bool = False


@dataclass(frozen=True, slots=True)
class Flag:
    """One bit, true when active.

    ``makes_position`` says what the position of the same frame is worth while the flag is active, None where it comes
    with no position; ``sums_up`` names the flags whose sum it is. All of this holds for the order codes ``only``, those
    with a parameter ``only_while`` other than 0; for the others an active flag is ``unexplained``.
    """

    active_low: bool = False
    when_active: str = ""
    when_inactive: str = ""
    makes_position: Verdict | None = None
    sums_up: tuple[str, ...] = ()
    only: str = ""
    only_while: str = ""

    @property
    def unexplained(self) -> Flag:
        """The flag as order codes have it for which the manual does not explain it."""
        worth = None if self.makes_position is None else Verdict.USABLE_WITH_WARNING
        return Flag(self.active_low, UNEXPLAINED, makes_position=worth)


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the named values."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Constant:
    """Always the same bits.

    ``padding_of`` names the field for whose sake zeros are sent; the two together fill its ``container`` from the low
    end. Zeros that fill a gap between fields are no field of the spec: they follow from their neighbours.
    """

    value: int = 0
    padding_of: str = ""
    fills_gap: bool = False


@dataclass(frozen=True, slots=True)
class Unused:
    """Bits that mean nothing in this encoder: it sends ``value``, and another one of the kind may send anything.

    They are reported where they differ, not refused. ``makes_position`` says what the position is worth then.
    """

    value: int = 0
    makes_position: Verdict = Verdict.USABLE_WITH_WARNING


@dataclass(frozen=True, slots=True)
class CrcValue:
    """The bits of the CRC named."""

    crc: str


@dataclass(frozen=True, slots=True)
class Parity:
    """The bit that makes the count of ones in it and the fields ``of`` even, or odd."""

    of: tuple[str, ...]
    odd: bool = False


@dataclass(frozen=True, slots=True)
class Decimal:
    """A number read as runs of decimal digits, the most significant run first."""

    runs: tuple[Digits, ...]

    @property
    def digits(self) -> int:
        """How many digits it has."""
        return sum(run.digits for run in self.runs)

    @property
    def limit(self) -> int:
        """The lowest number with more digits."""
        return self.runs[0].divisor * self.runs[0].modulus


@dataclass(frozen=True, slots=True)
class Text:
    """Characters, one a byte."""


Kind = Number | Flag | Choice | Constant | Unused | CrcValue | Parity | Decimal | Text
