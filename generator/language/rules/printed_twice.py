"""Rules for facts that a manual or a spec gives twice: text that repeats data, lists of defaults, and repetitions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ...model.expressions import Expression, ExpressionError
from ..document import Path
from ..problems import DocumentReport, quoted
from .values import constant_width
from .walk import Fields, Has, Spec, by_name, expanded, field_lists, interface_of, items, last_address, layouts, mapping

#: Names of interfaces in manuals, without RS-485, which is also the name of the signals.
_INTERFACES = {"ssi": re.compile(r"\bSSI\b"), "biss": re.compile(r"\bBiSS\b", re.IGNORECASE)}
_ANY_INTERFACE = re.compile(r"\bSSI\b|\bBiSS\b|\bRS-?485\b", re.IGNORECASE)

#: Numbers: binary in quotes, hexadecimal as in 0x1F or 0Ah, binary as in 0b01. Plain digits may be a name.
_IN_QUOTES = re.compile(r"\"([01]+)\"|'([01]+)'|“([01]+)”")
_WITH_PREFIX = re.compile(r"0[xX][0-9A-Fa-f]+|0b[01]+")
_WITH_SUFFIX = re.compile(r"((?:0[0-9A-F]*|[0-9A-F]*[A-F][0-9A-F]*))h")


#: A length, perhaps as a quotient, and a voltage: one with its tolerance, or two.
_DECIMAL = r"[0-9]{1,3}(?:,[0-9]{3})+|[0-9]+(?:\.[0-9]+)?"
_LENGTH = re.compile(rf"(?<![\d.,/])(?:({_DECIMAL}) ?/ ?)?({_DECIMAL}) ?(mm|[µμ]m|nm)\b(?!/)")
_NANOMETRES = {
    **dict.fromkeys(("nm", "nanometres", "nanometers"), 1),
    **dict.fromkeys(("µm", "μm", "um", "micrometres", "micrometers"), 1000),
    **dict.fromkeys(("mm", "millimetres", "millimeters"), 1_000_000),
}
_VOLT = r"\+?([0-9]+(?:\.[0-9]+)?) ?V(?: ?DC|dc)?"
_ONE_VOLTAGE = re.compile(rf"{_VOLT}(?: ?± ?([0-9]+(?:\.[0-9]+)?) ?%)?")
_TWO_VOLTAGES = re.compile(rf"{_VOLT} ?(?:to|-|–|…|\.\.\.|(?=\+)) ?{_VOLT}")
#: Way out of a contradiction between the meaning of an order code value and its settings.
MEANING_DIFFERS = "; if the manual prints it so, give the reason in 'meaning_differs'"


def value_words(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the meaning of an order code value agrees with its settings: code, length and supply."""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            if "meaning_differs" in value:
                continue
            meaning, value_path, sets = value.get("meaning", ""), (*path, "values", text), mapping(value, "sets")
            for name, expected in _codes_named(spec, value).items():
                if value["sets"][name] != expected:
                    word = "Gray" if expected else "binary"
                    problem = f"the meaning of {quoted(text)} says {word}, so {quoted(name)} must be {expected}"
                    report.add("meaning-mismatch", (*value_path, "sets", name), problem + MEANING_DIFFERS)
            lengths = _lengths_named(meaning)
            for name, number in sets.items():
                unit = str(mapping(raw, "parameters", name).get("unit"))
                if lengths and unit in _NANOMETRES and number * _NANOMETRES[unit] not in lengths:
                    says = next(iter(lengths.values()))
                    problem = f"the meaning of {quoted(text)} says {says}, but {quoted(name)} is {number} {unit}"
                    report.add("meaning-mismatch", (*value_path, "sets", name), problem + MEANING_DIFFERS)
            stated_range, supply = supply_named(meaning), mapping(value, "supply")
            if stated_range and supply and stated_range != (supply["min_mv"], supply["max_mv"]):
                problem = f"the meaning of {quoted(text)} says {stated_range[0]} to {stated_range[1]} mV"
                report.add(
                    "meaning-mismatch",
                    (*value_path, "supply"),
                    f"{problem}, but here it is {supply['min_mv']} to {supply['max_mv']}{MEANING_DIFFERS}",
                )


def _lengths_named(meaning: str) -> dict[Fraction, str]:
    """Return the lengths in a meaning in nanometres, each with its text. A quotient also stands for its dividend."""
    lengths = {}
    for dividend, number, unit in _LENGTH.findall(meaning):
        length = Fraction(number.replace(",", "")) * _NANOMETRES[unit]
        text = f"{number} {unit}"
        if dividend:
            whole = Fraction(dividend.replace(",", "")) * _NANOMETRES[unit]
            length, text = whole / Fraction(number.replace(",", "")), f"{dividend}/{number} {unit}"
            lengths[whole] = text
        lengths[length] = text
    return lengths


def _codes_named(spec: Spec, value: Spec) -> dict[str, int]:
    """Return the parameters that must be set by a value whose meaning names one code, with the required numbers."""
    words = [word for word in ("Gray", "binary") if re.search(rf"\b{word}\b", value.get("meaning", ""), re.IGNORECASE)]
    if len(words) != 1:
        return {}
    interface = value.get("interface")
    own_layouts = (fields for fields in layouts(spec) if interface in (None, fields.interface))
    used = {mapping(fields.owner, "gray").get("when") for fields in own_layouts}
    return {name: int(words[0] == "Gray") for name in mapping(value, "sets") if name in used}


