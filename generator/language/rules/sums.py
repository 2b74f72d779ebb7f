"""Rules for the size of parameters that are calculated from others."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from ...model.expressions import LARGEST_MULTIPLE, Expression, ExpressionError, Term
from ..problems import DocumentReport, quoted
from ..written_codes import WrittenParameter
from ..written_parts import WrittenSpec

#: Most terms of a sum of parameters, with all definitions inserted.
_MOST_TERMS = 256


def list_terms(expression_text: object) -> tuple[Term, ...]:
    """Return the terms of an expression as it is written. Empty for text that is not an expression."""
    if not isinstance(expression_text, (int, str)):
        return ()
    try:
        return Expression.parse(expression_text).terms
    except ExpressionError:  # Reported by the rule on expressions.
        return ()


class _SumSize(NamedTuple):
    """Number of terms of a parameter with all definitions inserted, and the largest number in a product."""

    terms: int
    multiple: int

    @property
    def is_too_large(self) -> bool:
        return self.terms > _MOST_TERMS or self.multiple > LARGEST_MULTIPLE


def check_long_sums(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no parameter becomes a long sum or a large multiple when its parameters are replaced.

    They are replaced by their definitions. Definitions that each use another one twice would take forever: 30 of them
    are a sum of 2^30 terms. A parameter that uses a reported one is not reported.
    """
    size_by_name: dict[str, _SumSize] = {}
    for name, parameter in spec.parameters.items():
        size = _find_size(name, spec.parameters, size_by_name)
        used_names = [factor.parameter for term in list_terms(parameter.equals) for factor in term.factors]
        uses_reported = any(size_by_name[used_name].is_too_large for used_name in used_names)
        if not size.is_too_large or uses_reported:
            continue
        if size.terms > _MOST_TERMS:
            problem = f"is a sum of {size.terms} terms with the definitions of its parameters"
            limit = _MOST_TERMS
        else:
            problem = f"is a multiple of {size.multiple} with the definitions of its parameters"
            limit = LARGEST_MULTIPLE
        report.add("bad-expression", parameter.place_of("equals"), f"{quoted(name)} {problem}; the limit is {limit}")


def _find_size(name: str, parameters: Mapping[str, WrittenParameter], size_by_name: dict[str, _SumSize]) -> _SumSize:
    """Return the size of a parameter when all parameters in it are replaced by their definitions.

    Each factor of a product counts as a term. A parameter without a definition has one term. ``size_by_name`` caches
    the results.
    """
    if name in size_by_name:
        return size_by_name[name]
    size_by_name[name] = _SumSize(1, 1)  # This ends the recursion for a circular definition, another rule reports it.
    terms = list_terms(parameters[name].equals) if name in parameters else ()
    term_count, largest_multiple = 0, 1
    for term in terms:
        sizes = [_find_size(factor.parameter, parameters, size_by_name) for factor in term.factors]
        term_count += sum(size.terms for size in sizes)
        multiple = abs(term.multiple) * math.prod(size.multiple for size in sizes)
        largest_multiple = max(largest_multiple, multiple)
    if terms:
        size_by_name[name] = _SumSize(term_count, largest_multiple)
    return size_by_name[name]
