"""Comments on the parts of a device, and on the functions that use them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...model import (
    Alarm,
    Argument,
    Crc,
    Device,
    Field,
    Interface,
    Layout,
    Parameter,
    Procedure,
    Register,
    assert_never,
)
from ...plan.crcs import CoveredData, CrcFunction, CrcMethod
from ...plan.steps import (
    MasterCall,
    PlannedStep,
    PollRegister,
    ProcedurePlan,
    ReadRegister,
    SendRequest,
    VerifyWrite,
    WaitTime,
    WriteRegister,
)
from ...plan.values import Latin1Text, meaning_of
from ...say import commands_and_alarms as say_commands
from ...say import layout as say_layout
from ...say import order_code as say_order_code
from ...say import register as say_register
from ...say.layout import field_place
from ...say.names_and_evidence import addresses_text, bit_range, full_title, register_field, title_of
from ...say.text import CodeText, Statement, count_with_unit, list_parts, statement
from .comments import HEADER_STYLE, Paragraph
from .order_codes import unknown_parts
from .structs import LayoutStruct

#: The functions of a transport.
CALLS = {
    MasterCall.READ: "read_registers",
    MasterCall.WRITE: "write_registers",
    MasterCall.WAIT: "wait_us",
    MasterCall.SEND: "send_request",
}
#: Labels of statements that the constants and functions of a register already express.
_IN_CODE = ("Default", "Limits")
#: Maximum width of the column with the places in a comment.
_PLACE_COLUMN_WIDTH = 30


def _paragraphs_with_heading(heading: str, statements: Iterable[Statement]) -> list[Paragraph]:
    """Return one paragraph for each statement, with the heading before the first one.

    Without statements, the heading is the only paragraph.
    """
    sentences = list(map(HEADER_STYLE.sentence, statements))
    if not sentences:
        return [f"{heading}."]
    first_sentence, *other_sentences = sentences
    return [f"{heading}: {first_sentence}", *other_sentences]


# -- order codes, parameters and facts


def about_order_codes(device: Device) -> list[Paragraph]:
    """Return the comment on how order codes are built.

    The header recognizes only the listed values of some parts. The comment names these parts, and omits what the manual
    says about their other values.
    """
    names_of_listed_parts = unknown_parts(device)
    statements_on_other_values: list[Statement] = []
    for part in device.order_code.parts:
        if part.name in names_of_listed_parts:
            statements_on_other_values += say_order_code.open_values(part)
    paragraphs: list[Paragraph] = []
    for order_code_statement in say_order_code.describe_order_code(device):
        if order_code_statement not in statements_on_other_values:
            paragraphs.append(HEADER_STYLE.sentence(order_code_statement))
    if names_of_listed_parts:
        paragraphs.append(f"Only the listed values are known here for: {', '.join(names_of_listed_parts)}.")
    return paragraphs


def about_parameter(device: Device, prefix: str, parameter: Parameter) -> str:
    """Return the comment on a parameter, such as the number of position bits.

    The formula of a computed parameter (``equals``) is omitted, because it is the body of the parameter's function.
    For a parameter in a register, the comment names the function that updates it.
    """
    statements = list(say_order_code.describe_parameter(device, parameter))
    if parameter.equals is not None:
        statements_on_formula = list(say_order_code.parameter_origin(device, parameter))
        statements = [statement for statement in statements if statement not in statements_on_formula]
    update = f" {prefix}_take_{parameter.register}() updates it." if parameter.read_from else ""
    return HEADER_STYLE.paragraph(statements) + update


def about_alarm(device: Device, alarm: Alarm) -> list[Paragraph]:
    """Return the comment on an alarm: its title, and the statements about it."""
    return _paragraphs_with_heading(title_of(alarm), say_commands.describe_alarm(device, alarm))


def about_crc(device: Device, function: CrcFunction) -> list[Paragraph]:
    """Return the comment on the function of a CRC: its argument, the facts of the CRC, and a special form."""
    facts = list(map(HEADER_STYLE.sentence, say_layout.describe_crc(device, function.crc)))
    if function.covered_data is CoveredData.BITS:
        return ["Return the CRC of bits. Bit 0 is the last one sent.", *facts]
    paragraphs: list[Paragraph] = ["Return the CRC of bytes in the order sent.", *facts]
    if function.method is CrcMethod.XOR and not any("XOR of the bytes" in fact for fact in facts):
        paragraphs.append("With this polynomial, the CRC of whole bytes is their XOR.")
    return paragraphs


def about_word_crc(device: Device, crc: Crc, *, is_folded: bool) -> list[Paragraph]:
    """Return the comment on the function that computes a CRC over a whole word.

    If the function is straight-line code (``is_folded``), the last paragraph explains how the code follows from the
    polynomial.
    """
    use = "The result is 0 if a received word is valid. With 0 in place of the CRC, it is the CRC to send."
    return [
        f"Compute CRC {crc.name} over a whole word. {use}",
        *map(HEADER_STYLE.sentence, say_layout.describe_crc(device, crc)),
        _explain_derivation(crc) if is_folded else "",
    ]


def about_bits_crc(device: Device, crc: Crc) -> list[Paragraph]:
    """Return the comment on the function that computes a CRC over the bits of a frame in bytes."""
    return [
        f"Return CRC {crc.name} of a frame, bit by bit.",
        *map(HEADER_STYLE.sentence, say_layout.describe_crc(device, crc)),
    ]


def _explain_derivation(crc: Crc) -> str:
    """Explain why the straight-line code leaves the remainder of a polynomial with two or three terms.

    Without a middle term, the polynomial is x^width + 1.
    """
    width = crc.width
    # The exponent of the middle term. ``poly`` contains the terms below x^width.
    middle = (crc.poly >> 1).bit_length()
    if not middle:
        return (
            f"How it folds: the remainder of x^{width} is 1, so the bits from {width} up are XORed into those "
            f"{width} places lower, until {width} bits are left."
        )
    # Each squaring doubles the exponents: the remainders of x^width, x^(2 * width) and x^(4 * width).
    powers = [f"of {_format_power(width << times)} is {_format_power(middle << times)} + 1" for times in range(3)]
    return (
        f"How it folds: the remainder {powers[0]}. By squaring, the remainder {powers[1]}, and {powers[2]}. "
        f"With h = v >> {4 * width}, v becomes (v mod 2^{4 * width}) ^ h ^ (h << {4 * middle}). The same is done with "
        f"the shifts {2 * width} and {2 * middle}, then {width} and {middle}, until {width} bits are left."
    )


def _format_power(exponent: int) -> str:
    """Return a power of x, such as ``x^3``, or ``x`` for the exponent 1."""
    return f"x^{exponent}" if exponent > 1 else "x"


# -- layouts


def about_layout(device: Device, interface: Interface, struct: LayoutStruct) -> list[Paragraph]:
    """Return the comment on a frame: its purpose, the place of each field, and its errata, which few readers need.

    Numbers that consist of several fields (joins) are described in the comments on their members.
    """
    frame_layout = struct.layout
    statements_elsewhere = list(say_layout.describe_joins(frame_layout))
    errata = list(say_layout.errata_of(device, interface, frame_layout))
    statements_elsewhere += errata
    heading = say_layout.describe_head(interface, frame_layout, CodeText(frame_layout.name), device.alternatives)
    paragraphs: list[Paragraph] = [HEADER_STYLE.sentence(heading)]
    for layout_statement in say_layout.describe_layout(device, interface, frame_layout):
        if layout_statement not in statements_elsewhere:
            paragraphs.append(HEADER_STYLE.sentence(layout_statement))
    if frame_layout.sender == "master" and frame_layout.data_fields:
        paragraphs.append("Set all members, because those that an initial value leaves out are 0.")
    return [*paragraphs, *field_table(struct), *map(HEADER_STYLE.sentence, errata)]


def about_member(struct: LayoutStruct, member: Field) -> str:
    """Return the comment on a member of the struct: the facts about its field, or its title without any facts.

    Facts in the comment on the field's enumeration are not repeated. For a text, the comment says that its array has no
    terminating zero byte.
    """
    enumeration = struct.enumeration(member)
    statements_on_enumeration = enumeration.statements if enumeration is not None else ()
    statements = say_register.describe_field(struct.device, member)
    facts = HEADER_STYLE.paragraph(statement for statement in statements if statement not in statements_on_enumeration)
    description = facts or f"{title_of(member)}."
    is_text = isinstance(meaning_of(member), Latin1Text)
    terminator = "No terminator." if is_text else ""
    return f"{description} {terminator}".rstrip()


def about_unused(struct: LayoutStruct) -> str:
    """Return the comment on the member ``unused``: which of its bits belong to which unused field of the frame."""
    bits_and_names: list[str] = []
    for field, low in struct.layout.unused:
        highest = low + field.widest - 1
        bits = bit_range(highest, low)
        bits_and_names.append(f"{'bit' if highest == low else 'bits'} {bits} {field.name}")
    listed_fields = HEADER_STYLE.phrase(statement(*list_parts(bits_and_names)))
    return f"Unused bits, each 1 if it differs from the manual: {listed_fields}."


def place_of_field(frame_layout: Layout, placed_field: Field) -> str:
    """Return the position of a field in words, such as ``bits 46:31`` or ``byte 1, bits 7:1``."""
    return HEADER_STYLE.phrase(statement(*field_place(frame_layout, placed_field)))


def _describe_in_table(struct: LayoutStruct, field: Field) -> str:
    """Return the text on a field in the table of a layout, empty if its place and its member already say everything.

    The text gives the width if the place of the field depends on the order code. Facts follow for fields without a
    member in the struct, which are constants and the field that tells frames apart (the selector).
    """
    has_member = field.carries_data and field is not struct.layout_plan.selector
    facts = () if has_member else say_register.describe_field(struct.device, field)
    if field.is_fixed:
        return HEADER_STYLE.paragraph(facts)
    width = field.width.constant if field.width.is_constant else HEADER_STYLE.number(field.width)
    return HEADER_STYLE.paragraph((statement(count_with_unit(width, "bit")), *facts))


def _table_rows(struct: LayoutStruct) -> Iterator[tuple[str, str, str]]:
    """Yield the place of each field, its name, and a text on it, which is often empty.

    A frame that is decoded byte by byte has no row for the bits that pad a field.
    """
    for field in struct.layout.fields:
        if struct.layout_plan.by_word or not field.padding_of:
            name = "-" if field.fills_gap else field.name
            yield place_of_field(struct.layout, field), name, _describe_in_table(struct, field)


def field_table(struct: LayoutStruct) -> Iterator[Paragraph]:
    """Yield one line of the comment on a layout for each field: its place, its name, and a text on it.

    An example is ``  bits 46:31  position  Absolute position.``
    """
    rows = list(_table_rows(struct))
    # The text of a long place goes below it, so that it does not widen the column of places.
    place_widths = (len(place_text) for place_text, _, _ in rows)
    place_width = max((width for width in place_widths if width <= _PLACE_COLUMN_WIDTH), default=0)
    name_width = max((len(name) for _, name, _ in rows), default=0)
    for place_text, name, description in rows:
        lead = f"  {place_text:{place_width}}  "
        if not description:
            yield lead, name
        elif len(place_text) > place_width:
            yield lead, name
            yield "        ", description
        else:
            yield f"{lead}{name:{name_width}}  ", description


# -- registers


def about_register(device: Device, register: Register) -> list[Paragraph]:
    """Return the comment on a register. Its default and limits are omitted, since constants and functions give them."""
    heading = say_register.describe_head(device, register, full_title(register))
    statements = say_register.describe_register(device, register)
    other_statements = [statement for statement in statements if statement.label not in _IN_CODE]
    return list(map(HEADER_STYLE.sentence, (heading, *other_statements)))


def about_access(device: Device, register: Register, *, writes: bool, read_state: str) -> Iterator[Paragraph]:
    """Yield the comment on the function that writes a register, or with ``writes`` False, on the one that reads it.

    If frames depend on the register, ``read_state`` is the name of the function that updates the variant after a write.
    Otherwise it is empty.
    """
    has_wait = writes and register.wait_at_least_ms is not None
    wait = f", then wait {register.wait_at_least_ms} ms" if has_wait else ""
    register_title = title_of(register)
    ends_with_kind = register_title.lower().endswith(("register", "registers"))
    kind = "" if ends_with_kind else " register"
    verb = "Write" if writes else "Read"
    yield f"{verb} the {register_title}{kind} ({addresses_text(register)}){wait}."
    selector = device.bank_selector(register)
    if selector:
        yield f"It first writes to {title_of(device.register(selector))} to select bank {register.bank}."
    elif register.bank is not None:
        yield f"Select bank {register.bank} before you call this function."
    if writes and read_state:
        yield f"The frames depend on the register, so call {read_state}() afterwards to update the variant."


# -- procedures


def about_procedure(device: Device, procedure: Procedure) -> list[Paragraph]:
    """Return the comment on a procedure: its title with its source, and the statements about it."""
    heading = HEADER_STYLE.sentence(statement(procedure.title, source=procedure.source))
    return [heading, *map(HEADER_STYLE.sentence, say_commands.describe_procedure(device, procedure))]


def about_argument(device: Device, argument: Argument) -> str:
    """Return the comment on an argument of a procedure."""
    return HEADER_STYLE.sentence(say_commands.describe_argument(device, argument))


def about_run(device: Device, procedure_plan: ProcedurePlan, read_state: str) -> Iterator[Paragraph]:
    """Yield the comment on the function that carries out a procedure.

    It lists the functions that the user's transport must provide. If the procedure changes what frames look like, it
    says to call ``read_state`` afterwards, which updates the variant. ``read_state`` is empty if there is no such
    function.
    """
    *first_functions, last_function = (CALLS[call] for call in procedure_plan.calls)
    functions = f"{', '.join(first_functions)} and {last_function}" if first_functions else last_function
    interface = device.interface(procedure_plan.procedure.interface)
    yield f"The procedure uses {interface.title}. The transport needs {functions}."
    if read_state and procedure_plan.changes_frames:
        yield f"The frames depend on the bytes written, so call {read_state}() afterwards to update the variant."


def note_of_step(device: Device, operation: PlannedStep) -> str:
    """Return the comment on a step of a procedure, whose row already shows the address, the bytes and the times.

    For a wait or a write, the comment is the meaning of the step in the spec, or else the time, or the field and the
    value written. For a read or a poll, the title of the field or register comes before the meaning. For a request, the
    data ID comes before the meaning, and without both the comment is empty.
    """
    meaning = operation.step.meaning
    match operation:
        case WaitTime(step):
            return meaning or HEADER_STYLE.phrase(say_commands.describe_step(device, step))
        case SendRequest(step=step):
            succession = "in succession, with no other request in between" if step.in_succession else ""
            return "; ".join(filter(None, (step.data_id, succession, meaning)))
        case WriteRegister(step):
            purpose = meaning or f"{_register_place(device, operation)}: {step.value_name}"
            return f"{purpose}, also done if an earlier step fails" if operation.locks_again else purpose
        case VerifyWrite():
            return f"{_register_place(device, operation)}: read back, in addition to the steps in the manual"
        case ReadRegister() | PollRegister():
            return ": ".join(filter(None, (title_of(operation.field or operation.register), meaning)))
        case _:
            assert_never(operation)


def note_of_read(device: Device, read: ReadRegister) -> str:
    """Describe a member for bytes that are read: their place, and the meaning of the step if it has one."""
    return ": ".join(filter(None, (_register_place(device, read), read.step.meaning)))


def _register_place(device: Device, step: WriteRegister | ReadRegister | VerifyWrite) -> str:
    field_name = f".{step.field.name}" if step.field is not None else ""
    return register_field(device, step.register.name + field_name).title


def manual_title(device: Device) -> str:
    """Return the title, revision, date and language of a manual, with the editions that it was compared with."""
    manual = device.manual
    editions = ", ".join(f"{edition.language} {edition.revision}" for edition in manual.editions)
    dated = f" of {manual.date}" if manual.date else ""
    compared = f", compared with: {editions}" if editions else ""
    return f'"{manual.title}", revision {manual.revision}{dated} ({manual.language}{compared})'
