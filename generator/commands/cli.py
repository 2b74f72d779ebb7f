"""The command line: arguments in, text and exit code out.

Exit codes: 0 done. 1 problems in the input, a difference, a frame with an error, or a register value that does not
match this encoder. 2 wrong usage, unknown order code, or text that is not a frame or needs --choose. 3 a valid frame
whose position is not usable. With several frames, the worst one decides: 2, then 1, then 3.
"""

from __future__ import annotations

import argparse
import atexit
import gc
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import look_up, which_specs
from .arguments import held_bytes, parse
from .parsers import parser_for
from .settings_targets import refuse_unknown_targets
from .terminal import Progress, Stop, prepare, problems, release

if TYPE_CHECKING:
    from pathlib import Path

    from ..cache import Cache
    from ..language.problems import Report
    from .which_specs import Specs

JSON_VERSION = 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code. ``arguments`` default to those of the process."""
    if arguments is None:
        # Models have no cycles, so a process that ends soon gains nothing from a search for them, not even at its end.
        gc.set_threshold(1_000_000, 50, 100)
        atexit.register(gc.freeze)
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
        chosen = parse(parser_for(sys.argv[1:] if arguments is None else arguments), arguments)
        prepare(as_json=getattr(chosen, "json", False))
        return _RUNS[chosen.command](chosen)
    except Stop as stop:
        print(f"codewheel: {stop}", file=sys.stderr)
        return stop.code
    except SystemExit as stop:  # Of the parser: help, or wrong usage.
        return int(stop.code or 0)


#: An entry of the cache with another form than ours is ignored, and the command does its work.
_OTHER_FORM = suppress(LookupError, TypeError, AttributeError, ValueError)


def _cache(chosen: argparse.Namespace) -> Cache:
    from ..cache import Cache, default_folder

    return Cache(None if getattr(chosen, "no_cache", False) else default_folder())


def _specs_to_judge(named: Sequence[Path], command: str, cache: Cache) -> Specs:
    specs = which_specs.specs_to_judge(named, command, cache)
    refuse_unknown_targets(specs.settings)
    return specs


def _specs_to_read(named: Sequence[Path], cache: Cache) -> Specs:
    specs = which_specs.specs_to_read(named, cache)
    refuse_unknown_targets(specs.settings)
    return specs


def _print(as_json: bool, data: Callable[[], Mapping[str, Any]], text: Callable[[], str]) -> None:
    print(json.dumps(data(), indent=2, ensure_ascii=False) if as_json else text())


def _generate(chosen: argparse.Namespace) -> int:
    from .earlier import Generated, Hashes, earlier
    from .generate import is_unchanged, run
    from .selection import selected

    asked = selected(chosen, _cache(chosen))
    paths, settings_given = asked.paths, asked.options
    options = [*(chosen.target or ()), "", *settings_given, "", *chosen.edition]
    before = earlier(_cache(chosen), "generate", paths, options)
    known = None if chosen.templates is not None or chosen.biss_dtd is not None else before.get(Generated)
    if known is not None:
        with _OTHER_FORM:
            read = _read_line(known["families"], before.report(known["files"]), chosen.packaged, asked.packaged)
            if is_unchanged(chosen, known["hashes"], known["owners"], read, before.cache):
                return 0
    from ..loading.library import load_families

    with Progress("codewheel: reading the specs"):
        families, report = load_families(paths, _cache(chosen))
    alike = before.of_models([family.digest for family in families])
    names = [family.device.name for family in families]
    known = None if report or chosen.edition or chosen.templates or chosen.biss_dtd else alike.get(Hashes)
    if known is not None:
        with _OTHER_FORM:
            read = _read_line(names, report, chosen.packaged, asked.packaged)
            if is_unchanged(chosen, known["hashes"], known["owners"], read, before.cache):
                before.put({"families": names, "files": report.files} | known)
                return 0
    from ..loading.stored import digest_of
    from ..owners import owners
    from ..parts import Kept, Rendering
    from ..targets import Library
    from ..targets.registry import BUILT_IN
    from ..write import hashes
    from .outputs import are_built_in, complete, options_named, rendered, targets_named

    progress = Progress("codewheel: checking the specs")
    # Other processes begin to render at once, unless the run will end with problems. They do not know the user's
    # templates and options.
    changed = {setting.partition(".")[0] for setting in settings_given}
    plain = [name for name in dict.fromkeys(chosen.target or BUILT_IN) if name in BUILT_IN and name not in changed]
    digests = {item.device.name: item.digest for item in families}
    if not chosen.no_cache:
        digests = {item.device.name: item.digest or digest_of(item.device) for item in families}
    kept = Kept(_cache(chosen), digests, progress.begun)
    loaded = [item.device for item in families]
    with Rendering(loaded, [] if report or chosen.templates else plain, kept) as begun:
        targets = targets_named(chosen.target)
        settings = options_named(asked.options_for([family.device.name for family in families]), targets)
        if chosen.templates is not None and not chosen.templates.is_dir():
            raise Stop(f"there is no folder {chosen.templates}", 2)
        if chosen.biss_dtd is not None and all(target.name != "biss" for target in targets):
            raise Stop("--biss-dtd needs the target biss", 2)
        with progress:
            devices = complete(families, targets, chosen.edition, report)
        if report:
            raise problems(report)
        names = [device.name for device in devices]
        print(_read_line(names, report, chosen.packaged, asked.packaged))
        with progress:
            files = rendered(Library(devices, chosen.templates), targets, settings, begun)
    if chosen.templates is None and are_built_in(targets, chosen.target):
        made = {name: hashes(texts) for name, texts in files.items()}
        before.put({"families": names, "files": report.files, "hashes": made, "owners": owners(devices)})
        alike.put({"hashes": made, "owners": owners(devices)})

    def gate() -> None:
        import_module(f"{__package__}.coverage").refuse_unproved(families, "written", _cache(chosen))

    return run(chosen, files, gate, asked.guard(chosen, devices, report.files))


def _read_line(families: Sequence[str], report: Report, packaged: Sequence[str], packaged_files: Sequence[Path]) -> str:
    """Return the line about the specs that were read, and one about values that are still the template's."""
    from .placeholders import short_notice

    read = look_up.read_line(families, report, packaged, packaged_files)
    return "\n".join(filter(None, (read, short_notice(report.files))))


