"""Sentences about a parameter."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Device, Parameter
from ..model.expressions import Expression
from .name import register_field
from .place import hexadecimal, register_at
from .register import limits
from .text import Code, Part, Ref, Statement, spec_text, statement
from .words import number


def parameter(device: Device, item: Parameter) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    yield from spec_text(item.meaning, source=item.source)
    yield from spec_text(item.unit, label="Unit")
    yield from origin(device, item)


def _bound(number: int | None) -> Expression | None:
    return Expression(number) if number is not None else None


def origin(device: Device, item: Parameter) -> Iterator[Statement]:
    """Yield the source of its value if no order code sets it."""
    if item.equals is not None:
        yield statement("Equals ", item.equals)
    if item.alternative:
        yield statement("Set by your choice of ", *_choice(device, item))
    if item.read_from:
        span = limits(*map(_bound, (item.min, item.max)))
        between = (", ", *span) if span and not item.by_code else ()
        at = register_at(device.register(item.register))
        yield statement(f"Read at run time from {at} (", register_field(device, item.read_from), ")", *between)
    if item.by_code:
        codes = (f"{one.code} means {value(item, one.value)}" for one in item.by_code)
        yield statement(f"The register holds a code: {', '.join(codes)}")


def _choice(device: Device, item: Parameter) -> Iterator[Part]:
    """Yield a reference to the alternative that sets a parameter. If it has a default, the values follow."""
    yield Ref("alternative", item.alternative, item.alternative)
    found = next((one for one in device.optional_alternatives if one.name == item.alternative), None)
    for index, answer in enumerate(found.answers if found is not None else ()):
        yield f"{', ' if index else ': '}{answer.sets[item.name]} for "
        yield Code(answer.name)
        yield "" if index else " (default)"


def initial(device: Device) -> str:
    """Return the kind of the values that apply until registers are read, in the plural."""
    names = {item.register for item in device.run_time_parameters}
    # A device of one interface lacks the registers of the others.
    held = [item for item in device.registers if item.name in names]
    has_default = not held or any(item.default is not None for item in held)
    return "factory defaults" if has_default else "values of the order code"


def value(item: Parameter, count: int) -> str:
    """Return its value for an order code. IDs and other codes are in the hexadecimal notation of manuals."""
    return hexadecimal(count) if item.hexadecimal else number(count)
