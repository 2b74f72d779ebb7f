"""Rules for clocks, baud rates and the serial port: limits, cables, the monoflop time, and notes about them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import combinations, pairwise
from typing import NamedTuple

from ...model import Timing
from ...model.interface_parts import CABLE_LIMITS, CableLength, Clock
from ..keys_of_order_codes import WrittenRs485, WrittenSpi, WrittenSsi
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, Path, missing_keys_message, quoted
from ..written import LocatedPart
from .parts import (
    WrittenInterface,
    as_affected_name,
    clocks_of,
    interfaces,
    is_explained_at,
    is_second_reading,
    share_order_codes,
)
from .walk import is_placeholder

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
_US_PER_S = 1_000_000
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
    # The unit that the number probably has: 10 is more likely 10 MHz, and 100 more likely 100 kHz.
    prefix, factor = ("M", 1_000_000) if rate < _LIKELY_MEGA else ("k", 1000)
    likely_rate = rate * factor
    if unit == "baud":
        # Manuals round standard rates: 115 kbaud is 115200 baud.
        standard_rates = [standard_rate for standard_rate in _STANDARD_BAUDS if standard_rate // 1000 == rate]
        likely_rate = standard_rates[0] if standard_rates else likely_rate
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
        for path, rate, unit in _rates_of_interface(interface):
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


def _rates_of_interface(interface: WrittenInterface) -> Iterator[_Rate]:
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
        for path, rate, unit in _rates_of_interface(interface):
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
    """Check that a monoflop time fits the clocks and the pauses that apply to the same order codes.

    After this time without a clock edge, the encoder ends the word.
    """
    time_us, key = _lowest_or_typical_us(timing)
    # Errata refer to a part of a list by its name: interfaces.ssi.monoflop.at_least_us.
    path_of_timings = timing.path[:-1]
    names_in_path = map(str, (*path_of_timings, _MONOFLOP, key))
    erratum_path = as_affected_name(".".join(names_in_path))
    if is_explained_at(report.document, erratum_path) or not time_us:
        return
    remedy = f"If this is what the manual says, add an erratum that affects {erratum_path}"
    for clock in ssi.clock:
        lowest_hz = clock.part.min_hz
        if not lowest_hz or not share_order_codes(clock.part, timing.part):
            continue
        half_period_us = Fraction(_US_PER_S, 2 * lowest_hz)
        if time_us < half_period_us:
            message = (
                f"{time_us} µs is shorter than half a period of the slowest clock, 'min_hz: {lowest_hz}', so it would"
                f" end within a word; correct one of the two. {remedy}"
            )
            report.add("monoflop", (*timing.path, key), message)
    _check_pauses(timing, time_us, ssi, remedy, report)


def _check_pauses(
    monoflop: LocatedPart[Timing], monoflop_us: int, ssi: WrittenSsi, remedy: str, report: DocumentReport
) -> None:
    """Report each pause between words that is shorter than the monoflop time, so that the next word comes too early.

    Only pauses for the order codes of the monoflop time are compared.
    """
    pauses = [timing for timing in ssi.timings if timing.part.name == _PAUSE]
    for pause in pauses:
        pause_us = pause.part.at_least_us
        if pause_us is None or not share_order_codes(pause.part, monoflop.part):
            continue
        if pause_us < monoflop_us:
            problem = f"the pause of {pause_us} µs is shorter than the monoflop time of {monoflop_us} µs"
            message = f"{problem}; correct one of the two"
            report.add("monoflop", (*pause.path, "at_least_us"), f"{message}. {remedy}")


def _lowest_or_typical_us(timing: LocatedPart[Timing]) -> tuple[int | None, str]:
    """Return the guaranteed shortest time of a timing in µs or, without one, the typical time, with its key.

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
    limit_hz = row.part.limit_hz
    limit_words = row.part.limit_words  # "below" or "at most"
    lowest_hz = clock.min_hz or 0
    highest_hz = clock.max_hz
    is_too_low = limit_hz < lowest_hz
    is_too_high = highest_hz is not None and limit_hz > highest_hz
    affected_path = "interfaces.ssi.clock.max_hz" if is_too_high else "interfaces.ssi.clock.min_hz"
    is_within_limits = not is_too_low and not is_too_high
    if is_within_limits or is_explained_at(report.document, affected_path):
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


