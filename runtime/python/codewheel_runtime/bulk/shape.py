# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Descriptions of frames for ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import lru_cache
from typing import Any, Literal, NamedTuple

from ..codec import BitField, assert_never
from ..errors import ErrorKind
from ..facts import Scale
from ..reports import Report, Verdict


class Column(NamedTuple):
    """Field of ``width`` bits that starts at bit ``low`` of the number that a frame forms.

    ``kind`` is the type of value that the bits encode. ``not_flag`` is an active-low flag. If ``zero_means`` is not 0,
    bits that are all 0 represent this number. With ``power_of_two``, only such numbers can be encoded. ``runs``
    contains the name, divisor and modulus of each group of decimal digits: its number is ``bits // divisor % modulus``.
    ``field`` is the name of the field in messages, if it differs from ``name``. ``values`` lists the only allowed
    values of the field, if they are limited. ``scale`` has the first members of its ``Scale``.
    """

    name: str
    low: int
    width: int
    kind: Literal["number", "signed", "flag", "not_flag", "choice", "digits", "text"] = "number"
    zero_means: int = 0
    power_of_two: bool = False
    runs: tuple[tuple[str, int, int], ...] = ()
    field: str = ""
    values: type[IntEnum] | tuple[int, ...] = ()
    scale: tuple[int, int, int, str] | None = None


class Check(NamedTuple):
    """Condition on the ``width`` bits that start at ``low``.

    They must be one of ``values``, or at most ``limit``, or the parity of the bits in ``parity_of``, inverted if
    ``odd``. ``mask`` selects the bits of each place in ``parity_of`` that count. 0 stands for all. If ``lowest`` is not
    0, the bits are a signed number from ``lowest`` to ``limit``.
    """

    low: int
    width: int
    fault: ErrorKind
    values: tuple[int, ...] = ()
    limit: int | None = None
    parity_of: tuple[tuple[int, int], ...] = ()
    odd: bool = False
    mask: int = 0
    lowest: int = 0

    def parity(self, number: int) -> int:
        """Return the parity bit for a frame, or 0 if the encoder does not send it."""
        # A mask of 0 selects all bits.
        ones = (((number >> low) & ((1 << width) - 1) & (self.mask or -1)).bit_count() for low, width in self.parity_of)
        return ((sum(ones) & 1) ^ self.odd) & self.width

    def is_within(self, bits: int) -> bool:
        """Return whether the bits are at most ``limit``, and if they are signed, at least ``lowest``.

        Without a limit, this is True.
        """
        # Modulo 2**width, the numbers from ``lowest`` to ``limit`` become the numbers from 0 on.
        return self.limit is None or (bits - self.lowest) & ((1 << self.width) - 1) <= self.limit - self.lowest


class Fold(NamedTuple):
    """Step of a CRC: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << back)``."""

    shift: int
    mask: int
    back: int


class CrcOf(NamedTuple):
    """CRC of ``width`` bits at ``low``.

    ``differs`` returns the bits in which the CRC of a frame differs from the computed CRC. ``steps`` fold a number
    whose last bits are inverted by ``xorout``. ``is_xor`` is True for a CRC that is the XOR of all bytes.
    """

    low: int
    width: int
    differs: Callable[[int], int]
    steps: tuple[Fold, ...] = ()
    xorout: int = 0
    is_xor: bool = False


def compare_bytes(
    function: Callable[[bytes], int], length: int, width: int, order: Literal["little", "big"]
) -> Callable[[int], int]:
    """Return a function that finds the wrong bits of the CRC of a frame, which is its last ``width`` bytes.

    Here ``width`` is a number of bytes. ``function`` computes the CRC of the ``length - width`` bytes before.
    """

    def differs(number: int) -> int:
        """Return the bits in which the CRC of a frame differs from the computed CRC."""
        data = number.to_bytes(length, order)
        return function(data[:-width]) ^ int.from_bytes(data[-width:], order)

    return differs


