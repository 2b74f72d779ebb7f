"""Frames whose CRC was computed with other parameters, or over bits other than the frame's."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import Crc, Flag, Number, PlacedLayout, Unused
from ..model.fields import KNOWN_CRCS
from ..reference.bits_and_values import binary_to_gray, gray_to_binary, reflect
from .hypotheses import (
    NOT_INVERTED,
    START_BITS,
    TEXTS,
    Hypothesis,
    TypedFrame,
    check_constant_bits,
    crc_covered_bits,
    likelihood,
)

#: Polynomials, including their top bit, that BiSS masters offer.
POLYNOMIALS = tuple(crc.polynomial for crc in KNOWN_CRCS if crc.in_masters)
#: Usual CRCs of 16 bits over bytes: name, polynomial without its top bit, start value, and whether it is reflected.
CRCS_OF_16_BITS = (
    ("MODBUS", 0x8005, 0xFFFF, True),
    ("CCITT-FALSE", 0x1021, 0xFFFF, False),
    ("XMODEM", 0x1021, 0, False),
    ("KERMIT", 0x1021, 0, True),
)
#: A kind of mistake, its description, and the CRC of a frame with that mistake.
OtherCrc = tuple[str, str, Crc]


def hypothesis_without_mistake(placed_layout: PlacedLayout, crc: Crc, frame: int) -> Hypothesis:
    """Return a hypothesis without a mistake: a frame with this layout and CRC. The caller adds the mistake.

    The received CRC is in the lowest bits of the frame.
    """
    constant_bits, are_constants_correct = check_constant_bits(placed_layout, frame)
    covered_data, covered_bits = crc_covered_bits(placed_layout, frame)
    return Hypothesis(
        kind="",
        description="",
        crc=crc,
        covered_data=covered_data,
        covered_bits=covered_bits,
        received_crc=frame & crc.mask,
        received_crc_bits=crc.width,
        right_constant_bits=constant_bits if are_constants_correct else 0,
        likelihood=likelihood(placed_layout, frame),
    )


def other_crc_hypotheses(
    placed_layout: PlacedLayout, crc: Crc, frame: int, *, has_start_bits: bool
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the CRC of a frame has different parameters, reversed bits, or covers different bits.

    If the CRC covers only a part of the frame, different bits are not tried. ``has_start_bits`` is true for BiSS, which
    sends a start bit before the frame.
    """
    without_mistake = hypothesis_without_mistake(placed_layout, crc, frame)
    for kind, description, other_crc in other_crcs_over_bits(crc):
        yield replace(without_mistake, kind=kind, description=description, crc=other_crc)
    reversed_crc = reflect(without_mistake.received_crc, crc.width)
    yield replace(without_mistake, kind="crc_reversed", description=TEXTS["crc_reversed"], received_crc=reversed_crc)
    if placed_layout.covers_part:
        return
    yield from _status_hypotheses(without_mistake, placed_layout, frame)
    yield from _position_code_hypotheses(without_mistake, placed_layout, frame)
    if has_start_bits:
        yield from _start_bit_hypotheses(without_mistake)


def other_crcs_over_bits(crc: Crc) -> Iterator[OtherCrc]:
    """Yield variants of a CRC over bits: with its inversion changed, other start values, or its polynomial reversed.

    Each CRC comes with the kind of mistake and its description, such as ``the start value of the CRC is 0x3f``.
    """
    inversion_text = "the CRC is not inverted" if crc.xorout else "the CRC is inverted"
    yield NOT_INVERTED, inversion_text, replace(crc, xorout=crc.xorout ^ crc.mask)
    for start in _other_start_values(crc):
        yield "start_value", f"the start value of the CRC is {start:#x}", replace(crc, init=start)
    reversed_polynomial = reflect(crc.poly_with_top_bit, crc.width + 1) & crc.mask
    with_top_bit = reversed_polynomial | (1 << crc.width)
    polynomial_text = f"the polynomial is {with_top_bit:#x}, written in reverse"
    yield "polynomial_reversed", polynomial_text, replace(crc, poly=reversed_polynomial)


