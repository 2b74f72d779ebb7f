"""The facts about one order code: its position, frame, clocks and times that settings of masters need.

The rules for masters in ``specs/masters`` refer to its items by name. An item that the manual does not give is None. A
rule that needs it reports it as unknown.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from ..language.keys_of_masters import NUMBERS
from ..model import Biss, Clock, Crc, Device, Interface, Measurement, PlacedLayout, Ssi, Timeout, Variant
from ..model.order_codes import facts_for_code
from ..order_codes.parameters import with_answers
from ..say.names_and_evidence import Topic, reference_to_mention, word_for_document
from ..say.text import hertz, timeout_words
from .encoder_facts import (
    CableRow,
    CableTable,
    EncoderFacts,
    Undecided,
    answer_notes,
    cable_table,
    channel_notes,
    clock_notes,
    frame_channels,
    frame_notes,
    split_notes,
)
from .frame_parts import (
    FramePart,
    NoMasterSettings,
    bit_counts,
    frame_parts,
    parity_of_frame,
    position_coding,
    rough_parts,
)

_NO_ANSWERS: Mapping[str, str] = MappingProxyType({})


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


def _notes_on_frame(
    device: Device, frame: _PositionFrame, parts_of_frame: Sequence[FramePart], as_delivered: bool
) -> Iterator[str]:
    """Yield notes on the frame, on a position in several fields, and on further data channels."""
    placed_layout, measurement = frame.placed_layout, frame.measurement
    yield from frame_notes(
        device, placed_layout, parts_of_frame, position_name=measurement.position_name, as_delivered=as_delivered
    )
    yield from split_notes(device, placed_layout, measurement, frame.variant)
    yield from channel_notes(frame.interface, placed_layout)


def facts_of_order_code(
    device: Device,
    variant: Variant,
    as_delivered: bool = True,
    cable_m: int | None = None,
    answers: Mapping[str, str] = _NO_ANSWERS,
) -> EncoderFacts:
    """Return the facts about one order code that master settings depend on.

    Args:
        device: The family.
        variant: The order code, with the parameters that registers hold.
        as_delivered: True if those are the factory defaults.
        cable_m: Cable length in meters for which the highest clock is chosen. By default, only the encoder limits it.
        answers: The user's answers to questions that the manual leaves open, by the name of the question.

    Raises:
        Undecided: The frame depends on an answer that is missing.
        NoMasterSettings: The order code has no BiSS or SSI interface, no frame contains its position, or no clock is
            known for this cable length.
    """
    frame = _position_frame(device, variant, answers)
    placed_layout = frame.placed_layout
    deciding_alternatives = device.alternatives_of(placed_layout.layout)
    needed_answers = {alternative.name: answers[alternative.name] for alternative in deciding_alternatives}
    parts_of_frame, obstacle = _parts_and_obstacle(frame)
    crc_obstacle = _crc_obstacle(device, placed_layout)
    numbers = _numbers_by_name(frame, parts_of_frame)
    table_of_clocks = cable_table(device, frame.interface, variant.code)
    notes = [
        *answer_notes(deciding_alternatives, needed_answers),
        *clock_notes(numbers, table_of_clocks, cable_m),
        *_notes_on_frame(device, frame, parts_of_frame, as_delivered),
    ]
    notes += [reason for reason in (obstacle, crc_obstacle) if reason]
    facts_without_notes = _facts_for_any_cable(frame, parts_of_frame, numbers, table_of_clocks)
    facts_for_any_cable = replace(
        facts_without_notes, notes=tuple(notes), answers=needed_answers, obstacle=obstacle, crc_obstacle=crc_obstacle
    )
    return facts_for_any_cable if cable_m is None else _limit_to_cable(facts_for_any_cable, cable_m)


def _position_frame(device: Device, variant: Variant, answers: Mapping[str, str]) -> _PositionFrame:
    """Return the frame that contains the position, with the user's answers to questions that the manual leaves open.

    Raises:
        Undecided: The frame depends on an answer that is missing.
        NoMasterSettings: The order code has no BiSS or SSI interface, or no frame contains its position.
    """
    interface = device.interface(variant.interface)
    if not isinstance(interface, (Biss, Ssi)):
        supported_interfaces = f"there are masters for {Ssi.title} and {Biss.title} only"
        raise NoMasterSettings(f"{variant.code} has the interface {interface.title}; {supported_interfaces}")
    measurement = device.measurement_of(variant.interface) or _WITHOUT_UNIT
    placed_layout = _frame_with_position(interface, measurement, with_answers(device, variant, answers))
    deciding_alternatives = device.alternatives_of(placed_layout.layout)
    unanswered_questions = [
        alternative.name for alternative in deciding_alternatives if alternative.name not in answers
    ]
    if unanswered_questions:
        raise Undecided(placed_layout.layout, unanswered_questions)
    return _PositionFrame(
        device=device,
        variant=variant,
        interface=interface,
        placed_layout=placed_layout,
        measurement=measurement.within(placed_layout.layout.position_range),
    )


def _parts_and_obstacle(frame: _PositionFrame) -> tuple[tuple[FramePart, ...], str]:
    """Return the parts of the frame by their role for a master, and the reason why no master can read the position.

    The reason is empty if masters can read it. With a reason, the roles are only approximate.
    """
    layout = frame.placed_layout.layout
    try:
        if layout.in_bytes:
            raise NoMasterSettings(f"'{layout.name}' is sent as bytes, but the rules for masters cover frames of bits")
        return tuple(frame_parts(frame.placed_layout, frame.measurement, frame.variant)), ""
    except NoMasterSettings as reason:
        approximate_parts = tuple(rough_parts(frame.placed_layout, frame.measurement, frame.variant))
        return approximate_parts, f"No master described here can read the position: {reason}."


def _crc_obstacle(device: Device, placed_layout: PlacedLayout) -> str:
    """Return the reason why no master can check the CRC of a frame, or an empty string.

    It is empty if masters can check the CRC, and for a frame without a CRC.
    """
    crc = device.crc_of(placed_layout)
    if crc is None or _can_masters_check(device, crc):
        return ""
    problem = "is not sent most significant bit first, either plain or fully inverted"
    return f"No master described here can check the CRC: '{crc.name}' {problem}."


def _can_masters_check(device: Device, crc: Crc) -> bool:
    """Return whether masters can check a CRC: it is sent most significant bit first, either plain or fully inverted.

    Its polynomial must also end with + 1, since some masters omit this 1.
    """
    is_reflected = device.reflects_input(crc) or crc.refout
    is_plain_or_inverted = crc.xorout in (0, crc.mask)
    ends_with_1 = bool(crc.poly & 1)
    return not is_reflected and is_plain_or_inverted and ends_with_1


def _facts_for_any_cable(
    frame: _PositionFrame,
    frame_parts: tuple[FramePart, ...],
    numbers: Mapping[str, int | None],
    table_of_clocks: CableTable,
) -> EncoderFacts:
    """Return the facts about an order code for any cable length, without notes, answers and obstacles for masters."""
    device, interface = frame.device, frame.interface
    timeout = interface.timeout_of(frame.variant.code) if isinstance(interface, Biss) else None
    clock = interface.clock_of(frame.variant.code)
    return EncoderFacts(
        code=frame.variant.code,
        family=device.name,
        words=_words_by_name(frame, frame_parts, numbers),
        numbers=numbers,
        frame_parts=frame_parts,
        timeout=timeout_words(timeout) if timeout is not None else "",
        cable_table=table_of_clocks,
        count_size_um=frame.measurement.micrometres(frame.variant.parameters),
        document_word=word_for_document(device),
        other_channels=frame_channels(interface, frame.placed_layout),
        layout_name=frame.placed_layout.name,
        mention_by_topic={subject: reference_to_mention(device, interface, subject) for subject in Topic},
        used_hz=clock.used_hz if numbers["clock_max_hz"] is None else (),
    )


def _numbers_by_name(frame: _PositionFrame, frame_parts: Sequence[FramePart]) -> dict[str, int | None]:
    """Return all numbers to which the rules for masters refer, by name: ``{"position_bits": 24, …}``.

    A number that the spec does not give is None.
    """
    variant = frame.variant
    crc = frame.device.crc_of(frame.placed_layout)
    bit_count_by_name = bit_counts(frame_parts)
    numbers = (
        bit_count_by_name
        | _crc_numbers(crc)
        | _clock_and_times(frame.interface, variant.code)
        | _supply_voltage(frame.device, variant)
    )
    numbers |= _measurement_numbers(frame.measurement, variant, bit_count_by_name["multiturn_bits"] or 0)
    return {name: numbers[name] for name in NUMBERS}


def _words_by_name(
    frame: _PositionFrame, frame_parts: Sequence[FramePart], numbers: Mapping[str, int | None]
) -> dict[str, str]:
    """Return all facts to which the rules for masters refer and that are words: ``{"coding": "gray", ...}``."""
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
    """Return the active level of the status bits: ``low``, ``high``, ``mixed`` if they differ, or ``none`` without any.

    A bit that is always 1 counts as active low, because it looks like an active-low bit that is never active.
    """
    levels = {part.active or "low" for part in frame_parts if part.role == "status"}
    if not levels:
        return "none"
    if len(levels) > 1:
        return "mixed"
    return levels.pop()


def _limit_to_cable(unlimited: EncoderFacts, metres: int) -> EncoderFacts:
    """Return the facts about an order code with the highest clock for a cable length.

    It is the clock in the table of cable lengths or, if lower, the highest clock of the encoder. If the latter is
    unknown, only those clocks in ``used_hz`` remain that the table allows. ``cable_row`` becomes the row of the table
    that limits the clock, or None if the encoder limits it.

    Raises:
        NoMasterSettings: The table does not cover this length, or its clock is too low for the encoder.
    """
    cable_row = _cable_row(unlimited, metres)
    slowest_hz, fastest_hz = unlimited.numbers["clock_min_hz"], unlimited.numbers["clock_max_hz"]
    if fastest_hz is None:
        used_hz = tuple(hz for hz in unlimited.used_hz if hz <= cable_row.highest_hz)
        return replace(unlimited, cable_m=metres, used_hz=used_hz)
    highest_hz = min(cable_row.highest_hz, fastest_hz)
    if slowest_hz is not None and highest_hz < slowest_hz:
        table_text = f"the table in {unlimited.cable_table.origin} has {cable_row.text}"
        need_text = f"the encoder needs at least {hertz(slowest_hz)}"
        raise NoMasterSettings(f"{unlimited.code}, cable of {metres} m: {table_text}, but {need_text}")
    limiting_row = cable_row if highest_hz == cable_row.highest_hz else None
    numbers = {**unlimited.numbers, "clock_max_hz": highest_hz}
    return replace(unlimited, numbers=numbers, cable_m=metres, cable_row=limiting_row)


def _cable_row(unlimited: EncoderFacts, metres: int) -> CableRow:
    """Return the row of the table of clocks that applies to a cable length.

    Raises:
        NoMasterSettings: There is no table, or the cable is longer than all cables in it.
    """
    row = unlimited.cable_table.row_of(metres)
    if row is not None:
        return row
    cable_text = f"{unlimited.code}, cable of {metres} m"
    has_table = bool(unlimited.cable_table.rows)
    if not has_table:
        raise NoMasterSettings(f"{cable_text}: the spec has no table of clocks by cable length")
    longest = max(table_row.metres for table_row in unlimited.cable_table.rows)
    raise NoMasterSettings(f"{cable_text}: the table in {unlimited.cable_table.origin} ends at {longest} m")


def _frame_with_position(interface: Interface, measurement: Measurement, variant: Variant) -> PlacedLayout:
    """Return the frame that contains the position of an order code: the first one if several BiSS channels do.

    Raises:
        NoMasterSettings: No frame contains the position.
    """
    layouts = sorted(interface.layouts, key=lambda layout: layout.channel or 0)
    for layout in layouts:
        placed_layout = layout.place(variant.parameters)
        _, position_width = placed_layout.lowest_bit_and_width_of(measurement.position_name)
        if position_width:
            return placed_layout
    raise NoMasterSettings(f"no frame of {interface.title} carries '{measurement.position_name}'")


def _crc_numbers(crc: Crc | None) -> dict[str, int | None]:
    """Return the parameters of a CRC by their names in the rules for masters, or zeros without a CRC.

    The polynomial is in three notations: x^6 + x + 1 is 0x43, 0x03 without its top bit, and 0x21 without its last 1.
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


