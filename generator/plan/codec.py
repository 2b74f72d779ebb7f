"""Plans for decoding and encoding layouts: positions of fields, checks, and sources of the bits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import pairwise

from ..model import Alternative, Crc, Device, Digits, Fault, Field, Join, Layout, Piece
from ..model.expressions import Expression
from ..model.kinds import Constant, CrcValue, Flag, Parity, Text, Unused
from ..model.record import dataclass
from .crc_tables import FoldStep
from .crcs import covers_part, divides, fold_steps
from .values import Meaning, meaning_of


@dataclass(frozen=True, slots=True)
class Bits:
    """``width`` bits of the word, starting at ``low``. ``pieces`` describe the same bits in bytes, lowest bits first.

    ``on_top`` is true if there are no bits above them, so a shift is enough to extract them. ``widest`` is the largest
    width of any order code.
    """

    low: Expression
    width: Expression
    widest: int
    on_top: bool
    pieces: tuple[Piece, ...]

    @property
    def are_fixed(self) -> bool:
        """True if the bits have the same position for every order code."""
        return self.low.is_constant and self.width.is_constant


# -- frame checks


@dataclass(frozen=True, slots=True)
class AlwaysIs:
    """The field is a constant."""

    field: Field
    bits: Bits
    value: int
    fault = Fault.CONSTANT


@dataclass(frozen=True, slots=True)
class ZerosAbove:
    """The field fills its container up to ``width`` bits. The constant ``padding`` is above it.

    ``bits`` are the bits of the container that the field can occupy. ``beyond`` are the bytes that it never occupies.
    """

    field: Field
    padding: Field
    bits: Bits
    beyond: tuple[Piece, ...]
    fault = Fault.CONSTANT

    @property
    def may_reach(self) -> bool:
        """True if there are bits above the field in the bytes that it occupies."""
        reached = self.field.container - 8 * len(self.beyond)
        return reached > (self.field.widest if self.bits.width.is_constant else 0)


@dataclass(frozen=True, slots=True)
class ParityIs:
    """The bit is the parity of the fields ``of``: 1 for an odd number of ones or, with ``odd``, for an even number.

    ``mask`` is the mask of the bits of each field that count, or 0 if all of them count. ``known_parity`` is the only
    valid value of the bit in this frame if each field in ``of`` has a single value.
    """

    field: Field
    bits: Bits
    of: tuple[Field, ...]
    of_bits: tuple[Bits, ...]
    odd: bool
    mask: int
    known_parity: int | None
    fault = Fault.CONSTANT

    @property
    def selector(self) -> Field:
        """The only field in ``of`` if the parity is known."""
        (field,) = self.of
        return field


@dataclass(frozen=True, slots=True)
class IsOneOf:
    """The field has one of these values: its named values or, for a selector, those that identify this frame."""

    field: Field
    bits: Bits
    values: tuple[int, ...]
    fault = Fault.RANGE


@dataclass(frozen=True, slots=True)
class AtMost:
    """The field, as a decimal number, has at most as many digits as all ``runs`` together."""

    field: Field
    bits: Bits
    limit: int
    runs: tuple[Digits, ...]
    fault = Fault.RANGE

    @property
    def digits(self) -> int:
        """Number of digits."""
        return sum(run.digits for run in self.runs)


@dataclass(frozen=True, slots=True)
class NotAbove:
    """The field is at most ``highest``, which is lower than its width allows for some order codes."""

    field: Field
    bits: Bits
    highest: Expression
    fault = Fault.RANGE


@dataclass(frozen=True, slots=True)
class IsBetween:
    """The signed field is from ``lowest`` to ``highest``, fewer numbers than its width allows for some order codes."""

    field: Field
    bits: Bits
    lowest: Expression
    highest: Expression
    fault = Fault.RANGE


Check = AlwaysIs | ZerosAbove | ParityIs | IsOneOf | AtMost | NotAbove | IsBetween


@dataclass(frozen=True, slots=True)
class FrameCrc:
    """The CRC at the end of a frame.

    It covers ``covered`` bits, starting at bit ``low``, which is everything before the CRC unless ``is_part`` is true.
    ``divides`` is true if the polynomial divides every valid word
    once the final XOR is removed. ``steps``, if any, then reduce the word without a table.
    """

    crc: Crc
    field: Field
    bits: Bits
    covered: Expression
    low: int
    is_part: bool
    divides: bool
    steps: tuple[FoldStep, ...]

    @property
    def gap(self) -> int:
        """Number of bits between those that it covers and the CRC."""
        return self.low - self.crc.width

    @property
    def inverted(self) -> int:
        """Mask of the CRC bits that are sent inverted."""
        return self.crc.xorout


@dataclass(frozen=True, slots=True)
class Gray:
    """The bits are sent in Gray code if the parameter ``when`` is not 0, or always if ``when`` is empty."""

    low: Expression
    width: Expression
    when: str

    @property
    def depends(self) -> bool:
        """True if the code, or the position of its bits, depends on the order code."""
        return bool(self.when) or not (self.low.is_constant and self.width.is_constant)


# -- parts of a frame


@dataclass(frozen=True, slots=True)
class Part:
    """A field of a decoded frame. ``shared`` is true if a join or a parity bit also uses its bits."""

    field: Field
    bits: Bits
    shared: bool

    @property
    def meaning(self) -> Meaning:
        """Operation that converts its bits."""
        return meaning_of(self.field)


@dataclass(frozen=True, slots=True)
class Whole:
    """A join: several fields as one number, most significant first. ``bits`` is set if they are adjacent."""

    join: Join
    fields: tuple[Field, ...]
    width: Expression
    widest: int
    bits: Bits | None

    @property
    def from_low(self) -> Iterator[tuple[Field, Expression]]:
        """Yield its fields, lowest first, each with the position of its lowest bit in the number."""
        low = Expression(0)
        for field in reversed(self.fields):
            yield field, low
            low += field.width

    def joined(self, numbers: Mapping[str, int], parameters: Mapping[str, int]) -> int:
        """Return the number of these fields, for an order code with these parameters."""
        return sum(numbers[field.name] << low.value(parameters) for field, low in self.from_low)

    def parts(self, number: int, parameters: Mapping[str, int]) -> dict[str, int]:
        """Return the numbers of its fields, by name. The inverse of ``joined``."""
        widths = ((field, low.value(parameters), field.width.value(parameters)) for field, low in self.from_low)
        return {field.name: number >> low & (1 << width) - 1 for field, low, width in widths}

    @property
    def depends(self) -> bool:
        """True if the position of any of its fields depends on the order code."""
        return not all(low.is_constant for _, low in self.from_low)


@dataclass(frozen=True, slots=True)
class Reserved:
    """Reserved bits. A decoder reports unexpected values but does not reject them.

    A decoded frame has one number for all reserved bits, ``unused``. Its bits starting at ``place`` are 1 where this
    field differs from ``value``.
    """

    field: Field
    bits: Bits
    value: int
    place: int

    @property
    def mask(self) -> int:
        """Mask of its bits in ``unused``."""
        return ((1 << self.bits.widest) - 1) << self.place


@dataclass(frozen=True, slots=True)
class Fixed:
    """A number that is the same in every frame of this layout."""

    number: int


@dataclass(frozen=True, slots=True)
class ValueOfField:
    """The value of a field. The inverse of its meaning converts it to bits."""

    field: Field

    @property
    def meaning(self) -> Meaning:
        """Operation whose inverse converts the value."""
        return meaning_of(self.field)


@dataclass(frozen=True, slots=True)
class ParityOf:
    """The parity bit over several fields. ``mask`` is the mask of the bits of each that count, or 0 for all bits."""

    of: tuple[Field, ...]
    odd: bool
    mask: int


@dataclass(frozen=True, slots=True)
class ReservedBits:
    """Reserved bits: ``value``, with those bits inverted that are 1 in ``unused``, starting at ``place``."""

    value: int
    place: int


@dataclass(frozen=True, slots=True)
class Term:
    """One field of an encoded frame, other than the CRC."""

    field: Field
    bits: Bits
    value: Fixed | ValueOfField | ParityOf | ReservedBits

    @property
    def depends(self) -> bool:
        """True if its position or, for a signed field, its width depends on the order code."""
        return not self.field.low.is_constant or (self.field.number.signed and not self.field.width.is_constant)


@dataclass(frozen=True)
class Codec:
    """The plan of a layout.

    ``by_word`` is true if the frame is processed as one number, because it is sent as bits, the order code moves its
    fields, or Gray code must be converted first. Otherwise its bytes are processed one by one. ``alternatives`` are the
    questions whose answers the caller must pass.
    """

    layout: Layout
    by_word: bool
    length: int
    selector: Field | None
    crc: FrameCrc | None
    gray: Gray | None
    parts: tuple[Part, ...]
    wholes: tuple[Whole, ...]
    alternatives: tuple[Alternative, ...]
    reserved: tuple[Reserved, ...]
    checks: tuple[Check, ...]
    terms: tuple[Term, ...]

    @property
    def keeps_others(self) -> bool:
        """True if bits outside all fields are kept: register bits that the manual does not define."""
        return self.layout.gaps == "unspecified" and not self.layout.sender

    @property
    def in_bytes(self) -> bool:
        return self.layout.in_bytes

    @cached_property
    def constants(self) -> Mapping[str, int]:
        """Values of the fields that always have the same bits, by name, including the zeros that pad other fields."""
        constants = {check.field.name: check.value for check in self.checks if isinstance(check, AlwaysIs)}
        return constants | {check.padding.name: 0 for check in self.checks if isinstance(check, ZerosAbove)}

    @cached_property
    def depends(self) -> bool:
        """True if any position or width, or the highest position, depends on the order code."""
        answered = {name for alternative in self.alternatives for name in alternative.answers[0].sets}
        places = (place for field in self.layout.fields for place in (field.low, field.width))
        highest = (check.highest for check in self.checks if isinstance(check, (NotAbove, IsBetween)))
        can_be_gray = self.gray is not None and bool(self.gray.when)
        expressions = (self.layout.bits, *places, *highest)
        return can_be_gray or any(not answered.issuperset(expression.parameters) for expression in expressions)

    @property
    def from_low(self) -> range:
        """Return the indices of the bytes, least significant byte first."""
        return range(self.length) if self.layout.byte_order == "low_byte_first" else range(self.length - 1, -1, -1)

    def faults(self) -> tuple[Fault, ...]:
        """Return the errors that a decoder of this layout can find, without duplicates."""
        faults = {Fault.LENGTH, *(check.fault for check in self.checks)}
        if self.crc is not None:
            faults.add(Fault.CRC)
        return tuple(fault for fault in Fault if fault in faults)

    def bits_of(self, name: str) -> Bits:
        return bits_of(self.layout, self.layout.field(name))


def codec_of(device: Device, layout: Layout) -> Codec:
    """Return the plan for a layout of a frame or of a register's bytes."""
    have_places = all(field.pieces or field.padding_of for field in layout.fields)
    by_word = not (layout.in_bytes and have_places) or bool(layout.gray_of)
    selector = fixed_selector(layout)
    shared_names = {name for join in layout.joins for name in join.fields}
    shared_names |= {name for field in layout.fields if isinstance(field.kind, Parity) for name in field.kind.of}
    data_fields = (field for field in layout.fields if field.carries_data and field is not selector)
    return Codec(
        layout=layout,
        by_word=by_word,
        length=layout.widest // 8,
        selector=selector,
        crc=_crc(device, layout),
        gray=_gray(layout),
        parts=tuple(Part(field, bits_of(layout, field), field.name in shared_names) for field in data_fields),
        wholes=tuple(_wholes(layout, by_word)),
        alternatives=device.alternatives_of(layout),
        reserved=tuple(_reserved(layout)),
        checks=(*_constants(layout, by_word), *_ranges(layout), *_position_checks(device, layout)),
        terms=tuple(_terms(layout)),
    )


