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
    for sender in dict.fromkeys(layout.sender for layout in layouts):
        sender_layouts = [layout for layout in layouts if layout.sender == sender]
        if not sender_layouts[0].selector:
            continue
        fallback = next((layout for layout in sender_layouts if not layout.selector), None)
        selected_layouts = sender_layouts[: sender_layouts.index(fallback)] if fallback is not None else sender_layouts
        selector = sender_layouts[0].field(sender_layouts[0].selector)
        needs = max((piece.byte + 1 for piece in selector.pieces), default=1)
        branches = tuple(Branch(layout, layout.selects) for layout in selected_layouts)
        yield Dispatch(
            sender=sender,
            selector=selector,
            bits=bits_of(sender_layouts[0], selector),
            needs=needs,
            branches=branches,
            fallback=fallback,
        )
