"""Frames of other order codes, or of an encoder whose registers select other widths."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice, product
from typing import NamedTuple

from ..model import Constant, Crc, Device, Layout, PlacedLayout, Variant
from ..order_codes.parameters import possible_states, run_time_widths, with_changed
from ..say.plain_text import count_with_unit, first_of
from .hypotheses import Hypothesis, TypedFrame, check_constant_bits, frame_hypothesis

#: A truncated frame of another order code is recognised by the rest of its CRC. At most this many bits may be missing.
_MOST_CUT_BITS = 2
#: Most register states to try, far more than today's encoders have.
_MOST_STATES = 4096


class FrameShape(NamedTuple):
    """A layout of a certain length, and the order codes that send it, or none if registers set that length."""

    placed_layout: PlacedLayout
    order_codes: tuple[str, ...]


def other_order_code_hypotheses(
    device: Device, variant: Variant, placed_layout: PlacedLayout, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses with the frame of another order code, or with a frame that results from other register values.

    The frame is complete, read too long, or truncated.
    """
    for crc in device.crcs_of(placed_layout.layout):
        yield from _hypotheses_with_crc(device, variant, placed_layout, crc, typed_frame)


def _hypotheses_with_crc(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc, typed_frame: TypedFrame
) -> Iterator[Hypothesis]:
    """Yield hypotheses with frames of other order codes or register values that end with this CRC.

    The typed frame is complete, or shorter with extra bits, or longer without its last 1 or 2 bits.
    """
    shapes_by_length = _shapes_by_length(device, variant, placed_layout, crc)
    yield from _complete_frame_hypotheses(variant, placed_layout, crc, typed_frame, shapes_by_length)
    for shape_bits, shapes in shapes_by_length.items():
        extra_bits = placed_layout.bits - shape_bits
        if extra_bits > 0 and typed_frame.may_have(placed_layout.bits):
            yield _too_long_hypothesis(variant, shapes, crc, typed_frame.number, extra_bits)
        # A longer frame that lacks a few bits.
        elif -_MOST_CUT_BITS <= extra_bits < 0 and typed_frame.bits == placed_layout.bits:
            yield _too_short_hypothesis(variant, shapes, crc, typed_frame.number, lost_bits=-extra_bits)


def _too_long_hypothesis(
    variant: Variant, shapes: Sequence[FrameShape], crc: Crc, number: int, extra_bits: int
) -> Hypothesis:
    """Return the hypothesis that ``number`` is a shorter frame followed by ``extra_bits`` bits.

    ``shapes`` are the layouts with the length of the shorter frame.
    """
    # The extra bits are the stop bit and zeros, since the master holds SLI at 0. A single bit may be anything.
    zero_bits = extra_bits if extra_bits > 1 else 0
    zero_mask = (1 << zero_bits) - 1
    are_zero_bits_right = number & zero_mask == 0
    frame = number >> extra_bits
    shape = _possible_shape(shapes, frame)
    length_text = f"{shape.placed_layout.bits} bits"
    mistake_text = f", read {count_with_unit(extra_bits, 'bit')} too long"
    hypothesis = frame_hypothesis(
        _mistake_kind(shape.order_codes),
        f"{length_text}, {_sender_text(variant, shape.order_codes)}{mistake_text}",
        shape.placed_layout,
        crc,
        frame,
        determined_bits=zero_bits,
        are_determined_right=are_zero_bits_right,
        order_codes=shape.order_codes,
    )
    return _with_common_template(hypothesis, length_text, mistake_text)


