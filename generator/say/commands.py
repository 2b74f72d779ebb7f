"""Commands, presets, resets and saving: which of them an encoder has, and statements about procedures and steps."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ..model import (
    Argument,
    Biss,
    DataId,
    Device,
    Exchange,
    Input,
    Interface,
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    RegisterStep,
    Rs485,
    SendStep,
    Spi,
    Step,
    Value,
    WaitStep,
    WriteStep,
    assert_never,
)
from ..model.record import dataclass
from .errata import describe_erratum, errata
from .names_and_places import heading, register_at, register_field
from .names_and_places import register_reference as reference_to_register
from .text import CodeText, Reference, Statement, TextPart, as_sentence, list_parts, spec_text, statement, time_text


def describe_procedure(device: Device, sequence: Procedure) -> Iterator[Statement]:
    """Yield all statements about a procedure that follow its title, without arguments and steps."""
    yield from about_procedure(sequence)
    yield from spec_text(sequence.note)
    yield from map(describe_erratum, errata(device, f"procedures.{sequence.name}"))


def about_procedure(sequence: Procedure) -> Iterator[Statement]:
    """Yield the preconditions and the result of a procedure."""
    yield from spec_text(sequence.precondition, label="Precondition")
    yield from spec_text(sequence.result, label="Result")


def describe_argument(device: Device, parameter: Argument) -> Statement:
    """Return the meaning of an argument, the register to which it is written, and which of its meanings applies."""
    sentence_parts: list[TextPart] = [
        f"{as_sentence(parameter.meaning)} It is written to " if parameter.meaning else "It is written to "
    ]
    sentence_parts.append(reference_to_register(device, parameter.of))
    if parameter.meant_as:
        sentence_parts += [" as its ", CodeText(parameter.meant_as)]
    return statement(*sentence_parts)


def describe_step(device: Device, procedure_step: Step) -> Statement:
    """Return a step as an instruction, such as ``Wait at least 20 ms`` or ``Write save to command, address 77h``."""
    match procedure_step:
        case WaitStep():
            return statement(f"Wait at least {time_text(procedure_step.microseconds)}")
        case SendStep():
            request_bytes = CodeText(procedure_step.request.hex(" ").upper())
            repetition = _repetition_text(procedure_step)
            return statement("Send the request ", CodeText(procedure_step.data_id), f"{repetition}: ", request_bytes)
        case _:
            return statement(*_register_access(device, procedure_step))


def _repetition_text(send_step: SendStep) -> str:
    """Return how many times a request is sent and at what interval: `` 10 times, at least 40 µs apart``.

    The text is empty for a request that is sent once.
    """
    if send_step.times <= 1:
        return ""
    repetition_text = f" {send_step.times} times"
    if send_step.microseconds:
        repetition_text += f", at least {time_text(send_step.microseconds)} apart"
    if send_step.in_succession:
        repetition_text += ", with no other request between them"
    return repetition_text


def read_back(device: Device, register: Register, field: str) -> Statement:
    """Return the read-back check that generated code makes before a written value takes effect."""
    register_or_field = _register_or_field(device, register.name, field)
    return statement(
        "Read back ", register_or_field, f", {register_at(register)}, and stop unless it holds the written value"
    )


def _register_access(device: Device, procedure_step: RegisterStep) -> Iterator[TextPart]:
    """Yield the parts of the instruction to read, poll or write a register or a field of it.

    Only a fixed value of a whole register is also shown as bytes.
    """
    register = device.register(procedure_step.register)
    address_text = f", {register_at(register)}"
    match procedure_step:
        case ReadStep(field=field):
            yield from ("Read ", _register_or_field(device, register.name, field), address_text)
        case PollStep(field=field, value=value):
            yield from ("Poll ", _register_or_field(device, register.name, field))
            yield f"{address_text}, until it is {value}"
        case WriteStep(value_name=name, value=value):
            yield from ("Write ", *_value_or_argument(name, value), " to ")
            if value is None and name == register.name:
                yield register_at(register)
            else:
                yield from (reference_to_register(device, register.name), address_text)
            if value is not None:
                yield from (": ", CodeText(register.bytes_of(value).hex(" ").upper()))
        case ModifyStep(field=field, value_name=name, value=value):
            yield from ("Write ", *_value_or_argument(name, value), " to ")
            yield from (_register_or_field(device, register.name, field), address_text)
            yield ", leaving the register's other fields unchanged"
        case _:
            assert_never(procedure_step)


def _value_or_argument(name: str, value: int | None) -> tuple[TextPart, ...]:
    """Return the name of a value or, if ``value`` is None, the name of the argument whose value is written."""
    return ("the argument ", CodeText(name)) if value is None else (CodeText(name),)


def _register_or_field(device: Device, register: str, field: str) -> TextPart:
    """Return a reference to a field of a register, or to the register if ``field`` is empty."""
    return register_field(device, f"{register}.{field}" if field else register)


#: Words of manuals for changing the position, in names and texts.
_PRESET_WORDS = re.compile(
    r"(?i)preset|pres(?:\b|_)|zero|offset|origin|datum|home|referenc|position to 0|set[ _-]?(?:the )?position"
)
#: Words of manuals for keeping settings when the power is off. A request that writes a byte of a memory saves nothing.
_SAVE_WORDS = re.compile(r"(?i)\bsav(?:e|ing)|_save|stor(?:e|ing)|permanent|programming")
_SAVE_TO = re.compile(rf"{_SAVE_WORDS.pattern}|eeprom|flash|non-?volatile")
#: Purposes of requests that change nothing.
_READING_PURPOSES = frozenset(("position", "read", "capture"))


@dataclass(frozen=True, slots=True)
class Commands:
    """Possible commands, presets, resets and saves over one interface, and the hardware inputs.

    ``registers`` hold commands, which are their named values. ``settings`` are all other registers that can be written.
    ``has_control_data`` is true if frames carry commands of the protocol.
    """

    procedures: tuple[Procedure, ...]
    registers: tuple[Register, ...]
    settings: tuple[Register, ...]
    requests: tuple[DataId | Exchange, ...]
    inputs: tuple[Input, ...]
    has_control_data: bool

    @property
    def is_empty(self) -> bool:
        """True if nothing in the model contradicts that there is no command, preset, reset or save."""
        lists = (self.procedures, self.registers, self.settings, self.requests, self.inputs)
        return not any(lists) and not self.has_control_data

    @property
    def may_preset(self) -> bool:
        """True if something, other than a reset, may change the position."""
        if self.settings or self.inputs:
            return True
        return any(_PRESET_WORDS.search(text) for text in (*self._texts_on_commands(), *self._request_texts()))

    @property
    def may_save(self) -> bool:
        """True if something may save settings."""
        if self.settings or any(_SAVE_TO.search(text) for text in self._texts_on_commands()):
            return True
        return any(_SAVE_WORDS.search(text) for text in self._request_texts())

    @property
    def resets(self) -> tuple[DataId, ...]:
        """Requests that reset the encoder or its position."""
        return tuple(request for request in self.requests if isinstance(request, DataId) and request.purpose == "reset")

    def _texts_on_commands(self) -> Iterator[str]:
        """Yield the names and texts of procedures, registers and inputs, without procedures that only send resets."""
        resets = {request.name for request in self.resets}
        for procedure in self.procedures:
            requests_sent = {step.data_id for step in procedure.steps if isinstance(step, SendStep)}
            only_sends_resets = bool(requests_sent) and requests_sent <= resets
            if not only_sends_resets:
                yield from (procedure.name, procedure.title, procedure.result, procedure.note)
        for register in (*self.registers, *self.settings):
            yield from (register.name, register.printed_name, register.meaning, register.note)
            for value in _named_values(register):
                yield from (value.name, value.printed_name, value.meaning)
        for pin in self.inputs:
            yield from (pin.name, pin.printed_name, pin.meaning, pin.low, pin.high, pin.note)

    def _request_texts(self) -> Iterator[str]:
        """Yield the names and meanings of T-format requests except resets, and the frames of other requests."""
        for request in self.requests:
            if not isinstance(request, DataId):
                yield request.request
            elif request.purpose != "reset":
                yield from (request.name, request.meaning)


def commands_over(device: Device, interface: Interface) -> Commands:
    """Return everything with which a user can change something over an interface or at an input.

    These are procedures that write or send something, writable registers, requests that do not only read, inputs, and
    commands of the protocol. The register that selects a bank is left out.
    """
    # A register that opens another one for writing counts as a setting, even if its values look like commands.
    openers = {register.opened_by for register in device.registers}
    bank_select = interface.bank_select if isinstance(interface, Biss) else None
    command_registers: list[Register] = []
    settings: list[Register] = []
    for register in device.registers_over(interface.name):
        if not register.writable:
            continue
        if holds_commands(register) and register.name not in openers:
            command_registers.append(register)
        elif register.name != bank_select:
            settings.append(register)
    procedures = [procedure for procedure in device.procedures if procedure.interface == interface.name]
    return Commands(
        procedures=tuple(procedure for procedure in procedures if _changes_encoder(procedure)),
        registers=tuple(command_registers),
        settings=tuple(settings),
        requests=tuple(
            request for request in _requests_of_interface(interface) if request.purpose not in _READING_PURPOSES
        ),
        inputs=device.inputs,
        has_control_data=isinstance(interface, Biss) and bool(interface.control_data),
    )


def holds_commands(register: Register) -> bool:
    """Return whether the named values of a register are commands: values that are written once, unlike settings."""
    is_written_once = not register.readable or register.clears_itself
    return register.writable and is_written_once and bool(_named_values(register))


def _named_values(register: Register) -> tuple[Value, ...]:
    """Return the named values of all fields."""
    return tuple(value for field in register.layout.fields for value in field.values)


def _changes_encoder(procedure: Procedure) -> bool:
    """Return whether a procedure writes or sends something."""
    return any(isinstance(step, (WriteStep, ModifyStep, SendStep)) for step in procedure.steps)


def _requests_of_interface(interface: Interface) -> Iterator[DataId | Exchange]:
    """Yield the T-format requests and the other exchanges of an interface."""
    if isinstance(interface, Rs485):
        yield from interface.data_ids
    if isinstance(interface, (Rs485, Spi)):
        yield from interface.exchanges


def remedied(text: str, names: Sequence[str]) -> Iterator[Statement]:
    """Yield the remedy ``text`` with references to manual steps, of which ``names`` are the names."""
    if not names:
        yield from spec_text(text, label="Remedy")
        return
    steps = list_parts([Reference("by-hand", name, heading(name)) for name in names], " or ")
    introduction = f"{as_sentence(text)} Steps: " if text else "Steps: "
    yield statement(introduction, *steps, label="Remedy")


def with_steps(text: str, names: Sequence[str]) -> str:
    """Return the remedy as plain text with the titles of its manual steps, which the hardware page describes."""
    if not names:
        return text
    titles = " or ".join(map(heading, names))
    return f"{as_sentence(text)} Steps on the hardware page: {titles}".strip()
