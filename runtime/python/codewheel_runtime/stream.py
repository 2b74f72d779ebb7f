# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes files of frames in bounded memory, and partitions of data frames."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager, suppress
from enum import Enum
from importlib import import_module
from inspect import signature
from types import MappingProxyType
from typing import Any, Final, NamedTuple, TypeVar, cast, get_type_hints

from .arrow import of_arrow
from .bulk_decode import decode_many
from .encoder import Encoder
from .inputs import DigitKind, FileKind, InputError, Source, Stored, UsageError, WordKind, column_of
from .reports import Verdict
from .shape import Shape
from .sinks import SINKS, Plan, Sink, TargetKind, arrow_columns, pandas_columns, target_kind
from .sources import opened
from .table import ErrorKind, Table
from .text import Cells

np: Any = import_module("numpy")

__all__ = [
    "Files",
    "InputError",
    "Layout",
    "Summary",
    "UsageError",
    "layout_of",
    "layouts_of",
]

_Part = TypeVar("_Part")
_NO_ANSWERS: Final[Mapping[str, Enum | str]] = MappingProxyType({})


class Summary(NamedTuple):
    """Number of frames in a file, in total and by result.

    Attributes:
        frames: Number of frames.
        faults: Number of frames with each error.
        verdicts: Number of valid frames with each verdict. Empty if the frames have no verdict.
        lost: Number of cells in other columns that were left empty because they are not numbers, unlike earlier cells.
    """

    frames: int
    faults: Mapping[ErrorKind, int]
    verdicts: Mapping[Verdict, int]
    lost: int = 0

    @property
    def error_rate(self) -> float:
        """Fraction of the frames with an error, from 0 to 1."""
        return sum(self.faults.values()) / self.frames if self.frames else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return the counts as plain values for JSON."""
        faults = {kind.name.lower(): count for kind, count in self.faults.items()}
        verdicts = {kind.value: count for kind, count in self.verdicts.items()}
        return {"frames": self.frames, "faults": faults, "verdicts": verdicts, "lost_cells": self.lost}

    def __str__(self) -> str:
        valid = self.frames - sum(self.faults.values())
        verdicts = ", ".join(f"{count} {kind.value.replace('_', ' ')}" for kind, count in self.verdicts.items())
        parts = [counted(self.frames, "frame"), f"{valid} valid" + (f" ({verdicts})" if verdicts else "")]
        for kind, count in self.faults.items():
            parts.append(f"{count} with a {'CRC' if kind is ErrorKind.CRC else kind.name.lower()} error")
        if self.lost:
            parts.append(f"{counted(self.lost, 'cell')} of other columns left empty")
        return ", ".join(parts)


def counted(count: int, word: str) -> str:
    """Return a number followed by its noun."""
    return f"{count} {word}{'' if count == 1 else 's'}"


# Kinds of frames


class Layout(NamedTuple):
    """Kind of frame that an encoder sends or receives. ``answers`` are the questions that the manual leaves open."""

    name: str
    sender: str
    answers: Mapping[str, type[Enum]]
    make: Callable[..., Shape]

    def shape(self, encoder: Encoder, answers: Mapping[str, object]) -> Shape:
        """Return the shape of these frames for an encoder and the answers to its questions."""
        variant = {"variant": encoder} if "variant" in signature(self.make).parameters else {}
        return self.make(**variant, **answers)


def layouts_of(encoder: Encoder) -> tuple[Layout, ...]:
    """Return all kinds of frames of an encoder's interface. Those that it sends come first."""
    package, _, module = type(encoder).__module__.rpartition(".")
    frames: Mapping[tuple[str, str], Mapping[str, Callable[..., Shape]]]
    frames = import_module(f"{package}._shapes.{module}").FRAMES
    found: list[Layout] = []
    for (interface, sender), makers in sorted(frames.items(), key=lambda item: item[0][1]):
        for name, make in makers.items() if interface == encoder.interface.value else ():
            hints = get_type_hints(make)
            answers = {item: hints[item] for item in signature(make).parameters if issubclass(hints[item], Enum)}
            found.append(Layout(name, sender, answers, make))
    return tuple(found)


