"""Rules for references to names, which must exist. Messages suggest the most similar name."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from ...model import INTERFACES, Biss
from ...model.expressions import Expression, ExpressionError
from ...model.steps import has_steps
from ..document import Path
from ..hints import expression_hint, number_hint
from ..problems import DocumentReport, nearest_choice, quoted, suggestion
from ..schema_check import value_at
from . import parameters
from .shapes import KINDS
from .walk import (
    INTERFACE_OF_REGISTERS,
    Fields,
    Has,
    Spec,
    bits_of,
    by_name,
    field_lists,
    field_names,
    has_other_bits,
    interface_of,
    items,
    layouts,
    mapping,
    measurements,
    named_values,
    readable_names,
)

_NAME = re.compile("[a-z][a-z0-9]*(_[a-z0-9]+)*")


class NameResolver:
    """Names defined in a spec as read, by kind, and the report for undefined ones."""

    def __init__(self, raw: Spec, report: DocumentReport) -> None:
        self._report = report
        self._broken = {name for name in mapping(raw, "interfaces") if name not in INTERFACES}
        for path in report.faults():
            name = value_at(raw, path) if path[-1] == "name" else path[-1]
            if isinstance(name, str) and not _NAME.fullmatch(name):
                self._broken.add(name)
        self.groups, self.registers = by_name(raw, "field_groups"), by_name(raw, "registers")
        self.procedures, self.parameters = by_name(raw, "procedures"), mapping(raw, "parameters")
        self._known: Mapping[str, Collection[str]] = {
            "CRC": by_name(raw, "crcs"),
            "erratum": by_name(raw, "errata"),
            "field group": self.groups,
            "interface": mapping(raw, "interfaces"),
            "parameter": self.parameters,
            "procedure": self.procedures,
            "register": self.registers,
        }

    def refer(self, path: Path, kind: str, name: str, known_names: Collection[str] | None = None) -> None:
        """Report ``name`` at ``path`` unless it is in ``known_names``, by default all names of its kind.

        If one of these names is itself wrong, it is reported already and may be the one that is nearest_choice.
        """
        choices = self._known[kind] if known_names is None else known_names
        if name in choices:
            return
        if self._broken.isdisjoint(choices) or nearest_choice(
            name, [choice for choice in choices if choice not in self._broken]
        ):
            problem = f"there is no {kind} {quoted(name)}{suggestion(name, choices)}"
            self._report.add("undefined-reference", path, problem)
        else:
            self._report.mark(path)

    def report_problem(self, path: Path, problem: str) -> None:
        """Report a name that exists but is not sufficient."""
        self._report.add("undefined-reference", path, problem)

    def refer_by(
        self, key: str, path: Path, owner: Spec, kind: str, known_names: Collection[str] | None = None
    ) -> None:
        """Call ``refer`` for the value of a key: one name, several names, or none."""
        references = owner.get(key, ())
        for name, place in (
            [(references, ())]
            if isinstance(references, str)
            else [(reference, (at,)) for at, reference in enumerate(references)]
        ):
            self.refer((*path, key, *place), kind, name, known_names)

    def refer_to_bit(self, path: Path, text: str) -> None:
        """Report ``text``, written as ``register.field``, unless both exist."""
        name, _, field = text.partition(".")
        self.refer(path, "register", name)
        if name in self.registers:
            self.refer(path, f"field of {quoted(name)} called", field, self.bits(name))

    def bits(self, register: str) -> list[str]:
        """Return the names allowed after the dot that follows a register."""
        return bits_of(self.registers[register], self.groups)

    def values(self, register: str, field: str | None) -> list[str]:
        """Return the names of values of a register, or of one of its fields."""
        return named_values(self.registers[register], self.groups, field)


def field_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of fields and layouts: groups, CRCs, sibling fields, data IDs."""
    resolver = NameResolver(raw, report)
    for fields in field_lists(spec):
        names = list(field_names(fields, resolver.groups))
        joins, gray, gray_path = mapping(fields.owner, "join"), mapping(fields.owner, "gray"), (*fields.path, "gray")
        for path, field in fields:
            resolver.refer_by("use", path, field, "field group")
            resolver.refer_by("crc", path, field, "CRC")
            if "parity_of" in field or "crc_of" in field:
                siblings = [name for name in names if name != field.get("name")]
                resolver.refer_by("parity_of", path, field, "other field", [*siblings, *joins])
                resolver.refer_by("crc_of", path, field, "other field", siblings)
            if (
                "values_of" in field
                and fields.kind is not Has.GROUP
                and not mapping(raw, "interfaces", fields.interface).get("data_ids")
            ):
                message = (
                    f"the interface {quoted(fields.interface)} has no table of data IDs; list the values with 'values'"
                )
                report.add("undefined-reference", (*path, "values_of"), message)
            for index, text in enumerate(field.get("explained_by", ())):
                resolver.refer_to_bit((*path, "explained_by", index), text)
        resolver.refer_by("of", gray_path, gray, "field or joined number", [*names, *joins])
        resolver.refer_by("when", gray_path, gray, "parameter")
        for name in mapping(fields.owner, "when"):
            resolver.refer((*fields.path, "when", name), "field", name, names)
        for join in joins:
            resolver.refer_by(join, (*fields.path, "join"), joins, "field", names)


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
        bounded = [*field_names(fields, resolver.groups), *mapping(register, "join")]
        resolver.refer_by("limits_of", path, register, "field or joined number", bounded)
        resolver.refer_by("write_clears", path, register, "register")
        for below, meaning in items(register, "meanings"):
            _check_meaning((*path, *below), meaning, resolver)


