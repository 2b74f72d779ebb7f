"""Registers of a virtual encoder: access rules, self-clearing commands with their effects, waits, and the EEPROM.

The model states the access rules, defaults, waits, and the values that steps of procedures poll for. The model does not
describe the effect of a command, so the effect is inferred from words in the name of its value: ``save``, ``activate``,
``restore``, ``reset``, ``simulate`` and ``clear``.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

from ..model import (
    Constant,
    Device,
    Field,
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
from ..reference.bits_and_values import bits_of_field, with_bits


class Host(Protocol):
    """The members of the encoder that its registers read and change."""

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
    """Registers by address. ``too_early`` counts commands that were ignored because the master did not wait."""

    def __init__(self, encoder: Host, initial_bytes: Mapping[str, bytes]) -> None:
        self._encoder = encoder
        device = encoder.device
        interface = encoder.variant.interface
        self.registers = {register.name: register for register in device.registers_over(interface)}
        self.too_early = 0
        #: Time from which the encoder executes the next command.
        self._ready_at = 0.0
        #: Names of the registers that were read last.
        self._last_reads: deque[str] = deque(maxlen=16)
        #: Bytes of each register by its name, in the order of their addresses: now, and in the EEPROM.
        self._bytes = {name: bytearray(self._default_bytes(register)) for name, register in self.registers.items()}
        for name, data in initial_bytes.items():
            self._set_initial_bytes(name, data)
        self._saved_bytes = {name: bytes(data) for name, data in self._bytes.items()}
        for register in self.registers.values():
            self._apply_to_parameters(register)

    def _set_initial_bytes(self, register_name: str, data: bytes) -> None:
        """Set the bytes of a register, in ascending order of address.

        Raises:
            ValueError: There is no such register, or it has a different length.
        """
        register = self.registers.get(register_name)
        if register is None or len(data) != register.length:
            names_and_lengths = [
                f"{known_register.name} ({known_register.length})" for known_register in self.registers.values()
            ]
            registers_text = ", ".join(names_and_lengths) or "none"
            raise ValueError(f"no register '{register_name}' of {len(data)} bytes; the registers are: {registers_text}")
        self._bytes[register_name][:] = data

    def value(self, name: str) -> int:
        """Return the number that a register holds."""
        return number_from_bytes(self.registers[name].layout, bytes(self._bytes[name]))

    def hold(self, address: int, value: int) -> None:
        """Set and save the byte at an address, even if the master cannot write it.

        For a register that is accessed whole, and therefore has a single address, this is the last byte.

        Raises:
            ValueError: There is no register at this address.
        """
        register = self._readable_register_at(address) or self._writable_register_at(address)
        if register is None:
            raise ValueError(f"{self._encoder.variant.code} has no register at 0x{address:02X}")
        # A negative index: -1 is the byte at the last address.
        index_from_end = address - register.last_address - 1
        self._bytes[register.name][index_from_end] = value
        self._saved_bytes[register.name] = bytes(self._bytes[register.name])
        self._apply_to_parameters(register)

    def readable(self, address: int) -> bool:
        """Return whether the master may read the byte at an address."""
        return self._readable_register_at(address) is not None

    def writable(self, address: int) -> bool:
        """Return whether the master may write the byte at an address now."""
        register = self._writable_register_at(address)
        return register is not None and self._is_open(register)

    def read(self, address: int) -> int | None:
        """Return the byte at an address, or None if it cannot be read.

        Before its first byte is read, the register is updated with the current position and alarms. Reading the last
        byte can clear alarms.
        """
        register = self._readable_register_at(address)
        if register is None:
            return None
        if address == register.address:
            self._refresh_register(register)
        byte = self._bytes[register.name][address - register.address]
        if address == register.last_address:
            self._react_to_read(register)
        return byte

    def read_whole(self, address: int) -> int | None:
        """Return the number in the only register at an address, or None if it cannot be read."""
        register = self._readable_register_at(address)
        if register is None:
            return None
        self._refresh_register(register)
        self._react_to_read(register)
        return self.value(register.name)

    def write_whole(self, address: int, value: int) -> bool:
        """Write the only register at an address, and return whether the encoder accepts it."""
        register = self._writable_register_at(address)
        if register is None or not self._is_open(register):
            return False
        register_mask = (1 << (8 * register.length)) - 1
        bits_that_fit = value & register_mask
        self._bytes[register.name][:] = register.bytes_of(bits_that_fit)
        self._react_to_write(register)
        return True

    def write(self, address: int, value: int) -> bool:
        """Write the byte at an address, and return whether the encoder accepts it.

        The write takes effect with the last byte of the register: for example, the encoder then executes a command.
        """
        register = self._writable_register_at(address)
        if register is None or not self._is_open(register):
            return False
        self._bytes[register.name][address - register.address] = value
        if address == register.last_address:
            self._react_to_write(register)
        return True

    def restart(self) -> None:
        """Discard the values of volatile registers that were not saved.

        The value of a volatile register is lost without a command that saves it. Other registers save each write.
        """
        for name, register in self.registers.items():
            if register.volatile:
                self._bytes[name][:] = self._saved_bytes[name]
            self._apply_to_parameters(register)
        self._ready_at = 0.0

    def _readable_register_at(self, address: int) -> Register | None:
        """Return the register with a byte at this address that the master may read, or None if there is none."""
        for register in self._registers_at(address):
            if register.readable:
                return register
        return None

    def _writable_register_at(self, address: int) -> Register | None:
        """Return the register with a byte at this address that the master may write, or None if there is none."""
        for register in self._registers_at(address):
            if register.writable:
                return register
        return None

    def _registers_at(self, address: int) -> Iterator[Register]:
        """Yield the registers with a byte at this address in the selected bank."""
        for register in self.registers.values():
            if register.address <= address <= register.last_address:
                # The register that contains the number of the selected bank, or "" for a register outside all banks.
                bank_selector = self._encoder.device.bank_selector(register)
                is_in_selected_bank = not bank_selector or self.value(bank_selector) == register.bank
                if is_in_selected_bank:
                    yield register

    def _default_bytes(self, register: Register) -> bytes:
        """Return the factory default of a register: as the manual gives it, or else from the values of its fields.

        A field whose value cannot be encoded is 0.
        """
        if register.default is not None:
            return register.bytes_of(register.default)
        placed_layout = self._encoder.place(register.layout)
        value_by_field: dict[str, int | str | bool] = {}
        for placed_field in placed_layout.fields:
            if placed_field.field.carries_data:
                value_by_field[placed_field.name] = self._default_value(placed_field.field)
        content = 0
        # One field at a time, with 0 in the others, so that a field that cannot be encoded does not affect them.
        zeros = dict.fromkeys(value_by_field, 0)
        for name, value in value_by_field.items():
            try:
                content |= codec.encode(self._encoder.device, placed_layout, {**zeros, name: value})
            except codec.EncodeError:
                continue  # For example, 0 is not a valid number of this field.
        return number_to_bytes(register.layout, content, 8 * register.length)

    def _default_value(self, field: Field) -> int | str | bool:
        """Return the value of a field in the manual or, without one, its factory default, or false or 0."""
        documented_value = field.documented(self._encoder.variant.parameters)
        if documented_value is not None:
            return documented_value
        if isinstance(field.kind, Flag):
            return False
        return field.default or 0

    def _is_open(self, register: Register) -> bool:
        """Return whether the master can write a register now.

        A register can be protected by another one, ``opened_by``: the master can write it only while a field of the
        other register has a certain value. This is the field ``opened_by_field``, or the first one if it is empty.
        """
        if not register.opened_by:
            return True
        opening_register = self.registers[register.opened_by]
        opening_field = opening_register.layout.fields[0]
        if register.opened_by_field:
            opening_field = opening_register.layout.field(register.opened_by_field)
        placed_field = self._encoder.place(opening_register.layout).find_field(opening_field.name)
        if placed_field is None:
            return False
        opening_value = opening_field.value_named(register.opened_by_value).value
        current_value = bits_of_field(placed_field, self.value(opening_register.name))
        return current_value == opening_value

    def _react_to_write(self, register: Register) -> None:
        """Let a written register take effect: correct its value, execute it if it is a command, and save it."""
        content = self._corrected_content(register, self.value(register.name))
        self._store_number(register, content)
        for name in register.write_clears:
            self._store_number(self.registers[name], 0)
        # A register that cannot be read takes only commands.
        is_command_register = register.clears_itself or not register.readable
        if is_command_register:
            self._execute_command(register, content)
        if register.clears_itself:
            self._store_number(register, register.default or 0)
        if not register.volatile:
            self._saved_bytes[register.name] = bytes(self._bytes[register.name])

    def _corrected_content(self, register: Register, written_content: int) -> int:
        """Return the content that a register has after a write.

        Constant bits keep their value. Some encoders replace a number above the maximum by the default, which the spec
        expresses with ``above_max: default``.
        """
        content = written_content
        for placed_field in self._encoder.place(register.layout).fields:
            kind = placed_field.field.kind
            if isinstance(kind, Constant):
                content = with_bits(content, placed_field, kind.value)
        if register.above_max == "default" and register.max is not None and register.default is not None:
            highest = register.max.value(self._encoder.variant.parameters)
            if content > highest:
                return register.default
        return content

    def _store_number(self, register: Register, number: int) -> None:
        """Store a number in a register, and update the parameters of the encoder that the register holds."""
        self._bytes[register.name][:] = number_to_bytes(register.layout, number, 8 * register.length)
        self._apply_to_parameters(register)

    def _apply_to_parameters(self, register: Register) -> None:
        """Update the parameters of the encoder that a register holds, if any, such as the resolution."""
        encoder = self._encoder
        encoder.variant = after_write(encoder.device, encoder.variant, register, self.value(register.name))

    def _execute_command(self, register: Register, number: int) -> None:
        """Execute the command with this number, unless the encoder is still executing the previous one.

        The effects follow from words in the name of the command: ``save_all``, ``restore_defaults``,
        ``simulate_overheat``, where ``overheat`` is a flag. A number without a name is not a command.
        """
        command_names = [value.name for value in register.layout.fields[0].values if value.value == number]
        if not command_names:
            return
        now = self._encoder.clock()
        is_still_busy = now < self._ready_at  # with the previous command
        if is_still_busy:
            self.too_early += 1
            return
        self._ready_at = now + (register.wait_at_least_ms or 0) / 1000
        words_of_name = command_names[0].split("_")
        last_word = words_of_name[-1]
        if "restore" in words_of_name:
            self._restore_defaults()
        if "activate" in words_of_name:
            self._activate_last_argument(register)
        if not {"save", "restore", "activate"}.isdisjoint(words_of_name):
            self._saved_bytes = {register_name: bytes(data) for register_name, data in self._bytes.items()}
        if "reset" in words_of_name:
            self.restart()
        if "simulate" in words_of_name:
            self._encoder.flags.add(last_word)
        if "clear" in words_of_name:
            self._encoder.flags.discard(last_word)
        self._set_polled_fields(register, number)

    def _restore_defaults(self) -> None:
        """Set all volatile registers to their factory defaults."""
        for register in self.registers.values():
            if register.volatile:
                self._store_number(register, register.default or 0)

    def _activate_last_argument(self, command_register: Register) -> None:
        """Activate the value that the user wrote before an activate command, such as the preset.

        A procedure shows which register this is: it writes an argument to the register, and then writes a value with
        ``activate`` in its name to the command register. The first such procedure applies.
        """
        for procedure in self._encoder.device.procedures:
            write_steps = [step for step in procedure.steps if isinstance(step, WriteStep)]
            # A step without a fixed value writes an argument of the procedure.
            argument_steps = [step for step in write_steps if step.value is None]
            command_steps = _command_steps(procedure, command_register)
            activates = any("activate" in step.value_name for step in command_steps)
            if argument_steps and activates:
                last_step = argument_steps[-1]
                self._activate_argument(self.registers[last_step.register])
                return

    def _activate_argument(self, register: Register) -> None:
        """Preset the position to the number in a register, or use the number as an offset.

        It is an offset if the register currently has the meaning ``offset``. The number is in the field or joined
        number ``limits_of``, or in the last field, or else it is the number in the whole register.
        """
        placed_layout = self._encoder.place(register.layout)
        content = self.value(register.name)
        values = codec.decode(self._encoder.device, placed_layout, content).values
        argument_name = register.limits_of or placed_layout.fields[-1].name
        argument = int(values.get(argument_name, content))
        if self._current_meaning(register) == "offset":
            self._encoder.add_offset(argument)
        else:
            self._encoder.set_position(argument)

    def _current_meaning(self, register: Register) -> str:
        """Return the name of the meaning that a register has now, such as ``offset``, or an empty string.

        The meaning can depend on a field of another register: ``meaning.when`` is this field, such as
        ``mode.preset_type``, and ``meaning.value`` is the name of the value that it must have.
        """
        for meaning in register.meanings:
            deciding_register, _, deciding_field = meaning.when.partition(".")
            placed_layout = self._encoder.place(self.registers[deciding_register].layout)
            placed_field = placed_layout.find_field(deciding_field)
            if placed_field is None:
                continue
            field_bits = bits_of_field(placed_field, self.value(deciding_register))
            value_names = [value.name for value in placed_field.field.values if value.value == field_bits]
            if meaning.value in value_names:
                return meaning.name
        return ""

    def _set_polled_fields(self, command_register: Register, command: int) -> None:
        """Set the fields that procedures poll after this command to the value for which they wait."""
        for procedure in self._encoder.device.procedures:
            commands = [step.value for step in _command_steps(procedure, command_register)]
            if command not in commands:
                continue
            for step in procedure.steps:
                if isinstance(step, PollStep):
                    self._set_field(self.registers[step.register], step.field, step.value)

    def _set_field(self, register: Register, field_name: str, value: int) -> None:
        """Store a value in a field of a register. A field that this order code lacks is ignored."""
        placed_field = self._encoder.place(register.layout).find_field(field_name)
        if placed_field is not None:
            content = with_bits(self.value(register.name), placed_field, value)
            self._store_number(register, content)

    def _refresh_register(self, register: Register) -> None:
        """Update the position and the alarms in a register before the master reads it.

        A register that the master can write has neither, and is unchanged.
        """
        if register.writable:
            return
        content = self.value(register.name)
        position_names = self._encoder.position_names()
        alarm_names = {alarm.flag_name for alarm in self._encoder.device.alarms if alarm.register}
        for placed_field in self._encoder.place(register.layout).fields:
            if placed_field.name in position_names:
                position_bits = self._encoder.position_now() & placed_field.mask
                content = with_bits(content, placed_field, position_bits)
            elif placed_field.name in alarm_names:
                is_active = placed_field.name in self._encoder.flags
                is_active_low = getattr(placed_field.field.kind, "active_low", False)
                alarm_bit = int(is_active != is_active_low)
                content = with_bits(content, placed_field, alarm_bit)
        self._bytes[register.name][:] = number_to_bytes(register.layout, content, 8 * register.length)

    def _react_to_read(self, register: Register) -> None:
        """Clear alarms if the master has just read the registers that a procedure reads to clear them.

        Such a procedure consists only of reads. Its last step reads whether the alarms have been cleared, so they are
        cleared once all steps before it have been carried out.
        """
        self._last_reads.append(register.name)
        for procedure in self._encoder.device.procedures:
            read_steps = [step for step in procedure.steps if isinstance(step, ReadStep)]
            only_reads = len(read_steps) == len(procedure.steps)
            registers_to_read = [step.register for step in read_steps[:-1]]
            if not only_reads or not registers_to_read:
                continue
            read_count = len(registers_to_read)
            last_reads = list(self._last_reads)[-read_count:]
            if last_reads == registers_to_read:
                cleared_alarms = [alarm for alarm in self._encoder.device.alarms if procedure.name in alarm.cleared_by]
                self._encoder.flags -= {alarm.flag_name for alarm in cleared_alarms}


def _command_steps(procedure: Procedure, command_register: Register) -> list[WriteStep]:
    """Return the steps of a procedure that write a fixed value to a command register."""
    write_steps = [step for step in procedure.steps if isinstance(step, WriteStep)]
    return [step for step in write_steps if step.register == command_register.name and step.value is not None]
