# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encodes many frames from columns. Loaded only by ``encode_many``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, NamedTuple

from ..codec import NO_SUCH_FLAG, assert_never
from .chunk import (
    Chunk,
    are_within_limits,
    bit_mask,
    compute_crc,
    compute_parity,
    exchange_columns,
    np,
    shift_left,
    shift_right,
    take_checked_bits,
)
from .decode import CHUNK
from .encode_columns import FirstError, list_names, read_arrays
from .shape import Check, Column, DigitCoding, FrameLayout, Join, find_width
from .table import Table

#: Number of bits per character in a frame, and the number of the last Latin-1 character.
_CHARACTER_BITS: Final = 8
_LAST_LATIN_1: Final = 0xFF


def encode_many(columns: Mapping[str, Any] | Table, layout: FrameLayout) -> Any:
    """Return the frames with the field values in ``columns``, as rows of bytes or as 64-bit numbers.

    ``columns`` is a decoded table, or arrays by name. Raises RowError if a value does not fit its field.
    """
    # Columns of a table that were not decoded from frames, such as ``time``, are ignored.
    other_names: Iterable[str] = ()
    if isinstance(columns, Table):
        other_names = columns.others
        columns = columns.columns
    arrays = read_arrays(columns, layout, other_names)
    # All arrays have the same length.
    count = max(map(len, arrays.values()), default=0)
    frames = np.empty((count, layout.byte_count), np.uint8) if layout.byte_count else np.empty(count, np.uint64)
    for start in range(0, count, CHUNK):
        rows = slice(start, start + CHUNK)
        first_error = FirstError()
        arrays_of_chunk = {name: array[rows] for name, array in arrays.items()}
        words = _encode_rows(arrays_of_chunk, layout, first_error)
        first_error.raise_first(start)
        # A frame of bits has at most 64 bits, which are one word.
        frames[rows] = _convert_to_rows(words, layout) if layout.byte_count else words[0]
    return frames


def _make_words_of_constants(layout: FrameLayout, row_count: int) -> list[Any]:
    """Return frames in which only the constant bits are set, as arrays of 64-bit words, the lowest word first."""
    words: list[Any] = []
    for lowest_bit in range(0, layout.bit_count, 64):
        constant_bits = (layout.fixed >> lowest_bit) & ((1 << 64) - 1)
        words.append(np.full(row_count, np.uint64(constant_bits)))
    return words


def _encode_rows(arrays: Mapping[str, Any], layout: FrameLayout, first_error: FirstError) -> list[Any]:
    """Return the encoded frames as arrays of 64-bit words, the lowest word first.

    Each array has one element per frame. ``arrays`` contains the values of each field by name. A value that does
    not fit is recorded in ``first_error``.
    """
    first_array = next(iter(arrays.values()))
    row_count = len(first_array)
    words = _make_words_of_constants(layout, row_count)
    if "fault" in arrays:
        faults = arrays["fault"]
        first_error.add(faults != 0, "fault", faults, allowed="0 (a frame with an error has no values)")
    for column in layout.columns:
        has_values = all(name in arrays for name in list_names(column))
        if has_values:
            for piece in _encode_field(arrays, column, first_error):
                _insert_bits(words, piece.lowest_bit, piece.width, piece.bits)
        elif column.value_kind == "not_flag":
            # A missing flag is inactive. For an active-low flag, the bit is 1.
            _insert_bits(words, column.lowest_bit, column.width, np.ones(row_count, np.uint64))
    for join in layout.joins:
        if join.name in arrays:
            _insert_joined_number(words, arrays, layout, join, first_error)
    _insert_unused_bits(words, arrays, layout, first_error)
    _check_values(words, arrays, layout, first_error)
    _convert_from_binary(words, layout)
    _insert_parities_and_crc(words, layout)
    return words


def _insert_bits(words: list[Any], lowest_bit: int, width: int, bits: Any) -> None:
    """Insert ``width`` bits into each frame, from bit ``lowest_bit`` on. These bits of ``words`` must still be 0."""
    word_index, shift = divmod(lowest_bit, 64)
    if width:
        words[word_index] |= shift_left(bits, shift)
    continues_in_next_word = shift + width > 64
    if continues_in_next_word:
        words[word_index + 1] |= shift_right(bits, 64 - shift)


class _Piece(NamedTuple):
    """Piece of a field: its lowest bit in the frame, its width, and an array with the bits of each frame."""

    lowest_bit: int
    width: int
    bits: Any


