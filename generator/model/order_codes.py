"""Order codes: their parts, parameters, spellings and alternatives, and the codes to which a fact applies."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from fnmatch import translate
from functools import cache
from glob import escape
from itertools import product
from types import MappingProxyType
from typing import Protocol, TypeVar

from .expressions import Expression
from .facts import (
    Supply,
)
from .manual import Sources
from .record import dataclass


@dataclass(frozen=True, slots=True)
class CodedValue:
    """A value of a parameter, and the code for it in a register."""

    code: int
    value: int


@dataclass(frozen=True, slots=True)
class Parameter:
    """A quantity set by the order code or, if ``equals`` is given, calculated from other quantities.

    The register field ``read_from`` holds either the value or, if there are ``by_code``, a code for it.
    """

    name: str
    meaning: str
    unit: str
    equals: Expression | None
    largest: int
    source: Sources
    read_from: str = ""
    min: int | None = None
    max: int | None = None
    interface: str = ""
    hexadecimal: bool = False
    alternative: str = ""
    by_code: tuple[CodedValue, ...] = ()

    def held_value(self, number: int) -> int | None:
        """Return the value of the parameter for the number in its register field (``read_from``).

        If the field contains codes (``by_code``), the result is None for a number that is not one of them.
        """
        if not self.by_code:
            return number
        return next((coded.value for coded in self.by_code if coded.code == number), None)

    @property
    def register(self) -> str:
        """Register that holds the parameter at run time, or an empty string."""
        register_name, _, _ = self.read_from.partition(".")
        return register_name

    @property
    def field(self) -> str:
        _, _, field_name = self.read_from.partition(".")
        return field_name


@dataclass(frozen=True, slots=True)
class Answer:
    """One answer of an alternative, with the parameters that it sets."""

    name: str
    meaning: str
    sets: Mapping[str, int]
    source: Sources


@dataclass(frozen=True, slots=True)
class Alternative:
    """A question that the manual leaves open. The first answer applies until the user chooses one.

    Frames whose fields depend on the answer cannot be decoded without a choice. If ``default`` names the first answer,
    only verdicts depend on the answer, and the user need not choose.
    """

    name: str
    meaning: str
    answers: tuple[Answer, ...]
    source: Sources
    default: str = ""

    @property
    def parameter(self) -> str:
        """First parameter that the answers set: the only one of an alternative with a default."""
        return next(iter(self.answers[0].sets))


def answer_combinations(alternatives: Sequence[Alternative]) -> Iterator[tuple[tuple[Answer, ...], Mapping[str, int]]]:
    """Yield every combination of answers to the alternatives, with the parameters that it sets.

    Without alternatives there is one combination, which is empty.
    """
    for answers in product(*(alternative.answers for alternative in alternatives)):
        parameters: dict[str, int] = {}
        for answer in answers:
            parameters |= answer.sets
        yield answers, parameters


@dataclass(frozen=True, slots=True)
class CodeValue:
    text: str
    meaning: str
    interface: str
    sets: Mapping[str, int]
    only_with: Mapping[str, tuple[str, ...]]
    source: Sources
    supply: Supply | None = None


@dataclass(frozen=True, slots=True)
class CodePart:
    name: str
    meaning: str
    open: str
    values: tuple[CodeValue, ...]
    source: Sources
    open_only_with: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True)
class SpelledValue:
    """How another spelling of the order code writes one listed value of a part."""

    part: str
    text: str
    value: str


@dataclass(frozen=True, slots=True)
class Spelling:
    """Another notation of order codes on labels. ``where`` describes its use.

    Parts in ``values`` can have only the texts listed there. ``then`` is a regular expression for text after the code
    that has no meaning here.
    """

    pattern: str
    where: str
    values: tuple[SpelledValue, ...]
    then: str
    source: Sources


@dataclass(frozen=True, slots=True)
class OrderCode:
    """Grammar of order codes: a ``pattern`` with the names of parts in braces, and the values of each part."""

    pattern: str
    parts: tuple[CodePart, ...]
    special: str
    not_on_label: str
    note: str
    source: Sources
    also_written: tuple[Spelling, ...] = ()


_PATTERN_PARTS = re.compile(r"\.\.\.|…|x|[^.…x]+|\.")


class Restricted(Protocol):
    """A fact with the order codes to which it applies."""

    @property
    def only(self) -> str: ...


_Fact = TypeVar("_Fact", bound=Restricted)


def facts_for_code(facts: Iterable[_Fact], code: str) -> tuple[_Fact, ...]:
    """Return the facts that apply to an order code: those with matching patterns in ``only``, or without patterns."""
    return tuple(fact for fact in facts if applies_to_code(fact.only, code))


class _Named(Protocol):
    @property
    def name(self) -> str: ...


def repeated_names(facts: Iterable[_Named]) -> set[str]:
    """Return the names that occur more than once. Facts with the same name apply to different order codes."""
    counts = Counter(fact.name for fact in facts)
    return {name for name, count in counts.items() if count > 1}


def applies_to_code(only: str, code: str) -> bool:
    """Return True if an order code matches ``only``, a list of patterns. An empty list matches all order codes.

    In a pattern, ``...`` stands for any text and ``x`` for any one character. Commas separate patterns. The hyphen that
    can follow an order code on a label counts as a part of it.
    """
    if not only:
        return True
    patterns = _code_patterns(only)
    return any(pattern.match(code) or pattern.match(f"{code}-") for pattern in patterns)


@cache
def _code_patterns(only: str) -> tuple[re.Pattern[str], ...]:
    """Return the regular expressions for patterns of order codes that are separated by commas."""
    return tuple(_pattern_of_code(order_code.strip()) for order_code in only.split(","))


def _pattern_of_code(order_code: str) -> re.Pattern[str]:
    """Return the regular expression for a pattern of order codes, such as ``X-24x...``."""
    # The pattern is translated as one of file names, which is fast even if it contains several "...".
    wildcards = {"...": "*", "…": "*", "x": "?"}
    parts = [wildcards.get(part) or escape(part) for part in _PATTERN_PARTS.findall(order_code)]
    return re.compile(translate("".join(parts)))