def _other_start_values(crc: Crc) -> list[int]:
    """Return other start values that a CRC may have: 0, all ones, and those of known CRCs with the same polynomial."""
    known_starts = {known.init for known in KNOWN_CRCS if known.polynomial == crc.poly_with_top_bit}
    return sorted({0, crc.mask, *known_starts} - {crc.init})


def other_crcs_over_bytes(crc: Crc) -> Iterator[OtherCrc]:
    """Yield variants of a CRC over bytes: with its inversion changed, other start values, or other polynomials.

    Each CRC comes with the kind of mistake and its description. For the XOR of all bytes, a start value is the same as
    an inversion, so other start values are omitted. Other polynomials are tried for CRCs of 8 and 16 bits.
    """
    inversion_text = "the CRC is not inverted" if crc.xorout else "the CRC is inverted"
    if crc.is_xor:
        # With x^8 + 1, the polynomial of an XOR, the start value is simply added to the result.
        inversion_text += f", or its start value is {crc.mask ^ crc.init:#x} (the same here)"
    yield NOT_INVERTED, inversion_text, replace(crc, xorout=crc.xorout ^ crc.mask)
    if not crc.is_xor:
        for start in _other_start_values(crc):
            yield "start_value", f"the start value of the CRC is {start:#x}", replace(crc, init=start)
    if crc.width == 16:
        yield from _other_crcs_of_16_bits(crc)
    for polynomial in POLYNOMIALS:
        is_8_bit = polynomial.bit_length() == 9
        if crc.width == 8 and is_8_bit:
            without_top_bit = polynomial & 0xFF
            most_significant_first = replace(crc, poly=without_top_bit, refin=False, refout=False)
            least_significant_first = replace(crc, poly=without_top_bit, refin=True, refout=True)
            polynomial_text = f"the polynomial is {polynomial:#x}"
            yield "other_polynomial", f"{polynomial_text}, most significant bit first", most_significant_first
            yield "other_polynomial", f"{polynomial_text}, least significant bit first", least_significant_first


def _other_crcs_of_16_bits(crc: Crc) -> Iterator[OtherCrc]:
    """Yield usual CRCs of 16 bits that differ in more than the start value, and this one with the other bit order."""
    usual_crcs: list[Crc] = []
    for name, poly, init, is_reflected in CRCS_OF_16_BITS:
        usual_crc = replace(crc, poly=poly, init=init, refin=is_reflected, refout=is_reflected, xorout=0)
        usual_crcs.append(usual_crc)
        differs_in_start_value = replace(usual_crc, init=crc.init) == crc
        if not differs_in_start_value:
            yield "other_polynomial", f"the CRC is that of {name}", usual_crc
    in_other_order = replace(crc, refin=not crc.refin, refout=not crc.refout)
    if in_other_order not in usual_crcs:
        order = "most" if crc.refin else "least"
        yield "crc_reversed", f"the CRC is computed {order} significant bit first", in_other_order


