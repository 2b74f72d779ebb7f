"""Statements about the origin of a family: its overlays, its edition, and the parts removed by them."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import LEFT_OUT, NOT_KNOWN, Device, EditionTest
from .erratum import erratum
from .name import words
from .text import Code, Ref, Statement, statement
from .words import sentence


def origin(device: Device) -> Iterator[Statement]:
    """Yield how the family differs from its manual, if at all."""
    special = next((overlay.special for overlay in device.overlays if overlay.special), "")
    if special:
        yield statement(
            "Only for encoders whose order code ends in ",
            Code(f"/{special}"),
            ". For all others use ",
            Code(device.base),
        )
    if device.edition:
        date = f" of {device.manual.date}" if device.manual.date else ""
        yield statement(
            f"Describes encoders of edition {device.edition} of the manual{date}, as far as they are known. "
            "The edition that the spec transcribes is ",
            Code(device.base),
            ". Each difference is given with its source. Unknown parts are omitted",
        )
    for overlay in device.overlays:
        yield statement(
            f"Includes the overlay {overlay.name}, “{overlay.title}”. "
            "Each of its changes is noted inline, with its reason and its source"
        )


def other_editions(device: Device) -> Iterator[Statement]:
    """Yield a hint at other editions of the manual, with the command that generates files for one."""
    if device.editions:
        example = f"codewheel generate --edition {device.name}={device.editions[0].revision}"
        yield statement(
            "Differences from other editions of the manual are noted inline. For the files of another edition, use ",
            Code(example),
        )


def removals(device: Device) -> Iterator[Statement]:
    """Yield those changes by overlays and editions that removed the part where they would otherwise be noted."""
    for correction in device.errata:
        has_no_place = device.base or correction.overlay or not correction.affects
        if (
            (correction.overlay or correction.edition)
            and has_no_place
            and correction.used in (LEFT_OUT, NOT_KNOWN)
            and correction.severity != "wording"
        ):
            yield erratum(correction)


def edition_test(revision: str, test: EditionTest) -> Statement:
    """Return the register test for an encoder older than an edition."""
    register = Ref("register", test.register, words(test.register))
    return statement(
        register,
        f": {test.run} is {test.min} to {test.max}. {sentence(test.why)} Any other value means that the encoder is "
        f"older than edition {revision}. A value in this range is not conclusive",
        source=test.source,
    )
