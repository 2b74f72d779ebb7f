# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Order codes, as printed on the labels of encoders."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from .reports import ReadOnly

#: Highest number of characters in a label.
LONGEST = 100
#: Maximum number of characters of a text that the error prints.
_PRINTED_CHARACTERS = 20

#: Name of a part in a pattern, such as ``{bits}``.
_PART_IN_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
#: Text that may follow a code: a tail after ``-``, and a suffix ``/Sxxx``.
_TEXT_AFTER_CODE = "(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?"
_ALL_GO_WITH_IT: ReadOnly[tuple[str, ...]] = ReadOnly({})


class OrderCodeError(ValueError):
    """A label is not an order code.

    Attributes:
        label: The label.
        part: Name of the wrong part. The first of several parts that cannot be combined, or empty if it is unknown.
        reason: Description of the error.
        nearest: Order codes most similar to the label.
    """

    def __init__(self, label: str, part: str, reason: str, nearest: tuple[str, ...]) -> None:
        super().__init__(label, part, reason, nearest)
        self.label = label
        self.part = part
        self.reason = reason
        self.nearest = nearest

    def __str__(self) -> str:
        nearest = f"; similar order codes: {', '.join(self.nearest)}" if self.nearest else ""
        return f"'{self.label}' {self.reason}{nearest}"


class PartValue(NamedTuple):
    """Value of a part of the order code."""

    text: str
    meaning: str = ""
    source: str = ""


class Part(NamedTuple):
    """Part of the order code.

    Attributes:
        name: Name of the part.
        meaning: Meaning of the part.
        values: Listed values.
        open: Regular expression for values that the manual does not list.
        open_only_with: Values of other parts that can be combined with unlisted values, by part. Empty if all can.
        source: Section and page of the manual.
    """

    name: str
    meaning: str
    values: tuple[PartValue, ...]
    open: str = ""
    open_only_with: Mapping[str, tuple[str, ...]] = _ALL_GO_WITH_IT
    source: str = ""


class SpelledValue(NamedTuple):
    """Text in an alternative spelling, and the listed value that it represents."""

    part: str
    text: str
    value: str


class Spelling(NamedTuple):
    """Alternative spelling of an order code.

    Attributes:
        pattern: The spelling, with the names of the parts in braces.
        where: Document that uses the spelling.
        values: Allowed texts of the parts that are spelled differently.
        then: Regular expression for text that follows and is ignored.
        source: Section and page.
    """

    pattern: str
    where: str
    values: tuple[SpelledValue, ...] = ()
    then: str = ""
    source: str = ""

    def listed_text(self, part: str, text: str) -> str:
        """Return the text of a part in the usual spelling.

        Text without an alternative spelling is returned unchanged.
        """
        for spelled in self.values:
            if spelled.part == part and spelled.text.upper() == text.upper():
                return spelled.value
        return text


class Label(NamedTuple):
    """Label split into its parts.

    ``code`` and ``parts`` describe the label in the usual spelling. ``listed`` contains the parts of the listed code
    used in place of the label. A value that the manual does not list is replaced by the first listed value that can be
    combined with the others. ``unlisted`` are the names of these parts. ``tail`` is the text after the code,
    starting with ``-``, and ``special`` is the ``/Sxxx`` suffix of the label. ``written_as_in`` is the document that
    uses the label's spelling, if it is not the usual spelling.
    """

    code: str
    parts: tuple[str, ...]
    listed: tuple[str, ...]
    unlisted: tuple[str, ...]
    tail: str
    special: str
    written_as_in: str = ""


