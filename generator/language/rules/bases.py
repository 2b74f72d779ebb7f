"""Rules for spelling: hexadecimal numbers begin with 0x, decimal ones have no leading zero, and quotes are straight."""

from __future__ import annotations

import re

from ..problems import DocumentReport, Path, quoted
from .walk import Spec, leaves_of

#: Keys of numbers that manuals print in hexadecimal.
HEXADECIMAL = frozenset("address addresses poly init xorout check control constant unused biss_id".split())
#: Maps whose keys are names defined in the spec.
_OWN_NAMES = frozenset(("values", "arguments", "sets"))
#: Pairs of quotes used by word processors and PDF files.
_TYPOGRAPHIC = frozenset(map(tuple, ("“”", "„“", "„”", "””", "‘’", "‚‘", "’’", "«»", "»«")))
_DECIMAL = re.compile("[0-9]{2,}")
_LEADING_ZERO = re.compile("[-+]?0[0-9]+")


def number_base(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that numbers printed in hexadecimal have 0x, and that no number has leading zeros.

    A JSON file may use decimal numbers, because JSON has no others.
    """
    in_json = report.document.line(1).startswith("{")
    for path, number in leaves_of(spec, report):
        if not isinstance(number, int) or isinstance(number, bool):
            continue
        spelling = report.document.spelling_at(path)
        hexadecimal = f"0x{spelling.lstrip('+-0'):0>2}"
        if not in_json and _is_hexadecimal(path) and _DECIMAL.fullmatch(spelling):
            decimal_hint = f", or {number:#04x} for decimal {number}" if number > 9 else ""
            message = (
                f"{quoted(path[-1])} is {spelling}, which is decimal, but manuals print it in hexadecimal; "
                f"write {hexadecimal}{decimal_hint}"
            )
            report.add("number-base", path, message)
        elif _LEADING_ZERO.fullmatch(spelling):
            message = (
                f"{spelling} begins with a zero and is read as decimal {number}; "
                f"write {number}, or {hexadecimal} if it is hexadecimal"
            )
            report.add("number-base", path, message)


def typographic_quotes(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no text is in typographic quotes, which YAML treats as part of the text."""
    for path, value in leaves_of(spec, report):
        if isinstance(value, str) and len(value) > 1 and (value[0], value[-1]) in _TYPOGRAPHIC:
            message = (
                f"the quotes {value[0]} and {value[-1]} are part of this text; "
                f'write "{value[1:-1]}" with straight quotes'
            )
            report.add("typographic-quotes", path, message)


def _is_hexadecimal(path: Path) -> bool:
    if path[-1] == "value":
        return "writes" in path
    return path[-1] in HEXADECIMAL and _OWN_NAMES.isdisjoint(path[-2:-1])
