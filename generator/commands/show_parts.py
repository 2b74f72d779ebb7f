"""Parts of the output of ``codewheel show``: interfaces, frames and registers in lines of at most 80 columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..model import Constant, Device, Field, Interface, Layout, PlacedLayout, Unused, Value, Variant, cite
from ..model.expressions import Expression
from ..order_codes.parameters import run_time_widths
from ..say import field
from ..say import interface as say_interface
from ..say import layout as say_layout
from ..say import register as say_register
from ..say.alternative import answer, needs, question
from ..say.lines import WIDTH, pairs, wrapped
from ..say.parameter import initial
from ..say.place import bits, field_at, hexadecimal
from ..say.text import BY_NAME, Style
from ..say.words import counted
from .decode import bit_place


def at(parameters: Mapping[str, int]) -> Style:
    """Return the style for statements about an order code, with expressions as numbers."""
    return replace(BY_NAME, resolve=lambda expression: Expression(expression.value(parameters)))


def interface_lines(device: Device, interface: Interface) -> list[str]:
    """Return the lines about one interface: clock, times, port, data IDs."""
    facts = say_interface.facts(device, interface)
    rows = [(fact.label, f"{BY_NAME.phrase(fact)}  {BY_NAME.cited(fact.source)}") for fact in facts]
    return [f"{interface.title}  [{cite(interface.source)}]", *pairs(rows, 2)]


# -- frames


def layout_lines(device: Device, interface: Interface, layout: Layout) -> list[str]:
    """Return the lines about a frame of a family: its fields with their widths, one line per group."""
    rows: dict[str, list[str]] = {}
    for layout_field in layout.fields:
        width = layout_field.width.constant if layout_field.width.is_constant else layout_field.width.render()
        rows.setdefault(layout_field.group or layout_field.name, []).append(
            f"{layout_field.name} {width}" if layout_field.group else counted(width, "bit") + _fixed(layout_field)
        )
    return [
        wrapped(
            BY_NAME.sentence(say_layout.head(interface, layout, layout.name, device.alternatives)), WIDTH, "    ", "  "
        ),
        *pairs(((name, ", ".join(parts)) for name, parts in rows.items()), 4),
        *(wrapped(BY_NAME.sentence(fact), WIDTH, "      ", "    ") for fact in say_layout.facts(interface, layout)),
        *(wrapped(BY_NAME.sentence(need), WIDTH, "      ", "    ") for need in needs(device, layout)),
    ]


def _fixed(layout_field: Field) -> str:
    match layout_field.kind:
        case Constant(value):
            return f", always {field.short(value)}"
        case Unused(value):
            return f", unused, {field.short(value)} in the manual"
        case _:
            return ""


def frame_lines(device: Device, layout: Layout, variant: Variant) -> list[str]:
    """Return the lines about a frame of an order code: a title, a picture, and what registers may change in it."""
    interface, placed = device.interface(variant.interface), layout.place(variant.parameters)
    style = at(variant.parameters)
    name = f"{layout.name} ({layout.printed_name})" if layout.printed_name else layout.name
    lines = [
        wrapped(style.sentence(say_layout.head(interface, layout, name, device.alternatives)), WIDTH, "  ", ""),
        *picture(placed),
    ]
    notes = [style.sentence(fact) for fact in say_layout.carries(interface, layout)]
    for alternative in device.alternatives_of(layout):
        picture_note = f"The picture shows {alternative.answers[0].name}."
        notes += [
            f"{style.sentence(need)} {picture_note}"
            for need in needs(replace(device, alternatives=(alternative,)), layout)
        ]
    widths = run_time_widths(device, layout)
    if widths:
        notes.append(
            f"The widths are the {initial(device)} in {' and '.join(field_at(device, path) for path in widths)}."
        )
    if layout.gray_of:
        names = device.needed_parameters([layout.gray_when] if layout.gray_when else [])
        deciding_fields = ", ".join(
            field_at(device, parameter.read_from) for parameter in device.run_time_parameters if parameter.name in names
        )
        decided = f", according to the factory default of {deciding_fields}" if deciding_fields else ""
        notes.append(f"{layout.gray_of} is in {'Gray code' if placed.gray else 'binary'}{decided}.")
    return [*lines, *(wrapped(note, WIDTH, "  ", "  ") for note in notes)]


def picture(placed: PlacedLayout) -> list[str]:
    """Draw the layout as rows of boxes in the order sent, within the width of a terminal."""
    rows: list[tuple[str, str]] = []
    lines: list[str] = []

    def flush() -> None:
        if rows:
            edge = "  +" + "+".join("-" * len(name) for name, _ in rows) + "+"
            lines.extend(
                [
                    "  " + "".join(f" {place}" for _, place in rows).rstrip(),
                    edge,
                    "  |" + "|".join(name for name, _ in rows) + "|",
                    edge,
                ]
            )
            rows.clear()

    used_columns = 3
    for placed_field in placed.fields:
        name = _box(placed_field.field)
        place = bit_place(placed.layout, placed.bits, placed_field.high, placed_field.low)
        width = max(len(name), len(place)) + 2
        if used_columns + width + 1 > WIDTH:
            flush()
            used_columns = 3
        rows.append((name.center(width), place.center(width)))
        used_columns += width + 1
    flush()
    return lines


def _box(layout_field: Field) -> str:
    """Return the text in the box of a field: its name, a constant's value, or both."""
    if not isinstance(layout_field.kind, Constant):
        return layout_field.name
    constant = field.short(layout_field.kind.value)
    return constant if layout_field.padding_of or layout_field.fills_gap else f"{layout_field.name} = {constant}"


