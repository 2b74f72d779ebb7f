"""Errata of a manual: which ones affect a part of the spec, and their texts."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum
from .changed import change_in_words
from .text import Said, said
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

    below, below_without = (tuple(f"{place}." for place in places) for places in (paths, without))
    return tuple(
        item
        for item in device.errata
        if (wording or item.severity != "wording")
        and any(
            other in exactly
            or (
                (other in paths or other.startswith(below))
                and other not in without
                and not other.startswith(below_without)
            )
            for other in item.affects
        )
    )


def erratum(item: Erratum, *, whole: bool = False) -> Said:
    """Return an erratum in three labelled parts: the printed text, the value used, and the reason.

    The reason is omitted if it is long, unless ``whole`` is set or wrong bytes could be sent. A change by an overlay
    or another edition always has its reason. The short form keeps the value used if wrong bytes could be sent and the
    erratum is open.
    """
    if item.overlay or item.edition:
        return _change(item)
    at_stake = item.severity == "wrong_data"
    with_reason = whole or at_stake or len(item.why) <= _SHORT
    used = sentence(item.used) + (f" {sentence(f'Only with {item.only}')}" if item.only else "")
    brief = f"Used: {used}" if at_stake and item.status == "open" else ""
    label = f"Erratum {item.name} ({item.status}, {item.severity.replace('_', ' ')})"
    parts = _labelled(("Printed", item.printed), ("Used", used), ("Why", item.why if with_reason else ""))
    return Said((), label, item.source, brief, tuple(parts))


def _labelled(*parts: tuple[str, str]) -> Iterator[Said]:
    return (said(text, label=label) for label, text in parts if text)


def _change(item: Erratum) -> Said:
    label = f"Overlay {item.overlay}" if item.overlay else f"In edition {item.edition}"
    if item.edition.startswith("before "):
        label = f"Before edition {item.edition.removeprefix('before ')}"
    # Next to code, a hint that another edition differs is enough, since the code is correct for this edition.
    differs = "may differ" if item.used == NOT_KNOWN else "differs"
    brief = f"{differs}. See the encoder's page." if item.edition else None
    return Said((), label, item.source, brief, tuple(_labelled(*changed(item), ("Why", item.why))))


def changed(item: Erratum) -> Iterator[tuple[str, str]]:
    """Yield a change by an overlay or another edition as labelled texts: the part, and its changed content."""
    what = change_in_words(item.printed)
    if item.used == NOT_KNOWN:
        yield "Not known", what
    elif item.used == LEFT_OUT and item.edition:
        yield "Not present", what
    elif item.printed.endswith(".note") and item.edition:
        yield "Instead of", what
        yield "Text", f"{item.used}"
    else:
        yield "In the spec", what
        yield "In that edition" if item.edition else "With the overlay", f"{item.used}"
