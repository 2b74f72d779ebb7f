"""Kinds of fields. The kind defines how bits are converted to a value. Each kind has only its own facts.

Each kind also states the facts that modules of all layers need, so that these need no list of kinds:

- ``word`` is its name in sentences about a change of the kind.
- ``role`` is its part in a frame. Only data matter to users of a decoded frame.
- ``is_joinable`` is true if a joined number can contain the bits, because its value is the number formed by its bits.
- ``value_at_rest`` is a valid value of a field that has no other source: the value of the bits 0 if possible.
- ``makes_position`` is the verdict on the position while a bit differs from its normal value, or None.
- ``digit_code`` is the code of its bits, a key of ``DIGIT_CODES``, or empty. Decoders reject bits outside the code.

mypy reports a kind that lacks one of them where a module reads it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from math import gcd
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple

from .manual import Sources
from .part import Name, Prose, fact, key, meaning_key, name_key, part, source_key
from .record import dataclass

if TYPE_CHECKING:
    from fractions import Fraction


#: Part of a field in a frame: data of three forms, a check of other bits, or bits that are always the same.
Role = Literal["data", "flag", "choice", "check", "fixed"]
#: Roles of fields that carry data, which is neither constant nor derived from other fields.
DATA_ROLES: frozenset[Role] = frozenset(("data", "flag", "choice"))

#: Meaning of an active flag that the manual explains only for other order codes.
UNEXPLAINED = "the manual does not say what this bit means for this order code"


class Verdict(Enum):
    """Usability of the position in a valid frame, from worst to best.

    UNKNOWN: no flag of the frame gives any information.
    C and the Python columns number the verdicts in this order. The most severe one applies, so UNKNOWN beats a warning.
    """

    NOT_USABLE = "not_usable"
    UNKNOWN = "unknown"
    USABLE_WITH_WARNING = "usable_with_warning"
    USABLE = "usable"


@dataclass(frozen=True, slots=True)
class Value:
    """A named value of a field or register. ``makes_position`` is the verdict on the position in the same frame."""

    name: str
    value: int
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    source: Sources
    makes_position: Verdict | None = None


class DigitCode(NamedTuple):
    """A code in which each digit of a number is sent separately, the most significant digit first.

    Attributes:
        name: Name of the code.
        bits: Number of bits of a digit. The most significant digit can have fewer.
        codes: Code of each digit, from 0 up. Their number is the base.
    """

    name: str
    bits: int
    codes: tuple[int, ...]

    def highest(self, width: int) -> int:
        """Return the highest number that fits in ``width`` bits, such as 399 in 10 bits of BCD.

        The result is -1 if the first digit has too few bits for the code of 0, as in 5 bits of excess-3.
        """
        base = len(self.codes)
        complete_digits, bits_of_top_digit = divmod(width, self.bits)
        # Number of digits, from 0 up, whose code fits in the bits of the first digit.
        possible_top_digits = 1
        if bits_of_top_digit:
            too_wide_digits = (digit for digit, code in enumerate(self.codes) if code >> bits_of_top_digit)
            possible_top_digits = next(too_wide_digits, base)
        return possible_top_digits * int(base**complete_digits) - 1


class WholeCode(NamedTuple):
    """A code whose only digit fills the field, such as one-hot code: 0001, 0010, 0100 and 1000 in 4 bits.

    Attributes:
        name: Name of the code.
        codes_of: Function that returns the codes of the numbers from 0 up for a field of that many bits.
    """

    name: str
    codes_of: Callable[[int], Iterable[int]]


#: Codes of digits, by their name in specs.
DIGIT_CODES: Mapping[str, DigitCode | WholeCode] = MappingProxyType({"bcd": DigitCode("BCD", 4, tuple(range(10)))})


def code_in_field(code_name: str, bit_count: int) -> DigitCode | None:
    """Return the code ``code_name`` of ``DIGIT_CODES`` for a field of ``bit_count`` bits, or None without a name."""
    if not code_name:
        return None
    digit_code = DIGIT_CODES[code_name]
    if isinstance(digit_code, WholeCode):
        return DigitCode(name=digit_code.name, bits=bit_count, codes=tuple(digit_code.codes_of(bit_count)))
    return digit_code


@part("A group of decimal digits.", data="Decimal digits inside a number: number // divisor % modulus.")
class Digits:
    """A run of decimal digits within a number: ``number // divisor % modulus``."""

    name: Name = name_key("Name of the number that these digits form.")
    digits: int = key("Number of digits.", minimum=1, maximum=18)
    divisor: int = fact("Ten to the power of the number of less significant digits.")
    modulus: int = fact("Ten to the power of the number of these digits.")
    meaning: Prose = meaning_key("Meaning of the number.", default="")


