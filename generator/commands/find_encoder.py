"""Find the family or the order code that the user named in the specs of a run."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..say.plain_text import counted, first_of
from .arguments import bytes_by_address
from .terminal import Stop, problems

if TYPE_CHECKING:
    import argparse

    from ..cache import Cache
    from ..language.problems import Report
    from ..model import Device
    from ..order_codes.labels import Match
    from .read_specs import Specs

#: Most files in a message.
_MOST_FILES = 8
#: A family, the order code in it (None if the family was named), and the specs in which it was found.
Located = tuple["Device", "Match | None", Sequence[Path]]


def find_order_code(specs: Specs, text: str, cache: Cache) -> tuple[Device, Match, Sequence[Path]]:
    """Return the family and variant of an order code, and the specs with it. Few families are loaded if possible.

    The user's specs come first. If their text does not show which families are possible, all of them are loaded. Specs
    with problems are then omitted and listed.

    Raises:
        Stop: There is no such code (exit code 2), or no valid spec has it and others have problems (exit code 1).
    """
    device, match, paths = _find(specs, text, cache, is_name=False)
    if match is None:  # Only a name has no match.
        raise _unknown([device], text)
    return device, match, paths


def find_requested(chosen: argparse.Namespace, specs: Specs, cache: Cache) -> tuple[Device, Match, dict[int, int]]:
    """Return the family and variant of ``ORDER-CODE`` in the edition of ``--edition``, and the bytes of ``--register``.

    Registers that served to infer the edition are omitted.

    Raises:
        Stop: As for ``find_order_code``, a byte is malformed, or the edition is not known. The exit code is then 2.
    """
    device, match, paths = find_order_code(specs, chosen.order_code, cache)
    register_bytes = bytes_by_address(chosen.register)
    if chosen.edition is None:
        return device, match, register_bytes
    from .encoder_options import in_requested_edition

    device, match_in_edition, register_bytes = in_requested_edition(
        paths, device, match, chosen.edition, chosen.order_code, register_bytes
    )
    return device, match_in_edition or match, register_bytes


def find_family_or_code(specs: Specs, text: str, cache: Cache) -> Located:
    """Return a family by its name, or the family and variant of an order code, like ``find_order_code``.

    Raises:
        Stop: As for ``find_order_code``.
    """
    return _find(specs, text, cache, is_name=True)


def _find(specs: Specs, text: str, cache: Cache, is_name: bool) -> Located:
    """Return the family or order code of the first group that has it, and report that a later group also has it."""
    skipped: list[Report] = []
    for index, paths in enumerate(specs.groups):
        family_and_code = _find_in_group(paths, text, cache, is_name, skipped)
        if family_and_code is None:
            continue
        device, match = family_and_code
        _refuse_hidden(device, skipped)
        for report in skipped:
            _report_skipped(report)
        later_groups = specs.groups[index + 1 :]
        if any(_group_has(group, device.name, text, cache, is_name) for group in later_groups):
            print(f"codewheel: {text} is in your specs and in the packaged ones; yours are used", file=sys.stderr)
        return device, match, paths
    raise _no_such_encoder(specs, text, cache, is_name)


def _group_has(paths: Sequence[Path], family: str, text: str, cache: Cache, is_name: bool) -> bool:
    """Return True if a group also has the family, or the order code or name."""
    from ..loading.stored import has_family

    return has_family(paths, family) or _find_in_group(paths, text, cache, is_name, []) is not None


def _find_in_group(
    paths: Sequence[Path], text: str, cache: Cache, is_name: bool, skipped: list[Report]
) -> tuple[Device, Match | None] | None:
    """Return the family or order code in a group of specs, or None. Reports of specs with problems are added."""
    from ..loading.stored import families_for

    selected = families_for(paths, text, cache)
    matches = _all_matches(selected, text, is_name) if selected is not None else None
    # Several may share an order code by mistake, which only the check of all specs finds.
    if matches is not None and len(matches) < 2:
        return matches[0] if matches else None
    from ..loading.library import load_sound

    devices, report = load_sound(paths)
    if report:
        skipped.append(report)
    return _best_match(devices, text, is_name)


def _best_match(devices: Sequence[Device], text: str, is_name: bool) -> tuple[Device, Match | None] | None:
    """Return the family with this name, or the order code with the shortest tail after it, or None."""
    return min(_all_matches(devices, text, is_name), key=_tail_length, default=None)


def _tail_length(family_and_code: tuple[Device, Match | None]) -> int:
    _, match = family_and_code
    return len(match.tail) if match is not None else 0


def _all_matches(devices: Sequence[Device], text: str, is_name: bool) -> list[tuple[Device, Match | None]]:
    """Return the family with this name, or all families with the order code."""
    from ..order_codes.labels import UnknownOrderCode
    from ..order_codes.labels import find as match_of

    family = _family(devices, text) if is_name else None
    if family is not None:
        return [(family, None)]
    matches: list[tuple[Device, Match | None]] = []
    for device in _candidates(devices, text):
        with suppress(UnknownOrderCode):
            matches.append((device, match_of(device, text)))
    return matches


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
    notice = f"skipped, with {counted(len(report), 'problem')}: {first_of(files, _MOST_FILES)}; run codewheel check"
    print(f"codewheel: {notice}", file=sys.stderr)


def _no_such_encoder(specs: Specs, text: str, cache: Cache, is_name: bool) -> Stop:
    """Return the reason why no group has the text: problems in a spec, or the nearest codes of all families."""
    from ..language.files import packaged_families
    from ..loading.library import load_sound

    devices: list[Device] = []
    for paths in specs.groups:
        group_devices, report = load_sound(paths)
        if report:
            return problems(report)
        devices += group_devices
    reason = _unknown(devices, text)
    if not specs.packaged and _find_in_group(packaged_families(), text, cache, is_name, []):
        return Stop(f"{reason}; the packaged specs have it, so leave out the names of specs", reason.code)
    return reason


def find_among(devices: Sequence[Device], text: str) -> tuple[Device, Match]:
    """Return the family and variant of an order code among ``devices``, with the shortest tail after the code.

    Raises:
        Stop: There is no such code. The exit code is 2.
    """
    device, match = _best_match(devices, text, is_name=False) or (None, None)
    if device is None or match is None:
        raise _unknown(devices, text)
    return device, match


def _candidates(devices: Sequence[Device], text: str) -> list[Device]:
    """Return the families that may have the order code ``text``, first the special models with its suffix.

    Other special models and older editions are left out, since they share order codes with a family.
    """
    code = "".join(text.split()).upper()
    special_models = [device for device in devices if _is_special_model(device, code)]
    return [*special_models, *(device for device in devices if not device.base)]


def _is_special_model(device: Device, code: str) -> bool:
    """Return whether a device is a special model whose suffix ends the code."""
    return any(overlay.special and code.endswith(f"/{overlay.special}") for overlay in device.overlays)


def _unknown(devices: Sequence[Device], text: str) -> Stop:
    """Return the reason why text is not an order code of any of these families."""
    from ..language.files import SUFFIXES
    from ..order_codes import labels
    from ..order_codes.labels import NEAR, closest_reason, nearest_codes

    reason = closest_reason(_candidates(devices, text), text)
    if reason is not None:
        return Stop(reason, 2)
    device = _family(devices, text)
    if device is not None:
        code = device.variants[0].code
        return Stop(f"{labels.family_instead_of_code(text, code)} (codewheel show {device.name} explains them)", 2)
    if Path(text).suffix in SUFFIXES:
        return Stop(f"'{text}' is not an order code; give a spec as --specs {text}", 2)
    near = ", ".join(nearest_codes(devices, text, NEAR))
    remedy = labels.nearest_codes_hint(near) if near else "; codewheel list shows the known patterns"
    return Stop(labels.unknown_code(text) + remedy, 2)


def _family(devices: Sequence[Device], text: str) -> Device | None:
    return next((device for device in devices if device.name == text.strip().lower()), None)
