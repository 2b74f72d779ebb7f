"""Frames whose bits are all inverted, or whose bits or bytes are in a different order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Crc, PlacedLayout, Spi, Variant
from ..reference.bits_and_values import reflect
from .hypotheses import INVERTED_WITHOUT_PAIR, TEXTS, Hypothesis, TypedFrame, frame_hypothesis, possible_lengths


def rearranged_frame_hypotheses(
    variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which all bits are inverted, or the bits or bytes of the frame are in a different order.

    The received bits must have the length of the frame, possibly with leading zeros that complete a byte or word.
    """
    if placed_layout.bits in possible_lengths(placed_layout, typed_frame):
        other_frames = {
            "all_inverted": typed_frame.number ^ ((1 << placed_layout.bits) - 1),
            "bits_reversed": reflect(typed_frame.number, placed_layout.bits),
        }
        if placed_layout.bits % 8 == 0:
            other_frames["bits_reversed_in_bytes"] = reflected_bytes(typed_frame.number, placed_layout.bits // 8)
        for kind, frame in other_frames.items():
            hypothesis = frame_hypothesis(
                kind=kind, description=TEXTS[kind], placed_layout=placed_layout, crc=crc, frame=frame
            )
            # Swapping the two wires of a pair inverts all bits, but SPI has no wire pairs.
            lacks_pair = kind == "all_inverted" and variant.interface == Spi.name
            yield replace(hypothesis, relative_frequency=INVERTED_WITHOUT_PAIR if lacks_pair else 1.0)
    yield from _byte_order_hypotheses("bytes_reversed", placed_layout, crc, typed_frame)
    # In a single word, swapped bytes are the same as reversed bytes.
    has_several_words = placed_layout.bits > 16
    if has_several_words:
        yield from _byte_order_hypotheses("words_swapped", placed_layout, crc, typed_frame)


def reflected_bytes(number: int, byte_count: int) -> int:
    """Return a number of ``byte_count`` bytes with the bits of each byte in reverse order."""
    original_bytes = number.to_bytes(byte_count, "big")
    return int.from_bytes(bytes(reflect(byte, 8) for byte in original_bytes), "big")


def _byte_order_hypotheses(
    kind: str, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that the bytes of a frame are in reverse order, or the two bytes of each 16-bit word.

    ``kind`` is ``bytes_reversed`` or ``words_swapped``. The frame is padded with leading zeros to whole bytes or words.
    In the correct order, these must be zeros. Nothing is yielded if the received bits cannot have this length.
    """
    unit_bits = 16 if kind == "words_swapped" else 8
    unit_count = (placed_layout.bits + unit_bits - 1) // unit_bits  # rounded up
    padded_bits = unit_count * unit_bits
    is_too_long = typed_frame.number >> padded_bits != 0
    if is_too_long:
        return
    has_possible_length = typed_frame.bits in (placed_layout.bits, padded_bits)
    is_whole_bytes = typed_frame.bits % 8 == 0 and has_possible_length
    if typed_frame.is_length_known and not is_whole_bytes:
        return
    if kind == "words_swapped":
        padded_frame = swapped_words(typed_frame.number, padded_bits // 8)
    else:
        padded_frame = int.from_bytes(typed_frame.number.to_bytes(padded_bits // 8, "little"), "big")
    frame = padded_frame & ((1 << placed_layout.bits) - 1)
    are_padding_bits_zero = frame == padded_frame
    yield frame_hypothesis(
        kind=kind,
        description=TEXTS[kind],
        placed_layout=placed_layout,
        crc=crc,
        frame=frame,
        determined_bits=padded_bits - placed_layout.bits,
        do_determined_bits_match=are_padding_bits_zero,
    )


def swapped_words(number: int, byte_count: int) -> int:
    """Return a number of ``byte_count`` bytes, which must be even, with the two bytes of each 16-bit word swapped."""
    original_bytes = number.to_bytes(byte_count, "big")
    swapped_bytes = bytearray(byte_count)
    swapped_bytes[0::2] = original_bytes[1::2]
    swapped_bytes[1::2] = original_bytes[0::2]
    return int.from_bytes(swapped_bytes, "big")
