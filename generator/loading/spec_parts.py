"""Parts of a spec: sources, tables, alarms and procedures of the model, ``only`` patterns, and which parts are valid.

An example of a register with a misspelled field is wrong, but reporting it adds nothing. The example is checked once
the register is fixed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from ..language.keys_of_order_codes import WrittenRs485
from ..language.keys_of_specs import WrittenProcedure, WrittenSpec
from ..language.problems import DocumentReport, Path, quoted
from ..language.rules.parts import field_lists, interfaces, owner_of_alarm
from ..model import (
    Argument,
    CrcExample,
    Device,
    Example,
    FrameExample,
    Manufacturer,
    MeasureExample,
    ModifyStep,
    PollStep,
    Procedure,
    ProcedureExample,
    ReadStep,
    RegisterExample,
    Rs485,
    SendStep,
    Source,
    Sources,
    Step,
    Supply,
    Table,
    Variant,
    WaitStep,
    WriteStep,
    assert_never,
)
from ..model.order_codes import applies_to_code
from ..model.record import dataclass

Raw = Mapping[str, Any]
T = TypeVar("T")

#: A citation: ``6.4 p.35``, with the groups "6.4" and "35", or ``it: 6.4 p.36``, whose document is "it".
_SOURCE_PATTERN = re.compile(
    r"\s*(?:(?P<document>[a-z][a-z0-9_]*):\s*)?(?P<section>.*?)(?:\s*\bp\.(?P<page>[0-9]+))?\s*$"
)
#: Empty values by type. For any other type, the empty value is None.
_EMPTY_VALUES: Mapping[Any, Any] = MappingProxyType(
    {str: "", int: 0, bool: False, tuple: (), Mapping: MappingProxyType({})}
)


def parse_sources(cited_text: str) -> Sources:
    """Return the citations in a text such as ``6.4 p.35; it: 6.4 p.36``.

    Each citation has a section and a page. The key of a document, such as ``it``, can precede them. By default, they
    are in the manual. A range of pages, such as ``p.14-15``, is part of the section.
    """
    citations = []
    for source_text in cited_text.split(";"):
        source_match = _SOURCE_PATTERN.fullmatch(source_text)
        if source_match is not None:
            document_key = source_match["document"] or ""  # Empty for the manual.
            page = int(source_match["page"]) if source_match["page"] else None
            citations.append(Source(document_key, source_match["section"], page))
    return tuple(citations)


def sources(raw_part: Raw, source_key: str = "source") -> Sources:
    """Return the citations under a key of a part of the spec, or ``()`` if it has no such key."""
    return parse_sources(raw_part[source_key]) if source_key in raw_part else ()


def build_part(part_class: Callable[..., T], raw: Raw, /, **value_by_member: Any) -> T:
    """Return a part of the model, an object of ``part_class``, from its definition in a spec.

    A member has the value in ``value_by_member``, or else the value under its name in ``raw``. Other members have their
    default, or an empty value: no text, 0, false, or None if the type allows it. Inner parts and lists of them are
    built in the same way.
    """
    for member_name, member_type, has_default in _members_with_types(part_class):
        if member_name in value_by_member:
            continue
        if member_type == Sources:
            value_by_member[member_name] = sources(raw, member_name)
        elif member_name in raw:
            value_by_member[member_name] = _convert_to_type(member_type, raw[member_name])
        elif not has_default:
            container_or_type = get_origin(member_type) or member_type
            value_by_member[member_name] = _EMPTY_VALUES.get(container_or_type)
    return part_class(**value_by_member)


def records(part_class: Callable[..., T], raw: Raw, key: str) -> tuple[T, ...]:
    """Return the parts of the model that a part of the spec lists under ``key``, as objects of ``part_class``."""
    return tuple(build_part(part_class, definition) for definition in raw.get(key, ()))


@cache
def _members_with_types(part_class: Any) -> list[tuple[str, Any, bool]]:
    """Return the members of a class of the model: for each, its name, its type, and whether it has a default."""
    # Names are resolved in the module, so that a member called 'bytes' does not hide the type.
    hints = get_type_hints(part_class, localns={})
    members: list[tuple[str, Any, bool]] = []
    for member in fields(part_class):
        has_default = member.default is not MISSING or member.default_factory is not MISSING
        members.append((member.name, hints[member.name], has_default))
    return members


def _convert_to_type(member_type: Any, raw_value: Any) -> Any:
    """Return a value from a spec as a member of type ``tuple[Value, ...]``, ``Clock`` or ``Clock | None``, for example.

    A map becomes an object if the type, or the first type in it, is a class of the model. Other values are returned as
    they are.
    """
    type_arguments = get_args(member_type)
    inner_type = type_arguments[0] if type_arguments else member_type
    if get_origin(member_type) is tuple:
        return tuple(_convert_map(inner_type, member) for member in raw_value)
    if isinstance(inner_type, type) and is_dataclass(inner_type):
        return _convert_map(inner_type, raw_value)
    return raw_value


def _convert_map(part_class: Any, raw_value: Any) -> Any:
    """Return a map from the spec as an object of ``part_class``, and any other value as it is."""
    return build_part(part_class, raw_value) if isinstance(raw_value, Mapping) else raw_value


def build_manufacturer(raw_manufacturer: Raw) -> Manufacturer:
    """Return the manufacturer that a checked manufacturer's file describes."""
    name = raw_manufacturer["manufacturer"]
    return build_part(
        Manufacturer, {"python_package": f"{name}_encoders", "version": "0.0.0", **raw_manufacturer, "name": name}
    )


