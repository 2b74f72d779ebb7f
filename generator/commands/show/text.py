"""Text of ``codewheel show`` about a family or an order code, in lines of at most 80 columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ...model import (
    Alternative,
    Constant,
    Device,
    Field,
    Interface,
    Layout,
    Measurement,
    Parameter,
    PlacedLayout,
    Register,
    Sources,
    Unused,
    Value,
    Variant,
    cite,
)
from ...model.expressions import Expression
from ...order_codes.labels import LabelMatch
from ...order_codes.parameters import parameters_of, run_time_names, run_time_widths, with_sent_layouts
from ...order_codes.quantities import with_quantities
from ...order_codes.reduction import for_interface, reduced_to_codes
from ...say import WIDTH, decimal, two_columns, wrap_text
from ...say import errata as say_errata
from ...say import layout as say_layout
from ...say import order_code as say_order_code
from ...say import register as say_register
from ...say.errata import describe_answer as say_answer
from ...say.errata import describe_question, needed_answers
from ...say.names_and_evidence import bits, describe_grade, differences_from_manual, field_at, hexadecimal, short_number
from ...say.order_code import describe_spelling, not_on_label, open_values
from ...say.text import PLAIN_STYLE, Style, count_with_unit, language_name
from ..decode.text import label_differences
from .picture import picture


def device_text(device: Device) -> str:
    """Return the text about a family: order codes, interfaces, registers, procedures and errata."""
    lines = [wrap_text(f"{device.title} ({device.manufacturer.title})", WIDTH)]
    lines += [*_manual_lines(device), *_order_code_lines(device)]
    parameters = [(parameter.name, _about_parameter(device, parameter)) for parameter in device.parameters]
    if parameters:
        lines += ["", "Parameters", *two_columns(parameters, indent=2)]
    lines += alternative_lines(device)
    measurements = [("", device.measurement)]
    measurements += [(interface.title, interface.measurement) for interface in device.interfaces]
    # A family has no values for parameters, so expressions are shown as text.
    lines += _position_lines(measurements, parameters=None)
    for interface in device.interfaces:
        lines += _range_lines(device, interface.name, parameters=None)
    for interface in device.interfaces:
        lines += ["", *interface_lines(device, interface)]
        for layout in interface.layouts:
            lines += layout_lines(device, interface, layout)
    lines += [*register_lines(device, variant=None), *_input_and_procedure_lines(device), *_errata_lines(device)]
    return "\n".join(lines)


def variant_text(device: Device, code_match: LabelMatch) -> str:
    """Return the text about an order code: its parameters, interface, frames, registers, procedures and errata."""
    variant = code_match.variant
    reduced_device = reduced_to_codes(for_interface(device, variant.interface), [variant.code])
    lines = [wrap_text(f"{variant.code}: {device.title} ({device.manufacturer.title})", WIDTH, prefix="  ", first="")]
    lines += [*label_differences(device, code_match), *_manual_lines(device), *_parameter_lines(device, variant)]
    lines += alternative_lines(reduced_device)
    lines += _position_lines([("", device.measurement_of(variant.interface))], variant.parameters)
    lines += _range_lines(reduced_device, variant.interface, variant.parameters)
    interface = with_sent_layouts(reduced_device.interface(variant.interface), variant.parameters)
    interface_with_numbers = with_quantities(reduced_device, variant).interface(variant.interface)
    lines += ["", *interface_lines(reduced_device, interface_with_numbers)]
    for layout in interface.layouts:
        lines += ["", *frame_lines(reduced_device, layout, variant)]
    lines += register_lines(reduced_device, variant)
    lines += [*_input_and_procedure_lines(reduced_device), *_errata_lines(reduced_device)]
    return "\n".join(lines)


def style_with(parameters: Mapping[str, int] | None) -> Style:
    """Return a style that shows expressions as numbers with the parameters of an order code, or as text if None."""
    if parameters is None:
        return PLAIN_STYLE
    return replace(PLAIN_STYLE, resolve=lambda expression: Expression(expression.value(parameters)))


def _manual_lines(device: Device) -> list[str]:
    """Return the lines about the manual, its other editions, and the evidence for the facts."""
    manual = device.manual
    date = f" of {manual.date}" if manual.date else ""
    language = language_name(manual.language)
    sentences = [f"from the manual {manual.title}, revision {manual.revision}{date}, in {language}"]
    sentences += map(PLAIN_STYLE.sentence, (describe_grade(device), *differences_from_manual(device)))
    if device.editions:
        revisions = ", ".join(edition.revision for edition in device.editions)
        sentences.append(f"--edition shows the others: {revisions}")
    return [wrap_text(sentence, WIDTH, prefix="  ") for sentence in sentences]


def _order_code_lines(device: Device) -> Iterator[str]:
    """Yield the pattern of the order codes, the values of each part, the rule for unlisted values, and spellings."""
    yield ""
    yield f"Order codes: {device.order_code.pattern}"
    for statement in not_on_label(device):
        yield wrap_text(PLAIN_STYLE.sentence(statement), WIDTH, prefix="    ", first="  ")
    for code_part in device.order_code.parts:
        yield wrap_text(code_part.meaning, WIDTH, prefix="    ", first=f"  {code_part.name}: ")
        texts_and_meanings = [(value.text, value.meaning) for value in code_part.values]
        yield from two_columns(texts_and_meanings, indent=4)
        for statement in open_values(code_part):
            yield _indented_paragraph(PLAIN_STYLE.sentence(statement))
    for label_spelling in device.order_code.also_written:
        spelling_sentence = PLAIN_STYLE.sentence(describe_spelling(label_spelling))
        yield wrap_text(spelling_sentence, WIDTH, prefix="    ", first="  ")


def _indented_paragraph(text: str) -> str:
    """Return a wrapped text below a heading. Its lines after the first are indented further."""
    return wrap_text(text, WIDTH, prefix="      ", first="    ")


# -- parameters and questions


def _parameter_lines(device: Device, variant: Variant) -> list[str]:
    """Return a section about the fixed parameters of an order code, and one about parameters that registers hold."""
    parameters = parameters_of(device, variant.interface)
    run_time_parameter_names = run_time_names(device)
    # These are parameters that a register holds, and parameters that are calculated from them.
    run_time_parameters = [parameter for parameter in parameters if parameter.name in run_time_parameter_names]
    # The user chooses parameters of alternatives, so they are listed with the questions.
    other_parameters = [parameter for parameter in parameters if parameter not in run_time_parameters]
    fixed_parameters = [parameter for parameter in other_parameters if not parameter.alternative]
    lines = []
    if fixed_parameters:
        lines += ["", "Parameters", *_value_lines(device, fixed_parameters, variant)]
    if run_time_parameters:
        heading = f"Held in registers ({say_order_code.words_for_initial_values(device)})"
        lines += ["", heading, *_value_lines(device, run_time_parameters, variant)]
        # A calculated parameter has no register of its own.
        register_names = [parameter.register for parameter in run_time_parameters if parameter.read_from]
        example = f"--register 0x{device.register(register_names[0]).address:02X}=0x.."
        lines.append(wrap_text(f"decode accepts other values, one byte at a time: {example}", WIDTH, prefix="  "))
    return lines


def _value_lines(device: Device, parameters: Sequence[Parameter], variant: Variant) -> list[str]:
    """Return lines in columns about parameters: ``singleturn_bits  17  Bits of one revolution``.

    Each line contains the name, the value for the order code, and the wrapped meaning.
    """
    values = [say_order_code.parameter_value(parameter, variant.parameters[parameter.name]) for parameter in parameters]
    name_width = max(len(parameter.name) for parameter in parameters)
    value_width = max(map(len, values))
    rows_of_parameters = []
    for parameter, value_text in zip(parameters, values, strict=True):
        name_and_value = f"{parameter.name.ljust(name_width)}  {value_text.ljust(value_width)}"
        rows_of_parameters.append((name_and_value, _about_parameter(device, parameter)))
    return two_columns(rows_of_parameters, indent=2)


def _about_parameter(device: Device, parameter: Parameter) -> str:
    return PLAIN_STYLE.paragraph(say_order_code.describe_parameter(device, parameter))


def alternative_lines(device: Device) -> list[str]:
    """Return the questions that the manual leaves open, each with its answers."""
    if not device.alternatives:
        return []
    lines = ["", "Left open by the manual, for you to choose"]
    for alternative in device.alternatives:
        question = PLAIN_STYLE.sentence(describe_question(alternative))
        lines.append(wrap_text(question, WIDTH, prefix="      ", first=f"  {alternative.name}: "))
        for answer in alternative.answers:
            answer_sentence = PLAIN_STYLE.sentence(say_answer(answer))
            lines.append(_indented_paragraph(answer_sentence))
        lines.append(_indented_paragraph(_how_to_choose(alternative)))
    return lines


def _how_to_choose(alternative: Alternative) -> str:
    """Return a sentence on how to answer a question with an option of ``decode``: ``… with --choose first_bit=low``.

    The example is the first answer that is not the default.
    """
    example, *other_answers = alternative.answers
    default_sentence = ""
    if alternative.default:
        # The default is the first answer.
        example = other_answers[0]
        default_sentence = f"{alternative.default} applies without a choice. "
    return f"{default_sentence}Give decode the answer with --choose {alternative.name}={example.name}"


# -- the position


def _position_lines(
    measurements: Sequence[tuple[str, Measurement | None]], parameters: Mapping[str, int] | None
) -> list[str]:
    """Return the section about the range of the position, with a row for each measurement that is not None.

    A row begins with the title of the interface, or, if that is "", with the name of the position.
    """
    title_and_range_rows = []
    for title, measurement in measurements:
        if measurement is None:
            continue
        unit_and_range = style_with(parameters).phrase(say_layout.describe_measurement(measurement))
        length = _whole_length(measurement, parameters)
        range_text = f"{unit_and_range}{length}  [{cite(measurement.source)}]"
        title_and_range_rows.append((title or measurement.position_name, range_text))
    if not title_and_range_rows:
        return []
    return ["", "Position", *two_columns(title_and_range_rows, indent=2)]


def _whole_length(measurement: Measurement, parameters: Mapping[str, int] | None) -> str:
    """Return the total length of a linear encoder as a clause: ``, 1,000.000 mm in total``.

    The text is "" for a rotary encoder, and for a family (``parameters`` is None).
    """
    if parameters is None or measurement.modulus is None:
        return ""
    micrometers_per_count = measurement.micrometres(parameters)
    if micrometers_per_count is None:
        return ""
    counts = measurement.modulus.value(parameters)
    millimeters = micrometers_per_count * counts / 1000  # a fraction
    # A fraction has at most three decimals if its denominator divides 1000.
    three_decimals_are_exact = 1000 % millimeters.denominator == 0
    length_text = f"{float(millimeters):,.3f}" if three_decimals_are_exact else decimal(millimeters)
    return f", {length_text} mm in total"


def _range_lines(device: Device, interface: str, parameters: Mapping[str, int] | None) -> list[str]:
    """Return a line for each layout that has its own range of the position, such as ``in short 4,096 counts …``."""
    style = style_with(parameters)
    range_rows = []
    for layout_name, own_range in say_layout.own_ranges(device, interface):
        range_text = style.phrase(say_layout.describe_position_range(own_range))
        range_rows.append((f"in {layout_name}", f"{range_text}  [{cite(own_range.source)}]"))
    return two_columns(range_rows, indent=2)


# -- interfaces and frames


def interface_lines(device: Device, interface: Interface) -> list[str]:
    """Return the title of an interface, and a line for each fact about it, such as its clock or its port."""
    facts = say_order_code.describe_interface_facts(device, interface)
    fact_rows = [(fact.label, f"{PLAIN_STYLE.phrase(fact)}  {PLAIN_STYLE.cited(fact.source)}") for fact in facts]
    return [f"{interface.title}  [{cite(interface.source)}]", *two_columns(fact_rows, indent=2)]


def layout_lines(device: Device, interface: Interface, layout: Layout) -> list[str]:
    """Return the lines about a frame of a family: a row for each field or group of fields, with their widths.

    The row of a group contains all of its fields: ``status error 1, warning 1``.
    """
    widths_by_name: dict[str, list[str]] = {}
    for field in layout.fields:
        name = field.group or field.name
        widths_by_name.setdefault(name, []).append(_width_text(field))
    heading = PLAIN_STYLE.sentence(say_layout.describe_head(interface, layout, layout.name, device.alternatives))
    lines = [wrap_text(heading, WIDTH, prefix="    ", first="  ")]
    width_rows = [(name, ", ".join(widths)) for name, widths in widths_by_name.items()]
    lines += two_columns(width_rows, indent=4)
    for statement in (*say_layout.describe_layout_facts(interface, layout), *needed_answers(device, layout)):
        lines.append(_indented_paragraph(PLAIN_STYLE.sentence(statement)))
    return lines


def _width_text(field: Field) -> str:
    """Return the width of a field, such as ``4 bits, always 5`` for a field with a fixed value.

    For a field of a group, this is ``error 1``. A width that depends on parameters is a formula: ``singleturn_bits
    bits``.
    """
    width = field.width.constant if field.width.is_constant else field.width.render()
    if field.group:
        return f"{field.name} {width}"
    return count_with_unit(width, "bit") + _fixed_value_text(field)


def _fixed_value_text(field: Field) -> str:
    """Return the fixed value of a field, such as ``, always 5`` or ``, unused, 1Fh in the manual``, or ""."""
    match field.kind:
        case Constant(value):
            return f", always {short_number(value)}"
        case Unused(value):
            return f", unused, {short_number(value)} in the manual"
        case _:
            return ""


def frame_lines(device: Device, layout: Layout, variant: Variant) -> list[str]:
    """Return the lines about a frame of an order code: a title, a picture, and notes, for example about registers."""
    interface = device.interface(variant.interface)
    placed_layout = layout.place(variant.parameters)
    style = style_with(variant.parameters)
    name = f"{layout.name} ({layout.printed_name})" if layout.printed_name else layout.name
    heading = style.sentence(say_layout.describe_head(interface, layout, name, device.alternatives))
    notes = [style.sentence(fact) for fact in say_layout.describe_selector(interface, layout)]
    notes += _notes_about_choices(device, layout, style)
    paths_of_widths = run_time_widths(device, layout)
    if paths_of_widths:
        register_fields = " and ".join(field_at(device, field_path) for field_path in paths_of_widths)
        notes.append(f"The widths are the {say_order_code.words_for_initial_values(device)} in {register_fields}.")
    if layout.gray_of:
        notes.append(_position_code_note(device, placed_layout))
    note_lines = [wrap_text(note, WIDTH, prefix="  ", first="  ") for note in notes]
    return [wrap_text(heading, WIDTH, prefix="  ", first=""), *picture(placed_layout), *note_lines]


def _notes_about_choices(device: Device, layout: Layout, style: Style) -> Iterator[str]:
    """Yield a note for each question that the frame depends on, with the answer that its picture shows."""
    for alternative in device.alternatives_of(layout):
        device_with_one_question = replace(device, alternatives=(alternative,))
        for statement in needed_answers(device_with_one_question, layout):
            yield f"{style.sentence(statement)} The picture shows {alternative.answers[0].name}."


def _position_code_note(device: Device, placed_layout: PlacedLayout) -> str:
    """Return a sentence on the code of the position: ``position is in Gray code.``

    If registers determine the code, the sentence names their fields: ``position is in binary, according to …``.
    """
    layout = placed_layout.layout
    code = "Gray code" if placed_layout.gray else "binary"
    code_text = f"{layout.gray_of} is in {code}"
    if placed_layout.gray_excess:
        code_text += f" with an excess of {placed_layout.gray_excess}"
    deciding_names = device.needed_parameters([layout.gray_when]) if layout.gray_when else ()
    deciding_parameters = [parameter for parameter in device.run_time_parameters if parameter.name in deciding_names]
    if not deciding_parameters:
        return f"{code_text}."
    register_fields = ", ".join(field_at(device, parameter.read_from) for parameter in deciding_parameters)
    return f"{code_text}, according to the factory default of {register_fields}."


# -- registers


def register_lines(device: Device, variant: Variant | None) -> list[str]:
    """Return the section about registers with their fields. ``variant`` is None for a family."""
    if not device.registers:
        return []
    lines = ["", "Registers"]
    for register in device.registers:
        lines += _lines_about_register(device, register, variant)
    return lines


def _lines_about_register(device: Device, register: Register, variant: Variant | None) -> list[str]:
    """Return the lines about a register: its facts, its fields and its values.

    Several fields are listed with their bits, which depend on the order code in some families. The rules of a single
    field are among the facts.
    """
    style = style_with(variant.parameters if variant is not None else None)
    heading = style.sentence(say_register.describe_head(device, register, register.name))
    lines = [wrap_text(heading, WIDTH, prefix="    ", first="  ")]
    fields = register.layout.fields
    facts = list(say_register.describe_register_facts(device, register))
    if len(fields) == 1:
        facts += say_register.describe_field_rules(device, fields[0])
    if facts:
        lines.append(wrap_text(style.paragraph(facts), WIDTH, prefix="    "))
    if len(fields) > 1:
        field_rows = [
            (bits_text, _about_field(device, field, style)) for bits_text, field in _placed_fields(register, variant)
        ]
        lines += two_columns(field_rows, indent=4)
    value_rows = [(hexadecimal(value.value), _about_value(value)) for value in register.values]
    return lines + two_columns(value_rows, indent=4)


def _placed_fields(register: Register, variant: Variant | None) -> Iterator[tuple[str, Field]]:
    """Yield each field of a register with its bits. Without an order code, bits that depend on it are omitted."""
    if variant is not None:
        for placed_field in register.layout.place(variant.parameters).fields:
            yield bits(placed_field.highest_bit, placed_field.lowest_bit), placed_field.field
        return
    for field in register.layout.fields:
        has_fixed_bits = field.low.is_constant and field.width.is_constant
        high = field.low.constant + field.width.constant - 1
        yield bits(high, field.low.constant) if has_fixed_bits else "", field


def _about_value(value: Value) -> str:
    """Return the name of a register's value with the first sentence of its meaning."""
    first_sentence, _, _ = value.meaning.partition(". ")
    return f"{value.name}: {first_sentence}" if first_sentence else value.name


