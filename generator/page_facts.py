"""What a page about a device says of everything but layouts: interfaces, CRCs, procedures, examples; rows of tables whose cells are Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from .markdown import cited, code, joined, link, text
from .model import Alarm, Argument, Crc, Device, Example, Input, Interface, Procedure, Register, Step, Timing
from .page import address, bit_link, errata_links, expression, hexadecimal, is_said, named, value_text
from .words import hertz, microseconds, nanoseconds, number, timeout_words

_ACCESS = {"read_only": "read only", "read_write": "read and write", "write_only": "write only"}
_ALIGNMENT = {"msb_left": "left: the MSB comes with the first clock, zeros follow the word", "lsb_right": "right: zeros come before the word"}
_CODE = {"binary": "binary", "gray": "Gray", "by_order_code": "binary or Gray, by order code"}
_ABOVE_MAX = {"default": "the encoder takes the default instead", "refused": "the encoder refuses it"}
_SEVERITY = {
    "wrong_data": "wrong bytes or bits on the wire",
    "wrong_limit": "a wrong limit or order code",
    "omission": "something missing",
    "wording": "wording only",
}
_STATUS = {"settled": "settled by the manual's own evidence or by arithmetic", "open": "open: only hardware or the maker could decide"}


def interface_rows(interface: Interface) -> Iterator[tuple[str, str, str]]:
    """Fact, value, source."""
    own = cited(interface.source)
    if interface.clock_min_hz is not None and interface.clock_max_hz is not None:
        yield "Clock", f"{hertz(interface.clock_min_hz)} to {hertz(interface.clock_max_hz)}", cited(interface.clock_source)
    if interface.signals:
        yield "Signals", text(interface.signals), own
    if interface.alignment:
        yield "Alignment", text(_ALIGNMENT.get(interface.alignment, interface.alignment)), cited(interface.alignment_source)
    if interface.output_code:
        yield "Code", text(_CODE.get(interface.output_code, interface.output_code)), cited(interface.output_code_source)
    if interface.profile:
        yield "Profile", text(interface.profile), own
    if interface.description_file:
        yield "Description file", text(interface.description_file), own
    if interface.bank_select:
        yield "Bank select", link(code(interface.bank_select), f"#register-{interface.bank_select}"), own
    if interface.network is not None:
        slaves = "several slaves allowed" if interface.network.multiple_slaves else "one slave only"
        yield "Network", f"{text(interface.network.topology.replace('_', ' '))}, {slaves}", cited(interface.network.source)
    timeout = interface.timeout
    if timeout is not None:
        # Without a rule the words have the printed values already.
        shown = timeout.printed if timeout.half_clock_periods is not None else ()
        printed = "; ".join(f"{nanoseconds(item.timeout_ns)} at {hertz(item.clock_hz)}" for item in shown)
        yield "Time-out", timeout_words(timeout) + (f" ({printed})" if printed else ""), cited(timeout.source)
    port = interface.port
    if port is not None:
        parity, flow = (f"{text(value).replace('none', 'no')} {what}" for value, what in ((port.parity, "parity"), (port.flow_control, "flow control")))
        settings = f"{number(port.baud)} Bd, {port.data_bits} data bits, {parity}, {port.stop_bits} stop bit{'s' * (port.stop_bits > 1)}"
        yield "Port", f"{settings}, {flow}", cited(port.source)


def timing_rows(timings: tuple[Timing, ...]) -> Iterator[tuple[str, ...]]:
    """Name, meaning, bounds, source."""
    for item in timings:
        bounds = (("at least", item.at_least_us), ("typically", item.typical_us), ("at most", item.at_most_us))
        words = ", ".join(f"{word} {microseconds(value)}" for word, value in bounds if value is not None)
        yield joined([code(item.name), text(item.symbol)]), text(item.meaning), words, cited(item.source)


def crc_rows(crc: Crc) -> Iterator[tuple[str, str]]:
    """The parameters and every spelling of the polynomial that masters ask for."""
    full = crc.poly_with_top_bit
    yield "Polynomial", text(crc.polynomial)
    yield "with its top bit", f"`0x{full:X}` = {full} = `{full:b}b`"
    yield "without its top bit", f"`0x{crc.poly:02X}`"
    if full & 1:
        yield "without its last 1", f"`0x{full >> 1:X}`"
    yield "Width", f"{crc.width} bit{'s' * (crc.width > 1)}"
    yield "Start value", f"`0x{crc.init:X}`"
    yield "Input, output reflected", f"{_yes(crc.refin)}, {_yes(crc.refout)}"
    inverted = " (sent inverted)" if crc.xorout == crc.mask else " (sent as it is)" if crc.xorout == 0 else ""
    yield "XORed at the end", f"`0x{crc.xorout:X}`{inverted}"
    if crc.form == "xor":
        yield "In short", "the XOR of the bytes before it"


def _yes(value: bool) -> str:
    return "yes" if value else "no"


def access(register: Register) -> str:
    return _ACCESS[register.access]


def register_facts(device: Device, register: Register) -> Iterator[tuple[str, str]]:
    """Fact and value; what the register does not have is left out."""
    yield "Address", f"{address(register)}" + (f", {register.length} bytes" if register.length > 1 else "")
    yield "Access", access(register)
    if register.length > 1:
        order = "low byte first: {} holds the low byte" if register.byte_order == "low_byte_first" else "high byte first: {} holds the high byte"
        yield "Byte order", order.format(hexadecimal(register.address))
    if register.bank is not None:
        yield "Bank", f"{register.bank}"
    data = register.default_bytes()
    if data is not None:
        yield "Default", f"`{data.hex(' ').upper()}`"
    if (register.min is not None and not register.meanings) or register.max is not None:
        low = expression(register.min) if register.min is not None else "0"
        what = "" if register.limits_of == register.name else f" of {code(register.limits_of)}"
        yield f"Limits{what}", f"{low} to {expression(register.max)}" if register.max is not None else f"{low} or more"
    if register.above_max:
        yield "Above the limit", _ABOVE_MAX.get(register.above_max, register.above_max)
    if register.opened_by:
        path = ".".join(filter(None, [register.opened_by, register.opened_by_field]))
        yield "Opened by", f"{bit_link(path)} = {code(register.opened_by_value)}"
    if register.write_clears:
        yield "A write clears", ", ".join(link(code(name), f"#register-{name}") for name in register.write_clears)
    if register.clears_itself:
        yield "After a write", "goes back to its default by itself"
    if register.wait_at_least_ms is not None:
        yield "Wait after a write", f"at least {register.wait_at_least_ms} ms"
    if register.volatile:
        yield "At power-off", "to be kept, a written value has to be saved"
    if register.reserved:
        yield "Reserved", f"for the {register.reserved}"
    for item in register.meanings:
        bounds = f", {expression(item.min) or '0'} to {expression(item.max)}" if item.max is not None else ""
        yield f"While {bit_link(item.when)} = {code(item.value)}", joined([f"{code(item.name)}{bounds}", text(item.meaning), cited(item.source)])
    links = errata_links(device, f"registers.{register.name}")
    if links:
        yield "Errata", links


def step_rows(device: Device, procedure: Procedure) -> Iterator[tuple[str, ...]]:
    """Number, what to do, bytes, why, source."""
    for index, step in enumerate(procedure.steps, 1):
        what, data = _step(device, step)
        yield f"{index}", what, data, text(step.meaning), cited(step.source) if step.source != procedure.source else ""


def _step(device: Device, step: Step) -> tuple[str, str]:
    if step.do == "wait":
        return f"wait at least {microseconds(step.microseconds)}", ""
    if step.do == "send":
        again = f", {step.times} times" + (f", at least {microseconds(step.microseconds)} apart" if step.microseconds else "") if step.times > 1 else ""
        return f"send the request {code(step.data_id)}{again}", f"`{step.request.hex(' ').upper()}`"
    register = device.register(step.register)
    where = link(code(register.name), f"#register-{register.name}") + (f" field {code(step.field)}" if step.field else "")
    if step.do == "read":
        return f"read {where}", f"from {address(register)}"
    value = f"{code(step.value_name)}" if step.value_name else number(step.value or 0)
    if step.do == "poll":
        return f"poll: read {where} until it is {value}", f"from {address(register)}"
    if step.value is None:
        return f"write {value} to {where}", f"to {address(register)}: as the register's fields place it"
    data = step.value.to_bytes(register.length, "little" if register.byte_order == "low_byte_first" else "big")
    return f"write {value} to {where}", f"to {address(register)}: `{data.hex(' ').upper()}`" if not step.field else f"to {address(register)}, other fields as read"


def alarm_facts(device: Device, alarm: Alarm) -> Iterator[tuple[str, str]]:
    if alarm.field:
        places = ((alarm.group, f"#group-{alarm.group}"), (alarm.register, f"#register-{alarm.register}"))
        yield "Flag", " in ".join([code(alarm.field), *(link(code(name), target) for name, target in places if name)])
    yield "Meaning", text(alarm.meaning)
    if not (alarm.implemented or is_said(alarm)):
        yield "Implemented", "no"
    if alarm.detected:
        yield "Detected", text(alarm.detected)
    if alarm.below_mv is not None:
        yield "Raised below", f"{alarm.below_mv / 1000:g} V"
    if alarm.latch is not None:
        yield "Latched", "stays until it is reset" if alarm.latch else "no"
    if alarm.remedy:
        yield "How to clear", text(alarm.remedy)
    if alarm.cleared_by:
        yield "Cleared by", ", ".join(link(code(name), f"#procedure-{name}") for name in alarm.cleared_by)
    links = errata_links(device, f"alarms.{alarm.name}")
    if links:
        yield "Errata", links


def example_facts(device: Device, example: Example) -> Iterator[tuple[str, str]]:
    targets = (("Frame", "layout", example.layout), ("Register", "register", example.register), ("Procedure", "procedure", example.procedure), ("CRC", "crc", example.crc))
    yield from ((title, link(code(name), f"#{kind}-{name}")) for title, kind, name in targets if name)
    if example.order_code:
        yield "Order code", code(example.order_code)
    if example.kind == "frame":
        yield "Sent by", f"the {example.sender}"
    if example.bytes:
        yield "Bytes", f"`{example.bytes.hex(' ').upper()}`"
    if example.bits:
        yield "Bits", code(example.bits)
    if example.check is not None:
        yield "Check value", f"`{hexadecimal(example.check)}`"
    yield from ((f"Argument {code(name)}", number(value) + (f" ({hexadecimal(value)})" if value > 9 else "")) for name, value in example.arguments.items())
    if example.values:
        yield "Values", ", ".join(f"{code(name)} = {_value(value)}" for name, value in example.values.items())
    if example.counts is not None and example.micrometres is not None:
        yield "Length", f"{number(example.counts)} counts are {number(example.micrometres)} µm"
    if example.writes:
        yield "Writes", ", ".join(f"`{item.address:02X}h: {item.value:02X}`" for item in example.writes)
    if example.refused:
        yield "Refused", f"for its {text(example.refused)}"
    links = [link(code(example.erratum), f"#erratum-{example.erratum}") if example.erratum else "", errata_links(device, f"examples.{example.name}")]
    if any(links):
        yield "Errata", ", ".join(dict.fromkeys(", ".join(filter(None, links)).split(", ")))
    if example.note:
        yield "Note", text(example.note)
    yield "Source", cited(example.source)


def _value(value: int | str | bool) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return number(value) if isinstance(value, int) else code(value)


def status(value: str) -> str:
    return _STATUS[value]


def severity(value: str) -> str:
    return _SEVERITY[value]


def input_facts(device: Device, item: Input) -> Iterator[tuple[str, str]]:
    yield from (("Name", code(item.name)), ("Meaning", text(item.meaning)), ("Low level", text(item.low)), ("High level", text(item.high)))
    if item.pulse_at_least_us is not None:
        yield "Pulse", f"at least {microseconds(item.pulse_at_least_us)}"
    if item.inverts:
        yield "High level inverts", bit_link(item.inverts)
    if item.needs:
        yield "Works only if enabled by", bit_link(item.needs)
    if item.when_unused:
        yield "When unused", f"connect to {text(item.when_unused)}"
    if item.note:
        yield "Note", text(item.note)
    links = errata_links(device, f"inputs.{item.name}")
    if links:
        yield "Errata", links


def argument_line(argument: Argument) -> str:
    meant = f" as its {code(argument.meant_as)}" if argument.meant_as else ""
    return f"Argument {code(argument.name)}, written to {link(code(argument.of), f'#register-{argument.of}')}{meant}: {text(argument.meaning)}"


def control_rows(interface: Interface) -> Iterator[tuple[str, ...]]:
    """The fields of the BiSS control frame: name, bits, meaning, source."""
    for item in interface.control_data:
        values = [value_text(value, f"{value.value:0{item.bits}b}b") for value in item.values]
        crc = link(code(item.crc), f"#crc-{item.crc}") if item.crc else ""
        yield named(item.name, item.printed_name, item.names), f"{item.bits}", joined([text(item.meaning), crc, *values]), cited(item.source)


