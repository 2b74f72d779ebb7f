"""``codewheel find``: propose the layout of an unknown encoder from several of its frames."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from ..say import count_with_unit
from .cli import Parser
from .find_encoder import command_for_spec
from .terminal import CommandError, print_json

if TYPE_CHECKING:
    import argparse

    from ..layout_search.answers import PossibleLine
    from ..layout_search.frames import RecordedFrames

EXAMPLES = (
    "codewheel find biss --bits 30 0x02EFCADC 0x02FF6BCE 0x031254F2",
    "codewheel find ssi --positions 0,45,90 0b00000 0b00110 0b01100",
)
JSON_VERSION = 1
_ABOUT = (
    "All frames have the same length and begin with the first data bit. 0b... shows every bit. 0x... has four bits per "
    "digit, unless --bits gives the number of bits. For RS-485, a frame is a sequence of bytes in hexadecimal. Turn "
    "the shaft between the frames, because bits that never change cannot be identified. The exit code is 0 if there is "
    "a proposal, and 1 if all frames are equal or the line is dead."
)
#: Number of bits in the longest frame, by interface, and for all other interfaces.
_LONGEST_FRAME = {"rs485": 1024}
_LONGEST_IN_BITS = 64
#: Number of bits in the shortest frame, by interface. For all other interfaces, it is one bit.
_SHORTEST_FRAME = {"rs485": 8, "spi": 8}
#: Highest absolute position that ``--positions`` accepts. It is above the counts of 64 bits.
_HIGHEST_POSITION = 1e20
#: Number of characters of an invalid text that a message shows.
_SHOWN_CHARACTERS = 40


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Propose widths, code and CRC of an unknown encoder, each as a line for decode."
    parser.epilog = _ABOUT
    parser.add_argument("interface", choices=("biss", "ssi", "spi", "rs485"), help="interface of the encoder")
    parser.add_argument(
        "frame", nargs="+", metavar="FRAME", help="the frames, each as one argument, or - to read one frame per line"
    )
    parser.add_argument(
        "--positions",
        metavar="NUMBER,...",
        help="shaft position for each frame, in any unit and from any zero point, separated by commas",
    )
    parser.add_argument(
        "--bits", type=int, metavar="NUMBER", help="number of bits in a frame, if 0x... does not show this"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> int:
    """Print the proposals, the most likely first.

    Raises:
        CommandError: A frame or a position is malformed (exit code 2), or all frames are equal or come from a dead line
            (exit code 1).
    """
    from ..layout_search.answers import answer_with_lines
    from ..layout_search.frames import NoLayout
    from ..layout_search.search import find_layouts, lacks_frames

    recording = _read_recording(arguments)
    try:
        layouts = find_layouts(recording)
    except NoLayout as error:
        raise CommandError(str(error), 1) from None
    proposals = [answer_with_lines(recording, layout) for layout in layouts]
    if arguments.json:
        print_json(_json_data(recording, proposals))
    else:
        first_frame = _frame_texts(arguments.frame)[0]
        has_too_few_frames = lacks_frames(recording, layouts[0])
        print(*_text_lines(recording, proposals, first_frame, has_too_few_frames=has_too_few_frames), sep="\n")
    return 0


def _read_recording(arguments: argparse.Namespace) -> RecordedFrames:
    """Return the frames of the arguments.

    Raises:
        CommandError: They are not frames of the same length. The exit code is 2.
    """
    from ..layout_search.frames import FEWEST_FRAMES, RecordedFrames

    frame_texts = _frame_texts(arguments.frame)
    if len(frame_texts) < FEWEST_FRAMES:
        raise CommandError("one frame does not show a layout; give at least 2, and turn the shaft between them", 2)
    frames = [_read_frame(arguments.interface, frame_text, arguments.bits) for frame_text in frame_texts]
    lengths = sorted({frame.bits for frame in frames})
    if len(lengths) > 1:
        reason = f"the frames have {lengths[0]} to {lengths[-1]} bits; give frames of the same length"
        raise CommandError(f"{reason}, with all leading zeros, or --bits", 2)
    common_length = lengths[0]
    if arguments.interface == "rs485" and common_length % 8:
        raise CommandError(f"the frames have {common_length} bits; over RS-485, they are whole bytes", 2)
    longest = _LONGEST_FRAME.get(arguments.interface, _LONGEST_IN_BITS)
    shortest = _SHORTEST_FRAME.get(arguments.interface, 1)
    if common_length > longest:
        raise CommandError(f"the frames have {common_length} bits; a line has at most {longest}", 2)
    if common_length < shortest:
        length = count_with_unit(common_length, "bit")
        raise CommandError(f"the frames have {length}; a line has at least {shortest}", 2)
    positions: tuple[float, ...] = ()
    if arguments.positions is not None:
        positions = _read_positions(arguments.positions, len(frame_texts))
    return RecordedFrames(
        interface=arguments.interface,
        bits=common_length,
        frames=tuple(frame.number for frame in frames),
        positions=positions,
    )


def _frame_texts(frame_arguments: Sequence[str]) -> list[str]:
    """Return the text of each frame.

    Each argument is a frame, or has a frame on each of its lines. If ``-`` is the only argument, the frames are the
    lines of standard input.
    """
    from .decode.several_frames import argument_lines

    if list(frame_arguments) == ["-"]:
        return [line.text for line in argument_lines(frame_arguments)]
    frame_texts: list[str] = []
    for frame_argument in frame_arguments:
        frame_texts += [line.text for line in argument_lines([frame_argument])]
    return frame_texts


class _Frame(NamedTuple):
    """A frame as a number whose highest bit is the first one sent, and its length."""

    number: int
    bits: int


def _read_frame(interface: str, text: str, bits: int | None) -> _Frame:
    """Return the frame in a text: ``0b`` with every bit, ``0x`` with hex digits, or hex bytes (the only RS-485 form).

    ``bits`` is the length that the user gave, or None. It determines the number of leading zeros, except for ``0b``.

    Raises:
        CommandError: The text is not a frame. The exit code is 2.
    """
    import re

    from .decode.digits import with_prefix
    from .decode.frames import FrameTextError, frame_bytes, undecorated

    try:
        plain_text = undecorated(text)
        if interface != "rs485":
            # A bit frame may be one number with a prefix. An RS-485 frame always consists of bytes.
            plain_text = with_prefix(plain_text, bits or 0)
            compact_text = re.sub(r"[\s_]", "", plain_text)
            number_of_digits = len(compact_text) - len("0b")  # The prefix 0x has the same length.
            if re.fullmatch(r"0[bB][01]+", compact_text):
                return _Frame(number=int(compact_text, 2), bits=number_of_digits)
            if re.fullmatch(r"0[xX][0-9A-Fa-f]+", compact_text):
                frame = _Frame(number=int(compact_text, 16), bits=4 * number_of_digits)
                return _with_stated_length(frame, bits, text)
            # Without a prefix, a single piece could be decimal, hexadecimal or binary.
            if len(plain_text.split()) == 1:
                start_of_text = plain_text[:_SHOWN_CHARACTERS]
                remedy = "write 0b... with every bit, 0x..., or hex bytes"
                raise CommandError(f"'{start_of_text}' is not a frame; {remedy}", 2)
        frame_in_bytes = frame_bytes(plain_text)
    except FrameTextError as error:
        raise CommandError(str(error), 2) from None
    frame = _Frame(number=int.from_bytes(frame_in_bytes, "big"), bits=8 * len(frame_in_bytes))
    return _with_stated_length(frame, bits, text)


def _with_stated_length(frame: _Frame, bit_count: int | None, text: str) -> _Frame:
    """Return a frame with the length that the user gave, or with its own length if ``bit_count`` is None.

    Raises:
        CommandError: The frame has 1 bits above this length. The exit code is 2.
    """
    if bit_count is None:
        return frame
    if frame.number.bit_length() > bit_count:
        raise CommandError(f"'{text[:_SHOWN_CHARACTERS]}' has more than {bit_count} bits", 2)
    return _Frame(frame.number, bit_count)


def _read_positions(text: str, frame_count: int) -> tuple[float, ...]:
    """Return the positions in a text such as ``0,45,90``. There must be ``frame_count`` of them, one for each frame.

    Raises:
        CommandError: The text is not a list of numbers, or their number is wrong. The exit code is 2.
    """
    from math import isfinite

    try:
        positions = tuple(float(number_text) for number_text in text.split(","))
    except ValueError:
        start_of_text = text[:_SHOWN_CHARACTERS]
        problem = f"'{start_of_text}' is not a list of numbers"
        raise CommandError(f"{problem}; write it like --positions 0,45,90", 2) from None
    if len(positions) != frame_count:
        both_counts = f"{count_with_unit(len(positions), 'position')} for {count_with_unit(frame_count, 'frame')}"
        raise CommandError(f"{both_counts}; give one for each frame", 2)
    if not all(map(isfinite, positions)):
        raise CommandError("a position is not a finite number; write it like --positions 0,45,90", 2)
    if max(map(abs, positions)) > _HIGHEST_POSITION:
        raise CommandError(f"a position is beyond ±{_HIGHEST_POSITION:.0e}; give the positions in a larger unit", 2)
    return positions


def _json_data(recording: RecordedFrames, proposals: Sequence[PossibleLine]) -> dict[str, Any]:
    """Return the proposals as plain data for ``--json``."""
    return {
        "version": JSON_VERSION,
        "frames": len(recording.frames),
        "bits": recording.bits,
        "layouts": [_proposal_data(proposal) for proposal in proposals],
    }


def _proposal_data(proposal: PossibleLine) -> dict[str, Any]:
    return {
        "line": proposal.line,
        "equal": [{"line": equal_line.line, "reason": equal_line.reason} for equal_line in proposal.equal_lines],
        "notes": list(proposal.notes),
    }


def _text_lines(
    recording: RecordedFrames, proposals: Sequence[PossibleLine], first_frame: str, *, has_too_few_frames: bool
) -> Iterator[str]:
    """Yield the proposals as lines of text, and the commands to continue with the first proposal.

    If there are too few frames for a proposal, a request for more frames replaces the commands.
    """
    number_of_frames = count_with_unit(len(recording.frames), "frame")
    length = count_with_unit(recording.bits, "bit")
    yield f"{number_of_frames} of {length}, most likely layout first"
    for rank, proposal in enumerate(proposals, 1):
        yield ""
        yield f"{rank}. {proposal.line}"
        yield from (f"   {note}" for note in proposal.notes)
        for equal_line in proposal.equal_lines:
            yield f"   or {equal_line.line}"
            yield f"      {equal_line.reason}"
    most_likely_line = proposals[0].line
    yield ""
    if has_too_few_frames:
        yield "Too few frames to confirm a layout. Record about twenty while the shaft turns."
        return
    yield "To continue with the first one:"
    yield f"  codewheel decode {shlex.quote(most_likely_line)} {shlex.quote(first_frame)}"
    yield f"  {command_for_spec(most_likely_line)}"
