"""Patterns that stand for many order codes, such as ``E40-{SSI,BISS}-{12,16}``."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from ...model import Device, OrderCode, Variant
from ...order_codes.labels import filled
from ...say.markdown import code

#: Lowest number of order codes that are shown as patterns. Fewer codes are listed one by one.
_FEWEST_FOR_PATTERNS = 12
#: Texts of the parts of an order code, in order.
PartTexts = tuple[str, ...]


def order_codes(device: Device, codes: Sequence[str]) -> str:
    """Return the order codes one by one, or as patterns if there are many."""
    return ", ".join(map(code, codes if len(codes) < _FEWEST_FOR_PATTERNS else patterns(device, codes)))


def patterns(device: Device, codes: Collection[str]) -> list[str]:
    """Return patterns, with differences in braces, that together match exactly these order codes."""
    part_names = [part.name for part in device.order_code.parts]
    variants = [variant for variant in device.variants if variant.code in codes]
    rows = [_texts_of_parts(variant, part_names) for variant in variants]
    return [_pattern(device.order_code, part_names, texts_of_parts) for texts_of_parts in _products(rows)]


def _texts_of_parts(variant: Variant, part_names: Sequence[str]) -> PartTexts:
    return tuple(variant.parts.get(name, "") for name in part_names)


def _pattern(order_code: OrderCode, part_names: Sequence[str], texts_of_parts: Sequence[Sequence[str]]) -> str:
    """Return the order code with the possible texts of each part, in braces if there are several."""
    texts_by_part: dict[str, str] = {}
    for name, texts in zip(part_names, texts_of_parts, strict=True):
        texts_by_part[name] = texts[0] if len(texts) == 1 else f"{{{','.join(texts)}}}"
    return filled(order_code.pattern, texts_by_part)


def _products(rows: Sequence[PartTexts]) -> Iterator[list[list[str]]]:
    """Yield the rows as products of the texts of each part. Rows are split if a part combines with only some others."""
    divisions = [_divided_by_part(rows, index) for index in range(len(rows[0]))]
    splitting_divisions = [groups for groups in divisions if len(groups) > 1]
    if not splitting_divisions:
        yield [list(dict.fromkeys(texts)) for texts in zip(*rows, strict=True)]
        return
    for group in min(splitting_divisions, key=len):
        yield from _products(group)


def _divided_by_part(rows: Sequence[PartTexts], index: int) -> list[list[PartTexts]]:
    """Group the rows by one part, and merge texts of it that combine with the same other parts."""
    other_parts_of_text: dict[str, set[PartTexts]] = {}
    for row in rows:
        other_parts_of_text.setdefault(row[index], set()).add(row[:index] + row[index + 1 :])
    groups: dict[frozenset[PartTexts], list[PartTexts]] = {}
    for row in rows:
        groups.setdefault(frozenset(other_parts_of_text[row[index]]), []).append(row)
    return list(groups.values())
