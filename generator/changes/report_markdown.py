"""Changes as a section of a changelog in Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..say.markdown import code as in_code
from ..say.markdown import text
from .change import Change
from .impact import Impact
from .report import Found, about, versions

_TITLES = {
    Impact.BREAKING: "Breaking",
    Impact.BEHAVIOUR: "Behaviour",
    Impact.COMPATIBLE: "Compatible",
    Impact.DOCUMENTATION: "Documentation",
}


def as_markdown(found: Found) -> str:
    """Return the output of ``codewheel diff --markdown``: a heading for each package, family and impact."""
    lines = [f"## {'; '.join(map(versions, found.packages)) or 'Changes'}", ""]
    lines += [line for notice in found.notices for line in (text(notice), "")]
    for family in dict.fromkeys(change.family for change in found.changes):
        lines += [f"### {text(family)}", ""]
        lines += _family([change for change in found.changes if change.family == family])
    if not found.changes:
        lines += ["No differences.", ""]
    if found.changes and found.files is not None:
        lines += [f"{len(found.files.changed)} of {found.files.count} generated files change.", ""]
    return "\n".join(lines).rstrip()


def _family(changes: Sequence[Change]) -> Iterator[str]:
    for impact, title in _TITLES.items():
        here = [change for change in changes if change.impact is impact]
        if here:
            yield from (f"#### {title}", "", *map(_item, here), "")


def _item(change: Change) -> str:
    return f"- {text(change.text)} ({in_code(change.rule.name)}): {_about(change)}"


def _about(change: Change) -> str:
    said = about(change, "\0{}\0").split("\0")
    return "".join(in_code(piece) if index % 2 else _kept(piece) for index, piece in enumerate(said))


def _kept(piece: str) -> str:
    """Return escaped text with its leading and trailing space."""
    start, end = (" " if edge == " " else "" for edge in (piece[:1], piece[-1:]))
    return f"{start}{text(piece)}{end}" if piece.strip() else piece
