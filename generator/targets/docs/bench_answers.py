"""Answers at the top of the page of an order code: pins, clock and cable, the frame, and the bytes to send."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from ...masters.cable import cable_table
from ...model import (
    Biss,
    Connector,
    Crc,
    DataId,
    Device,
    Interface,
    Layout,
    ModifyStep,
    PollStep,
    ReadStep,
    Register,
    Rs485,
    SendStep,
    Spi,
    Ssi,
    Step,
    Variant,
    Verdict,
    WaitStep,
    WriteStep,
    assert_never,
    choices,
)
from ...plan.codec import codec_of, constant_values
from ...plan.replies import exchanges
from ...plan.reports import reportings
from ...plan.values import Active, Raw, TwosComplement, meaning_of
from ...plan.verdicts import Judgement, Only, Speaks
from ...say.box import as_words
from ...say.crc import inverted
from ...say.evidence import document
from ...say.interface import PURPOSES, settings, word_lengths
from ...say.markdown import STYLE, anchor, cited, code, joined, link, text
from ...say.name import title
from ...say.place import addresses, bits, frame_bytes
from ...say.report import deciding
from ...say.text import said
from ...say.timing import bounds
from ...say.words import WORTH, counted, hertz, microseconds, nanoseconds, sentence, timeout_words, volts

Row = tuple[str, ...]
T = TypeVar("T")
_SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
#: Bits of a BiSS frame before the position: the start bit and the CDS bit.
_BEFORE_BISS = 2


@dataclass(frozen=True, slots=True)
class Wiring:
    """Table of contacts and signals.

    ``about`` lists the connectors and cables of each column, and ``notes`` the sentences that apply to all of them.
    ``errata`` are the paths of the connectors in the spec.
    """

    head: tuple[str, ...]
    rows: tuple[Row, ...]
    about: tuple[str, ...]
    notes: tuple[str, ...]
    errata: tuple[str, ...]


def wiring(device: Device) -> Wiring:
    """Return one table with the contacts of every connector and cable for each signal."""
    columns = _columns(device.connectors)
    signals = dict.fromkeys(item.signal for connector in device.connectors for item in connector.contacts)
    kinds = ["Wire" if column[0].kind == "cable" else "Pin" for column in columns]
    head = [
        kind if kinds.count(kind) == 1 else f"{kind} {kinds[: index + 1].count(kind)}"
        for index, kind in enumerate(kinds)
    ]
    rows = [(*(_contacts(column, signal) for column in columns), text(signal)) for signal in signals]
    about = [f"{name}: {', '.join(_marked(column, _named))}" for name, column in zip(head, columns, strict=True)]
    sentences = [item.note.rstrip(".").split(". ") for item in device.connectors]
    notes = [text(sentence(one)) for one in (sentences or [[]])[0] if one and all(one in other for other in sentences)]
    errata = tuple(f"connectors.{item.name}" for item in device.connectors)
    return Wiring((*head, "Signal"), tuple(rows), tuple(about), tuple(notes), errata)


def _columns(connectors: Sequence[Connector]) -> list[list[Connector]]:
    """Group connectors of one kind that have the same contacts for most signals of the one with fewer."""
    columns: list[list[Connector]] = []
    for item in connectors:
        for column in columns:
            mine, other = _by_signal(item), _by_signal(column[0])
            alike = sum(mine.get(signal) == contacts for signal, contacts in other.items())
            if item.kind == column[0].kind and 2 * alike > min(len(mine), len(other)):
                column.append(item)
                break
        else:
            columns.append([item])
    return columns


def _by_signal(connector: Connector) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for item in connector.contacts:
        found.setdefault(item.signal, []).append(item.contact)
    return found


def _contacts(column: Sequence[Connector], signal: str) -> str:
    """Return the contacts of a signal, marked with the number of their connector if they differ."""
    found = [_in_short(_by_signal(item).get(signal, [])) for item in column]
    return text(found[0] if len(set(found)) == 1 else ", ".join(_marked(found, str)))


def _marked(items: Sequence[T], written: Callable[[T], str]) -> list[str]:
    """Return the items that are not empty, followed by their number if there are several in a column."""
    return [
        f"{written(item)} ({index})" if len(items) > 1 else written(item) for index, item in enumerate(items, 1) if item
    ]


def _in_short(contacts: Sequence[str]) -> str:
    """Return contacts as a list, with three or more consecutive numbers as a range."""
    numbers = [int(item) for item in contacts if item.isdecimal()]
    if len(numbers) == len(contacts) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
        return f"{numbers[0]} to {numbers[-1]}"
    return ", ".join(contacts)


def _named(item: Connector) -> str:
    return f"{anchor(f'connector-{item.name}')}{text(item.title)}"


def supply(device: Device, variants: Sequence[Variant]) -> list[str]:
    """Return the supply of each order code, or of all if it is the same, with its source."""
    found: dict[str, list[str]] = {}
    for item in variants:
        needed = device.supply_of(item)
        if needed is not None:
            said_ = f"{volts(needed.min_mv)} to {volts(needed.max_mv)} ({cited(needed.source)})"
            found.setdefault(said_, []).append(item.code)
    if len(found) == 1:
        return list(found)
    return [f"{value} with {', '.join(map(code, codes))}" for value, codes in found.items()]


# -- clock, cable and times


@dataclass(frozen=True, slots=True)
class Speed:
    """Clock or baud rate: specified values, and a table of clock and frame duration by cable length."""

    title: str
    facts: tuple[str, ...]
    head: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()


def speed(device: Device, interface: Interface, layout: Layout | None) -> Speed:
    match interface:
        case Ssi() | Biss():
            return _clock(device, interface, layout)
        case Spi():
            shown = map(STYLE.sentence, settings(device, interface))
            return Speed("Clock and words", tuple(shown))
        case Rs485():
            return _baud(device, interface)
        case _:
            assert_never(interface)


def _clock(device: Device, interface: Ssi | Biss, layout: Layout | None) -> Speed:
    clock = interface.clock
    lengths = _lengths(device, layout) if layout is not None else []
    before = _BEFORE_BISS if isinstance(interface, Biss) else 0
    plus = ", with the start bit and the CDS bit" if before else ""
    shown = min(max(1_000_000, clock.min_hz), clock.max_hz)
    facts = [f"Clock: {hertz(clock.min_hz)} to {hertz(clock.max_hz)} ({cited(clock.source)})."]
    if lengths:
        durations = _either(_duration(bits + before, shown) for bits in lengths)
        facts.append(f"{_either(map(str, lengths))} bits at {hertz(shown)}: {durations}{plus}.")
    facts += _pauses(device, interface)
    table = cable_table(device, interface)
    fitting = [(row.metres, min(row.hz, clock.max_hz)) for row in table.rows if row.hz >= clock.min_hz]
    rows = tuple((f"{m} m", hertz(hz), _either(_duration(bits + before, hz) for bits in lengths)) for m, hz in fitting)
    if rows:
        facts.append(f"Clock for each cable length: from {text(table.origin)}.")
    is_below = any(row.is_below for row in table.rows)
    head = ("Cable below", "Clock below", "Frame above") if is_below else ("Cable up to", "Clock up to", "Frame")
    return Speed("Clock and cable", tuple(facts), head, rows)


def _pauses(device: Device, interface: Ssi | Biss) -> Iterator[str]:
    """Yield the time between frames, and the time until the encoder answers."""
    match interface:
        case Ssi():
            pause = next((item for item in interface.timings if item.symbol == "Tp"), None)
            if pause is not None:
                yield f"Pause between two words: {bounds(pause)} ({cited(pause.source)})."
        case Biss():
            if interface.timeout is not None:
                yield f"Time-out after a frame: {timeout_words(interface.timeout)} ({cited(interface.timeout.source)})."
            yield f"Reply time (acknowledge): the {document(device)} does not say."


def _baud(device: Device, interface: Rs485) -> Speed:
    port = interface.port
    bits = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
    sizes = sorted({item.widest // 8 for item in interface.layouts if item.sender == "encoder"})
    times = ", ".join(f"{counted(size, 'byte')} {_duration(size * bits, port.baud)}" for size in (1, *sizes))
    rate = STYLE.phrase(next(iter(settings(device, interface))))
    facts = (
        f"{rate} ({cited(port.source)}).",
        f"Duration on the line, with {bits} bits per byte: {times}.",
        f"Reply time and cable length: the {document(device)} does not say.",
    )
    return Speed("Baud rate and times", facts)


def _lengths(device: Device, layout: Layout) -> list[int]:
    """Return the lengths of a frame in bits, one for each answer to questions that the manual leaves open."""
    return sorted({layout.sent_bits.value(sets) for _, sets in choices(device.alternatives_of(layout))})


def _either(items: Iterable[str]) -> str:
    return " or ".join(items)


def _duration(bits: int, hz: int) -> str:
    """Return the duration of some bits, in microseconds with one decimal if it is long."""
    exact = bits * 1_000_000_000 / hz
    return nanoseconds(round(exact)) if exact % 100 == 0 else f"{exact / 1000:.1f} µs"


# -- the frame


def position_frame(family: Device, here: Interface) -> Layout | None:
    """Return the frame that says most about the position: its parts, then its flags. With a tie, the shortest."""
    telling = {item.name for item in family.interface(here.name).layouts if family.tells_position(here.name, item)}
    of = family.position_names(here.name)

    def worth(item: Layout) -> tuple[int, int, int]:
        flags = sum(isinstance(meaning_of(field), Active) for field in item.fields)
        return len(of & {field.name for field in item.fields}), flags, -item.widest

    return max((item for item in here.layouts if item.name in telling), key=worth, default=None)


def frame_facts(family: Device, layout: Layout, variant: Variant) -> Iterator[tuple[str, str]]:
    """Yield the CRC, the polarity of the flags and the verdict on the position, each in one line."""
    checked = family.crc_of(layout)
    yield "CRC", crc_line(checked) if checked is not None else "none"
    by_level: dict[str, list[tuple[str, str]]] = {}
    placed = layout.place(variant.parameters)
    for item in placed.fields:
        of_byte = frame_bytes(layout, placed.bits, item.high, item.low) if layout.in_bytes else ""
        at = (code(item.name), of_byte or bits(item.high, item.low))
        if isinstance(meaning_of(item.field), Active):
            by_level.setdefault(f"Active at {deciding(item.field)}", []).append(at)
        elif not of_byte and item.field.printed_name and deciding(item.field) in {"0", "1"}:
            by_level.setdefault("Not used by this encoder", []).append(at)
    yield from ((label, ", ".join(_with_places(names))) for label, names in by_level.items())
    judgement = next((item.judgement for item in reportings(family) if item.codec.layout.name == layout.name), None)
    if judgement is not None:
        yield "Position", verdict_line(judgement, variant, checked is not None)


def _with_places(flags: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield flags with their places. A byte is named only where it changes."""
    last = ""
    for name, place in flags:
        byte, _, bit = place.rpartition(", ")
        yield f"{name} ({bit if byte == last else place})"
        last = byte


