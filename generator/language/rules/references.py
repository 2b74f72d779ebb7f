"""Rules for references to names, which must exist. Messages suggest the most similar name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...model import Alarm, Biss, Measurement
from ...model.expressions import Expression, ExpressionError
from ...model.steps import has_steps
from ..document import Path
from ..hints import expression_hint, number_hint, product_hint
from ..problems import DocumentReport, quoted
from ..written import LocatedPart
from ..written_codes import WrittenOpenedBy, WrittenRegister, WrittenRegisterMeaning
from ..written_interfaces import WrittenRs485
from ..written_layouts import KIND_KEYS, WrittenField
from ..written_parts import WrittenExample, WrittenProcedure, WrittenSpec, WrittenStep
from . import parameters
from .name_resolver import NameResolver
from .parts import (
    FieldList,
    FieldOwner,
    by_name,
    by_part_name,
    field_lists,
    field_names,
    has_other_bits,
    layouts_of_interfaces,
    measurements,
    readable_names,
)
from .walk import next_steps

#: Kind of a field that is a number.
_NUMBER_KIND = "digits"


def check_field_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check the references of fields and layouts: groups, CRCs, sibling fields, joined numbers, parameters, data IDs.

    A group may use data IDs, because its interface is not known.
    """
    resolver = NameResolver(spec, report)
    for field_list in field_lists(spec):
        names = list(field_names(field_list, resolver.groups))
        has_data_ids = field_list.kind is FieldOwner.GROUP or bool(_data_ids(spec, field_list.interface))
        for field in field_list.fields:
            _check_field(field, names, list(field_list.joins), resolver)
            if field.values_of and not has_data_ids:
                problem = f"the interface {quoted(field_list.interface)} has no table of data IDs"
                message = f"{problem}; list the values with 'values'"
                report.add("undefined-reference", field.place_of("values_of"), message)
        _check_layout(field_list, names, resolver)


def _data_ids(spec: WrittenSpec, interface: str) -> object:
    """Return the table of data IDs of an interface as the file has it, even if it is invalid. None without a table."""
    return WrittenRs485(spec.with_invalid_parts.interfaces.data.get(interface)).data.get("data_ids")


def _check_layout(field_list: FieldList, names: Sequence[str], resolver: NameResolver) -> None:
    """Check that the fields exist that a layout or register sends in Gray code, joins to numbers, or is identified by.

    ``names`` are its fields, including fields of groups.
    """
    layout = field_list.layout
    path = field_list.owner.path
    gray = layout.gray if layout is not None else None
    if gray is not None:
        number_names = [*names, *field_list.joins]
        resolver.refer_if_given(gray.place_of("of"), "field or joined number", gray.of, number_names)
        resolver.refer_if_given(gray.place_of("when"), "parameter", gray.when)
    for name in field_list.selectors:
        resolver.refer((*path, "when", name), "field", name, names)
    for join, joined_names in field_list.joins.items():
        resolver.refer_to_each((*path, "join", join), "field", joined_names, names)


def _check_field(field: WrittenField, names: Sequence[str], joins: Sequence[str], resolver: NameResolver) -> None:
    """Check that the group, CRC, covered fields and explaining bits that a field names exist.

    ``names`` are the fields of its layout, and ``joins`` the numbers that are joined from them.
    """
    resolver.refer_if_given(field.place_of("use"), "field group", field.use)
    resolver.refer_if_given(field.place_of("crc"), "CRC", field.crc)
    other_fields = [name for name in names if name != field.name]
    parity_path = field.place_of("parity_of")
    # A single name may be written without a list. In this case, its path has no index.
    is_single_name = isinstance(field.data.get("parity_of"), str)
    for index, name in enumerate(field.parity_of):
        name_path = parity_path if is_single_name else (*parity_path, index)
        resolver.refer(name_path, "other field", name, [*other_fields, *joins])
    resolver.refer_to_each(field.place_of("crc_of"), "other field", field.crc_of, other_fields)
    for index, bit in enumerate(field.explained_by):
        resolver.refer_to_bit((*field.path, "explained_by", index), bit)


