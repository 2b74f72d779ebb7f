"""Facts about an order code that master settings depend on: cable lengths, data channels, and notes for the user.

The rules for masters in ``specs/masters`` refer to the facts by name.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction

from ..language.problems import join_words
from ..model import (
    Alternative,
    Biss,
    Device,
    Flag,
    Interface,
    Layout,
    Measurement,
    PlacedLayout,
    Ssi,
    Unused,
    Variant,
    Verdict,
    assert_never,
    channel_frame,
)
from ..model.order_codes import facts_for_code
from ..model.record import dataclass
from ..say.names_and_evidence import Topic, addresses_text
from ..say.order_code import words_for_initial_values
from ..say.text import count_with_unit, hertz
from .frame_parts import FramePart, NoMasterSettings, turn_bits_of_fields

#: iC-Haus, application note AN15, BiSS C master operation details, revision A3, table 1: clock on MA with RS-422.
_BISS_CLOCKS = (
    (10, 10_000_000),
    (25, 5_000_000),
    (60, 2_000_000),
    (100, 1_000_000),
    (200, 500_000),
    (500, 200_000),
    (1000, 100_000),
)


class Undecided(NoMasterSettings):
    """The frame depends on a question that the manual leaves open, and the user gave no answer."""

    def __init__(self, layout: Layout, names: Iterable[str]) -> None:
        super().__init__(f"'{layout.name}' depends on {' and '.join(names)}, which you must choose")
        self.layout = layout


@dataclass(frozen=True, slots=True)
class CableRow:
    """A row of a table that gives the highest clock by cable length.

    ``metres`` and ``hz`` are upper limits. The length is exclusive if ``is_shorter`` is true, and the clock if
    ``is_below`` is true.
    """

    metres: int
    hz: int
    is_below: bool
    is_shorter: bool

    @property
    def cable(self) -> str:
        """The range of cable lengths, such as ``shorter than 50 m``."""
        limit_words = "shorter than" if self.is_shorter else "up to"
        return f"{limit_words} {self.metres} m"

    @property
    def text(self) -> str:
        """The cable lengths and the clock, such as ``up to 25 m: 5 MHz``."""
        clock_text = f"below {hertz(self.hz)}" if self.is_below else hertz(self.hz)
        return f"{self.cable}: {clock_text}"

    @property
    def highest_hz(self) -> int:
        """The highest permitted clock in Hz, which is below an exclusive limit."""
        return self.hz - 1 if self.is_below else self.hz

    def includes(self, metres: int) -> bool:
        """Return whether the row applies to this cable length."""
        return metres < self.metres or (metres == self.metres and not self.is_shorter)


@dataclass(frozen=True, slots=True)
class CableTable:
    """A table of clocks by cable length: its rows, its origin in words, and the names of the errata about it."""

    rows: tuple[CableRow, ...]
    origin: str
    errata: tuple[str, ...]

    def row_of(self, metres: int) -> CableRow | None:
        """Return the row with the highest clock for this cable length, or None if the table has no row for it."""
        rows_for_length = [row for row in self.rows if row.includes(metres)]
        return max(rows_for_length, key=lambda row: row.hz, default=None)

    def sentence_on_clock(self, clock_hz: int) -> str:
        """Return a sentence about the longest cable for a clock, or that no row allows it.

        Return an empty string without a table.
        """
        if not self.rows:
            return ""
        rows_with_clock = [row for row in self.rows if clock_hz <= row.highest_hz]
        if rows_with_clock:
            longest_row = max(rows_with_clock, key=lambda row: row.metres)
            cable = longest_row.cable
            return f"This clock frequency is suitable for a cable {cable}, according to the table in {self.origin}."
        fastest_row = max(self.rows, key=lambda row: row.hz)
        limit_words = "below " if fastest_row.is_below else ""
        limit = f"{limit_words}{hertz(fastest_row.hz)}"
        reason = f"its highest clock is {limit}, for a cable {fastest_row.cable}"
        return f"No row of the table in {self.origin} allows this clock: {reason}."


def _printed_rows(interface: Ssi, order_code: str) -> list[CableRow]:
    """Return the rows of the manual's table that apply to an order code, or all rows if ``order_code`` is empty."""
    cable_lengths = facts_for_code(interface.cable_lengths, order_code) if order_code else interface.cable_lengths
    return [
        CableRow(
            metres=cable_length.shorter_than_m,
            hz=cable_length.limit_hz,
            is_below=cable_length.is_exclusive,
            is_shorter=True,
        )
        for cable_length in cable_lengths
    ]


