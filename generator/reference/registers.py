"""Decode registers, list the writes of a procedure, and identify an encoder and its edition by its registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..model import (
    NOT_KNOWN,
    Device,
    Erratum,
    ModifyStep,
    Number,
    PlacedLayout,
    Procedure,
    Register,
    Variant,
    Write,
    WriteStep,
    cite,
    member_named,
    number_from_bytes,
    number_to_bytes,
)
from ..model.expressions import Expression
from ..model.registers import name_with_limits, value_bounds
from ..order_codes.labels import LabelMatch, edition_before, edition_tests_of_register
from ..order_codes.parameters import RegisterError, after_write
from ..say import count_with_unit, frame_texts
from ..say.frame_texts import register_length_message
from .bits_and_values import EncodeError, bits_of_field, number_of_text, with_bits
from .codec import decode, encode
from .findings import DecodedFrame, ValueDifference


def decode_register(device: Device, variant: Variant, name: str, data: bytes) -> DecodedFrame:
    """Decode a register from its bytes in ascending order of address. Its name is not case-sensitive.

    Raises:
        RegisterError: This interface does not have the register, or the register has a different length.
    """
    registers = {register.name: register for register in device.registers_over(variant.interface)}
    register_name = name.lower()
    if register_name not in registers:
        for erratum in device.errata:
            message = _unknown_register_message(device, erratum, register_name)
            if message:
                raise RegisterError(message)
        available = f"it has: {', '.join(registers)}" if registers else "it has none"
        raise RegisterError(f"{variant.code} has no register '{name}'; {available}")
    register = registers[register_name]
    if len(data) != register.length:
        needed_length = count_with_unit(register.length, "byte")
        actual_length = count_with_unit(len(data), "byte")
        raise RegisterError(register_length_message(register.name, needed_length, actual_length))
    placed_layout = register.layout.place(variant.parameters)
    return decode(device, placed_layout, number_from_bytes(register.layout, data))


def _unknown_register_message(device: Device, erratum: Erratum, name: str) -> str:
    """Return an error message if an erratum says that an edition or overlay does not describe a register.

    Return an empty string if the erratum does not apply to this register, or not to this device.
    """
    # For such an erratum, ``printed`` lists the unknown registers, separated by commas.
    concerns_register = erratum.used == NOT_KNOWN and name in erratum.printed.split(", ")
    # The device of the latest edition also has errata about older editions.
    concerns_device = bool(erratum.overlay or device.edition)
    if not concerns_register or not concerns_device:
        return ""
    if erratum.edition:
        scope = f"in edition {device.edition} of the manual"
    else:
        scope = f"according to the overlay {erratum.overlay}"
    return f"'{name}' is unknown {scope}: {erratum.why} [{cite(erratum.source)}]"


#: The lowest and the highest value of an argument, each None if there is no such limit.
Limits = tuple["Expression | None", "Expression | None"]


def register_writes(
    device: Device, procedure: Procedure, variant: Variant, arguments: Mapping[str, int]
) -> tuple[Write, ...]:
    """Return the writes of a procedure in order: one per byte, or one per register that is written at once.

    Written values can change the limits of later steps. A step that writes only one field keeps the other bits of the
    register: as the procedure has written them before, or as in the default of the register, which is 0 if the manual
    gives none.

    Raises:
        EncodeError: An argument is missing, does not fit its register or field, or is not a valid content.
    """
    writes: list[Write] = []
    meaning_by_argument = {argument.name: argument.meant_as for argument in procedure.arguments}
    # The current content of each register that the procedure has written.
    content_by_register: dict[str, int] = {}
    for step in procedure.steps:
        if not isinstance(step, (WriteStep, ModifyStep)):
            continue
        register = device.register(step.register)
        placed_layout = register.layout.place(variant.parameters)
        value = _value_of_step(step, arguments)
        if step.value is None:
            # A register can have several meanings with different limits.
            meaning_name = meaning_by_argument.get(step.value_name, "")
            limits = device.limits(register, meaning_name)
            field_name = _name_of_written_field(register, step)
            _check_argument(value, register, field_name, placed_layout, limits)
        if isinstance(step, ModifyStep):
            old_content = content_by_register.get(step.register, register.default or 0)
            content = _with_field_changed(placed_layout, step.field, field_value=value, old_content=old_content)
        elif step.value is None:
            content = _content_for_argument(device, register, placed_layout, value)
        else:
            content = value
        content_by_register[step.register] = content
        variant = after_write(device, variant, register, content)
        writes += _writes_of_register(register, content)
    return tuple(writes)


def _value_of_step(step: WriteStep | ModifyStep, arguments: Mapping[str, int]) -> int:
    """Return the number that a step writes: its fixed value, or the argument that it names.

    Raises:
        EncodeError: ``arguments`` does not contain the argument.
    """
    if step.value is not None:
        return step.value
    if step.value_name not in arguments:
        raise EncodeError(f"the argument '{step.value_name}' is missing")
    return arguments[step.value_name]


def _name_of_written_field(register: Register, step: WriteStep | ModifyStep) -> str:
    """Return the name of the field that a step writes. For a whole register, it is the field with its limits."""
    return step.field if isinstance(step, ModifyStep) else name_with_limits(register)


def _writes_of_register(register: Register, content: int) -> list[Write]:
    """Return one write per byte, or a single write of the number if the register is written at once."""
    if register.is_accessed_whole:
        return [Write(register.address, content)]
    data = number_to_bytes(register.layout, content, 8 * register.length)
    return [Write(register.address + offset, byte) for offset, byte in enumerate(data)]


def _with_field_changed(placed_layout: PlacedLayout, field_name: str, field_value: int, old_content: int) -> int:
    """Return the content of a register after a value is written to one of its fields. The other bits are unchanged.

    Raises:
        EncodeError: The value does not fit, or this order code has no such field.
    """
    placed_field = placed_layout.find_field(field_name)
    if placed_field is None:
        raise EncodeError(f"{field_value} does not fit '{field_name}'")
    is_too_wide = field_value & ~placed_field.mask != 0
    if is_too_wide:
        raise EncodeError(f"{field_value} does not fit '{field_name}'")
    return with_bits(old_content, placed_field, field_value)


def _content_for_argument(device: Device, register: Register, placed_layout: PlacedLayout, argument: int) -> int:
    """Return the content of a register to which an argument is written.

    The argument is the value of the field or joined number to which the limits of the register apply. Without such a
    field, it is the content itself.

    Raises:
        EncodeError: The argument does not fit, or is not a valid content.
    """
    name = name_with_limits(register)
    names_of_numbers = {field.name for field in register.layout.fields if isinstance(field.kind, Number)}
    names_of_numbers |= {join.name for join in register.layout.joins}
    if name in names_of_numbers or register.limits_of == name:
        return encode(device, placed_layout, {name: argument})
    # The argument is the number in the whole register.
    problems = decode(device, placed_layout, argument).problems
    if problems:
        first_problem = problems[0]
        raise EncodeError(f"{argument:#x} is not a value of '{register.name}': {first_problem.message}")
    return argument


def _check_argument(
    argument: int, register: Register, field_name: str, placed_layout: PlacedLayout, limits: Limits
) -> None:
    """Check that an argument is a named value of the field, if it has any, and that it is within the limits.

    The limits are checked if they belong to a meaning of the register, or if the register's own limits apply to this
    field.

    Raises:
        EncodeError: The argument is not valid.
    """
    allowed_values: list[int] = []
    for field in register.layout.fields:
        if field.name == field_name:
            allowed_values += [named_value.value for named_value in field.values]
    if allowed_values and argument not in allowed_values:
        raise EncodeError(f"{argument} is not a value of '{field_name}'")
    lowest, highest = value_bounds(register, placed_layout, limits, placed_layout.parameters)
    # The limits of a meaning apply to the field or register to which the argument is written.
    has_limits_of_meaning = limits != (register.min, register.max)
    is_limited = has_limits_of_meaning or field_name == name_with_limits(register)
    if is_limited and not lowest <= argument <= highest:
        raise EncodeError(frame_texts.outside_limits_message(f"{argument}", f"{lowest}", f"{highest}"))


def _identity_registers(device: Device, variant: Variant) -> Iterator[Register]:
    """Yield the registers whose documented contents identify the encoder, such as the device ID.

    Registers in banks are omitted, because their addresses are not unique.
    """
    names = {register.name for register, _ in device.identity if register.bank is None}
    return (register for register in device.registers_over(variant.interface) if register.name in names)


def identifying_addresses(device: Device, variant: Variant) -> frozenset[int]:
    """Return the addresses of the registers whose documented contents identify an encoder with this order code."""
    addresses: set[int] = set()
    for register in _identity_registers(device, variant):
        addresses.update(_list_addresses(register))
    return frozenset(addresses)


def _list_addresses(register: Register) -> range:
    """Return the addresses of all bytes of a register."""
    return range(register.address, register.last_address + 1)


def compare_identifying_registers(
    device: Device, variant: Variant, bytes_by_address: Mapping[int, int]
) -> tuple[ValueDifference, ...]:
    """Return the fields of identifying registers whose contents show that the encoder has a different order code.

    Registers that ``bytes_by_address`` does not contain are unknown, and are not compared.
    """
    differences: list[ValueDifference] = []
    for register in _identity_registers(device, variant):
        differences += _compare_register(variant, register, bytes_by_address)
    return tuple(differences)


def _compare_register(
    variant: Variant, register: Register, bytes_by_address: Mapping[int, int]
) -> Iterator[ValueDifference]:
    """Yield the fields of a register whose known bits differ from the values that the manual gives for an order code.

    Bytes that ``bytes_by_address`` lacks are unknown. The message shows the field in hexadecimal, with a dot for each
    unknown digit.
    """
    placed_layout = register.layout.place(variant.parameters)
    addresses = _list_addresses(register)
    register_bytes = bytes(bytes_by_address.get(address, 0) for address in addresses)
    masks_of_bytes = bytearray()  # 0xFF for each byte that is known.
    for address in addresses:
        masks_of_bytes.append(0xFF if address in bytes_by_address else 0)
    content = number_from_bytes(register.layout, register_bytes)
    known_mask = number_from_bytes(register.layout, bytes(masks_of_bytes))
    for placed_field in placed_layout.fields:
        documented = placed_field.field.documented(variant.parameters)
        if documented is None:
            continue
        documented_bits = number_of_text(documented) if isinstance(documented, str) else documented
        known_bits = bits_of_field(placed_field, known_mask)
        actual_bits = bits_of_field(placed_field, content) & known_bits
        matches_documentation = actual_bits == documented_bits & known_bits
        if matches_documentation:
            continue
        path = f"{register.name}.{placed_field.name}" if len(placed_layout.fields) > 1 else register.name
        is_completely_known = known_bits == placed_field.mask
        if is_completely_known:
            message = frame_texts.undocumented_content_message(
                path, f"{actual_bits:#04x}", variant.code, f"{documented_bits:#04x}"
            )
        else:
            actual_digits = _known_digits(actual_bits, known_bits, placed_field.width)
            documented_digits = _known_digits(documented_bits, known_bits, placed_field.width)
            message = f"{path}: the given part is {actual_digits}, {variant.code} has {documented_digits}"
        yield ValueDifference(path, actual=actual_bits, documented=documented_bits, message=message, is_register=True)


def _known_digits(field_bits: int, known_bits: int, width: int) -> str:
    """Return the hexadecimal digits of a field with ``width`` bits, with dots for unknown digits, such as ``..A3h``.

    The bits of the field that are known are 1 in ``known_bits``. A digit is known if all of its bits are known.
    """
    text = ""
    all_bits = (1 << width) - 1
    highest_digit_shift = (width - 1) // 4 * 4  # A digit is 4 bits. The highest digit may have fewer.
    for shift in range(highest_digit_shift, -1, -4):
        bits_of_digit = (all_bits >> shift) & 0xF
        known_bits_of_digit = (known_bits >> shift) & bits_of_digit
        digit = (field_bits >> shift) & 0xF
        text += f"{digit:X}" if known_bits_of_digit == bits_of_digit else "."
    return text + "h"


def values_of_older_edition(device: Device, decoded: DecodedFrame) -> Iterator[ValueDifference]:
    """Yield values of a register that show that an older edition of the manual applies to the encoder.

    An edition has tests: a register field, ``run``, whose value must be from ``min`` to ``max`` in encoders of this
    edition. Frames have no such tests.
    """
    is_register = decoded.layout is not None and not decoded.layout.layout.sender
    if decoded.layout is None or not is_register:
        return
    register = decoded.layout.name
    number_by_field = {field.name: field.raw for field in decoded.fields}
    for revision, test in edition_tests_of_register(device, register):
        number = number_by_field.get(test.run)
        if number is None or test.min <= number <= test.max:
            continue
        bounds = f"{test.min} to {test.max}"
        message = frame_texts.older_edition_message(
            run=test.run,
            actual=f"{number}",
            bounds=bounds,
            revision=revision,
            register=register,
            before=edition_before(device, revision),
        )
        yield ValueDifference(test.run, actual=number, documented=bounds, message=message, is_register=True)


def edition_by_registers(device: Device, match: LabelMatch, bytes_by_address: Mapping[int, int]) -> str:
    """Return the revision of the latest edition of the manual that is compatible with the registers of an encoder.

    An edition has tests: a register field, ``run``, whose value must be from ``min`` to ``max`` in encoders of this
    edition. The result is the revision before the first edition with a failed test, or the revision of the spec if no
    test fails.

    Raises:
        ValueError: ``bytes_by_address`` has no complete register that identifies the edition.
    """
    has_register = False
    for edition in device.editions:
        for test in edition.tests:
            register = device.register(test.register)
            addresses = _list_addresses(register)
            is_complete = bytes_by_address.keys() >= set(addresses)
            if not is_complete:
                continue
            has_register = True
            register_bytes = bytes(bytes_by_address[address] for address in addresses)
            content = number_from_bytes(register.layout, register_bytes)
            placed_layout = register.layout.place(match.variant.parameters)
            decoded_register = decode(device, placed_layout, content)
            tested_field = member_named(decoded_register.fields, test.run, f"field of '{register.name}'")
            if not test.min <= tested_field.raw <= test.max:
                return edition_before(device, edition.revision)
    if not has_register:
        raise ValueError(_missing_registers_message(device))
    return device.manual.revision


def without_edition_registers(device: Device, bytes_by_address: Mapping[int, int]) -> dict[int, int]:
    """Return the register bytes by address, without the bytes of registers that identify the edition of the manual."""
    edition_addresses: set[int] = set()
    for name in _names_of_edition_registers(device):
        edition_addresses.update(_list_addresses(device.register(name)))
    return {address: value for address, value in bytes_by_address.items() if address not in edition_addresses}


def _names_of_edition_registers(device: Device) -> list[str]:
    """Return the names of the registers whose values identify the edition of the manual, without duplicates."""
    names = (test.register for edition in device.editions for test in edition.tests)
    return list(dict.fromkeys(names))


def _missing_registers_message(device: Device) -> str:
    """Return the message that lists the command-line options for the registers that identify the edition.

    The options for a register of two bytes are, for example, ``--register 0x10=0x.. --register 0x11=0x..``.
    """
    names = _names_of_edition_registers(device)
    if not names:
        return f"no register of {device.name} identifies the edition"
    options_by_register = []
    for name in names:
        addresses = _list_addresses(device.register(name))
        options = [f"--register 0x{address:02X}=0x.." for address in addresses]
        options_by_register.append(" ".join(options))
    names_text = " or ".join(names)
    options_text = "; or ".join(options_by_register)
    return f"to infer the edition, give all of {names_text}: {options_text}"
