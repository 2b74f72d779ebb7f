"""Statements about an order code: its parts and other spellings on labels."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import CodePart, Device, Spelling
from .erratum import errata, erratum
from .text import Code, Part, Said, parted, said, told


def order_code(device: Device) -> Iterator[Said]:
    """Yield all statements about it in order, for running text."""
    code = device.order_code
    yield said(Code(code.pattern), label="Order codes", source=code.source)
    for item in code.parts:
        yield part(item)
        yield from open_values(item)
    yield from map(spelling, code.also_written)
    yield from told(code.note)
    yield from told(code.special)
    yield from map(erratum, errata(device, "order_code", "parameters"))


def part(item: CodePart) -> Said:
    """Return the meaning and the values of a part."""
    values: list[tuple[Part, ...]] = [
        (Code(value.text), f" = {value.meaning}") if value.meaning else (Code(value.text),) for value in item.values
    ]
    return said(f"{item.meaning}: ", *parted(values, "; "), label=item.name)


def open_values(item: CodePart) -> Iterator[Said]:
    """Yield the rule for values that the manual does not list."""
    if item.open:
        yield said("Other values that match ", Code(item.open), " are accepted and shown as unlisted")


def spelling(item: Spelling) -> Said:
    """Return another spelling found on labels."""
    return said(Code(item.pattern), f", as in {item.where}", label="Also written", source=item.source)