def build_supply(raw_owner: Raw, inherited: Sources = ()) -> Supply | None:
    """Return the supply of a device or of a value of its order code, or None if it has none.

    A supply without a citation has the citation of ``raw_owner``, or else ``inherited``, the citation of its parent.
    """
    if "supply" not in raw_owner:
        return None
    definition = raw_owner["supply"]
    source = sources(definition) or sources(raw_owner) or inherited
    return build_part(Supply, definition, source=source)


def build_table(raw_table: Raw) -> Table:
    return build_part(Table, raw_table, rows=tuple(tuple(map(str, row)) for row in raw_table["rows"]))


def only_while(only: str, variants: Sequence[Variant], parameters: Collection[str]) -> str:
    """Return the first parameter that is not 0 for the order codes in ``only``, and 0 for all others, or "".

    ``only`` is a list of patterns of order codes, such as ``X-24..., X-17-A``.
    """
    return next((name for name in parameters if _is_nonzero_only_for(name, only, variants)), "")


def _is_nonzero_only_for(parameter: str, only: str, variants: Sequence[Variant]) -> bool:
    """Return whether a parameter is not 0 for the order codes in ``only``, and 0 for all others."""
    for variant in variants:
        is_nonzero = variant.parameters.get(parameter, 0) != 0
        if is_nonzero != applies_to_code(only, variant.code):
            return False
    return True


def names_set_by_order_codes(raw_spec: Raw) -> list[str]:
    """Return the names of the parameters that order codes set, not a formula, a register or an answer of the user."""
    derived_keys = {"equals", "read_from", "alternative"}
    return [name for name, definition in raw_spec["parameters"].items() if derived_keys.isdisjoint(definition)]


