"""Find the specs, the family or the order code that the user named."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..say.numbers import counted, first_of
from .terminal import Stop, problems

if TYPE_CHECKING:
    from ..cache import Cache
    from ..language.problems import Report
    from ..model import Device
    from ..order_codes.labels import Match
    from .which_specs import Specs

_MOST_FILES = 8


def load(paths: Sequence[Path]) -> tuple[Device, ...]:
    """Return the devices of the specs, and print problems to standard error.

    Raises:
        Stop: There are problems. The exit code is 1.
    """
    from ..loading.library import load_library

    devices, report = load_library(paths)
    if report:
        raise problems(report)
    return devices


def read_line(
    families: Iterable[str], report: Report, packaged: Sequence[str] = (), packaged_files: Sequence[Path] = ()
) -> str:
    """Return one line that names the specs that were read, so that users notice a forgotten path.

    ``packaged`` are the names given with ``--packaged``, and ``packaged_files`` the specs of these names.
    """
    passed_over = [file for file in report.passed_over if file not in report.files]
    others = f"; skipped: {first_of(passed_over, _MOST_FILES)}" if passed_over else ""
    if not packaged:
        return f"read {counted(len(report.files), 'spec')}: {first_of(report.files, _MOST_FILES)}{others}"
    packaged_names = {path.stem for path in packaged_files}
    packaged_folders = {os.path.realpath(path.parent) for path in packaged_files}
    own_files = [file for file in report.files if os.path.dirname(os.path.realpath(file)) not in packaged_folders]
    own = f", and {counted(len(own_files), 'spec')} of yours: {first_of(own_files, _MOST_FILES)}" if own_files else ""
    read_names = ", ".join(name for name in families if name in packaged_names)
    return f"read the packaged specs of {', '.join(packaged)}: {read_names}{own}{others}"


#: A family, the order code in it (None if the family was named), and the specs in which it was found.
Located = tuple["Device", "Match | None", Sequence[Path]]


def order_code(specs: Specs, text: str, cache: Cache) -> tuple[Device, Match, Sequence[Path]]:
    """Return the family and variant of an order code, and the specs with it. Few families are loaded if possible.

    The user's specs come first. If their text does not show which families are possible, all of them are loaded. Specs
    with problems are then omitted and listed.

    Raises:
        Stop: There is no such code (exit code 2), or no valid spec has it and others have problems (exit code 1).
    """
    device, match, paths = _located(specs, text, cache, is_name=False)
    if match is None:  # Only a name has no match.
        raise _unknown([device], text)
    return device, match, paths


def family_or_code(specs: Specs, text: str, cache: Cache) -> Located:
    """Return a family by its name, or the family and variant of an order code, like ``order_code``.

    Raises:
        Stop: As for ``order_code``.
    """
    return _located(specs, text, cache, is_name=True)


def _located(specs: Specs, text: str, cache: Cache, is_name: bool) -> Located:
    """Return the family or order code of the first group that has it, and report that a later group also has it."""
    skipped: list[Report] = []
    for index, paths in enumerate(specs.groups):
        found = _in_group(paths, text, cache, is_name, skipped)
        if found is None:
            continue
        _refuse_hidden(found[0], skipped)
        for report in skipped:
            _report_skipped(report)
        if any(_has(group, found[0].name, text, cache, is_name) for group in specs.groups[index + 1 :]):
            print(f"codewheel: {text} is in your specs and in the packaged ones; yours are used", file=sys.stderr)
        return (*found, paths)
    raise _not_found(specs, text, cache, is_name)


def _has(paths: Sequence[Path], family: str, text: str, cache: Cache, is_name: bool) -> bool:
    """Return True if a group also has the family, or the order code or name."""
    from ..loading.selected import has_family

    return has_family(paths, family) or _in_group(paths, text, cache, is_name, []) is not None


def _in_group(
    paths: Sequence[Path], text: str, cache: Cache, is_name: bool, skipped: list[Report]
) -> tuple[Device, Match | None] | None:
    """Return the family or order code in a group of specs, or None. Reports of specs with problems are added."""
    from ..loading.selected import families_for

    selected = families_for(paths, text, cache)
    matches = _matches(selected, text, is_name) if selected is not None else None
    # Several may share an order code by mistake, which only the check of all specs finds.
    if matches is not None and len(matches) < 2:
        return matches[0] if matches else None
    from ..loading.library import load_sound

    devices, report = load_sound(paths)
    if report:
        skipped.append(report)
    return _match(devices, text, is_name)


def _match(devices: Sequence[Device], text: str, is_name: bool) -> tuple[Device, Match | None] | None:
    """Return the family with this name, or the order code with the shortest tail after it, or None."""
    found = _matches(devices, text, is_name)
    return min(found, key=lambda item: len(item[1].tail) if item[1] is not None else 0) if found else None


def _matches(devices: Sequence[Device], text: str, is_name: bool) -> list[tuple[Device, Match | None]]:
    """Return the family with this name, or all families with the order code."""
    from ..order_codes.labels import UnknownOrderCode
    from ..order_codes.labels import find as find_in

    family = _family(devices, text) if is_name else None
    if family is not None:
        return [(family, None)]
    found: list[tuple[Device, Match | None]] = []
    for device in in_order(devices, text):
        with suppress(UnknownOrderCode):
            found.append((device, find_in(device, text)))
    return found


def _refuse_hidden(device: Device, skipped: Iterable[Report]) -> None:
    """Refuse a packaged family if the user has a spec of that name, but with problems.

    Raises:
        Stop: The exit code is 1.
    """
    for report in skipped:
        if device.name in {Path(file).stem for file in report.faulty_files}:
            raise problems(report)


def _report_skipped(report: Report) -> None:
    files = list(dict.fromkeys(problem.file for problem in report.problems))
    left_out = f"skipped, with {counted(len(report), 'problem')}: {first_of(files, _MOST_FILES)}; run codewheel check"
    print(f"codewheel: {left_out}", file=sys.stderr)


def _not_found(specs: Specs, text: str, cache: Cache, is_name: bool) -> Stop:
    """Return the reason why no group has the text: problems in a spec, or the nearest codes of all families."""
    from ..loading.library import load_sound
    from ..loading.shipped import packaged_families

    devices: list[Device] = []
    for paths in specs.groups:
        sound, report = load_sound(paths)
        if report:
            return problems(report)
        devices += sound
    reason = _unknown(devices, text)
    if not specs.packaged and _in_group(packaged_families(), text, cache, is_name, []):
        return Stop(f"{reason}; the packaged specs have it, so leave out the names of specs", reason.code)
    return reason


def find(devices: Sequence[Device], text: str) -> tuple[Device, Match]:
    """Return the family and variant of an order code among ``devices``, with the shortest tail after the code.

    Raises:
        Stop: There is no such code. The exit code is 2.
    """
    found = _match(devices, text, is_name=False)
    if found is None or found[1] is None:
        raise _unknown(devices, text)
    return found[0], found[1]


def in_order(devices: Sequence[Device], text: str) -> list[Device]:
    """Return the families that may have the order code ``text``, first the special models with its suffix.

    Other special models and older editions are left out, since they share order codes with a family.
    """
    code = "".join(text.split()).upper()
    special = [
        item for item in devices if any(code.endswith(f"/{over.special}") for over in item.overlays if over.special)
    ]
    return [*special, *(item for item in devices if not item.base)]


def _unknown(devices: Sequence[Device], text: str) -> Stop:
    """Return the reason why text is not an order code of any of these families."""
    from ..language.files import SUFFIXES
    from ..order_codes import messages
    from ..order_codes.labels import NEAR, closest_reason, nearest_codes

    reason = closest_reason(in_order(devices, text), text)
    if reason is not None:
        return Stop(reason, 2)
    device = _family(devices, text)
    if device is not None:
        code = device.variants[0].code
        return Stop(f"{messages.family(text, code)} (codewheel show {device.name} explains them)", 2)
    if Path(text).suffix in SUFFIXES:
        return Stop(f"'{text}' is not an order code; give a spec as --specs {text}", 2)
    near = ", ".join(nearest_codes(devices, text, NEAR))
    remedy = messages.nearest(near) if near else "; codewheel list shows the known patterns"
    return Stop(messages.unknown(text) + remedy, 2)


def _family(devices: Sequence[Device], text: str) -> Device | None:
    return next((device for device in devices if device.name == text.strip().lower()), None)
