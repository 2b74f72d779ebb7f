# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the mistake that explains an invalid frame, by trying common mistakes one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from operator import index
from typing import Any, Final, NamedTuple, SupportsIndex, cast

from .errors import CrcError, FrameError, Sender
from .reports import Interface


class _Change(NamedTuple):
    """Change that could make a frame valid: its description, and the frame after the change."""

    description: str
    frame: object


def why(encoder: Sender, frame: object) -> tuple[str, ...]:
    """Return the changes that make an invalid frame valid, as text, the most likely first.

    Example: ``"with all bits inverted: check for swapped wires of the data line"``. If the line is dead, or if the
    frame has all data channels, a sentence about that is the only result. A short CRC is sometimes correct by chance. A
    CRC of 6 bits is correct in 1 of 64 cases, and in most cases there is a bit whose inversion makes it correct. Check
    several frames, and look for a single mistake that explains all of them.
    """
    if explanation := _explain_whole_frame(encoder, frame):
        return (explanation,)
    # Without a CRC or another check, every frame is valid, so nothing can be concluded.
    if not _can_be_invalid(encoder):
        return ()
    decode = encoder.decode
    changes = _yield_changes(encoder, frame)
    return tuple(change.description for change in changes if _is_valid(decode, change.frame))


def hint(encoder: Sender, frame: object) -> str:
    """Return the common mistakes that would explain an invalid frame as one sentence, or an empty string."""
    if explanation := _explain_whole_frame(encoder, frame):
        return explanation[0].upper() + explanation[1:]
    changes = why(encoder, frame)
    return f"The frame would be valid {'; or '.join(changes)}" if changes else ""


#: In shorter frames, all bits can be equal by chance.
_LEAST_BITS: Final = 12
#: Widths of CRCs that are tried.
_USUAL_CRC_BITS: Final = (6, 4, 16)
#: Maximum number of bits and bytes that are tried at the beginning or the end of a frame.
_MOST_EXTRA_BITS: Final = 3
_MOST_EXTRA_BYTES: Final = 3


def _explain_whole_frame(encoder: Sender, frame: object) -> str:
    """Return a sentence that explains an invalid frame without any change to it, or an empty string.

    The line is dead, or the frame has all data channels.
    """
    has_check = _can_be_invalid(encoder)
    return _explain_dead_line(encoder, frame, has_check) or _explain_all_channels(encoder, frame)


def _explain_dead_line(encoder: Sender, frame: object, has_check: bool) -> str:
    """Return a sentence about a dead line, or an empty string if the line changes.

    On a dead line, nothing is received, or at least 12 equal bits. If the frames have no CRC or other
    check (``has_check`` is False), such bits can also be a valid frame.
    """
    received = _convert_to_number(frame, _count_frame_bits(encoder))
    if received is None:
        return ""
    number, received_bits = received
    if not received_bits:
        return "nothing was received. Check the supply, for loose or swapped wires, and the clock or request"
    all_ones = (1 << received_bits) - 1
    has_equal_bits = number in (0, all_ones)
    if received_bits < _LEAST_BITS or not has_equal_bits:
        return ""
    level = 1 if number else 0
    if not has_check:
        return f"every bit is {level}. A dead line looks the same, and there is no CRC to distinguish it"
    likely_cause = "a broken wire" if level else "a short circuit"
    other_wires = "wires A and B" if encoder.interface is Interface.RS485 else "the clock"
    return f"every bit is {level}: the line never changes. Check for {likely_cause}, the supply and {other_wires}"


def _explain_all_channels(encoder: Sender, frame: object) -> str:
    """Return a sentence about a frame with all data channels, or an empty string. ``decode`` expects a single channel.

    The frame contains the bits of all channels. If leading zeros are missing, it has the correct CRCs of all channels.
    """
    channel_layout: Callable[[], Any] | None = getattr(encoder, "channels", None)
    frame_bits = _count_frame_bits(encoder)
    received = _convert_to_number(frame, frame_bits)
    if channel_layout is None or received is None:
        return ""
    layout = channel_layout()
    _, received_bits = received
    if received_bits <= frame_bits:
        return ""
    has_all_channels = received_bits == layout.bits or _is_valid(layout.decode, frame)
    if not has_all_channels:
        return ""
    return "the frame has several data channels, and this decodes a single one: use channels().decode"


