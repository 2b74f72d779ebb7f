"""Python expressions as trees, printed with parentheses where Python or a reader needs them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce

from ...model.expressions import Expression, Factor, Term
from ...model.record import dataclass

#: Operators by precedence, lowest first. Arithmetic gets parentheses next to bit operators.
_LOOSEST_FIRST = (("or",), ("and",), ("not",), ("|",), ("^",), ("&",), ("<<", ">>"), ("+", "-"), ("*", "//", "%"))
_LEVELS = {operator: level for level, operators in enumerate(_LOOSEST_FIRST) for operator in operators}
_ARITHMETIC, _ATOM = _LEVELS["+"], len(_LOOSEST_FIRST)


class Expr:
    """Expression. ``str`` returns its text."""

    __slots__ = ()

    @property
    def level(self) -> int:
        return _ATOM

    @property
    def operand(self) -> str:
        """Text next to any operator."""
        return str(self) if self.level == _ATOM else f"({self})"

    def as_operand_of(self, operator: str, after: bool = False) -> str:
        """Return the text as an operand of ``operator``."""
        outer = _LEVELS[operator]
        looser = self.level <= outer if after else self.level < outer
        return self.operand if looser or outer < _ARITHMETIC <= self.level else str(self)


@dataclass(frozen=True, slots=True)
class Atom(Expr):
    """Name, number, call, subscript or attribute."""

    text: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Negative(Expr):
    value: Expr

    @property
    def level(self) -> int:
        return _LEVELS["*"]

    def __str__(self) -> str:
        return f"-{self.value.as_operand_of('*')}"


@dataclass(frozen=True, slots=True)
class Not(Expr):
    value: Expr

    @property
    def level(self) -> int:
        return _LEVELS["not"]

    def __str__(self) -> str:
        return f"not {self.value.as_operand_of('not')}"


@dataclass(frozen=True, slots=True)
class Operation(Expr):
    """Binary operation."""

    left: Expr
    operator: str
    right: Expr

    @property
    def level(self) -> int:
        return _LEVELS[self.operator]

    def __str__(self) -> str:
        left = self.left.as_operand_of(self.operator)
        right = self.right.as_operand_of(self.operator, after=True)
        return f"{left} {self.operator} {right}"


def call(function: str, *arguments: Expr | str) -> Expr:
    return Atom(f"{function}({', '.join(map(str, arguments))})")


def number(value: int) -> Expr:
    return Atom(grouped(value))


def mask(value: int) -> Expr:
    """Return a hexadecimal number."""
    return Atom(f"0x{value:X}")


def grouped(value: int) -> str:
    """Return a decimal number. Five or more digits are grouped by three."""
    return f"{value:_}" if abs(value) >= 10_000 else str(value)


def coded(value: int) -> str:
    """Return the value of a code, in decimal below ten and otherwise in hexadecimal."""
    return str(value) if value < 10 else f"0x{value:X}"


def joined(operator: str, operands: Iterable[Expr]) -> Expr:
    """Return one or more operands, joined by an operator."""
    return reduce(lambda left, right: Operation(left, operator, right), operands)


def times(value: Expr, factor: int) -> Expr:
    return value if factor == 1 else Operation(value, "*", number(factor))


def moved(value: Expr, operator: str, by: Expr) -> Expr:
    """Return ``value`` with a shift, or unchanged if the distance is 0."""
    return value if by == Atom("0") else Operation(value, operator, by)


def _sign(value: int) -> int:
    return 1 if value > 0 else -1


@dataclass(frozen=True, slots=True)
class Scope:
    """Maps the names of parameters to expressions."""

    names: Mapping[str, str]

    def of(self, value: Expression) -> Expr:
        if value.is_constant:
            return number(value.constant)
        terms = [(_sign(term.multiple), self._product(term)) for term in value.terms]
        if value.constant:
            constant = Atom(str(abs(value.constant)))
            sign = _sign(value.constant)
            # A sum should not start with a sign.
            terms.insert(0 if sign > terms[0][0] else len(terms), (sign, constant))
        (sign, first), *following = terms
        total: Expr = first if sign > 0 else Negative(first)
        for sign, product in following:
            total = Operation(total, "+" if sign > 0 else "-", product)
        return total

    def ones(self, width: Expression) -> Expr:
        """Return a mask of ``width`` ones."""
        if width.is_constant:
            return mask((1 << width.constant) - 1)
        return Operation(self.power(width), "-", number(1))

    def power(self, width: Expression) -> Expr:
        return Operation(number(1), "<<", self.of(width))

    def _product(self, term: Term) -> Expr:
        multiple = [number(abs(term.multiple))] if abs(term.multiple) != 1 else []
        return joined("*", [*multiple, *map(self._factor, term.factors)])

    def _factor(self, factor: Factor) -> Expr:
        parameter = Atom(self.names[factor.parameter])
        return Operation(number(1), "<<", parameter) if factor.power else parameter
