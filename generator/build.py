"""From checked data to the model.

What rules cannot see in the text is found here, while the model comes together: bits that overlap, limits that do not fit, examples that
contradict their layout. A part that cannot be built is reported and left out, so that one run shows every problem.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from . import codec
from .agree import check_agreement
from .build_facts import alarm, connector, erratum, example, hardware_input, manual, sources, supply, table, timing
from .crc import form, polynomial_text
from .examples import check_examples
from .expressions import Expression, ExpressionError
from .fields import Context, Raw, build_values
from .held import held_in_registers
from .layouts import build_layout
from .limits import bounded, bounded_width, bounds, representable
from .measured import check_measurements
from .model import (
    Argument, CableLength, Characteristic, CodePart, CodeValue, ControlField, Crc, DataId, Device, Document, FieldGroup, Interface, Led, LedState,
    LostFigure, Manufacturer, Measurement, MemoryAccess, Network, OrderCode, Parameter, Port, PrintedTimeout, Procedure, Register,
    RegisterMeaning, SpelledValue, Spelling, Step, Timeout, Variant,
)
from .order_codes import combinations
from .problems import DocumentReport, Path
from .reach import check_reach
from .run_time import resolve_parameters
from .sound import sound_so_far


def build_device(raw: Raw, manufacturer: Manufacturer, report: DocumentReport) -> Device | None:
    """The family that a checked device file describes, or None where an expression has no value.

    What could not be built is missing from the result; the caller uses it only when nothing was reported.
    """
    definitions = _definitions(raw)
    order_code = _order_code(raw["order_code"])
    held = held_in_registers(raw, report)
    variants = _variants(order_code, definitions, held)
    crcs = tuple(_crc(item) for item in raw.get("crcs", ()))
    context = Context(
        report=report,
        groups=MappingProxyType({item["name"]: (item, ("field_groups", index)) for index, item in enumerate(raw.get("field_groups", ()))}),
        definitions=definitions,
        parameter_sets=_parameter_sets(raw, definitions, variants),
        crcs=MappingProxyType({item.name: item for item in crcs}),
        data_ids=MappingProxyType({kind: _data_ids(item) for kind, item in raw["interfaces"].items()}),
        sources=sources,
    )
    if variants and not check_reach(raw, context, variants):
        return None
    interfaces = tuple(_interface(kind, item, context) for kind, item in raw["interfaces"].items())
    registers = _registers(raw, context)
    device = Device(
        name=raw["device"],
        title=raw["title"],
        movement=raw["movement"],
        manufacturer=manufacturer,
        manual=manual(raw["manual"]),
        documents=tuple(Document(key, item["title"], item.get("url", "")) for key, item in raw.get("documents", {}).items()),
        lost_figures=tuple(LostFigure(item["content"], sources(item)) for item in raw.get("lost_figures", ())),
        parameters=tuple(_parameter(name, item, definitions, variants) for name, item in raw["parameters"].items()),
        order_code=order_code,
        variants=variants,
        crcs=crcs,
        interfaces=interfaces,
        registers=registers,
        alarms=tuple(map(alarm, raw.get("alarms", ()))),
        procedures=(),
        timings=tuple(map(timing, raw.get("timings", ()))),
        connectors=tuple(map(connector, raw.get("connectors", ()))),
        leds=tuple(
            Led(item["name"], item["title"], tuple(LedState(state["state"], state["meaning"]) for state in item["states"]), sources(item))
            for item in raw.get("leds", ())
        ),
        characteristics=tuple(Characteristic(item["name"], item["value"], item.get("only", ""), sources(item)) for item in raw.get("characteristics", ())),
        examples=tuple(map(example, raw.get("examples", ()))),
        errata=tuple(map(erratum, raw.get("errata", ()))),
        measurement=_measurement(raw, context),
        inputs=tuple(map(hardware_input, raw.get("inputs", ()))),
        tables=tuple(map(table, raw.get("tables", ()))),
        field_groups=tuple(
            FieldGroup(item["name"], item.get("printed_name", ""), item.get("names", {}), item["bits"], item.get("note", ""), sources(item))
            for item in raw.get("field_groups", ())
        ),
        supply=supply(raw),
    )
    _check_control_bytes(device, report)
    device = replace(device, procedures=_procedures(raw, device))
    check_measurements(device, report)
    check_agreement(raw, device, report)
    check_examples(device, report)
    return device


def _definitions(raw: Raw) -> Mapping[str, Expression]:
    found = {}
    for name, item in raw["parameters"].items():
        if "equals" in item:
            try:
                found[name] = Expression.parse(item["equals"])
            except ExpressionError:
                continue  # reported by the rule on expressions
    return MappingProxyType(found)


def _order_code(raw: Raw) -> OrderCode:
    parts = tuple(
        CodePart(part["name"], part["meaning"], part.get("open", ""), tuple(_code_value(text, value or {}, part) for text, value in part["values"].items()), sources(part), _only(part, "open_only_with"))
        for part in raw["parts"]
    )
    spellings = tuple(_spelling(item) for item in raw.get("also_written", ()))
    return OrderCode(raw["pattern"], parts, raw.get("special", ""), raw.get("note", ""), sources(raw), spellings)


def _spelling(raw: Raw) -> Spelling:
    texts = ((part, *item) for part, found in raw.get("values", {}).items() for item in found.items())
    values = tuple(SpelledValue(part, text, value) for part, text, value in texts)
    return Spelling(raw["pattern"], raw["where"], values, raw.get("then", ""), sources(raw))


def _code_value(text: str, raw: Raw, part: Raw) -> CodeValue:
    sets = MappingProxyType(dict(raw.get("sets", {})))
    return CodeValue(text, raw.get("meaning", ""), raw.get("interface", ""), sets, _only(raw, "only_with"), sources(raw), supply(raw, sources(part)))


def _only(raw: Raw, key: str) -> Mapping[str, tuple[str, ...]]:
    return MappingProxyType({name: tuple(values) for name, values in raw.get(key, {}).items()})


def _variants(order_code: OrderCode, definitions: Mapping[str, Expression], held: Mapping[str, int]) -> tuple[Variant, ...]:
    found = combinations(order_code) if order_code.parts else ()
    return tuple(
        Variant(code, MappingProxyType(dict(parts)), interface, resolve_parameters({**held, **sets}, definitions)) for code, parts, interface, sets in found
    )


def _parameter_sets(
    raw: Raw, definitions: Mapping[str, Expression], variants: Sequence[Variant]
) -> Mapping[str, Sequence[Mapping[str, int]]]:
    """By interface, every set of parameters that a layout has to suit: the order codes', and the bounds of those held in registers."""
    kinds = (*raw["interfaces"], *(item.get("interface", "biss") for item in raw.get("registers", ())))
    if not variants:  # Nothing is known of parameters; what does without them can be looked at all the same.
        return MappingProxyType({kind: ({},) for kind in kinds})
    found: dict[str, list[Mapping[str, int]]] = {kind: [] for kind in kinds}
    bounds = [(name, item[key]) for name, item in raw["parameters"].items() if "read_from" in item for key in ("min", "max") if key in item]
    for variant in variants:
        known = found.setdefault(variant.interface, [])
        base = {name: value for name, value in variant.parameters.items() if name not in definitions}
        for changed in ({}, *({name: value} for name, value in bounds)):
            parameters = resolve_parameters({**base, **changed}, definitions)
            if parameters not in known:
                known.append(parameters)
    # An interface that no order code selects has been reported; its layouts are looked at with the parameters of the others.
    every = [parameters for known in found.values() for parameters in known]
    return MappingProxyType({kind: known or every for kind, known in found.items()})


