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
    exact_places = _exact_places(value)
    places = _ROUNDED if exact_places is None else exact_places
    whole, part = divmod(round(abs(value) * 10**places), 10**places)
    sign = "-" if value < 0 else ""
    text = f"{sign}{whole:,}"
    if places:
        text += f".{part:0{places}}"
    return f"≈ {text}" if exact_places is None else text


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
    sign = "-" if number < 0 else "+"
    return f"{text} {sign} {abs(number)}"


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


def _exact_places(value: Fraction) -> int | None:
    """Return the number of decimals of a number, or None if they never end."""
    # Each decimal divides the denominator by 2, by 5 or by both, so there are at most as many as it has bits.
    for places in range(value.denominator.bit_length() + 1):
        if 10**places % value.denominator == 0:
            return places
    return None


def counted(count: int | str, unit: str) -> str:
    """Return a count with its unit: ``1 bit``, ``8 bits`` or ``position_bits bits``."""
    return f"{count} {unit}{'' if count == 1 else 's'}"


def with_unit(value: int | str, unit: str) -> str:
    """Return a value with a unit that specs give in the plural: ``1 revolution``, ``8 revolutions``, ``50 µm``."""
    is_word = len(unit) > 3  # unlike ms, µs and ns
    if is_word and str(value) == "1":
        unit = unit.removesuffix("s")
    return f"{value} {unit}".rstrip()


def first_of(items: Sequence[str], count: int = 3, between: str = ", ") -> str:
    """Join the first items, and count the others: ``a, b, c and 5 more``."""
    first_items = between.join(items[:count])
    omitted = len(items) - count
    return f"{first_items} and {omitted} more" if omitted > 0 else first_items


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
    stand_ins = {**STAND_INS, **replacements}
    text = text.translate({ord(sign): stand_in for sign, stand_in in stand_ins.items()})
    # This form separates an accent from its letter.
    decomposed = unicodedata.normalize("NFKD", text)
    without_accents = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    return without_accents.encode("ascii", "replace").decode()


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
    words = [word for word in plain(text).split(" ") if word]
    if not words:
        return ""
    lines: list[str] = []
    line = (prefix if first is None else first) + words[0]
    for word in words[1:]:
        if len(line) + 1 + len(word) > width:
            lines.append(line)
            line = prefix + word
        else:
            line = f"{line} {word}"
    return "\n".join([*lines, line])


def pairs(rows: Iterable[tuple[str, str]], indent: int) -> list[str]:
    """Return the rows as lines with two columns. The second column is wrapped."""
    row_list = list(rows)
    name_width = min(max((len(name) for name, _ in row_list), default=0), 40)
    margin, text_margin = " " * indent, " " * (indent + name_width + 2)
    lines: list[str] = []
    for name, text in row_list:
        if text:
            lines.append(wrapped(text, WIDTH, text_margin, f"{margin}{name.ljust(name_width)}  "))
        else:
            lines.append(f"{margin}{name}")
    return lines
