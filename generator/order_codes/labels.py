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


#: Message for an order code without any character.
EMPTY = "the order code is empty; give the code on the label"


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
    """Return the message for the name of a family instead of an order code."""
    return f"'{text}' is a family; give an order code, such as {code}"


def unknown_code(text: str) -> str:
    return f"'{text}' is not a known order code"


def nearest_codes_hint(codes: str) -> str:
    """Return the end of the message for an unknown order code that is similar to others."""
    return f"; the nearest are {codes}"


#: Highest number of characters in a label, and those shown of a longer text.
LONGEST, _SHOWN_CHARACTERS = 100, 20
#: Least similarity, of 1, for a code to be suggested.
NEAR = 0.5

_PART_IN_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
#: Regular expression for text that may follow the code on a label.
AFTER = r"(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?"


class UnknownOrderCode(ValueError):
    """The order code does not exist. The message names the wrong part and its valid values.

    ``close`` is true if this message should be shown: either all but one part of the text matches the family, or the
    text cannot belong to any family.
    """

    def __init__(self, message: str, close: bool) -> None:
        super().__init__(message)
        self.close = close


@dataclass(frozen=True, slots=True)
class LabelMatch:
    """An order code as read from a label.

    ``variant`` is the matching listed code. If a part has a value that the manual does not list, the code has this
    value, and its interface and parameters come from the first listed code that fits. ``unlisted`` names such parts,
    ``tail`` is the text after the code on the label, and ``special`` is set for codes that end in /Sxxx.
    ``written_as_in`` is where codes are written like this label, if the manual lists order codes in another notation.
    """

    variant: Variant
    unlisted: tuple[str, ...]
    tail: str
    special: bool
    written_as_in: str = ""


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
    """Return True if a value of one part is possible next to these texts of the other parts."""
    return all(texts.get(name) in allowed_texts for name, allowed_texts in value.only_with.items())


def fill_pattern(pattern: str, texts: Mapping[str, str]) -> str:
    """Return a pattern with the names in braces replaced by the texts of these parts."""
    return _PART_IN_BRACES.sub(lambda brace: texts[brace[1]], pattern)


def find_code(device: Device, text: str) -> LabelMatch:
    """Parse the label ``text`` for this family. Text after ``-`` and ``/Sxxx`` are accepted, and spaces are ignored.

    Raises:
        UnknownOrderCode: A part is missing or wrong, the parts cannot be combined, or the text is longer than any
            label.
    """
    if len(text) > LONGEST:
        raise UnknownOrderCode(too_long(text[:_SHOWN_CHARACTERS], str(len(text)), str(LONGEST)), close=True)
    label = without_blanks(text).upper()
    if not label:
        raise UnknownOrderCode(EMPTY, close=True)
    # A part of the code itself may look like /Sxxx, which is a special model only after the code.
    for spelling in (as_listed(device.order_code), *device.order_code.also_written):
        label_match = re.fullmatch(expression_of_code(device.order_code, spelling) + AFTER, label, re.IGNORECASE)
        if label_match is None:
            continue
        # A spelling may use different texts for the values of a part. Other values are as listed.
        value_by_spelling = {(value.part, value.text.upper()): value.value for value in spelling.values}
        value_by_part: dict[str, str] = {}
        for part in device.order_code.parts:
            part_text = label_match[part.name]
            value_by_part[part.name] = value_by_spelling.get((part.name, part_text), part_text)
        variant, unlisted_parts = _variant_with_parts(device, value_by_part, label)
        return LabelMatch(
            variant=variant,
            unlisted=unlisted_parts,
            tail=label_match["tail_"] or "",
            special=label_match["special_"] is not None,
            written_as_in=spelling.where,
        )
    raise _unknown_code_error(device, label)


def without_blanks(text: str) -> str:
    """Return a label or pattern without spaces, since codes are printed both with and without them.

    A byte order mark is removed, too.
    """
    return "".join(text.replace("\ufeff", "").split())


def values_by_spelling(part: CodePart, spelling: Spelling) -> Mapping[str, str]:
    """Return the listed values of ``part`` by their texts in this spelling, which are mostly the same."""
    spellings_of_part = {value.text: value.value for value in spelling.values if value.part == part.name}
    return spellings_of_part or {value.text: value.text for value in part.values}


def beginnings(code: OrderCode) -> tuple[str, ...]:
    """Return the possible prefixes of the family's labels, uppercase and without spaces. "" matches any label.

    Prefixes that begin with another prefix are omitted.
    """
    prefixes: set[str] = set()
    for spelling in (as_listed(code), *code.also_written):
        prefixes |= {without_blanks(text).upper() for text in _first_texts(code, spelling)}
    shortest_prefixes: list[str] = []
    for prefix in sorted(prefixes):  # A prefix of another one comes before it.
        if not prefix.startswith(tuple(shortest_prefixes)):
            shortest_prefixes.append(prefix)
    return tuple(shortest_prefixes)


