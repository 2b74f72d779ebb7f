"""Facts about registers: names, access, values and limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import (
    Register,
    RegisterMeaning,
)
from ..model.registers import name_with_limits
from ..say.names_and_places import bits
from ..say.plain_text import count_with_unit
from .frame_bits import word_bits
from .reading import (
    NOTHING,
    ComparedFact,
    ComparedFacts,
    FactClass,
    SpecReading,
    as_delivered,
    in_hex,
    register_text,
)
from .stated import FactSubject


def add_registers(reading: SpecReading, facts: ComparedFacts) -> None:
    """Add the facts, the names and the bits of every register."""
    for register in reading.device.registers:
        key, place = reading.key_of(register), ("registers", register.name)
        subject = FactSubject(
            reading, key=key, place=place, description=register_text(register), interface=register.interface
        )
        facts.add(_register_facts(subject, register))
        _add_names(subject, register, facts)
        # The bits of a joined number follow from its fields.
        facts.derived[FactClass.POSITION] += len(register.layout.joins)
        facts.words[key] = word_bits(subject, register.layout, register)


def _add_names(subject: FactSubject, register: Register, facts: ComparedFacts) -> None:
    """Add the names of the fields that a register refers to: the field that its limits apply to, and the opening field.

    The register can only be written after the opening field has a certain value. If only a register is named there, the
    name is "nothing".
    """
    name_of_limited_field = ComparedFact(
        fact_class=FactClass.LIMIT,
        key=subject.key,
        value=register.limits_of,
        description=f"field that the limits of {subject.description} apply to",
        place=(*subject.place, "limits_of"),
    )
    facts.add_name(("bounded",), name_of_limited_field)
    if register.opened_by:
        name_of_opening_field = ComparedFact(
            fact_class=FactClass.BEHAVIOUR,
            key=subject.key,
            value=register.opened_by_field or NOTHING,
            description=f"field that opens {subject.description}",
            place=(*subject.place, "opened_by"),
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
        place = (*subject.place, stated_at)
        yield subject.detail_fact(FactClass.DEFAULT, name="default", value=in_hex(default), noun="default", place=place)
    if register.opened_by:
        yield subject.detail_fact(
            FactClass.BEHAVIOUR, name="opened_by", value=_opener_text(subject.reading, register), noun="opener"
        )
    yield from _limit_facts(subject, register)


def _opener_text(reading: SpecReading, register: Register) -> str:
    """Return the value that opens a register for writing, and its bits: ``0x5A in register 0x49 bits 7:0``.

    If the spec does not give a value, the text is only the register that must be written: ``register 0x49``.
    """
    opener = reading.register(register.opened_by)
    if opener is None:
        return register.opened_by
    for field in opener.layout.fields:
        if register.opened_by_field and field.name != register.opened_by_field:
            continue
        for named_value in field.values:
            if named_value.name == register.opened_by_value:
                bits_text = reading.bits_of(opener.interface, field)
                return f"{in_hex(named_value.value)} in {register_text(opener)} {bits_text}"
    return register_text(opener)


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
            place=reading.first_existing((*subject.place, "limits_of"), subject.place),
            depends_on=subject.key,
        )
    for meaning in register.meanings:
        # The condition contains no names, so it can also be the key of the meaning.
        description = f"{subject.description} while {reading.state(meaning.when, meaning.value)}"
        meaning_subject = subject.inside(key=(description,), place=("meanings", meaning.name), description=description)
        yield from meaning_subject.stated_facts(meaning)


def _limited_bits_text(register: Register, parameters: Mapping[str, int]) -> str:
    """Return the bits of a register that its limits apply to: ``bits 7:0``, or ``all bits`` if they name no field."""
    names = register.layout.field_names_of(name_with_limits(register))
    fields = register.layout.place(parameters).find_fields(names)
    return " and ".join(bits(field.high, field.low) for field in fields) or "all bits"
