"""Bytes to send, on the page of an order code: requests, presets and commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ...model import (
    Biss,
    DataId,
    Device,
    Interface,
    Layout,
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Register,
    Rs485,
    SendStep,
    Spi,
    Ssi,
    Step,
    Variant,
    WaitStep,
    WriteStep,
    assert_never,
)
from ...model.record import dataclass
from ...plan.codec import codec_of
from ...plan.replies import exchanges
from ...plan.values import Raw, TwosComplement, meaning_of
from ...say.box import as_words
from ...say.commands import Commands, commands_over
from ...say.evidence import document
from ...say.interface import PURPOSES, word_lengths
from ...say.markdown import code, joined, link, text
from ...say.name import title
from ...say.place import addresses, bits
from ...say.words import counted, microseconds

Row = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Sending:
    """Requests and commands with their bytes. ``other_value`` says how to write a position other than 0."""

    facts: tuple[str, ...]
    requests: tuple[Row, ...]
    commands: tuple[Row, ...]
    command_errata: str
    other_value: str


def sending(
    family: Device, device: Device, interface: Interface, variant: Variant, errata_at: Callable[..., str]
) -> Sending:
    """Return the bytes to send for an order code. ``errata_at`` returns links to errata that change bytes."""
    requests = tuple(_requests(device, interface, errata_at))
    commands = tuple(_commands(device, variant, errata_at))
    preset = next(
        (register for register in _preset_registers(device) if zero_of(device, register, variant) is not None), None
    )
    possible = commands_over(device, interface)
    facts = list(_facts(device, interface, possible, bool(commands), preset is not None))
    inputs = [link(text(title(hardware_input)), f"#input-{hardware_input.name}") for hardware_input in device.inputs]
    if inputs:
        facts.append(f"Inputs: {', '.join(inputs)}.")
    other_value = _other_value(family.register(preset.name), variant) if preset is not None else ""
    command_errata = _command_errata(device, errata_at)
    return Sending(tuple(facts), requests, commands, command_errata, other_value)


def _facts(device: Device, interface: Interface, possible: Commands, has_rows: bool, has_preset: bool) -> Iterator[str]:
    """Yield what the bytes mean. A sentence denies only what nothing in ``possible`` contradicts."""
    match interface:
        case Ssi():
            denial = " It has no preset, reset or save command." if possible.is_empty else ""
            yield f"SSI only reads the position.{denial}"
            yield from _registers_to_write(possible)
        case Biss():
            yield from _facts_of_biss(device, possible, has_rows, has_preset)
        case Rs485() if not interface.exchanges:
            yield "Bytes are in hexadecimal."
            yield from _denied_by_t_format(device, possible)
            yield from _registers_to_write(possible)
        case Rs485() | Spi():
            yield "The frames of the master are requests. The frames of the encoder answer them."
        case _:
            assert_never(interface)


def _facts_of_biss(device: Device, possible: Commands, has_rows: bool, has_preset: bool) -> Iterator[str]:
    if has_preset:
        # The script of the site changes this sentence together with the bytes.
        zero = '<span id="preset-of-rows">The preset is 0 in these rows.</span>'
        yield f"Addresses and bytes are in hexadecimal. {zero}"
    elif has_rows and not possible.may_preset:
        yield f"The {document(device)} describes no preset over BiSS."
    elif has_rows:
        yield "Addresses and bytes are in hexadecimal."
        yield from _registers_to_write(possible)
    elif possible.registers or possible.settings:
        yield from _registers_to_write(possible)
    elif not possible.is_empty:
        yield f"The {document(device)} describes no registers that can be written over BiSS."
    elif document(device) == "manual" and not device.evidence.left_out:
        yield "The manual describes no commands over BiSS: no preset, reset or save."
    else:
        yield f"The {document(device)} describes no commands over BiSS. The encoder may have some."


def _registers_to_write(possible: Commands) -> Iterator[str]:
    """Yield the registers that hold commands, with the commands, and the other registers that can be written."""
    for register in possible.registers:
        names = ", ".join(code(title(value)) for field in register.layout.fields for value in field.values)
        yield f"Write a command to {_register_link(register)}: {names}."
    if possible.settings:
        settings = ", ".join(map(_register_link, possible.settings))
        yield f"{'Other registers' if possible.registers else 'Registers'} that can be written: {settings}."


def _register_link(register: Register) -> str:
    return link(f"{addresses(register)} {text(title(register))}", f"#register-{register.name}")


def _denied_by_t_format(device: Device, possible: Commands) -> Iterator[str]:
    """Yield the commands that requests of the T-format lack."""
    if possible.may_preset:
        return
    exception = " other than the resets" if possible.resets else ""
    save = "" if possible.may_save else ", and no save command"
    there_is = "There is" if document(device) == "manual" else "The spec describes"
    yield f"{there_is} no preset{exception}{save}."


def _preset_registers(device: Device) -> Iterator[Register]:
    """Yield the registers to which procedures write a position."""
    for procedure in device.procedures:
        yield from (device.register(argument.of) for argument in procedure.arguments if argument.name == "position")


def _other_value(register: Register, variant: Variant) -> str:
    """Return how to write another position, with an example."""
    low, width = register.layout.place(variant.parameters).place_of(register.limits_of)
    if not width:
        return ""
    order = register.byte_order.replace("_", " ")
    shift = f" × 2^{low}" if low else ""
    example = min(1000, (1 << width) - 1)
    data = register.bytes_of(example << low).hex(" ").upper()
    return (
        f"Another position: write position{shift} as {counted(register.length, 'byte')}, {order}, to "
        f"{link(addresses(register), f'#register-{register.name}')}. For 1,000: {code(data)}."
    )


def _requests(device: Device, interface: Interface, errata_at: Callable[..., str]) -> Iterator[Row]:
    """Yield rows of request with its reply, meaning."""
    for exchange in exchanges(interface):
        frames = [
            link(code(layout.name), f"#layout-{layout.name}") for layout in (exchange.request, exchange.reply) if layout
        ]
        bits = exchange.exchange.word_bits
        effect = PURPOSES[exchange.exchange.purpose] or text(exchange.request.note.partition(". ")[0].removesuffix("."))
        about = [effect, f"in words of {word_lengths([bits])}" if bits is not None else ""]
        description = ", ".join(filter(None, about))
        yield " → ".join(frames), description[:1].upper() + description[1:]
    if not isinstance(interface, Rs485):
        return
    for data_id in interface.data_ids:
        request, reply = (_frame_of(interface, sender, data_id.id) for sender in ("master", "encoder"))
        request_fields = request.fields if request is not None else ()
        part_names = dict.fromkeys(
            field.group or field.name
            for field in request_fields
            if not field.group or field.group != request_fields[0].group
        )
        sent_bytes = ", ".join(
            [code(f"{data_id.control:02X}"), *(text(as_words(name).partition(" of ")[0]) for name in part_names)]
        )
        reply_link = (
            f" → {link(counted(reply.widest // 8, 'byte'), f'#layout-{reply.name}')}" if reply is not None else ""
        )
        description = joined([text(data_id.meaning or data_id.purpose), *_repeated(device, data_id)], ". ")
        errors = errata_at(*(f"procedures.{procedure.name}" for procedure in _sending_only(device, data_id)))
        meaning = joined(
            [f"{description}.", f"<small>Data ID {data_id.id:X} {code(data_id.name)}</small>", errors], " "
        )
        yield sent_bytes + reply_link, meaning


def _sending_only(device: Device, data_id: DataId) -> Iterator[Procedure]:
    """Yield the procedures that send this request and no other."""
    for procedure in device.procedures:
        if [step.data_id for step in procedure.steps if isinstance(step, SendStep)] == [data_id.name]:
            yield procedure


def _repeated(device: Device, data_id: DataId) -> Iterator[str]:
    """Yield the repetition and the waiting time of the procedures that send only this request, with links."""
    for procedure in _sending_only(device, data_id):
        send_step = next(step for step in procedure.steps if isinstance(step, SendStep))
        waits = [f"wait {microseconds(step.microseconds)}" for step in procedure.steps if isinstance(step, WaitStep)]
        times = f"{send_step.times} times"
        apart = f"at least {microseconds(send_step.microseconds)} apart" if send_step.microseconds else ""
        yield "Send it " + joined([link(times, f"#procedure-{procedure.name}"), apart, *waits], ", ")


def _frame_of(interface: Rs485, sender: str, data_id: int) -> Layout | None:
    return next((layout for layout in interface.layouts if layout.sender == sender and data_id in layout.selects), None)


def _writing_procedures(device: Device) -> list[Procedure]:
    return [
        procedure
        for procedure in device.procedures
        if any(isinstance(step, (WriteStep, ModifyStep)) for step in procedure.steps)
    ]


def _commands(device: Device, variant: Variant, errata_at: Callable[..., str]) -> Iterator[Row]:
    """Yield rows of task and bytes to send, for procedures that write something.

    Errata about a single bit are next to it. ``_command_errata`` has the others.
    """
    for procedure in _writing_procedures(device):
        bytes_to_write = joined((_sent(device, step, variant) for step in procedure.steps), ", ")
        bits_set = [f"registers.{step.register}.{step.field}" for step in _modifications(procedure)]
        bit_errata = errata_at(exactly=bits_set) if bits_set else ""
        yield link(text(procedure.title), f"#procedure-{procedure.name}"), joined([bytes_to_write, bit_errata], ". ")


def _command_errata(device: Device, errata_at: Callable[..., str]) -> str:
    """Return the errata about procedures that write something, and about the registers that they write."""
    procedures = _writing_procedures(device)
    registers = [
        f"registers.{step.register}"
        for procedure in procedures
        for step in procedure.steps
        if isinstance(step, WriteStep)
    ]
    places = dict.fromkeys((*(f"procedures.{procedure.name}" for procedure in procedures), *registers))
    return errata_at(*places, exactly=registers) if places else ""


def _modifications(procedure: Procedure) -> Iterator[ModifyStep]:
    return (step for step in procedure.steps if isinstance(step, ModifyStep))


def _sent(device: Device, step: Step, variant: Variant) -> str:
    match step:
        case WaitStep():
            return f"wait {microseconds(step.microseconds)}"
        case SendStep():
            return code(step.request.hex(" ").upper())
        case ReadStep():
            return f"read {addresses(device.register(step.register))}"
        case PollStep():
            return f"read {addresses(device.register(step.register))} until {code(step.field)} is {step.value}"
        case ModifyStep():
            register = device.register(step.register)
            value = "the new value" if step.value is None else f"{step.value}"
            return f"{addresses(register)}: {_bit_of(register, step.field, variant)} = {value}"
        case WriteStep():
            register = device.register(step.register)
            data = register.bytes_of(step.value) if step.value is not None else zero_of(device, register, variant)
            return f"{addresses(register)}: {code(data.hex(' ').upper()) if data is not None else 'the new value'}"
        case _:
            assert_never(step)


def _bit_of(register: Register, name: str, variant: Variant) -> str:
    placed = register.layout.place(variant.parameters).find_field(name)
    return bits(placed.high, placed.low) if placed is not None else code(name)


def zero_of(device: Device, register: Register, variant: Variant) -> bytes | None:
    """Return the bytes of a register that holds the position 0, or None for a register with anything else."""
    if register not in _preset_registers(device):
        return None
    constants = codec_of(device, register.layout).constants
    total = 0
    for placed_field in register.layout.place(variant.parameters).fields:
        if placed_field.name in constants:
            total |= constants[placed_field.name] << placed_field.low
        elif not isinstance(meaning_of(placed_field.field), (Raw, TwosComplement)):
            return None
    return register.bytes_of(total)
