"""Rules for the steps of procedures: their keys, the registers that they access, and waits."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import takewhile
from typing import NamedTuple

from ...model import Biss
from ..document import Path
from ..keys_of_fields import WrittenOpenedBy, WrittenRegister
from ..keys_of_specs import WrittenProcedure, WrittenSpec, WrittenStep
from ..problems import DocumentReport, quoted
from .parts import (
    Groups,
    Registers,
    bank_select_register,
    by_name,
    constant_width,
    fields_of,
    has_other_bits,
    interface_name_of,
    is_second_reading,
    register_of_step,
)
from .shapes import check_keys
from .walk import leaves

#: Kinds of steps that access a register.
_KINDS_OF_ACCESS = frozenset(("write", "read", "poll"))
_MILLISECONDS_IN_TEXT = re.compile(r"(?<![\w.,])(\d+) ?ms\b")


def check_interface_of_steps(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure for an interface of the spec accesses only registers of this interface."""
    register_by_name = by_name(spec.registers)
    for procedure in spec.procedures:
        if procedure.interface not in spec.interfaces.data:
            continue
        for step in procedure.steps:
            register = register_by_name.get(step.register)
            if step.do not in _KINDS_OF_ACCESS or register is None:
                continue
            interface_of_register = interface_name_of(register)
            if interface_of_register != procedure.interface:
                message = (
                    f"{quoted(step.register)} is a register of {interface_of_register}, but the procedure is for"
                    f" {procedure.interface}; correct the interface of one of the two"
                )
                report.add("interface-mismatch", step.path_of("register"), message, cause=procedure.name)


