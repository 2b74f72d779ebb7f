"""Reduce a device to some of its interfaces or order codes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from operator import is_
from typing import Any, Protocol

from ..model import (
    Biss,
    CodePart,
    Connector,
    CrcExample,
    CrcValue,
    Device,
    Erratum,
    Example,
    Field,
    Flag,
    FrameExample,
    Input,
    Interface,
    Layout,
    MeasureExample,
    ProcedureExample,
    Quantity,
    RegisterExample,
    Source,
    Variant,
    assert_never,
)
from ..model.expressions import Expression
from ..model.order_codes import applies_to_code
from .parameters import parameters_of

#: Types of values that apply to every order code. They make up most of a device, so the search skips them.
_UNCONDITIONAL_PARTS = (str, int, Source, Expression, Quantity)
#: Lists of a device that contain parts with ``only``, the order codes that a part applies to, or references to them.
_CONDITIONAL_PARTS = ("interfaces", "registers", "alarms", "timings", "connectors", "leds", "characteristics", "errata")


def reduced_to_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device with only the facts that apply to some of these order codes.

    The member ``only`` of a fact lists the order codes that it applies to. It is removed if it includes all of these
    codes. A flag that is only explained for other order codes becomes unexplained, which means that the manual does not
    say what it means here. Questions about such flags are left out.
    """
    # The list ``by_hand`` of a fact names steps that a person carries out. These are characteristics of the device.
    manual_steps = {step.name for step in device.characteristics if not _applies_only_to_others(step, codes)}
    reduced_parts = {name: _reduced_part(getattr(device, name), codes, manual_steps) for name in _CONDITIONAL_PARTS}
    reduced = replace(device, **reduced_parts)
    if not device.optional_alternatives:
        return reduced
    # Questions with a default only decide verdicts. They remain if a flag that they concern remains.
    remaining_names = {alternative.name for alternative in reduced.alternatives if not alternative.default}
    for _, layout in reduced.layouts():
        remaining_names |= _names_of_parts(reduced.verdict_alternatives(layout))
    remaining = tuple(alternative for alternative in reduced.alternatives if alternative.name in remaining_names)
    return replace(reduced, alternatives=remaining)


def _reduced_part(part: Any, codes: Collection[str], manual_steps: Collection[str]) -> Any:
    """Return a part of the model with only the facts that apply to some of these order codes.

    ``only`` of a fact lists the order codes that it applies to. It is removed if it includes all of these codes. A flag
    that is only explained for other codes becomes unexplained. Steps that a person carries out are left out if they are
    not in ``manual_steps``. If nothing changes, the same object is returned.
    """
    if isinstance(part, _UNCONDITIONAL_PARTS):
        return part
    if isinstance(part, tuple):
        return _reduced_values(part, codes, manual_steps)
    if isinstance(part, Field) and isinstance(part.kind, Flag):
        is_unexplained = _applies_only_to_others(part.kind, codes)
        if is_unexplained:
            return part.unexplained
    if not names_of_members(part.__class__):
        return part
    changed: dict[str, Any] = {}
    for member_name, member in parts_of(part):
        reduced_member = _reduced_part(member, codes, manual_steps)
        if reduced_member is not member:
            changed[member_name] = reduced_member
    only = getattr(part, "only", "")
    if only and all(applies_to_code(only, code) for code in codes):
        changed["only"] = ""
    step_names = getattr(part, "by_hand", ())
    if any(step_name not in manual_steps for step_name in step_names):
        changed["by_hand"] = tuple(step_name for step_name in step_names if step_name in manual_steps)
    return replace(part, **changed) if changed else part


def _reduced_values(values: tuple[Any, ...], codes: Collection[str], manual_steps: Collection[str]) -> tuple[Any, ...]:
    """Return the values of a tuple that apply to some of these order codes, each reduced to the facts that apply.

    If nothing changes, the same object is returned.
    """
    if all(isinstance(value, _UNCONDITIONAL_PARTS) for value in values):
        return values
    applying_values = [value for value in values if not _applies_only_to_others(value, codes)]
    reduced_values = tuple([_reduced_part(value, codes, manual_steps) for value in applying_values])
    are_same_objects = len(reduced_values) == len(values) and all(map(is_, reduced_values, values))
    return values if are_same_objects else reduced_values


def parts_of(part: Any) -> Iterator[tuple[str, Any]]:
    """Yield the name and the value of each member of a part that is itself an object of the model, or a tuple."""
    for name in names_of_members(part.__class__):
        value = getattr(part, name)
        if isinstance(value, tuple) or names_of_members(value.__class__):
            yield name, value


