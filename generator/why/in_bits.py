"""Common mistakes with a frame that is one number: BiSS, or any other bits with a CRC at the end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import prod
from typing import NamedTuple

from ..model import (
    Answer,
    Biss,
    Constant,
    Crc,
    Device,
    Flag,
    Kind,
    PlacedLayout,
    Spi,
    Unused,
    Variant,
    answer_combinations,
)
from .exchanges import echo_hypotheses
from .hypotheses import (
    ACTIVE,
    AFTER_COMMAND,
    IDLE,
    TEXTS,
    Hypothesis,
    TypedFrame,
    frame_hypothesis,
    likelihood,
    possible_lengths,
)
from .other_crcs import other_crc_hypotheses, other_polynomial_hypotheses, status_mask
from .other_order_codes import other_order_code_hypotheses
from .rearranged import rearranged_frame_hypotheses
from .recordings import (
    LINES,
    FrameOffset,
    LineMistakes,
    line_name,
    recorded_bits,
    recording_hypotheses,
    window_hypotheses,
)


def all_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses, each with one mistake that could have turned a valid frame into the one that the user typed.

    ``placed_layout`` is the layout that the frame should have. If the CRC covers only a part of the frame, only
    different CRC parameters and moved or rearranged bits are tried.
    """
    if placed_layout.bits in possible_lengths(placed_layout, typed_frame):
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
    if typed_frame.may_have_length(placed_layout.bits):
        yield from echo_hypotheses(device, variant, placed_layout, typed_frame.number)
    if variant.interface == Spi.name:
        yield from _left_out_command_hypotheses(placed_layout, crc, typed_frame)
        yield from _idle_command_hypotheses(placed_layout, crc, typed_frame)
        yield from _data_offset_hypotheses(line, placed_layout, crc, typed_frame)
    received_bits = recorded_bits(typed_frame, placed_layout.bits)
    extra_bits = typed_frame.digit_bits - placed_layout.bits
    if variant.interface == Spi.name and typed_frame.is_bytes and 0 < extra_bits < 8:
        # A word that does not fill its bytes can be at their beginning. The zeros in front are then received bits.
        received_bits = received_bits.zfill(typed_frame.digit_bits)
    hypotheses_by_rule: list[Hypothesis] = []
    possible_offsets = [offset for offset in line.offsets if _can_lose_bits(placed_layout, crc, offset)]
    for length in possible_lengths(placed_layout, typed_frame):
        for offset in possible_offsets:
            if placed_layout.bits + offset.additional_bits == length:
                hypotheses_by_rule += _offset_hypotheses(
                    placed_layout=placed_layout, crc=crc, offset=offset, number=typed_frame.number, length=length
                )
    hypotheses_by_rule += recording_hypotheses(line, placed_layout, crc, received_bits)
    yield from hypotheses_by_rule
    is_frame_found = any(hypothesis.fits for hypothesis in hypotheses_by_rule)
    if crc is not None and not is_frame_found:
        yield from window_hypotheses(placed_layout, crc, received_bits)


def _can_lose_bits(placed_layout: PlacedLayout, crc: Crc | None, offset: FrameOffset) -> bool:
    """Return whether a frame with this CRC is long enough to lose as many bits as this offset says.

    Lost last bits must belong to the CRC, if there is one.
    """
    missing_bits = len(offset.missing_first_bits) + offset.lost_last_bits
    if missing_bits > placed_layout.bits:
        return False
    return crc is None or offset.lost_last_bits <= crc.width


def _left_out_command_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that the first bits of an SPI word, which are sent during the command, are missing.

    They are assumed to be the constants that the layout requires.
    """
    command, command_bits = _bits_during_command(placed_layout, crc)
    remaining_bits = placed_layout.bits - command_bits
    has_remaining_bits = typed_frame.may_have_length(remaining_bits) and typed_frame.digit_bits == remaining_bits
    has_command = command_bits > 0
    if not has_command or not has_remaining_bits:
        return
    description = TEXTS["command_left_out"].format(command_bits)
    frame = (command << remaining_bits) | typed_frame.number
    hypothesis = frame_hypothesis(
        kind="command_left_out", description=description, placed_layout=placed_layout, crc=crc, frame=frame
    )
    # The constants that were assumed prove nothing.
    assumed_bits = _constant_bits_at_or_above(placed_layout, remaining_bits)
    yield replace(hypothesis, determined_bits=hypothesis.determined_bits - assumed_bits)


def _idle_command_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that only MISO was recorded, which was idle during the command.

    The first bits of the SPI word are then all 0 or all 1, although the layout requires other constants.
    """
    command, command_bits = _bits_during_command(placed_layout, crc)
    remaining_bits = placed_layout.bits - command_bits
    assumed_bits = _constant_bits_at_or_above(placed_layout, remaining_bits)
    are_bits_typed = typed_frame.is_length_known or typed_frame.digit_bits > remaining_bits
    has_data = remaining_bits > 0
    is_possible = are_bits_typed and typed_frame.may_have_length(placed_layout.bits)
    if not assumed_bits or not has_data or not is_possible:
        return
    received_command = typed_frame.number >> remaining_bits
    all_ones = (1 << command_bits) - 1
    if received_command == command or received_command not in (0, all_ones):
        return
    level = received_command & 1
    description = TEXTS["command_idle"].format(command_bits, level)
    data = typed_frame.number & ((1 << remaining_bits) - 1)
    frame = (command << remaining_bits) | data
    hypothesis = frame_hypothesis(
        kind="command_left_out", description=description, placed_layout=placed_layout, crc=crc, frame=frame
    )
    # Instead of the constants that were assumed, the idle bits are the evidence. They can have two values.
    idle_evidence = command_bits - 1
    yield replace(hypothesis, determined_bits=hypothesis.determined_bits - assumed_bits + idle_evidence)


