"""Limits of the values that may be written to a register, and whether they are stricter than the width."""

from __future__ import annotations

from collections.abc import Mapping

from ..model import Device, Field, Join, Layout, Register, RegisterMeaning
from ..model.expressions import Expression
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a register, or of one of its meanings.

    ``member`` is the limited field or join, or empty if the limits apply to the whole register. ``low`` and ``high``
    are None if the manual gives no limit. ``binds_low`` and ``binds_high`` are true if a value of ``width`` bits,
    signed or unsigned, can be outside the limit. ``stands_for`` is the meaning of 0 if that is a number above the
    limits.
    """

    member: str
    signed: bool
    width: Expression
    low: Expression | None
    high: Expression | None
    binds_low: bool
    binds_high: bool
    stands_for: int

    @property
    def binding(self) -> tuple[tuple[str, Expression], ...]:
        """``min`` and ``max``, each only if a value that fits can be outside it."""
        sides = (("min", self.low, self.binds_low), ("max", self.high, self.binds_high))
        return tuple((side, limit) for side, limit, binds in sides if limit is not None and binds)


def limits_of(device: Device, register: Register, meaning: RegisterMeaning | None = None) -> Limits:
    """Return the limits of a register, or of one of its meanings."""
    low, high = (register.min, register.max) if meaning is None else (meaning.min, meaning.max)
    layout, member = register.layout, limited_member(register)
    join = next((candidate for candidate in layout.joins if candidate.name == member), None)
    fields = _limited_fields(layout, member, join)
    signed = join is None and any(field.number.signed for field in fields)
    width = layout.bits
    if fields:
        width = sum((field.width for field in fields), Expression(0))
    parameter_sets = [variant.parameters for variant in device.variants_over(register.interface)]
    ranges = [(parameters, *_representable_range(width, signed, parameters)) for parameters in parameter_sets]
    # A limit that rules out no value with the factory defaults may do so with other register values.
    run_time_names = {parameter.name for parameter in device.run_time_parameters}
    binds_low = low is not None and (
        not run_time_names.isdisjoint(low.parameters)
        or any(low.value(parameters) > lowest for parameters, lowest, _ in ranges)
    )
    binds_high = high is not None and (
        not run_time_names.isdisjoint(high.parameters)
        or any(high.value(parameters) < highest for parameters, _, highest in ranges)
    )
    zero_means = fields[0].number.zero_means if join is None and fields else 0
    is_above = all(zero_means > highest for _, _, highest in ranges)
    return Limits(
        member=member,
        signed=signed,
        width=width,
        low=low,
        high=high,
        binds_low=binds_low,
        binds_high=binds_high,
        stands_for=zero_means if is_above else 0,
    )


def _limited_fields(layout: Layout, member: str, join: Join | None) -> list[Field]:
    """Return the fields of the limited join, or the limited field, or none if the limits apply to the register."""
    if join is not None:
        return [layout.field(name) for name in join.fields]
    return [layout.field(member)] if member else []


def limited_member(register: Register) -> str:
    """Return the name of the limited field or join, or an empty string if the limits apply to the whole register."""
    layout = register.layout
    if register.limits_of in layout.member_names:
        return register.limits_of
    return layout.fields[0].name if len(layout.fields) == 1 else ""


def _representable_range(width: Expression, signed: bool, parameters: Mapping[str, int]) -> tuple[int, int]:
    """Return the lowest and highest number of this width."""
    bits = width.value(parameters)
    return (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) if signed else (0, (1 << bits) - 1)
