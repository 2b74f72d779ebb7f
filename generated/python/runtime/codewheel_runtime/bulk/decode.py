# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes many frames into NumPy arrays. Loaded only by ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from typing import Any, Final, NamedTuple, cast

from ..codec import as_bytes, assert_never, whole_number
from ..errors import ErrorKind
from ..reports import Verdict
from .chunk import Chunk, are_within, bit_mask, compare_crc, compute_parity, limbs_of, np, shift_left, shift_right
from .shape import (
    Check,
    Column,
    Join,
    Shape,
    choose_smallest_type,
    count_unused_bits,
    find_deferred_fields,
    find_position_columns,
    find_quick_checks,
    find_scales,
    find_width,
    group_unused_bits,
    list_column_types,
)
from .table import FrameSource, Table, all_match
from .words import read_floats

#: Number of frames decoded at once: small enough for the cache, large enough to keep the overhead of calls low.
CHUNK: Final = 32_768
#: Number of values above which a search is faster than comparisons.
_MANY_VALUES: Final = 16


def decode_many(frames: object, shape: Shape, encoder: FrameSource | None) -> Table:
    """Decode ``frames`` into columns, ``CHUNK`` frames at a time.

    A frame with a wrong length gets the error LENGTH, and meaningless values. For the arguments, see ``decode_many`` of
    the frame's class.
    """
    if _is_arrow(frames):
        from .arrow import read_column

        frames = read_column(frames, shape)
    source, wrong_rows = read_rows(frames, shape.length) if shape.length else _read_words(frames, shape.bits)
    count = len(source)
    out = _allocate_columns(count, {**list_column_types(shape), "fault": "u1"})
    fault = out.pop("fault")
    fault[:] = 0
    for start in range(0, count, CHUNK):
        rows = slice(start, start + CHUNK)
        _decode(source[rows], shape, {name: column[rows] for name, column in out.items()}, fault[rows])
    if len(wrong_rows):
        fault[wrong_rows] = ErrorKind.LENGTH
    verdicts = out.pop("verdict", None)
    if verdicts is not None and len(wrong_rows):
        # The verdict "not usable".
        verdicts[wrong_rows] = 0
    # Fields of joined numbers: the name of the number, the lowest bit in it, and the width.
    parts: dict[str, tuple[str, int, int]] = {}
    for join in shape.joins:
        parts |= {name: (join.name, low, width) for name, low, width in find_deferred_fields(shape, join)}
    return Table(
        encoder=encoder,
        columns=out,
        fault=fault,
        verdict=verdicts,
        position=shape.position,
        parts=parts,
        report_causes=shape.report_causes,
        position_columns=find_position_columns(shape),
        scales=find_scales(shape),
        frame=shape.frame,
    )


def _is_arrow(frames: object) -> bool:
    """Return whether frames are a column from Arrow, polars, or another library with Arrow's C interface."""
    return hasattr(frames, "__arrow_c_stream__") or hasattr(frames, "__arrow_c_array__")


def _allocate_columns(count: int, wanted: Mapping[str, str]) -> dict[str, Any]:
    """Return columns of ``count`` rows in one block of memory, in the order of ``wanted``: NumPy types by name.

    The system uses larger pages for one block than for many small ones.
    """
    size = {name: np.dtype(dtype).itemsize for name, dtype in wanted.items()}
    space = np.empty(count * sum(size.values()), np.uint8)
    columns = {}
    start = 0
    # The largest types come first, to align the columns of numbers.
    for name in sorted(wanted, key=lambda name: -size[name]):
        end = start + count * size[name]
        columns[name] = space[start:end].view(wanted[name])
        start = end
    return {name: columns[name] for name in wanted}


class ReadFrames(NamedTuple):
    """Frames as an array of rows of bytes or of 64-bit numbers, and the indices of frames with a wrong length.

    Zeros replace frames with a wrong length.
    """

    frames: Any
    wrong_rows: Any


