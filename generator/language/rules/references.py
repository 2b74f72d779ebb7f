"""Rules for references to names, which must exist. Messages suggest the most similar name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...model import Biss
from ...model.expressions import Expression, ExpressionError
from ...model.steps import has_steps
from ..document import Path
from ..hints import expression_hint, number_hint
from ..problems import DocumentReport, quoted
from . import parameters
from .name_resolver import NameResolver
from .shapes import KINDS
from .walk import (
    INTERFACE_OF_REGISTERS,
    Fields,
    Has,
    Spec,
    by_name,
    field_lists,
    field_names,
    has_other_bits,
    interface_of,
    items,
    layouts,
    mapping,
    measurements,
    readable_names,
)

#: Kind of a field that is a number.
_NUMBER = "digits"


def field_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of fields and layouts: groups, CRCs, sibling fields, data IDs."""
    resolver = NameResolver(raw, report)
    for fields in field_lists(spec):
        names = list(field_names(fields, resolver.groups))
        joins = mapping(fields.owner, "join")
        for path, field in fields:
            _check_field(path, field, names, list(joins), resolver)
            has_no_table = not mapping(raw, "interfaces", fields.interface).get("data_ids")
            if "values_of" in field and fields.kind is not Has.GROUP and has_no_table:
                problem = f"the interface {quoted(fields.interface)} has no table of data IDs"
                message = f"{problem}; list the values with 'values'"
                report.add("undefined-reference", (*path, "values_of"), message)
        gray, gray_path = mapping(fields.owner, "gray"), (*fields.path, "gray")
        resolver.refer_by("of", gray_path, gray, "field or joined number", [*names, *joins])
        resolver.refer_by("when", gray_path, gray, "parameter")
        for name in mapping(fields.owner, "when"):
            resolver.refer((*fields.path, "when", name), "field", name, names)
        for join in joins:
            resolver.refer_by(join, (*fields.path, "join"), joins, "field", names)


def _check_field(path: Path, field: Spec, names: list[str], joins: list[str], resolver: NameResolver) -> None:
    """Check the references of a field. ``names`` are the fields of its layout, and ``joins`` its joined numbers."""
    resolver.refer_by("use", path, field, "field group")
    resolver.refer_by("crc", path, field, "CRC")
    siblings = [name for name in names if name != field.get("name")]
    resolver.refer_by("parity_of", path, field, "other field", [*siblings, *joins])
    resolver.refer_by("crc_of", path, field, "other field", siblings)
    for index, text in enumerate(field.get("explained_by", ())):
        resolver.refer_to_bit((*path, "explained_by", index), text)


def register_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of registers: their interface, their opener, the field that their limits apply to."""
    resolver = NameResolver(raw, report)
    for path, register in items(spec, "registers"):
        resolver.refer_by("interface", path, register, "interface")
        if "interface" not in register and INTERFACE_OF_REGISTERS not in mapping(raw, "interfaces"):
            message = (
                f"registers belong to {INTERFACE_OF_REGISTERS} by default, "
                f"but this device has no {INTERFACE_OF_REGISTERS}; add 'interface'"
            )
            report.add("undefined-reference", path, message)
        _check_opener((*path, "opened_by"), mapping(register, "opened_by"), resolver)
        fields = Fields(Has.REGISTER, register, path, interface_of(register))
        numbers = [*field_names(fields, resolver.groups), *mapping(register, "join")]
        resolver.refer_by("limits_of", path, register, "field or joined number", numbers)
        resolver.refer_by("write_clears", path, register, "register")
        for meaning_path, meaning in items(register, "meanings"):
            _check_meaning((*path, *meaning_path), meaning, resolver)


def _check_opener(path: Path, opener: Spec, resolver: NameResolver) -> None:
    """Check the register, the field and the value that open another register."""
    resolver.refer_by("register", path, opener, "register")
    name = opener.get("register")
    if name not in resolver.registers:
        return
    fields = resolver.bits(name)
    resolver.refer_by("field", path, opener, f"field of {quoted(name)} called", fields)
    if opener.get("field", "") not in ("", *fields):
        return
    values = resolver.values(name, opener.get("field"))
    resolver.refer_by("value", path, opener, f"value of {quoted(name)} called", values)
    if "field" not in opener and opener.get("value") in values and len(fields) > 1:
        problem = f"{quoted(name)} has several fields; add 'field' with the name of the field"
        resolver.report_problem((*path, "value"), f"{problem} that must hold {quoted(opener['value'])}")


def _check_meaning(path: Path, meaning: Spec, resolver: NameResolver) -> None:
    """Check the field that selects the meaning of a register, and its value."""
    when = meaning["when"]
    resolver.refer_to_bit((*path, "when"), when)
    name, _, field = when.partition(".")
    if name in resolver.registers and field in resolver.bits(name):
        resolver.refer_by("is", path, meaning, f"value of {quoted(when)} called", resolver.values(name, field))


def device_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of parameters, hardware inputs, the measurement and BiSS as a whole."""
    resolver = NameResolver(raw, report)
    for parameter_name, parameter in mapping(spec, "parameters").items():
        if "read_from" in parameter:
            resolver.refer_to_bit(("parameters", parameter_name, "read_from"), parameter["read_from"])
        resolver.refer_by("interface", ("parameters", parameter_name), parameter, "interface")
    for path, hardware_input in items(spec, "inputs"):
        for key in ("inverts", "needs"):
            if key in hardware_input:
                resolver.refer_to_bit((*path, key), hardware_input[key])
    readable: dict[str, None] = {}
    for fields in layouts(raw):
        readable |= dict.fromkeys(readable_names(fields, resolver.groups))
    for path, measurement in measurements(spec):
        resolver.refer_by("of", path, measurement, "field or joined number", readable)
        _check_measured_field(path, measurement, raw, resolver, report)
    biss_path = ("interfaces", Biss.name)
    resolver.refer_by("bank_select", biss_path, mapping(spec, *biss_path), "register")