def layout_of(encoder: Encoder, name: str = "") -> Layout:
    """Return the kind of frame with this name, which is the name in the manual or the name of the class.

    Raises:
        UsageError: There is no such frame, or a name is needed to choose one.
    """
    found = layouts_of(encoder)
    if name:
        wanted = name.replace("_", "").lower()
        chosen = [item for item in found if item.name.replace("_", "") == wanted]
        wrong = f"{encoder.code} has no frame '{name[:40]}'"
    else:
        chosen = [item for item in found if item.sender == "encoder"]
        wrong = f"{encoder.code} sends several kinds of frames; choose a layout"
    if len(chosen) != 1:
        raise UsageError(f"{wrong}: {', '.join(item.name for item in found) or 'none is known'}")
    return chosen[0]


def shape_for(encoder: Encoder, layout: str, answers: Mapping[str, Any]) -> Shape:
    """Return the shape of frames. Raises UsageError if an answer is missing or not needed."""
    asked = layout_of(encoder, layout)
    for name in answers:
        if name not in asked.answers:
            needed = f"it accepts {', '.join(asked.answers)}" if asked.answers else "it needs no answers"
            raise UsageError(f"{asked.name} does not accept the answer '{name[:40]}': {needed}")
    given: dict[str, object] = {}
    for name, kind in asked.answers.items():
        answer = answers.get(name)
        found = [item for item in kind if answer in (item, item.name, item.name.lower())]
        if len(found) != 1:
            words = " or ".join(item.name.lower() for item in kind)
            raise UsageError(f"the manual leaves the {name} of {asked.name} open: choose {words}")
        given[name] = found[0]
    return asked.shape(encoder, given)


# Files and partitions