def _too_short_hypothesis(
    variant: Variant, shapes: Sequence[FrameShape], crc: Crc, number: int, lost_bits: int
) -> Hypothesis:
    """Return the hypothesis that ``number`` is a longer frame without its last ``lost_bits`` bits.

    ``shapes`` are the layouts with the length of the longer frame.
    """
    # The lost bits are 0 here, and ``frame_hypothesis`` does not compare them.
    frame = number << lost_bits
    shape = _possible_shape(shapes, frame)
    length_text = f"{shape.placed_layout.bits} bits"
    mistake_text = f", read {count_with_unit(lost_bits, 'bit')} too short"
    hypothesis = frame_hypothesis(
        _mistake_kind(shape.order_codes),
        f"{length_text}, {_sender_text(variant, shape.order_codes)}{mistake_text}",
        shape.placed_layout,
        crc,
        frame,
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
    """Yield a hypothesis with the complete frame of another order code or other register values, if possible.

    If leading zeros are not known, several lengths are possible. The shortest hypothesis represents all, with all order
    codes.
    """
    # A text without leading zeros that fits into the expected frame is not explained by a longer frame.
    has_known_length = typed_frame.exact or typed_frame.bits > placed_layout.bits
    if not has_known_length:
        return
    possible_shapes: list[FrameShape] = []
    for shape_bits, shapes in shapes_by_length.items():
        if typed_frame.may_have(shape_bits):
            possible_shapes.append(_possible_shape(shapes, typed_frame.number))
    if not possible_shapes:
        return
    # If the text may have any number of leading zeros, the CRC cannot distinguish these lengths. The shapes come
    # sorted by length.
    shortest_layout = possible_shapes[0].placed_layout
    order_codes = _order_codes_of(possible_shapes)
    length_text = f"{shortest_layout.bits} bits"
    if len(possible_shapes) > 1:
        length_text += " or more"
    hypothesis = frame_hypothesis(
        _mistake_kind(order_codes),
        f"{length_text}, {_sender_text(variant, order_codes)}",
        shortest_layout,
        crc,
        typed_frame.number,
        order_codes=order_codes,
    )
    yield _with_common_template(hypothesis, length_text, mistake_text="")


def _with_common_template(hypothesis: Hypothesis, length_text: str, mistake_text: str) -> Hypothesis:
    """Return the hypothesis with a template without the order codes, which can differ between frames of one encoder."""
    if not hypothesis.order_codes:
        return hypothesis
    return replace(hypothesis, template=f"{length_text}, the frame of another order code{mistake_text}")


def _possible_shape(shapes: Sequence[FrameShape], frame: int) -> FrameShape:
    """Return the likeliest shape for the frame, with the order codes of all possible shapes.

    The shapes all have the length of the frame. Shapes whose constant bits are right are possible, or all if there are
    no such shapes. The possible shape with the fewest constant bits is the likeliest.
    """
    constants = [check_constant_bits(shape.placed_layout, frame) for shape in shapes]
    right_shapes = [shape for shape, (_, are_right) in zip(shapes, constants, strict=True) if are_right]
    possible_shapes = right_shapes or shapes
    # The first item of a check is the number of constant bits.
    likeliest = min(possible_shapes, key=lambda shape: check_constant_bits(shape.placed_layout, frame)[0])
    return FrameShape(likeliest.placed_layout, _order_codes_of(possible_shapes))


def _order_codes_of(shapes: Sequence[FrameShape]) -> tuple[str, ...]:
    return tuple(order_code for shape in shapes for order_code in shape.order_codes)


def _mistake_kind(order_codes: Sequence[str]) -> str:
    return "other_order_code" if order_codes else "other_widths"


def _sender_text(variant: Variant, order_codes: Sequence[str]) -> str:
    """Return which encoders send a frame: ``the frame of X-12 or X-14``, ``the frame of X-12 and 5 more``.

    Without order codes, it is the frame of ``variant`` with other register values.
    """
    if not order_codes:
        return f"the frame that {variant.code} sends when its registers select other widths"
    if len(order_codes) == 2:
        return f"the frame of {order_codes[0]} or {order_codes[1]}"
    return f"the frame of {first_of(order_codes, 1)}"


def _shapes_by_length(
    device: Device, variant: Variant, placed_layout: PlacedLayout, crc: Crc
) -> dict[int, list[FrameShape]]:
    """Return the shapes with this CRC by length in bits, shortest first, without the length of the expected frame.

    Shapes of one length differ in their constant bits, such as zeros above the position. If the expected frame has
    another CRC, its length counts, too. A length that only registers can select has no order codes.
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
        if length != placed_layout.bits or has_other_crc:
            shapes_by_length.setdefault(length, []).append(shape)
    return shapes_by_length


def _shapes_of_order_codes(device: Device, variant: Variant, layout: Layout) -> list[FrameShape]:
    """Return the layout for each order code of the interface, with the order codes that share it.

    They share it if length, CRC and the places of constants are the same.
    """
    # A question that the manual leaves open has the same answer for all frames.
    answer_names = [parameter.name for parameter in device.parameters if parameter.alternative]
    answers = {name: variant.parameters[name] for name in answer_names}
    shape_by_key: dict[object, FrameShape] = {}
    for other_variant in device.variants_over(variant.interface):
        other_layout = layout.place({**other_variant.parameters, **answers})
        constants = [field for field in other_layout.fields if isinstance(field.field.kind, Constant)]
        constant_places = tuple((constant.low, constant.width) for constant in constants)
        shape_key = other_layout.bits, device.crc_of(other_layout), constant_places
        # The layout belongs to the first order code with this key. Each order code adds its name.
        known_shape = shape_by_key.get(shape_key, FrameShape(other_layout, order_codes=()))
        order_codes = (*known_shape.order_codes, other_variant.code)
        shape_by_key[shape_key] = FrameShape(known_shape.placed_layout, order_codes)
    return list(shape_by_key.values())


def _parameters_of_states(device: Device, variant: Variant, layout: Layout) -> Iterator[Mapping[str, int]]:
    """Yield the parameters with each combination of values of the registers that decide the length of a layout.

    At most 4,096 combinations are tried. Without such registers, nothing is yielded.
    """
    registers = run_time_widths(device, layout)
    parameters_in_registers = [
        parameter for parameter in device.run_time_parameters if parameter.read_from in registers
    ]
    if not parameters_in_registers:
        return
    # A combination consists of a state for each field: values by parameter name.
    for state in islice(product(*possible_states(parameters_in_registers)), _MOST_STATES):
        yield with_changed(device, variant, ChainMap(*map(dict, state)))
