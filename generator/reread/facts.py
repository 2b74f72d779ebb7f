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
from .sections import COVER, WORD, plain_line

#: Keys that hold no fact of the manual: places, names, and the judgement of an erratum.
_NO_FACTS = frozenset({"source", "name", "erratum", "affects", "severity", "status"})
#: Words that manuals print for keys whose own words they never print.
_PRINTED_FOR_KEY = {"init": "start value", "poly": "polynomial", "xorout": "inverted output"}
#: Keys of the words that a manual prints next to a value.
_KEYS_OF_LABELS = ("name", "printed_name", "title", "symbol", "contact", "signal")
#: Letters of a value shown with its fact.
_SHOWN_LETTERS = 60
#: Words that manuals print for values of the spec language.
_PRINTED_FOR_VALUE = {"read_only": ("ro", "r"), "read_write": ("rw",), "write_only": ("wo", "w")}
#: The path of a fact about an option of the order code.
_PATH_OF_OPTION = re.compile(r"order_code\.parts\.[^.]+\.values\.([^.]+)(?:\..*)?")
#: Paths of the facts about the edition itself. Manuals print them with a date.
_PATHS_OF_EDITION = ("manual.revision", "manual.date", "manual.history")
_REVISION_NUMBER = re.compile(r"\d+(?:\.\d+)+")
_PRINTED_DATE = re.compile(r"\d{1,2}[./-]\d{1,2}[./-]\d{4}|\d{4}-\d\d-\d\d")
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
    def words(self) -> frozenset[str]:
        """The words of the value as a manual may print them, such as ``4,000`` and ``fa0h`` for 4000."""
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
        words: set[str] = set()
        for name in self.names:
            words.update(_words_of_name(name))
        return frozenset(words)

    @cached_property
    def own_name(self) -> frozenset[str]:
        """The words of the last of its names."""
        if not self.names:
            return frozenset()
        return frozenset(_words_of_name(self.names[-1]))

    def is_at(self, sections: Collection[str], passage: Passage) -> bool:
        """Return whether the fact cites one of the sections, or is an option of the order code that the passage names.

        Manuals print order codes in many sections and headings, few of which a spec cites. A fact of the edition is
        instead at a passage that changes it on the cover, has a date, or adds a row to the history below its own row.
        """
        if self.is_of_edition:
            is_on_cover = passage.section.number == COVER and not self.words.isdisjoint(passage.old)
            has_date = any(_PRINTED_DATE.fullmatch(word) for word in (*passage.old, *passage.new))
            return is_on_cover or has_date or self._is_above_new_row_of_history(passage)
        return not self.sections.isdisjoint(sections) or self._is_option_named_in(passage)

    def _is_above_new_row_of_history(self, passage: Passage) -> bool:
        """Return whether a passage adds a row with another revision below the row of this fact."""
        begins_with_revision = bool(passage.new) and _REVISION_NUMBER.fullmatch(passage.new[0]) is not None
        is_new_row = not passage.old and begins_with_revision
        return is_new_row and self.path != "manual.date" and not self.words.isdisjoint(passage.close)

    def _is_option_named_in(self, passage: Passage) -> bool:
        """Return whether the fact is about an option of the order code whose label is in the passage.

        The label is one of the old words, or is the last two digits of an order code among them. For a passage that
        adds an order code, the words around it count instead of the old words.
        """
        option_match = _PATH_OF_OPTION.fullmatch(self.path)
        if option_match is None:
            return False
        label = option_match[1].casefold()
        # A row with a new order code is next to rows of other order codes.
        adds_order_code = not passage.old and bool(_last_digits(word.casefold() for word in passage.new))
        words_of_passage = passage.close if adds_order_code else passage.old
        folded_words = {word.casefold() for word in words_of_passage}
        if _is_order_code_label(label) and label in folded_words:
            return True
        # Labels of digits are often printed only at the end of an order code.
        return label.isdigit() and label in _last_digits(folded_words)


def _words_of_name(name: str) -> list[str]:
    """Return the words of a name or identifier: ``["clock", "max"]`` for ``clock_max``."""
    return WORD.findall(name.replace("_", " ").casefold())


def spaced(text: str) -> str:
    """Return the words of a text or of an identifier, with spaces between them and around them."""
    words = " ".join(_words_of_name(plain_line(text)))
    return f" {words} "


def _is_order_code_label(words_text: str) -> bool:
    """Return whether a text can only be a label of an order code.

    Such a text is a number of 4 or more digits, or another text of 3 or more characters or with a digit. A or TO can be
    words.
    """
    if words_text.isdigit():
        return len(words_text) >= 4
    has_digit = any(letter.isdigit() for letter in words_text)
    return len(words_text) >= 3 or has_digit


