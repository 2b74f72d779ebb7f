"""Read the text that a person types for a frame, as bytes or as a number. Ambiguous text is rejected."""

from __future__ import annotations

import re

from ..language.problems import quoted, visible
from ..model import PlacedLayout
from ..why.mistakes import BitText

_HEX = re.compile(r"(?:0x)?[0-9A-Fa-f]+", re.IGNORECASE)
_ONE_BYTE = re.compile(r"(?:0x)?[0-9A-Fa-f]{2}", re.IGNORECASE)
#: Far longer than any frame. Longer lines are rejected without further work.
_LONGEST_TEXT = 4096


class FrameTextError(ValueError):
    """The text is not a frame. The message shows the accepted forms."""


def checked(text: str) -> str:
    """Return the text without spaces around it.

    Raises:
        FrameTextError: The text is empty or longer than any frame.
    """
    text = text.strip()
    if not text:
        raise FrameTextError("the frame is empty")
    if len(text) > _LONGEST_TEXT:
        raise FrameTextError("the text is longer than any frame or register")
    return text


def frame_bytes(text: str) -> bytes:
    """Return the bytes of hex text, in pieces of whole bytes.

    Raises:
        FrameTextError: A piece is not hex, or has an odd number of digits.
    """
    data = b""
    for piece in text.replace(",", " ").split():
        shown = quoted(visible(piece))
        if not _HEX.fullmatch(piece):
            raise FrameTextError(f"{shown} is not hex; write the bytes like 02 00 12 34 00 24")
        prefixed = piece[:2] in ("0x", "0X")
        digits = piece[2:] if prefixed else piece
        if len(digits) == 1 and prefixed:
            digits = f"0{digits}"
        elif len(digits) == 1:
            raise FrameTextError(f"{shown} is one hex digit; write 0{digits} if it is a byte")
        elif len(digits) % 2:
            wrong = f"{shown} has an odd number of hex digits: one is missing or one too many"
            raise FrameTextError(wrong)
        data += bytes.fromhex(digits)
    if not data:
        raise FrameTextError("the frame is empty")
    return data


def frame_number(placed: PlacedLayout, text: str) -> BitText:
    """Return one number given as ``0b`` with every digit, or as ``0x`` or hex bytes, which imply leading zeros.

    Raises:
        FrameTextError: The text has another form.
    """
    compact = re.sub(r"[\s_]", "", text)
    if re.fullmatch(r"0[bB][01]+", compact):
        return BitText(int(compact, 2), len(compact) - 2, exact=True)
    pieces = text.replace(",", " ").split()
    if len(pieces) > 1 and all(map(_ONE_BYTE.fullmatch, pieces)):
        bare = [piece for piece in pieces if len(piece) == 2]
        if len(bare) == len(pieces) and not set("".join(pieces)) - set("01"):
            raise FrameTextError(f"{quoted(text)} could be bits or hex bytes; prefix it with 0b or 0x")
        compact = "0x" + "".join(piece[-2:] for piece in pieces)
    if re.fullmatch(r"0[xX][0-9A-Fa-f]+", compact):
        number = int(compact, 16)
        return BitText(number, number.bit_length(), exact=False)
    how = f"write 0b and all {placed.bits} bits in the order sent, or 0x and hex digits"
    if len(pieces) == 1 and re.fullmatch(r"[0-9A-Fa-f]{1,40}", compact):
        how = f"write 0x{compact} if it is hex"
        how += f", 0b{compact} if it is bits" if not set(compact) - set("01") else ""
    raise FrameTextError(f"{quoted(visible(text))} is not a frame of {placed.bits} bits; {how}")
