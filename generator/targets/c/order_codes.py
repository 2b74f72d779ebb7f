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
from collections.abc import Iterator, Mapping, Sequence, Set

from ...model import CodePart, Device, Spelling, Variant
from ...model.record import dataclass
from ...order_codes.labels import filled, spelled, without_blanks
from .. import TargetError

_ATOM = re.compile(r"(?P<unit>\[[^\]]+\]|\\d|\\.|[A-Za-z0-9-])(?:\{(?P<least>\d+)(?:,(?P<most>\d+))?\}|(?P<maybe>\?))?")
_CLASSES = {
    "[0-9]": "#",
    r"\d": "#",
    "[A-Z]": "@",
    "[A-Za-z]": "@",
    "[A-Z0-9]": "%",
    "[0-9A-Z]": "%",
    "[A-Za-z0-9]": "%",
}
_FITS = {"#": "[0-9]", "@": "[A-Z]", "%": "[A-Z0-9]", "~": "[0-9]?"}
#: An open part with more patterns than this is omitted.
_MOST_PATTERNS = 16
#: Largest number of combinations of listed values and patterns, over all spellings of the labels.
_MOST_COMBINATIONS = 100_000


@dataclass(frozen=True)
class OpenCode:
    """A pattern for labels. ``code`` is the index of its order code, or None if the label is refused."""

    pattern: str
    code: int | None
    unlisted: tuple[str, ...]


@dataclass(frozen=True)
class _Choice:
    """A string for a part of an order code: a listed one, or a pattern if the manual leaves it open.

    ``label`` is the text on the label if that differs.
    """

    text: str
    is_open: bool
    label: str = ""

    @property
    def shown(self) -> str:
        return self.label or self.text


def written_out(expression: str) -> tuple[str, ...]:
    """Return the patterns of an open part, the longest first, or nothing if it cannot be expanded."""
    patterns: list[str] = []
    for alternative in expression.split("|"):
        atoms, at = [], 0
        while at < len(alternative):
            match = _ATOM.match(alternative, at)
            if match is None:
                return ()
            atoms.append(_repetitions(match, match.end() == len(alternative)))
            at = match.end()
        if not all(atoms):
            return ()
        patterns += map("".join, itertools.product(*atoms))
        if len(patterns) > _MOST_PATTERNS:
            return ()
    return tuple(sorted(patterns, key=len, reverse=True))


def _repetitions(match: re.Match[str], is_last: bool) -> tuple[str, ...]:
    """Return one unit with its repetitions, or an empty text if its kind has no mark."""
    unit = match["unit"]
    mark = _CLASSES.get(unit, unit[-1] if len(unit) == 1 or (unit[0] == "\\" and not unit[1].isalnum()) else "")
    fewest = 0 if match["maybe"] else int(match["least"] or 1)
    most_repetitions = 1 if match["maybe"] else int(match["most"] or fewest)
    if not mark or most_repetitions > _MOST_PATTERNS:
        return ()
    if mark == "#" and is_last:
        return ("#" * fewest + "~" * (most_repetitions - fewest),)
    return tuple(mark * count for count in range(most_repetitions, fewest - 1, -1))


def unknown_parts(device: Device) -> tuple[str, ...]:
    """Return the open parts that the table does not contain."""
    return tuple(part.name for part in device.order_code.parts if part.open and not written_out(part.open))


def open_codes(device: Device) -> tuple[OpenCode, ...]:
    """Return the patterns for order codes with open parts and for labels in other spellings. The first match decides.

    A pattern with an open part also matches listed values. If their combination is not an order code, a refused
    pattern comes before it.
    """
    code, codes = device.order_code, _Codes(device)
    spellings = [(code.pattern, [_choices(part) for part in code.parts], True)]
    for spelling in code.also_written:
        own_parts = {value.part for value in spelling.values}
        spelled_parts = {part.name: _spelled_choices(part, spelling) for part in code.parts if part.name in own_parts}
        choices = [spelled_parts.get(part.name) or _choices(part) for part in code.parts]
        thens = written_out(spelling.then) if spelling.then else ("",)
        spellings += [(spelling.pattern + then, choices, False) for then in thens]
    if sum(math.prod(map(len, choices)) for _, choices, _ in spellings) > _MOST_COMBINATIONS:
        raise TargetError(
            f"open parts and other spellings combine to more than {_MOST_COMBINATIONS} patterns of labels, "
            "the maximum of the C target",
            ("order_code",),
        )
    return tuple(row for spelling in spellings for row in _rows(codes, *spelling))


