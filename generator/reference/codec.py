"""Encode and decode using only the model, for the command line and as a reference for testing all generated codecs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..model import (
    Choice,
    Constant,
    Crc,
    CrcValue,
    Decimal,
    Device,
    Fault,
    Flag,
    Join,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Scale,
    Text,
    Unused,
    Value,
    Variant,
    assert_never,
    number_from_bytes,
    number_to_bytes,
)
from ..model.positions import PositionRange
from ..model.record import dataclass
from ..say import fault
from ..say.layout import as_one_number
from ..say.words import counted
from .crc import compute_bits, in_order

Values = Mapping[str, "int | str | bool"]

#: Name of the number that holds the unused bits of a decoded frame.
UNUSED = "unused"


@dataclass(frozen=True, slots=True)
class Problem:
    """An error in a frame, with the field that has it."""

    fault: Fault
    field: str
    message: str


class EncodeError(ValueError):
    """A value is missing, unknown, or does not fit its field."""


class DecodedField(NamedTuple):
    """A field of a decoded frame.

    ``raw`` is the number on the wire. ``value`` is its meaning: a number, a Boolean, the name of a value, or a string.
    ``scale`` gives the quantity that a number stands for.
    """

    name: str
    raw: int
    value: int | str | bool
    unit: str
    meaning: str
    high: int
    low: int
    scale: Scale | None = None


@dataclass(frozen=True, slots=True)
class CrcResult:
    name: str
    received: int
    computed: int

    @property
    def ok(self) -> bool:
        return self.received == self.computed


@dataclass(frozen=True, slots=True)
class Decoded:
    layout: PlacedLayout | None
    number: int
    fields: tuple[DecodedField, ...]
    crc: CrcResult | None
    problems: tuple[Problem, ...]

    @property
    def values(self) -> dict[str, int | str | bool]:
        return {item.name: item.value for item in self.fields}


def number_of_text(text: str) -> int:
    """Return the bits of a text field as one number. Latin-1 has a character for every byte."""
    return int.from_bytes(text.encode("latin-1", "replace"), "big")


def select(
    device: Device, variant: Variant, sender: str, data: bytes
) -> tuple[PlacedLayout | None, tuple[Problem, ...]]:
    """Return the layout of ``data``, identified by the selector field, or the reason why there is none."""
    candidates = [item for item in device.interface(variant.interface).layouts if item.sender == sender]
    if not candidates:
        return None, (Problem(Fault.RANGE, "", f"the {sender} sends no frames on this interface"),)
    allowed: list[int] = []
    for layout in candidates:
        placed = layout.place(variant.parameters)
        if not layout.selector:
            return placed, ()
        allowed.extend(layout.selects)
        if _selected(placed, data) in layout.selects:
            return placed, ()
    layout = candidates[0]
    found = _selected(layout.place(variant.parameters), data)
    if found is None:
        return None, (Problem(Fault.LENGTH, "", fault.too_few_bytes(counted(len(data), "byte"))),)
    choices = ", ".join(f"{value:X}" for value in sorted(allowed))
    wrong = fault.no_frame(layout.selector, f"{found:X}", choices)
    return None, (Problem(Fault.RANGE, layout.selector, wrong),)


def _selected(placed: PlacedLayout, data: bytes) -> int | None:
    """Return the value of the selector field, or None if ``data`` is too short for it. Longer data is accepted."""
    selector = placed.field(placed.layout.selector)
    if selector is None:
        return None
    low_first = placed.layout.byte_order == "low_byte_first"
    needed = selector.high // 8 + 1 if low_first else (placed.bits - selector.low + 7) // 8
    if len(data) < needed:
        return None
    beyond = 0 if low_first else placed.bits - 8 * needed
    return number_from_bytes(placed.layout, data[:needed]) >> (selector.low - beyond) & selector.mask


def decode_bytes(device: Device, variant: Variant, sender: str, data: bytes) -> Decoded:
    """Decode a frame of whole bytes whose selector field identifies the layout."""
    placed, problems = select(device, variant, sender, data)
    return decode_placed(device, placed, data) if placed is not None else Decoded(None, 0, (), None, problems)


def decode_placed(device: Device, placed: PlacedLayout, data: bytes) -> Decoded:
    """Decode a frame of whole bytes with a known layout."""
    number = number_from_bytes(placed.layout, data)
    if 8 * len(data) != placed.bits:
        return _other_length(placed, number, counted(placed.bits // 8, "byte"), len(data))
    return decode(device, placed, number)


def decode_bits(device: Device, placed: PlacedLayout, number: int, bits: int) -> Decoded:
    """Decode a frame of this many bits with a known layout."""
    if bits != placed.bits:
        return _other_length(placed, number, f"{placed.bits} bits", bits)
    return decode(device, placed, number)


def _other_length(placed: PlacedLayout, number: int, needed: str, found: int) -> Decoded:
    wrong = fault.length(placed.name, needed, f"{found}")
    return Decoded(placed, number, (), None, (Problem(Fault.LENGTH, "", wrong),))


def decode(device: Device, placed: PlacedLayout, number: int) -> Decoded:
    """Decode ``number`` into all fields and the CRC, and find all errors."""
    if number >> placed.bits:
        return _other_length(placed, number, f"{placed.bits} bits", number.bit_length())
    problems: list[Problem] = []
    fields = []
    plain = from_gray(placed, number)
    for item in placed.fields:
        raw = number >> item.low & item.mask
        fields += _decode_field(item, raw, plain >> item.low & item.mask, problems)
        if isinstance(item.field.kind, Parity):
            expected = parity_bit(placed, item.field.kind, number)
            if raw != expected:
                wrong = fault.parity(item.name, f"{raw}", ", ".join(item.field.kind.of), f"{expected}")
                problems.append(Problem(Fault.CONSTANT, item.name, wrong))
        elif item.name == placed.layout.selector and raw not in placed.layout.selects:
            problems.append(Problem(Fault.RANGE, item.name, fault.of_other_frame(item.name, f"{raw:X}")))
    valid = device.range_in(placed.layout)
    limited = placed.field(valid.field.name) if valid is not None else None
    if valid is not None and limited is not None:
        wrong = _outside(valid, limited, plain >> limited.low & limited.mask, placed)
        if wrong:
            problems.append(Problem(Fault.RANGE, limited.name, wrong))
    crc = _decode_crc(device, placed, number, problems)
    fields += [_decode_join(placed, join, number, plain) for join in placed.layout.joins]
    if placed.layout.has_unused:
        bits = unused_bits(placed, number)
        fields.append(DecodedField(UNUSED, bits, bits, "", "unused bits that differ from the manual", -1, -1))
    if problems:
        problems.sort(key=lambda item: list(Fault).index(item.fault))
    return Decoded(placed, number, tuple(fields), crc, tuple(problems))


def _outside(valid: PositionRange, item: PlacedField, raw: int, placed: PlacedLayout) -> str:
    """Return the error if the encoder does not have this position, or an empty string."""
    lowest, highest = valid.lowest.value(placed.parameters), valid.highest.value(placed.parameters)
    found = _number_of(item.field.number, raw, item.width)
    if lowest <= found <= highest:
        return ""
    if item.field.number.signed:
        return fault.outside(f"{item.name} {found}", f"{lowest}", f"{highest}")
    return fault.too_high(item.name, f"{found}", f"{highest}")


def _decode_crc(device: Device, placed: PlacedLayout, number: int, problems: list[Problem]) -> CrcResult | None:
    item = placed.crc_field
    if item is None or not isinstance(item.field.kind, CrcValue):
        return None
    crc = device.crc(item.field.kind.crc)
    result = CrcResult(crc.name, number >> item.low & item.mask, compute(crc, placed, number))
    if not result.ok:
        wrong = fault.crc(f"{result.received:#04x}", f"{result.computed:#04x}")
        problems.append(Problem(Fault.CRC, item.name, wrong))
    return result


def _decode_join(placed: PlacedLayout, join: Join, number: int, plain: int) -> DecodedField:
    parts = " and ".join(name for name in join.fields if placed.field(name) is not None)
    meaning = as_one_number(parts) if len(join.fields) > 1 else ""
    value = join_value(placed, join, plain)
    raw = join_value(placed, join, number) if placed.gray else value
    return DecodedField(join.name, raw, value, "", meaning, -1, -1)


def unused_bits(placed: PlacedLayout, number: int) -> int:
    """Return the unused bits of a frame as one number. A bit is 1 if it differs from the manual."""
    found = 0
    for item, place in placed.unused:
        found |= (number >> item.low & item.mask ^ _documented(item)) << place
    return found


def _documented(item: PlacedField) -> int:
    """Return the documented value of an unused field, cut to the width of the field for this order code."""
    return item.field.kind.value & item.mask if isinstance(item.field.kind, Unused) else 0


def parity_bit(placed: PlacedLayout, parity: Parity, number: int) -> int:
    """Return the parity bit that matches the other bits of ``number``."""
    fields = (placed.field(name) for name in parity.of)
    ones = sum((number >> of.low & of.mask & parity.mask).bit_count() for of in fields if of is not None)
    return (ones + parity.odd) & 1


def join_value(placed: PlacedLayout, join: Join, number: int) -> int:
    """Return the fields of a join as one number, with the first field most significant."""
    value = 0
    for name in join.fields:
        part = placed.field(name)
        if part is not None:
            value = value << part.width | number >> part.low & part.mask
    return value


def gray_to_binary(gray: int) -> int:
    """Return the number whose Gray code is ``gray``."""
    binary = gray
    while gray := gray >> 1:
        binary ^= gray
    return binary


def binary_to_gray(binary: int) -> int:
    """Return the Gray code of ``binary``."""
    return binary ^ binary >> 1


def from_gray(placed: PlacedLayout, number: int) -> int:
    """Return ``number`` with the part that is sent in Gray code, if any, converted to binary."""
    return _with_part(placed, number, gray_to_binary)


def to_gray(placed: PlacedLayout, number: int) -> int:
    """Return ``number`` with the part that is sent in Gray code, if any, converted to Gray code."""
    return _with_part(placed, number, binary_to_gray)


def _with_part(placed: PlacedLayout, number: int, change: Callable[[int], int]) -> int:
    if not placed.gray:
        return number
    low, width = placed.place_of(placed.layout.gray_of)
    mask = (1 << width) - 1
    return number & ~(mask << low) | change(number >> low & mask) << low


def _decode_field(item: PlacedField, wire: int, raw: int, problems: list[Problem]) -> list[DecodedField]:
    """Decode a field for the user. ``wire`` is the number as sent, ``raw`` the same number converted from Gray code."""
    field, name = item.field, item.name
    value: int | str | bool = raw
    meaning = field.meaning
    match field.kind:
        case Number() as number:
            value = _number_of(number, raw, item.width)
        case Flag() as flag:
            value = bool(raw) != flag.active_low
            meaning = (flag.when_active if value else flag.when_inactive) or meaning
        case Choice(values):
            named = next((entry for entry in values if entry.value == raw), None)
            if named is not None:
                value, meaning = named.name, named.meaning or meaning
            else:
                problems.append(Problem(Fault.RANGE, name, fault.no_value(name, f"{raw:#x}")))
        case Constant(constant):
            if raw != constant:
                wrong = fault.constant(name, f"{raw:#x}", f"{constant:#x}")
                problems.append(Problem(Fault.CONSTANT, name, wrong))
        case Text():
            value = raw.to_bytes(item.width // 8, "big").decode("latin-1")
        case Decimal() as decimal:
            if raw >= decimal.limit:
                wrong = fault.digits(name, f"{raw}", f"{decimal.digits}")
                problems.append(Problem(Fault.RANGE, name, wrong))
        case Unused():
            pass  # any value is valid
        case CrcValue() | Parity():
            pass  # checked later, when the other fields are known
        case _ as kind:
            assert_never(kind)
    found = [DecodedField(name, wire, value, field.unit, meaning, item.high, item.low, field.scale)]
    for run in field.runs:
        part = raw // run.divisor % run.modulus
        found.append(DecodedField(run.name, part, part, "", run.meaning, item.high, item.low))
    return found


def _number_of(number: Number, raw: int, width: int) -> int:
    if number.signed and raw >> (width - 1):
        return raw - (1 << width)
    return raw or number.zero_means


def compute(crc: Crc, placed: PlacedLayout, number: int) -> int:
    """Return the CRC that matches the other bits of ``number``."""
    return compute_bits(crc, *covered(crc, placed, number))


def covered(crc: Crc, placed: PlacedLayout, number: int) -> tuple[int, int]:
    """Return the bits that the CRC covers as a number, in the order in which it processes them, and how many."""
    if placed.layout.crc_covers_bytes:
        data = number_to_bytes(placed.layout, number, placed.bits)
        return in_order(crc, data[: -(crc.width // 8)])
    low, bits = placed.crc_covers
    return number >> low & (1 << bits) - 1, bits


def encode(device: Device, placed: PlacedLayout, values: Values) -> int:
    """Encode these values.

    Constants, parity and CRC are filled in. The value of a join can replace those of its fields. Unused bits are as in
    the manual, except for those that ``unused`` inverts.

    Raises:
        EncodeError: A value is missing, unknown, or does not fit.
    """
    given = dict(values)
    for join in placed.layout.joins:
        if join.name in given:
            given |= _split(placed, join, _number(given.pop(join.name)), given)
    number, valid = 0, device.range_in(placed.layout)
    for item in placed.fields:
        raw = _raw(placed, item, given)
        wrong = _outside(valid, item, raw, placed) if valid is not None and item.name == valid.field.name else ""
        if wrong:
            raise EncodeError(wrong)
        number |= raw << item.low
    if placed.layout.unused:
        number |= _unused(placed, _number(given.pop(UNUSED, 0)))
    used = _used(placed)
    left = [name for name in given if name not in used]
    if left:
        raise EncodeError(f"there is no field '{left[0]}' in {placed.name}")
    absent = next(
        (field.name for field in placed.layout.fields if given.get(field.name) and placed.field(field.name) is None), ""
    )
    if absent:
        raise EncodeError(f"{absent} {given[absent]} does not fit: this order code has no such field")
    for item in placed.fields:
        if isinstance(item.field.kind, Parity):
            number |= parity_bit(placed, item.field.kind, number) << item.low
    number = to_gray(placed, number)
    for item in placed.fields:
        if isinstance(item.field.kind, CrcValue):
            number |= compute(device.crc(item.field.kind.crc), placed, number) << item.low
    return number


def _used(placed: PlacedLayout) -> set[str]:
    names = {field.name for field in placed.layout.fields}
    return names | {run.name for field in placed.layout.fields for run in field.runs}


def _unused(placed: PlacedLayout, turned: int) -> int:
    """Return the unused bits at their positions in the frame: the manual's values, with ``turned`` inverted."""
    number = 0
    for item, place in placed.unused:
        number |= (turned >> place & item.mask ^ _documented(item)) << item.low
        turned &= ~(item.mask << place)
    if turned:
        raise EncodeError(f"'{UNUSED}' has the bits {turned:#x}, which are not unused bits of {placed.name}")
    return number


