"""Rules for procedures and register banks: each step is possible, and parameters are written before they are saved.

All registers, fields and values that procedures name must exist.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import takewhile

from ...model import INTERFACES, Biss
from ..document import Path
from ..problems import DocumentReport, quoted
from ..written_codes import WrittenOpenedBy, WrittenRegister
from ..written_interfaces import WrittenRs485
from ..written_parts import WrittenProcedure, WrittenSpec, WrittenStep
from .name_resolver import NameResolver
from .parts import (
    bank_select_register,
    by_name,
    by_part_name,
    fields_of,
    has_other_bits,
    interface_name_of,
    is_second_reading,
    value_names,
    value_names_of_register,
)
from .shapes import check_keys

#: Represents a register that does not exist.
_NO_REGISTER = WrittenRegister({})
Registers = Mapping[str, WrittenRegister]
#: Access of a register that makes a kind of step impossible.
_IMPOSSIBLE_ACCESS = {"write": "read_only", "read": "write_only", "poll": "write_only"}


def check_procedure_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interfaces, registers, values and data IDs that procedures name exist."""
    resolver = NameResolver(spec, report)
    for procedure in spec.procedures:
        resolver.check_optional_name(procedure.place_of("interface"), "interface", procedure.interface)
        for argument in procedure.arguments:
            resolver.check_optional_name(argument.place_of("of"), "register", argument.of)
            register = resolver.registers.get(argument.of)
            if register is not None:
                noun = f"meaning of {quoted(argument.of)} called"
                known_meanings = by_name(register.meanings)
                resolver.check_optional_name(argument.place_of("as"), noun, argument.as_, known_names=known_meanings)
        interface_data = spec.with_invalid_parts.interfaces.data.get(procedure.interface)
        data_ids = by_part_name(WrittenRs485(interface_data).data_ids)
        for step in procedure.steps:
            _check_names_in_step(step, procedure, resolver)
            resolver.check_optional_name(step.place_of("data_id"), "data ID", step.data_id, known_names=data_ids)


def _check_names_in_step(step: WrittenStep, procedure: WrittenProcedure, resolver: NameResolver) -> None:
    """Check that the register, the field and the value that a step of a procedure names exist."""
    name = step.register
    resolver.check_optional_name(step.place_of("register"), "register", name)
    register = resolver.registers.get(name)
    if register is None:
        return
    known_fields = resolver.bit_names(name)
    noun = f"field of {quoted(name)} called"
    resolver.check_optional_name(step.place_of("field"), noun, step.field, known_names=known_fields)
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
    path = step.place_of("value")
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


def check_step_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each step of a procedure has the keys of its kind.

    Keys for the time between requests are allowed only if the step sends several requests.
    """
    for procedure in spec.procedures:
        for step in procedure.steps:
            check_keys(step, step.do, rule="step-shape", subject=f"a {step.do} step", report=report)
            _check_conditions_between_requests(step, report)


def _check_conditions_between_requests(step: WrittenStep, report: DocumentReport) -> None:
    """Check that a step has no condition between requests, such as a time, if it sends only one request."""
    sends_one_request = step.do == "send" and step.times in (None, 1)
    if not sends_one_request:
        return
    request_count = "has no 'times'" if step.times is None else "sends one"
    values_by_key = {"in_succession": step.in_succession, "every_at_least_us": step.every_at_least_us}
    for key, value in values_by_key.items():
        if value:
            key_text = quoted(key)
            problem = f"{key_text} applies to several requests, but the step {request_count}"
            report.add("step-shape", step.place_of(key), f"{problem}; add 'times', or remove {key_text}", at_key=True)
            return


def check_step_access(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every register that is written can be written, and that every register that is read can be read.

    A step that writes one field of a register with other bits must also read the register, to keep the other bits.
    """
    registers = by_name(spec.with_invalid_parts.registers)
    groups = by_name(spec.with_invalid_parts.field_groups)
    for procedure in spec.procedures:
        for step in procedure.steps:
            register = _register_of(step, registers)
            writes_one_field = step.do == "write" and bool(step.field)
            keeps_other_bits = writes_one_field and has_other_bits(register, groups)
            if keeps_other_bits and register.access == "write_only":
                message = (
                    f"{quoted(step.register)} is write_only, so a step cannot keep its other bits; "
                    "describe it as one field with all its bits, and remove 'field'"
                )
                report.add("access-mismatch", step.place_of("field"), message)
            is_impossible = bool(register.access) and _IMPOSSIBLE_ACCESS.get(step.do) == register.access
            if is_impossible:
                message = f"{quoted(step.register)} is {register.access}, so a step cannot {step.do} it"
                report.add("access-mismatch", step.place_of("register"), message)
    _check_written_registers(spec, _names_with_access(registers, "read_only"), report)
    _check_read_registers(spec, _names_with_access(registers, "write_only"), report)


