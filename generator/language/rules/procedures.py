"""Rules for procedures and register banks: each step is possible, and parameters are written before they are saved."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from itertools import takewhile

from ...model import INTERFACES, Biss
from ..document import Path
from ..problems import DocumentReport, quoted
from ..schema_files import is_second
from .shapes import KeysOfKind, check_keys
from .walk import (
    Fields,
    Has,
    Spec,
    bank_select,
    by_name,
    expanded,
    has_other_bits,
    interface_of,
    items,
    mapping,
    named_values,
)

#: Access of a register that makes a kind of step impossible.
_REFUSED = {"write": "read_only", "read": "write_only", "poll": "write_only"}
#: Keys of each kind of step, and those of all kinds.
_STEPS: dict[str, KeysOfKind] = {
    "write": (("register", "value"), ("field",)),
    "read": (("register",), ("field",)),
    "poll": (("register", "field", "until"), ()),
    "wait": (("at_least_ms",), ()),
    "send": (("data_id",), ("times", "every_at_least_us", "in_succession")),
}
_ALL_STEPS = frozenset(("do", "meaning", "source"))


def step_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each step has the keys of its kind."""
    for path, procedure in items(spec, "procedures"):
        for below, step in items(procedure, "steps"):
            kind: str = step["do"]
            check_keys("step-shape", f"a {kind} step", (*path, *below), step, _STEPS[kind], _ALL_STEPS, report)
            _check_repeated((*path, *below), step, report)


def _check_repeated(path: Path, step: Spec, report: DocumentReport) -> None:
    """Check that conditions between the requests of a step are only given for several requests."""
    conditions = [key for key in ("in_succession", "every_at_least_us") if step.get(key)]
    if step["do"] == "send" and conditions and step.get("times", 1) == 1:
        request_count = "sends one" if "times" in step else "has no 'times'"
        key = quoted(conditions[0])
        problem = f"{key} applies to several requests, but the step {request_count}; add 'times', or remove {key}"
        report.add("step-shape", (*path, conditions[0]), problem, at_key=True)