def _number(value: int | str | bool) -> int:
    if isinstance(value, str):
        raise EncodeError(f"'{value}' is not a number")
    return int(value)


def _split(placed: PlacedLayout, join: Join, value: int, given: Values) -> dict[str, int]:
    parts: dict[str, int] = {}
    rest = value
    for name in reversed(join.fields):
        item = placed.field(name)
        width = item.width if item is not None else 0
        parts[name] = rest & ((1 << width) - 1)
        rest >>= width
    if rest or value < 0:
        raise EncodeError(f"{join.name} {value} does not fit")
    if any(name in given and given[name] != parts[name] for name in parts):
        raise EncodeError(f"{join.name} and its fields disagree")
    return parts


def _raw(placed: PlacedLayout, item: PlacedField, given: Values) -> int:
    """Return the bits of one field. CRC and parity are computed later from the others."""
    name, kind = item.name, item.field.kind
    if isinstance(kind, Constant):
        return kind.value
    if isinstance(kind, (Unused, CrcValue, Parity)):
        return 0
    if isinstance(kind, Decimal) and name not in given:
        return sum(_parts(kind, given))
    if name not in given:
        if name == placed.layout.selector and len(placed.layout.selects) == 1:
            return placed.layout.selects[0]
        raise EncodeError(f"'{name}' is missing")
    value = given[name]
    match kind:
        case Number():
            raw = _bits_of(kind, item, _number(value))
        case Flag():
            raw = int(bool(value) != kind.active_low)
        case Choice(values):
            raw = _chosen(name, values, value) if isinstance(value, str) else _number(value)
        case Text():
            raw = number_of_text(value) if isinstance(value, str) else _number(value)
        case Decimal():
            raw = _number(value)
        case _:
            assert_never(kind)
    if raw < 0 or raw > item.mask:
        raise EncodeError(fault.too_wide(name, f"{raw}", f"{item.width}"))
    return raw


def _bits_of(number: Number, item: PlacedField, value: int) -> int:
    raw = 0 if value == number.zero_means else value & item.mask
    if _number_of(number, raw, item.width) != value:
        raise EncodeError(fault.too_wide(item.name, f"{value}", f"{item.width}"))
    if number.power_of_two and value.bit_count() != 1:
        raise EncodeError(fault.no_power_of_two(item.name, f"{value}"))
    return raw


def _chosen(name: str, values: Sequence[Value], value: str) -> int:
    named = next((item for item in values if item.name == value), None)
    if named is None:
        raise EncodeError(f"{name} has no value '{value}'")
    return named.value


def _parts(decimal: Decimal, given: Values) -> Iterator[int]:
    """Yield the value of each run of digits, multiplied by its divisor."""
    for run in decimal.runs:
        value = _number(given.get(run.name, 0))
        if not 0 <= value < run.modulus:
            raise EncodeError(f"{run.name} {value} has more than {run.digits} digits")
        yield value * run.divisor