def _check_opener(path: Path, opened: Spec, resolver: NameResolver) -> None:
    resolver.refer_by("register", path, opened, "register")
    name = opened.get("register")
    if name in resolver.registers:
        resolver.refer_by("field", path, opened, f"field of {quoted(name)} called", resolver.bits(name))
        values = resolver.values(name, opened.get("field"))
        resolver.refer_by("value", path, opened, f"value of {quoted(name)} called", values)
        if "field" not in opened and opened.get("value") in values and len(resolver.bits(name)) > 1:
            problem = f"{quoted(name)} has several fields; add 'field' with the name of the field"
            resolver.report_problem((*path, "value"), f"{problem} that must hold {quoted(opened['value'])}")


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
    for path, measurement in measurements(spec):
        names = [name for fields in layouts(raw) for name in readable_names(fields, resolver.groups)]
        resolver.refer_by("of", path, measurement, "field or joined number", dict.fromkeys(names))
        name = measurement.get("of", "")
        replies = (fields for fields in layouts(raw) if fields.owner.get("from") == "encoder")
        measured = (fields for fields in replies if path[0] == "measurement" or fields.interface in path)
        fields = (field_names(layout_fields, resolver.groups).get(name) for layout_fields in measured)
        kinds = [_kind_of(field) for field in fields if field is not None]
        if kinds and "digits" not in kinds:
            problem = (
                f"{quoted(name)} has {quoted(kinds[0])}, so it is not a number; name the field that holds the position"
            )
            report.add("measurement-shape", (*path, "of"), problem)
    biss_path = ("interfaces", Biss.name)
    resolver.refer_by("bank_select", biss_path, mapping(spec, *biss_path), "register")


