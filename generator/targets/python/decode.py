"""Decoding of a frame or register: expressions for its checks and for the values of its fields."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import field
from functools import cached_property

from ...model import Digits, Field, Piece
from ...model.expressions import Expression
from ...model.never import assert_never
from ...model.record import dataclass
from ...plan.codec import (
    AlwaysIs,
    AtMost,
    Check,
    Codec,
    IsBetween,
    IsOneOf,
    NotAbove,
    ParityIs,
    Part,
    ZerosAbove,
    parity,
)
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from .bits import Reader
from .expr import Atom, Expr, Operation, Scope, call, coded, grouped, mask, number
from .names import ClassNames

#: Number of bits per CRC table.
TABLE_BITS = 16
#: Maximum length of a frame, in bytes, whose bytes have a name each.
_UNPACKED = 16


@dataclass(frozen=True)
class Once(Scope):
    """Scope that assigns a name to each value that depends on the order code, and records its expression.

    Values that depend on the parameters ``answered`` are not assigned once, since a caller can give other answers.
    """

    answered: frozenset[str] = frozenset()
    named: dict[str, str] = field(default_factory=dict)

    def of(self, value: Expression) -> Expr:
        return self._name("size", value, super().of(value))

    def ones(self, width: Expression) -> Expr:
        return self._name("ones", width, Scope(self.names).ones(width))

    def _name(self, kind: str, value: Expression, found: Expr) -> Expr:
        if value.is_constant or not self.answered.isdisjoint(value.parameters):
            return found
        known = {text: name for name, text in self.named.items()}
        name = known.get(str(found), f"{kind}_{len(self.named)}")
        self.named[name] = str(found)
        return Atom(name)


class Decoder:
    """Expressions in the decoder of a frame or register. ``enum`` returns the name of a field's IntEnum.

    A frame has one decoder for each encoder, in which the values of a Once are computed only once.
    """

    def __init__(self, scope: Scope, codec: Codec, names: ClassNames, enum: Callable[[Field], str]) -> None:
        self.scope, self.codec, self.names, self.enum = scope, codec, names, enum
        self.is_unpacked = (
            isinstance(scope, Once) and codec.in_bytes and not codec.by_word and 1 < codec.length <= _UNPACKED
        )
        self.byte = "b{}" if self.is_unpacked else "data[{}]"
        self.read = Reader(scope, codec, self.byte)

    def number(self, value: Expression) -> Expr:
        return self.scope.of(value)

    @property
    def named(self) -> dict[str, str]:
        """Values that depend on the order code, by name. Complete once the decoder has been printed."""
        return self.scope.named if isinstance(self.scope, Once) else {}

    def local(self, field: Field) -> str:
        """Return the variable for the bits of a field."""
        return f"of_{field.name}" if isinstance(self.scope, Once) else self.names.local(field.name)

    # -- CRC

    @property
    def xor(self) -> str:
        """XOR of all bytes before a CRC that is this XOR. Empty for any other CRC."""
        crc = self.codec.crc
        before = self.codec.length - crc.crc.width // 8 if crc is not None else 0
        if crc is None or not crc.crc.is_xor or before > _UNPACKED:
            return ""
        inverted = [f"0x{crc.inverted:02X}"] if crc.inverted else []
        return " ^ ".join([*(self.byte.format(place) for place in range(before)), *inverted])

    @property
    def crc_covers(self) -> Expr | None:
        """Number of bits before the CRC of a word, for its tables. None if an answer decides it.

        With the start value 0, zeros before the word do not change the CRC, so the longest word has tables for all.
        """
        crc = self.codec.crc
        if crc is None or self.codec.in_bytes:
            return None
        if not crc.crc.init and not crc.is_part:
            return number(self.codec.layout.widest - crc.crc.width)
        answered = self.scope.answered if isinstance(self.scope, Once) else frozenset()
        return Scope(self.scope.names).of(crc.covered) if answered.isdisjoint(crc.covered.parameters) else None

    @property
    def tables(self) -> int:
        """Number of tables for the CRC of a word. 0 if it has none."""
        return -(-self.codec.layout.widest // TABLE_BITS) if self.crc_covers is not None else 0

    @property
    def lookups(self) -> str:
        """XOR of the tables. The word is halved first, because operations on short numbers are faster."""
        shifts = [TABLE_BITS * place for place in range(self.tables - 1)]
        found = [f"high >> {shift}" if shift else "high" for shift in shifts]
        ones = mask((1 << TABLE_BITS) - 1)
        indices = ["low", *(f"{item} & {ones}" for item in found[:-1]), *found[-1:]][: self.tables]
        return " ^ ".join(f"table_{place}[{item}]" for place, item in enumerate(indices))

    @staticmethod
    def listed(name: str, count: int) -> str:
        """Return ``count`` numbered names for a tuple assignment."""
        return ", ".join(f"{name}{place}" for place in range(count)) + ("," if count == 1 else "")

    # -- first byte of a frame of bytes

    @cached_property
    def heads(self) -> list[tuple[int, int]]:
        """Valid first bytes of a frame whose selector is in the first byte, each with its selector."""
        checks = [item for item in self.codec.checks if self._in_head(item)]
        selector = next((item for item in checks if isinstance(item, IsOneOf) and self.selects(item.field)), None)
        if selector is None:
            return []
        sound = (byte for byte in range(256) if all(self._holds(item, byte) for item in checks))
        return [(byte, _of(selector.bits.pieces, byte)) for byte in sound]

    @property
    def members(self) -> list[tuple[int, str]]:
        """Value of the selector for each valid first byte. Empty if the selector is not an attribute of the frame."""
        shown = next((item for item in self.codec.parts if self.selects(item.field)), None)
        if shown is None:
            return []
        match meaning_of(shown.field):
            case Named(values):
                names = {item.value: f"{self.enum(shown.field)}.{item.name.upper()}" for item in values}
                return [(byte, names.get(value, coded(value))) for byte, value in self.heads]
            case Raw() | TwosComplement() | ZeroMeans() | Active() | DigitRuns() | Characters():
                return [(byte, coded(value)) for byte, value in self.heads]
            case meaning:
                assert_never(meaning)

    @property
    def disagreement(self) -> list[str]:
        """Conditions under which a check fails, if the first byte decides most of them. Empty if it does not."""
        if not self.heads:
            return []
        others = [item for item in self.codec.checks if not self._in_head(item)]
        if not all(isinstance(item, (AlwaysIs, ZerosAbove)) for item in others):
            return []
        heads = [f"0x{byte:02X}" for byte, _ in self.heads]
        among = "heads" if self.members else f"({', '.join(heads)})"
        head = f"b0 != {heads[0]}" if len(heads) == 1 and not self.members else f"b0 not in {among}"
        # Bits that get a name come first, so that each has one if no condition holds.
        others.sort(key=lambda item: not isinstance(item, ZerosAbove))
        return [*map(self._fails, others), head]

    def _fails(self, item: Check) -> str:
        if isinstance(item, ZerosAbove):
            bits = self.read.of_bytes(item.field.pieces)
            return f"({self.local(item.field)} := {bits}) >> {self.number(item.bits.width).operand}"
        bits = self.read.bits(item.bits)
        return f"{bits.operand} != {mask(item.value)}" if isinstance(item, AlwaysIs) and item.value else str(bits)

    def _in_head(self, item: Check) -> bool:
        """Return whether a check depends only on the first byte."""
        if not self.is_unpacked or not isinstance(item, (AlwaysIs, ParityIs, IsOneOf)):
            return False
        of = item.of_bits if isinstance(item, ParityIs) else ()
        pieces = [*item.bits.pieces, *(piece for bits in of for piece in bits.pieces)]
        return bool(pieces) and all(piece.byte == 0 for piece in pieces)

    @staticmethod
    def _holds(item: Check, byte: int) -> bool:
        found = _of(item.bits.pieces, byte)
        match item:
            case AlwaysIs(value=value):
                return found == value
            case ParityIs(of_bits=of, odd=odd, mask=counted):
                parts = (_of(bits.pieces, byte) & (counted or -1) for bits in of)
                return found == sum(parity(part, False) for part in parts) & 1 ^ odd
            case IsOneOf(values=values):
                return found in values
            case _:
                return True

    # -- values

    def selects(self, field: Field) -> bool:
        return field.name == self.codec.layout.selector

    def is_padded(self, field: Field) -> bool:
        """Return whether the bits above the field have already been checked."""
        return any(isinstance(item, ZerosAbove) and item.field is field for item in self.codec.checks)

    def has_name(self, field: Field) -> bool:
        """Return whether the bits of a field have a local name after the checks."""
        checks = [item for item in self.codec.checks if item.field.name == field.name]
        listed = [item for item in checks if isinstance(item, IsOneOf) and len(item.values) > 1]
        chosen = bool(listed) and self.selects(field) and not self.disagreement
        return chosen or any(isinstance(item, (ZerosAbove, AtMost, NotAbove, IsBetween)) for item in checks)

    def bits(self, part: Part) -> Expr:
        """Return the bits of a field after all checks."""
        return Atom(self.local(part.field)) if self.has_name(part.field) else self.read.bits(part.bits)

    def values(self, part: Part) -> list[Expr]:
        """Return the values of a field: one, or one per run of digits."""
        item, bits = part.field, self.bits(part)
        if self.disagreement and self.selects(item):
            return [Atom("heads[b0]")]
        match meaning_of(item):
            case Raw():
                return [bits]
            case TwosComplement():
                return [call("signed", bits, self.number(item.width))]
            case ZeroMeans(stands_for):
                return [_or(bits, stands_for)]
            case Active(low):
                # A shorter number also contains the lowest bits.
                at = part.bits.low
                is_low = self.tables and not self.codec.gray and at.is_constant and at.constant < TABLE_BITS
                return [_truth(self.read.bit(part.bits, "low" if is_low else ""), low)]
            case Named() if self.selects(item):
                return [call(self.enum(item), bits)]
            case Named():
                return [Atom(self.local(item))]
            case DigitRuns(runs):
                return [value for _, value in digits(bits, runs)]
            case Characters():
                adjacent = self.read.characters(part.bits)
                return [Atom(f'{adjacent}.decode("latin-1")') if adjacent else _text(item, bits)]
            case meaning:
                assert_never(meaning)

    def all_values(self, given: Sequence[tuple[str, str]]) -> list[str]:
        """Return the values of all attributes, in order, after the encoder and the answers."""
        values = [str(value) for part in self.codec.parts for value in self.values(part)]
        kept = [self.read.unused()] if self.codec.reserved else [self.read.others()] if self.codec.keeps_others else []
        return [*(name for name, _ in given), *values, *map(str, kept)]


def assigned(scope: Scope, names: ClassNames, enum: str, item: Field, bits: Expr) -> Iterator[tuple[str, Expr]]:
    """Yield the attributes of a field of a joined number, with their values. ``enum`` is the name of its IntEnum."""
    name = names.attribute
    match meaning_of(item):
        case Raw():
            yield name(item.name), bits
        case TwosComplement():
            yield name(item.name), call("signed", bits, scope.of(item.width))
        case ZeroMeans(stands_for):
            yield name(item.name), _or(bits, stands_for)
        case Active(low):
            yield name(item.name), _truth(bits, low)
        case Named():
            yield name(item.name), call("choice", enum, f'"{item.name}"', bits)
        case DigitRuns(runs):
            yield from ((name(run.name), value) for run, value in digits(bits, runs))
        case Characters():
            yield name(item.name), _text(item, bits)
        case meaning:
            assert_never(meaning)


def _of(pieces: Iterable[Piece], byte: int) -> int:
    """Return the number that the pieces of one byte form."""
    return sum((byte >> piece.right & piece.mask) << piece.left for piece in pieces)


def digits(value: Expr, runs: Sequence[Digits]) -> Iterator[tuple[Digits, Expr]]:
    """Yield the runs of decimal digits in a number, each with its value."""
    for run in runs:
        found = value if run.divisor == 1 else Operation(value, "//", number(run.divisor))
        yield run, found if run is runs[0] else Operation(found, "%", number(run.modulus))


def _or(bits: Expr, stands_for: int) -> Expr:
    return Atom(f"{bits.operand} or {grouped(stands_for)}")


def _truth(bits: Expr, low: bool) -> Expr:
    return Atom(f"not {bits}" if low else f"{bits.operand} != 0")


def _text(field: Field, bits: Expr) -> Expr:
    return Atom(f'{bits.operand}.to_bytes({field.width.constant // 8}, "big").decode("latin-1")')
