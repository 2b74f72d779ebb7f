# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encoder of the frames in a table, and the base class with the types of its columns and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, Protocol

from ..codec import PositionRange


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
