# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads the columns passed to ``encode_many``, and reports the first value that does not fit."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Final

from ..errors import RangeError
from .chunk import np
from .shape import Column, FrameLayout, find_scales

#: Allowed ``dtype.kind`` of the NumPy array for a field, if it allows more than integers. Bools are not numbers.
ARRAY_KINDS: Final[Mapping[str, str]] = {"text": "SU", "flag": "uib", "not_flag": "uib"}


class RowError(RangeError):
    """A value cannot be encoded. ``row`` is the index of the first row with such a value."""

    def __init__(self, row: int, field: str, value: object, allowed: str) -> None:
        super().__init__(field, value, allowed)
        self.row = row
        self.args = (row, field, value, allowed)

    def __str__(self) -> str:
        return f"row {self.row}: {super().__str__()}"


class FirstError:
    """First error in the rows: the first wrong field in the first row that has an error.

    Fields are checked one after another, each in all rows. ``row`` is the lowest row with an error so far, or None.
    ``_error`` holds the arguments of its ``RowError``: field, value and allowed values.
    """

    def __init__(self) -> None:
        self.row: int | None = None
        self._error: tuple[str, object, str] = ("", 0, "")

    def add(self, is_wrong: Any, field: str, values: Any, allowed: str) -> None:
        """Record the first row in which ``is_wrong`` is True, unless this row or an earlier one already has an error.

        ``values`` are the values of ``field`` in all rows, and ``allowed`` describes the allowed values, for the
        message.
        """
        if not is_wrong.any():
            return
        row = int(is_wrong.argmax())
        if self.row is None or row < self.row:
            self.row = row
            self._error = (field, values[row].item(), allowed)

    def raise_first(self, start: int) -> None:
        """Raise RowError if there is an error. ``start`` is the index of the first of these rows among all rows."""
        if self.row is not None:
            raise RowError(start + self.row, *self._error)


def read_arrays(columns: Mapping[str, Any], layout: FrameLayout, other_names: Iterable[str]) -> dict[str, Any]:
    """Return the available columns of the frame as arrays of equal length. A single value applies to all rows.

    ``other_names`` are the names of columns that do not belong to the frame and are ignored.

    Raises:
        TypeError: A column is missing, unknown or of the wrong type.
        ValueError: The columns have different lengths.
    """
    if not hasattr(columns, "keys"):
        raise TypeError(f"columns must be a mapping of names to arrays, got {type(columns).__name__}")
    fields: dict[str, Column] = {}
    for column in layout.columns:
        fields |= dict.fromkeys(list_names(column), column)
    _check_names([*columns], fields, layout, other_names)
    joined_names = [join.name for join in layout.joins]
    names_present = [name for name in (*fields, *joined_names, "unused", "fault") if name in columns]
    arrays = {name: _make_array(name, columns[name]) for name in names_present}
    # Single values become arrays without dimensions. If there are only single values, there is one row.
    row_count = max((array.size for array in arrays.values() if array.ndim), default=1)
    for name, array in arrays.items():
        field_kind = fields[name].value_kind if name in fields else "number"
        _check_array(name, array, columns[name], field_kind, row_count)
    return {name: np.broadcast_to(array, (row_count,)) for name, array in arrays.items()}


def _make_array(name: str, cells: Any) -> Any:
    """Return a column as an array. Raises TypeError if its cells have different shapes or are masked."""
    try:
        array: Any = np.asanyarray(cells)
    except ValueError:
        raise TypeError(f"column {name} is not a row of values: its cells have different shapes") from None
    if not isinstance(array, np.ma.MaskedArray):
        return np.asarray(array)
    if np.ma.getmaskarray(array).any():
        raise TypeError(f"column {name} has masked values, which no frame can contain: leave out their rows")
    return array.filled()


def _check_array(name: str, array: Any, cells: Any, field_kind: str, row_count: int) -> None:
    """Raise an error if a column does not have ``row_count`` rows, or if its type does not fit a field of this kind.

    ``array`` was made from ``cells``, the column that the caller passed.

    Raises:
        ValueError: The length is wrong.
        TypeError: The type is wrong.
    """
    is_single_value = array.ndim == 0
    if array.ndim > 1:
        raise ValueError(f"column {name} has the shape {array.shape}: expected one value per row")
    if not is_single_value and array.shape != (row_count,):
        raise ValueError(f"column {name} has the shape {array.shape}, but others have {row_count} rows")
    # An empty list has no type.
    if array.size and array.dtype.kind not in ARRAY_KINDS.get(field_kind, "ui"):
        if _has_missing(array):
            raise TypeError(f"column {name} has missing values, which no frame can contain: leave out their rows")
        advice = ": convert it to integers" if array.dtype.kind in "fO" else ""
        raise TypeError(f"column {name} has the type {array.dtype}, which does not fit the field{advice}")
    # NumPy converts bools to numbers if the list also has numbers, so the type of the array does not show them.
    if not field_kind.endswith("flag") and isinstance(cells, (list, tuple)) and _has_bool(cells):
        raise TypeError(f"column {name} contains bools, which do not fit the field")


def _has_missing(array: Any) -> bool:
    """Return whether a value is missing: NaN or None, as in an Arrow column that became an array."""
    if array.dtype.kind == "f":
        return bool(np.isnan(array).any())
    return array.dtype.kind == "O" and any(cell is None for cell in array.flat)


def _has_bool(cells: Any) -> bool:
    """Return whether a cell is a bool."""
    return any(type(cell) is bool for cell in cells)


def _check_names(
    columns: Collection[str], fields: Mapping[str, Column], layout: FrameLayout, other_names: Iterable[str]
) -> None:
    """Raise TypeError if a column is missing or unknown.

    ``fields`` contains the field of each column by name. Flags, fields without bits, and unused bits may be omitted. If
    a joined number is given, its fields may be omitted too. Additional columns of a decoded table are ignored.
    """
    optional = {"unused"}
    for name, column in fields.items():
        if column.value_kind.endswith("flag") or not column.width:
            optional.add(name)
    for join in layout.joins:
        if join.name in columns:
            optional.update(name for name, _ in join.fields)
    missing_names = sorted(fields.keys() - {*columns} - optional)
    joined_names = {join.name for join in layout.joins}
    ignored_names = {*other_names, *find_scales(layout), "unused", "fault", "verdict"}
    unknown_names = sorted(map(str, {*columns} - ignored_names - fields.keys() - joined_names))
    known_names = ", ".join([*fields, *sorted(joined_names)])
    if unknown_names:
        raise TypeError(f"unknown columns: {', '.join(unknown_names)}; the columns are {known_names}")
    if missing_names:
        raise TypeError(f"missing columns: {', '.join(missing_names)}; the columns are {known_names}")


def list_names(column: Column) -> tuple[str, ...]:
    """Return the names of a field's columns: one for each group of its decimal digits, or just the field."""
    return tuple(name for name, _, _ in column.digit_groups) or (column.name,)
