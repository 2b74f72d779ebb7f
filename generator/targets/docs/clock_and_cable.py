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
from ...say.interface import clock_words, settings
from ...say.markdown import STYLE, cited, text
from ...say.mentions import Subject
from ...say.timing import bounds_with_codes
from ...say.words import counted, hertz, nanoseconds, timeout_words
from .unstated import unstated

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


def speed(family: Device, device: Device, interface: Interface, layout: Layout | None) -> Speed:
    match interface:
        case Ssi() | Biss():
            return _clock(family, device, interface, layout)
        case Spi():
            setting_sentences = map(STYLE.sentence, settings(device, interface))
            return Speed("Clock and words", tuple(setting_sentences))
        case Rs485():
            return _baud(family, device, interface)
        case _:
            assert_never(interface)


def _clock(family: Device, device: Device, interface: Ssi | Biss, layout: Layout | None) -> Speed:
    clock = interface.clock
    lengths = _lengths(device, layout) if layout is not None else []
    before = _BEFORE_BISS if isinstance(interface, Biss) else 0
    plus = ", with the start bit and the CDS bit" if before else ""
    lowest, highest = clock.min_hz or 0, clock.fastest_hz
    example_hz = min(max(1_000_000, lowest), highest)
    facts = [f"Clock: {clock_words(clock)} ({cited(clock.source)})."]
    if lengths:
        durations = _either(_duration(bits + before, example_hz) for bits in lengths)
        facts.append(f"{_either(map(str, lengths))} bits at {hertz(example_hz)}: {durations}{plus}.")
    facts += _pauses(family, interface)
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


def _pauses(family: Device, interface: Ssi | Biss) -> Iterator[str]:
    """Yield the time between frames, and the time until the encoder answers."""
    match interface:
        case Ssi():
            for pause in (timing for timing in interface.timings if timing.symbol == "Tp"):
                yield f"Pause between two words: {bounds_with_codes(pause)} ({cited(pause.source)})."
        case Biss():
            if interface.timeout is not None:
                yield f"Time-out after a frame: {timeout_words(interface.timeout)} ({cited(interface.timeout.source)})."
            yield from unstated(family, interface, {"reply time (acknowledge)": Subject.REPLY_TIME})


def _baud(family: Device, device: Device, interface: Rs485) -> Speed:
    port = interface.port
    bits = 1 + port.data_bits + (port.parity != "none") + port.stop_bits
    sizes = sorted({layout.widest // 8 for layout in interface.layouts if layout.sender == "encoder"})
    times = ", ".join(f"{counted(size, 'byte')} {_duration(size * bits, port.baud)}" for size in (1, *sizes))
    rate = STYLE.phrase(next(iter(settings(device, interface))))
    facts = (
        f"{rate} ({cited(port.source)}).",
        f"Duration ({bits} bits per byte): {times}.",
        *unstated(family, interface, {"reply time": Subject.REPLY_TIME, "cable length": Subject.CABLE}),
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
