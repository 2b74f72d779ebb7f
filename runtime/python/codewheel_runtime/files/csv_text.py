# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from CSV files in chunks."""

from __future__ import annotations

import csv
import io
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Generator, Iterable, Iterator
from itertools import chain, islice
from typing import BinaryIO, Final, NamedTuple

from ..bulk.cells import TextCells, read_text
from ..bulk.shape import FrameLayout
from ..bulk.words import DigitKind, list_names, quote
from ..errors import InputError
from . import inputs
from .fast_csv import Block, BlockReader, JoinedBlocks, ends_with_row, has_a_row_per_line, split_into_blocks
from .inputs import (
    FIRST,
    FrameBatch,
    Source,
    StorageFormat,
    ValidFraction,
    check_form,
    find_usual_column,
    select_columns,
)

#: Limit for the length of a line. If a line is longer, the file is not CSV.
_LONGEST_LINE: Final = 1 << 20


def read_csv_rows(
    file: BinaryIO,
    file_name: str,
    size: int | None,
    storage: StorageFormat,
    layout: FrameLayout,
    find_valid_fraction: ValidFraction,
) -> Source:
    """Read the first rows of a CSV file, and return a source that reads the frames and the other columns later.

    ``file_name`` and ``size`` in bytes describe the file. ``find_valid_fraction`` returns the fraction of valid frames,
    for the check of the first frames.

    Raises:
        InputError: The text is UTF-16, there is no such column, or the first row cannot be read.
        UsageError: Two of the other columns to keep have the same name.
    """
    blocks = split_into_blocks(b"", file)
    first_block = next(blocks, b"")
    if first_block.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        raise InputError(file_name, "the text is UTF-16: save the file as UTF-8")
    lines = _Lines(_open_text([first_block]), file_name)
    delimiter, rows = _open_rows(lines)
    # The first row decides about the header and the columns. Then the rows are read again from its block.
    first_row = next(rows, None)
    if first_row is None:
        return Source(_yield_no_parts(), size)
    columns_of_file = _find_columns(first_row, file_name, storage, layout)
    other_names = tuple(column_name for _, column_name in columns_of_file.other_columns)
    empty_columns = select_columns(other_names, storage, lambda _: [], file_name)
    kept_columns = [(index, name) for index, name in columns_of_file.other_columns if name in empty_columns]
    first_frame = _find_first_frame(first_block, lines.line_number, columns_of_file.has_header)
    skips_header = first_frame.is_before_header
    # Only the slow reader skips a header.
    fast_reader = None if skips_header else _make_fast_reader(columns_of_file, kept_columns, delimiter, layout, storage)
    slow_reader = _SlowReader(lines, delimiter, columns_of_file.frame_column, kept_columns, skips_header)
    csv_file = _CsvFile(file_name, storage, layout, find_valid_fraction)
    parts = _CsvParts(csv_file, fast_reader, slow_reader, first_frame)
    remaining_blocks = chain([first_block[first_frame.offset :]], blocks)
    return Source(parts.read(remaining_blocks), size, other_names, empty_columns)


class _Columns(NamedTuple):
    """Columns of a file.

    Attributes:
        names: Names of all columns. Without a header, or without a name in it, they are numbered from 1.
        frame_column: Index of the column of frames.
        other_columns: Index and name of each other column.
        has_header: True if the first row contains the names.
    """

    names: list[str]
    frame_column: int
    other_columns: list[tuple[int, str]]
    has_header: bool


def _find_columns(first_row: list[str], file_name: str, storage: StorageFormat, layout: FrameLayout) -> _Columns:
    """Return the columns of a file according to its first row, which can be a header.

    Raises the error of ``_find_frame_column``.
    """
    frame_column, has_header = _find_frame_column(first_row, file_name, storage, layout)
    column_titles = [cell.strip() for cell in first_row] if has_header else [""] * len(first_row)
    names = [cell or f"column_{number}" for number, cell in enumerate(column_titles, 1)]
    other_columns = [(index, name) for index, name in enumerate(names) if index != frame_column]
    return _Columns(names, frame_column, other_columns, has_header)


class _Start(NamedTuple):
    """Where reading starts: offset in bytes, number of lines before it, and True if the header still follows."""

    offset: int
    lines_before: int
    is_before_header: bool


