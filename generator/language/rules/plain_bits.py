"""Rule for flags and parity bits that a spec describes as plain numbers."""

from __future__ import annotations

import re

from ...model import INTERFACES
from ..problems import DocumentReport, quoted
from ..second_reading import is_second
from .walk import Fields, Has, Spec, field_lists

_FLAG = re.compile(r"(?:n_?)?(?:e|w|err|error|fault|failure|warn|warning|alarm)(?:_(?:bit|flag))?")
_PARITY = re.compile(r"(?:(?:even|odd)_)?(?:par|parity)(?:_bit)?")
#: The only keys of a field that is just a number. Every other key says how the bit is used.
_PLAIN = frozenset(("name", "printed_name", "names", "bits", "at", "meaning", "source"))


def plain_bits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a bit of an encoder's frame that is called error or parity is described as one.

    A plain number has no effect on the verdict, and no decoder checks it. A note explains a bit that is neither.
    """
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    for fields in field_lists(spec):
        for path, field in fields if _is_received(fields) else ():
            name = str(field.get("name", ""))
            if _bits(field) != 1 or not _PLAIN.issuperset(field) or _is_fixed(fields, name):
                continue
            problem = f"{quoted(name)} is a plain number, so decoders ignore it"
            if _PARITY.fullmatch(name) and "gray" not in fields.owner:  # No decoder checks a parity over Gray code.
                remedy = "write 'parity_of: [FIELDS]' instead of 'bits: 1', or add a 'note' that it is not a parity bit"
                report.add("plain-bit", path, f"{problem}; {remedy}")
            elif _FLAG.fullmatch(name):
                remedy = (
                    "write 'active: high' or 'active: low' instead of 'bits: 1', or add a 'note' that it is not a flag"
                )
                report.add("plain-bit", path, f"{problem}; {remedy}")


def _is_received(fields: Fields) -> bool:
    """Return True for the fields of a frame from an encoder, and of a group, which may be part of one."""
    return fields.kind is Has.GROUP or (fields.kind is Has.LAYOUT and fields.owner.get("from") == "encoder")


def _is_fixed(fields: Fields, name: str) -> bool:
    """Return True for a field with a fixed meaning in the frames of its interface."""
    return fields.interface in INTERFACES and name in INTERFACES[fields.interface].flags


def _bits(field: Spec) -> object:
    """Return the number of bits of a field, given by its width or as the place of one bit."""
    return 1 if isinstance(field.get("at"), int) else field.get("bits")
