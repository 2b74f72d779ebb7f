"""Order codes with open parts, and labels in other spellings, as a table of patterns that C can search.

The regular expression of an open part is expanded: ``[0-9]`` becomes the mark ``#``, ``[A-Z]`` becomes ``@``, both
together ``%``, and an optional digit ``~``. Other regular expressions are not supported. The header names the parts of
which it knows only the listed values.
"""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence, Set

from ...model import CodePart, Device, Spelling, Variant
from ...model.record import dataclass
from ...order_codes.patterns import fill_pattern, values_by_spelling, without_blanks
from .. import TargetError

_PATTERN_UNIT = re.compile(
    r"(?P<unit>\[[^\]]+\]|\\d|\\.|[A-Za-z0-9-])(?:\{(?P<least>\d+)(?:,(?P<most>\d+))?\}|(?P<maybe>\?))?"
)
_MARK_BY_CLASS = {
    "[0-9]": "#",
    r"\d": "#",
    "[A-Z]": "@",
    "[A-Za-z]": "@",
    "[A-Z0-9]": "%",
    "[0-9A-Z]": "%",
    "[A-Za-z0-9]": "%",
}
_CLASS_BY_MARK = {"#": "[0-9]", "@": "[A-Z]", "%": "[A-Z0-9]", "~": "[0-9]?"}
#: Characters of a pattern for which a label can show a digit.
_MAY_BE_DIGIT = frozenset("0123456789#%~")
#: An open part with more patterns than this is omitted.
_MOST_PATTERNS = 16
#: Largest number of combinations of listed values and patterns, over all spellings of the labels.
_MOST_COMBINATIONS = 100_000


@dataclass(frozen=True)
class OpenCode:
    """A pattern for labels.

    ``order_code_index`` is the index of its order code, or None if such a label is not an order code.
    ``unlisted`` are the parts for which the label shows a value that the manual does not list.
    """

    pattern: str
    order_code_index: int | None
    unlisted: tuple[str, ...]


@dataclass(frozen=True)
class _Choice:
    """A text for a part of an order code: a value that the manual lists, or a pattern if the manual leaves it open.

    ``label`` is the text on the label if that differs.
    """

    text: str
    is_pattern: bool
    label: str = ""

    @property
    def shown(self) -> str:
        """The text or pattern on the label."""
        return self.label or self.text


def patterns_of_expression(expression: str) -> tuple[str, ...]:
    """Return the patterns that a regular expression of an open part stands for, the longest first.

    ``[A-Z][0-9]{2}|X`` gives ``@##`` and ``X``. The result is empty if the expression is not supported, or if it stands
    for more than ``_MOST_PATTERNS`` patterns.
    """
    patterns: list[str] = []
    for alternative in expression.split("|"):
        # For each unit of the expression, such as ``[0-9]{1,2}``, the patterns that it stands for.
        patterns_of_units: list[tuple[str, ...]] = []
        start = 0
        while start < len(alternative):
            unit_match = _PATTERN_UNIT.match(alternative, start)
            if unit_match is None:
                return ()
            start = unit_match.end()
            patterns_of_units.append(_repeat_unit(unit_match, is_last=start == len(alternative)))
        # A unit without patterns is not supported.
        if not all(patterns_of_units):
            return ()
        patterns += map("".join, itertools.product(*patterns_of_units))
        if len(patterns) > _MOST_PATTERNS:
            return ()
    return tuple(sorted(patterns, key=len, reverse=True))


