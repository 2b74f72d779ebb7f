"""Facts other than data: contacts, alarms, inputs, the manual's history."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..language.problems import Path
from ..model import Alarm, Connector, Edition, Manual
from .cited import numbers_in
from .fact import Fact, Sort
from .printed_names import plain
from .reading import Reading, at, over
from .stated import Subject


def contacts(reading: Reading) -> Iterator[Fact]:
    """Yield every contact, by interface, number of its connector or cable, and pin or colour."""
    counts: dict[tuple[str, str], int] = {}
    for item in reading.device.connectors:
        for interface in item.interfaces or ("",):
            counts[interface, item.kind] = counts.get((interface, item.kind), 0) + 1
            yield from _contacts(reading, item, interface, counts[interface, item.kind])


def _contacts(reading: Reading, connector: Connector, interface: str, number: int) -> Iterator[Fact]:
    what = f"{connector.kind} {number}" + (f" for {over(interface)}" if interface else "")
    owner = Subject(reading, ("connector", interface, connector.kind, number), ("connectors", connector.name), what)
    yield owner.first(Sort.PIN, "present", name=connector.name)
    for item in connector.contacts:
        key, place = (*owner.key, plain(item.contact)), (*owner.place, "contacts", item.contact)
        contact = Subject(reading, key, place, f"contact {item.contact} of {what}", joint=" with ")
        yield contact.first(Sort.PIN, signal(item.signal), at="signal", under=owner.key)
        yield from contact.stated(item)


def signal(text: str) -> str:
    """Return a signal as used in comparisons: with its sign, without blanks."""
    return "".join(text.casefold().split())


def alarms(reading: Reading) -> Iterator[Fact]:
    """Yield every alarm, by the place of its bit."""
    for item in reading.device.alarms:
        for where in _bits_of(reading, item):
            subject = Subject(reading, ("alarm", where), ("alarms", item.name), f"the alarm '{item.name}'")
            yield replace(subject.first(Sort.ALARM, "present", name=item.name), what=f"alarm at {where}")
            yield from subject.stated(item)


def _bits_of(reading: Reading, alarm: Alarm) -> Iterator[str]:
    """Yield the places of the bits of an alarm, in words without names."""
    register = reading.register(alarm.register) if alarm.register else None
    if register is not None:
        yield reading.bits_at(f"{alarm.register}.{alarm.field}") if alarm.field else at(register)
    for interface, layout in reading.device.layouts():
        for item in layout.fields:
            if alarm.group and (item.group, item.name) == (alarm.group, alarm.field):
                places = reading.bits_in_frames(interface.name, layout, item)
                yield from (f"{place} over {interface.short}" for place in places)


def inputs(reading: Reading) -> Iterator[Fact]:
    """Yield every hardware input, in the order of the manual."""
    for number, item in enumerate(reading.device.inputs, 1):
        subject = Subject(reading, ("input", number), ("inputs", item.name), f"input {number}")
        yield subject.first(Sort.INPUT, "present", name=item.name)
        yield from subject.stated(item)


def history(reading: Reading) -> Iterator[Fact]:
    """Yield the edition that was read, and the manual's revisions."""
    manual = reading.device.manual
    yield from _edition(reading, manual, ("manual",))
    for item in manual.editions:
        yield from _edition(reading, item, ("manual", "editions", item.revision))
    for row in manual.history:
        key, place = ("revision", row.revision), ("manual", "history", row.revision)
        subject = Subject(reading, key, place, f"revision {row.revision}")
        yield subject.first(Sort.HISTORY, "listed")
        yield from subject.stated(row)


def _edition(reading: Reading, item: Manual | Edition, place: Path) -> Iterator[Fact]:
    subject = Subject(reading, ("edition", item.language), place, f"the edition '{item.language}'")
    yield Fact(Sort.HISTORY, subject.key, item.revision, f"revision of {subject.what}", (*place, "revision"))
    yield from subject.stated(item)


def characteristics(reading: Reading) -> Iterator[Fact]:
    """Yield every characteristic by its name, with its quantities in the order of the text."""
    for item in reading.device.characteristics:
        key, place = ("characteristic", item.name), ("characteristics", item.name)
        subject = Subject(reading, key, place, f"the characteristic '{item.name}'")
        yield subject.first(Sort.CHARACTERISTIC, "present", name=item.name)
        yield from subject.stated(item)
        for index, value in enumerate(item.values):
            what = f"{value.quantity} {index + 1} of {subject.what}"
            yield from Subject(reading, (*key, index), (*place, "values", index), what, under=key).stated(value)


def tables(reading: Reading) -> Iterator[Fact]:
    """Yield every table by its name, with the numbers in its cells by row and column."""
    for item in reading.device.tables:
        subject = Subject(reading, ("table", item.name), ("tables", item.name), f"the table '{item.name}'")
        yield subject.first(Sort.TABLE, f"{len(item.rows)} rows", name=item.name)
        yield from subject.stated(item)
        for number, row in enumerate(item.rows):
            for column, cell in enumerate(row):
                if numbers := numbers_in(cell):
                    place, noun = (*subject.place, "rows", number, column), f"row {number + 1}, column {column + 1}"
                    yield subject.fact(Sort.TABLE, f"{number} {column}", numbers, noun, place)


def leds(reading: Reading) -> Iterator[Fact]:
    """Yield every LED by its name, with its states in the order of the manual."""
    for item in reading.device.leds:
        owner = Subject(reading, ("led", item.name), ("leds", item.name), f"the LED '{item.name}'")
        yield owner.first(Sort.LED, f"{len(item.states)} states", name=item.name)
        for number, state in enumerate(item.states):
            key, place = (*owner.key, number), (*owner.place, "states", number)
            subject = Subject(reading, key, place, f"state {number + 1} of {owner.what}", under=owner.key)
            yield subject.fact(Sort.LED, "state", state.state.casefold(), "words")
            yield from subject.stated(state)