def _encode_field(arrays: Mapping[str, Any], column: Column, first_error: FirstError) -> Iterator[_Piece]:
    """Yield the bits of a field, and their place in the frame.

    A value that does not fit is recorded in ``first_error``.

    A text field has one piece for each character, and any other field has a single piece. ``arrays`` contains the
    values of each field by name.
    """
    # Only a field of decimal digits has several columns, which ``_encode_digits`` takes from ``arrays``.
    first_name = list_names(column)[0]
    values = arrays[first_name]
    match column.value_kind:
        case "flag" | "not_flag":
            bits = _encode_flag(values, column, first_error)
        case "digits":
            bits = _encode_digits(arrays, column, first_error)
        case "text":
            yield from _encode_text(values, column, first_error)
            return
        case "signed":
            bits = _encode_signed(values, column, first_error)
        case "number" | "choice":
            bits = _encode_number(values, column, first_error)
        case _:
            assert_never(column.value_kind)
    yield _Piece(column.lowest_bit, column.width, bits)


def _encode_flag(values: Any, column: Column, first_error: FirstError) -> Any:
    """Return the bit of a flag in each frame: 1 for an active flag, or 0 if the flag is active low.

    Values other than True and False, and active flags that the encoder does not send, are recorded in ``first_error``.
    """
    is_active = values != 0
    if values.dtype.kind != "b":
        first_error.add(is_active & (values != 1), column.name, values, allowed="True or False")
    if not column.width:
        first_error.add(is_active, column.name, values, allowed=NO_SUCH_FLAG)
    is_active_high = column.value_kind == "flag"
    # The bit is 1 for an active flag that is active high, and for an inactive flag that is active low.
    is_bit_set = is_active == is_active_high
    return is_bit_set.astype(np.uint64)


def _encode_digits(arrays: Mapping[str, Any], column: Column, first_error: FirstError) -> Any:
    """Return the number that groups of decimal digits form. Each group has its own column.

    Groups and numbers that are too large are recorded in ``first_error``.
    """
    # The groups 12 and 34 form the number 1234. The group 12 has the divisor 100 and, with two digits, the modulus 100.
    first_name, *_ = column.digit_groups[0]
    number = np.zeros(len(arrays[first_name]), np.uint64)
    for name, divisor, modulus in column.digit_groups:
        digits = _check_unsigned(arrays[name], first_error, name, highest=modulus - 1)
        number += digits * np.uint64(divisor)
    if column.width < 64:
        allowed = f"0 to {(1 << column.width) - 1}"
        first_error.add(shift_right(number, column.width) != 0, column.name, number, allowed)
    return number


def _encode_signed(values: Any, column: Column, first_error: FirstError) -> Any:
    """Return the bits of a signed number in two's complement.

    Values that do not fit are recorded in ``first_error``.
    """
    sign_bit = (1 << column.width) >> 1
    # A field without bits can only have the value 0.
    highest = sign_bit - 1 if sign_bit else 0
    is_wrong = values > highest if sign_bit else values != 0
    # Unsigned arrays have no negative values.
    if values.dtype.kind == "i":
        is_wrong = is_wrong | (values < -sign_bit)
    first_error.add(is_wrong, column.name, values, allowed=f"{-sign_bit} to {highest}")
    return values.astype(np.int64).view(np.uint64) & bit_mask(column.width)


def _encode_number(values: Any, column: Column, first_error: FirstError) -> Any:
    """Return the bits of an unsigned number as 64-bit numbers. Values that do not fit are recorded in ``first_error``.

    If all bits 0 represent another number (``column.zero_means``), such as 16, then 16 is sent as 0, and the value 0 is
    an error. Some fields accept only powers of two.
    """
    if column.power_of_two:
        # A power of two has a single bit, which subtracting 1 clears.
        without_lowest_bit = values & (values - values.dtype.type(1))
        is_wrong = (values < 1) | (without_lowest_bit != 0)
        first_error.add(is_wrong, column.name, values, allowed="a power of two")
    if column.zero_means:
        first_error.add(values == 0, column.name, values, allowed=f"1 to {column.zero_means}")
        values = np.where(values == column.zero_means, values.dtype.type(0), values)
    return _check_unsigned(values, first_error, column.name, highest=(1 << column.width) - 1)


def _check_unsigned(values: Any, first_error: FirstError, name: str, highest: int) -> Any:
    """Return numbers as unsigned 64-bit numbers. Numbers outside 0 to ``highest`` are recorded in ``first_error``."""
    # Unsigned arrays have no negative values.
    is_wrong = values < 0 if values.dtype.kind == "i" else np.zeros(len(values), bool)
    bits = values.astype(np.uint64)
    if highest < (1 << 64) - 1:
        is_wrong = is_wrong | (bits > np.uint64(highest))
    first_error.add(is_wrong, name, values, allowed=f"0 to {highest}")
    return bits


