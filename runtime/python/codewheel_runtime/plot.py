# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Plots the position and the speed of frames over time, with errors marked. Needs matplotlib."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import import_module
from pathlib import PurePath
from typing import Any, Final

from .clocked import Lost
from .inputs import UsageError
from .stream import written
from .table import ErrorKind, SpeedUnit, Table, Unit

np: Any = import_module("numpy")
_FIGURE: Any = import_module("matplotlib.figure")
_COLLECTIONS: Any = import_module("matplotlib.collections")

_KINDS: Final = ("png", "svg", "pdf")
#: Units to try, with their labels: the unit and label of positions, and of speeds.
_UNITS: Final[tuple[tuple[Unit, str, SpeedUnit, str], ...]] = (
    ("millimetres", "position in mm", "millimetres", "speed in mm/s"),
    ("degrees", "angle in degrees", "rpm", "speed in rpm"),
    ("counts", "position in counts", "counts", "speed in counts/s"),
)
#: Number of points above which only the lowest and highest of each column of pixels are drawn.
_POINTS: Final = 20_000


def figure(table: Table, lost: Sequence[Lost] = (), title: str = "") -> Any:
    """Draw the position and the speed over time.

    Frames with an error, frames without a usable position, and lost cycles are marked at their times.

    Args:
        table: The frames, with a column ``time`` or ``sample``.
        lost: Cycles without a frame.
        title: Title. The default is the order code.

    Returns:
        A ``matplotlib.figure.Figure``.

    Raises:
        ValueError: The table has no column of times, or the frames have no position.
    """
    axis = next((name for name in ("time", "sample") if name in table), None)
    if axis is None:
        raise ValueError("the table has no column 'time'")
    times = np.asarray(table[axis], np.float64)
    angle, named, speed, speed_named = _unit(table)
    drawn = _FIGURE.Figure(figsize=(10, 6), layout="constrained")
    top, bottom = drawn.subplots(2, 1, sharex=True)
    code = getattr(table.encoder, "code", "")
    drawn.suptitle(title or code or "frames")
    usable = table.usable
    _line(top, times, table.in_units(angle), angle == "degrees")
    top.set_ylabel(named)
    try:
        _line(bottom, times, table.velocity(times, speed), False)
    except (AttributeError, ValueError):
        bottom.text(
            0.5, 0.5, "the speed is unknown: the position may wrap around", transform=bottom.transAxes, ha="center"
        )
    bottom.set_ylabel(speed_named if axis == "time" else speed_named.replace("/s", "/sample"))
    bottom.set_xlabel("time in s" if axis == "time" else "sample")
    marks = [
        (times[table.fault == kind], f"{_error(kind)}", colour)
        for kind, colour in zip((*ErrorKind,)[1:], ("tab:purple", "tab:red", "tab:pink", "tab:brown"), strict=True)
    ]
    marks.append((times[table.ok & ~usable], "position not usable", "tab:orange"))
    marks.append((np.array([item.time for item in lost], np.float64), "lost", "black"))
    for at, name, colour in marks:
        if len(at):
            _mark((top, bottom), at, f"{name} ({len(at)})", colour)
    if top.get_legend_handles_labels()[1]:
        # Above the axes, where it does not cover the plot.
        top.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=3, frameon=False, fontsize="small")
    for axes in (top, bottom):
        axes.grid(alpha=0.3)
        axes.margins(x=0.01)
    return drawn


def save(
    table: Table,
    target: str | os.PathLike[str],
    lost: Sequence[Lost] = (),
    *,
    title: str = "",
    force: bool = False,
    sources: Sequence[str] = (),
) -> None:
    """Draw the position and the speed over time, and write the picture.

    Args:
        table, lost, title: See ``figure``.
        target: The file to write: ``.png``, ``.svg`` or ``.pdf``.
        force: Replace an existing file.
        sources: Files that were read, which are not replaced.

    Raises:
        UsageError: The format is unknown, the file exists, or the table has no times or no positions.
        OSError: The file cannot be written.
    """
    kind = PurePath(target).suffix.lower().removeprefix(".")
    if kind not in _KINDS:
        raise UsageError(f"{os.fspath(target)}: the name of a picture ends in .png, .svg or .pdf")
    try:
        drawn = figure(table, lost, title)
    except (ValueError, AttributeError) as error:
        raise UsageError(f"nothing to plot: {error}") from None
    with written(os.fspath(target), sources, force) as file:
        drawn.savefig(file, format=kind, dpi=150)


def _unit(table: Table) -> tuple[Unit, str, SpeedUnit, str]:
    """Return the first unit that the encoder supports."""
    for item in _UNITS:
        try:
            table[:0].in_units(item[0])
        except (AttributeError, ValueError):
            if item[0] == "counts":
                raise ValueError("these frames have no position") from None
            continue
        return item
    raise AssertionError


def _error(kind: ErrorKind) -> str:
    return f"{'CRC' if kind is ErrorKind.CRC else kind.name.lower()} error"


def _line(axes: Any, times: Any, values: Any, wraps: bool) -> None:
    """Draw values over time. The line has a gap where the position wraps around."""
    times, values = _thinned(times, values)
    if wraps and len(values):
        jumps = np.flatnonzero(np.abs(np.diff(values)) > 180) + 1
        times, values = np.insert(times, jumps, times[jumps]), np.insert(values, jumps, np.nan)
    few = {"marker": ".", "markersize": 4} if len(values) < 200 else {}
    axes.plot(times, values, linewidth=1, **few)


def _thinned(times: Any, values: Any) -> tuple[Any, Any]:
    """Return at most a few thousand points that look the same: the extremes of each stretch."""
    known = np.isfinite(values)
    times, values = times[known], values[known]
    if len(values) <= _POINTS:
        return times, values
    size = -(-len(values) // (_POINTS // 2))
    whole = len(values) // size * size
    rows = values[:whole].reshape(-1, size)
    starts = np.arange(len(rows)) * size
    places = np.unique(np.concatenate([starts + rows.argmin(axis=1), starts + rows.argmax(axis=1), [len(values) - 1]]))
    return times[places], values[places]


def _mark(axes: Sequence[Any], times: Any, label: str, colour: str) -> None:
    """Mark times with thin vertical lines."""
    shown = times if len(times) <= _POINTS // 10 else times[:: -(-len(times) // (_POINTS // 10))]
    for place, one in enumerate(axes):
        lines = _COLLECTIONS.LineCollection(
            [[(at, 0), (at, 1)] for at in shown],
            transform=one.get_xaxis_transform(),
            colors=colour,
            linewidths=1,
            alpha=0.6,
            label=label if not place else None,
        )
        one.add_collection(lines, autolim=False)
