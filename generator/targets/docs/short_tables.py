"""Tables with two columns for the page of an order code, which fit on a phone: a place or value, and all about it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ...model import Answer, Device, Example, Field, FieldGroup, Interface, Layout, Procedure, Register, Sources, Timing
from ...say import register as say_register
from ...say.commands import step
from ...say.interface import bounds_with_codes, settings
from ...say.markdown import STYLE, anchor, cited, code, joined, link, text
from ...say.names_and_places import Titled, addresses, heading, title
from ...say.text import counted, sentence, statement
from .fact_tables import example_facts
from .layout_tables import (
    field_cell,
    field_place_cell,
    fields_and_groups,
    group_place,
    group_places,
    has_value_table,
    value_rows,
)

Row = tuple[str, ...]


def title_cell(titled_part: Titled) -> str:
    """Return a title in words, with the identifier for programmers in small type."""
    return f"{text(title(titled_part))} <small>{code(titled_part.name)}</small>"


def field_rows(device: Device, layout: Layout) -> Iterator[Row]:
    """Yield rows of place, field. A group of fields is one row with a link to its table."""
    for field_or_group in fields_and_groups(device, layout):
        if isinstance(field_or_group, FieldGroup):
            yield group_place(device, layout, field_or_group), _group_cell(layout, field_or_group)
        else:
            description = _description_cell(device, field_or_group, layout.source, in_register=not layout.sender)
            yield _place_cell(device, layout, field_or_group), description


def _place_cell(device: Device, layout: Layout, field: Field) -> str:
    """Return the place of a field. If it is that of a field with its padding, the width of the field follows."""
    place = field_place_cell(layout, field, device.alternatives_of(layout))
    width = counted(STYLE.number(field.width), "bit") if field.container else ""
    return joined([place, width])


def _group_cell(layout: Layout, group: FieldGroup) -> str:
    """Return a link to the table of a group, and the names of its fields."""
    group_link = link(text(heading(group.name)), f"#group-{group.name}")
    names = ", ".join(code(field.name) for field in layout.fields if field.group == group.name)
    return f"{group_link} <small>{code(group.name)}</small>: {names}"


def group_rows(device: Device, name: str) -> Iterator[Row]:
    """Yield rows of place, field for a group of fields."""
    for field, place in group_places(device, name, _answer_names):
        yield place, _description_cell(device, field, ())


def _answer_names(answers: Sequence[Answer]) -> str:
    return code(", ".join(answer.name for answer in answers))


def _description_cell(device: Device, field: Field, layout_source: Sources, in_register: bool = False) -> str:
    """Return a field with all statements about it, and its source unless it is ``layout_source``."""
    description = joined([title_cell(field), field_cell(device, field, in_register)])
    if not field.source or field.source == layout_source:
        return description
    return f"{description} <small>{cited(field.source)}</small>"


def value_tables(register: Register) -> list[list[Row]]:
    """Return rows of value, name and meaning for each field with many named values."""
    return [_value_table(field) for field in register.layout.fields if has_value_table(field)]


def _value_table(field: Field) -> list[Row]:
    return [(number, joined([name, meaning])) for number, name, meaning, _ in value_rows(field)]


def register_rows(device: Device) -> Iterator[Row]:
    """Yield rows of bank, addresses, register."""
    for register in device.registers:
        data = register.default_bytes()
        default = f", default {code(data.hex(' ').upper())}" if data is not None else ""
        register_link = link(text(title(register)), f"#register-{register.name}")
        bank = "" if register.bank is None else f"{register.bank}"
        about = f"{register_link} <small>{code(register.name)}</small> {say_register.access(register)}{default}"
        yield bank, addresses(register), about


def step_sentences(device: Device, procedure: Procedure) -> Iterator[str]:
    """Yield the steps as sentences, each with its reason."""
    for procedure_step in procedure.steps:
        reason = f" ({text(procedure_step.meaning)})" if procedure_step.meaning else ""
        yield STYLE.phrase(step(device, procedure_step)) + reason + "."


def time_rows(timings: Iterable[Timing]) -> Iterator[Row]:
    """Yield rows of duration, time."""
    for timing in timings:
        identifiers = "</small> <small>".join(filter(None, (text(timing.symbol), code(timing.name))))
        about = f"{text(timing.meaning)} <small>{identifiers}</small> <small>{cited(timing.source)}</small>"
        yield text(bounds_with_codes(timing)), about


def example_rows(device: Device, examples: Iterable[Example]) -> Iterator[Row]:
    """Yield rows of example, its facts."""
    for example in examples:
        labelled_values = example_facts(device, example)
        facts = [f"{label}: {value}" for label, value in labelled_values if label not in ("Order code", "Source")]
        source = f" <small>{cited(example.source)}</small>"
        yield anchor(f"example-{example.name}") + text(heading(example.name)), joined(facts) + source


def led_rows(device: Device) -> Iterator[Row]:
    """Yield rows of LED or state, meaning."""
    for led in device.leds:
        yield f"**{text(led.title)}**", f"<small>{cited(led.source)}</small>"
        for state in led.states:
            step_links = (link("Step by step", f"hardware.md#by-hand-{name}") + "." for name in state.by_hand)
            order_codes = [f"Only with {code(state.only)}."] if state.only else []
            yield text(state.state), joined([text(sentence(state.meaning)), *order_codes, *step_links], " ")


def setting_lines(device: Device, interface: Interface) -> Iterator[str]:
    """Yield the settings of the interface, each with its source."""
    for setting in settings(device, interface):
        yield f"{text(setting.label)}: {STYLE.phrase(statement(*setting.parts))} <small>{cited(setting.source)}</small>"
