"""Comments in C: text of a spec in ASCII, made safe so that nothing in it ends the comment."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

from ...say.plain_text import in_ascii, plain

COLUMNS = 100
#: The smallest width of a text after its lead.
_NARROWEST = 36

#: A paragraph of a comment. A pair is a lead and its text, whose other lines are indented by the width of the lead.
Paragraph = str | tuple[str, str]

#: Signs that comments spell in their own way.
_ASCII_SPELLINGS = {"±": "+/-", "°": " deg ", "Ω": "ohm"}


def ascii_text(text: object) -> str:
    return re.sub(" +", " ", in_ascii(plain(text).replace("N°", "No."), _ASCII_SPELLINGS)).strip()


def in_comment(text: object) -> str:
    """Make ``text`` safe for a comment: nothing in it ends or opens one, continues a line or is a trigraph."""
    safe = ascii_text(text).replace("\\", "|")
    while "??" in safe:
        safe = safe.replace("??", "? ?")
    return _separate_comment_marks(safe)


def _separate_comment_marks(text: str) -> str:
    """Put a space between every adjacent star and slash."""
    return re.sub(r"\*(?=/)|/(?=\*)", lambda match: match[0] + " ", text)


def comment(paragraphs: Sequence[Paragraph] | str, indent: int = 0) -> str:
    """Format paragraphs as a comment. Empty ones are omitted."""
    if isinstance(paragraphs, str):
        leads_and_texts = [("", paragraphs)]
    else:
        leads_and_texts = [(lead, text) for lead, text in map(_lead_and_text, paragraphs) if text]
    margin = " " * indent
    lines: list[str] = []
    for unsafe_lead, text in leads_and_texts:
        lead = in_comment_lead(unsafe_lead)
        if lead.startswith("@") and lines and not lines[-1].startswith(("@", " ")):
            # The parameters of a function come after an empty line.
            lines.append("")
        if len(lead) > COLUMNS - indent - _NARROWEST:
            # The lead is too long: the text goes below.
            lines.append(_separate_comment_marks(lead.rstrip()))
            lead = "        "
        width = COLUMNS - indent - 3 - len(lead)
        wrapped = textwrap.wrap(in_comment(text), width, break_long_words=False, break_on_hyphens=False) or [""]
        lines.append(_separate_comment_marks(lead + wrapped[0]))
        lines += (_separate_comment_marks(" " * len(lead) + line) for line in wrapped[1:])
    if len(lines) == 1 and len(lines[0]) + indent + 6 <= COLUMNS:
        return f"{margin}/* {lines[0]} */"
    body = "\n".join(f"{margin} * {line}".rstrip() for line in lines)
    return f"{margin}/*\n{body}\n{margin} */"


def _lead_and_text(paragraph: Paragraph) -> tuple[str, str]:
    return ("", paragraph) if isinstance(paragraph, str) else paragraph


def comment_lines(paragraphs: Sequence[Paragraph] | str) -> str:
    """Format paragraphs as lines inside a comment that the template opens and closes."""
    inner = comment(paragraphs).splitlines()
    return f" * {inner[0][3:-3]}" if len(inner) == 1 else "\n".join(inner[1:-1])


def in_comment_lead(text: str) -> str:
    """Make the lead of a paragraph safe for a comment, with its spaces kept."""
    return re.sub("[^ ]+", lambda word: in_comment(word[0]), text)
