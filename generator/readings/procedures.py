"""Procedures, identified by the bytes that they write, read and send. Waits and repetitions are values."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import Path
from ..model import ModifyStep, PollStep, Procedure, ReadStep, SendStep, Step, WaitStep, WriteStep, assert_never
from .fact import Fact, Key, Sort
from .reading import Reading, at, in_hex, over

#: A fact about part of a procedure: its class, its key and its place within the procedure, its value and its name.
_Detail = tuple[Sort, Key, Path, str, str]


def procedures(reading: Reading) -> Iterator[Fact]:
    """Yield every procedure: its steps, its waits and its repetitions."""
    for item in reading.device.procedures:
        text = program(reading, item)
        key: Key = ("procedure", item.interface, text)
        owner: Path = ("procedures", item.name)
        yield Fact(Sort.PROCEDURE, key, text, f"a procedure over {over(item.interface)}", owner, name=item.name)
        for sort, part, place, value, what in (*_arguments(reading, item), *_times(reading, item)):
            yield Fact(sort, (*key, *part), value, what, (*owner, *place), key)


def _arguments(reading: Reading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield the registers whose limits apply to the arguments."""
    for number, item in enumerate(procedure.arguments, 1):
        register = reading.device.register(item.of)
        meaning = next((found for found in register.meanings if found.name == item.meant_as), None)
        held = f" while {reading.state(meaning.when, meaning.value)}" if meaning is not None else ""
        what = f"limits of argument {number} of the procedure '{procedure.name}'"
        place = ("arguments", item.name, "of")
        yield Sort.LIMIT, ("argument", number), place, f"{at(register)}{held}", what


def _times(reading: Reading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield the waits, the bits that are read, and the repetitions of requests."""
    done, waited, before = 0, 0, "at its start"
    called = f"the procedure '{procedure.name}'"
    for index, step in enumerate(procedure.steps):
        place = ("steps", index)
        if isinstance(step, WaitStep):
            waited += step.microseconds
            if not isinstance(next(iter(procedure.steps[index + 1 :]), None), WaitStep):
                what = f"wait {before} in {called}"
                yield Sort.WAIT, ("wait", done), (*place, "at_least_ms"), f"{waited // 1000} ms", what
            continue
        text = f"'{_done(reading, step, procedure)}'"
        done, waited, before = done + 1, 0, f"after {text}"
        if isinstance(step, ReadStep) and step.field:
            bits = _bits(reading, step.register, step.field)
            yield Sort.PROCEDURE, ("bits", done), (*place, "field"), bits, f"bits used by {text}"
        if isinstance(step, SendStep):
            sent, every = f"{text} in {called}", (*place, "every_at_least_us")
            yield Sort.PROCEDURE, ("times", done), (*place, "times"), str(step.times), f"repetitions of {sent}"
            if step.microseconds:
                yield Sort.WAIT, ("every", done), every, f"{step.microseconds} µs", f"interval of {sent}"
            if step.in_succession:
                yield Sort.PROCEDURE, ("succession", done), (*place, "in_succession"), "yes", f"succession of {sent}"


def program(reading: Reading, procedure: Procedure) -> str:
    """Return the steps of a procedure as text, without waits and repetitions."""
    done = (_done(reading, step, procedure) for step in procedure.steps)
    return "; ".join(text for text in done if text)


def _done(reading: Reading, step: Step, procedure: Procedure) -> str:
    match step:
        case WriteStep(register, name, value):
            found = reading.device.register(register)
            text = found.bytes_of(value).hex(" ").upper() if value is not None else _argument(procedure, name)
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
    names = [item.name for item in procedure.arguments]
    return f"argument {names.index(name) + 1}" if name in names else name


def _bits(reading: Reading, name: str, field: str) -> str:
    """Return a register, and its bits if the step does not use all of them."""
    register = reading.device.register(name)
    found = next((item for item in register.layout.fields if item.name == field), None)
    where = f" {reading.bits_of(register.interface, found)}" if found is not None else ""
    if found is not None and found.width.is_constant and found.width.constant == 8 * register.length:
        where = ""
    return f"{at(register).removeprefix('register ')}{where}"


def programs(reading: Reading, names: tuple[str, ...]) -> str:
    """Return the steps of several procedures as text, in a fixed order."""
    known = {item.name: item for item in reading.device.procedures}
    return " | ".join(sorted(program(reading, known[name]) for name in names if name in known))
