"""Encode and decode using only the model, for the command line and as a reference for testing all generated codecs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Fault,
    Field,
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
)
from ..model.device import PositionRange
from ..model.record import dataclass
from ..say import report
from ..say.layout import as_one_number
from ..say.plain_text import counted
from .bits import compute, documented_bits, from_gray, join_value, parity_bit, to_gray, unused_bits

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
        return {field.name: field.value for field in self.fields}


def number_of_text(text: str) -> int:
    """Return the bits of a text field as one number. Latin-1 has a character for every byte."""
    return int.from_bytes(text.encode("latin-1", "replace"), "big")


def select(
    device: Device, variant: Variant, sender: str, data: bytes
) -> tuple[PlacedLayout | None, tuple[Problem, ...]]:
    """Return the layout of ``data``, identified by the selector field, or the reason why there is none."""
    candidates = [layout for layout in device.interface(variant.interface).layouts if layout.sender == sender]
    if not candidates:
        return None, (Problem(Fault.RANGE, "", f"the {sender} sends no frames on this interface"),)
    allowed: list[int] = []
    for layout in candidates:
        placed = layout.place(variant.parameters)
        if not layout.selector:
            return placed, ()
        allowed.extend(layout.selects)
        if _selected_value(placed, data) in layout.selects:
            return placed, ()
    layout = candidates[0]
    selected_value = _selected_value(layout.place(variant.parameters), data)
    if selected_value is None:
        return None, (Problem(Fault.LENGTH, "", report.too_few_bytes(counted(len(data), "byte"))),)
    choices = ", ".join(f"{value:X}" for value in sorted(allowed))
    message = report.no_frame(layout.selector, f"{selected_value:X}", choices)
    return None, (Problem(Fault.RANGE, layout.selector, message),)


def _selected_value(placed: PlacedLayout, data: bytes) -> int | None:
    """Return the value of the selector field, or None if ``data`` is too short for it. Longer data is accepted."""
    selector = placed.find_field(placed.layout.selector)
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


def _other_length(placed: PlacedLayout, number: int, needed: str, length_text: int) -> Decoded:
    message = report.length(placed.name, needed, f"{length_text}")
    return Decoded(placed, number, (), None, (Problem(Fault.LENGTH, "", message),))


def decode(device: Device, placed: PlacedLayout, number: int) -> Decoded:
    """Decode ``number`` into all fields and the CRC, and find all errors."""
    if number >> placed.bits:
        return _other_length(placed, number, f"{placed.bits} bits", number.bit_length())
    problems: list[Problem] = []
    fields = []
    plain = from_gray(placed, number)
    for placed_field in placed.fields:
        raw = number >> placed_field.low & placed_field.mask
        fields += _decode_field(placed_field, raw, plain >> placed_field.low & placed_field.mask, problems)
        if isinstance(placed_field.field.kind, Parity):
            expected = parity_bit(placed, placed_field.field.kind, number)
            if raw != expected:
                message = report.parity(
                    placed_field.name, f"{raw}", ", ".join(placed_field.field.kind.of), f"{expected}"
                )
                problems.append(Problem(Fault.CONSTANT, placed_field.name, message))
        elif placed_field.name == placed.layout.selector and raw not in placed.layout.selects:
            problems.append(
                Problem(Fault.RANGE, placed_field.name, report.of_other_frame(placed_field.name, f"{raw:X}"))
            )
    valid = device.range_in(placed.layout)
    limited = placed.find_field(valid.field.name) if valid is not None else None
    if valid is not None and limited is not None:
        message = _range_message(valid, limited, plain >> limited.low & limited.mask, placed)
        if message:
            problems.append(Problem(Fault.RANGE, limited.name, message))
    crc = _decode_crc(device, placed, number, problems)
    fields += [_decode_join(placed, join, number, plain) for join in placed.layout.joins]
    if placed.layout.has_unused:
        bits = unused_bits(placed, number)
        fields.append(DecodedField(UNUSED, bits, bits, "", "unused bits that differ from the manual", -1, -1))
    if problems:
        problems.sort(key=lambda problem: list(Fault).index(problem.fault))
    return Decoded(placed, number, tuple(fields), crc, tuple(problems))


def _range_message(valid: PositionRange, placed_field: PlacedField, raw: int, placed: PlacedLayout) -> str:
    """Return the error if the encoder does not have this position, or an empty string."""
    lowest, highest = valid.lowest.value(placed.parameters), valid.highest.value(placed.parameters)
    position = _number_of(placed_field.field.number, raw, placed_field.width)
    if lowest <= position <= highest:
        return ""
    if placed_field.field.number.signed:
        return report.outside(f"{placed_field.name} {position}", f"{lowest}", f"{highest}")
    return report.too_high(placed_field.name, f"{position}", f"{highest}")


def _decode_crc(device: Device, placed: PlacedLayout, number: int, problems: list[Problem]) -> CrcResult | None:
    placed_field, crc = placed.crc_field, device.crc_of(placed)
    if placed_field is None or crc is None:
        return None
    result = CrcResult(crc.name, number >> placed_field.low & placed_field.mask, compute(crc, placed, number))
    if not result.ok:
        message = report.crc(f"{result.received:#04x}", f"{result.computed:#04x}")
        problems.append(Problem(Fault.CRC, placed_field.name, message))
    return result


def _decode_join(placed: PlacedLayout, join: Join, number: int, plain: int) -> DecodedField:
    parts = " and ".join(field.name for field in placed.find_fields(join.fields))
    meaning = as_one_number(parts) if len(join.fields) > 1 else ""
    value = join_value(placed, join, plain)
    raw = join_value(placed, join, number) if placed.gray else value
    return DecodedField(join.name, raw, value, "", meaning, -1, -1)


def _decode_field(placed_field: PlacedField, wire: int, raw: int, problems: list[Problem]) -> list[DecodedField]:
    """Decode a field for the user. ``wire`` is the number as sent, ``raw`` the same number converted from Gray code."""
    field, high, low = placed_field.field, placed_field.high, placed_field.low
    problem = _value_problem(field, raw)
    if problem is not None:
        problems.append(problem)
    value, meaning = _value_and_meaning(field, raw, placed_field.width)
    decoded_fields = [DecodedField(field.name, wire, value, field.unit, meaning, high, low, field.scale)]
    for run in field.runs:
        part = raw // run.divisor % run.modulus
        decoded_fields.append(DecodedField(run.name, part, part, "", run.meaning, high, low))
    return decoded_fields


def _value_and_meaning(field: Field, raw: int, width: int) -> tuple[int | str | bool, str]:
    """Return what a number in a field stands for. Numbers that are not valid stand for themselves."""
    match field.kind:
        case Number() as number:
            return _number_of(number, raw, width), field.meaning
        case Flag() as flag:
            is_active = bool(raw) != flag.active_low
            return is_active, (flag.when_active if is_active else flag.when_inactive) or field.meaning
        case Choice(values):
            named_value = next((candidate for candidate in values if candidate.value == raw), None)
            return (
                (raw, field.meaning)
                if named_value is None
                else (named_value.name, named_value.meaning or field.meaning)
            )
        case Text():
            return raw.to_bytes(width // 8, "big").decode("latin-1"), field.meaning
        case Constant() | Decimal() | Unused() | CrcValue() | Parity():
            return raw, field.meaning
        case _ as kind:
            assert_never(kind)


def _value_problem(field: Field, raw: int) -> Problem | None:
    """Return the error if a number is not valid in a field. CRC and parity are checked when all fields are known."""
    name = field.name
    match field.kind:
        case Choice(values) if all(candidate.value != raw for candidate in values):
            return Problem(Fault.RANGE, name, report.no_value(name, f"{raw:#x}"))
        case Constant(constant) if raw != constant:
            return Problem(Fault.CONSTANT, name, report.constant(name, f"{raw:#x}", f"{constant:#x}"))
        case Decimal() as decimal if raw >= decimal.limit:
            return Problem(Fault.RANGE, name, report.digits(name, f"{raw}", f"{decimal.digits}"))
        case _:
            return None


def _number_of(number: Number, raw: int, width: int) -> int:
    if number.signed and raw >> (width - 1):
        return raw - (1 << width)
    return raw or number.zero_means


def encode(device: Device, placed: PlacedLayout, values: Values) -> int:
    """Encode these values.

    Constants, parity and CRC are filled in. The value of a join can replace those of its fields. Unused bits are as in
    the manual, except for those that ``unused`` inverts.

    Raises:
        EncodeError: A value is missing, unknown, or does not fit.
    """
    remaining = dict(values)
    for join in placed.layout.joins:
        if join.name in remaining:
            remaining |= _split(placed, join, _number(remaining.pop(join.name)), remaining)
    number = _encode_fields(device, placed, remaining)
    if placed.layout.unused:
        number |= _unused(placed, _number(remaining.pop(UNUSED, 0)))
    _check_names(placed, remaining)
    number = to_gray(placed, number)
    for placed_field in placed.fields:
        if isinstance(placed_field.field.kind, Parity):
            number |= parity_bit(placed, placed_field.field.kind, number) << placed_field.low
    crc_field, crc = placed.crc_field, device.crc_of(placed)
    if crc_field is not None and crc is not None:
        number |= compute(crc, placed, number) << crc_field.low
    return number


def _encode_fields(device: Device, placed: PlacedLayout, values: Values) -> int:
    """Return the bits of all fields except parity, CRC and unused ones."""
    number, valid = 0, device.range_in(placed.layout)
    for placed_field in placed.fields:
        raw = _raw(placed, placed_field, values)
        if valid is not None and placed_field.name == valid.field.name:
            problem = _range_message(valid, placed_field, raw, placed)
            if problem:
                raise EncodeError(problem)
        number |= raw << placed_field.low
    return number


def _check_names(placed: PlacedLayout, values: Values) -> None:
    """Check that each value belongs to a field, and that the fields that this order code lacks have none."""
    used_names = _used_names(placed)
    for name in values:
        if name not in used_names:
            raise EncodeError(f"there is no field '{name}' in {placed.name}")
    for field in placed.layout.fields:
        if values.get(field.name) and placed.find_field(field.name) is None:
            raise EncodeError(f"{field.name} {values[field.name]} does not fit: this order code has no such field")


def _used_names(placed: PlacedLayout) -> set[str]:
    names = {field.name for field in placed.layout.fields}
    return names | {run.name for field in placed.layout.fields for run in field.runs}


def _unused(placed: PlacedLayout, inverted: int) -> int:
    """Return the unused bits at their positions in the frame: the manual's values, except those ``inverted``."""
    number = 0
    for placed_field, low_bit in placed.unused:
        number |= (inverted >> low_bit & placed_field.mask ^ documented_bits(placed_field)) << placed_field.low
        inverted &= ~(placed_field.mask << low_bit)
    if inverted:
        raise EncodeError(f"'{UNUSED}' has the bits {inverted:#x}, which are not unused bits of {placed.name}")
    return number