def cable_table(device: Device, interface: Ssi | Biss, order_code: str = "") -> CableTable:
    """Return the table of clocks by cable length: the manual's table for SSI, and a published one for BiSS.

    If the manual gives no table, it has no rows. The rows and errata of the manual are those for the order code, or all
    if ``order_code`` is empty.
    """
    match interface:
        case Ssi():
            table_path = f"interfaces.{interface.name}.cable_lengths"
            rows = _printed_rows(interface, order_code)
            errata = facts_for_code(device.errata, order_code) if order_code else device.errata
            errata_names = [erratum.name for erratum in errata if table_path in erratum.affects]
            return CableTable(rows=tuple(rows), origin=_ORIGIN_MANUAL, errata=tuple(errata_names))
        case Biss():
            rows = [CableRow(metres=metres, hz=hz, is_below=False, is_shorter=False) for metres, hz in _BISS_CLOCKS]
            return CableTable(rows=tuple(rows), origin=_ORIGIN_PUBLIC, errata=())
        case _:
            assert_never(interface)


@dataclass(frozen=True, slots=True)
class FrameChannels:
    """Names of the data channels before and after the position in its frame, in the order in which they are sent."""

    before: tuple[str, ...] = ()
    after: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Return whether the frame has other data channels than the one with the position."""
        return bool(self.before or self.after)

    def refusal(self, position_layout: str) -> str:
        """Return the reason why a master for a single data channel cannot read the position, or an empty string.

        Such a master reads only the first channel of a frame. ``position_layout`` is the channel with the position.
        """
        if not self.before:
            return ""
        first_name = self.before[0]
        order_text = f"'{first_name}' is the first in the frame, and '{position_layout}' with the position follows it"
        return f"The description of this master covers a single data channel, but {order_text}."

    @property
    def gap(self) -> str:
        """Sentence about the channels that a master for a single data channel does not read."""
        names = join_words(f"'{name}'" for name in self.after)
        return f"The description of this master covers a single data channel. Nothing reads {names} after it."


#: A frame with a single data channel.
NO_CHANNELS = FrameChannels()


@dataclasses.dataclass(frozen=True, slots=True)
class EncoderFacts:
    """Facts about one order code that master settings depend on.

    ``words`` and ``numbers`` are the facts to which the rules for masters refer, by name. A number that the spec does
    not give is None. ``frame_parts`` are the parts of the frame in the order in which they are sent, and ``notes`` are
    sentences for the user. ``answers`` are the user's answers to questions that the manual leaves open, by the name of
    the question. ``cable_m`` is the cable length for which the highest clock is chosen, and ``cable_row`` is the row of
    the table that limits the clock, or None. ``count_size_um`` is the exact length of a count in µm. ``document_word``
    is the word for the source of the spec, such as ``manual``. ``mention_by_topic`` refers to a text of the manual
    about a subject. ``used_hz`` has clocks with which the encoder is known to work, if its highest clock is unknown.
    ``obstacle`` is the reason why no master can read the position, and ``crc_obstacle`` is the reason why none can
    check the CRC. Both are sentences or empty. ``other_channels`` are the other data channels in the frame
    ``layout_name``.
    """

    code: str
    family: str
    words: Mapping[str, str]
    numbers: Mapping[str, int | None]
    frame_parts: tuple[FramePart, ...]
    timeout: str
    cable_table: CableTable
    mention_by_topic: Mapping[Topic, str]
    notes: tuple[str, ...] = ()
    answers: Mapping[str, str] = dataclasses.field(default_factory=dict)
    cable_m: int | None = None
    cable_row: CableRow | None = None
    count_size_um: Fraction | None = None
    document_word: str = "manual"
    used_hz: tuple[int, ...] = ()
    obstacle: str = ""
    crc_obstacle: str = ""
    other_channels: FrameChannels = NO_CHANNELS
    layout_name: str = ""

    @property
    def known_numbers(self) -> Mapping[str, int]:
        """The numbers that the spec gives, by name."""
        return {name: value for name, value in self.numbers.items() if value is not None}


_ORIGIN_MANUAL, _ORIGIN_PUBLIC = "the encoder's manual", "iC-Haus AN15, revision A3, for RS-422"


def frame_channels(interface: Interface, position_layout: PlacedLayout) -> FrameChannels:
    """Return the names of the other data channels in the frame with the position, if the frame has several channels."""
    frame = channel_frame(interface)
    layouts_in_frame = frame.layouts if frame is not None else ()
    sent_names = [layout.name for layout in layouts_in_frame if layout.is_sent(position_layout.parameters)]
    if position_layout.name not in sent_names:
        return NO_CHANNELS
    position_index = sent_names.index(position_layout.name)
    return FrameChannels(before=tuple(sent_names[:position_index]), after=tuple(sent_names[position_index + 1 :]))


def channel_notes(interface: Interface, position_layout: PlacedLayout) -> Iterator[str]:
    """Yield a sentence about BiSS data channels that the settings do not cover, because they lack the position."""
    channel = position_layout.layout.channel
    sent_layouts = [layout for layout in interface.layouts if layout.is_sent(position_layout.parameters)]
    other_layouts = [layout for layout in sent_layouts if layout.channel and layout.channel != channel]
    if isinstance(interface, Biss) and channel and other_layouts:
        other_channels = " and ".join(f"'{layout.name}' on channel {layout.channel}" for layout in other_layouts)
        yield f"The encoder also sends {other_channels}. These settings are for channel {channel} only."


NOTE_ON_CLOCKS = (
    "The clocks shown are the fastest that encoder and master support, regardless of cable length. "
    "Use --cable METRES to get the clocks for a cable length."
)


def answer_notes(alternatives: Sequence[Alternative], answer_names: Mapping[str, str]) -> Iterator[str]:
    """Yield a sentence for each of the user's answers to questions that the manual leaves open.

    ``answer_names`` has the name of the answer to each question, by the name of the question.
    """
    for alternative in alternatives:
        for answer in alternative.answers:
            if answer.name == answer_names[alternative.name]:
                yield f"With {alternative.name}={answer.name}: {answer.meaning}."


def clock_notes(numbers: Mapping[str, int | None], table_of_clocks: CableTable, cable_m: int | None) -> Iterator[str]:
    """Yield a note if the clock also depends on the cable length, but the user gave none (``cable_m`` is None)."""
    is_highest_clock_known = numbers["clock_max_hz"] is not None
    if is_highest_clock_known and table_of_clocks.rows and cable_m is None:
        yield NOTE_ON_CLOCKS


def _register_in_words(device: Device, name: str) -> str:
    """Return the printed name of a register with its addresses, or only ``name`` if the spec has no such register."""
    for register in device.registers:
        if register.name == name:
            return f"{register.printed_name or name} ({addresses_text(register)})"
    return name


def frame_notes(
    device: Device,
    placed_layout: PlacedLayout,
    frame_parts: Sequence[FramePart],
    *,
    position_name: str,
    as_delivered: bool,
) -> Iterator[str]:
    """Yield notes on registers that change the frame, on a signed position, and on status bits that never change.

    ``as_delivered`` is true if the registers have their factory defaults.
    """
    layout = placed_layout.layout
    width_parameters = set(layout.bits.parameters)
    code_parameters = {layout.gray_when} if layout.gray_when else set[str]()
    yield from _register_notes(device, width_parameters, dependence="widths depend", as_delivered=as_delivered)
    yield from _register_notes(device, code_parameters, dependence="code depends", as_delivered=as_delivered)
    position = placed_layout.find_field(position_name)
    if position is not None and position.field.number.signed:
        lowest, highest = device.signed_range(position, placed_layout)
        all_ones = (1 << position.width) - 1
        yield (
            f"The position is signed, in two's complement: {lowest} to {highest}. A master that reads it as unsigned "
            f"shows -1 as {all_ones}."
        )
    # A status bit without an active level never changes.
    fixed_bits = [part.name for part in frame_parts if part.role == "status" and not part.active]
    if fixed_bits:
        yield f"{' and '.join(fixed_bits)}: always 1, which a master treats as an inactive status bit."
    yield from _notes_on_unused_bits(placed_layout, frame_parts)
    yield from _notes_on_status_order(placed_layout)


def _notes_on_unused_bits(placed_layout: PlacedLayout, frame_parts: Sequence[FramePart]) -> Iterator[str]:
    """Yield a note on bits that masters take as zero bits, although the encoder may send ones there."""
    padding_names = [part.name for part in frame_parts if part.role == "padding"]
    names_in_quotes: list[str] = []
    for placed_field in placed_layout.fields:
        field_kind = placed_field.field.kind
        may_be_any_bits = isinstance(field_kind, Unused) and field_kind.makes_position is Verdict.USABLE
        if may_be_any_bits and placed_field.name in padding_names:
            names_in_quotes.append(f"'{placed_field.name}'")
    if names_in_quotes:
        yield (
            f"Masters take {' and '.join(names_in_quotes)} as zero bits. If the encoder sends ones there, a master may "
            "read a wrong position."
        )


def _notes_on_status_order(placed_layout: PlacedLayout) -> Iterator[str]:
    """Yield a note if the frame has a warning bit before its first error bit, unlike usual BiSS frames."""
    verdicts_of_flags: list[Verdict | None] = []
    for placed_field in placed_layout.fields:
        if isinstance(placed_field.field.kind, Flag):
            verdicts_of_flags.append(placed_field.field.kind.makes_position)
    if Verdict.NOT_USABLE not in verdicts_of_flags or Verdict.USABLE_WITH_WARNING not in verdicts_of_flags:
        return
    if verdicts_of_flags.index(Verdict.USABLE_WITH_WARNING) < verdicts_of_flags.index(Verdict.NOT_USABLE):
        order_text = "A warning bit is sent before the error bit"
        yield f"{order_text}. Masters that expect the error bit first take one for the other."


def split_notes(
    device: Device, placed_layout: PlacedLayout, measurement: Measurement, variant: Variant
) -> Iterator[str]:
    """Yield notes on a position of several fields whose boundaries do not separate revolutions from the angle.

    A field can contain bits of both. Or the spec does not give the counts per revolution, so that all bits are listed
    as singleturn bits.
    """
    position_fields = placed_layout.find_fields(placed_layout.layout.field_names_of(measurement.position_name))
    if len(position_fields) == 1:
        return
    if device.movement == "rotary" and measurement.counts_per_turn is None:
        remedy = "Add the counts per revolution to the spec to list the revolutions"
        yield f"All bits of the position are listed as singleturn bits. {remedy}."
    with suppress(NoMasterSettings):
        turn_bits_by_field = turn_bits_of_fields(placed_layout, measurement, variant)
        for field in position_fields:
            turn_bits_of_field = turn_bits_by_field[field.name]
            if 0 < turn_bits_of_field < field.width:
                highest_bits = count_with_unit(turn_bits_of_field, "bit")
                both_parts = f"the revolutions in its highest {highest_bits} and the rest below them"
                yield f"'{field.name}' holds both parts of the position: {both_parts}."


def _register_notes(device: Device, parameters: set[str], *, dependence: str, as_delivered: bool) -> Iterator[str]:
    """Yield a note on the registers that set any of these parameters, if there are any.

    ``dependence`` is ``widths depend`` or ``code depends``, as in "The widths depend on registers: …".
    """
    needed_names = device.needed_parameters(parameters)
    register_names = [parameter.register for parameter in device.run_time_parameters if parameter.name in needed_names]
    registers_in_words = dict.fromkeys(_register_in_words(device, name) for name in register_names)
    if not registers_in_words:
        return
    register_contents = "the given values"
    if as_delivered:
        register_contents = f"their {words_for_initial_values(device)}. Other values need other settings"
    yield f"The {dependence} on registers: {', '.join(registers_in_words)}. These settings are for {register_contents}."
