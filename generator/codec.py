"""Encoding and decoding by the model alone: what the command line shows, and what every generated codec is held against."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .crc import compute_bits, compute_bytes
from .model import Crc, Device, Field, Join, Layout, PlacedField, PlacedLayout, Variant
from .words import counted

Values = Mapping[str, "int | str | bool"]


@dataclass(frozen=True, slots=True)
class Problem:
    """A fault of a frame: ``kind`` is ``crc``, ``constant``, ``length`` or ``range``."""

    kind: str
    field: str
    message: str


class EncodeError(ValueError):
    """A value is missing, unknown, or does not fit its field."""


@dataclass(frozen=True, slots=True)
class DecodedField:
    """``raw`` is the number on the wire, ``value`` what it stands for: a number, a truth value, the name of a value, or text."""

    name: str
    raw: int
    value: int | str | bool
    unit: str
    meaning: str
    high: int
    low: int


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


def number_from_bytes(layout: Layout, data: bytes) -> int:
    """The bytes of a frame or register as one number."""
    return int.from_bytes(data, "little" if layout.byte_order == "low_byte_first" else "big")


def number_to_bytes(layout: Layout, number: int, bits: int) -> bytes:
    """One number as the bytes of a frame or register."""
    return number.to_bytes(bits // 8, "little" if layout.byte_order == "low_byte_first" else "big")


def select(device: Device, variant: Variant, sender: str, data: bytes) -> tuple[PlacedLayout | None, tuple[Problem, ...]]:
    """The layout of ``data`` among those of the variant's interface, told by the selecting field; or why there is none."""
    candidates = [item for item in device.interface(variant.interface).layouts if item.sender == sender]
    if not candidates:
        return None, (Problem("range", "", f"the {sender} sends no frame over this interface"),)
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
        return None, (Problem("length", "", f"{counted(len(data), 'byte')}: too few to tell the frame by"),)
    choices = ", ".join(f"{value:X}" for value in sorted(allowed))
    return None, (Problem("range", layout.selector, f"{layout.selector} is {found:X}; it can be {choices}"),)


def _selected(placed: PlacedLayout, data: bytes) -> int | None:
    """The selecting field, counted from the start of the frame, which may be too short or too long; None where it is not in ``data``."""
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
    """A frame of whole bytes, its layout told by its selecting field."""
    placed, problems = select(device, variant, sender, data)
    return decode_placed(device, placed, data) if placed is not None else Decoded(None, 0, (), None, problems)


def decode_placed(device: Device, placed: PlacedLayout, data: bytes) -> Decoded:
    """A frame of whole bytes whose layout is known."""
    if 8 * len(data) != placed.bits:
        wrong = f"'{placed.name}' has {counted(placed.bits // 8, 'byte')}; this has {len(data)}"
        return Decoded(placed, number_from_bytes(placed.layout, data), (), None, (Problem("length", "", wrong),))
    return decode(device, placed, number_from_bytes(placed.layout, data))


