# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Classes for the tables from the manuals, except for frames and registers.

``source`` is the section and page of the manual. An empty text, an empty tuple or None means that the manual does not
say.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import Enum
from math import gcd
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from .reports import Interface, ReadOnly

if TYPE_CHECKING:
    from decimal import Decimal
    from fractions import Fraction

_NO_NAMES: ReadOnly[str] = ReadOnly({})


class Access(Enum):
    """Access of a master to a register."""

    READ_ONLY = "read_only"
    READ_WRITE = "read_write"
    WRITE_ONLY = "write_only"


class ByteOrder(Enum):
    """Byte order of a number, named after the byte at the lowest address."""

    LOW_BYTE_FIRST = "low_byte_first"
    HIGH_BYTE_FIRST = "high_byte_first"


class AboveMax(Enum):
    """Reaction of an encoder to a value above the maximum: it uses the default, or rejects the value."""

    DEFAULT = "default"
    REFUSED = "refused"


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


class ConnectorKind(Enum):
    """Kind of connection: a connector with pins, or a cable with colored wires."""

    CONNECTOR = "connector"
    CABLE = "cable"


class Status(Enum):
    """Status of an erratum: resolved by evidence in the manual itself, or open until tested on hardware."""

    SETTLED = "settled"
    OPEN = "open"


class Severity(Enum):
    """What happens if a program follows the printed text of an erratum literally."""

    WRONG_DATA = "wrong_data"
    WRONG_LIMIT = "wrong_limit"
    OMISSION = "omission"
    WORDING = "wording"


class Edition(NamedTuple):
    """Edition of the manual in another language, which was also consulted."""

    language: str
    title: str
    revision: str
    date: str = ""


class Revision(NamedTuple):
    """Row of the manual's revision table."""

    revision: str
    changes: str
    date: str = ""
    hardware: str = ""
    software: str = ""


class Manual(NamedTuple):
    """Manual that a module was generated from."""

    title: str
    revision: str
    date: str
    language: str
    publisher: str = ""
    editions: tuple[Edition, ...] = ()
    history: tuple[Revision, ...] = ()


class Document(NamedTuple):
    """Public document that a source cites by ``key``."""

    key: str
    title: str
    url: str = ""


class Crc(NamedTuple):
    """Standard parameters of a CRC. ``poly`` omits the top bit."""

    name: str
    width: int
    poly: int
    init: int
    refin: bool
    refout: bool
    xorout: int
    polynomial: str
    note: str = ""
    source: str = ""


class Scale(NamedTuple):
    """Quantity that a number represents: ``(number * numerator + offset) / denominator``, in ``unit``."""

    numerator: int
    denominator: int
    offset: int
    unit: str
    source: str = ""

    def quantity(self, number: int) -> Fraction:
        """Return the exact quantity for a number."""
        from fractions import Fraction

        return Fraction(number * self.numerator + self.offset, self.denominator)

    @property
    def places(self) -> int:
        """Number of decimals: as many as exact decimals need, otherwise enough for a tenth of a count."""
        # Decimals are exact if the reduced denominator divides a power of ten. This power has at most as many zeros as
        # the denominator has bits.
        reduced = self.denominator // gcd(self.numerator, self.offset, self.denominator)
        for places in range(reduced.bit_length()):
            if 10**places % reduced == 0:
                return places
        # The last decimal must be at most a tenth of a count, which is numerator / denominator.
        places = 0
        while 10**places * self.numerator < 10 * self.denominator:
            places += 1
        return places

    def decimal(self, number: int) -> Decimal:
        """Return the quantity for a number with ``places`` decimals. It is rounded if the exact decimals never end."""
        from decimal import Decimal

        scaled_number = number * self.numerator + self.offset
        # The size in units of the last decimal, rounded to the nearest integer.
        units_numerator = abs(scaled_number) * 10**self.places
        units = (2 * units_numerator + self.denominator) // (2 * self.denominator)
        sign = "-" if scaled_number < 0 and units else ""
        # A decimal from text is exact. Arithmetic with decimals would round to the precision of the context.
        return Decimal(f"{sign}{units}E-{self.places}")


