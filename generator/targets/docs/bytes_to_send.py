"""Bytes to send, on the page of an order code: requests, presets and commands."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import (
    Biss,
    DataId,
    Device,
    Interface,
    Layout,
    ModifyStep,
    PollStep,
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
    other_value: str


def sending(family: Device, device: Device, interface: Interface, variant: Variant) -> Sending:
    requests, commands = tuple(_requests(device, interface)), tuple(_commands(device, variant))
    preset = next((item for item in _preset_registers(device) if zero_of(device, item, variant) is not None), None)
    facts = []
    match interface:
        case Ssi():
            facts.append("SSI only reads the position. It has no preset, reset or save command.")
        case Biss():
            if not commands:
                facts.append(f"The {document(device)} describes no commands over BiSS: no preset, reset or save.")
            elif preset is None:
                facts.append(f"The {document(device)} describes no preset over BiSS.")
            else:
                # The script of the site changes this sentence together with the bytes.
                zero = '<span id="preset-of-rows">The preset is 0 in these rows.</span>'
                facts.append(f"Addresses and bytes are in hexadecimal. {zero}")
        case Rs485():
            if interface.exchanges:
                facts.append("The frames of the master are requests. The frames of the encoder answer them.")
            else:
                facts.append("Bytes are in hexadecimal. There is no preset other than the resets, and no save command.")
        case Spi():
            facts.append("The frames of the master are requests. The frames of the encoder answer them.")
        case _:
            assert_never(interface)
    inputs = [link(text(title(item)), f"#input-{item.name}") for item in device.inputs]
    if inputs:
        facts.append(f"Inputs: {', '.join(inputs)}.")
    other = _other_value(family.register(preset.name), variant) if preset is not None else ""
    return Sending(tuple(facts), requests, commands, other)


def _preset_registers(device: Device) -> Iterator[Register]:
    """Yield the registers to which procedures write a position."""
    for item in device.procedures:
        yield from (device.register(one.of) for one in item.arguments if one.name == "position")


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


def _requests(device: Device, interface: Interface) -> Iterator[Row]:
    """Yield rows of request with its reply, meaning."""
    for each in exchanges(interface):
        frames = [link(code(item.name), f"#layout-{item.name}") for item in (each.request, each.reply) if item]
        bits = each.item.word_bits
        effect = PURPOSES[each.item.purpose] or text(each.request.note.partition(". ")[0].removesuffix("."))
        about = [effect, f"in words of {word_lengths([bits])}" if bits is not None else ""]
        told = ", ".join(filter(None, about))
        yield " → ".join(frames), told[:1].upper() + told[1:]
    if not isinstance(interface, Rs485):
        return
    for item in interface.data_ids:
        asked, answered = (_frame_of(interface, sender, item.id) for sender in ("master", "encoder"))
        rest = asked.fields if asked is not None else ()
        others = dict.fromkeys(
            field.group or field.name for field in rest if not field.group or field.group != rest[0].group
        )
        sent = ", ".join([code(f"{item.control:02X}"), *(text(as_words(name).partition(" of ")[0]) for name in others)])
        back = (
            f" → {link(counted(answered.widest // 8, 'byte'), f'#layout-{answered.name}')}"
            if answered is not None
            else ""
        )
        told = joined([text(item.meaning or item.purpose), *_repeated(device, item)], ". ")
        yield sent + back, f"{told}. <small>Data ID {item.id:X} {code(item.name)}</small>"


def _repeated(device: Device, item: DataId) -> Iterator[str]:
    """Yield the repetition and the waiting time of the procedures that send only this request, with links."""
    for procedure in device.procedures:
        sends = [step for step in procedure.steps if isinstance(step, SendStep)]
        if [step.data_id for step in sends] == [item.name]:
            waits = [
                f"wait {microseconds(step.microseconds)}" for step in procedure.steps if isinstance(step, WaitStep)
            ]
            times = f"{sends[0].times} times"
            apart = f"at least {microseconds(sends[0].microseconds)} apart" if sends[0].microseconds else ""
            yield "Send it " + joined([link(times, f"#procedure-{procedure.name}"), apart, *waits], ", ")


def _frame_of(interface: Rs485, sender: str, data_id: int) -> Layout | None:
    return next((item for item in interface.layouts if item.sender == sender and data_id in item.selects), None)


def _commands(device: Device, variant: Variant) -> Iterator[Row]:
    """Yield rows of task and bytes to send for every procedure that writes or sends something."""
    for item in device.procedures:
        if any(isinstance(step, (WriteStep, ModifyStep)) for step in item.steps):
            sent = joined((_sent(device, step, variant) for step in item.steps), ", ")
            yield link(text(item.title), f"#procedure-{item.name}"), sent


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
    placed = register.layout.place(variant.parameters).field(name)
    return bits(placed.high, placed.low) if placed is not None else code(name)


def zero_of(device: Device, register: Register, variant: Variant) -> bytes | None:
    """Return the bytes of a register that holds the position 0, or None for a register with anything else."""
    if register not in _preset_registers(device):
        return None
    constants = codec_of(device, register.layout).constants
    total = 0
    for item in register.layout.place(variant.parameters).fields:
        if item.name in constants:
            total |= constants[item.name] << item.low
        elif not isinstance(meaning_of(item.field), (Raw, TwosComplement)):
            return None
    return register.bytes_of(total)
