"""The command line: arguments in, text and exit code out.

Exit codes: 0 done; 1 problems in the input, a difference found, a frame with a fault, or a register that holds another
value than this encoder's; 2 wrong usage, unknown order code, or a frame that cannot be read; 3 a sound frame whose
position is not usable. Of several frames the worst decides: 2, then 1, then 3.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from . import look_up
from .arguments import Parser, ShowVersion, a_path, add_examples, parse
from .terminal import Stop, prepare, release
from .words import counted

_DESCRIPTION = "Describe an absolute encoder once; get a Python codec, C headers, a BiSS XML description and documentation."
_SPECS = (
    "files, each read whatever it holds, or folders, of which every .yaml file is read that is a spec by its keys; "
    "without any, the specs that lie in the current folder, or else those that ship with codewheel"
)
JSON_VERSION = 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; ``arguments`` default to those of the process."""
    prepare()
    try:
        code = _run(arguments)
        sys.stdout.flush()
        sys.stderr.flush()
        return code
    except BrokenPipeError:
        # The reader of our output has left before the end: neither done nor a verdict, so what a shell says of it.
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
        chosen = parse(_parser(), arguments)
        prepare(as_json=getattr(chosen, "json", False))
        code: int = chosen.run(chosen)
        return code
    except Stop as stop:
        print(f"codewheel: {stop}", file=sys.stderr)
        return stop.code
    except SystemExit as stop:  # Of the parser: help, or wrong usage.
        return int(stop.code or 0)


