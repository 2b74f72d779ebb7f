"""The description of a frame or register, as data, for outputs that interpret data instead of printing statements.

Python prints it as literals for many frames at once, the browser as JSON. Positions are bit positions in the number
that the bytes form. A member that has its default may be omitted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field as dataclass_field
from dataclasses import replace
from typing import NamedTuple

from ..model import Fault, Field, Flag, Scale, Verdict
from ..model.expressions import Expression
from ..model.record import assert_never, dataclass
from . import verdicts
from .codec import LayoutPlan
from .limits import powers_of_two
from .operations import (
    AlwaysIs,
    AtMost,
    ConstantNumber,
    DigitCoding,
    FrameCrc,
    Gray,
    IsBetween,
    IsOneOf,
    JoinedNumber,
    JoinNotAbove,
    NotAbove,
    ParityIs,
    ParityOf,
    Reserved,
    ZerosAbove,
)
from .operations import Check as PlannedCheck
from .values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
    meaning_of,
)


class Name(str):
    """Name of a field, of a run of digits, or of a number formed by several fields. Outputs may need to change it."""

    __slots__ = ()


class BitSpan(NamedTuple):
    """``width`` bits, starting at bit ``low``."""

    low: Expression
    width: Expression


@dataclass(frozen=True, slots=True)
class BitField:
    """The bits of a field, with or without a value."""

    name: str
    low: Expression
    width: Expression


@dataclass(frozen=True, slots=True)
class Column:
    """A field, and the operation that converts its bits. ``runs`` lists name, divisor and modulus of runs of digits.

    ``scale`` converts its number to a quantity. Codecs do not compute it.
    """

    name: Name
    low: Expression
    width: Expression
    kind: str = "number"
    zero_means: int = 0
    runs: tuple[tuple[Name, int, int], ...] = ()
    power_of_two: bool = False
    scale: Scale | None = None


@dataclass(frozen=True, slots=True)
class Join:
    """Number formed by several fields, lowest first, each with the position of its lowest bit in the number."""

    name: Name
    fields: tuple[tuple[Name, Expression], ...]


@dataclass(frozen=True, slots=True)
class Unused:
    """Reserved bits. Bits that differ from ``value`` are 1 in one number, starting at bit ``place``."""

    low: Expression
    width: Expression
    value: int
    place: int


@dataclass(frozen=True, slots=True)
class Check:
    """Bits whose value must be one of ``values``, at most ``limit``, or the parity of the bits at ``parity_of``.

    If ``lowest`` is not 0, the bits are a signed number from ``lowest`` to ``limit``. If ``joined`` is not empty, the
    bits at these places form the number together, most significant first.
    ``mask`` is the mask of the bits at each place that count, or 0 if all of them count.
    """

    low: Expression
    width: Expression
    fault: Fault
    values: tuple[int, ...] = ()
    limit: Expression | None = None
    parity_of: tuple[BitSpan, ...] = ()
    odd: bool = False
    mask: int = 0
    lowest: Expression = Expression(0)
    joined: tuple[BitSpan, ...] = ()


@dataclass(frozen=True, slots=True)
class DescribedVerdictCause:
    """Cause of a verdict: the active flag ``flag``, unless one of the flags in ``unless`` is also active.

    If ``mask`` is not 0, the cause is any of these reserved bits instead. If ``when`` is not empty, the cause is that
    all of these fields have these values, and ``flag`` is only the name of the combination. The value of an active flag
    is 1. ``only`` selects the order codes to which the cause applies, or is None for all of them. ``chosen`` is the
    condition on an answer of the user to a question that the manual leaves open, or None.
    """

    verdict: Verdict
    flag: Name
    unless: tuple[Name, ...] = ()
    mask: int = 0
    only: verdicts.CodeCondition | None = None
    when: tuple[tuple[Name, int], ...] = ()
    chosen: verdicts.CodeCondition | None = None


@dataclass(frozen=True, slots=True)
class Answered:
    """Verdict of a report while ``parameter`` is not 0. The user's answer to an open question sets this parameter."""

    parameter: str
    verdict: Verdict


@dataclass(frozen=True, slots=True)
class DescribedReportCause:
    """Cause of a report: a flag, any of the reserved bits in ``mask``, or the values ``when`` of a verdict's cause.

    ``answered`` is the verdict of the report if an answer of the user changes it.
    """

    report: str
    flag: Name
    mask: int = 0
    only: verdicts.CodeCondition | None = None
    when: tuple[tuple[Name, int], ...] = ()
    answered: Answered | None = dataclass_field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Description:
    """A frame or register. ``length`` is 0 and ``order`` is empty if it is not sent as bytes.

    ``exchanged_bytes`` has the first byte of each field with a byte order of its own, and the byte after it.

    ``columns`` and ``fields`` contain all fields, in the order of the layout. ``fixed`` contains the constant bits that
    are not all 0. ``otherwise`` is the verdict if no cause applies, or None without a position. If
    ``judges_if_positive`` is not None, the verdict is at best UNKNOWN for order codes where it is 0.
    """

    bits: Expression
    length: int
    order: str
    exchanged_bytes: tuple[tuple[int, int], ...]
    columns: tuple[Column, ...]
    joins: tuple[Join, ...]
    unused: tuple[Unused, ...]
    checks: tuple[Check, ...]
    parities: tuple[Check, ...]
    verdict_causes: tuple[DescribedVerdictCause, ...]
    report_causes: tuple[DescribedReportCause, ...]
    fields: tuple[BitField, ...]
    crcs: tuple[FrameCrc, ...]
    gray: Gray | None
    digit_codings: tuple[DigitCoding, ...]
    fixed: tuple[tuple[BitSpan, int], ...]
    otherwise: Verdict | None
    judges_if_positive: Expression | None


