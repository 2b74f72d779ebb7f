"""Closing steps of a procedure: each one undoes an earlier opening step that wrote to the same register."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Device, ModifyStep, Register, Step, WriteStep, member_named


def closing_steps(device: Device, steps: Sequence[Step]) -> frozenset[int]:
    """Return the indices of the closing steps.

    An opening step writes the number that opens a register used in the procedure (``opened_by``). Its closing step is
    the next step that writes a different number to the same place.
    """
    written = {step.register for step in steps if isinstance(step, WriteStep | ModifyStep)}
    openers = [register for register in device.registers if register.opened_by and register.name in written]
    opened: set[str] = set()
    closing: set[int] = set()
    for index, step in enumerate(steps):
        if not isinstance(step, WriteStep | ModifyStep) or step.value is None:
            continue
        opened_here = [register for register in openers if _writes_opening_place(step, register)]
        if any(step.value == _opening_number(device, register) for register in opened_here):
            opened.add(step.register)
        elif opened_here and step.register in opened:
            opened.discard(step.register)
            closing.add(index)
    return frozenset(closing)


def _writes_opening_place(step: WriteStep | ModifyStep, opened: Register) -> bool:
    """Return whether the step writes to the place that opens the register."""
    if step.register != opened.opened_by:
        return False
    return isinstance(step, WriteStep) or step.field == opened.opened_by_field


def _opening_number(device: Device, opened: Register) -> int:
    """Return the number that opens the register."""
    fields = device.register(opened.opened_by).layout.fields
    values = (value for field in fields if opened.opened_by_field in ("", field.name) for value in field.values)
    return member_named(values, opened.opened_by_value, f"value of '{opened.opened_by}'").value
