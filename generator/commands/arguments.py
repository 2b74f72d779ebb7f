"""Arguments of the command line: options that several commands share, help with examples, and errors with a hint."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from .terminal import CommandError

if TYPE_CHECKING:
    from ..cache import Cache

#: Columns of the help.
_HELP_WIDTH = 79
#: Forms of the output of check and diff.
FORMATS = ("text", "json", "github", "sarif")
FORMATS_HELP = "text, json, github for comments in a pull request, or sarif (version 2.1.0) for review tools"
_SPECS_HELP = (
    "spec files or folders. In a folder and its subfolders, all .yaml files with the keys of a spec are read "
    "(default: the specs under [tool.codewheel], or else those in the current folder and its subfolders{})"
)
#: End of the help about specs for commands that also read the packaged specs.
AND_PACKAGED = ", and the packaged specs"


class Parser(argparse.ArgumentParser):
    """A parser that suggests the nearest choice.

    ``more_help`` returns text for the end of the help. It is called only when help is shown.
    """

    more_help: Callable[[], str] | None = None

    def __init__(self, **options: Any) -> None:
        # Each argument is formatted when it is added. A fixed width avoids asking the terminal for its width each time.
        super().__init__(formatter_class=partial(argparse.HelpFormatter, width=_HELP_WIDTH), **options)

    def format_help(self) -> str:
        help_text = super().format_help()
        return f"{help_text}\n{self.more_help()}\n" if self.more_help is not None else help_text

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Raise ``ArgumentError`` if the value is not among the choices.

        The message suggests the nearest choice, or lists all choices.
        """
        if action.choices is not None and value not in action.choices:
            from ..language.problems import suggest_word

            kind = "command" if isinstance(action, argparse._SubParsersAction) else "choice"
            choices = list(map(str, action.choices))
            hint = suggest_word(str(value), choices) or f"; known: {', '.join(choices)}"
            raise argparse.ArgumentError(None, f"there is no {kind} '{value}'{hint}")


class ShowVersion(argparse.Action):
    """The action of ``--version``."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str | None = None) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        print(f"codewheel {__version__}")
        parser.exit()


def parse(parser: argparse.ArgumentParser, words: Sequence[str]) -> argparse.Namespace:
    """Parse the words of a command line. For an unexpected word, print an error and the usage, and end the process."""
    arguments, extra_words = parser.parse_known_args(words)
    if extra_words:
        arguments.parser.error(_unexpected_message(arguments.parser, extra_words[0]))
    return arguments


def _unexpected_message(parser: argparse.ArgumentParser, argument: str) -> str:
    """Return the message about an unexpected argument, which suggests the nearest option, or ``--specs`` for a spec."""
    from ..language.problems import suggest_word

    options = sorted(name for action in parser._actions for name in action.option_strings)
    if argument.startswith("-"):
        option_name, _, _ = argument.partition("=")
        return f"there is no option '{argument}'{suggest_word(option_name, options)}"
    is_spec = Path(argument).suffix in (".yaml", ".yml") or Path(argument).exists()
    if "--specs" in options and is_spec:
        return f"unexpected argument '{argument}'; give a spec as --specs {argument}"
    return f"unexpected argument '{argument}'"


def add_examples(parser: Parser, name: str, examples: Sequence[str]) -> None:
    """Add the examples to the help of the command ``name``, and wrap its description.

    The parser also becomes an attribute of the parsed arguments, for ``parse``.
    """
    parser.set_defaults(parser=parser)
    # These commands read no spec, so their examples work without one.
    needs_spec = name not in ("new", "explain", "find")
    condition = ", with the spec that codewheel new my_encoder writes" if needs_spec else ""
    example_lines = [f"examples{condition}:", *(f"  {example}" for example in examples)]
    epilog_lines = [textwrap.fill(parser.epilog, _HELP_WIDTH), ""] if parser.epilog else []
    parser.epilog = "\n".join([*epilog_lines, *example_lines])
    parser.description = textwrap.fill(parser.description or "", _HELP_WIDTH)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter


# -- arguments and options of several commands


def a_path(text: str) -> Path:
    """Return a text as a path, and reject an empty text, which may come from an unset variable."""
    if not text:
        raise argparse.ArgumentTypeError("the path is empty; write . for this folder")
    return Path(text)


def add_specs(parser: argparse.ArgumentParser, other_specs: str = "") -> None:
    """Add the argument ``SPECS``, and ``--specs`` with the same meaning."""
    add_specs_argument(parser, other_specs)
    parser.add_argument(
        "--specs", dest="more_specs", action="append", type=a_path, default=[], metavar="PATH", help="the same as SPECS"
    )


def add_specs_argument(parser: argparse.ArgumentParser, other_specs: str = "") -> None:
    """Add the argument ``SPECS``. ``other_specs`` is the end of its help."""
    parser.add_argument("specs", nargs="*", type=a_path, metavar="SPECS", help=_SPECS_HELP.format(other_specs))


def add_specs_option(parser: argparse.ArgumentParser, other_specs: str = AND_PACKAGED) -> None:
    """Add ``--specs`` for commands whose arguments are not specs, and the options ``--json`` and ``--no-cache``."""
    parser.add_argument(
        "--specs", action="append", type=a_path, default=[], metavar="PATH", help=_SPECS_HELP.format(other_specs)
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_cache_option(parser)


def add_cache_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--no-cache``."""
    parser.add_argument("--no-cache", action="store_true", help="do not use cached results, and do not store new ones")


def cache_for(arguments: argparse.Namespace) -> Cache:
    """Return the cache of a run. With ``--no-cache``, it keeps nothing."""
    from ..cache import Cache, default_folder

    has_no_cache = getattr(arguments, "no_cache", False)
    return Cache(None if has_no_cache else default_folder())


def add_register_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--register``, whose values ``bytes_by_address`` reads."""
    parser.add_argument(
        "--register",
        action="append",
        default=[],
        metavar="ADDRESS=BYTE",
        help="value of a register, such as 0x56=0x10 (may be repeated, default: the factory defaults)",
    )


def bytes_by_address(pairs: Sequence[str]) -> dict[int, int]:
    """Return pairs such as ``0x56=0x10`` as bytes by address: ``{0x56: 0x10}``.

    Numbers may be decimal, or have a prefix. If several pairs have the same address, the last one is used.

    Raises:
        CommandError: A pair is malformed. The exit code is 2.
    """
    register_bytes: dict[int, int] = {}
    for pair in pairs:
        malformed = CommandError(f"'{pair}' is not a register and a byte; write it like 0x56=0x10", 2)
        # With base 0, the prefix of a number determines its base: 0x, 0b, or none for decimal.
        address_text, _, byte_text = pair.partition("=")
        try:
            address = int(address_text, 0)
            byte = int(byte_text, 0)
        except ValueError:
            raise malformed from None
        if not 0 <= byte <= 255:
            raise malformed
        register_bytes[address] = byte
    return register_bytes


def add_choose_option(parser: argparse.ArgumentParser, default: str) -> None:
    """Add ``--choose``. ``default`` is the end of its help: the behavior of the command without an answer."""
    parser.add_argument(
        "--choose",
        action="append",
        default=[],
        metavar="NAME=ANSWER",
        help="answer a question that the manual leaves open (may be repeated). 'show' lists these questions. "
        f"Without an answer, {default}",
    )


def add_edition_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--edition`` for commands that know register values."""
    parser.add_argument(
        "--edition",
        metavar="EDITION",
        help="use a different edition of the manual: a revision, a date, or 'label' or 'registers' to infer it",
    )
