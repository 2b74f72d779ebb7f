"""Find the family that a label which is not an order code is closest to, by its name and its pattern."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from ..model import Device
from .labels import UnknownOrderCode, find_code, without_blanks

_LETTERS_AND_DIGITS = re.compile(r"[a-z0-9]+")


class _Reason(NamedTuple):
    """The message of a family about a label. The greatest one is the best: it is of the family most like the label."""

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
    """Return why ``text`` is not an order code, by the family whose name or pattern has the longest beginning in it.

    Without the name, the message of a family counts only if it is ``close``. Return None if there is no such family.
    The text must be an order code of none of them.
    """
    reasons = list(_reasons(devices, text))
    if not reasons:
        return None
    best = max(reasons, key=lambda reason: (reason.matching_characters, reason.is_close))
    return best.message


def _reasons(devices: Iterable[Device], text: str) -> Iterator[_Reason]:
    """Yield the message of each family that the text is close to, or that it names."""
    label = _without_marks(text)
    for device in devices:
        name = _name_without_marks(device)
        length_of_name = len(name) if label.startswith(name) else 0
        try:
            find_code(device, text)
        except UnknownOrderCode as error:
            if error.close or length_of_name:
                length = max(length_of_name, _length_before_parts(device))
                yield _Reason(matching_characters=length, is_close=error.close, message=str(error))


def _without_marks(text: str) -> str:
    """Return the letters and digits of a text: ``xy24`` of ``X-Y24``."""
    return "".join(_LETTERS_AND_DIGITS.findall(without_blanks(text).lower()))


def _name_without_marks(device: Device) -> str:
    return device.name.replace("_", "")


def _length_before_parts(device: Device) -> int:
    """Return the number of letters and digits in front of the first part of the pattern: 2 for ``X-Y-{bits}``."""
    text_before_parts, _, _ = device.order_code.pattern.partition("{")
    return sum(map(str.isalnum, text_before_parts))