def alarm_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of alarms: the flag in a field group or register, and the procedures that clear them."""
    resolver = NameResolver(raw, report)
    for path, alarm in items(spec, "alarms"):
        resolver.refer_by("group", path, alarm, "field group")
        resolver.refer_by("register", path, alarm, "register")
        if "field" in alarm and "group" not in alarm and "register" not in alarm:
            report.add(
                "undefined-reference", (*path, "field"), "'field' also needs the 'group' or 'register' of the flag"
            )
        owner, owners = ("register", resolver.registers) if "register" in alarm else ("group", resolver.groups)
        if alarm.get(owner) in owners:
            flags = by_name(owners[alarm[owner]], "fields")
            resolver.refer_by("field", path, alarm, f"field of {quoted(alarm[owner])} called", flags)
        resolver.refer_by("cleared_by", path, alarm, "procedure")


def _kind_of(field: Spec) -> str:
    """Return the key for the kind of a field, or ``digits`` for a number."""
    return next((key for key in KINDS if key in field), "digits")


def by_hand_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that manual remedies refer to a characteristic with numbered steps."""
    resolver = NameResolver(raw, report)
    characteristics = by_name(raw, "characteristics").items()
    counted = [name for name, characteristic in characteristics if has_steps(f"{characteristic.get('value')}")]
    states = [((*path, *below), state) for path, led in items(spec, "leds") for below, state in items(led, "states")]
    flags = [field for fields in field_lists(spec) for field in fields]
    for path, owner in (*items(spec, "alarms"), *states, *flags):
        resolver.refer_by("by_hand", path, owner, "characteristic with numbered steps called", counted)


def procedure_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of procedures: their interface, registers, values and data IDs."""
    resolver = NameResolver(raw, report)
    for path, procedure in items(spec, "procedures"):
        resolver.refer_by("interface", path, procedure, "interface")
        for below, argument in items(procedure, "arguments"):
            register_name = argument["of"]
            resolver.refer_by("of", (*path, *below), argument, "register")
            if register_name in resolver.registers:
                meanings = by_name(resolver.registers[register_name], "meanings")
                resolver.refer_by(
                    "as", (*path, *below), argument, f"meaning of {quoted(register_name)} called", meanings
                )
        for below, step in items(procedure, "steps"):
            _check_step((*path, *below), step, procedure, resolver)
            data_ids = by_name(raw, "interfaces", procedure["interface"], "data_ids")
            resolver.refer_by("data_id", (*path, *below), step, "data ID", data_ids)


def _check_step(path: Path, step: Spec, procedure: Spec, resolver: NameResolver) -> None:
    """Check the register of a step, with its field and its value."""
    resolver.refer_by("register", path, step, "register")
    name = step.get("register")
    if name in resolver.registers:
        resolver.refer_by("field", path, step, f"field of {quoted(name)} called", resolver.bits(name))
        arguments = [argument["name"] for _, argument in items(procedure, "arguments")]
        values = [*resolver.values(name, step.get("field")), *arguments]
        resolver.refer_by("value", path, step, f"argument, or value of {quoted(name)}, called", values)
        is_named = "field" not in step and step.get("value") in resolver.values(name, None)
        if is_named and step["value"] not in arguments and has_other_bits(resolver.registers[name], resolver.groups):
            remedy = f"add 'field' with the name of the field that must hold {quoted(step['value'])}"
            if resolver.registers[name].get("access") == "write_only":
                remedy = "describe it as one field with all its bits, because it is write_only"
            resolver.report_problem((*path, "value"), f"{quoted(name)} has other bits, too; {remedy}")


def alternative_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the answers of an alternative set the same parameters, and that these name the alternative."""
    resolver, alternatives = NameResolver(raw, report), by_name(raw, "alternatives")
    for path, alternative in items(spec, "alternatives"):
        _check_answers(path, alternative, resolver, report)
    for name, parameter in mapping(spec, "parameters").items():
        if "alternative" in parameter:
            alternative_name = parameter["alternative"]
            resolver.refer_by("alternative", ("parameters", name), parameter, "alternative", alternatives)
            answers = mapping(alternatives.get(alternative_name, {}), "values")
            setting_answers = [answer for answer in answers if name in mapping(answers, answer, "sets")]
            if alternative_name in alternatives and not setting_answers:
                problem = f"no answer of {quoted(alternative_name)} sets {quoted(name)}"
                report.add("undefined-reference", ("parameters", name, "alternative"), problem)
    for path, example in items(spec, "examples"):
        for name, answer in mapping(example, "alternatives").items():
            answer_path = (*path, "alternatives", name)
            resolver.refer(answer_path, "alternative", name, alternatives)
            if name in alternatives:
                answers = mapping(alternatives[name], "values")
                resolver.refer(answer_path, f"answer of {quoted(name)} called", answer, answers)