def read_rows(frames: Any, length: int) -> ReadFrames:
    """Return frames as rows of bytes.

    A missing frame counts as one of 0 bytes, as does a row of an array with masked bytes. Arrays and buffers have
    frames of one length only.

    Raises:
        TypeError: The frames are not bytes.
        ValueError: An array or a buffer does not have complete frames of this length.
    """
    if isinstance(frames, (list, tuple)):
        return _read_list_of_rows(cast(Iterable[Any], frames), length)
    if isinstance(frames, np.ndarray) and frames.dtype.kind == "O":
        return read_rows(frames.tolist(), length)
    array: Any = np.frombuffer(frames, np.uint8) if isinstance(frames, (bytes, bytearray)) else frames
    if isinstance(frames, memoryview):
        array = np.asarray(frames)
    if not isinstance(array, np.ndarray) or array.dtype != np.uint8:
        raise TypeError(f"frames must be rows of {length} bytes, got {type(array).__name__} of other items")
    if array.ndim == 1 and len(array) % length == 0:
        array = array.reshape(-1, length)
    if array.ndim != 2 or array.shape[1] != length:
        raise ValueError(f"expected complete frames of {length} bytes, got an array of the shape {array.shape}")
    if isinstance(array, np.ma.MaskedArray):
        has_masked_bytes = np.ma.getmaskarray(array).any(axis=1)
        return ReadFrames(array.filled(0), np.flatnonzero(has_masked_bytes))
    return ReadFrames(array, wrong_rows=())


def _read_list_of_rows(frames: Iterable[Any], length: int) -> ReadFrames:
    """Return a list of byte strings as rows of bytes. The strings can have different lengths."""
    rows: list[bytes] = []
    wrong_rows: list[int] = []
    for index, frame in enumerate(frames):
        row = b"" if _is_missing(frame) else as_bytes(frame)
        if len(row) != length:
            wrong_rows.append(index)
            row = bytes(length)
        rows.append(row)
    array = np.frombuffer(b"".join(rows), np.uint8).reshape(-1, length)
    return ReadFrames(array, np.array(wrong_rows, np.intp))


def _read_words(frames: Any, bits: int) -> ReadFrames:
    """Return frames as 64-bit numbers. A missing frame is listed as one of the wrong length.

    A buffer of bytes has eight bytes per frame, least significant first. A buffer of other items is an array. ``bits``
    is the length of a frame.

    Raises:
        TypeError: The frames are not integers or a buffer.
        ValueError: The length of a buffer is not a multiple of eight bytes.
    """
    if isinstance(frames, memoryview):
        frames = as_bytes(cast(Any, frames)) if frames.itemsize == 1 else np.asarray(frames)
    if isinstance(frames, (bytes, bytearray)):
        if len(frames) % 8:
            raise ValueError(f"expected eight bytes per frame, got {len(frames)} bytes")
        return ReadFrames(np.frombuffer(frames, "<u8").astype(np.uint64, copy=False), wrong_rows=())
    if isinstance(frames, np.ndarray):
        array: Any = frames
        # As a list, masked items are None.
        return _read_words(array.tolist(), bits) if array.dtype.kind == "O" else _read_array_of_words(array, bits)
    if not isinstance(frames, Iterable) or isinstance(frames, str):
        raise TypeError(f"frames must be numbers or packed bytes, got {type(frames).__name__}")
    return _read_list_of_words(cast(list[Any], frames))


def _read_array_of_words(frames: Any, bits: int) -> ReadFrames:
    """Return an array of integers, or of floating-point numbers without fractions, as 64-bit numbers.

    Masked frames and negative ones have a wrong length. Raises TypeError for other arrays.
    """
    if frames.dtype.kind == "f" and frames.ndim == 1:
        frames = read_floats(frames, bits)
    if frames.dtype.kind not in "ui" or frames.ndim != 1:
        raise TypeError(f"frames must be integers in one dimension, got an array of {frames.dtype} {frames.shape}")
    is_wrong = np.ma.getmaskarray(frames)
    numbers = np.ma.getdata(frames)
    if numbers.dtype.kind == "i":
        is_wrong = is_wrong | (numbers < 0)
    words = numbers.astype(np.uint64, copy=False)
    wrong_rows = np.flatnonzero(is_wrong)
    if len(wrong_rows):
        words = np.where(is_wrong, np.uint64(0), words)
    return ReadFrames(words, wrong_rows)


