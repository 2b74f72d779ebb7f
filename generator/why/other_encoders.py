"""Frames of other order codes, or of other register values, that explain a frame with a wrong CRC."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice, product

from ..model import Constant, Crc, Device, PlacedLayout, Variant
from ..order_codes.parameters import possible_states, run_time_widths, with_changed
from ..say.numbers import counted, first_of
from .tries import BitText, Try, fixed_bits, read_as

#: A truncated frame of another order code is recognised by the rest of its CRC. At most this many bits may be missing.
_CUT = 2
#: Most register states to try, far more than today's encoders have.
_STATES = 4096


#: A layout of a certain length, and the order codes that send it, or none if registers set that length.
Shape = tuple[PlacedLayout, tuple[str, ...]]


def other_codes(device: Device, variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield tries with the frame of another order code, or with the frame that results from other register values.

    The frame is complete, read too long, or truncated.
    """
    shapes = _shapes(device, variant, placed)
    yield from _complete_frame_tries(variant, placed, crc, text, shapes)
    for bits, shapes_of_length in shapes.items():
        extra_bits = placed.bits - bits
        if extra_bits > 0 and (text.bits == placed.bits if text.exact else text.bits <= placed.bits):
            # The first extra bit is the stop bit or whatever came instead. The others are 0: the master holds SLI at 0.
            zeros = extra_bits if extra_bits > 1 else 0
            last_bits = text.number & ((1 << zeros) - 1)
            number = text.number >> extra_bits
            other_placed, codes = _possible_shape(shapes_of_length, number)
            words = f"{bits} bits, {_sender(variant, codes)}, read {counted(extra_bits, 'bit')} too long"
            holds = not last_bits
            yield read_as(_kind(codes), words, other_placed, crc, number, demanded=zeros, holds=holds, codes=codes)
        elif -_CUT <= extra_bits < 0 and text.bits == placed.bits:
            number = text.number << -extra_bits
            other_placed, codes = _possible_shape(shapes_of_length, number)
            words = f"{bits} bits, {_sender(variant, codes)}, read {counted(-extra_bits, 'bit')} too short"
            yield read_as(_kind(codes), words, other_placed, crc, number, -extra_bits, codes=codes)


def _complete_frame_tries(
    variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText, shapes: Mapping[int, Sequence[Shape]]
) -> Iterator[Try]:
    """Yield a try with the complete frame of another order code or other register values."""
    whole: list[Sequence[Shape]] = []
    for bits, shapes_of_length in shapes.items():
        if bits == text.bits if text.exact else placed.bits < text.bits <= bits:
            whole.append(shapes_of_length)
    if whole:
        # If the text may have any number of leading zeros, the CRC cannot distinguish these lengths.
        likely_placed = _possible_shape(whole[0], text.number)[0]
        codes = tuple(code for shapes_of_length in whole for code in _possible_shape(shapes_of_length, text.number)[1])
        length_text = " or more" if len(whole) > 1 else ""
        yield read_as(
            _kind(codes),
            f"{likely_placed.bits} bits{length_text}, {_sender(variant, codes)}",
            likely_placed,
            crc,
            text.number,
            codes=codes,
        )


def _possible_shape(shapes: Sequence[Shape], number: int) -> Shape:
    """Return the shape of this length with the fewest fixed bits, and all order codes that could send the frame."""
    possible_shapes = [shape for shape in shapes if fixed_bits(shape[0], number)[1]] or shapes
    likeliest = min(possible_shapes, key=lambda shape: fixed_bits(shape[0], number)[0])
    return likeliest[0], tuple(code for _, codes in possible_shapes for code in codes)


def _kind(codes: Sequence[str]) -> str:
    return "other_order_code" if codes else "other_widths"


def _sender(variant: Variant, codes: Sequence[str]) -> str:
    if not codes:
        return f"the frame that {variant.code} sends when its registers select other widths"
    if len(codes) == 2:
        return f"the frame of {codes[0]} or {codes[1]}"
    return f"the frame of {first_of(codes, 1)}"


def _shapes(device: Device, variant: Variant, placed: PlacedLayout) -> dict[int, list[Shape]]:
    """Return the layout in each other length that is possible for it, by length, shortest first.

    Those of one length differ in their fixed bits, such as zeros above the position.
    """
    layouts_by_length: dict[tuple[int, object], tuple[PlacedLayout, list[str]]] = {}
    names = [parameter.name for parameter in device.parameters if parameter.alternative]
    answers = {name: variant.parameters[name] for name in names}
    for other_variant in device.variants_over(variant.interface):
        other_placed = placed.layout.place({**other_variant.parameters, **answers})
        constants = [field for field in other_placed.fields if isinstance(field.field.kind, Constant)]
        key = (other_placed.bits, tuple((field.low, field.width) for field in constants))
        layouts_by_length.setdefault(key, (other_placed, []))[1].append(other_variant.code)
    lengths = {bits for bits, _ in layouts_by_length}
    registers = run_time_widths(device, placed.layout)
    register_parameters = [width for width in device.run_time_parameters if width.read_from in registers]
    if register_parameters:
        for states in islice(product(*possible_states(register_parameters)), _STATES):
            parameters = with_changed(device, variant, ChainMap(*map(dict, states)))
            if placed.layout.bits.value(parameters) not in lengths:
                other_placed = placed.layout.place(parameters)
                lengths.add(other_placed.bits)
                layouts_by_length[other_placed.bits, ()] = (other_placed, [])
    shapes: dict[int, list[Shape]] = {}
    for (bits, _), (other_placed, codes) in sorted(layouts_by_length.items(), key=lambda pair: pair[0][0]):
        if bits != placed.bits:
            shapes.setdefault(bits, []).append((other_placed, tuple(codes)))
    return shapes
