"""Rule for requests over SPI that an encoder would take as a write."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Spi
from ..problems import DocumentReport, quoted
from ..second_reading import is_second
from .values import constant_width
from .walk import Fields, Has, Spec, by_name, expanded, items

_HERE = ("interfaces", Spi.name)
#: Bits of the longest word over SPI. The check of the layouts reports longer ones.
_MOST_BITS = 64


def requests_that_write(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that constants distinguish each request from those that write, unless a note of its layout explains it.

    A second word of a write has no address. The encoder knows it by the word before.
    """
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    groups, layouts = by_name(raw, "field_groups"), by_name(spec, *_HERE, "layouts")
    exchanges = [exchange for _, exchange in items(spec, *_HERE, "exchanges")]
    bits = {name: _constant_bits(layout, groups) for name, layout in layouts.items()}
    write_requests = (exchange["request"] for exchange in exchanges if exchange["purpose"] == "write")
    writes = [name for name in write_requests if name in layouts]
    addressed = [name for name in writes if "address" in _free_names(layouts[name], groups)]
    for exchange in exchanges:
        name = exchange["request"]
        if name not in layouts or name in writes or "note" in layouts[name] or not bits[name]:
            continue
        with_constants = (write for write in addressed if set(bits[write]) > {"?"})
        equal = next((write for write in with_constants if _may_be_equal(bits[name], bits[write])), None)
        if equal is not None:
            problem = f"{quoted(name)} can be the same word as {quoted(equal)}, so it would write a register"
            remedy = "correct a 'constant' in one of them, or explain it in a 'note' of this layout"
            report.add("spi-exchange", (*_HERE, "layouts", name), f"{problem}; {remedy}")


def _may_be_equal(request: str, write: str) -> bool:
    """Return True if two words have the same length and no constant bit differs."""
    if len(request) != len(write):
        return False
    return all(bit == write_bit or "?" in (bit, write_bit) for bit, write_bit in zip(request, write, strict=True))


def _constant_bits(layout: Spec, groups: dict[str, Spec]) -> str:
    """Return a word as 0, 1 and ? for bits that are not constant. Empty if a width is not constant or too large."""
    bits = ""
    for _, field in expanded(Fields(Has.LAYOUT, layout, (), Spi.name), groups):
        width = 1 if "parity_of" in field else constant_width(field)
        if width is None or width > _MOST_BITS:
            return ""
        constant = field.get("constant", field.get("unused"))
        bits += f"{constant:0{width}b}" if isinstance(constant, int) else "?" * width
    return bits


def _free_names(layout: Spec, groups: dict[str, Spec]) -> Iterator[str]:
    """Yield the names of the fields that have no fixed value."""
    for _, field in expanded(Fields(Has.LAYOUT, layout, (), Spi.name), groups):
        if "constant" not in field and "unused" not in field:
            yield str(field.get("name"))
