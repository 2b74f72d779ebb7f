"""Rules for procedures that must agree with their registers, and with times and counts given elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import takewhile

from ..problems import DocumentReport, Path, join_words, quoted
from ..written_codes import WrittenRegister
from ..written_parts import WrittenProcedure, WrittenSpec, WrittenStep
from .parts import Groups, by_name, constant_width, fields_of, interface_name_of, is_second_reading
from .walk import leaves

#: Kinds of steps that access a register.
_KINDS_OF_ACCESS = frozenset(("write", "read", "poll"))
_MILLISECONDS_IN_TEXT = re.compile(r"(?<![\w.,])(\d+) ?ms\b")
_NUMBER_WORDS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
_REPETITIONS_IN_TEXT = re.compile(rf"\b({'|'.join(_NUMBER_WORDS)}|[1-9]\d?) requests\b", re.IGNORECASE)


def check_interface_of_steps(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure for an interface of the spec accesses only registers of this interface."""
    registers = by_name(spec.registers)
    for procedure in spec.procedures:
        if procedure.interface not in spec.interfaces.data:
            continue
        for step in procedure.steps:
            register = registers.get(step.register)
            if step.do not in _KINDS_OF_ACCESS or register is None:
                continue
            interface_of_register = interface_name_of(register)
            if interface_of_register != procedure.interface:
                message = (
                    f"{quoted(step.register)} is a register of {interface_of_register}, but the procedure is for"
                    f" {procedure.interface}; correct the interface of one of the two"
                )
                report.add("interface-mismatch", step.place_of("register"), message, cause=procedure.name)


