"""Rules for names: typos, and names that contradict their meaning, their printed name, or what they belong to."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple, Protocol

from ..document import Path
from ..keys_of_fields import WrittenField
from ..keys_of_specs import WrittenSpec, WrittenStep
from ..problems import DocumentReport, is_typo, quoted, suggest_word
from .parts import by_name, constant_width, field_lists, owner_of_alarm, register_of_step, value_names_of_register
from .walk import KEYS_OF_TEXTS, SECTIONS_ON_OTHER_DOCUMENTS, is_derived, leaves_of, texts_about_encoder

#: Words of a name, with the patterns of their opposites.
_OPPOSITE_PATTERN_BY_WORD = {
    "singleturn": re.compile(r"multi-?turn", re.IGNORECASE),
    "multiturn": re.compile(r"single-?turn", re.IGNORECASE),
    "read": re.compile(r"writ(?:es?|ing|ten)", re.IGNORECASE),
    "write": re.compile(r"read(?:s|ing)?", re.IGNORECASE),
}
#: The number of an LED in a name or title.
_LED_NUMBER = re.compile(r"led[ _]?(\d+)", re.IGNORECASE)
#: Length of the shortest word that is compared with words of other names, and largest number of compared names.
_SHORTEST_COMPARED_WORD, _MOST_COMPARED_NAMES = 6, 300
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
        for word, opposite in _OPPOSITE_PATTERN_BY_WORD.items():
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
        yield _NamedText(name, parameter.meaning, parameter.path_of("meaning"))
    for code_part in spec.order_code.parts:
        yield _NamedText(code_part.name, code_part.meaning, code_part.path_of("meaning"))
    rs485 = spec.interfaces.rs485
    if rs485 is not None:
        for data_id in rs485.data_ids:
            yield _NamedText(data_id.part.name, data_id.part.meaning, (*data_id.path, "meaning"))
    for field_list in field_lists(spec):
        for field in field_list.fields:
            yield _NamedText(field.name, field.meaning, field.path_of("meaning"))
            yield _NamedText(field.name, field.when_active, field.path_of("when_active"))
            for value_name, value in field.values.items():
                yield _NamedText(value_name, value.meaning, value.path_of("meaning"))


def check_misspelt_fields(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no field has the name of another one with a letter more or less, as ``posiion`` for ``position``.

    The rarer of the two names is reported, at its first field.
    """
    first_path_by_name: dict[str, Path] = {}
    field_count_by_name: Counter[str] = Counter()
    for field_list in field_lists(spec):
        for field in field_list.fields:
            first_path_by_name.setdefault(field.name, field.path_of("name"))
            field_count_by_name[field.name] += 1
    compared_names = list(field_count_by_name)[:_MOST_COMPARED_NAMES]
    for pair_of_names in combinations(compared_names, 2):
        # Of equally common names, the first one counts as rarer.
        rarer, common = sorted(pair_of_names, key=lambda name: field_count_by_name[name])
        if _differ_by_missing_letter(rarer.split("_"), common.split("_")):
            message = f"another field is {quoted(common)}; correct one of the two, or give them names that differ more"
            report.add("misspelt-name", first_path_by_name[rarer], message)


def _differ_by_missing_letter(words: Sequence[str], other_words: Sequence[str]) -> bool:
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
    is_long_enough = len(shorter) >= _SHORTEST_COMPARED_WORD
    differs_in_length = len(longer) > len(shorter)
    is_other_form = longer.startswith(shorter) and longer[-1] in _LETTERS_OF_OTHER_FORMS
    is_other_word = is_other_form or longer.endswith(shorter)
    return is_long_enough and differs_in_length and not is_other_word and is_typo(shorter, longer)


_DIGITS = re.compile(r"\d+")
#: A printed range of bits or bytes, such as ``ADD6 ... ADD0``.
_PRINTED_RANGE = re.compile(r"(?P<name>[A-Za-z_]+)(?P<first>\d{1,3}) ?(?:\.\.\.|…|to) ?(?P=name)(?P<last>\d{1,3})")
_QUOTED_DIGITS = re.compile(r"\"(\d+)\"")


