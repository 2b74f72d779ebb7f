"""Identification in C: the bytes of the registers that tell what an encoder is, and which order codes answer so."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Register
from . import TargetError
from .c_source import bracketed, c_name, title
from .c_views import Check, IdentityView, Line

if TYPE_CHECKING:
    from .c_device import DeviceView


def identities(view: DeviceView) -> tuple[IdentityView, ...]:
    """What the registers of each interface can tell."""
    registers = list(dict.fromkeys(register.name for register, _ in view.device.identity))
    by_interface: dict[str, list[Register]] = {}
    for name in registers:
        register = view.device.register(name)
        by_interface.setdefault(register.interface, []).append(register)
    return tuple(_identity(view, kind, found, len(by_interface) == 1) for kind, found in by_interface.items())


def _identity(view: DeviceView, kind: str, registers: list[Register], alone: bool) -> IdentityView:
    prefix = view.prefix if alone else f"{view.prefix}_{kind}"
    interface = view.device.interface(kind)
    locals_, checks = [], []
    for register in registers:
        codec = view.register_view(register).codec
        read = f"read->{c_name(register.name)}"
        if codec is None:
            checks.append(Check(_of_byte(view, register, read), ""))
            continue
        local = c_name(register.name, ("read", "variant"))
        locals_.append(f"{codec.name} {local};")
        decoded = f"({codec.name}_decode(variant, {read}, sizeof({read}), &{local}) != {view.maker.name.upper()}_OK)"
        checks.append(Check(f"{decoded} || !{codec.name}_is_expected(variant, &{local})", ""))
    return IdentityView(
        type=view.unique(f"{prefix}_identity"),
        function=view.unique(f"{prefix}_could_be"),
        next=view.unique(f"{prefix}_next_candidate"),
        read=view.unique(f"{prefix}_read_identity"),
        reads=tuple((c_name(item.name), view.register_view(item).access) for item in registers),
        connection=f"{view.maker.name.upper()}_INTERFACE_{kind.upper()}",
        title=interface.title,
        members=tuple(Line(f"uint8_t {c_name(item.name)}[{item.length}];", f"from {item.address:02X}h: {title(item)}") for item in registers),
        locals=tuple(locals_),
        checks=tuple(checks),
        uses_variant=bool(locals_) or any("variant" in item.condition for item in checks),
    )


def _of_byte(view: DeviceView, register: Register, read: str) -> str:
    """A register of one byte, which has no struct."""
    equals = register.layout.fields[0].equals
    if isinstance(equals, str) or equals is None:
        raise TargetError(f"'{register.name}' is compared with something other than a number, which the C target cannot express")
    value = f"{view.PREFIX}_REG_{register.name.upper()}_EXPECTED" if isinstance(equals, int) else bracketed(view.scope.text(equals)) if isinstance(equals, Expression) else ""
    return f"{read}[0] != {value}"
