# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from cells of text."""

from __future__ import annotations

import re
from typing import Final

from .shape import FrameLayout
from .words import DigitKind, quote

_PREFIXED_NUMBER: Final = re.compile(r"0([xX][0-9a-fA-F]+|[bB][01]+)")
_HEX_DIGITS: Final = re.compile(r"[0-9a-fA-F]+")
_DECIMAL_DIGITS: Final = re.compile(r"[0-9]+")
#: Words for a missing value, in lower case.
_WORDS_FOR_MISSING: Final = frozenset(("", "nan", "na", "n/a", "<na>", "null", "none"))


def read_text(text: str, layout: FrameLayout, number_base: DigitKind | None) -> int | bytes:
    """Return the frame in a cell of text. Raises ValueError if the text is not a frame.

    Spaces and underscores are ignored. A frame of bytes is a row of hexadecimal bytes, with or without a leading
    ``0x``. A frame of bits is a number. ``0x`` or ``0b`` specifies its base, otherwise ``number_base`` does.
    """
    text_without_spaces = text.replace(" ", "").replace("_", "")
    if layout.byte_count:
        return _read_bytes(text_without_spaces, text)
    if _PREFIXED_NUMBER.fullmatch(text_without_spaces):
        return int(text_without_spaces, 0)
    is_decimal = _DECIMAL_DIGITS.fullmatch(text_without_spaces) is not None
    if number_base == "decimal":
        if not is_decimal:
            raise ValueError(f"{quote(text)} is not a decimal number")
        return int(text_without_spaces, 10)
    if not _HEX_DIGITS.fullmatch(text_without_spaces):
        raise ValueError(f"{quote(text)} is not a hexadecimal number")
    if number_base is None and is_decimal:
        choice = "choose --digits decimal or --digits hex (in Python: digits='hex'), or put 0x in front"
        raise ValueError(f"{quote(text)} can be decimal or hexadecimal: {choice}")
    if number_base is None:
        choice = "choose --digits hex (in Python: digits='hex'), or put 0x in front"
        raise ValueError(f"{quote(text)} is hexadecimal: {choice}")
    return int(text_without_spaces, 16)


def _read_bytes(text_without_spaces: str, text: str) -> bytes:
    """Return the hexadecimal bytes in ``text_without_spaces``, which is a cell without spaces.

    ``text`` is the cell, for the error.
    """
    has_prefix = text_without_spaces[:2] in ("0x", "0X")
    hex_digits = text_without_spaces[2:] if has_prefix else text_without_spaces
    if not _HEX_DIGITS.fullmatch(hex_digits) or len(hex_digits) % 2:
        raise ValueError(f"{quote(text)} is not a row of hexadecimal bytes")
    return bytes.fromhex(hex_digits)


class TextCells:
    """Reader of text cells that contain frames. A cell that is empty or contains no frame yields None.

    ``nonempty_count`` is the number of nonempty cells, and ``unread_count`` is the number of those that contain no
    frame. Words for a missing value, such as ``nan``, count as empty. ``error_place`` and ``error`` are the location
    and the error message of the first cell without a frame.
    """

    def __init__(self, layout: FrameLayout, number_base: DigitKind | None) -> None:
        self._layout = layout
        self._number_base: DigitKind | None = number_base
        self.nonempty_count = self.unread_count = self.error_place = 0
        self.error = ""

    def read(self, text: str, cell_place: int) -> int | bytes | None:
        """Return the frame in a cell, or None if there is none. ``cell_place`` identifies the cell in errors."""
        if text[:2] == "0x" and not self._layout.byte_count and text.isascii():
            # This is a fast path for the usual form. Other forms are handled below.
            try:
                number = int(text, 16)
            except ValueError:
                pass
            else:
                self.nonempty_count += 1
                return number
        try:
            frame = read_text(text, self._layout, self._number_base)
        except ValueError as error:
            if text.strip().lower() in _WORDS_FOR_MISSING:
                return None
            if not self.unread_count:
                self.error_place = cell_place
                self.error = str(error)
            self.nonempty_count += 1
            self.unread_count += 1
            return None
        self.nonempty_count += 1
        return frame

    @property
    def are_mostly_unread(self) -> bool:
        """True if more than half of the nonempty cells contain no frame."""
        return 2 * self.unread_count > self.nonempty_count
