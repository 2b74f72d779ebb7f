"""Tables with two columns for the page of an order code, which fit on a phone: a place or value, and all about it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...model import Device, Example, Field, Interface, Layout, Procedure, Register, Sources, Timing
from ...say import register as say_register
from ...say.interface import settings
from ...say.markdown import STYLE, anchor, cited, code, joined, link, text
from ...say.name import Titled, heading, title
from ...say.place import addresses, bits
from ...say.procedure import step
from ...say.text import said
from ...say.timing import bounds
from ...say.words import counted, sentence
from .fact_tables import example_facts
from .layout_tables import field_cell, field_place_cell, group_place, group_shapes, has_value_table, value_rows

Row = tuple[str, ...]


def titled(item: Titled) -> str:
    """Return a title in words, with the identifier for programmers in small type."""
    return f"{text(title(item))} <small>{code(item.name)}</small>"


def field_rows(device: Device, layout: Layout) -> Iterator[Row]:
    """Yield rows of place, field. A group of fields is one row with a link to its table."""
    groups = {group.name: group for group in device.field_groups}
    done: set[str] = set()
    there = {field.name for field in layout.fields}
    for field in layout.fields:
        if field.group in groups:
            if field.group not in done:
                done.add(field.group)
                group = groups[field.group]
                names = ", ".join(code(item.name) for item in layout.fields if item.group == group.name)
                to = link(text(heading(group.name)), f"#group-{group.name}")
                yield group_place(device, layout, group), f"{to} <small>{code(group.name)}</small>: {names}"
        elif field.padding_of not in there:
            place = field_place_cell(layout, field, device.alternatives_of(layout))
            size = counted(STYLE.number(field.width), "bit") if field.container else ""
            yield joined([place, size]), _described(device, field, layout.source, in_register=not layout.sender)


def group_rows(device: Device, name: str) -> Iterator[Row]:
    """Yield rows of place, field for a group of fields."""
    shapes = group_shapes(device, name)
    for field, _, _ in shapes[0][1]:
        places: dict[str, str] = {}
        for answers, fields in shapes:
            place = next(bits(high, low) for other, high, low in fields if other is field)
            places.setdefault(place, ", ".join(item.name for item in answers))
        several = len(places) > 1
        where = joined(f"{place} ({code(answer)})" if several else place for place, answer in places.items())
        yield where, _described(device, field, ())


def _described(device: Device, field: Field, known: Sources, in_register: bool = False) -> str:
    """Return a field with all statements about it, and its source unless it is ``known``."""
    about = joined([titled(field), field_cell(device, field, in_register)])
    return about + (f" <small>{cited(field.source)}</small>" if field.source and field.source != known else "")


def value_tables(register: Register) -> list[list[Row]]:
    """Return rows of value, name and meaning for each field with many named values."""
    return [
        [(number, joined([name, meaning])) for number, name, meaning, _ in value_rows(field)]
        for field in register.layout.fields
        if has_value_table(field)
    ]


def register_rows(device: Device) -> Iterator[Row]:
    """Yield rows of bank, addresses, register."""
    for item in device.registers:
        data = item.default_bytes()
        default = f", default {code(data.hex(' ').upper())}" if data is not None else ""
        to = f"{link(text(title(item)), f'#register-{item.name}')} <small>{code(item.name)}</small>"
        bank = "" if item.bank is None else f"{item.bank}"
        yield bank, addresses(item), f"{to} {say_register.access(item)}{default}"


def steps(device: Device, procedure: Procedure) -> Iterator[str]:
    """Yield the steps as sentences, each with its reason."""
    for item in procedure.steps:
        reason = f" ({text(item.meaning)})" if item.meaning else ""
        yield STYLE.phrase(step(device, item)) + reason + "."


def time_rows(timings: Iterable[Timing]) -> Iterator[Row]:
    """Yield rows of duration, time."""
    for item in timings:
        names = "</small> <small>".join(filter(None, (text(item.symbol), code(item.name))))
        yield bounds(item), f"{text(item.meaning)} <small>{names}</small> <small>{cited(item.source)}</small>"


def example_rows(device: Device, examples: Iterable[Example]) -> Iterator[Row]:
    """Yield rows of example, its facts."""
    for item in examples:
        facts = [
            f"{label}: {value}" for label, value in example_facts(device, item) if label not in ("Order code", "Source")
        ]
        source = f" <small>{cited(item.source)}</small>"
        yield anchor(f"example-{item.name}") + text(heading(item.name)), joined(facts) + source


def led_rows(device: Device) -> Iterator[Row]:
    """Yield rows of LED or state, meaning."""
    for item in device.leds:
        yield f"**{text(item.title)}**", f"<small>{cited(item.source)}</small>"
        for state in item.states:
            hands = (link("Step by step", f"hardware.md#by-hand-{name}") + "." for name in state.by_hand)
            yield text(state.state), joined([text(sentence(state.meaning)), *hands], " ")


def setting_lines(device: Device, interface: Interface) -> Iterator[str]:
    """Yield the settings of the interface, each with its source."""
    for item in settings(device, interface):
        yield f"{text(item.label)}: {STYLE.phrase(said(*item.parts))} <small>{cited(item.source)}</small>"
