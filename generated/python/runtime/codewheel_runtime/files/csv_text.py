# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from CSV files in chunks."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Generator, Iterable, Iterator
from itertools import chain, islice
from typing import BinaryIO, Final

from ..bulk.cells import Cells, read_text
from ..bulk.shape import Shape
from ..bulk.words import DigitKind, listed, short
from ..errors import InputError
from . import inputs
from .fast_csv import Block, Joined, ends_with_row, is_plain, reader, whole_lines
from .inputs import FIRST, Part, Share, Source, Stored, check_form, kept_columns, named_place

#: Limit for the length of a line. A longer one means that the file is not CSV.
_LONGEST: Final = 1 << 20


def read_csv_rows(file: BinaryIO, name: str, size: int | None, stored: Stored, shape: Shape, share: Share) -> Source:
    """Return the frames and the other columns of a CSV file.

    ``name`` and ``size`` in bytes are those of the file. ``share`` returns the fraction of valid frames.
    """
    blocks = whole_lines(b"", file)
    head = next(blocks, b"")
    lines = _Lines(_text_of([head]), name)
    delimiter, rows = _open_rows(lines)
    # The first row decides about the header and the columns. Then the rows are read again from its block.
    first_row = next(rows, None)
    if first_row is None:
        return Source(_nothing(), size)
    place, is_header = _place(first_row, name, stored, shape)
    header = [cell.strip() for cell in first_row] if is_header else [""] * len(first_row)
    names = [cell or f"column_{number}" for number, cell in enumerate(header, 1)]
    other_names = [(index, cell) for index, cell in enumerate(names) if index != place]
    empty_columns = kept_columns((cell for _, cell in other_names), stored, lambda _: [], name)
    columns = [(index, cell) for index, cell in other_names if cell in empty_columns]
    # Lines before the first row of frames: comments, empty lines and the header. ``start`` is their length in bytes.
    skipped = lines.number if is_header else lines.number - 1
    start = 0
    for _ in range(skipped):
        start = head.find(b"\n", start) + 1 or len(head)
    if b"\r" in head[:start].replace(b"\r\n", b""):
        # A line ends with a single CR, which only the reader of rows counts. It reads from the beginning, so it skips
        # the header itself.
        skipped, start = 0, 0
    table = _Table(lines, delimiter, place, columns, is_header and not start)
    read_fast = reader(names, place, columns, delimiter, shape, stored.digits) if start or not is_header else None
    parts = _read_parts(table, read_fast, chain([head[start:]], blocks), skipped, start, (name, stored, shape, share))
    return Source(parts, size, tuple(cell for _, cell in other_names), empty_columns)


def _text_of(blocks: Iterable[bytes]) -> io.TextIOWrapper:
    """Return blocks as one text file."""
    return io.TextIOWrapper(io.BufferedReader(Joined(blocks)), "utf-8-sig", "replace", newline="")


def _nothing() -> Generator[Part, None, None]:
    """Yield no frames."""
    yield from ()


