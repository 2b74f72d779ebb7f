"""Integers that depend on parameters: ``24``, ``2^position_bits - 1``, ``spare_bits * offset``.

The spec language allows a sum of terms. A term is a product of numbers, parameters and powers of two of parameters.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from .record import dataclass

_TERM_PATTERN = re.compile(
    r"\s*(?:(?P<power>2\s*\^)\s*)?(?:(?P<hex>0x[0-9A-Fa-f]+)|(?P<number>[0-9]+)|(?P<name>[a-z][a-z0-9_]*))\s*"
)
_OPERATOR_PATTERN = re.compile(r"[-+*]")

#: Limit far above the widths, positions and limits of any encoder. It prevents huge numbers in a hostile spec.
LARGEST_EXPONENT = 128
#: Largest number in a product. It is far above the counts of any encoder.
LARGEST_MULTIPLE = 1 << 32
#: Most characters of a number. It is more than 2^128 has, and fewer than Python refuses to convert.
_MOST_DIGITS = 100


def is_power_of_two(number: int) -> bool:
    """Return True for 1, 2, 4 and so on."""
    return number > 0 and number & (number - 1) == 0


class ExpressionError(ValueError):
    """The text is not an expression, or has no value. The message gives the reason."""


@dataclass(frozen=True, slots=True)
class Factor:
    """A parameter or, if ``power`` is set, two to the power of the parameter."""

    parameter: str
    power: bool = False


@dataclass(frozen=True, slots=True)
class Term:
    """``multiple`` times the product of one or more factors, as in ``2 * bits`` or ``bits + bits``."""

    multiple: int
    factors: tuple[Factor, ...]

    @property
    def is_power(self) -> bool:
        """True if one of the factors is a power of two."""
        return any(factor.power for factor in self.factors)

    @property
    def is_product(self) -> bool:
        return len(self.factors) > 1

    def __mul__(self, other: Term) -> Term:
        return Term(self.multiple * other.multiple, (*self.factors, *other.factors))


@dataclass(frozen=True, slots=True)
class Expression:
    """A constant plus terms, in the order in which the spec has them."""

    constant: int = 0
    terms: tuple[Term, ...] = ()

    @classmethod
    @cache
    def parse(cls, text: int | str) -> Expression:
        """Parse an expression from a spec.

        Raises:
            ExpressionError: The text is not a sum of numbers, parameters and powers of two, or the number in a product
                or the exponent of a power is too large.
        """
        if isinstance(text, int):
            return cls(text)
        # ``total`` is the sum so far, ``product`` that of the current term, and ``sign`` the sign of this term.
        total = cls()
        product = cls(1)
        position = 0
        sign = 1
        if text.startswith("-"):
            sign = -1
            position = 1
        while True:
            factor_match = _TERM_PATTERN.match(text, position)
            if factor_match is None:
                raise ExpressionError(f"'{text}' is not a sum of numbers, parameters and powers of two")
            product = _multiply(product, _parse_factor(factor_match))
            position = factor_match.end()
            operator_match = _OPERATOR_PATTERN.match(text, position)
            if position < len(text) and operator_match is None:
                raise ExpressionError(f"'{text}' is not a sum of numbers, parameters and powers of two")
            # The term ends here.
            if operator_match is None or operator_match[0] != "*":
                total = total + product if sign > 0 else total - product
                product = cls(1)
            if operator_match is None:
                return total
            # A product keeps the sign of its term.
            sign = {"+": 1, "-": -1, "*": sign}[operator_match[0]]
            position += 1

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters in order, without duplicates."""
        if not self.terms:
            return ()
        return tuple(dict.fromkeys(factor.parameter for term in self.terms for factor in term.factors))

    @property
    def is_constant(self) -> bool:
        return not self.terms

    @property
    def has_product(self) -> bool:
        """True if one of the terms has several factors."""
        return any(term.is_product for term in self.terms)

    def value(self, parameters: Mapping[str, int]) -> int:
        """Return the value for these parameters.

        Raises:
            ExpressionError: A parameter is missing, an exponent is out of range, or a product is too large.
        """
        total = self.constant
        for term in self.terms:
            product = term.multiple
            for factor in term.factors:
                product *= _value_of_factor(factor, parameters)
                # Products of products, each a parameter of its own, would grow until the memory is full.
                if abs(product) >> (2 * LARGEST_EXPONENT):
                    raise ExpressionError(f"the product is larger than 2^{2 * LARGEST_EXPONENT}")
            total += product
        return total

    def substitute(self, definitions: Mapping[str, Expression]) -> Expression:
        """Return the expression with calculated parameters replaced by their definitions.

        Parameters in powers and products are kept, because two to the power of a sum is not a sum. A parameter defined
        by a product is also kept, because its name is more readable.
        """
        sum_of_terms = Expression(self.constant)
        for term in self.terms:
            definition = definitions.get(term.factors[0].parameter)
            if definition is None or term.is_product or term.is_power or definition.has_product:
                sum_of_terms += Expression(0, (term,))
            else:
                full_definition = definition.substitute(definitions)
                sum_of_terms += full_definition * Expression(term.multiple)
        return sum_of_terms

    def __add__(self, other: Expression) -> Expression:
        return _simplify(self.constant + other.constant, self.terms + other.terms)

    def __sub__(self, other: Expression) -> Expression:
        negated = tuple(Term(-term.multiple, term.factors) for term in other.terms)
        return _simplify(self.constant - other.constant, self.terms + negated)

    def has_value_of(self, other: Expression) -> bool:
        """Return True if both have the same value for all parameters, even if their terms are in another order."""
        return self - other == Expression()

    def __mul__(self, other: Expression) -> Expression:
        term_pairs = itertools.product(self._all_terms, other._all_terms)
        product_of_constants, *other_products = [term * other_term for term, other_term in term_pairs]
        # A constant of 0 leads to products with the multiple 0.
        return _simplify(product_of_constants.multiple, tuple(term for term in other_products if term.multiple))

    @property
    def _all_terms(self) -> tuple[Term, ...]:
        """The constant as a term without factors, then the terms."""
        return (Term(self.constant, ()), *self.terms)

    def render(self, prefix: str = "", power: str = "2^{}", suffix: str = "") -> str:
        """Return the expression as text with the terms first, such as ``variant.singleturn_bits + 8``.

        Args:
            prefix: Text before each parameter, such as ``variant.``.
            power: Notation for two to the power of a parameter. The parameter replaces ``{}``.
            suffix: Text after each number, such as ``U`` in C.
        """
        text_of_terms = ""
        for term in self.terms:
            # The multiple is written first, unless it is 1 or -1.
            factor_texts = [] if abs(term.multiple) == 1 else [f"{abs(term.multiple)}{suffix}"]
            for factor in term.factors:
                parameter_text = prefix + factor.parameter
                factor_texts.append(power.format(parameter_text) if factor.power else parameter_text)
            if text_of_terms:
                text_of_terms += " + " if term.multiple > 0 else " - "
            elif term.multiple <= 0:
                text_of_terms = "-"
            text_of_terms += " * ".join(factor_texts)
        constant_text = f"{abs(self.constant)}{suffix}"
        if not text_of_terms:
            return f"{self.constant}{suffix}"
        if not self.constant:
            return text_of_terms
        if self.constant < 0:
            return f"{text_of_terms} - {constant_text}"
        if text_of_terms.startswith("-"):
            # ``8 - bits`` instead of ``-bits + 8``.
            return f"{constant_text} - {text_of_terms[1:]}"
        return f"{text_of_terms} + {constant_text}"


