# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Descriptions of frames for ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from functools import lru_cache
from typing import Any, Literal, NamedTuple

from ..codec import BitField, assert_never, exchange_bytes
from ..errors import ErrorKind
from ..facts import Scale
from ..reports import Report, Verdict


class Column(NamedTuple):
    """Field of ``width`` bits that starts at bit ``lowest_bit`` of the number that a frame forms.

    ``value_kind`` is the type of value that the bits encode. ``not_flag`` is an active-low flag. If ``zero_means`` is
    not 0, bits that are all 0 represent this number. With ``power_of_two``, only powers of two can be encoded.
    ``digit_groups`` contains the name, divisor and modulus of each group of decimal digits: its number is ``bits //
    divisor % modulus``. ``field`` is the name of the field in messages, if it differs from ``name``. ``allowed_values``
    lists the only allowed values of the field, if they are limited. ``scale`` contains the first members of the
    ``Scale`` that converts the number to a quantity.
    """

    name: str
    lowest_bit: int
    width: int
    value_kind: Literal["number", "signed", "flag", "not_flag", "choice", "digits", "text"] = "number"
    zero_means: int = 0
    power_of_two: bool = False
    digit_groups: tuple[tuple[str, int, int], ...] = ()
    field: str = ""
    allowed_values: type[IntEnum] | tuple[int, ...] = ()
    scale: tuple[int, int, int, str] | None = None


class Check(NamedTuple):
    """Condition on the ``width`` bits that start at ``lowest_bit``, and the error of a frame that does not meet it.

    The bits must be one of ``allowed_values``, or at most ``highest``, or the parity of the bits in ``parity_of``,
    inverted if ``odd``. Each item of ``parity_of`` is the lowest bit and the width of a covered field. ``mask`` selects
    which bits of each covered field count. A mask of 0 selects all. If ``lowest`` is not 0, the bits are a signed
    number from ``lowest`` to ``highest``. If ``joined`` is not empty, the bits at these places form the number
    together, most significant first.
    """

    lowest_bit: int
    width: int
    error_kind: ErrorKind
    allowed_values: tuple[int, ...] = ()
    highest: int | None = None
    parity_of: tuple[tuple[int, int], ...] = ()
    odd: bool = False
    mask: int = 0
    lowest: int = 0
    joined: tuple[tuple[int, int], ...] = ()

    def take(self, number: int) -> int:
        """Return the bits of a frame, given as a number, to which the condition applies."""
        bits = 0
        for lowest_bit, width in self.joined or ((self.lowest_bit, self.width),):
            bits = (bits << width) | ((number >> lowest_bit) & ((1 << width) - 1))
        return bits

    def parity(self, number: int) -> int:
        """Return the parity bit for a frame, given as a number, or 0 if the encoder does not send a parity bit."""
        # A mask of 0 selects all bits, which are the bits of -1.
        one_count = 0
        for lowest_bit, width in self.parity_of:
            field_mask = (1 << width) - 1
            one_count += ((number >> lowest_bit) & field_mask & (self.mask or -1)).bit_count()
        is_odd = one_count & 1
        return (is_odd ^ self.odd) & self.width

    def is_within(self, bits: int) -> bool:
        """Return whether the bits are at most ``highest``, and if they are signed, at least ``lowest``.

        Returns True if there is no limit.
        """
        if self.highest is None:
            return True
        # Modulo 2**width, the lowest number becomes 0, so one comparison checks both limits.
        mask = (1 << self.width) - 1
        return ((bits - self.lowest) & mask) <= self.highest - self.lowest


class Fold(NamedTuple):
    """Step of a CRC that folds the high bits of a number: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << back)``."""

    shift: int
    mask: int
    back: int


class CrcOf(NamedTuple):
    """CRC of ``width`` bits, whose lowest bit is ``lowest_bit``.

    ``find_difference`` returns the bits in which the CRC in a frame differs from the CRC computed from the frame. If
    the CRC can be computed by folding, ``steps`` are the steps, and ``xorout`` is the mask of the CRC bits that are
    sent inverted. ``is_xor`` is True for a CRC that is the XOR of all bytes.
    """

    lowest_bit: int
    width: int
    find_difference: Callable[[int], int]
    steps: tuple[Fold, ...] = ()
    xorout: int = 0
    is_xor: bool = False


