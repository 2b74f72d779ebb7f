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
from ..files.layouts import find_frame_layout
from ..files.sources import find_kind, open_source
from .common import USAGE, CommandFailed, find_encoder, missing_package_error, show_progress

np: Any = import_module("numpy")

#: Number of lost cycles and accesses that are printed.
_MOST_PRINTED = 10
#: Maximum number of characters that are searched for the column of frames in the header of a CSV file.
_LONGEST_HEADER = 1 << 16


def capture(package: str, options: argparse.Namespace) -> None:
    """Decode a capture into a file of columns."""
    encoder = _select_encoder(package, options)
    with show_progress(package, options.files[0]) as progress:
        # The arguments that say how the encoder was connected, and which frames it sends.
        capture_arguments = _list_capture_arguments(options)
        summary = Captures(package).decode_capture(
            encoder,
            options.files,
            options.output,
            **capture_arguments,
            si=options.si,
            to=options.write,
            columns=options.columns,
            limit=options.limit,
            raw=options.raw,
            force=options.force,
            progress=progress,
        )
    _print_summary(summary, options)


def plot(package: str, options: argparse.Namespace) -> None:
    """Plot position and speed of a capture over time."""
    encoder = _select_encoder(package, options)
    try:
        from .plot import save
    except ImportError as error:
        raise missing_package_error(error) from None
    with show_progress(package, options.files[0]):
        lost: tuple[Lost, ...] = ()
        if _has_frames(options.files[0]):
            table = _read_frames(encoder, options)
        else:
            table, lost, *_ = Captures(package).read_capture(encoder, options.files, **_list_capture_arguments(options))
        if not table.count:
            raise CommandFailed(_explain_no_frames(lost, options))
        save(table, options.output, lost, force=options.force, sources=options.files)
    print(f"{options.output}: {table.count} frames, {len(lost)} lost")


def _has_frames(path: str) -> bool:
    """Return whether a file has a column of frames: a Parquet file, or a CSV file with a column ``word`` or ``frame``.

    Other files are captures.
    """
    file_kind = find_kind(path)
    if file_kind == "parquet":
        return True
    if file_kind != "csv":
        return False
    with open(path, encoding="utf-8-sig", errors="replace") as file:
        header = file.readline(_LONGEST_HEADER)
    column_names = (cell.strip().strip('"').lower() for cell in re.split("[,;\t]", header))
    return any(name in ("word", "frame") for name in column_names)


def _read_frames(encoder: Encoder | BissLayout, options: argparse.Namespace) -> Table:
    """Return a table of the frames in a file with the columns ``time`` and ``word`` or ``frame``."""
    if isinstance(encoder, BissLayout):
        layout = encoder.layout
    else:
        layout = find_frame_layout(encoder, options.layout, dict(options.choose))
    path = options.files[0]
    frames: list[Any] = []
    times: list[Any] = []
    storage = StorageFormat(number_base=options.digits, wanted_columns=("time",))
    with open_source(path, storage, layout, _accept_all_frames) as frame_source:
        if "time" not in frame_source.empty_columns:
            raise InputError(path, "no column 'time'; a plot needs the time of each frame in seconds")
        for part in frame_source.batches:
            times.append(read_seconds(part.other_columns["time"], path))
            frames += _list_rows(part.frames) if layout.byte_count else _list_numbers(part.frames)
    # Without the empty array, a file without frames would have nothing to join.
    all_times = np.concatenate([np.zeros(0), *times])
    table = decode_many(frames, layout, encoder)
    return table.with_columns(time=all_times)


def _accept_all_frames(_frames: Any) -> float:
    """Return 1.0 as the fraction of valid frames, so that the check of a file's first frames always passes."""
    return 1.0


def _list_rows(frames: Any) -> list[bytes | None]:
    """Return rows of bytes as a list of bytes. A missing frame is None."""
    return [None if row is None else bytes(row) for row in frames]


def _list_numbers(frames: Any) -> Any:
    """Return numbers as a list. A missing frame is None."""
    return frames.tolist() if hasattr(frames, "tolist") else frames


def _select_encoder(package: str, options: argparse.Namespace) -> Encoder | BissLayout:
    """Return the encoder or the layout selected by the arguments.

    Without ``--biss``, the first of ``files`` is the label of the encoder. It becomes ``order_code``, and is removed
    from the files.

    Raises:
        CommandFailed: The layout or the label is wrong, or there is no file.
    """
    if options.biss is not None:
        try:
            return biss_layout(options.biss)
        except UsageError as error:
            raise CommandFailed(error, USAGE) from None
    # The command line puts both into one list, because the label is omitted with --biss.
    options.order_code, *options.files = options.files
    try:
        encoder = find_encoder(package, options)
    except CommandFailed:
        if os.path.isfile(options.order_code):
            problem = f"{options.order_code} is a file: give the order code in front of it, or --biss"
            raise CommandFailed(problem, USAGE) from None
        raise
    if not options.files:
        raise CommandFailed("give the order code and the file of the capture, or --biss and the file", USAGE)
    return encoder


def _list_capture_arguments(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments that ``capture`` and ``plot`` pass on to the functions for captures, by name.

    Example: ``{"clock": "MA", "data": "SLO", "rate": None, …, "layout": "", "answers": {}}``.
    """
    names = ("clock", "data", "rate", "rest", "baud", "threshold", "layout")
    arguments: dict[str, Any] = {name: getattr(options, name) for name in names}
    # ``choose`` contains pairs of the name of a question and the answer.
    arguments["answers"] = dict(options.choose)
    return arguments


def _print_summary(summary: CaptureSummary, options: argparse.Namespace) -> None:
    """Print the counts of a capture, its first lost cycles and its first register accesses.

    Raises:
        CommandFailed: There is no frame, or more than ``--max-errors`` percent of the cycles have no valid frame.
    """
    out = sys.stderr if options.output == "-" else sys.stdout
    if options.json:
        print(json.dumps(summary.to_dict()), file=out)
    else:
        for lost_cycle in summary.first_lost[:_MOST_PRINTED]:
            print(f"{lost_cycle.time:.9g}: {lost_cycle.reason}", file=out)
        lost_count = sum(summary.lost.values())
        if lost_count > _MOST_PRINTED:
            print(f"... and {lost_count - _MOST_PRINTED} more lost", file=out)
        for access in summary.accesses[:_MOST_PRINTED]:
            print(f"{access.time:.9g}: {access}", file=out)
        more_accesses = summary.access_count - _MOST_PRINTED
        if more_accesses > 0:
            print(f"... and {more_accesses} more accesses; --json prints all of them", file=out)
        print(summary, file=out)
    frame_counts = summary.frames
    if not frame_counts.frames:
        raise CommandFailed(_explain_no_frames(summary.first_lost, options))
    if 100 * summary.error_rate > options.max_errors:
        problem = f"{summary.error_rate:.0%} of the cycles have no valid frame"
        raise CommandFailed(
            f"{problem}; check {_name_layout(options)} and the channels (--max-errors is {options.max_errors:g})"
        )


def _name_layout(options: argparse.Namespace) -> str:
    """Return the name of the argument that describes the frames, for a message."""
    return "the order code" if options.biss is None else "the layout (--biss)"


def _explain_no_frames(lost: Any, options: argparse.Namespace) -> str:
    """Return the message for a capture without a frame, with the reason for the first lost cycle."""
    first_lost: Lost | None = next(iter(lost), None)
    reason = f": {first_lost.reason}" if first_lost else ""
    return f"the capture contains no frame{reason}; check the channels (--clock, --data) and {_name_layout(options)}"
