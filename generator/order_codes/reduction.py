"""Reduce a device to some of its interfaces or order codes, or replace its quantities by numbers."""

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
    Constant,
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
    Join,
    Layout,
    MeasureExample,
    Measurement,
    Parity,
    ProcedureExample,
    Quantity,
    RegisterExample,
    Source,
    Ssi,
    Variant,
    assert_never,
)
from ..model.expressions import Expression, Term
from ..model.order_codes import fits
from .parameters import parameters_of, run_time_names
from .sent_layouts import with_sent_layouts

#: Parts that apply to every order code. They make up most of a device, so the search leaves them out.
_UNCONDITIONAL_PARTS = (str, int, Source, Expression, Quantity)
#: Parts of a device that have ``only``, or that refer to such parts.
_CONDITIONAL_PARTS = ("interfaces", "registers", "alarms", "timings", "connectors", "leds", "characteristics", "errata")


def reduced_to_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device for these order codes.

    Facts that apply to none of these codes are omitted, and such flags are unexplained. Facts that apply to all of them
    lose their ``only``. Questions about unexplained flags are omitted.
    """
    # The list ``by_hand`` of a fact names characteristics: steps that a person carries out.
    manual_steps = {step.name for step in device.characteristics if not _applies_only_to_others(step, codes)}
    reduced_parts = {name: _reduced_part(getattr(device, name), codes, manual_steps) for name in _CONDITIONAL_PARTS}
    reduced = replace(device, **reduced_parts)
    if not device.optional_alternatives:
        return reduced
    # Questions with a default decide only verdicts, so they remain if a flag that they concern does.
    remaining_names = {alternative.name for alternative in reduced.alternatives if not alternative.default}
    for _, layout in reduced.layouts():
        remaining_names |= _names_of_parts(reduced.verdict_alternatives(layout))
    remaining = tuple(alternative for alternative in reduced.alternatives if alternative.name in remaining_names)
    return replace(reduced, alternatives=remaining)


def _reduced_part(part: Any, codes: Collection[str], manual_steps: Collection[str]) -> Any:
    """Return the part without facts about other order codes, and without manual steps not in ``manual_steps``.

    If nothing changes, the result is the same object, so that callers compare with ``is``. An ``only`` that includes
    all codes is removed. A flag that is explained only for other codes becomes unexplained.
    """
    if isinstance(part, _UNCONDITIONAL_PARTS):
        return part
    if isinstance(part, tuple):
        return _reduced_values(part, codes, manual_steps)
    if isinstance(part, Field) and isinstance(part.kind, Flag) and _applies_only_to_others(part.kind, codes):
        return part.unexplained
    if not names_of_members(part.__class__):
        return part
    changed: dict[str, Any] = {}
    for member_name, member in parts_of(part):
        reduced_member = _reduced_part(member, codes, manual_steps)
        if reduced_member is not member:
            changed[member_name] = reduced_member
    only = getattr(part, "only", "")
    if only and all(fits(only, code) for code in codes):
        changed["only"] = ""
    step_names = getattr(part, "by_hand", ())
    if any(step_name not in manual_steps for step_name in step_names):
        changed["by_hand"] = tuple(step_name for step_name in step_names if step_name in manual_steps)
    return replace(part, **changed) if changed else part


def _reduced_values(values: tuple[Any, ...], codes: Collection[str], manual_steps: Collection[str]) -> tuple[Any, ...]:
    """Return the values for these order codes. If nothing changes, the result is the same object."""
    if all(isinstance(value, _UNCONDITIONAL_PARTS) for value in values):
        return values
    applying_values = [value for value in values if not _applies_only_to_others(value, codes)]
    reduced_values = tuple([_reduced_part(value, codes, manual_steps) for value in applying_values])
    are_same_objects = len(reduced_values) == len(values) and all(map(is_, reduced_values, values))
    return values if are_same_objects else reduced_values


def parts_of(part: Any) -> Iterator[tuple[str, Any]]:
    """Yield name and value of members that are themselves objects of the model, or tuples."""
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
    """Return whether a part is only for some order codes, none of which is among ``codes``."""
    only = getattr(part, "only", "")
    return bool(only) and not any(fits(only, code) for code in codes)


def for_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device with only these listed order codes.

    Interfaces, parameters, examples and values of the order code that only the others have are left out.
    """
    variants = tuple(variant for variant in device.variants if variant.code in codes)
    interface_names = {variant.interface for variant in variants}
    # The variants contain the names of interfaces, such as "biss".
    has_all_interfaces = interface_names == _names_of_parts(device.interfaces)
    with_interfaces = device if has_all_interfaces else for_interfaces(device, interface_names)
    reduced = reduced_to_codes(with_interfaces, [variant.code for variant in variants])
    parameter_names = _names_of_parameters(device, interface_names)
    code_parts = tuple(_with_used_values(part, variants) for part in device.order_code.parts)
    examples = tuple(example for example in reduced.examples if getattr(example, "order_code", "") in {"", *codes})
    return replace(
        reduced,
        variants=variants,
        examples=examples,
        parameters=tuple(parameter for parameter in reduced.parameters if parameter.name in parameter_names),
        order_code=replace(device.order_code, parts=code_parts),
    )


