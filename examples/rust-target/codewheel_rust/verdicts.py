"""Conditions of a verdict on the position of a frame, as expressions over ``self`` and ``variant``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from operator import or_

from codewheel.model import Verdict, assert_never
from codewheel.plan.operations import FieldToDecode, Reserved
from codewheel.plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
)
from codewheel.plan.verdicts import CodeCondition, MatchingValues, VerdictCause

from .family import Struct
from .names import pascal, snake
from .spelling import Scope, hexadecimal


def conditions(struct: Struct, scope: Scope) -> Iterator[tuple[str, Verdict]]:
    """Yield the conditions of the verdicts that are worse than that without an active cause, worst first."""
    verdict_rules = struct.verdict_rules
    if verdict_rules is None:
        return
    causes = dict(verdict_rules.worst_first)
    for verdict in Verdict:
        if verdict is Verdict.UNKNOWN and verdict_rules.may_be_unknown:
            yield f"{scope.expression(verdict_rules.judges_if_positive)} == 0", verdict
        for condition in _active(struct, causes.get(verdict, ()), scope):
            yield condition, verdict


def _active(struct: Struct, causes: Sequence[VerdictCause], scope: Scope) -> Iterator[str]:
    """Yield the condition that each cause is active. Unused bits are checked together."""
    for cause in causes:
        if not isinstance(cause.cause, Reserved):
            terms = [_selects(condition, scope) for condition in cause.conditions]
            terms += _terms(struct, cause.cause)
            terms += [f"!self.{snake(part.field.name)}" for part in cause.overriding_flags]
            yield " && ".join(terms)
    mask = reduce(or_, (cause.cause.mask for cause in causes if isinstance(cause.cause, Reserved)), 0)
    if mask:
        yield f"self.unused & {hexadecimal(mask)} != 0"


def _selects(condition: CodeCondition, scope: Scope) -> str:
    return f"{scope.parameter(condition.parameter)} {'!=' if condition.holds else '=='} 0"


def _terms(struct: Struct, cause: FieldToDecode | MatchingValues) -> Iterator[str]:
    """Yield the conditions that a flag is active, or that fields have their values."""
    parts = cause.conditions if isinstance(cause, MatchingValues) else ((cause, 1),)
    for part, value in parts:
        member = f"self.{snake(part.field.name)}"
        match part.meaning:
            case ActiveFlag():
                yield member if value else f"!{member}"
            case NamedChoice():
                enum = struct.enums[part.field.name]
                name = next(named.name for named in enum.values if named.value == value)
                yield f"{member} == {enum.name}::{pascal(name)}"
            case UnsignedNumber() | TwosComplement() | ZeroMeans() | DecimalDigits() | Latin1Text():
                yield f"{member} == {value}"
            case meaning:
                assert_never(meaning)