def step_access(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers that are written are writable, and that those that are read are readable."""
    registers, groups = by_name(raw, "registers"), by_name(raw, "field_groups")
    accesses: dict[str, object] = {name: register.get("access") for name, register in registers.items()}
    for path, procedure in items(spec, "procedures"):
        for step_path, step in items(procedure, "steps"):
            register = registers.get(step.get("register", ""), {})
            access = register.get("access")
            writes_field = step["do"] == "write" and "field" in step
            if writes_field and access == "write_only" and has_other_bits(register, groups):
                message = (
                    f"{quoted(step['register'])} is write_only, so a step cannot keep its other bits; "
                    "describe it as one field with all its bits, and leave 'field' out"
                )
                report.add("access-mismatch", (*path, *step_path, "field"), message)
            if access is not None and _REFUSED.get(step["do"]) == access:
                message = f"{quoted(step['register'])} is {access}, so a step cannot {step['do']} it"
                report.add("access-mismatch", (*path, *step_path, "register"), message)
    _check_written_registers(spec, accesses, report)
    _check_read_registers(spec, accesses, report)


def _check_written_registers(spec: Spec, accesses: Mapping[str, object], report: DocumentReport) -> None:
    """Check that registers that open others or select a bank are writable."""
    for path, register in items(spec, "registers"):
        opener = mapping(register, "opened_by").get("register")
        if accesses.get(str(opener)) == "read_only":
            message = f"{quoted(opener)} is read_only, so it cannot open {quoted(register['name'])}"
            report.add("access-mismatch", (*path, "opened_by", "register"), message)
    select = bank_select(spec)
    if accesses.get(str(select)) == "read_only":
        message = f"{quoted(select)} is read_only, so it cannot select a bank"
        report.add("access-mismatch", ("interfaces", Biss.name, "bank_select"), message)


def _check_read_registers(spec: Spec, accesses: Mapping[str, object], report: DocumentReport) -> None:
    """Check that registers that contain parameters or alarms are readable."""
    for name, parameter in mapping(spec, "parameters").items():
        register_name = str(parameter.get("read_from", "")).partition(".")[0]
        if accesses.get(register_name) == "write_only":
            message = f"{quoted(register_name)} is write_only, so {quoted(name)} cannot be read from it"
            report.add("access-mismatch", ("parameters", name, "read_from"), message)
    for path, alarm in items(spec, "alarms"):
        register_name = str(alarm.get("register", ""))
        if accesses.get(register_name) == "write_only":
            message = f"{quoted(register_name)} is write_only, so it cannot signal {quoted(alarm['name'])}"
            report.add("access-mismatch", (*path, "register"), message)


def step_waits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure waits long enough after a write that takes time, at least before the next write."""
    registers = by_name(spec, "registers")
    for path, procedure in items(spec, "procedures"):
        steps = list(items(procedure, "steps"))
        for index, (step_path, step) in enumerate(steps):
            needed_ms = registers.get(step.get("register", ""), {}).get("wait_at_least_ms")
            if step["do"] == "write" and needed_ms is not None:
                short_wait = _find_short_wait(step_path, steps[index + 1 :], needed_ms)
                if short_wait is not None:
                    place, wait_text = short_wait
                    problem = f"{quoted(step['register'])} needs a wait of {needed_ms} ms after a write"
                    report.add("wait-too-short", (*path, *place), f"{problem}, but {wait_text}", cause=step["register"])


def _find_short_wait(write_path: Path, later_steps: list[tuple[Path, Spec]], needed_ms: int) -> tuple[Path, str] | None:
    """Return the place of a wait that is too short or missing after a write, and what is there. None if it is enough.

    After the last write, a procedure need not wait at all.
    """
    until_write = list(takewhile(lambda path_and_step: path_and_step[1]["do"] != "write", later_steps))
    waits = [(path, step) for path, step in until_write if step["do"] == "wait"]
    waits_ms = [wait["at_least_ms"] for _, wait in waits if "at_least_ms" in wait]
    is_polled = any(step["do"] == "poll" for _, step in until_write)
    is_last_write = len(until_write) == len(later_steps)
    if is_polled or sum(waits_ms) >= needed_ms or (is_last_write and not waits_ms):
        return None
    if not waits_ms:
        return write_path, "there is no wait here"
    first_wait_path, _ = waits[0]
    return (*first_wait_path, "at_least_ms"), f"the wait here is {sum(waits_ms)} ms"


def step_opens(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure that writes to the opener of a register writes the value that opens it."""
    registers = by_name(spec, "registers")
    for path, procedure in items(spec, "procedures"):
        steps = list(items(procedure, "steps"))
        arguments = [argument["name"] for _, argument in items(procedure, "arguments")]
        for index, (step_path, step) in enumerate(steps):
            opener = mapping(registers.get(step.get("register", ""), {}), "opened_by")
            values_before = [earlier["value"] for _, earlier in steps[:index] if _writes(earlier, opener)]
            if step["do"] != "write" or not values_before:
                continue
            # An argument may be the value that opens the register.
            last_value = values_before[-1]
            if last_value != opener.get("value") and last_value not in arguments:
                message = (
                    f"{quoted(step['register'])} must be opened by writing {quoted(opener['value'])} to"
                    f" {quoted(opener['register'])}, but {quoted(last_value)} was written there"
                )
                report.add("not-opened", (*path, *step_path, "register"), message)


def _writes(step: Spec, opener: Spec) -> bool:
    """Return True if a step writes the register, or the field of it, that opens another register."""
    if step["do"] != "write" or "value" not in step or "value" not in opener:
        return False
    writes_opening_register = "register" in step and step["register"] == opener.get("register")
    # A step without a field writes all of them.
    writes_opening_field = "field" not in step or step["field"] == opener.get("field")
    return writes_opening_register and writes_opening_field


def argument_written(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure writes each of its arguments."""
    procedures = by_name(raw, "procedures")
    for path, procedure in items(spec, "procedures"):
        # A step rejected by the schema may be the one that writes it.
        steps = [step for _, step in items(procedures.get(procedure["name"], {}), "steps")]
        written_values = [step.get("value") for step in steps]  # of any type, as the schema may have rejected the step
        for argument_path, argument in items(procedure, "arguments"):
            if argument["name"] not in written_values:
                message = (
                    f"no step writes the argument {quoted(argument['name'])}; write it with"
                    f" 'value: {argument['name']}', or remove the argument"
                )
                report.add("argument-not-written", (*path, *argument_path, "name"), message)


def procedure_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure with the name of a command writes the value of that command to the register."""
    registers, groups = by_name(raw, "registers"), by_name(raw, "field_groups")
    for path, procedure in items(spec, "procedures"):
        name = procedure["name"]
        writes_by_register: dict[str, list[tuple[Path, object]]] = {}
        for step_path, step in items(procedure, "steps"):
            register = registers.get(step.get("register", ""), {})
            value_names = named_values(register, groups, step.get("field"))
            if step["do"] == "write" and name in value_names and step.get("value") in value_names:
                value_path = (*path, *step_path, "value")
                writes_by_register.setdefault(step["register"], []).append((value_path, step["value"]))
        for register_name, writes in writes_by_register.items():
            written_values = [value for _, value in writes]
            if name not in written_values:
                last_path, last_value = writes[-1]
                message = (
                    f"the procedure {quoted(name)} has the same name as a value of {quoted(register_name)}, but writes"
                    f" {quoted(last_value)}; write that value, or rename the procedure"
                )
                report.add("procedure-name", last_path, message)


_SAVE = re.compile(r"(?:save|store|burn)(?:_.*)?")
_ANY_BANK = "any"


def saved_before_written(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure writes its arguments before it saves, unless a note of the procedure explains it."""
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    registers = by_name(raw, "registers")
    for path, procedure in items(spec, "procedures"):
        if "note" in procedure:
            continue
        arguments = {argument["name"] for _, argument in items(procedure, "arguments")}
        writes = [(step_path, step) for step_path, step in items(procedure, "steps") if step["do"] == "write"]
        saves = [
            index for index, (_, step) in enumerate(writes) if step.get("register") in registers and _is_save(step)
        ]
        if not saves:
            continue
        last_save = saves[-1]
        save_path, save = writes[last_save]
        later_steps = [step for _, step in writes[last_save + 1 :] if step.get("register") != save.get("register")]
        unsaved_register = _first_unsaved(later_steps, arguments, registers)
        if unsaved_register:
            problem = f"this step saves before {quoted(unsaved_register)} is written"
            remedy = "move this step behind the write, or explain the order in a 'note' of the procedure"
            message = f"{problem}, so that value is lost at power-off; {remedy}"
            report.add("saved-too-early", (*path, *save_path), message)


def _is_save(step: Spec) -> bool:
    """Return whether a step writes a value that is called save, store or burn."""
    return _SAVE.fullmatch(str(step.get("value", ""))) is not None


def _first_unsaved(later_steps: Iterable[Spec], arguments: set[str], registers: dict[str, Spec]) -> str:
    """Return the first register that later steps write with an argument, or an empty text. Not a volatile one."""
    for step in later_steps:
        name = str(step.get("register", ""))
        if step.get("value") in arguments and name in registers and not registers[name].get("volatile"):
            return name
    return ""


def bank_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the interface of a register in a bank has banks and names the register that selects them."""
    select = bank_select(raw)
    for path, register in items(spec, "registers"):
        interface = interface_of(register)
        if "bank" not in register:
            continue
        if INTERFACES[interface].highest_in_bank is None:
            message = (
                f"{quoted(register['name'])} is in a bank, but only BiSS has a register that selects banks; leave"
                " 'bank' out, and describe in 'note' how the bank is selected"
            )
            report.add("bank-not-selected", (*path, "bank"), message, at_key=True)
        elif select is None:
            message = (
                f"{quoted(register['name'])} is in bank {register['bank']}; name the register that selects banks with"
                " 'bank_select' under 'biss'"
            )
            report.add("bank-not-selected", (*path, "bank"), message)


def bank_selected(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure selects the bank before it accesses a register in it."""
    registers, select = by_name(raw, "registers"), bank_select(raw)
    if not isinstance(select, str):
        return
    bank_numbers = _numbers(registers.get(select, {}), raw)
    for path, procedure in items(spec, "procedures"):
        selected_bank: object = None
        for step_path, step in items(procedure, "steps"):
            bank = registers.get(step.get("register", ""), {}).get("bank")
            if step["do"] == "write" and step.get("register") == select:
                # An argument may select any bank.
                selected_bank = bank_numbers.get(step.get("value", ""), _ANY_BANK)
            elif isinstance(bank, int) and selected_bank not in (bank, _ANY_BANK):
                message = (
                    f"{quoted(step['register'])} is in bank {bank}; write {bank} to {quoted(select)} before this step"
                )
                report.add("bank-not-selected", (*path, *step_path, "register"), message)


def _numbers(register: Spec, raw: Spec) -> dict[str, object]:
    """Return the numbers of all named values of a register."""
    numbers: dict[str, object] = {}
    for _, field in expanded(Fields(Has.REGISTER, register, (), ""), by_name(raw, "field_groups")):
        for name, value in mapping(field, "values").items():
            numbers[name] = mapping(value).get("value")
    return numbers