def check_numbers_in_printed_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the printed name ``STATUS1`` of a register, field or value that is called ``status1`` has its number.

    Only names with the same words are compared.
    """
    for register in spec.registers:
        _compare_with_printed_name(register.name, register.printed_name, register.path_of("printed_name"), report)
    for field_list in field_lists(spec):
        for field in field_list.fields:
            _compare_with_printed_name(field.name, field.printed_name, field.path_of("printed_name"), report)
            for name, value in field.values.items():
                _compare_with_printed_name(name, value.printed_name, value.path_of("printed_name"), report)


def _compare_with_printed_name(name: str, printed_name: str, path: Path, report: DocumentReport) -> None:
    """Report a printed name that differs from a name only in a number."""
    printed_as_name = re.sub(r"\W+", "_", printed_name.lower()).strip("_")
    # Numbers are replaced by 0, so that only the words are compared: STATUS1 has the words of status2.
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
            if width is not None:
                _check_printed_range(field, width, report)
                _check_values_in_quotes(field, width, report)


def _check_printed_range(field: WrittenField, width: int, report: DocumentReport) -> None:
    """Check that a printed range, such as ``ADD6 ... ADD0``, has as many bits or bytes as the field."""
    printed_range = _PRINTED_RANGE.fullmatch(field.printed_name)
    if printed_range is None:
        return
    numbers_in_range = abs(int(printed_range.group("first")) - int(printed_range.group("last"))) + 1
    bits_of_bytes = 8 * numbers_in_range
    if width not in (numbers_in_range, bits_of_bytes):
        message = f"the range has {numbers_in_range} bits or bytes, but the field has {width} bits"
        report.add("printed-number", field.path_of("printed_name"), f"{message}; correct one of the two")


def _check_values_in_quotes(field: WrittenField, width: int, report: DocumentReport) -> None:
    """Report a value that is printed as other digits in quotes, if another value of the field is printed in binary."""
    digits_by_name: dict[str, str] = {}
    for name, value in field.values.items():
        match = _QUOTED_DIGITS.fullmatch(value.printed_name)
        if match is not None:
            digits_by_name[name] = match[1]
    non_binary_digits_by_name: dict[str, str] = {}
    for name, digits in digits_by_name.items():
        if len(digits) != width or not set(digits) <= {"0", "1"}:
            non_binary_digits_by_name[name] = digits
    is_binary = len(non_binary_digits_by_name) < len(digits_by_name)
    for name, digits in non_binary_digits_by_name.items():
        if is_binary:
            message = f"{quoted(digits)} is not a binary number of {width} bits, as in the other values of the field"
            report.add("printed-number", field.values[name].path_of("printed_name"), message)


#: Words of which one value cannot have both: in its name and in its meaning.
_OPPOSITES = (
    ("gray", "binary"),
    ("enable", "disable"),
    ("enabled", "disabled"),
    ("clockwise", "counterclockwise"),
    ("cw", "ccw"),
    ("open", "closed"),
    ("on", "off"),
    ("high", "low"),
    ("up", "down"),
)
_OPPOSITE_BY_WORD = {**dict(_OPPOSITES), **{opposite: word for word, opposite in _OPPOSITES}}


def check_name_and_meaning(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the meaning of a named value does not contain the opposite of a word in its name.

    For example, ``binary`` must not mean "Gray code". A meaning that contains both words is accepted.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            for name, value in field.values.items():
                for word, opposite in _yield_contradictions(name, value.meaning):
                    message = f"{quoted(name)} has a meaning with {quoted(opposite)} and without {quoted(word)}"
                    report.add("words-contradict", value.path_of("meaning"), f"{message}; correct one of the two")


def _yield_contradictions(name: str, meaning: str) -> Iterator[tuple[str, str]]:
    """Yield each word of a name whose opposite, but not itself, is in the meaning, with this opposite.

    For the name ``binary`` and the meaning ``Gray code``, this is ``("binary", "gray")``.
    """
    plain_name = name.replace("counter_clockwise", "counterclockwise")
    plain_meaning = re.sub(r"counter-?clockwise", "counterclockwise", meaning.casefold())
    meaning_words = set(re.findall(r"[a-z]+", plain_meaning))
    for word in plain_name.split("_"):
        if word not in _OPPOSITE_BY_WORD or word in meaning_words:
            continue
        opposite = _OPPOSITE_BY_WORD[word]
        if opposite in meaning_words:
            yield word, opposite


def check_alarm_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alarm with the name of a flag in its group or register describes that flag, and not another one.

    The key ``field`` of an alarm names its flag. Without this key, the flag has the same name as the alarm.
    """
    for located_alarm in spec.alarms:
        alarm = located_alarm.part
        name = alarm.name
        flag_name = alarm.field or alarm.name
        group_or_register = owner_of_alarm(spec, located_alarm)
        if group_or_register is None or flag_name == name:
            continue
        flag_by_name = by_name(group_or_register.fields)
        if name in flag_by_name and flag_name in flag_by_name:
            owner_name = alarm.group or alarm.register
            problem = (
                f"the alarm {quoted(name)} has the same name as a flag of {quoted(owner_name)}, but describes"
                f" {quoted(flag_name)}; use that flag, or rename the alarm"
            )
            report.add("alarm-name", (*located_alarm.path, "field"), problem)


