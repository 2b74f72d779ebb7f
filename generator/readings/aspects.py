"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..language.problems import Path
from ..language.rules.parameters import kind_of_unit
from ..model import Choice, Crc, CrcValue, Decimal, Field, Flag, Number, PlacedField, Register, Unused
from ..model.expressions import Expression
from .fact import Aspect, Key, Name, Names, Sort
from .printed import printed_names
from .reading import Parameters, Reading, as_delivered, bits, in_hex, over

Said = Iterator[tuple[str, Aspect]]

_FIELDS: Key = ("field",)


class Aspects:
    """The aspects of the fields of one frame or register."""

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
        where = f"name of {bits(item.high, item.low)} of '{self.owner[-1]}'"
        if place[-2:] == ("fields", field.name):
            names.setdefault(_FIELDS, {})[item.low, item.width] = Name(
                Sort.POSITION, field.name, where, (*place, "name")
            )
        if isinstance(field.kind, Choice):
            values = names.setdefault(("value", item.low, item.width), {})
            for value in field.values:
                here = self._reading.first((*place, "values", value.name), place)
                what = f"name of value {in_hex(value.value)} {where.removeprefix('name ')}"
                values[value.value,] = Name(Sort.VALUE, value.name, what, here)

    def of(self, item: PlacedField, parameters: Parameters) -> Mapping[str, Aspect]:
        """Return all properties of a field for these parameters, by their subject."""
        return dict((*self._of_kind(item), *self._of_field(item, parameters)))

    def _of_kind(self, item: PlacedField) -> Said:
        match item.field.kind:
            case Number() as number:
                yield from self._of_number(item.field, number)
            case Flag() as flag:
                yield from self._of_flag(item.field, flag)
            case Unused() as unused:
                place = self.place(item.field)
                value = unused.makes_position.value
                yield "worth", Aspect(Sort.VERDICT, value, "verdict on the position", place, mild=True)
            case Choice():
                yield from self._of_values(item.field)
            case CrcValue(name):
                yield from crc_aspects(self._reading.device.crc(name), self.interface)
            case Decimal(runs):
                place = (*self.place(item.field), "digits")
                yield "digits", Aspect(Sort.VALUE, " ".join(str(run.digits) for run in runs), "digits", place)

    def _of_number(self, field: Field, number: Number) -> Said:
        place = self.place(field)
        if number.zero_means:
            value = str(number.zero_means)
            yield "zero", Aspect(Sort.POSITION, value, "meaning of 0", (*place, "zero_means"))
        if number.power_of_two:
            yield "powers", Aspect(Sort.LIMIT, "only powers of two", "values", (*place, "power_of_two"))

    def _of_flag(self, field: Field, flag: Flag) -> Said:
        place = self.place(field)
        level = "low" if flag.active_low else "high"
        yield "level", Aspect(Sort.POSITION, level, "active level", (*place, "active"))
        if flag.makes_position is not None:
            value = flag.makes_position.value
            key = self._reading.first((*place, "makes_position"), place)
            yield "worth", Aspect(Sort.VERDICT, value, "verdict on the position", key)
        if flag.only:
            yield "only", Aspect(Sort.BEHAVIOUR, flag.only, "order codes that have it", (*place, "only"))
        if flag.sums_up:
            value = ", ".join(sorted({place for name in flag.sums_up for place in self._flag_at(name)}))
            yield "sum", Aspect(Sort.BEHAVIOUR, value, "flags that it combines", (*place, "sums_up"))

    def _flag_at(self, name: str) -> Iterator[str]:
        """Yield the bit of a flag in each frame of the same interface that has it."""
        for layout in self._reading.device.interface(self.interface).layouts:
            for field in layout.fields:
                if field.name == name:
                    yield from self._reading.bits_in_frames(self.interface, layout, field)

    def _of_values(self, field: Field) -> Said:
        place = self.place(field)
        for item in field.values:
            here = self._reading.first((*place, "values", item.name), place)
            number = in_hex(item.value)
            yield f"value {item.value}", Aspect(Sort.VALUE, "named", f"value {number}", here)
            names = printed_names(self._reading, item.printed_name, item.names)
            for language, text in names:
                about = f"name of value {item.value} in {language}"
                printed = self._reading.name_place(here, language)
                yield about, Aspect(Sort.PRINTED, text, f"printed name of value {number}", printed, mild=True)

    def _of_field(self, item: PlacedField, parameters: Parameters) -> Said:
        field, place = item.field, self.place(item.field)
        for language, text in printed_names(self._reading, field.printed_name, field.names):
            here = self._reading.name_place(place, language)
            yield f"name in {language}", Aspect(Sort.PRINTED, text, "printed name", here, mild=True)
        if field.equals is not None:
            found = field.equals
            number = found.value(parameters) if isinstance(found, Expression) else found
            value = in_hex(number) if isinstance(number, int) else number
            yield "equals", Aspect(Sort.VALUE, value, "value that is always there", (*place, "equals"))
        default, implied = self._default(item)
        if default is not None:
            here = (*place, "default")
            yield "default", Aspect(Sort.DEFAULT, in_hex(default), "default", here, implied=implied)
        yield from self._of_encoder(field, place)

    def _default(self, item: PlacedField) -> tuple[int | None, bool]:
        """Return the default of a field, and True if the register's default implies it. None if both are the same."""
        own, register = item.field.default, self._register
        whole = as_delivered(register)[0] if register is not None else None
        if register is None or whole is None:
            return own, False
        if item.width == 8 * register.length or not item.field.carries_data:
            return None, False
        return (own, False) if own is not None else (whole >> item.low & (1 << item.width) - 1, True)

    def _of_encoder(self, field: Field, place: Path) -> Said:
        """Yield whether the encoder implements it, and who may use it."""
        if not field.implemented:
            yield "implemented", Aspect(Sort.BEHAVIOUR, "no", "presence in this encoder", (*place, "implemented"))
        if field.reserved:
            yield "reserved", Aspect(Sort.BEHAVIOUR, field.reserved, "user", (*place, "reserved"))
        if field.explained_by:
            value = ", ".join(sorted(map(self._reading.bits_at, field.explained_by)))
            yield "explained", Aspect(Sort.BEHAVIOUR, value, "bits that give details", (*place, "explained_by"))
        if field.unit:
            yield "unit", Aspect(Sort.VALUE, kind_of_unit(field.unit), "unit", (*place, "unit"))


def crc_aspects(crc: Crc, interface: str, of: str = "the CRC") -> Said:
    """Yield the parameters of a CRC."""
    numbers = {
        "width": str(crc.width),
        "poly": in_hex(crc.poly),
        "init": in_hex(crc.init),
        "xorout": in_hex(crc.xorout),
    }
    turned = {"refin": str(crc.refin).lower(), "refout": str(crc.refout).lower()}
    for name, value in {**numbers, **turned}.items():
        what = f"{name} of {of} over {over(interface)}"
        yield f"CRC {name}", Aspect(Sort.CRC, value, what, ("crcs", crc.name, name), alone=True)
