"""Rules for registers: their addresses, access and defaults, also as the manual and texts repeat them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Literal, NamedTuple

from ...model import INTERFACES
from ..keys_of_fields import WrittenField, WrittenPrintedDefault, WrittenRegister
from ..keys_of_specs import WrittenErratum, WrittenSpec
from ..problems import DocumentReport, Path, quoted
from .parts import (
    BitRange,
    FieldOwner,
    by_name,
    field_lists,
    interface_name_of,
    is_explained_at,
    is_second_reading,
    last_address,
    parse_bit_range,
    position_names,
)
from .walk import KEYS_OF_TEXTS, SECTIONS_NOT_ABOUT_ENCODER, is_derived, leaves_of


def check_addresses(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``addresses``, the addresses that the manual prints for a register, match its address and length."""
    for register in spec.registers:
        if register.addresses is None:
            continue
        lowest_text, _, highest_text = str(register.addresses).partition("-")  # ``0x4B`` or ``0x4B-0x4E``
        printed_lowest = int(lowest_text, 0)  # Base 0 reads 0x4B as hexadecimal.
        printed_highest = int(highest_text, 0) if highest_text else printed_lowest
        highest_address = last_address(register)
        if (printed_lowest, printed_highest) != (register.address, highest_address):
            message = (
                f"{quoted(register.name)} is printed at {_range_of_addresses(printed_lowest, printed_highest)}; "
                f"'address' {register.address:#04x} and 'length' {register.length} "
                f"result in {_range_of_addresses(register.address, highest_address)}"
            )
            report.add("addresses-mismatch", register.path_of("addresses"), message)


def _range_of_addresses(lowest: int, highest: int) -> str:
    return f"{lowest:#04x}" if lowest == highest else f"{lowest:#04x} to {highest:#04x}"


