"""Rules for facts that a manual or a spec gives twice: text that repeats data, lists of defaults, and repetitions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

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
            value_path, problem = (*path, "values", text), f"the meaning of {quoted(text)} says"
            meaning, sets = value.get("meaning", ""), mapping(value, "sets")
            for name, code in _codes_named(spec, value).items():
                if sets[name] != code:
                    word = "Gray" if code else "binary"
                    message = f"{problem} {word}, so {quoted(name)} must be {code}{MEANING_DIFFERS}"
                    report.add("meaning-mismatch", (*value_path, "sets", name), message)
            lengths = _lengths_named(meaning)
            for name, number in sets.items():
                unit = str(mapping(raw, "parameters", name).get("unit"))
                if lengths and unit in _NANOMETRES and number * _NANOMETRES[unit] not in lengths:
                    first_length, *_ = lengths.values()
                    message = f"{problem} {first_length}, but {quoted(name)} is {number} {unit}{MEANING_DIFFERS}"
                    report.add("meaning-mismatch", (*value_path, "sets", name), message)
            stated_range, supply = supply_named(meaning), mapping(value, "supply")
            if stated_range and supply and stated_range != (supply["min_mv"], supply["max_mv"]):
                low_mv, high_mv = stated_range
                actual_range = f"{supply['min_mv']} to {supply['max_mv']}"
                message = f"{problem} {low_mv} to {high_mv} mV, but here it is {actual_range}{MEANING_DIFFERS}"
                report.add("meaning-mismatch", (*value_path, "supply"), message)


def _lengths_named(meaning: str) -> dict[Fraction, str]:
    """Return the lengths in a meaning in nanometres, each with its text. A quotient also stands for its dividend."""
    lengths = {}
    for dividend, number, unit in _LENGTH.findall(meaning):
        if dividend:
            text = f"{dividend}/{number} {unit}"
            whole_length = Fraction(dividend.replace(",", "")) * _NANOMETRES[unit]
            lengths[whole_length] = text
            lengths[whole_length / Fraction(number.replace(",", ""))] = text
        else:
            lengths[Fraction(number.replace(",", "")) * _NANOMETRES[unit]] = f"{number} {unit}"
    return lengths


def _codes_named(spec: Spec, value: Spec) -> dict[str, int]:
    """Return the parameters that must be set by a value whose meaning names one code, with the required numbers.

    A parameter that decides the code of a layout is 1 for Gray code and 0 for binary code.
    """
    meaning = value.get("meaning", "")
    says_gray, says_binary = (re.search(rf"\b{word}\b", meaning, re.IGNORECASE) for word in ("Gray", "binary"))
    if bool(says_gray) == bool(says_binary):
        return {}
    interface = value.get("interface")
    deciding_parameters = set()
    for fields in layouts(spec):
        if interface is None or fields.interface == interface:
            deciding_parameters.add(mapping(fields.owner, "gray").get("when"))
    required_number = 1 if says_gray else 0
    return {name: required_number for name in mapping(value, "sets") if name in deciding_parameters}


def supply_named(text: str) -> tuple[int, int] | None:
    """Return the supply range given by a text, in millivolts, or None."""
    two_voltages = _TWO_VOLTAGES.fullmatch(text)
    if two_voltages is not None:
        low, high = two_voltages.groups()
        return _millivolts(low, 100), _millivolts(high, 100)
    one_voltage = _ONE_VOLTAGE.fullmatch(text)
    if one_voltage is None:
        return None
    volts, tolerance_text = one_voltage.groups()
    tolerance = Fraction(tolerance_text or 0)
    return _millivolts(volts, 100 - tolerance), _millivolts(volts, 100 + tolerance)


def _millivolts(volts: str, per_cent: Fraction | int) -> int:
    return int(Fraction(volts) * per_cent * 10)


def printed_number(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a value whose printed name is a number has that number."""
    for fields in field_lists(spec):
        for path, field in fields:
            for name, value in mapping(field, "values").items():
                printed_name = value.get("printed_name", "")
                number = _number(printed_name, constant_width(field))
                if number is not None and number != value["value"]:
                    problem = f"{quoted(name)} is printed as {printed_name}, which is {number}"
                    message = f"{problem}, but 'value' is {value['value']}"
                    report.add("printed-number", (*path, "values", name, "value"), message)


