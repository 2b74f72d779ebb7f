"""Values that an encoder must accept, as conditions in C on the struct ``in``."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from codewheel.model import Field, Flag, Text
from codewheel.model.registers import name_with_limits
from proof import in_c
from proof_layout import Codec
from proof_reference import ones


def valid(codec: Codec) -> Iterator[str]:
    for field in codec.fields:
        yield from _valid_field(codec, field)
    for join in codec.layout.joins:
        parts = [_member_value(codec, name) for name in join.fields]
        yield f"{_member_value(codec, join.name)} == {codec.joined(join, *parts)}"
    if codec.layout.unused:
        mask = " | ".join(f"({ones(field)} << {place})" for field, place in codec.layout.unused)
        yield f"({_member_value(codec, 'unused')} & ~({mask})) == 0"
    yield from limits(codec, lambda name: _member_value(codec, name))


def _member_value(codec: Codec, name: str) -> str:
    return f"((number)in.{codec.member(name).name})"


def _valid_field(codec: Codec, field: Field) -> Iterator[str]:
    plain, width = _member_value(codec, field.name), in_c(field.width)
    if isinstance(field.kind, (Flag, Text)):
        return
    if field.number.signed:
        member = f"(long long)in.{codec.member(field.name).name}"
        yield f"{member} >= -(1LL << ({width} - 1)) && {member} <= (1LL << ({width} - 1)) - 1"
        return
    fits = f"({plain} >> {width}) == 0"
    yield f"(({plain} != 0 && {fits}) || {plain} == {field.number.zero_means})" if field.number.zero_means else fits
    allowed = codec.allowed(field)
    if allowed:
        yield " || ".join(f"{plain} == {allowed_value}" for allowed_value in allowed)
    if field.number.power_of_two:
        yield one_bit(field, plain)
    for run in field.runs:
        yield f"{_member_value(codec, run.name)} < {run.modulus}"
    if field.runs:
        yield f"{plain} == {' + '.join(f'{_member_value(codec, run.name)} * {run.divisor}' for run in field.runs)}"


def one_bit(field: Field, value: str) -> str:
    return " || ".join(f"{value} == {1 << bit}ULL" for bit in range(field.widest))


def limits(codec: Codec, value_of: Callable[[str], str]) -> Iterator[str]:
    """Return the limits of a register, which apply to writes and not to reads."""
    register = codec.register
    name = name_with_limits(register) if register is not None else ""
    if register is None or not name:
        return
    if register.min is not None and not (register.min.is_constant and register.min.constant <= 0):
        yield f"{value_of(name)} >= {in_c(register.min)}"
    if register.max is not None:
        yield f"{value_of(name)} <= {in_c(register.max)}"