def _encode_text(values: Any, column: Column, first_error: FirstError) -> Iterator[_Piece]:
    """Yield the characters of a text field as pieces of 8 bits, from the highest place in the frame to the lowest.

    ``values`` is an array of strings. A string that is shorter than the field is padded with NUL characters. A longer
    string, or one with a character outside Latin-1, is recorded in ``first_error``.
    """
    length = column.width // _CHARACTER_BITS
    # NumPy stores the characters of a bytes array (S) in one byte each, and the characters of a text array (U) in four.
    character_type = np.dtype(np.uint8 if values.dtype.kind == "S" else np.uint32)
    stored_count = values.dtype.itemsize // character_type.itemsize
    # A row for each string and a column for each character, with NUL where the strings are shorter than the field.
    characters = np.zeros((len(values), max(length, stored_count)), character_type)
    # Without gaps and in the byte order of this machine, the memory of the strings can be viewed as characters.
    contiguous_values = np.ascontiguousarray(values, values.dtype.newbyteorder("="))
    characters[:, :stored_count] = contiguous_values.view(character_type).reshape(len(values), stored_count)
    is_not_latin_1 = (characters > _LAST_LATIN_1).any(axis=1)
    is_too_long = characters[:, length:].any(axis=1)
    first_error.add(is_not_latin_1 | is_too_long, column.name, values, allowed=f"{length} Latin-1 characters")
    for index in range(length):
        following_characters = length - 1 - index
        lowest_bit = column.lowest_bit + _CHARACTER_BITS * following_characters
        yield _Piece(lowest_bit, _CHARACTER_BITS, characters[:, index].astype(np.uint64))


def _insert_joined_number(
    words: list[Any], arrays: Mapping[str, Any], layout: FrameLayout, join: Join, first_error: FirstError
) -> None:
    """Insert a number that consists of several fields into the frames, such as a position of multiturn and singleturn.

    Fields whose values are also given separately are already in ``words``. If they differ from their bits in the joined
    number, the error is recorded in ``first_error``.
    """
    width = find_width(layout, join)
    joined_numbers = _check_unsigned(arrays[join.name], first_error, join.name, highest=(1 << width) - 1)
    by_name = {column.name: column for column in layout.columns}
    for name, lowest_bit_in_number in join.fields:
        column = by_name[name]
        if not column.width:
            continue
        bits = shift_right(joined_numbers, lowest_bit_in_number) & bit_mask(column.width)
        is_given_separately = all(field_name in arrays for field_name in list_names(column))
        if is_given_separately:
            separate_bits = Chunk(words, layout.bit_count).take(column.lowest_bit, column.width)
            first_error.add(separate_bits != bits, join.name, arrays[join.name], allowed="equal to its fields")
        else:
            _insert_bits(words, column.lowest_bit, column.width, bits)


def _insert_unused_bits(
    words: list[Any], arrays: Mapping[str, Any], layout: FrameLayout, first_error: FirstError
) -> None:
    """Insert the unused bits with the values given in the manual, inverted where a bit of the column ``unused`` is 1.

    This column contains all unused bits of a frame side by side: ``bit_in_column`` is a bit in the column, and
    ``lowest_bit`` a bit in the frame. Without this column, all unused bits have the values given in the manual. Other
    bits that are 1 in the column are an error, which is recorded in ``first_error``.
    """
    no_differences = np.zeros(len(words[0]), np.uint8)
    differences = arrays.get("unused", no_differences)
    differing_bits = differences.astype(np.uint64)
    unused_mask = sum(((1 << unused.width) - 1) << unused.bit_in_column for unused in layout.unused)
    # NumPy requires that the mask fits into 64 bits.
    other_bits_mask = ~np.uint64(unused_mask & ((1 << 64) - 1))
    has_other_bits = (differing_bits & other_bits_mask) != 0
    first_error.add(has_other_bits, "unused", differences, allowed=f"within the mask {unused_mask:#x}")
    for unused in layout.unused:
        bits_in_manual = np.uint64(unused.value)
        bits_to_send = shift_right(differing_bits, unused.bit_in_column) ^ bits_in_manual
        _insert_bits(words, unused.lowest_bit, unused.width, bits_to_send & bit_mask(unused.width))


def _check_values(words: list[Any], arrays: Mapping[str, Any], layout: FrameLayout, first_error: FirstError) -> None:
    """In ``first_error``, record the first value that its field does not allow, or that exceeds the field's limits.

    ``words`` are the frames so far, and ``arrays`` the values of each field by name, for the error.
    """
    # The column of a check is the one that covers exactly the same bits of the frame.
    columns_by_bits = {(column.lowest_bit, column.width): column for column in layout.columns}
    for check in layout.checks:
        if check.joined and check.highest is not None:
            joined_numbers = take_checked_bits(Chunk(words, layout.bit_count), check)
            is_within = are_within_limits(joined_numbers, check, check.highest)
            first_error.add(~is_within, layout.position, joined_numbers, allowed=f"at most {check.highest}")
            continue
        column = columns_by_bits.get((check.lowest_bit, check.width))
        # No column covers constants, and parity bits are computed.
        if column is None or check.parity_of:
            continue
        bits = Chunk(words, layout.bit_count).take(check.lowest_bit, check.width)
        _check_column(bits, arrays, column, check, first_error)


