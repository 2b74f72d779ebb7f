"""A common mistake that may explain a frame, what the frame must look like with it, and the texts of mistakes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from ..model import (
    Constant,
    Crc,
    Flag,
    Parity,
    PlacedField,
    PlacedLayout,
    Unused,
)
from ..model.record import dataclass
from ..reference.bits_and_values import compute_bits, compute_bytes, parity_bit


@dataclass(frozen=True, slots=True)
class TypedFrame:
    """A frame as the user typed it, with ``bits`` bits, or at least that many if leading zeros may be missing.

    ``is_length_known`` is true if none are missing. ``digit_bits`` is the number of bits of all digits, including
    leading zeros, or 0 for a decimal number. ``is_bytes`` is true for several bytes, which usually have all their
    zeros. If the frame is too short, ``text_with_zeros`` is its text in case that leading zeros are missing, not its
    last bits.
    """

    number: int
    bits: int
    is_length_known: bool
    digit_bits: int = 0
    is_bytes: bool = False
    text_with_zeros: str = ""

    def may_have_length(self, bits: int) -> bool:
        """Return whether the frame can have this number of bits, possibly with leading zeros that were not typed."""
        if self.is_length_known:
            return self.bits == bits
        return self.bits <= bits


NOT_INVERTED = "crc_not_inverted"
OTHER_MESSAGE = "other_message"

#: Estimated relative frequency of each kind of mistake, with the reason. It applies to every single hypothesis.
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
        "bits_around": 2,  # a buffer without acknowledge, or with a clock too many on both sides of the word
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
        "command_left_out": 8,  # a program keeps only the bytes after its command
        "echo": 16,  # the wires are swapped, or the receiver is never switched off
        "several_frames": 8,  # a program reads all that has arrived
        "first_byte_lost": 4,  # the receiver was enabled too late after the request
        "first_byte_left_out": 2,  # the control field is compared, but left out of the CRC
        "all_inverted": 2,  # the two wires of a differential pair are swapped
        "start_value": 1,  # other protocols start with all ones
        "polynomial_reversed": 1,  # a polynomial can be written from either end
        "words_swapped": 2,  # a buffer of 16-bit words is read on a machine of the other byte order
        "bits_reversed": 1,  # the bits are collected from the other end
        "bits_reversed_in_bytes": 2,  # SPI or a serial port receives the least significant bit first
        OTHER_MESSAGE: 16,  # a recording of the line contains requests, error messages and other replies
        "crc_bytes_swapped": 8,  # MODBUS sends its CRC low byte first and its numbers high byte first
        "crc_reversed": 0.5,  # the CRC is computed least significant bit first
    }
)

#: Likelihood, relative to a random bit, of an inactive flag or a reserved bit as documented, and of an active flag.
#: Faults are assumed to be rare.
IDLE, ACTIVE = 1.8, 0.2
#: Fewest bits of a frame whose bits are all equal because the line is dead. In shorter frames, this may be chance.
LEAST_EQUAL_BITS = 12
#: Relative frequency of inverted bits over SPI, which has no wire pairs that could be swapped.
INVERTED_WITHOUT_PAIR = 0.125
#: Relative frequency of a shift that begins after the command, since most SPI words are shifted as a whole.
AFTER_COMMAND = 0.5
#: Relative frequency of a different order code without a CRC, where only the length and a few bits can contradict it.
OTHER_CODE_WITHOUT_CRC = 0.25
#: Relative frequency of a mistake together with a second one.
WITH_SECOND_MISTAKE = 0.125


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """One common mistake that may have been made with a frame, and what a frame with that mistake must look like.

    The CRC with the parameters ``crc`` (None if the frame has none) covers the ``covered_bits`` bits ``covered_data``.
    ``received_crc`` are the first ``received_crc_bits`` bits of the received CRC. ``determined_bits`` is the number of
    other bits whose value the mistake determines, and ``do_determined_bits_match`` is true if they have it.

    ``right_constant_bits`` is the number of frame bits that have their constant value. They prove nothing, but make one
    reading more likely than another, just as inactive flags do (``likelihood``).

    ``frame`` is the frame without the mistake, with the layout ``frame_layout``, if the mistake changes the frame.
    ``order_codes`` are those that would send it. ``recording_parts`` are the parts of the recording that contains the
    frame, each as a name and its bits, and ``searched_places`` is the number of places at which it was searched.
    ``template`` is the description without the details of this frame. With ``has_assumed_bit``, the value of a lost bit
    is assumed, and another hypothesis assumes the other value. ``relative_frequency`` is how frequent the mistake is
    here, relative to other mistakes of its kind.
    """

    kind: str
    description: str
    crc: Crc | None
    covered_data: int
    covered_bits: int
    received_crc: int
    received_crc_bits: int
    is_crc_over_bytes: bool = False
    determined_bits: int = 0
    do_determined_bits_match: bool = True
    right_constant_bits: int = 0
    likelihood: float = 1.0
    frame: int = 0
    frame_layout: PlacedLayout | None = None
    order_codes: tuple[str, ...] = ()
    recording_parts: tuple[tuple[str, str], ...] = ()
    searched_places: int = 1
    template: str = ""
    has_assumed_bit: bool = False
    relative_frequency: float = 1.0

    @property
    def frequency(self) -> float:
        """Estimated frequency of the mistake, relative to other mistakes."""
        return MISTAKES[self.kind] * self.relative_frequency

    @property
    def fits(self) -> bool:
        """True if the hypothesis matches: the bits that the mistake determines and the CRC are correct.

        Without a CRC, only the determined bits are compared.
        """
        if not self.do_determined_bits_match:
            return False
        if self.crc is None:
            return True
        if self.is_crc_over_bytes:
            computed_crc = compute_bytes(self.crc, self.covered_data.to_bytes(self.covered_bits // 8, "big"))
        else:
            computed_crc = compute_bits(self.crc, self.covered_data, self.covered_bits)
        # Only the received bits of the CRC are compared.
        missing_crc_bits = self.crc.width - self.received_crc_bits
        return computed_crc >> missing_crc_bits == self.received_crc

    @property
    def one_in(self) -> int:
        """Number of random frames of which one matches the hypothesis by chance: 64 for 6 received CRC bits.

        It is smaller if the frame was searched at several places of a recording.
        """
        compared_bits = self.received_crc_bits + self.determined_bits
        number_of_patterns = 1 << compared_bits
        return max(number_of_patterns // self.searched_places, 1)

    @property
    def score(self) -> float:
        """Relative likelihood of a mistake that matches: its frequency, times how improbable the match is by chance."""
        evidence = self.received_crc_bits + max(self.determined_bits, self.right_constant_bits)
        return self.frequency * self.likelihood * 2.0**evidence / self.searched_places

    @property
    def match_key(self) -> tuple[object, ...]:
        """Key of the hypothesis. Hypotheses with the same key match the same frames."""
        # If the start value is 0, leading zeros do not change the CRC, so the number of covered bits does not matter.
        has_start_value = self.crc is not None and self.crc.init != 0
        distinguishing_bits = self.covered_bits if has_start_value else 0
        return self.crc, self.covered_data, distinguishing_bits, self.received_crc, self.received_crc_bits


def check_constant_bits(placed_layout: PlacedLayout, frame: int) -> tuple[int, bool]:
    """Return how many bits of a frame must have a certain value, and whether all of them have it: ``(6, True)``.

    These are the bits of constants, of parity bits, and of the selector, the field that identifies the layout. A
    selector with 4 valid values has 2 free bits, which do not count.
    """
    constant_bits = 0
    are_correct = True
    for placed_field in placed_layout.fields:
        raw_value = (frame >> placed_field.lowest_bit) & placed_field.mask
        expected_value = _expected_constant(placed_layout, placed_field, frame)
        if expected_value is not None:
            constant_bits += placed_field.width
            are_correct = are_correct and raw_value == expected_value
        elif placed_field.name == placed_layout.layout.selector:
            selector_values = placed_layout.layout.selects
            # Choosing one of 3 or 4 values takes 2 bits, and a single value takes 0 bits.
            free_bits = (len(selector_values) - 1).bit_length()
            constant_bits += placed_field.width - free_bits
            are_correct = are_correct and raw_value in selector_values
    return constant_bits, are_correct


def has_only_parity(placed_layout: PlacedLayout) -> bool:
    """Return whether nothing but one parity bit can contradict a frame, which then passes half of all shifts."""
    constant_bits, _ = check_constant_bits(placed_layout, frame=0)
    return placed_layout.crc_field is None and placed_layout.has_parity and constant_bits == 1


def _expected_constant(placed_layout: PlacedLayout, placed_field: PlacedField, frame: int) -> int | None:
    """Return the value that a constant or a parity bit must have in the frame, or None for other fields."""
    match placed_field.field.kind:
        case Constant(value):
            return value
        case Parity() as parity:
            return parity_bit(placed_layout, parity, frame)
        case _:
            return None


def likelihood(placed_layout: PlacedLayout, frame: int) -> float:
    """Return how likely the flags and reserved bits of a frame are, compared with random bits.

    It is the product of 1.8 for each inactive flag and each reserved bit with its value in the manual, and of 0.2 for
    each active flag and each reserved field with a different value. Without such fields, it is 1.
    """
    likelihood = 1.0
    for placed_field in placed_layout.fields:
        raw_value = (frame >> placed_field.lowest_bit) & placed_field.mask
        match placed_field.field.kind:
            case Flag(active_low=active_low):
                is_active = bool(raw_value) != active_low
                likelihood *= ACTIVE if is_active else IDLE
            case Unused(documented_value):
                is_as_documented = raw_value == documented_value & placed_field.mask
                likelihood *= IDLE**placed_field.width if is_as_documented else ACTIVE
    return likelihood


def frame_hypothesis(
    kind: str,
    description: str,
    placed_layout: PlacedLayout,
    crc: Crc | None,
    frame: int,
    *,
    lost_bits: int = 0,
    determined_bits: int = 0,
    do_determined_bits_match: bool = True,
    order_codes: Sequence[str] = (),
) -> Hypothesis:
    """Return the hypothesis that the encoder sent ``frame``, and that a mistake changed it.

    ``kind`` and ``description`` name the mistake. The last ``lost_bits`` bits of the frame were not received. They
    belong to the CRC, and only its other bits are compared. Without a CRC, their values in ``frame`` are assumed, so
    they prove nothing. ``determined_bits`` is the number of bits around the frame whose value the mistake determines.
    The bits of constants and parity are added to it.
    """
    constant_bits, are_constants_correct = check_constant_bits(placed_layout, frame)
    hypothesis = Hypothesis(
        kind=kind,
        description=description,
        crc=None,
        covered_data=frame,
        covered_bits=placed_layout.bits,
        received_crc=0,
        received_crc_bits=0,
        determined_bits=determined_bits + max(constant_bits - lost_bits, 0),
        do_determined_bits_match=do_determined_bits_match and are_constants_correct,
        likelihood=likelihood(placed_layout, frame),
        frame=frame,
        frame_layout=placed_layout,
        order_codes=tuple(order_codes),
    )
    if crc is None:
        return hypothesis
    all_determined_bits = determined_bits + constant_bits
    return _with_crc(hypothesis, placed_layout, crc=crc, lost_bits=lost_bits, determined_bits=all_determined_bits)


def _with_crc(
    hypothesis: Hypothesis, placed_layout: PlacedLayout, *, crc: Crc, lost_bits: int, determined_bits: int
) -> Hypothesis:
    """Return a hypothesis in which the frame ends with a CRC, of which the last ``lost_bits`` were not received."""
    covered_data, covered_bits = crc_covered_bits(placed_layout, hypothesis.frame)
    return replace(
        hypothesis,
        crc=crc,
        covered_data=covered_data,
        covered_bits=covered_bits,
        received_crc=(hypothesis.frame & crc.mask) >> lost_bits,
        received_crc_bits=crc.width - lost_bits,
        determined_bits=determined_bits,
    )


def crc_covered_bits(placed_layout: PlacedLayout, frame: int) -> tuple[int, int]:
    """Return the bits of a frame that the CRC covers, as a number shifted to bit 0, and how many they are."""
    low, width = placed_layout.covered_lowest_bit_and_width
    mask = (1 << width) - 1
    return (frame >> low) & mask, width


def possible_lengths(placed_layout: PlacedLayout, typed_frame: TypedFrame) -> list[int]:
    """Return the numbers of bits that may have been received, largest first.

    If the user may have omitted leading zeros, these are the length of the expected frame, and one bit less, since its
    first bit may be missing.
    """
    has_known_length = typed_frame.is_length_known or typed_frame.bits > placed_layout.bits
    if has_known_length:
        return [typed_frame.bits]
    lengths = (placed_layout.bits, placed_layout.bits - 1)
    return [length for length in lengths if length >= typed_frame.bits]


#: Texts by name. Numbers in braces are replaced by the details of a frame.
TEXTS: Mapping[str, str] = MappingProxyType(
    {
        "all_inverted": "every bit is inverted, as with swapped data wires",
        "bits_reversed": "the bits are in reverse order",
        "bits_reversed_in_bytes": "the bits of each byte are in reverse order",
        "bytes_reversed": "the bytes are in reverse order",
        "words_swapped": "the two bytes of each 16-bit word are swapped",
        "crc_reversed": "the bits of the CRC are in reverse order",
        "crc_bytes_swapped": "the bytes of the CRC are swapped",
        "and_swapped": "{0}, and its bytes are swapped",
        "and_crc_bytes_swapped": "{0}, and the bytes of the CRC are swapped",
        "status_left_out": "the CRC covers only the bits before error and warning",
        "status_turned": "error and warning were converted to active high",
        "removed_and_idle": "error and warning were removed from the frame, and the CRC is computed as if they were "
        "inactive",
        "removed": "error and warning were removed from the frame, and the CRC covers the rest",
        "covers_binary": "the CRC covers the position in binary, but here it is in Gray code",
        "covers_gray": "the CRC covers the position in Gray code, but here it is already binary",
        "polynomial": "the polynomial is {0}, a {1}-bit CRC",
        "bits_arrived": "{0}, of which only {1} bits arrived",
        "then_zeros": "{0}, followed by zeros",
        "inverted_too": "{0}, and the CRC is inverted",
        "not_inverted_too": "{0}, and the CRC is not inverted",
        "command_left_out": "the first {0} bits, which are sent during the command, are missing",
        "command_idle": "the first {0} bits, which are sent during the command, are all {1}, as if only MISO were "
        "recorded",
        "after_command": "in the bits after the command: {0}",
        "bits": "{0} bits",
        "bits_or_more": "{0} bits or more",
        "of_code": "the frame of {0}",
        "of_two_codes": "the frame of {0} or {1}",
        "of_more_codes": "the frame of {0} and {1} more",
        "of_other_code": "the frame of another order code",
        "of_registers": "the frame that {0} sends when its registers select other widths",
        "read_too_long": ", read {0} too long",
        "read_too_short": ", read {0} too short",
        "extra_byte": "an extra byte",
        "extra_bytes": "{0} extra bytes",
        "before": "{0} before the frame, such as an echo of the request",
        "after": "{0} after the frame",
        "byte_missing": "the first byte ({0}) is missing",
        "last_byte_missing": "the last byte, a part of the CRC, is missing",
        "and_follows": "{0}, and an extra byte follows the frame",
        "bytes_inverted": "every bit is inverted",
        "other_message": "the CRC at the end is correct, so this is a whole message of another length, such as a "
        "request, an error message or a different reply",
        "bytes_missing": "the text has {0} of the {1} bytes of the frame. Missing: {2}",
        "read_as_zeros": "{0}, treated as leading zeros",
        "zeros_left_out": "{0}. If it lacks its leading zeros instead, write {1}",
        "first_byte_left_out": "the CRC does not cover the first byte",
        "line_stuck": "every bit is {0}: the line never changes. Check for {1}, the supply and {2}",
        "line_may_be_stuck": "every bit is {0}. A dead line looks the same, {1}",
        "crc_is_correct": "and the CRC is correct too",
        "has_no_crc": "and there is no CRC to distinguish it",
        "zero_reply": "every bit after the command is 0: the encoder does not drive the line. Check for a short "
        "circuit, the supply and the chip select",
    }
)
#: Bits that BiSS sends before the frame, which a CRC may also cover, with the text.
START_BITS: tuple[tuple[str, str], ...] = (
    ("1", "the CRC also covers the start bit, or a CDS bit of 1"),
    ("10", "the CRC also covers the start bit and a CDS bit of 0"),
    ("11", "the CRC also covers the start bit and a CDS bit of 1"),
)
