# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes many frames into NumPy arrays. Loaded only by ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from typing import Any, Final

from ..codec import assert_never
from ..errors import ErrorKind
from ..reports import Verdict
from .chunk import (
    Chunk,
    are_within_limits,
    bit_mask,
    compute_parity,
    find_crc_difference,
    np,
    shift_left,
    shift_right,
    split_into_words,
    take_checked_bits,
)
from .frame_rows import is_arrow, read_rows, read_words
from .quick_checks import find_quick_checks
from .shape import (
    Check,
    Column,
    Join,
    Shape,
    all_match,
    choose_smallest_type,
    count_unused_bits,
    find_deferred_fields,
    find_position_columns,
    find_scales,
    find_width,
    group_unused_bits,
    list_column_types,
)
from .table import FrameSource, Table

#: Number of frames decoded at once: small enough for the cache, large enough to keep the overhead of calls low.
CHUNK: Final = 32_768
#: Number of allowed values above which a search takes less time than a comparison with each of them.
_MANY_VALUES: Final = 16
#: Verdicts in the order of their numbers in a column. The worst is 0.
VERDICTS: Final[list[Verdict | None]] = [*Verdict]


def decode_many(frames: object, shape: Shape, encoder: FrameSource | None) -> Table:
    """Decode many frames into a table that has an array for each field, and the error of each frame.

    A frame of the wrong length has a length error, and its values have no meaning.

    Args:
        frames: Frames as an array, a buffer, a list or an Arrow column. They are rows of bytes, or numbers if a frame
            is a string of bits.
        shape: Description of the frames.
        encoder: Encoder of the frames, for the units of the table, or None if it is not known.
    """
    if is_arrow(frames):
        from .arrow import read_column

        frames = read_column(frames, shape)
    # Frames of the wrong length have been replaced by zeros. Their rows are in ``wrong_rows``.
    frames_read, wrong_rows = read_rows(frames, shape.length) if shape.length else read_words(frames, shape.bits)
    count = len(frames_read)
    columns = _allocate_columns(count, {**list_column_types(shape), "fault": "u1"})
    faults = columns.pop("fault")
    _decode_by_chunks(frames_read, shape, columns, faults)
    verdicts = columns.pop("verdict", None)
    if len(wrong_rows):
        faults[wrong_rows] = ErrorKind.LENGTH
        if verdicts is not None:
            verdicts[wrong_rows] = VERDICTS.index(Verdict.NOT_USABLE)
    return Table(
        encoder=encoder,
        columns=columns,
        fault=faults,
        verdict=verdicts,
        position=shape.position,
        parts=_find_parts_of_joined_numbers(shape),
        report_causes=shape.report_causes,
        position_columns=find_position_columns(shape),
        scales=find_scales(shape),
        frame=shape.frame,
    )


def _decode_by_chunks(frames: Any, shape: Shape, columns: Mapping[str, Any], faults: Any) -> None:
    """Decode the frames into ``columns`` and ``faults``, whose arrays have an element for each frame."""
    faults[:] = 0
    for start in range(0, len(frames), CHUNK):
        rows = slice(start, start + CHUNK)
        columns_of_chunk = {name: column[rows] for name, column in columns.items()}
        _decode_chunk(frames[rows], shape, columns_of_chunk, faults[rows])


def _find_parts_of_joined_numbers(shape: Shape) -> dict[str, tuple[str, int, int]]:
    """Return the fields that a table extracts from a joined number on access.

    For each field by name, these are the joined number, the lowest bit in it, and the width.
    """
    parts: dict[str, tuple[str, int, int]] = {}
    for join in shape.joins:
        for field_name, low, width in find_deferred_fields(shape, join):
            parts[field_name] = (join.name, low, width)
    return parts


def _allocate_columns(count: int, types: Mapping[str, str]) -> dict[str, Any]:
    """Return uninitialized columns of ``count`` rows by name, in one block of memory.

    ``types`` contains the NumPy type of each column by name, and determines their order. The system uses larger pages
    for one block than for many small ones.
    """
    item_sizes = {name: np.dtype(type_name).itemsize for name, type_name in types.items()}
    block = np.empty(count * sum(item_sizes.values()), np.uint8)
    columns = {}
    start = 0
    # The largest types come first, to align the columns of numbers.
    for name in sorted(types, key=lambda name: -item_sizes[name]):
        end = start + count * item_sizes[name]
        columns[name] = block[start:end].view(types[name])
        start = end
    return {name: columns[name] for name in types}


