"""Rules for clocks, baud rates and times of one interface that must agree with each other."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from ...model import Timing
from ...model.interface_parts import CABLE_LIMITS, CableLength, Clock, Timeout
from ..problems import DocumentReport, Path, quoted
from ..written import LocatedPart
from ..written_interfaces import WrittenBiss, WrittenRs485, WrittenSpi, WrittenSsi
from ..written_parts import WrittenSpec
from .parts import (
    WrittenInterface,
    as_affected_name,
    clocks_of,
    has_erratum_at,
    interfaces,
    is_second_reading,
    share_order_codes,
)

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
#: No encoder has such a low limit in Hz. The highest limits in kHz, of SPI, are still below.
_LOWEST_MAXIMUM_HZ = 50_000
#: The lowest clock in Hz of an encoder whose highest clock is plausible.
_LOWEST_MINIMUM_HZ = 1_000
#: The lowest standard baud rate. Rates in kbaud and Mbaud that do not look like one are below it.
_LOWEST_BAUD = 300
#: Below this number, a unit of MHz is more likely than kHz.
_LIKELY_MEGA = 50
#: Standard baud rates that are not whole numbers of kbaud.
_STANDARD_BAUDS = (9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 921_600)


def check_plausible_rates(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no clock or baud rate is too low for an encoder, unless the interface has a note."""
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for _, interface in interfaces(spec):
        if interface.note:
            continue
        for clock in clocks_of(interface):
            max_hz, min_hz = clock.part.max_hz, clock.part.min_hz
            if max_hz is not None and max_hz < _LOWEST_MAXIMUM_HZ:
                _report_rate(max_hz, unit="Hz", path=(*clock.path, "max_hz"), report=report)
            elif min_hz is not None and 0 < min_hz < _LOWEST_MINIMUM_HZ:
                _report_rate(min_hz, unit="Hz", path=(*clock.path, "min_hz"), report=report)
        port = interface.port if isinstance(interface, WrittenRs485) else None
        if port is not None and port.has("baud") and port.part.baud < _LOWEST_BAUD:
            _report_rate(port.part.baud, unit="baud", path=(*port.path, "baud"), report=report)


