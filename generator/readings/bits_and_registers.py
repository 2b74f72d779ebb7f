"""Facts about registers, and about the bits of frames and registers: levels, values, limits, CRCs and verdicts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain

from ..language.document import Path
from ..language.problems import join_words
from ..model import (
    Constant,
    CrcValue,
    Field,
    Flag,
    Kind,
    Layout,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Register,
    RegisterMeaning,
    Text,
    Unused,
)
from ..model.registers import name_with_limits
from ..order_codes.parameters import deciding_parameters
from ..say import count_with_unit
from ..say.names_and_evidence import bits
from .reading import (
    NOTHING,
    BitMeaning,
    CodeAndState,
    ComparedFact,
    ComparedFacts,
    FactClass,
    Parameters,
    SpecReading,
    WordBits,
    WordCase,
    as_delivered,
    in_hex,
    interface_label,
    register_text,
)
from .stated import FactSubject


def add_names(subject: FactSubject, placed_field: PlacedField, owner: str | int, facts: ComparedFacts) -> None:
    """Add the names of a field and of its values to ``facts``, to compare them with the names in the other reading.

    ``owner`` is the name of the frame or register. A field is identified by its lowest bit and its width, such as
    ``(3, 5)``, and a value by its number and its field. Names of fields that are not at this place of the spec, such as
    fields of a group, are left out.
    """
    field_name = placed_field.name
    path_in_file = subject.path_in_file
    bits_text = f"{bits(placed_field.highest_bit, placed_field.lowest_bit)} of '{owner}'"
    low_and_width = placed_field.lowest_bit, placed_field.width
    has_name_at_place = path_in_file[-2:] == ("fields", field_name)
    if has_name_at_place:
        name_fact = ComparedFact(
            fact_class=FactClass.POSITION,
            key=low_and_width,
            value=field_name,
            description=f"name of {bits_text}",
            path_in_file=(*path_in_file, "name"),
        )
        facts.add_name(("field",), name_fact)
    for named_value in placed_field.field.values:
        value_name_fact = ComparedFact(
            fact_class=FactClass.VALUE,
            key=(named_value.value,),
            value=named_value.name,
            description=f"name of value {in_hex(named_value.value)} of {bits_text}",
            path_in_file=subject.reading.first_existing((*path_in_file, "values", named_value.name), path_in_file),
        )
        facts.add_name(("value", *low_and_width), value_name_fact)


def properties(
    subject: FactSubject, placed_field: PlacedField, parameters: Parameters, register: Register | None
) -> Iterator[ComparedFact]:
    """Yield the facts about a field other than its bits: its kind, its documented value, its default and so on.

    ``parameters`` are the parameters of an order code. ``register`` is the register that contains the field, or None
    for a field of a frame.
    """
    field = placed_field.field
    yield from _facts_of_kind(subject, field)
    if field.equals is not None:
        fixed_value = field.documented(parameters)
        value_text = in_hex(fixed_value) if isinstance(fixed_value, int) else str(fixed_value)
        yield subject.detail_fact(FactClass.VALUE, name="equals", value=value_text, noun="fixed value")
    if register is None:
        default, is_implied = field.default, False
    else:
        default, is_implied = _default_and_is_implied(placed_field, register)
    if default is not None:
        yield replace(
            subject.detail_fact(FactClass.DEFAULT, name="default", value=in_hex(default), noun="default"),
            is_implied=is_implied,
        )
    yield from subject.stated_facts(field)


def _facts_of_kind(subject: FactSubject, field: Field) -> Iterator[ComparedFact]:
    """Yield the facts that depend on the kind of a field: the members of its kind, its CRC, and its named values.

    Both readings must state these facts, except the verdict of unused bits (``may_be_missing``).
    """
    reading = subject.reading
    for fact in subject.stated_facts(field.kind):
        if fact.fact_class is FactClass.VERDICT:
            # If the interface defines the verdict of a flag, it is not in the spec.
            verdict_path = reading.first_existing(fact.path_in_file, subject.path_in_file)
            yield replace(fact, path_in_file=verdict_path, may_be_missing=isinstance(field.kind, Unused))
        else:
            yield replace(fact, may_be_missing=False)
    if isinstance(field.kind, CrcValue):
        crc_text = f"the CRC over {interface_label(subject.interface)}"
        crc_subject = FactSubject(reading, key=("crc",), path_in_file=("crcs", field.kind.crc), description=crc_text)
        yield from crc_subject.stated_facts(reading.device.crc(field.kind.crc))
    for named_value in field.values:
        value_subject = FactSubject(
            reading,
            key=("value", named_value.value),
            path_in_file=reading.first_existing(
                (*subject.path_in_file, "values", named_value.name), subject.path_in_file
            ),
            description=f"value {in_hex(named_value.value)} of {subject.description}",
        )
        yield value_subject.existence_fact(FactClass.VALUE, "named")
        yield from value_subject.stated_facts(named_value)


def _default_and_is_implied(placed_field: PlacedField, register: Register) -> tuple[int | None, bool]:
    """Return the default of a field in a register, and whether the default of the register implies it.

    For example ``(3, True)``. The default is None if the field has no data, or if it is the whole register, whose
    default is a fact about the register.
    """
    stated_default = placed_field.field.default
    register_default = as_delivered(register)
    if register_default is None:
        return stated_default, False
    is_whole_register = placed_field.width == 8 * register.length
    if is_whole_register or not placed_field.field.carries_data:
        return None, False
    if stated_default is not None:
        return stated_default, False
    default_in_register = (register_default >> placed_field.lowest_bit) & placed_field.mask
    return default_in_register, True


def word_bits(owner: FactSubject, layout: Layout, register: Register | None = None) -> WordBits:
    """Return the bits of a frame or register in each case, for comparing them with the other reading.

    A case is an order code with a state of its registers. Cases with the same layout share one object. ``register`` is
    None for a frame.
    """
    deciding_names = deciding_parameters(layout)
    word_case_by_values: dict[tuple[int, ...], WordCase] = {}
    word_cases: dict[CodeAndState, WordCase] = {}
    for case, parameters in owner.reading.cases(owner.interface).items():
        deciding_values = tuple(parameters[name] for name in deciding_names)
        if deciding_values not in word_case_by_values:
            word_case = _word_case(owner, layout.place(parameters), parameters, register)
            word_case_by_values[deciding_values] = word_case
        word_cases[case] = word_case_by_values[deciding_values]
    return WordBits(description=owner.description, path_in_file=owner.path_in_file, cases=word_cases)


def _word_case(
    owner: FactSubject, placed_layout: PlacedLayout, parameters: Parameters, register: Register | None
) -> WordCase:
    """Return the bits of a frame or register for these parameters, with the properties and the names of its fields.

    The bits begin with bit 0. Bits that belong to no field are "unspecified".
    """
    unspecified_bit = BitMeaning(
        part="unspecified", weight=None, fixed=None, path_in_file=(*owner.path_in_file, "other_bits")
    )
    bits_by_number = [unspecified_bit] * placed_layout.bits
    properties_by_low_and_width = {}
    name_facts = ComparedFacts()
    for placed_field in placed_layout.fields:
        path_in_file = owner.reading.field_path(owner.path_in_file, placed_field.field)
        description = f"{bits(placed_field.highest_bit, placed_field.lowest_bit)} of {owner.description}"
        bits_of_field = list(_bit_meanings(placed_field, placed_layout, path_in_file))
        if placed_field.field.byte_order:
            # The bits are compared as they are sent, in the byte order of the frame.
            bytes_of_field = [bits_of_field[low : low + 8] for low in range(0, placed_field.width, 8)]
            bits_of_field = list(chain.from_iterable(reversed(bytes_of_field)))
        bits_by_number[placed_field.lowest_bit : placed_field.highest_bit + 1] = bits_of_field
        subject = FactSubject(
            owner.reading, key=(), path_in_file=path_in_file, description=description, interface=owner.interface
        )
        facts = properties(subject, placed_field, parameters, register)
        properties_by_low_and_width[placed_field.lowest_bit, placed_field.width] = {fact.key: fact for fact in facts}
        add_names(subject, placed_field, owner.path_in_file[-1], name_facts)
    return WordCase(bits=tuple(bits_by_number), fields=properties_by_low_and_width, names=name_facts.names)


def _bit_meanings(placed_field: PlacedField, placed_layout: PlacedLayout, path_in_file: Path) -> Iterator[BitMeaning]:
    """Yield the meaning of each bit of a field, beginning with the lowest bit.

    Constants and unused bits have a fixed value. The bits of a number have weights, which continue across the fields of
    a joined number. In a text, each character has the weights 0 to 7. A flag or parity bit has no weight unless it is
    part of a joined number.
    """
    kind = placed_field.field.kind
    owner_text = _part_text(kind, placed_field, placed_layout)
    weight_in_join = _weight_in_join(placed_field, placed_layout)
    # In a field that is not part of a joined number, the lowest bit has the weight 0.
    lowest_weight = 0
    if weight_in_join is not None and placed_field.field.carries_data:
        lowest_weight = weight_in_join
    for index in range(placed_field.width):
        match kind:
            case Constant(value) | Unused(value):
                yield BitMeaning(owner_text, weight=None, fixed=(value >> index) & 1, path_in_file=path_in_file)
            case Flag() | Parity() if weight_in_join is None:
                yield BitMeaning(owner_text, weight=None, fixed=None, path_in_file=path_in_file)
            case Text():
                yield BitMeaning(owner_text, weight=index % 8, fixed=None, path_in_file=path_in_file)
            case _:
                yield BitMeaning(owner_text, weight=lowest_weight + index, fixed=None, path_in_file=path_in_file)


def _part_text(kind: Kind, placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return a text on what the bits of a field are, such as ``a signed number in Gray code`` or ``the CRC``."""
    match kind:
        case Number(signed=True):
            return "a signed number" + _gray_suffix(placed_field, placed_layout)
        case Flag():
            return "a flag"
        case Constant():
            return "constant"
        case Unused():
            return "unused"
        case CrcValue(_, covered):
            if not covered:
                return "the CRC"
            lowest_covered, covered_width = placed_layout.covered_lowest_bit_and_width
            highest_covered = lowest_covered + covered_width - 1
            return f"the CRC of {bits(highest_covered, lowest_covered)}"
        case Parity():
            return _parity_text(kind, placed_layout)
        case Text():
            return "a character"
        case _:
            return "a number" + _gray_suffix(placed_field, placed_layout)


