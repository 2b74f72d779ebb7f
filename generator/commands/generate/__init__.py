"""``codewheel generate``: write the outputs for the specs, or check whether they are up to date."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, TypedDict

from ...say import count_with_unit
from ..cli import Parser, a_path, add_cache_option, add_specs, cache_for
from ..terminal import CommandError, Progress, error_after_printing

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from ...cache import Cache, CachedResult
    from ...language.problems import ProblemReport
    from ...loading.library import Family
    from ...model import Device
    from ...targets import Library, Options, Target
    from .selection import Selection
#: The files of each target, as texts by path.
Files = Mapping[str, Mapping[str, str]]
#: The families of each target, as ``owners`` returns them.
Families = Mapping[str, Sequence[str]]
EXAMPLES = (
    "codewheel generate",
    "codewheel generate my_encoder.yaml -o out --target c",
    "codewheel generate --check",
)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Write all outputs of the specs."
    add_specs(parser)
    _add_selection(parser)
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
    parser.more_help = _targets_help


def _add_selection(parser: argparse.ArgumentParser) -> None:
    """Add the options about what is written, and where."""
    parser.add_argument(
        "-o",
        dest="output",
        type=a_path,
        metavar="DIR",
        help="output folder (default: the folder set in [tool.codewheel], otherwise 'generated')",
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


def _add_own_files(parser: argparse.ArgumentParser) -> None:
    """Add the options that name files of the user."""
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
        help="validate the idbiss files against your copy of idbiss.dtd, and exit 1 if a file is not valid",
    )
    add_cache_option(parser)


def _targets_help() -> str:
    from ..outputs import targets_help

    return targets_help()


def run(arguments: argparse.Namespace) -> int:
    """Write or compare all outputs, and return the exit code.

    Nothing is rendered if an earlier run with the same specs and options wrote the files that are in the output folder.

    Raises:
        CommandError: The specs or the arguments have problems, a target fails, or the output differs or cannot be
            written.
    """
    from .selection import select_specs

    cache = cache_for(arguments)
    selection = select_specs(arguments, cache)
    cached_run = _result_of_earlier_run(arguments, selection, cache)
    if repeat_output_if_unchanged(arguments, cached_run.get()):
        return 0
    return _render_and_write(arguments, cache, selection, cached_run)


def _refuse_unproved_specs(arguments: argparse.Namespace, families: Sequence[Family], cache: Cache) -> None:
    """Raise ``CommandError`` if a spec must not be released, unless there is ``--unchecked``."""
    from ..check.specs import refuse_unproved

    if not arguments.unchecked:
        refuse_unproved(families, "written", cache)


def _render_and_write(arguments: argparse.Namespace, cache: Cache, selection: Selection, result: CachedResult) -> int:
    """Render the outputs, store the result, write or compare the files, and return the exit code."""
    from ...loading.library import load_families
    from ...targets import Library
    from .. import outputs
    from ..outputs import owners
    from ..read_specs import report_unknown_families
    from .files import write_or_compare

    with Progress("codewheel: reading the specs"):
        families, report = load_families(selection.paths, cache)
    targets = outputs.targets_named(arguments.target)
    devices_in_specs = [family.device for family in families]
    report_unknown_families(selection.settings, [device.name for device in devices_in_specs], report)
    # Only the C headers have an option that depends on the families.
    c_families = [device.name for device in outputs.accepted_devices("c", devices_in_specs, selection.only)]
    options = outputs.options_named(selection.options_for(c_families), targets)
    _refuse_misused_options(arguments, targets)
    with Progress("codewheel: checking the specs"):
        devices = outputs.complete_devices(
            families, targets, editions=arguments.edition, report=report, filters=selection.only
        )
    if report:
        raise error_after_printing(report)
    specs_line = _line_about_specs(devices, report, arguments.packaged, selection.packaged)
    print(specs_line)
    target_names = [target.name for target in targets]
    accepted_devices_by_target = outputs.devices_by_target(target_names, devices, selection.only)
    library = Library(devices, arguments.templates)
    files = _render_targets(library, accepted_devices_by_target, targets, options=options, cache=cache)
    families_by_target = {name: owners(accepted) for name, accepted in accepted_devices_by_target.items()}
    if outputs.are_built_in(targets, arguments.target):
        result.put(result_to_store(specs_line, files, families_by_target))
    refuse_unproved_specs = partial(_refuse_unproved_specs, arguments, families, cache)
    guard = selection.guard(arguments, devices, report.files)
    return write_or_compare(arguments, files, families_by_target, gate=refuse_unproved_specs, guard=guard)


def _result_of_earlier_run(arguments: argparse.Namespace, selection: Selection, cache: Cache) -> CachedResult:
    """Return the result of an earlier run with the same specs and options, which may be missing.

    With templates of the user or ``--biss-dtd``, no result is stored.
    """
    from ...cache import NO_CACHE, CachedResult
    from ...loading.configuration import filters_as_texts

    # Empty texts separate the lists, so that the same values in other lists lead to another key.
    options = [*(arguments.target or ()), "", *selection.options, "", *arguments.edition, "", *arguments.packaged, ""]
    options += filters_as_texts(selection.only)
    is_cacheable = arguments.templates is None and arguments.biss_dtd is None
    return CachedResult(cache if is_cacheable else NO_CACHE, "generate", selection.paths, options=options)


def _refuse_misused_options(arguments: argparse.Namespace, targets: Sequence[Target]) -> None:
    """Refuse ``--templates`` with a folder that does not exist, and ``--biss-dtd`` without the target ``biss``.

    Raises:
        CommandError: The exit code is 2.
    """
    if arguments.templates is not None and not arguments.templates.is_dir():
        raise CommandError(f"there is no folder {arguments.templates}", 2)
    if arguments.biss_dtd is not None and all(target.name != "biss" for target in targets):
        raise CommandError("--biss-dtd needs the target biss", 2)


def _line_about_specs(
    devices: Sequence[Device], report: ProblemReport, packaged: Sequence[str], packaged_files: Sequence[Path]
) -> str:
    """Return a line about the specs that were read, and a second line if they contain values of ``codewheel new``.

    ``packaged`` are the names given with ``--packaged``, and ``packaged_files`` the specs of these names.
    """
    from ..check import specs_read_line
    from ..new import placeholder_line

    specs_line = specs_read_line([device.name for device in devices], report, packaged, packaged_files)
    todo_line = placeholder_line(report.files)
    return f"{specs_line}\n{todo_line}" if todo_line else specs_line


def _render_targets(
    library: Library,
    accepted_devices_by_target: Mapping[str, tuple[Device, ...]],
    targets: Sequence[Target],
    *,
    options: Mapping[str, Options],
    cache: Cache,
) -> dict[str, Mapping[str, str]]:
    """Return the files of each target, as ``{target: {path: text}}``.

    Parts of unchanged families come from the cache. A target writes the devices that it accepts.
    """
    from ...targets.registry import files_of
    from ..outputs import FamilyParts, render_targets

    render_target = FamilyParts(cache).files_of if cache else files_of
    with Progress("codewheel: rendering") as progress:

        def render_with_progress(target: Target, library: Library, target_options: Options) -> Mapping[str, str]:
            progress.text = f"codewheel: rendering {target.name}"
            library_of_target = replace(library, devices=accepted_devices_by_target[target.name])
            return render_target(target, library_of_target, target_options)

        return render_targets(library, targets, options, render_with_progress)


# -- result of a run, which a later run with the same input repeats


class Generated(TypedDict):
    """Result of a run: the line about the specs, the targets, and the number and digest of their files."""

    read_line: str
    targets: list[str]
    count: int
    digest: str


def repeat_output_if_unchanged(arguments: argparse.Namespace, generated: Generated | None) -> bool:
    """Repeat the output of an earlier run, and return True, if the files on the disk come from it.

    ``generated`` is the result of that run, or None if there is none with the same input.
    """
    from ...write_and_remove import digest_on_disk

    if generated is None or digest_on_disk(arguments.output, generated["targets"]) != generated["digest"]:
        return False
    print(generated["read_line"])
    print_summary(arguments, generated["count"], changed_count=0)
    return True


def result_to_store(specs_read_line: str, files: Files, families: Families) -> Generated:
    """Return the result of a run that rendered these files."""
    from ...write_and_remove import digest_of

    count = sum(map(len, files.values()))
    return Generated(read_line=specs_read_line, targets=list(files), count=count, digest=digest_of(files, families))


def print_summary(arguments: argparse.Namespace, file_count: int, changed_count: int) -> None:
    """Print the number of files. With ``--check``, raise ``CommandError`` with code 1 if some of them differ."""
    if arguments.check and changed_count:
        raise CommandError(f"{count_with_unit(changed_count, 'file')} out of date; run: {arguments.again}", 1)
    if arguments.check:
        print(f"{count_with_unit(file_count, 'file')} up to date")
    elif changed_count:
        print(f"{count_with_unit(changed_count, 'file')} changed, {file_count - changed_count} unchanged")
    else:
        print(f"all {file_count} files unchanged")