def _repeat_unit(unit_match: re.Match[str], *, is_last: bool) -> tuple[str, ...]:
    """Return the patterns that a unit of a regular expression stands for, the longest first.

    In patterns, ``#`` is a digit and ``~`` a digit that may be missing. ``[0-9]{1,2}`` gives ``##`` and ``#``, or at
    the end of an expression the single pattern ``#~``. The result is empty if there is no mark for the characters, or
    if they are repeated too often.
    """
    mark = _mark_of_characters(unit_match["unit"])
    if unit_match["maybe"]:
        fewest_repeats, most_repeats = 0, 1
    else:
        fewest_repeats = int(unit_match["least"] or 1)
        most_repeats = int(unit_match["most"] or fewest_repeats)
    # Each number of repeats can be a pattern.
    if not mark or most_repeats > _MOST_PATTERNS:
        return ()
    if mark == "#" and is_last:
        required_digits, optional_digits = "#" * fewest_repeats, "~" * (most_repeats - fewest_repeats)
        return (required_digits + optional_digits,)
    return tuple(mark * repeats for repeats in range(most_repeats, fewest_repeats - 1, -1))


def _mark_of_characters(unit: str) -> str:
    """Return the mark for a class of characters, or the character itself: ``#`` for ``[0-9]``, ``-`` for ``\\-``.

    The result is empty for a class without a mark.
    """
    is_escaped_sign = unit[0] == "\\" and not unit[1:].isalnum()
    stands_for_itself = len(unit) == 1 or is_escaped_sign
    own_character = unit[-1] if stands_for_itself else ""
    return _MARK_BY_CLASS.get(unit, own_character)


def unknown_parts(device: Device) -> tuple[str, ...]:
    """Return the names of the parts for which the header knows only the listed values.

    The manual leaves these parts open, but the table of patterns cannot express which other values they can have.
    """
    return tuple(part.name for part in device.order_code.parts if part.open and not patterns_of_expression(part.open))


def open_codes(device: Device) -> tuple[OpenCode, ...]:
    """Return the patterns for order codes with open parts and for labels in other spellings. The first match decides.

    A pattern with an open part also matches listed values. If their combination is not an order code, a pattern that
    rejects it comes first.

    Raises:
        TargetError: The spellings have more than ``_MOST_COMBINATIONS`` combinations of listed values and patterns.
    """
    order_code = device.order_code
    listed_choices = {part.name: _list_choices(part) for part in order_code.parts}
    spellings = [_build_spelling(order_code.pattern, listed_choices, is_listed=True)]
    for spelling in order_code.also_written:
        choices = {part.name: _choices_of_spelling(part, spelling) for part in order_code.parts}
        endings = patterns_of_expression(spelling.then) if spelling.then else ("",)
        spellings += [_build_spelling(spelling.pattern + ending, choices, is_listed=False) for ending in endings]
    number_of_combinations = sum(spelling.number_of_combinations for spelling in spellings)
    if number_of_combinations > _MOST_COMBINATIONS:
        raise TargetError(
            f"open parts and other spellings combine to more than {_MOST_COMBINATIONS} patterns of labels, "
            "the maximum of the C target",
            ("order_code",),
        )
    codes = _Codes(device)
    return tuple(itertools.chain.from_iterable(_open_codes_of(codes, spelling) for spelling in spellings))


@dataclass(frozen=True)
class _Spelling:
    """A spelling of labels: its pattern, such as ``{family}-{bits}``, and the choices for each part.

    ``is_listed`` is True for the spelling of the order codes in the manual's list.
    """

    pattern: str
    choices: Sequence[Sequence[_Choice]]
    is_listed: bool

    @property
    def number_of_combinations(self) -> int:
        return math.prod(map(len, self.choices))


def _build_spelling(pattern: str, choices: Mapping[str, Sequence[_Choice]], *, is_listed: bool) -> _Spelling:
    """Return a spelling of labels with these choices for each part, by name.

    If a digit may follow a part, an optional digit at the end of the part (``~``) would match it. Such a part has a
    separate pattern for each number of digits instead.
    """
    choices_of_parts = []
    for name, part_choices in choices.items():
        may_precede_digit = _may_precede_digit(name, pattern, choices)
        choices_of_parts.append(_split_optional_digits(part_choices) if may_precede_digit else part_choices)
    return _Spelling(pattern, choices=choices_of_parts, is_listed=is_listed)


