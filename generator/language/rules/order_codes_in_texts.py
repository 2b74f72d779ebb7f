"""Rules for order codes, their labels and resolutions in texts and tables, which must be in the order code."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from decimal import Decimal
from itertools import takewhile
from typing import NamedTuple

from ..document import Path
from ..keys_of_order_codes import WrittenCodePart, WrittenOrderCode
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted
from ..schemas import PROSE
from .parts import by_name
from .walk import KEYS_OF_TEXTS, is_derived, leaves_of, texts_about_encoder

#: Parts of an order code that a text leaves open, such as ``xxx`` or ``...``, and its tail.
_LEFT_OPEN = re.compile(r"x+|\.{2,3}|…|_+|\*")
_TAIL_OF_LABEL = re.compile(r"(?:[-/]?(?:\.{2,3}|…)|[-/])*")
#: Least number of letters with which an order code begins to be found in a text.
_SHORTEST_START = 3
_NAME_IN_BRACES = re.compile(r"\{(\w+)\}")


def check_order_codes_in_texts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that order codes in tables and other texts contain only values that the spec lists for their parts.

    A text may leave parts open, such as ``TV62-xxx-0050-...``, and may end after any part.
    """
    pattern = spec.order_code.pattern
    start_expressions = _expressions_for_start(spec.order_code)
    # An older edition is derived with its own order codes and with today's texts, so the two need not agree.
    if not start_expressions or report.document.family:
        return
    pattern_pieces = _pieces_of_pattern(spec.order_code)
    if pattern.startswith("{"):  # The start is a label of the first part, so it is already matched.
        pattern_pieces = pattern_pieces[1:]
    any_start = "|".join(start_expressions)
    code_in_text = re.compile(rf"(?<![\w-])({any_start})([\w.…/*-]+)")  # ``TV62`` and ``-xxx-0050-...``
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or not _is_text_about_own_codes(path):
            continue
        for start, text_after_start in code_in_text.findall(text):
            unknown_label = _unknown_label(text_after_start.rstrip(".,"), pattern_pieces)
            if unknown_label:
                problem = f"{quoted(start + text_after_start)} names {quoted(unknown_label)}"
                message = f"{problem}, which is not in the order code; correct one of the two"
                report.add("left-behind", path, message)
                break


