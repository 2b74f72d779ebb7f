"""Rules for facts that a revision leaves behind in texts: quantities, names, states, byte orders and defaults."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Literal, NamedTuple

from ...model import Characteristic
from ..document import Path
from ..keys_of_fields import WrittenRegister
from ..keys_of_specs import WrittenErratum, WrittenExample, WrittenSpec
from ..problems import DocumentReport, join_words, quoted, suggest_word
from ..written import located
from .parts import by_name
from .walk import (
    KEYS_OF_TEXTS,
    SECTIONS_NOT_ABOUT_ENCODER,
    ErratumTargets,
    is_derived,
    leaves,
    leaves_of,
    texts_about_encoder,
)

#: Factors to the smallest unit of a quantity, by the units of texts and by the ends of keys.
_UNIT_FACTORS: Mapping[str, Mapping[str, int]] = {
    "voltage": {"V": 1000, "mV": 1, "mv": 1},
    "frequency": {"MHz": 1_000_000, "kHz": 1000, "Hz": 1, "hz": 1},
    "current": {"A": 1000, "mA": 1, "ma": 1},
    "temperature": {"°C": 1},
    "torque": {"Nm": 1},
    "length": {"m": 1},
}
#: ``"voltage"`` for ``"mV"`` and so on.
_KIND_OF_UNIT = {unit: kind for kind, factors in _UNIT_FACTORS.items() for unit in factors}
_UNITS_OF_KEYS_ONLY = frozenset(("mv", "hz", "ma"))
_UNITS_IN_TEXTS = "|".join(sorted(_KIND_OF_UNIT.keys() - _UNITS_OF_KEYS_ONLY, key=len, reverse=True))
#: A quantity such as ``-20 °C`` or ``4.5 V``, but not a tolerance such as ``± 5 V``.
_QUANTITY_IN_TEXT = re.compile(
    rf"(?<![\w.,±])(?<!± )(?P<number>[+−-]?\d+(?:,\d{{3}})*(?:\.\d+)?) ?(?P<unit>{_UNITS_IN_TEXTS})(?![\w/])"
)
_NOUN = "bits?|registers?|commands?|alarms?|inputs?"
#: A printed name in quotes, with the word for its kind.
_QUOTED_NAME = re.compile(
    rf'"(?P<before>[A-Z][^"]{{2,60}})" (?:{_NOUN})\b|\b(?:{_NOUN}) "(?P<after>[A-Z][^"]{{2,60}})"'
)
_KEYS_OF_NAMES = frozenset(("printed_name", "title", "signal", "name"))


def check_erratum_quantities(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the quantities in ``used``, an erratum's text about what applies, are in the facts that it affects.

    Without quantities in ``used``, those in ``printed``, the text of the manual, are compared. Quantities are compared
    only with quantities of the same kind. Overlays and older editions change facts without changing every text, so they
    are not checked.
    """
    if is_derived(report.document):
        return
    erratum_targets = ErratumTargets(spec.data)
    for erratum in spec.errata:
        key = "used"
        quantity_matches = list(_QUANTITY_IN_TEXT.finditer(erratum.used))
        if not quantity_matches:
            key = "printed"
            quantity_matches = list(_QUANTITY_IN_TEXT.finditer(erratum.printed))
        # An erratum with readings is about two printed values, and the facts have only one of them.
        if not quantity_matches or erratum.readings:
            continue
        affected_facts: list[object] = []
        for affected_path in erratum.affects:
            affected_facts += erratum_targets.values_at(affected_path)
        texts_by_kind = _texts_of_quantities(affected_facts)
        messages = [_message_on_quantity(quantity_match, texts_by_kind) for quantity_match in quantity_matches]
        first_message = next(filter(None, messages), "")
        if first_message:
            report.add("left-behind", erratum.path_of(key), first_message, cause=first_message)


def _texts_of_quantities(facts: Iterable[object]) -> dict[str, dict[Decimal, str]]:
    """Return the quantities in facts, by their kind and number: ``{"voltage": {Decimal(4500): "'min_mv: 4500'"}}``."""
    texts_by_kind: dict[str, dict[Decimal, str]] = {}
    for stated in _stated_quantities(facts):
        texts_by_kind.setdefault(stated.kind, {})[stated.number] = stated.text
    return texts_by_kind