def supply_named(text: str) -> tuple[int, int] | None:
    """Return the supply range given by a text, in millivolts, or None."""
    if (range_match := _TWO_VOLTAGES.fullmatch(text)) is not None:
        return _millivolts(range_match[1], 100), _millivolts(range_match[2], 100)
    match = _ONE_VOLTAGE.fullmatch(text)
    if match is None:
        return None
    tolerance = Fraction(match[2] or 0)
    return _millivolts(match[1], 100 - tolerance), _millivolts(match[1], 100 + tolerance)


def _millivolts(volts: str, per_cent: Fraction | int) -> int:
    return int(Fraction(volts) * per_cent * 10)


def printed_number(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a value whose printed name is a number has that number."""
    for fields in field_lists(spec):
        for path, field in fields:
            for name, value in mapping(field, "values").items():
                number = _number(value.get("printed_name", ""), constant_width(field))
                if number is not None and number != value["value"]:
                    problem = (
                        f"{quoted(name)} is printed as {value['printed_name']}, which is {number}, but 'value' is"
                        f" {value['value']}"
                    )
                    report.add("printed-number", (*path, "values", name, "value"), problem)


def _number(text: str, width: int | None) -> int | None:
    """Return the number in a printed name if it is clearly only a number, otherwise None."""
    if (match := _IN_QUOTES.fullmatch(text)) is not None:
        digits = next(group for group in match.groups() if group)
        return int(digits, 2) if len(digits) == width else None
    if _WITH_PREFIX.fullmatch(text):
        return int(text, 0)
    suffixed = _WITH_SUFFIX.fullmatch(text)
    return int(suffixed[1], 16) if suffixed is not None else None


def interface_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an order code value does not select a different interface than its meaning names."""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            words = _ANY_INTERFACE.findall(value.get("meaning", ""))
            names = {word.upper().replace("RS485", "RS-485") for word in words}
            for kind, pattern in _INTERFACES.items():
                if len(names) == 1 and pattern.search(value["meaning"]) and value.get("interface", kind) != kind:
                    problem = (
                        f"the meaning of {quoted(text)} mentions {names.pop().replace('BISS', 'BiSS')}, but the"
                        f" value selects {value['interface']}"
                    )
                    report.add("interface-mismatch", (*path, "values", text, "interface"), problem)
                    break


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


#: Lists that are sets, at any place.
_SETS = frozenset(
    """
    interfaces sums_up explained_by write_clears cleared_by by_hand data_id memory_access printed also_written
    cable_lengths
    """.split()
)
#: Maps of lists that are sets.
_MAPS_OF_SETS = frozenset(("only_with", "open_only_with"))
#: Keys of fields without data. Each word of a frame can have its own check bits with the same names.
_NOT_DATA = frozenset(("constant", "unused", "crc", "parity_of"))


def repeated_item(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no item of a list that is a set occurs twice."""
    for path, set_items in _unique_lists((), spec):
        for index, set_item in enumerate(set_items):
            first_index = set_items.index(set_item)
            if first_index < index:
                item_text = quoted(set_item) if isinstance(set_item, (str, int)) else "this"
                message = (
                    f"{item_text} is already item {first_index + 1} of '{path[-1]}'; "
                    "remove it, or write the intended one"
                )
                report.add("repeated-item", (*path, index), message)


def repeated_text(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers, fields of a frame, and values of a field do not have the text of a neighbour."""
    registers: dict[object, list[tuple[Path, Spec]]] = {}
    for path, register in items(spec, "registers"):
        registers.setdefault((interface_of(register), register.get("bank")), []).append((path, register))
    for neighbours in registers.values():
        _report_repeated(neighbours, "printed_name", report)
    for fields in field_lists(spec):
        data_fields = [(path, field) for path, field in fields if _NOT_DATA.isdisjoint(field)]
        _report_repeated(data_fields, "printed_name", report)
        for path, field in fields:
            values = [((*path, "values", name), value) for name, value in mapping(field, "values").items()]
            _report_repeated(values, "printed_name", report)
            # Several values can be "not used".
            explained = [(path, value) for path, value in values if value.get("meaning", "").count(" ") > 1]
            _report_repeated(explained, "meaning", report)


def _report_repeated(neighbours: Iterable[tuple[Path, Spec]], key: str, report: DocumentReport) -> None:
    """Report every text under a key that an earlier item has."""
    first_names: dict[object, object] = {}
    for path, neighbour in neighbours:
        name = neighbour.get("name", path[-1])
        if key in neighbour and (first_name := first_names.setdefault(neighbour[key], name)) != name:
            message = f"{quoted(str(first_name))} already has this text as its {quoted(key)}; one of the two is wrong"
            report.add("repeated-text", (*path, key), message)


def _unique_lists(path: Path, node: Any) -> Iterator[tuple[Path, list[Any]]]:
    if isinstance(node, list):
        if path[-1] in _SETS or (len(path) > 1 and path[-2] in _MAPS_OF_SETS):
            yield path, node
        for index, inner in enumerate(node):
            yield from _unique_lists((*path, index), inner)
    elif isinstance(node, dict):
        for key, inner in node.items():
            yield from _unique_lists((*path, key), inner)
