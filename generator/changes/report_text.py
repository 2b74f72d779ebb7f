"""Changes as text for a terminal of 80 columns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..say.lines import WIDTH, wrapped
from ..say.numbers import counted, first_of
from .change import Change
from .impact import Impact
from .report import DiffResult, about, totals, versions

_COLUMN = 17


def as_text(findings: DiffResult) -> str:
    """Return the output of ``codewheel diff``."""
    lines = list(findings.notices)
    for family in dict.fromkeys(change.family for change in findings.changes):
        family_changes = [change for change in findings.changes if change.family == family]
        lines.append(family)
        for change in sorted(family_changes, key=lambda change: (-change.impact, change.rule.is_renaming)):
            if change.impact > Impact.DOCUMENTATION:
                lines += _change(change)
        lines += _words([change for change in family_changes if change.impact is Impact.DOCUMENTATION])
    lines.append(totals(findings.changes) if findings.changes else "no differences")
    if findings.changes:
        lines += _result(findings)
    return "\n".join(lines)


def _change(change: Change) -> Iterator[str]:
    indent = " " * _COLUMN
    yield wrapped(change.text, WIDTH, indent, f"  {change.rule.word:<13}  ")
    yield wrapped(f"{about(change)} [{change.rule.name}]", WIDTH, indent)


def _words(changes: Sequence[Change]) -> Iterator[str]:
    """Yield the documentation changes: the places of the first few, and the number of the others."""
    for rule in dict.fromkeys(change.rule for change in changes):
        changes_of_rule = [change for change in changes if change.rule is rule]
        texts = first_of([_place(change) for change in changes_of_rule], between="; ")
        yield wrapped(f"{texts} [{rule.name}]", WIDTH, " " * _COLUMN, f"  {rule.word:<13}  ")


def _place(change: Change) -> str:
    path = change.path.removeprefix("interfaces.").replace(".layouts.", ".")
    return path if change.rule.name in ("words", "source") else change.text


def _result(findings: DiffResult) -> Iterator[str]:
    """Yield the line about generated files and versions."""
    parts = []
    if findings.files is not None:
        count = len(findings.files.changed)
        parts.append(f"{count} of {counted(findings.files.count, 'file')} change{'s' * (count == 1)}")
    parts += map(versions, findings.packages)
    if parts:
        yield wrapped(f"generated: {'; '.join(parts)}", WIDTH, "  ", "")
