"""``codewheel reread`` and ``codewheel facts``: from a new edition of a manual, or a place in it, to the facts."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..loading.library import load_families
from ..reread.citing import Citing, citing, ranked
from ..reread.passages import Passage, changed, numbers_changed, same_language
from ..reread.sections import WORD, Manual, NoText, read
from ..say.words import counted
from .terminal import Stop, problems

if TYPE_CHECKING:
    from ..loading.library import Family

JSON_VERSION = 1
#: Facts listed for a passage, and the longest text shown of it.
_MOST_FACTS, _LONGEST = 8, 400
_CANNOT = (
    "Only words and their order are compared. Changes in figures and in the arrangement of columns and tables are not "
    "found. Read these in the new edition."
)


@dataclass(frozen=True)
class _Touched:
    """A passage with the facts whose value or name appears in it, and the number of all facts that belong to it."""

    passage: Passage
    facts: Sequence[Citing]
    here: int


def run(chosen: argparse.Namespace) -> int:
    """Compare two texts. The exit code is 1 if they differ.

    Raises:
        Stop: A manual cannot be read, or the family is not known.
    """
    try:
        old, new = read(chosen.old), read(chosen.new)
    except NoText as reason:
        raise Stop(str(reason), 2) from None
    family = _family(chosen.specs, chosen.family, old)
    facts = citing(family.document)
    by_words = same_language(old, new)
    passages = changed(old, new) if by_words else numbers_changed(old, new)
    without_number = _without_number(family)
    touched = [_touched(passage, facts, old, without_number) for passage in passages]
    if chosen.json:
        print(json.dumps(_as_data(family, touched, by_words), indent=2, ensure_ascii=False))
    else:
        print("\n".join(_as_text(family, touched, facts, by_words)))
    return 1 if touched else 0


def _family(specs: Sequence[Path], name: str | None, old: Manual) -> Family:
    families, report = load_families(specs)
    if report:
        raise problems(report)
    plain = {family.device.name: family for family in families if not family.device.base}
    if name is not None:
        if name.lower() not in plain:
            raise Stop(f"'{name}' is not a family; known: {', '.join(plain)}", 2)
        return plain[name.lower()]
    cover = {word.casefold() for section in old.sections[:1] for word in section.words}
    matches = [family for family in plain.values() if cover >= set(WORD.findall(family.device.manual.title.casefold()))]
    if len(matches) != 1:
        problem = (
            "its first page names none of the families" if not matches else "its first page names several families"
        )
        known_names = ", ".join(plain)
        raise Stop(
            f"cannot tell which family this manual describes: {problem}; add --family NAME, one of {known_names}", 2
        )
    return matches[0]


def _without_number(family: Family) -> Mapping[int, str]:
    """Return the sections without a number by their pages, because their titles depend on the language."""
    contents = family.document.data["manual"].get("contents", {})
    return {
        heading["page"]: title for title, heading in contents.items() if not title[0].isdigit() and "page" in heading
    }


def _touched(passage: Passage, facts: Sequence[Citing], old: Manual, without_number: Mapping[int, str]) -> _Touched:
    sections = {passage.section.number} | old.without_heading_after(passage.section.number)
    sections.add(without_number.get(passage.section.page or 0, passage.section.number))
    section_facts = [fact for fact in facts if fact.is_at(sections, passage)]
    return _Touched(passage, ranked(section_facts, passage), len(section_facts))


def _as_text(family: Family, touched: Sequence[_Touched], facts: Sequence[Citing], by_words: bool) -> Iterator[str]:
    compared_note = "" if by_words else "; the texts have few words in common, so only numbers are compared"
    yield f"facts of {family.document.file}{compared_note}"
    if not touched:
        yield "no difference"
        return
    section = ""
    for touched_passage in touched:
        if touched_passage.passage.section.shown != section:
            section = touched_passage.passage.section.shown
            yield f"\n{section}"
        yield from _passage(touched_passage)
    sections = {touched_passage.passage.section.number for touched_passage in touched}
    citing_them = sum(1 for fact in facts if fact.sections & sections)
    yield ""
    places = f"{counted(len(touched), 'passage')} in {counted(len(sections), 'section')}"
    yield f"{places}, cited by {citing_them:,} of {len(facts):,} facts"
    yield _CANNOT


def _passage(touched_passage: _Touched) -> Iterator[str]:
    yield ""
    for name, text in zip(("old", "new"), touched_passage.passage.shown, strict=True):
        if text:
            yield f"  {name}: {text if len(text) <= _LONGEST else text[: _LONGEST - 3] + '...'}"
    if not touched_passage.here:
        yield "  no fact in the spec cites this place"
        return
    listed_facts = touched_passage.facts[:_MOST_FACTS]
    yield from (f"  {fact.shown}" for fact in listed_facts)
    if touched_passage.here > len(listed_facts):
        yield f"  {_others(touched_passage.here - len(listed_facts), bool(listed_facts))}"


def _others(number: int, are_some_listed: bool) -> str:
    return f"and {counted(number, 'other fact' if are_some_listed else 'fact')} from this section"


def _as_data(family: Family, touched: Sequence[_Touched], by_words: bool) -> Mapping[str, Any]:
    return {
        "version": JSON_VERSION,
        "spec": family.document.file,
        "compared": "words" if by_words else "numbers",
        "passages": [
            {
                "section": touched_passage.passage.section.number,
                "title": touched_passage.passage.section.title,
                "old": " ".join(touched_passage.passage.old),
                "new": " ".join(touched_passage.passage.new),
                "facts": _listed(touched_passage.facts),
                "facts_of_section": touched_passage.here,
            }
            for touched_passage in touched
        ],
    }


def _listed(facts: Iterable[Citing]) -> list[Mapping[str, Any]]:
    return [{"file": fact.file, "line": fact.line, "path": fact.path, "value": fact.value} for fact in facts]


def run_facts(chosen: argparse.Namespace) -> int:
    """List the facts that cite a page or a section. The exit code is 1 if there are none.

    Raises:
        Stop: There is no such family, or neither page nor section was given.
    """
    if chosen.page is None and chosen.section is None:
        raise Stop("give --page NUMBER or --section NUMBER, or both", 2)
    families, report = load_families(chosen.specs)
    if report:
        raise problems(report)
    cited_family = next((family for family in families if family.device.name == chosen.family.lower()), None)
    if cited_family is None:
        raise Stop(
            f"'{chosen.family}' is not a family; known: {', '.join(family.device.name for family in families)}", 2
        )
    facts = [
        fact
        for fact in citing(cited_family.document)
        if (chosen.page is None or chosen.page in fact.pages)
        and (chosen.section is None or chosen.section in fact.sections)
    ]
    if chosen.json:
        print(json.dumps({"version": JSON_VERSION, "facts": _listed(facts)}, indent=2, ensure_ascii=False))
    else:
        place = " ".join(
            [f"section {chosen.section}"] * (chosen.section is not None)
            + [f"page {chosen.page}"] * (chosen.page is not None)
        )
        print("\n".join([*(fact.shown for fact in facts), f"{counted(len(facts), 'fact')} from {place}"]))
    return 0 if facts else 1
