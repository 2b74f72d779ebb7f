"""Checks before writing or encoding: limits of registers, and values that do not fit their fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ..model import Device, Digits, Field, Layout, Register, RegisterMeaning
from ..model.expressions import Expression
from ..model.kinds import Choice, Constant, CrcValue, Decimal, Flag, Number, Parity, Text, Unused
from ..model.record import assert_never, dataclass
from .codec import LayoutPlan
from .frame_checks import allowed_values
from .operations import IsBetween, JoinedNumber, JoinNotAbove, NotAbove


@dataclass(frozen=True, slots=True)
class NumberLimits:
    """The limits of a register, or of one of its meanings.

    ``member`` is the limited field or join, or empty if the limits apply to the whole register. ``lowest`` and
    ``highest`` are None if the manual gives no limit. ``can_be_below`` and ``can_be_above`` are true if a value of
    ``width`` bits, signed or unsigned, can be outside the limit. ``number_for_zero`` is the number that the value 0
    encodes, if that is too large for the bits of every order code, such as 256 in 8 bits. Otherwise it is 0.
    """

    member: str
    signed: bool
    width: Expression
    lowest: Expression | None
    highest: Expression | None
    can_be_below: bool
    can_be_above: bool
    number_for_zero: int

    @property
    def bounds_to_check(self) -> tuple[tuple[str, Expression], ...]:
        """``("min", lowest)`` and ``("max", highest)``, each only if a value that fits can be outside it."""
        bounds = []
        if self.lowest is not None and self.can_be_below:
            bounds.append(("min", self.lowest))
        if self.highest is not None and self.can_be_above:
            bounds.append(("max", self.highest))
        return tuple(bounds)


def limits_of(device: Device, register: Register, meaning: RegisterMeaning | None = None) -> NumberLimits:
    """Return the limits of the number in a register or, with ``meaning``, of one of the meanings of this number.

    ``can_be_below`` and ``can_be_above`` are true if the bits can hold numbers outside the limits for any order code.
    """
    part_with_limits = register if meaning is None else meaning
    low, high = part_with_limits.min, part_with_limits.max
    member = limited_member(register)
    fields = _limited_fields(register.layout, member)
    is_join = any(join.name == member for join in register.layout.joins)
    # A join is unsigned, even if one of its fields is signed.
    signed = not is_join and any(field.number.signed for field in fields)
    # Without a limited field or join, the limits apply to the number in the whole register.
    width = register.layout.bits
    if fields:
        width = sum((field.width for field in fields), Expression(0))
    representable_ranges = []
    for variant in device.variants_over(register.interface):
        representable_ranges.append(_representable_range(width, signed, variant.parameters))
    # 0 may encode a number that does not fit in the bits, such as 256 in 8 bits.
    is_single_field = bool(fields) and not is_join
    encoded_as_zero = fields[0].number.zero_means if is_single_field else 0
    is_above_range = all(encoded_as_zero > representable.highest for representable in representable_ranges)
    return NumberLimits(
        member=member,
        signed=signed,
        width=width,
        lowest=low,
        highest=high,
        can_be_below=low is not None and _can_be_below(device, low, representable_ranges),
        can_be_above=high is not None and _can_be_above(device, high, representable_ranges),
        number_for_zero=encoded_as_zero if is_above_range else 0,
    )


class _RepresentableRange(NamedTuple):
    """Lowest and highest number that fits in the bits of an order code with these parameters."""

    parameters: Mapping[str, int]
    lowest: int
    highest: int


def _representable_range(width: Expression, signed: bool, parameters: Mapping[str, int]) -> _RepresentableRange:
    """Return the numbers that fit in a width for one order code, such as 0 to 4095, or -2048 to 2047 if signed."""
    bits = width.value(parameters)
    if signed:
        return _RepresentableRange(parameters, lowest=-(1 << (bits - 1)), highest=(1 << (bits - 1)) - 1)
    return _RepresentableRange(parameters, lowest=0, highest=(1 << bits) - 1)


def _can_be_below(device: Device, low: Expression, representable_ranges: list[_RepresentableRange]) -> bool:
    """Return whether the bits can represent a number below the limit ``low``, for any order code.

    Return true if the limit depends on the content of other registers.
    """
    if _depends_on_registers(device, low):
        return True
    return any(low.value(representable.parameters) > representable.lowest for representable in representable_ranges)


def _can_be_above(device: Device, high: Expression, representable_ranges: list[_RepresentableRange]) -> bool:
    """Return whether the bits can represent a number above the limit ``high``, for any order code.

    Return true if the limit depends on the content of other registers.
    """
    if _depends_on_registers(device, high):
        return True
    return any(high.value(representable.parameters) < representable.highest for representable in representable_ranges)


def _depends_on_registers(device: Device, limit: Expression) -> bool:
    """Return whether a limit contains a parameter that a register of the encoder holds at run time."""
    run_time_names = {parameter.name for parameter in device.run_time_parameters}
    return not run_time_names.isdisjoint(limit.parameters)


def _limited_fields(layout: Layout, member: str) -> list[Field]:
    """Return the fields that form the limited number: those of the join ``member``, or only the field ``member``.

    A join is a number that several fields form together. The list is empty if ``member`` is empty, because the limits
    then apply to the number in the whole register.
    """
    for join in layout.joins:
        if join.name == member:
            return [layout.field(name) for name in join.fields]
    return [layout.field(member)] if member else []


def limited_member(register: Register) -> str:
    """Return the name of the field or joined number to which the limits of the register apply.

    Return an empty string if they apply to the number in the whole register. A register with a single field has the
    limits of this field.
    """
    layout = register.layout
    if register.limits_of in layout.member_names:
        return register.limits_of
    has_single_field = len(layout.fields) == 1
    return layout.fields[0].name if has_single_field else ""


@dataclass(frozen=True, slots=True)
class NotOneOf:
    """The value is not listed."""

    field: Field
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class NotSigned:
    """The number does not fit in two's complement."""

    field: Field


