"""Facts that a reader states about a part of the model, by the table of members, and about its procedures."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

from ..language.document import Path
from ..language.rules.parameters import kind_of_unit
from ..model import (
    Digits,
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Scale,
    SendStep,
    Step,
    WaitStep,
    WriteStep,
    assert_never,
)
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, Member
from ..model.record import dataclass
from .reading import Fact, Key, Reading, Sort, Value, in_hex, interface_label, register_text, short

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


_UNITS = {"mv": " mV", "us": " µs", "ms": " ms", "hz": " Hz", "ns": " ns"}


@dataclass(frozen=True)
class Subject:
    """Something that facts are about: its key without names, its place in the file, and its name in messages.

    ``interface`` determines the order codes for which its expressions have values. ``under`` is the key of the fact
    that this one depends on, by default its own. ``joint`` precedes its name.
    """

    reading: Reading
    key: Key
    place: Path
    description: str
    interface: str = ""
    under: Key | None = None
    joint: str = " of "

    def inside(self, key: Key, place: Path, description: str) -> Subject:
        """Return a part of the subject, about which there are only facts if there is the subject."""
        return Subject(self.reading, (*self.key, *key), (*self.place, *place), description, self.interface, self.key)

    def existence(self, sort: Sort, value: Value, at: str = "", name: str = "", under: Key = ()) -> Fact:
        """Return the fact that the subject exists. ``name`` is the reader's name of it."""
        place = (*self.place, at) if at else self.place
        return Fact(sort, self.key, value, self.description, place, under or self.under or (), name=name)

    def present(self, sort: Sort, model_part: Any, value: str = "present", at: str = "") -> Iterator[Fact]:
        """Yield the fact that the subject exists, and those that are stated about its ``model_part``."""
        yield self.existence(sort, value, at, getattr(model_part, "name", ""))
        yield from self.stated_facts(model_part)

    def fact(self, sort: Sort, name: str, value: Value, noun: str, at: Path | None = None, mild: bool = False) -> Fact:
        """Return another fact about the subject, which ``noun`` describes."""
        under = self.key if self.under is None else self.under
        place = (*self.place, name) if at is None else at
        return Fact(sort, (*self.key, name), value, f"{noun}{self.joint}{self.description}", place, under, mild)

    def stated_facts(self, model_part: Any, without: Collection[str] = ()) -> Iterator[Fact]:
        """Yield a fact for each stated member that the table assigns to a class of facts, and for each printed name."""
        own_names = {member_field.name for member_field in fields(model_part)}
        for member in PARTS_BY_CLASS[type(model_part).__name__].members:
            value = getattr(model_part, member.attribute) if member.read and member.attribute in own_names else None
            if member.is_stated(value) and member.name not in without:
                # The spec uses its name in the model or in the data.
                place = self.reading.first_existing((*self.place, member.attribute), (*self.place, member.name))
                text = _text(self.reading, member, value, self.interface)
                yield self.fact(Sort(member.read), member.name, text, member.noun or member.words, place)
        for language, text in self.reading.printed_names(model_part).items():
            places = (*self.place, "names", language), (*self.place, "printed_name"), self.place
            place = self.reading.first_existing(*places)
            yield self.fact(Sort.PRINTED, f"name in {language}", text, "printed name", place, mild=True)


def _text(reading: Reading, member: Member, value: Any, interface: str) -> Value:
    """Return a stated value in words without names."""
    if member.refers_to:
        return _referred_text(reading, member, value, interface)
    if isinstance(value, Expression):
        return {case: short(value.value(parameters)) for case, parameters in reading.cases(interface).items()}
    if isinstance(value, bool):
        words = {"level": ("high", "low")}.get(member.form, ("no", "yes") if "=" in member.shape else ("false", "true"))
        return words[value]
    if isinstance(value, int):
        return in_hex(value) if member.notation == "hex" else f"{value}{_UNITS.get(member.notation, '')}"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, tuple):
        return f"{' '.join(map(_part_text, value))}{_UNITS.get(member.notation, '')}"
    if isinstance(value, Scale):
        # Two readers may write the same formula with different numbers.
        factor, offset = value.quantity(1) - value.quantity(0), value.quantity(0)
        return f"number * {factor} + {offset} {value.unit}"
    if is_dataclass(value):
        return str(getattr(value, fields(value)[0].name))
    return kind_of_unit(value) if member.form == "unit" else str(value)


def _part_text(part: object) -> str:
    return str(part.digits if isinstance(part, Digits) else part)


def _referred_text(reading: Reading, member: Member, value: Any, interface: str) -> str:
    """Return the things that a member names, in words without names."""
    names = (value,) if isinstance(value, str) else value
    match member.refers_to.removesuffix("s"):
        case "register":
            texts = {_register_text(reading, name) for name in names}
        case "dotted":
            texts = {reading.bits_at(name) for name in names}
        case "procedure":
            return programs(reading, names)
        case _:
            layouts = reading.device.interface(interface).layouts
            flags = ((layout, field) for layout in layouts for field in layout.fields if field.name in names)
            texts = {bits for layout, flag in flags for bits in reading.bits_in_frames(interface, layout, flag)}
    return ", ".join(sorted(texts))


def _register_text(reading: Reading, name: str) -> str:
    """Return the address of a register, or its name if there is no such register."""
    register = reading.register(name)
    return register_text(register) if register is not None else name
