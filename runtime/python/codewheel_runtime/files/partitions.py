# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes the frames in partitions of data frames, for example Arrow or pandas data frames."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, cast

from ..bulk.arrow import read_arrow
from ..bulk.cells import TextCells
from ..bulk.conversion import arrow_columns, pandas_columns
from ..bulk.decode import decode_many
from ..bulk.shape import FrameLayout
from ..bulk.words import DigitKind
from ..encoder import Encoder
from ..errors import InputError, UsageError
from ..packages import load
from .inputs import find_column

#: Name of a partition in messages.
_PARTITION_NAME = "the partition"


class PartitionDecoder(NamedTuple):
    """Decoder of partitions.

    Attributes:
        encoder: The encoder.
        layout: Description of its frames.
        frame_column: Name of the column with the frames. Empty for the default.
        digits: Base of numbers in text without ``0x``: ``hex`` or ``decimal``.
        raw: True to keep positions that are not usable.
    """

    encoder: Encoder
    layout: FrameLayout
    frame_column: str
    digits: DigitKind | None
    raw: bool

    def decode(self, partition: Any) -> Any:
        """Return the partition without the column of frames, and with the fields after the other columns.

        Raises:
            TypeError: ``partition`` is not a table.
            InputError: There is no column of frames.
            UsageError: Another column has the name of a field.
        """
        library = type(partition).__module__.partition(".")[0]
        class_name = type(partition).__name__
        if library == "pyarrow" and class_name in ("Table", "RecordBatch"):
            return self._decode_arrow(partition)
        if library == "pandas" and class_name == "DataFrame":
            return self._decode_pandas(partition)
        if hasattr(partition, "__arrow_c_stream__") or hasattr(partition, "__arrow_c_array__"):
            return self._decode_arrow(load("pyarrow").table(partition))
        raise TypeError(f"expected a table of Arrow, pandas, polars or DuckDB, got {class_name}")

    def _decode_arrow(self, partition: Any) -> Any:
        """Return an Arrow table: the columns except the column of frames, then the decoded columns.

        ``digits`` is the base of numbers in text without ``0x``.
        """
        names = list(partition.schema.names)
        frame_column_name = find_column(names, self.frame_column, _PARTITION_NAME)
        try:
            frame_column = partition.column(names.index(frame_column_name))
            frames = read_arrow(frame_column, self.layout, self.digits)
            decoded_table = decode_many(frames, self.layout, self.encoder)
        except (TypeError, ValueError) as error:
            raise InputError(_PARTITION_NAME, str(error), place=f"column {frame_column_name!r}") from None
        decoded_columns = arrow_columns(decoded_table, decoded_table.names, self.raw)
        # Columns can have the same name, so they are selected by their index.
        kept_columns = {name: partition.column(index) for index, name in enumerate(names) if name != frame_column_name}
        check_distinct_names(kept_columns, decoded_columns, _PARTITION_NAME)
        columns = {**kept_columns, **decoded_columns}
        return partition.__class__.from_arrays([*columns.values()], names=[*columns])

    def _decode_pandas(self, partition: Any) -> Any:
        """Return a pandas DataFrame: the columns except the column of frames, then the decoded columns."""
        names = [str(label) for label in partition.columns]
        frame_column_name = find_column(names, self.frame_column, _PARTITION_NAME)
        column_index = names.index(frame_column_name)
        try:
            frame_column = partition.iloc[:, column_index]
            frames = _read_series(frame_column, self.layout, self.digits)
            decoded_table = decode_many(frames, self.layout, self.encoder)
        except (TypeError, ValueError) as error:
            raise InputError(_PARTITION_NAME, str(error), place=f"column {frame_column_name!r}") from None
        decoded_columns = pandas_columns(decoded_table, decoded_table.names, self.raw)
        # The label of a column in pandas can be another type than text.
        frame_column_label = partition.columns[column_index]
        kept_part = partition.drop(columns=[frame_column_label])
        kept_names = [str(label) for label in kept_part.columns]
        check_distinct_names(kept_names, decoded_columns, _PARTITION_NAME)
        return kept_part.assign(**decoded_columns)


def _read_series(series: Any, layout: FrameLayout, digits: DigitKind | None) -> Any:
    """Convert a pandas column to the form that ``decode_many`` expects. Missing items are None or NaN.

    Integers stay an array, and so do floats for frames of bits. Other columns become a list of frames. ``digits`` is
    the base of numbers in text that have no ``0x``.

    Raises:
        ValueError: Most cells of text contain no frame.
        TypeError: A cell is not a frame.
    """
    frames: Any = series.to_numpy()
    has_bits = not layout.byte_count
    if frames.dtype.kind in "ui" or (frames.dtype.kind == "f" and has_bits):
        return frames
    cells = TextCells(layout, digits)
    missing = series.isna().tolist()
    cell_frames: list[Any] = []
    for row, cell in enumerate(frames.tolist()):
        cell_frames.append(None if missing[row] else _read_cell(cell, layout, cells, row))
    if cells.are_mostly_unread:
        raise ValueError(f"row {cells.error_place + 1}: {cells.error}")
    return cell_frames


def _read_cell(cell: object, layout: FrameLayout, cells: TextCells, row: int) -> Any:
    """Return the frame in a cell that is text, bytes or an integer.

    ``cells`` is the reader of text, which returns None for a cell without a frame. ``row`` is the number of the row,
    for errors.

    Raises:
        TypeError: The cell has another type, or is a number for a frame of bytes.
    """
    if isinstance(cell, str):
        return cells.read(cell, row)
    if isinstance(cell, (bytes, bytearray, memoryview)):
        data = bytes(cast(bytes, cell))
        return data if layout.byte_count else int.from_bytes(data, "big")
    if isinstance(cell, int) and not layout.byte_count:
        return cell
    raise TypeError(f"{str(cell)[:40]!r} is not a frame of this encoder")


def check_distinct_names(source_columns: Iterable[str], decoded_columns: Iterable[str], source: str) -> None:
    """Raise UsageError if one of ``source_columns`` has the name of a decoded column. ``source`` names their file."""
    shared = sorted({*source_columns} & {*decoded_columns})
    if shared:
        raise UsageError(
            f"{source} already has a column '{shared[0]}', which the decoded frames also have: "
            "rename it, or select other columns"
        )
