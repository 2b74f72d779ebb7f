"""The pages of rules: rules of ``check``, each with a test spec that breaks it, and rules of ``diff`` with reasons.

``make rules-page`` writes the pages, and the examples for ``codewheel explain`` as JSON.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from codewheel.changes.rules import OUTPUTS, RULES, TITLES, ChangeRule, Impact
from codewheel.language.problems import join_words
from codewheel.say.text import code_span, escape, markdown_link, table

ROOT = Path(__file__).resolve().parents[2]
FOLDER, DATA = ROOT / "docs/transcribe", ROOT / "generator" / "language" / "rules.json"
#: First letters of the rules on each page, which has at most fifteen screens.
_LETTERS = (("a", "c"), ("d", "m"), ("n", "r"), ("s", "z"))
FOLDERS = ("tests/check/broken", "tests/check/broken_model", "tests/masters/broken")
_EXPECTED = re.compile(r"^# expect: (\d+):(\d+): ([\w-]+): (.*)$", re.MULTILINE)
_WIDEST = 110

_MADE_FROM = "<!-- Generated from the broken specs of the tests by: make rules-page -->"
_INTRODUCTION = """\
`codewheel check` reports each problem with its rule: `FILE:LINE:COLUMN: RULE: MESSAGE`. For each rule, these pages show
the message, which includes the fix, and the faulty line from the shortest test spec that breaks the rule. The tests
compare every message literally. `codewheel explain RULE` prints the same.

The [rules of diff](rules-of-diff.md) determine the impact of a change."""
_INTRODUCTION_OF_DIFF = """\
`codewheel diff` assigns each change to a rule, which determines its impact on each output. The impact on the pages is
always *documentation*. The [rules of check](rules.md) are on other pages."""


@dataclass(frozen=True)
class Example:
    """A problem in a test spec."""

    rule: str
    message: str
    spec: Path
    line: int
    problems: int

    @property
    def lines(self) -> list[str]:
        """Return the faulty line, preceded by the last line above it with less indentation."""
        lines = self.spec.read_text(encoding="utf-8").splitlines()
        faulty = lines[self.line - 1]
        depth = len(faulty) - len(faulty.lstrip())
        above = [line for line in lines[: self.line - 1] if len(line) - len(line.lstrip()) < depth]
        return [_shortened(line) for line in [*above[-1:], faulty]]


def examples() -> dict[str, Example]:
    """Return the example of each rule: the spec with the fewest problems, and the shortest among equals."""
    examples_by_rule: dict[str, list[Example]] = {}
    for spec in sorted(path for folder in FOLDERS for path in (ROOT / folder).glob("*.yaml")):
        expected_problems = _EXPECTED.findall(spec.read_text(encoding="utf-8"))
        for line, _, rule, message in expected_problems:
            examples_by_rule.setdefault(rule, []).append(
                Example(rule, message, spec=spec, line=int(line), problems=len(expected_problems))
            )
    return {rule: min(examples_by_rule[rule], key=_complexity) for rule in sorted(examples_by_rule)}


def _complexity(example: Example) -> tuple[int, int, int]:
    """Return a key by which the simplest example is the least: few problems, a short spec, and an early line."""
    return example.problems, example.spec.stat().st_size, example.line


def rules_pages() -> dict[str, str]:
    """Return the pages by file name: the list of the rules of ``check``, these rules, and those of ``diff``."""
    shown_examples = examples()
    list_items = []
    pages = {}
    for first, last in _LETTERS:
        page, title = f"rules-{first}-to-{last}.md", f"Rules of check: {first.upper()} to {last.upper()}"
        rules = [rule for rule in shown_examples if first <= rule[0] <= last]
        links = ", ".join(markdown_link(code_span(rule), f"{page}#{rule}") for rule in rules)
        list_items.append(f"- {markdown_link(title, page)}: {links}")
        sections = [_example_section(shown_examples[rule]) for rule in rules]
        pages[page] = [f"# {title}", f"The {markdown_link('list of rules', 'rules.md')} explains this page.", *sections]
    pages["rules.md"] = ["# Rules", _INTRODUCTION, "\n".join(list_items)]
    pages["rules-of-diff.md"] = ["# Rules of diff", _INTRODUCTION_OF_DIFF, *_diff_rules()]
    return {page: "\n\n".join([_MADE_FROM, *parts]) + "\n" for page, parts in pages.items()}


def _example_section(example: Example) -> str:
    yaml_lines = "\n".join(example.lines)
    path = example.spec.relative_to(ROOT).as_posix()
    head = f"## {escape(example.rule)}\n\n{escape(example.message)}"
    return f"{head}\n\n[`{example.spec.name}`](../../{path}):\n\n```yaml\n{yaml_lines}\n```"


def _diff_rules() -> Iterator[str]:
    """Yield a heading and a table for each combination of impacts, the gravest first."""
    rules_by_impacts: dict[tuple[Impact, ...], list[ChangeRule]] = {}
    for rule in RULES.values():
        rules_by_impacts.setdefault(rule.impacts, []).append(rule)
    for impacts in sorted(rules_by_impacts, key=lambda impacts: (max(impacts), *impacts), reverse=True):
        rows = [(code_span(rule.name), escape(rule.when), escape(rule.why)) for rule in rules_by_impacts[impacts]]
        yield f"## {_impacts_in_words(impacts)}"
        yield table(["Rule", "When", "Why"], rows)


def _impacts_in_words(impacts: Sequence[Impact]) -> str:
    """Return the impacts on all outputs but the pages: ``C and XML: breaking · Python: compatible``."""
    outputs_by_impact: dict[str, list[str]] = {}
    for impact, output in zip(impacts, OUTPUTS, strict=True):
        if output != "pages":
            outputs_by_impact.setdefault(impact.word, []).append(TITLES[output])
    return " · ".join(f"{join_words(outputs)}: {impact}" for impact, outputs in outputs_by_impact.items())


def _shortened(line: str) -> str:
    return line if len(line) <= _WIDEST else line[: _WIDEST - 1] + "…"


def rules_data() -> str:
    """Return the message and the lines of each example, as JSON."""
    data = {rule: {"message": example.message, "lines": example.lines} for rule, example in examples().items()}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    for page_name, content in rules_pages().items():
        (FOLDER / page_name).write_text(content, encoding="utf-8")
    DATA.write_text(rules_data(), encoding="utf-8")
