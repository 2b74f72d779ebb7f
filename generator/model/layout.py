"""Layouts: named fields over so many bits, and the CRCs that end them.

Bit 0 is the least significant bit everywhere, and a number of several bytes is one integer whose byte order the layout states.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from ..expressions import Expression
from .facts import Sources


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
    for x^8 + 1 over whole bytes, which is their XOR; ``table`` for every other.
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
    ``container`` bits from the field's low end. ``makes_position`` says of a flag what the position in the same frame is worth
    while the flag is active, ``sums_up`` which flags it is the sum of. ``pieces`` is empty unless the layout is carried as bytes and the container lies at a fixed place.
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
    makes_position: str = ""
    sums_up: tuple[str, ...] = ()
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
    ``high_byte_first``. ``fields`` stand in sending order for frames, and from the most significant bit down for registers. ``channel`` is the
    BiSS data channel, where the encoder has several.
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
    channel: int | None = None

    def field(self, name: str) -> Field:
        return next(item for item in self.fields if item.name == name)

    @property
    def data_fields(self) -> tuple[Field, ...]:
        return tuple(item for item in self.fields if item.carries_data)

    @property
    def spoiling_flags(self) -> tuple[Field, ...]:
        """The flags during which the position of this frame is not usable; one that sums up others of the frame adds nothing to them."""
        here = {item.name for item in self.fields}
        spoiling = (item for item in self.fields if item.implemented and item.makes_position == "not_usable")
        return tuple(item for item in spoiling if not item.sums_up or not here.issuperset(item.sums_up))

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

    def place_of(self, name: str) -> tuple[int, int]:
        """Low bit and width of a field, or of a join whose fields touch; width 0 where this order code has none of them."""
        join = next((item for item in self.layout.joins if item.name == name), None)
        parts = [item for item in map(self.field, join.fields if join is not None else (name,)) if item is not None]
        return (parts[-1].low, sum(item.width for item in parts)) if parts else (0, 0)


@dataclass(frozen=True, slots=True)
class DataId:
    name: str
    id: int
    control: int
    purpose: str
    meaning: str
    source: Sources