def _decode_chunk(frames: Any, shape: Shape, columns: Mapping[str, Any], faults: Any) -> None:
    """Decode some frames: write their values into ``columns`` and their errors into ``faults``.

    Quick checks first find the frames that have any error. Only these frames are then examined for the kind of their
    error. Values are written for all frames, including frames with an error.
    """
    # Each array is nonzero for the frames that fail one check.
    failures: list[Any] = []
    if shape.length:
        words = split_into_words(frames, shape)
    else:
        words = [frames]
        has_too_long_frames = shape.bits < 64 and int(frames.max()) >> shape.bits
        if has_too_long_frames:
            failures.append(shift_right(frames, shape.bits))
            words = [frames & bit_mask(shape.bits)]
    chunk = Chunk(words, shape.bits)
    if shape.crc is not None:
        failures.append(find_crc_difference(chunk, shape.crc))
    chunk.convert_to_binary(shape)
    failures += _run_quick_checks(chunk, shape)
    failures = [failure for failure in failures if failure.any()]
    _write_columns(chunk, shape, columns)
    if shape.default_verdict is not None:
        _write_verdicts(shape, columns)
    if not failures:
        return
    failed_rows = np.flatnonzero(reduce(np.logical_or, failures))
    words_of_failed = [word.take(failed_rows) for word in words]
    faults[failed_rows] = _find_faults(frames.take(failed_rows, axis=0), words_of_failed, shape)
    if shape.default_verdict is not None:
        _set_where(faults != 0, VERDICTS.index(Verdict.NOT_USABLE), out=columns["verdict"])


def _set_where(condition: Any, value: int, out: Any) -> None:
    """Set the elements of ``out``, an array of bytes, to ``value`` where ``condition`` is True.

    Arithmetic with 0 and 1 takes the same time for any condition. An assignment with a mask takes much longer if True
    and False alternate at random.
    """
    out *= np.logical_not(condition).view(np.uint8)
    if value:
        out += condition.view(np.uint8) * np.uint8(value)


def _run_quick_checks(chunk: Chunk, shape: Shape) -> list[Any]:
    """Return an array for each check except the CRC. It is nonzero for the frames that fail the check."""
    checks = find_quick_checks(shape)
    failures: list[Any] = []
    for word, (mask, required_bits) in zip(chunk.words, checks.fixed, strict=False):
        if mask:
            failures.append((word & np.uint64(mask)) ^ np.uint64(required_bits))
    for index, allowed_values in checks.bytes:
        byte = chunk.byte(index)
        is_allowed = reduce(np.logical_or, (byte == np.uint8(value) for value in allowed_values))
        failures.append(~is_allowed)
    for check in checks.remaining:
        failures.append(~_pass_check(chunk, check))
    return failures


def _find_faults(frames: Any, words: list[Any], shape: Shape) -> Any:
    """Return the error of each frame as the number of its ``ErrorKind``, or 0 for a valid frame.

    If a frame has several errors, the lowest number counts, because ``decode`` checks in the order of these numbers.
    ``words`` are the frames as 64-bit words, limited to the bits of the frame. ``frames`` are the frames as they were
    passed. The extra bits of a frame that is too long are still set in them.
    """
    chunk = Chunk(words, shape.bits)
    is_made_of_bytes = shape.length > 0
    # Each kind of error, with an array that is True for the frames with this error.
    errors: list[tuple[ErrorKind, Any]] = []
    if shape.crc is not None:
        errors.append((ErrorKind.CRC, find_crc_difference(chunk, shape.crc) != 0))
    # The CRC covers the bits as they are sent. Other checks need binary numbers instead of Gray code.
    chunk.convert_to_binary(shape)
    errors += [(check.fault, np.logical_not(_pass_check(chunk, check))) for check in shape.checks]
    if not is_made_of_bytes and shape.bits < 64:
        errors.append((ErrorKind.LENGTH, shift_right(frames, shape.bits) != 0))
    faults = np.zeros(len(frames), np.uint8)
    # The highest kind comes first, so that lower kinds replace it.
    highest_kind_first = sorted(errors, key=lambda error: -error[0])
    for error_kind, has_error in highest_kind_first:
        _set_where(has_error, error_kind, out=faults)
    return faults


