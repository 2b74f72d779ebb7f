"""Encoder family with all its facts, and the range of the numbers that it sends as its position.

An offset can shift unsigned positions up to the ``highest`` of the measurement, so all of these are valid.
Signed positions end at ``highest``, and their number is the number of positions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple, TypeVar

from .channels import channel_frame
from .documents import Document, Erratum, Evidence, LostFigure, Manual, ManualEdition, Manufacturer, Overlay
from .examples import Example, Sample
from .expressions import Expression
from .facts import Alarm, Characteristic, Connector, Input, Led, Supply, Table, Timing
from .fields import Crc, Field, PlacedField
from .interfaces import Biss, Interface
from .kinds import CrcValue, Flag, Number
from .layout import Layout, PlacedLayout
from .lookup import first_or_raise, member_named
from .measurement import Measurement
from .order_codes import Alternative, OrderCode, Parameter
from .record import dataclass
from .registers import FieldGroup, Register
from .steps import Procedure


class PositionRange(NamedTuple):
    """Lowest and highest valid number in a field that could hold others.

    It is the position, or the number of revolutions if another field counts one revolution in all its bits.
    """

    field: Field
    lowest: Expression
    highest: Expression


def narrower_range(
    measurement: Measurement, layout: Layout, parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of a position if it is narrower than the width of its field for some order code, or None.

    Parts of one revolution in several fields have no range, and signed positions have none without ``highest``. Decimal
    digits have none either, nor does a number whose bits 0 represent another number. ``parameter_sets`` are the
    parameters of the order codes.
    """
    fields_by_name = {field.name: field for field in layout.fields}
    position_fields = [fields_by_name[name] for name in layout.names_in(measurement.of) if name in fields_by_name]
    are_numbers = all(isinstance(field.kind, Number) for field in position_fields)
    if not are_numbers:
        return None
    is_signed = len(position_fields) == 1 and position_fields[0].number.signed
    if is_signed:
        position_range = _signed_range(measurement, position_fields[0])
    else:
        position_range = _unsigned_range(measurement, position_fields, parameter_sets)
    if position_range is None or position_range.field.number.zero_means:
        return None
    is_narrower = any(_is_narrower(position_range, parameters) for parameters in parameter_sets)
    return position_range if is_narrower else None


def _is_narrower(position_range: PositionRange, parameters: Mapping[str, int]) -> bool:
    """Return True if a range has fewer numbers than the width of its field allows, but at least one.

    The result is False for order codes without the field, whose width is 0.
    """
    width = position_range.field.width.value(parameters)
    highest = position_range.highest.value(parameters)
    return bool(width) and 0 <= highest - position_range.lowest.value(parameters) < (1 << width) - 1


def _signed_range(measurement: Measurement, field: Field) -> PositionRange | None:
    """Return the range of a signed position: as many numbers as it has counts, up to ``highest``. None if unknown."""
    total = measurement.total
    highest = measurement.highest
    if total is None or highest is None:
        return None
    lowest = highest - total + Expression(1)
    return PositionRange(field, lowest, highest)


def _unsigned_range(
    measurement: Measurement, fields: Sequence[Field], parameter_sets: Sequence[Mapping[str, int]]
) -> PositionRange | None:
    """Return the range of a position without a sign, or None if it has none.

    A position in one field has one if its number of counts is known. A position in two fields, revolutions above one
    full revolution, has the range of its revolutions, unless an offset shifts it up to ``highest``.
    """
    total = measurement.total
    turns = measurement.turns
    counts_per_turn = measurement.counts_per_turn
    if total is None or any(field.number.signed for field in fields):
        return None
    if len(fields) == 1:
        highest = measurement.highest or total - Expression(1)
        return PositionRange(fields[0], lowest=Expression(0), highest=highest)
    if len(fields) != 2 or measurement.highest is not None or counts_per_turn is None or turns is None:
        return None
    # The fields of a position are listed from the most significant one.
    high_field, low_field = fields
    for parameters in parameter_sets:
        if counts_per_turn.value(parameters) != 1 << low_field.width.value(parameters):
            # Both fields are parts of one revolution.
            return None
    return PositionRange(high_field, lowest=Expression(0), highest=turns - Expression(1))


_Kind = TypeVar("_Kind", bound=Interface)