def _reserved(layout: Layout) -> Iterator[Reserved]:
    for field, place in layout.unused:
        yield Reserved(field, bits_of(layout, field), _unused_value(field), place)


def fixed_selector(layout: Layout) -> Field | None:
    """Return the selector if a single value of it identifies the frame."""
    return layout.field(layout.selector) if len(layout.selects) == 1 else None


def only_value(layout: Layout, field: Field) -> int | None:
    """Return the only value of a constant or of a selector with one value, or None for any other field."""
    if isinstance(field.kind, Constant):
        return field.kind.value
    return layout.selects[0] if field is fixed_selector(layout) else None


def bits_of(layout: Layout, field: Field) -> Bits:
    """Return the bits of a field. For a padded field in bytes, include all bytes that it can occupy."""
    reached = tuple(piece for piece in field.pieces if not field.container or piece.left < field.widest)
    return _bits(layout, field.low, field.width, field.widest, reached)


def _bits(layout: Layout, low: Expression, width: Expression, widest: int, pieces: tuple[Piece, ...] = ()) -> Bits:
    on_top = not layout.in_bytes and layout.bits - low - width == Expression(0)
    return Bits(low, width, widest, on_top, pieces)


def _crc(device: Device, layout: Layout) -> FrameCrc | None:
    field = layout.crc_field
    if field is None or not isinstance(field.kind, CrcValue):
        return None
    crc = device.crc(field.kind.crc)
    bits = bits_of(layout, field)
    if field.kind.of:
        first, last = layout.field(field.kind.of[0]), layout.field(field.kind.of[-1])
        return FrameCrc(
            crc=crc,
            field=field,
            bits=bits,
            covered=first.low + first.width - last.low,
            low=last.low.constant,
            is_part=True,
            divides=False,
            steps=(),
        )
    covers_all = not covers_part(device, crc)
    return FrameCrc(
        crc=crc,
        field=field,
        bits=bits,
        covered=layout.bits - Expression(crc.width),
        low=crc.width,
        is_part=False,
        divides=covers_all and divides(crc, layout),
        steps=fold_steps(crc, layout.widest) if covers_all else (),
    )


