"""Find the family that a label which is not an order code is closest to, by its name and its pattern."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate
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
    possible_names = list(_possible_names(text))
    for device in devices:
        # The last possible name is the whole text.
        if _name_without_marks(device) in possible_names[-1:]:
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
    possible_names = set(_possible_names(text))
    for device in devices:
        name = _name_without_marks(device)
        length_of_name = len(name) if name in possible_names else 0
        try:
            find_code(device, text)
        except UnknownOrderCode as error:
            if error.close or length_of_name:
                length = max(length_of_name, _length_before_parts(device))
                yield _Reason(matching_characters=length, is_close=error.close, message=str(error))


def _possible_names(text: str) -> Iterator[str]:
    """Yield the beginnings of a text up to each mark, without marks: ``x`` and ``xy24`` of ``X-Y24``."""
    label = without_blanks(text).lower()
    return accumulate(_LETTERS_AND_DIGITS.findall(label))


def _name_without_marks(device: Device) -> str:
    return device.name.replace("_", "")


def _length_before_parts(device: Device) -> int:
    """Return the number of letters and digits in front of the first part of the pattern: 2 for ``X-Y-{bits}``."""
    text_before_parts, _, _ = device.order_code.pattern.partition("{")
    return sum(map(str.isalnum, text_before_parts))
