"""Layouts: named fields over so many bits, and the CRCs that end them.

Bit 0 is the least significant bit everywhere, and a number of several bytes is one integer whose byte order the layout
states.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from .expressions import Expression
from .facts import Sources
from .kinds import Choice, Constant, CrcValue, Decimal, Digits, Flag, Kind, Number, Parity, Unused, Value, Verdict


@dataclass(frozen=True, slots=True)
class Crc:
    """A CRC by its standard parameters."""

    name: str
    width: int
    poly: int
    init: int
    refin: bool
    refout: bool
    xorout: int
    note: str
    source: Sources

    @property
    def poly_with_top_bit(self) -> int:
        return self.poly | 1 << self.width

    @property
    def mask(self) -> int:
        return (1 << self.width) - 1

    @property
    def is_xor(self) -> bool:
        """Return whether the CRC of whole bytes is their XOR."""
        return self.width == 8 and self.poly == 1 and self.init == 0 and self.refin == self.refout

    @property
    def polynomial(self) -> str:
        """Return the generator polynomial as ``x^6 + x + 1``."""
        powers = [self.width, *(power for power in range(self.width - 1, -1, -1) if self.poly >> power & 1)]
        return " + ".join({0: "1", 1: "x"}.get(power, f"x^{power}") for power in powers)


@dataclass(frozen=True, slots=True)
class Piece:
    """Part of a field in one byte: ``((byte >> right) & mask) << left``."""

    byte: int
    right: int
    mask: int
    left: int


@dataclass(frozen=True, slots=True)
class Field:
    """A field at bits ``low`` to ``low + width - 1``; ``kind`` says how these bits become a value.

    The field and its padding fill ``container`` bits from the field's low end. ``pieces`` is empty unless the layout is
    carried as bytes and the container lies at a fixed place.
    """

    name: str
    kind: Kind
    low: Expression
    width: Expression
    widest: int
    printed_name: str = ""
    names: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    group: str = ""
    container: int = 0
    pieces: tuple[Piece, ...] = ()
    equals: Expression | int | str | None = None
    implemented: bool = True
    reserved: str = ""
    explained_by: tuple[str, ...] = ()
    unit: str = ""
    default: int | None = None
    meaning: str = ""
    note: str = ""
    source: Sources = ()
    remedy: str = ""
    by_hand: tuple[str, ...] = ()

    @property
    def unexplained(self) -> Field:
        """The flag as order codes have it for which the manual does not explain it."""
        assert isinstance(self.kind, Flag)
        return replace(self, kind=self.kind.unexplained, meaning="", note="", remedy="", by_hand=())

    def held_by(self, parameters: Mapping[str, int]) -> Field:
        """Return the field as an order code with these parameters has it."""
        while_ = self.kind.only_while if isinstance(self.kind, Flag) else ""
        return self.unexplained if while_ and not parameters.get(while_) else self

    @property
    def is_fixed(self) -> bool:
        """Whether it lies at the same place for every order code."""
        return self.low.is_constant and self.width.is_constant

    @property
    def mask_in_place(self) -> int:
        """Its bits within the layout as one number, as far as it can reach; its lowest bit has to be fixed."""
        return ((1 << self.widest) - 1) << self.low.constant

    @property
    def carries_data(self) -> bool:
        """Whether a user of a decoded frame wants it: it is neither fixed nor derived from other fields."""
        return not isinstance(self.kind, (Constant, Unused, CrcValue, Parity))

    def documented(self, parameters: Mapping[str, int]) -> int | str | None:
        """What ``equals`` comes to for an order code with these parameters."""
        return self.equals.value(parameters) if isinstance(self.equals, Expression) else self.equals

    @property
    def number(self) -> Number:
        """How its bits count: as the number that it is, else as a plain one."""
        return self.kind if isinstance(self.kind, Number) else Number()

    @property
    def values(self) -> tuple[Value, ...]:
        """The named values, if it is a choice."""
        return self.kind.values if isinstance(self.kind, Choice) else ()

    @property
    def runs(self) -> tuple[Digits, ...]:
        """The runs of decimal digits, if it is read in decimal."""
        return self.kind.runs if isinstance(self.kind, Decimal) else ()

    @property
    def padding_of(self) -> str:
        """The field that it pads, if it is padding."""
        return self.kind.padding_of if isinstance(self.kind, Constant) else ""

    @property
    def fills_gap(self) -> bool:
        """Whether it is the zeros between two fields of the spec, or beside one."""
        return isinstance(self.kind, Constant) and self.kind.fills_gap


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

    It is carried ``in_bytes``, by the ``byte_order`` ``low_byte_first`` or ``high_byte_first``, or else as bits, the
    most significant first. ``fields`` stand in sending order for frames, and from the most significant bit down for
    registers. ``channel`` is the BiSS data channel, where the encoder has several.
    """

    name: str
    printed_name: str
    sender: str
    in_bytes: bool
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
    gray_of: str = ""
    gray_when: str = ""
    channel: int | None = None

    def field(self, name: str) -> Field:
        return next(item for item in self.fields if item.name == name)

    def names_in(self, name: str) -> tuple[str, ...]:
        """The fields of a join, most significant first; of a field its own name."""
        return next((item.fields for item in self.joins if item.name == name), (name,))

    @property
    def carried_as(self) -> str:
        """The word of the spec language for how it is carried."""
        return "bytes" if self.in_bytes else "bits"

    @property
    def data_fields(self) -> tuple[Field, ...]:
        return tuple(item for item in self.fields if item.carries_data)

    @property
    def spoiling_flags(self) -> tuple[Field, ...]:
        """The flags during which the position of this frame is not usable.

        A flag that sums up others of the frame adds nothing to them.
        """
        here = {item.name for item in self.fields}
        return tuple(
            item
            for item in self.fields
            if item.implemented
            and isinstance(item.kind, Flag)
            and item.kind.makes_position is Verdict.NOT_USABLE
            and not (item.kind.sums_up and here.issuperset(item.kind.sums_up))
        )

    @property
    def unused(self) -> tuple[tuple[Field, int], ...]:
        """The unused fields, the lowest first, each with its lowest bit in the number that a decoder makes of them.

        In bytes that number has a byte for each one of the frame in which unused bits lie, and every bit keeps its
        place in its byte. Where fields move with the order code, and in words, they stand side by side.
        """
        fields = [item for item in self.fields if isinstance(item.kind, Unused)]
        if self.in_bytes and all(item.low.is_constant and item.width.is_constant for item in fields):
            fields.sort(key=lambda item: item.low.constant)
            spans = ((item.low.constant, item.low.constant + item.widest - 1) for item in fields)
            taken = sorted({byte for low, high in spans for byte in range(low // 8, high // 8 + 1)})
            places = [8 * taken.index(item.low.constant // 8) + item.low.constant % 8 for item in fields]
        else:
            # The last one sent is the lowest in a word, the first one where the low byte comes first.
            fields = fields if self.byte_order == "low_byte_first" else fields[::-1]
            places = [sum(item.widest for item in fields[:index]) for index in range(len(fields))]
        return tuple(zip(fields, places, strict=True))

    @property
    def unused_width(self) -> int:
        """How many bits the number of the unused fields has."""
        return max((place + item.widest for item, place in self.unused), default=0)

    @property
    def status_fields(self) -> tuple[Field, ...]:
        """The bits for error and warning: flags, and bits that stand for one and are never active, so always 1."""
        return tuple(
            item
            for item in self.fields
            if isinstance(item.kind, Flag) or (isinstance(item.kind, Unused) and item.kind.value and item.widest == 1)
        )

    @property
    def crc_field(self) -> Field | None:
        return next((item for item in self.fields if isinstance(item.kind, CrcValue)), None)

    def place(self, parameters: Mapping[str, int]) -> PlacedLayout:
        """The layout for one order code; fields without bits are left out, flags of other order codes not explained."""
        every = (
            PlacedField(item.held_by(parameters), item.low.value(parameters), item.width.value(parameters))
            for item in self.fields
        )
        placed = {item.name: item for item in every if item.width > 0}
        gray = bool(self.gray_when and parameters.get(self.gray_when))
        unused = tuple((placed[item.name], place) for item, place in self.unused if item.name in placed)
        return PlacedLayout(self, self.bits.value(parameters), tuple(placed.values()), gray, unused)


@dataclass(frozen=True, slots=True)
class PlacedLayout:
    """A layout whose positions are numbers; ``gray`` says that the number ``layout.gray_of`` is sent in Gray code.

    ``unused`` are the unused fields that the order code has, each with its place as in ``layout.unused``.
    """

    layout: Layout
    bits: int
    fields: tuple[PlacedField, ...]
    gray: bool = False
    unused: tuple[tuple[PlacedField, int], ...] = ()

    @property
    def name(self) -> str:
        return self.layout.name

    def field(self, name: str) -> PlacedField | None:
        return next((item for item in self.fields if item.name == name), None)

    def place_of(self, name: str) -> tuple[int, int]:
        """Low bit and width of a field, or of a join whose fields touch.

        Width 0 where this order code has none of them.
        """
        parts = [item for item in map(self.field, self.layout.names_in(name)) if item is not None]
        return (parts[-1].low, sum(item.width for item in parts)) if parts else (0, 0)


def number_from_bytes(layout: Layout, data: bytes) -> int:
    """The bytes of a frame or register as one number."""
    return int.from_bytes(data, "little" if layout.byte_order == "low_byte_first" else "big")


def number_to_bytes(layout: Layout, number: int, bits: int) -> bytes:
    """One number as the bytes of a frame or register."""
    return number.to_bytes(bits // 8, "little" if layout.byte_order == "low_byte_first" else "big")
