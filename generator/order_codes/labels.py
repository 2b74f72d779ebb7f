"""Find the order code of a label, say why a text is not one, and find the edition of the manual for a label."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from ..model import CodePart, Device, EditionTest, Variant
from ..model.record import dataclass
from .patterns import as_listed, expression_of_code, fill_pattern, without_blanks


def too_long(start: str, length: str, longest: str) -> str:
    """Return the message for a text that is longer than any label. ``start`` is its beginning."""
    return f"'{start}...' is not an order code: it has {length} characters, more than the {longest} of any label"


#: Message for an order code without any character.
EMPTY = "the order code is empty; give the code on the label"


def cannot_be_combined(code: str, parts: str, nearest: str) -> str:
    """Return the message for parts that are valid individually but not in combination."""
    return f"'{code}' has {parts}, which cannot be combined; the nearest codes are {nearest}"


def not_of_family(code: str, family: str, nearest: str) -> str:
    """Return the message for an order code that does not belong to a family."""
    return f"'{code}' is not an order code of {family}; the nearest are {nearest}"


def wrong_part(code: str, problem: str, valid: str, nearest: str) -> str:
    """Return the message for one wrong or missing part. ``problem`` says which: ``has singleturn '19'``."""
    return f"'{code}' {problem}; valid values: {valid}. The nearest codes are {nearest}"


def unlisted_values(pattern: str) -> str:
    """Return the end of a list of valid values, for a part that also accepts values of the form of a pattern."""
    return f", and others of the form {pattern}"


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


#: Highest number of characters in a label, and number of characters that are shown of a longer text.
LONGEST, _SHOWN_CHARACTERS = 100, 20
#: Lowest similarity, from 0 to 1, at which a code is suggested.
NEAR = 0.5
#: Regular expression for text that may follow the code on a label: ``-more text``, ``/S042``, or both.
AFTER = r"(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?"


class UnknownOrderCode(ValueError):
    """The order code does not exist. The message names the wrong part and its valid values.

    ``names_mistake`` is true if the message names the mistake in the text: all but one part of it match the family, the
    parts cannot be combined, or the text is empty or too long. It is false if the text belongs to another family.
    """

    def __init__(self, message: str, names_mistake: bool) -> None:
        super().__init__(message)
        self.names_mistake = names_mistake


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


def find_code(device: Device, text: str) -> LabelMatch:
    """Return the order code of a family that matches the text of a label.

    Spaces are ignored. After the order code, the label can continue with ``-`` and any text, or with ``/Sxxx``.

    Raises:
        UnknownOrderCode: A part is missing or wrong, the parts cannot be combined, or the text is longer than any
            label.
    """
    if len(text) > LONGEST:
        message = too_long(start=text[:_SHOWN_CHARACTERS], length=str(len(text)), longest=str(LONGEST))
        raise UnknownOrderCode(message, names_mistake=True)
    label = without_blanks(text).upper()
    if not label:
        raise UnknownOrderCode(EMPTY, names_mistake=True)
    # A part of the code itself may look like /Sxxx, which is a special model only after the code.
    for spelling in (as_listed(device.order_code), *device.order_code.also_written):
        label_pattern = expression_of_code(device.order_code, spelling) + AFTER
        label_match = re.fullmatch(label_pattern, label, re.IGNORECASE)
        if label_match is None:
            continue
        # A spelling may use its own texts for the values of a part. All other values have the texts that are listed.
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


def _variant_with_parts(
    device: Device, value_by_part: Mapping[str, str], label: str
) -> tuple[Variant, tuple[str, ...]]:
    """Return the order code with these values of its parts, and the names of parts whose value is not listed.

    The returned code contains the unlisted values. Its interface and parameters come from the first listed code whose
    other parts have these values.

    Raises:
        UnknownOrderCode: The parts cannot be combined.
    """
    # The value of each part as listed, or None if the manual does not list it.
    listed_values = {part.name: _listed_value(part, value_by_part[part.name]) for part in device.order_code.parts}
    variant = _fitting_variant(device, listed_values)
    if variant is None:
        message = _clash_message(device, label, value_by_part, listed_values)
        raise UnknownOrderCode(message, names_mistake=True)
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
    """Return the listed value of an order code part that equals a text regardless of case, or None."""
    for value in part.values:
        if value.text.upper() == text.upper():
            return value.text
    return None


def _fitting_variant(device: Device, listed_values: Mapping[str, str | None]) -> Variant | None:
    """Return the first listed order code with these values of its parts, or None if there is none.

    In ``listed_values``, None is a value that the manual does not list. It matches any listed code, provided that the
    part can have an unlisted value next to the values of the other parts.
    """
    for part in device.order_code.parts:
        if listed_values[part.name] is None and not _can_be_unlisted(part, listed_values):
            return None
    for variant in device.variants:
        if all(value in (None, variant.parts[name]) for name, value in listed_values.items()):
            return variant
    return None


def _can_be_unlisted(part: CodePart, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether an order code part can have an unlisted value next to these values of the other parts.

    ``open_only_with`` lists, for some other parts, the values next to which an unlisted value is possible. Another part
    that is itself unlisted (None) does not restrict this part.
    """
    for name, allowed_values in part.open_only_with.items():
        other_value = listed_values[name]
        if other_value is not None and other_value not in allowed_values:
            return False
    return True


