# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Writes columns of decoded frames to Parquet, Arrow or CSV files, and converts them for other libraries."""

from __future__ import annotations

import csv
import io
import sys
from collections.abc import Callable, Mapping
from functools import cached_property
from math import isnan
from pathlib import PurePath
from types import TracebackType
from typing import Any, Final, Literal, NamedTuple, Protocol, cast

from ..bulk.conversion import WORDS, arrow_columns, list_texts
from ..bulk.table import Table
from ..packages import load

TargetKind = Literal["parquet", "arrow", "csv"]
_FORMAT_BY_SUFFIX: Final[dict[str, TargetKind]] = {
    ".parquet": "parquet",
    ".pq": "parquet",
    ".arrow": "arrow",
    ".feather": "arrow",
}

#: Number of CSV rows that are formatted at a time.
_ROWS_AT_ONCE: Final = 1 << 14
#: Number of CSV rows that are always formatted without pyarrow.
_FEW_ROWS: Final = 1000


def find_target_kind(path: str) -> TargetKind:
    """Return the format of a file according to its extension. Other extensions, or none, mean CSV."""
    return _FORMAT_BY_SUFFIX.get(PurePath(path).suffix.lower(), "csv")


class Plan(NamedTuple):
    """Columns of an output file.

    Attributes:
        names: Names of the columns, in order.
        source_columns: Columns of the source that are also written, each as an empty column: a list, or an array of
            Arrow or NumPy.
        empty_table: A table without frames.
        raw: True to write positions that are not usable.
    """

    names: tuple[str, ...]
    source_columns: Mapping[str, Any]
    empty_table: Table
    raw: bool = False

    @property
    def decoded_names(self) -> tuple[str, ...]:
        """Names of the columns that are decoded from frames."""
        return tuple(name for name in self.names if name not in self.source_columns)


