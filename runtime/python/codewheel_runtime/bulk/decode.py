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
    FrameLayout,
    Join,
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


def decode_many(frames: object, layout: FrameLayout, encoder: FrameSource | None) -> Table:
    """Decode many frames into a table that has an array for each field, and the error of each frame.

    A frame of the wrong length has a length error, and its values have no meaning.

    Args:
        frames: Frames as an array, a buffer, a list or an Arrow column. They are rows of bytes, or numbers if a frame
            is a string of bits.
        layout: Description of the frames.
        encoder: Encoder of the frames, for the units of the table, or None if it is not known.
    """
    if is_arrow(frames):
        from .arrow import read_column

        frames = read_column(frames, layout)
    # Frames of the wrong length have been replaced by zeros. Their rows are in ``wrong_rows``.
    frames_read, wrong_rows = (
        read_rows(frames, layout.byte_count) if layout.byte_count else read_words(frames, layout.bit_count)
    )
    count = len(frames_read)
    columns = _allocate_columns(count, {**list_column_types(layout), "fault": "u1"})
    faults = columns.pop("fault")
    _decode_by_chunks(frames_read, layout, columns, faults)
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
        position=layout.position,
        parts=_find_parts_of_joined_numbers(layout),
        report_causes=layout.report_causes,
        position_columns=find_position_columns(layout),
        scales=find_scales(layout),
        frame=layout.frame,
    )


def _decode_by_chunks(frames: Any, layout: FrameLayout, columns: Mapping[str, Any], faults: Any) -> None:
    """Decode the frames into ``columns`` and ``faults``, whose arrays have an element for each frame."""
    faults[:] = 0
    for start in range(0, len(frames), CHUNK):
        rows = slice(start, start + CHUNK)
        columns_of_chunk = {name: column[rows] for name, column in columns.items()}
        _decode_chunk(frames[rows], layout, columns_of_chunk, faults[rows])


def _find_parts_of_joined_numbers(layout: FrameLayout) -> dict[str, tuple[str, int, int]]:
    """Return the fields that a table extracts from a joined number on access.

    For each field by name, these are the joined number, the lowest bit in it, and the width.
    """
    parts: dict[str, tuple[str, int, int]] = {}
    for join in layout.joins:
        for field_name, lowest_bit, width in find_deferred_fields(layout, join):
            parts[field_name] = (join.name, lowest_bit, width)
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


def _decode_chunk(frames: Any, layout: FrameLayout, columns: Mapping[str, Any], faults: Any) -> None:
    """Decode some frames: write their values into ``columns`` and their errors into ``faults``.

    Quick checks first find the frames that have any error. Only these frames are then examined for the kind of their
    error. Values are written for all frames, including frames with an error.
    """
    # Each array is nonzero for the frames that fail one check.
    failures: list[Any] = []
    if layout.byte_count:
        words = split_into_words(frames, layout)
    else:
        words = [frames]
        has_too_long_frames = layout.bit_count < 64 and int(frames.max()) >> layout.bit_count
        if has_too_long_frames:
            failures.append(shift_right(frames, layout.bit_count))
            words = [frames & bit_mask(layout.bit_count)]
    chunk = Chunk(words, layout.bit_count)
    if layout.crc is not None:
        failures.append(find_crc_difference(chunk, layout.crc))
    chunk.convert_to_binary(layout)
    failures += _run_quick_checks(chunk, layout)
    failures = [failure for failure in failures if failure.any()]
    _write_columns(chunk, layout, columns)
    if layout.default_verdict is not None:
        _write_verdicts(layout, columns)
    if not failures:
        return
    failed_rows = np.flatnonzero(reduce(np.logical_or, failures))
    words_of_failed = [word.take(failed_rows) for word in words]
    faults[failed_rows] = _find_faults(frames.take(failed_rows, axis=0), words_of_failed, layout)
    if layout.default_verdict is not None:
        _set_where(faults != 0, VERDICTS.index(Verdict.NOT_USABLE), out=columns["verdict"])


def _set_where(condition: Any, value: int, out: Any) -> None:
    """Set the elements of ``out``, an array of bytes, to ``value`` where ``condition`` is True.

    Arithmetic with 0 and 1 takes the same time for any condition. An assignment with a mask takes much longer if True
    and False alternate at random.
    """
    out *= np.logical_not(condition).view(np.uint8)
    if value:
        out += condition.view(np.uint8) * np.uint8(value)


def _run_quick_checks(chunk: Chunk, layout: FrameLayout) -> list[Any]:
    """Return an array for each check except the CRC. It is nonzero for the frames that fail the check."""
    checks = find_quick_checks(layout)
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


