"""Output of ``codewheel check``, as text and as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..language.problems import Report
from ..say.numbers import counted
from . import placeholders
from .formats import Finding, as_review
from .look_up import read_line


def as_data(report: Report) -> dict[str, Any]:
    """Return the problems in the form that ``--json`` prints."""
    problems = [problem.to_json() for problem in report.shown]
    data = {"files": report.files, "passed_over": report.passed_over, "problems": problems}
    return data | {"placeholders": placeholders.as_data(report.files)}


def as_text(families: Sequence[str], report: Report, form: str = "text") -> str:
    """Return the problems as text, with the files read and a summary, or in a form for review tools.

    ``families`` are the names of all families.
    """
    if form in ("github", "sarif"):
        return as_review(
            [
                Finding(problem.file, problem.line, problem.column, problem.rule, problem.message)
                for problem in report.shown
            ],
            form,
        )
    lines = [problem.format() for problem in report.shown]
    lines += placeholders.notice(report.files)
    lines.append(read_line(families, report))
    if report:
        lines.append(counted(len(report), "problem"))
    elif families:
        names = ", ".join(families)
        lines.append(f"no problems in {len(families)} {'family' if len(families) == 1 else 'families'}: {names}")
    else:  # Some files define no family, such as those of masters.
        lines.append("no problems")
    return "\n".join(lines)
