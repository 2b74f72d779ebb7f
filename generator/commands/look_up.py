"""Find the specs, the family or the order code that the user named."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..say.numbers import counted, first_of
from .terminal import Stop

if TYPE_CHECKING:
    from ..cache import Cache
    from ..language.problems import Report
    from ..model import Device
    from ..order_codes.labels import Match

_MOST_FILES = 8


def load(paths: Sequence[Path]) -> tuple[Device, ...]:
    """Return the devices of the specs, and print problems to standard error.

    Raises:
        Stop: There are problems (exit code 1), or a path does not exist (exit code 2).
    """
    from ..loading.library import load_library

    refuse_missing(paths)
    devices, report = load_library(paths)
    if report:
        raise problems(report)
    return devices


def refuse_missing(paths: Sequence[Path]) -> None:
    """Check that all paths exist.

    Raises:
        Stop: A path does not exist. The exit code is 2.
    """
    missing = [str(path) for path in paths if not _is_there(path)]
    if missing:
        raise Stop(f"no such file or folder: {', '.join(missing)}", 2)


def _is_there(path: Path) -> bool:
    try:
        return path.exists() or path.is_symlink()
    except (OSError, ValueError):
        return True  # It exists, and reading it will report the error.


def own_or_shipped(paths: Sequence[Path], say: bool = False) -> list[Path]:
    """Return the given paths, else the specs in the current folder, else an empty list for the shipped ones.

    Args:
        paths: The paths that the user gave.
        say: Report on standard error that the specs in the current folder are used.

    Raises:
        Stop: A path does not exist. The exit code is 2.
    """
    refuse_missing(paths)
    from ..language.files import own_specs

    own = list(paths) or own_specs(Path())
    if say and own and not paths:
        named = first_of([str(path) for path in own], _MOST_FILES)
        print(f"codewheel: using the specs in this folder, not those of codewheel: {named}", file=sys.stderr)
    return own


def read_line(paths: Sequence[Path], families: Iterable[str], report: Report) -> str:
    """Return one line that names the specs that were read, so that users notice a forgotten path."""

    if not paths:
        return f"read the specs shipped with codewheel: {', '.join(families)}"
    passed_over = [file for file in report.passed_over if file not in report.files]
    others = f"; skipped: {first_of(passed_over, _MOST_FILES)}" if passed_over else ""
    return f"read {counted(len(report.files), 'spec')}: {first_of(report.files, _MOST_FILES)}{others}"


def order_code(specs: Sequence[Path], text: str, cache: Cache) -> tuple[Device, Match]:
    """Return the family and variant of an order code. Only the families that it may belong to are loaded.

    If none of these has the order code, all are loaded. Specs with problems are then omitted and listed.

    Raises:
        Stop: There is no such code (exit code 2), or no valid spec has it and others have problems (exit code 1).
    """
    refuse_missing(specs)
    selected = _only_match(_selected(specs, text, cache), text)
    if selected is not None:
        return selected
    with _sound(specs) as devices:
        return find(devices, text)


def family_or_code(specs: Sequence[Path], text: str, cache: Cache) -> tuple[Device, Match | None]:
    """Return a family by its name, or the family and variant of an order code, like ``order_code``.

    Raises:
        Stop: As for ``order_code``.
    """
    refuse_missing(specs)
    devices = _selected(specs, text, cache)
    family = _family(devices, text)
    selected = (family, None) if family is not None else _only_match(devices, text)
    if selected is not None:
        return selected
    with _sound(specs) as devices:
        family = _family(devices, text)
        return (family, None) if family is not None else find(devices, text)


def _selected(specs: Sequence[Path], text: str, cache: Cache) -> Sequence[Device]:
    from ..loading.selected import families_for

    return families_for(specs, text, cache)


def _only_match(devices: Sequence[Device], text: str) -> tuple[Device, Match] | None:
    """Return the only one of these families that has the order code, or None if there is none or more than one."""
    from ..order_codes.labels import UnknownOrderCode
    from ..order_codes.labels import find as find_in

    found = []
    for device in devices:
        with suppress(UnknownOrderCode):
            found.append((device, find_in(device, text)))
    return found[0] if len(found) == 1 else None


def find(devices: Sequence[Device], text: str) -> tuple[Device, Match]:
    """Return the family and variant of an order code among ``devices``, with the shortest tail after the code.

    Raises:
        Stop: There is no such code. The exit code is 2.
    """
    from ..order_codes.labels import UnknownOrderCode
    from ..order_codes.labels import find as find_in

    explanation, found = "", []
    for device in in_order(devices, text):
        try:
            found.append((device, find_in(device, text)))
        except UnknownOrderCode as reason:
            explanation = explanation or (str(reason) if reason.close else "")
    if found:
        return min(found, key=lambda item: len(item[1].tail))
    raise Stop(explanation or _unknown(devices, text), 2)


def in_order(devices: Sequence[Device], text: str) -> list[Device]:
    """Return the families that may have the order code ``text``, first the special models with its suffix.

    Other special models and older editions are left out, since they share order codes with a family.
    """
    code = "".join(text.split()).upper()
    special = [
        item for item in devices if any(code.endswith(f"/{over.special}") for over in item.overlays if over.special)
    ]
    return [*special, *(item for item in devices if not item.base)]


def _unknown(devices: Sequence[Device], text: str) -> str:
    """Return the message for text that is not an order code."""
    from ..language.files import SUFFIXES
    from ..order_codes import messages
    from ..order_codes.labels import NEAR, nearest_codes

    device = _family(devices, text)
    if device is not None:
        code = device.variants[0].code
        return f"{messages.family(text, code)} (codewheel show {device.name} explains them)"
    if Path(text).suffix in SUFFIXES:
        return f"'{text}' is not an order code; give a spec as --specs {text}"
    near = ", ".join(nearest_codes(devices, text, NEAR))
    remedy = messages.nearest(near) if near else "; codewheel list shows the known patterns"
    return messages.unknown(text) + remedy


def _family(devices: Sequence[Device], text: str) -> Device | None:
    return next((device for device in devices if device.name == text.strip().lower()), None)


@contextmanager
def _sound(specs: Sequence[Path]) -> Iterator[tuple[Device, ...]]:
    """Yield the usable devices. If the search then fails, report the problems in the specs instead."""
    from ..loading.library import load_sound

    devices, report = load_sound(specs)
    try:
        yield devices
    except Stop:
        if report:
            raise problems(report) from None
        raise
    if report:
        files = list(dict.fromkeys(problem.file for problem in report.problems))
        left_out = (
            f"skipped, with {counted(len(report), 'problem')}: {first_of(files, _MOST_FILES)}; run codewheel check"
        )
        print(f"codewheel: {left_out}", file=sys.stderr)


def problems(report: Report) -> Stop:
    """Print all problems to standard error, and return the ``Stop`` to raise."""

    for problem in report.shown:
        print(problem.format(), file=sys.stderr)
    return Stop(counted(len(report), "problem"), 1)
