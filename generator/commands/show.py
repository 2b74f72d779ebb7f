"""``codewheel show``: text at most 80 columns wide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..model import Device, Measurement, Parameter, Sources, Variant, cite
from ..order_codes.labels import Match
from ..order_codes.narrowing import for_interface
from ..order_codes.parameters import parameters_of, run_time_names
from ..order_codes.reduction import reduced_to_codes
from ..order_codes.with_numbers import with_output_code
from ..say.erratum import erratum
from ..say.evidence import grade
from ..say.lines import WIDTH, pairs, wrapped
from ..say.measurement import measurement, own_ranges, position_range
from ..say.numbers import decimal
from ..say.order_code import open_values, spelling
from ..say.origin import origin as says_origin
from ..say.parameter import initial, parameter, value
from ..say.text import BY_NAME
from ..say.words import language
from .decode import label_differences
from .show_parts import alternative_lines, at, frame_lines, interface_lines, layout_lines, register_lines


def device_text(device: Device) -> str:
    """Return the text about a family: order codes, interfaces, registers, procedures and errata."""
    lines = [
        wrapped(f"{device.title} ({device.manufacturer.title})", WIDTH),
        *_manual(device),
        "",
        f"Order codes: {device.order_code.pattern}",
    ]
    for part in device.order_code.parts:
        lines.append(wrapped(part.meaning, WIDTH, "    ", f"  {part.name}: "))
        lines += pairs([(item.text, item.meaning) for item in part.values], 4)
        lines += [wrapped(BY_NAME.sentence(item), WIDTH, "      ", "    ") for item in open_values(part)]
    for spelled in device.order_code.also_written:
        lines.append(wrapped(BY_NAME.sentence(spelling(spelled)), WIDTH, "    ", "  "))
    lines += ["", "Parameters"]
    lines += pairs([(item.name, BY_NAME.paragraph(parameter(device, item))) for item in device.parameters], 2)
    lines += alternative_lines(device)
    lines += _position(
        [("", device.measurement), *((item.title, item.measurement) for item in device.interfaces)], None
    )
    lines += [line for item in device.interfaces for line in _own_ranges(device, item.name, None)]
    for interface in device.interfaces:
        lines += ["", *interface_lines(device, interface)]
        for layout in interface.layouts:
            lines += layout_lines(device, interface, layout)
    return "\n".join([*lines, *register_lines(device, None), *_inputs_and_procedures(device), *_errata(device)])


def variant_text(device: Device, match: Match) -> str:
    """Return the text about an order code: its interface, widths, frames, registers and limits."""
    variant = match.variant
    here = reduced_to_codes(for_interface(device, variant.interface), [variant.code])
    lines = [wrapped(f"{variant.code}: {device.title} ({device.manufacturer.title})", WIDTH, "  ", "")]
    lines += [*label_differences(device, match), *_manual(device), *_parameters(device, variant)]
    lines += alternative_lines(here)
    lines += _position([("", device.measurement_of(variant.interface))], variant.parameters)
    lines += _own_ranges(here, variant.interface, variant.parameters)
    interface = here.interface(variant.interface)
    lines += ["", *interface_lines(here, with_output_code(interface, variant))]
    for layout in interface.layouts:
        lines += ["", *frame_lines(here, layout, variant)]
    return "\n".join([*lines, *register_lines(here, variant), *_inputs_and_procedures(here), *_errata(here)])


def _manual(device: Device) -> list[str]:
    manual = device.manual
    date = f" of {manual.date}" if manual.date else ""
    origin = f"from the manual {manual.title}, revision {manual.revision}{date}, in {language(manual.language)}"
    said = [BY_NAME.sentence(item) for item in (grade(device), *says_origin(device))]
    if device.editions:
        said.append(f"--edition shows the others: {', '.join(item.revision for item in device.editions)}")
    return [wrapped(line, WIDTH, "  ") for line in (origin, *said)]


def _parameters(device: Device, variant: Variant) -> list[str]:
    """Return the lines about parameters that the order code sets and those held in registers."""
    shown = parameters_of(device, variant.interface)
    at_run_time = run_time_names(device)
    fixed = [item for item in shown if item.name not in at_run_time and not item.alternative]
    held = [item for item in shown if item.name in at_run_time]
    lines = ["", "Parameters", *_values(device, fixed, variant)] if fixed else []
    if held:
        lines += ["", f"Held in registers ({initial(device)})", *_values(device, held, variant)]
        addresses = dict.fromkeys(device.register(item.register).address for item in held if item.read_from)
        example = f"--register 0x{next(iter(addresses)):02X}=0x.."
        lines.append(wrapped(f"decode accepts other values, one byte at a time: {example}", WIDTH, "  ", "  "))
    return lines


def _values(device: Device, parameters: Sequence[Parameter], variant: Variant) -> list[str]:
    names = max(len(item.name) for item in parameters)
    shown = {item.name: value(item, variant.parameters[item.name]) for item in parameters}
    numbers = max(map(len, shown.values()))
    rows = (
        (f"{item.name.ljust(names)}  {shown[item.name].ljust(numbers)}", BY_NAME.paragraph(parameter(device, item)))
        for item in parameters
    )
    return pairs(rows, 2)


def _position(
    measurements: Sequence[tuple[str, Measurement | None]], parameters: Mapping[str, int] | None
) -> list[str]:
    style = at(parameters) if parameters is not None else BY_NAME
    rows = []
    for over, item in measurements:
        if item is None:
            continue
        counts = style.phrase(measurement(item))
        step = item.micrometres(parameters) if parameters is not None else None
        if step is not None and item.modulus is not None and parameters is not None:
            millimetres = step * item.modulus.value(parameters) / 1000
            places = "" if 1000 % millimetres.denominator else f"{float(millimetres):,.3f}"
            counts += f", {places or decimal(millimetres)} mm in total"
        rows.append((over or item.of, f"{counts}  [{cite(item.source)}]"))
    return ["", "Position", *pairs(rows, 2)] if rows else []


def _own_ranges(device: Device, interface: str, parameters: Mapping[str, int] | None) -> list[str]:
    """Return the lines about layouts in which the position has another range."""
    style = at(parameters) if parameters is not None else BY_NAME
    return pairs(
        (
            (f"in {name}", f"{style.phrase(position_range(item))}  [{cite(item.source)}]")
            for name, item in own_ranges(device, interface)
        ),
        2,
    )


def _listed(title: str, rows: Sequence[tuple[str, str, Sources]]) -> list[str]:
    """Return a paragraph of names, each with its text and its source."""
    return ["", title, *pairs([(name, f"{text}  [{cite(source)}]") for name, text, source in rows], 2)] if rows else []


def _inputs_and_procedures(device: Device) -> list[str]:
    inputs = _listed("Inputs", [(item.name, item.meaning, item.source) for item in device.inputs])
    return inputs + _listed("Procedures", [(item.name, item.title, item.source) for item in device.procedures])


def _errata(device: Device) -> list[str]:
    """Return the errata in full, except those about wording, which are only counted."""
    found = [item for item in device.errata if item.severity != "wording"]
    if not device.errata:
        return []
    lines = ["", "Errata of the manual"]
    for item in found:
        head, *parts = BY_NAME.lines(erratum(item, whole=True))
        lines += [wrapped(head, WIDTH, "    ", "  "), *(wrapped(line, WIDTH, "      ", "    ") for line in parts)]
    more = len(device.errata) - len(found)
    return lines + (
        [wrapped(f"and {more} about wording only, listed by --json and the documentation", WIDTH, "    ", "  ")]
        if more
        else []
    )