def check_register_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that everything that registers name exists.

    This includes their interface, the register that unlocks them, and the field to which their limits apply.
    """
    resolver = NameResolver(spec, report)
    for register in spec.registers:
        resolver.refer_if_given(register.place_of("interface"), "interface", register.interface)
        if register.interface is None and Biss.name not in spec.with_invalid_parts.interfaces.data:
            message = f"registers belong to {Biss.name} by default, but this device has no {Biss.name}; add 'interface'"
            report.add("undefined-reference", register.path, message)
        if register.opened_by is not None:
            _check_opener(register.opened_by, resolver)
        field_list = FieldList(FieldOwner.REGISTER, register, "")
        number_names = [*field_names(field_list, resolver.groups), *register.join]
        limits_path = register.place_of("limits_of")
        resolver.refer_if_given(limits_path, "field or joined number", register.limits_of, number_names)
        resolver.refer_to_each(register.place_of("write_clears"), "register", register.write_clears)
        for meaning in register.meanings:
            _check_meaning(meaning, resolver)


def _check_opener(opener: WrittenOpenedBy, resolver: NameResolver) -> None:
    """Check that the register, its field and its value that unlock another register for writing exist."""
    name = opener.register
    resolver.refer_if_given(opener.place_of("register"), "register", name)
    if name not in resolver.registers:
        return
    known_fields = resolver.bits(name)
    resolver.refer_if_given(opener.place_of("field"), f"field of {quoted(name)} called", opener.field, known_fields)
    if opener.field not in ("", *known_fields):
        return
    known_values = resolver.values(name, opener.field)
    resolver.refer_if_given(opener.place_of("value"), f"value of {quoted(name)} called", opener.value, known_values)
    if not opener.field and opener.value in known_values and len(known_fields) > 1:
        problem = f"{quoted(name)} has several fields; add 'field' with the name of the field"
        resolver.report_problem(opener.place_of("value"), f"{problem} that must hold {quoted(opener.value)}")


def _check_meaning(meaning: WrittenRegisterMeaning, resolver: NameResolver) -> None:
    """Check that the field that selects a meaning of a register exists, and that it has the named value.

    The field is written as ``register.field``.
    """
    resolver.refer_to_bit(meaning.place_of("when"), meaning.when)
    name, _, field = meaning.when.partition(".")
    if name in resolver.registers and field in resolver.bits(name):
        kind = f"value of {quoted(meaning.when)} called"
        resolver.refer_if_given(meaning.place_of("is"), kind, meaning.is_, resolver.values(name, field))


def check_device_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the registers, fields and interfaces named by parameters, inputs, measurements and BiSS exist.

    A measurement names the field or joined number that holds the position, which must occur in some frame. BiSS names
    the register that selects banks.
    """
    resolver = NameResolver(spec, report)
    for parameter in spec.parameters.values():
        if parameter.read_from:
            resolver.refer_to_bit(parameter.place_of("read_from"), parameter.read_from)
        resolver.refer_if_given(parameter.place_of("interface"), "interface", parameter.interface)
    for hardware_input in spec.inputs:
        for key, text in (("inverts", hardware_input.part.inverts), ("needs", hardware_input.part.needs)):
            if text:
                resolver.refer_to_bit((*hardware_input.path, key), text)
    readable_values: dict[str, None] = {}
    for frame in layouts_of_interfaces(spec.with_invalid_parts):
        readable_values |= dict.fromkeys(readable_names(frame, resolver.groups))
    for measurement in measurements(spec):
        if measurement.has("of"):
            resolver.refer((*measurement.path, "of"), "field or joined number", measurement.part.of, readable_values)
            _check_measured_field(measurement, spec, resolver, report)
    biss = spec.interfaces.biss
    if biss is not None:
        resolver.refer_if_given(biss.place_of("bank_select"), "register", biss.bank_select)


