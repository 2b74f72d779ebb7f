"""Facts that a manual does not state, on the page of an order code: denied only if no text of the manual has them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...model import Device, Interface
from ...say.evidence import Subject, document, mentions
from ...say.markdown import link
from ...say.text import BY_NAME, listed, statement


def unstated_facts(family: Device, interface: Interface, subjects: Mapping[str, Subject]) -> Iterator[str]:
    """Yield the facts that the manual does not state, and links for those that a text may have, in one line.

    ``family`` has the texts about all order codes, because a text about others may be valid for this one too.
    """
    unmentioned = [label for label, subject in subjects.items() if not mentions(family, interface, subject)]
    sentences = [f"{_capitalized(unmentioned)}: the {document(family)} does not say."] if unmentioned else []
    mentioned = [label for label in subjects if label not in unmentioned]
    if mentioned:
        places = [link("times", "#timings")]
        if family.characteristics:
            places.append(link("characteristics", "hardware.md#characteristics"))
        sentences.append(f"{_capitalized(mentioned)}: see {' and '.join(places)}.")
    if sentences:
        yield " ".join(sentences)


def no_leds(family: Device, device: Device, interface: Interface) -> str:
    """Return why a page shows no LEDs, or an empty string if the manual may have some in its texts."""
    if device.leds or document(family) != "manual":
        return ""
    if family.leds:
        return "The manual describes no LEDs of this order code."
    return "" if mentions(family, interface, Subject.LEDS) else "The manual describes no LEDs."


def no_supply(family: Device, interface: Interface) -> str:
    """Return what a page says in place of a supply."""
    if mentions(family, interface, Subject.SUPPLY):
        return f"see {link('characteristics', 'hardware.md#characteristics')}"
    return f"the {document(family)} does not say"


def _capitalized(labels: list[str]) -> str:
    """Return labels as the beginning of a sentence."""
    phrase = BY_NAME.phrase(statement(*listed(labels)))
    return phrase[:1].upper() + phrase[1:]
