"""Statements about a procedure, its arguments and its steps."""

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
from .words import microseconds, sentence


def procedure(device: Device, item: Procedure) -> Iterator[Said]:
    """Yield all statements that follow its title, without arguments and steps."""
    yield from about(item)
    yield from told(item.note)
    yield from map(erratum, errata(device, f"procedures.{item.name}"))


def about(item: Procedure) -> Iterator[Said]:
    """Yield its preconditions and its result."""
    yield from told(item.precondition, label="Before")
    yield from told(item.result, label="Result")


def argument(device: Device, item: Argument) -> Said:
    """Return the meaning of an argument and the register to which it is written."""
    as_ = (" as its ", Code(item.meant_as)) if item.meant_as else ()
    meaning = f"{sentence(item.meaning)} Written to " if item.meaning else "Written to "
    return said(meaning, named(device, item.of), *as_)


def step(device: Device, item: Step) -> Said:
    """Return a step as an instruction."""
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


def read_back(device: Device, register: Register, field: str) -> Said:
    """Return the read-back check that generated code makes before a written value takes effect."""
    at = f", {register_at(register)}"
    return said("Read back ", _where(device, register.name, field), f"{at}, and stop unless it holds the written value")


def _access(device: Device, item: RegisterStep) -> Iterator[Part]:
    register = device.register(item.register)
    at = f", {register_at(register)}"
    match item:
        case ReadStep(field=field):
            yield from ("Read ", _where(device, register.name, field), at)
        case PollStep(field=field, value=value):
            yield from ("Poll ", _where(device, register.name, field), f"{at}, until it is {value}")
        case WriteStep(value_name=name, value=value):
            yield from ("Write ", *_value(name, value), " to ", named(device, register.name), at)
            yield from (": ", Code(register.bytes_of(value).hex(" ").upper())) if value is not None else ()
        case ModifyStep(field=field, value_name=name, value=value):
            yield from ("Write ", *_value(name, value), " to ", _where(device, register.name, field), at)
            yield ", and keep the other fields of the register as read"
        case _:
            assert_never(item)


def _value(name: str, value: int | None) -> tuple[Part, ...]:
    """Return a value by its name, or the argument that the caller passes."""
    return ("the argument ", Code(name)) if value is None else (Code(name),)


def _where(device: Device, register: str, field: str) -> Part:
    return register_field(device, f"{register}.{field}" if field else register)
