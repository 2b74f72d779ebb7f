"""Facts other than frames and registers: alarms, connectors, inputs, editions, characteristics, tables and LEDs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from ..language.document import Path
from ..model import Alarm, Connector, Edition, Field, Layout, Manual
from .reading import ComparedFact, FactClass, FactKey, SpecReading, comparable_text, interface_label, register_text
from .stated import FactSubject
from .texts import numbers_in


def surroundings(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the facts about connectors, alarms, inputs, editions, characteristics, tables and LEDs.

    An alarm is identified by its bits. It can be in several places, such as a register and the frames.
    """
    yield from _connector_facts(reading)
    for alarm in reading.device.alarms:
        for bits_text in _alarm_bits_texts(reading, alarm):
            subject = FactSubject(
                reading, key=("alarm", bits_text), place=("alarms", alarm.name), description=f"the alarm '{alarm.name}'"
            )
            yield replace(
                subject.existence_fact(FactClass.ALARM, "present", name=alarm.name), description=f"alarm at {bits_text}"
            )
            yield from subject.stated_facts(alarm)
    for number, hardware_input in enumerate(reading.device.inputs, 1):
        subject = FactSubject(
            reading, key=("input", number), place=("inputs", hardware_input.name), description=f"input {number}"
        )
        yield from subject.facts_of_part(FactClass.INPUT, hardware_input)
    yield from _history_facts(reading, reading.device.manual)
    yield from _characteristic_facts(reading)
    yield from _table_facts(reading)
    yield from _led_facts(reading)


def _connector_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the connectors and cables of each interface with their contacts.

    The connectors of an interface are numbered from 1, and so are its cables. Those that are for no particular
    interface are numbered together.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for connector in reading.device.connectors:
        for interface in connector.interfaces or ("",):
            counts[interface, connector.kind] += 1
            yield from _contact_facts(reading, connector, interface, counts[interface, connector.kind])


def _contact_facts(
    reading: SpecReading, connector: Connector, interface: str, connector_number: int
) -> Iterator[ComparedFact]:
    """Yield a connector or cable of an interface, and its contacts with their signals.

    A contact is identified by its pin or colour, such as ``("connector", "ssi", "connector", 1, "3")``.
    """
    connector_text = f"{connector.kind} {connector_number}"
    if interface:
        connector_text += f" for {interface_label(interface)}"
    key: FactKey = ("connector", interface, connector.kind, connector_number)
    owner = FactSubject(reading, key=key, place=("connectors", connector.name), description=connector_text)
    yield from owner.facts_of_part(FactClass.PIN, connector)
    for contact in connector.contacts:
        subject = FactSubject(
            reading,
            key=(*owner.key, comparable_text(contact.contact)),
            place=(*owner.place, "contacts", contact.contact),
            description=f"contact {contact.contact} of {connector_text}",
            joint=" with ",
        )
        # Two readers may write capitals and spaces differently, but not the + or - of a signal.
        signal = "".join(contact.signal.casefold().split())
        yield subject.existence_fact(FactClass.PIN, signal, at="signal", depends_on=owner.key)
        yield from subject.stated_facts(contact)


def _alarm_bits_texts(reading: SpecReading, alarm: Alarm) -> Iterator[str]:
    """Yield the places of an alarm: ``register 0x49 bit 3``, a whole register, and its bit in each frame.

    An alarm in frames belongs to a field group. Its bits are given for each frame with that group: ``bit 3 of … over
    SSI``. ``reading`` is the spec, or a second transcript of the manual, from which the facts are compared.
    """
    register = reading.register(alarm.register) if alarm.register else None
    if register is not None and alarm.field:
        yield reading.describe_bits(f"{alarm.register}.{alarm.field}")
    elif register is not None:
        yield register_text(register)
    if not alarm.group:
        return
    for interface, layout in reading.device.layouts():
        for field in _fields_of_alarm(layout, alarm):
            for bit_text in reading.bits_in_frames(interface.name, layout, field):
                yield f"{bit_text} over {interface.short}"


def _fields_of_alarm(layout: Layout, alarm: Alarm) -> list[Field]:
    """Return the fields of a frame that send an alarm: those with its name and from its field group."""
    return [field for field in layout.fields if field.group == alarm.group and field.name == alarm.field]


def _history_facts(reading: SpecReading, manual: Manual) -> Iterator[ComparedFact]:
    """Yield the revisions of the editions that were read, by language, and those that the manual lists."""
    editions: list[tuple[Path, Manual | Edition]] = [(("manual",), manual)]
    editions += [(("manual", "editions", edition.revision), edition) for edition in manual.editions]
    for place, edition in editions:
        subject = FactSubject(
            reading, key=("edition", edition.language), place=place, description=f"the edition '{edition.language}'"
        )
        revision = subject.existence_fact(FactClass.HISTORY, edition.revision, at="revision")
        yield replace(revision, description=f"revision of {subject.description}")
        yield from subject.stated_facts(edition)
    for row in manual.history:
        row_place = ("manual", "history", row.revision)
        row_subject = FactSubject(
            reading, key=("revision", row.revision), place=row_place, description=f"revision {row.revision}"
        )
        yield from row_subject.facts_of_part(FactClass.HISTORY, row, value="listed")


def _characteristic_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the facts of every characteristic, identified by its name, and of its quantities, numbered in the text."""
    for characteristic in reading.device.characteristics:
        key = ("characteristic", characteristic.name)
        place = ("characteristics", characteristic.name)
        subject = FactSubject(reading, key=key, place=place, description=f"the characteristic '{characteristic.name}'")
        yield from subject.facts_of_part(FactClass.CHARACTERISTIC, characteristic)
        for index, quantity_value in enumerate(characteristic.values):
            description = f"{quantity_value.quantity} {index + 1} of {subject.description}"
            quantity_subject = subject.inside(key=(index,), place=("values", index), description=description)
            yield from quantity_subject.stated_facts(quantity_value)


def _table_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield every table, identified by its name, and the numbers of each cell with numbers, by row and column."""
    for table in reading.device.tables:
        subject = FactSubject(
            reading, key=("table", table.name), place=("tables", table.name), description=f"the table '{table.name}'"
        )
        yield from subject.facts_of_part(FactClass.TABLE, table, value=f"{len(table.rows)} rows")
        for row_index, row in enumerate(table.rows):
            for column_index, cell in enumerate(row):
                cell_numbers = numbers_in(cell)  # A text, such as "5V 10ms", or "".
                if cell_numbers:
                    place = (*subject.place, "rows", row_index, column_index)
                    noun = f"row {row_index + 1}, column {column_index + 1}"
                    yield subject.detail_fact(
                        FactClass.TABLE, name=f"{row_index} {column_index}", value=cell_numbers, noun=noun, place=place
                    )


def _led_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield every LED, identified by its name, and its states, numbered in the order of the manual."""
    for led in reading.device.leds:
        led_subject = FactSubject(
            reading, key=("led", led.name), place=("leds", led.name), description=f"the LED '{led.name}'"
        )
        yield from led_subject.facts_of_part(FactClass.LED, led, value=f"{len(led.states)} states")
        for index, led_state in enumerate(led.states):
            state_subject = led_subject.inside(
                key=(index,),
                place=("states", index),
                description=f"state {index + 1} of {led_subject.description}",
            )
            yield state_subject.detail_fact(FactClass.LED, name="state", value=led_state.state.casefold(), noun="words")
            yield from state_subject.stated_facts(led_state)
