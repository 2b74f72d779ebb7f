"""A decoder in C, and the functions that convert the positions that it returns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import reduce
from operator import or_

from ...model import Field, Layout, Measurement, assert_never, cite
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.codec import ShiftedBits, characters, is_plain_flag
from ...plan.operations import AlwaysIs, Check, ParityIs, Part, Whole, ZerosAbove
from ...plan.values import (
    Active,
    Characters,
    DigitRuns,
    Named,
    PositionRange,
    Raw,
    TwosComplement,
    ZeroMeans,
    position_ranges,
)
from ...say.names_and_places import words
from .bits import digits
from .context import Context, Function, wide_number_of
from .names import (
    Call,
    Cast,
    Conditional,
    Declared,
    Expr,
    Name,
    Number,
    Operation,
    Scope,
    c_name,
    joined,
    masked,
    unsigned,
)
from .structs import Struct

#: Names of arguments and locals in the generated functions. The locals of fields have other names.
_LOCALS = frozenset("variant word received plain bytes length out in crc index v wide value flags".split())


@dataclass(frozen=True, slots=True)
class ByteIs:
    """A byte whose bits under ``mask`` never change. ``reasons`` contains the names of its constant fields."""

    byte: int
    mask: int
    value: int
    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FlagsIn:
    """The byte of the next flags. ``is_first`` and ``is_only`` show whether there are others."""

    byte: int
    is_first: bool
    is_only: bool


@dataclass(frozen=True, slots=True)
class UnusedIn:
    """A byte with unused bits, at its position in the member. The first byte initialises the local variable."""

    bits: Expr
    is_first: bool


@dataclass(frozen=True, slots=True)
class UnusedAre:
    """All unused bits."""

    bits: Expr


class Decoder:
    """The operations of a decoder in order, and the expressions in them."""

    def __init__(self, struct: Struct) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.reader = struct.reader
        self._plain_flags = {part.field.name for part in self.plan.parts if is_plain_flag(part)}
        parities = [op for op in self.plan.checks if isinstance(op, ParityIs)]
        self._word_parities = {op.field.name: mask for op in parities if (mask := self._mask_in_word(op))}
        checked = {field.name for op in parities if op.field.name not in self._word_parities for field in op.of}
        checked |= {op.field.name for op in self.plan.checks if isinstance(op, ZerosAbove)}
        self._only_reported = {op.field.name for op in self.plan.reserved} - checked

    def local(self, field: Field) -> Expr:
        """Return the local that holds the bits of a field."""
        return Name(c_name(field.name, _LOCALS))

    @property
    def fields_with_local(self) -> tuple[Field, ...]:
        """The fields that have a local."""
        untaken = self._plain_flags | self._only_reported | self.plan.constants.keys()
        untaken |= self._word_parities.keys()
        untaken |= {part.field.name for part in self.plan.parts if isinstance(part.meaning, Characters)}
        untaken |= {crc.field.name for crc in self.plan.crcs}
        return tuple(field for field in self.plan.layout.fields if field.name not in untaken)

    def raw(self, field: Field) -> tuple[str, Expr]:
        """Return the type and the bits of a field."""
        return self.reader.value(self.plan.bits_of(field.name))

    def bits_as_sent(self, field: Field) -> Expr:
        """Return the bits of a field before any Gray code is converted."""
        return self.reader.sent(field)

    # -- errors

    @property
    def checks(self) -> Iterator[Check | ByteIs]:
        """The checks in order. A parity bit of the selector comes last, since its check covers both."""
        checks = self.plan.checks
        parities = [op for op in checks if isinstance(op, ParityIs)]
        checked_selectors = {op.selector.name for op in parities if op.known_parity is not None}
        if self.plan.by_word:
            yield from (op for op in checks if isinstance(op, AlwaysIs))
        else:
            yield from (op for op in checks if isinstance(op, ZerosAbove) and op.may_reach)
            yield from _constant_bytes(checks)
        yield from sorted(parities, key=lambda op: op.known_parity is not None)
        for op in checks:
            if not isinstance(op, (AlwaysIs, ZerosAbove, ParityIs)) and op.field.name not in checked_selectors:
                yield op

    def is_of_other_frame(self, op: ParityIs) -> Expr:
        """Return the condition that the selector or its parity bit is not that of this frame.

        A byte that holds both is compared once.
        """
        assert op.known_parity is not None
        (selected,) = self.plan.layout.selects
        pieces = [
            *((piece, selected) for piece in op.of_bits[0].pieces),
            *((piece, op.known_parity) for piece in op.bits.pieces),
        ]
        byte = pieces[0][0].byte if pieces else 0
        if self.plan.by_word or any(piece.byte != byte for piece, _ in pieces):
            other_parity = Operation("!=", (self.local(op.field), Number(op.known_parity)))
            other_value = self.struct.is_none_of(
                op.selector, self.local(op.selector), self.plan.layout.selects, is_raw=True
            )
            return joined("||", (other_value, other_parity))
        # The other constants in it have been checked.
        constants = (constant for constant in _constant_bytes(self.plan.checks) if constant.byte == byte)
        constant_bits = next(constants, ByteIs(byte, 0, 0, ()))
        mask, value = constant_bits.mask, constant_bits.value
        for piece, number in pieces:
            mask |= piece.mask << piece.right
            value |= (number >> piece.left & piece.mask) << piece.right
        whole_byte = Name(f"bytes[{byte}]")
        bits = masked(whole_byte, mask) if mask != 0xFF else whole_byte
        return Operation("!=", (bits, Number(value, hexadecimal=True)))

    def _mask_in_word(self, op: ParityIs) -> int:
        """Return the mask of a parity bit and all bits that it covers, 0 if they are not always in the lower 32 bits.

        A selector with a known parity is compared instead.
        """
        all_bits = (op.bits, *op.of_bits)
        if not self.plan.by_word or self.plan.gray is not None or op.mask or op.known_parity is not None:
            return 0
        if not all(bits.are_fixed for bits in all_bits):
            return 0
        masks = (((1 << bits.width.constant) - 1) << bits.low.constant for bits in all_bits)
        mask = reduce(or_, masks)
        return mask if mask.bit_length() <= 32 else 0

    def parity_in_word(self, op: ParityIs) -> Expr | None:
        """Return the parity of a parity bit and all bits that it covers, if the word has them all, or None."""
        mask = self._word_parities.get(op.field.name)
        return Call("cw_parity", (masked(self.reader.lower(32), mask),)) if mask else None

    def parity(self, fields: Sequence[Field], mask: int) -> Expr:
        if self.plan.parity_covers_gray:
            return self.reader.parity_as_sent(fields, mask)
        return self.reader.parity([(self.local(field), field.widest) for field in fields], mask)

    # -- members

    @property
    def fills(self) -> Iterator[FlagsIn | Part | Whole | UnusedIn | UnusedAre]:
        """The operations that fill the members, in order. Unused bits are taken from a byte together with its flags."""
        unused = self.struct.unused
        waiting = {bits.byte: bits for bits in unused.moved if bits.byte is not None}
        for op in self._members:
            yield op
            if isinstance(op, FlagsIn) and op.byte in waiting:
                yield from self._gather_unused(waiting, op.byte, Name("flags"))
        for byte in tuple(waiting):
            yield from self._gather_unused(waiting, byte, Name(f"bytes[{byte}]"))
        if unused and (self.plan.by_word or unused.single):
            yield UnusedAre(unused.member)

    def _gather_unused(self, waiting: dict[int, ShiftedBits], byte: int, bits: Expr) -> Iterator[UnusedIn | UnusedAre]:
        """Yield the unused bits of a byte, and after the last such byte the whole member."""
        unused, moved = self.struct.unused, waiting.pop(byte)
        if len(unused.moved) > 1:
            yield UnusedIn(unused.at_place(moved, bits), len(waiting) + 1 == len(unused.moved))
            bits = Name("unused")
        if not waiting:
            yield UnusedAre(unused.member_from(bits))

    @property
    def _members(self) -> Iterator[FlagsIn | Part | Whole]:
        in_bytes = [part for part in self.plan.parts if is_plain_flag(part) and not self.plan.by_word]
        bytes_ = [part.bits.pieces[0].byte for part in in_bytes]
        changes = [index for index, byte in enumerate(bytes_) if index == 0 or byte != bytes_[index - 1]]
        first = {in_bytes[index].field.name: bytes_[index] for index in changes}
        for part in self.plan.parts:
            if part.field.name in first:
                yield FlagsIn(first[part.field.name], part is in_bytes[0], len(changes) == 1)
            yield part
        yield from self.plan.wholes

    def members(self, part: Part) -> Iterator[tuple[str, Expr]]:
        """Yield the members that a part fills, each with its value."""
        name, bits = c_name(part.field.name), self.local(part.field)
        type_ = self.struct.type_of(part.field)
        match part.meaning:
            case Raw() | Named():
                yield name, self._bits_as(type_, part)
            case TwosComplement():
                width = self.struct.scope.of(part.field.width)
                yield name, Cast(type_, Call("cw_signed", (bits, width)))
            case ZeroMeans(number):
                yield name, Cast(type_, Conditional(Operation("==", (bits, Number(0))), Number(number), bits))
            case Active(low):
                bit = self.reader.flag(part.bits) if is_plain_flag(part) else bits
                yield name, Name(self._is_active(part, bit, low).operand)
            case DigitRuns(runs):
                yield name, self._bits_as(type_, part)
                for run in runs:
                    digit = digits(bits, part.field, run)
                    yield c_name(run.name), Cast(unsigned((run.modulus - 1).bit_length()), digit)
            case Characters():
                for index, byte in characters(part.field):
                    yield f"{name}[{index}]", Cast(type_, Name(f"bytes[{byte}]"))
            case never:
                assert_never(never)

    def _is_active(self, part: Part, bit: Expr, low: bool) -> Expr:
        """Return the condition that a flag is active. A flag that the order code does not have is inactive."""
        if low and not part.field.width.is_constant:
            return Operation("!=", (bit, self.struct.scope.of(part.field.width)))
        return Operation("==" if low else "!=", (bit, Number(0)))

    def _bits_as(self, type_: str, part: Part) -> Expr:
        """Return the bits of a part, with a cast if the member has another type."""
        bits = self.local(part.field)
        return bits if self.raw(part.field)[0] == type_ else Cast(type_, bits)

    def is_fixed(self, field: Field) -> bool:
        """Return True if a field always has the same bits."""
        return field.name in self.plan.constants

    def whole(self, whole: Whole) -> Expr:
        return self.reader.whole(whole, self.local)


def _constant_bytes(checks: Iterable[Check]) -> Iterator[ByteIs]:
    constant_bytes: dict[int, ByteIs] = {}
    for op in checks:
        name = words(op.field.name)
        match op:
            case ZerosAbove(beyond=beyond):
                constant_bytes |= {piece.byte: ByteIs(piece.byte, 0xFF, 0, (f"above {name}",)) for piece in beyond}
            case AlwaysIs(bits=bits, value=value):
                for piece in bits.pieces:
                    byte_so_far = constant_bytes.get(piece.byte, ByteIs(piece.byte, 0, 0, ()))
                    mask = byte_so_far.mask | piece.mask << piece.right
                    part = (value >> piece.left & piece.mask) << piece.right
                    reasons = tuple(dict.fromkeys((*byte_so_far.reasons, name)))
                    constant_bytes[piece.byte] = ByteIs(piece.byte, mask, byte_so_far.value | part, reasons)
    return (constant_bytes[byte] for byte in sorted(constant_bytes))


@dataclass(frozen=True, slots=True)
class RangeFunctions:
    """The functions about the range of positions: the modulus, and the distance between two positions.

    ``scope`` precedes their names: it is empty, or the name of a frame with a range that other frames do not have.
    ``modulus`` is None for an angle, and for a position that never wraps around.
    """

    prefix: str
    scope: str
    is_signed: bool
    never_wraps: bool
    modulus: Function | None
    turns: Expr | None
    one_turn: bool
    layouts: tuple[Layout, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        if not self.never_wraps:
            yield f"{self.scope}modulus"
        yield f"{self.scope}position_difference"


@dataclass(frozen=True, slots=True)
class AnglePositions:
    """Positions of a rotary encoder."""

    prefix: str
    where: str
    is_signed: bool
    per_turn: Function
    ranges: tuple[RangeFunctions, ...]

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        yield "counts_per_turn"
        for functions in self.ranges:
            yield from functions.names
        yield from ("turns", "degrees")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


@dataclass(frozen=True, slots=True)
class LengthPositions:
    """Positions of a linear encoder."""

    prefix: str
    where: str
    is_signed: bool
    ranges: tuple[RangeFunctions, ...]
    step: Expr
    step_varies: bool
    unit: str
    per_mm: int
    per_counts: Expr | None

    @property
    def names(self) -> Iterator[str]:
        """The functions, by the ends of their names."""
        for functions in self.ranges:
            yield from functions.names
        yield from (self.unit, "millimetres")

    def declared(self) -> Iterator[Declared]:
        yield from ((f"{self.prefix}_{name}", ()) for name in self.names)


Positions = AnglePositions | LengthPositions


def positions(context: Context) -> Positions | None:
    """Return the functions that convert the positions of the interface, if the manual gives their unit."""
    measurement = context.device.measurement_of(context.interface.name)
    return _positions(context, measurement) if measurement is not None else None


def _positions(context: Context, measurement: Measurement) -> Positions | None:
    position_ranges_ = position_ranges(context.device, context.interface)
    is_signed = any(position_range.signed_field is not None for position_range in position_ranges_)
    scope, prefix, where = context.scope, context.prefix, f"[{cite(measurement.source)}]"
    ranges = tuple(_range_functions(context, position_ranges_))
    step, fine, counts = measurement.step_um, measurement.step_nm, measurement.per_counts
    if measurement.counts_per_turn is not None:
        about = f"Return the number of counts in one revolution {where}."
        per_turn = wide_number_of(scope, f"{prefix}_counts_per_turn", measurement.counts_per_turn, about)
        return AnglePositions(prefix, where, is_signed, per_turn, ranges)
    length = step if step is not None else fine
    if length is not None:
        unit, per_mm = ("micrometres", 1_000) if step is not None else ("nanometres", 1_000_000)
        per_counts = _signed(scope, counts) if counts is not None else None
        varies = not all(step.is_constant for step in measurement.steps)
        return LengthPositions(
            prefix=prefix,
            where=where,
            is_signed=is_signed,
            ranges=ranges,
            step=_signed(scope, length),
            step_varies=varies,
            unit=unit,
            per_mm=per_mm,
            per_counts=per_counts,
        )
    return None


def _range_functions(context: Context, ranges: Sequence[PositionRange]) -> Iterator[RangeFunctions]:
    """Yield the functions of the interface, or those of each frame if their ranges differ."""
    for position_range in ranges:
        if not position_range.has_difference:
            continue
        if len(ranges) == 1:
            yield _functions_of_range(context, position_range, "", position_range.layouts)
            continue
        for layout in position_range.layouts:
            yield _functions_of_range(context, position_range, f"{layout.name}_", (layout,))


def _functions_of_range(
    context: Context, position_range: PositionRange, before: str, layouts: tuple[Layout, ...]
) -> RangeFunctions:
    turns, is_signed = position_range.measurement.turns, position_range.signed_field is not None
    return RangeFunctions(
        prefix=context.prefix,
        scope=before,
        is_signed=is_signed,
        never_wraps=position_range.never_wraps,
        modulus=_modulus(context, position_range, f"{context.prefix}_{before}modulus"),
        turns=context.scope.of(turns) if turns is not None else None,
        one_turn=turns == Expression(1),
        layouts=layouts,
    )


def _modulus(context: Context, position_range: PositionRange, name: str) -> Function | None:
    """Return the function for the number of counts after which a length wraps around."""
    measurement, is_signed = position_range.measurement, position_range.signed_field is not None
    if measurement.modulus is None:
        return None
    wraps = "wraps around" if is_signed else "wraps around to 0"
    about = f"Return the number of counts after which the position {wraps} [{cite(measurement.source)}]."
    if measurement.highest is not None and is_signed:
        about += f" The highest position is {measurement.highest.render()}."
    elif measurement.highest is not None:
        about += f" An offset raises all positions, up to {measurement.highest.render()}."
    return wide_number_of(context.scope, name, measurement.modulus, about)


def _signed(scope: Scope, value: Expression) -> Expr:
    return Number(value.constant, signed=True) if value.is_constant else Cast("int64_t", scope.of(value))