def _about_field(device: Device, field: Field, style: Style) -> str:
    """Return the name of a field with its values and its rules."""
    statements = list(say_register.describe_field_rules(device, field))
    if field.values:
        # The values come before the rules.
        statements.insert(0, say_register.describe_choices(field.values))
    values_and_rules = style.paragraph(statements)
    return f"{field.name}: {values_and_rules}" if values_and_rules else field.name


# -- inputs, procedures and errata


def _input_and_procedure_lines(device: Device) -> list[str]:
    """Return a section about the hardware inputs and one about the procedures, each item with its citation."""
    lines: list[str] = []
    input_rows = [(pin.name, _append_source(pin.meaning, pin.source)) for pin in device.inputs]
    if input_rows:
        lines += ["", "Inputs", *two_columns(input_rows, indent=2)]
    procedures = device.procedures
    procedure_rows = [(procedure.name, _append_source(procedure.title, procedure.source)) for procedure in procedures]
    if procedure_rows:
        lines += ["", "Procedures", *two_columns(procedure_rows, indent=2)]
    return lines


def _append_source(text: str, source: Sources) -> str:
    return f"{text}  [{cite(source)}]"


def _errata_lines(device: Device) -> list[str]:
    """Return the errata in full, except errata about wording, which are only counted."""
    if not device.errata:
        return []
    lines = ["", "Errata of the manual"]
    wording_count = 0
    for erratum in device.errata:
        if erratum.severity == "wording":
            wording_count += 1
            continue
        erratum_statement = say_errata.describe_erratum(erratum, whole=True)
        heading, *details = PLAIN_STYLE.lines(erratum_statement)
        lines += [wrap_text(heading, WIDTH, prefix="    ", first="  "), *map(_indented_paragraph, details)]
    if wording_count:
        summary = f"and {wording_count} about wording only, listed by --json and the documentation"
        lines.append(wrap_text(summary, WIDTH, prefix="    ", first="  "))
    return lines