class _Table:
    """Rows of a CSV file, read one by one: the delimiter, the column of frames, and the other columns to keep.

    ``place`` is the index of the column of frames, and ``count`` the number of rows that ``take`` returns at once.
    """

    def __init__(
        self, lines: _Lines, delimiter: str, place: int, columns: list[tuple[int, str]], skips_header: bool
    ) -> None:
        self.lines, self.delimiter, self.place, self.columns = lines, delimiter, place, columns
        self._skips_header = skips_header
        # Cells take memory, so more columns mean fewer rows at once.
        self.count = max(inputs.ROWS // (1 + len(columns)), 1)
        #: Frame in the last row that was read, as text.
        self._before = ""
        self._rows: Iterator[list[str]] = iter(())

    def open(self, blocks: Iterable[bytes], lines: int, done: int) -> None:
        """Read these blocks. ``lines`` and ``done`` are the numbers of lines and bytes before these blocks."""
        self.lines = _Lines(_text_of(blocks), self.lines.name, lines, done)
        self._rows = _open_rows(self.lines, self.delimiter)[1]
        if self._skips_header:
            next(self._rows, None)
            self._skips_header = False

    def take(self) -> tuple[list[str], list[int], dict[str, list[str]]]:
        """Return the cells of some frames, their line numbers, and the cells of other columns in the same rows by name.

        At the end of the blocks, all of them are empty.
        """
        cells: list[str] = []
        numbers: list[int] = []
        # Only cells are kept, because rows are lists, which the garbage collector would traverse repeatedly.
        other_columns: dict[str, list[str]] = {name: [] for _, name in self.columns}
        appenders = [(index, other_columns[name].append) for index, name in self.columns]
        lines, place = self.lines, self.place
        for row in islice(self._rows, self.count):
            cells.append(row[place] if len(row) > place else "")
            numbers.append(lines.number)
            for index, append in appenders:
                append(row[index] if len(row) > index else "")
        # The row before the last one can be in the previous batch.
        if lines.is_cut and cells and len(cells[-1]) < len(cells[-2] if len(cells) > 1 else self._before):
            # The last line is not terminated and is shorter than the previous one, so digits may be missing.
            cells[-1] = ""
        self._before = cells[-1] if cells else self._before
        return cells, numbers, other_columns

    def skip(self, last: str) -> None:
        """Remember the last cell of a block that was read in another way."""
        self._before = last


#: Name of the file for errors, storage format, description of the frames, and fraction of valid frames.
_Where = tuple[str, Stored, Shape, Share]


def _read_parts(
    table: _Table,
    read: Callable[[bytes], Block | None] | None,
    blocks: Iterator[bytes],
    lines: int,
    done: int,
    where: _Where,
) -> Generator[Part, None, None]:
    """Yield the frames of blocks. ``lines`` and ``done`` are the numbers of lines and bytes before the first block.

    ``read`` is the fast reader of a block, or None if there is none. It returns None for blocks with unusual content.
    ``table`` reads these row by row, and the rest of the file with them if a row may continue in the next block.
    """
    name, stored, shape, share = where
    cells, is_first = Cells(shape, stored.digits), True
    for block in blocks:
        is_whole = block.endswith(b"\n")
        parsed = read(block) if read is not None and is_whole and is_plain(block) else None
        if parsed is not None:
            lines, done = lines + parsed.lines, done + len(block)
            cells.seen += len(parsed.frames)
            if is_first and len(parsed.frames):
                _check_first(cells, parsed.first, name, stored, shape, share)
                is_first = False
            # The next block can end with an incomplete row, which is compared with this cell.
            table.skip(parsed.last)
            yield Part(parsed.frames, done, parsed.other_columns)
            continue
        # After a quote, a row can continue in the next block.
        is_alone = read is not None and is_plain(block) and ends_with_row(block, table.delimiter)
        table.open([block] if is_alone else chain([block], blocks), lines, done)
        while (batch := table.take())[0]:
            texts, numbers, other_columns = batch
            frames = [cells.read(text, number) for text, number in zip(texts, numbers, strict=False)]
            if is_first:
                _check_first(cells, texts[:FIRST], name, stored, shape, share)
                is_first = False
            yield Part(frames, table.lines.read, other_columns)
        # If the table has read all blocks, this was the last one.
        lines, done = lines + block.count(b"\n"), done + len(block)


def _check_first(cells: Cells, texts: list[str], name: str, stored: Stored, shape: Shape, share: Share) -> None:
    """Raise InputError if most of the first cells are not frames, or if they fit the other base much better.

    The base is checked only if ``--digits`` chose one: ``check_form`` compares the fraction of valid frames, which
    ``share`` returns, in both bases. ``cells`` has read the cells already, and ``texts`` are up to 1000 of them.
    """
    if cells.are_mostly_unread:
        raise InputError(name, f"line {cells.place}", cells.error)
    if stored.digits is not None and not shape.length:
        other_base: DigitKind = "hex" if stored.digits == "decimal" else "decimal"
        chosen_frames = _read(texts, shape, stored.digits)
        other_forms = [(f"--digits {other_base}", _read(texts, shape, other_base))]
        check_form(name, chosen_frames, other_forms, share)


def _read(texts: list[str], shape: Shape, digits: DigitKind) -> list[int | bytes]:
    """Return the frames in cells, read in this base. Cells without a frame are skipped."""
    cells = Cells(shape, digits)
    return [frame for text in texts if (frame := cells.read(text, 0)) is not None]


class _Lines:
    """Lines of a text, counted and limited in length. ``is_cut`` is True if the last one is not terminated.

    ``number`` is the number of the line, from 1, and ``read`` the number of characters so far.
    """

    def __init__(self, file: io.TextIOWrapper, name: str, number: int = 0, read: int = 0) -> None:
        self._file, self.name, self.number, self.read, self.is_cut = file, name, number, read, False

    def __iter__(self) -> Iterator[str]:
        """Yield the lines. Raises InputError if one is too long."""
        while line := self._file.readline(_LONGEST):
            self.number += 1
            self.read += len(line)
            if len(line) == _LONGEST:
                raise self.wrong(f"a line has more than {_LONGEST} characters: this is not a CSV file")
            self.is_cut = line[-1] not in "\r\n"
            yield line

    def wrong(self, message: str) -> InputError:
        """Return an error in the current line."""
        return InputError(self.name, f"line {self.number}", message)


def _open_rows(lines: _Lines, delimiter: str = "") -> tuple[str, Iterator[list[str]]]:
    """Return the delimiter and the rows of a CSV file.

    By default, the delimiter is the most frequent one of comma, semicolon and tab in the first line that is not empty
    and no comment.
    """
    texts = iter(lines)
    first_line = next(texts, "")
    while first_line and (not first_line.strip() or first_line.lstrip().startswith("#")):
        first_line = next(texts, "")
    delimiter = delimiter or max(",;\t", key=first_line.count)
    return delimiter, _check_row(lines, chain([first_line], texts), delimiter) if first_line else iter(())


def _check_row(lines: _Lines, texts: Iterable[str], delimiter: str) -> Iterator[list[str]]:
    """Yield rows, without empty ones and # comments."""
    try:
        for row in csv.reader(texts, delimiter=delimiter):
            # The row counts if its first cell is not empty and no comment, or if any other cell is not empty.
            start = row[0].lstrip() if row else ""
            if start[:1] != "#" and (start or any(cell.strip() for cell in row)):
                yield row
    except csv.Error as error:
        raise lines.wrong(str(error)) from None


def _place(first: list[str], name: str, stored: Stored, shape: Shape) -> tuple[int, bool]:
    """Return the index of the column of frames, and whether the first row is a header.

    The column is the requested one, by name or by number from 1, or the only one, or one named ``frame`` or ``word``.
    Names are those of a header. Otherwise the first row is a header if its cell in the column is not a frame.

    Raises:
        InputError: There is no such column.
    """
    names = [cell.strip() for cell in first]
    wanted = stored.column
    if wanted and wanted in names:
        return names.index(wanted), True
    if wanted:
        index = int(wanted) - 1 if wanted.isascii() and wanted.isdigit() and len(wanted) < 9 else -1
        if not 0 <= index < len(names):
            raise InputError(name, "line 1", f"no column {short(wanted)}; the columns are {listed(names)}")
    elif len(names) == 1:
        index = 0
    else:
        named_index = named_place(names)
        if named_index is None:
            raise InputError(name, "line 1", f"choose the column with the frames; the columns are {listed(names)}")
        return named_index, True
    # An empty cell is a missing frame, not a header.
    return index, bool(first[index].strip()) and not _is_frame(first[index], shape)


def _is_frame(text: str, shape: Shape) -> bool:
    """Return whether the text can be a frame: a number in hexadecimal with at least one decimal digit."""
    try:
        read_text(text, shape, "hex")
    except ValueError:
        return False
    # 'face' is a header, although it is also hexadecimal.
    return any(character.isdigit() for character in text)
