# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Options of the commands."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from enum import Enum
from typing import Final

from ..reports import Interface

#: Default limit for the percentage of frames with an error. A higher percentage suggests wrong settings or wiring.
DEFAULT_MAX_ERRORS: Final = 10.0
#: Maximum number of characters in a number, which is enough for 64 bits.
_LONGEST_NUMBER: Final = 20


def add_capture(parser: argparse.ArgumentParser) -> None:
    """Add the command-line options for captures."""
    add_option = parser.add_argument_group("capture").add_argument
    add_option("--biss", metavar="FIELDS", help="layout of BiSS frames of an encoder without a package")
    add_option("--clock", default="", metavar="CHANNEL", help="channel of the clock, MA")
    add_option("--data", default="", metavar="CHANNEL", help="channel of the data line, SLO, or of the serial line")
    add_option(
        "--rate", type=_parse_rate, metavar="RATE", help="sample rate such as 24MHz, if FILE does not contain it"
    )
    add_option(
        "--rest",
        type=seconds,
        metavar="SECONDS",
        help="shortest rest of the clock between cycles (default: 1.4 periods)",
    )
    add_option("--baud", type=_parse_rate, metavar="BAUD", help="baud rate, if it differs from the manual")
    add_option(
        "--threshold",
        type=float,
        metavar="VOLTS",
        help="voltage above which a level is 1, for an oscilloscope's table (default: the middle of the range)",
    )


def add_output(parser: argparse.ArgumentParser, plot: bool = False) -> None:
    """Add the options for the file to write."""
    add_option = parser.add_argument_group("output").add_argument
    if plot:
        add_option("-o", "--output", required=True, metavar="FILE", help="picture to write: .png, .svg or .pdf")
        add_option("--force", action="store_true", help="replace an existing file")
        _add_digits(add_option)
        return
    add_option("-o", "--output", default="-", metavar="FILE", help="output file (default: CSV on standard output)")
    add_option("--json", action="store_true", help="print a frame, or the summary, as JSON")
    add_option(
        "--si", action="store_true", help="also write position and speed in SI units (a file needs a column 'time')"
    )
    add_option("--write", choices=("parquet", "arrow", "csv"), help="output format (default: by extension, else csv)")
    add_option(
        "--columns",
        type=_parse_names,
        default=(),
        metavar="NAME,...",
        help="columns to write, also of FILE (default: all)",
    )
    add_option("--raw", action="store_true", help="write the position of every frame, even if it is not usable")
    _add_max_errors(add_option, "frames have an error")
    add_option("--limit", type=count, metavar="COUNT", help="decode at most this many frames")
    add_option("--force", action="store_true", help="replace an existing file")


def add_record(parser: argparse.ArgumentParser) -> None:
    """Add the options for the file of live readings."""
    add_option = parser.add_argument_group("output").add_argument
    add_option("-o", "--output", default="", metavar="FILE", help="table to write, or - for standard output")
    add_option("--write", choices=("csv", "jsonl", "parquet"), help="output format (default: by extension, else csv)")
    _add_max_errors(add_option, "readings failed")
    add_option("--force", action="store_true", help="replace an existing file")


def add_input(parser: argparse.ArgumentParser) -> None:
    """Add the options for the file of frames."""
    add_option = parser.add_argument_group("input").add_argument
    add_option("--read", choices=("binary", "csv", "parquet"), help="input format (default: by extension, else binary)")
    words = ("packed", "little", "big", "little32", "big32")
    add_option(
        "--words", choices=words, default="packed", metavar="FORM", help=f"form of binary frames: {', '.join(words)}"
    )
    add_option("--column", default="", metavar="NAME", help="column with the frames, in CSV also its number from 1")
    _add_digits(add_option)
    add_option("--cut", action="store_true", help="ignore an incomplete frame at the end")


