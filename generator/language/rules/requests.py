"""Rules for requests with their replies, over SPI and RS-485."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ...model import Rs485, Spi
from ..document import Path
from ..problems import DocumentReport, quoted, suggestion
from ..schema_files import is_second
from .values import constant_width
from .walk import Fields, Has, Spec, by_name, expanded, field_names, interface_of, items, mapping

#: Senders with the key of their frames in an exchange.
KEYS: Mapping[str, str] = {"master": "request", "encoder": "reply"}
#: Largest width of a field, in bits, that is written out. The build reports wider words.
_WIDEST = 4096


def check_exchanges(
    spec: Spec, raw: Spec, interface: str, rule: str, report: DocumentReport
) -> list[tuple[Path, Spec]]:
    """Check that the frames of exchanges exist, and that each request is in one of them. Return the exchanges.

    A request for the position needs a measurement, because without one no output has a position.
    """
    interface_path = ("interfaces", interface)
    layouts = by_name(raw, *interface_path, "layouts")
    exchanges = list(items(spec, *interface_path, "exchanges"))
    for sender, key in KEYS.items():
        names = [name for name, layout in layouts.items() if layout.get("from") == sender]
        for path, exchange in exchanges:
            name = exchange.get(key, "")
            if name not in ("", *names):
                message = f"there is no layout {quoted(name)} from the {sender}{suggestion(name, names)}"
                report.add("undefined-reference", (*path, key), message)
    requests = [exchange["request"] for _, exchange in exchanges]
    for index, (path, exchange) in enumerate(exchanges):
        if exchange["request"] in requests[:index]:
            report.add(rule, (*path, "request"), f"{quoted(exchange['request'])} already has a reply; keep one")
    if "measurement" not in raw and "measurement" not in mapping(raw, *interface_path):
        for path, exchange in exchanges:
            if exchange["purpose"] == "position":
                message = (
                    f"{quoted(exchange['request'])} asks for the position, but the spec has no 'measurement'; add one"
                )
                report.add(rule, (*path, "purpose"), message)
    return exchanges


def report_unused(
    layout: Spec, path: Path, exchanges: list[tuple[Path, Spec]], rule: str, report: DocumentReport
) -> None:
    """Report a frame that no exchange contains."""
    key = KEYS.get(layout.get("from", ""), "")
    if key and layout["name"] not in [exchange.get(key) for _, exchange in exchanges]:
        message = f"no exchange has {quoted(layout['name'])} as its {key}; add one under 'exchanges'"
        report.add(rule, path, message)


_RS485_PATH = ("interfaces", Rs485.name)
_RULE = "rs485-exchange"
#: Keys that belong to data IDs, in the interface and in its layouts.
_OF_DATA_IDS = ("data_ids", "memory_access")


def requests(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each request over RS-485 has a data ID, or is in an exchange with its reply."""
    interface = mapping(spec, *_RS485_PATH)
    if not interface:
        return
    if mapping(interface, "port").get("data_bits", 8) != 8:
        message = "frames over RS-485 consist of bytes, so a character has 8 data bits, and its parity bit is 'parity'"
        report.add(_RULE, (*_RS485_PATH, "port", "data_bits"), message)
    if "exchanges" not in interface:
        if "data_ids" not in mapping(raw, *_RS485_PATH):
            message = "no request is described; add 'data_ids' (for frames like those of the T-format) or 'exchanges'"
            report.add(_RULE, _RS485_PATH, message)
        return
    for key in _OF_DATA_IDS:
        if key in interface:
            message = f"{quoted(key)} belongs to frames like those of the T-format; keep either it or 'exchanges'"
            report.add(_RULE, (*_RS485_PATH, key), message, at_key=True)
    _check_exchanges(spec, raw, report)


