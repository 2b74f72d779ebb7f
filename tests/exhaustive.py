"""Cases that only ``make verify`` runs, because ``make test`` has others of their kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pytest


def mostly_exhaustive(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """Return the parameters of a test, of which ``make test`` only runs ``kept``."""
    cases = list(cases)
    assert all(case in cases for case in kept), kept
    return [case if case in kept else pytest.param(case, marks=pytest.mark.exhaustive) for case in cases]


def exhaustive_if(is_exhaustive: Callable[..., bool], rows: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return the rows of parameters of a test, marked where this is true of them."""
    return [pytest.param(*row, marks=pytest.mark.exhaustive) if is_exhaustive(*row) else row for row in rows]
