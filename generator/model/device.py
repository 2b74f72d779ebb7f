"""An encoder family with all its facts, and the order codes and releases of the family."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import TypeVar

from .expressions import Expression
from .facts import Alarm, Characteristic, Connector, Input, Led, Supply, Table, Timing
from .fields import Crc, Field, PlacedField
from .interfaces import Biss, Interface, channel_frame
from .kinds import CrcValue, Flag
from .layout import Layout, PlacedLayout
from .manual import (
    Document,
    Erratum,
    Evidence,
    Example,
    LostFigure,
    Manual,
    ManualEdition,
    Manufacturer,
    Overlay,
    Sample,
)
from .measurement import Measurement, PositionRange, narrower_range
from .order_codes import Alternative, OrderCode, Parameter
from .record import dataclass, first_or_raise, member_named
from .registers import FieldGroup, Procedure, Register

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
    """Number of facts in a spec by how they were read from the manual.

    ``twice`` counts facts that two readers read equally, ``explained`` those that they read differently for a stated
    reason, and ``once`` all others that were read. ``decided`` counts facts that no manual prints, and ``derived``
    facts that follow from others.
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
        optional_question_names = {alternative.name for alternative in self.optional_alternatives}
        independent_parameters: list[Parameter] = []
        for parameter in self.parameters:
            is_calculated = parameter.equals is not None
            # Parameters that no answer sets have an empty ``alternative``.
            needs_answer = parameter.alternative != "" and parameter.alternative not in optional_question_names
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
        names_to_process = list(names)
        while names_to_process:
            name = names_to_process.pop()
            if name not in needed_names and name in self.definitions:
                names_to_process += self.definitions[name].parameters
            needed_names.add(name)
        return frozenset(needed_names)

    def sample_of(self, layout: Layout) -> Sample | None:
        """Return the sample frame of a layout, or None if none could be made up."""
        return next((sample for sample in self.samples if sample.layout == layout.name), None)

    def alternatives_of(self, layout: Layout) -> tuple[Alternative, ...]:
        """Return the questions that the user must answer before a frame of this layout can be read or written."""
        if not self.alternatives:
            return ()
        # The parameters on which the positions and widths of fields depend.
        parameters_of_layout: set[str] = set()
        for field in layout.fields:
            parameters_of_layout.update(field.low.parameters, field.width.parameters)
        open_questions: list[Alternative] = []
        for question in self.alternatives:
            values_set_by_answer = question.answers[0].sets  # All answers to a question set the same parameters.
            if not parameters_of_layout.isdisjoint(values_set_by_answer):
                open_questions.append(question)
        return tuple(open_questions)

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
        """Return the lowest and the highest value that may be written to a register. None means no limit.

        If the register has a meaning with the name ``meant_as``, the limits are those of this meaning.
        """
        for meaning in register.meanings:
            if meaning.name == meant_as:
                return meaning.min, meaning.max
        return register.min, register.max

    @cached_property
    def identity(self) -> tuple[tuple[Register, Field], ...]:
        """Register fields that identify a device of this family: fields with a documented value."""
        identifying_fields: list[tuple[Register, Field]] = []
        for register in self.registers:
            identifying_fields += [(register, field) for field in register.layout.fields if field.equals is not None]
        return tuple(identifying_fields)

    def measurement_of(self, interface: str) -> Measurement | None:
        """Return the measurement of the position over this interface or, if it has none, that of the device.

        The result is None if there is neither. The interface may be missing while a spec with problems is checked.
        """
        measurements_of_interface = [
            device_interface.measurement for device_interface in self.interfaces if device_interface.name == interface
        ]
        if measurements_of_interface and measurements_of_interface[0] is not None:
            return measurements_of_interface[0]
        return self.measurement

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
        depends_on_order_code = False
        for code_part in self.order_code.parts:
            for code_value in code_part.values:
                if code_value.supply is None:
                    continue
                depends_on_order_code = True
                is_value_of_variant = variant.parts.get(code_part.name) == code_value.text
                if is_value_of_variant:
                    return code_value.supply
        return None if depends_on_order_code else self.supply

    def position_name(self, interface: str) -> str:
        """Return the name of the field or join with the position. Without a measurement, it is ``position``."""
        measurement = self.measurement_of(interface)
        return measurement.position_name if measurement is not None else "position"

    def position_names(self, interface: str) -> frozenset[str]:
        """Return the names of the fields and joins that form the measured position or a part of it.

        Without a measurement, they are those named ``position``.
        """
        return self._position_names[interface]

    @cached_property
    def _position_names(self) -> dict[str, frozenset[str]]:
        """Names of the fields and joins of the position or a part of it, by interface."""
        names_by_interface = {}
        for interface in self.interfaces:
            position_name = self.position_name(interface.name)
            position_and_part_names = {position_name}
            for layout in interface.layouts:
                for join in layout.joins:
                    if join.name == position_name:
                        position_and_part_names.update(join.fields)
            names_by_interface[interface.name] = frozenset(position_and_part_names)
        return names_by_interface

    def sends_position(self, interface: str, layout: Layout) -> bool:
        """Return whether frames of this layout send the position, or a part of it, to the master."""
        return layout.sender == "encoder" and not layout.member_names.isdisjoint(self.position_names(interface))

    def has_verdict(self, interface: str, layout: Layout) -> bool:
        """Return True if frames of this layout have a verdict on the position: whether it is usable.

        They contain the position, or they are a data channel in the same frame with bits that show this, such as an
        error bit.
        """
        if self.sends_position(interface, layout):
            return True
        frame_of_channels = channel_frame(self.interface(interface))
        is_channel = frame_of_channels is not None and layout in frame_of_channels.layouts
        return is_channel and layout.judges_position

    def range_in(self, layout: Layout) -> PositionRange | None:
        """Return the range of valid positions in frames of this layout, or None if its field can hold no other numbers.

        The result is also None for a layout that belongs to no interface, such as the layout of a register.
        """
        # The device keeps its layouts in memory, so no other layout can have the ``id`` of one of them.
        if id(layout) not in self._ranges_by_layout:
            interface_names = [interface.name for interface, device_layout in self.layouts() if device_layout is layout]
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
        position_fields = layout.find_fields(layout.field_names_of(measurement.position_name))
        return narrower_range(measurement, position_fields, parameter_sets)

    @cached_property
    def _ranges_by_layout(self) -> dict[int, PositionRange | None]:
        """Results of ``range_in`` so far, because each frame of many needs one."""
        return {}

    def signed_range(self, field: PlacedField, placed_layout: PlacedLayout) -> tuple[int, int]:
        """Return the lowest and the highest valid number of a signed field in a frame.

        For the position, this is its range. Otherwise it is the range of two's complement in the width of the field.
        """
        position_range = self.range_in(placed_layout.layout)
        if position_range is None or position_range.name != field.name:
            # A field without bits for the order code counts as one bit.
            half_of_numbers = 1 << (max(field.width, 1) - 1)
            return -half_of_numbers, half_of_numbers - 1
        lowest = position_range.lowest.value(placed_layout.parameters)
        return lowest, position_range.highest.value(placed_layout.parameters)

    def register(self, name: str) -> Register:
        return member_named(self.registers, name, "register")

    def registers_over(self, interface: str) -> tuple[Register, ...]:
        """Return the registers that are accessed over this interface."""
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
        """Return True if a CRC processes each input byte least significant bit first.

        Frames of bits contain no bytes to reflect, so ``refin`` of their CRC has no effect.
        """
        layouts = [layout for _, layout in self.layouts()]
        layouts += [register.layout for register in self.registers]
        layouts_with_crc = [layout for layout in layouts if crc in self.crcs_of(layout)]
        # A CRC in no layout is only used for bytes.
        covers_bytes = not layouts_with_crc or any(layout.crc_covers_bytes for layout in layouts_with_crc)
        return crc.refin and covers_bytes

    def procedure(self, name: str) -> Procedure:
        return member_named(self.procedures, name, "procedure")

    def variant(self, code: str) -> Variant:
        matches = (variant for variant in self.variants if variant.code == code)
        return first_or_raise(matches, f"order code '{code}'")

    def variants_over(self, interface: str) -> tuple[Variant, ...]:
        """Return the listed order codes with this interface."""
        return tuple(variant for variant in self.variants if variant.interface == interface)
