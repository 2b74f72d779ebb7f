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
        numbers = (int(first, 0), int(last or first, 0))
        has = (register["address"], last_address(register))
        if numbers != has:
            wrong = (
                f"{quoted(register['name'])} is printed at {_addresses(*numbers)}; 'address' {register['address']:#04x}"
                f" and 'length' {register['length']} result in {_addresses(*has)}"
            )
            report.add("addresses-mismatch", (*path, "addresses"), wrong)


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
                wrong = f"the label {quoted(text)} must be {expression.render()}, which is {number} here"
                report.add("label-mismatch", (*path, "values", text, "sets"), wrong)


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
            wrong = "a row has either 'bytes' for the whole register, or 'at' and 'value' for some of its bits"
            report.add("default-mismatch", path, wrong)
            continue
        register = registers.get(row["register"])
        if register is None:
            continue
        found = next(_row_faults(row, register), None)
        if found is not None and "erratum" not in row:
            report.add("default-mismatch", (*path, found[0]), found[1])
        if found is None and "erratum" in row:
            wrong = f"the row is correct, so {quoted(row['erratum'])} explains nothing; leave 'erratum' out"
            report.add("default-mismatch", (*path, "erratum"), wrong)


def _row_faults(row: Spec, register: Spec) -> Iterator[tuple[str, str]]:
    name, default = quoted(register["name"]), register.get("default")
    if "bytes" in row:
        printed = bytes.fromhex(row["bytes"])
        order = "little" if register.get("byte_order") == "low_byte_first" else "big"
        number = int.from_bytes(printed, order)  # type: ignore[arg-type]
        if len(printed) != register["length"]:
            yield "bytes", f"{name} has {register['length']} bytes, but {len(printed)} are printed"
        elif default is None:
            yield "bytes", f"{name} has no 'default', but the printed bytes are {number:#x}"
        elif default != number:
            yield "bytes", f"the 'default' of {name} is {default:#x}, but the printed bytes are {number:#x}"
        return
    bounds = _bounds(row["at"])
    if bounds is None:
        yield "at", f"{quoted(row['at'])} is not a position; write a bit number, or a range such as 7:6"
        return
    high, low = bounds
    held = (default or 0) >> low & (1 << high - low + 1) - 1
    if default is None:
        yield "value", f"{name} has no 'default' that contains these bits"
    elif held != row["value"]:
        gives = f"the 'default' of {name} is {default:#x}, which gives {held} in these bits"
        yield "value", f"{gives}, but the manual prints {row['value']}"
    yield from _field_faults(row, register, bounds)


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
    values = mapping(field, "values")
    if "is" in row and mapping(values, row["is"]).get("value") != row["value"]:
        right = next((name for name, item in values.items() if mapping(item).get("value") == row["value"]), None)
        what = f"is {quoted(right)}" if right else "has no name"
        yield "is", f"{row['value']} {what} in {quoted(row['field'])}, but {quoted(row['is'])} is printed"


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
        bit = "" if self.bit is None else f" bit {self.bit}"
        value = "" if self.value is None else f" = {self.value}" if self.bit is not None else f" = {self.value:#04x}"
        return f"{self.first:#04x}{f'-{self.last:#04x}' if self.last > self.first else ''}{bit}{value}"


def writes(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the printed writes of a procedure match its steps."""
    registers, groups = by_name(spec, "registers"), by_name(spec, "field_groups")
    for path, procedure in items(spec, "procedures"):
        printed = [_printed(text) for text in procedure.get("printed_writes", ())]
        steps = [(below, step) for below, step in items(procedure, "steps") if step["do"] == "write"]
        made = [_made(step, registers, groups) for _, step in steps]
        if not printed or any(write is None for write in made):
            continue
        for index, write in enumerate(printed):
            if index >= len(made):
                wrong = f"{write} is printed, but no step writes it"
                report.add("writes-mismatch", (*path, "printed_writes", index), wrong)
            elif write != made[index]:
                line = report.document.position((*path, *steps[index][0]))[0]
                wrong = f"{write} is printed, but the step on line {line} writes {made[index]}"
                report.add("writes-mismatch", (*path, "printed_writes", index), wrong)
        for below, _ in steps[len(printed) :]:
            report.add("writes-mismatch", (*path, *below), "this write is not among the 'printed_writes'")


def _printed(text: str) -> _Write:
    found = _WRITE.fullmatch(text)
    assert found is not None  # The schema has the same pattern.
    first = int(found["first"], 16)
    last = first if found["last"] is None else int(found["last"], 16)
    bit = None if found["bit"] is None else int(found["bit"])
    return _Write(first, last, bit, None if found["value"] is None else int(found["value"], 0))


def _made(step: Spec, registers: Mapping[str, Spec], groups: Mapping[str, Spec]) -> _Write | None:
    """Return the write of a step, or None if the text does not determine it or another rule reports the step."""
    register = registers.get(step.get("register", ""))
    if register is None or "value" not in step:
        return None
    fields = [field for _, field in expanded(Fields(Has.REGISTER, register, (), ""), groups)]
    name = step.get("field")
    of = next((item for item in fields if name in (None, item.get("name")) and step["value"] in _values(item)), None)
    number = None if of is None else mapping(_values(of), step["value"]).get("value")
    address, last = register["address"], last_address(register)
    if name is None and (of is None or len(fields) == 1):
        return _Write(address, last, None, number)
    bounds = _bounds(mapping(of or next((item for item in fields if item.get("name") == name), {})).get("at"))
    if bounds is None:
        return None
    low = bounds[1]
    return _Write(address, last, low, number) if name is not None else _Write(address, last, None, (number or 0) << low)


def _values(field: Spec) -> Spec:
    return mapping(field, "values")


def _addresses(first: int, last: int) -> str:
    return f"{first:#04x}" if first == last else f"{first:#04x} to {last:#04x}"