def _number(value: int | str | bool) -> int:
    if isinstance(value, str):
        raise EncodeError(f"'{value}' is not a number")
    return int(value)


def _split(placed: PlacedLayout, join: Join, value: int, values: Values) -> dict[str, int]:
    parts: dict[str, int] = {}
    remaining_bits = value
    for name in reversed(join.fields):
        placed_field = placed.find_field(name)
        width = placed_field.width if placed_field is not None else 0
        parts[name] = remaining_bits & ((1 << width) - 1)
        remaining_bits >>= width
    if remaining_bits or value < 0:
        raise EncodeError(f"{join.name} {value} does not fit")
    if any(name in values and values[name] != parts[name] for name in parts):
        raise EncodeError(f"{join.name} and its fields disagree")
    return parts


def _raw(placed: PlacedLayout, placed_field: PlacedField, values: Values) -> int:
    """Return the bits of one field. CRC and parity are computed later from the others."""
    name, kind = placed_field.name, placed_field.field.kind
    if isinstance(kind, Constant):
        return kind.value
    if isinstance(kind, (Unused, CrcValue, Parity)):
        return 0
    if isinstance(kind, Decimal) and name not in values:
        return sum(_digit_parts(kind, values))
    if name not in values:
        if name == placed.layout.selector and len(placed.layout.selects) == 1:
            return placed.layout.selects[0]
        raise EncodeError(f"'{name}' is missing")
    raw = _raw_value(kind, placed_field, values[name])
    if raw < 0 or raw > placed_field.mask:
        raise EncodeError(report.too_wide(name, f"{raw}", f"{placed_field.width}"))
    return raw


