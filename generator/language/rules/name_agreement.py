"""Rules for names that other names or their own meanings repeat."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from ..document import Path
from ..problems import DocumentReport, is_typo, quoted
from ..written_layouts import WrittenField
from ..written_parts import WrittenSpec
from .parts import constant_width, field_lists

#: Words of a name, with the patterns of their opposites.
_OPPOSITE_WORDS = {
    "singleturn": re.compile(r"multi-?turn", re.IGNORECASE),
    "multiturn": re.compile(r"single-?turn", re.IGNORECASE),
    "read": re.compile(r"writ(?:es?|ing|ten)", re.IGNORECASE),
    "write": re.compile(r"read(?:s|ing)?", re.IGNORECASE),
}
#: The number of an LED in a name or title.
_LED_NUMBER = re.compile(r"led[ _]?(\d+)", re.IGNORECASE)
#: Length of the shortest word that is compared with words of other names, and largest number of compared names.
_SHORTEST_COMPARED_WORD, _MOST_NAMES = 6, 300
#: Last letters of another form of a word, as in ``letters``, ``stored``, ``encoder`` and ``battery``.
_LETTERS_OF_OTHER_FORMS = "sdrye0123456789"


def check_names_and_meanings(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no meaning begins with the opposite of a word in the name, such as "Write a byte" for ``read``."""
    for named_text in _named_texts(spec):
        first_word, _, _ = named_text.text.partition(" ")
        words_of_name = set(named_text.name.split("_"))
        has_both_opposites = {"read", "write"} <= words_of_name or {"singleturn", "multiturn"} <= words_of_name
        if has_both_opposites:
            continue
        for word, opposite in _OPPOSITE_WORDS.items():
            if word in words_of_name and opposite.fullmatch(first_word):
                problem = f"the text begins with {quoted(first_word)}, but the name has {quoted(word)}"
                report.add("words-contradict", named_text.path, f"{problem}; correct one of the two")


