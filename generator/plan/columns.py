"""Plans for decoding many frames at once, with the same operations as for a single frame.

A column decoder does not look at single bytes, so positions are bit positions in the number formed by the frame's
bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..model import Layout, Verdict
from ..model.expressions import Expression
from .codec import AlwaysIs, AtMost, Check, Codec, Fixed, IsOneOf, ParityIs, ParityOf, Part, Reserved, ZerosAbove
from .reports import Judgement, Only, Reporting


@dataclass(frozen=True, slots=True)
class Place:
    """``width`` bits, starting at bit ``low``."""

    low: Expression
    width: Expression


@dataclass(frozen=True, slots=True)
class Condition:
    """Bits whose value must be one of ``values``, at most ``limit``, or the parity of all bits at ``parity_of``."""

    place: Place
    check: Check
    values: tuple[int, ...] = ()
    limit: int | None = None
    parity_of: tuple[Place, ...] = ()
    odd: bool = False


@dataclass(frozen=True, slots=True)
class Worth:
    """A verdict and its cause: a flag, unless certain other flags are active, or any of certain reserved bits.

    Without ``only`` it applies to all order codes.
    """

    verdict: Verdict
    flag: Part | None
    unless: tuple[Part, ...]
    mask: int
    only: Only | None


@dataclass(frozen=True, slots=True)
class Telling:
    """A report and its cause: a flag, or any of certain reserved bits."""

    report: str
    flag: Part | None
    mask: int
    only: Only | None


def conditions(codec: Codec) -> Iterator[Condition]:
    """Yield the checks of a frame other than the CRC, in the order used for a single frame."""
    for item in codec.checks:
        match item:
            case AlwaysIs(field, _, value):
                yield Condition(Place(field.low, field.width), item, (value,))
            case ZerosAbove(padding=padding):
                yield Condition(Place(padding.low, padding.width), item, (0,))
            case ParityIs(field=field, of=of, odd=odd):
                places = tuple(Place(one.low, one.width) for one in of)
                yield Condition(Place(field.low, field.width), item, parity_of=places, odd=odd)
            case IsOneOf(field, _, values):
                yield Condition(Place(field.low, field.width), item, values)
            case AtMost(field=field, limit=limit):
                yield Condition(Place(field.low, field.width), item, limit=limit)


def worth(judgement: Judgement) -> Iterator[Worth]:
    """Yield the verdicts on the position, worst first."""
    for verdict, items in judgement.worst_first:
        for item in items:
            if isinstance(item.by, Reserved):
                yield Worth(verdict, None, (), ((1 << item.by.bits.widest) - 1) << item.by.place, item.only)
            else:
                yield Worth(verdict, item.by, item.unless, 0, item.only)


def telling(reporting: Reporting) -> Iterator[Telling]:
    """Yield the reports of a frame."""
    for item in reporting.told:
        if isinstance(item.by, Reserved):
            yield Telling(item.report.name, None, ((1 << item.by.bits.widest) - 1) << item.by.place, item.only)
        else:
            yield Telling(item.report.name, item.by, 0, item.only)


def crc_place(layout: Layout, width: int) -> int:
    """Return the position of the lowest CRC bit in the number formed by the frame."""
    ends_on_top = layout.in_bytes and layout.byte_order == "low_byte_first"
    return layout.widest - width if ends_on_top else 0


def fixed(codec: Codec) -> Iterator[tuple[Place, int]]:
    """Yield the fixed bits of the frame."""
    for item in codec.terms:
        if isinstance(item.value, Fixed) and item.value.number:
            yield Place(item.field.low, item.field.width), item.value.number


def parities(codec: Codec) -> Iterator[tuple[Place, tuple[Place, ...], bool]]:
    """Yield the parity bits to encode, each with the bits that it covers and whether the parity is odd."""
    for item in codec.terms:
        if isinstance(item.value, ParityOf):
            of = tuple(Place(one.low, one.width) for one in item.value.of)
            yield Place(item.field.low, item.field.width), of, item.value.odd
