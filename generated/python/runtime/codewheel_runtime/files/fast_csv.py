# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads CSV files in blocks with pyarrow. Blocks with unusual content are read row by row, with the same result."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, BinaryIO, Final, NamedTuple

from ..bulk.shape import FrameLayout
from ..bulk.words import DigitKind
from ..packages import load
from .inputs import FIRST

np: Any = load("numpy")

#: Number of bytes that are read at a time. This is also the limit for a line.
BLOCK: Final = 1 << 21
#: Value of each hexadecimal digit by its character code. Other characters have 255.
_HEX_DIGIT_VALUES: Final = np.full(256, 255, np.uint8)
for _digit in range(16):
    _HEX_DIGIT_VALUES[[ord(f"{_digit:x}"), ord(f"{_digit:X}")]] = _digit


class Block(NamedTuple):
    """Rows of a block.

    Attributes:
        frames: The frames.
        other_columns: Cells of the other columns, by name.
        first_cells: Cells of the first frames, at most 1000, for the check of the first frames.
        last_cell: Cell of the last frame, or an empty string if there is none.
        line_count: Number of lines.
    """

    frames: Any
    other_columns: dict[str, Any]
    first_cells: list[str]
    last_cell: str
    line_count: int


def split_into_blocks(data: bytes, file: BinaryIO) -> Iterator[bytes]:
    """Yield blocks of whole lines from a file. The last block may end within a line.

    ``data`` is the part of the file that was read before. A line that is longer than a block ends the iteration,
    because the file is not CSV.
    """
    while next_data := file.read(BLOCK):
        data += next_data
        lines_end = data.rfind(b"\n") + 1
        if lines_end:
            yield data[:lines_end]
            data = data[lines_end:]
        elif len(data) > BLOCK:
            break
    if data:
        yield data


def has_a_row_per_line(block: bytes) -> bool:
    """Return whether each line of a block is a row: it has no comments, and its lines end only with LF or CRLF.

    With an odd number of quotes, the last row can continue in the next block, so the result is False.
    """
    if b"#" in block or (b'"' in block and block.count(b'"') % 2):
        return False
    # A single CR would also end a line.
    return b"\r" not in block or block.count(b"\r") == block.count(b"\r\n")


def ends_with_row(block: bytes, delimiter: str) -> bool:
    """Return whether a block ends with the end of a row. If quotes are in unusual places, the result is False."""
    if b'"' not in block:
        return True
    escaped = re.escape(delimiter.encode())
    # A cell in quotes is between delimiters or line ends. Quotes within it are doubled.
    cell_in_quotes = rb'(?<![^%b\r\n])"(?:[^"]|"")*"(?=[%b\r\n])' % (escaped, escaped)
    text_without_cells_in_quotes = re.sub(cell_in_quotes, b"", block)
    return b'"' not in text_without_cells_in_quotes


class JoinedBlocks(io.RawIOBase):
    """File whose contents are blocks of bytes, one after another."""

    def __init__(self, blocks: Iterable[bytes]) -> None:
        super().__init__()
        self._blocks = iter(blocks)
        self._data = b""

    def readable(self) -> bool:
        """Return True."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Fill the buffer, and return the number of bytes written, or 0 at the end of the blocks."""
        if not self._data:
            self._data = next(self._blocks, b"")
        part = self._data[: len(buffer)]
        self._data = self._data[len(buffer) :]
        buffer[: len(part)] = part
        return len(part)


