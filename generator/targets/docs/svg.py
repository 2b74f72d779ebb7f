"""Elements shared by all pictures: a card with a title, text, and colours for light and dark screens."""

from __future__ import annotations

import html
from collections.abc import Sequence
from textwrap import wrap

from ...say.plain_text import plain

#: Width that fits on the screen of a phone: 375 pixels minus the margins of a page.
WIDE = 340.0
#: Average character width of sans-serif fonts as a fraction of the font size, deliberately a little too high.
_LETTER_WIDTH = 0.58
#: Class, property, colour on a light screen, colour on a dark screen.
_CLASS_COLOURS = (
    ("card", "fill", "#ffffff", "#0f172a"),
    ("card", "stroke", "#cbd5e1", "#475569"),
    ("ink", "fill", "#0f172a", "#f1f5f9"),
    ("faint", "fill", "#475569", "#cbd5e1"),
    ("line", "stroke", "#64748b", "#94a3b8"),
    ("wave", "stroke", "#0f172a", "#f1f5f9"),
    ("data", "fill", "#dbeafe", "#1e3a5f"),
    ("group", "fill", "#fdf0d0", "#5b4a1e"),
    ("flag", "fill", "#fde2e2", "#6b2a2a"),
    ("check", "fill", "#e6dcfb", "#453070"),
    ("fixed", "fill", "#eef1f5", "#334155"),
    ("choice", "fill", "#dcf5e3", "#1f4d33"),
    ("nothing", "fill", "#ffffff", "#0f172a"),
)


def _style_element() -> str:
    light = "".join(f".{name}{{{property_name}:{colour}}}" for name, property_name, colour, _ in _CLASS_COLOURS)
    dark = "".join(f".{name}{{{property_name}:{colour}}}" for name, property_name, _, colour in _CLASS_COLOURS)
    always = ".line,.wave{fill:none}rect{stroke:#64748b}"
    return f"<style>{always}{light}@media(prefers-color-scheme:dark){{{dark}}}</style>"


def card(title: str, body: Sequence[str], width: float, height: float, description: str) -> str:
    """Return a picture of this size. ``description`` is its text alternative."""
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{number(width)}" height="{number(height)}" '
        f'viewBox="0 0 {number(width)} {number(height)}" role="img" aria-label="{html.escape(plain(title))}" '
        'font-family="system-ui, -apple-system, Segoe UI, Helvetica, Arial, sans-serif">'
    )
    size = f'width="{number(width - 1)}" height="{number(height - 1)}"'
    descriptions = [f"<title>{_escaped(title)}</title>", f"<desc>{_escaped(description)}</desc>"]
    background = f'<rect x="0.5" y="0.5" {size} rx="6" class="card"/>'
    return "\n".join([head, *descriptions, _style_element(), background, *body, "</svg>", ""])


def _escaped(words: str) -> str:
    """Return words as the content of an element."""
    return html.escape(plain(words), quote=False)


def rect(x: float, top: float, box_width: float, box_height: float, fill: str) -> str:
    """Return a box. ``fill`` is its colour class."""
    size = f'width="{number(box_width)}" height="{number(box_height)}"'
    return f'<rect x="{number(x)}" y="{number(top)}" {size} class="{fill}"/>'


def swatch(x: float, top: float, box_width: float, box_height: float, colour: str) -> str:
    """Return a box in a colour that is the same in both colour schemes, such as that of a wire."""
    size = f'width="{number(box_width)}" height="{number(box_height)}"'
    return f'<rect x="{number(x)}" y="{number(top)}" {size} fill="{colour}"/>'


def text(
    x: float,
    y: float,
    words: str,
    size: int,
    anchor: str,
    *,
    faint: bool = False,
    bold: bool = False,
) -> str:
    """Return a line of text."""
    weight = ' font-weight="600"' if bold else ""
    look = f'font-size="{size}" text-anchor="{anchor}" class="{"faint" if faint else "ink"}"{weight}'
    return f'<text x="{number(x)}" y="{number(y)}" {look}>{_escaped(words)}</text>'


def width(words: str, size: float) -> float:
    """Return an upper estimate of the width of a line of text."""
    return len(words) * size * _LETTER_WIDTH


def wrapped(words: str, room: float, size: float) -> list[str]:
    """Return text as lines no wider than ``room``."""
    return wrap(plain(words), max(1, int(room / (size * _LETTER_WIDTH))))


def number(value: float) -> str:
    """Return a number with at most one decimal, identical on every machine."""
    return f"{value:.1f}".removesuffix(".0")