def _find_first_frame(first_block: bytes, first_row_line: int, has_header: bool) -> _Start:
    """Return the start of the first row with a frame, after comments, empty lines and the header.

    ``first_block`` is the first block of the file, and ``first_row_line`` the number of the line of its first row,
    which is the header if ``has_header`` is True.
    """
    lines_before = first_row_line if has_header else first_row_line - 1
    offset = _find_line(first_block, lines_before)
    has_single_cr = b"\r" in first_block[:offset].replace(b"\r\n", b"")
    if has_single_cr:
        # Only the slow reader counts lines that end with a single CR. It reads from the beginning, and skips the header
        # itself.
        return _Start(offset=0, lines_before=0, is_before_header=has_header)
    return _Start(offset, lines_before, is_before_header=has_header and not offset)


def _make_fast_reader(
    columns: _Columns, kept_columns: list[tuple[int, str]], delimiter: str, layout: FrameLayout, storage: StorageFormat
) -> BlockReader | None:
    """Return a reader of blocks, or None if pyarrow is not installed."""
    try:
        return BlockReader(columns.names, columns.frame_column, kept_columns, delimiter, layout, storage.number_base)
    except ImportError:
        return None


def _find_line(data: bytes, line_count: int) -> int:
    """Return the offset of the byte after the first ``line_count`` lines, or the length of the data if it has fewer."""
    offset = 0
    for _ in range(line_count):
        line_end = data.find(b"\n", offset)
        offset = len(data) if line_end < 0 else line_end + 1
    return offset


def _open_text(blocks: Iterable[bytes]) -> io.TextIOWrapper:
    """Return blocks of bytes as a single text file."""
    return io.TextIOWrapper(io.BufferedReader(JoinedBlocks(blocks)), "utf-8-sig", "replace", newline="")


def _yield_no_parts() -> Generator[FrameBatch, None, None]:
    """Yield no frames (for a file without rows)."""
    yield from ()


class _Batch(NamedTuple):
    """Frame cells of some rows, their line numbers, and the cells of other columns in the same rows, by name."""

    cells: list[str]
    line_numbers: list[int]
    other_columns: dict[str, list[str]]


