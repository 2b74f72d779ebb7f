"""Facts about registers other than their bits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import Choice, Register
from ..model.limits import bounded, bounds
from ..say.place import bits
from .fact import NOTHING, Fact, Facts, Name, Sort
from .frame_bits import word
from .reading import Reading, as_delivered, at, in_hex, short
from .stated import Subject


def add_registers(reading: Reading, facts: Facts) -> None:
    """Add every register, its bits, and its behaviour."""
    for register in reading.device.registers:
        key, place = reading.key_of(register), ("registers", register.name)
        subject = Subject(reading, key, place, at(register), register.interface)
        facts.add(_facts(subject, register))
        _add_names(subject, register, facts)
        facts.derived[Sort.POSITION] += len(register.layout.joins)
        facts.words[key] = word(subject, register.layout, register)


def _add_names(subject: Subject, register: Register, facts: Facts) -> None:
    """Add the names that a register refers to: the field with limits, and the field that opens it."""
    what, place = f"field that the limits of {subject.what} apply to", (*subject.place, "limits_of")
    facts.call(("bounded",), subject.key, Name(Sort.LIMIT, register.limits_of, what, place))
    if register.opened_by:
        name, what = register.opened_by_field or NOTHING, f"field that opens {subject.what}"
        facts.call(("opener",), subject.key, Name(Sort.BEHAVIOUR, name, what, (*subject.place, "opened_by")))


def _facts(subject: Subject, register: Register) -> Iterator[Fact]:
    length = f"{register.length} byte{'s' * (register.length != 1)}"
    yield subject.first(Sort.ADDRESS, length, at="address", name=register.name)
    yield from subject.stated(register, without=("byte_order",) if register.length == 1 else ())
    default, is_stated = as_delivered(register)
    if default is not None:
        place = (*subject.place, "default" if is_stated else "fields")
        yield subject.fact(Sort.DEFAULT, "default", in_hex(default), "default", place)
    if register.opened_by:
        yield subject.fact(Sort.BEHAVIOUR, "opened_by", _opened_by(subject.reading, register), "opener")
    yield from _limits(subject, register)


def _opened_by(reading: Reading, register: Register) -> str:
    opener = reading.register(register.opened_by)
    if opener is None:
        return register.opened_by
    for item in opener.layout.fields:
        if register.opened_by_field in ("", item.name) and isinstance(item.kind, Choice):
            for value in item.values:
                if value.name == register.opened_by_value:
                    return f"{in_hex(value.value)} in {at(opener)} {reading.bits_of(opener.interface, item)}"
    return at(opener)


def _limits(subject: Subject, register: Register) -> Iterator[Fact]:
    """Yield the limits, also of each meaning, for every order code and state of the registers."""
    reading = subject.reading
    meanings = [("", register.min, register.max, subject.place)]
    for item in register.meanings:
        held, place = f" while {reading.state(item.when, item.value)}", (*subject.place, "meanings", item.name)
        meanings.append((held, item.min, item.max, place))
    if any(low is not None or high is not None for _, low, high, _ in meanings):
        place = reading.first((*subject.place, "limits_of"), subject.place)
        what = f"bits that the limits of {subject.what} apply to"
        value = {case: _bounded(register, each) for case, each in reading.cases(register.interface).items()}
        yield Fact(Sort.LIMIT, (*subject.key, "bounded"), value, what, place, subject.key)
    for held, low, high, place in meanings:
        for word_, limit, index in (("min", low, 0), ("max", high, 1)):
            if limit is not None:
                value = {
                    case: short(bounds(register, register.layout.place(each), (low, high), each)[index])
                    for case, each in reading.cases(register.interface).items()
                }
                key, what = (*subject.key, word_, held), f"{word_}imum of {subject.what}{held}"
                yield Fact(Sort.LIMIT, key, value, what, (*place, word_), subject.key)


def _bounded(register: Register, parameters: Mapping[str, int]) -> str:
    """Return the bits of a register that its limits apply to."""
    placed = map(register.layout.place(parameters).field, register.layout.names_in(bounded(register)))
    return " and ".join(bits(item.low + item.width - 1, item.low) for item in placed if item is not None) or "all bits"
