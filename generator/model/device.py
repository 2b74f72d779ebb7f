"""The device: an encoder family with its order codes, interfaces, registers, procedures and examples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

from ..expressions import Expression
from .facts import (
    Alarm, CableLength, Characteristic, Connector, Document, Erratum, Input, Led, LostFigure, Manual, Manufacturer, MemoryAccess, Network, Port,
    Sources, Supply, Table, Timeout, Timing,
)
from .layout import Crc, DataId, Field, Layout, Value


@dataclass(frozen=True, slots=True)
class Parameter:
    """A quantity that an order code sets, or that follows from others when ``equals`` is given."""

    name: str
    meaning: str
    unit: str
    equals: Expression | None
    largest: int
    source: Sources
    read_from: str = ""
    min: int | None = None
    max: int | None = None
    interface: str = ""
    hexadecimal: bool = False

    @property
    def register(self) -> str:
        """The register that holds the parameter at run time, or empty."""
        return self.read_from.partition(".")[0]

    @property
    def field(self) -> str:
        return self.read_from.partition(".")[2]


@dataclass(frozen=True, slots=True)
class CodeValue:
    text: str
    meaning: str
    interface: str
    sets: Mapping[str, int]
    only_with: Mapping[str, tuple[str, ...]]
    source: Sources
    supply: Supply | None = None


@dataclass(frozen=True, slots=True)
class CodePart:
    name: str
    meaning: str
    open: str
    values: tuple[CodeValue, ...]
    source: Sources
    open_only_with: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True)
class SpelledValue:
    """What stands in a spelling for a listed value of a part."""

    part: str
    text: str
    value: str


@dataclass(frozen=True, slots=True)
class Spelling:
    """Another way in which a label may be written, ``where`` it is so.

    The parts of ``values`` have the texts listed there alone. ``then`` is a regular expression for what follows and means nothing here.
    """

    pattern: str
    where: str
    values: tuple[SpelledValue, ...]
    then: str
    source: Sources


@dataclass(frozen=True, slots=True)
class OrderCode:
    """The grammar: ``pattern`` with part names in braces, and what each part may be."""

    pattern: str
    parts: tuple[CodePart, ...]
    special: str
    note: str
    source: Sources
    also_written: tuple[Spelling, ...] = ()


@dataclass(frozen=True, slots=True)
class FieldGroup:
    """Fields that several layouts share; a field names its group."""

    name: str
    printed_name: str
    names: Mapping[str, str]
    bits: int
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class ControlField:
    """A field of the BiSS control frame, of which the manual gives no whole layout."""

    name: str
    printed_name: str
    bits: int
    values: tuple[Value, ...]
    crc: str
    meaning: str
    source: Sources
    names: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True)
class Interface:
    """One interface; what its kind does not have stays empty."""

    kind: str
    layouts: tuple[Layout, ...]
    timings: tuple[Timing, ...]
    note: str
    source: Sources
    clock_min_hz: int | None = None
    clock_max_hz: int | None = None
    clock_source: Sources = ()
    signals: str = ""
    alignment: str = ""
    alignment_source: Sources = ()
    output_code: str = ""
    output_code_source: Sources = ()
    cable_lengths: tuple[CableLength, ...] = ()
    profile: str = ""
    network: Network | None = None
    timeout: Timeout | None = None
    control_data: tuple[ControlField, ...] = ()
    control_data_note: str = ""
    description_file: str = ""
    bank_select: str = ""
    measurement: Measurement | None = None
    port: Port | None = None
    data_ids: tuple[DataId, ...] = ()
    memory_access: tuple[MemoryAccess, ...] = ()

    @property
    def title(self) -> str:
        return {"ssi": "SSI", "biss": "BiSS C-mode", "rs485": "RS-485"}[self.kind]


@dataclass(frozen=True, slots=True)
class RegisterMeaning:
    """One of the things that a register can mean: while ``register.field`` (``when``) has the value named ``value``."""

    name: str
    when: str
    value: str
    min: Expression | None
    max: Expression | None
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Register:
    """A register of ``length`` bytes from ``address`` on; ``layout`` places its fields."""

    name: str
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    interface: str
    address: int
    length: int
    access: str
    byte_order: str
    default: int | None
    min: Expression | None
    max: Expression | None
    limits_of: str
    opened_by: str
    opened_by_value: str
    clears_itself: bool
    wait_at_least_ms: int | None
    volatile: bool
    layout: Layout
    note: str
    source: Sources
    above_max: str = ""
    write_clears: tuple[str, ...] = ()
    meanings: tuple[RegisterMeaning, ...] = ()
    reserved: str = ""
    bank: int | None = None
    opened_by_field: str = ""

    @property
    def last_address(self) -> int:
        return self.address + self.length - 1

    @property
    def readable(self) -> bool:
        return self.access != "write_only"

    @property
    def writable(self) -> bool:
        return self.access != "read_only"

    @property
    def values(self) -> tuple[Value, ...]:
        """The named values of a register that is one choice."""
        return self.layout.fields[0].values if len(self.layout.fields) == 1 else ()

    def default_bytes(self) -> bytes | None:
        """The default as bytes in ascending order of address."""
        if self.default is None:
            return None
        return self.default.to_bytes(self.length, "little" if self.byte_order == "low_byte_first" else "big")


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a procedure.

    ``do`` is ``write`` (``register``, and ``value``, or the argument ``value_name`` when ``value`` is None; with ``field`` only that field is
    set and the others stay as read), ``read`` (``register``), ``poll`` (``register`` until ``field`` is ``value``), ``wait``
    (``microseconds``), or ``send`` (``data_id``, ``times``, ``microseconds`` from one to the next; ``request`` is the frame).
    """

    do: str
    register: str = ""
    field: str = ""
    value_name: str = ""
    value: int | None = None
    microseconds: int = 0
    data_id: str = ""
    request: bytes = b""
    times: int = 1
    meaning: str = ""
    source: Sources = ()