def _register_of(step: WrittenStep, registers: Registers) -> WrittenRegister:
    """Return the register that a step accesses, or an empty register if it accesses none or it does not exist."""
    return registers.get(step.register, _NO_REGISTER)


def _names_with_access(registers: Registers, access: str) -> set[str]:
    return {name for name, register in registers.items() if register.access == access}


def _check_written_registers(spec: WrittenSpec, read_only_names: Collection[str], report: DocumentReport) -> None:
    """Check that no register that unlocks another one for writing, or selects a bank, is among the read-only ones."""
    for register in spec.registers:
        unlocking_register = register.opened_by.register if register.opened_by is not None else ""
        if unlocking_register in read_only_names:
            message = f"{quoted(unlocking_register)} is read_only, so it cannot unlock {quoted(register.name)}"
            report.add("access-mismatch", (*register.place_of("opened_by"), "register"), message)
    bank_register = bank_select_register(spec)
    if bank_register in read_only_names:
        message = f"{quoted(bank_register)} is read_only, so it cannot select a bank"
        report.add("access-mismatch", ("interfaces", Biss.name, "bank_select"), message)


def _check_read_registers(spec: WrittenSpec, write_only_names: Collection[str], report: DocumentReport) -> None:
    """Check that no register that holds a parameter or an alarm is among the write-only ones."""
    for parameter_name, parameter in spec.parameters.items():
        register_name, _, _ = parameter.read_from.partition(".")  # ``register`` or ``register.field``
        if register_name in write_only_names:
            message = f"{quoted(register_name)} is write_only, so {quoted(parameter_name)} cannot be read from it"
            report.add("access-mismatch", parameter.place_of("read_from"), message)
    for located_alarm in spec.alarms:
        alarm = located_alarm.part
        if alarm.register in write_only_names:
            message = f"{quoted(alarm.register)} is write_only, so it cannot signal {quoted(alarm.name)}"
            report.add("access-mismatch", (*located_alarm.path, "register"), message)