def _first_texts(code: OrderCode, spelling: Spelling) -> list[str]:
    """Return the texts with which labels in this spelling begin: fixed text, or the values of the first part.

    If the first part can have unlisted values, an empty text is among them, since a label can begin with anything.
    """
    # The split yields texts and names of parts in turn, beginning with a text.
    text_before_parts, *names_and_texts = _PART_IN_BRACES.split(spelling.pattern)
    if text_before_parts.strip():
        return [text_before_parts]
    first_part = member_named(code.parts, names_and_texts[0], "part of the order code")
    first_texts = list(values_by_spelling(first_part, spelling))
    has_own_spelling = any(value.part == first_part.name for value in spelling.values)
    if first_part.open and not has_own_spelling:
        first_texts.append("")
    return first_texts


def as_listed(order_code: OrderCode) -> Spelling:
    """Return, as a spelling, the notation in which the manual lists order codes."""
    return Spelling(pattern=order_code.pattern, where="", values=(), then="", source=())


def _variant_with_parts(
    device: Device, value_by_part: Mapping[str, str], label: str
) -> tuple[Variant, tuple[str, ...]]:
    """Return the order code with these parts, and the names of parts with unlisted values.

    An unlisted value remains in the code. Interface and parameters come from the first listed code that fits.

    Raises:
        UnknownOrderCode: The parts cannot be combined.
    """
    # The value of each part as listed, or None if the manual does not list it.
    listed_values = {part.name: _listed_value(part, value_by_part[part.name]) for part in device.order_code.parts}
    variant = _fitting_variant(device, listed_values)
    if variant is None:
        raise UnknownOrderCode(_clash_message(device, label, value_by_part, listed_values), close=True)
    unlisted_parts = tuple(name for name, value in listed_values.items() if value is None)
    if unlisted_parts:
        printed_values = {name: value or value_by_part[name] for name, value in listed_values.items()}
        variant = Variant(
            code=fill_pattern(device.order_code.pattern, printed_values),
            parts=MappingProxyType(printed_values),
            interface=variant.interface,
            parameters=variant.parameters,
        )
    return variant, unlisted_parts


def _listed_value(part: CodePart, text: str) -> str | None:
    """Return the value of a part as listed, or None if it is not."""
    for value in part.values:
        if value.text.upper() == text.upper():
            return value.text
    return None


def _fitting_variant(device: Device, listed_values: Mapping[str, str | None]) -> Variant | None:
    """Return the first listed code with these parts, or None if there is none.

    In ``listed_values``, None stands for an unlisted value, which matches any listed code. There is no such code if a
    part is unlisted where only listed values are possible.
    """
    for part in device.order_code.parts:
        if listed_values[part.name] is None and not _can_be_open(part, listed_values):
            return None
    for variant in device.variants:
        if all(value in (None, variant.parts[name]) for name, value in listed_values.items()):
            return variant
    return None