def check_procedure_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a procedure with the name of a named value writes this value, if it writes to the same register."""
    register_by_name = by_name(spec.with_invalid_parts.registers)
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for procedure in spec.procedures:
        name = procedure.name
        # Steps that write a named value to a register which also has a value with the name of the procedure.
        writes_by_register: dict[str, list[WrittenStep]] = {}
        for step in procedure.steps:
            register = register_of_step(step, register_by_name)
            known_values = value_names_of_register(register, group_by_name, step.field)
            if step.do == "write" and {name, step.value} <= set(known_values):
                writes_by_register.setdefault(step.register, []).append(step)
        for register_name, writes in writes_by_register.items():
            written_values = [write.value for write in writes]
            if name not in written_values:
                last_write = writes[-1]
                message = (
                    f"the procedure {quoted(name)} has the same name as a value of {quoted(register_name)}, but writes"
                    f" {quoted(last_write.value)}; write that value, or rename the procedure"
                )
                report.add("procedure-name", last_write.path_of("value"), message)


#: Letters that a word needs so that one differing letter is likely a mistake, not another word.
_LEAST_LETTERS = 6
#: Longest contents and most tables that are compared. A manual has some 50 entries and 10 tables.
_MOST_ENTRIES = 200


class _Printed(Protocol):
    """A part with its names in manuals."""

    @property
    def printed_name(self) -> str: ...

    @property
    def names(self) -> Mapping[str, str]: ...


def check_misspelt_name(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no name in the manual differs by one letter from an entry of its contents, which would be a typo.

    The names of an alarm are also compared with the names of its flag.
    """
    _compare_with_contents(spec, report)
    for alarm in spec.alarms:
        group_or_register = owner_of_alarm(spec, alarm)
        if group_or_register is None:
            continue
        flag = by_name(group_or_register.fields).get(alarm.part.field)
        if flag is None:
            continue
        # The names by their keys, such as ("names", "it"), so that each is compared with the name in its language.
        flag_name_by_path = dict(_printed_names(flag))
        for name_path, name in _printed_names(alarm.part):
            flag_name = flag_name_by_path.get(name_path, "")
            if _misspells(name, flag_name):
                message = f"the flag of this alarm has {quoted(flag_name)}; correct one of the two"
                report.add("misspelt-name", (*alarm.path, *name_path), message)


