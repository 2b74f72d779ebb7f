"""``codewheel reread``: compare two editions of a manual, and list the facts that cite changed passages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

from ..language.problems import joined_lines
from ..say.plain_text import count_with_unit
from .arguments import Parser, a_path, add_specs_option
from .facts import facts_data
from .terminal import CommandError, Progress, print_json, print_problems

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from ..loading.library import Family
    from ..reread.facts import Citing
    from ..reread.passages import Passage
    from ..reread.ranking import TouchedFacts
    from ..reread.sections import Manual

EXAMPLES = ("codewheel reread manual-1.0.txt manual-1.1.txt --family my_encoder",)
JSON_VERSION = 1
#: Most facts listed for a passage (equal ones count once), and most characters shown of its text.
_MOST_FACTS, _LONGEST = 10, 400
_LIMITS_OF_REREAD = (
    "Only words and their order are compared. Changes in figures and in the arrangement of columns and tables are not "
    "found. Read these in the new edition."
)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Compare the texts of two editions of a manual, and list the facts that cite changed passages."
    parser.epilog = (
        "Exit codes: 0 no difference. 1 differences. 2 incorrect usage, or a file that is not the text of a manual."
    )
    parser.add_argument("old", type=a_path, metavar="OLD", help="the edition that the spec describes: text or PDF")
    parser.add_argument("new", type=a_path, metavar="NEW", help="the new edition")
    parser.add_argument(
        "--family", metavar="FAMILY", help="family that the manual describes (default: the one named on its first page)"
    )
    add_specs_option(parser, "")


@dataclass(frozen=True)
class _ChangedPassage:
    """A passage with the facts whose value or name appears in it, and the number of all facts of its section.

    ``section_names`` are the names by which facts cite the section.
    """

    passage: Passage
    section_names: frozenset[str]
    facts: Sequence[Citing]
    facts_of_section: int


def run(arguments: argparse.Namespace) -> int:
    """Print the passages in which two texts differ, with the facts that cite them. The exit code is 1 if there are any.

    Raises:
        CommandError: A manual cannot be read, or the family is not known.
    """
    from ..reread.facts import facts_with_citations
    from ..reread.passages import differing_passages, numbers_changed, same_language
    from ..reread.ranking import TouchedFacts
    from ..reread.sections import NoText, read_manual
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
        print("\n".join(_text_lines(family, changed_passages, facts, compares_words=compares_words)))
    return 1 if changed_passages else 0


def _family_of_manual(specs: Sequence[Path], name: str | None, old: Manual) -> Family:
    """Return the family of this name, or else the family that the manual names on its first page.

    Raises:
        CommandError: There are problems in the specs (exit code 1), or the family is not known (exit code 2).
    """
    from ..loading.library import load_families

    families, report = load_families(specs)
    if report:
        raise print_problems(report)
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

    Facts cite these titles, but the text may contain them in another language. The page is the same.
    """
    contents = family.document.data["manual"].get("contents", {})
    headings = [(title, heading) for title, heading in contents.items() if not title[0].isdigit()]
    return {heading["page"]: title for title, heading in headings if "page" in heading}


def _passage_with_facts(
    passage: Passage, touched_facts: TouchedFacts, old: Manual, titles_by_page: Mapping[int, str]
) -> _ChangedPassage:
    """Return a changed passage with the facts of its section that it concerns, and the number of all of them.

    Facts may cite the section by its number, by the number of a following section without a heading in the text, or by
    the title of an unnumbered section on its page.
    """
    section = passage.section
    section_names = {section.number, *old.without_heading_after(section.number)}
    # Without a title on its page, this adds the number again. No section is on page 0.
    section_names.add(titles_by_page.get(section.page or 0, section.number))
    facts, number_of_facts = touched_facts.touched_by(passage, section_names)
    return _ChangedPassage(
        passage=passage,
        section_names=frozenset(section_names),
        facts=facts,
        facts_of_section=number_of_facts,
    )


