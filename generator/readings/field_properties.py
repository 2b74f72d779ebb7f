"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import CrcValue, Field, PlacedField, Register, Unused
from ..say.place import bits
from .fact import Fact, Facts, Sort
from .reading import Parameters, as_delivered, in_hex, interface_label
from .stated import Subject


def add_names(subject: Subject, placed_field: PlacedField, owner: str | int, facts: Facts) -> None:
    """Add the names of a field of the frame or register ``owner``, and of the field's values."""
    name, place, bits_text = (
        placed_field.name,
        subject.place,
        f"{bits(placed_field.high, placed_field.low)} of '{owner}'",
    )
    span = placed_field.low, placed_field.width
    if place[-2:] == ("fields", name):
        facts.call(("field",), Fact(Sort.POSITION, span, name, f"name of {bits_text}", (*place, "name")))
    for value in placed_field.field.values:
        description, path = f"name of value {in_hex(value.value)} of {bits_text}", (*place, "values", value.name)
        fact = Fact(Sort.VALUE, (value.value,), value.name, description, subject.reading.first_existing(path, place))
        facts.call(("value", *span), fact)


def properties(
    subject: Subject, placed_field: PlacedField, parameters: Parameters, register: Register | None
) -> Iterator[Fact]:
    """Yield all properties of a field for these parameters, and of the ``register`` that may contain it."""
    field = placed_field.field
    yield from _of_kind(subject, field)
    if field.equals is not None:
        number = field.documented(parameters)
        value = in_hex(number) if isinstance(number, int) else str(number)
        yield subject.fact(Sort.VALUE, "equals", value, "fixed value")
    default, is_implied = (field.default, False) if register is None else _default(placed_field, register)
    if default is not None:
        yield replace(subject.fact(Sort.DEFAULT, "default", in_hex(default), "default"), implied=is_implied)
    yield from subject.stated_facts(field)


def _of_kind(subject: Subject, field: Field) -> Iterator[Fact]:
    reading = subject.reading
    for fact in subject.stated_facts(field.kind):
        # The verdict of a flag that the interface defines is not in the spec.
        is_verdict = fact.sort is Sort.VERDICT
        place = reading.first_existing(fact.place, subject.place) if is_verdict else fact.place
        yield replace(fact, place=place, mild=is_verdict and isinstance(field.kind, Unused))
    if isinstance(field.kind, CrcValue):
        crc = Subject(reading, ("crc",), ("crcs", field.kind.crc), f"the CRC over {interface_label(subject.interface)}")
        yield from crc.stated_facts(reading.device.crc(field.kind.crc))
    for named_value in field.values:
        place = reading.first_existing((*subject.place, "values", named_value.name), subject.place)
        value_subject = Subject(
            reading, ("value", named_value.value), place, f"value {in_hex(named_value.value)} of {subject.description}"
        )
        yield value_subject.existence(Sort.VALUE, "named")
        yield from value_subject.stated_facts(named_value)


def _default(placed_field: PlacedField, register: Register) -> tuple[int | None, bool]:
    """Return the default of a field, and True if the register's default implies it. None if both are the same."""
    own_default, register_default = placed_field.field.default, as_delivered(register)
    if register_default is None:
        return own_default, False
    if placed_field.width == 8 * register.length or not placed_field.field.carries_data:
        return None, False
    return (
        (own_default, False)
        if own_default is not None
        else (register_default >> placed_field.low & (1 << placed_field.width) - 1, True)
    )
