# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command line of a package: ``python -m PACKAGE decode ORDER-CODE frames.bin -o out.parquet``."""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import sys
from collections.abc import Callable, Sequence
from enum import Enum
from importlib import import_module
from time import monotonic
from types import FrameType
from typing import TYPE_CHECKING, Final, NoReturn, TextIO

from .encoder import Encoder
from .order_codes import OrderCodeError
from .reports import Interface

if TYPE_CHECKING:
    from .stream import Summary

DONE, FAILED, USAGE, INTERRUPTED = 0, 1, 2, 130
#: Default limit for the percentage of frames with an error. A higher percentage suggests wrong settings or wiring.
DEFAULT_MAX_ERRORS: Final = 10.0
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
meaning. An empty or truncated cell becomes a row with a length error.

exit codes:
  0    success
  1    a file cannot be read or written, FILE does not contain such frames, or
       more frames have an error than --max-errors allows
  2    wrong usage, or an unknown order code
  130  interrupted
With too many errors (--max-errors) the output is still written. With any
other nonzero exit code, no output is written and an existing file is unchanged.
"""


class _Failed(Exception):
    """The command ends with this message and this exit code."""

    def __init__(self, message: object, code: int = FAILED) -> None:
        super().__init__(str(message))
        self.code = code


def main(package: str, arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        package: Name of the manufacturer's package, such as ``lika_encoders``.
        arguments: Command-line arguments. Defaults to the arguments of the process.

    Returns:
        The exit code.
    """
    try:
        chosen = _parser(package).parse_args(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        _decode(package, chosen)
    except _Failed as failure:
        return _told(package, failure, failure.code)
    except KeyboardInterrupt:
        return _told(package, "interrupted; no file was written", INTERRUPTED)
    except BrokenPipeError:
        # The reader has closed the pipe. Without this, Python would report the error again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    return DONE


def _told(package: str, message: object, code: int) -> int:
    print(f"python -m {package}: {message}", file=sys.stderr)
    return code


def _parser(package: str) -> argparse.ArgumentParser:
    def shaped(prog: str) -> argparse.RawDescriptionHelpFormatter:
        return argparse.RawDescriptionHelpFormatter(prog, width=80)

    top = argparse.ArgumentParser(prog=f"python -m {package}", formatter_class=shaped, allow_abbrev=False)
    top.description = "Decode frames of absolute encoders, given the order code on the label."
    top.add_argument(
        "--version", action="version", version=f"{_distribution(package)} {import_module(package).__version__}"
    )
    commands = top.add_subparsers(metavar="COMMAND", required=True)
    parser = commands.add_parser(
        "decode",
        help="decode a file of frames into a file of columns",
        description="Decode a file of frames into a file of columns, in bounded memory.",
        epilog=_EPILOG,
        formatter_class=shaped,
        allow_abbrev=False,
    )
    parser.add_argument("order_code", metavar="ORDER-CODE", help="the code on the label")
    parser.add_argument("file", metavar="FILE", help="file of frames, or - for standard input")
    _add_output(parser)
    _add_input(parser)
    _add_encoder(parser)
    return top


def _add_output(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument_group("output").add_argument
    add("-o", "--output", default="-", metavar="FILE", help="output file (default: CSV on standard output)")
    add("--write", choices=("parquet", "arrow", "csv"), help="output format (default: by extension, else csv)")
    add("--columns", type=_names, default=(), metavar="NAME,...", help="columns to write, also of FILE (default: all)")
    add("--raw", action="store_true", help="write the position of every frame, even if it is not usable")
    add(
        "--max-errors",
        type=_percent,
        default=DEFAULT_MAX_ERRORS,
        metavar="PERCENT",
        help="exit with 1 if more frames than this have an error (default: %(default)g)",
    )
    add("--limit", type=_count, metavar="COUNT", help="decode at most this many frames")
    add("--force", action="store_true", help="replace an existing file")


def _add_input(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument_group("input").add_argument
    add("--read", choices=("binary", "csv", "parquet"), help="input format (default: by extension, else binary)")
    words = ("packed", "little", "big", "little32", "big32")
    add("--words", choices=words, default="packed", metavar="FORM", help=f"form of binary frames: {', '.join(words)}")
    add("--column", default="", metavar="NAME", help="column with the frames, in CSV also its number from 1")
    add("--digits", choices=("hex", "decimal"), help="base of numbers in text without 0x")
    add("--cut", action="store_true", help="ignore an incomplete frame at the end")


def _add_encoder(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument_group("encoder").add_argument
    interfaces = [item.value for item in Interface]
    add("--interface", choices=interfaces, help="reject an order code with another interface")
    add("--layout", default="", metavar="NAME", help="kind of the frames, if the encoder sends several")
    add(
        "--register",
        action="append",
        type=_register,
        default=[],
        metavar="ADDRESS=BYTE",
        help="register byte that affects frames, such as 0x56=0x10 (else the factory default); repeatable",
    )
    add(
        "--choose",
        action="append",
        type=_answer,
        default=[],
        metavar="NAME=ANSWER",
        help="answer to a question that the manual leaves open; repeatable",
    )


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(","))


def _number(text: str) -> int:
    # Longer numbers are out of range anyway, and Python refuses to parse very long ones.
    if len(text) > 20 or not text.isascii():
        raise ValueError
    return int(text, 0)


def _count(text: str) -> int:
    if (count := _number(text)) < 0:
        raise ValueError
    return count


def _percent(text: str) -> float:
    if not 0 <= (number := float(text)) <= 100:
        raise ValueError
    return number


def _register(text: str) -> tuple[int, int]:
    address, _, value = text.partition("=")
    return _number(address), _number(value)


def _answer(text: str) -> tuple[str, Enum | str]:
    name, between, answer = text.partition("=")
    if not between:
        raise ValueError
    return name.strip(), answer.strip()


# argparse prints these names in its messages.
for _kind, _name in ((_count, "count"), (_percent, "percent"), (_register, "ADDRESS=BYTE"), (_answer, "NAME=ANSWER")):
    _kind.__name__ = _name


def _distribution(package: str) -> str:
    """Return the name by which a package is installed."""
    return package.replace("_", "-")


def _encoder_of(package: str, chosen: argparse.Namespace) -> Encoder:
    """Return the encoder that the arguments select. Raises ValueError if there is none."""
    encoder: Encoder = import_module(package).lookup(str(chosen.order_code))
    if chosen.interface is not None and encoder.interface.value != chosen.interface:
        wanted = Interface(chosen.interface).title
        raise ValueError(f"{encoder.code} has the interface {encoder.interface.title}, not {wanted}")
    if chosen.register:
        with_registers: Callable[[dict[int, int]], Encoder] | None = getattr(encoder, "with_registers", None)
        if with_registers is None:
            raise ValueError(f"no register affects the frames of {encoder.code}")
        encoder = with_registers(dict(chosen.register))
    return encoder


def _decode(package: str, chosen: argparse.Namespace) -> None:
    try:
        encoder = _encoder_of(package, chosen)
    except (OrderCodeError, ValueError) as error:
        raise _Failed(error, USAGE) from None
    try:
        from .stream import Files, InputError, UsageError
    except ImportError as error:
        raise _missing(package, error) from None
    progress = Progress(sys.stderr)
    try:
        with _Stoppable():
            summary = Files(package).decode_file(
                encoder,
                chosen.file,
                chosen.output,
                layout=chosen.layout,
                to=chosen.write,
                kind=chosen.read,
                words=chosen.words,
                column=chosen.column,
                digits=chosen.digits,
                cut=chosen.cut,
                columns=chosen.columns,
                limit=chosen.limit,
                raw=chosen.raw,
                force=chosen.force,
                answers=dict(chosen.choose),
                progress=progress.show if sys.stderr.isatty() else None,
            )
    except BrokenPipeError:
        raise
    except UsageError as error:
        raise _Failed(error, USAGE) from None
    except ImportError as error:
        raise _missing(package, error) from None
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        raise _Failed(f"{where}{error.strerror or error}") from None
    except MemoryError:
        raise _Failed("not enough memory") from None
    except InputError as error:
        raise _Failed(error) from None
    finally:
        progress.clear()
    _report(summary, chosen.output, chosen.max_errors)


def _report(summary: Summary, output: str, max_errors: float) -> None:
    """Print the summary, to standard error if the table goes to standard output."""
    print(summary, file=sys.stderr if output == "-" else sys.stdout)
    if 100 * summary.error_rate > max_errors:
        raise _Failed(f"{summary.error_rate:.0%} of the frames have an error; --max-errors is {max_errors:g}")


def _missing(package: str, error: ImportError) -> _Failed:
    return _Failed(f"this needs {error.name or error}: pip install '{_distribution(package)}[parquet]'")


class _Stoppable:
    """Context that treats SIGTERM like a keyboard interrupt, so that no incomplete file remains."""

    def __enter__(self) -> None:
        self._before = signal.getsignal(signal.SIGTERM)
        signal.signal(signal.SIGTERM, self._stop)

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGTERM, self._before)

    @staticmethod
    def _stop(number: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt


class Progress:
    """Progress bar on the last line of a terminal."""

    #: Highest number of updates per second.
    RATE: Final = 10

    def __init__(self, out: TextIO) -> None:
        self._out, self._started, self._shown = out, monotonic(), 0.0

    def show(self, done: int, total: int | None, frames: int) -> None:
        """Show the progress."""
        now = monotonic()
        if now - self._shown < 1 / self.RATE:
            return
        self._shown = now
        text = f"{frames:,} frames, {now - self._started:.0f} s"
        if total:
            part = min(done / total, 1.0)
            filled = round(30 * part)
            text = f"[{'#' * filled}{' ' * (30 - filled)}] {part:4.0%} {text}"
        columns = shutil.get_terminal_size().columns
        self._out.write(f"\r{text[: columns - 1]:<{columns - 1}}")
        self._out.flush()

    def clear(self) -> None:
        """Clear the line if anything was shown."""
        if self._shown:
            self._out.write(f"\r{' ' * (shutil.get_terminal_size().columns - 1)}\r")
            self._out.flush()
