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
from .text import Code, Part, Statement, spec_text, statement
from .words import microseconds, sentence


def procedure(device: Device, sequence: Procedure) -> Iterator[Statement]:
    """Yield all statements that follow its title, without arguments and steps."""
    yield from about(sequence)
    yield from spec_text(sequence.note)
    yield from map(erratum, errata(device, f"procedures.{sequence.name}"))


def about(sequence: Procedure) -> Iterator[Statement]:
    """Yield its preconditions and its result."""
    yield from spec_text(sequence.precondition, label="Before")
    yield from spec_text(sequence.result, label="Result")


def argument(device: Device, parameter: Argument) -> Statement:
    """Return the meaning of an argument and the register to which it is written."""
    as_ = (" as its ", Code(parameter.meant_as)) if parameter.meant_as else ()
    meaning = f"{sentence(parameter.meaning)} Written to " if parameter.meaning else "Written to "
    return statement(meaning, named(device, parameter.of), *as_)


def step(device: Device, procedure_step: Step) -> Statement:
    """Return a step as an instruction."""
    match procedure_step:
        case WaitStep():
            return statement(f"Wait at least {microseconds(procedure_step.microseconds)}")
        case SendStep():
            interval_text = (
                f", at least {microseconds(procedure_step.microseconds)} apart" if procedure_step.microseconds else ""
            )
            succession_text = ", with no other request between them" if procedure_step.in_succession else ""
            repetition_text = (
                f" {procedure_step.times} times{interval_text}{succession_text}" if procedure_step.times > 1 else ""
            )
            return statement(
                "Send the request ",
                Code(procedure_step.data_id),
                f"{repetition_text}: ",
                Code(procedure_step.request.hex(" ").upper()),
            )
        case _:
            return statement(*_access(device, procedure_step))


def read_back(device: Device, register: Register, field: str) -> Statement:
    """Return the read-back check that generated code makes before a written value takes effect."""
    address_text = f", {register_at(register)}"
    return statement(
        "Read back ",
        _register_and_field(device, register.name, field),
        f"{address_text}, and stop unless it holds the written value",
    )


def _access(device: Device, procedure_step: RegisterStep) -> Iterator[Part]:
    register = device.register(procedure_step.register)
    address_text = f", {register_at(register)}"
    match procedure_step:
        case ReadStep(field=field):
            yield from ("Read ", _register_and_field(device, register.name, field), address_text)
        case PollStep(field=field, value=value):
            yield from (
                "Poll ",
                _register_and_field(device, register.name, field),
                f"{address_text}, until it is {value}",
            )
        case WriteStep(value_name=name, value=value):
            yield from ("Write ", *_value(name, value), " to ", named(device, register.name), address_text)
            yield from (": ", Code(register.bytes_of(value).hex(" ").upper())) if value is not None else ()
        case ModifyStep(field=field, value_name=name, value=value):
            yield from (
                "Write ",
                *_value(name, value),
                " to ",
                _register_and_field(device, register.name, field),
                address_text,
            )
            yield ", and keep the other fields of the register as read"
        case _:
            assert_never(procedure_step)


def _value(name: str, value: int | None) -> tuple[Part, ...]:
    """Return a value by its name, or the argument that the caller passes."""
    return ("the argument ", Code(name)) if value is None else (Code(name),)


def _register_and_field(device: Device, register: str, field: str) -> Part:
    return register_field(device, f"{register}.{field}" if field else register)
