"""``codewheel reread``: compare two editions of a manual, and list the facts that cite changed passages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from typing import TYPE_CHECKING, Any

from ..language.problems import joined_lines
from ..say import count_with_unit
from .cli import Parser, a_path, add_specs_option
from .facts import facts_data
from .terminal import CommandError, Progress, error_after_printing, print_json

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from ..loading.library import Family
    from ..reread.facts import CitingFact
    from ..reread.passages import Passage
    from ..reread.sections import Manual
    from ..reread.touched_facts import TouchedFacts

EXAMPLES = ("codewheel reread manual-1.0.txt manual-1.1.txt --family my_encoder",)
JSON_VERSION = 1
#: Highest number of facts that are listed for a passage, and of characters that are shown of its text.
_MAX_FACTS, _MAX_CHARACTERS = 10, 400
_LIMITS_OF_REREAD = (
    "Only words and their order are compared. Changes in figures and in the arrangement of columns and tables are not "
    "found. Read these in the new edition."
)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Compare the texts of two editions of a manual, and list the facts that cite changed passages."
    parser.epilog = (
        "The exit code is 0 without differences, 1 with differences, and 2 for a usage error or a file that is not the "
        "text of a manual."
    )
    parser.add_argument("old", type=a_path, metavar="OLD", help="the edition that the spec describes: text or PDF")
    parser.add_argument("new", type=a_path, metavar="NEW", help="the new edition")
    parser.add_argument(
        "--family", metavar="FAMILY", help="family that the manual describes (default: the family on its first page)"
    )
    add_specs_option(parser, "")


@dataclass(frozen=True)
class _ChangedPassage:
    """A changed passage of a manual with the facts that it concerns."""

    passage: Passage
    #: Names by which facts cite the section of the passage.
    section_names: frozenset[str]
    #: Facts whose value or name appears in the passage.
    facts: Sequence[CitingFact]
    #: Number of all facts that cite the section.
    section_fact_count: int


def run(arguments: argparse.Namespace) -> int:
    """Print the passages in which two editions differ, with the facts that cite them.

    The exit code is 1 if there are any differences.

    Raises:
        CommandError: A manual cannot be read, or the family is not known.
    """
    from ..reread.facts import facts_with_citations
    from ..reread.passages import differing_passages, numbers_changed, same_language
    from ..reread.sections import NoText, read_manual
    from ..reread.touched_facts import TouchedFacts
    from .read_specs import specs_to_judge

    paths = specs_to_judge(arguments.specs, "reread OLD NEW").paths
    try:
        old, new = read_manual(arguments.old), read_manual(arguments.new)
    except NoText as error:
        raise CommandError(str(error), 2) from None
    family = _family_of_manual(paths, arguments.family, old)
    facts = facts_with_citations(family.document)
    # In texts of different languages, only the numbers can be compared.
    compares_words = same_language(old, new)
    passages = differing_passages(old, new) if compares_words else numbers_changed(old, new)
    titles_by_page = _unnumbered_sections(family)
    touched_facts = TouchedFacts(facts)
    with Progress("codewheel: comparing the texts"):
        changed_passages = [_passage_with_facts(passage, touched_facts, old, titles_by_page) for passage in passages]
    if arguments.json:
        print_json(_as_data(family, changed_passages, compares_words=compares_words))
    else:
        print(*_text_lines(family, changed_passages, facts, compares_words=compares_words), sep="\n")
    return 1 if changed_passages else 0


def _family_of_manual(specs: Sequence[Path], name: str | None, old: Manual) -> Family:
    """Return the family with this name, or, if ``name`` is None, the family that the manual names on its first page.

    Raises:
        CommandError: The specs have problems (exit code 1), or the family is not known (exit code 2).
    """
    from ..loading.library import load_families

    families, report = load_families(specs)
    if report:
        raise error_after_printing(report)
    families_by_name = {family.device.name: family for family in families if not family.device.base}
    known_names = ", ".join(families_by_name)
    if name is not None:
        if name.lower() not in families_by_name:
            raise CommandError(f"'{name}' is not a family; known: {known_names}", 2)
        return families_by_name[name.lower()]
    named_families = [family for family in families_by_name.values() if _is_named_first(family, old)]
    if len(named_families) != 1:
        named_count_text = "several families" if named_families else "none of the families"
        problem = f"cannot tell which family this manual describes: its first page names {named_count_text}"
        raise CommandError(f"{problem}; add --family NAME, one of {known_names}", 2)
    return named_families[0]


def _is_named_first(family: Family, manual: Manual) -> bool:
    """Return whether the first section of a manual contains all words of the family's manual title, in any case."""
    from ..reread.sections import WORD

    first_words = {word.casefold() for section in manual.sections[:1] for word in section.words}
    title_words = set(WORD.findall(family.device.manual.title.casefold()))
    return title_words <= first_words


def _unnumbered_sections(family: Family) -> Mapping[int, str]:
    """Return the titles of the sections without a number, by their pages: ``{12: "Annex"}``.

    Facts cite these titles. The text of the manual may be in a different language, but the pages are the same.
    """
    contents = family.document.data["manual"].get("contents", {})
    headings = [(title, heading) for title, heading in contents.items() if not title[0].isdigit()]
    return {heading["page"]: title for title, heading in headings if "page" in heading}


