"""Whole numbers that depend on parameters: ``24``, ``singleturn_bits + 8``, ``2^position_bits - 1``.

The spec language allows a sum of terms; a term is a number, a parameter, or two to the power of either.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

_TERM = re.compile(r"\s*(?:(?P<power>2\s*\^)\s*)?(?:(?P<hex>0x[0-9A-Fa-f]+)|(?P<number>[0-9]+)|(?P<name>[a-z][a-z0-9_]*))\s*")
_SIGN = re.compile(r"[+-]")

#: No width, position or limit of any encoder comes near; it keeps a hostile spec from asking for a huge number.
LARGEST_EXPONENT = 128


class ExpressionError(ValueError):
    """The text is no expression, or it has no value; the message says why."""


@dataclass(frozen=True, slots=True)
class Term:
    """``sign * parameter``, or ``sign * 2**parameter`` when ``power`` is set."""

    sign: int
    parameter: str
    power: bool = False


@dataclass(frozen=True, slots=True)
class Expression:
    """A constant plus terms, in the order in which they were written."""

    constant: int = 0
    terms: tuple[Term, ...] = ()

    @classmethod
    def parse(cls, text: int | str) -> Expression:
        """The expression that the spec writes as ``text``.

        Raises:
            ExpressionError: The text is no sum of numbers, parameters and powers of two.
        """
        if isinstance(text, int):
            return cls(text)
        constant, terms, position, sign = 0, [], 0, 1
        if text.startswith("-"):
            sign, position = -1, 1
        while True:
            match = _TERM.match(text, position)
            if match is None:
                raise ExpressionError(f"'{text}' is not a sum of numbers, parameters and powers of two")
            power = match["power"] is not None
            if match["name"] is not None:
                terms.append(Term(sign, match["name"], power))
            else:
                number = int(match["hex"], 16) if match["hex"] else int(match["number"])
                if power and number > LARGEST_EXPONENT:
                    raise ExpressionError(f"2^{number} is more than any field can hold")
                constant += sign * (2**number if power else number)
            position = match.end()
            if position == len(text):
                return cls(constant, tuple(terms))
            operator = _SIGN.match(text, position)
            if operator is None:
                raise ExpressionError(f"'{text}' is not a sum of numbers, parameters and powers of two")
            sign = 1 if operator[0] == "+" else -1
            position += 1

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, each once, in order."""
        return tuple(dict.fromkeys(term.parameter for term in self.terms))

    @property
    def is_constant(self) -> bool:
        return not self.terms

    def value(self, parameters: Mapping[str, int]) -> int:
        """The number for these parameters.

        Raises:
            ExpressionError: A parameter is not among them, or an exponent is out of reach.
        """
        total = self.constant
        for term in self.terms:
            if term.parameter not in parameters:
                raise ExpressionError(f"there is no parameter '{term.parameter}'")
            number = parameters[term.parameter]
            if term.power:
                if not 0 <= number <= LARGEST_EXPONENT:
                    raise ExpressionError(f"2^{term.parameter} is out of reach with {term.parameter} = {number}")
                number = 2**number
            total += term.sign * number
        return total

    def substitute(self, definitions: Mapping[str, Expression]) -> Expression:
        """The same with parameters that follow from others replaced by what they equal.

        A power keeps its parameter: two to a sum is no sum.
        """
        result = Expression(self.constant)
        for term in self.terms:
            inner = definitions.get(term.parameter)
            if term.power or inner is None:
                result += Expression(0, (term,))
            else:
                inner = inner.substitute(definitions)
                result = result + inner if term.sign > 0 else result - inner
        return result

    def __add__(self, other: Expression) -> Expression:
        return _simplified(self.constant + other.constant, self.terms + other.terms)

    def __sub__(self, other: Expression) -> Expression:
        negated = tuple(Term(-term.sign, term.parameter, term.power) for term in other.terms)
        return _simplified(self.constant - other.constant, self.terms + negated)

    def render(self, prefix: str = "", power: str = "2^{}", suffix: str = "") -> str:
        """The expression as text, terms first: ``variant.singleturn_bits + 8``.

        Args:
            prefix: Put before each parameter, such as ``variant.``.
            power: How two to the power of a parameter is written; ``{}`` is the parameter.
            suffix: Put after each number, such as ``U`` in C.
        """
        text = ""
        for term in self.terms:
            atom = prefix + term.parameter
            atom = power.format(atom) if term.power else atom
            if text:
                text += (" + " if term.sign > 0 else " - ") + atom
            else:
                text = ("" if term.sign > 0 else "-") + atom
        if not text:
            return f"{self.constant}{suffix}"
        if text.startswith("-") and self.constant > 0:
            return f"{self.constant}{suffix} - {text[1:]}"
        if self.constant > 0:
            return f"{text} + {self.constant}{suffix}"
        return f"{text} - {-self.constant}{suffix}" if self.constant < 0 else text


def _simplified(constant: int, terms: tuple[Term, ...]) -> Expression:
    """The sum with opposite terms cancelled and positive terms first."""
    kept: list[Term] = []
    for term in terms:
        opposite = Term(-term.sign, term.parameter, term.power)
        if opposite in kept:
            kept.remove(opposite)
        else:
            kept.append(term)
    return Expression(constant, tuple(sorted(kept, key=lambda term: -term.sign)))
