"""``codewheel list`` and ``codewheel show`` for a person, at most 80 columns wide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .model import Device, Measurement, Parameter, Variant, cite
from .order_codes import Match
from .output import for_interface
from .relevant import parameters_of, run_time_names
from .render import wrapped
from .show_parts import WIDTH, frame_lines, interface_lines, layout_lines, pairs, place_of, register_lines, value
from .words import language, number


def list_data(devices: Sequence[Device]) -> dict[str, Any]:
    """The families as plain data."""
    return {
        "version": 1,
        "families": [
            {
                "family": device.name,
                "title": device.title,
                "manufacturer": device.manufacturer.title,
                "interfaces": [item.kind for item in device.interfaces],
                "pattern": device.order_code.pattern,
                "order_codes": [variant.code for variant in device.variants],
                "manual": {"title": device.manual.title, "revision": device.manual.revision, "date": device.manual.date or None},
            }
            for device in devices
        ],
    }


def list_text(devices: Sequence[Device]) -> str:
    """A few lines for each family."""
    lines = []
    for device in devices:
        manual = f"{device.manual.title}, revision {device.manual.revision}" + (f" of {device.manual.date}" if device.manual.date else "")
        lines += [
            wrapped(f"{device.title} ({device.manufacturer.title})", WIDTH, " " * 10, f"{device.name:<8}  "),
            *pairs(
                [
                    ("interfaces", ", ".join(item.title for item in device.interfaces)),
                    ("order codes", f"{len(device.variants)}, {device.order_code.pattern}"),
                    ("manual", manual),
                ],
                10,
            ),
            "",
        ]
    return "\n".join(lines).rstrip()


def device_text(device: Device) -> str:
    """A family: what its order codes decide, its interfaces, registers, procedures and errata."""
    lines = [wrapped(f"{device.title} ({device.manufacturer.title})", WIDTH), *_manual(device), "", f"Order codes: {device.order_code.pattern}"]
    for part in device.order_code.parts:
        lines.append(wrapped(part.meaning, WIDTH, "    ", f"  {part.name}: "))
        lines += pairs([(item.text, item.meaning) for item in part.values], 4)
        if part.open:
            lines.append(wrapped(f"others that match {part.open} are taken as unlisted", WIDTH, "      ", "    "))
    for spelling in device.order_code.also_written:
        lines.append(wrapped(f"{spelling.pattern}, as in {spelling.where}", WIDTH, "    ", "  also "))
    lines += ["", "Parameters"]
    lines += pairs([(item.name, item.meaning + _origin(item)) for item in device.parameters], 2)
    lines += _position([("", device.measurement), *((item.title, item.measurement) for item in device.interfaces)], None)
    for interface in device.interfaces:
        lines += ["", *interface_lines(interface)]
        for layout in interface.layouts:
            lines += layout_lines(layout)
    return "\n".join([*lines, *register_lines(device.registers, None), *_inputs(device), *_procedures(device), *_errata(device)])


def variant_text(device: Device, match: Match) -> str:
    """One order code: interface, widths, frame pictures, registers and limits; what belongs to another interface is left out."""
    variant = match.variant
    here = for_interface(device, variant.interface)
    lines = [wrapped(f"{variant.code}: {device.title} ({device.manufacturer.title})", WIDTH, "  ", "")]
    if match.written_as_in:
        lines.append(wrapped(f"the label is written as in {match.written_as_in}", WIDTH, "  "))
    if match.unlisted:
        lines.append(wrapped(f"not listed in the manual, taken as any other: {', '.join(match.unlisted)}", WIDTH, "  "))
    if match.tail:
        lines.append(f"  the label goes on with {match.tail}")
    if match.special:
        lines.append(wrapped(device.order_code.special or "A code that ends in /Sxxx may differ from the manual.", WIDTH, "  "))
    lines += [*_manual(device), *_parameters(device, variant)]
    lines += _position([("", device.measurement_of(variant.interface))], variant.parameters)
    interface = here.interface(variant.interface)
    lines += ["", *interface_lines(interface, _code(device, variant) if interface.output_code else "")]
    for layout in interface.layouts:
        lines += ["", *frame_lines(device, layout, variant)]
    return "\n".join([*lines, *register_lines(here.registers, variant), *_inputs(here), *_procedures(here), *_errata(here)])


def _manual(device: Device) -> list[str]:
    date = f" of {device.manual.date}" if device.manual.date else ""
    return [wrapped(f"from the manual {device.manual.title}, revision {device.manual.revision}{date}, in {language(device.manual.language)}", WIDTH, "  ")]


def _origin(parameter: Parameter) -> str:
    if parameter.read_from:
        return f" (register {parameter.read_from})"
    return f" (= {parameter.equals.render()})" if parameter.equals is not None else ""


def _parameters(device: Device, variant: Variant) -> list[str]:
    """What the order code decides of this interface, and what registers do."""
    shown = parameters_of(device, variant.interface)
    at_run_time = run_time_names(device)
    fixed = [item for item in shown if item.name not in at_run_time]
    held = [item for item in shown if item.name in at_run_time]
    lines = ["", "Parameters", *_values(device, fixed, variant)] if fixed else []
    if held:
        lines += ["", "Held by registers, as delivered", *_values(device, held, variant)]
        addresses = dict.fromkeys(device.register(item.register).address for item in held if item.read_from)
        example = f"--register 0x{next(iter(addresses)):02X}=0x.."
        lines.append(wrapped(f"decode takes what they hold instead, a byte at a time: {example}", WIDTH, "  ", "  "))
    return lines


def _values(device: Device, parameters: Sequence[Parameter], variant: Variant) -> list[str]:
    names = max(len(item.name) for item in parameters)
    shown = {item.name: _value(item, variant.parameters[item.name]) for item in parameters}
    numbers = max(map(len, shown.values()))
    return pairs([(f"{item.name.ljust(names)}  {shown[item.name].ljust(numbers)}", item.meaning + _place(device, item)) for item in parameters], 2)


def _value(parameter: Parameter, count: int) -> str:
    """The number; what has no unit and is no small number is a code."""
    if not parameter.unit:
        return f"{count}" if count < 10 else f"{count:X}h"
    return f"{number(count)} {parameter.unit}" if len(parameter.unit) < 4 else number(count)


def _place(device: Device, parameter: Parameter) -> str:
    return f" ({place_of(device, parameter.read_from)})" if parameter.read_from else ""


def _position(measurements: Sequence[tuple[str, Measurement | None]], parameters: Mapping[str, int] | None) -> list[str]:
    """What a position counts, in turns or in micrometres."""
    rows = []
    for over, item in measurements:
        if item is None:
            continue
        parts = []
        if item.steps_per_turn is not None:
            parts.append(f"{value(item.steps_per_turn, parameters)} counts in a revolution")
        if item.turns is not None:
            turns = value(item.turns, parameters)
            parts.append(f"{turns} revolution{'' if turns == '1' else 's'}")
        if item.step_um is not None:
            parts.append(f"{value(item.step_um, parameters)} µm to a count")
        if item.steps is not None:
            parts.append(f"{value(item.steps, parameters)} counts in all")
        if item.step_um is not None and item.steps is not None and parameters is not None:
            micrometres = item.step_um.value(parameters) * item.steps.value(parameters)
            parts.append(f"which is {micrometres // 1000:,}.{micrometres % 1000:03} mm")
        if item.highest is not None:
            parts.append(f"the highest {value(item.highest, parameters)}")
        rows.append((over or item.of, f"{', '.join(parts)}  [{cite(item.source)}]"))
    return ["", "Position", *pairs(rows, 2)] if rows else []


def _code(device: Device, variant: Variant) -> str:
    """The code in which an order code sends its position."""
    for layout in device.interface(variant.interface).layouts:
        if layout.gray_of:
            return "Gray" if layout.place(variant.parameters).gray or not layout.gray_when else "binary"
    return ""


def _inputs(device: Device) -> list[str]:
    if not device.inputs:
        return []
    return ["", "Inputs", *pairs([(item.name, f"{item.meaning}  [{cite(item.source)}]") for item in device.inputs], 2)]


def _procedures(device: Device) -> list[str]:
    if not device.procedures:
        return []
    return ["", "Procedures", *pairs([(item.name, f"{item.title}  [{cite(item.source)}]") for item in device.procedures], 2)]


def _errata(device: Device) -> list[str]:
    """The errata; those of wording only are counted."""
    found = [item for item in device.errata if item.severity != "wording"]
    if not device.errata:
        return []
    lines = ["", "Errata of the manual"]
    for item in found:
        lines.append(wrapped(f"{item.name}: {item.status}, {item.severity.replace('_', ' ')}  [{cite(item.source)}]", WIDTH, "    ", "  "))
        lines += [wrapped(item.printed, WIDTH, " " * 13, "    printed: "), wrapped(item.used, WIDTH, " " * 13, "    used:    ")]
    more = len(device.errata) - len(found)
    return lines + ([wrapped(f"and {more} of wording only, which --json and the documentation list", WIDTH, "    ", "  ")] if more else [])
