"""Rules for procedures as a whole: the names in them, arguments, banks, and the writes that the manual prints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from ...model import INTERFACES
from ..keys_of_fields import WrittenRegister
from ..keys_of_order_codes import WrittenRs485
from ..keys_of_specs import WrittenProcedure, WrittenSpec, WrittenStep
from ..problems import DocumentReport, Path, quoted
from .parts import (
    NO_REGISTER,
    Groups,
    Registers,
    bank_select_register,
    by_name,
    by_part_name,
    fields_of,
    has_other_bits,
    interface_name_of,
    is_second_reading,
    last_address,
    parse_bit_range,
    register_of_step,
    value_names,
)
from .references import NameResolver
from .walk import leaves


def check_procedure_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interfaces, registers, values and data IDs that procedures name exist."""
    resolver = NameResolver(spec, report)
    for procedure in spec.procedures:
        resolver.check_optional_name(procedure.path_of("interface"), "interface", procedure.interface)
        for argument in procedure.arguments:
            resolver.check_optional_name(argument.path_of("of"), "register", argument.of)
            register = resolver.registers.get(argument.of)
            if register is not None:
                noun = f"meaning of {quoted(argument.of)} called"
                known_meanings = by_name(register.meanings)
                resolver.check_optional_name(argument.path_of("as"), noun, argument.as_, known_names=known_meanings)
        interface_data = spec.with_invalid_parts.interfaces.data.get(procedure.interface)
        data_ids = by_part_name(WrittenRs485(interface_data).data_ids)
        for step in procedure.steps:
            _check_names_in_step(step, procedure, resolver)
            resolver.check_optional_name(step.path_of("data_id"), "data ID", step.data_id, known_names=data_ids)


def _check_names_in_step(step: WrittenStep, procedure: WrittenProcedure, resolver: NameResolver) -> None:
    """Check that the register, the field and the value that a step of a procedure names exist."""
    name = step.register
    resolver.check_optional_name(step.path_of("register"), "register", name)
    register = resolver.registers.get(name)
    if register is None:
        return
    known_fields = resolver.bit_names(name)
    noun = f"field of {quoted(name)} called"
    resolver.check_optional_name(step.path_of("field"), noun, step.field, known_names=known_fields)
    has_unknown_field = bool(step.field) and step.field not in known_fields
    if not has_unknown_field:
        argument_names = [argument.name for argument in procedure.arguments]
        _check_written_value(step, register, argument_names, resolver)


def _check_written_value(
    step: WrittenStep, register: WrittenRegister, argument_names: Sequence[str], resolver: NameResolver
) -> None:
    """Check that a step writes an argument of its procedure or a named value, without changing other bits.

    A step without a field writes the whole register. If it writes the named value of one of several fields, this is
    reported, because it would change the other fields.
    """
    name = step.register
    path = step.path_of("value")
    possible_values = [*resolver.value_names(name, step.field), *argument_names]
    noun = f"argument, or value of {quoted(name)}, called"
    resolver.check_optional_name(path, noun, step.value, known_names=possible_values)
    is_named_value = step.value in resolver.value_names(name) and step.value not in argument_names
    writes_whole_register = not step.field
    if writes_whole_register and is_named_value and has_other_bits(register, resolver.groups):
        remedy = f"add 'field' with the name of the field that must hold {quoted(step.value)}"
        if register.access == "write_only":
            remedy = "describe it as one field with all its bits, because it is write_only"
        resolver.report_problem(path, f"{quoted(name)} has other bits, too; {remedy}")


