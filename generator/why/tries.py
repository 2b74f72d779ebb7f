"""A try with a frame that is one number: its text, and frames of other order codes or register values."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice, product
from types import MappingProxyType

from ..model import (
    Choice,
    Constant,
    Crc,
    CrcValue,
    Decimal,
    Device,
    Flag,
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
        "bits_reversed": 1,  # a serial port receives the least significant bit first
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
        if not self.holds:
            return False
        if self.crc is None:
            return True
        computed = (
            compute_bytes(self.crc, self.data.to_bytes(self.bits // 8, "big"))
            if self.by_bytes
            else compute_bits(self.crc, self.data, self.bits)
        )
        return computed >> (self.crc.width - self.known_bits) == self.received

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
        """Key of the try. Tries with the same key match the same frames. With init 0, leading zeros do not matter."""
        bits = self.bits if self.crc is not None and self.crc.init else 0
        return self.crc, self.data, bits, self.received, self.known_bits


def fixed_bits(placed: PlacedLayout, number: int) -> tuple[int, bool]:
    """Return the number of bits in a frame that must have a certain value, and whether they all have it.

    These are constants, parity, and the field that identifies the layout.
    """
    bits, holds = 0, True
    for placed_field in placed.fields:
        raw, expected = number >> placed_field.low & placed_field.mask, _fixed_value(placed, placed_field, number)
        if expected is not None:
            bits, holds = bits + placed_field.width, holds and raw == expected
        elif placed_field.name == placed.layout.selector:
            bits += placed_field.width - (len(placed.layout.selects) - 1).bit_length()
            holds = holds and raw in placed.layout.selects
    return bits, holds


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
            case Flag(active_low=low):
                likelihood *= ACTIVE if bool(raw) != low else IDLE
            case Unused(value):
                likelihood *= IDLE**placed_field.width if raw == value & placed_field.mask else ACTIVE
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
    fixed, are_right = fixed_bits(placed, number)
    if crc is None:
        return _without_crc(kind, words, placed, number, lost, demanded, holds)
    received = (number & crc.mask) >> lost
    return Try(
        kind,
        words,
        crc,
        *covered_number(placed, number),
        received,
        crc.width - lost,
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
    completed = (number | last_bits for last_bits in range(1 << lost))
    frame = next((frame for frame in completed if fixed_bits(placed, frame)[1]), number)
    fixed, are_right = fixed_bits(placed, frame)
    return Try(
        kind,
        words,
        None,
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
