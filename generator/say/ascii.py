"""Text in ASCII, for comments and terminals that have no other characters."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping

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