def _read_list_of_words(frames: Iterable[Any]) -> ReadFrames:
    """Return a list of numbers as 64-bit numbers. Negative and longer ones have a wrong length.

    Raises TypeError for items that are neither integers nor missing.
    """
    words: list[int] = []
    wrong_rows: list[int] = []
    for index, frame in enumerate(frames):
        is_missing = _is_missing(frame)
        word = 0 if is_missing else whole_number(f"the frame at index {index}", frame)
        if is_missing or not 0 <= word < 1 << 64:
            wrong_rows.append(index)
            word = 0
        words.append(word)
    return ReadFrames(np.array(words, np.uint64), np.array(wrong_rows, np.intp))


def _is_missing(frame: object) -> bool:
    """Return True if the frame is None, NaN or ``pandas.NA``."""
    # This is a fast path for the usual types.
    if type(frame) is int or type(frame) is bytes:
        return False
    # Only NaN differs from itself.
    is_nan = isinstance(frame, float) and frame != frame
    return frame is None or is_nan or type(frame).__name__ == "NAType"


def _decode(source: Any, shape: Shape, out: Mapping[str, Any], fault: Any) -> None:
    """Decode some frames into the columns ``out``, and their errors into ``fault``.

    Frames that fail a quick check are examined for their errors. All frames are written, including frames with an
    error.
    """
    # Arrays that are nonzero for frames that fail a check.
    doubts: list[Any] = []
    if shape.length:
        limbs = limbs_of(source, shape)
    else:
        limbs = [source]
        has_long_words = shape.bits < 64 and int(source.max()) >> shape.bits
        if has_long_words:
            doubts.append(shift_right(source, shape.bits))
            limbs = [source & bit_mask(shape.bits)]
    chunk = Chunk(limbs, shape.bits)
    if shape.crc is not None:
        doubts.append(compare_crc(chunk, shape.crc))
    chunk.convert(shape)
    doubts += _find_doubtful_frames(chunk, shape)
    doubtful = [doubt for doubt in doubts if doubt.any()]
    _write(chunk, shape, out)
    if shape.default_verdict is not None:
        _judge(shape, out)
    if not doubtful:
        return
    doubtful_rows = np.flatnonzero(reduce(np.logical_or, doubtful))
    doubtful_limbs = [limb.take(doubtful_rows) for limb in limbs]
    fault[doubtful_rows] = _find_faults(source.take(doubtful_rows, axis=0), doubtful_limbs, shape)
    if shape.default_verdict is not None:
        # A frame with an error gets verdict 0, so its position is not usable. True and False multiply by 1 and 0.
        verdicts: Any = out["verdict"]
        verdicts *= fault == 0


def _find_doubtful_frames(chunk: Chunk, shape: Shape) -> list[Any]:
    """Return arrays that are nonzero for frames that fail a check other than the CRC: one array for each check."""
    checks = find_quick_checks(shape)
    failures: list[Any] = []
    for limb, (mask, value) in zip(chunk.limbs, checks.fixed, strict=False):
        if mask:
            failures.append((limb & np.uint64(mask)) ^ np.uint64(value))
    for index, allowed_values in checks.bytes:
        byte = chunk.byte(index)
        is_allowed = reduce(np.logical_or, (byte == np.uint8(value) for value in allowed_values))
        failures.append(~is_allowed)
    for check in checks.remaining:
        failures.append(~_is_met(chunk, check))
    return failures


def _find_faults(source: Any, limbs: list[Any], shape: Shape) -> Any:
    """Return the error of each frame, or 0. If there are several errors, it is the first that ``decode`` checks.

    This is the one with the lowest ``ErrorKind``, because ``decode`` checks in the order of these numbers. ``limbs``
    are the frames as numbers. In ``source``, which are the frames as they were passed, bits above the frame are still
    set.
    """
    chunk = Chunk(limbs, shape.bits)
    # Each kind of error, with an array that is True for the frames with this error.
    errors: list[tuple[ErrorKind, Any]] = []
    if shape.crc is not None:
        errors.append((ErrorKind.CRC, compare_crc(chunk, shape.crc) != 0))
    chunk.convert(shape)
    errors += [(check.fault, np.logical_not(_is_met(chunk, check))) for check in shape.checks]
    if not shape.length and shape.bits < 64:
        errors.append((ErrorKind.LENGTH, shift_right(source, shape.bits) != 0))
    faults = np.zeros(len(source), np.uint8)
    # The highest kind comes first, so that lower kinds replace it.
    for error_kind, has_error in sorted(errors, key=lambda error: -error[0]):
        # In the frames with this error, its number replaces an earlier one.
        faults *= np.logical_not(has_error)
        faults += has_error * np.uint8(error_kind)
    return faults


