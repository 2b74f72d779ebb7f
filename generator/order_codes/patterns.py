"""List the order codes of a family, and build the regular expressions that match their texts on labels."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from ..model import CodePart, CodeValue, OrderCode, Spelling, member_named

_PART_IN_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")


class ListedCode(NamedTuple):
    """A listed order code: ``("X-24-B", {"bits": "24", "output": "B"}, "biss", {"singleturn_bits": 24})``."""

    text: str
    #: The text of each part, by the name of the part.
    parts: Mapping[str, str]
    interface: str
    #: The parameters that the parts set.
    parameters: Mapping[str, int]


def listed_codes(order_code: OrderCode) -> Iterator[ListedCode]:
    """Yield every combination of values of the parts that is allowed, as an order code."""
    values_of_parts = [part.values for part in order_code.parts]
    for values in itertools.product(*values_of_parts):
        texts = {part.name: value.text for part, value in zip(order_code.parts, values, strict=True)}
        if not all(_can_be_combined(value, texts) for value in values):
            continue
        parameters: dict[str, int] = {}
        for value in values:
            parameters |= value.sets
        interfaces = [value.interface for value in values if value.interface]
        interface = interfaces[0] if interfaces else ""
        code = fill_pattern(order_code.pattern, texts)
        yield ListedCode(text=code, parts=texts, interface=interface, parameters=parameters)


def _can_be_combined(value: CodeValue, texts: Mapping[str, str]) -> bool:
    """Return whether a value of one part can be combined with these texts of the other parts.

    ``only_with`` lists, for some other parts, the texts with which the value is possible.
    """
    return all(texts.get(name) in allowed_texts for name, allowed_texts in value.only_with.items())


def fill_pattern(pattern: str, texts: Mapping[str, str]) -> str:
    """Return a pattern such as ``X-{bits}`` with the names in braces replaced by the texts of these parts."""
    return _PART_IN_BRACES.sub(lambda brace: texts[brace[1]], pattern)


def without_blanks(text: str) -> str:
    """Return a label or pattern without spaces, because codes are printed both with and without them.

    A byte order mark is also removed.
    """
    return "".join(text.replace("\ufeff", "").split())


def values_by_spelling(part: CodePart, spelling: Spelling) -> Mapping[str, str]:
    """Return the listed values of an order code part by their texts in this spelling. Most texts equal the values."""
    spellings_of_part = {value.text: value.value for value in spelling.values if value.part == part.name}
    return spellings_of_part or {value.text: value.text for value in part.values}


def beginnings(order_code: OrderCode) -> tuple[str, ...]:
    """Return the texts with which labels of the family begin, in uppercase and without spaces.

    Texts that begin with another of these texts are left out. ``("",)`` means that a label can begin with any text.
    """
    prefixes: set[str] = set()
    for spelling in (as_listed(order_code), *order_code.also_written):
        prefixes |= {without_blanks(text).upper() for text in _first_texts(order_code, spelling)}
    shortest_prefixes: list[str] = []
    for prefix in sorted(prefixes):  # If one prefix begins with another, the shorter one comes first.
        if not prefix.startswith(tuple(shortest_prefixes)):
            shortest_prefixes.append(prefix)
    return tuple(shortest_prefixes)


def _first_texts(order_code: OrderCode, spelling: Spelling) -> list[str]:
    """Return the texts with which labels in this spelling begin: fixed text, or the values of the first part.

    If the first part can have unlisted values, the list contains "", because a label can then begin with any text.
    """
    # The split alternates between fixed texts and names of parts, beginning with a text.
    text_before_parts, first_part_name, *_ = _PART_IN_BRACES.split(spelling.pattern)
    if text_before_parts.strip():
        return [text_before_parts]
    first_part = member_named(order_code.parts, first_part_name, "part of the order code")
    first_texts = list(values_by_spelling(first_part, spelling))
    has_own_spelling = any(value.part == first_part.name for value in spelling.values)
    if first_part.open and not has_own_spelling:
        first_texts.append("")
    return first_texts


def as_listed(order_code: OrderCode) -> Spelling:
    """Return the notation in which the manual lists order codes, as an object like the additional notations."""
    return Spelling(pattern=order_code.pattern, where="", values=(), then="", source=())


def expression_of_code(order_code: OrderCode, spelling: Spelling, anything: str = "") -> str:
    """Return a regular expression for an order code in this spelling, with a group for each part.

    For the pattern ``X-{bits}``, it is ``X\\-(?P<bits>17|24)``. The part named ``anything`` matches any text.
    """
    spelled_parts = {value.part for value in spelling.values}
    pattern_by_part: dict[str, str] = {}
    for part in order_code.parts:
        if part.name == anything:
            pattern_by_part[part.name] = "[A-Z0-9]*"
        elif part.name in spelled_parts:
            pattern_by_part[part.name] = _any_of(values_by_spelling(part, spelling))
        else:
            pattern_by_part[part.name] = _value_pattern(part)
    expression = ""
    # The split alternates between fixed texts and names of parts, beginning with a text.
    texts_and_names = _PART_IN_BRACES.split(spelling.pattern)
    for index, text_or_name in enumerate(texts_and_names):
        is_name = index % 2 == 1
        if is_name:
            expression += f"(?P<{text_or_name}>{pattern_by_part[text_or_name]})"
        else:
            expression += re.escape(without_blanks(text_or_name))
    if spelling.then:
        expression += f"(?:{spelling.then})"
    return expression


def _value_pattern(part: CodePart) -> str:
    """Return a regular expression for the listed values of a part, and for unlisted values if the part can have any.

    ``part.open`` is the regular expression for unlisted values, or "" if only listed values are possible.
    """
    listed_values = _any_of(value.text for value in part.values)
    return f"{listed_values}|{part.open}" if part.open else listed_values


def _any_of(texts: Iterable[str]) -> str:
    """Return a regular expression for one of the texts. The longest are tried first."""
    longest_first = sorted(texts, key=len, reverse=True)
    return "|".join(re.escape(without_blanks(text)) for text in longest_first)
