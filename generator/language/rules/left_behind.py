"""Rules for texts that a revision of the spec leaves behind: values and order codes that are no longer right."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import takewhile
from typing import Literal, NamedTuple

from ..document import Path
from ..problems import DocumentReport, quoted
from ..schema_files import PROSE
from ..written_codes import WrittenOrderCode, WrittenRegister
from ..written_parts import WrittenErratum, WrittenExample, WrittenSpec
from .parts import by_name
from .walk import leaves_of

#: A number such as ``0x3F``, ``3Fh`` or ``63``.
_NUMBER = r"(?P<number>0[xX][0-9A-Fa-f]+|[0-9][0-9A-F]*h\b|[0-9]+(?![0-9A-Fa-f]*h\b|[.,]?[0-9A-Za-z]))"
#: The start value of a CRC in words, unless the sentence restricts it.
_START_VALUE = re.compile(rf"\bstart value (?:is |of |to )?{_NUMBER}(?! unless)", re.IGNORECASE)
#: The default of a register in words.
_DEFAULT_IN_TEXT = re.compile(rf"\bdefault (?:value )?(?:is |of ){_NUMBER}(?! unless)", re.IGNORECASE)
#: Words in the name of an example that shows the factory default of a register.
_AS_DELIVERED = frozenset(("default", "defaults", "delivered"))
#: Parts of an order code that a text leaves open, such as ``xxx`` or ``...``, and its tail.
_LEFT_OPEN = re.compile(r"x+|\.{2,3}|…|_+|\*")
_TAIL_OF_LABEL = re.compile(r"(?:[-/]?(?:\.{2,3}|…)|[-/])*")
#: Least number of letters with which an order code begins to be found in a text.
_SHORTEST_START = 3
_NAME_IN_BRACES = re.compile(r"\{(\w+)\}")


class _KeyWithText(NamedTuple):
    """A key of a part of a spec that contains a number, and a pattern that finds this number in a text."""

    section: str
    key: str
    pattern: re.Pattern[str]


_INIT_OF_CRC = _KeyWithText("crcs", "init", _START_VALUE)
_DEFAULT_OF_REGISTER = _KeyWithText("registers", "default", _DEFAULT_IN_TEXT)
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
        _check_number_in_erratum(erratum, _DEFAULT_OF_REGISTER, defaults, report)
    for example in spec.examples:
        register = registers.get(example.register)
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
    report.add("left-behind", example.place_of("bytes"), message)


def _check_number_in_erratum(
    erratum: WrittenErratum, key: _KeyWithText, numbers: _NumberByName, report: DocumentReport
) -> None:
    """Check that the number in ``used``, an erratum's text about what applies, is that of the part that it affects.

    ``numbers`` contains the number under the key for each part of the section, by name.
    """
    affected_numbers = _numbers_affected_by(erratum, key, numbers)
    _check_number_in_text(erratum.used, key, affected_numbers, path=erratum.place_of("used"), report=report)


def _numbers_affected_by(erratum: WrittenErratum, key: _KeyWithText, numbers: _NumberByName) -> _NumberByName:
    """Return those of ``numbers`` that an erratum affects. They are the values of a key in the parts of a section.

    For the section ``crcs`` and the key ``init``, an erratum affects the number of the CRC ``word`` if it affects
    ``crcs.word`` or ``crcs.word.init``.
    """
    affected_numbers: dict[str, int | None] = {}
    for affected_path in erratum.affects:
        section, *names = affected_path.split(".")
        if section != key.section or not names:
            continue
        part_name, *keys = names
        affects_number = keys in ([], [key.key])
        if affects_number and part_name in numbers:
            affected_numbers[part_name] = numbers[part_name]
    return affected_numbers


def _check_number_in_text(
    text: str, key: _KeyWithText, numbers: _NumberByName, *, path: Path, report: DocumentReport
) -> None:
    """Report a text whose number, found with the pattern of ``key``, differs from one of ``numbers``.

    Only the first difference is reported. Numbers that are None are not compared.
    """
    match = key.pattern.search(text)
    if match is None:
        return
    possible_numbers = _possible_numbers(match["number"])
    for name, number in numbers.items():
        if number is not None and number not in possible_numbers:
            message = (
                f"the text says {quoted(match[0])}, but {quoted(key.key)} of {quoted(name)} is {number:#x}; "
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
    any_start = "|".join(starts)
    code_in_text = re.compile(rf"(?<![\w-])({any_start})([\w.…/*-]+)")  # ``TV62`` and ``-xxx-0050-...``
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or not _is_text_about_own_codes(path):
            continue
        for start, text_after_start in code_in_text.findall(text):
            unknown_label = _unknown_label(text_after_start.rstrip(".,"), pieces)
            if unknown_label:
                problem = f"{quoted(start + text_after_start)} names {quoted(unknown_label)}"
                message = f"{problem}, which is not in the order code; correct one of the two"
                report.add("left-behind", path, message)
                break


def _list_starts(order_code: WrittenOrderCode) -> list[str]:
    """Return regular expressions for the beginning of an order code, such as ``TV62``, to find order codes in texts.

    It is the text before the first part of the pattern or, without such text, a label of the first part. If all labels
    begin and end with the same letters, an x may replace the letters between them: ENx10 for ENA10 and ENB10. The list
    is empty if a beginning is too short, or begins with a digit, because it would also match other words.
    """
    # Of the pattern ``X-{bits}{output}``, these are ``X-`` and ``bits}{output}``.
    fixed_start, _, text_from_first_name = order_code.pattern.partition("{")
    if fixed_start:
        return [re.escape(fixed_start)] if len(fixed_start) >= _SHORTEST_START else []
    name_of_first_part, _, _ = text_from_first_name.partition("}")
    first_part = by_name(order_code.parts).get(name_of_first_part)
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


class _PatternPiece(NamedTuple):
    """The literal text before a part in the pattern of the order code, and an expression that matches its labels."""

    literal: str
    label_expression: re.Pattern[str] | None


def _split_pattern(order_code: WrittenOrderCode) -> list[_PatternPiece]:
    """Return the literal text before each part of the pattern, and the expression that matches a label of the part.

    For ``X-{bits}-{output}`` these are ``("", <bits>)`` and ``("-", <output>)``: the text before the first part is
    empty, because the start of the order code is matched separately. The expression is None if the part is unknown, has
    no labels or an empty label, or is open with an invalid expression. The text is not checked from there on.
    """
    parts = by_name(order_code.parts)
    # Literals are at even indices, names at odd indices.
    literals_and_names = _NAME_IN_BRACES.split(order_code.pattern)
    pieces: list[_PatternPiece] = []
    for index in range(1, len(literals_and_names), 2):
        part = parts.get(literals_and_names[index])
        alternatives: list[str] = []
        if part is not None:
            # The longest label first, because a regular expression takes the first alternative that matches.
            alternatives = sorted(map(re.escape, part.values), key=len, reverse=True)
            alternatives += [part.open] if part.open else []
        expression = None
        has_empty_label = not all(alternatives)
        if alternatives and not has_empty_label:
            with suppress(re.error, OverflowError):  # An invalid expression is reported elsewhere.
                expression = re.compile("|".join(alternatives))
        literal_before = "" if index == 1 else literals_and_names[index - 1]
        pieces.append(_PatternPiece(literal_before, expression))
    return pieces


def _unknown_label(order_code_text: str, pieces: Sequence[_PatternPiece]) -> str:
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