def _expressions_for_start(order_code: WrittenOrderCode) -> list[str]:
    """Return regular expressions for the beginning of an order code, such as ``TV62``, to find order codes in texts.

    It is the text before the first part of the pattern or, without such text, a label of the first part. The list is
    empty if a beginning is too short, or begins with a digit, because it would also match other words.
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
    expressions.update(_start_with_open_letters(labels))
    return sorted(expressions, key=len, reverse=True)  # A label comes before another one with which it begins.


def _start_with_open_letters(labels: Sequence[str]) -> Iterator[str]:
    """Yield the expression for a text that leaves the letters open in which labels differ: ENx10 for ENA10 and ENB10.

    Nothing is yielded unless all labels begin and end with the same letters.
    """
    common_start = _common_start(labels)
    reversed_labels = [label[::-1] for label in labels]
    common_end = _common_start(reversed_labels)[::-1]
    if len(labels) > 1 and common_start and common_end:
        yield f"{re.escape(common_start)}x{re.escape(common_end)}"


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


def _pieces_of_pattern(order_code: WrittenOrderCode) -> list[_PatternPiece]:
    """Return the literal text before each part of the pattern, and the expression that matches a label of the part.

    For ``X-{bits}-{output}`` these are ``("", <bits>)`` and ``("-", <output>)``: the text before the first part is
    empty, because the start of the order code is matched separately.
    """
    part_by_name = by_name(order_code.parts)
    # In turn, beginning and ending with literal text: "X-", "bits", "-", "output" and "".
    literals_and_names = _NAME_IN_BRACES.split(order_code.pattern)
    names_of_parts = literals_and_names[1::2]
    literals_before_parts = ("", *literals_and_names[2:-1:2])
    pieces: list[_PatternPiece] = []
    for literal_before, part_name in zip(literals_before_parts, names_of_parts, strict=True):
        pieces.append(_PatternPiece(literal_before, _label_expression(part_by_name.get(part_name))))
    return pieces


def _label_expression(part: WrittenCodePart | None) -> re.Pattern[str] | None:
    """Return an expression that matches a label of a part of the order code, or None if no label can be recognized.

    That is the case if the part is unknown, has no labels or an empty label, or is open with an invalid expression.
    """
    if part is None:
        return None
    # The longest label first, because a regular expression takes the first alternative that matches.
    alternatives = sorted(map(re.escape, part.values), key=len, reverse=True)
    if part.open:
        alternatives.append(part.open)
    has_empty_label = "" in alternatives
    if not alternatives or has_empty_label:
        return None
    try:
        return re.compile("|".join(alternatives))
    except (re.error, OverflowError):  # An invalid expression is reported elsewhere.
        return None


def _unknown_label(order_code_text: str, pattern_pieces: Sequence[_PatternPiece]) -> str:
    """Return the first word of a text where a label is expected and none of the part's labels matches.

    ``order_code_text`` is the remainder of an order code after its start. The result is empty if all labels match, or
    if the text ends or departs from the pattern before, or reaches a part without an expression. An open place, such as
    ``xxx`` or ``...``, matches a part and may also replace the next ones: after it, a part whose literal does not
    follow is skipped.
    """
    remaining_text = order_code_text
    is_after_open_place = False
    for literal, label_expression in pattern_pieces:
        is_end_of_code = _TAIL_OF_LABEL.fullmatch(remaining_text) is not None
        if is_end_of_code or label_expression is None:
            return ""
        if not remaining_text.startswith(literal):
            if is_after_open_place:
                continue  # The open place also replaces this part.
            return ""  # The text departs from the pattern.
        text_from_label = remaining_text.removeprefix(literal)
        match = label_expression.match(text_from_label) or _LEFT_OPEN.match(text_from_label)
        if match is not None:
            is_after_open_place = text_from_label[0] in "x.…_*"  # the characters of _LEFT_OPEN
            remaining_text = text_from_label[match.end() :]
        elif literal or not is_after_open_place:  # Without a literal, the open place may replace this part, too.
            return _first_word(text_from_label)
    return ""


def _first_word(text: str) -> str:
    """Return the letters and digits with which a text begins."""
    word = re.match(r"[0-9A-Za-z]+", text)
    return word[0] if word is not None else ""


#: Units of lengths. Texts also have numbers of bits and counts that are not those of an order code.
_UNITS_OF_LENGTHS = ("nm", "µm", "mm")
#: Keys of texts, including those that quote the manual.
_KEYS_OF_COMPARED_TEXTS = KEYS_OF_TEXTS | {"printed", "why", "title", "value"}


def check_resolutions_in_texts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts that list resolutions of the order code, such as ``50 µm to 2 µm``, do not list other ones.

    A text lists resolutions if at least one of its lengths is one, and all lengths in this unit are in their range.
    """
    if is_derived(report.document):
        return
    for unit, resolutions in _resolutions_by_unit(spec):
        length_in_text = re.compile(rf"(?<![\w.,±/])(?<!± )(\d+(?:\.\d+)?) {unit}(?![\w/])")
        for path, text in texts_about_encoder(spec, _KEYS_OF_COMPARED_TEXTS, report):
            lengths = [Decimal(number) for number in length_in_text.findall(text)]
            other_lengths = [length for length in lengths if length not in resolutions]
            lists_resolutions = len(other_lengths) < len(lengths)
            are_in_range = all(min(resolutions) <= length <= max(resolutions) for length in lengths)
            if other_lengths and lists_resolutions and are_in_range:
                length_text = f"{other_lengths[0]} {unit}"
                message = f"the text lists {length_text}, but no order code has it; correct one of the two"
                report.add("left-behind", path, message, cause=length_text)


