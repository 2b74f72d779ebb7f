# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Plots the position and the speed of frames over time, with errors marked. Needs matplotlib."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from importlib import import_module
from math import ceil
from pathlib import PurePath
from typing import Any, Final, NamedTuple

from ..bulk.table import SpeedUnit, Table, Unit
from ..captures.captured_frames import Lost
from ..errors import ErrorKind, UsageError
from ..files.targets import open_for_writing

np: Any = import_module("numpy")
_FIGURE: Any = import_module("matplotlib.figure")
_COLLECTIONS: Any = import_module("matplotlib.collections")

_PICTURE_FORMATS: Final = ("png", "svg", "pdf")
_ERROR_COLORS: Final = {
    ErrorKind.LENGTH: "tab:purple",
    ErrorKind.CRC: "tab:red",
    ErrorKind.CONSTANT: "tab:pink",
    ErrorKind.RANGE: "tab:brown",
}


class _Units(NamedTuple):
    """Units of positions and speeds, with their labels."""

    position: Unit
    position_label: str
    speed: SpeedUnit
    speed_label: str


#: Units to try, in this order.
_UNITS_TO_TRY: Final = (
    _Units("millimetres", "position in mm", "millimetres", "speed in mm/s"),
    _Units("degrees", "angle in degrees", "rpm", "speed in rpm"),
    _Units("counts", "position in counts", "counts", "speed in counts/s"),
)
#: Maximum number of points of which all are drawn, instead of the lowest and the highest of each segment.
_MOST_POINTS: Final = 20_000
#: Number of points below which each of them is marked.
_FEW_POINTS: Final = 200


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
    time_columns = [name for name in ("time", "sample") if name in table]
    if not time_columns:
        raise ValueError("the table has no column 'time'")
    time_column = time_columns[0]
    times = np.asarray(table[time_column], np.float64)
    units = _choose_units(table)
    plot_figure = _FIGURE.Figure(figsize=(10, 6), layout="constrained")
    position_axes, speed_axes = plot_figure.subplots(2, 1, sharex=True)
    plot_figure.suptitle(title or getattr(table.encoder, "code", "") or "frames")
    _draw_line(position_axes, times, table.in_units(units.position), wraps=units.position == "degrees")
    position_axes.set_ylabel(units.position_label)
    _draw_speed(speed_axes, table, times, units.speed)
    is_timed = time_column == "time"
    # Without a sample rate, speeds are per sample.
    speed_axes.set_ylabel(units.speed_label if is_timed else units.speed_label.replace("/s", "/sample"))
    speed_axes.set_xlabel("time in s" if is_timed else "sample")
    for mark_times, label, color in _list_marks(table, times, lost):
        if len(mark_times):
            _draw_marks((position_axes, speed_axes), mark_times, f"{label} ({len(mark_times)})", color)
    _add_legend(position_axes)
    for axes in (position_axes, speed_axes):
        axes.grid(alpha=0.3)
        axes.margins(x=0.01)
    return plot_figure


def _add_legend(axes: Any) -> None:
    """Explain the marks in a legend above the axes, where it does not cover the plot. Without marks, there is none."""
    _, labels = axes.get_legend_handles_labels()
    if labels:
        axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=3, frameon=False, fontsize="small")


def _draw_speed(axes: Any, table: Table, times: Any, unit: SpeedUnit) -> None:
    """Draw the speed over time, or a note if the speed cannot be computed."""
    try:
        _draw_line(axes, times, table.velocity(times, unit), wraps=False)
    except (AttributeError, ValueError):
        note = "the speed is unknown: the position may wrap around"
        axes.text(0.5, 0.5, note, transform=axes.transAxes, ha="center")


