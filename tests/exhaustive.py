"""Cases that ``make quick`` or ``make test`` leaves out, because it has others of their kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pytest


def mostly_exhaustive(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """Return the parameters of a test, of which ``make test`` keeps these."""
    cases = list(cases)
    assert all(case in cases for case in kept), kept
    return [case if case in kept else pytest.param(case, marks=pytest.mark.exhaustive) for case in cases]


def mostly_slow(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """Return the parameters of a test, of which ``make quick`` keeps these."""
    cases = list(cases)
    assert all(case in cases for case in kept), kept
    return [case if case in kept else pytest.param(case, marks=pytest.mark.slow) for case in cases]


def slow_after(count: int, rows: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return the rows of parameters of a test, of which ``make quick`` keeps the first ones."""
    return [row if index < count else pytest.param(*row, marks=pytest.mark.slow) for index, row in enumerate(rows)]


def exhaustive_if(is_exhaustive: Callable[..., bool], rows: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return the rows of parameters of a test, marked where this is true of them."""
    return [pytest.param(*row, marks=pytest.mark.exhaustive) if is_exhaustive(*row) else row for row in rows]
