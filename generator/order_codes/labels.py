"""Enumerate order codes, parse the text of a label, and find the edition of the manual for a label."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from ..model import CodePart, CodeValue, Device, EditionTest, OrderCode, Spelling, Variant, member_named
from ..model.record import dataclass


def too_long(start: str, length: str, longest: str) -> str:
    """Return the message for text that is longer than any label."""
    return f"'{start}...' is not an order code: it has {length} characters, more than the {longest} of any label"


def cannot_be_combined(code: str, parts: str, nearest: str) -> str:
    """Return the message for parts that are valid individually but not in combination."""
    return f"'{code}' has {parts}, which cannot be combined; the nearest codes are {nearest}"


def not_of_family(code: str, family: str, nearest: str) -> str:
    return f"'{code}' is not an order code of {family}; the nearest are {nearest}"


def wrong_part(code: str, problem: str, valid: str, nearest: str) -> str:
    """Return the message for one wrong or missing part. ``problem`` says which: ``has singleturn '19'``."""
    return f"'{code}' {problem}; valid values: {valid}. The nearest codes are {nearest}"


def has_part(name: str, value: str) -> str:
    return f"has {name} '{value}'"


def has_no_part(name: str) -> str:
    return f"has no {name}"


def family_instead_of_code(text: str, code: str) -> str:
    """Return the message for the name of a family in place of an order code."""
    return f"'{text}' is a family; give an order code, such as {code}"


def unknown_code(text: str) -> str:
    return f"'{text}' is not a known order code"


def nearest_codes_hint(codes: str) -> str:
    """Return the end of the message for an unknown order code that is similar to others."""
    return f"; the nearest are {codes}"


#: Highest number of characters in a label.
LONGEST = 100
#: Least similarity, of 1, for a code to be suggested.
NEAR = 0.4

_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
#: Regular expression for text that may follow the code on a label.
AFTER = r"(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?"


class UnknownOrderCode(ValueError):
    """The order code does not exist. The message names the wrong part and its valid values.

    ``close`` is true if this message is the one to show: either all but one part of the text matches the family, or the
    text cannot belong to any family.
    """

    def __init__(self, message: str, close: bool) -> None:
        super().__init__(message)
        self.close = close


@dataclass(frozen=True, slots=True)
class Match:
    """An order code as read from a label.

    ``variant`` is the matching listed code. ``unlisted`` names the parts whose value is not listed in the manual,
    ``tail`` is the text after the code on the label, and ``special`` is set for codes that end in /Sxxx.
    ``written_as_in`` is where codes are written like this label, if the manual lists order codes in another notation.
    """

    variant: Variant
    unlisted: tuple[str, ...]
    tail: str
    special: bool
    written_as_in: str = ""


def combinations(order_code: OrderCode) -> Iterator[tuple[str, Mapping[str, str], str, Mapping[str, int]]]:
    """Yield every listed code: text, value of each part, interface, and the parameters that the parts set."""
    for values in itertools.product(*(part.values for part in order_code.parts)):
        texts = {part.name: value.text for part, value in zip(order_code.parts, values, strict=True)}
        if not all(_can_be_combined(value, texts) for value in values):
            continue
        parameters: dict[str, int] = {}
        for value in values:
            parameters |= value.sets
        interfaces = [value.interface for value in values if value.interface]
        interface = interfaces[0] if interfaces else ""
        yield filled(order_code.pattern, texts), texts, interface, parameters


def _can_be_combined(value: CodeValue, texts: Mapping[str, str]) -> bool:
    """Return True if a value of one part is possible next to these texts of the other parts."""
    return all(texts.get(name) in allowed_texts for name, allowed_texts in value.only_with.items())


def filled(pattern: str, texts: Mapping[str, str]) -> str:
    """Return a pattern with the names in braces replaced by the texts of these parts."""
    return _BRACES.sub(lambda brace: texts[brace[1]], pattern)


def find(device: Device, text: str) -> Match:
    """Parse the label ``text`` for this family. Text after ``-`` and ``/Sxxx`` are accepted, and spaces are ignored.

    Raises:
        UnknownOrderCode: A part is missing or wrong, or the text is longer than any label.
    """
    if len(text) > LONGEST:
        raise UnknownOrderCode(too_long(text[:20], str(len(text)), str(LONGEST)), close=True)
    code = without_blanks(text).upper()
    # A part of the code itself may look like /Sxxx, which is a special model only after the code.
    for spelling in (as_listed(device.order_code), *device.order_code.also_written):
        match = re.fullmatch(regex(device.order_code, spelling) + AFTER, code, re.IGNORECASE)
        if match is not None:
            value_by_text = {(value.part, value.text.upper()): value.value for value in spelling.values}
            part_texts = ((part.name, match[part.name]) for part in device.order_code.parts)
            parts = {name: value_by_text.get((name, text), text) for name, text in part_texts}
            variant, unlisted = _resolve(device, parts, code)
            return Match(variant, unlisted, match["tail_"] or "", match["special_"] is not None, spelling.where)
    raise _explain(device, code)


def without_blanks(text: str) -> str:
    """Return a label or pattern without spaces, since codes are printed both with and without them."""
    return "".join(text.split())


def spelled(part: CodePart, spelling: Spelling) -> Mapping[str, str]:
    """Return the listed values of ``part`` by their texts in this spelling."""
    own_spellings = {value.text: value.value for value in spelling.values if value.part == part.name}
    return own_spellings or {value.text: value.text for value in part.values}


def beginnings(code: OrderCode) -> tuple[str, ...]:
    """Return the possible prefixes of the family's labels, uppercase and without spaces. "" matches any label."""
    prefixes: set[str] = set()
    for spelling in (as_listed(code), *code.also_written):
        literal, *names_and_literals = _BRACES.split(spelling.pattern)
        texts = [literal]
        if not literal.strip():  # The pattern begins with a part.
            first_part = member_named(code.parts, names_and_literals[0], "part of the order code")
            texts = list(spelled(first_part, spelling))
            has_own_spelling = any(value.part == first_part.name for value in spelling.values)
            if first_part.open and not has_own_spelling:
                texts.append("")
        prefixes |= {without_blanks(text).upper() for text in texts}
    shortest: list[str] = []
    for prefix in sorted(prefixes):  # A prefix of another one comes before it.
        if not prefix.startswith(tuple(shortest)):
            shortest.append(prefix)
    return tuple(shortest)