def _check_measured_field(
    path: Path, measurement: Spec, raw: Spec, resolver: NameResolver, report: DocumentReport
) -> None:
    """Check that a field with the measured position is a number in at least one frame."""
    name = measurement.get("of", "")
    is_of_device = path == ("measurement",)
    kinds = []
    for fields in layouts(raw):
        is_measured = is_of_device or fields.interface in path
        field = field_names(fields, resolver.groups).get(name)
        if is_measured and fields.owner.get("from") == "encoder" and field is not None:
            kinds.append(_kind_of(field))
    if kinds and _NUMBER not in kinds:
        problem = f"{quoted(name)} has {quoted(kinds[0])}, so it is not a number"
        message = f"{problem}; name the field that holds the position"
        report.add("measurement-shape", (*path, "of"), message)


def alarm_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of alarms: the flag in a field group or register, and the procedures that clear them."""
    resolver = NameResolver(raw, report)
    for path, alarm in items(spec, "alarms"):
        resolver.refer_by("group", path, alarm, "field group")
        resolver.refer_by("register", path, alarm, "register")
        if "field" in alarm and "group" not in alarm and "register" not in alarm:
            message = "'field' also needs the 'group' or 'register' of the flag"
            report.add("undefined-reference", (*path, "field"), message)
        owner_key, owners = ("register", resolver.registers) if "register" in alarm else ("group", resolver.groups)
        owner_name = alarm.get(owner_key)
        if owner_name in owners:
            flags = by_name(owners[owner_name], "fields")
            resolver.refer_by("field", path, alarm, f"field of {quoted(owner_name)} called", flags)
        resolver.refer_by("cleared_by", path, alarm, "procedure")


def _kind_of(field: Spec) -> str:
    """Return the key for the kind of a field, or ``digits`` for a number."""
    for key in KINDS:
        if key in field:
            return key
    return _NUMBER


def by_hand_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that manual remedies refer to a characteristic with numbered steps."""
    resolver = NameResolver(raw, report)
    characteristics = by_name(raw, "characteristics").items()
    with_steps = [name for name, characteristic in characteristics if has_steps(f"{characteristic.get('value')}")]
    owners = list(items(spec, "alarms"))
    for led_path, led in items(spec, "leds"):
        owners += [((*led_path, *path), state) for path, state in items(led, "states")]
    for fields in field_lists(spec):
        owners += fields
    for path, owner in owners:
        resolver.refer_by("by_hand", path, owner, "characteristic with numbered steps called", with_steps)


