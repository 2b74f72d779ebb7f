# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Columns of many decoded frames, and their conversion to other formats."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from fractions import Fraction
from math import tau
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Generic, Literal, Protocol, overload

from ..codec import PositionRange, shorten, whole_number
from ..errors import ErrorKind, RangeError
from ..facts import Scale
from ..packages import load
from ..reports import Movement, Verdict
from .conversion import insert_none
from .shape import ReportCause

#: Units for positions and speeds.
Unit = Literal["counts", "turns", "degrees", "radians", "micrometres", "millimetres", "metres"]
#: Units of encoders that measure angles, and of those that measure lengths.
AngleUnit = Literal["counts", "turns", "degrees", "radians"]
LengthUnit = Literal["counts", "micrometres", "millimetres", "metres"]
#: Units for speeds: a unit per second, or revolutions per minute.
SpeedUnit = Unit | Literal["rpm"]

#: Size of one turn in each angular unit, and size of each unit of length in micrometers.
_UNITS_PER_TURN: Final[Mapping[str, float]] = {"turns": 1, "degrees": 360, "radians": tau}
_MICROMETERS_PER_UNIT: Final[Mapping[str, int]] = {"micrometres": 1, "millimetres": 1_000, "metres": 1_000_000}
_POSITION_UNITS: Final = ("counts", *_UNITS_PER_TURN, *_MICROMETERS_PER_UNIT)


def all_match(columns: Any, values: Iterable[tuple[str, int]]) -> Any:
    """Return an array that is True for each row in which all these columns have the values next to their names."""
    matches: Any = True
    for name, value in values:
        matches = matches & (columns[name] == value)
    return matches


#: Number of rows that are converted to Python objects at once.
_ROWS_AT_ONCE: Final = 1 << 14
#: No other columns.
_NO_COLUMNS: Final[Mapping[str, Any]] = MappingProxyType({})


class UnitError(ValueError, AttributeError):
    """The encoder does not measure in this unit. The message lists the units that it measures in."""


class FrameSource(Protocol):
    """Encoder of the frames in a table, or a layout of frames instead."""

    @property
    def code(self) -> str:
        """Order code, or the layout as text."""
        ...

    def _range_in(self, frame: str, /) -> PositionRange: ...


if TYPE_CHECKING:
    # Type checkers know this module, which the standard library of Python 3.10 does not replace.
    from typing_extensions import TypeVar

    _Name = TypeVar("_Name", bound=str, default=Any)
    _Unit = TypeVar("_Unit", bound=str, default=Any)

    class _TableOf(Generic[_Name, _Unit]):
        """Base class for type checkers, generic in the names of the columns and in the units."""

else:
    _Name = _Unit = str

    class _TableOf:
        """Base at run time."""

        def __class_getitem__(cls, arguments: object) -> type:
            """Return the class itself."""
            return cls


