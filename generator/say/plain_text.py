"""Text from a spec in ASCII, on one line, or wrapped as a paragraph."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping

#: Replacements for signs that Unicode does not decompose well.
STAND_INS: Mapping[str, str] = {
    "→": "->",
    "←": "<-",
    "↔": "<->",
    "−": "-",
    "–": "-",
    "—": "-",
    "‑": "-",
    "“": '"',
    "”": '"',
    "„": '"',
    "‘": "'",
    "’": "'",
    "…": "...",
    "×": "x",
    "·": ".",
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "≠": "!=",
    "≈": "~",
    "²": "^2",
    "³": "^3",
    "°": "deg",
    "µ": "u",
    "μ": "u",
    "Ω": "Ohm",
    "Ø": "dia. ",
    "ß": "ss",
    "§": "section ",
    "®": "(R)",
    "©": "(C)",
    "™": "(TM)",
}


def in_ascii(text: str, replacements: Mapping[str, str]) -> str:
    """Return the text with ``replacements``, then those above, then letters without accents, then ``?``."""
    if text.isascii():
        return text
    table = {ord(sign): stand_in for sign, stand_in in {**STAND_INS, **replacements}.items()}
    flat = unicodedata.normalize("NFKD", text.translate(table))
    return "".join(letter for letter in flat if not unicodedata.combining(letter)).encode("ascii", "replace").decode()


#: Columns of a terminal.
WIDTH = 80
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]+")


def one_line(text: object) -> str:
    """Return the text on one line. Control characters, line ends and direction marks become spaces."""
    line = str(text)
    return line if line.isprintable() else _CONTROL.sub(" ", line)


def plain(text: object) -> str:
    """Return the text on one line, without spaces at its ends."""
    return one_line(text).strip()


def wrapped(text: object, width: int, prefix: str = "", first: str | None = None) -> str:
    """Return a paragraph of at most ``width`` columns. Lines start with ``prefix``, the first with ``first``."""
    lines: list[str] = []
    line = prefix if first is None else first
    has_words = False
    for word in filter(None, plain(text).split(" ")):
        if has_words and len(line) + 1 + len(word) > width:
            lines.append(line)
            line, has_words = prefix, False
        line, has_words = f"{line} {word}" if has_words else line + word, True
    return "\n".join([*lines, line]) if has_words else ""


def pairs(rows: Iterable[tuple[str, str]], indent: int) -> list[str]:
    """Return the rows as lines with two columns. The second column is wrapped."""
    row_list = list(rows)
    width = min(max((len(name) for name, _ in row_list), default=0), 40)
    margin, start = " " * indent, " " * (indent + width + 2)
    lines: list[str] = []
    for name, text in row_list:
        lines.append(wrapped(text, WIDTH, start, f"{margin}{name.ljust(width)}  ") if text else f"{margin}{name}")
    return lines