def _data_offset_hypotheses(
    line: LineMistakes, placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the first bits of an SPI word, the command, are intact, and the data are shifted.

    The master sends the command itself, so on a shared line it is correct even if the data are read with the wrong
    clock edge. Nothing is yielded if the command has no constant, which would show that it is intact, or if no data
    follow it.
    """
    _, command_bits = _bits_during_command(placed_layout, crc)
    remaining_bits = placed_layout.bits - command_bits
    constant_bits = _constant_bits_at_or_above(placed_layout, remaining_bits)
    has_data = remaining_bits > 0
    if not constant_bits or not has_data or not typed_frame.may_have_length(placed_layout.bits):
        return
    for offset in line.offsets:
        if offset.additional_bits != 0 or not _can_lose_bits(placed_layout, crc, offset):
            continue
        hypotheses = _offset_hypotheses(
            placed_layout=placed_layout,
            crc=crc,
            offset=offset,
            number=typed_frame.number,
            length=placed_layout.bits,
            command_bits=command_bits,
        )
        for hypothesis in hypotheses:
            # The intact command does not prove that the data are shifted.
            determined_bits = hypothesis.determined_bits
            yield replace(
                hypothesis,
                determined_bits=max(determined_bits - constant_bits, 0),
                right_constant_bits=determined_bits,
            )


def data_bits_of_zero_reply(placed_layout: PlacedLayout, crc: Crc | None, typed_frame: TypedFrame) -> int:
    """Return the number of bits after the command of an SPI word if all of them are 0, and otherwise 0.

    The command must be right, and it must have a constant, which shows that it is a command.
    """
    command, command_bits = _bits_during_command(placed_layout, crc)
    data_bits = placed_layout.bits - command_bits
    has_command = _constant_bits_at_or_above(placed_layout, data_bits) > 0
    is_command_and_zeros = (
        typed_frame.may_have_length(placed_layout.bits) and typed_frame.number == command << data_bits
    )
    return data_bits if has_command and is_command_and_zeros else 0


def _bits_during_command(placed_layout: PlacedLayout, crc: Crc | None) -> tuple[int, int]:
    """Return the first bits of a word, before its data, and their number: ``(0x8021, 16)``.

    These are constants, and bits that the CRC does not cover, which are 0 in the result. If they are not whole bytes,
    the result is ``(0, 0)``.
    """
    low, width = placed_layout.covered_lowest_bit_and_width if crc is not None else (0, placed_layout.bits)
    first_bit_above_covered = low + width
    command = 0
    lowest_bit = placed_layout.bits
    fields_as_sent = sorted(placed_layout.fields, key=lambda placed_field: -placed_field.lowest_bit)
    for field in fields_as_sent:
        is_uncovered = field.lowest_bit >= first_bit_above_covered
        if not isinstance(field.field.kind, Constant) and not is_uncovered:
            break
        if isinstance(field.field.kind, Constant):
            command |= field.field.kind.value << field.lowest_bit
        lowest_bit = field.lowest_bit
    command_bits = placed_layout.bits - lowest_bit
    is_whole_bytes = command_bits % 8 == 0
    return (command >> lowest_bit, command_bits) if is_whole_bytes else (0, 0)


def _constant_bits_at_or_above(placed_layout: PlacedLayout, lowest_bit: int) -> int:
    """Return the number of bits in the constants of a layout whose bits are all at ``lowest_bit`` or above."""
    constants = [field for field in placed_layout.fields if isinstance(field.field.kind, Constant)]
    return sum(constant.width for constant in constants if constant.lowest_bit >= lowest_bit)


class _OffsetParts(NamedTuple):
    """The bits before a frame, the bits behind it, and the frame, whose missing last bits are 0."""

    bits_before: int
    bits_after: int
    frame_without_last_bits: int


def _divide_by_offset(offset: FrameOffset, number: int, length: int) -> _OffsetParts:
    """Divide the ``length`` bits of ``number`` into the extra bits of an offset and the frame between them."""
    frame_part_length = length - len(offset.bits_before) - len(offset.bits_after)
    number_without_bits_after = number >> len(offset.bits_after)
    frame_part = number_without_bits_after & ((1 << frame_part_length) - 1)
    missing_first_bits = int(offset.missing_first_bits or "0", 2)
    return _OffsetParts(
        bits_before=number_without_bits_after >> frame_part_length,
        bits_after=number & ((1 << len(offset.bits_after)) - 1),
        frame_without_last_bits=((missing_first_bits << frame_part_length) | frame_part) << offset.lost_last_bits,
    )


def _likelihood_of_extra_bits(offset: FrameOffset, received: _OffsetParts) -> float:
    """Return the likelihood of those extra bits that are mostly 0."""
    mostly_0_before = _bits_with_mark(offset.bits_before, "~", received.bits_before)
    mostly_0_after = _bits_with_mark(offset.bits_after, "~", received.bits_after)
    return prod(ACTIVE if bit else IDLE for bit in (*mostly_0_before, *mostly_0_after))


def _offset_hypotheses(
    placed_layout: PlacedLayout,
    crc: Crc | None,
    offset: FrameOffset,
    number: int,
    length: int,
    *,
    command_bits: int = 0,
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the ``length`` bits of ``number`` contain the frame with an offset.

    Extra bits that must be 1 are evidence, and those that are mostly 0 change the likelihood. Without a CRC, there is a
    hypothesis for each value of the missing last bits. With a CRC, these bits belong to it, and are 0 here. The first
    ``command_bits`` bits are not affected.
    """
    affected_length = length - command_bits
    command = number >> affected_length
    received = _divide_by_offset(offset, number & ((1 << affected_length) - 1), affected_length)
    frame_without_last_bits = (command << (placed_layout.bits - command_bits)) | received.frame_without_last_bits
    template = TEXTS["after_command"].format(offset.text) if command_bits else offset.text
    start_bits = _bits_with_mark(offset.bits_before, "1", received.bits_before)
    assumed_bits = offset.lost_last_bits + len(offset.missing_first_bits) if crc is None else 0
    for last_bits in range(1 << offset.lost_last_bits) if crc is None else range(1):
        hypothesis = frame_hypothesis(
            kind=offset.kind,
            description=template.format(offset.missing_first_bits),
            placed_layout=placed_layout,
            crc=crc,
            frame=frame_without_last_bits | last_bits,
            lost_bits=assumed_bits if crc is None else offset.lost_last_bits,
            determined_bits=len(start_bits),
            do_determined_bits_match=all(start_bits),
        )
        yield replace(
            hypothesis,
            template=template,
            likelihood=hypothesis.likelihood * _likelihood_of_extra_bits(offset, received),
            has_assumed_bit=assumed_bits > 0,
            relative_frequency=AFTER_COMMAND if command_bits else 1.0,
        )


def _bits_with_mark(marks: str, mark: str, received_bits: int) -> list[int]:
    """Return the extra bits before or after a frame that have a certain mark, last bit first.

    ``marks`` describes these bits: in ``1~``, the first is a start bit, which must be 1, and the second is mostly 0. If
    ``received_bits`` is 0b10, the result for the mark ``~`` is ``[0]``.
    """
    marks_from_last_bit = enumerate(reversed(marks))
    return [(received_bits >> bit) & 1 for bit, mark_of_bit in marks_from_last_bit if mark_of_bit == mark]


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
    if not frame_status_mask or not are_last_before_crc or not typed_frame.may_have_length(bits_without_status):
        return
    data = typed_frame.number >> crc.width
    received_crc = typed_frame.number & crc.mask
    data_in_frame = data << (crc.width + status_bits)
    frame = data_in_frame | _idle_status(placed_layout, frame_status_mask) | received_crc
    yield frame_hypothesis(
        kind="status_not_sent", description=TEXTS["removed_and_idle"], placed_layout=placed_layout, crc=crc, frame=frame
    )
    # If leading zeros may be missing, other hypotheses include a CRC over the bits before error and warning.
    if typed_frame.is_length_known:
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
        is_status = (frame_status_mask >> placed_field.lowest_bit) & 1
        if is_status and _is_set_when_idle(placed_field.field.kind):
            idle_bits |= placed_field.mask << placed_field.lowest_bit
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
        if typed_frame.may_have_length(other_layout.bits):
            yield frame_hypothesis(
                kind="other_answer",
                description=description,
                placed_layout=other_layout,
                crc=crc,
                frame=typed_frame.number,
            )
        if typed_frame.may_have_length(other_layout.bits + 1):
            too_long_text = f"{description}, read one bit too long"
            yield frame_hypothesis(
                kind="other_answer",
                description=too_long_text,
                placed_layout=other_layout,
                crc=crc,
                frame=typed_frame.number >> 1,
            )


def _decode_options(device: Device, answers: Sequence[Answer]) -> Iterator[str]:
    """Yield the command-line option of ``decode`` that chooses each answer, such as ``--choose zero_bit=left_out``."""
    for alternative in device.alternatives:
        for answer in answers:
            if answer in alternative.answers:
                yield f"--choose {alternative.name}={answer.name}"