def _raw_value(
    kind: Number | Flag | Choice | Text | Decimal, placed_field: PlacedField, value: int | str | bool
) -> int:
    """Return the number that stands for a value of a field."""
    match kind:
        case Number():
            return _bits_of(kind, placed_field, _number(value))
        case Flag():
            return int(bool(value) != kind.active_low)
        case Choice(named_values):
            return _value_of_name(placed_field.name, named_values, value) if isinstance(value, str) else _number(value)
        case Text():
            return number_of_text(value) if isinstance(value, str) else _number(value)
        case Decimal():
            return _number(value)
        case _:
            assert_never(kind)


def _bits_of(number: Number, placed_field: PlacedField, value: int) -> int:
    raw = 0 if value == number.zero_means else value & placed_field.mask
    if _number_of(number, raw, placed_field.width) != value:
        raise EncodeError(report.too_wide(placed_field.name, f"{value}", f"{placed_field.width}"))
    if number.power_of_two and value.bit_count() != 1:
        raise EncodeError(report.no_power_of_two(placed_field.name, f"{value}"))
    return raw


def _value_of_name(name: str, values: Sequence[Value], value: str) -> int:
    named_value = next((candidate for candidate in values if candidate.name == value), None)
    if named_value is None:
        raise EncodeError(f"{name} has no value '{value}'")
    return named_value.value


def _digit_parts(decimal: Decimal, values: Values) -> Iterator[int]:
    """Yield the value of each run of digits, multiplied by its divisor."""
    for run in decimal.runs:
        value = _number(values.get(run.name, 0))
        if not 0 <= value < run.modulus:
            raise EncodeError(f"{run.name} {value} has more than {run.digits} digits")
        yield value * run.divisor
