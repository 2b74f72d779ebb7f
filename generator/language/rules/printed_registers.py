"""Rules for registers that the manual prints twice: their addresses, its list of defaults, and writes to them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

from ..problems import DocumentReport, quoted
from ..written_codes import WrittenPrintedDefault, WrittenRegister
from ..written_parts import WrittenProcedure, WrittenSpec, WrittenStep
from .parts import Groups, by_name, fields_of, last_address

#: The highest and the lowest bit, as in ``7:6``.
_BIT_RANGE_TEXT = re.compile(r"([0-9]{1,4}):([0-9]{1,4})")
#: A printed write, as in ``0x48 = 0x01``, ``0x49 bit 2 = 0`` or ``0x50-0x54``.
_PRINTED_WRITE = re.compile(
    r"(?P<first>0x[0-9A-Fa-f]+)(?:-(?P<last>0x[0-9A-Fa-f]+))?(?: bit (?P<bit>[0-9]+))?(?: = (?P<value>\w+))?"
)


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
                f"{quoted(register.name)} is printed at {_address_text(printed_lowest, printed_highest)}; "
                f"'address' {register.address:#04x} and 'length' {register.length} "
                f"result in {_address_text(register.address, highest_address)}"
            )
            report.add("addresses-mismatch", register.place_of("addresses"), message)


def _address_text(lowest: int, highest: int) -> str:
    return f"{lowest:#04x}" if lowest == highest else f"{lowest:#04x} to {highest:#04x}"


def check_default_lists(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``printed_defaults``, the manual's list of defaults, matches the registers.

    A row gives the ``bytes`` of a whole register, or the ``value`` of some of its bits (``at``). An erratum explains a
    row that differs.
    """
    registers = by_name(spec.registers)
    for row in spec.printed_defaults:
        has_bytes = bool(row.bytes)
        has_place = row.at is not None
        has_value = row.value is not None
        has_whole_register = has_bytes and not has_place and not has_value
        has_some_bits = not has_bytes and has_place and has_value
        if not has_whole_register and not has_some_bits:
            message = "a row has either 'bytes' for the whole register, or 'at' and 'value' for some of its bits"
            report.add("default-mismatch", row.path, message)
            continue
        register = registers.get(row.register)
        if register is not None:
            _check_row(row, register, report)


def _check_row(row: WrittenPrintedDefault, register: WrittenRegister, report: DocumentReport) -> None:
    """Check that a row of the manual's defaults matches its register, or names an erratum that explains the difference.

    Only the first difference is reported. An erratum that is named by a correct row is reported too.
    """
    differences = list(_differences_of_bytes(row, register) if row.bytes else _differences_of_bits(row, register))
    if differences and not row.erratum:
        difference = differences[0]
        report.add("default-mismatch", row.place_of(difference.key), difference.message)
    elif not differences and row.erratum:
        message = f"the row is correct, so {quoted(row.erratum)} explains nothing; remove 'erratum'"
        report.add("default-mismatch", row.place_of("erratum"), message)


class _Difference(NamedTuple):
    """A message about a row of the manual's defaults that differs from its register, and the differing key."""

    key: str
    message: str


def _differences_of_bytes(row: WrittenPrintedDefault, register: WrittenRegister) -> Iterator[_Difference]:
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
    bit_range = _parse_bit_range(row.at)
    if bit_range is None:
        message = f"{quoted(row.at)} is not a position; write a bit number, or a range such as 7:6"
        yield _Difference("at", message)
        return
    if register.default is None:
        yield _Difference("value", f"{name} has no 'default' that contains these bits")
    else:
        width = bit_range.highest - bit_range.lowest + 1
        mask = (1 << width) - 1
        default_bits = (register.default >> bit_range.lowest) & mask
        if default_bits != row.value:
            problem = f"the 'default' of {name} is {register.default:#x}, which gives {default_bits} in these bits"
            yield _Difference("value", f"{problem}, but the manual prints {row.value}")
    yield from _differences_of_field(row, register, bit_range)


class _BitRange(NamedTuple):
    """The highest and the lowest bit of a place in a register."""

    highest: int
    lowest: int


def _differences_of_field(
    row: WrittenPrintedDefault, register: WrittenRegister, bits_of_row: _BitRange
) -> Iterator[_Difference]:
    """Yield the difference if a row has other bits than its field, or another name for the number."""
    field = by_name(register.fields).get(row.field)
    if field is None:  # Reported by the rule on references, or the field is in a group.
        return
    if field.at is not None and _parse_bit_range(field.at) != bits_of_row:
        yield _Difference("at", f"{quoted(row.field)} is at {field.at}, but {row.at} is printed")
    names_of_number = [name for name, value in field.values.items() if value.value == row.value]
    printed_name = row.is_
    if printed_name and printed_name not in names_of_number:
        actual_name = f"is {quoted(names_of_number[0])}" if names_of_number else "has no name"
        message = f"{row.value} {actual_name} in {quoted(row.field)}, but {quoted(printed_name)} is printed"
        yield _Difference("is", message)


