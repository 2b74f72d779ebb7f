"""Rules on words that say once more what stands beside them as data: where the two differ, one of them is a slip."""

from __future__ import annotations

import re

from ..problems import DocumentReport, quoted
from .values import constant_width
from .walk import Spec, field_lists, items, mapping

#: Names of interfaces in the words of a manual. RS-485 is not among them: it is the name of the signals as well.
_INTERFACES = {"ssi": re.compile(r"\bSSI\b"), "biss": re.compile(r"\bBiSS\b", re.IGNORECASE)}
_ANY_INTERFACE = re.compile(r"\bSSI\b|\bBiSS\b|\bRS-?485\b", re.IGNORECASE)

#: A number in binary in quotes, in hexadecimal as in 0x1F or 0Ah, in binary as in 0b01. Plain digits may be a name.
_IN_QUOTES = re.compile(r"\"([01]+)\"|'([01]+)'|“([01]+)”")
_WITH_PREFIX = re.compile(r"0[xX][0-9A-Fa-f]+|0b[01]+")
_WITH_SUFFIX = re.compile(r"((?:0[0-9A-F]*|[0-9A-F]*[A-F][0-9A-F]*))h")


def printed_number(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """A value that the manual names by its number has that number."""
    for fields in field_lists(spec):
        for path, field in fields:
            for name, value in mapping(field, "values").items():
                number = _number(value.get("printed_name", ""), constant_width(field))
                if number is not None and number != value["value"]:
                    wrong = (
                        f"{quoted(name)} is printed as {value['printed_name']}, which is {number}; 'value' is"
                        f" {value['value']}"
                    )
                    report.add("printed-number", (*path, "values", name, "value"), wrong)


def _number(text: str, width: int | None) -> int | None:
    """The number that a printed name is, where it is clearly one and nothing else."""
    if (found := _IN_QUOTES.fullmatch(text)) is not None:
        digits = next(group for group in found.groups() if group)
        return int(digits, 2) if len(digits) == width else None
    if _WITH_PREFIX.fullmatch(text):
        return int(text, 0)
    suffixed = _WITH_SUFFIX.fullmatch(text)
    return int(suffixed[1], 16) if suffixed is not None else None


def interface_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """A value of an order code whose meaning names one interface does not select another."""
    for path, part in items(spec, "order_code", "parts"):
        for text, value in part["values"].items():
            named = {
                found.upper().replace("RS485", "RS-485") for found in _ANY_INTERFACE.findall(value.get("meaning", ""))
            }
            for kind, pattern in _INTERFACES.items():
                if len(named) == 1 and pattern.search(value["meaning"]) and value.get("interface", kind) != kind:
                    wrong = (
                        f"the meaning of {quoted(text)} names {named.pop().replace('BISS', 'BiSS')}, and it selects"
                        f" {value['interface']}"
                    )
                    report.add("interface-mismatch", (*path, "values", text, "interface"), wrong)
                    break
