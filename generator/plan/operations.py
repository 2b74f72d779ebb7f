"""Operations of decoders and encoders, independent of any language: bits to extract, checks, CRCs and terms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import BitSlice, Crc, Digits, Fault, Field, Flag, Join, Parity, assert_never
from ..model.expressions import Expression
from ..model.record import dataclass
from .crcs import FoldStep
from .values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    Meaning,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
    meaning_of,
)


@dataclass(frozen=True, slots=True)
class FieldBits:
    """``width`` bits of the word, starting at ``low``.

    ``bit_slices`` describe the same bits in bytes, lowest bits first. ``has_no_bits_above`` is true if there are no
    bits above them, so a shift is enough to extract them. ``widest`` is the largest width of any order code.
    """

    low: Expression
    width: Expression
    widest: int
    has_no_bits_above: bool
    bit_slices: tuple[BitSlice, ...]

    @property
    def are_fixed(self) -> bool:
        """True if the bits have the same position for every order code."""
        return self.low.is_constant and self.width.is_constant


# -- frame checks


@dataclass(frozen=True, slots=True)
class AlwaysIs:
    """The field is a constant."""

    field: Field
    bits: FieldBits
    value: int
    fault = Fault.CONSTANT


@dataclass(frozen=True, slots=True)
class ZerosAbove:
    """All bits above ``field`` in its container are 0. In the spec, these bits are the constant ``padding``.

    The container is the number of whole bytes in which the field is sent. ``bits`` are the bits of the field, in the
    bytes that it can occupy. ``bytes_beyond_field`` are the bytes of the container that it never occupies.
    """

    field: Field
    padding: Field
    bits: FieldBits
    bytes_beyond_field: tuple[BitSlice, ...]
    fault = Fault.CONSTANT

    @property
    def shares_bytes_with_field(self) -> bool:
        """True if the bytes that the field occupies also contain bits above it, for at least one order code."""
        bits_of_occupied_bytes = self.field.container - 8 * len(self.bytes_beyond_field)
        # If the width depends on the order code, none of the bits belongs to the field for every order code.
        # A family reduced to one order code keeps ``widest``, so the constant width can be smaller.
        bits_always_in_field = self.bits.width.constant if self.bits.width.is_constant else 0
        return bits_of_occupied_bytes > bits_always_in_field


@dataclass(frozen=True, slots=True)
class ParityIs:
    """The bit is the parity of ``covered_fields``: 1 for an odd number of ones or, with ``odd``, for an even number.

    ``mask`` is the mask of the bits of each field that count, or 0 if all of them count. ``known_parity`` is the only
    valid value of the bit in this frame if it covers a single field with a single value, or else None.
    """

    field: Field
    bits: FieldBits
    covered_fields: tuple[Field, ...]
    covered_bits: tuple[FieldBits, ...]
    odd: bool
    mask: int
    known_parity: int | None
    fault = Fault.CONSTANT

    @property
    def selector(self) -> Field:
        """The single field that the parity bit covers. Only for checks with a ``known_parity``."""
        (field,) = self.covered_fields
        return field


@dataclass(frozen=True, slots=True)
class IsOneOf:
    """The field has one of these values: its named values or, for a selector, those that identify this frame."""

    field: Field
    bits: FieldBits
    values: tuple[int, ...]
    fault = Fault.RANGE


@dataclass(frozen=True, slots=True)
class AtMost:
    """The field is a decimal number with at most as many digits as all ``runs`` together."""

    field: Field
    bits: FieldBits
    limit: int
    runs: tuple[Digits, ...]
    fault = Fault.RANGE

    @property
    def digits(self) -> int:
        """Number of digits."""
        return sum(run.digits for run in self.runs)


@dataclass(frozen=True, slots=True)
class NotAbove:
    """The field is at most ``highest``, which is lower than its width allows for some order codes.

    ``code`` is the name of the code of its digits, if they are sent separately. Other codes are above ``highest``.
    """

    field: Field
    bits: FieldBits
    highest: Expression
    code: str = ""
    fault = Fault.RANGE


@dataclass(frozen=True, slots=True)
class IsBetween:
    """The signed field is from ``lowest`` to ``highest``, fewer numbers than its width allows for some order codes."""

    field: Field
    bits: FieldBits
    lowest: Expression
    highest: Expression
    fault = Fault.RANGE


@dataclass(frozen=True, slots=True)
class JoinNotAbove:
    """The number that several fields form is at most ``highest``, which is lower than their width allows.

    ``bits`` are those of ``field``, its most significant field.
    """

    joined_number: JoinedNumber
    bits: FieldBits
    highest: Expression
    fault = Fault.RANGE

    @property
    def field(self) -> Field:
        """Most significant field of the number."""
        return self.joined_number.fields[0]


Check = AlwaysIs | ZerosAbove | ParityIs | IsOneOf | AtMost | NotAbove | IsBetween | JoinNotAbove


def checks_of_meaning(field: Field, bits: FieldBits) -> Iterator[Check]:
    """Yield a range check if the bits of a field can contain a number that has no meaning.

    This is the case for decimal digits: 4 digits need 14 bits, which can also contain a number above 9999. Lists of
    valid values are checked elsewhere.
    """
    match meaning_of(field):
        case DecimalDigits(runs):
            # The runs split the decimal number, most significant first: number // divisor % modulus.
            most_significant_run = runs[0]
            highest = most_significant_run.divisor * most_significant_run.modulus - 1
            yield AtMost(field, bits, highest, runs)
        case UnsignedNumber() | TwosComplement() | ZeroMeans() | ActiveFlag() | NamedChoice() | Latin1Text():
            return
        case meaning:
            assert_never(meaning)


@dataclass(frozen=True, slots=True)
class FrameCrc:
    """A CRC at the end of a frame.

    It covers ``covered_width`` bits from ``lowest_covered_bit`` on, which is everything before the CRC unless
    ``covers_part_only`` is true. ``is_checked_by_division`` is true if the polynomial divides every valid word once the
    final XOR is removed. ``steps``, if any, then reduce the word without a table. If only some order codes have it,
    ``bits`` is its place in their frames.
    """

    crc: Crc
    field: Field
    bits: FieldBits
    covered_width: Expression
    lowest_covered_bit: int
    covers_part_only: bool
    is_checked_by_division: bool
    steps: tuple[FoldStep, ...]

    @property
    def is_optional(self) -> bool:
        """True if only some order codes have the CRC: codes for which the width of the field is not 0."""
        return not self.field.width.is_constant

    @property
    def bits_between(self) -> int:
        """Number of bits between the CRC and the lowest bit that it covers."""
        # The CRC is at bit 0, below the bits that it covers.
        return self.lowest_covered_bit - self.crc.width

    @property
    def inverted_mask(self) -> int:
        """Mask of the CRC bits that are sent inverted."""
        return self.crc.xorout


@dataclass(frozen=True, slots=True)
class Gray:
    """The bits are sent in Gray code if the parameter ``when`` is not 0, or always if ``when`` is empty.

    ``excess`` is added to the number before it is sent, modulo the numbers that fit into the bits.
    """

    low: Expression
    width: Expression
    when: str
    excess: Expression = Expression(0)

    @property
    def depends_on_order_code(self) -> bool:
        """True if the code, or the position of its bits, depends on the order code."""
        return bool(self.when) or not all(number.is_constant for number in (self.low, self.width, self.excess))

    @property
    def has_excess(self) -> bool:
        """True if the excess is not 0 for every order code."""
        return self.excess != Expression(0)


@dataclass(frozen=True, slots=True)
class DigitCoding:
    """The bits are sent as digits of ``digit_bits`` bits. ``codes`` has the code of each digit, from 0 up.

    Before all else, a decoder converts them to the number. Bits with another code become all 1, which is above the
    highest number.
    """

    low: Expression
    width: Expression
    digit_bits: int
    codes: tuple[int, ...]

    @property
    def packed_codes(self) -> int:
        """All codes as one number, with the code of the digit 0 in its lowest bits."""
        return sum(code << self.digit_bits * digit for digit, code in enumerate(self.codes))


# -- parts of a frame


@dataclass(frozen=True, slots=True)
class FieldToDecode:
    """A field of a decoded frame. ``is_shared`` is true if a join or a parity bit also uses its bits."""

    field: Field
    bits: FieldBits
    is_shared: bool

    @property
    def name(self) -> str:
        return self.field.name

    @property
    def meaning(self) -> Meaning:
        """Operation that converts its bits."""
        return meaning_of(self.field)


@dataclass(frozen=True, slots=True)
class JoinedNumber:
    """A join: several fields as one number, most significant first. ``bits`` is set if they are adjacent."""

    join: Join
    fields: tuple[Field, ...]
    width: Expression
    widest: int
    bits: FieldBits | None

    @property
    def name(self) -> str:
        """Name of the join."""
        return self.join.name

    @property
    def fields_from_low(self) -> Iterator[tuple[Field, Expression]]:
        """Yield its fields, lowest first, each with the position of its lowest bit in the number."""
        lowest_bit = Expression(0)
        for field in reversed(self.fields):
            yield field, lowest_bit
            lowest_bit += field.width

    def number_of(self, numbers: Mapping[str, int], parameters: Mapping[str, int]) -> int:
        """Return the number that the fields form together, for an order code with these parameters.

        ``numbers`` has the number in each field, by the name of the field.
        """
        return sum(numbers[field.name] << low.value(parameters) for field, low in self.fields_from_low)

    def field_numbers(self, number: int, parameters: Mapping[str, int]) -> dict[str, int]:
        """Split ``number`` into the numbers of the fields that form it, and return them by the names of the fields.

        This is the inverse of ``number_of``. ``parameters`` are those of an order code.
        """
        field_numbers: dict[str, int] = {}
        for field, low in self.fields_from_low:
            mask = (1 << field.width.value(parameters)) - 1
            field_numbers[field.name] = (number >> low.value(parameters)) & mask
        return field_numbers

    @property
    def depends_on_order_code(self) -> bool:
        """True if the position of any of its fields depends on the order code."""
        return not all(low.is_constant for _, low in self.fields_from_low)


@dataclass(frozen=True, slots=True)
class Reserved:
    """Reserved bits. A decoder reports unexpected values but does not reject them.

    A decoded frame contains one number for all reserved bits, ``unused``. Its bits from ``lowest_bit_in_unused`` on are
    1 where this field differs from ``value``.
    """

    field: Field
    bits: FieldBits
    value: int
    lowest_bit_in_unused: int

    @property
    def mask(self) -> int:
        """Mask of its bits in ``unused``."""
        return ((1 << self.bits.widest) - 1) << self.lowest_bit_in_unused


@dataclass(frozen=True, slots=True)
class ConstantNumber:
    """A number that is the same in every frame of this layout."""

    number: int


@dataclass(frozen=True, slots=True)
class ValueOfField:
    """The value of a field. The inverse of its meaning converts it to bits."""

    field: Field

    @property
    def meaning(self) -> Meaning:
        """Operation whose inverse converts the value."""
        return meaning_of(self.field)


@dataclass(frozen=True, slots=True)
class ParityOf:
    """The parity bit over several fields. ``mask`` is the mask of the bits of each that count, or 0 for all bits."""

    covered_fields: tuple[Field, ...]
    odd: bool
    mask: int


@dataclass(frozen=True, slots=True)
class ReservedBits:
    """Reserved bits: ``value``, with those bits inverted that are 1 in ``unused``, from ``lowest_bit_in_unused`` on."""

    value: int
    lowest_bit_in_unused: int


@dataclass(frozen=True, slots=True)
class FieldToEncode:
    """One field of an encoded frame, other than the CRC."""

    field: Field
    bits: FieldBits
    value: ConstantNumber | ValueOfField | ParityOf | ReservedBits

    @property
    def name(self) -> str:
        return self.field.name

    @property
    def depends_on_order_code(self) -> bool:
        """True if the code that encodes the field needs parameters of the order code.

        This is the case if its position depends on the order code. It is also the case if its width does, and the bits
        are computed from the width: for a signed number, and for a flag or parity bit that some order codes lack.
        """
        has_fixed_position = self.field.low.is_constant
        needs_width = self.field.number.signed or isinstance(self.field.kind, (Flag, Parity))
        return not has_fixed_position or (needs_width and not self.field.width.is_constant)
