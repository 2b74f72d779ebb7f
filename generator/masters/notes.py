"""Notes on the facts about an order code, as sentences: answers, clocks, and the bits of the frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

from ..model import Alternative, Device, Measurement, PlacedLayout, Variant
from ..say.names_and_places import addresses_text
from ..say.order_code import initial
from ..say.text import count_with_unit
from .frame_parts import CableTable, FramePart, NoRecord, turn_bits_of_fields

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


def clock_notes(numbers: Mapping[str, int | None], cables: CableTable, cable_m: int | None) -> Iterator[str]:
    """Yield a note if the clock also depends on the cable length, but the user gave none (``cable_m`` is None)."""
    is_highest_clock_known = numbers["clock_max_hz"] is not None
    if is_highest_clock_known and cables.rows and cable_m is None:
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


def split_notes(
    device: Device, placed_layout: PlacedLayout, measurement: Measurement, variant: Variant
) -> Iterator[str]:
    """Yield notes on a position of several fields whose boundaries do not separate revolutions from the angle.

    A field can contain bits of both. Or the spec does not give the counts per revolution, so that all bits are listed
    as singleturn bits.
    """
    position_fields = placed_layout.find_fields(placed_layout.layout.names_in(measurement.of))
    if len(position_fields) == 1:
        return
    if device.movement == "rotary" and measurement.counts_per_turn is None:
        remedy = "Add the counts per revolution to the spec to list the revolutions"
        yield f"All bits of the position are listed as singleturn bits. {remedy}."
    with suppress(NoRecord):
        turn_bits = turn_bits_of_fields(placed_layout, measurement, variant)
        for field in position_fields:
            turn_bits_of_field = turn_bits[field.name]
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
    registers = dict.fromkeys(_register_in_words(device, name) for name in register_names)
    if not registers:
        return
    contents = "the given values"
    if as_delivered:
        contents = f"their {initial(device)}. Other values need other settings"
    yield f"The {dependence} on registers: {', '.join(registers)}. These settings are for {contents}."
