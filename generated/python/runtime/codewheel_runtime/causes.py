# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the mistake that explains an invalid frame, by trying common mistakes one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from operator import index
from typing import Final, SupportsIndex, cast

from .errors import FrameError, Sender
from .reports import Interface


def why(encoder: Sender, frame: object) -> tuple[str, ...]:
    """Return the changes that make an invalid frame valid, the most likely first.

    If the line is dead, this is the only answer. A short CRC is sometimes correct by chance. A CRC of 6 bits is correct
    in 1 of 64 cases, and in most cases there is a bit whose inversion makes it correct. Check several frames, and look
    for the mistake that explains all of them.
    """
    # Without a CRC or another check, every frame is valid, so nothing can be concluded.
    can_be_invalid = _can_be_invalid(encoder)
    if dead_line := _explain_dead_line(encoder, frame, can_be_invalid):
        return (dead_line,)
    if not can_be_invalid:
        return ()
    decode = encoder.decode
    return tuple(change for change, changed in _try_changes(encoder, frame) if _is_valid(decode, changed))


def hint(encoder: Sender, frame: object) -> str:
    """Return the result of ``why`` as one sentence, or an empty string."""
    changes = why(encoder, frame)
    if changes and _explain_dead_line(encoder, frame, _can_be_invalid(encoder)):
        # The description of a dead line is a sentence already. Only its first letter changes.
        return changes[0][0].upper() + changes[0][1:]
    return f"The frame would be valid {'; or '.join(changes)}" if changes else ""


#: In shorter frames, all bits can be equal by chance.
_LEAST_BITS: Final = 12


def _explain_dead_line(encoder: Sender, frame: object, has_crc: bool) -> str:
    """Return the description of a dead line, or an empty string if the line changes.

    On a dead line nothing is received, or at least 12 bits that are all equal.
    """
    received = _convert_to_number(frame, _count_frame_bits(encoder))
    if received is None:
        return ""
    number, bits = received
    if not bits:
        return "nothing was received. Check the supply, for loose or swapped wires, and the clock or request"
    if bits < _LEAST_BITS or number not in (0, (1 << bits) - 1):
        return ""
    level = 1 if number else 0
    if not has_crc:
        return f"every bit is {level}. A dead line looks the same, and there is no CRC to distinguish it"
    likely_cause = "a broken wire" if level else "a short circuit"
    other_wires = "wires A and B" if encoder.interface is Interface.RS485 else "the clock"
    return f"every bit is {level}: the line never changes. Check for {likely_cause}, the supply and {other_wires}"


def _convert_to_number(frame: object, frame_bits: int) -> tuple[int, int] | None:
    """Return a frame as a number, and its length in bits. None if it is not one, such as a text of other digits.

    A number without its length has at least ``frame_bits`` bits.
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
    """Return whether some frames of the right length are invalid. If all are valid, a valid frame proves nothing.

    Three frames are tried: 0, 1, and all bits 1. Frames of bytes, and of unknown length, are assumed to have a check.
    """
    bits = _count_frame_bits(encoder)
    return not bits or not all(_is_valid(encoder.decode, word) for word in (0, 1, (1 << bits) - 1))


def _is_valid(decode: Callable[[object], object], frame: object) -> bool:
    """Return whether a frame decodes without an error."""
    try:
        decode(frame)
    except (FrameError, TypeError):
        return False
    return True


def _try_changes(encoder: Sender, frame: object) -> Iterator[tuple[str, object]]:
    """Yield each common mistake in words, with the frame that it would have changed into this one."""
    if isinstance(frame, (bytes, bytearray, memoryview)):
        yield from _try_changed_bytes(encoder, bytes(cast(bytes, frame)))
        return
    bits = _count_frame_bits(encoder)
    if isinstance(frame, int) and not isinstance(frame, bool) and frame >= 0 and bits:
        yield from _try_changed_words(encoder, frame, bits)


def _try_changed_bytes(encoder: Sender, data: bytes) -> Iterator[tuple[str, object]]:
    """Yield each mistake that could have changed a frame of bytes in words, with the frame without this mistake."""
    number = int.from_bytes(data, "big")
    # Bit 0 of the number is bit 0 of the last byte.
    flipped_frames = ((number ^ (1 << bit)).to_bytes(len(data), "big") for bit in range(8 * len(data)))
    yield from _try_flipped_bits(
        encoder, flipped_frames, lambda bit: f"bit {bit % 8} of byte {len(data) - 1 - bit // 8}"
    )
    yield "with all bits inverted: check for swapped wires of the data line", bytes(byte ^ 0xFF for byte in data)
    yield "with its bytes in reverse order", data[::-1]
    reversed_bytes = bytes(_reverse_bits(byte, 8) for byte in data)
    yield "with the bits of each byte in reverse order: the least significant bit is sent first", reversed_bytes
    for count in range(1, min(len(data), 4)):
        yield f"without its first {_count_units(count, 'byte')}: check for an echo or a leftover byte", data[count:]
        yield f"without its last {_count_units(count, 'byte')}: they may belong to the next frame", data[:-count]


def _try_changed_words(encoder: Sender, frame: int, bits: int) -> Iterator[tuple[str, object]]:
    """Yield each mistake that could have changed a frame of bits in words, with the frame without this mistake."""
    highest = (1 << bits) - 1
    if frame <= highest:
        yield from _try_flipped_bits(encoder, (frame ^ (1 << bit) for bit in range(bits)), lambda bit: f"bit {bit}")
    yield "with all bits inverted: check for swapped wires of the data line", (frame & highest) ^ highest
    if frame <= highest:
        yield "with its bits in reverse order: the most significant bit is sent first", _reverse_bits(frame, bits)
        for crc_bits in (6, 4, 16):
            yield f"with the {crc_bits} bits of its CRC inverted, as BiSS sends them", frame ^ ((1 << crc_bits) - 1)
    else:
        yield f"with only its last {bits} bits: leave out bits before the data", frame & highest
    for count in (1, 2, 3):
        yield f"without its last {_count_units(count, 'bit')}: send fewer clocks, or shift right", frame >> count
        for appended in range(1 << count):
            change = f"with {_count_units(count, 'more bit')} at its end, {appended:0{count}b}: send more clocks"
            yield change, ((frame << count) | appended) & highest


def _try_flipped_bits(
    encoder: Sender, flipped_frames: Iterable[object], name_of_bit: Callable[[int], str]
) -> Iterator[tuple[str, object]]:
    """Yield a frame that is valid with one bit inverted, if there is one. The bit is named if only one is possible.

    ``flipped_frames`` are the frames with bit 0, 1, … inverted, and ``name_of_bit`` returns the name of a bit.
    """
    decode = encoder.decode
    valid_flips = [(bit, flipped) for bit, flipped in enumerate(flipped_frames) if _is_valid(decode, flipped)]
    if valid_flips:
        # All of them are valid, so the first one is as good as any.
        bit, frame = valid_flips[0]
        bit_text = name_of_bit(bit) if len(valid_flips) == 1 else f"one of {len(valid_flips)} bits"
        yield f"with {bit_text} inverted: a disturbed bit if only some frames fail", frame


def _count_frame_bits(encoder: Sender) -> int:
    """Return the number of bits in a frame, or 0 if it is made of bytes or the order code does not determine it."""
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
