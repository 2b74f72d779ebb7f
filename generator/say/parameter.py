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


def parameter(device: Device, device_parameter: Parameter) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    yield from spec_text(device_parameter.meaning, source=device_parameter.source)
    yield from spec_text(device_parameter.unit, label="Unit")
    yield from origin(device, device_parameter)


def _bound(number: int | None) -> Expression | None:
    return Expression(number) if number is not None else None


def origin(device: Device, device_parameter: Parameter) -> Iterator[Statement]:
    """Yield the source of its value if no order code sets it."""
    if device_parameter.equals is not None:
        yield statement("Equals ", device_parameter.equals)
    if device_parameter.alternative:
        yield statement("Set by your choice of ", *_choice(device, device_parameter))
    if device_parameter.read_from:
        span = limits(*map(_bound, (device_parameter.min, device_parameter.max)))
        between = (", ", *span) if span and not device_parameter.by_code else ()
        at = register_at(device.register(device_parameter.register))
        yield statement(
            f"Read at run time from {at} (", register_field(device, device_parameter.read_from), ")", *between
        )
    if device_parameter.by_code:
        values = {coded.code: value(device_parameter, coded.value) for coded in device_parameter.by_code}
        codes = (f"{code} means {text}" for code, text in values.items())
        yield statement(f"The register holds a code: {', '.join(codes)}")


def _choice(device: Device, device_parameter: Parameter) -> Iterator[Part]:
    """Yield a reference to the alternative that sets a parameter. If it has a default, the values follow."""
    name = device_parameter.alternative
    yield Ref("alternative", name, name)
    answers = {question.name: question.answers for question in device.optional_alternatives}.get(name, ())
    for index, answer in enumerate(answers):
        yield f"{', ' if index else ': '}{answer.sets[device_parameter.name]} for "
        yield Code(answer.name)
        yield "" if index else " (default)"


def initial(device: Device) -> str:
    """Return the kind of the values that apply until registers are read, in the plural."""
    names = {run_time_parameter.register for run_time_parameter in device.run_time_parameters}
    # A device of one interface lacks the registers of the others.
    defaults = [register.default for register in device.registers if register.name in names]
    has_default = not defaults or any(default is not None for default in defaults)
    return "factory defaults" if has_default else "values of the order code"


def value(device_parameter: Parameter, count: int) -> str:
    """Return its value for an order code. IDs and other codes are in the hexadecimal notation of manuals."""
    return hexadecimal(count) if device_parameter.hexadecimal else number(count)