def _find_faults(frames: Any, words: list[Any], layout: FrameLayout) -> Any:
    """Return the error of each frame as the number of its ``ErrorKind``, or 0 for a valid frame.

    If a frame has several errors, the lowest number counts, because ``decode`` checks in the order of these numbers.
    ``words`` are the frames as 64-bit words, limited to the bits of the frame. ``frames`` are the frames as they were
    passed. The extra bits of a frame that is too long are still set in them.
    """
    chunk = Chunk(words, layout.bit_count)
    is_made_of_bytes = layout.byte_count > 0
    # Each kind of error, with an array that is True for the frames with this error.
    errors: list[tuple[ErrorKind, Any]] = []
    if layout.crc is not None:
        errors.append((ErrorKind.CRC, find_crc_difference(chunk, layout.crc) != 0))
    # The CRC covers the bits as they are sent. Other checks need binary numbers instead of Gray code.
    chunk.convert_to_binary(layout)
    errors += [(check.error_kind, np.logical_not(_pass_check(chunk, check))) for check in layout.checks]
    if not is_made_of_bytes and layout.bit_count < 64:
        errors.append((ErrorKind.LENGTH, shift_right(frames, layout.bit_count) != 0))
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
    if check.highest is not None:
        return are_within_limits(bits, check, check.highest)
    # A value that needs more bits than the field never occurs in it.
    possible_values = [value for value in check.allowed_values if not (value >> check.width)]
    if len(possible_values) > _MANY_VALUES:
        return np.isin(bits, np.array(possible_values, bits.dtype))
    # A few comparisons are faster than a search. They are fastest if both sides have the same NumPy type.
    bits_type = bits.dtype.type
    is_allowed = np.zeros(len(bits), bool)
    for value in possible_values:
        is_allowed |= bits == bits_type(value)
    return is_allowed


def _write_columns(chunk: Chunk, layout: FrameLayout, columns: Mapping[str, Any]) -> None:
    """Write the values of fields, joined numbers and unused bits into ``columns``, which are arrays by name."""
    fields_by_name = {field.name: field for field in layout.columns}
    for field in layout.columns:
        # A field that the table extracts from a joined number on access has no column. A field of decimal digits has
        # one column for each group of digits.
        if field.name in columns or field.digit_groups:
            _write_field(chunk, field, columns)
    for join in layout.joins:
        _write_joined_number(chunk, layout, join, fields_by_name, out=columns[join.name].view(np.uint64))
    if layout.unused:
        _write_unused_bits(chunk, layout, out=columns["unused"])


def _write_joined_number(chunk: Chunk, layout: FrameLayout, join: Join, fields: Mapping[str, Column], out: Any) -> None:
    """Write a number that consists of several fields into ``out``, an array of 64-bit numbers.

    ``join.fields`` lists the names of the fields, each with its lowest bit in the joined number. The first field
    provides the lowest bits. ``fields`` contains the descriptions of all fields by name.
    """
    first_name, _ = join.fields[0]
    first_field = fields[first_name]
    are_adjacent_in_frame = all(
        fields[name].lowest_bit == first_field.lowest_bit + lowest_bit_in_number
        for name, lowest_bit_in_number in join.fields
    )
    if are_adjacent_in_frame:
        # The frame contains the joined number as it is.
        chunk.write_bits(first_field.lowest_bit, find_width(layout, join), out)
        return
    chunk.write_bits(first_field.lowest_bit, first_field.width, out)
    for name, lowest_bit_in_number in join.fields[1:]:
        field = fields[name]
        bits = chunk.take(field.lowest_bit, field.width).astype(np.uint64, copy=False)
        out |= shift_left(bits, lowest_bit_in_number)


def _write_unused_bits(chunk: Chunk, layout: FrameLayout, out: Any) -> None:
    """For each frame, write a number into ``out`` in which each unused bit is 1 if it differs from the manual.

    The unused bits are side by side in this number. Groups of them are moved from bit ``lowest_bit`` of the frame to
    bit ``bit_in_column`` of the number. The numbers have as few bytes as possible.
    """
    number_type = np.dtype(choose_smallest_type(count_unused_bits(layout))).type
    number = number_type(0)
    for group in group_unused_bits(layout):
        width = group.mask.bit_length()
        is_in_one_byte = group.lowest_bit % 8 + width <= 8
        if is_in_one_byte:
            bits = chunk.take_from_byte(group.lowest_bit, group.mask)
        else:
            bits = chunk.take(group.lowest_bit, width) & np.uint64(group.mask)
        if group.value:
            # The bits that are 1 in the manual count as different if they are 0.
            bits = bits ^ bits.dtype.type(group.value)
        differing_bits = bits.astype(number_type, copy=False)
        if group.bit_in_column:
            differing_bits = differing_bits << number_type(group.bit_in_column)
        number = number | differing_bits
    out[:] = number