def _status_hypotheses(without_mistake: Hypothesis, placed_layout: PlacedLayout, frame: int) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the CRC does not cover the error and warning bits, or these bits were inverted later.

    A master may convert them to active high after checking the CRC. Nothing is yielded if the frame has neither bit.
    """
    frame_status_mask = status_mask(placed_layout)
    if not frame_status_mask:
        return
    crc_bits = without_mistake.received_crc_bits
    # The CRC is below the covered data, so the mask is shifted by its width.
    data_without_status, data_bits = _remove_bits(
        without_mistake.covered_data, without_mistake.covered_bits, mask=frame_status_mask >> crc_bits
    )
    yield replace(
        without_mistake,
        kind="status_left_out",
        description=TEXTS["status_left_out"],
        covered_data=data_without_status,
        covered_bits=data_bits,
    )
    if not _has_active_low_status(placed_layout):
        return
    frame_with_inverted_status = frame ^ frame_status_mask
    yield replace(
        without_mistake,
        kind="status_turned",
        description=TEXTS["status_turned"],
        covered_data=frame_with_inverted_status >> crc_bits,
        likelihood=likelihood(placed_layout, frame_with_inverted_status),
    )


def _has_active_low_status(placed_layout: PlacedLayout) -> bool:
    """Return whether an error or warning bit of the frame is 1 while it is inactive.

    Only such a bit can be converted to active high. An unused bit in its place is also 1.
    """
    status_names = [status_field.name for status_field in placed_layout.layout.status_fields]
    present_fields = [field for field in placed_layout.fields if field.name in status_names and field.width]
    kinds = [placed_field.field.kind for placed_field in present_fields]
    return any(isinstance(kind, Unused) or (isinstance(kind, Flag) and kind.active_low) for kind in kinds)


def status_mask(placed_layout: PlacedLayout) -> int:
    """Return the mask of the error and warning bits in the frame, or 0 if the frame has neither."""
    status_names = [status_field.name for status_field in placed_layout.layout.status_fields]
    mask = 0
    for placed_field in placed_layout.fields:
        if placed_field.name in status_names:
            mask |= placed_field.mask << placed_field.lowest_bit
    return mask


def _remove_bits(data: int, data_bits: int, mask: int) -> tuple[int, int]:
    """Remove the bits in ``mask`` from ``data``, and return the other bits, moved together, and how many they are.

    For example, 0b101 without the bits in 0b010 is ``(0b11, 2)``.
    """
    remaining_data = remaining_bits = 0
    for bit in reversed(range(data_bits)):
        is_removed = (mask >> bit) & 1
        if not is_removed:
            value_of_bit = (data >> bit) & 1
            remaining_data = (remaining_data << 1) | value_of_bit
            remaining_bits += 1
    return remaining_data, remaining_bits


def _position_code_hypotheses(
    without_mistake: Hypothesis, placed_layout: PlacedLayout, frame: int
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the position was converted between Gray code and binary after the CRC was computed.

    The CRC then covers the frame with the other form of the position. Nothing is yielded for a frame without a number.
    """
    lowest_bit, width = _lowest_bit_and_width_of_position(placed_layout)
    if not width:
        return
    position_mask = (1 << width) - 1
    position = (frame >> lowest_bit) & position_mask
    frame_without_position = frame ^ (position << lowest_bit)
    conversions = (
        (gray_to_binary(position), TEXTS["covers_binary"]),
        (binary_to_gray(position), TEXTS["covers_gray"]),
    )
    for converted_position, description in conversions:
        converted_frame = frame_without_position | (converted_position << lowest_bit)
        covered_data = converted_frame >> without_mistake.received_crc_bits
        yield replace(without_mistake, kind="other_code", description=description, covered_data=covered_data)


def _lowest_bit_and_width_of_position(placed_layout: PlacedLayout) -> tuple[int, int]:
    """Return the lowest bit and the width of the number that a master would convert from Gray code to binary.

    This is the number that is sent in Gray code. Without one, it is the number that several fields form, or else the
    widest number. The width is 0 if the frame has no number.
    """
    joins = placed_layout.layout.joins
    if placed_layout.layout.gray_of:
        return placed_layout.lowest_bit_and_width_of(placed_layout.layout.gray_of)
    if joins:
        return placed_layout.lowest_bit_and_width_of(joins[0].name)
    number_fields = [field for field in placed_layout.fields if isinstance(field.field.kind, Number)]
    if not number_fields:
        return 0, 0
    widest_field = max(number_fields, key=lambda placed_field: placed_field.width)
    return placed_layout.lowest_bit_and_width_of(widest_field.name)


