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
    """Yield hypotheses, each with one mistake that could have turned a valid frame into the one that the user typed.

    ``placed_layout`` is the layout that the frame should have. If the CRC covers only a part of the frame, only
    different CRC parameters and moved or rearranged bits are tried.
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
    """Return the numbers of bits that may have been received, largest first.

    If the user may have omitted leading zeros, these are the length of the expected frame, and one bit less, since its
    first bit may be missing.
    """
    has_known_length = typed_frame.exact or typed_frame.bits > placed_layout.bits
    if has_known_length:
        return [typed_frame.bits]
    lengths = (placed_layout.bits, placed_layout.bits - 1)
    return [length for length in lengths if length >= typed_frame.bits]


def moved_frame_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the received bits are not exactly the frame.

    They may contain extra bits around the frame, lack its first or last bits, or be the user's own request. If no rule
    of the line finds the frame, and the frame has a CRC, it is searched at every bit. Nothing is yielded for a frame of
    0 bits.
    """
    line = LINES.get(line_name(device.interface(variant.interface)))
    if line is None or not placed_layout.bits:
        return
    if typed_frame.may_have(placed_layout.bits):
        yield from echo_hypotheses(device, variant, placed_layout, typed_frame.number)
    if variant.interface == Spi.name:
        yield from _left_out_command_hypotheses(placed_layout, crc, typed_frame)
    received_bits = recorded_bits(typed_frame, placed_layout.bits)
    extra_bits = typed_frame.written - placed_layout.bits
    if variant.interface == Spi.name and typed_frame.is_bytes and 0 < extra_bits < 8:
        # A word that does not fill its bytes can be at their beginning. The zeros in front are then received bits.
        received_bits = received_bits.zfill(typed_frame.written)
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
    """Return whether a frame with this CRC is long enough to lose as many bits as this offset says.

    Lost last bits must belong to the CRC, if there is one.
    """
    missing_bits = len(offset.missing) + offset.lost
    if missing_bits > placed_layout.bits:
        return False
    return crc is None or offset.lost <= crc.width