class OrderCode(NamedTuple):
    """Structure of an order code.

    Attributes:
        pattern: The order code, with the names of the parts in braces.
        parts: The parts.
        special: Meaning of the ``/Sxxx`` suffix.
        not_on_label: For made-up order codes: what the label shows instead, and what the code stands for.
        note: Note on the order code.
        source: Section and page of the manual.
        also_written: Alternative spellings.
    """

    pattern: str
    parts: tuple[Part, ...]
    special: str = ""
    not_on_label: str = ""
    note: str = ""
    source: str = ""
    also_written: tuple[Spelling, ...] = ()

    def read(self, label: str, family: str, codes: Mapping[str, tuple[str, ...]]) -> Label:
        """Return the label split into its parts.

        Case and spaces are ignored. A tail after ``-`` and a suffix ``/Sxxx`` are accepted.

        Args:
            label: The text on the label.
            family: Name of the family, for the error.
            codes: Listed order codes with their parts.

        Raises:
            OrderCodeError: The label is not an order code of the family.
            TypeError: ``label`` is not a string.
        """
        text = check_label(label)
        match = _match_label(text, self._make_expression())
        if match is not None:
            part_texts = {part.name: match[part.name] for part in self.parts}
            return self._make_label(text, match, part_texts, codes)
        for spelling in self.also_written:
            match = _match_label(text, self._make_spelling_expression(spelling))
            if match is not None:
                # The parts are converted to the usual spelling.
                part_texts = {part.name: spelling.listed_text(part.name, match[part.name]) for part in self.parts}
                split_label = self._make_label(text, match, part_texts, codes)
                document_with_spelling = spelling.where
                return split_label._replace(written_as_in=document_with_spelling)
        raise self._unknown_code_error(text, family, codes)

    def _make_label(
        self, text: str, match: re.Match[str], part_texts: Mapping[str, str], codes: Mapping[str, tuple[str, ...]]
    ) -> Label:
        """Return the label ``text`` split into parts.

        Args:
            text: The label.
            match: Match of the regular expression for the code, which has the tail and the suffix of the label.
            part_texts: Text of each part of the label in the usual spelling, by name.
            codes: Listed order codes with their parts.

        Raises:
            OrderCodeError: No listed code has this combination of values.
        """
        # The value is None if the manual does not list it.
        listed_values = {part.name: _find_listed(part, part_texts[part.name]) for part in self.parts}
        unlisted = tuple(name for name, value in listed_values.items() if value is None)
        # Listed values are written as in the manual, unlisted ones as on the label.
        values = {name: value or part_texts[name] for name, value in listed_values.items()}
        fitting_code = self._find_fitting_code(listed_values, codes)
        if fitting_code is None:
            raise self._cannot_be_combined_error(text, values, listed_values, codes)
        return Label(
            # Each part name in braces is replaced by the value of that part.
            code=_PART_IN_BRACES.sub(lambda braces: values[braces[1]], self.pattern),
            parts=tuple(values.values()),
            listed=fitting_code,
            unlisted=unlisted,
            tail=match["tail_"] or "",
            special=match["special_"] or "",
        )

    def _find_fitting_code(
        self, listed_values: Mapping[str, str | None], codes: Mapping[str, tuple[str, ...]]
    ) -> tuple[str, ...] | None:
        """Return the parts of the first listed code with these values, or None if there is no such code.

        None means that the manual does not list the value. Every listed code matches such a value, if the value can
        be combined with the values of the other parts.
        """
        unlisted_parts = [part for part in self.parts if listed_values[part.name] is None]
        can_be_combined = all(_can_be_combined(part, listed_values) for part in unlisted_parts)
        if not can_be_combined:
            return None
        part_names = [part.name for part in self.parts]
        for code_parts in codes.values():
            code_values = dict(zip(part_names, code_parts, strict=False))
            if all(value in (None, code_values[name]) for name, value in listed_values.items()):
                return code_parts
        return None

    def _cannot_be_combined_error(
        self,
        text: str,
        part_texts: Mapping[str, str],
        listed_values: Mapping[str, str | None],
        codes: Mapping[str, tuple[str, ...]],
    ) -> OrderCodeError:
        """Return the error for a label whose parts are all valid, but cannot be combined.

        It names each part that would be valid with another listed value, or "its parts" if there is no such part.
        ``part_texts`` contains the text of each part of the label ``text``, and ``listed_values`` contains its listed
        value, or None.
        """
        wrong_part_names: list[str] = []
        for part in self.parts:
            changed_combinations = ({**listed_values, part.name: value.text} for value in part.values)
            if any(self._find_fitting_code(changed_combination, codes) for changed_combination in changed_combinations):
                wrong_part_names.append(part.name)
        parts_text = " and ".join(f"{name} '{part_texts[name]}'" for name in wrong_part_names) or "its parts"
        first_name = wrong_part_names[0] if wrong_part_names else ""
        reason = f"has {parts_text}, which cannot be combined"
        return OrderCodeError(text, first_name, reason, find_nearest(codes, text))

    def _make_expression(self, free_part: str = "") -> str:
        """Return a regular expression for the whole order code, with a named group for each part.

        The part with the name ``free_part`` may consist of any letters and digits, or be empty.
        """
        expressions = {part.name: _match_values(part) for part in self.parts}
        if free_part:
            expressions[free_part] = "[A-Z0-9]*"
        return _join_pattern(self.pattern, expressions)

    def _make_spelling_expression(self, spelling: Spelling) -> str:
        """Return a regular expression for the whole order code in another spelling, with a named group for each part.

        Parts without an alternative spelling are the same as in the usual spelling.
        """
        expressions = {part.name: _match_values(part) for part in self.parts}
        for name in {spelled.part for spelled in spelling.values}:
            expressions[name] = _match_any(spelled.text for spelled in spelling.values if spelled.part == name)
        ignored_text = f"(?:{spelling.then})" if spelling.then else ""
        return _join_pattern(spelling.pattern, expressions) + ignored_text

    def _unknown_code_error(self, text: str, family: str, codes: Mapping[str, tuple[str, ...]]) -> OrderCodeError:
        """Return the error for a text that is not an order code.

        The message names the wrong part if the text would be an order code with other letters and digits in that part.
        """
        nearest_codes = find_nearest(codes, text)
        candidates = list(self._find_wrong_parts(text))
        if not candidates:
            return OrderCodeError(text, "", f"is not an order code of {family}", nearest_codes)
        # The wrong part is the one that leaves the fewest unlisted values in the other parts. Of several, a missing
        # part comes first.
        part, part_text, _ = min(candidates, key=lambda candidate: (candidate.unlisted_count, candidate.text != ""))
        problem = f"has {part.name} '{part_text}'" if part_text else f"has no {part.name}"
        valid_values = ", ".join(value.text for value in part.values)
        if part.open:
            valid_values += f", and others of the form {part.open}"
        return OrderCodeError(text, part.name, f"{problem}; valid values: {valid_values}", nearest_codes)

    def _find_wrong_parts(self, text: str) -> Iterator[_WrongPart]:
        """Yield each part whose letters and digits, if they were others, could make a text an order code."""
        for part in self.parts:
            match = _match_label(text, self._make_expression(free_part=part.name))
            if match is None:
                continue
            other_parts = [other_part for other_part in self.parts if other_part is not part]
            unlisted_parts = [other for other in other_parts if _find_listed(other, match[other.name]) is None]
            yield _WrongPart(part, match[part.name], unlisted_count=len(unlisted_parts))