def _check_exchanges(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that one exchange has the position, and that each frame is in an exchange."""
    exchanges = check_exchanges(spec, raw, Rs485.name, _RULE, report)
    positions = [(path, exchange) for path, exchange in exchanges if exchange["purpose"] == "position"]
    for path, exchange in positions:
        if "reply" not in exchange:
            report.add(_RULE, path, f"{quoted(exchange['request'])} asks for the position, so it needs a 'reply'")
    for path, _ in positions[1:]:
        report.add(_RULE, (*path, "purpose"), "a second request asks for the position; use 'other'")
    for path, layout in items(spec, *_RS485_PATH, "layouts"):
        report_unused(layout, path, exchanges, _RULE, report)
        if "when" in layout:
            message = "the request decides which frame is the reply; leave 'when' out"
            report.add(_RULE, (*path, "when"), message, at_key=True)
        if layout.get("carried_as") == "bits":
            message = f"{quoted(layout['name'])} is sent over a serial port, as bytes; use 'carried_as: bytes'"
            report.add(_RULE, (*path, "carried_as"), message)


_SPI_PATH = ("interfaces", Spi.name)
#: Fields of the requests, and of the reply, that access a register.
_NEEDED = {"read": (("address",), ("data",)), "write": (("address", "data"), ())}


def exchanges(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each frame over SPI is a request or its reply, and that accesses have their fields."""
    layouts = by_name(raw, *_SPI_PATH, "layouts")
    if not mapping(spec, *_SPI_PATH):
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
    interface = mapping(spec, *_SPI_PATH)
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
    for path, layout in items(spec, *_SPI_PATH, "layouts"):
        key = KEYS.get(layout.get("from", ""), "")
        if exchanges or key == "request" or path[-1] != 0:
            report_unused(layout, path, exchanges, "spi-exchange", report)
        if layout.get("carried_as") == "bytes":
            message = f"{quoted(layout['name'])} is an SPI word, which is always carried as bits; remove 'carried_as'"
            report.add("spi-exchange", (*path, "carried_as"), message)


def _check_parities(spec: Spec, report: DocumentReport) -> None:
    """Check that the parity bits of a word without a CRC cover the other fields, unless a note names those left out."""
    for path, layout in items(spec, *_SPI_PATH, "layouts"):
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


_SPI_REQUESTS_PATH = ("interfaces", Spi.name)


def requests_that_write(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that constants distinguish each request from those that write, unless a note of its layout explains it.

    A second word of a write has no address. The encoder knows it by the word before.
    """
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    groups, layouts = by_name(raw, "field_groups"), by_name(spec, *_SPI_REQUESTS_PATH, "layouts")
    exchanges = [exchange for _, exchange in items(spec, *_SPI_REQUESTS_PATH, "exchanges")]
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
            report.add("spi-exchange", (*_SPI_REQUESTS_PATH, "layouts", name), f"{problem}; {remedy}")


def _may_be_equal(request: str, write: str) -> bool:
    """Return True if two words have the same length and no constant bit differs."""
    if len(request) != len(write):
        return False
    return all(bit == write_bit or "?" in (bit, write_bit) for bit, write_bit in zip(request, write, strict=True))


def _constant_bits(layout: Spec, groups: dict[str, Spec]) -> str:
    """Return a word as 0, 1 and ? for bits that are not constant. Empty if a width depends on the order code."""
    bits = ""
    for _, field in expanded(Fields(Has.LAYOUT, layout, (), Spi.name), groups):
        width = 1 if "parity_of" in field else constant_width(field)
        if width is None or width > _WIDEST:
            return ""
        constant = field.get("constant", field.get("unused"))
        bits += f"{constant:0{width}b}" if isinstance(constant, int) else "?" * width
    return bits


def _free_names(layout: Spec, groups: dict[str, Spec]) -> Iterator[str]:
    """Yield the names of the fields that have no fixed value."""
    for _, field in expanded(Fields(Has.LAYOUT, layout, (), Spi.name), groups):
        if "constant" not in field and "unused" not in field:
            yield str(field.get("name"))
