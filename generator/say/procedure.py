"""What is said of a procedure, its arguments and its steps."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import (
    Argument,
    Device,
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    RegisterStep,
    SendStep,
    Step,
    WaitStep,
    WriteStep,
    assert_never,
)
from .erratum import errata, erratum
from .name import register as named
from .name import register_field
from .place import register_at
from .text import Code, Part, Said, said, told
from .words import microseconds


def procedure(device: Device, item: Procedure) -> Iterator[Said]:
    """All that running text says below its title, in order; arguments and steps stand apart."""
    yield from about(item)
    yield from told(item.note)
    yield from map(erratum, errata(device, f"procedures.{item.name}"))


def about(item: Procedure) -> Iterator[Said]:
    """What has to be so before it, and what is so after it."""
    yield from told(item.precondition, label="Before")
    yield from told(item.result, label="Result")


def argument(device: Device, item: Argument) -> Said:
    """What the caller gives, and the register that takes it."""
    as_ = (" as its ", Code(item.meant_as)) if item.meant_as else ()
    meaning = f"{item.meaning.rstrip('.')}; written to " if item.meaning else "Written to "
    return said(meaning, named(device, item.of), *as_)


def step(device: Device, item: Step) -> Said:
    """What a person does."""
    match item:
        case WaitStep():
            return said(f"Wait at least {microseconds(item.microseconds)}")
        case SendStep():
            apart = f", at least {microseconds(item.microseconds)} apart" if item.microseconds else ""
            alone = ", with no other request between them" if item.in_succession else ""
            again = f" {item.times} times{apart}{alone}" if item.times > 1 else ""
            return said("Send the request ", Code(item.data_id), f"{again}: ", Code(item.request.hex(" ").upper()))
        case _:
            return said(*_access(device, item))


def read_back(device: Device, register: Register, field: str = "") -> Said:
    """What generated code does before a command acts on what was written."""
    at = f", {register_at(register)}"
    return said("Read ", _where(device, register.name, field), f"{at}, and stop unless it holds what was written")


def _access(device: Device, item: RegisterStep) -> Iterator[Part]:
    register = device.register(item.register)
    at = f", {register_at(register)}"
    match item:
        case ReadStep(field=field):
            yield from ("Read ", _where(device, register.name, field), at)
        case PollStep(field=field, value=value):
            yield from ("Read ", _where(device, register.name, field), f"{at}, until it is {value}")
        case WriteStep(value_name=name, value=value):
            yield from ("Write ", *_value(name, value), " to ", named(device, register.name), at)
            yield from (": ", Code(register.bytes_of(value).hex(" ").upper())) if value is not None else ()
        case ModifyStep(field=field, value_name=name, value=value):
            yield from ("Write ", *_value(name, value), " to ", _where(device, register.name, field), at)
            yield ", and leave the register's other fields as read"
        case _:
            assert_never(item)


def _value(name: str, value: int | None) -> tuple[Part, ...]:
    """A value by its name, or what the caller gives."""
    return ("the argument ", Code(name)) if value is None else (Code(name),)


def _where(device: Device, register: str, field: str) -> Part:
    return register_field(device, f"{register}.{field}" if field else register)