def _can_be_open(part: CodePart, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether a part can have an unlisted value in combination with these values of the other parts.

    ``open_only_with`` lists, for some other parts, the values that allow an unlisted value. Unlisted values are always
    allowed.
    """
    for name, allowed_values in part.open_only_with.items():
        if listed_values[name] is not None and listed_values[name] not in allowed_values:
            return False
    return True


def expression_of_code(order_code: OrderCode, spelling: Spelling, anything: str = "") -> str:
    """Return a regular expression for the whole code in this spelling, with a group for each part.

    It is ``X\\-(?P<bits>17|24)`` for the pattern ``X-{bits}``. The part named ``anything`` can have any text.
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
    texts_and_names = _PART_IN_BRACES.split(spelling.pattern)  # Text and names of parts in turn.
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
    """Return a regular expression for the listed values of a part, and for unlisted values if it can have any.

    ``part.open`` is the expression for unlisted values.
    """
    listed_values = _any_of(value.text for value in part.values)
    return f"{listed_values}|{part.open}" if part.open else listed_values


def _any_of(texts: Iterable[str]) -> str:
    """Return a regular expression for one of the texts. The longest are tried first."""
    longest_first = sorted(texts, key=len, reverse=True)
    return "|".join(re.escape(without_blanks(text)) for text in longest_first)


def _clash_message(
    device: Device, label: str, value_by_part: Mapping[str, str], listed_values: Mapping[str, str | None]
) -> str:
    """Return the message about parts that are valid individually but not in combination.

    It names each part for which another value alone would give a listed code.
    """
    clashing_parts: list[str] = []
    for part in device.order_code.parts:
        if _fits_if_changed(device, part, listed_values):
            clashing_parts.append(f"{part.name} '{listed_values[part.name] or value_by_part[part.name]}'")
    parts_text = " and ".join(clashing_parts) or "its parts"
    return cannot_be_combined(label, parts_text, _nearest_codes_text(device, label))


def _fits_if_changed(device: Device, part: CodePart, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether there is a code with these parts if another value of ``part`` is chosen."""
    return any(_fitting_variant(device, {**listed_values, part.name: value.text}) for value in part.values)


class _WrongPart(NamedTuple):
    """A part that may be wrong.

    The smallest tuple is the likeliest: it has the fewest unlisted other parts and, if several are equal, no text
    itself.
    """

    unlisted_others: int
    is_present: bool
    position: int
    text: str


def _unknown_code_error(device: Device, label: str) -> UnknownOrderCode:
    """Return the error about a label, with the missing or unlisted part, if that is clear, and the nearest codes."""
    nearest = _nearest_codes_text(device, label)
    candidates = list(_possible_wrong_parts(device, label))
    if not candidates:
        return UnknownOrderCode(not_of_family(label, device.name.upper(), nearest), close=False)
    likeliest = min(candidates)  # ``_WrongPart`` is ordered by its members.
    part = device.order_code.parts[likeliest.position]
    valid_values = ", ".join(value.text for value in part.values)
    problem = has_part(part.name, likeliest.text) if likeliest.is_present else has_no_part(part.name)
    return UnknownOrderCode(wrong_part(label, problem, valid_values, nearest), close=True)


def _possible_wrong_parts(device: Device, label: str) -> Iterator[_WrongPart]:
    """Yield each part of the order code with which the label would match the family if the part had any text."""
    for position, part in enumerate(device.order_code.parts):
        pattern = expression_of_code(device.order_code, as_listed(device.order_code), anything=part.name) + AFTER
        label_match = re.fullmatch(pattern, label, re.IGNORECASE)
        if label_match is None or not _has_more_than(label_match, part, label):
            continue
        unlisted_others = 0
        for other_part in device.order_code.parts:
            if other_part is not part and _listed_value(other_part, label_match[other_part.name]) is None:
                unlisted_others += 1
        text = label_match[part.name]
        yield _WrongPart(unlisted_others=unlisted_others, is_present=text != "", position=position, text=text)


def _has_more_than(label_match: re.Match[str], part: CodePart, label: str) -> bool:
    """Return True if a label has letters or digits of the family, apart from a wrong part and the tail.

    A family whose codes consist of one part, such as ``{model}``, would otherwise be close to every label.
    """
    tail_length = len(label_match["tail_"] or "") + len(label_match["special_"] or "")
    text_before = label[: label_match.start(part.name)]
    end_of_code = len(label) - tail_length
    text_after = label[label_match.end(part.name) : end_of_code]
    return any(character.isalnum() for character in text_before + text_after)


def _nearest_codes_text(device: Device, label: str) -> str:
    return ", ".join(nearest_codes([device], label))


def nearest_codes(devices: Sequence[Device], text: str, least: float = 0.0) -> list[str]:
    """Return at most three similar listed codes, those that begin with ``text`` first.

    Codes are compared with ``text`` or with ``text`` without its tail.

    Args:
        devices: The families.
        text: Text that was meant as an order code.
        least: Minimum similarity, from 0 to 1.
    """
    from difflib import SequenceMatcher

    # A text may go on after the code, with another hyphen, so it is compared up to the hyphens that the code has.
    # People confuse hyphens and slashes.
    text_with_hyphens = text.upper().replace("/", "-")
    pieces = text_with_hyphens.split("-")
    ranked_codes: list[tuple[bool, float, str]] = []
    for device in devices:
        for variant in device.variants:
            code_with_hyphens = variant.code.upper().replace("/", "-")
            pieces_of_code = code_with_hyphens.count("-") + 1
            text_without_tail = "-".join(pieces[:pieces_of_code])
            begins_with_text = code_with_hyphens.startswith(text_with_hyphens)
            similarity = SequenceMatcher(None, code_with_hyphens, text_without_tail).ratio()
            ranked_codes.append((begins_with_text, similarity, variant.code))
    ranked_codes.sort(key=lambda ranked_code: ranked_code[:2], reverse=True)
    return [code for _, similarity, code in ranked_codes[:3] if similarity >= least]


def edition_before(device: Device, revision: str) -> str:
    """Return the revision that precedes this one, which must not be the first."""
    revisions = [edition.revision for edition in device.editions]
    return revisions[revisions.index(revision) - 1]


def edition_by_label(device: Device, match: LabelMatch) -> str:
    """Return the revision whose labels are written like this label, or an empty string if none is certain."""
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
