"""Facts other than frames and registers: procedures, alarms, connectors, inputs, editions, tables and so on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from ..language.document import Path
from ..model import (
    Alarm,
    Connector,
    Edition,
    Field,
    Layout,
    Manual,
    Procedure,
    ReadStep,
    SendStep,
    WaitStep,
)
from .reading import (
    ComparedFact,
    FactClass,
    FactKey,
    SpecReading,
    comparable_text,
    interface_label,
    register_text,
)
from .stated import FactSubject, dotted_path, numbers_in, program_text, register_and_bits, step_text


def surroundings(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the facts about connectors, alarms, inputs, editions, characteristics, tables and LEDs.

    An alarm is identified by its bits. It can be in several places, such as a register and the frames.
    """
    yield from _connector_facts(reading)
    for alarm in reading.device.alarms:
        for bits_text in _alarm_bits_texts(reading, alarm):
            subject = FactSubject(
                reading,
                key=("alarm", bits_text),
                path_in_file=("alarms", alarm.name),
                description=f"the alarm '{alarm.name}'",
            )
            yield replace(
                subject.existence_fact(FactClass.ALARM, "present", name=alarm.name), description=f"alarm at {bits_text}"
            )
            yield from subject.stated_facts(alarm)
    for number, hardware_input in enumerate(reading.device.inputs, 1):
        subject = FactSubject(
            reading, key=("input", number), path_in_file=("inputs", hardware_input.name), description=f"input {number}"
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
    owner = FactSubject(reading, key=key, path_in_file=("connectors", connector.name), description=connector_text)
    yield from owner.facts_of_part(FactClass.PIN, connector)
    for contact in connector.contacts:
        subject = FactSubject(
            reading,
            key=(*owner.key, comparable_text(contact.contact)),
            path_in_file=(*owner.path_in_file, "contacts", contact.contact),
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
    for path_in_file, edition in editions:
        subject = FactSubject(
            reading,
            key=("edition", edition.language),
            path_in_file=path_in_file,
            description=f"the edition '{edition.language}'",
        )
        revision = subject.existence_fact(FactClass.HISTORY, edition.revision, at="revision")
        yield replace(revision, description=f"revision of {subject.description}")
        yield from subject.stated_facts(edition)
    for row in manual.history:
        row_path = ("manual", "history", row.revision)
        row_subject = FactSubject(
            reading, key=("revision", row.revision), path_in_file=row_path, description=f"revision {row.revision}"
        )
        yield from row_subject.facts_of_part(FactClass.HISTORY, row, value="listed")


def _characteristic_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the facts of every characteristic, identified by its name, and of its quantities, numbered in the text."""
    for characteristic in reading.device.characteristics:
        key = ("characteristic", characteristic.name)
        path_in_file = ("characteristics", characteristic.name)
        subject = FactSubject(
            reading, key=key, path_in_file=path_in_file, description=f"the characteristic '{characteristic.name}'"
        )
        yield from subject.facts_of_part(FactClass.CHARACTERISTIC, characteristic)
        for index, quantity_value in enumerate(characteristic.values):
            description = f"{quantity_value.quantity} {index + 1} of {subject.description}"
            quantity_subject = subject.inside(key=(index,), path_in_file=("values", index), description=description)
            yield from quantity_subject.stated_facts(quantity_value)


def _table_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield every table, identified by its name, and the numbers of each cell with numbers, by row and column."""
    for table in reading.device.tables:
        subject = FactSubject(
            reading,
            key=("table", table.name),
            path_in_file=("tables", table.name),
            description=f"the table '{table.name}'",
        )
        yield from subject.facts_of_part(FactClass.TABLE, table, value=f"{len(table.rows)} rows")
        for row_index, row in enumerate(table.rows):
            for column_index, cell in enumerate(row):
                cell_numbers = numbers_in(cell)  # A text, such as "5V 10ms", or "".
                if cell_numbers:
                    path_in_file = (*subject.path_in_file, "rows", row_index, column_index)
                    noun = f"row {row_index + 1}, column {column_index + 1}"
                    yield subject.detail_fact(
                        FactClass.TABLE,
                        name=f"{row_index} {column_index}",
                        value=cell_numbers,
                        noun=noun,
                        path_in_file=path_in_file,
                    )


def _led_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield every LED, identified by its name, and its states, numbered in the order of the manual."""
    for led in reading.device.leds:
        led_subject = FactSubject(
            reading, key=("led", led.name), path_in_file=("leds", led.name), description=f"the LED '{led.name}'"
        )
        yield from led_subject.facts_of_part(FactClass.LED, led, value=f"{len(led.states)} states")
        for index, led_state in enumerate(led.states):
            state_subject = led_subject.inside(
                key=(index,),
                path_in_file=("states", index),
                description=f"state {index + 1} of {led_subject.description}",
            )
            yield state_subject.detail_fact(FactClass.LED, name="state", value=led_state.state.casefold(), noun="words")
            yield from state_subject.stated_facts(led_state)


class _Detail(NamedTuple):
    """A fact about part of a procedure. Its key and its place are within the procedure."""

    fact_class: FactClass
    key: FactKey
    path_in_file: Path
    value: str
    description: str


def procedures(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the facts of every procedure: its steps as text, and its argument limits, waits and repetitions.

    Two readers give procedures different names. A procedure is therefore identified by its interface and the text of
    its steps, such as ``write 0x49 = 05; read 0x4A``.
    """
    for procedure in reading.device.procedures:
        steps_text = program_text(reading, procedure)
        procedure_key: FactKey = ("procedure", procedure.interface, steps_text)
        procedure_path: Path = ("procedures", procedure.name)
        yield ComparedFact(
            fact_class=FactClass.PROCEDURE,
            key=procedure_key,
            value=steps_text,
            description=f"a procedure over {interface_label(procedure.interface)}",
            path_in_file=procedure_path,
            name=procedure.name,
            name_path=(*procedure_path, "name"),
        )
        for detail in (*_argument_limits(reading, procedure), *_waits_and_repetitions(reading, procedure)):
            yield ComparedFact(
                fact_class=detail.fact_class,
                key=(*procedure_key, *detail.key),
                value=detail.value,
                description=detail.description,
                path_in_file=(*procedure_path, *detail.path_in_file),
                depends_on=procedure_key,
            )


def _argument_limits(reading: SpecReading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield for each argument the register whose limits apply to it: ``register 0x49``.

    If another register determines what the argument means, the condition for its meaning follows: ``register 0x49 while
    register 0x4A bits 1:0 is 3``.
    """
    for number, argument in enumerate(procedure.arguments, 1):
        register = reading.device.register(argument.of)
        while_text = ""
        for meaning in register.meanings:
            if meaning.name == argument.meant_as:
                while_text = f" while {reading.state(meaning.when, meaning.value)}"
        yield _Detail(
            fact_class=FactClass.LIMIT,
            key=("argument", number),
            path_in_file=("arguments", argument.name, "of"),
            value=f"{register_text(register)}{while_text}",
            description=f"limits of argument {number} of the procedure '{procedure.name}'",
        )


def _waits_and_repetitions(reading: SpecReading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield the waits, the bits that are read, and the repetitions of requests.

    A step is identified by its number, for which waits are not counted. Consecutive waits are added up, and are
    identified by the number of the step before them, or 0 at the start.
    """
    step_number = 0
    total_wait_us = 0
    position_text = "at its start"  # of the next wait
    for index, step in enumerate(procedure.steps):
        step_place = ("steps", index)
        if isinstance(step, WaitStep):
            total_wait_us += step.microseconds
            following_steps = procedure.steps[index + 1 :]
            is_last_of_waits = not following_steps or not isinstance(following_steps[0], WaitStep)
            if is_last_of_waits:
                yield _Detail(
                    fact_class=FactClass.WAIT,
                    key=("wait", step_number),
                    path_in_file=(*step_place, "at_least_ms"),
                    value=f"{total_wait_us // 1000} ms",
                    description=f"wait {position_text} in the procedure '{procedure.name}'",
                )
            continue
        quoted_step = f"'{step_text(reading, step, procedure)}'"
        step_number += 1
        # Waits after this step are added up from zero again.
        total_wait_us = 0
        position_text = f"after {quoted_step}"
        if isinstance(step, ReadStep) and step.field:
            yield _Detail(
                fact_class=FactClass.PROCEDURE,
                key=("bits", step_number),
                path_in_file=(*step_place, "field"),
                value=register_and_bits(reading, step.register, step.field),
                description=f"bits used by {quoted_step}",
            )
        if isinstance(step, SendStep):
            step_in_procedure = f"{quoted_step} in the procedure '{procedure.name}'"
            yield from _repetition_details(step, step_number, step_place, step_in_procedure)


def _repetition_details(step: SendStep, step_number: int, path_in_file: Path, request_text: str) -> Iterator[_Detail]:
    """Yield how often a request is sent, at which interval, and whether in succession without other requests."""
    yield _Detail(
        fact_class=FactClass.PROCEDURE,
        key=("times", step_number),
        path_in_file=(*path_in_file, "times"),
        value=str(step.times),
        description=f"repetitions of {request_text}",
    )
    if step.microseconds:
        yield _Detail(
            fact_class=FactClass.WAIT,
            key=("every", step_number),
            path_in_file=(*path_in_file, "every_at_least_us"),
            value=f"{step.microseconds} µs",
            description=f"interval of {request_text}",
        )
    if step.in_succession:
        yield _Detail(
            fact_class=FactClass.PROCEDURE,
            key=("succession", step_number),
            path_in_file=(*path_in_file, "in_succession"),
            value="yes",
            description=f"succession of {request_text}",
        )


def content_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the page of every section and of every entry in the table of contents, if it has one."""
    for section, section_contents in reading.document.data["manual"].get("contents", {}).items():
        path_in_file: Path = ("manual", "contents", section)
        pages = {(*path_in_file, "page"): section_contents.get("page")}
        for entry, page in section_contents.get("entries", {}).items():
            pages[(*path_in_file, "entries", entry)] = page
        for page_path, page in pages.items():
            if page is not None:
                description = f"page of {dotted_path(page_path[2:])} in the contents"
                yield ComparedFact(
                    fact_class=FactClass.CONTENTS,
                    key=("contents", *page_path),
                    value=str(page),
                    description=description,
                    path_in_file=page_path,
                )
