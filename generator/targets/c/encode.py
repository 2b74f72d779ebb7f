"""Encoders in C, which assemble the bits of fields in a word or byte by byte."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

from ...model import Field, Piece, assert_never
from ...plan.codec import characters
from ...plan.limits import NoPowerOfTwo, OutsideLimits, Refusal, TooWide, refusals
from ...plan.operations import Fixed, ParityIs, ParityOf, ReservedBits, Term, ValueOfField, Whole, ZerosAbove
from ...plan.values import (
    Active,
    Characters,
    DigitRuns,
    Named,
    Raw,
    TwosComplement,
    ZeroMeans,
    meaning_of,
    widest_value,
)
from .expr import (
    Cast,
    Conditional,
    Expr,
    Name,
    Number,
    Operation,
    joined,
    masked,
    shifted_left,
    shifted_right,
    size_of,
    unsigned,
)
from .names import c_name
from .structs import Struct


class Encoder:
    """The operations of an encoder in order, and the expressions in them."""

    def __init__(self, struct: Struct, limits: Sequence[OutsideLimits]) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.reader = struct.reader
        self.refusals = tuple(op for op in (*_powers_first(refusals(self.plan)), *limits) if not _never_applies(op))
        self._parities = frozenset(op.field.name for op in self.plan.checks if isinstance(op, ParityIs))
        self._padded = frozenset(op.field.name for op in self.plan.checks if isinstance(op, ZerosAbove))
        self._reserved = frozenset(op.field.name for op in self.plan.reserved)

    def member_of(self, field: Field) -> Expr:
        """Return the member of the struct that is encoded."""
        return Name(f"in->{c_name(field.name)}")

    # -- values that are refused

    def number(self, field: Field) -> Expr:
        """Return a member as a number, with a cast if it is of an enumeration."""
        return Cast("uint32_t", self.member_of(field)) if self.struct.enumeration(field) else self.member_of(field)

    def joined(self, whole: Whole) -> Expr:
        return self.reader.joined(whole, self._bits_in_whole)

    def total(self, field: Field) -> Expr:
        """Return the number that a field's runs of digits form."""
        work = unsigned(max(field.widest, 32))
        runs = ((Name(f"in->{c_name(run.name)}"), run.divisor) for run in field.runs)
        return joined("+", tuple(_run_product(work, run, divisor) for run, divisor in runs))

    # -- the word

    @property
    def word(self) -> tuple[Expr, ...]:
        terms = (term for term in self.plan.terms if not isinstance(term.value, ReservedBits))
        variable_terms = (term for term in terms if not self._is_always_zero(term))
        return (*map(self._term, variable_terms), *self.struct.unused.in_word)

    def _term(self, op: Term) -> Expr:
        value = self._value(op)
        if op.field.low.is_constant and not op.field.low.constant:
            return Cast("uint64_t", value) if isinstance(value, Name) else value
        return shifted_left(Cast("uint64_t", value), self.struct.scope.of(op.field.low))

    def _value(self, op: Term) -> Expr:
        match op.value:
            case Fixed(number):
                return Number(number, hexadecimal=op.field.name not in self._parities)
            case ParityOf(covered_fields, odd, mask):
                parts = [(self._bits_of_member(field), field.widest) for field in covered_fields]
                if len(parts) == 1 and parts[0][1] <= 32:
                    parts = [(Cast("uint32_t", parts[0][0]), parts[0][1])]
                ones = self.reader.parity(parts, mask)
                return Operation("^", (ones, Number(1))) if odd else ones
            case ValueOfField(field):
                return self._bits_of_member(field)
            case ReservedBits():
                return self.struct.unused.bits_of(op.field)

    def _is_always_zero(self, op: Term) -> bool:
        """Return True if none of its bits is ever set."""
        is_derived = op.field.name in self.plan.constants or op.field.name in self._parities
        return is_derived and op.value == Fixed(0)

    def _bits_in_whole(self, field: Field) -> Expr:
        """Return the bits of a member as an unsigned number. Some compilers give an enumeration a sign."""
        bits = self._bits_of_member(field)
        return Cast(unsigned(field.widest), bits) if isinstance(meaning_of(field), Named) else bits

    def _bits_of_member(self, field: Field) -> Expr:
        if field.name in self._reserved:
            return self.struct.unused.bits_of(field)
        name = self.member_of(field)
        match meaning_of(field):
            case Active(low):
                return Conditional(name, *((Number(0), Number(1)) if low else (Number(1), Number(0))))
            case TwosComplement():
                return Operation("&", (Cast("uint64_t", name), self.struct.scope.mask(field.width)))
            case ZeroMeans(number):
                return Conditional(Operation("==", (name, Number(number))), Number(0), name)
            case Raw() | Named() | DigitRuns() | Characters():
                return name
            case never:
                assert_never(never)

    # -- the bytes

    @property
    def bytes(self) -> Iterator[tuple[int, Expr]]:
        """The value of each byte, except those of the CRC."""
        members = self._member_bytes()
        crc_bytes = self._crc_bytes()
        for byte, number in self._constant_bytes().items():
            if byte in members:
                constant = [Number(number, hexadecimal=True)] if number else []
                yield byte, _as_byte(joined("|", (*constant, *members[byte])))
            elif byte not in crc_bytes:
                yield byte, Number(number, hexadecimal=True)

    def _crc_bytes(self) -> set[int]:
        """Return the bytes of a CRC that is computed over whole bytes."""
        crc = self.plan.crc
        if crc is None or not self.plan.layout.crc_covers_bytes:
            return set()
        return {piece.byte for piece in crc.bits.pieces}

    def _constant_bytes(self) -> dict[int, int]:
        """Return the constant bits of every byte."""
        constants = dict.fromkeys(range(self.plan.length), 0)
        for op in self.plan.terms:
            match op.value:
                case Fixed(value):
                    for piece in op.field.pieces:
                        constants[piece.byte] |= (value >> piece.left & piece.mask) << piece.right
        return constants

    def _member_bytes(self) -> dict[int, list[Expr]]:
        """Return what members and parity bits contribute to each byte."""
        contributions: dict[int, list[Expr]] = {}
        for byte, bits in chain(self.struct.unused.in_bytes, *map(self._term_bytes, self.plan.terms)):
            contributions.setdefault(byte, []).append(bits)
        return contributions

    def _term_bytes(self, op: Term) -> Iterator[tuple[int, Expr]]:
        """Yield the contributions of a term that is not constant."""
        match op.value:
            case ReservedBits() | Fixed():
                return
            case ValueOfField(field):
                yield from self._given_bytes(op, field)
            case ParityOf():
                for piece in op.field.pieces:
                    yield piece.byte, shifted_left(shifted_right(self._value(op), piece.left), piece.right)
            case _:
                assert_never(op.value)

    def _given_bytes(self, op: Term, field: Field) -> Iterator[tuple[int, Expr]]:
        """Yield the contributions of a member to its bytes."""
        name = self.member_of(field)
        match meaning_of(field):
            case Characters():
                for index, byte in characters(field):
                    yield byte, Cast("uint8_t", Name(f"{name}[{index}]"))
            case Active(low):
                for piece in field.pieces:
                    bit, zero = Number(piece.mask << piece.right, hexadecimal=True), Number(0, hexadecimal=True)
                    yield piece.byte, Conditional(name, zero, bit) if low else Conditional(name, bit, zero)
            case TwosComplement():
                # Copies of the sign must not reach the zeros above the field.
                bits = self._value(op) if field.name in self._padded else Cast("uint64_t", name)
                for piece in field.pieces:
                    yield piece.byte, self._placed_piece(field, piece, bits, may_be_wider=True)
            case Raw() | ZeroMeans() | Named() | DigitRuns():
                for piece in field.pieces:
                    if piece.left < size_of(widest_value(field)):
                        yield (
                            piece.byte,
                            self._placed_piece(field, piece, self._value(op), may_be_wider=len(field.pieces) > 1),
                        )
            case never:
                assert_never(never)

    def _placed_piece(self, field: Field, piece: Piece, bits: Expr, may_be_wider: bool) -> Expr:
        """Return one piece of the bits of a field, shifted to its place in its byte."""
        value = shifted_right(bits, piece.left)
        if may_be_wider and piece.mask != 0xFF:
            value = masked(value, piece.mask)
        if piece.right:
            return shifted_left(Cast("uint32_t", value), piece.right)
        is_wide = isinstance(value, Name) and self.struct.type_of(field) != unsigned(8)
        return Cast("uint32_t", value) if is_wide else value


def _as_byte(value: Expr) -> Expr:
    """Cast a value to a byte. A one-byte member needs no cast."""
    if isinstance(value, Name):
        return value
    return Cast("uint8_t", value.value if isinstance(value, Cast) and isinstance(value.value, Name) else value)


def _run_product(type_: str, run: Expr, divisor: int) -> Expr:
    return Operation("*", (Cast(type_, run), Number(divisor))) if divisor > 1 else run


def _powers_first(ops: Iterable[Refusal]) -> list[Refusal]:
    """Move checks for a power of two before checks of the width. Both give the same error."""
    ordered: list[Refusal] = []
    for op in ops:
        ordered.insert(len(ordered) - isinstance(op, NoPowerOfTwo), op)
    return ordered


def _never_applies(op: Refusal) -> bool:
    """Return True if no value of the member's type would be refused."""
    return isinstance(op, TooWide) and op.width.is_constant and size_of(op.field.widest) == op.field.widest