class BlockReader:
    """Reader of blocks with pyarrow.

    Args:
        names: Names of all columns.
        frame_column: Index of the column of frames.
        kept_columns: Index and name of each other column to keep.
        delimiter: Character between two cells.
        layout: Description of the frames.
        digits: Base of numbers without ``0x``.

    Raises:
        ImportError: pyarrow is not installed.
    """

    def __init__(
        self,
        names: Sequence[str],
        frame_column: int,
        kept_columns: Sequence[tuple[int, str]],
        delimiter: str,
        layout: FrameLayout,
        digits: DigitKind | None,
    ) -> None:
        self._pyarrow: Any = load("pyarrow")
        self._pyarrow_compute: Any = load("pyarrow.compute")
        self._pyarrow_csv: Any = load("pyarrow.csv")
        self._frame_bytes = layout.byte_count
        self._digits: DigitKind | None = digits
        self._kept_names = [name for _, name in kept_columns]
        # Columns are named by their index, because names in the file can be equal.
        self._column_names = [str(index) for index in range(len(names))]
        # The column of frames comes first.
        wanted_names = [str(frame_column), *(str(index) for index, _ in kept_columns)]
        self._parse_options = self._pyarrow_csv.ParseOptions(delimiter=delimiter)
        self._convert_options = self._pyarrow_csv.ConvertOptions(
            include_columns=wanted_names,
            column_types=dict.fromkeys(wanted_names, self._pyarrow.string()),
            strings_can_be_null=False,
        )

    def read(self, block: bytes) -> Block | None:
        """Return the frames and the other columns of a block of whole lines.

        Return None if the block must be read row by row: a cell is missing, has a line end in quotes, or is not a frame
        in the usual form.
        """
        line_count = block.count(b"\n")
        try:
            table = self._read_table(block)
            has_line_end_in_quotes = table.num_rows != line_count and b'"' in block
            if has_line_end_in_quotes:
                return None
            # Column 0 contains the frames.
            cells = table.column(0).chunk(0) if table.num_rows else self._pyarrow.array([], self._pyarrow.string())
            frames = self._read_frames(cells)
        except self._pyarrow.ArrowInvalid:
            return None
        if frames is None:
            return None
        return Block(
            frames=frames,
            other_columns={
                name: table.column(index).combine_chunks() for index, name in enumerate(self._kept_names, start=1)
            },
            first_cells=cells.slice(0, FIRST).to_pylist(),
            last_cell=cells[-1].as_py() if len(cells) else "",
            line_count=line_count,
        )

    def _read_table(self, block: bytes) -> Any:
        """Return the cells of a block as a table of texts.

        The table has the column of frames, which ``_convert_options`` puts first, and the other columns to keep.

        Raises ArrowInvalid if a row has too few or too many cells.
        """
        read_options = self._pyarrow_csv.ReadOptions(
            column_names=self._column_names,
            use_threads=False,
            # pyarrow must not split the block.
            block_size=len(block) + 1,
        )
        block_file = self._pyarrow.BufferReader(block)
        table = self._pyarrow_csv.read_csv(block_file, read_options, self._parse_options, self._convert_options)
        return table.combine_chunks()

    def _read_frames(self, cells: Any) -> Any:
        """Return the frames in cells of text as numbers or rows of bytes, or None if they are not in the usual form."""
        if self._frame_bytes:
            return _read_bytes(cells, self._frame_bytes, self._pyarrow_compute)
        return _read_words(cells, self._digits, self._pyarrow, self._pyarrow_compute)


def _read_words(cells: Any, digits: DigitKind | None, pa: Any, pc: Any) -> Any:
    """Return the frames in cells of text as numbers, or None if the cells need the slower reader.

    Cells without ``0x`` are in the base ``digits``. If the base is hexadecimal, either all cells or none must begin
    with ``0x``. ``pa`` and ``pc`` are the modules of pyarrow. The conversion raises ArrowInvalid for cells that are not
    numbers.
    """

    def begins_with(text: str) -> Any:
        """Return whether each cell begins with ``text``, regardless of case."""
        return pc.starts_with(cells, text, ignore_case=True)

    all_have_prefix = pc.all(begins_with("0x"), min_count=0).as_py()
    if not all_have_prefix:
        has_binary_cell = pc.any(begins_with("0b"), min_count=0).as_py()
        if digits is None or has_binary_cell:
            return None
        if digits == "hex":
            any_has_prefix = pc.any(begins_with("0x"), min_count=0).as_py()
            if any_has_prefix:
                return None
            cells = pc.binary_join_element_wise("0x", cells, "")
    return cells.cast(pa.uint64()).to_numpy(zero_copy_only=False)


def _read_bytes(cells: Any, frame_bytes: int, pc: Any) -> Any:
    """Return the hexadecimal bytes in cells as an array with a row for each cell.

    Return None if there is no cell, or if a cell has a different length or is not hexadecimal. ``pc`` is the module
    ``pyarrow.compute``.
    """
    cells_without_spaces = pc.replace_substring(cells, " ", "")
    cell_count = len(cells_without_spaces)
    # Arrow stores the characters of all cells one after another in ``data``. Another buffer has the place of each cell
    # there, and the end of the last one. The array can be a slice of a longer array, which begins at ``first_cell``.
    _, starts_buffer, data = cells_without_spaces.buffers()
    first_cell = cells_without_spaces.offset
    cell_starts = np.frombuffer(starts_buffer, np.int32)[first_cell : first_cell + cell_count + 1]
    cell_lengths = np.diff(cell_starts)
    digits_per_cell = 2 * frame_bytes
    if not cell_count or (cell_lengths != digits_per_cell).any():
        return None
    characters = np.frombuffer(data, np.uint8, count=digits_per_cell * cell_count, offset=int(cell_starts[0]))
    digits = _HEX_DIGIT_VALUES[characters]
    # 255 represents a character that is not a hexadecimal digit.
    if digits.max() > 15:
        return None
    # Each cell has an even number of digits, so this also holds across the cells.
    high_digits = digits[::2]
    low_digits = digits[1::2]
    return ((high_digits << 4) | low_digits).reshape(cell_count, frame_bytes)
