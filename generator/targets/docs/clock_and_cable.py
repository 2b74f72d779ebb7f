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
from ...say.evidence import document
from ...say.interface import clock_words, settings
from ...say.markdown import STYLE, cited, text
from ...say.timing import bounds
from ...say.words import counted, hertz, nanoseconds, timeout_words

Row = tuple[str, ...]
#: Bits of a BiSS frame before the position: the start bit and the CDS bit.
_BEFORE_BISS = 2


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
    lowest, highest = clock.min_hz or 0, clock.fastest_hz
    shown = min(max(1_000_000, lowest), highest)
    facts = [f"Clock: {clock_words(clock)} ({cited(clock.source)})."]
    if lengths:
        durations = _either(_duration(bits + before, shown) for bits in lengths)
        facts.append(f"{_either(map(str, lengths))} bits at {hertz(shown)}: {durations}{plus}.")
    facts += _pauses(device, interface)
    table = cable_table(device, interface)
    fitting = [(row.metres, min(row.hz, highest)) for row in table.rows if row.hz >= lowest]
    rows = tuple((f"{m} m", hertz(hz), _either(_duration(bits + before, hz) for bits in lengths)) for m, hz in fitting)
    if rows:
        facts.append(f"Clock for each cable length: from {text(table.origin)}{_up_to_used(clock)}.")
    is_below = any(row.is_below for row in table.rows)
    head = ("Cable below", "Clock below", "Frame above") if is_below else ("Cable up to", "Clock up to", "Frame")
    return Speed("Clock and cable", tuple(facts), head, rows)


def _up_to_used(clock: Clock) -> str:
    """Return why the table ends at a clock, if that is not the highest clock of the encoder."""
    return "" if clock.max_hz is not None else f", up to {hertz(clock.fastest_hz)}, the fastest clock in use"


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