def as_listed(order_code: OrderCode) -> Spelling:
    """Return, as a spelling, the notation in which the manual lists order codes."""
    return Spelling(order_code.pattern, "", (), "", ())


def _resolve(device: Device, parts: Mapping[str, str], code: str) -> tuple[Variant, tuple[str, ...]]:
    """Return the order code with these parts, and the names of parts with unlisted values."""
    listed_values = {part.name: _listed_value(part, parts[part.name]) for part in device.order_code.parts}
    variant = _fitting_code(device, listed_values)
    if variant is None:
        raise UnknownOrderCode(_clash_message(device, code, parts, listed_values), close=True)
    unlisted = tuple(name for name, value in listed_values.items() if value is None)
    if unlisted:
        printed_values = {name: value or parts[name] for name, value in listed_values.items()}
        printed = filled(device.order_code.pattern, printed_values)
        variant = Variant(printed, MappingProxyType(printed_values), variant.interface, variant.parameters)
    return variant, unlisted


def _listed_value(part: CodePart, text: str) -> str | None:
    """Return the value of a part as listed, or None if it is not."""
    for value in part.values:
        if value.text.upper() == text.upper():
            return value.text
    return None


def _fitting_code(device: Device, listed_values: Mapping[str, str | None]) -> Variant | None:
    """Return the first listed code with these parts, where None stands for an unlisted value."""
    for part in device.order_code.parts:
        if listed_values[part.name] is None and not _can_be_open(part, listed_values):
            return None
    for variant in device.variants:
        if all(value in (None, variant.parts[name]) for name, value in listed_values.items()):
            return variant
    return None


