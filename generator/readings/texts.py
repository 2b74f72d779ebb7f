"""Facts in the texts of a spec: the numbers in them, the sections that they cite, and the pages of the contents.

Two readers write texts in different words, so only the numbers and cited sections of texts are compared.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from ..language.document import Path, label_of
from ..language.schemas import PROSE
from ..loading.spec_parts import parse_sources
from .reading import ComparedFact, FactClass, PrintedNumbers, SpecReading

#: First part of the keys of numbers in texts, and of cited sections.
NUMBERS, CITED = "numbers", "cited"
_UNITS = (
    r"(?:[mµ]?[VA](?:pp)?|[km]?Nm|[mckµ]?m(?:²|/s)?|[mµn]?s|min(?:ute)?s?|[kMG]?Hz|°[CF]?|%|[kM]?Ω(?:/km)?|AWG|k?g)"
)
_NUMBER_IN_TEXT = re.compile(rf"[±−+-]?(?:[^\W\d_][\w-]*)?\d[\w.,-]*(?:/s|/km|²| ?{_UNITS}(?!\w))?")
#: Maps of a second reading by path, which are not texts.
_MAPS_WITHOUT_TEXTS = frozenset((("found",), ("sections",)))
_KEYS_OF_TEXTS = PROSE | {"printed", "used"}
_THOUSANDS_COMMA = re.compile(r"(?<=\d),(?=\d{3}(?!\d))")


def numbers_in(text: str) -> str:
    """Return the numbers in a text in their order, each with its unit: ``5V 10ms``. Return "" if there are none."""
    # 4,096 is read as 4096.
    without_commas = _THOUSANDS_COMMA.sub("", text)
    # The pattern also matches a comma, point or hyphen after a number.
    numbers = (match.rstrip(".,-").replace(" ", "").lstrip("+") for match in _NUMBER_IN_TEXT.findall(without_commas))
    return " ".join(numbers).replace("−", "-")


def content_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the page of every section and of every entry in the table of contents, if it has one."""
    for section, section_contents in reading.document.data["manual"].get("contents", {}).items():
        place: Path = ("manual", "contents", section)
        pages = {(*place, "page"): section_contents.get("page")}
        for entry, page in section_contents.get("entries", {}).items():
            pages[(*place, "entries", entry)] = page
        for page_place, page in pages.items():
            if page is not None:
                description = f"page of {dotted_path(page_place[2:])} in the contents"
                yield ComparedFact(
                    fact_class=FactClass.CONTENTS,
                    key=("contents", *page_place),
                    value=str(page),
                    description=description,
                    place=page_place,
                )


def text_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield a fact for every text with numbers, and one for every source with sections, identified by their places."""
    for place, text in prose_texts((), reading.document.data):
        numbers_or_sections = _numbers_or_sections(place[-1], text)
        if not numbers_or_sections:
            continue
        if is_source(place[-1]):
            yield ComparedFact(
                fact_class=FactClass.SECTION,
                key=(CITED, *place),
                value=numbers_or_sections,
                description=f"section cited at {dotted_path(place)}",
                place=place,
            )
        else:
            yield ComparedFact(
                fact_class=FactClass.TEXT,
                key=(NUMBERS, *place),
                value=numbers_or_sections,
                description=f"numbers in {dotted_path(place)}",
                place=place,
            )


def is_source(key: str | int) -> bool:
    """Return whether a key of a spec contains a citation of a manual, such as ``source`` or ``default_source``."""
    return key == "source" or str(key).endswith("_source")


def _numbers_or_sections(key: str | int, text: str) -> str:
    """Return the part of a text that is compared: its numbers, or the sections of the manual that a source cites.

    Citations of other documents are left out.
    """
    if not is_source(key):
        return numbers_in(text)
    # A source without a document cites the manual itself.
    sections = {cited.section for cited in parse_sources(text) if not cited.document and cited.section}
    return ", ".join(sorted(sections))


def printed_numbers_by_path(reading: SpecReading) -> dict[str, PrintedNumbers]:
    """Return the numbers, or cited sections, that the second reader of a manual read for texts of the spec.

    A second reading is a transcript of the same manual that was written without the spec. Its key ``found`` lists texts
    by the path of the text in the spec, such as ``registers.mode.meaning``. From ``at 5 V, 10 ms`` there, the result is
    ``5V 10ms`` with its place in the second reading.
    """
    printed_numbers: dict[str, PrintedNumbers] = {}
    for path, text in reading.document.data.get("found", {}).items():
        member_name = path.rpartition(".")[2]
        printed_numbers[path] = PrintedNumbers(text=_numbers_or_sections(member_name, text), place=("found", path))
    return printed_numbers


def sections_by_path(reading: SpecReading) -> dict[str, list[str]]:
    """Return the sections that a second reading cites for whole parts of the spec: ``{"registers": ["4.3"]}``."""
    cited_sections: dict[str, list[str]] = {}
    for section, paths in reading.document.data.get("sections", {}).items():
        for path in paths:
            cited_sections.setdefault(path, []).append(section)
    return cited_sections


def prose_texts(place: Path, node: Any) -> Iterator[tuple[Path, str]]:
    """Yield every text and source in a spec, with its place.

    Call it with ``()`` and the data of the spec. It calls itself for each part. In a place, an item of a list is given
    by its name, or by its index if it has none.
    """
    if isinstance(node, dict):
        for key, member in node.items():
            if (*place, key) not in _MAPS_WITHOUT_TEXTS:
                yield from prose_texts((*place, key), member)
    elif isinstance(node, list):
        for index, member in enumerate(node):
            yield from prose_texts((*place, label_of(member) or index), member)
    elif isinstance(node, str):
        is_characteristic = (place[0], place[-1]) == ("characteristics", "value")
        if is_characteristic or place[-1] in _KEYS_OF_TEXTS:
            yield place, node


def dotted_path(place: Path) -> str:
    """Return a place as a path with dots."""
    return ".".join(map(str, place))
