"""Values in generated Python: of fields, limits of registers, and numbers that depend on the order code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field as dataclass_field

from ...model import Digits, Field, Register
from ...model.expressions import Expression
from ...model.record import assert_never, dataclass
from ...plan.codec import LayoutPlan
from ...plan.limits import NumberLimits, limits_of
from ...plan.operations import IsBetween, JoinNotAbove, NotAbove
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
from ...say.names_and_evidence import name_in_words
from .literals import Atom, ExpressionTranslator, Negative, PythonExpression, PythonOperation, call, grouped, number
from .names import ClassNames, DeviceNames, meaning_limits


@dataclass(frozen=True)
class NamedValues(ExpressionTranslator):
    """Expressions in a decoder, in which each value that depends on the order code gets a variable.

    ``values_by_name`` contains the Python code of each value by the name of its variable, such as ``{"position_mask":
    "(1 << variant.position_bits) - 1"}``. ``preferred_variables`` contains the names to use, by the kind of the value
    (``size``, or ``ones`` for a mask) and its code. Values that depend on ``answered_parameters`` get no variable,
    since the user can give other answers to open questions in each call.
    """

    answered_parameters: frozenset[str] = frozenset()
    values_by_name: dict[str, str] = dataclass_field(default_factory=dict)
    preferred_variables: dict[tuple[str, str], str] = dataclass_field(default_factory=dict)
    comments: dict[str, str] = dataclass_field(default_factory=dict)

    def to_python(self, expression: Expression) -> PythonExpression:
        """Return an expression of the spec in Python: a number, or the variable with its value."""
        return self._use_name("size", expression, super().to_python(expression))

    def mask_of_ones(self, width: Expression) -> PythonExpression:
        """Return a mask of ``width`` 1 bits: a number, or the variable with the mask."""
        mask_of_parameters = ExpressionTranslator(self.code_by_parameter).mask_of_ones(width)
        return self._use_name("ones", width, mask_of_parameters)

    def _use_name(self, kind_of_value: str, value: Expression, value_code: PythonExpression) -> PythonExpression:
        """Return the variable for a value that depends on the order code, and record that it holds ``value_code``.

        Equal code has the same variable. A new variable gets its preferred name, or a name such as ``size_3``. A
        constant, and a value that depends on an answer of the user, is returned as ``value_code``.
        """
        depends_on_answer = not self.answered_parameters.isdisjoint(value.parameters)
        if value.is_constant or depends_on_answer:
            return value_code
        code_text = str(value_code)
        variable_by_code = {named_code: variable_name for variable_name, named_code in self.values_by_name.items()}
        variable_name = variable_by_code.get(code_text)
        if variable_name is None:
            variable_name = self.preferred_variables.get(
                (kind_of_value, code_text), f"{kind_of_value}_{len(self.values_by_name)}"
            )
        self.values_by_name[variable_name] = code_text
        return Atom(variable_name)

    def prefer_for_size(self, variable_name: str, size: Expression, comment: str = "") -> None:
        """Prefer this name for the variable of a number, such as a place or a width. ``comment`` explains its code."""
        # A plain translator returns the expression itself rather than a variable.
        value_code = str(ExpressionTranslator(self.code_by_parameter).to_python(size))
        if self._prefer("size", size, value_code, variable_name) and comment:
            self.comments[variable_name] = comment

    def prefer_for_mask(self, variable_name: str, width: Expression) -> None:
        """Prefer ``variable_name`` for the variable of a mask of ``width`` 1 bits."""
        self._prefer(
            "ones", width, str(ExpressionTranslator(self.code_by_parameter).mask_of_ones(width)), variable_name
        )

    def _prefer(self, kind_of_value: str, value: Expression, value_code: str, variable_name: str) -> bool:
        """Prefer a name for the variable of a value with this code, and return whether it is the preferred one.

        Another name that is already preferred for equal code stays. A constant needs no variable.
        """
        return (
            not value.is_constant
            and self.preferred_variables.setdefault((kind_of_value, value_code), variable_name) == variable_name
        )


def prefer_names_of_fields(translator: NamedValues, layout_plan: LayoutPlan, class_names: ClassNames) -> None:
    """Prefer names of fields for places, widths, masks and limits that depend on the order code: ``position_bits``."""
    unused_name = _LocalNames(layout_plan, class_names).unused_name
    frame_bits = layout_plan.layout.bits
    translator.prefer_for_size("frame_bits", frame_bits, comment_on_constant(layout_plan, frame_bits))
    for field in layout_plan.layout.fields:
        low_comment = comment_on_constant(layout_plan, field.low)
        translator.prefer_for_size(unused_name(f"{field.name}_bits"), field.width)
        translator.prefer_for_size(unused_name(f"{field.name}_low"), field.low, low_comment)
        translator.prefer_for_mask(unused_name(f"{field.name}_mask"), field.width)
    for check in layout_plan.checks:
        if isinstance(check, (NotAbove, IsBetween)):
            translator.prefer_for_size(unused_name(f"highest_{check.field.name}"), check.highest)
        if isinstance(check, JoinNotAbove):
            translator.prefer_for_size(unused_name(f"highest_{check.joined_number.join.name}"), check.highest)
        if isinstance(check, IsBetween):
            translator.prefer_for_size(unused_name(f"lowest_{check.field.name}"), check.lowest)
    if layout_plan.gray is not None:
        translator.prefer_for_size(unused_name("gray_low"), layout_plan.gray.low)
        translator.prefer_for_size(unused_name("gray_bits"), layout_plan.gray.width)
        translator.prefer_for_size(unused_name("gray_excess"), layout_plan.gray.excess)


class _LocalNames:
    """The names of the variables in a decoder, initially those of its fields and their decimal digits."""

    def __init__(self, layout_plan: LayoutPlan, class_names: ClassNames) -> None:
        self._names = class_names
        self._used_names: set[str] = set()
        for field in layout_plan.layout.fields:
            self._used_names.add(class_names.variable_name(field.name))
            self._used_names.update(class_names.variable_name(run.name) for run in field.runs)

    def unused_name(self, wanted_name: str) -> str:
        """Return ``wanted_name``, with underscores at its end if another variable has this name, and reserve it."""
        name = self._names.variable_name(wanted_name)
        while name in self._used_names:
            name += "_"
        self._used_names.add(name)
        return name


def comment_on_constant(layout_plan: LayoutPlan, expression: Expression) -> str:
    """Return a comment that explains the constant in a sum of widths: ``8 = crc (6) + warning (1) + error (1)``.

    It lists the fields of fixed width at the low end of the word. For one field, it is only ``crc (6)``. It is empty
    if the widths do not add up to the constant.
    """
    constant = expression.constant
    if constant <= 0:
        return ""
    fields_by_low = {field.low.constant: field for field in layout_plan.layout.fields if field.is_fixed}
    fields_with_width: list[str] = []
    # From bit 0 up, each field begins where the one below it ends.
    lowest_bit = 0
    while lowest_bit < constant and lowest_bit in fields_by_low and fields_by_low[lowest_bit].widest:
        field = fields_by_low[lowest_bit]
        fields_with_width.append(f"{field.name} ({field.widest})")
        lowest_bit += field.widest
    if lowest_bit != constant:
        return ""
    if len(fields_with_width) == 1:
        return fields_with_width[0]
    return f"{constant} = {' + '.join(reversed(fields_with_width))}"


@dataclass(frozen=True)
class LimitsFunction:
    """A function that returns the limits of a register.

    If the register has several uses (meanings), ``meaning_in_words`` is the one that the limits apply to. Otherwise it
    is empty.
    """

    name: str
    meaning_in_words: str
    lowest: PythonExpression
    highest: PythonExpression
    takes_variant: bool


def limits_functions(device_names: DeviceNames, register: Register, *, takes_variant: bool) -> Iterator[LimitsFunction]:
    """Yield the function for the limits of a register, and one for each of its meanings with limits of its own.

    ``takes_variant`` is True if the first function takes the order code.
    """
    if register.min is not None or register.max is not None:
        lowest, highest = limit_expressions(device_names.translator, limits_of(device_names.device, register))
        yield LimitsFunction("limits", meaning_in_words="", lowest=lowest, highest=highest, takes_variant=takes_variant)
    for meaning in register.meanings:
        if meaning.min is not None or meaning.max is not None:
            limits = limits_of(device_names.device, register, meaning)
            lowest, highest = limit_expressions(device_names.translator, limits)
            yield LimitsFunction(
                name=meaning_limits(meaning),
                meaning_in_words=name_in_words(meaning.name),
                lowest=lowest,
                highest=highest,
                takes_variant=limits_depend(limits),
            )


def limit_expressions(
    translator: ExpressionTranslator, limits: NumberLimits
) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value. A limit that the spec does not give follows from the width."""
    lowest, highest = _limits_of_width(translator, limits)
    if limits.lowest is not None:
        lowest = translator.to_python(limits.lowest)
    if limits.highest is not None:
        highest = translator.to_python(limits.highest)
    return lowest, highest


