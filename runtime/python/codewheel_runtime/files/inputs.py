# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Types that the file readers share, and the check of a file's first frames."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple

from ..bulk.words import DigitKind, WordKind, list_names, quote
from ..codec import shorten
from ..errors import InputError, UsageError
from ..packages import load

np: Any = load("numpy")

#: Number of frames read at once: large enough to keep the overhead low, small enough to limit memory use.
CHUNK: Final = 1 << 17
#: Number of rows read at a time if each cell is a separate object.
ROWS: Final = 1 << 16
#: Number of frames at the start of a file that are used to check whether it is read correctly.
FIRST: Final = 1000

FileKind = Literal["binary", "csv", "parquet"]
#: Function that decodes frames and returns the fraction of valid frames, from 0 to 1. It requires at least one frame.
ValidFraction = Callable[[Any], float]

#: Default names of the column that contains the frames.
_DEFAULT_COLUMNS: Final = ("frame", "word")


class StorageFormat(NamedTuple):
    """Storage format of the frames in a file.

    Attributes:
        kind: Format of the file. The default depends on its extension.
        word_form: Form of a frame of bits in a binary file. ``packed`` uses as few bytes as possible, most significant
            first. ``little`` and ``big`` are little-endian and big-endian numbers of eight bytes, ``little32`` and
            ``big32`` of four bytes.
        frame_column: Name of the column with the frames. For CSV, this may be its number, from 1. Empty for the
            default.
        number_base: Base of numbers in text without ``0x`` or ``0b``.
        ignores_incomplete_frame: True to ignore an incomplete frame at the end.
        wanted_columns: Names of the other columns to keep. Empty to keep all.
    """

    kind: FileKind | None = None
    word_form: WordKind = "packed"
    frame_column: str = ""
    number_base: DigitKind | None = None
    ignores_incomplete_frame: bool = False
    wanted_columns: Sequence[str] = ()

    def keeps(self, name: str) -> bool:
        """Return whether the column ``name``, which does not contain the frames, must be kept."""
        return not self.wanted_columns or name in self.wanted_columns


class FrameBatch(NamedTuple):
    """Frames in the form that ``decode_many`` expects, the other columns of the same rows, and the progress.

    ``amount_read`` is the amount of the source that has been read, in bytes or rows. A column is a list of strings or
    an Arrow array.
    """

    frames: Any
    amount_read: int
    other_columns: Mapping[str, Any] = MappingProxyType({})


class Source(NamedTuple):
    """Frames of a file, the total amount of data if known, and the other columns.

    ``other_names`` lists all other columns. ``empty_columns`` contains an empty column for each that is read.
    """

    batches: Generator[FrameBatch, None, None]
    total_amount: int | None
    other_names: tuple[str, ...] = ()
    empty_columns: Mapping[str, Any] = MappingProxyType({})


def select_columns(
    column_names: Iterable[str], storage: StorageFormat, make_empty_column: Callable[[str], Any], file_name: str
) -> dict[str, Any]:
    """Return empty columns for the names that the storage format keeps, by name.

    Each column is created by ``make_empty_column``. ``column_names`` are the names of all columns except the column of
    frames. ``file_name`` is the name of the file, for errors.

    Raises:
        UsageError: Two of these columns have the same name.
    """
    empty_columns: dict[str, Any] = {}
    for name in filter(storage.keeps, column_names):
        if name in empty_columns:
            raise UsageError(f"{file_name} has two columns {quote(name)}; rename one, or select the columns")
        empty_columns[name] = make_empty_column(name)
    return empty_columns


def find_column(column_names: list[str], requested_name: str, file_name: str) -> str:
    """Return the name of the column with the frames: the requested or only column, or one with a default name.

    ``column_names`` are the names of all columns, and ``requested_name`` is the requested name, or empty. ``file_name``
    is for errors.

    Raises:
        InputError: The column does not exist, or there are several such columns.
    """
    if requested_name:
        if column_names.count(requested_name) == 1:
            return requested_name
        problem = "several columns" if requested_name in column_names else "no column"
        raise InputError(file_name, f"{problem} {quote(requested_name)}; the columns are {list_names(column_names)}")
    usual_index = find_usual_column(column_names)
    if usual_index is None:
        raise InputError(file_name, f"choose the column with the frames; the columns are {list_names(column_names)}")
    return column_names[usual_index]


def find_usual_column(column_names: list[str]) -> int | None:
    """Return the index of the only column or the only column named ``frame`` or ``word``, otherwise None."""
    if len(column_names) == 1:
        return 0
    usual_indices = [index for index, name in enumerate(column_names) if name.lower() in _DEFAULT_COLUMNS]
    return usual_indices[0] if len(usual_indices) == 1 else None


def check_form(
    file_name: str, chosen_frames: Any, other_forms: Iterable[tuple[str, Any]], find_valid_fraction: ValidFraction
) -> None:
    """Raise an error if the first frames of a file fit another form far better than the chosen one.

    Args:
        file_name: Name of the file, for the error.
        chosen_frames: The first frames in the chosen form.
        other_forms: Command-line option of each other form, and the first frames in that form.
        find_valid_fraction: Function that returns the fraction of valid frames.

    Raises:
        InputError: At least one frame in ten has an error, but at most one in twenty would in one of ``other_forms``.
    """
    if not len(chosen_frames):
        return
    valid_fraction = find_valid_fraction(chosen_frames)
    if valid_fraction > 0.9:
        return
    for option, frames_in_other_form in other_forms:
        # One or two frames can be valid by chance.
        if len(frames_in_other_form) <= 2:
            continue
        other_fraction = find_valid_fraction(frames_in_other_form)
        if other_fraction >= 0.95:
            problem = f"{1 - valid_fraction:.0%} of the first {len(chosen_frames)} frames have an error"
            raise InputError(file_name, f"{problem}; with {option}, {other_fraction:.0%} are valid")


def read_seconds(cells: Any, source: str) -> Any:
    """Return a column of times in seconds as a NumPy array. An empty cell becomes NaN.

    ``cells`` is a list of texts, an Arrow array, or a NumPy array, which is returned unchanged. ``source`` is the name
    of the file, for the error.

    Raises:
        InputError: A cell is not a number, or is infinite.
    """
    # Only a NumPy array has a ``dtype``. Other columns are lists or Arrow arrays.
    if hasattr(cells, "dtype"):
        return cells
    cells = cells.to_pylist() if hasattr(cells, "to_pylist") else cells
    seconds: list[float] = []
    for cell in cells:
        try:
            time = np.nan if cell in (None, "") else float(cell)
        except (TypeError, ValueError):
            time = np.inf
        # Python also reads digits with underscores between them, and bools.
        if np.isinf(time) or isinstance(cell, bool) or "_" in str(cell):
            reason = f"expected numbers in seconds with a decimal point, got {shorten(cell)}"
            raise InputError(source, reason, place="column 'time'")
        seconds.append(time)
    return np.array(seconds, np.float64)
