# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes files of frames in bounded memory, and partitions of data frames."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final, NamedTuple, TypeVar, cast

from ..bulk.decode import decode_many
from ..bulk.shape import FrameLayout
from ..bulk.table import FrameSource, Table
from ..bulk.words import DigitKind, WordKind
from ..codec import whole_number
from ..encoder import Encoder
from ..errors import ErrorKind, InputError, UsageError
from ..packages import load
from ..reports import Verdict
from .inputs import FileKind, Source, StorageFormat, read_seconds
from .layouts import FrameKind, find_frame_layout
from .partitions import PartitionDecoder, check_distinct_names
from .sinks import SINKS, Plan, Sink, TargetKind, find_target_kind
from .sources import open_source
from .targets import open_for_writing

np: Any = load("numpy")

__all__ = [
    "Files",
    "FrameKind",
    "InputError",
    "Summary",
    "UsageError",
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
        """Return the counts as plain values for JSON.

        Example: ``{"frames": 9, "faults": {"crc": 1}, "verdicts": {"usable": 8}, "lost_cells": 0}``.
        """
        faults = {kind.name.lower(): count for kind, count in self.faults.items()}
        verdicts = {kind.value: count for kind, count in self.verdicts.items()}
        return {"frames": self.frames, "faults": faults, "verdicts": verdicts, "lost_cells": self.lost}

    def __str__(self) -> str:
        valid_count = self.frames - sum(self.faults.values())
        verdicts = ", ".join(f"{count} {kind.value.replace('_', ' ')}" for kind, count in self.verdicts.items())
        valid_text = f"{valid_count} valid ({verdicts})" if verdicts else f"{valid_count} valid"
        phrases = [count_units(self.frames, "frame"), valid_text]
        for kind, count in self.faults.items():
            kind_name = "CRC" if kind is ErrorKind.CRC else kind.name.lower()
            phrases.append(f"{count} with a {kind_name} error")
        if self.lost:
            phrases.append(f"{count_units(self.lost, 'cell')} of other columns left empty")
        return ", ".join(phrases)


def count_units(count: int, word: str) -> str:
    """Return a number followed by its noun, such as ``1 frame`` or ``2 frames``."""
    return f"{count} {word}{'' if count == 1 else 's'}"


# Files and partitions


class Files(NamedTuple):
    """Functions that decode files and partitions. Labels are looked up in the package ``package``."""

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

        Each frame becomes a row, after the other columns of the file. A column of CSV becomes numbers in Parquet and
        Arrow if its first cells are numbers. Later cells that are not numbers are left empty, and counted as ``lost``.
        The position is empty if it is not usable. ``fault`` contains the error of a frame. A cell without a frame has a
        length error. The target file appears only when it is complete.

        Args:
            encoder: The encoder, or its label.
            source: The file to read, or ``-`` for standard input.
            target: The file to write, or ``-`` for CSV on standard output.
            layout: Kind of the frames, if the encoder sends several kinds.
            to: Format to write: ``parquet``, ``arrow`` or ``csv``. The default follows from the name of the file.
            kind: Format to read: ``binary``, ``csv`` or ``parquet``. The default follows from the name of the file.
            words: Form of a frame of bits in a binary file: ``packed`` (as few bytes as possible, most significant
                first), ``little`` and ``big`` (numbers of eight bytes), ``little32`` and ``big32`` (of four bytes).
            column: Name of the column with the frames. For CSV, this may be its number, from 1.
            digits: Base of numbers in text that do not start with ``0x``: ``hex`` or ``decimal``.
            cut: Ignore an incomplete frame at the end.
            si: Also write the position and the speed in SI units. The source needs a column ``time`` in seconds.
            columns: Decoded columns and columns of the file to write. The default is all.
            limit: Maximum number of frames to decode.
            raw: Write the position of every frame, even if it is not usable.
            force: Replace an existing file.
            answers: Answers to the questions that the manual leaves open, by name.
            progress: Called from time to time with the amount read, the total if known, and the number of frames.

        Returns:
            Counts of frames, of each error and of each verdict.

        Raises:
            InputError: The source does not contain such frames, or many of the first 1000 frames would only be valid
                with other ``words`` or ``digits``.
            UsageError: The arguments are wrong or incompatible with each other.
            OSError: A file cannot be read or written.
        """
        encoder = self._find_encoder(encoder)
        frame_layout = find_frame_layout(encoder, layout, answers)
        output = Output(os.fspath(target), find_target_format(target, to), columns, raw, force, si)
        # Speeds need the times, even if the column is not written.
        wanted = (*columns, "time") if si and columns else columns
        storage = StorageFormat(kind, words, column, digits, cut, wanted)
        return _decode_file(encoder, frame_layout, os.fspath(source), storage, output, limit, progress)

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
            A partition of the same type: a ``pyarrow.Table`` or ``RecordBatch`` or a pandas DataFrame. Other
            types get a ``pyarrow.Table``, which they accept.

        Raises:
            InputError: The column does not contain such frames.
            TypeError: ``part`` is not a partition of a supported type.
            UsageError: The arguments are wrong or incompatible with each other.
        """
        encoder = self._find_encoder(encoder)
        decoder = PartitionDecoder(encoder, find_frame_layout(encoder, layout, answers), column, digits, raw)
        return cast(_Part, decoder.decode(part))

    def _find_encoder(self, encoder: Encoder | str) -> Encoder:
        """Return the encoder for a label. An encoder is returned unchanged."""
        if isinstance(encoder, Encoder):
            return encoder
        found_encoder: Encoder = import_module(self.package).lookup(encoder)
        return found_encoder


class Output(NamedTuple):
    """Output file.

    Attributes:
        target: Name of the file, or ``-`` for standard output.
        kind: Format of the file.
        columns: Columns to write. Empty for all.
        raw: True to write positions that are not usable.
        force: True to replace an existing file.
        si: True to write the position and the speed in SI units, too.
    """

    target: str
    kind: TargetKind
    columns: Sequence[str]
    raw: bool
    force: bool
    si: bool


def find_target_format(target: str | os.PathLike[str], to: TargetKind | None) -> TargetKind:
    """Return the format to write: the requested format, or the format implied by the file name.

    A target ``-`` means standard output.

    Raises:
        UsageError: A format other than CSV is requested for standard output.
    """
    kind = to or find_target_kind(os.fspath(target))
    if os.fspath(target) == "-" and kind != "csv":
        raise UsageError("only CSV can be written to standard output")
    return kind


def _decode_file(
    encoder: Encoder,
    frame_layout: FrameLayout,
    source: str,
    storage: StorageFormat,
    output: Output,
    limit: int | None,
    progress: Callable[[int, int | None, int], None] | None,
) -> Summary:
    """Decode a file into a file of columns, part by part, and return the counts.

    ``limit`` is the maximum number of frames. ``progress`` is called from time to time with the amount read, the total
    if known, and the number of frames.

    Raises:
        UsageError: Speeds are requested, but the source has no column ``time``. Or an argument does not fit the source
            or the target.
        InputError: The source does not contain such frames.
    """
    # A table without frames shows which columns the result has.
    empty_result = decode_many([], frame_layout, encoder)
    speed_columns = SpeedColumns("time", source) if output.si else None
    if speed_columns is not None:
        empty_result = speed_columns.extend_empty(empty_result.with_columns(time=np.zeros(0)))

    def find_valid_fraction(frames: Any) -> float:
        """Return the fraction of valid frames."""
        return float(decode_many(frames, frame_layout, encoder).ok.mean())

    with (
        open_source(source, storage, frame_layout, find_valid_fraction) as frame_source,
        open_for_writing(output.target, [source], output.force) as file,
    ):
        if speed_columns is not None:
            _check_columns_for_speeds(frame_source, empty_result, source)
        plan = make_plan(empty_result, frame_source, output.columns, source, output.raw)
        with SINKS[output.kind](file, plan) as sink:
            return decode_parts(frame_source, frame_layout, encoder, sink, limit, progress, speed_columns)


def _check_columns_for_speeds(frame_source: Source, empty_result: Table, source: str) -> None:
    """Raise UsageError unless the source has a column ``time``, and none of the columns that are added for speeds.

    ``empty_result`` is a table with the added columns. ``source`` is the name of the source.
    """
    if "time" not in frame_source.empty_columns:
        raise UsageError(f"{source} has no column 'time', which speeds in SI units need")
    added_names = [name for name in empty_result.others if name != "time"]
    check_distinct_names(frame_source.empty_columns, added_names, source)


def decode_parts(
    frame_source: Source,
    frame_layout: FrameLayout,
    encoder: FrameSource | None,
    sink: Sink,
    limit: int | None = None,
    progress: Callable[[int, int | None, int], None] | None = None,
    add_columns: Callable[[Table, Mapping[str, Any]], Table] | None = None,
) -> Summary:
    """Decode the frames of a source into a file, ``sink``, and return the counts.

    Args:
        limit: Maximum number of frames to decode.
        progress: Called after each part with the amount read, the total if known, and the number of frames.
        add_columns: Function that adds columns to a table. It also receives the other columns of the same rows.

    Raises:
        UsageError: ``limit`` is negative.
        InputError: A part of the source cannot be read.
    """
    if limit is not None and whole_number("limit", limit) < 0:
        raise UsageError(f"limit must be at least 0, got {limit}")
    counts = _Counts()
    for part in frame_source.batches:
        # The first rows up to the limit. A slice up to None takes all rows.
        rows_left = None if limit is None else limit - counts.frames
        rows = slice(rows_left)
        table = decode_many(part.frames[rows], frame_layout, encoder)
        counts.add(table)
        if len(table.fault):
            other_columns = {name: column[rows] for name, column in part.other_columns.items()}
            extended_table = table if add_columns is None else add_columns(table, other_columns)
            sink.write(extended_table, other_columns)
        if progress is not None:
            progress(part.amount_read, frame_source.total_amount, counts.frames)
        if limit is not None and counts.frames >= limit:
            break
    return counts.summary(sink.lost_cell_count)


class SpeedColumns:
    """Function that adds the position and the speed in SI units to each table of a file.

    ``_time_column`` is the name of the column of times. ``_last`` holds the unwrapped position and the time of the
    last usable frame so far, or None before the first. The first speed in the next table is computed from it.
    """

    def __init__(self, time_column: str, source: str) -> None:
        self._time_column = time_column
        self._source = source
        self._last: tuple[int, float] | None = None

    def extend_empty(self, empty: Table) -> Table:
        """Return a table without frames that has the added columns.

        Raises:
            UsageError: The times are not in seconds, or the encoder has no SI units.
        """
        # Without a sample rate, a capture has a column of sample numbers instead of ``time``.
        if self._time_column != "time":
            raise UsageError("speeds need the sample rate: give it with --rate")
        try:
            return empty.in_si()
        except (AttributeError, ValueError) as error:
            raise UsageError(f"no SI units: {error}") from None

    def __call__(self, table: Table, other_columns: Mapping[str, Any]) -> Table:
        """Return a table with the times and the added columns, and remember its last usable frame."""
        times = read_seconds(other_columns[self._time_column], self._source)
        extended = table.with_columns(**{self._time_column: times}).in_si(self._last)
        usable_rows = np.flatnonzero(table.usable)
        if len(usable_rows):
            # Unwrapping continues from the last position of the previous table.
            previous_position = None if self._last is None else self._last[0]
            # Later frames without a usable position get the same count.
            last_position = int(table.unwrapped(previous_position)[-1])
            last_usable_row = usable_rows[-1]
            self._last = (last_position, float(times[last_usable_row]))
        return extended


class _Counts:
    """Running counts of frames, of frames with each error, and of valid frames with each verdict.

    ``_verdicts`` has the counts by the index of the verdict in ``Verdict``.
    """

    def __init__(self) -> None:
        self.frames = 0
        self._faults: dict[ErrorKind, int] = {}
        self._verdicts: dict[int, int] = {}

    def add(self, table: Table) -> None:
        """Count the frames of a table."""
        self.frames += len(table.fault)
        for kind, count in table.faults().items():
            # The kind of valid frames is 0.
            if kind:
                self._faults[kind] = self._faults.get(kind, 0) + count
        if "verdict" in table:
            verdicts_of_valid_frames = table.verdict[table.ok]
            for index in range(len(Verdict)):
                count = int((verdicts_of_valid_frames == index).sum())
                self._verdicts[index] = self._verdicts.get(index, 0) + count

    def summary(self, lost_cells: int) -> Summary:
        """Return the counts, without verdicts that do not occur.

        ``lost_cells`` is the number of cells that were left empty.
        """
        all_verdicts = [*Verdict]
        verdicts = {all_verdicts[index]: count for index, count in self._verdicts.items() if count}
        faults = dict(sorted(self._faults.items()))
        return Summary(frames=self.frames, faults=faults, verdicts=verdicts, lost=lost_cells)


def make_plan(empty_result: Table, frame_source: Source, columns: Sequence[str], source: str, raw: bool) -> Plan:
    """Return the columns to write: the requested ones, or the other columns of the file and all fields.

    ``empty_result`` is a table that shows the fields but contains no frames. ``frame_source`` is the source, ``source``
    its name for errors, and ``columns`` are the requested columns, or none. With ``raw``, positions that are not usable
    are also written.

    Raises:
        UsageError: A requested column does not exist, or a column of the file has the name of a field.
    """
    existing_names = [*frame_source.other_names, *empty_result.names]
    unknown_names = [name for name in columns if name not in existing_names]
    if unknown_names:
        raise UsageError(f"no column '{unknown_names[0][:40]}'; the columns are {', '.join(existing_names)}")
    field_names = [name for name in empty_result.names if name not in empty_result.others]
    check_distinct_names(frame_source.empty_columns, field_names, source)
    written_names = columns or (*frame_source.empty_columns, *empty_result.names)
    # Each name is written once, in the order of its first occurrence.
    names = tuple(dict.fromkeys(written_names))
    return Plan(names=names, source_columns=frame_source.empty_columns, empty_table=empty_result, raw=raw)
