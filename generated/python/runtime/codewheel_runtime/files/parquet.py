# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from Parquet files in chunks."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import Any, BinaryIO, Final

from ..bulk.arrow import NoFrame, read_arrow
from ..bulk.shape import FrameLayout
from ..bulk.words import quote
from ..errors import InputError
from ..packages import load
from . import inputs
from .inputs import FrameBatch, Source, StorageFormat, find_column, select_columns

#: Number of bytes of a Parquet column that are read at a time.
_BUFFER_BYTES: Final = 1 << 20


def read_parquet_batches(file: BinaryIO, file_name: str, storage: StorageFormat, layout: FrameLayout) -> Source:
    """Open a Parquet file, and return a source that reads the frames and the other columns later.

    Raises:
        InputError: The file is not Parquet, or has no column of frames.
        UsageError: Two columns to keep have the same name.
    """
    with _convert_errors(file_name):
        # Without a buffer, a whole column is read at once.
        opened_file = load("pyarrow.parquet").ParquetFile(file, buffer_size=_BUFFER_BYTES, pre_buffer=False)
        schema = opened_file.schema_arrow
        frame_column = find_column(list(schema.names), storage.frame_column, file_name)
        total = int(opened_file.metadata.num_rows)
    other_names = tuple(column_name for column_name in schema.names if column_name != frame_column)
    pa: Any = load("pyarrow")

    def make_empty_column(column_name: str) -> Any:
        return pa.array([], schema.field(column_name).type)

    # The keys are the names of the other columns that the user wants.
    empty_columns = select_columns(other_names, storage, make_empty_column, file_name)
    kept_names = tuple(empty_columns)
    parts = _read_batches(opened_file, frame_column, kept_names, file_name, storage, layout)
    return Source(parts, total, other_names, empty_columns)


def _read_batches(
    file: Any,
    frame_column: str,
    kept_names: tuple[str, ...],
    file_name: str,
    storage: StorageFormat,
    layout: FrameLayout,
) -> Generator[FrameBatch, None, None]:
    """Yield the frames of a column, with the other columns of the same rows, and the number of rows read so far.

    ``frame_column`` is the name of the column of frames, and ``kept_names`` are the names of the other columns to read.
    ``file_name`` is the name of the file, for errors.

    Raises:
        InputError: The column contains no frames, or the file is damaged.
    """
    rows_read = 0
    with _convert_errors(file_name):
        # More columns mean fewer rows at once.
        row_count = max(inputs.CHUNK // (1 + len(kept_names)), 1)
        batches = file.iter_batches(batch_size=row_count, columns=[frame_column, *kept_names])
    while True:
        with _convert_errors(file_name):
            batch = next(batches, None)
            if batch is None:
                return
        try:
            frames = read_arrow(batch.column(frame_column), layout, storage.number_base, rows_before=rows_read)
        except NoFrame as error:
            row_number = rows_read + error.row + 1
            raise InputError(file_name, str(error), place=f"row {row_number} of column {quote(frame_column)}") from None
        except TypeError as error:
            raise InputError(file_name, str(error), place=f"column {quote(frame_column)}") from None
        rows_read += len(batch)
        other_columns = {column_name: batch.column(column_name) for column_name in kept_names}
        yield FrameBatch(frames, rows_read, other_columns)


@contextmanager
def _convert_errors(file_name: str) -> Generator[None, None, None]:
    """Convert the errors that pyarrow raises for an unreadable file to InputError. ``file_name`` is for the error."""
    arrow_error: Any = load("pyarrow").lib.ArrowException
    try:
        yield
    except InputError:
        raise
    except (arrow_error, OSError, ValueError, MemoryError) as error:
        # The first line of the message, or the type of an error without a message.
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        raise InputError(file_name, f"this is not a valid Parquet file: {reason}") from None