def _limits_of_width(
    translator: ExpressionTranslator, limits: NumberLimits
) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value that fit in the field.

    If the bits 0 stand for a number above all others, such as 256, the values are 1 to this number.
    """
    if limits.signed:
        half_of_range = translator.power_of_two(limits.width - Expression(1))
        return Negative(half_of_range), PythonOperation(half_of_range, "-", number(1))
    if limits.number_for_zero:
        return number(1), number(limits.number_for_zero)
    return number(0), PythonOperation(translator.power_of_two(limits.width), "-", number(1))


def limits_depend(limits: NumberLimits) -> bool:
    """Return whether limits depend on the order code."""
    deciding_limits = [limit for limit in (limits.lowest, limits.highest) if limit is not None]
    # A limit that the spec does not give follows from the width.
    if len(deciding_limits) < 2:
        deciding_limits.append(limits.width)
    return not all(limit.is_constant for limit in deciding_limits)


def attribute_values(
    translator: ExpressionTranslator, class_names: ClassNames, enum_name: str, field: Field, bits: PythonExpression
) -> Iterator[tuple[str, PythonExpression]]:
    """Yield the attributes of a field of a joined number, with their values. ``enum_name`` is its IntEnum."""
    attribute_name = class_names.attribute_name(field.name)
    match meaning_of(field):
        case UnsignedNumber():
            yield attribute_name, bits
        case TwosComplement():
            yield attribute_name, call("signed", bits, translator.to_python(field.width))
        case ZeroMeans(number_for_zero):
            yield attribute_name, replace_zero(bits, number_for_zero)
        case ActiveFlag(is_active_low):
            yield attribute_name, is_flag_active(bits, low_is_active=is_active_low)
        case NamedChoice():
            yield attribute_name, call("as_member", enum_name, f'"{field.name}"', bits)
        case DecimalDigits(runs):
            for run, run_value in digit_values(bits, runs):
                yield class_names.attribute_name(run.name), run_value
        case Latin1Text():
            yield attribute_name, text_of_number(field, bits)
        case meaning:
            assert_never(meaning)


def digit_values(
    decimal_number: PythonExpression, digit_runs: Sequence[Digits]
) -> Iterator[tuple[Digits, PythonExpression]]:
    """Yield groups of decimal digits in a number (digit runs), each with its value, such as ``number // 100 % 10``."""
    for digit_run in digit_runs:
        digits_code = decimal_number
        if digit_run.divisor != 1:
            digits_code = PythonOperation(digits_code, "//", number(digit_run.divisor))
        # No digits are before the first run.
        if digit_run is not digit_runs[0]:
            digits_code = PythonOperation(digits_code, "%", number(digit_run.modulus))
        yield digit_run, digits_code


def replace_zero(bits: PythonExpression, number_for_zero: int) -> PythonExpression:
    """Return the bits, or the number that the bits 0 stand for, such as ``data[0] or 256``."""
    return Atom(f"{bits.operand} or {grouped(number_for_zero)}")


def is_flag_active(bit: PythonExpression, *, low_is_active: bool) -> PythonExpression:
    """Return the condition that a flag with this bit is active."""
    return Atom(f"not {bit.operand}" if low_is_active else f"{bit.operand} != 0")


def text_of_number(field: Field, bits: PythonExpression) -> PythonExpression:
    """Return the text whose characters are the bytes of a number, such as ``number.to_bytes(4, "big").decode(…)``."""
    character_count = field.width.constant // 8
    return Atom(f'{bits.operand}.to_bytes({character_count}, "big").decode("latin-1")')