def _parameter(name: str, raw: Raw, definitions: Mapping[str, Expression], variants: Sequence[Variant]) -> Parameter:
    largest = max((variant.parameters.get(name, 0) for variant in variants), default=0)
    bounds = (raw.get("read_from", ""), raw.get("min"), raw.get("max"), raw.get("interface", ""), raw.get("hexadecimal", False))
    return Parameter(name, raw["meaning"], raw.get("unit", ""), definitions.get(name), largest, sources(raw), *bounds)


def _crc(raw: Raw) -> Crc:
    shape = {key: raw[key] for key in ("width", "poly", "init", "refin", "refout")}
    return Crc(
        name=raw["name"], xorout=raw["xorout"], form=form(**shape), polynomial=polynomial_text(raw["width"], raw["poly"]),
        note=raw.get("note", ""), source=sources(raw), **shape,
    )


def _data_ids(raw: Raw) -> tuple[DataId, ...]:
    return tuple(
        DataId(item["name"], item["id"], item["control"], item["purpose"], item.get("meaning", ""), sources(item)) for item in raw.get("data_ids", ())
    )


def _interface(kind: str, raw: Raw, context: Context) -> Interface:
    path: Path = ("interfaces", kind)
    layouts = (build_layout(item, (*path, "layouts", index), context, interface=kind) for index, item in enumerate(raw["layouts"]))
    extra: dict[str, Any] = {}
    if "clock" in raw:
        extra |= {"clock_min_hz": raw["clock"]["min_hz"], "clock_max_hz": raw["clock"]["max_hz"], "clock_source": sources(raw["clock"])}
    if "network" in raw:
        extra["network"] = Network(raw["network"]["topology"], raw["network"]["multiple_slaves"], sources(raw["network"]))
    if "timeout" in raw:
        timeout = raw["timeout"]
        printed = tuple(PrintedTimeout(item["clock_hz"], item["timeout_ns"]) for item in timeout.get("printed", ()))
        bounds = {key: timeout.get(key) for key in ("half_clock_periods", "at_most_ns", "typical_ns")}
        extra["timeout"] = Timeout(rule=timeout["rule"], printed=printed, source=sources(timeout), **bounds)
    if "control_data" in raw:
        extra["control_data"] = tuple(_control_field(item, raw["control_data"], context) for item in raw["control_data"]["fields"])
        extra["control_data_note"] = raw["control_data"].get("note", "")
    if "port" in raw:
        port = raw["port"]
        extra["port"] = Port(port["baud"], port["data_bits"], port["parity"], port["stop_bits"], port.get("flow_control", "none"), sources(port))
    return Interface(
        kind=kind,
        layouts=tuple(item for item in layouts if item is not None),
        timings=tuple(map(timing, raw.get("timings", ()))),
        note=raw.get("note", ""),
        source=sources(raw),
        signals=raw.get("signals", ""),
        alignment=raw.get("alignment", ""),
        alignment_source=sources(raw, "alignment_source") or sources(raw),
        output_code=raw.get("output_code", ""),
        output_code_source=sources(raw, "output_code_source") or sources(raw),
        cable_lengths=tuple(CableLength(item["shorter_than_m"], item["below_hz"], sources(item) or sources(raw)) for item in raw.get("cable_lengths", ())),
        profile=raw.get("profile", ""),
        description_file=raw.get("description_file", ""),
        bank_select=raw.get("bank_select", ""),
        measurement=_measurement(raw, context),
        data_ids=context.data_ids.get(kind, ()),
        memory_access=tuple(
            MemoryAccess(item["access"], item["busy"], item["address"], item["data"], item["meaning"], sources(item)) for item in raw.get("memory_access", ())
        ),
        **extra,
    )


