"""Iterators over the parts of a spec, shared by several rules.

Rules check the valid parts of a spec. They look up names in ``spec.with_invalid_parts``, because a name is still
defined if something else about its part is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from itertools import islice
from types import MappingProxyType
from typing import NamedTuple, Protocol, TypeVar

from ...model import INTERFACES, Alarm, Biss, Clock, Timing
from ...model.measurement import Measurement
from ..document import Document
from ..files import is_second
from ..keys_of_fields import WrittenField, WrittenFieldGroup, WrittenLayout, WrittenRegister
from ..keys_of_order_codes import (
    WrittenBiss,
    WrittenControlData,
    WrittenParameter,
    WrittenRs485,
    WrittenSpi,
    WrittenSsi,
)
from ..keys_of_specs import WrittenSpec, WrittenStep
from ..problems import DocumentReport, Path
from ..written import LocatedPart

#: A rule, called with a spec that contains only valid parts, and the report to which it adds problems.
Rule = Callable[[WrittenSpec, DocumentReport], None]
WrittenInterface = WrittenSsi | WrittenBiss | WrittenRs485 | WrittenSpi
#: Owner of a list of fields.
Owner = WrittenLayout | WrittenRegister | WrittenFieldGroup | WrittenControlData
Groups = Mapping[str, WrittenFieldGroup]

#: An interface that does not exist has layouts too, so that their names are known.
_INTERFACE_CLASSES: Mapping[str, type[WrittenInterface]] = MappingProxyType(
    {"ssi": WrittenSsi, "biss": WrittenBiss, "rs485": WrittenRs485, "spi": WrittenSpi}
)
#: Lists and maps that the path of an erratum omits, because their items are identified by name.
KEYS_OMITTED_BY_ERRATA = frozenset(
    "layouts fields combinations values parts steps arguments meanings data_ids contacts timings".split()
)
#: Largest number of fields of a layout or register, including the fields of its groups. Without groups, the schema
#: limits it.
MAX_FIELDS = 512
#: The place of a field with several bits, such as ``7:6``.
_BIT_RANGE_TEXT = re.compile(r"([0-9]{1,4}):([0-9]{1,4})")


class PlacedPart(Protocol):
    """A part with its place and its data."""

    @property
    def path(self) -> Path: ...

    @property
    def data(self) -> Mapping[str, object]: ...

    def has(self, name: str, /) -> bool: ...


class NamedPart(Protocol):
    """A part with a name."""

    name: str

    def is_valid(self, name: str) -> bool: ...


class NamedModelPart(Protocol):
    """A part of the model with a name."""

    @property
    def name(self) -> str: ...


_Named = TypeVar("_Named", bound=NamedPart)
_NamedModelPart = TypeVar("_NamedModelPart", bound=NamedModelPart)


def by_name(parts: Iterable[_Named]) -> dict[str, _Named]:
    """Return parts by name. Parts without a valid name are left out, and so are later parts with the same name."""
    part_by_name: dict[str, _Named] = {}
    for part in parts:
        if part.is_valid("name"):
            part_by_name.setdefault(part.name, part)
    return part_by_name


def by_part_name(parts: Iterable[LocatedPart[_NamedModelPart]]) -> dict[str, LocatedPart[_NamedModelPart]]:
    """Return parts of the model by name.

    Parts without a valid name are left out, and so are later parts with the same name.
    """
    part_by_name: dict[str, LocatedPart[_NamedModelPart]] = {}
    for located_part in parts:
        if located_part.is_valid("name"):
            part_by_name.setdefault(located_part.part.name, located_part)
    return part_by_name


def interfaces(spec: WrittenSpec) -> Iterator[tuple[str, WrittenInterface]]:
    """Yield the name of each interface of a spec with the interface, in the order of the spec."""
    for name, data in spec.interfaces.data.items():
        interface_class = _INTERFACE_CLASSES.get(name, WrittenSsi)
        yield name, interface_class(data, ("interfaces", name))


class FieldOwner(Enum):
    """Owners of a list of fields, by their key."""

    LAYOUT = "layouts"
    REGISTER = "registers"
    GROUP = "field_groups"
    CONTROL = "control_data"


@dataclass(frozen=True, slots=True)
class FieldList:
    """A list of fields with its owner, the kind of its owner and its interface, which is empty for groups."""

    owner_kind: FieldOwner
    owner: Owner
    interface: str

    @property
    def fields(self) -> tuple[WrittenField, ...]:
        """The fields as listed, with ``use`` as a separate field."""
        return self.owner.fields

    @property
    def name(self) -> str:
        """Name of the owner. Control data have none."""
        return "" if isinstance(self.owner, WrittenControlData) else self.owner.name

    @property
    def layout(self) -> WrittenLayout | None:
        """The owner, if it is a layout."""
        return self.owner if isinstance(self.owner, WrittenLayout) else None

    @property
    def is_from_encoder(self) -> bool:
        """True for a frame that an encoder sends."""
        return self.layout is not None and self.layout.from_ == "encoder"

    @property
    def is_written_by_master(self) -> bool:
        """True for a frame that a master sends, and for a register that it can write."""
        if isinstance(self.owner, WrittenRegister):
            return self.owner.has("access") and self.owner.access != "read_only"
        return self.layout is not None and self.layout.from_ == "master"

    @property
    def joins(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the joined fields, by the name of the joined number. Groups and control data have none."""
        return self.owner.join if isinstance(self.owner, WrittenLayout | WrittenRegister) else MappingProxyType({})

    @property
    def selectors(self) -> Mapping[str, tuple[int, ...]]:
        """The values by which a frame is identified, by the name of the field that has them. Empty if there is none."""
        return self.layout.when if self.layout is not None else MappingProxyType({})


