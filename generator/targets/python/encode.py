"""Encoding of a frame or register: the terms that form its number, and the checks of its values."""

from __future__ import annotations

from functools import cached_property

from ...model import Field
from ...model.expressions import Expression
from ...model.never import assert_never
from ...plan.codec import Codec, Fixed, Given, ParityOf, Term, Turned, Whole
from ...plan.refusals import (
    DigitsDisagree,
    DigitTooHigh,
    NoPowerOfTwo,
    NotOneOf,
    NotSigned,
    NotZeroFor,
    OutsideLimits,
    Refusal,
    TooWide,
    WholeDisagrees,
    depends,
    refusals,
)
from ...plan.values import (
    Active,
    Characters,
    DigitRuns,
    Meaning,
    Named,
    Raw,
    TwosComplement,
    ZeroMeans,
    is_named,
    meaning_of,
)
from .bits import others
from .expr import Atom, Expr, Not, Operation, Scope, call, joined, mask, moved, number, times
from .names import ClassNames


class Maker:
    """Expressions in ``encode``. They use the attributes and local variables of a class."""

    def __init__(self, scope: Scope, codec: Codec, names: ClassNames) -> None:
        self.scope, self.codec, self.names = scope, codec, names
        # Python objects store each number only once, so its parts cannot contradict it.
        self.refusals: list[Refusal] = [
            item for item in refusals(codec) if not isinstance(item, (DigitsDisagree, WholeDisagrees))
        ]

    @property
    def depends(self) -> bool:
        """True if anything depends on the order code."""
        crc = self.codec.crc
        return (
            self.codec.gray is not None
            or any(map(depends, self.refusals))
            or any(term.depends for term in self.codec.terms if not _is_absent(term))
            or not all(item.bits.are_fixed for item in self.codec.reserved)
            or (self.codec.keeps_others and not all(item.is_fixed for item in self.codec.layout.fields))
            or (crc is not None and not self.codec.in_bytes and not crc.steps and not crc.covered.is_constant)
        )

    @cached_property
    def terms(self) -> list[Expr]:
        """Terms of the number. If the high byte comes first, a CRC after it is not part of the number."""
        crc = self.codec.crc if self.codec.in_bytes else None
        cut = crc.crc.width if crc is not None and self.codec.layout.byte_order == "high_byte_first" else 0
        fixed = sum(
            term.value.number << (term.bits.low.constant - cut)
            for term in self.codec.terms
            if isinstance(term.value, Fixed) and term.bits.low.is_constant
        )
        moving = (
            moved(self._value(term), "<<", self.scope.of(term.bits.low - Expression(cut)))
            for term in self.codec.terms
            if not _is_absent(term)
        )
        kept = [Atom("unused")] if self.codec.keeps_others else []
        return [*([mask(fixed)] if fixed else []), *moving, *kept] or [number(0)]

    def _value(self, term: Term) -> Expr:
        match term.value:
            case Fixed(value):
                return mask(value)
            case Given(field):
                return self._given(field)
            case ParityOf(of, odd):
                by_name = {item.field.name: item for item in self.codec.terms}
                bits = joined("^", [self._value(by_name[field.name]) for field in of])
                ones = Operation(Atom(f"{bits.operand}.bit_count()"), "&", number(1))
                return Operation(ones, "^", number(1)) if odd else ones
            case Turned(value, place):
                found = moved(Atom("unused"), ">>", number(place))
                found = Operation(found, "^", mask(value)) if value else found
                return Operation(found, "&", self.scope.ones(term.field.width))

    @property
    def unused(self) -> Expr:
        """Mask of all unused bits, at their positions in ``unused``."""
        if self.codec.keeps_others:
            return others(self.scope, self.codec)
        reserved = self.codec.reserved
        fixed = sum(((1 << item.bits.widest) - 1) << item.place for item in reserved if item.bits.are_fixed)
        moving = [item for item in reserved if not item.bits.are_fixed]
        ones = (moved(self.scope.ones(item.bits.width), "<<", number(item.place)) for item in moving)
        return joined("|", [*([mask(fixed)] if fixed else []), *ones])

    def _given(self, field: Field) -> Expr:
        """Return the checked bits of a field."""
        return self._bits(field, Atom(self.names.local(field.name)))

    def _bits(self, field: Field, number: Expr) -> Expr:
        """Return the bits of a field. ``number`` is its local variable."""
        own = Atom(f"self.{self.names.attribute(field.name)}")
        match meaning_of(field):
            case Raw() | ZeroMeans() | Named():
                return number
            case TwosComplement():
                return Operation(number, "&", self.scope.ones(field.width))
            case Active(low):
                return Not(own) if low else call("bool", own)
            case DigitRuns():
                return self.digits(field)
            case Characters():
                return call("text_number", f'"{field.name}"', own, str(field.width.constant // 8))
            case meaning:
                assert_never(meaning)

    def is_choice(self, op: Refusal) -> bool:
        """Return whether the check looks up the name of a value, even if every value of the bits has one."""
        match op:
            case NotOneOf(field):
                return field.name != self.codec.layout.selector
            case TooWide(field):
                return is_named(meaning_of(field))
            case (
                NotSigned()
                | NotZeroFor()
                | NoPowerOfTwo()
                | DigitTooHigh()
                | DigitsDisagree()
                | WholeDisagrees()
                | OutsideLimits()
            ):
                return False
            case _:
                assert_never(op)

    def digits(self, field: Field) -> Expr:
        """Return the number that runs of decimal digits form."""
        return joined("+", (times(self._index(run.name), run.divisor) for run in field.runs))

    # -- joins

    def whole(self, whole: Whole) -> Expr:
        parts = [moved(self._unchecked(field), "<<", self.scope.of(low)) for field, low in whole.from_low]
        return joined("|", reversed(parts))

    def _unchecked(self, field: Field) -> Expr:
        number = self._index(field.name)
        match meaning_of(field):
            case ZeroMeans(stands_for):
                return Atom(f"(0 if self.{self.names.attribute(field.name)} == {stands_for} else {number})")
            case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
                return self._bits(field, number)
            case meaning:
                assert_never(meaning)

    def parts(self, whole: Whole) -> list[tuple[Field, Expr]]:
        """Return the fields of a joined number, most significant first, with expressions for their bits."""
        name, found = Atom(self.names.attribute(whole.join.name)), []
        for field, low in whole.from_low:
            shifted = moved(name, ">>", self.scope.of(low))
            top = field is whole.fields[0]
            found.append((field, shifted if top else Operation(shifted, "&", self.scope.ones(field.width))))
        return found[::-1]

    @staticmethod
    def whole_depends(whole: Whole) -> bool:
        """Return whether the expression of a joined number depends on the order code."""
        cut = (item for item in whole.fields if _is_cut(meaning_of(item)))
        return whole.depends or not all(item.width.is_constant for item in cut)

    def _index(self, name: str) -> Expr:
        return call("index", f"self.{self.names.attribute(name)}")


def _is_cut(meaning: Meaning) -> bool:
    """Return whether ``_bits`` truncates a number to the width of the field."""
    match meaning:
        case TwosComplement():
            return True
        case Raw() | ZeroMeans() | Active() | Named() | DigitRuns() | Characters():
            return False
        case _:
            assert_never(meaning)


def _is_absent(term: Term) -> bool:
    """Return whether a term is omitted, because it is 0 or combined with other constants."""
    return isinstance(term.value, Fixed) and (term.bits.low.is_constant or not term.value.number)
