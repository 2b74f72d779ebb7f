"""The parameters held in a register at run time: their bits, their codes and their factory defaults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from ..language.problems import DocumentReport, quoted
from ..model import CodedValue
from ..order_codes.run_time import State, coded_states
from .fields import bit_range
from .from_mapping import Raw


def held_in_registers(raw: Raw, report: DocumentReport) -> Mapping[str, int]:
    """Return the parameters held in registers at run time, with their default values.

    Parameters whose values the order code sets are not in the result.
    """
    defaults: dict[str, int] = {}
    by_order_code = set_by_codes(raw)
    for name, definition in raw["parameters"].items():
        if "read_from" not in definition:
            continue
        register, field = _register_and_field(raw, definition)
        if register is None or field is None:
            defaults[name] = definition.get("max", 0)  # reported by the rule on references
            continue
        place = _place(field)
        if place is None:
            message = f"'{definition['read_from']}' must be placed with 'at' and a constant width"
            report.add("undefined-reference", ("parameters", name, "read_from"), message)
            defaults[name] = definition.get("max", 0)
            continue
        low, width = place
        _check_codes(name, definition, width, report)
        if name in by_order_code:
            _check_set_values(name, raw, coded_values(definition), report)
        elif "default" not in register:
            message = f"the register of '{definition['read_from']}' has no default"
            report.add(
                "undefined-reference",
                ("parameters", name, "read_from"),
                f"{message}, so every order code must set {quoted(name)}",
            )
            defaults[name] = definition.get("max", 0)
        else:
            number = register["default"] >> low & ((1 << width) - 1)
            defaults[name] = _default(name, definition, number, field.get("zero_means", 0), report)
    return MappingProxyType(defaults)


def _register_and_field(raw: Raw, definition: Raw) -> tuple[Raw | None, Raw | None]:
    """Return the register and the field that a parameter is read from, each None if it does not exist."""
    register_name, _, field_name = definition["read_from"].partition(".")
    registers = raw.get("registers", ())
    register = next((candidate for candidate in registers if candidate["name"] == register_name), None)
    return register, _field(register, field_name) if register is not None else None


def _default(name: str, definition: Raw, number: int, zero_means: int, report: DocumentReport) -> int:
    """Return the value of a parameter whose field has this number by default, and check it."""
    codes = coded_values(definition)
    if codes:
        value = next((coded.value for coded in codes if coded.code == number), None)
        if value is None:
            message = f"the default of '{definition['read_from']}' is {number}"
            remedy = f"which is not a code of {quoted('by_code')}"
            report.add("default-does-not-fit", ("parameters", name), f"{message}, {remedy}")
        return value or 0
    value = number or zero_means
    if not definition.get("min", 0) <= value <= definition.get("max", value):
        message = f"the default of '{definition['read_from']}' is {value}, not between 'min' and 'max'"
        report.add("default-does-not-fit", ("parameters", name), message)
    return value


def coded_values(definition: Raw) -> tuple[CodedValue, ...]:
    """Return the codes of a parameter in a register with their values, in the order of the codes."""
    values = (CodedValue(int(code, 0), value) for code, value in definition.get("by_code", {}).items())
    return tuple(sorted(values, key=lambda coded: coded.code))


def extreme_states(raw: Raw) -> Sequence[Sequence[State]]:
    """Return the states of each register field that must fit: the limits of its parameter, or each of its codes."""
    limits: list[list[State]] = []
    codes_by_field: dict[str, dict[str, Mapping[int, int]]] = {}
    for name, definition in raw["parameters"].items():
        field = definition.get("read_from")
        if field is not None and "by_code" in definition:
            values_by_code = {coded.code: coded.value for coded in coded_values(definition)}
            codes_by_field.setdefault(field, {})[name] = values_by_code
        elif field is not None:
            limits.append([{name: definition[key]} for key in ("min", "max") if key in definition])
    return [*limits, *map(coded_states, codes_by_field.values())]


def set_by_codes(raw: Raw) -> frozenset[str]:
    """Return the parameters that an order code sets."""
    names: set[str] = set()
    for part in raw["order_code"]["parts"]:
        for value in part["values"].values():
            names.update((value or {}).get("sets", ()))
    return frozenset(names)


def _check_set_values(name: str, raw: Raw, codes: Sequence[CodedValue], report: DocumentReport) -> None:
    """Check that order codes set values that the register can hold."""
    known_values = {coded.value for coded in codes}
    for index, part in enumerate(raw["order_code"]["parts"]):
        for text, value in part["values"].items():
            number = (value or {}).get("sets", {}).get(name)
            if known_values and number is not None and number not in known_values:
                path = ("order_code", "parts", index, "values", text, "sets", name)
                report.add(
                    "default-does-not-fit", path, f"{number} is not one of the values in 'by_code' of {quoted(name)}"
                )


def _check_codes(name: str, definition: Raw, width: int, report: DocumentReport) -> None:
    """Check that each code fits into the field and is unique."""
    texts: dict[int, str] = {}
    for text in definition.get("by_code", {}):
        code = int(text, 0)
        path = ("parameters", name, "by_code", text)
        if code >> width:
            message = f"the code {text} does not fit into the {width} bits of '{definition['read_from']}'"
            report.add("value-too-wide", path, message, at_key=True)
        elif code in texts:
            report.add("value-clash", path, f"{texts[code]} and {text} are the same code; keep one", at_key=True)
        texts.setdefault(code, text)


def _field(register: Raw, name: str) -> Raw | None:
    """Return the field of a register as in the spec.

    A register without fields is one number. A field of a group is empty.
    """
    if "fields" not in register:
        return {"name": name, "at": f"{8 * register['length'] - 1}:0"} if name == register["name"] else None
    own_fields = [field for field in register["fields"] if "use" not in field]
    of_group: Raw | None = {} if len(own_fields) < len(register["fields"]) else None
    return next((field for field in own_fields if field.get("name") == name), of_group)


def _place(field: Raw) -> tuple[int, int] | None:
    """Return low bit and width of a field, or None if they are not plain numbers."""
    bounds = bit_range(field["at"]) if "at" in field else None
    if bounds is None:
        return None
    high, low = bounds
    width = field.get("bits", high - low + 1)
    return (low, width) if isinstance(width, int) else None
