"""Reading and writing a register by name in C, through the user's transport."""

from __future__ import annotations

from collections.abc import Sequence

from ...model import Device, number_to_bytes
from ...plan.limits import OutsideLimits, depends
from ...plan.operations import IsOneOf
from .. import TargetError
from .about import about_access
from .comments import Paragraph
from .expr import Expr, Name
from .structs import Struct


class Access:
    """The functions that read and write a register. A name is empty if the register does not allow that access.

    Registers reserved for the manufacturer are only read. ``struct`` is empty if the register is one plain byte.
    """

    def __init__(self, layout: Struct, has_struct: bool, outside: Sequence[OutsideLimits]) -> None:
        context, register = layout.context, layout.register
        assert register is not None
        self.register, self.outside = register, outside
        self.stem = layout.name.upper()
        self.struct = layout.name if has_struct else ""
        self._layout, self._field = layout, register.layout.fields[0]
        self.values = next((op.values for op in layout.plan.checks if isinstance(op, IsOneOf)), ())
        choice = layout.choice(self._field)
        self.type = self.struct or (choice.type if choice is not None else "uint8_t")
        is_written = register.writable and not register.reserved
        self.read = f"{context.prefix}_read_{register.name}" if register.readable else ""
        self.write = f"{context.prefix}_write_{register.name}" if is_written else ""
        read_state = f"{context.prefix}_read_state" if register.name in state_registers(context.device) else ""
        self.read_about: tuple[Paragraph, ...] = tuple(about_access(context.device, register, False, ""))
        self.write_about: tuple[Paragraph, ...] = tuple(about_access(context.device, register, True, read_state))
        self.bank_address, self.bank = "", 0
        selector = context.device.bank_selector(register)
        if selector:
            selecting = context.device.register(selector)
            if selecting.length > 1:
                raise TargetError(f"'{selector}' selects banks with {selecting.length} bytes; the C target writes one")
            self.bank_address = f"{context.PREFIX}_REG_{selector}_ADDRESS".upper()
            self.bank = number_to_bytes(selecting.layout, register.bank or 0, 8)[0]

    def is_unknown(self, name: str, is_raw: bool) -> Expr:
        """Return the condition that a byte differs from all named values."""
        return self._layout.is_none_of(self._field, Name(name), self.values, is_raw)

    @property
    def write_depends(self) -> bool:
        """True if the function that writes uses the variant."""
        return bool(self.struct) or any(map(depends, self.outside))


def state_registers(device: Device) -> list[str]:
    """Return the readable registers that hold a part of the variant, each once."""
    names = dict.fromkeys(parameter.register for parameter in device.run_time_parameters)
    return [name for name in names if device.register(name).readable]
