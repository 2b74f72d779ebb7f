"""Find the family that is most similar to a label that is not an order code, by its name and its pattern."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from ..model import Device
from .labels import UnknownOrderCode, find_code, without_blanks

_LETTERS_AND_DIGITS = re.compile(r"[a-z0-9]+")


class _Reason(NamedTuple):
    """Why a label is not an order code of one family. The family with the most matching characters is the most similar.

    ``is_close`` is true if the label matches all but one part of the order code.
    """

    matching_characters: int
    is_close: bool
    message: str


def family_with_name(devices: Iterable[Device], text: str) -> Device | None:
    """Return the family with the name ``text``, such as ``xy24`` for ``X-Y 24``, or None."""
    label = _without_marks(text)
    for device in devices:
        if _name_without_marks(device) == label:
            return device
    return None


def closest_reason(devices: Sequence[Device], text: str) -> str | None:
    """Return why ``text`` is not an order code, as the message of the family that is most similar to it, or None.

    A family is similar if the text begins with its name, or matches all but one part of its order codes. The text must
    not be an order code of any of the families.
    """
    reasons = list(_reasons(devices, text))
    if not reasons:
        return None
    best = max(reasons, key=lambda reason: (reason.matching_characters, reason.is_close))
    return best.message


def _reasons(devices: Iterable[Device], text: str) -> Iterator[_Reason]:
    """Yield why a text is not an order code, for each family that it names or almost matches."""
    label = _without_marks(text)
    for device in devices:
        name = _name_without_marks(device)
        length_of_name = len(name) if label.startswith(name) else 0
        try:
            find_code(device, text)
        except UnknownOrderCode as error:
            if error.names_mistake or length_of_name:
                length = max(length_of_name, _length_before_parts(device))
                yield _Reason(matching_characters=length, is_close=error.names_mistake, message=str(error))


def _without_marks(text: str) -> str:
    """Return only the letters and digits of a text, in lowercase: ``xy24`` for ``X-Y24``."""
    return "".join(_LETTERS_AND_DIGITS.findall(without_blanks(text).lower()))


def _name_without_marks(device: Device) -> str:
    return device.name.replace("_", "")


def _length_before_parts(device: Device) -> int:
    """Return the number of letters and digits with which all order codes begin: 2 for the pattern ``X-Y-{bits}``."""
    text_before_parts, _, _ = device.order_code.pattern.partition("{")
    return sum(map(str.isalnum, text_before_parts))