def _is_met(chunk: Chunk, check: Check) -> Any:
    """Return for each frame whether its bits meet a check."""
    bits = chunk.take(check.low, check.width)
    if check.parity_of:
        return bits == compute_parity(chunk, check)
    if check.limit is not None:
        return are_within(bits, check, check.limit)
    # A value that needs more bits than the field never occurs in it.
    values = [value for value in check.values if not value >> check.width]
    # For many values, a search takes less time than one comparison for each.
    if len(values) > _MANY_VALUES:
        return np.isin(bits, np.array(values, bits.dtype))
    is_allowed = np.zeros(len(bits), bool)
    for value in values:
        is_allowed |= bits == bits.dtype.type(value)
    return is_allowed


def _write(chunk: Chunk, shape: Shape, out: Mapping[str, Any]) -> None:
    """Write the columns of the fields, of the joined numbers and of unused bits into ``out``, by name."""
    columns_by_name = {column.name: column for column in shape.columns}
    # Fields that are extracted from a joined number on access are not in ``out``. The columns of digits have separate
    # names.
    for column in shape.columns:
        if column.name in out or column.runs:
            _write_column(chunk, column, out)
    for join in shape.joins:
        _write_join(chunk, shape, join, columns_by_name, out[join.name].view(np.uint64))
    if shape.unused:
        _write_unused(chunk, shape, out["unused"])


def _write_join(chunk: Chunk, shape: Shape, join: Join, columns: Mapping[str, Column], number: Any) -> None:
    """Write a number that consists of several fields into the array ``number``.

    The first field provides its lowest bits.

    ``columns`` contains the descriptions of all fields by name. ``low`` is a position in the frame, and ``offset`` a
    position in the joined number.
    """
    first_name, _ = join.fields[0]
    first = columns[first_name]
    are_adjacent = all(columns[name].low == first.low + offset for name, offset in join.fields)
    if are_adjacent:
        # The fields have the same order in the frame, so they are one number there.
        chunk.take(first.low, find_width(shape, join), out=number)
        return
    chunk.take(first.low, first.width, out=number)
    for name, offset in join.fields[1:]:
        column = columns[name]
        part = chunk.take(column.low, column.width).astype(np.uint64, copy=False)
        number |= shift_left(part, offset)


def _write_unused(chunk: Chunk, shape: Shape, out: Any) -> None:
    """Write the unused bits into ``out``: 1 where they differ from the manual.

    Groups of bits are moved from ``low`` in the frame to ``place`` in ``out``, in as few bytes as possible.
    """
    bits_type = np.dtype(choose_smallest_type(count_unused_bits(shape))).type
    number = bits_type(0)
    for group in group_unused_bits(shape):
        width = group.mask.bit_length()
        is_in_one_byte = group.low % 8 + width <= 8
        if is_in_one_byte:
            differing = chunk.small(group.low, group.mask)
        else:
            differing = chunk.take(group.low, width) & np.uint64(group.mask)
        if group.value:
            differing = differing ^ differing.dtype.type(group.value)
        differing = differing.astype(bits_type, copy=False)
        if group.place:
            differing = differing << bits_type(group.place)
        number = number | differing
    out[:] = number