class _WrongPart(NamedTuple):
    """Part of a label that may be wrong.

    Attributes:
        part: The part.
        text: Its text in the label. Empty if it is missing.
        unlisted_count: Number of other parts whose values are not listed.
    """

    part: Part
    text: str
    unlisted_count: int


def check_label(label: str) -> str:
    """Return ``label`` in upper case, without spaces.

    Raises:
        OrderCodeError: ``label`` is longer than any label.
        TypeError: ``label`` is not a string.
    """
    if not isinstance(label, str):
        raise TypeError(f"the label must be a string such as the order code, got {type(label).__name__}")
    if len(label) > LONGEST:
        reason = f"is not an order code: it has {len(label)} characters, more than the {LONGEST} of any label"
        raise OrderCodeError(f"{label[:_PRINTED_CHARACTERS]}...", "", reason, ())
    return _remove_blanks(label).upper()


def find_nearest(codes: Iterable[str], text: str) -> tuple[str, ...]:
    """Return at most three codes: first those that begin with ``text``, then the most similar ones.

    The tail of the text is ignored: ``X-24-TAIL`` is compared with the code ``X-25`` as ``X-24``, because the code has
    two pieces between hyphens.
    """
    upper_text = text.upper()
    most_similar_first = sorted(codes, key=lambda code: _measure_similarity(code.upper(), upper_text), reverse=True)
    return tuple(most_similar_first[:3])


def _measure_similarity(code: str, text: str) -> tuple[bool, float]:
    """Return whether a code begins with a text, and the similarity (0 to 1) of the code and the text without its tail.

    The text is compared up to the number of hyphens in the code.
    """
    from difflib import SequenceMatcher

    piece_count = code.count("-") + 1
    text_without_tail = "-".join(text.split("-")[:piece_count])
    similarity = SequenceMatcher(None, code, text_without_tail).ratio()
    return code.startswith(text), similarity


def _match_label(text: str, code_expression: str) -> re.Match[str] | None:
    """Return the match of a label that consists of a code, a tail and a suffix ``/Sxxx``, or None for other text.

    The tail and the suffix can be missing. A part of the code can look like the suffix, so the code is matched first.
    """
    return re.fullmatch(f"{code_expression}{_TEXT_AFTER_CODE}", text, re.IGNORECASE)


def _can_be_combined(part: Part, listed_values: Mapping[str, str | None]) -> bool:
    """Return whether an unlisted value of a part can be combined with the values of the other parts.

    ``listed_values`` contains the listed value of each part by name, or None for an unlisted value, which can always be
    combined.
    """
    for name, allowed_values in part.open_only_with.items():
        value = listed_values[name]
        if value is not None and value not in allowed_values:
            return False
    return True


def _find_listed(part: Part, text: str) -> str | None:
    """Return the listed value of a part that equals a text, regardless of case, or None if there is no such value."""
    return next((value.text for value in part.values if value.text.upper() == text.upper()), None)


def _match_values(part: Part) -> str:
    """Return a regular expression for the listed values of a part, and for other values if the manual allows them."""
    listed_expression = _match_any(value.text for value in part.values)
    return f"{listed_expression}|{part.open}" if part.open else listed_expression


def _match_any(texts: Iterable[str]) -> str:
    """Return a regular expression for any of these texts, longest first."""
    return "|".join(re.escape(text) for text in sorted(texts, key=len, reverse=True))


def _join_pattern(pattern: str, expressions: Mapping[str, str]) -> str:
    """Return the pattern of an order code as a regular expression, with a named group for each part.

    The pattern ``X-{bits}`` becomes ``X\\-(?P<bits>12|16)``. ``expressions`` contains the regular expression of each
    part.
    """
    # Every second piece is the name of a part: ["X-", "bits", ""] for X-{bits}. The others are text.
    pieces = _PART_IN_BRACES.split(pattern)
    pieces[::2] = [re.escape(_remove_blanks(text)) for text in pieces[::2]]
    pieces[1::2] = [f"(?P<{name}>{expressions[name]})" for name in pieces[1::2]]
    return "".join(pieces)


def _remove_blanks(text: str) -> str:
    """Return the text without spaces. Some codes are printed both with and without them."""
    return "".join(text.split())