class Files(NamedTuple):
    """Functions that decode files and partitions. A label denotes an encoder of the package ``package``."""

    package: str

    def decode_file(
        self,
        encoder: Encoder | str,
        source: str | os.PathLike[str],
        target: str | os.PathLike[str],
        *,
        layout: str = "",
        to: TargetKind | None = None,
        kind: FileKind | None = None,
        words: WordKind = "packed",
        column: str = "",
        digits: DigitKind | None = None,
        cut: bool = False,
        si: bool = False,
        columns: Sequence[str] = (),
        limit: int | None = None,
        raw: bool = False,
        force: bool = False,
        answers: Mapping[str, Enum | str] = _NO_ANSWERS,
        progress: Callable[[int, int | None, int], None] | None = None,
    ) -> Summary:
        """Decode a file of frames into a file of columns, in bounded memory.

        Each frame becomes a row. The other columns of the file come first, unchanged. The position is empty if it is
        not usable, or if the frame has an error. The error is in ``fault``. A cell without a frame becomes a row with a
        length error. The target appears when it is complete. On error, no file is created and an existing file is left
        unchanged.

        Args:
            encoder: The encoder, or its label.
            source: The file to read, or ``-`` for standard input.
            target: The file to write, or ``-`` for CSV on standard output.
            layout: Kind of the frames, if the encoder sends several kinds.
            to: Format to write: ``parquet``, ``arrow`` or ``csv``. The default follows from the name of the file.
            kind: Format to read: ``binary``, ``csv`` or ``parquet``. The default follows from the name of the file.
            words: Form of a frame of bits in a binary file. ``packed`` uses as few bytes as possible, most significant
                first. ``little`` and ``big`` are little-endian and big-endian numbers of eight bytes, ``little32`` and
                ``big32`` of four bytes.
            column: Name of the column with the frames. For CSV, this may be its number, from 1.
            digits: Base of numbers in text that do not start with ``0x``: ``hex`` or ``decimal``.
            cut: Ignore an incomplete frame at the end.
            si: Also write the position and the speed in SI units. The source needs a column ``time`` in seconds.
            columns: Columns to write, both decoded columns and columns of the file. The default is all.
            limit: Maximum number of frames to decode.
            raw: Write the position of every frame, even if it is not usable.
            force: Replace an existing file.
            answers: Answers to the questions that the manual leaves open, by name.
            progress: Called from time to time with the amount read, the total if known, and the number of frames.

        Returns:
            Counts of frames, of each error and of each verdict.

        Raises:
            InputError: The source does not contain such frames. The message says where. This error is also raised if
                many of the first 1000 frames have an error but would be valid with other ``words`` or ``digits``. The
                message then suggests them.
            UsageError: The arguments are wrong or incompatible with each other.
            OSError: A file cannot be read or written.
        """
        encoder = self._encoder(encoder)
        shape = shape_for(encoder, layout, answers)
        to = to or target_kind(os.fspath(target))
        if os.fspath(target) == "-" and to != "csv":
            raise UsageError("only CSV can be written to standard output")
        empty = decode_many([], shape, encoder)
        derived = Derived("time", os.fspath(source)) if si else None
        fields = empty if derived is None else derived.check(empty.with_columns(time=np.zeros(0)))
        stored = Stored(kind, words, column, digits, cut, (*columns, "time") if si and columns else columns)

        def share(frames: Any) -> float:
            return float(decode_many(frames, shape, encoder).ok.mean())

        with (
            opened(os.fspath(source), stored, shape, share) as read,
            written(os.fspath(target), [source], force) as file,
        ):
            if derived is not None:
                if "time" not in read.kept:
                    raise UsageError(f"{os.fspath(source)} has no column 'time', which speeds in SI units need")
                _apart(read.kept, [name for name in fields.others if name != "time"], os.fspath(source))
            plan = plan_of(fields, read, columns, os.fspath(source), raw)
            with SINKS[to](file, plan) as sink:
                return decoded(read, shape, encoder, sink, limit, progress, derived)

    def decode_partition(
        self,
        part: _Part,
        encoder: Encoder | str,
        column: str = "",
        *,
        layout: str = "",
        digits: DigitKind | None = None,
        raw: bool = False,
        answers: Mapping[str, Enum | str] = _NO_ANSWERS,
    ) -> _Part:
        """Decode the frames of a table from Arrow, pandas, polars, DuckDB, or another library with Arrow's C stream.

        The fields, ``verdict`` and ``fault`` replace the column of frames. Other columns, all rows and the index of a
        DataFrame are unchanged. A position is null if the frame has an error or its position is not usable. A missing
        frame has a length error. The result depends only on the arguments, so engines can process partitions in any
        order and in other processes.

        Args:
            part: The partition.
            encoder: The encoder, or its label.
            column: Name of the column with the frames: integers, bytes or text. By default, the only column, or
                ``frame`` or ``word``.
            layout: Kind of the frames, if the encoder sends several kinds.
            digits: Base of numbers in text that do not start with ``0x``: ``hex`` or ``decimal``.
            raw: Keep the position of every frame, even if it is not usable.
            answers: Answers to the questions that the manual leaves open, by name.

        Returns:
            A partition of the same type: a ``pyarrow.Table`` or ``RecordBatch`` or a pandas DataFrame. For other
            types, a ``pyarrow.Table``, which they accept.

        Raises:
            InputError: The column does not contain such frames.
            TypeError: ``part`` is not a partition of a supported type.
            UsageError: The arguments are wrong or incompatible with each other.
        """
        encoder = self._encoder(encoder)
        shape = shape_for(encoder, layout, answers)
        kind = (type(part).__module__.partition(".")[0], type(part).__name__)
        if kind in (("pyarrow", "Table"), ("pyarrow", "RecordBatch")):
            return cast(_Part, _of_arrow(part, encoder, shape, column, digits, raw))
        if kind == ("pandas", "DataFrame"):
            return cast(_Part, _of_pandas(part, encoder, shape, column, digits, raw))
        if hasattr(part, "__arrow_c_stream__") or hasattr(part, "__arrow_c_array__"):
            found = import_module("pyarrow").table(part)
            return cast(_Part, _of_arrow(found, encoder, shape, column, digits, raw))
        raise TypeError(f"expected a table of Arrow, pandas, polars or DuckDB, got {type(part).__name__}")

    def _encoder(self, encoder: Encoder | str) -> Encoder:
        if isinstance(encoder, Encoder):
            return encoder
        found: Encoder = import_module(self.package).lookup(encoder)
        return found


