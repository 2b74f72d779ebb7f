"""Rule for texts that name a resolution that the order code no longer has."""

from __future__ import annotations

import re
from collections.abc import Iterator
from decimal import Decimal

from ..problems import DocumentReport
from ..written_parts import WrittenSpec
from .stale_texts import KEYS_OF_TEXTS, is_derived, yield_texts

#: Units of lengths. Texts also have numbers of bits and counts that are not those of an order code.
_UNITS_OF_LENGTHS = ("nm", "µm", "mm")
#: Keys of texts, including those that quote the manual.
_KEYS = KEYS_OF_TEXTS | {"printed", "why", "title", "value"}


def check_resolutions_in_texts(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts that list resolutions of the order code, such as ``50 µm to 2 µm``, do not list other ones.

    A text lists resolutions if at least one of its lengths is one, and all lengths in this unit are in their range.
    """
    if is_derived(report.document):
        return
    for unit, resolutions in _resolutions_by_unit(spec):
        length_in_text = re.compile(rf"(?<![\w.,±/])(?<!± )(\d+(?:\.\d+)?) {unit}(?![\w/])")
        for path, text in yield_texts(spec, _KEYS, report):
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
        is_open = False
        for part in spec.order_code.parts:
            for value in part.values.values():
                if name in value.sets:
                    lengths.add(Decimal(value.sets[name]))
                    is_open |= bool(part.open)
        if len(lengths) > 1 and not is_open:
            yield parameter.unit, lengths