def _check(chosen: argparse.Namespace) -> int:
    from .check_text import as_data, as_text
    from .earlier import SpecsRead, earlier

    if chosen.write and not chosen.coverage:
        raise Stop("--write needs --coverage", 2)
    paths = _specs_to_judge([*chosen.specs, *chosen.more_specs], "check", _cache(chosen)).paths
    if chosen.format in ("github", "sarif") and chosen.coverage:
        raise Stop(f"--format {chosen.format} lists problems only; leave --coverage out", 2)
    chosen.json = chosen.json or chosen.format == "json"
    before = earlier(_cache(chosen), "check", paths)
    known = None if chosen.coverage or chosen.target else before.get(SpecsRead)
    if known is not None:
        with _OTHER_FORM:
            report = before.report(known["files"])
            data = {"version": JSON_VERSION} | as_data(report)
            _print(chosen.json, lambda: data, lambda: as_text(known["families"], report, chosen.format))
            return 0
    from ..targets.registry import WITH_PROBLEMS
    from . import check, coverage
    from .outputs import are_built_in, targets_named

    targets = targets_named(chosen.target, WITH_PROBLEMS)
    with Progress("codewheel: checking the specs"):
        found = check.run(paths, targets, None if chosen.coverage else _cache(chosen))
    names = [family.device.name for family in found.families]
    covered = coverage.cover(found, chosen.write) if chosen.coverage else []
    counts = coverage.as_data(covered) if chosen.coverage else {}
    data = {"version": JSON_VERSION} | as_data(found.report) | counts
    _print(chosen.json, lambda: data, lambda: as_text(names, found.report, chosen.format))
    if chosen.coverage and not chosen.json:
        print(coverage.as_text(covered, found))
    if not found.report and are_built_in(targets, WITH_PROBLEMS):
        before.put({"families": names, "files": found.report.files})
    return 0 if coverage.is_complete(covered, found.report) else 1


