# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes many frames into NumPy arrays. Loaded only by ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache, reduce
from importlib import import_module
from typing import Any, Final, cast

from ..codec import as_bytes, assert_never, whole_number
from ..errors import ErrorKind
from ..reports import Verdict
from .shape import (
    Check,
    Column,
    CrcOf,
    Shape,
    kinds,
    late_fields,
    measured,
    quick_checks,
    scales,
    smallest,
    unused_bits,
    unused_groups,
    width_of,
)
from .table import FrameSource, Table, all_match
from .words import of_floats

#: Number of frames decoded at once: small enough for the cache, large enough to keep the overhead of calls low.
CHUNK: Final = 32_768

#: NumPy, untyped so that type checkers accept all its versions.
np: Any = import_module("numpy")


class Chunk:
    """Chunk of frames. Each is a ``bits``-bit number in 64-bit limbs, lowest limb first. Higher bits are 0."""

    def __init__(self, limbs: list[Any], bits: int) -> None:
        self.limbs, self.bits = limbs, bits
        self._bytes: dict[int, Any] = {}

    def byte(self, place: int) -> Any:
        """Return the eight bits that start at bit ``8 * place``."""
        if place not in self._bytes:
            limb, shift = self.limbs[place // 8], 8 * (place % 8)
            self._bytes[place] = (limb >> np.uint64(shift) if shift else limb).astype(np.uint8)
        return self._bytes[place]

    def small(self, low: int, mask: int) -> Any:
        """Return the bits that start at ``low``, limited to ``mask``. All of them are in one byte."""
        bits = self.byte(low // 8)
        bits = bits >> np.uint8(low % 8) if low % 8 else bits
        return bits if mask == 0xFF >> low % 8 else bits & np.uint8(mask)

    def take(self, low: int, width: int, out: Any = None) -> Any:
        """Return the ``width`` bits that start at ``low``, as 64-bit numbers in ``out`` if it is given."""
        if width == 0 or low % 8 + width <= 8:
            count = len(self.limbs[0])
            bits = self.small(low, (1 << width) - 1) if width else np.zeros(count, np.uint8)
            return bits if out is None else np.copyto(out, bits)
        at, shift = divmod(low, 64)
        whole = shift + width in (64, self.bits - 64 * at)
        number = np.right_shift(self.limbs[at], np.uint64(shift), out=out)
        if shift + width > 64:
            number |= self.limbs[at + 1] << np.uint64(64 - shift)
            whole = low + width == self.bits or width == 64
        if not whole:
            number &= np.uint64((1 << width) - 1)
        return number

    def flag(self, low: int, active: bool, out: Any) -> None:
        """Set ``out`` to True where a bit is 1, or where it is 0 if ``active`` is False."""
        bit = self.byte(low // 8) & np.uint8(1 << low % 8)
        (np.not_equal if active else np.equal)(bit, 0, out=out)

    def ungray(self, low: int, width: int) -> None:
        """Convert bits from Gray code to binary."""
        mask = np.uint64(((1 << width) - 1) << low)
        gray = self.limbs[0] & mask
        binary, shift = gray, 1
        while shift < width:
            binary = binary ^ binary >> np.uint64(shift) & mask
            shift *= 2
        self.limbs = [self.limbs[0] ^ gray ^ binary]
        self._bytes.clear()


def decode_many(frames: object, shape: Shape, encoder: FrameSource | None) -> Table:
    """Decode ``frames`` into columns. For the arguments, see ``decode_many`` of the frame's class."""
    if _is_arrow(frames):
        from .arrow import of_column

        frames = of_column(frames, shape)
    source, wrong_rows = rows_of(frames, shape.length) if shape.length else _words_of(frames, shape.bits)
    count = len(source)
    out = _columns(count, {**kinds(shape), "fault": "u1"})
    fault = out.pop("fault")
    fault[:] = 0
    for start in range(0, count, CHUNK):
        rows = slice(start, start + CHUNK)
        _decode(source[rows], shape, {name: column[rows] for name, column in out.items()}, fault[rows])
    if len(wrong_rows):
        fault[wrong_rows] = ErrorKind.LENGTH
    verdicts = out.pop("verdict", None)
    if verdicts is not None and len(wrong_rows):
        verdicts[wrong_rows] = 0
    parts = {name: (join.name, low, width) for join in shape.joins for name, low, width in late_fields(shape, join)}
    return Table(
        encoder=encoder,
        columns=out,
        fault=fault,
        verdict=verdicts,
        position=shape.position,
        parts=parts,
        tells=shape.tells,
        measured=measured(shape),
        scales=scales(shape),
        frame=shape.frame,
    )


def _is_arrow(frames: object) -> bool:
    """Return whether frames are a column from Arrow, polars, or another library with Arrow's C interface."""
    return hasattr(frames, "__arrow_c_stream__") or hasattr(frames, "__arrow_c_array__")


def _columns(count: int, wanted: Mapping[str, str]) -> dict[str, Any]:
    """Return columns in one block of memory. The system uses larger pages for it than for many small blocks."""
    size = {name: np.dtype(kind).itemsize for name, kind in wanted.items()}
    space = np.empty(count * sum(size.values()), np.uint8)
    columns, start = {}, 0
    for name in sorted(wanted, key=lambda name: -size[name]):
        end = start + count * size[name]
        columns[name], start = space[start:end].view(wanted[name]), end
    return {name: columns[name] for name in wanted}


def rows_of(frames: Any, length: int) -> tuple[Any, Any]:
    """Return frames as rows of bytes, and the indices of those with the wrong length."""
    if isinstance(frames, (list, tuple)):
        rows = [b"" if _is_missing(frame) else as_bytes(frame) for frame in cast(Iterable[Any], frames)]
        wrong_rows = [index for index, row in enumerate(rows) if len(row) != length]
        for index in wrong_rows:
            rows[index] = bytes(length)
        return np.frombuffer(b"".join(rows), np.uint8).reshape(-1, length), np.array(wrong_rows, np.intp)
    if isinstance(frames, np.ndarray) and frames.dtype.kind == "O":
        return rows_of(frames.tolist(), length)
    array: Any = np.frombuffer(frames, np.uint8) if isinstance(frames, (bytes, bytearray, memoryview)) else frames
    if not isinstance(array, np.ndarray) or array.dtype != np.uint8:
        raise TypeError(f"frames must be rows of {length} bytes, got {type(array).__name__} of other items")
    if array.ndim == 1 and len(array) % length == 0:
        array = array.reshape(-1, length)
    if array.ndim != 2 or array.shape[1] != length:
        raise ValueError(f"expected complete frames of {length} bytes, got an array of the shape {array.shape}")
    return array, ()


def _words_of(frames: Any, bits: int) -> tuple[Any, Any]:
    """Return frames as 64-bit numbers, and the indices of those that are longer or missing."""
    if isinstance(frames, (bytes, bytearray, memoryview)):
        data = cast(Any, frames)
        if len(data) % 8:
            raise ValueError(f"expected eight bytes per frame, got {len(data)} bytes")
        return np.frombuffer(frames, "<u8").astype(np.uint64, copy=False), ()
    if isinstance(frames, np.ndarray) and frames.dtype.kind != "O":
        if frames.dtype.kind == "f" and frames.ndim == 1:
            frames = of_floats(frames, bits)
        if frames.dtype.kind not in "ui" or frames.ndim != 1:
            raise TypeError(f"frames must be integers in one dimension, got an array of {frames.dtype} {frames.shape}")
        if isinstance(frames, np.ma.MaskedArray):
            return frames.filled(0).astype(np.uint64, copy=False), np.flatnonzero(np.ma.getmaskarray(frames))
        return frames.astype(np.uint64, copy=False), ()
    if not isinstance(frames, Iterable) or isinstance(frames, str):
        raise TypeError(f"frames must be numbers or packed bytes, got {type(frames).__name__}")
    words: list[int] = []
    for row, frame in enumerate(cast(list[Any], frames), 1):
        # A missing frame is replaced by -1, because both have a length error.
        words.append(-1 if _is_missing(frame) else whole_number(f"the frame in row {row}", frame))
    wrong_rows = [index for index, word in enumerate(words) if not 0 <= word < 1 << 64]
    for index in wrong_rows:
        words[index] = 0
    return np.array(words, np.uint64), np.array(wrong_rows, np.intp)


def _is_missing(frame: object) -> bool:
    """Return True if the frame is None, NaN or ``pandas.NA``."""
    if type(frame) is int or type(frame) is bytes:
        return False
    return frame is None or type(frame).__name__ == "NAType" or (isinstance(frame, float) and frame != frame)


def _decode(source: Any, shape: Shape, out: Mapping[str, Any], fault: Any) -> None:
    """Decode some frames into columns. Frames that fail the quick checks are examined for their errors."""
    limbs, bits, doubts = _limbs(source, shape) if shape.length else [source], shape.bits, []
    if not shape.length and bits < 64 and int(source.max()) >> bits:
        doubts = [source >> np.uint64(bits)]
        limbs = [source & np.uint64((1 << bits) - 1)]
    chunk = Chunk(limbs, bits)
    if shape.crc is not None:
        doubts.append(crc_difference(chunk, shape.crc))
    if shape.gray is not None:
        chunk.ungray(*shape.gray)
    doubts += _doubts(chunk, shape)
    doubtful = [doubt for doubt in doubts if doubt.any()]
    _write(chunk, shape, out)
    if shape.otherwise is not None:
        _judge(shape, out)
    if doubtful:
        where = np.flatnonzero(reduce(np.logical_or, doubtful))
        _write_faults(source.take(where, 0), [limb.take(where) for limb in limbs], where, shape, out, fault)


def _write_faults(source: Any, limbs: list[Any], where: Any, shape: Shape, out: Mapping[str, Any], fault: Any) -> None:
    """Write the errors of the frames with the indexes ``where``. A frame with an error has no usable position."""
    fault[where] = _faults(source, limbs, shape)
    if shape.otherwise is not None:
        verdicts: Any = out["verdict"]
        verdicts *= fault == 0


def _doubts(chunk: Chunk, shape: Shape) -> list[Any]:
    """Return arrays that are nonzero for frames that fail a check other than the CRC."""
    checks = quick_checks(shape)
    doubts: list[Any] = []
    for limb, (mask, value) in zip(chunk.limbs, checks.fixed, strict=False):
        if mask:
            doubts.append(limb & np.uint64(mask) ^ np.uint64(value))
    for place, values in checks.bytes:
        byte = chunk.byte(place)
        doubts.append(~reduce(np.logical_or, (byte == np.uint8(value) for value in values)))
    return [*doubts, *(~_holds(chunk, check) for check in checks.remaining)]


def _faults(source: Any, limbs: list[Any], shape: Shape) -> Any:
    """Return the error of each frame. If there are several, it is the one that ``decode`` checks first."""
    chunk = Chunk(limbs, shape.bits)
    errors = [(ErrorKind.CRC, crc_difference(chunk, shape.crc) != 0)] if shape.crc is not None else []
    if shape.gray is not None:
        chunk.ungray(*shape.gray)
    errors += [(check.fault, np.logical_not(_holds(chunk, check))) for check in shape.checks]
    if not shape.length and shape.bits < 64:
        errors.append((ErrorKind.LENGTH, source >> np.uint64(shape.bits) != 0))
    fault = np.zeros(len(source), np.uint8)
    for kind, where in sorted(errors, key=lambda error: -error[0]):
        fault *= np.logical_not(where)
        fault += where * np.uint8(kind)
    return fault


def _limbs(rows: Any, shape: Shape) -> list[Any]:
    """Return rows of bytes as limbs, read eight bytes at a time. Bytes of a neighbouring limb are shifted out."""
    rows = np.ascontiguousarray(rows)
    count, length = rows.shape
    is_little = shape.order == "little"
    kind = "<u8" if is_little else ">u8"
    if length < 8:
        return [_short(rows, kind, is_little)]
    limbs: list[Any] = []
    for low in range(0, length, 8):
        excess = max(low + 8 - length, 0)
        offset = low - excess if is_little else length - low - 8 + excess
        limb = np.ndarray((count,), kind, rows, offset, (length,)).astype(np.uint64)
        if excess:
            limb >>= np.uint64(8 * excess)
        limbs.append(limb)
    return limbs


def _short(rows: Any, kind: str, is_little: bool) -> Any:
    """Return rows of fewer than eight bytes as numbers. Reads go past the end of all rows except the last eight."""
    count, length = rows.shape
    direct_count = max(count - 8, 0)
    limb = np.empty(count, np.uint64)
    if direct_count:
        limb[:direct_count] = np.ndarray((direct_count,), kind, rows, 0, (length,))
    padded = np.zeros((count - direct_count, 8), np.uint8)
    padded[:, :length] = rows[direct_count:]
    limb[direct_count:] = padded.view(kind)[:, 0]
    if is_little:
        limb &= np.uint64((1 << 8 * length) - 1)
    else:
        limb >>= np.uint64(8 * (8 - length))
    return limb


def _holds(chunk: Chunk, check: Check) -> Any:
    bits = chunk.take(check.low, check.width)
    if check.parity_of:
        return bits == parity_bits(chunk, check)
    if check.limit is not None:
        return within(bits, check, check.limit)
    values = [value for value in check.values if not value >> check.width]
    if len(values) > 16:
        return np.isin(bits, np.array(values, bits.dtype))
    is_allowed = np.zeros(len(bits), bool)
    for value in values:
        is_allowed |= bits == bits.dtype.type(value)
    return is_allowed


def within(bits: Any, check: Check, limit: int) -> Any:
    """Return whether each number is from ``lowest`` to ``limit``. Negative ones are in two's complement."""
    kind, mask = bits.dtype.type, (1 << check.width) - 1
    if check.lowest:
        bits = bits - kind(check.lowest & mask) & kind(mask)
    return bits <= kind(limit - check.lowest)


def parity_bits(chunk: Chunk, check: Check) -> Any:
    """Return the parity bit of each frame."""
    # The parity of several fields is the parity of their XOR.
    fields = [chunk.take(low, width) for low, width in check.parity_of]
    bits = fields[0]
    if len(fields) > 1:
        bits = np.bitwise_xor.reduce([field.astype(np.uint64) for field in fields])
    width = max(width for _, width in check.parity_of)
    kind, shift = bits.dtype.type, 1 << max(width - 1, 0).bit_length() >> 1
    if check.mask:
        bits = bits & kind(check.mask & (1 << width) - 1)
    while shift:
        bits = bits ^ bits >> kind(shift)
        shift >>= 1
    return bits & kind(1) ^ kind(check.odd)


def crc_difference(chunk: Chunk, crc: CrcOf) -> Any:
    """Return the bits in which each CRC differs from the computed one, 0 if it matches."""
    if crc.steps:
        return _folded(chunk.limbs[0], crc, chunk.bits)
    if crc.is_xor:
        number = reduce(np.bitwise_xor, chunk.limbs)
        half = (number ^ number >> np.uint64(32)).astype(np.uint32)
        half ^= half >> np.uint32(16)
        half ^= half >> np.uint32(8)
        difference = half.astype(np.uint8)
        return difference ^ np.uint8(crc.xorout) if crc.xorout else difference
    tables = _tables(crc.differs, chunk.bits)
    difference = tables[0][chunk.byte(0)]
    for place, table in enumerate(tables[1:], 1):
        difference ^= table[chunk.byte(place)]
    return difference


def _folded(number: Any, crc: CrcOf, bits: int) -> Any:
    """Return remainders. Each step folds high bits onto lower ones, in 32 bits as soon as the numbers fit."""
    remainder, word_type = number ^ np.uint64(crc.xorout) if crc.xorout else number, np.uint64
    for step in crc.steps:
        if bits <= step.shift:
            continue
        high = remainder >> word_type(step.shift)
        remainder = remainder & word_type(step.mask)
        bits = max(step.shift, bits - step.shift + step.back)
        if word_type is np.uint64 and bits <= 32:
            remainder, high, word_type = remainder.astype(np.uint32), high.astype(np.uint32), np.uint32
        remainder ^= high
        if step.back:
            high <<= word_type(step.back)
            remainder ^= high
    return remainder


@lru_cache(maxsize=64)
def _tables(differs: Callable[[int], int], bits: int) -> tuple[Any, ...]:
    """Return one table per byte of a number, with the contribution of each value of the byte to the CRC difference.

    The entries of the first table also include the difference of the number 0.
    """
    zero_difference = differs(0)
    tables: list[Any] = []
    for low in range(0, bits, 8):
        table = np.array([zero_difference if low == 0 else 0], np.uint64)
        for place in range(low, low + 8):
            change = differs(1 << place) ^ zero_difference if place < bits else 0
            table = np.concatenate([table, table ^ np.uint64(change)])
        tables.append(table)
    return tuple(tables)


def _write(chunk: Chunk, shape: Shape, out: Mapping[str, Any]) -> None:
    """Write the columns of the fields, of the joined numbers and of unused bits."""
    by_name = {column.name: column for column in shape.columns}
    for column in shape.columns:
        if column.name in out or column.runs:
            _write_column(chunk, column, out)
    for join in shape.joins:
        fields = [(by_name[name], low) for name, low in join.fields]
        low, number = fields[0][0].low, out[join.name].view(np.uint64)
        if all(column.low == low + place for column, place in fields):
            chunk.take(low, width_of(shape, join), number)
            continue
        chunk.take(low, fields[0][0].width, number)
        for column, place in fields[1:]:
            part = chunk.take(column.low, column.width).astype(np.uint64, copy=False)
            number |= part << np.uint64(place)
    if shape.unused:
        _write_unused(chunk, shape, out["unused"])


def _write_unused(chunk: Chunk, shape: Shape, out: Any) -> None:
    """Write the unused bits that differ from the manual, in as few bytes as possible."""
    kind = np.dtype(smallest(unused_bits(shape))).type
    number = kind(0)
    for low, mask, value, place in unused_groups(shape):
        width = mask.bit_length()
        small = low % 8 + width <= 8
        turned = chunk.small(low, mask) if small else chunk.take(low, width) & np.uint64(mask)
        if value:
            turned = turned ^ turned.dtype.type(value)
        turned = turned.astype(kind, copy=False)
        number = number | (turned << kind(place) if place else turned)
    out[:] = number


def _write_column(chunk: Chunk, column: Column, out: Mapping[str, Any]) -> None:
    match column.kind:
        case "flag" | "not_flag":
            chunk.flag(column.low, column.kind == "flag", out[column.name])
        case "choice":
            out[column.name][:] = chunk.take(column.low, column.width)
        case "digits":
            bits = chunk.take(column.low, column.width).astype(np.uint64, copy=False)
            for name, divisor, modulus in column.runs:
                out[name][:] = bits // np.uint64(divisor) % np.uint64(modulus)
        case "text":
            out[column.name][:] = _text(chunk, column)
        case "number":
            number = out[column.name].view(np.uint64)
            chunk.take(column.low, column.width, number)
            if column.zero_means:
                number[number == 0] = column.zero_means
        case "signed":
            number = out[column.name].view(np.uint64)
            chunk.take(column.low, column.width, number)
            if column.width:
                top = np.uint64(1 << column.width - 1)
                number ^= top
                number -= top
        case _:
            assert_never(column.kind)


def _text(chunk: Chunk, column: Column) -> Any:
    """Return the strings of a field, whose first character is the most significant."""
    length = column.width // 8
    rows = np.empty((len(chunk.limbs[0]), length), np.uint8)
    for place in range(length):
        rows[:, place] = chunk.take(column.low + 8 * (length - 1 - place), 8)
    return rows.view(f"S{length}")[:, 0]


def _judge(shape: Shape, out: Mapping[str, Any]) -> None:
    """Write the verdict on the position of each valid frame.

    The computation has no branches, so the time does not depend on the frames.
    """
    otherwise, verdicts = VERDICTS.index(shape.otherwise), out["verdict"]
    unused: Any = out.get("unused")
    any_unused_differs = bool(shape.unused) and unused.any()
    speaking: dict[Verdict, list[Any]] = {}
    for condition in shape.speaks:
        if condition.when:
            where = all_match(out, condition.when)
        elif condition.flag:
            where = out[condition.flag]
            for name in condition.unless:
                where = np.greater(where, out[name])
        elif any_unused_differs:
            where = unused & unused.dtype.type(condition.mask & (1 << 8 * unused.itemsize) - 1) != 0
        else:
            continue
        speaking.setdefault(condition.verdict, []).append(where)
    verdicts[:] = otherwise
    if Verdict.USABLE_WITH_WARNING in speaking:
        less = np.uint8((otherwise - VERDICTS.index(Verdict.USABLE_WITH_WARNING)) % 256)
        verdicts -= reduce(np.logical_or, speaking[Verdict.USABLE_WITH_WARNING]).view(np.uint8) * less
    if Verdict.NOT_USABLE in speaking:
        verdicts *= np.logical_not(reduce(np.logical_or, speaking[Verdict.NOT_USABLE])).view(np.uint8)


#: Verdicts in the order of their numbers in a column. The worst is 0.
VERDICTS: Final[list[Verdict | None]] = [*Verdict]