def procedure_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of procedures: their interface, registers, values and data IDs."""
    resolver = NameResolver(raw, report)
    for path, procedure in items(spec, "procedures"):
        resolver.refer_by("interface", path, procedure, "interface")
        for argument_path, argument in items(procedure, "arguments"):
            place = (*path, *argument_path)
            register_name = argument["of"]
            resolver.refer_by("of", place, argument, "register")
            if register_name in resolver.registers:
                meanings = by_name(resolver.registers[register_name], "meanings")
                resolver.refer_by("as", place, argument, f"meaning of {quoted(register_name)} called", meanings)
        data_ids = by_name(raw, "interfaces", procedure["interface"], "data_ids")
        for step_path, step in items(procedure, "steps"):
            _check_step((*path, *step_path), step, procedure, resolver)
            resolver.refer_by("data_id", (*path, *step_path), step, "data ID", data_ids)


def _check_step(path: Path, step: Spec, procedure: Spec, resolver: NameResolver) -> None:
    """Check the register of a step, with its field and its value."""
    resolver.refer_by("register", path, step, "register")
    name = step.get("register")
    if name not in resolver.registers:
        return
    register = resolver.registers[name]
    resolver.refer_by("field", path, step, f"field of {quoted(name)} called", resolver.bits(name))
    if step.get("field", "") not in ("", *resolver.bits(name)):
        return
    arguments = [argument["name"] for _, argument in items(procedure, "arguments")]
    values = [*resolver.values(name, step.get("field")), *arguments]
    resolver.refer_by("value", path, step, f"argument, or value of {quoted(name)}, called", values)
    # The value of one field, written to the whole register, would change its other bits.
    is_value_of_field = step.get("value") in resolver.values(name, None) and step["value"] not in arguments
    if "field" not in step and is_value_of_field and has_other_bits(register, resolver.groups):
        remedy = f"add 'field' with the name of the field that must hold {quoted(step['value'])}"
        if register.get("access") == "write_only":
            remedy = "describe it as one field with all its bits, because it is write_only"
        resolver.report_problem((*path, "value"), f"{quoted(name)} has other bits, too; {remedy}")


def alternative_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the answers of an alternative set the same parameters, and that these name the alternative."""
    resolver, alternatives = NameResolver(raw, report), by_name(raw, "alternatives")
    for path, alternative in items(spec, "alternatives"):
        _check_answers(path, alternative, resolver, report)
    for name, parameter in mapping(spec, "parameters").items():
        resolver.refer_by("alternative", ("parameters", name), parameter, "alternative", alternatives)
        alternative_name = parameter.get("alternative")
        if alternative_name in alternatives and not _is_set(name, alternatives[alternative_name]):
            problem = f"no answer of {quoted(alternative_name)} sets {quoted(name)}"
            report.add("undefined-reference", ("parameters", name, "alternative"), problem)
    for path, example in items(spec, "examples"):
        for name, answer in mapping(example, "alternatives").items():
            answer_path = (*path, "alternatives", name)
            resolver.refer(answer_path, "alternative", name, alternatives)
            if name in alternatives:
                answers = mapping(alternatives[name], "values")
                resolver.refer(answer_path, f"answer of {quoted(name)} called", answer, answers)


def _is_set(parameter_name: str, alternative: Spec) -> bool:
    """Return True if any answer of an alternative sets a parameter."""
    answers = mapping(alternative, "values")
    return any(parameter_name in mapping(answers, answer, "sets") for answer in answers)


def _check_answers(path: Path, alternative: Spec, resolver: NameResolver, report: DocumentReport) -> None:
    """Check that each answer of an alternative sets all its parameters, and no others."""
    answers, owner = alternative["values"], alternative["name"]
    parameters = resolver.parameters
    own_parameters = [name for name in parameters if mapping(parameters, name).get("alternative") == owner]
    first_answers: dict[str, str] = {}
    for answer in answers:
        for name in answers[answer]["sets"]:
            first_answers.setdefault(name, answer)
    for answer in answers:
        sets, sets_path = answers[answer]["sets"], (*path, "values", answer, "sets")
        for name in sets:
            resolver.refer((*sets_path, name), "parameter", name)
            if name in parameters and name not in own_parameters:
                problem = f"{quoted(name)} is not a parameter of {quoted(owner)}; give it 'alternative: {owner}'"
                report.add("undefined-reference", (*sets_path, name), problem)
        for name in own_parameters:
            if name in first_answers and name not in sets:
                problem = f"{quoted(answer)} does not set {quoted(name)}, which {quoted(first_answers[name])} sets"
                report.add("undefined-reference", sets_path, problem)