class FieldFacts(NamedTuple):
    """Facts about a field. For its position in the frame, see ``bit_fields`` of the class.

    ``active`` is ``high`` or ``low`` for a flag. ``constant`` is the value of a constant field, ``unused`` the value of
    unused bits in the manual. ``implemented`` is False for a field that does not exist in this encoder. ``reserved`` is
    the only party that may use it. ``explained_by`` lists register fields with details, as ``register.field``.
    ``zero_means`` is the value that is sent as 0, if there is such a value. ``digit_code`` is the code of each digit,
    such as ``bcd``, of a number that is not sent in binary. ``scale`` gives the quantity that a number stands for.
    """

    name: str
    printed_name: str = ""
    meaning: str = ""
    unit: str = ""
    scale: Scale | None = None
    active: str = ""
    when_active: str = ""
    when_inactive: str = ""
    default: int | None = None
    constant: int | None = None
    unused: int | None = None
    signed: bool = False
    zero_means: int = 0
    power_of_two: bool = False
    digit_code: str = ""
    implemented: bool = True
    reserved: str = ""
    explained_by: tuple[str, ...] = ()
    names: Mapping[str, str] = _NO_NAMES
    note: str = ""
    source: str = ""


class RegisterMeaning(NamedTuple):
    """One of several meanings of a register. It applies while the field ``when`` has the value ``value``.

    ``min`` and ``max`` are its limits as given in the manual. The register's class contains them as numbers.
    """

    name: str
    when: str
    value: str
    min: str = ""
    max: str = ""
    meaning: str = ""
    source: str = ""


