"""Rule for the history of a manual's revisions."""

from __future__ import annotations

from ..problems import DocumentReport, quoted
from .walk import Spec, explained, items, mapping


def revision_in_history(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the history of a manual lists its own revision, unless an erratum explains it."""
    revisions = [str(history_row.get("revision")) for _, history_row in items(raw, "manual", "history")]
    revision = mapping(spec, "manual").get("revision")
    is_repeated = len(set(revisions)) < len(revisions)  # Reported by another rule.
    if not revisions or is_repeated or not revision or revision in revisions:
        return
    if explained(report.document, "manual", "history"):
        return
    problem = f"the manual has revision {quoted(revision)}, but its history lists {', '.join(revisions)}"
    remedy = "correct one of the two, or add an erratum that affects manual.history if the manual prints this"
    report.add("revision-not-in-history", ("manual", "revision"), f"{problem}; {remedy}")