def check_written_arguments(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each argument of a procedure is written by one of its steps."""
    procedure_by_name = by_name(spec.with_invalid_parts.procedures)
    for procedure in spec.procedures:
        # An invalid step may be the one that writes the argument.
        procedure_with_invalid_steps = procedure_by_name.get(procedure.name, procedure)
        written_values = [step.value for step in procedure_with_invalid_steps.steps]
        for argument in procedure.arguments:
            if argument.name not in written_values:
                message = (
                    f"no step writes the argument {quoted(argument.name)}; write it with"
                    f" 'value: {argument.name}', or remove the argument"
                )
                report.add("argument-not-written", argument.path_of("name"), message)


#: Names of values that save parameters, such as ``save`` or ``store_all``.
_SAVE_WORDS = re.compile(r"(?:save|store|burn)(?:_.*)?")
_ANY_BANK = "any"


def check_saves_before_writes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure writes its arguments before it saves them, unless it has a note, which may explain it.

    It saves with the last write of a value called save, store or burn. Volatile registers need no saving.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    register_by_name = by_name(spec.with_invalid_parts.registers)
    for procedure in spec.procedures:
        if procedure.note:
            continue
        argument_names = {argument.name for argument in procedure.arguments}
        writes = [step for step in procedure.steps if step.do == "write" and step.register in register_by_name]
        indices_of_saves = [index for index, step in enumerate(writes) if _is_save(step)]
        if not indices_of_saves:
            continue
        index_of_last_save = indices_of_saves[-1]
        last_save = writes[index_of_last_save]
        later_writes = writes[index_of_last_save + 1 :]
        writes_to_other_registers = [step for step in later_writes if step.register != last_save.register]
        unsaved_register = _first_unsaved_register(writes_to_other_registers, argument_names, register_by_name)
        if unsaved_register:
            problem = f"this step saves before {quoted(unsaved_register)} is written"
            remedy = "move this step after the write, or explain the order in a 'note' of the procedure"
            message = f"{problem}, so that value is lost at power-off; {remedy}"
            report.add("saved-too-early", last_save.path, message)


def _is_save(step: WrittenStep) -> bool:
    """Return True if a step writes a named value that is called save, store or burn, such as ``save_all``."""
    return _SAVE_WORDS.fullmatch(step.value) is not None


def _first_unsaved_register(
    later_writes: Iterable[WrittenStep], argument_names: set[str], register_by_name: Registers
) -> str:
    """Return the first non-volatile register to which one of the later steps writes an argument of the procedure.

    The result is empty if there is none.
    """
    for step in later_writes:
        needs_saving = not register_by_name[step.register].volatile
        if needs_saving and step.value in argument_names:
            return step.register
    return ""


def check_named_bank(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register in a bank is accessed over BiSS, and that BiSS names the register that selects the bank."""
    biss = spec.with_invalid_parts.interfaces.biss
    has_bank_select = biss is not None and biss.has("bank_select")
    for register in spec.registers:
        if register.bank is None:
            continue
        if INTERFACES[interface_name_of(register)].highest_in_bank is None:
            message = (
                f"{quoted(register.name)} is in a bank, but only BiSS has a register that selects banks; remove"
                " 'bank', and describe in 'note' how the bank is selected"
            )
            report.add("bank-not-selected", register.path_of("bank"), message, at_key=True)
        elif not has_bank_select:
            message = (
                f"{quoted(register.name)} is in bank {register.bank}; use 'bank_select' under 'biss' to name"
                " the register that selects banks"
            )
            report.add("bank-not-selected", register.path_of("bank"), message)


def check_selected_bank(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure selects the bank of a register before it accesses the register.

    An argument, whose value is not known, may select any bank.
    """
    register_by_name = by_name(spec.with_invalid_parts.registers)
    bank_register = bank_select_register(spec.with_invalid_parts)
    if not bank_register:
        return
    bank_numbers = _numbers_by_name(register_by_name.get(bank_register, NO_REGISTER), spec)
    for procedure in spec.procedures:
        selected_bank: object = None
        for step in procedure.steps:
            bank = register_of_step(step, register_by_name).bank
            if step.do == "write" and step.register == bank_register:
                # A value without a name is an argument, which may select any bank.
                selected_bank = bank_numbers.get(step.value, _ANY_BANK)
            elif bank is not None and selected_bank not in (bank, _ANY_BANK):
                problem = f"{quoted(step.register)} is in bank {bank}"
                message = f"{problem}; write {bank} to {quoted(bank_register)} before this step"
                report.add("bank-not-selected", step.path_of("register"), message)


def _numbers_by_name(register: WrittenRegister, spec: WrittenSpec) -> dict[str, int | None]:
    """Return the numbers of all named values of a register, by name. The number of an invalid value is None."""
    numbers: dict[str, int | None] = {}
    for field in fields_of(register, by_name(spec.with_invalid_parts.field_groups)):
        numbers |= dict.fromkeys(value_names(field))
        numbers |= {name: value.value for name, value in field.values.items() if value.is_valid("value")}
    return numbers


#: A printed write, as in ``0x48 = 0x01``, ``0x49 bit 2 = 0`` or ``0x50-0x54``.
_PRINTED_WRITE = re.compile(
    r"(?P<first>0x[0-9A-Fa-f]+)(?:-(?P<last>0x[0-9A-Fa-f]+))?(?: bit (?P<bit>[0-9]+))?(?: = (?P<value>\w+))?"
)


@dataclass(frozen=True)
class _Write:
    """A write: the addresses, the bit if it is a single one, and the number, or None if the caller supplies it."""

    first_address: int
    last_address: int
    bit: int | None
    value: int | None

    def __str__(self) -> str:
        """Return the write as text, such as ``0x48 = 0x01``, ``0x49 bit 2 = 0`` or ``0x50-0x54``."""
        text = f"{self.first_address:#04x}"
        if self.last_address > self.first_address:
            text += f"-{self.last_address:#04x}"
        if self.bit is not None:
            text += f" bit {self.bit}"
        if self.value is not None:
            text += f" = {self.value:#04x}" if self.bit is None else f" = {self.value}"
        return text


def check_writes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``printed_writes``, the writes that the manual prints for a procedure, match its steps.

    A procedure with a step that is not completely known is not checked.
    """
    register_by_name = by_name(spec.registers)
    group_by_name = by_name(spec.field_groups)
    for procedure in spec.procedures:
        write_steps = [step for step in procedure.steps if step.do == "write"]
        writes = [_write_of_step(step, register_by_name, group_by_name) for step in write_steps]
        are_all_known = None not in writes
        if procedure.printed_writes and are_all_known:
            _compare_writes(procedure, write_steps, writes, report)


def _compare_writes(
    procedure: WrittenProcedure, write_steps: list[WrittenStep], writes: list[_Write | None], report: DocumentReport
) -> None:
    """Report each printed write that differs from the step at the same place, and each step without a printed write.

    ``writes`` contains the write that each of the ``write_steps`` carries out.
    """
    for index, printed_text in enumerate(procedure.printed_writes):
        printed_write = _parse_printed_write(printed_text)
        printed_path = (*procedure.path, "printed_writes", index)
        if index >= len(write_steps):
            report.add("writes-mismatch", printed_path, f"{printed_write} is printed, but no step writes it")
        elif printed_write != writes[index]:
            line, _ = report.document.position(write_steps[index].path)
            message = f"{printed_write} is printed, but the step on line {line} writes {writes[index]}"
            report.add("writes-mismatch", printed_path, message)
    steps_without_print = write_steps[len(procedure.printed_writes) :]
    for step in steps_without_print:
        report.add("writes-mismatch", step.path, "this write is not among the 'printed_writes'")


def _parse_printed_write(write_text: str) -> _Write:
    """Return the write that a text of ``printed_writes`` describes, such as ``0x49 bit 2 = 0`` or ``0x50-0x54``."""
    match = _PRINTED_WRITE.fullmatch(write_text)
    assert match is not None  # The schema uses the same pattern.
    first_text, last_text, bit_text, value_text = match.group("first", "last", "bit", "value")
    return _Write(
        first_address=int(first_text, 16),
        last_address=int(last_text or first_text, 16),
        bit=int(bit_text) if bit_text else None,
        value=int(value_text, 0) if value_text else None,
    )


def _write_of_step(
    step: WrittenStep, register_by_name: Mapping[str, WrittenRegister], group_by_name: Groups
) -> _Write | None:
    """Return the write that a step of a procedure carries out, or None if it is not completely known.

    With ``field``, only the bits of this field are written, and the result contains the lowest one. Otherwise the whole
    register is written, with the value in the bits of the field that has it.
    """
    register = register_by_name.get(step.register)
    if register is None or not step.value:
        return None
    register_fields = list(fields_of(register, group_by_name))
    possible_fields = [field for field in register_fields if step.field in ("", field.name)]
    # The field that has the value. Without such a field, the value is an argument, whose number the caller supplies.
    fields_with_value = [field for field in possible_fields if step.value in field.values]
    written_number = None
    if fields_with_value:
        written_number = fields_with_value[0].values[step.value].value
    write_of_register = _Write(register.address, last_address(register), bit=None, value=written_number)
    is_value_of_register = not fields_with_value or len(register_fields) == 1
    if not step.field and is_value_of_register:
        return write_of_register
    written_fields = fields_with_value or possible_fields
    bit_range = parse_bit_range(written_fields[0].at) if written_fields else None
    if bit_range is None:
        return None
    if step.field:
        return replace(write_of_register, bit=bit_range.lowest)
    # The step writes the whole register: the other fields are 0, and the value is at the bits of its field.
    shifted_number = (written_number or 0) << bit_range.lowest
    return replace(write_of_register, value=shifted_number)


_NUMBER_WORDS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
_REPETITIONS_IN_TEXT = re.compile(rf"\b({'|'.join(_NUMBER_WORDS)}|[1-9]\d?) requests\b", re.IGNORECASE)


def check_register_of_argument(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an argument of a procedure is written to the register whose limits apply to it (``of``)."""
    register_by_name = by_name(spec.with_invalid_parts.registers)
    for procedure in spec.procedures:
        for argument in procedure.arguments:
            register_with_limits = argument.of
            write_steps = [step for step in procedure.steps if step.do == "write" and step.value == argument.name]
            written_register_names = [write_step.register for write_step in write_steps]
            if register_with_limits not in register_by_name:
                continue
            if write_steps and register_with_limits not in written_register_names:
                message = (
                    f"the limits of {quoted(argument.name)} are those of {quoted(register_with_limits)}, but a step"
                    f" writes it to {quoted(written_register_names[0])}; correct one of the two"
                )
                report.add("argument-register", argument.path_of("of"), message)


def check_counted_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a number of requests in the texts of a procedure is the number of times that its step sends a request.

    Only procedures with several steps are checked, exactly one of which repeats its request.
    """
    for procedure in spec.procedures:
        repeated_steps = [step for step in procedure.steps if step.times is not None]
        if len(repeated_steps) != 1 or len(procedure.steps) == 1:  # Another rule checks a procedure of one step.
            continue
        (repeated_step,) = repeated_steps
        for stated_count in _stated_counts(procedure):
            if stated_count.number != repeated_step.times:
                problem = f"the text says {stated_count.number} requests, but 'times' is {repeated_step.times}"
                report.add("quantity-repeated", stated_count.path, f"{problem}; one of the two is wrong")


def check_repeated_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a text of a procedure with one step has the number of requests that the step sends."""
    for procedure in spec.procedures:
        times = procedure.steps[0].times if len(procedure.steps) == 1 else None
        if times is None:
            continue  # With several steps, it is not known about which of them a text speaks.
        for stated_count in _stated_counts(procedure):
            if stated_count.number != times:
                message = (
                    f"the text says {stated_count.words} requests, but 'times' is {times}; one of the two is wrong"
                )
                report.add("quantity-repeated", stated_count.path, message)


class _StatedCount(NamedTuple):
    """A number of requests in a text of a procedure: the path of the text, the number as written, and the number."""

    path: Path
    words: str
    number: int


def _stated_counts(procedure: WrittenProcedure) -> Iterator[_StatedCount]:
    """Yield each number of requests in the texts of a procedure, such as 3 for ``after three requests``."""
    for path_in_procedure, text in leaves(procedure.data):
        if not isinstance(text, str):
            continue
        for words in _REPETITIONS_IN_TEXT.findall(text):
            number = int(words) if words.isdigit() else _NUMBER_WORDS.index(words.casefold()) + 2  # The first is "two".
            yield _StatedCount((*procedure.path, *path_in_procedure), words=words, number=number)
