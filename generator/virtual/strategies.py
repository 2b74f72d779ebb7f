"""Hypothesis strategies: valid and corrupted frames of encoders, for tests of programs that decode them."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from ..model import Layout, number_to_bytes
from .encoder import VirtualEncoder


def positions(encoder: VirtualEncoder) -> st.SearchStrategy[int]:
    """Return positions of an encoder, in which those near the ends are more frequent."""
    lowest, highest = encoder.lowest, encoder.lowest + encoder.counts - 1
    frequent = {lowest, lowest + 1, (lowest + highest) // 2, highest, max(lowest, 0)}
    return st.one_of(st.sampled_from(sorted(frequent)), st.integers(lowest, highest))


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
    sent_layout = _layout(encoder, layout)
    encoder.position = draw(positions(encoder))
    frame = _sent(encoder, sent_layout)
    bit = 1 << draw(st.integers(0, encoder.place(sent_layout).bits - 1))
    if isinstance(frame, int):
        return frame ^ bit
    return (int.from_bytes(frame, "big") ^ bit).to_bytes(len(frame), "big")


def _layout(encoder: VirtualEncoder, name: str) -> Layout:
    layouts = encoder.layouts("encoder")
    measurement = encoder.device.measurement_of(encoder.variant.interface)
    position_name = measurement.of if measurement is not None else "position"
    for layout in layouts:
        if layout.name == name or (not name and position_name in layout.member_names):
            return layout
    raise ValueError(f"{encoder.variant.code} has no frame '{name}'; it has: {', '.join(i.name for i in layouts)}")


def _sent(encoder: VirtualEncoder, layout: Layout) -> Any:
    selector_values = {layout.selector: layout.selects[0]} if layout.selector else {}
    number = encoder.frame(layout, selector_values)
    return number_to_bytes(layout, number, encoder.place(layout).bits) if layout.in_bytes else number
