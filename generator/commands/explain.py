"""``codewheel explain``: describe a rule of ``check`` or ``diff``."""

from __future__ import annotations

import json
import textwrap
from typing import TYPE_CHECKING, TypedDict

from .cli import Parser
from .terminal import CommandError

if TYPE_CHECKING:
    import argparse

EXAMPLES = ("codewheel explain", "codewheel explain register-gone")
#: Rules about several files, for which the tests have no single broken file to show as an example.
_SEVERAL_FILES = {
    "coverage-file": "the coverage file next to a spec differs from the file that 'check --coverage --write' would "
    "write.",
    "overlay-change": "a change in an overlay or edition has keys that do not belong to its kind.",
    "overlay-conflict": "two overlays change the same location.",
    "overlay-unused": "a change in an overlay has no effect, or sets, adds or removes something that does not exist.",
    "readings-disagree": "the second reading of a manual differs from the spec. The manual decides. If the manual "
    "prints both, record an erratum with 'readings'.",
    "words-disagree": "a sheet of turning words, filled in from the manual, has a different word than the text of the "
    "spec. The manual decides.",
    "words-outdated": "a text has changed since its sheet of turning words was filled in, or a gap has no valid word.",
}


class RuleExample(TypedDict):
    """A problem in a small spec: the message, and the lines of the spec around it."""

    message: str
    lines: list[str]


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = (
        "Explain a rule of check with an example, or a rule of diff with its impact and the reason for it."
    )
    parser.add_argument("rule", nargs="?", metavar="RULE", help="name of the rule (default: list all rules)")


def run(arguments: argparse.Namespace) -> int:
    """Print the description of the rule, or the list of all rules.

    Raises:
        CommandError: There is no such rule. The exit code is 2.
    """
    print(explain(arguments.rule))
    return 0


def explain(name: str | None) -> str:
    """Return the description of a rule or, if no name is given, the list of all rules.

    The same name can belong to a rule of ``check`` and a rule of ``diff``. Then both are described.

    Raises:
        CommandError: There is no such rule. The exit code is 2.
    """
    from ..changes.rules import RULES
    from ..language.problems import suggest_word

    examples = rules_of_check()
    if name is None:
        return _list_rules(examples)
    descriptions = [*_describe_rule_of_check(name, examples), *_describe_rule_of_diff(name)]
    if not descriptions:
        names_of_rules = [*examples, *_SEVERAL_FILES, *RULES]
        hint = suggest_word(name, names_of_rules) or "; codewheel explain lists the rules"
        raise CommandError(f"there is no rule '{name}'{hint}", 2)
    return "\n\n".join(descriptions)


def rules_of_check() -> dict[str, RuleExample]:
    """Return an example of each rule of ``check``, by the name of the rule.

    Rules about several files have no example.
    """
    from importlib.resources import files

    rules_file = files("codewheel.language").joinpath("rules.json")
    examples: dict[str, RuleExample] = json.loads(rules_file.read_text(encoding="utf-8"))
    return examples


def _list_rules(examples: dict[str, RuleExample]) -> str:
    """Return all rules: the rules of diff with their impacts and conditions, and the names of the rules of check.

    ``examples`` contains an example of each rule of check about a single file, by the name of the rule.
    """
    from ..changes.rules import RULES
    from ..say import WIDTH, wrap_text

    lines = ["Rules of diff:", ""]
    for rule in RULES.values():
        # The columns are as wide as the longest name and the longest impact.
        name_and_impact = f"{rule.name:<22} {rule.impact.word:<14} "
        indent = " " * len(name_and_impact)
        lines.append(wrap_text(rule.when, WIDTH, prefix=indent, first=name_and_impact))
    names_of_check_rules = sorted([*examples, *_SEVERAL_FILES])
    wrapped_names = textwrap.fill(", ".join(names_of_check_rules), WIDTH, break_on_hyphens=False)
    lines += ["", "Rules of check:", "", wrapped_names]
    return "\n".join(lines)


def _describe_rule_of_check(name: str, examples: dict[str, RuleExample]) -> list[str]:
    """Return the description of a rule of check as one text, or an empty list if there is no such rule."""
    from ..say import WIDTH, wrap_text

    if name in _SEVERAL_FILES:
        return [wrap_text(_SEVERAL_FILES[name], WIDTH, prefix="  ", first=f"{name}, a rule of check: ")]
    if name not in examples:
        return []
    example = examples[name]
    message = wrap_text(f"{example['message']}.", WIDTH, prefix="  ")
    heading = f"{name}, a rule of check. Example message:"
    return ["\n".join([heading, message, "", "for these lines:", "", *example["lines"]])]


def _describe_rule_of_diff(name: str) -> list[str]:
    """Return a rule of diff with its impact on each output and its reason, or an empty list if there is none."""
    from ..changes.rules import OUTPUTS, RULES, TITLES
    from ..say import WIDTH, wrap_text

    rule = RULES.get(name)
    if rule is None:
        return []
    heading = wrap_text(f"{rule.when}.", WIDTH, prefix="  ", first=f"{rule.name}: ")
    impact_lines = []
    for output, impact in zip(OUTPUTS, rule.impacts, strict=True):
        impact_lines.append(f"  {TITLES[output]:<7} {impact.word}")
    reason = wrap_text(rule.why, WIDTH, prefix="  ")
    return ["\n".join([heading, *impact_lines, reason])]
