"""Commands, presets, resets and saving: which of them an encoder has, and statements about procedures and inputs.

Also alarms: statements about them, and the meaning and remedy of the flags that report them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ..model import (
    Alarm,
    Argument,
    Biss,
    DataId,
    Device,
    Exchange,
    Field,
    Flag,
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
    Sources,
    Spi,
    Step,
    Unused,
    Value,
    WaitStep,
    WriteStep,
    assert_never,
    member_named,
)
from ..model.record import dataclass
from .errata import describe_erratum, errata_affecting
from .names_and_evidence import heading, order_codes_text, register_at, register_field, short_number, title_of
from .names_and_evidence import register_reference as reference_to_register
from .text import (
    CodeText,
    Reference,
    Statement,
    TextPart,
    as_sentence,
    list_parts,
    spec_text,
    statement,
    time_text,
    volts,
)


def describe_procedure(device: Device, procedure: Procedure) -> Iterator[Statement]:
    """Yield all statements about a procedure except its title, its arguments and its steps."""
    yield from about_procedure(procedure)
    yield from spec_text(procedure.note)
    yield from map(describe_erratum, errata_affecting(device, f"procedures.{procedure.name}"))


def about_procedure(procedure: Procedure) -> Iterator[Statement]:
    """Yield the precondition and the result of a procedure, if the spec states them."""
    yield from spec_text(procedure.precondition, label="Precondition")
    yield from spec_text(procedure.result, label="Result")


def describe_argument(device: Device, argument: Argument) -> Statement:
    """Return the meaning of an argument of a procedure and the register that it is written to.

    If that register has several meanings, the statement also names the one that the argument has.
    """
    meaning_sentence = f"{as_sentence(argument.meaning)} " if argument.meaning else ""
    sentence_parts: list[TextPart] = [f"{meaning_sentence}It is written to "]
    sentence_parts.append(reference_to_register(device, argument.of))
    if argument.meant_as:
        sentence_parts += [" as its ", CodeText(argument.meant_as)]
    return statement(*sentence_parts)


def describe_step(device: Device, step: Step) -> Statement:
    """Return a step as an instruction, such as ``Wait at least 20 ms`` or ``Write save to command, register 77h``."""
    match step:
        case WaitStep():
            return statement(f"Wait at least {time_text(step.microseconds)}")
        case SendStep():
            name = CodeText(step.data_id)
            request_bytes = CodeText(step.request.hex(" ").upper())
            return statement("Send the request ", name, f"{_repetition_text(step)}: ", request_bytes)
        case _:
            return statement(*_parts_of_register_step(device, step))


def _repetition_text(send_step: SendStep) -> str:
    """Return how many times a step sends its request and at what interval: `` 10 times, at least 40 µs apart``.

    The text is empty if the request is sent only once.
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
    """Return the instruction to check a written value by reading it back, which generated code does before using it.

    An empty ``field`` means the whole register.
    """
    register_or_field = _register_or_field(device, register.name, field)
    stop_condition = "and stop unless it holds the written value"
    return statement("Read back ", register_or_field, f", {register_at(register)}, {stop_condition}")


def _parts_of_register_step(device: Device, step: RegisterStep) -> Iterator[TextPart]:
    """Yield the parts of the instruction to read, poll or write a register, or one of its fields.

    If the step writes a fixed value to a whole register, the instruction ends with the bytes to write.
    """
    register = device.register(step.register)
    register_reference = reference_to_register(device, register.name)
    addresses = register_at(register)
    match step:
        case ReadStep(field=field_name):
            register_or_field = _register_or_field(device, register.name, field_name)
            yield from ("Read ", register_or_field, f", {addresses}")
        case PollStep(field=field_name, value=value):
            register_or_field = _register_or_field(device, register.name, field_name)
            yield from ("Poll ", register_or_field, f", {addresses}, until it is {value}")
        case WriteStep(value_name=value_name, value=value):
            yield from ("Write ", *_parts_of_written_value(value_name, value), " to ")
            # An argument with the name of the register already says which register it is.
            if value is None and value_name == register.name:
                yield addresses
            else:
                yield from (register_reference, f", {addresses}")
            if value is not None:
                bytes_to_write = register.bytes_of(value).hex(" ").upper()
                yield from (": ", CodeText(bytes_to_write))
        case ModifyStep(field=field_name, value_name=value_name, value=value):
            register_or_field = _register_or_field(device, register.name, field_name)
            yield from ("Write ", *_parts_of_written_value(value_name, value), " to ")
            yield from (register_or_field, f", {addresses}, leaving the register's other fields unchanged")
        case _:
            assert_never(step)


