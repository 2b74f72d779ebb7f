"""``codewheel generate``: write the files of a library, or compare them."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..cache import Cache
from ..known_files import KnownFiles
from ..say.numbers import counted
from ..write import Change, WriteError, changes, is_as_written, write
from .terminal import Stop

#: The files of each target, as texts by path.
Rendered = Mapping[str, Mapping[str, str]]


def run(chosen: argparse.Namespace, files: Rendered, gate: Callable[[], None]) -> int:
    """Write or compare the files of each target, and return the exit code.

    ``gate`` raises ``Stop`` to refuse writing specs that must not be released. It is called if a file would change.

    Raises:
        Stop: The disk fails, or a file differs.
    """
    try:
        if chosen.check:
            found = [item for name, texts in files.items() for item in changes(chosen.output, name, texts)]
        else:
            asked = (lambda: None) if chosen.unchecked else gate
            found = write(chosen.output, files, chosen.force, lambda: _tell_of_the_wait(chosen.output), asked)
    except WriteError as error:
        raise Stop(str(error), 1) from None
    _tell(found, chosen)
    if chosen.biss_dtd is not None:
        _validate_idbiss(files["biss"], chosen.output, chosen.biss_dtd)
    return 0


def is_unchanged(chosen: argparse.Namespace, hashes: Rendered, read: str, cache: Cache) -> bool:
    """Return True if the files of each target have these hashes, and print ``read`` and the files.

    Otherwise, print nothing.
    """
    known = KnownFiles(cache, "written files", [str(chosen.output)])
    if not is_as_written(chosen.output, hashes, known.result):
        return False
    known.keep()
    print(read)
    _tell([Change(path, "unchanged") for files in hashes.values() for path in sorted(files)], chosen)
    return True


def _tell(found: Sequence[Change], chosen: argparse.Namespace) -> None:
    words = {"written": "differs", "removed": "left over"} if chosen.check else {}
    for item in found:
        if item.what != "unchanged":
            print(f"{words.get(item.what, item.what):<10} {(chosen.output / item.path).as_posix()}")
    _sum_up(found, chosen)


def _tell_of_the_wait(output: Path) -> None:
    print(f"codewheel: waiting for another run that is writing to {output.as_posix()}", file=sys.stderr, flush=True)


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
