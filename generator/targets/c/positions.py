"""The functions that convert positions: to turns, degrees and micrometres, and to the distance moved."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ...model import Measurement, cite
from ...model.expressions import Expression
from ...plan.measurement import measured
from .context import Context
from .expr import Cast, Expr, Number
from .functions import Function, wide_number_of
from .names import Declared


@dataclass(frozen=True, slots=True)
class AnglePositions:
    """Positions in angles. They wrap around to 0 after ``turns``, or after a single turn if ``one_turn`` is True.

    ``over`` names the interface in words. It is empty if positions mean the same for all interfaces.
    """

    prefix: str
    over: str
    where: str
    per_turn: Function
    turns: Expr | None
    one_turn: bool

    @property
    def names(self) -> Iterator[str]:
        """The functions, by their ends."""
        rolling = ("modulus", "position_difference") if self.turns is not None else ()
        yield from ("counts_per_turn", *rolling, "turns", "degrees")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


@dataclass(frozen=True, slots=True)
class LengthPositions:
    """Positions along a scale. They wrap around to 0 after ``modulus``, if the manual says so."""

    prefix: str
    over: str
    where: str
    modulus: Function | None
    step: Expr
    step_varies: bool

    @property
    def names(self) -> Iterator[str]:
        """The functions, by their ends."""
        rolling = ("modulus", "position_difference") if self.modulus is not None else ()
        yield from (*rolling, "micrometres", "millimetres")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


Positions = AnglePositions | LengthPositions


def positions(context: Context) -> Iterator[Positions]:
    """Yield the functions of each interface, or one set if all interfaces measure in the same way."""
    for group in measured(context.device):
        if group.everywhere:
            yield from _positions(context, context.prefix, "", group.measurement)
            continue
        for interface in group.interfaces:
            own = context.device.measurement_of(interface.name) or group.measurement
            over = f" received over {interface.title}"
            yield from _positions(context, f"{context.prefix}_{interface.name}", over, own)


def _positions(context: Context, prefix: str, over: str, measurement: Measurement) -> Iterator[Positions]:
    scope, where = context.scope, f"[{cite(measurement.source)}]"
    steps, turns, step = measurement.counts_per_turn, measurement.turns, measurement.step_um
    if steps is not None:
        of = f" of a position{over}" if over else ""
        about = f"Return the number of counts in one revolution{of} {where}."
        per_turn = wide_number_of(scope, f"{prefix}_counts_per_turn", steps, about)
        one_turn = turns == Expression(1)
        yield AnglePositions(prefix, over, where, per_turn, scope.of(turns) if turns is not None else None, one_turn)
    elif step is not None:
        wide = Number(step.constant, signed=True) if step.is_constant else Cast("int64_t", scope.of(step))
        modulus = None
        if measurement.modulus is not None:
            about = f"Return the number of counts after which the position{over} wraps around to 0 {where}."
            if measurement.highest is not None:
                about += f" An offset raises all positions, up to {measurement.highest.render()}."
            modulus = wide_number_of(scope, f"{prefix}_modulus", measurement.modulus, about)
        yield LengthPositions(prefix, over, where, modulus, wide, not step.is_constant)
