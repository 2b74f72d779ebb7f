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
from ..loading.spec_parts import parse_sources
from ..model import Sources
from .passages import Passage
from .sections import COVER, WORD, plain_line

#: Keys whose values are not facts of the manual: sources, names, and our assessment of an erratum.
_KEYS_WITHOUT_FACTS = frozenset({"source", "name", "erratum", "affects", "severity", "status"})
#: Words that manuals use for these keys, whose own words they never use.
_PRINTED_FOR_KEY = {"init": "start value", "poly": "polynomial", "xorout": "inverted output"}
#: Keys with the words that a manual prints next to a value.
_KEYS_OF_LABELS = ("name", "printed_name", "title", "symbol", "contact", "signal")
#: Most characters of a value that are shown with its fact.
_SHOWN_LETTERS = 60
#: Words that manuals use for values of the spec language.
_PRINTED_FOR_VALUE = {
    "read_only": ("ro", "r"),
    "read_write": ("rw",),
    "write_only": ("wo", "w"),
}
#: Words that manuals use for the byte order, which every number of several bytes has.
_PRINTED_FOR_BYTE_ORDER = {
    "low_byte_first": ("low", "first", "lsb", "msb"),
    "high_byte_first": ("high", "first", "msb", "lsb"),
}
#: A hexadecimal number in a text, such as ``fa0h``. A manual may print it without the ``h``.
HEXADECIMAL = re.compile(r"[0-9a-f]{2,}h")
#: The path of a fact about an option of the order code.
_PATH_OF_OPTION = re.compile(r"order_code\.parts\.[^.]+\.values\.([^.]+)(?:\..*)?")
#: Paths of the facts about the edition itself. Manuals print them with a date.
_PATHS_OF_EDITION = ("manual.revision", "manual.date", "manual.history")
_REVISION_NUMBER = re.compile(r"\d+(?:\.\d+)+")
_PRINTED_DATE = re.compile(r"\d{1,2}[./-]\d{1,2}[./-]\d{4}|\d{4}-\d\d-\d\d")
#: An order code that ends in a number, such as the resolution.
ORDER_CODE = re.compile(r"[a-z]{2}\w*?(?P<number>\d\d)")


