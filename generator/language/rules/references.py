"""The names that a spec defines, and rules for references to names, which must exist.

Messages suggest the most similar name.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence

from ...model import INTERFACES, Alarm, Biss, Measurement
from ...model.registers import has_steps
from ..document import Path
from ..keys_of_fields import (
    KIND_KEYS,
    WrittenField,
    WrittenFieldGroup,
    WrittenOpenedBy,
    WrittenRegister,
    WrittenRegisterMeaning,
)
from ..keys_of_order_codes import WrittenRs485
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, nearest_choice, quoted, suggest_word
from ..schema_check import remaining_value_at
from ..written import LocatedPart
from .parts import (
    FieldList,
    FieldOwner,
    bit_names,
    by_name,
    by_part_name,
    field_lists,
    fields_by_name,
    layouts_of_interfaces,
    measurements,
    readable_names,
    value_names_of_register,
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
        names = list(fields_by_name(field_list, resolver.groups))
        is_group = field_list.owner_kind is FieldOwner.GROUP
        may_use_data_ids = is_group or bool(_table_of_data_ids(spec, field_list.interface))
        for field in field_list.fields:
            _check_references_of_field(field, names, list(field_list.joins), resolver)
            if field.values_of and not may_use_data_ids:
                problem = f"the interface {quoted(field_list.interface)} has no table of data IDs"
                message = f"{problem}; list the values with 'values'"
                report.add("undefined-reference", field.path_of("values_of"), message)
        _check_references_of_layout(field_list, names, resolver)


def _table_of_data_ids(spec: WrittenSpec, interface_name: str) -> object:
    """Return the table of data IDs of an interface as the file has it, even if it is invalid. None without a table."""
    interface_data = spec.with_invalid_parts.interfaces.data.get(interface_name)
    return WrittenRs485(interface_data).data.get("data_ids")


def _check_references_of_layout(field_list: FieldList, known_fields: Sequence[str], resolver: NameResolver) -> None:
    """Check that the fields exist that a layout or register sends in Gray code, joins to numbers, or is identified by.

    ``known_fields`` are the names of its fields, including fields of groups.
    """
    layout = field_list.layout
    path = field_list.owner.path
    gray = layout.gray if layout is not None else None
    if gray is not None:
        known_numbers = [*known_fields, *field_list.joins]
        resolver.check_optional_name(gray.path_of("of"), "field or joined number", gray.of, known_names=known_numbers)
        resolver.check_optional_name(gray.path_of("when"), "parameter", gray.when)
    for name in field_list.selectors:
        resolver.check_name((*path, "when", name), "field", name, known_names=known_fields)
    for joined_number, names_of_parts in field_list.joins.items():
        resolver.check_each_name((*path, "join", joined_number), "field", names_of_parts, known_names=known_fields)


def _check_references_of_field(
    field: WrittenField, names_in_layout: Sequence[str], joined_numbers: Sequence[str], resolver: NameResolver
) -> None:
    """Check that the group, CRC, covered fields and explaining bits that a field names exist.

    ``names_in_layout`` are the names of the fields of its layout. Several fields can be joined to one of the
    ``joined_numbers``, which also have names.
    """
    resolver.check_optional_name(field.path_of("use"), "field group", field.use)
    resolver.check_optional_name(field.path_of("crc"), "CRC", field.crc)
    other_fields = [name for name in names_in_layout if name != field.name]
    fields_and_joins = [*other_fields, *joined_numbers]
    parity_path = field.path_of("parity_of")
    # A single name may be written without a list. In this case, its path has no index.
    is_single_name = isinstance(field.data.get("parity_of"), str)
    for index, name in enumerate(field.parity_of):
        name_path = parity_path if is_single_name else (*parity_path, index)
        resolver.check_name(name_path, "other field", name, known_names=fields_and_joins)
    resolver.check_each_name(field.path_of("crc_of"), "other field", field.crc_of, known_names=other_fields)
    for index, bit_path in enumerate(field.explained_by):
        resolver.check_bit_path((*field.path, "explained_by", index), bit_path)


def check_register_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that everything that registers name exists.

    This includes their interface, the register that unlocks them, and the field to which their limits apply.
    """
    resolver = NameResolver(spec, report)
    for register in spec.registers:
        resolver.check_optional_name(register.path_of("interface"), "interface", register.interface)
        if register.interface is None and Biss.name not in spec.with_invalid_parts.interfaces.data:
            message = f"registers belong to {Biss.name} by default, but this device has no {Biss.name}; add 'interface'"
            report.add("undefined-reference", register.path, message)
        if register.opened_by is not None:
            _check_unlocking_register(register.opened_by, resolver)
        field_list = FieldList(FieldOwner.REGISTER, register, interface="")
        known_numbers = [*fields_by_name(field_list, resolver.groups), *register.join]
        limits_path = register.path_of("limits_of")
        noun = "field or joined number"
        resolver.check_optional_name(limits_path, noun, register.limits_of, known_names=known_numbers)
        resolver.check_each_name(register.path_of("write_clears"), "register", register.write_clears)
        for meaning in register.meanings:
            _check_selector_of_meaning(meaning, resolver)


