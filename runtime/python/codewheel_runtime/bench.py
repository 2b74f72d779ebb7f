# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Commands for the bench: decodes captures, draws plots, and shows an encoder live."""

from __future__ import annotations

import argparse
import json
import sys
from importlib import import_module
from typing import Any

from .any_biss import BissLayout, biss_layout
from .capture import Captures, CaptureSummary, Lost
from .command import USAGE, Failed, encoder_of, missing, working
from .encoder import Encoder
from .inputs import UsageError
from .reports import Interface

#: Number of lost cycles and accesses that are printed.
_PRINTED = 10


def capture(package: str, chosen: argparse.Namespace) -> None:
    """Decode a capture into a file of columns."""
    encoder = _encoder(package, chosen)
    with working(package, chosen.files[0]) as progress:
        summary = Captures(package).decode_capture(
            encoder,
            chosen.files,
            chosen.output,
            **_probes(chosen),
            si=chosen.si,
            to=chosen.write,
            columns=chosen.columns,
            limit=chosen.limit,
            raw=chosen.raw,
            force=chosen.force,
            progress=progress,
        )
    _report(summary, chosen)


def plot(package: str, chosen: argparse.Namespace) -> None:
    """Plot position and speed of a capture over time."""
    encoder = _encoder(package, chosen)
    try:
        from .plot import save
    except ImportError as error:
        raise missing(package, error) from None
    with working(package, chosen.files[0]):
        found = Captures(package).read_capture(encoder, chosen.files, **_probes(chosen))
        if not found.table.count:
            raise Failed(_nothing(found.lost))
        save(found.table, chosen.output, found.lost, force=chosen.force, sources=chosen.files)
    print(f"{chosen.output}: {found.table.count} frames, {len(found.lost)} lost")


def monitor(package: str, chosen: argparse.Namespace) -> None:
    """Show an encoder live."""
    from .monitor import watch

    encoder = encoder_of(package, chosen)
    if encoder.interface is not Interface.RS485:
        said = f"{encoder.code} has the interface {encoder.interface.title}, and a serial port cannot send its clock"
        raise Failed(f"{said}: record it with a logic analyser, and use 'capture'", USAGE)
    try:
        link: Any = import_module(f"{__package__}.link")
    except ImportError as error:
        raise missing(package, error) from None
    try:
        # Without retries, every error is counted.
        with link.open_encoder(chosen.port, encoder, retries=0) as opened:
            watch(opened, encoder, chosen.port, count=chosen.count, interval_s=chosen.interval)
    except link.LinkError as error:
        raise Failed(error) from None


def _encoder(package: str, chosen: argparse.Namespace) -> Encoder | BissLayout:
    """Return the encoder or the layout, and leave only the names of files in ``files``."""
    if chosen.biss is not None:
        try:
            return biss_layout(chosen.biss)
        except UsageError as error:
            raise Failed(error, USAGE) from None
    chosen.order_code, *chosen.files = chosen.files
    encoder = encoder_of(package, chosen)
    if not chosen.files:
        raise Failed("give the order code and the file of the capture, or --biss and the file", USAGE)
    return encoder


def _probes(chosen: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments that both commands have."""
    names = ("clock", "data", "rate", "rest", "baud", "layout")
    return {**{name: getattr(chosen, name) for name in names}, "answers": dict(chosen.choose)}


def _report(summary: CaptureSummary, chosen: argparse.Namespace) -> None:
    out = sys.stderr if chosen.output == "-" else sys.stdout
    if chosen.json:
        print(json.dumps(summary.to_dict()), file=out)
    else:
        for lost in summary.first_lost[:_PRINTED]:
            print(f"{lost.time:.9g}: {lost.reason}", file=out)
        if (more := sum(summary.lost.values()) - _PRINTED) > 0:
            print(f"... and {more} more lost", file=out)
        for access in summary.accesses[:_PRINTED]:
            print(f"{access.time:.9g}: {access}", file=out)
        if (more := summary.access_count - _PRINTED) > 0:
            print(f"... and {more} more accesses; --json prints all of them", file=out)
        print(summary, file=out)
    if not summary.frames.frames:
        raise Failed(_nothing(summary.first_lost))
    if 100 * summary.error_rate > chosen.max_errors:
        said = f"{summary.error_rate:.0%} of the cycles have no valid frame"
        raise Failed(f"{said}; check the order code and the channels (--max-errors is {chosen.max_errors:g})")


def _nothing(lost: Any) -> str:
    """Return the message for a capture without a frame."""
    first: Lost | None = next(iter(lost), None)
    said = f": {first.reason}" if first else ""
    return f"the capture contains no frame{said}; check the channels (--clock, --data) and the order code"