def check_step_waits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure waits long enough after a write that takes time, until its next write or its end."""
    registers = by_name(spec.registers)
    for procedure in spec.procedures:
        for index, step in enumerate(procedure.steps):
            needed_ms = _register_of(step, registers).wait_at_least_ms
            if step.do != "write" or needed_ms is None:
                continue
            later_steps = procedure.steps[index + 1 :]
            short_wait = _find_short_wait(step, later_steps, needed_ms)
            if short_wait is not None:
                wait_path, wait_text = short_wait
                problem = f"{quoted(step.register)} needs a wait of {needed_ms} ms after a write"
                report.add("wait-too-short", wait_path, f"{problem}, but {wait_text}", cause=step.register)


def _find_short_wait(write: WrittenStep, later_steps: Sequence[WrittenStep], needed_ms: int) -> tuple[Path, str] | None:
    """Return the place of a wait that is too short or missing after a write, and a text that describes it.

    The text is ``there is no wait here`` or ``the wait here is 5 ms``. The result is None if the waits before the next
    write are long enough together, if a step polls a register before it, or if the procedure ends without a wait.
    """
    steps_before_next_write = list(takewhile(lambda step: step.do != "write", later_steps))
    waits = [step for step in steps_before_next_write if step.do == "wait"]
    waits_ms = [wait.at_least_ms for wait in waits if wait.at_least_ms is not None]
    is_polled = any(step.do == "poll" for step in steps_before_next_write)
    is_last_write = len(steps_before_next_write) == len(later_steps)
    total_ms = sum(waits_ms)
    ends_without_wait = is_last_write and not waits_ms
    if is_polled or total_ms >= needed_ms or ends_without_wait:
        return None
    if not waits_ms:
        return write.path, "there is no wait here"
    return waits[0].place_of("at_least_ms"), f"the wait here is {total_ms} ms"


def check_opening_steps(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure writes the value that unlocks a register (``opened_by``) before it writes the register.

    Only the last of its earlier writes to the unlocking register counts. If there is none, another procedure may unlock
    the register.
    """
    registers = by_name(spec.registers)
    for procedure in spec.procedures:
        argument_names = [argument.name for argument in procedure.arguments]
        for index, step in enumerate(procedure.steps):
            opener = _register_of(step, registers).opened_by
            if step.do != "write" or opener is None:
                continue
            earlier_steps = procedure.steps[:index]
            opening_values = [earlier.value for earlier in earlier_steps if _writes_to_opener(earlier, opener)]
            if not opening_values:
                continue
            last_value = opening_values[-1]
            # The caller of the procedure may pass the correct value as an argument.
            if last_value != opener.value and last_value not in argument_names:
                message = (
                    f"{quoted(step.register)} must be unlocked by writing {quoted(opener.value)} to"
                    f" {quoted(opener.register)}, but {quoted(last_value)} was written there"
                )
                report.add("not-opened", step.place_of("register"), message)


def _writes_to_opener(step: WrittenStep, opener: WrittenOpenedBy) -> bool:
    """Return True if a step writes any value to the register, or to its field, that unlocks another register."""
    if step.do != "write" or not step.value or not opener.value:
        return False
    is_opening_register = bool(step.register) and step.register == opener.register
    writes_all_fields = not step.field
    return is_opening_register and (writes_all_fields or step.field == opener.field)


