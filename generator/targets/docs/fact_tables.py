"""Tables of facts, except about layouts: wide tables for interface pages, and two columns for pages of order codes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import (
    Answer,
    Biss,
    Crc,
    CrcExample,
    Device,
    Document,
    Erratum,
    Example,
    Field,
    FieldGroup,
    FrameExample,
    Interface,
    Layout,
    MeasureExample,
    Procedure,
    ProcedureExample,
    Register,
    RegisterExample,
    Scale,
    Sources,
    Supply,
    Timing,
    Variant,
    assert_never,
)
from ...plan.procedures import plan_procedure
from ...plan.steps import VerifyWrite
from ...say import count_with_unit, group_digits, quantity_text
from ...say import register as say_register
from ...say.commands_and_alarms import describe_step, read_back
from ...say.errata import content_before_and_after, errata_affecting
from ...say.layout import crc_sent, describe_measurement, describe_position_range, own_ranges
from ...say.names_and_evidence import Titled, addresses_text, heading, hexadecimal, title_of
from ...say.order_code import bounds_with_codes, describe_settings
from ...say.register import describe_value
from ...say.text import (
    MARKDOWN,
    anchor_of,
    as_sentence,
    citation,
    code_span,
    escape,
    join_filled,
    markdown_link,
    statement,
    volts,
)
from .layout_tables import (
    field_cell,
    field_place_cell,
    fields_and_groups,
    group_place,
    group_places,
    has_value_table,
    name_cell,
    value_rows,
)
from .links_and_errata import ERRATA
from .order_code_tables import order_codes

_SEVERITY_TEXTS = {
    "wrong_data": "wrong bytes or bits on the wire",
    "wrong_limit": "a wrong limit or order code",
    "omission": "missing information",
    "wording": "wording only",
}
SEVERITIES = tuple(_SEVERITY_TEXTS)


def interface_rows(device: Device, interface: Interface) -> Iterator[tuple[str, str, str]]:
    """Yield rows of fact, value, source for the settings of an interface."""
    for setting in describe_settings(device, interface):
        yield escape(setting.label), MARKDOWN.phrase(setting), citation(setting.source)


def step_rows(device: Device, procedure: Procedure) -> Iterator[tuple[str, ...]]:
    """Yield rows of number, instruction, reason, source for the steps of a procedure.

    A check that only generated code makes has no number.
    """
    step_number = 0
    for planned_step in plan_procedure(device, procedure).operations:
        if isinstance(planned_step, VerifyWrite):
            field_name = planned_step.field.name if planned_step.field is not None else ""
            instruction = MARKDOWN.sentence(read_back(device, planned_step.register, field_name))
            reason = "Generated code adds this step, because a corrupted write can look successful."
            yield "", instruction, reason, ""
            continue
        step_number += 1
        spec_step = planned_step.step
        source = citation(spec_step.source) if spec_step.source != procedure.source else ""
        yield (
            f"{step_number}",
            MARKDOWN.sentence(describe_step(device, spec_step)),
            escape(spec_step.meaning),
            source,
        )


def timing_rows(timings: tuple[Timing, ...]) -> Iterator[tuple[str, ...]]:
    """Yield rows of name, meaning, duration, source."""
    for timing in timings:
        duration = escape(bounds_with_codes(timing))
        yield (
            join_filled([code_span(timing.name), escape(timing.symbol)]),
            escape(timing.meaning),
            duration,
            citation(timing.source),
        )


def crc_rows(device: Device, crc: Crc) -> Iterator[tuple[str, str]]:
    """Yield the parameters of a CRC as label and value, with the polynomial in every notation that masters expect."""
    polynomial_with_top_bit = crc.poly_with_top_bit
    is_input_reflected = _yes_or_no(device.reflects_input(crc))
    is_output_reflected = _yes_or_no(crc.refout)
    # In the notation of manuals, such as "x^6 + x + 1".
    yield "Polynomial", escape(crc.polynomial)
    yield (
        "with its top bit",
        f"`0x{polynomial_with_top_bit:X}` = {polynomial_with_top_bit} = `{polynomial_with_top_bit:b}b`",
    )
    yield "without its top bit", f"`0x{crc.poly:02X}`"
    if polynomial_with_top_bit & 1:
        yield "without its trailing 1 (Koopman notation)", f"`0x{polynomial_with_top_bit >> 1:X}`"
    yield "Width", count_with_unit(crc.width, "bit")
    yield "Start value", f"`0x{crc.init:X}`"
    yield "Input, output reflected", f"{is_input_reflected}, {is_output_reflected}"
    yield "Final XOR", f"`0x{crc.xorout:X}` ({crc_sent(crc)})"
    if crc.is_xor:
        yield "In short", "XOR of the preceding bytes"


def _yes_or_no(is_true: bool) -> str:
    return "yes" if is_true else "no"


def example_facts(device: Device, example: Example) -> Iterator[tuple[str, str]]:
    """Yield the facts of a worked example as label and value.

    The erratum that an example refers to is linked here, unless the page lists it next to the example anyway.
    """
    for label, content in _facts_and_empty_facts(device, example):
        if content:
            yield label, content
    listed_errata = {erratum.name for erratum in errata_affecting(device, f"examples.{example.name}", wording=True)}
    if example.erratum and example.erratum not in listed_errata:
        title_by_erratum = {erratum.name: erratum.title for erratum in device.errata}
        title = title_by_erratum[example.erratum]
        yield "Erratum", markdown_link(escape(title), f"{ERRATA}#erratum-{example.erratum}")
    if example.note:
        yield "Note", escape(example.note)
    yield "Source", citation(example.source)


def _facts_and_empty_facts(device: Device, example: Example) -> Iterator[tuple[str, str]]:
    """Yield the facts of an example as label and value. The value is empty if the example does not have this fact."""
    match example:
        case FrameExample():
            if example.layout:
                yield "Frame", markdown_link(code_span(example.layout), f"#layout-{example.layout}")
            yield "Order code", code_span(example.order_code)
            yield "Sent by", f"the {example.sender}"
            for question, answer in example.alternatives.items():
                question_link = markdown_link(code_span(question), f"#alternative-{question}")
                yield "Alternative", f"{question_link} = {code_span(answer)}"
            yield _bytes_fact(example.bytes)
            yield "Bits", code_span(example.bits)
            layouts = [layout for _, layout in device.layouts() if layout.name == example.layout]
            yield _values_fact(example.values, layouts)
            if example.refused:
                yield "Rejected", f"because of its {escape(example.refused)}"
        case RegisterExample():
            yield "Register", markdown_link(code_span(example.register), f"#register-{example.register}")
            yield "Order code", code_span(example.order_code)
            yield _bytes_fact(example.bytes)
            register = device.register(example.register)
            yield _values_fact(example.values, [register.layout])
        case CrcExample():
            yield "CRC", markdown_link(code_span(example.crc), f"#crc-{example.crc}")
            yield _bytes_fact(example.bytes)
            yield "Check value", f"`{hexadecimal(example.check)}`"
        case ProcedureExample():
            yield from _facts_of_procedure_example(example)
        case MeasureExample():
            yield "Order code", code_span(example.order_code)
            yield "Length", f"{group_digits(example.counts)} counts are {group_digits(example.micrometres)} µm"
        case _:
            assert_never(example)


def _facts_of_procedure_example(example: ProcedureExample) -> Iterator[tuple[str, str]]:
    """Yield as label and value: the procedure, the order code, the arguments, and the bytes that it writes."""
    yield "Procedure", markdown_link(code_span(example.procedure), f"#procedure-{example.procedure}")
    yield "Order code", code_span(example.order_code)
    for argument, value in example.arguments.items():
        # A single digit is the same in both notations.
        hexadecimal_text = f" ({hexadecimal(value)})" if value > 9 else ""
        yield f"Argument {code_span(argument)}", f"{group_digits(value)}{hexadecimal_text}"
    writes = [f"`{write.address:02X}h: {write.value:02X}`" for write in example.writes]
    yield "Writes", ", ".join(writes)


def _bytes_fact(data: bytes) -> tuple[str, str]:
    """Return the label and the bytes of an example in hexadecimal."""
    hexadecimal_bytes = f"`{data.hex(' ').upper()}`" if data else ""
    return "Bytes", hexadecimal_bytes


def _values_fact(values: Mapping[str, int | str | bool], layouts: Iterable[Layout]) -> tuple[str, str]:
    """Return the label and the field values of an example, with quantities for fields that have a scale in a layout."""
    scale_by_field = {field.name: field.scale for layout in layouts for field in layout.fields}
    assignments = []
    for field_name, value in values.items():
        value_text = _value_text(value, scale_by_field.get(field_name))
        assignments.append(f"{code_span(field_name)} = {value_text}")
    return "Values", ", ".join(assignments)


def _value_text(value: int | str | bool, scale: Scale | None) -> str:
    """Return a value of a worked example as text, with its quantity if it has a scale."""
    if isinstance(value, bool):
        return _yes_or_no(value)
    if not isinstance(value, int):
        return code_span(value)
    if scale is None:
        return group_digits(value)
    return f"{group_digits(value)} ({escape(quantity_text(scale, value))})"


def printed_and_used_rows(erratum: Erratum) -> Iterator[tuple[str, str]]:
    """Yield the printed text and the value used, or the parts of a change by an overlay or edition, with labels."""
    if erratum.overlay:
        yield "Overlay", code_span(erratum.overlay)
    if erratum.edition:
        yield "Edition", escape(erratum.edition)
    if erratum.overlay or erratum.edition:
        yield from ((label, escape(change_text)) for label, change_text in content_before_and_after(erratum))
    else:
        yield "Printed", escape(erratum.printed)
        yield "Used", escape(erratum.used)


def sentence_on_changes(count: int) -> str:
    """Return a sentence on the changes by overlays and other editions, or an empty string if there are none."""
    return f" {count} more entries are changes in overlays or other editions." if count else ""


def severity_text(severity: str) -> str:
    return _SEVERITY_TEXTS[severity]


def document_rows(documents: Iterable[Document]) -> list[tuple[str, ...]]:
    """Return rows of key, title, address."""
    return [_document_row(document) for document in documents]


def _document_row(document: Document) -> tuple[str, ...]:
    """Return a row of key, title, address. The address is empty for a document that is not public."""
    address = f"<{document.url}>" if document.url else ""
    return code_span(document.key), escape(document.title), address


def control_rows(interface: Biss) -> Iterator[tuple[str, ...]]:
    """Yield rows of name, number of bits, meaning, source for the fields of the BiSS control frame."""
    for control_field in interface.control_data:
        value_statements = [describe_value(named_value, control_field.bits) for named_value in control_field.values]
        value_phrases = map(MARKDOWN.phrase, value_statements)
        crc_link = markdown_link(code_span(control_field.crc), f"#crc-{control_field.crc}") if control_field.crc else ""
        yield (
            name_cell(control_field),
            f"{control_field.bits}",
            join_filled([escape(control_field.meaning), crc_link, *value_phrases]),
            citation(control_field.source),
        )


Row = tuple[str, ...]


def title_cell(titled_part: Titled) -> str:
    """Return the title of an item, followed by its name in programs in small type."""
    return f"{escape(title_of(titled_part))} <small>{code_span(titled_part.name)}</small>"


def field_rows(device: Device, layout: Layout) -> Iterator[Row]:
    """Yield rows of place, field. A group of fields has one row, with a link to its table."""
    for field_or_group in fields_and_groups(device, layout):
        if isinstance(field_or_group, FieldGroup):
            yield group_place(device, layout, field_or_group), _group_cell(layout, field_or_group)
        else:
            description = _description_cell(device, field_or_group, layout.source, in_register=not layout.sender)
            yield _place_cell(device, layout, field_or_group), description


def _place_cell(device: Device, layout: Layout, field: Field) -> str:
    """Return the place of a field. If the field has padding, the place includes it, and the field's width follows."""
    place = field_place_cell(layout, field, device.alternatives_of(layout))
    width = count_with_unit(MARKDOWN.number(field.width), "bit") if field.container else ""
    return join_filled([place, width])


