"""Lookups by name whose errors say what does not exist."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NoReturn, Protocol, TypeVar


class _Named(Protocol):
    @property
    def name(self) -> str: ...


_N = TypeVar("_N", bound=_Named)
_T = TypeVar("_T")


def member_named(members: Iterable[_N], name: str, kind: str) -> _N:
    """Return the first member with this name. If there is none, raise a ``LookupError`` that names its ``kind``."""
    for member in members:
        if member.name == name:
            return member
    raise LookupError(f"there is no {kind} called '{name}'")


def first_or_raise(values: Iterable[_T], kind: str) -> _T:
    """Return the first value, or raise a ``LookupError`` with the ``kind`` of value if there is none."""
    for value in values:
        return value
    raise LookupError(f"there is no {kind}")


def assert_never(value: NoReturn) -> NoReturn:
    """Make mypy reject a ``match`` that misses a member of the union."""
    raise AssertionError(f"no case for {value!r}")