def check_clock_range(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a clock has a highest limit or clocks in use, in ascending order and within the limits."""
    # Documents must not give a clock. Then the outputs say that it is not known.
    may_be_unknown = spec.evidence.part.grade == "uncorroborated"
    raw_clocks_by_path: dict[Path, LocatedPart[Clock]] = {}
    for _, raw_interface in interfaces(spec.with_invalid_parts):
        raw_clocks_by_path |= {raw_clock.path: raw_clock for raw_clock in clocks_of(raw_interface)}
    for _, interface in interfaces(spec):
        for clock in clocks_of(interface):
            if not clock.is_given:
                continue
            _check_order_of_frequencies(clock, report)
            if not may_be_unknown:
                _report_missing_limit(clock, raw_clocks_by_path.get(clock.path), report)


def _check_order_of_frequencies(located_clock: LocatedPart[Clock], report: DocumentReport) -> None:
    """Check that the lowest limit of a clock, the frequencies in use and the highest limit are in ascending order."""
    clock = located_clock.part
    used_frequencies = list(clock.used_hz)
    if used_frequencies != sorted(set(used_frequencies)):
        message = "list the clocks of 'used_hz' once each, in ascending order"
        report.add("clock-range", (*located_clock.path, "used_hz"), message)
    frequencies: list[tuple[str, int]] = []  # Each with its key.
    if clock.min_hz is not None:
        frequencies.append(("min_hz", clock.min_hz))
    frequencies += [("used_hz", frequency) for frequency in used_frequencies]
    if clock.max_hz is not None:
        frequencies.append(("max_hz", clock.max_hz))
    for (lower_key, lower_hz), (higher_key, higher_hz) in pairwise(frequencies):
        # A wrong order among the frequencies in use is already reported.
        if lower_hz > higher_hz and lower_key != higher_key:
            problem = f"{quoted(lower_key)} ({lower_hz}) is above {quoted(higher_key)} ({higher_hz})"
            report.add("clock-range", (*located_clock.path, lower_key), problem)


def _report_missing_limit(
    clock: LocatedPart[Clock], raw_clock: LocatedPart[Clock] | None, report: DocumentReport
) -> None:
    """Report a clock without a highest frequency, unless it lists frequencies in use (``used_hz``).

    ``raw_clock`` is the clock together with its invalid keys, which must not be reported as missing.
    """
    is_complete = raw_clock is not None and clock.data.keys() == raw_clock.data.keys()
    is_known = clock.part.max_hz is not None or bool(clock.part.used_hz)
    # A source that is still a placeholder marks a clock whose limits are still to be transcribed.
    if is_complete and not is_known and not is_placeholder(clock.source):
        problem = missing_keys_message(("max_hz",), "a clock")
        remedy = "if no document of the manufacturer gives the limits, write 'used_hz'"
        report.add("missing-key", clock.path, f"{problem}; {remedy}", at_key=True)


def check_cable_order(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the clock limit of SSI is lower for longer cables, and that no two rows have the same length.

    An erratum that affects the table of cable lengths explains a different order.
    """
    for name, interface in interfaces(spec):
        if not isinstance(interface, WrittenSsi):
            continue
        if is_explained_at(report.document, "interfaces", name, "cable_lengths"):
            continue
        affected_path = f"interfaces.{name}.cable_lengths"
        shortest_first = sorted(interface.cable_lengths, key=lambda row: row.part.shorter_than_m)
        for row, row_of_longer_cable in combinations(shortest_first, 2):
            if share_order_codes(row.part, row_of_longer_cable.part):
                _check_cable_order(row.part, row_of_longer_cable, affected_path=affected_path, report=report)


def _check_cable_order(
    shorter: CableLength,
    row_of_longer_cable: LocatedPart[CableLength],
    affected_path: str,
    report: DocumentReport,
) -> None:
    """Report the row of a longer cable if its clock limit is not lower than the limit of a shorter cable.

    ``affected_path`` is the path that an erratum must affect to explain it.
    """
    longer_cable = row_of_longer_cable.part
    # A row without a limit, which another rule reports, has the limit 0.
    is_slower = longer_cable.limit_hz < shorter.limit_hz or not shorter.limit_hz
    have_same_length = longer_cable.shorter_than_m == shorter.shorter_than_m
    if not is_slower or have_same_length:
        limit, limit_of_shorter = (f"{row.limit_words} {row.limit_hz} Hz" for row in (longer_cable, shorter))
        problem = (
            f"the clock must be {limit} for cables shorter than {longer_cable.shorter_than_m} m, but {limit_of_shorter}"
            f" for cables shorter than {shorter.shorter_than_m} m; a longer cable needs a slower clock. If this is what"
            f" the manual says, add an erratum that affects {affected_path}"
        )
        report.add("cable-order", (*row_of_longer_cable.path, longer_cable.limit_key), problem)


_NUMBER_WORDS = {"one": 1, "two": 2, "nine": 9, "ten": 10, "eleven": 11, "twelve": 12}
_STOP_BITS = re.compile(r"\b(one|two|[12]) stop bits?\b", re.IGNORECASE)
_CHARACTER_LENGTH = re.compile(r"\b(nine|ten|eleven|twelve|9|1[0-2]) bits\b", re.IGNORECASE)
_PARITY_IN_TEXT = re.compile(r"\b(no|even|odd) parity\b", re.IGNORECASE)


def check_serial_port(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the stop bits, parity and bits per character in the note of an RS-485 interface match its ``port``."""
    rs485 = spec.interfaces.rs485
    if rs485 is None or not rs485.port.is_given:
        return
    port = rs485.port.part
    parity_bits = 0 if port.parity == "none" else 1
    settings = [
        _SettingInText("stop_bits", _STOP_BITS, str(port.stop_bits)),
        _SettingInText("parity", _PARITY_IN_TEXT, port.parity.replace("none", "no")),
    ]
    # If the note mentions the start bit, its number of bits is the number of the whole character.
    if "start bit" in rs485.note:
        bits_of_character = 1 + port.data_bits + parity_bits + port.stop_bits
        settings.append(_SettingInText("data_bits", _CHARACTER_LENGTH, str(bits_of_character)))
    _compare_with_port(rs485, settings, report)


class _SettingInText(NamedTuple):
    """A setting of a port, the pattern of texts about it, and the number or word that they must contain."""

    key: str
    pattern: re.Pattern[str]
    expected_word: str


def _compare_with_port(rs485: WrittenRs485, settings: Iterable[_SettingInText], report: DocumentReport) -> None:
    """Report the first words in the note of an RS-485 interface that contradict a setting of its port."""
    for setting in settings:
        for word in setting.pattern.findall(rs485.note):
            plain_word = word.casefold()
            number_or_word = str(_NUMBER_WORDS.get(plain_word, plain_word))  # "2" for "Two", "even" for "even".
            if number_or_word != setting.expected_word:
                line, _ = report.document.position((*rs485.port.path, setting.key))
                requirement = f"{quoted(setting.key)} of 'port' on line {line} requires {setting.expected_word}"
                message = f"the text says {quoted(word)}, but {requirement}; correct one of the two"
                report.add("port-mismatch", rs485.path_of("note"), message)
                return