def _parity_text(parity: Parity, placed_layout: PlacedLayout) -> str:
    """Return a text on a parity bit, such as ``odd parity of bits 7:0``.

    If ``over`` restricts the parity to some bits of each field, the text is ``odd parity of the odd bits of bits 7:0``.
    """
    polarity = "odd" if parity.odd else "even"
    covered_bits = join_words([_text_of_bits(placed_layout, name) for name in parity.of])
    if not parity.over:
        return f"{polarity} parity of {covered_bits}"
    counted_words = parity.over.replace("_", " ")
    return f"{polarity} parity of the {counted_words} of {covered_bits}"


def _text_of_bits(placed_layout: PlacedLayout, name: str) -> str:
    """Return the bits of a field as text, or its name if the order code does not have this field."""
    placed_field = placed_layout.find_field(name)
    return bits(placed_field.highest_bit, placed_field.lowest_bit) if placed_field is not None else name


def _gray_suffix(placed_field: PlacedField, placed_layout: PlacedLayout) -> str:
    """Return `` in Gray code`` for a field that is sent in Gray code, or ""."""
    is_gray = placed_layout.gray and placed_field.name in placed_layout.layout.field_names_of(
        placed_layout.layout.gray_of
    )
    return " in Gray code" if is_gray else ""


def _weight_in_join(placed_field: PlacedField, placed_layout: PlacedLayout) -> int | None:
    """Return the weight of a field's lowest bit in the longest joined number that contains the field, or None.

    The most significant field is the first, so the weight is the number of bits in the fields after this one.
    """
    longest_bits = 0
    weight = None
    for join in placed_layout.layout.joins:
        if placed_field.name not in join.fields:
            continue
        joined_fields = placed_layout.find_fields(join.fields)
        index = joined_fields.index(placed_field)
        lower_fields = joined_fields[index + 1 :]
        total_bits = sum(field.width for field in joined_fields)
        if total_bits > longest_bits:
            longest_bits = total_bits
            weight = sum(field.width for field in lower_fields)
    return weight


