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
from ...say import commands as say_commands
from ...say import layout as say_crc
from ...say import layout as say_layout
from ...say import order_code as say_order_code
from ...say import order_code as say_parameter
from ...say import register as say_field
from ...say import register as say_register
from ...say import report as say_report
from ...say.names_and_places import addresses_text, bit_range, field_place, full_title, register_field, title_of
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


def _paragraphs_with_heading(name: str, items: Iterable[Statement]) -> list[Paragraph]:
    """Return the statements, with the name before the first statement. Without statements, it is the name alone."""
    sentences = list(map(HEADER_STYLE.sentence, items))
    if not sentences:
        return [f"{name}."]
    return [f"{name}: {sentences[0]}", *sentences[1:]]


# -- order codes, parameters and facts


def about_order_codes(device: Device) -> list[Paragraph]:
    """Return the comment on the order codes, with the parts for which only the listed values are known.

    For these parts, the statements about other values are left out.
    """
    names_of_unknown_parts = unknown_parts(device)
    statements_on_unknown_parts: list[Statement] = []
    for part in device.order_code.parts:
        if part.name in names_of_unknown_parts:
            statements_on_unknown_parts += say_order_code.open_values(part)
    paragraphs: list[Paragraph] = []
    for order_code_statement in say_order_code.order_code(device):
        if order_code_statement not in statements_on_unknown_parts:
            paragraphs.append(HEADER_STYLE.sentence(order_code_statement))
    if names_of_unknown_parts:
        paragraphs.append(f"Only the listed values are known here for: {', '.join(names_of_unknown_parts)}.")
    return paragraphs


def about_parameter(device: Device, prefix: str, parameter: Parameter) -> str:
    """Return the comment on a parameter. If its function computes it, the comment leaves out how it is computed."""
    update = f" {prefix}_take_{parameter.register}() updates it." if parameter.read_from else ""
    statements_in_code = list(say_parameter.parameter_origin(device, parameter)) if parameter.equals is not None else ()
    statements = say_parameter.describe_parameter(device, parameter)
    return HEADER_STYLE.paragraph(statement for statement in statements if statement not in statements_in_code) + update


def about_alarm(device: Device, alarm: Alarm) -> list[Paragraph]:
    return _paragraphs_with_heading(title_of(alarm), say_report.describe_alarm(device, alarm))


def about_crc(device: Device, function: CrcFunction) -> list[Paragraph]:
    """Return the comment on the function of a CRC: its argument, the facts of the CRC, and a special form."""
    facts = list(map(HEADER_STYLE.sentence, say_crc.describe_crc(device, function.crc)))
    if function.carrier is CoveredData.BITS:
        return ["Return the CRC of bits. Bit 0 is the last one sent.", *facts]
    paragraphs: list[Paragraph] = ["Return the CRC of bytes in the order sent.", *facts]
    if function.form is CrcMethod.XOR:
        paragraphs.append("With this polynomial, the CRC of whole bytes is their XOR.")
    return paragraphs


def about_word_crc(device: Device, crc: Crc, folds: bool) -> list[Paragraph]:
    """Return the comment on the function that computes a CRC over a whole word."""
    use = "The result is 0 if a received word is valid. With 0 in place of the CRC, it is the CRC to send."
    return [
        f"Compute CRC {crc.name} over a whole word. {use}",
        *map(HEADER_STYLE.sentence, say_crc.describe_crc(device, crc)),
        _explain_derivation(crc) if folds else "",
    ]


