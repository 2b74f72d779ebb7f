"""The colors of pages and pictures, from ``runtime/browser/palette.css``, for light and dark screens."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from ..model.record import dataclass
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