def _parts_of_written_value(name: str, value: int | None) -> tuple[TextPart, ...]:
    """Return the name of a value or, if ``value`` is None, the name of the argument whose value is written."""
    return ("the argument ", CodeText(name)) if value is None else (CodeText(name),)


def _register_or_field(device: Device, register: str, field: str) -> TextPart:
    """Return a reference to a field of a register, or to the register if ``field`` is empty."""
    return register_field(device, f"{register}.{field}" if field else register)


#: Words that manuals use for a change of the position, in names and in texts.
_PRESET_WORDS = re.compile(
    r"(?i)preset|pres(?:\b|_)|zero|offset|origin|datum|home|referenc|position to 0|set[ _-]?(?:the )?position"
)
#: Words that manuals use for keeping settings when the power is off. A request that writes a byte of memory does not
#: match.
_SAVE_WORDS = re.compile(r"(?i)\bsav(?:e|ing)|_save|stor(?:e|ing)|permanent|programming")
_SAVE_TO = re.compile(rf"{_SAVE_WORDS.pattern}|eeprom|flash|non-?volatile")
#: Purposes of the requests that only read.
_READING_PURPOSES = frozenset(("position", "read", "capture"))


@dataclass(frozen=True, slots=True)
class Commands:
    """Everything that may be a command, preset, reset or save over one interface or at a hardware input.

    ``registers`` are the registers whose named values are commands, and ``settings`` all other writable registers.
    ``has_control_data`` is True if the frames of the protocol carry commands.
    """

    procedures: tuple[Procedure, ...]
    registers: tuple[Register, ...]
    settings: tuple[Register, ...]
    requests: tuple[DataId | Exchange, ...]
    inputs: tuple[Input, ...]
    has_control_data: bool

    @property
    def is_empty(self) -> bool:
        """True if the spec describes nothing that may be a command, preset, reset or save."""
        all_commands = (self.procedures, self.registers, self.settings, self.requests, self.inputs)
        return not any(all_commands) and not self.has_control_data

    @property
    def may_preset(self) -> bool:
        """True if anything other than a reset may change the position."""
        if self.settings or self.inputs:
            return True
        texts = (*self._texts_about_commands(), *self._texts_about_requests())
        return any(_PRESET_WORDS.search(text) for text in texts)

    @property
    def may_save(self) -> bool:
        """True if anything may save settings."""
        if self.settings:
            return True
        may_command_save = any(_SAVE_TO.search(text) for text in self._texts_about_commands())
        may_request_save = any(_SAVE_WORDS.search(text) for text in self._texts_about_requests())
        return may_command_save or may_request_save

    @property
    def resets(self) -> tuple[DataId, ...]:
        """Requests that reset the encoder or its position."""
        t_format_requests = [request for request in self.requests if isinstance(request, DataId)]
        return tuple(request for request in t_format_requests if request.purpose == "reset")

    def _texts_about_commands(self) -> Iterator[str]:
        """Yield the names and texts of registers, inputs, and procedures that do more than send resets."""
        reset_names = {request.name for request in self.resets}
        for procedure in self.procedures:
            requests_sent = {step.data_id for step in procedure.steps if isinstance(step, SendStep)}
            only_sends_resets = bool(requests_sent) and requests_sent <= reset_names
            if not only_sends_resets:
                yield from (procedure.name, procedure.title, procedure.result, procedure.note)
        for register in (*self.registers, *self.settings):
            yield from (register.name, register.printed_name, register.meaning, register.note)
            for value in _named_values(register):
                yield from (value.name, value.printed_name, value.meaning)
        for hardware_input in self.inputs:
            yield from (hardware_input.name, hardware_input.printed_name, hardware_input.meaning)
            yield from (hardware_input.low, hardware_input.high, hardware_input.note)

    def _texts_about_requests(self) -> Iterator[str]:
        """Yield the names and meanings of T-format requests except resets, and the frame names of other requests."""
        for request in self.requests:
            if not isinstance(request, DataId):
                yield request.request
            elif request.purpose != "reset":
                yield from (request.name, request.meaning)