def compare_bytes(
    function: Callable[[bytes], int],
    length: int,
    width: int,
    order: Literal["little", "big"],
    exchanged_bytes: tuple[tuple[int, int], ...] = (),
) -> Callable[[int], int]:
    """Return a function that finds the bits in which the CRC in a frame of bytes differs from the computed CRC.

    The returned function takes the frame as a number. The frame has ``length`` bytes, and its last ``width`` bytes are
    the CRC. ``function`` computes the CRC of the bytes before it. ``exchanged_bytes`` are the fields that have a byte
    order of their own, as in ``FrameLayout``.
    """

    def find_difference(number: int) -> int:
        """Return the XOR of the CRC in a frame and the computed CRC."""
        data = number.to_bytes(length, order)
        sent_crc = int.from_bytes(data[-width:], order)
        sent_bytes = exchange_bytes(data, exchanged_bytes)
        computed_crc = function(sent_bytes[:-width])
        return computed_crc ^ sent_crc

    return find_difference


def compare_bits(function: Callable[[int, int], int], covered: int, width: int, gap: int = 0) -> Callable[[int], int]:
    """Return a function that finds the bits in which the CRC in a frame of bits differs from the computed CRC.

    The returned function takes the frame as a number, whose last ``width`` bits are the CRC. The CRC covers ``covered``
    bits, and ``gap`` bits are between them and the CRC. ``function`` computes the CRC of a number with this number of
    bits.
    """
    covered_mask = (1 << covered) - 1
    crc_mask = (1 << width) - 1

    def find_difference(number: int) -> int:
        """Return the XOR of the CRC in a frame and the computed CRC."""
        covered_bits = (number >> (width + gap)) & covered_mask
        return function(covered_bits, covered) ^ (number & crc_mask)

    return find_difference


class DigitCoding(NamedTuple):
    """Number of ``width`` bits at ``lowest_bit`` whose digits are sent separately, in ``digit_bits`` bits each.

    ``codes`` contains the code of each digit, starting with 0.
    """

    lowest_bit: int
    width: int
    digit_bits: int
    codes: tuple[int, ...]


class Join(NamedTuple):
    """Number assembled from fields, each listed with the position of its lowest bit in the number."""

    name: str
    fields: tuple[tuple[str, int], ...]


class Unused(NamedTuple):
    """Bits that have no meaning in the manual, but the value ``value``.

    In the column ``unused``, each bit that differs from the manual is 1. These bits start at bit ``bit_in_column``
    there.
    """

    lowest_bit: int
    width: int
    value: int
    bit_in_column: int


class VerdictCause(NamedTuple):
    """Cause of a ``verdict``: an active flag, or unused bits in ``mask`` that differ from the manual.

    The flag counts only if no flag in ``unless`` is active. With ``required_values``, the cause is instead that these
    columns have the given values, where 1 is an active flag.
    """

    verdict: Verdict
    flag: str = ""
    unless: tuple[str, ...] = ()
    mask: int = 0
    required_values: tuple[tuple[str, int], ...] = ()


class ReportCause(NamedTuple):
    """Cause of a ``report``: an active flag, unused bits in ``mask`` that differ from the manual, or certain values.

    ``required_values`` lists columns with the value that each must have. ``chosen_verdict`` replaces the verdict of the
    report if your answer to an open question changes it, otherwise it is None.
    """

    report: str
    flag: str = ""
    mask: int = 0
    required_values: tuple[tuple[str, int], ...] = ()
    chosen_verdict: Verdict | None = None

    def of(self, reports: Mapping[str, Report]) -> Report:
        """Look up the report of this cause among all reports, by name.

        Your answer to an open question can change the report's verdict.
        """
        report = reports[self.report]
        return report if self.chosen_verdict is None else report._replace(makes_position=self.chosen_verdict)

    def is_active(self, frame: Any) -> bool:
        """Return whether the report applies to a decoded frame."""
        if self.required_values:
            return all(getattr(frame, name) == value for name, value in self.required_values)
        if self.flag:
            return bool(getattr(frame, self.flag))
        return bool(frame.unused & self.mask)