def describe(layout_plan: LayoutPlan, reporting: verdicts.ReportsAndVerdict | None = None) -> Description:
    """Return the description of a frame or register, as data.

    ``reporting`` contains the reports and the verdict of a frame. Without it, the description has no causes of reports
    or verdicts. For a frame without the position, it has only causes of reports.
    """
    layout = layout_plan.layout
    power_of_two_names = powers_of_two(layout_plan)
    description = Description(
        bits=layout.bits,
        length=layout_plan.length if layout_plan.in_bytes else 0,
        order=_byte_order(layout_plan),
        exchanged_bytes=layout.exchanged_bytes,
        columns=tuple(_describe_column(field, field.name in power_of_two_names) for field in layout.fields),
        joins=tuple(map(_describe_join, layout_plan.joined_numbers)),
        unused=tuple(_describe_reserved_bits(reserved) for reserved in layout_plan.reserved),
        checks=tuple(_describe_check(check) for check in layout_plan.checks),
        parities=tuple(_computed_parities(layout_plan)),
        verdict_causes=(),
        report_causes=(),
        fields=tuple(BitField(field.name, field.low, field.width) for field in layout.fields),
        crcs=layout_plan.crcs,
        gray=layout_plan.gray,
        digit_codings=layout_plan.digit_codings,
        fixed=tuple(_constant_ones(layout_plan)),
        otherwise=None,
        judges_if_positive=None,
    )
    if reporting is None:
        return description
    description = replace(description, report_causes=tuple(map(_describe_report_cause, reporting.causes)))
    verdict_rules = reporting.verdict_rules
    if verdict_rules is None:
        return description
    return replace(
        description,
        verdict_causes=tuple(_describe_verdict_causes(verdict_rules)),
        otherwise=verdict_rules.default_verdict,
        judges_if_positive=verdict_rules.judges_if_positive if verdict_rules.may_be_unknown else None,
    )


def _describe_reserved_bits(reserved: Reserved) -> Unused:
    """Return reserved bits as data: their position, the value in the manual, and their place in ``unused``."""
    field = reserved.field
    return Unused(field.low, field.width, value=reserved.value, place=reserved.lowest_bit_in_unused)


def _byte_order(layout_plan: LayoutPlan) -> str:
    """Return Python's name of the byte order, or an empty string if the layout is not sent as bytes."""
    if not layout_plan.in_bytes:
        return ""
    return "little" if layout_plan.layout.byte_order == "low_byte_first" else "big"


def _computed_parities(layout_plan: LayoutPlan) -> Iterator[Check]:
    """Yield the parity bits that must be computed when a frame is encoded.

    A parity bit that is the same in every frame of this layout is omitted, because it is encoded as a constant.
    """
    for encoded_field in layout_plan.encoded_fields:
        if isinstance(encoded_field.value, ParityOf):
            yield _describe_parity(encoded_field.field, encoded_field.value)


def _constant_ones(layout_plan: LayoutPlan) -> Iterator[tuple[BitSpan, int]]:
    """Yield the bits of each constant whose value is not 0, with this value.

    Encoding starts from a frame of zeros, so constants of 0 need no operation.
    """
    for encoded_field in layout_plan.encoded_fields:
        if isinstance(encoded_field.value, ConstantNumber) and encoded_field.value.number != 0:
            bits = BitSpan(encoded_field.field.low, encoded_field.field.width)
            yield bits, encoded_field.value.number


def _describe_column(field: Field, must_be_power_of_two: bool) -> Column:
    """Return a field as data: its position, and the operation that converts its bits to a value.

    The member ``kind`` names the operation: ``signed``, ``flag``, ``not_flag`` for an active-low flag, ``choice``,
    ``digits``, ``text``, or ``number``. ``zero_means`` is the number that is sent as 0, or 0 if there is none.
    """
    column = Column(Name(field.name), field.low, field.width, power_of_two=must_be_power_of_two, scale=field.scale)
    match meaning_of(field):
        case UnsignedNumber():
            return column
        case TwosComplement():
            return replace(column, kind="signed")
        case ZeroMeans(number):
            return replace(column, zero_means=number)
        case ActiveFlag(low):
            return replace(column, kind="not_flag" if low else "flag")
        case NamedChoice():
            return replace(column, kind="choice")
        case DecimalDigits(digit_runs):
            runs = tuple((Name(digits.name), digits.divisor, digits.modulus) for digits in digit_runs)
            return replace(column, kind="digits", runs=runs)
        case Latin1Text():
            return replace(column, kind="text")
        case meaning:
            assert_never(meaning)