def _left_out_command_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that the first bits of an SPI word, which are sent during the command, are missing.

    They are assumed to be the constants that the layout requires.
    """
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
    # The constants that were assumed prove nothing.
    assumed_bits = sum(field.width for field in placed_layout.fields if _is_constant_from(field, remaining_bits))
    yield replace(hypothesis, determined_bits=constant_bits - assumed_bits)


def _bits_during_command(placed_layout: PlacedLayout, crc: Crc | None) -> tuple[int, int]:
    """Return the first bits of a word, before its data, and their number: ``(0x8021, 16)``.

    These are constants, and bits that the CRC does not cover, which are 0 in the result. If they are not whole bytes,
    the result is ``(0, 0)``.
    """
    low, width = placed_layout.crc_covers if crc is not None else (0, placed_layout.bits)
    first_bit_above_covered = low + width
    command = 0
    lowest_bit = placed_layout.bits
    fields_as_sent = sorted(placed_layout.fields, key=lambda placed_field: -placed_field.low)
    for field in fields_as_sent:
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
    """Yield hypotheses in which the ``length`` bits of ``number`` contain the frame with an offset.

    An offset describes extra bits before and after the frame, and missing first and last bits. Extra bits that must be
    1 are evidence, and those that are mostly 0 change the likelihood. Without a CRC, there is a hypothesis for each
    value of the missing last bits. With a CRC, these bits belong to it, and are 0 here.
    """
    frame_part_length = length - len(offset.front) - len(offset.behind)
    front_and_frame_part = number >> len(offset.behind)
    behind = number & ((1 << len(offset.behind)) - 1)
    front = front_and_frame_part >> frame_part_length
    frame_part = front_and_frame_part & ((1 << frame_part_length) - 1)
    missing_first_bits = int(offset.missing or "0", 2)
    frame_without_last_bits = ((missing_first_bits << frame_part_length) | frame_part) << offset.lost
    start_bits = _bits_with_mark(offset.front, "1", front)
    mostly_zero_bits = _bits_with_mark(offset.front, "~", front) + _bits_with_mark(offset.behind, "~", behind)
    likelihood_around = prod(ACTIVE if bit else IDLE for bit in mostly_zero_bits)
    if crc is None:
        assumed_bits = offset.lost + len(offset.missing)
        bits_not_compared = assumed_bits
        values_of_last_bits = range(1 << offset.lost)
    else:
        assumed_bits = 0
        bits_not_compared = offset.lost
        values_of_last_bits = range(1)
    for last_bits in values_of_last_bits:
        hypothesis = frame_hypothesis(
            offset.kind,
            offset.text.format(offset.missing),
            placed_layout,
            crc,
            frame_without_last_bits | last_bits,
            lost_bits=bits_not_compared,
            determined_bits=len(start_bits),
            are_determined_right=all(start_bits),
        )
        yield replace(
            hypothesis,
            template=offset.text,
            likelihood=hypothesis.likelihood * likelihood_around,
            has_assumed_bit=assumed_bits > 0,
        )


def _bits_with_mark(marks: str, mark: str, received_bits: int) -> list[int]:
    """Return the extra bits before or after a frame that have a certain mark, last bit first.

    ``marks`` describes these bits: in ``1~``, the first is a start bit, which must be 1, and the second is mostly 0. If
    ``received_bits`` is 0b10, the result for the mark ``~`` is ``[0]``.
    """
    marks_from_last_bit = enumerate(reversed(marks))
    return [(received_bits >> bit) & 1 for bit, mark_of_bit in marks_from_last_bit if mark_of_bit == mark]


def rearranged_frame_hypotheses(
    variant: Variant, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which all bits are inverted, or the bits or bytes of the frame are in a different order.

    The received bits must have the length of the frame, possibly with leading zeros that complete a byte or word.
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
    if typed_frame.exact and not is_whole_bytes:
        return
    if kind == "words_swapped":
        padded_frame = swapped_words(typed_frame.number, padded_bits // 8)
    else:
        padded_frame = int.from_bytes(typed_frame.number.to_bytes(padded_bits // 8, "little"), "big")
    frame = padded_frame & ((1 << placed_layout.bits) - 1)
    are_padding_bits_zero = frame == padded_frame
    yield frame_hypothesis(
        kind,
        TEXTS[kind],
        placed_layout,
        crc,
        frame,
        determined_bits=padded_bits - placed_layout.bits,
        are_determined_right=are_padding_bits_zero,
    )


def swapped_words(number: int, byte_count: int) -> int:
    """Return a number of ``byte_count`` bytes, which must be even, with the two bytes of each 16-bit word swapped."""
    original_bytes = number.to_bytes(byte_count, "big")
    swapped_bytes = bytearray(byte_count)
    swapped_bytes[0::2] = original_bytes[1::2]
    swapped_bytes[1::2] = original_bytes[0::2]
    return int.from_bytes(swapped_bytes, "big")


def _removed_status_hypotheses(placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the error and warning bits are missing from the frame.

    Either the CRC covers them as inactive, or it covers only the other bits. In the expected frame, they must be the
    last bits before the CRC.
    """
    frame_status_mask = status_mask(placed_layout)
    status_bits = frame_status_mask.bit_count()
    bits_without_status = placed_layout.bits - status_bits
    # The mask without the CRC then has ones only in its lowest bits.
    lowest_bits_mask = (1 << status_bits) - 1
    are_last_before_crc = frame_status_mask >> crc.width == lowest_bits_mask
    if not frame_status_mask or not are_last_before_crc or not typed_frame.may_have(bits_without_status):
        return
    data = typed_frame.number >> crc.width
    received_crc = typed_frame.number & crc.mask
    data_in_frame = data << (crc.width + status_bits)
    frame = data_in_frame | _idle_status(placed_layout, frame_status_mask) | received_crc
    yield frame_hypothesis("status_not_sent", TEXTS["removed_and_idle"], placed_layout, crc, frame)
    # If leading zeros may be missing, other hypotheses include a CRC over the bits before error and warning.
    if typed_frame.exact:
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
    """Return the inactive values of the error and warning bits, at their places in the frame."""
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
    """Yield hypotheses in which a different answer to a question that the manual leaves open applies to the frame.

    The frame is complete, or one extra bit was read. Answers that do not change the layout, or that lead to a frame
    without a CRC, are skipped.
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
    """Yield the command-line option of ``decode`` that chooses each answer, such as ``--choose zero_bit=left_out``."""
    for alternative in device.alternatives:
        for answer in answers:
            if answer in alternative.answers:
                yield f"--choose {alternative.name}={answer.name}"
