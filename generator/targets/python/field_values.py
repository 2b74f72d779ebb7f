"""Expressions for the values of a field, from an expression for its bits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Digits, Field
from ...model.record import assert_never
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
    meaning_of,
)
from .literals import Atom, ParameterExpressions, PythonExpression, PythonOperation, call, grouped, number
from .names import ClassNames


def attribute_values(
    scope: ParameterExpressions, class_names: ClassNames, enum: str, field: Field, bits: PythonExpression
) -> Iterator[tuple[str, PythonExpression]]:
    """Yield the attributes of a field of a joined number, with their values. ``enum`` is the name of its IntEnum."""
    attribute = class_names.attribute(field.name)
    match meaning_of(field):
        case UnsignedNumber():
            yield attribute, bits
        case TwosComplement():
            yield attribute, call("signed", bits, scope.expression_of(field.width))
        case ZeroMeans(number_for_zero):
            yield attribute, replace_zero(bits, number_for_zero)
        case ActiveFlag(low):
            yield attribute, is_flag_active(bits, low_is_active=low)
        case NamedChoice():
            yield attribute, call("as_member", enum, f'"{field.name}"', bits)
        case DecimalDigits(runs):
            for run, run_value in digit_values(bits, runs):
                yield class_names.attribute(run.name), run_value
        case Latin1Text():
            yield attribute, text_of_number(field, bits)
        case meaning:
            assert_never(meaning)


def digit_values(
    decimal_number: PythonExpression, digit_runs: Sequence[Digits]
) -> Iterator[tuple[Digits, PythonExpression]]:
    """Yield groups of decimal digits in a number (digit runs), each with its value, such as ``number // 100 % 10``."""
    for digit_run in digit_runs:
        value = decimal_number
        if digit_run.divisor != 1:
            value = PythonOperation(value, "//", number(digit_run.divisor))
        # No digits are before the first run.
        if digit_run is not digit_runs[0]:
            value = PythonOperation(value, "%", number(digit_run.modulus))
        yield digit_run, value


def replace_zero(bits: PythonExpression, number_for_zero: int) -> PythonExpression:
    """Return the bits, or the number that the bits 0 stand for, such as ``data[0] or 256``."""
    return Atom(f"{bits.operand} or {grouped(number_for_zero)}")


def is_flag_active(bit: PythonExpression, *, low_is_active: bool) -> PythonExpression:
    """Return the condition that a flag with this bit is active."""
    return Atom(f"not {bit.operand}" if low_is_active else f"{bit.operand} != 0")


def text_of_number(field: Field, bits: PythonExpression) -> PythonExpression:
    """Return the text whose characters are the bytes of a number, such as ``number.to_bytes(4, "big").decode(…)``."""
    number_of_characters = field.width.constant // 8
    return Atom(f'{bits.operand}.to_bytes({number_of_characters}, "big").decode("latin-1")')