def _gray(layout: Layout) -> Gray | None:
    if not layout.gray_of:
        return None
    fields = [layout.field(name) for name in layout.names_in(layout.gray_of)]
    return Gray(fields[-1].low, sum((field.width for field in fields), Expression(0)), layout.gray_when)


def _wholes(layout: Layout, by_word: bool) -> Iterator[Whole]:
    for join in layout.joins:
        fields = tuple(layout.field(name) for name in join.fields)
        width = sum((field.width for field in fields), Expression(0))
        widest = min(sum(field.widest for field in fields) or 1, 64)
        side_by_side = all(upper.low == lower.low + lower.width for upper, lower in pairwise(fields))
        bits = _bits(layout, fields[-1].low, width, widest) if by_word and side_by_side else None
        yield Whole(join=join, fields=fields, width=width, widest=widest, bits=bits)


def _constants(layout: Layout, by_word: bool) -> Iterator[Check]:
    """Yield the checks of constants and parity bits in the order of the fields, and therefore of their errors."""
    for field in layout.fields:
        bits = bits_of(layout, field)
        match field.kind:
            case Constant(padding_of=name) if name and not by_word:
                padded = layout.field(name)
                bits = bits_of(layout, padded)
                beyond = tuple(piece for piece in padded.pieces if piece not in bits.pieces)
                yield ZerosAbove(padded, field, bits, beyond)
            case Constant(value=number):
                yield AlwaysIs(field, bits, number)
            case Parity(of=names, odd=odd) as kind:
                fields = tuple(map(layout.field, names))
                of_bits = tuple(bits_of(layout, covered) for covered in fields)
                yield ParityIs(
                    field=field,
                    bits=bits,
                    of=fields,
                    of_bits=of_bits,
                    odd=odd,
                    mask=_parity_mask(kind, fields),
                    known_parity=_known_parity(layout, fields, kind),
                )