def _may_precede_digit(name: str, pattern: str, choices: Mapping[str, Sequence[_Choice]]) -> bool:
    """Return True if a digit may follow this part: one of the pattern, or one of the next part, which may be empty."""
    _, _, after_part = without_blanks(pattern).partition("{" + name + "}")
    if not after_part.startswith("{"):
        return after_part[:1] in _MAY_BE_DIGIT
    next_name = after_part[1:].partition("}")[0]
    return any(not choice.shown or choice.shown[0] in _MAY_BE_DIGIT for choice in choices[next_name])


def _split_optional_digits(choices: Sequence[_Choice]) -> Sequence[_Choice]:
    """Return the choices with a pattern for each number of optional digits: ``##`` and ``#`` for ``#~``."""
    choices_with_fixed_length: list[_Choice] = []
    for choice in choices:
        if not choice.is_pattern:
            choices_with_fixed_length.append(choice)
            continue
        text_without_optional_digits = choice.text.rstrip("~")
        number_of_optional_digits = len(choice.text) - len(text_without_optional_digits)
        for digits in range(number_of_optional_digits, -1, -1):
            pattern = text_without_optional_digits + "#" * digits
            choices_with_fixed_length.append(_Choice(pattern, is_pattern=True))
    return choices_with_fixed_length


