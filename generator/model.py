"""The model: one encoder family, fully resolved, as frozen data.

Everything that can be worked out is worked out here or on the way here: positions, widths, masks, CRC plans, order codes.
A target reads the model and computes no bit position. Bit 0 is the least significant bit everywhere, and a number of several
bytes is one integer whose byte order the layout states.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

from .expressions import Expression


@dataclass(frozen=True, slots=True)
class Source:
    """Where a fact is stated: ``document`` is empty for the manual itself, a language code for another edition, else a key of ``documents``."""

    document: str
    section: str
    page: int | None

    def __str__(self) -> str:
        parts = (f"{self.document}:" if self.document else "", self.section, "" if self.page is None else f"p.{self.page}")
        return " ".join(part for part in parts if part)


Sources = tuple[Source, ...]


def cite(sources: Sources) -> str:
    """The sources as one short text, ``6.4 p.35; it: 6.4 p.36``."""
    return "; ".join(str(source) for source in sources)


@dataclass(frozen=True, slots=True)
class Document:
    key: str
    title: str
    url: str = ""


@dataclass(frozen=True, slots=True)
class Edition:
    language: str
    title: str
    revision: str
    date: str


@dataclass(frozen=True, slots=True)
class Revision:
    revision: str
    date: str
    changes: str
    hardware: str
    software: str


@dataclass(frozen=True, slots=True)
class Manual:
    title: str
    revision: str
    date: str
    language: str
    publisher: str
    editions: tuple[Edition, ...]
    history: tuple[Revision, ...]


@dataclass(frozen=True, slots=True)
class LostFigure:
    content: str
    source: Sources


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


@dataclass(frozen=True, slots=True)
class CodePart:
    name: str
    meaning: str
    open: str
    values: tuple[CodeValue, ...]
    source: Sources


@dataclass(frozen=True, slots=True)
class OrderCode:
    """The grammar: ``pattern`` with part names in braces, and what each part may be."""

    pattern: str
    parts: tuple[CodePart, ...]
    special: str
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class FoldStep:
    """One step of a table-free CRC: ``v = (v & mask) ^ (v >> shift) ^ (v >> shift << back)``; without ``back`` the last part falls away."""

    shift: int
    mask: int
    back: int


@dataclass(frozen=True, slots=True)
class Crc:
    """A CRC by its standard parameters.

    ``form`` says how code should compute it: ``fold`` for x^n + x^m + 1 and x^n + 1 with start value 0, most significant bit first; ``xor``
    for x^8 + 1 over whole bytes, which is their XOR; ``bitwise`` for every other.
    """

    name: str
    width: int
    poly: int
    init: int
    refin: bool
    refout: bool
    xorout: int
    form: str
    polynomial: str
    note: str
    source: Sources

    @property
    def poly_with_top_bit(self) -> int:
        return self.poly | 1 << self.width

    @property
    def mask(self) -> int:
        return (1 << self.width) - 1


@dataclass(frozen=True, slots=True)
class Value:
    """A named value of a field or register."""

    name: str
    value: int
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Digits:
    """A run of decimal digits inside a number: ``number // divisor % modulus``."""

    name: str
    digits: int
    divisor: int
    modulus: int
    meaning: str


@dataclass(frozen=True, slots=True)
class Piece:
    """Part of a field in one byte: ``((byte >> right) & mask) << left``."""

    byte: int
    right: int
    mask: int
    left: int


@dataclass(frozen=True, slots=True)
class Field:
    """A field at bits ``low`` to ``low + width - 1``.

    ``kind`` is one of: ``number``, ``flag`` (true when active), ``choice`` (one of ``values``), ``constant``, ``crc``, ``parity``,
    ``digits``, ``text``. ``padding_of`` names the field for whose sake a constant zero field exists; the two together fill
    ``container`` bits from the field's low end. ``pieces`` is empty unless the layout is carried as bytes and the container lies at a fixed place.
    """

    name: str
    kind: str
    low: Expression
    width: Expression
    widest: int
    printed_name: str = ""
    names: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    group: str = ""
    container: int = 0
    pieces: tuple[Piece, ...] = ()
    padding_of: str = ""
    constant: int = 0
    active_low: bool = False
    when_active: str = ""
    when_inactive: str = ""
    values: tuple[Value, ...] = ()
    crc: str = ""
    parity_of: str = ""
    digits: tuple[Digits, ...] = ()
    equals: Expression | int | str | None = None
    signed: bool = False
    zero_means: int = 0
    power_of_two: bool = False
    implemented: bool = True
    reserved: str = ""
    explained_by: tuple[str, ...] = ()
    unit: str = ""
    default: int | None = None
    meaning: str = ""
    note: str = ""
    source: Sources = ()

    @property
    def carries_data(self) -> bool:
        """Whether a user of a decoded frame wants it: it is neither fixed nor derived from other fields."""
        return self.kind not in ("constant", "crc", "parity")

    @property
    def is_optional(self) -> bool:
        """Whether some order codes do not have the field (its width can be 0)."""
        return not self.width.is_constant


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
class Join:
    """A number made of several fields, most significant first."""

    name: str
    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PlacedField:
    """A field at a fixed place, for one order code."""

    field: Field
    low: int
    width: int

    @property
    def name(self) -> str:
        return self.field.name

    @property
    def high(self) -> int:
        return self.low + self.width - 1

    @property
    def mask(self) -> int:
        return (1 << self.width) - 1