def _report_rate(rate: int, unit: str, path: Path, report: DocumentReport) -> None:
    """Report a rate that is implausibly low, with the number that is probably meant: in kHz or MHz instead of Hz."""
    rate_key = path[-1]
    prefix, factor = ("M", 1_000_000) if rate < _LIKELY_MEGA else ("k", 1000)
    likely_rate = rate * factor
    if unit == "baud":
        # Manuals round standard rates: 115 kbaud is 115200 baud.
        rounded_to_rate = [standard_rate for standard_rate in _STANDARD_BAUDS if standard_rate // 1000 == rate]
        likely_rate = rounded_to_rate[0] if rounded_to_rate else likely_rate
    problem = f"'{rate_key}' is {rate} {unit}, which is implausible; if the manual means {rate} {prefix}{unit}"
    remedy = f"write {likely_rate}. If the number is right, say so in a 'note' of the interface"
    report.add("implausible-rate", path, f"{problem}, {remedy}")


def check_round_rates(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that rates have at most three significant digits, as in data sheets.

    Slow rates and standard baud rates are accepted, and so is a rate that a note of the interface gives.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for _, interface in interfaces(spec):
        for path, rate, unit in _yield_rates(interface):
            digit_count = len(str(rate).rstrip("0"))  # 2 for 1,500,000.
            is_standard = unit == "baud" and rate % _STANDARD_BAUD == 0
            is_low = rate < _LOWEST_HZ
            is_explained = _contains_rate(interface.note, rate)
            if is_low or is_standard or is_explained:
                continue
            if digit_count > _SIGNIFICANT_DIGITS:
                message = (
                    f"{rate} {unit} has {digit_count} significant digits, which is implausible; correct it, or say in a"
                    f" 'note' of the interface that it is {rate} {unit}"
                )
                report.add("implausible-rate", path, message)


def _contains_rate(note: str, rate: int) -> bool:
    """Return True if a note contains the digits of a rate, with or without commas."""
    return str(rate) in note.replace(",", "")


class _Rate(NamedTuple):
    """A clock limit in Hz or a baud rate, with its path."""

    path: Path
    number: int
    unit: str


def _yield_rates(interface: WrittenInterface) -> Iterator[_Rate]:
    """Yield the clock limits of an interface, including those for cable lengths, or its baud rate.

    ``port``, ``clock`` and each row of the cable lengths have their path in the spec, and their values as ``part``.
    """
    if isinstance(interface, WrittenRs485):
        serial_port = interface.port
        if serial_port.is_valid("baud"):
            baud = serial_port.part.baud
            yield _Rate((*serial_port.path, "baud"), baud, unit="baud")
        return
    for clock in interface.clock:
        limits = clock.part
        for key, limit_hz in (("min_hz", limits.min_hz), ("max_hz", limits.max_hz)):
            if limit_hz is not None:
                yield _Rate((*clock.path, key), limit_hz, unit="Hz")
    if isinstance(interface, WrittenSsi):
        for row in interface.cable_lengths:
            yield _Rate((*row.path, row.part.limit_key), row.part.limit_hz, unit="Hz")


def check_rates_of_lines(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no clock or baud rate over RS-422 or RS-485 is above 10 MHz, unless a note of the interface gives it.

    An interface has such lines if it is RS-485 or its ``signals`` name them. Another rule checks clocks for cables.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for _, interface in interfaces(spec):
        if isinstance(interface, WrittenSpi):
            continue
        has_rs_lines = isinstance(interface, WrittenRs485) or _RS_LINES.search(interface.signals) is not None
        if not has_rs_lines:
            continue
        for path, rate, unit in _yield_rates(interface):
            is_for_cables = path[-1] in CABLE_LIMITS
            is_explained = _contains_rate(interface.note, rate)
            if rate > _HIGHEST_HZ and not is_for_cables and not is_explained:
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
    path_of_timings = timing.path[:-1]
    names_in_path = map(str, (*path_of_timings, _MONOFLOP, key))
    affected_path = as_affected_name(".".join(names_in_path))
    if has_erratum_at(report.document, affected_path) or not time_us:
        return
    remedy = f"If this is what the manual says, add an erratum that affects {affected_path}"
    for clock in ssi.clock:
        lowest_hz = clock.part.min_hz
        if not lowest_hz or not share_order_codes(clock.part, timing.part):
            continue
        # Half a period of the clock lasts _NS_PER_S / (2 * lowest_hz).
        is_shorter_than_half_period = 2 * lowest_hz * time_us * _NS_PER_US < _NS_PER_S
        if is_shorter_than_half_period:
            message = (
                f"{time_us} µs is shorter than half a period of the slowest clock, 'min_hz: {lowest_hz}', so it would"
                f" end within a word; correct one of the two. {remedy}"
            )
            report.add("monoflop", (*timing.path, key), message)
    pauses = [other_timing for other_timing in ssi.timings if other_timing.part.name == _PAUSE]
    for pause in pauses:
        pause_us = pause.part.at_least_us
        if pause_us is None or not share_order_codes(pause.part, timing.part):
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
    if timing.part.at_least_us is not None:
        return timing.part.at_least_us, "at_least_us"
    if timing.part.typical_us is not None:
        return timing.part.typical_us, "typical_us"
    return None, ""


def check_cable_clocks(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each clock limit for cables is within the limits of the clock, unless an erratum explains it.

    A row must have one limit, of the same kind as all other rows.
    """
    ssi = spec.interfaces.ssi
    if ssi is None:
        return
    for row in ssi.cable_lengths:
        _check_kind_of_limit(row, ssi.cable_lengths[0].part.limit_key, report)
        for clock in ssi.clock:
            if row.is_valid(row.part.limit_key) and share_order_codes(clock.part, row.part):
                _check_cable_clock(row, clock.part, report)


def _check_kind_of_limit(row: LocatedPart[CableLength], key_of_first_row: str, report: DocumentReport) -> None:
    """Report a row of the table of cable lengths that has both limits, none, or another one than the first row."""
    has_limit = any(map(row.has, CABLE_LIMITS))
    if has_limit and row.part.limit_key != key_of_first_row:
        problem = f"the first row has {quoted(key_of_first_row)}; write the same kind of limit in all rows"
        report.add("cable-limit", (*row.path, row.part.limit_key), problem, at_key=True)
    elif row.has("below_hz") and row.has("at_most_hz"):
        problem = "'below_hz' and 'at_most_hz' exclude each other; keep the one that the manual gives"
        report.add("cable-limit", (*row.path, "at_most_hz"), problem, at_key=True)
    elif not has_limit:
        problem = "the row has no clock limit; add 'below_hz', or 'at_most_hz' if the clock may be equal to it"
        report.add("cable-limit", row.path, problem)


def _check_cable_clock(row: LocatedPart[CableLength], clock: Clock, report: DocumentReport) -> None:
    """Report a clock limit for cables that is outside the limits of a clock."""
    limit_hz, limit_words = row.part.limit_hz, row.part.limit_words
    lowest_hz = clock.min_hz or 0
    highest_hz = clock.max_hz
    is_too_low = limit_hz < lowest_hz
    is_too_high = highest_hz is not None and limit_hz > highest_hz
    affected_path = "interfaces.ssi.clock.max_hz" if is_too_high else "interfaces.ssi.clock.min_hz"
    is_within_limits = not is_too_low and not is_too_high
    if is_within_limits or has_erratum_at(report.document, affected_path):
        return
    if is_too_high:
        message = f"{limit_hz} Hz is above 'max_hz: {highest_hz}'"
    else:
        message = (
            f"no clock is {limit_words} {limit_hz} Hz for cables shorter than {row.part.shorter_than_m} m: the clock is"
            f" {lowest_hz} to {highest_hz} Hz"
        )
    remedy = "correct one of the two. If this is what the manual says, add an erratum that affects"
    report.add("clock-range", (*row.path, row.part.limit_key), f"{message}; {remedy} {affected_path}")


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
        follows_clock = timeout.part.rule == "follows_clock"
        if follows_clock and timeout.part.half_clock_periods is None:
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
    clocks = [clock.part for clock in biss.clock if share_order_codes(clock.part, timeout.part)]
    for clock in clocks:
        lowest_hz = clock.min_hz
        if not longest_ns or not lowest_hz:
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
            if share_order_codes(clock.part, timeout.part):
                _check_clocks_of_timeouts(timeout, clock.part, report)
        half_periods = timeout.part.half_clock_periods
        if timeout.part.rule != "fixed" and half_periods is not None:
            _check_calculated_timeouts(timeout, half_periods, report)


def _check_clocks_of_timeouts(timeout: LocatedPart[Timeout], clock: Clock, report: DocumentReport) -> None:
    """Report timeouts that the manual prints for clocks outside the limits of ``clock``."""
    if clock.max_hz is None or has_erratum_at(report.document, *_PATH_OF_TIMEOUT):
        return
    lowest_hz = clock.min_hz or 0
    highest_hz = clock.max_hz
    for index, printed in enumerate(timeout.part.printed):
        if not lowest_hz <= printed.clock_hz <= highest_hz:
            problem = f"the clock is {lowest_hz} to {highest_hz} Hz, so there is no timeout at {printed.clock_hz} Hz"
            affected_path = ".".join(_PATH_OF_TIMEOUT)
            remedy = f"if the manual gives both, add an erratum that affects {affected_path}"
            path = (*timeout.path, "printed", index, "clock_hz")
            report.add("timeout-mismatch", path, f"{problem}; {remedy}")


def _check_timeout_rule(located_timeout: LocatedPart[Timeout], report: DocumentReport) -> None:
    """Check that a timeout has the numbers for its rule: a time if it is fixed, or a number of half clock periods.

    A timeout that follows the clock may also have a time or printed examples instead of half clock periods.
    """
    timeout = located_timeout.part
    path = located_timeout.path
    has_half_periods = timeout.half_clock_periods is not None
    has_time = timeout.at_most_ns is not None or timeout.typical_ns is not None
    has_time_or_example = has_time or bool(timeout.printed)
    if timeout.rule == "fixed":
        if has_half_periods:
            message = "a fixed timeout does not depend on the clock; remove 'half_clock_periods'"
            report.add("timeout-mismatch", (*path, "half_clock_periods"), message, at_key=True)
        if not has_time:
            message = "a fixed timeout needs 'at_most_ns' or 'typical_ns'"
            report.add("timeout-mismatch", path, message, at_key=True)
    elif timeout.rule == "follows_clock" and not has_half_periods and not has_time_or_example:
        message = (
            "a timeout that depends on the clock needs 'half_clock_periods', "
            "or 'typical_ns', 'at_most_ns' or 'printed' if there is no rule"
        )
        report.add("timeout-mismatch", path, message, at_key=True)


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