def example_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of examples: their subject, the fields with values, and errata."""
    resolver = NameResolver(raw, report)
    known_layouts: dict[Any, Fields] = {}
    for layout in layouts(raw):
        if isinstance(layout.owner.get("name"), str):
            known_layouts[layout.owner["name"]] = layout
    for path, example in items(spec, "examples"):
        for key in ("procedure", "erratum", "register"):
            resolver.refer_by(key, path, example, key)
        resolver.refer_by("crc", path, example, "CRC")
        resolver.refer_by("layout", path, example, "layout", known_layouts)
        procedure_name = example.get("procedure", "")
        if procedure_name in resolver.procedures:
            arguments = by_name(resolver.procedures[procedure_name], "arguments")
            kind = f"argument of {quoted(procedure_name)} called"
            for name in mapping(example, "arguments"):
                resolver.refer((*path, "arguments", name), kind, name, arguments)
        fields = known_layouts.get(example.get("layout"))
        if fields is None and example.get("register") in resolver.registers:
            fields = Fields(Has.REGISTER, resolver.registers[example["register"]], (), "")
        if fields is not None:
            field_names_in_example = readable_names(fields, resolver.groups)
            for name in mapping(example, "values"):
                resolver.refer((*path, "values", name), "field", name, field_names_in_example)


#: Lists that paths leave out: a frame belongs to its interface, and a field to its frame.
_LISTS = ("layouts", "fields", "combinations")


def erratum_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each path affected by an erratum exists."""
    resolver = NameResolver(raw, report)
    # Many errata affect the same places, so the steps of each place are found once.
    steps_by_node: dict[int, dict[str, Any]] = {}
    for path, erratum in items(spec, "errata"):
        for index, affected in enumerate(erratum.get("affects", ())):
            steps = affected.split(".")
            short_steps = [*(step for step in steps[:-1] if step not in _LISTS), steps[-1]]
            if len(short_steps) < len(steps):
                problem = f"no output would find {quoted(affected)}; write {'.'.join(short_steps)}"
                report.add("undefined-reference", (*path, "affects", index), problem)
                continue
            node: Any = raw
            for step in steps:
                if id(node) not in steps_by_node:
                    steps_by_node[id(node)] = dict(_next_steps(node))
                next_nodes = steps_by_node[id(node)]
                if step not in next_nodes:
                    kind = f"place {quoted(affected)} in this spec: there is no"
                    resolver.refer((*path, "affects", index), kind, step, next_nodes)
                    break
                node = next_nodes[step]


def _next_steps(node: Any) -> Iterator[tuple[str, Any]]:
    """Yield the possible next steps of a path: keys and names.

    For a map these include the names in its lists, as in ``interfaces.biss.word``.
    """
    if isinstance(node, list):
        for list_member in node:
            if isinstance(list_member, dict) and "name" in list_member:
                yield str(list_member["name"]), list_member
    elif isinstance(node, dict):
        for key, value in node.items():
            if isinstance(value, list):
                yield from _next_steps(value)
            elif key == "values" and isinstance(value, dict):
                yield from value.items()
        yield from node.items()  # Last, so that a key takes precedence over a name.


def expressions(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that every expression is valid, and that every parameter in it exists."""
    resolver = NameResolver(raw, report)
    for path, text in parameters.expressions(spec):
        try:
            names = Expression.parse(text).parameters
        except ExpressionError as error:
            hint = expression_hint(str(text)) or number_hint(str(path[-1]), text)
            if not hint:
                hint = "; write an expression such as singleturn_bits + 8"
            report.add("bad-expression", path, f"{error}{hint}")
            continue
        for name in names:
            resolver.refer(path, "parameter", name)


def printed_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers, fields and errata named in the manual's list of defaults exist."""
    resolver = NameResolver(raw, report)
    for path, row in items(spec, "printed_defaults"):
        name = row["register"]
        resolver.refer_by("register", path, row, "register")
        if name in resolver.registers:
            resolver.refer_by("field", path, row, f"field of {quoted(name)} called", resolver.bits(name))
        resolver.refer_by("erratum", path, row, "erratum")


def connector_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the interfaces that a connector is wired for exist."""
    resolver = NameResolver(raw, report)
    for path, connector in items(spec, "connectors"):
        resolver.refer_by("interfaces", path, connector, "interface")


def unused_crc(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each CRC is a field of some frame, or has a note."""
    used_crcs: set[str] = set()
    for fields in field_lists(raw):
        used_crcs |= {field["crc"] for _, field in fields if isinstance(field.get("crc"), str)}
    if not used_crcs <= by_name(raw, "crcs").keys():
        return  # A misspelt name, which another rule reports, may be meant as the unused CRC.
    for path, crc in items(spec, "crcs"):
        if crc["name"] not in used_crcs and "note" not in crc:
            problem = f"no frame uses the CRC {quoted(crc['name'])}"
            field = f"{{name: crc, crc: {crc['name']}}}"
            remedy = f"add the field {field} at the end of its frame, or explain in a 'note' what the CRC is for"
            report.add("unused-crc", (*path, "name"), f"{problem}; {remedy}")


def evidence_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the names of documents, implementations and examples in the evidence."""
    resolver, evidence, documents = NameResolver(raw, report), mapping(spec, "evidence"), mapping(raw, "documents")
    languages = [str(edition.get("language")) for _, edition in items(raw, "manual", "editions")]
    for key in mapping(evidence, "documents"):
        resolver.refer(("evidence", "documents", key), "document", key, ("manual", *languages, *documents))
    resolver.refer_by("implementations", ("evidence",), evidence, "document", documents)
    resolver.refer_by("vectors", ("evidence",), evidence, "example", by_name(raw, "examples"))
