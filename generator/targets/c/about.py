"""What comments say of the parts of a device, and of the functions that use them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ...model import (
    Alarm,
    Crc,
    Device,
    Field,
    Input,
    Interface,
    Layout,
    Parameter,
    Procedure,
    Register,
    Text,
    assert_never,
)
from ...plan.crcs import Carrier, CrcFunction, Form
from ...plan.steps import Call, Operation, Polls, Reads, Run, Sends, Verifies, Waits, Writes
from ...say import alarm, crc, field, hardware_input, layout, order_code, parameter, procedure, register
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
#: What constants and functions of a register state.
_IN_CODE = ("Default", "Limits")
#: The widest column of places in a comment.
_PLACE = 50


def _headed(name: str, items: Iterable[Said]) -> list[Paragraph]:
    """The statements, the first of them after the name."""
    lines = list(map(S.sentence, items))
    return [f"{name}: {lines[0]}", *lines[1:]] if lines else [f"{name}."]


# -- order codes, parameters and facts


def about_order_codes(device: Device) -> list[Paragraph]:
    unknown = unknown_parts(device)
    hidden = [item for part in device.order_code.parts if part.name in unknown for item in order_code.open_values(part)]
    about: list[Paragraph] = [S.sentence(item) for item in order_code.order_code(device) if item not in hidden]
    return [*about, f"Known here only as listed: {', '.join(unknown)}."] if unknown else about


def about_parameter(device: Device, prefix: str, item: Parameter) -> str:
    taken = f" {prefix}_take_{item.register}() takes it over." if item.read_from else ""
    in_code = list(parameter.origin(device, item)) if item.equals is not None else ()
    return S.paragraph(one for one in parameter.parameter(device, item) if one not in in_code) + taken


def about_input(device: Device, item: Input) -> list[Paragraph]:
    return _headed(title(item), hardware_input.hardware_input(device, item))


def about_alarm(device: Device, item: Alarm) -> list[Paragraph]:
    return _headed(title(item), alarm.alarm(device, item))


_COVERED = "The argument holds the bits that the CRC covers, the last one sent in bit 0"
_TAKES = {
    (Form.FOLD, Carrier.BITS): f"{_COVERED}. Bits of 0 before them change nothing.",
    (Form.TABLE, Carrier.BITS): f"{_COVERED}, and how many they are.",
    (Form.XOR, Carrier.BYTES): "With this polynomial the CRC of whole bytes is their XOR.",
}


def about_crc(device: Device, function: CrcFunction) -> list[Paragraph]:
    derived = _derivation(function.crc) if function.form is Form.FOLD else ""
    return [*map(S.sentence, crc.crc(device, function.crc)), _TAKES.get((function.form, function.carrier), ""), derived]


def _derivation(item: Crc) -> str:
    """Why straight-line code leaves the remainder."""
    width, middle = item.width, (item.poly >> 1).bit_length()
    if not middle:
        return f"x^{width} leaves 1: the bits from {width} on go down by {width}, until {width} are left."
    powers = [f"{_power(width << up)} leaves {_power(middle << up)} + 1" for up in range(3)]
    return (
        f"How it folds: {powers[0]}, so that {powers[1]} (the square) and {powers[2]}. With h = v >> {4 * width}, "
        f"v becomes (v mod 2^{4 * width}) ^ h ^ (h << {4 * middle}); in the same way at {2 * width} with "
        f"{2 * middle}, and at {width} with {middle}, until {width} bits are left."
    )


def _power(exponent: int) -> str:
    return f"x^{exponent}" if exponent > 1 else "x"


# -- layouts


def about_layout(device: Device, interface: Interface, struct: Struct) -> list[Paragraph]:
    item = struct.layout
    """What the frame is and where its bits are; errata after that, which few come for."""
    elsewhere = list(layout.joins(item))  # Their members say it.
    errata = list(layout.errata_of(device, interface, item))
    about = [one for one in layout.layout(device, interface, item) if one not in (*elsewhere, *errata)]
    head = layout.head(interface, item, Code(item.name), device.alternatives)
    return [*map(S.sentence, (head, *about)), *table(struct), *map(S.sentence, errata)]


def about_member(struct: Struct, item: Field) -> str:
    """What its enumeration does not say."""
    choice = struct.enumeration(item)
    about = [one for one in field.field(struct.device, item) if choice is None or one not in choice.said]
    return " ".join(filter(None, (S.paragraph(about), "No terminator." if isinstance(item.kind, Text) else "")))


def about_unused(struct: Struct) -> str:
    """What the member for all unused bits holds."""
    fields = listed([f"{bit_range(at + item.widest - 1, at)} {item.name}" for item, at in struct.layout.unused])
    return f"Unused bits, each 1 where it is not as the manual has it: {S.phrase(said(*fields))}."


def place(item: Layout, of: Field) -> str:
    """Where a field lies."""
    return S.phrase(said(*field_place(item, of)))


def _holds(struct: Struct, item: Field) -> str:
    """What no member says of a field, and how wide it is where its place does not tell."""
    is_member = item.carries_data and item is not struct.plan.selector
    about = () if is_member else field.field(struct.device, item)
    if item.is_fixed:
        return S.paragraph(about)
    width = item.width.constant if item.width.is_constant else S.number(item.width)
    return S.paragraph((said(counted(width, "bit")), *about))


def table(struct: Struct) -> Iterator[Paragraph]:
    """One line for each field: where it is, its name, and what no member says."""
    rows = [
        (place(struct.layout, item), "-" if item.fills_gap else item.name, _holds(struct, item))
        for item in struct.layout.fields
        if struct.plan.by_word or not item.padding_of
    ]
    # A long place has its text below, and does not widen the column for the others.
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
    """What a function says that reads a register, or writes it."""
    waits = f", then waits {item.wait_at_least_ms} ms" if writes and item.wait_at_least_ms is not None else ""
    yield f"{'Writes' if writes else 'Reads'} {title(item)}, {addresses(item)}{waits}."
    selector = device.bank_selector(item)
    if selector:
        yield f"Selects bank {item.bank} first: a write to {title(device.register(selector))}."
    elif item.bank is not None:
        yield f"Bank {item.bank} has to be selected before."
    if writes and read_state:
        yield f"The frames depend on it: {read_state}() makes the variant follow."


# -- procedures


def about_procedure(device: Device, item: Procedure, names: Mapping[str, str]) -> list[Paragraph]:
    arguments = (f"{names[one.name]}: {S.sentence(procedure.argument(device, one))}" for one in item.arguments)
    head = S.sentence(said(item.title, source=item.source))
    return [head, *arguments, *map(S.sentence, procedure.procedure(device, item))]


def about_run(device: Device, run: Run, read_state: str) -> Iterator[Paragraph]:
    *calls, last = (CALLS[item] for item in run.calls)
    needed = f"{', '.join(calls)} and {last}" if calls else last
    interface = device.interface(run.procedure.interface)
    yield f"Carries it out over {interface.title}; the transport needs {needed}."
    if read_state and run.changes_frames:
        yield f"The frames depend on what it writes: {read_state}() makes the variant follow."


def note_of_step(device: Device, item: Operation) -> str:
    """What a step is for: its row has the address, the bytes and the times."""
    meaning = item.step.meaning
    match item:
        case Waits(step):
            return meaning or S.phrase(procedure.step(device, step))
        case Sends(step=step):
            alone = "in succession, no other request in between" if step.in_succession else ""
            return "; ".join(filter(None, (step.data_id, alone, meaning)))
        case Writes(step):
            of = meaning or f"{_where(device, item)}: {step.value_name}"
            return f"{of}; also where a step before it fails" if item.closes else of
        case Verifies():
            return f"{_where(device, item)}: read back, which no manual asks for"
        case Reads() | Polls():
            return ": ".join(filter(None, (title(item.field or item.register), meaning)))
        case _:
            assert_never(item)


def note_of_read(device: Device, item: Reads) -> str:
    """What a member holds that takes what is read."""
    return ": ".join(filter(None, (_where(device, item), item.step.meaning)))


def _where(device: Device, item: Writes | Reads | Verifies) -> str:
    field_name = f".{item.field.name}" if item.field is not None else ""
    return register_field(device, item.register.name + field_name).title
