# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Records about the interfaces of an encoder: SSI, BiSS, SPI and RS-485, with their clocks and times."""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from .fields import NO_NAMES, NamedValue

if TYPE_CHECKING:
    pass


class Alignment(Enum):
    """Alignment of the data in an SSI word. Zeros follow left-aligned data and precede right-aligned data."""

    MSB_LEFT = "msb_left"
    LSB_RIGHT = "lsb_right"


class TimeoutRule(Enum):
    """Dependence of a timeout on the clock."""

    FOLLOWS_CLOCK = "follows_clock"
    FIXED = "fixed"


class Purpose(Enum):
    """Purpose of a request."""

    CAPTURE = "capture"
    WRITE = "write"
    READ = "read"
    RESET = "reset"


class Timing(NamedTuple):
    """Time with its bounds in microseconds.

    ``only`` lists the order codes that the time applies to, or is empty for all.
    """

    name: str
    meaning: str
    at_least_us: int | None = None
    typical_us: int | None = None
    at_most_us: int | None = None
    symbol: str = ""
    source: str = ""
    only: str = ""


class Clock(NamedTuple):
    """Clock frequencies.

    Attributes:
        min_hz: Lowest clock. None if it is not known.
        max_hz: Highest clock. None if it is not known.
        source: Source of the facts.
        used_hz: Clocks that programs or masters use, in ascending order. They are not limits.
        only: Order codes that have this clock, if not all do.
    """

    min_hz: int | None
    max_hz: int | None
    source: str = ""
    used_hz: tuple[int, ...] = ()
    only: str = ""


class CableLength(NamedTuple):
    """Clock limit for a cable: cables shorter than ``shorter_than_m`` require a clock below ``below_hz``.

    If the manual includes the limit, it is ``at_most_hz``, and ``below_hz`` is None. ``only`` lists the order codes
    that the limit applies to, or is empty for all.
    """

    shorter_than_m: int
    below_hz: int | None = None
    source: str = ""
    only: str = ""
    at_most_hz: int | None = None


class Port(NamedTuple):
    """Settings of a serial port."""

    baud: int
    data_bits: int
    parity: str
    stop_bits: int
    flow_control: str
    source: str = ""


class Network(NamedTuple):
    """Network topology of an encoder."""

    topology: str
    multiple_slaves: bool
    source: str = ""


class DataChannels(NamedTuple):
    """Data channels in one frame, and the fields in them whose highest bits must agree."""

    order: tuple[str, ...]
    compared: Mapping[str, str] = NO_NAMES
    compared_bits: str = ""
    tolerance: int = 0
    source: str = ""


class PrintedTimeout(NamedTuple):
    """Timeout given in the manual for one clock frequency."""

    clock_hz: int
    timeout_ns: int


class Timeout(NamedTuple):
    """Timeout after a frame. ``only`` lists the order codes that it applies to, or is empty for all."""

    rule: TimeoutRule
    half_clock_periods: int | None = None
    at_most_ns: int | None = None
    typical_ns: int | None = None
    printed: tuple[PrintedTimeout, ...] = ()
    source: str = ""
    only: str = ""

    def nanoseconds(self, clock_hz: int) -> float | None:
        """Return the timeout for a clock frequency.

        Args:
            clock_hz: Clock frequency in hertz.

        Returns:
            The timeout in nanoseconds, or None if the manual does not give it for this frequency. A fixed timeout is
            the typical value or, if that is unknown, the maximum.
        """
        if self.half_clock_periods is not None:
            return self.half_clock_periods * 500_000_000 / clock_hz
        if self.rule is TimeoutRule.FOLLOWS_CLOCK:
            ns_by_clock = {printed.clock_hz: printed.timeout_ns for printed in reversed(self.printed)}
            return ns_by_clock.get(clock_hz)
        return self.typical_ns if self.typical_ns is not None else self.at_most_ns


class ControlField(NamedTuple):
    """Field of the BiSS control frame. ``crc`` is the name of the CRC in the field, if it has a CRC."""

    name: str
    bits: int
    meaning: str = ""
    values: tuple[NamedValue, ...] = ()
    crc: str = ""
    printed_name: str = ""
    source: str = ""


class DataIdFacts(NamedTuple):
    """Data ID. ``control`` is the control field that is sent for it."""

    name: str
    id: int
    control: int
    purpose: Purpose
    meaning: str = ""
    source: str = ""


class MemoryAccess(NamedTuple):
    """Encoder's reply to a memory access, depending on the busy flag in the reply."""

    access: str
    busy: bool
    address: str
    data: str
    meaning: str
    source: str = ""


_Row = TypeVar("_Row", Clock, CableLength, Timeout, Timing)


def _rows_for_code(rows: tuple[_Row, ...], code: str) -> tuple[_Row, ...]:
    """Return the rows that apply to an order code.

    Their ``only`` is set to empty, because they apply without restriction.
    """
    return tuple(row._replace(only="") for row in rows if _applies_to_code(row.only, code))


def _applies_to_code(only: str, code: str) -> bool:
    """Return whether a row applies to an order code. ``only`` lists patterns of order codes, or is empty for all.

    In a pattern, ``...`` represents any text and ``x`` any one character: ``X-2x, Y...`` fits ``X-24`` and ``Y8``.
    Commas separate several patterns. The hyphen after an order code on a label counts as part of it.
    """
    if not only:
        return True
    for pattern in only.split(","):
        escaped = re.escape(pattern.strip())
        expression = escaped.replace(r"\.\.\.", ".*").replace("…", ".*").replace("x", ".")
        if re.fullmatch(expression, code) or re.fullmatch(expression, f"{code}-"):
            return True
    return False


