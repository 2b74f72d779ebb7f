"""Order codes: the list of them, and what the text on a label means."""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from .model import CodePart, Device, OrderCode, Variant

_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_SPECIAL = re.compile(r"/S[A-Za-z0-9]+$")


class UnknownOrderCode(ValueError):
    """No such order code; the message says which part is wrong and what would be right."""


@dataclass(frozen=True, slots=True)
class Match:
    """An order code as read from a label.

    ``variant`` is the enumerated code that it stands for. ``unlisted`` names the parts whose value the manual leaves open, ``tail`` is what
    followed the code on the label, ``special`` is set for codes that end in /Sxxx.
    """

    variant: Variant
    unlisted: tuple[str, ...]
    tail: str
    special: bool


def combinations(order_code: OrderCode) -> Iterator[tuple[str, Mapping[str, str], str, Mapping[str, int]]]:
    """Every enumerated code: its text, the value of each part, the interface, and the parameters that the parts set."""
    for values in itertools.product(*(part.values for part in order_code.parts)):
        chosen = {part.name: value for part, value in zip(order_code.parts, values)}
        texts = {name: value.text for name, value in chosen.items()}
        if any(texts.get(name) not in allowed for value in values for name, allowed in value.only_with.items()):
            continue
        sets = {name: number for value in values for name, number in value.sets.items()}
        interface = next((value.interface for value in values if value.interface), "")
        yield _BRACES.sub(lambda brace: texts[brace[1]], order_code.pattern), texts, interface, sets


def find(device: Device, text: str) -> Match:
    """What the label ``text`` means for this family; a tail after ``-`` and ``/Sxxx`` are accepted.

    Raises:
        UnknownOrderCode: A part is missing or wrong.
    """
    code = text.strip().upper()
    # A part of the code itself may look like /Sxxx; only what follows the code is taken for that.
    match = re.fullmatch(_regex(device.order_code, {}) + r"(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?", code, re.IGNORECASE)
    if match is None:
        raise UnknownOrderCode(_explain(device, _SPECIAL.sub("", code)))
    return _resolve(device, {part.name: match[part.name] for part in device.order_code.parts}, match["tail_"] or "", match["special_"] is not None, code)


def _resolve(device: Device, parts: Mapping[str, str], tail: str, special: bool, code: str) -> Match:
    listed = {part.name: _listed(part, parts[part.name]) for part in device.order_code.parts}
    unlisted = [name for name, known in listed.items() if known is None]
    # What is not listed is taken as the first listed value that goes with the rest.
    fits = (item for item in device.variants if all(known in (None, item.parts[name]) for name, known in listed.items()))
    variant = next((item for item in fits if _open_here(device, unlisted, item)), None)
    if variant is None:
        raise UnknownOrderCode(f"'{code}' combines parts that do not go together; the nearest are {_nearest(device, code)}")
    if unlisted:
        shown = {name: known or parts[name] for name, known in listed.items()}
        printed = _BRACES.sub(lambda brace: shown[brace[1]], device.order_code.pattern)
        variant = Variant(printed, MappingProxyType(shown), variant.interface, variant.parameters)
    return Match(variant, tuple(unlisted), tail, special)


def _listed(part: CodePart, text: str) -> str | None:
    return next((value.text for value in part.values if value.text.upper() == text.upper()), None)


def _open_here(device: Device, unlisted: Sequence[str], variant: Variant) -> bool:
    """Whether every unlisted part may be open together with the listed ones."""
    parts = [part for part in device.order_code.parts if part.name in unlisted]
    return all(other in unlisted or variant.parts[other] in allowed for part in parts for other, allowed in part.open_only_with.items())


def _regex(order_code: OrderCode, instead: Mapping[str, str]) -> str:
    """A regular expression for the whole code; ``instead`` replaces the expression of single parts."""
    parts = {part.name: instead.get(part.name) or _alternatives(part) for part in order_code.parts}
    pieces = _BRACES.split(order_code.pattern)
    return "".join(f"(?P<{piece}>{parts[piece]})" if index % 2 else re.escape(piece) for index, piece in enumerate(pieces))


def _alternatives(part: CodePart) -> str:
    texts = sorted((value.text for value in part.values), key=len, reverse=True)
    return "|".join([*map(re.escape, texts), *([part.open] if part.open else [])])


def _explain(device: Device, code: str) -> str:
    """What is wrong with ``code``: the one part that is not listed, or else the nearest codes."""
    for part in device.order_code.parts:
        match = re.fullmatch(_regex(device.order_code, {part.name: "[A-Z0-9]*"}) + "(-.*)?", code, re.IGNORECASE)
        if match:
            valid = ", ".join(value.text for value in part.values)
            wrong = f"has no {part.name}" if not match[part.name] else f"has {part.name} '{match[part.name]}'"
            return f"'{code}' {wrong}; valid are {valid}. The nearest codes are {_nearest(device, code)}"
    return f"'{code}' is no order code of {device.name.upper()}; the nearest are {_nearest(device, code)}"


def _nearest(device: Device, code: str) -> str:
    return ", ".join(nearest_codes([device], code))


def nearest_codes(devices: list[Device], code: str) -> list[str]:
    """The three enumerated codes that look most like ``code``."""
    codes = [variant.code for device in devices for variant in device.variants]
    head = code.split("-")[0] if "-" in code and code not in codes else code
    return difflib.get_close_matches(head.upper(), codes, n=3, cutoff=0.0)
