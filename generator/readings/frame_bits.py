"""Frames and registers bit by bit. The meaning of a bit does not depend on how a reader splits bytes into fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from operator import itemgetter

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
    Register,
    Text,
    Unused,
    assert_never,
)
from ..order_codes.parameters import deciding_parameters
from ..say.place import bits
from .fact import Bit, Case, Facts, Placed, Word
from .field_properties import add_names, properties
from .reading import Parameters
from .stated import Subject


def word(owner: Subject, layout: Layout, register: Register | None = None) -> Word:
    """Return a frame or register, which ``owner`` describes, in each case of its interface."""
    made: dict[tuple[int, ...], Placed] = {}
    sources = deciding_parameters(layout)
    cases: dict[Case, Placed] = {}
    for case, parameters in owner.reading.cases(owner.interface).items():
        same = tuple(parameters[name] for name in sources)
        if same not in made:
            made[same] = _placed(owner, layout.place(parameters), parameters, register)
        cases[case] = made[same]
    return Word(owner.what, owner.place, cases)


def _placed(owner: Subject, placed: PlacedLayout, parameters: Parameters, register: Register | None) -> Placed:
    found = [Bit("unspecified", None, None, (*owner.place, "other_bits"))] * placed.bits
    fields = {}
    names = Facts()
    for item in placed.fields:
        place, what = owner.reading.field_place(owner.place, item.field), f"{bits(item.high, item.low)} of {owner.what}"
        for index, bit in enumerate(_bits(item, placed, place), item.low):
            found[index] = bit
        subject = Subject(owner.reading, (), place, what, owner.interface)
        facts = properties(subject, item, parameters, register)
        fields[item.low, item.width] = {fact.key: fact for fact in facts}
        add_names(subject, item, owner.place[-1], names)
    return Placed(tuple(found), fields, names.names)


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
        case CrcValue(_, of):
            low, count = placed.crc_covers
            return f"the CRC of {bits(low + count - 1, low)}" if of else "the CRC"
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
    return " in Gray code" if placed.gray and item.name in placed.layout.names_in(placed.layout.gray_of) else ""


def _joined(item: PlacedField, placed: PlacedLayout) -> int | None:
    """Return the weight of the field's lowest bit in the longest joined number that contains it, or None."""
    found: list[tuple[int, int | None]] = [(0, None)]
    for join in placed.layout.joins:
        if item.name in join.fields:
            parts = [part for part in map(placed.field, join.fields) if part is not None]
            below = parts[[part.name for part in parts].index(item.name) + 1 :]
            found.append((sum(part.width for part in parts), sum(part.width for part in below)))
    return max(found, key=itemgetter(0))[1]


def run(found: Sequence[Bit]) -> str:
    """Describe adjacent bits, highest first: ``bits 7:0 of a number``, ``constant 0010``."""
    first, last = found[0], found[-1]
    if first.fixed is not None:
        return f"{first.part} {''.join(str(bit.fixed) for bit in found)}"
    if first.weight is None or last.weight is None:
        return first.part
    return f"{bits(first.weight, last.weight)} of {first.part}"


def continues(bit: Bit, above: Bit) -> bool:
    """Return True if a bit continues the same item as ``above``, the next higher bit."""
    if (bit.part, bit.place) != (above.part, above.place) or (bit.fixed is None) is not (above.fixed is None):
        return False
    return bit.weight is None or above.weight is None or bit.weight + 1 == above.weight
