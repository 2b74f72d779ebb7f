# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads frames from text, and from CSV files in chunks."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Generator, Iterable, Iterator
from itertools import islice
from typing import BinaryIO, Final, TypeVar

from . import inputs
from .inputs import (
    FIRST,
    DigitKind,
    InputError,
    Part,
    Share,
    Source,
    Stored,
    check_form,
    kept_columns,
    listed,
    named_place,
    short,
)
from .shape import Shape

_Item = TypeVar("_Item")
#: Limit for the length of a line. A longer one means that the file is not CSV.
_LONGEST: Final = 1 << 20

_PREFIXED: Final = re.compile(r"0([xX][0-9a-fA-F]+|[bB][01]+)")
_HEX: Final = re.compile(r"[0-9a-fA-F]+")
_DECIMAL: Final = re.compile(r"[0-9]+")
#: Words for a missing value, in lower case.
_MISSING: Final = frozenset(("", "nan", "na", "n/a", "<na>", "null", "none"))


def of_text(text: str, shape: Shape, digits: DigitKind | None) -> int | bytes:
    """Return the frame that a text contains as hex bytes or as a number. Raises ValueError if there is none."""
    packed = text.replace(" ", "").replace("_", "")
    if shape.length:
        packed = packed[2:] if packed[:2] in ("0x", "0X") else packed
        if not _HEX.fullmatch(packed) or len(packed) % 2:
            raise ValueError(f"{short(text)} is not a row of hexadecimal bytes")
        return bytes.fromhex(packed)
    if _PREFIXED.fullmatch(packed):
        return int(packed, 0)
    pattern, base = (_DECIMAL, 10) if digits == "decimal" else (_HEX, 16)
    if not pattern.fullmatch(packed):
        raise ValueError(f"{short(text)} is not a {'decimal' if base == 10 else 'hexadecimal'} number")
    if digits is None:
        raise ValueError(f"{short(text)} can be decimal or hexadecimal; choose the digits, or put 0x in front")
    return int(packed, base)


class Cells:
    """Reader of text cells that contain frames. An empty cell, or one without a frame, yields None.

    ``seen`` is the number of cells that are not empty, and ``unread`` the number of those without a frame. ``place``
    and ``said`` are the location and the error message of the first of these.
    """

    def __init__(self, shape: Shape, digits: DigitKind | None) -> None:
        self._shape = shape
        self._digits: DigitKind | None = digits
        self.seen = self.unread = self.place = 0
        self.said = ""

    def read(self, text: str, place: int) -> int | bytes | None:
        """Return the frame in a cell, or None. ``place`` identifies the cell in errors."""
        if text[:2] == "0x" and not self._shape.length and text.isascii():
            # This is a fast path for the usual form. Other forms are handled below.
            try:
                number = int(text, 16)
            except ValueError:
                pass
            else:
                self.seen += 1
                return number
        try:
            frame = of_text(text, self._shape, self._digits)
        except ValueError as error:
            if text.strip().lower() in _MISSING:
                return None
            if not self.unread:
                self.place, self.said = place, str(error)
            self.seen += 1
            self.unread += 1
            return None
        self.seen += 1
        return frame

    @property
    def are_others(self) -> bool:
        """True if most cells do not contain frames."""
        return 2 * self.unread > self.seen


# CSV


def csv_rows(file: BinaryIO, name: str, size: int | None, stored: Stored, shape: Shape, share: Share) -> Source:
    """Return the frames and the other columns of a CSV file."""
    # The caller closes the file.
    text = io.TextIOWrapper(file, "utf-8-sig", "replace", newline="")
    try:
        lines = _Lines(text, name)
        rows = _rows(lines)
        first = next(rows, None)
        if first is None:
            text.detach()
            return Source(_nothing(), size)
        place, is_header = _place(first, name, stored, shape)
        names = [cell.strip() if is_header else "" for cell in first]
        names = [cell or f"column_{at}" for at, cell in enumerate(names, 1)]
        others = [(at, cell) for at, cell in enumerate(names) if at != place]
        kept = kept_columns((cell for _, cell in others), stored, lambda _: [], name)
        columns = [(at, cell) for at, cell in others if cell in kept]
        table = _Table(text, lines, rows if is_header else _chained(first, rows), place, columns)
        return Source(_parts(table, name, stored, shape, share), size, tuple(cell for _, cell in others), kept)
    except BaseException:
        text.detach()
        raise


def _nothing() -> Generator[Part, None, None]:
    yield from ()


