"""Rules for SPI: requests with their replies, and the frames that access registers."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import Spi
from ..problems import DocumentReport, Path, quoted
from .exchanges import KEYS, check_exchanges, report_unused
from .walk import Fields, Has, Spec, by_name, field_names, interface_of, items, mapping

_HERE = ("interfaces", Spi.name)
#: Fields of the requests, and of the reply, that access a register.
_NEEDED = {"read": (("address",), ("data",)), "write": (("address", "data"), ())}


def exchanges(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each frame over SPI is a request or its reply, and that accesses have their fields."""
    layouts = by_name(raw, *_HERE, "layouts")
    if not mapping(spec, *_HERE):
        return
    found = check_exchanges(spec, raw, Spi.name, "spi-exchange", report)
    for path, register in items(spec, "registers"):
        if interface_of(register) == Spi.name and "byte_order" in register:
            wrong = (
                f"{quoted(register['name'])} is sent as one number over SPI, high byte first; leave 'byte_order' out,"
            )
            wrong += " or leave the register out if its low byte comes first"
            report.add("spi-exchange", (*path, "byte_order"), wrong, at_key=True)
        for below, field in items(register, "fields"):
            if interface_of(register) == Spi.name and "equals" in field:
                wrong = "an encoder cannot be identified by its registers over SPI; use 'constant' or 'meaning'"
                report.add("spi-exchange", (*path, *below, "equals"), wrong, at_key=True)
    registers = by_name(raw, "registers")
    for name, parameter in mapping(spec, "parameters").items():
        if interface_of(registers.get(str(parameter.get("read_from")).partition(".")[0], {})) == Spi.name:
            wrong = f"a parameter cannot be read from a register over SPI; leave 'read_from' out of {quoted(name)}"
            wrong += ", and give it a value for each order code"
            report.add("spi-exchange", ("parameters", name, "read_from"), wrong, at_key=True)
    _check_lengths(spec, found, report)
    _check_frames(spec, found, report)
    _check_parities(spec, report)
    _check_accesses(raw, layouts, found, report)


def _check_lengths(spec: Spec, found: list[tuple[Path, Spec]], report: DocumentReport) -> None:
    """Check that only exchanges with another length say so, and that late replies can be read completely."""
    interface = mapping(spec, *_HERE)
    shared = interface.get("word_bits")
    for path, item in found:
        if item.get("word_bits") == shared is not None:
            wrong = f"'word_bits' is {shared}, as for the interface; remove it from the exchange"
            report.add("spi-exchange", (*path, "word_bits"), wrong, at_key=True)
    writes = [(path, item) for path, item in found if item["purpose"] == "write"]
    for path, item in writes[1:] if interface.get("reply") == "next_word" else ():
        first = writes[0][1]
        lengths = [each.get("word_bits", shared) for each in (first, item)]
        if lengths[0] != lengths[1]:
            wrong = f"{quoted(item['request'])} has {lengths[1]} bits and {quoted(first['request'])} {lengths[0]}"
            way = "its word cannot hold the reply to the word before; give both the same 'word_bits'"
            report.add("spi-exchange", path, f"{wrong}, so {way}")


#: Keys of fields whose values follow from the spec or from other fields.
_DECIDED = frozenset(("constant", "unused", "parity_of", "crc", "use"))


def _check_frames(spec: Spec, found: list[tuple[Path, Spec]], report: DocumentReport) -> None:
    """Check that each frame has a place in an exchange, or that there is only one frame."""
    for path, layout in items(spec, *_HERE, "layouts"):
        key = KEYS.get(layout.get("from", ""), "")
        if found or key == "request" or path[-1] != 0:
            report_unused(layout, path, found, "spi-exchange", report)
        if layout.get("carried_as") == "bytes":
            wrong = f"{quoted(layout['name'])} is an SPI word, which is always carried as bits; remove 'carried_as'"
            report.add("spi-exchange", (*path, "carried_as"), wrong)


def _check_parities(spec: Spec, report: DocumentReport) -> None:
    """Check that the parity bits of a word without a CRC cover the other fields, unless a note names those left out."""
    for path, layout in items(spec, *_HERE, "layouts"):
        found = [(below, field) for below, field in items(layout, "fields") if "parity_of" in field]
        covered = {name for _, field in found for name in _covered(layout, field["parity_of"])}
        fields = [field for _, field in items(layout, "fields") if "parity_of" not in field]
        notes = {word for _, field in found for word in re.findall(r"\w+", str(field.get("note", "")))}
        named = [field["name"] for field in fields if "name" in field]
        left_out = [name for name in named if name not in covered and name not in notes]
        if found and left_out and not any("crc" in field for field in fields):
            below, field = found[0]
            wrong = f"{quoted(field.get('name', ''))} leaves out {quoted(left_out[0])}"
            way = f"add it to 'parity_of', or add a 'note' that the manual leaves out {left_out[0]}"
            report.add("spi-parity", (*path, *below, "parity_of"), f"{wrong}; {way}")


def _covered(layout: Spec, of: object) -> Iterator[str]:
    """Yield the fields that a parity bit covers, with those of joined numbers."""
    joins = mapping(layout, "join")
    for name in map(str, of if isinstance(of, list) else [of]):
        yield from joins.get(name, [name])


def _free(layout: Spec) -> Iterator[str]:
    """Yield the fields of a request whose values a user chooses."""
    for _, field in items(layout, "fields"):
        if _DECIDED.isdisjoint(field) and "name" in field:
            yield field["name"]


def _check_accesses(
    raw: Spec, layouts: dict[str, Spec], found: list[tuple[Path, Spec]], report: DocumentReport
) -> None:
    groups = by_name(raw, "field_groups")

    def fields(name: str) -> Iterator[str]:
        return iter(field_names(Fields(Has.LAYOUT, layouts.get(name, {}), (), Spi.name), groups))

    for purpose, needed in _NEEDED.items():
        accesses = [(path, item) for path, item in found if item["purpose"] == purpose]
        for names, key in zip(needed, KEYS.values(), strict=True):
            have = {name for _, item in accesses for name in fields(item[key])}
            gone = next((name for name in names if name not in have), "")
            if accesses and gone:
                wrong = f"{quoted(accesses[0][1][key])} is for a register, so it needs the field {quoted(gone)}"
                report.add("spi-exchange", (*accesses[0][0], key), wrong)
            for path, item in accesses if key == "request" and not gone else ():
                free = next((name for name in _free(layouts.get(item[key], {})) if name not in names), "")
                if free:
                    wrong = f"an access to a register gives no value for {quoted(free)} in {quoted(item[key])}"
                    report.add("spi-exchange", (*path, key), f"{wrong}; use 'constant' or 'unused' there")
        if purpose == "read" and len(accesses) > 1:
            report.add("spi-exchange", (*accesses[1][0], "purpose"), "a second request reads registers; keep one")
        missing = "write_only" if purpose == "read" else "read_only"
        for path, register in items(raw, "registers"):
            if interface_of(register) == Spi.name and not accesses and register.get("access") != missing:
                wrong = f"no exchange has the purpose {purpose!r}, so {quoted(register.get('name', ''))} has no access"
                report.add("spi-exchange", path, f"{wrong}; add one under 'exchanges'")
                break