def _number(printed_name: str, width: int | None) -> int | None:
    """Return the number in a printed name if it is clearly only a number, otherwise None.

    Zeros and ones in quotes are a binary number if they have as many digits as the field has bits.
    """
    if _IN_QUOTES.fullmatch(printed_name):
        digits = printed_name[1:-1]
        return int(digits, 2) if len(digits) == width else None
    if _WITH_PREFIX.fullmatch(printed_name):
        return int(printed_name, 0)
    with_suffix = _WITH_SUFFIX.fullmatch(printed_name)
    return int(with_suffix[1], 16) if with_suffix is not None else None


def interface_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an order code value does not select a different interface than its meaning names."""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            meaning = value.get("meaning", "")
            words = _ANY_INTERFACE.findall(meaning)
            names = {word.upper().replace("RS485", "RS-485") for word in words}
            if len(names) != 1 or "interface" not in value:
                continue
            named_kinds = [kind for kind, pattern in _INTERFACES.items() if pattern.search(meaning)]
            if named_kinds and value["interface"] != named_kinds[0]:
                name = names.pop().replace("BISS", "BiSS")
                problem = f"the meaning of {quoted(text)} mentions {name}, but the value selects {value['interface']}"
                report.add("interface-mismatch", (*path, "values", text, "interface"), problem)


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
            sets_all_parameters = all(name in sets for name in expression.parameters)
            if not text.isdecimal() or not sets_all_parameters:
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
        has_whole_register = "bytes" in row and "at" not in row and "value" not in row
        has_some_bits = "bytes" not in row and "at" in row and "value" in row
        if not has_whole_register and not has_some_bits:
            message = "a row has either 'bytes' for the whole register, or 'at' and 'value' for some of its bits"
            report.add("default-mismatch", path, message)
            continue
        register = registers.get(row["register"])
        if register is None:
            continue
        faults = list(_row_faults(row, register))
        if faults and "erratum" not in row:
            key, message = faults[0]
            report.add("default-mismatch", (*path, key), message)
        elif not faults and "erratum" in row:
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
    if default is None:
        yield "value", f"{name} has no 'default' that contains these bits"
    else:
        high, low = bounds
        mask = (1 << (high - low + 1)) - 1
        default_bits = (default >> low) & mask
        if default_bits != row["value"]:
            problem = f"the 'default' of {name} is {default:#x}, which gives {default_bits} in these bits"
            yield "value", f"{problem}, but the manual prints {row['value']}"
    yield from _field_faults(row, register, bounds)


def _byte_faults(row: Spec, register: Spec) -> Iterator[tuple[str, str]]:
    """Yield the error of a row with the bytes of the whole register."""
    name, default = quoted(register["name"]), register.get("default")
    printed_bytes = bytes.fromhex(row["bytes"])
    byte_order: Literal["little", "big"] = "little" if register.get("byte_order") == "low_byte_first" else "big"
    number = int.from_bytes(printed_bytes, byte_order)
    if len(printed_bytes) != register["length"]:
        yield "bytes", f"{name} has {register['length']} bytes, but {len(printed_bytes)} are printed"
    elif default is None:
        yield "bytes", f"{name} has no 'default', but the printed bytes are {number:#x}"
    elif default != number:
        yield "bytes", f"the 'default' of {name} is {default:#x}, but the printed bytes are {number:#x}"


def _field_faults(row: Spec, register: Spec, bounds: tuple[int, int]) -> Iterator[tuple[str, str]]:
    """Yield the errors of a row's field: a different place, or a different name of the number."""
    if "field" not in row:
        return
    field = by_name(register, "fields").get(row["field"])
    if field is None:  # Reported by the rule on references, or the field is in a group.
        return
    if "at" in field and _bounds(field["at"]) != bounds:
        yield "at", f"{quoted(row['field'])} is at {field['at']}, but {row['at']} is printed"
    values = mapping(field, "values")
    names = [name for name, value in values.items() if mapping(value).get("value") == row["value"]]
    if "is" in row and row["is"] not in names:
        actual = f"is {quoted(names[0])}" if names else "has no name"
        yield "is", f"{row['value']} {actual} in {quoted(row['field'])}, but {quoted(row['is'])} is printed"