def _parser() -> argparse.ArgumentParser:
    parser = Parser(prog="codewheel", description=_DESCRIPTION)
    parser.add_argument("--version", action=ShowVersion, help="show the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    generate = commands.add_parser("generate", help="write all outputs, or compare them", description="Write every output of the specs.")
    generate.add_argument("specs", nargs="*", type=a_path, metavar="SPECS", help=_SPECS)
    _add_more_specs(generate)
    generate.add_argument("-o", dest="output", type=a_path, default=Path("generated"), metavar="DIR", help="output folder (default: generated)")
    generate.add_argument("--target", action="append", metavar="NAME", help="python, c, biss or docs; may be repeated (default: all four)")
    generate.add_argument("--check", action="store_true", help="write nothing; exit 1 if an output is not what the specs yield")
    generate.add_argument(
        "--force", action="store_true", help="overwrite files in the way that codewheel has not written"
    )
    generate.add_argument("--templates", type=a_path, metavar="DIR", help="folder whose templates are used instead of ours, file by file")
    generate.add_argument("--biss-dtd", type=a_path, metavar="FILE", help="the idbiss.dtd that you have: exit 1 if the idbiss file is not valid by it")
    generate.set_defaults(run=_generate)

    check = commands.add_parser("check", help="look for problems in specs", description="Report every problem of the specs.")
    check.add_argument("specs", nargs="*", type=a_path, metavar="SPECS", help=_SPECS)
    _add_more_specs(check)
    check.add_argument("--json", action="store_true", help="print the problems as JSON")
    check.set_defaults(run=_check)

    listing = commands.add_parser("list", help="list the families", description="List families, interfaces, order codes and manuals.")
    _add_spec_option(listing)
    listing.set_defaults(run=_list)

    show = commands.add_parser("show", help="show a family or an order code", description="Show everything that is known of a family or an order code.")
    show.add_argument("what", metavar="FAMILY|ORDER-CODE", help="the name of a family as list shows it, or the code on a label")
    _add_spec_option(show)
    show.set_defaults(run=_show)

    decode = commands.add_parser(
        "decode",
        help="name every bit of a frame",
        description="Name every bit of a frame, check its CRC, and say what the encoder reports.",
        epilog="FRAME is hex bytes for RS-485; for SSI and BiSS one number, first bit sent most significant: 0b... with every digit, "
        "0x..., or hex bytes. Lines of standard input may be empty or have comments after #. Exit codes: 0 done; 1 a frame with a "
        "fault, or a register that holds another value than this encoder's; 2 wrong usage, or text that is no frame; 3 a sound frame "
        "whose position is not usable. Of several frames the worst decides: 2, 1, 3.",
    )
    decode.add_argument("order_code", metavar="ORDER-CODE", help="the code on the label")
    decode.add_argument("frame", nargs="+", metavar="FRAME", help="the frame, in one or several arguments; - reads one frame a line")
    decode.add_argument("--as", dest="register_name", metavar="REGISTER", help="decode the bytes as the value of this register")
    decode.add_argument(
        "--register", action="append", default=[], metavar="ADDRESS=BYTE", help="what a register holds, such as 0x56=0x10; may be repeated (else: defaults)"
    )
    decode.add_argument("--layout", metavar="NAME", help="the frame's layout, as show names it, where nothing in the frame tells it: another BiSS data channel")
    decode.add_argument("--from", dest="sender", choices=("encoder", "master"), default="encoder", help="who sent it (default: encoder)")
    _add_spec_option(decode)
    decode.set_defaults(run=_decode)

    master = commands.add_parser("master", help="what a BiSS or SSI master is told", description="What a BiSS or SSI master has to be told about an encoder.")
    master.add_argument("order_code", nargs="?", metavar="ORDER-CODE", help="the code on the label; without one, the masters are listed")
    master.add_argument("--master", metavar="NAME", help="this master only; exit 1 if it cannot take the encoder")
    master.add_argument("--masters", action="append", type=a_path, default=[], metavar="PATH", help="descriptions of masters of your own, files or folders")
    master.add_argument(
        "--register", action="append", default=[], metavar="ADDRESS=BYTE", help="what a register holds, such as 0x56=0x10; may be repeated (else: defaults)"
    )
    master.add_argument("--cable", type=_metres, metavar="METRES", help="choose the clocks for a cable of this length")
    _add_spec_option(master)
    master.set_defaults(run=_master)

    diff = commands.add_parser("diff", help="what another version of a spec changes", description="Name each changed fact, breaking or compatible; exit 1 if there is one.")
    diff.add_argument("old", type=a_path, metavar="OLD", help="the spec as it was: a file or a folder")
    diff.add_argument("new", type=a_path, metavar="NEW", help="the spec as it is to be")
    diff.add_argument("--json", action="store_true", help="print JSON")
    diff.set_defaults(run=_diff)

    new = commands.add_parser("new", help="write a spec to start from", description="Write a commented spec that passes check, to be filled from a manual.")
    new.add_argument("name", metavar="NAME", help="name of the family: small letters, digits and underscores")
    new.add_argument("-o", dest="output", type=a_path, metavar="FILE", help="where to write it (default: NAME.yaml in this folder)")
    new.set_defaults(run=_new)
    add_examples(commands)
    return parser


def _metres(text: str) -> int:
    """A length of cable: a whole number of metres, or what is rounded up to one."""
    try:
        metres = math.ceil(float(text))
    except (ValueError, OverflowError):
        metres = 0
    if not 0 < metres <= 100_000:
        raise argparse.ArgumentTypeError(f"'{text}' is no length in metres, such as 30")
    return metres


def _add_more_specs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--specs", dest="more_specs", action="append", type=a_path, default=[], metavar="PATH", help="the same as SPECS"
    )


def _add_spec_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--specs", action="append", type=a_path, default=[], metavar="PATH", help="specs to use instead of those that ship with the tool")
    parser.add_argument("--json", action="store_true", help="print JSON")


def _print_json(data: Mapping[str, Any]) -> None:
    print(json.dumps(data, indent=2, ensure_ascii=False))


def _generate(chosen: argparse.Namespace) -> int:
    from .generate import run, targets_named
    from .load import load_library
    from .targets import BUILT_IN, Library

    targets = targets_named(list(dict.fromkeys(chosen.target or BUILT_IN)))
    if chosen.templates is not None and not chosen.templates.is_dir():
        raise Stop(f"there is no folder {chosen.templates}", 2)
    if chosen.biss_dtd is not None and "biss" not in targets:
        raise Stop("--biss-dtd is for the target biss", 2)
    paths = look_up.own_or_shipped([*chosen.specs, *chosen.more_specs])
    devices, report = load_library(paths, tuple(targets))
    if report:
        raise look_up.problems(report)
    print(look_up.read_line(paths, devices, report))
    return run(chosen, Library(devices, chosen.templates), targets)