@dataclass(frozen=True, slots=True)
class Variant:
    """One listed order code: its text, parts, interface, and the value of every parameter."""

    code: str
    parts: Mapping[str, str]
    interface: str
    parameters: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class TimesRead:
    """Number of facts in a spec by how they were read: twice and equal, twice and different with a reason, or once.

    ``decided`` counts facts that no manual prints, and ``derived`` counts facts that follow from other facts.
    """

    twice: int
    explained: int
    decided: int
    once: int
    derived: int


@dataclass(frozen=True, slots=True)
class ReleasedChange:
    """A recorded change: its rule, its impact, a description, and the order codes and outputs affected."""

    rule: str
    impact: str
    text: str
    reach: str
    outputs: str


@dataclass(frozen=True, slots=True)
class Release:
    """A version, with its changes ``since`` an earlier one. It is based on revision ``manual`` of the manual.

    ``names`` are the changes of names in generated files.
    """

    version: str
    since: str
    manual: str
    changes: tuple[ReleasedChange, ...]
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Device:
    """An encoder family, with all facts from its manual resolved."""

    name: str
    title: str
    movement: str
    evidence: Evidence
    manufacturer: Manufacturer
    manual: Manual
    documents: tuple[Document, ...]
    lost_figures: tuple[LostFigure, ...]
    parameters: tuple[Parameter, ...]
    order_code: OrderCode
    variants: tuple[Variant, ...]
    crcs: tuple[Crc, ...]
    interfaces: tuple[Interface, ...]
    registers: tuple[Register, ...]
    alarms: tuple[Alarm, ...]
    procedures: tuple[Procedure, ...]
    timings: tuple[Timing, ...]
    connectors: tuple[Connector, ...]
    leds: tuple[Led, ...]
    characteristics: tuple[Characteristic, ...]
    examples: tuple[Example, ...]
    errata: tuple[Erratum, ...]
    measurement: Measurement | None = None
    inputs: tuple[Input, ...] = ()
    tables: tuple[Table, ...] = ()
    field_groups: tuple[FieldGroup, ...] = ()
    supply: Supply | None = None
    alternatives: tuple[Alternative, ...] = ()
    times_read: TimesRead | None = None
    #: Overlays on the spec, and the original family if this one is a special model or another edition.
    overlays: tuple[Overlay, ...] = ()
    base: str = ""
    #: Editions of the manual, oldest first, and the edition of this device if it differs from the spec's edition.
    editions: tuple[ManualEdition, ...] = ()
    edition: str = ""
    releases: tuple[Release, ...] = ()
    samples: tuple[Sample, ...] = ()
    #: Start of the hash of the content of the spec. Comments in the spec do not change it.
    content_hash: str = ""

    @cached_property
    def set_parameters(self) -> tuple[Parameter, ...]:
        """Independent parameters: those that an order code sets, a register holds, or an answer with a default sets."""
        optional_questions = {alternative.name for alternative in self.optional_alternatives}
        independent_parameters: list[Parameter] = []
        for parameter in self.parameters:
            is_calculated = parameter.equals is not None
            # Parameters that no answer sets have an empty ``alternative``.
            needs_answer = parameter.alternative != "" and parameter.alternative not in optional_questions
            if not is_calculated and not needs_answer:
                independent_parameters.append(parameter)
        return tuple(independent_parameters)

    @property
    def optional_alternatives(self) -> tuple[Alternative, ...]:
        """Questions that the user may answer. Without a choice, their default applies. They decide only verdicts."""
        return tuple(alternative for alternative in self.alternatives if alternative.default)

    def verdict_alternatives(self, layout: Layout) -> tuple[Alternative, ...]:
        """Return the questions whose answers decide the verdict on a frame of this layout."""
        kinds = [field.kind for field in layout.fields if isinstance(field.kind, Flag)]
        parameters = {kind.verdict_parameter for kind in kinds}
        return tuple(alternative for alternative in self.optional_alternatives if alternative.parameter in parameters)

    @cached_property
    def definitions(self) -> Mapping[str, Expression]:
        """Expressions of the derived parameters, by name."""
        return {parameter.name: parameter.equals for parameter in self.parameters if parameter.equals is not None}

    def needed_parameters(self, names: Iterable[str]) -> frozenset[str]:
        """Return these parameters, and all parameters from which they are calculated."""
        needed_names = set[str]()
        pending = list(names)
        while pending:
            name = pending.pop()
            if name not in needed_names and name in self.definitions:
                pending += self.definitions[name].parameters
            needed_names.add(name)
        return frozenset(needed_names)

    def sample_of(self, layout: Layout) -> Sample | None:
        """Return the sample frame of a layout, or None if none could be made up."""
        return next((sample for sample in self.samples if sample.layout == layout.name), None)

    def alternatives_of(self, layout: Layout) -> tuple[Alternative, ...]:
        """Return the questions that the user must answer before a frame of this layout can be read or written."""
        if not self.alternatives:
            return ()
        # The parameters on which places and widths depend. All answers of a question set the same parameters.
        needed_names = {name for field in layout.fields for name in (*field.low.parameters, *field.width.parameters)}
        return tuple(
            question for question in self.alternatives if not needed_names.isdisjoint(question.answers[0].sets)
        )

    @cached_property
    def run_time_parameters(self) -> tuple[Parameter, ...]:
        """Parameters that a register holds at run time."""
        return tuple(parameter for parameter in self.parameters if parameter.read_from)

    def layouts(self) -> Iterator[tuple[Interface, Layout]]:
        for interface in self.interfaces:
            for layout in interface.layouts:
                yield interface, layout

    def interface(self, name: str) -> Interface:
        return member_named(self.interfaces, name, "interface")

    def interface_of(self, layout: Layout) -> Interface:
        """Return the interface with this layout, or raise a ``LookupError``."""
        matches = (interface for interface, candidate in self.layouts() if candidate is layout)
        return first_or_raise(matches, f"interface with the layout '{layout.name}'")

    def find_interface(self, interface_class: type[_Kind]) -> _Kind | None:
        """Return the interface of this kind, or None."""
        return next((interface for interface in self.interfaces if isinstance(interface, interface_class)), None)

    def layout(self, name: str) -> Layout:
        return member_named((layout for _, layout in self.layouts()), name, "layout")

    def limits(self, register: Register, meant_as: str = "") -> tuple[Expression | None, Expression | None]:
        """Return the lowest and highest value of a register, or of its meaning ``meant_as``. None is unlimited.

        If no meaning has this name, the limits belong to the register.
        """
        meaning = next((meaning for meaning in register.meanings if meaning.name == meant_as), None)
        return (meaning.min, meaning.max) if meaning is not None else (register.min, register.max)

    @cached_property
    def identity(self) -> tuple[tuple[Register, Field], ...]:
        """Register fields that identify a device of this family: fields with a documented value."""
        fields = ((register, field) for register in self.registers for field in register.layout.fields)
        return tuple((register, field) for register, field in fields if field.equals is not None)

    def measurement_of(self, interface: str) -> Measurement | None:
        """Return the measurement of the position on this interface, or else that of the device, if there is one.

        An interface can be missing while a spec with problems is checked.
        """
        own_measurements = (known.measurement for known in self.interfaces if known.name == interface)
        return next(own_measurements, None) or self.measurement

    def measurement_in(self, interface: str, layout: Layout) -> Measurement | None:
        """Return the measurement of the position in frames of this layout, or None if the interface has none.

        Its range may differ from other layouts.
        """
        measurement = self.measurement_of(interface)
        return measurement.within(layout.position_range) if measurement is not None else None

    def supply_of(self, variant: Variant) -> Supply | None:
        """Return the supply that an order code needs, or None if the manual does not give it.

        If values of the order code determine the supply, it is the supply of the first value that has one, and None if
        no value has one, such as an unlisted value. Otherwise it is the supply of the device.
        """
        has_supply_by_code = False
        for part in self.order_code.parts:
            for value in part.values:
                if value.supply is None:
                    continue
                has_supply_by_code = True
                is_value_of_variant = variant.parts.get(part.name) == value.text
                if is_value_of_variant:
                    return value.supply
        return None if has_supply_by_code else self.supply

    def position_names(self, interface: str) -> frozenset[str]:
        """Return the names of the fields and joins that form the measured position or a part of it.

        Without a measurement, they are those named ``position``.
        """
        return self._position_names[interface]

    @cached_property
    def _position_names(self) -> dict[str, frozenset[str]]:
        """Names of the fields and joins of the position or a part of it, by interface."""
        position_names = {}
        for interface in self.interfaces:
            measurement = self.measurement_of(interface.name)
            position_name = measurement.of if measurement is not None else "position"
            joins = (join for layout in interface.layouts for join in layout.joins)
            position_names[interface.name] = frozenset(
                {position_name}.union(*(join.fields for join in joins if join.name == position_name))
            )
        return position_names

    def sends_position(self, interface: str, layout: Layout) -> bool:
        """Return whether frames of this layout send the position, or a part of it, to the master."""
        return layout.sender == "encoder" and not layout.member_names.isdisjoint(self.position_names(interface))

    def has_verdict(self, interface: str, layout: Layout) -> bool:
        """Return whether frames of this layout have a verdict on the position.

        They send it, or they are a data channel of the same frame, with bits that say whether it is usable.
        """
        if self.sends_position(interface, layout):
            return True
        frame = channel_frame(self.interface(interface))
        return frame is not None and layout in frame.layouts and layout.judges_position

    def range_in(self, layout: Layout) -> PositionRange | None:
        """Return the range of valid positions in a frame of the encoder, or None if its field holds no others.

        The result is also None for a layout that belongs to no interface, such as the layout of a register.
        """
        # The device holds its layouts, so no other layout can have the identity of one of them.
        if id(layout) not in self._ranges_by_layout:
            interface_names = [interface.name for interface, candidate in self.layouts() if candidate is layout]
            if not interface_names:
                return None
            self._ranges_by_layout[id(layout)] = self._range_over(interface_names[0], layout)
        return self._ranges_by_layout[id(layout)]

    def _range_over(self, interface: str, layout: Layout) -> PositionRange | None:
        """Return the range of valid positions in a frame over an interface, or None if all values are valid."""
        measurement = self.measurement_in(interface, layout)
        if layout.sender != "encoder" or measurement is None:
            return None
        parameter_sets = [variant.parameters for variant in self.variants_over(interface)]
        return narrower_range(measurement, layout, parameter_sets)

    @cached_property
    def _ranges_by_layout(self) -> dict[int, PositionRange | None]:
        """Results of ``range_in`` so far, because each frame of many needs one."""
        return {}

    def signed_range(self, field: PlacedField, placed: PlacedLayout) -> tuple[int, int]:
        """Return the lowest and the highest valid number of a signed field of a frame."""
        valid_range = self.range_in(placed.layout)
        # A field without bits for the order code counts as one bit.
        half_of_numbers = 1 << (max(field.width, 1) - 1)
        if valid_range is None or valid_range.field.name != field.name:
            return -half_of_numbers, half_of_numbers - 1
        return valid_range.lowest.value(placed.parameters), valid_range.highest.value(placed.parameters)

    def register(self, name: str) -> Register:
        return member_named(self.registers, name, "register")

    def registers_over(self, interface: str) -> tuple[Register, ...]:
        """Return the registers that this interface reaches."""
        return tuple(register for register in self.registers if register.interface == interface)

    def bank_selector(self, register: Register) -> str:
        """Return the register that selects the bank of this register, or an empty string if there is none."""
        interface = self.interface(register.interface)
        return interface.bank_select if isinstance(interface, Biss) and register.bank is not None else ""

    def crc(self, name: str) -> Crc:
        return member_named(self.crcs, name, "CRC")

    def crcs_of(self, layout: Layout) -> tuple[Crc, ...]:
        """Return the CRCs at the end of a layout, of which each order code has at most one."""
        return tuple(self.crc(field.kind.crc) for field in layout.fields if isinstance(field.kind, CrcValue))

    def crc_of(self, placed: PlacedLayout) -> Crc | None:
        """Return the CRC at the end of the frames of one order code, or None."""
        placed_field = placed.crc_field
        if placed_field is None or not isinstance(placed_field.field.kind, CrcValue):
            return None
        return self.crc(placed_field.field.kind.crc)

    def reflects_input(self, crc: Crc) -> bool:
        """Return whether the input of a CRC is reflected. In frames of bits, there are no bytes to reflect."""
        layouts = [layout for _, layout in self.layouts()]
        layouts += [register.layout for register in self.registers]
        covers_bytes = [layout.crc_covers_bytes for layout in layouts if crc in self.crcs_of(layout)]
        is_in_no_layout = not covers_bytes  # Then it is only used for bytes.
        return crc.refin and (any(covers_bytes) or is_in_no_layout)

    def procedure(self, name: str) -> Procedure:
        return member_named(self.procedures, name, "procedure")

    def variant(self, code: str) -> Variant:
        matches = (variant for variant in self.variants if variant.code == code)
        return first_or_raise(matches, f"order code '{code}'")

    def variants_over(self, interface: str) -> tuple[Variant, ...]:
        """Return the listed order codes with this interface."""
        return tuple(variant for variant in self.variants if variant.interface == interface)