def check_written_arguments(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each argument of a procedure is written by one of its steps."""
    procedures = by_name(spec.with_invalid_parts.procedures)
    for procedure in spec.procedures:
        # An invalid step may be the one that writes the argument.
        procedure_with_invalid_steps = procedures.get(procedure.name, procedure)
        written_values = [step.value for step in procedure_with_invalid_steps.steps]
        for argument in procedure.arguments:
            if argument.name not in written_values:
                message = (
                    f"no step writes the argument {quoted(argument.name)}; write it with"
                    f" 'value: {argument.name}', or remove the argument"
                )
                report.add("argument-not-written", argument.place_of("name"), message)


def check_procedure_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure with the name of a named value writes this value, if it writes to the same register."""
    registers = by_name(spec.with_invalid_parts.registers)
    groups = by_name(spec.with_invalid_parts.field_groups)
    for procedure in spec.procedures:
        name = procedure.name
        # Steps that write a named value to a register which also has a value with the name of the procedure.
        writes_by_register: dict[str, list[WrittenStep]] = {}
        for step in procedure.steps:
            register = _register_of(step, registers)
            known_values = value_names_of_register(register, groups, step.field)
            if step.do == "write" and {name, step.value} <= set(known_values):
                writes_by_register.setdefault(step.register, []).append(step)
        for register_name, writes in writes_by_register.items():
            written_values = [write.value for write in writes]
            if name not in written_values:
                last_write = writes[-1]
                message = (
                    f"the procedure {quoted(name)} has the same name as a value of {quoted(register_name)}, but writes"
                    f" {quoted(last_write.value)}; write that value, or rename the procedure"
                )
                report.add("procedure-name", last_write.place_of("value"), message)


#: Names of values that save parameters, such as ``save`` or ``store_all``.
_SAVE_WORDS = re.compile(r"(?:save|store|burn)(?:_.*)?")
_ANY_BANK = "any"


def check_saves_before_writes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure writes its arguments before it saves them, unless it has a note, which may explain it.

    It saves with the last write of a value called save, store or burn. Volatile registers need no saving.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    registers = by_name(spec.with_invalid_parts.registers)
    for procedure in spec.procedures:
        if procedure.note:
            continue
        argument_names = {argument.name for argument in procedure.arguments}
        writes = [step for step in procedure.steps if step.do == "write" and step.register in registers]
        indices_of_saves = [index for index, step in enumerate(writes) if _is_save(step)]
        if not indices_of_saves:
            continue
        index_of_last_save = indices_of_saves[-1]
        last_save = writes[index_of_last_save]
        later_writes = writes[index_of_last_save + 1 :]
        writes_to_other_registers = [step for step in later_writes if step.register != last_save.register]
        unsaved_register = _first_unsaved(writes_to_other_registers, argument_names, registers)
        if unsaved_register:
            problem = f"this step saves before {quoted(unsaved_register)} is written"
            remedy = "move this step after the write, or explain the order in a 'note' of the procedure"
            message = f"{problem}, so that value is lost at power-off; {remedy}"
            report.add("saved-too-early", last_save.path, message)


def _is_save(step: WrittenStep) -> bool:
    """Return True if a step writes a named value that is called save, store or burn, such as ``save_all``."""
    return _SAVE_WORDS.fullmatch(step.value) is not None


def _first_unsaved(later_writes: Iterable[WrittenStep], argument_names: set[str], registers: Registers) -> str:
    """Return the first non-volatile register to which one of the later steps writes an argument of the procedure.

    The result is empty if there is none.
    """
    for step in later_writes:
        needs_saving = not registers[step.register].volatile
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
            report.add("bank-not-selected", register.place_of("bank"), message, at_key=True)
        elif not has_bank_select:
            message = (
                f"{quoted(register.name)} is in bank {register.bank}; use 'bank_select' under 'biss' to name"
                " the register that selects banks"
            )
            report.add("bank-not-selected", register.place_of("bank"), message)


def check_selected_bank(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure selects the bank of a register before it accesses the register.

    An argument, whose value is not known, may select any bank.
    """
    registers = by_name(spec.with_invalid_parts.registers)
    bank_register = bank_select_register(spec.with_invalid_parts)
    if not bank_register:
        return
    bank_numbers = _numbers_by_name(registers.get(bank_register, _NO_REGISTER), spec)
    for procedure in spec.procedures:
        selected_bank: object = None
        for step in procedure.steps:
            bank = _register_of(step, registers).bank
            if step.do == "write" and step.register == bank_register:
                # A value without a name is an argument, which may select any bank.
                selected_bank = bank_numbers.get(step.value, _ANY_BANK)
            elif bank is not None and selected_bank not in (bank, _ANY_BANK):
                problem = f"{quoted(step.register)} is in bank {bank}"
                message = f"{problem}; write {bank} to {quoted(bank_register)} before this step"
                report.add("bank-not-selected", step.place_of("register"), message)


def _numbers_by_name(register: WrittenRegister, spec: WrittenSpec) -> dict[str, int | None]:
    """Return the numbers of all named values of a register, by name. The number of an invalid value is None."""
    numbers: dict[str, int | None] = {}
    for field in fields_of(register, by_name(spec.with_invalid_parts.field_groups)):
        numbers |= dict.fromkeys(value_names(field))
        numbers |= {name: value.value for name, value in field.values.items() if value.is_valid("value")}
    return numbers