def decoded(
    read: Source,
    shape: Shape,
    encoder: Encoder | None,
    sink: Sink,
    limit: int | None = None,
    progress: Callable[[int, int | None, int], None] | None = None,
    derived: Callable[[Table, Mapping[str, Any]], Table] | None = None,
) -> Summary:
    """Decode the frames of a source into a file, and return the counts. ``derived`` adds columns to each table."""
    counts = _Counts()
    for part in read.parts:
        rows = slice(None if limit is None else limit - counts.frames)
        table = decode_many(part.frames[rows], shape, encoder)
        counts.add(table)
        if len(table.fault):
            others = {name: column[rows] for name, column in part.others.items()}
            sink.write(table if derived is None else derived(table, others), others)
        if progress is not None:
            progress(part.done, read.total, counts.frames)
        if limit is not None and counts.frames >= limit:
            break
    return counts.summary(sink.lost)


class Derived:
    """Position and speed in SI units. The first speed in a table uses the last frame of the previous table."""

    def __init__(self, time: str, source: str) -> None:
        self._time, self._source = time, source
        self._last: tuple[int, float] | None = None

    def check(self, empty: Table) -> Table:
        """Return the columns of a table without frames. Raises UsageError if there are no SI units."""
        if self._time != "time":
            raise UsageError("speeds need the sample rate: give it with --rate")
        try:
            return empty.in_si()
        except (AttributeError, ValueError) as error:
            raise UsageError(f"no SI units: {error}") from None

    def __call__(self, table: Table, others: Mapping[str, Any]) -> Table:
        times = seconds_of(others[self._time], self._source)
        made = table.with_columns(**{self._time: times}).in_si(self._last)
        good = np.flatnonzero(table.usable)
        if len(good):
            previous = None if self._last is None else self._last[0]
            self._last = (int(table.unwrapped(previous)[-1]), float(times[good[-1]]))
        return made


def seconds_of(cells: Any, source: str) -> Any:
    """Return the cells of a column of times as an array of seconds. An empty cell becomes NaN."""
    if hasattr(cells, "dtype"):
        return cells
    cells = cells.to_pylist() if hasattr(cells, "to_pylist") else cells
    try:
        return np.array([np.nan if cell in (None, "") else float(cell) for cell in cells], np.float64)
    except (TypeError, ValueError):
        raise InputError(source, "column 'time'", "expected numbers in seconds") from None


class _Counts:
    """Running counts of frames."""

    def __init__(self) -> None:
        self.frames = 0
        self._faults: dict[ErrorKind, int] = {}
        self._verdicts: dict[int, int] = {}

    def add(self, table: Table) -> None:
        """Count the frames of a table."""
        self.frames += len(table.fault)
        for kind, count in table.faults().items():
            if kind:
                self._faults[kind] = self._faults.get(kind, 0) + count
        worth = table.get("verdict")
        if worth is not None:
            sound = worth[table.ok]
            for place in range(len(Verdict)):
                self._verdicts[place] = self._verdicts.get(place, 0) + int((sound == place).sum())

    def summary(self, lost: int) -> Summary:
        """Return the counts. ``lost`` is the number of cells that were left empty."""
        order = [*Verdict]
        verdicts = {order[place]: count for place, count in self._verdicts.items() if count}
        return Summary(self.frames, dict(sorted(self._faults.items())), verdicts, lost)


def plan_of(empty: Table, read: Source, columns: Sequence[str], source: str, raw: bool) -> Plan:
    """Return the columns to write: the requested ones, or the other columns of the file and all fields."""
    wrong = [name for name in columns if name not in [*read.names, *empty]]
    if wrong:
        there = ", ".join([*read.names, *empty])
        raise UsageError(f"no column '{wrong[0][:40]}'; the columns are {there}")
    _apart(read.kept, [name for name in empty if name not in empty.others], source)
    return Plan(tuple(dict.fromkeys(columns or (*read.kept, *empty))), read.kept, empty, raw)


