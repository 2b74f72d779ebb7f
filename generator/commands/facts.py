"""``codewheel facts``: list the facts that cite a page or a section of a manual."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..say import count_with_unit
from .cli import Parser, add_specs_option
from .terminal import CommandError, error_after_printing, print_json

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from ..loading.library import Family
    from ..reread.facts import CitingFact

EXAMPLES = ("codewheel facts my_encoder --section 6.2", "codewheel facts my_encoder --section 1 --json")
JSON_VERSION = 1


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "List the facts of a family that cite a page or a section of its manual."
    parser.add_argument("family", metavar="FAMILY", help="a family name as shown by list")
    parser.add_argument("--page", type=int, metavar="NUMBER", help="facts that cite this page")
    parser.add_argument("--section", metavar="NUMBER", help="facts that cite this section, such as 6.4")
    add_specs_option(parser, "")


def run(arguments: argparse.Namespace) -> int:
    """List the facts that cite a page, a section, or both. The exit code is 1 if there are none.

    Raises:
        CommandError: The family does not exist, or neither page nor section was given.
    """
    from ..reread.facts import facts_with_citations
    from .read_specs import specs_to_judge

    paths = specs_to_judge(arguments.specs, "facts FAMILY").paths
    page = arguments.page
    section = arguments.section
    if page is None and section is None:
        raise CommandError("give --page NUMBER or --section NUMBER, or both", 2)
    facts = facts_with_citations(family_named(arguments.family, paths).document)
    if page is not None:
        facts = [fact for fact in facts if page in fact.pages]
    if section is not None:
        facts = [fact for fact in facts if section in fact.sections]
    if arguments.json:
        print_json({"version": JSON_VERSION, "facts": facts_data(facts)})
    else:
        for fact in facts:
            print(fact.summary)
        print(f"{count_with_unit(len(facts), 'fact')} from {_section_and_page(section, page)}")
    return 0 if facts else 1


def family_named(name: str, paths: Sequence[Path]) -> Family:
    """Return the family of this name.

    Raises:
        CommandError: The specs have problems (exit code 1), or the family does not exist (exit code 2).
    """
    from ..loading.library import load_families

    families, report = load_families(paths)
    if report:
        raise error_after_printing(report)
    families_by_name = {family.device.name: family for family in families}
    if name.lower() not in families_by_name:
        raise CommandError(f"'{name}' is not a family; known: {', '.join(families_by_name)}", 2)
    return families_by_name[name.lower()]


def _section_and_page(section: str | None, page: int | None) -> str:
    if section is None:
        return f"page {page}"
    if page is None:
        return f"section {section}"
    return f"section {section} page {page}"


def facts_data(facts: Iterable[CitingFact]) -> list[Mapping[str, Any]]:
    """Return facts as plain data for ``--json``."""
    return [{"file": fact.file, "line": fact.line, "path": fact.path, "value": fact.value} for fact in facts]