def _resolutions_by_unit(spec: WrittenSpec) -> Iterator[tuple[str, set[Decimal]]]:
    """Yield the lengths that each parameter can have, with their unit, if the order code lists at least two."""
    for name, parameter in spec.parameters.items():
        if parameter.unit not in _UNITS_OF_LENGTHS:
            continue
        lengths: set[Decimal] = set()
        is_any_part_open = False
        for part in spec.order_code.parts:
            for value in part.values.values():
                if name in value.sets:
                    lengths.add(Decimal(value.sets[name]))
                    is_any_part_open |= bool(part.open)
        if len(lengths) > 1 and not is_any_part_open:
            yield parameter.unit, lengths


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
            report.add("left-behind", erratum.path_of("used"), message, cause=label)


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


_WORD_WITH_DIGITS = re.compile(r"\b[A-Za-z]+\d\w*")
#: Shortest start of an order code of which a word with the same letters in another order is a mistake.
_SHORTEST_FIXED_START = 5


def check_swapped_letters(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text contains the beginning of an order code with swapped characters, such as ABC12 for ABC21.

    The beginning is the text before the first part of the order code. It is not compared if it is short.
    """
    text_before_parts, _, _ = spec.order_code.pattern.partition("{")
    fixed_start = text_before_parts.strip("-/ ")
    if len(fixed_start) < _SHORTEST_FIXED_START:
        return
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or path[-1] == "printed" or path[0] in ("documents", "evidence"):
            continue
        other_words = [word for word in _WORD_WITH_DIGITS.findall(text) if word != fixed_start]
        swapped_words = [word for word in other_words if sorted(word) == sorted(fixed_start)]
        if swapped_words:
            problem = (
                f"{quoted(swapped_words[0])} has the characters of {quoted(fixed_start)}, which begins order codes"
            )
            report.add("misspelt-name", path, f"{problem}; correct it")


def check_order_codes_in_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the codes in table columns with the heading "order code" begin with the fixed text of order codes.

    Also check that each number between two hyphens in them is a label of a part of the order code, or one that an open
    part accepts.
    """
    fixed_start, _, _ = spec.order_code.pattern.partition("{")  # The text before the first part.
    if not fixed_start.strip("-/ "):
        return
    for table in spec.tables:
        headings = [heading.casefold() for heading in table.part.columns]
        if "order code" not in headings:
            continue
        column_index = headings.index("order code")
        for row_index, row in enumerate(table.part.rows):
            cell = row[column_index] if column_index < len(row) else ""
            codes = re.findall(r"\S+-\.\.\.", cell)  # Such as ``TV62-0050-...``.
            problems = [_problem_of_code(code, fixed_start, spec) for code in codes]
            first_problem = next(filter(None, problems), "")
            path = (*table.path, "rows", row_index, column_index)
            is_reported = path in report.faults()  # As an order code in a text.
            if first_problem and not is_reported:
                report.add("table-arithmetic", path, f"{first_problem}; correct it")


def _problem_of_code(code: str, fixed_start: str, spec: WrittenSpec) -> str:
    """Return the reason that a text cannot be an order code, or an empty string if it can.

    ``fixed_start`` is the text with which all order codes begin.
    """
    if not code.startswith(fixed_start):
        return f"{quoted(code)} does not begin with {quoted(fixed_start)}, as order codes do"
    for word in code.removeprefix(fixed_start).split("-"):
        is_label = any(_accepts_label(part, word) for part in spec.order_code.parts)
        if word.isdecimal() and not is_label:
            return f"{quoted(word)} is not in the order code"
    return ""


def _accepts_label(part: WrittenCodePart, label: str) -> bool:
    """Return True if a part of the order code lists a label or, if it is open, its expression matches the label."""
    return label in part.values or bool(part.open and re.fullmatch(part.open, label))
