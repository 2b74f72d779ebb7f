"""Plans for distinguishing the frames of one sender."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Field, Layout
from ..model.record import dataclass
from .codec import Bits, bits_of


@dataclass(frozen=True, slots=True)
class Branch:
    """A frame, and the selector values that identify it."""

    layout: Layout
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Dispatch:
    """The frames of one sender, identified by ``selector``. ``fallback`` is the frame for all other values, or None.

    The selector has the same position in all of them. ``needs`` is the number of bytes needed to read it.
    """

    sender: str
    selector: Field
    bits: Bits
    needs: int
    branches: tuple[Branch, ...]
    fallback: Layout | None


def dispatches(layouts: Sequence[Layout]) -> Iterator[Dispatch]:
    """Yield a dispatch for each sender that sends more than one kind of frame on an interface."""
    for sender in dict.fromkeys(item.sender for item in layouts):
        sent = [item for item in layouts if item.sender == sender]
        if not sent[0].selector:
            continue
        fallback = next((item for item in sent if not item.selector), None)
        told = sent[: sent.index(fallback)] if fallback is not None else sent
        selector = sent[0].field(sent[0].selector)
        needs = max((piece.byte + 1 for piece in selector.pieces), default=1)
        branches = tuple(Branch(item, item.selects) for item in told)
        yield Dispatch(sender, selector, bits_of(sent[0], selector), needs, branches, fallback)
