"""Rules for registers that the manual prints twice: their addresses, its list of defaults, and writes to them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

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
        first_text, _, last_text = str(register.addresses).partition("-")
        # A single address is the first and the last one. Base 0 reads 0x4B as hexadecimal.
        printed_range = (int(first_text, 0), int(last_text or first_text, 0))
        actual_range = (register.address, last_address(register))
        if printed_range != actual_range:
            message = (
                f"{quoted(register.name)} is printed at {_address_text(*printed_range)}; "
                f"'address' {register.address:#04x} and 'length' {register.length} "
                f"result in {_address_text(*actual_range)}"
            )
            report.add("addresses-mismatch", register.place_of("addresses"), message)


def _address_text(first: int, last: int) -> str:
    return f"{first:#04x}" if first == last else f"{first:#04x} to {last:#04x}"


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
        key, message = differences[0]
        report.add("default-mismatch", row.place_of(key), message)
    elif not differences and row.erratum:
        message = f"the row is correct, so {quoted(row.erratum)} explains nothing; remove 'erratum'"
        report.add("default-mismatch", row.place_of("erratum"), message)


def _differences_of_bytes(row: WrittenPrintedDefault, register: WrittenRegister) -> Iterator[tuple[str, str]]:
    """Yield the key and the message of a difference between the printed bytes and the default of a register.

    Nothing is yielded if they are equal.
    """
    name = quoted(register.name)
    default = register.default
    printed_bytes = bytes.fromhex(row.bytes)
    byte_order: Literal["little", "big"] = "little" if register.byte_order == "low_byte_first" else "big"
    number = int.from_bytes(printed_bytes, byte_order)
    if len(printed_bytes) != register.length:
        yield "bytes", f"{name} has {register.length} bytes, but {len(printed_bytes)} are printed"
    elif default is None:
        yield "bytes", f"{name} has no 'default', but the printed bytes are {number:#x}"
    elif default != number:
        yield "bytes", f"the 'default' of {name} is {default:#x}, but the printed bytes are {number:#x}"


def _differences_of_bits(row: WrittenPrintedDefault, register: WrittenRegister) -> Iterator[tuple[str, str]]:
    """Yield the key and the message of each difference between a row about some bits and a register."""
    name = quoted(register.name)
    bounds = _parse_bit_range(row.at)
    if bounds is None:
        yield "at", f"{quoted(row.at)} is not a position; write a bit number, or a range such as 7:6"
        return
    if register.default is None:
        yield "value", f"{name} has no 'default' that contains these bits"
    else:
        high, low = bounds
        mask = (1 << (high - low + 1)) - 1
        default_bits = (register.default >> low) & mask
        if default_bits != row.value:
            problem = f"the 'default' of {name} is {register.default:#x}, which gives {default_bits} in these bits"
            yield "value", f"{problem}, but the manual prints {row.value}"
    yield from _differences_of_field(row, register, bounds)


def _differences_of_field(
    row: WrittenPrintedDefault, register: WrittenRegister, bounds: tuple[int, int]
) -> Iterator[tuple[str, str]]:
    """Yield the key and the message if a row has other bits than its field, or another name for the number.

    ``bounds`` are the highest and the lowest bit of the row.
    """
    field = by_name(register.fields).get(row.field)
    if field is None:  # Reported by the rule on references, or the field is in a group.
        return
    if field.at is not None and _parse_bit_range(field.at) != bounds:
        yield "at", f"{quoted(row.field)} is at {field.at}, but {row.at} is printed"
    names = [name for name, value in field.values.items() if value.value == row.value]
    if row.is_ and row.is_ not in names:
        actual = f"is {quoted(names[0])}" if names else "has no name"
        yield "is", f"{row.value} {actual} in {quoted(row.field)}, but {quoted(row.is_)} is printed"


def _parse_bit_range(at: int | str | None) -> tuple[int, int] | None:
    """Return the highest and the lowest bit of a place such as ``7:6`` or 5, or None if it is not a place."""
    if isinstance(at, int):
        is_bit_of_register = 0 <= at < 1024  # No register has more bits.
        return (at, at) if is_bit_of_register else None
    bit_range = _BIT_RANGE_TEXT.fullmatch(str(at))
    if bit_range is None:
        return None
    high, low = int(bit_range[1]), int(bit_range[2])
    return (high, low) if high >= low else None


@dataclass(frozen=True)
class _Write:
    """A write: the addresses, the bit if it is a single one, and the number, or None if the caller supplies it."""

    first: int
    last: int
    bit: int | None
    value: int | None

    def __str__(self) -> str:
        """Return the write as text, such as ``0x48 = 0x01``, ``0x49 bit 2 = 0`` or ``0x50-0x54``."""
        text = f"{self.first:#04x}"
        if self.last > self.first:
            text += f"-{self.last:#04x}"
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
        steps = [step for step in procedure.steps if step.do == "write"]
        step_writes = [_write_of_step(step, registers, groups) for step in steps]
        if procedure.printed_writes and None not in step_writes:
            _compare_writes(procedure, steps, step_writes, report)


def _compare_writes(
    procedure: WrittenProcedure,
    steps: list[WrittenStep],
    step_writes: list[_Write | None],
    report: DocumentReport,
) -> None:
    """Report each printed write that differs from the step at the same place, and each step without a printed write."""
    for index, text in enumerate(procedure.printed_writes):
        printed_write = _parse_write(text)
        printed_path = (*procedure.path, "printed_writes", index)
        if index >= len(steps):
            report.add("writes-mismatch", printed_path, f"{printed_write} is printed, but no step writes it")
        elif printed_write != step_writes[index]:
            line, _ = report.document.position(steps[index].path)
            message = f"{printed_write} is printed, but the step on line {line} writes {step_writes[index]}"
            report.add("writes-mismatch", printed_path, message)
    for step in steps[len(procedure.printed_writes) :]:
        report.add("writes-mismatch", step.path, "this write is not among the 'printed_writes'")


def _parse_write(write_text: str) -> _Write:
    """Return the write that a text of ``printed_writes`` describes, such as ``0x49 bit 2 = 0`` or ``0x50-0x54``."""
    match = _PRINTED_WRITE.fullmatch(write_text)
    assert match is not None  # The schema uses the same pattern.
    first, last, bit, value = match.group("first", "last", "bit", "value")
    return _Write(
        first=int(first, 16),
        last=int(first if last is None else last, 16),
        bit=None if bit is None else int(bit),
        value=None if value is None else int(value, 0),
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
    first = register.address
    last = last_address(register)
    writes_whole_register = not step.field and (not fields_with_value or len(register_fields) == 1)
    if writes_whole_register:
        return _Write(first=first, last=last, bit=None, value=number)
    written_fields = fields_with_value or possible_fields
    bounds = _parse_bit_range(written_fields[0].at) if written_fields else None
    if bounds is None:
        return None
    _, low_bit = bounds
    if not step.field:
        return _Write(first=first, last=last, bit=None, value=(number or 0) << low_bit)
    return _Write(first=first, last=last, bit=low_bit, value=number)
