"""Hypothesis strategies: valid and corrupted frames of encoders, for tests of programs that decode them."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from ..model import Layout, number_to_bytes
from .encoder import VirtualEncoder


def positions(encoder: VirtualEncoder) -> st.SearchStrategy[int]:
    """Return a strategy for positions of an encoder. The ends of the range and its middle are more frequent."""
    lowest = encoder.lowest
    highest = encoder.lowest + encoder.counts - 1
    middle = (lowest + highest) // 2
    zero = max(lowest, 0)  # The position 0, which is not an end if positions are signed.
    frequent_positions = {lowest, lowest + 1, middle, highest, zero}
    return st.one_of(st.sampled_from(sorted(frequent_positions)), st.integers(lowest, highest))


@st.composite
def frames(draw: st.DrawFn, encoder: VirtualEncoder, layout: str = "") -> tuple[int, int | bytes]:
    """Return a position of an encoder, and the frame with this position.

    Args:
        draw: Passed by Hypothesis.
        encoder: The encoder. Its position is changed.
        layout: Name of the frame. By default, the first frame with a whole position.

    Returns:
        The position, and the frame: bytes over RS-485, otherwise a number whose highest bit is sent first.
    """
    encoder.position = draw(positions(encoder))
    return encoder.position, _frame_or_bytes(encoder, _frame_layout(encoder, layout))


@st.composite
def disturbed_frames(draw: st.DrawFn, encoder: VirtualEncoder, layout: str = "") -> int | bytes:
    """Return a frame of an encoder in which exactly one bit is wrong. A CRC detects all such frames.

    Args:
        draw: Passed by Hypothesis.
        encoder: The encoder. Its position is changed.
        layout: Name of the frame. By default, the first frame with a whole position.

    Returns:
        The frame, in the form that ``frames`` returns.
    """
    frame_layout = _frame_layout(encoder, layout)
    encoder.position = draw(positions(encoder))
    frame = _frame_or_bytes(encoder, frame_layout)
    highest_bit = encoder.place(frame_layout).bits - 1
    inverted_bit = 1 << draw(st.integers(0, highest_bit))
    if isinstance(frame, int):
        return frame ^ inverted_bit
    frame_number = int.from_bytes(frame, "big") ^ inverted_bit
    return frame_number.to_bytes(len(frame), "big")


def _frame_layout(encoder: VirtualEncoder, name: str) -> Layout:
    """Return the layout of the frame with this name. If the name is empty, return the first one with a whole position.

    Raises:
        ValueError: The encoder sends no such frame.
    """
    sent_layouts = encoder.layouts(sender="encoder")
    measurement = encoder.device.measurement_of(encoder.variant.interface)
    # The name of the number that is the position. Fields can be parts of it.
    position_name = measurement.position_name if measurement is not None else "position"
    for layout in sent_layouts:
        if name and layout.name == name:
            return layout
        has_whole_position = position_name in layout.member_names
        if not name and has_whole_position:
            return layout
    known_names = ", ".join(layout.name for layout in sent_layouts)
    raise ValueError(f"{encoder.variant.code} has no frame '{name}'; it has: {known_names}")


def _frame_or_bytes(encoder: VirtualEncoder, layout: Layout) -> Any:
    """Return the current frame of the encoder with this layout: bytes over RS-485, and otherwise a number.

    If a selector field identifies frames of this layout, it has the first of its valid values.
    """
    selector_value = {}
    if layout.selector:
        selector_value[layout.selector] = layout.selects[0]
    number = encoder.frame(layout, selector_value)
    if layout.in_bytes:
        return number_to_bytes(layout, number, encoder.place(layout).bits)
    return number