class _Table:
    """Rows of a CSV file, the index of the column of frames, and the indices and names of other columns to keep."""

    def __init__(
        self,
        text: io.TextIOWrapper,
        lines: _Lines,
        rows: Iterator[list[str]],
        place: int,
        columns: list[tuple[int, str]],
    ) -> None:
        self.text, self.lines, self.rows, self.place, self.columns = text, lines, rows, place, columns
        # Cells take memory, so more columns mean fewer rows at once.
        self.count = max(inputs.ROWS // (1 + len(columns)), 1)
        self._before = ""

    def take(self) -> tuple[list[str], list[int], dict[str, list[str]]]:
        """Return the cells of some frames, their lines, and the cells of other columns in the same rows."""
        cells: list[str] = []
        numbers: list[int] = []
        # Only cells are kept, because rows are lists, which the garbage collector would traverse repeatedly.
        others: dict[str, list[str]] = {name: [] for _, name in self.columns}
        kept = [(at, others[name].append) for at, name in self.columns]
        lines, place = self.lines, self.place
        for row in islice(self.rows, self.count):
            cells.append(row[place] if len(row) > place else "")
            numbers.append(lines.number)
            for at, append in kept:
                append(row[at] if len(row) > at else "")
        if lines.is_cut and cells and len(cells[-1]) < len(cells[-2] if len(cells) > 1 else self._before):
            # The last line is not terminated and is shorter than the previous one, so digits may be missing.
            cells[-1] = ""
        self._before = cells[-1] if cells else ""
        return cells, numbers, others


def _parts(table: _Table, name: str, stored: Stored, shape: Shape, share: Share) -> Generator[Part, None, None]:
    cells, is_first = Cells(shape, stored.digits), True
    try:
        while True:
            texts, numbers, others = table.take()
            if not texts:
                return
            frames = [cells.read(*item) for item in zip(texts, numbers, strict=False)]
            if is_first:
                _check_first(cells, texts[:FIRST], name, stored, shape, share)
                is_first = False
            yield Part(frames, table.lines.read, others)
    finally:
        table.text.detach()


def _check_first(cells: Cells, texts: list[str], name: str, stored: Stored, shape: Shape, share: Share) -> None:
    """Raise InputError if the first cells are not frames, or if they are valid frames only in another base."""
    if cells.are_others:
        raise InputError(name, f"line {cells.place}", cells.said)
    if stored.digits is not None and not shape.length:
        other: DigitKind = "hex" if stored.digits == "decimal" else "decimal"
        own, fitting = _read(texts, shape, stored.digits), _read(texts, shape, other)
        check_form(name, own, [(f"--digits {other}", fitting)], share)


def _read(texts: list[str], shape: Shape, digits: DigitKind) -> list[int | bytes]:
    """Return the frames in cells. Cells without a frame are skipped."""
    cells = Cells(shape, digits)
    return [frame for text in texts if (frame := cells.read(text, 0)) is not None]


class _Lines:
    """Lines of a text, counted and limited in length. ``is_cut`` is True if the last one is not terminated."""

    def __init__(self, file: io.TextIOWrapper, name: str) -> None:
        self._file, self._name, self.number, self.read, self.is_cut = file, name, 0, 0, False

    def __iter__(self) -> Iterator[str]:
        while line := self._file.readline(_LONGEST):
            self.number += 1
            self.read += len(line)
            if len(line) == _LONGEST:
                raise self.wrong(f"a line has more than {_LONGEST} characters: this is not a CSV file")
            self.is_cut = line[-1] not in "\r\n"
            yield line

    def wrong(self, message: str) -> InputError:
        return InputError(self._name, f"line {self.number}", message)


def _rows(lines: _Lines) -> Iterator[list[str]]:
    """Yield the rows of a CSV file, without empty ones and # comments. The first line determines the delimiter."""
    found = iter(lines)
    first = next(found, "")
    while first and (not first.strip() or first.lstrip().startswith("#")):
        first = next(found, "")
    if not first:
        return
    between = max(",;\t", key=first.count)
    reader = csv.reader(_chained(first, found), delimiter=between)
    try:
        for row in reader:
            start = row[0].lstrip() if row else ""
            if start[:1] != "#" and (start or any(cell.strip() for cell in row)):
                yield row
    except csv.Error as error:
        raise lines.wrong(str(error)) from None


def _chained(first: _Item, others: Iterable[_Item]) -> Iterator[_Item]:
    yield first
    yield from others


def _place(first: list[str], name: str, stored: Stored, shape: Shape) -> tuple[int, bool]:
    """Return the index of the column of frames, and whether the first row is a header."""
    names = [cell.strip() for cell in first]
    wanted = stored.column
    if wanted and wanted in names:
        return names.index(wanted), True
    if wanted:
        place = int(wanted) - 1 if wanted.isascii() and wanted.isdigit() and len(wanted) < 9 else -1
        if not 0 <= place < len(names):
            raise InputError(name, "line 1", f"no column {short(wanted)}; the columns are {listed(names)}")
    elif len(names) == 1:
        place = 0
    else:
        named = named_place(names)
        if named is None:
            raise InputError(name, "line 1", f"choose the column with the frames; the columns are {listed(names)}")
        return named, True
    # An empty cell is a missing frame, not a header.
    return place, bool(first[place].strip()) and not _is_frame(first[place], shape)


def _is_frame(text: str, shape: Shape) -> bool:
    """Return whether the text can be a frame, and is not a header."""
    try:
        of_text(text, shape, "hex")
    except ValueError:
        return False
    # 'face' is a header, although it is also hexadecimal.
    return any(character.isdigit() for character in text)
