"""What outputs say in words. This module is for text that needs no model: ASCII, lines, and numbers with units."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

    from ..model.kinds import Scale


#: Number of decimals of a number that cannot be written exactly, such as 1/3.
_ROUNDED_DECIMALS = 6


def group_digits(value: int) -> str:
    """Return a number with commas between groups of three digits: ``65,536``."""
    return f"{value:,}"


def decimal(value: Fraction) -> str:
    """Return a number with all its decimals and with commas between groups of three digits: ``1,234.5``.

    If its decimals never end, return six of them, with ``≈`` in front of the number.
    """
    exact_decimals = _number_of_decimals(value)
    decimal_count = _ROUNDED_DECIMALS if exact_decimals is None else exact_decimals
    # As a whole number of the last decimal: 12345 for 1234.5 with one decimal.
    value_in_last_decimal = round(abs(value) * 10**decimal_count)
    whole_number, fraction = divmod(value_in_last_decimal, 10**decimal_count)
    sign = "-" if value < 0 else ""
    decimal_text = f"{sign}{whole_number:,}"
    if decimal_count:
        decimal_text += f".{fraction:0{decimal_count}}"
    return f"≈ {decimal_text}" if exact_decimals is None else decimal_text


def quantity_text(scale: Scale, value: int) -> str:
    """Return the quantity that the value of a field represents: ``26.9 °C``, or ``≈ 26.9 °C`` if it is rounded."""
    text = f"{scale.decimal(value)} {scale.unit}"
    return text if scale.is_exact(value) else f"≈ {text}"


def formula(scale: Scale) -> str:
    """Return the formula for a quantity in the form that manuals print: ``(value + 152) / 2.776``."""
    # The quantity is (value * numerator + offset) / denominator. The result is the first form with a whole offset.
    numerator = scale.numerator
    denominator = scale.denominator
    offset = scale.offset
    if offset % denominator == 0:
        product = f"value{_factor_text(numerator, denominator)}"
        return _sum_text(product, offset // denominator)
    if offset % numerator == 0:
        value_with_offset = _sum_text("value", offset // numerator)
        return f"({value_with_offset}){_factor_text(numerator, denominator)}"
    product = f"value × {numerator}" if numerator > 1 else "value"
    return f"({_sum_text(product, offset)}) / {denominator}"


def _sum_text(text: str, number: int) -> str:
    """Return a sum as text, such as ``value - 40``. If the number is 0, return the text unchanged."""
    if number == 0:
        return text
    sign = "-" if number < 0 else "+"
    return f"{text} {sign} {abs(number)}"


def _factor_text(numerator: int, denominator: int) -> str:
    """Return a fraction as a factor that follows a value, such as `` × 5 / 3``, or "" for a factor of 1.

    If one side is a power of ten, the fraction becomes a decimal: `` × 0.5`` or `` / 2.5``.
    """
    if numerator == denominator:
        return ""
    if denominator == 1:
        return f" × {numerator}"
    if _is_power_of_ten(numerator):
        return f" / {_divided_by_power_of_ten(denominator, numerator)}"
    if _is_power_of_ten(denominator):
        return f" × {_divided_by_power_of_ten(numerator, denominator)}"
    return f" × {numerator} / {denominator}"


def _is_power_of_ten(number: int) -> bool:
    """Return whether a positive number is 1, 10, 100 and so on."""
    return str(number).strip("0") == "1"


def _divided_by_power_of_ten(number: int, power_of_ten: int) -> str:
    """Return a number divided by a power of ten as a decimal without trailing zeros: 2776 by 1000 is ``2.776``."""
    decimal_count = len(str(power_of_ten)) - len("1")
    # Leading zeros make sure that at least one digit is before the point.
    digits = f"{number:0{decimal_count + 1}}"
    position_of_point = len(digits) - decimal_count
    return f"{digits[:position_of_point]}.{digits[position_of_point:]}".rstrip("0").rstrip(".")


def _number_of_decimals(value: Fraction) -> int | None:
    """Return how many decimals a number has, or None if they never end."""
    # Each decimal divides the denominator by 2, by 5 or by both, so there are at most as many as it has bits.
    highest_count = value.denominator.bit_length()
    for decimal_count in range(highest_count + 1):
        if 10**decimal_count % value.denominator == 0:
            return decimal_count
    return None


def count_with_unit(count: int | str, unit: str) -> str:
    """Return a count with its unit: ``1 bit``, ``8 bits`` or ``position_bits bits``."""
    return f"{count} {unit}" if count == 1 else f"{count} {unit}s"


def with_unit(value: int | str, unit: str) -> str:
    """Return a value with a unit that specs give in the plural: ``1 revolution``, ``8 revolutions``, ``50 µm``."""
    is_word = len(unit) > 3  # unlike ms, µs and ns
    if is_word and str(value) == "1":
        unit = unit.removesuffix("s")
    return f"{value} {unit}".rstrip()


def first_of(texts: Sequence[str], count: int = 3, between: str = ", ") -> str:
    """Return the first ``count`` items as a list, followed by the number of the others: ``a, b, c and 5 more``."""
    first_texts = between.join(texts[:count])
    omitted_count = len(texts) - count
    return f"{first_texts} and {omitted_count} more" if omitted_count > 0 else first_texts


#: ASCII replacements for signs that Unicode does not decompose, or decomposes badly.
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
    """Return the text in ASCII, with signs replaced according to ``replacements`` or else ``STAND_INS``.

    Letters lose their accents. Signs without a replacement become ``?``.
    """
    if text.isascii():
        return text
    replacement_by_sign = {**STAND_INS, **replacements}
    replaced = text.translate({ord(sign): replacement for sign, replacement in replacement_by_sign.items()})
    # This Unicode form separates each accent from its letter.
    decomposed = unicodedata.normalize("NFKD", replaced)
    without_accents = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    return without_accents.encode("ascii", "replace").decode()


#: Width of a terminal in columns.
WIDTH = 80
_CONTROL_CHARACTERS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]+")


def one_line(text: object) -> str:
    """Return the text on one line, with spaces in place of control characters, line ends and direction marks."""
    line = str(text)
    return line if line.isprintable() else _CONTROL_CHARACTERS.sub(" ", line)


def text_on_one_line(text: object) -> str:
    """Return the text on one line, without leading and trailing spaces."""
    return one_line(text).strip()


def wrap_text(text: object, width: int, prefix: str = "", first: str | None = None) -> str:
    """Return the text as lines of at most ``width`` columns. Only a line with a single long word can be longer.

    Each line starts with ``prefix``, except the first line if ``first`` is given. A text without words stays empty.
    """
    words = [word for word in text_on_one_line(text).split(" ") if word]
    if not words:
        return ""
    first_word, *further_words = words
    first_prefix = prefix if first is None else first
    lines: list[str] = []
    current_line = f"{first_prefix}{first_word}"
    for word in further_words:
        length_with_word = len(current_line) + 1 + len(word)  # with a space between them
        if length_with_word > width:
            lines.append(current_line)
            current_line = prefix + word
        else:
            current_line = f"{current_line} {word}"
    return "\n".join([*lines, current_line])


#: Widest first column of a table with two columns.
_WIDEST_NAME = 40


def two_columns(rows: Iterable[tuple[str, str]], indent: int) -> list[str]:
    """Return the lines of a table with two columns: names and texts. Texts are wrapped, and can be empty.

    The second column begins two spaces after the longest name, or after 40 characters if a name is longer than that. A
    name that is too long moves its text to the right. ``indent`` is the number of spaces in front of the names.
    """
    row_list = list(rows)
    longest_name = max((len(name) for name, _ in row_list), default=0)
    name_width = min(longest_name, _WIDEST_NAME)
    margin = " " * indent
    text_margin = " " * (indent + name_width + 2)
    lines: list[str] = []
    for name, text in row_list:
        if text:
            name_column = f"{margin}{name.ljust(name_width)}  "
            lines.append(wrap_text(text, WIDTH, prefix=text_margin, first=name_column))
        else:
            lines.append(f"{margin}{name}")
    return lines