def _write_field(chunk: Chunk, field: Column, columns: Mapping[str, Any]) -> None:
    """Write the values of a field into its column, or into one column for each group of its decimal digits."""
    match field.value_kind:
        case "flag" | "not_flag":
            is_active_high = field.value_kind == "flag"
            chunk.write_flag(field.lowest_bit, field.width, is_active_high, out=columns[field.name])
        case "choice":
            columns[field.name][:] = chunk.take(field.lowest_bit, field.width)
        case "digits":
            bits = chunk.take(field.lowest_bit, field.width).astype(np.uint64, copy=False)
            # The number 1234 has the groups 12 and 34. The group 12 has the divisor 100 and the modulus 100.
            for name, divisor, modulus in field.digit_groups:
                number_without_lower_groups = bits // np.uint64(divisor)
                columns[name][:] = number_without_lower_groups % np.uint64(modulus)
        case "text":
            columns[field.name][:] = _read_text(chunk, field)
        case "number":
            number = columns[field.name].view(np.uint64)
            chunk.write_bits(field.lowest_bit, field.width, out=number)
            if field.zero_means:
                number[number == 0] = field.zero_means
        case "signed":
            number = columns[field.name].view(np.uint64)
            chunk.write_bits(field.lowest_bit, field.width, out=number)
            if field.width:
                # In two's complement, (n ^ sign_bit) - sign_bit extends the sign to 64 bits.
                sign_bit = np.uint64(1 << (field.width - 1))
                number ^= sign_bit
                number -= sign_bit
        case _:
            assert_never(field.value_kind)


def _read_text(chunk: Chunk, field: Column) -> Any:
    """Return the text of a field in each frame as an array of byte strings. The first character is the highest byte."""
    length = field.width // 8
    rows = np.empty((len(chunk.words[0]), length), np.uint8)
    for index in range(length):
        following_characters = length - 1 - index
        rows[:, index] = chunk.take(field.lowest_bit + 8 * following_characters, width=8)
    return rows.view(f"S{length}")[:, 0]


def _write_verdicts(layout: FrameLayout, columns: Mapping[str, Any]) -> None:
    """Write the verdict on the position of each frame, as an index in ``VERDICTS``, into the column ``verdict``.

    The verdict is NOT_USABLE if one of its causes is active, for example an error flag. Otherwise, it is
    USABLE_WITH_WARNING if a cause for that verdict is active, unless the default verdict is UNKNOWN. Otherwise, it is
    the default verdict. CRC errors and other frame errors are not considered here. The computation has no branches, so
    its time does not depend on the frames.
    """
    default = VERDICTS.index(layout.default_verdict)
    verdicts = columns["verdict"]
    verdicts[:] = default
    if not layout.verdict_causes:
        return
    activity_by_verdict = _find_active_causes(layout, columns)
    warnings = activity_by_verdict.get(Verdict.USABLE_WITH_WARNING)
    # A warning cannot improve an unknown verdict.
    if warnings and layout.default_verdict is not Verdict.UNKNOWN:
        has_warning = reduce(np.logical_or, warnings)
        _set_where(has_warning, VERDICTS.index(Verdict.USABLE_WITH_WARNING), out=verdicts)
    errors = activity_by_verdict.get(Verdict.NOT_USABLE)
    if errors:
        has_error = reduce(np.logical_or, errors)
        _set_where(has_error, VERDICTS.index(Verdict.NOT_USABLE), out=verdicts)


def _find_active_causes(layout: FrameLayout, columns: Mapping[str, Any]) -> dict[Verdict, list[Any]]:
    """Return a list of arrays for each verdict, one for each cause: True for the frames in which it is active.

    A cause is an active flag, unused bits that differ from the manual, or fields with certain values. ``columns`` are
    the decoded fields. If no unused bit differs from the manual in any frame, causes that consist of unused bits are
    omitted.
    """
    # Each bit of this column is 1 where an unused bit differs from the manual.
    unused: Any = columns.get("unused")
    any_unused_differs = bool(layout.unused) and unused.any()
    activity_by_verdict: dict[Verdict, list[Any]] = {}
    for cause in layout.verdict_causes:
        if cause.required_values:
            is_active = all_match(columns, cause.required_values)
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
