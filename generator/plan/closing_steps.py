"""Which steps of a procedure undo what a step before them has opened, as the register that is written says."""

from __future__ import annotations

from collections.abc import Sequence

from ..model import Device, ModifyStep, Register, Step, WriteStep


def closing_steps(device: Device, steps: Sequence[Step]) -> frozenset[int]:
    """The places of the steps that close.

    A step opens where it writes the number by which a register of the procedure is opened (``opened_by``); the first
    step after it that writes another number to the same place closes.
    """
    written = {step.register for step in steps if isinstance(step, WriteStep | ModifyStep)}
    openers = [item for item in device.registers if item.opened_by and item.name in written]
    opened: set[str] = set()
    found: set[int] = set()
    for index, step in enumerate(steps):
        if not isinstance(step, WriteStep | ModifyStep) or step.value is None:
            continue
        of = [item for item in openers if _is_place(step, item)]
        if any(step.value == _opening_number(device, item) for item in of):
            opened.add(step.register)
        elif of and step.register in opened:
            opened.discard(step.register)
            found.add(index)
    return frozenset(found)


def _is_place(step: WriteStep | ModifyStep, opened: Register) -> bool:
    """Whether the step writes what opens the register."""
    if step.register != opened.opened_by:
        return False
    return isinstance(step, WriteStep) or step.field == opened.opened_by_field


def _opening_number(device: Device, opened: Register) -> int:
    """What opens the register."""
    fields = device.register(opened.opened_by).layout.fields
    values = (value for field in fields if opened.opened_by_field in ("", field.name) for value in field.values)
    return next(value.value for value in values if value.name == opened.opened_by_value)