def _clock_and_times(interface: Biss | Ssi, order_code: str) -> dict[str, int | None]:
    """Return clock limits and times of an order code by name: ``{"clock_max_hz": 5000000, "pause_us": 20, …}``.

    A number that the spec does not give is None.
    """
    timing_by_name = {timing.name: timing for timing in facts_for_code(interface.timings, order_code)}
    pause = timing_by_name.get("pause")
    busy = timing_by_name.get("busy")
    clock = interface.clock_of(order_code)
    timeout = interface.timeout_of(order_code) if isinstance(interface, Biss) else None
    return {
        "clock_min_hz": clock.min_hz,
        "clock_max_hz": clock.max_hz,
        "timeout_us": _longest_timeout_us(timeout, clock) if timeout is not None else None,
        "busy_us": busy.at_most_us if busy is not None else None,
        "pause_us": pause.at_least_us if pause is not None else None,
    }


def _longest_timeout_us(timeout: Timeout, clock: Clock) -> int | None:
    """Return the longest timeout in µs, rounded up, or None if the spec does not give it.

    A timeout that is given in clock periods is longest at the lowest clock.
    """
    slowest_hz = clock.min_hz
    if timeout.at_most_ns is not None:
        return _divide_rounding_up(timeout.at_most_ns, 1000)
    if timeout.half_clock_periods is not None and slowest_hz is not None:
        # Half a period at f Hz is 500 000 / f microseconds.
        return _divide_rounding_up(timeout.half_clock_periods * 500_000, slowest_hz)
    return None