def compare_bits(function: Callable[[int, int], int], covered: int, width: int, gap: int = 0) -> Callable[[int], int]:
    """Return a function that finds the wrong bits of the CRC in the last ``width`` bits of a number.

    The CRC covers ``covered`` bits, and ``gap`` bits are between them and the CRC. ``function`` computes the CRC of a
    number with a number of bits.
    """
    ones = (1 << covered) - 1
    return lambda number: function((number >> (width + gap)) & ones, covered) ^ (number & ((1 << width) - 1))


class DigitCoding(NamedTuple):
    """Number of ``width`` bits at ``low`` whose digits are sent separately, in ``digit_bits`` bits each.

    ``codes`` has the code of each digit, from 0 up.
    """

    low: int
    width: int
    digit_bits: int
    codes: tuple[int, ...]


class Join(NamedTuple):
    """Number assembled from fields, each listed with the position of its lowest bit in the number."""

    name: str
    fields: tuple[tuple[str, int], ...]


class Unused(NamedTuple):
    """Bits without meaning. Bits that differ from ``value`` are 1 in ``unused``, starting at bit ``place``."""

    low: int
    width: int
    value: int
    place: int


class VerdictCause(NamedTuple):
    """Condition for a ``verdict``: a flag is active and certain others are not, or unused bits in ``mask`` differ.

    With ``when``, all these columns must have the values next to them, 1 for an active flag.
    """

    verdict: Verdict
    flag: str = ""
    unless: tuple[str, ...] = ()
    mask: int = 0
    when: tuple[tuple[str, int], ...] = ()


class ReportCause(NamedTuple):
    """Condition for a ``report``: a flag is active, unused bits in ``mask`` differ, or ``when`` as in ``VerdictCause``.

    ``chosen_verdict`` is the verdict of the report if your choice changes it.
    """

    report: str
    flag: str = ""
    mask: int = 0
    when: tuple[tuple[str, int], ...] = ()
    chosen_verdict: Verdict | None = None

    def of(self, reports: Mapping[str, Report]) -> Report:
        """Return the report of this cause from all reports by name. Your choice can replace its verdict."""
        report = reports[self.report]
        return report if self.chosen_verdict is None else report._replace(makes_position=self.chosen_verdict)

    def is_active(self, frame: Any) -> bool:
        """Return whether the report applies to a decoded frame."""
        if self.when:
            return all(getattr(frame, name) == value for name, value in self.when)
        return bool(getattr(frame, self.flag) if self.flag else frame.unused & self.mask)


class Shape(NamedTuple):
    """Description of a frame or register. ``length`` is its length in bytes, or 0 for a ``bits``-bit number.

    ``digit_codings`` are the numbers whose digits are sent separately. ``gray`` are lowest bit and width of the
    number that is sent in Gray code, and ``excess`` is added to it before. ``fixed`` contains the bits that are 1
    in every such frame. ``position`` is the column of the position, if there is one, and ``default_verdict`` the
    verdict if no condition applies. ``fields`` are all fields in the order of the manual. ``kept_mask`` selects the
    bits of a register that belong to no field, if they are kept. ``limited`` is the name of a value with limits,
    and its attribute. ``frame`` is the name of the frame if other frames have another range of the position.
    """

    bits: int
    length: int = 0
    order: Literal["little", "big"] = "little"
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
    limited: tuple[str, str] | None = None
    frame: str = ""


def list_column_types(shape: Shape) -> dict[str, str]:
    """Return the columns that ``decode_many`` writes, with their NumPy types: ``{"position": "i8", "error": "?"}``.

    Plain parts of a joined number are not among them, because they are extracted on access. Nor is ``fault``.
    """
    late_names = {name for join in shape.joins for name, _, _ in find_deferred_fields(shape, join)}
    types: dict[str, str] = {}
    for column in shape.columns:
        if column.name not in late_names:
            types |= _choose_types(column)
    for join in shape.joins:
        types[join.name] = "u8" if find_width(shape, join) == 64 else "i8"
    if shape.unused:
        types["unused"] = choose_smallest_type(count_unused_bits(shape))
    if shape.default_verdict is not None:
        types["verdict"] = "u1"
    return types


