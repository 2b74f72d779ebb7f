"""The functions that convert positions: to turns, degrees and micrometres, and to the distance moved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Layout, Measurement, cite
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.values import PositionRange, position_ranges
from .constants import Function, wide_number_of
from .context import Context
from .expr import Cast, Expr, Number, Scope
from .names import Declared


@dataclass(frozen=True, slots=True)
class RangeFunctions:
    """The functions about the range of positions: the modulus, and the distance between two positions.

    ``scope`` precedes their names: it is empty, or the name of a frame with a range that other frames do not have.
    ``modulus`` is None for an angle, and for a position that never wraps around.
    """

    prefix: str
    scope: str
    is_signed: bool
    never_wraps: bool
    modulus: Function | None
    turns: Expr | None
    one_turn: bool
    layouts: tuple[Layout, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        if not self.never_wraps:
            yield f"{self.scope}modulus"
        yield f"{self.scope}position_difference"


@dataclass(frozen=True, slots=True)
class AnglePositions:
    """Positions of a rotary encoder."""

    prefix: str
    where: str
    is_signed: bool
    per_turn: Function
    ranges: tuple[RangeFunctions, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        yield "counts_per_turn"
        for functions in self.ranges:
            yield from functions.names
        yield from ("turns", "degrees")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


@dataclass(frozen=True, slots=True)
class LengthPositions:
    """Positions of a linear encoder."""

    prefix: str
    where: str
    is_signed: bool
    ranges: tuple[RangeFunctions, ...]
    step: Expr
    step_varies: bool
    unit: str
    per_mm: int
    per_counts: Expr | None

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        for functions in self.ranges:
            yield from functions.names
        yield from (self.unit, "millimetres")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


Positions = AnglePositions | LengthPositions


def positions(context: Context) -> Positions | None:
    """Return the functions that convert the positions of the interface, if the manual gives their unit."""
    measurement = context.device.measurement_of(context.interface.name)
    return _positions(context, measurement) if measurement is not None else None


def _positions(context: Context, measurement: Measurement) -> Positions | None:
    position_ranges_ = position_ranges(context.device, context.interface)
    is_signed = any(position_range.signed_field is not None for position_range in position_ranges_)
    scope, prefix, where = context.scope, context.prefix, f"[{cite(measurement.source)}]"
    ranges = tuple(_range_functions(context, position_ranges_))
    step, fine, counts = measurement.step_um, measurement.step_nm, measurement.per_counts
    if measurement.counts_per_turn is not None:
        about = f"Return the number of counts in one revolution {where}."
        per_turn = wide_number_of(scope, f"{prefix}_counts_per_turn", measurement.counts_per_turn, about)
        return AnglePositions(prefix, where, is_signed, per_turn, ranges)
    length = step if step is not None else fine
    if length is not None:
        unit, per_mm = ("micrometres", 1_000) if step is not None else ("nanometres", 1_000_000)
        per_counts = _signed(scope, counts) if counts is not None else None
        varies = not all(step.is_constant for step in measurement.steps)
        return LengthPositions(
            prefix=prefix,
            where=where,
            is_signed=is_signed,
            ranges=ranges,
            step=_signed(scope, length),
            step_varies=varies,
            unit=unit,
            per_mm=per_mm,
            per_counts=per_counts,
        )
    return None


def _range_functions(context: Context, ranges: Sequence[PositionRange]) -> Iterator[RangeFunctions]:
    """Yield the functions of the interface, or those of each frame if their ranges differ."""
    for position_range in ranges:
        if not position_range.has_difference:
            continue
        if len(ranges) == 1:
            yield _functions_of_range(context, position_range, "", position_range.layouts)
            continue
        for layout in position_range.layouts:
            yield _functions_of_range(context, position_range, f"{layout.name}_", (layout,))


def _functions_of_range(
    context: Context, position_range: PositionRange, before: str, layouts: tuple[Layout, ...]
) -> RangeFunctions:
    turns, is_signed = position_range.measurement.turns, position_range.signed_field is not None
    return RangeFunctions(
        prefix=context.prefix,
        scope=before,
        is_signed=is_signed,
        never_wraps=position_range.never_wraps,
        modulus=_modulus(context, position_range, f"{context.prefix}_{before}modulus"),
        turns=context.scope.of(turns) if turns is not None else None,
        one_turn=turns == Expression(1),
        layouts=layouts,
    )


def _modulus(context: Context, position_range: PositionRange, name: str) -> Function | None:
    """Return the function for the number of counts after which a length wraps around."""
    measurement, is_signed = position_range.measurement, position_range.signed_field is not None
    if measurement.modulus is None:
        return None
    wraps = "wraps around" if is_signed else "wraps around to 0"
    about = f"Return the number of counts after which the position {wraps} [{cite(measurement.source)}]."
    if measurement.highest is not None and is_signed:
        about += f" The highest position is {measurement.highest.render()}."
    elif measurement.highest is not None:
        about += f" An offset raises all positions, up to {measurement.highest.render()}."
    return wide_number_of(context.scope, name, measurement.modulus, about)


def _signed(scope: Scope, value: Expression) -> Expr:
    return Number(value.constant, signed=True) if value.is_constant else Cast("int64_t", scope.of(value))
