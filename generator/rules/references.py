"""Rules on names that refer to something: it has to exist. The nearest name is offered where there is one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ..expressions import Expression, ExpressionError
from ..problems import DocumentReport, Path, quoted, suggestion
from ..schema_hints import number_hint
from .shapes import ANGLE, LENGTH
from .walk import (
    INTERFACE_OF_REGISTERS, Fields, Spec, bits_of, by_name, field_lists, field_names, interface_of, items, layouts, mapping, measurements,
    named_values, readable_names,
)


def _refer(report: DocumentReport, path: Path, kind: str, name: str, known: Iterable[str]) -> None:
    """Reports ``name`` at ``path`` unless it is known; ``kind`` says what it should be, as in ``register``."""
    choices = list(known)
    if name not in choices:
        report.add("undefined-reference", path, f"there is no {kind} {quoted(name)}{suggestion(name, choices, 'known are')}")


def _refer_to_bit(report: DocumentReport, path: Path, text: str, raw: Spec) -> None:
    """Reports ``text``, written as ``register.field``, unless both exist."""
    registers = by_name(raw, "registers")
    name, _, field = text.partition(".")
    _refer(report, path, "register", name, registers)
    if name in registers:
        _refer(report, path, f"field of {quoted(name)} called", field, bits_of(registers[name], by_name(raw, "field_groups")))


def field_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What fields and layouts refer to: groups, CRCs, sibling fields, data IDs."""
    groups, crcs = by_name(raw, "field_groups"), by_name(raw, "crcs")
    for fields in field_lists(spec):
        names = list(field_names(fields, groups))
        for path, field in fields:
            if "use" in field:
                _refer(report, (*path, "use"), "field group", field["use"], groups)
            if "crc" in field:
                _refer(report, (*path, "crc"), "CRC", field["crc"], crcs)
            if "parity_of" in field:
                siblings = [name for name in names if name != field.get("name")]
                _refer(report, (*path, "parity_of"), "other field", field["parity_of"], siblings)
            if "values_of" in field and fields.kind != "group" and not mapping(raw, "interfaces", fields.interface).get("data_ids"):
                message = f"the interface {quoted(fields.interface)} has no table of data IDs; list the values with 'values'"
                report.add("undefined-reference", (*path, "values_of"), message)
            for index, text in enumerate(field.get("explained_by", ())):
                _refer_to_bit(report, (*path, "explained_by", index), text, raw)
        gray = mapping(fields.owner, "gray")
        if gray:
            _refer(report, (*fields.path, "gray", "of"), "field or joined number", gray["of"], [*names, *mapping(fields.owner, "join")])
            _refer(report, (*fields.path, "gray", "when"), "parameter", gray["when"], mapping(raw, "parameters"))
        for name in mapping(fields.owner, "when"):
            _refer(report, (*fields.path, "when", name), "field", name, names)
        for join, members in mapping(fields.owner, "join").items():
            for index, name in enumerate(members):
                _refer(report, (*fields.path, "join", join, index), "field", name, names)


def register_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What registers refer to: their interface, the register that opens them, the field that their limits bound."""
    groups, registers = by_name(raw, "field_groups"), by_name(raw, "registers")
    for path, register in items(spec, "registers"):
        interface = interface_of(register)
        if "interface" in register:
            _refer(report, (*path, "interface"), "interface", interface, mapping(raw, "interfaces"))
        elif interface not in mapping(raw, "interfaces"):
            message = f"registers belong to {INTERFACE_OF_REGISTERS} unless 'interface' says otherwise, and this device has no {INTERFACE_OF_REGISTERS}"
            report.add("undefined-reference", path, message)
        if "opened_by" in register:
            opened = register["opened_by"]
            _refer(report, (*path, "opened_by", "register"), "register", opened["register"], registers)
            if opened["register"] in registers:
                opener = registers[opened["register"]]
                if "field" in opened:
                    _refer(report, (*path, "opened_by", "field"), f"field of {quoted(opened['register'])} called", opened["field"], bits_of(opener, groups))
                values = named_values(opener, groups, opened.get("field"))
                _refer(report, (*path, "opened_by", "value"), f"value of {quoted(opened['register'])} called", opened["value"], values)
        if "limits_of" in register:
            fields = Fields("register", register, path, interface)
            known = [*field_names(fields, groups), *mapping(register, "join")]
            _refer(report, (*path, "limits_of"), "field or joined number", register["limits_of"], known)
        for index, name in enumerate(register.get("write_clears", ())):
            _refer(report, (*path, "write_clears", index), "register", name, registers)
        for below, meaning in items(register, "meanings"):
            _refer_to_bit(report, (*path, *below, "when"), meaning["when"], raw)
            name, _, field = meaning["when"].partition(".")
            if name in registers and field in bits_of(registers[name], groups):
                _refer(report, (*path, *below, "is"), f"value of {quoted(meaning['when'])} called", meaning["is"], named_values(registers[name], groups, field))


def device_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What parameters, hardware inputs, the measurement and BiSS as a whole refer to."""
    for name, parameter in mapping(spec, "parameters").items():
        if "read_from" in parameter:
            _refer_to_bit(report, ("parameters", name, "read_from"), parameter["read_from"], raw)
        if "interface" in parameter:
            _refer(report, ("parameters", name, "interface"), "interface", parameter["interface"], mapping(raw, "interfaces"))
    for path, item in items(spec, "inputs"):
        for key in ("inverts", "needs"):
            if key in item:
                _refer_to_bit(report, (*path, key), item[key], raw)
    for path, measurement in measurements(spec):
        groups = by_name(raw, "field_groups")
        known = [name for fields in layouts(raw) for name in readable_names(fields, groups)]
        _refer(report, (*path, "of"), "field or joined number", measurement["of"], dict.fromkeys(known))
    bank_select = mapping(spec, "interfaces", "biss").get("bank_select")
    if bank_select is not None:
        _refer(report, ("interfaces", "biss", "bank_select"), "register", bank_select, by_name(raw, "registers"))