class _Codes:
    """The order codes of a device, found by their listed parts."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self.names = tuple(part.name for part in device.order_code.parts)
        #: Indices of the order codes by the names of some parts and by the texts of these.
        self._indices: dict[tuple[str, ...], dict[tuple[str, ...], list[int]]] = {}

    def first(self, chosen: Mapping[str, _Choice]) -> int | None:
        """Return the first order code with the listed parts, if the other parts may be open there."""
        names = tuple(name for name, choice in chosen.items() if not choice.is_open)
        if names not in self._indices:
            indices_by_texts: dict[tuple[str, ...], list[int]] = defaultdict(list)
            for index, variant in enumerate(self._device.variants):
                indices_by_texts[tuple(variant.parts[name] for name in names)].append(index)
            self._indices[names] = indices_by_texts
        indices = self._indices[names].get(tuple(chosen[name].text for name in names), ())
        parts, variants = self._device.order_code.parts, self._device.variants
        return next((index for index in indices if all(_open_combinations(parts, chosen, variants[index]))), None)


def _rows(codes: _Codes, pattern: str, choices: Sequence[Sequence[_Choice]], is_listed: bool) -> list[OpenCode]:
    """Return the rows of one spelling. For the listed spelling, codes without open parts need no row."""
    combinations = [dict(zip(codes.names, values, strict=True)) for values in itertools.product(*choices)]
    coded = [(chosen, codes.first(chosen)) for chosen in combinations]
    allowed = {tuple(chosen.values()) for chosen, code in coded if code is not None and _open_parts(chosen)}
    patterns = [_open_choices(part_choices) for part_choices in choices]
    rows = []
    for chosen, code in coded:
        unlisted = _open_parts(chosen)
        if code is None:
            needs_row = _is_covered(tuple(chosen.values()), patterns, allowed)
        else:
            needs_row = bool(unlisted) or not is_listed
        if needs_row:
            label_texts = {name: choice.shown for name, choice in chosen.items()}
            rows.append(OpenCode(filled(without_blanks(pattern), label_texts), code, unlisted))
    return sorted(rows, key=lambda row: len(row.unlisted))


def _open_parts(chosen: Mapping[str, _Choice]) -> tuple[str, ...]:
    return tuple(name for name, choice in chosen.items() if choice.is_open)


def _open_choices(choices: Sequence[_Choice]) -> list[_Choice]:
    return [choice for choice in choices if choice.is_open]


def _spelled_choices(part: CodePart, spelling: Spelling) -> list[_Choice]:
    return [_Choice(value, False, text) for text, value in spelled(part, spelling).items()]


def _choices(part: CodePart) -> list[_Choice]:
    listed = [_Choice(value.text, False) for value in part.values]
    patterns = written_out(part.open) if part.open else ()
    return [*listed, *(_Choice(pattern, True) for pattern in patterns)]


def _open_combinations(parts: Sequence[CodePart], chosen: Mapping[str, _Choice], variant: Variant) -> Iterator[bool]:
    for part in parts:
        if chosen[part.name].is_open:
            for other_part, allowed in part.open_only_with.items():
                yield chosen[other_part].is_open or variant.parts[other_part] in allowed


def _is_covered(
    chosen: tuple[_Choice, ...], patterns: Sequence[Sequence[_Choice]], allowed: Set[tuple[_Choice, ...]]
) -> bool:
    """Return True if a label of the codes ``chosen`` would match one of these patterns, which has more open parts.

    ``patterns`` contains the patterns of each part.
    """
    if not allowed:
        return False
    wider = (_wider_choices(choice, part_patterns) for choice, part_patterns in zip(chosen, patterns, strict=True))
    return any(values in allowed for values in itertools.product(*wider))


def _wider_choices(choice: _Choice, patterns: Sequence[_Choice]) -> list[_Choice]:
    """Return a choice, and the patterns that match its text if it is a listed value."""
    if choice.is_open:
        return [choice]
    return [choice, *(pattern for pattern in patterns if _expression(pattern.text).fullmatch(choice.text))]


@functools.cache
def _expression(pattern: str) -> re.Pattern[str]:
    return re.compile("".join(_FITS.get(letter, re.escape(letter)) for letter in pattern), re.IGNORECASE)