def _group_cell(layout: Layout, field_group: FieldGroup) -> str:
    """Return a link to the table of a group of fields, followed by the names of the fields."""
    group_link = markdown_link(escape(heading(field_group.name)), f"#group-{field_group.name}")
    field_names = ", ".join(code_span(field.name) for field in layout.fields if field.group == field_group.name)
    return f"{group_link} <small>{code_span(field_group.name)}</small>: {field_names}"


def group_rows(device: Device, name: str) -> Iterator[Row]:
    """Yield rows of place, field for a group of fields."""
    for field, place in group_places(device, name, _answer_names):
        yield place, _description_cell(device, field, ())


def _answer_names(answers: Sequence[Answer]) -> str:
    """Return the names of answers as one piece of code: ```normal, binary```."""
    return code_span(", ".join(answer.name for answer in answers))


def _description_cell(device: Device, field: Field, layout_source: Sources, in_register: bool = False) -> str:
    """Return a field with all statements about it, and its source if that differs from the source of its layout."""
    description = join_filled([title_cell(field), field_cell(device, field, in_register)])
    if not field.source or field.source == layout_source:
        return description
    return f"{description} <small>{citation(field.source)}</small>"


def value_tables(register: Register) -> list[list[Row]]:
    """Return a table of values and their meanings for each field that has many named values."""
    return [_value_table(field) for field in register.layout.fields if has_value_table(field)]