def layouts_of_interfaces(spec: WrittenSpec) -> Iterator[FieldList]:
    """Yield the layouts of all interfaces."""
    for name, interface in interfaces(spec):
        for layout in interface.layouts:
            yield FieldList(FieldOwner.LAYOUT, layout, name)


def field_lists(spec: WrittenSpec) -> Iterator[FieldList]:
    """Yield every list of fields: of groups, layouts, control data and registers, in the order of the language."""
    for group in spec.field_groups:
        yield FieldList(FieldOwner.GROUP, group, interface="")
    yield from layouts_of_interfaces(spec)
    for name, interface in interfaces(spec):
        # Only BiSS has control data. An interface with an unknown name, which is reported, may be BiSS.
        control_data = WrittenBiss(interface.data, interface.path).control_data
        if control_data is not None and control_data.is_given:
            yield FieldList(FieldOwner.CONTROL, control_data, name)
    for register in spec.registers:
        if register.has("fields"):
            yield FieldList(FieldOwner.REGISTER, register, interface_name_of(register))


def interface_name_of(register: WrittenRegister | None) -> str:
    """Return the name of the interface of a register. It is BiSS for a register without one, and for None."""
    return Biss.name if register is None else str(register.data.get("interface", Biss.name))


#: Represents a register that does not exist.
NO_REGISTER = WrittenRegister({})
Registers = Mapping[str, WrittenRegister]


def register_of_step(step: WrittenStep, register_by_name: Registers) -> WrittenRegister:
    """Return the register that a step accesses, or an empty register if it accesses none or it does not exist."""
    return register_by_name.get(step.register, NO_REGISTER)


def last_address(register: WrittenRegister) -> int:
    """Return the last address of a register, or its only one if the interface has no address for each byte."""
    interface = INTERFACES.get(interface_name_of(register))
    if interface is not None and not interface.byte_addresses:
        return register.address
    return register.address + register.length - 1


def with_groups_expanded(field_list: FieldList, group_by_name: Groups) -> Iterator[tuple[Path, WrittenField]]:
    """Yield the fields of a layout, register or group with their paths, and the fields of a group where it is used.

    A field from a group has the path of the field that includes the group. Fields beyond the limit, which another rule
    reports, are omitted.
    """
    return islice(_expand_groups(field_list, group_by_name), MAX_FIELDS)


def _expand_groups(field_list: FieldList, group_by_name: Groups) -> Iterator[tuple[Path, WrittenField]]:
    """Yield the fields with their paths, and the fields of a group where it is used, without a limit."""
    for field in field_list.fields:
        group = group_by_name.get(field.use)
        if group is None:
            yield field.path, field
        else:
            for group_field in group.fields:
                yield field.path, group_field