def crc_line(crc: Crc) -> str:
    """Return the parameters of a CRC in one line, with the polynomial including its top bit."""
    powers = crc.polynomial.split("^")
    polynomial = powers[0] + "".join(
        part[: (end := len(part) - len(part.lstrip("0123456789")))].translate(_SUPERSCRIPT) + part[end:]
        for part in powers[1:]
    )
    reflected = {(True, True): "input and output reflected", (True, False): "input reflected"}
    parts = [
        f"poly `0x{crc.poly_with_top_bit:X}` ({text(polynomial)})",
        f"init {crc.init:#x}" if crc.init else "init 0",
        reflected.get((crc.refin, crc.refout), "output reflected" if crc.refout else ""),
        inverted(crc),
        counted(crc.width, "bit"),
        "over everything before it",
        "which is the XOR of these bytes" if crc.is_xor else "",
    ]
    return ", ".join(filter(None, parts))


def verdict_line(judgement: Judgement, variant: Variant, has_crc: bool) -> str:
    """Return the rule for the verdict on the position of an order code."""
    parts = []
    for verdict, items in judgement.worst_first:
        by_value: dict[str, list[str]] = {}
        for item in items:
            if _applies(item.only, variant):
                by_value.setdefault(deciding(item.by.field), []).append(_cause(item))
        if by_value:
            causes = (f"{' or '.join(names)} is {value}" for value, names in by_value.items())
            parts.append(f"{_VERDICT[verdict]} if {', or if '.join(causes)}")
    if not parts:
        return STYLE.phrase(said(WORTH[judgement.otherwise]))
    correct = ", if the CRC is correct," if has_crc else ""
    return "; ".join([*parts, f"otherwise{correct} {_VERDICT[judgement.otherwise]}"])


