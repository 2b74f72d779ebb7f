"""The parameters held in a register at run time: their bits and their factory defaults."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..language.problems import DocumentReport
from .fields import bit_range
from .from_mapping import Raw


def held_in_registers(raw: Raw, report: DocumentReport) -> Mapping[str, int]:
    """Return the parameters held in registers at run time, with their default values."""
    found = {}
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
        if place is None or "default" not in register:
            wrong = f"'{item['read_from']}' must be placed with 'at' and a constant width, in a register with a default"
            report.add("undefined-reference", ("parameters", name, "read_from"), wrong)
            found[name] = item.get("max", 0)
            continue
        low, width = place
        value = register["default"] >> low & ((1 << width) - 1) or field.get("zero_means", 0)
        found[name] = value
        if not item.get("min", 0) <= value <= item.get("max", value):
            wrong = f"the default of '{item['read_from']}' is {value}, not between 'min' and 'max'"
            report.add("default-does-not-fit", ("parameters", name), wrong)
    return MappingProxyType(found)


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
