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
    return tuple(
        record(
            Procedure,
            item,
            arguments=tuple(
                record(Argument, entry, meant_as=entry.get("as", "")) for entry in item.get("arguments", ())
            ),
            steps=tuple(_STEPS[step["do"]](step, sources(step) or sources(item), device) for step in item["steps"]),
        )
        for item in raw.get("procedures", ())
    )


def _write(raw: Raw, source: Sources, device: Device) -> Step:
    """Build a write step. A name not among the values of the field, or of a single-field register, is an argument."""
    register, field, name, meaning = (raw.get(key, "") for key in ("register", "field", "value", "meaning"))
    written = (item.layout.fields for item in device.registers if item.name == register)
    fields = [item for items in written for item in items if field in ("", item.name)]
    named = fields[0].values if len(fields) == 1 else ()
    value = next((item.value for item in named if item.name == name), None)
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
    interface = device.over(Rs485)
    known = interface.data_ids if interface is not None else ()
    control = bytes(item.control for item in known if item.name == raw.get("data_id"))
    pause = raw.get("every_at_least_us", 0)
    return record(SendStep, raw, source=source, request=control[:1], microseconds=pause)


_STEPS = {"write": _write, "read": _read, "poll": _poll, "wait": _wait, "send": _send}
