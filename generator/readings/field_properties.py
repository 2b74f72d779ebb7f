"""Properties of a field other than its bits: levels, values, limits, CRCs, the verdict of a flag."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..model import CrcValue, Field, PlacedField, Register, Unused
from ..say.place import bits
from .fact import Fact, Facts, Sort
from .reading import Parameters, as_delivered, in_hex, over
from .stated import Subject


def add_names(subject: Subject, item: PlacedField, owner: str | int, facts: Facts) -> None:
    """Add the names of a field of the frame or register ``owner``, and of the field's values."""
    name, place, where = item.name, subject.place, f"{bits(item.high, item.low)} of '{owner}'"
    span = item.low, item.width
    if place[-2:] == ("fields", name):
        facts.call(("field",), Fact(Sort.POSITION, span, name, f"name of {where}", (*place, "name")))
    for value in item.field.values:
        what, at = f"name of value {in_hex(value.value)} of {where}", (*place, "values", value.name)
        fact = Fact(Sort.VALUE, (value.value,), value.name, what, subject.reading.first(at, place))
        facts.call(("value", *span), fact)


def properties(
    subject: Subject, item: PlacedField, parameters: Parameters, register: Register | None
) -> Iterator[Fact]:
    """Yield all properties of a field for these parameters, and of the ``register`` that may contain it."""
    field = item.field
    yield from _of_kind(subject, field)
    if field.equals is not None:
        number = field.documented(parameters)
        value = in_hex(number) if isinstance(number, int) else str(number)
        yield subject.fact(Sort.VALUE, "equals", value, "fixed value")
    default, is_implied = (field.default, False) if register is None else _default(item, register)
    if default is not None:
        yield replace(subject.fact(Sort.DEFAULT, "default", in_hex(default), "default"), implied=is_implied)
    yield from subject.stated(field)


def _of_kind(subject: Subject, field: Field) -> Iterator[Fact]:
    reading = subject.reading
    for fact in subject.stated(field.kind):
        # The verdict of a flag that the interface defines is not in the spec.
        is_verdict = fact.sort is Sort.VERDICT
        place = reading.first(fact.place, subject.place) if is_verdict else fact.place
        yield replace(fact, place=place, mild=is_verdict and isinstance(field.kind, Unused))
    if isinstance(field.kind, CrcValue):
        crc = Subject(reading, ("crc",), ("crcs", field.kind.crc), f"the CRC over {over(subject.interface)}")
        yield from crc.stated(reading.device.crc(field.kind.crc))
    for item in field.values:
        place = reading.first((*subject.place, "values", item.name), subject.place)
        value = Subject(reading, ("value", item.value), place, f"value {in_hex(item.value)} of {subject.what}")
        yield value.first(Sort.VALUE, "named")
        yield from value.stated(item)


def _default(item: PlacedField, register: Register) -> tuple[int | None, bool]:
    """Return the default of a field, and True if the register's default implies it. None if both are the same."""
    own, whole = item.field.default, as_delivered(register)
    if whole is None:
        return own, False
    if item.width == 8 * register.length or not item.field.carries_data:
        return None, False
    return (own, False) if own is not None else (whole >> item.low & (1 << item.width) - 1, True)
