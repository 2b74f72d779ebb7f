"""Clock or baud rate by cable length, and pauses, on the page of an order code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...masters.cable import cable_table
from ...model import (
    Biss,
    Clock,
    Device,
    Interface,
    Layout,
    Rs485,
    Spi,
    Ssi,
    assert_never,
    choices,
)
from ...model.record import dataclass
from ...say.evidence import Subject
from ...say.interface import bounds_with_codes, clock_words, settings
from ...say.markdown import STYLE, cited, text
from ...say.text import counted, hertz, nanoseconds, timeout_words
from .unstated import unstated_facts

Row = tuple[str, ...]
#: Bits of a BiSS frame before the position: the start bit and the CDS bit.
_BISS_START_BITS = 2


@dataclass(frozen=True, slots=True)
class SpeedSection:
    """Clock or baud rate: specified values, and a table of clock and frame duration by cable length."""

    title: str
    facts: tuple[str, ...]
    head: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()


def speed_section(family: Device, device: Device, interface: Interface, layout: Layout | None) -> SpeedSection:
    match interface:
        case Ssi() | Biss():
            return _clock_section(family, device, interface, layout)
        case Spi():
            setting_sentences = map(STYLE.sentence, settings(device, interface))
            return SpeedSection("Clock and words", tuple(setting_sentences))
        case Rs485():
            return _baud_section(family, device, interface)
        case _:
            assert_never(interface)


def _clock_section(family: Device, device: Device, interface: Ssi | Biss, layout: Layout | None) -> SpeedSection:
    clock = interface.clock
    lengths = _frame_lengths(device, layout) if layout is not None else []
    start_bits = _BISS_START_BITS if isinstance(interface, Biss) else 0
    clocked_lengths = [bits + start_bits for bits in lengths]
    lowest_hz, highest_hz = clock.min_hz or 0, clock.fastest_hz
    example_hz = min(max(1_000_000, lowest_hz), highest_hz)
    facts = [f"Clock: {clock_words(clock)} ({cited(clock.source)})."]
    if lengths:
        durations = _durations(clocked_lengths, example_hz)
        with_start_bits = ", with the start bit and the CDS bit" if start_bits else ""
        facts.append(f"{_joined_by_or(map(str, lengths))} bits at {hertz(example_hz)}: {durations}{with_start_bits}.")
    facts += _pauses(family, interface)
    table = cable_table(device, interface)
    rows: list[Row] = []
    for row in table.rows:
        if row.hz >= lowest_hz:
            hz = min(row.hz, highest_hz)
            rows.append((f"{row.metres} m", hertz(hz), _durations(clocked_lengths, hz)))
    if rows:
        facts.append(f"Clock for each cable length: from {text(table.origin)}{_limit_of_used_clocks(clock)}.")
    is_below = any(row.is_below for row in table.rows)
    head = ("Cable below", "Clock below", "Frame above") if is_below else ("Cable up to", "Clock up to", "Frame")
    return SpeedSection("Clock and cable", tuple(facts), head, tuple(rows))


def _limit_of_used_clocks(clock: Clock) -> str:
    """Return why the table ends at a clock, if that is not the highest clock of the encoder."""
    return "" if clock.max_hz is not None else f", up to {hertz(clock.fastest_hz)}, the fastest clock in use"


def _pauses(family: Device, interface: Ssi | Biss) -> Iterator[str]:
    """Yield the time between frames, and the time until the encoder answers."""
    match interface:
        case Ssi():
            pauses = [timing for timing in interface.timings if timing.symbol == "Tp"]
            for pause in pauses:
                yield f"Pause between two words: {bounds_with_codes(pause)} ({cited(pause.source)})."
        case Biss():
            if interface.timeout is not None:
                yield f"Time-out after a frame: {timeout_words(interface.timeout)} ({cited(interface.timeout.source)})."
            yield from unstated_facts(family, interface, {"reply time (acknowledge)": Subject.REPLY_TIME})


def _baud_section(family: Device, device: Device, interface: Rs485) -> SpeedSection:
    port = interface.port
    bits_per_byte = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
    sizes = sorted({layout.widest // 8 for layout in interface.layouts if layout.sender == "encoder"})
    times = ", ".join(f"{counted(size, 'byte')} {_duration(size * bits_per_byte, port.baud)}" for size in (1, *sizes))
    baud_rate = STYLE.phrase(next(iter(settings(device, interface))))
    facts = (
        f"{baud_rate} ({cited(port.source)}).",
        f"Duration ({bits_per_byte} bits per byte): {times}.",
        *unstated_facts(family, interface, {"reply time": Subject.REPLY_TIME, "cable length": Subject.CABLE}),
    )
    return SpeedSection("Baud rate and times", facts)


def _frame_lengths(device: Device, layout: Layout) -> list[int]:
    """Return the lengths of a frame in bits, one for each answer to questions that the manual leaves open."""
    return sorted({layout.sent_bits.value(sets) for _, sets in choices(device.alternatives_of(layout))})


def _joined_by_or(alternatives: Iterable[str]) -> str:
    return " or ".join(alternatives)


def _durations(lengths: Iterable[int], hz: int) -> str:
    return _joined_by_or(_duration(bits, hz) for bits in lengths)


def _duration(bits: int, hz: int) -> str:
    """Return the duration of some bits, in microseconds with one decimal if it is long."""
    exact_ns = bits * 1_000_000_000 / hz
    return nanoseconds(round(exact_ns)) if exact_ns % 100 == 0 else f"{exact_ns / 1000:.1f} µs"
