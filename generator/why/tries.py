"""A try with a frame that is one number: its text, and frames of other order codes or register values."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice, product
from types import MappingProxyType
from typing import NamedTuple

from ..model import (
    Choice,
    Constant,
    Crc,
    CrcValue,
    Decimal,
    Device,
    Flag,
    Layout,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Text,
    Unused,
    Variant,
    assert_never,
)
from ..model.record import dataclass
from ..order_codes.parameters import possible_states, run_time_widths, with_changed
from ..reference.bits import compute_bits, compute_bytes, parity_bit
from ..say.plain_text import counted, first_of


@dataclass(frozen=True, slots=True)
class BitText:
    """A frame as typed, with ``bits`` bits, or at least that many if the text does not show leading zeros.

    ``written`` is the number of bits of all digits, leading zeros included.
    """

    number: int
    bits: int
    exact: bool
    written: int = 0

    def may_have(self, bits: int) -> bool:
        """Return whether the frame may have been this number of bits."""
        return self.bits == bits if self.exact else self.bits <= bits


NOT_INVERTED = "crc_not_inverted"

#: Estimated relative frequency of each kind of mistake, with the reason. It applies to every single try.
MISTAKES: Mapping[str, float] = MappingProxyType(
    {
        "line_stuck": 8,  # no power, no encoder, or a disconnected wire
        NOT_INVERTED: 8,  # every master has a switch for it, and drivers differ
        "other_order_code": 8,  # a person types in the widths, and the label is worn
        "other_widths": 2,  # registers hold the widths, and someone once wrote to them
        "first_bit_missing": 4,  # sampled one clock late, such as with an uncompensated line delay
        "bits_in_front": 4,  # few manuals say whether a master's data begin at the start bit, at CDS or after it
        "bits_behind": 4,  # the stop bit is read as one more data bit
        "last_bits_missing": 4,  # one clock too few, or a frame cut to fit an integer
        "status_left_out": 4,  # a driver computes the CRC over the position only
        "status_not_sent": 4,  # a master's switch for status bits removes them from the data
        "raw_buffer": 64,  # the rule of the receiver finds the frame in every complete buffer
        "bits_around": 2,  # a buffer without acknowledge, since the program removed it
        "frame_inside": 0.5,  # nothing but the CRC shows where the frame begins
        "zeros_behind": 8,  # SSI with more clocks than the word has bits
        "zeros_in_front": 8,  # the word is at the end of a fixed number of clocks
        "word_twice": 8,  # some encoders repeat the word while the clock continues
        "other_answer": 8,  # tried only if the manual is ambiguous about the frame
        "status_turned": 2,  # drivers pass error and warning on as active high
        "other_code": 2,  # a master converts Gray code to binary before the CRC is checked
        "start_bits_in_crc": 2,  # other protocols include their start bit in the CRC
        "other_polynomial": 2,  # masters offer polynomials of many lengths, and their defaults differ
        "bytes_reversed": 2,  # a byte buffer is copied into an integer of the other byte order
        "bytes_in_front": 8,  # on two wires the sender receives its own request
        "bytes_behind": 4,  # the next frame has begun
        "echo": 16,  # the wires are swapped, or the receiver is never switched off
        "several_frames": 8,  # a program reads all that has arrived
        "first_byte_lost": 4,  # the receiver was enabled too late after the request
        "first_byte_left_out": 2,  # the control field is compared, but left out of the CRC
        "all_inverted": 2,  # the two wires of a differential pair are swapped
        "start_value": 1,  # other protocols start with all ones
        "polynomial_reversed": 1,  # a polynomial can be written from either end
        "words_swapped": 2,  # a buffer of 16-bit words is read on a machine of the other byte order
        "bits_reversed": 1,  # the bits are collected from the other end
        "bits_reversed_in_bytes": 1,  # a serial port receives the least significant bit first
        "crc_reversed": 0.5,  # the CRC is computed least significant bit first
    }
)

#: Likelihood, relative to a random bit, of an inactive flag or a reserved bit as documented, and of an active flag.
#: Faults are assumed to be rare.
IDLE, ACTIVE = 1.8, 0.2


@dataclass(frozen=True, slots=True)
class Try:
    """One mistake, tried.

    ``data`` are the ``bits`` bits that the CRC with parameters ``crc`` would cover. ``received`` are the first
    ``known_bits`` bits of the CRC to compare with. ``demanded`` is the number of other bits whose value the mistake
    determines, and ``holds`` is true if they have it. ``fixed`` is the number of frame bits that have their constant
    value. They prove nothing, but make one reading more likely than another, as do inactive flags (``likelihood``).
    ``number`` is the frame with the layout ``placed`` without the mistake, if that changes the frame. ``codes`` are
    the order codes that would send it. ``parts`` are the parts of the recording that contains the frame, and
    ``places`` is the number of places at which it was searched. ``template`` is the text without the details of this
    frame. ``crc`` is None if the frame has none.
    """

    kind: str
    text: str
    crc: Crc | None
    data: int
    bits: int
    received: int
    known_bits: int
    by_bytes: bool = False
    demanded: int = 0
    holds: bool = True
    fixed: int = 0
    likelihood: float = 1.0
    number: int = 0
    placed: PlacedLayout | None = None
    codes: tuple[str, ...] = ()
    parts: tuple[tuple[str, str], ...] = ()
    places: int = 1
    template: str = ""

    @property
    def fits(self) -> bool:
        """Whether a frame with the mistake has these bits: the ones that it determines, and the CRC."""
        if not self.holds:
            return False
        if self.crc is None:
            return True
        if self.by_bytes:
            computed = compute_bytes(self.crc, self.data.to_bytes(self.bits // 8, "big"))
        else:
            computed = compute_bits(self.crc, self.data, self.bits)
        missing_crc_bits = self.crc.width - self.known_bits
        return computed >> missing_crc_bits == self.received

    @property
    def one_in(self) -> int:
        """Average number of random frames among which one matches."""
        return max((1 << (self.known_bits + self.demanded)) // self.places, 1)

    @property
    def score(self) -> float:
        """Likelihood of a mistake that matches: its frequency, times the improbability of the match without it."""
        evidence = self.known_bits + max(self.demanded, self.fixed)
        return MISTAKES[self.kind] * self.likelihood * 2.0**evidence / self.places

    @property
    def question(self) -> tuple[object, ...]:
        """Key of the try. Tries with the same key match the same frames."""
        # With a start value of 0, leading zeros do not change the CRC, so the number of bits does not matter.
        has_start_value = self.crc is not None and self.crc.init != 0
        bits = self.bits if has_start_value else 0
        return self.crc, self.data, bits, self.received, self.known_bits


def fixed_bits(placed: PlacedLayout, number: int) -> tuple[int, bool]:
    """Return the number of bits in a frame that must have a certain value, and whether they all have it.

    These are constants, parity, and the field that identifies the layout.
    """
    bits, are_right = 0, True
    for placed_field in placed.fields:
        raw = number >> placed_field.low & placed_field.mask
        expected = _fixed_value(placed, placed_field, number)
        if expected is not None:
            bits += placed_field.width
            are_right = are_right and raw == expected
        elif placed_field.name == placed.layout.selector:
            # Of several values of the selector, each is right.
            free_bits = (len(placed.layout.selects) - 1).bit_length()
            bits += placed_field.width - free_bits
            are_right = are_right and raw in placed.layout.selects
    return bits, are_right


def _fixed_value(placed: PlacedLayout, placed_field: PlacedField, number: int) -> int | None:
    """Return the value that a constant or parity must have in ``number``, or None for other fields."""
    match placed_field.field.kind:
        case Constant(value):
            return value
        case Parity() as parity:
            return parity_bit(placed, parity, number)
        case Number() | Flag() | Choice() | Unused() | CrcValue() | Decimal() | Text():
            return None
        case _ as kind:
            assert_never(kind)


def likelihood(placed: PlacedLayout, number: int) -> float:
    """Return the likelihood of the flags and reserved bits, relative to random bits."""
    likelihood = 1.0
    for placed_field in placed.fields:
        raw = number >> placed_field.low & placed_field.mask
        match placed_field.field.kind:
            case Flag(active_low=active_low):
                is_active = bool(raw) != active_low
                likelihood *= ACTIVE if is_active else IDLE
            case Unused(value):
                is_as_documented = raw == value & placed_field.mask
                likelihood *= IDLE**placed_field.width if is_as_documented else ACTIVE
    return likelihood


def read_as(
    kind: str,
    words: str,
    placed: PlacedLayout,
    crc: Crc | None,
    number: int,
    lost: int = 0,
    demanded: int = 0,
    holds: bool = True,
    codes: Sequence[str] = (),
) -> Try:
    """Return a try in which the frame was ``number``, whose last ``lost`` bits were not received.

    Without a CRC, lost bits are those with which the parity is right.
    """
    if crc is None:
        return _without_crc(kind, words, placed, number, lost, demanded, holds)
    fixed, are_right = fixed_bits(placed, number)
    covered_data, covered_bits = covered_number(placed, number)
    return Try(
        kind=kind,
        text=words,
        crc=crc,
        data=covered_data,
        bits=covered_bits,
        # The CRC is at the end of the frame.
        received=(number & crc.mask) >> lost,
        known_bits=crc.width - lost,
        demanded=demanded + fixed,
        holds=holds and are_right,
        likelihood=likelihood(placed, number),
        number=number,
        placed=placed,
        codes=tuple(codes),
    )


def _without_crc(
    kind: str, words: str, placed: PlacedLayout, number: int, lost: int, demanded: int, holds: bool
) -> Try:
    """Return a try with a frame that only its constants and parity can contradict."""
    possible_frames = [number | last_bits for last_bits in range(1 << lost)]
    right_frames = [frame for frame in possible_frames if fixed_bits(placed, frame)[1]]
    frame = right_frames[0] if right_frames else number
    fixed, are_right = fixed_bits(placed, frame)
    return Try(
        kind=kind,
        text=words,
        crc=None,
        data=frame,
        bits=placed.bits,
        received=0,
        known_bits=0,
        demanded=demanded + max(fixed - lost, 0),
        holds=holds and are_right,
        likelihood=likelihood(placed, frame),
        number=frame,
        placed=placed,
    )


def covered_number(placed: PlacedLayout, number: int) -> tuple[int, int]:
    """Return the bits that the CRC covers, and how many they are."""
    low, bits = placed.crc_covers
    return number >> low & (1 << bits) - 1, bits


#: A truncated frame of another order code is recognised by the rest of its CRC. At most this many bits may be missing.
_CUT = 2
#: Most register states to try, far more than today's encoders have.
_STATES = 4096


class Shape(NamedTuple):
    """A layout of a certain length, and the order codes that send it, or none if registers set that length."""

    placed: PlacedLayout
    codes: tuple[str, ...]


def other_codes(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Iterator[Try]:
    """Yield tries with the frame of another order code, or with the frame that results from other register values.

    The frame is complete, read too long, or truncated.
    """
    for crc in device.crcs_of(placed.layout):
        yield from _other_codes_with(device, variant, placed, crc, text)


def _other_codes_with(device: Device, variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText) -> Iterator[Try]:
    """Yield tries with the frames that end with this CRC."""
    shapes_by_length = _shapes(device, variant, placed, crc)
    yield from _complete_frame_tries(variant, placed, crc, text, shapes_by_length)
    for bits, shapes in shapes_by_length.items():
        extra_bits = placed.bits - bits
        if extra_bits > 0 and text.may_have(placed.bits):
            # The first extra bit is the stop bit or whatever came instead. The others are 0: the master holds SLI at 0.
            zeros = extra_bits if extra_bits > 1 else 0
            are_zero = text.number & ((1 << zeros) - 1) == 0
            number = text.number >> extra_bits
            shape = _possible_shape(shapes, number)
            words = f"{bits} bits, {_sender(variant, shape.codes)}, read {counted(extra_bits, 'bit')} too long"
            kind = _kind(shape.codes)
            attempt = read_as(kind, words, shape.placed, crc, number, demanded=zeros, holds=are_zero, codes=shape.codes)
            yield _of_any_code(attempt, f"{bits} bits", f", read {counted(extra_bits, 'bit')} too long")
        elif -_CUT <= extra_bits < 0 and text.bits == placed.bits:
            lost_bits = -extra_bits
            number = text.number << lost_bits
            shape = _possible_shape(shapes, number)
            words = f"{bits} bits, {_sender(variant, shape.codes)}, read {counted(lost_bits, 'bit')} too short"
            attempt = read_as(_kind(shape.codes), words, shape.placed, crc, number, lost=lost_bits, codes=shape.codes)
            yield _of_any_code(attempt, f"{bits} bits", f", read {counted(lost_bits, 'bit')} too short")


def _complete_frame_tries(
    variant: Variant, placed: PlacedLayout, crc: Crc, text: BitText, shapes_by_length: Mapping[int, Sequence[Shape]]
) -> Iterator[Try]:
    """Yield a try with the complete frame of another order code or other register values."""
    possible_shapes: list[Shape] = []
    for bits, shapes in shapes_by_length.items():
        # A text without leading zeros that fits into the expected frame is not explained by a longer one.
        is_long_enough = text.exact or text.bits > placed.bits
        if is_long_enough and text.may_have(bits):
            possible_shapes.append(_possible_shape(shapes, text.number))
    if not possible_shapes:
        return
    # If the text may have any number of leading zeros, the CRC cannot distinguish these lengths.
    likely_placed = possible_shapes[0].placed
    codes = tuple(code for shape in possible_shapes for code in shape.codes)
    length_text = f"{likely_placed.bits} bits"
    if len(possible_shapes) > 1:
        length_text += " or more"
    words = f"{length_text}, {_sender(variant, codes)}"
    yield _of_any_code(read_as(_kind(codes), words, likely_placed, crc, text.number, codes=codes), length_text)


def _of_any_code(attempt: Try, length_text: str, cut: str = "") -> Try:
    """Return the try with a template without the order codes, which can differ between frames of one encoder."""
    if not attempt.codes:
        return attempt
    return replace(attempt, template=f"{length_text}, the frame of another order code{cut}")


def _possible_shape(shapes: Sequence[Shape], number: int) -> Shape:
    """Return the shape of this length with the fewest fixed bits, and all order codes that could send the frame."""
    possible_shapes = [shape for shape in shapes if fixed_bits(shape.placed, number)[1]] or shapes
    likeliest = min(possible_shapes, key=lambda shape: fixed_bits(shape.placed, number)[0])
    return Shape(likeliest.placed, tuple(code for shape in possible_shapes for code in shape.codes))


def _kind(codes: Sequence[str]) -> str:
    return "other_order_code" if codes else "other_widths"


def _sender(variant: Variant, codes: Sequence[str]) -> str:
    if not codes:
        return f"the frame that {variant.code} sends when its registers select other widths"
    if len(codes) == 2:
        return f"the frame of {codes[0]} or {codes[1]}"
    return f"the frame of {first_of(codes, 1)}"


def _shapes(device: Device, variant: Variant, placed: PlacedLayout, crc: Crc) -> dict[int, list[Shape]]:
    """Return the layout with this CRC in each other length that is possible for it, by length, shortest first.

    Those of one length differ in their fixed bits, such as zeros above the position. With another CRC than that of the
    expected frame, the length can be the same.
    """
    shapes = _shapes_of_order_codes(device, variant, placed)
    lengths = {shape.placed.bits for shape in shapes}
    for parameters in _parameters_of_states(device, variant, placed.layout):
        bits = placed.layout.bits.value(parameters)
        if bits not in lengths:
            lengths.add(bits)
            shapes.append(Shape(placed.layout.place(parameters), ()))
    shapes_by_length: dict[int, list[Shape]] = {}
    has_other_crc = device.crc_of(placed) != crc
    shapes_with_crc = [shape for shape in shapes if device.crc_of(shape.placed) == crc]
    for shape in sorted(shapes_with_crc, key=lambda shape: shape.placed.bits):
        if shape.placed.bits != placed.bits or has_other_crc:
            shapes_by_length.setdefault(shape.placed.bits, []).append(shape)
    return shapes_by_length


def _shapes_of_order_codes(device: Device, variant: Variant, placed: PlacedLayout) -> list[Shape]:
    """Return the layout for each order code, once for those with the same length, CRC and constant bits."""
    # A question that the manual leaves open has the same answer for all of them.
    answered = [parameter.name for parameter in device.parameters if parameter.alternative]
    answers = {name: variant.parameters[name] for name in answered}
    shapes: dict[object, Shape] = {}
    for other_variant in device.variants_over(variant.interface):
        other_placed = placed.layout.place({**other_variant.parameters, **answers})
        constants = [field for field in other_placed.fields if isinstance(field.field.kind, Constant)]
        key = (other_placed.bits, device.crc_of(other_placed), tuple((field.low, field.width) for field in constants))
        shape = shapes.get(key, Shape(other_placed, ()))
        shapes[key] = Shape(shape.placed, (*shape.codes, other_variant.code))
    return list(shapes.values())


def _parameters_of_states(device: Device, variant: Variant, layout: Layout) -> Iterator[Mapping[str, int]]:
    """Yield the parameters with other values of the registers that decide the length of a layout."""
    registers = run_time_widths(device, layout)
    parameters_in_registers = [width for width in device.run_time_parameters if width.read_from in registers]
    if not parameters_in_registers:
        return
    for state in islice(product(*possible_states(parameters_in_registers)), _STATES):
        yield with_changed(device, variant, ChainMap(*map(dict, state)))