@dataclass(frozen=True, slots=True)
class Number:
    """An integer, in two's complement if ``signed``. If all bits are 0, the value is ``zero_means``.

    With ``digit_code``, a key of ``DIGIT_CODES``, each digit is sent separately.
    """

    word: ClassVar[str] = "number"
    role: ClassVar[Role] = "data"
    makes_position: ClassVar[Verdict | None] = None
    signed: bool = False
    zero_means: int = 0
    power_of_two: bool = False
    digit_code: str = ""

    @property
    def is_joinable(self) -> bool:
        """True if the value is the number formed by the bits."""
        return not self.signed and not self.zero_means and not self.digit_code

    @property
    def value_at_rest(self) -> int:
        """The number that the bits 0 represent, or 1 if only powers of two are valid, since 0 is not one of them."""
        return 1 if self.power_of_two else self.zero_means


@dataclass(frozen=True, slots=True)
class Flag:
    """One bit, true when active.

    ``makes_position`` is the verdict on the position in the same frame while the flag is active: whether the position
    is usable. It is None in a frame without a position. If an answer of the user sets ``verdict_parameter`` to 1, the
    verdict is ``verdict_if_set`` instead. ``sums_up`` lists the flags that it combines: it is active while one of them
    is. All of this applies to the order codes ``only``, for which the parameter ``only_while`` is not 0. For all other
    order codes, the manual does not explain the flag.
    """

    word: ClassVar[str] = "flag"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "flag"
    value_at_rest: ClassVar[int] = 0
    active_low: bool = False
    when_active: str = ""
    when_inactive: str = ""
    makes_position: Verdict | None = None
    sums_up: tuple[str, ...] = ()
    only: str = ""
    only_while: str = ""
    verdict_parameter: str = ""
    verdict_if_set: Verdict | None = None

    @property
    def is_joinable(self) -> bool:
        """True if the bit 1 means active."""
        return not self.active_low

    @property
    def unexplained(self) -> Flag:
        """The same flag for order codes for which the manual does not explain it.

        While it is active, the position is usable with a warning.
        """
        verdict = None if self.makes_position is None else Verdict.USABLE_WITH_WARNING
        return Flag(active_low=self.active_low, when_active=UNEXPLAINED, makes_position=verdict)


@dataclass(frozen=True, slots=True)
class Choice:
    """One of several named values."""

    word: ClassVar[str] = "named values"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "choice"
    is_joinable: ClassVar[bool] = True
    makes_position: ClassVar[Verdict | None] = None
    values: tuple[Value, ...]

    @property
    def value_at_rest(self) -> int:
        """Number of the first named value, since 0 may have no name."""
        return self.values[0].value


@dataclass(frozen=True, slots=True)
class Constant:
    """Bits that are always the same.

    ``padding_of`` is the name of the field that the zeros pad. Field and zeros together fill the field's ``container``
    from the low end. Zeros that fill a gap between fields are not in the spec. They follow from the neighboring
    fields. Zeros that fill the first byte of a frame of bits are not on the line either.
    """

    word: ClassVar[str] = "fixed bits"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "fixed"
    is_joinable: ClassVar[bool] = False
    value_at_rest: ClassVar[int] = 0
    makes_position: ClassVar[Verdict | None] = None
    value: int = 0
    padding_of: str = ""
    fills_gap: bool = False
    fills_byte: bool = False


@dataclass(frozen=True, slots=True)
class Unused:
    """Reserved bits. This encoder sends ``value``. Other encoders of the same kind may send any value.

    Other values are reported, not rejected. ``makes_position`` is the verdict on the position in that case.
    """

    word: ClassVar[str] = "unused bits"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "fixed"
    is_joinable: ClassVar[bool] = False
    value_at_rest: ClassVar[int] = 0
    value: int = 0
    makes_position: Verdict = Verdict.USABLE_WITH_WARNING


@dataclass(frozen=True, slots=True)
class CrcValue:
    """The bits of the named CRC. It covers the adjacent fields ``of`` or, without them, everything sent before it."""

    word: ClassVar[str] = "CRC"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "check"
    is_joinable: ClassVar[bool] = False
    value_at_rest: ClassVar[int] = 0
    makes_position: ClassVar[Verdict | None] = None
    crc: str
    of: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Parity:
    """A bit that makes the number of ones even or odd, counting this bit and the bits of the fields ``of``.

    ``over`` selects the bits of each field that count: ``odd_bits``, ``even_bits``, or all if it is empty. Bit 0 is the
    least significant bit of the field. ``constants`` are covered as well. Their 1 bits are already counted in ``odd``,
    and ``turned`` is true if their number is odd.
    """

    word: ClassVar[str] = "parity"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "check"
    is_joinable: ClassVar[bool] = False
    value_at_rest: ClassVar[int] = 0
    makes_position: ClassVar[Verdict | None] = None
    of: tuple[str, ...]
    odd: bool = False
    over: str = ""
    constants: tuple[str, ...] = ()
    turned: bool = False

    @property
    def mask(self) -> int:
        """Mask of the bits that count in each covered field, which has at most 64 bits."""
        match self.over:
            case "odd_bits":
                return 0xAAAA_AAAA_AAAA_AAAA
            case "even_bits":
                return 0x5555_5555_5555_5555
        return 0xFFFF_FFFF_FFFF_FFFF

    @property
    def covers(self) -> tuple[str, ...]:
        """All fields that the bit covers."""
        return (*self.constants, *self.of)

    @property
    def is_odd(self) -> bool:
        """True if the number of 1 bits is odd in a valid frame, counting this bit, covered fields and constants."""
        return self.odd != self.turned