class FrameLayout(NamedTuple):
    """Description of a frame or register. ``byte_count`` is 0 for a number of ``bit_count`` bits.

    ``exchanged_bytes`` has the first byte of each field whose byte order is not ``order``, and the byte after it.
    ``digit_codings`` are the numbers whose digits are sent separately. ``gray`` is the lowest bit and the width of the
    number that is sent in Gray code, and ``excess`` is the number that is sent for position 0. ``fixed`` contains the
    bits that are 1 in every such frame. ``position`` is the name of the column with the position, or empty if there is
    none, and ``default_verdict`` is the verdict if none of ``verdict_causes`` is active. ``fields`` are all fields in
    the order of the manual. ``kept_mask`` selects the bits of a register that belong to no field, if they are kept.
    ``limited_value`` is the name of a value with limits, and its attribute. ``frame`` is the name of the frame if other
    frames have a different position range.
    """

    bit_count: int
    byte_count: int = 0
    order: Literal["little", "big"] = "little"
    exchanged_bytes: tuple[tuple[int, int], ...] = ()
    columns: tuple[Column, ...] = ()
    digit_codings: tuple[DigitCoding, ...] = ()
    joins: tuple[Join, ...] = ()
    unused: tuple[Unused, ...] = ()
    checks: tuple[Check, ...] = ()
    crc: CrcOf | None = None
    gray: tuple[int, int] | None = None
    excess: int = 0
    fixed: int = 0
    parities: tuple[Check, ...] = ()
    position: str = ""
    default_verdict: Verdict | None = None
    verdict_causes: tuple[VerdictCause, ...] = ()
    report_causes: tuple[ReportCause, ...] = ()
    fields: tuple[BitField, ...] = ()
    kept_mask: int | None = None
    limited_value: tuple[str, str] | None = None
    frame: str = ""


def list_column_types(layout: FrameLayout) -> dict[str, str]:
    """Return the columns that ``decode_many`` writes, with their NumPy types: ``{"position": "i8", "error": "?"}``.

    The column ``fault`` is omitted, and so are the plain parts of a joined number, which the table extracts on access.
    """
    deferred_names = {name for join in layout.joins for name, _, _ in find_deferred_fields(layout, join)}
    types: dict[str, str] = {}
    for column in layout.columns:
        if column.name not in deferred_names:
            types |= _choose_types(column)
    for join in layout.joins:
        types[join.name] = "u8" if find_width(layout, join) == 64 else "i8"
    if layout.unused:
        types["unused"] = choose_smallest_type(count_unused_bits(layout))
    if layout.default_verdict is not None:
        types["verdict"] = "u1"
    return types


def _choose_types(column: Column) -> dict[str, str]:
    """Return the NumPy types of a field's columns, by name. Only groups of decimal digits can have several columns.

    Numbers are signed, unless they need all 64 bits.
    """
    match column.value_kind:
        case "digits":
            return {name: "i8" for name, _, _ in column.digit_groups}
        case "text":
            return {column.name: f"S{column.width // 8}"}
        case "flag" | "not_flag":
            return {column.name: "?"}
        case "choice":
            return {column.name: choose_smallest_type(column.width)}
        case "number" | "signed":
            return {column.name: "u8" if column.width == 64 else "i8"}
        case _:
            assert_never(column.value_kind)


def choose_smallest_type(width: int) -> str:
    """Return the smallest unsigned NumPy type with at least ``width`` bits."""
    for bits, type_name in ((8, "u1"), (16, "u2"), (32, "u4")):
        if width <= bits:
            return type_name
    return "u8"


def count_unused_bits(layout: FrameLayout) -> int:
    """Return the number of bits in the column ``unused``, which contains all unused bits of a frame side by side."""
    return max(unused.bit_in_column + unused.width for unused in layout.unused)


class UnusedGroup(NamedTuple):
    """Unused bits of a frame that are shifted together into the column ``unused``.

    ``lowest_bit`` is in the frame, and ``bit_in_column`` is their lowest bit in the column. ``mask`` selects the bits
    of the group after they are shifted down to bit 0, and ``value`` contains their values in the manual.
    """

    lowest_bit: int
    mask: int
    value: int
    bit_in_column: int