def fields_by_name(field_list: FieldList, group_by_name: Groups) -> dict[str, WrittenField]:
    """Return the fields of a layout, register or group by name, including the fields of groups that it uses."""
    located_fields = with_groups_expanded(field_list, group_by_name)
    return {field.name: field for _, field in located_fields if field.name}


def readable_names(field_list: FieldList, group_by_name: Groups) -> list[str]:
    """Return the names of all values that a decoder returns: fields, joined numbers and groups of digits.

    A register without fields is one number with its own name.
    """
    if field_list.owner_kind is FieldOwner.REGISTER and not field_list.owner.has("fields"):
        return [field_list.name]
    field_by_name = fields_by_name(field_list, group_by_name)
    # A join with a wrong value is reported, but its name is known.
    names = [*field_by_name, *field_list.owner.names_in("join")]
    for field in field_by_name.values():
        names += [digit_group.part.name for digit_group in field.digits if digit_group.part.name]
    return names


def keys_of_origin(parameter: WrittenParameter) -> list[str]:
    """Return the keys of a parameter that say where its value comes from, such as ``equals`` for an expression.

    The list is empty if order codes set the parameter.
    """
    origin_by_key = {"equals": parameter.equals, "read_from": parameter.read_from, "alternative": parameter.alternative}
    return [key for key, origin in origin_by_key.items() if origin not in (None, "")]


def clocks_of(interface: WrittenInterface) -> tuple[LocatedPart[Clock], ...]:
    """Return the clocks of an interface: several if they depend on the order code, and none for RS-485."""
    return () if isinstance(interface, WrittenRs485) else interface.clock


class RestrictedPart(Protocol):
    """A part of the model with the order codes to which it applies."""

    @property
    def only(self) -> str: ...


def share_order_codes(fact: RestrictedPart, other_fact: RestrictedPart) -> bool:
    """Return True if two facts certainly apply to a common order code.

    This is the case if they have the same patterns of order codes (``only``), or if one of them applies to all codes.
    """
    applies_to_all_codes = not fact.only or not other_fact.only
    return applies_to_all_codes or fact.only == other_fact.only


def timings(spec: WrittenSpec) -> Iterator[LocatedPart[Timing]]:
    """Yield the timings of all interfaces, then those of the device as a whole."""
    for _, interface in interfaces(spec):
        yield from interface.timings
    yield from spec.timings


def measurements(spec: WrittenSpec) -> Iterator[LocatedPart[Measurement]]:
    """Yield the measurements of the device and its interfaces."""
    if spec.measurement is not None and spec.measurement.is_given:
        yield spec.measurement
    for _, interface in interfaces(spec):
        if interface.measurement is not None and interface.measurement.is_given:
            yield interface.measurement


def measurement_of(spec: WrittenSpec, interface: str) -> LocatedPart[Measurement] | None:
    """Return the measurement of an interface or, if it has none, of the device. None if there is neither."""
    if interface in spec.interfaces.data:
        interface_by_name = dict(interfaces(spec))
        own_measurement = interface_by_name[interface].measurement
        if own_measurement is not None and own_measurement.is_given:
            return own_measurement
    return spec.measurement


def position_names(spec: WrittenSpec, interface: str) -> set[str]:
    """Return the names of the fields and joins that form the position.

    These are the measured number, by default ``position``, and the fields that a layout of the interface joins to it.
    """
    measurement = measurement_of(spec, interface)
    measured_name = measurement.part.of if measurement is not None and measurement.has("of") else "position"
    names = {measured_name}
    for frame in layouts_of_interfaces(spec):
        if frame.interface == interface:
            names.update(frame.joins.get(measured_name, ()))
    return names


class BitRange(NamedTuple):
    """The highest and the lowest bit of a place in a register."""

    highest: int
    lowest: int


def parse_bit_range(bit_or_range: int | str | None) -> BitRange | None:
    """Return the highest and lowest bit of a range such as ``7:6`` or of a single bit such as 5, otherwise None."""
    if isinstance(bit_or_range, int):
        is_bit_of_register = 0 <= bit_or_range < 1024  # No register has more bits.
        return BitRange(bit_or_range, bit_or_range) if is_bit_of_register else None
    match = _BIT_RANGE_TEXT.fullmatch(str(bit_or_range))
    if match is None:
        return None
    bit_range = BitRange(*map(int, match.groups()))
    return bit_range if bit_range.highest >= bit_range.lowest else None