def _control_field(raw: Raw, parent: Raw, context: Context) -> ControlField:
    bits = raw.get("bits", context.crcs[raw["crc"]].width if raw.get("crc") in context.crcs else 1)
    values = build_values(raw, context)
    return ControlField(raw["name"], raw.get("printed_name", ""), bits if isinstance(bits, int) else 0, values, raw.get("crc", ""), raw.get("meaning", ""), sources(raw) or sources(parent), raw.get("names", {}))


def _registers(raw: Raw, context: Context) -> tuple[Register, ...]:
    built = (_register(item, ("registers", index), context) for index, item in enumerate(raw.get("registers", ())))
    return tuple(item for item in built if item is not None)


def _register(raw: Raw, path: Path, context: Context) -> Register | None:
    interface = raw.get("interface", "biss")
    body = raw if "fields" in raw else {**raw, "fields": [{"name": raw["name"], "bits": 8 * raw["length"]}]}
    layout = build_layout(body, path, context, interface=interface, total=8 * raw["length"])
    if layout is None:
        return None
    opened = raw.get("opened_by", {})
    register = Register(
        name=raw["name"],
        printed_name=raw.get("printed_name", ""),
        names=raw.get("names", {}),
        meaning=raw.get("meaning", ""),
        interface=interface,
        address=raw["address"],
        length=raw["length"],
        access=raw["access"],
        byte_order=raw.get("byte_order", "high_byte_first"),
        default=raw.get("default"),
        min=context.expression(raw["min"]) if "min" in raw else None,
        max=context.expression(raw["max"]) if "max" in raw else None,
        limits_of=raw.get("limits_of", raw["name"]),
        opened_by=opened.get("register", ""),
        opened_by_value=opened.get("value", ""),
        clears_itself=raw.get("clears_itself", False),
        wait_at_least_ms=raw.get("wait_at_least_ms"),
        volatile=raw.get("volatile", False),
        layout=layout,
        note=raw.get("note", ""),
        source=sources(raw),
        above_max=raw.get("above_max", ""),
        write_clears=tuple(raw.get("write_clears", ())),
        meanings=tuple(_register_meaning(item, context) for item in raw.get("meanings", ())),
        reserved=raw.get("reserved", ""),
        bank=raw.get("bank"),
        opened_by_field=opened.get("field", ""),
    )
    _check_limits(register, path, context)
    return register


