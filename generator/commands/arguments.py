"""Arguments of the command line: help with examples, and errors that say what would be right."""

from __future__ import annotations

import argparse
import math
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..language.problems import suggestion
from .terminal import Stop

_WIDTH = 79
#: What one can type, by command, on the spec that ``new`` writes.
EXAMPLES = {
    "generate": (
        "codewheel generate",
        "codewheel generate my_encoder.yaml -o out --target c",
        "codewheel generate --check",
    ),
    "check": ("codewheel check my_encoder.yaml", "codewheel check .", "codewheel check --json"),
    "list": ("codewheel list", "codewheel list --specs my_encoder.yaml"),
    "show": ("codewheel show my_encoder", "codewheel show MY-ENCODER-13-SC"),
    "decode": (
        "codewheel decode MY-ENCODER-13-SC 0b0001111101000_1_1_011010",
        'codewheel decode MY-ENCODER-13-SC --as preset "00 00 03 E8"',
    ),
    "master": ("codewheel master", "codewheel master MY-ENCODER-13-SC"),
    "diff": (
        "codewheel diff old/my_encoder.yaml my_encoder.yaml",
        "codewheel diff old/my_encoder.yaml my_encoder.yaml --fail-on behaviour",
    ),
    "explain": ("codewheel explain", "codewheel explain register-gone"),
    "new": ("codewheel new my_encoder", "codewheel new my_encoder -o specs/my_encoder.yaml"),
}


class Parser(argparse.ArgumentParser):
    """A parser that suggests the nearest choice.

    ``more_help`` gives text for the end of the help, and is called only when help is shown.
    """

    more_help: Callable[[], str] | None = None

    def format_help(self) -> str:
        return super().format_help() + (f"\n{self.more_help()}\n" if self.more_help is not None else "")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            kind = "command" if isinstance(action, argparse._SubParsersAction) else "choice"
            choices = list(map(str, action.choices))
            near = suggestion(str(value), choices) or f"; known: {', '.join(choices)}"
            raise argparse.ArgumentError(None, f"there is no {kind} '{value}'{near}")


class ShowVersion(argparse.Action):
    """``--version``; the version is looked up only when it is asked for."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"codewheel {version('codewheel')}")
        parser.exit()


def a_path(text: str) -> Path:
    """A path as an argument; empty text, such as of a variable that is not set, is none."""
    if not text:
        raise argparse.ArgumentTypeError("the path is empty; write . for this folder")
    return Path(text)


def metres(text: str) -> int:
    """A length of cable: a whole number of metres, or what is rounded up to one."""
    try:
        length = math.ceil(float(text))
    except (ValueError, OverflowError):
        length = 0
    if not 0 < length <= 100_000:
        raise argparse.ArgumentTypeError(f"'{text}' is no length in metres, such as 30")
    return length


def held_bytes(pairs: Sequence[str]) -> dict[int, int]:
    """``0x56=0x10`` and the like as bytes by address.

    Raises:
        Stop: A pair is none; exit code 2.
    """
    held = {}
    for pair in pairs:
        address, equals, value = pair.partition("=")
        try:
            held[int(address, 0)] = int(value, 0)
        except ValueError:
            raise Stop(f"'{pair}' is no register and byte; write them as in 0x56=0x10", 2) from None
        if not equals or not 0 <= int(value, 0) <= 255:
            raise Stop(f"'{pair}' is no register and byte; write them as in 0x56=0x10", 2)
    return held


def parse(parser: argparse.ArgumentParser, arguments: Sequence[str] | None) -> argparse.Namespace:
    """The arguments; what is left over is an error of the command, whose usage is shown."""
    chosen, extra = parser.parse_known_args(arguments)
    if extra:
        chosen.parser.error(_left_over(chosen.parser, extra[0]))
    return chosen


def _left_over(parser: argparse.ArgumentParser, text: str) -> str:
    options = sorted(name for action in parser._actions for name in action.option_strings)
    if text.startswith("-"):
        return f"there is no option '{text}'{suggestion(text.partition('=')[0], options)}"
    if "--specs" in options and (Path(text).suffix in (".yaml", ".yml") or Path(text).exists()):
        return f"'{text}' is one argument too many; a spec is given as: --specs {text}"
    return f"'{text}' is one argument too many"


def add_examples(commands: argparse._SubParsersAction[Parser]) -> None:
    """Put the examples under the help of each command, and let each know its own parser."""
    for name, parser in commands.choices.items():
        parser.set_defaults(parser=parser)
        of_what = "" if name in ("new", "explain") else ", where my_encoder is what codewheel new my_encoder writes"
        lines = [f"examples{of_what}:", *(f"  {line}" for line in EXAMPLES[name])]
        text = [textwrap.fill(parser.epilog, _WIDTH), ""] if parser.epilog else []
        parser.epilog = "\n".join([*text, *lines])
        parser.description = textwrap.fill(parser.description or "", _WIDTH)
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
