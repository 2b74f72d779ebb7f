"""Facts that follow from the table of members: each value that a reader states about one part of the model."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

from ..language.problems import Path
from ..language.rules.parameters import kind_of_unit
from ..model import Digits, Scale
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, Member
from ..model.record import dataclass
from .fact import Fact, Key, Sort, Value
from .procedures import programs
from .reading import Reading, in_hex, register_text, short

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
