"""The command line: arguments in, text and exit code out, and the arguments that several commands share.

Exit codes: 0 done. 1 problems in the input, a difference, a frame with an error, or a register value that does not
match this encoder. 2 incorrect usage, unknown order code, or input that is not a frame or needs --choose. 3 a valid
frame whose position is not usable. With several frames, the worst one decides: 2, then 1, then 3.
"""

from __future__ import annotations

import argparse
import atexit
import gc
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

from .. import __version__
from .terminal import CommandError, prepare_streams, release_streams

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


_DESCRIPTION = (
    "Describe an absolute encoder once and get a Python codec, C headers, a BiSS XML description and documentation."
)
#: The help of each command, in the order of the help.
COMMANDS: Mapping[str, str] = {
    "generate": "write all outputs, or compare them",
    "check": "find problems in specs",
    "list": "list the families",
    "show": "show a family or an order code",
    "decode": "decode a frame",
    "find": "find the layout of an unknown encoder",
    "master": "show the settings for a BiSS or SSI master",
    "simulate": "run a virtual encoder",
    "diff": "list the changes between two versions of specs",
    "reread": "find the changes in a new edition of a manual",
    "facts": "list the facts from a page or section of a manual",
    "cloze": "write a sheet for checking the words of a spec against the manual",
    "explain": "explain a rule of check or diff",
    "new": "write an example spec to start from",
    "migrate": "update specs to the current spec language",
}


#: Exit codes of a process that one of these signals ends, as in a shell.
_CODE_OF_SIGPIPE, _CODE_OF_SIGINT = 141, 130


class Command(Protocol):
    """The module or package of a command. It imports most modules only in ``run``, so that it can be imported quickly.

    ``EXAMPLES`` are command lines for the help, with the spec that ``new`` writes.
    """

    EXAMPLES: Sequence[str]

    def add_arguments(self, parser: Parser) -> None: ...

    def run(self, arguments: argparse.Namespace) -> int: ...


def command_named(name: str) -> Command:
    """Import the module or package of a command, and return it."""
    return cast("Command", import_module(f"{__package__}.{name}"))


def parser_for(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser for these arguments.

    It knows the command that the arguments begin with, or else all commands. To save time, only commands that are among
    the arguments are imported, because the help only lists the names of the others.
    """
    parser = Parser(prog="codewheel", description=_DESCRIPTION)
    parser.add_argument("--version", action=ShowVersion, help="show the version and exit")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name in _possible_commands(arguments):
        command_parser = subparsers.add_parser(name, help=COMMANDS[name])
        if name in arguments:
            command = command_named(name)
            command.add_arguments(command_parser)
            add_examples(command_parser, name, command.EXAMPLES)
    parser.formatter_class = argparse.HelpFormatter
    return parser


def _possible_commands(arguments: Sequence[str]) -> Sequence[str]:
    """Return the command that the arguments begin with, no command for ``--version``, and otherwise all commands."""
    first_argument = arguments[0] if arguments else ""
    if first_argument in COMMANDS:
        return [first_argument]
    if first_argument == "--version":
        return []
    return list(COMMANDS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code. ``arguments`` default to the arguments of the process.

    The exit code is 1 if the output cannot be written. It is 130 if the user interrupts the command, and 141 if the
    reader of the output closes it early, as in a shell.
    """
    if arguments is None:
        # Models contain no reference cycles, so collecting garbage would only cost time, even at the end.
        gc.set_threshold(1_000_000, 50, 100)
        atexit.register(gc.freeze)
    prepare_streams()
    try:
        code = _run_command(arguments)
        sys.stdout.flush()
        sys.stderr.flush()
        return code
    except BrokenPipeError:
        # The reader of the output closed it early.
        release_streams()
        return _CODE_OF_SIGPIPE
    except OSError as error:
        release_streams()
        with suppress(OSError):
            file_name = error.filename or "the output"
            print(f"codewheel: cannot write {file_name}: {error.strerror or error}", file=sys.stderr, flush=True)
        release_streams()
        return 1
    except KeyboardInterrupt:
        return _CODE_OF_SIGINT


def _run_command(arguments: Sequence[str] | None) -> int:
    """Parse the arguments, run the command, and return its exit code.

    If the command raises ``CommandError``, print its message and return its exit code.
    """
    try:
        words = sys.argv[1:] if arguments is None else arguments
        parsed = parse(parser_for(words), words)
        prepare_streams(as_json=getattr(parsed, "json", False))
        return command_named(parsed.command).run(parsed)
    except CommandError as stop:
        print(f"codewheel: {stop}", file=sys.stderr)
        return stop.code
    except SystemExit as stop:  # The parser raises it after printing the help or a usage error.
        return int(stop.code or 0)