def constant_width(field: WrittenField) -> int | None:
    """Return the width of a field if it is constant, or None if it depends on parameters or another rule reports it.

    A flag has one bit, and so has a field whose place is a single bit.
    """
    if field.has("bits"):
        # A width that is a text is an expression over parameters.
        return field.bits if isinstance(field.bits, int) and field.bits > 0 else None
    bit_range = _BIT_RANGE_TEXT.fullmatch(str(field.at))
    if bit_range is not None:
        highest_bit, lowest_bit = map(int, bit_range.groups())
        width = highest_bit - lowest_bit + 1
        return width if width > 0 else None
    return 1 if field.is_flag or isinstance(field.at, int) else None


def bit_names(register: WrittenRegister, group_by_name: Groups) -> list[str]:
    """Return the names allowed after the dot in ``register.field``: the fields of a register, or its own name."""
    if register.has("fields"):
        field_list = FieldList(FieldOwner.REGISTER, register, interface="")
        return list(fields_by_name(field_list, group_by_name))
    return [register.name]


def owner_of_alarm(spec: WrittenSpec, alarm: LocatedPart[Alarm]) -> WrittenFieldGroup | WrittenRegister | None:
    """Return the group of an alarm's flag or, if it names none, the register. Return None if there is no such owner."""
    if alarm.part.group:
        return by_name(spec.field_groups).get(alarm.part.group)
    return by_name(spec.registers).get(alarm.part.register)


def has_other_bits(register: WrittenRegister, group_by_name: Groups) -> bool:
    """Return True if a register has several fields, or bits outside its fields."""
    has_several_fields = len(bit_names(register, group_by_name)) > 1
    return has_several_fields or register.has("other_bits")


def value_names(field: WrittenField) -> list[str]:
    """Return the names of the named values of a field, even of invalid ones."""
    return field.names_in("values")


def fields_of(register: WrittenRegister, group_by_name: Groups) -> Iterator[WrittenField]:
    """Yield the fields of a register, with groups included."""
    field_list = FieldList(FieldOwner.REGISTER, register, interface="")
    for _, field in with_groups_expanded(field_list, group_by_name):
        yield field


def value_names_of_register(register: WrittenRegister, group_by_name: Groups, field_name: str = "") -> list[str]:
    """Return the names of values of all fields of a register, or only of the field of this name."""
    names: list[str] = []
    for field in fields_of(register, group_by_name):
        if not field_name or field.name == field_name:
            names += value_names(field)
    return names


def bank_select_register(spec: WrittenSpec) -> str:
    """Return the name of the register that selects banks. Empty if there is none."""
    return spec.interfaces.biss.bank_select if spec.interfaces.biss is not None else ""


def as_affected_name(path: str) -> str:
    """Return a path of names in the form used by errata, without the names of certain lists.

    The path of a timing is ``interfaces.ssi.monoflop`` instead of ``interfaces.ssi.timings.monoflop``. The last name is
    always kept.
    """
    *names, last_name = path.split(".")
    kept_names = [name for name in names if name not in KEYS_OMITTED_BY_ERRATA]
    return ".".join((*kept_names, last_name))


def is_second_reading(document: Document) -> bool:
    """Return True for a second reading of a manual, which repeats printed facts without notes and other explanations.

    A second reading is compared with the spec of the same encoder.
    """
    return is_second(document.file)


def is_explained_at(document: Document, *keys: str) -> bool:
    """Return True if an erratum affects exactly this place, given by keys and names: ``"interfaces", "ssi", "clock"``.

    A second reading has no errata, so everything counts as explained there. It repeats the printed values, and its
    spec must agree or explain the difference.
    """
    if is_second_reading(document):
        return True
    return bool(errata_at(document, *keys))


def errata_at(document: Document, *keys: str) -> frozenset[str]:
    """Return the names of the errata that affect exactly this place: ``"interfaces", "ssi", "clock"``."""
    affected_path = as_affected_name(".".join(keys))
    errata = WrittenSpec(document.data).errata
    return frozenset(erratum.name for erratum in errata if affected_path in map(as_affected_name, erratum.affects))