def _ranges(layout: Layout) -> Iterator[Check]:
    for field in layout.fields:
        bits = bits_of(layout, field)
        values = allowed_values(layout, field)
        if values:
            yield IsOneOf(field, bits, values)
        if field.runs:
            first = field.runs[0]
            yield AtMost(field, bits, first.divisor * first.modulus - 1, field.runs)


def _position_checks(device: Device, layout: Layout) -> Iterator[Check]:
    position = device.range_in(layout)
    if position is not None and position.field.number.signed:
        yield IsBetween(position.field, bits_of(layout, position.field), position.lowest, position.highest)
    elif position is not None:
        yield NotAbove(position.field, bits_of(layout, position.field), position.highest)


def allowed_values(layout: Layout, field: Field) -> tuple[int, ...]:
    """Return the valid values of a selector or a choice, without duplicates. Return none if every value is valid."""
    named_numbers = (value.value for value in field.values)
    values = dict.fromkeys(layout.selects if field.name == layout.selector else named_numbers)
    # Each value fits in the bits, so this many values are all that are possible.
    is_full = field.width.is_constant and len(values) == 1 << field.widest
    return () if is_full else tuple(values)


def _known_parity(layout: Layout, fields: tuple[Field, ...], kind: Parity) -> int | None:
    """Return the parity bit if every field has a single value, otherwise None."""
    value = only_value(layout, fields[0]) if len(fields) == 1 else None
    return parity(value & kind.mask, kind.odd) if value is not None else None


