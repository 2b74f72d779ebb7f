"""Statements about an order code: its parts, its parameters, and other spellings on labels."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import CodePart, CodeValue, Device, Parameter, Spelling
from ..model.expressions import Expression
from .errata import errata, erratum
from .names_and_places import hexadecimal, register_at, register_field
from .numbers import number
from .register import limits
from .text import Code, Part, Ref, Statement, parted, spec_text, statement


def order_code(device: Device) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    code = device.order_code
    yield statement(Code(code.pattern), label="Order codes", source=code.source)
    for code_part in code.parts:
        yield part(code_part)
        yield from open_values(code_part)
    yield from map(spelling, code.also_written)
    yield from not_on_label(device)
    yield from spec_text(code.note)
    yield from spec_text(code.special)
    yield from map(erratum, errata(device, "order_code", "parameters"))


def not_on_label(device: Device) -> Iterator[Statement]:
    """Yield that the order codes are made up, with what the label shows instead, if they are."""
    yield from spec_text(device.order_code.not_on_label, label="Made-up order code")


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


def parameter(device: Device, device_parameter: Parameter) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    yield from spec_text(device_parameter.meaning, source=device_parameter.source)
    yield from spec_text(device_parameter.unit, label="Unit")
    yield from parameter_origin(device, device_parameter)


def _bound(number: int | None) -> Expression | None:
    return Expression(number) if number is not None else None


def parameter_origin(device: Device, device_parameter: Parameter) -> Iterator[Statement]:
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
        values = {coded.code: parameter_value(device_parameter, coded.value) for coded in device_parameter.by_code}
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


def parameter_value(device_parameter: Parameter, count: int) -> str:
    """Return its value for an order code. IDs and other codes are in the hexadecimal notation of manuals."""
    return hexadecimal(count) if device_parameter.hexadecimal else number(count)
