"""Everything with which a user can change something in an encoder: what contradicts that it has no commands."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..model import (
    Biss,
    DataId,
    Device,
    Exchange,
    Input,
    Interface,
    ModifyStep,
    Procedure,
    Register,
    Rs485,
    SendStep,
    Spi,
    Value,
    WriteStep,
)
from ..model.record import dataclass

#: Words of manuals for changing the position, in names and texts.
_PRESET = re.compile(
    r"(?i)preset|pres(?:\b|_)|zero|offset|origin|datum|home|referenc|position to 0|set[ _-]?(?:the )?position"
)
#: Words of manuals for keeping settings when the power is off. A request that writes a byte of a memory saves nothing.
_SAVE = re.compile(r"(?i)\bsav(?:e|ing)|_save|stor(?:e|ing)|permanent|programming")
_SAVE_TO = re.compile(rf"{_SAVE.pattern}|eeprom|flash|non-?volatile")
#: Purposes of requests that change nothing.
_READING = frozenset(("position", "read", "capture"))


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
        return not (self.procedures or self.registers or self.settings or self.requests or self.inputs) and not (
            self.has_control_data
        )

    @property
    def may_preset(self) -> bool:
        """True if something here, other than a reset, may change the position."""
        texts = (*self._texts(), *self._request_texts())
        return bool(self.settings or self.inputs) or any(map(_PRESET.search, texts))

    @property
    def may_save(self) -> bool:
        """True if something here may keep settings."""
        texts_may_save = any(map(_SAVE_TO.search, self._texts())) or any(map(_SAVE.search, self._request_texts()))
        return bool(self.settings) or texts_may_save

    @property
    def resets(self) -> tuple[DataId, ...]:
        """Requests that reset the encoder or its position."""
        return tuple(request for request in self.requests if isinstance(request, DataId) and request.purpose == "reset")

    def _texts(self) -> Iterator[str]:
        """Yield the names and texts of everything except requests, and except procedures that only send resets."""
        resets = {request.name for request in self.resets}
        for procedure in self.procedures:
            if not resets.issuperset(step.data_id for step in procedure.steps if isinstance(step, SendStep)):
                yield from (procedure.name, procedure.title, procedure.result, procedure.note)
        for register in (*self.registers, *self.settings):
            yield from (register.name, register.printed_name, register.meaning, register.note)
            for value in _values(register):
                yield from (value.name, value.printed_name, value.meaning)
        for pin in self.inputs:
            yield from (pin.name, pin.printed_name, pin.meaning, pin.low, pin.high, pin.note)

    def _request_texts(self) -> Iterator[str]:
        """Yield the names and texts of the requests except resets."""
        for request in self.requests:
            if isinstance(request, DataId):
                yield from () if request.purpose == "reset" else (request.name, request.meaning)
            else:
                yield request.request


def commands_over(device: Device, interface: Interface) -> Commands:
    """Return everything with which a user can change something over an interface or at an input."""
    writable = [register for register in device.registers_over(interface.name) if register.writable]
    locks = {register.opened_by for register in device.registers}
    selects_bank = interface.bank_select if isinstance(interface, Biss) else ""
    registers = [register for register in writable if holds_commands(register) and register.name not in locks]
    excluded_names = {selects_bank, *(register.name for register in registers)}
    procedures = (procedure for procedure in device.procedures if procedure.interface == interface.name)
    return Commands(
        procedures=tuple(filter(_changes_encoder, procedures)),
        registers=tuple(registers),
        settings=tuple(register for register in writable if register.name not in excluded_names),
        requests=tuple(request for request in _requests(interface) if request.purpose not in _READING),
        inputs=device.inputs,
        has_control_data=isinstance(interface, Biss) and bool(interface.control_data),
    )


def holds_commands(register: Register) -> bool:
    """Return whether the named values of a register are commands: those written once, not settings that are kept."""
    is_written_once = not register.readable or register.clears_itself
    return register.writable and is_written_once and bool(_values(register))


def _values(register: Register) -> tuple[Value, ...]:
    """Return the named values of all fields."""
    return tuple(value for field in register.layout.fields for value in field.values)


def _changes_encoder(procedure: Procedure) -> bool:
    """Return whether a procedure writes or sends something."""
    return any(isinstance(step, (WriteStep, ModifyStep, SendStep)) for step in procedure.steps)


def _requests(interface: Interface) -> Iterator[DataId | Exchange]:
    if isinstance(interface, Rs485):
        yield from interface.data_ids
    if isinstance(interface, (Rs485, Spi)):
        yield from interface.exchanges