def _message_on_quantity(quantity_match: re.Match[str], texts_by_kind: Mapping[str, Mapping[Decimal, str]]) -> str:
    """Return the message about a quantity in a text that differs from all quantities of its kind in the facts.

    ``texts_by_kind`` contains, for each kind such as voltage, the numbers in the facts in the smallest unit, with
    their texts. The result is empty if the quantity is one of them, or if there are none.
    """
    number_text, unit = quantity_match.group("number", "unit")
    text_by_number = texts_by_kind.get(_KIND_OF_UNIT[unit], {})
    if not text_by_number or _in_smallest_unit(number_text, unit) in text_by_number:
        return ""
    texts = [text for text in text_by_number.values() if text]  # The mean of two bounds has no text.
    stated_texts = join_words(texts, "or")
    return (
        f"the text says {quoted(quantity_match[0])}, but the affected facts have {stated_texts}; correct one of the two"
    )


class _StatedQuantity(NamedTuple):
    """A quantity in a fact: its kind, such as voltage, its number in the smallest unit, and its text."""

    kind: str
    number: Decimal
    text: str


def _stated_quantities(facts: Iterable[object]) -> Iterator[_StatedQuantity]:
    """Yield each quantity in facts.

    For the key ``min_mv`` it is ``("voltage", Decimal(4500), "'min_mv: 4500'")``. The values of characteristics state
    their unit under a separate key. The mean of ``min_mv`` and ``max_mv``, which is the nominal value, has no text.
    """
    for fact in facts:
        yield from _nominal_quantities(fact)
        for path, value in leaves(fact):
            key = str(path[-1]) if path else ""
            _, _, unit = key.rpartition("_")  # ``mv`` of ``min_mv``.
            if unit in _KIND_OF_UNIT and isinstance(value, int):
                yield _StatedQuantity(_KIND_OF_UNIT[unit], Decimal(value), f"'{key}: {value}'")
        if isinstance(fact, dict):
            yield from _quantities_of_characteristic(located(Characteristic, fact, ()).part)


def _quantities_of_characteristic(characteristic: Characteristic) -> Iterator[_StatedQuantity]:
    """Yield each bound of the quantities of a characteristic: ``("voltage", Decimal(4500), "4.5 V")``."""
    for quantity in characteristic.values:
        unit = quantity.unit
        for bound in (quantity.min, quantity.typical, quantity.max):
            if unit in _KIND_OF_UNIT and bound is not None:
                number = _in_smallest_unit(str(bound), unit)
                yield _StatedQuantity(_KIND_OF_UNIT[unit], number, f"{bound} {unit}")


def _nominal_quantities(fact: object) -> Iterator[_StatedQuantity]:
    """Yield the mean of each pair of bounds in a fact, such as ``min_mv`` and ``max_mv``. The mean has no text."""
    values_by_path = {path: value for path, value in leaves(fact) if path}
    for path, maximum in values_by_path.items():
        prefix, _, unit = str(path[-1]).partition("_")  # ``max`` and ``mv`` of ``max_mv``.
        if prefix != "max" or unit not in _KIND_OF_UNIT:
            continue
        minimum = values_by_path.get((*path[:-1], f"min_{unit}"))
        if isinstance(minimum, int) and isinstance(maximum, int):
            mean = Decimal(minimum + maximum) / 2
            yield _StatedQuantity(_KIND_OF_UNIT[unit], mean, text="")


def _in_smallest_unit(number_text: str, unit: str) -> Decimal:
    """Return a quantity in the smallest unit of its kind: 4500 for ``4.5`` and the unit V."""
    number = Decimal(number_text.replace(",", "").replace("−", "-"))
    kind = _KIND_OF_UNIT[unit]
    return number * _UNIT_FACTORS[kind][unit]