def _describe_check(check: PlannedCheck) -> Check:
    """Return a check as data: the bits that are checked, and the values, limits, or parity that they must have.

    ``fault`` is the error that a decoder reports if the check fails.
    """
    check_of_field = Check(check.field.low, check.field.width, check.fault)
    match check:
        case AlwaysIs(value=value):
            return replace(check_of_field, values=(value,))
        case ZerosAbove(padding=padding):
            return replace(check_of_field, low=padding.low, width=padding.width, values=(0,))
        case ParityIs(covered_fields=covered_fields, odd=odd, mask=mask):
            return replace(check_of_field, parity_of=_bit_spans_of(covered_fields), odd=odd, mask=mask)
        case IsOneOf(values=values):
            return replace(check_of_field, values=values)
        case AtMost(limit=limit):
            return replace(check_of_field, limit=Expression(limit))
        case NotAbove(highest=highest):
            return replace(check_of_field, limit=highest)
        case IsBetween(lowest=lowest, highest=highest):
            return replace(check_of_field, limit=highest, lowest=lowest)
        case JoinNotAbove(joined_number=number, highest=highest):
            spans = _bit_spans_of(number.fields)
            return replace(check_of_field, low=number.fields[-1].low, width=number.width, limit=highest, joined=spans)
        case _:
            assert_never(check)


def _describe_join(joined_number: JoinedNumber) -> Join:
    """Return a number formed by several fields as data: its fields are, for example, ``(("angle", 0), ("turns", 12))``.

    The second member of each pair is the position of the field's lowest bit in the number.
    """
    fields_from_low = tuple((Name(field.name), low) for field, low in joined_number.fields_from_low)
    return Join(name=Name(joined_number.join.name), fields=fields_from_low)


def _describe_parity(parity_bit: Field, parity: ParityOf) -> Check:
    """Return the check that a parity bit matches the fields that it covers."""
    return Check(
        low=parity_bit.low,
        width=parity_bit.width,
        fault=Fault.CONSTANT,
        parity_of=_bit_spans_of(parity.covered_fields),
        odd=parity.odd,
        mask=parity.mask,
    )


def _bit_spans_of(fields: tuple[Field, ...]) -> tuple[BitSpan, ...]:
    """Return the position and the width of the bits of each field."""
    return tuple(BitSpan(field.low, field.width) for field in fields)


def _describe_verdict_causes(verdict_rules: verdicts.VerdictRules) -> Iterator[DescribedVerdictCause]:
    """Yield the causes of the verdict as data, with the causes of the worst verdict first."""
    for verdict, verdict_causes in verdict_rules.worst_first:
        for verdict_cause in verdict_causes:
            cause = verdict_cause.cause
            yield DescribedVerdictCause(
                verdict=verdict,
                flag=Name(cause.field.name),
                unless=tuple(Name(flag.field.name) for flag in verdict_cause.overriding_flags),
                mask=_find_reserved_mask(cause),
                only=verdict_cause.code_condition,
                when=_list_conditions(cause),
                chosen=verdict_cause.answer_condition,
            )


def _describe_report_cause(report_cause: verdicts.ReportCause) -> DescribedReportCause:
    """Return the cause of a report as data: a flag, reserved bits, or the values of several fields."""
    cause = report_cause.cause
    return DescribedReportCause(
        report=report_cause.report.name,
        flag=Name(cause.field.name),
        mask=_find_reserved_mask(cause),
        only=report_cause.code_condition,
        when=_list_conditions(cause),
        answered=_verdict_by_answer(report_cause.described_field),
    )


def _verdict_by_answer(field: Field) -> Answered | None:
    """Return the verdict that an active flag leads to after a certain answer of the user to an open question.

    The answer sets a parameter to a value other than 0. Return None if the verdict of the flag depends on no answer.
    """
    match field.kind:
        case Flag(verdict_parameter=parameter, verdict_if_set=verdict) if verdict is not None:
            return Answered(parameter, verdict)
        case _:
            return None


def _find_reserved_mask(cause: verdicts.Cause) -> int:
    """Return the mask of reserved bits in ``unused``, the number formed by all of them, or 0 for any other cause."""
    return cause.mask if isinstance(cause, Reserved) else 0


def _list_conditions(cause: verdicts.Cause) -> tuple[tuple[Name, int], ...]:
    """Return the fields of a cause that consists of values, each with its value, or nothing for any other cause."""
    conditions = cause.conditions if isinstance(cause, verdicts.MatchingValues) else ()
    return tuple((Name(decoded_field.name), value) for decoded_field, value in conditions)
