# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames as numbers: their forms in files and arrays."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final, Literal

from ..packages import load

np: Any = load("numpy")

WordKind = Literal["packed", "little", "big", "little32", "big32"]
DigitKind = Literal["hex", "decimal"]

#: Number of bytes and byte order of a word. 0 represents packed words, which have the minimum number of bytes for
#: their bits.
WORDS: Final[Mapping[WordKind, tuple[int, str]]] = MappingProxyType(
    {
        "packed": (0, ">"),
        "little": (8, "<"),
        "big": (8, ">"),
        "little32": (4, "<"),
        "big32": (4, ">"),
    }
)


def rows_to_numbers(rows: Any, word_form: WordKind = "packed") -> Any:
    """Return rows of bytes as 64-bit numbers: the row ``01 02`` as ``0x102``, or little-endian as ``0x201``.

    Rows of ``packed`` words have one to eight bytes, most significant first. For other words, each row has as many
    bytes as the word.
    """
    word_bytes, byte_order = WORDS[word_form]
    is_short_packed_word = not word_bytes and rows.shape[1] < 8
    if is_short_packed_word:
        # Zeros in front make all words eight bytes long.
        padded_rows = np.zeros((len(rows), 8), np.uint8)
        padded_rows[:, 8 - rows.shape[1] :] = rows
        return padded_rows.reshape(-1).view(">u8").astype(np.uint64)
    word_type = f"{byte_order}u{word_bytes or 8}"
    return np.ascontiguousarray(rows).reshape(-1).view(word_type).astype(np.uint64, copy=False)


def read_floats(frames: Any, frame_bits: int, rows_before: int = 0) -> Any:
    """Return frames of ``frame_bits`` bits that are floating-point numbers as integers. Missing frames are masked.

    NaN, infinities, negative values, and values from 2**64 up are missing frames, and so are masked values.
    ``rows_before`` is the number of earlier rows, to number the row in an error.

    Raises:
        TypeError: A value is not an integer, or the type cannot represent every frame of that length.
    """
    # A float has one more significant bit than its stored mantissa.
    significant_bits = np.finfo(frames.dtype).nmant + 1
    if frame_bits > significant_bits:
        raise TypeError(f"{frames.dtype} cannot represent every frame of {frame_bits} bits: use integers or text")
    values = np.ma.getdata(frames)
    is_frame = (values >= 0) & (values < 2.0**64) & ~np.ma.getmaskarray(frames)
    frame_values = np.where(is_frame, values, 0)
    fractional_rows = np.flatnonzero(frame_values != np.floor(frame_values))
    if len(fractional_rows):
        first_row = fractional_rows[0]
        raise TypeError(
            f"the frame at index {rows_before + first_row} must be an integer, got {frame_values[first_row]}"
        )
    return np.ma.masked_array(frame_values.astype(np.uint64), ~is_frame)


def quote(text: str) -> str:
    """Return the text in quotes for a message, shortened if it is longer than 40 characters."""
    return repr(text if len(text) <= 40 else f"{text[:40]}...")


def list_names(names: list[str]) -> str:
    """Return at most eight of the names for a message, and the number of remaining names."""
    first_names = ", ".join(quote(name) for name in names[:8])
    return f"{first_names} and {len(names) - 8} more" if len(names) > 8 else first_names
