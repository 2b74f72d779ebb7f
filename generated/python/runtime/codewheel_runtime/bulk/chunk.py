# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames as NumPy arrays of 64-bit numbers: their bits, parities and CRCs."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, reduce
from typing import Any

from ..packages import load
from .shape import Check, CrcOf, Shape

#: NumPy, untyped so that type checkers accept all its versions.
np: Any = load("numpy")


class Chunk:
    """Chunk of frames. Each is a ``bits``-bit number in 64-bit limbs, lowest limb first. Higher bits are 0.

    ``limbs`` is a list of arrays, each with an element for each frame. ``_bytes`` keeps the arrays of single bytes that
    were extracted, by the index of the byte. ``_before_ungray`` is the chunk with Gray code, once it is converted.
    """

    def __init__(self, limbs: list[Any], bits: int) -> None:
        self.limbs = limbs
        self.bits = bits
        self._before_ungray: Chunk | None = None
        self._bytes: dict[int, Any] = {}

    @property
    def sent(self) -> Chunk:
        """Chunk with the bits as they were sent, before any Gray code is converted."""
        # A chunk that stored itself would stay in memory until the next run of the garbage collector.
        return self._before_ungray or self

    def byte(self, index: int) -> Any:
        """Return the eight bits of each frame that start at bit ``8 * place``."""
        if index not in self._bytes:
            limb = self.limbs[index // 8]
            shift = 8 * (index % 8)
            self._bytes[index] = (limb >> np.uint64(shift) if shift else limb).astype(np.uint8)
        return self._bytes[index]

    def small(self, low: int, mask: int) -> Any:
        """Return the bits that start at ``low``, limited to ``mask``. All of them are in one byte."""
        bits = self.byte(low // 8)
        bits = bits >> np.uint8(low % 8) if low % 8 else bits
        return bits if mask == 0xFF >> (low % 8) else bits & np.uint8(mask)

    def take(self, low: int, width: int, out: Any = None) -> Any:
        """Return the ``width`` bits of each frame that start at ``low``.

        With ``out``, an array of 64-bit numbers, they are written there. Without it, the type can be smaller.
        """
        if width == 0 or low % 8 + width <= 8:
            bits = self.small(low, (1 << width) - 1) if width else np.zeros(len(self.limbs[0]), np.uint8)
            return bits if out is None else np.copyto(out, bits)
        limb_index, shift = divmod(low, 64)
        number = np.right_shift(self.limbs[limb_index], np.uint64(shift), out=out)
        # Other bits above the field must be set to 0.
        if shift + width <= 64:
            # Nothing is above the last bits of a limb or of the frame.
            has_bits_above = shift + width not in (64, self.bits - 64 * limb_index)
        else:
            # The field continues in the next limb.
            number |= self.limbs[limb_index + 1] << np.uint64(64 - shift)
            has_bits_above = low + width != self.bits and width != 64
        if has_bits_above:
            number &= np.uint64((1 << width) - 1)
        return number

    def flag(self, low: int, width: int, active: bool, out: Any) -> None:
        """Set ``out`` to True where a bit is 1, or where it is 0 if ``active`` is False. Without a bit, it is False."""
        if not width:
            out[:] = False
            return
        bit = self.byte(low // 8) & np.uint8(1 << (low % 8))
        (np.not_equal if active else np.equal)(bit, 0, out=out)

    def ungray(self, low: int, width: int, excess: int) -> None:
        """Convert the ``width`` bits from ``low`` on from Gray code to binary, minus ``excess``. The others stay."""
        mask = np.uint64(((1 << width) - 1) << low)
        gray = self.limbs[0] & mask
        # Bit n is the XOR of all Gray bits from n on, which doubling shifts collect.
        binary = gray
        shift = 1
        while shift < width:
            binary = binary ^ ((binary >> np.uint64(shift)) & mask)
            shift *= 2
        if excess:
            binary = (binary - np.uint64(excess << low)) & mask
        self._before_ungray = Chunk(self.limbs, self.bits)
        self.limbs = [self.limbs[0] ^ gray ^ binary]
        self._bytes.clear()


def limbs_of(rows: Any, shape: Shape) -> list[Any]:
    """Return rows of bytes as limbs, read eight bytes at a time, the lowest limb first.

    The highest limb also has eight bytes, so that it overlaps the next one. The bytes of that are shifted out.
    """
    rows = np.ascontiguousarray(rows)
    count, length = rows.shape
    is_little = shape.order == "little"
    dtype = "<u8" if is_little else ">u8"
    if length < 8:
        return [_take_from_bytes(rows, dtype, is_little)]
    limbs: list[Any] = []
    for low in range(0, length, 8):
        # Number of bytes of the highest limb that belong to the limb below.
        overlap = max(low + 8 - length, 0)
        first_byte = low - overlap
        # In the other byte order, the lowest byte is the last one of the row.
        offset = first_byte if is_little else length - 8 - first_byte
        # A view: one number of eight bytes in each row, from this offset on.
        limb = np.ndarray((count,), dtype, rows, offset, (length,)).astype(np.uint64)
        if overlap:
            limb >>= np.uint64(8 * overlap)
        limbs.append(limb)
    return limbs


def _take_from_bytes(rows: Any, dtype: str, is_little: bool) -> Any:
    """Return rows of fewer than eight bytes as numbers.

    Eight bytes are read for each row. Those of the last rows would be outside the array, so these rows are copied.
    """
    count, length = rows.shape
    # After these rows, at least eight bytes follow.
    direct_count = max(count - 8, 0)
    limb = np.empty(count, np.uint64)
    if direct_count:
        limb[:direct_count] = np.ndarray((direct_count,), dtype, rows, 0, (length,))
    padded = np.zeros((count - direct_count, 8), np.uint8)
    padded[:, :length] = rows[direct_count:]
    limb[direct_count:] = padded.view(dtype)[:, 0]
    # The bytes of the next row are the high ones in little-endian order, otherwise the low ones.
    if is_little:
        limb &= np.uint64((1 << (8 * length)) - 1)
    else:
        limb >>= np.uint64(8 * (8 - length))
    return limb


def are_within(bits: Any, check: Check, limit: int) -> Any:
    """Return whether each number is from ``lowest`` to ``limit``. Negative ones are in two's complement."""
    bits_type = bits.dtype.type
    mask = (1 << check.width) - 1
    # Modulo 2**width, the numbers from ``lowest`` to ``limit`` become those from 0 on.
    if check.lowest:
        bits = (bits - bits_type(check.lowest & mask)) & bits_type(mask)
    return bits <= bits_type(limit - check.lowest)


def compute_parity(chunk: Chunk, check: Check) -> Any:
    """Return the parity bit of each frame, of the bits as they were sent, or 0 if the encoder does not send it.

    It is the XOR of the bits in ``parity_of``, inverted if ``odd`` is True.
    """
    if not check.width:
        return np.zeros(len(chunk.limbs[0]), np.uint8)
    # The parity of several fields is the parity of their XOR.
    fields = [chunk.sent.take(low, width) for low, width in check.parity_of]
    bits = fields[0]
    if len(fields) > 1:
        bits = np.bitwise_xor.reduce([field.astype(np.uint64) for field in fields])
    width = max(width for _, width in check.parity_of)
    bits_type = bits.dtype.type
    if check.mask:
        bits = bits & bits_type(check.mask & ((1 << width) - 1))
    # Fold the upper half of the bits onto the lower half until one bit is left.
    half = (1 << max(width - 1, 0).bit_length()) // 2
    while half:
        bits = bits ^ (bits >> bits_type(half))
        half //= 2
    return (bits & bits_type(1)) ^ bits_type(check.odd)


def compare_crc(chunk: Chunk, crc: CrcOf) -> Any:
    """Return the bits in which each CRC differs from the computed one, 0 if it matches."""
    if crc.steps:
        return _fold(chunk.limbs[0], crc, chunk.bits)
    if crc.is_xor:
        # The XOR of all bytes, with the CRC among them: 64, 32, 16, then 8 bits.
        number = reduce(np.bitwise_xor, chunk.limbs)
        half = (number ^ (number >> np.uint64(32))).astype(np.uint32)
        half ^= half >> np.uint32(16)
        half ^= half >> np.uint32(8)
        difference = half.astype(np.uint8)
        return difference ^ np.uint8(crc.xorout) if crc.xorout else difference
    # For other CRCs, each byte of the frame contributes an entry of its table.
    tables = _tables_of_folds(crc.differs, chunk.bits)
    difference = tables[0][chunk.byte(0)]
    for index, table in enumerate(tables[1:], 1):
        difference ^= table[chunk.byte(index)]
    return difference


def _fold(number: Any, crc: CrcOf, bits: int) -> Any:
    """Return the remainders of numbers with their CRC, 0 if it matches.

    Each step folds the high bits onto lower ones, in 32 bits as soon as the numbers fit.
    """
    remainder = number ^ np.uint64(crc.xorout) if crc.xorout else number
    word_type = np.uint64
    for step in crc.steps:
        # The number has no bits that this step would fold.
        if bits <= step.shift:
            continue
        high = remainder >> word_type(step.shift)
        remainder = remainder & word_type(step.mask)
        # The width of the remainder: that of the low bits, or of the folded high bits.
        bits = max(step.shift, bits - step.shift + step.back)
        # Operations on 32 bits take half the time.
        if word_type is np.uint64 and bits <= 32:
            remainder = remainder.astype(np.uint32)
            high = high.astype(np.uint32)
            word_type = np.uint32
        remainder ^= high
        if step.back:
            high <<= word_type(step.back)
            remainder ^= high
    return remainder


@lru_cache(maxsize=64)
def _tables_of_folds(differs: Callable[[int], int], bits: int) -> tuple[Any, ...]:
    """Return one table per byte of a number, with the contribution of each value of the byte to the CRC difference.

    The entries of the first table also include the difference of the number 0.
    """
    zero_difference = differs(0)
    tables: list[Any] = []
    for low in range(0, bits, 8):
        table = np.array([zero_difference if low == 0 else 0], np.uint64)
        # Each bit doubles the table: its second half has the entries with this bit set.
        for bit in range(low, low + 8):
            change = differs(1 << bit) ^ zero_difference if bit < bits else 0
            table = np.concatenate([table, table ^ np.uint64(change)])
        tables.append(table)
    return tuple(tables)