def _passage_with_facts(
    passage: Passage, touched_facts: TouchedFacts, old: Manual, titles_by_page: Mapping[int, str]
) -> _ChangedPassage:
    """Return a changed passage with the facts that it concerns, and the number of all facts that cite its section.

    Facts may cite the section by its number, by the number of a later section whose heading is not in the text, or by
    the title of an unnumbered section on the same page.
    """
    section = passage.section
    section_names = {section.number, *old.without_heading_after(section.number)}
    if section.page is not None and section.page in titles_by_page:
        section_names.add(titles_by_page[section.page])
    facts, number_of_facts = touched_facts.touched_by(passage, section_names)
    return _ChangedPassage(
        passage=passage,
        section_names=frozenset(section_names),
        facts=facts,
        section_fact_count=number_of_facts,
    )


def _text_lines(
    family: Family, changed_passages: Sequence[_ChangedPassage], facts: Sequence[CitingFact], *, compares_words: bool
) -> Iterator[str]:
    """Yield the changed passages by section with the facts that they concern, and then a summary.

    ``facts`` are all facts of the spec. ``compares_words`` is false if only numbers were compared, because the texts
    have few words in common.
    """
    note = "" if compares_words else "; the texts have few words in common, so only numbers are compared"
    yield f"facts of {family.document.file}{note}"
    if not changed_passages:
        yield "no difference"
        return
    heading = ""
    for changed_passage in changed_passages:
        section = changed_passage.passage.section
        if section.shown != heading:
            heading = section.shown
            # The paths of the facts that were listed in this section, by the old and the new text.
            paths_by_change: dict[tuple[Sequence[str], Sequence[str]], set[str]] = {}
            yield f"\n{heading}"
        change = (changed_passage.passage.old_words, changed_passage.passage.new_words)
        listed_paths = paths_by_change.setdefault(change, set())
        yield from _passage_lines(changed_passage, listed_paths)
    section_numbers = {changed_passage.passage.section.number for changed_passage in changed_passages}
    cited_names: set[str] = set()
    for changed_passage in changed_passages:
        cited_names |= changed_passage.section_names
    citing_facts = [fact for fact in facts if not fact.sections.isdisjoint(cited_names)]
    number_of_passages = count_with_unit(len(changed_passages), "passage")
    number_of_sections = count_with_unit(len(section_numbers), "section")
    yield ""
    yield f"{number_of_passages} in {number_of_sections}, cited by {len(citing_facts):,} of {len(facts):,} facts"
    yield _LIMITS_OF_REREAD


def _passage_lines(changed_passage: _ChangedPassage, listed_paths: set[str]) -> Iterator[str]:
    """Yield the old and the new text of a passage, and the facts that it concerns.

    Equal facts are listed once, with all their lines. The other facts of the section are only counted. ``listed_paths``
    are the paths of facts that were already listed for the same change in this section. They are not listed again, and
    the paths of the facts listed now are added to them.
    """
    yield ""
    old_text, new_text = changed_passage.passage.shown_texts
    for edition, passage_text in (("old", old_text), ("new", new_text)):
        if passage_text:
            yield f"  {edition}: {_shorten_text(passage_text)}"
    if not changed_passage.section_fact_count:
        yield "  no fact in the spec cites this place"
        return
    groups = _groups_of_equal_facts(changed_passage.facts)[:_MAX_FACTS]
    new_groups = [group for group in groups if not listed_paths.issuperset(fact.path for fact in group)]
    yield from map(_line_of_equal_facts, new_groups)
    is_repeated = bool(listed_paths)
    listed_facts = list(chain.from_iterable(groups))
    listed_paths.update(fact.path for fact in listed_facts)
    if is_repeated:
        conjunction = "and " if new_groups else ""
        yield f"  {conjunction}the facts listed above for the same change"
        return
    unlisted_count = changed_passage.section_fact_count - len(listed_facts)
    if unlisted_count:
        noun = "other fact" if listed_facts else "fact"
        yield f"  and {count_with_unit(unlisted_count, noun)} from this section"


def _line_of_equal_facts(facts: Sequence[CitingFact]) -> str:
    """Return a line with the first of several equal facts, and the lines of the spec that contain the others."""
    first_fact, *other_facts = facts
    if not other_facts:
        return f"  {first_fact.summary}"
    other_lines = [str(line_number) for line_number in sorted({fact.line for fact in other_facts})]
    noun = "line" if len(other_lines) == 1 else "lines"
    return f"  {first_fact.summary}, also in {noun} {joined_lines(other_lines)}"


def _groups_of_equal_facts(facts: Sequence[CitingFact]) -> list[list[CitingFact]]:
    """Return the facts in groups. Successive facts with the same key and value are one group, such as equal waits."""
    from ..reread.touched_facts import key_of

    def key_and_value(fact: CitingFact) -> object:
        return key_of(fact), fact.value

    return [list(group) for _, group in groupby(facts, key_and_value)]


def _shorten_text(text: str) -> str:
    """Return the text with at most ``_MAX_CHARACTERS`` characters, cut with three dots."""
    return text if len(text) <= _MAX_CHARACTERS else text[: _MAX_CHARACTERS - len("...")] + "..."


def _as_data(family: Family, changed_passages: Sequence[_ChangedPassage], *, compares_words: bool) -> Mapping[str, Any]:
    """Return the changed passages as plain data for ``--json``."""
    return {
        "version": JSON_VERSION,
        "spec": family.document.file,
        "compared": "words" if compares_words else "numbers",
        "passages": [_passage_data(changed_passage) for changed_passage in changed_passages],
    }


def _passage_data(changed_passage: _ChangedPassage) -> Mapping[str, Any]:
    """Return a changed passage with the facts that cite its section, for JSON."""
    passage = changed_passage.passage
    return {
        "section": passage.section.number,
        "title": passage.section.title,
        "old": " ".join(passage.old_words),
        "new": " ".join(passage.new_words),
        "facts": facts_data(changed_passage.facts),
        "facts_of_section": changed_passage.section_fact_count,
    }