def _text_lines(
    family: Family, changed_passages: Sequence[_ChangedPassage], facts: Sequence[Citing], *, compares_words: bool
) -> Iterator[str]:
    """Yield the changed passages by section, each with its facts, and how many of all ``facts`` cite these sections.

    ``compares_words`` is false if only numbers were compared, because the texts have few words in common.
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
            facts_by_change: dict[tuple[Sequence[str], Sequence[str]], set[str]] = {}
            yield f"\n{heading}"
        change = (changed_passage.passage.old, changed_passage.passage.new)
        yield from _passage_lines(changed_passage, facts_by_change.setdefault(change, set()))
    sections = {changed_passage.passage.section.number for changed_passage in changed_passages}
    cited_names = {name for changed_passage in changed_passages for name in changed_passage.section_names}
    citing_facts = [fact for fact in facts if not fact.sections.isdisjoint(cited_names)]
    yield ""
    places = f"{count_with_unit(len(changed_passages), 'passage')} in {count_with_unit(len(sections), 'section')}"
    yield f"{places}, cited by {len(citing_facts):,} of {len(facts):,} facts"
    yield _LIMITS_OF_REREAD


def _passage_lines(changed_passage: _ChangedPassage, listed_paths: set[str]) -> Iterator[str]:
    """Yield the old and the new text of a passage, and the facts that cite the place.

    Equal facts are printed once, with all their lines. The rest of the section's facts are only counted.
    ``listed_paths`` are the paths of the facts listed before for the same change in this section. They are not listed
    again, and the paths of the facts listed now are added.
    """
    yield ""
    old_text, new_text = changed_passage.passage.shown
    for edition, passage_text in (("old", old_text), ("new", new_text)):
        if passage_text:
            yield f"  {edition}: {_shorten_text(passage_text)}"
    if not changed_passage.facts_of_section:
        yield "  no fact in the spec cites this place"
        return
    groups = _groups_of_equal_facts(changed_passage.facts)[:_MOST_FACTS]
    is_repeated = bool(listed_paths)
    new_groups = [group for group in groups if not listed_paths.issuperset(fact.path for fact in group)]
    for first_fact, *other_facts in new_groups:
        other_lines = [str(line_number) for line_number in sorted({fact.line for fact in other_facts})]
        noun = "line" if len(other_lines) == 1 else "lines"
        others_text = f", also in {noun} {joined_lines(other_lines)}" if other_lines else ""
        yield f"  {first_fact.shown}{others_text}"
    listed_facts = [fact for group in groups for fact in group]
    listed_paths.update(fact.path for fact in listed_facts)
    if is_repeated:
        yield f"  {'and ' if new_groups else ''}the facts listed above for the same change"
        return
    unlisted = changed_passage.facts_of_section - len(listed_facts)
    if unlisted:
        noun = "other fact" if listed_facts else "fact"
        yield f"  and {count_with_unit(unlisted, noun)} from this section"


def _groups_of_equal_facts(facts: Sequence[Citing]) -> list[list[Citing]]:
    """Return facts that follow each other with the same key and value as one group, such as a wait after each step."""
    from ..reread.ranking import key_of

    def key_and_value(fact: Citing) -> object:
        return key_of(fact), fact.value

    return [list(group) for _, group in groupby(facts, key_and_value)]


def _shorten_text(text: str) -> str:
    """Return the text with at most ``_LONGEST`` characters, cut with three dots."""
    return text if len(text) <= _LONGEST else text[: _LONGEST - len("...")] + "..."


def _as_data(family: Family, changed_passages: Sequence[_ChangedPassage], *, compares_words: bool) -> Mapping[str, Any]:
    """Return the changed passages in the form that ``--json`` prints."""
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
        "old": " ".join(passage.old),
        "new": " ".join(passage.new),
        "facts": facts_data(changed_passage.facts),
        "facts_of_section": changed_passage.facts_of_section,
    }
