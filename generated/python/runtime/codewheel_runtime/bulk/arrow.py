# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from Arrow columns."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ..errors import InputError
from ..packages import load
from .cells import TextCells
from .shape import FrameLayout
from .words import DigitKind, read_floats, rows_to_numbers

np: Any = load("numpy")


class NoFrame(ValueError):
    """The cell in ``row`` does not contain a frame."""

    def __init__(self, row: int, message: str) -> None:
        super().__init__(message)
        self.row = row


def read_column(column: Any, layout: FrameLayout) -> Any:
    """Convert a column of any library with Arrow's C interface to the form that ``decode_many`` expects.

    Raises:
        InputError: Most cells of text are not frames.
        TypeError: The type of the column does not fit the frames.
    """
    pa: Any = load("pyarrow")
    if not isinstance(column, (pa.Array, pa.ChunkedArray)):
        try:
            column = pa.chunked_array(column) if hasattr(column, "__arrow_c_stream__") else pa.array(column)
        except pa.ArrowException as error:
            reason = f"pyarrow cannot read the column ({error}): convert it to 64-bit integers, bytes or text"
            raise TypeError(reason) from None
    try:
        return read_arrow(column, layout)
    except NoFrame as error:
        reason = "frames as text need 0x in front: convert the column to integers"
        raise InputError("the frames", reason, place=f"row {error.row + 1}") from None


def read_arrow(column: Any, layout: FrameLayout, number_base: DigitKind | None = None, rows_before: int = 0) -> Any:
    """Convert an Arrow column to the form that ``decode_many`` expects. Missing items are masked or None.

    ``number_base`` is the base of numbers in text that have no ``0x``. ``rows_before`` is the number of rows of the
    file that have already been read. If it is 0 and the column is text, most of its cells must be frames.

    Raises:
        NoFrame: Most of the first cells of text are not frames.
        TypeError: The type of the column does not fit the frames.
    """
    pa: Any = load("pyarrow")
    arrow_types = pa.types
    if isinstance(column, pa.ChunkedArray):
        column = column.combine_chunks()
    if arrow_types.is_dictionary(column.type):
        # pyarrow cannot look up views by their indices.
        dictionary = _convert_views(column.dictionary)
        column = pa.DictionaryArray.from_arrays(column.indices, dictionary).dictionary_decode()
    column = _convert_views(column)
    arrow_type = column.type
    if arrow_types.is_null(arrow_type):
        return [None] * len(column)
    if arrow_types.is_integer(arrow_type):
        return _read_integers(column, layout)
    if arrow_types.is_float64(arrow_type) and not layout.byte_count:
        return read_floats(column.to_numpy(zero_copy_only=False), layout.bit_count, rows_before)
    if arrow_types.is_string(arrow_type) or arrow_types.is_large_string(arrow_type):
        return _read_each(column.to_pylist(), layout, number_base, is_first=not rows_before)
    is_variable_length = arrow_types.is_binary(arrow_type) or arrow_types.is_large_binary(arrow_type)
    if not is_variable_length and not arrow_types.is_fixed_size_binary(arrow_type):
        raise TypeError(f"expected numbers, bytes or text, got items of the type {arrow_type}")
    return _read_bytes(column, layout)


def _read_bytes(column: Any, layout: FrameLayout) -> Any:
    """Convert a column of bytes. It is faster if no item is missing and all have the length of a frame."""
    # A frame is either a row of bytes or a number of some bits, which are rounded up to whole bytes.
    has_rows_of_bytes = layout.byte_count > 0
    bytes_per_frame = layout.byte_count if has_rows_of_bytes else (layout.bit_count + 7) // 8
    rows = None if column.null_count else _read_rows(column, bytes_per_frame)
    if rows is None:
        return read_byte_cells(column.to_pylist(), layout)
    return rows if has_rows_of_bytes else rows_to_numbers(rows)


def _convert_views(array: Any) -> Any:
    """Return an array of text or byte views, which polars uses, as plain text or bytes. Others stay unchanged."""
    pa: Any = load("pyarrow")
    # Old versions of pyarrow lack a function to test for views.
    plain_types = {"string_view": pa.large_string, "binary_view": pa.large_binary}
    plain_type = plain_types.get(str(array.type))
    return array if plain_type is None else array.cast(plain_type())


def _read_integers(array: Any, layout: FrameLayout) -> Any:
    """Return integers as an array. Missing ones are masked. Raises TypeError if frames are bytes."""
    if layout.byte_count:
        raise TypeError(f"expected rows of {layout.byte_count} bytes, got numbers")
    if not array.null_count:
        return array.to_numpy(zero_copy_only=False)
    missing = array.is_null().to_numpy(zero_copy_only=False)
    return np.ma.masked_array(array.fill_null(0).to_numpy(zero_copy_only=False), missing)


def _read_rows(array: Any, bytes_per_row: int) -> Any:
    """Return byte strings as an array with one row per string, without copying.

    Return None if a string has a different length.
    """
    arrow_type = array.type
    row_count = len(array)
    if not row_count:
        return np.zeros((0, bytes_per_row), np.uint8)
    # Arrow stores the bytes of all strings one after another in the buffer ``data``. ``first_byte`` is the place of the
    # first string there, because an array can be a slice of a longer array, which begins at ``array.offset``.
    types = load("pyarrow").types
    if types.is_fixed_size_binary(arrow_type):
        if arrow_type.byte_width != bytes_per_row:
            return None
        _, data = array.buffers()
        first_byte = array.offset * bytes_per_row
    else:
        # If lengths can differ, another buffer has the place of each string in ``data``, and the end of the last one.
        _, starts_buffer, data = array.buffers()
        start_type = np.int64 if types.is_large_binary(arrow_type) else np.int32
        all_starts = np.frombuffer(starts_buffer, start_type)
        string_starts = all_starts[array.offset : array.offset + row_count + 1]
        if (np.diff(string_starts) != bytes_per_row).any():
            return None
        first_byte = int(string_starts[0])
    return np.frombuffer(data, np.uint8, count=row_count * bytes_per_row, offset=first_byte).reshape(
        row_count, bytes_per_row
    )


def read_byte_cells(byte_strings: Iterable[bytes | None], layout: FrameLayout) -> list[Any]:
    """Return frames that are byte strings in the form that ``decode_many`` expects: unchanged, or as integers.

    None stays None. For frames of bits, a string that has too few bytes for all bits also becomes None.
    """
    if layout.byte_count:
        return list(byte_strings)
    least_bytes = (layout.bit_count + 7) // 8
    frames: list[int | None] = []
    for byte_string in byte_strings:
        is_complete = byte_string is not None and len(byte_string) >= least_bytes
        frames.append(int.from_bytes(byte_string, "big") if byte_string and is_complete else None)
    return frames


def _read_each(
    texts: Iterable[str | None], layout: FrameLayout, number_base: DigitKind | None, is_first: bool
) -> list[Any]:
    """Return the frame in each text cell, or None for a cell without a frame. ``number_base`` is the base of numbers.

    Raises:
        NoFrame: ``is_first`` is True, and most cells contain no frame.
    """
    cells = TextCells(layout, number_base)
    frames = [cells.read(cell or "", row) for row, cell in enumerate(texts)]
    if is_first and cells.are_mostly_unread:
        raise NoFrame(cells.error_place, cells.error)
    return frames
