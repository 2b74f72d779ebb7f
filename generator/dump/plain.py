"""The model as plain data, for ``show --json`` and the XML description.

Every dataclass of the model becomes a map with the members that the table in ``model/members`` lists for it. Members
with a different form in the data are added by the functions of this module. The module ``schema`` describes the whole
form.

Every member is always present. A missing number is null, and a missing text is empty. A position or limit that depends
on the order code is a text such as ``48 - singleturn_bits`` in the data of a family, and a number in the data of an
order code.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any

from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Example,
    Field,
    Flag,
    Interface,
    Join,
    Kind,
    Layout,
    Number,
    Parity,
    Procedure,
    Register,
    Source,
    Sources,
    Step,
    Table,
    Text,
    Unused,
    Variant,
    Verdict,
    assert_never,
)
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, ModelMember
from ..model.record import dataclass
from ..order_codes.labels import LabelMatch
from ..order_codes.parameters import with_sent_layouts
from ..order_codes.reduction import for_interface, reduced_to_codes
from .schema import fill_members

VERSION = 1

PlainData = dict[str, Any]

_NO_PARAMETERS: Mapping[str, int] = MappingProxyType({})


def device_dump(device: Device) -> PlainData:
    """Return a family as plain data."""
    return _Dump(device, variant=None).whole_device(device.variants, parameters=_NO_PARAMETERS, label=None)


def variant_dump(device: Device, code_match: LabelMatch) -> PlainData:
    """Return one order code as plain data, with expressions resolved and without the other interfaces.

    Facts that do not apply to the order code are left out. ``code_match`` also describes how the label differs from the
    order code.
    """
    variant = code_match.variant
    label_data = {
        "code": variant.code,
        "unlisted": list(code_match.unlisted),
        "tail": code_match.tail,
        "special": code_match.special,
        "written_as_in": code_match.written_as_in,
    }
    reduced_device = reduced_to_codes(for_interface(device, variant.interface), [variant.code])
    # A parameter without an interface applies to all interfaces.
    names_of_interfaces = ("", variant.interface)
    parameters = tuple(
        parameter for parameter in reduced_device.parameters if parameter.interface in names_of_interfaces
    )
    measurement = reduced_device.measurement_of(variant.interface)
    interface = with_sent_layouts(reduced_device.interface(variant.interface), variant.parameters)
    reduced_device = replace(reduced_device, parameters=parameters, measurement=measurement, interfaces=(interface,))
    reduced_variant = replace(variant, parameters=_parameters_of_interface(device, variant))
    return _Dump(reduced_device, variant).whole_device((reduced_variant,), reduced_variant.parameters, label_data)


def _parameters_of_interface(device: Device, variant: Variant) -> dict[str, int]:
    """Return the parameters of an order code, without those that belong to another interface."""
    parameters = dict(variant.parameters)
    for parameter in device.parameters:
        if parameter.interface not in ("", variant.interface):
            parameters.pop(parameter.name, None)
    return parameters


#: Attributes of fields that are plain numbers. They have the same names in the data.
_MEMBERS_OF_NUMBERS = tuple(member.name for member in fields(Number))


@dataclass(frozen=True)
class _Dump:
    """Conversion of a device to plain data. If a variant is given, expressions become numbers."""

    device: Device
    variant: Variant | None

    def whole_device(
        self, variants: Iterable[Variant], parameters: Mapping[str, int], label: PlainData | None
    ) -> PlainData:
        """Return all data of the device in one map.

        Args:
            variants: The order codes to list.
            parameters: The values of the parameters of the order code. Empty for a family.
            label: How the label differs from the order code, or None for a family.
        """
        identity = self._identity_data(label)
        order_codes = self._order_codes(variants, parameters)
        return identity | order_codes | self._communication_data() | self._surroundings_data()

    def _identity_data(self, label: PlainData | None) -> PlainData:
        """Return the names of the family, its manufacturer, its manual and the evidence for it."""
        device = self.device
        return {
            "version": VERSION,
            "family": device.name,
            "base": device.base,
            "overlays": self.to_plain_data(device.overlays, ()),
            "edition": device.edition,
            "editions": self.to_plain_data(device.editions, ()),
            "title": device.title,
            "movement": device.movement,
            "order_code": self.variant.code if self.variant is not None else None,
            "interface": self.variant.interface if self.variant is not None else None,
            "label": label,
            "manufacturer": self.to_plain_data(device.manufacturer, ()),
            "evidence": self.to_plain_data(device.evidence, ()),
            "manual": self.to_plain_data(device.manual, ()),
            "documents": self.to_plain_data(device.documents, ()),
        }

    def _order_codes(self, variants: Iterable[Variant], parameters: Mapping[str, int]) -> PlainData:
        """Return the order codes, their grammar, their parameters, and the questions that the manual leaves open."""
        source = self.device.order_code.source
        return {
            "parameters": dict(parameters),
            "parameter_definitions": self.to_plain_data(self.device.parameters, source),
            "alternatives": self.to_plain_data(self.device.alternatives, ()),
            "order_code_grammar": self.to_plain_data(self.device.order_code, ()),
            "order_codes": [self.to_plain_data(variant, source) | _sources_data(source) for variant in variants],
        }

    def _communication_data(self) -> PlainData:
        """Return the interfaces, frames and registers, and what belongs to them: CRCs, alarms, procedures and times."""
        device = self.device
        return {
            "interfaces": {interface.name: self._interface_data(interface) for interface in device.interfaces},
            "layouts": [self._layout_data(layout, owner.name, owner.source) for owner, layout in device.layouts()],
            "field_groups": self.to_plain_data(device.field_groups, ()),
            "registers": [self._register_data(register) for register in device.registers],
            "crcs": self.to_plain_data(device.crcs, ()),
            "alarms": self.to_plain_data(device.alarms, ()),
            "procedures": list(map(self._procedure_data, device.procedures)),
            "timings": self._timings_data(),
        }

    def _procedure_data(self, procedure: Procedure) -> PlainData:
        procedure_data: PlainData = self.to_plain_data(procedure, ())
        procedure_data["steps"] = [self._step_data(step, procedure.source) for step in procedure.steps]
        return procedure_data

    def _table_data(self, table: Table) -> PlainData:
        table_data: PlainData = self.to_plain_data(table, ())
        table_data["rows"] = [{"cells": list(row)} for row in table.rows]
        return table_data

    def _surroundings_data(self) -> PlainData:
        """Return the measurement, the hardware and other facts of the manual."""
        device = self.device
        return {
            "measurement": self.to_plain_data(device.measurement, ()),
            "inputs": self.to_plain_data(device.inputs, ()),
            "connectors": self.to_plain_data(device.connectors, ()),
            "leds": self.to_plain_data(device.leds, ()),
            "characteristics": self.to_plain_data(device.characteristics, ()),
            "tables": list(map(self._table_data, device.tables)),
            "examples": [self._example_data(example) for example in device.examples],
            "errata": self.to_plain_data(device.errata, ()),
            "lost_figures": self.to_plain_data(device.lost_figures, ()),
            "supply": self.to_plain_data(device.supply, ()),
        }

    def to_plain_data(self, value: Any, inherited_sources: Sources) -> Any:
        """Return any part of the model as plain data: maps, lists, texts, numbers, Booleans and None.

        The members of a dataclass are those that ``model/members`` lists for its class. If it does not list the class,
        they are all attributes. A part without sources has the ``inherited_sources`` of its parent.
        """
        if isinstance(value, Expression):
            return self._number_or_text(value)
        if isinstance(value, Verdict):
            return value.value
        if isinstance(value, bytes):
            return value.hex(" ").upper()
        if isinstance(value, Mapping):
            return {key: self.to_plain_data(member, inherited_sources) for key, member in value.items()}
        if isinstance(value, tuple):
            return [self.to_plain_data(member, inherited_sources) for member in value]
        if not is_dataclass(value) or isinstance(value, type):
            return value
        own_sources: Sources = getattr(value, "source", ()) or inherited_sources
        part_description = PARTS_BY_CLASS.get(type(value).__name__)
        if part_description is None:
            attribute_names = [attribute_value.name for attribute_value in fields(value)]
            return {
                name: self.to_plain_data(getattr(value, name), own_sources) for name in attribute_names
            } | _sources_data(own_sources)
        plain_members = {}
        for member in part_description.members:
            if member.data_type and hasattr(value, member.attribute):
                attribute_value = getattr(value, member.attribute)
                plain_members[member.name] = self._member_data(member, attribute_value, own_sources)
        return plain_members | _sources_data(own_sources) if part_description.is_sourced else plain_members

    def _member_data(self, member: ModelMember, value: Any, inherited_sources: Sources) -> Any:
        """Return a member as plain data. A missing member that would be one of several words is an empty string."""
        # The type of such a member begins with ``|``, followed by the possible words: ``|low|high``.
        is_missing_word = value is None and member.data_type.startswith("|")
        return "" if is_missing_word else self.to_plain_data(value, inherited_sources)

    def _number_or_text(self, expression: Expression) -> int | str:
        """Return the number for an order code. For a family, it may be a text, such as ``48 - singleturn_bits``."""
        if self.variant is not None:
            return expression.value(self.variant.parameters)
        return expression.constant if expression.is_constant else expression.render()

    def _interface_data(self, interface: Interface) -> PlainData:
        """Return an interface with its kind and the names of its layouts.

        Members that the interface lacks have their defaults.
        """
        interface_data: PlainData = self.to_plain_data(interface, interface.source)
        # In the data, a word replaces each of these objects, and the source is a member of the interface.
        for fact_name, key_of_word in (("alignment", "end"), ("output_code", "code")):
            fact_data = interface_data.pop(fact_name, None)
            if fact_data is not None:
                interface_data[fact_name] = fact_data[key_of_word]
                interface_data[f"{fact_name}_source"] = fact_data["source"]
        interface_data["kind"] = interface.name
        interface_data["layouts"] = [layout.name for layout in interface.layouts]
        return fill_members(interface_data, "interface")

    def _layout_data(self, layout: Layout, interface_name: str, inherited_sources: Sources) -> PlainData:
        """Return a layout with its interface, the open questions about it, its joined numbers and its fields."""
        own_sources = layout.source or inherited_sources
        # The fields come last, in a different form.
        layout_data: PlainData = self.to_plain_data(replace(layout, fields=()), own_sources)
        layout_data |= {"carried_as": layout.carried_as, "interface": interface_name}
        layout_data["alternatives"] = [alternative.name for alternative in self.device.alternatives_of(layout)]
        layout_data["join"] = [self._join_data(join, layout) | _sources_data(own_sources) for join in layout.joins]
        layout_data["fields"] = self._fields_data(layout, own_sources)
        return layout_data

    def _fields_data(self, layout: Layout, inherited_sources: Sources) -> list[PlainData]:
        """Return the fields of a layout, each with its highest bit.

        For a family, these are all fields. For an order code, fields without bits are left out.
        """
        fields_data: list[PlainData] = []
        if self.variant is None:
            for field in layout.fields:
                highest_bit = field.low + field.width - Expression(1)
                fields_data.append(self._field_data(field, highest_bit, inherited_sources))
        else:
            for placed_field in layout.place(self.variant.parameters).fields:
                fields_data.append(
                    self._field_data(placed_field.field, Expression(placed_field.highest_bit), inherited_sources)
                )
        return fields_data

    def _field_data(self, field: Field, highest_bit: Expression, inherited_sources: Sources) -> PlainData:
        """Return a field with the name and the members of its kind, such as ``choice`` and ``values``.

        ``highest_bit`` is the highest bit of the field.
        """
        # The members of the kind are added below. Those of a plain number conflict with none of them.
        field_data: PlainData = self.to_plain_data(replace(field, kind=Number()), inherited_sources)
        field_data["high"] = self._number_or_text(highest_bit)
        if isinstance(field.equals, str):
            field_data["equals"] = None
            field_data["equals_text"] = field.equals
        else:
            field_data["equals_text"] = ""
        field_data["kind"], members_of_kind = self._kind_data(field.kind, field.source or inherited_sources)
        return fill_members(field_data | members_of_kind, "field")

    def _kind_data(self, kind: Kind, inherited_sources: Sources) -> tuple[str, PlainData]:
        """Return the name of a kind in the data, and its own members: ``("unused", {"unused": 0, …})``."""
        match kind:
            case Number():
                return "number", {name: getattr(kind, name) for name in _MEMBERS_OF_NUMBERS}
            case Flag():
                return "flag", _flag_members(kind)
            case Choice(values):
                return "choice", {"values": self.to_plain_data(values, inherited_sources)}
            case Constant(value, padding_of):
                return "constant", {"constant": value, "padding_of": padding_of}
            case Unused(value, verdict):
                return "unused", {"unused": value, "makes_position": verdict.value}
            case CrcValue(crc, covered):
                return "crc", {"crc": crc, "crc_of": list(covered)}
            case Parity() as parity:
                odd_or_even = "odd" if parity.is_odd else "even"
                return "parity", {"parity_of": list(parity.covers), "parity": odd_or_even, "over": parity.over}
            case Decimal(runs):
                return "digits", {"digits": self.to_plain_data(runs, inherited_sources)}
            case Text():
                return "text", {}
            case _:
                assert_never(kind)

    def _join_data(self, join: Join, layout: Layout) -> PlainData:
        """Return a number that is joined from fields, with the sum of their widths."""
        width = Expression(0)
        for name in join.fields:
            width += layout.field(name).width
        return {"name": join.name, "fields": list(join.fields), "width": self._number_or_text(width)}

    def _register_data(self, register: Register) -> PlainData:
        """Return a register with its default as hex bytes, the condition for writing it, its joins and its fields."""
        register_data: PlainData = self.to_plain_data(register, ())
        default_bytes = register.default_bytes()
        register_data["default_bytes"] = default_bytes.hex(" ").upper() if default_bytes is not None else ""
        register_data["opened_by"] = _opening_condition_data(register) if register.opened_by else None
        register_data["other_bits"] = register.layout.gaps
        layout = register.layout
        citation = _sources_data(register.source)
        register_data["join"] = [self._join_data(join, layout) | citation for join in layout.joins]
        register_data["fields"] = self._fields_data(layout, register.source)
        return register_data

    def _step_data(self, step: Step, inherited_sources: Sources) -> PlainData:
        return fill_members(self.to_plain_data(step, inherited_sources), "step")

    def _example_data(self, example: Example) -> PlainData:
        # An example that is not a frame has no sender. In the data, it has always been the encoder.
        return fill_members({"from": "encoder"} | self.to_plain_data(example, ()), "example")

    def _timings_data(self) -> list[PlainData]:
        """Return the times of the device, whose ``interface`` is empty, and the times of each interface."""
        timings = [self.to_plain_data(timing, ()) | {"interface": ""} for timing in self.device.timings]
        for interface in self.device.interfaces:
            for timing in interface.timings:
                timing_data = self.to_plain_data(timing, interface.source)
                timings.append(timing_data | {"interface": interface.name})
        return timings


def _flag_members(flag: Flag) -> PlainData:
    """Return the members of a flag, as the table of members names them. A missing verdict is an empty string."""
    return {
        "when_active": flag.when_active,
        "when_inactive": flag.when_inactive,
        "makes_position": flag.makes_position.value if flag.makes_position is not None else "",
        "sums_up": list(flag.sums_up),
        "only": flag.only,
        "only_while": flag.only_while,
        "verdict_parameter": flag.verdict_parameter,
        "verdict_if_set": flag.verdict_if_set.value if flag.verdict_if_set is not None else "",
        "active": "low" if flag.active_low else "high",
    }


def _opening_condition_data(register: Register) -> PlainData:
    return {"register": register.opened_by, "field": register.opened_by_field, "value": register.opened_by_value}


def _sources_data(sources: Sources) -> PlainData:
    """Return ``{"source": first}``, where None means no source, and also all ``"sources"`` if there are several."""
    sources_data = [_source_data(source) for source in sources]
    if len(sources_data) < 2:
        return {"source": sources_data[0] if sources_data else None}
    return {"source": sources_data[0], "sources": sources_data}


def _source_data(source: Source) -> PlainData:
    return {"document": source.document, "section": source.section, "page": source.page}