@contextmanager
def written(target: str, sources: Iterable[str | os.PathLike[str]], force: bool) -> Generator[Any, None, None]:
    """Open a temporary file. It is renamed to ``target`` when complete, and removed after an error."""
    if target == "-":
        yield None
        return
    place = os.path.realpath(target)
    if os.path.lexists(place):
        if not os.path.isfile(place):
            raise UsageError(f"{target} is not a regular file, so it cannot be replaced")
        if any(os.fspath(source) != "-" and os.path.samefile(place, source) for source in sources):
            raise UsageError(f"{target} is also the source; write to another file")
        if not force:
            raise UsageError(f"{target} already exists; use force to replace it")
    folder, name = os.path.split(place)
    neighbour = os.path.join(folder, f".{name[:100]}.{os.getpid()}.part")
    file = open(neighbour, "xb")  # noqa: SIM115 (closed below)
    try:
        with file:
            yield file
        os.replace(neighbour, place)
    except BaseException:
        # Writing the rest of the buffer may fail on a full disk.
        with suppress(OSError):
            file.close()
        os.unlink(neighbour)
        raise


def _of_arrow(part: Any, encoder: Encoder, shape: Shape, column: str, digits: DigitKind | None, raw: bool) -> Any:
    names = list(part.schema.names)
    column = column_of(names, column, "the partition")
    try:
        table = decode_many(of_arrow(part.column(names.index(column)), shape, digits), shape, encoder)
    except (TypeError, ValueError) as error:
        raise InputError("the partition", f"column {column!r}", str(error)) from None
    made = arrow_columns(table, table, raw)
    kept = {name: part.column(place) for place, name in enumerate(names) if name != column}
    _apart(kept, made, "the partition")
    found = {**kept, **made}
    return part.__class__.from_arrays([*found.values()], names=[*found])


def _of_pandas(part: Any, encoder: Encoder, shape: Shape, column: str, digits: DigitKind | None, raw: bool) -> Any:
    names = list(map(str, part.columns))
    column = column_of(names, column, "the partition")
    try:
        table = decode_many(_of_series(part.iloc[:, names.index(column)], shape, digits), shape, encoder)
    except (TypeError, ValueError) as error:
        raise InputError("the partition", f"column {column!r}", str(error)) from None
    made = pandas_columns(table, table, raw)
    kept = part.drop(columns=[part.columns[names.index(column)]])
    _apart(list(map(str, kept.columns)), made, "the partition")
    return kept.assign(**made)


def _of_series(series: Any, shape: Shape, digits: DigitKind | None) -> Any:
    """Convert a pandas column to the form that ``decode_many`` expects. Missing items are None or NaN."""
    frames: Any = series.to_numpy()
    if frames.dtype.kind in "ui" or (frames.dtype.kind == "f" and not shape.length):
        return frames
    cells = Cells(shape, digits)
    missing = series.isna().tolist()
    found = [
        None if is_missing else _item(item, shape, cells, row)
        for row, (item, is_missing) in enumerate(zip(frames.tolist(), missing, strict=False))
    ]
    if cells.are_others:
        raise ValueError(f"row {cells.place + 1}: {cells.said}")
    return found


def _item(item: object, shape: Shape, cells: Cells, row: int) -> Any:
    """Return a frame from a column of objects."""
    if isinstance(item, str):
        return cells.read(item, row)
    if isinstance(item, (bytes, bytearray, memoryview)):
        data = bytes(cast(bytes, item))
        return data if shape.length else int.from_bytes(data, "big")
    if isinstance(item, int) and not shape.length:
        return item
    raise TypeError(f"{str(item)[:40]!r} is not a frame of this encoder")


def _apart(kept: Iterable[str], made: Iterable[str], source: str) -> None:
    """Raise UsageError if another column has the same name as a decoded one."""
    both = sorted({*kept} & {*made})
    if both:
        raise UsageError(
            f"{source} already has a column '{both[0]}', which the decoded frames also have: "
            "rename it, or select other columns"
        )