def _check_unlocking_register(opener: WrittenOpenedBy, resolver: NameResolver) -> None:
    """Check that the register, its field and its value that unlock another register for writing exist.

    If the register has several fields, the spec must say which of them needs the value.
    """
    register_name = opener.register
    resolver.check_optional_name(opener.path_of("register"), "register", register_name)
    if register_name not in resolver.registers:
        return
    known_fields = resolver.bit_names(register_name)
    noun = f"field of {quoted(register_name)} called"
    resolver.check_optional_name(opener.path_of("field"), noun, opener.field, known_names=known_fields)
    is_field_known = opener.field in known_fields
    if opener.field and not is_field_known:
        return
    known_values = resolver.value_names(register_name, opener.field)
    value_path = opener.path_of("value")
    resolver.check_optional_name(
        value_path, f"value of {quoted(register_name)} called", opener.value, known_names=known_values
    )
    is_ambiguous = not opener.field and len(known_fields) > 1
    if is_ambiguous and opener.value in known_values:
        problem = f"{quoted(register_name)} has several fields; add 'field' with the name of the field"
        resolver.report_problem(value_path, f"{problem} that must hold {quoted(opener.value)}")


def _check_selector_of_meaning(meaning: WrittenRegisterMeaning, resolver: NameResolver) -> None:
    """Check that the field that selects a meaning of a register exists, and that it has the named value.

    The field is written as ``register.field``.
    """
    resolver.check_bit_path(meaning.path_of("when"), meaning.when)
    register_name, _, field_name = meaning.when.partition(".")
    if register_name in resolver.registers and field_name in resolver.bit_names(register_name):
        noun = f"value of {quoted(meaning.when)} called"
        known_values = resolver.value_names(register_name, field_name)
        resolver.check_optional_name(meaning.path_of("is"), noun, meaning.is_, known_names=known_values)


def check_device_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the registers, fields and interfaces named by parameters, inputs, measurements and BiSS exist.

    A measurement names the field or joined number that holds the position, which must occur in some frame. BiSS names
    the register that selects banks.
    """
    resolver = NameResolver(spec, report)
    for parameter in spec.parameters.values():
        if parameter.read_from:
            resolver.check_bit_path(parameter.path_of("read_from"), parameter.read_from)
        resolver.check_optional_name(parameter.path_of("interface"), "interface", parameter.interface)
    for hardware_input in spec.inputs:
        inverted_bit = hardware_input.part.inverts
        needed_bit = hardware_input.part.needs
        for key, bit_path in (("inverts", inverted_bit), ("needs", needed_bit)):
            if bit_path:
                resolver.check_bit_path((*hardware_input.path, key), bit_path)
    readable_values: dict[str, None] = {}
    for frame in layouts_of_interfaces(spec.with_invalid_parts):
        readable_values |= dict.fromkeys(readable_names(frame, resolver.groups))
    for measurement in measurements(spec):
        if measurement.has("of"):
            measured_name = measurement.part.of
            path = (*measurement.path, "of")
            resolver.check_name(path, "field or joined number", measured_name, known_names=readable_values)
            _check_measured_field(measurement, spec, resolver, report)
    biss = spec.interfaces.biss
    if biss is not None:
        resolver.check_optional_name(biss.path_of("bank_select"), "register", biss.bank_select)


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
        field = fields_by_name(frame, resolver.groups).get(name)
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
        resolver.check_optional_name((*path, "group"), "field group", alarm.group)
        resolver.check_optional_name((*path, "register"), "register", alarm.register)
        if alarm.field and not alarm.group and not alarm.register:
            message = "'field' also needs the 'group' or 'register' of the flag"
            report.add("undefined-reference", (*path, "field"), message)
        _check_flag_of_alarm(alarm, (*path, "field"), resolver)
        resolver.check_each_name((*path, "cleared_by"), "procedure", alarm.cleared_by)


def _check_flag_of_alarm(alarm: Alarm, path: Path, resolver: NameResolver) -> None:
    """Check that the register or group that an alarm names contains the flag of the alarm."""
    owner: WrittenRegister | WrittenFieldGroup | None
    if alarm.register:
        owner = resolver.registers.get(alarm.register)
    else:
        owner = resolver.groups.get(alarm.group)
    if owner is not None:
        noun = f"field of {quoted(owner.name)} called"
        resolver.check_optional_name(path, noun, alarm.field, known_names=by_name(owner.fields))


def check_by_hand_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``by_hand`` names characteristics whose text has numbered steps, for a person to carry out."""
    resolver = NameResolver(spec, report)
    characteristics = by_part_name(spec.with_invalid_parts.characteristics).items()
    instructions = [name for name, characteristic in characteristics if has_steps(characteristic.part.value)]
    noun = "characteristic with numbered steps called"
    for path, names in _remedies_by_hand(spec):
        resolver.check_each_name((*path, "by_hand"), noun, names, known_names=instructions)


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