def _choose_types(column: Column) -> dict[str, str]:
    """Return the NumPy types of the columns that a field becomes, by name. Only decimal digits can be several columns.

    Numbers are signed, unless they need all 64 bits.
    """
    match column.kind:
        case "digits":
            return {name: "i8" for name, _, _ in column.runs}
        case "text":
            return {column.name: f"S{column.width // 8}"}
        case "flag" | "not_flag":
            return {column.name: "?"}
        case "choice":
            return {column.name: choose_smallest_type(column.width)}
        case "number" | "signed":
            return {column.name: "u8" if column.width == 64 else "i8"}
        case _:
            assert_never(column.kind)


def choose_smallest_type(width: int) -> str:
    """Return the smallest unsigned NumPy type with at least ``width`` bits."""
    for bits, type_name in ((8, "u1"), (16, "u2"), (32, "u4")):
        if width <= bits:
            return type_name
    return "u8"


def count_unused_bits(shape: Shape) -> int:
    """Return the width of the number that all unused bits form."""
    return max(unused.place + unused.width for unused in shape.unused)


class UnusedGroup(NamedTuple):
    """Unused bits that are shifted together.

    ``low`` is their lowest bit in the frame, and ``place`` their lowest bit in ``unused``. Bit 0 of ``mask``, and of
    ``value``, which is that in the manual, is the bit ``low`` of the frame.
    """

    low: int
    mask: int
    value: int
    place: int