def _register_meaning(raw: Raw, context: Context) -> RegisterMeaning:
    low, high = (context.expression(raw[key]) if key in raw else None for key in ("min", "max"))
    return RegisterMeaning(raw["name"], raw["when"], raw["is"], low, high, raw.get("meaning", ""), sources(raw))


def _check_limits(register: Register, path: Path, context: Context) -> None:
    """Whether the limits fit what they bound, and the default fits the limits and the named values."""
    report = context.report
    for parameters in context.parameter_sets.get(register.interface, ()):
        placed = register.layout.place(parameters)
        join = next((item for item in register.layout.joins if item.name == bounded(register)), None)
        item = placed.field(bounded(register))
        width, zero_means = bounded_width(register, placed), item.field.zero_means if item is not None else 0
        lowest, highest = representable(register, placed)
        low, high = bounds(register, placed, (register.min, register.max), parameters)
        if high == zero_means:
            high -= 1
        if low < lowest or high > highest or low > high:
            key = "max" if high > highest else "min"
            wrong = f"the {key}imum {high if key == 'max' else low} does not fit into the {width} bits of '{register.limits_of}'"
            if lowest <= low and high <= highest:
                wrong = f"the minimum {low} is above the maximum {high}"
            report.add("limit-does-not-fit", (*path, key), wrong)
            return
        if register.default is None:
            continue
        if register.default >> (8 * register.length):
            report.add("default-does-not-fit", (*path, "default"), f"the default {register.default:#x} does not fit into {8 * register.length} bits")
            return
        value = codec.join_value(placed, join, register.default) if join is not None else register.default >> (item.low if item is not None else 0) & ((1 << width) - 1)
        value -= 1 << width if value > highest else 0
        if not low <= (value or zero_means) <= max(high, zero_means):
            report.add("default-does-not-fit", (*path, "default"), f"the default {value} is outside the limits {low} to {high}")
            return
        if register.values and register.default not in [item.value for item in register.values] and not register.clears_itself:
            listed = ", ".join(f"{item.value:#x}" for item in register.values)
            report.add("default-does-not-fit", (*path, "default"), f"the default {register.default:#x} is none of the values {listed}")
            return


