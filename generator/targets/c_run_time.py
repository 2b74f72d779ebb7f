"""Parameters that registers hold at run time: functions that take them over into the variant from the bytes of a register."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..model import Parameter, Register
from . import TargetError
from .c_layout import LayoutSource
from .c_source import bracketed, c_name, number, title, unsigned
from .c_views import Check, TakeView

if TYPE_CHECKING:
    from .c_device import DeviceView


#: What the function that reads the registers calls its own arguments and locals.
_TAKEN = frozenset(("failure", "result", "taken", "transport", "variant"))


def takers(view: DeviceView) -> Iterable[TakeView]:
    """One function for each register that holds parameters."""
    by_register: dict[str, list[Parameter]] = {}
    for item in view.device.run_time_parameters:
        by_register.setdefault(item.register, []).append(item)
    for name, parameters in by_register.items():
        yield _taker(view, view.device.register(name), parameters)


def held_in(view: DeviceView, parameter: Parameter) -> str:
    """What is said of a member of the variant that a register holds."""
    if not parameter.read_from:
        return ""
    register = view.device.register(parameter.register)
    return f"held at run time in {title(register)}, {register.address:02X}h: {view.prefix}_take_{register.name}()"


def _taker(view: DeviceView, register: Register, parameters: list[Parameter]) -> TakeView:
    source = LayoutSource(view, register.layout, f"{view.prefix}_reg_{register.name}", "", register)
    locals_, checks, fills = [], [], []
    for item in parameters:
        field = register.layout.field(item.field)
        if not field.pieces:
            raise TargetError(f"'{item.read_from}' moves with the order code; the C target cannot read a parameter from it")
        name = c_name(item.name, ("bytes", "length", "variant"))
        kind, raw = source.raw(field)
        if field.zero_means:
            kind = unsigned(max(field.widest, field.zero_means.bit_length()))
            locals_ += [f"const {source.raw(field)[0]} {name}_raw = {raw};", f"const {kind} {name} = ({kind})(({name}_raw == 0U) ? {number(field.zero_means)} : {name}_raw);"]
        else:
            locals_.append(f"const {kind} {name} = {raw};")
        condition = _outside(name, item, 1 if field.zero_means else 0, max((1 << field.widest) - 1, field.zero_means))
        checks += [Check(condition, "RANGE")] if condition else []
        member = f"variant->{c_name(item.name)}"
        cast = view.member_type(item)
        fills.append(f"{member} = {name};" if cast == kind else f"{member} = ({cast}){name};")
    return TakeView(
        name=view.unique(f"{view.prefix}_take_{register.name}"),
        length=f"{view.PREFIX}_REG_{register.name.upper()}_LENGTH",
        about=f"Takes over into the variant what the register {title(register)} holds: {', '.join(item.name for item in parameters)}.",
        locals=tuple(locals_),
        checks=tuple(checks),
        fills=tuple(fills),
        bytes=c_name(register.name, _TAKEN),
        access=view.register_view(register).access,
    )


def _outside(name: str, item: Parameter, least: int, largest: int) -> str:
    """When a value is none that the parameter can have."""
    conditions = [f"{name} < {number(item.min)}"] if item.min and item.min > least else []
    conditions += [f"{name} > {number(item.max)}"] if item.max is not None and item.max < largest else []
    return conditions[0] if len(conditions) == 1 else " || ".join(map(bracketed, conditions))
