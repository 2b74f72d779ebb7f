"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from operator import itemgetter

from ..language.document import Path
from ..language.problems import listed
from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Field,
    Flag,
    Kind,
    Layout,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Register,
    Text,
    Unused,
    assert_never,
)
from ..order_codes.parameters import deciding_parameters
from ..say.names_and_places import bits
from .reading import Bit, Case, Fact, Facts, Parameters, Sort, Word, WordCase, as_delivered, in_hex, interface_label
from .stated import Subject


def add_names(subject: Subject, placed_field: PlacedField, owner: str | int, facts: Facts) -> None:
    """Add the names of a field of the frame or register ``owner``, and of the field's values."""
    name, place, bits_text = (
        placed_field.name,
        subject.place,
        f"{bits(placed_field.high, placed_field.low)} of '{owner}'",
    )
    span = placed_field.low, placed_field.width
    if place[-2:] == ("fields", name):
        facts.call(("field",), Fact(Sort.POSITION, span, name, f"name of {bits_text}", (*place, "name")))
    for value in placed_field.field.values:
        description, path = f"name of value {in_hex(value.value)} of {bits_text}", (*place, "values", value.name)
        fact = Fact(Sort.VALUE, (value.value,), value.name, description, subject.reading.first_existing(path, place))
        facts.call(("value", *span), fact)


def properties(
    subject: Subject, placed_field: PlacedField, parameters: Parameters, register: Register | None
) -> Iterator[Fact]:
    """Yield all properties of a field for these parameters, and of the ``register`` that may contain it."""
    field = placed_field.field
    yield from _of_kind(subject, field)
    if field.equals is not None:
        number = field.documented(parameters)
        value = in_hex(number) if isinstance(number, int) else str(number)
        yield subject.fact(Sort.VALUE, "equals", value, "fixed value")
    default, is_implied = (field.default, False) if register is None else _default(placed_field, register)
    if default is not None:
        yield replace(subject.fact(Sort.DEFAULT, "default", in_hex(default), "default"), implied=is_implied)
    yield from subject.stated_facts(field)


def _of_kind(subject: Subject, field: Field) -> Iterator[Fact]:
    reading = subject.reading
    for fact in subject.stated_facts(field.kind):
        # The verdict of a flag that the interface defines is not in the spec.
        is_verdict = fact.sort is Sort.VERDICT
        place = reading.first_existing(fact.place, subject.place) if is_verdict else fact.place
        yield replace(fact, place=place, mild=is_verdict and isinstance(field.kind, Unused))
    if isinstance(field.kind, CrcValue):
        crc = Subject(reading, ("crc",), ("crcs", field.kind.crc), f"the CRC over {interface_label(subject.interface)}")
        yield from crc.stated_facts(reading.device.crc(field.kind.crc))
    for named_value in field.values:
        place = reading.first_existing((*subject.place, "values", named_value.name), subject.place)
        value_subject = Subject(
            reading, ("value", named_value.value), place, f"value {in_hex(named_value.value)} of {subject.description}"
        )
        yield value_subject.existence(Sort.VALUE, "named")
        yield from value_subject.stated_facts(named_value)


def _default(placed_field: PlacedField, register: Register) -> tuple[int | None, bool]:
    """Return the default of a field, and True if the register's default implies it. None if both are the same."""
    own_default, register_default = placed_field.field.default, as_delivered(register)
    if register_default is None:
        return own_default, False
    if placed_field.width == 8 * register.length or not placed_field.field.carries_data:
        return None, False
    return (
        (own_default, False)
        if own_default is not None
        else (register_default >> placed_field.low & (1 << placed_field.width) - 1, True)
    )


def word(owner: Subject, layout: Layout, register: Register | None = None) -> Word:
    """Return a frame or register, which ``owner`` describes, in each case of its interface."""
    placed_by_values: dict[tuple[int, ...], WordCase] = {}
    deciding = deciding_parameters(layout)
    cases: dict[Case, WordCase] = {}
    for case, parameters in owner.reading.cases(owner.interface).items():
        values = tuple(parameters[name] for name in deciding)
        if values not in placed_by_values:
            placed_by_values[values] = _word_case(owner, layout.place(parameters), parameters, register)
        cases[case] = placed_by_values[values]
    return Word(owner.description, owner.place, cases)


