"""Numbers with their units in words. Unlike ``words``, this module needs no model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

#: Decimals of a number that has no exact decimal, such as 1/3.
_ROUNDED = 6


def number(value: int) -> str:
    """Return a number in groups of three digits."""
    return f"{value:,}"


def decimal(value: Fraction) -> str:
    """Return a number with all its decimals, in groups of three digits: ``1,234.5``.

    If the decimals never end, return six of them after ``≈``.
    """
    digits = next((most for most in range(_most(value)) if 10**most % value.denominator == 0), None)
    places = _ROUNDED if digits is None else digits
    whole, part = divmod(round(abs(value) * 10**places), 10**places)
    text = f"{'-' if value < 0 else ''}{whole:,}" + (f".{part:0{places}}" if places else "")
    return f"≈ {text}" if digits is None else text


def _most(value: Fraction) -> int:
    """Return a number of decimals that is enough for any fraction whose decimals end."""
    return value.denominator.bit_length() + 1


def counted(count: int | str, thing: str) -> str:
    """Return a count with its unit: ``1 bit``, ``8 bits`` or ``position_bits bits``."""
    return f"{count} {thing}{'' if count == 1 else 's'}"


def with_unit(value: int | str, unit: str) -> str:
    """Return a value with a unit that specs give in the plural: ``1 revolution``, ``8 revolutions``, ``50 µm``."""
    is_word = len(unit) > 3  # unlike ms, µs and ns
    return f"{value} {unit.removesuffix('s') if is_word and str(value) == '1' else unit}".rstrip()


def first_of(items: Sequence[str], most: int = 3, between: str = ", ") -> str:
    """Join the first items, and count the others: ``a, b, c and 5 more``."""
    more = len(items) - most
    return between.join(items[:most]) + (f" and {more} more" if more > 0 else "")
