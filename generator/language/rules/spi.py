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
    spi_exchanges = check_exchanges(spec, raw, Spi.name, "spi-exchange", report)
    _check_registers(spec, raw, report)
    _check_lengths(spec, spi_exchanges, report)
    _check_frames(spec, spi_exchanges, report)
    _check_parities(spec, report)
    _check_accesses(raw, layouts, spi_exchanges, report)


def _check_registers(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers over SPI have only keys that can be used over SPI, and that no parameter is read there."""
    for path, register in items(spec, "registers"):
        if interface_of(register) != Spi.name:
            continue
        if "byte_order" in register:
            message = (
                f"{quoted(register['name'])} is sent as one number over SPI, high byte first; leave 'byte_order' out,"
                " or leave the register out if its low byte comes first"
            )
            report.add("spi-exchange", (*path, "byte_order"), message, at_key=True)
        for field_path, field in items(register, "fields"):
            if "equals" in field:
                message = "an encoder cannot be identified by its registers over SPI; use 'constant' or 'meaning'"
                report.add("spi-exchange", (*path, *field_path, "equals"), message, at_key=True)
    registers = by_name(raw, "registers")
    for name, parameter in mapping(spec, "parameters").items():
        register_name = str(parameter.get("read_from")).partition(".")[0]
        if interface_of(registers.get(register_name, {})) == Spi.name:
            message = (
                f"a parameter cannot be read from a register over SPI; leave 'read_from' out of {quoted(name)}"
                ", and give it a value for each order code"
            )
            report.add("spi-exchange", ("parameters", name, "read_from"), message, at_key=True)


def _check_lengths(spec: Spec, exchanges: list[tuple[Path, Spec]], report: DocumentReport) -> None:
    """Check that only exchanges with another length say so, and that late replies can be read completely."""
    interface = mapping(spec, *_HERE)
    default_bits = interface.get("word_bits")
    for path, exchange in exchanges:
        if exchange.get("word_bits") == default_bits is not None:
            message = f"'word_bits' is {default_bits}, as for the interface; remove it from the exchange"
            report.add("spi-exchange", (*path, "word_bits"), message, at_key=True)
    writes = [(path, exchange) for path, exchange in exchanges if exchange["purpose"] == "write"]
    for path, exchange in writes[1:] if interface.get("reply") == "next_word" else ():
        first_write = writes[0][1]
        first_bits = first_write.get("word_bits", default_bits)
        word_bits = exchange.get("word_bits", default_bits)
        if word_bits != first_bits:
            message = (
                f"{quoted(exchange['request'])} has {word_bits} bits and {quoted(first_write['request'])} {first_bits}"
                ", so its word cannot hold the reply to the word before; give both the same 'word_bits'"
            )
            report.add("spi-exchange", path, message)


#: Keys of fields whose values follow from the spec or from other fields.
_DECIDED = frozenset(("constant", "unused", "parity_of", "crc", "use"))


def _check_frames(spec: Spec, exchanges: list[tuple[Path, Spec]], report: DocumentReport) -> None:
    """Check that each frame has a place in an exchange, or that there is only one frame."""
    for path, layout in items(spec, *_HERE, "layouts"):
        key = KEYS.get(layout.get("from", ""), "")
        if exchanges or key == "request" or path[-1] != 0:
            report_unused(layout, path, exchanges, "spi-exchange", report)
        if layout.get("carried_as") == "bytes":
            message = f"{quoted(layout['name'])} is an SPI word, which is always carried as bits; remove 'carried_as'"
            report.add("spi-exchange", (*path, "carried_as"), message)


def _check_parities(spec: Spec, report: DocumentReport) -> None:
    """Check that the parity bits of a word without a CRC cover the other fields, unless a note names those left out."""
    for path, layout in items(spec, *_HERE, "layouts"):
        parity_fields = [(field_path, field) for field_path, field in items(layout, "fields") if "parity_of" in field]
        covered_names = {name for _, field in parity_fields for name in _covered_fields(layout, field["parity_of"])}
        fields = [field for _, field in items(layout, "fields") if "parity_of" not in field]
        notes = {word for _, field in parity_fields for word in re.findall(r"\w+", str(field.get("note", "")))}
        field_names = [field["name"] for field in fields if "name" in field]
        left_out = [name for name in field_names if name not in covered_names and name not in notes]
        if parity_fields and left_out and not any("crc" in field for field in fields):
            field_path, field = parity_fields[0]
            message = (
                f"{quoted(field.get('name', ''))} leaves out {quoted(left_out[0])}; "
                f"add it to 'parity_of', or add a 'note' that the manual leaves out {left_out[0]}"
            )
            report.add("spi-parity", (*path, *field_path, "parity_of"), message)


def _covered_fields(layout: Spec, parity_of: object) -> Iterator[str]:
    """Yield the fields that a parity bit covers, with those of joined numbers."""
    joins = mapping(layout, "join")
    for name in map(str, parity_of if isinstance(parity_of, list) else [parity_of]):
        yield from joins.get(name, [name])


def _free_fields(layout: Spec) -> Iterator[str]:
    """Yield the fields of a request whose values a user chooses."""
    for _, field in items(layout, "fields"):
        if _DECIDED.isdisjoint(field) and "name" in field:
            yield field["name"]


def _check_accesses(
    raw: Spec, layouts: dict[str, Spec], exchanges: list[tuple[Path, Spec]], report: DocumentReport
) -> None:
    """Check that registers have exchanges for their accesses, and that the frames of these have the needed fields."""
    groups = by_name(raw, "field_groups")
    for purpose, needed in _NEEDED.items():
        accesses = [(path, exchange) for path, exchange in exchanges if exchange["purpose"] == purpose]
        for names, key in zip(needed, KEYS.values(), strict=True):
            _check_fields(accesses, key, names, layouts, groups, report)
        if purpose == "read" and len(accesses) > 1:
            report.add("spi-exchange", (*accesses[1][0], "purpose"), "a second request reads registers; keep one")
        impossible_access = "write_only" if purpose == "read" else "read_only"
        for path, register in items(raw, "registers"):
            if interface_of(register) == Spi.name and not accesses and register.get("access") != impossible_access:
                message = (
                    f"no exchange has the purpose {purpose!r}, so {quoted(register.get('name', ''))} has no access; "
                    "add one under 'exchanges'"
                )
                report.add("spi-exchange", path, message)
                break


def _check_fields(
    accesses: list[tuple[Path, Spec]],
    key: str,
    needed: tuple[str, ...],
    layouts: dict[str, Spec],
    groups: dict[str, Spec],
    report: DocumentReport,
) -> None:
    """Check that the frames under a key of these exchanges have the needed fields, and requests no undecided ones."""
    names: set[str] = set()
    for _, exchange in accesses:
        names |= field_names(Fields(Has.LAYOUT, layouts.get(exchange[key], {}), (), Spi.name), groups).keys()
    missing_name = next((name for name in needed if name not in names), "")
    if accesses and missing_name:
        path, exchange = accesses[0]
        message = f"{quoted(exchange[key])} is for a register, so it needs the field {quoted(missing_name)}"
        report.add("spi-exchange", (*path, key), message)
    for path, exchange in accesses if key == "request" and not missing_name else ():
        free_names = _free_fields(layouts.get(exchange[key], {}))
        undecided_name = next((name for name in free_names if name not in needed), "")
        if undecided_name:
            message = (
                f"an access to a register gives no value for {quoted(undecided_name)} in {quoted(exchange[key])}; "
                "use 'constant' or 'unused' there"
            )
            report.add("spi-exchange", (*path, key), message)
