"""Comments and texts in XML files for masters, in ASCII.

Only the beginning of one idbiss file is public. Our file uses only the elements and attributes found there. Comments
mark every further interpretation as inferred. Facts with no publicly known place in the format are in the full
description, for which we have our own schema.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import lru_cache

from markupsafe import Markup, escape

from ...dump.xml import clean
from ...say.plain_text import in_ascii, plain

_WIDTH = 132
#: Signs that comments spell in their own way.
_OWN = {"±": "+/-", "→": "to", "°": " deg", "\N{OHM SIGN}": "Ohm"}


def ascii_only(text: object) -> str:
    """Return ``text`` in ASCII for comments, where XML allows no character references."""
    return in_ascii(plain(text), _OWN)


def comment_text(text: object) -> Markup:
    """Return ``text`` for a comment, without double hyphens, which would end it."""
    comment_line = ascii_only(text)
    while "--" in comment_line:
        comment_line = comment_line.replace("--", "- -")
    return Markup(comment_line + " " if comment_line.endswith("-") else comment_line)


def comment(text: object, indent: str) -> Markup:
    """Return a complete comment, wrapped if necessary. Line breaks in the text are preserved."""
    lines = str(text).split("\n")
    if len(lines) == 1 and len(indent) + len(whole := comment_text(lines[0])) + 9 <= _WIDTH:
        return Markup(f"{indent}<!-- {whole} -->")
    wrapped = [piece for line in lines for piece in _wrapped(line, _WIDTH - len(indent) - 5)]
    return Markup("\n".join([f"{indent}<!--", *(f"{indent}     {line}" for line in wrapped), f"{indent}-->"]))


# The files for the order codes of a family have most lines in common.
@lru_cache(maxsize=1024)
def _wrapped(line: str, width: int) -> Sequence[str]:
    """Return the lines of a comment for one line of its text. An indented one is an item of a list."""
    first, indent = ("  ", "    ") if line.startswith("  ") else ("", "")
    return textwrap.wrap(str(comment_text(line)), width, initial_indent=first, subsequent_indent=indent)


def ascii_text(text: object) -> Markup:
    """Return ``text`` for an element, in ASCII and with character references."""
    return Markup(str(escape(clean(plain(text)))).encode("ascii", "xmlcharrefreplace").decode())
