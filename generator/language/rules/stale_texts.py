"""Rules for facts that a revision of the spec leaves behind: quantities, quoted names, addresses, commands, times."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from typing import NamedTuple

from ...model import Characteristic, Timing
from ..document import Document, ErratumTargets, Path
from ..problems import DocumentReport, join_words, quoted, suggest_word
from ..schema_files import PROSE
from ..written import LocatedPart, located
from ..written_codes import WrittenRegister
from ..written_parts import WrittenSpec
from .parts import by_name, interfaces
from .walk import leaves, leaves_of

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
#: Texts about the encoder of today.
KEYS_OF_TEXTS = (PROSE | {"used"}) - {"title", "why", "changes", "source"}
_KEYS_ABOUT_OTHER_DOCUMENTS = frozenset(("documents", "manual", "editions", "evidence", "lost_figures"))


def is_derived(document: Document) -> bool:
    """Return True for an overlay or an older edition, which changes facts without changing every text about them."""
    return bool(document.family or document.other_files)


def yield_texts(spec: WrittenSpec, keys: Collection[str], report: DocumentReport) -> Iterator[tuple[Path, str]]:
    """Yield each text under one of these keys with its path, except texts about other documents."""
    for path, text in leaves_of(spec.data, report):
        is_about_encoder = path[0] not in _KEYS_ABOUT_OTHER_DOCUMENTS
        if isinstance(text, str) and is_about_encoder and path[-1] in keys:
            yield path, text


def check_erratum_quantities(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the quantities in ``used``, an erratum's text about what applies, are in the facts that it affects.

    Without quantities in ``used``, those in ``printed`` are compared. Quantities are compared only with quantities of
    the same kind. Overlays and older editions change facts without changing every text, so they are not checked.
    """
    if is_derived(report.document):
        return
    erratum_targets = ErratumTargets(spec.data)
    for erratum in spec.errata:
        key, quantities = "used", list(_QUANTITY_IN_TEXT.finditer(erratum.used))
        if not quantities:
            key, quantities = "printed", list(_QUANTITY_IN_TEXT.finditer(erratum.printed))
        # An erratum with readings is about two printed values, and the facts have only one of them.
        if not quantities or erratum.readings:
            continue
        affected_facts: list[object] = []
        for affected_path in erratum.affects:
            affected_facts += erratum_targets.at(affected_path)
        stated_by_kind: dict[str, dict[Decimal, str]] = {}
        for stated in _stated_quantities(affected_facts):
            stated_by_kind.setdefault(stated.kind, {})[stated.number] = stated.text
        messages = [_message_on_quantity(quantity, stated_by_kind) for quantity in quantities]
        first_message = next(filter(None, messages), "")
        if first_message:
            report.add("left-behind", erratum.place_of(key), first_message, cause=first_message)


def _message_on_quantity(quantity: re.Match[str], stated_by_kind: Mapping[str, Mapping[Decimal, str]]) -> str:
    """Return the message about a quantity in a text that differs from all quantities of its kind in the facts.

    ``stated_by_kind`` contains, for each kind such as voltage, the numbers in the facts in the smallest unit, with
    their texts. The result is empty if the quantity is one of them, or if there are none.
    """
    number_text, unit = quantity.group("number", "unit")
    text_by_number = stated_by_kind.get(_KIND_OF_UNIT[unit], {})
    if not text_by_number or _in_smallest_unit(number_text, unit) in text_by_number:
        return ""
    stated_texts = join_words(list(filter(None, text_by_number.values())), "or")
    return f"the text says {quoted(quantity[0])}, but the affected facts have {stated_texts}; correct one of the two"


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
        if not isinstance(fact, dict):
            continue
        characteristic = located(Characteristic, fact, ()).part
        for quantity in characteristic.values:
            unit = quantity.unit
            for bound in (quantity.min, quantity.typical, quantity.max):
                if unit in _KIND_OF_UNIT and bound is not None:
                    number = _in_smallest_unit(str(bound), unit)
                    yield _StatedQuantity(_KIND_OF_UNIT[unit], number, f"{bound} {unit}")


