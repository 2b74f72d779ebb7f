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
from .literals import Atom, Negative, ParameterExpressions, PythonExpression, PythonOperation, call, grouped, number
from .names import ClassNames, ModuleContext, meaning_limits


@dataclass(frozen=True)
class NamedValues(ParameterExpressions):
    """Expressions in a decoder, in which each value that depends on the order code gets a variable.

    ``values_by_name`` contains the Python code of each value by the name of its variable, such as ``{"position_mask":
    "(1 << variant.position_bits) - 1"}``. ``preferred`` contains the names to use, by the kind of the value (``size``,
    or ``ones`` for a mask) and its code. Values that depend on ``answered_parameters`` get no variable, since the user
    can give other answers to open questions in each call.
    """

    answered_parameters: frozenset[str] = frozenset()
    values_by_name: dict[str, str] = dataclass_field(default_factory=dict)
    preferred: dict[tuple[str, str], str] = dataclass_field(default_factory=dict)
    comments: dict[str, str] = dataclass_field(default_factory=dict)

    def expression_of(self, expression: Expression) -> PythonExpression:
        """Return an expression of the spec in Python: a number, or the variable with its value."""
        return self._use_name("size", expression, super().expression_of(expression))

    def ones(self, width: Expression) -> PythonExpression:
        """Return a mask of ``width`` 1 bits: a number, or the variable with the mask."""
        mask_of_parameters = ParameterExpressions(self.names).ones(width)
        return self._use_name("ones", width, mask_of_parameters)

    def _use_name(self, kind: str, value: Expression, expression: PythonExpression) -> PythonExpression:
        """Return the variable for a value that depends on the order code, and record its code ``expression``.

        Equal code has the same variable. A new variable gets its preferred name, or a name such as ``size_3``. A
        constant, and a value that depends on an answer of the user, is returned as ``expression``.
        """
        depends_on_answer = not self.answered_parameters.isdisjoint(value.parameters)
        if value.is_constant or depends_on_answer:
            return expression
        code = str(expression)
        names_by_code = {named_code: name for name, named_code in self.values_by_name.items()}
        name = names_by_code.get(code)
        if name is None:
            name = self.preferred.get((kind, code), f"{kind}_{len(self.values_by_name)}")
        self.values_by_name[name] = code
        return Atom(name)

    def prefer_for_size(self, name: str, size: Expression, comment: str = "") -> None:
        """Prefer ``name`` for the variable of a number, such as a place or a width. ``comment`` explains its code."""
        # A plain scope returns the expression itself rather than a variable.
        code = str(ParameterExpressions(self.names).expression_of(size))
        if self._prefer("size", size, code, name) and comment:
            self.comments[name] = comment

    def prefer_for_mask(self, name: str, width: Expression) -> None:
        """Prefer ``name`` for the variable of a mask of ``width`` 1 bits."""
        self._prefer("ones", width, str(ParameterExpressions(self.names).ones(width)), name)

    def _prefer(self, kind: str, value: Expression, code: str, name: str) -> bool:
        """Prefer a name for the variable of a value with this code, and return whether it is the preferred one.

        Another name that is already preferred for equal code stays. A constant needs no variable.
        """
        return not value.is_constant and self.preferred.setdefault((kind, code), name) == name


def prefer_names_of_fields(scope: NamedValues, layout_plan: LayoutPlan, class_names: ClassNames) -> None:
    """Prefer names of fields for places, widths, masks and limits that depend on the order code: ``position_bits``."""
    unused_name = _LocalNames(layout_plan, class_names).unused_name
    frame_bits = layout_plan.layout.bits
    scope.prefer_for_size("frame_bits", frame_bits, comment_on_constant(layout_plan, frame_bits))
    for field in layout_plan.layout.fields:
        low_comment = comment_on_constant(layout_plan, field.low)
        scope.prefer_for_size(unused_name(f"{field.name}_bits"), field.width)
        scope.prefer_for_size(unused_name(f"{field.name}_low"), field.low, low_comment)
        scope.prefer_for_mask(unused_name(f"{field.name}_mask"), field.width)
    for check in layout_plan.checks:
        if isinstance(check, (NotAbove, IsBetween)):
            scope.prefer_for_size(unused_name(f"highest_{check.field.name}"), check.highest)
        if isinstance(check, JoinNotAbove):
            scope.prefer_for_size(unused_name(f"highest_{check.joined_number.join.name}"), check.highest)
        if isinstance(check, IsBetween):
            scope.prefer_for_size(unused_name(f"lowest_{check.field.name}"), check.lowest)
    if layout_plan.gray is not None:
        scope.prefer_for_size(unused_name("gray_low"), layout_plan.gray.low)
        scope.prefer_for_size(unused_name("gray_bits"), layout_plan.gray.width)
        scope.prefer_for_size(unused_name("gray_excess"), layout_plan.gray.excess)


