"""Find the edition of the manual that applies to an encoder, by its label or its registers."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, EditionTest
from .labels import LabelMatch


def edition_before(device: Device, revision: str) -> str:
    """Return the revision that precedes this one, which must not be the first."""
    revisions = [edition.revision for edition in device.editions]
    return revisions[revisions.index(revision) - 1]


def edition_by_label(device: Device, match: LabelMatch) -> str:
    """Return the revision of the manual whose order codes are written like this label, or "" if it cannot be inferred.

    ``match.written_as_in`` is the place where codes are written like the label.
    """
    spellings = device.order_code.also_written
    patterns = {spelling.pattern for spelling in spellings if spelling.where == match.written_as_in}
    for edition in device.editions:
        if not patterns.isdisjoint(edition.labels):
            return edition.revision
    return ""


def tests_of(device: Device, register: str) -> Iterator[tuple[str, EditionTest]]:
    """Yield the tests of a register that show which revision of the manual applies to an encoder.

    Each test comes with the first revision for which the register passes it.
    """
    for edition in device.editions:
        for test in edition.tests:
            if test.register == register:
                yield edition.revision, test