def _add_max_errors(add_option: Callable[..., object], failure: str) -> None:
    """Add the option ``--max-errors``.

    ``failure`` describes what is counted, for the help: ``frames have an error``.
    """
    add_option(
        "--max-errors",
        type=_parse_percent,
        default=DEFAULT_MAX_ERRORS,
        metavar="PERCENT",
        help=f"exit with 1 if more than this share of the {failure} (default: %(default)g)",
    )


def _add_digits(add_option: Callable[..., object]) -> None:
    """Add the option ``--digits``."""
    add_option("--digits", choices=("hex", "decimal"), help="base of numbers in text without 0x")


def add_encoder(parser: argparse.ArgumentParser) -> None:
    """Add the options that select the encoder and its frames."""
    add_option = parser.add_argument_group("encoder").add_argument
    interfaces = [interface.value for interface in Interface]
    add_option("--interface", choices=interfaces, help="reject an order code with another interface")
    add_option("--layout", default="", metavar="NAME", help="kind of the frames, if the encoder sends several")
    add_option(
        "--register",
        action="append",
        type=_parse_register,
        default=[],
        metavar="ADDRESS=BYTE",
        help="register byte that affects frames, such as 0x56=0x10 (else the factory default); repeatable",
    )
    add_option(
        "--choose",
        action="append",
        type=_parse_answer,
        default=[],
        metavar="NAME=ANSWER",
        help="answer to a question about frames that the manual leaves open. Without it, the command lists the answers "
        "if a frame needs one; repeatable",
    )


# The functions below parse the text of an option. They raise ValueError for a wrong text, which argparse reports.


def _parse_names(text: str) -> tuple[str, ...]:
    """Return the names in a list separated by commas: ``("time", "position")`` for ``time,position``."""
    return tuple(name.strip() for name in text.split(","))


def _parse_number(text: str) -> int:
    """Return the number in the text of an option, which is decimal or has a prefix such as 0x."""
    # Longer numbers are out of range anyway, and Python rejects very long ones.
    if len(text) > _LONGEST_NUMBER or not text.isascii():
        raise ValueError
    return int(text, 0)


def count(text: str) -> int:
    """Return a nonnegative number of frames or readings."""
    number = _parse_number(text)
    if number < 0:
        raise ValueError
    return number


def _parse_percent(text: str) -> float:
    """Return a percentage, from 0 to 100."""
    number = float(text)
    if not 0 <= number <= 100:
        raise ValueError
    return number


def _parse_register(text: str) -> tuple[int, int]:
    """Return the address and the byte in ``ADDRESS=BYTE``: ``(0x56, 0x10)`` for ``0x56=0x10``."""
    address, _, value = text.partition("=")
    return _parse_number(address), _parse_number(value)


def _parse_answer(text: str) -> tuple[str, Enum | str]:
    """Return the name of a question and its answer: ``("zero_bit", "as_printed")`` for ``zero_bit=as_printed``."""
    name, equals_sign, answer = text.partition("=")
    if not equals_sign:
        raise ValueError
    return name.strip(), answer.strip()


def seconds(text: str) -> float:
    """Return a time in seconds."""
    number = float(text)
    if not 0 <= number < 1e6:
        raise ValueError
    return number


def _parse_rate(text: str) -> float:
    """Return a rate, such as a sample rate, in Hz: 24000000.0 for ``24MHz``."""
    match = _RATE_TEXT.fullmatch(text.strip())
    if match is None:
        raise ValueError
    number, prefix = float(match[1]), match[2]
    if not number:
        raise ValueError
    return number * _FACTOR_BY_PREFIX[prefix]


_FACTOR_BY_PREFIX: Final = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
_RATE_TEXT: Final = re.compile(r"([0-9]{1,12}(?:\.[0-9]{1,9})?) ?([kMG]?)(?:Hz|S/s|Bd)?")

# argparse prints these names in its messages.
for _kind, _name in (
    (count, "count"),
    (_parse_percent, "percent"),
    (seconds, "time in seconds"),
    (_parse_rate, "rate, such as 24MHz"),
    (_parse_register, "ADDRESS=BYTE"),
    (_parse_answer, "NAME=ANSWER"),
):
    _kind.__name__ = _name
