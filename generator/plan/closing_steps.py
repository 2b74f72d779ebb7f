"""Closing steps of a procedure: each undoes an earlier opening step that wrote to the same register."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Device, ModifyStep, Register, Step, Value, WriteStep, member_named


def closing_steps(device: Device, steps: Sequence[Step]) -> frozenset[int]:
    """Return the indices of the closing steps.

    An opening step writes the number that opens a register (``opened_by``) to which the procedure also writes. Its
    closing step is the next step that writes a different number to the same place. A step that writes an argument is
    neither.
    """
    written_names = {step.register for step in steps if isinstance(step, WriteStep | ModifyStep)}
    used_registers = [register for register in device.registers if register.name in written_names]
    locked_registers = [register for register in used_registers if register.opened_by]
    # Names of the registers to which an opening step was the last to write.
    holding_opening_value: set[str] = set()
    closing_indices: set[int] = set()
    for index, step in enumerate(steps):
        # Without a fixed value, a step writes an argument.
        if not isinstance(step, WriteStep | ModifyStep) or step.value is None:
            continue
        controlled_registers = [register for register in locked_registers if _controls_access(step, register)]
        opening_numbers = (_opening_number(device, register) for register in controlled_registers)
        if any(step.value == opening_number for opening_number in opening_numbers):
            holding_opening_value.add(step.register)
        elif controlled_registers and step.register in holding_opening_value:
            holding_opening_value.discard(step.register)
            closing_indices.add(index)
    return frozenset(closing_indices)


def _controls_access(step: WriteStep | ModifyStep, locked_register: Register) -> bool:
    """Return whether the step writes to the register or field that opens and closes the locked register."""
    if step.register != locked_register.opened_by:
        return False
    # A WriteStep writes the whole register, and with it the field.
    return isinstance(step, WriteStep) or step.field == locked_register.opened_by_field


def _opening_number(device: Device, locked_register: Register) -> int:
    """Return the number of the named value that opens the locked register."""
    opening_register = device.register(locked_register.opened_by)
    named_values: list[Value] = []
    for field in opening_register.layout.fields:
        # If no field is named, any field of the opening register can open the locked register.
        if locked_register.opened_by_field in ("", field.name):
            named_values += field.values
    return member_named(named_values, locked_register.opened_by_value, f"value of '{opening_register.name}'").value
