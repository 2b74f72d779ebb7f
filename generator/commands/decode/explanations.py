"""Explain a frame with errors: by mistakes on the line or in the program, or as a frame of another kind."""

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
from ...why.hypotheses import LEAST_EQUAL_BITS, TypedFrame
from .frames import FrameTextError, decode_as, frame_number, layouts_of_sender, placed_bytes, typed_bits, undecorated

if TYPE_CHECKING:
    from ...why.diagnosis import Diagnosis

#: Faults that may be explained by a mistake in reading the line or in computing the CRC.
_TRANSMISSION_FAULTS = frozenset((Fault.CRC, Fault.LENGTH))
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


def why_text(
    device: Device,
    variant: Variant,
    sender: str,
    frame_text: str,
    decoded: codec.DecodedFrame,
    *,
    with_pairs: bool = False,
) -> Diagnosis | None:
    """Return possible explanations of a frame whose CRC, length or constant is wrong, or None if nothing explains it.

    A frame of bytes whose layout is not known is also explained. ``decoded`` is the result of decoding the text. If
    ``with_pairs`` is true, pairs of mistakes are also listed, even if a single mistake explains the frame.
    """
    placed_layout = decoded.layout
    if placed_layout is not None and not placed_layout.layout.in_bytes:
        # If the layouts of the sender differ in length, the number of hex bytes determines the length of the frame.
        is_exact = differ_in_length(device.interface(variant.interface).layouts, sender)
        typed_frame = typed_bits(device, placed_layout, undecorated(frame_text), exact=is_exact)
        return _why_bits(device, variant, placed_layout, decoded, typed_frame=typed_frame, with_pairs=with_pairs)
    if placed_layout is None:
        first_layout = layouts_of_sender(device, variant, sender)[0]
        layout_of_bytes = first_layout.place(variant.parameters)
    else:
        faults = {problem.fault for problem in decoded.problems}
        if not faults & {*_TRANSMISSION_FAULTS, Fault.CONSTANT}:
            return None
        layout_of_bytes = placed_layout
    from ...why.explain import explain_bytes

    frame = placed_bytes(layout_of_bytes, variant, undecorated(frame_text))
    return explain_bytes(device, variant, sender, placed_layout, frame, with_pairs=with_pairs)


def why_valid_text(
    device: Device, variant: Variant, sender: str, frame_text: str, placed_layout: PlacedLayout
) -> Diagnosis | None:
    """Return the mistakes with which a valid bit frame without a CRC may have been read, or None if there are none."""
    from ...why.explain import explain_constant

    is_exact = differ_in_length(device.interface(variant.interface).layouts, sender)
    typed_frame = frame_number(placed_layout, undecorated(frame_text), exact=is_exact)
    return explain_constant(device, variant, placed_layout, typed_frame)


def _why_bits(
    device: Device,
    variant: Variant,
    placed_layout: PlacedLayout,
    decoded: codec.DecodedFrame,
    *,
    typed_frame: TypedFrame,
    with_pairs: bool,
) -> Diagnosis | None:
    """Return possible explanations of a bit frame, or None if it needs none or nothing explains it.

    A frame is explained if its CRC, its length or a constant is wrong, or if it is long and its bits are all equal, as
    on a dead line. The bits of a valid frame without a CRC are checked too, because only they show a dead line.
    ``typed_frame`` is the frame as the user typed it.
    """
    faults = {problem.fault for problem in decoded.problems}
    is_valid_without_crc = not faults and decoded.crc is None
    all_ones = (1 << placed_layout.bits) - 1
    has_equal_bits = placed_layout.bits >= LEAST_EQUAL_BITS and decoded.number in (0, all_ones)
    has_transmission_fault = not faults.isdisjoint(_TRANSMISSION_FAULTS)
    is_suspicious = is_valid_without_crc or has_equal_bits or has_transmission_fault
    from ...why.explain import explain_bits, explain_constant

    if is_suspicious:
        is_valid = not faults
        return explain_bits(device, variant, placed_layout, typed_frame, is_valid=is_valid, with_pairs=with_pairs)
    if Fault.CONSTANT in faults:
        return explain_constant(device, variant, placed_layout, typed_frame)
    return None
