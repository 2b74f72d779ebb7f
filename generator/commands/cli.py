"""The command line: arguments in, text and exit code out.

Exit codes: 0 done. 1 problems in the input, a difference, a frame with an error, or a register value that does not
match this encoder. 2 incorrect usage, unknown order code, or input that is not a frame or needs --choose. 3 a valid
frame whose position is not usable. With several frames, the worst one decides: 2, then 1, then 3.
"""

from __future__ import annotations

import argparse
import atexit
import gc
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from typing import Protocol, cast

from .arguments import Parser, ShowVersion, add_examples, parse
from .terminal import CommandError, prepare_streams, release_streams

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
