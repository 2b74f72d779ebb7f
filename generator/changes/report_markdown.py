"""Changes as a section of a changelog in Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..say.markdown import code as in_code
from ..say.markdown import text
from .change import Change
from .impact import Impact
from .report import DiffResult, about, versions

_TITLES = {
    Impact.BREAKING: "Breaking",
    Impact.BEHAVIOUR: "Behaviour",
    Impact.COMPATIBLE: "Compatible",
    Impact.DOCUMENTATION: "Documentation",
}


def as_markdown(findings: DiffResult) -> str:
    """Return the output of ``codewheel diff --markdown``: a heading for each package, family and impact."""
    lines = [f"## {'; '.join(map(versions, findings.packages)) or 'Changes'}", ""]
    lines += [line for notice in findings.notices for line in (text(notice), "")]
    for family in dict.fromkeys(change.family for change in findings.changes):
        lines += [f"### {text(family)}", ""]
        lines += _family([change for change in findings.changes if change.family == family])
    if not findings.changes:
        lines += ["No differences.", ""]
    if findings.changes and findings.files is not None:
        lines += [f"{len(findings.files.changed)} of {findings.files.count} generated files change.", ""]
    return "\n".join(lines).rstrip()


def _family(changes: Sequence[Change]) -> Iterator[str]:
    for impact, title in _TITLES.items():
        changes_of_impact = [change for change in changes if change.impact is impact]
        if changes_of_impact:
            yield from (f"#### {title}", "", *map(_item, changes_of_impact), "")


def _item(change: Change) -> str:
    return f"- {text(change.text)} ({in_code(change.rule.name)}): {_about(change)}"


def _about(change: Change) -> str:
    pieces = about(change, "\0{}\0").split("\0")  # Prose and code in turn.
    pieces[::2] = map(_escaped, pieces[::2])
    pieces[1::2] = map(in_code, pieces[1::2])
    return "".join(pieces)


def _escaped(piece: str) -> str:
    """Return escaped text with its leading and trailing space."""
    start = " " if piece.startswith(" ") else ""
    end = " " if piece.endswith(" ") else ""
    return f"{start}{text(piece)}{end}" if piece.strip() else piece