def alarm_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What alarms refer to: the flag in a field group, and the procedures that clear them."""
    groups, procedures = by_name(raw, "field_groups"), by_name(raw, "procedures")
    for path, alarm in items(spec, "alarms"):
        if "group" in alarm:
            _refer(report, (*path, "group"), "field group", alarm["group"], groups)
        if "register" in alarm:
            registers = by_name(raw, "registers")
            _refer(report, (*path, "register"), "register", alarm["register"], registers)
            if "field" in alarm and alarm["register"] in registers:
                known = by_name(registers[alarm["register"]], "fields")
                _refer(report, (*path, "field"), f"field of {quoted(alarm['register'])} called", alarm["field"], known)
        elif "field" in alarm and "group" not in alarm:
            report.add("undefined-reference", (*path, "field"), "'field' names a flag; say where with 'group' or 'register'")
        elif "field" in alarm and alarm["group"] in groups:
            known = by_name(groups[alarm["group"]], "fields")
            _refer(report, (*path, "field"), f"field of {quoted(alarm['group'])} called", alarm["field"], known)
        for index, name in enumerate(alarm.get("cleared_by", ())):
            _refer(report, (*path, "cleared_by", index), "procedure", name, procedures)


def procedure_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What procedures refer to: their interface, registers, values and data IDs."""
    groups, registers = by_name(raw, "field_groups"), by_name(raw, "registers")
    for path, procedure in items(spec, "procedures"):
        interface = procedure["interface"]
        _refer(report, (*path, "interface"), "interface", interface, mapping(raw, "interfaces"))
        arguments = []
        for below, argument in items(procedure, "arguments"):
            _refer(report, (*path, *below, "of"), "register", argument["of"], registers)
            if "as" in argument and argument["of"] in registers:
                meanings = by_name(registers[argument["of"]], "meanings")
                _refer(report, (*path, *below, "as"), f"meaning of {quoted(argument['of'])} called", argument["as"], meanings)
            arguments.append(argument["name"])
        for below, step in items(procedure, "steps"):
            here = (*path, *below)
            register = registers.get(step.get("register", ""))
            if "register" in step:
                _refer(report, (*here, "register"), "register", step["register"], registers)
            if "field" in step and register is not None:
                _refer(report, (*here, "field"), f"field of {quoted(step['register'])} called", step["field"], bits_of(register, groups))
            if "value" in step and register is not None:
                known = [*named_values(register, groups, step.get("field")), *arguments]
                _refer(report, (*here, "value"), f"argument, or value of {quoted(step['register'])}, called", step["value"], known)
            if "data_id" in step:
                _refer(report, (*here, "data_id"), "data ID", step["data_id"], by_name(raw, "interfaces", interface, "data_ids"))


