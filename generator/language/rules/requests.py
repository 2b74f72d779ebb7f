"""Rules for requests with their replies, over SPI and RS-485."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ...model import Spi
from ..keys_of_fields import WrittenField, WrittenLayout
from ..keys_of_order_codes import WrittenRs485, WrittenRs485Exchange, WrittenSpi, WrittenSpiExchange
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted, suggest_word
from .parts import (
    FieldList,
    FieldOwner,
    Groups,
    by_name,
    constant_width,
    fields_by_name,
    interface_name_of,
    is_second_reading,
    with_groups_expanded,
)

#: Requests with their replies, over SPI or RS-485.
Exchanges = Sequence[WrittenRs485Exchange] | Sequence[WrittenSpiExchange]
LayoutsByName = Mapping[str, WrittenLayout]
#: Key of the frame in an exchange by its sender.
_FRAME_KEY_BY_SENDER: Mapping[str, str] = {"master": "request", "encoder": "reply"}
#: Bits of the longest SPI word. Another rule reports a longer one.
_WIDEST_WORD = 64


def check_exchanges(
    interface: WrittenRs485 | WrittenSpi,
    interface_with_invalid_parts: WrittenRs485 | WrittenSpi,
    spec: WrittenSpec,
    rule: str,
    report: DocumentReport,
) -> None:
    """Check that the frames of exchanges exist, and that no two exchanges have the same request.

    A request for the position needs a measurement, because without one no output has a position. Problems are reported
    under ``rule``. ``interface_with_invalid_parts`` is the same interface together with its invalid parts.
    """
    _check_frames_of_exchanges(interface.exchanges, by_name(interface_with_invalid_parts.layouts), report)
    has_measurement = spec.with_invalid_parts.has("measurement") or interface_with_invalid_parts.has("measurement")
    earlier_requests = set()
    for exchange in interface.exchanges:
        request = exchange.request
        if request in earlier_requests:
            report.add(rule, exchange.path_of("request"), f"{quoted(request)} already has a reply; keep one")
        earlier_requests.add(request)
        if exchange.purpose == "position" and not has_measurement:
            message = f"{quoted(request)} asks for the position, but the spec has no 'measurement'; add one"
            report.add(rule, exchange.path_of("purpose"), message)


def _frame_name(exchange: WrittenRs485Exchange | WrittenSpiExchange, frame_key: str) -> str:
    """Return the name of the frame under a key of an exchange: its request or its reply."""
    return exchange.request if frame_key == "request" else exchange.reply


def _check_frames_of_exchanges(exchanges: Exchanges, layout_by_name: LayoutsByName, report: DocumentReport) -> None:
    """Check that the request of each exchange is a layout that the master sends, and the reply one from the encoder."""
    for sender, frame_key in _FRAME_KEY_BY_SENDER.items():
        known_names = [frame_name for frame_name, layout in layout_by_name.items() if layout.from_ == sender]
        for exchange in exchanges:
            frame_name = _frame_name(exchange, frame_key)
            if frame_name and frame_name not in known_names:
                hint = suggest_word(frame_name, known_names)
                message = f"there is no layout {quoted(frame_name)} from the {sender}{hint}"
                report.add("undefined-reference", exchange.path_of(frame_key), message)


def _report_frame_without_exchange(
    layout: WrittenLayout, exchanges: Exchanges, rule: str, report: DocumentReport
) -> None:
    """Report a frame that is in no exchange, as the request of the master or as the reply of the encoder."""
    if layout.from_ not in _FRAME_KEY_BY_SENDER:
        return
    frame_key = _FRAME_KEY_BY_SENDER[layout.from_]  # 'request' or 'reply'
    names_in_exchanges = [_frame_name(exchange, frame_key) for exchange in exchanges]
    if layout.name not in names_in_exchanges:
        message = f"no exchange has {quoted(layout.name)} as its {frame_key}; add one under 'exchanges'"
        report.add(rule, layout.path, message)


_EXCHANGE_RULE = "rs485-exchange"
#: Keys that belong to data IDs, in the interface and in its layouts.
_KEYS_WITH_DATA_IDS = ("data_ids", "memory_access")


def check_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an RS-485 interface describes its requests with either data IDs or exchanges, and uses 8 data bits.

    An exchange is a request with its reply.
    """
    interface = spec.interfaces.rs485
    interface_with_invalid_parts = spec.with_invalid_parts.interfaces.rs485
    if interface is None or interface_with_invalid_parts is None or not interface.is_given:
        return
    port = interface.port
    has_other_length = port.has("data_bits") and port.part.data_bits != 8
    if has_other_length:
        message = "frames over RS-485 consist of bytes, so a character has 8 data bits, and its parity bit is 'parity'"
        report.add(_EXCHANGE_RULE, (*port.path, "data_bits"), message)
    if not interface.has("exchanges"):
        if not interface_with_invalid_parts.has("data_ids"):
            message = "no request is described; add 'data_ids' (for frames as in the T-format) or 'exchanges'"
            report.add(_EXCHANGE_RULE, interface.path, message)
        return
    for key in _KEYS_WITH_DATA_IDS:
        if interface.has(key):
            message = f"{quoted(key)} belongs to frames as in the T-format; keep either it or 'exchanges'"
            report.add(_EXCHANGE_RULE, interface.path_of(key), message, at_key=True)
    check_exchanges(interface, interface_with_invalid_parts, spec, rule=_EXCHANGE_RULE, report=report)
    _check_frames_of_rs485(interface, report)


