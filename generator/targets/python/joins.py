"""Numbers that several fields of a frame or register form, and their parts."""

from __future__ import annotations

from collections.abc import Callable

from ...model import Field
from ...model.lookup import assert_never
from ...plan.codec import Codec
from ...plan.operations import Whole
from ...plan.values import (
    Active,
    Characters,
    DigitRuns,
    Meaning,
    Named,
    Raw,
    TwosComplement,
    ZeroMeans,
    meaning_of,
)
from .expr import Atom, Expr, Not, Operation, Scope, call, joined, moved, times
from .names import ClassNames


class Maker:
    """Expressions of joined numbers. They use the attributes of a class."""

    def __init__(self, scope: Scope, codec: Codec, names: ClassNames) -> None:
        self.scope, self.codec, self.names = scope, codec, names

    def _bits(self, field: Field) -> Expr:
        """Return the bits of a field, without a check of its value."""
        attribute, number = Atom(f"self.{self.names.attribute(field.name)}"), self._index(field.name)
        match meaning_of(field):
            case Raw() | Named():
                return number
            case ZeroMeans(stands_for):
                return Atom(f"(0 if {attribute} == {stands_for} else {number})")
            case TwosComplement():
                return Operation(number, "&", self.scope.ones(field.width))
            case Active(low):
                return Not(attribute) if low else call("bool", attribute)
            case DigitRuns():
                return self.digits(field)
            case Characters():
                return call("text_number", f'"{field.name}"', attribute, str(field.width.constant // 8))
            case meaning:
                assert_never(meaning)

    def digits(self, field: Field) -> Expr:
        """Return the number that runs of decimal digits form."""
        return joined("+", (times(self._index(run.name), run.divisor) for run in field.runs))

    def whole(self, whole: Whole) -> Expr:
        parts = [moved(self._bits(field), "<<", self.scope.of(low)) for field, low in whole.from_low]
        return joined("|", reversed(parts))

    def whole_of_numbers(self, whole: Whole, scope: Scope, expression_of: Callable[[str], str]) -> Expr:
        """Return the same expression of unsigned numbers, without a check of their types."""
        terms = []
        for field, low in whole.from_low:
            attribute = Atom(expression_of(self.names.attribute(field.name)))
            terms.append(moved(attribute, "<<", scope.of(low)))
        return joined("|", reversed(terms))

    def parts(self, whole: Whole) -> list[tuple[Field, Expr]]:
        """Return the fields of a joined number, most significant first, with expressions for their bits."""
        name, field_bits = Atom(self.names.attribute(whole.join.name)), []
        for field, low in whole.from_low:
            shifted = moved(name, ">>", self.scope.of(low))
            top = field is whole.fields[0]
            field_bits.append((field, shifted if top else Operation(shifted, "&", self.scope.ones(field.width))))
        return field_bits[::-1]

    @staticmethod
    def whole_depends(whole: Whole) -> bool:
        """Return whether the expression of a joined number depends on the order code."""
        truncated_fields = (field for field in whole.fields if _is_truncated(meaning_of(field)))
        return whole.depends or not all(field.width.is_constant for field in truncated_fields)

    def _index(self, name: str) -> Expr:
        return call("index", f"self.{self.names.attribute(name)}")


def _is_truncated(meaning: Meaning) -> bool:
    """Return whether ``_bits`` truncates a number to the width of the field."""
    match meaning:
        case TwosComplement():
            return True
        case Raw() | ZeroMeans() | Active() | Named() | DigitRuns() | Characters():
            return False
        case _:
            assert_never(meaning)