@dataclass(frozen=True, slots=True)
class Argument:
    """A value that the caller of a procedure gives, written to the register ``of``; ``meant_as`` names the register's meaning, if it has several."""

    name: str
    of: str
    meaning: str
    meant_as: str = ""


@dataclass(frozen=True, slots=True)
class Procedure:
    name: str
    title: str
    interface: str
    arguments: tuple[Argument, ...]
    precondition: str
    steps: tuple[Step, ...]
    result: str
    note: str
    source: Sources

    @property
    def argument(self) -> str:
        return self.arguments[0].name if self.arguments else ""

    @property
    def argument_of(self) -> str:
        return self.arguments[0].of if self.arguments else ""

    @property
    def argument_meaning(self) -> str:
        return self.arguments[0].meaning if self.arguments else ""


@dataclass(frozen=True, slots=True)
class Measurement:
    """What ``of`` counts: ``steps_per_turn`` and ``turns`` for an angle, ``step_um`` and ``steps`` for a length.

    ``highest`` is the highest number sent, where an offset can move the positions above the steps in all.
    """

    of: str
    steps_per_turn: Expression | None
    turns: Expression | None
    step_um: Expression | None
    steps: Expression | None
    highest: Expression | None
    source: Sources


@dataclass(frozen=True, slots=True)
class Write:
    address: int
    value: int


@dataclass(frozen=True, slots=True)
class Example:
    """A worked example; which members are set follows from ``kind`` (frame, register, crc, procedure)."""

    name: str
    kind: str
    order_code: str
    layout: str
    register: str
    procedure: str
    crc: str
    sender: str
    bytes: bytes
    bits: str
    check: int | None
    arguments: Mapping[str, int]
    values: Mapping[str, int | str | bool]
    writes: tuple[Write, ...]
    refused: str
    erratum: str
    note: str
    source: Sources
    counts: int | None = None
    micrometres: int | None = None

    @property
    def argument(self) -> int | None:
        return next(iter(self.arguments.values()), None)


@dataclass(frozen=True, slots=True)
class Variant:
    """One enumerated order code: the text, its parts, its interface, and the value of every parameter."""

    code: str
    parts: Mapping[str, str]
    interface: str
    parameters: Mapping[str, int]


@dataclass(frozen=True)
class Device:
    """An encoder family: everything that its manual says, resolved."""

    name: str
    title: str
    movement: str
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

    @cached_property
    def set_parameters(self) -> tuple[Parameter, ...]:
        """The parameters that everything else follows from: those that an order code sets or that a register holds."""
        return tuple(item for item in self.parameters if item.equals is None)

    @cached_property
    def run_time_parameters(self) -> tuple[Parameter, ...]:
        """The parameters that a register holds at run time."""
        return tuple(item for item in self.parameters if item.read_from)

    def layouts(self) -> Iterator[tuple[Interface, Layout]]:
        for interface in self.interfaces:
            for layout in interface.layouts:
                yield interface, layout

    def interface(self, kind: str) -> Interface:
        return next(item for item in self.interfaces if item.kind == kind)

    def layout(self, name: str) -> Layout:
        return next(layout for _, layout in self.layouts() if layout.name == name)

    def limits(self, register: Register, meant_as: str = "") -> tuple[Expression | None, Expression | None]:
        """Lowest and highest value of a register, or of one of its meanings."""
        meaning = next((item for item in register.meanings if item.name == meant_as), None)
        return (meaning.min, meaning.max) if meaning is not None else (register.min, register.max)

    @cached_property
    def identity(self) -> tuple[tuple[Register, Field], ...]:
        """The register fields by which a device of this family is known: those whose value the spec states."""
        return tuple((register, item) for register in self.registers for item in register.layout.fields if item.equals is not None)

    def measurement_of(self, interface: str) -> Measurement | None:
        """What the position counts over this interface."""
        return self.interface(interface).measurement or self.measurement

    def supply_of(self, variant: Variant) -> Supply | None:
        """The supply that an order code needs.

        None where the manual does not give it, as of an unlisted value of the part that tells it.
        """
        telling = [part for part in self.order_code.parts if any(value.supply is not None for value in part.values)]
        if not telling:
            return self.supply
        values = (value for part in telling for value in part.values if variant.parts.get(part.name) == value.text)
        return next((value.supply for value in values if value.supply is not None), None)

    def position_names(self, interface: str) -> frozenset[str]:
        """The fields and joins that are the position or a part of it: what is measured, else those named ``position``."""
        measurement = self.measurement_of(interface)
        of = measurement.of if measurement is not None else "position"
        joins = (join for layout in self.interface(interface).layouts for join in layout.joins)
        return frozenset({of}.union(*(join.fields for join in joins if join.name == of)))

    def register(self, name: str) -> Register:
        return next(item for item in self.registers if item.name == name)

    def crc(self, name: str) -> Crc:
        return next(item for item in self.crcs if item.name == name)

    def procedure(self, name: str) -> Procedure:
        return next(item for item in self.procedures if item.name == name)

    def variant(self, code: str) -> Variant:
        return next(item for item in self.variants if item.code == code)

    def errata_for(self, path: str) -> tuple[Erratum, ...]:
        """The errata that touch ``path``, something above it or something below it, such as ``registers.preset``."""
        return tuple(
            item
            for item in self.errata
            if any(path == other or path.startswith(other + ".") or other.startswith(path + ".") for other in item.affects)
        )