def check_only_patterns(raw_spec: Raw, variants: Sequence[Variant], report: DocumentReport) -> None:
    """Check each ``patterns_text`` in a spec, the list of patterns for the order codes that a fact applies to.

    An order code must match each pattern. In other editions of the manual, which may have fewer order codes, one
    matching pattern is enough. If the fact is a flag, a parameter must be 0 for all other order codes.
    """
    if not variants:
        return
    for path, raw_fact in _mappings_with_only(raw_spec, ()):
        patterns_text = raw_fact["only"]
        unmatched_patterns = _unmatched_patterns(patterns_text, variants)
        is_wrong = bool(unmatched_patterns)
        if report.document.family:  # The document is another edition of the manual.
            is_wrong = not any(applies_to_code(patterns_text, variant.code) for variant in variants)
        if is_wrong:
            example_code = variants[0].code
            message = f"no order code of the family matches {quoted(unmatched_patterns[0])}"
            example_pattern = quoted(f"{example_code[: len(example_code) // 2]}...")
            remedy = f"'...' matches any text and 'x' matches one character, as in {example_pattern}"
            report.add("only-codes", (*path, "only"), f"{message}; {remedy}")
        elif "active" in raw_fact and not only_while(patterns_text, variants, names_set_by_order_codes(raw_spec)):
            message = f"no parameter distinguishes the order codes {quoted(patterns_text)} from the others"
            remedy = "add a parameter that these order codes set and that is 0 for all others"
            report.add("only-parameter", (*path, "only"), f"{message}; {remedy}")


def parameters_of_flags(raw_spec: Raw, variants: Sequence[Variant]) -> Iterator[str]:
    """Yield, for each flag that only applies to some order codes, the parameter that is 0 for all other codes."""
    names_set_by_codes = names_set_by_order_codes(raw_spec)
    for _, owner in _mappings_with_only(raw_spec, ()):
        if "active" in owner:
            yield only_while(owner["only"], variants, names_set_by_codes)


def _unmatched_patterns(only: str, variants: Sequence[Variant]) -> list[str]:
    """Return the patterns in ``only`` that no order code matches. Commas separate the patterns."""
    patterns = [pattern.strip() for pattern in only.split(",")]
    return [pattern for pattern in patterns if not any(applies_to_code(pattern, variant.code) for variant in variants)]


def check_alarms(raw_spec: Raw, report: DocumentReport) -> None:
    """Report an alarm that applies to different order codes than its flag in a register or field group."""
    spec = WrittenSpec(dict(raw_spec))
    for alarm in spec.alarms:
        register_or_group = owner_of_alarm(spec, alarm)
        if register_or_group is None or not alarm.part.field:
            continue
        flag = next((field for field in register_or_group.fields if field.name == alarm.part.field), None)
        if flag is None or alarm.part.only == flag.only:
            continue
        message = (
            f"the alarm applies to {_codes_in_words(alarm.part.only)}, "
            f"but its flag {quoted(flag.name)} applies to {_codes_in_words(flag.only)}"
        )
        path = (*alarm.path, "only") if alarm.part.only else alarm.path
        report.add("only-alarm", path, f"{message}; give both the same 'only'")


def _codes_in_words(only: str) -> str:
    """Return the order codes that a fact applies to, in words. ``only`` is "" if it applies to all of them."""
    return f"the order codes {quoted(only)}" if only else "all order codes"


def _mappings_with_only(raw_value: Any, spec_path: Path) -> Iterator[tuple[Path, Raw]]:
    """Yield the path and the content of each map in a spec that has the key ``only``, at any depth."""
    if isinstance(raw_value, Mapping):
        if isinstance(raw_value.get("only"), str):
            yield spec_path, raw_value
        for key, inner_value in raw_value.items():
            if key not in ("also_written", "names"):  # The keys below these are texts on labels and languages.
                yield from _mappings_with_only(inner_value, (*spec_path, key))
    elif isinstance(raw_value, (list, tuple)):
        for index, inner_value in enumerate(raw_value):
            yield from _mappings_with_only(inner_value, (*spec_path, index))


def build_procedures(raw_spec: Raw, device: Device) -> tuple[Procedure, ...]:
    return tuple(_build_procedure(definition, device) for definition in raw_spec.get("procedures", ()))