def commands_over(device: Device, interface: Interface) -> Commands:
    """Return everything with which a user can change something over an interface or at an input.

    These are procedures that write or send something, writable registers, requests that change something, inputs, and
    commands of the protocol. The register that selects the bank is omitted.
    """
    # A register that opens another register for writing counts as a setting, even if its values look like commands.
    opening_registers = {register.opened_by for register in device.registers}
    bank_select = interface.bank_select if isinstance(interface, Biss) else None
    command_registers: list[Register] = []
    settings: list[Register] = []
    for register in device.registers_over(interface.name):
        if not register.writable:
            continue
        if holds_commands(register) and register.name not in opening_registers:
            command_registers.append(register)
        elif register.name != bank_select:
            settings.append(register)
    procedures = [procedure for procedure in device.procedures if procedure.interface == interface.name]
    requests = _requests_of_interface(interface)
    return Commands(
        procedures=tuple(filter(_changes_encoder, procedures)),
        registers=tuple(command_registers),
        settings=tuple(settings),
        requests=tuple(request for request in requests if request.purpose not in _READING_PURPOSES),
        inputs=device.inputs,
        has_control_data=isinstance(interface, Biss) and bool(interface.control_data),
    )


def holds_commands(register: Register) -> bool:
    """Return whether the named values of a register are commands.

    Unlike a setting, a command is written once: the register cannot be read, or it returns to its default by itself.
    """
    is_written_once = not register.readable or register.clears_itself
    return register.writable and is_written_once and bool(_named_values(register))


def _named_values(register: Register) -> tuple[Value, ...]:
    """Return the named values of all fields of a register."""
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


def describe_remedy(remedy: str, procedure_names: Sequence[str]) -> Iterator[Statement]:
    """Yield the remedy for a problem, followed by references to the manual procedures with these names.

    Nothing is yielded if the remedy is empty and there are no procedures.
    """
    if not procedure_names:
        yield from spec_text(remedy, label="Remedy")
        return
    links_to_procedures = [Reference(kind="by-hand", name=name, title=heading(name)) for name in procedure_names]
    introduction = f"{as_sentence(remedy)} Steps: " if remedy else "Steps: "
    yield statement(introduction, *list_parts(links_to_procedures, " or "), label="Remedy")


def remedy_with_procedures(remedy: str, procedure_names: Sequence[str]) -> str:
    """Return a remedy as plain text, with the titles of the manual procedures that the hardware page describes."""
    if not procedure_names:
        return remedy
    titles = " or ".join(map(heading, procedure_names))
    return f"{as_sentence(remedy)} Steps on the hardware page: {titles}".strip()


def input_facts(device: Device, hardware_input: Input) -> Iterator[Statement]:
    """Yield the facts about a hardware input: the meaning of its levels, its shortest pulse, and rules for its use."""
    yield from spec_text(hardware_input.low, label="Low level")
    yield from spec_text(hardware_input.high, label="High level")
    if hardware_input.pulse_at_least_us is not None:
        yield statement(f"at least {time_text(hardware_input.pulse_at_least_us)}", label="Pulse")
    if hardware_input.inverts:
        yield statement("A high level inverts ", register_field(device, hardware_input.inverts))
    if hardware_input.needs:
        yield statement(
            "The input has an effect only if it is enabled by ", register_field(device, hardware_input.needs)
        )
    if hardware_input.when_unused:
        yield statement(f"Connect it to {hardware_input.when_unused} when it is not used")