def _measurement(raw: Raw, context: Context) -> Measurement | None:
    if "measurement" not in raw:
        return None
    found = raw["measurement"]
    parts = {key: context.expression(found[key]) if key in found else None for key in ("steps_per_turn", "turns", "step_um", "steps", "highest")}
    return Measurement(of=found["of"], source=sources(found), **parts)


def _procedures(raw: Raw, device: Device) -> tuple[Procedure, ...]:
    found = []
    for item in raw.get("procedures", ()):
        steps = tuple(_step(step, item, device) for step in item["steps"])
        found.append(
            Procedure(
                name=item["name"], title=item["title"], interface=item["interface"], 
                arguments=tuple(Argument(entry["name"], entry["of"], entry.get("meaning", ""), entry.get("as", "")) for entry in item.get("arguments", ())), precondition=item.get("precondition", ""), steps=steps,
                result=item.get("result", ""), note=item.get("note", ""), source=sources(item),
            )
        )
    return tuple(found)


def _step(raw: Raw, procedure: Raw, device: Device) -> Step:
    step = Step(do=raw["do"], meaning=raw.get("meaning", ""), source=sources(raw) or sources(procedure))
    if raw["do"] == "wait":
        return replace(step, microseconds=1000 * raw.get("at_least_ms", 0))
    if raw["do"] == "send":
        request = _request(device, raw.get("data_id", ""))
        return replace(step, data_id=raw.get("data_id", ""), request=request, times=raw.get("times", 1), microseconds=raw.get("every_at_least_us", 0))
    step = replace(step, register=raw.get("register", ""), field=raw.get("field", ""), value_name=raw.get("value", ""))
    if raw["do"] == "poll":
        return replace(step, value=raw.get("until", 0))
    register = next((item for item in device.registers if item.name == step.register), None)
    fields = [item for item in register.layout.fields if not step.field or item.name == step.field] if register is not None else []
    named = next((value for item in fields for value in item.values if value.name == step.value_name), None) if step.field or len(fields) == 1 else None
    return replace(step, value=named.value if named is not None else None)


def _request(device: Device, data_id: str) -> bytes:
    """The request of one byte that asks for this data ID: its control field."""
    for interface in device.interfaces:
        for item in interface.data_ids:
            if item.name == data_id:
                return bytes([item.control])
    return b""


def _check_control_bytes(device: Device, report: DocumentReport) -> None:
    """Whether each printed control byte is what its data ID encodes to."""
    known = sound_so_far(report)
    for interface in device.interfaces:
        for item in interface.data_ids:
            layout = next((layout for layout in interface.layouts if item.id in layout.selects), None)
            variant = next((variant for variant in device.variants if variant.interface == interface.kind), None)
            if not known.has_frames or variant is None:
                continue
            if layout is None:
                wrong = f"no layout is sent or received for data ID {item.id:X}; add it to a layout's 'when'"
                report.add("undefined-reference", ("interfaces", interface.kind, "data_ids", item.name), wrong)
                continue
            placed = layout.place(variant.parameters)
            values = {field.name: 0 for field in layout.data_fields} | {layout.selector: item.id}
            try:
                made = codec.number_to_bytes(layout, codec.encode(device, placed, values), placed.bits)[0]
            except codec.EncodeError:
                continue  # a layout that cannot be encoded with zeros is found by other rules
            if made != item.control:
                wrong = f"the control field of data ID {item.id:X} is {made:#04x} by its fields; the manual's {item.control:#04x} does not agree"
                report.add("control-mismatch", ("interfaces", interface.kind, "data_ids", item.name, "control"), wrong)
