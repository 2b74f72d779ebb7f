"""Errata of a manual: which ones affect a part of the spec, and their texts."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum
from .changed import change_in_words
from .text import Statement, statement
from .words import sentence

#: Longest reason, in characters, that is shown next to code. Errata with wrong data always have their reason.
_SHORT = 100


def errata(
    device: Device, *paths: str, without: Collection[str] = (), exactly: Collection[str] = (), wording: bool = False
) -> tuple[Erratum, ...]:
    """Return the errata about these parts of the spec or anything inside them, except the parts ``without``.

    An erratum about a part in ``exactly`` is about that part as a whole. Errata about wording are included only on
    request, for pages that show the text of a manual.
    """

    def is_about(affected: str) -> bool:
        return affected in exactly or (_is_within(affected, paths) and not _is_within(affected, without))

    candidates = [correction for correction in device.errata if wording or correction.severity != "wording"]
    return tuple(correction for correction in candidates if any(map(is_about, correction.affects)))


def _is_within(path: str, parts: Collection[str]) -> bool:
    """Return whether a path is that of one of the parts, or of something inside it."""
    return path in parts or path.startswith(tuple(f"{part}." for part in parts))


def erratum(correction: Erratum, *, whole: bool = False) -> Statement:
    """Return an erratum in three labelled parts: the printed text, the value used, and the reason.

    The reason is omitted if it is long, unless ``whole`` is set or wrong bytes could be sent. A change by an overlay
    or another edition always has its reason. The short form keeps the value used if wrong bytes could be sent and the
    erratum is open.
    """
    if correction.overlay or correction.edition:
        return _change(correction)
    at_stake = correction.severity == "wrong_data"
    with_reason = whole or at_stake or len(correction.why) <= _SHORT
    used = sentence(correction.used) + (f" {sentence(f'Only with {correction.only}')}" if correction.only else "")
    brief = f"Used: {used}" if at_stake and correction.status == "open" else ""
    label = f"Erratum {correction.name} ({correction.status}, {correction.severity.replace('_', ' ')})"
    parts = _labelled(("Printed", correction.printed), ("Used", used), ("Why", correction.why if with_reason else ""))
    return Statement((), label, correction.source, brief, tuple(parts))


def _labelled(*parts: tuple[str, str]) -> Iterator[Statement]:
    return (statement(text, label=label) for label, text in parts if text)


def _change(correction: Erratum) -> Statement:
    label = f"Overlay {correction.overlay}" if correction.overlay else f"In edition {correction.edition}"
    if correction.edition.startswith("before "):
        label = f"Before edition {correction.edition.removeprefix('before ')}"
    # Next to code, a hint that another edition differs is enough, since the code is correct for this edition.
    differs = "may differ" if correction.used == NOT_KNOWN else "differs"
    brief = f"{differs}. See the encoder's page." if correction.edition else None
    return Statement(
        (), label, correction.source, brief, tuple(_labelled(*changed(correction), ("Why", correction.why)))
    )


def changed(correction: Erratum) -> Iterator[tuple[str, str]]:
    """Yield a change by an overlay or another edition as labelled texts: the part, and its changed content."""
    change = change_in_words(correction.printed)
    if correction.used == NOT_KNOWN:
        yield "Not known", change
    elif correction.used == LEFT_OUT and correction.edition:
        yield "Not present", change
    elif correction.printed.endswith(".note") and correction.edition:
        yield "Instead of", change
        yield "Text", f"{correction.used}"
    else:
        yield "In the spec", change
        yield "In that edition" if correction.edition else "With the overlay", f"{correction.used}"
