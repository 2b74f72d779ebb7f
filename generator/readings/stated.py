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
from .printed_names import printed_names
from .procedures import programs
from .reading import Reading, at, in_hex, short

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
    what: str
    interface: str = ""
    under: Key | None = None
    joint: str = " of "

    def first(self, sort: Sort, value: Value, at: str = "", name: str = "", under: Key = ()) -> Fact:
        """Return the fact that the subject exists. ``name`` is the reader's name of it."""
        return Fact(sort, self.key, value, self.what, (*self.place, at) if at else self.place, under, name=name)

    def fact(self, sort: Sort, name: str, value: Value, noun: str, at: Path | None = None, mild: bool = False) -> Fact:
        """Return another fact about the subject, which ``noun`` describes."""
        under = self.key if self.under is None else self.under
        place = (*self.place, name) if at is None else at
        return Fact(sort, (*self.key, name), value, f"{noun}{self.joint}{self.what}", place, under, mild)

    def stated(self, item: Any, without: Collection[str] = ()) -> Iterator[Fact]:
        """Yield a fact for each stated member that the table assigns to a class of facts, and for each printed name."""
        for member, value in _stated(self.reading, item, self.interface):
            if member.name not in without:
                # The spec uses its name in the model or in the data.
                place = self.reading.first((*self.place, member.attribute), (*self.place, member.name))
                yield self.fact(Sort(member.read), member.name, value, member.noun or member.words, place)
        names = printed_names(self.reading, getattr(item, "printed_name", ""), getattr(item, "names", {}))
        for language, text in names:
            place = self.reading.name_place(self.place, language)
            yield self.fact(Sort.PRINTED, f"name in {language}", text, "printed name", place, mild=True)


def _stated(reading: Reading, item: Any, interface: str) -> Iterator[tuple[Member, Value]]:
    """Yield the stated members of a part of the model with their values, in words without names."""
    own = {each.name for each in fields(item)}
    for member in PARTS_BY_CLASS[type(item).__name__].members:
        if member.read and member.attribute in own:
            value = getattr(item, member.attribute)
            if member.is_stated(value):
                yield member, _text(reading, member, value, interface)


def _text(reading: Reading, member: Member, value: Any, interface: str) -> Value:
    if member.refers_to:
        return _referred(reading, member, value, interface)
    if isinstance(value, Expression):
        return {case: short(value.value(each)) for case, each in reading.cases(interface).items()}
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
        return " ".join(str(one.digits) if isinstance(one, Digits) else str(one) for one in value)
    if isinstance(value, Scale):
        # Two readers may write the same formula with different numbers.
        factor, offset = value.quantity(1) - value.quantity(0), value.quantity(0)
        return f"number * {factor} + {offset} {value.unit}"
    if is_dataclass(value):
        return str(getattr(value, fields(value)[0].name))
    return kind_of_unit(value) if member.form == "unit" else str(value)


def _referred(reading: Reading, member: Member, value: Any, interface: str) -> str:
    """Return the things that a member names, in words without names."""
    names = (value,) if isinstance(value, str) else value
    match member.refers_to.removesuffix("s"):
        case "register":
            found = ((name, reading.register(name)) for name in names)
            texts = {at(register) if register is not None else name for name, register in found}
        case "dotted":
            texts = {reading.bits_at(name) for name in names}
        case "procedure":
            return programs(reading, names)
        case _:
            texts = {place for name in names for place in reading.flag_places(interface, name)}
    return ", ".join(sorted(texts))
