"""The kinds of fields, which define how bits become a value. Each kind has only the facts specific to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from .facts import Sources

#: Meaning of an active flag that the manual explains for other order codes only.
UNEXPLAINED = "the manual does not say what this bit means for this order code"


class Verdict(Enum):
    """Usability of the position in a valid frame, from worst to best.

    UNKNOWN: no flag of the frame gives any information.
    C and the Python columns number the verdicts in this order. The most severe one decides, so a warning never makes a
    position better than no information.
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
    """An integer, in two's complement if ``signed``. All bits 0 mean ``zero_means``."""

    signed: bool = False
    zero_means: int = 0
    power_of_two: bool = False


@dataclass(frozen=True, slots=True)
class Flag:
    """One bit, true when active.

    ``makes_position`` is the verdict on the position in the same frame while the flag is active, or None without a
    position. ``sums_up`` names the flags that it combines. All of this holds for the order codes ``only``, those whose
    parameter ``only_while`` is not 0. For the others, an active flag is ``unexplained``.
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
        """The flag for order codes for which the manual does not explain it."""
        worth = None if self.makes_position is None else Verdict.USABLE_WITH_WARNING
        return Flag(self.active_low, UNEXPLAINED, makes_position=worth)


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the named values."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Constant:
    """Always the same bits.

    ``padding_of`` names the field that the zeros pad. The two together fill its ``container`` from the low end. Zeros
    that fill a gap between fields are not in the spec: they follow from their neighbours.
    """

    value: int = 0
    padding_of: str = ""
    fills_gap: bool = False


@dataclass(frozen=True, slots=True)
class Unused:
    """Reserved bits. This encoder sends ``value``, similar ones may send anything.

    Other values are reported, not rejected. ``makes_position`` is the verdict on the position in that case.
    """

    value: int = 0
    makes_position: Verdict = Verdict.USABLE_WITH_WARNING


@dataclass(frozen=True, slots=True)
class CrcValue:
    """The bits of the named CRC."""

    crc: str


@dataclass(frozen=True, slots=True)
class Parity:
    """A bit that makes the number of ones in itself and the fields ``of`` even or odd."""

    of: tuple[str, ...]
    odd: bool = False


@dataclass(frozen=True, slots=True)
class Decimal:
    """A number read as runs of decimal digits, the most significant run first."""

    runs: tuple[Digits, ...]

    @property
    def digits(self) -> int:
        """Number of digits."""
        return sum(run.digits for run in self.runs)

    @property
    def limit(self) -> int:
        """Lowest number with more digits."""
        return self.runs[0].divisor * self.runs[0].modulus


@dataclass(frozen=True, slots=True)
class Text:
    """Characters, one per byte."""


Kind = Number | Flag | Choice | Constant | Unused | CrcValue | Parity | Decimal | Text