def _can_be_open(part: CodePart, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether a part can have an unlisted value next to these values of the other parts."""
    return all(listed_values[name] in (None, *allowed) for name, allowed in part.open_only_with.items())


def regex(order_code: OrderCode, spelling: Spelling, anything: str = "") -> str:
    """Return a regular expression for the whole code in this spelling. The part ``anything`` can have any text."""
    spelled_parts = {value.part for value in spelling.values}
    pattern_by_part: dict[str, str] = {}
    for part in order_code.parts:
        if part.name == anything:
            pattern_by_part[part.name] = "[A-Z0-9]*"
        elif part.name in spelled_parts:
            pattern_by_part[part.name] = _any_of(spelled(part, spelling))
        else:
            pattern_by_part[part.name] = _value_pattern(part)
    pieces = _BRACES.split(spelling.pattern)  # Text and names of parts in turn.
    pieces[::2] = [re.escape(without_blanks(text)) for text in pieces[::2]]
    pieces[1::2] = [f"(?P<{name}>{pattern_by_part[name]})" for name in pieces[1::2]]
    end = f"(?:{spelling.then})" if spelling.then else ""
    return "".join(pieces) + end


def _value_pattern(part: CodePart) -> str:
    listed = _any_of(value.text for value in part.values)
    return f"{listed}|{part.open}" if part.open else listed


def _any_of(texts: Iterable[str]) -> str:
    return "|".join(re.escape(without_blanks(text)) for text in sorted(texts, key=len, reverse=True))


def _clash_message(device: Device, code: str, parts: Mapping[str, str], listed_values: Mapping[str, str | None]) -> str:
    """Return the message about parts that are valid individually but not in combination, with the parts to change."""
    names = [part.name for part in device.order_code.parts if _fits_if_changed(device, part, listed_values)]
    listed_parts = " and ".join(f"{name} '{listed_values[name] or parts[name]}'" for name in names) or "its parts"
    return cannot_be_combined(code, listed_parts, _nearest_hint(device, code))


def _fits_if_changed(device: Device, part: CodePart, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether there is a code with these parts if another value of ``part`` is chosen."""
    return any(_fitting_code(device, {**listed_values, part.name: value.text}) for value in part.values)


class _WrongPart(NamedTuple):
    """A part that may be the wrong one. The likeliest has the fewest unlisted other parts, and then no text itself."""

    unlisted_others: int
    is_present: bool
    position: int
    text: str


def _explain(device: Device, code: str) -> UnknownOrderCode:
    """Return the error about ``code``, with the missing or unlisted part, if that is clear, and the nearest codes."""
    candidates = []
    for position, part in enumerate(device.order_code.parts):
        pattern = regex(device.order_code, as_listed(device.order_code), part.name) + AFTER
        match = re.fullmatch(pattern, code, re.IGNORECASE)
        if match is None or not _has_more_than(match, part, code):
            continue
        text = match[part.name]
        other_parts = [other_part for other_part in device.order_code.parts if other_part is not part]
        unlisted_others = [other for other in other_parts if _listed_value(other, match[other.name]) is None]
        candidates.append(_WrongPart(len(unlisted_others), text != "", position, text))
    if not candidates:
        problem = not_of_family(code, device.name.upper(), _nearest_hint(device, code))
        return UnknownOrderCode(problem, close=False)
    wrong = min(candidates)
    part = device.order_code.parts[wrong.position]
    valid_values = ", ".join(value.text for value in part.values)
    problem = has_part(part.name, wrong.text) if wrong.is_present else has_no_part(part.name)
    return UnknownOrderCode(wrong_part(code, problem, valid_values, _nearest_hint(device, code)), close=True)


def _has_more_than(match: re.Match[str], part: CodePart, code: str) -> bool:
    """Return True if a label has letters or digits of the family, apart from a wrong part and the tail.

    A family whose codes consist of one part, such as ``{model}``, would otherwise be close to every label.
    """
    tail = len(match["tail_"] or "") + len(match["special_"] or "")
    other_text = code[: match.start(part.name)] + code[match.end(part.name) : len(code) - tail]
    return match[part.name] == "" or any(map(str.isalnum, other_text))


def closest_reason(devices: Iterable[Device], text: str) -> str | None:
    """Return why text that is an order code of none of these families is not one of the first that is close."""
    for device in devices:
        try:
            find(device, text)
        except UnknownOrderCode as reason:
            if reason.close:
                return str(reason)
    return None


def _nearest_hint(device: Device, code: str) -> str:
    return ", ".join(nearest_codes([device], code))


def nearest_codes(devices: Sequence[Device], text: str, least: float = 0.0) -> list[str]:
    """Return the three listed codes that are most similar to ``text``, or to ``text`` without its tail.

    Args:
        devices: The families.
        text: Text that was meant as an order code.
        least: Minimum similarity, from 0 to 1.
    """
    from difflib import SequenceMatcher

    pieces = text.upper().split("-")
    similarities: list[tuple[float, str]] = []
    for device in devices:
        for variant in device.variants:
            # A text may go on after the code, with another hyphen.
            text_without_tail = "-".join(pieces[: variant.code.count("-") + 1])
            similarity = SequenceMatcher(None, variant.code, text_without_tail).ratio()
            similarities.append((similarity, variant.code))
    most_similar = sorted(similarities, key=lambda similarity_and_code: similarity_and_code[0], reverse=True)[:3]
    return [code for similarity, code in most_similar if similarity >= least]


def edition_before(device: Device, revision: str) -> str:
    """Return the revision that precedes this one."""
    revisions = [edition.revision for edition in device.editions]
    return revisions[revisions.index(revision) - 1]


def edition_by_label(device: Device, match: Match) -> str:
    """Return the edition whose labels are written like this one, or an empty string if the label does not show it."""
    spellings = device.order_code.also_written
    patterns = {spelling.pattern for spelling in spellings if spelling.where == match.written_as_in}
    for edition in device.editions:
        if not patterns.isdisjoint(edition.labels):
            return edition.revision
    return ""


def tests_of(device: Device, register: str) -> Iterator[tuple[str, EditionTest]]:
    """Yield the tests of a register, each with the first revision for which the register passes the test."""
    for edition in device.editions:
        for test in edition.tests:
            if test.register == register:
                yield edition.revision, test