def _pass_check(chunk: Chunk, check: Check) -> Any:
    """Return an array that is True for each frame that passes a check of its parity, limits or allowed values."""
    bits = take_checked_bits(chunk, check)
    if check.parity_of:
        return bits == compute_parity(chunk, check)
    if check.limit is not None:
        return are_within_limits(bits, check, check.limit)
    # A value that needs more bits than the field never occurs in it.
    possible_values = [value for value in check.values if not (value >> check.width)]
    if len(possible_values) > _MANY_VALUES:
        return np.isin(bits, np.array(possible_values, bits.dtype))
    # A few comparisons are faster than a search. They are fastest if both sides have the same NumPy type.
    bits_type = bits.dtype.type
    is_allowed = np.zeros(len(bits), bool)
    for value in possible_values:
        is_allowed |= bits == bits_type(value)
    return is_allowed


def _write_columns(chunk: Chunk, shape: Shape, columns: Mapping[str, Any]) -> None:
    """Write the values of fields, joined numbers and unused bits into ``columns``, which are arrays by name."""
    fields_by_name = {field.name: field for field in shape.columns}
    for field in shape.columns:
        # A field that the table extracts from a joined number on access has no column. A field of decimal digits has
        # one column for each group of digits.
        if field.name in columns or field.runs:
            _write_field(chunk, field, columns)
    for join in shape.joins:
        _write_joined_number(chunk, shape, join, fields_by_name, out=columns[join.name].view(np.uint64))
    if shape.unused:
        _write_unused_bits(chunk, shape, out=columns["unused"])


def _write_joined_number(chunk: Chunk, shape: Shape, join: Join, fields: Mapping[str, Column], out: Any) -> None:
    """Write a number that consists of several fields into ``out``, an array of 64-bit numbers.

    ``join.fields`` lists the names of the fields, each with its lowest bit in the joined number. The first field
    provides the lowest bits. ``fields`` contains the descriptions of all fields by name.
    """
    first_name, _ = join.fields[0]
    first_field = fields[first_name]
    are_adjacent_in_frame = all(
        fields[name].low == first_field.low + low_in_number for name, low_in_number in join.fields
    )
    if are_adjacent_in_frame:
        # The frame contains the joined number as it is.
        chunk.write_bits(first_field.low, find_width(shape, join), out)
        return
    chunk.write_bits(first_field.low, first_field.width, out)
    for name, low_in_number in join.fields[1:]:
        field = fields[name]
        bits = chunk.take(field.low, field.width).astype(np.uint64, copy=False)
        out |= shift_left(bits, low_in_number)


def _write_unused_bits(chunk: Chunk, shape: Shape, out: Any) -> None:
    """For each frame, write a number into ``out`` in which each unused bit is 1 if it differs from the manual.

    The unused bits are side by side in this number. Groups of them are moved from bit ``low`` of the frame to bit
    ``place`` of the number. The numbers have as few bytes as possible.
    """
    number_type = np.dtype(choose_smallest_type(count_unused_bits(shape))).type
    number = number_type(0)
    for group in group_unused_bits(shape):
        width = group.mask.bit_length()
        is_in_one_byte = group.low % 8 + width <= 8
        if is_in_one_byte:
            bits = chunk.take_from_byte(group.low, group.mask)
        else:
            bits = chunk.take(group.low, width) & np.uint64(group.mask)
        if group.value:
            # The bits that are 1 in the manual count as different if they are 0.
            bits = bits ^ bits.dtype.type(group.value)
        differing_bits = bits.astype(number_type, copy=False)
        if group.place:
            differing_bits = differing_bits << number_type(group.place)
        number = number | differing_bits
    out[:] = number