class _Codes:
    """The order codes of a device, found by their listed parts."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self.part_names = tuple(part.name for part in device.order_code.parts)
        #: Indices of the order codes by the names of some parts and by their texts.
        self._indices: dict[tuple[str, ...], dict[tuple[str, ...], list[int]]] = {}

    def first_index(self, choice_by_part: Mapping[str, _Choice]) -> int | None:
        """Return the index of the first order code that has the chosen texts, or None.

        For each part of the order code, such as ``bits`` in ``X-{bits}``, a listed text or a pattern for unlisted
        values is chosen. An order code is skipped if its texts for the other parts do not allow unlisted values.
        """
        names_with_text = tuple(name for name, choice in choice_by_part.items() if not choice.is_pattern)
        listed_texts = tuple(choice_by_part[name].text for name in names_with_text)
        indices = self._indices_by_texts(names_with_text).get(listed_texts, ())
        for index in indices:
            variant = self._device.variants[index]
            if _allows_unlisted_values(variant, self._device.order_code.parts, choice_by_part):
                return index
        return None

    def _indices_by_texts(self, part_names: tuple[str, ...]) -> Mapping[tuple[str, ...], list[int]]:
        """Return the indices of all order codes by their texts for these parts, such as ``{("24", "B"): [0, 3]}``.

        The result is computed once for each set of parts.
        """
        if part_names not in self._indices:
            indices_by_texts: dict[tuple[str, ...], list[int]] = defaultdict(list)
            for index, variant in enumerate(self._device.variants):
                texts = tuple(variant.parts[name] for name in part_names)
                indices_by_texts[texts].append(index)
            self._indices[part_names] = indices_by_texts
        return self._indices[part_names]


def _open_codes_of(codes: _Codes, spelling: _Spelling) -> list[OpenCode]:
    """Return the patterns of one spelling. Those with the fewest open parts come first.

    In the spelling of the manual's list, order codes without open parts need no pattern. A combination that is not an
    order code needs a pattern that rejects it only if a pattern with open parts would match it.
    """
    choices_and_indices: list[tuple[Mapping[str, _Choice], int | None]] = []
    for choices in itertools.product(*spelling.choices):
        part_choices = dict(zip(codes.part_names, choices, strict=True))
        choices_and_indices.append((part_choices, codes.first_index(part_choices)))
    # The combinations with open parts that lead to an order code.
    open_combinations: set[tuple[_Choice, ...]] = set()
    for choice_by_part, order_code_index in choices_and_indices:
        if order_code_index is not None and _parts_with_pattern(choice_by_part):
            open_combinations.add(tuple(choice_by_part.values()))
    patterns_of_parts = [_list_patterns(choices) for choices in spelling.choices]
    open_codes_of_spelling = []
    for choice_by_part, order_code_index in choices_and_indices:
        unlisted = _parts_with_pattern(choice_by_part)
        if order_code_index is None:
            combination = tuple(choice_by_part.values())
            is_needed = _is_matched_by_open_pattern(combination, patterns_of_parts, open_combinations)
        else:
            is_needed = bool(unlisted) or not spelling.is_listed
        if is_needed:
            shown_texts = {name: choice.shown for name, choice in choice_by_part.items()}
            label_pattern = fill_pattern(without_blanks(spelling.pattern), shown_texts)
            open_code = OpenCode(pattern=label_pattern, order_code_index=order_code_index, unlisted=unlisted)
            open_codes_of_spelling.append(open_code)
    return sorted(open_codes_of_spelling, key=lambda open_code: len(open_code.unlisted))


def _parts_with_pattern(choice_by_part: Mapping[str, _Choice]) -> tuple[str, ...]:
    """Return the names of the parts for which a pattern is chosen."""
    return tuple(name for name, choice in choice_by_part.items() if choice.is_pattern)


def _list_patterns(choices: Sequence[_Choice]) -> list[_Choice]:
    """Return the choices that are patterns."""
    return [choice for choice in choices if choice.is_pattern]


def _choices_of_spelling(part: CodePart, spelling: Spelling) -> list[_Choice]:
    """Return the choices for a part in another spelling of labels.

    They are the texts that this spelling has for the values of the part, or else the usual choices for the part.
    """
    has_own_texts = any(value.part == part.name for value in spelling.values)
    if has_own_texts:
        texts_on_label = values_by_spelling(part, spelling).items()
        choices = [_Choice(value, is_pattern=False, label=text) for text, value in texts_on_label]
        if choices:
            return choices
    return _list_choices(part)


def _list_choices(part: CodePart) -> list[_Choice]:
    """Return the listed values of a part, and its patterns if it is open."""
    choices = [_Choice(value.text, is_pattern=False) for value in part.values]
    if part.open:
        choices += [_Choice(pattern, is_pattern=True) for pattern in patterns_of_expression(part.open)]
    return choices


def _allows_unlisted_values(variant: Variant, parts: Sequence[CodePart], choice_by_part: Mapping[str, _Choice]) -> bool:
    """Return True if the parts for which a pattern is chosen may have unlisted values in this order code.

    The key ``open_only_with`` of a part lists conditions. Each is met if the other part is open too, or if the order
    code has one of the listed values for it.
    """
    for part in parts:
        if not choice_by_part[part.name].is_pattern:
            continue
        for other_part, allowed_values in part.open_only_with.items():
            has_allowed_value = variant.parts[other_part] in allowed_values
            if not choice_by_part[other_part].is_pattern and not has_allowed_value:
                return False
    return True


def _is_matched_by_open_pattern(
    chosen: tuple[_Choice, ...], patterns: Sequence[Sequence[_Choice]], allowed: Set[tuple[_Choice, ...]]
) -> bool:
    """Return True if a label with the texts ``chosen`` would match a combination that has patterns for more parts.

    ``patterns`` contains the patterns of each part, and ``allowed`` the combinations that lead to an order code. If
    ``A-#`` is allowed, it would match the label ``A-7``.
    """
    if not allowed:
        return False
    matching_choices: list[list[_Choice]] = []
    for choice, part_patterns in zip(chosen, patterns, strict=True):
        matching_choices.append(_matching_choices(choice, part_patterns))
    return any(combination in allowed for combination in itertools.product(*matching_choices))


def _matching_choices(choice: _Choice, patterns: Sequence[_Choice]) -> list[_Choice]:
    """Return a choice, followed by the patterns that match its text if it is a listed value."""
    if choice.is_pattern:
        return [choice]
    return [choice, *(pattern for pattern in patterns if _compile_pattern(pattern.text).fullmatch(choice.text))]


@functools.cache
def _compile_pattern(pattern: str) -> re.Pattern[str]:
    """Return a pattern as a regular expression: ``[0-9][0-9]?`` for ``#~``."""
    expression = "".join(_CLASS_BY_MARK.get(letter, re.escape(letter)) for letter in pattern)
    return re.compile(expression, re.IGNORECASE)