def _check_measured_field(
    measurement: LocatedPart[Measurement], spec: WrittenSpec, resolver: NameResolver, report: DocumentReport
) -> None:
    """Check that the field that holds the position is a number in at least one frame that the encoder sends.

    For the measurement of an interface, only the frames of this interface count.
    """
    name = measurement.part.of
    path = measurement.path
    is_of_device = path == ("measurement",)
    kind_keys = []
    for frame in layouts_of_interfaces(spec.with_invalid_parts):
        # The path of a measurement of an interface contains the name of the interface.
        is_measured = is_of_device or frame.interface in path
        field = field_names(frame, resolver.groups).get(name)
        if is_measured and frame.is_from_encoder and field is not None:
            kind_keys.append(_kind_key(field))
    if kind_keys and _NUMBER_KIND not in kind_keys:
        problem = f"{quoted(name)} has {quoted(kind_keys[0])}, so it is not a number"
        message = f"{problem}; name the field that holds the position"
        report.add("measurement-shape", (*path, "of"), message)


def _kind_key(field: WrittenField) -> str:
    """Return the first key that makes a field something other than a number, such as ``crc``.

    Without such a key, the result is ``digits``, which stands for a number.
    """
    kind_keys = [key for key in KIND_KEYS if field.has(key)]
    return kind_keys[0] if kind_keys else _NUMBER_KIND


def check_alarm_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the flag of an alarm exists in its group or register, and that the procedures that clear it exist."""
    resolver = NameResolver(spec, report)
    for located_alarm in spec.alarms:
        alarm = located_alarm.part
        path = located_alarm.path
        resolver.refer_if_given((*path, "group"), "field group", alarm.group)
        resolver.refer_if_given((*path, "register"), "register", alarm.register)
        if alarm.field and not alarm.group and not alarm.register:
            message = "'field' also needs the 'group' or 'register' of the flag"
            report.add("undefined-reference", (*path, "field"), message)
        _check_flag(alarm, (*path, "field"), resolver)
        resolver.refer_to_each((*path, "cleared_by"), "procedure", alarm.cleared_by)


def _check_flag(alarm: Alarm, path: Path, resolver: NameResolver) -> None:
    """Check that the register or group that an alarm names contains the flag of the alarm."""
    owner_name = alarm.register or alarm.group
    owner = resolver.registers.get(owner_name) if alarm.register else resolver.groups.get(owner_name)
    if owner is not None:
        resolver.refer_if_given(path, f"field of {quoted(owner_name)} called", alarm.field, by_name(owner.fields))


def check_by_hand_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``by_hand`` names characteristics whose text has numbered steps, for a person to carry out."""
    resolver = NameResolver(spec, report)
    characteristics = by_part_name(spec.with_invalid_parts.characteristics).items()
    names_with_steps = [name for name, characteristic in characteristics if has_steps(characteristic.part.value)]
    for path, names in _remedies_by_hand(spec):
        resolver.refer_to_each((*path, "by_hand"), "characteristic with numbered steps called", names, names_with_steps)


def _remedies_by_hand(spec: WrittenSpec) -> Iterator[tuple[Path, Sequence[str]]]:
    """Yield the path of each alarm, LED state and field, with the characteristics that its ``by_hand`` names."""
    for alarm in spec.alarms:
        yield alarm.path, alarm.part.by_hand
    for led in spec.leds:
        for index, state in enumerate(led.part.states):
            yield (*led.path, "states", index), state.by_hand
    for field_list in field_lists(spec):
        for field in field_list.fields:
            yield field.path, field.by_hand


