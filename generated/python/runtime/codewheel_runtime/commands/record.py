# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Writes live readings to CSV, JSON lines or Parquet files, one row per reading."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from importlib import import_module
from pathlib import PurePath
from typing import Any, Final, Literal, NamedTuple, Protocol

from ..errors import UsageError
from ..files.targets import open_for_writing

RecordKind = Literal["csv", "jsonl", "parquet"]
#: Formats by name, for the option.
RECORD_KINDS: Final[tuple[RecordKind, ...]] = ("csv", "jsonl", "parquet")
_FORMAT_BY_SUFFIX: Final[dict[str, RecordKind]] = {
    ".jsonl": "jsonl",
    ".ndjson": "jsonl",
    ".parquet": "parquet",
    ".pq": "parquet",
}
#: Number of rows of a Parquet file that are written at a time.
_ROWS_AT_ONCE: Final = 4096


class RecordedReading(NamedTuple):
    """One reading of an encoder.

    Attributes:
        time: Time of the reading in seconds, since the first one was started.
        position: Position in counts. None if it is not usable, or if there was an error.
        verdict: Verdict of the frame. Empty after an error.
        reports: Names of the encoder's active reports, separated by spaces.
        error: Kind of the error, such as ``no reply``. Empty if there was none.
    """

    time: float
    position: int | None = None
    verdict: str = ""
    reports: str = ""
    error: str = ""


class Recorder(Protocol):
    """Open output to which readings are appended."""

    def write(self, reading: RecordedReading) -> None:
        """Append a reading."""
        ...

    def close(self) -> None:
        """Write the readings that have not been written yet."""
        ...


class _Csv:
    """CSV with a header. Each row is written immediately, so that another program can follow the file.

    Without a file, rows go to standard output. ``_opened_file`` is the text layer over a file, which the caller closes.
    """

    def __init__(self, file: Any) -> None:
        self._opened_file = io.TextIOWrapper(file, "utf-8", newline="") if file is not None else None
        self._output = self._opened_file or sys.stdout
        self._write_row: Callable[[Any], object] = csv.writer(self._output, lineterminator="\n").writerow
        self._write_row(RecordedReading._fields)

    def write(self, reading: RecordedReading) -> None:
        self._write_row(reading._replace(time=_round(reading.time)))
        self._output.flush()

    def close(self) -> None:
        self._output.flush()
        if self._opened_file is not None:
            self._opened_file.detach()


class _JsonLines:
    """One JSON object per line.

    Without a file, lines go to standard output. ``_opened_file`` is the text layer over a file, which the caller
    closes.
    """

    def __init__(self, file: Any) -> None:
        self._opened_file = io.TextIOWrapper(file, "utf-8", newline="") if file is not None else None
        self._output = self._opened_file or sys.stdout

    def write(self, reading: RecordedReading) -> None:
        self._output.write(json.dumps(reading._replace(time=_round(reading.time))._asdict()) + "\n")
        self._output.flush()

    def close(self) -> None:
        self._output.flush()
        if self._opened_file is not None:
            self._opened_file.detach()


class _Parquet:
    """Parquet file, written in groups of rows."""

    def __init__(self, file: Any) -> None:
        """Write the header of ``file``, whose columns are the fields of ``RecordedReading``."""
        self._pyarrow: Any = import_module("pyarrow")
        text_type = self._pyarrow.string()
        number_types = {"time": self._pyarrow.float64(), "position": self._pyarrow.int64()}
        self._schema = self._pyarrow.schema(
            [(name, number_types.get(name, text_type)) for name in RecordedReading._fields]
        )
        self._writer = import_module("pyarrow.parquet").ParquetWriter(file, self._schema)
        #: Rows that have not been written yet.
        self._pending_rows: list[dict[str, Any]] = []

    def write(self, reading: RecordedReading) -> None:
        self._pending_rows.append(reading._asdict())
        if len(self._pending_rows) == _ROWS_AT_ONCE:
            self._write_rows()

    def close(self) -> None:
        self._write_rows()
        self._writer.close()

    def _write_rows(self) -> None:
        self._writer.write_table(self._pyarrow.Table.from_pylist(self._pending_rows, self._schema))
        self._pending_rows.clear()


_RECORDERS: Final[dict[RecordKind, Callable[[Any], Recorder]]] = {
    "csv": _Csv,
    "jsonl": _JsonLines,
    "parquet": _Parquet,
}


def record_kind(target: str, kind: RecordKind | None) -> RecordKind:
    """Return the format to write: the requested format, or the format implied by the file name.

    Raises:
        UsageError: Parquet cannot be written to standard output.
    """
    chosen_kind = kind or _FORMAT_BY_SUFFIX.get(PurePath(target).suffix.lower(), "csv")
    if target == "-" and chosen_kind == "parquet":
        raise UsageError("Parquet cannot be written to standard output; give a file with -o")
    return chosen_kind


@contextmanager
def open_recorder(target: str, kind: RecordKind | None, force: bool) -> Generator[Recorder, None, None]:
    """Open a file of readings, or standard output for ``-``. After an error, no file remains.

    Raises:
        UsageError: The file exists, or the format does not fit.
        OSError: The file cannot be written.
    """
    chosen_kind = record_kind(target, kind)
    with open_for_writing(target, (), force) as file:
        recorder = _RECORDERS[chosen_kind](file)
        yield recorder
        recorder.close()


def _round(seconds: float) -> float:
    """Return a time rounded to microseconds."""
    return round(seconds, 6)
