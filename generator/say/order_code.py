"""Statements about an order code: its parts and other spellings on labels."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import CodePart, CodeValue, Device, Spelling
from .erratum import errata, erratum
from .text import Code, Part, Said, parted, said, told


def order_code(device: Device) -> Iterator[Said]:
    """Yield all statements about it in order, for running text."""
    code = device.order_code
    yield said(Code(code.pattern), label="Order codes", source=code.source)
    for code_part in code.parts:
        yield part(code_part)
        yield from open_values(code_part)
    yield from map(spelling, code.also_written)
    yield from told(code.note)
    yield from told(code.special)
    yield from map(erratum, errata(device, "order_code", "parameters"))


def part(code_part: CodePart) -> Said:
    """Return the meaning and the values of a part."""
    return said(f"{code_part.meaning}: ", *parted(map(_part_value, code_part.values), "; "), label=code_part.name)


def _part_value(value: CodeValue) -> tuple[Part, ...]:
    return (Code(value.text), f" = {value.meaning}") if value.meaning else (Code(value.text),)


def open_values(code_part: CodePart) -> Iterator[Said]:
    """Yield the rule for values that the manual does not list."""
    if code_part.open:
        yield said("Other values that match ", Code(code_part.open), " are accepted and shown as unlisted")


def spelling(label_spelling: Spelling) -> Said:
    """Return another spelling found on labels."""
    return said(
        Code(label_spelling.pattern),
        f", as in {label_spelling.where}",
        label="Also written",
        source=label_spelling.source,
    )