def _nominal_quantities(fact: object) -> Iterator[_StatedQuantity]:
    """Yield the mean of each pair of bounds in a fact, such as ``min_mv`` and ``max_mv``."""
    values_by_path = {path: value for path, value in leaves(fact) if path}
    for path, maximum in values_by_path.items():
        bound, _, unit = str(path[-1]).partition("_")
        minimum = values_by_path.get((*path[:-1], f"min_{unit}"))
        if bound == "max" and unit in _KIND_OF_UNIT and isinstance(minimum, int) and isinstance(maximum, int):
            yield _StatedQuantity(_KIND_OF_UNIT[unit], Decimal(minimum + maximum) / 2, "")


def _in_smallest_unit(number_text: str, unit: str) -> Decimal:
    """Return a quantity in the smallest unit of its kind: 4500 for ``4.5`` and the unit V."""
    number = Decimal(number_text.replace(",", "").replace("−", "-"))
    kind = _KIND_OF_UNIT[unit]
    return number * _UNIT_FACTORS[kind][unit]


def check_repeated_waits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a timing about writes to a register has the same wait as this register.

    The register is recognized by its name in the manual, or by its own name: "Command" for ``command``.
    """
    waiting_registers: dict[str, WrittenRegister] = {}  # By their names in texts.
    for register in by_name(spec.registers).values():
        if register.wait_at_least_ms is not None:
            waiting_registers[register.name.replace("_", " ").capitalize()] = register
            waiting_registers[register.printed_name] = register
    for _, interface in interfaces(spec):
        for timing in interface.timings:
            _check_wait(timing, waiting_registers, report)


def _check_wait(
    timing: LocatedPart[Timing], waiting_registers: Mapping[str, WrittenRegister], report: DocumentReport
) -> None:
    """Check that a timing whose meaning says ``write to the … register`` has the wait of this register.

    ``waiting_registers`` contains the registers that need a wait after a write, by their names in the manual.
    """
    match = re.search(r"\bwrite to the (.+?) register\b", timing.part.meaning)
    if match is None:
        return
    printed_name = match[1].strip('"')
    register = waiting_registers.get(printed_name)
    wait_us = timing.part.at_least_us
    if register is None or register.wait_at_least_ms is None or wait_us is None:
        return
    wait_of_register_us = register.wait_at_least_ms * 1000
    if wait_us != wait_of_register_us:
        message = (
            f"'at_least_us' is {wait_us}, but 'wait_at_least_ms' of {quoted(register.name)} "
            f"is {register.wait_at_least_ms}; correct one of the two"
        )
        report.add("left-behind", (*timing.path, "at_least_us"), message)


def check_quoted_names(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a bit, register, command, alarm or input that a text names in quotes exists in the spec.

    Names are compared without regard to capitals and punctuation. Overlays and older editions change names without
    changing every text, so specs with either are not checked.
    """
    if is_derived(report.document):
        return
    names_in_spec = _printed_names(spec, report)
    folded_names = {_fold_name(name) for name in names_in_spec}
    for path, text in yield_texts(spec, KEYS_OF_TEXTS, report):
        for match in _QUOTED_NAME.finditer(text):
            # The name is before the word for its kind, as in "Preset" register, or after it.
            name_before, name_after = match.group("before", "after")
            name = name_before or name_after
            if _fold_name(name) not in folded_names:
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
    if report.document.family or report.document.other_files:
        return
    known_names = {_fold_name(name) for name in _printed_names(spec, report)}
    long_names = {register.printed_name: register.printed_name.split() for register in by_name(spec.registers).values()}
    long_names = {name: words for name, words in long_names.items() if len(words) >= _WORDS_OF_LONG_NAME}
    for path, text in leaves_of(spec.data, report) if long_names else ():
        is_text = path[-1] in KEYS_OF_TEXTS or path[-1] in ("printed", "title")
        if not isinstance(text, str) or path[0] in _KEYS_ABOUT_OTHER_DOCUMENTS or not is_text:
            continue
        for name, words in long_names.items():
            similar_phrase = _similar_phrase(text, words)
            if similar_phrase and _fold_name(similar_phrase) not in known_names:
                message = f"nothing here is called {quoted(similar_phrase)}; did you mean {quoted(name)}?"
                report.add("left-behind", path, f"{message} Correct the text", cause=similar_phrase)