_VERDICT = {
    Verdict.USABLE: "✓ usable",
    Verdict.USABLE_WITH_WARNING: "▲ usable with a warning",
    Verdict.NOT_USABLE: "✕ **not usable**",
    Verdict.UNKNOWN: "? unknown",
}


def _cause(item: Speaks) -> str:
    unless = " and ".join(code(part.field.name) for part in item.unless)
    return code(item.by.field.name) + (
        f" (while {unless} {'is' if len(item.unless) == 1 else 'are'} inactive)" if unless else ""
    )


def _applies(only: Only | None, variant: Variant) -> bool:
    return only is None or bool(variant.parameters.get(only.parameter, 0)) == only.holds


# -- what to send


@dataclass(frozen=True, slots=True)
class Sending:
    """Requests and commands with their bytes. ``other_value`` says how to write a position other than 0."""

    facts: tuple[str, ...]
    requests: tuple[Row, ...]
    commands: tuple[Row, ...]
    other_value: str


def sending(family: Device, device: Device, interface: Interface, variant: Variant) -> Sending:
    requests, commands = tuple(_requests(device, interface)), tuple(_commands(device, variant))
    preset = next((item for item in _preset_registers(device) if zero_of(device, item, variant) is not None), None)
    facts = []
    match interface:
        case Ssi():
            facts.append("SSI only reads the position. It has no preset, reset or save command.")
        case Biss():
            if not commands:
                facts.append(f"The {document(device)} describes no commands over BiSS: no preset, reset or save.")
            elif preset is None:
                facts.append(f"The {document(device)} describes no preset over BiSS.")
            else:
                facts.append("Addresses and bytes are in hexadecimal. The preset is 0 in these rows.")
        case Rs485():
            if interface.exchanges:
                facts.append("The frames of the master are requests. The frames of the encoder answer them.")
            else:
                facts.append("Bytes are in hexadecimal. There is no preset other than the resets, and no save command.")
        case Spi():
            facts.append("The frames of the master are requests. The frames of the encoder answer them.")
        case _:
            assert_never(interface)
    inputs = [link(text(title(item)), f"#input-{item.name}") for item in device.inputs]
    if inputs:
        facts.append(f"Inputs: {', '.join(inputs)}.")
    other = _other_value(family.register(preset.name), variant) if preset is not None else ""
    return Sending(tuple(facts), requests, commands, other)