def _check_answers(path: Path, alternative: Spec, resolver: NameResolver, report: DocumentReport) -> None:
    """Check that each answer of an alternative sets all its parameters, and no others."""
    answers, owner = alternative["values"], alternative["name"]
    parameters = resolver.parameters
    own_parameters = [name for name in parameters if mapping(parameters, name).get("alternative") == owner]
    first_answer_setting = {name: answer for answer in reversed(answers) for name in answers[answer]["sets"]}
    for answer, sets in ((answer, answers[answer]["sets"]) for answer in answers):
        sets_path = (*path, "values", answer, "sets")
        for name in sets:
            resolver.refer((*sets_path, name), "parameter", name)
            if name in resolver.parameters and name not in own_parameters:
                problem = f"{quoted(name)} is not a parameter of {quoted(owner)}; give it 'alternative: {owner}'"
                report.add("undefined-reference", (*sets_path, name), problem)
        for name in own_parameters:
            if name in first_answer_setting and name not in sets:
                problem = (
                    f"{quoted(answer)} does not set {quoted(name)}, which {quoted(first_answer_setting[name])} sets"
                )
                report.add("undefined-reference", sets_path, problem)


def example_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of examples: their subject, the fields with values, and errata."""
    resolver = NameResolver(raw, report)
    named_layouts = ((layout.owner.get("name"), layout) for layout in layouts(raw))
    known_layouts: dict[Any, Fields] = {name: layout for name, layout in named_layouts if isinstance(name, str)}
    for path, example in items(spec, "examples"):
        for key in ("procedure", "erratum", "register"):
            resolver.refer_by(key, path, example, key)
        resolver.refer_by("crc", path, example, "CRC")
        resolver.refer_by("layout", path, example, "layout", known_layouts)
        name = example.get("procedure", "")
        for argument in mapping(example, "arguments") if name in resolver.procedures else ():
            arguments = by_name(resolver.procedures[name], "arguments")
            resolver.refer((*path, "arguments", argument), f"argument of {quoted(name)} called", argument, arguments)
        owner_fields = known_layouts.get(example.get("layout"))
        if owner_fields is None and example.get("register") in resolver.registers:
            owner_fields = Fields(Has.REGISTER, resolver.registers[example["register"]], (), "")
        if owner_fields is not None:
            names = readable_names(owner_fields, resolver.groups)
            for name in mapping(example, "values"):
                resolver.refer((*path, "values", name), "field", name, names)


#: Lists that paths leave out: a frame belongs to its interface, and a field to its frame.
_LISTS = ("layouts", "fields", "combinations")


def erratum_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each path affected by an erratum exists."""
    resolver, steps_by_node = NameResolver(raw, report), {id(raw): dict(_next_steps(raw))}
    for path, erratum in items(spec, "errata"):
        for index, affected in enumerate(erratum.get("affects", ())):
            steps = affected.split(".")
            short = [*(step for step in steps[:-1] if step not in _LISTS), steps[-1]]
            if len(short) < len(steps):
                problem = f"no output would find {quoted(affected)}; write {'.'.join(short)}"
                report.add("undefined-reference", (*path, "affects", index), problem)
                continue
            node: Any = raw
            for step in steps:
                next_nodes = steps_by_node.get(id(node)) or steps_by_node.setdefault(id(node), dict(_next_steps(node)))
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
            report.add("bad-expression", path, f"{error}{hint or '; write an expression such as singleturn_bits + 8'}")
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
    names = (field.get("crc") for fields in field_lists(raw) for _, field in fields)
    used_crcs = {name for name in names if isinstance(name, str)}
    for path, crc in items(spec, "crcs"):
        if used_crcs <= by_name(raw, "crcs").keys() and crc["name"] not in used_crcs and "note" not in crc:
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