def _convert_to_number(frame: object, frame_bits: int) -> tuple[int, int] | None:
    """Return a frame as a number, and its length in bits. Return None if it is not a number.

    Text with characters other than 0 and 1 is not a number. The length of a frame that is given as a number is at least
    ``frame_bits``.
    """
    if isinstance(frame, (bytes, bytearray, memoryview)):
        data = bytes(cast(bytes, frame))
        return int.from_bytes(data, "big"), 8 * len(data)
    if isinstance(frame, str):
        digits = frame.strip().removeprefix("0b").replace("_", "").replace(" ", "")
        if set(digits) - {"0", "1"}:
            return None
        return int(digits or "0", 2), len(digits)
    if isinstance(frame, SupportsIndex) and not isinstance(frame, bool):
        number = index(frame)
        return number, max(frame_bits, number.bit_length())
    return None


def _can_be_invalid(encoder: Sender) -> bool:
    """Return whether some frames of the right length are invalid. If none of them is, a valid frame proves nothing.

    Three frames are tried: 0, 1, and all bits 1. Frames of bytes and frames of unknown length are assumed to have a
    check.
    """
    frame_bits = _count_frame_bits(encoder)
    # 0 stands for bytes, or for an unknown length.
    if not frame_bits:
        return True
    tried_frames = (0, 1, (1 << frame_bits) - 1)
    return not all(_is_valid(encoder.decode, frame) for frame in tried_frames)


def _has_wrong_crc(decode: Callable[[object], object], frame: object) -> bool:
    """Return whether a frame is invalid because of its CRC. Many frames do not have one."""
    try:
        decode(frame)
    except CrcError:
        return True
    except (FrameError, TypeError):
        return False
    return False


def _is_valid(decode: Callable[[object], object], frame: object) -> bool:
    """Return whether a frame decodes without an error."""
    try:
        decode(frame)
    except (FrameError, TypeError):
        # A TypeError means that an answer is missing, or that the frame has the wrong type.
        return False
    return True


def _yield_changes(encoder: Sender, frame: object) -> Iterator[_Change]:
    """Yield the changes that would undo each common mistake.

    There are none for a frame that is text made of 0 and 1.
    """
    if isinstance(frame, (bytes, bytearray, memoryview)):
        yield from _yield_changes_of_bytes(encoder, bytes(cast(bytes, frame)))
        return
    frame_bits = _count_frame_bits(encoder)
    if isinstance(frame, int) and not isinstance(frame, bool) and frame >= 0 and frame_bits:
        yield from _yield_changes_of_number(encoder, frame, frame_bits)


def _yield_changes_of_bytes(encoder: Sender, data: bytes) -> Iterator[_Change]:
    """Yield the changes to a frame of bytes that would undo each common mistake."""

    def name_bit(bit: int) -> str:
        # Bit 0 is the lowest bit of the last byte.
        bytes_after, bit_in_byte = divmod(bit, 8)
        return f"bit {bit_in_byte} of byte {len(data) - 1 - bytes_after}"

    flipped_bit = _explain_by_flipped_bit(encoder, _flip_each_bit(data), name_bit)
    if flipped_bit is not None:
        yield flipped_bit
    inverted_bytes = bytes(byte ^ 0xFF for byte in data)
    yield _Change("with all bits inverted: check for swapped wires of the data line", inverted_bytes)
    yield _Change("with its bytes in reverse order", data[::-1])
    reversed_bits = bytes(_reverse_bits(byte, 8) for byte in data)
    yield _Change("with the bits of each byte in reverse order: the least significant bit is sent first", reversed_bits)
    most_extra_bytes = min(len(data) - 1, _MOST_EXTRA_BYTES)
    for extra_count in range(1, most_extra_bytes + 1):
        bytes_text = _count_units(extra_count, "byte")
        yield _Change(f"without its first {bytes_text}: check for an echo or a leftover byte", data[extra_count:])
        yield _Change(f"without its last {bytes_text}: they may belong to the next frame", data[:-extra_count])