def _check(chosen: argparse.Namespace) -> int:
    from .load import load_library

    paths = look_up.own_or_shipped([*chosen.specs, *chosen.more_specs])
    devices, report = load_library(paths)
    if chosen.json:
        problems = [problem.to_json() for problem in report.problems]
        read = {"files": report.files, "passed_over": report.passed_over}
        _print_json({"version": JSON_VERSION, **read, "problems": problems})
        return 1 if report else 0
    for problem in report.problems:
        print(problem.format())
    print(look_up.read_line(paths, devices, report))
    if report:
        print(counted(len(report), "problem"))
    else:
        names = ", ".join(device.name for device in devices)
        # A file may be checked that makes no family by itself, such as a master.
        print(f"no problems in {len(devices)} {'family' if len(devices) == 1 else 'families'}: {names}" if devices else "no problems")
    return 1 if report else 0


def _list(chosen: argparse.Namespace) -> int:
    from .show import list_data, list_text

    devices = look_up.load(chosen.specs)
    if chosen.json:
        _print_json(list_data(devices))
    else:
        print(list_text(devices))
    if look_up.has_other_specs(chosen.specs):
        print(f"codewheel: {look_up.OWN_SPECS_HINT}", file=sys.stderr)
    return 0


def _show(chosen: argparse.Namespace) -> int:
    device, match = look_up.family_or_code(chosen.specs, chosen.what)
    if chosen.json:
        from .output import device_dump, variant_dump

        _print_json(device_dump(device) if match is None else variant_dump(device, match))
        return 0
    from .show import device_text, variant_text

    print(device_text(device) if match is None else variant_text(device, match))
    return 0


def _diff(chosen: argparse.Namespace) -> int:
    from .diff import as_data, as_text, compare

    changes = compare(look_up.load([chosen.old]), look_up.load([chosen.new]))
    if chosen.json:
        _print_json(as_data(changes))
    else:
        print(as_text(changes))
    return 1 if changes else 0


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


def _held(pairs: Sequence[str]) -> dict[int, int]:
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


def _master(chosen: argparse.Namespace) -> int:
    from . import masters, masters_text
    from .masters_record import NoRecord, record
    from .problems import suggestion
    from .run_time import RegisterError, with_registers

    look_up.refuse_missing(chosen.masters)
    known, report = masters.load_masters(chosen.masters)
    if report:
        raise look_up.problems(report)
    if chosen.order_code is None:
        if chosen.json:
            _print_json(masters_text.masters_data(known))
        else:
            print(masters_text.masters_text(known))
        return 0
    names = [item.name for item in known]
    if chosen.master is not None and chosen.master not in names:
        raise Stop(f"there is no master '{chosen.master}'{suggestion(chosen.master, names) or '; codewheel master lists them'}", 2)
    device, match = look_up.order_code(chosen.specs, chosen.order_code)
    try:
        variant = with_registers(device, match.variant, _held(chosen.register))
        found = record(device, variant, not chosen.register, chosen.cable)
    except RegisterError as error:
        raise Stop(str(error), 2) from None
    except NoRecord as error:
        raise Stop(str(error), 1) from None
    sheets = [masters.sheet(item, found) for item in known if chosen.master in (None, item.name)]
    if chosen.json:
        _print_json(masters_text.sheet_data(match, found, sheets))
    else:
        print(masters_text.sheet_text(match, device.title, found, sheets))
    return 1 if chosen.master is not None and sheets[0].refusals else 0


def _decode(chosen: argparse.Namespace) -> int:
    from .decode_run import Decoding, Request, frames
    from .findings import compare_held, fixed_addresses
    from .run_time import RegisterError, with_registers

    device, match = look_up.order_code(chosen.specs, chosen.order_code)
    held, fixed = _held(chosen.register), fixed_addresses(device, match.variant)
    changing = {address: value for address, value in held.items() if address not in fixed}
    try:
        match = replace(match, variant=with_registers(device, match.variant, changing))
    except RegisterError as error:
        raise Stop(str(error), 2) from None
    others = compare_held(device, match.variant, held)
    asked = Request(device, match, chosen.sender, chosen.layout, chosen.register_name, chosen.json, others)
    decoding = Decoding(asked)
    try:
        decoding.run(frames(chosen.frame))
    except BrokenPipeError:
        release()
    return decoding.code
