# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Columns of many decoded frames, and their conversion to other formats."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import IntEnum
from importlib import import_module
from math import tau
from typing import Any, Final, Literal

from .codec import unwrap
from .encoder import Encoder
from .errors import RangeError
from .reports import Verdict

#: Units for positions and speeds.
Unit = Literal["counts", "turns", "degrees", "radians", "micrometres", "millimetres", "metres"]

#: Size of one turn in each angular unit, and size of each unit of length in micrometres.
_OF_A_TURN: Final[Mapping[str, float]] = {"turns": 1, "degrees": 360, "radians": tau}
_OF_A_LENGTH: Final[Mapping[str, int]] = {"micrometres": 1, "millimetres": 1_000, "metres": 1_000_000}


class Fault(IntEnum):
    """Frame errors, in the order in which ``decode`` checks for them."""

    NONE = 0
    LENGTH = 1
    CRC = 2
    CONSTANT = 3
    RANGE = 4


class Table(Mapping[str, Any]):
    """Columns of many frames: a NumPy array for each field, and ``fault`` with the error of each frame.

    The arrays hold the raw bits of every frame, including invalid ones. Use ``usable_position`` for positions: it is
    masked if there is none. ``to_arrow`` and ``to_pandas`` return nulls there.

    Frames with a verdict also have a column ``verdict``: the index of the verdict in ``Verdict``. It is 0 if the
    position is not usable or the frame has an error.
    """

    def __init__(
        self,
        encoder: Encoder | None,
        columns: dict[str, Any],
        fault: Any,
        verdict: Any,
        position: str,
        parts: Mapping[str, tuple[str, int, int]],
        tells: tuple[tuple[str, str, int], ...] = (),
        measured: frozenset[str] = frozenset(),
    ) -> None:
        self.encoder, self._tells, self._measured = encoder, tells, measured
        self._columns = columns
        self._fault, self._verdict, self._position, self._parts = fault, verdict, position, parts
        self._names = [*parts, *columns, *(["verdict"] if verdict is not None else []), "fault"]

    @property
    def fault(self) -> Any:
        """Error of each frame, as the number of a :class:`Fault`. Valid frames have 0."""
        return self._fault

    @property
    def ok(self) -> Any:
        """True for each valid frame."""
        return self._fault == 0

    @property
    def position(self) -> Any:
        """Raw position of each frame in counts, including invalid frames. See ``usable_position``.

        Raises:
            AttributeError: The frames have no position.
        """
        if not self._position:
            raise AttributeError("these frames have no position")
        return self[self._position]

    @property
    def usable_position(self) -> Any:
        """Position of each frame in counts, masked if the frame has an error or its position is not usable.

        Raises:
            AttributeError: The frames have no position.
        """
        np: Any = import_module("numpy")
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
        """True for each valid frame whose position is usable, with or without a warning."""
        worst = [*Verdict].index(Verdict.NOT_USABLE)
        return self.ok if self._verdict is None else (self._verdict != worst) & self.ok

    @property
    def reports(self) -> dict[str, Any]:
        """Arrays by name of the report. Each is True for the valid frames with that report."""
        made: dict[str, Any] = {}
        for report, flag, mask in self._tells:
            unused: Any = self["unused"] if mask else None
            active = self[flag] if flag else unused & (mask & (1 << 8 * unused.itemsize) - 1) != 0
            made[report] = active & self.ok
        return made

    def __getitem__(self, name: str) -> Any:
        if name == "fault":
            return self._fault
        if name == "verdict" and self._verdict is not None:
            return self._verdict
        if name in self._parts and name not in self._columns:
            whole, low, width = self._parts[name]
            self._columns[name] = self._columns[whole] >> low & ((1 << width) - 1)
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(self._names))

    def __len__(self) -> int:
        return len(dict.fromkeys(self._names))

    def __repr__(self) -> str:
        wrong = int((self._fault != 0).sum())
        of = f" of {self.encoder.code}" if self.encoder is not None else ""
        return f"<{len(self._fault)} frames{of}, {wrong} with an error: {', '.join(self)}>"

    def faults(self) -> dict[Fault, int]:
        """Return the number of valid frames and the number of frames with each error."""
        kinds = ((kind, int((self._fault == kind).sum())) for kind in Fault)
        return {kind: count for kind, count in kinds if count}

    def unwrapped(self, previous: int | None = None) -> Any:
        """Return the position of each frame as a count that continues when the position wraps around.

        It starts with the first usable position. A frame without a usable position has the count of the preceding
        frame. Between two usable frames the encoder must move by less than half of the ``modulus``.

        Args:
            previous: Last count of the preceding frames, to continue from.

        Returns:
            An array of counts.

        Raises:
            AttributeError: The frames have no position.
            RangeError: A position is above the highest that this encoder sends, or below 0.
            ValueError: The manual does not say where the position of this encoder wraps around.
        """
        np: Any = import_module("numpy")
        encoder: Any = self.encoder
        modulus: int = encoder.modulus
        highest: int = getattr(encoder, "highest", modulus - 1)
        good = np.flatnonzero(self.usable)
        position = self.position.astype(np.int64)
        if not len(good):
            return np.full(len(position), previous or 0, np.int64)
        used = position[good]
        for wrong in (int(used.max()), int(used.min())):
            if not 0 <= wrong <= highest:
                raise RangeError("position", wrong, f"0 to {highest}")
        start = int(used[0]) if previous is None else unwrap(previous, int(used[0]), modulus, highest)
        steps = (np.diff(used) + modulus // 2) % modulus - modulus // 2
        counts = np.concatenate([[start if previous is None else previous, start], start + np.cumsum(steps)])
        return counts[np.cumsum(self.usable)].astype(np.int64)

    def in_units(self, unit: Unit, counts: Any = None) -> Any:
        """Convert counts to a unit.

        Args:
            unit: The unit. Degrees and radians are within one revolution.
            counts: An array of counts, by default the position of each frame.

        Returns:
            An array of values. Without ``counts``, it is NaN if the position is not usable.

        Raises:
            AttributeError: The encoder does not measure in this unit.
            ValueError: The manual does not give the size of a count.
        """
        found = self.position if counts is None else counts
        one, parts = self._unit(unit)
        if unit in ("degrees", "radians"):
            found = found % parts
        made = found * one / parts
        np: Any = import_module("numpy")
        return np.where(self.usable, made, np.nan) if counts is None else made

    def velocity(self, seconds: Any, unit: Unit = "counts") -> Any:
        """Return the speed of the encoder, measured from the previous usable position.

        Args:
            seconds: Time between two frames, or an array with the time of each frame.
            unit: Unit of length or angle.

        Returns:
            An array of speeds in units per second. It is NaN for frames without a usable position, and for the first
            frame that has one.

        Raises:
            AttributeError, RangeError, ValueError: See ``unwrapped`` and ``in_units``.
        """
        np: Any = import_module("numpy")
        counts, good = self.unwrapped(), np.flatnonzero(self.usable)
        times = np.arange(len(counts)) * seconds if np.ndim(seconds) == 0 else np.asarray(seconds)
        if len(times) != len(counts):
            raise ValueError(f"expected {len(counts)} times, one per frame, got {len(times)}")
        one, parts = self._unit(unit)
        found = np.full(len(counts), np.nan)
        found[good[1:]] = np.diff(counts[good]) * one / parts / np.diff(times[good])
        return found

    def _unit(self, unit: Unit) -> tuple[float, int]:
        """Return the size of one count in a unit, as numerator and denominator."""
        if unit == "counts":
            return 1, 1
        encoder: Any = self.encoder
        if unit in _OF_A_TURN:
            per_turn: int = encoder.from_turns(1)
            return _OF_A_TURN[unit], per_turn
        micrometres: int = encoder.micrometres(1)
        return micrometres, _OF_A_LENGTH[unit]

    def hidden(self, name: str) -> Any:
        """Return a mask of the rows in which a column has no meaning, or None if it always has one.

        A column that is the position or a part of it has no meaning in rows without a usable position.
        """
        return ~self.usable if name in self._measured else None

    def to_arrow(self, *, raw: bool = False) -> Any:
        """Return an Arrow table with the same columns. Needs pyarrow.

        Args:
            raw: Keep positions that are not usable. Otherwise they are null.
        """
        pa: Any = import_module("pyarrow")
        return pa.table({name: pa.array(self[name], mask=None if raw else self.hidden(name)) for name in self})

    def to_pandas(self, *, raw: bool = False) -> Any:
        """Return a pandas DataFrame with the same columns. Needs pandas.

        Args:
            raw: Keep positions that are not usable. Otherwise they are ``<NA>``, in a column of ``Int64``.
        """
        pd: Any = import_module("pandas")
        found: dict[str, Any] = {}
        for name in self:
            hidden = None if raw else self.hidden(name)
            found[name] = self[name] if hidden is None else pd.arrays.IntegerArray(self[name], hidden)
        return pd.DataFrame(found)
