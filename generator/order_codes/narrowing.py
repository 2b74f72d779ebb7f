"""Reduce a device to some of its interfaces or order codes, without parts that belong only to others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import Protocol

from ..model import (
    Biss,
    CodePart,
    Connector,
    CrcExample,
    CrcValue,
    Device,
    Erratum,
    Example,
    FrameExample,
    Input,
    Interface,
    MeasureExample,
    ProcedureExample,
    RegisterExample,
    Variant,
    assert_never,
)
from .parameters import parameters_of
from .reduction import reduced_to_codes


def for_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device with only these listed order codes, without interfaces and examples of the others."""
    variants = tuple(variant for variant in device.variants if variant.code in codes)
    kinds = {variant.interface for variant in variants}
    has_all_interfaces = kinds == _names(device.interfaces)
    with_interfaces = device if has_all_interfaces else for_interfaces(device, kinds)
    reduced = reduced_to_codes(with_interfaces, [variant.code for variant in variants])
    parameter_names = {parameter.name for kind in kinds for parameter in parameters_of(device, kind)}
    examples = tuple(example for example in reduced.examples if getattr(example, "order_code", "") in {"", *codes})
    return replace(
        reduced,
        variants=variants,
        examples=examples,
        parameters=tuple(parameter for parameter in reduced.parameters if parameter.name in parameter_names),
        order_code=replace(
            device.order_code, parts=tuple(_with_used_values(part, variants) for part in device.order_code.parts)
        ),
    )


def _with_used_values(part: CodePart, variants: Collection[Variant]) -> CodePart:
    """Return the part of the order code with only the values that one of the variants has."""
    used_texts = {variant.parts[part.name] for variant in variants}
    return replace(part, values=tuple(value for value in part.values if value.text in used_texts))


def for_interface(device: Device, kind: str) -> Device:
    """Return the device with only one of its interfaces, and without parts that belong to the others."""
    return for_interfaces(device, {kind})


def for_interfaces(device: Device, kinds: Collection[str]) -> Device:
    """Return the device with only some of its interfaces, and without parts that belong only to the others."""
    reduced = _with_used_parts(_with_interfaces(device, kinds), sent_crcs(device.interfaces))
    remaining_names = {
        "interfaces": _names(reduced.interfaces),
        "registers": _names(reduced.registers),
        "procedures": _names(reduced.procedures),
        "crcs": _names(reduced.crcs),
        "field_groups": _names(reduced.field_groups),
        "alarms": _names(reduced.alarms),
        "connectors": _names(reduced.connectors),
        "parameters": {parameter.name for kind in kinds for parameter in parameters_of(device, kind)},
        "alternatives": _names(reduced.alternatives),
    }
    layouts = {layout.name for interface in reduced.interfaces for layout in interface.layouts}
    names_in_examples = remaining_names | {"layouts": layouts}
    examples = [example for example in device.examples if _holds_for(example, kinds, device, names_in_examples)]
    affects_remaining = _leads_to(remaining_names | {"examples": _names(examples)})

    def concerns_remaining(erratum: Erratum) -> bool:
        return not erratum.affects or any(map(affects_remaining, erratum.affects))

    return replace(reduced, examples=tuple(examples), errata=tuple(filter(concerns_remaining, device.errata)))


def _with_interfaces(device: Device, kinds: Collection[str]) -> Device:
    """Return the device with only those parts that refer to one of these interfaces or to none."""

    def is_wired(connector: Connector) -> bool:
        return not connector.interfaces or not set(kinds).isdisjoint(connector.interfaces)

    return replace(
        device,
        interfaces=tuple(interface for interface in device.interfaces if interface.name in kinds),
        registers=tuple(register for register in device.registers if register.interface in kinds),
        procedures=tuple(procedure for procedure in device.procedures if procedure.interface in kinds),
        connectors=tuple(filter(is_wired, device.connectors)),
    )


def sent_crcs(interfaces: Collection[Interface]) -> set[str]:
    """Return the names of the CRCs that are in a frame of one of the interfaces."""
    sent_fields = (field for interface in interfaces for layout in interface.layouts for field in layout.fields)
    crcs = {field.kind.crc for field in sent_fields if isinstance(field.kind, CrcValue)}
    for interface in interfaces:
        if isinstance(interface, Biss):
            crcs |= {control_field.crc for control_field in interface.control_data}
    return crcs


def _with_used_parts(device: Device, crcs_sent: Collection[str]) -> Device:
    """Return the device with only the CRCs, groups, alarms and alternatives that its frames and registers use.

    A CRC that is in no frame, such as that of a memory, belongs to all interfaces. ``crcs_sent`` are the others.
    """
    sent_fields = [field for interface in device.interfaces for layout in interface.layouts for field in layout.fields]
    crcs = sent_crcs(device.interfaces)
    groups, registers = {"", *(field.group for field in sent_fields)}, {"", *_names(device.registers)}
    layouts = [layout for interface in device.interfaces for layout in interface.layouts]
    layouts += [register.layout for register in device.registers]
    decisions = {alternative.name for layout in layouts for alternative in device.alternatives_of(layout)}
    decisions |= {alternative.name for layout in layouts for alternative in device.verdict_alternatives(layout)}
    return replace(
        device,
        crcs=tuple(crc for crc in device.crcs if crc.name in crcs or crc.name not in crcs_sent),
        field_groups=tuple(group for group in device.field_groups if group.name in groups),
        alarms=tuple(alarm for alarm in device.alarms if alarm.group in groups and alarm.register in registers),
        alternatives=tuple(alternative for alternative in device.alternatives if alternative.name in decisions),
        inputs=tuple(_with_registers(device_input, registers) for device_input in device.inputs),
    )


def _with_registers(device_input: Input, registers: Collection[str]) -> Input:
    """Return the input without the effects of other interfaces' registers."""

    def path_if_present(path: str) -> str:
        return path if path.partition(".")[0] in registers else ""

    return replace(
        device_input, inverts=path_if_present(device_input.inverts), needs=path_if_present(device_input.needs)
    )


class _Named(Protocol):
    @property
    def name(self) -> str: ...


def _names(named_parts: Iterable[_Named]) -> set[str]:
    return {part.name for part in named_parts}


def _leads_to(remaining_names: Mapping[str, set[str]]) -> Callable[[str], bool]:
    """Return a function that tests whether a path of an erratum leads to a part of these interfaces.

    Paths that belong to no interface pass the test.
    """

    def leads_to_remaining_part(path: str) -> bool:
        parts = path.split(".")
        return len(parts) == 1 or parts[1] in remaining_names.get(parts[0], {parts[1]})

    return leads_to_remaining_part


def _holds_for(
    example: Example, interfaces: Collection[str], device: Device, remaining_names: Mapping[str, set[str]]
) -> bool:
    """Return whether an example is about a part of these interfaces, and its order code has one of the interfaces."""
    match example:
        case FrameExample():
            is_about_part = example.layout in {"", *remaining_names["layouts"]}
        case RegisterExample():
            is_about_part = example.register in remaining_names["registers"]
        case ProcedureExample():
            is_about_part = example.procedure in remaining_names["procedures"]
        case CrcExample():
            return example.crc in remaining_names["crcs"]
        case MeasureExample():
            is_about_part = True
        case _:
            assert_never(example)
    codes = (variant for variant in device.variants if variant.code == example.order_code)
    return is_about_part and all(variant.interface in interfaces for variant in codes)
