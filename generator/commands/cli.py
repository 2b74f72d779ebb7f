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
from .terminal import Progress, Stop, prepare, release

if TYPE_CHECKING:
    from pathlib import Path

    from ..cache import Cache
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


def _cache(chosen: argparse.Namespace) -> Cache:
    from ..cache import Cache, default_folder

    return Cache(None if getattr(chosen, "no_cache", False) else default_folder())


def _specs_to_judge(named: Sequence[Path], command: str) -> Specs:
    specs = which_specs.specs_to_judge(named, command)
    refuse_unknown_targets(specs.settings)
    return specs


def _specs_to_read(named: Sequence[Path]) -> Specs:
    specs = which_specs.specs_to_read(named)
    refuse_unknown_targets(specs.settings)
    return specs


def _print(as_json: bool, data: Callable[[], Mapping[str, Any]], text: Callable[[], str]) -> None:
    print(json.dumps(data(), indent=2, ensure_ascii=False) if as_json else text())


def _generate(chosen: argparse.Namespace) -> int:
    from .generate import run

    return run(chosen, _cache(chosen))


def _check(chosen: argparse.Namespace) -> int:
    from ..cache import NO_CACHE
    from .cached_result import cached_result, report_of, specs_read
    from .check_text import as_data, as_text

    if chosen.write and not chosen.coverage:
        raise Stop("--write needs --coverage", 2)
    paths = _specs_to_judge([*chosen.specs, *chosen.more_specs], "check").paths
    if chosen.format in ("github", "sarif") and chosen.coverage:
        raise Stop(f"--format {chosen.format} lists problems only; leave --coverage out", 2)
    chosen.json = chosen.json or chosen.format == "json"
    cache = _cache(chosen)
    result = cached_result(NO_CACHE if chosen.coverage or chosen.target else cache, "check", paths)
    specs = result.get()
    if specs is not None:
        report = report_of(specs)
        data = {"version": JSON_VERSION} | as_data(report)
        _print(chosen.json, lambda: data, lambda: as_text(specs["families"], report, chosen.format))
        return 0
    from ..targets.registry import WITH_PROBLEMS
    from . import check, coverage
    from .outputs import are_built_in, targets_named

    targets = targets_named(chosen.target, WITH_PROBLEMS)
    with Progress("codewheel: checking the specs"):
        found = check.run(paths, targets, NO_CACHE if chosen.coverage else cache)
    names = [family.device.name for family in found.families]
    covered = coverage.cover(found, chosen.write) if chosen.coverage else []
    counts = coverage.as_data(covered) if chosen.coverage else {}
    data = {"version": JSON_VERSION} | as_data(found.report) | counts
    _print(chosen.json, lambda: data, lambda: as_text(names, found.report, chosen.format))
    if chosen.coverage and not chosen.json:
        print(coverage.as_text(covered, found))
    if not found.report and are_built_in(targets, WITH_PROBLEMS):
        result.put(specs_read(names, found.report))
    return 0 if coverage.is_complete(covered, found.report) else 1


def _list(chosen: argparse.Namespace) -> int:
    from .cached_result import cached_result
    from .listing import Row, as_data, as_text, rows, without_repeated

    def rows_of(paths: Sequence[Path]) -> list[Row]:
        result = cached_result(cache, "list", paths)
        stored_rows: list[Row] | None = result.get()
        if stored_rows is not None:
            return stored_rows
        new_rows = rows(look_up.load(paths))
        result.put(new_rows)
        return new_rows

    cache = _cache(chosen)
    specs = _specs_to_read([*chosen.specs, *chosen.more_specs])
    families = without_repeated(*map(rows_of, specs.groups))
    _print(chosen.json, lambda: as_data(families), lambda: as_text(families))
    return 0


def _show(chosen: argparse.Namespace) -> int:
    specs = _specs_to_read(chosen.specs)
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

    chosen.specs = _specs_to_judge(chosen.specs, "reread OLD NEW").paths
    return run(chosen)


def _facts(chosen: argparse.Namespace) -> int:
    from .reread import run_facts

    chosen.specs = _specs_to_judge(chosen.specs, "facts FAMILY").paths
    return run_facts(chosen)


def _simulate(chosen: argparse.Namespace) -> int:
    from .simulate import run

    return run(chosen, _specs_to_read(chosen.specs), _cache(chosen))


def _diff(chosen: argparse.Namespace) -> int:
    from .diff import run

    cache = _cache(chosen)
    return run(
        chosen,
        lambda old, new: import_module(f"{__package__}.changed_files").changed_files(old, new, cache),
        lambda families: import_module(f"{__package__}.coverage").refuse_unproved(families, "recorded", cache),
        cache,
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

    return run(_specs_to_judge(chosen.specs, "migrate").paths, chosen.check)


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

    specs = _specs_to_read(chosen.specs)
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
