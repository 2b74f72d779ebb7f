# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Types shared by the file readers, and the check of a file's first frames."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple

np: Any = import_module("numpy")

#: Number of frames read at once: large enough to keep the overhead low, small enough to limit memory use.
CHUNK: Final = 1 << 17
#: Number of rows read at once if each cell is a separate object.
ROWS: Final = 1 << 16
#: Number of frames at the start of a file that are used to check whether it is read correctly.
FIRST: Final = 1000

FileKind = Literal["binary", "csv", "parquet"]
WordKind = Literal["packed", "little", "big", "little32", "big32"]
DigitKind = Literal["hex", "decimal"]

#: Number of bytes and byte order of a word. Packed words have as many bytes as their bits need.
WORDS: Final[Mapping[WordKind, tuple[int, str]]] = MappingProxyType(
    {
        "packed": (0, ">"),
        "little": (8, "<"),
        "big": (8, ">"),
        "little32": (4, "<"),
        "big32": (4, ">"),
    }
)

#: Function that returns the fraction of valid frames.
Share = Callable[[Any], float]

#: Default names of the column that contains the frames.
_NAMES: Final = ("frame", "word")


class InputError(ValueError):
    """A file does not contain the expected frames.

    Attributes:
        file: Name of the file.
        place: Offset, line, row or column.
        message: What is wrong.
    """

    def __init__(self, file: str, place: str, message: str) -> None:
        super().__init__(file, place, message)
        self.file, self.place, self.message = file, place, message

    def __str__(self) -> str:
        return f"{self.file}{', ' if self.place else ''}{self.place}: {self.message}"


class UsageError(ValueError):
    """The arguments are wrong, regardless of the contents of the file."""


class Stored(NamedTuple):
    """Storage format of the frames in a file.

    Attributes:
        kind: Format of the file. The default depends on its extension.
        words: Form of a frame of bits in a binary file. ``packed`` uses as few bytes as possible, most significant
            first. ``little`` and ``big`` are little-endian and big-endian numbers of eight bytes, ``little32`` and
            ``big32`` of four bytes.
        column: Name of the column with the frames. For CSV, this may be its number, from 1. Empty for the default.
        digits: Base of numbers in text without ``0x`` or ``0b``.
        cut: True to ignore an incomplete frame at the end.
        wanted: Names of the other columns to keep. Empty to keep all.
    """

    kind: FileKind | None = None
    words: WordKind = "packed"
    column: str = ""
    digits: DigitKind | None = None
    cut: bool = False
    wanted: Sequence[str] = ()

    def keeps(self, name: str) -> bool:
        """Return True if the column ``name``, which does not contain the frames, is to be kept."""
        return not self.wanted or name in self.wanted


class Part(NamedTuple):
    """Frames in the form that ``decode_many`` expects, the other columns of the same rows, and the progress.

    ``done`` is the amount of the source that has been read, in bytes or rows. A column is a list of strings or an Arrow
    array.
    """

    frames: Any
    done: int
    other_columns: Mapping[str, Any] = MappingProxyType({})


class Source(NamedTuple):
    """Frames of a file, the total amount of data if known, and the other columns.

    ``names`` lists all other columns. ``empty_columns`` has an empty column for each that is read.
    """

    parts: Generator[Part, None, None]
    total: int | None
    names: tuple[str, ...] = ()
    empty_columns: Mapping[str, Any] = MappingProxyType({})


def kept_columns(names: Iterable[str], stored: Stored, empty: Callable[[str], Any], file: str) -> dict[str, Any]:
    """Return an empty column for each of the other columns to keep."""
    columns: dict[str, Any] = {}
    for name in filter(stored.keeps, names):
        if name in columns:
            raise UsageError(f"{file} has two columns {short(name)}; rename one, or select the columns")
        columns[name] = empty(name)
    return columns


def column_of(names: list[str], wanted: str, file: str) -> str:
    """Return the name of the column with the frames: the requested one, the only one, or one with a default name."""
    if wanted:
        if names.count(wanted) == 1:
            return wanted
        problem = "several columns" if wanted in names else "no column"
        raise InputError(file, "", f"{problem} {short(wanted)}; the columns are {listed(names)}")
    place = named_place(names)
    if place is None:
        raise InputError(file, "", f"choose the column with the frames; the columns are {listed(names)}")
    return names[place]


def named_place(names: list[str]) -> int | None:
    """Return the index of the only column, or of the only one with a default name for the frames."""
    named = [place for place, name in enumerate(names) if len(names) == 1 or name.lower() in _NAMES]
    return named[0] if len(named) == 1 else None


def check_form(name: str, chosen_frames: Any, other_forms: Iterable[tuple[str, Any]], share: Share) -> None:
    """Check that no other form works much better if many frames are invalid in the chosen form.

    Args:
        name: Name of the file.
        chosen_frames: The first frames in the chosen form.
        other_forms: Command-line option of each other form, and the first frames in that form.
        share: Function that returns the fraction of valid frames.

    Raises:
        InputError: At least one frame in ten has an error, but in one of ``other_forms`` at most one in twenty would.
    """
    if not len(chosen_frames) or (valid := share(chosen_frames)) > 0.9:
        return
    for option, frames in other_forms:
        # One or two frames can be valid by chance.
        if len(frames) > 2 and (fitting := share(frames)) >= 0.95:
            problem = f"{1 - valid:.0%} of the first {len(chosen_frames)} frames have an error"
            raise InputError(name, "", f"{problem}; with {option}, {fitting:.0%} are valid")


def numbers(rows: Any, words: WordKind = "packed") -> Any:
    """Return rows of at most eight bytes as numbers."""
    length, order = WORDS[words]
    if length or rows.shape[1] == 8:
        kind = f"{order}u{length or 8}"
        return np.ascontiguousarray(rows).reshape(-1).view(kind).astype(np.uint64, copy=False)
    wide = np.zeros((len(rows), 8), np.uint8)
    wide[:, 8 - rows.shape[1] :] = rows
    return wide.reshape(-1).view(">u8").astype(np.uint64)


def of_floats(frames: Any, bits: int, done: int = 0) -> Any:
    """Return floating-point frames as integers, masked if they are NaN or out of range.

    ``done`` is the number of earlier rows, to number the row in an error.

    Raises:
        TypeError: A value is not an integer, or the type cannot represent every frame of that length.
    """
    if bits > np.finfo(frames.dtype).nmant + 1:
        raise TypeError(f"{frames.dtype} cannot represent every frame of {bits} bits: use integers or text")
    is_frame = (frames >= 0) & (frames < 2.0**63)
    whole = np.where(is_frame, frames, 0)
    fractional_rows = np.flatnonzero(whole != np.floor(whole))
    if len(fractional_rows):
        raise TypeError(
            f"the frame in row {done + fractional_rows[0] + 1} is not an integer: {whole[fractional_rows[0]]}"
        )
    return np.ma.masked_array(whole.astype(np.uint64), ~is_frame)


def short(text: str) -> str:
    """Return the text for a message, shortened if it is long."""
    return repr(text if len(text) <= 40 else f"{text[:40]}...")


def listed(names: list[str]) -> str:
    """Return at most eight of the names, for a message."""
    first_names = ", ".join(short(name) for name in names[:8])
    return f"{first_names} and {len(names) - 8} more" if len(names) > 8 else first_names
