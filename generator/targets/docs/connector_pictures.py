"""SVG pictures of connectors and cables: a row for each pin or wire, with its colour and its signal.

Each colour is next to its name, so the picture can be read without colour vision. The face of a connector is not drawn,
because the manuals show the arrangement of pins only in figures, and specs have no figures.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import Connector, Contact
from .svg import WIDE, card, rect, swatch, text, wrapped

_MARGIN, _ROW, _LINE, _SIZE = 10.0, 28.0, 15.0, 12
#: Left edges of the names of wires, and of the signals in a table with wires and in one with pins only.
_NAME, _SIGNAL_AFTER_WIRES, _SIGNAL_AFTER_PINS = 46.0, 136.0, 52.0
#: Colours of wires, on light and on dark screens.
_WIRE_COLOURS = {
    "black": "#000000",
    "blue": "#1d4ed8",
    "brown": "#7b3f00",
    "green": "#15803d",
    "grey": "#8a8f98",
    "orange": "#f97316",
    "pink": "#f9a8d4",
    "red": "#dc2626",
    "turquoise": "#2dd4bf",
    "violet": "#7e22ce",
    "white": "#ffffff",
    "yellow": "#facc15",
}
_BETWEEN_COLOURS = re.compile(r"[^a-z]+")
FACE_UNKNOWN = "Pins in the order of the manual's table. Their arrangement on the connector face is not known."


def connector_text(connector: Connector) -> str:
    """Return the text alternative of the picture."""
    return f"{connector.title}: {', '.join(map(_contact_text, connector.contacts))}"


def _contact_text(contact: Contact) -> str:
    return f"{contact.contact} {contact.signal}" + (f" (only {contact.only})" if contact.only else "")


def connector_picture(connector: Connector) -> str:
    """Return the picture of a connector or cable."""
    body: list[str] = []
    top = _MARGIN
    text_start = _SIGNAL_AFTER_PINS if all(map(_is_pin, connector.contacts)) else _SIGNAL_AFTER_WIRES
    for contact in connector.contacts:
        lines = list(_signal_lines(contact, WIDE - _MARGIN - text_start))
        body += _contact_elements(contact, top)
        for index, (line, faint) in enumerate(lines):
            body.append(text(text_start, top + 18 + _LINE * index, line, _SIZE, "start", faint=faint))
        top += max(_ROW, _LINE * len(lines) + 8)
    if any(map(_is_pin, connector.contacts)):
        for line in wrapped(FACE_UNKNOWN, WIDE - 2 * _MARGIN, _SIZE):
            body.append(text(_MARGIN, top + 16, line, _SIZE, "start", faint=True))
            top += _LINE
    return card(connector.title, body, WIDE, top + _MARGIN, connector_text(connector))


def _signal_lines(contact: Contact, room: float) -> Iterator[tuple[str, bool]]:
    """Yield the lines for a signal and its order codes, each with True if it is faint."""
    yield from ((line, False) for line in wrapped(contact.signal, room, _SIZE))
    if contact.only:
        yield from ((line, True) for line in wrapped(f"only {contact.only}", room, _SIZE))


def _is_pin(contact: Contact) -> bool:
    return contact.contact.isdecimal() and len(contact.contact) <= 3


def _contact_elements(contact: Contact, top: float) -> Iterator[str]:
    """Yield the elements of a pin with its number, a wire with its colours and their names, or only a name."""
    if _is_pin(contact):
        yield rect(_MARGIN, top + 3, 28, 22, "data")
        yield text(_MARGIN + 14, top + 18, contact.contact, _SIZE, "middle", bold=True)
        return
    words = _BETWEEN_COLOURS.split(contact.contact.lower())
    if all(word in _WIRE_COLOURS for word in words):
        colour_width = 28.0 / len(words)
        for index, word in enumerate(words):
            yield swatch(_MARGIN + colour_width * index, top + 5, colour_width, 18, _WIRE_COLOURS[word])
    for line in wrapped(contact.contact, _SIGNAL_AFTER_WIRES - _NAME - 6, _SIZE)[:1]:
        yield text(_NAME, top + 18, line, _SIZE, "start")