def _word_case(owner: Subject, placed: PlacedLayout, parameters: Parameters, register: Register | None) -> WordCase:
    placed_bits = [Bit("unspecified", None, None, (*owner.place, "other_bits"))] * placed.bits
    fields = {}
    names = Facts()
    for placed_field in placed.fields:
        place, description = (
            owner.reading.field_place(owner.place, placed_field.field),
            f"{bits(placed_field.high, placed_field.low)} of {owner.description}",
        )
        for index, bit in enumerate(_bits(placed_field, placed, place), placed_field.low):
            placed_bits[index] = bit
        subject = Subject(owner.reading, (), place, description, owner.interface)
        facts = properties(subject, placed_field, parameters, register)
        fields[placed_field.low, placed_field.width] = {fact.key: fact for fact in facts}
        add_names(subject, placed_field, owner.place[-1], names)
    return WordCase(tuple(placed_bits), fields, names.names)


def _bits(placed_field: PlacedField, placed: PlacedLayout, place: Path) -> Iterator[Bit]:
    """Yield each bit of a field, lowest first."""
    kind = placed_field.field.kind
    part, offset = _owner_text(kind, placed_field, placed), 0
    joined = _weight_in_join(placed_field, placed)
    if joined is not None and isinstance(kind, (Number, Choice, Decimal, Flag)):
        offset = joined
    for index in range(placed_field.width):
        match kind:
            case Constant(value) | Unused(value):
                yield Bit(part, None, value >> index & 1, place)
            case Flag() | Parity() if joined is None:
                yield Bit(part, None, None, place)
            case Text():
                yield Bit(part, index % 8, None, place)
            case _:
                yield Bit(part, offset + index, None, place)


def _owner_text(kind: Kind, placed_field: PlacedField, placed: PlacedLayout) -> str:
    """Return the owner of the bits of a field."""
    match kind:
        case Number(signed=True):
            return "a signed number" + _gray(placed_field, placed)
        case Number() | Choice() | Decimal():
            return "a number" + _gray(placed_field, placed)
        case Flag():
            return "a flag"
        case Constant():
            return "constant"
        case Unused():
            return "unused"
        case CrcValue(_, covered):
            low, count = placed.crc_covers
            return f"the CRC of {bits(low + count - 1, low)}" if covered else "the CRC"
        case Parity(covered, odd, over):
            covered_bits = [_bits_of(placed, name) for name in covered]
            counted = f"the {over.replace('_', ' ')} of " if over else ""
            return f"{'odd' if odd else 'even'} parity of {counted}{listed(covered_bits)}"
        case Text():
            return "a character"
        case _:
            assert_never(kind)


def _bits_of(placed: PlacedLayout, name: str) -> str:
    """Return the bits of a field, or its name if the order code has no such field."""
    placed_field = placed.find_field(name)
    return bits(placed_field.high, placed_field.low) if placed_field is not None else name


def _gray(placed_field: PlacedField, placed: PlacedLayout) -> str:
    return " in Gray code" if placed.gray and placed_field.name in placed.layout.names_in(placed.layout.gray_of) else ""


def _weight_in_join(placed_field: PlacedField, placed: PlacedLayout) -> int | None:
    """Return the weight of the field's lowest bit in the longest joined number that contains it, or None."""
    weights: list[tuple[int, int | None]] = [(0, None)]
    for join in placed.layout.joins:
        if placed_field.name in join.fields:
            parts = placed.find_fields(join.fields)
            below = parts[parts.index(placed_field) + 1 :]
            width = sum(part.width for part in parts)
            weights.append((width, sum(part.width for part in below)))
    return max(weights, key=itemgetter(0))[1]


def describe_bits(adjacent_bits: Sequence[Bit]) -> str:
    """Describe adjacent bits, highest first: ``bits 7:0 of a number``, ``constant 0010``."""
    first, last = adjacent_bits[0], adjacent_bits[-1]
    if first.fixed is not None:
        return f"{first.part} {''.join(str(bit.fixed) for bit in adjacent_bits)}"
    if first.weight is None or last.weight is None:
        return first.part
    return f"{bits(first.weight, last.weight)} of {first.part}"


def continues_item(bit: Bit, above: Bit) -> bool:
    """Return True if a bit continues the same item as ``above``, the next higher bit."""
    if (bit.part, bit.place) != (above.part, above.place) or (bit.fixed is None) is not (above.fixed is None):
        return False
    return bit.weight is None or above.weight is None or bit.weight + 1 == above.weight
