"""Build procedures from checked data, with one function for each kind of step."""

from __future__ import annotations

from ..model import (
    Argument,
    Device,
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Rs485,
    SendStep,
    Sources,
    Step,
    WaitStep,
    WriteStep,
)
from .from_mapping import Raw, record, sources


def build_procedures(raw: Raw, device: Device) -> tuple[Procedure, ...]:
    return tuple(_procedure(definition, device) for definition in raw.get("procedures", ()))


def _procedure(raw: Raw, device: Device) -> Procedure:
    arguments = [record(Argument, argument, meant_as=argument.get("as", "")) for argument in raw.get("arguments", ())]
    steps = [_STEPS[step["do"]](step, sources(step) or sources(raw), device) for step in raw["steps"]]
    return record(Procedure, raw, arguments=tuple(arguments), steps=tuple(steps))


def _write(raw: Raw, source: Sources, device: Device) -> Step:
    """Build a write step. A name not among the values of the field, or of a single-field register, is an argument."""
    register, field, name, meaning = (raw.get(key, "") for key in ("register", "field", "value", "meaning"))
    fields_of_register = (candidate.layout.fields for candidate in device.registers if candidate.name == register)
    fields = [field_ for fields in fields_of_register for field_ in fields if field in ("", field_.name)]
    values = fields[0].values if len(fields) == 1 else ()
    value = next((candidate.value for candidate in values if candidate.name == name), None)
    if field:
        return ModifyStep(register, field, name, value, meaning=meaning, source=source)
    return WriteStep(register, name, value, meaning=meaning, source=source)


def _read(raw: Raw, source: Sources, device: Device) -> Step:
    return record(ReadStep, raw, source=source)


def _poll(raw: Raw, source: Sources, device: Device) -> Step:
    return record(PollStep, raw, source=source, value=raw.get("until", 0))


def _wait(raw: Raw, source: Sources, device: Device) -> Step:
    return record(WaitStep, raw, source=source, microseconds=1000 * raw.get("at_least_ms", 0))


def _send(raw: Raw, source: Sources, device: Device) -> Step:
    """Build a send step. The request is one byte, the control field of the data ID."""
    interface = device.find_interface(Rs485)
    data_ids = interface.data_ids if interface is not None else ()
    control = bytes(data_id.control for data_id in data_ids if data_id.name == raw.get("data_id"))
    pause = raw.get("every_at_least_us", 0)
    return record(SendStep, raw, source=source, request=control[:1], microseconds=pause)


_STEPS = {"write": _write, "read": _read, "poll": _poll, "wait": _wait, "send": _send}
