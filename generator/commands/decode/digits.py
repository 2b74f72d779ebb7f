"""Digits without a prefix, as programs and logs print them: find the only meaning that they can have.

The decode page follows the same rules, in text.js.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...say import frame_texts
from ...say.frame_texts import DIGITS

_HEX_DIGITS = re.compile(r"[0-9A-Fa-f]+")
_DECIMAL_DIGITS = re.compile(DIGITS["decimal"])
_ZEROS_AND_ONES = re.compile(r"[01]+")
_BINARY_NUMBER = re.compile(r"0[bB][01]+")
#: Characters that separate words in the arrays of programs and logs.
_SEPARATORS = re.compile(r"[\s'\",;\[\](){}<>]+")
#: The suffixes of numbers in C.
_HEX_SUFFIX = re.compile(r"[uUlL]+$")
#: Fewest digits that show that numbers are decimal. In hex, 1 of 80,000 texts of this length has no letter.
_FEWEST_DECIMAL_DIGITS = 24
#: Number of digits from which a piece of digits is not a byte in hexadecimal.
_FEWEST_DIGITS_OF_NUMBER = 3
#: A byte in binary with its prefix, whose leading zeros may be missing.
_PREFIXED_BYTE = re.compile(r"0[bB][01]{1,8}")
#: A byte in decimal.
_DECIMAL_BYTE = re.compile(r"0|[1-9][0-9]{0,2}")
#: The beginning of an array of numbers without a prefix, which are decimal in every programming language. Programs also
#: print it without brackets.
_ARRAY = re.compile(r"(?:^|[\[({])\s*[0-9]+\s*,")
#: Bits with their prefix that are too many for a byte.
_PREFIXED_FRAME = re.compile(r"0[bB][01]{9,}")
#: Bits with the prefix 0b, or with the misspelled prefix b. The prefix consists of hex digits too.
_PREFIXED_BITS = re.compile(r"0?[bB][01]+")


def with_prefix(text: str, bits: int) -> str:
    """Add the prefix ``0b`` or ``0x`` to the digits of a frame of ``bits`` bits, if their base is certain.

    The base is certain for digits with a letter or a leading zero, for all bits of the frame, for bits in groups, and
    for bytes in hex or binary. The leading zeros of bytes may be missing. Any other text is returned as it is.
    """
    pieces = text.replace("_", "").split()
    all_digits = "".join(pieces)
    are_hex_digits = all(map(_HEX_DIGITS.fullmatch, pieces))
    if not are_hex_digits or _PREFIXED_BITS.fullmatch(all_digits):
        return text
    if _ZEROS_AND_ONES.fullmatch(all_digits):
        binary_digits = _binary_digits(pieces, bits)
        return f"0b{binary_digits}" if binary_digits else text
    if len(pieces) == 1:
        may_be_decimal = _DECIMAL_DIGITS.fullmatch(all_digits) is not None
        return text if may_be_decimal else f"0x{all_digits}"
    hex_bytes = with_leading_zeros(pieces)
    are_whole_bytes = all(len(hex_byte) % 2 == 0 for hex_byte in hex_bytes)
    if not are_whole_bytes:
        return text
    return " ".join(f"0x{hex_byte}" for hex_byte in hex_bytes)


def _binary_digits(pieces: Sequence[str], bits: int) -> str:
    """Return the bits of a frame from groups of zeros and ones, or "" if the groups may also be hex or decimal.

    The digits are bits if there are as many as the frame has bits, or if the groups have one digit or more than two.
    Groups of four may also be words in hex, unless these would be more bytes than the frame has.
    Groups of different lengths are bytes whose leading zeros are missing, unless one of them begins with a zero.
    """
    digits = "".join(pieces)
    if len(digits) == bits:
        return digits
    longest = max(map(len, pieces))
    # A byte without its leading zeros can also have one digit, but a frame cannot have that many bytes.
    byte_count = (bits + 7) // 8
    are_single_bits = longest == 1 and len(pieces) > byte_count
    if are_single_bits:
        return digits
    if len(pieces) == 1 or longest <= 2:
        return ""
    have_bytes_in_hex = all(len(piece) == 4 for piece in pieces) and len(digits) <= 2 * byte_count
    if have_bytes_in_hex:
        return ""
    have_different_lengths = len(set(map(len, pieces))) > 1
    are_bytes_without_zeros = have_different_lengths and longest <= 8 and not _has_leading_zero(pieces)
    if are_bytes_without_zeros:
        return "".join(piece.zfill(8) for piece in pieces)
    return digits


def with_leading_zeros(pieces: Sequence[str]) -> Sequence[str]:
    """Return bytes in hex or binary, whose leading zeros may be missing, as two hex digits each: ``FF 01``.

    Bytes with the prefix ``0b`` are also accepted if one of them has 8 digits. The pieces are returned as they are if
    one begins with a zero, which shows that no leading zeros are missing, or if zeros and ones may be whole bytes in
    hex.
    """
    if all(map(_ZEROS_AND_ONES.fullmatch, pieces)):
        return _binary_bytes_as_hex(pieces)
    longest = max(map(len, pieces), default=0)
    are_prefixed_bytes = len(pieces) > 1 and all(map(_PREFIXED_BYTE.fullmatch, pieces))
    if are_prefixed_bytes and longest == len("0b") + 8:
        return [f"{int(piece, 2):02X}" for piece in pieces]
    if longest != 2 or _has_leading_zero(pieces):
        return pieces
    return [piece.zfill(2) for piece in pieces]


def _binary_bytes_as_hex(pieces: Sequence[str]) -> Sequence[str]:
    """Return bytes in binary as two hex digits each, or the pieces as they are if they may be something else.

    The pieces are zeros and ones. They are bytes in binary if there are several of 3 to 8 digits, and if they cannot be
    hex: hex bytes have an even number of digits, except that pieces of eight zeros and ones are bits.
    """
    longest = max(map(len, pieces), default=0)
    are_bytes = len(pieces) > 1 and 3 <= longest <= 8
    have_odd_length = any(len(piece) % 2 for piece in pieces)
    have_all_bits = all(len(piece) == 8 for piece in pieces)
    cannot_be_hex = have_odd_length or have_all_bits
    if not are_bytes or not cannot_be_hex:
        return pieces
    return [f"{int(piece, 2):02X}" for piece in pieces]


def _has_leading_zero(pieces: Sequence[str]) -> bool:
    """Return whether a piece of several digits begins with 0."""
    return any(len(piece) > 1 and piece.startswith("0") for piece in pieces)


def bits_of_bytes(text: str, bits: int, *, line_carries_bytes: bool) -> str:
    """Return the binary digits in a text for a frame of ``bits`` bits in bytes, or "" if the text is not binary.

    If the line carries bits, the prefix ``0b`` is enough. Otherwise, the text is binary if it has more digits than the
    frame has in hex, and more than one byte. It must then contain all bits, or, if the line carries bytes, it may be a
    number without leading zeros.
    """
    compact_text = text.replace("_", "")
    has_prefix = _BINARY_NUMBER.fullmatch(compact_text) is not None
    digits = compact_text.removeprefix("0b").removeprefix("0B") if has_prefix else compact_text
    if has_prefix and not line_carries_bytes:
        return digits
    if not _ZEROS_AND_ONES.fullmatch(digits):
        return ""
    most_hex_digits = max(bits // 4, 8)
    is_too_long_for_hex = len(digits) > most_hex_digits
    has_all_bits = len(digits) == bits and "1" in digits
    is_number_without_zeros = line_carries_bytes and digits.startswith("1") and len(digits) <= bits
    is_binary = is_too_long_for_hex and (has_all_bits or is_number_without_zeros)
    return digits if is_binary else ""


def possible_meanings(digits: str, bits: int) -> Iterator[str]:
    """Yield how to write digits without a prefix, for each meaning that they can have in a frame of ``bits`` bits.

    For ``10``, these are ``0xA if it is decimal``, ``0x10 if it is hex`` and ``0b10 if it is bits``. A decimal or
    hexadecimal number must fit into the frame. The number of bits is checked later. The decode page follows the same
    rule.
    """
    largest = (1 << bits) - 1
    if _DECIMAL_DIGITS.fullmatch(digits) and int(digits) <= largest:
        yield frame_texts.if_decimal(f"0x{int(digits):X}")
    if re.fullmatch(DIGITS["hexadecimal"], digits) and int(digits, 16) <= largest:
        yield frame_texts.if_hex(digits)
    if re.fullmatch(DIGITS["bits"], digits):
        yield frame_texts.if_bits(digits)


def meanings_of_long_number(digits: str) -> Iterator[str]:
    """Yield how to write a number without a prefix that is too large for the frame, in decimal or hexadecimal.

    The number may contain more bits than the frame, for example if it comes from a raw buffer.
    """
    if re.fullmatch(DIGITS["long_number"], digits):
        yield frame_texts.if_decimal(f"0x{int(digits):X}")
        yield frame_texts.if_hex(digits)


def meanings_of_array(text: str) -> list[str]:
    """Return how to write the bytes in an array such as ``[18, 52, 86]`` or ``18,52,86``, for each possible meaning.

    Programs print such arrays in decimal, and users type them in hex. The list is empty for any other text.
    """
    array = _ARRAY.search(text)
    return meanings_of_decimal_bytes(_SEPARATORS.sub(" ", text[array.start() :]).split()) if array else []


def with_two_digits(text: str) -> str:
    """Return an array of single digits, such as ``[0, 1, 2]``, as the bytes ``00 01 02``, or any other text as it is.

    Single digits are the same byte in decimal and in hex. Zeros and ones may be bits, so they are returned as they are.
    """
    array = _ARRAY.search(text)
    pieces = _SEPARATORS.sub(" ", text[array.start() :]).split() if array else []
    are_digits = all(len(piece) == 1 and piece.isdecimal() for piece in pieces)
    if array is None or not are_digits or set(pieces) <= {"0", "1"}:
        return text
    return text[: array.start()] + " ".join(f"0{piece}" for piece in pieces)


def meanings_of_decimal_bytes(pieces: Sequence[str]) -> list[str]:
    """Return how to write pieces that can be bytes in decimal: as decimal and, with at most two digits each, as hex.

    The list is empty for any other pieces, for zeros and ones, which may be bits, and for single digits, which are the
    same in decimal and in hex.
    """
    can_be_decimal = len(pieces) > 1 and all(map(_DECIMAL_BYTE.fullmatch, pieces))
    if not can_be_decimal or set("".join(pieces)) <= {"0", "1"} or max(map(int, pieces)) > 0xFF:
        return []
    if max(map(len, pieces)) == 1:
        return []
    meanings = [frame_texts.if_decimal(" ".join(f"0x{int(piece):02X}" for piece in pieces))]
    if max(map(len, pieces)) < _FEWEST_DIGITS_OF_NUMBER:
        meanings.append(frame_texts.if_hex(" 0x".join(piece.zfill(2) for piece in pieces)))
    return meanings


def words_of(text: str, sizes: Sequence[int]) -> list[str]:
    """Return the words in a text with several frames, such as ``{0x7FFE, 0x3FFF}``, each with its prefix.

    ``sizes`` are the possible numbers of bits of a frame. The list is empty for any other text, and if the words could
    also be one longer frame. Words of more than 8 bits with the prefix ``0b`` are always frames of their own, and so
    are decimal numbers that are too large for a frame if they are hexadecimal.
    """
    words = [word for word in _SEPARATORS.split(text) if word]
    if len(words) < 2:
        return []
    if all(_PREFIXED_FRAME.fullmatch(word.replace("_", "")) for word in words):
        return words
    are_numbers = min(map(len, words)) >= _FEWEST_DIGITS_OF_NUMBER and are_decimal_numbers(words, sizes[0])
    if are_numbers and int("".join(words), 16) >> sizes[0]:
        return [f"0b{int(word):0{sizes[0]}b}" for word in words]
    for bits in sizes:
        frames = _words_of_size(words, bits)
        is_possible_size = len(words) * bits in sizes
        if frames and not is_possible_size:
            return frames
    return []


def are_decimal_numbers(texts: Sequence[str], bits: int) -> bool:
    """Return whether all texts are decimal numbers, although single ones could also be hexadecimal.

    Either one of them is too large for a frame of ``bits`` bits if it is hexadecimal, or they have 24 or more digits
    together, among which hexadecimal numbers would have letters.
    """
    if len(texts) < 2 or not all(map(_DECIMAL_DIGITS.fullmatch, texts)):
        return False
    digits = "".join(texts)
    are_bits = set(digits) <= {"0", "1"}
    fit_in_frame = all(int(text) >> bits == 0 for text in texts)
    if are_bits or not fit_in_frame:
        return False
    is_too_large_in_hex = any(int(text, 16) >> bits for text in texts)
    return is_too_large_in_hex or len(digits) >= _FEWEST_DECIMAL_DIGITS


def lack_leading_zeros(texts: Sequence[str], bits: int) -> bool:
    """Return whether texts are frames of ``bits`` bits without their leading zeros, as ``print(x, BIN)`` writes them.

    One of them has all bits, and each begins with a 1. Texts of at most 8 bits may be bytes.
    """
    are_bits = all(_ZEROS_AND_ONES.fullmatch(text) and text.startswith("1") for text in texts)
    lengths = set(map(len, texts))
    return are_bits and len(lengths) > 1 and min(lengths) > 8 and max(lengths) == bits


def are_several_numbers(pieces: Sequence[str], bits: int) -> bool:
    """Return whether pieces are several numbers that cannot be one frame of ``bits`` bits.

    They are binary numbers with the prefix ``0b`` that are not bytes, or decimal digits that would be more bytes than
    the frame has.
    """
    binary_count = sum(_BINARY_NUMBER.fullmatch(piece) is not None for piece in with_leading_zeros(pieces))
    if binary_count > 1:
        return True
    digits = "".join(pieces)
    are_bits = set(digits) <= {"0", "1"}
    are_long_digits = digits.isdecimal() and not are_bits and max(map(len, pieces)) >= _FEWEST_DIGITS_OF_NUMBER
    frame_bytes = (bits + 7) // 8  # rounded up
    return len(pieces) > 1 and are_long_digits and len(digits) > 2 * frame_bytes


def _words_of_size(words: Sequence[str], bits: int) -> list[str]:
    """Return the words with their prefixes if each of them is a frame of ``bits`` bits, or an empty list.

    In hex, a word has all its digits, and a prefix or a letter shows that the words are hex. If all words have the
    prefix, leading zeros of some of them may be missing, but not half of the digits. In binary, at least one word has
    all its bits, and the leading zeros of others may be missing.
    """
    if bits <= 8:
        return []
    digit_count = (bits + 3) // 4
    numbers = [_HEX_SUFFIX.sub("", word) if word[:2] in ("0x", "0X") else word for word in words]
    digits = [number.removeprefix("0x").removeprefix("0X") for number in numbers]
    prefix_count = sum(number != plain for number, plain in zip(numbers, digits, strict=True))
    lengths = [len(plain) for plain in digits]
    if all(map(_HEX_DIGITS.fullmatch, digits)) and max(lengths) == digit_count:
        fewest_digits = digit_count // 2 + 1 if prefix_count == len(words) else digit_count
        are_hex = prefix_count > 0 or not "".join(digits).isdecimal()
        fit = all(int(plain, 16) >> bits == 0 for plain in digits)
        if are_hex and fit and min(lengths) >= fewest_digits:
            return [f"0x{plain}" for plain in digits]
    bit_texts = [word.removeprefix("0b").removeprefix("0B") for word in words]
    lengths = [len(bit_text) for bit_text in bit_texts]
    # Words of at most 8 zeros and ones may be bytes.
    are_binary = all(map(_ZEROS_AND_ONES.fullmatch, bit_texts)) and min(lengths) > 8 and max(lengths) == bits
    return [f"0b{bit_text.zfill(bits)}" for bit_text in bit_texts] if are_binary else []
