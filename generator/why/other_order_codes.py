"""Frames of other order codes, or of an encoder whose registers select other widths."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice, product
from typing import NamedTuple

from ..model import Constant, Crc, Device, Layout, Parity, PlacedLayout, Variant
from ..order_codes.parameters import possible_states, run_time_widths, with_changed
from ..say import count_with_unit
from .hypotheses import OTHER_CODE_WITHOUT_CRC, TEXTS, Hypothesis, TypedFrame, check_constant_bits, frame_hypothesis

#: A truncated frame of another order code is recognized by the rest of its CRC. At most this many bits may be missing.
MOST_CUT_BITS = 2
#: Maximum number of register states to try, far more than today's encoders have.
MOST_STATES = 4096


#: The shapes of the last layout, by the identities of what they depend on. The value keeps these objects alive.
_shapes_of_last_layout: dict[tuple[int, int, int], tuple[tuple[Device, Variant, Layout], list[FrameShape]]] = {}


class FrameShape(NamedTuple):
    """A layout of a certain length, and the order codes that send it, or none if registers set that length."""

    placed_layout: PlacedLayout
    order_codes: tuple[str, ...]


def other_order_code_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which a different order code, or an encoder with different register values, sent the frame.

    Such a frame has other field widths. It may be complete, followed by extra bits, or truncated. Without a CRC, only a
    complete frame is considered.
    """
    if device.crc_of(placed_layout) is None:
        yield from _hypotheses_without_crc(device, variant, placed_layout, typed_frame)
        return
    for crc in device.crcs_of(placed_layout.layout):
        yield from _hypotheses_with_crc(device, variant, placed_layout, crc, typed_frame)


