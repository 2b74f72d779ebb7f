"""Statements about a register: its address, its content, and the rules for reading and writing it."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import BankSelect, Device, Register, RegisterMeaning, first_of
from ..model.expressions import Expression
from .errata import errata, erratum, needed_answers
from .names_and_places import hexadecimal, register_at, register_field
from .names_and_places import register as named
from .text import Code, Part, Statement, listed, spec_text, statement

_ACCESS = {"read_only": "read only", "read_write": "read and write", "write_only": "write only"}
#: Phrases for registers and fields that only one party may use.
USERS = {"maker": "manufacturer"}
_ABOVE_MAX = {
    "default": "The encoder replaces a value above the limit with the default",
    "refused": "The encoder rejects a value above the limit",
}


def access(register: Register) -> str:
    return _ACCESS[register.access]


def head(device: Device, register: Register, name: Part) -> Statement:
    """Return the register's ``name``, address, access and interface."""
    interface = device.interface(register.interface).title
    return statement(name, f", {register_at(register)}, {access(register)}, over {interface}", source=register.source)


def register(device: Device, device_register: Register) -> Iterator[Statement]:
    """Yield all statements that follow the head in running text."""
    yield from spec_text(device_register.meaning)
    yield from facts(device, device_register)
    yield from spec_text(device_register.note)
    yield from map(erratum, errata(device, f"registers.{device_register.name}"))


def facts(device: Device, register: Register) -> Iterator[Statement]:
    """Yield its content and the rules for reading and writing it."""
    yield from _holds(register)
    yield from needed_answers(device, register.layout)
    yield from _rules(device, register)
    yield from (_meaning(device, meaning) for meaning in register.meanings)


def _holds(register: Register) -> Iterator[Statement]:
    if register.last_address > register.address:
        lowest = "low" if register.byte_order == "low_byte_first" else "high"
        yield statement(f"{lowest} byte first, at {hexadecimal(register.address)}", label="Byte order")
    data = register.default_bytes()
    if data is not None:
        yield statement(Code(data.hex(" ").upper()), label="Default")
    if not register.meanings and (register.min is not None or register.max is not None):
        field_text = () if register.limits_of == register.name else (" for ", Code(register.limits_of))
        yield statement(*limits(register.min, register.max), *field_text, label="Limits")


def limits(low: Expression | None, high: Expression | None) -> tuple[Part, ...]:
    """Return a range, or an empty tuple without limits."""
    if low is not None and high is not None:
        return low, " to ", high
    if low is not None:
        return "at least ", low
    return ("at most ", high) if high is not None else ()


def _rules(device: Device, register: Register) -> Iterator[Statement]:
    yield from _same_address(device, register)
    if register.bank is not None:
        facts = device.interface(register.interface).facts()
        bank_selects = (fact for fact in facts if isinstance(fact, BankSelect))
        select = first_of(bank_selects, f"register that selects the bank of '{register.name}'").register
        yield statement(f"First select bank {register.bank} with ", named(device, select))
    if register.reserved:
        yield reserved(register.reserved)
    if register.opened_by:
        yield _opening_condition(device, register)
    if register.wait_at_least_ms is not None:
        yield statement(f"Wait at least {register.wait_at_least_ms} ms between a write and the next command")
    if register.clears_itself:
        yield statement("Automatically returns to its default after a write")
    if register.volatile:
        yield statement("Save the parameters after a write, or the encoder loses the value at power-off")
    if register.above_max:
        yield statement(_ABOVE_MAX[register.above_max])
    if register.write_clears:
        yield statement("A write sets ", *listed([named(device, name) for name in register.write_clears]), " to zero")


def reserved(user: str) -> Statement:
    return statement(f"Reserved for the {USERS[user]}")


def _same_address(device: Device, register: Register) -> Iterator[Statement]:
    """Yield the other register at the same address, which differs only in the direction of access."""
    for other_register in device.registers:
        if other_register is not register and (other_register.address, other_register.bank) == (
            register.address,
            register.bank,
        ):
            action = "Writing to" if other_register.access == "write_only" else "Reading"
            yield statement(f"{action} the same address accesses ", named(device, other_register.name), " instead")


def _opening_condition(device: Device, register: Register) -> Statement:
    """Return the value that another register must hold before this one can be written."""
    opener = device.register(register.opened_by)
    path = ".".join(filter(None, (register.opened_by, register.opened_by_field)))
    field = opener.layout.field(register.opened_by_field) if register.opened_by_field else opener.layout.fields[0]
    value = field.value_named(register.opened_by_value).value
    value_text = f"{value}" if register.opened_by_field else hexadecimal(value, 2 * opener.length)
    field_reference = register_field(device, path)
    return statement(
        "Can be written only while ", field_reference, f" is {value_text} (", Code(register.opened_by_value), ")"
    )


def _meaning(device: Device, meaning: RegisterMeaning) -> Statement:
    """Return one meaning of a register and the field value that selects it."""
    path, _, field = meaning.when.partition(".")
    bit = device.register(path).layout.field(field)
    value = bit.value_named(meaning.value).value
    field_reference = register_field(device, meaning.when)
    condition = ("While ", field_reference, f" is {value} (", Code(meaning.value), "), the register holds ")
    span = limits(meaning.min, meaning.max)
    meaning_text = f": {meaning.meaning}" if meaning.meaning else ""
    return statement(
        *condition, Code(meaning.name), *((", ", *span) if span else ()), meaning_text, source=meaning.source
    )