def alternative_lines(device: Device) -> list[str]:
    """Return the questions that the manual leaves open, each with its answers."""
    lines: list[str] = []
    for alternative in device.alternatives:
        lines.append(wrapped(BY_NAME.sentence(question(alternative)), WIDTH, "      ", f"  {alternative.name}: "))
        lines += (
            wrapped(BY_NAME.sentence(answer(alternative_answer)), WIDTH, "      ", "    ")
            for alternative_answer in alternative.answers
        )
        example_answer = alternative.answers[1 if alternative.default else 0]
        example = f"Give decode the answer with --choose {alternative.name}={example_answer.name}"
        default = f"{alternative.default} applies without a choice. " if alternative.default else ""
        lines.append(wrapped(default + example, WIDTH, "      ", "    "))
    return ["", "Left open by the manual, for you to choose", *lines] if lines else []


# -- registers


def register_lines(device: Device, variant: Variant | None) -> list[str]:
    """Return one paragraph per register, for an order code with its fields."""
    if not device.registers:
        return []
    style = at(variant.parameters) if variant is not None else BY_NAME
    lines = ["", "Registers"]
    for register in device.registers:
        head = style.sentence(say_register.head(device, register, register.name))
        lines += [wrapped(head, WIDTH, "    ", "  ")]
        fields = register.layout.fields
        facts = [*say_register.facts(device, register), *(field.rules(device, fields[0]) if len(fields) == 1 else ())]
        lines += [wrapped(style.paragraph(facts), WIDTH, "    ")] if facts else []
        if variant is not None and len(fields) > 1:
            placed = register.layout.place(variant.parameters)
            lines += pairs(
                ((bits(part.high, part.low), _field(device, part.field, style)) for part in placed.fields), 4
            )
        lines += pairs(((hexadecimal(choice.value), _choice(choice)) for choice in register.values), 4)
    return lines


def _choice(choice: Value) -> str:
    """Return the name of a register's value with the first sentence of its meaning."""
    meaning = choice.meaning.partition(". ")[0]
    return f"{choice.name}: {meaning}" if meaning else choice.name


def _field(device: Device, register_field: Field, style: Style) -> str:
    rules = field.rules(device, register_field)
    text = style.paragraph([field.choices(register_field.values), *rules] if register_field.values else rules)
    return f"{register_field.name}: {text}" if text else register_field.name
