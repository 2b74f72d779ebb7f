# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encoder of the frames in a table, and the base classes of a table: the types of its columns, and its frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, Protocol, cast

from ..codec import PositionRange
from ..packages import load


class FrameSource(Protocol):
    """Encoder of the frames in a table, or a frame layout."""

    @property
    def code(self) -> str:
        """Order code, or the layout as text."""
        ...

    def _range_in(self, frame: str, /) -> PositionRange: ...


if TYPE_CHECKING:
    # Type checkers know this module, which the standard library of Python 3.10 does not replace.
    from typing_extensions import TypeVar

    ColumnName = TypeVar("ColumnName", bound=str, default=Any)
    PositionUnit = TypeVar("PositionUnit", bound=str, default=Any)

    class TableOf(Generic[ColumnName, PositionUnit]):
        """Base class for type checkers, generic over column names and units."""

else:
    ColumnName = PositionUnit = str

    class TableOf:
        """Base at run time."""

        def __class_getitem__(cls, arguments: object) -> type:
            """Return the class itself."""
            return cls


class FrameSequence(ABC):
    """Frames as a sequence. Each frame is a dictionary with its values by the names of the columns.

    NaN counts as equal to NaN, because a frame without a usable position has NaN as its speed.
    """

    encoder: FrameSource | None

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""

    @property
    @abstractmethod
    def columns(self) -> dict[str, Any]:
        """Columns by name."""

    @abstractmethod
    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield the frames."""

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return self.rows()

    def index(self, frame: Mapping[str, Any]) -> int:
        """Return the index of the first frame with these values.

        Args:
            frame: Values by the names of the columns, as ``table[7]`` returns them.

        Raises:
            TypeError: ``frame`` is not a dictionary, for example a decoded frame.
            ValueError: The table has no such frame.
        """
        if not isinstance(cast("object", frame), Mapping):
            raise TypeError(f"expected a dictionary with the values of a frame, got {type(frame).__name__}")
        for index, row in enumerate(self.rows()):
            if _have_same_values(row, frame):
                return index
        raise ValueError("the table has no frame with these values")

    def __contains__(self, name_or_frame: object) -> bool:
        """Return whether the table has a column of this name, or a frame with these values."""
        if isinstance(name_or_frame, str):
            return name_or_frame in self.names
        if not isinstance(name_or_frame, Mapping):
            return False
        frame = cast("Mapping[str, Any]", name_or_frame)
        return any(_have_same_values(row, frame) for row in self.rows())

    def __eq__(self, other: object) -> bool:
        """Return whether two tables have the same encoder and the same columns. The bits of invalid frames count."""
        if not isinstance(other, FrameSequence):
            return NotImplemented
        if self.encoder != other.encoder or self.names != other.names:
            return False
        return all(map(_have_same_cells, self.columns.values(), other.columns.values()))

    # Like other sequences that can be compared and changed, a table cannot be the key of a dictionary.
    __hash__ = None  # type: ignore[assignment]


def _have_same_values(frame: Mapping[str, Any], other_frame: Mapping[str, Any]) -> bool:
    """Return whether two frames have the same values by the same names."""
    if frame.keys() != other_frame.keys():
        return False
    for name, value in frame.items():
        other_value = other_frame[name]
        are_both_nan = value != value and other_value != other_value
        if value != other_value and not are_both_nan:
            return False
    return True


def _have_same_cells(column: Any, other_column: Any) -> bool:
    """Return whether two columns have the same length and the same cells."""
    np: Any = load("numpy")
    cells, other_cells = np.asarray(column), np.asarray(other_column)
    if cells.shape != other_cells.shape:
        return False
    are_both_nan = (cells != cells) & (other_cells != other_cells)
    return bool(np.all((cells == other_cells) | are_both_nan))
