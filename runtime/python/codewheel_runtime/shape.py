# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Descriptions of frames for ``decode_many`` and ``encode_many``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import lru_cache
from typing import Any, Literal, NamedTuple

from .codec import BitField, assert_never
from .facts import Scale
from .reports import Report, Verdict
from .table import ErrorKind


class Column(NamedTuple):
    """Field of ``width`` bits that starts at bit ``low`` of the number that a frame forms.

    ``kind`` is the type of value that the bits encode. ``runs`` contains the name, divisor and modulus of each group of
    decimal digits. ``field`` is the name of the field in messages, if it differs from ``name``. ``values`` lists the
    only allowed values of the field, if they are limited. ``scale`` has the first members of its ``Scale``.
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
        """Return the parity bit for a frame."""
        ones = ((number >> low & (1 << width) - 1 & (self.mask or -1)).bit_count() for low, width in self.parity_of)
        return sum(ones) & 1 ^ self.odd

    def is_within(self, bits: int) -> bool:
        """Return whether the bits are at most ``limit``, and if they are signed, at least ``lowest``."""
        return self.limit is None or bits - self.lowest & (1 << self.width) - 1 <= self.limit - self.lowest


class Fold(NamedTuple):
    """Step of a CRC: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << back)``."""

    shift: int
    mask: int
    back: int


class CrcOf(NamedTuple):
    """CRC of ``width`` bits at ``low``.

    ``differs`` returns the bits in which the CRC of a frame differs from the computed one. ``steps`` fold a number
    whose last bits are inverted by ``xorout``. ``is_xor`` is True for a CRC that is the XOR of all bytes.
    """

    low: int
    width: int
    differs: Callable[[int], int]
    steps: tuple[Fold, ...] = ()
    xorout: int = 0
    is_xor: bool = False


def of_bytes(
    function: Callable[[bytes], int], length: int, width: int, order: Literal["little", "big"]
) -> Callable[[int], int]:
    """Return a function that finds the wrong bits of the CRC in the last ``width`` of ``length`` bytes."""

    def differs(number: int) -> int:
        data = number.to_bytes(length, order)
        return function(data[:-width]) ^ int.from_bytes(data[-width:], order)

    return differs


def of_bits(function: Callable[[int, int], int], covered: int, width: int, gap: int = 0) -> Callable[[int], int]:
    """Return a function that finds the wrong bits of the CRC in the last ``width`` bits of a number.

    The CRC covers ``covered`` bits, and ``gap`` bits are between them and the CRC.
    """
    ones = (1 << covered) - 1
    return lambda number: function(number >> width + gap & ones, covered) ^ number & ((1 << width) - 1)


class Join(NamedTuple):
    """Number assembled from fields, each listed with the position of its lowest bit in the number."""

    name: str
    fields: tuple[tuple[str, int], ...]


class Unused(NamedTuple):
    """Bits without meaning. Those that differ from ``value`` are 1 in ``unused``, starting at bit ``place``."""

    low: int
    width: int
    value: int
    place: int


class Speaks(NamedTuple):
    """Condition for a ``verdict``: a flag is active and certain others are not, or unused bits in ``mask`` differ.

    With ``when``, all these columns have the values next to them, 1 for an active flag.
    """

    verdict: Verdict
    flag: str = ""
    unless: tuple[str, ...] = ()
    mask: int = 0
    when: tuple[tuple[str, int], ...] = ()


class Tells(NamedTuple):
    """Condition for a ``report``: a flag is active, unused bits in ``mask`` differ, or ``when`` as in ``Speaks``.

    ``answered`` is the verdict of the report if your choice changes it.
    """

    report: str
    flag: str = ""
    mask: int = 0
    when: tuple[tuple[str, int], ...] = ()
    answered: Verdict | None = None

    def of(self, known: Mapping[str, Report]) -> Report:
        """Return the report with its verdict."""
        report = known[self.report]
        return report if self.answered is None else report._replace(makes_position=self.answered)

    def is_active(self, frame: Any) -> bool:
        """Return whether a decoded frame has the report."""
        if self.when:
            return all(getattr(frame, name) == value for name, value in self.when)
        return bool(getattr(frame, self.flag) if self.flag else frame.unused & self.mask)


class Shape(NamedTuple):
    """Description of a frame or register. ``length`` is its length in bytes, or 0 for a ``bits``-bit number.

    ``fixed`` contains the bits that are 1 in every such frame. ``position`` is the column of the position, if there is
    one, and ``otherwise`` the verdict if no condition applies. ``fields`` are all fields in the order of the manual.
    ``others`` is the mask of the bits of a register that belong to no field, if they are kept. ``limited`` is the name
    of a value with limits, and its attribute. ``frame`` is the name of the frame if other frames have another range of
    the position.
    """

    bits: int
    length: int = 0
    order: Literal["little", "big"] = "little"
    columns: tuple[Column, ...] = ()
    joins: tuple[Join, ...] = ()
    unused: tuple[Unused, ...] = ()
    checks: tuple[Check, ...] = ()
    crc: CrcOf | None = None
    gray: tuple[int, int] | None = None
    fixed: int = 0
    parities: tuple[Check, ...] = ()
    position: str = ""
    otherwise: Verdict | None = None
    speaks: tuple[Speaks, ...] = ()
    tells: tuple[Tells, ...] = ()
    fields: tuple[BitField, ...] = ()
    others: int | None = None
    limited: tuple[str, str] | None = None
    frame: str = ""


def kinds(shape: Shape) -> dict[str, str]:
    """Return the columns that are written, with their NumPy types."""
    late = {name for join in shape.joins for name, _, _ in late_fields(shape, join)}
    found: dict[str, str] = {}
    for item in shape.columns:
        if item.name in late:
            continue
        match item.kind:
            case "digits":
                found |= {name: "i8" for name, _, _ in item.runs}
            case "text":
                found[item.name] = f"S{item.width // 8}"
            case "flag" | "not_flag":
                found[item.name] = "?"
            case "choice":
                found[item.name] = smallest(item.width)
            case "number" | "signed":
                found[item.name] = "u8" if item.width == 64 else "i8"
            case _:
                assert_never(item.kind)
    found |= {join.name: "u8" if width_of(shape, join) == 64 else "i8" for join in shape.joins}
    found |= {"unused": smallest(unused_bits(shape))} if shape.unused else {}
    return found | ({"verdict": "u1"} if shape.otherwise is not None else {})


def smallest(width: int) -> str:
    """Return the smallest unsigned NumPy type with at least ``width`` bits."""
    return "u1" if width <= 8 else "u2" if width <= 16 else "u4" if width <= 32 else "u8"


def unused_bits(shape: Shape) -> int:
    """Return the width of the number that all unused bits form."""
    return max(item.place + item.width for item in shape.unused)


@lru_cache(maxsize=256)
def unused_groups(shape: Shape) -> tuple[tuple[int, int, int, int], ...]:
    """Return groups of unused bits that are shifted together: lowest bit, mask, value and place of each."""
    found: dict[tuple[int, int], list[Unused]] = {}
    for item in shape.unused:
        found.setdefault((item.low - item.place, item.low // 8), []).append(item)
    groups: list[tuple[int, int, int, int]] = []
    for items in found.values():
        first = min(items)
        masks = [((1 << item.width) - 1 << item.low - first.low, item.low - first.low) for item in items]
        value = sum(mask & item.value << low for (mask, low), item in zip(masks, items, strict=False))
        groups.append((first.low, sum(mask for mask, _ in masks), value, first.place))
    return tuple(groups)


def width_of(shape: Shape, join: Join) -> int:
    """Return the width of a joined number."""
    by_name = {item.name: item for item in shape.columns}
    return sum(by_name[name].width for name, _ in join.fields)


def late_fields(shape: Shape, join: Join) -> list[tuple[str, int, int]]:
    """Return the fields that are plain bits of a joined number. They are extracted from it on access."""
    by_name = {item.name: item for item in shape.columns}
    if width_of(shape, join) > 63 or join is not shape.joins[0]:
        return []
    plain = ((by_name[name], low) for name, low in join.fields)
    return [(i.name, low, i.width) for i, low in plain if i.kind == "number" and not i.zero_means]


def measured(shape: Shape) -> frozenset[str]:
    """Return the columns of the position and its parts, or all numbers if the frame has only a part of the position."""
    if shape.position:
        parts = (name for join in shape.joins if join.name == shape.position for name, _ in join.fields)
        return frozenset((shape.position, *parts))
    is_told = shape.otherwise is not None
    return frozenset(item.name for item in shape.columns if is_told and item.kind in ("number", "signed"))


def scales(shape: Shape) -> dict[str, tuple[str, Scale]]:
    """Return the columns of quantities, each with the column of its number. No field can have such a name."""
    found = ((item.name, Scale(*item.scale)) for item in shape.columns if item.scale is not None)
    return {f"{name} ({scale.unit})": (name, scale) for name, scale in found}


class Sound(NamedTuple):
    """Quick checks of a frame. Only frames that fail them are examined for their errors.

    ``fixed`` contains a mask and the required bits of each 64-bit limb, ``bytes`` the allowed values of single bytes,
    and ``others`` the remaining checks.
    """

    fixed: tuple[tuple[int, int], ...]
    bytes: tuple[tuple[int, tuple[int, ...]], ...]
    others: tuple[Check, ...]


@lru_cache(maxsize=256)
def sound(shape: Shape) -> Sound:
    """Return the checks of a shape, combined into one per byte and one for all constant bits."""
    mask = values = 0
    left: list[Check] = []
    by_byte: dict[int, list[Check]] = {}
    for item in shape.checks:
        if not item.width and not item.parity_of and holds(0, item):
            continue
        bits = [item, *(Check(low, width, item.fault) for low, width in item.parity_of)]
        places = {at // 8 for of in bits for at in (of.low, of.low + max(of.width, 1) - 1)}
        plain = [value for value in item.values if not value >> item.width]
        if len(places) == 1:
            by_byte.setdefault(places.pop(), []).append(item)
        elif len(plain) == 1:
            mask |= ((1 << item.width) - 1) << item.low
            values |= plain[0] << item.low
        else:
            left.append(item)
    some: list[tuple[int, tuple[int, ...]]] = []
    for place, items in by_byte.items():
        good = [byte for byte in range(256) if all(holds(byte << 8 * place, item) for item in items)]
        same = 255
        for byte in good:
            same &= ~(byte ^ good[0])
        if good and len(good) == 1 << 8 - same.bit_count():
            mask |= same << 8 * place
            values |= (good[0] & same) << 8 * place
        elif len(good) <= 8:
            some.append((place, tuple(good)))
        else:
            left += items
    limbs = range(0, shape.bits, 64)
    fixed = tuple((mask >> low & (1 << 64) - 1, values >> low & (1 << 64) - 1) for low in limbs)
    return Sound(fixed, tuple(some), tuple(left))


def holds(number: int, item: Check) -> bool:
    """Return whether the condition holds for one frame."""
    bits = number >> item.low & (1 << item.width) - 1
    if item.parity_of:
        return bits == item.parity(number)
    return item.is_within(bits) if item.limit is not None else bits in item.values
