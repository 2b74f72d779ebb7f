"""The page of rules: those of ``check``, each with a test spec that breaks it, and those of ``diff`` with reasons.

``make rules-page`` writes the page, and the examples for ``codewheel explain`` as JSON.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path

from codewheel.changes.rules import RULES, TITLES
from codewheel.say.markdown import code, escape, table

ROOT = Path(__file__).resolve().parents[2]
PAGE, DATA = ROOT / "docs/transcribe/rules.md", ROOT / "generator" / "language" / "rules.json"
FOLDERS = ("tests/check/broken", "tests/check/broken_model", "tests/masters/broken")
_EXPECTED = re.compile(r"^# expect: (\d+):(\d+): ([\w-]+): (.*)$", re.MULTILINE)
_WIDEST = 110

_INTRODUCTION = """\
<!-- Generated from the broken specs of the tests by: make rules-page -->

# Rules

`codewheel check` reports each problem with its rule: `FILE:LINE:COLUMN: RULE: MESSAGE`. For each rule, this page shows
the message, which includes the fix, and the faulty line from the shortest test spec that breaks the rule. The tests
compare every message literally.

The [rules of diff](#rules-of-diff), which determine the impact of a change, are at the end of the page."""


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
    """Return the example of each rule: the spec with the fewest problems, and the shortest of these."""
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


def rules_page() -> str:
    parts = [
        _INTRODUCTION,
        "## Rules of check",
        *map(_example_section, examples().values()),
        "## Rules of diff",
        _diff_rules(),
    ]
    return "\n\n".join(parts) + "\n"


def _example_section(example: Example) -> str:
    yaml_lines = "\n".join(example.lines)
    path = example.spec.relative_to(ROOT).as_posix()
    head = f"### {escape(example.rule)}\n\n{escape(example.message)}"
    return f"{head}\n\n[`{example.spec.name}`](../../{path}):\n\n```yaml\n{yaml_lines}\n```"


def _diff_rules() -> str:
    rows = []
    for rule in RULES.values():
        impacts = [impact.word for impact in rule.impacts]
        rows.append((code(rule.name), escape(rule.when), *impacts, escape(rule.why)))
    return table(["Rule", "When", *TITLES.values(), "Why"], rows)


def _shortened(line: str) -> str:
    return line if len(line) <= _WIDEST else line[: _WIDEST - 1] + "…"


def rules_data() -> str:
    """Return the message and the lines of each example, as JSON."""
    data = {rule: {"message": example.message, "lines": example.lines} for rule, example in examples().items()}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    PAGE.write_text(rules_page(), encoding="utf-8")
    DATA.write_text(rules_data(), encoding="utf-8")
