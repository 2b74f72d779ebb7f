"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

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
    field_name, place = placed_field.name, subject.place
    bits_text = f"{bits(placed_field.high, placed_field.low)} of '{owner}'"
    span = placed_field.low, placed_field.width
    # Fields of a group, and fields that the build adds, have no name at this place.
    if place[-2:] == ("fields", field_name):
        name_fact = Fact(
            sort=Sort.POSITION,
            key=span,
            value=field_name,
            description=f"name of {bits_text}",
            place=(*place, "name"),
        )
        facts.add_name(("field",), name_fact)
    for value in placed_field.field.values:
        value_name_fact = Fact(
            sort=Sort.VALUE,
            key=(value.value,),
            value=value.name,
            description=f"name of value {in_hex(value.value)} of {bits_text}",
            place=subject.reading.first_existing((*place, "values", value.name), place),
        )
        facts.add_name(("value", *span), value_name_fact)


def properties(
    subject: Subject, placed_field: PlacedField, parameters: Parameters, register: Register | None
) -> Iterator[Fact]:
    """Yield all properties of a field for these parameters, and of the ``register`` that may contain it."""
    field = placed_field.field
    yield from _of_kind(subject, field)
    if field.equals is not None:
        fixed_value = field.documented(parameters)
        value_text = in_hex(fixed_value) if isinstance(fixed_value, int) else str(fixed_value)
        yield subject.fact(Sort.VALUE, "equals", value_text, "fixed value")
    if register is None:
        default, is_implied = field.default, False
    else:
        default, is_implied = _default(placed_field, register)
    if default is not None:
        yield replace(subject.fact(Sort.DEFAULT, "default", in_hex(default), "default"), is_implied=is_implied)
    yield from subject.stated_facts(field)


def _of_kind(subject: Subject, field: Field) -> Iterator[Fact]:
    """Yield the facts that depend on the kind of the field: about its bits, its CRC, and its values."""
    reading = subject.reading
    for fact in subject.stated_facts(field.kind):
        if fact.sort is Sort.VERDICT:
            # The verdict of a flag that the interface defines is not in the spec.
            place = reading.first_existing(fact.place, subject.place)
            yield replace(fact, place=place, may_be_missing=isinstance(field.kind, Unused))
        else:
            yield replace(fact, may_be_missing=False)
    if isinstance(field.kind, CrcValue):
        crc_text = f"the CRC over {interface_label(subject.interface)}"
        crc_subject = Subject(reading, key=("crc",), place=("crcs", field.kind.crc), description=crc_text)
        yield from crc_subject.stated_facts(reading.device.crc(field.kind.crc))
    for named_value in field.values:
        value_subject = Subject(
            reading,
            key=("value", named_value.value),
            place=reading.first_existing((*subject.place, "values", named_value.name), subject.place),
            description=f"value {in_hex(named_value.value)} of {subject.description}",
        )
        yield value_subject.existence(Sort.VALUE, "named")
        yield from value_subject.stated_facts(named_value)


def _default(placed_field: PlacedField, register: Register) -> tuple[int | None, bool]:
    """Return the default of a field, and True if the register's default implies it. None if both are the same."""
    stated_default, register_default = placed_field.field.default, as_delivered(register)
    if register_default is None:
        return stated_default, False
    is_whole_register = placed_field.width == 8 * register.length
    if is_whole_register or not placed_field.field.carries_data:
        return None, False
    if stated_default is not None:
        return stated_default, False
    return register_default >> placed_field.low & placed_field.mask, True


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
    properties_by_span = {}
    names = Facts()
    for placed_field in placed.fields:
        place = owner.reading.field_place(owner.place, placed_field.field)
        description = f"{bits(placed_field.high, placed_field.low)} of {owner.description}"
        placed_bits[placed_field.low : placed_field.high + 1] = _bits(placed_field, placed, place)
        subject = Subject(owner.reading, key=(), place=place, description=description, interface=owner.interface)
        facts = properties(subject, placed_field, parameters, register)
        properties_by_span[placed_field.low, placed_field.width] = {fact.key: fact for fact in facts}
        add_names(subject, placed_field, owner.place[-1], names)
    return WordCase(tuple(placed_bits), properties_by_span, names.names)


def _bits(placed_field: PlacedField, placed: PlacedLayout, place: Path) -> Iterator[Bit]:
    """Yield each bit of a field, lowest first."""
    kind = placed_field.field.kind
    part = _owner_text(kind, placed_field, placed)
    weight_in_join = _weight_in_join(placed_field, placed)
    lowest_weight = 0
    if weight_in_join is not None and isinstance(kind, (Number, Choice, Decimal, Flag)):
        lowest_weight = weight_in_join
    for index in range(placed_field.width):
        match kind:
            case Constant(value) | Unused(value):
                yield Bit(part, weight=None, fixed=value >> index & 1, place=place)
            case Flag() | Parity() if weight_in_join is None:
                yield Bit(part, weight=None, fixed=None, place=place)
            case Text():
                yield Bit(part, weight=index % 8, fixed=None, place=place)
            case _:
                yield Bit(part, weight=lowest_weight + index, fixed=None, place=place)


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
        case Parity():
            return _parity_text(kind, placed)
        case Text():
            return "a character"
        case _:
            assert_never(kind)


def _parity_text(parity: Parity, placed: PlacedLayout) -> str:
    """Return text such as ``odd parity of bits 7:0``, or of their ``one bits`` if the parity is over those."""
    polarity = "odd" if parity.odd else "even"
    counted = f"the {parity.over.replace('_', ' ')} of " if parity.over else ""
    covered_bits = [_bits_of(placed, name) for name in parity.of]
    return f"{polarity} parity of {counted}{listed(covered_bits)}"


def _bits_of(placed: PlacedLayout, name: str) -> str:
    """Return the bits of a field, or its name if the order code has no such field."""
    placed_field = placed.find_field(name)
    return bits(placed_field.high, placed_field.low) if placed_field is not None else name


def _gray(placed_field: PlacedField, placed: PlacedLayout) -> str:
    is_gray = placed.gray and placed_field.name in placed.layout.names_in(placed.layout.gray_of)
    return " in Gray code" if is_gray else ""


def _weight_in_join(placed_field: PlacedField, placed: PlacedLayout) -> int | None:
    """Return the weight of the field's lowest bit in the longest joined number that contains it, or None."""
    longest_bits, weight = 0, None
    for join in placed.layout.joins:
        if placed_field.name not in join.fields:
            continue
        # The most significant field is the first.
        fields = placed.find_fields(join.fields)
        lower_fields = fields[fields.index(placed_field) + 1 :]
        total_bits = sum(field.width for field in fields)
        if total_bits > longest_bits:
            longest_bits, weight = total_bits, sum(field.width for field in lower_fields)
    return weight


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
    if (bit.part, bit.place) != (above.part, above.place):
        return False
    is_constant, is_constant_above = bit.fixed is not None, above.fixed is not None
    if is_constant is not is_constant_above:
        return False
    return bit.weight is None or above.weight is None or bit.weight + 1 == above.weight
