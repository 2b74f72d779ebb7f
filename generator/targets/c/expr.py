"""C expressions as trees, and the types and constants of C."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod

from ...model.expressions import Expression, Factor, Term
from ...model.record import dataclass
from .. import TargetError
from .names import c_name

_PLAIN = frozenset(letter for letter in map(chr, range(0x20, 0x7F)) if letter not in '"\\?')


def string(text: object) -> str:
    """Return ``text`` as a string literal."""
    return '"' + "".join(map(_character, str(text).encode("utf-8"))) + '"'


def _character(byte: int) -> str:
    """Return a byte as a character of a string literal."""
    return chr(byte) if chr(byte) in _PLAIN else f"\\{byte:03o}"


def number(value: int, hexadecimal: bool = False, digits: int = 2) -> str:
    """Return ``value`` as an unsigned constant."""
    text = f"0x{value:0{digits}X}" if hexadecimal else str(value)
    return f"UINT64_C({text})" if value > 0xFFFFFFFF or (hexadecimal and digits > 8) else f"{text}U"


def signed_number(value: int) -> str:
    text = f"INT64_C({abs(value)})" if abs(value) > 0x7FFF else str(abs(value))
    return f"(-{text})" if value < 0 else text


def mask(width: int) -> str:
    """Return a constant whose lowest ``width`` bits are 1."""
    return number((1 << width) - 1, hexadecimal=True)


def size_of(bits: int) -> int:
    """Return the width of the smallest unsigned type for ``bits`` bits."""
    for size in (8, 16, 32, 64):
        if bits <= size:
            return size
    raise TargetError(f"a number of {bits} bits; the C target holds numbers of at most 64 bits")


def signed(bits: int) -> str:
    return f"int{size_of(bits)}_t"


def unsigned(bits: int) -> str:
    """Return the smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"


class Expr:
    """C expression, whose text is its ``str``."""

    __slots__ = ()

    @property
    def operand(self) -> str:
        """The text to use inside an operation, or after a cast."""
        return str(self)


@dataclass(frozen=True, slots=True)
class Name(Expr):
    """A name: a local, ``in->flag``, ``bytes[3]``."""

    text: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Number(Expr):
    """An unsigned constant, or with ``signed`` one with a sign."""

    value: int
    hexadecimal: bool = False
    signed: bool = False

    def __str__(self) -> str:
        return signed_number(self.value) if self.signed else number(self.value, self.hexadecimal)


@dataclass(frozen=True, slots=True)
class Call(Expr):
    function: str
    arguments: tuple[Expr, ...]

    def __str__(self) -> str:
        return f"{self.function}({', '.join(map(str, self.arguments))})"


@dataclass(frozen=True, slots=True)
class Cast(Expr):
    type: str
    value: Expr

    def __str__(self) -> str:
        return f"({self.type}){self.value.operand}"


_SUMS = frozenset("+-")


@dataclass(frozen=True, slots=True)
class Operation(Expr):
    """Two or more operands with one operator."""

    operator: str
    operands: tuple[Expr, ...]

    def __str__(self) -> str:
        first, *following = self.operands
        # A sum continues without parentheses, from the left.
        goes_on = isinstance(first, Operation) and {first.operator, self.operator} <= _SUMS
        start = str(first) if goes_on else first.operand
        return f" {self.operator} ".join([start, *(operand.operand for operand in following)])

    @property
    def operand(self) -> str:
        return f"({self})"


@dataclass(frozen=True, slots=True)
class Conditional(Expr):
    """One of two values: the first if the condition holds."""

    condition: Expr
    then: Expr
    otherwise: Expr

    def __str__(self) -> str:
        return f"{self.condition.operand} ? {self.then.operand} : {self.otherwise.operand}"

    @property
    def operand(self) -> str:
        return f"({self})"


def shifted_right(value: Expr, by: int) -> Expr:
    """Return ``value`` shifted to the right, unless by 0."""
    return Operation(">>", (value, Number(by))) if by else value


