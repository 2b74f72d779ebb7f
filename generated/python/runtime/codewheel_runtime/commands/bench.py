# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Commands for captures: decode them, and draw plots."""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from importlib import import_module
from typing import Any

from ..bulk.decode import decode_many
from ..bulk.table import Table
from ..captures.any_biss import BissLayout, biss_layout
from ..captures.capture import Captures, CaptureSummary, Lost
from ..encoder import Encoder
from ..errors import InputError, UsageError
from ..files.inputs import StorageFormat, read_seconds
from ..files.layouts import find_shape
from ..files.sources import find_kind, open_source
from .common import USAGE, CommandFailed, find_encoder, missing_package_error, show_progress

np: Any = import_module("numpy")

#: Number of lost cycles and accesses that are printed.
_MOST_PRINTED = 10
#: Most characters of the header of a CSV file that are searched for the column of frames.
_LONGEST_HEADER = 1 << 16


def capture(package: str, chosen: argparse.Namespace) -> None:
    """Decode a capture into a file of columns."""
    encoder = _select_encoder(package, chosen)
    with show_progress(package, chosen.files[0]) as progress:
        # The arguments that say how the encoder was connected, and which frames it sends.
        capture_arguments = _list_capture_arguments(chosen)
        summary = Captures(package).decode_capture(
            encoder,
            chosen.files,
            chosen.output,
            **capture_arguments,
            si=chosen.si,
            to=chosen.write,
            columns=chosen.columns,
            limit=chosen.limit,
            raw=chosen.raw,
            force=chosen.force,
            progress=progress,
        )
    _print_summary(summary, chosen)


def plot(package: str, chosen: argparse.Namespace) -> None:
    """Plot position and speed of a capture over time."""
    encoder = _select_encoder(package, chosen)
    try:
        from .plot import save
    except ImportError as error:
        raise missing_package_error(error) from None
    with show_progress(package, chosen.files[0]):
        lost: tuple[Lost, ...] = ()
        if _has_frames(chosen.files[0]):
            table = _read_frames(encoder, chosen)
        else:
            table, lost, *_ = Captures(package).read_capture(encoder, chosen.files, **_list_capture_arguments(chosen))
        if not table.count:
            raise CommandFailed(_explain_no_frames(lost, chosen))
        save(table, chosen.output, lost, force=chosen.force, sources=chosen.files)
    print(f"{chosen.output}: {table.count} frames, {len(lost)} lost")


def _has_frames(path: str) -> bool:
    """Return whether a file has a column of frames: Parquet, or CSV with a column ``word`` or ``frame``.

    Other files are captures.
    """
    kind = find_kind(path)
    if kind == "parquet":
        return True
    if kind != "csv":
        return False
    with open(path, encoding="utf-8-sig", errors="replace") as file:
        header = file.readline(_LONGEST_HEADER)
    names = (cell.strip().strip('"').lower() for cell in re.split("[,;\t]", header))
    return any(name in ("word", "frame") for name in names)


def _read_frames(encoder: Encoder | BissLayout, chosen: argparse.Namespace) -> Table:
    """Return a table of the frames in a file that has the columns ``time`` and ``word`` or ``frame``."""
    if isinstance(encoder, BissLayout):
        shape = encoder.shape
    else:
        shape = find_shape(encoder, chosen.layout, dict(chosen.choose))
    path = chosen.files[0]
    frames: list[Any] = []
    times: list[Any] = []
    # Nothing checks the first frames here, so the function for their valid fraction does not matter.
    with open_source(path, StorageFormat(digits=chosen.digits, wanted=("time",)), shape, lambda frames: 1.0) as read:
        if "time" not in read.empty_columns:
            raise InputError(path, "", "no column 'time'; a plot needs the time of each frame in seconds")
        for part in read.parts:
            times.append(read_seconds(part.other_columns["time"], path))
            frames += _list_rows(part.frames) if shape.length else _list_numbers(part.frames)
    return decode_many(frames, shape, encoder).with_columns(time=np.concatenate([np.zeros(0), *times]))


