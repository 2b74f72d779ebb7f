"""Facts of a spec that cite its manual, with the words by which a text of the manual may print them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any

from ..language.document import Document, Path
from ..loading.from_mapping import parse_sources
from ..model import Sources
from .passages import Passage
from .sections import COVER, WORD, plain

#: Keys that hold no fact of their own.
_NO_FACTS = frozenset({"source", "name", "erratum", "affects"})
#: Keys of the words that a manual prints next to a value.
_LABELS = ("name", "printed_name", "title", "symbol", "contact", "signal")
#: Letters of a value shown with its fact.
_SHOWN_LETTERS = 60
#: Words that manuals print for values of the spec language.
_SHORT = {"read_only": ("ro", "r"), "read_write": ("rw",), "write_only": ("wo", "w")}
#: The path of a fact about an option of the order code.
_OPTION = re.compile(r"order_code\.parts\.[^.]+\.values\.([^.]+)(?:\..*)?")
#: Paths of the facts about the edition itself. Manuals print them with a date.
_EDITION = ("manual.revision", "manual.date", "manual.history")
_REVISION = re.compile(r"\d+(?:\.\d+)+")
_DATE = re.compile(r"\d{1,2}[./-]\d{1,2}[./-]\d{4}|\d{4}-\d\d-\d\d")
#: An order code that ends in a number, such as the resolution.
ORDER_CODE = re.compile(r"[a-z]{2}\w*?(\d\d)")


@dataclass(frozen=True)
class Citing:
    """A fact that cites the manual: its place in the spec, its value, and the sections and pages that it cites.

    ``spelling`` is a number as spelled in the spec, ``item`` the path of the part of the spec that has the fact, and
    ``refers_to`` are the paths or names of the parts to which that item refers.
    """

    file: str
    line: int
    path: str
    value: object
    sections: frozenset[str]
    pages: frozenset[int]
    names: tuple[str, ...]
    spelling: str = ""
    item: str = ""
    refers_to: frozenset[str] = frozenset()

    @property
    def shown(self) -> str:
        text = self.spelling or " ".join(str(self.value).split())
        if len(text) > _SHOWN_LETTERS:
            text = text[: _SHOWN_LETTERS - 3] + "..."
        return f"{_relative_path(self.file)}:{self.line}: {self.path}: {text}"

    @property
    def is_of_edition(self) -> bool:
        """True for the revision, the date and the history of the manual."""
        return self.path.startswith(_EDITION)

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of the value as a manual may print them."""
        printed_words = frozenset(_printed_words(self.value))
        if self.path.endswith(".poly"):
            printed_words |= _with_top_bit(self.value)
        return printed_words

    @cached_property
    def text(self) -> str:
        """The words of the value in order, with spaces between them and around them. Empty for a number."""
        return "" if isinstance(self.value, int) else spaced(str(self.value))

    @cached_property
    def own_name_text(self) -> str:
        """The words of the last of its names in order, as in ``text``."""
        return spaced(self.names[-1]) if self.names else ""

    @property
    def is_page_of_contents(self) -> bool:
        """True for a page of an entry of the contents, which changes with the layout of a manual."""
        return isinstance(self.value, int) and self.path.startswith("manual.contents.")

    @cached_property
    def named(self) -> frozenset[str]:
        """The words of its name and of the names above it."""
        return frozenset(word for name in self.names for word in WORD.findall(name.replace("_", " ").casefold()))

    @cached_property
    def own_name(self) -> frozenset[str]:
        """The words of the last of its names."""
        return frozenset(word.casefold() for name in self.names[-1:] for word in WORD.findall(name.replace("_", " ")))

    def is_at(self, sections: Collection[str], passage: Passage) -> bool:
        """Return whether it cites one of the sections, or is an option of the order code that the passage names.

        Manuals print order codes in many sections, and in headings. A spec cites few of them.
        """
        if self.is_of_edition:
            is_revision_on_cover = passage.section.number == COVER and not self.words.isdisjoint(passage.old)
            has_date = any(map(_DATE.fullmatch, (*passage.old, *passage.new)))
            return is_revision_on_cover or has_date or self._is_above_new_row_of_history(passage)
        return not self.sections.isdisjoint(sections) or self._is_option_named_in(passage)

    def _is_above_new_row_of_history(self, passage: Passage) -> bool:
        """Return whether a passage adds a row with another revision below the row of this one."""
        is_new_row = not passage.old and any(map(_REVISION.fullmatch, passage.new[:1]))
        return is_new_row and self.path != "manual.date" and not self.words.isdisjoint(passage.close)

    def _is_option_named_in(self, passage: Passage) -> bool:
        option = _OPTION.fullmatch(self.path)
        if option is None:
            return False
        label = option[1].casefold()
        # A row with a new order code is next to rows of others.
        adds_order_code = not passage.old and bool(_last_digits(word.casefold() for word in passage.new))
        words = {word.casefold() for word in (passage.close if adds_order_code else passage.old)}
        # Labels of digits are often printed only at the end of an order code.
        return (_is_order_code_label(label) and label in words) or (label.isdigit() and label in _last_digits(words))


def spaced(text: str) -> str:
    """Return the words of a text or of an identifier, with spaces between them and around them."""
    return f" {' '.join(WORD.findall(plain(text).replace('_', ' ').casefold()))} "


def _is_order_code_label(text: str) -> bool:
    """Return whether a text can only be a label of an order code. A, TO or 21 can be any word."""
    if text.isdigit():
        return len(text) > 3
    return len(text) > 2 or any(letter.isdigit() for letter in text)


def _last_digits(words: Iterable[str]) -> set[str]:
    """Return the two digits at the end of each order code among words."""
    order_codes = [ORDER_CODE.fullmatch(word) for word in words]
    return {order_code[1] for order_code in order_codes if order_code is not None}


