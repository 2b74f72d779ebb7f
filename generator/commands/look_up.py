"""From what the user named to devices: the specs to read, a family, an order code."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ..language.files import SUFFIXES, own_specs
from ..say.words import counted
from .terminal import Stop

if TYPE_CHECKING:
    from ..language.problems import Report
    from ..model import Device
    from ..order_codes.labels import Match

#: From this likeness on, of 1, a code is worth naming as the nearest.
_NEAR = 0.4
_MOST_FILES = 8


def load(paths: Sequence[Path]) -> tuple[Device, ...]:
    """The devices of the specs; problems go to standard error.

    Raises:
        Stop: There are problems, exit code 1, or there is no such path; 2.
    """
    from ..loading.library import load_library

    refuse_missing(paths)
    devices, report = load_library(paths)
    if report:
        raise problems(report)
    return devices


def refuse_missing(paths: Sequence[Path]) -> None:
    """What is not there was not meant.

    Raises:
        Stop: There is nothing at one of the paths; exit code 2.
    """
    missing = [str(path) for path in paths if not _is_there(path)]
    if missing:
        raise Stop(f"there is no file or folder {' or '.join(missing)}", 2)


def _is_there(path: Path) -> bool:
    try:
        return path.exists() or path.is_symlink()
    except (OSError, ValueError):
        return True  # Something is; reading it says what is wrong.


def own_or_shipped(paths: Sequence[Path], say: bool = False) -> list[Path]:
    """The paths that were given, else the specs of the current folder, else none, which stands for those that ship.

    Args:
        paths: The paths that were given.
        say: Say on standard error that the specs of the current folder are taken.

    Raises:
        Stop: There is nothing at one of the paths; exit code 2.
    """
    refuse_missing(paths)
    own = list(paths) or own_specs(Path())
    if say and own and not paths:
        print(f"codewheel: reading the specs of this folder: {_listed([str(path) for path in own])}", file=sys.stderr)
    return own


def read_line(paths: Sequence[Path], devices: Sequence[Device], report: Report) -> str:
    """What was read, in one line: it shows a user who forgot a path."""
    if not paths:
        return f"read the specs that ship with codewheel: {', '.join(device.name for device in devices)}"
    passed_over = [file for file in report.passed_over if file not in report.files]
    others = f"; passed over: {_listed(passed_over)}" if passed_over else ""
    return f"read {counted(len(report.files), 'spec')}: {_listed(report.files)}{others}"


def _listed(files: Sequence[str]) -> str:
    more = len(files) - _MOST_FILES
    return ", ".join(files[:_MOST_FILES]) + (f" and {more} more" if more > 0 else "")


def order_code(specs: Sequence[Path], text: str) -> tuple[Device, Match]:
    """The family and variant of an order code; specs with problems are left out, and named.

    Raises:
        Stop: There is no such code, exit code 2, or the specs have problems and no sound one has it; 1.
    """
    with _sound(specs) as devices:
        return find(devices, text)


def family_or_code(specs: Sequence[Path], text: str) -> tuple[Device, Match | None]:
    """A family by its name, or the family and variant of an order code.

    Raises:
        Stop: As ``order_code`` does.
    """
    with _sound(specs) as devices:
        family = _family(devices, text)
        return (family, None) if family is not None else find(devices, text)


def find(devices: Sequence[Device], text: str) -> tuple[Device, Match]:
    """The family and variant of an order code among ``devices``.

    Raises:
        Stop: There is no such code; exit code 2.
    """
    from ..order_codes.labels import UnknownOrderCode
    from ..order_codes.labels import find as find_in

    explanation = ""
    for device in in_order(devices, text):
        try:
            return device, find_in(device, text)
        except UnknownOrderCode as reason:
            explanation = explanation or (str(reason) if reason.close else "")
    raise Stop(explanation or _unknown(devices, text), 2)


def in_order(devices: Sequence[Device], text: str) -> list[Device]:
    """The families that may have the order code ``text``: first one of special models, if the code ends as theirs do.

    Special models of another sort are not looked at, nor older editions: they share order codes with a family.
    """
    code = "".join(text.split()).upper()
    special = [
        item for item in devices if any(code.endswith(f"/{over.special}") for over in item.overlays if over.special)
    ]
    return [*special, *(item for item in devices if not item.base)]


def _unknown(devices: Sequence[Device], text: str) -> str:
    """What to say of a text that is no order code, nor nearly one."""
    from ..order_codes.labels import nearest_codes

    device = _family(devices, text)
    if device is not None:
        code = device.variants[0].code
        needed = f"an order code is needed, such as {code}; codewheel show {device.name} tells of them"
        return f"'{text}' is a family, and {needed}"
    if Path(text).suffix in SUFFIXES:
        return f"'{text}' is no order code; a spec is given as: --specs {text}"
    near = ", ".join(nearest_codes(devices, text, _NEAR))
    remedy = f"the nearest are {near}" if near else "codewheel list shows what they look like"
    return f"'{text}' is no known order code; {remedy}"


def _family(devices: Sequence[Device], text: str) -> Device | None:
    return next((device for device in devices if device.name == text.strip().lower()), None)


@contextmanager
def _sound(specs: Sequence[Path]) -> Iterator[tuple[Device, ...]]:
    """The devices that can be used; where nothing is found, problems of the specs are the likelier reason."""
    from ..loading.library import load_sound

    refuse_missing(specs)
    devices, report = load_sound(specs)
    try:
        yield devices
    except Stop:
        if report:
            raise problems(report) from None
        raise
    if report:
        files = list(dict.fromkeys(problem.file for problem in report.problems))
        left_out = f"left out, for {counted(len(report), 'problem')}: {_listed(files)}; codewheel check tells them"
        print(f"codewheel: {left_out}", file=sys.stderr)


def problems(report: Report) -> Stop:
    """All problems on standard error, and the end that they call for."""
    for problem in report.problems:
        print(problem.format(), file=sys.stderr)
    return Stop(counted(len(report), "problem"), 1)
