"""Transcription mistakes in the values of a spec."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from codewheel.language.document import Document, Path
from codewheel.loading.spec_parts import parse_sources

from .names import other_names
from .places import PROSE, WORD, WORDED, Place, places
from .words import opposites


class Gone(Enum):
    """Marker for an omitted value."""

    GONE = "nothing"


#: A place and its new value.
Change = tuple[Path, Any]


@dataclass(frozen=True)
class Mutant:
    """A spec with one mistake: its place, its name, and the change."""

    file: str
    place: Place
    mistake: str
    changes: tuple[Change, ...]
    #: Class of the fact: the class of its place, or for a source the wrong part.
    fact: str
    #: The same changes in the second reading, if the mistake is in both files.
    changes_in_second: tuple[Change, ...] = ()

    @property
    def difference(self) -> str:
        """Return the mistake as one line of Markdown, as a diff of the files would show it."""
        return f"{_as_code(self.place.value)} -> {_as_code(self.changes[0][1])}"

    @property
    def is_left_out(self) -> bool:
        """Return whether a value is omitted rather than wrong."""
        return self.mistake in ("item omitted", "key omitted")


#: Digits that are easily confused in print and in handwriting.
_ALIKE = {
    "0": "86", "1": "7", "2": "7", "3": "8", "4": "9", "5": "63", "6": "85", "7": "1", "8": "3B", "9": "40",
    "A": "4", "B": "8", "C": "0", "D": "0", "E": "F", "F": "E",
}  # fmt: skip
_NUMBER = re.compile(r"0x[0-9A-Fa-f]+|[0-9]+(?:\.[0-9]+)*")
_IN_TEXT = re.compile(r"0x[0-9A-Fa-f]+|[0-9]+")
_WORD = re.compile(r"(?<![a-z0-9_^])[a-z][a-z0-9_]*|(?<=\^)[a-z][a-z0-9_]*")
#: Lists whose order matters. Each item can be exchanged with its neighbour.
_ORDERED = re.compile(r".*\b(fields|steps|digits|join\.NAME|writes|printed_writes)")
#: Keys whose text is hexadecimal without a prefix.
_HEX_TEXTS = frozenset(("bytes",))


def mutants(document: Document) -> Iterator[Mutant]:
    """Yield every possible single mistake in a document, in the order of the file."""
    for place in places(document):
        if place.is_text:
            for text in opposites(place.value):
                yield Mutant(document.file, place, "word turned round", ((place.path, text),), WORD)
        for mistake, changes in _mistakes(place, document):
            fact = _wrong_in_source(place.value, changes[0][1], document) if place.fact == "source" else place.fact
            yield Mutant(document.file, place, mistake, changes, fact)


def _wrong_in_source(old: str, new: str, document: Document) -> str:
    """Return the wrong part of a source, and for a page whether the contents of the manual can tell."""
    pairs = zip(parse_sources(old), parse_sources(new), strict=True)
    before, after = next((before, after) for before, after in pairs if before != after)
    if before.document or after.document or "manual" not in document.data:
        return "place in another document"
    if before.section != after.section:
        return "cited section"
    row = document.data["manual"].get("contents", {}).get(before.section, {})
    return "cited page" if "page" in row or "entries" in row else "page without contents"


def in_both(mutants_of_spec: Iterable[Mutant], spec: Document, second: Document) -> Iterator[Mutant]:
    """Yield the mutants of a spec whose mistake a second reader can make too, with the changes in the second reading.

    Both files then have the same value under the same names. Words of texts are in one file alone.
    """
    second_places = {second.name_path(place.path): place for place in places(second)}
    for mutant in mutants_of_spec:
        changes = []
        for path, new in mutant.changes:
            place = second_places.get(spec.name_path(path))
            if place is not None and place.value == _value_at(spec.data, path):
                changes.append((place.path, new))
        if len(changes) == len(mutant.changes) and mutant.fact != WORD:
            yield replace(mutant, changes_in_second=tuple(changes))


def mutated(document: Document, changes: Iterable[Change]) -> dict[str, Any]:
    """Return the data of a document with the changes of a mistake. Unchanged parts are shared."""
    data = document.data
    for path, new in changes:
        data = _with_value(data, path, new)
    return data


def _with_value(node: Any, path: Path, new: Any) -> Any:
    step, remaining_path = path[0], path[1:]
    if isinstance(node, list):
        assert isinstance(step, int)
        if not remaining_path and new is Gone.GONE:
            return node[:step] + node[step + 1 :]
        return [
            *node[:step],
            new if not remaining_path else _with_value(node[step], remaining_path, new),
            *node[step + 1 :],
        ]
    if not remaining_path and new is Gone.GONE:
        return {key: value for key, value in node.items() if key != step}
    return {**node, step: new if not remaining_path else _with_value(node[step], remaining_path, new)}


def _mistakes(place: Place, document: Document) -> Iterator[tuple[str, tuple[Change, ...]]]:
    value, path = place.value, place.path
    in_prose = place.fact in PROSE or (place.fact in WORDED and not re.search("[0-9]", str(value)))
    if isinstance(value, dict):
        if place.keys == "order_code.parts.values":
            yield from _mistakes_in_labels(place)
    elif not isinstance(value, list):
        of_value = _mistakes_in_value(place, document)
        yield from ((mistake, ((path, new),)) for mistake, new in of_value if new != value)
        if not in_prose:
            yield from _exchange_with_next(place, document)
    if in_prose:
        return
    if isinstance(path[-1], int) or place.keys.endswith(".NAME"):
        yield "item omitted", ((path, Gone.GONE),)
    elif place.optional:
        yield "key omitted", ((path, Gone.GONE),)
    if isinstance(path[-1], int) and _ORDERED.fullmatch(place.keys):
        items, index = _value_at(document.data, path[:-1]), path[-1]
        if index + 1 < len(items):
            yield "items swapped", ((path, items[index + 1]), ((*path[:-1], index + 1), items[index]))


def _mistakes_in_value(place: Place, document: Document) -> Iterator[tuple[str, Any]]:
    value, schema = place.value, place.schema
    if isinstance(value, bool):
        yield "boolean flipped", not value
    elif isinstance(value, int) and value < 0:
        yield "sign lost", -value
        yield from ((mistake, -number) for mistake, number in _mistakes_in_number(-value, str(-value)))
    elif isinstance(value, int):
        yield from _mistakes_in_number(value, _number_as_written(place, document))
    elif isinstance(value, float):
        yield from ((mistake, float(text)) for mistake, text in _mistakes_in_text(str(value), bare=False))
    elif isinstance(value, str) and "enum" in schema:
        yield from (("different word", word) for word in schema["enum"])
    elif isinstance(value, str):
        names = list(other_names(place, document.data))
        yield from (("different name", name) for name in names)
        if place.kind == "name" and len(value) > 1:
            yield from (("letter lost", value[:at] + value[at + 1 :]) for at in {1, len(value) // 2, len(value) - 1})
        if place.kind != "name" and not names:
            yield from _mistakes_in_text(value, str(place.path[-1]) in _HEX_TEXTS)
            if place.kind == "expression":
                yield from _mistakes_in_expression(value, document.data.get("parameters", {}))


def _number_as_written(place: Place, document: Document) -> str:
    """Return a number as it is written in the file."""
    line, column = document.position(place.path)
    match = _NUMBER.match(document.line(line), column - 1)
    return match[0] if match is not None else str(place.value)


def _mistakes_in_number(value: int, written: str) -> Iterator[tuple[str, int]]:
    for mistake, text in _mistakes_in_digits(written):
        yield mistake, int(text, 16 if text.startswith("0x") else 10)
    yield from (("off by one", value + step) for step in (-1, 1) if value + step >= 0)
    yield from (("bit flipped", value ^ 1 << bit) for bit in range(max(value.bit_length(), 1)))


def _mistakes_in_digits(written: str, bare: bool = False) -> Iterator[tuple[str, str]]:
    """Yield mistakes in the digits of a number as written. A ``bare`` number is hexadecimal without a prefix."""
    start = 2 if written.startswith("0x") else 0
    hexadecimal, digits = bare or start > 0, written[start:]
    for index, digit in enumerate(digits):
        before, after = written[: start + index], digits[index + 1 :]
        if len(digits) > 1 and not bare:
            yield "digit lost", before + after
        if after and after[0] != digit:
            yield "digits swapped", before + after[0] + digit + after[1:]
        for misread_digit in _ALIKE.get(digit.upper(), ""):
            if hexadecimal or misread_digit.isdecimal():
                yield "digit misread", before + misread_digit + after
    if digits.endswith("0") and len(digits) > 1 and not bare:
        yield "extra zero", written + "0"


def _mistakes_in_text(text: str, bare: bool) -> Iterator[tuple[str, str]]:
    """Yield mistakes in each number of a text."""
    if set(text) <= {"0", "1"} and len(text) > 2:
        yield from (("bit flipped", text[:at] + str(1 - int(text[at])) + text[at + 1 :]) for at in range(len(text)))
    for match in (re.compile("[0-9A-Fa-f]+") if bare else _IN_TEXT).finditer(text):
        for mistake, digits in _mistakes_in_digits(match[0], bare):
            yield mistake, text[: match.start()] + digits + text[match.end() :]
        if not bare and not match[0].startswith("0x"):
            number = int(match[0])
            for neighbour in (number - 1, number + 1):
                if neighbour >= 0:
                    yield "off by one", f"{text[: match.start()]}{neighbour}{text[match.end() :]}"


def _mistakes_in_expression(text: str, parameters: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for match in _WORD.finditer(text):
        for name in parameters:
            if name != match[0]:
                yield "different name", text[: match.start()] + name + text[match.end() :]
    for index, sign in enumerate(text):
        if sign in "+-":
            yield "different word", text[:index] + {"+": "-", "-": "+"}[sign] + text[index + 1 :]


def _mistakes_in_labels(place: Place) -> Iterator[tuple[str, tuple[Change, ...]]]:
    """Yield mistakes in the texts of labels, which are keys."""
    for label in place.value:
        for mistake, text in _mistakes_in_label(label):
            if text and text not in place.value:
                values = {text if key == label else key: value for key, value in place.value.items()}
                yield mistake, ((place.path, values),)


def _mistakes_in_label(label: str) -> Iterator[tuple[str, str]]:
    for match in _IN_TEXT.finditer(label):
        for mistake, digits in _mistakes_in_digits(match[0]):
            yield mistake, label[: match.start()] + digits + label[match.end() :]


def _exchange_with_next(place: Place, document: Document) -> Iterator[tuple[str, tuple[Change, ...]]]:
    """Yield the exchange of this value and the next one, as if a reader had confused two rows of a table."""
    path = place.path
    for depth in (1, 2):
        if len(path) <= depth:
            return
        owner, step, remaining_path = path[: -depth - 1], path[-depth - 1], path[-depth:]
        siblings = _value_at(document.data, owner)
        following = _next_step(siblings, step, place)
        if following is None:
            continue
        neighbour = (*owner, following, *remaining_path)
        next_value = _value_at(document.data, neighbour)
        if next_value is not None and next_value != place.value and not isinstance(next_value, (dict, list)):
            yield "swapped with the next", ((path, next_value), (neighbour, place.value))
        return


def _next_step(siblings: Any, step: str | int, place: Place) -> str | int | None:
    """Return the step to the item after this one, in a list or in a map with free names."""
    if isinstance(siblings, list) and isinstance(step, int):
        return step + 1 if step + 1 < len(siblings) else None
    if isinstance(siblings, dict) and ".NAME." in f"{place.keys}.":
        keys: Sequence[Any] = list(siblings)
        at = keys.index(step) + 1
        return keys[at] if at < len(keys) else None
    return None


def _value_at(data: Any, path: Path) -> Any:
    for step in path:
        in_list = isinstance(data, list) and isinstance(step, int) and step < len(data)
        if not in_list and not (isinstance(data, dict) and step in data):
            return None
        data = data[step]
    return data


def _as_code(value: Any) -> str:
    if isinstance(value, Gone):
        return value.value
    text = " ".join(str(value).split())
    return code_span(text if len(text) <= 60 else f"{text[:57]}...")


def code_span(text: str) -> str:
    """Return a text as a Markdown code span. Its fence is longer than any run of backticks in the text."""
    fence = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    space = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{fence}{space}{text}{space}{fence}" if text else '`""`'
