"""Facts about registers other than their bits."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ..language.problems import Path
from ..model import Choice, Register
from ..model.expressions import Expression
from ..model.limits import bounded, bounds
from .aspects import Aspects
from .fact import NOTHING, Fact, Facts, Key, Name, Sort, Value
from .printed import printed_names
from .reading import Parameters, Reading, as_delivered, at, in_hex, short
from .words import word


def add_registers(reading: Reading, facts: Facts) -> None:
    """Add every register, its bits, and its behaviour."""
    for register in reading.device.registers:
        owner: Path = ("registers", register.name)
        key = reading.key_of(register)
        facts.add(_facts(reading, register, key, owner))
        _add_names(register, key, owner, facts)
        facts.follows(Sort.POSITION, len(register.layout.joins))
        aspects = Aspects(reading, owner, register.interface, register)
        facts.words[key] = word(reading, register.layout, key, at(register), aspects)


def _add_names(register: Register, key: Key, owner: Path, facts: Facts) -> None:
    """Add the names that a register refers to: the field with limits, and the field that opens it."""
    what = f"field that the limits of {at(register)} apply to"
    facts.call(("bounded",), key, Name(Sort.LIMIT, register.limits_of, what, (*owner, "limits_of")))
    if register.opened_by:
        what = f"field that opens {at(register)}"
        name = Name(Sort.BEHAVIOUR, register.opened_by_field or NOTHING, what, (*owner, "opened_by"))
        facts.call(("opener",), key, name)


def _facts(reading: Reading, register: Register, key: Key, owner: Path) -> Iterator[Fact]:
    name = at(register)
    length = f"{register.length} byte{'s' * (register.length != 1)}"
    yield Fact(Sort.ADDRESS, key, length, name, (*owner, "address"), name=register.name)
    said: list[tuple[Sort, str, str, str]] = [(Sort.ACCESS, "access", register.access, "access")]
    if register.length > 1:
        said.append((Sort.BYTE_ORDER, "byte_order", register.byte_order, "byte order"))
    default, stated = as_delivered(register)
    if default is not None:
        said.append((Sort.DEFAULT, "default", in_hex(default), "default"))
    said += _behaviour(reading, register)
    for sort, word_, value, what in said:
        place = (*owner, word_) if stated or word_ != "default" else (*owner, "fields")
        yield Fact(sort, (*key, word_), value, f"{what} of {name}", place, key)
    for language, text in printed_names(reading, register.printed_name, register.names):
        place = reading.name_place(owner, language)
        yield Fact(Sort.PRINTED, (*key, "name", language), text, f"printed name of {name}", place, key, mild=True)
    yield from _limits(reading, register, key, owner)


def _behaviour(reading: Reading, register: Register) -> Iterator[tuple[Sort, str, str, str]]:
    if register.wait_at_least_ms is not None:
        yield Sort.WAIT, "wait_at_least_ms", f"{register.wait_at_least_ms} ms", "wait after a write"
    if register.clears_itself:
        yield Sort.BEHAVIOUR, "clears_itself", "yes", "return to the default"
    if register.volatile:
        yield Sort.BEHAVIOUR, "volatile", "yes", "loss at power-off"
    if register.above_max:
        yield Sort.LIMIT, "above_max", register.above_max, "value above the maximum"
    if register.reserved:
        yield Sort.BEHAVIOUR, "reserved", register.reserved, "user"
    if register.write_clears:
        cleared = (reading.register(name) for name in register.write_clears)
        value = ", ".join(sorted(at(item) for item in cleared if item is not None))
        yield Sort.BEHAVIOUR, "write_clears", value, "registers cleared by a write"
    if register.opened_by:
        yield Sort.BEHAVIOUR, "opened_by", _opened_by(reading, register), "opener"


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


def _limits(reading: Reading, register: Register, key: Key, owner: Path) -> Iterator[Fact]:
    """Yield the limits, also of each meaning, for every order code and state of the registers."""
    meanings = [("", "", register.min, register.max, owner)]
    for item in register.meanings:
        held = f" while {reading.state(item.when, item.value)}"
        meanings.append((held, held, item.min, item.max, (*owner, "meanings", item.name)))
    if any(low is not None or high is not None for _, _, low, high, _ in meanings):
        place = reading.first((*owner, "limits_of"), owner)
        what = f"bits that the limits of {at(register)} apply to"
        yield Fact(Sort.LIMIT, (*key, "bounded"), _bounded(reading, register), what, place, key)
    for told, held, low, high, place in meanings:
        for word_, limit, index in (("min", low, 0), ("max", high, 1)):
            if limit is not None:
                value = _in_cases(reading, register, _bound(register, (low, high), index))
                what = f"{word_}imum of {at(register)}{held}"
                yield Fact(Sort.LIMIT, (*key, word_, told), value, what, (*place, word_), key)


def _bounded(reading: Reading, register: Register) -> str:
    """Return the bits of a register that its limits apply to."""
    name = bounded(register)
    join = next((item.fields for item in register.layout.joins if item.name == name), (name,))
    parts = [item for item in register.layout.fields if item.name in join]
    return " and ".join(reading.bits_of(register.interface, item) for item in parts) or "all bits"


def _bound(
    register: Register, limits: tuple[Expression | None, Expression | None], index: int
) -> Callable[[Parameters], str]:
    return lambda parameters: short(bounds(register, register.layout.place(parameters), limits, parameters)[index])


def _in_cases(reading: Reading, register: Register, value: Callable[[Parameters], str]) -> Value:
    return {case: value(parameters) for case, parameters in reading.cases(register.interface).items()}