def _flip_each_bit(data: bytes) -> Iterator[bytes]:
    """Yield the frame with one bit inverted, for each of its bits. Bit 0 is the lowest bit of the last byte."""
    number = int.from_bytes(data, "big")
    for bit in range(8 * len(data)):
        flipped_number = number ^ (1 << bit)
        yield flipped_number.to_bytes(len(data), "big")


def _yield_changes_of_number(encoder: Sender, frame: int, frame_bits: int) -> Iterator[_Change]:
    """Yield the changes to a frame of ``frame_bits`` bits, given as a number, that would undo each common mistake."""
    frame_mask = (1 << frame_bits) - 1
    is_too_long = frame > frame_mask
    if not is_too_long:
        flipped_frames = (frame ^ (1 << bit) for bit in range(frame_bits))
        flipped_bit = _explain_by_flipped_bit(encoder, flipped_frames, name_bit=lambda bit: f"bit {bit}")
        if flipped_bit is not None:
            yield flipped_bit
    inverted_frame = ~frame & frame_mask
    yield _Change("with all bits inverted: check for swapped wires of the data line", inverted_frame)
    if is_too_long:
        yield _Change(f"with only its last {frame_bits} bits: leave out bits before the data", frame & frame_mask)
    else:
        reversed_frame = _reverse_bits(frame, frame_bits)
        yield _Change("with its bits in reverse order: the most significant bit is sent first", reversed_frame)
        for crc_bits in _USUAL_CRC_BITS if _has_wrong_crc(encoder.decode, frame) else ():
            crc_mask = (1 << crc_bits) - 1
            yield _Change(f"with the {crc_bits} bits of its CRC inverted, as BiSS sends them", frame ^ crc_mask)
    yield from _yield_changes_of_length(frame, frame_mask)


def _yield_changes_of_length(frame: int, frame_mask: int) -> Iterator[_Change]:
    """Yield the frame without its last bits, then with more bits at its end. ``frame_mask`` is a frame of ones."""
    for bit_count in range(1, _MOST_EXTRA_BITS + 1):
        bits_text = _count_units(bit_count, "bit")
        yield _Change(f"without its last {bits_text}: send fewer clocks, or shift right", frame >> bit_count)
        more_bits_text = _count_units(bit_count, "more bit")
        for appended_bits in range(1 << bit_count):
            description = f"with {more_bits_text} at its end, {appended_bits:0{bit_count}b}: send more clocks"
            yield _Change(description, ((frame << bit_count) | appended_bits) & frame_mask)


def _explain_by_flipped_bit(
    encoder: Sender, flipped_frames: Iterable[object], name_bit: Callable[[int], str]
) -> _Change | None:
    """Return the change that one inverted bit explains, or None. The bit is named if only one is possible.

    ``flipped_frames`` are the frames with bit 0, 1, … inverted, and ``name_bit`` returns the name of a bit.
    """
    decode = encoder.decode
    valid_flips = [
        (bit_index, flipped_frame)
        for bit_index, flipped_frame in enumerate(flipped_frames)
        if _is_valid(decode, flipped_frame)
    ]
    if not valid_flips:
        return None
    # All of them are valid, so the first one is as good as any.
    bit_index, frame = valid_flips[0]
    bit_text = name_bit(bit_index) if len(valid_flips) == 1 else f"one of {len(valid_flips)} bits"
    return _Change(f"with {bit_text} inverted: a disturbed bit if only some frames fail", frame)


def _count_frame_bits(encoder: Sender) -> int:
    """Return the number of bits in a frame, or 0 if it consists of bytes or the order code does not determine it."""
    try:
        return cast(int, getattr(encoder, "frame_bits", 0))
    except ValueError:
        return 0


def _count_units(count: int, unit: str) -> str:
    """Return a number with its unit, such as ``2 bytes``."""
    return f"{count} {unit}" if count == 1 else f"{count} {unit}s"


def _reverse_bits(number: int, bits: int) -> int:
    """Return the bits of a number in reverse order."""
    return int(f"{number:0{bits}b}"[::-1], 2)
