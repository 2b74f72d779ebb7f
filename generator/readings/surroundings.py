"""Facts other than data: contacts, alarms, inputs, the manual's history, characteristics, tables, LEDs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from ..language.problems import Path
from ..model import Alarm, Edition, Manual
from .cited import numbers_in
from .fact import Fact, Key, Sort
from .reading import Reading, at, over, plain
from .stated import Subject


def surroundings(reading: Reading) -> Iterator[Fact]:
    """Yield all facts other than data."""
    yield from _connectors(reading)
    for alarm in reading.device.alarms:
        for where in _bits_of(reading, alarm):
            subject = Subject(reading, ("alarm", where), ("alarms", alarm.name), f"the alarm '{alarm.name}'")
            yield replace(subject.first(Sort.ALARM, "present", name=alarm.name), what=f"alarm at {where}")
            yield from subject.stated(alarm)
    for number, item in enumerate(reading.device.inputs, 1):
        subject = Subject(reading, ("input", number), ("inputs", item.name), f"input {number}")
        yield from subject.present(Sort.INPUT, item)
    yield from _history(reading, reading.device.manual)
    yield from _characteristics(reading)
    yield from _tables(reading)
    yield from _leds(reading)


def _connectors(reading: Reading) -> Iterator[Fact]:
    """Yield every contact, by interface, number of its connector or cable, and pin or colour."""
    counts: Counter[tuple[str, str]] = Counter()
    every = ((item, interface) for item in reading.device.connectors for interface in item.interfaces or ("",))
    for connector, interface in every:
        counts[interface, connector.kind] += 1
        number = counts[interface, connector.kind]
        what = f"{connector.kind} {number}" + (f" for {over(interface)}" if interface else "")
        key: Key = ("connector", interface, connector.kind, number)
        owner = Subject(reading, key, ("connectors", connector.name), what)
        yield owner.first(Sort.PIN, "present", name=connector.name)
        for item in connector.contacts:
            place: Path = (*owner.place, "contacts", item.contact)
            what = f"contact {item.contact} of {owner.what}"
            contact = Subject(reading, (*owner.key, plain(item.contact)), place, what, joint=" with ")
            # Two readers differ in capitals and blanks, but not in the sign of a signal.
            signal = "".join(item.signal.casefold().split())
            yield contact.first(Sort.PIN, signal, at="signal", under=owner.key)
            yield from contact.stated(item)


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


def _history(reading: Reading, manual: Manual) -> Iterator[Fact]:
    """Yield the editions that were read, and the manual's revisions."""
    editions: list[tuple[Path, Manual | Edition]] = [(("manual",), manual)]
    editions += [(("manual", "editions", item.revision), item) for item in manual.editions]
    for place, edition in editions:
        subject = Subject(reading, ("edition", edition.language), place, f"the edition '{edition.language}'")
        what = f"revision of {subject.what}"
        yield replace(subject.first(Sort.HISTORY, edition.revision, at="revision"), what=what)
        yield from subject.stated(edition)
    for row in manual.history:
        key, place = ("revision", row.revision), ("manual", "history", row.revision)
        yield from Subject(reading, key, place, f"revision {row.revision}").present(Sort.HISTORY, row, "listed")


def _characteristics(reading: Reading) -> Iterator[Fact]:
    """Yield every characteristic by its name, with its quantities in the order of the text."""
    for item in reading.device.characteristics:
        key, place = ("characteristic", item.name), ("characteristics", item.name)
        subject = Subject(reading, key, place, f"the characteristic '{item.name}'")
        yield from subject.present(Sort.CHARACTERISTIC, item)
        for index, value in enumerate(item.values):
            what = f"{value.quantity} {index + 1} of {subject.what}"
            yield from subject.inside((index,), ("values", index), what).stated(value)


def _tables(reading: Reading) -> Iterator[Fact]:
    """Yield every table by its name, with the numbers in its cells by row and column."""
    for item in reading.device.tables:
        subject = Subject(reading, ("table", item.name), ("tables", item.name), f"the table '{item.name}'")
        yield from subject.present(Sort.TABLE, item, f"{len(item.rows)} rows")
        for number, row in enumerate(item.rows):
            for column, cell in enumerate(row):
                if numbers := numbers_in(cell):
                    place, noun = (*subject.place, "rows", number, column), f"row {number + 1}, column {column + 1}"
                    yield subject.fact(Sort.TABLE, f"{number} {column}", numbers, noun, place)


def _leds(reading: Reading) -> Iterator[Fact]:
    """Yield every LED by its name, with its states in the order of the manual."""
    for item in reading.device.leds:
        owner = Subject(reading, ("led", item.name), ("leds", item.name), f"the LED '{item.name}'")
        yield owner.first(Sort.LED, f"{len(item.states)} states", name=item.name)
        for number, state in enumerate(item.states):
            subject = owner.inside((number,), ("states", number), f"state {number + 1} of {owner.what}")
            yield subject.fact(Sort.LED, "state", state.state.casefold(), "words")
            yield from subject.stated(state)
