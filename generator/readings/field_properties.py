"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from ..language.problems import Path
from ..model import Choice, CrcValue, Field, PlacedField, Register, Unused
from .fact import Fact, Key, Name, Names, Sort
from .reading import Parameters, Reading, as_delivered, bits, in_hex, over
from .stated import Subject

_FIELDS: Key = ("field",)


class Properties:
    """The properties of the fields of one frame or register."""

    def __init__(
        self, reading: Reading, owner: Path, interface: str, what: str, register: Register | None = None
    ) -> None:
        self._reading, self.owner, self.interface, self.what, self._register = reading, owner, interface, what, register
        self._places: dict[str, Path] = {}

    def place(self, field: Field) -> Path:
        """Return the place of the field in the spec."""
        if field.name not in self._places:
            self._places[field.name] = self._reading.field_place(self.owner, field)
        return self._places[field.name]

    def add_names(self, item: PlacedField, names: dict[Key, Names]) -> None:
        """Add the names of the field and of its values."""
        field, place = item.field, self.place(item.field)
        where = f"{bits(item.high, item.low)} of '{self.owner[-1]}'"
        if place[-2:] == ("fields", field.name):
            name = Name(Sort.POSITION, field.name, f"name of {where}", (*place, "name"))
            names.setdefault(_FIELDS, {})[item.low, item.width] = name
        if isinstance(field.kind, Choice):
            values = names.setdefault(("value", item.low, item.width), {})
            for value in field.values:
                what = f"name of value {in_hex(value.value)} of {where}"
                values[value.value,] = Name(Sort.VALUE, value.name, what, self._value_place(place, value.name))

    def _value_place(self, place: Path, name: str) -> Path:
        return self._reading.first((*place, "values", name), place)

    def of(self, item: PlacedField, parameters: Parameters) -> Mapping[Key, Fact]:
        """Return all properties of a field for these parameters, by their keys."""
        where = f"{bits(item.high, item.low)} of {self.what}"
        subject = Subject(self._reading, (), self.place(item.field), where, self.interface)
        found = (*self._of_kind(subject, item.field), *self._of_field(subject, item, parameters))
        return {fact.key: fact for fact in found}

    def _of_kind(self, subject: Subject, field: Field) -> Iterator[Fact]:
        for fact in subject.stated(field.kind):
            # The verdict of a flag that the interface defines is not in the spec.
            is_verdict = fact.sort is Sort.VERDICT
            place = self._reading.first(fact.place, subject.place) if is_verdict else fact.place
            yield replace(fact, place=place, mild=is_verdict and isinstance(field.kind, Unused))
        if isinstance(field.kind, CrcValue):
            what = f"the CRC over {over(self.interface)}"
            crc = Subject(self._reading, ("crc",), ("crcs", field.kind.crc), what)
            yield from crc.stated(self._reading.device.crc(field.kind.crc))
        for item in field.values:
            place, what = self._value_place(subject.place, item.name), f"value {in_hex(item.value)} of {subject.what}"
            value = Subject(self._reading, ("value", item.value), place, what)
            yield value.first(Sort.VALUE, "named")
            yield from value.stated(item)

    def _of_field(self, subject: Subject, item: PlacedField, parameters: Parameters) -> Iterator[Fact]:
        field = item.field
        if field.equals is not None:
            number = field.documented(parameters)
            value = in_hex(number) if isinstance(number, int) else str(number)
            yield subject.fact(Sort.VALUE, "equals", value, "fixed value")
        default, is_implied = self._default(item)
        if default is not None:
            yield replace(subject.fact(Sort.DEFAULT, "default", in_hex(default), "default"), implied=is_implied)
        yield from subject.stated(field)

    def _default(self, item: PlacedField) -> tuple[int | None, bool]:
        """Return the default of a field, and True if the register's default implies it. None if both are the same."""
        own, register = item.field.default, self._register
        whole = as_delivered(register)[0] if register is not None else None
        if register is None or whole is None:
            return own, False
        if item.width == 8 * register.length or not item.field.carries_data:
            return None, False
        return (own, False) if own is not None else (whole >> item.low & (1 << item.width) - 1, True)
