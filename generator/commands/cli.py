"""The command line: arguments in, text and exit code out.

Exit codes: 0 done. 1 problems in the input, a difference, a frame with an error, or a register value that does not
match this encoder. 2 wrong usage, unknown order code, or text that is not a frame or needs --choose. 3 a valid frame
whose position is not usable. With several frames, the worst one decides: 2, then 1, then 3.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from . import look_up
from .arguments import Parser, ShowVersion, a_path, add_examples, held_bytes, metres, parse
from .terminal import Stop, prepare, release

if TYPE_CHECKING:
    from ..cache import Cache
    from ..loading.library import Family

_DESCRIPTION = (
    "Describe an absolute encoder once and get a Python codec, C headers, a BiSS XML description and documentation."
)
_SPECS = (
    "spec files, or folders. In a folder, all .yaml files with the keys of a spec are read (default: the specs in the "
    "current folder, or if there are none, those shipped with codewheel)"
)
JSON_VERSION = 1

_Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code. ``arguments`` default to those of the process."""
    prepare()
    try:
        code = _run(arguments)
        sys.stdout.flush()
        sys.stderr.flush()
        return code
    except BrokenPipeError:
        # The reader closed our output early. Return the code that a shell gives for SIGPIPE.
        release()
        return 141
    except OSError as error:
        release()
        with suppress(OSError):
            place = error.filename or "the output"
            print(f"codewheel: cannot write {place}: {error.strerror or error}", file=sys.stderr, flush=True)
        release()
        return 1
    except KeyboardInterrupt:
        return 130


