"""Find the edition of the manual that applies to an encoder, from its label or with registers that identify it."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, EditionTest
from .labels import Match


def edition_before(device: Device, revision: str) -> str:
    """Return the revision that precedes this one."""
    revisions = [edition.revision for edition in device.editions]
    return revisions[revisions.index(revision) - 1]


def edition_by_label(device: Device, match: Match) -> str:
    """Return the edition whose labels are written like this one, or an empty string if the label does not show it."""
    spellings = device.order_code.also_written
    patterns = {spelling.pattern for spelling in spellings if spelling.where == match.written_as_in}
    revisions = (edition.revision for edition in device.editions if not patterns.isdisjoint(edition.labels))
    return next(revisions, "")


def tests_of(device: Device, register: str) -> Iterator[tuple[str, EditionTest]]:
    """Yield the tests of a register, each with the first revision for which the register passes the test."""
    for edition in device.editions:
        for test in edition.tests:
            if test.register == register:
                yield edition.revision, test