#: Lists that paths leave out: a frame belongs to its interface, and a field to its frame.
_LISTS_LEFT_OUT_OF_PATHS = ("layouts", "fields", "combinations")


def check_erratum_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each path in ``affects`` of an erratum exists, and that it omits the names of certain lists.

    These are the lists of layouts, fields and combinations: the field ``crc`` of the layout ``word`` has the path
    ``interfaces.biss.word.crc``. The first step that does not exist is reported.
    """
    resolver = NameResolver(spec, report)
    # The possible next steps of each map or list by its id, because many errata affect the same places.
    node_by_step_by_id: dict[int, dict[str, object]] = {}
    for erratum in spec.errata:
        for index, affected_place in enumerate(erratum.affects):
            path = (*erratum.path, "affects", index)
            *outer_steps, last_step = affected_place.split(".")
            kept_steps = [step for step in outer_steps if step not in _LISTS_LEFT_OUT_OF_PATHS]
            if kept_steps != outer_steps:
                short_place = ".".join((*kept_steps, last_step))
                problem = f"no output would find {quoted(affected_place)}; write {short_place}"
                report.add("undefined-reference", path, problem)
                continue
            node: object = spec.with_invalid_parts.data  # The map or list that the steps so far lead to.
            for step in (*outer_steps, last_step):
                if id(node) not in node_by_step_by_id:
                    node_by_step_by_id[id(node)] = dict(next_steps(node))
                node_by_step = node_by_step_by_id[id(node)]
                if step not in node_by_step:
                    noun = f"place {quoted(affected_place)} in this spec: there is no"
                    resolver.check_name(path, noun, step, known_names=node_by_step)
                    break
                node = node_by_step[step]


def check_printed_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the registers, fields and errata exist that ``printed_defaults``, the manual's own list, names."""
    resolver = NameResolver(spec, report)
    for printed in spec.printed_defaults:
        resolver.check_optional_name(printed.path_of("register"), "register", printed.register)
        if printed.register in resolver.registers:
            noun = f"field of {quoted(printed.register)} called"
            known_fields = resolver.bit_names(printed.register)
            resolver.check_optional_name(printed.path_of("field"), noun, printed.field, known_names=known_fields)
        resolver.check_optional_name(printed.path_of("erratum"), "erratum", printed.erratum)


