"""The errata of a manual: which of them concern a part of the spec, and what they say."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum
from .changed import change_in_words
from .text import Ref, Said, said
from .words import sentence

#: The evidence of an erratum is told beside code up to so many characters, and at any length where data is at stake.
_SHORT = 100


def errata(device: Device, *paths: str, without: Collection[str] = (), wording: bool = False) -> tuple[Erratum, ...]:
    """The errata of these parts of the spec or of something inside them, but not of the parts ``without``.

    Those of wording alone are for pages that show a manual as it is.
    """

    below, below_without = (tuple(f"{place}." for place in places) for places in (paths, without))
    return tuple(
        item
        for item in device.errata
        if (wording or item.severity != "wording")
        and any(
            (other in paths or other.startswith(below)) and other not in without and not other.startswith(below_without)
            for other in item.affects
        )
    )


def reference(item: Erratum) -> Ref:
    return Ref("erratum", item.name, item.name)


def erratum(item: Erratum, *, whole: bool = False) -> Said:
    """What is printed and what is used; and the evidence, where it is short, wrong bytes could be sent or it is told
    as a whole.

    Of a change by an overlay or another edition: what the spec has, what is here, and always why.
    In brief what is used stays where wrong bytes could be sent and nobody knows which they are.
    """
    if item.overlay or item.edition:
        return _change(item)
    at_stake = item.severity == "wrong_data"
    why = f" Why: {sentence(item.why)}" if item.why and (whole or at_stake or len(item.why) <= _SHORT) else ""
    used = f"Used: {sentence(item.used)}"
    used += f" Only with {item.only}." if item.only else ""
    standing = f"{item.status}, {item.severity.replace('_', ' ')}"
    brief = used if at_stake and item.status == "open" else ""
    text = f"Printed: {sentence(item.printed)} {used}{why}"
    return Said((text,), f"Erratum {item.name} ({standing})", item.source, brief)


def _change(item: Erratum) -> Said:
    label = f"Overlay {item.overlay}" if item.overlay else f"Edition {item.edition}"
    if item.edition.startswith("before "):
        label = f"Editions {item.edition}"
    what, value = change_in_words(item.printed), str(item.used)
    if item.used == NOT_KNOWN:
        changed = f"Not known {'there' if item.edition else 'here'}: {what}"
    elif item.used == LEFT_OUT and item.edition:
        changed = f"Not there: {what}"
    elif item.printed.endswith(".note") and item.edition:
        changed = f"Instead of {what}: {sentence(value)}"
    else:
        changed = f"The spec has {what}; {'there' if item.edition else 'here'} it is {value}"
    # Beside code it is enough that another edition differs: what the code does is right for this one.
    differs = "may differ" if item.used == NOT_KNOWN else "differs"
    brief = f"{differs}; the end of this file says how." if item.edition else None
    return replace(said(f"{sentence(changed)} Why: {sentence(item.why)}", label=label, source=item.source), brief=brief)
