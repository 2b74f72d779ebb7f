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
        lines += pairs([(part_value.text, part_value.meaning) for part_value in part.values], 4)
        lines += [wrapped(BY_NAME.sentence(open_value), WIDTH, "      ", "    ") for open_value in open_values(part)]
    for spelled in device.order_code.also_written:
        lines.append(wrapped(BY_NAME.sentence(spelling(spelled)), WIDTH, "    ", "  "))
    lines += ["", "Parameters"]
    lines += pairs(
        [
            (device_parameter.name, BY_NAME.paragraph(parameter(device, device_parameter)))
            for device_parameter in device.parameters
        ],
        2,
    )
    lines += alternative_lines(device)
    lines += _position(
        [("", device.measurement), *((interface.title, interface.measurement) for interface in device.interfaces)], None
    )
    lines += [line for interface in device.interfaces for line in _own_ranges(device, interface.name, None)]
    for interface in device.interfaces:
        lines += ["", *interface_lines(device, interface)]
        for layout in interface.layouts:
            lines += layout_lines(device, interface, layout)
    return "\n".join([*lines, *register_lines(device, None), *_inputs_and_procedures(device), *_errata(device)])


def variant_text(device: Device, match: Match) -> str:
    """Return the text about an order code: its interface, widths, frames, registers and limits."""
    variant = match.variant
    reduced_device = reduced_to_codes(for_interface(device, variant.interface), [variant.code])
    lines = [wrapped(f"{variant.code}: {device.title} ({device.manufacturer.title})", WIDTH, "  ", "")]
    lines += [*label_differences(device, match), *_manual(device), *_parameters(device, variant)]
    lines += alternative_lines(reduced_device)
    lines += _position([("", device.measurement_of(variant.interface))], variant.parameters)
    lines += _own_ranges(reduced_device, variant.interface, variant.parameters)
    interface = reduced_device.interface(variant.interface)
    lines += ["", *interface_lines(reduced_device, with_output_code(interface, variant))]
    for layout in interface.layouts:
        lines += ["", *frame_lines(reduced_device, layout, variant)]
    return "\n".join(
        [
            *lines,
            *register_lines(reduced_device, variant),
            *_inputs_and_procedures(reduced_device),
            *_errata(reduced_device),
        ]
    )


def _manual(device: Device) -> list[str]:
    manual = device.manual
    date = f" of {manual.date}" if manual.date else ""
    origin = f"from the manual {manual.title}, revision {manual.revision}{date}, in {language(manual.language)}"
    statements = [BY_NAME.sentence(statement) for statement in (grade(device), *says_origin(device))]
    if device.editions:
        statements.append(f"--edition shows the others: {', '.join(edition.revision for edition in device.editions)}")
    return [wrapped(line, WIDTH, "  ") for line in (origin, *statements)]


def _parameters(device: Device, variant: Variant) -> list[str]:
    """Return the lines about parameters that the order code sets and those held in registers."""
    shown_parameters = parameters_of(device, variant.interface)
    at_run_time = run_time_names(device)
    fixed = [
        parameter for parameter in shown_parameters if parameter.name not in at_run_time and not parameter.alternative
    ]
    held_parameters = [parameter for parameter in shown_parameters if parameter.name in at_run_time]
    lines = ["", "Parameters", *_values(device, fixed, variant)] if fixed else []
    if held_parameters:
        lines += ["", f"Held in registers ({initial(device)})", *_values(device, held_parameters, variant)]
        addresses = dict.fromkeys(
            device.register(device_parameter.register).address
            for device_parameter in held_parameters
            if device_parameter.read_from
        )
        example = f"--register 0x{next(iter(addresses)):02X}=0x.."
        lines.append(wrapped(f"decode accepts other values, one byte at a time: {example}", WIDTH, "  ", "  "))
    return lines


def _values(device: Device, parameters: Sequence[Parameter], variant: Variant) -> list[str]:
    names = max(len(device_parameter.name) for device_parameter in parameters)
    value_texts = {
        device_parameter.name: value(device_parameter, variant.parameters[device_parameter.name])
        for device_parameter in parameters
    }
    numbers = max(map(len, value_texts.values()))
    rows = (
        (
            f"{device_parameter.name.ljust(names)}  {value_texts[device_parameter.name].ljust(numbers)}",
            BY_NAME.paragraph(parameter(device, device_parameter)),
        )
        for device_parameter in parameters
    )
    return pairs(rows, 2)


def _position(
    measurements: Sequence[tuple[str, Measurement | None]], parameters: Mapping[str, int] | None
) -> list[str]:
    style = at(parameters) if parameters is not None else BY_NAME
    rows = []
    for title, interface_measurement in measurements:
        if interface_measurement is None:
            continue
        counts = style.phrase(measurement(interface_measurement))
        step = interface_measurement.micrometres(parameters) if parameters is not None else None
        if step is not None and interface_measurement.modulus is not None and parameters is not None:
            millimetres = step * interface_measurement.modulus.value(parameters) / 1000
            places = "" if 1000 % millimetres.denominator else f"{float(millimetres):,.3f}"
            counts += f", {places or decimal(millimetres)} mm in total"
        rows.append((title or interface_measurement.of, f"{counts}  [{cite(interface_measurement.source)}]"))
    return ["", "Position", *pairs(rows, 2)] if rows else []


def _own_ranges(device: Device, interface: str, parameters: Mapping[str, int] | None) -> list[str]:
    """Return the lines about layouts in which the position has another range."""
    style = at(parameters) if parameters is not None else BY_NAME
    return pairs(
        (
            (f"in {name}", f"{style.phrase(position_range(layout_range))}  [{cite(layout_range.source)}]")
            for name, layout_range in own_ranges(device, interface)
        ),
        2,
    )


def _listed(title: str, rows: Sequence[tuple[str, str, Sources]]) -> list[str]:
    """Return a paragraph of names, each with its text and its source."""
    return ["", title, *pairs([(name, f"{text}  [{cite(source)}]") for name, text, source in rows], 2)] if rows else []


def _inputs_and_procedures(device: Device) -> list[str]:
    inputs = _listed(
        "Inputs",
        [(hardware_input.name, hardware_input.meaning, hardware_input.source) for hardware_input in device.inputs],
    )
    return inputs + _listed(
        "Procedures", [(procedure.name, procedure.title, procedure.source) for procedure in device.procedures]
    )


def _errata(device: Device) -> list[str]:
    """Return the errata in full, except those about wording, which are only counted."""
    detailed_errata = [erratum for erratum in device.errata if erratum.severity != "wording"]
    if not device.errata:
        return []
    lines = ["", "Errata of the manual"]
    for listed_erratum in detailed_errata:
        head, *parts = BY_NAME.lines(erratum(listed_erratum, whole=True))
        lines += [wrapped(head, WIDTH, "    ", "  "), *(wrapped(line, WIDTH, "      ", "    ") for line in parts)]
    wording_count = len(device.errata) - len(detailed_errata)
    return lines + (
        [
            wrapped(
                f"and {wording_count} about wording only, listed by --json and the documentation", WIDTH, "    ", "  "
            )
        ]
        if wording_count
        else []
    )
