"""Registers of a virtual encoder: access rules, self-clearing commands with their effects, waits, and the EEPROM.

The model states the access rules, defaults, waits, and the values that steps of procedures poll for. It does not
describe the effect of a command, so the effect is inferred from words in the name of its value: ``save``, ``activate``,
``restore``, ``reset``, ``simulate`` and ``clear``.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Protocol

from ..model import (
    Constant,
    Device,
    Flag,
    Layout,
    PlacedLayout,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    Variant,
    WriteStep,
    number_from_bytes,
    number_to_bytes,
)
from ..order_codes.parameters import after_write
from ..reference import codec


class Host(Protocol):
    """Encoder that has the registers."""

    device: Device
    variant: Variant
    flags: set[str]
    clock: Callable[[], float]

    def place(self, layout: Layout) -> PlacedLayout: ...
    def position_names(self) -> frozenset[str]: ...
    def position_now(self) -> int: ...
    def set_position(self, value: int) -> None: ...
    def add_offset(self, value: int) -> None: ...


class Memory:
    """Registers by address. ``too_early`` counts commands that were not executed because of a missing wait."""

    def __init__(self, encoder: Host, initial_bytes: Mapping[str, bytes]) -> None:
        self._encoder = encoder
        device, interface = encoder.device, encoder.variant.interface
        self.registers = {register.name: register for register in device.registers_over(interface)}
        self.too_early = 0
        self._ready = 0.0
        self._read: deque[str] = deque(maxlen=16)
        self._bytes = {name: bytearray(self._default(register)) for name, register in self.registers.items()}
        for name, data in initial_bytes.items():
            if name not in self.registers or len(data) != self.registers[name].length:
                sizes = (
                    ", ".join(f"{register.name} ({register.length})" for register in self.registers.values()) or "none"
                )
                raise ValueError(f"no register '{name}' of {len(data)} bytes; the registers are: {sizes}")
            self._bytes[name][:] = data
        self._saved = {name: bytes(data) for name, data in self._bytes.items()}
        for register in self.registers.values():
            self._take_over(register)

    def value(self, name: str) -> int:
        """Return the number that a register holds."""
        return number_from_bytes(self.registers[name].layout, bytes(self._bytes[name]))

    def hold(self, address: int, value: int) -> None:
        """Set the byte at an address, even if the master cannot write it. It is the lowest byte if there is no other.

        Raises:
            ValueError: There is no register at this address.
        """
        register = self._register_at(address, write=False) or self._register_at(address, write=True)
        if register is None:
            raise ValueError(f"{self._encoder.variant.code} has no register at 0x{address:02X}")
        self._bytes[register.name][address - register.last_address - 1] = value
        self._saved[register.name] = bytes(self._bytes[register.name])
        self._take_over(register)

    def readable(self, address: int) -> bool:
        """Return whether the master may read the byte at an address."""
        return self._register_at(address, write=False) is not None

    def writable(self, address: int) -> bool:
        """Return whether the master may write the byte at an address now."""
        register = self._register_at(address, write=True)
        return register is not None and self._is_open(register)

    def read(self, address: int) -> int | None:
        """Return the byte at an address, or None if it cannot be read."""
        register = self._register_at(address, write=False)
        if register is None:
            return None
        if address == register.address:
            self._refresh(register)
        byte = self._bytes[register.name][address - register.address]
        if address == register.last_address:
            self._read.append(register.name)
            self._clear_by_reading()
        return byte

    def read_whole(self, address: int) -> int | None:
        """Return the number in the register at an address that has no others, or None if it cannot be read."""
        register = self._register_at(address, write=False)
        if register is None:
            return None
        self._refresh(register)
        self._read.append(register.name)
        self._clear_by_reading()
        return self.value(register.name)

    def write_whole(self, address: int, value: int) -> bool:
        """Write the register at an address that has no others, and return whether the encoder accepts it."""
        register = self._register_at(address, write=True)
        if register is None or not self._is_open(register):
            return False
        self._bytes[register.name][:] = register.bytes_of(value & (1 << 8 * register.length) - 1)
        self._react_to_write(register)
        return True

    def write(self, address: int, value: int) -> bool:
        """Write the byte at an address, and return whether the encoder accepts it."""
        register = self._register_at(address, write=True)
        if register is None or not self._is_open(register):
            return False
        self._bytes[register.name][address - register.address] = value
        if address == register.last_address:
            self._react_to_write(register)
        return True

    def restart(self) -> None:
        """Discard values that were not saved."""
        for name, register in self.registers.items():
            self._bytes[name][:] = self._saved[name] if register.volatile else self._bytes[name]
            self._take_over(register)
        self._ready = 0.0

    def _register_at(self, address: int, write: bool) -> Register | None:
        for register in self.registers.values():
            if register.address <= address <= register.last_address and (
                register.writable if write else register.readable
            ):
                select = self._encoder.device.bank_selector(register)
                if not select or self.value(select) == register.bank:
                    return register
        return None

    def _default(self, register: Register) -> bytes:
        if register.default is not None:
            return register.bytes_of(register.default)
        placed = self._encoder.place(register.layout)
        values: dict[str, int | str | bool] = {}
        for placed_field in placed.fields:
            field = placed_field.field
            documented = field.documented(self._encoder.variant.parameters)
            if not field.carries_data:
                continue
            if documented is not None:
                values[placed_field.name] = documented
            else:
                values[placed_field.name] = False if isinstance(field.kind, Flag) else field.default or 0
        number = 0
        for name, value in values.items():
            try:
                number |= codec.encode(self._encoder.device, placed, {**dict.fromkeys(values, 0), name: value})
            except codec.EncodeError:
                continue  # such as a number for which 0 is not valid
        return number_to_bytes(register.layout, number, 8 * register.length)

    def _is_open(self, register: Register) -> bool:
        if not register.opened_by:
            return True
        opener = self.registers[register.opened_by]
        field = opener.layout.field(register.opened_by_field) if register.opened_by_field else opener.layout.fields[0]
        placed_field = self._encoder.place(opener.layout).find_field(field.name)
        if placed_field is None:
            return False
        opening_value = field.value_named(register.opened_by_value).value
        return self.value(opener.name) >> placed_field.low & placed_field.mask == opening_value

    def _react_to_write(self, register: Register) -> None:
        number = self.value(register.name)
        placed = self._encoder.place(register.layout)
        for placed_field in placed.fields:
            if isinstance(placed_field.field.kind, Constant):
                number = (
                    number & ~(placed_field.mask << placed_field.low)
                    | placed_field.field.kind.value << placed_field.low
                )
        if register.above_max == "default" and register.max is not None and register.default is not None:
            number = register.default if number > register.max.value(self._encoder.variant.parameters) else number
        self._store(register, number)
        for name in register.write_clears:
            self._store(self.registers[name], 0)
        if register.clears_itself or not register.readable:
            self._command(register, number)
        if register.clears_itself:
            self._store(register, register.default or 0)
        if not register.volatile:
            self._saved[register.name] = bytes(self._bytes[register.name])

    def _store(self, register: Register, number: int) -> None:
        self._bytes[register.name][:] = number_to_bytes(register.layout, number, 8 * register.length)
        self._take_over(register)

    def _take_over(self, register: Register) -> None:
        encoder = self._encoder
        encoder.variant = after_write(encoder.device, encoder.variant, register, self.value(register.name))

    def _command(self, register: Register, number: int) -> None:
        """Execute a command, unless the previous one is still being executed."""
        field = register.layout.fields[0]
        name = next((value.name for value in field.values if value.value == number), "")
        now = self._encoder.clock()
        if not name or now < self._ready:
            self.too_early += bool(name)
            return
        self._ready = now + (register.wait_at_least_ms or 0) / 1000
        words = name.split("_")
        if "restore" in words:
            for volatile_register in self.registers.values():
                if volatile_register.volatile:
                    self._store(volatile_register, volatile_register.default or 0)
        if "activate" in words:
            self._activate(register)
        if "save" in words or "restore" in words or "activate" in words:
            self._saved = {register_name: bytes(data) for register_name, data in self._bytes.items()}
        if "reset" in words:
            self.restart()
        if "simulate" in words:
            self._encoder.flags.add(words[-1])
        if "clear" in words:
            self._encoder.flags.discard(words[-1])
        self._answer(register, number)

    def _activate(self, command: Register) -> None:
        """Activate the register whose argument a procedure writes before an activating command."""
        for procedure in self._encoder.device.procedures:
            argument_steps = [step for step in procedure.steps if isinstance(step, WriteStep) and step.value is None]
            if argument_steps and any("activate" in step.value_name for step in _commands(procedure, command)):
                register = self.registers[argument_steps[-1].register]
                meaning = self._meaning(register)
                placed = self._encoder.place(register.layout)
                value = codec.decode(self._encoder.device, placed, self.value(register.name)).values
                number = value.get(register.limits_of or placed.fields[-1].name, self.value(register.name))
                report_value = self._encoder.add_offset if meaning == "offset" else self._encoder.set_position
                report_value(int(number))
                return

    def _meaning(self, register: Register) -> str:
        for meaning in register.meanings:
            name, _, field = meaning.when.partition(".")
            placed_field = self._encoder.place(self.registers[name].layout).find_field(field)
            if placed_field is not None:
                number = self.value(name) >> placed_field.low & placed_field.mask
                names = [value.name for value in placed_field.field.values if value.value == number]
                if meaning.value in names:
                    return meaning.name
        return ""

    def _answer(self, command: Register, number: int) -> None:
        """Set the fields for which a procedure polls after this command."""
        for procedure in self._encoder.device.procedures:
            if any(step.value == number for step in _commands(procedure, command)):
                for step in procedure.steps:
                    if isinstance(step, PollStep):
                        placed_field = self._encoder.place(self.registers[step.register].layout).find_field(step.field)
                        if placed_field is not None:
                            old = self.value(step.register)
                            self._store(
                                self.registers[step.register],
                                old & ~(placed_field.mask << placed_field.low) | step.value << placed_field.low,
                            )

    def _refresh(self, register: Register) -> None:
        """Update a read-only register that has flags or the position."""
        placed = self._encoder.place(register.layout)
        number = self.value(register.name)
        parts = self._encoder.position_names()
        for placed_field in placed.fields:
            if register.writable:
                return
            if placed_field.name in parts:
                number = (
                    number & ~(placed_field.mask << placed_field.low)
                    | (self._encoder.position_now() & placed_field.mask) << placed_field.low
                )
            elif placed_field.name in self._alarms():
                bit = (placed_field.name in self._encoder.flags) != getattr(
                    placed_field.field.kind, "active_low", False
                )
                number = number & ~(1 << placed_field.low) | bit << placed_field.low
        self._bytes[register.name][:] = number_to_bytes(register.layout, number, 8 * register.length)

    def _alarms(self) -> set[str]:
        return {alarm.field for alarm in self._encoder.device.alarms if alarm.register}

    def _clear_by_reading(self) -> None:
        """Clear the alarms of a procedure that only reads, once its registers have been read in order."""
        for procedure in self._encoder.device.procedures:
            names = [step.register for step in procedure.steps if isinstance(step, ReadStep)][:-1]
            cleared = {alarm.name for alarm in self._encoder.device.alarms if procedure.name in alarm.cleared_by}
            if cleared and len(names) + 1 == len(procedure.steps) and list(self._read)[-len(names) :] == names:
                self._encoder.flags -= cleared


def _commands(procedure: Procedure, command: Register) -> list[WriteStep]:
    """Return the steps of a procedure that write a fixed value to a command register."""
    steps = (step for step in procedure.steps if isinstance(step, WriteStep))
    return [step for step in steps if step.register == command.name and step.value is not None]