def _build_procedure(raw_procedure: Raw, device: Device) -> Procedure:
    """Return a procedure with its arguments and steps. A step without a citation has the citation of the procedure."""
    arguments: list[Argument] = []
    for raw_argument in raw_procedure.get("arguments", ()):
        arguments.append(build_part(Argument, raw_argument, meant_as=raw_argument.get("as", "")))
    steps = []
    for raw_step in raw_procedure["steps"]:
        build_step = _STEPS[raw_step["do"]]
        steps.append(build_step(raw_step, sources(raw_step) or sources(raw_procedure), device))
    return build_part(Procedure, raw_procedure, arguments=tuple(arguments), steps=tuple(steps))


def _build_write_step(raw_step: Raw, source: Sources, device: Device) -> Step:
    """Return a step that writes a field, if it names one, or a whole register.

    ``value`` names a value of that field, or of the only field of the register. Any other name is an argument of the
    procedure, and the number of the step is then None.
    """
    register_name, field_name = raw_step.get("register", ""), raw_step.get("field", "")
    value_name = raw_step.get("value", "")
    meaning = raw_step.get("meaning", "")
    candidate_fields: list[Any] = []
    for register in device.registers:
        if register.name == register_name:
            candidate_fields += register.layout.fields
    if field_name:
        candidate_fields = [field for field in candidate_fields if field.name == field_name]
    number = None
    if len(candidate_fields) == 1:
        numbers_with_name = [value.value for value in candidate_fields[0].values if value.name == value_name]
        number = numbers_with_name[0] if numbers_with_name else None
    if field_name:
        return ModifyStep(
            register=register_name,
            field=field_name,
            value_name=value_name,
            value=number,
            meaning=meaning,
            source=source,
        )
    return WriteStep(register=register_name, value_name=value_name, value=number, meaning=meaning, source=source)


def _build_read_step(raw_step: Raw, source: Sources, device: Device) -> Step:
    return build_part(ReadStep, raw_step, source=source)


def _build_poll_step(raw_step: Raw, source: Sources, device: Device) -> Step:
    return build_part(PollStep, raw_step, source=source, value=raw_step.get("until", 0))


def _build_wait_step(raw_step: Raw, source: Sources, device: Device) -> Step:
    return build_part(WaitStep, raw_step, source=source, microseconds=1000 * raw_step.get("at_least_ms", 0))


def _build_send_step(raw_step: Raw, source: Sources, device: Device) -> Step:
    """Return a step that sends a request over RS-485: one byte, the control field of a data ID.

    The request is empty if the device does not have this data ID.
    """
    rs485 = device.find_interface(Rs485)
    data_ids = rs485.data_ids if rs485 is not None else ()
    control_bytes = [data_id.control for data_id in data_ids if data_id.name == raw_step.get("data_id")]
    request = bytes(control_bytes[:1])
    pause_us = raw_step.get("every_at_least_us", 0)
    return build_part(SendStep, raw_step, source=source, request=request, microseconds=pause_us)


_STEPS = {
    "write": _build_write_step,
    "read": _build_read_step,
    "poll": _build_poll_step,
    "wait": _build_wait_step,
    "send": _build_send_step,
}


#: A kind of item, as the key of its list, and a name.
PartName = tuple[str, str]