def _check_frames_of_rs485(interface: WrittenRs485, report: DocumentReport) -> None:
    """Check the exchanges of an RS-485 interface, and the frames in them.

    At most one exchange may ask for the position, and it must have a reply. Every frame must be in an exchange, must be
    carried as bytes, and must not be selected by a data ID.
    """
    position_exchanges = [exchange for exchange in interface.exchanges if exchange.purpose == "position"]
    for exchange in position_exchanges:
        if not exchange.reply:
            message = f"{quoted(exchange.request)} asks for the position, so it needs a 'reply'"
            report.add(_EXCHANGE_RULE, exchange.path, message)
    for exchange in position_exchanges[1:]:
        first_request = quoted(position_exchanges[0].request)
        reason = f"programs poll the position with a single request, which is {first_request}"
        message = f"a second request asks for the position, but {reason}; use 'other'"
        report.add(_EXCHANGE_RULE, exchange.path_of("purpose"), message)
    for layout in interface.layouts:
        _report_frame_without_exchange(layout, interface.exchanges, rule=_EXCHANGE_RULE, report=report)
        if layout.when:
            message = "the request decides which frame is the reply; remove 'when'"
            report.add(_EXCHANGE_RULE, layout.path_of("when"), message, at_key=True)
        if layout.carried_as == "bits":
            message = f"{quoted(layout.name)} is sent over a serial port, as bytes; use 'carried_as: bytes'"
            report.add(_EXCHANGE_RULE, layout.path_of("carried_as"), message)


#: Fields that a request needs to access a register, and those that its reply needs, by the purpose of the request.
_NEEDED_IN_REQUEST = {"read": ("address",), "write": ("address", "data")}
_NEEDED_IN_REPLY: Mapping[str, tuple[str, ...]] = {"read": ("data",), "write": ()}


