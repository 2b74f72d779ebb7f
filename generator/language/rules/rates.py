"""Rules for clocks, baud rates and times of one interface that must agree with each other."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from fractions import Fraction

from ...model import Timing
from ...model.clocks import CableLength, Clock, Timeout
from ..problems import DocumentReport, Path
from ..schema_files import is_second
from ..written import LocatedPart
from ..written_interfaces import WrittenBiss, WrittenRs485, WrittenSpi, WrittenSsi
from ..written_parts import WrittenSpec
from .parts import WrittenInterface, as_affected_name, has_erratum_at, interfaces, share_codes

#: Significant digits of the rates in data sheets.
_SIGNIFICANT_DIGITS = 3
#: Slower rates, such as the limits of slow masters, are not compared.
_LOWEST_HZ = 100_000
#: Every standard baud rate with more digits is a multiple of this one.
_STANDARD_BAUD = 300
#: Highest rate in Hz over lines as in RS-422 and RS-485, and the names of these lines.
_HIGHEST_HZ = 10_000_000
_RS_LINES = re.compile(r"\bRS-?(?:422|485)\b", re.IGNORECASE)
#: Usual names of the times of an SSI encoder.
_MONOFLOP, _PAUSE = "monoflop", "pause"
#: Place of the timeouts of BiSS, and the path of their printed values in errata.
_PATH_OF_TIMEOUT = ("interfaces", "biss", "timeout")
_PATH_OF_PRINTED_TIMEOUTS = ".".join((*_PATH_OF_TIMEOUT, "printed"))
_NS_PER_S, _NS_PER_US = 1_000_000_000, 1000


def check_round_rates(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that rates have at most three significant digits, as in data sheets.

    Slow rates and standard baud rates are accepted, and so is a rate that a note of the interface gives.
    """
    if is_second(report.document.file):  # It has no notes.
        return
    for _, interface in interfaces(spec):
        for path, rate, unit in _yield_rates(interface):
            digits = len(str(rate).rstrip("0"))  # 2 for 1,500,000.
            is_standard = unit == "baud" and rate % _STANDARD_BAUD == 0
            is_high = rate >= _LOWEST_HZ
            is_explained = _contains_rate(interface.note, rate)
            if digits > _SIGNIFICANT_DIGITS and is_high and not is_standard and not is_explained:
                message = (
                    f"{rate} {unit} has {digits} significant digits, which is implausible; correct it, or say in a"
                    f" 'note' of the interface that it is {rate} {unit}"
                )
                report.add("implausible-rate", path, message)


def _contains_rate(note: str, rate: int) -> bool:
    """Return True if a note contains the digits of a rate, with or without commas."""
    return str(rate) in note.replace(",", "")


def _yield_rates(interface: WrittenInterface) -> Iterator[tuple[Path, int, str]]:
    """Yield the clock limits of an interface, or its baud rate, each with its path and unit: Hz or baud.

    Clock limits for cable lengths are included.
    """
    if isinstance(interface, WrittenRs485):
        if interface.port.is_valid("baud"):
            yield (*interface.port.path, "baud"), interface.port.part.baud, "baud"
        return
    for clock in interface.clock:
        for key, rate in (("min_hz", clock.part.min_hz), ("max_hz", clock.part.max_hz)):
            if rate is not None:
                yield (*clock.path, key), rate, "Hz"
    if isinstance(interface, WrittenSsi):
        for row in interface.cable_lengths:
            if row.is_valid("below_hz"):
                yield (*row.path, "below_hz"), row.part.below_hz, "Hz"