def _value_table(field: Field) -> list[Row]:
    """Return rows of value, name with meaning."""
    return [(number, join_filled([name, meaning])) for number, name, meaning, _ in value_rows(field)]


def register_rows(device: Device) -> Iterator[Row]:
    """Yield rows of bank, addresses, register. The bank is empty for a register without a bank."""
    for register in device.registers:
        default_text = ""
        default_bytes = register.default_bytes()
        if default_bytes is not None:
            default_text = f", default {code_span(default_bytes.hex(' ').upper())}"
        register_link = markdown_link(escape(title_of(register)), f"#register-{register.name}")
        bank_text = "" if register.bank is None else f"{register.bank}"
        access = say_register.describe_access(register)
        register_cell = f"{register_link} <small>{code_span(register.name)}</small> {access}{default_text}"
        yield bank_text, addresses_text(register), register_cell


def step_sentences(device: Device, procedure: Procedure) -> Iterator[str]:
    """Yield the steps of a procedure as sentences, each with its reason in parentheses."""
    for procedure_step in procedure.steps:
        instruction = MARKDOWN.phrase(describe_step(device, procedure_step))
        reason = f" ({escape(procedure_step.meaning)})" if procedure_step.meaning else ""
        yield f"{instruction}{reason}."


def time_rows(timings: Iterable[Timing]) -> Iterator[Row]:
    """Yield rows of duration, time."""
    for timing in timings:
        symbol = f"<small>{escape(timing.symbol)}</small> " if timing.symbol else ""
        name = f"<small>{code_span(timing.name)}</small>"
        source = f"<small>{citation(timing.source)}</small>"
        duration = escape(bounds_with_codes(timing))
        yield duration, f"{escape(timing.meaning)} {symbol}{name} {source}"