def _hypotheses_with_crc(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which an encoder with other field widths sent a frame that ends with this CRC.

    The received bits are the complete frame, a shorter frame followed by extra bits, or a longer frame without its last
    1 or 2 bits.
    """
    shapes_by_length = _shapes_by_length(device, variant, placed_layout, crc)
    yield from _complete_frame_hypotheses(variant, placed_layout, crc, typed_frame, shapes_by_length)
    for shape_bits, shapes in shapes_by_length.items():
        extra_bits = placed_layout.bits - shape_bits
        if extra_bits > 0 and typed_frame.may_have_length(placed_layout.bits):
            yield _too_long_hypothesis(
                variant=variant, shapes=shapes, crc=crc, number=typed_frame.number, extra_bits=extra_bits
            )
        elif -MOST_CUT_BITS <= extra_bits < 0 and typed_frame.bits == placed_layout.bits:
            yield _too_short_hypothesis(
                variant=variant, shapes=shapes, crc=crc, number=typed_frame.number, lost_bits=-extra_bits
            )


def _hypotheses_without_crc(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield the hypothesis, for each possible length, that the received bits are the frame of a different order code.

    Constants, parity and the length are the evidence. A frame of the expected length needs a constant or a parity bit,
    because otherwise it could contain any bits.
    """
    shapes_by_length = _shapes_by_length(device, variant, placed_layout, crc=None)
    for length, shapes in shapes_by_length.items():
        if not _may_be_complete(typed_frame, length, placed_layout.bits):
            continue
        shape = _possible_shape(shapes, typed_frame.number)
        length_text = TEXTS["bits"].format(length)
        hypothesis = frame_hypothesis(
            kind=_mistake_kind(shape.order_codes),
            description=f"{length_text}, {_sender_text(variant, shape.order_codes)}",
            placed_layout=shape.placed_layout,
            crc=None,
            frame=typed_frame.number,
            order_codes=shape.order_codes,
        )
        has_evidence = hypothesis.determined_bits > 0
        if has_evidence or length != placed_layout.bits:
            hypothesis = replace(hypothesis, relative_frequency=OTHER_CODE_WITHOUT_CRC)
            yield _with_common_template(hypothesis, length_text, mistake_text="")


def _may_be_complete(typed_frame: TypedFrame, length: int, expected_length: int) -> bool:
    """Return whether a typed frame may have exactly ``length`` bits.

    If the number of bits is not known, this is the expected length, or a length whose leading zeros were typed.
    """
    if typed_frame.is_length_known or not typed_frame.may_have_length(length):
        return typed_frame.may_have_length(length)
    return length == expected_length or length <= typed_frame.digit_bits


def _too_long_hypothesis(
    variant: Variant, shapes: Sequence[FrameShape], crc: Crc, number: int, extra_bits: int
) -> Hypothesis:
    """Return the hypothesis that ``number`` is a shorter frame followed by ``extra_bits`` bits.

    ``shapes`` are the layouts with the length of the shorter frame.
    """
    # Two or more extra bits are the stop bit and zeros, since the master holds SLI at 0. A single extra bit can be 1.
    zero_bits = extra_bits if extra_bits > 1 else 0
    zero_mask = (1 << zero_bits) - 1
    are_zero_bits_correct = number & zero_mask == 0
    frame = number >> extra_bits
    shape = _possible_shape(shapes, frame)
    length_text = TEXTS["bits"].format(shape.placed_layout.bits)
    mistake_text = TEXTS["read_too_long"].format(count_with_unit(extra_bits, "bit"))
    hypothesis = frame_hypothesis(
        kind=_mistake_kind(shape.order_codes),
        description=f"{length_text}, {_sender_text(variant, shape.order_codes)}{mistake_text}",
        placed_layout=shape.placed_layout,
        crc=crc,
        frame=frame,
        determined_bits=zero_bits,
        do_determined_bits_match=are_zero_bits_correct,
        order_codes=shape.order_codes,
    )
    return _with_common_template(hypothesis, length_text, mistake_text)


def _too_short_hypothesis(
    variant: Variant, shapes: Sequence[FrameShape], crc: Crc, number: int, lost_bits: int
) -> Hypothesis:
    """Return the hypothesis that ``number`` is a longer frame without its last ``lost_bits`` bits.

    ``shapes`` are the layouts with the length of the longer frame.
    """
    # The lost bits are 0 here, and are not compared.
    frame = number << lost_bits
    shape = _possible_shape(shapes, frame)
    length_text = TEXTS["bits"].format(shape.placed_layout.bits)
    mistake_text = TEXTS["read_too_short"].format(count_with_unit(lost_bits, "bit"))
    hypothesis = frame_hypothesis(
        kind=_mistake_kind(shape.order_codes),
        description=f"{length_text}, {_sender_text(variant, shape.order_codes)}{mistake_text}",
        placed_layout=shape.placed_layout,
        crc=crc,
        frame=frame,
        lost_bits=lost_bits,
        order_codes=shape.order_codes,
    )
    return _with_common_template(hypothesis, length_text, mistake_text)


def _complete_frame_hypotheses(
    variant: Variant,
    placed_layout: PlacedLayout,
    crc: Crc,
    typed_frame: TypedFrame,
    shapes_by_length: Mapping[int, Sequence[FrameShape]],
) -> Iterator[Hypothesis]:
    """Yield the hypothesis that the received bits are the complete frame of an encoder with other field widths.

    If the user may have omitted leading zeros, several lengths are possible. A single hypothesis, with the shortest
    length and the order codes of all lengths, represents them, because the CRC cannot distinguish them.
    """
    # A number that fits in the expected frame does not need a longer frame as its explanation.
    has_known_length = typed_frame.is_length_known or typed_frame.bits > placed_layout.bits
    if not has_known_length:
        return
    possible_shapes: list[FrameShape] = []
    for shape_bits, shapes in shapes_by_length.items():
        if typed_frame.may_have_length(shape_bits):
            possible_shapes.append(_possible_shape(shapes, typed_frame.number))
    if not possible_shapes:
        return
    # The shapes are sorted by length.
    shortest_layout = possible_shapes[0].placed_layout
    order_codes = _order_codes_of(possible_shapes)
    length_text = TEXTS["bits_or_more" if len(possible_shapes) > 1 else "bits"].format(shortest_layout.bits)
    hypothesis = frame_hypothesis(
        kind=_mistake_kind(order_codes),
        description=f"{length_text}, {_sender_text(variant, order_codes)}",
        placed_layout=shortest_layout,
        crc=crc,
        frame=typed_frame.number,
        order_codes=order_codes,
    )
    yield _with_common_template(hypothesis, length_text, mistake_text="")


def _with_common_template(hypothesis: Hypothesis, length_text: str, mistake_text: str) -> Hypothesis:
    """Return the hypothesis with a text for several frames: without the order codes, which differ between frames."""
    if not hypothesis.order_codes:
        return hypothesis
    return replace(hypothesis, template=f"{length_text}, {TEXTS['of_other_code']}{mistake_text}")


def _possible_shape(shapes: Sequence[FrameShape], frame: int) -> FrameShape:
    """Return the likeliest of several shapes of the same length for a frame, with the order codes of all possible ones.

    A shape is possible if all constant bits of the frame are correct. If this is true of none, all are possible. The
    possible shape with the fewest constant bits is the likeliest.
    """
    matching_shapes: list[FrameShape] = []
    for shape in shapes:
        _, are_constants_correct = check_constant_bits(shape.placed_layout, frame)
        if are_constants_correct:
            matching_shapes.append(shape)

    def count_constant_bits(shape: FrameShape) -> int:
        constant_bits, _ = check_constant_bits(shape.placed_layout, frame)
        return constant_bits

    possible_shapes = matching_shapes or shapes
    likeliest = min(possible_shapes, key=count_constant_bits)
    return FrameShape(likeliest.placed_layout, _order_codes_of(possible_shapes))


def _order_codes_of(shapes: Sequence[FrameShape]) -> tuple[str, ...]:
    """Return the order codes that send a frame with any of these shapes."""
    return tuple(order_code for shape in shapes for order_code in shape.order_codes)


def _mistake_kind(order_codes: Sequence[str]) -> str:
    """Return the kind of mistake: another order code, or other field widths if only registers set them."""
    return "other_order_code" if order_codes else "other_widths"


def _sender_text(variant: Variant, order_codes: Sequence[str]) -> str:
    """Return a text for the encoders that send a frame: ``the frame of X-12 or X-14``, ``... of X-12 and 5 more``.

    Without order codes, it is the frame of ``variant`` with other register values.
    """
    if not order_codes:
        return TEXTS["of_registers"].format(variant.code)
    if len(order_codes) > 2:
        return TEXTS["of_more_codes"].format(order_codes[0], len(order_codes) - 1)
    return TEXTS["of_two_codes" if len(order_codes) == 2 else "of_code"].format(*order_codes)


def _shapes_by_length(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc | None
) -> dict[int, list[FrameShape]]:
    """Return the possible shapes of a frame with this CRC, grouped by length in bits, shortest first.

    Shapes of the same length differ in their constant bits, such as zeros above the position. The length of the
    expected frame is omitted, unless the expected frame has a different CRC, or none. Without a CRC, only the shape of
    the order code itself is omitted. A length that only registers can set has no order codes.
    """
    layout = placed_layout.layout
    shapes = _shapes_of_order_codes(device, variant, layout)
    known_lengths = {shape.placed_layout.bits for shape in shapes}
    for parameters in _parameters_of_states(device, variant, layout):
        length = layout.bits.value(parameters)
        if length not in known_lengths:
            known_lengths.add(length)
            shapes.append(FrameShape(layout.place(parameters), order_codes=()))
    has_other_crc = device.crc_of(placed_layout) != crc
    shapes_with_crc = [shape for shape in shapes if device.crc_of(shape.placed_layout) == crc]
    shapes_with_crc.sort(key=lambda shape: shape.placed_layout.bits)
    shapes_by_length: dict[int, list[FrameShape]] = {}
    for shape in shapes_with_crc:
        length = shape.placed_layout.bits
        is_other_shape = crc is None and variant.code not in shape.order_codes
        if length != placed_layout.bits or has_other_crc or is_other_shape:
            shapes_by_length.setdefault(length, []).append(shape)
    return shapes_by_length


def _shapes_of_order_codes(device: Device, variant: Variant, layout: Layout) -> list[FrameShape]:
    """Return the different shapes of a layout over all order codes of the interface, each with its order codes.

    Order codes share a shape if the length, the CRC, and the places of the constants and parity bits are the same. The
    shapes are stored, because several frames usually have the same layout.
    """
    cache_key = id(device), id(variant), id(layout)
    if cache_key not in _shapes_of_last_layout:
        _shapes_of_last_layout.clear()
        shapes = _compute_shapes_of_order_codes(device, variant, layout)
        # The objects are kept, so that no other object gets the same identity.
        _shapes_of_last_layout[cache_key] = (device, variant, layout), shapes
    _, shapes = _shapes_of_last_layout[cache_key]
    return list(shapes)


def _compute_shapes_of_order_codes(device: Device, variant: Variant, layout: Layout) -> list[FrameShape]:
    """Return the different shapes of a layout over all order codes of the interface, each with its order codes."""
    # The user's answers to questions that the manual leaves open apply to all order codes.
    answer_names = [parameter.name for parameter in device.parameters if parameter.alternative]
    answers = {name: variant.parameters[name] for name in answer_names}
    shape_by_key: dict[object, FrameShape] = {}
    for other_variant in device.variants_over(variant.interface):
        other_layout = layout.place({**other_variant.parameters, **answers})
        fixed_fields = [field for field in other_layout.fields if isinstance(field.field.kind, (Constant, Parity))]
        fixed_places = tuple((field.lowest_bit, field.width) for field in fixed_fields)
        shape_key = other_layout.bits, device.crc_of(other_layout), fixed_places
        # The layout belongs to the first order code with this key. Each order code adds its name.
        known_shape = shape_by_key.get(shape_key, FrameShape(other_layout, order_codes=()))
        order_codes = (*known_shape.order_codes, other_variant.code)
        shape_by_key[shape_key] = FrameShape(known_shape.placed_layout, order_codes)
    return list(shape_by_key.values())


def states_of_widths(device: Device, layout: Layout) -> Sequence[Sequence[Mapping[str, int]]]:
    """Return the possible states of each register field that affects the length of a layout.

    A state gives the values of parameters by name. The result is empty if no register affects the length.
    """
    registers = run_time_widths(device, layout)
    parameters = [parameter for parameter in device.run_time_parameters if parameter.read_from in registers]
    return possible_states(parameters)


def _parameters_of_states(device: Device, variant: Variant, layout: Layout) -> Iterator[Mapping[str, int]]:
    """Yield the parameters of an order code for each combination of register values that affects a layout's length.

    At most 4,096 combinations are tried. Nothing is yielded if no register affects the length.
    """
    states_by_field = states_of_widths(device, layout)
    if not states_by_field:
        return
    # A combination has one state of each field: the values of parameters by name.
    for combination in islice(product(*states_by_field), MOST_STATES):
        yield with_changed(device, variant, ChainMap(*map(dict, combination)))