def check_spi_exchanges(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each frame over SPI is a request or its reply, and that accesses to registers have their fields."""
    interface = spec.interfaces.spi
    interface_with_invalid_parts = spec.with_invalid_parts.interfaces.spi
    if interface is None or interface_with_invalid_parts is None or not interface.is_given:
        return
    check_exchanges(interface, interface_with_invalid_parts, spec, rule="spi-exchange", report=report)
    _check_registers_over_spi(spec, report)
    _check_word_lengths(interface, report)
    _check_frames_over_spi(interface, report)
    _check_register_accesses(interface, interface_with_invalid_parts, spec, report)


def _check_registers_over_spi(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers over SPI have no byte order and no values that identify an encoder.

    Also check that no parameter is read from them.
    """
    for register in spec.registers:
        if interface_name_of(register) != Spi.name:
            continue
        if register.byte_order:
            message = (
                f"{quoted(register.name)} is sent as one number over SPI, high byte first; remove 'byte_order',"
                " or omit the register if its low byte comes first"
            )
            report.add("spi-exchange", register.path_of("byte_order"), message, at_key=True)
        for field in register.fields:
            if field.equals is not None:
                message = "an encoder cannot be identified by its registers over SPI; use 'constant' or 'meaning'"
                report.add("spi-exchange", field.path_of("equals"), message, at_key=True)
    register_by_name = by_name(spec.with_invalid_parts.registers)
    for name, parameter in spec.parameters.items():
        register_name, _, _ = parameter.read_from.partition(".")  # ``register`` or ``register.field``
        if interface_name_of(register_by_name.get(register_name)) == Spi.name:
            message = (
                f"a parameter cannot be read from a register over SPI; remove 'read_from' from {quoted(name)}"
                ", and give it a value for each order code"
            )
            report.add("spi-exchange", parameter.path_of("read_from"), message, at_key=True)


def _check_word_lengths(interface: WrittenSpi, report: DocumentReport) -> None:
    """Check that an exchange has its own ``word_bits`` only if its words are longer or shorter than usual.

    If each word carries the reply to the word before it, also check that all writes have words of the same length.
    """
    default_bits = interface.word_bits
    for exchange in interface.exchanges:
        if exchange.word_bits == default_bits:
            message = f"'word_bits' is {default_bits}, as for the interface; remove it from the exchange"
            report.add("spi-exchange", exchange.path_of("word_bits"), message, at_key=True)
    writes = [exchange for exchange in interface.exchanges if exchange.purpose == "write"]
    is_reply_late = interface.reply == "next_word"
    if not is_reply_late or not writes:
        return
    first_write, *other_writes = writes
    first_bits = default_bits if first_write.word_bits is None else first_write.word_bits
    for exchange in other_writes:
        word_bits = default_bits if exchange.word_bits is None else exchange.word_bits
        if word_bits != first_bits:
            message = (
                f"{quoted(exchange.request)} has {word_bits} bits and {quoted(first_write.request)} {first_bits}"
                ", so its word cannot hold the reply to the word before; give both the same 'word_bits'"
            )
            report.add("spi-exchange", exchange.path, message)


#: Keys of fields whose values follow from the spec or from other fields.
_KEYS_WITH_KNOWN_VALUES = ("constant", "unused", "parity_of", "crc", "use")


def _check_frames_over_spi(interface: WrittenSpi, report: DocumentReport) -> None:
    """Check that each frame over SPI is in an exchange and carried as bits."""
    for layout_index, layout in enumerate(interface.layouts):
        is_request = layout.from_ == "master"
        # Without exchanges, the first frame can be the only one: it is read with any word.
        if interface.exchanges or is_request or layout_index > 0:
            _report_frame_without_exchange(layout, interface.exchanges, rule="spi-exchange", report=report)
        if layout.carried_as == "bytes":
            message = f"{quoted(layout.name)} is an SPI word, which is always carried as bits; remove 'carried_as'"
            report.add("spi-exchange", layout.path_of("carried_as"), message)


def _fields_to_choose(layout: WrittenLayout | None) -> Iterator[str]:
    """Yield the names of the fields of a request whose values a user chooses: all but constants and check bits.

    If there is no request, nothing is yielded.
    """
    if layout is None:
        return
    for field in layout.fields:
        if field.name and not field.has(*_KEYS_WITH_KNOWN_VALUES):
            yield field.name


def _check_register_accesses(
    interface: WrittenSpi, interface_with_invalid_parts: WrittenSpi, spec: WrittenSpec, report: DocumentReport
) -> None:
    """Check that there is an exchange for reading registers and one for writing, if registers can be read or written.

    The frames of these exchanges must contain the address and the data. Only one exchange may read registers.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    layout_by_name = by_name(interface_with_invalid_parts.layouts)
    all_registers = spec.with_invalid_parts.registers
    spi_registers = [register for register in all_registers if interface_name_of(register) == Spi.name]
    for purpose, impossible_access in (("read", "write_only"), ("write", "read_only")):
        accesses = [exchange for exchange in interface.exchanges if exchange.purpose == purpose]
        if accesses:
            _check_requests_of_accesses(accesses, purpose, layout_by_name, group_by_name, report)
            _check_replies_of_accesses(accesses, purpose, layout_by_name, group_by_name, report)
        if purpose == "read" and len(accesses) > 1:
            second_access = accesses[1]
            message = "a second request reads registers; keep one"
            report.add("spi-exchange", second_access.path_of("purpose"), message)
        accessible_registers = [register for register in spi_registers if register.access != impossible_access]
        if accessible_registers and not accesses:
            register = accessible_registers[0]
            message = (
                f"no exchange has the purpose {purpose!r}, so {quoted(register.name)} has no access; "
                "add one under 'exchanges'"
            )
            report.add("spi-exchange", register.path, message)


def _check_requests_of_accesses(
    accesses: Sequence[WrittenSpiExchange],
    purpose: str,
    layout_by_name: LayoutsByName,
    group_by_name: Groups,
    report: DocumentReport,
) -> None:
    """Check that the requests of exchanges together have the fields to read (or write) a register: address and data.

    A request may have no other field whose value a user would have to choose.
    """
    needed_names = _NEEDED_IN_REQUEST[purpose]
    known_names: set[str] = set()
    for exchange in accesses:
        known_names |= _names_in_frame(exchange.request, layout_by_name, group_by_name)
    missing_names = [name for name in needed_names if name not in known_names]
    if missing_names:
        _report_missing_field(accesses[0], frame_key="request", missing_name=missing_names[0], report=report)
    else:
        _report_undecided_fields(accesses, needed_names, layout_by_name, report)


def _check_replies_of_accesses(
    accesses: Sequence[WrittenSpiExchange],
    purpose: str,
    layout_by_name: LayoutsByName,
    group_by_name: Groups,
    report: DocumentReport,
) -> None:
    """Check that the replies of exchanges that read registers together have the field ``data``."""
    known_names: set[str] = set()
    for exchange in accesses:
        known_names |= _names_in_frame(exchange.reply, layout_by_name, group_by_name)
    missing_names = [name for name in _NEEDED_IN_REPLY[purpose] if name not in known_names]
    if missing_names:
        _report_missing_field(accesses[0], frame_key="reply", missing_name=missing_names[0], report=report)


def _names_in_frame(frame_name: str, layout_by_name: LayoutsByName, group_by_name: Groups) -> set[str]:
    """Return the names of the fields of a frame. The set is empty if there is no such frame."""
    layout = layout_by_name.get(frame_name)
    return set(fields_by_name(_as_field_list(layout), group_by_name)) if layout is not None else set()


def _report_missing_field(
    access: WrittenSpiExchange, frame_key: str, missing_name: str, report: DocumentReport
) -> None:
    """Report a field that is missing in the request or reply of an exchange that accesses registers."""
    frame_name = _frame_name(access, frame_key)
    message = f"{quoted(frame_name)} is for a register, so it needs the field {quoted(missing_name)}"
    report.add("spi-exchange", access.path_of(frame_key), message)


def _report_undecided_fields(
    accesses: Sequence[WrittenSpiExchange],
    needed_names: tuple[str, ...],
    layout_by_name: LayoutsByName,
    report: DocumentReport,
) -> None:
    """Report each request that accesses registers and has another field whose value a user would have to choose."""
    for exchange in accesses:
        names_to_choose = _fields_to_choose(layout_by_name.get(exchange.request))
        undecided_names = [field_name for field_name in names_to_choose if field_name not in needed_names]
        if undecided_names:
            problem = f"a register access gives no value for {quoted(undecided_names[0])}"
            message = f"{problem} in {quoted(exchange.request)}; give it 'constant' or 'unused'"
            report.add("spi-exchange", exchange.path_of("request"), message)


def _as_field_list(layout: WrittenLayout) -> FieldList:
    return FieldList(FieldOwner.LAYOUT, layout, Spi.name)


def check_requests_that_write(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no SPI request can be the same word as a request that writes, unless a note of its layout explains it.

    Two words can be the same if they have the same length and no constant bit differs.
    """
    interface = spec.interfaces.spi
    # A second reading repeats printed facts, without the notes that may explain them.
    if interface is None or is_second_reading(report.document):
        return
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    layout_by_name = by_name(interface.layouts)
    write_requests = [exchange.request for exchange in interface.exchanges if exchange.purpose == "write"]
    word_by_write = dict(_words_of_writes(write_requests, layout_by_name, group_by_name))
    for exchange in interface.exchanges:
        name = exchange.request
        if name not in layout_by_name or name in write_requests:
            continue
        word = _word_with_constant_bits(layout_by_name[name], group_by_name)
        is_explained = bool(layout_by_name[name].note)
        if is_explained or not word:
            continue
        equal_writes = [write for write, word_of_write in word_by_write.items() if _may_be_equal(word, word_of_write)]
        if equal_writes:
            problem = f"{quoted(name)} can be the same word as {quoted(equal_writes[0])}, so it would write a register"
            remedy = "correct a 'constant' in one of them, or explain it in a 'note' of this layout"
            report.add("spi-exchange", (*interface.path, "layouts", name), f"{problem}; {remedy}")


def _words_of_writes(
    write_requests: Sequence[str], layout_by_name: LayoutsByName, group_by_name: Groups
) -> Iterator[tuple[str, str]]:
    """Yield each request that writes a register and that a word can be compared with, with its word such as ``01??``.

    Only a write with constants and an address that the user chooses is compared: a second word of a write has no
    address, and the encoder recognizes it by the word before.
    """
    for name in write_requests:
        if name not in layout_by_name:
            continue
        word = _word_with_constant_bits(layout_by_name[name], group_by_name)
        has_address_to_choose = "address" in _names_without_fixed_value(layout_by_name[name], group_by_name)
        if has_address_to_choose and _has_constant(word):
            yield name, word


def _has_constant(word: str) -> bool:
    """Return True if a word such as ``01??`` has a constant bit."""
    return "0" in word or "1" in word


def _may_be_equal(word: str, other_word: str) -> bool:
    """Return True if two words, such as ``01??`` and ``0?1?``, have the same length and no constant bit differs."""
    if len(word) != len(other_word):
        return False
    bit_pairs = zip(word, other_word, strict=True)
    return all(bit == other_bit or "?" in (bit, other_bit) for bit, other_bit in bit_pairs)


def _word_with_constant_bits(layout: WrittenLayout, group_by_name: Groups) -> str:
    """Return the bits of a word as text such as ``01??``, with a question mark for each bit that is not constant.

    The result is empty if the width of a field depends on the order code or is too large.
    """
    word = ""
    for _, field in with_groups_expanded(_as_field_list(layout), group_by_name):
        width = 1 if field.parity_of else constant_width(field)
        if width is None or width > _WIDEST_WORD:
            return ""
        fixed_value = _fixed_value(field)
        word += "?" * width if fixed_value is None else f"{fixed_value:0{width}b}"
    return word


def _fixed_value(field: WrittenField) -> int | None:
    """Return the value that a field always has, or None if its value can change."""
    return field.unused if field.constant is None else field.constant


def _names_without_fixed_value(layout: WrittenLayout, group_by_name: Groups) -> Iterator[str]:
    """Yield the names of the fields of a layout whose values can change."""
    for _, field in with_groups_expanded(_as_field_list(layout), group_by_name):
        if _fixed_value(field) is None:
            yield field.name
