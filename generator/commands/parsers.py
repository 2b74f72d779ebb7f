"""Arguments and options of each command."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module

from .arguments import FORMATS, FORMATS_HELP, Parser, ShowVersion, a_path, add_cache_option, complete, metres

_DESCRIPTION = (
    "Describe an absolute encoder once and get a Python codec, C headers, a BiSS XML description and documentation."
)
_SPECS = (
    "spec files, or folders. In a folder and below it, all .yaml files with the keys of a spec are read (default: the "
    "specs under [tool.codewheel], or else those in the current folder and below it{})"
)
_PACKAGED_TOO = ", and the packaged ones"


def parser_for(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser for these arguments: with the command that they begin with, or else with all commands.

    Only commands that are among the arguments have arguments of their own, because the others can only be listed.
    """
    parser = Parser(prog="codewheel", description=_DESCRIPTION)
    parser.add_argument("--version", action=ShowVersion, help="show the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    first = arguments[0] if arguments else ""
    for name in [first] if first in _COMMANDS else () if first == "--version" else _COMMANDS:
        summary, add_arguments = _COMMANDS[name]
        command = commands.add_parser(name, help=summary)
        if name in arguments:
            add_arguments(command)
            complete(command, name)
    parser.formatter_class = argparse.HelpFormatter
    return parser


def _add_generate(parser: Parser) -> None:
    parser.description = "Write all outputs of the specs."
    _add_specs(parser)
    parser.add_argument(
        "-o",
        dest="output",
        type=a_path,
        metavar="DIR",
        help="output folder (default: that under [tool.codewheel], or else generated)",
    )
    parser.add_argument(
        "--packaged",
        action="append",
        default=[],
        metavar="NAME",
        help="generate a packaged encoder: an order code, a family or a manufacturer (may be repeated)",
    )
    parser.add_argument(
        "--target", action="append", metavar="NAME", help="write only this output (see below, may be repeated)"
    )
    parser.add_argument(
        "--option",
        action="append",
        default=[],
        metavar="TARGET.OPTION=VALUE",
        help="set an option of a target (see below, may be repeated)",
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing, and exit 1 if an output does not match the specs"
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files that codewheel did not write")
    parser.add_argument(
        "--prune", action="store_true", help="also remove the outputs of families whose specs are not read"
    )
    parser.add_argument(
        "--edition",
        action="append",
        default=[],
        metavar="FAMILY=EDITION",
        help="also generate another edition of a family, selected by revision or date (may be repeated)",
    )
    parser.add_argument(
        "--unchecked", action="store_true", help="write even if second readings disagree or coverage is out of date"
    )
    _add_own_files(parser)
    parser.more_help = _targets_for_help


def _add_own_files(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--templates",
        type=a_path,
        metavar="DIR",
        help="folder with your own templates, which override the built-in ones: DIR/TARGET/NAME",
    )
    parser.add_argument(
        "--biss-dtd",
        type=a_path,
        metavar="FILE",
        help="validate the idbiss files against FILE, your copy of idbiss.dtd, and exit 1 if one is not valid",
    )
    add_cache_option(parser)


def _add_check(parser: Parser) -> None:
    parser.description = "Report all problems in the specs."
    _add_specs(parser)
    parser.add_argument(
        "--target",
        action="append",
        metavar="NAME",
        help="check that this output can express the specs (see below, may be repeated)",
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print the problems as JSON")
    form.add_argument("--format", choices=FORMATS, default="text", help=FORMATS_HELP)
    add_cache_option(parser)
    parser.add_argument(
        "--coverage",
        action="store_true",
        help="count how often each fact was read, and exit 1 if a fact that needs two readings was read only once",
    )
    parser.add_argument(
        "--write",
        action="store_true",
        help="with --coverage: save the counts next to the specs, for the documentation pages",
    )
    parser.more_help = _targets_for_help


def _add_list(parser: Parser) -> None:
    parser.description = "List families, interfaces, order codes and manuals."
    _add_specs(parser, _PACKAGED_TOO)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_cache_option(parser)


def _add_show(parser: Parser) -> None:
    parser.description = "Show everything known about a family or an order code."
    parser.add_argument(
        "what", metavar="FAMILY|ORDER-CODE", help="a family name as shown by list, or the code on the label"
    )
    parser.add_argument(
        "--edition", metavar="EDITION", help="use another edition of the manual: a revision, a date, or 'label'"
    )
    _add_spec_option(parser)


_ABOUT_FRAMES = (
    "For RS-485, FRAME is a sequence of bytes in hexadecimal. For SSI, BiSS and SPI, it is one number whose most "
    "significant bit is the first bit sent: 0b... with every digit, 0x..., or hex bytes. The notations of "
    "programs and logs are also accepted, such as 0F:42, [0x0F, 0x42], \\x0F\\x42 and F4243D3h. With -, lines "
    "may begin with a time, and empty lines and text after # are skipped. The exit code is 0 on success, 1 "
    "for a frame with an error or a register value that this encoder cannot have, 2 for wrong usage, text "
    "that is not a frame, or a missing --choose, and 3 for a valid frame whose position is not usable. With "
    "several frames, the exit code is that of the worst one, in the order 2, 1, 3."
)


def _add_decode(parser: Parser) -> None:
    parser.description = "Name every bit of a frame, check its CRC, and list the reports of the encoder."
    parser.epilog = _ABOUT_FRAMES
    parser.add_argument("order_code", metavar="ORDER-CODE", help="the code on the label")
    parser.add_argument(
        "frame", nargs="+", metavar="FRAME", help="the frame, as one or more arguments, or - to read one frame per line"
    )
    parser.add_argument(
        "--as", dest="register_name", metavar="REGISTER", help="decode the bytes as this register's value"
    )
    _add_register_option(parser)
    _add_choose_option(parser, "frames that depend on the answer are not decoded")
    _add_edition_option(parser)
    parser.add_argument(
        "--layout",
        metavar="NAME",
        help="layout of the frame, as listed by show, if the frame does not identify it (such as another BiSS"
        " data channel)",
    )
    parser.add_argument(
        "--from",
        dest="sender",
        choices=("encoder", "master"),
        default="encoder",
        help="sender of the frame (default: encoder)",
    )
    _add_spec_option(parser)


def _add_master(parser: Parser) -> None:
    parser.description = "Show the settings that a BiSS or SSI master needs for an encoder."
    parser.add_argument(
        "order_code", nargs="?", metavar="ORDER-CODE", help="the code on the label (default: list the masters)"
    )
    parser.add_argument(
        "--master", metavar="NAME", help="show only this master, and exit 1 if it does not support the encoder"
    )
    parser.add_argument("--format", metavar="FORMAT", help="print a file for this master in one of its formats")
    parser.add_argument("--device", metavar="DEVICE", help="device of the master for --format (default: the first)")
    parser.add_argument(
        "--masters",
        action="append",
        type=a_path,
        default=[],
        metavar="PATH",
        help="your own descriptions of masters, as files or folders",
    )
    _add_register_option(parser)
    _add_choose_option(parser, "no settings if they depend on the answer")
    _add_edition_option(parser)
    parser.add_argument("--cable", type=metres, metavar="METRES", help="choose clocks for a cable of this length")
    _add_spec_option(parser)


def _add_simulate(parser: Parser) -> None:
    parser.description = "Answer like an encoder on a pseudo-terminal or over TCP, and print the device or URL to open."
    parser.add_argument("order_code", metavar="ORDER-CODE", help="the code on the label")
    parser.add_argument(
        "--position",
        default="0",
        metavar="POSITION",
        help="counts such as 1000003, sine:0.5Hz, or ramp:1000 in counts per second (default: 0)",
    )
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="NAME[:RATE]",
        help="inject a fault into this share of the replies, such as flip:1e-3 (may be repeated)",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the random faults (default: 0)")
    parser.add_argument(
        "--flag", action="append", default=[], metavar="NAME", help="activate an alarm or flag (may be repeated)"
    )
    parser.add_argument(
        "--tcp",
        nargs="?",
        type=int,
        const=0,
        metavar="PORT",
        help="use TCP on this computer instead of a pseudo-terminal (default: any free port)",
    )
    _add_register_option(parser)
    _add_choose_option(parser, "requests that depend on the answer are not answered")
    parser.add_argument("--edition", metavar="EDITION", help="use another edition of the manual: a revision or a date")
    parser.add_argument(
        "--specs", action="append", type=a_path, default=[], metavar="PATH", help="specs to use, as for decode"
    )
    parser.more_help = lambda: import_module(f"{__package__}.simulate").more_help()


def _add_diff(parser: Parser) -> None:
    from .diff import add_diff

    add_diff(parser)


def _add_explain(parser: Parser) -> None:
    from .explain import add_explain

    add_explain(parser)


def _add_reread(parser: Parser) -> None:
    parser.description = "Compare the texts of two editions of a manual, and list the facts that cite changed passages."
    parser.epilog = (
        "Exit codes: 0 no difference. 1 differences. 2 wrong usage, or a file that is not the text of a manual."
    )
    parser.add_argument("old", type=a_path, metavar="OLD", help="the edition that the spec describes: text or PDF")
    parser.add_argument("new", type=a_path, metavar="NEW", help="the new edition")
    parser.add_argument(
        "--family", metavar="FAMILY", help="family that the manual describes (default: the one named on its first page)"
    )
    _add_spec_option(parser, "")


def _add_facts(parser: Parser) -> None:
    parser.description = "List the facts of a family that cite a page or a section of its manual."
    parser.add_argument("family", metavar="FAMILY", help="a family name as shown by list")
    parser.add_argument("--page", type=int, metavar="NUMBER", help="facts that cite this page")
    parser.add_argument("--section", metavar="NUMBER", help="facts that cite this section, such as 6.4")
    _add_spec_option(parser, "")


def _add_new(parser: Parser) -> None:
    parser.description = "Write a commented spec that passes check, to be filled in from a manual."
    parser.add_argument("name", metavar="NAME", help="name of the family: lowercase letters, digits and underscores")
    parser.add_argument(
        "-o", dest="output", type=a_path, metavar="FILE", help="output file (default: NAME.yaml in this folder)"
    )
    parser.add_argument(
        "--like",
        choices=("biss", "ssi", "rs485", "rs485-exchanges", "spi", "linear"),
        default="",
        help="kind of encoder: multiturn over this interface (SPI: singleturn), or linear over BiSS. "
        "rs485: the T-format, rs485-exchanges: other requests",
    )


def _add_migrate(parser: Parser) -> None:
    parser.description = (
        "Apply renamed keys to specs, keep comments and layout, and list what only a person can decide."
    )
    parser.add_argument("specs", nargs="*", type=a_path, metavar="SPECS", help=_SPECS.format(""))
    parser.add_argument("--check", action="store_true", help="list what would change, and write nothing")


#: The help and the arguments of each command, in the order of the help.
_COMMANDS: Mapping[str, tuple[str, Callable[[Parser], None]]] = {
    "generate": ("write all outputs, or compare them", _add_generate),
    "check": ("find problems in specs", _add_check),
    "list": ("list the families", _add_list),
    "show": ("show a family or an order code", _add_show),
    "decode": ("decode a frame", _add_decode),
    "master": ("show the settings for a BiSS or SSI master", _add_master),
    "simulate": ("run a virtual encoder", _add_simulate),
    "diff": ("list the changes between two versions of specs", _add_diff),
    "reread": ("find the changes in a new edition of a manual", _add_reread),
    "facts": ("list the facts from a page or section of a manual", _add_facts),
    "explain": ("explain a rule of check or diff", _add_explain),
    "new": ("write an example spec to start from", _add_new),
    "migrate": ("update specs to the current spec language", _add_migrate),
}


def _add_specs(parser: argparse.ArgumentParser, other_specs: str = "") -> None:
    parser.add_argument("specs", nargs="*", type=a_path, metavar="SPECS", help=_SPECS.format(other_specs))
    parser.add_argument(
        "--specs", dest="more_specs", action="append", type=a_path, default=[], metavar="PATH", help="the same as SPECS"
    )


def _add_register_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--register",
        action="append",
        default=[],
        metavar="ADDRESS=BYTE",
        help="value of a register, such as 0x56=0x10 (may be repeated, default: the factory defaults)",
    )


def _add_choose_option(parser: argparse.ArgumentParser, otherwise: str) -> None:
    parser.add_argument(
        "--choose",
        action="append",
        default=[],
        metavar="NAME=ANSWER",
        help="answer a question that the manual leaves open. show lists these questions (may be repeated, default: "
        f"{otherwise})",
    )


def _add_edition_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--edition",
        metavar="EDITION",
        help="use another edition of the manual: a revision, a date, or 'label' or 'registers' to infer it",
    )


def _add_spec_option(parser: argparse.ArgumentParser, other_specs: str = _PACKAGED_TOO) -> None:
    parser.add_argument(
        "--specs",
        action="append",
        type=a_path,
        default=[],
        metavar="PATH",
        help=_SPECS.format(other_specs),
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_cache_option(parser)


def _targets_for_help() -> str:
    from .outputs import listing

    return listing()