class Sink(Protocol):
    """Output file to which tables are appended."""

    def __enter__(self) -> Sink: ...

    def __exit__(
        self, error_type: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def write(self, table: Table, other_columns: Mapping[str, Any]) -> None:
        """Append the frames of a table, and the other columns of the same rows."""

    @property
    def lost_cell_count(self) -> int:
        """Number of cells in other columns that were left empty because they are not numbers, unlike earlier cells."""
        ...


class TextConverter:
    """Converter from a text column to Arrow arrays of text, or of numbers if the first chunk contains only numbers.

    ``chosen_type`` is the Arrow type, which the first chunk determines. Before that, it is None. ``lost_cell_count`` is
    the number of cells that became null because they are not numbers.
    """

    def __init__(self) -> None:
        self._pyarrow: Any = load("pyarrow")
        self.chosen_type: Any = None
        self.lost_cell_count = 0

    def array(self, cells: Any) -> Any:
        """Return the cells of a chunk as an Arrow array. Empty cells become null.

        The first chunk determines the type (``chosen_type``). Later cells that do not fit the type become null, and are
        counted in ``lost_cell_count``.
        """
        if isinstance(cells, self._pyarrow.Array):
            has_number_type = self.chosen_type is not None and self.chosen_type != self._pyarrow.string()
            if has_number_type:
                try:
                    return cells.cast(self.chosen_type)
                except self._pyarrow.ArrowInvalid:
                    # Some cells are empty or not numbers. They are examined below.
                    pass
            compute: Any = load("pyarrow.compute")
            texts = compute.utf8_trim_whitespace(cells)
            texts = compute.if_else(compute.equal(texts, ""), None, texts)
        else:
            # The cells are a list of texts.
            texts = self._pyarrow.array([cell.strip() or None for cell in cells], self._pyarrow.string())
        if self.chosen_type is None:
            self.chosen_type = self._find_type(texts)
        try:
            return texts.cast(self.chosen_type)
        except self._pyarrow.ArrowInvalid:
            numbers = [self._cast_cell(cell) for cell in texts]
            # Cells that were null before are empty, not lost.
            null_count = sum(number is None for number in numbers)
            self.lost_cell_count += null_count - texts.null_count
            return self._pyarrow.array(numbers, self.chosen_type)

    def _find_type(self, texts: Any) -> Any:
        """Return the Arrow type for these texts: integer if all are integers, float if all are numbers, otherwise text.

        If all texts are null, the type is text.
        """
        has_text = texts.null_count < len(texts)
        number_types = (self._pyarrow.int64(), self._pyarrow.float64()) if has_text else ()
        for arrow_type in number_types:
            try:
                texts.cast(arrow_type)
            except self._pyarrow.ArrowInvalid:
                continue
            return arrow_type
        return self._pyarrow.string()

    def _cast_cell(self, cell: Any) -> Any:
        """Return a text cell as a number of type ``chosen_type``, or None if it is not a number."""
        try:
            return cell.cast(self.chosen_type).as_py()
        except self._pyarrow.ArrowInvalid:
            return None


class ArrowSink:
    """Parquet or Arrow file.

    The file is opened by the first ``write``, whose cells determine the types of the columns.
    """

    def __init__(self, file: Any, plan: Plan, parquet: bool) -> None:
        self._pyarrow: Any = load("pyarrow")
        self._file = file
        self._plan = plan
        self._parquet = parquet
        self._writer = cast(Any, None)
        self._text_converters = {
            name: TextConverter() for name, column in plan.source_columns.items() if isinstance(column, list)
        }

    def __enter__(self) -> ArrowSink:
        return self

    def __exit__(
        self, error_type: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error_type is None and self._writer is None:
            # Nothing was written: the file contains the columns, but no rows.
            self.write(self._plan.empty_table, self._plan.source_columns)
        if self._writer is not None:
            self._writer.close()

    @property
    def lost_cell_count(self) -> int:
        """Number of cells in other columns that were left empty because they are not numbers, unlike earlier cells."""
        return sum(converter.lost_cell_count for converter in self._text_converters.values())

    def write(self, table: Table, other_columns: Mapping[str, Any]) -> None:
        """Append the frames of a table, and the other columns of the same rows, in the order of the plan."""
        arrays = arrow_columns(table, self._plan.decoded_names, self._plan.raw)
        for name in self._plan.source_columns:
            column = other_columns[name]
            if name in self._text_converters:
                column = self._text_converters[name].array(column)
            elif hasattr(column, "dtype"):
                # A NumPy array. The only other columns are Arrow arrays, which need no conversion.
                column = self._pyarrow.array(column, from_pandas=True)
            arrays[name] = column
        columns = {name: arrays[name] for name in self._plan.names}
        if self._writer is None:
            # The first cells of other columns determine their types.
            column_types = [(name, column.type) for name, column in columns.items()]
            self._writer = self._open_writer(self._pyarrow.schema(column_types))
        self._writer.write(self._pyarrow.RecordBatch.from_arrays([*columns.values()], schema=self._writer_schema))

    def _open_writer(self, schema: Any) -> Any:
        """Return a writer for a file with these columns, and keep their schema for later tables."""
        self._writer_schema = schema
        if not self._parquet:
            return self._pyarrow.ipc.new_file(self._file, schema)
        decoded_names = self._plan.decoded_names
        integer_columns = [name for name in decoded_names if schema.field(name).type == "int64"]
        return load("pyarrow.parquet").ParquetWriter(
            self._file,
            schema,
            compression="zstd",
            compression_level=1,
            use_dictionary=[name for name in decoded_names if name in WORDS],
            # Successive positions differ little, so their differences take fewer bits and less time.
            column_encoding=dict.fromkeys(integer_columns, "DELTA_BINARY_PACKED"),
        )


class CsvSink:
    """CSV file with a header. It needs only NumPy. With pyarrow, the output is the same, but is written faster."""

    def __init__(self, file: Any, plan: Plan) -> None:
        # CSV keeps every cell as text, so no cell is ever lost.
        self._plan = plan
        self.lost_cell_count = 0
        # Without a file, the rows go to standard output.
        self._opened_file = io.TextIOWrapper(file, "utf-8", newline="") if file is not None else None
        self._output = self._opened_file or sys.stdout
        self._writer = csv.writer(self._output, lineterminator="\n")
        self._writer.writerow(plan.names)

    def __enter__(self) -> CsvSink:
        return self

    def __exit__(
        self, error_type: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error_type is None:
            self._output.flush()
        if self._opened_file is not None:
            # The caller closes the file.
            self._opened_file.detach()

    @cached_property
    def _formatter(self) -> _ArrowFormatter | None:
        """Formatter for many rows, or None if pyarrow is not installed."""
        try:
            return _ArrowFormatter(self._plan)
        except ImportError:
            return None

    def write(self, table: Table, other_columns: Mapping[str, Any]) -> None:
        """Append the frames of a table, and the other columns of the same rows."""
        # The formatter cannot write quotes, which an empty cell needs if it is alone in its row. For a few rows,
        # loading pyarrow would take longer than it saves.
        has_several_columns = len(self._plan.names) > 1
        formatter = self._formatter if has_several_columns and table.count > _FEW_ROWS else None
        # Cells as text take much memory, so only some rows are converted at once.
        for start in range(0, table.count, _ROWS_AT_ONCE):
            rows = slice(start, start + _ROWS_AT_ONCE)
            table_rows = table[rows]
            columns = {name: other_columns[name][rows] for name in self._plan.source_columns}
            csv_text = formatter.format_rows(table_rows, columns) if formatter is not None else None
            if csv_text is None:
                # There is no formatter, or a cell needs quotes.
                self._write_rows(table_rows, columns)
            else:
                self._output.write(csv_text)

    def _write_rows(self, table: Table, other_columns: Mapping[str, Any]) -> None:
        """Append rows with Python's CSV writer, which adds quotes where needed."""
        columns: list[list[Any]] = []
        for name in self._plan.names:
            if name in self._plan.source_columns:
                columns.append(_list_csv_cells(other_columns[name]))
            else:
                hidden = None if self._plan.raw else table.hidden(name)
                columns.append(_format_cells(name, table[name], hidden))
        self._writer.writerows(zip(*columns, strict=False))


def _format_cells(name: str, column: Any, hidden: Any) -> list[Any]:
    """Return the cells of a decoded column for CSV. ``hidden`` is True in rows whose cell must be empty, or None."""
    cells: list[Any] = column.tolist()
    # The kind of an array's type: O is objects, b bools, f floats, and S bytes.
    if column.dtype.kind == "O":
        # Decimals, without an exponent.
        cells = [f"{cell:f}" for cell in cells]
    if column.dtype.kind == "b":
        cells = ["true" if cell else "false" for cell in cells]
    if hidden is not None:
        # Only positions, flags and quantities have hidden cells. They are neither words nor NaN.
        return ["" if is_hidden else cell for cell, is_hidden in zip(cells, hidden.tolist(), strict=False)]
    if name in WORDS:
        # Faults and verdicts are stored as the index of their word.
        words = WORDS[name]
        return [words[index] for index in cells]
    if column.dtype.kind == "f":
        return ["" if isnan(cell) else cell for cell in cells]
    return list_texts(column) if column.dtype.kind == "S" else cells


class _ArrowFormatter:
    """Formatter that writes rows as CSV with pyarrow."""

    def __init__(self, plan: Plan) -> None:
        self._pyarrow: Any = load("pyarrow")
        self._pyarrow_csv: Any = load("pyarrow.csv")
        self._plan = plan
        self._options = self._pyarrow_csv.WriteOptions(include_header=False, quoting_style="none")

    def format_rows(self, table: Table, other_columns: Mapping[str, Any]) -> str | None:
        """Return the rows of a table and the other columns of the same rows as CSV, or None if a cell needs quotes."""
        columns: list[Any] = []
        for name in self._plan.names:
            if name in self._plan.source_columns:
                columns.append(self._convert_source(other_columns[name]))
            else:
                columns.append(self._convert_decoded(name, table))
        output = self._pyarrow.BufferOutputStream()
        # The names do not appear in the output.
        names = [str(index) for index in range(len(columns))]
        try:
            self._pyarrow_csv.write_csv(self._pyarrow.RecordBatch.from_arrays(columns, names), output, self._options)
        except self._pyarrow.ArrowInvalid:
            # pyarrow rejects cells that need quotes, because it must not write quotes here.
            return None
        return str(output.getvalue(), "utf-8")

    def _convert_decoded(self, name: str, table: Table) -> Any:
        """Return a decoded column for CSV, as an Arrow array."""
        column = table[name]
        hidden = None if self._plan.raw else table.hidden(name)
        if name in WORDS:
            # A fault or a verdict is the index of its word.
            words = self._pyarrow.array(WORDS[name], self._pyarrow.string())
            return words.take(self._pyarrow.array(column))
        is_bool_or_integer = column.dtype.kind in "bui"
        if is_bool_or_integer:
            return self._pyarrow.array(column, mask=hidden)
        return self._format_texts(_format_cells(name, column, hidden))

    def _convert_source(self, column: Any) -> Any:
        """Return a column of the source as an Arrow array for CSV.

        Integers, bools and texts in Arrow arrays stay unchanged. Other columns become text, as they do without
        pyarrow.
        """
        arrow_types = self._pyarrow.types
        arrow_type = getattr(column, "type", None)
        unchanged_kinds = (arrow_types.is_integer, arrow_types.is_boolean, arrow_types.is_string)
        if arrow_type is not None and any(is_kind(arrow_type) for is_kind in unchanged_kinds):
            return column
        return self._format_texts(_list_csv_cells(column))

    def _format_texts(self, cells: list[Any]) -> Any:
        """Return cells as an Arrow array of texts."""
        return self._pyarrow.array([str(cell) for cell in cells], self._pyarrow.string())


def _list_csv_cells(column: Any) -> list[Any]:
    """Return the cells of a column of the source for CSV. The column is a list, an Arrow array or a NumPy array."""
    # Arrow arrays have ``to_pylist``. Only cells of these columns can be None, bools or bytes, which become text here.
    # Lists contain texts. NumPy arrays, which have ``tolist``, contain numbers.
    if hasattr(column, "to_pylist"):
        return [_format_csv_cell(cell) for cell in column.to_pylist()]
    cells: list[Any] = column.tolist() if hasattr(column, "tolist") else column
    return cells


def _format_csv_cell(cell: Any) -> Any:
    """Return a cell of an Arrow array for CSV.

    None becomes empty text, a bool becomes ``true`` or ``false``, and bytes become hexadecimal text. Other cells stay
    unchanged.
    """
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    return cell.hex() if isinstance(cell, bytes) else cell


def _open_parquet(file: Any, plan: Plan) -> Sink:
    """Return the sink for a Parquet file."""
    return ArrowSink(file, plan, parquet=True)


def _open_arrow(file: Any, plan: Plan) -> Sink:
    """Return the sink for an Arrow file."""
    return ArrowSink(file, plan, parquet=False)


#: Writers by format.
SINKS: Final[Mapping[TargetKind, Callable[[Any, Plan], Sink]]] = {
    "parquet": _open_parquet,
    "arrow": _open_arrow,
    "csv": CsvSink,
}
