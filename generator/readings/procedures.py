"""Procedures, identified by the bytes that they write, read and send. Waits and repetitions are values."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import Path
from ..model import ModifyStep, PollStep, Procedure, ReadStep, SendStep, Step, WaitStep, WriteStep, assert_never
from .fact import Fact, Key, Sort
from .reading import Reading, in_hex, interface_label, register_text

#: A fact about part of a procedure: its class, its key and its place within the procedure, its value and its name.
_Detail = tuple[Sort, Key, Path, str, str]


def procedures(reading: Reading) -> Iterator[Fact]:
    """Yield every procedure: its steps, its waits and its repetitions."""
    for procedure in reading.device.procedures:
        text = program(reading, procedure)
        key: Key = ("procedure", procedure.interface, text)
        owner: Path = ("procedures", procedure.name)
        yield Fact(
            Sort.PROCEDURE,
            key,
            text,
            f"a procedure over {interface_label(procedure.interface)}",
            owner,
            name=procedure.name,
        )
        for sort, part, place, value, description in (*_arguments(reading, procedure), *_times(reading, procedure)):
            yield Fact(sort, (*key, *part), value, description, (*owner, *place), key)


def _arguments(reading: Reading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield the registers whose limits apply to the arguments."""
    for number, argument in enumerate(procedure.arguments, 1):
        register = reading.device.register(argument.of)
        meaning = next((candidate for candidate in register.meanings if candidate.name == argument.meant_as), None)
        while_text = f" while {reading.state(meaning.when, meaning.value)}" if meaning is not None else ""
        description = f"limits of argument {number} of the procedure '{procedure.name}'"
        place = ("arguments", argument.name, "of")
        yield Sort.LIMIT, ("argument", number), place, f"{register_text(register)}{while_text}", description


def _times(reading: Reading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield the waits, the bits that are read, and the repetitions of requests."""
    done_steps, waited, before = 0, 0, "at its start"
    procedure_text = f"the procedure '{procedure.name}'"
    for index, step in enumerate(procedure.steps):
        place = ("steps", index)
        if isinstance(step, WaitStep):
            waited += step.microseconds
            if not isinstance(next(iter(procedure.steps[index + 1 :]), None), WaitStep):
                description = f"wait {before} in {procedure_text}"
                yield Sort.WAIT, ("wait", done_steps), (*place, "at_least_ms"), f"{waited // 1000} ms", description
            continue
        text = f"'{_step_text(reading, step, procedure)}'"
        done_steps, waited, before = done_steps + 1, 0, f"after {text}"
        if isinstance(step, ReadStep) and step.field:
            bits = _bits(reading, step.register, step.field)
            yield Sort.PROCEDURE, ("bits", done_steps), (*place, "field"), bits, f"bits used by {text}"
        if isinstance(step, SendStep):
            request_text, path = f"{text} in {procedure_text}", (*place, "every_at_least_us")
            yield (
                Sort.PROCEDURE,
                ("times", done_steps),
                (*place, "times"),
                str(step.times),
                f"repetitions of {request_text}",
            )
            if step.microseconds:
                yield Sort.WAIT, ("every", done_steps), path, f"{step.microseconds} µs", f"interval of {request_text}"
            if step.in_succession:
                yield (
                    Sort.PROCEDURE,
                    ("succession", done_steps),
                    (*place, "in_succession"),
                    "yes",
                    f"succession of {request_text}",
                )


def program(reading: Reading, procedure: Procedure) -> str:
    """Return the steps of a procedure as text, without waits and repetitions."""
    texts = (_step_text(reading, step, procedure) for step in procedure.steps)
    return "; ".join(text for text in texts if text)


def _step_text(reading: Reading, step: Step, procedure: Procedure) -> str:
    match step:
        case WriteStep(register, name, value):
            written = reading.device.register(register)
            text = written.bytes_of(value).hex(" ").upper() if value is not None else _argument(procedure, name)
            return f"write {_bits(reading, register, '')} = {text}"
        case ModifyStep(register, field, name, value):
            text = in_hex(value) if value is not None else _argument(procedure, name)
            return f"set {_bits(reading, register, field)} to {text}"
        case ReadStep(register):
            return f"read {_bits(reading, register, '')}"
        case PollStep(register, field, value):
            return f"poll {_bits(reading, register, field)} until {value}"
        case SendStep():
            return f"send {step.request.hex(' ').upper()}"
        case WaitStep():
            return ""
        case _:
            assert_never(step)


def _argument(procedure: Procedure, name: str) -> str:
    """Return an argument by its number among the arguments."""
    names = [argument.name for argument in procedure.arguments]
    return f"argument {names.index(name) + 1}" if name in names else name


def _bits(reading: Reading, name: str, field: str) -> str:
    """Return a register, and its bits if the step does not use all of them."""
    register = reading.device.register(name)
    used_field = next((candidate for candidate in register.layout.fields if candidate.name == field), None)
    bits_text = f" {reading.bits_of(register.interface, used_field)}" if used_field is not None else ""
    if used_field is not None and used_field.width.is_constant and used_field.width.constant == 8 * register.length:
        bits_text = ""
    return f"{register_text(register).removeprefix('register ')}{bits_text}"


def programs(reading: Reading, names: tuple[str, ...]) -> str:
    """Return the steps of several procedures as text, in a fixed order."""
    procedures_by_name = {procedure.name: procedure for procedure in reading.device.procedures}
    return " | ".join(
        sorted(program(reading, procedures_by_name[name]) for name in names if name in procedures_by_name)
    )