def _compare_with_contents(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report each printed name that differs by one letter from an entry of the manual's table of contents.

    An erratum with this name explains it. Names in other languages are not compared, and very long contents are not
    searched.
    """
    manual = spec.with_invalid_parts.manual
    title_by_lower_case: dict[str, str] = {}
    for section in manual.contents.values():
        title_by_lower_case |= {title.casefold(): title for title in section.names_in("entries")}
    if len(title_by_lower_case) > _MOST_ENTRIES:
        return
    texts_of_errata = "\n".join(erratum.used.casefold() for erratum in spec.errata)
    for path, name in leaves_of(spec.data, report):
        # A name in another language can differ by one letter too: temperature, temperatura.
        is_name = path[-1] == "printed_name" or path[-2:] == ("names", manual.language)
        if not is_name or not isinstance(name, str):
            continue
        similar_titles = [title for title in title_by_lower_case if _misspells(name, title)]
        is_known = name.casefold() in title_by_lower_case or name.casefold() in texts_of_errata
        if similar_titles and not is_known:
            printed_title = title_by_lower_case[similar_titles[0]]
            message = (
                f"the table of contents has {quoted(printed_title)}; correct one of the two, "
                "or add an erratum whose 'used' has this name"
            )
            report.add("misspelt-name", path, message)


def _misspells(printed_name: str, correct_name: str) -> bool:
    """Return True if two names differ in only one word, and by only one letter in it.

    Short words, which may be different words, and words that differ only in a plural s are not counted as misspelt.
    """
    if abs(len(printed_name) - len(correct_name)) > 1:
        return False
    words, correct_words = printed_name.casefold().split(), correct_name.casefold().split()
    if len(words) != len(correct_words):
        return False
    word_pairs = zip(words, correct_words, strict=True)
    different_pairs = [(word, correct_word) for word, correct_word in word_pairs if word != correct_word]
    if len(different_pairs) != 1:
        return False
    word, correct_word = different_pairs[0]
    differs_only_in_plural = word.rstrip("s") == correct_word.rstrip("s")
    return len(correct_word) >= _LEAST_LETTERS and not differs_only_in_plural and is_typo(word, correct_word)


def _printed_names(part: _Printed) -> Iterator[tuple[Path, str]]:
    """Yield the printed names of a part, each with its path below it."""
    yield ("printed_name",), part.printed_name
    for language, name in part.names.items():
        yield ("names", language), name


_RS_STANDARD = re.compile(r"\bRS[- ]?(\d{2,4})\b")
_KNOWN_RS_STANDARDS = ("232", "422", "423", "449", "485", "530", "562", "644")


def check_standards(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each standard with the prefix RS in a text exists, such as RS-485.

    The text of the manual that an erratum corrects may name any standard.
    """
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed" or path[0] in SECTIONS_ON_OTHER_DOCUMENTS:
            continue
        unknown_numbers = [number for number in _RS_STANDARD.findall(text) if number not in _KNOWN_RS_STANDARDS]
        if unknown_numbers:
            number = unknown_numbers[0]
            problem = f"RS-{number} is not a known standard; expected one such as RS-422 or RS-485"
            message = f"{problem}; correct the number, or write TIA-{number}"
            report.add("unknown-standard", path, message)


#: The name of an error or alarm with a word in capital letters, such as "ST error".
_NAMED_ERROR = re.compile(r"\b([A-Z]{2,}) (error|alarm|flag|warning)\b")


def check_alarm_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that alarms named in texts, such as ``ST error``, exist: their word in capitals must be in a printed name.

    Only specs with an alarm of such a name are checked. Specs with overlays and older editions are not checked.
    """
    if is_derived(report.document):
        return
    alarm_names = {alarm.part.printed_name for alarm in spec.alarms}
    has_name_with_capitals = any(_NAMED_ERROR.fullmatch(name) for name in alarm_names)
    if not has_name_with_capitals:
        return
    known_words: set[str] = set()  # The words in capitals of all printed names.
    for path, text in leaves_of(spec.data, report):
        if path[-1] in ("printed_name", "title", "signal"):
            known_words.update(re.findall(r"[A-Z]{2,}", str(text)))
    checked_keys = KEYS_OF_TEXTS | {"when_active", "when_inactive"}
    for path, text in texts_about_encoder(spec, checked_keys, report):
        for match in _NAMED_ERROR.finditer(text):
            name, word_in_capitals = match[0], match[1]  # ``ST error`` and ``ST``
            if word_in_capitals not in known_words:
                hint = suggest_word(name, sorted(alarm_names))
                message = f"no alarm here is called {quoted(name)}{hint}; correct the text"
                report.add("left-behind", path, message, cause=name)