@dataclass(frozen=True, slots=True)
class Decimal:
    """A number formed by runs of decimal digits, most significant run first."""

    word: ClassVar[str] = "decimal digits"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "data"
    is_joinable: ClassVar[bool] = True
    value_at_rest: ClassVar[int] = 0
    makes_position: ClassVar[Verdict | None] = None
    runs: tuple[Digits, ...]

    @property
    def digits(self) -> int:
        """Number of digits."""
        return sum(run.digits for run in self.runs)

    @property
    def limit(self) -> int:
        """Lowest number with too many digits."""
        return self.runs[0].divisor * self.runs[0].modulus


@dataclass(frozen=True, slots=True)
class Text:
    """Characters, one per byte."""

    word: ClassVar[str] = "text"
    digit_code: ClassVar[str] = ""
    role: ClassVar[Role] = "data"
    is_joinable: ClassVar[bool] = False
    value_at_rest: ClassVar[int] = 0
    makes_position: ClassVar[Verdict | None] = None


#: Kinds whose value a user gives when a frame is encoded.
DataKind = Number | Flag | Choice | Decimal | Text
Kind = DataKind | Constant | Unused | CrcValue | Parity


#: Widest field that can have a scale. With the limits of the schema, C computes the quantity in 64 bits.
WIDEST = 32


@part(
    "For a number of at most 32 bits: the quantity that it stands for, (number × numerator + "
    "offset) / denominator. For (number + 152) / 2.776 °C: {numerator: 1000, denominator: 2776, "
    "offset: 152000, unit: °C}. Decoders return the number itself. Its default, limits and "
    "documented value are numbers as well.",
    data="The quantity (number * numerator + offset) / denominator.",
    kw_only=False,
)
class Scale:
    """The quantity ``(number * numerator + offset) / denominator``, in ``unit``.

    The offset is added before the division, so that three whole numbers express every linear formula exactly.
    """

    numerator: int = key("Factor of the number.", minimum=1, maximum=16777216)
    denominator: int = key("Divisor of the sum.", minimum=1, maximum=16777216)
    offset: int = key(
        "Number that is added to the product before the division, such as -80 for number / 2 - 40 with "
        "the denominator 2.",
        data="Number that is added to the product before the division.",
        minimum=-1000000000000,
        maximum=1000000000000,
    )
    unit: Literal[
        "%",
        "A",
        "Hz",
        "K",
        "V",
        "kHz",
        "mA",
        "mT",
        "mV",
        "mm",
        "ms",
        "nm",
        "rpm",
        "s",
        "°",
        "°/s",
        "°C",
        "°F",
        "µm",
        "µs",
        "Ω",
    ] = key("Unit of the quantity.", data_type="string")
    source: Sources = source_key(default=())

    def quantity(self, number: int) -> Fraction:
        """Convert a number to an exact quantity."""
        from fractions import Fraction

        return Fraction(number * self.numerator + self.offset, self.denominator)

    @property
    def places(self) -> int:
        """Number of decimal places that show every quantity exactly or, if there is none, to a tenth of a count.

        The quantity of a number is (number * numerator + offset) / denominator.
        """
        # Without common factors, 250 / 1000 has the denominator 4.
        reduced_denominator = self.denominator // gcd(self.numerator, self.offset, self.denominator)
        # Only denominators whose factors are all two or five have exact decimals, with fewer places than the
        # denominator has bits: 1/4 is 0.25.
        for places in range(reduced_denominator.bit_length()):
            is_exact = 10**places % reduced_denominator == 0
            if is_exact:
                return places
        # A tenth of a count is ``numerator / denominator / 10``.
        places = 0
        while 10**places * self.numerator < 10 * self.denominator:
            places += 1
        return places

    def decimal(self, number: int) -> str:
        """Return the quantity for a number with ``places`` decimal places. Halves are rounded away from 0."""
        # The quantity is this number divided by the denominator.
        dividend = number * self.numerator + self.offset
        # The size of the quantity in units of the last decimal place. Adding half a unit before the division, which
        # rounds down, rounds it to the nearest: n / d + 1 / 2 is (2 * n + d) / (2 * d).
        units_of_last_place = (2 * abs(dividend) * 10**self.places + self.denominator) // (2 * self.denominator)
        sign = "-" if units_of_last_place and dividend < 0 else ""
        # At least one digit before the decimal point.
        digits = f"{units_of_last_place:0{self.places + 1}}"
        if not self.places:
            return sign + digits
        return f"{sign}{digits[: -self.places]}.{digits[-self.places :]}"

    def is_exact(self, number: int) -> bool:
        """Return True if the quantity for a number is exactly the decimal with ``places`` decimal places."""
        units_of_last_place: int = (number * self.numerator + self.offset) * 10**self.places
        return units_of_last_place % self.denominator == 0
