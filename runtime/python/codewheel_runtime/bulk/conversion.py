# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Converts columns of decoded frames for Arrow and pandas."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Final, Protocol

from ..codec import shorten
from ..errors import ErrorKind
from ..facts import Scale
from ..packages import load
from ..reports import Verdict

#: Words that replace the numbers of a column, so that a file can be read without this package.
WORDS: Final[Mapping[str, tuple[str, ...]]] = {
    "fault": tuple(kind.name.lower() for kind in ErrorKind),
    "verdict": tuple(verdict.value for verdict in Verdict),
}
#: Number of digits for quantities in Arrow, which is enough for every scale.
_DECIMAL_PRECISION: Final = 38


class Columns(Protocol):
    """Columns of decoded frames. A table is one example."""

    def __getitem__(self, name: str, /) -> Any: ...

    def hidden(self, name: str) -> Any:
        """Return a mask of the rows in which a column has no meaning, or None if it always has a meaning."""
        ...

    def scale(self, name: str) -> Scale | None:
        """Return the scale of a column of quantities, or None for other columns."""
        ...


def insert_none(hidden: Iterable[bool], cells: Iterable[Any]) -> list[Any]:
    """Return the cells of a column as a list, with None in place of the cells for which ``hidden`` is True."""
    return [None if is_hidden else cell for cell, is_hidden in zip(cells, hidden, strict=True)]


def check_new_columns(columns: Mapping[str, Any], decoded_names: Collection[str], count: int) -> None:
    """Raise an error unless each column fits a table of ``count`` frames that has the columns ``decoded_names``.

    Raises:
        TypeError: A column is a single value.
        ValueError: A column has a different length, or the same name as a decoded column.
    """
    for name, column in columns.items():
        if not hasattr(column, "__len__"):
            raise TypeError(f"'{name}' must have a value for every frame, got {shorten(column)}")
        if name in decoded_names:
            raise ValueError(f"the frames already have a column '{name}'")
        if len(column) != count:
            raise ValueError(f"expected {count} values in '{name}', one per frame, got {len(column)}")


def make_unknown_column_message(name: str, names: Sequence[str]) -> str:
    """Return the message for a column that a table does not have, with the most similar of its ``names``."""
    nearest = get_close_matches(name, names, n=1)
    suggestion = f"; did you mean {nearest[0]!r}?" if nearest else ""
    return f"no column {name[:40]!r}; the columns are {', '.join(names)}{suggestion}"


def convert_to_quantities(numbers: Any, scale: Scale) -> Any:
    """Return a column of numbers converted to quantities, such as degrees Celsius, as decimals."""
    np: Any = load("numpy")
    # Numbers such as temperatures repeat, so each different number is converted only once.
    different_numbers, indices_of_numbers = np.unique(numbers, return_inverse=True)
    different_quantities = np.array([scale.decimal(number) for number in different_numbers.tolist()], object)
    return different_quantities[indices_of_numbers]


def read_cells(columns: Columns, name: str, rows: slice) -> list[Any]:
    """Return the values of a column in some rows as Python objects.

    Errors and verdicts become enumeration members, values without a meaning become None, and bytes become text.
    """
    column = columns[name][rows]
    cells: list[Any] = column.tolist() if hasattr(column, "tolist") else list(column)
    # A fault is the number of its ErrorKind. A verdict is its index in Verdict, whose values are texts.
    if name == "fault":
        return [ErrorKind(cell) for cell in cells]
    if name == "verdict":
        verdicts = [*Verdict]
        return [verdicts[cell] for cell in cells]
    hidden = columns.hidden(name)
    if hidden is not None:
        cells = insert_none(hidden[rows].tolist(), cells)
    return [cell.decode("latin-1") if isinstance(cell, bytes) else cell for cell in cells]


def list_texts(column: Any) -> list[str]:
    """Return the cells of a column of byte strings as text."""
    return [cell.decode("latin-1") for cell in column.tolist()]


def arrow_columns(table: Columns, names: Iterable[str], raw: bool = False) -> dict[str, Any]:
    """Return columns as Arrow arrays by name, with ``fault`` and ``verdict`` as strings.

    Values without meaning, such as a position that is not usable, are null unless ``raw`` is True. NaN is always null.
    """
    pa: Any = load("pyarrow")
    arrays: dict[str, Any] = {}
    for name in names:
        column = table[name]
        hidden = None if raw else table.hidden(name)
        scale = table.scale(name)
        if name in WORDS:
            # The numbers of the column are indices of its words. They are small, so int8 is enough.
            word_indices = pa.array(column.view("i1"))
            arrays[name] = pa.DictionaryArray.from_arrays(word_indices, pa.array(WORDS[name]))
        elif scale is not None:
            decimal_type = pa.decimal128(_DECIMAL_PRECISION, scale.places)
            arrays[name] = pa.array(column, decimal_type, mask=hidden)
        else:
            arrays[name] = _arrow_array(pa, column, hidden)
    return arrays


def _arrow_array(pa: Any, column: Any, hidden: Any) -> Any:
    """Return a column as an Arrow array. ``pa`` is the module ``pyarrow``.

    In arrays of numbers and flags, NaN and the values for which ``hidden`` is True become null.
    """
    if _is_text(column):
        return pa.array(list_texts(column), pa.string())
    is_numpy_array = hasattr(getattr(column, "dtype", None), "kind")
    return pa.array(column, mask=hidden, from_pandas=True) if is_numpy_array else pa.array(column)


def pandas_columns(table: Columns, names: Iterable[str], raw: bool = False) -> dict[str, Any]:
    """Return columns for pandas by name, with ``fault`` and ``verdict`` as categories.

    Values without meaning, such as a position that is not usable, are null unless ``raw`` is True.
    """
    pd: Any = load("pandas")
    columns: dict[str, Any] = {}
    for name in names:
        column = table[name]
        hidden = None if raw else table.hidden(name)
        if name in WORDS:
            columns[name] = pd.Categorical.from_codes(column.view("i1"), WORDS[name])
        elif table.scale(name) is not None:
            cells = column.tolist()
            columns[name] = cells if hidden is None else insert_none(hidden, cells)
        elif hidden is not None:
            nullable_array = pd.arrays.BooleanArray if column.dtype == bool else pd.arrays.IntegerArray
            columns[name] = nullable_array(column, hidden)
        else:
            columns[name] = list_texts(column) if _is_text(column) else column
    return columns


def _is_text(column: Any) -> bool:
    """Return whether a column is a NumPy array of byte strings. Other columns of a file may have a different type."""
    dtype = getattr(column, "dtype", None)
    return getattr(dtype, "kind", "") == "S"
