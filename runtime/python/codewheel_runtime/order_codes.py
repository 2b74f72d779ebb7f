# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Order codes, as printed on the labels of encoders."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from .reports import ReadOnly

#: Highest number of characters in a label.
LONGEST = 100

_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_AFTER = "(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?"
_ALL_GO_WITH_IT: ReadOnly[tuple[str, ...]] = ReadOnly({})


class OrderCodeError(ValueError):
    """A label is not an order code.

    Attributes:
        label: The label.
        part: Name of the wrong part, if there is exactly one.
        reason: What is wrong.
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


class Label(NamedTuple):
    """Label split into its parts.

    ``listed`` contains the parts of the listed code used in place of the label. A value that the manual does not list
    is replaced by the first listed value that can be combined with the others. ``special`` is the ``/Sxxx`` suffix of
    the label. ``written_as_in`` is the document that uses the label's spelling, if it is not the usual one.
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
        note: Note on the order code.
        source: Section and page of the manual.
        also_written: Alternative spellings.
    """

    pattern: str
    parts: tuple[Part, ...]
    special: str = ""
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
        """
        text = checked(label)
        # A part of the code itself may look like /Sxxx, so only text after the code is treated as this ending.
        match = re.fullmatch(f"{self._expression()}{_AFTER}", text, re.IGNORECASE)
        if match is not None:
            return self._label(text, match, {part.name: match[part.name] for part in self.parts}, codes)
        for spelling in self.also_written:
            match = re.fullmatch(f"{self._expression_of(spelling)}{_AFTER}", text, re.IGNORECASE)
            if match is not None:
                listed = {(item.part, item.text.upper()): item.value for item in spelling.values}
                found = {
                    part.name: listed.get((part.name, match[part.name].upper()), match[part.name])
                    for part in self.parts
                }
                return self._label(text, match, found, codes)._replace(written_as_in=spelling.where)
        raise self._error(text, family, codes)

    def _label(
        self, text: str, match: re.Match[str], found: Mapping[str, str], codes: Mapping[str, tuple[str, ...]]
    ) -> Label:
        """Return the label with the parts ``found``."""
        known = {part.name: _listed(part, found[part.name]) for part in self.parts}
        unlisted = tuple(name for name, value in known.items() if value is None)
        shown = {name: found[name] if value is None else value for name, value in known.items()}
        listed = self._fitting(known, codes)
        if listed is None:
            raise self._clash(text, shown, known, codes)
        code = _BRACES.sub(lambda brace: shown[brace[1]], self.pattern)
        return Label(code, tuple(shown.values()), listed, unlisted, match["tail_"] or "", match["special_"] or "")

    def _fitting(self, known: Mapping[str, str | None], codes: Mapping[str, tuple[str, ...]]) -> tuple[str, ...] | None:
        """Return the parts of the first listed code with these values. None represents an unlisted value."""
        names = [part.name for part in self.parts]
        for values in codes.values():
            found = dict(zip(names, values, strict=False))
            if any(value not in (None, found[name]) for name, value in known.items()):
                continue
            open_parts = [part for part in self.parts if known[part.name] is None]
            if all(
                known[other] is None or known[other] in allowed
                for part in open_parts
                for other, allowed in part.open_only_with.items()
            ):
                return values
        return None

    def _clash(
        self,
        text: str,
        shown: Mapping[str, str],
        known: Mapping[str, str | None],
        codes: Mapping[str, tuple[str, ...]],
    ) -> OrderCodeError:
        """Return the error for valid parts that cannot be combined. It names the parts to change."""
        names = [
            part.name
            for part in self.parts
            if any(self._fitting({**known, part.name: value.text}, codes) for value in part.values)
        ]
        listed = " and ".join(f"{name} '{shown[name]}'" for name in names) or "its parts"
        part = names[0] if names else ""
        return OrderCodeError(text, part, f"has {listed}, which cannot be combined", nearest(codes, text))

    def _expression(self, any_for: str = "") -> str:
        """Return a regular expression for the whole code, with any text allowed for the part ``any_for``."""
        expressions = {part.name: "[A-Z0-9]*" if part.name == any_for else _alternatives(part) for part in self.parts}
        return _joined(self.pattern, expressions)

    def _expression_of(self, spelling: Spelling) -> str:
        """Return a regular expression for the whole code in another spelling."""
        expressions = {part.name: _alternatives(part) for part in self.parts}
        for name in {item.part for item in spelling.values}:
            expressions[name] = _any_of(item.text for item in spelling.values if item.part == name)
        then = f"(?:{spelling.then})" if spelling.then else ""
        return _joined(spelling.pattern, expressions) + then

    def _error(self, text: str, family: str, codes: Mapping[str, tuple[str, ...]]) -> OrderCodeError:
        found: list[tuple[int, Part, str]] = []
        for part in self.parts:
            match = re.fullmatch(f"{self._expression(part.name)}{_AFTER}", text, re.IGNORECASE)
            if match:
                others = [other for other in self.parts if other is not part]
                unlisted = sum(_listed(other, match[other.name]) is None for other in others)
                found.append((unlisted, part, match[part.name]))
        if found:
            # Blame the part whose removal leaves the fewest unlisted values, and among equals a missing part.
            _, part, given = min(found, key=lambda item: (item[0], item[2] != ""))
            wrong = f"has {part.name} '{given}'" if given else f"has no {part.name}"
            valid = ", ".join(value.text for value in part.values)
            return OrderCodeError(text, part.name, f"{wrong}; valid values: {valid}", nearest(codes, text))
        return OrderCodeError(text, "", f"is not an order code of {family}", nearest(codes, text))


def checked(label: str) -> str:
    """Return ``label`` in upper case, without spaces.

    Raises:
        OrderCodeError: ``label`` is longer than any label.
        TypeError: ``label`` is not a string.
    """
    if not isinstance(label, str):
        raise TypeError(f"the label must be a string such as the order code, got {type(label).__name__}")
    if len(label) > LONGEST:
        reason = f"is not an order code: it has {len(label)} characters, more than the {LONGEST} of any label"
        raise OrderCodeError(f"{label[:20]}...", "", reason, ())
    return _without_blanks(label).upper()


def nearest(codes: Iterable[str], text: str) -> tuple[str, ...]:
    """Return the three codes most similar to ``text``, or to the part of it before a tail."""
    from difflib import SequenceMatcher

    pieces = text.upper().split("-")

    def likeness(code: str) -> float:
        return SequenceMatcher(None, code, "-".join(pieces[: code.count("-") + 1])).ratio()

    return tuple(sorted(codes, key=likeness, reverse=True)[:3])


def _listed(part: Part, text: str) -> str | None:
    return next((value.text for value in part.values if value.text.upper() == text.upper()), None)


def _alternatives(part: Part) -> str:
    listed = _any_of(value.text for value in part.values)
    return f"{listed}|{part.open}" if part.open else listed


def _any_of(texts: Iterable[str]) -> str:
    return "|".join(re.escape(text) for text in sorted(texts, key=len, reverse=True))


def _joined(pattern: str, expressions: Mapping[str, str]) -> str:
    pieces = [
        f"(?P<{piece}>{expressions[piece]})" if index % 2 else re.escape(_without_blanks(piece))
        for index, piece in enumerate(_BRACES.split(pattern))
    ]
    return "".join(pieces)


def _without_blanks(text: str) -> str:
    """Return the text without spaces. Some codes are printed both with and without them."""
    return "".join(text.split())
