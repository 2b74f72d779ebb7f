"""Rules for clocks, baud rates and times of one interface that must agree with each other."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import Timing
from ...model.interfaces import Timeout
from ..problems import DocumentReport, Path
from ..schema_files import is_second
from ..written import Located
from ..written_interfaces import WrittenBiss, WrittenRs485, WrittenSpi, WrittenSsi
from ..written_parts import WrittenSpec
from .parts import WrittenInterface, explained, interfaces

#: Significant digits of the rates in data sheets.
_DIGITS = 3
#: Slower rates, such as the limits of slow masters, are not compared.
_LOWEST_HZ = 100_000
#: Every standard baud rate with more digits is a multiple of this one.
_STANDARD_BAUD = 300
#: Highest rate in Hz over lines as in RS-422 and RS-485, and the names of these lines.
_HIGHEST_HZ = 10_000_000
_LINES = re.compile(r"\bRS-?(?:422|485)\b", re.IGNORECASE)
#: Usual names of the times of an SSI encoder.
_MONOFLOP, _PAUSE = "monoflop", "pause"
_NS_PER_S, _NS_PER_US = 1_000_000_000, 1000


def round_rates(spec: WrittenSpec, raw: WrittenSpec, report: DocumentReport) -> None:
    """Check that rates have at most three significant digits, as in data sheets.

    Slow rates and standard baud rates are accepted, and so is a rate that a note of the interface gives.
    """
    if is_second(report.document.file):  # It has no notes.
        return
    for _, interface in interfaces(spec):
        for path, rate, unit in _rates(interface):
            digits = len(str(rate).rstrip("0"))
            is_standard = unit == "baud" and rate % _STANDARD_BAUD == 0
            is_high = rate >= _LOWEST_HZ
            if digits > _DIGITS and is_high and not is_standard and not _gives_rate(interface.note, rate):
                message = (
                    f"{rate} {unit} has {digits} significant digits, which is implausible; correct it, or say in a"
                    f" 'note' of the interface that it is {rate} {unit}"
                )
                report.add("implausible-rate", path, message)


def _gives_rate(note: str, rate: int) -> bool:
    """Return whether a note has the digits of a rate, with or without commas."""
    return str(rate) in note.replace(",", "")


def _rates(interface: WrittenInterface) -> Iterator[tuple[Path, int, str]]:
    """Yield the limits of the clock and for cables, or the baud rate, of an interface, with their places and units."""
    if isinstance(interface, WrittenRs485):
        if interface.port.is_valid("baud"):
            yield (*interface.port.path, "baud"), interface.port.part.baud, "baud"
        return
    clock = interface.clock
    for key, rate in (("min_hz", clock.part.min_hz), ("max_hz", clock.part.max_hz)):
        if rate is not None:
            yield (*clock.path, key), rate, "Hz"
    if isinstance(interface, WrittenSsi):
        for row in interface.cable_lengths:
            if row.is_valid("below_hz"):
                yield (*row.path, "below_hz"), row.part.below_hz, "Hz"


def rates_of_lines(spec: WrittenSpec, raw: WrittenSpec, report: DocumentReport) -> None:
    """Check that no clock or baud rate over RS-422 or RS-485 is above 10 MHz, unless a note of the interface gives it.

    An interface has such lines if it is RS-485 or its signals say so. Clocks for cables have a rule of their own.
    """
    if is_second(report.document.file):  # It has no notes.
        return
    for _, interface in interfaces(spec):
        if isinstance(interface, WrittenSpi):
            continue
        has_such_lines = isinstance(interface, WrittenRs485) or _LINES.search(interface.signals) is not None
        for path, rate, unit in _rates(interface) if has_such_lines else ():
            is_limit = path[-1] != "below_hz"
            if is_limit and rate > _HIGHEST_HZ and not _gives_rate(interface.note, rate):
                message = (
                    f"{rate} {unit} is above {_HIGHEST_HZ} {unit}, which is implausible over RS-422 or RS-485; correct"
                    f" it, or say in a 'note' of the interface that it is {rate} {unit}"
                )
                report.add("implausible-rate", path, message)


def monoflop(spec: WrittenSpec, raw: WrittenSpec, report: DocumentReport) -> None:
    """Check that the monoflop time of SSI is between half a period of the slowest clock and the pause.

    The shortest time that a timing gives counts, for the pause only a guaranteed one. An erratum explains others.
    """
    ssi = spec.interfaces.ssi
    timings = {timing.part.name: timing for timing in ssi.timings} if ssi is not None else {}
    if ssi is None or _MONOFLOP not in timings:
        return
    located_monoflop = timings[_MONOFLOP]
    time_us, key = _shortest(located_monoflop)
    lowest_hz = ssi.clock.part.min_hz
    place = ".".join(map(str, (*located_monoflop.path[:-1], _MONOFLOP, key)))
    if explained(report.document, place) or not time_us:
        return
    remedy = f"If this is what the manual says, add an erratum that affects {place}"
    if lowest_hz and 2 * lowest_hz * time_us * _NS_PER_US < _NS_PER_S:
        message = (
            f"{time_us} µs is shorter than half a period of the slowest clock, 'min_hz: {lowest_hz}', so it would end"
            f" within a word; correct one of the two. {remedy}"
        )
        report.add("monoflop", (*located_monoflop.path, key), message)
    pause_us = timings[_PAUSE].part.at_least_us if _PAUSE in timings else None
    if pause_us is not None and pause_us < time_us:
        message = (
            f"the pause of {pause_us} µs is shorter than the monoflop time of {time_us} µs; correct one of the two"
        )
        report.add("monoflop", (*timings[_PAUSE].path, "at_least_us"), f"{message}. {remedy}")


def _shortest(timing: Located[Timing]) -> tuple[int | None, str]:
    """Return the shortest guaranteed or else the typical time of a timing, with its key, or ``(None, "")``."""
    part = timing.part
    for key, time_us in (("at_least_us", part.at_least_us), ("typical_us", part.typical_us)):
        if time_us is not None:
            return time_us, key
    return None, ""


def cable_clocks(spec: WrittenSpec, raw: WrittenSpec, report: DocumentReport) -> None:
    """Check that each clock limit for cables is within the limits of the clock, unless an erratum explains it."""
    ssi = spec.interfaces.ssi
    if ssi is None:
        return
    lowest_hz, highest_hz = ssi.clock.part.min_hz or 0, ssi.clock.part.max_hz
    for row in ssi.cable_lengths:
        below_hz = row.part.below_hz
        is_too_high = highest_hz is not None and below_hz > highest_hz
        place = "interfaces.ssi.clock.max_hz" if is_too_high else "interfaces.ssi.clock.min_hz"
        if explained(report.document, place):
            continue
        if row.is_valid("below_hz") and (below_hz < lowest_hz or is_too_high):
            message = (
                f"no clock is below {below_hz} Hz for cables shorter than {row.part.shorter_than_m} m: the clock is"
                f" {lowest_hz} to {highest_hz} Hz"
            )
            if is_too_high:
                message = f"{below_hz} Hz is above 'max_hz: {highest_hz}'"
            remedy = "correct one of the two. If this is what the manual says, add an erratum that affects"
            report.add("clock-range", (*row.path, "below_hz"), f"{message}; {remedy} {place}")


def timeouts_and_clocks(spec: WrittenSpec, raw: WrittenSpec, report: DocumentReport) -> None:
    """Check that a BiSS time-out is longer than half a clock period and, if it follows the clock, in half periods.

    Printed time-outs without a rule are then whole numbers of half periods, apart from rounding to nanoseconds.
    """
    biss = spec.interfaces.biss
    timeout = biss.timeout if biss is not None else None
    if biss is None or timeout is None or explained(report.document, *map(str, timeout.path), "printed"):
        return
    remedy = f"correct one of the two. If this is what the manual says, add an erratum that affects {_dotted(timeout)}"
    _check_longest_timeout(biss, timeout, remedy, report)
    if timeout.part.rule != "follows_clock" or timeout.part.half_clock_periods is not None:
        return
    for index, printed in enumerate(timeout.part.printed):
        half_periods = 2 * printed.clock_hz * printed.timeout_ns / _NS_PER_S
        rounding = printed.clock_hz / _NS_PER_S  # Half a nanosecond, in half periods.
        if abs(half_periods - round(half_periods)) > rounding or round(half_periods) < 1:
            message = (
                f"{printed.timeout_ns} ns are {half_periods:.3g} half periods at {printed.clock_hz} Hz, but a time-out"
                f" that follows the clock is a whole number of them; {remedy}"
            )
            report.add("timeout-mismatch", (*timeout.path, "printed", index, "timeout_ns"), message)


def _check_longest_timeout(biss: WrittenBiss, timeout: Located[Timeout], remedy: str, report: DocumentReport) -> None:
    """Report a longest time-out that is shorter than half a period of the slowest clock."""
    longest_ns, lowest_hz = timeout.part.at_most_ns, biss.clock.part.min_hz
    if longest_ns and lowest_hz and 2 * lowest_hz * longest_ns < _NS_PER_S:
        message = (
            f"{longest_ns} ns is shorter than half a period of the slowest clock, 'min_hz: {lowest_hz}', so it would"
            f" end within a frame; {remedy}"
        )
        report.add("timeout-mismatch", (*timeout.path, "at_most_ns"), message)


def _dotted(timeout: Located[Timeout]) -> str:
    return ".".join(map(str, (*timeout.path, "printed")))
