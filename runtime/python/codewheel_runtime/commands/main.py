# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command line of a package: decodes frames, files and captures, draws plots, and shows an encoder live."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from ..encoder import Encoder
from .common import (
    DONE,
    FAILED,
    INTERRUPTED,
    USAGE,
    CommandFailed,
    distribution,
    find_encoder,
    missing_package_error,
    show_progress,
)
from .one_frame import parse_frame, print_frame
from .options import add_capture, add_encoder, add_input, add_output, add_record, count, seconds

if TYPE_CHECKING:
    from ..files.stream import Summary

_EPILOG: Final = """\
input formats (by the extension of FILE, or --read):
  binary   frames one after another. RS-485: their bytes. SSI and BiSS: as few
           bytes as possible per frame, most significant first, padded with 0
           in front. With --words little or big, eight bytes per frame. With
           --words little32 or big32, four bytes per frame
  csv      a column of 0x... or 0b... numbers, or of plain numbers with
           --digits. RS-485: hex bytes. Columns are separated by commas,
           semicolons or tabs. Lines that start with # are skipped
  parquet  a column of integers, of bytes, or of text as in CSV

The output has one row per frame, in order. Its columns are the other columns
of FILE, the fields, 'verdict' (usability of the position) and 'fault': none,
length, crc, constant or range. The position is empty if it is not usable or
the frame has an error. The other fields of a frame with an error have no
meaning. An empty or truncated cell becomes a row with a length error, whose
flags are empty.

exit codes:
  0    success
  1    a file cannot be read or written, FILE does not contain such frames, more
       frames have an error than --max-errors allows, or the frame has an error
  2    incorrect usage, or an unknown order code
  3    the frame is valid, but its position is not usable
  130  interrupted
With too many errors (--max-errors) the output is still written. With any
other nonzero exit code, no file is written and an existing file is unchanged.
"""


_BENCH_EPILOG: Final = """\
captures: sigrok sessions (.sr) and CSV, Saleae CSV and binary files (the clock
and the data line, in this order), the bytes that Saleae's serial analyzer
exports, VCD, NumPy files (.npy, .npz), and tables of 0 and 1 or of voltages.
They are recognized by their contents.

channels: SSI and BiSS need a clock (MA, --clock) and a data line (SLO, --data).
RS-485 needs one line (--data). A channel is chosen by its name or by its number
from 1. Usual names are found without an option.

--biss describes an encoder without a package, in the order of transmission:
  --biss position=32,error,warning,crc=6:0x43
  --biss multiturn=12,singleturn=24,error,warning,crc=6:0x43
  --biss singleturn=32,error,warning,crc=6:0x43
Degrees and speeds need singleturn, the counts of one turn.
error and warning are active at level 0. zero=2 are bits that are always 0, and
unused=2 bits without meaning.

exit codes:
  0    success
  1    a file cannot be read or written, or is not a capture, it contains no
       frame, or more cycles have an error or no frame than --max-errors allows
  2    incorrect usage, or an unknown order code
  130  interrupted
"""


_RECORD_EPILOG: Final = """\
The table has one row per reading: 'time' in seconds, 'position' in counts
(empty if it is not usable), 'verdict', 'reports' (active alarms), and 'error',
such as 'no reply'. Requests are not repeated, so every error is a row. Without
-o, the table is written to standard output if that is not a terminal.

exit codes:
  0    success
  1    the port cannot be opened, the encoder never answers, the file cannot be
       written, or more readings failed than --max-errors allows
  2    incorrect usage, or an unknown order code
With too many errors (--max-errors), the table is still written. Ctrl-C ends it.
"""


