"""Rules for facts that a manual prints twice: lists of defaults, last addresses, writes of procedures, labels."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ...model.expressions import Expression, ExpressionError
from ..problems import DocumentReport, quoted
from .walk import Fields, Has, Spec, by_name, expanded, items, last_address, mapping

_RANGE = re.compile(r"([0-9]{1,4}):([0-9]{1,4})")
_WRITE = re.compile(
    r"(?P<first>0x[0-9A-Fa-f]+)(?:-(?P<last>0x[0-9A-Fa-f]+))?(?: bit (?P<bit>[0-9]+))?(?: = (?P<value>\w+))?"
)


def addresses(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the printed addresses match address and length."""
    for path, register in items(spec, "registers"):
        printed = register.get("addresses")
        if printed is None:
            continue
        first, _, last = str(printed).partition("-")
        printed_range = (int(first, 0), int(last or first, 0))
        actual_range = (register["address"], last_address(register))
        if printed_range != actual_range:
            message = (
                f"{quoted(register['name'])} is printed at {_address_text(*printed_range)}; "
                f"'address' {register['address']:#04x} and 'length' {register['length']} "
                f"result in {_address_text(*actual_range)}"
            )
            report.add("addresses-mismatch", (*path, "addresses"), message)


def labels(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the number on a label matches the expression of its part."""
    for path, part in items(spec, "order_code", "parts"):
        expression = _expression(part.get("label_is"))
        if expression is None:
            continue
        for text, value in part["values"].items():
            sets = mapping(value, "sets")
            if not text.isdecimal() or not sets.keys() >= set(expression.parameters):
                continue
            number = _value(expression, sets)
            if number is not None and int(text) != number:
                message = f"the label {quoted(text)} must be {expression.render()}, which is {number} here"
                report.add("label-mismatch", (*path, "values", text, "sets"), message)


def _expression(text: object) -> Expression | None:
    try:
        return Expression.parse(text) if isinstance(text, (int, str)) else None
    except ExpressionError:  # Reported by the rule on expressions.
        return None


def _value(expression: Expression, sets: Spec) -> int | None:
    try:
        return expression.value(sets)
    except ExpressionError:  # The exponent is out of range. Another rule reports it.
        return None


def default_lists(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the manual's list of defaults matches the registers, except for rows explained by an erratum."""
    registers = by_name(spec, "registers")
    for path, row in items(spec, "printed_defaults"):
        if ("bytes" in row) == ("value" in row) or ("bytes" in row) == ("at" in row):
            message = "a row has either 'bytes' for the whole register, or 'at' and 'value' for some of its bits"
            report.add("default-mismatch", path, message)
            continue
        register = registers.get(row["register"])
        if register is None:
            continue
        fault = next(_row_faults(row, register), None)
        if fault is not None and "erratum" not in row:
            report.add("default-mismatch", (*path, fault[0]), fault[1])
        if fault is None and "erratum" in row:
            message = f"the row is correct, so {quoted(row['erratum'])} explains nothing; leave 'erratum' out"
            report.add("default-mismatch", (*path, "erratum"), message)


def _row_faults(row: Spec, register: Spec) -> Iterator[tuple[str, str]]:
    """Yield the errors of a row of the manual's defaults, each with its key."""
    if "bytes" in row:
        yield from _byte_faults(row, register)
        return
    name, default = quoted(register["name"]), register.get("default")
    bounds = _bounds(row["at"])
    if bounds is None:
        yield "at", f"{quoted(row['at'])} is not a position; write a bit number, or a range such as 7:6"
        return
    high, low = bounds
    default_bits = (default or 0) >> low & (1 << high - low + 1) - 1
    if default is None:
        yield "value", f"{name} has no 'default' that contains these bits"
    elif default_bits != row["value"]:
        message = (
            f"the 'default' of {name} is {default:#x}, which gives {default_bits} in these bits, "
            f"but the manual prints {row['value']}"
        )
        yield "value", message
    yield from _field_faults(row, register, bounds)


def _byte_faults(row: Spec, register: Spec) -> Iterator[tuple[str, str]]:
    """Yield the error of a row with the bytes of the whole register."""
    name, default = quoted(register["name"]), register.get("default")
    printed_bytes = bytes.fromhex(row["bytes"])
    is_low_byte_first = register.get("byte_order") == "low_byte_first"
    number = int.from_bytes(printed_bytes, "little" if is_low_byte_first else "big")
    if len(printed_bytes) != register["length"]:
        yield "bytes", f"{name} has {register['length']} bytes, but {len(printed_bytes)} are printed"
    elif default is None:
        yield "bytes", f"{name} has no 'default', but the printed bytes are {number:#x}"
    elif default != number:
        yield "bytes", f"the 'default' of {name} is {default:#x}, but the printed bytes are {number:#x}"


def _field_faults(row: Spec, register: Spec, bounds: tuple[int, int]) -> Iterator[tuple[str, str]]:
    """Yield the errors of a row's field: a different place, or a different name of the number."""
    fields = by_name(register, "fields")
    if "field" not in row:
        return
    field = fields.get(row["field"])
    if field is None:  # Reported by the rule on references, or the field is in a group.
        return
    if "at" in field and _bounds(field["at"]) != bounds:
        yield "at", f"{quoted(row['field'])} is at {field['at']}, but {row['at']} is printed"
    numbers = {name: mapping(value).get("value") for name, value in mapping(field, "values").items()}
    if "is" in row and numbers.get(row["is"]) != row["value"]:
        correct_name = next((name for name, number in numbers.items() if number == row["value"]), None)
        meaning = f"is {quoted(correct_name)}" if correct_name else "has no name"
        yield "is", f"{row['value']} {meaning} in {quoted(row['field'])}, but {quoted(row['is'])} is printed"


def _bounds(at: object) -> tuple[int, int] | None:
    if isinstance(at, int):
        return (at, at) if 0 <= at < 1024 else None
    match = _RANGE.fullmatch(str(at))
    bounds = (int(match[1]), int(match[2])) if match is not None else (0, 1)
    return bounds if bounds[0] >= bounds[1] else None


@dataclass(frozen=True)
class _Write:
    """A write: the addresses, the bit if it is a single one, and the number, or None if the caller supplies it."""

    first: int
    last: int
    bit: int | None
    value: int | None

    def __str__(self) -> str:
        text = f"{self.first:#04x}"
        if self.last > self.first:
            text += f"-{self.last:#04x}"
        if self.bit is not None:
            text += f" bit {self.bit}"
        if self.value is not None:
            text += f" = {self.value:#04x}" if self.bit is None else f" = {self.value}"
        return text


def writes(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the printed writes of a procedure match its steps."""
    registers, groups = by_name(spec, "registers"), by_name(spec, "field_groups")
    for path, procedure in items(spec, "procedures"):
        printed_writes = [_printed_write(text) for text in procedure.get("printed_writes", ())]
        steps = [(step_path, step) for step_path, step in items(procedure, "steps") if step["do"] == "write"]
        step_writes = [_step_write(step, registers, groups) for _, step in steps]
        if not printed_writes or any(write is None for write in step_writes):
            continue
        for index, write in enumerate(printed_writes):
            if index >= len(step_writes):
                message = f"{write} is printed, but no step writes it"
                report.add("writes-mismatch", (*path, "printed_writes", index), message)
            elif write != step_writes[index]:
                line = report.document.position((*path, *steps[index][0]))[0]
                message = f"{write} is printed, but the step on line {line} writes {step_writes[index]}"
                report.add("writes-mismatch", (*path, "printed_writes", index), message)
        for step_path, _ in steps[len(printed_writes) :]:
            report.add("writes-mismatch", (*path, *step_path), "this write is not among the 'printed_writes'")


def _printed_write(text: str) -> _Write:
    """Return the write that a text of ``printed_writes`` describes."""
    match = _WRITE.fullmatch(text)
    assert match is not None  # The schema has the same pattern.
    first = int(match["first"], 16)
    last = first if match["last"] is None else int(match["last"], 16)
    bit = None if match["bit"] is None else int(match["bit"])
    value = None if match["value"] is None else int(match["value"], 0)
    return _Write(first=first, last=last, bit=bit, value=value)


def _step_write(step: Spec, registers: Mapping[str, Spec], groups: Mapping[str, Spec]) -> _Write | None:
    """Return the write of a step, or None if the text does not determine it or another rule reports the step."""
    register = registers.get(step.get("register", ""))
    if register is None or "value" not in step:
        return None
    fields = [field for _, field in expanded(Fields(Has.REGISTER, register, (), ""), groups)]
    name = step.get("field")
    candidates = [field for field in fields if name in (None, field.get("name"))]
    valued_field = next((field for field in candidates if step["value"] in mapping(field, "values")), None)
    number = None if valued_field is None else mapping(valued_field, "values", step["value"]).get("value")
    address, last = register["address"], last_address(register)
    if name is None and (valued_field is None or len(fields) == 1):
        return _Write(first=address, last=last, bit=None, value=number)
    named_field = next((field for field in fields if field.get("name") == name), {})
    bounds = _bounds(mapping(valued_field or named_field).get("at"))
    if bounds is None:
        return None
    low_bit = bounds[1]
    if name is None:
        return _Write(first=address, last=last, bit=None, value=(number or 0) << low_bit)
    return _Write(first=address, last=last, bit=low_bit, value=number)


def _address_text(first: int, last: int) -> str:
    return f"{first:#04x}" if first == last else f"{first:#04x} to {last:#04x}"
