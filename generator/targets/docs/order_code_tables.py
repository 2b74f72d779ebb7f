"""Tables of order codes: their parts, the quantities that they set, and the unit of the position."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ...model import Alternative, Answer, Device, Interface, Parameter
from ...order_codes.parameters import parameters_of, run_time_names
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.measurement import measurement, own_ranges, position_range
from ...say.name import heading
from ...say.order_code import open_values
from ...say.parameter import origin
from ...say.parameter import value as parameter_value
from .page_links import style_beside


def part_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of part, meaning, value, meaning of the value, source."""
    parameters = {item.name: item for item in device.parameters}
    for part in device.order_code.parts:
        for index, value in enumerate(part.values):
            head = (code(part.name), text(part.meaning)) if index == 0 else ("", "")
            sets = ", ".join(
                f"{code(name)} = {parameter_value(parameters[name], count)}" for name, count in value.sets.items()
            )
            yield (
                *head,
                code(value.text),
                joined([text(value.meaning), sets, _only_with(value.only_with)]),
                cited(value.source or part.source),
            )
        for item in open_values(part):
            shown = joined([STYLE.sentence(item), _only_with(part.open_only_with)])
            yield "", "", "", shown, cited(part.source)


def spelling_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of pattern on the label, where it is used, its texts for the listed values, source."""
    for item in device.order_code.also_written:
        values = "; ".join(
            f"{code(value.text)} is {code(value.value)}" for value in item.values if value.text != value.value
        )
        then = f"{code(item.then)} may follow and has no meaning here" if item.then else ""
        yield code(item.pattern), text(item.where), joined([values, then]), cited(item.source)


def _only_with(combined: Any) -> str:
    return "; ".join(f"only with {code(name)} {', '.join(map(code, values))}" for name, values in combined.items())


def parameter_rows(device: Device, kind: str) -> Iterator[tuple[str, ...]]:
    """Yield the name, meaning, unit, formula and source of the quantities that an order code sets for an interface."""
    names = run_time_names(device)
    for item in parameters_of(device, kind):
        if item.name not in names and not item.alternative:
            yield (
                code(item.name),
                text(item.meaning),
                text(item.unit),
                STYLE.number(item.equals) if item.equals is not None else "",
                cited(item.source),
            )


def run_time_rows(device: Device, kind: str) -> Iterator[tuple[str, ...]]:
    """Yield the name, meaning, origin, factory default and source of the quantities that registers hold.

    The registers may belong to another interface.
    """
    names = run_time_names(device)
    for item in parameters_of(device, kind):
        if item.name in names:
            unit = f"unit: {text(item.unit)}" if item.unit else ""
            yield (
                code(item.name),
                joined([text(item.meaning), unit]),
                style_beside(device).paragraph(origin(device, item)),
                _delivered(device, item),
                cited(item.source),
            )


def _kinds(device: Device, parameter: Parameter) -> list[str]:
    return [item.name for item in device.interfaces if parameter in parameters_of(device, item.name)]


def _delivered(device: Device, parameter: Parameter) -> str:
    if parameter.read_from and device.register(parameter.register).default is None:
        return "by order code"
    kinds = _kinds(device, parameter)
    found = next((item.parameters[parameter.name] for item in device.variants if item.interface in kinds), None)
    return parameter_value(parameter, found) if found is not None else ""


def code_table(device: Device, interface: Interface, links: Mapping[str, str]) -> dict[str, Any]:
    """Return the order codes of an interface as links to their pages, with the quantities that they set."""
    names = run_time_names(device)
    shown = (item for item in parameters_of(device, interface.name) if item.name not in names)
    parameters = [item for item in shown if not item.alternative]
    variants = device.variants_over(interface.name)
    rows = [
        (links[item.code], *(parameter_value(part, item.parameters[part.name]) for part in parameters))
        for item in variants
    ]
    head = ["Order code", *(code(item.name) for item in parameters)]
    return {"head": head, "rows": rows}


def alternatives(device: Device) -> list[dict[str, Any]]:
    """Return each question that the manual leaves open, its answers, and the frames that need one."""
    return [
        {
            "alternative": item,
            "title": heading(item.name),
            "rows": [_answer_row(device, item, one) for one in item.answers],
            "frames": [
                link(code(layout.name), f"#layout-{layout.name}")
                for _, layout in device.layouts()
                if item in (*device.alternatives_of(layout), *device.verdict_alternatives(layout))
            ],
            "members": list(map(code, item.answers[0].sets)),
        }
        for item in device.alternatives
    ]


def _answer_row(device: Device, item: Alternative, one: Answer) -> tuple[str, ...]:
    """Return a row of answer, meaning, quantities that it sets, source."""
    parameters = {item.name: item for item in device.parameters}
    # The page of one interface lacks the parameters of others.
    shown = ((parameters[name], count) for name, count in one.sets.items() if name in parameters)
    sets = (f"{code(part.name)} = {parameter_value(part, count)}: {text(part.meaning)}" for part, count in shown)
    return code(one.name), text(one.meaning), joined(sets), cited(one.source or item.source)


def measurement_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield the unit of the position, for all interfaces or for one."""
    for over, item in [("", device.measurement), *((part.title, part.measurement) for part in device.interfaces)]:
        if item is not None:
            yield code(item.of) + (f" over {over}" if over else ""), STYLE.phrase(measurement(item)), cited(item.source)
    for interface in device.interfaces:
        of = device.measurement_of(interface.name)
        for name, item_range in own_ranges(device, interface.name) if of is not None else ():
            where = f"{code(of.of)} in {code(name)}" if of is not None else ""
            yield where, STYLE.phrase(position_range(item_range)), cited(item_range.source)
