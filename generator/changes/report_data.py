"""Changes as data, in the shape of ``language/diff.schema.json``."""

from __future__ import annotations

from typing import Any

from .change import Change
from .impact import OUTPUTS, Impact
from .report import Found

VERSION = 2


def as_data(found: Found) -> dict[str, Any]:
    """Return the output of ``codewheel diff --json``."""
    counts = {impact.word: sum(change.impact is impact for change in found.changes) for impact in Impact if impact}
    return {
        "version": VERSION,
        "impact": found.impact.word,
        "counts": counts,
        "changes": [change_data(change) for change in found.changes],
        "generated": {"files": found.files.count, "changed": list(found.files.changed)} if found.files else None,
        "packages": [
            {"name": item.name, "old": item.old, "stated": item.stated, "due": item.due, "new": item.new}
            for item in found.packages
        ],
        "notices": list(found.notices),
    }


def change_data(change: Change) -> dict[str, Any]:
    """Return one change as data."""
    impacts = {name: impact.word for name, impact in zip(OUTPUTS, change.rule.impacts, strict=True)}
    return {
        "family": change.family,
        "rule": change.rule.name,
        "impact": change.impact.word,
        "outputs": impacts,
        "path": change.path,
        "text": change.text,
        "old": change.old,
        "new": change.new,
        "order_codes": list(change.codes),
        "reach": change.reach,
        "names": dict(change.names),
    }
