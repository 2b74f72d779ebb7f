"""Procedures, identified by the bytes that they write, read and send. Waits and repetitions are values."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import Path
from ..model import (
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    SendStep,
    Step,
    WaitStep,
    WriteStep,
    assert_never,
)
from .fact import Fact, Key, Sort
from .reading import Reading, at, in_hex, over


def procedures(reading: Reading) -> Iterator[Fact]:
    """Yield every procedure: its steps, its waits and its repetitions."""
    for item in reading.device.procedures:
        text = program(reading, item)
        key: Key = ("procedure", item.interface, text)
        owner: Path = ("procedures", item.name)
        yield Fact(Sort.PROCEDURE, key, text, f"a procedure over {over(item.interface)}", owner, name=item.name)
        yield from _arguments(reading, item, key, owner)
        yield from _times(reading, item, key, owner)


def _arguments(reading: Reading, procedure: Procedure, key: Key, owner: Path) -> Iterator[Fact]:
    """Yield the registers whose limits apply to the arguments."""
    for number, item in enumerate(procedure.arguments, 1):
        register = reading.device.register(item.of)
        meaning = next((found for found in register.meanings if found.name == item.meant_as), None)
        held = f" while {reading.state(meaning.when, meaning.value)}" if meaning is not None else ""
        what = f"limits of argument {number} of the procedure '{procedure.name}'"
        place: Path = (*owner, "arguments", item.name, "of")
        yield Fact(Sort.LIMIT, (*key, "argument", number), f"{at(register)}{held}", what, place, key)


def program(reading: Reading, procedure: Procedure) -> str:
    """Return the steps of a procedure as text, without waits and repetitions."""
    done = (_done(reading, step, procedure) for step in procedure.steps)
    return "; ".join(text for text in done if text)


def _done(reading: Reading, step: Step, procedure: Procedure) -> str:
    match step:
        case WriteStep(register, name, value):
            found = reading.device.register(register)
            return f"write {_bytes(found, value, _argument(procedure, name))}"
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


def _bytes(register: Register, value: int | None, argument: str) -> str:
    """Return text such as ``0x4B = 10 00 00``."""
    text = register.bytes_of(value).hex(" ").upper() if value is not None else argument
    return f"{at(register).removeprefix('register ')} = {text}"


def _bits(reading: Reading, name: str, field: str) -> str:
    """Return a register, and its bits if the step does not use all of them."""
    register = reading.device.register(name)
    found = next((item for item in register.layout.fields if item.name == field), None)
    where = f" {reading.bits_of(register.interface, found)}" if found is not None else ""
    if found is not None and found.width.is_constant and found.width.constant == 8 * register.length:
        where = ""
    return f"{at(register).removeprefix('register ')}{where}"


def _times(reading: Reading, procedure: Procedure, key: Key, owner: Path) -> Iterator[Fact]:
    done, waited, before = 0, 0, "at its start"
    called = f"the procedure '{procedure.name}'"
    for index, step in enumerate(procedure.steps):
        place: Path = (*owner, "steps", index)
        if isinstance(step, WaitStep):
            waited += step.microseconds
            if not isinstance(next(iter(procedure.steps[index + 1 :]), None), WaitStep):
                value, what = f"{waited // 1000} ms", f"wait {before} in {called}"
                yield Fact(Sort.WAIT, (*key, "wait", done), value, what, (*place, "at_least_ms"), key)
            continue
        done, waited = done + 1, 0
        if isinstance(step, ReadStep) and step.field:
            here, what = (*place, "field"), f"bits used by '{_done(reading, step, procedure)}'"
            yield Fact(Sort.PROCEDURE, (*key, "bits", done), _bits(reading, step.register, step.field), what, here, key)
        before = f"after '{_done(reading, step, procedure)}'"
        if isinstance(step, SendStep):
            sent = f"'{_done(reading, step, procedure)}' in {called}"
            yield Fact(
                Sort.PROCEDURE, (*key, "times", done), str(step.times), f"repetitions of {sent}", (*place, "times"), key
            )
            if step.microseconds:
                here, value = (*place, "every_at_least_us"), f"{step.microseconds} µs"
                yield Fact(Sort.WAIT, (*key, "every", done), value, f"interval of {sent}", here, key)
            if step.in_succession:
                here = (*place, "in_succession")
                yield Fact(Sort.PROCEDURE, (*key, "succession", done), "yes", f"succession of {sent}", here, key)


def programs(reading: Reading, names: tuple[str, ...]) -> str:
    """Return the steps of several procedures as text, in a fixed order."""
    known = {item.name: item for item in reading.device.procedures}
    return " | ".join(sorted(program(reading, known[name]) for name in names if name in known))