def describe_bits(adjacent_bits: Sequence[BitMeaning]) -> str:
    """Describe adjacent bits of one item, such as ``bits 7:0 of a number``, ``constant 0010`` or ``a flag``.

    ``adjacent_bits`` begins with the highest bit.
    """
    highest_bit = adjacent_bits[0]
    lowest_bit = adjacent_bits[-1]
    if highest_bit.fixed is not None:
        digits = "".join(str(bit.fixed) for bit in adjacent_bits)
        return f"{highest_bit.part} {digits}"
    if highest_bit.weight is None or lowest_bit.weight is None:
        return highest_bit.part
    return f"{bits(highest_bit.weight, lowest_bit.weight)} of {highest_bit.part}"


def continues_item(bit: BitMeaning, bit_above: BitMeaning) -> bool:
    """Return whether a bit belongs to the same item as ``bit_above``, the next higher bit.

    The part and the place of the two are equal, both or neither are constant, and weights, if any, are consecutive.
    """
    if (bit.part, bit.path_in_file) != (bit_above.part, bit_above.path_in_file):
        return False
    is_constant = bit.fixed is not None
    is_constant_above = bit_above.fixed is not None
    if is_constant != is_constant_above:
        return False
    return bit.weight is None or bit_above.weight is None or bit.weight + 1 == bit_above.weight


