"""Rules for texts that a revision of the spec leaves behind: values and order codes that are no longer right."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import takewhile
from typing import Literal

from ..document import Path
from ..problems import DocumentReport, quoted
from ..schema_files import PROSE
from ..written_codes import WrittenOrderCode, WrittenRegister
from ..written_parts import WrittenErratum, WrittenExample, WrittenSpec
from .parts import by_name
from .walk import leaves_of

_NUMBER = r"(?P<number>0[xX][0-9A-Fa-f]+|[0-9][0-9A-F]*h\b|[0-9]+(?![0-9A-Fa-f]*h\b|[.,]?[0-9A-Za-z]))"
#: The start value of a CRC in words, unless the sentence restricts it.
_START_VALUE = re.compile(rf"\bstart value (?:is |of |to )?{_NUMBER}(?! unless)", re.IGNORECASE)
#: The default of a register in words.
_DEFAULT_IN_TEXT = re.compile(rf"\bdefault (?:value )?(?:is |of ){_NUMBER}(?! unless)", re.IGNORECASE)
#: Words in the name of an example that shows the factory default of a register.
_AS_DELIVERED = frozenset(("default", "defaults", "delivered"))
#: Parts of an order code that a text leaves open, and its tail.
_LEFT_OPEN = re.compile(r"x+|\.{2,3}|…|_+|\*")
_TAIL_OF_LABEL = re.compile(r"(?:[-/]?(?:\.{2,3}|…)|[-/])*")
#: Least number of letters with which an order code begins to be found in a text.
_SHORTEST_START = 3
_NAME_IN_BRACES = re.compile(r"\{(\w+)\}")


#: Numbers by the names of their registers or CRCs. None if the spec does not give one.
_Numbers = Mapping[str, int | None]


def check_start_values(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a start value in the note of a CRC, or in an erratum about it, is the ``init`` of the CRC."""
    for crc in spec.crcs:
        start_value = {crc.part.name: crc.part.init}
        _check_number_in_text((*crc.path, "note"), crc.part.note, _START_VALUE, "init", start_value, report)
    # Reversed, so that the first of several CRCs with one name counts.
    start_values = {crc.part.name: crc.part.init for crc in reversed(spec.crcs)}
    for erratum in spec.errata:
        affected_values = _numbers_affected_by(erratum, "crcs", start_values, "init")
        _check_number_in_text(erratum.place_of("used"), erratum.used, _START_VALUE, "init", affected_values, report)


#: Several bytes in hexadecimal in a text, such as ``32h 10h 01h`` or ``32 10 01``.
_BYTES_IN_TEXT = re.compile(r"\b[0-9A-F]{2}h?(?: [0-9A-F]{2}h?){2,}\b")


