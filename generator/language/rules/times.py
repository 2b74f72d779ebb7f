"""Rules for times: timings, the timeout of BiSS, intervals, and times in texts and errata."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise

from ...model import Timing
from ...model.interface_parts import Clock, Timeout
from ...say.text import nanoseconds
from ..keys_of_fields import WrittenRegister
from ..keys_of_order_codes import WrittenBiss
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, Path, join_words, quoted
from ..written import LocatedPart
from .parts import PlacedPart, by_name, interfaces, is_explained_at, share_order_codes, timings
from .walk import ErratumTargets, is_derived, leaves

_NS_PER_S = 1_000_000_000
#: Nanoseconds by the ends of keys and by the units in texts.
_NANOSECONDS_PER_UNIT = {"ns": 1, "us": 1000, "µs": 1000, "ms": 1_000_000, "s": 1_000_000_000}
#: A time such as ``20 µs``, but not a rate such as ``1 ms/m``.
_TIME_PATTERN = r"(?<![\w.,])(?P<number>\d+(?:,\d{3})*(?:\.\d+)?) ?(?P<unit>ns|us|µs|ms|s(?:econds?)?)\b(?!/)"
_ANY_TIME = re.compile(_TIME_PATTERN)
#: A time that the reader or the encoder must keep.
_TIME_TO_KEEP = re.compile(
    rf"\b(?:[Ww]ait|[Pp]ause|[Ww]ithin|[Aa]t least|[Aa]t most)\w*\b[^.;:,]{{0,40}}?{_TIME_PATTERN}"
)
_KEYS_WITHOUT_PROSE = frozenset(("source", "bytes", "bits", "name", "address"))


def check_repeated_times(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the times in texts and errata are those of the facts that they describe.

    A text is compared with the times next to it, or otherwise with those of its register, procedure, timing or input.
    An erratum is compared with the facts that it affects. Both may also repeat one of the ``timings``, or a time of
    another part. Overlays and older editions change times without changing every text, so their specs are not checked.
    """
    if is_derived(report.document):
        return
    named_times: set[int] = set()  # The times under ``timings``, in nanoseconds as all times here.
    for timing in timings(spec):
        named_times |= set(_nanoseconds_in(dict(timing.data)))
    timed_parts: list[PlacedPart] = [*spec.registers, *spec.procedures, *spec.timings, *spec.inputs]
    own_times_of_parts = [set(_nanoseconds_in(part.data)) for part in timed_parts]
    # The number of parts in which a time occurs, to distinguish a time of another part from the part's own.
    part_count_by_time: Counter[int | Decimal] = Counter()
    for own_times in own_times_of_parts:
        part_count_by_time.update(own_times)
    for part, own_times in zip(timed_parts, own_times_of_parts, strict=True):
        other_times = _TimesElsewhere(
            named_times=named_times, part_count_by_time=part_count_by_time, own_times=own_times
        )
        for path, text, nearby_times in _texts_with_nearby_times(part.data, part.path):
            expected_times = nearby_times or own_times
            _compare_times(text, expected_times, other_times, path=path, report=report)
    for _, interface in interfaces(spec):
        other_times = _TimesElsewhere(named_times=named_times, part_count_by_time=part_count_by_time, own_times=set())
        for path, text, nearby_times in _texts_with_nearby_times(interface.data, interface.path):
            _compare_times(text, nearby_times, other_times, path=path, report=report)
    _compare_times_of_errata(spec, named_times, report)
    _compare_times_of_symbols(spec, report)


