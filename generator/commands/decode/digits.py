"""Digits without a prefix, as programs and logs print them: find the only meaning that they can have.

The page follows the same rules, in text.js.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...say import report as say
from ...say.notations import DIGITS

_HEX_DIGITS = re.compile(r"[0-9A-Fa-f]+")
_DECIMAL_DIGITS = re.compile(DIGITS["decimal"])
_ZEROS_AND_ONES = re.compile(r"[01]+")
_BINARY_NUMBER = re.compile(r"0[bB][01]+")
#: What separates words in the arrays of programs and logs.
_SEPARATORS = re.compile(r"[\s'\",;\[\](){}<>]+")
#: Bits with a prefix, which may be misspelt as b, although all of it are hex digits.
_PREFIXED_BITS = re.compile(r"0?[bB][01]+")


def with_prefix(text: str, bits: int) -> str:
    """Return the text of a number of ``bits`` bits with the prefix ``0b`` or ``0x`` if its base is certain.

    The base is certain for digits with a letter or a leading zero, all bits of the frame, bits in groups, and bytes or
    words in hex or binary, also without their leading zeros. Other text is returned as it is.
    """
    pieces = text.replace("_", "").split()
    are_digits = all(_HEX_DIGITS.fullmatch(piece) for piece in pieces)
    if not are_digits or _PREFIXED_BITS.fullmatch("".join(pieces)):
        return text
    if _ZEROS_AND_ONES.fullmatch("".join(pieces)):
        digits = _binary_digits(pieces, bits)
        return f"0b{digits}" if digits else text
    if len(pieces) == 1:
        # Digits with a letter or a leading zero are not decimal.
        return text if _DECIMAL_DIGITS.fullmatch(pieces[0]) else f"0x{pieces[0]}"
    byte_pieces = with_leading_zeros(pieces)
    are_whole_bytes = all(len(piece) % 2 == 0 for piece in byte_pieces)
    return " ".join(f"0x{piece}" for piece in byte_pieces) if are_whole_bytes else text


def _binary_digits(pieces: Sequence[str], bits: int) -> str:
    """Return the bits of a number in pieces of zeros and ones, or "" if these may also be hex or decimal.

    The digits are bits if there are as many as the frame has, or if they are in groups of one or of more than two.
    Groups of different lengths are bytes without their leading zeros, unless such a zero is written.
    """
    digits = "".join(pieces)
    byte_count = (bits + 7) // 8
    if len(digits) == bits:
        return digits
    longest = max(map(len, pieces))
    # Bytes without leading zeros can have one digit, too, but not more bytes than the frame has.
    are_single_bits = longest == 1 and len(pieces) > byte_count
    if are_single_bits:
        return digits
    if len(pieces) == 1 or longest <= 2:
        return ""
    have_different_lengths = len({len(piece) for piece in pieces}) > 1
    lack_zeros = have_different_lengths and longest <= 8 and not _has_leading_zero(pieces)
    return "".join(piece.zfill(8) for piece in pieces) if lack_zeros else digits


def with_leading_zeros(pieces: Sequence[str]) -> Sequence[str]:
    """Return bytes in hex or binary, of a program that omits leading zeros, as two hex digits each: ``FF 1``.

    The pieces are returned as they are if a leading zero shows that none is omitted, or if they may be whole bytes in
    hex already.
    """
    longest = max(map(len, pieces), default=0)
    are_binary = all(_ZEROS_AND_ONES.fullmatch(piece) for piece in pieces)
    if are_binary:
        are_bytes = len(pieces) > 1 and 3 <= longest <= 8
        have_odd_length = any(len(piece) % 2 for piece in pieces)
        have_all_bits = all(len(piece) == 8 for piece in pieces)
        # Hex bytes have an even number of digits. Pieces of eight zeros and ones count as bits.
        cannot_be_hex = have_odd_length or have_all_bits
        if not are_bytes or not cannot_be_hex:
            return pieces
        return [f"{int(piece, 2):02X}" for piece in pieces]
    lack_zeros = longest == 2 and not _has_leading_zero(pieces)
    return [piece.zfill(2) for piece in pieces] if lack_zeros else pieces


def _has_leading_zero(pieces: Sequence[str]) -> bool:
    """Return whether a piece of several digits begins with 0."""
    return any(len(piece) > 1 and piece.startswith("0") for piece in pieces)


def bits_of_bytes(text: str, bits: int, *, line_carries_bytes: bool) -> str:
    """Return the digits of one binary number for a frame of ``bits`` bits in bytes, or "" for any other text.

    Without a prefix, or if the line carries bytes, so that ``0b`` may be hex, it has more digits than in hex, and more
    than one byte. It has all bits or, if the line carries bytes, no leading zeros.
    """
    compact_text = text.replace("_", "")
    has_prefix = _BINARY_NUMBER.fullmatch(compact_text) is not None
    digits = compact_text[len("0b") :] if has_prefix else compact_text
    if has_prefix and not line_carries_bytes:
        return digits
    hex_digits = bits // 4
    are_bits = _ZEROS_AND_ONES.fullmatch(digits) and max(hex_digits, 8) < len(digits) <= bits
    has_all_bits = len(digits) == bits and "1" in digits
    lacks_zeros = line_carries_bytes and digits.startswith("1")
    return digits if are_bits and (has_all_bits or lacks_zeros) else ""


def possible_meanings(digits: str, bits: int) -> Iterator[str]:
    """Yield how to write digits without a prefix, for each meaning that they can have in a frame of ``bits`` bits.

    For ``10``: ``0xA if it is decimal``, ``0x10 if it is hex``, ``0b10 if it is bits``. A decimal or hexadecimal number
    must fit into the frame. Bits may be of any number, since the length is checked later. The page follows the same
    rule.
    """
    largest = (1 << bits) - 1
    if _DECIMAL_DIGITS.fullmatch(digits) and int(digits) <= largest:
        yield say.if_decimal(f"0x{int(digits):X}")
    if re.fullmatch(DIGITS["hexadecimal"], digits) and int(digits, 16) <= largest:
        yield say.if_hex(digits)
    if re.fullmatch(DIGITS["bits"], digits):
        yield say.if_bits(digits)


def meanings_of_long_number(digits: str) -> Iterator[str]:
    """Yield how to write a decimal or hexadecimal number without a prefix that is too large for the frame.

    It may have further bits, as a register of a program or a raw buffer.
    """
    if re.fullmatch(DIGITS["long_number"], digits):
        yield say.if_decimal(f"0x{int(digits):X}")
        yield say.if_hex(digits)


def words_of(text: str, bits: int) -> list[str]:
    """Return the words in a text such as ``{0x7FFE, 0x3FFF}`` that has several words of ``bits`` bits.

    A word has all its hex digits, or is in binary and may lack leading zeros if another word has all its bits. Words
    without ``0x`` get it if a letter shows that they are hex. Return an empty list for any other text.
    """
    words = [word for word in _SEPARATORS.split(text) if word]
    if len(words) < 2:
        return []
    digits = rf"[0-9A-Fa-f]{{{bits // 4}}}"
    if all(re.fullmatch(rf"0[xX]{digits}[uUlL]*", word) for word in words):
        return words
    all_digits = "".join(words)
    if all(re.fullmatch(digits, word) for word in words) and not all_digits.isdecimal():
        return [f"0x{word}" for word in words]
    lengths = [len(word) for word in words]
    # Shorter ones may be bytes.
    are_binary = _ZEROS_AND_ONES.fullmatch(all_digits) and min(lengths) > 8 and max(lengths) == bits
    return [f"0b{word.zfill(bits)}" for word in words] if are_binary else []