def _list_marks(table: Table, times: Any, lost: Sequence[Lost]) -> Iterator[tuple[Any, str, str]]:
    """Yield times to mark, which may be empty, with a label and a color: ``(times, "CRC error", "tab:red")``."""
    for kind, color in _ERROR_COLORS.items():
        yield times[table.fault == kind], _name_error(kind), color
    yield times[table.ok & ~table.usable], "position not usable", "tab:orange"
    yield np.array([cycle.time for cycle in lost], np.float64), "lost", "black"


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
        table: The frames, with a column ``time`` or ``sample``.
        target: The file to write: ``.png``, ``.svg`` or ``.pdf``.
        lost: Cycles without a frame.
        title: Title. The default is the order code.
        force: Replace an existing file.
        sources: Input files, which are never replaced.

    Raises:
        UsageError: The format is unknown, the file exists, or the table has no times or no positions.
        OSError: The file cannot be written.
    """
    picture_format = PurePath(target).suffix.lower().removeprefix(".")
    if picture_format not in _PICTURE_FORMATS:
        raise UsageError(f"{os.fspath(target)}: the name of a picture ends in .png, .svg or .pdf")
    try:
        plot_figure = figure(table, lost, title)
    except (ValueError, AttributeError) as error:
        raise UsageError(f"nothing to plot: {error}") from None
    with open_for_writing(os.fspath(target), sources, force) as file:
        plot_figure.savefig(file, format=picture_format, dpi=150)


def _choose_units(table: Table) -> _Units:
    """Return the first units that the encoder supports. Raises ValueError if the frames have no position."""
    for units in _UNITS_TO_TRY:
        try:
            # The result does not matter. It raises an error if the unit does not apply.
            table[:0].in_units(units.position)
        except (AttributeError, ValueError):
            # Every position is in counts.
            if units.position == "counts":
                raise ValueError("these frames have no position") from None
            continue
        return units
    raise AssertionError


def _name_error(kind: ErrorKind) -> str:
    return f"{'CRC' if kind is ErrorKind.CRC else kind.name.lower()} error"


def _draw_line(axes: Any, times: Any, values: Any, wraps: bool) -> None:
    """Draw values over time. If they are degrees that wrap around (``wraps``), the line has a gap at each wrap."""
    times, values = _reduce_points(times, values)
    if wraps and len(values):
        # Degrees jump by up to 360 where they wrap around. A NaN there interrupts the line.
        wrap_indices = np.flatnonzero(np.abs(np.diff(values)) > 180) + 1
        times = np.insert(times, wrap_indices, times[wrap_indices])
        values = np.insert(values, wrap_indices, np.nan)
    # Few points are also drawn as dots.
    markers = {"marker": ".", "markersize": 4} if len(values) < _FEW_POINTS else {}
    axes.plot(times, values, linewidth=1, **markers)


def _reduce_points(times: Any, values: Any) -> tuple[Any, Any]:
    """Reduce points to about 20,000 that look the same when plotted, with their times.

    The points are split into segments of equal length. The lowest and the highest point of each segment are kept. Of
    the points after the last complete segment, only the last one is kept. NaN values are omitted.
    """
    is_finite = np.isfinite(values)
    times = times[is_finite]
    values = values[is_finite]
    if len(values) <= _MOST_POINTS:
        return times, values
    # Two points of each segment are kept.
    segment_size = ceil(len(values) / (_MOST_POINTS // 2))
    segment_count = len(values) // segment_size
    segments = values[: segment_count * segment_size].reshape(-1, segment_size)
    first_indices = np.arange(segment_count) * segment_size
    lowest_indices = first_indices + segments.argmin(axis=1)
    highest_indices = first_indices + segments.argmax(axis=1)
    last_index = len(values) - 1
    kept_indices = np.unique(np.concatenate([lowest_indices, highest_indices, [last_index]]))
    return times[kept_indices], values[kept_indices]


def _draw_marks(axes: Sequence[Any], times: Any, label: str, color: str) -> None:
    """Mark times with thin vertical lines."""
    # Where lines are too close to be distinguished, only some are drawn.
    most_lines = _MOST_POINTS // 10
    step = max(ceil(len(times) / most_lines), 1)
    # The ends of each line: 0 is the bottom of the axes, and 1 their top.
    line_ends = [[(time, 0), (time, 1)] for time in times[::step]]
    for index, plot_axes in enumerate(axes):
        lines = _COLLECTIONS.LineCollection(
            line_ends,
            transform=plot_axes.get_xaxis_transform(),
            colors=color,
            linewidths=1,
            alpha=0.6,
            # One entry in the legend for both plots.
            label=label if index == 0 else None,
        )
        plot_axes.add_collection(lines, autolim=False)