def example_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What examples refer to: what they are examples of, the fields that they give values of, and errata."""
    groups, registers, errata = by_name(raw, "field_groups"), by_name(raw, "registers"), by_name(raw, "errata")
    procedures = by_name(raw, "procedures")
    known_layouts = {layout.owner["name"]: layout for layout in layouts(raw) if isinstance(layout.owner.get("name"), str)}
    simple = (("procedure", procedures), ("crc", by_name(raw, "crcs")), ("erratum", errata), ("register", registers), ("layout", known_layouts))
    for path, example in items(spec, "examples"):
        for key, known in simple:
            if key in example:
                _refer(report, (*path, key), "CRC" if key == "crc" else key, example[key], known)
        if example.get("procedure") in procedures:
            arguments = by_name(procedures[example["procedure"]], "arguments")
            for name in mapping(example, "arguments"):
                _refer(report, (*path, "arguments", name), f"argument of {quoted(example['procedure'])} called", name, arguments)
        of = None
        if example.get("layout") in known_layouts:
            of = known_layouts[example["layout"]]
        elif example.get("register") in registers:
            of = Fields("register", registers[example["register"]], (), "")
        if of is not None:
            names = readable_names(of, groups)
            for name in mapping(example, "values"):
                _refer(report, (*path, "values", name), "field", name, names)


def erratum_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Each path of what an erratum affects leads somewhere."""
    for path, erratum in items(spec, "errata"):
        for index, affected in enumerate(erratum.get("affects", ())):
            node: Any = raw
            for step in affected.split("."):
                found = dict(_below(node))
                if step not in found:
                    _refer(report, (*path, "affects", index), f"place {quoted(affected)} in this spec: nothing called", step, found)
                    break
                node = found[step]


def _below(node: Any) -> Iterator[tuple[str, Any]]:
    """What the next step of a path may be: a key or a name, and from a map also the names in its lists, as in ``interfaces.biss.word``."""
    if isinstance(node, list):
        yield from ((str(item["name"]), item) for item in node if isinstance(item, dict) and "name" in item)
    elif isinstance(node, dict):
        for key, value in node.items():
            if isinstance(value, list):
                yield from _below(value)
            elif key == "values" and isinstance(value, dict):
                yield from value.items()
        yield from node.items()  # Last, so that a key wins over a name.


def expressions(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Every expression can be read, and every parameter in it exists."""
    parameters = mapping(raw, "parameters")
    for path, text in _expressions(spec):
        try:
            names = Expression.parse(text).parameters
        except ExpressionError as error:
            hint = number_hint(str(path[-1]), text) or (f"; write {str(text).replace('**', '^')}" if "**" in str(text) else "")
            report.add("bad-expression", path, f"{error}{hint or '; write it as in singleturn_bits + 8'}")
            continue
        for name in names:
            _refer(report, path, "parameter", name, parameters)


def _expressions(spec: Spec) -> Iterator[tuple[Path, int | str]]:
    for name, parameter in mapping(spec, "parameters").items():
        if "equals" in parameter:
            yield ("parameters", name, "equals"), parameter["equals"]
    for fields in field_lists(spec):
        for path, field in fields:
            # What a text equals is text; what a number equals may depend on the order code.
            keys = ("bits",) if "text" in field else ("bits", "equals")
            yield from (((*path, key), field[key]) for key in keys if key in field)
    for path, register in items(spec, "registers"):
        yield from (((*path, key), register[key]) for key in ("min", "max") if key in register)
        for below, meaning in items(register, "meanings"):
            yield from (((*path, *below, key), meaning[key]) for key in ("min", "max") if key in meaning)
    for path, measurement in measurements(spec):
        yield from (((*path, key), measurement[key]) for key in (*ANGLE, *LENGTH) if key in measurement)


def order_code_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What the values of an order code refer to: parameters, interfaces, other parts and their values."""
    parameters, parts, interfaces = mapping(raw, "parameters"), by_name(raw, "order_code", "parts"), mapping(raw, "interfaces")

    def refer_to_parts(path: Path, part: Spec, combined: Spec) -> None:
        for name, texts in combined.items():
            _refer(report, (*path, name), "other part", name, [other for other in parts if other != part["name"]])
            for index, other in enumerate(texts if name in parts else ()):
                _refer(report, (*path, name, index), f"{name}", other, mapping(parts[name], "values"))

    for path, part in items(spec, "order_code", "parts"):
        refer_to_parts((*path, "open_only_with"), part, mapping(part, "open_only_with"))
        for text, value in part["values"].items():
            here = (*path, "values", text)
            for name in mapping(value, "sets"):
                _refer(report, (*here, "sets", name), "parameter", name, parameters)
            if "interface" in value:
                _refer(report, (*here, "interface"), "interface", value["interface"], interfaces)
            refer_to_parts((*here, "only_with"), part, mapping(value, "only_with"))


def connector_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """The interfaces that a connector is wired for exist."""
    for path, connector in items(spec, "connectors"):
        for index, interface in enumerate(connector.get("interfaces", ())):
            _refer(report, (*path, "interfaces", index), "interface", interface, mapping(raw, "interfaces"))
