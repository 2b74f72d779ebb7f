"""Labels and colour classes of fields in pictures."""

from __future__ import annotations

from ..model import Choice, Constant, CrcValue, Decimal, Field, Flag, Number, Parity, Text, Unused, assert_never

#: Colour class of values that have none of their own.
DATA = "data"


def colour(field: Field) -> str:
    """Return the colour class of a field."""
    match field.kind:
        case Flag():
            return "flag"
        case Choice():
            return "choice"
        case CrcValue() | Parity():
            return "check"
        case Constant() | Unused():
            return "fixed"
        case Number() | Decimal() | Text():
            return DATA
        case _:
            assert_never(field.kind)


def label(field: Field) -> str:
    """Return the name of a field, with the value of a constant."""
    match field.kind:
        case Unused(value=value) if not (field.printed_name or value):
            return "unused"
        case Constant(value=number, padding_of=padded):
            text = f"{number:X}h" if number > 9 else f"{number}"
            is_plain = number == 0 and (padded or not field.printed_name)
            return text if is_plain else f"{as_words(field.name)} = {text}"
        case Number() | Flag() | Choice() | Unused() | CrcValue() | Parity() | Decimal() | Text():
            return as_words(field.name)
        case _:
            assert_never(field.kind)


def as_words(name: str) -> str:
    return name.replace("_", " ")
