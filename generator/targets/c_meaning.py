"""Meaning beside counts: what a position is in turns, degrees or micrometres, where it starts again, and how far it has moved."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Interface, Measurement, cite
from .c_source import bracketed, needs_variant, plain_expression, unbracketed
from .c_views import Function

if TYPE_CHECKING:
    from .c_device import DeviceView


def meanings(view: DeviceView) -> Iterable[Function]:
    """The functions of each interface; one set where all interfaces measure alike."""
    measured = [(item, view.device.measurement_of(item.kind)) for item in view.device.interfaces]
    by_formula: dict[tuple[Expression | None, ...], list[tuple[Interface, Measurement]]] = {}
    for interface, measurement in measured:
        if measurement is not None:
            formula = (measurement.steps_per_turn, measurement.turns, measurement.step_um, measurement.steps)
            by_formula.setdefault(formula, []).append((interface, measurement))
    for group in by_formula.values():
        alone = len(by_formula) == 1
        prefixes = [view.prefix] if alone else [f"{view.prefix}_{interface.kind}" for interface, _ in group]
        for prefix, (interface, measurement) in zip(prefixes, group):
            yield from _functions(view, prefix, measurement, "" if alone else f" over {interface.title}")


def _functions(view: DeviceView, prefix: str, measurement: Measurement, over: str) -> Iterable[Function]:
    where = f"[{cite(measurement.source)}]"
    if measurement.steps_per_turn is not None:
        yield from _of_angle(view, prefix, measurement.steps_per_turn, measurement.turns, over, where)
    elif measurement.step_um is not None:
        yield from _of_length(view, prefix, measurement, over, where)


def _wide(view: DeviceView, expression: Expression) -> str:
    """The expression as a number of 64 bits."""
    text = view.scope.text(expression)
    return unbracketed(text) if expression.terms and expression.terms[0].is_power else f"(uint64_t){bracketed(text)}"


def _of_angle(view: DeviceView, prefix: str, steps: Expression, turns: Expression | None, over: str, where: str) -> Iterable[Function]:
    per_turn = f"{prefix}_steps_per_turn"
    yield _function(view, per_turn, "uint64_t", "", _wide(view, steps), f"Counts of one revolution{over} {where}.")
    if turns is not None:
        one = turns == Expression(1)
        product = f"{per_turn}(variant)" if one else f"{per_turn}(variant) * {bracketed(view.scope.text(turns))}"
        about = f"The position{over} starts again at 0 after so many counts" + (": those of one revolution." if one else ": those of all revolutions.")
        yield from _rolling(view, prefix, product, about)
    steps_line = f"const uint64_t steps = {per_turn}(variant);"
    lines: tuple[str, ...] = (steps_line, "return (double)position / (double)steps;")
    yield Function(view.unique(f"{prefix}_turns"), "double", "uint64_t position", lines, f"A position{over} in revolutions.", True)
    lines = (steps_line, "const uint64_t angle = position % steps;", "return ((double)angle * 360.0) / (double)steps;")
    yield Function(view.unique(f"{prefix}_degrees"), "double", "uint64_t position", lines, f"A position{over} in degrees within its revolution, from 0 to below 360.", True)


def _of_length(view: DeviceView, prefix: str, measurement: Measurement, over: str, where: str) -> Iterable[Function]:
    step = measurement.step_um
    assert step is not None
    if measurement.steps is not None:
        shifted = f" An offset moves all positions up, to {plain_expression(measurement.highest)} at most." if measurement.highest is not None else ""
        about = f"The position{over} starts again at 0 after so many counts {where}.{shifted}"
        yield from _rolling(view, prefix, _wide(view, measurement.steps), about)
    width = str(step.constant) if step.is_constant else f"(int64_t){bracketed(view.scope.text(step))}"
    lines: tuple[str, ...] = (f"const int64_t step = {width};", "return position * step;")
    yield Function(view.unique(f"{prefix}_micrometres"), "int64_t", "int64_t position", lines, f"A position{over} in micrometres {where}; the product has to fit into 64 bits.", needs_variant(lines))
    lines = (f"const int64_t micrometres = {prefix}_micrometres(variant, position);", "return (double)micrometres / 1000.0;")
    yield Function(view.unique(f"{prefix}_millimetres"), "double", "int64_t position", lines, f"A position{over} in millimetres.", True)


def _rolling(view: DeviceView, prefix: str, modulus: str, about: str) -> Iterable[Function]:
    name = f"{prefix}_modulus"
    yield _function(view, name, "uint64_t", "", modulus, about)
    text = f"{view.maker.name}_difference(now, before, {name}(variant))"
    about = "How far the position has moved from before to now, the shorter way round. Added up, the differences count on where the position starts again."
    yield _function(view, f"{prefix}_position_difference", "int64_t", "uint64_t now, uint64_t before", text, about)


def _function(view: DeviceView, name: str, type_: str, arguments: str, value: str, about: str) -> Function:
    return Function(view.unique(name), type_, arguments, (f"return {value};",), about, needs_variant(value))