def _parity_mask(kind: Parity, fields: tuple[Field, ...]) -> int:
    """Return the mask of the bits that count, no wider than the fields, or 0 if all of them count."""
    if not kind.over:
        return 0
    widest = max(field.widest for field in fields)
    return kind.mask & (1 << widest) - 1


def parity(number: int, odd: bool) -> int:
    return (number.bit_count() & 1) ^ odd


def _unused_value(field: Field) -> int:
    return field.kind.value if isinstance(field.kind, Unused) else 0


def _terms(layout: Layout) -> Iterator[Term]:
    places = {field.name: place for field, place in layout.unused}
    for field in layout.fields:
        single_value = only_value(layout, field)
        match field.kind:
            case CrcValue():
                continue
            case Parity(of=names, odd=odd) as kind:
                fields = tuple(map(layout.field, names))
                bit, mask = _known_parity(layout, fields, kind), _parity_mask(kind, fields)
                value: Fixed | ValueOfField | ParityOf | ReservedBits = (
                    ParityOf(fields, odd, mask) if bit is None else Fixed(bit)
                )
            case Unused(number):
                value = ReservedBits(number, places[field.name])
            case _:
                value = ValueOfField(field) if single_value is None else Fixed(single_value)
        yield Term(field, bits_of(layout, field), value)


def characters(field: Field) -> tuple[tuple[int, int], ...]:
    """Return the index and byte of each character in a text field, or nothing if they do not fill whole bytes."""
    if not isinstance(field.kind, Text) or any(piece.right or piece.mask != 0xFF for piece in field.pieces):
        return ()
    return tuple((field.widest // 8 - 1 - piece.left // 8, piece.byte) for piece in reversed(field.pieces))


def is_plain_flag(part: Part) -> bool:
    """Return whether a part is a flag whose bit no join and no parity bit uses."""
    return isinstance(part.field.kind, Flag) and not part.shared