def _preset_registers(device: Device) -> Iterator[Register]:
    """Yield the registers to which procedures write a position."""
    for item in device.procedures:
        yield from (device.register(one.of) for one in item.arguments if one.name == "position")


def _other_value(register: Register, variant: Variant) -> str:
    """Return how to write another position, with an example."""
    low, width = register.layout.place(variant.parameters).place_of(register.limits_of)
    if not width:
        return ""
    order = register.byte_order.replace("_", " ")
    shift = f" × 2^{low}" if low else ""
    example = min(1000, (1 << width) - 1)
    data = register.bytes_of(example << low).hex(" ").upper()
    return (
        f"Another position: write position{shift} as {counted(register.length, 'byte')}, {order}, to "
        f"{link(addresses(register), f'#register-{register.name}')}. For 1,000: {code(data)}."
    )


def _requests(device: Device, interface: Interface) -> Iterator[Row]:
    """Yield rows of request with its reply, meaning."""
    for each in exchanges(interface):
        frames = [link(code(item.name), f"#layout-{item.name}") for item in (each.request, each.reply) if item]
        bits = each.item.word_bits
        about = [PURPOSES[each.item.purpose], f"in words of {word_lengths([bits])}" if bits is not None else ""]
        yield " → ".join(frames), ", ".join(filter(None, about)).capitalize()
    if not isinstance(interface, Rs485):
        return
    for item in interface.data_ids:
        asked, answered = (_frame_of(interface, sender, item.id) for sender in ("master", "encoder"))
        rest = asked.fields if asked is not None else ()
        others = dict.fromkeys(
            field.group or field.name for field in rest if not field.group or field.group != rest[0].group
        )
        sent = ", ".join([code(f"{item.control:02X}"), *(text(as_words(name).partition(" of ")[0]) for name in others)])
        back = (
            f" → {link(counted(answered.widest // 8, 'byte'), f'#layout-{answered.name}')}"
            if answered is not None
            else ""
        )
        told = joined([text(item.meaning or item.purpose), *_repeated(device, item)], ". ")
        yield sent + back, f"{told}. <small>Data ID {item.id:X} {code(item.name)}</small>"