def _clash_message(
    device: Device, label: str, value_by_part: Mapping[str, str], listed_values: Mapping[str, str | None]
) -> str:
    """Return the message for parts of a label that are valid individually but not in combination.

    It names each part that could be corrected alone: with a different value of this part, the code would exist.
    """
    clashing_parts: list[str] = []
    for part in device.order_code.parts:
        if _fits_if_changed(device, part, listed_values):
            value = listed_values[part.name] or value_by_part[part.name]
            clashing_parts.append(f"{part.name} '{value}'")
    parts_text = " and ".join(clashing_parts) or "its parts"
    return cannot_be_combined(code=label, parts=parts_text, nearest=_nearest_codes_text(device, label))


def _fits_if_changed(device: Device, part: CodePart, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether an order code exists with a different value of ``part`` and these values of the other parts."""
    return any(_fitting_variant(device, {**listed_values, part.name: value.text}) for value in part.values)


class _WrongPart(NamedTuple):
    """A part of an order code that may be wrong in a label.

    The smallest tuple is the likeliest mistake: the fewest other parts are unlisted, and, if several mistakes have the
    same number, the part is missing.
    """

    unlisted_others: int
    is_present: bool
    position: int
    text: str


def _unknown_code_error(device: Device, label: str) -> UnknownOrderCode:
    """Return the error for a label that matches no order code of the family, with the nearest codes.

    If a single missing or wrong part explains it, the error names this part and its valid values.
    """
    nearest = _nearest_codes_text(device, label)
    candidates = list(_possible_wrong_parts(device, label))
    if not candidates:
        message = not_of_family(code=label, family=device.name.upper(), nearest=nearest)
        return UnknownOrderCode(message, names_mistake=False)
    likeliest_wrong_part = min(candidates)  # ``_WrongPart`` is ordered by its members.
    part = device.order_code.parts[likeliest_wrong_part.position]
    valid_values = ", ".join(value.text for value in part.values)
    if part.open:
        valid_values += unlisted_values(part.open)
    problem = (
        has_part(part.name, likeliest_wrong_part.text) if likeliest_wrong_part.is_present else has_no_part(part.name)
    )
    message = wrong_part(code=label, problem=problem, valid=valid_values, nearest=nearest)
    return UnknownOrderCode(message, names_mistake=True)


def _possible_wrong_parts(device: Device, label: str) -> Iterator[_WrongPart]:
    """Yield each part of the order code that may be the only wrong part of a label.

    The label must match the family if any text is accepted for this part.
    """
    for position, part in enumerate(device.order_code.parts):
        code_pattern = expression_of_code(device.order_code, as_listed(device.order_code), anything=part.name)
        label_match = re.fullmatch(code_pattern + AFTER, label, re.IGNORECASE)
        if label_match is None or not _has_text_besides(label_match, part, label):
            continue
        other_parts = [other_part for other_part in device.order_code.parts if other_part is not part]
        listed_values = [_listed_value(other_part, label_match[other_part.name]) for other_part in other_parts]
        part_text = label_match[part.name]
        yield _WrongPart(
            unlisted_others=listed_values.count(None), is_present=part_text != "", position=position, text=part_text
        )


def _has_text_besides(label_match: re.Match[str], part: CodePart, label: str) -> bool:
    """Return whether a label contains letters or digits before or after a wrong part, apart from the tail.

    If it does not, the label does not resemble the family: codes that consist of one part, such as ``{model}``, match
    every label.
    """
    tail_length = len(label_match["tail_"] or "") + len(label_match["special_"] or "")
    text_before = label[: label_match.start(part.name)]
    end_of_code = len(label) - tail_length
    text_after = label[label_match.end(part.name) : end_of_code]
    return any(character.isalnum() for character in text_before + text_after)


def _nearest_codes_text(device: Device, label: str) -> str:
    """Return the order codes of a family that are most similar to a label, as a list in words: ``X-24, X-25``."""
    return ", ".join(nearest_codes([device], label))


def nearest_codes(devices: Sequence[Device], text: str, least: float = 0.0) -> list[str]:
    """Return at most three listed order codes that are similar to a text.

    Codes that begin with the text come first, and then the most similar ones.

    Args:
        devices: The families.
        text: Text that was meant as an order code.
        least: Minimum similarity, from 0 to 1.
    """
    from difflib import SequenceMatcher

    # A label may continue after the code with a hyphen and more text, so it is cut to as many hyphens as the code has.
    # Slashes count as hyphens, because people confuse them.
    text_with_hyphens = text.upper().replace("/", "-")
    pieces = text_with_hyphens.split("-")
    ranked_codes: list[tuple[bool, float, str]] = []
    for device in devices:
        for variant in device.variants:
            code_with_hyphens = variant.code.upper().replace("/", "-")
            piece_count = code_with_hyphens.count("-") + 1
            text_without_tail = "-".join(pieces[:piece_count])
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
    """Return the revision of the manual whose order codes are written like this label, or "" if it cannot be inferred.

    ``match.written_as_in`` is the place where codes are written like the label.
    """
    spellings = device.order_code.also_written
    patterns = {spelling.pattern for spelling in spellings if spelling.where == match.written_as_in}
    for edition in device.editions:
        if not patterns.isdisjoint(edition.labels):
            return edition.revision
    return ""


def edition_tests_of_register(device: Device, register: str) -> Iterator[tuple[str, EditionTest]]:
    """Yield the tests of a register that show which revision of the manual applies to an encoder.

    Each test comes with the first revision for which the register passes it.
    """
    for edition in device.editions:
        for test in edition.tests:
            if test.register == register:
                yield edition.revision, test


_LETTERS_AND_DIGITS = re.compile(r"[a-z0-9]+")


class _Reason(NamedTuple):
    """Why a label is not an order code of one family. The family with the most matching characters is the most similar.

    ``is_close`` is true if the label matches all but one part of the order code.
    """

    matching_characters: int
    is_close: bool
    message: str


def family_with_name(devices: Iterable[Device], text: str) -> Device | None:
    """Return the family with the name ``text``, such as ``xy24`` for ``X-Y 24``, or None."""
    label = _without_marks(text)
    for device in devices:
        if _name_without_marks(device) == label:
            return device
    return None


def closest_reason(devices: Sequence[Device], text: str) -> str | None:
    """Return why ``text`` is not an order code, as the message of the family that is most similar to it, or None.

    A family is similar if the text begins with its name, or matches all but one part of its order codes. The text must
    not be an order code of any of the families.
    """
    reasons = list(_reasons_of_similar_families(devices, text))
    if not reasons:
        return None
    best = max(reasons, key=lambda reason: (reason.matching_characters, reason.is_close))
    return best.message


def _reasons_of_similar_families(devices: Iterable[Device], text: str) -> Iterator[_Reason]:
    """Yield why a text is not an order code, for each family that it names or almost matches."""
    label = _without_marks(text)
    for device in devices:
        name = _name_without_marks(device)
        length_of_name = len(name) if label.startswith(name) else 0
        try:
            find_code(device, text)
        except UnknownOrderCode as error:
            if error.names_mistake or length_of_name:
                matching_length = max(length_of_name, _length_before_parts(device))
                yield _Reason(matching_characters=matching_length, is_close=error.names_mistake, message=str(error))


def _without_marks(text: str) -> str:
    """Return only the letters and digits of a text, in lowercase: ``xy24`` for ``X-Y24``."""
    return "".join(_LETTERS_AND_DIGITS.findall(without_blanks(text).lower()))


def _name_without_marks(device: Device) -> str:
    return device.name.replace("_", "")


def _length_before_parts(device: Device) -> int:
    """Return the number of letters and digits with which all order codes begin: 2 for the pattern ``X-Y-{bits}``."""
    text_before_parts, _, _ = device.order_code.pattern.partition("{")
    return sum(map(str.isalnum, text_before_parts))
