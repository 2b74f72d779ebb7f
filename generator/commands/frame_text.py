"""Read the text that a person types or pastes for frames, as bytes or as numbers. Ambiguous text is rejected."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..language.problems import quoted, visible
from ..model import INTERFACES, PlacedLayout, Variant
from ..say import frame_text as say
from ..why.bit_text import BitText

_HEX = re.compile(r"(?:0x)?[0-9A-Fa-f]+", re.IGNORECASE)
_GAPS = re.compile(r"[\s_]")
_BITS = re.compile(r"0[bB][01]+")
_NUMBER = re.compile(r"0[xX][0-9A-Fa-f]+")
_ONE_BYTE = re.compile(r"(?:0x)?[0-9A-Fa-f]{2}", re.IGNORECASE)
#: A number that no program has decorated.
_BARE = re.compile(r"0[xXbB][0-9A-Fa-f]+")
#: Spellings of programs and logs, and their replacement. The page has the same list.
_PASTED = (
    (re.compile(r"\bb(?=['\"])"), ""),
    (re.compile(r"\\x([0-9A-Fa-f]{2})"), r" 0x\1 "),
    (re.compile(r"[\[\](){}<>\"',;:]"), " "),
    (re.compile(r"(?<![0-9A-Za-z])([0-9A-Fa-f]{2})-(?=[0-9A-Fa-f]{2}(?![0-9A-Za-z]))"), r"\1 "),
    (re.compile(r"(?<![0-9A-Za-z])(?:0[xX])?([0-9A-Fa-f]+)[hH](?![0-9A-Za-z])"), r"0x\1"),
    (re.compile(r"(?<![0-9A-Za-z])(0[xXbB][0-9A-Fa-f_]+)[uUlL]+(?![0-9A-Za-z])"), r"\1"),
)
#: A time in front of a frame: with a decimal point, a unit, or hours, minutes and seconds.
_TIME = re.compile(
    r"\[?((?:[0-9]{4}-[0-9]{2}-[0-9]{2}[T ])?[0-9]{1,2}:[0-9]{2}:[0-9]{2}(?:[.,][0-9]+)?Z?"
    r"|[0-9]+[.][0-9]+(?: ?(?:s|ms|us|µs))?|[0-9]+ ?(?:s|ms|us|µs))\]?[ \t,;]+(?=[^ \t])"
)


class FrameTextError(ValueError):
    """The text is not a frame. The message shows the accepted forms."""


class Line(NamedTuple):
    """A frame as text, with its line number (None if it is the only one) and its leading timestamp."""

    number: int | None
    time: str
    text: str


def frame_lines(lines: Iterable[str]) -> Iterator[Line]:
    """Yield the frames in lines. Comments after ``#`` and empty lines are skipped."""
    for number, line in enumerate(lines, 1):
        text = line.partition("#")[0].strip()
        if text:
            time = _TIME.match(text)
            yield Line(number, time[1] if time else "", text[time.end() :] if time else text)


def checked(text: str) -> str:
    """Return the text of a frame without brackets, quotes and other marks of the program that it was copied from.

    Raises:
        FrameTextError: The text is empty or longer than any frame.
    """
    if len(text) > say.LONGEST:
        raise FrameTextError(say.TOO_LONG)
    if _BARE.fullmatch(text):
        return text
    for pattern, replacement in _PASTED:
        text = pattern.sub(replacement, text)
    text = text.strip()
    if not text:
        raise FrameTextError(say.EMPTY)
    return text


def frame_bytes(text: str) -> bytes:
    """Return the bytes of hex text, in pieces of whole bytes.

    Raises:
        FrameTextError: A piece is not hex, or has an odd number of digits.
    """
    data = b""
    for piece in text.split():
        piece_text = quoted(visible(piece))
        if not _HEX.fullmatch(piece):
            raise FrameTextError(say.not_hex(piece_text))
        prefixed = piece[:2] in ("0x", "0X")
        digits = piece[2:] if prefixed else piece
        if len(digits) == 1 and prefixed:
            digits = f"0{digits}"
        elif len(digits) == 1:
            raise FrameTextError(say.one_digit(piece_text, digits))
        elif len(digits) % 2:
            raise FrameTextError(say.odd(piece_text))
        data += bytes.fromhex(digits)
    return data


def placed_bytes(placed: PlacedLayout, variant: Variant, text: str) -> bytes:
    """Return the bytes of a frame in bytes: hex text or, if the line carries bits, also ``0b`` with every bit sent.

    Raises:
        FrameTextError: The text has another form, or another number of bits.
    """
    compact = text.replace("_", "")
    if INTERFACES[variant.interface].carried_as == "bytes" or not _BITS.fullmatch(compact):
        return frame_bytes(text)
    bits = placed.layout.sent_bits.value(placed.parameters)
    if len(compact) - 2 != bits:
        remedy = say.write_bits(str(bits), str(placed.bits // 8))
        raise FrameTextError(say.no_bits(quoted(visible(text)), str(bits), remedy))
    return int(compact, 2).to_bytes(placed.bits // 8, "big")


def frame_number(placed: PlacedLayout, text: str, *, exact: bool = False) -> BitText:
    """Return one number given as ``0b`` with all leading zeros, or as ``0x`` or hex bytes, which imply them.

    With ``exact``, bytes imply no zeros, because frames of the sender have different lengths.

    Raises:
        FrameTextError: The text has another form.
    """
    compact = _GAPS.sub("", text)
    if _BITS.fullmatch(compact):
        return BitText(int(compact, 2), len(compact) - 2, exact=True)
    pieces = text.split()
    if len(pieces) > 1 and all(map(_ONE_BYTE.fullmatch, pieces)):
        bare = [piece for piece in pieces if len(piece) == 2]
        if len(bare) == len(pieces) and not set("".join(pieces)) - set("01"):
            raise FrameTextError(say.bits_or_bytes(quoted(text)))
        compact = "0x" + "".join(piece[-2:] for piece in pieces)
        if exact and len(pieces) != (placed.bits + 7) // 8:
            return BitText(int(compact, 16), 8 * len(pieces), exact=True)
    if _NUMBER.fullmatch(compact):
        number = int(compact, 16)
        return BitText(number, number.bit_length(), exact=False)
    readings = list(_readings(compact, placed.bits)) if len(pieces) == 1 else []
    remedy = say.write_one_of(", ".join(readings)) if readings else say.write_number(str(placed.bits))
    raise FrameTextError(say.no_bits(quoted(visible(text)), str(placed.bits), remedy))


def _readings(digits: str, bits: int) -> Iterator[str]:
    """Yield the possible meanings of digits without a prefix that fit into the bits. The page has the same rule."""
    if re.fullmatch(r"0|[1-9][0-9]{0,39}", digits) and not int(digits) >> bits:
        yield say.if_decimal(f"0x{int(digits):X}")
    if re.fullmatch(r"[0-9A-Fa-f]{1,40}", digits) and not int(digits, 16) >> bits:
        yield say.if_hex(digits)
    if re.fullmatch(r"[01]{1,40}", digits):
        yield say.if_bits(digits)
