"""Name the other frames of an interface that a frame can be, for ``codewheel decode`` without ``--layout``."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Constant, CrcValue, Device, Fault, Parity, PlacedLayout, Variant
from ..model.layout import have_lengths
from ..reference.codec import Decoded
from ..say import frame_text as say
from .decode import decoded_as
from .frame_text import FrameTextError, checked


class OtherFrames:
    """The layouts of a sender, each a candidate for a frame that was decoded as one of them."""

    def __init__(self, device: Device, variant: Variant, sender: str) -> None:
        layouts = [layout for layout in device.interface(variant.interface).layouts if layout.sender == sender]
        self._device, self._variant = device, variant
        self._exact = have_lengths(layouts, sender)
        # A selector identifies the frame.
        is_open = len(layouts) > 1 and not any(layout.selector for layout in layouts)
        self._candidates = [layout.place(variant.parameters) for layout in layouts] if is_open else []

    def of(self, text: str, decoded: Decoded) -> tuple[PlacedLayout, ...]:
        """Return the other layouts with which the text is a valid frame. ``decoded`` is its ``decode_text``."""
        return tuple(candidate for candidate in self._candidates if self._can_be(candidate, text, decoded))

    def _can_be(self, candidate: PlacedLayout, text: str, decoded: Decoded) -> bool:
        if decoded.layout is None or candidate.name == decoded.layout.name:
            return False
        if candidate.layout.in_bytes != decoded.layout.layout.in_bytes:
            return False  # its text has another form
        # Hex digits imply leading zeros, so without this, a short frame would be valid as a long one.
        has_other_length = any(problem.fault is Fault.LENGTH for problem in decoded.problems)
        if candidate.bits != decoded.layout.bits and not has_other_length:
            return False
        try:
            return not decoded_as(self._device, self._variant, candidate, checked(text), exact=self._exact).problems
        except FrameTextError:  # another number of bits
            return False


def other_frames_line(decoded: Decoded, other_layouts: Sequence[PlacedLayout]) -> str:
    """Return the names of the other frames in a sentence, or an empty string if there are none."""
    if not other_layouts:
        return ""
    names = ", ".join(layout.name for layout in other_layouts)
    if not decoded.problems:
        return f"{say.also_possible(names)} (choose with --layout)"
    if is_another(decoded, other_layouts):
        return f"{say.valid_other(names)}: add --layout {names}"
    return f"{say.possible_instead(names)} (choose with --layout)"


def is_another(decoded: Decoded, other_layouts: Sequence[PlacedLayout]) -> bool:
    """Return whether a wrong frame is a valid one of another kind, whose check bits match, so it has no mistake."""
    if not decoded.problems or len(other_layouts) != 1:
        return False
    return any(isinstance(field.field.kind, (Constant, CrcValue, Parity)) for field in other_layouts[0].fields)
