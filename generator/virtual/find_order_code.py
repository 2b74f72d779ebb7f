"""Find the family and the variant of an order code for a virtual encoder."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from ..language.problems import ProblemReport
from ..loading.editions import revision_for
from ..loading.library import Family, families_without_problems, in_edition, load_families
from ..model import Device
from ..one_line.encoder import device_of_line
from ..one_line.parse import is_line
from ..order_codes.labels import LabelMatch, UnknownOrderCode, find_code


@cache
def _load_families(specs: tuple[Path, ...]) -> tuple[Family, ...]:
    """Return the families without problems, from these specs or from those shipped with codewheel.

    Raises:
        ValueError: There are none. The message has the problems of the specs.
    """
    families, report = load_families(specs or None)
    valid_families = tuple(families_without_problems(families, report))
    if not valid_families:
        raise ValueError("\n".join(problem.format() for problem in report.shown) or "there are no specs")
    return valid_families


def _has_special_code(device: Device, text: str) -> bool:
    """Return whether the text of an order code contains the code of a special model of the family."""
    return any(overlay.special and overlay.special in text for overlay in device.overlays)


def find_order_code(text: str, specs: tuple[Path, ...], edition: str) -> tuple[Device, LabelMatch]:
    """Return the family and the variant of an order code, or of an encoder in one line.

    Families of the special model in the text come first. Others with a ``base`` are left out, since they share the
    order codes of that family.

    Raises:
        ValueError: There is no such order code or edition, no spec is valid, or the line has a problem. For an unknown
            order code, the message comes from the last family that is ``close``, or else from the first family.
    """
    if is_line(text):
        if edition:
            raise ValueError("an encoder in one line has no editions; leave the edition out")
        return device_of_line(text)
    reason = ""
    special_families = [family for family in _load_families(specs) if _has_special_code(family.device, text)]
    ordinary_families = [family for family in _load_families(specs) if not family.device.base]
    for family in (*special_families, *ordinary_families):
        try:
            match = find_code(family.device, text)
        except UnknownOrderCode as error:
            if error.close or not reason:
                reason = str(error)
            continue
        if not edition:
            return family.device, match
        report = ProblemReport()
        family_in_edition = in_edition(family, revision_for(family.device, edition), report)
        if family_in_edition is None or report:
            raise ValueError("\n".join(problem.format() for problem in report.shown))
        return family_in_edition.device, find_code(family_in_edition.device, text)
    raise ValueError(reason)
