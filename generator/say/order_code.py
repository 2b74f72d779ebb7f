"""Statements about an order code: its parts and other spellings on labels."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import CodePart, CodeValue, Device, Spelling
from .erratum import errata, erratum
from .text import Code, Part, Statement, parted, spec_text, statement


def order_code(device: Device) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    code = device.order_code
    yield statement(Code(code.pattern), label="Order codes", source=code.source)
    for code_part in code.parts:
        yield part(code_part)
        yield from open_values(code_part)
    yield from map(spelling, code.also_written)
    yield from spec_text(code.note)
    yield from spec_text(code.special)
    yield from map(erratum, errata(device, "order_code", "parameters"))


def part(code_part: CodePart) -> Statement:
    """Return the meaning and the values of a part."""
    return statement(f"{code_part.meaning}: ", *parted(map(_part_value, code_part.values), "; "), label=code_part.name)


def _part_value(value: CodeValue) -> tuple[Part, ...]:
    return (Code(value.text), f" = {value.meaning}") if value.meaning else (Code(value.text),)


def open_values(code_part: CodePart) -> Iterator[Statement]:
    """Yield the rule for values that the manual does not list."""
    if code_part.open:
        yield statement("Other values that match ", Code(code_part.open), " are accepted and shown as unlisted")


def spelling(label_spelling: Spelling) -> Statement:
    """Return another spelling found on labels."""
    return statement(
        Code(label_spelling.pattern),
        f", as in {label_spelling.where}",
        label="Also written",
        source=label_spelling.source,
    )