def decode(device: Device, placed: PlacedLayout, number: int) -> Decoded:
    """Every field of ``number``, the CRC, and all faults."""
    if number >> placed.bits:
        wrong = f"'{placed.name}' has {placed.bits} bits; this has {number.bit_length()}"
        return Decoded(placed, number, (), None, (Problem("length", "", wrong),))
    problems: list[Problem] = []
    fields = []
    crc_result = None
    plain = from_gray(placed, number)
    for item in placed.fields:
        raw = number >> item.low & item.mask
        fields += _decode_field(item, raw, plain >> item.low & item.mask, problems)
        if item.field.kind == "parity":
            of = placed.field(item.field.parity_of)
            expected = (number >> of.low & of.mask).bit_count() & 1 if of is not None else 0
            if raw != expected:
                problems.append(Problem("constant", item.name, f"{item.name} is {raw}; for this {item.field.parity_of} it has to be {expected}"))
        elif item.field.kind == "crc":
            crc_result = CrcResult(item.field.crc, raw, compute(device.crc(item.field.crc), placed, number))
            if not crc_result.ok:
                problems.append(Problem("crc", item.name, f"the CRC is {raw:#04x}; over these bits it has to be {crc_result.computed:#04x}"))
        elif item.name == placed.layout.selector and raw not in placed.layout.selects:
            problems.append(Problem("range", item.name, f"{item.name} {raw:X} does not belong to this frame"))
    for join in placed.layout.joins:
        value = join_value(placed, join, plain)
        parts = " and ".join(name for name in join.fields if placed.field(name) is not None)
        fields.append(DecodedField(join.name, join_value(placed, join, number), value, "", f"{parts} as one number" if len(join.fields) > 1 else "", -1, -1))
    order = {"length": 0, "crc": 1, "constant": 2, "range": 3}
    return Decoded(placed, number, tuple(fields), crc_result, tuple(sorted(problems, key=lambda item: order[item.kind])))


def join_value(placed: PlacedLayout, join: Join, number: int) -> int:
    """The fields of a join as one number, the first of them most significant."""
    value = 0
    for name in join.fields:
        part = placed.field(name)
        if part is not None:
            value = value << part.width | number >> part.low & part.mask
    return value


def gray_to_binary(gray: int) -> int:
    """The number that ``gray`` stands for in reflected binary code."""
    binary = gray
    while gray := gray >> 1:
        binary ^= gray
    return binary


def binary_to_gray(binary: int) -> int:
    """``binary`` in reflected binary code."""
    return binary ^ binary >> 1


def from_gray(placed: PlacedLayout, number: int) -> int:
    """``number`` with the part that is sent in Gray code, if any, turned into binary."""
    return _with_part(placed, number, gray_to_binary)


def to_gray(placed: PlacedLayout, number: int) -> int:
    """``number`` with the part that is sent in Gray code, if any, turned into it."""
    return _with_part(placed, number, binary_to_gray)


def _with_part(placed: PlacedLayout, number: int, change: Callable[[int], int]) -> int:
    if not placed.gray:
        return number
    low, width = placed.place_of(placed.layout.gray_of)
    mask = (1 << width) - 1
    return number & ~(mask << low) | change(number >> low & mask) << low