@dataclass(frozen=True)
class CitingFact:
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
    def summary(self) -> str:
        """The fact in one line, with its value shortened: ``specs/x24.yaml:12: clock.max_hz: 4_000_000``."""
        value_text = self.spelling or " ".join(str(self.value).split())
        if len(value_text) > _SHOWN_LETTERS:
            value_text = value_text[: _SHOWN_LETTERS - len("...")] + "..."
        return f"{_relative_path(self.file)}:{self.line}: {self.path}: {value_text}"

    @property
    def is_of_edition(self) -> bool:
        """True for the revision, the date and the history of the manual."""
        return self.path.startswith(_PATHS_OF_EDITION)

    @cached_property
    def value_words(self) -> frozenset[str]:
        """The words that a manual may print for the value, such as ``4,000`` or ``fa0h`` for 4000."""
        printed_words = frozenset(_printed_words(self.value))
        if self.path.endswith(".poly"):
            printed_words |= _with_top_bit(self.value)
        return printed_words

    @cached_property
    def text(self) -> str:
        """The words of the value, with spaces around and between them: `` not used ``. Empty for a number."""
        return "" if isinstance(self.value, int) else spaced(str(self.value))

    @cached_property
    def own_name_text(self) -> str:
        """The words of the last of its names, in the form of ``text``."""
        return spaced(self.names[-1]) if self.names else ""

    @property
    def is_page_of_contents(self) -> bool:
        """True for a page of an entry of the contents, which changes with the layout of a manual."""
        return isinstance(self.value, int) and self.path.startswith("manual.contents.")

    @cached_property
    def name_words(self) -> frozenset[str]:
        """The words of its name and of the names above it."""
        words: set[str] = set()
        for name in self.names:
            words.update(_words_of_name(name))
        return frozenset(words)

    @cached_property
    def own_name_words(self) -> frozenset[str]:
        """The words of the last of its names."""
        if not self.names:
            return frozenset()
        return frozenset(_words_of_name(self.names[-1]))

    def may_change_with(self, sections: Collection[str], passage: Passage) -> bool:
        """Return whether a change of the passage can affect the fact.

        The fact cites one of the sections, or is about an option of the order code that the passage contains. Manuals
        print order codes in many sections, few of which a spec cites.

        Facts about the edition, such as its date, do not cite sections. They are at passages that contain a date,
        change a word of the fact on the cover, or add a row to the history below the row of the fact.
        """
        if self.is_of_edition:
            is_on_cover = passage.section.number == COVER and not self.value_words.isdisjoint(passage.old_words)
            has_date = any(_PRINTED_DATE.fullmatch(word) for word in (*passage.old_words, *passage.new_words))
            return is_on_cover or has_date or self._is_above_new_row_of_history(passage)
        return not self.sections.isdisjoint(sections) or self._is_option_named_in(passage)

    def _is_above_new_row_of_history(self, passage: Passage) -> bool:
        """Return whether a passage adds a row with another revision to the history, below the row of this fact.

        If the row is part of a larger change, the words of the fact are among the old words. Otherwise they are close
        to the passage.
        """
        added_words = [word for word in passage.new_words if word not in passage.old_words]
        adds_revision = any(_REVISION_NUMBER.fullmatch(word) for word in added_words)
        if not adds_revision or self.path == "manual.date":
            return False
        if passage.old_words:
            return bool(self.value_words) and self.value_words <= {word.casefold() for word in passage.old_words}
        begins_with_revision = _REVISION_NUMBER.fullmatch(passage.new_words[0]) is not None
        return begins_with_revision and not self.value_words.isdisjoint(passage.words_in_row)

    def _is_option_named_in(self, passage: Passage) -> bool:
        """Return whether the fact is about an option of the order code whose label is in the passage.

        The label is one of the old words, or the last two digits of an order code among them. If the passage only adds
        an order code, the words around it count as the old words, since tables list similar order codes in adjacent
        rows.
        """
        path_with_label = _PATH_OF_OPTION.fullmatch(self.path)
        if path_with_label is None:
            return False
        option_label = path_with_label[1].casefold()
        compared_words = passage.old_words
        new_words_end_with_digits = bool(_last_digits(word.casefold() for word in passage.new_words))
        only_adds_order_code = not passage.old_words and new_words_end_with_digits
        if only_adds_order_code:
            compared_words = passage.words_in_row
        lowercase_words = {word.casefold() for word in compared_words}
        if _is_order_code_label(option_label) and option_label in lowercase_words:
            return True
        # Labels of digits are often printed only at the end of an order code.
        return option_label.isdigit() and option_label in _last_digits(lowercase_words)


def _words_of_name(name: str) -> list[str]:
    """Return the words of a name or identifier: ``["clock", "max"]`` for ``clock_max``."""
    return WORD.findall(name.replace("_", " ").casefold())


def spaced(text: str) -> str:
    """Return the words of a text or of an identifier, with spaces around and between them, for searches of phrases."""
    words = " ".join(_words_of_name(plain_line(text)))
    return f" {words} "


def _is_order_code_label(words_text: str) -> bool:
    """Return whether a text is so specific that it is the label of an option where it occurs.

    Numbers with fewer than 4 digits and words with fewer than 3 letters are not: A or TO can be ordinary words.
    """
    if words_text.isdigit():
        return len(words_text) >= 4
    has_digit = any(letter.isdigit() for letter in words_text)
    return len(words_text) >= 3 or has_digit


def _last_digits(words: Iterable[str]) -> set[str]:
    """Return the two digits at the end of each order code among lowercase words: ``{"24"}`` for ``xy24``."""
    last_digits: set[str] = set()
    for word in words:
        order_code = ORDER_CODE.fullmatch(word)
        if order_code is not None:
            last_digits.add(order_code[1])
    return last_digits


