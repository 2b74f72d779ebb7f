"""Reduce a device to some of its interfaces or order codes, without parts that belong only to others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import Protocol

from ..model import (
    Biss,
    CodePart,
    CrcExample,
    CrcValue,
    Device,
    Example,
    FrameExample,
    Input,
    Interface,
    MeasureExample,
    ProcedureExample,
    RegisterExample,
    assert_never,
)
from .holding_only import held_by
from .parameters import parameters_of


def for_codes(device: Device, codes: Collection[str]) -> Device:
    """Return the device with only these listed order codes, without interfaces and examples of the others."""
    variants = tuple(item for item in device.variants if item.code in codes)
    kinds = {item.interface for item in variants}
    here = for_interfaces(device, kinds) if kinds != {item.name for item in device.interfaces} else device
    here = held_by(here, [item.code for item in variants])
    parameters = {item.name for kind in kinds for item in parameters_of(device, kind)}
    examples = tuple(item for item in here.examples if getattr(item, "order_code", "") in {"", *codes})
    return replace(
        here,
        variants=variants,
        examples=examples,
        parameters=tuple(item for item in here.parameters if item.name in parameters),
        order_code=replace(
            device.order_code,
            parts=tuple(_listed(item, {one.parts[item.name] for one in variants}) for item in device.order_code.parts),
        ),
    )


def _listed(part: CodePart, texts: Collection[str]) -> CodePart:
    return replace(part, values=tuple(item for item in part.values if item.text in texts))


def for_interface(device: Device, kind: str) -> Device:
    """Return the device with only one of its interfaces, and without parts that belong to the others."""
    return for_interfaces(device, {kind})


def for_interfaces(device: Device, kinds: Collection[str]) -> Device:
    """Return the device with only some of its interfaces, and without parts that belong only to the others."""
    part = _with_used(_with_own(device, kinds), sent_crcs(device.interfaces))
    kept = {
        "interfaces": _names(part.interfaces),
        "registers": _names(part.registers),
        "procedures": _names(part.procedures),
        "crcs": _names(part.crcs),
        "field_groups": _names(part.field_groups),
        "alarms": _names(part.alarms),
        "connectors": _names(part.connectors),
        "parameters": {item.name for kind in kinds for item in parameters_of(device, kind)},
        "alternatives": _names(part.alternatives),
    }
    layouts = {layout.name for item in part.interfaces for layout in item.layouts}
    examples = tuple(item for item in device.examples if _holds_for(item, kinds, device, kept | {"layouts": layouts}))
    here = _is_here(kept | {"examples": _names(examples)})
    errata = tuple(item for item in device.errata if not item.affects or any(map(here, item.affects)))
    return replace(part, examples=examples, errata=errata)


def _with_own(device: Device, kinds: Collection[str]) -> Device:
    """Return the device with only those parts that refer to one of these interfaces or to none."""
    return replace(
        device,
        interfaces=tuple(item for item in device.interfaces if item.name in kinds),
        registers=tuple(item for item in device.registers if item.interface in kinds),
        procedures=tuple(item for item in device.procedures if item.interface in kinds),
        connectors=tuple(
            item for item in device.connectors if not item.interfaces or not set(kinds).isdisjoint(item.interfaces)
        ),
    )


def sent_crcs(interfaces: Collection[Interface]) -> set[str]:
    """Return the names of the CRCs that are in a frame of one of the interfaces."""
    sent = (field for item in interfaces for layout in item.layouts for field in layout.fields)
    crcs = {field.kind.crc for field in sent if isinstance(field.kind, CrcValue)}
    return crcs | {part.crc for item in interfaces if isinstance(item, Biss) for part in item.control_data}


def _with_used(device: Device, crcs_sent: Collection[str]) -> Device:
    """Return the device with only the CRCs, groups, alarms and alternatives that its frames and registers use.

    A CRC that is in no frame, such as that of a memory, belongs to all interfaces. ``crcs_sent`` are the others.
    """
    sent = [field for item in device.interfaces for layout in item.layouts for field in layout.fields]
    crcs = sent_crcs(device.interfaces)
    groups, registers = {"", *(field.group for field in sent)}, {"", *_names(device.registers)}
    layouts = [layout for item in device.interfaces for layout in item.layouts]
    layouts += [item.layout for item in device.registers]
    decisions = {
        item.name
        for layout in layouts
        for item in (*device.alternatives_of(layout), *device.verdict_alternatives(layout))
    }
    return replace(
        device,
        crcs=tuple(item for item in device.crcs if item.name in crcs or item.name not in crcs_sent),
        field_groups=tuple(item for item in device.field_groups if item.name in groups),
        alarms=tuple(item for item in device.alarms if item.group in groups and item.register in registers),
        alternatives=tuple(item for item in device.alternatives if item.name in decisions),
        inputs=tuple(_with_registers(item, registers) for item in device.inputs),
    )


def _with_registers(item: Input, registers: Collection[str]) -> Input:
    """Return the input without the effects of other interfaces' registers."""

    def held(path: str) -> str:
        return path if path.partition(".")[0] in registers else ""

    return replace(item, inverts=held(item.inverts), needs=held(item.needs))


class _Named(Protocol):
    @property
    def name(self) -> str: ...


def _names(items: Iterable[_Named]) -> set[str]:
    return {item.name for item in items}


def _is_here(kept: Mapping[str, set[str]]) -> Callable[[str], bool]:
    """Return a function that tests whether a path of an erratum leads to a part of these interfaces.

    Paths that belong to no interface pass the test.
    """

    def found(path: str) -> bool:
        parts = path.split(".")
        return len(parts) == 1 or parts[1] in kept.get(parts[0], {parts[1]})

    return found


def _holds_for(example: Example, interfaces: Collection[str], device: Device, kept: Mapping[str, set[str]]) -> bool:
    """Return whether an example is about a part of these interfaces, and its order code has one of the interfaces."""
    match example:
        case FrameExample():
            found = example.layout in {"", *kept["layouts"]}
        case RegisterExample():
            found = example.register in kept["registers"]
        case ProcedureExample():
            found = example.procedure in kept["procedures"]
        case CrcExample():
            return example.crc in kept["crcs"]
        case MeasureExample():
            found = True
        case _:
            assert_never(example)
    codes = (variant for variant in device.variants if variant.code == example.order_code)
    return found and all(variant.interface in interfaces for variant in codes)