def _write_column(chunk: Chunk, column: Column, out: Mapping[str, Any]) -> None:
    """Write the values of a field to its columns."""
    match column.kind:
        case "flag" | "not_flag":
            is_active_high = column.kind == "flag"
            chunk.flag(column.low, column.width, active=is_active_high, out=out[column.name])
        case "choice":
            out[column.name][:] = chunk.take(column.low, column.width)
        case "digits":
            bits = chunk.take(column.low, column.width).astype(np.uint64, copy=False)
            for name, divisor, modulus in column.runs:
                shifted_digits = bits // np.uint64(divisor)
                out[name][:] = shifted_digits % np.uint64(modulus)
        case "text":
            out[column.name][:] = _read_text(chunk, column)
        case "number":
            number = out[column.name].view(np.uint64)
            chunk.take(column.low, column.width, out=number)
            if column.zero_means:
                number[number == 0] = column.zero_means
        case "signed":
            number = out[column.name].view(np.uint64)
            chunk.take(column.low, column.width, out=number)
            if column.width:
                # In two's complement, (n ^ sign_bit) - sign_bit extends the sign to 64 bits.
                sign_bit = np.uint64(1 << (column.width - 1))
                number ^= sign_bit
                number -= sign_bit
        case _:
            assert_never(column.kind)


def _read_text(chunk: Chunk, column: Column) -> Any:
    """Return the strings of a field as bytes. The first character is the most significant."""
    length = column.width // 8
    rows = np.empty((len(chunk.limbs[0]), length), np.uint8)
    for index in range(length):
        following_characters = length - 1 - index
        rows[:, index] = chunk.take(column.low + 8 * following_characters, width=8)
    return rows.view(f"S{length}")[:, 0]


def _judge(shape: Shape, out: Mapping[str, Any]) -> None:
    """Write the verdict on the position of each frame, as the index in ``VERDICTS``, as if it had no error.

    It is NOT_USABLE if any of the conditions for this is met. Otherwise it is USABLE_WITH_WARNING if any of those is
    met, unless the default is UNKNOWN. Otherwise it is the default. The computation has no branches, so the time does
    not depend on the frames.
    """
    default = VERDICTS.index(shape.default_verdict)
    verdicts = out["verdict"]
    verdicts[:] = default
    if not shape.verdict_causes:
        return
    active_by_verdict = _find_active_conditions(shape, out)
    warnings = active_by_verdict.get(Verdict.USABLE_WITH_WARNING)
    # A warning cannot improve an unknown verdict.
    if warnings and shape.default_verdict is not Verdict.UNKNOWN:
        # Subtracting this from the default yields the verdict of a warning.
        decrease = np.uint8((default - VERDICTS.index(Verdict.USABLE_WITH_WARNING)) % 256)
        has_warning = reduce(np.logical_or, warnings)
        verdicts -= has_warning.view(np.uint8) * decrease
    errors = active_by_verdict.get(Verdict.NOT_USABLE)
    if errors:
        # NOT_USABLE has the index 0.
        is_usable = np.logical_not(reduce(np.logical_or, errors))
        verdicts *= is_usable.view(np.uint8)


def _find_active_conditions(shape: Shape, out: Mapping[str, Any]) -> dict[Verdict, list[Any]]:
    """Return the conditions of each verdict: one array each, True for the frames that meet it.

    ``out`` contains the decoded columns. The conditions on unused bits are left out if none of these bits differs from
    the manual.
    """
    # Each bit of this column is 1 where an unused bit differs from the manual.
    unused: Any = out.get("unused")
    any_unused_differs = bool(shape.unused) and unused.any()
    active_by_verdict: dict[Verdict, list[Any]] = {}
    for condition in shape.verdict_causes:
        if condition.when:
            is_active = all_match(out, condition.when)
        elif condition.flag:
            is_active = out[condition.flag]
            for name in condition.unless:
                # For two bools, "greater" means True and False: the flag is active, and the other one is not.
                is_active = np.greater(is_active, out[name])
        elif any_unused_differs:
            # NumPy requires that the mask fits the type of the column. Bits above that do not occur.
            column_bits = 8 * unused.itemsize
            possible_mask = condition.mask & ((1 << column_bits) - 1)
            is_active = (unused & unused.dtype.type(possible_mask)) != 0
        else:
            continue
        active_by_verdict.setdefault(condition.verdict, []).append(is_active)
    return active_by_verdict


#: Verdicts in the order of their numbers in a column. The worst is 0.
VERDICTS: Final[list[Verdict | None]] = [*Verdict]