def _similar_phrase(text: str, words: Sequence[str]) -> str:
    """Return the first words of a text that differ from ``words`` in exactly one word in the middle, or ""."""
    words_of_text = re.findall(r"[\w-]+", text)
    for index in range(len(words_of_text) - len(words) + 1):
        phrase = words_of_text[index : index + len(words)]
        different_words = [word for word, other in zip(phrase, words, strict=True) if word != other]
        has_same_ends = (phrase[0], phrase[-1]) == (words[0], words[-1])
        if has_same_ends and len(different_words) == 1:
            return " ".join(phrase)
    return ""


def _printed_names(spec: WrittenSpec, report: DocumentReport) -> list[str]:
    """Return the names of all parts of a spec, each once: names in the manual, in other languages and in the spec."""
    names: dict[str, None] = {}  # In the order of the spec, each once.
    for path, text in leaves_of(spec.data, report):
        section, key = path[0], path[-1]
        is_about_encoder = section != "errata" and section not in _KEYS_ABOUT_OTHER_DOCUMENTS
        is_in_other_language = path[-2:-1] == ("names",)
        is_name = key in _KEYS_OF_NAMES or is_in_other_language
        if isinstance(text, str) and is_about_encoder and is_name:
            names[text] = None
    return list(names)


def _fold_name(printed_name: str) -> str:
    """Return a name in lower case, with one space for all other characters between letters and digits."""
    return re.sub(r"[\W_]+", " ", printed_name).strip().casefold()


_WORD_IN_CAPITALS = re.compile(r"(?<![\w/-])[A-Z][A-Z0-9]+(?![\w/-])")


