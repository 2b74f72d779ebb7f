"""Tests, filters and functions of the templates."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ...plan import operations, steps
from ...plan.limits import Refusal
from ...render import tests_for
from ...say.text import sentence
from .context import byte_order
from .docstrings import docstring
from .expr import Expr, coded, grouped, mask
from .lines import broken
from .literals import constant, literal, quoted, table
from .module import Enumeration
from .names import encoder_name, interface_name
from .text import of_answer, of_crc, of_value


def operand(value: Expr) -> str:
    """Return an operand, in parentheses unless it is a name, a number or a call."""
    return value.operand


FILTERS: Mapping[str, Callable[..., object]] = {
    "broken": broken,
    "byte_order": byte_order,
    "coded": coded,
    "encoder": encoder_name,
    "grouped": grouped,
    "interface": interface_name,
    "mask": mask,
    "operand": operand,
    "sentence": sentence,
}
FUNCTIONS: Mapping[str, Callable[..., object]] = {
    "constant": constant,
    "docstring": docstring,
    "literal": literal,
    "of_crc": of_crc,
    "of_answer": of_answer,
    "of_value": of_value,
    "quoted": quoted,
    "table": table,
}
TESTS = tests_for(
    operations.Check,
    Refusal,
    steps.Operation,
    steps.FixedNumber,
    steps.AsNumber,
    steps.OutsideArgumentLimits,
    steps.Undecodable,
    Enumeration,
)
