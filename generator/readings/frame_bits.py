"""Frames and registers bit by bit. The meaning of a bit does not depend on how a reader splits bytes into fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..language.problems import Path, listed
from ..model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Flag,
    Kind,
    Layout,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Text,
    Unused,
    assert_never,
)
from .fact import Bit, Case, Key, Names, Placed, Word
from .field_properties import Properties
from .reading import Parameters, Reading, bits


def word(reading: Reading, layout: Layout, key: Key, what: str, properties: Properties) -> Word:
    """Return a frame or register in each case of its interface."""
    made: dict[tuple[int, ...], Placed] = {}
    sources = reading.sources_of(layout)
    cases: dict[Case, Placed] = {}
    for case, parameters in reading.cases(properties.interface).items():
        same = tuple(parameters[name] for name in sources)
        if same not in made:
            made[same] = _placed(layout.place(parameters), properties, parameters)
        cases[case] = made[same]
    return Word(key, what, properties.owner, cases)


def _placed(placed: PlacedLayout, properties: Properties, parameters: Parameters) -> Placed:
    found = [Bit("unspecified", None, None, (*properties.owner, "other_bits"))] * placed.bits
    fields = {}
    names: dict[Key, Names] = {}
    for item in placed.fields:
        place = properties.place(item.field)
        for index, bit in enumerate(_bits(item, placed, place)):
            found[item.low + index] = bit
        fields[item.low, item.width] = properties.of(item, parameters)
        properties.add_names(item, names)
    return Placed(tuple(found), fields, names)


def _bits(item: PlacedField, placed: PlacedLayout, place: Path) -> Iterator[Bit]:
    """Yield each bit of a field, lowest first."""
    kind = item.field.kind
    part, offset = _part(kind, item, placed), 0
    joined = _joined(item, placed)
    if joined is not None and isinstance(kind, (Number, Choice, Decimal, Flag)):
        offset = joined
    for index in range(item.width):
        match kind:
            case Constant(value) | Unused(value):
                yield Bit(part, None, value >> index & 1, place)
            case Flag() | Parity() if joined is None:
                yield Bit(part, None, None, place)
            case Text():
                yield Bit(part, index % 8, None, place)
            case _:
                yield Bit(part, offset + index, None, place)


def _part(kind: Kind, item: PlacedField, placed: PlacedLayout) -> str:
    """Return the owner of the bits of a field."""
    match kind:
        case Number(signed=True):
            return "a signed number" + _gray(item, placed)
        case Number() | Choice() | Decimal():
            return "a number" + _gray(item, placed)
        case Flag():
            return "a flag"
        case Constant():
            return "constant"
        case Unused():
            return "unused"
        case CrcValue():
            return "the CRC"
        case Parity(of, odd, over):
            others = ((name, placed.field(name)) for name in of)
            where = [bits(other.high, other.low) if other is not None else name for name, other in others]
            counted = f"the {over.replace('_', ' ')} of " if over else ""
            return f"{'odd' if odd else 'even'} parity of {counted}{listed(where)}"
        case Text():
            return "a character"
        case _:
            assert_never(kind)


def _gray(item: PlacedField, placed: PlacedLayout) -> str:
    names = next((join.fields for join in placed.layout.joins if join.name == placed.layout.gray_of), ())
    return " in Gray code" if placed.gray and item.name in (placed.layout.gray_of, *names) else ""


def _joined(item: PlacedField, placed: PlacedLayout) -> int | None:
    """Return the weight of the field's lowest bit in the longest joined number that contains it, or None."""
    found: tuple[int, int] | None = None
    for join in placed.layout.joins:
        if item.name not in join.fields:
            continue
        parts = [part for part in map(placed.field, join.fields) if part is not None]
        below = parts[[part.name for part in parts].index(item.name) + 1 :]
        longest = sum(part.width for part in parts)
        if found is None or longest > found[0]:
            found = longest, sum(part.width for part in below)
    return None if found is None else found[1]


def run(found: Sequence[Bit]) -> str:
    """Describe adjacent bits, highest first: ``bits 7:0 of a number``, ``constant 0010``."""
    first, last = found[0], found[-1]
    if first.fixed is not None:
        return f"{first.part} {''.join(str(bit.fixed) for bit in found)}"
    if first.weight is None or last.weight is None:
        return first.part
    return f"{bits(first.weight, last.weight)} of {first.part}"


def continues(one: Bit, other: Bit) -> bool:
    """Return True if ``other``, the next lower bit, continues the same item."""
    if one.part != other.part or (one.fixed is None) is not (other.fixed is None):
        return False
    return one.weight is None or other.weight is None or one.weight == other.weight + 1