@lru_cache(maxsize=256)
def group_unused_bits(layout: FrameLayout) -> tuple[UnusedGroup, ...]:
    """Return the groups of unused bits that can be shifted together into the column ``unused``.

    Bits form a group if they have the same distance from the frame to the column, and begin in the same byte of the
    frame.
    """
    unused_by_group: dict[tuple[int, int], list[Unused]] = {}
    for unused in layout.unused:
        distance_to_column = unused.lowest_bit - unused.bit_in_column
        byte_index = unused.lowest_bit // 8
        unused_by_group.setdefault((distance_to_column, byte_index), []).append(unused)
    groups: list[UnusedGroup] = []
    for unused_of_group in unused_by_group.values():
        lowest = min(unused_of_group, key=lambda unused: unused.lowest_bit)
        mask = 0
        value = 0
        for unused in unused_of_group:
            # Bit 0 of the mask and the value is the lowest bit of the group.
            offset = unused.lowest_bit - lowest.lowest_bit
            unused_mask = ((1 << unused.width) - 1) << offset
            mask |= unused_mask
            value |= unused_mask & (unused.value << offset)
        groups.append(UnusedGroup(lowest.lowest_bit, mask, value, lowest.bit_in_column))
    return tuple(groups)


def find_width(layout: FrameLayout, join: Join) -> int:
    """Return the number of bits of a joined number, which is the sum of the widths of its fields."""
    width_by_name = {column.name: column.width for column in layout.columns}
    return sum(width_by_name[name] for name, _ in join.fields)


def find_deferred_fields(layout: FrameLayout, join: Join) -> list[tuple[str, int, int]]:
    """Return the fields that are plain bits of a joined number: name, lowest bit in the number, and width of each.

    The table extracts these fields from the joined number on access, instead of when frames are decoded. Only the first
    joined number of a frame has such fields, and only if it has fewer than 64 bits.
    """
    is_first_join = join is layout.joins[0]
    if find_width(layout, join) > 63 or not is_first_join:
        return []
    columns_by_name = {column.name: column for column in layout.columns}
    deferred_fields: list[tuple[str, int, int]] = []
    for name, lowest_bit_in_number in join.fields:
        column = columns_by_name[name]
        # A field with another value for 0 is not just bits of the number.
        is_plain = column.value_kind == "number" and not column.zero_means
        if is_plain:
            deferred_fields.append((name, lowest_bit_in_number, column.width))
    return deferred_fields


def find_position_columns(layout: FrameLayout) -> frozenset[str]:
    """Return the names of the columns whose values have no meaning if the position is not usable.

    These are the position and the parts that it is joined from. A frame with a verdict but without the whole position
    contains only a part of it, so all numbers of such a frame are returned. The result is empty for frames without a
    verdict.
    """
    if layout.position:
        position_columns = {layout.position}
        for join in layout.joins:
            if join.name == layout.position:
                position_columns |= {name for name, _ in join.fields}
        return frozenset(position_columns)
    has_verdict = layout.default_verdict is not None
    if not has_verdict:
        return frozenset()
    return frozenset(column.name for column in layout.columns if column.value_kind in ("number", "signed"))


def find_scales(layout: FrameLayout) -> dict[str, tuple[str, Scale]]:
    """Return the names of the quantity columns, each with the column of its number and the scale.

    Example: ``{"temperature (°C)": ("temperature", Scale(…))}``. Such a name cannot be the name of a field.
    """
    scales: dict[str, tuple[str, Scale]] = {}
    for column in layout.columns:
        if column.scale is not None:
            scale = Scale(*column.scale)
            scales[f"{column.name} ({scale.unit})"] = (column.name, scale)
    return scales


def holds(number: int, check: Check) -> bool:
    """Return whether a frame, given as a number, meets a condition."""
    bits = check.take(number)
    if check.parity_of:
        return bits == check.parity(number)
    return check.is_within(bits) if check.highest is not None else bits in check.allowed_values


def all_match(columns: Any, values: Iterable[tuple[str, int]]) -> Any:
    """Return an array that is True for each row in which these columns have the values given with their names."""
    matches: Any = True
    for name, value in values:
        matches = matches & (columns[name] == value)
    return matches


def find_active(columns: Any, cause: ReportCause) -> Any:
    """Return an array that is True for the frames in which the cause of a report is active, valid or not.

    The cause consists of columns with certain values, an active flag, or unused bits that differ from the manual.
    ``columns`` are the columns of the frames by name.
    """
    if cause.required_values:
        return all_match(columns, cause.required_values)
    if cause.flag:
        return columns[cause.flag]
    unused: Any = columns["unused"]
    # NumPy requires that the mask fits the type of the column, which has all unused bits.
    column_bits = 8 * unused.itemsize
    mask_in_column = cause.mask & ((1 << column_bits) - 1)
    return (unused & mask_in_column) != 0