def _decode_field(item: PlacedField, wire: int, raw: int, problems: list[Problem]) -> list[DecodedField]:
    """The field as a user reads it; ``wire`` is what was sent, ``raw`` the same out of Gray code."""
    field = item.field
    value: int | str | bool = raw
    if field.signed and raw >> (item.width - 1):
        value = raw - (1 << item.width)
    elif field.zero_means and raw == 0:
        value = field.zero_means
    meaning = field.meaning
    if field.kind == "flag":
        value = bool(raw) != field.active_low
        meaning = (field.when_active if value else field.when_inactive) or meaning
    elif field.kind == "choice":
        named = next((entry for entry in field.values if entry.value == raw), None)
        value, meaning = (named.name, named.meaning or meaning) if named is not None else (raw, meaning)
        if named is None:
            problems.append(Problem("range", item.name, f"{item.name} has no value {raw:#x}"))
    elif field.kind == "constant" and raw != field.constant:
        problems.append(Problem("constant", item.name, f"{item.name} is {raw:#x}; it is always {field.constant:#x}"))
    elif field.kind == "text":
        value = raw.to_bytes(item.width // 8, "big").decode("ascii", "replace")
    elif field.kind == "digits":
        if raw >= field.digits[0].divisor * field.digits[0].modulus:
            problems.append(Problem("range", item.name, f"{item.name} is {raw}, which has more than {sum(run.digits for run in field.digits)} digits"))
        runs = [DecodedField(run.name, raw // run.divisor % run.modulus, raw // run.divisor % run.modulus, "", run.meaning, item.high, item.low) for run in field.digits]
        return [DecodedField(item.name, raw, raw, field.unit, meaning, item.high, item.low), *runs]
    return [DecodedField(item.name, wire, value, field.unit, meaning, item.high, item.low)]


def compute(crc: Crc, placed: PlacedLayout, number: int) -> int:
    """The CRC that belongs to the other bits of ``number``."""
    if placed.layout.carried_as == "bytes":
        data = number_to_bytes(placed.layout, number, placed.bits)
        return compute_bytes(crc, data[: -(crc.width // 8)])
    return compute_bits(crc, number >> crc.width, placed.bits - crc.width)


def encode(device: Device, placed: PlacedLayout, values: Values) -> int:
    """The number whose fields have these values; constants, parity and CRC are filled in, a join may stand for its fields.

    Raises:
        EncodeError: A value is missing, unknown, or does not fit.
    """
    given = dict(values)
    for join in placed.layout.joins:
        if join.name in given:
            given |= _split(placed, join, _number(given.pop(join.name)), given)
    number = 0
    for item in placed.fields:
        number |= _raw(placed, item, given) << item.low
    left = [name for name in given if name not in _used(placed)]
    if left:
        raise EncodeError(f"there is no field '{left[0]}' in {placed.name}")
    absent = next((field.name for field in placed.layout.fields if given.get(field.name) and placed.field(field.name) is None), "")
    if absent:
        raise EncodeError(f"{absent} {given[absent]} does not fit: this order code has no such field")
    for item in placed.fields:
        if item.field.kind == "parity":
            of = placed.field(item.field.parity_of)
            number |= ((number >> of.low & of.mask).bit_count() & 1 if of is not None else 0) << item.low
    number = to_gray(placed, number)
    for item in placed.fields:
        if item.field.kind == "crc":
            number |= compute(device.crc(item.field.crc), placed, number) << item.low
    return number


def _used(placed: PlacedLayout) -> set[str]:
    names = {field.name for field in placed.layout.fields}
    return names | {run.name for field in placed.layout.fields for run in field.digits}


def _number(value: int | str | bool) -> int:
    if isinstance(value, str):
        raise EncodeError(f"'{value}' is no number")
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
    field = item.field
    if field.kind in ("constant",):
        return field.constant
    if field.kind in ("crc", "parity"):
        return 0
    if field.kind == "digits" and field.name not in given:
        return sum(_digits(field, given))
    if field.name not in given:
        if field.name == placed.layout.selector and len(placed.layout.selects) == 1:
            return placed.layout.selects[0]
        raise EncodeError(f"'{field.name}' is missing")
    value = given[field.name]
    if field.kind == "flag":
        return int(bool(value) != field.active_low)
    if field.kind == "choice" and isinstance(value, str):
        named = next((entry for entry in field.values if entry.name == value), None)
        if named is None:
            raise EncodeError(f"{field.name} has no value '{value}'")
        return named.value
    if field.kind == "text" and isinstance(value, str):
        raw = int.from_bytes(value.encode("ascii", "replace"), "big")
    else:
        raw = _number(value)
        if field.signed and -(1 << (item.width - 1)) <= raw < 1 << (item.width - 1):
            raw &= item.mask
        elif field.signed or (field.zero_means and raw == 0):
            raise EncodeError(f"{field.name} {raw} does not fit into {item.width} bits")
        elif field.zero_means and raw == field.zero_means:
            raw = 0
    if raw < 0 or raw > item.mask:
        raise EncodeError(f"{field.name} {raw} does not fit into {item.width} bits")
    if field.power_of_two and raw.bit_count() != 1:
        raise EncodeError(f"{field.name} {raw} is no power of two")
    return raw


def _digits(field: Field, given: Values) -> list[int]:
    parts = []
    for run in field.digits:
        value = _number(given.get(run.name, 0))
        if not 0 <= value < run.modulus:
            raise EncodeError(f"{run.name} {value} has more than {run.digits} digits")
        parts.append(value * run.divisor)
    return parts