def _relative_path(file: str) -> str:
    """Return a path relative to the current folder if it is below it."""
    with suppress(ValueError):
        return FilePath(file).relative_to(FilePath.cwd()).as_posix()
    return file


def _printed_words(value: object) -> Iterator[str]:
    """Yield the words that manuals print for a value, in lower case. A Boolean has none.

    A number can be printed in hexadecimal, with separators, or in another unit. For example, 4000 is printed as
    ``4,000``, ``4.000``, ``4``, ``400.0`` or ``fa0h``.
    """
    if isinstance(value, bool) or value is None:
        return
    if value in _PRINTED_FOR_BYTE_ORDER:
        yield from _PRINTED_FOR_BYTE_ORDER[str(value)]
        return
    if not isinstance(value, int):
        for word in WORD.findall(plain_line(str(value))):
            yield word.casefold()
            if HEXADECIMAL.fullmatch(word.casefold()):
                yield word.casefold().removesuffix("h")
        yield from _PRINTED_FOR_VALUE.get(str(value), ())
        return
    with_commas = f"{value:,}"
    yield from (with_commas, with_commas.replace(",", "."))
    yield f"{value:g}"
    for scale in (1000, 1_000_000):
        # With a factor of 1000, a value of 100 can be printed as 0.1 of the larger unit.
        if value >= scale // 10:
            yield f"{value / scale:g}"
    yield from (str(value), f"{value / 10:.1f}")
    yield from (f"{value:x}", f"{value:02x}", f"{value:x}h", f"{value:02x}h", f"0x{value:x}", f"0x{value:02x}")


def _with_top_bit(polynomial: object) -> frozenset[str]:
    """Return a CRC polynomial with its highest bit, in the notations of manuals: hexadecimal and binary.

    The spec leaves out the highest bit, whose position is the width of the CRC. The width is not known here, so all
    widths up to 32 are included.
    """
    if not isinstance(polynomial, int):
        return frozenset()
    smallest_width = max(polynomial.bit_length(), 3)
    printed_polynomials: set[str] = set()
    for width in range(smallest_width, 33):
        with_top_bit = polynomial | (1 << width)
        printed_polynomials |= {f"{with_top_bit:x}", f"{with_top_bit:x}h", f"0x{with_top_bit:x}", f"{with_top_bit:b}"}
    return frozenset(printed_polynomials)


#: Keys whose values are the names of other parts of the spec, or paths to them.
_KEYS_OF_REFERENCES = ("register", "crc", "field", "alarm", "procedure", "affects", "order_code", "erratum", "layout")
#: Keys of maps whose values are parts of the spec themselves.
_MAPS_OF_ITEMS = ("values", "contents")


@dataclass(frozen=True)
class _EnclosingContext:
    """The parts of a spec around a fact: the nearest one with its path, and the names, source and references."""

    item: Path = ()
    source: Sources = ()
    names: tuple[str, ...] = ()
    refers_to: frozenset[str] = frozenset()


def facts_with_citations(document: Document) -> list[CitingFact]:
    """Return the facts of a spec with what they cite. A fact without a source has the source of the item around it."""
    return list(_facts_in(document, document.data, path=(), enclosing=_EnclosingContext()))


def _parse_source(source: str) -> Sources:
    """Return the places that a source cites, without the mark of the template of ``codewheel new``."""
    return parse_sources(source.replace("TODO ", ""))


def _facts_in(document: Document, node: Any, path: Path, enclosing: _EnclosingContext) -> Iterator[CitingFact]:
    """Yield the facts in part of a spec, with names, source and references from the items around them.

    Every single value with a source is a fact, and so is every value about the manual itself. Sources and the keys in
    ``_KEYS_WITHOUT_FACTS`` are left out.
    """
    if isinstance(node, dict):
        map_context = _context_inside_map(node, path, enclosing)
        for key, member in node.items():
            is_fact = key not in _KEYS_WITHOUT_FACTS and not str(key).endswith("_source")
            if is_fact:
                printed_key = _PRINTED_FOR_KEY.get(str(key), str(key))
                member_source = _source_of_member(node, path, key, map_context)
                member_context = replace(map_context, source=member_source, names=(*map_context.names, printed_key))
                yield from _facts_in(document, member, (*path, key), member_context)
    elif isinstance(node, list):
        for index, member in enumerate(node):
            # A row of a table is an item without a name.
            is_row = isinstance(member, list)
            member_context = replace(enclosing, item=(*path, index)) if is_row else enclosing
            yield from _facts_in(document, member, (*path, index), member_context)
    elif enclosing.source or path[:1] == ("manual",):
        yield _build_fact(document, node, path, enclosing)


