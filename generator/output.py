"""The model as plain data: what ``show --json`` prints and what the XML description carries.

Every dataclass of the model becomes a map with the same members in the same order, so that nothing can be forgotten; the few places where
the outside has another word or shape are in the tables and functions below. Every member is always there: a number that the manual does not give
is null, a text that it does not give is empty. Numbers are integers. Where a position or a limit of a family depends on the order code, its expression
stands there as text, such as ``48 - singleturn_bits``; with an order code, everything is resolved.

The shape is described by ``spec/show.schema.json``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any

from .expressions import Expression
from .model import Device, Example, Field, Interface, Join, Layout, Register, Source, Sources, Step, Variant
from .order_codes import Match
from .relevant import parameters_of

VERSION = 1

Item = dict[str, Any]

#: Members that say how code computes something, not what the encoder does.
_LEFT_OUT = {"Field": {"pieces", "widest"}, "Layout": {"fold", "widest"}, "Crc": {"form"}}
#: Members that the outside calls by another word.
_RENAMED = {
    "Layout": {"sender": "from", "selector": "told_by", "selects": "told_by_values", "gaps": "other_bits", "joins": "join"},
    "Example": {"sender": "from"},
}
#: What has no source because it is one, or stands outside the manual.
_UNSOURCED = {"Manufacturer", "Manual", "Edition", "Revision", "Document"}
_NO_PARAMETERS: Mapping[str, int] = MappingProxyType({})


def device_dump(device: Device) -> Item:
    """A family as plain data."""
    return _Dump(device, None).whole(device.variants, _NO_PARAMETERS, None)


def variant_dump(device: Device, match: Match) -> Item:
    """One order code as plain data, everything resolved; what belongs to another interface is left out."""
    variant = match.variant
    label = {
        "code": variant.code, "unlisted": list(match.unlisted), "tail": match.tail, "special": match.special,
        "written_as_in": match.written_as_in,
    }
    return _Dump(for_interface(device, variant.interface), variant).whole((variant,), variant.parameters, label)


@dataclass(frozen=True)
class _Dump:
    """The walk over a device; with a variant, expressions become numbers."""

    device: Device
    variant: Variant | None

    def whole(self, variants: Iterable[Variant], parameters: Mapping[str, int], label: Item | None) -> Item:
        device = self.device
        return {
            "version": VERSION,
            "family": device.name,
            "title": device.title,
            "movement": device.movement,
            "order_code": self.variant.code if self.variant is not None else None,
            "interface": self.variant.interface if self.variant is not None else None,
            "label": label,
            "manufacturer": self.plain(device.manufacturer, ()),
            "manual": self.plain(device.manual, ()),
            "documents": self.plain(device.documents, ()),
            "parameters": dict(parameters),
            "parameter_definitions": self.plain(device.parameters, device.order_code.source),
            "order_code_grammar": self.plain(device.order_code, ()),
            "order_codes": [self.plain(item, device.order_code.source) | _cited(device.order_code.source) for item in variants],
            "interfaces": {item.kind: self._interface(item) for item in device.interfaces},
            "layouts": [self._layout(layout, item.kind, item.source) for item in device.interfaces for layout in item.layouts],
            "field_groups": self.plain(device.field_groups, ()),
            "registers": [self._register(item) for item in device.registers],
            "crcs": [self.plain(item, ()) | {"poly_with_top_bit": item.poly_with_top_bit} for item in device.crcs],
            "alarms": self.plain(device.alarms, ()),
            "procedures": [self.plain(item, ()) | {"steps": [self._step(step, item.source) for step in item.steps]} for item in device.procedures],
            "timings": self._timings(),
            "measurement": self.plain(device.measurement, ()),
            "inputs": self.plain(device.inputs, ()),
            "connectors": self.plain(device.connectors, ()),
            "leds": self.plain(device.leds, ()),
            "characteristics": self.plain(device.characteristics, ()),
            "tables": [self.plain(item, ()) | {"rows": [{"cells": list(row)} for row in item.rows]} for item in device.tables],
            "examples": self.plain(device.examples, ()),
            "errata": self.plain(device.errata, ()),
            "lost_figures": self.plain(device.lost_figures, ()),
            "supply": self.plain(device.supply, ()),
        }

    def plain(self, value: Any, inherited: Sources) -> Any:
        """Any part of the model as plain data; what has no source of its own has that of what it is part of."""
        if isinstance(value, Expression):
            return self._number(value)
        if isinstance(value, bytes):
            return value.hex(" ").upper()
        if isinstance(value, Mapping):
            return {key: self.plain(item, inherited) for key, item in value.items()}
        if isinstance(value, tuple):
            return [self.plain(item, inherited) for item in value]
        if not is_dataclass(value) or isinstance(value, type):
            return value
        kind = type(value).__name__
        own: Sources = getattr(value, "source", ()) or inherited
        renamed = _RENAMED.get(kind, {})
        left_out = _LEFT_OUT.get(kind, set())
        made = {renamed.get(item.name, item.name): self.plain(getattr(value, item.name), own) for item in fields(value) if item.name not in left_out | {"source"}}
        return made if kind in _UNSOURCED else made | _cited(own)

    def _number(self, expression: Expression) -> int | str:
        if self.variant is not None:
            return expression.value(self.variant.parameters)
        return expression.constant if expression.is_constant else expression.render()

    def _interface(self, interface: Interface) -> Item:
        made: Item = self.plain(interface, interface.source)
        clock = {"min_hz": made.pop("clock_min_hz"), "max_hz": made.pop("clock_max_hz")} | _cited(interface.clock_source)
        del made["clock_source"], made["timings"]
        for name in ("alignment", "output_code"):
            said: Sources = getattr(interface, f"{name}_source") if getattr(interface, name) else ()
            made[f"{name}_source"] = _cited(said)["source"]
        made["title"] = interface.title
        made["clock"] = clock if interface.clock_source else None
        made["layouts"] = [layout.name for layout in interface.layouts]
        return made

    def _layout(self, layout: Layout, interface: str, inherited: Sources) -> Item:
        own = layout.source or inherited
        made: Item = self.plain(replace(layout, fields=()), own)
        made["interface"] = interface
        made["join"] = [self._join(item, layout) | _cited(own) for item in layout.joins]
        made["fields"] = self._fields(layout, own)
        return made

    def _fields(self, layout: Layout, inherited: Sources) -> list[Item]:
        if self.variant is None:
            return [self._field(item, item.low + item.width - Expression(1), inherited) for item in layout.fields]
        placed = layout.place(self.variant.parameters)
        return [self._field(item.field, Expression(item.high), inherited) for item in placed.fields]

    def _field(self, field: Field, high: Expression, inherited: Sources) -> Item:
        made: Item = self.plain(field, inherited)
        is_flag, is_constant = field.kind == "flag", field.kind == "constant"
        place = {"name": made.pop("name"), "kind": made.pop("kind"), "high": self._number(high)}
        del made["active_low"]
        made["equals"] = None if isinstance(field.equals, str) else made["equals"]
        made["equals_text"] = field.equals if isinstance(field.equals, str) else ""
        made["constant"] = field.constant if is_constant else None
        made["active"] = ("low" if field.active_low else "high") if is_flag else ""
        return place | made

    def _join(self, join: Join, layout: Layout) -> Item:
        width = Expression(0)
        for name in join.fields:
            width += layout.field(name).width
        return {"name": join.name, "fields": list(join.fields), "width": self._number(width)}

    def _register(self, register: Register) -> Item:
        made: Item = self.plain(replace(register, layout=replace(register.layout, fields=(), joins=())), ())
        del made["layout"], made["opened_by_field"], made["opened_by_value"]
        data = register.default_bytes()
        made["last_address"] = register.last_address
        made["default_bytes"] = data.hex(" ").upper() if data is not None else ""
        made["opened_by"] = _opened_by(register) if register.opened_by else None
        made["other_bits"] = register.layout.gaps
        made["join"] = [self._join(item, register.layout) | _cited(register.source) for item in register.layout.joins]
        made["fields"] = self._fields(register.layout, register.source)
        return made

    def _step(self, step: Step, inherited: Sources) -> Item:
        made: Item = self.plain(step, inherited)
        return made

    def _timings(self) -> list[Item]:
        """The times of the device and of its interfaces in one list."""
        device = [self.plain(item, ()) | {"interface": ""} for item in self.device.timings]
        return device + [self.plain(item, part.source) | {"interface": part.kind} for part in self.device.interfaces for item in part.timings]


def _opened_by(register: Register) -> Item:
    return {"register": register.opened_by, "field": register.opened_by_field, "value": register.opened_by_value}


def _cited(sources: Sources) -> Item:
    """``source`` is the first; ``sources`` lists all where there are several."""
    listed = [_source(item) for item in sources]
    if len(listed) < 2:
        return {"source": listed[0] if listed else None}
    return {"source": listed[0], "sources": listed}


def _source(source: Source) -> Item:
    return {"document": source.document, "section": source.section, "page": source.page}


def for_interface(device: Device, kind: str) -> Device:
    """The device with only one of its interfaces, and without what belongs to the others."""
    interfaces = tuple(item for item in device.interfaces if item.kind == kind)
    layouts = {layout.name for item in interfaces for layout in item.layouts}
    registers = tuple(item for item in device.registers if item.interface == kind)
    procedures = tuple(item for item in device.procedures if item.interface == kind)
    all_fields = [field for item in interfaces for layout in item.layouts for field in layout.fields]
    crcs = {field.crc for field in all_fields} | {part.crc for item in interfaces for part in item.control_data}
    groups = {field.group for field in all_fields}
    names = {"layout": layouts, "register": {item.name for item in registers}, "procedure": {item.name for item in procedures}, "crc": crcs}
    alarms = tuple(item for item in device.alarms if item.group in {"", *groups} and item.register in {"", *names["register"]})
    connectors = tuple(item for item in device.connectors if not item.interfaces or kind in item.interfaces)
    examples = [item for item in device.examples if all(getattr(item, key) in {"", *found} for key, found in names.items())]
    examples = [item for item in examples if _same_interface(device, item, kind)]
    kept = {
        "interfaces": {kind},
        "registers": names["register"],
        "procedures": names["procedure"],
        "crcs": crcs,
        "field_groups": groups,
        "alarms": {item.name for item in alarms},
        "connectors": {item.name for item in connectors},
        "examples": {item.name for item in examples},
        "parameters": {item.name for item in parameters_of(device, kind)},
    }
    here = _is_here(kept)
    return replace(
        device,
        interfaces=interfaces,
        registers=registers,
        procedures=procedures,
        crcs=tuple(item for item in device.crcs if item.name in crcs),
        field_groups=tuple(item for item in device.field_groups if item.name in groups),
        alarms=alarms,
        connectors=connectors,
        examples=tuple(examples),
        errata=tuple(item for item in device.errata if not item.affects or any(map(here, item.affects))),
    )


def _is_here(kept: Mapping[str, set[str]]) -> Callable[[str], bool]:
    """Whether a path of an erratum leads to something that this interface has; paths that belong to no interface always do."""

    def found(path: str) -> bool:
        parts = path.split(".")
        return len(parts) == 1 or parts[1] in kept.get(parts[0], {parts[1]})

    return found


def _same_interface(device: Device, example: Example, kind: str) -> bool:
    """Whether an example that names an order code and no layout is one of this interface."""
    return all(variant.interface == kind for variant in device.variants if variant.code == example.order_code)
