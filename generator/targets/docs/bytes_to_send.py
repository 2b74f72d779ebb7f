"""The section of an order code's page about the bytes to send: requests, presets and commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ...model import (
    Biss,
    DataId,
    Device,
    Input,
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
from ...plan.codec import layout_plan_of
from ...plan.frames import RequestAndReply, exchanges
from ...plan.values import TwosComplement, UnsignedNumber, meaning_of
from ...say.commands_and_alarms import Commands, commands_over
from ...say.layout import name_as_words
from ...say.names_and_evidence import addresses_text, bits, register_at, title_of, word_for_document
from ...say.order_code import PURPOSES, word_lengths
from ...say.text import code_span, count_with_unit, escape, join_filled, markdown_link, time_text

Row = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SendingSection:
    """Requests and commands with their bytes, and facts about them.

    ``other_value`` is a sentence on how to write a preset other than 0, or empty without a preset.
    """

    facts: tuple[str, ...]
    requests: tuple[Row, ...]
    commands: tuple[Row, ...]
    command_errata: str
    other_value: str


def sending_section(
    family_device: Device, device: Device, interface: Interface, variant: Variant, errata_at: Callable[..., str]
) -> SendingSection:
    """Return the section about the bytes to send for an order code.

    ``device`` is ``family_device`` reduced to the order code. ``errata_at`` returns links to errata that change bytes.
    """
    # In this order, because ``errata_at`` lists the errata in the order of its calls.
    requests = tuple(_request_rows(device, interface, errata_at))
    commands = tuple(_command_rows(device, variant, errata_at))
    preset_registers = list(_registers_with_known_zero(device, variant))
    introduction = _introduction_paragraphs(
        device,
        interface,
        possible_commands=commands_over(device, interface),
        has_rows=bool(commands),
        has_preset=bool(preset_registers),
    )
    facts = list(introduction)
    input_links = ", ".join(map(_input_link, device.inputs))
    if input_links:
        facts.append(f"Inputs: {input_links}.")
    other_value = ""
    if preset_registers:
        preset_register = family_device.register(preset_registers[0].name)
        other_value = _how_to_write_other_positions(preset_register, variant)
    return SendingSection(
        facts=tuple(facts),
        requests=requests,
        commands=commands,
        command_errata=_command_errata(device, errata_at),
        other_value=other_value,
    )


def _input_link(hardware_input: Input) -> str:
    """Return a link to the section about a hardware input, labeled with its title."""
    return markdown_link(escape(title_of(hardware_input)), f"#input-{hardware_input.name}")


def _introduction_paragraphs(
    device: Device, interface: Interface, *, possible_commands: Commands, has_rows: bool, has_preset: bool
) -> Iterator[str]:
    """Yield sentences on the notation of the bytes, and on what the interface does not have, such as a preset.

    A sentence says that there is no preset, reset or save only if nothing in the spec may be one. ``has_rows`` is True
    if the page has rows of commands, and ``has_preset`` if a register is a preset whose bytes for 0 are known.
    """
    match interface:
        case Ssi():
            denial = " It has no preset, reset or save command." if possible_commands.is_empty else ""
            yield f"SSI only reads the position.{denial}"
            yield from _sentences_on_writable_registers(possible_commands)
        case Biss():
            yield from _introduction_for_biss(device, possible_commands, has_rows=has_rows, has_preset=has_preset)
        case Rs485() if not interface.exchanges:
            yield "Bytes are in hexadecimal."
            yield from _commands_missing_in_t_format(device, possible_commands)
            yield from _sentences_on_writable_registers(possible_commands)
        case Rs485() | Spi():
            yield "The frames of the master are requests. The frames of the encoder answer them."
        case _:
            assert_never(interface)


def _introduction_for_biss(
    device: Device, possible_commands: Commands, *, has_rows: bool, has_preset: bool
) -> Iterator[str]:
    """Yield sentences on the rows of commands over BiSS or, without rows, on the commands that the encoder may have.

    The statement that it has no commands is included only if the spec covers a whole manual.
    """
    if has_preset:
        # The script of the site changes this sentence together with the bytes.
        preset_sentence = '<span id="preset-of-rows">The preset is 0 in these rows.</span>'
        yield f"Addresses and bytes are in hexadecimal. {preset_sentence}"
    elif has_rows and not possible_commands.may_preset:
        yield f"The {word_for_document(device)} describes no preset over BiSS."
    elif has_rows:
        yield "Addresses and bytes are in hexadecimal."
        yield from _sentences_on_writable_registers(possible_commands)
    elif possible_commands.registers or possible_commands.settings:
        yield from _sentences_on_writable_registers(possible_commands)
    elif not possible_commands.is_empty:
        yield f"The {word_for_document(device)} describes no registers that can be written over BiSS."
    elif word_for_document(device) == "manual" and not device.evidence.left_out:
        yield "The manual describes no commands over BiSS: no preset, reset or save."
    else:
        yield f"The {word_for_document(device)} describes no commands over BiSS. The encoder may have some."


def _sentences_on_writable_registers(possible_commands: Commands) -> Iterator[str]:
    """Yield a sentence for each register that accepts commands, and one about all other writable registers."""
    for register in possible_commands.registers:
        command_names: list[str] = []
        for field in register.layout.fields:
            command_names += [code_span(title_of(command)) for command in field.values]
        yield f"Write a command to {_register_link(register)}: {', '.join(command_names)}."
    if possible_commands.settings:
        subject = "Other registers" if possible_commands.registers else "Registers"
        register_links = ", ".join(map(_register_link, possible_commands.settings))
        yield f"{subject} that can be written: {register_links}."


def _register_link(register: Register) -> str:
    """Return a link to a register, labeled with its addresses and its title."""
    return markdown_link(f"{addresses_text(register)} {escape(title_of(register))}", f"#register-{register.name}")


def _commands_missing_in_t_format(device: Device, possible_commands: Commands) -> Iterator[str]:
    """Yield the sentence that there is no preset and no save command, or nothing if anything may be a preset.

    If anything may be a save command, the sentence is only about the preset.
    """
    if possible_commands.may_preset:
        return
    exception_text = " other than the resets" if possible_commands.resets else ""
    save_text = "" if possible_commands.may_save else ", and no save command"
    there_is = "There is" if word_for_document(device) == "manual" else "The spec describes"
    yield f"{there_is} no preset{exception_text}{save_text}."


def _preset_registers(device: Device) -> Iterator[Register]:
    """Yield the preset registers: those to which procedures write their argument ``position``."""
    for procedure in device.procedures:
        for argument in procedure.arguments:
            if argument.name == "position":
                yield device.register(argument.of)


def _registers_with_known_zero(device: Device, variant: Variant) -> Iterator[Register]:
    """Yield the preset registers for which the bytes of a preset of 0 are known."""
    for register in _preset_registers(device):
        if bytes_of_zero_position(device, register, variant) is not None:
            yield register


def _how_to_write_other_positions(register: Register, variant: Variant) -> str:
    """Return a sentence on how to write a preset other than 0 to a register, with an example.

    Return an empty string if the field of the position has no bits for this order code.
    """
    # The limits of a preset register apply to the field of the position, which may begin above bit 0.
    placed_layout = register.layout.place(variant.parameters)
    lowest_position_bit, position_width = placed_layout.lowest_bit_and_width_of(register.limits_of)
    if not position_width:
        return ""
    length_text = count_with_unit(register.length, "byte")
    # The byte order is "high byte first" or "low byte first".
    byte_order = register.byte_order.replace("_", " ")
    factor_text = f" × 2^{lowest_position_bit}" if lowest_position_bit else ""
    highest_position = (1 << position_width) - 1
    example_position = min(1000, highest_position)
    example_bytes = register.bytes_of(example_position << lowest_position_bit)
    example_in_hexadecimal = code_span(example_bytes.hex(" ").upper())
    # The script of the page finds the rows of commands by the text of the link, which is only the addresses.
    addresses = addresses_text(register)
    addresses_link = markdown_link(addresses, f"#register-{register.name}")
    linked_register = register_at(register).replace(addresses, addresses_link)
    return (
        f"To set a different position, write position{factor_text} as {length_text}, {byte_order}, to "
        f"{linked_register}. For {example_position:,}: {example_in_hexadecimal}."
    )


def _request_rows(device: Device, interface: Interface, errata_at: Callable[..., str]) -> Iterator[Row]:
    """Yield rows of request with reply, meaning."""
    for exchange in exchanges(interface):
        yield _exchange_row(exchange)
    if isinstance(interface, Rs485):
        for data_id in interface.data_ids:
            yield _data_id_row(device, interface, data_id, errata_at)


def _exchange_row(request_and_reply: RequestAndReply) -> Row:
    """Return a row of request with reply, meaning.

    The meaning is the purpose of the request or, without a purpose, the first sentence of the note on it. The size of
    its words follows if the spec states one.
    """
    layouts = [layout for layout in (request_and_reply.request, request_and_reply.reply) if layout is not None]
    frame_links = [markdown_link(code_span(layout.name), f"#layout-{layout.name}") for layout in layouts]
    first_sentence_of_note = request_and_reply.request.note.partition(". ")[0].removesuffix(".")
    purpose_and_size = PURPOSES[request_and_reply.exchange.purpose] or escape(first_sentence_of_note)
    word_bits = request_and_reply.exchange.word_bits
    if word_bits is not None:
        word_size = f"in words of {word_lengths([word_bits])}"
        purpose_and_size = f"{purpose_and_size}, {word_size}" if purpose_and_size else word_size
    # capitalize() would also change the case of the other letters.
    return " → ".join(frame_links), purpose_and_size[:1].upper() + purpose_and_size[1:]


def _data_id_row(device: Device, interface: Rs485, data_id: DataId, errata_at: Callable[..., str]) -> Row:
    """Return a row of request with reply, meaning for a T-format request.

    The request is shown as its control byte, followed by the names of its other parts: ``C2, address, data``. The
    meaning is followed by the repetitions in procedures that send only this request, by the data ID, and by errata.
    """
    request = _layout_with_data_id(interface, sender="master", data_id=data_id.id)
    reply = _layout_with_data_id(interface, sender="encoder", data_id=data_id.id)
    part_names = _names_after_control_field(request) if request is not None else []
    control_byte = code_span(f"{data_id.control:02X}")
    frames_cell = ", ".join([control_byte, *part_names])
    if reply is not None:
        reply_length = count_with_unit(reply.widest // 8, "byte")
        reply_link = markdown_link(reply_length, f"#layout-{reply.name}")
        frames_cell += f" → {reply_link}"
    procedures = _procedures_sending_only(device, data_id)
    repetitions = map(_repetition_text, procedures)
    meaning_and_repetitions = join_filled([escape(data_id.meaning or data_id.purpose), *repetitions], ". ")
    data_id_and_name = f"<small>Data ID {data_id.id:X} {code_span(data_id.name)}</small>"
    spec_paths = [f"procedures.{procedure.name}" for procedure in procedures]
    meaning_cell = join_filled([f"{meaning_and_repetitions}.", data_id_and_name, errata_at(*spec_paths)], " ")
    return frames_cell, meaning_cell


def _names_after_control_field(request: Layout) -> list[str]:
    """Return the names of the parts that follow the control field of a request. A group of fields counts as one part.

    The control field is the group of the first field. If this field is not in a group, all fields are listed.
    """
    control_group = request.fields[0].group
    part_names: dict[str, None] = {}
    for field in request.fields:
        is_in_control_field = bool(field.group) and field.group == control_group
        if not is_in_control_field:
            part_names[field.group or field.name] = None
    # For "preset of turns", only "preset" is shown.
    return [escape(name_as_words(part_name).partition(" of ")[0]) for part_name in part_names]


def _procedures_sending_only(device: Device, data_id: DataId) -> list[Procedure]:
    """Return the procedures that send this request and no other."""
    return [procedure for procedure in device.procedures if _requests_sent(procedure) == [data_id.name]]


def _requests_sent(procedure: Procedure) -> list[str]:
    """Return the names of the requests that a procedure sends, in order."""
    return [step.data_id for step in procedure.steps if isinstance(step, SendStep)]


def _repetition_text(procedure: Procedure) -> str:
    """Return how often a procedure sends its only request, such as ``Send it 10 times, at least 40 µs apart``."""
    send_step = next(step for step in procedure.steps if isinstance(step, SendStep))
    wait_texts = [f"wait {time_text(step.microseconds)}" for step in procedure.steps if isinstance(step, WaitStep)]
    times_link = markdown_link(f"{send_step.times} times", f"#procedure-{procedure.name}")
    interval_text = f"at least {time_text(send_step.microseconds)} apart" if send_step.microseconds else ""
    return "Send it " + join_filled([times_link, interval_text, *wait_texts], ", ")


def _layout_with_data_id(interface: Rs485, *, sender: str, data_id: int) -> Layout | None:
    """Return the frame from a sender, ``master`` or ``encoder``, that a data ID identifies, or None without one."""
    layouts_of_sender = [layout for layout in interface.layouts if layout.sender == sender]
    # ``selects`` are the data IDs that identify a frame.
    return next((layout for layout in layouts_of_sender if data_id in layout.selects), None)


def _writing_procedures(device: Device) -> list[Procedure]:
    """Return the procedures that write a register or a field of a register."""
    return [procedure for procedure in device.procedures if _has_write_step(procedure)]


def _has_write_step(procedure: Procedure) -> bool:
    return any(isinstance(step, (WriteStep, ModifyStep)) for step in procedure.steps)


def _command_rows(device: Device, variant: Variant, errata_at: Callable[..., str]) -> Iterator[Row]:
    """Yield rows of task, bytes to write for the procedures that write registers.

    Errata about a field that a step changes are in its row. Errata about whole registers are not in the rows.
    """
    for procedure in _writing_procedures(device):
        steps_in_bytes = [_step_in_bytes(device, step, variant) for step in procedure.steps]
        modify_steps = [step for step in procedure.steps if isinstance(step, ModifyStep)]
        changed_fields = [f"registers.{step.register}.{step.field}" for step in modify_steps]
        errata_links = errata_at(exactly=changed_fields) if changed_fields else ""
        task = markdown_link(escape(procedure.title), f"#procedure-{procedure.name}")
        bytes_to_write = join_filled(steps_in_bytes, ", ")
        yield task, join_filled([bytes_to_write, errata_links], ". ")


def _command_errata(device: Device, errata_at: Callable[..., str]) -> str:
    """Return links to the errata about procedures that write registers, and about these registers as a whole."""
    procedure_paths, register_paths = list[str](), list[str]()
    for procedure in _writing_procedures(device):
        procedure_paths.append(f"procedures.{procedure.name}")
        register_paths += [f"registers.{step.register}" for step in procedure.steps if isinstance(step, WriteStep)]
    # Each path only once, in this order.
    spec_paths = dict.fromkeys((*procedure_paths, *register_paths))
    return errata_at(*spec_paths, exactly=register_paths) if spec_paths else ""


def _step_in_bytes(device: Device, step: Step, variant: Variant) -> str:
    """Return a step of a procedure in short, such as ``wait 1 ms``, or an address with the bytes to write."""
    match step:
        case WaitStep():
            return f"wait {time_text(step.microseconds)}"
        case SendStep():
            return code_span(step.request.hex(" ").upper())
        case ReadStep():
            addresses = addresses_text(device.register(step.register))
            return f"read {addresses}"
        case PollStep():
            addresses = addresses_text(device.register(step.register))
            return f"read {addresses} until {code_span(step.field)} is {step.value}"
        case ModifyStep():
            register = device.register(step.register)
            field_bits = _bits_of_field(register, step.field, variant)
            # Without a value in the spec, the caller of the procedure provides it.
            new_value = "the new value" if step.value is None else f"{step.value}"
            return f"{addresses_text(register)}: {field_bits} = {new_value}"
        case WriteStep():
            register = device.register(step.register)
            bytes_to_write = _bytes_to_write(device, register, step.value, variant)
            return f"{addresses_text(register)}: {bytes_to_write}"
        case _:
            assert_never(step)


def _bytes_to_write(device: Device, register: Register, value: int | None, variant: Variant) -> str:
    """Return the bytes to write to a register: those of a value or, if it is None, those of a preset of 0.

    If these are unknown, return ``the new value``.
    """
    register_bytes = bytes_of_zero_position(device, register, variant) if value is None else register.bytes_of(value)
    if register_bytes is None:
        return "the new value"
    return code_span(register_bytes.hex(" ").upper())


def _bits_of_field(register: Register, name: str, variant: Variant) -> str:
    """Return the bits of a field in a register, or its name if it has no bits for this order code."""
    placed_field = register.layout.place(variant.parameters).find_field(name)
    return bits(placed_field.highest_bit, placed_field.lowest_bit) if placed_field is not None else code_span(name)


def bytes_of_zero_position(device: Device, register: Register, variant: Variant) -> bytes | None:
    """Return the bytes that set a preset register to the position 0, or None if they are unknown.

    Constants keep their values, and numbers are 0. The bytes are unknown if the register has any other field, or if it
    is not a preset register.
    """
    if register not in _preset_registers(device):
        return None
    constant_by_field = layout_plan_of(device, register.layout).constants
    register_value = 0
    for placed_field in register.layout.place(variant.parameters).fields:
        if placed_field.name in constant_by_field:
            register_value |= constant_by_field[placed_field.name] << placed_field.lowest_bit
        elif not isinstance(meaning_of(placed_field.field), (UnsignedNumber, TwosComplement)):
            return None
    return register.bytes_of(register_value)
