"""Common mistakes with a frame that is one number: BiSS, or any other bits with a CRC at the end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import prod

from ..model import (
    Answer,
    Biss,
    Constant,
    Crc,
    Device,
    Flag,
    Kind,
    PlacedField,
    PlacedLayout,
    Spi,
    Unused,
    Variant,
    answer_combinations,
)
from ..reference.bits import reflect
from .exchanges import echo_hypotheses
from .hypotheses import (
    ACTIVE,
    IDLE,
    INVERTED_WITHOUT_PAIR,
    Hypothesis,
    TypedFrame,
    check_constant_bits,
    frame_hypothesis,
    likelihood,
)
from .other_crcs import other_crc_hypotheses, other_polynomial_hypotheses, status_mask
from .other_order_codes import other_order_code_hypotheses
from .recordings import LINES, FrameOffset, line_name, recorded_bits, recording_hypotheses, window_hypotheses
from .texts import TEXTS


def all_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield every single mistake that could have turned a valid frame into the typed one.

    ``placed_layout`` is the layout of the expected frame. If the CRC covers only a part of the frame, only other CRC
    parameters, and rearranged and moved frames, are tried. A frame that can have the right length is tried in another
    length only if that leads to another frame.
    """
    if placed_layout.bits in _possible_lengths(placed_layout, typed_frame):
        is_biss = variant.interface == Biss.name
        yield from other_crc_hypotheses(placed_layout, crc, typed_frame.number, has_start_bits=is_biss)
    yield from rearranged_frame_hypotheses(variant, placed_layout, crc, typed_frame)
    yield from moved_frame_hypotheses(device, variant, placed_layout, crc, typed_frame)
    if placed_layout.covers_part:
        return
    yield from _removed_status_hypotheses(placed_layout, crc, typed_frame)
    yield from other_answer_hypotheses(device, variant, placed_layout, typed_frame)
    yield from other_polynomial_hypotheses(placed_layout, crc, typed_frame)
    yield from other_order_code_hypotheses(device, variant, placed_layout, typed_frame)


