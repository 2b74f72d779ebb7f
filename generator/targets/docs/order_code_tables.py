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
    parameters = {parameter.name: parameter for parameter in device.parameters}
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
        for open_value in open_values(part):
            meaning = joined([STYLE.sentence(open_value), _only_with(part.open_only_with)])
            yield "", "", "", meaning, cited(part.source)


def spelling_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield rows of pattern on the label, where it is used, its texts for the listed values, source."""
    for spelling in device.order_code.also_written:
        values = "; ".join(
            f"{code(value.text)} is {code(value.value)}" for value in spelling.values if value.text != value.value
        )
        then = f"{code(spelling.then)} may follow and has no meaning here" if spelling.then else ""
        yield code(spelling.pattern), text(spelling.where), joined([values, then]), cited(spelling.source)


def _only_with(combined: Any) -> str:
    return "; ".join(f"only with {code(name)} {', '.join(map(code, values))}" for name, values in combined.items())


def parameter_rows(device: Device, kind: str) -> Iterator[tuple[str, ...]]:
    """Yield the name, meaning, unit, formula and source of the quantities that an order code sets for an interface."""
    names = run_time_names(device)
    for parameter in parameters_of(device, kind):
        if parameter.name not in names and not parameter.alternative:
            yield (
                code(parameter.name),
                text(parameter.meaning),
                text(parameter.unit),
                STYLE.number(parameter.equals) if parameter.equals is not None else "",
                cited(parameter.source),
            )


def run_time_rows(device: Device, kind: str) -> Iterator[tuple[str, ...]]:
    """Yield the name, meaning, origin, factory default and source of the quantities that registers hold.

    The registers may belong to another interface.
    """
    names = run_time_names(device)
    for parameter in parameters_of(device, kind):
        if parameter.name in names:
            unit = f"unit: {text(parameter.unit)}" if parameter.unit else ""
            yield (
                code(parameter.name),
                joined([text(parameter.meaning), unit]),
                style_beside(device).paragraph(origin(device, parameter)),
                _delivered(device, parameter),
                cited(parameter.source),
            )


def _kinds(device: Device, parameter: Parameter) -> list[str]:
    return [interface.name for interface in device.interfaces if parameter in parameters_of(device, interface.name)]


def _delivered(device: Device, parameter: Parameter) -> str:
    if parameter.read_from and device.register(parameter.register).default is None:
        return "by order code"
    kinds = _kinds(device, parameter)
    default = next(
        (variant.parameters[parameter.name] for variant in device.variants if variant.interface in kinds), None
    )
    return parameter_value(parameter, default) if default is not None else ""


def code_table(device: Device, interface: Interface, links: Mapping[str, str]) -> dict[str, Any]:
    """Return the order codes of an interface as links to their pages, with the quantities that they set."""
    names = run_time_names(device)
    code_parameters = (parameter for parameter in parameters_of(device, interface.name) if parameter.name not in names)
    parameters = [parameter for parameter in code_parameters if not parameter.alternative]
    variants = device.variants_over(interface.name)
    rows = [
        (
            links[variant.code],
            *(parameter_value(parameter, variant.parameters[parameter.name]) for parameter in parameters),
        )
        for variant in variants
    ]
    head = ["Order code", *(code(parameter.name) for parameter in parameters)]
    return {"head": head, "rows": rows}


def alternatives(device: Device) -> list[dict[str, Any]]:
    """Return each question that the manual leaves open, its answers, and the frames that need one."""
    return [
        {
            "alternative": alternative,
            "title": heading(alternative.name),
            "rows": [_answer_row(device, alternative, answer) for answer in alternative.answers],
            "frames": [
                link(code(layout.name), f"#layout-{layout.name}")
                for _, layout in device.layouts()
                if alternative in (*device.alternatives_of(layout), *device.verdict_alternatives(layout))
            ],
            "members": list(map(code, alternative.answers[0].sets)),
        }
        for alternative in device.alternatives
    ]


def _answer_row(device: Device, alternative: Alternative, answer: Answer) -> tuple[str, ...]:
    """Return a row of answer, meaning, quantities that it sets, source."""
    parameters = {parameter.name: parameter for parameter in device.parameters}
    # The page of one interface lacks the parameters of others.
    parameter_counts = ((parameters[name], count) for name, count in answer.sets.items() if name in parameters)
    sets = (
        f"{code(parameter.name)} = {parameter_value(parameter, count)}: {text(parameter.meaning)}"
        for parameter, count in parameter_counts
    )
    return code(answer.name), text(answer.meaning), joined(sets), cited(answer.source or alternative.source)


def measurement_rows(device: Device) -> Iterator[tuple[str, ...]]:
    """Yield the unit of the position, for all interfaces or for one."""
    for interface_title, unit in [
        ("", device.measurement),
        *((interface.title, interface.measurement) for interface in device.interfaces),
    ]:
        if unit is not None:
            yield (
                code(unit.of) + (f" over {interface_title}" if interface_title else ""),
                STYLE.phrase(measurement(unit)),
                cited(unit.source),
            )
    for interface in device.interfaces:
        position_unit = device.measurement_of(interface.name)
        for name, item_range in own_ranges(device, interface.name) if position_unit is not None else ():
            where = f"{code(position_unit.of)} in {code(name)}" if position_unit is not None else ""
            yield where, STYLE.phrase(position_range(item_range)), cited(item_range.source)