def example_rows(device: Device, examples: Iterable[Example]) -> Iterator[Row]:
    """Yield rows of example, facts with their source. The order code is omitted, because the page is about it."""
    for example in examples:
        fact_lines = []
        for label, value in example_facts(device, example):
            if label not in ("Order code", "Source"):
                fact_lines.append(f"{label}: {value}")
        anchor = anchor_of(f"example-{example.name}")
        title = escape(heading(example.name))
        source = f"<small>{citation(example.source)}</small>"
        yield f"{anchor}{title}", f"{join_filled(fact_lines)} {source}"


def led_rows(device: Device) -> Iterator[Row]:
    """Yield for each LED a row of name, source, and then rows of state, meaning."""
    for led in device.leds:
        yield f"**{escape(led.title)}**", f"<small>{citation(led.source)}</small>"
        for state in led.states:
            sentences = [escape(as_sentence(state.meaning))]
            if state.only:
                sentences.append(f"This applies only to {code_span(state.only)}.")
            for procedure_name in state.by_hand:
                steps_link = markdown_link("Step by step", f"hardware.md#by-hand-{procedure_name}")
                sentences.append(f"{steps_link}.")
            yield escape(state.state), join_filled(sentences, " ")


def setting_lines(device: Device, interface: Interface) -> Iterator[str]:
    """Yield the settings of an interface as lines, each with its source."""
    for setting in describe_settings(device, interface):
        value = MARKDOWN.phrase(statement(*setting.parts))
        yield f"{escape(setting.label)}: {value} <small>{citation(setting.source)}</small>"


def overview_rows(device: Device, interface: Interface, variants: Sequence[Variant]) -> Iterator[Row]:
    """Yield rows of fact, value, source: the unit and range of the position, the supplies, the interface's facts."""
    position_measurement = device.measurement_of(interface.name)
    if position_measurement is not None:
        resolution_and_range = MARKDOWN.phrase(describe_measurement(position_measurement))
        yield "Position", resolution_and_range, citation(position_measurement.source)
        for layout_name, range_of_layout in own_ranges(device, interface.name):
            range_text = MARKDOWN.phrase(describe_position_range(range_of_layout))
            yield f"Position in {code_span(layout_name)}", range_text, citation(range_of_layout.source)
    for supply, codes in _codes_by_supply(device, variants).items():
        has_all_codes = len(codes) == len(variants)
        label = "Supply" if has_all_codes else f"Supply ({order_codes(device, codes)})"
        voltage_range = f"{volts(supply.min_mv)} to {volts(supply.max_mv)}"
        yield label, voltage_range, citation(supply.source)
    yield from interface_rows(device, interface)


def _codes_by_supply(device: Device, variants: Iterable[Variant]) -> dict[Supply, list[str]]:
    """Return the order codes that have each supply. Order codes whose supply is unknown are omitted."""
    codes_by_supply: dict[Supply, list[str]] = {}
    for variant in variants:
        supply = device.supply_of(variant)
        if supply is not None:
            codes_by_supply.setdefault(supply, []).append(variant.code)
    return codes_by_supply