def check_unused_crc(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each CRC is used by a field of some layout, register or group, or has a note about its use."""
    used_crcs: set[str] = set()
    for field_list in field_lists(spec.with_invalid_parts):
        used_crcs |= {field.crc for field in field_list.fields if field.crc}
    defined_crcs = by_part_name(spec.with_invalid_parts.crcs).keys()
    if not used_crcs <= defined_crcs:
        return  # A misspelt name, which another rule reports, may be meant as the unused CRC.
    for crc in spec.crcs:
        name = crc.part.name
        if name not in used_crcs and not crc.part.note:
            problem = f"no frame uses the CRC {quoted(name)}"
            missing_field = f"{{name: crc, crc: {name}}}"
            remedy = (
                f"add the field {missing_field} at the end of its frame, or explain in a 'note' what the CRC is for"
            )
            report.add("unused-crc", (*crc.path, "name"), f"{problem}; {remedy}")


_NAME_PATTERN = re.compile("[a-z][a-z0-9]*(_[a-z0-9]+)*")


class NameResolver:
    """The names that a spec defines, by kind, and the report of references to undefined names.

    A name counts as defined even if its part is otherwise invalid. ``groups``, ``registers`` and ``procedures`` contain
    the parts by name.
    """

    def __init__(self, spec: WrittenSpec, report: DocumentReport) -> None:
        self._report = report
        whole_spec = spec.with_invalid_parts
        interfaces = list(whole_spec.interfaces.data)
        self.parameter_names = whole_spec.names_in("parameters")
        # Names that are themselves misspelt: unknown interfaces, and names that the schema check rejected.
        self._misspelt_names = {name for name in interfaces if name not in INTERFACES}
        for path in report.faults():
            # A part in a list has its name under 'name', one in a map is a key itself.
            last_step = path[-1]
            name = remaining_value_at(whole_spec.data, path) if last_step == "name" else last_step
            if isinstance(name, str) and not _NAME_PATTERN.fullmatch(name):
                self._misspelt_names.add(name)
        self.groups = by_name(whole_spec.field_groups)
        self.registers = by_name(whole_spec.registers)
        self.procedures = by_name(whole_spec.procedures)
        self._names_by_noun: Mapping[str, Collection[str]] = {
            "CRC": by_part_name(whole_spec.crcs),
            "erratum": by_name(whole_spec.errata),
            "field group": self.groups,
            "interface": interfaces,
            "parameter": self.parameter_names,
            "procedure": self.procedures,
            "register": self.registers,
        }

    def check_name(self, path: Path, noun: str, name: str, *, known_names: Collection[str] | None = None) -> None:
        """Report the name at ``path`` if it does not exist: if it is not among ``known_names``.

        By default, these are all names of its kind in the spec. ``noun`` is its kind in the message, such as
        ``register``, or ``field of 'preset' called`` with ``known_names``. If one of the known names is itself
        misspelt, which is reported already, ``name`` may be the correct spelling. Then the place is only marked as
        faulty, unless another known name is similar.
        """
        accepted_names = self._names_by_noun[noun] if known_names is None else known_names
        if name in accepted_names:
            return
        has_misspelt_name = not self._misspelt_names.isdisjoint(accepted_names)
        well_spelt_names = [
            accepted_name for accepted_name in accepted_names if accepted_name not in self._misspelt_names
        ]
        if has_misspelt_name and not nearest_choice(name, well_spelt_names):
            self._report.mark(path)
            return
        problem = f"there is no {noun} {quoted(name)}{suggest_word(name, accepted_names)}"
        self._report.add("undefined-reference", path, problem, cause=name)

    def report_problem(self, path: Path, problem: str) -> None:
        """Report a problem with the name at ``path``, which exists."""
        self._report.add("undefined-reference", path, problem)

    def check_optional_name(
        self, path: Path, noun: str, name: str | None, *, known_names: Collection[str] | None = None
    ) -> None:
        """Report the name at ``path`` if it does not exist. A missing name, which is None or empty, is accepted."""
        if name:
            self.check_name(path, noun, name, known_names=known_names)

    def check_each_name(
        self, path: Path, noun: str, names: Sequence[str], *, known_names: Collection[str] | None = None
    ) -> None:
        """Report each name in the list at ``path`` that does not exist."""
        for index, name in enumerate(names):
            self.check_name((*path, index), noun, name, known_names=known_names)

    def check_bit_path(self, path: Path, bit_path: str) -> None:
        """Report ``bit_path``, written as ``register.field``, unless both exist."""
        register_name, _, field_name = bit_path.partition(".")
        self.check_name(path, "register", register_name)
        if register_name in self.registers:
            noun = f"field of {quoted(register_name)} called"
            self.check_name(path, noun, field_name, known_names=self.bit_names(register_name))

    def bit_names(self, register_name: str) -> list[str]:
        """Return the names allowed after the dot in ``register.field``: the fields of a register, or its own name."""
        return bit_names(self.registers[register_name], self.groups)

    def value_names(self, register_name: str, field_name: str = "") -> list[str]:
        """Return the names of values of a register, or of one of its fields."""
        return value_names_of_register(self.registers[register_name], self.groups, field_name)