def _start_bit_hypotheses(without_mistake: Hypothesis) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the CRC also covers the bits that BiSS sends before the frame.

    These are a start bit, a CDS bit, or both. They become the highest bits of the covered data.
    """
    for bits_before, description in START_BITS:
        highest_bits = int(bits_before, 2) << without_mistake.covered_bits
        yield replace(
            without_mistake,
            kind="start_bits_in_crc",
            description=description,
            covered_data=highest_bits | without_mistake.covered_data,
            covered_bits=without_mistake.covered_bits + len(bits_before),
        )


def other_polynomial_hypotheses(placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the CRC has a different polynomial, possibly of a different width.

    The data before the CRC have the expected length. With two bits of data (d) and an expected CRC of four bits, a CRC
    of three bits (c) leads to ``ddccc``, or to ``ddccc0`` if the expected number of bits was read. A CRC of five bits
    leads to ``ddccccc`` or ``ddcccc``. The 0 is the stop bit, and later bits are also 0, because the master holds SLI
    at 0. ``typed_frame``, the frame as the user typed it, must have one of these lengths, or lack only leading zeros.
    """
    data_bits = placed_layout.bits - crc.width
    for polynomial in POLYNOMIALS:
        if polynomial == crc.poly_with_top_bit:
            continue
        other_crc = _with_polynomial(crc, polynomial)
        complete_length = data_bits + other_crc.width
        expected_length = placed_layout.bits
        different_lengths = dict.fromkeys((complete_length, expected_length))
        for length in different_lengths:
            may_lack_leading_zeros = not typed_frame.is_length_known and length > typed_frame.bits
            if length == typed_frame.bits or may_lack_leading_zeros:
                yield _polynomial_hypothesis(
                    placed_layout=placed_layout, crc=crc, other_crc=other_crc, number=typed_frame.number, length=length
                )


def _with_polynomial(crc: Crc, polynomial: int) -> Crc:
    """Return the CRC with a different polynomial, which includes its top bit.

    The start value is 0 or all ones, and the CRC is inverted or not, like the original CRC.
    """
    width = polynomial.bit_length() - 1
    mask = (1 << width) - 1
    init = mask if crc.init else 0
    xorout = mask if crc.xorout else 0
    return replace(crc, width=width, poly=polynomial & mask, init=init, xorout=xorout)


def _polynomial_hypothesis(
    placed_layout: PlacedLayout, crc: Crc, other_crc: Crc, number: int, length: int
) -> Hypothesis:
    """Return the hypothesis that the ``length`` bits of ``number`` are the data of the frame and the CRC ``other_crc``.

    The data have the same length as in the expected frame. They are followed by the CRC, or only by its first bits, or
    by the CRC and zeros.
    """
    data_bits = placed_layout.bits - crc.width
    bits_after_data = length - data_bits
    data = number >> bits_after_data
    mask_after_data = (1 << bits_after_data) - 1
    number_after_data = number & mask_after_data
    received_crc_bits = min(other_crc.width, bits_after_data)
    zero_bits = bits_after_data - received_crc_bits
    zero_mask = (1 << zero_bits) - 1
    are_zero_bits_correct = number_after_data & zero_mask == 0
    # The expected frame with these data, to check its constants.
    frame_with_crc_0 = data << crc.width
    constant_bits, are_constants_correct = check_constant_bits(placed_layout, frame_with_crc_0)
    description = TEXTS["polynomial"].format(f"{other_crc.poly_with_top_bit:#x}", other_crc.width)
    if received_crc_bits < other_crc.width:
        description = TEXTS["bits_arrived"].format(description, received_crc_bits)
    elif zero_bits:
        description = TEXTS["then_zeros"].format(description)
    # In a frame of the expected length, the mistake does not move the constants, so they do not prove it.
    are_constants_evidence = length != placed_layout.bits
    return Hypothesis(
        kind="other_polynomial",
        description=description,
        crc=other_crc,
        covered_data=data,
        covered_bits=data_bits,
        received_crc=number_after_data >> zero_bits,
        received_crc_bits=received_crc_bits,
        determined_bits=zero_bits + (constant_bits if are_constants_evidence else 0),
        do_determined_bits_match=are_zero_bits_correct and (are_constants_correct or not are_constants_evidence),
        right_constant_bits=zero_bits + (constant_bits if are_constants_correct else 0),
        likelihood=likelihood(placed_layout, frame_with_crc_0),
    )