def main(package: str, arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        package: Name of the manufacturer's package, such as ``my_encoders``.
        arguments: Command-line arguments. Defaults to the arguments of the process.

    Returns:
        The exit code.
    """
    try:
        options = _make_parser(package).parse_args(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        code: int = options.run(package, options) or DONE
    except CommandFailed as failure:
        return _print_failure(package, failure, failure.code)
    except KeyboardInterrupt:
        return _print_failure(package, "interrupted; no file was written", INTERRUPTED)
    except BrokenPipeError:
        # The reader has closed the pipe. Without this, Python would report the error again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    return code


def _print_failure(package: str, message: object, code: int) -> int:
    """Print a message to standard error, and return the exit code."""
    print(f"{distribution(package)}: {message}", file=sys.stderr)
    return code


def _make_parser(package: str) -> argparse.ArgumentParser:
    """Return the command-line parser."""

    def formatter(prog: str) -> argparse.RawDescriptionHelpFormatter:
        return argparse.RawDescriptionHelpFormatter(prog, width=80)

    main_parser = argparse.ArgumentParser(prog=distribution(package), formatter_class=formatter, allow_abbrev=False)
    main_parser.description = "Decode frames and captures of absolute encoders, given the order code on the label."
    main_parser.add_argument(
        "--version", action="version", version=f"{distribution(package)} {import_module(package).__version__}"
    )
    commands = main_parser.add_subparsers(metavar="COMMAND", required=True)

    def add_command(
        name: str, run: Callable[..., int | None], summary: str, description: str = "", epilog: str = ""
    ) -> Any:
        """Add a command and its summary, and return its parser.

        ``run`` carries out the command. ``main`` finds it as ``run`` in the parsed arguments. ``run`` takes the name of
        the package and these arguments, and can return an exit code.
        """
        description = description or f"{summary[0].upper()}{summary[1:]}."
        parser = commands.add_parser(
            name, help=summary, description=description, epilog=epilog, formatter_class=formatter, allow_abbrev=False
        )
        parser.set_defaults(run=run)
        return parser

    _add_decode_command(add_command)
    _add_monitor_command(add_command)
    capture_summary = "decode a capture of a logic analyzer into a file of columns"
    plot_summary = "plot position and speed over time, of a capture or of frames with a time"
    _add_capture_command(add_command, "capture", capture_summary)
    _add_capture_command(add_command, "plot", plot_summary)
    return main_parser


def _add_decode_command(add_command: Callable[..., Any]) -> None:
    """Add the command ``decode``. ``add_command`` adds a command, and returns the parser for its arguments."""
    parser = add_command(
        "decode",
        _decode,
        "decode a frame, or a file of frames into a file of columns",
        description="Decode a frame, or a file of frames into a file of columns, in bounded memory.",
        epilog=_EPILOG,
    )
    parser.add_argument("order_code", metavar="ORDER-CODE", help="the code on the label")
    parser.add_argument(
        "file",
        metavar="FILE",
        nargs="+",
        help="file of frames, - for standard input, or a frame: hex bytes or a number",
    )
    add_output(parser)
    add_input(parser)
    add_encoder(parser)


def _add_monitor_command(add_command: Callable[..., Any]) -> None:
    """Add the command ``monitor``. ``add_command`` adds a command, and returns the parser for its arguments."""
    parser = add_command(
        "monitor",
        _monitor,
        "show an encoder live, over RS-485, and record it",
        description="Read an encoder over RS-485, and show its position, speed and state live, or write a table.",
        epilog=_RECORD_EPILOG,
    )
    parser.add_argument("order_code", metavar="ORDER-CODE", help="the code on the label")
    parser.add_argument("port", metavar="PORT", help="serial port, such as /dev/ttyUSB0, COM3 or socket://HOST:PORT")
    parser.add_argument("--count", type=count, metavar="COUNT", help="stop after this many readings")
    parser.add_argument("--interval", type=seconds, default=0.0, metavar="SECONDS", help="time between two readings")
    add_record(parser)
    add_encoder(parser)


def _add_capture_command(add_command: Callable[..., Any], name: str, summary: str) -> None:
    """Add the command ``capture`` or ``plot``, which have the same arguments.

    ``add_command`` adds a command, and returns the parser for its arguments. ``summary`` is the help text of the
    command.
    """
    parser = add_command(name, partial(_run_bench_command, name), summary, epilog=_BENCH_EPILOG)
    parser.add_argument(
        "files",
        metavar="[ORDER-CODE] FILE",
        nargs="+",
        help="the code on the label, unless --biss is given; capture",
    )
    add_capture(parser)
    add_output(parser, plot=name == "plot")
    add_encoder(parser)


def _monitor(package: str, options: argparse.Namespace) -> None:
    """Show an encoder live. This needs no packages other than pyserial."""
    from .monitor import monitor

    monitor(package, options)


def _run_bench_command(name: str, package: str, options: argparse.Namespace) -> int | None:
    """Run the command ``capture`` or ``plot``. Both need NumPy."""
    try:
        from . import bench
    except ImportError as error:
        raise missing_package_error(error) from None
    run: Callable[[str, argparse.Namespace], int | None] = getattr(bench, name)
    return run(package, options)


def _decode(package: str, options: argparse.Namespace) -> int | None:
    """Decode the frame in the arguments and print it, or decode a file. Return the exit code.

    An argument is a frame if it looks like a frame and there is no file of this name.

    Raises:
        CommandFailed: The frame is empty, or its digits could be bits or hexadecimal digits.
    """
    encoder = find_encoder(package, options)
    if not any(argument.strip() for argument in options.file):
        raise CommandFailed("the frame is empty", USAGE)
    if options.file != ["-"] and not os.path.exists(options.file[0]):
        frame = parse_frame(" ".join(options.file), encoder)
        if frame is not None and options.si:
            raise CommandFailed("--si needs a file with a column 'time': one frame has no speed", USAGE)
        if frame is not None:
            return print_frame(encoder, frame, options)
    if len(options.file) > 1:
        arguments_text = " ".join(options.file)
        raise CommandFailed(f"expected one file or one frame, got {arguments_text[:60]!r}", USAGE)
    options.file = options.file[0]
    _decode_file(package, encoder, options)
    return DONE


def _decode_file(package: str, encoder: Encoder, options: argparse.Namespace) -> None:
    """Decode a file into a file of columns."""
    try:
        from ..files.stream import Files
    except ImportError as error:
        raise missing_package_error(error) from None
    with show_progress(package, options.file) as progress:
        summary = Files(package).decode_file(
            encoder,
            options.file,
            options.output,
            layout=options.layout,
            to=options.write,
            kind=options.read,
            words=options.words,
            column=options.column,
            digits=options.digits,
            cut=options.cut,
            si=options.si,
            columns=options.columns,
            limit=options.limit,
            raw=options.raw,
            force=options.force,
            answers=dict(options.choose),
            progress=progress,
        )
    _print_summary(summary, options)


def _print_summary(summary: Summary, options: argparse.Namespace) -> None:
    """Print the summary, to standard error if the table goes to standard output.

    Raises CommandFailed if more than ``--max-errors`` percent of the frames have an error.
    """
    out = sys.stderr if options.output == "-" else sys.stdout
    summary_text = json.dumps(summary.to_dict()) if options.json else str(summary)
    print(summary_text, file=out)
    if 100 * summary.error_rate > options.max_errors:
        raise CommandFailed(
            f"{summary.error_rate:.0%} of the frames have an error; --max-errors is {options.max_errors:g}"
        )
