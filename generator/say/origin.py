"""What a family is made of beside its manual: overlays, and what they or another edition take away."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import LEFT_OUT, NOT_KNOWN, Device, EditionTest
from .erratum import erratum
from .name import words
from .text import Code, Ref, Said, said
from .words import sentence


def origin(device: Device) -> Iterator[Said]:
    """Whether it is the family of the manual; nothing where it is, as the manual has it."""
    special = next((item.special for item in device.overlays if item.special), "")
    if special:
        yield said(
            "Only for encoders whose order code ends in ", Code(f"/{special}"), "; all others are ", Code(device.base)
        )
    if device.edition:
        date = f" of {device.manual.date}" if device.manual.date else ""
        yield said(
            f"As edition {device.edition} of the manual{date} had it, as far as that is known; "
            "the one that the spec transcribes is ",
            Code(device.base),
            ". What was otherwise is told with its source, and what is not known is left out",
        )
    for item in device.overlays:
        yield said(
            f"Over what the manual says lies the overlay {item.name}, “{item.title}”. "
            "Each of its changes is told where it is, with its reason and its source"
        )


def other_editions(device: Device) -> Iterator[Said]:
    """That encoders of other editions may differ, and how files for them are made."""
    if device.editions:
        example = f"codewheel generate --edition {device.name}={device.editions[0].revision}"
        yield said(
            "Where encoders of other editions of the manual may differ, it is said at the place; ",
            Code(example),
            " makes files for such encoders",
        )


def taken_away(device: Device) -> Iterator[Said]:
    """The changes by overlays and editions that have left nothing at which they could be told."""
    for item in device.errata:
        nowhere = device.base or item.overlay or not item.affects
        if (
            (item.overlay or item.edition)
            and nowhere
            and item.used in (LEFT_OUT, NOT_KNOWN)
            and item.severity != "wording"
        ):
            yield erratum(item)


def edition_test(revision: str, test: EditionTest) -> Said:
    """What tells an encoder of before an edition."""
    register = Ref("register", test.register, words(test.register))
    return said(
        register,
        f": {test.run} is {test.min} to {test.max}. {sentence(test.why)} Another value tells an encoder of before "
        f"edition {revision}; one of these tells nothing for sure",
        source=test.source,
    )