def check_register_of_argument(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an argument of a procedure is written to the register whose limits apply to it (``of``)."""
    registers = by_name(spec.with_invalid_parts.registers)
    for procedure in spec.procedures:
        for argument in procedure.arguments:
            register_with_limits = argument.of
            writes = [step for step in procedure.steps if step.do == "write" and step.value == argument.name]
            written_names = [write.register for write in writes]
            if register_with_limits not in registers:
                continue
            if writes and register_with_limits not in written_names:
                message = (
                    f"the limits of {quoted(argument.name)} are those of {quoted(register_with_limits)}, but a step"
                    f" writes it to {quoted(written_names[0])}; correct one of the two"
                )
                report.add("argument-register", argument.place_of("of"), message)


def check_polled_values(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a step that polls a field waits for a value that fits in the field."""
    registers = by_name(spec.registers)
    groups = by_name(spec.with_invalid_parts.field_groups)
    for procedure in spec.procedures:
        for step in procedure.steps:
            register = registers.get(step.register)
            if step.do != "poll" or register is None or step.until is None:
                continue
            width = _width_of(register, step.field, groups)
            if width is None:
                continue
            bits_above_width = step.until >> width
            if bits_above_width:
                bits_text = "1 bit" if width == 1 else f"{width} bits"
                message = f"{quoted(step.field)} has {bits_text}, so it is never {step.until}"
                report.add("value-too-wide", step.place_of("until"), message)


def _width_of(register: WrittenRegister, field_name: str, groups: Groups) -> int | None:
    """Return the width of a field of a register, or None if the width is not constant or the field does not exist."""
    for field in fields_of(register, groups):
        if field.name == field_name:
            return constant_width(field)
    return None


def check_waits_of_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the waits directly after a write are together not longer than the register needs.

    A text of the procedure that contains the longer time explains it.
    """
    if is_second_reading(report.document):  # Second readings have no such texts.
        return
    registers = by_name(spec.registers)
    for procedure in spec.procedures:
        explained_ms = set(_milliseconds_in_texts(procedure))
        for write, waits in _waits_after_writes(procedure):
            needed_ms = _needed_wait(write, registers)
            waited_ms = sum(wait.at_least_ms or 0 for wait in waits)
            if needed_ms is None or waited_ms in explained_ms:
                continue
            if waited_ms > needed_ms:
                message = (
                    f"{quoted(write.register)} needs a wait of {needed_ms} ms after a write, but the wait here is"
                    f" {waited_ms} ms; correct one of the two, or say in a 'note' of the procedure why it takes"
                    f" {waited_ms} ms"
                )
                report.add("wait-mismatch", waits[0].place_of("at_least_ms"), message)


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
    registers = by_name(spec.registers)
    for procedure in spec.procedures:
        if [step.do for step in procedure.steps[-2:]] != ["wait", "write"]:
            continue
        *earlier_steps, wait, last_write = procedure.steps
        needed_ms = _needed_wait(last_write, registers)
        is_for_step_before = bool(earlier_steps) and _needed_wait(earlier_steps[-1], registers) is not None
        if needed_ms is None or is_for_step_before:
            continue
        if wait.at_least_ms == needed_ms:
            message = (
                f"{quoted(last_write.register)} needs a wait of {needed_ms} ms after a write, and the procedure waits"
                " before it; move the wait behind this step, or add another one"
            )
            report.add("wait-too-short", last_write.path, message, cause=last_write.register)


def _needed_wait(step: WrittenStep, registers: Mapping[str, WrittenRegister]) -> int | None:
    """Return the wait in ms that the register of a step needs after a write, or None if none is known."""
    register = registers.get(step.register)
    return register.wait_at_least_ms if register is not None else None


def check_intervals(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interval between the requests of a step is a shortest time in ``timings`` of RS-485.

    Nothing is checked if ``timings`` contains no shortest time.
    """
    rs485 = spec.interfaces.rs485
    shortest_times = {timing.part.at_least_us for timing in rs485.timings} if rs485 is not None else set()
    known_times_us = sorted(time_us for time_us in shortest_times if time_us is not None)
    if not known_times_us:
        return
    known_text = join_words([f"{time_us} µs" for time_us in known_times_us], "or")
    for procedure in spec.procedures:
        for step in procedure.steps:
            interval_us = step.every_at_least_us
            if interval_us is not None and interval_us not in known_times_us:
                message = (
                    f"the interval is {interval_us} µs, but the shortest time in 'timings' of rs485 is {known_text};"
                    " correct one of the two, or add the interval to 'timings'"
                )
                report.add("time-repeated", step.place_of("every_at_least_us"), message)


def check_counted_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a number of requests in the texts of a procedure is the number of times that its step sends a request.

    Only procedures with several steps are checked, exactly one of which repeats its request.
    """
    for procedure in spec.procedures:
        repeated_steps = [step for step in procedure.steps if step.times is not None]
        if len(repeated_steps) != 1 or len(procedure.steps) == 1:  # Another rule checks a procedure of one step.
            continue
        (repeated_step,) = repeated_steps
        for path, number in _counts_in_texts(procedure.data):
            if number != repeated_step.times:
                problem = f"the text says {number} requests, but 'times' is {repeated_step.times}"
                report.add("quantity-repeated", (*procedure.path, *path), f"{problem}; one of the two is wrong")


def _counts_in_texts(part_data: Mapping[str, object]) -> Iterator[tuple[Path, int]]:
    """Yield each number of requests in the texts of a procedure, with the path of its text in the procedure."""
    for path, text in leaves(part_data):
        if not isinstance(text, str):
            continue
        for number_text in _REPETITIONS_IN_TEXT.findall(text):
            if number_text.isdigit():
                yield path, int(number_text)
            else:
                yield path, _NUMBER_WORDS.index(number_text.casefold()) + 2  # The words begin with two.


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
                report.add("words-contradict", step.place_of("until"), f"{problem}; one of the two is wrong")


#: The level of a bit in a meaning such as ``0 until the value is saved``.
_LEVEL_IN_MEANING = re.compile(r"(?P<level>[01]) (?P<conjunction>until|while|during|when)\b")