def check_labels_in_errata(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that labels in errata about order codes exist in the order code.

    A word counts as a label if an existing label in the same text has the same shape: letters and digits at the same
    places, as in ``A12`` and ``B07``.
    """
    if is_derived(report.document):
        return
    known_labels = _known_labels(spec)
    for erratum in spec.errata:
        affected_sections = [affected_path.split(".")[0] for affected_path in erratum.affects]
        if "order_code" not in affected_sections:
            continue
        words_in_capitals = _WORD_IN_CAPITALS.findall(erratum.used)
        shapes_of_labels = {_shape_of_label(word) for word in words_in_capitals if word in known_labels}
        unknown_words = [word for word in words_in_capitals if word not in known_labels]
        unknown_labels = [word for word in unknown_words if _shape_of_label(word) in shapes_of_labels]
        if unknown_labels:
            label = unknown_labels[0]
            message = f"{quoted(label)} is not in the order code; correct the text"
            report.add("left-behind", erratum.place_of("used"), message, cause=label)


def _known_labels(spec: WrittenSpec) -> set[str]:
    """Return the labels of all parts of the order code, also as alternative spellings write them."""
    known_labels: set[str] = set()
    for part in by_name(spec.order_code.parts).values():
        known_labels.update(part.values)
    for spelling in spec.order_code.also_written:
        for label_by_spelling in spelling.values.values():
            known_labels.update(label_by_spelling)
    return known_labels


def _shape_of_label(label: str) -> str:
    """Return a label with each letter as A and each digit as 0: ``A00`` for ``B07``."""
    with_equal_letters = re.sub("[A-Z]", "A", label)
    return re.sub("[0-9]", "0", with_equal_letters)


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
    for path, text in yield_texts(spec, checked_keys, report):
        for match in _NAMED_ERROR.finditer(text):
            name, word_in_capitals = match[0], match[1]  # ``ST error`` and ``ST``
            if word_in_capitals not in known_words:
                hint = suggest_word(name, sorted(alarm_names))
                message = f"no alarm here is called {quoted(name)}{hint}; correct the text"
                report.add("left-behind", path, message, cause=name)


#: A state of an LED in a text, such as "The LED is off".
_LED_IS = re.compile(
    r"\bLED (?:is|goes|turns|stays|lights up) (?P<state>off|red|green|yellow|orange|amber|blue|white)\b", re.IGNORECASE
)
_TEXTS_ON_LEDS = frozenset(("meaning", "when_active", "when_inactive", "low", "high"))


def check_led_states(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a state of an LED in a text, as in ``the LED is off``, is a state that some LED of the spec has.

    A spec without LEDs is not checked.
    """
    states: list[str] = []
    for led in spec.data.get("leds", ()):
        states += [str(led_state.get("state", "")).casefold() for led_state in led["states"]]
    words_of_states = set(re.findall(r"\w+", " ".join(states)))
    if not states or is_derived(report.document):
        return
    for path, text in yield_texts(spec, _TEXTS_ON_LEDS, report):
        for match in _LED_IS.finditer(text):
            state = match.group("state")
            if state.casefold() not in words_of_states:
                problem = f"the text says {quoted(match[0])}, but no LED has the state {quoted(state)}"
                report.add("left-behind", path, f"{problem}; correct one of the two", cause=state)


#: An address or a command in a text, such as "register (1Fh)" or "command 03".
_REGISTER_AT = re.compile(r"\b[Rr]egisters? \(?(?P<address>[0-9A-F]{2})h\b")
_COMMANDS = re.compile(r"\b[Cc]ommands? [0-9A-F]{2}(?:(?:, (?:and )?| and | or )[0-9A-F]{2})*\b")
_FIRST_BYTE = re.compile(r"\b(?P<byte>low|high) byte (?:comes|is sent) first\b")
#: Keys of the numbers that a text may call a command.
_KEYS_OF_CODES = frozenset(("value", "constant", "control", "id"))


def check_addresses_and_commands(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers named by their address in texts, and commands named by their code, exist in the spec.

    A spec without registers is not checked, nor is ``printed``, the text of the manual that an erratum corrects.
    """
    registers = by_name(spec.registers).values()
    if not registers or is_derived(report.document):
        return
    addresses: set[int] = set()
    for register in registers:
        addresses.update(range(register.address, register.address + register.length))
    coded_values = [value for path, value in leaves_of(spec.data, report) if path[-1] in _KEYS_OF_CODES]
    known_codes = {value for value in coded_values if isinstance(value, int)}
    for path, text in leaves_of(spec.data, report):
        is_text = path[-1] in KEYS_OF_TEXTS or path[0] == "tables"
        if not isinstance(text, str) or path[0] in _KEYS_ABOUT_OTHER_DOCUMENTS or not is_text:
            continue
        for match in _REGISTER_AT.finditer(text):
            address = match["address"]
            if int(address, 16) not in addresses:
                named_register = quoted(f"register {address}h")
                message = f"the text says {named_register}, but no register has this address; correct one of the two"
                report.add("left-behind", path, message, cause=address)
        for code in _command_codes(text):
            if known_codes.isdisjoint(_possible_numbers(code)):
                named_command = quoted(f"command {code}")
                problem = f"the text says {named_command}, but nothing here has this value"
                report.add("left-behind", path, f"{problem}; correct one of the two", cause=code)


def _possible_numbers(code: str) -> set[int]:
    """Return the numbers that a code in a text can be, because manuals print codes in hexadecimal or in decimal."""
    return {int(code, 16), int(code)} if code.isdigit() else {int(code, 16)}


def _command_codes(text: str) -> Iterator[str]:
    """Yield the codes of commands in a text: ``01`` and ``03`` of ``commands 01 and 03``."""
    for commands in _COMMANDS.findall(text):
        yield from re.findall(r"\b[0-9A-F]{2}\b", commands)


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
                report.add("left-behind", register.place_of(key), f"{problem}; correct one of the two")