def describe_alarm(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield all statements about an alarm except its name."""
    yield from spec_text(device_alarm.meaning, source=device_alarm.source)
    yield from alarm_facts(device, device_alarm)
    yield from map(describe_erratum, errata_affecting(device, f"alarms.{device_alarm.name}"))


def alarm_facts(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield the flag that shows an alarm, its cause, its duration, its remedy, and the procedures that clear it."""
    if device_alarm.group:
        group = member_named(device.field_groups, device_alarm.group, "field group")
        group_reference = Reference(kind="group", name=group.name, title=title_of(group))
        yield statement(CodeText(device_alarm.field), " in ", group_reference, label="Flag")
    elif device_alarm.register:
        # Without a field, the whole register is the flag, and the path has no period.
        flag_path = f"{device_alarm.register}.{device_alarm.field}".rstrip(".")
        yield statement(register_field(device, flag_path), label="Flag")
    if not device_alarm.implemented and "not implemented" not in device_alarm.meaning.lower():
        yield statement("Not implemented in this encoder")
    yield from spec_text(device_alarm.detected, label="Detected")
    if device_alarm.below_mv is not None:
        yield statement(f"The alarm is raised below {volts(device_alarm.below_mv)}")
    if device_alarm.latch is True:
        yield statement("The alarm stays active until it is reset")
    elif device_alarm.latch is False:
        yield statement("The alarm clears itself when its cause is gone")
    yield from describe_remedy(device_alarm.remedy, device_alarm.by_hand)
    yield from order_codes_text(device_alarm.only)
    if device_alarm.cleared_by:
        procedures = [Reference(kind="procedure", name=name, title=name) for name in device_alarm.cleared_by]
        yield statement(*list_parts(procedures, " or "), label="Cleared by")


def alarm_of(device: Device, field: Field, register: str = "") -> Alarm | None:
    """Return the alarm that a flag shows, or None if the manual describes none.

    ``register`` is the name of the register that contains the flag, or empty for a flag in a frame.
    """
    for alarm in device.alarms:
        if register:
            has_same_owner = alarm.register == register
        else:
            # Alarms in frames belong to the group of their flag.
            has_same_owner = bool(alarm.group) and alarm.group == field.group
        if has_same_owner and alarm.field == field.name:
            return alarm
    return None


def flag_state_meanings(field: Field) -> tuple[str, str]:
    """Return the meanings of a flag while it is active and inactive, or two empty texts for any other field."""
    if not isinstance(field.kind, Flag):
        return "", ""
    return field.kind.when_active, field.kind.when_inactive


def meaning(field: Field, alarm: Alarm | None) -> str:
    """Return the meaning of a report: of an active flag, or of unused bits that differ from the manual.

    For a flag, it is the meaning of its active level, followed by the meaning of the field. If the spec states neither,
    it is the meaning of the alarm or, without an alarm, ``active``. An active flag that the encoder does not implement
    contradicts the manual, unless the manual explains its active level.
    """
    if isinstance(field.kind, Unused):
        difference_text = f"unused bits differ from the documented value {short_number(field.kind.value)}"
        return f"{difference_text}. {as_sentence(field.meaning)}" if field.meaning else difference_text
    when_active, _ = flag_state_meanings(field)
    if not field.implemented:
        return when_active or "active, although the manual says that this encoder does not have it"
    if when_active and field.meaning:
        return f"{as_sentence(when_active)} {as_sentence(field.meaning)}"
    meaning_of_flag = when_active or field.meaning
    meaning_of_alarm = alarm.meaning if alarm is not None else ""
    return meaning_of_flag or meaning_of_alarm or "active"


def remedy(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy for a flag or its alarm, with the titles of its manual procedures, or an empty string."""
    return remedy_with_procedures(remedy_text(field, alarm), manual_steps(field, alarm))


def remedy_text(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy for a flag or, if the flag has none, for its alarm, without manual procedures."""
    return field.remedy or (alarm.remedy if alarm is not None else "")


def manual_steps(field: Field, alarm: Alarm | None) -> tuple[str, ...]:
    """Return the names of the manual procedures recommended for a flag or, if it has none, for its alarm."""
    return field.by_hand or (alarm.by_hand if alarm is not None else ())


def alarm_source(field: Field, alarm: Alarm | None) -> Sources:
    """Return the source of a flag's alarm, or the source of the flag if there is no alarm with a source."""
    return alarm.source if alarm is not None and alarm.source else field.source