def _simplify(constant: int, terms: tuple[Term, ...]) -> Expression:
    """Return the sum of a constant and terms, with one term for equal factors, and with positive terms first."""
    multiple_by_factors: dict[tuple[Factor, ...], int] = {}
    for term in terms:
        multiple_by_factors[term.factors] = multiple_by_factors.get(term.factors, 0) + term.multiple
    nonzero_terms = (Term(multiple, factors) for factors, multiple in multiple_by_factors.items() if multiple)
    # False comes before True, and terms of one sign keep their order.
    positive_first = sorted(nonzero_terms, key=lambda term: term.multiple < 0)
    return Expression(constant, tuple(positive_first))


def _parse_factor(factor_match: re.Match[str]) -> Expression:
    """Return the expression for a single factor in a text: a number, a parameter, or two to the power of either.

    Raises:
        ExpressionError: The number or the power is out of range.
    """
    is_power = factor_match["power"] is not None
    if factor_match["name"] is not None:
        factor = Factor(factor_match["name"], power=is_power)
        return Expression(constant=0, terms=(Term(multiple=1, factors=(factor,)),))
    digits = factor_match["hex"] or factor_match["number"]
    if len(digits) > _MOST_DIGITS:
        raise ExpressionError(f"a number of {len(digits)} characters is larger than any field can hold")
    number = int(factor_match["hex"], 16) if factor_match["hex"] else int(factor_match["number"])
    if is_power and number > LARGEST_EXPONENT:
        raise ExpressionError(f"2^{number} is larger than any field can hold")
    return Expression(2**number if is_power else number)


def _multiply(product: Expression, factor: Expression) -> Expression:
    """Return the product of a term so far and another factor. Both are a number, or have exactly one term.

    Raises:
        ExpressionError: The number in the product is too large.
    """
    new_product = product * factor
    sizes_of_numbers = [abs(new_product.constant) if product.is_constant and factor.is_constant else 0]
    sizes_of_numbers += [abs(term.multiple) for term in new_product.terms]
    is_product = product != Expression(1)
    if is_product and max(sizes_of_numbers) > LARGEST_MULTIPLE:
        raise ExpressionError(f"{max(sizes_of_numbers)} in a product is larger than {LARGEST_MULTIPLE}")
    return new_product


def _value_of_factor(factor: Factor, parameters: Mapping[str, int]) -> int:
    """Return the value of a factor.

    Raises:
        ExpressionError: The parameter is missing, or the exponent is out of range.
    """
    if factor.parameter not in parameters:
        raise ExpressionError(f"there is no parameter '{factor.parameter}'")
    parameter_value = parameters[factor.parameter]
    if not factor.power:
        return parameter_value
    if not 0 <= parameter_value <= LARGEST_EXPONENT:
        raise ExpressionError(f"2^{factor.parameter} is too large with {factor.parameter} = {parameter_value}")
    return 1 << parameter_value


def resolve_parameters(known_values: Mapping[str, int], definitions: Mapping[str, Expression]) -> Mapping[str, int]:
    """Return ``known_values`` together with all parameters that can be calculated from them.

    ``definitions`` contains the expressions of the calculated parameters. A parameter is left out if another one in its
    expression is unknown. A value that is out of range is replaced by 0, and reported where it is used.
    """
    parameters = dict(known_values)
    pending_definitions = {name: definition for name, definition in definitions.items() if name not in parameters}
    while pending_definitions:
        calculable_names = []
        for name, definition in pending_definitions.items():
            if parameters.keys() >= set(definition.parameters):
                calculable_names.append(name)
        if not calculable_names:
            break
        for name in calculable_names:
            definition = pending_definitions.pop(name)
            try:
                parameters[name] = definition.value(parameters)
            except ExpressionError:
                parameters[name] = 0
    return MappingProxyType(parameters)