@dataclass(frozen=True, slots=True)
class Layout:
    """Named fields over so many bits.

    ``carried_as`` is ``bits`` (first bit sent is the most significant) or ``bytes``; then ``byte_order`` is ``low_byte_first`` or
    ``high_byte_first``. ``fields`` stand in sending order for frames, and from the most significant bit down for registers.
    """

    name: str
    printed_name: str
    sender: str
    carried_as: str
    byte_order: str
    bits: Expression
    widest: int
    fields: tuple[Field, ...]
    joins: tuple[Join, ...]
    selector: str
    selects: tuple[int, ...]
    gaps: str
    note: str
    source: Sources
    fold: tuple[FoldStep, ...] = ()
    gray_of: str = ""
    gray_when: str = ""

    def field(self, name: str) -> Field:
        return next(item for item in self.fields if item.name == name)

    @property
    def data_fields(self) -> tuple[Field, ...]:
        return tuple(item for item in self.fields if item.carries_data)

    @property
    def crc_field(self) -> Field | None:
        return next((item for item in self.fields if item.kind == "crc"), None)

    def place(self, parameters: Mapping[str, int]) -> PlacedLayout:
        """The layout for one order code; fields without bits are left out."""
        placed = (PlacedField(item, item.low.value(parameters), item.width.value(parameters)) for item in self.fields)
        gray = bool(self.gray_when and parameters.get(self.gray_when))
        return PlacedLayout(self, self.bits.value(parameters), tuple(item for item in placed if item.width > 0), gray)


@dataclass(frozen=True, slots=True)
class PlacedLayout:
    """A layout whose positions are numbers; ``gray`` says that the number ``layout.gray_of`` is sent in Gray code."""

    layout: Layout
    bits: int
    fields: tuple[PlacedField, ...]
    gray: bool = False

    @property
    def name(self) -> str:
        return self.layout.name

    def field(self, name: str) -> PlacedField | None:
        return next((item for item in self.fields if item.name == name), None)

    def join_low_and_width(self, join: Join) -> tuple[int, int]:
        """Position of a join whose fields touch, as low bit and width."""
        return self.place_of(join.name)

    def place_of(self, name: str) -> tuple[int, int]:
        """Low bit and width of a field, or of a join whose fields touch; width 0 where this order code has none of them."""
        join = next((item for item in self.layout.joins if item.name == name), None)
        parts = [item for item in map(self.field, join.fields if join is not None else (name,)) if item is not None]
        return (parts[-1].low, sum(item.width for item in parts)) if parts else (0, 0)


@dataclass(frozen=True, slots=True)
class Timing:
    name: str
    symbol: str
    meaning: str
    at_least_us: int | None
    typical_us: int | None
    at_most_us: int | None
    source: Sources


@dataclass(frozen=True, slots=True)
class DataId:
    name: str
    id: int
    control: int
    purpose: str
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class MemoryAccess:
    access: str
    busy: int
    address: str
    data: str
    meaning: str
    source: Sources


@dataclass(frozen=True, slots=True)
class CableLength:
    shorter_than_m: int
    below_hz: int
    source: Sources


@dataclass(frozen=True, slots=True)
class Port:
    baud: int
    data_bits: int
    parity: str
    stop_bits: int
    flow_control: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Network:
    topology: str
    multiple_slaves: bool
    source: Sources


@dataclass(frozen=True, slots=True)
class PrintedTimeout:
    clock_hz: int
    timeout_ns: int


@dataclass(frozen=True, slots=True)
class Timeout:
    rule: str
    half_clock_periods: int | None
    at_most_ns: int | None
    typical_ns: int | None
    printed: tuple[PrintedTimeout, ...]
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
    output_code: str = ""
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
class Alarm:
    name: str
    printed_name: str
    names: Mapping[str, str]
    group: str
    field: str
    meaning: str
    detected: str
    below_mv: int | None
    latch: bool | None
    implemented: bool
    remedy: str
    cleared_by: tuple[str, ...]
    source: Sources


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
    """A value that the caller of a procedure gives, written to the register ``of``."""

    name: str
    of: str
    meaning: str


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
class Contact:
    contact: str
    signal: str
    only: str


@dataclass(frozen=True, slots=True)
class Connector:
    name: str
    kind: str
    title: str
    interfaces: tuple[str, ...]
    mating: str
    contacts: tuple[Contact, ...]
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class LedState:
    state: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Led:
    name: str
    title: str
    states: tuple[LedState, ...]
    source: Sources


@dataclass(frozen=True, slots=True)
class Characteristic:
    name: str
    value: str
    only: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Measurement:
    """What ``of`` counts: ``steps_per_turn`` and ``turns`` for an angle, ``step_um`` and ``steps`` for a length."""

    of: str
    steps_per_turn: Expression | None
    turns: Expression | None
    step_um: Expression | None
    steps: Expression | None
    source: Sources


@dataclass(frozen=True, slots=True)
class Input:
    """A hardware input; ``inverts`` and ``needs`` name register bits as ``register.field``."""

    name: str
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    low: str
    high: str
    pulse_at_least_us: int | None
    inverts: str
    needs: str
    when_unused: str
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Table:
    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str
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
class Erratum:
    name: str
    printed: str
    used: str
    why: str
    status: str
    severity: str
    affects: tuple[str, ...]
    source: Sources


@dataclass(frozen=True, slots=True)
class Variant:
    """One enumerated order code: the text, its parts, its interface, and the value of every parameter."""

    code: str
    parts: Mapping[str, str]
    interface: str
    parameters: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Manufacturer:
    name: str
    title: str
    biss_id: int | None
    python_package: str
    version: str
    trademarks: tuple[str, ...]


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

    def measurement_of(self, interface: str) -> Measurement | None:
        """What the position counts over this interface."""
        return self.interface(interface).measurement or self.measurement

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
