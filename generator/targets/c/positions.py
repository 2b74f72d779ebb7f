"""Positions in C: the functions that convert them to turns and lengths, and those about their range."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Layout, Measurement, cite
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.values import PositionRange, position_ranges
from .context import HeaderContext
from .expressions import CCast, CExpression, CFunction, CNumber, ParameterSpelling, wide_number_function
from .names import DeclaredName


@dataclass(frozen=True, slots=True)
class RangeFunctions:
    """The functions for one range of positions: the modulus, and the distance between two positions.

    If frames have different ranges, ``scope`` is the name of a frame in the names of the functions. Otherwise it is
    empty. ``modulus`` is the function for the counts after which a length wraps around. It is None for an angle, and
    for a position that never wraps around.
    """

    prefix: str
    scope: str
    is_signed: bool
    never_wraps: bool
    modulus: CFunction | None
    turns: CExpression | None
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
    """The functions for positions of a rotary encoder. ``where`` cites the manual."""

    prefix: str
    where: str
    is_signed: bool
    per_turn: CFunction
    ranges: tuple[RangeFunctions, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        yield "counts_per_turn"
        for functions in self.ranges:
            yield from functions.names
        yield from ("turns", "degrees")

    def declared(self) -> Iterator[DeclaredName]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


@dataclass(frozen=True, slots=True)
class LengthPositions:
    """The functions for positions of a linear encoder. ``where`` cites the manual.

    A count is ``step`` in ``unit``, or ``step`` per ``per_counts`` counts. ``per_mm`` units are a millimeter.
    """

    prefix: str
    where: str
    is_signed: bool
    ranges: tuple[RangeFunctions, ...]
    step: CExpression
    step_varies: bool
    unit: str
    per_mm: int
    per_counts: CExpression | None

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        for functions in self.ranges:
            yield from functions.names
        yield from (self.unit, "millimetres")

    def declared(self) -> Iterator[DeclaredName]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


Positions = AnglePositions | LengthPositions


def positions(context: HeaderContext) -> Positions | None:
    """Return the functions that convert positions to turns or lengths, or None if the manual gives no unit."""
    measurement = context.device.measurement_of(context.interface.name)
    return _build_positions(context, measurement) if measurement is not None else None


def _build_positions(context: HeaderContext, measurement: Measurement) -> Positions | None:
    """Return the conversions to angles or to lengths, or None if the manual gives no unit."""
    if measurement.counts_per_turn is not None:
        return _angle_positions(context, measurement, measurement.counts_per_turn)
    if measurement.step_um is not None:
        return _length_positions(context, measurement, measurement.step_um, unit="micrometres", per_mm=1_000)
    if measurement.step_nm is not None:
        return _length_positions(context, measurement, measurement.step_nm, unit="nanometres", per_mm=1_000_000)
    return None


def _angle_positions(context: HeaderContext, measurement: Measurement, counts_per_turn: Expression) -> AnglePositions:
    """Return the functions that convert counts to turns and degrees."""
    ranges = position_ranges(context.device, context.interface)
    where = f"[{cite(measurement.source)}]"
    per_turn = wide_number_function(
        context.scope,
        name=f"{context.prefix}_counts_per_turn",
        expression=counts_per_turn,
        about=f"Return the number of counts in one revolution {where}.",
    )
    return AnglePositions(
        prefix=context.prefix,
        where=where,
        is_signed=any(position_range.signed_field is not None for position_range in ranges),
        per_turn=per_turn,
        ranges=tuple(_range_functions(context, ranges)),
    )


def _length_positions(
    context: HeaderContext, measurement: Measurement, step: Expression, *, unit: str, per_mm: int
) -> LengthPositions:
    """Return the functions that convert counts to lengths, with a step in ``unit``."""
    ranges = position_ranges(context.device, context.interface)
    per_counts = measurement.per_counts
    return LengthPositions(
        prefix=context.prefix,
        where=f"[{cite(measurement.source)}]",
        is_signed=any(position_range.signed_field is not None for position_range in ranges),
        ranges=tuple(_range_functions(context, ranges)),
        step=_cast_to_signed(context.scope, step),
        step_varies=not all(expression.is_constant for expression in measurement.steps),
        unit=unit,
        per_mm=per_mm,
        per_counts=_cast_to_signed(context.scope, per_counts) if per_counts is not None else None,
    )


def _range_functions(context: HeaderContext, ranges: Sequence[PositionRange]) -> Iterator[RangeFunctions]:
    """Yield the functions for the only range of positions. If there are several, each frame has its own functions.

    There are no functions for a range in which the distance between two positions is unknown.
    """
    for position_range in ranges:
        if not position_range.has_difference:
            continue
        if len(ranges) == 1:
            yield _functions_of_range(context, position_range, scope="", layouts=position_range.layouts)
            continue
        for layout in position_range.layouts:
            yield _functions_of_range(context, position_range, scope=f"{layout.name}_", layouts=(layout,))


def _functions_of_range(
    context: HeaderContext, position_range: PositionRange, *, scope: str, layouts: tuple[Layout, ...]
) -> RangeFunctions:
    """Return the functions for one range. ``scope`` is a part of their names, as in ``acme_x_ssi_{scope}modulus``."""
    turns = position_range.measurement.turns
    return RangeFunctions(
        prefix=context.prefix,
        scope=scope,
        is_signed=position_range.signed_field is not None,
        never_wraps=position_range.never_wraps,
        modulus=_build_modulus(context, position_range, f"{context.prefix}_{scope}modulus"),
        turns=context.scope.expression_of(turns) if turns is not None else None,
        one_turn=turns == Expression(1),
        layouts=layouts,
    )


def _build_modulus(context: HeaderContext, position_range: PositionRange, name: str) -> CFunction | None:
    """Return the function for the counts after which a length wraps around, or None if it does not wrap around."""
    measurement = position_range.measurement
    is_signed = position_range.signed_field is not None
    if measurement.modulus is None:
        return None
    wraps = "wraps around" if is_signed else "wraps around to 0"
    about = f"Return the number of counts after which the position {wraps} [{cite(measurement.source)}]."
    if measurement.highest is not None and is_signed:
        about += f" The highest position is {measurement.highest.render()}."
    elif measurement.highest is not None:
        about += f" An offset raises all positions, up to {measurement.highest.render()}."
    return wide_number_function(context.scope, name=name, expression=measurement.modulus, about=about)


def _cast_to_signed(scope: ParameterSpelling, expression: Expression) -> CExpression:
    """Return an expression as a number with a sign, such as ``(int64_t)variant.step``."""
    if expression.is_constant:
        return CNumber(expression.constant, signed=True)
    return CCast("int64_t", scope.expression_of(expression))