def check_procedure_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interfaces, registers, values and data IDs that procedures name exist."""
    resolver = NameResolver(spec, report)
    for procedure in spec.procedures:
        resolver.refer_if_given(procedure.place_of("interface"), "interface", procedure.interface)
        for argument in procedure.arguments:
            resolver.refer_if_given(argument.place_of("of"), "register", argument.of)
            register = resolver.registers.get(argument.of)
            if register is not None:
                kind = f"meaning of {quoted(argument.of)} called"
                resolver.refer_if_given(argument.place_of("as"), kind, argument.as_, by_name(register.meanings))
        interface = WrittenRs485(spec.with_invalid_parts.interfaces.data.get(procedure.interface))
        data_ids = by_part_name(interface.data_ids)
        for step in procedure.steps:
            _check_step(step, procedure, resolver)
            resolver.refer_if_given(step.place_of("data_id"), "data ID", step.data_id, data_ids)


def _check_step(step: WrittenStep, procedure: WrittenProcedure, resolver: NameResolver) -> None:
    """Check that the register, the field and the value that a step of a procedure names exist."""
    name = step.register
    resolver.refer_if_given(step.place_of("register"), "register", name)
    register = resolver.registers.get(name)
    if register is None:
        return
    names_of_fields = resolver.bits(name)
    resolver.refer_if_given(step.place_of("field"), f"field of {quoted(name)} called", step.field, names_of_fields)
    if step.field in ("", *names_of_fields):
        _check_written_value(step, register, [argument.name for argument in procedure.arguments], resolver)


def _check_written_value(
    step: WrittenStep, register: WrittenRegister, arguments: Sequence[str], resolver: NameResolver
) -> None:
    """Check that a step writes an argument of its procedure or a named value, without changing other bits.

    A step without a field writes the whole register. If it writes the named value of one of several fields, this is
    reported, because it would change the other fields.
    """
    name = step.register
    path = step.place_of("value")
    possible_values = [*resolver.values(name, step.field), *arguments]
    resolver.refer_if_given(path, f"argument, or value of {quoted(name)}, called", step.value, possible_values)
    is_value_of_field = step.value in resolver.values(name) and step.value not in arguments
    if not step.field and is_value_of_field and has_other_bits(register, resolver.groups):
        remedy = f"add 'field' with the name of the field that must hold {quoted(step.value)}"
        if register.access == "write_only":
            remedy = "describe it as one field with all its bits, because it is write_only"
        resolver.report_problem(path, f"{quoted(name)} has other bits, too; {remedy}")


def check_example_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that everything that examples name exists, such as procedures, layouts, fields and errata."""
    resolver = NameResolver(spec, report)
    known_layouts = {frame.name: frame for frame in layouts_of_interfaces(spec.with_invalid_parts) if frame.name}
    for example in spec.examples:
        resolver.refer_if_given(example.place_of("procedure"), "procedure", example.procedure)
        resolver.refer_if_given(example.place_of("erratum"), "erratum", example.erratum)
        resolver.refer_if_given(example.place_of("register"), "register", example.register)
        resolver.refer_if_given(example.place_of("crc"), "CRC", example.crc)
        resolver.refer_if_given(example.place_of("layout"), "layout", example.layout, known_layouts)
        procedure = resolver.procedures.get(example.procedure)
        if procedure is not None:
            kind = f"argument of {quoted(example.procedure)} called"
            for name in example.arguments:
                resolver.refer((*example.path, "arguments", name), kind, name, by_name(procedure.arguments))
        _check_example_values(example, known_layouts, resolver)


def _check_example_values(
    example: WrittenExample, known_layouts: Mapping[str, FieldList], resolver: NameResolver
) -> None:
    """Check that the layout or register of an example has the fields whose values the example gives."""
    field_list = known_layouts.get(example.layout)
    if field_list is None and example.register in resolver.registers:
        field_list = FieldList(FieldOwner.REGISTER, resolver.registers[example.register], "")
    if field_list is not None:
        names = readable_names(field_list, resolver.groups)
        for name in example.values:
            resolver.refer((*example.path, "values", name), "field", name, names)


#: Lists that paths leave out: a frame belongs to its interface, and a field to its frame.
_LISTS_LEFT_OUT_OF_PATHS = ("layouts", "fields", "combinations")