def _run(arguments: Sequence[str] | None) -> int:
    try:
        chosen = parse(_parser(sys.argv[1:] if arguments is None else arguments), arguments)
        if getattr(chosen, "looks_up", False) and getattr(chosen, "order_code", "") is not None:
            chosen.specs = look_up.own_or_shipped(chosen.specs, say=True)
        prepare(as_json=getattr(chosen, "json", False))
        code: int = chosen.run(chosen)
        return code
    except Stop as stop:
        print(f"codewheel: {stop}", file=sys.stderr)
        return stop.code
    except SystemExit as stop:  # Of the parser: help, or wrong usage.
        return int(stop.code or 0)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser for these arguments: with the command that they begin with, or else with all commands."""
    parser = Parser(prog="codewheel", description=_DESCRIPTION)
    parser.add_argument("--version", action=ShowVersion, help="show the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    first = arguments[0] if arguments else ""
    for name in [first] if first in _COMMANDS else () if first == "--version" else _COMMANDS:
        _COMMANDS[name](commands)
    add_examples(commands)
    return parser


def _add_generate(commands: _Commands) -> None:
    parser = commands.add_parser(
        "generate", help="write all outputs, or compare them", description="Write all outputs of the specs."
    )
    _add_specs(parser)
    parser.add_argument(
        "-o",
        dest="output",
        type=a_path,
        default=Path("generated"),
        metavar="DIR",
        help="output folder (default: generated)",
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
    parser.set_defaults(run=_generate)


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
    _add_cache_option(parser)


def _add_check(commands: _Commands) -> None:
    parser = commands.add_parser(
        "check", help="find problems in specs", description="Report all problems in the specs."
    )
    _add_specs(parser)
    parser.add_argument(
        "--target",
        action="append",
        metavar="NAME",
        help="check that this output can express the specs (see below, may be repeated)",
    )
    parser.add_argument("--json", action="store_true", help="print the problems as JSON")
    _add_cache_option(parser)
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
    parser.set_defaults(run=_check)


def _add_list(commands: _Commands) -> None:
    parser = commands.add_parser(
        "list", help="list the families", description="List families, interfaces, order codes and manuals."
    )
    _add_spec_option(parser)
    parser.set_defaults(run=_list)


def _add_show(commands: _Commands) -> None:
    parser = commands.add_parser(
        "show",
        help="show a family or an order code",
        description="Show everything known about a family or an order code.",
    )
    parser.add_argument(
        "what", metavar="FAMILY|ORDER-CODE", help="a family name as shown by list, or the code on the label"
    )
    parser.add_argument(
        "--edition", metavar="EDITION", help="use another edition of the manual: a revision, a date, or 'label'"
    )
    _add_spec_option(parser)
    parser.set_defaults(run=_show)


_ABOUT_FRAMES = (
    "For RS-485, FRAME is a sequence of bytes in hexadecimal. For SSI and BiSS, it is one number whose most "
    "significant bit is the first bit sent: 0b... with every digit, 0x..., or hex bytes. The notations of "
    "programs and logs are also accepted, such as 0F:42, [0x0F, 0x42], \\x0F\\x42 and F4243D3h. With -, lines "
    "may begin with a time, and empty lines and text after # are skipped. The exit code is 0 on success, 1 "
    "for a frame with an error or a register value that this encoder cannot have, 2 for wrong usage, text "
    "that is not a frame, or a missing --choose, and 3 for a valid frame whose position is not usable. With "
    "several frames, the exit code is that of the worst one, in the order 2, 1, 3."
)


def _add_decode(commands: _Commands) -> None:
    parser = commands.add_parser(
        "decode",
        help="decode a frame",
        description="Name every bit of a frame, check its CRC, and list the reports of the encoder.",
        epilog=_ABOUT_FRAMES,
    )
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
        help="the frame's layout, one of those listed by show, if the frame does not identify it (such as another BiSS"
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
    parser.set_defaults(run=_decode)


def _add_master(commands: _Commands) -> None:
    parser = commands.add_parser(
        "master",
        help="show the settings for a BiSS or SSI master",
        description="Show the settings that a BiSS or SSI master needs for an encoder.",
    )
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
    parser.set_defaults(run=_master)


def _add_diff(commands: _Commands) -> None:
    from .diff import add_diff

    add_diff(commands).set_defaults(run=_diff)


def _add_explain(commands: _Commands) -> None:
    from .explain import add_explain

    add_explain(commands)


def _add_reread(commands: _Commands) -> None:
    parser = commands.add_parser(
        "reread",
        help="find the changes in a new edition of a manual",
        description="Compare the texts of two editions of a manual, and list the facts that cite changed passages.",
        epilog="Exit codes: 0 no difference. 1 differences. 2 wrong usage, or a file that is not the text of a manual.",
    )
    parser.add_argument("old", type=a_path, metavar="OLD", help="the edition that the spec describes: text or PDF")
    parser.add_argument("new", type=a_path, metavar="NEW", help="the new edition")
    parser.add_argument(
        "--family", metavar="FAMILY", help="family that the manual describes (default: the one named on its first page)"
    )
    _add_spec_option(parser)
    parser.set_defaults(run=_reread)


def _add_facts(commands: _Commands) -> None:
    parser = commands.add_parser(
        "facts",
        help="list the facts from a page or section of a manual",
        description="List the facts of a family that cite a page or a section of its manual.",
    )
    parser.add_argument("family", metavar="FAMILY", help="a family name as shown by list")
    parser.add_argument("--page", type=int, metavar="NUMBER", help="facts that cite this page")
    parser.add_argument("--section", metavar="NUMBER", help="facts that cite this section, such as 6.4")
    _add_spec_option(parser)
    parser.set_defaults(run=_facts)


def _add_new(commands: _Commands) -> None:
    parser = commands.add_parser(
        "new",
        help="write an example spec to start from",
        description="Write a commented spec that passes check, to be filled in from a manual.",
    )
    parser.add_argument("name", metavar="NAME", help="name of the family: lowercase letters, digits and underscores")
    parser.add_argument(
        "-o", dest="output", type=a_path, metavar="FILE", help="output file (default: NAME.yaml in this folder)"
    )
    parser.set_defaults(run=_new)


#: The commands, in the order of the help.
_COMMANDS = {
    "generate": _add_generate,
    "check": _add_check,
    "list": _add_list,
    "show": _add_show,
    "decode": _add_decode,
    "master": _add_master,
    "diff": _add_diff,
    "reread": _add_reread,
    "facts": _add_facts,
    "explain": _add_explain,
    "new": _add_new,
}


def _add_specs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("specs", nargs="*", type=a_path, metavar="SPECS", help=_SPECS)
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


def _add_spec_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--specs",
        action="append",
        type=a_path,
        default=[],
        metavar="PATH",
        help="specs to use (default: those in the current folder, or those shipped with codewheel)",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    _add_cache_option(parser)
    parser.set_defaults(looks_up=True)


def _add_cache_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--no-cache", action="store_true", help="neither use nor store results of earlier runs")


def _cache(chosen: argparse.Namespace) -> Cache:
    from ..cache import Cache, default_folder

    return Cache(None if chosen.no_cache else default_folder())


def _print(as_json: bool, data: Callable[[], Mapping[str, Any]], text: Callable[[], str]) -> None:
    print(json.dumps(data(), indent=2, ensure_ascii=False) if as_json else text())


def _targets_for_help() -> str:
    from .outputs import listing

    return listing()


def _generate(chosen: argparse.Namespace) -> int:
    from .earlier import earlier
    from .generate import is_unchanged, run

    paths = look_up.own_or_shipped([*chosen.specs, *chosen.more_specs])
    options = [*(chosen.target or ()), "", *chosen.option, "", *chosen.edition]
    before = earlier(_cache(chosen), "generate", paths, options)
    known = None if chosen.templates is not None or chosen.biss_dtd is not None else before.get()
    if known is not None:
        read = look_up.read_line(paths, known["families"], before.report(known["files"]))
        if is_unchanged(chosen, known["hashes"], read):
            return 0
    from ..targets import Library
    from ..write import hashes
    from .coverage import refuse_unproved
    from .outputs import are_built_in, load_for, options_named, rendered, targets_named

    targets = targets_named(chosen.target)
    settings = options_named(chosen.option, targets)
    if chosen.templates is not None and not chosen.templates.is_dir():
        raise Stop(f"there is no folder {chosen.templates}", 2)
    if chosen.biss_dtd is not None and all(target.name != "biss" for target in targets):
        raise Stop("--biss-dtd needs the target biss", 2)
    families: list[Family] = []
    devices, report = load_for(paths, targets, chosen.edition, families, _cache(chosen))
    if report:
        raise look_up.problems(report)
    names = [device.name for device in devices]
    print(look_up.read_line(paths, names, report))
    files = rendered(Library(devices, chosen.templates), targets, settings)
    if chosen.templates is None and are_built_in(targets, chosen.target):
        made = {name: hashes(texts) for name, texts in files.items()}
        before.put({"families": names, "files": report.files, "hashes": made})
    return run(chosen, files, lambda: refuse_unproved(families, "written"))


def _check(chosen: argparse.Namespace) -> int:
    from .check_text import as_data, as_text
    from .earlier import earlier

    if chosen.write and not chosen.coverage:
        raise Stop("--write needs --coverage", 2)
    paths = look_up.own_or_shipped([*chosen.specs, *chosen.more_specs])
    before = earlier(_cache(chosen), "check", paths)
    known = None if chosen.coverage or chosen.target else before.get()
    if known is not None:
        report = before.report(known["files"])
        data = {"version": JSON_VERSION} | as_data(report)
        _print(chosen.json, lambda: data, lambda: as_text(known["families"], report, paths))
        return 0
    from . import check, coverage
    from .outputs import are_built_in, targets_named

    targets = targets_named(chosen.target)
    found = check.run(paths, targets, None if chosen.coverage else _cache(chosen))
    names = [family.device.name for family in found.families]
    covered = coverage.cover(found, chosen.write) if chosen.coverage else []
    counts = coverage.as_data(covered) if chosen.coverage else {}
    data = {"version": JSON_VERSION} | as_data(found.report) | counts
    _print(chosen.json, lambda: data, lambda: as_text(names, found.report, paths))
    if chosen.coverage and not chosen.json:
        print(coverage.as_text(covered, found))
    if not found.report and are_built_in(targets):
        before.put({"families": names, "files": found.report.files})
    return 0 if coverage.is_complete(covered, found.report) else 1


def _list(chosen: argparse.Namespace) -> int:
    from .earlier import earlier
    from .listing import as_data, as_text, rows

    before = earlier(_cache(chosen), "list", chosen.specs)
    families = before.get()
    if families is None:
        families = rows(look_up.load(chosen.specs))
        before.put(families)
    _print(chosen.json, lambda: as_data(families), lambda: as_text(families))
    return 0


def _show(chosen: argparse.Namespace) -> int:
    device, match = look_up.family_or_code(chosen.specs, chosen.what, _cache(chosen))
    if chosen.edition is not None:
        from .editions import asked_for

        device, match, _ = asked_for(chosen.specs, device, match, chosen.edition, chosen.what, {})
    if chosen.json:
        from ..dump.plain import device_dump, variant_dump

        data = device_dump(device) if match is None else variant_dump(device, match)
        print(json.dumps(data, indent=2, ensure_ascii=False))
        return 0
    from .show import device_text, variant_text

    print(device_text(device) if match is None else variant_text(device, match))
    return 0


def _reread(chosen: argparse.Namespace) -> int:
    from .reread import run

    return run(chosen)


def _facts(chosen: argparse.Namespace) -> int:
    from .reread import run_facts

    return run_facts(chosen)


def _diff(chosen: argparse.Namespace) -> int:
    from .diff import run

    return run(
        chosen,
        lambda old, new: import_module(f"{__package__}.changed_files").changed_files(old, new),
        lambda families: import_module(f"{__package__}.coverage").refuse_unproved(families, "recorded"),
    )


def _new(chosen: argparse.Namespace) -> int:
    from .new import NameRefused, NotWritten, write_spec

    try:
        for path in write_spec(chosen.name, chosen.output):
            print(f"written    {path.as_posix()}")
    except NameRefused as error:
        raise Stop(str(error), 2) from None
    except NotWritten as error:
        raise Stop(str(error), 1) from None
    return 0


def _master(chosen: argparse.Namespace) -> int:
    from .master import run

    code, data = run(chosen, _cache(chosen))
    print(data if isinstance(data, str) else json.dumps(data, indent=2, ensure_ascii=False))
    return code


def _decode(chosen: argparse.Namespace) -> int:
    from ..order_codes.holding_only import held_by
    from ..order_codes.run_time import RegisterError, decided, with_registers
    from ..reference.findings import compare_held, fixed_addresses
    from .choose import answers_of
    from .decode_run import Decoding, Request, frames

    device, found = look_up.order_code(chosen.specs, chosen.order_code, _cache(chosen))
    match, held = found, held_bytes(chosen.register)
    if chosen.edition is not None:
        from .editions import asked_for

        device, again, held = asked_for(chosen.specs, device, found, chosen.edition, chosen.order_code, held)
        match = again or found
    answers = answers_of(device, match.variant, chosen.choose)
    fixed = fixed_addresses(device, match.variant)
    changing = {address: value for address, value in held.items() if address not in fixed}
    try:
        variant = decided(device, with_registers(device, match.variant, changing), answers)
    except RegisterError as error:
        raise Stop(str(error), 2) from None
    others = compare_held(device, match.variant, held)
    match = replace(match, variant=variant)
    device = held_by(device, [variant.code])
    asked = Request(device, match, chosen.sender, chosen.layout, chosen.register_name, chosen.json, others, answers)
    decoding = Decoding(asked)
    try:
        decoding.run(frames(chosen.frame))
    except BrokenPipeError:
        release()
    return decoding.code
