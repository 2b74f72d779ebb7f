"""Record of the facts about one order code that BiSS and SSI masters need, the same for every master.

The rules for masters in ``specs/masters`` refer to its items by name. An item that the manual does not give is None. A
rule that needs it reports it as unknown.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from types import MappingProxyType

from ..language.master_items import NUMBERS
from ..model import (
    Alternative,
    Biss,
    Constant,
    Crc,
    CrcValue,
    Device,
    Field,
    Flag,
    Interface,
    Layout,
    Measurement,
    PlacedField,
    PlacedLayout,
    Ssi,
    Unused,
    Variant,
)
from ..order_codes.run_time import decided
from ..say.evidence import document
from ..say.parameter import initial
from ..say.place import addresses
from ..say.words import hertz, timeout_words
from .cable import CableRow, CableTable, cable_table

_NO_ANSWERS: Mapping[str, str] = MappingProxyType({})


class NoRecord(ValueError):
    """There are no master settings for this order code. The message gives the reason in one line."""


class Undecided(NoRecord):
    """The frame depends on a question that the manual leaves open, and there was no answer."""

    def __init__(self, layout: Layout, names: Iterable[str]) -> None:
        super().__init__(f"'{layout.name}' depends on {' and '.join(names)}, which you must choose")
        self.layout = layout


@dataclass(frozen=True, slots=True)
class Part:
    """A run of bits in the frame. ``role`` is ``padding``, ``multiturn``, ``singleturn``, ``status`` or ``crc``.

    ``active`` of a status bit is ``low``, ``high``, or empty if it never changes.
    """

    name: str
    role: str
    bits: int
    active: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """Facts about one order code. ``parts`` are in the order sent, ``notes`` are whole sentences.

    ``answers`` are the user's answers to questions that the manual leaves open, by the names of the alternatives.
    ``cable_m`` is the cable length for which the highest clock is chosen, and ``cable_row`` the row of the table for
    it. Both may be None. ``step`` is the exact length of a count in µm. ``numbers`` has it in each unit in which it is
    whole. ``document`` is the word for what does not state a fact. ``used_hz`` has the clocks in use, if the highest
    clock is not known.
    """

    code: str
    family: str
    words: Mapping[str, str]
    numbers: Mapping[str, int | None]
    parts: tuple[Part, ...]
    timeout: str
    cables: CableTable
    notes: tuple[str, ...]
    answers: Mapping[str, str]
    cable_m: int | None = None
    cable_row: CableRow | None = None
    step: Fraction | None = None
    document: str = "manual"
    used_hz: tuple[int, ...] = ()

    @property
    def known(self) -> Mapping[str, int]:
        return {name: value for name, value in self.numbers.items() if value is not None}


#: Position whose unit the spec does not give.
_WITHOUT_UNIT = Measurement("position", None, None, None, None, None, ())


def record(
    device: Device,
    variant: Variant,
    as_delivered: bool = True,
    cable_m: int | None = None,
    answers: Mapping[str, str] = _NO_ANSWERS,
) -> Record:
    """Return the record of one order code.

    Args:
        device: The family.
        variant: The order code, with the parameters that registers hold.
        as_delivered: True if those are the factory defaults.
        cable_m: Cable length in metres for which to choose the highest clock. By default, the interface's limit holds.
        answers: The user's answers to questions that the manual leaves open, by the names of the alternatives.

    Raises:
        Undecided: The frame depends on an answer that is missing.
        NoRecord: The order code has no BiSS or SSI interface, its frame does not have the common form (padding,
            position, padding, status, CRC), or no clock is known for this cable length.
    """
    interface = device.interface(variant.interface)
    if not isinstance(interface, (Biss, Ssi)):
        only = f"there are masters for {Ssi.title} and {Biss.title} only"
        raise NoRecord(f"{variant.code} has the interface {interface.title}; {only}")
    measurement = device.measurement_of(variant.interface) or _WITHOUT_UNIT
    placed = _frame(interface, measurement, decided(device, variant, answers))
    deciding = device.alternatives_of(placed.layout)
    missing = [item.name for item in deciding if item.name not in answers]
    if missing:
        raise Undecided(placed.layout, missing)
    taken = {item.name: answers[item.name] for item in deciding}
    parts = tuple(_parts(placed, measurement, variant))
    crc = _crc(device, placed)
    actives = {part.active or "low" for part in parts if part.role == "status"}
    words = {
        "interface": variant.interface,
        "movement": device.movement,
        "coding": _coding(placed, measurement),
        "status_active": "none" if not actives else actives.pop() if len(actives) == 1 else "mixed",
    }
    widths = _widths(parts)
    numbers = widths | _crc_numbers(crc) | _times(interface) | _supply(device, variant)
    numbers |= _measured(measurement, variant, widths["multiturn_bits"] or 0)
    cables = cable_table(device, interface)
    timeout = timeout_words(interface.timeout) if isinstance(interface, Biss) and interface.timeout is not None else ""
    notes = (
        *_answer_notes(deciding, taken),
        *_clock_notes(numbers, cables, cable_m),
        *_notes(device, measurement.of, placed, parts, as_delivered),
    )
    ordered = {name: numbers[name] for name in NUMBERS}
    step = measurement.micrometres(variant.parameters)
    source = document(device)
    found = Record(
        variant.code, device.name, words, ordered, parts, timeout, cables, notes, taken, step=step, document=source
    )
    if numbers["clock_max_hz"] is None:
        found = replace(found, used_hz=interface.clock.used_hz)
    return found if cable_m is None else _with_cable(found, cable_m)


def _with_cable(found: Record, metres: int) -> Record:
    """Return the record with the highest clock for this cable length."""
    row = found.cables.row_of(metres)
    if row is None:
        longest = max((item.metres for item in found.cables.rows), default=0)
        wrong = "neither the manual nor a public table gives the clock for a cable length"
        if longest:
            wrong = f"the table in {found.cables.origin} ends at {longest} m"
        raise NoRecord(f"{found.code}, cable of {metres} m: {wrong}")
    slowest, fastest = found.numbers["clock_min_hz"], found.numbers["clock_max_hz"]
    if fastest is None:
        used_hz = tuple(hz for hz in found.used_hz if hz <= row.highest_hz)
        return replace(found, cable_m=metres, used_hz=used_hz)
    highest = min(row.highest_hz, fastest)
    if slowest is not None and highest < slowest:
        wrong = f"the table in {found.cables.origin} has {row.text}, but the encoder needs at least {hertz(slowest)}"
        raise NoRecord(f"{found.code}, cable of {metres} m: {wrong}")
    limited = row if highest == row.highest_hz else None
    return replace(found, numbers={**found.numbers, "clock_max_hz": highest}, cable_m=metres, cable_row=limited)


def _frame(interface: Interface, measurement: Measurement, variant: Variant) -> PlacedLayout:
    """Return the frame that carries the position. With several BiSS channels, this is the first."""
    layouts = sorted(interface.layouts, key=lambda item: item.channel or 0)
    for layout in layouts:
        placed = layout.place(variant.parameters)
        if placed.place_of(measurement.of)[1]:
            if layout.in_bytes:
                raise NoRecord(f"'{layout.name}' is carried as bytes, and the rules for masters cover frames of bits")
            return placed
    raise NoRecord(f"no frame of {interface.title} carries '{measurement.of}'")


def _parts(placed: PlacedLayout, measurement: Measurement, variant: Variant) -> Iterator[Part]:
    """Yield the fields in the order sent, after checking that they are padding, position, padding, status bits, CRC."""
    layout = placed.layout
    of_position = layout.names_in(measurement.of)
    order = ["before", "position", "after", "status", "crc"]
    stage, top = 0, placed.bits
    for item in placed.fields:
        if item.high + 1 != top:
            raise NoRecord(f"the bits of '{layout.name}' above '{item.name}' have no meaning in the spec")
        top = item.low
        kind = _stage(item, of_position, order[stage])
        if kind not in order[stage:]:
            raise NoRecord(
                f"no master expects '{item.name}' at this place: "
                "the common frame is padding, position, padding, status bits, CRC"
            )
        stage = order.index(kind)
        if kind == "position":
            yield from _position(item, item.name == of_position[-1], len(of_position) > 1, measurement, variant)
        else:
            yield Part(
                item.name, {"before": "padding", "after": "padding"}.get(kind, kind), item.width, _active(item.field)
            )
    if top:
        raise NoRecord(f"the last bits of '{layout.name}' have no meaning in the spec")


def _stage(item: PlacedField, of_position: Sequence[str], stage: str) -> str:
    """Return the part of the common frame that a field belongs to. ``stage`` is the stage of its predecessor."""
    if item.name in of_position:
        return "position"
    if isinstance(item.field.kind, CrcValue):
        return "crc"
    if isinstance(item.field.kind, (Constant, Unused)) and item.field.kind.value == 0:
        return "before" if stage == "before" else "after"
    if item.width == 1 and isinstance(item.field.kind, (Flag, Constant, Unused)):
        return "status"
    raise NoRecord(f"'{item.name}' is not a position, status bit or CRC, and the rules for masters cover only these")


def _position(
    item: PlacedField, is_last: bool, is_joined: bool, measurement: Measurement, variant: Variant
) -> Iterator[Part]:
    """Yield turns and position within a turn: two fields, or one that holds both."""
    if is_joined:
        yield Part(item.name, "singleturn" if is_last else "multiturn", item.width)
        return
    turns = measurement.turns.value(variant.parameters) if measurement.turns is not None else 1
    turn_bits = (turns - 1).bit_length()
    if turn_bits:
        yield Part(f"{item.name}_turns", "multiturn", turn_bits)
    yield Part(item.name, "singleturn", item.width - turn_bits)


def _active(field: Field) -> str:
    if not isinstance(field.kind, Flag):
        return ""
    return "low" if field.kind.active_low else "high"


def _crc(device: Device, placed: PlacedLayout) -> Crc | None:
    crc = device.crc_of(placed.layout)
    if crc is None:
        return None
    if device.reflects_input(crc) or crc.refout or crc.xorout not in (0, crc.mask) or not crc.poly & 1:
        raise NoRecord(f"the CRC '{crc.name}' is not sent most significant bit first, either plain or fully inverted")
    return crc


def _coding(placed: PlacedLayout, measurement: Measurement) -> str:
    layout: Layout = placed.layout
    is_gray = bool(layout.gray_of) and (placed.gray or not layout.gray_when)
    if is_gray and layout.gray_of != measurement.of:
        has_more = set(layout.names_in(measurement.of)) < set(layout.names_in(layout.gray_of))
        what = "with more than the position" if has_more else "not the whole position"
        raise NoRecord(f"only '{layout.gray_of}' is in Gray code, {what}")
    return "gray" if is_gray else "binary"


def _widths(parts: Sequence[Part]) -> dict[str, int | None]:
    bits = {
        role: sum(part.bits for part in parts if part.role == role)
        for role in ("multiturn", "singleturn", "padding", "status", "crc")
    }
    first = next(index for index, part in enumerate(parts) if part.role in ("multiturn", "singleturn"))
    left = sum(part.bits for part in parts[:first])
    position = bits["multiturn"] + bits["singleturn"]
    data = position + bits["padding"]
    return {
        "multiturn_bits": bits["multiturn"],
        "singleturn_bits": bits["singleturn"],
        "position_bits": position,
        "padding_left": left,
        "padding_right": bits["padding"] - left,
        "data_bits": data,
        "status_bits": bits["status"],
        "data_and_status_bits": data + bits["status"],
        "crc_bits": bits["crc"],
        "frame_bits": data + bits["status"] + bits["crc"],
    }


def _crc_numbers(crc: Crc | None) -> dict[str, int | None]:
    """Return the three notations of the polynomial: x^6 + x + 1 is 0x43, 0x03 and 0x21."""
    whole, poly, start, turned = (crc.poly_with_top_bit, crc.poly, crc.init, crc.xorout) if crc else (0, 0, 0, 0)
    return {
        "crc_polynomial": whole,
        "crc_polynomial_without_top_bit": poly,
        "crc_polynomial_without_last_1": whole >> 1,
        "crc_start": start,
        "crc_inverted": int(turned != 0),
    }


def _times(interface: Biss | Ssi) -> dict[str, int | None]:
    """Return clock and times. A time-out in clock periods is longest at the slowest clock."""
    timeout = interface.timeout if isinstance(interface, Biss) else None
    longest = None
    if timeout is not None and timeout.at_most_ns is not None:
        longest = -(-timeout.at_most_ns // 1000)
    elif timeout is not None and timeout.half_clock_periods is not None:
        slowest = interface.clock.min_hz
        longest = -(-timeout.half_clock_periods * 500_000 // slowest) if slowest is not None else None
    pause = next((item.at_least_us for item in interface.timings if item.name == "pause"), None)
    return {
        "clock_min_hz": interface.clock.min_hz,
        "clock_max_hz": interface.clock.max_hz,
        "timeout_us": longest,
        "busy_us": next((item.at_most_us for item in interface.timings if item.name == "busy"), None),
        "pause_us": pause,
    }


def _supply(device: Device, variant: Variant) -> dict[str, int | None]:
    found = device.supply_of(variant)
    lowest, highest = (found.min_mv, found.max_mv) if found is not None else (None, None)
    return {"supply_min_mv": lowest, "supply_max_mv": highest}


def _measured(measurement: Measurement, variant: Variant, multiturn_bits: int) -> dict[str, int | None]:
    found = {"counts_per_turn": measurement.counts_per_turn, "turns": measurement.turns}
    known = {name: item.value(variant.parameters) if item is not None else None for name, item in found.items()}
    if known["turns"] is not None:
        # Registers may set fewer bits than needed for the revolutions in other registers at their factory defaults.
        known["turns"] = min(known["turns"], 1 << multiturn_bits)
    step = measurement.micrometres(variant.parameters)
    return known | {"step_um": _whole(step, 1), "step_pm": _whole(step, 1_000_000)}


def _whole(step: Fraction | None, per_um: int) -> int | None:
    """Return a length in micrometres in another unit, or None if it is not a whole number of that unit."""
    return int(step * per_um) if step is not None and (step * per_um).denominator == 1 else None


def _answer_notes(deciding: Sequence[Alternative], taken: Mapping[str, str]) -> Iterator[str]:
    for item in deciding:
        answer = next(one for one in item.answers if one.name == taken[item.name])
        yield f"With {item.name}={answer.name}: {answer.meaning}."


def _clock_notes(numbers: Mapping[str, int | None], cables: CableTable, cable_m: int | None) -> Iterator[str]:
    if numbers["clock_max_hz"] is not None and cables.rows and cable_m is None:
        yield (
            "The clocks shown are the fastest that encoder and master support, regardless of cable length. "
            "Use --cable METRES to get the clocks for a cable length."
        )


def _deciding(device: Device, name: str) -> str:
    """Return a register in words. One that is only reached over another interface has no address here."""
    register = next((item for item in device.registers if item.name == name), None)
    return name if register is None else f"{register.printed_name or name} ({addresses(register)})"


def _notes(device: Device, of: str, placed: PlacedLayout, parts: Sequence[Part], as_delivered: bool) -> Iterator[str]:
    for what, names in (
        ("widths depend", set(placed.layout.bits.parameters)),
        ("code depends", {placed.layout.gray_when} - {""}),
    ):
        needed = device.needed_parameters(names)
        names_of = (item.register for item in device.run_time_parameters if item.name in needed)
        deciding = ", ".join(dict.fromkeys(_deciding(device, name) for name in names_of))
        if deciding:
            given = f"their {initial(device)}. Other values need other settings" if as_delivered else "the given values"
            yield f"The {what} on registers: {deciding}. These settings are for {given}."
    signed = next((item for item in placed.fields if item.name == of and item.field.number.signed), None)
    if signed is not None:
        lowest, highest = device.signed_range(signed, placed)
        wrong = f"A master that reads it as unsigned shows -1 as {(1 << signed.width) - 1}."
        yield f"The position is signed, in two's complement: {lowest} to {highest}. {wrong}"
    fixed = [part.name for part in parts if part.role == "status" and not part.active]
    if fixed:
        yield f"{' and '.join(fixed)}: always 1, which a master treats as an inactive status bit."