class _SlowReader:
    """Row-by-row reader of a CSV file, for any contents.

    ``frame_column`` is the index of the column of frames, and ``kept_columns`` are the indices and names of the other
    columns to keep. ``rows_at_once`` is the number of rows that are read at a time.
    """

    def __init__(
        self, lines: _Lines, delimiter: str, frame_column: int, kept_columns: list[tuple[int, str]], skips_header: bool
    ) -> None:
        self.lines = lines
        self.delimiter = delimiter
        self.frame_column = frame_column
        self.kept_columns = kept_columns
        self._skips_header = skips_header
        # Cells take memory, so more columns mean fewer rows at once.
        self.rows_at_once = max(inputs.ROWS // (1 + len(kept_columns)), 1)
        #: Frame in the last row that was read, as text.
        self._last_cell = ""
        self._rows: Iterator[list[str]] = iter(())

    def open(self, blocks: Iterable[bytes], lines_before: int, bytes_before: int) -> None:
        """Start reading these blocks. ``lines_before`` and ``bytes_before`` count the lines and bytes before them."""
        self.lines = _Lines(_open_text(blocks), self.lines.file_name, lines_before, bytes_before)
        _, self._rows = _open_rows(self.lines, self.delimiter)
        if self._skips_header:
            next(self._rows, None)
            self._skips_header = False

    def read_batch(self) -> _Batch:
        """Return the cells of the next rows. At the end of the blocks, there are no cells.

        A missing cell counts as empty. A frame at the end of the file that may be cut off also counts
        as empty.
        """
        cells: list[str] = []
        line_numbers: list[int] = []
        # Only cells are kept, because rows are lists, which the garbage collector would traverse repeatedly.
        other_columns: dict[str, list[str]] = {name: [] for _, name in self.kept_columns}
        appenders = [(index, other_columns[name].append) for index, name in self.kept_columns]
        lines = self.lines
        frame_column = self.frame_column
        for row in islice(self._rows, self.rows_at_once):
            cells.append(row[frame_column] if len(row) > frame_column else "")
            line_numbers.append(lines.line_number)
            for index, append in appenders:
                append(row[index] if len(row) > index else "")
        if cells:
            # The cell before the last one can be in the previous batch.
            cell_before = cells[-2] if len(cells) > 1 else self._last_cell
            # A file that ends without a line end can have been cut off within its last cell.
            may_miss_digits = lines.is_cut and len(cells[-1]) < len(cell_before)
            if may_miss_digits:
                cells[-1] = ""
            self._last_cell = cells[-1]
        return _Batch(cells, line_numbers, other_columns)

    def remember_last_cell(self, cell: str) -> None:
        """Remember the last cell of a block that the fast reader has read."""
        self._last_cell = cell


class _CsvFile(NamedTuple):
    """Name of the file for errors, form and description of its frames, and function for the valid fraction."""

    file_name: str
    storage: StorageFormat
    layout: FrameLayout
    find_valid_fraction: ValidFraction


class _CsvParts:
    """Frames of a file, read block by block.

    Args:
        csv_file: The file.
        fast_reader: Reader of blocks, or None if pyarrow is not installed.
        slow_reader: Reader of the blocks that ``fast_reader`` cannot read. If a row may continue in the next block, it
            reads the rest of the file.
        start: Where the first block starts.
    """

    def __init__(
        self, csv_file: _CsvFile, fast_reader: BlockReader | None, slow_reader: _SlowReader, start: _Start
    ) -> None:
        self._csv_file = csv_file
        self._fast_reader = fast_reader
        self._slow_reader = slow_reader
        self._bytes_read = start.offset
        self._lines_read = start.lines_before
        self._cells = TextCells(csv_file.layout, csv_file.storage.number_base)
        self._are_first_cells_checked = False

    def read(self, blocks: Iterator[bytes]) -> Generator[FrameBatch, None, None]:
        """Yield the frames of all blocks, with the other columns of the same rows and the progress."""
        for block in blocks:
            has_a_row_in_each_line = self._fast_reader is not None and has_a_row_per_line(block)
            fast_block = self._read_fast(block) if has_a_row_in_each_line else None
            if fast_block is not None:
                yield FrameBatch(fast_block.frames, self._bytes_read, fast_block.other_columns)
                continue
            # After a quote, a row can continue in the next block.
            ends_here = has_a_row_in_each_line and ends_with_row(block, self._slow_reader.delimiter)
            yield from self._read_slowly([block] if ends_here else chain([block], blocks))
            # If the slow reader has read all blocks, this was the last one.
            self._lines_read += block.count(b"\n")
            self._bytes_read += len(block)

    def _read_fast(self, block: bytes) -> Block | None:
        """Return the rows of a block, or None if its content is unusual, or if it ends within a line."""
        has_whole_lines = block.endswith(b"\n")
        fast_block = self._fast_reader.read(block) if self._fast_reader is not None and has_whole_lines else None
        if fast_block is None:
            return None
        self._lines_read += fast_block.line_count
        self._bytes_read += len(block)
        self._cells.nonempty_count += len(fast_block.frames)
        self._check_first_cells(fast_block.first_cells)
        # The next block can end with an incomplete row, which is compared with this cell.
        self._slow_reader.remember_last_cell(fast_block.last_cell)
        return fast_block

    def _read_slowly(self, blocks: Iterable[bytes]) -> Iterator[FrameBatch]:
        """Yield the frames of blocks that are read row by row."""
        reader = self._slow_reader
        reader.open(blocks, self._lines_read, self._bytes_read)
        read_cell = self._cells.read
        while (batch := reader.read_batch()).cells:
            frames = [read_cell(text, number) for text, number in zip(batch.cells, batch.line_numbers, strict=False)]
            self._check_first_cells(batch.cells[:FIRST])
            yield FrameBatch(frames, reader.lines.amount_read, batch.other_columns)

    def _check_first_cells(self, texts: list[str]) -> None:
        """Check the first cells of the file once. Raises the error of ``_check_first_cells``."""
        if texts and not self._are_first_cells_checked:
            self._are_first_cells_checked = True
            _check_first_cells(self._cells, texts, self._csv_file)


def _check_first_cells(cells: TextCells, texts: list[str], csv_file: _CsvFile) -> None:
    """Raise InputError if most of the first cells are not frames or are more likely in another base.

    Another base is tried only for frames of bits, and only if ``--digits`` chose a base: ``check_form`` compares the
    fraction of valid frames in both bases. ``cells`` has read the cells already, and ``texts`` are the first cells, at
    most 1000.
    """
    file_name, storage, layout, find_valid_fraction = csv_file
    has_bits = not layout.byte_count
    if cells.are_mostly_unread:
        raise InputError(file_name, cells.error, place=f"line {cells.error_place}")
    if storage.number_base is not None and has_bits:
        other_base: DigitKind = "hex" if storage.number_base == "decimal" else "decimal"
        chosen_frames = _read_frames(texts, layout, storage.number_base)
        other_forms = [(f"--digits {other_base}", _read_frames(texts, layout, other_base))]
        check_form(file_name, chosen_frames, other_forms, find_valid_fraction)


def _read_frames(texts: list[str], layout: FrameLayout, digits: DigitKind) -> list[int | bytes]:
    """Return the frames in cells of text, read in this base. Cells without a frame are skipped."""
    cells = TextCells(layout, digits)
    frames = [cells.read(text, cell_place=0) for text in texts]
    return [frame for frame in frames if frame is not None]


class _Lines:
    """Iterator over the lines of a text that counts them and limits their length.

    ``line_number`` is the number of the last line, counted from 1. ``amount_read`` is the amount read so far: the bytes
    before these lines, and the characters of these lines. ``is_cut`` is True if the last line is not terminated.
    """

    def __init__(self, file: io.TextIOWrapper, file_name: str, line_number: int = 0, amount_read: int = 0) -> None:
        self._file = file
        self.file_name = file_name
        self.line_number = line_number
        self.amount_read = amount_read
        self.is_cut = False

    def __iter__(self) -> Iterator[str]:
        """Yield the lines. Raises InputError if a line is too long."""
        while line := self._file.readline(_LONGEST_LINE):
            self.line_number += 1
            self.amount_read += len(line)
            if len(line) == _LONGEST_LINE:
                raise self.make_error(f"a line has more than {_LONGEST_LINE} characters: this is not a CSV file")
            self.is_cut = line[-1] not in "\r\n"
            yield line

    def make_error(self, message: str) -> InputError:
        """Return an error in the current line."""
        return InputError(self.file_name, message, place=f"line {self.line_number}")


def _open_rows(lines: _Lines, delimiter: str = "") -> tuple[str, Iterator[list[str]]]:
    """Return the delimiter and the rows of a CSV file.

    By default, the delimiter is the comma, semicolon or tab that is most frequent in the first line that is neither
    empty nor a comment.
    """
    texts = iter(lines)
    first_line = next(texts, "")
    while first_line and (not first_line.strip() or first_line.lstrip().startswith("#")):
        first_line = next(texts, "")
    delimiter = delimiter or max(",;\t", key=first_line.count)
    if not first_line:
        return delimiter, iter(())
    return delimiter, _split_rows(lines, chain([first_line], texts), delimiter)


def _split_rows(lines: _Lines, texts: Iterable[str], delimiter: str) -> Iterator[list[str]]:
    """Yield the rows of a CSV file, without empty rows and # comments.

    ``texts`` are the lines, and ``lines`` counts them for errors.
    """
    try:
        for row in csv.reader(texts, delimiter=delimiter):
            first_cell = row[0].lstrip() if row else ""
            is_comment = first_cell.startswith("#")
            # The first cell is tested by itself, because it alone decides for most rows.
            is_empty = not first_cell and not any(cell.strip() for cell in row)
            if not is_comment and not is_empty:
                yield row
    except csv.Error as error:
        raise lines.make_error(str(error)) from None


class _FrameColumn(NamedTuple):
    """Index of the column of frames, and True if the first row is a header."""

    frame_column: int
    has_header: bool


def _find_frame_column(
    first_row: list[str], file_name: str, storage: StorageFormat, layout: FrameLayout
) -> _FrameColumn:
    """Return the index of the column of frames, and whether the first row is a header.

    The column is the requested one (by name, or by number from 1), the only column, or a column named ``frame`` or
    ``word``. Names come from a header. Otherwise the first row is a header if its cell in this column is not a frame.
    ``file_name`` is for errors, and ``storage.column`` is the requested column.

    Raises:
        InputError: There is no such column, or none is requested and it is not clear which one to use.
    """
    column_names = [cell.strip() for cell in first_row]
    requested_column = storage.frame_column
    if requested_column and requested_column in column_names:
        return _FrameColumn(column_names.index(requested_column), has_header=True)
    if requested_column:
        is_number = requested_column.isascii() and requested_column.isdigit() and len(requested_column) < 9
        column_number = int(requested_column) if is_number else 0
        if not 1 <= column_number <= len(column_names):
            reason = f"no column {quote(requested_column)}; the columns are {list_names(column_names)}"
            raise InputError(file_name, reason, place="line 1")
        column_index = column_number - 1
    elif len(column_names) == 1:
        column_index = 0
    else:
        usual_index = find_usual_column(column_names)
        if usual_index is None:
            reason = f"choose the column with the frames; the columns are {list_names(column_names)}"
            raise InputError(file_name, reason, place="line 1")
        return _FrameColumn(usual_index, has_header=True)
    # An empty cell is a missing frame, not a header.
    first_cell = first_row[column_index]
    is_empty = not first_cell.strip()
    return _FrameColumn(column_index, has_header=not is_empty and not _is_frame(first_cell, layout))


def _is_frame(text: str, layout: FrameLayout) -> bool:
    """Return whether text can be a frame: a hexadecimal number with at least one decimal digit."""
    try:
        read_text(text, layout, "hex")
    except ValueError:
        return False
    # 'face' is a header, although it is also hexadecimal.
    return any(character.isdigit() for character in text)