class _LocalNames:
    """The names of the variables in a decoder, initially those of its fields and their decimal digits."""

    def __init__(self, layout_plan: LayoutPlan, class_names: ClassNames) -> None:
        self._names = class_names
        self._used_names: set[str] = set()
        for field in layout_plan.layout.fields:
            self._used_names.add(class_names.local(field.name))
            self._used_names.update(class_names.local(run.name) for run in field.runs)

    def unused_name(self, wanted: str) -> str:
        """Return ``wanted``, with underscores at its end if another variable has this name, and reserve it."""
        name = self._names.local(wanted)
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
    low = 0
    while low < constant and low in fields_by_low and fields_by_low[low].widest:
        field = fields_by_low[low]
        fields_with_width.append(f"{field.name} ({field.widest})")
        low += field.widest
    if low != constant:
        return ""
    if len(fields_with_width) == 1:
        return fields_with_width[0]
    return f"{constant} = {' + '.join(reversed(fields_with_width))}"


@dataclass(frozen=True)
class LimitsFunction:
    """A function that returns the limits of a register.

    If the register has several uses (meanings), ``when`` is the one that the limits apply to. Otherwise it is empty.
    """

    name: str
    when: str
    low: PythonExpression
    high: PythonExpression
    takes_variant: bool


def limits_functions(context: ModuleContext, register: Register, *, takes_variant: bool) -> Iterator[LimitsFunction]:
    """Yield the function for the limits of a register, and one for each of its meanings with limits of its own.

    ``takes_variant`` is True if the first function takes the order code.
    """
    if register.min is not None or register.max is not None:
        low, high = limit_expressions(context.scope, limits_of(context.device, register))
        yield LimitsFunction("limits", when="", low=low, high=high, takes_variant=takes_variant)
    for meaning in register.meanings:
        if meaning.min is not None or meaning.max is not None:
            limits = limits_of(context.device, register, meaning)
            low, high = limit_expressions(context.scope, limits)
            yield LimitsFunction(
                name=meaning_limits(meaning),
                when=name_in_words(meaning.name),
                low=low,
                high=high,
                takes_variant=limits_depend(limits),
            )


def limit_expressions(scope: ParameterExpressions, limits: NumberLimits) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value. A limit that the spec does not give follows from the width."""
    low, high = _limits_of_width(scope, limits)
    if limits.low is not None:
        low = scope.expression_of(limits.low)
    if limits.high is not None:
        high = scope.expression_of(limits.high)
    return low, high


def _limits_of_width(scope: ParameterExpressions, limits: NumberLimits) -> tuple[PythonExpression, PythonExpression]:
    """Return the lowest and the highest value that fit in the field.

    If the bits 0 stand for a number above all others, such as 256, the values are 1 to this number.
    """
    if limits.signed:
        half_of_range = scope.power(limits.width - Expression(1))
        return Negative(half_of_range), PythonOperation(half_of_range, "-", number(1))
    if limits.number_for_zero:
        return number(1), number(limits.number_for_zero)
    return number(0), PythonOperation(scope.power(limits.width), "-", number(1))


def limits_depend(limits: NumberLimits) -> bool:
    """Return whether limits depend on the order code."""
    bounds = [bound for bound in (limits.low, limits.high) if bound is not None]
    # A limit that the spec does not give follows from the width.
    if len(bounds) < 2:
        bounds.append(limits.width)
    return not all(bound.is_constant for bound in bounds)


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
