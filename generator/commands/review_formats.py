"""Findings of ``check`` and ``diff`` for review tools: workflow commands of GitHub, and SARIF 2.1.0."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from .. import __version__

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
    place = f"file={file},line={finding.line},col={finding.column},title={rule}"
    return f"::{finding.level} {place}::{_escape_workflow_text(finding.message)}"


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