@cache
def names_of_members(part_class: type) -> tuple[str, ...]:
    """Return the names of the members of a class of the model that can be replaced. Other classes have none."""
    if not is_dataclass(part_class):
        return ()
    return tuple(field.name for field in fields(part_class) if field.init)


def _applies_only_to_others(part: Any, codes: Collection[str]) -> bool:
    """Return whether a part applies only to order codes that are not among ``codes``.

    ``only`` of the part lists the order codes that it applies to, and is "" if it applies to all of them.
    """
    only = getattr(part, "only", "")
    return bool(only) and not any(applies_to_code(only, code) for code in codes)


def for_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device with only these order codes.

    Interfaces, parameters, examples and values of order code parts that only other order codes have are left out.
    """
    variants = tuple(variant for variant in device.variants if variant.code in codes)
    interface_names = {variant.interface for variant in variants}
    if interface_names == _names_of_parts(device.interfaces):
        with_interfaces = device
    else:
        with_interfaces = for_interfaces(device, interface_names)
    reduced = reduced_to_codes(with_interfaces, [variant.code for variant in variants])
    parameter_names = _names_of_parameters(device, interface_names)
    code_parts = tuple(_with_used_values(part, variants) for part in device.order_code.parts)
    # Examples of a CRC have no order code, so they remain.
    examples = tuple(example for example in reduced.examples if getattr(example, "order_code", "") in {"", *codes})
    return replace(
        reduced,
        variants=variants,
        examples=examples,
        parameters=tuple(parameter for parameter in reduced.parameters if parameter.name in parameter_names),
        order_code=replace(device.order_code, parts=code_parts),
    )


def _names_of_parameters(device: Device, interface_names: Collection[str]) -> set[str]:
    """Return the names of the parameters that matter for one of the interfaces, such as ``{"ssi", "biss"}``."""
    names: set[str] = set()
    for interface_name in interface_names:
        names |= _names_of_parts(parameters_of(device, interface_name))
    return names


def _with_used_values(part: CodePart, variants: Collection[Variant]) -> CodePart:
    """Return a part of the order code with only the values that occur in these order codes."""
    used_texts = {variant.parts[part.name] for variant in variants}
    return replace(part, values=tuple(value for value in part.values if value.text in used_texts))


def for_interface(device: Device, interface_name: str) -> Device:
    """Return the device with only one of its interfaces, and without parts that belong to other interfaces."""
    return for_interfaces(device, {interface_name})


def for_interfaces(device: Device, interface_names: Collection[str]) -> Device:
    """Return the device with only some of its interfaces, such as ``{"ssi", "biss"}``.

    Parts that belong only to other interfaces are left out. Examples and errata remain if they are about a remaining
    part.
    """
    with_interfaces = _with_interfaces(device, interface_names)
    reduced = _with_used_parts(with_interfaces, all_sent_crcs=sent_crcs(device.interfaces))
    # The keys are the lists of the device. Paths in errata begin with them: ``registers.preset.default``.
    remaining_names = {
        "interfaces": _names_of_parts(reduced.interfaces),
        "registers": _names_of_parts(reduced.registers),
        "procedures": _names_of_parts(reduced.procedures),
        "crcs": _names_of_parts(reduced.crcs),
        "field_groups": _names_of_parts(reduced.field_groups),
        "alarms": _names_of_parts(reduced.alarms),
        "connectors": _names_of_parts(reduced.connectors),
        "parameters": _names_of_parameters(device, interface_names),
        "alternatives": _names_of_parts(reduced.alternatives),
    }
    layout_names = {layout.name for interface in reduced.interfaces for layout in interface.layouts}
    names_in_examples = remaining_names | {"layouts": layout_names}
    examples: list[Example] = []
    for example in device.examples:
        if _concerns_interfaces(example, interface_names, device, names_in_examples):
            examples.append(example)
    remaining_names["examples"] = _names_of_parts(examples)
    errata = tuple(erratum for erratum in device.errata if _concerns_remaining(erratum, remaining_names))
    return replace(reduced, examples=tuple(examples), errata=errata)


def _with_interfaces(device: Device, names: Collection[str]) -> Device:
    """Return the device with only these interfaces, and with only the registers, procedures and connectors for them.

    A connector that lists no interface is for all of them.
    """

    def is_wired(connector: Connector) -> bool:
        return not connector.interfaces or not set(names).isdisjoint(connector.interfaces)

    return replace(
        device,
        interfaces=tuple(interface for interface in device.interfaces if interface.name in names),
        registers=tuple(register for register in device.registers if register.interface in names),
        procedures=tuple(procedure for procedure in device.procedures if procedure.interface in names),
        connectors=tuple(filter(is_wired, device.connectors)),
    )


def sent_crcs(interfaces: Collection[Interface]) -> set[str]:
    """Return the names of the CRCs in the frames of these interfaces, and in the BiSS control frame."""
    crcs: set[str] = set()
    for interface in interfaces:
        for layout in interface.layouts:
            crcs |= {field.kind.crc for field in layout.fields if isinstance(field.kind, CrcValue)}
        if isinstance(interface, Biss):
            crcs |= {control_field.crc for control_field in interface.control_data}
    return crcs


def _with_used_parts(device: Device, all_sent_crcs: Collection[str]) -> Device:
    """Return the device with only the CRCs, groups, alarms and alternatives that its frames and registers use.

    ``all_sent_crcs`` are the CRCs in the frames of all interfaces of the complete device. Any other CRC, such as the
    CRC of a memory, belongs to all interfaces, so it remains.
    """
    removed_crcs = set(all_sent_crcs) - sent_crcs(device.interfaces)
    layouts: list[Layout] = []
    # An alarm without a group or register has "" there, so it remains.
    used_groups = {""}
    for interface in device.interfaces:
        layouts += interface.layouts
        for layout in interface.layouts:
            used_groups |= {field.group for field in layout.fields}
    layouts += [register.layout for register in device.registers]
    used_registers = {"", *_names_of_parts(device.registers)}
    used_alternatives: set[str] = set()
    for layout in layouts:
        used_alternatives |= _names_of_parts(device.alternatives_of(layout))
        used_alternatives |= _names_of_parts(device.verdict_alternatives(layout))
    alarms = [alarm for alarm in device.alarms if alarm.group in used_groups and alarm.register in used_registers]
    return replace(
        device,
        crcs=tuple(crc for crc in device.crcs if crc.name not in removed_crcs),
        field_groups=tuple(group for group in device.field_groups if group.name in used_groups),
        alarms=tuple(alarms),
        alternatives=tuple(option for option in device.alternatives if option.name in used_alternatives),
        inputs=tuple(_with_registers(device_input, used_registers) for device_input in device.inputs),
    )


def _with_registers(device_input: Input, registers: Collection[str]) -> Input:
    """Return a hardware input without references to registers that are not in ``registers``.

    ``inverts`` is the path of the setting that the input inverts, and ``needs`` is the setting that enables it, such as
    ``settings.direction``. Without the register, both are "".
    """

    def path_if_present(path: str) -> str:
        register, _, _ = path.partition(".")
        return path if register in registers else ""

    inverts = path_if_present(device_input.inverts)
    needs = path_if_present(device_input.needs)
    return replace(device_input, inverts=inverts, needs=needs)


class _Named(Protocol):
    @property
    def name(self) -> str: ...


def _names_of_parts(named_parts: Iterable[_Named]) -> set[str]:
    return {part.name for part in named_parts}


def _concerns_remaining(erratum: Erratum, remaining_names: Mapping[str, set[str]]) -> bool:
    """Return whether an erratum concerns a remaining part. An erratum without paths concerns the whole device."""
    if not erratum.affects:
        return True
    return any(_leads_to_remaining_part(path, remaining_names) for path in erratum.affects)


def _leads_to_remaining_part(path: str, remaining_names: Mapping[str, set[str]]) -> bool:
    """Return whether the part at a path, such as ``registers.preset.default``, remains in a reduced device.

    ``remaining_names`` contains the names of the remaining parts by list, such as ``registers``. Lists that it does not
    contain are complete.
    """
    if "." not in path:
        return True
    list_name, part_name, *_ = path.split(".")
    return list_name not in remaining_names or part_name in remaining_names[list_name]


def _concerns_interfaces(
    example: Example, interfaces: Collection[str], device: Device, remaining_names: Mapping[str, set[str]]
) -> bool:
    """Return whether an example is about a remaining part, and its order code has one of these interfaces.

    Examples of a CRC have no order code. An order code that the device does not list is not checked.
    """
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
    variants_of_example = (variant for variant in device.variants if variant.code == example.order_code)
    return is_about_part and all(variant.interface in interfaces for variant in variants_of_example)
