"""``only``: the order codes to which a fact applies, abbreviated as in manuals, such as ``.../65K...``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from fnmatch import translate
from functools import cache
from glob import escape
from typing import Protocol, TypeVar

_PARTS = re.compile(r"\.\.\.|…|x|[^.…x]+|\.")


class Restricted(Protocol):
    """A fact with the order codes to which it applies."""

    @property
    def only(self) -> str: ...


_Fact = TypeVar("_Fact", bound=Restricted)


def facts_for_code(facts: Iterable[_Fact], code: str) -> tuple[_Fact, ...]:
    """Return the facts that apply to an order code."""
    return tuple(fact for fact in facts if fits(fact.only, code))


def fits(only: str, code: str) -> bool:
    """Return whether ``code`` is one of the order codes ``only``. An empty ``only`` means all of them.

    ``...`` stands for any text and ``x`` for any one character. Commas separate several patterns. The hyphen after an
    order code on a label counts as part of it.
    """
    return not only or any(pattern.match(text) for pattern in _code_patterns(only) for text in (code, f"{code}-"))


@cache
def _code_patterns(only: str) -> tuple[re.Pattern[str], ...]:
    return tuple(_pattern(order_code.strip()) for order_code in only.split(","))


def _pattern(order_code: str) -> re.Pattern[str]:
    """Return the regular expression of an abbreviated order code."""
    # As for file names, where several "..." do not try every way to share the text between them.
    wildcards = {"...": "*", "…": "*", "x": "?"}
    parts = [wildcards.get(part) or escape(part) for part in _PARTS.findall(order_code)]
    return re.compile(translate("".join(parts)))
