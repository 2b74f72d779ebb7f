"""Find the family and the variant of an order code for a virtual encoder."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from ..language.problems import ProblemReport
from ..loading.history import revision_for
from ..loading.library import Family, families_without_problems, in_edition, load_families
from ..model import Device
from ..one_line.encoder import device_of_line
from ..one_line.parse import is_line
from ..order_codes.labels import LabelMatch, UnknownOrderCode, find_code


@cache
def _load_families(specs: tuple[Path, ...]) -> tuple[Family, ...]:
    """Load specs, and return the families without problems. An empty tuple stands for the specs of the package.

    Raises:
        ValueError: No family is valid. The message lists the problems in the specs.
    """
    families, report = load_families(specs or None)
    valid_families = tuple(families_without_problems(families, report))
    if not valid_families:
        problems_text = "\n".join(problem.format() for problem in report.shown)
        raise ValueError(problems_text or "there are no specs")
    return valid_families


def _has_special_code(device: Device, text: str) -> bool:
    """Return whether an order code contains the code of a special model, which an overlay of the family describes."""
    return any(overlay.special and overlay.special in text for overlay in device.overlays)


def find_order_code(text: str, specs: tuple[Path, ...], edition: str) -> tuple[Device, LabelMatch]:
    """Return the family and the variant of an order code, or of an encoder that is described in one line.

    Families with a special model that is named in the text are tried first. Families derived from a ``base`` have the
    same order codes as their base and are not tried.

    Raises:
        ValueError: There is no such order code or edition, no spec is valid, or the line has a problem. For an unknown
            order code, the message names the most similar codes of the last family that has any.
    """
    if is_line(text):
        if edition:
            raise ValueError("an encoder in one line has no editions; leave the edition out")
        return device_of_line(text)
    error_message = ""
    families = _load_families(specs)
    special_families = [family for family in families if _has_special_code(family.device, text)]
    ordinary_families = [family for family in families if not family.device.base]
    for family in (*special_families, *ordinary_families):
        try:
            match = find_code(family.device, text)
        except UnknownOrderCode as error:
            # An error with similar order codes is more helpful.
            if error.names_mistake or not error_message:
                error_message = str(error)
            continue
        if not edition:
            return family.device, match
        report = ProblemReport()
        revision = revision_for(family.device, edition)
        family_in_edition = in_edition(family, revision, report)
        if family_in_edition is None or report:
            raise ValueError("\n".join(problem.format() for problem in report.shown))
        return family_in_edition.device, find_code(family_in_edition.device, text)
    raise ValueError(error_message)
