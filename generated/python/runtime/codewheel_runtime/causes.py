# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds the mistake that explains an invalid frame, by trying common mistakes one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from operator import index
from typing import Final, SupportsIndex, cast

from .encoder import Encoder
from .errors import FrameError
from .reports import Interface


def why(encoder: Encoder, frame: object) -> tuple[str, ...]:
    """Return the changes that make an invalid frame valid, the most likely first.

    If the line is dead, this is the only answer. A short CRC is sometimes correct by chance. A CRC of 6 bits is correct
    in 1 of 64 cases, and in most cases there is a bit whose inversion makes it correct. Check several frames, and look
    for the mistake that explains all of them.
    """
    apart = _is_told_apart(encoder)
    if dead := _dead_line(encoder, frame, apart):
        return (dead,)
    if not apart:
        return ()
    return tuple(said for said, other in _others(encoder, frame) if _is_sound(encoder.decode, other))


def hint(encoder: Encoder, frame: object) -> str:
    """Return the result of ``why`` as one sentence."""
    found = why(encoder, frame)
    if found and _dead_line(encoder, frame, _is_told_apart(encoder)):
        return found[0][0].upper() + found[0][1:]
    return f"The frame would be valid {'; or '.join(found)}" if found else ""


#: In shorter frames, all bits can be equal by chance.
_LEAST_BITS: Final = 12


def _dead_line(encoder: Encoder, frame: object, has_crc: bool) -> str:
    """Return the description of a dead line, or an empty string if the line changes."""
    bits = _bits_of(encoder)
    if isinstance(frame, (bytes, bytearray, memoryview)):
        data = bytes(cast(bytes, frame))
        number, bits = int.from_bytes(data, "big"), 8 * len(data)
    elif isinstance(frame, str):
        text = frame.strip().removeprefix("0b").replace("_", "").replace(" ", "")
        if set(text) - {"0", "1"}:
            return ""
        number, bits = int(text or "0", 2), len(text)
    elif isinstance(frame, SupportsIndex) and not isinstance(frame, bool):
        number = index(frame)
        bits = max(bits, number.bit_length())
    else:
        return ""
    if not bits:
        return "nothing was received. Check the supply, for loose or swapped wires, and the clock or request"
    if bits < _LEAST_BITS or number not in (0, (1 << bits) - 1):
        return ""
    level = 1 if number else 0
    if not has_crc:
        return f"every bit is {level}. A dead line looks the same, and there is no CRC to distinguish it"
    cause = "a broken wire" if level else "a short circuit"
    others = "wires A and B" if encoder.interface is Interface.RS485 else "the clock"
    return f"every bit is {level}: the line never changes. Check for {cause}, the supply and {others}"


def _is_told_apart(encoder: Encoder) -> bool:
    """Return whether some frames of the right length are invalid. If all are valid, a valid frame proves nothing."""
    bits = _bits_of(encoder)
    return not bits or not all(_is_sound(encoder.decode, word) for word in (0, 1, (1 << bits) - 1))


def _is_sound(decode: Callable[[object], object], frame: object) -> bool:
    try:
        decode(frame)
    except (FrameError, TypeError):
        return False
    return True


def _others(encoder: Encoder, frame: object) -> Iterator[tuple[str, object]]:
    if isinstance(frame, (bytes, bytearray, memoryview)):
        data = bytes(cast(bytes, frame))
        number = int.from_bytes(data, "big")
        flipped = ((number ^ 1 << bit).to_bytes(len(data), "big") for bit in range(8 * len(data)))
        yield from _disturbed(encoder, flipped, lambda bit: f"bit {bit % 8} of byte {len(data) - 1 - bit // 8}")
        yield "with all bits inverted: check for swapped wires of the data line", bytes(byte ^ 0xFF for byte in data)
        yield "with its bytes in reverse order", data[::-1]
        turned = bytes(int(f"{byte:08b}"[::-1], 2) for byte in data)
        yield "with the bits of each byte in reverse order: the least significant bit is sent first", turned
        for place in range(1, min(len(data), 4)):
            yield f"without its first {_count(place, 'byte')}: check for an echo or a leftover byte", data[place:]
            yield f"without its last {_count(place, 'byte')}: they may belong to the next frame", data[:-place]
        return
    bits = _bits_of(encoder)
    if not isinstance(frame, int) or isinstance(frame, bool) or frame < 0 or not bits:
        return
    last = (1 << bits) - 1
    if frame <= last:
        yield from _disturbed(encoder, (frame ^ 1 << bit for bit in range(bits)), lambda bit: f"bit {bit}")
    yield "with all bits inverted: check for swapped wires of the data line", frame & last ^ last
    if frame <= last:
        yield "with its bits in reverse order: the most significant bit is sent first", _turned(frame, bits)
        for crc_bits in (6, 4, 16):
            yield f"with the {crc_bits} bits of its CRC inverted, as BiSS sends them", frame ^ (1 << crc_bits) - 1
    else:
        yield f"with only its last {bits} bits: leave out bits before the data", frame & last
    for place in (1, 2, 3):
        yield f"without its last {_count(place, 'bit')}: send fewer clocks, or shift right", frame >> place
        for filled in range(1 << place):
            more = f"with {_count(place, 'more bit')} at its end, {filled:0{place}b}: send more clocks"
            yield more, (frame << place | filled) & last


def _disturbed(
    encoder: Encoder, flipped: Iterable[object], named: Callable[[int], str]
) -> Iterator[tuple[str, object]]:
    """Yield a frame that becomes valid when one bit is inverted. The bit is named if only one is possible."""
    found = [(bit, other) for bit, other in enumerate(flipped) if _is_sound(encoder.decode, other)]
    if found:
        which = named(found[0][0]) if len(found) == 1 else f"one of {len(found)} bits"
        yield f"with {which} inverted: a disturbed bit if only some frames fail", found[0][1]


def _bits_of(encoder: Encoder) -> int:
    """Return the number of bits in a frame, or 0 if it is made of bytes or the order code does not determine it."""
    try:
        return cast(int, getattr(encoder, "frame_bits", 0))
    except ValueError:
        return 0


def _count(count: int, of: str) -> str:
    return f"{count} {of}" if count == 1 else f"{count} {of}s"


def _turned(number: int, bits: int) -> int:
    return int(f"{number:0{bits}b}"[::-1], 2)