def _possible_lengths(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> list[int]:
    """Return the lengths in bits that the text may have, longest first.

    Without leading zeros, these are the length of the frame and one bit less, since the first bit may be missing.
    Neither is below the number of typed bits.
    """
    has_known_length = typed_frame.exact or typed_frame.bits > placed_layout.bits
    if has_known_length:
        return [typed_frame.bits]
    lengths = (placed_layout.bits, placed_layout.bits - 1)
    return [length for length in lengths if length >= typed_frame.bits]


def moved_frame_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses with bits around the frame, or without its first or last bits, or with the user's own request.

    The offsets and recordings of the line are tried. If none of them fits and there is a CRC, the frame is searched at
    every bit.
    """
    line = LINES.get(line_name(device.interface(variant.interface)))
    if line is None:
        return
    if typed_frame.may_have(placed_layout.bits):
        yield from echo_hypotheses(device, variant, placed_layout, typed_frame.number)
    if variant.interface == Spi.name:
        yield from _left_out_command_hypotheses(placed_layout, crc, typed_frame)
    received_bits = recorded_bits(typed_frame, placed_layout.bits)
    hypotheses_by_rule: list[Hypothesis] = []
    possible_offsets = [offset for offset in line.slips if _can_have(placed_layout, crc, offset)]
    for length in _possible_lengths(placed_layout, typed_frame):
        for offset in possible_offsets:
            if placed_layout.bits + offset.additional_bits == length:
                hypotheses_by_rule += _offset_hypotheses(placed_layout, crc, offset, typed_frame.number, length)
    hypotheses_by_rule += recording_hypotheses(line, placed_layout, crc, received_bits)
    yield from hypotheses_by_rule
    is_frame_found = any(hypothesis.fits for hypothesis in hypotheses_by_rule)
    if crc is not None and not is_frame_found:
        yield from window_hypotheses(placed_layout, crc, received_bits)


def _can_have(placed_layout: PlacedLayout, crc: Crc | None, offset: FrameOffset) -> bool:
    """Return whether the frame has the bits that are missing with an offset, and its CRC the lost last bits."""
    if len(offset.missing) + offset.lost > placed_layout.bits:
        return False
    return crc is None or offset.lost <= crc.width


def _left_out_command_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that the bits during the command are missing, with the command that the layout expects."""
    command, command_bits = _bits_during_command(placed_layout, crc)
    remaining_bits = placed_layout.bits - command_bits
    has_remaining_bits = typed_frame.may_have(remaining_bits) and typed_frame.written == remaining_bits
    has_command = command_bits > 0
    if not has_command or not has_remaining_bits:
        return
    description = TEXTS["command_left_out"].format(command_bits)
    frame = (command << remaining_bits) | typed_frame.number
    hypothesis = frame_hypothesis("command_left_out", description, placed_layout, crc, frame)
    constant_bits, _ = check_constant_bits(placed_layout, 0)
    # The constants of the command are the assumed ones, so they prove nothing.
    assumed_bits = sum(field.width for field in placed_layout.fields if _is_constant_from(field, remaining_bits))
    yield replace(hypothesis, determined_bits=constant_bits - assumed_bits)


def _bits_during_command(placed_layout: PlacedLayout, crc: Crc | None) -> tuple[int, int]:
    """Return the first bits of a word, up to its data, and their number: ``(0x8021, 16)``.

    These are constants, and bits that the CRC does not cover, which are returned as 0. If they are not whole bytes, the
    result is ``(0, 0)``.
    """
    low, width = placed_layout.crc_covers if crc is not None else (0, placed_layout.bits)
    first_bit_above_covered = low + width
    command = 0
    lowest_bit = placed_layout.bits
    # From the first field that is sent to the last.
    for field in sorted(placed_layout.fields, key=lambda placed_field: -placed_field.low):
        is_uncovered = field.low >= first_bit_above_covered
        if not isinstance(field.field.kind, Constant) and not is_uncovered:
            break
        if isinstance(field.field.kind, Constant):
            command |= field.field.kind.value << field.low
        lowest_bit = field.low
    command_bits = placed_layout.bits - lowest_bit
    is_whole_bytes = command_bits % 8 == 0
    return (command >> lowest_bit, command_bits) if is_whole_bytes else (0, 0)


def _is_constant_from(field: PlacedField, lowest_bit: int) -> bool:
    """Return whether a field is a constant whose bits are all at ``lowest_bit`` or above."""
    return isinstance(field.field.kind, Constant) and field.low >= lowest_bit


def _offset_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, offset: FrameOffset, number: int, length: int
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the ``length`` bits of ``number`` do not begin and end with the frame.

    The bits are, in the order received: bits before the frame, the received part of the frame, bits after it. Bits
    before the frame that must be 1 count as determined, and those that are mostly 0 change the likelihood. Without a
    CRC, there is a hypothesis for each value of the lost last bits. With a CRC, these bits belong to it and are 0 here.
    """
    frame_part_length = length - len(offset.front) - offset.behind
    front_and_frame_part = number >> offset.behind
    front = front_and_frame_part >> frame_part_length
    frame_part = front_and_frame_part & ((1 << frame_part_length) - 1)
    missing_first_bits = int(offset.missing or "0", 2)
    frame_without_last_bits = ((missing_first_bits << frame_part_length) | frame_part) << offset.lost
    start_bits = _bits_with_mark(offset.front, "1", front)
    front_likelihood = prod(ACTIVE if bit else IDLE for bit in _bits_with_mark(offset.front, "~", front))
    assumed_bits = 0 if crc is not None else offset.lost + len(offset.missing)
    for last_bits in range(1 << offset.lost if crc is None else 1):
        hypothesis = frame_hypothesis(
            offset.kind,
            offset.text.format(offset.missing),
            placed_layout,
            crc,
            frame_without_last_bits | last_bits,
            lost_bits=offset.lost if crc is not None else assumed_bits,
            determined_bits=len(start_bits),
            are_determined_right=all(start_bits),
        )
        yield replace(
            hypothesis,
            template=offset.text,
            likelihood=hypothesis.likelihood * front_likelihood,
            has_assumed_bit=assumed_bits > 0,
        )


def _bits_with_mark(marks_in_front: str, mark: str, received_front: int) -> list[int]:
    """Return those received bits before the frame that have this mark, the last one first.

    The marks ``1~`` belong to a start bit, which must be 1, and to a bit that is mostly 0. If the bits are 0b10, the
    bit with the mark ``~`` is ``[0]``.
    """
    marks_from_last_bit = enumerate(reversed(marks_in_front))
    return [(received_front >> bit) & 1 for bit, mark_of_bit in marks_from_last_bit if mark_of_bit == mark]


def rearranged_frame_hypotheses(
    variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which all bits are inverted, or the bits or bytes are in another order.

    The bits must have the length of the frame. For bytes and words, the frame may be filled up with zeros.
    """
    if placed_layout.bits in _possible_lengths(placed_layout, typed_frame):
        other_frames = {
            "all_inverted": typed_frame.number ^ ((1 << placed_layout.bits) - 1),
            "bits_reversed": reflect(typed_frame.number, placed_layout.bits),
        }
        if placed_layout.bits % 8 == 0:
            other_frames["bits_reversed_in_bytes"] = reflected_bytes(typed_frame.number, placed_layout.bits // 8)
        for kind, frame in other_frames.items():
            hypothesis = frame_hypothesis(kind, TEXTS[kind], placed_layout, crc, frame)
            # SPI has single wires. Over other interfaces, the two wires of a pair can be swapped, which inverts all
            # bits.
            lacks_pair = kind == "all_inverted" and variant.interface == Spi.name
            frequency = INVERTED_WITHOUT_PAIR if lacks_pair else 1.0
            yield replace(hypothesis, likelihood=hypothesis.likelihood * frequency)
    yield from _byte_order_hypotheses("bytes_reversed", placed_layout, crc, typed_frame)
    # With two bytes, a swapped word is the same as reversed bytes.
    if placed_layout.bits > 16:
        yield from _byte_order_hypotheses("words_swapped", placed_layout, crc, typed_frame)


def reflected_bytes(number: int, byte_count: int) -> int:
    """Return ``byte_count`` bytes with the bits of each in reverse order."""
    original_bytes = number.to_bytes(byte_count, "big")
    return int.from_bytes(bytes(reflect(byte, 8) for byte in original_bytes), "big")


def _byte_order_hypotheses(
    kind: str, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that the bytes of the frame are in reverse order, or the two bytes of each 16-bit word.

    ``kind`` is "bytes_reversed" or "words_swapped". The frame was filled up with leading zeros to whole bytes or words,
    which must be zero in the right order. Nothing is yielded for a frame that is longer, or exact in another length.
    """
    unit_bits = 16 if kind == "words_swapped" else 8
    # The next multiple of the unit.
    filled_bits = (placed_layout.bits + unit_bits - 1) // unit_bits * unit_bits
    is_longer = typed_frame.number >> filled_bits != 0
    if is_longer:
        return
    has_possible_length = typed_frame.bits in (placed_layout.bits, filled_bits)
    is_whole_bytes = typed_frame.bits % 8 == 0 and has_possible_length
    if typed_frame.exact and not is_whole_bytes:
        return
    if kind == "words_swapped":
        filled_frame = swapped_words(typed_frame.number, filled_bits // 8)
    else:
        filled_frame = int.from_bytes(typed_frame.number.to_bytes(filled_bits // 8, "little"), "big")
    frame = filled_frame & ((1 << placed_layout.bits) - 1)
    are_filling_bits_zero = frame == filled_frame
    yield frame_hypothesis(
        kind,
        TEXTS[kind],
        placed_layout,
        crc,
        frame,
        determined_bits=filled_bits - placed_layout.bits,
        are_determined_right=are_filling_bits_zero,
    )


def swapped_words(number: int, byte_count: int) -> int:
    """Return ``byte_count`` bytes, which is even, with the two bytes of each 16-bit word swapped."""
    original_bytes = number.to_bytes(byte_count, "big")
    swapped_bytes = bytearray(byte_count)
    swapped_bytes[0::2] = original_bytes[1::2]
    swapped_bytes[1::2] = original_bytes[0::2]
    return int.from_bytes(swapped_bytes, "big")


def _removed_status_hypotheses(placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame) -> Iterator[Hypothesis]:
    """Yield hypotheses in which error and warning are missing: removed after the CRC was computed, or before.

    They must be the last bits before the CRC. In the first case, the CRC covers them as inactive.
    """
    frame_status_mask = status_mask(placed_layout)
    status_bits = frame_status_mask.bit_count()
    bits_without_status = placed_layout.bits - status_bits
    # The mask, shifted by the CRC, then consists of ones from bit 0 on.
    ones_from_bit_0 = (1 << status_bits) - 1
    are_last_before_crc = frame_status_mask >> crc.width == ones_from_bit_0
    if not frame_status_mask or not are_last_before_crc or not typed_frame.may_have(bits_without_status):
        return
    data = typed_frame.number >> crc.width
    received_crc = typed_frame.number & crc.mask
    data_in_frame = data << (crc.width + status_bits)
    frame = data_in_frame | _idle_status(placed_layout, frame_status_mask) | received_crc
    yield frame_hypothesis("status_not_sent", TEXTS["removed_and_idle"], placed_layout, crc, frame)
    if typed_frame.exact:  # Otherwise this is the same as a CRC over the bits before them.
        yield Hypothesis(
            kind="status_not_sent",
            description=TEXTS["removed"],
            crc=crc,
            covered_data=data,
            covered_bits=bits_without_status - crc.width,
            received_crc=received_crc,
            received_crc_bits=crc.width,
            likelihood=likelihood(placed_layout, frame),
            frame=frame,
            frame_layout=placed_layout,
        )


def _idle_status(placed_layout: PlacedLayout, frame_status_mask: int) -> int:
    """Return the bits of error and warning, at their places in the frame, while neither is active."""
    idle_bits = 0
    for placed_field in placed_layout.fields:
        is_status = (frame_status_mask >> placed_field.low) & 1
        if is_status and _is_set_when_idle(placed_field.field.kind):
            idle_bits |= placed_field.mask << placed_field.low
    return idle_bits


def _is_set_when_idle(kind: Kind) -> bool:
    """Return whether a status bit is 1 while it is inactive: an active-low flag, or an unused bit."""
    if isinstance(kind, Flag):
        return kind.active_low
    # An unused status bit is 1, like an inactive flag over BiSS.
    return isinstance(kind, Unused)


def other_answer_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the frame with each other answer to the open questions of the manual, complete or read one bit too long.

    Answers that do not change the layout, or that lead to a frame without a CRC, are skipped.
    """
    for answers, changed_parameters in answer_combinations(device.alternatives_of(placed_layout.layout)):
        other_layout = placed_layout.layout.place({**variant.parameters, **changed_parameters})
        crc = device.crc_of(other_layout)
        if other_layout == placed_layout or crc is None:
            continue
        option_text = " ".join(_decode_options(device, answers))
        description = f"{other_layout.bits} bits, as with {option_text}"
        if typed_frame.may_have(other_layout.bits):
            yield frame_hypothesis("other_answer", description, other_layout, crc, typed_frame.number)
        if typed_frame.may_have(other_layout.bits + 1):
            too_long_text = f"{description}, read one bit too long"
            yield frame_hypothesis("other_answer", too_long_text, other_layout, crc, typed_frame.number >> 1)


def _decode_options(device: Device, answers: Sequence[Answer]) -> Iterator[str]:
    """Yield the options of ``decode`` that choose the answers, such as ``--choose zero_bit=left_out``."""
    for alternative in device.alternatives:
        for answer in answers:
            if answer in alternative.answers:
                yield f"--choose {alternative.name}={answer.name}"
