"""Fast decoding of valid frames: values that depend only on the order code are computed once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

from ...model.expressions import Expression
from ...model.never import assert_never
from ...plan.codec import AlwaysIs, Bits, Check, IsOneOf, ParityIs, Part, ZerosAbove, parity
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from .bits import Reader
from .codec import Coder
from .expr import Atom, Expr, Scope, coded, mask

#: Number of bits per CRC table.
TABLE_BITS = 16


@dataclass(frozen=True)
class Once(Scope):
    """Scope that assigns a name to each value that depends on the order code, and records its expression."""

    named: dict[str, str] = field(default_factory=dict)

    def of(self, value: Expression) -> Expr:
        return super().of(value) if value.is_constant else self._name("size", super().of(value))

    def ones(self, width: Expression) -> Expr:
        return super().ones(width) if width.is_constant else self._name("ones", super().ones(width))

    def power(self, width: Expression) -> Expr:
        return Scope(self.names).power(width)

    def _name(self, kind: str, value: Expr) -> Expr:
        known = {text: name for name, text in self.named.items()}
        name = known.get(str(value), f"{kind}_{len(self.named)}")
        self.named[name] = str(value)
        return Atom(name)


class Fast:
    """Function that decodes valid frames of one kind, for its template."""

    def __init__(self, coder: Coder) -> None:
        self.coder, self.plan = coder, coder.plan
        self.name = f"_fast_{coder.layout.name}"
        self._once = Once(coder.context.scope.names)
        self.read = Reader(self._once, coder.plan, byte="b{}")
        self.bits = self._once.of(coder.layout.bits)
        self._checked = [item for item in self.plan.checks if not self._in_head(item)]

    @property
    def applies(self) -> bool:
        """True if the frames have a fast decoder. Others use only the decoder with all checks."""
        plan = self.plan
        plain = not plan.alternatives and all(map(self._is_plain, plan.parts))
        known = all(isinstance(item, (AlwaysIs, ZerosAbove)) for item in self._checked)
        if not plan.in_bytes:
            return plain and known and not any(isinstance(item, ZerosAbove) for item in self._checked)
        fits = not plan.by_word and (plan.crc is None or self.coder.crc_is_unrolled)
        return plain and known and fits and bool(self.heads) and plan.length > 1

    def _is_plain(self, part: Part) -> bool:
        """Return whether ``_value`` converts the bits of a part. A selector is looked up by the first byte instead."""
        match meaning_of(part.field):
            case Raw() | TwosComplement() | ZeroMeans() | Active():
                return True
            case Named():
                return self.coder.selects(part.field)
            case DigitRuns() | Characters():
                return False
            case meaning:
                assert_never(meaning)

    # -- first byte of a frame of bytes

    def _in_head(self, item: Check) -> bool:
        """Return whether a check depends only on the first byte."""
        if not self.plan.in_bytes or self.plan.by_word or not isinstance(item, (AlwaysIs, ParityIs, IsOneOf)):
            return False
        pieces = [*item.bits.pieces, *(piece for of in self._parity_of(item) for piece in of.pieces)]
        return bool(pieces) and all(piece.byte == 0 for piece in pieces)

    @cached_property
    def heads(self) -> list[tuple[int, int]]:
        """Valid first bytes of such a frame, each with its selector."""
        checks = [item for item in self.plan.checks if self._in_head(item)]
        selector = next((item for item in checks if isinstance(item, IsOneOf) and self.coder.selects(item.field)), None)
        if selector is None:
            return []
        sound = (byte for byte in range(256) if all(self._holds(item, byte) for item in checks))
        return [(byte, self._of(selector.bits.pieces, byte)) for byte in sound]

    def _holds(self, item: Check, byte: int) -> bool:
        found = self._of(item.bits.pieces, byte)
        match item:
            case AlwaysIs(value=value):
                return found == value
            case ParityIs(of_bits=of, odd=odd):
                return found == sum(parity(self._of(bits.pieces, byte), False) for bits in of) & 1 ^ odd
            case IsOneOf(values=values):
                return found in values
            case _:
                return True

    @staticmethod
    def _parity_of(item: Check) -> tuple[Bits, ...]:
        return item.of_bits if isinstance(item, ParityIs) else ()

    @staticmethod
    def _of(pieces: object, byte: int) -> int:
        return sum((byte >> piece.right & piece.mask) << piece.left for piece in pieces)  # type: ignore[attr-defined]

    @property
    def members(self) -> list[tuple[int, str]]:
        """Values of the selector, by first byte. Empty if the selector is not an attribute of the frame."""
        shown = next((item for item in self.plan.parts if self.coder.selects(item.field)), None)
        if shown is None:
            return []
        match meaning_of(shown.field):
            case Named(values):
                names = {item.value: f"{self.coder.enum(shown.field)}.{item.name.upper()}" for item in values}
                return [(byte, names[value]) for byte, value in self.heads if value in names]
            case Raw() | TwosComplement() | ZeroMeans() | Active() | DigitRuns() | Characters():
                return [(byte, coded(value)) for byte, value in self.heads]
            case meaning:
                assert_never(meaning)

    # -- values computed once, and checks of each frame

    @property
    def tables(self) -> int:
        """Number of tables for the CRC of a word. 0 if it has no CRC."""
        has_crc = self.plan.crc is not None and not self.plan.in_bytes
        return -(-self.coder.layout.widest // TABLE_BITS) if has_crc else 0

    @property
    def lookups(self) -> list[str]:
        """Index into each table. The word is halved first, because operations on short numbers are faster."""
        shifts = [TABLE_BITS * place for place in range(self.tables - 1)]
        found = [f"high >> {shift}" if shift else "high" for shift in shifts]
        return ["low", *(f"{item} & {mask((1 << TABLE_BITS) - 1)}" for item in found[:-1]), *found[-1:]][: self.tables]

    @cached_property
    def conditions(self) -> list[str]:
        """Conditions under which a frame needs the decoder with all checks."""
        return [*self._conditions()]

    def _conditions(self) -> Iterator[str]:
        if self.plan.in_bytes and self.plan.crc is not None:
            inverted = self.plan.crc.inverted
            every = " ^ ".join(f"b{place}" for place in range(self.plan.length))
            yield f"({every}) != 0x{inverted:02X}" if inverted else every
        for item in self._checked:
            if isinstance(item, ZerosAbove):
                width, whole = self._once.of(item.bits.width), self.read.of_bytes(item.field.pieces)
                yield f"({self._local(item.field.name)} := {whole}) >> {width}"
            elif isinstance(item, AlwaysIs):
                found = self.read.bits(item.bits)
                yield f"({found}) != {mask(item.value)}" if item.value else str(found)

    @cached_property
    def values(self) -> list[str]:
        """Attributes of the frame, in order."""
        given = ["variant"] if self.coder.takes_variant else []
        reserved = [str(self.read.unused())] if self.plan.reserved else []
        return [*given, *(self._value(part) for part in self.plan.parts), *reserved]

    def _value(self, part: Part) -> str:
        if self.coder.selects(part.field):
            return "heads[b0]"
        match meaning_of(part.field):
            case Raw():
                return self._bits(part)
            case TwosComplement():
                return f"signed({self._bits(part)}, {self._once.of(part.field.width)})"
            case ZeroMeans(stands_for):
                return f"({self._bits(part)}) or {stands_for}"
            case Active(low):
                bit = self._bit(part)
                return f"not {bit}" if low else f"({bit}) != 0"
            case Named() | DigitRuns() | Characters() as meaning:
                raise ValueError(f"{part.field.name} has no fast decoder: {meaning}")
            case meaning:
                assert_never(meaning)

    def _bits(self, part: Part) -> str:
        padded = {item.field.name for item in self._checked if isinstance(item, ZerosAbove)}
        return self._local(part.field.name) if part.field.name in padded else str(self.read.bits(part.bits))

    def _bit(self, part: Part) -> Expr:
        # A shorter number also contains the lowest bits.
        low = part.bits.low
        is_low = self.tables and low.is_constant and low.constant < TABLE_BITS
        return self.read.bit(part.bits, "low" if is_low else "")

    @property
    def named(self) -> dict[str, str]:
        """Values that depend on the order code, by name. Complete after all other properties are evaluated."""
        _ = (self.conditions, self.values, self.bits)
        return self._once.named

    @staticmethod
    def listed(name: str, count: int) -> str:
        """Return ``count`` numbered names for a tuple assignment."""
        return ", ".join(f"{name}{place}" for place in range(count)) + ("," if count == 1 else "")

    @staticmethod
    def _local(name: str) -> str:
        return f"of_{name}"
