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
from ...plan.crcs import Carrier, CrcFunction, Form
from ...plan.steps import Call, Operation, Polls, Reads, Run, Sends, Verifies, Waits, Writes
from ...plan.values import Characters, meaning_of
from ...say import alarm, crc, field, layout, order_code, parameter, procedure, register
from ...say.name import full_title, register_field, title
from ...say.place import addresses, bit_range, field_place
from ...say.text import Code, Said, listed, said
from ...say.words import counted
from .comments import Paragraph
from .order_codes import unknown_parts
from .structs import Struct
from .style import S

#: The functions of a transport.
CALLS = {
    Call.READ: "read_registers",
    Call.WRITE: "write_registers",
    Call.WAIT: "wait_us",
    Call.SEND: "send_request",
}
#: Labels of statements that the constants and functions of a register already express.
_IN_CODE = ("Default", "Limits")
#: Maximum width of the column with the places in a comment.
_PLACE = 50


def _headed(name: str, items: Iterable[Said]) -> list[Paragraph]:
    """Return the statements, with the name before the first one."""
    lines = list(map(S.sentence, items))
    return [f"{name}: {lines[0]}", *lines[1:]] if lines else [f"{name}."]


# -- order codes, parameters and facts


def about_order_codes(device: Device) -> list[Paragraph]:
    unknown = unknown_parts(device)
    hidden = [item for part in device.order_code.parts if part.name in unknown for item in order_code.open_values(part)]
    about: list[Paragraph] = [S.sentence(item) for item in order_code.order_code(device) if item not in hidden]
    return [*about, f"Only the listed values are known here for: {', '.join(unknown)}."] if unknown else about


def about_parameter(device: Device, prefix: str, item: Parameter) -> str:
    taken = f" {prefix}_take_{item.register}() updates it." if item.read_from else ""
    in_code = list(parameter.origin(device, item)) if item.equals is not None else ()
    return S.paragraph(one for one in parameter.parameter(device, item) if one not in in_code) + taken


def about_alarm(device: Device, item: Alarm) -> list[Paragraph]:
    return _headed(title(item), alarm.alarm(device, item))


def about_crc(device: Device, function: CrcFunction) -> list[Paragraph]:
    """Return the comment on the function of a CRC."""
    about = list(map(S.sentence, crc.crc(device, function.crc)))
    if function.carrier is Carrier.BYTES:
        by_xor = "With this polynomial, the CRC of whole bytes is their XOR." if function.form is Form.XOR else ""
        return ["Return the CRC of bytes in the order sent.", *about, by_xor]
    return ["Return the CRC of bits. Bit 0 is the last one sent.", *about]


def about_word_crc(device: Device, item: Crc, folds: bool) -> list[Paragraph]:
    """Return the comment on the function that computes a CRC over a whole word."""
    use = "The result is 0 if a received word is valid. With 0 in place of the CRC, it is the CRC to send."
    return [
        f"Compute CRC {item.name} over a whole word. {use}",
        *map(S.sentence, crc.crc(device, item)),
        _derivation(item) if folds else "",
    ]


def about_bits_crc(device: Device, item: Crc) -> list[Paragraph]:
    """Return the comment on the function that computes a CRC over the bits of a frame in bytes."""
    return [f"Return CRC {item.name} of a frame, bit by bit.", *map(S.sentence, crc.crc(device, item))]


def _derivation(item: Crc) -> str:
    """Explain why the straight-line code leaves the remainder."""
    width, middle = item.width, (item.poly >> 1).bit_length()
    if not middle:
        return (
            f"How it folds: the remainder of x^{width} is 1, so the bits from {width} up are XORed into those "
            f"{width} places lower, until {width} bits are left."
        )
    powers = [f"of {_power(width << up)} is {_power(middle << up)} + 1" for up in range(3)]
    return (
        f"How it folds: the remainder {powers[0]}. By squaring, the remainder {powers[1]}, and {powers[2]}. "
        f"With h = v >> {4 * width}, v becomes (v mod 2^{4 * width}) ^ h ^ (h << {4 * middle}). The same is done with "
        f"the shifts {2 * width} and {2 * middle}, then {width} and {middle}, until {width} bits are left."
    )


def _power(exponent: int) -> str:
    return f"x^{exponent}" if exponent > 1 else "x"


# -- layouts


def about_layout(device: Device, interface: Interface, struct: Struct) -> list[Paragraph]:
    """Return the purpose of the frame, the positions of its bits, and finally its errata, which few readers need."""
    item = struct.layout
    elsewhere = list(layout.joins(item))  # Their members say it.
    errata = list(layout.errata_of(device, interface, item))
    about = [one for one in layout.layout(device, interface, item) if one not in (*elsewhere, *errata)]
    head = layout.head(interface, item, Code(item.name), device.alternatives)
    return [*map(S.sentence, (head, *about)), *table(struct), *map(S.sentence, errata)]


