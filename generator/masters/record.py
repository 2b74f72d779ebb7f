"""The record of an order code: the facts about its position, frame, clocks and times that settings of masters need.

The rules for masters in ``specs/masters`` refer to its items by name. An item that the manual does not give is None. A
rule that needs it reports it as unknown.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from ..language.master_items import NUMBERS
from ..model import (
    Biss,
    Clock,
    Crc,
    Device,
    Interface,
    Layout,
    Measurement,
    PlacedLayout,
    Ssi,
    Timeout,
    Variant,
)
from ..model.order_codes import facts_for_code
from ..order_codes.parameters import with_answers
from ..say.evidence import Topic, reference_to_mention, word_for_document
from ..say.text import hertz, timeout_words
from .channels import NO_CHANNELS, FrameChannels, channel_notes, frame_channels
from .frame_parts import (
    CableRow,
    CableTable,
    FramePart,
    NoRecord,
    bit_counts,
    cable_table,
    frame_parts,
    parity_of_frame,
    position_coding,
    rough_parts,
)
from .notes import answer_notes, clock_notes, frame_notes, split_notes

_NO_ANSWERS: Mapping[str, str] = MappingProxyType({})


class Undecided(NoRecord):
    """The frame depends on a question that the manual leaves open, and no answer was given."""

    def __init__(self, layout: Layout, names: Iterable[str]) -> None:
        super().__init__(f"'{layout.name}' depends on {' and '.join(names)}, which you must choose")
        self.layout = layout


@dataclasses.dataclass(frozen=True, slots=True)
class EncoderFacts:
    """Facts about one order code. ``parts`` are in the order sent, ``notes`` are whole sentences.

    ``answers`` are the user's answers to questions that the manual leaves open, by the names of the alternatives.
    ``cable_m`` is the cable length for which the highest clock is chosen, and ``cable_row`` the row of the table for
    it. Both may be None. ``step`` is the exact length of a count in µm. ``numbers`` has it in each unit in which it is
    whole. ``document`` is the word for what does not state a fact. ``mentioned`` has the place of a text about a
    subject, or an empty string. ``used_hz`` has the clocks in use, if the highest clock is not known. ``obstacle`` is
    the reason why no master can take the position, and ``crc_obstacle`` the reason why none can check the CRC. Both are
    sentences, or empty. ``channels`` are the other data channels in the frame ``layout``.
    """

    code: str
    family: str
    words: Mapping[str, str]
    numbers: Mapping[str, int | None]
    parts: tuple[FramePart, ...]
    timeout: str
    cables: CableTable
    notes: tuple[str, ...]
    answers: Mapping[str, str]
    mentioned: Mapping[Topic, str]
    cable_m: int | None = None
    cable_row: CableRow | None = None
    step: Fraction | None = None
    document: str = "manual"
    used_hz: tuple[int, ...] = ()
    obstacle: str = ""
    crc_obstacle: str = ""
    channels: FrameChannels = NO_CHANNELS
    layout: str = ""

    @property
    def known_numbers(self) -> Mapping[str, int]:
        return {name: value for name, value in self.numbers.items() if value is not None}


#: Position whose unit the spec does not state.
_WITHOUT_UNIT = Measurement(of="position")


@dataclasses.dataclass(frozen=True, slots=True)
class _PositionFrame:
    """The frame of an order code that carries the position."""

    device: Device
    variant: Variant
    interface: Biss | Ssi
    placed_layout: PlacedLayout
    measurement: Measurement


def record(
    device: Device,
    variant: Variant,
    as_delivered: bool = True,
    cable_m: int | None = None,
    answers: Mapping[str, str] = _NO_ANSWERS,
) -> EncoderFacts:
    """Return the record of one order code.

    Args:
        device: The family.
        variant: The order code, with the parameters that registers hold.
        as_delivered: True if those are the factory defaults.
        cable_m: Cable length in metres for which to choose the highest clock. By default, the interface's limit holds.
        answers: The user's answers to questions that the manual leaves open, by the names of the alternatives.

    Raises:
        Undecided: The frame depends on an answer that is missing.
        NoRecord: The order code has no BiSS or SSI interface, no frame carries its position, or no clock is known for
            this cable length.
    """
    frame = _position_frame(device, variant, answers)
    deciding_alternatives = device.alternatives_of(frame.placed_layout.layout)
    parts, obstacle = _parts_and_obstacle(frame)
    crc_obstacle = _crc_obstacle(device, frame.placed_layout)
    numbers = _numbers_by_name(frame, parts)
    cables = cable_table(device, frame.interface, variant.code)
    needed_answers = {alternative.name: answers[alternative.name] for alternative in deciding_alternatives}
    notes = (
        *answer_notes(deciding_alternatives, needed_answers),
        *clock_notes(numbers, cables, cable_m),
        *frame_notes(device, frame.measurement.of, frame.placed_layout, parts, as_delivered),
        *split_notes(device, frame.placed_layout, frame.measurement, frame.variant),
        *channel_notes(frame.interface, frame.placed_layout),
        *filter(None, (obstacle, crc_obstacle)),
    )
    # The record is first built for any cable.
    unlimited = _build_record(frame, parts, numbers, cables, notes, needed_answers)
    unlimited = replace(unlimited, obstacle=obstacle, crc_obstacle=crc_obstacle)
    return unlimited if cable_m is None else _limit_to_cable(unlimited, cable_m)


def _position_frame(device: Device, variant: Variant, answers: Mapping[str, str]) -> _PositionFrame:
    """Return the frame with the position as these answers place it. Raise the errors of ``record``."""
    interface = device.interface(variant.interface)
    if not isinstance(interface, (Biss, Ssi)):
        only = f"there are masters for {Ssi.title} and {Biss.title} only"
        raise NoRecord(f"{variant.code} has the interface {interface.title}; {only}")
    measurement = device.measurement_of(variant.interface) or _WITHOUT_UNIT
    placed_layout = _frame_with_position(interface, measurement, with_answers(device, variant, answers))
    deciding_alternatives = device.alternatives_of(placed_layout.layout)
    missing = [alternative.name for alternative in deciding_alternatives if alternative.name not in answers]
    if missing:
        raise Undecided(placed_layout.layout, missing)
    return _PositionFrame(
        device=device,
        variant=variant,
        interface=interface,
        placed_layout=placed_layout,
        measurement=measurement.within(placed_layout.layout.position_range),
    )


def _parts_and_obstacle(frame: _PositionFrame) -> tuple[tuple[FramePart, ...], str]:
    """Return the parts of the frame, and the reason why no master can take them, or an empty string if they can.

    With a reason, the parts are only rough.
    """
    layout = frame.placed_layout.layout
    try:
        if layout.in_bytes:
            raise NoRecord(f"'{layout.name}' is carried as bytes, and the rules for masters cover frames of bits")
        return tuple(frame_parts(frame.placed_layout, frame.measurement, frame.variant)), ""
    except NoRecord as reason:
        rough = tuple(rough_parts(frame.placed_layout, frame.measurement, frame.variant))
        return rough, f"No master described here can read the position: {reason}."


def _crc_obstacle(device: Device, placed_layout: PlacedLayout) -> str:
    """Return the reason why no master can check the CRC, or an empty string."""
    crc = device.crc_of(placed_layout)
    if crc is None or _is_common_form(device, crc):
        return ""
    problem = "is not sent most significant bit first, either plain or fully inverted"
    return f"No master described here can check the CRC: '{crc.name}' {problem}."


def _is_common_form(device: Device, crc: Crc) -> bool:
    """Return whether the CRC is sent most significant bit first, either plain or fully inverted.

    The polynomial must end with + 1, since masters may omit this 1.
    """
    is_reflected = device.reflects_input(crc) or crc.refout
    is_plain_or_inverted = crc.xorout in (0, crc.mask)
    ends_with_1 = bool(crc.poly & 1)
    return not is_reflected and is_plain_or_inverted and ends_with_1


def _build_record(
    frame: _PositionFrame,
    frame_parts: tuple[FramePart, ...],
    numbers: Mapping[str, int | None],
    cables: CableTable,
    notes: tuple[str, ...],
    answers: Mapping[str, str],
) -> EncoderFacts:
    """Return the record for any cable length, without the reasons why masters cannot use it.

    ``used_hz`` is empty if the highest clock is known.
    """
    device, interface = frame.device, frame.interface
    timeout = interface.timeout_of(frame.variant.code) if isinstance(interface, Biss) else None
    clock = interface.clock_of(frame.variant.code)
    return EncoderFacts(
        code=frame.variant.code,
        family=device.name,
        words=_words_by_name(frame, frame_parts, numbers),
        numbers=numbers,
        parts=frame_parts,
        timeout=timeout_words(timeout) if timeout is not None else "",
        cables=cables,
        notes=notes,
        answers=answers,
        step=frame.measurement.micrometres(frame.variant.parameters),
        document=word_for_document(device),
        channels=frame_channels(interface, frame.placed_layout),
        layout=frame.placed_layout.name,
        mentioned={subject: reference_to_mention(device, interface, subject) for subject in Topic},
        used_hz=clock.used_hz if numbers["clock_max_hz"] is None else (),
    )


def _numbers_by_name(frame: _PositionFrame, frame_parts: Sequence[FramePart]) -> dict[str, int | None]:
    """Return the numbers of a record by name, in the order of ``NUMBERS``: ``{"position_bits": 24, …}``.

    A number that the spec does not give is None.
    """
    variant = frame.variant
    crc = frame.device.crc_of(frame.placed_layout)
    widths = bit_counts(frame_parts)
    numbers = (
        widths
        | _crc_numbers(crc)
        | _clock_and_times(frame.interface, variant.code)
        | _supply_voltage(frame.device, variant)
    )
    numbers |= _measurement_numbers(frame.measurement, variant, widths["multiturn_bits"] or 0)
    return {name: numbers[name] for name in NUMBERS}


def _words_by_name(
    frame: _PositionFrame, frame_parts: Sequence[FramePart], numbers: Mapping[str, int | None]
) -> dict[str, str]:
    """Return the facts of a record that are words, by name: ``{"coding": "gray", "parity": "none", ...}``."""
    movement = frame.device.movement
    return {
        "interface": frame.variant.interface,
        "movement": movement,
        "coding": position_coding(frame.placed_layout, frame.measurement, frame_parts),
        "status_active": _status_active(frame_parts),
        "parity": parity_of_frame(frame.placed_layout, frame_parts),
        "singleturn_codes": _singleturn_codes(movement, numbers["singleturn_bits"], numbers["counts_per_turn"]),
    }


def _status_active(frame_parts: Sequence[FramePart]) -> str:
    """Return the level at which the status bits are active, ``mixed`` if they differ, or ``none``."""
    # A bit that is always 1 has no level. It is an active-low bit that is never active.
    levels = {part.active or "low" for part in frame_parts if part.role == "status"}
    if not levels:
        return "none"
    have_same_level = len(levels) == 1
    return levels.pop() if have_same_level else "mixed"


def _limit_to_cable(unlimited: EncoderFacts, metres: int) -> EncoderFacts:
    """Return the record with the highest clock for this cable length: the table's clock or, if lower, the encoder's.

    If the encoder's clock is not known, the record contains the clocks in use that the table allows. ``cable_row`` is
    the row of the table that limits the clock, or None if the encoder limits it.

    Raises:
        NoRecord: The table has no such length, or its clock is lower than the encoder's lowest.
    """
    row = _cable_row(unlimited, metres)
    slowest_hz, fastest_hz = unlimited.numbers["clock_min_hz"], unlimited.numbers["clock_max_hz"]
    if fastest_hz is None:
        used_hz = tuple(hz for hz in unlimited.used_hz if hz <= row.highest_hz)
        return replace(unlimited, cable_m=metres, used_hz=used_hz)
    highest_hz = min(row.highest_hz, fastest_hz)
    if slowest_hz is not None and highest_hz < slowest_hz:
        table_text = f"the table in {unlimited.cables.origin} has {row.text}"
        need_text = f"the encoder needs at least {hertz(slowest_hz)}"
        raise NoRecord(f"{unlimited.code}, cable of {metres} m: {table_text}, but {need_text}")
    limiting_row = row if highest_hz == row.highest_hz else None
    numbers = {**unlimited.numbers, "clock_max_hz": highest_hz}
    return replace(unlimited, numbers=numbers, cable_m=metres, cable_row=limiting_row)


def _cable_row(unlimited: EncoderFacts, metres: int) -> CableRow:
    """Return the row of the table for this cable length.

    Raises:
        NoRecord: There is no table, or the cable is longer than all in it.
    """
    row = unlimited.cables.row_of(metres)
    if row is not None:
        return row
    cable_text = f"{unlimited.code}, cable of {metres} m"
    longest = max((table_row.metres for table_row in unlimited.cables.rows), default=0)
    if not longest:
        raise NoRecord(f"{cable_text}: the spec has no table of clocks by cable length")
    raise NoRecord(f"{cable_text}: the table in {unlimited.cables.origin} ends at {longest} m")


def _frame_with_position(interface: Interface, measurement: Measurement, variant: Variant) -> PlacedLayout:
    """Return the frame that carries the position of this order code. With several BiSS channels, this is the first.

    Raises:
        NoRecord: No frame carries the position.
    """
    layouts = sorted(interface.layouts, key=lambda layout: layout.channel or 0)
    for layout in layouts:
        placed_layout = layout.place(variant.parameters)
        _, position_width = placed_layout.place_of(measurement.of)
        if position_width:
            return placed_layout
    raise NoRecord(f"no frame of {interface.title} carries '{measurement.of}'")


def _crc_numbers(crc: Crc | None) -> dict[str, int | None]:
    """Return the numbers of the CRC, or zeros without a CRC.

    The polynomial x^6 + x + 1 is 0x43, or 0x03 without its top bit, or 0x21 without its last 1.
    """
    polynomial = crc.poly_with_top_bit if crc is not None else 0
    is_inverted = crc is not None and crc.xorout != 0
    return {
        "crc_polynomial": polynomial,
        "crc_polynomial_without_top_bit": crc.poly if crc is not None else 0,
        "crc_polynomial_without_last_1": polynomial >> 1,
        "crc_start": crc.init if crc is not None else 0,
        "crc_inverted": int(is_inverted),
    }


def _clock_and_times(interface: Biss | Ssi, code: str) -> dict[str, int | None]:
    """Return clock and times of an order code by name, with None for those that the spec does not give.

    For example ``{"clock_min_hz": 80000, "clock_max_hz": 5000000, "pause_us": 20, …}``.
    """
    timings = {timing.name: timing for timing in facts_for_code(interface.timings, code)}
    pause, busy = timings.get("pause"), timings.get("busy")
    clock = interface.clock_of(code)
    timeout = interface.timeout_of(code) if isinstance(interface, Biss) else None
    return {
        "clock_min_hz": clock.min_hz,
        "clock_max_hz": clock.max_hz,
        "timeout_us": _longest_timeout_us(timeout, clock) if timeout is not None else None,
        "busy_us": busy.at_most_us if busy is not None else None,
        "pause_us": pause.at_least_us if pause is not None else None,
    }


def _longest_timeout_us(timeout: Timeout, clock: Clock) -> int | None:
    """Return the longest time-out, rounded up, or None if it is not known. In periods, it depends on the clock."""
    slowest_hz = clock.min_hz
    if timeout.at_most_ns is not None:
        return _divide_rounding_up(timeout.at_most_ns, 1000)
    if timeout.half_clock_periods is not None and slowest_hz is not None:
        # Half a period at f Hz is 500 000 / f microseconds.
        return _divide_rounding_up(timeout.half_clock_periods * 500_000, slowest_hz)
    return None


def _divide_rounding_up(number: int, divisor: int) -> int:
    # Division rounds down, so dividing the negative number rounds its absolute value up.
    return -(-number // divisor)


def _supply_voltage(device: Device, variant: Variant) -> dict[str, int | None]:
    supply = device.supply_of(variant)
    lowest, highest = (supply.min_mv, supply.max_mv) if supply is not None else (None, None)
    return {"supply_min_mv": lowest, "supply_max_mv": highest}


def _measurement_numbers(measurement: Measurement, variant: Variant, multiturn_bits: int) -> dict[str, int | None]:
    """Return the counts per turn, the turns, and the step where it is whole. None if unknown."""
    counts, turns = measurement.counts_per_turn, measurement.turns
    turn_count = None
    if turns is not None:
        # Registers may set fewer bits than needed for the revolutions in other registers at their factory defaults.
        turn_count = min(turns.value(variant.parameters), 1 << multiturn_bits)
    step = measurement.micrometres(variant.parameters)
    return {
        "counts_per_turn": counts.value(variant.parameters) if counts is not None else None,
        "turns": turn_count,
        "step_um": _whole_number(step, per_um=1),
        "step_pm": _whole_number(step, per_um=1_000_000),
    }


def _singleturn_codes(movement: str, singleturn_bits: int | None, counts_per_turn: int | None) -> str:
    """Return ``all`` if every value of the singleturn bits is a position within a turn, and ``some`` if fewer are.

    Return ``none`` for linear encoders, and ``unknown`` without the numbers.
    """
    if movement == "linear":
        return "none"
    if counts_per_turn is None or singleturn_bits is None:
        return "unknown"
    number_of_codes = 1 << singleturn_bits
    return "all" if counts_per_turn == number_of_codes else "some"


def _whole_number(step: Fraction | None, per_um: int) -> int | None:
    """Return a length in micrometres in another unit, or None if it is not a whole number of that unit.

    ``per_um`` is the number of these units in a micrometre, such as 1,000,000 for picometres.
    """
    if step is None:
        return None
    length = step * per_um
    is_whole = length.denominator == 1
    return int(length) if is_whole else None
