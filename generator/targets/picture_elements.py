"""The SVG elements that all pictures share, and the colors of pages and pictures.

The colors are in ``runtime/browser/palette.css``, for light and dark screens. The background of a picture follows the
color scheme of the screen.
"""

from __future__ import annotations

import html
import re
from collections.abc import Mapping, Sequence
from functools import cache
from textwrap import wrap

from ..model.record import dataclass
from ..say import text_on_one_line
from .registry import our_runtime

_COLOUR_PROPERTY = re.compile(r"--codewheel-([a-z-]+): (#[0-9a-f]{6});")
_DARK_MEDIA_QUERY = "@media (prefers-color-scheme: dark)"
#: Prefix of the names of wire colors.
WIRE = "wire-"


@dataclass(frozen=True)
class Palette:
    """Colors by name, such as ``bits-flag``. A color that is the same on both screens is only in ``light``."""

    light: Mapping[str, str]
    dark: Mapping[str, str]

    def on_dark(self, name: str) -> str:
        """Return a color on a dark screen."""
        return self.dark.get(name, self.light[name])

    @property
    def wires(self) -> dict[str, str]:
        """The colors of wires by the English word, such as ``brown``."""
        return {name.removeprefix(WIRE): colour for name, colour in self.light.items() if name.startswith(WIRE)}


def palette_css() -> str:
    """Return the custom properties as a style sheet, without the comment at its top."""
    css = (our_runtime("browser") / "palette.css").read_text(encoding="utf-8")
    return css.partition("\n\n")[2]


@cache
def palette() -> Palette:
    """Return the colors from the style sheet."""
    light, _, dark = palette_css().partition(_DARK_MEDIA_QUERY)
    return Palette(dict(_COLOUR_PROPERTY.findall(light)), dict(_COLOUR_PROPERTY.findall(dark)))


#: Width in pixels that fits on the screen of a phone: 375 minus the margins of a page.
PICTURE_WIDTH = 340.0
#: Average character width of sans-serif fonts as a fraction of the font size, rounded up to be safe.
_LETTER_WIDTH = 0.58
#: Class of an element, CSS property, and name of the color in the palette.
_CLASS_COLOURS = (
    ("card", "fill", "page"),
    ("card", "stroke", "border"),
    ("ink", "fill", "ink"),
    ("faint", "fill", "soft-ink"),
    ("line", "stroke", "line"),
    ("wave", "stroke", "ink"),
    *((kind, "fill", f"bits-{kind}") for kind in ("data", "group", "flag", "check", "fixed", "choice", "nothing")),
)


def _style_element() -> str:
    """Return the style sheet of a picture, with the colors of its classes for light and dark screens."""
    colours = palette()
    light = "".join(
        f".{name}{{{css_property}:{colours.light[colour]}}}" for name, css_property, colour in _CLASS_COLOURS
    )
    dark = "".join(
        f".{name}{{{css_property}:{colours.on_dark(colour)}}}" for name, css_property, colour in _CLASS_COLOURS
    )
    always = f".line,.wave{{fill:none}}rect{{stroke:{colours.light['line']}}}"
    return f"<style>{always}{light}@media(prefers-color-scheme:dark){{{dark}}}</style>"


def create_picture(title: str, body: Sequence[str], width: float, height: float, description: str) -> str:
    """Return an SVG picture of this size. ``body`` are its elements, and ``description`` is its text alternative."""
    picture_width, picture_height = number(width), number(height)
    label = html.escape(text_on_one_line(title))
    svg_start = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{picture_width}" height="{picture_height}" '
        f'viewBox="0 0 {picture_width} {picture_height}" role="img" '
        f'aria-label="{label}" '
        'font-family="system-ui, -apple-system, Segoe UI, Helvetica, Arial, sans-serif">'
    )
    descriptions = [f"<title>{_escape_xml(title)}</title>", f"<desc>{_escape_xml(description)}</desc>"]
    # Half a pixel inside the picture on each side, so that the border is fully visible.
    background_size = f'width="{number(width - 1)}" height="{number(height - 1)}"'
    background = f'<rect x="0.5" y="0.5" {background_size} rx="6" class="card"/>'
    return "\n".join([svg_start, *descriptions, _style_element(), background, *body, "</svg>", ""])


def _escape_xml(words: str) -> str:
    """Return text for the content of an element, with the markup of XML escaped."""
    return html.escape(text_on_one_line(words), quote=False)


def draw_box(*, left: float, top: float, box_width: float, box_height: float, fill: str) -> str:
    """Return a rectangle. ``fill`` is its color class."""
    size = f'width="{number(box_width)}" height="{number(box_height)}"'
    return f'<rect x="{number(left)}" y="{number(top)}" {size} class="{fill}"/>'


def draw_swatch(*, left: float, top: float, box_width: float, box_height: float, colour: str) -> str:
    """Return a rectangle in a color that is the same on light and dark screens, such as the color of a wire."""
    size = f'width="{number(box_width)}" height="{number(box_height)}"'
    return f'<rect x="{number(left)}" y="{number(top)}" {size} fill="{colour}"/>'


def draw_text(
    words: str, *, x: float, y: float, size: int, anchor: str, faint: bool = False, bold: bool = False
) -> str:
    """Return a line of text. ``anchor`` says which part of it is at ``x``: its ``start``, ``middle`` or ``end``."""
    weight = ' font-weight="600"' if bold else ""
    colour = "faint" if faint else "ink"
    attributes = f'font-size="{size}" text-anchor="{anchor}" class="{colour}"{weight}'
    return f'<text x="{number(x)}" y="{number(y)}" {attributes}>{_escape_xml(words)}</text>'


def text_width(words: str, size: float) -> float:
    """Return an upper estimate of the width of a line of text."""
    return len(words) * size * _LETTER_WIDTH


def wrap_to_width(words: str, room: float, size: float) -> list[str]:
    """Return text as lines of at most ``room`` pixels, with at least one character per line."""
    letters_per_line = int(room / (size * _LETTER_WIDTH))
    return wrap(text_on_one_line(words), max(1, letters_per_line))


def number(value: float) -> str:
    """Return a number with at most one decimal, so that it is identical on every machine."""
    return f"{value:.1f}".removesuffix(".0")
