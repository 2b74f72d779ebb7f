"""Facts about registers other than their bits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import Register, RegisterMeaning
from ..model.limits import bounded
from ..say.place import bits
from .fact import NOTHING, Fact, Facts, Sort
from .frame_bits import word
from .reading import Reading, as_delivered, in_hex, register_text
from .stated import Subject


def add_registers(reading: Reading, facts: Facts) -> None:
    """Add every register, its bits, and its behaviour."""
    for register in reading.device.registers:
        key, place = reading.key_of(register), ("registers", register.name)
        subject = Subject(reading, key, place, register_text(register), register.interface)
        facts.add(_facts(subject, register))
        _add_names(subject, register, facts)
        facts.derived[Sort.POSITION] += len(register.layout.joins)
        facts.words[key] = word(subject, register.layout, register)


def _add_names(subject: Subject, register: Register, facts: Facts) -> None:
    """Add the names that a register refers to: the field with limits, and the field that opens it."""
    description, place = f"field that the limits of {subject.description} apply to", (*subject.place, "limits_of")
    facts.call(("bounded",), Fact(Sort.LIMIT, subject.key, register.limits_of, description, place))
    if register.opened_by:
        name, description = register.opened_by_field or NOTHING, f"field that opens {subject.description}"
        place = (*subject.place, "opened_by")
        facts.call(("opener",), Fact(Sort.BEHAVIOUR, subject.key, name, description, place))


def _facts(subject: Subject, register: Register) -> Iterator[Fact]:
    length = f"{register.length} byte{'s' * (register.length != 1)}"
    yield subject.existence(Sort.ADDRESS, length, at="address", name=register.name)
    yield from subject.stated_facts(register, without=("byte_order",) if register.length == 1 else ())
    default = as_delivered(register)
    if default is not None:
        place = (*subject.place, "fields" if register.default is None else "default")
        yield subject.fact(Sort.DEFAULT, "default", in_hex(default), "default", place)
    if register.opened_by:
        yield subject.fact(Sort.BEHAVIOUR, "opened_by", _opened_by(subject.reading, register), "opener")
    yield from _limits(subject, register)


def _opened_by(reading: Reading, register: Register) -> str:
    opener = reading.register(register.opened_by)
    if opener is None:
        return register.opened_by
    for field in opener.layout.fields:
        value = next((value for value in field.values if value.name == register.opened_by_value), None)
        if value is not None and register.opened_by_field in ("", field.name):
            return f"{in_hex(value.value)} in {register_text(opener)} {reading.bits_of(opener.interface, field)}"
    return register_text(opener)


def _limits(subject: Subject, register: Register) -> Iterator[Fact]:
    """Yield the limits of each meaning, and the bits that they apply to."""
    reading = subject.reading
    limited_parts: list[Register | RegisterMeaning] = [register, *register.meanings]
    if any(limited_part.min is not None or limited_part.max is not None for limited_part in limited_parts):
        place = reading.first_existing((*subject.place, "limits_of"), subject.place)
        description = f"bits that the limits of {subject.description} apply to"
        value = {case: _bounded(register, parameters) for case, parameters in reading.cases(register.interface).items()}
        yield Fact(Sort.LIMIT, (*subject.key, "bounded"), value, description, place, subject.key)
    for meaning in register.meanings:
        description = f"{subject.description} while {reading.state(meaning.when, meaning.value)}"
        yield from subject.inside((description,), ("meanings", meaning.name), description).stated_facts(meaning)


def _bounded(register: Register, parameters: Mapping[str, int]) -> str:
    """Return the bits of a register that its limits apply to."""
    names = register.layout.names_in(bounded(register))
    fields = register.layout.place(parameters).find_fields(names)
    return " and ".join(bits(field.high, field.low) for field in fields) or "all bits"
