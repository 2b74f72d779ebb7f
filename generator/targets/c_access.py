"""Reading and writing a register by its name in C, through the transport of the user."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from .. import codec
from ..model import Register
from . import TargetError
from .c_source import Paragraph, addresses, needs_variant, number, title
from .c_views import AccessView, Check, CodecView, Limits

if TYPE_CHECKING:
    from .c_device import DeviceView
    from .c_layout import LayoutSource


def access(view: DeviceView, register: Register, source: LayoutSource, struct: CodecView | None, limits: Limits) -> AccessView:
    """The functions that read and write a register, as its access allows; those reserved to the manufacturer are only read."""
    field = register.layout.fields[0]
    choice = view.choices.get((f"reg_{register.name}", field.name)) if struct is None and field.kind == "choice" else None
    read_checks = tuple(_known(source, is_raw=True)) if choice is not None else ()
    known = tuple(_known(source, is_raw=False)) if choice is not None else ()
    write_checks = (*known, *limits.checks("value")) if struct is None else ()
    milliseconds = register.wait_at_least_ms
    selector = _selector(view, register)
    bank = view.device.register(selector) if selector else None
    if bank is not None and bank.length > 1:
        raise TargetError(f"'{selector}' selects banks with {bank.length} bytes; the C target writes one")
    return AccessView(
        read=view.unique(f"{view.prefix}_read_{register.name}") if register.readable else "",
        write=view.unique(f"{view.prefix}_write_{register.name}") if register.writable and not register.reserved else "",
        read_about=tuple(_about(view, register, "Reads")),
        write_about=tuple(_about(view, register, "Writes")),
        type=struct.name if struct is not None else choice.type if choice is not None else "uint8_t",
        struct=struct.name if struct is not None else "",
        stem=f"{view.PREFIX}_REG_{register.name.upper()}",
        bank_address=f"{view.PREFIX}_REG_{bank.name.upper()}_ADDRESS" if bank is not None else "",
        bank=number(codec.number_to_bytes(bank.layout, register.bank or 0, 8)[0], True) if bank is not None else "",
        read_checks=read_checks,
        write_checks=write_checks,
        wait=number(1000 * milliseconds) if milliseconds is not None else "",
        write_needs_variant=struct is not None or needs_variant(write_checks),
    )


def _known(source: LayoutSource, is_raw: bool) -> Iterable[Check]:
    condition = source.choice_condition(source.layout.fields[0], "value", is_raw)
    if condition:
        yield Check(condition, "RANGE")


def _selector(view: DeviceView, register: Register) -> str:
    """The register that selects the bank of this one; empty where it is in none or the manual names none."""
    return view.device.interface(register.interface).bank_select if register.bank is not None else ""


def _about(view: DeviceView, register: Register, does: str) -> Iterable[Paragraph]:
    waits = f", then waits {register.wait_at_least_ms} ms" if does == "Writes" and register.wait_at_least_ms is not None else ""
    yield f"{does} {title(register)}, {addresses(register)}{waits}."
    selector = _selector(view, register)
    if selector:
        yield f"Selects bank {register.bank} first: a write to {title(view.device.register(selector))}."
    elif register.bank is not None:
        yield f"Bank {register.bank} has to be selected before."
    if does == "Writes" and register.name in state_registers(view):
        yield f"The frames depend on it: {view.prefix}_read_state() makes the variant follow."


def state_registers(view: DeviceView) -> list[str]:
    """The registers that hold what is part of the variant and can be read, each once."""
    names = dict.fromkeys(item.register for item in view.device.run_time_parameters)
    return [name for name in names if view.device.register(name).readable]