def check_polled_values(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a step that polls a field waits for a value that fits in the field."""
    register_by_name = by_name(spec.registers)
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for procedure in spec.procedures:
        for step in procedure.steps:
            register = register_by_name.get(step.register)
            if step.do != "poll" or register is None or step.until is None:
                continue
            width = _width_of_field(register, step.field, group_by_name)
            if width is None:
                continue
            bits_above_width = step.until >> width
            if bits_above_width:
                bits_text = "1 bit" if width == 1 else f"{width} bits"
                message = f"{quoted(step.field)} has {bits_text}, so it is never {step.until}"
                report.add("value-too-wide", step.path_of("until"), message)


def _width_of_field(register: WrittenRegister, field_name: str, group_by_name: Groups) -> int | None:
    """Return the width of a field of a register, or None if the width is not constant or the field does not exist."""
    for field in fields_of(register, group_by_name):
        if field.name == field_name:
            return constant_width(field)
    return None


def check_waits_of_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the waits directly after a write are together not longer than the register needs.

    A text of the procedure that contains the longer time explains it.
    """
    if is_second_reading(report.document):  # Second readings have no such texts.
        return
    register_by_name = by_name(spec.registers)
    for procedure in spec.procedures:
        explained_ms = set(_milliseconds_in_texts(procedure))
        for write, waits in _waits_after_writes(procedure):
            needed_ms = _needed_wait_ms(write, register_by_name)
            waited_ms = sum(wait.at_least_ms or 0 for wait in waits)
            if needed_ms is None or waited_ms in explained_ms:
                continue
            if waited_ms > needed_ms:
                message = (
                    f"{quoted(write.register)} needs a wait of {needed_ms} ms after a write, but the wait here is"
                    f" {waited_ms} ms; correct one of the two, or say in a 'note' of the procedure why it takes"
                    f" {waited_ms} ms"
                )
                report.add("wait-mismatch", waits[0].path_of("at_least_ms"), message)


def _milliseconds_in_texts(procedure: WrittenProcedure) -> Iterator[int]:
    """Yield the times in milliseconds in the texts of a procedure."""
    for _, text in leaves(procedure.data):
        if isinstance(text, str):
            yield from map(int, _MILLISECONDS_IN_TEXT.findall(text))


def _waits_after_writes(procedure: WrittenProcedure) -> Iterator[tuple[WrittenStep, Sequence[WrittenStep]]]:
    """Yield each write with the waits directly after it, if there are any."""
    for index, step in enumerate(procedure.steps):
        if step.do != "write":
            continue
        later_steps = procedure.steps[index + 1 :]
        waits = list(takewhile(lambda later_step: later_step.do == "wait", later_steps))
        if waits:
            yield step, waits


def check_wait_at_end(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report a procedure that ends with a wait and then a write, if the register needs exactly this wait after a write.

    The two steps are then probably in the wrong order, unless the step before the wait needs a wait, too.
    """
    register_by_name = by_name(spec.registers)
    for procedure in spec.procedures:
        if [step.do for step in procedure.steps[-2:]] != ["wait", "write"]:
            continue
        *earlier_steps, wait, last_write = procedure.steps
        needed_ms = _needed_wait_ms(last_write, register_by_name)
        is_for_step_before = bool(earlier_steps) and _needed_wait_ms(earlier_steps[-1], register_by_name) is not None
        if needed_ms is None or is_for_step_before:
            continue
        if wait.at_least_ms == needed_ms:
            message = (
                f"{quoted(last_write.register)} needs a wait of {needed_ms} ms after a write, and the procedure waits"
                " before it; move the wait behind this step, or add another one"
            )
            report.add("wait-too-short", last_write.path, message, cause=last_write.register)


def _needed_wait_ms(step: WrittenStep, register_by_name: Mapping[str, WrittenRegister]) -> int | None:
    """Return the wait in ms that the register of a step needs after a write, or None if none is known."""
    register = register_by_name.get(step.register)
    return register.wait_at_least_ms if register is not None else None


def check_polled_levels(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a step that polls a bit waits for the level that follows from its meaning.

    If the meaning is ``0 until the value is saved``, or has ``while`` or ``during`` instead of ``until``, the step must
    wait for 1. If it is ``0 when …``, the step must wait for 0.
    """
    for procedure in spec.procedures:
        for step in procedure.steps:
            match = _LEVEL_IN_MEANING.match(step.meaning)
            if step.do != "poll" or match is None or step.until not in (0, 1):
                continue
            stated_level = int(match.group("level"))
            # ``0 when saved`` gives the level at the end, and ``0 until saved`` the level before.
            final_level = stated_level if match.group("conjunction") == "when" else 1 - stated_level
            if step.until != final_level:
                problem = f"the meaning says {quoted(match[0])}, but 'until' is {step.until}"
                report.add("words-contradict", step.path_of("until"), f"{problem}; one of the two is wrong")


#: The level of a bit in a meaning such as ``0 until the value is saved``.
_LEVEL_IN_MEANING = re.compile(r"(?P<level>[01]) (?P<conjunction>until|while|during|when)\b")
#: Access of a register that makes a kind of step impossible.
_IMPOSSIBLE_ACCESS = {"write": "read_only", "read": "write_only", "poll": "write_only"}


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
            report.add("step-shape", step.path_of(key), f"{problem}; add 'times', or remove {key_text}", at_key=True)
            return


def check_step_access(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every register that is written can be written, and that every register that is read can be read.

    A step that writes one field of a register with other bits must also read the register, to keep the other bits.
    """
    register_by_name = by_name(spec.with_invalid_parts.registers)
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for procedure in spec.procedures:
        for step in procedure.steps:
            register = register_of_step(step, register_by_name)
            writes_one_field = step.do == "write" and bool(step.field)
            keeps_other_bits = writes_one_field and has_other_bits(register, group_by_name)
            if keeps_other_bits and register.access == "write_only":
                message = (
                    f"{quoted(step.register)} is write_only, so a step cannot keep its other bits; "
                    "describe it as one field with all its bits, and remove 'field'"
                )
                report.add("access-mismatch", step.path_of("field"), message)
            is_impossible = bool(register.access) and _IMPOSSIBLE_ACCESS.get(step.do) == register.access
            if is_impossible:
                message = f"{quoted(step.register)} is {register.access}, so a step cannot {step.do} it"
                report.add("access-mismatch", step.path_of("register"), message)
    _check_written_registers(spec, _names_with_access(register_by_name, "read_only"), report)
    _check_read_registers(spec, _names_with_access(register_by_name, "write_only"), report)


def _names_with_access(register_by_name: Registers, access: str) -> set[str]:
    return {name for name, register in register_by_name.items() if register.access == access}


def _check_written_registers(spec: WrittenSpec, read_only_names: Collection[str], report: DocumentReport) -> None:
    """Check that no register that unlocks another one for writing, or selects a bank, is among the read-only ones."""
    for register in spec.registers:
        unlocking_register = register.opened_by.register if register.opened_by is not None else ""
        if unlocking_register in read_only_names:
            message = f"{quoted(unlocking_register)} is read_only, so it cannot unlock {quoted(register.name)}"
            report.add("access-mismatch", (*register.path_of("opened_by"), "register"), message)
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
            report.add("access-mismatch", parameter.path_of("read_from"), message)
    for located_alarm in spec.alarms:
        alarm = located_alarm.part
        if alarm.register in write_only_names:
            message = f"{quoted(alarm.register)} is write_only, so it cannot signal {quoted(alarm.name)}"
            report.add("access-mismatch", (*located_alarm.path, "register"), message)


def check_step_waits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure waits long enough after a write that takes time, until its next write or its end."""
    register_by_name = by_name(spec.registers)
    for procedure in spec.procedures:
        for index, step in enumerate(procedure.steps):
            needed_ms = register_of_step(step, register_by_name).wait_at_least_ms
            if step.do != "write" or needed_ms is None:
                continue
            later_steps = procedure.steps[index + 1 :]
            short_wait = _find_short_wait(step, later_steps, needed_ms)
            if short_wait is not None:
                problem = f"{quoted(step.register)} needs a wait of {needed_ms} ms after a write"
                message = f"{problem}, but {short_wait.text}"
                report.add("wait-too-short", short_wait.path, message, cause=step.register)


class _ShortWait(NamedTuple):
    """The path of a wait that is too short, or of a write without a wait, and a text that says so."""

    path: Path
    text: str


def _find_short_wait(write: WrittenStep, later_steps: Sequence[WrittenStep], needed_ms: int) -> _ShortWait | None:
    """Return the wait after a write that is too short or missing. Its text is such as ``the wait here is 5 ms``.

    The result is None if the waits before the next write are long enough together, if a step polls a register before
    it, or if the procedure ends without a wait.
    """
    steps_before_next_write = list(takewhile(lambda step: step.do != "write", later_steps))
    waits = [step for step in steps_before_next_write if step.do == "wait"]
    waits_ms = [wait.at_least_ms for wait in waits if wait.at_least_ms is not None]
    polls_register = any(step.do == "poll" for step in steps_before_next_write)
    is_last_write = len(steps_before_next_write) == len(later_steps)
    total_wait_ms = sum(waits_ms)
    ends_without_wait = is_last_write and not waits_ms
    if polls_register or total_wait_ms >= needed_ms or ends_without_wait:
        return None
    if not waits_ms:
        return _ShortWait(write.path, "there is no wait here")
    return _ShortWait(waits[0].path_of("at_least_ms"), f"the wait here is {total_wait_ms} ms")


def check_opening_steps(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure writes the value that unlocks a register (``opened_by``) before it writes the register.

    Only the last of its earlier writes to the unlocking register counts. If there is none, another procedure may unlock
    the register.
    """
    register_by_name = by_name(spec.registers)
    for procedure in spec.procedures:
        argument_names = [argument.name for argument in procedure.arguments]
        for index, step in enumerate(procedure.steps):
            unlocking_write = register_of_step(step, register_by_name).opened_by
            if step.do != "write" or unlocking_write is None:
                continue
            earlier_steps = procedure.steps[:index]
            unlocking_values = [
                earlier.value for earlier in earlier_steps if _writes_to_unlocking_register(earlier, unlocking_write)
            ]
            if not unlocking_values:
                continue
            last_value = unlocking_values[-1]
            # The caller of the procedure may pass the correct value as an argument.
            if last_value != unlocking_write.value and last_value not in argument_names:
                message = (
                    f"{quoted(step.register)} must be unlocked by writing {quoted(unlocking_write.value)} to"
                    f" {quoted(unlocking_write.register)}, but {quoted(last_value)} was written there"
                )
                report.add("not-opened", step.path_of("register"), message)


def _writes_to_unlocking_register(step: WrittenStep, unlocking_write: WrittenOpenedBy) -> bool:
    """Return True if a step writes any value to the register, or to its field, that unlocks another register."""
    if step.do != "write" or not step.value or not unlocking_write.value:
        return False
    is_opening_register = bool(step.register) and step.register == unlocking_write.register
    writes_all_fields = not step.field
    return is_opening_register and (writes_all_fields or step.field == unlocking_write.field)