def _list_rows(frames: Any) -> list[bytes | None]:
    """Return rows of bytes as a list of bytes. A missing frame is None."""
    return [None if row is None else bytes(row) for row in frames]


def _list_numbers(frames: Any) -> Any:
    """Return numbers as a list. A missing frame is None."""
    return frames.tolist() if hasattr(frames, "tolist") else frames


def _select_encoder(package: str, chosen: argparse.Namespace) -> Encoder | BissLayout:
    """Return the encoder or the layout that the arguments select.

    Without ``--biss``, the first of ``files`` is the label of the encoder. It becomes ``order_code``, and is removed
    from the files.

    Raises:
        CommandFailed: The layout or the label is wrong, or there is no file.
    """
    if chosen.biss is not None:
        try:
            return biss_layout(chosen.biss)
        except UsageError as error:
            raise CommandFailed(error, USAGE) from None
    # The command line puts both into one list, because the label is omitted with --biss.
    chosen.order_code, *chosen.files = chosen.files
    try:
        encoder = find_encoder(package, chosen)
    except CommandFailed:
        if os.path.isfile(chosen.order_code):
            problem = f"{chosen.order_code} is a file: give the order code in front of it, or --biss"
            raise CommandFailed(problem, USAGE) from None
        raise
    if not chosen.files:
        raise CommandFailed("give the order code and the file of the capture, or --biss and the file", USAGE)
    return encoder


def _list_capture_arguments(chosen: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments that ``capture`` and ``plot`` pass on to the functions for captures, by name.

    An example is ``{"clock": "MA", "data": "SLO", "rate": None, …, "layout": "", "answers": {}}``.
    """
    names = ("clock", "data", "rate", "rest", "baud", "threshold", "layout")
    arguments: dict[str, Any] = {name: getattr(chosen, name) for name in names}
    # ``choose`` contains pairs of the name of a question and the answer.
    arguments["answers"] = dict(chosen.choose)
    return arguments


def _print_summary(summary: CaptureSummary, chosen: argparse.Namespace) -> None:
    """Print the counts of a capture, its first lost cycles and its first register accesses.

    Raises:
        CommandFailed: There is no frame, or more than ``--max-errors`` percent of the cycles have no valid frame.
    """
    out = sys.stderr if chosen.output == "-" else sys.stdout
    if chosen.json:
        print(json.dumps(summary.to_dict()), file=out)
    else:
        for lost in summary.first_lost[:_MOST_PRINTED]:
            print(f"{lost.time:.9g}: {lost.reason}", file=out)
        more_lost = sum(summary.lost.values()) - _MOST_PRINTED
        if more_lost > 0:
            print(f"... and {more_lost} more lost", file=out)
        for access in summary.accesses[:_MOST_PRINTED]:
            print(f"{access.time:.9g}: {access}", file=out)
        more_accesses = summary.access_count - _MOST_PRINTED
        if more_accesses > 0:
            print(f"... and {more_accesses} more accesses; --json prints all of them", file=out)
        print(summary, file=out)
    if not summary.frames.frames:
        raise CommandFailed(_explain_no_frames(summary.first_lost, chosen))
    if 100 * summary.error_rate > chosen.max_errors:
        problem = f"{summary.error_rate:.0%} of the cycles have no valid frame"
        raise CommandFailed(
            f"{problem}; check {_name_layout(chosen)} and the channels (--max-errors is {chosen.max_errors:g})"
        )


def _name_layout(chosen: argparse.Namespace) -> str:
    """Return the name of the argument that describes the frames, for a message."""
    return "the order code" if chosen.biss is None else "the layout (--biss)"


def _explain_no_frames(lost: Any, chosen: argparse.Namespace) -> str:
    """Return the message for a capture without a frame, with the reason why the first cycle was lost."""
    first_lost: Lost | None = next(iter(lost), None)
    reason = f": {first_lost.reason}" if first_lost else ""
    return f"the capture contains no frame{reason}; check the channels (--clock, --data) and {_name_layout(chosen)}"