def _source_of_member(item: Mapping[str, Any], path: Path, member_name: str, map_context: _EnclosingContext) -> Sources:
    """Return the citations of a member of a map: its own source, ``<key>_source``, or else the source of the map.

    An entry of the table of contents without a source cites its section, such as ``manual.contents.4.2``.
    """
    own_source = item.get(f"{member_name}_source")
    source = _parse_source(own_source) if isinstance(own_source, str) else map_context.source
    if path[:2] == ("manual", "contents") and not source:
        section = path[2] if len(path) > 2 else member_name
        return _parse_source(str(section))
    return source


def _context_inside_map(item: Mapping[str, Any], path: Path, enclosing: _EnclosingContext) -> _EnclosingContext:
    """Return the item, source, names and references for the facts in a map.

    A map is an item itself if it is in a list or in a map of items, or has a source. Other maps belong to the item
    around them.
    """
    is_in_map_of_items = len(path) > 1 and path[-2] in _MAPS_OF_ITEMS
    is_item = bool(path) and (isinstance(path[-1], int) or "source" in item or is_in_map_of_items)
    own_source = item.get("source")
    references = frozenset(_references_in(item))
    # An item with its own references has only its own.
    if not is_item or not references:
        references |= enclosing.refers_to
    return _EnclosingContext(
        item=path if is_item else enclosing.item,
        source=_parse_source(own_source) if isinstance(own_source, str) else enclosing.source,
        names=(*enclosing.names, *_names_of_item(item)),
        refers_to=references,
    )


def _references_in(item: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names and paths of the parts to which a map refers by the keys ``_KEYS_OF_REFERENCES``."""
    for key in _KEYS_OF_REFERENCES:
        name_or_names = item.get(key)
        names = name_or_names if isinstance(name_or_names, list) else [name_or_names]
        for name in names:
            if isinstance(name, str):
                yield name


def _build_fact(document: Document, fact_value: object, path: Path, enclosing: _EnclosingContext) -> CitingFact:
    """Return the value at a path as a fact, with the sections and pages of the manual that it cites.

    Citations of other documents are left out.
    """
    # A citation without a document is one of the manual itself.
    in_manual = [citation for citation in enclosing.source if not citation.document]
    line, _ = document.position(path)
    return CitingFact(
        file=document.file,
        line=line,
        path=document.name_path(path),
        value=fact_value,
        sections=frozenset(citation.section for citation in in_manual if citation.section),
        pages=frozenset(citation.page for citation in in_manual if citation.page is not None),
        names=enclosing.names,
        spelling=_spelling_in_spec(document, fact_value, path),
        item=document.name_path(enclosing.item),
        refers_to=enclosing.refers_to,
    )


def _spelling_in_spec(document: Document, fact_value: object, path: Path) -> str:
    """Return a number or truth value as in the spec, such as ``0x1F`` or ``true``, or "" for another value."""
    if isinstance(fact_value, bool):
        return str(fact_value).lower()
    return document.spelling_at(path) if isinstance(fact_value, int) else ""


def _names_of_item(item: Mapping[str, Any]) -> list[str]:
    """Return the names of an item: those that the manual may print next to its values, and translations."""
    labels = [item.get(key) for key in _KEYS_OF_LABELS]
    names_by_language = item.get("names")
    if isinstance(names_by_language, dict):
        labels += names_by_language.values()
    return [label for label in labels if isinstance(label, str)]
