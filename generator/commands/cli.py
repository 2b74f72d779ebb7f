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
    "cloze": "write a sheet to check the words of a spec against the manual",
    "explain": "explain a rule of check or diff",
    "new": "write an example spec to start from",
    "migrate": "update specs to the current spec language",
}


#: Exit codes that a shell gives for an end by these signals.
_CODE_OF_SIGPIPE, _CODE_OF_SIGINT = 141, 130


class Command(Protocol):
    """The module or package of a command. To be imported quickly, it imports what its run needs only in ``run``.

    ``EXAMPLES`` are command lines for the help, with the spec that ``new`` writes.
    """

    EXAMPLES: Sequence[str]

    def add_arguments(self, parser: Parser) -> None: ...

    def run(self, arguments: argparse.Namespace) -> int: ...


def command_named(name: str) -> Command:
    """Import a command."""
    return cast("Command", import_module(f"{__package__}.{name}"))


def parser_for(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser for these arguments: with the command that they begin with, or else with all commands.

    Only commands that are among the arguments are imported and get arguments of their own, because the help only lists
    the others.
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
    """Return the command with which the arguments begin, no command for ``--version``, or else all commands."""
    first_argument = arguments[0] if arguments else ""
    if first_argument in COMMANDS:
        return [first_argument]
    return [] if first_argument == "--version" else list(COMMANDS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code. ``arguments`` default to the arguments of the process.

    The exit code is 1 if the output cannot be written. If the user or the reader of the output ends the command, it has
    the exit code of shells: 141 or 130.
    """
    if arguments is None:
        # Models have no cycles, so a process that ends soon gains nothing from a search for them, not even at its end.
        gc.set_threshold(1_000_000, 50, 100)
        atexit.register(gc.freeze)
    prepare_streams()
    try:
        code = _run_command(arguments)
        sys.stdout.flush()
        sys.stderr.flush()
        return code
    except BrokenPipeError:
        # The reader closed our output early.
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

    If it raises ``CommandError``, print the message and return the exit code of ``CommandError``.
    """
    try:
        words = sys.argv[1:] if arguments is None else arguments
        parsed = parse(parser_for(words), words)
        prepare_streams(as_json=getattr(parsed, "json", False))
        return command_named(parsed.command).run(parsed)
    except CommandError as stop:
        print(f"codewheel: {stop}", file=sys.stderr)
        return stop.code
    except SystemExit as stop:  # Of the parser: help, or wrong usage.
        return int(stop.code or 0)
