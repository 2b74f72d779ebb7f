"""Parts of a spec as a terminal shows them: with visible control characters, and cut to its width around a column."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence


def excerpt(line_text: str, column: int, width: int = 80) -> list[str]:
    """Return two lines: the part of a line around a column, and a caret below the column. Empty for a blank line."""
    if not line_text.strip():
        return []
    window, caret = _cut_window(line_text, column, max(width, 20) - 4)
    return [f"    {window}", f"    {' ' * caret}^"]


def visible(text: str) -> str:
    """Return a text in which every character that controls a terminal is replaced by an escape such as ``\\x1b``."""
    return "".join(map(_visible_character, text))


def _visible_character(character: str) -> str:
    """Return a character, or an escape such as ``\\x1b`` if it controls the terminal."""
    if unicodedata.category(character) not in ("Cc", "Cf", "Cs", "Zl", "Zp"):
        return character
    if character == "\t":
        return "\\t"
    code = ord(character)
    if code < 0x100:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _measure_columns(text: str) -> int:
    """Return the width of a text in a terminal: two columns for a wide character, none for a combining one."""
    wide_count = sum(unicodedata.east_asian_width(character) in "WF" for character in text)
    combining_count = sum(unicodedata.combining(character) != 0 for character in text)
    return len(text) + wide_count - combining_count


def _cut_window(line_text: str, column: int, width: int) -> tuple[str, int]:
    """Return the part of a line to show, without its indentation, and the offset of the caret in it, in columns.

    A line with more than ``width`` columns is cut so that the caret is visible, with more text before it than after.
    """
    indentation = len(line_text) - len(line_text.lstrip(" "))
    stripped = line_text.strip(" ")
    caret_index = max(0, min(column - 1 - indentation, len(stripped)))
    # Each character takes at least one column, so nothing farther away can be shown. A line may have millions.
    start = max(0, caret_index - width)
    characters_before = [_visible_character(character) for character in stripped[start:caret_index]]
    characters_after = [_visible_character(character) for character in stripped[caret_index : caret_index + width + 1]]
    is_too_long = start > 0 or _measure_columns("".join(characters_before + characters_after)) > width
    if is_too_long:
        characters_before = _cut_at_start(characters_before, width * 2 // 3, is_cut_already=start > 0)
        characters_after = _cut_at_end(characters_after, width - _measure_columns("".join(characters_before)))
    text_before = "".join(characters_before)
    return text_before + "".join(characters_after), _measure_columns(text_before)


def _cut_at_start(characters: list[str], width: int, *, is_cut_already: bool) -> list[str]:
    """Return the last characters that fit in ``width`` columns, after three dots if any were omitted, now or before."""
    fitting_count = _count_fitting(characters[::-1], width)
    if not is_cut_already and fitting_count == len(characters):
        return characters
    return ["...", *characters[len(characters) - fitting_count :]]


def _cut_at_end(characters: list[str], width: int) -> list[str]:
    """Return the characters if they fit in ``width`` columns, otherwise as many as fit before three dots."""
    if _measure_columns("".join(characters)) <= width:
        return characters
    return [*characters[: _count_fitting(characters, width - 3)], "..."]


def _count_fitting(characters: Sequence[str], width: int) -> int:
    """Return the number of characters at the beginning that fit in ``width`` columns."""
    used_columns = 0
    for count, character in enumerate(characters):
        used_columns += _measure_columns(character)
        if used_columns > width:
            return count
    return len(characters)
