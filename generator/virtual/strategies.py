"""Hypothesis strategies: valid and corrupted frames of encoders, for tests of programs that decode them."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from ..model import Layout, number_to_bytes
from .encoder import VirtualEncoder


def positions(encoder: VirtualEncoder) -> st.SearchStrategy[int]:
    """Return positions of an encoder, in which those near the ends are more frequent."""
    lowest, highest = encoder.lowest, encoder.lowest + encoder.counts - 1
    often = {lowest, lowest + 1, (lowest + highest) // 2, highest, max(lowest, 0)}
    return st.one_of(st.sampled_from(sorted(often)), st.integers(lowest, highest))


@st.composite
def frames(draw: st.DrawFn, encoder: VirtualEncoder, layout: str = "") -> tuple[int, int | bytes]:
    """Return a position of an encoder, and the frame in which it sends it.

    Args:
        draw: Passed by Hypothesis.
        encoder: The encoder. Its position is changed.
        layout: Name of the frame. By default, the first one with a whole position.

    Returns:
        The position, and the frame: bytes over RS-485, otherwise a number whose highest bit is sent first.
    """
    encoder.position = draw(positions(encoder))
    return encoder.position, _sent(encoder, _layout(encoder, layout))


@st.composite
def disturbed_frames(draw: st.DrawFn, encoder: VirtualEncoder, layout: str = "") -> int | bytes:
    """Return a frame of an encoder in which exactly one bit is wrong. A CRC detects all of these.

    Args:
        draw: Passed by Hypothesis.
        encoder: The encoder. Its position is changed.
        layout: Name of the frame. By default, the first one with a whole position.

    Returns:
        The frame, in the form that ``frames`` returns.
    """
    chosen = _layout(encoder, layout)
    encoder.position = draw(positions(encoder))
    frame = _sent(encoder, chosen)
    bit = 1 << draw(st.integers(0, encoder.place(chosen).bits - 1))
    if isinstance(frame, int):
        return frame ^ bit
    return (int.from_bytes(frame, "big") ^ bit).to_bytes(len(frame), "big")


def _layout(encoder: VirtualEncoder, name: str) -> Layout:
    layouts = encoder.layouts("encoder")
    whole = encoder.device.measurement_of(encoder.variant.interface)
    of = whole.of if whole is not None else "position"
    for item in layouts:
        if item.name == name or (not name and of in item.member_names):
            return item
    raise ValueError(f"{encoder.variant.code} has no frame '{name}'; it has: {', '.join(i.name for i in layouts)}")


def _sent(encoder: VirtualEncoder, layout: Layout) -> Any:
    given = {layout.selector: layout.selects[0]} if layout.selector else {}
    number = encoder.frame(layout, given)
    return number_to_bytes(layout, number, encoder.place(layout).bits) if layout.in_bytes else number
