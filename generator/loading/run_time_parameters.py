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
    found = {}
    by_order_code = set_by_codes(raw)
    for name, item in raw["parameters"].items():
        if "read_from" not in item:
            continue
        register_name, _, field_name = item["read_from"].partition(".")
        register = next((entry for entry in raw.get("registers", ()) if entry["name"] == register_name), None)
        field = _field(register, field_name) if register is not None else None
        if register is None or field is None:
            found[name] = item.get("max", 0)  # reported by the rule on references
            continue
        place = _place(field)
        if place is None:
            wrong = f"'{item['read_from']}' must be placed with 'at' and a constant width"
            report.add("undefined-reference", ("parameters", name, "read_from"), wrong)
            found[name] = item.get("max", 0)
            continue
        low, width = place
        codes = coded_values(item)
        _check_codes(name, item, width, report)
        if name in by_order_code:
            _check_set_values(name, raw, codes, report)
            continue
        if "default" not in register:
            wrong = f"the register of '{item['read_from']}' has no default, so every order code must set {quoted(name)}"
            report.add("undefined-reference", ("parameters", name, "read_from"), wrong)
            found[name] = item.get("max", 0)
            continue
        number = register["default"] >> low & ((1 << width) - 1)
        if codes:
            value = next((one.value for one in codes if one.code == number), None)
            if value is None:
                wrong = f"the default of '{item['read_from']}' is {number}, which is not a code of {quoted('by_code')}"
                report.add("default-does-not-fit", ("parameters", name), wrong)
            found[name] = value or 0
            continue
        value = number or field.get("zero_means", 0)
        found[name] = value
        if not item.get("min", 0) <= value <= item.get("max", value):
            wrong = f"the default of '{item['read_from']}' is {value}, not between 'min' and 'max'"
            report.add("default-does-not-fit", ("parameters", name), wrong)
    return MappingProxyType(found)


def coded_values(item: Raw) -> tuple[CodedValue, ...]:
    """Return the codes of a parameter in a register with their values, in the order of the codes."""
    found = (CodedValue(int(code, 0), value) for code, value in item.get("by_code", {}).items())
    return tuple(sorted(found, key=lambda one: one.code))


def extreme_states(raw: Raw) -> Sequence[Sequence[State]]:
    """Return the states of each register field that must fit: the limits of its parameter, or each of its codes."""
    held = {name: item for name, item in raw["parameters"].items() if "read_from" in item}
    coded: dict[str, dict[str, Mapping[int, int]]] = {}
    for name, item in held.items():
        if "by_code" in item:
            coded.setdefault(item["read_from"], {})[name] = {one.code: one.value for one in coded_values(item)}
    plain = (
        [{name: item[key]} for key in ("min", "max") if key in item]
        for name, item in held.items()
        if "by_code" not in item
    )
    return [*plain, *map(coded_states, coded.values())]


def set_by_codes(raw: Raw) -> frozenset[str]:
    """Return the parameters that an order code sets."""
    parts = raw["order_code"]["parts"]
    return frozenset(
        name for part in parts for value in part["values"].values() for name in (value or {}).get("sets", ())
    )


def _check_set_values(name: str, raw: Raw, codes: Sequence[CodedValue], report: DocumentReport) -> None:
    """Check that order codes set values that the register can hold."""
    known = {one.value for one in codes}
    for index, part in enumerate(raw["order_code"]["parts"]):
        for text, value in part["values"].items():
            number = (value or {}).get("sets", {}).get(name)
            if known and number is not None and number not in known:
                path = ("order_code", "parts", index, "values", text, "sets", name)
                report.add(
                    "default-does-not-fit", path, f"{number} is not one of the values in 'by_code' of {quoted(name)}"
                )


def _check_codes(name: str, item: Raw, width: int, report: DocumentReport) -> None:
    """Check that each code fits into the field and is unique."""
    texts: dict[int, str] = {}
    for text in item.get("by_code", {}):
        code = int(text, 0)
        path = ("parameters", name, "by_code", text)
        if code >> width:
            wrong = f"the code {text} does not fit into the {width} bits of '{item['read_from']}'"
            report.add("value-too-wide", path, wrong, at_key=True)
        elif code in texts:
            report.add("value-clash", path, f"{texts[code]} and {text} are the same code; keep one", at_key=True)
        texts.setdefault(code, text)


def _field(register: Raw, name: str) -> Raw | None:
    """Return the field of a register as in the spec.

    A register without fields is one number. A field of a group is empty.
    """
    if "fields" not in register:
        return {"name": name, "at": f"{8 * register['length'] - 1}:0"} if name == register["name"] else None
    own = [entry for entry in register["fields"] if "use" not in entry]
    of_group: Raw | None = {} if len(own) < len(register["fields"]) else None
    return next((entry for entry in own if entry.get("name") == name), of_group)


def _place(field: Raw) -> tuple[int, int] | None:
    """Return low bit and width of a field, or None if they are not plain numbers."""
    bounds = bit_range(field["at"]) if "at" in field else None
    if bounds is None:
        return None
    high, low = bounds
    width = field.get("bits", high - low + 1)
    return (low, width) if isinstance(width, int) else None
