"""Find out whether a frame may be of another kind, for encoders that send frames of several layouts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...model import (
    Constant,
    CrcValue,
    Device,
    Fault,
    Parity,
    PlacedLayout,
    Variant,
)
from ...model.layout import differ_in_length
from ...reference import codec
from ...say import frame_texts
from .frames import FrameTextError, decode_as, layouts_of_sender, undecorated

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis

#: Mistakes with which the received bits are not a reply.
NO_REPLY = frozenset(("line_stuck", "echo"))


class OtherFrames:
    """The other layouts of a sender, with which a frame may also be valid.

    There are none if the sender has only one layout, or if a selector, a field in each frame, identifies the layout.
    """

    def __init__(self, device: Device, variant: Variant, sender: str) -> None:
        layouts = layouts_of_sender(device, variant, sender)
        self._device = device
        self._variant = variant
        self._is_exact = differ_in_length(layouts, sender)
        self._candidates: list[PlacedLayout] = []
        has_selector = any(layout.selector for layout in layouts)
        if len(layouts) > 1 and not has_selector:
            self._candidates = [layout.place(variant.parameters) for layout in layouts]

    def layouts_of(self, frame_text: str, decoded: codec.DecodedFrame) -> tuple[PlacedLayout, ...]:
        """Return the other layouts with which the text is a valid frame.

        ``decoded`` is the result of decoding the text with one of the layouts.
        """
        return tuple(candidate for candidate in self._candidates if self._is_valid_as(candidate, frame_text, decoded))

    def _is_valid_as(self, candidate: PlacedLayout, text: str, decoded: codec.DecodedFrame) -> bool:
        """Return whether a text that was decoded with one layout is also a valid frame of a different one.

        A frame of the right length is not tried with a layout that has a different number of bits.
        """
        if decoded.layout is None or candidate.name == decoded.layout.name:
            return False
        if candidate.layout.in_bytes != decoded.layout.layout.in_bytes:
            return False  # The text of such a frame has a different form.
        # Leading zeros of hex digits may be missing, so 0x1A2B, a 16-bit frame, would be valid in a layout of 24.
        has_wrong_length = any(problem.fault is Fault.LENGTH for problem in decoded.problems)
        if candidate.bits != decoded.layout.bits and not has_wrong_length:
            return False
        frame_text = undecorated(text)
        try:
            candidate_decoded = decode_as(self._device, self._variant, candidate, frame_text, exact=self._is_exact)
        except FrameTextError:  # The number of bits differs.
            return False
        return not candidate_decoded.problems


def is_frame_of_other_kind(
    decoded: codec.DecodedFrame, other_layouts: Sequence[PlacedLayout], diagnosis: Diagnosis | None
) -> bool:
    """Return whether a frame with errors is actually a valid frame of the only layout in ``other_layouts``.

    That layout must have a constant, a CRC or a parity bit, because any bits are valid in a layout without them. A dead
    line or the user's own request, according to ``diagnosis``, is more likely than such a frame.
    """
    if not decoded.problems or len(other_layouts) != 1:
        return False
    if diagnosis is not None and any(mistake.kind in NO_REPLY for mistake in diagnosis.explanations):
        return False
    kinds = [placed_field.field.kind for placed_field in other_layouts[0].fields]
    return any(isinstance(kind, (Constant, CrcValue, Parity)) for kind in kinds)


def frame_of_other_code(diagnosis: Diagnosis | None) -> str:
    """Return a text with the other order codes that may have sent a frame without a CRC, or an empty string."""
    if diagnosis is None or diagnosis.has_crc:
        return ""
    texts = [explanation.text for explanation in diagnosis.explanations if explanation.kind == "other_order_code"]
    return next(iter(texts), "")


def other_frames_line(
    decoded: codec.DecodedFrame,
    other_layouts: Sequence[PlacedLayout],
    diagnosis: Diagnosis | None,
    other_code: str,
) -> str:
    """Return a sentence with the other layouts that the frame matches, and how to choose one, or an empty string.

    ``other_code`` is a text with other order codes that may have sent the frame, or empty.
    """
    if not other_layouts:
        return ""
    layout_names = ", ".join(layout.name for layout in other_layouts)
    if not decoded.problems:
        return f"{frame_texts.also_possible(layout_names)} (choose with --layout)"
    if is_frame_of_other_kind(decoded, other_layouts, diagnosis):
        sentence = f"{frame_texts.valid_other(layout_names)}: add --layout {layout_names}"
        return f"{sentence}. {frame_texts.another_reading(other_code)}" if other_code else sentence
    return f"{frame_texts.possible_instead(layout_names)} (choose with --layout)"