def add_registers(reading: SpecReading, facts: ComparedFacts) -> None:
    """Add the facts, the names and the bits of every register."""
    for register in reading.device.registers:
        key, path_in_file = reading.key_of(register), ("registers", register.name)
        subject = FactSubject(
            reading,
            key=key,
            path_in_file=path_in_file,
            description=register_text(register),
            interface=register.interface,
        )
        facts.add(_register_facts(subject, register))
        _add_names_of_referred_fields(subject, register, facts)
        # The bits of a joined number follow from its fields.
        facts.derived[FactClass.POSITION] += len(register.layout.joins)
        facts.words[key] = word_bits(subject, register.layout, register)


def _add_names_of_referred_fields(subject: FactSubject, register: Register, facts: ComparedFacts) -> None:
    """Add the names of the fields that a register refers to: the field that its limits apply to, and the opening field.

    The register can only be written after the opening field has a certain value. If only a register is named there, the
    name is "nothing".
    """
    name_of_limited_field = ComparedFact(
        fact_class=FactClass.LIMIT,
        key=subject.key,
        value=register.limits_of,
        description=f"field that the limits of {subject.description} apply to",
        path_in_file=(*subject.path_in_file, "limits_of"),
    )
    facts.add_name(("bounded",), name_of_limited_field)
    if register.opened_by:
        name_of_opening_field = ComparedFact(
            fact_class=FactClass.BEHAVIOUR,
            key=subject.key,
            value=register.opened_by_field or NOTHING,
            description=f"field that opens {subject.description}",
            path_in_file=(*subject.path_in_file, "opened_by"),
        )
        facts.add_name(("opener",), name_of_opening_field)


def _register_facts(subject: FactSubject, register: Register) -> Iterator[ComparedFact]:
    """Yield the facts about a register: its address, length, default, opening register, limits and other members."""
    length_text = count_with_unit(register.length, "byte")
    yield subject.existence_fact(FactClass.ADDRESS, length_text, at="address", name=register.name)
    # A single byte has no byte order.
    members_without_fact = ("byte_order",) if register.length == 1 else ()
    yield from subject.stated_facts(register, without=members_without_fact)
    default = as_delivered(register)
    if default is not None:
        # If the spec does not state the default, it follows from the documented values of the fields.
        stated_at = "fields" if register.default is None else "default"
        path_in_file = (*subject.path_in_file, stated_at)
        yield subject.detail_fact(
            FactClass.DEFAULT, name="default", value=in_hex(default), noun="default", path_in_file=path_in_file
        )
    if register.opened_by:
        yield subject.detail_fact(
            FactClass.BEHAVIOUR, name="opened_by", value=_opener_text(subject.reading, register), noun="opener"
        )
    yield from _limit_facts(subject, register)


def _opener_text(reading: SpecReading, register: Register) -> str:
    """Return the value that opens a register for writing, and its bits: ``0x5A in register 0x49 bits 7:0``.

    If the spec does not give a value, the text is only the register that must be written: ``register 0x49``.
    """
    opening_register = reading.register(register.opened_by)
    if opening_register is None:
        return register.opened_by
    for field in opening_register.layout.fields:
        if register.opened_by_field and field.name != register.opened_by_field:
            continue
        for named_value in field.values:
            if named_value.name == register.opened_by_value:
                bits_text = reading.bits_of(opening_register.interface, field)
                return f"{in_hex(named_value.value)} in {register_text(opening_register)} {bits_text}"
    return register_text(opening_register)


def _limit_facts(subject: FactSubject, register: Register) -> Iterator[ComparedFact]:
    """Yield the bits that the limits of a register apply to, and the facts about each of its meanings.

    A register has several meanings if a different register determines how it is interpreted.
    """
    reading = subject.reading
    limited_parts: list[Register | RegisterMeaning] = [register, *register.meanings]
    if any(part.min is not None or part.max is not None for part in limited_parts):
        cases = reading.cases(register.interface)
        yield ComparedFact(
            fact_class=FactClass.LIMIT,
            key=(*subject.key, "bounded"),
            value={case: _limited_bits_text(register, parameters) for case, parameters in cases.items()},
            description=f"bits that the limits of {subject.description} apply to",
            path_in_file=reading.first_existing((*subject.path_in_file, "limits_of"), subject.path_in_file),
            depends_on=subject.key,
        )
    for meaning in register.meanings:
        # The condition contains no names, so it can also be the key of the meaning.
        description = f"{subject.description} while {reading.state(meaning.when, meaning.value)}"
        meaning_subject = subject.inside(
            key=(description,), path_in_file=("meanings", meaning.name), description=description
        )
        yield from meaning_subject.stated_facts(meaning)


def _limited_bits_text(register: Register, parameters: Mapping[str, int]) -> str:
    """Return the bits of a register that its limits apply to: ``bits 7:0``, or ``all bits`` if they name no field."""
    names = register.layout.field_names_of(name_with_limits(register))
    fields = register.layout.place(parameters).find_fields(names)
    return " and ".join(bits(field.highest_bit, field.lowest_bit) for field in fields) or "all bits"