@dataclass(frozen=True)
class ValidParts:
    """The valid parts of a spec, given by the parts that are not valid."""

    #: Places with problems, and the places that contain them.
    faulty_paths: frozenset[Path]
    #: Items with problems, and items that depend on them.
    faulty_parts: frozenset[PartName]

    def is_valid(self, section: str, item_name: str) -> bool:
        """Return whether an item and all items that it uses are valid. ``section`` is a list such as ``registers``."""
        return (section, item_name) not in self.faulty_parts

    @property
    def has_valid_order_codes(self) -> bool:
        """Whether the order codes and the parameters are valid."""
        return ("parameters",) not in self.faulty_paths and ("order_code",) not in self.faulty_paths

    @property
    def has_valid_layouts(self) -> bool:
        """Whether all layouts and data IDs are valid, so that decoders can find the layout of any frame."""
        return not any(kind in ("layouts", "data_ids") for kind, _ in self.faulty_parts)

    def is_example_valid(self, example: Example) -> bool:
        """Return whether an example and all parts that it depends on are valid.

        A bit frame depends on its layout. A frame of bytes depends on all layouts, because its bytes select one of
        them. All examples except those of a CRC also depend on order codes and parameters.
        """
        if not self.is_valid("examples", example.name):
            return False
        match example:
            case CrcExample():
                return self.is_valid("crcs", example.crc)
            case FrameExample() if example.bits:
                are_parts_valid = self.is_valid("layouts", example.layout)
            case FrameExample():
                are_parts_valid = self.has_valid_layouts
            case RegisterExample():
                are_parts_valid = self.is_valid("registers", example.register)
            case ProcedureExample():
                are_parts_valid = self.is_valid("procedures", example.procedure)
            case MeasureExample():
                are_parts_valid = not any("measurement" in path for path in self.faulty_paths)
            case _:
                assert_never(example)
        return are_parts_valid and self.has_valid_order_codes


def valid_parts_so_far(report: DocumentReport) -> ValidParts:
    """Return which parts of a document are valid, according to the problems reported so far."""
    document = report.document
    return valid_parts(WrittenSpec(document.data), (*report.faults(), *document.broken, *document.doubtful))


def valid_parts(spec: WrittenSpec, faults: Iterable[Path]) -> ValidParts:
    """Return which parts of a spec are valid, given the places with problems.

    A part is not valid if something in it has a problem. An item is also not valid if it uses such an item, for example
    a layout that uses a field group with a problem.
    """
    # Each place with a problem and the places that contain it: registers, registers[2] and registers[2].address.
    faulty_paths: set[Path] = set()
    for fault_path in faults:
        faulty_paths.update(fault_path[:step_count] for step_count in range(1, len(fault_path) + 1))
    faulty_parts = {part for part, part_path in _parts_with_paths(spec) if part_path in faulty_paths}
    for field_list in field_lists(spec):  # Field groups come first, because layouts and registers may use them.
        used_parts = [("field_groups", field.use) for field in field_list.fields]
        used_parts += [("crcs", field.crc) for field in field_list.fields]
        if field_list.owner.path in faulty_paths or not faulty_parts.isdisjoint(used_parts):
            faulty_parts.add((field_list.owner_kind.value, _name_or_mark(field_list.name)))
    for procedure in spec.procedures:
        if procedure.path in faulty_paths or not faulty_parts.isdisjoint(_uses_of(procedure)):
            faulty_parts.add(("procedures", _name_or_mark(procedure.name)))
    return ValidParts(frozenset(faulty_paths), frozenset(faulty_parts))


def _parts_with_paths(spec: WrittenSpec) -> Iterator[tuple[PartName, Path]]:
    """Yield each CRC, example, register and data ID of a spec with its place."""
    for crc in spec.crcs:
        yield ("crcs", _name_or_mark(crc.part.name)), crc.path
    for example in spec.examples:
        yield ("examples", _name_or_mark(example.name)), example.path
    for register in spec.registers:
        yield ("registers", _name_or_mark(register.name)), register.path
    for _, interface in interfaces(spec):
        for data_id in WrittenRs485(interface.data, interface.path).data_ids:
            yield ("data_ids", _name_or_mark(data_id.part.name)), data_id.path


def _uses_of(procedure: WrittenProcedure) -> Iterator[PartName]:
    """Yield the registers and data IDs that a procedure uses, in its steps or for the limits of an argument."""
    for step in procedure.steps:
        yield from (("registers", step.register), ("data_ids", step.data_id))
    for argument in procedure.arguments:
        yield "registers", argument.of


def _name_or_mark(name: str) -> str:
    """Return the name of an item, or "?" for an item without a name, which nothing can refer to."""
    return name or "?"