def check_quoted_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a bit, register, command, alarm or input that a text names in quotes exists in the spec.

    Names are compared without regard to capitals and punctuation. Overlays and older editions change names without
    changing every text, so specs with either are not checked.
    """
    if is_derived(report.document):
        return
    names_in_spec = _names_of_all_parts(spec, report)
    folded_names = {_name_for_comparison(name) for name in names_in_spec}
    for path, text in texts_about_encoder(spec, KEYS_OF_TEXTS, report):
        for match in _QUOTED_NAME.finditer(text):
            # The name is before the word for its kind, as in "Preset" register, or after it.
            name_before, name_after = match.group("before", "after")
            name = name_before or name_after
            if _name_for_comparison(name) not in folded_names:
                hint = suggest_word(name, names_in_spec)
                message = f"nothing here is called {quoted(name)}{hint}; correct the text"
                report.add("left-behind", path, message, cause=name)


#: Least number of words in a name that is recognized in a text although one word differs.
_WORDS_OF_LONG_NAME = 3


def check_renamed_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts name a register with a name of three or more words as the spec does.

    A phrase that differs from the name in one word in the middle, such as ``Preset setting enable`` for
    ``Preset write enable``, is the old name of a renamed register, unless something else has this name.
    """
    if is_derived(report.document):
        return
    known_names = {_name_for_comparison(name) for name in _names_of_all_parts(spec, report)}
    words_by_name: dict[str, list[str]] = {}  # The words of each long printed name.
    for register in by_name(spec.registers).values():
        words_of_name = register.printed_name.split()
        if len(words_of_name) >= _WORDS_OF_LONG_NAME:
            words_by_name[register.printed_name] = words_of_name
    if not words_by_name:
        return
    for path, text in texts_about_encoder(spec, KEYS_OF_TEXTS | {"printed", "title"}, report):
        for name, words_of_name in words_by_name.items():
            similar_phrase = _similar_phrase(text, words_of_name)
            if similar_phrase and _name_for_comparison(similar_phrase) not in known_names:
                problem = f"nothing here is called {quoted(similar_phrase)}; did you mean {quoted(name)}?"
                report.add("left-behind", path, f"{problem} Correct the text", cause=similar_phrase)


def _similar_phrase(text: str, words_of_name: Sequence[str]) -> str:
    """Return the first words of a text that differ from a name in exactly one word in the middle, or ""."""
    words_of_text = re.findall(r"[\w-]+", text)
    last_start = len(words_of_text) - len(words_of_name)
    for start in range(last_start + 1):
        phrase = words_of_text[start : start + len(words_of_name)]
        word_pairs = zip(phrase, words_of_name, strict=True)
        different_words = [word for word, word_of_name in word_pairs if word != word_of_name]
        has_same_ends = (phrase[0], phrase[-1]) == (words_of_name[0], words_of_name[-1])
        if has_same_ends and len(different_words) == 1:
            return " ".join(phrase)
    return ""


def _names_of_all_parts(spec: WrittenSpec, report: DocumentReport) -> list[str]:
    """Return the names of all parts of a spec, each once: names in the manual, in other languages and in the spec."""
    names: dict[str, None] = {}  # In the order of the spec, each once.
    for path, text in leaves_of(spec.data, report):
        section, key = path[0], path[-1]
        is_about_encoder = section != "errata" and section not in SECTIONS_NOT_ABOUT_ENCODER
        is_in_other_language = path[-2:-1] == ("names",)
        is_name = key in _KEYS_OF_NAMES or is_in_other_language
        if isinstance(text, str) and is_about_encoder and is_name:
            names[text] = None
    return list(names)


def _name_for_comparison(printed_name: str) -> str:
    """Return a name in lower case, with one space for all other characters between letters and digits."""
    return re.sub(r"[\W_]+", " ", printed_name).strip().casefold()


#: A state of an LED in a text, such as "The LED is off".
_LED_IS = re.compile(
    r"\bLED (?:is|goes|turns|stays|lights up) (?P<state>off|red|green|yellow|orange|amber|blue|white)\b", re.IGNORECASE
)
_TEXTS_ON_LEDS = frozenset(("meaning", "when_active", "when_inactive", "low", "high"))