def check_rates_of_lines(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no clock or baud rate over RS-422 or RS-485 is above 10 MHz, unless a note of the interface gives it.

    An interface has such lines if it is RS-485 or its ``signals`` name them. Another rule checks clocks for cables.
    """
    if is_second(report.document.file):  # It has no notes.
        return
    for _, interface in interfaces(spec):
        if isinstance(interface, WrittenSpi):
            continue
        has_rs_lines = isinstance(interface, WrittenRs485) or _RS_LINES.search(interface.signals) is not None
        if not has_rs_lines:
            continue
        for path, rate, unit in _yield_rates(interface):
            is_for_cables = path[-1] == "below_hz"
            if rate > _HIGHEST_HZ and not is_for_cables and not _contains_rate(interface.note, rate):
                message = (
                    f"{rate} {unit} is above {_HIGHEST_HZ} {unit}, which is implausible over RS-422 or RS-485; correct"
                    f" it, or say in a 'note' of the interface that it is {rate} {unit}"
                )
                report.add("implausible-rate", path, message)


def check_monoflop(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the monoflop time of SSI is longer than half a period of the slowest clock.

    Also check that it is not longer than the pause between words. An erratum explains a time outside this range.
    """
    ssi = spec.interfaces.ssi
    if ssi is None:
        return
    for timing in ssi.timings:
        if timing.part.name == _MONOFLOP:
            _check_monoflop(timing, ssi, report)


def _check_monoflop(timing: LocatedPart[Timing], ssi: WrittenSsi, report: DocumentReport) -> None:
    """Check that a monoflop time fits the clocks and the pauses that apply to the same order codes."""
    time_us, key = _find_shortest(timing)
    # Errata refer to a part of a list by its name: interfaces.ssi.monoflop.at_least_us.
    affected_path = as_affected_name(".".join(map(str, (*timing.path[:-1], _MONOFLOP, key))))
    if has_erratum_at(report.document, affected_path) or not time_us:
        return
    remedy = f"If this is what the manual says, add an erratum that affects {affected_path}"
    for clock in ssi.clock:
        lowest_hz = clock.part.min_hz
        if not lowest_hz or not share_codes(clock.part, timing.part):
            continue
        # Half a period of the clock lasts _NS_PER_S / (2 * lowest_hz).
        is_shorter_than_half_period = 2 * lowest_hz * time_us * _NS_PER_US < _NS_PER_S
        if is_shorter_than_half_period:
            message = (
                f"{time_us} µs is shorter than half a period of the slowest clock, 'min_hz: {lowest_hz}', so it would"
                f" end within a word; correct one of the two. {remedy}"
            )
            report.add("monoflop", (*timing.path, key), message)
    for pause in ssi.timings:
        pause_us = pause.part.at_least_us
        if pause.part.name != _PAUSE or pause_us is None or not share_codes(pause.part, timing.part):
            continue
        if pause_us < time_us:
            message = (
                f"the pause of {pause_us} µs is shorter than the monoflop time of {time_us} µs; correct one of the two"
            )
            report.add("monoflop", (*pause.path, "at_least_us"), f"{message}. {remedy}")


def _find_shortest(timing: LocatedPart[Timing]) -> tuple[int | None, str]:
    """Return the guaranteed shortest time of a timing or, without one, the typical time, with its key.

    The result is ``(None, "")`` if the timing has neither.
    """
    part = timing.part
    for key, time_us in (("at_least_us", part.at_least_us), ("typical_us", part.typical_us)):
        if time_us is not None:
            return time_us, key
    return None, ""


def check_cable_clocks(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each clock limit for cables is within the limits of the clock, unless an erratum explains it."""
    ssi = spec.interfaces.ssi
    if ssi is None:
        return
    for row in ssi.cable_lengths:
        for clock in ssi.clock:
            if row.is_valid("below_hz") and share_codes(clock.part, row.part):
                _check_cable_clock(row, clock.part, report)


def _check_cable_clock(row: LocatedPart[CableLength], clock: Clock, report: DocumentReport) -> None:
    """Report a clock limit for cables that is outside the limits of a clock."""
    below_hz = row.part.below_hz
    lowest_hz = clock.min_hz or 0
    highest_hz = clock.max_hz
    is_too_low = below_hz < lowest_hz
    is_too_high = highest_hz is not None and below_hz > highest_hz
    place = "interfaces.ssi.clock.max_hz" if is_too_high else "interfaces.ssi.clock.min_hz"
    if has_erratum_at(report.document, place) or not (is_too_low or is_too_high):
        return
    if is_too_high:
        message = f"{below_hz} Hz is above 'max_hz: {highest_hz}'"
    else:
        message = (
            f"no clock is below {below_hz} Hz for cables shorter than {row.part.shorter_than_m} m: the clock is"
            f" {lowest_hz} to {highest_hz} Hz"
        )
    remedy = "correct one of the two. If this is what the manual says, add an erratum that affects"
    report.add("clock-range", (*row.path, "below_hz"), f"{message}; {remedy} {place}")


def check_timeouts_and_clocks(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a BiSS timeout is longer than half a period of the slowest clock.

    If the timeout follows the clock, also check that each printed timeout is a whole number of half periods, apart from
    rounding to nanoseconds.
    """
    biss = spec.interfaces.biss
    if biss is None:
        return
    for timeout in biss.timeout:
        if has_erratum_at(report.document, *_PATH_OF_TIMEOUT, "printed"):
            continue
        remedy = (
            "correct one of the two. If this is what the manual says, "
            f"add an erratum that affects {_PATH_OF_PRINTED_TIMEOUTS}"
        )
        _check_longest_timeout(biss, timeout, remedy, report)
        if timeout.part.rule == "follows_clock" and timeout.part.half_clock_periods is None:
            _check_half_periods(timeout, remedy, report)


def _check_half_periods(timeout: LocatedPart[Timeout], remedy: str, report: DocumentReport) -> None:
    """Report each timeout in the manual that is not a whole number of half clock periods."""
    for index, printed in enumerate(timeout.part.printed):
        half_periods = 2 * printed.clock_hz * printed.timeout_ns / _NS_PER_S
        rounding = printed.clock_hz / _NS_PER_S  # Half a nanosecond, in half periods.
        nearest_whole = round(half_periods)
        is_whole = abs(half_periods - nearest_whole) <= rounding
        if not is_whole or nearest_whole < 1:
            message = (
                f"{printed.timeout_ns} ns are {half_periods:.3g} half periods at {printed.clock_hz} Hz, but a timeout"
                f" that follows the clock is a whole number of them; {remedy}"
            )
            report.add("timeout-mismatch", (*timeout.path, "printed", index, "timeout_ns"), message)


def _check_longest_timeout(
    biss: WrittenBiss, timeout: LocatedPart[Timeout], remedy: str, report: DocumentReport
) -> None:
    """Report a longest timeout that is shorter than half a period of the slowest clock of the same order codes."""
    longest_ns = timeout.part.at_most_ns
    for clock in biss.clock:
        lowest_hz = clock.part.min_hz
        if not longest_ns or not lowest_hz or not share_codes(clock.part, timeout.part):
            continue
        # Half a period of the clock lasts _NS_PER_S / (2 * lowest_hz).
        is_shorter_than_half_period = 2 * lowest_hz * longest_ns < _NS_PER_S
        if is_shorter_than_half_period:
            message = (
                f"{longest_ns} ns is shorter than half a period of the slowest clock, 'min_hz: {lowest_hz}', so it"
                f" would end within a frame; {remedy}"
            )
            report.add("timeout-mismatch", (*timeout.path, "at_most_ns"), message)


def check_timeout_mismatch(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the timeouts of BiSS that the manual prints match its rule, and are for possible clocks."""
    biss = spec.interfaces.biss
    if biss is None:
        return
    for timeout in biss.timeout:
        if not timeout.is_given:
            continue
        _check_timeout_rule(timeout, report)
        for clock in biss.clock:
            if share_codes(clock.part, timeout.part):
                _check_clocks_of_timeouts(timeout, clock.part, report)
        if timeout.part.rule != "fixed" and timeout.part.half_clock_periods is not None:
            _check_calculated_timeouts(timeout, timeout.part.half_clock_periods, report)


def _check_clocks_of_timeouts(timeout: LocatedPart[Timeout], clock: Clock, report: DocumentReport) -> None:
    """Report timeouts that the manual prints for clocks outside the limits of ``clock``."""
    if clock.max_hz is None or has_erratum_at(report.document, *_PATH_OF_TIMEOUT):
        return
    lowest_hz = clock.min_hz or 0
    highest_hz = clock.max_hz
    for index, printed in enumerate(timeout.part.printed):
        if not lowest_hz <= printed.clock_hz <= highest_hz:
            problem = f"the clock is {lowest_hz} to {highest_hz} Hz, so there is no timeout at {printed.clock_hz} Hz"
            remedy = f"if the manual gives both, add an erratum that affects {'.'.join(_PATH_OF_TIMEOUT)}"
            path = (*timeout.path, "printed", index, "clock_hz")
            report.add("timeout-mismatch", path, f"{problem}; {remedy}")


def _check_timeout_rule(timeout: LocatedPart[Timeout], report: DocumentReport) -> None:
    """Check that a timeout has the numbers for its rule: a time if it is fixed, or a number of half clock periods.

    A timeout that follows the clock may also have a time or printed examples instead of half clock periods.
    """
    part = timeout.part
    has_half_periods = part.half_clock_periods is not None
    has_limit = part.at_most_ns is not None or part.typical_ns is not None
    if part.rule == "fixed":
        if has_half_periods:
            message = "a fixed timeout does not depend on the clock; remove 'half_clock_periods'"
            report.add("timeout-mismatch", (*timeout.path, "half_clock_periods"), message, at_key=True)
        if not has_limit:
            message = "a fixed timeout needs 'at_most_ns' or 'typical_ns'"
            report.add("timeout-mismatch", timeout.path, message, at_key=True)
    elif part.rule == "follows_clock" and not has_half_periods and not has_limit and not part.printed:
        message = (
            "a timeout that depends on the clock needs 'half_clock_periods', "
            "or 'typical_ns', 'at_most_ns' or 'printed' if there is no rule"
        )
        report.add("timeout-mismatch", timeout.path, message, at_key=True)


def _check_calculated_timeouts(timeout: LocatedPart[Timeout], half_periods: int, report: DocumentReport) -> None:
    """Check that each printed timeout is this number of half clock periods, rounded to the nearest nanosecond."""
    for index, printed in enumerate(timeout.part.printed):
        clock_hz = printed.clock_hz
        printed_ns = printed.timeout_ns
        # Half a period of the clock is 10**9 / (2 * clock_hz) ns.
        exact_ns = Fraction(half_periods * 10**9, 2 * clock_hz)
        if abs(exact_ns - printed_ns) > Fraction(1, 2):
            rounded_ns = math.floor(exact_ns + Fraction(1, 2))
            message = f"{half_periods} half periods at {clock_hz} Hz are {rounded_ns} ns, not {printed_ns}"
            report.add("timeout-mismatch", (*timeout.path, "printed", index, "timeout_ns"), message)