def check_bytes_in_errata(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the bytes that an erratum quotes are the bytes of an example that names the erratum.

    Only as many bytes as the example has are compared. If the erratum quotes several frames of this length, one of them
    must be the example.
    """
    errata = by_name(spec.errata)
    for example in spec.examples:
        erratum = errata.get(example.erratum)
        example_bytes = example.bytes.upper().split()
        if erratum is None or not example_bytes:
            continue
        quoted_frames: list[list[str]] = []
        for bytes_text in _BYTES_IN_TEXT.findall(erratum.printed):
            quoted_frames.append(bytes_text.replace("h", "").split())
        frames_of_length = [frame for frame in quoted_frames if len(frame) == len(example_bytes)]
        if frames_of_length and example_bytes not in frames_of_length:
            message = (
                f"the text has the bytes {quoted(' '.join(frames_of_length[0]))}, but the example"
                f" {quoted(example.name)} has {quoted(example.bytes)}; correct one of the two"
            )
            report.add("left-behind", erratum.place_of("printed"), message)


def check_defaults(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a default in the text of an erratum, or shown by an example, is the ``default`` of its register."""
    registers = by_name(spec.registers)
    defaults = {name: register.default for name, register in registers.items()}
    for erratum in spec.errata:
        affected_defaults = _numbers_affected_by(erratum, "registers", defaults, "default")
        _check_number_in_text(
            erratum.place_of("used"), erratum.used, _DEFAULT_IN_TEXT, "default", affected_defaults, report
        )
    for example in spec.examples:
        register = registers.get(example.register)
        if register is not None and _shows_default(example):
            _check_shown_default(example, register, report)


def _shows_default(example: WrittenExample) -> bool:
    """Return True for an example that shows the bytes of a register and has "default" or "delivered" in its name.

    The result is False for an example with an erratum, which explains a difference.
    """
    is_called_default = not _AS_DELIVERED.isdisjoint(example.name.split("_"))
    return example.kind == "register" and bool(example.bytes) and is_called_default and not example.erratum


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
    report.add("left-behind", example.place_of("bytes"), message)


def _numbers_affected_by(erratum: WrittenErratum, section: str, numbers: _Numbers, key: str) -> _Numbers:
    """Return those of ``numbers`` that an erratum affects. They are the values of ``key`` in the parts of a section.

    For the section ``crcs`` and the key ``init``, an erratum affects the number of the CRC ``word`` if it affects
    ``crcs.word`` or ``crcs.word.init``.
    """
    affected_numbers: dict[str, int | None] = {}
    for affected in erratum.affects:
        affected_section, *names = affected.split(".")
        if affected_section != section or not names:
            continue
        part_name, *keys = names
        affects_number = keys in ([], [key])
        if affects_number and part_name in numbers:
            affected_numbers[part_name] = numbers[part_name]
    return affected_numbers


def _check_number_in_text(
    path: Path, text: str, pattern: re.Pattern[str], key: str, numbers: _Numbers, report: DocumentReport
) -> None:
    """Report a text whose number, found with ``pattern``, differs from one of ``numbers``, the values of ``key``.

    Only the first difference is reported. Numbers that are None are not compared.
    """
    match = pattern.search(text)
    if match is None:
        return
    for name, number in numbers.items():
        if number is not None and number not in _possible_numbers(match["number"]):
            message = (
                f"the text says {quoted(match[0])}, but {quoted(key)} of {quoted(name)} is {number:#x}; "
                "correct one of the two"
            )
            report.add("left-behind", path, message)
            return


def _possible_numbers(text: str) -> set[int]:
    """Return the numbers that a text can be: 63 for ``0x3F``, ``3Fh`` and ``63``, but 10 and 2 for ``10``."""
    if text.endswith("h"):
        return {int(text[:-1], 16)}
    if text[:2].lower() == "0x":
        return {int(text, 0)}
    may_be_binary = len(text) > 1 and set(text) <= {"0", "1"}
    return {int(text), int(text, 2)} if may_be_binary else {int(text)}


def _default_in_hexadecimal(register: WrittenRegister) -> str:
    """Return the default of a register as hexadecimal digits in byte order: ``"3412"`` for 0x1234, low byte first.

    The result is empty if there is no default, if there are several bytes without a byte order, or if the default does
    not fit.
    """
    length = register.length
    default = register.default
    if default is None or (length > 1 and not register.byte_order):
        return ""
    byte_order: Literal["little", "big"] = "little" if register.byte_order == "low_byte_first" else "big"
    try:
        return default.to_bytes(length, byte_order, signed=default < 0).hex()
    except OverflowError:
        return ""


def check_order_codes_in_texts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that order codes in tables and other texts contain only values that the spec lists for their parts.

    A text may leave parts open, such as ``TV62-xxx-0050-...``, and may end after any part.
    """
    pattern = spec.order_code.pattern
    starts = _list_starts(spec.order_code)
    # An older edition is derived with its own order codes and with today's texts, so the two need not agree.
    if not starts or report.document.family:
        return
    pieces = _split_pattern(spec.order_code)
    if pattern.startswith("{"):  # The start is a label of the first part, so it is already matched.
        pieces = pieces[1:]
    code_in_text = re.compile(rf"(?<![\w-])({'|'.join(starts)})([\w.…/*-]+)")
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or not _is_text_about_own_codes(path):
            continue
        for start, text_after_start in code_in_text.findall(text):
            unknown_label = _unknown_label(text_after_start.rstrip(".,"), pieces)
            if unknown_label:
                names = f"{quoted(start + text_after_start)} names {quoted(unknown_label)}"
                message = f"{names}, which is not in the order code; correct one of the two"
                report.add("left-behind", path, message)
                break


def _list_starts(order_code: WrittenOrderCode) -> list[str]:
    """Return regular expressions for the beginning of an order code, such as ``TV62``, to find order codes in texts.

    It is the text before the first part of the pattern or, without such text, a label of the first part. If all labels
    begin and end with the same letters, an x may replace the letters between them: ENx10 for ENA10 and ENB10. The list
    is empty if a beginning is too short, or begins with a digit, because it would also match other words.
    """
    start, _, from_first_name = order_code.pattern.partition("{")
    if start:
        return [re.escape(start)] if len(start) >= _SHORTEST_START else []
    first_name, _, _ = from_first_name.partition("}")
    first_part = by_name(order_code.parts).get(first_name)
    labels = list(first_part.values) if first_part is not None else []
    too_general_labels = [label for label in labels if len(label) < _SHORTEST_START or not label[0].isalpha()]
    if not labels or too_general_labels:
        return []
    expressions = {re.escape(label) for label in labels}
    common_start = _common_start(labels)
    reversed_labels = [label[::-1] for label in labels]
    common_end = _common_start(reversed_labels)[::-1]
    if len(labels) > 1 and common_start and common_end:
        expressions.add(f"{re.escape(common_start)}x{re.escape(common_end)}")
    return sorted(expressions, key=len, reverse=True)  # A label comes before another one with which it begins.


def _common_start(texts: Sequence[str]) -> str:
    """Return the letters with which all texts begin."""
    letters_by_position = zip(*texts, strict=False)
    equal_letters = takewhile(lambda letters: len(set(letters)) == 1, letters_by_position)
    return "".join(letters[0] for letters in equal_letters)


#: Keys of texts about the encoder. Titles and reasons of errata may quote another order code.
_TEXT_KEYS = (PROSE | {"used"}) - {"title", "why", "changes", "source", "alignment_source", "output_code_source"}
#: Sections whose texts may name other order codes.
_SECTIONS_WITH_OTHER_CODES = frozenset(("documents", "manual", "order_code", "editions", "evidence"))


def _is_text_about_own_codes(path: Path) -> bool:
    """Return True if the text at a path is about the encoder itself, so that order codes in it must be the spec's."""
    section, key = path[0], path[-1]
    if section in _SECTIONS_WITH_OTHER_CODES:
        return False
    is_cell_of_table = section == "tables" and "rows" in path
    is_value_of_characteristic = (section, key) == ("characteristics", "value")
    return is_cell_of_table or is_value_of_characteristic or key in _TEXT_KEYS


def _split_pattern(order_code: WrittenOrderCode) -> list[tuple[str, re.Pattern[str] | None]]:
    """Return the literal text before each part of the pattern, and the expression that matches a label of the part.

    For ``X-{bits}-{output}`` these are ``("", <bits>)`` and ``("-", <output>)``: the text before the first part is
    empty, because the start of the order code is matched separately. The expression is None if the part is unknown, has
    no labels or an empty label, or is open with an invalid expression. The text is not checked from there on.
    """
    parts = by_name(order_code.parts)
    # Literals are at even indices, names at odd indices.
    literals_and_names = _NAME_IN_BRACES.split(order_code.pattern)
    pieces: list[tuple[str, re.Pattern[str] | None]] = []
    for index in range(1, len(literals_and_names), 2):
        part = parts.get(literals_and_names[index])
        alternatives: list[str] = []
        if part is not None:
            # The longest label first, because a regular expression takes the first alternative that matches.
            alternatives = sorted(map(re.escape, part.values), key=len, reverse=True)
            alternatives += [part.open] if part.open else []
        expression = None
        with suppress(re.error, OverflowError):  # An invalid expression is reported elsewhere.
            has_empty_label = not all(alternatives)
            expression = re.compile("|".join(alternatives)) if alternatives and not has_empty_label else None
        literal_before = "" if index == 1 else literals_and_names[index - 1]
        pieces.append((literal_before, expression))
    return pieces


def _unknown_label(order_code_text: str, pieces: Sequence[tuple[str, re.Pattern[str] | None]]) -> str:
    """Return the first word of a text where a label is expected and none of the part's labels matches.

    ``order_code_text`` is the rest of an order code after its start. The result is empty if all labels match, or if the
    text ends or departs from the pattern before. An open place, such as ``xxx`` or ``...``, matches a part and may also
    replace the next ones: after it, a part whose literal does not follow is skipped.
    """
    is_left_open = False
    for literal, expression in pieces:
        if _TAIL_OF_LABEL.fullmatch(order_code_text) or expression is None:
            return ""
        if not order_code_text.startswith(literal):
            if is_left_open:
                continue
            return ""
        text_from_label = order_code_text.removeprefix(literal)
        match = expression.match(text_from_label) or _LEFT_OPEN.match(text_from_label)
        if match is not None:
            is_left_open = text_from_label[0] in "x.…_*"  # the characters of _LEFT_OPEN
            order_code_text = text_from_label[match.end() :]
        elif literal or not is_left_open:
            return _first_word(text_from_label)
    return ""


def _first_word(text: str) -> str:
    """Return the letters and digits with which a text begins."""
    word = re.match(r"[0-9A-Za-z]+", text)
    return word[0] if word is not None else ""
