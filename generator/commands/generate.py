"""``codewheel generate``: write the files of a library, or compare them."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..render import TemplateFault, unused_templates
from ..say.words import counted
from ..targets import Library, Options, Target, TargetError
from ..targets.registry import files_of, target_names
from ..write import Change, WriteError, changes, write
from .terminal import Stop


def run(
    chosen: argparse.Namespace,
    library: Library,
    targets: Sequence[Target],
    options: Mapping[str, Options],
    gate: Callable[[], None],
) -> int:
    """Write or compare all files of the targets, and return the exit code. ``options`` are by target name.

    ``gate`` raises ``Stop`` to refuse writing specs that must not be released. It is called if a file would change.

    Raises:
        Stop: A target, a template or the disk fails, or a file differs.
    """
    try:
        files = _files(library, targets, options)
        found = [item for name, texts in files.items() for item in changes(chosen.output, name, texts)]
        if not chosen.check:
            if not chosen.unchecked and any(item.what != "unchanged" for item in found):
                gate()
            found = write(chosen.output, files, chosen.force, lambda: _tell_of_the_wait(chosen.output))
    except (TargetError, TemplateFault, WriteError) as error:
        raise Stop(str(error), 1) from None
    words = {"written": "differs", "unchanged": "up to date", "removed": "left over"} if chosen.check else {}
    for item in found:
        print(f"{words.get(item.what, item.what):<10} {(chosen.output / item.path).as_posix()}")
    _sum_up(found, chosen)
    if chosen.biss_dtd is not None:
        _validate_idbiss(files["biss"], chosen.output, chosen.biss_dtd)
    return 0


def _tell_of_the_wait(output: Path) -> None:
    print(f"codewheel: waiting for another run that is writing to {output.as_posix()}", file=sys.stderr, flush=True)


def _files(library: Library, targets: Sequence[Target], options: Mapping[str, Options]) -> dict[str, Mapping[str, str]]:
    """Return the files of each target.

    Raises:
        TargetError: A target fails, or cannot express a device.
        TemplateFault: A user's template fails.
        Stop: The name of a user's template is misspelt.
    """
    files = {target.name: files_of(target, library, options[target.name]) for target in targets}
    if library.own_templates is not None:
        rendered = {target.name: target.templates for target in targets}
        unused = list(unused_templates(library.own_templates, rendered, target_names()))
        if unused:
            raise Stop("\n  ".join(["nothing written: these templates have no effect:", *unused]), 2)
    return files


def _sum_up(found: Sequence[Change], chosen: argparse.Namespace) -> None:
    stale = sum(item.what != "unchanged" for item in found)
    if not chosen.check:
        changed = f"{counted(stale, 'file')} changed, {len(found) - stale} unchanged"
        print(changed if stale else f"all {len(found)} files unchanged")
    elif stale:
        again = ["codewheel", "generate", *map(str, [*chosen.specs, *chosen.more_specs])]
        again += [] if chosen.output == Path("generated") else ["-o", str(chosen.output)]
        again += [word for name in chosen.target or () for word in ("--target", name)]
        again += [word for setting in chosen.option for word in ("--option", setting)]
        again += [] if chosen.templates is None else ["--templates", str(chosen.templates)]
        raise Stop(f"{counted(stale, 'file')} out of date; run: {shlex.join(again)}", 1)
    else:
        print(f"{counted(len(found), 'file')} up to date")


def _validate_idbiss(files: Mapping[str, str], output: Path, dtd: Path) -> None:
    """Validate every idbiss file against the document type ``dtd``.

    Raises:
        Stop: A file is not valid (exit code 1), or ``dtd`` cannot be used (exit code 2).
    """
    from ..targets.biss.dtd import DtdError, faults, read_dtd

    names = [name for name in files if Path(name).name.startswith("idbiss")]
    try:
        text = read_dtd(dtd)
        places = {name: (output / name).as_posix() for name in names}
        found = [fault for name in names for fault in faults(files[name], places[name], text, dtd.as_posix())]
    except DtdError as error:
        raise Stop(str(error), 2) from None
    for fault in found:
        print(fault, file=sys.stderr)
    if found:
        raise Stop(f"not valid against {dtd}: {counted(len(found), 'error')}", 1)
    for name in names:
        print(f"valid against {dtd}: {places[name]}")