@lru_cache(maxsize=256)
def group_unused_bits(shape: Shape) -> tuple[UnusedGroup, ...]:
    """Return the groups of unused bits.

    Bits with the same shift from the frame to ``unused`` form a group if they begin in the same byte of the frame.
    """
    # The key is the shift and the index of the byte.
    by_shift: dict[tuple[int, int], list[Unused]] = {}
    for unused in shape.unused:
        by_shift.setdefault((unused.low - unused.place, unused.low // 8), []).append(unused)
    groups: list[UnusedGroup] = []
    for group in by_shift.values():
        # The bits with the lowest place in the frame.
        first = min(group)
        mask = value = 0
        for unused in group:
            offset = unused.low - first.low
            unused_mask = ((1 << unused.width) - 1) << offset
            mask |= unused_mask
            value |= unused_mask & (unused.value << offset)
        groups.append(UnusedGroup(low=first.low, mask=mask, value=value, place=first.place))
    return tuple(groups)


def find_width(shape: Shape, join: Join) -> int:
    """Return the width of a joined number."""
    by_name = {column.name: column for column in shape.columns}
    return sum(by_name[name].width for name, _ in join.fields)


def find_deferred_fields(shape: Shape, join: Join) -> list[tuple[str, int, int]]:
    """Return the fields that are plain bits of a joined number: name, lowest bit in this number, and width.

    They are extracted from it on access. Only the first joined number of a shape has such fields, and only if it has
    fewer than 64 bits.
    """
    by_name = {column.name: column for column in shape.columns}
    if find_width(shape, join) > 63 or join is not shape.joins[0]:
        return []
    deferred_fields: list[tuple[str, int, int]] = []
    for name, low in join.fields:
        column = by_name[name]
        if column.kind == "number" and not column.zero_means:
            deferred_fields.append((name, low, column.width))
    return deferred_fields


def find_position_columns(shape: Shape) -> frozenset[str]:
    """Return the columns whose values have no meaning if the position is not usable.

    These are the position and its parts. If a frame has a verdict but not the whole position, it contains only a part
    of the position, so the result is all its numbers. Other frames have no such columns.
    """
    if shape.position:
        parts = (name for join in shape.joins if join.name == shape.position for name, _ in join.fields)
        return frozenset((shape.position, *parts))
    if shape.default_verdict is None:
        return frozenset()
    return frozenset(column.name for column in shape.columns if column.kind in ("number", "signed"))


def find_scales(shape: Shape) -> dict[str, tuple[str, Scale]]:
    """Return the name of each column of quantities, with the column of its number and the scale.

    An example is ``{"temperature (°C)": ("temperature", Scale(…))}``. No field can have such a name.
    """
    scaled = ((column.name, Scale(*column.scale)) for column in shape.columns if column.scale is not None)
    return {f"{name} ({scale.unit})": (name, scale) for name, scale in scaled}


class QuickChecks(NamedTuple):
    """Quick checks of a frame. Only frames that fail them are examined for their errors.

    ``fixed`` contains a mask and the required bits of each 64-bit limb, lowest first. ``bytes`` contains the index of a
    byte and its allowed values. ``remaining`` contains all other checks.
    """

    fixed: tuple[tuple[int, int], ...]
    bytes: tuple[tuple[int, tuple[int, ...]], ...]
    remaining: tuple[Check, ...]


@lru_cache(maxsize=256)
def find_quick_checks(shape: Shape) -> QuickChecks:
    """Return the checks of a shape, combined into allowed values of bytes and a single check of all constant bits.

    If the four lowest bits of a frame must be 1010, the result is ``fixed=((0xF, 0xA),)``.
    """
    # The constant bits of the frame, and their values at the same places.
    mask = values = 0
    remaining: list[Check] = []
    by_byte: dict[int, list[Check]] = {}
    for check in shape.checks:
        # A check of no bits that always holds is left out.
        if not check.width and not check.parity_of and holds(0, check):
            continue
        if check.parity_of and (
            shape.gray is not None or shape.digit_codings
        ):  # It is the parity of the bits before the conversion.
            remaining.append(check)
            continue
        byte_indices = _split_into_bytes(check)
        fitting_values = [value for value in check.values if not value >> check.width]
        if len(byte_indices) == 1:
            by_byte.setdefault(byte_indices.pop(), []).append(check)
        elif len(fitting_values) == 1:
            mask |= ((1 << check.width) - 1) << check.low
            values |= fitting_values[0] << check.low
        else:
            remaining.append(check)
    byte_values: list[tuple[int, tuple[int, ...]]] = []
    for index, checks in by_byte.items():
        allowed = [byte for byte in range(256) if _are_all_met(byte << (8 * index), checks)]
        # Bits that are the same in all allowed values.
        constant_bits = 255
        for byte in allowed:
            constant_bits &= ~(byte ^ allowed[0])
        # If the other bits can have any value, the constant bits are the whole condition: n other bits have 2**n
        # values.
        if allowed and len(allowed) == 1 << (8 - constant_bits.bit_count()):
            mask |= constant_bits << (8 * index)
            values |= (allowed[0] & constant_bits) << (8 * index)
        # A few allowed values are compared one by one.
        elif len(allowed) <= 8:
            byte_values.append((index, tuple(allowed)))
        else:
            remaining += checks
    limbs = range(0, shape.bits, 64)
    fixed = tuple(((mask >> low) & ((1 << 64) - 1), (values >> low) & ((1 << 64) - 1)) for low in limbs)
    return QuickChecks(fixed=fixed, bytes=tuple(byte_values), remaining=tuple(remaining))


def _split_into_bytes(check: Check) -> set[int]:
    """Return the indices of the bytes in which the bits of a check, and of its parity, begin and end."""
    byte_indices: set[int] = set()
    # A field without bits counts as one bit.
    for low, width in ((check.low, check.width), *check.parity_of):
        byte_indices |= {low // 8, (low + max(width, 1) - 1) // 8}
    return byte_indices


def _are_all_met(number: int, checks: list[Check]) -> bool:
    """Return whether all conditions hold for one frame."""
    return all(holds(number, check) for check in checks)


def holds(number: int, check: Check) -> bool:
    """Return whether the condition holds for one frame."""
    bits = (number >> check.low) & ((1 << check.width) - 1)
    if check.parity_of:
        return bits == check.parity(number)
    return check.is_within(bits) if check.limit is not None else bits in check.values