def about_bits_crc(device: Device, crc: Crc) -> list[Paragraph]:
    """Return the comment on the function that computes a CRC over the bits of a frame in bytes."""
    return [
        f"Return CRC {crc.name} of a frame, bit by bit.",
        *map(HEADER_STYLE.sentence, say_crc.describe_crc(device, crc)),
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
    return f"x^{exponent}" if exponent > 1 else "x"


# -- layouts


def about_layout(device: Device, interface: Interface, struct: LayoutStruct) -> list[Paragraph]:
    """Return the purpose of the frame, the positions of its bits, and finally its errata, which few readers need."""
    frame_layout = struct.layout
    statements_on_joins = list(say_layout.describe_joins(frame_layout))  # The comments on their members contain them.
    errata = list(say_layout.errata_of(device, interface, frame_layout))
    head = say_layout.head(interface, frame_layout, CodeText(frame_layout.name), device.alternatives)
    paragraphs: list[Paragraph] = [HEADER_STYLE.sentence(head)]
    for layout_statement in say_layout.describe_layout(device, interface, frame_layout):
        if layout_statement not in statements_on_joins and layout_statement not in errata:
            paragraphs.append(HEADER_STYLE.sentence(layout_statement))
    return [*paragraphs, *table(struct), *map(HEADER_STYLE.sentence, errata)]


def about_member(struct: LayoutStruct, member: Field) -> str:
    """Return the facts of a field that its enumeration does not show, or its title if there are none.

    For a string, a remark on the missing terminator follows.
    """
    choice = struct.enumeration(member)
    shown_statements = choice.statements if choice is not None else ()
    statements = say_field.describe_field(struct.device, member)
    about = HEADER_STYLE.paragraph(statement for statement in statements if statement not in shown_statements)
    # A string in C ends with a zero byte, the array of the struct does not.
    ending = "No terminator." if isinstance(meaning_of(member), Latin1Text) else ""
    return " ".join(filter(None, (about or f"{title_of(member)}.", ending)))


def about_unused(struct: LayoutStruct) -> str:
    """Describe the member for all unused bits, with the bits of it that belong to each unused field."""
    unused = struct.layout.unused
    fields = list_parts([f"{bit_range(low + field.widest - 1, low)} {field.name}" for field, low in unused])
    return f"Unused bits, each 1 if it differs from the manual: {HEADER_STYLE.phrase(statement(*fields))}."


def place_of_field(frame_layout: Layout, placed_field: Field) -> str:
    """Return the position of a field in words, such as ``bits 46:31`` or ``byte 1, bits 7:1``."""
    return HEADER_STYLE.phrase(statement(*field_place(frame_layout, placed_field)))


def _facts_without_member(struct: LayoutStruct, field: Field) -> str:
    """Return the facts of a field that no member shows, and its width unless its place shows it.

    The comment on a member contains the facts of its field. Constants and the selector have no member.
    """
    is_member = field.carries_data and field is not struct.plan.selector
    about = () if is_member else say_field.describe_field(struct.device, field)
    if field.is_fixed:
        return HEADER_STYLE.paragraph(about)
    width = field.width.constant if field.width.is_constant else HEADER_STYLE.number(field.width)
    return HEADER_STYLE.paragraph((statement(count_with_unit(width, "bit")), *about))


def _table_rows(struct: LayoutStruct) -> Iterator[tuple[str, str, str]]:
    """Yield the place of each field, its name, and the facts that no member shows."""
    for placed_field in struct.layout.fields:
        if struct.plan.by_word or not placed_field.padding_of:
            name = "-" if placed_field.fills_gap else placed_field.name
            yield place_of_field(struct.layout, placed_field), name, _facts_without_member(struct, placed_field)


def table(struct: LayoutStruct) -> Iterator[Paragraph]:
    """Yield one line for each field: its place, its name, and the facts that no member shows.

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
    """Return the comment on a register, without its default and limits, which constants and functions have."""
    head = say_register.head(device, register, full_title(register))
    about = [
        statement for statement in say_register.describe_register(device, register) if statement.label not in _IN_CODE
    ]
    return list(map(HEADER_STYLE.sentence, (head, *about)))


def about_access(device: Device, register: Register, writes: bool, read_state: str) -> Iterator[Paragraph]:
    """Yield the comment on a function that reads or writes a register.

    ``read_state`` is the function that updates the variant, or empty if the register has no part of it.
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
    head = HEADER_STYLE.sentence(statement(procedure.title, source=procedure.source))
    return [head, *map(HEADER_STYLE.sentence, say_commands.describe_procedure(device, procedure))]


def about_argument(device: Device, argument: Argument) -> str:
    return HEADER_STYLE.sentence(say_commands.describe_argument(device, argument))


def about_run(device: Device, run: ProcedurePlan, read_state: str) -> Iterator[Paragraph]:
    """Yield the purpose of the function that carries out a procedure, and the accesses that it needs."""
    *calls, last = (CALLS[call] for call in run.calls)
    needed = f"{', '.join(calls)} and {last}" if calls else last
    interface = device.interface(run.procedure.interface)
    yield f"{run.procedure.title}, over {interface.title}. The transport needs {needed}."
    if read_state and run.changes_frames:
        yield f"The frames depend on the bytes written, so call {read_state}() afterwards to update the variant."


def note_of_step(device: Device, operation: PlannedStep) -> str:
    """Return the purpose of a step. Its row already has the address, the bytes and the times.

    For a wait and a write, it is the meaning of the step in the spec, or else the time, or the place and the value
    written. A read and a poll have the title of their field or register before the meaning, and a request its data ID.
    A request without either has an empty note.
    """
    meaning = operation.step.meaning
    match operation:
        case WaitTime(step):
            return meaning or HEADER_STYLE.phrase(say_commands.describe_step(device, step))
        case SendRequest(step=step):
            alone = "in succession, with no other request in between" if step.in_succession else ""
            return "; ".join(filter(None, (step.data_id, alone, meaning)))
        case WriteRegister(step):
            purpose = meaning or f"{_register_place(device, operation)}: {step.value_name}"
            return f"{purpose}, also done if an earlier step fails" if operation.closes else purpose
        case VerifyWrite():
            return f"{_register_place(device, operation)}: read back, in addition to the steps of the manual"
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
