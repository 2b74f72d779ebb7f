# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the frames passed to ``decode_many`` as rows of bytes or as 64-bit words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, cast

from ..codec import as_bytes, whole_number
from .chunk import (
    np,
)
from .words import read_floats


def is_arrow(frames: object) -> bool:
    """Return whether frames are a column from Arrow, polars, or another library with Arrow's C interface."""
    return hasattr(frames, "__arrow_c_stream__") or hasattr(frames, "__arrow_c_array__")


class ReadFrames(NamedTuple):
    """Frames as an array of byte rows or 64-bit numbers, and the indices of frames with the wrong length.

    Frames with the wrong length are replaced by zeros.
    """

    frames: Any
    wrong_rows: Any


def read_rows(frames: Any, length: int) -> ReadFrames:
    """Return frames of ``length`` bytes as an array with a row of bytes for each frame.

    A missing frame, such as None, and an array row with masked bytes have the wrong length. In arrays
    and buffers, all frames have the same length. Lists can have frames of different lengths.

    Raises:
        TypeError: The frames are not bytes.
        ValueError: An array or a buffer does not contain complete frames of this length.
    """
    if isinstance(frames, (list, tuple)):
        return _read_list_of_rows(cast(Iterable[Any], frames), length)
    if isinstance(frames, np.ndarray) and frames.dtype.kind == "O":
        return read_rows(frames.tolist(), length)
    array: Any = np.frombuffer(frames, np.uint8) if isinstance(frames, (bytes, bytearray)) else frames
    if isinstance(frames, memoryview):
        array = np.asarray(frames)
    if not isinstance(array, np.ndarray) or array.dtype != np.uint8:
        raise TypeError(f"frames must be rows of {length} bytes, got {type(array).__name__} of other items")
    if array.ndim == 1 and len(array) % length == 0:
        array = array.reshape(-1, length)
    if array.ndim != 2 or array.shape[1] != length:
        raise ValueError(f"expected complete frames of {length} bytes, got an array of the shape {array.shape}")
    if isinstance(array, np.ma.MaskedArray):
        has_masked_bytes = np.ma.getmaskarray(array).any(axis=1)
        return ReadFrames(array.filled(0), np.flatnonzero(has_masked_bytes))
    return ReadFrames(array, wrong_rows=())


def _read_list_of_rows(frames: Iterable[Any], length: int) -> ReadFrames:
    """Return a list of byte strings as rows of bytes. The strings can have different lengths."""
    rows: list[bytes] = []
    wrong_rows: list[int] = []
    for index, frame in enumerate(frames):
        row = b"" if _is_missing(frame) else as_bytes(frame)
        if len(row) != length:
            wrong_rows.append(index)
            row = bytes(length)
        rows.append(row)
    array = np.frombuffer(b"".join(rows), np.uint8).reshape(-1, length)
    return ReadFrames(array, np.array(wrong_rows, np.intp))


def read_words(frames: Any, bits: int) -> ReadFrames:
    """Return frames of ``bits`` bits as 64-bit numbers. A missing frame, such as None, has the wrong length.

    ``frames`` is an array or a list of numbers, or a buffer. A buffer of bytes has eight bytes per frame, least
    significant first. A buffer with items of another type is read as an array.

    Raises:
        TypeError: The frames are not integers or a buffer.
        ValueError: The length of a buffer is not a multiple of eight bytes.
    """
    if isinstance(frames, memoryview):
        frames = as_bytes(cast(Any, frames)) if frames.itemsize == 1 else np.asarray(frames)
    if isinstance(frames, (bytes, bytearray)):
        if len(frames) % 8:
            raise ValueError(f"expected eight bytes per frame, got {len(frames)} bytes")
        return ReadFrames(np.frombuffer(frames, "<u8").astype(np.uint64, copy=False), wrong_rows=())
    if isinstance(frames, np.ndarray):
        array: Any = frames
        # As a list, masked items are None.
        return read_words(array.tolist(), bits) if array.dtype.kind == "O" else _read_array_of_words(array, bits)
    if not isinstance(frames, Iterable) or isinstance(frames, str):
        raise TypeError(f"frames must be numbers or packed bytes, got {type(frames).__name__}")
    return _read_list_of_words(cast(list[Any], frames))


def _read_array_of_words(frames: Any, bits: int) -> ReadFrames:
    """Return an array of integers, or of floating-point numbers without fractions, as 64-bit numbers.

    Masked and negative frames have the wrong length. Raises TypeError for other arrays.
    """
    if frames.dtype.kind == "f" and frames.ndim == 1:
        frames = read_floats(frames, bits)
    if frames.dtype.kind not in "ui" or frames.ndim != 1:
        raise TypeError(f"frames must be integers in one dimension, got an array of {frames.dtype} {frames.shape}")
    is_wrong = np.ma.getmaskarray(frames)
    numbers = np.ma.getdata(frames)
    if numbers.dtype.kind == "i":
        is_wrong = is_wrong | (numbers < 0)
    words = numbers.astype(np.uint64, copy=False)
    wrong_rows = np.flatnonzero(is_wrong)
    if len(wrong_rows):
        words = np.where(is_wrong, np.uint64(0), words)
    return ReadFrames(words, wrong_rows)


def _read_list_of_words(frames: Iterable[Any]) -> ReadFrames:
    """Return a list of numbers as 64-bit numbers. Negative numbers and numbers with more bits have the wrong length.

    Raises TypeError for items that are neither integers nor missing.
    """
    words: list[int] = []
    wrong_rows: list[int] = []
    for index, frame in enumerate(frames):
        is_missing = _is_missing(frame)
        word = 0 if is_missing else whole_number(f"the frame at index {index}", frame)
        if is_missing or not 0 <= word < (1 << 64):
            wrong_rows.append(index)
            word = 0
        words.append(word)
    return ReadFrames(np.array(words, np.uint64), np.array(wrong_rows, np.intp))


def _is_missing(frame: object) -> bool:
    """Return whether the frame is None, NaN or ``pandas.NA``."""
    # This is a fast path for the usual types.
    if type(frame) is int or type(frame) is bytes:
        return False
    # Only NaN differs from itself.
    is_nan = isinstance(frame, float) and frame != frame
    return frame is None or is_nan or type(frame).__name__ == "NAType"
