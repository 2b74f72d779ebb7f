"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..language.problems import Path
from ..model import Choice, CrcValue, Field, PlacedField, Register, Unused
from ..model.expressions import Expression
from .fact import Aspect, Key, Name, Names, Sort
from .printed_names import printed_names
from .reading import Parameters, Reading, as_delivered, bits, in_hex, over
from .stated import member_place, noun_of, stated

Found = Iterator[tuple[str, Aspect]]

_FIELDS: Key = ("field",)


class Properties:
    """The properties of the fields of one frame or register."""

    def __init__(self, reading: Reading, owner: Path, interface: str, register: Register | None = None) -> None:
        self._reading, self.owner, self.interface, self._register = reading, owner, interface, register
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

    def of(self, item: PlacedField, parameters: Parameters) -> Mapping[str, Aspect]:
        """Return all properties of a field for these parameters, by their subject."""
        return dict((*self._of_kind(item.field), *self._of_field(item, parameters)))

    def _of_kind(self, field: Field) -> Found:
        place = self.place(field)
        is_unused = isinstance(field.kind, Unused)
        for member, value in stated(self._reading, field.kind, self.interface):
            here = member_place(self._reading, place, member)
            if member.name == "makes_position":
                here = self._reading.first(here, place)
            yield member.name, Aspect(Sort(member.read), str(value), noun_of(member), here, mild=is_unused)
        if isinstance(field.kind, CrcValue):
            crc = self._reading.device.crc(field.kind.crc)
            for member, value in stated(self._reading, crc, self.interface):
                what = f"{noun_of(member)} of the CRC over {over(self.interface)}"
                here = ("crcs", crc.name, member.name)
                yield f"CRC {member.name}", Aspect(Sort(member.read), str(value), what, here, alone=True)
        for item in field.values:
            here = self._value_place(place, item.name)
            number = in_hex(item.value)
            yield f"value {item.value}", Aspect(Sort.VALUE, "named", f"value {number}", here)
            yield from self._printed(item, f"value {item.value}, ", here, f"printed name of value {number}")

    def _printed(self, item: Field | object, about: str, place: Path, what: str) -> Found:
        names = printed_names(self._reading, getattr(item, "printed_name", ""), getattr(item, "names", {}))
        for language, text in names:
            here = self._reading.name_place(place, language)
            yield f"{about}name in {language}", Aspect(Sort.PRINTED, text, what, here, mild=True)

    def _of_field(self, item: PlacedField, parameters: Parameters) -> Found:
        field, place = item.field, self.place(item.field)
        yield from self._printed(field, "", place, "printed name")
        if field.equals is not None:
            found = field.equals
            number = found.value(parameters) if isinstance(found, Expression) else found
            value = in_hex(number) if isinstance(number, int) else number
            yield "equals", Aspect(Sort.VALUE, value, "value that is always there", (*place, "equals"))
        default, is_implied = self._default(item)
        if default is not None:
            here = (*place, "default")
            yield "default", Aspect(Sort.DEFAULT, in_hex(default), "default", here, implied=is_implied)
        for member, text in stated(self._reading, field, self.interface):
            here = member_place(self._reading, place, member)
            yield member.name, Aspect(Sort(member.read), str(text), noun_of(member), here)

    def _default(self, item: PlacedField) -> tuple[int | None, bool]:
        """Return the default of a field, and True if the register's default implies it. None if both are the same."""
        own, register = item.field.default, self._register
        whole = as_delivered(register)[0] if register is not None else None
        if register is None or whole is None:
            return own, False
        if item.width == 8 * register.length or not item.field.carries_data:
            return None, False
        return (own, False) if own is not None else (whole >> item.low & (1 << item.width) - 1, True)
