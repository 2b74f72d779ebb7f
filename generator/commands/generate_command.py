"""``codewheel generate``: its arguments, and its run from the specs to the files.

``selection`` finds the specs and the output folder, ``outputs`` renders, and ``generate`` writes or compares.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .arguments import Parser, a_path, add_cache_option, add_specs
from .terminal import Progress, Stop, problems

if TYPE_CHECKING:
    import argparse

    from ..cache import Cache
    from ..language.problems import Report
    from ..loading.library import Family
    from ..model import Device
    from ..parts import Rendering
    from ..targets import Target
    from .earlier import Earlier, Hashes, Models
    from .selection import Selection

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
        help="validate the idbiss files against FILE, your copy of idbiss.dtd, and exit 1 if one is not valid",
    )
    add_cache_option(parser)


def _targets_help() -> str:
    from .outputs import listing

    return listing()


@dataclass(frozen=True)
class _Run:
    """The arguments of a run, the specs and options that follow from them, and the results of earlier runs."""

    chosen: argparse.Namespace
    cache: Cache
    selection: Selection
    results: Earlier

    def read_line(self, families: Sequence[str], report: Report) -> str:
        """Return the line about the specs that were read, and one about values that are still the template's."""
        from .read_specs import placeholder_line, read_line

        read = read_line(families, report, self.chosen.packaged, self.selection.packaged)
        return "\n".join(filter(None, (read, placeholder_line(report.files))))

    def is_unchanged(self, hashes: Hashes, families: Sequence[str], report: Report) -> bool:
        """Return whether the output has the files with these hashes, and print the result if so."""
        from .generate import is_unchanged

        read = self.read_line(families, report)
        return is_unchanged(self.chosen, hashes["hashes"], hashes["owners"], read, self.cache)


def run(chosen: argparse.Namespace) -> int:
    """Write or compare all outputs, and return the exit code.

    Raises:
        Stop: There are problems in the specs, an argument is wrong, or a file differs or cannot be written.
    """
    from .earlier import earlier
    from .read_specs import cache_for
    from .selection import selected

    cache = cache_for(chosen)
    selection = selected(chosen, cache)
    options = [*(chosen.target or ()), "", *selection.options, "", *chosen.edition]
    current = _Run(chosen, cache, selection, earlier(cache, "generate", selection.paths, options))
    if _is_unchanged_with_same_files(current):
        return 0
    from ..loading.library import load_families

    with Progress("codewheel: reading the specs"):
        families, report = load_families(selection.paths, cache)
    models = current.results.of_models([family.digest for family in families])
    if _is_unchanged_with_same_models(current, families, report, models):
        return 0
    return _generate(current, families, report, models)


#: An entry of the cache with another form than ours is ignored, and the command does its work.
_OTHER_FORM = (LookupError, TypeError, AttributeError, ValueError)


def _is_unchanged_with_same_files(current: _Run) -> bool:
    """Return whether the specs have not changed since an earlier run, nor the outputs, and print the result if so."""
    from .earlier import Generated

    if current.chosen.templates is not None or current.chosen.biss_dtd is not None:
        return False
    generated: Generated | None = current.results.get(Generated)
    if generated is None:
        return False
    with suppress(*_OTHER_FORM):
        report = current.results.report(generated["files"])
        return current.is_unchanged(generated, generated["families"], report)
    return False


def _is_unchanged_with_same_models(current: _Run, families: Sequence[Family], report: Report, models: Models) -> bool:
    """Return whether the models are those of an earlier run, with the same outputs, and print the result if so."""
    from .earlier import Hashes

    chosen = current.chosen
    if report or chosen.edition or chosen.templates is not None or chosen.biss_dtd is not None:
        return False
    hashes: Hashes | None = models.get(Hashes)
    if hashes is None:
        return False
    names = [family.device.name for family in families]
    with suppress(*_OTHER_FORM):
        if current.is_unchanged(hashes, names, report):
            current.results.put({"families": names, "files": report.files, **hashes})
            return True
    return False


def _generate(current: _Run, families: Sequence[Family], report: Report, models: Models) -> int:
    """Render all outputs, store their hashes, write or compare them, and return the exit code."""
    from ..owners import owners
    from ..write import hashes
    from . import generate
    from .outputs import are_built_in, targets_named

    chosen = current.chosen
    progress = Progress("codewheel: checking the specs")
    with _begin_rendering(current, families, report, progress) as rendering:
        targets = targets_named(chosen.target)
        devices, files = _check_and_render(current, families, report, targets, rendering, progress)
    if chosen.templates is None and are_built_in(targets, chosen.target):
        names = [device.name for device in devices]
        result = {"hashes": {name: hashes(texts) for name, texts in files.items()}, "owners": owners(devices)}
        current.results.put({"families": names, "files": report.files, **result})
        models.put(result)

    def gate() -> None:
        from .check.coverage import refuse_unproved

        refuse_unproved(families, "written", current.cache)

    return generate.run(chosen, files, gate, current.selection.guard(chosen, devices, report.files))


def _begin_rendering(current: _Run, families: Sequence[Family], report: Report, progress: Progress) -> Rendering:
    """Begin to render in other processes, unless the run will end with problems.

    These processes do not know the user's templates and options.
    """
    from ..loading.stored import digest_of
    from ..parts import Kept, Rendering
    from ..targets.registry import BUILT_IN

    chosen = current.chosen
    targets_with_options = {setting.partition(".")[0] for setting in current.selection.options}
    names = dict.fromkeys(chosen.target or BUILT_IN)
    plain_targets = [name for name in names if name in BUILT_IN and name not in targets_with_options]
    devices = [family.device for family in families]
    if chosen.no_cache:
        digests = {family.device.name: family.digest for family in families}
    else:
        digests = {family.device.name: family.digest or digest_of(family.device) for family in families}
    cannot_begin = bool(report) or chosen.templates is not None
    return Rendering(devices, [] if cannot_begin else plain_targets, Kept(current.cache, digests, progress.report_part))


def _check_and_render(
    current: _Run,
    families: Sequence[Family],
    report: Report,
    targets: Sequence[Target],
    rendering: Rendering,
    progress: Progress,
) -> tuple[Sequence[Device], Mapping[str, Mapping[str, str]]]:
    """Check that the targets can express the specs, and return the devices and the files of each target.

    Raises:
        Stop: There are problems in the specs, or an argument is wrong.
    """
    from ..targets import Library
    from .outputs import complete, options_named, rendered

    chosen = current.chosen
    options = options_named(current.selection.options_for([family.device.name for family in families]), targets)
    if chosen.templates is not None and not chosen.templates.is_dir():
        raise Stop(f"there is no folder {chosen.templates}", 2)
    if chosen.biss_dtd is not None and all(target.name != "biss" for target in targets):
        raise Stop("--biss-dtd needs the target biss", 2)
    with progress:
        devices = complete(families, targets, chosen.edition, report)
    if report:
        raise problems(report)
    print(current.read_line([device.name for device in devices], report))
    with progress:
        files = rendered(Library(devices, chosen.templates), targets, options, rendering)
    return devices, files