def _clock_for_code(clock: Clock, clocks: tuple[Clock, ...], code: str) -> Clock:
    """Return the clock of an order code: the first of ``clocks`` that applies to it, or ``clock`` if none does."""
    clocks_of_code = _rows_for_code(clocks, code)
    return clocks_of_code[0] if clocks_of_code else clock


class SsiFacts(NamedTuple):
    """Facts about the SSI interface.

    If the clock depends on the order code, ``clocks`` has the clocks, and ``clock`` has no limits.
    """

    clock: Clock
    alignment: Alignment
    output_code: str = ""
    signals: str = ""
    cable_lengths: tuple[CableLength, ...] = ()
    timings: tuple[Timing, ...] = ()
    note: str = ""
    source: str = ""
    alignment_source: str = ""
    output_code_source: str = ""
    clocks: tuple[Clock, ...] = ()

    def for_code(self, code: str) -> SsiFacts:
        """Return the facts that apply to one order code, without those of other order codes.

        Args:
            code: The order code, as in the attribute ``code`` of an encoder.
        """
        return self._replace(
            # ``clocks`` are the clock limits that apply only to some order codes.
            clock=_clock_for_code(self.clock, self.clocks, code),
            clocks=(),
            cable_lengths=_rows_for_code(self.cable_lengths, code),
            timings=_rows_for_code(self.timings, code),
        )

    def clock_below_hz(self, cable_m: float) -> int | None:
        """Return the clock limit for a cable, according to the table in the manual.

        Rows that apply only to some order codes are ignored here. ``for_code`` returns the facts in which they are
        included.

        Args:
            cable_m: Length of the cable in meters.

        Returns:
            The limit in hertz. The clock must be below it, so it is one hertz more than ``at_most_hz``. None if the
            cable is too long for the table, or if there is no table.
        """
        for row in self.cable_lengths:
            applies_to_all_codes = not row.only
            if applies_to_all_codes and cable_m < row.shorter_than_m:
                return row.below_hz if row.at_most_hz is None else row.at_most_hz + 1
        return None


class BissFacts(NamedTuple):
    """Facts about the BiSS C-mode interface.

    If the clock depends on the order code, ``clocks`` has the clocks, and ``clock`` has no limits. The same
    applies to ``timeouts``, and ``timeout`` is then None.
    """

    clock: Clock
    profile: str = ""
    signals: str = ""
    network: Network | None = None
    timeout: Timeout | None = None
    control_data: tuple[ControlField, ...] = ()
    control_data_note: str = ""
    description_file: str = ""
    bank_select: str = ""
    timings: tuple[Timing, ...] = ()
    note: str = ""
    source: str = ""
    clocks: tuple[Clock, ...] = ()
    timeouts: tuple[Timeout, ...] = ()
    channels: DataChannels | None = None

    def for_code(self, code: str) -> BissFacts:
        """Return the facts that apply to one order code, without those of other order codes.

        Args:
            code: The order code, as in the attribute ``code`` of an encoder.
        """
        timeouts = _rows_for_code(self.timeouts, code)
        return self._replace(
            # ``clocks`` are the clock limits that apply only to some order codes.
            clock=_clock_for_code(self.clock, self.clocks, code),
            clocks=(),
            timeout=timeouts[0] if timeouts else self.timeout,
            timeouts=(),
            timings=_rows_for_code(self.timings, code),
        )


class Exchange(NamedTuple):
    """Request over SPI or RS-485, with the frame that answers it.

    Attributes:
        request: Frame that the master sends.
        reply: Frame with which the encoder answers, or empty if it does not answer.
        purpose: ``position``, ``read``, ``write`` or ``other``.
        word_bits: Number of bits in each of the two SPI words, or None if the interface determines it.
        source: Source of the exchange.
    """

    request: str
    reply: str
    purpose: str
    word_bits: int | str | None = None
    source: str = ""


class SpiFacts(NamedTuple):
    """Facts about the SPI interface.

    Attributes:
        clock: Clock frequencies. It has no limits if they depend on the order code.
        mode: SPI mode, 0 to 3.
        word_bits: Number of bits of a word, or an expression if it depends on the order code. An exchange can differ.
        reply: Word in which the encoder answers, ``same_word`` or ``next_word``.
        exchanges: Requests with their replies.
        timings: Timings of this interface.
        note: Additional information.
        source: Source of the facts.
        clocks: Clock frequencies, each with its order codes. Empty if they do not depend on the order code.
    """

    clock: Clock
    mode: int
    word_bits: int | str
    reply: str
    exchanges: tuple[Exchange, ...] = ()
    timings: tuple[Timing, ...] = ()
    note: str = ""
    source: str = ""
    clocks: tuple[Clock, ...] = ()

    def for_code(self, code: str) -> SpiFacts:
        """Return the facts that apply to one order code, without those of other order codes.

        Args:
            code: The order code, as in the attribute ``code`` of an encoder.
        """
        return self._replace(
            # ``clocks`` are the clock limits that apply only to some order codes.
            clock=_clock_for_code(self.clock, self.clocks, code),
            clocks=(),
            timings=_rows_for_code(self.timings, code),
        )


class Rs485Facts(NamedTuple):
    """Facts about the RS-485 interface. Its requests are either in ``data_ids`` or in ``exchanges``."""

    port: Port
    data_ids: tuple[DataIdFacts, ...] = ()
    memory_access: tuple[MemoryAccess, ...] = ()
    exchanges: tuple[Exchange, ...] = ()
    timings: tuple[Timing, ...] = ()
    note: str = ""
    source: str = ""

    def for_code(self, code: str) -> Rs485Facts:
        """Return the facts that apply to one order code, without those of other order codes.

        Args:
            code: The order code, as in the attribute ``code`` of an encoder.
        """
        return self._replace(timings=_rows_for_code(self.timings, code))
