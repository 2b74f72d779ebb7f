"""The functions that convert positions: to turns, degrees and micrometres, and to the distance moved."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Measurement, cite
from ...model.expressions import Expression
from ...model.record import dataclass
from .context import Context
from .expr import Cast, Expr, Number, Scope
from .functions import Function, wide_number_of
from .names import Declared


@dataclass(frozen=True, slots=True)
class AnglePositions:
    """Positions of a rotary encoder, which wrap around after ``turns``, if the manual gives this number.

    ``one_turn`` is True for singleturn encoders.
    """

    prefix: str
    where: str
    is_signed: bool
    per_turn: Function
    turns: Expr | None
    one_turn: bool

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        rolling = ("modulus", "position_difference") if self.turns is not None else ()
        yield from ("counts_per_turn", *rolling, "turns", "degrees")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


@dataclass(frozen=True, slots=True)
class LengthPositions:
    """Positions of a linear encoder, which wrap around after ``modulus``, if the manual gives this number."""

    prefix: str
    where: str
    is_signed: bool
    modulus: Function | None
    step: Expr
    step_varies: bool
    unit: str
    per_mm: int
    per_counts: Expr | None

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        rolling = ("modulus", "position_difference") if self.modulus is not None else ()
        yield from (*rolling, self.unit, "millimetres")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


Positions = AnglePositions | LengthPositions


def positions(context: Context) -> Positions | None:
    """Return the functions that convert the positions of the interface, if the manual gives their unit."""
    measurement = context.device.measurement_of(context.interface.name)
    return _positions(context, measurement) if measurement is not None else None


def _positions(context: Context, measurement: Measurement) -> Positions | None:
    is_signed = context.device.signed_position(context.interface.name) is not None
    scope, prefix, where = context.scope, context.prefix, f"[{cite(measurement.source)}]"
    steps, turns = measurement.counts_per_turn, measurement.turns
    step, fine, counts = measurement.step_um, measurement.step_nm, measurement.per_counts
    if steps is not None:
        about = f"Return the number of counts in one revolution {where}."
        per_turn = wide_number_of(scope, f"{prefix}_counts_per_turn", steps, about)
        one_turn = turns == Expression(1)
        return AnglePositions(
            prefix, where, is_signed, per_turn, scope.of(turns) if turns is not None else None, one_turn
        )
    length = step if step is not None else fine
    if length is not None:
        unit, per_mm = ("micrometres", 1_000) if step is not None else ("nanometres", 1_000_000)
        per_counts = _signed(scope, counts) if counts is not None else None
        modulus = None
        if measurement.modulus is not None:
            wraps = "wraps around" if is_signed else "wraps around to 0"
            about = f"Return the number of counts after which the position {wraps} {where}."
            if measurement.highest is not None and is_signed:
                about += f" The highest position is {measurement.highest.render()}."
            elif measurement.highest is not None:
                about += f" An offset raises all positions, up to {measurement.highest.render()}."
            modulus = wide_number_of(scope, f"{prefix}_modulus", measurement.modulus, about)
        varies = not all(item.is_constant for item in measurement.steps)
        return LengthPositions(
            prefix, where, is_signed, modulus, _signed(scope, length), varies, unit, per_mm, per_counts
        )
    return None


def _signed(scope: Scope, value: Expression) -> Expr:
    return Number(value.constant, signed=True) if value.is_constant else Cast("int64_t", scope.of(value))
