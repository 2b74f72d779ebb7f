# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames as NumPy arrays of 64-bit numbers: their bits, parities and CRCs."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, reduce
from typing import Any, Final

from ..packages import load
from .shape import Check, CrcOf, DigitCoding, Shape

#: NumPy, untyped so that type checkers accept all its versions.
np: Any = load("numpy")


#: Number of bits of a limb, the number with all of them set, and its number of bytes.
_LIMB_BITS: Final = 64
_LIMB_MASK: Final = (1 << _LIMB_BITS) - 1
_LIMB_BYTES: Final = 8


def bit_mask(width: int) -> Any:
    """Return the 64-bit number whose ``width`` lowest bits are 1."""
    return np.uint64(((1 << width) - 1) & _LIMB_MASK)


def shift_right(numbers: Any, places: int) -> Any:
    """Return 64-bit numbers without their lowest bits."""
    return numbers >> np.uint64(places)


def shift_left(numbers: Any, places: int) -> Any:
    """Return 64-bit numbers multiplied by a power of two. Bits above the highest one are lost."""
    return numbers << np.uint64(places)


class Chunk:
    """Chunk of frames. Each is a ``bits``-bit number in 64-bit limbs, lowest limb first. Higher bits are 0.

    ``limbs`` is a list of arrays, each with an element for each frame. ``_bytes`` keeps the arrays of single bytes that
    were extracted, by the index of the byte. ``_as_sent`` is the chunk with Gray code, once it is converted.
    """

    def __init__(self, limbs: list[Any], bits: int) -> None:
        self.limbs = limbs
        self.bits = bits
        self._as_sent: Chunk | None = None
        self._bytes: dict[int, Any] = {}

    @property
    def sent(self) -> Chunk:
        """Chunk with the bits as they were sent, before any Gray code is converted."""
        # A chunk that stored itself would stay in memory until the next run of the garbage collector.
        return self._as_sent or self

    def byte(self, index: int) -> Any:
        """Return byte ``index`` of each frame: the eight bits that start at bit ``8 * index``."""
        if index not in self._bytes:
            limb_index, byte_in_limb = divmod(index, 8)
            limb = self.limbs[limb_index]
            if byte_in_limb:
                limb = shift_right(limb, 8 * byte_in_limb)
            # The conversion keeps the lowest eight bits.
            self._bytes[index] = limb.astype(np.uint8)
        return self._bytes[index]

    def small(self, low: int, mask: int) -> Any:
        """Return the bits that start at ``low``, limited to ``mask``. All of them are in one byte."""
        byte_index, shift = divmod(low, 8)
        bits = self.byte(byte_index)
        if shift:
            bits = bits >> np.uint8(shift)
        # After the shift, this many bits of the byte are left.
        is_rest_of_byte = mask == 0xFF >> shift
        return bits if is_rest_of_byte else bits & np.uint8(mask)

    def take(self, low: int, width: int, out: Any = None) -> Any:
        """Return the ``width`` bits of each frame that start at ``low``.

        With ``out``, an array of 64-bit numbers, they are written there, and callers must not use the result, which can
        be None. Without it, the type can be smaller.
        """
        is_in_one_byte = low % 8 + width <= 8
        if not width or is_in_one_byte:
            bits = self.small(low, (1 << width) - 1) if width else np.zeros(len(self.limbs[0]), np.uint8)
            return bits if out is None else np.copyto(out, bits)
        limb_index, shift = divmod(low, _LIMB_BITS)
        number = np.right_shift(self.limbs[limb_index], np.uint64(shift), out=out)
        end_in_limb = shift + width
        if end_in_limb > _LIMB_BITS:
            # The field continues in the next limb.
            number |= shift_left(self.limbs[limb_index + 1], _LIMB_BITS - shift)
        # Nothing is above the last bits of a limb or of the frame.
        has_bits_above = end_in_limb != _LIMB_BITS and low + width != self.bits
        if has_bits_above and width != _LIMB_BITS:
            number &= bit_mask(width)
        return number

    def flag(self, low: int, width: int, active: bool, out: Any) -> None:
        """Set ``out`` to True where a bit is 1, or where it is 0 if ``active`` is False. Without a bit, it is False."""
        if not width:
            out[:] = False
            return
        bit = self.byte(low // 8) & np.uint8(1 << (low % 8))
        (np.not_equal if active else np.equal)(bit, 0, out=out)

    def convert(self, shape: Shape) -> None:
        """Convert numbers that are sent as digits, or in Gray code, to binary. ``sent`` is the chunk as it was before.

        Such frames have a single limb.
        """
        if shape.gray is None and not shape.digit_codings:
            return
        self._as_sent = Chunk(self.limbs, self.bits)
        for coding in shape.digit_codings:
            self._convert_digits(coding)
        if shape.gray is not None:
            self.ungray(*shape.gray, shape.excess)
        self._bytes.clear()

    def _convert_digits(self, coding: DigitCoding) -> None:
        """Convert separate digits to the number that they form. Its bits are all 1 if a digit has no valid code."""
        base = len(coding.codes)
        # The digit of each code. Codes of no digit have the digit ``base``.
        digits_by_code = np.full(1 << coding.digit_bits, base, np.uint8)
        digits_by_code[list(coding.codes)] = np.arange(base, dtype=np.uint8)
        sent = shift_right(self.limbs[0], coding.low) & bit_mask(coding.width)
        number = np.zeros_like(sent)
        is_invalid = np.zeros(len(sent), bool)
        for place in range(0, coding.width, coding.digit_bits):
            code = shift_right(sent, place) & bit_mask(coding.digit_bits)
            digit = digits_by_code[code.astype(np.uint8)]
            is_invalid |= digit == base
            number += digit.astype(np.uint64) * np.uint64(base ** (place // coding.digit_bits))
        number[is_invalid] = bit_mask(coding.width)
        # The XOR of both is 1 in the bits that change.
        self.limbs = [self.limbs[0] ^ shift_left(sent ^ number, coding.low)]

    def ungray(self, low: int, width: int, excess: int) -> None:
        """Convert the ``width`` bits from ``low`` on from Gray code to binary, minus ``excess``. The others stay."""
        mask = shift_left(bit_mask(width), low)
        gray = self.limbs[0] & mask
        # Bit n is the XOR of all Gray bits from n on, which doubling shifts collect.
        binary = gray
        shift = 1
        while shift < width:
            binary = binary ^ (shift_right(binary, shift) & mask)
            shift *= 2
        if excess:
            binary = (binary - np.uint64(excess << low)) & mask
        # The XOR with ``gray`` clears its bits, and the XOR with ``binary`` sets the converted bits.
        self.limbs = [self.limbs[0] ^ gray ^ binary]


def limbs_of(rows: Any, shape: Shape) -> list[Any]:
    """Return rows of bytes as limbs, the lowest limb first.

    Each limb is read as one number of eight bytes. The highest limb can have fewer bytes in the row. This limb is then
    read together with bytes of the limb below, which are shifted out.
    """
    contiguous_rows = np.ascontiguousarray(rows)
    row_bytes = contiguous_rows.shape[1]
    is_little = shape.order == "little"
    if row_bytes < _LIMB_BYTES:
        return [_read_short_rows(contiguous_rows, is_little)]
    limbs: list[Any] = []
    for low_byte in range(0, row_bytes, _LIMB_BYTES):
        # Number of bytes of the highest limb that belong to the limb below.
        overlap = max(low_byte + _LIMB_BYTES - row_bytes, 0)
        first_byte = low_byte - overlap
        # In big-endian order, the lowest byte is the last one of the row.
        offset = first_byte if is_little else row_bytes - _LIMB_BYTES - first_byte
        limb = _view_limb(contiguous_rows, len(contiguous_rows), offset, is_little).astype(np.uint64)
        if overlap:
            limb >>= np.uint64(8 * overlap)
        limbs.append(limb)
    return limbs


def _view_limb(rows: Any, row_count: int, offset: int, is_little: bool) -> Any:
    """Return a view of the first rows: one number of eight bytes in each row, from the byte ``offset`` on."""
    row_bytes = rows.shape[1]
    return np.ndarray((row_count,), _get_limb_type(is_little), rows, offset, strides=(row_bytes,))


def _get_limb_type(is_little: bool) -> str:
    """Return NumPy's name for a number of eight bytes in little-endian or big-endian order."""
    return "<u8" if is_little else ">u8"


def _read_short_rows(rows: Any, is_little: bool) -> Any:
    """Return rows of fewer than eight bytes as numbers.

    Eight bytes are read for each row. For the last rows, some of them would be outside the array, so these rows are
    copied.
    """
    row_count, row_bytes = rows.shape
    # After these rows, at least eight bytes follow.
    direct_count = max(row_count - _LIMB_BYTES, 0)
    numbers = np.empty(row_count, np.uint64)
    if direct_count:
        numbers[:direct_count] = _view_limb(rows, direct_count, 0, is_little)
    padded_rows = np.zeros((row_count - direct_count, _LIMB_BYTES), np.uint8)
    padded_rows[:, :row_bytes] = rows[direct_count:]
    numbers[direct_count:] = padded_rows.view(_get_limb_type(is_little))[:, 0]
    # The bytes of the next row are the high bytes in little-endian order, otherwise the low bytes.
    if is_little:
        numbers &= bit_mask(8 * row_bytes)
    else:
        numbers >>= np.uint64(8 * (_LIMB_BYTES - row_bytes))
    return numbers


def are_within(bits: Any, check: Check, limit: int) -> Any:
    """Return whether each number is from ``lowest`` to ``limit``. Negative ones are in two's complement."""
    bits_type = bits.dtype.type
    mask = (1 << check.width) - 1
    # Modulo 2**width, the numbers from ``lowest`` to ``limit`` become the numbers from 0 on.
    if check.lowest:
        bits = (bits - bits_type(check.lowest & mask)) & bits_type(mask)
    return bits <= bits_type(limit - check.lowest)


def compute_parity(chunk: Chunk, check: Check) -> Any:
    """Return the parity bit of each frame, of the bits as they were sent, or 0 if the encoder does not send it.

    It is the XOR of the bits in ``parity_of``, inverted if ``odd`` is True.
    """
    if not check.width:
        return np.zeros(len(chunk.limbs[0]), np.uint8)
    fields = [chunk.sent.take(low, width) for low, width in check.parity_of]
    width = max(width for _, width in check.parity_of)
    # The parity of several fields is the parity of their XOR.
    bits = fields[0] if len(fields) == 1 else np.bitwise_xor.reduce([field.astype(np.uint64) for field in fields])
    bits_type = bits.dtype.type
    if check.mask:
        bits = bits & bits_type(check.mask & ((1 << width) - 1))
    parity = _fold_to_one_bit(bits, width)
    return parity ^ bits_type(check.odd)


def _fold_to_one_bit(bits: Any, width: int) -> Any:
    """Return the XOR of the ``width`` bits of each number, by folding their upper half onto their lower half.

    Bits above the width must be 0. An example of width 4: ``1011 -> 10 ^ 11 = 01 -> 0 ^ 1 = 1``.
    """
    bits_type = bits.dtype.type
    # Half of the smallest power of two that is not below the width: 4 for the widths 5 to 8.
    half = (1 << max(width - 1, 0).bit_length()) // 2
    while half:
        bits = bits ^ (bits >> bits_type(half))
        half //= 2
    return bits & bits_type(1)


def compare_crc(chunk: Chunk, crc: CrcOf) -> Any:
    """Return the bits in which each CRC differs from the computed CRC, 0 if it matches."""
    if crc.steps:
        return _fold_crc(chunk.limbs[0], crc, chunk.bits)
    if crc.is_xor:
        return _xor_bytes(chunk, crc.xorout)
    # For other CRCs, each byte of the frame contributes an entry of its table.
    first_table, *other_tables = _make_crc_tables(crc.differs, chunk.bits)
    difference = first_table[chunk.byte(0)]
    for byte_index, table in enumerate(other_tables, 1):
        difference ^= table[chunk.byte(byte_index)]
    return difference


def _xor_bytes(chunk: Chunk, xorout: int) -> Any:
    """Return the XOR of all bytes of each frame, including the CRC, by folding 64 bits to 32, 16 and 8."""
    number = reduce(np.bitwise_xor, chunk.limbs)
    half = (number ^ shift_right(number, 32)).astype(np.uint32)
    half ^= half >> np.uint32(16)
    half ^= half >> np.uint32(8)
    difference = half.astype(np.uint8)
    return difference ^ np.uint8(xorout) if xorout else difference


def _fold_crc(number: Any, crc: CrcOf, bits: int) -> Any:
    """Return the remainders of numbers of ``bits`` bits with their CRC, 0 if it matches.

    A step removes the bits from ``step.shift`` on, and adds them to the lower ones (``step.mask``) twice: from bit 0
    on, and from bit ``step.back`` on. The remainder of the division by the polynomial stays the same. Numbers that fit
    into 32 bits are computed in 32 bits, which takes half the time.
    """
    remainder = number ^ np.uint64(crc.xorout) if crc.xorout else number
    word_type = np.uint64
    remaining_bits = bits
    for step in crc.steps:
        has_bits_to_fold = remaining_bits > step.shift
        if not has_bits_to_fold:
            continue
        high = remainder >> word_type(step.shift)
        remainder = remainder & word_type(step.mask)
        # The width of the remainder: the width of the low bits, or of the folded high bits.
        folded_bits = remaining_bits - step.shift + step.back
        remaining_bits = max(step.shift, folded_bits)
        if word_type is np.uint64 and remaining_bits <= 32:
            word_type = np.uint32
            remainder = remainder.astype(word_type)
            high = high.astype(word_type)
        remainder ^= high
        if step.back:
            high <<= word_type(step.back)
            remainder ^= high
    return remainder


@lru_cache(maxsize=64)
def _make_crc_tables(compute_difference: Callable[[int], int], bits: int) -> tuple[Any, ...]:
    """Return one table per byte of a frame. The XOR of the entries for all bytes is the CRC difference of the frame.

    ``compute_difference`` returns the CRC difference of one frame: its CRC XOR the CRC computed from its other bits.
    Each bit contributes the same difference in every frame, so the differences of bytes can be combined with XOR. The
    difference of the frame 0 is part of every difference, and is included in the first table.
    """
    zero_difference = compute_difference(0)
    tables: list[Any] = []
    for lowest_bit in range(0, bits, 8):
        first_entry = 0 if tables else zero_difference
        table = np.array([first_entry], np.uint64)
        # Each bit doubles the table: its second half has the entries with this bit set.
        for bit in range(lowest_bit, lowest_bit + 8):
            contribution = compute_difference(1 << bit) ^ zero_difference if bit < bits else 0
            table = np.concatenate([table, table ^ np.uint64(contribution)])
        tables.append(table)
    return tuple(tables)
