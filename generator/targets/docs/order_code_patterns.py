"""Patterns that stand for many order codes, such as ``E40-{SSI,BISS}-{12,16}``."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from ...model import Device
from ...order_codes.labels import filled
from ...say.markdown import code

#: Lowest number of order codes that are shown as patterns. Fewer codes are listed one by one.
MANY = 12
#: Texts of the parts of an order code, in order.
_Parts = tuple[str, ...]


def order_codes(device: Device, codes: Sequence[str]) -> str:
    """Return the order codes one by one, or as patterns if there are many."""
    return ", ".join(map(code, codes if len(codes) < MANY else patterns(device, codes)))


def patterns(device: Device, codes: Collection[str]) -> list[str]:
    """Return patterns, with differences in braces, that together match exactly these order codes."""
    names = [part.name for part in device.order_code.parts]
    rows = [
        tuple(variant.parts.get(name, "") for name in names) for variant in device.variants if variant.code in codes
    ]

    def spelled(box: Sequence[Sequence[str]]) -> str:
        texts = {
            name: texts[0] if len(texts) == 1 else f"{{{','.join(texts)}}}"
            for name, texts in zip(names, box, strict=True)
        }
        return filled(device.order_code.pattern, texts)

    return [spelled(box) for box in _boxes(rows)]


def _boxes(rows: Sequence[_Parts]) -> Iterator[list[list[str]]]:
    """Yield the rows as products of the texts of each part. Rows are split if a part combines with only some others."""
    divided = [row_groups for index in range(len(rows[0])) if len(row_groups := _divided(rows, index)) > 1]
    if not divided:
        yield [list(dict.fromkeys(texts)) for texts in zip(*rows, strict=True)]
        return
    for part in min(divided, key=len):
        yield from _boxes(part)


def _divided(rows: Sequence[_Parts], index: int) -> list[list[_Parts]]:
    """Group the rows by one part, and merge texts of it that combine with the same other parts."""
    partners: dict[str, set[_Parts]] = {}
    for row in rows:
        partners.setdefault(row[index], set()).add(row[:index] + row[index + 1 :])
    rows_by_partners: dict[frozenset[_Parts], list[_Parts]] = {}
    for row in rows:
        rows_by_partners.setdefault(frozenset(partners[row[index]]), []).append(row)
    return list(rows_by_partners.values())
