"""Tables with two columns for the page of an order code, which fit on a phone: a place or value, and all about it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...model import Device, Example, Field, FieldGroup, Interface, Layout, Procedure, Register, Sources, Timing
from ...say import register as say_register
from ...say.interface import settings
from ...say.markdown import STYLE, anchor, cited, code, joined, link, text
from ...say.name import Titled, heading, title
from ...say.place import addresses
from ...say.procedure import step
from ...say.text import statement
from ...say.timing import bounds_with_codes
from ...say.words import counted, sentence
from .fact_tables import example_facts
from .layout_tables import (
    field_cell,
    field_place_cell,
    group_place,
    group_places,
    has_value_table,
    in_rows,
    value_rows,
)

Row = tuple[str, ...]


def titled(titled_part: Titled) -> str:
    """Return a title in words, with the identifier for programmers in small type."""
    return f"{text(title(titled_part))} <small>{code(titled_part.name)}</small>"


def field_rows(device: Device, layout: Layout) -> Iterator[Row]:
    """Yield rows of place, field. A group of fields is one row with a link to its table."""
    for field_or_group in in_rows(device, layout):
        if isinstance(field_or_group, FieldGroup):
            names = ", ".join(code(field.name) for field in layout.fields if field.group == field_or_group.name)
            to = link(text(heading(field_or_group.name)), f"#group-{field_or_group.name}")
            yield (
                group_place(device, layout, field_or_group),
                f"{to} <small>{code(field_or_group.name)}</small>: {names}",
            )
        else:
            place = field_place_cell(layout, field_or_group, device.alternatives_of(layout))
            size = counted(STYLE.number(field_or_group.width), "bit") if field_or_group.container else ""
            yield (
                joined([place, size]),
                _described(device, field_or_group, layout.source, in_register=not layout.sender),
            )


def group_rows(device: Device, name: str) -> Iterator[Row]:
    """Yield rows of place, field for a group of fields."""
    for field, where in group_places(device, name, lambda answers: code(", ".join(answer.name for answer in answers))):
        yield where, _described(device, field, ())


def _described(device: Device, field: Field, layout_source: Sources, in_register: bool = False) -> str:
    """Return a field with all statements about it, and its source unless it is ``layout_source``."""
    about = joined([titled(field), field_cell(device, field, in_register)])
    return about + (f" <small>{cited(field.source)}</small>" if field.source and field.source != layout_source else "")


def value_tables(register: Register) -> list[list[Row]]:
    """Return rows of value, name and meaning for each field with many named values."""
    return [
        [(number, joined([name, meaning])) for number, name, meaning, _ in value_rows(field)]
        for field in register.layout.fields
        if has_value_table(field)
    ]


def register_rows(device: Device) -> Iterator[Row]:
    """Yield rows of bank, addresses, register."""
    for register in device.registers:
        data = register.default_bytes()
        default = f", default {code(data.hex(' ').upper())}" if data is not None else ""
        to = f"{link(text(title(register)), f'#register-{register.name}')} <small>{code(register.name)}</small>"
        bank = "" if register.bank is None else f"{register.bank}"
        yield bank, addresses(register), f"{to} {say_register.access(register)}{default}"


def steps(device: Device, procedure: Procedure) -> Iterator[str]:
    """Yield the steps as sentences, each with its reason."""
    for procedure_step in procedure.steps:
        reason = f" ({text(procedure_step.meaning)})" if procedure_step.meaning else ""
        yield STYLE.phrase(step(device, procedure_step)) + reason + "."


def time_rows(timings: Iterable[Timing]) -> Iterator[Row]:
    """Yield rows of duration, time."""
    for timing in timings:
        names = "</small> <small>".join(filter(None, (text(timing.symbol), code(timing.name))))
        yield (
            text(bounds_with_codes(timing)),
            f"{text(timing.meaning)} <small>{names}</small> <small>{cited(timing.source)}</small>",
        )


def example_rows(device: Device, examples: Iterable[Example]) -> Iterator[Row]:
    """Yield rows of example, its facts."""
    for example in examples:
        facts = [
            f"{label}: {value}"
            for label, value in example_facts(device, example)
            if label not in ("Order code", "Source")
        ]
        source = f" <small>{cited(example.source)}</small>"
        yield anchor(f"example-{example.name}") + text(heading(example.name)), joined(facts) + source


def led_rows(device: Device) -> Iterator[Row]:
    """Yield rows of LED or state, meaning."""
    for led in device.leds:
        yield f"**{text(led.title)}**", f"<small>{cited(led.source)}</small>"
        for state in led.states:
            hands = (link("Step by step", f"hardware.md#by-hand-{name}") + "." for name in state.by_hand)
            codes = [f"Only with {code(state.only)}."] if state.only else []
            yield text(state.state), joined([text(sentence(state.meaning)), *codes, *hands], " ")


def setting_lines(device: Device, interface: Interface) -> Iterator[str]:
    """Yield the settings of the interface, each with its source."""
    for setting in settings(device, interface):
        yield f"{text(setting.label)}: {STYLE.phrase(statement(*setting.parts))} <small>{cited(setting.source)}</small>"