@dataclass(frozen=True, slots=True)
class NotZeroFor:
    """The number is 0, or it is above the maximum and is not the value that 0 encodes."""

    field: Field
    number_for_zero: int


@dataclass(frozen=True, slots=True)
class NoPowerOfTwo:
    """The number is not a power of two. A separate check tests its range."""

    field: Field


@dataclass(frozen=True, slots=True)
class TooWide:
    """The number has more bits than the field."""

    field: Field
    width: Expression


@dataclass(frozen=True, slots=True)
class TooHigh:
    """The number is above the highest one, which always fits in the field."""

    field: Field
    highest: Expression


@dataclass(frozen=True, slots=True)
class NotBetween:
    """The signed number is outside its range, which always fits in the field."""

    field: Field
    lowest: Expression
    highest: Expression


@dataclass(frozen=True, slots=True)
class DigitTooHigh:
    """A group of digits has too many digits."""

    field: Field
    run: Digits


@dataclass(frozen=True, slots=True)
class DigitsDisagree:
    """The runs of digits do not match the number, in languages that keep both."""

    field: Field
    runs: tuple[Digits, ...]


@dataclass(frozen=True, slots=True)
class JoinDisagrees:
    """The fields of a join do not match its number, in languages that keep both."""

    joined_number: JoinedNumber


@dataclass(frozen=True, slots=True)
class JoinTooHigh:
    """The number of a join is above the highest one, which its fields could hold."""

    joined_number: JoinedNumber
    highest: Expression


@dataclass(frozen=True, slots=True)
class OutsideLimits:
    """The member is outside a limit of its register. ``bounds`` are the limits to check."""

    member: str
    bounds: tuple[tuple[str, Expression], ...]


Refusal = (
    NotOneOf
    | NotSigned
    | NotZeroFor
    | NoPowerOfTwo
    | TooWide
    | TooHigh
    | NotBetween
    | DigitTooHigh
    | DigitsDisagree
    | JoinDisagrees
    | JoinTooHigh
    | OutsideLimits
)