def _names_of_parameters(device: Device, kinds: Collection[str]) -> set[str]:
    """Return the names of the parameters that matter for one of the interfaces, such as ``{"ssi", "biss"}``."""
    return {parameter.name for kind in kinds for parameter in parameters_of(device, kind)}


def _with_used_values(part: CodePart, variants: Collection[Variant]) -> CodePart:
    """Return the part of the order code with only the values that some of the variants have."""
    used_texts = {variant.parts[part.name] for variant in variants}
    return replace(part, values=tuple(value for value in part.values if value.text in used_texts))


def for_interface(device: Device, interface_name: str) -> Device:
    """Return the device with only one of its interfaces, and without parts that belong to other interfaces."""
    return for_interfaces(device, {interface_name})


def for_interfaces(device: Device, kinds: Collection[str]) -> Device:
    """Return the device with only the interfaces named ``kinds``, and without parts of other interfaces only.

    Examples and errata remain if they are about a remaining part.
    """
    with_interfaces = _with_interfaces(device, kinds)
    reduced = _with_used_parts(with_interfaces, all_sent_crcs=sent_crcs(device.interfaces))
    # The key is a list of the device, which is the beginning of a path in an erratum: ``registers.preset.default``.
    remaining_names = {
        "interfaces": _names_of_parts(reduced.interfaces),
        "registers": _names_of_parts(reduced.registers),
        "procedures": _names_of_parts(reduced.procedures),
        "crcs": _names_of_parts(reduced.crcs),
        "field_groups": _names_of_parts(reduced.field_groups),
        "alarms": _names_of_parts(reduced.alarms),
        "connectors": _names_of_parts(reduced.connectors),
        "parameters": _names_of_parameters(device, kinds),
        "alternatives": _names_of_parts(reduced.alternatives),
    }
    layout_names = {layout.name for interface in reduced.interfaces for layout in interface.layouts}
    names_in_examples = remaining_names | {"layouts": layout_names}
    examples = tuple(
        example for example in device.examples if _concerns_interfaces(example, kinds, device, names_in_examples)
    )
    remaining_names["examples"] = _names_of_parts(examples)
    errata = tuple(erratum for erratum in device.errata if _concerns_remaining(erratum, remaining_names))
    return replace(reduced, examples=examples, errata=errata)


def _with_interfaces(device: Device, kinds: Collection[str]) -> Device:
    """Return the device with only those parts that refer to one of the interfaces named ``kinds``, or to none."""

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
    """Return the names of the CRCs that are in a frame of one of the interfaces, or in control data of BiSS."""
    sent_fields = (field for interface in interfaces for layout in interface.layouts for field in layout.fields)
    crcs = {field.kind.crc for field in sent_fields if isinstance(field.kind, CrcValue)}
    for interface in interfaces:
        if isinstance(interface, Biss):
            crcs |= {control_field.crc for control_field in interface.control_data}
    return crcs


def _with_used_parts(device: Device, all_sent_crcs: Collection[str]) -> Device:
    """Return the device with only the CRCs, groups, alarms and alternatives that its frames and registers use.

    ``all_sent_crcs`` are the CRCs in frames of any interface of the family. Any other CRC, such as a memory's CRC,
    belongs to all interfaces.
    """
    removed_crcs = set(all_sent_crcs) - sent_crcs(device.interfaces)
    layouts: list[Layout] = []
    # With "" among the used groups and registers, an alarm that has none of its own remains.
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
    """Return the input without the effects of registers not in ``registers``, which belong to other interfaces."""

    # ``inverts`` and ``needs`` are paths such as ``settings.direction``. An empty list has no effect.
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
    """Return whether one of the paths of an erratum leads to a remaining part, or to none that can be removed."""
    if not erratum.affects:
        return True
    return any(_leads_to_remaining_part(path, remaining_names) for path in erratum.affects)


