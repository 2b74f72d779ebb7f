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
    yield from _facts_of_kind(subject, field)
    if field.equals is not None:
        fixed_value = field.documented(parameters)
        value_text = in_hex(fixed_value) if isinstance(fixed_value, int) else str(fixed_value)
        yield subject.detail_fact(Sort.VALUE, "equals", value_text, "fixed value")
    if register is None:
        default, is_implied = field.default, False
    else:
        default, is_implied = _default_and_is_implied(placed_field, register)
    if default is not None:
        yield replace(subject.detail_fact(Sort.DEFAULT, "default", in_hex(default), "default"), is_implied=is_implied)
    yield from subject.stated_facts(field)


def _facts_of_kind(subject: Subject, field: Field) -> Iterator[Fact]:
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
        yield value_subject.existence_fact(Sort.VALUE, "named")
        yield from value_subject.stated_facts(named_value)


def _default_and_is_implied(placed_field: PlacedField, register: Register) -> tuple[int | None, bool]:
    """Return the default of a field, and True if the register's default implies it. None if both are the same."""
    stated_default, register_default = placed_field.field.default, as_delivered(register)
    if register_default is None:
        return stated_default, False
    is_whole_register = placed_field.width == 8 * register.length
    if is_whole_register or not placed_field.field.carries_data:
        return None, False
    if stated_default is not None:
        return stated_default, False
    default_in_register = register_default >> placed_field.low & placed_field.mask
    return default_in_register, True


def word(owner: Subject, layout: Layout, register: Register | None = None) -> Word:
    """Return a frame or register, which ``owner`` describes, in each case of its interface."""
    deciding_names = deciding_parameters(layout)
    word_case_by_values: dict[tuple[int, ...], WordCase] = {}
    word_cases: dict[Case, WordCase] = {}
    for case, parameters in owner.reading.cases(owner.interface).items():
        deciding_values = tuple(parameters[name] for name in deciding_names)
        if deciding_values not in word_case_by_values:
            word_case = _word_case(owner, layout.place(parameters), parameters, register)
            word_case_by_values[deciding_values] = word_case
        word_cases[case] = word_case_by_values[deciding_values]
    return Word(description=owner.description, place=owner.place, cases=word_cases)


def _word_case(
    owner: Subject, placed_layout: PlacedLayout, parameters: Parameters, register: Register | None
) -> WordCase:
    """Return the bits, the properties of the fields and their names for these parameters."""
    unspecified_bit = Bit(part="unspecified", weight=None, fixed=None, place=(*owner.place, "other_bits"))
    placed_bits = [unspecified_bit] * placed_layout.bits
    properties_by_span = {}
    names = Facts()
    for placed_field in placed_layout.fields:
        place = owner.reading.field_place(owner.place, placed_field.field)
        description = f"{bits(placed_field.high, placed_field.low)} of {owner.description}"
        placed_bits[placed_field.low : placed_field.high + 1] = _bits(placed_field, placed_layout, place)
        subject = Subject(owner.reading, key=(), place=place, description=description, interface=owner.interface)
        facts = properties(subject, placed_field, parameters, register)
        properties_by_span[placed_field.low, placed_field.width] = {fact.key: fact for fact in facts}
        add_names(subject, placed_field, owner.place[-1], names)
    return WordCase(bits=tuple(placed_bits), fields=properties_by_span, names=names.names)


def _bits(placed_field: PlacedField, placed_layout: PlacedLayout, place: Path) -> Iterator[Bit]:
    """Yield each bit of a field, lowest first."""
    kind = placed_field.field.kind
    part = _owner_text(kind, placed_field, placed_layout)
    weight_in_join = _weight_in_join(placed_field, placed_layout)
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


def _owner_text(kind: Kind, placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return the owner of the bits of a field."""
    match kind:
        case Number(signed=True):
            return "a signed number" + _gray_suffix(placed_field, placed_layout)
        case Number() | Choice() | Decimal():
            return "a number" + _gray_suffix(placed_field, placed_layout)
        case Flag():
            return "a flag"
        case Constant():
            return "constant"
        case Unused():
            return "unused"
        case CrcValue(_, covered):
            if not covered:
                return "the CRC"
            low, count = placed_layout.crc_covers
            return f"the CRC of {bits(low + count - 1, low)}"
        case Parity():
            return _parity_text(kind, placed_layout)
        case Text():
            return "a character"
        case _:
            assert_never(kind)


def _parity_text(parity: Parity, placed_layout: PlacedLayout) -> str:
    """Return text such as ``odd parity of bits 7:0``, or of their ``one bits`` if the parity is over those."""
    polarity = "odd" if parity.odd else "even"
    covered_bits = listed([_bits_of(placed_layout, name) for name in parity.of])
    if not parity.over:
        return f"{polarity} parity of {covered_bits}"
    counted_words = parity.over.replace("_", " ")
    return f"{polarity} parity of the {counted_words} of {covered_bits}"


def _bits_of(placed_layout: PlacedLayout, name: str) -> str:
    """Return the bits of a field, or its name if the order code has no such field."""
    placed_field = placed_layout.find_field(name)
    return bits(placed_field.high, placed_field.low) if placed_field is not None else name


def _gray_suffix(placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return `` in Gray code`` for a field that is sent so, or an empty string."""
    is_gray = placed_layout.gray and placed_field.name in placed_layout.layout.names_in(placed_layout.layout.gray_of)
    return " in Gray code" if is_gray else ""


def _weight_in_join(placed_field: PlacedField, placed_layout: PlacedLayout) -> int | None:
    """Return the weight of the field's lowest bit in the longest joined number that contains it, or None."""
    longest_bits, weight = 0, None
    for join in placed_layout.layout.joins:
        if placed_field.name not in join.fields:
            continue
        # The most significant field is the first.
        fields = placed_layout.find_fields(join.fields)
        lower_fields = fields[fields.index(placed_field) + 1 :]
        total_bits = sum(field.width for field in fields)
        if total_bits > longest_bits:
            longest_bits, weight = total_bits, sum(field.width for field in lower_fields)
    return weight


def describe_bits(adjacent_bits: Sequence[Bit]) -> str:
    """Describe adjacent bits, highest first: ``bits 7:0 of a number``, ``constant 0010``."""
    first, last = adjacent_bits[0], adjacent_bits[-1]
    if first.fixed is not None:
        digits = "".join(str(bit.fixed) for bit in adjacent_bits)
        return f"{first.part} {digits}"
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