def _write_field(chunk: Chunk, field: Column, columns: Mapping[str, Any]) -> None:
    """Write the values of a field into its column, or into one column for each group of its decimal digits."""
    match field.kind:
        case "flag" | "not_flag":
            is_active_high = field.kind == "flag"
            chunk.write_flag(field.low, field.width, is_active_high, out=columns[field.name])
        case "choice":
            columns[field.name][:] = chunk.take(field.low, field.width)
        case "digits":
            bits = chunk.take(field.low, field.width).astype(np.uint64, copy=False)
            # The number 1234 has the groups 12 and 34. The group 12 has the divisor 100 and the modulus 100.
            for name, divisor, modulus in field.runs:
                number_without_lower_groups = bits // np.uint64(divisor)
                columns[name][:] = number_without_lower_groups % np.uint64(modulus)
        case "text":
            columns[field.name][:] = _read_text(chunk, field)
        case "number":
            number = columns[field.name].view(np.uint64)
            chunk.write_bits(field.low, field.width, out=number)
            if field.zero_means:
                number[number == 0] = field.zero_means
        case "signed":
            number = columns[field.name].view(np.uint64)
            chunk.write_bits(field.low, field.width, out=number)
            if field.width:
                # In two's complement, (n ^ sign_bit) - sign_bit extends the sign to 64 bits.
                sign_bit = np.uint64(1 << (field.width - 1))
                number ^= sign_bit
                number -= sign_bit
        case _:
            assert_never(field.kind)


def _read_text(chunk: Chunk, field: Column) -> Any:
    """Return the text of a field in each frame as an array of byte strings. The first character is the highest byte."""
    length = field.width // 8
    rows = np.empty((len(chunk.words[0]), length), np.uint8)
    for index in range(length):
        following_characters = length - 1 - index
        rows[:, index] = chunk.take(field.low + 8 * following_characters, width=8)
    return rows.view(f"S{length}")[:, 0]


def _write_verdicts(shape: Shape, columns: Mapping[str, Any]) -> None:
    """Write the verdict on the position of each frame, as an index in ``VERDICTS``, into the column ``verdict``.

    The verdict is NOT_USABLE if one of its causes is active, for example an error flag. Otherwise, it is
    USABLE_WITH_WARNING if a cause for that verdict is active, unless the default verdict is UNKNOWN. Otherwise, it is
    the default verdict. CRC errors and other frame errors are not considered here. The computation has no branches, so
    its time does not depend on the frames.
    """
    default = VERDICTS.index(shape.default_verdict)
    verdicts = columns["verdict"]
    verdicts[:] = default
    if not shape.verdict_causes:
        return
    activity_by_verdict = _find_active_causes(shape, columns)
    warnings = activity_by_verdict.get(Verdict.USABLE_WITH_WARNING)
    # A warning cannot improve an unknown verdict.
    if warnings and shape.default_verdict is not Verdict.UNKNOWN:
        has_warning = reduce(np.logical_or, warnings)
        _set_where(has_warning, VERDICTS.index(Verdict.USABLE_WITH_WARNING), out=verdicts)
    errors = activity_by_verdict.get(Verdict.NOT_USABLE)
    if errors:
        has_error = reduce(np.logical_or, errors)
        _set_where(has_error, VERDICTS.index(Verdict.NOT_USABLE), out=verdicts)


def _find_active_causes(shape: Shape, columns: Mapping[str, Any]) -> dict[Verdict, list[Any]]:
    """Return a list of arrays for each verdict, one for each cause: True for the frames in which it is active.

    A cause is an active flag, unused bits that differ from the manual, or fields with certain values. ``columns`` are
    the decoded fields. If no unused bit differs from the manual in any frame, causes that consist of unused bits are
    omitted.
    """
    # Each bit of this column is 1 where an unused bit differs from the manual.
    unused: Any = columns.get("unused")
    any_unused_differs = bool(shape.unused) and unused.any()
    activity_by_verdict: dict[Verdict, list[Any]] = {}
    for cause in shape.verdict_causes:
        if cause.when:
            is_active = all_match(columns, cause.when)
        elif cause.flag:
            is_active = columns[cause.flag]
            for name in cause.unless:
                # For two bools, "greater" means True and False: the flag is active, and the other one is not.
                is_active = np.greater(is_active, columns[name])
        elif any_unused_differs:
            # NumPy requires that the mask fits the type of the column, which has all unused bits.
            column_bits = 8 * unused.itemsize
            mask_in_column = cause.mask & ((1 << column_bits) - 1)
            is_active = (unused & unused.dtype.type(mask_in_column)) != 0
        else:
            continue
        activity_by_verdict.setdefault(cause.verdict, []).append(is_active)
    return activity_by_verdict
