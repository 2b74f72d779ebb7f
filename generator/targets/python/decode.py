"""Values in ``decode``: expressions that convert the bits of each field."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from ...model import Digits, Field
from ...model.never import assert_never
from ...plan.codec import Part
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from .bits import Reader
from .expr import Atom, Expr, Operation, Scope, call, grouped, number
from .names import ClassNames


class Taker:
    """Generator of expressions for the values of fields. ``enum`` returns the name of a field's IntEnum."""

    def __init__(self, scope: Scope, read: Reader, names: ClassNames, enum: Callable[[Field], str]) -> None:
        self.scope, self.read, self.names, self.enum = scope, read, names, enum

    def values(self, part: Part, bits: Expr) -> list[Expr]:
        """Return the values of a field of the frame with these ``bits``: one, or one per run of digits."""
        field = part.field
        match meaning_of(field):
            case Raw():
                return [bits]
            case TwosComplement():
                return [self._signed(field, bits)]
            case ZeroMeans(stands_for):
                return [_or(bits, stands_for)]
            case Active(low):
                return [_truth(self.read.bit(part.bits), low)]
            case Named() if field.name == self.read.codec.layout.selector:
                return [call(self.enum(field), bits)]
            case Named():
                return [Atom(self.names.local(field.name))]
            case DigitRuns(runs):
                return [value for _, value in digits(bits, runs)]
            case Characters():
                adjacent = self.read.characters(part.bits)
                return [Atom(f'{adjacent}.decode("latin-1")') if adjacent else _text(field, bits)]
            case meaning:
                assert_never(meaning)

    def assigned(self, field: Field, bits: Expr) -> Iterator[tuple[str, Expr]]:
        """Yield the attributes of a field of a joined number, with their values."""
        name = self.names.attribute
        match meaning_of(field):
            case Raw():
                yield name(field.name), bits
            case TwosComplement():
                yield name(field.name), self._signed(field, bits)
            case ZeroMeans(stands_for):
                yield name(field.name), _or(bits, stands_for)
            case Active(low):
                yield name(field.name), _truth(bits, low)
            case Named():
                yield name(field.name), call("choice", self.enum(field), f'"{field.name}"', bits)
            case DigitRuns(runs):
                yield from ((name(run.name), value) for run, value in digits(bits, runs))
            case Characters():
                yield name(field.name), _text(field, bits)
            case meaning:
                assert_never(meaning)

    def _signed(self, field: Field, bits: Expr) -> Expr:
        return call("signed", bits, self.scope.of(field.width))


def digits(value: Expr, runs: Sequence[Digits]) -> Iterator[tuple[Digits, Expr]]:
    """Yield the runs of decimal digits in a number, each with its value."""
    for run in runs:
        found = value if run.divisor == 1 else Operation(value, "//", number(run.divisor))
        yield run, found if run is runs[0] else Operation(found, "%", number(run.modulus))


def _or(bits: Expr, stands_for: int) -> Expr:
    return Atom(f"{bits.operand} or {grouped(stands_for)}")


def _truth(bits: Expr, low: bool) -> Expr:
    return Atom(f"not {bits}") if low else call("bool", bits)


def _text(field: Field, bits: Expr) -> Expr:
    return Atom(f'{bits.operand}.to_bytes({field.width.constant // 8}, "big").decode("latin-1")')