def _compare_times_of_symbols(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report each timing whose meaning gives its symbol another time, as in ``tw > 20 µs``, than its own bounds."""
    for timing in timings(spec):
        if not timing.part.symbol:
            continue
        bounds = set(_nanoseconds_in(timing.data))
        symbol_with_time = rf"\b{re.escape(timing.part.symbol)} ?[<>=≤≥] ?{_TIME_PATTERN}"
        time_matches = list(re.finditer(symbol_with_time, timing.part.meaning))
        times_in_meaning = set(map(_to_nanoseconds, time_matches))
        if time_matches and bounds.isdisjoint(times_in_meaning):
            _report_time(time_matches[0], bounds, path=(*timing.path, "meaning"), report=report)


def _compare_times_of_errata(spec: WrittenSpec, named_times: set[int], report: DocumentReport) -> None:
    """Report each erratum with times in ``used``, its text about what applies, if none of them is in an affected fact.

    One of the ``named_times`` is accepted too, unless the erratum affects exactly one timing.
    """
    erratum_targets = ErratumTargets(spec.data)
    cached_times = _CachedTimes()
    for erratum in spec.errata:
        time_matches = list(_ANY_TIME.finditer(erratum.used))
        if not time_matches:
            continue
        used_times = set(map(_to_nanoseconds, time_matches))
        affected_facts: list[object] = []
        for affected_path in dict.fromkeys(erratum.affects):
            affected_facts += erratum_targets.values_at(affected_path)
        affected_times: set[int] = set()
        for fact in affected_facts:
            affected_times |= cached_times.times_in(fact)
        affected_timings = [fact for fact in affected_facts if _is_timing(fact)]
        times_of_only_timing = cached_times.times_in(affected_timings[0]) if len(affected_timings) == 1 else set()
        if affected_times and used_times.isdisjoint(affected_times | named_times):
            _report_time(time_matches[0], affected_times, path=erratum.path_of("used"), report=report)
        elif times_of_only_timing and used_times.isdisjoint(times_of_only_timing):
            _report_time(time_matches[0], times_of_only_timing, path=erratum.path_of("used"), report=report)


class _CachedTimes:
    """The times in parts of a spec, which are cached because many errata may affect the same part."""

    def __init__(self) -> None:
        self._times_by_node_id: dict[int, set[int]] = {}

    def times_in(self, node: object) -> set[int]:
        """Return all times in a part of a spec, in nanoseconds."""
        if id(node) not in self._times_by_node_id:
            self._times_by_node_id[id(node)] = set(_nanoseconds_in(node))
        return self._times_by_node_id[id(node)]


#: Keys of timings and of the timeout of BiSS.
_KEYS_OF_TIMINGS = frozenset(("at_least_us", "typical_us", "at_most_us", "at_most_ns", "typical_ns"))


def _is_timing(fact: object) -> bool:
    return isinstance(fact, dict) and not _KEYS_OF_TIMINGS.isdisjoint(fact)


@dataclass(frozen=True, slots=True)
class _TimesElsewhere:
    """The times of a spec outside one part: the named times in ``timings``, and the times of other parts.

    ``part_count_by_time`` contains the number of parts with each time, and ``own_times`` the times of the one part.
    """

    named_times: Set[int]
    part_count_by_time: Mapping[int | Decimal, int]
    own_times: Set[int]

    def contains(self, time: Decimal) -> bool:
        """Return True if a time is one of the named times, or occurs in another part."""
        other_part_count = self.part_count_by_time.get(time, 0)
        if time in self.own_times:
            other_part_count -= 1
        return time in self.named_times or other_part_count > 0


def _compare_times(
    text: str, expected_times: set[int], other_times: _TimesElsewhere, *, path: Path, report: DocumentReport
) -> None:
    """Report the first time in a text that is neither one of the expected times nor elsewhere in the spec.

    Without expected times, nothing is reported.
    """
    if not expected_times:
        return
    for match in _TIME_TO_KEEP.finditer(text):
        stated_time = _to_nanoseconds(match)
        if stated_time not in expected_times and not other_times.contains(stated_time):
            _report_time(match, expected_times, path=path, report=report)
            return


def _report_time(match: re.Match[str], expected_times: set[int], path: Path, report: DocumentReport) -> None:
    """Report a time in a text that is not one of the expected times. ``match`` has its groups number and unit."""
    times_text = join_words([nanoseconds(time) for time in sorted(expected_times)], "or")
    number, unit = match.group("number", "unit")
    message = (
        f"the text says {number} {unit}, but the time here is {times_text}; "
        "correct one of the two, or add the time to 'timings'"
    )
    report.add("time-repeated", path, message)


def _to_nanoseconds(match: re.Match[str]) -> Decimal:
    """Return the time that a match of ``_TIME_PATTERN`` found, in nanoseconds."""
    number = Decimal(match["number"].replace(",", ""))
    # A unit without an entry is ``second`` or ``seconds``.
    nanoseconds_per_unit = _NANOSECONDS_PER_UNIT.get(match["unit"], _NANOSECONDS_PER_UNIT["s"])
    return number * nanoseconds_per_unit


def _nanoseconds_in(node: object) -> Iterator[int]:
    """Yield every time in a part of a spec, in nanoseconds: whole numbers under keys such as ``wait_ms``."""
    for path, value in leaves(node):
        key = str(path[-1]) if path else ""
        _, _, unit = key.rpartition("_")  # ``ms`` of ``wait_ms``.
        if unit in _NANOSECONDS_PER_UNIT and isinstance(value, int):
            yield value * _NANOSECONDS_PER_UNIT[unit]


def _texts_with_nearby_times(node: object, path: Path) -> Iterator[tuple[Path, str, set[int]]]:
    """Yield every text in a part of a spec, with its path and the times in the same map."""
    if isinstance(node, dict):
        numbers_by_key = {key: value for key, value in node.items() if isinstance(value, int)}
        nearby_times = set(_nanoseconds_in(numbers_by_key))
        for key, value in node.items():
            if isinstance(value, str) and key not in _KEYS_WITHOUT_PROSE:
                yield (*path, key), value, nearby_times
            else:
                yield from _texts_with_nearby_times(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _texts_with_nearby_times(value, (*path, index))


def check_repeated_waits(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a timing about writes to a register has the same wait as this register.

    The register is recognized by its name in the manual, or by its own name: "Command" for ``command``.
    """
    waiting_register_by_name: dict[str, WrittenRegister] = {}  # By their names in texts.
    for register in by_name(spec.registers).values():
        if register.wait_at_least_ms is not None:
            waiting_register_by_name[register.name.replace("_", " ").capitalize()] = register
            waiting_register_by_name[register.printed_name] = register
    for _, interface in interfaces(spec):
        for timing in interface.timings:
            _compare_wait_with_register(timing, waiting_register_by_name, report)


def _compare_wait_with_register(
    timing: LocatedPart[Timing], waiting_register_by_name: Mapping[str, WrittenRegister], report: DocumentReport
) -> None:
    """Check that a timing whose meaning says ``write to the … register`` has the wait of this register.

    ``waiting_register_by_name`` contains the registers that need a wait after a write, by their names in the manual.
    """
    match = re.search(r"\bwrite to the (.+?) register\b", timing.part.meaning)
    if match is None:
        return
    printed_name = match[1].strip('"')
    register = waiting_register_by_name.get(printed_name)
    wait_us = timing.part.at_least_us
    if register is None or register.wait_at_least_ms is None or wait_us is None:
        return
    wait_of_register_us = register.wait_at_least_ms * 1000
    if wait_us != wait_of_register_us:
        message = (
            f"'at_least_us' is {wait_us}, but 'wait_at_least_ms' of {quoted(register.name)} "
            f"is {register.wait_at_least_ms}; correct one of the two"
        )
        report.add("left-behind", (*timing.path, "at_least_us"), message)


def check_timing_bounds(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a timing has a lowest, a typical or a highest value, and that these are in ascending order."""
    for timing in timings(spec):
        times_by_key = {  # In ascending order.
            "at_least_us": timing.part.at_least_us,
            "typical_us": timing.part.typical_us,
            "at_most_us": timing.part.at_most_us,
        }
        stated_times = [(key, time_us) for key, time_us in times_by_key.items() if time_us is not None]
        if not stated_times:
            message = "a timing needs 'at_least_us', 'typical_us' or 'at_most_us'"
            report.add("timing-without-bound", timing.path, message)
        for (lower_key, lower_us), (higher_key, higher_us) in pairwise(stated_times):
            if lower_us > higher_us:
                message = f"{quoted(higher_key)} ({higher_us}) is less than {quoted(lower_key)} ({lower_us})"
                report.add("timing-order", (*timing.path, higher_key), message)


def check_intervals(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the interval between the requests of a step is a shortest time in ``timings`` of RS-485.

    Nothing is checked if ``timings`` contains no shortest time.
    """
    rs485 = spec.interfaces.rs485
    shortest_times_us = {timing.part.at_least_us for timing in rs485.timings} if rs485 is not None else set()
    known_times_us = sorted(time_us for time_us in shortest_times_us if time_us is not None)
    if not known_times_us:
        return
    known_text = join_words([f"{time_us} µs" for time_us in known_times_us], "or")
    for procedure in spec.procedures:
        for step in procedure.steps:
            interval_us = step.every_at_least_us
            if interval_us is not None and interval_us not in known_times_us:
                message = (
                    f"the interval is {interval_us} µs, but the shortest time in 'timings' of rs485 is {known_text};"
                    " correct one of the two, or add the interval to 'timings'"
                )
                report.add("time-repeated", step.path_of("every_at_least_us"), message)


#: Place of the timeouts of BiSS, and the path of their printed values in errata.
_PATH_OF_TIMEOUT = ("interfaces", "biss", "timeout")
_PATH_OF_PRINTED_TIMEOUTS = ".".join((*_PATH_OF_TIMEOUT, "printed"))


def check_timeouts_and_clocks(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a BiSS timeout is longer than half a period of the slowest clock.

    If the timeout follows the clock, also check that each printed timeout is a whole number of half periods, apart from
    rounding to nanoseconds.
    """
    biss = spec.interfaces.biss
    if biss is None:
        return
    for timeout in biss.timeout:
        if is_explained_at(report.document, *_PATH_OF_TIMEOUT, "printed"):
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
        half_periods_per_ns = 2 * printed.clock_hz / _NS_PER_S
        half_periods = 2 * printed.clock_hz * printed.timeout_ns / _NS_PER_S
        rounding = 0.5 * half_periods_per_ns  # A printed time is rounded by at most half a nanosecond.
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
        half_period_ns = Fraction(_NS_PER_S, 2 * lowest_hz)
        if longest_ns < half_period_ns:
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
    if clock.max_hz is None or is_explained_at(report.document, *_PATH_OF_TIMEOUT):
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
        # Half a period of the clock is _NS_PER_S / (2 * clock_hz) ns.
        exact_ns = Fraction(half_periods * _NS_PER_S, 2 * clock_hz)
        if abs(exact_ns - printed_ns) > Fraction(1, 2):
            rounded_ns = math.floor(exact_ns + Fraction(1, 2))
            message = f"{half_periods} half periods at {clock_hz} Hz are {rounded_ns} ns, not {printed_ns}"
            report.add("timeout-mismatch", (*timeout.path, "printed", index, "timeout_ns"), message)