def _parse_bit_range(place: int | str | None) -> _BitRange | None:
    """Return the bits of a place such as ``7:6`` or 5, or None if it is not a place."""
    if isinstance(place, int):
        is_bit_of_register = 0 <= place < 1024  # No register has more bits.
        return _BitRange(place, place) if is_bit_of_register else None
    match = _BIT_RANGE_TEXT.fullmatch(str(place))
    if match is None:
        return None
    bit_range = _BitRange(*map(int, match.groups()))
    return bit_range if bit_range.highest >= bit_range.lowest else None


@dataclass(frozen=True)
class _Write:
    """A write: the addresses, the bit if it is a single one, and the number, or None if the caller supplies it."""

    first_address: int
    last_address: int
    bit: int | None
    value: int | None

    def __str__(self) -> str:
        """Return the write as text, such as ``0x48 = 0x01``, ``0x49 bit 2 = 0`` or ``0x50-0x54``."""
        text = f"{self.first_address:#04x}"
        if self.last_address > self.first_address:
            text += f"-{self.last_address:#04x}"
        if self.bit is not None:
            text += f" bit {self.bit}"
        if self.value is not None:
            text += f" = {self.value:#04x}" if self.bit is None else f" = {self.value}"
        return text


def check_writes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``printed_writes``, the writes that the manual prints for a procedure, match its steps.

    A procedure with a step that is not completely known is not checked.
    """
    registers = by_name(spec.registers)
    groups = by_name(spec.field_groups)
    for procedure in spec.procedures:
        write_steps = [step for step in procedure.steps if step.do == "write"]
        writes = [_write_of_step(step, registers, groups) for step in write_steps]
        are_all_known = None not in writes
        if procedure.printed_writes and are_all_known:
            _compare_writes(procedure, write_steps, writes, report)


def _compare_writes(
    procedure: WrittenProcedure, write_steps: list[WrittenStep], writes: list[_Write | None], report: DocumentReport
) -> None:
    """Report each printed write that differs from the step at the same place, and each step without a printed write.

    ``writes`` contains the write that each of the ``write_steps`` carries out.
    """
    for index, printed_text in enumerate(procedure.printed_writes):
        printed_write = _parse_write(printed_text)
        printed_path = (*procedure.path, "printed_writes", index)
        if index >= len(write_steps):
            report.add("writes-mismatch", printed_path, f"{printed_write} is printed, but no step writes it")
        elif printed_write != writes[index]:
            line, _ = report.document.position(write_steps[index].path)
            message = f"{printed_write} is printed, but the step on line {line} writes {writes[index]}"
            report.add("writes-mismatch", printed_path, message)
    steps_without_print = write_steps[len(procedure.printed_writes) :]
    for step in steps_without_print:
        report.add("writes-mismatch", step.path, "this write is not among the 'printed_writes'")


def _parse_write(write_text: str) -> _Write:
    """Return the write that a text of ``printed_writes`` describes, such as ``0x49 bit 2 = 0`` or ``0x50-0x54``."""
    match = _PRINTED_WRITE.fullmatch(write_text)
    assert match is not None  # The schema uses the same pattern.
    first_text, last_text, bit_text, value_text = match.group("first", "last", "bit", "value")
    return _Write(
        first_address=int(first_text, 16),
        last_address=int(last_text or first_text, 16),
        bit=int(bit_text) if bit_text else None,
        value=int(value_text, 0) if value_text else None,
    )


def _write_of_step(step: WrittenStep, registers: Mapping[str, WrittenRegister], groups: Groups) -> _Write | None:
    """Return the write that a step of a procedure carries out, or None if it is not completely known.

    With ``field``, only the bits of this field are written, and the result contains the lowest one. Otherwise the whole
    register is written, with the value in the bits of the field that has it.
    """
    register = registers.get(step.register)
    if register is None or not step.value:
        return None
    register_fields = list(fields_of(register, groups))
    possible_fields = [field for field in register_fields if step.field in ("", field.name)]
    # The field that has the value. Without such a field, the value is an argument, whose number the caller supplies.
    fields_with_value = [field for field in possible_fields if step.value in field.values]
    number = None
    if fields_with_value:
        number = fields_with_value[0].values[step.value].value
    write_of_register = _Write(register.address, last_address(register), bit=None, value=number)
    is_value_of_register = not fields_with_value or len(register_fields) == 1
    if not step.field and is_value_of_register:
        return write_of_register
    written_fields = fields_with_value or possible_fields
    bit_range = _parse_bit_range(written_fields[0].at) if written_fields else None
    if bit_range is None:
        return None
    if step.field:
        return replace(write_of_register, bit=bit_range.lowest)
    return replace(write_of_register, value=(number or 0) << bit_range.lowest)
