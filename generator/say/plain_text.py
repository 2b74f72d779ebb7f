"""Text that needs no model: text from a spec in ASCII, on one line or wrapped, and numbers with their units."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

    from ..model.kinds import Scale


#: Decimals of a number that has no exact decimal, such as 1/3.
_ROUNDED = 6


def number(value: int) -> str:
    """Return a number in groups of three digits."""
    return f"{value:,}"


def decimal(value: Fraction) -> str:
    """Return a number with all its decimals, in groups of three digits: ``1,234.5``.

    If the decimals never end, return six of them after ``≈``.
    """
    digits = next(
        (digit_count for digit_count in range(_enough_decimals(value)) if 10**digit_count % value.denominator == 0),
        None,
    )
    places = _ROUNDED if digits is None else digits
    whole, part = divmod(round(abs(value) * 10**places), 10**places)
    sign = "-" if value < 0 else ""
    text = f"{sign}{whole:,}" + (f".{part:0{places}}" if places else "")
    return f"≈ {text}" if digits is None else text


def quantity(scale: Scale, value: int) -> str:
    """Return the quantity that a number stands for: ``26.9 °C``. Begin with ``≈`` if the decimals are rounded."""
    text = f"{scale.decimal(value)} {scale.unit}"
    return text if scale.is_exact(value) else f"≈ {text}"


def formula(scale: Scale) -> str:
    """Return the formula of a quantity in the form that manuals print: ``(value + 152) / 2.776``."""
    numerator, denominator, offset = scale.numerator, scale.denominator, scale.offset
    if offset % denominator == 0:
        return _added_number("value" + _times(numerator, denominator), offset // denominator)
    if offset % numerator == 0:
        return f"({_added_number('value', offset // numerator)}){_times(numerator, denominator)}"
    factor = f"value × {numerator}" if numerator > 1 else "value"
    return f"({_added_number(factor, offset)}) / {denominator}"


def _added_number(text: str, number: int) -> str:
    if number == 0:
        return text
    return f"{text} {'-' if number < 0 else '+'} {abs(number)}"


def _times(numerator: int, denominator: int) -> str:
    """Return a factor after a value, with a decimal if one of the numbers is a power of ten."""
    if numerator == denominator:
        return ""
    if denominator == 1:
        return f" × {numerator}"
    if _is_power_of_ten(numerator):
        return f" / {_decimal(denominator, numerator)}"
    if _is_power_of_ten(denominator):
        return f" × {_decimal(numerator, denominator)}"
    return f" × {numerator} / {denominator}"


def _is_power_of_ten(number: int) -> bool:
    return str(number).strip("0") == "1"


def _decimal(number: int, power: int) -> str:
    """Return a number divided by a power of ten."""
    places = len(str(power)) - 1
    digits = f"{number:0{places + 1}}"
    return f"{digits[: len(digits) - places]}.{digits[len(digits) - places :]}".rstrip("0").rstrip(".")


def _enough_decimals(value: Fraction) -> int:
    """Return a number of decimals that is enough for any fraction whose decimals end."""
    return value.denominator.bit_length() + 1


def counted(count: int | str, unit: str) -> str:
    """Return a count with its unit: ``1 bit``, ``8 bits`` or ``position_bits bits``."""
    return f"{count} {unit}{'' if count == 1 else 's'}"


def with_unit(value: int | str, unit: str) -> str:
    """Return a value with a unit that specs give in the plural: ``1 revolution``, ``8 revolutions``, ``50 µm``."""
    is_word = len(unit) > 3  # unlike ms, µs and ns
    return f"{value} {unit.removesuffix('s') if is_word and str(value) == '1' else unit}".rstrip()


def first_of(items: Sequence[str], count: int = 3, between: str = ", ") -> str:
    """Join the first items, and count the others: ``a, b, c and 5 more``."""
    omitted = len(items) - count
    return between.join(items[:count]) + (f" and {omitted} more" if omitted > 0 else "")


#: Replacements for signs that Unicode does not decompose well.
STAND_INS: Mapping[str, str] = {
    "→": "->",
    "←": "<-",
    "↔": "<->",
    "−": "-",
    "–": "-",
    "—": "-",
    "‑": "-",
    "“": '"',
    "”": '"',
    "„": '"',
    "‘": "'",
    "’": "'",
    "…": "...",
    "×": "x",
    "·": ".",
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "≠": "!=",
    "≈": "~",
    "²": "^2",
    "³": "^3",
    "°": "deg",
    "µ": "u",
    "μ": "u",
    "Ω": "Ohm",
    "Ø": "dia. ",
    "ß": "ss",
    "§": "section ",
    "®": "(R)",
    "©": "(C)",
    "™": "(TM)",
}


def in_ascii(text: str, replacements: Mapping[str, str]) -> str:
    """Return the text with ``replacements``, then those above, then letters without accents, then ``?``."""
    if text.isascii():
        return text
    table = {ord(sign): stand_in for sign, stand_in in {**STAND_INS, **replacements}.items()}
    flat = unicodedata.normalize("NFKD", text.translate(table))
    return "".join(letter for letter in flat if not unicodedata.combining(letter)).encode("ascii", "replace").decode()


#: Columns of a terminal.
WIDTH = 80
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]+")


def one_line(text: object) -> str:
    """Return the text on one line. Control characters, line ends and direction marks become spaces."""
    line = str(text)
    return line if line.isprintable() else _CONTROL.sub(" ", line)


def plain(text: object) -> str:
    """Return the text on one line, without spaces at its ends."""
    return one_line(text).strip()


def wrapped(text: object, width: int, prefix: str = "", first: str | None = None) -> str:
    """Return a paragraph of at most ``width`` columns. Lines start with ``prefix``, the first with ``first``."""
    lines: list[str] = []
    line = prefix if first is None else first
    has_words = False
    for word in filter(None, plain(text).split(" ")):
        if has_words and len(line) + 1 + len(word) > width:
            lines.append(line)
            line, has_words = prefix, False
        line, has_words = f"{line} {word}" if has_words else line + word, True
    return "\n".join([*lines, line]) if has_words else ""


def pairs(rows: Iterable[tuple[str, str]], indent: int) -> list[str]:
    """Return the rows as lines with two columns. The second column is wrapped."""
    row_list = list(rows)
    width = min(max((len(name) for name, _ in row_list), default=0), 40)
    margin, start = " " * indent, " " * (indent + width + 2)
    lines: list[str] = []
    for name, text in row_list:
        lines.append(wrapped(text, WIDTH, start, f"{margin}{name.ljust(width)}  ") if text else f"{margin}{name}")
    return lines