def _check_column(bits: Any, arrays: Mapping[str, Any], column: Column, check: Check, first_error: FirstError) -> None:
    """In ``first_error``, record the first value of a column that is not in the list of a check, or above its limit.

    ``bits`` are the bits of the column in each frame.
    """
    if check.highest is None:
        allowed_values = ", ".join(map(str, check.allowed_values))
        # A value that needs more bits than the field never occurs in it.
        possible_values = [value for value in check.allowed_values if 0 <= value < (1 << check.width)]
        is_not_allowed = ~np.isin(bits, possible_values)
        values = arrays.get(column.name, bits)
        first_error.add(is_not_allowed, column.name, values, allowed=f"one of {allowed_values}")
        return
    is_outside = ~are_within_limits(bits, check, check.highest)
    if column.value_kind == "signed":
        first_error.add(is_outside, column.name, arrays[column.name], allowed=f"{check.lowest} to {check.highest}")
    else:
        first_error.add(is_outside, column.name, bits, allowed=f"at most {check.highest}")


def _convert_from_binary(words: list[Any], layout: FrameLayout) -> None:
    """Convert binary numbers to separate digits and to Gray code, where the encoder sends these. Changes ``words``.

    Frames with such numbers have a single word.
    """
    for coding in layout.digit_codings:
        _convert_to_digits(words, coding)
    if layout.gray is not None:
        lowest_bit, width = layout.gray
        _convert_to_gray(words, lowest_bit, width, layout.excess)


def _insert_parities_and_crc(words: list[Any], layout: FrameLayout) -> None:
    """Insert the parity bits, then the CRC, which also covers the parity bits. Both cover the bits as they are sent."""
    chunk = Chunk(words, layout.bit_count)
    for check in layout.parities:
        parity_bits = compute_parity(chunk, check).astype(np.uint64)
        _insert_bits(words, check.lowest_bit, check.width, parity_bits)
    if layout.crc is not None:
        # A new chunk, because the first one can have cached bytes from before the parity bits.
        chunk_with_parities = Chunk(words, layout.bit_count)
        crc_bits = compute_crc(chunk_with_parities, layout.crc).astype(np.uint64)
        _insert_bits(words, layout.crc.lowest_bit, layout.crc.width, crc_bits)


def _convert_to_digits(words: list[Any], coding: DigitCoding) -> None:
    """Replace a binary number in each frame with the codes of its digits, such as BCD. Changes the first word."""
    base = np.uint64(len(coding.codes))
    codes = np.array(coding.codes, np.uint64)
    number = shift_right(words[0], coding.lowest_bit) & bit_mask(coding.width)
    # Clear the bits of the number, which the codes replace.
    words[0] ^= shift_left(number, coding.lowest_bit)
    # Take the digits of the number one by one, the lowest digit first.
    for code_shift in range(0, coding.width, coding.digit_bits):
        lowest_digit = (number % base).astype(np.intp)
        # The highest digit can have fewer bits than its code.
        code_within_field = codes[lowest_digit] & bit_mask(coding.width - code_shift)
        words[0] |= shift_left(code_within_field, coding.lowest_bit + code_shift)
        number = number // base


def _convert_to_gray(words: list[Any], lowest_bit: int, width: int, excess: int) -> None:
    """Convert the ``width`` bits starting at bit ``lowest_bit`` from binary to Gray code. Changes the first word.

    ``excess`` is the number that the encoder sends for position 0, and is added to the binary number first.
    """
    if excess:
        # The sum of a position and the excess always fits into the bits.
        words[0] += np.uint64(excess << lowest_bit)
    binary = shift_right(words[0], lowest_bit) & bit_mask(width)
    # The Gray code of n is n ^ n >> 1.
    words[0] ^= shift_left(shift_right(binary, 1), lowest_bit)


def _convert_to_rows(words: list[Any], layout: FrameLayout) -> Any:
    """Return the bytes of each frame as a row, in the order in which they are sent."""
    # The bytes of each word, the lowest byte first, as one row for each frame.
    bytes_by_word = [word.astype("<u8").view(np.uint8).reshape(-1, 8) for word in words]
    rows = np.stack(bytes_by_word, axis=1).reshape(len(words[0]), -1)
    # The highest word can have more bytes than the frame.
    rows = rows[:, : layout.byte_count]
    return exchange_columns(rows if layout.order == "little" else rows[:, ::-1], layout)