def shifted_left(value: Expr, by: int | Expr) -> Expr:
    """Return ``value`` shifted to the left, unless by 0."""
    if not by:
        return value
    distance = Number(by) if isinstance(by, int) else by
    return Operation("<<", (value, distance))


def masked(value: Expr, mask: int) -> Expr:
    return Operation("&", (value, Number(mask, hexadecimal=True)))


def joined(operator: str, operands: tuple[Expr, ...]) -> Expr:
    """Return the operands joined by an operator, or the only one."""
    return operands[0] if len(operands) == 1 else Operation(operator, operands)


@dataclass(frozen=True)
class Scope:
    """The spelling of parameters: set ones are members of the variant, others are functions of it.

    ``largest`` contains the highest values of the parameters that an order code sets. A parameter that depends on an
    alternative of the manual is a function of the argument that ``answers`` names.
    """

    prefix: str
    largest: Mapping[str, int]
    answers: Mapping[str, str]

    def atom(self, parameter: str) -> Expr:
        if parameter in self.answers:
            return Call(f"{self.prefix}_{parameter}", (Name(self.answers[parameter]),))
        if parameter in self.largest:
            return Name(f"variant.{c_name(parameter)}")
        return Call(f"{self.prefix}_{parameter}", (Name("variant"),))

    def mask(self, width: Expression) -> Expr:
        """Return a mask of ``width`` ones."""
        if width.is_constant:
            return Number((1 << width.constant) - 1, hexadecimal=True)
        return Call("cw_mask", (self.of(width),))

    def of(self, expression: Expression) -> Expr:
        """Return the expression in C, unsigned. No intermediate result is negative unless the result is."""
        match expression:
            case Expression(-1, (Term(1, (Factor(name, True),)),)):
                return Call("cw_mask", (self.atom(name),))
        plus = [self._term(term) for term in expression.terms if term.multiple > 0]
        minus = [self._term(term) for term in expression.terms if term.multiple < 0]
        if expression.constant > 0 or not plus:
            plus.insert(0, Number(max(expression.constant, 0)))
        elif isinstance(plus[0], Name) and (len(expression.terms) > 1 or expression.constant < 0):
            plus[0] = Cast("uint32_t", plus[0])
        if expression.constant < 0:
            minus.append(Number(-expression.constant))
        return joined("-", (joined("+", tuple(plus)), *minus))

    def signed(self, expression: Expression) -> Expr:
        """Return the expression in 64 bits with a sign.

        A power of two is written as its mask plus one, since the power itself may not fit.
        """
        masks = [term for term in expression.terms if term.is_power and not term.is_product]
        constant = expression.constant + sum(term.multiple for term in masks)
        total: Expr | None = Number(constant, signed=True)
        if constant == 0 and expression.terms and expression.terms[0].multiple > 0:
            total = None
        for term in expression.terms:
            product = Call("cw_mask", (self.atom(term.factors[0].parameter),)) if term in masks else self._term(term)
            wide = Cast("int64_t", product)
            sign = "+" if term.multiple > 0 else "-"
            total = Operation(sign, (total, wide)) if total is not None else wide
        return total or Number(0, signed=True)

    def _term(self, term: Term) -> Expr:
        """Return a product, in 64 bits if 32 may be too few. A single parameter keeps its own type."""
        first, *further = (self._factor(factor) for factor in term.factors)
        if abs(term.multiple) != 1:
            further.append(Number(abs(term.multiple)))
        if not further:
            return first
        if not term.factors[0].power:
            # A parameter that an order code does not set has up to 32 bits.
            largest = abs(term.multiple) * prod(self.largest.get(factor.parameter, 1 << 32) for factor in term.factors)
            first = Cast("uint64_t" if term.is_power or largest >> 32 else "uint32_t", first)
        return Operation("*", (first, *further))

    def _factor(self, factor: Factor) -> Expr:
        name = self.atom(factor.parameter)
        return Operation("<<", (Cast("uint64_t", Number(1)), name)) if factor.power else name
