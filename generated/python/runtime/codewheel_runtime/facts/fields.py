# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Records about fields and registers, and about the CRCs and scales of their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from math import gcd
from typing import TYPE_CHECKING, NamedTuple

from ..reports import ReadOnly

if TYPE_CHECKING:
    from decimal import Decimal
    from fractions import Fraction


NO_NAMES: ReadOnly[str] = ReadOnly({})


class Access(Enum):
    """Access of a master to a register."""

    READ_ONLY = "read_only"
    READ_WRITE = "read_write"
    WRITE_ONLY = "write_only"


class ByteOrder(Enum):
    """Byte order of a number, named after the byte at the lowest address."""

    LOW_BYTE_FIRST = "low_byte_first"
    HIGH_BYTE_FIRST = "high_byte_first"


class AboveMax(Enum):
    """Reaction of an encoder to a value above the maximum: it uses the default, or rejects the value."""

    DEFAULT = "default"
    REFUSED = "refused"


class Crc(NamedTuple):
    """Standard parameters of a CRC. ``poly`` omits the top bit."""

    name: str
    width: int
    poly: int
    init: int
    refin: bool
    refout: bool
    xorout: int
    polynomial: str
    note: str = ""
    source: str = ""


class Scale(NamedTuple):
    """Quantity that a number represents: ``(number * numerator + offset) / denominator``, in ``unit``."""

    numerator: int
    denominator: int
    offset: int
    unit: str
    source: str = ""

    def quantity(self, number: int) -> Fraction:
        """Convert a number to an exact quantity."""
        from fractions import Fraction

        return Fraction(number * self.numerator + self.offset, self.denominator)

    @property
    def places(self) -> int:
        """Number of decimals: as many as an exact value needs, otherwise enough for a tenth of a count."""
        # The quantity is (number * numerator + offset) / denominator. A factor that all three share cancels out.
        reduced_denominator = self.denominator // gcd(self.numerator, self.offset, self.denominator)
        # Decimals are exact if the denominator divides a power of ten, which has at most as many zeros as the
        # denominator has bits. For example, 8 divides 1000, so eighths have three decimals.
        for decimals in range(reduced_denominator.bit_length()):
            if 10**decimals % reduced_denominator == 0:
                return decimals
        # The last decimal must be at most a tenth of a count: 10**-decimals <= (numerator / denominator) / 10.
        decimals = 0
        while 10**decimals * self.numerator < 10 * self.denominator:
            decimals += 1
        return decimals

    def decimal(self, number: int) -> Decimal:
        """Return the quantity for a number with ``places`` decimals.

        It is rounded if the exact value has infinitely many decimals.
        """
        from decimal import Decimal

        scaled_number = number * self.numerator + self.offset
        # The size in units of the last decimal, rounded to the nearest integer.
        units_numerator = abs(scaled_number) * 10**self.places
        units = (2 * units_numerator + self.denominator) // (2 * self.denominator)
        sign = "-" if scaled_number < 0 and units else ""
        # A decimal from text is exact. Arithmetic with decimals would round to the precision of the context.
        return Decimal(f"{sign}{units}E-{self.places}")


class FieldFacts(NamedTuple):
    """Facts about a field. For its position in the frame, see ``bit_fields`` of the class.

    ``active`` is ``high`` or ``low`` for a flag. ``constant`` is the value of a constant field, and ``unused`` is the
    value of unused bits in the manual. ``implemented`` is False for a field that does not exist in this encoder.
    ``reserved`` names the only party that may use it. ``explained_by`` lists register fields with details, as
    ``register.field``. ``zero_means`` is the value that is sent as 0, if there is such a value. ``digit_code`` is the
    code of each digit, such as ``bcd``, if a number is not sent in binary. ``byte_order`` is ``low_byte_first`` or
    ``high_byte_first`` if it is not that of the frame. ``scale`` converts the number to a quantity.
    """

    name: str
    printed_name: str = ""
    meaning: str = ""
    unit: str = ""
    scale: Scale | None = None
    active: str = ""
    when_active: str = ""
    when_inactive: str = ""
    default: int | None = None
    constant: int | None = None
    unused: int | None = None
    signed: bool = False
    zero_means: int = 0
    power_of_two: bool = False
    digit_code: str = ""
    byte_order: str = ""
    implemented: bool = True
    reserved: str = ""
    explained_by: tuple[str, ...] = ()
    names: Mapping[str, str] = NO_NAMES
    note: str = ""
    source: str = ""


class RegisterMeaning(NamedTuple):
    """One of several meanings of a register. It applies while the field ``when`` has the value ``value``.

    ``min`` and ``max`` are its limits as given in the manual. The register's class contains them as numbers.
    """

    name: str
    when: str
    value: str
    min: str = ""
    max: str = ""
    meaning: str = ""
    source: str = ""


class Register(NamedTuple):
    """Register of ``length`` bytes, starting at ``address``.

    If ``opened_by`` is given, that register must hold ``opened_by_value``, in its field ``opened_by_field`` if given,
    before this register can be written. ``wait_ms`` is the minimum time to wait after a write. ``above_max`` is the
    reaction to a value above the maximum. ``write_clears`` lists registers that a write sets to zero. ``reserved``
    names the only party that may use the register.
    """

    name: str
    printed_name: str
    address: int
    length: int
    access: Access
    byte_order: ByteOrder
    default: bytes | None = None
    opened_by: str = ""
    opened_by_field: str = ""
    opened_by_value: str = ""
    clears_itself: bool = False
    wait_ms: int = 0
    volatile: bool = False
    bank: int | None = None
    above_max: AboveMax | None = None
    write_clears: tuple[str, ...] = ()
    meanings: tuple[RegisterMeaning, ...] = ()
    reserved: str = ""
    fields: tuple[FieldFacts, ...] = ()
    names: Mapping[str, str] = NO_NAMES
    meaning: str = ""
    note: str = ""
    source: str = ""


class NamedValue(NamedTuple):
    """Named value of a field."""

    name: str
    value: int
    meaning: str = ""