def about_member(struct: Struct, item: Field) -> str:
    """Return the facts of a field that its enumeration does not show."""
    choice = struct.enumeration(item)
    about = [one for one in field.field(struct.device, item) if choice is None or one not in choice.said]
    ending = "No terminator." if isinstance(meaning_of(item), Characters) else ""
    return " ".join(filter(None, (S.paragraph(about) or f"{title(item)}.", ending)))


def about_unused(struct: Struct) -> str:
    """Describe the member for all unused bits."""
    fields = listed([f"{bit_range(at + item.widest - 1, at)} {item.name}" for item, at in struct.layout.unused])
    return f"Unused bits, each 1 if it differs from the manual: {S.phrase(said(*fields))}."


def place(item: Layout, of: Field) -> str:
    """Return the position of a field."""
    return S.phrase(said(*field_place(item, of)))


def _holds(struct: Struct, item: Field) -> str:
    """Return the facts of a field that no member shows, and its width unless its place shows it."""
    is_member = item.carries_data and item is not struct.plan.selector
    about = () if is_member else field.field(struct.device, item)
    if item.is_fixed:
        return S.paragraph(about)
    width = item.width.constant if item.width.is_constant else S.number(item.width)
    return S.paragraph((said(counted(width, "bit")), *about))


def table(struct: Struct) -> Iterator[Paragraph]:
    """Yield one line for each field: its place, its name, and the facts that no member shows."""
    rows = [
        (place(struct.layout, item), "-" if item.fills_gap else item.name, _holds(struct, item))
        for item in struct.layout.fields
        if struct.plan.by_word or not item.padding_of
    ]
    # The text of a long place goes below it, so that it does not widen the column for the others.
    places = max((len(row[0]) for row in rows if len(row[0]) <= _PLACE), default=0)
    names = max((len(row[1]) for row in rows), default=0)
    for where, name, holds in rows:
        yield (f"  {where:{places}}  {name:{names}}  ", holds) if holds else (f"  {where:{places}}  ", name)


# -- registers


def about_register(device: Device, item: Register) -> list[Paragraph]:
    head = register.head(device, item, full_title(item))
    about = [one for one in register.register(device, item) if one.label not in _IN_CODE]
    return list(map(S.sentence, (head, *about)))


def about_access(device: Device, item: Register, writes: bool, read_state: str) -> Iterator[Paragraph]:
    """Yield the comment on a function that reads or writes a register."""
    waits = f", then wait {item.wait_at_least_ms} ms" if writes and item.wait_at_least_ms is not None else ""
    name = title(item)
    kind = "" if name.lower().endswith(("register", "registers")) else " register"
    yield f"{'Write' if writes else 'Read'} the {name}{kind} ({addresses(item)}){waits}."
    selector = device.bank_selector(item)
    if selector:
        yield f"It first writes to {title(device.register(selector))} to select bank {item.bank}."
    elif item.bank is not None:
        yield f"Select bank {item.bank} before you call this function."
    if writes and read_state:
        yield f"The frames depend on the register, so call {read_state}() afterwards to update the variant."


# -- procedures


def about_procedure(device: Device, item: Procedure) -> list[Paragraph]:
    head = S.sentence(said(item.title, source=item.source))
    return [head, *map(S.sentence, procedure.procedure(device, item))]


def about_argument(device: Device, item: Argument) -> str:
    return S.sentence(procedure.argument(device, item))


def about_run(device: Device, run: Run, read_state: str) -> Iterator[Paragraph]:
    *calls, last = (CALLS[item] for item in run.calls)
    needed = f"{', '.join(calls)} and {last}" if calls else last
    interface = device.interface(run.procedure.interface)
    yield f"{run.procedure.title}, over {interface.title}. The transport needs {needed}."
    if read_state and run.changes_frames:
        yield f"The frames depend on the bytes written, so call {read_state}() afterwards to update the variant."


def note_of_step(device: Device, item: Operation) -> str:
    """Return the purpose of a step. Its row already has the address, the bytes and the times."""
    meaning = item.step.meaning
    match item:
        case Waits(step):
            return meaning or S.phrase(procedure.step(device, step))
        case Sends(step=step):
            alone = "in succession, with no other request in between" if step.in_succession else ""
            return "; ".join(filter(None, (step.data_id, alone, meaning)))
        case Writes(step):
            of = meaning or f"{_where(device, item)}: {step.value_name}"
            return f"{of}, also done if an earlier step fails" if item.closes else of
        case Verifies():
            return f"{_where(device, item)}: read back, which is added to the given steps"
        case Reads() | Polls():
            return ": ".join(filter(None, (title(item.field or item.register), meaning)))
        case _:
            assert_never(item)


def note_of_read(device: Device, item: Reads) -> str:
    """Describe a member for bytes that are read."""
    return ": ".join(filter(None, (_where(device, item), item.step.meaning)))


def _where(device: Device, item: Writes | Reads | Verifies) -> str:
    field_name = f".{item.field.name}" if item.field is not None else ""
    return register_field(device, item.register.name + field_name).title
