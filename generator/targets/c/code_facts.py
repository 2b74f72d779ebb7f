"""Facts in C that depend on the order code: clock, timeout, times and clocks by cable length, as macros by code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from ...language.problems import join_words
from ...model import (
    Biss,
    CableLength,
    Clock,
    Clocked,
    Interface,
    Ssi,
    Timeout,
    Timing,
    cite,
)
from ...model.order_codes import facts_for_code, repeated_names
from ...model.record import dataclass
from ...say.order_code import describe_timing as say_timing
from .comments import HEADER_STYLE
from .context import HeaderContext
from .names import CMacro, DeclaredName, c_number
from .variants import CodeRow


def timing_macros(timing: Timing, stem: str) -> Iterator[CMacro]:
    """Yield a macro for each bound of a time that the manual gives, in microseconds: ``ACME_X_STARTUP_AT_MOST_US``.

    The comment on the first macro describes the time, and the comments on the others refer to it.
    """
    note = HEADER_STYLE.sentence(say_timing(timing))
    bounds = {"AT_LEAST": timing.at_least_us, "TYPICAL": timing.typical_us, "AT_MOST": timing.at_most_us}
    for bound, value in bounds.items():
        if value is not None:
            yield CMacro(f"{stem}_{timing.name}_{bound}_US".upper(), value=c_number(value), note=note)
            note = f"see {timing.name} above"


def clock_limits(clock: Clock) -> Iterator[tuple[str, int, str]]:
    """Yield the numbers that the manual gives for a clock: the end of a macro's name, the clock in Hz, and a comment.

    They are the lowest and the highest clock, and the fastest clock in use. Numbers that it does not give are left out.
    """
    names_clocks_and_notes = (
        ("CLOCK_MIN_HZ", clock.min_hz, "lowest clock in Hz"),
        ("CLOCK_MAX_HZ", clock.max_hz, "highest clock in Hz"),
        ("CLOCK_USED_HZ", max(clock.used_hz, default=None), "a clock in use in Hz, not a limit"),
    )
    for name, clock_hz, note in names_clocks_and_notes:
        if clock_hz is not None:
            yield name, clock_hz, note


def timeout_limits(timeout: Timeout) -> Iterator[tuple[str, int]]:
    """Yield the typical and the longest timeout: the end of a macro's name, and the timeout in nanoseconds.

    If the manual does not give the timeout as a number of clock periods, the timeouts printed for each clock follow.
    """
    names_and_times = [("TYPICAL", timeout.typical_ns), ("AT_MOST", timeout.at_most_ns)]
    if timeout.half_clock_periods is None:
        names_and_times += [(f"AT_{printed.clock_hz}_HZ", printed.timeout_ns) for printed in timeout.printed]
    for name, time_ns in names_and_times:
        if time_ns is not None:
            yield f"TIMEOUT_{name}_NS", time_ns


def timeout_product(timeout: Timeout | None) -> int:
    """Return the number that divided by the clock in hertz gives the timeout in nanoseconds.

    The result is 0 if there is no timeout or if it does not follow the clock.
    """
    if timeout is None or timeout.rule != "follows_clock":
        return 0
    half_clock_periods = timeout.half_clock_periods or 0
    # Half a clock period in nanoseconds is 500,000,000 divided by the clock in hertz.
    return 500_000_000 * half_clock_periods


@dataclass(frozen=True, slots=True)
class ClockLimitFunction:
    """Function that returns the clock limit for a cable length."""

    name: str
    cable_rows: tuple[CableLength, ...]

    @property
    def source(self) -> str:
        """The source of the clocks by cable length."""
        return cite(tuple(dict.fromkeys(chain.from_iterable(row.source for row in self.cable_rows))))


@dataclass(frozen=True, slots=True)
class TimeoutFunction:
    """Function that returns the timeout in nanoseconds for a clock in hertz: ``product`` divided by the clock."""

    name: str
    product: int


def function_names(clock_limits: Sequence[ClockLimitFunction], timeouts: Sequence[TimeoutFunction]) -> list[str]:
    """Return the names of functions for clock limits and timeouts."""
    return [*(limit.name for limit in clock_limits), *(timeout.name for timeout in timeouts)]


class CodeFacts:
    """Macros and functions for the facts about the interface that differ between order codes, such as the clock.

    They are empty if all order codes have the same facts. Order codes with the same clocks by cable length, or the same
    rule for the timeout, share a function. Each of them has a macro that names the function.
    """

    def __init__(self, context: HeaderContext, interface: Interface, code_rows: Sequence[CodeRow]) -> None:
        self._context = context
        self._interface = interface
        self.clock_limits: list[ClockLimitFunction] = []
        self.timeouts: list[TimeoutFunction] = []
        self._times = [*_repeated_times(interface.timings), *_repeated_times(context.device.timings)]
        self.macros = list(chain.from_iterable(map(self._macros_of, code_rows)))

    @property
    def facts_in_words(self) -> str:
        """The facts that depend on the order code, for the comment on the macros, such as ``clock and times``."""
        subjects = {
            "clock": isinstance(self._interface, Clocked) and bool(self._interface.clocks_by_code),
            "timeout": isinstance(self._interface, Biss) and bool(self._interface.timeouts_by_code),
            "clock limit by cable length": bool(self.clock_limits),
            "times": bool(self._times),
        }
        return join_words(subject for subject, depends_on_code in subjects.items() if depends_on_code)

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of its macros and functions at file scope, each with the path of the interface."""
        path = ("interfaces", self._interface.name)
        yield from ((macro.name, path) for macro in self.macros)
        yield from ((name, path) for name in function_names(self.clock_limits, self.timeouts))

    def _macros_of(self, row: CodeRow) -> Iterator[CMacro]:
        """Yield the macros of an order code, such as ``ACME_X_24_A_CLOCK_MAX_HZ``."""
        interface = self._interface
        code = row.variant.code
        if isinstance(interface, Clocked) and interface.clocks_by_code:
            for name, clock_hz, note in clock_limits(interface.clock_of(code)):
                yield CMacro(f"{row.macro}_{name}", value=c_number(clock_hz), note=note)
        if isinstance(interface, Biss) and interface.timeouts_by_code:
            yield from self._timeout_macros(row, interface.timeout_of(code))
        if isinstance(interface, Ssi) and has_cables_by_code(interface):
            yield from self._clock_limit_macros(row, facts_for_code(interface.cable_lengths, code))
        for time in facts_for_code(self._times, code):
            yield from timing_macros(time, row.macro)

    def _timeout_macros(self, row: CodeRow, timeout: Timeout | None) -> Iterator[CMacro]:
        """Yield the macros of the timeout of an order code. One names a function if the clock decides the timeout."""
        if timeout is None:
            return
        for name, time_ns in timeout_limits(timeout):
            yield CMacro(f"{row.macro}_{name}", value=c_number(time_ns), note="timeout in nanoseconds")
        product = timeout_product(timeout)
        if product:
            function = self._find_or_add_timeout(product, row)
            yield CMacro(f"{row.macro}_TIMEOUT_NS", value=function.name, note="function that returns its timeout")

    def _find_or_add_timeout(self, product: int, row: CodeRow) -> TimeoutFunction:
        """Return the function for a timeout of ``product`` divided by the clock.

        If no earlier order code has it, a function named after the order code of ``row`` is added to ``timeouts``.
        """
        for function in self.timeouts:
            if function.product == product:
                return function
        new_function = TimeoutFunction(self._function_name("timeout_ns", row), product)
        self.timeouts.append(new_function)
        return new_function

    def _clock_limit_macros(self, row: CodeRow, cable_rows: tuple[CableLength, ...]) -> Iterator[CMacro]:
        """Yield the macro that names the function for the clock limit by cable length, or nothing without limits."""
        if cable_rows:
            function = self._find_or_add_clock_limit(cable_rows, row)
            yield CMacro(
                f"{row.macro}_CLOCK_LIMIT_HZ", value=function.name, note="function that returns its clock limit"
            )

    def _find_or_add_clock_limit(self, cable_rows: tuple[CableLength, ...], row: CodeRow) -> ClockLimitFunction:
        """Return the function for these clocks by cable length.

        If no earlier order code has it, a function named after the order code of ``row`` is added to ``clock_limits``.
        """
        for function in self.clock_limits:
            if function.cable_rows == cable_rows:
                return function
        new_function = ClockLimitFunction(self._function_name("clock_limit_hz", row), cable_rows)
        self.clock_limits.append(new_function)
        return new_function

    def _function_name(self, ending: str, row: CodeRow) -> str:
        """Return the name of a function, which contains the first order code that uses it: ``acme_x_24_timeout_ns``."""
        return f"{self._context.prefix}_{row.name_in_macros.lower()}_{ending}"


def _repeated_times(times: Sequence[Timing]) -> list[Timing]:
    """Return the times that share their name with others. Each of them applies to different order codes."""
    shared_names = repeated_names(times)
    return [time for time in times if time.name in shared_names]


def has_cables_by_code(interface: Ssi) -> bool:
    """Return True if the clocks by cable length depend on the order code."""
    return any(row.only for row in interface.cable_lengths)
