# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command that shows an encoder live, over RS-485."""

from __future__ import annotations

import argparse
import sys
from contextlib import nullcontext

from ..link import LinkError, open_encoder
from ..reports import Interface
from .common import USAGE, Failed, find_encoder, show_progress
from .monitor import watch
from .record import open_recorder


def monitor(package: str, chosen: argparse.Namespace) -> None:
    """Show an encoder live, and record its readings.

    Raises:
        Failed: The encoder has no RS-485, it never answered, or more readings failed than ``--max-errors`` allows.
    """
    encoder = find_encoder(package, chosen)
    if encoder.interface is not Interface.RS485:
        is_spi = encoder.interface is Interface.SPI
        how = "export the words that it finds, and use 'decode'" if is_spi else "use 'capture'"
        problem = f"{encoder.code} has the interface {encoder.interface.title}, and a serial port cannot send its clock"
        raise Failed(f"{problem}: record it with a logic analyser, and {how}", USAGE)
    # On a terminal, readings are shown. In a pipe, they are written as a table.
    target = chosen.output if chosen.output or sys.stdout.isatty() else "-"
    out = sys.stderr if target == "-" else sys.stdout
    try:
        with (
            show_progress(package, chosen.port),
            open_recorder(target, chosen.write, chosen.force) if target else nullcontext() as recorder,
            # Without retries, every error is counted.
            open_encoder(chosen.port, encoder, retries=0) as opened,
        ):
            readings = watch(
                opened,
                encoder,
                chosen.port,
                count=chosen.count,
                interval_s=chosen.interval,
                out=out,
                recorder=recorder,
                is_shown=target != "-",
            )
    except LinkError as error:
        raise Failed(error) from None
    if 100 * readings.failures > chosen.max_errors * readings.total:
        failures_text = f"{readings.failures} of {readings.total} readings failed"
        raise Failed(f"{failures_text}; --max-errors is {chosen.max_errors:g}")
