"""Facts that master settings depend on: the parts of a frame by their role, and the highest clock for a cable."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from ..model import (
    Biss,
    Constant,
    CrcValue,
    Device,
    Field,
    Flag,
    Measurement,
    Parity,
    PlacedField,
    PlacedLayout,
    Ssi,
    Unused,
    Variant,
    assert_never,
)
from ..model.expressions import is_power_of_two
from ..model.order_codes import facts_for_code
from ..model.record import dataclass
from ..say.text import hertz

_ORIGIN_MANUAL, _ORIGIN_PUBLIC = "the encoder's manual", "iC-Haus AN15, revision A3, for RS-422"


class NoRecord(ValueError):
    """There are no master settings for this order code. The message gives the reason in one line."""


@dataclasses.dataclass(frozen=True, slots=True)
class FramePart:
    """Adjacent bits in a frame that have the same role for a master.

    ``role`` is ``padding``, ``multiturn``, ``singleturn``, ``status``, ``crc``, ``parity`` or ``other``. ``active`` is
    the active level of a status bit, ``low`` or ``high``, or empty if it never changes.
    """

    name: str
    role: str
    bits: int
    active: str = ""


#: Roles in the common frame that masters expect, in the order sent. Zero bits may be on both sides of the position.
_ROLES_AS_SENT = ("before", "position", "after", "status", "crc")


def frame_parts(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> Iterator[FramePart]:
    """Yield the parts of a frame by their role for a master, in the order in which they are sent.

    Masters expect zero bits, the position, zero bits, status bits and a CRC, in this order. Bits that do not fit this
    order have the role ``parity`` or ``other``.

    Raises:
        NoRecord: No master can read the frame, because some bits have no field, other bits are sent within the
            position, or the revolutions are not the highest bits of the position.
    """
    layout = placed_layout.layout
    turn_bits = turn_bits_of_fields(placed_layout, measurement, variant)
    position_field_names = tuple(turn_bits)
    stage = "before"
    unread_bits = placed_layout.bits  # Number of bits after the fields so far.
    for field in placed_layout.fields:
        has_gap_before = field.high + 1 != unread_bits
        if has_gap_before:
            raise NoRecord(f"the bits of '{layout.name}' above '{field.name}' have no meaning in the spec")
        unread_bits = field.low
        role = _role_of_field(field, placed_layout, position_field_names, stage)
        if role == "position":
            yield from _position_parts(field, turn_bits[field.name])
        else:
            yield _part_without_position(field, role)
        stage = _next_stage(stage, role)
    if unread_bits:
        raise NoRecord(f"the last bits of '{layout.name}' have no meaning in the spec")


def _next_stage(stage: str, role: str) -> str:
    """Return the stage of the frame after a field with this role: the last role of the usual order that was reached.

    The usual order is ``before``, ``position``, ``after``, ``status``, ``crc``.
    """
    if role in _ROLES_AS_SENT:
        return role
    # After an unexpected field, later zero bits are not adjacent to the position, so they are not padding.
    return "status" if stage in ("position", "after") else stage


def _part_without_position(field: PlacedField, role: str) -> FramePart:
    """Return the frame part for a field that is not part of the position.

    The roles ``before`` and ``after`` are zero bits on either side of the position, which become ``padding``.
    """
    if role in ("before", "after"):
        return FramePart(name=field.name, role="padding", bits=field.width)
    if role == "status":
        return FramePart(name=field.name, role="status", bits=field.width, active=_active_level(field.field))
    return FramePart(name=field.name, role=role, bits=field.width)


def rough_parts(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> Iterator[FramePart]:
    """Yield the parts of a frame that no master can read, in the order in which they are sent.

    The role of a field follows only from its kind, wherever it is in the frame. If the revolutions are not the highest
    bits of the position, all of its bits are ``singleturn``.
    """
    try:
        turn_bits = turn_bits_of_fields(placed_layout, measurement, variant)
    except NoRecord:
        turn_bits = {field.name: 0 for field in _position_fields(placed_layout, measurement)}
    for field in placed_layout.fields:
        if field.name in turn_bits:
            yield from _position_parts(field, turn_bits[field.name])
            continue
        # At this stage, zero bits are padding.
        role = _expected_role(field, stage="after")
        if role == "other" and _is_parity_of_frame(field, placed_layout):
            role = "parity"
        yield _part_without_position(field, role)


def _role_of_field(
    field: PlacedField, placed_layout: PlacedLayout, position_field_names: Sequence[str], stage: str
) -> str:
    """Return the role of a field: ``before`` (zero bits), ``position``, ``after`` (zero bits), ``status``, or ``crc``.

    Masters expect the roles in this order. ``stage`` is the role that has been reached. A field that does not fit the
    order has the role ``parity`` or ``other``. ``position_field_names`` are the fields that form the position, most
    significant first.

    Raises:
        NoRecord: Other bits are sent between the fields of the position.
    """
    if field.name in position_field_names:
        if stage not in ("before", "position"):
            raise NoRecord(f"the position is not in one piece: other bits are sent before '{field.name}'")
        return "position"
    if stage == "position":
        last_position_field = position_field_names[-1]
        lowest_bit_of_position, _ = placed_layout.place_of(last_position_field)
        is_within_position = field.low > lowest_bit_of_position
        if is_within_position:
            raise NoRecord(f"the position is not in one piece: '{field.name}' is sent within it")
    role = _expected_role(field, stage)
    if stage == "before":
        possible_roles: tuple[str, ...] = ("before",)  # Only zero bits can precede the position.
    else:
        possible_roles = _ROLES_AS_SENT[_ROLES_AS_SENT.index(stage) :]
    if role in possible_roles:
        return role
    if _is_parity_of_frame(field, placed_layout):
        return "parity"
    return "other"


def _expected_role(field: PlacedField, stage: str) -> str:
    """Return the role that follows from the kind of a field outside the position.

    Zero bits are ``before`` the position if ``stage`` is ``before``, and otherwise ``after`` it. A flag, and a single
    constant or unused bit that is 1, is a status bit. All other fields except a CRC are ``other``.
    """
    kind = field.field.kind
    if isinstance(kind, CrcValue):
        return "crc"
    if isinstance(kind, (Constant, Unused)) and kind.value == 0:
        return "before" if stage == "before" else "after"
    # Constant and unused zeros are handled above.
    is_status_bit = field.width == 1 and isinstance(kind, (Flag, Constant, Unused))
    return "status" if is_status_bit else "other"


def _is_parity_of_frame(field: PlacedField, placed_layout: PlacedLayout) -> bool:
    """Return whether a field is a parity bit at the end of the frame that covers all other bits.

    Bits that are always 0 need not be covered.
    """
    kind = field.field.kind
    is_last_field = field.low == 0
    # With ``over``, the parity covers only the odd or the even bits of each field.
    if not isinstance(kind, Parity) or kind.over or not is_last_field:
        return False
    covered_names = set(kind.constants)
    for covered_item in kind.of:
        covered_names.update(placed_layout.layout.names_in(covered_item))
    other_fields = [other_field for other_field in placed_layout.fields if other_field is not field]
    return all(other_field.name in covered_names or _is_always_zero(other_field) for other_field in other_fields)


def _is_always_zero(field: PlacedField) -> bool:
    """Return whether a field consists of constant or unused bits that are 0."""
    return isinstance(field.field.kind, (Constant, Unused)) and field.field.kind.value == 0


def _position_fields(placed_layout: PlacedLayout, measurement: Measurement) -> list[PlacedField]:
    """Return the fields that form the position for the order code, most significant first."""
    return placed_layout.find_fields(placed_layout.layout.names_in(measurement.of))


def turn_bits_of_fields(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> dict[str, int]:
    """Return the number of bits that count revolutions in each field of the position, by the name of the field.

    The revolutions are the highest bits of the position, even if a field contains bits of both parts. The fields are
    sorted, most significant first.

    Raises:
        NoRecord: The revolutions are not the highest bits of the position.
    """
    fields = _position_fields(placed_layout, measurement)
    position_bits = sum(field.width for field in fields)
    remaining_turn_bits = _turn_bits(measurement, position_bits, variant)
    turn_bits_by_field: dict[str, int] = {}
    for field in fields:
        turn_bits_of_field = min(field.width, remaining_turn_bits)
        turn_bits_by_field[field.name] = turn_bits_of_field
        remaining_turn_bits -= turn_bits_of_field
    return turn_bits_by_field


def _turn_bits(measurement: Measurement, position_bits: int, variant: Variant) -> int:
    """Return how many of the highest bits of the position count revolutions.

    The result is 0 for a length, for a single revolution, and if the spec does not give the number of revolutions and
    the counts per revolution are not a power of two.

    Raises:
        NoRecord: There are several revolutions with counts that are not a power of two, so no separate bits count them.
    """
    turns = measurement.turns.value(variant.parameters) if measurement.turns is not None else None
    if measurement.counts_per_turn is None or turns == 1:
        return 0
    counts = measurement.counts_per_turn.value(variant.parameters)
    if is_power_of_two(counts):
        singleturn_bits = (counts - 1).bit_length()
        return max(position_bits - singleturn_bits, 0)
    if turns is None:
        return 0
    raise NoRecord(f"'{measurement.of}' has {counts} counts per revolution, so no bits of it are the revolutions")


def _position_parts(field: PlacedField, turn_bits: int) -> Iterator[FramePart]:
    """Yield the frame parts of a field of the position: its highest ``turn_bits`` bits, and the bits below them."""
    singleturn_bits = field.width - turn_bits
    if turn_bits:
        turns_name = f"{field.name}_turns" if singleturn_bits else field.name
        yield FramePart(name=turns_name, role="multiturn", bits=turn_bits)
    if singleturn_bits:
        yield FramePart(name=field.name, role="singleturn", bits=singleturn_bits)


def _active_level(field: Field) -> str:
    """Return the active level of a flag, ``low`` or ``high``, or an empty string for other fields."""
    if not isinstance(field.kind, Flag):
        return ""
    return "low" if field.kind.active_low else "high"


def parity_of_frame(placed_layout: PlacedLayout, frame_parts: Sequence[FramePart]) -> str:
    """Return ``odd`` or ``even`` if the frame ends with a parity bit over all of its bits, and otherwise ``none``."""
    kind = placed_layout.fields[-1].field.kind
    last_part = frame_parts[-1]
    if last_part.role != "parity" or not isinstance(kind, Parity):
        return "none"
    return "odd" if kind.is_odd else "even"


def position_coding(placed_layout: PlacedLayout, measurement: Measurement, frame_parts: Sequence[FramePart]) -> str:
    """Return the code in which the position is sent: ``binary``, ``gray``, or the name of a code of digits (``bcd``).

    It is ``gray_with_status`` if position and status bits form one number in Gray code, ``gray_excess`` if a constant
    is added to the position first, and ``other`` if a different set of bits is in Gray code.
    """
    layout = placed_layout.layout
    for placed_field in placed_layout.find_fields(layout.names_in(measurement.of)):
        if placed_field.field.kind.digit_code:
            return placed_field.field.kind.digit_code
    # With ``gray_when``, only some order codes use Gray code.
    is_binary_order_code = bool(layout.gray_when) and not placed_layout.gray
    if not layout.gray_of or is_binary_order_code:
        return "binary"
    gray_names = {field.name for field in placed_layout.find_fields(layout.names_in(layout.gray_of))}
    position_names = {field.name for field in placed_layout.find_fields(layout.names_in(measurement.of))}
    if gray_names == position_names:
        return "gray_excess" if placed_layout.gray_excess else "gray"
    status_names = {part.name for part in frame_parts if part.role == "status"}
    if gray_names == position_names | status_names:
        return "gray_with_status"
    return "other"


def _bits_of_role(frame_parts: Sequence[FramePart], role: str) -> int:
    """Return the total number of bits of all parts with this role."""
    return sum(part.bits for part in frame_parts if part.role == role)


def bit_counts(frame_parts: Sequence[FramePart]) -> dict[str, int | None]:
    """Return the numbers of bits of a frame by their names in the rules for masters: ``{"crc_bits": 6, ...}``.

    ``left`` in a name means before the position, and ``right`` means after it. ``frame_bits`` does not include the
    parity bit.
    """
    roles = ("multiturn", "singleturn", "padding", "status", "crc", "other", "parity")
    bits = {role: _bits_of_role(frame_parts, role) for role in roles}
    parts_left = _parts_before_position(frame_parts)
    padding_left = _bits_of_role(parts_left, "padding")
    other_left = _bits_of_role(parts_left, "other")
    position = bits["multiturn"] + bits["singleturn"]
    data = position + bits["padding"]
    return {
        "multiturn_bits": bits["multiturn"],
        "singleturn_bits": bits["singleturn"],
        "position_bits": position,
        "padding_left": padding_left,
        "padding_right": bits["padding"] - padding_left,
        "data_bits": data,
        "status_bits": bits["status"],
        "data_and_status_bits": data + bits["status"],
        "crc_bits": bits["crc"],
        "other_bits_left": other_left,
        "other_bits_right": bits["other"] - other_left,
        "other_bits_after_status": _bits_of_role(_parts_after_status(frame_parts), "other"),
        "parity_bits": bits["parity"],
        "bits_without_crc": data + bits["status"] + bits["other"],
        "frame_bits": data + bits["status"] + bits["crc"] + bits["other"],
    }


def _parts_before_position(frame_parts: Sequence[FramePart]) -> Sequence[FramePart]:
    """Return the parts of a frame that are sent before the position. The frame must contain the position."""
    roles = [part.role for part in frame_parts]
    first_indices = [roles.index(role) for role in ("multiturn", "singleturn") if role in roles]
    start_of_position = min(first_indices)
    return frame_parts[:start_of_position]


def _parts_after_status(frame_parts: Sequence[FramePart]) -> Sequence[FramePart]:
    """Return the parts of a frame starting with the first status bit, or an empty sequence without a status bit."""
    roles = [part.role for part in frame_parts]
    if "status" not in roles:
        return ()
    return frame_parts[roles.index("status") :]


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

    def about(self, clock_hz: int) -> str:
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


def _printed_rows(interface: Ssi, code: str) -> list[CableRow]:
    """Return the rows of the manual's table that apply to an order code, or all rows if ``code`` is empty."""
    lengths = facts_for_code(interface.cable_lengths, code) if code else interface.cable_lengths
    return [
        CableRow(metres=length.shorter_than_m, hz=length.limit_hz, is_below=length.is_exclusive, is_shorter=True)
        for length in lengths
    ]


def cable_table(device: Device, interface: Ssi | Biss, code: str = "") -> CableTable:
    """Return the table of clocks by cable length: the manual's table for SSI, and a published one for BiSS.

    If the manual gives no table, it has no rows. The rows and errata of the manual are those for the order code, or all
    if ``code`` is empty.
    """
    match interface:
        case Ssi():
            path = f"interfaces.{interface.name}.cable_lengths"
            rows = _printed_rows(interface, code)
            errata = facts_for_code(device.errata, code) if code else device.errata
            errata_names = [erratum.name for erratum in errata if path in erratum.affects]
            return CableTable(rows=tuple(rows), origin=_ORIGIN_MANUAL, errata=tuple(errata_names))
        case Biss():
            rows = [CableRow(metres=metres, hz=hz, is_below=False, is_shorter=False) for metres, hz in _BISS_CLOCKS]
            return CableTable(rows=tuple(rows), origin=_ORIGIN_PUBLIC, errata=())
        case _:
            assert_never(interface)
