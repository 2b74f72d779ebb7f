# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Columns of many decoded frames, and their conversion to other formats."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final, cast, overload

from ..codec import PositionRange, whole_number
from ..errors import ErrorKind
from ..facts import Scale
from ..packages import load
from ..reports import Movement, Verdict
from .conversion import (
    Columns,
    arrow_columns,
    check_new_columns,
    convert_to_quantities,
    make_unknown_column_message,
    pandas_columns,
    read_cells,
)
from .motion import compute_speeds, find_motion, list_times, unwrap_positions
from .shape import ReportCause, find_active
from .table_base import ColumnName, FrameSequence, FrameSource, PositionUnit, TableOf
from .units import POSITION_UNITS, AngleUnit, LengthUnit, SpeedUnit, Unit, find_unit_size

__all__ = ["AngleUnit", "FrameSource", "LengthUnit", "SpeedUnit", "Table", "Unit"]

#: Number of rows that are converted to Python objects at a time.
_ROWS_AT_ONCE: Final = 1 << 14
#: No other columns.
_NO_COLUMNS: Final[Mapping[str, Any]] = MappingProxyType({})


class Table(TableOf[ColumnName, PositionUnit], FrameSequence):
    """Columns of many frames: a NumPy array for each field, and ``fault`` with the error of each frame.

    The arrays hold the raw bits of every frame, including invalid ones. Use ``usable_position`` for positions: it is
    masked if there is none. ``to_arrow`` and ``to_pandas`` return null for frames without a usable position.

    Frames with a verdict also have a column ``verdict``: the index of the verdict in ``Verdict``. It is 0 if the
    position is not usable or the frame has an error.

    A number with a scale also has a column of its quantity, such as ``temperature (°C)``, with a
    :class:`decimal.Decimal` for each frame.

    A table can also contain other columns, such as ``time``.

    A table is a sequence of frames: ``len(table)`` is their number, ``table[10:20]`` a table of ten frames, and
    ``table[7]`` a dictionary with the values of one frame. Iteration yields such a dictionary for each frame.
    ``table["singleturn"]`` is a column, and ``columns`` contains all of them. ``table[7] in table`` looks for a frame
    with the same values, and ``"singleturn" in table`` for a column.
    """

    def __init__(
        self,
        encoder: FrameSource | None,
        columns: dict[str, Any],
        fault: Any,
        verdict: Any,
        position: str,
        parts: Mapping[str, tuple[str, int, int]],
        report_causes: tuple[ReportCause, ...] = (),
        position_columns: frozenset[str] = frozenset(),
        scales: Mapping[str, tuple[str, Scale]] = _NO_COLUMNS,
        other_columns: Mapping[str, Any] = _NO_COLUMNS,
        frame: str = "",
    ) -> None:
        # _parts: for each column that is a part of a joined number, this number, the lowest bit in it, and the width.
        # _scales: for each column of quantities, the column of its numbers, and their scale.
        # _position_columns: names of the position and its parts, which are hidden where the position is not usable.
        # Copies as dictionaries, so that a table can be pickled.
        self._others = dict(other_columns)
        self._scales = dict(scales)
        self.encoder = encoder
        self._position_columns = position_columns
        self._report_causes = report_causes
        self._columns = columns
        self._frame = frame
        self._fault = fault
        self._verdict = verdict
        self._position = position
        self._parts = parts
        verdict_names = ["verdict"] if verdict is not None else []
        self._names = [*other_columns, *parts, *columns, *scales, *verdict_names, "fault"]

    @property
    def fault(self) -> Any:
        """Error of each frame, as the number of a :class:`ErrorKind`. Valid frames have 0."""
        return self._fault

    @property
    def ok(self) -> Any:
        """True for each valid frame."""
        return self._fault == 0

    @property
    def position(self) -> Any:
        """Raw position of each frame in counts, including invalid frames.

        Prefer ``usable_position``, which masks these.

        Raises:
            AttributeError: The frames have no position.
        """
        if not self._position:
            raise AttributeError("these frames have no position")
        return self._find_column(self._position)

    @property
    def usable_position(self) -> Any:
        """Position of each frame in counts, masked if the frame has an error or its position is not usable.

        Raises:
            AttributeError: The frames have no position.
        """
        np: Any = load("numpy")
        return np.ma.masked_array(self.position, ~self.usable)

    @property
    def verdict(self) -> Any:
        """Verdict on the position of each frame, as an index in ``Verdict``.

        Raises:
            AttributeError: The frames have no verdict.
        """
        if self._verdict is None:
            raise AttributeError("these frames have no verdict")
        return self._verdict

    @property
    def usable(self) -> Any:
        """True for each valid frame whose verdict is not ``NOT_USABLE``. Without verdicts, for each valid frame.

        This includes positions with a warning, and positions with the verdict ``UNKNOWN``.
        """
        if self._verdict is None:
            return self.ok
        not_usable = [*Verdict].index(Verdict.NOT_USABLE)
        return (self._verdict != not_usable) & self.ok

    @property
    def reports(self) -> dict[str, Any]:
        """Arrays by report name. Each is True for the valid frames with that report."""
        reports: dict[str, Any] = {}
        for cause in self._report_causes:
            reports[cause.report] = find_active(self, cause) & self.ok
        return reports

    @property
    def others(self) -> Mapping[str, Any]:
        """Columns that were not decoded from frames, by name."""
        return self._others

    @property
    def count(self) -> int:
        """Number of frames, like ``len(table)``."""
        return len(self._fault)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in order."""
        return tuple(dict.fromkeys(self._names))

    @property
    def columns(self) -> dict[str, Any]:
        """Columns by name, as ``table[name]`` returns them. ``fault`` and ``verdict`` are numbers."""
        return {name: self._find_column(name) for name in self.names}

    def with_columns(self, **columns: Any) -> Table:
        """Return a table with additional columns in front.

        Args:
            columns: Columns by name, each with a value for every frame. ``time`` is in seconds.

        Returns:
            The table.

        Raises:
            TypeError: A column is a single value.
            ValueError: A column has a different length, or the same name as a decoded column.
        """
        decoded_names = {*self._names} - {*self._others}
        check_new_columns(columns, decoded_names, self.count)
        return self._replace_columns(self._columns, self._fault, self._verdict, {**self._others, **columns})

    def _replace_columns(
        self, columns: dict[str, Any], fault: Any, verdict: Any, other_columns: Mapping[str, Any]
    ) -> Table:
        """Return a copy of the table with other columns, errors, verdicts and possibly other rows."""
        return Table(
            encoder=self.encoder,
            columns=columns,
            fault=fault,
            verdict=verdict,
            position=self._position,
            parts=self._parts,
            report_causes=self._report_causes,
            position_columns=self._position_columns,
            scales=self._scales,
            other_columns=other_columns,
            frame=self._frame,
        )

    @overload
    def __getitem__(self, name: ColumnName) -> Any: ...

    @overload
    def __getitem__(self, name: int) -> dict[str, Any]: ...

    @overload
    def __getitem__(self, name: slice) -> Table[ColumnName, PositionUnit]: ...

    def __getitem__(self, name: Any) -> Any:
        """Return a column by its name, a frame by its index, or a table of several frames by a slice.

        Raises KeyError for an unknown name, IndexError for an unknown index, and TypeError for other keys.
        """
        if isinstance(name, slice):
            verdict = None if self._verdict is None else self._verdict[name]
            columns = {column_name: column[name] for column_name, column in self._columns.items()}
            other_columns = {column_name: column[name] for column_name, column in self._others.items()}
            return self._replace_columns(columns, self._fault[name], verdict, other_columns)
        if isinstance(name, str):
            return self._find_column(name)
        index = whole_number("the row", name)
        if not -self.count <= index < self.count:
            raise IndexError(f"no row {index}; the table has {self.count}")
        # Negative numbers count from the end.
        row = range(self.count)[index]
        return next(self[row : row + 1].rows())

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield the values of each frame by the names of the columns.

        ``fault`` is an :class:`ErrorKind` and ``verdict`` a :class:`Verdict`. A position that is not usable is None.
        """
        # Cells as objects take much memory, so only some rows are converted at once.
        for start in range(0, self.count, _ROWS_AT_ONCE):
            rows = slice(start, start + _ROWS_AT_ONCE)
            columns = [read_cells(self._as_columns(), name, rows) for name in self.names]
            for row in zip(*columns, strict=True):
                yield dict(zip(self.names, row, strict=True))

    def _find_column(self, name: str) -> Any:
        """Return a column by its name. Raises KeyError if there is no such column.

        A quantity, such as a temperature in °C, and a part of a joined number are computed on first use and then kept.
        """
        if name in self._others:
            return self._others[name]
        if name == "fault":
            return self._fault
        if name == "verdict" and self._verdict is not None:
            return self._verdict
        if name in self._scales and name not in self._columns:
            number_name, scale = self._scales[name]
            self._columns[name] = convert_to_quantities(self._find_column(number_name), scale)
        if name in self._parts and name not in self._columns:
            joined_name, lowest_bit, width = self._parts[name]
            self._columns[name] = (self._columns[joined_name] >> lowest_bit) & ((1 << width) - 1)
        if name not in self._columns:
            raise KeyError(make_unknown_column_message(name, self.names))
        return self._columns[name]

    def scale(self, name: str) -> Scale | None:
        """Return the scale of a column of quantities, or None for other columns."""
        return self._scales[name][1] if name in self._scales else None

    def __reversed__(self) -> Iterator[dict[str, Any]]:
        return self[::-1].rows()

    def __len__(self) -> int:
        return self.count

    def __repr__(self) -> str:
        error_count = int((self._fault != 0).sum())
        encoder_text = f" of {self.encoder.code}" if self.encoder is not None else ""
        return f"<{len(self._fault)} frames{encoder_text}, {error_count} with an error: {', '.join(self.names)}>"

    def faults(self) -> dict[ErrorKind, int]:
        """Return the number of valid frames and the number of frames with each error, omitting zeros."""
        counts = {kind: int((self._fault == kind).sum()) for kind in ErrorKind}
        return {kind: count for kind, count in counts.items() if count}

    def unwrapped(self, previous: int | None = None) -> Any:
        """Return the position of each frame as a count that continues when the position wraps around.

        The count of the first usable position is this position, or the one nearest to ``previous``. A later frame
        without a usable position has the count of the preceding frame. An earlier frame has ``previous``, or the
        first count. If no position is usable, all counts are ``previous`` or 0. If the position wraps, the encoder must
        move by less than half of the modulus between two usable frames.

        Args:
            previous: Last count of the preceding frames, to continue from.

        Returns:
            An array of counts.

        Raises:
            AttributeError: The frames have no position, or belong to no encoder.
            RangeError: A position is above the highest or below the lowest that this encoder sends.
            ValueError: The manual does not say where the position of this encoder wraps around.
        """
        encoder: Any = self.encoder
        position_range: PositionRange = encoder._range_in(self._frame)
        return unwrap_positions(self.position, self.usable, position_range, previous)

    def in_units(self, unit: PositionUnit, counts: Any = None) -> Any:
        """Convert counts to a unit.

        Args:
            unit: The unit. Degrees and radians are within one revolution.
            counts: An array of counts, by default the position of each frame.

        Returns:
            An array of values. Without ``counts``, it is NaN if the position is not usable.

        Raises:
            AttributeError: The frames have no position.
            ValueError: The encoder does not measure in this unit, or the manual does not give the size of a count.
        """
        positions = self.position if counts is None else counts
        # The size of one count. For angles, the denominator is the number of counts per turn.
        numerator, denominator = find_unit_size(self.encoder, unit)
        if unit in ("degrees", "radians"):
            positions = positions % denominator
        values = positions * numerator / denominator
        np: Any = load("numpy")
        return np.where(self.usable, values, np.nan) if counts is None else values

    def velocity(self, seconds: Any = None, unit: SpeedUnit = "counts") -> Any:
        """Return the speed of the encoder, measured from the previous usable position.

        Args:
            seconds: Time between two frames, or an array with the time of each frame. The default is the column
                ``time``.
            unit: Unit of length or angle per second, or ``rpm`` for revolutions per minute.

        Returns:
            An array of speeds. It is NaN for frames without a usable position, for the first usable frame, and for a
            time that is not later than that of the previous usable frame.

        Raises:
            AttributeError: The frames have no position.
            RangeError: A position is above the highest or below the lowest that this encoder sends.
            ValueError: The encoder does not measure in this unit, or the manual does not give the size of a count or
                the wrap-around point.
            ValueError: ``seconds`` is a single time that is 0, negative or infinite, or does not have one number
                per frame. Or there is no column ``time``.
        """
        return self._compute_speed(seconds, unit, None)

    def _compute_speed(self, seconds: Any, unit: SpeedUnit, previous: tuple[int, float] | None) -> Any:
        """Return the speed in each row, measured from the previous usable position. It is NaN where there is none.

        ``seconds`` is the time between two frames, an array of times, or None for the column ``time``. ``previous`` is
        the unwrapped position and the time of the last usable frame before the table, or None.
        """
        if seconds is None:
            if "time" not in self._others:
                raise ValueError("the table has no column 'time'; pass the time between two frames in seconds")
            seconds = self._others["time"]
        times = list_times(seconds, self.count)
        if unit not in (*POSITION_UNITS, "rpm"):
            raise ValueError(f"'{unit[:40]}' is not a unit of speeds: use {', '.join((*POSITION_UNITS, 'rpm'))}")
        previous_count = None if previous is None else previous[0]
        motion = find_motion(self.unwrapped(previous_count), times, self.usable, previous)
        return compute_speeds(motion, unit, self.encoder, self.count)

    def in_si(self, previous: tuple[int, float] | None = None) -> Table:
        """Return a table that also contains the position and the speed in SI units.

        The columns are ``radians`` and ``radians_per_second``, or ``metres`` and ``metres_per_second``. They are NaN if
        there is no usable position, and null in Arrow. The table needs a column ``time`` in seconds.

        Args:
            previous: Unwrapped position and time of the last usable frame before the table, for the first speed.

        Returns:
            The table. It also has the other columns of this table.

        Raises:
            AttributeError: The frames have no position.
            RangeError: A position is above the highest or below the lowest that this encoder sends.
            ValueError: There is no column ``time``, or the manual does not give the size of a count or the
                wrap-around point.
        """
        # This table, for type checkers with any unit.
        table: Any = self
        family = getattr(self.encoder, "family", None)
        unit: Unit = "metres" if family is not None and family.movement is Movement.LINEAR else "radians"
        columns = {unit: table.in_units(unit), f"{unit}_per_second": self._compute_speed(None, unit, previous)}
        return self.with_columns(**columns)

    def _as_columns(self) -> Columns:
        """Return this table as columns with any names, for functions that do not know the names."""
        return cast(Columns, self)

    def hidden(self, name: str) -> Any:
        """Return a mask of the rows in which a column has no meaning, or None if it always has a meaning.

        The position and the fields that it is joined from have no meaning in rows without a usable position. Flags have
        no meaning in rows of missing frames and of frames with a wrong length.
        """
        if name in self._scales:
            # A quantity has no meaning where its number has none.
            number_name, _ = self._scales[name]
            return self.hidden(number_name)
        if name in self._position_columns:
            return ~self.usable
        column = self._columns.get(name)
        # Only flags are columns of bools.
        is_flag = column is not None and column.dtype == bool
        return self._fault == ErrorKind.LENGTH if is_flag else None

    def to_arrow(self, *, raw: bool = False) -> Any:
        """Return an Arrow table with the same columns. Needs pyarrow.

        ``fault`` and ``verdict`` are strings. A value that is NaN is null.

        Args:
            raw: Keep positions that are not usable. Otherwise they are null.

        Returns:
            A ``pyarrow.Table``.
        """
        return load("pyarrow").table(arrow_columns(self._as_columns(), self.names, raw))

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """Return the columns as an Arrow stream, for example for polars and DuckDB. Needs pyarrow."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def to_pandas(self, *, raw: bool = False) -> Any:
        """Return a pandas DataFrame with the same columns. Needs pandas.

        ``fault`` and ``verdict`` are categorical strings.

        Args:
            raw: Keep positions that are not usable. Otherwise they are ``<NA>``, in an ``Int64`` column.

        Returns:
            A ``pandas.DataFrame``.
        """
        return load("pandas").DataFrame(pandas_columns(self._as_columns(), self.names, raw))