def refusals(layout_plan: LayoutPlan) -> Iterator[Refusal]:
    """Yield the reasons for which an encoder of this layout rejects a value, in the order of the fields.

    The range of a position replaces all other checks of its field. Limits of a register are not included.
    """
    range_checks = {check.field.name: check for check in layout_plan.checks if isinstance(check, (NotAbove, IsBetween))}
    for decoded_field in layout_plan.decoded_fields:
        field = decoded_field.field
        match range_checks.get(field.name):
            case NotAbove(highest=highest):
                yield TooHigh(field, highest)
            case IsBetween(lowest=lowest, highest=highest):
                yield NotBetween(field, lowest, highest)
            case None:
                yield from _field_refusals(layout_plan.layout, field)
    for joined_number in layout_plan.joined_numbers:
        yield JoinDisagrees(joined_number)
    for check in layout_plan.checks:
        if isinstance(check, JoinNotAbove):
            yield JoinTooHigh(check.joined_number, check.highest)


def powers_of_two(layout_plan: LayoutPlan) -> frozenset[str]:
    """Return the names of the fields whose numbers must be powers of two."""
    return frozenset(refusal.field.name for refusal in refusals(layout_plan) if isinstance(refusal, NoPowerOfTwo))


def limits_check_of(layout_plan: LayoutPlan, limits: NumberLimits) -> OutsideLimits | None:
    """Return the check that a field or joined number is within the limits of its register.

    Return None if the limits apply to the whole register, or if the bits cannot represent a number outside the limits.
    A minimum of 1 is omitted if another check rejects 0: a field in which the bits 0 encode another number, or a field
    for powers of two.
    """
    if not limits.member:
        return None
    bounds = limits.bounds_to_check
    minimum_of_1 = ("min", Expression(1))
    for decoded_field in layout_plan.decoded_fields:
        number = decoded_field.field.number
        rejects_zero = bool(number.zero_means) or number.power_of_two
        if rejects_zero and decoded_field.name == limits.member:
            bounds = tuple(bound for bound in bounds if bound != minimum_of_1)
    return OutsideLimits(limits.member, bounds) if bounds else None


def depends_on_order_code(refusal: Refusal) -> bool:
    """Return whether the width or the limit that a check compares with differs between order codes."""
    match refusal:
        case NotSigned(field) | NotZeroFor(field):
            return not field.width.is_constant
        case TooWide(width=width):
            return not width.is_constant
        case TooHigh(highest=highest) | JoinTooHigh(highest=highest):
            return not highest.is_constant
        case NotBetween(lowest=lowest, highest=highest):
            return not (lowest.is_constant and highest.is_constant)
        case JoinDisagrees(joined_number):
            return joined_number.depends_on_order_code
        case OutsideLimits(bounds=bounds):
            return not all(limit.is_constant for _, limit in bounds)
        case NotOneOf() | NoPowerOfTwo() | DigitTooHigh() | DigitsDisagree():
            return False
        case _:
            assert_never(refusal)


def _field_refusals(layout: Layout, field: Field) -> Iterator[Refusal]:
    """Yield the reasons for which an encoder rejects a value of one field, except the range of a position."""
    valid_values = allowed_values(layout, field)
    if valid_values:
        yield NotOneOf(field, valid_values)
        return
    match field.kind:
        case Number() as number:
            yield _number_refusal(field, number)
            if number.power_of_two:
                yield NoPowerOfTwo(field)
        case Choice():  # All numbers that fit are valid.
            yield TooWide(field, field.width)
        case Decimal(runs=runs):
            for digit_group in runs:
                yield DigitTooHigh(field, digit_group)
            yield DigitsDisagree(field, runs)
        case Flag() if not field.width.is_constant:
            yield TooWide(field, field.width)
        case Flag() | Text() | Constant() | Unused() | CrcValue() | Parity():
            return
        case _:
            assert_never(field.kind)


def _number_refusal(field: Field, number: Number) -> Refusal:
    """Return the check that a number fits in its field: as signed, as unsigned, or as unsigned except 0.

    In the last case, the bits 0 encode the number ``zero_means``.
    """
    if number.signed:
        return NotSigned(field)
    if number.zero_means:
        return NotZeroFor(field, number.zero_means)
    return TooWide(field, field.width)