def _bounds(at: object) -> tuple[int, int] | None:
    """Return the highest and the lowest bit of a place, or None if it is not one."""
    if isinstance(at, int):
        return (at, at) if 0 <= at < 1024 else None
    bit_range = _RANGE.fullmatch(str(at))
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
        if not printed_writes or None in step_writes:
            continue
        for index, printed in enumerate(printed_writes):
            printed_path = (*path, "printed_writes", index)
            if index >= len(step_writes):
                report.add("writes-mismatch", printed_path, f"{printed} is printed, but no step writes it")
            elif printed != step_writes[index]:
                step_path, _ = steps[index]
                line, _ = report.document.position((*path, *step_path))
                message = f"{printed} is printed, but the step on line {line} writes {step_writes[index]}"
                report.add("writes-mismatch", printed_path, message)
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
    step_field = step.get("field")
    candidates = [field for field in fields if step_field in (None, field.get("name"))]
    # The field that has the value. Without one, the value is an argument, whose number the caller supplies.
    fields_with_value = [field for field in candidates if step["value"] in mapping(field, "values")]
    number = mapping(fields_with_value[0], "values", step["value"]).get("value") if fields_with_value else None
    first, last = register["address"], last_address(register)
    writes_whole_register = step_field is None and (not fields_with_value or len(fields) == 1)
    if writes_whole_register:
        return _Write(first=first, last=last, bit=None, value=number)
    written_fields = fields_with_value or candidates
    bounds = _bounds(written_fields[0].get("at")) if written_fields else None
    if bounds is None:
        return None
    _, low_bit = bounds
    if step_field is None:
        return _Write(first=first, last=last, bit=None, value=(number or 0) << low_bit)
    return _Write(first=first, last=last, bit=low_bit, value=number)


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
    registers_by_bank: dict[object, list[tuple[Path, Spec]]] = {}
    for path, register in items(spec, "registers"):
        bank = (interface_of(register), register.get("bank"))
        registers_by_bank.setdefault(bank, []).append((path, register))
    for registers in registers_by_bank.values():
        _report_repeated(registers, "printed_name", report)
    for fields in field_lists(spec):
        data_fields = [(path, field) for path, field in fields if _NOT_DATA.isdisjoint(field)]
        _report_repeated(data_fields, "printed_name", report)
        for path, field in fields:
            values = [((*path, "values", name), value) for name, value in mapping(field, "values").items()]
            _report_repeated(values, "printed_name", report)
            # Several values can be "not used".
            with_long_meaning = [(path, value) for path, value in values if value.get("meaning", "").count(" ") > 1]
            _report_repeated(with_long_meaning, "meaning", report)


def _report_repeated(neighbours: Iterable[tuple[Path, Spec]], key: str, report: DocumentReport) -> None:
    """Report every text under a key that an earlier item has."""
    first_names: dict[object, object] = {}
    for path, neighbour in neighbours:
        if key not in neighbour:
            continue
        name = neighbour.get("name", path[-1])
        first_name = first_names.setdefault(neighbour[key], name)
        if first_name != name:
            message = f"{quoted(str(first_name))} already has this text as its {quoted(key)}; one of the two is wrong"
            report.add("repeated-text", (*path, key), message)


def _unique_lists(path: Path, node: Any) -> Iterator[tuple[Path, list[Any]]]:
    """Yield every list that is a set, at a place and below it."""
    if isinstance(node, list):
        is_in_map_of_sets = len(path) > 1 and path[-2] in _MAPS_OF_SETS
        if path[-1] in _SETS or is_in_map_of_sets:
            yield path, node
        for index, inner in enumerate(node):
            yield from _unique_lists((*path, index), inner)
    elif isinstance(node, dict):
        for key, inner in node.items():
            yield from _unique_lists((*path, key), inner)
