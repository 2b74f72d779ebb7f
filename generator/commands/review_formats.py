"""Findings of ``check`` and ``diff`` for review tools (GitHub and SARIF 2.1.0), and their places in specs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from .. import __version__

if TYPE_CHECKING:
    from ..language.document import Document
    from ..language.document import Path as SpecPath

_SARIF_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
#: Levels of SARIF by levels of GitHub.
_SARIF_LEVELS = {"error": "error", "warning": "warning", "notice": "note"}


@dataclass(frozen=True, slots=True)
class ReviewFinding:
    """A finding at a place of a file. ``level`` is ``error``, ``warning`` or ``notice``."""

    file: str
    line: int
    column: int
    rule: str
    message: str
    level: str = "error"


def as_review(findings: Sequence[ReviewFinding], form: str) -> str:
    """Return findings in the format ``github`` or ``sarif``, without a final line break."""
    if form == "github":
        return "\n".join(map(_workflow_command, findings))
    return json.dumps(_sarif_log(findings), indent=2, ensure_ascii=False)


def _workflow_command(finding: ReviewFinding) -> str:
    """Return a finding as a GitHub workflow command, in which line breaks and percent signs are escaped.

    For example ``::error file=x24.yaml,line=3,col=5,title=not-allowed::the message``.
    """
    # In the properties, a comma or a colon would end the value.
    file = _escape_workflow_text(finding.file, ",:")
    rule = _escape_workflow_text(finding.rule, ",:")
    properties = f"file={file},line={finding.line},col={finding.column},title={rule}"
    return f"::{finding.level} {properties}::{_escape_workflow_text(finding.message)}"


def _escape_workflow_text(text: str, more_characters: str = "") -> str:
    """Return a text in which line breaks, percent signs and ``more_characters`` are escaped, such as ``%0A``."""
    # The percent sign comes first, so that the percent signs of the escapes are not escaped.
    for character in f"%\r\n{more_characters}":
        text = text.replace(character, f"%{ord(character):02X}")
    return text


def _sarif_log(findings: Sequence[ReviewFinding]) -> dict[str, object]:
    rule_names = sorted({finding.rule for finding in findings})
    driver = {"name": "codewheel", "version": __version__, "rules": [{"id": name} for name in rule_names]}
    results = [_sarif_result(finding) for finding in findings]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return {"$schema": _SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}


def _sarif_result(finding: ReviewFinding) -> dict[str, object]:
    """Return a finding as a SARIF result."""
    location = {
        "artifactLocation": {"uri": _uri_of_file(finding.file)},
        "region": {"startLine": finding.line, "startColumn": finding.column},
    }
    return {
        "ruleId": finding.rule,
        "level": _SARIF_LEVELS[finding.level],
        "message": {"text": finding.message},
        "locations": [{"physicalLocation": location}],
    }


def _uri_of_file(file: str) -> str:
    path = Path(file)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())


_PATH_STEPS = re.compile(r"[^.\[\]]+")


def place_in_spec(document: Document, text: str) -> SpecPath:
    """Return the place of a path of keys and names, such as ``registers.mode.fields``, as far as it exists in a spec.

    In the result, indices replace the names of list items: ``("registers", 3, "fields")``.
    """
    from ..language.schema_check import remaining_value_at

    path: SpecPath = ()
    for step in _PATH_STEPS.findall(text):
        paths_to_step = list(_paths_to_step(step, remaining_value_at(document.data, path)))
        if not paths_to_step:
            break
        # The first path is the shortest.
        path = (*path, *paths_to_step[0])
    return path


def _paths_to_step(step: str, node: Any) -> Iterator[SpecPath]:
    """Yield the paths from ``node`` to a key or name in it: directly, or one level deeper if it is a map.

    Paths of changes leave out some keys, so ``position`` in ``{"fields": [{"name": "position"}]}`` is at
    ``("fields", 0)``.
    """
    yield from _children_named(step, node)
    if isinstance(node, dict):
        for key, inner_node in node.items():
            yield from ((key, *path) for path in _children_named(step, inner_node))


def _children_named(step: str, node: Any) -> Iterator[SpecPath]:
    """Yield the path ``(index,)`` to each item of a list with this name, or ``(key,)`` for a map with this key."""
    from ..language.document import label_of

    if isinstance(node, list):
        yield from ((index,) for index, child in enumerate(node) if label_of(child) == step)
    elif isinstance(node, dict) and step in node:
        yield (step,)
