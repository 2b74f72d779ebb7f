"""Python expressions as trees, and data as literals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, reduce

from ...model import PlacedLayout, number_to_bytes
from ...model.expressions import Expression, Factor, Term
from ...model.record import assert_never, dataclass
from ...plan.values import ActiveFlag, Meaning, TwosComplement, ZeroMeans
from .line_breaks import break_lines

#: Operators by precedence, lowest first.
_LOOSEST_FIRST = (("or",), ("and",), ("not",), ("|",), ("^",), ("&",), ("<<", ">>"), ("+", "-"), ("*", "//", "%"))
_PRECEDENCE_LEVELS = {operator: level for level, operators in enumerate(_LOOSEST_FIRST) for operator in operators}
_ATOM_LEVEL = len(_LOOSEST_FIRST)
#: Levels of the operators ``|`` to ``>>``. Readers do not know the order of these by heart.
_BIT_LEVELS = range(_PRECEDENCE_LEVELS["|"], _PRECEDENCE_LEVELS["+"])


class PythonExpression:
    """A Python expression. Its text is its ``str``."""

    __slots__ = ()

    @property
    def level(self) -> int:
        """The precedence of its operator. A higher number binds more tightly."""
        return _ATOM_LEVEL

    @property
    def operand(self) -> str:
        """The text to use next to any operator, in parentheses unless it is a name, a number or a call."""
        return str(self) if self.level == _ATOM_LEVEL else f"({self})"

    def as_operand_of(self, operator: str, is_right_operand: bool = False) -> str:
        """Return the text as an operand of ``operator``, in parentheses if they are needed or make it easier to read.

        An operand of a bit operator always gets parentheses, unless it has the same operator: ``(a >> 3) & 0xF``, and
        ``a | b | c``. ``is_right_operand`` is True for the right operand, which needs them if it has an operator of the
        same precedence.
        """
        operator_level = _PRECEDENCE_LEVELS[operator]
        binds_looser = self.level <= operator_level if is_right_operand else self.level < operator_level
        is_in_bit_operation = operator_level in _BIT_LEVELS and self.level != operator_level
        return self.operand if binds_looser or is_in_bit_operation else str(self)


@dataclass(frozen=True, slots=True)
class Atom(PythonExpression):
    """A name, number, call, subscript or attribute, which never needs parentheses."""

    text: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Negative(PythonExpression):
    """A value with a minus sign."""

    value: PythonExpression

    @property
    def level(self) -> int:
        return _PRECEDENCE_LEVELS["*"]

    def __str__(self) -> str:
        return f"-{self.value.as_operand_of('*')}"


@dataclass(frozen=True, slots=True)
class Not(PythonExpression):
    """The negation of a condition."""

    value: PythonExpression

    @property
    def level(self) -> int:
        return _PRECEDENCE_LEVELS["not"]

    def __str__(self) -> str:
        return f"not {self.value.as_operand_of('not')}"


@dataclass(frozen=True, slots=True)
class PythonOperation(PythonExpression):
    """An operation with two operands."""

    left: PythonExpression
    operator: str
    right: PythonExpression

    @property
    def level(self) -> int:
        return _PRECEDENCE_LEVELS[self.operator]

    def __str__(self) -> str:
        left = self.left.as_operand_of(self.operator)
        # Among equal operators, the left one comes first: ``a - b - c`` but ``a - (b - c)``.
        right = self.right.as_operand_of(self.operator, is_right_operand=True)
        return f"{left} {self.operator} {right}"


def call(function: str, *arguments: PythonExpression | str) -> PythonExpression:
    """Return a call of a function."""
    return Atom(f"{function}({', '.join(map(str, arguments))})")


def number(value: int) -> PythonExpression:
    """Return a decimal number."""
    return Atom(grouped(value))


def mask(value: int) -> PythonExpression:
    """Return a hexadecimal number."""
    return Atom(f"0x{value:X}")


def grouped(value: int) -> str:
    """Return the text of a decimal number. Five or more digits are grouped by three, as in ``10_000``."""
    return f"{value:_}" if abs(value) >= 10_000 else str(value)


def coded(value: int) -> str:
    """Return the value of a code, in decimal below ten and otherwise in hexadecimal."""
    return str(value) if value < 10 else f"0x{value:X}"


def join_operands(operator: str, operands: Iterable[PythonExpression]) -> PythonExpression:
    """Return one or more operands, joined by an operator."""
    return reduce(lambda left, right: PythonOperation(left, operator, right), operands)


def multiply(value: PythonExpression, factor: int) -> PythonExpression:
    """Return ``value`` times a factor, or unchanged for the factor 1."""
    return value if factor == 1 else PythonOperation(value, "*", number(factor))


def shift_left(value: PythonExpression, distance: PythonExpression) -> PythonExpression:
    """Return ``value << distance``, or the value unchanged for the distance 0."""
    return value if distance == Atom("0") else PythonOperation(value, "<<", distance)


def shift_right(value: PythonExpression, distance: PythonExpression) -> PythonExpression:
    """Return ``value >> distance``, or the value unchanged for the distance 0."""
    return value if distance == Atom("0") else PythonOperation(value, ">>", distance)


def _sign_of(value: int) -> int:
    return 1 if value > 0 else -1


@dataclass(frozen=True, slots=True)
class ExpressionTranslator:
    """Translates expressions of the spec to Python.

    ``code_by_parameter`` contains the code that reads each parameter, such as ``variant.bits``.
    """

    code_by_parameter: Mapping[str, str]

    def to_python(self, expression: Expression) -> PythonExpression:
        """Return an expression of the spec in Python, such as ``variant.position_bits + 8``."""
        if expression.is_constant:
            return number(expression.constant)
        # The summands are the products of the terms, and the constant. Each is positive, and comes with its sign.
        signs_and_summands = [(_sign_of(term.multiple), self._product_of_factors(term)) for term in expression.terms]
        if expression.constant:
            sign_and_constant = (_sign_of(expression.constant), Atom(str(abs(expression.constant))))
            # A sum should not start with a sign.
            first_term_sign, _ = signs_and_summands[0]
            is_first = expression.constant > 0 and first_term_sign < 0
            index_of_constant = 0 if is_first else len(signs_and_summands)
            signs_and_summands.insert(index_of_constant, sign_and_constant)
        (first_sign, first_summand), *further_summands = signs_and_summands
        sum_expression: PythonExpression = first_summand if first_sign > 0 else Negative(first_summand)
        for sign, summand in further_summands:
            sum_expression = PythonOperation(sum_expression, "+" if sign > 0 else "-", summand)
        return sum_expression

    def mask_of_ones(self, width: Expression) -> PythonExpression:
        """Return a mask of ``width`` 1 bits."""
        if width.is_constant:
            return mask((1 << width.constant) - 1)
        return PythonOperation(self.power_of_two(width), "-", number(1))

    def power_of_two(self, width: Expression) -> PythonExpression:
        """Return 2 to the power of ``width``."""
        return PythonOperation(number(1), "<<", self.to_python(width))

    def _product_of_factors(self, term: Term) -> PythonExpression:
        """Return the product of a term without its sign, such as ``2 * variant.turns``."""
        factors: list[PythonExpression] = []
        if abs(term.multiple) != 1:
            factors.append(number(abs(term.multiple)))
        factors += map(self._factor_expression, term.factors)
        return join_operands("*", factors)

    def _factor_expression(self, factor: Factor) -> PythonExpression:
        """Return a factor: a parameter, or 2 to the power of a parameter."""
        parameter = Atom(self.code_by_parameter[factor.parameter])
        return PythonOperation(number(1), "<<", parameter) if factor.power else parameter


def quoted(text: str | bytes) -> str:
    """Return a text or bytes as a literal on one line in double quotes. Bytes are in hexadecimal."""
    if isinstance(text, bytes):
        return 'b"' + "".join(f"\\x{byte:02x}" for byte in text) + '"'
    if text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    escaped = repr(text)
    # repr() chose double quotes, because the text has single ones.
    if escaped.startswith('"'):
        return escaped
    # In single quotes, repr() escapes single quotes and leaves double ones as they are.
    in_double_quotes = escaped[1:-1].replace("\\'", "'").replace('"', '\\"')
    return f'"{in_double_quotes}"'


@dataclass(frozen=True)
class SourceText:
    """Source code that is printed unchanged."""

    text: str


@dataclass(frozen=True)
class EnumMember:
    """A member of the enumeration ``enum_name``, given by its value in the spec."""

    enum_name: str
    value: str


@dataclass(frozen=True)
class Hex:
    """Hexadecimal number with at least two digits."""

    number: int


@dataclass(frozen=True)
class CallLiteral:
    """A call of a function or class. An argument without a name is positional."""

    function: str
    arguments: tuple[tuple[str, Literal], ...]

    @cached_property
    def flat(self) -> str:
        """The call on one line."""
        arguments = []
        for name, value in self.arguments:
            prefix = f"{name}=" if name else ""
            arguments.append(f"{prefix}{literal(value)}")
        return f"{self.function}({', '.join(arguments)})"


@dataclass(frozen=True)
class ConditionalItem:
    """An item of a tuple that is present only if the expression ``condition`` is true when the module runs."""

    call: CallLiteral
    condition: str


Literal = (
    None
    | bool
    | int
    | float
    | str
    | bytes
    | SourceText
    | EnumMember
    | Hex
    | CallLiteral
    | ConditionalItem
    | Sequence["Literal"]
    | Mapping[str, str]
)


def literal_call(function: str, *positional: Literal, **optional: Literal) -> CallLiteral:
    """Return a call with positional arguments, and with the optional arguments that are not empty."""
    return CallLiteral(function, (*(("", value) for value in positional), *_named_arguments(optional)))


def record_call(function: str, required: Mapping[str, Literal], **optional: Literal) -> CallLiteral:
    """Return a call with named arguments: all of ``required``, and the optional ones that are not empty."""
    return CallLiteral(function, (*required.items(), *_named_arguments(optional)))


def _named_arguments(optional: Mapping[str, Literal]) -> tuple[tuple[str, Literal], ...]:
    """Return the arguments that are not empty, with their names."""
    return tuple((name, value) for name, value in optional.items() if not is_empty(value))


def is_empty(value: Literal) -> bool:
    """Return whether a value is None or without content. False and 0 are not empty."""
    return value in (None, "", ()) or (isinstance(value, Mapping) and not value)


def constant(name: str, value: CallLiteral) -> str:
    """Return the statement that assigns a value to ``name``."""
    return break_lines(f"{name}: Final = {value.flat}")


def table_statement(name: str, record_class: str, rows: Sequence[CallLiteral]) -> str:
    """Return the statement that assigns a tuple of records to ``name``, one per line."""
    statement_start = f"{name}: Final[tuple[{record_class}, ...]] = "
    if not rows:
        return f"{statement_start}()"
    row_lines = [break_lines(f"    {row.flat},") for row in rows]
    return "\n".join([f"{statement_start}(", *row_lines, ")"])


def literal(value: Literal) -> str:
    """Return ``value`` as source code on one line."""
    match value:
        case str() | bytes():
            return quoted(value)
        case None | bool():
            return str(value)
        case int():
            return grouped(value)
        case float():
            return f"{value:g}"
        case Mapping():
            item_texts = [f"{quoted(key)}: {quoted(text)}" for key, text in value.items()]
            return f"ReadOnly({{{', '.join(item_texts)}}})"
        case SourceText() | Hex() | EnumMember() | CallLiteral() | ConditionalItem():
            return _source_code(value)
    element_texts = ", ".join(map(literal, value))
    # A tuple of one element needs a comma.
    return f"({element_texts},)" if len(value) == 1 else f"({element_texts})"


def _source_code(value: SourceText | Hex | EnumMember | CallLiteral | ConditionalItem) -> str:
    """Return source code, such as ``0x0F``, ``Access.READ``, ``Led("P1")`` or ``*([Led("P1")] if has_led else [])``."""
    match value:
        case SourceText():
            return value.text
        case Hex():
            return f"0x{value.number:02X}"
        case EnumMember():
            return f"{value.enum_name}.{value.value.upper()}"
        case CallLiteral():
            return value.flat
        case ConditionalItem():
            return f"*([{value.call.flat}] if {value.condition} else [])"
        case _:
            assert_never(value)


def zero_means_member(meaning: Meaning) -> dict[str, Literal]:
    """Return the member ``zero_means`` of a record: the number that the bits 0 stand for.

    The result is empty for a field in which 0 is 0.
    """
    return {"zero_means": meaning.number} if isinstance(meaning, ZeroMeans) else {}


def meaning_members(meaning: Meaning) -> dict[str, Literal]:
    """Return the members of the record ``FieldFacts`` that say what the bits of a field mean.

    Members that do not apply to the field are None.
    """
    not_applicable: dict[str, Literal] = {"active": None, "signed": None, "zero_means": None}
    match meaning:
        case TwosComplement():
            return not_applicable | {"signed": True}
        case ActiveFlag(low):
            return not_applicable | {"active": "low" if low else "high"}
        case _:
            return not_applicable | zero_means_member(meaning)


def value_in_words(value: Expression | int | str | None) -> str:
    """Return a value that the manual states in words, such as ``bits + 8``, ``'AB'`` or ``0x1B``."""
    if isinstance(value, Expression):
        return value.render()
    return repr(value) if isinstance(value, str) else coded(value or 0)


def frame_literal(placed_layout: PlacedLayout, number: int) -> str:
    """Return a frame as a Python literal, such as ``0x1a2b`` or ``bytes.fromhex("1A 2B")``."""
    if placed_layout.layout.in_bytes:
        return bytes_literal(number_to_bytes(placed_layout.layout, number, placed_layout.bits))
    return f"{number:#x}"


def bytes_literal(data: bytes) -> str:
    """Return bytes as a Python literal, such as ``bytes.fromhex("1A 2B")``."""
    return f'bytes.fromhex("{data.hex(" ").upper()}")'
