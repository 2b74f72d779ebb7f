"""What a page about a device says of its order codes: the parts, the quantities that follow from them, and what a position counts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .markdown import cited, code, joined, text
from .model import Device, Interface, Parameter
from .page import bit_link, expression, hexadecimal
from .relevant import parameters_of, run_time_names
from .words import number


def parameter_value(parameter: Parameter, value: int) -> str:
    """A quantity as a number; one that is a code, such as an ID, as manuals write it."""
    return hexadecimal(value) if parameter.hexadecimal else number(value)


def part_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Part, meaning, value, what it stands for, source."""
    parameters = {item.name: item for item in device.parameters}
    for part in device.order_code.parts:
        for index, value in enumerate(part.values):
            head = (code(part.name), text(part.meaning)) if index == 0 else ("", "")
            sets = ", ".join(f"{code(name)} = {parameter_value(parameters[name], count)}" for name, count in value.sets.items())
            yield *head, code(value.text), joined([text(value.meaning), sets, _only_with(value.only_with)]), cited(value.source or part.source)
        if part.open:
            shown = code(part.open) if part.open.isalnum() else f"matches {code(part.open)}"
            yield "", "", shown, joined(["accepted as well, shown as unlisted", _only_with(part.open_only_with)]), cited(part.source)


def spelling_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """The label, where it is written so, what stands there for listed values, source."""
    for item in device.order_code.also_written:
        values = "; ".join(f"{code(value.text)} is {code(value.value)}" for value in item.values if value.text != value.value)
        then = f"{code(item.then)} may follow and stands for nothing here" if item.then else ""
        yield code(item.pattern), text(item.where), joined([values, then]), cited(item.source)


def _only_with(combined: Any) -> str:
    return "; ".join(f"only with {code(name)} {', '.join(map(code, values))}" for name, values in combined.items())


def parameter_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """The quantities that follow from an order code: name, meaning, unit, interfaces, what it equals, source."""
    names = run_time_names(device)
    for item in device.parameters:
        if item.name not in names:
            yield code(item.name), text(item.meaning), text(item.unit), _over(device, item), expression(item.equals), cited(item.source)


def run_time_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """The quantities that follow from registers: name, meaning, where they are held or what they equal, value as delivered, source."""
    names = run_time_names(device)
    for item in device.parameters:
        if item.name in names:
            span = f"{number(item.min or 0)} to {number(item.max)}" if item.max is not None else ""
            held = joined([bit_link(item.read_from), span], ", ") if item.read_from else f"equals {expression(item.equals)}"
            unit = f"unit: {text(item.unit)}" if item.unit else ""
            yield code(item.name), joined([text(item.meaning), unit, f"over {_over(device, item)}"]), held, _delivered(device, item), cited(item.source)


def _kinds(device: Device, parameter: Parameter) -> list[str]:
    return [item.kind for item in device.interfaces if parameter in parameters_of(device, item.kind)]


def _over(device: Device, parameter: Parameter) -> str:
    return ", ".join(device.interface(kind).title for kind in _kinds(device, parameter))


def _delivered(device: Device, parameter: Parameter) -> str:
    kinds = _kinds(device, parameter)
    found = next((item.parameters[parameter.name] for item in device.variants if item.interface in kinds), None)
    return parameter_value(parameter, found) if found is not None else ""


def code_tables(device: Device) -> list[dict[str, Any]]:
    """For each interface its order codes with the quantities that follow from them."""
    return [_code_table(device, item) for item in device.interfaces if any(variant.interface == item.kind for variant in device.variants)]


def _code_table(device: Device, interface: Interface) -> dict[str, Any]:
    parameters = [item for item in parameters_of(device, interface.kind) if item.name not in run_time_names(device)]
    variants = [item for item in device.variants if item.interface == interface.kind]
    rows = [(code(item.code), *(parameter_value(part, item.parameters[part.name]) for part in parameters)) for item in variants]
    head = ["Order code", *(code(item.name) for item in parameters)]
    return {"title": f"{interface.title}: {len(variants)} order code{'s' * (len(variants) != 1)}", "head": head, "rows": rows}


def measurement_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """What a position counts, for all interfaces or for one."""
    for over, item in [("", device.measurement), *((part.title, part.measurement) for part in device.interfaces)]:
        if item is not None:
            one_turn = item.turns is not None and item.turns.is_constant and item.turns.constant == 1
            turns = "revolution" if one_turn else "revolutions"
            members = (("counts in a revolution", item.steps_per_turn), (turns, item.turns), ("µm to a count", item.step_um), ("counts in all", item.steps))
            words = [f"{expression(value)} {name}" for name, value in members if value is not None]
            words += [f"{expression(item.highest)} the highest"] if item.highest is not None else []
            yield code(item.of) + (f" over {over}" if over else ""), "<br>".join(words), cited(item.source)
