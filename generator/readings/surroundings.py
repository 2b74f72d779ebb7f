"""Facts other than data: contacts, alarms, inputs, the manual's history, characteristics, tables, LEDs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from ..language.problems import Path
from ..model import Alarm, Connector, Edition, Manual
from .cited import numbers_in
from .fact import Fact, Key, Sort
from .reading import Reading, interface_label, plain, register_text
from .stated import Subject


def surroundings(reading: Reading) -> Iterator[Fact]:
    """Yield all facts other than data."""
    yield from _connectors(reading)
    for alarm in reading.device.alarms:
        for place in _bits_of(reading, alarm):
            subject = Subject(reading, ("alarm", place), ("alarms", alarm.name), f"the alarm '{alarm.name}'")
            yield replace(subject.existence(Sort.ALARM, "present", name=alarm.name), description=f"alarm at {place}")
            yield from subject.stated_facts(alarm)
    for number, hardware_input in enumerate(reading.device.inputs, 1):
        subject = Subject(reading, ("input", number), ("inputs", hardware_input.name), f"input {number}")
        yield from subject.present(Sort.INPUT, hardware_input)
    yield from _history(reading, reading.device.manual)
    yield from _characteristics(reading)
    yield from _tables(reading)
    yield from _leds(reading)


def _connectors(reading: Reading) -> Iterator[Fact]:
    """Yield every contact, by interface, number of its connector or cable, and pin or colour."""
    counts: Counter[tuple[str, str]] = Counter()
    for connector in reading.device.connectors:
        for interface in connector.interfaces or ("",):
            counts[interface, connector.kind] += 1
            yield from _contacts(reading, connector, interface, counts[interface, connector.kind])


def _contacts(reading: Reading, connector: Connector, interface: str, number: int) -> Iterator[Fact]:
    """Yield a connector or cable of an interface, and its contacts."""
    description = f"{connector.kind} {number}" + (f" for {interface_label(interface)}" if interface else "")
    key: Key = ("connector", interface, connector.kind, number)
    owner = Subject(reading, key, ("connectors", connector.name), description)
    yield owner.existence(Sort.PIN, "present", name=connector.name)
    for contact in connector.contacts:
        place: Path = (*owner.place, "contacts", contact.contact)
        description = f"contact {contact.contact} of {owner.description}"
        subject = Subject(reading, (*owner.key, plain(contact.contact)), place, description, joint=" with ")
        # Two readers differ in capitals and blanks, but not in the sign of a signal.
        signal = "".join(contact.signal.casefold().split())
        yield subject.existence(Sort.PIN, signal, at="signal", under=owner.key)
        yield from subject.stated_facts(contact)


def _bits_of(reading: Reading, alarm: Alarm) -> Iterator[str]:
    """Yield the places of the bits of an alarm, in words without names."""
    register = reading.register(alarm.register) if alarm.register else None
    if register is not None:
        yield reading.bits_at(f"{alarm.register}.{alarm.field}") if alarm.field else register_text(register)
    for interface, layout in reading.device.layouts():
        for field in layout.fields:
            if alarm.group and (field.group, field.name) == (alarm.group, alarm.field):
                places = reading.bits_in_frames(interface.name, layout, field)
                yield from (f"{place} over {interface.short}" for place in places)


def _history(reading: Reading, manual: Manual) -> Iterator[Fact]:
    """Yield the editions that were read, and the manual's revisions."""
    editions: list[tuple[Path, Manual | Edition]] = [(("manual",), manual)]
    editions += [(("manual", "editions", edition.revision), edition) for edition in manual.editions]
    for place, edition in editions:
        subject = Subject(reading, ("edition", edition.language), place, f"the edition '{edition.language}'")
        description = f"revision of {subject.description}"
        yield replace(subject.existence(Sort.HISTORY, edition.revision, at="revision"), description=description)
        yield from subject.stated_facts(edition)
    for row in manual.history:
        key, place = ("revision", row.revision), ("manual", "history", row.revision)
        yield from Subject(reading, key, place, f"revision {row.revision}").present(Sort.HISTORY, row, "listed")


def _characteristics(reading: Reading) -> Iterator[Fact]:
    """Yield every characteristic by its name, with its quantities in the order of the text."""
    for characteristic in reading.device.characteristics:
        key, place = ("characteristic", characteristic.name), ("characteristics", characteristic.name)
        subject = Subject(reading, key, place, f"the characteristic '{characteristic.name}'")
        yield from subject.present(Sort.CHARACTERISTIC, characteristic)
        for index, value in enumerate(characteristic.values):
            description = f"{value.quantity} {index + 1} of {subject.description}"
            yield from subject.inside((index,), ("values", index), description).stated_facts(value)


def _tables(reading: Reading) -> Iterator[Fact]:
    """Yield every table by its name, with the numbers in its cells by row and column."""
    for table in reading.device.tables:
        subject = Subject(reading, ("table", table.name), ("tables", table.name), f"the table '{table.name}'")
        yield from subject.present(Sort.TABLE, table, f"{len(table.rows)} rows")
        for number, row in enumerate(table.rows):
            for column, cell in enumerate(row):
                if numbers := numbers_in(cell):
                    place, noun = (*subject.place, "rows", number, column), f"row {number + 1}, column {column + 1}"
                    yield subject.fact(Sort.TABLE, f"{number} {column}", numbers, noun, place)


def _leds(reading: Reading) -> Iterator[Fact]:
    """Yield every LED by its name, with its states in the order of the manual."""
    for led in reading.device.leds:
        owner = Subject(reading, ("led", led.name), ("leds", led.name), f"the LED '{led.name}'")
        yield owner.existence(Sort.LED, f"{len(led.states)} states", name=led.name)
        for number, state in enumerate(led.states):
            subject = owner.inside((number,), ("states", number), f"state {number + 1} of {owner.description}")
            yield subject.fact(Sort.LED, "state", state.state.casefold(), "words")
            yield from subject.stated_facts(state)