def _last_digits(words: Iterable[str]) -> set[str]:
    """Return the two digits at the end of each order code among lower-case words: ``{"24"}`` for ``xy24``."""
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
    """Yield the words of a value in lower case. A truth value has none.

    A number can be printed in hexadecimal, with separators, or in a larger unit. For example, 4000 is printed as
    ``4,000``, ``4.000``, ``4``, ``400.0`` or ``fa0h``.
    """
    if isinstance(value, bool) or value is None:
        return
    if not isinstance(value, int):
        for word in WORD.findall(plain_line(str(value))):
            yield word.casefold()
        yield from _PRINTED_FOR_VALUE.get(str(value), ())
        return
    with_commas = f"{value:,}"
    yield from (with_commas, with_commas.replace(",", "."))
    yield f"{value:g}"
    for scale in (1000, 1_000_000):
        # With a scale of 1000, a value of 100 can be printed as 0.1 of the larger unit.
        if value >= scale // 10:
            yield f"{value / scale:g}"
    yield from (str(value), f"{value / 10:.1f}")
    yield from (f"{value:x}", f"{value:02x}", f"{value:x}h", f"{value:02x}h", f"0x{value:x}", f"0x{value:02x}")


def _with_top_bit(polynomial: object) -> frozenset[str]:
    """Return a polynomial as manuals print it with its top bit, in hexadecimal or binary.

    The spec leaves out the top bit, whose position is the width of the CRC. Each width up to 32 is tried.
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
class _Surroundings:
    """The parts of a spec around a fact: the nearest one with its path, and the names, source and references."""

    item: Path = ()
    source: Sources = ()
    names: tuple[str, ...] = ()
    refers_to: frozenset[str] = frozenset()


def facts_with_citations(document: Document) -> list[Citing]:
    """Return the facts of a spec with what they cite. A fact without a source has the source of the item around it."""
    return list(_facts_in(document, document.data, path=(), around=_Surroundings()))


def _parse_source(source: str) -> Sources:
    """Return the places that a source cites, without the mark of the template of ``codewheel new``."""
    return parse_sources(source.replace("TODO ", ""))


def _facts_in(document: Document, node: Any, path: Path, around: _Surroundings) -> Iterator[Citing]:
    """Yield the facts in part of a spec, with names, source and references from the items around them.

    A fact is a value, neither map nor list, with a source, or any value about the manual. Keys of ``_NO_FACTS`` and
    sources themselves are left out.
    """
    if isinstance(node, dict):
        in_map = _surroundings_in(node, path, around)
        for key, member in node.items():
            is_fact = key not in _NO_FACTS and not str(key).endswith("_source")
            if is_fact:
                printed_key = _PRINTED_FOR_KEY.get(str(key), str(key))
                around_member = replace(
                    in_map, source=_source_of_member(node, path, key, in_map), names=(*in_map.names, printed_key)
                )
                yield from _facts_in(document, member, (*path, key), around_member)
    elif isinstance(node, list):
        for index, member in enumerate(node):
            # A row of a table is an item without a name.
            is_row = isinstance(member, list)
            around_member = replace(around, item=(*path, index)) if is_row else around
            yield from _facts_in(document, member, (*path, index), around_member)
    elif around.source or path[:1] == ("manual",):
        yield _build_fact(document, node, path, around)


def _source_of_member(item: Mapping[str, Any], path: Path, member_name: str, in_map: _Surroundings) -> Sources:
    """Return the citations of a map's member: its own source, ``<key>_source``, or else the source of the map.

    Contents without a source cite their section, which is the step after ``manual.contents`` in the path of the member.
    """
    own_source = item.get(f"{member_name}_source")
    source = _parse_source(own_source) if isinstance(own_source, str) else in_map.source
    if path[:2] == ("manual", "contents") and not source:
        section = path[2] if len(path) > 2 else member_name
        return _parse_source(str(section))
    return source


def _surroundings_in(item: Mapping[str, Any], path: Path, around: _Surroundings) -> _Surroundings:
    """Return the context of the facts in a map: from the map and from the items around it.

    An item is a map in a list, with a source, or in a map of items. Other maps belong to the item around them.
    """
    is_in_map_of_items = len(path) > 1 and path[-2] in _MAPS_OF_ITEMS
    is_item = bool(path) and (isinstance(path[-1], int) or "source" in item or is_in_map_of_items)
    own_source = item.get("source")
    references = frozenset(_references_in(item))
    # An item with its own references has only its own.
    if not is_item or not references:
        references |= around.refers_to
    return _Surroundings(
        item=path if is_item else around.item,
        source=_parse_source(own_source) if isinstance(own_source, str) else around.source,
        names=(*around.names, *_names_of_item(item)),
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


def _build_fact(document: Document, fact_value: object, path: Path, around: _Surroundings) -> Citing:
    """Return the value at a path as a fact, with the sections and pages of the manual that it cites.

    Citations of other documents are left out.
    """
    # A citation without a document is one of the manual itself.
    in_manual = [citation for citation in around.source if not citation.document]
    line, _ = document.position(path)
    return Citing(
        file=document.file,
        line=line,
        path=document.name_path(path),
        value=fact_value,
        sections=frozenset(citation.section for citation in in_manual if citation.section),
        pages=frozenset(citation.page for citation in in_manual if citation.page is not None),
        names=around.names,
        spelling=_spelling_in_spec(document, fact_value, path),
        item=document.name_path(around.item),
        refers_to=around.refers_to,
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