def check_erratum_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each path in ``affects`` of an erratum exists, and that it omits the names of certain lists.

    These are the lists of layouts, fields and combinations: the field ``crc`` of the layout ``word`` has the path
    ``interfaces.biss.word.crc``. The first step that does not exist is reported.
    """
    resolver = NameResolver(spec, report)
    # The possible next steps of each map or list by its id, because many errata affect the same places.
    next_nodes_by_id: dict[int, dict[str, object]] = {}
    for erratum in spec.errata:
        for index, affected in enumerate(erratum.affects):
            steps = affected.split(".")
            steps_without_lists = [*(step for step in steps[:-1] if step not in _LISTS_LEFT_OUT_OF_PATHS), steps[-1]]
            if len(steps_without_lists) < len(steps):
                problem = f"no output would find {quoted(affected)}; write {'.'.join(steps_without_lists)}"
                report.add("undefined-reference", (*erratum.path, "affects", index), problem)
                continue
            node: object = spec.with_invalid_parts.data
            for step in steps:
                if id(node) not in next_nodes_by_id:
                    next_nodes_by_id[id(node)] = dict(next_steps(node))
                next_nodes = next_nodes_by_id[id(node)]
                if step not in next_nodes:
                    kind = f"place {quoted(affected)} in this spec: there is no"
                    resolver.refer((*erratum.path, "affects", index), kind, step, next_nodes)
                    break
                node = next_nodes[step]


def check_expressions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every expression is valid, and that every parameter in it exists."""
    resolver = NameResolver(spec, report)
    for path, text in parameters.expressions(spec):
        try:
            names = Expression.parse(text).parameters
        except ExpressionError as error:
            hint = expression_hint(str(text)) or number_hint(str(path[-1]), text) or product_hint(str(text))
            if not hint:
                hint = "; write an expression such as singleturn_bits + 8"
            report.add("bad-expression", path, f"{error}{hint}")
            continue
        for name in names:
            resolver.refer(path, "parameter", name)


def check_printed_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the registers, fields and errata exist that ``printed_defaults``, the manual's own list, names."""
    resolver = NameResolver(spec, report)
    for printed in spec.printed_defaults:
        resolver.refer_if_given(printed.place_of("register"), "register", printed.register)
        if printed.register in resolver.registers:
            kind = f"field of {quoted(printed.register)} called"
            known_fields = resolver.bits(printed.register)
            resolver.refer_if_given(printed.place_of("field"), kind, printed.field, known_fields)
        resolver.refer_if_given(printed.place_of("erratum"), "erratum", printed.erratum)


def check_connector_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interfaces that a connector is wired for exist."""
    resolver = NameResolver(spec, report)
    for connector in spec.connectors:
        resolver.refer_to_each((*connector.path, "interfaces"), "interface", connector.part.interfaces)


def check_unused_crc(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each CRC is used by a field of some layout, register or group, or has a note about its use."""
    used_crcs: set[str] = set()
    for field_list in field_lists(spec.with_invalid_parts):
        used_crcs |= {field.crc for field in field_list.fields if field.crc}
    if not used_crcs <= by_part_name(spec.with_invalid_parts.crcs).keys():
        return  # A misspelt name, which another rule reports, may be meant as the unused CRC.
    for crc in spec.crcs:
        name = crc.part.name
        if name not in used_crcs and not crc.part.note:
            problem = f"no frame uses the CRC {quoted(name)}"
            field = f"{{name: crc, crc: {name}}}"
            remedy = f"add the field {field} at the end of its frame, or explain in a 'note' what the CRC is for"
            report.add("unused-crc", (*crc.path, "name"), f"{problem}; {remedy}")


def check_evidence_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the documents, implementations and examples that the evidence names exist.

    The manual is a document too, with the name ``manual`` and the language code of each edition.
    """
    resolver = NameResolver(spec, report)
    evidence = spec.evidence
    documents = spec.with_invalid_parts.names_in("documents")
    languages = [edition.part.language for edition in spec.with_invalid_parts.manual.editions]
    for key in evidence.part.documents:
        resolver.refer((*evidence.path, "documents", key), "document", key, ("manual", *languages, *documents))
    implementations_path = (*evidence.path, "implementations")
    resolver.refer_to_each(implementations_path, "document", evidence.part.implementations, documents)
    resolver.refer_to_each(
        (*evidence.path, "vectors"), "example", evidence.part.vectors, by_name(spec.with_invalid_parts.examples)
    )
