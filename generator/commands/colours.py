"""Colours on a terminal. Files, pipes and terminals without colours get plain text."""

from __future__ import annotations

import os
import re
import sys

_CODES = {"red": 31, "green": 32, "yellow": 33, "cyan": 36, "faint": 2, "bold": 1}
#: Colour of the first word of a line of ``diff``.
_BY_IMPACT = {
    "breaking": "red",
    "behaviour": "yellow",
    "compatible": "green",
    "renamed": "cyan",
    "documentation": "faint",
    "names": "bold",
}
_IMPACT = re.compile(rf"^(  )({'|'.join(_BY_IMPACT)})(?= )", re.MULTILINE)


def has_colours() -> bool:
    """Return whether standard output is a terminal with colours that the user has not switched off."""
    is_wanted = not os.environ.get("NO_COLOR") and os.environ.get("TERM", "") != "dumb"
    return is_wanted and sys.stdout.isatty()


def in_colour(text: str, colour: str) -> str:
    """Return a text in a colour of ``_CODES``."""
    return f"\x1b[{_CODES[colour]}m{text}\x1b[0m"


def with_coloured_impacts(text: str) -> str:
    """Return the text of ``diff`` with the impact of each change in its colour, if the terminal has colours."""
    if not has_colours():
        return text
    return _IMPACT.sub(lambda match: match[1] + in_colour(match[2], _BY_IMPACT[match[2]]), text)
