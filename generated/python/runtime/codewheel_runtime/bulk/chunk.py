# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames as NumPy arrays of 64-bit words: their bits, parities and CRCs."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, reduce
from typing import Any, Final

from ..packages import load
from .shape import Check, CrcOf, DigitCoding, FrameLayout

#: NumPy, untyped so that type checkers accept all its versions.
np: Any = load("numpy")


#: Size of a word in bits and in bytes, and the word whose bits are all 1.
_WORD_BITS: Final = 64
_WORD_BYTES: Final = 8
_WORD_MASK: Final = (1 << _WORD_BITS) - 1


def bit_mask(width: int) -> Any:
    """Return the 64-bit number whose ``width`` lowest bits are 1."""
    return np.uint64(((1 << width) - 1) & _WORD_MASK)


def shift_right(numbers: Any, places: int) -> Any:
    """Return 64-bit numbers shifted right, which drops their ``places`` lowest bits."""
    return numbers >> np.uint64(places)


def shift_left(numbers: Any, places: int) -> Any:
    """Return 64-bit numbers shifted left. Bits that are shifted beyond bit 63 are lost."""
    return numbers << np.uint64(places)


class Chunk:
    """Chunk of frames. Each frame is a number of ``bits`` bits, split into 64-bit words. Higher bits are 0.

    ``words`` is a list of arrays, each with one element per frame. The first array contains the lowest 64 bits of
    all frames. ``_cached_bytes`` keeps the arrays of single bytes that were extracted, by the index of the byte.
    ``_before_conversion`` is a copy of the chunk before digits or Gray code were converted, otherwise None.
    """

    def __init__(self, words: list[Any], bits: int) -> None:
        self.words = words
        self.bits = bits
        self._before_conversion: Chunk | None = None
        self._cached_bytes: dict[int, Any] = {}

    @property
    def as_sent(self) -> Chunk:
        """Chunk with the bits as they were sent, before any digits or Gray code are converted to binary."""
        # A chunk that stored itself would stay in memory until the next run of the garbage collector.
        return self._before_conversion or self

    def byte(self, index: int) -> Any:
        """Return byte ``index`` of each frame: the eight bits that start at bit ``8 * index``."""
        if index not in self._cached_bytes:
            word_index, byte_in_word = divmod(index, _WORD_BYTES)
            word = self.words[word_index]
            if byte_in_word:
                word = shift_right(word, 8 * byte_in_word)
            # The conversion keeps the lowest eight bits.
            self._cached_bytes[index] = word.astype(np.uint8)
        return self._cached_bytes[index]

    def take_from_byte(self, lowest_bit: int, mask: int) -> Any:
        """Return the bits of each frame that start at bit ``lowest_bit``, limited to ``mask``.

        All of them are in the same byte.
        """
        byte_index, shift = divmod(lowest_bit, 8)
        bits = self.byte(byte_index)
        if shift:
            bits = bits >> np.uint8(shift)
        mask_of_shifted_byte = 0xFF >> shift
        return bits if mask == mask_of_shifted_byte else bits & np.uint8(mask)

    def take(self, lowest_bit: int, width: int) -> Any:
        """Return the ``width`` bits of each frame from bit ``lowest_bit`` on. The array has 8-bit or 64-bit numbers.

        If the width is 0, all numbers are 0.
        """
        if not width:
            return np.zeros(len(self.words[0]), np.uint8)
        if _is_in_one_byte(lowest_bit, width):
            return self.take_from_byte(lowest_bit, (1 << width) - 1)
        return self._take_from_words(lowest_bit, width, out=None)

    def write_bits(self, lowest_bit: int, width: int, out: Any) -> None:
        """Write the ``width`` bits of each frame from bit ``lowest_bit`` on into ``out``, an array of 64-bit numbers.

        If the width is 0, all numbers are 0.
        """
        if not width:
            out[:] = 0
        elif _is_in_one_byte(lowest_bit, width):
            out[:] = self.take_from_byte(lowest_bit, (1 << width) - 1)
        else:
            self._take_from_words(lowest_bit, width, out=out)

    def _take_from_words(self, lowest_bit: int, width: int, out: Any) -> Any:
        """Return the bits of a field as 64-bit numbers. They are written into ``out``, or a new array if it is None."""
        word_index, shift = divmod(lowest_bit, _WORD_BITS)
        number = np.right_shift(self.words[word_index], np.uint64(shift), out=out)
        end_in_word = shift + width
        if end_in_word > _WORD_BITS:
            # The field continues in the next word.
            number |= shift_left(self.words[word_index + 1], _WORD_BITS - shift)
        # The shift leaves the bits above the field in the number, unless the field ends with its word or the frame.
        ends_with_word = end_in_word == _WORD_BITS
        ends_with_frame = lowest_bit + width == self.bits
        has_bits_above = not (ends_with_word or ends_with_frame or width == _WORD_BITS)
        if has_bits_above:
            number &= bit_mask(width)
        return number

    def write_flag(self, lowest_bit: int, width: int, is_active_high: bool, out: Any) -> None:
        """Write the state of a flag into ``out``, an array of bools: True for each frame in which it is active.

        The flag is bit ``lowest_bit``. An active-low flag (``is_active_high`` is False) is active if the bit is 0. If
        the width is 0, the encoder does not send the flag, and it is never active.
        """
        if not width:
            out[:] = False
            return
        bit = self.byte(lowest_bit // 8) & np.uint8(1 << (lowest_bit % 8))
        if is_active_high:
            np.not_equal(bit, 0, out=out)
        else:
            np.equal(bit, 0, out=out)

    def convert_to_binary(self, layout: FrameLayout) -> None:
        """Convert numbers in this chunk that are sent as separate digits or in Gray code to binary.

        ``as_sent`` returns the unconverted bits. Frames with such numbers have a single word.
        """
        if layout.gray is None and not layout.digit_codings:
            return
        self._before_conversion = Chunk(self.words, self.bits)
        for coding in layout.digit_codings:
            self._convert_from_digits(coding)
        if layout.gray is not None:
            lowest_bit, width = layout.gray
            self._convert_from_gray(lowest_bit, width, layout.excess)
        # These bytes were extracted before the conversion.
        self._cached_bytes.clear()

    def _convert_from_digits(self, coding: DigitCoding) -> None:
        """Replace separate digits, such as BCD, with the binary number that they form.

        If the code of a digit is invalid, all bits of the number are 1, which is above the highest number.
        """
        base = len(coding.codes)
        # Each valid code has a digit below the base. The base itself marks the invalid codes.
        digits_by_code = np.full(1 << coding.digit_bits, base, np.uint8)
        digits_by_code[list(coding.codes)] = np.arange(base, dtype=np.uint8)
        codes = shift_right(self.words[0], coding.lowest_bit) & bit_mask(coding.width)
        number = np.zeros_like(codes)
        is_invalid = np.zeros(len(codes), bool)
        place_value = 1
        for shift in range(0, coding.width, coding.digit_bits):
            code = shift_right(codes, shift) & bit_mask(coding.digit_bits)
            digit = digits_by_code[code.astype(np.uint8)]
            is_invalid |= digit == base
            number += digit.astype(np.uint64) * np.uint64(place_value)
            place_value *= base
        number[is_invalid] = bit_mask(coding.width)
        changed_bits = shift_left(codes ^ number, coding.lowest_bit)
        self.words = [self.words[0] ^ changed_bits]

    def _convert_from_gray(self, lowest_bit: int, width: int, excess: int) -> None:
        """Convert the ``width`` bits from bit ``lowest_bit`` on from Gray code to binary. The other bits do not change.

        ``excess`` is the number that the encoder sends for position 0, and is subtracted from the binary number.
        """
        mask = shift_left(bit_mask(width), lowest_bit)
        gray = self.words[0] & mask
        # Bit n of the binary number is the XOR of the Gray bits from n up. Shifts by 1, 2, 4, ... combine them.
        binary = gray
        shift = 1
        while shift < width:
            binary = binary ^ (shift_right(binary, shift) & mask)
            shift *= 2
        if excess:
            binary = (binary - np.uint64(excess << lowest_bit)) & mask
        changed_bits = gray ^ binary
        self.words = [self.words[0] ^ changed_bits]


def _is_in_one_byte(lowest_bit: int, width: int) -> bool:
    """Return whether the ``width`` bits that start at bit ``lowest_bit`` are in the same byte of a frame."""
    return lowest_bit % 8 + width <= 8


def split_into_words(rows: Any, layout: FrameLayout) -> list[Any]:
    """Return frames that are rows of bytes as arrays of 64-bit words. The first array has the lowest 64 bits.

    Each word is read as one number of eight bytes. If fewer bytes are left for the highest word, it is read together
    with bytes of the word below, which are then shifted out.
    """
    contiguous_rows = np.ascontiguousarray(exchange_columns(rows, layout))
    row_count, row_bytes = contiguous_rows.shape
    is_little_endian = layout.order == "little"
    if row_bytes < _WORD_BYTES:
        return [_read_short_rows(contiguous_rows, is_little_endian)]
    words: list[Any] = []
    for lowest_byte in range(0, row_bytes, _WORD_BYTES):
        # Number of bytes of the word below that are read together with the highest word.
        overlap = max(lowest_byte + _WORD_BYTES - row_bytes, 0)
        first_byte = lowest_byte - overlap
        # In big-endian order, the lowest byte is the last one of the row.
        offset = first_byte if is_little_endian else row_bytes - _WORD_BYTES - first_byte
        word = _view_word(contiguous_rows, row_count, offset, is_little_endian).astype(np.uint64)
        if overlap:
            word >>= np.uint64(8 * overlap)
        words.append(word)
    return words


def exchange_columns(rows: Any, layout: FrameLayout) -> Any:
    """Return frames that are rows of bytes with the bytes of each field with its own byte order in reverse order."""
    if not layout.exchanged_bytes:
        return rows
    byte_indices = list(range(layout.byte_count))
    for start, stop in layout.exchanged_bytes:
        byte_indices[start:stop] = reversed(byte_indices[start:stop])
    return rows[:, byte_indices]


def _view_word(rows: Any, row_count: int, offset: int, is_little_endian: bool) -> Any:
    """Return a view of eight bytes in each of the first ``row_count`` rows, as one word.

    They begin at byte ``offset``.
    """
    row_bytes = rows.shape[1]
    return np.ndarray((row_count,), _get_word_type(is_little_endian), rows, offset, strides=(row_bytes,))


def _get_word_type(is_little_endian: bool) -> str:
    """Return NumPy's name for a number of eight bytes in little-endian or big-endian order."""
    return "<u8" if is_little_endian else ">u8"


def _read_short_rows(rows: Any, is_little_endian: bool) -> Any:
    """Return rows of fewer than eight bytes as numbers.

    Eight bytes are read for each row, including bytes of the next rows, which are then removed. The last rows are
    copied and padded, because eight bytes would reach beyond the array.
    """
    row_count, row_bytes = rows.shape
    # A row has at least one byte, so eight bytes can be read from the beginning of every row before the last eight.
    padded_count = min(row_count, _WORD_BYTES)
    unpadded_count = row_count - padded_count
    numbers = np.empty(row_count, np.uint64)
    if unpadded_count:
        numbers[:unpadded_count] = _view_word(rows, unpadded_count, 0, is_little_endian)
    padded_rows = np.zeros((padded_count, _WORD_BYTES), np.uint8)
    padded_rows[:, :row_bytes] = rows[unpadded_count:]
    numbers[unpadded_count:] = padded_rows.view(_get_word_type(is_little_endian))[:, 0]
    # The bytes of the next row are the high bytes in little-endian order, otherwise the low bytes.
    if is_little_endian:
        numbers &= bit_mask(8 * row_bytes)
    else:
        numbers >>= np.uint64(8 * (_WORD_BYTES - row_bytes))
    return numbers


def take_checked_bits(chunk: Chunk, check: Check) -> Any:
    """Return the bits of each frame to which a check applies: one group of bits, or several that form a number."""
    if not check.joined:
        return chunk.take(check.lowest_bit, check.width)
    numbers = np.zeros(len(chunk.words[0]), np.uint64)
    for lowest_bit, width in check.joined:
        numbers = shift_left(numbers, width) | chunk.take(lowest_bit, width)
    return numbers


def are_within_limits(bits: Any, check: Check, limit: int) -> Any:
    """Return an array that is True for each number from ``check.lowest`` to ``limit``, the limit of the check.

    ``bits`` are the bits of a field. Negative numbers are in two's complement.
    """
    bits_type = bits.dtype.type
    mask = (1 << check.width) - 1
    if check.lowest:
        # Modulo 2**width, the lowest number becomes 0, so one comparison checks both limits.
        bits = (bits - bits_type(check.lowest & mask)) & bits_type(mask)
    return bits <= bits_type(limit - check.lowest)


def compute_parity(chunk: Chunk, check: Check) -> Any:
    """Return the parity bit of each frame, which covers the bits as they were sent.

    The parity bit is the XOR of the bits in ``check.parity_of``, inverted if ``check.odd`` is True. It is 0 if the
    encoder does not send a parity bit.
    """
    if not check.width:
        return np.zeros(len(chunk.words[0]), np.uint8)
    covered_fields = [chunk.as_sent.take(lowest_bit, width) for lowest_bit, width in check.parity_of]
    if len(covered_fields) == 1:
        covered_bits = covered_fields[0]
    else:
        # The parity of several fields is the parity of their XOR.
        covered_bits = np.bitwise_xor.reduce([field.astype(np.uint64) for field in covered_fields])
    highest_width = max(width for _, width in check.parity_of)
    bits_type = covered_bits.dtype.type
    if check.mask:
        mask_within_fields = check.mask & ((1 << highest_width) - 1)
        covered_bits = covered_bits & bits_type(mask_within_fields)
    even_parity = _xor_bits_of_each(covered_bits, highest_width)
    return even_parity ^ bits_type(check.odd)


def _xor_bits_of_each(numbers: Any, width: int) -> Any:
    """Return the XOR of the ``width`` lowest bits of each number: 1 for an odd number of ones. Higher bits must be 0.

    The upper half of the bits is folded onto the lower half until one bit is left. Example with four bits:
    ``1011 -> 10 ^ 11 = 01 -> 0 ^ 1 = 1``.
    """
    number_type = numbers.dtype.type
    # The width is rounded up to a power of two: half of it is 4 for the widths 5 to 8.
    half_width = (1 << max(width - 1, 0).bit_length()) // 2
    while half_width:
        numbers = numbers ^ (numbers >> number_type(half_width))
        half_width //= 2
    return numbers & number_type(1)


def compute_crc(chunk: Chunk, crc: CrcOf) -> Any:
    """Return the CRC of each frame of a chunk in which the bits of the CRC are still 0."""
    # The difference between a CRC of 0 and the computed CRC is the computed CRC.
    return find_crc_difference(chunk, crc)


def find_crc_difference(chunk: Chunk, crc: CrcOf) -> Any:
    """Return the XOR of the CRC in each frame and the CRC computed from the frame. It is 0 if they are equal."""
    if crc.steps:
        return _fold_crc(chunk.words[0], crc, chunk.bits)
    if crc.is_xor:
        return _xor_all_bytes(chunk, crc.xorout)
    # For other CRCs, each byte of the frame contributes an entry of its table.
    first_table, *other_tables = _make_crc_tables(crc.find_difference, chunk.bits)
    difference = first_table[chunk.byte(0)]
    for byte_index, table in enumerate(other_tables, 1):
        difference ^= table[chunk.byte(byte_index)]
    return difference


def _xor_all_bytes(chunk: Chunk, xorout: int) -> Any:
    """Return the XOR of all bytes of each frame, including its CRC, and of ``xorout``. It is 0 if the CRC is correct.

    The 64 bits are folded to 32, 16 and 8 bits.
    """
    number = reduce(np.bitwise_xor, chunk.words)
    folded = (number ^ shift_right(number, 32)).astype(np.uint32)
    folded ^= folded >> np.uint32(16)
    folded ^= folded >> np.uint32(8)
    xor_of_bytes = folded.astype(np.uint8)
    return xor_of_bytes ^ np.uint8(xorout) if xorout else xor_of_bytes


def _fold_crc(number: Any, crc: CrcOf, bits: int) -> Any:
    """Return the remainder of each frame, a number of ``bits`` bits, after division by the polynomial of its CRC.

    The remainder is 0 if the CRC is correct. Each step removes the bits from ``step.shift`` upward, and XORs them onto
    the lower bits (``step.mask``) at two places: at bit 0 and, unless ``step.back`` is 0, at bit ``step.back``. This
    does not change the remainder. As soon as the numbers fit into 32 bits, the steps use 32-bit numbers, which takes
    half the time.
    """
    remainder = number ^ np.uint64(crc.xorout) if crc.xorout else number
    number_type = np.uint64
    remaining_bits = bits
    for step in crc.steps:
        if remaining_bits <= step.shift:
            # There are no bits to fold.
            continue
        high_bits = remainder >> number_type(step.shift)
        remainder = remainder & number_type(step.mask)
        folded_width = remaining_bits - step.shift + step.back
        remaining_bits = max(step.shift, folded_width)
        if number_type is np.uint64 and remaining_bits <= 32:
            number_type = np.uint32
            remainder = remainder.astype(number_type)
            high_bits = high_bits.astype(number_type)
        remainder ^= high_bits
        if step.back:
            high_bits <<= number_type(step.back)
            remainder ^= high_bits
    return remainder


@lru_cache(maxsize=64)
def _make_crc_tables(compute_difference: Callable[[int], int], bits: int) -> tuple[Any, ...]:
    """Return a table of 256 entries for each byte of a frame of ``bits`` bits, the lowest byte first.

    The XOR of the entries for all bytes of a frame is its CRC difference: the CRC in the frame XOR the CRC computed
    from its other bits. ``compute_difference`` computes this for one frame. Each bit contributes the same difference to
    every frame, so the contributions can be combined by XOR. The first table also includes the difference of frame 0.
    """
    zero_difference = compute_difference(0)
    tables: list[Any] = []
    for lowest_bit in range(0, bits, 8):
        is_first_table = lowest_bit == 0
        first_entry = zero_difference if is_first_table else 0
        table = np.array([first_entry], np.uint64)
        # Each bit doubles the table: its second half has the entries with this bit set.
        for bit in range(lowest_bit, lowest_bit + 8):
            # Bits above the frame are always 0, so their entries are never used.
            contribution = compute_difference(1 << bit) ^ zero_difference if bit < bits else 0
            table = np.concatenate([table, table ^ np.uint64(contribution)])
        tables.append(table)
    return tuple(tables)
