"""Text that identifies facts: names of items, bits, addresses and values, and statements about the evidence for facts.

Some facts have no place of their own in the model. They are in texts: times with a meaning, characteristics, tables and
notes. Subjects that a manual mentions are searched in these texts too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from enum import Enum
from functools import lru_cache
from typing import Protocol

from ..model import (
    LEFT_OUT,
    NOT_KNOWN,
    Device,
    EditionTest,
    Field,
    Flag,
    Interface,
    Register,
    TimesRead,
    Unused,
)
from . import group_digits
from .errata import describe_erratum
from .text import CodeText, Reference, Statement, TextPart, as_sentence, join_groups, statement

_ACRONYMS = {
    "biss": "BiSS",
    "crc": "CRC",
    "eeprom": "EEPROM",
    "id": "ID",
    "led": "LED",
    "leds": "LEDs",
    "lsb": "LSB",
    "rs485": "RS-485",
    "scd": "SCD",
    "spi": "SPI",
    "ssi": "SSI",
    "um": "µm",
}


class Titled(Protocol):
    """Item of the spec, with its name in the spec and its name in the manual."""

    @property
    def name(self) -> str: ...
    @property
    def printed_name(self) -> str: ...


class HasOtherNames(Titled, Protocol):
    """Item that may also have other names in other editions of the manual."""

    @property
    def names(self) -> Mapping[str, str]: ...


def name_in_words(name: str) -> str:
    """Return a name from a spec as words for a sentence: ``encoder_id`` becomes ``encoder ID``."""
    return " ".join(_ACRONYMS.get(word, word) for word in name.split("_"))


def heading(name: str) -> str:
    """Return a name from a spec as a heading: ``encoder_id`` becomes ``Encoder ID``."""
    name_words = name_in_words(name)
    return name_words[0].upper() + name_words[1:]


def title_of(titled: Titled) -> str:
    """Return the name used in the manual or, if the manual gives none, the name from the spec as a heading."""
    return titled.printed_name or heading(titled.name)


def printed_name_of(named: HasOtherNames) -> str:
    """Return the name used in the manual, or else the names used in its other editions, or an empty string."""
    return named.printed_name or ", ".join(named.names.values())


def own_names(named: HasOtherNames) -> str:
    """Return the names used in the manual and its other editions: ``Command, it: Comando``."""
    names_with_language = [named.printed_name] if named.printed_name else []
    names_with_language += [f"{language}: {name}" for language, name in named.names.items()]
    return ", ".join(names_with_language)


def full_title(named: HasOtherNames) -> str:
    """Return the title, followed by different names in editions of other languages: ``Command (it: Comando)``."""
    own_title = title_of(named)
    other_names = [f"{language}: {name}" for language, name in named.names.items() if name != own_title]
    return f"{own_title} ({'; '.join(other_names)})" if other_names else own_title


def register_reference(device: Device, name: str) -> Reference:
    """Return a reference to the register with this name."""
    register = device.register(name)
    return Reference(kind="register", name=name, title=title_of(register))


def register_field(device: Device, path: str) -> Reference:
    """Return a reference to a field of a register, whose path is ``register.field``, or to a register."""
    register_name, _, field_name = path.partition(".")
    if not field_name:
        return register_reference(device, register_name)
    register = device.register(register_name)
    field_title = title_of(register.layout.field(field_name))
    return Reference(kind="register", name=path, title=f"{field_title} in {title_of(register)}")


def order_codes_text(codes: str) -> Iterator[Statement]:
    """Yield the order codes that an item applies to. Nothing is yielded for an empty text, which means all of them."""
    if codes:
        yield statement("This applies only to ", CodeText(codes))


def hexadecimal(value: int, digits: int = 2) -> str:
    """Return a number in the hexadecimal notation of manuals, with at least ``digits`` digits: ``3Fh``."""
    return f"{value:0{digits}X}h"


def addresses_text(register: Register) -> str:
    """Return the addresses of a register as text: ``49h`` or ``11h to 17h``."""
    first_address = hexadecimal(register.address)
    if register.last_address == register.address:
        return first_address
    return f"{first_address} to {hexadecimal(register.last_address)}"


def register_at(register: Register) -> str:
    """Return a register with its addresses as text: ``register 49h`` or ``registers 11h to 17h``."""
    noun = "registers" if register.last_address > register.address else "register"
    return f"{noun} {addresses_text(register)}"


def field_at(device: Device, path: str) -> str:
    """Return the address and path of a field: ``register 49h (configuration.code)``."""
    register_name, _, _ = path.partition(".")
    return f"{register_at(device.register(register_name))} ({path})"


def bit_range(highest_bit: int, lowest_bit: int) -> str:
    """Return bit numbers as text: ``5`` or ``5:3``."""
    return f"{highest_bit}" if highest_bit == lowest_bit else f"{highest_bit}:{lowest_bit}"


def bits(highest_bit: int, lowest_bit: int) -> str:
    """Return bits as text: ``bit 5`` or ``bits 5:3``."""
    noun = "bits" if highest_bit > lowest_bit else "bit"
    return f"{noun} {bit_range(highest_bit, lowest_bit)}"


def short_number(number: int) -> str:
    """Return a number below 10 in decimal, and any other number in hexadecimal: ``7``, ``1Fh``."""
    return f"{number}" if number < 10 else f"{number:X}h"


_MEANING_BY_GRADE = {
    "manual": "all pages of the manufacturer's document were read",
    "quoted": "every fact is in the manufacturer's words, and an independent implementation and data from real"
    " hardware agree",
    "corroborated": "every fact is in the manufacturer's words or in two implementations that share no code, and data"
    " from real hardware agrees",
    "corroborated, no hardware frame seen": "every fact is in the manufacturer's words or in two implementations that"
    " share no code",
    "uncorroborated": "the facts have a single source, so do not rely on them",
}
#: All grades, from the highest to the lowest.
GRADES = tuple(_MEANING_BY_GRADE)


def describe_grade(device: Device) -> Statement:
    """Return the grade of the evidence with its meaning, and the values that still come from the template of a spec."""
    grade_name = device.evidence.grade
    grade_text = f"{grade_name} ({_MEANING_BY_GRADE[grade_name]})"
    if device.evidence.placeholders:
        grade_text = f"{grade_text}. {placeholders(device)}"
    return statement(grade_text, label="Evidence")


def grade_below_manual(device: Device) -> Iterator[Statement]:
    """Yield the grade of the evidence with its meaning, or nothing if the whole manual was read."""
    if device.evidence.grade != "manual":
        yield describe_grade(device)


def lowest_grade() -> str:
    """Return the lowest grade, with its meaning."""
    lowest = GRADES[-1]
    return f"{lowest} ({_MEANING_BY_GRADE[lowest]})"


def mark_in_lists(device: Device) -> str:
    """Return the mark of a family in lists that do not show grades: its grade if it is the lowest one, or else ""."""
    grade_name = device.evidence.grade
    return grade_name if grade_name == GRADES[-1] else ""


def titled_in_lists(device: Device) -> str:
    """Return the title of a family for a list that does not show grades, with the grade if it is the lowest one."""
    mark = mark_in_lists(device)
    return f"{device.title} ({mark})" if mark else device.title


def placeholders(device: Device) -> str:
    """Return a sentence with the values that still come from the template, or an empty string if there are none."""
    placeholder_names = device.evidence.placeholders
    if not placeholder_names:
        return ""
    verb = "value is" if len(placeholder_names) == 1 else "values are"
    names_text = ", ".join(placeholder_names)
    return f"{len(placeholder_names)} {verb} still from the template, not from the manufacturer: {names_text}"


def word_for_document(device: Device) -> str:
    """Return the subject of "The manual does not say": ``manual``, or ``spec`` if not all of the manual was read."""
    return "manual" if device.evidence.grade == "manual" else "spec"


def describe_evidence_basis(device: Device) -> Iterator[Statement]:
    """Yield the basis of the grade, and the facts that the spec leaves out.

    The basis consists of the pages read in each document, the implementations and the test vectors. It is omitted for
    the grade ``manual``, which means that the whole manual was read.
    """
    evidence = device.evidence
    if evidence.grade != "manual":
        for document_name, pages in evidence.documents.items():
            yield statement(pages, label=f"Read in {document_name}")
        for label, evidence_names in (("Implementations", evidence.implementations), ("Vectors", evidence.vectors)):
            if evidence_names:
                yield statement(", ".join(evidence_names), label=label)
    for fact in evidence.left_out:
        yield statement(fact, label="Left out")


def differences_from_manual(device: Device) -> Iterator[Statement]:
    """Yield how the family differs from its manual: as a special model, as another edition, and by overlays."""
    specials = [overlay.special for overlay in device.overlays if overlay.special]
    if specials:
        suffix = CodeText(f"/{specials[0]}")
        yield statement(
            "This applies only to encoders whose order code ends in ",
            suffix,
            ". For all others, use ",
            CodeText(device.base),
        )
    if device.edition:
        date = f" of {device.manual.date}" if device.manual.date else ""
        yield statement(
            f"This describes encoders of edition {device.edition} of the manual{date}, as far as they are known. "
            "The edition that the spec transcribes is ",
            CodeText(device.base),
            ". Each difference is given with its source. Unknown parts are omitted",
        )
    for overlay in device.overlays:
        yield statement(
            f"This includes the overlay {overlay.name}, “{overlay.title}”. "
            "Each change is noted inline, with its reason and its source"
        )


def other_editions(device: Device, where: str = "inline") -> Iterator[Statement]:
    """Yield where the differences from other editions are noted, and the command that generates the files for one."""
    if device.editions:
        example = f"codewheel generate --edition {device.name}={device.editions[0].revision}"
        yield statement(
            f"Differences from other editions of the manual are noted {where}. For the files of another edition, use ",
            CodeText(example),
        )


def describe_removals(device: Device) -> Iterator[Statement]:
    """Yield the changes by overlays and editions that removed a part of the spec, so that no note can be next to it.

    A part that only another edition lacks is still in the family itself, which has no base. Changes of wording are
    omitted.
    """
    for erratum in device.errata:
        is_change = bool(erratum.overlay or erratum.edition) and erratum.severity != "wording"
        is_part_absent = bool(device.base or erratum.overlay) or not erratum.affects
        is_removal = erratum.used in (LEFT_OUT, NOT_KNOWN)
        if is_change and is_part_absent and is_removal:
            yield describe_erratum(erratum)


def edition_test(revision: str, test: EditionTest) -> Statement:
    """Return how a register shows that an encoder is older than an edition: the digits, their range, the conclusion."""
    register = Reference("register", test.register, name_in_words(test.register))
    return statement(
        register,
        f": {test.run} is {test.min} to {test.max}. {as_sentence(test.why)} Any other value means that the encoder is "
        f"older than edition {revision}. A value in this range is not conclusive",
        source=test.source,
    )


class Topic(Enum):
    """Subject of a text in a manual. Each value is a pattern for the words that manuals use for it."""

    REPLY_TIME = (
        r"(?i)acknowledg|busy time|latency|turn-?around|(?:reply|response|answer(?:ing)?|processing)[ _-](?:time|delay)"
        r"|\b(?:time|delay|pause|duration)\b.{0,80}\b(?:repl(?:y|ies)|responds?|answers?|start bit)\b"
        r"|\b(?:replies|responds|answers)\b.{0,40}\b(?:within|after at (?:least|most))\b"
    )
    CABLE = r"(?i)\bcables?[ _-](?:length|up to|shorter|below)|length of the cable|(?:maximum|longest) cable"
    TIMEOUT = r"(?i)time-?out|monoflop"
    PAUSE = r"(?i)\bpause|between (?:two|the|consecutive) (?:words|frames|transmissions|clock)"
    SUPPLY = r"(?i)^supply\b(?! source)|(?:supply|operating) voltage|\bsuppl(?:y|ied)\b[^.]*\d ?V\b"
    LEDS = r"(?i)\bleds?\b|light-emitting|indicator light"


#: Place of the note on an interface. All other places are lists.
_PLACE_OF_NOTE = "note on the interface"


def mentions(device: Device, interface: Interface, subject: Topic) -> bool:
    """Return whether a text about times, characteristics, tables, connectors or the interface mentions the subject."""
    return bool(place_of_mention(device, interface, subject))


def place_of_mention(device: Device, interface: Interface, subject: Topic) -> str:
    """Return the part of the spec whose texts mention the subject, such as ``times``, or an empty string."""
    return _place_with_words(subject, tuple(_interface_texts(device, interface)))


def reference_to_mention(device: Device, interface: Interface, subject: Topic) -> str:
    """Return where to read about a subject, such as ``see the times in the manual``, or "" if no text mentions it.

    If the note on the interface mentions it, the note is quoted, because commands do not show this note.
    """
    place = place_of_mention(device, interface, subject)
    if not place:
        return ""
    reference = f"see the {place} in the {word_for_document(device)}"
    if place == _PLACE_OF_NOTE:
        quoted_note = interface.note.rstrip(".")
        return f"{reference}: {quoted_note}"
    return reference


@lru_cache
def _place_with_words(subject: Topic, places_and_texts: tuple[tuple[str, str], ...]) -> str:
    """Return the place of the first text that mentions the subject, or "". Order codes of a family share results."""
    pattern = re.compile(subject.value)
    for place_of_text, text in places_and_texts:
        if pattern.search(text):
            return place_of_text
    return ""


def _interface_texts(device: Device, interface: Interface) -> Iterator[tuple[str, str]]:
    """Yield each text that is not about a frame or a register, with its place in front of it.

    The text of a table consists of its title, its heads, the first cell of each row, and its note.
    """
    for timing in (*interface.timings, *device.timings):
        yield "times", f"{_with_spaces(timing.name)}: {timing.symbol} {timing.meaning}"
    for characteristic in device.characteristics:
        name = _with_spaces(characteristic.name)
        quantities = [value.quantity for value in characteristic.values]
        yield "characteristics", " ".join([name, characteristic.value, *quantities])
    for table in device.tables:
        first_cells = [table_row[0] for table_row in table.rows if table_row]
        table_texts = [table.title, *table.columns, *first_cells, table.note]
        yield "tables", " ".join(table_texts)
    for connector in device.connectors:
        yield "notes on the connectors", connector.note
    yield _PLACE_OF_NOTE, interface.note


def _with_spaces(name: str) -> str:
    return name.replace("_", " ")


def deciding_value(field: Field) -> str:
    """Return the value of a field that can decide the verdict, or "" for a field without such a value.

    For a flag, this is its active level, such as ``1``. For unused bits, it is any undocumented value: ``not 5h``.
    """
    match field.kind:
        case Flag(active_low=is_active_low):
            return "0" if is_active_low else "1"
        case Unused(value=documented_value):
            is_one_bit = field.widest == 1
            return f"{1 - documented_value}" if is_one_bit else f"not {short_number(documented_value)}"
        case _:
            return ""


def conditions_text(values: Iterable[tuple[Field, int]]) -> Statement:
    """Return the field values that together decide a verdict, such as ``error is 0 and mode is 5h (test)``.

    A flag has the value 1 if it is active. An active flag that is active low is written as ``error is 0``.
    """
    phrases = [_condition_parts(field, value) for field, value in values]
    return statement(*join_groups(phrases, " and "))


def _condition_parts(field: Field, value: int) -> tuple[TextPart, ...]:
    """Return a field with its value: ``error is 0`` for a flag, or ``mode is 5h (test)`` for a named value.

    For a flag, ``value`` is 1 if it is active. An active flag that is active low is written as ``error is 0``.
    """
    if isinstance(field.kind, Flag):
        is_active = bool(value)
        # The bit of an active flag is 1, or 0 if the flag is active low. It is inverted while the flag is inactive.
        bit = int(is_active != field.kind.active_low)
        return CodeText(field.name), f" is {bit}"
    value_name = field.value_of(value).name
    return CodeText(field.name), f" is {short_number(value)} (", CodeText(value_name), ")"


def _second_reading_text(counts: TimesRead | None) -> str:
    """Return how many facts agree in two transcriptions of the manual, and why the other facts do not.

    Facts that follow from others are not part of the total. Return an empty string if there is only one transcription.
    """
    if counts is None:
        return ""
    number_of_facts = counts.twice + counts.explained + counts.decided + counts.once
    sentence_parts = [f"Of {group_digits(number_of_facts)} facts, {group_digits(counts.twice)} agree in both readings"]
    if counts.explained:
        differ_verb = "differs for a reason" if counts.explained == 1 else "differ for reasons"
        sentence_parts.append(f"{counts.explained} {differ_verb} given in the errata")
    if counts.decided:
        are_verb = "is" if counts.decided == 1 else "are"
        sentence_parts.append(f"{counts.decided} {are_verb} not in the manual")
    if counts.once:
        were_verb = "was" if counts.once == 1 else "were"
        sentence_parts.append(f"and {counts.once} {were_verb} read only once")
    summary = f"The manual was transcribed twice. {', '.join(sentence_parts)}"
    follow_verb = "follows" if counts.derived == 1 else "follow"
    return f"{summary}. {counts.derived} more {follow_verb} from others" if counts.derived else summary