def _divide_rounding_up(number: int, divisor: int) -> int:
    """Return the quotient of two positive numbers, rounded up."""
    return (number + divisor - 1) // divisor


def _supply_voltage(device: Device, variant: Variant) -> dict[str, int | None]:
    """Return the limits of the supply voltage of an order code in mV, or None if the spec does not give them."""
    supply = device.supply_of(variant)
    return {
        "supply_min_mv": supply.min_mv if supply is not None else None,
        "supply_max_mv": supply.max_mv if supply is not None else None,
    }


def _measurement_numbers(measurement: Measurement, variant: Variant, multiturn_bits: int) -> dict[str, int | None]:
    """Return the counts per turn, the number of turns, and the size of a count in µm and in pm, by name.

    A number is None if the spec does not give it, or if the size of a count is not a whole number in the unit.
    """
    counts_per_turn = measurement.counts_per_turn
    turns = measurement.turns
    turn_count = None
    if turns is not None:
        # One register can set fewer multiturn bits than another register needs for its factory default of revolutions.
        turn_count = min(turns.value(variant.parameters), 1 << multiturn_bits)
    count_size_um = measurement.micrometres(variant.parameters)
    return {
        "counts_per_turn": counts_per_turn.value(variant.parameters) if counts_per_turn is not None else None,
        "turns": turn_count,
        "step_um": _whole_number(count_size_um, per_um=1),
        "step_pm": _whole_number(count_size_um, per_um=1_000_000),
    }


def _singleturn_codes(movement: str, singleturn_bits: int | None, counts_per_turn: int | None) -> str:
    """Return which values of the singleturn bits are positions: ``all``, ``some``, ``none``, or ``unknown``.

    It is ``none`` for linear encoders, and ``unknown`` if the spec does not give the numbers.
    """
    if movement == "linear":
        return "none"
    if counts_per_turn is None or singleturn_bits is None:
        return "unknown"
    code_count = 1 << singleturn_bits
    return "all" if counts_per_turn == code_count else "some"


def _whole_number(length_um: Fraction | None, per_um: int) -> int | None:
    """Convert a length in micrometers to a smaller unit, or return None if it is not a whole number in this unit.

    ``per_um`` is the number of these units in a micrometer, such as 1,000,000 for picometers.
    """
    if length_um is None:
        return None
    length_in_unit = length_um * per_um
    is_whole = length_in_unit.denominator == 1
    return int(length_in_unit) if is_whole else None
