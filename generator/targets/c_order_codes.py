"""Order codes whose parts the manual leaves open, as a table of patterns that C can look through.

The regular expression of an open part is written out: ``[0-9]`` becomes the mark ``#``, ``[A-Z]`` ``@``, both together ``%``, a digit that may be
missing ``~``. Whatever else a regular expression can say is not, and the header says which parts it knows only as listed.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ..model import CodePart, Device, Variant

_ATOM = re.compile(r"(?P<unit>\[[^\]]+\]|\\d|\\.|[A-Za-z0-9-])(?:\{(?P<least>\d+)(?:,(?P<most>\d+))?\}|(?P<maybe>\?))?")
_CLASSES = {"[0-9]": "#", r"\d": "#", "[A-Z]": "@", "[A-Za-z]": "@", "[A-Z0-9]": "%", "[0-9A-Z]": "%", "[A-Za-z0-9]": "%"}
_FITS = {"#": "[0-9]", "@": "[A-Z]", "%": "[A-Z0-9]", "~": "[0-9]?"}
_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
#: An open part of more patterns than this is left out.
_MOST = 16


@dataclass(frozen=True)
class OpenCode:
    """A pattern for labels; ``code`` is the index of the order code that it stands for, or None where it is refused."""

    pattern: str
    code: int | None
    unlisted: tuple[str, ...]


@dataclass(frozen=True)
class _Choice:
    """What may stand for a part: a listed text, or a pattern that the manual leaves open."""

    text: str
    is_open: bool


def written_out(expression: str) -> tuple[str, ...]:
    """The patterns of an open part, the longest first; empty where they cannot be written out."""
    found: list[str] = []
    for alternative in expression.split("|"):
        atoms, at = [], 0
        while at < len(alternative):
            match = _ATOM.match(alternative, at)
            if match is None:
                return ()
            atoms.append(_repeated(match, match.end() == len(alternative)))
            at = match.end()
        found += ["".join(parts) for parts in itertools.product(*atoms)] if all(atoms) else []
        if not all(atoms) or len(found) > _MOST:
            return ()
    return tuple(sorted(found, key=len, reverse=True))


def _repeated(match: re.Match[str], is_last: bool) -> tuple[str, ...]:
    """One unit with its repetitions; empty where it is of a kind that has no mark."""
    unit = match["unit"]
    mark = _CLASSES.get(unit, unit[-1] if len(unit) == 1 or (unit[0] == "\\" and not unit[1].isalnum()) else "")
    least = 0 if match["maybe"] else int(match["least"] or 1)
    most = 1 if match["maybe"] else int(match["most"] or least)
    if not mark or most > _MOST:
        return ()
    if mark == "#" and is_last:
        return ("#" * least + "~" * (most - least),)
    return tuple(mark * count for count in range(most, least - 1, -1))


def unknown_parts(device: Device) -> tuple[str, ...]:
    """The open parts that the table does not know."""
    return tuple(part.name for part in device.order_code.parts if part.open and not written_out(part.open))


def open_codes(device: Device) -> tuple[OpenCode, ...]:
    """What order codes with open parts look like; the first pattern that fits a label decides.

    A pattern with an open part fits listed values as well. Where those are of no order code in this combination, a pattern that is refused
    comes before it.
    """
    parts = device.order_code.parts
    if not any(part.open for part in parts):
        return ()
    combinations = [dict(zip([part.name for part in parts], chosen)) for chosen in itertools.product(*map(_choices, parts))]
    found = [(chosen, _stands_for(device, chosen)) for chosen in combinations]
    allowed = [chosen for chosen, code in found if code is not None and any(item.is_open for item in chosen.values())]
    rows = []
    for chosen, code in found:
        unlisted = tuple(name for name, item in chosen.items() if item.is_open)
        if (code is not None and unlisted) or (code is None and any(_covers(other, chosen) for other in allowed)):
            rows.append(OpenCode(_BRACES.sub(lambda brace: chosen[brace[1]].text, device.order_code.pattern), code, unlisted))
    return tuple(sorted(rows, key=lambda row: len(row.unlisted)))


def _choices(part: CodePart) -> list[_Choice]:
    return [*(_Choice(value.text, False) for value in part.values), *(_Choice(text, True) for text in written_out(part.open) if part.open)]


def _stands_for(device: Device, chosen: Mapping[str, _Choice]) -> int | None:
    """The first order code that goes with the listed parts, where the open ones may be open."""
    for index, variant in enumerate(device.variants):
        if all(item.is_open or variant.parts[name] == item.text for name, item in chosen.items()) and all(_open_here(device.order_code.parts, chosen, variant)):
            return index
    return None


def _open_here(parts: Sequence[CodePart], chosen: Mapping[str, _Choice], variant: Variant) -> Iterator[bool]:
    for part in parts:
        if chosen[part.name].is_open:
            yield from (chosen[other].is_open or variant.parts[other] in allowed for other, allowed in part.open_only_with.items())


def _covers(pattern: Mapping[str, _Choice], chosen: Mapping[str, _Choice]) -> bool:
    """Whether a label of the codes ``chosen`` would fit ``pattern``, which has more open parts."""
    for name, item in pattern.items():
        other = chosen[name]
        if item == other:
            continue
        expression = "".join(_FITS.get(letter, re.escape(letter)) for letter in item.text)
        if not item.is_open or other.is_open or re.fullmatch(expression, other.text, re.IGNORECASE) is None:
            return False
    return True
