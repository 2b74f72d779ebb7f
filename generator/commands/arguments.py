"""Arguments of the command line: help with examples, and errors that suggest a correction."""

from __future__ import annotations

import argparse
import math
import textwrap
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from .. import __version__
from .terminal import Stop

_WIDTH = 79
#: Examples by command, using the spec that ``new`` writes.
EXAMPLES = {
    "generate": (
        "codewheel generate",
        "codewheel generate my_encoder.yaml -o out --target c",
        "codewheel generate --check",
    ),
    "check": ("codewheel check my_encoder.yaml", "codewheel check .", "codewheel check --json"),
    "list": ("codewheel list", "codewheel list my_encoder.yaml"),
    "show": ("codewheel show my_encoder", "codewheel show MY-ENCODER-13-SC"),
    "decode": (
        "codewheel decode MY-ENCODER-13-SC 0b0001111101000_1_1_011010",
        'codewheel decode MY-ENCODER-13-SC --as preset "00 00 03 E8"',
    ),
    "master": ("codewheel master", "codewheel master MY-ENCODER-13-SC"),
    "simulate": (
        "codewheel simulate MY-ENCODER-13-SC --position 1000",
        "codewheel simulate MY-ENCODER-13-SC --position sine:0.5Hz --fault flip:1e-3",
    ),
    "diff": (
        "codewheel diff old/my_encoder.yaml my_encoder.yaml",
        "codewheel diff old/my_encoder.yaml my_encoder.yaml --fail-on behaviour",
    ),
    "reread": ("codewheel reread manual-1.0.txt manual-1.1.txt --family my_encoder",),
    "facts": ("codewheel facts my_encoder --section 6.2", "codewheel facts my_encoder --section 1 --json"),
    "explain": ("codewheel explain", "codewheel explain register-gone"),
    "new": ("codewheel new my_encoder", "codewheel new my_encoder -o specs/my_encoder.yaml"),
    "migrate": ("codewheel migrate my_encoder.yaml", "codewheel migrate --check my_encoder.yaml"),
}


#: Forms of the output of check and diff.
FORMATS = ("text", "json", "github", "sarif")
FORMATS_HELP = "text, json, github for comments in a pull request, or sarif (version 2.1.0) for review tools"


class Parser(argparse.ArgumentParser):
    """A parser that suggests the nearest choice.

    ``more_help`` returns text for the end of the help. It is called only when help is shown.
    """

    more_help: Callable[[], str] | None = None

    def __init__(self, **options: Any) -> None:
        # Each argument is formatted when it is added. The terminal is asked for its width only to show the help.
        super().__init__(formatter_class=partial(argparse.HelpFormatter, width=_WIDTH), **options)

    def format_help(self) -> str:
        return super().format_help() + (f"\n{self.more_help()}\n" if self.more_help is not None else "")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            from ..language.problems import suggestion

            kind = "command" if isinstance(action, argparse._SubParsersAction) else "choice"
            choices = list(map(str, action.choices))
            hint = suggestion(str(value), choices) or f"; known: {', '.join(choices)}"
            raise argparse.ArgumentError(None, f"there is no {kind} '{value}'{hint}")


class ShowVersion(argparse.Action):
    """The action of ``--version``."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(f"codewheel {__version__}")
        parser.exit()


def a_path(text: str) -> Path:
    """Return the path, but reject empty text, such as from an unset variable."""
    if not text:
        raise argparse.ArgumentTypeError("the path is empty; write . for this folder")
    return Path(text)


def metres(text: str) -> int:
    """Return a cable length in metres, rounded up."""
    try:
        length = math.ceil(float(text))
    except (ValueError, OverflowError):
        length = 0
    if not 0 < length <= 100_000:
        raise argparse.ArgumentTypeError(f"'{text}' is not a length in metres, such as 30")
    return length


def held_bytes(pairs: Sequence[str]) -> dict[int, int]:
    """Return pairs such as ``0x56=0x10`` as bytes by address.

    Raises:
        Stop: A pair is malformed. The exit code is 2.
    """
    register_bytes = {}
    for pair in pairs:
        address, equals, value = pair.partition("=")
        try:
            register_bytes[int(address, 0)] = int(value, 0)
        except ValueError:
            raise Stop(f"'{pair}' is not a register and a byte; write it like 0x56=0x10", 2) from None
        if not equals or not 0 <= int(value, 0) <= 255:
            raise Stop(f"'{pair}' is not a register and a byte; write it like 0x56=0x10", 2)
    return register_bytes


def parse(parser: argparse.ArgumentParser, arguments: Sequence[str] | None) -> argparse.Namespace:
    """Parse the arguments. An extra one is an error that shows the usage of its command."""
    chosen, extra = parser.parse_known_args(arguments)
    if extra:
        chosen.parser.error(_left_over(chosen.parser, extra[0]))
    return chosen


def _left_over(parser: argparse.ArgumentParser, text: str) -> str:
    from ..language.problems import suggestion

    options = sorted(name for action in parser._actions for name in action.option_strings)
    if text.startswith("-"):
        return f"there is no option '{text}'{suggestion(text.partition('=')[0], options)}"
    if "--specs" in options and (Path(text).suffix in (".yaml", ".yml") or Path(text).exists()):
        return f"unexpected argument '{text}'; give a spec as --specs {text}"
    return f"unexpected argument '{text}'"


def complete(parser: Parser, name: str) -> None:
    """Add the examples to the help of a command, and the parser to its arguments."""
    parser.set_defaults(parser=parser)
    of_what = "" if name in ("new", "explain") else ", with the spec that codewheel new my_encoder writes"
    lines = [f"examples{of_what}:", *(f"  {line}" for line in EXAMPLES[name])]
    text = [textwrap.fill(parser.epilog, _WIDTH), ""] if parser.epilog else []
    parser.epilog = "\n".join([*text, *lines])
    parser.description = textwrap.fill(parser.description or "", _WIDTH)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter


def add_cache_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that every command with a cache has."""
    parser.add_argument("--no-cache", action="store_true", help="neither use nor store results of earlier runs")
