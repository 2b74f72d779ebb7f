"""``codewheel generate``: write the files of a library, or compare them."""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from ..cache import Cache
from ..known_files import KnownFiles
from ..owners import Guard, owners
from ..say.numbers import counted
from ..write import Change, WriteError, changes, is_as_written, left_stages, write
from .terminal import Stop

#: The files of each target, as texts by path.
Rendered = Mapping[str, Mapping[str, str]]


def run(chosen: argparse.Namespace, files: Rendered, gate: Callable[[], None], guard: Guard) -> int:
    """Write or compare the files of each target, and return the exit code.

    ``gate`` raises ``Stop`` to refuse writing specs that must not be released. It is called if a file would change.

    Raises:
        Stop: The disk fails, a file differs, or ``guard`` refuses the changes.
    """
    check: Callable[[Mapping[str, Sequence[Change]]], None] = (lambda _: None) if chosen.prune else guard.check
    try:
        if chosen.check:
            by_target = {name: changes(chosen.output, name, texts) for name, texts in files.items()}
            check(by_target)
            found = [item for of_target in by_target.values() for item in of_target] + left_stages(chosen.output)
        else:
            found = write(
                chosen.output,
                files,
                force=chosen.force,
                waiting=lambda: _tell_of_the_wait(chosen.output),
                gate=(lambda: None) if chosen.unchecked else gate,
                guard=check,
                families=owners(guard.devices),
            )
    except WriteError as error:
        raise Stop(str(error), 1) from None
    _tell(found, chosen)
    if chosen.biss_dtd is not None:
        _validate_idbiss(files["biss"], chosen.output, chosen.biss_dtd)
    return 0


def is_unchanged(
    chosen: argparse.Namespace, hashes: Rendered, families: Sequence[str], read: str, cache: Cache
) -> bool:
    """Return True if the files of each target have these hashes, and print ``read`` and the files.

    Otherwise, print nothing. ``families`` are those that the files were written from, as ``owners`` returns them.
    """
    known = KnownFiles(cache, "written files", [str(chosen.output)])
    if not is_as_written(chosen.output, hashes, known.result, families):
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
        _tell_of_a_mixture(found)
        raise Stop(f"{counted(stale, 'file')} out of date; run: {chosen.again}", 1)
    else:
        print(f"{counted(len(found), 'file')} up to date")


def _tell_of_a_mixture(found: Iterable[Change]) -> None:
    """Print which targets match the specs and which do not, as after a run that was killed between two targets."""
    states: dict[str, set[str]] = {}
    for item in found:
        target, is_in_a_target, _ = item.path.partition("/")
        if is_in_a_target:
            states.setdefault(target, set()).add(item.what)
    current = [target for target, state in states.items() if state == {"unchanged"}]
    outdated = [target for target, state in states.items() if state != {"unchanged"}]
    if current and outdated:
        print(f"up to date: {', '.join(current)}; out of date: {', '.join(outdated)}")


def command_again(chosen: argparse.Namespace, *more: str) -> str:
    """Return the command line that writes the outputs with the arguments that the user gave, and with ``more``."""
    again = ["codewheel", "generate", *map(str, [*chosen.specs, *chosen.more_specs]), *more]
    again += [word for name in chosen.packaged for word in ("--packaged", name)]
    again += [] if chosen.output is None else ["-o", str(chosen.output)]
    again += [word for name in chosen.target or () for word in ("--target", name)]
    again += [word for setting in chosen.option for word in ("--option", setting)]
    again += [] if chosen.templates is None else ["--templates", str(chosen.templates)]
    return shlex.join(again)


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