class Table(_TableOf[_Name, _Unit]):
    """Columns of many frames: a NumPy array for each field, and ``fault`` with the error of each frame.

    The arrays hold the raw bits of every frame, including invalid ones. Use ``usable_position`` for positions: it is
    masked if there is none. ``to_arrow`` and ``to_pandas`` return null for frames without a usable position.

    Frames with a verdict also have a column ``verdict``: the index of the verdict in ``Verdict``. It is 0 if the
    position is not usable or the frame has an error.

    A number with a scale also has a column of its quantity, such as ``temperature (°C)``, with a
    :class:`decimal.Decimal` for each frame.

    A table can also have other columns, such as ``time``.

    A table is a sequence of frames: ``len(table)`` is their number, ``table[10:20]`` a table of ten frames, and
    ``table[7]`` a dictionary with the values of one frame. Iteration gives such a dictionary for each frame.
    ``table["singleturn"]`` is a column, and ``columns`` contains all of them.
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
        """Arrays by name of the report. Each is True for the valid frames with that report."""
        reports: dict[str, Any] = {}
        for cause in self._report_causes:
            reports[cause.report] = self._find_active(cause) & self.ok
        return reports

    def _find_active(self, cause: ReportCause) -> Any:
        """Return an array that is True for the frames in which the cause of a report is active, valid or not.

        The cause is columns with certain values, or an active flag, or unused bits that differ from the manual.
        """
        if cause.when:
            return all_match(self, cause.when)
        if cause.flag:
            return self._find_column(cause.flag)
        unused: Any = self._find_column("unused")
        # NumPy requires that the mask fits the type of the column, which has all unused bits.
        column_bits = 8 * unused.itemsize
        mask_in_column = cause.mask & ((1 << column_bits) - 1)
        return (unused & mask_in_column) != 0

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
        """Return a table with other columns added in front.

        Args:
            columns: Columns by name, each with a value for every frame. ``time`` is in seconds.

        Returns:
            The table.

        Raises:
            TypeError: A column is a single value.
            ValueError: A column has a different length, or the name of a decoded column.
        """
        for name, column in columns.items():
            if not hasattr(column, "__len__"):
                raise TypeError(f"'{name}' must have a value for every frame, got {shorten(column)}")
            if name in self._names and name not in self._others:
                raise ValueError(f"the frames already have a column '{name}'")
            if len(column) != self.count:
                raise ValueError(f"expected {self.count} values in '{name}', one per frame, got {len(column)}")
        return self._replace_columns(self._columns, self._fault, self._verdict, {**self._others, **columns})

    def _replace_columns(
        self, columns: dict[str, Any], fault: Any, verdict: Any, other_columns: Mapping[str, Any]
    ) -> Table:
        """Return a copy of the table with these columns, errors and verdicts, which can have other rows."""
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
    def __getitem__(self, name: _Name) -> Any: ...

    @overload
    def __getitem__(self, name: int) -> dict[str, Any]: ...

    @overload
    def __getitem__(self, name: slice) -> Table[_Name, _Unit]: ...

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
            columns = [self._read_cells(name, rows) for name in self.names]
            for row in zip(*columns, strict=True):
                yield dict(zip(self.names, row, strict=True))

    def _read_cells(self, name: str, rows: slice) -> list[Any]:
        """Return the values of a column in some rows as Python objects.

        Errors and verdicts become members of their enumerations, values without a meaning become None, and bytes become
        text.
        """
        column = self._find_column(name)[rows]
        cells: list[Any] = column.tolist() if hasattr(column, "tolist") else list(column)
        # A fault is the number of its ErrorKind. A verdict is its index in Verdict, whose values are texts.
        if name == "fault":
            return [ErrorKind(cell) for cell in cells]
        if name == "verdict":
            verdicts = [*Verdict]
            return [verdicts[cell] for cell in cells]
        hidden = self.hidden(name)
        if hidden is not None:
            cells = insert_none(hidden[rows].tolist(), cells)
        return [cell.decode("latin-1") if isinstance(cell, bytes) else cell for cell in cells]

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
            self._columns[name] = self._convert_to_quantities(*self._scales[name])
        if name in self._parts and name not in self._columns:
            # The part is computed once, and kept as a column.
            whole, low, width = self._parts[name]
            self._columns[name] = (self._columns[whole] >> low) & ((1 << width) - 1)
        if name not in self._columns:
            raise KeyError(self._unknown_column_error(name))
        return self._columns[name]

    def _unknown_column_error(self, name: str) -> str:
        """Return the message for a column that the table does not have, with the most similar name."""
        nearest = get_close_matches(name, self.names, n=1)
        suggestion = f"; did you mean {nearest[0]!r}?" if nearest else ""
        return f"no column {name[:40]!r}; the columns are {', '.join(self.names)}{suggestion}"

    def _convert_to_quantities(self, name: str, scale: Scale) -> Any:
        """Return the column ``name`` of numbers converted to quantities, such as degrees Celsius, as decimals."""
        np: Any = load("numpy")
        # Numbers such as temperatures repeat, so each different number is converted only once.
        different_numbers, index_in_numbers = np.unique(self._find_column(name), return_inverse=True)
        quantities = np.array([scale.decimal(number) for number in different_numbers.tolist()], object)
        return quantities[index_in_numbers]

    def scale(self, name: str) -> Scale | None:
        """Return the scale of a column of quantities, or None for other columns."""
        return self._scales[name][1] if name in self._scales else None

    def __contains__(self, name: object) -> bool:
        """Return whether the table has a column of this name."""
        return name in self._names

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return self.rows()

    def __len__(self) -> int:
        return self.count

    def __repr__(self) -> str:
        error_count = int((self._fault != 0).sum())
        encoder_text = f" of {self.encoder.code}" if self.encoder is not None else ""
        return f"<{len(self._fault)} frames{encoder_text}, {error_count} with an error: {', '.join(self.names)}>"

    def faults(self) -> dict[ErrorKind, int]:
        """Return the number of valid frames and the number of frames with each error, without those that are 0."""
        counts: dict[ErrorKind, int] = {}
        for kind in ErrorKind:
            count = int((self._fault == kind).sum())
            if count:
                counts[kind] = count
        return counts

    def unwrapped(self, previous: int | None = None) -> Any:
        """Return the position of each frame as a count that continues when the position wraps around.

        The count of the first usable position is this position, or the one nearest to ``previous``. A later frame
        without a usable position has the count of the preceding frame. An earlier one has ``previous``, or the first
        count. If no position is usable, all counts are ``previous`` or 0. Between two usable frames the encoder must
        move by less than half of the modulus, if the position wraps.

        Args:
            previous: Last count of the preceding frames, to continue from.

        Returns:
            An array of counts.

        Raises:
            AttributeError: The frames have no position, or belong to no encoder.
            RangeError: A position is above the highest or below the lowest that this encoder sends.
            ValueError: The manual does not say where the position of this encoder wraps around.
        """
        np: Any = load("numpy")
        encoder: Any = self.encoder
        position_range: PositionRange = encoder._range_in(self._frame)
        usable_rows = np.flatnonzero(self.usable)
        positions = self.position.astype(np.int64)
        if not len(usable_rows):
            return np.full(len(positions), previous or 0, np.int64)
        usable_positions = positions[usable_rows]
        for extreme in (int(usable_positions.max()), int(usable_positions.min())):
            if not position_range.lowest <= extreme <= position_range.highest:
                raise RangeError("position", extreme, f"{position_range.lowest} to {position_range.highest}")
        first_position = int(usable_positions[0])
        first_count = first_position if previous is None else position_range.unwrap(previous, first_position)
        steps = np.diff(usable_positions)
        modulus = position_range.modulus
        if modulus is not None:
            # The shorter way around: from minus half of the modulus to half of it.
            steps = (steps + modulus // 2) % modulus - modulus // 2
        # Index 0 is the count before the first usable position, and index n the count at the n-th usable position.
        count_before = first_count if previous is None else previous
        counts = np.concatenate([[count_before, first_count], first_count + np.cumsum(steps)])
        # For each frame, the number of usable positions up to it.
        usable_so_far = np.cumsum(self.usable)
        return counts[usable_so_far].astype(np.int64)

    def in_units(self, unit: _Unit, counts: Any = None) -> Any:
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
        numerator, denominator = self._find_unit_size(unit)
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
            An array of speeds. It is NaN for frames without a usable position, for the first frame that has one, and
            where the time is not later than at the previous usable frame.

        Raises:
            AttributeError: The frames have no position.
            RangeError: A position is above the highest or below the lowest that this encoder sends.
            ValueError: The encoder does not measure in this unit, or the manual does not give the size of a count or
                say where the position wraps around.
            ValueError: ``seconds`` is a single time that is 0, negative or infinite, or there is not one number for
                each frame. Or there is no column ``time``.
        """
        return self._compute_speed(seconds, unit, None)

    def _compute_speed(self, seconds: Any, unit: SpeedUnit, previous: tuple[int, float] | None) -> Any:
        """Return the speed in each row, measured from the previous usable position. It is NaN where there is none.

        ``seconds`` is the time between two frames, an array of times, or None for the column ``time``. ``previous`` is
        the unwrapped position and the time of the last usable frame before the table, or None.
        """
        np: Any = load("numpy")
        times = self._check_times(seconds)
        if unit not in (*_POSITION_UNITS, "rpm"):
            raise ValueError(f"'{unit[:40]}' is not a unit of speeds: use {', '.join((*_POSITION_UNITS, 'rpm'))}")
        usable_rows = np.flatnonzero(self.usable)
        usable_times = times[usable_rows]
        if previous is None:
            # The first usable row has no speed.
            rows_with_speed = usable_rows[1:]
            counts = self.unwrapped(None)[usable_rows]
        else:
            previous_count, previous_time = previous
            rows_with_speed = usable_rows
            counts = np.insert(self.unwrapped(previous_count)[usable_rows], 0, previous_count)
            usable_times = np.insert(usable_times, 0, previous_time)
        elapsed = np.diff(usable_times)
        # If the clock stops or is set back, or if a time is infinite, there is no speed.
        elapsed = np.where((elapsed > 0) & np.isfinite(elapsed), elapsed, np.nan)
        numerator, denominator = self._find_unit_size("turns" if unit == "rpm" else unit)
        seconds_per_unit_of_time = 60 if unit == "rpm" else 1
        speeds = np.full(self.count, np.nan)
        speeds[rows_with_speed] = np.diff(counts) * (seconds_per_unit_of_time * numerator) / denominator / elapsed
        return speeds

    def _check_times(self, seconds: Any) -> Any:
        """Return the time of each frame.

        ``seconds`` is the time between two frames, an array of times, or None for the column ``time``.

        Raises:
            ValueError: The column does not exist, the times are not numbers, their number differs from the number of
                frames, or a single time is 0, negative or infinite.
        """
        np: Any = load("numpy")
        if seconds is None:
            if "time" not in self._others:
                raise ValueError("the table has no column 'time'; pass the time between two frames in seconds")
            seconds = self._others["time"]
        times: Any = np.asarray(seconds)
        if times.dtype.kind not in "uifO":
            raise ValueError(f"times must be numbers in seconds, got an array of {times.dtype}")
        try:
            # Differences of unsigned integers would wrap around.
            times = times.astype(np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"times must be numbers in seconds, got {shorten(seconds)}") from None
        if times.ndim == 0:
            if not 0 < times < np.inf:
                raise ValueError(f"the time between two frames must be above 0 s, got {seconds}")
            return np.arange(self.count) * times
        if times.ndim > 1:
            raise ValueError(f"expected one time per frame, got an array of the shape {times.shape}")
        if len(times) != self.count:
            raise ValueError(f"expected {self.count} times, one per frame, got {len(times)}")
        return times

    def in_si(self, previous: tuple[int, float] | None = None) -> Table:
        """Return a table that also has the position and the speed in SI units.

        The columns are ``radians`` and ``radians_per_second``, or ``metres`` and ``metres_per_second``. They are NaN if
        there is no usable position, and null in Arrow. The table needs a column ``time`` in seconds.

        Args:
            previous: Unwrapped position and time of the last usable frame before the table, for the first speed.

        Returns:
            The table. It also has the other columns of this table.

        Raises:
            AttributeError: The frames have no position.
            RangeError: A position is above the highest or below the lowest that this encoder sends.
            ValueError: There is no column ``time``, or the manual does not give the size of a count or say where the
                position wraps around.
        """
        table: Any = self
        family = getattr(self.encoder, "family", None)
        unit: Unit = "metres" if family is not None and family.movement is Movement.LINEAR else "radians"
        columns = {unit: table.in_units(unit), f"{unit}_per_second": self._compute_speed(None, unit, previous)}
        return self.with_columns(**columns)

    def _find_unit_size(self, unit: str) -> tuple[float, int]:
        """Return the size of one count in a unit, as numerator and denominator: ``(360, 65536)`` for degrees.

        Raises:
            UnitError: The unit is a length and the encoder measures angles, or the other way around.
            ValueError: The unit is not a unit of positions.
        """
        if unit == "counts":
            return 1, 1
        encoder: Any = self.encoder
        if unit in _UNITS_PER_TURN:
            if not hasattr(encoder, "from_turns"):
                raise UnitError(self._wrong_unit_error(unit, _UNITS_PER_TURN))
            counts_per_turn: int = encoder.from_turns(1)
            return _UNITS_PER_TURN[unit], counts_per_turn
        if unit in _MICROMETERS_PER_UNIT:
            if not hasattr(encoder, "micrometres"):
                raise UnitError(self._wrong_unit_error(unit, _MICROMETERS_PER_UNIT))
            micrometers_per_count = Fraction(encoder.micrometres(1))
            micrometers_per_unit = _MICROMETERS_PER_UNIT[unit]
            return micrometers_per_count.numerator, micrometers_per_count.denominator * micrometers_per_unit
        explanation = "; it is a unit of speed" if unit == "rpm" else ""
        raise ValueError(f"'{unit[:40]}' is not a unit of positions{explanation}: use {', '.join(_POSITION_UNITS)}")

    def _wrong_unit_error(self, unit: str, units_of_same_kind: Mapping[str, float]) -> str:
        """Return the message for a unit that the encoder does not measure in, with the units that it measures in.

        ``units_of_same_kind`` contains either all units of angles or all units of lengths, including ``unit``.
        """
        if self.encoder is None:
            return f"these frames belong to no encoder, so they have no {unit}: use counts"
        is_length = units_of_same_kind is _MICROMETERS_PER_UNIT
        measured = "angles, not lengths" if is_length else "lengths, not angles"
        supported_units = _UNITS_PER_TURN if is_length else _MICROMETERS_PER_UNIT
        units_text = ", ".join(("counts", *supported_units))
        return f"{self.encoder.code} measures {measured}: use {units_text} instead of {unit}"

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
        from .conversion import arrow_columns

        table: Any = self
        return load("pyarrow").table(arrow_columns(table, self.names, raw))

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
        from .conversion import pandas_columns

        table: Any = self
        return load("pandas").DataFrame(pandas_columns(table, self.names, raw))