class Register(NamedTuple):
    """Register of ``length`` bytes, starting at ``address``.

    If ``opened_by`` is given, that register must hold ``opened_by_value``, in its field ``opened_by_field`` if given,
    before this register can be written. ``wait_ms`` is the minimum time to wait after a write. ``above_max`` is the
    reaction to a value above the maximum. ``write_clears`` lists registers that a write sets to zero. ``reserved`` is
    the only party that may use the register.
    """

    name: str
    printed_name: str
    address: int
    length: int
    access: Access
    byte_order: ByteOrder
    default: bytes | None = None
    opened_by: str = ""
    opened_by_field: str = ""
    opened_by_value: str = ""
    clears_itself: bool = False
    wait_ms: int = 0
    volatile: bool = False
    bank: int | None = None
    above_max: AboveMax | None = None
    write_clears: tuple[str, ...] = ()
    meanings: tuple[RegisterMeaning, ...] = ()
    reserved: str = ""
    fields: tuple[FieldFacts, ...] = ()
    names: Mapping[str, str] = _NO_NAMES
    meaning: str = ""
    note: str = ""
    source: str = ""


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
    """Clock limit for a cable: cables shorter than ``shorter_than_m`` need a clock below ``below_hz``.

    ``only`` lists the order codes that the limit applies to, or is empty for all.
    """

    shorter_than_m: int
    below_hz: int
    source: str = ""
    only: str = ""


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
    compared: Mapping[str, str] = _NO_NAMES
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
            the typical one, or else the maximum.
        """
        if self.half_clock_periods is not None:
            return self.half_clock_periods * 500_000_000 / clock_hz
        if self.rule is TimeoutRule.FOLLOWS_CLOCK:
            ns_by_clock = {printed.clock_hz: printed.timeout_ns for printed in reversed(self.printed)}
            return ns_by_clock.get(clock_hz)
        return self.typical_ns if self.typical_ns is not None else self.at_most_ns


class NamedValue(NamedTuple):
    """Named value of a field."""

    name: str
    value: int
    meaning: str = ""


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
    """Reply of the encoder to a memory access, depending on the busy flag in the reply."""

    access: str
    busy: bool
    address: str
    data: str
    meaning: str
    source: str = ""


_Row = TypeVar("_Row", Clock, CableLength, Timeout, Timing)


def _rows_for_code(rows: tuple[_Row, ...], code: str) -> tuple[_Row, ...]:
    """Return the rows that apply to an order code.

    Their ``only`` is made empty, because they apply without restriction.
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
            The limit in hertz. The clock must be below it. None if the cable is too long for the table, or if there is
            no table.
        """
        for row in self.cable_lengths:
            applies_to_all_codes = not row.only
            if applies_to_all_codes and cable_m < row.shorter_than_m:
                return row.below_hz
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
        word_bits: Number of bits of both words over SPI, or None if the interface determines it.
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


class Alarm(NamedTuple):
    """Error or warning of the encoder.

    ``field`` is its flag, in a frame or in ``register``. ``latch`` is True if it stays active until it is reset.
    ``below_mv`` is the voltage in millivolts below which it is raised. ``cleared_by`` lists the procedures that clear
    it, and ``by_hand`` lists the characteristics that describe manual steps. ``only`` describes the order codes that
    have it, unless all have it.
    """

    name: str
    meaning: str
    printed_name: str = ""
    register: str = ""
    field: str = ""
    detected: str = ""
    below_mv: int | None = None
    latch: bool | None = None
    implemented: bool = True
    remedy: str = ""
    cleared_by: tuple[str, ...] = ()
    names: Mapping[str, str] = _NO_NAMES
    source: str = ""
    only: str = ""
    by_hand: tuple[str, ...] = ()


class Contact(NamedTuple):
    """Pin or wire. ``only`` lists the order codes that have it, or is empty if all have it."""

    contact: str
    signal: str
    only: str = ""


class Connector(NamedTuple):
    """Connector or cable."""

    name: str
    kind: ConnectorKind
    title: str
    interfaces: tuple[Interface, ...]
    contacts: tuple[Contact, ...]
    mating: str = ""
    note: str = ""
    source: str = ""


class LedState(NamedTuple):
    """State of an LED and its meaning.

    ``only`` describes the order codes that have it, unless all have it. ``by_hand`` lists the characteristics that
    describe manual steps.
    """

    state: str
    meaning: str
    only: str = ""
    by_hand: tuple[str, ...] = ()


class Led(NamedTuple):
    """LED and the meaning of its states."""

    name: str
    title: str
    states: tuple[LedState, ...]
    source: str = ""


class Input(NamedTuple):
    """Hardware input. ``inverts`` and ``needs`` are register bits, written as ``register.field``."""

    name: str
    meaning: str
    printed_name: str = ""
    low: str = ""
    high: str = ""
    pulse_at_least_us: int | None = None
    inverts: str = ""
    needs: str = ""
    when_unused: str = ""
    note: str = ""
    names: Mapping[str, str] = _NO_NAMES
    source: str = ""


class Table(NamedTuple):
    """Table of the manual."""

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    source: str = ""
    units: tuple[str, ...] = ()


class LostFigure(NamedTuple):
    """Content of a figure in the manual that is missing from its text."""

    content: str
    source: str = ""


class Quantity(NamedTuple):
    """Quantity such as ``torque``, with its bounds in ``unit``. ``where`` is the part that it applies to."""

    quantity: str
    unit: str
    min: float | None = None
    typical: float | None = None
    max: float | None = None
    where: str = ""


class Characteristic(NamedTuple):
    """Additional fact: its text, and its quantities with units in ``values``.

    ``only`` describes the order codes that it applies to, if not all.
    """

    name: str
    value: str
    only: str = ""
    source: str = ""
    values: tuple[Quantity, ...] = ()


class Erratum(NamedTuple):
    """Error or ambiguity in the manual.

    ``title`` says in one sentence what is wrong. ``printed`` is the text of the manual, to the letter only in double
    quotation marks. ``used`` is the text that is used instead, and ``why`` the reason. ``only`` describes the order
    codes that it applies to, if not all.
    """

    name: str
    title: str
    printed: str
    used: str
    why: str
    status: Status
    severity: Severity
    affects: tuple[str, ...] = ()
    source: str = ""
    only: str = ""