def _leads_to_remaining_part(path: str, remaining_names: Mapping[str, set[str]]) -> bool:
    """Return whether the part at a path, such as ``registers.preset.default``, remains.

    ``remaining_names`` are the names of the remaining parts by the list that they are in. Other lists are complete.
    """
    if "." not in path:
        return True
    list_name, part_name, *_ = path.split(".")
    return list_name not in remaining_names or part_name in remaining_names[list_name]


def _concerns_interfaces(
    example: Example, interfaces: Collection[str], device: Device, remaining_names: Mapping[str, set[str]]
) -> bool:
    """Return whether an example is about a remaining part, and its order code has one of these interfaces.

    Examples of a CRC have no order code. An order code that is not listed is ignored.
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


#: The parts of a device that contain expressions.
_NUMBERED_PARTS = ("interfaces", "registers", "procedures", "measurement")


def with_quantities(device: Device, variant: Variant, *, keeps_settings: bool = False) -> Device:
    """Return the device with the quantities of an order code filled in. Questions that the manual leaves open remain.

    Quantities held in registers have their factory defaults, unless ``keeps_settings``: then they remain, too, and
    quantities that are not numbers are calculated from numbers where possible. Layouts that have no bits for the order
    code are left out, with the CRCs that no other layout has.
    """
    # The answer to a question sets these parameters, so their values stay open.
    open_parameters = {parameter.name for parameter in device.parameters if parameter.alternative}
    if keeps_settings:
        open_parameters |= run_time_names(device)
    known_parameters = {name: value for name, value in variant.parameters.items() if name not in open_parameters}
    numbered_parts = (*_NUMBERED_PARTS, "parameters") if keeps_settings else _NUMBERED_PARTS
    parts_with_numbers = {name: _with_numbers(getattr(device, name), known_parameters) for name in numbered_parts}
    interfaces = tuple(with_output_code(interface, variant) for interface in parts_with_numbers["interfaces"])
    interfaces = tuple(with_sent_layouts(interface, variant.parameters) for interface in interfaces)
    interfaces = tuple(
        _without_needless_joins(interface, device.measurement_of(interface.name)) for interface in interfaces
    )
    device_with_numbers = replace(device, **parts_with_numbers | {"interfaces": interfaces})
    return _without_crcs(device_with_numbers, sent_crcs(device.interfaces) - sent_crcs(interfaces))


def _without_needless_joins(interface: Interface, measurement: Measurement | None) -> Interface:
    """Return the interface without joins that consist of a single field, except the join that is the position."""
    position_name = measurement.of if measurement is not None else ""

    def reduced(layout: Layout) -> Layout:
        field_by_join = {
            join.name: join.fields[0] for join in layout.joins if len(join.fields) == 1 and join.name != position_name
        }
        if not field_by_join:
            return layout
        joins = tuple(join for join in layout.joins if join.name not in field_by_join)
        return replace(layout, joins=joins, gray_of=field_by_join.get(layout.gray_of, layout.gray_of))

    return replace(interface, layouts=tuple(map(reduced, interface.layouts)))


def _without_crcs(device: Device, names: Collection[str]) -> Device:
    """Return the device without these CRCs and their examples."""
    if not names:
        return device
    crcs = tuple(crc for crc in device.crcs if crc.name not in names)
    examples = tuple(example for example in device.examples if getattr(example, "crc", "") not in names)
    return replace(device, crcs=crcs, examples=examples)


def with_output_code(interface: Interface, variant: Variant) -> Interface:
    """Return the interface with the code of an order code: Gray or binary.

    It is unchanged if it is not SSI, if its code is fixed, or if the encoder's frames have different codes.
    """
    if not isinstance(interface, Ssi) or interface.output_code is None or interface.name != variant.interface:
        return interface
    if interface.output_code.code != "by_order_code":
        return interface
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    are_gray = {layout.place(variant.parameters).gray for layout in sent_layouts}
    if are_gray == {True}:
        code = "gray"
    elif are_gray == {False}:
        code = "binary"
    else:  # The frames have different codes.
        return interface
    return replace(interface, output_code=replace(interface.output_code, code=code))


def _with_numbers(part: Any, known_parameters: Mapping[str, int]) -> Any:
    """Return the part, and all in it, with known parameters in expressions replaced by numbers.

    Layouts also lose fields whose width is then 0. If nothing changes, the result is the same object.
    """
    if isinstance(part, Expression):
        return _with_known_numbers(part, known_parameters)
    if isinstance(part, tuple):
        values_with_numbers = tuple(_with_numbers(value, known_parameters) for value in part)
        return part if all(map(is_, values_with_numbers, part)) else values_with_numbers
    if not names_of_members(part.__class__):
        return part
    changed: dict[str, Any] = {}
    for member_name, member in parts_of(part):
        member_with_numbers = _with_numbers(member, known_parameters)
        if member_with_numbers is not member:
            changed[member_name] = member_with_numbers
    part_with_numbers = replace(part, **changed) if changed else part
    if isinstance(part_with_numbers, Field):
        return _with_decided_flag(part_with_numbers, known_parameters)
    if isinstance(part_with_numbers, Layout):
        layout = _with_fixed_code(part_with_numbers, known_parameters)
        return _without_empty_fields(layout)
    return part_with_numbers


def _with_decided_flag(field: Field, known_parameters: Mapping[str, int]) -> Field:
    """Return a flag without the condition ``only_while`` if its parameter is known, and any other field unchanged.

    For an order code without the flag, it is unexplained.
    """
    if not isinstance(field.kind, Flag) or field.kind.only_while not in known_parameters:
        return field
    if not known_parameters[field.kind.only_while]:
        return field.unexplained
    return replace(field, kind=replace(field.kind, only_while=""))


def _with_fixed_code(layout: Layout, known_parameters: Mapping[str, int]) -> Layout:
    """Return the layout with a fixed code, Gray or binary, if the parameter ``gray_when`` that decides it is known."""
    if layout.gray_when not in known_parameters:
        return layout
    if known_parameters[layout.gray_when]:
        return replace(layout, gray_when="")  # Without a condition, ``gray_of`` is always in Gray code.
    return replace(layout, gray_of="", gray_when="", gray_excess=None)


def _without_empty_fields(layout: Layout) -> Layout:
    """Return the layout without zero-width fields, in the layout itself, in its joins and in its parity bits.

    If no remaining field judges the position, reserved bits lead to UNKNOWN instead of a warning.
    """
    empty_fields = {field.name: field for field in layout.fields if field.width == Expression(0)}
    if not empty_fields:
        return layout
    joins = [_without_fields(join, empty_fields) for join in layout.joins]
    remaining_fields = [field for field in layout.fields if field.name not in empty_fields]
    reduced = replace(
        layout,
        fields=tuple(_without_references(field, empty_fields) for field in remaining_fields),
        joins=tuple(join for join in joins if join.fields),
    )
    has_lost_validity = reduced.judges_position != layout.judges_position
    return reduced.with_unknown_verdicts() if has_lost_validity else reduced


def _without_references(field: Field, removed_fields: Mapping[str, Field]) -> Field:
    """Return the field without references to removed fields: a parity bit covers only the others.

    If it covers no other field, it is a constant: 0 for even parity, 1 for odd. The padding of a removed field is a
    constant in the bytes of both.
    """
    match field.kind:
        case Parity(of=covered_names) as parity if not removed_fields.keys().isdisjoint(covered_names):
            remaining_names = tuple(name for name in covered_names if name not in removed_fields)
            if not remaining_names:
                return replace(field, kind=Constant(int(parity.odd)))
            return replace(field, kind=replace(parity, of=remaining_names))
        case Constant(padding_of=padded_name) as padding if padded_name in removed_fields:
            bytes_of_both = removed_fields[padded_name].bit_slices
            return replace(field, kind=replace(padding, padding_of=""), bit_slices=bytes_of_both)
    return field


def _without_fields(join: Join, removed_names: Collection[str]) -> Join:
    return replace(join, fields=tuple(name for name in join.fields if name not in removed_names))


def _with_known_numbers(expression: Expression, known_parameters: Mapping[str, int]) -> Expression:
    """Return the sum with numbers for known parameters: for 12 ``bits``, ``bits * on + bits`` is ``12 * on + 12``."""
    constant = expression.constant
    open_terms: list[Term] = []
    for term in expression.terms:
        open_factors = tuple(factor for factor in term.factors if factor.parameter not in known_parameters)
        known_factors = tuple(factor for factor in term.factors if factor.parameter in known_parameters)
        known_product = Expression(0, (Term(term.multiple, known_factors),)).value(known_parameters)
        if not open_factors:
            constant += known_product
        elif known_product:
            open_terms.append(Term(known_product, open_factors))
    return Expression(constant, tuple(open_terms))