def check_default_lists(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``printed_defaults``, the manual's list of defaults, matches the registers.

    A row gives the ``bytes`` of a whole register, or the ``value`` of some of its bits (``at``). An erratum explains a
    row that differs.
    """
    register_by_name = by_name(spec.registers)
    for row in spec.printed_defaults:
        has_bytes = bool(row.bytes)
        names_bits = row.at is not None
        has_value = row.value is not None
        has_whole_register = has_bytes and not names_bits and not has_value
        has_some_bits = not has_bytes and names_bits and has_value
        if not has_whole_register and not has_some_bits:
            message = "a row has either 'bytes' for the whole register, or 'at' and 'value' for some of its bits"
            report.add("default-mismatch", row.path, message)
            continue
        register = register_by_name.get(row.register)
        if register is not None:
            _check_row_of_defaults(row, register, report)


def _check_row_of_defaults(row: WrittenPrintedDefault, register: WrittenRegister, report: DocumentReport) -> None:
    """Check that a row of the manual's defaults matches its register, or names an erratum that explains the difference.

    Only the first difference is reported. An erratum that is named by a correct row is reported too.
    """
    differences = list(
        _differences_of_whole_register(row, register) if row.bytes else _differences_of_bits(row, register)
    )
    if differences and not row.erratum:
        difference = differences[0]
        report.add("default-mismatch", row.path_of(difference.key), difference.message)
    elif not differences and row.erratum:
        message = f"the row is correct, so {quoted(row.erratum)} explains nothing; remove 'erratum'"
        report.add("default-mismatch", row.path_of("erratum"), message)


class _Difference(NamedTuple):
    """A message about a row of the manual's defaults that differs from its register, and the differing key."""

    key: str
    message: str


def _differences_of_whole_register(row: WrittenPrintedDefault, register: WrittenRegister) -> Iterator[_Difference]:
    """Yield the difference between the printed bytes and the default of a register. Nothing if they are equal."""
    name = quoted(register.name)
    default = register.default
    printed_bytes = bytes.fromhex(row.bytes)
    byte_order: Literal["little", "big"] = "little" if register.byte_order == "low_byte_first" else "big"
    number = int.from_bytes(printed_bytes, byte_order)
    if len(printed_bytes) != register.length:
        yield _Difference("bytes", f"{name} has {register.length} bytes, but {len(printed_bytes)} are printed")
    elif default is None:
        yield _Difference("bytes", f"{name} has no 'default', but the printed bytes are {number:#x}")
    elif default != number:
        message = f"the 'default' of {name} is {default:#x}, but the printed bytes are {number:#x}"
        yield _Difference("bytes", message)


def _differences_of_bits(row: WrittenPrintedDefault, register: WrittenRegister) -> Iterator[_Difference]:
    """Yield each difference between a row about some bits and a register."""
    name = quoted(register.name)
    bit_range = parse_bit_range(row.at)
    if bit_range is None:
        message = f"{quoted(row.at)} is not a position; write a bit number, or a range such as 7:6"
        yield _Difference("at", message)
        return
    if register.default is None:
        yield _Difference("value", f"{name} has no 'default' that contains these bits")
    else:
        width = bit_range.highest - bit_range.lowest + 1
        mask_of_width = (1 << width) - 1  # ``width`` ones.
        default_bits = (register.default >> bit_range.lowest) & mask_of_width
        if default_bits != row.value:
            problem = f"the 'default' of {name} is {register.default:#x}, which gives {default_bits} in these bits"
            yield _Difference("value", f"{problem}, but the manual prints {row.value}")
    yield from _differences_of_field(row, register, bit_range)


def _differences_of_field(
    row: WrittenPrintedDefault, register: WrittenRegister, bits_of_row: BitRange
) -> Iterator[_Difference]:
    """Yield the difference if a row has other bits than its field, or another name for the number."""
    field = by_name(register.fields).get(row.field)
    if field is None:  # Reported by the rule on references, or the field is in a group.
        return
    if field.at is not None and parse_bit_range(field.at) != bits_of_row:
        yield _Difference("at", f"{quoted(row.field)} is at {field.at}, but {row.at} is printed")
    names_of_number = [name for name, value in field.values.items() if value.value == row.value]
    printed_name = row.is_
    if printed_name and printed_name not in names_of_number:
        actual_name = f"is {quoted(names_of_number[0])}" if names_of_number else "has no name"
        message = f"{row.value} {actual_name} in {quoted(row.field)}, but {quoted(printed_name)} is printed"
        yield _Difference("is", message)


def check_register_range(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that all bytes of a register are within the addresses of its interface, or of its bank."""
    for register in spec.registers:
        interface = INTERFACES[interface_name_of(register)]
        if register.bank is not None and interface.highest_in_bank is not None:
            area_text = f"a bank of {interface.short}"
            highest_address = interface.highest_in_bank
        elif interface.highest_address is not None:
            area_text = f"the address range of {interface.short}"
            highest_address = interface.highest_address
        else:
            area_text = "the range of register addresses"
            highest_address = 0xFFFF
        end_address = last_address(register)
        if end_address > highest_address:
            extent = f"{quoted(register.name)} extends to {end_address:#x}"
            message = f"{extent}, but {area_text} ends at {highest_address:#x}"
            report.add("register-range", register.path_of("address"), message)


_BIT = r"\d{1,3}(?::\d{1,3})?"
#: The place of a field: its highest and its lowest bit, or its only one.
_FIELD_BITS = re.compile(r"([0-9]{1,4})(?::([0-9]{1,4}))?")
#: Bits that a sentence calls unused without a condition.
_CALLED_UNUSED = re.compile(
    rf"(?:^|[.;] )bits? ({_BIT}(?:(?:,| and|, and) {_BIT})*) (?:is|are) (?:not used|unused)(?=[.;]|$)", re.IGNORECASE
)
#: An access in words. The group is ``read`` or ``write``.
_ACCESS_IN_WORDS = re.compile(r"\b(?:is|are) (read|write)[ -]only\b")


def check_unused_bits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register has no field at bits that its note calls unused.

    A constant, unused bits and a field that is always 0 carry no data, so they may be there.
    """
    for field_list in field_lists(spec):
        unused_bits = set(_bits_called_unused(field_list.owner.note))
        if field_list.owner_kind is not FieldOwner.REGISTER or not unused_bits:
            continue
        for field in field_list.fields:
            contradicting_bits = unused_bits.intersection(_bits_in_range_text(field.at))
            carries_data = field.constant is None and field.unused is None and field.equals != 0
            if contradicting_bits and carries_data:
                message = (
                    f"the note says that bit {min(contradicting_bits)} is not used, but {quoted(field.name)} uses it; "
                    "one of the two is wrong"
                )
                report.add("unused-bits", field.path_of("at"), message)


def _bits_in_range_text(bit_or_range: int | str | None) -> range:
    """Return the bits of a range such as ``7:6`` or of the single bit ``5``. Empty for None, and for other text."""
    match = _FIELD_BITS.fullmatch(str(bit_or_range))
    if match is None:
        return range(0)
    highest_text, lowest_text = match.groups()
    highest_bit = int(highest_text)
    lowest_bit = int(lowest_text) if lowest_text else highest_bit
    return range(lowest_bit, highest_bit + 1)


def _bits_called_unused(note: str) -> Iterator[int]:
    """Yield the bits that a note calls unused, such as 6, 7 and 2 for ``bits 7:6 and 2 are not used``."""
    for match in _CALLED_UNUSED.finditer(note):
        listed_bits = match[1]  # ``7:6 and 2``
        for highest, lowest in re.findall(r"(\d{1,3})(?::(\d{1,3}))?", listed_bits):
            yield from range(int(lowest or highest), int(highest) + 1)


def check_repeated_access(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register whose fields all have a fixed value (``equals``) is not writable.

    A note or an erratum can explain it. Also check that registers have the access that errata about them state.
    """
    for register in spec.registers:
        fixed_fields = [field for field in register.fields if field.equals is not None]
        has_only_fixed_fields = bool(fixed_fields) and len(fixed_fields) == len(register.fields)
        is_explained_by_note = bool(register.note)
        if not has_only_fixed_fields or register.access != "read_write" or is_explained_by_note:
            continue
        if not is_explained_at(report.document, "registers", register.name, "access"):
            message = (
                f"all fields of {quoted(register.name)} have a fixed value ('equals'), so it should be read_only; "
                "if the manual says read_write, say so in a 'note'"
            )
            report.add("access-mismatch", register.path_of("access"), message)
    for erratum in spec.errata:
        _check_access_in_erratum(spec, erratum, report)


def _check_access_in_erratum(spec: WrittenSpec, erratum: WrittenErratum, report: DocumentReport) -> None:
    """Check that the registers that an erratum affects have the access that it states, ``read-only`` or ``write-only``.

    The key ``used`` of an erratum is its text about what applies instead of the manual. A text about bits or fields, or
    with both accesses, is not compared.
    """
    register_by_name = by_name(spec.registers)
    is_about_bits = re.search(r"\b(?:bit|field)", erratum.used, re.IGNORECASE) is not None
    stated_accesses = set(_ACCESS_IN_WORDS.findall(erratum.used))
    if is_about_bits or len(stated_accesses) != 1:
        return
    stated_access = f"{stated_accesses.pop()}_only"
    for affected_path in erratum.affects:
        section, _, name = affected_path.partition(".")
        if section != "registers" or name not in register_by_name:
            continue
        access = register_by_name[name].access
        if access != stated_access:
            message = f"this says {stated_access}, but {quoted(name)} is {access}; one of the two is wrong"
            report.add("access-mismatch", erratum.path_of("used"), message)


def check_zero_within_limits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check ``zero_means``, the number for which a stored 0 stands, against the highest number of its register.

    It may be at most one higher: in 16 bits, 0 can stand for 65536. A highest number that depends on the order code is
    not compared.
    """
    for register in spec.registers:
        for field in register.fields:
            meaning_of_zero = field.zero_means
            highest = register.max
            is_limited = register.limits_of in ("", field.name)
            if not is_limited or not isinstance(meaning_of_zero, int) or not isinstance(highest, int):
                continue
            if meaning_of_zero > highest + 1:
                message = (
                    f"zero stands for {meaning_of_zero}, which is above 'max' ({highest}); one of the two is wrong"
                )
                report.add("limit-does-not-fit", register.path_of("max"), message)


def check_cleared_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register that clears itself returns to 0, unless its note gives another number."""
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for register in spec.registers:
        default = register.default
        if register.clears_itself and default and not _contains_number(register.note, default):
            message = (
                f"{quoted(register.name)} clears itself, but its default is {default:#04x}; correct one of the two, or"
                f" say in a 'note' that it returns to {default:02X}h"
            )
            report.add("default-mismatch", register.path_of("default"), message)


def _contains_number(text: str, number: int) -> bool:
    """Return True if a text contains a number, in decimal or in hexadecimal."""
    return re.search(rf"\b(?:{number}|{number:02X}h|0x{number:02x})\b", text, re.IGNORECASE) is not None


def check_read_only_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register with only flags of alarms, or with the position, is writable only with a reason.

    The reason is a named value, a procedure that writes it, a key that matters only for writing, or a text with "writ".
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    written_names: set[str] = set()
    for procedure in spec.procedures:
        written_names.update(step.register for step in procedure.steps if step.do == "write")
    registers_of_alarms = {alarm.part.register for alarm in spec.alarms} | set(_explaining_registers(spec))
    for register in spec.registers:
        if register.access != "read_write":
            continue
        has_named_values = any(field.values for field in register.fields)
        can_be_written = has_named_values or register.name in written_names or register.has(*_KEYS_OF_WRITABLE)
        is_explained = "writ" in register.meaning.casefold() or "writ" in register.note.casefold()
        if can_be_written or is_explained:
            continue
        has_explained_flag = any(field.explained_by for field in register.fields)
        has_flag_of_alarm = has_explained_flag or register.name in registers_of_alarms
        has_only_flags = has_flag_of_alarm and all(map(_is_flag_or_fixed, register.fields))
        has_position = register.name in position_names(spec, interface_name_of(register))
        if has_only_flags or has_position:
            content_text = "flags of alarms" if has_only_flags else "the position"
            message = (
                f"{quoted(register.name)} has {content_text}, and nothing says what to write there; write 'access:"
                " read_only', or say in a 'note' what can be written"
            )
            report.add("access-mismatch", register.path_of("access"), message)


def _is_flag_or_fixed(field: WrittenField) -> bool:
    return bool(field.active) or field.constant is not None or field.unused is not None


def _explaining_registers(spec: WrittenSpec) -> Iterator[str]:
    """Yield the name of the register of each bit, written as ``register.bit``, that gives details of a flag.

    Names may repeat.
    """
    for register in spec.registers:
        for field in register.fields:
            for bit_path in field.explained_by:
                register_name, _, _ = bit_path.partition(".")
                yield register_name


#: Keys of a register that matter only if it is written.
_KEYS_OF_WRITABLE = ("default", "min", "max", "meanings", "opened_by", "clears_itself", "write_clears")


#: A sentence such as "The register automatically returns to 0" or "It returns to 00h by itself".
_RETURNS_BY_ITSELF = re.compile(
    r"\bautomatically returns to 0|\breturns to 0+h? (?:automatically|by itself)", re.IGNORECASE
)


def check_returning_registers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a register whose note says that it returns to 0 by itself has ``clears_itself: true``."""
    for register in spec.registers:
        if _RETURNS_BY_ITSELF.search(register.note) and not register.clears_itself:
            message = "the note says that the register returns to 0; write 'clears_itself: true', or correct the note"
            key = "clears_itself" if register.has("clears_itself") else "name"
            report.add("words-contradict", register.path_of(key), message)


#: An address or a command in a text, such as "register (1Fh)" or "command 03".
_REGISTER_AT = re.compile(r"\b[Rr]egisters? \(?(?P<address>[0-9A-F]{2})h\b")
_COMMANDS = re.compile(r"\b[Cc]ommands? [0-9A-F]{2}(?:(?:, (?:and )?| and | or )[0-9A-F]{2})*\b")
#: Keys of the numbers that a text may call a command.
_KEYS_OF_CODES = frozenset(("value", "constant", "control", "id"))


def check_addresses_and_commands(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers named by their address in texts, and commands named by their code, exist in the spec.

    A spec without registers is not checked, nor is ``printed``, the text of the manual that an erratum corrects.
    """
    registers = by_name(spec.registers).values()
    if not registers or is_derived(report.document):
        return
    register_addresses: set[int] = set()  # Of every byte.
    for register in registers:
        register_addresses.update(range(register.address, register.address + register.length))
    coded_values = [value for path, value in leaves_of(spec.data, report) if path[-1] in _KEYS_OF_CODES]
    known_codes = {value for value in coded_values if isinstance(value, int)}
    for path, text in leaves_of(spec.data, report):
        is_text = path[-1] in KEYS_OF_TEXTS or path[0] == "tables"
        if not isinstance(text, str) or path[0] in SECTIONS_NOT_ABOUT_ENCODER or not is_text:
            continue
        _check_addresses_in_text(text, register_addresses, path, report)
        for command_code in _command_codes(text):
            if known_codes.isdisjoint(_numbers_of_code(command_code)):
                named_command = quoted(f"command {command_code}")
                problem = f"the text says {named_command}, but nothing here has this value"
                report.add("left-behind", path, f"{problem}; correct one of the two", cause=command_code)


def _check_addresses_in_text(text: str, register_addresses: set[int], path: Path, report: DocumentReport) -> None:
    """Report each address in a text, as in ``register 4Bh``, that no register has."""
    for match in _REGISTER_AT.finditer(text):
        address_text = match["address"]
        if int(address_text, 16) not in register_addresses:
            named_register = quoted(f"register {address_text}h")
            message = f"the text says {named_register}, but no register has this address; correct one of the two"
            report.add("left-behind", path, message, cause=address_text)


def _numbers_of_code(code: str) -> set[int]:
    """Return the numbers that a code in a text can be, because manuals print codes in hexadecimal or in decimal."""
    return {int(code, 16), int(code)} if code.isdigit() else {int(code, 16)}


def _command_codes(text: str) -> Iterator[str]:
    """Yield the codes of commands in a text: ``01`` and ``03`` of ``commands 01 and 03``."""
    for commands in _COMMANDS.findall(text):
        yield from re.findall(r"\b[0-9A-F]{2}\b", commands)