def _repeated(device: Device, item: DataId) -> Iterator[str]:
    """Yield the repetition and the waiting time of the procedures that send only this request, with links."""
    for procedure in device.procedures:
        sends = [step for step in procedure.steps if isinstance(step, SendStep)]
        if [step.data_id for step in sends] == [item.name]:
            waits = [
                f"wait {microseconds(step.microseconds)}" for step in procedure.steps if isinstance(step, WaitStep)
            ]
            times = f"{sends[0].times} times"
            apart = f"at least {microseconds(sends[0].microseconds)} apart" if sends[0].microseconds else ""
            yield "Send it " + joined([link(times, f"#procedure-{procedure.name}"), apart, *waits], ", ")


def _frame_of(interface: Rs485, sender: str, data_id: int) -> Layout | None:
    return next((item for item in interface.layouts if item.sender == sender and data_id in item.selects), None)


def _commands(device: Device, variant: Variant) -> Iterator[Row]:
    """Yield rows of task and bytes to send for every procedure that writes or sends something."""
    for item in device.procedures:
        if any(isinstance(step, (WriteStep, ModifyStep)) for step in item.steps):
            sent = joined((_sent(device, step, variant) for step in item.steps), ", ")
            yield link(text(item.title), f"#procedure-{item.name}"), sent


def _sent(device: Device, step: Step, variant: Variant) -> str:
    match step:
        case WaitStep():
            return f"wait {microseconds(step.microseconds)}"
        case SendStep():
            return code(step.request.hex(" ").upper())
        case ReadStep():
            return f"read {addresses(device.register(step.register))}"
        case PollStep():
            return f"read {addresses(device.register(step.register))} until {code(step.field)} is {step.value}"
        case ModifyStep():
            register = device.register(step.register)
            value = "the new value" if step.value is None else f"{step.value}"
            return f"{addresses(register)}: {_bit_of(register, step.field, variant)} = {value}"
        case WriteStep():
            register = device.register(step.register)
            data = register.bytes_of(step.value) if step.value is not None else zero_of(device, register, variant)
            return f"{addresses(register)}: {code(data.hex(' ').upper()) if data is not None else 'the new value'}"
        case _:
            assert_never(step)


def _bit_of(register: Register, name: str, variant: Variant) -> str:
    placed = register.layout.place(variant.parameters).field(name)
    return bits(placed.high, placed.low) if placed is not None else code(name)


def zero_of(device: Device, register: Register, variant: Variant) -> bytes | None:
    """Return the bytes of a register that holds the position 0, or None for a register with anything else."""
    if register not in _preset_registers(device):
        return None
    constants = constant_values(codec_of(device, register.layout))
    total = 0
    for item in register.layout.place(variant.parameters).fields:
        if item.name in constants:
            total |= constants[item.name] << item.low
        elif not isinstance(meaning_of(item.field), (Raw, TwosComplement)):
            return None
    return register.bytes_of(total)
