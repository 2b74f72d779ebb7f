"""Recordings of a line that contain a frame: raw BiSS buffers, and SSI and SPI words with extra bits around them.

The descriptions are data for this package and for the script of the decode page, so that both find the same frames in
the same order.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

from ..model import Biss, Constant, Crc, Interface, PlacedLayout, Spi, Ssi
from ..model.record import dataclass
from .hypotheses import Hypothesis, TypedFrame, frame_hypothesis


@dataclass(frozen=True, slots=True)
class BitPattern:
    """Bits around a frame, as a regular expression for the bits in the order received.

    Each group is a part of the recording, and ``#`` is the number of bits of the frame. The bits in the groups
    ``proof_groups`` can have only one value, so they are evidence. The group ``again`` must repeat the frame, starting
    with its first bit.
    """

    kind: str
    text: str
    regular_expression: str
    proof_groups: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FrameOffset:
    """Bits that do not begin and end with the frame.

    ``bits_before`` and ``bits_after`` are extra bits around the frame: ``1`` is a start bit, ``~`` is mostly 0, like a
    CDS or stop bit, and ``?`` is any bit. ``missing_first_bits`` are the values of first bits that were not
    received, and ``lost_last_bits`` is the number of missing last bits. ``{0}`` in the text is replaced by
    ``missing_first_bits``.
    """

    kind: str
    text: str
    bits_before: str = ""
    missing_first_bits: str = ""
    lost_last_bits: int = 0
    bits_after: str = ""

    @property
    def additional_bits(self) -> int:
        """Number of received bits in addition to those of the frame. It is negative if fewer bits were received."""
        extra_bits = len(self.bits_before) + len(self.bits_after)
        return extra_bits - len(self.missing_first_bits) - self.lost_last_bits


@dataclass(frozen=True, slots=True)
class IncompletePattern:
    """A recording without a complete frame.

    In the text, ``{0}`` is the number of bits of the frame that were received, ``{1}`` the number of bits that it has,
    and ``{2}`` the number of missing bits.
    """

    text: str
    regular_expression: str


@dataclass(frozen=True, slots=True)
class LineMistakes:
    """Mistakes with the bits around a frame on one kind of line, in the order in which they are tried.

    ``offsets`` are by one or two bits.
    """

    offsets: tuple[FrameOffset, ...]
    recording_patterns: tuple[BitPattern, ...]
    incomplete_patterns: tuple[IncompletePattern, ...]


#: Kind of a frame that no rule finds, only its CRC.
FRAME_INSIDE = "frame_inside"
#: Its text. ``{0}`` is the number of bits before the frame.
FRAME_INSIDE_TEXT = "the frame begins after {0} other bits"

_FRAME = "(?P<frame>[01]{#})"
_TAIL = "(?P<time_out>0*)(?P<behind>[01]*)$"

_BISS_OFFSETS = (
    *(
        FrameOffset(
            "first_bit_missing",
            text="started one clock late: the first bit ({0}) is missing, and an extra bit follows",
            missing_first_bits=missing,
            bits_after="~",
        )
        for missing in "01"
    ),
    FrameOffset(
        "bits_in_front",
        text="started one clock early: an extra bit such as CDS is in front, and the last bit is missing",
        bits_before="~",
        lost_last_bits=1,
    ),
    FrameOffset(
        "bits_in_front",
        text="started two clocks early: start bit and CDS are in front, and the last two bits are missing",
        bits_before="1~",
        lost_last_bits=2,
    ),
    FrameOffset("bits_in_front", text="an extra bit in front, such as CDS", bits_before="~"),
    FrameOffset("bits_behind", text="an extra bit at the end, such as the stop bit", bits_after="~"),
    FrameOffset("bits_in_front", text="two extra bits in front: start bit and CDS", bits_before="1~"),
    FrameOffset(
        "bits_in_front",
        text="an extra bit in front, such as CDS, and one at the end, such as the stop bit",
        bits_before="~",
        bits_after="~",
    ),
    FrameOffset("bits_behind", text="two extra bits at the end", bits_after="~?"),
    *(
        FrameOffset("first_bit_missing", text="the first bit ({0}) is missing", missing_first_bits=missing)
        for missing in "01"
    ),
    FrameOffset("last_bits_missing", text="the last bit is missing", lost_last_bits=1),
    FrameOffset("last_bits_missing", text="the last two bits are missing", lost_last_bits=2),
)

_BISS = LineMistakes(
    offsets=_BISS_OFFSETS,
    recording_patterns=(
        # The rule of the C receiver: the start bit is the first 1 after a 0.
        BitPattern(
            "raw_buffer",
            "a raw buffer: acknowledge, start bit and CDS are in front of the frame",
            f"^(?P<idle>1*)(?P<acknowledge>0+)(?P<start>1)(?P<CDS>[01]){_FRAME}(?P<stop>0?){_TAIL}",
            proof_groups=("stop",),
        ),
        BitPattern(
            "bits_around",
            "start bit and CDS are in front of the frame, and stop bit and timeout follow",
            f"^(?P<start>1)(?P<CDS>[01]){_FRAME}(?P<stop>0){_TAIL}",
            proof_groups=("start", "stop"),
        ),
        BitPattern(
            "bits_around",
            "CDS is in front of the frame, and stop bit and timeout follow",
            f"^(?P<CDS>[01]){_FRAME}(?P<stop>0){_TAIL}",
            proof_groups=("stop",),
        ),
        BitPattern(
            "bits_around",
            "stop bit and timeout follow the frame",
            f"^{_FRAME}(?P<stop>0){_TAIL}",
            proof_groups=("stop",),
        ),
    ),
    incomplete_patterns=(
        IncompletePattern("as a raw buffer, it has no acknowledge (a 0 after the idle bits) and no frame", "^1+$"),
        IncompletePattern("as a raw buffer, it has no start bit (a 1 after the acknowledge) and no frame", "^1*0+$"),
        IncompletePattern("as a raw buffer, it ends at the start bit: CDS and the frame are missing", "^1*0+1$"),
        IncompletePattern(
            "as a raw buffer, it ends after {0} of the {1} bits of the frame. Bits still to be read: {2}",
            "^1*0+1[01](?P<frame>[01]*)$",
        ),
    ),
)

_WORD_FIRST = BitPattern(
    "zeros_behind",
    "the word comes first, and the other clocks read 0",
    f"^{_FRAME}(?P<zeros>0+)$",
    proof_groups=("zeros",),
)
_WORD_TWICE = BitPattern(
    "word_twice",
    "the word is repeated after its last bit",
    # Fewer repeated bits prove too little. The position is the same as with any other bits behind the word.
    f"^{_FRAME}(?P<gap>0?)(?P<again>[01]{{4,}})$",
    proof_groups=("gap", "again"),
)
_BIT_IN_FRONT = BitPattern(
    "bits_in_front",
    "the first clock carries no data, and the word follows",
    f"^(?P<front>[01]){_FRAME}(?P<zeros>0*)$",
    proof_groups=("zeros",),
)
_BITS_AROUND = BitPattern(
    "bits_around",
    "the first clock carries no data, and extra bits follow the word",
    # Before the first bit, the line is idle, which is high.
    f"^(?P<front>1){_FRAME}(?P<other>[01]+)$",
    proof_groups=("front",),
)
_WORD_LAST = BitPattern(
    "zeros_in_front", "zeros come first, and then the word", f"^(?P<zeros>0+){_FRAME}$", proof_groups=("zeros",)
)
_OTHERS_BEHIND = BitPattern("bits_behind", "the word comes first, and extra bits follow", f"^{_FRAME}(?P<other>[01]+)$")
_OTHERS_IN_FRONT = BitPattern(
    "bits_in_front", "extra bits come first, and then the word", f"^(?P<other>[01]+){_FRAME}$"
)
_TOO_SHORT = IncompletePattern(
    "it is too short: it has {0} of the {1} bits. Clocks still needed: {2}", "^(?P<frame>[01]*)$"
)


def _one_clock_offsets(cause: str) -> tuple[FrameOffset, ...]:
    """Return the mistakes of reading a frame one clock early or late. The number of received bits is then correct.

    ``cause`` continues the text after "one clock late" or "one clock early". A missing first bit is tried as 0 and 1.
    """
    late_text = f"started one clock late{cause}: the first bit ({{0}}) is missing, and an extra bit follows"
    early_text = f"started one clock early{cause}: an extra bit is in front, and the last bit is missing"
    return (
        FrameOffset("bits_in_front", text=early_text, bits_before="?", lost_last_bits=1),
        *(
            FrameOffset("first_bit_missing", text=late_text, missing_first_bits=missing, bits_after="?")
            for missing in "01"
        ),
    )


#: Lines by name: an interface and, for SSI, the alignment of the word.
LINES: Mapping[str, LineMistakes] = MappingProxyType(
    {
        "biss": _BISS,
        "ssi_msb_left": LineMistakes(
            _one_clock_offsets(""),
            (_WORD_TWICE, _WORD_FIRST, _BIT_IN_FRONT, _OTHERS_BEHIND, _BITS_AROUND),
            (_TOO_SHORT,),
        ),
        "ssi_lsb_right": LineMistakes(
            # An encoder does not know how many clocks follow, so the word may also come first.
            _one_clock_offsets(""),
            (_WORD_FIRST, _WORD_LAST, _WORD_TWICE, _BIT_IN_FRONT, _OTHERS_BEHIND, _OTHERS_IN_FRONT),
            (_TOO_SHORT,),
        ),
        "spi": LineMistakes(
            _one_clock_offsets(", as with the other clock edge"),
            (_WORD_FIRST, _BIT_IN_FRONT, _WORD_LAST, _OTHERS_BEHIND, _OTHERS_IN_FRONT),
            (_TOO_SHORT,),
        ),
    }
)


def line_name(interface: Interface) -> str:
    """Return the name of the line for an interface, such as ``ssi_msb_left``, or an empty string if it carries bytes.

    For SSI, the name contains the alignment of the position in the word.
    """
    match interface:
        case Ssi():
            return f"ssi_{interface.alignment.end}"
        case Biss() | Spi():
            return interface.name
        case _:
            return ""


def recorded_bits(typed_frame: TypedFrame, frame_length: int) -> str:
    """Return the received bits as text, such as ``0110``, including the leading zeros that the user typed.

    If the number fits in the frame and its length is not known, leading zeros are omitted, because the user may have
    added them.
    """
    fits_in_frame = typed_frame.number >> frame_length == 0
    bit_count = typed_frame.bits
    if not typed_frame.is_length_known and not fits_in_frame:
        bit_count = max(typed_frame.digit_bits, typed_frame.bits)
    # The number 0 without leading zeros has 0 bits, but one digit.
    digit_count = max(bit_count, 1)
    return f"{typed_frame.number:0{digit_count}b}"


def recording_hypotheses(
    line: LineMistakes, placed_layout: PlacedLayout, crc: Crc | None, received_bits: str
) -> Iterator[Hypothesis]:
    """Yield a hypothesis for each rule of the line that finds the frame in a recording.

    A rule is a pattern of the bits around the frame. Bits that can have only one value are evidence that the rule
    applies. If the pattern contains the frame twice, the second one must begin like the first.
    """
    for pattern in line.recording_patterns:
        match = _compile_for_length(pattern.regular_expression, placed_layout.bits).match(received_bits)
        if match is None:
            continue
        bits_by_part = {name: bits for name, bits in match.groupdict().items() if bits}
        frame_bits = bits_by_part["frame"]
        # Some encoders repeat the word while the clock continues.
        repeated_bits = bits_by_part.get("again", "")
        proof_bits = sum(len(bits_by_part.get(name, "")) for name in pattern.proof_groups)
        if "zeros" in bits_by_part:
            proof_bits -= _zeros_that_may_be_of_word(
                placed_layout, bits_by_part["zeros"], is_first=match.start("zeros") == 0
            )
        hypothesis = frame_hypothesis(
            kind=pattern.kind,
            description=pattern.text,
            placed_layout=placed_layout,
            crc=crc,
            frame=int(frame_bits, 2),
            determined_bits=proof_bits,
            do_determined_bits_match=frame_bits.startswith(repeated_bits),
        )
        yield replace(hypothesis, recording_parts=tuple(bits_by_part.items()))


def _zeros_that_may_be_of_word(placed_layout: PlacedLayout, zeros: str, *, is_first: bool) -> int:
    """Return how many of the extra zeros on one side of a word could be part of the word itself.

    Every word has this many constant zeros at this end, such as the padding of a number. They do not show that the
    extra zeros lie outside the word. ``is_first`` is true for zeros in front of the word.
    """
    constant_zeros_mask = 0
    for placed_field in placed_layout.fields:
        if isinstance(placed_field.field.kind, Constant):
            # The bits of the constant that are 0.
            constant_zeros_mask |= (placed_field.mask & ~placed_field.field.kind.value) << placed_field.lowest_bit
    # A 1 for each bit of the word that is always 0, the first bit sent first.
    marks = f"{constant_zeros_mask:0{placed_layout.bits}b}"
    marks_without_end = marks.lstrip("1") if is_first else marks.rstrip("1")
    constant_zeros_at_end = len(marks) - len(marks_without_end)
    return min(constant_zeros_at_end, len(zeros))


def window_hypotheses(placed_layout: PlacedLayout, crc: Crc, received_bits: str) -> Iterator[Hypothesis]:
    """Yield a hypothesis for each place in a recording at which the frame can begin.

    The more places there are, the more likely one of them matches by chance, so each hypothesis contains their number.
    """
    frame_length = placed_layout.bits
    place_count = len(received_bits) - frame_length + 1
    for start in range(place_count):
        end = start + frame_length
        bits_by_part = {
            "before": received_bits[:start],
            "frame": received_bits[start:end],
            "behind": received_bits[end:],
        }
        description = FRAME_INSIDE_TEXT.format(start)
        hypothesis = frame_hypothesis(
            kind=FRAME_INSIDE,
            description=description,
            placed_layout=placed_layout,
            crc=crc,
            frame=int(bits_by_part["frame"], 2),
        )
        yield replace(
            hypothesis,
            template=FRAME_INSIDE_TEXT,
            recording_parts=tuple((name, bits) for name, bits in bits_by_part.items() if bits),
            searched_places=place_count,
        )


def missing_part_text(line: LineMistakes, frame_length: int, received_bits: str) -> str:
    """Return a text about the part of the frame that a recording lacks, or an empty string.

    It is empty if no pattern of an incomplete recording matches, or if the recording contains the complete frame.
    """
    for pattern in line.incomplete_patterns:
        match = _compile_for_length(pattern.regular_expression, frame_length).match(received_bits)
        if match is None:
            continue
        received_frame_bits = match.groupdict().get("frame", "")
        received_length = len(received_frame_bits)
        if received_length < frame_length:
            return pattern.text.format(received_length, frame_length, frame_length - received_length)
    return ""


@lru_cache(maxsize=1024)
def _compile_for_length(regular_expression: str, frame_length: int) -> re.Pattern[str]:
    """Compile a regular expression for a recording, in which ``#`` stands for the number of bits of the frame."""
    return re.compile(regular_expression.replace("#", f"{frame_length}"))