def _list(chosen: argparse.Namespace) -> int:
    from .listing import Row, as_data, as_text, rows, without_repeated

    def rows_of(paths: Sequence[Path]) -> list[Row]:
        before = earlier(_cache(chosen), "list", paths)
        known: list[Row] | None = before.get(list[Row])
        if not known:
            known = rows(look_up.load(paths))
            before.put(known)
        return known

    from .earlier import earlier

    specs = _specs_to_read([*chosen.specs, *chosen.more_specs], _cache(chosen))
    families = without_repeated(*map(rows_of, specs.groups))
    _print(chosen.json, lambda: as_data(families), lambda: as_text(families))
    return 0


def _show(chosen: argparse.Namespace) -> int:
    specs = _specs_to_read(chosen.specs, _cache(chosen))
    device, match, paths = look_up.family_or_code(specs, chosen.what, _cache(chosen))
    if chosen.edition is not None:
        from .editions import asked_for

        device, match, _ = asked_for(paths, device, match, chosen.edition, chosen.what, {})
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

    chosen.specs = _specs_to_judge(chosen.specs, "reread OLD NEW", _cache(chosen)).paths
    return run(chosen)


def _facts(chosen: argparse.Namespace) -> int:
    from .reread import run_facts

    chosen.specs = _specs_to_judge(chosen.specs, "facts FAMILY", _cache(chosen)).paths
    return run_facts(chosen)


def _simulate(chosen: argparse.Namespace) -> int:
    from .simulate import run

    return run(chosen, _specs_to_read(chosen.specs, _cache(chosen)), _cache(chosen))


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
        for path in write_spec(chosen.name, chosen.output, chosen.like):
            print(f"written    {path.as_posix()}")
    except NameRefused as error:
        raise Stop(str(error), 2) from None
    except NotWritten as error:
        raise Stop(str(error), 1) from None
    return 0


def _migrate(chosen: argparse.Namespace) -> int:
    from .migrate import run

    return run(_specs_to_judge(chosen.specs, "migrate", _cache(chosen)).paths, chosen.check)


def _master(chosen: argparse.Namespace) -> int:
    from .master import run

    code, data = run(chosen, _cache(chosen))
    print(data if isinstance(data, str) else json.dumps(data, indent=2, ensure_ascii=False))
    return code


def _decode(chosen: argparse.Namespace) -> int:
    from ..order_codes.reduction import reduced_to_codes
    from ..order_codes.run_time import RegisterError, with_answers, with_registers
    from ..reference.findings import compare_held, fixed_addresses
    from .choose import answers_of
    from .decode_run import Decoding, Request, frames

    specs = _specs_to_read(chosen.specs, _cache(chosen))
    device, found, paths = look_up.order_code(specs, chosen.order_code, _cache(chosen))
    match, held = found, held_bytes(chosen.register)
    if chosen.edition is not None:
        from .editions import asked_for

        device, again, held = asked_for(paths, device, found, chosen.edition, chosen.order_code, held)
        match = again or found
    answers = answers_of(device, match.variant, chosen.choose)
    fixed = fixed_addresses(device, match.variant)
    changing = {address: value for address, value in held.items() if address not in fixed}
    try:
        variant = with_answers(device, with_registers(device, match.variant, changing), answers)
    except RegisterError as error:
        raise Stop(str(error), 2) from None
    others = compare_held(device, match.variant, held)
    match = replace(match, variant=variant)
    device = reduced_to_codes(device, [variant.code])
    asked = Request(device, match, chosen.sender, chosen.layout, chosen.register_name, chosen.json, others, answers)
    decoding = Decoding(asked)
    try:
        decoding.run(frames(chosen.frame))
    except BrokenPipeError:
        release()
    return decoding.code


def _explain(chosen: argparse.Namespace) -> int:
    from .explain import explain

    print(explain(chosen.rule))
    return 0


_RUNS: Mapping[str, Callable[[argparse.Namespace], int]] = {
    "generate": _generate,
    "check": _check,
    "list": _list,
    "show": _show,
    "decode": _decode,
    "master": _master,
    "simulate": _simulate,
    "diff": _diff,
    "reread": _reread,
    "facts": _facts,
    "explain": _explain,
    "new": _new,
    "migrate": _migrate,
}