def check_numbers_of_leds(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the number of an LED in its name, such as ``led_1``, is the number in its title, as in "LED 1"."""
    for led in spec.leds:
        numbers_in_name = _LED_NUMBER.findall(led.part.name)
        numbers_in_title = _LED_NUMBER.findall(led.part.title)
        if numbers_in_name and numbers_in_title and numbers_in_name != numbers_in_title:
            message = f"the title has {numbers_in_title[0]}, but the name is {quoted(led.part.name)}"
            report.add("words-contradict", (*led.path, "title"), f"{message}; correct one of the two")


class _NamedText(NamedTuple):
    """A text about a part of a spec, with the name of the part and the path of the text."""

    name: str
    text: str
    path: Path


def _named_texts(spec: WrittenSpec) -> Iterator[_NamedText]:
    """Yield the texts about each parameter, part of an order code, data ID, field and value."""
    for name, parameter in spec.parameters.items():
        yield _NamedText(name, parameter.meaning, parameter.place_of("meaning"))
    for code_part in spec.order_code.parts:
        yield _NamedText(code_part.name, code_part.meaning, code_part.place_of("meaning"))
    rs485 = spec.interfaces.rs485
    if rs485 is not None:
        for data_id in rs485.data_ids:
            yield _NamedText(data_id.part.name, data_id.part.meaning, (*data_id.path, "meaning"))
    for field_list in field_lists(spec):
        for field in field_list.fields:
            yield _NamedText(field.name, field.meaning, field.place_of("meaning"))
            yield _NamedText(field.name, field.when_active, field.place_of("when_active"))
            for value_name, value in field.values.items():
                yield _NamedText(value_name, value.meaning, value.place_of("meaning"))


def check_misspelt_fields(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no field has the name of another one with a letter more or less, as ``posiion`` for ``position``.

    The rarer of the two names is reported, at its first field.
    """
    path_by_name: dict[str, Path] = {}
    counts: Counter[str] = Counter()
    for field_list in field_lists(spec):
        for field in field_list.fields:
            path_by_name.setdefault(field.name, field.place_of("name"))
            counts[field.name] += 1
    compared_names = list(counts)[:_MOST_NAMES]
    for pair_of_names in combinations(compared_names, 2):
        # Of equally common names, the first one counts as rarer.
        rarer, common = sorted(pair_of_names, key=lambda name: counts[name])
        if _lacks_a_letter(rarer.split("_"), common.split("_")):
            message = f"another field is {quoted(common)}; correct one of the two, or give them names that differ more"
            report.add("misspelt-name", path_by_name[rarer], message)


def _lacks_a_letter(words: Sequence[str], other_words: Sequence[str]) -> bool:
    """Return True if two names differ in only one word, which lacks a letter in one of them, as ``positio`` does.

    Short words are not compared. A word with a letter more at its beginning, or with the ending of another form, such
    as ``letters`` for ``letter``, is a different word.
    """
    if len(words) != len(other_words):
        return False
    word_pairs = zip(words, other_words, strict=True)
    different_pairs = [(word, other_word) for word, other_word in word_pairs if word != other_word]
    if len(different_pairs) != 1:
        return False
    word, other_word = different_pairs[0]
    shorter, longer = sorted((word, other_word), key=len)
    is_long = len(shorter) >= _SHORTEST_COMPARED_WORD
    has_other_length = len(longer) > len(shorter)
    is_other_form = longer.startswith(shorter) and longer[-1] in _LETTERS_OF_OTHER_FORMS
    is_other_word = is_other_form or longer.endswith(shorter)
    return is_long and has_other_length and not is_other_word and is_typo(shorter, longer)


_DIGITS = re.compile(r"\d+")
#: A printed range of bits or bytes, such as ``ADD6 ... ADD0``.
_PRINTED_RANGE = re.compile(r"(?P<name>[A-Za-z_]+)(?P<first>\d{1,3}) ?(?:\.\.\.|…|to) ?(?P=name)(?P<last>\d{1,3})")
_QUOTED_DIGITS = re.compile(r"\"(\d+)\"")


def check_numbers_in_printed_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the printed name ``STATUS1`` of a register, field or value that is called ``status1`` has its number.

    Only names with the same words are compared.
    """
    for register in spec.registers:
        _compare_numbers(register.name, register.printed_name, register.place_of("printed_name"), report)
    for field_list in field_lists(spec):
        for field in field_list.fields:
            _compare_numbers(field.name, field.printed_name, field.place_of("printed_name"), report)
            for name, value in field.values.items():
                _compare_numbers(name, value.printed_name, value.place_of("printed_name"), report)


def _compare_numbers(name: str, printed_name: str, path: Path, report: DocumentReport) -> None:
    """Report a printed name that differs from a name only in a number."""
    printed_as_name = re.sub(r"\W+", "_", printed_name.lower()).strip("_")
    has_same_words = _DIGITS.sub("0", printed_as_name) == _DIGITS.sub("0", name)
    if has_same_words and printed_as_name != name:
        message = f"only a number differs from the name {quoted(name)}; correct one of the two"
        report.add("printed-number", path, message)


def check_printed_widths(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that printed names fit the width of a field: ranges such as ``ADD6 ... ADD0``, and values such as ``"01"``.

    A range is of bits or of bytes. Values in quotes are compared if another value of the field is printed in binary.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            width = constant_width(field)
            printed_range = _PRINTED_RANGE.fullmatch(field.printed_name)
            if width is None:
                continue
            if printed_range is not None:
                count = abs(int(printed_range.group("first")) - int(printed_range.group("last"))) + 1
                if width not in (count, 8 * count):
                    message = f"the range has {count} bits or bytes, but the field has {width} bits"
                    report.add("printed-number", field.place_of("printed_name"), f"{message}; correct one of the two")
            _check_values_in_quotes(field, width, report)


def _check_values_in_quotes(field: WrittenField, width: int, report: DocumentReport) -> None:
    """Report a value that is printed as other digits in quotes, if another value of the field is printed in binary."""
    digits_by_name: dict[str, str] = {}
    for name, value in field.values.items():
        match = _QUOTED_DIGITS.fullmatch(value.printed_name)
        if match is not None:
            digits_by_name[name] = match[1]
    other_digits: dict[str, str] = {}
    for name, digits in digits_by_name.items():
        if len(digits) != width or not set(digits) <= {"0", "1"}:
            other_digits[name] = digits
    is_binary = len(other_digits) < len(digits_by_name)
    for name, digits in other_digits.items():
        if is_binary:
            message = f"{quoted(digits)} is not a binary number of {width} bits, as in the other values of the field"
            report.add("printed-number", field.values[name].place_of("printed_name"), message)