def check_led_states(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a state of an LED in a text, as in ``the LED is off``, is a state that some LED of the spec has.

    A spec without LEDs is not checked.
    """
    state_names: list[str] = []
    for led in spec.data.get("leds", ()):
        state_names += [str(led_state.get("state", "")).casefold() for led_state in led["states"]]
    words_of_known_states = set(re.findall(r"\w+", " ".join(state_names)))
    if not state_names or is_derived(report.document):
        return
    for path, text in texts_about_encoder(spec, _TEXTS_ON_LEDS, report):
        for match in _LED_IS.finditer(text):
            state = match.group("state")
            if state.casefold() not in words_of_known_states:
                problem = f"the text says {quoted(match[0])}, but no LED has the state {quoted(state)}"
                report.add("left-behind", path, f"{problem}; correct one of the two", cause=state)


_FIRST_BYTE = re.compile(r"\b(?P<byte>low|high) byte (?:comes|is sent) first\b")


def check_byte_order_in_texts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the byte order of a register agrees with its meaning and note, if they say which byte comes first."""
    if is_derived(report.document):
        return
    for register in by_name(spec.registers).values():
        for key, text in (("meaning", register.meaning), ("note", register.note)):
            match = _FIRST_BYTE.search(text)
            if match is None or not register.byte_order:
                continue
            stated_order = f"{match['byte']}_byte_first"
            if register.byte_order != stated_order:
                problem = f"the text says {quoted(match[0])}, but 'byte_order' is {register.byte_order}"
                report.add("left-behind", register.path_of(key), f"{problem}; correct one of the two")


#: A number such as ``0x3F``, ``3Fh`` or ``63``.
_NUMBER = r"(?P<number>0[xX][0-9A-Fa-f]+|[0-9][0-9A-F]*h\b|[0-9]+(?![0-9A-Fa-f]*h\b|[.,]?[0-9A-Za-z]))"
#: The start value of a CRC in words, unless the sentence restricts it.
_START_VALUE = re.compile(rf"\bstart value (?:is |of |to )?{_NUMBER}(?! unless)", re.IGNORECASE)
#: The default of a register in words.
_DEFAULT_IN_TEXT = re.compile(rf"\bdefault (?:value )?(?:is |of ){_NUMBER}(?! unless)", re.IGNORECASE)
#: Words in the name of an example that shows the factory default of a register.
_AS_DELIVERED = frozenset(("default", "defaults", "delivered"))


class _StatedKey(NamedTuple):
    """A key of a part of a spec that contains a number, and a pattern that finds this number in a text."""

    section: str
    name: str
    pattern: re.Pattern[str]


_INIT_OF_CRC = _StatedKey("crcs", "init", _START_VALUE)
_DEFAULT_OF_REGISTER = _StatedKey("registers", "default", _DEFAULT_IN_TEXT)
#: Numbers by the names of their registers or CRCs. None if the spec does not give one.
_NumberByName = Mapping[str, int | None]


def check_start_values(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a start value in the note of a CRC, or in an erratum about it, is the ``init`` of the CRC."""
    for located_crc in spec.crcs:
        crc = located_crc.part
        path = (*located_crc.path, "note")
        _check_number_in_text(crc.note, _INIT_OF_CRC, {crc.name: crc.init}, path=path, report=report)
    # Reversed, so that the first of several CRCs with one name counts.
    start_values = {located_crc.part.name: located_crc.part.init for located_crc in reversed(spec.crcs)}
    for erratum in spec.errata:
        _check_number_in_erratum(erratum, _INIT_OF_CRC, start_values, report)


def check_defaults(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a default in the text of an erratum, or shown by an example, is the ``default`` of its register."""
    register_by_name = by_name(spec.registers)
    defaults = {name: register.default for name, register in register_by_name.items()}
    for erratum in spec.errata:
        _check_number_in_erratum(erratum, _DEFAULT_OF_REGISTER, defaults, report)
    for example in spec.examples:
        register = register_by_name.get(example.register)
        if register is not None and _shows_default(example):
            _check_shown_default(example, register, report)


def _shows_default(example: WrittenExample) -> bool:
    """Return True for an example that shows the bytes of a register and has "default" or "delivered" in its name.

    The result is False for an example with an erratum, which explains a difference.
    """
    words_of_name = example.name.split("_")
    is_called_default = not _AS_DELIVERED.isdisjoint(words_of_name)
    shows_register = example.kind == "register" and bool(example.bytes)
    return shows_register and is_called_default and not example.erratum


def _check_shown_default(example: WrittenExample, register: WrittenRegister, report: DocumentReport) -> None:
    """Check that the bytes of an example are the default of a register, if the byte order of the register is known."""
    default_digits = _default_in_hexadecimal(register)
    shown_digits = example.bytes.replace(" ", "").casefold()
    if not default_digits or shown_digits == default_digits:
        return
    message = f"the example shows the default of {quoted(example.register)}, which is {register.default:#x}"
    digits_in_other_order = bytes.fromhex(default_digits)[::-1].hex()
    if shown_digits == digits_in_other_order:
        message += ", in the other byte order; correct 'byte_order', 'default' or the bytes"
    else:
        message += "; correct one of the two, or give the example another name"
    report.add("left-behind", example.path_of("bytes"), message)


def _check_number_in_erratum(
    erratum: WrittenErratum, stated_key: _StatedKey, number_by_name: _NumberByName, report: DocumentReport
) -> None:
    """Check that the number in ``used``, an erratum's text about what applies, is that of the part that it affects.

    ``number_by_name`` contains the number under the key for each part of the section.
    """
    affected_numbers = _numbers_affected_by(erratum, stated_key, number_by_name)
    _check_number_in_text(erratum.used, stated_key, affected_numbers, path=erratum.path_of("used"), report=report)


def _numbers_affected_by(
    erratum: WrittenErratum, stated_key: _StatedKey, number_by_name: _NumberByName
) -> _NumberByName:
    """Return those of ``number_by_name`` that an erratum affects: the values of a key in the parts of a section.

    For the section ``crcs`` and the key ``init``, an erratum affects the number of the CRC ``word`` if it affects
    ``crcs.word`` or ``crcs.word.init``.
    """
    affected_numbers: dict[str, int | None] = {}
    for affected_path in erratum.affects:
        section, *names = affected_path.split(".")
        if section != stated_key.section or not names:
            continue
        part_name, *keys = names
        affects_number = keys in ([], [stated_key.name])
        if affects_number and part_name in number_by_name:
            affected_numbers[part_name] = number_by_name[part_name]
    return affected_numbers


def _check_number_in_text(
    text: str, stated_key: _StatedKey, number_by_name: _NumberByName, *, path: Path, report: DocumentReport
) -> None:
    """Report a text whose number, found with the pattern of ``stated_key``, differs from one of ``number_by_name``.

    Only the first difference is reported. Numbers that are None are not compared.
    """
    match = stated_key.pattern.search(text)
    if match is None:
        return
    possible_numbers = _possible_numbers(match["number"])
    for name, number in number_by_name.items():
        if number is not None and number not in possible_numbers:
            message = (
                f"the text says {quoted(match[0])}, but {quoted(stated_key.name)} of {quoted(name)} is {number:#x}; "
                "correct one of the two"
            )
            report.add("left-behind", path, message)
            return


def _possible_numbers(number_text: str) -> set[int]:
    """Return the numbers that a text can be: 63 for ``0x3F``, ``3Fh`` and ``63``, but 10 and 2 for ``10``."""
    if number_text.endswith("h"):
        return {int(number_text.removesuffix("h"), 16)}
    if number_text.lower().startswith("0x"):
        return {int(number_text, 16)}
    may_be_binary = len(number_text) > 1 and set(number_text) <= {"0", "1"}
    return {int(number_text), int(number_text, 2)} if may_be_binary else {int(number_text)}


def _default_in_hexadecimal(register: WrittenRegister) -> str:
    """Return the default of a register as hexadecimal digits in byte order: ``"3412"`` for 0x1234, low byte first.

    The result is empty if there is no default, if there are several bytes without a byte order, or if the default does
    not fit.
    """
    default = register.default
    is_order_unknown = register.length > 1 and not register.byte_order
    if default is None or is_order_unknown:
        return ""
    byte_order: Literal["little", "big"] = "little" if register.byte_order == "low_byte_first" else "big"
    try:
        return default.to_bytes(register.length, byte_order, signed=default < 0).hex()
    except OverflowError:
        return ""