def _relative_path(file: str) -> str:
    """Return a path relative to the current folder if it is below it."""
    with suppress(ValueError):
        return FilePath(file).relative_to(FilePath.cwd()).as_posix()
    return file


def _printed_words(value: object) -> Iterator[str]:
    """Yield the words of a value. A number can be printed in hexadecimal, with separators, or in a larger unit."""
    if isinstance(value, bool) or value is None:
        return
    if not isinstance(value, int):
        yield from (word.casefold() for word in WORD.findall(plain(str(value))))
        yield from _SHORT.get(str(value), ())
        return
    with_commas = f"{value:,}"
    yield from (with_commas, with_commas.replace(",", "."))
    yield f"{value:g}"
    for scale in (1000, 1_000_000):
        # 100 can be printed as 0.1 of the larger unit.
        if value >= scale // 10:
            yield f"{value / scale:g}"
    yield from (str(value), f"{value / 10:.1f}")
    yield from (f"{value:x}", f"{value:02x}", f"{value:x}h", f"{value:02x}h", f"0x{value:x}", f"0x{value:02x}")


def _with_top_bit(poly: object) -> frozenset[str]:
    """Return a polynomial as manuals print it with its top bit, in hexadecimal or binary, for any width."""
    if not isinstance(poly, int):
        return frozenset()
    numbers = [poly | 1 << width for width in range(max(poly.bit_length(), 3), 33)]
    texts: set[str] = set()
    for number in numbers:
        texts |= {f"{number:x}", f"{number:x}h", f"0x{number:x}", f"{number:b}"}
    return frozenset(texts)


#: Keys whose values are the names of other parts of the spec, or paths to them.
_REFERENCES = ("register", "crc", "field", "alarm", "procedure", "affects", "order_code", "erratum", "layout")
#: Keys of maps whose values are parts of the spec themselves.
_MAPS_OF_ITEMS = ("values", "contents")


@dataclass(frozen=True)
class _Surroundings:
    """The parts of a spec around a fact: the nearest one with its path, and the names, source and references."""

    item: Path = ()
    source: Sources = ()
    names: tuple[str, ...] = ()
    refers_to: frozenset[str] = frozenset()


def citing(document: Document) -> list[Citing]:
    """Return the facts of a spec with what they cite. A fact without a source has the source of the item around it."""
    return list(_sourced_items(document, document.data, (), _Surroundings()))


def _cited(source: str) -> Sources:
    """Return the places that a source cites, without the mark of the template of ``codewheel new``."""
    return parse_sources(source.replace("TODO ", ""))


def _sourced_items(document: Document, data: Any, path: Path, around: _Surroundings) -> Iterator[Citing]:
    """Yield the facts in part of a spec, with what they have from the items around it."""
    if isinstance(data, dict):
        around = _surroundings_in(data, path, around)
        for key, member in data.items():
            if key in _NO_FACTS or str(key).endswith("_source"):
                continue
            member_source = data.get(f"{key}_source")
            source = _cited(member_source) if isinstance(member_source, str) else around.source
            if path[:2] == ("manual", "contents") and not source:
                source = _cited(str(path[2] if len(path) > 2 else key))
            inner = replace(around, source=source, names=(*around.names, str(key)))
            yield from _sourced_items(document, member, (*path, key), inner)
    elif isinstance(data, list):
        for index, member in enumerate(data):
            # A row of a table is an item without a name.
            inner = replace(around, item=(*path, index)) if isinstance(member, list) else around
            yield from _sourced_items(document, member, (*path, index), inner)
    elif around.source or path[:1] == ("manual",):
        yield _fact(document, data, path, around)


def _surroundings_in(data: Mapping[str, Any], path: Path, around: _Surroundings) -> _Surroundings:
    """Return what the facts in a map have from it and from the items around it."""
    is_item = bool(path) and (isinstance(path[-1], int) or "source" in data or path[-2:-1] in _PATHS_OF_ITEMS)
    item = path if is_item else around.item
    source = _cited(data["source"]) if isinstance(data.get("source"), str) else around.source
    references = frozenset(_referenced(data))
    refers_to = references if is_item and references else around.refers_to | references
    return _Surroundings(item, source, (*around.names, *_labels(data)), refers_to)


_PATHS_OF_ITEMS = tuple((key,) for key in _MAPS_OF_ITEMS)


def _referenced(data: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names and paths of the parts to which a map refers."""
    for key in _REFERENCES:
        value = data.get(key)
        texts = value if isinstance(value, list) else [value]
        yield from (text for text in texts if isinstance(text, str))


def _fact(document: Document, value: object, path: Path, around: _Surroundings) -> Citing:
    in_manual = [citation for citation in around.source if not citation.document]
    return Citing(
        file=document.file,
        line=document.position(path)[0],
        path=document.name_path(path),
        value=value,
        sections=frozenset(citation.section for citation in in_manual if citation.section),
        pages=frozenset(citation.page for citation in in_manual if citation.page is not None),
        names=around.names,
        spelling=_spelling(document, value, path),
        item=document.name_path(around.item),
        refers_to=around.refers_to,
    )


def _spelling(document: Document, value: object, path: Path) -> str:
    """Return a number or a truth value as in the spec, or an empty text for another value."""
    if isinstance(value, bool):
        return str(value).lower()
    return document.spelling_at(path) if isinstance(value, int) else ""


def _labels(item: Mapping[str, Any]) -> list[str]:
    """Return the names of an item of a spec, as printed and in other languages."""
    labels = [item.get(key) for key in _LABELS]
    names_by_language = item.get("names")
    if isinstance(names_by_language, dict):
        labels += names_by_language.values()
    return [label for label in labels if isinstance(label, str)]
