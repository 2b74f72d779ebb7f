"""The ingredients of the record for a master: the parts of a frame by their role, and the clock for a cable."""

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
    Layout,
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

_ORIGIN_MANUAL, _ORIGIN_PUBLIC = "the encoder's manual", "AN15 of iC-Haus, revision A3, for RS-422"


class NoRecord(ValueError):
    """There are no master settings for this order code. The message gives the reason in one line."""


@dataclasses.dataclass(frozen=True, slots=True)
class FramePart:
    """A run of bits in the frame.

    ``role`` is ``padding``, ``multiturn``, ``singleturn``, ``status``, ``crc``, ``parity`` or ``other``.
    ``active`` of a status bit is ``low``, ``high``, or empty if it never changes.
    """

    name: str
    role: str
    bits: int
    active: str = ""


#: Roles in the common frame that masters expect, in the order sent. Zero bits may be on both sides of the position.
_ROLES_AS_SENT = ("before", "position", "after", "status", "crc")


def frame_parts(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> Iterator[FramePart]:
    """Yield the parts of the frame in the order sent. Bits that the common frame does not have there are ``other``.

    Raises:
        NoRecord: Some bits have no field, the position is not in one piece, or no bits of it are the revolutions.
    """
    layout = placed_layout.layout
    turn_bits = turn_bits_of_fields(placed_layout, measurement, variant)
    position_field_names = tuple(turn_bits)
    stage = "before"
    unread_bits = placed_layout.bits  # Number of bits below the fields so far, the first of which is the highest.
    for field in placed_layout.fields:
        if field.high + 1 != unread_bits:
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
    """Return the role in the common frame (``_ROLES_AS_SENT``) that has been reached after a field with this role."""
    if role in _ROLES_AS_SENT:
        return role
    # Zero bits after a parity bit or an unexpected field are not next to the position, so they cannot pad it.
    return "status" if stage in ("position", "after") else stage


def _part_without_position(field: PlacedField, role: str) -> FramePart:
    """Return the part for a field that is not of the position. Zero bits on both sides of the position are padding."""
    if role in ("before", "after"):
        return FramePart(name=field.name, role="padding", bits=field.width)
    if role == "status":
        return FramePart(name=field.name, role="status", bits=field.width, active=_active_level(field.field))
    return FramePart(name=field.name, role=role, bits=field.width)


def rough_parts(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> Iterator[FramePart]:
    """Yield the parts of a frame that masters cannot take, in the order sent.

    The kind of a field decides its role, wherever it is in the frame. If no bits of the position are the revolutions,
    all of them count as singleturn.
    """
    try:
        turn_bits = turn_bits_of_fields(placed_layout, measurement, variant)
    except NoRecord:
        turn_bits = {field.name: 0 for field in _position_fields(placed_layout, measurement)}
    for field in placed_layout.fields:
        if field.name in turn_bits:
            yield from _position_parts(field, turn_bits[field.name])
            continue
        # With this stage, zero bits are "after", which also counts as padding.
        role = _expected_role(field, stage="after")
        if role == "other" and _is_parity_of_frame(field, placed_layout):
            role = "parity"
        yield _part_without_position(field, role)


def _role_of_field(
    field: PlacedField, placed_layout: PlacedLayout, position_field_names: Sequence[str], stage: str
) -> str:
    """Return the role of a field, with ``before`` and ``after`` for zero bits.

    ``stage`` is the last role of the common frame that has been reached. A field that the common frame cannot have
    from there on is ``parity`` or ``other``.

    Raises:
        NoRecord: The position is not in one piece.
    """
    if field.name in position_field_names:
        if stage not in ("before", "position"):
            raise NoRecord(f"the position is not in one piece: other bits are sent before '{field.name}'")
        return "position"
    # The last field of the position has not been sent yet.
    if stage == "position":
        lowest_bit_of_position, _ = placed_layout.place_of(position_field_names[-1])
        if field.low > lowest_bit_of_position:
            raise NoRecord(f"the position is not in one piece: '{field.name}' is sent within it")
    role = _expected_role(field, stage)
    roles_from_stage = _ROLES_AS_SENT[_ROLES_AS_SENT.index(stage) :]
    # Before the position, the common frame has only zero bits.
    may_come_now = role == "before" if stage == "before" else role in roles_from_stage
    if may_come_now:
        return role
    if _is_parity_of_frame(field, placed_layout):
        return "parity"
    return "other"


def _expected_role(field: PlacedField, stage: str) -> str:
    """Return the role of a field that is not part of the position, from its kind.

    Zero bits are ``before`` or ``after`` the position, as ``stage`` says. A status bit is a flag, or a single constant
    or unused bit that is 1. All others are ``other``.
    """
    kind = field.field.kind
    if isinstance(kind, CrcValue):
        return "crc"
    if isinstance(kind, (Constant, Unused)) and kind.value == 0:
        return "before" if stage == "before" else "after"
    # A constant or unused bit is 1 here, since zeros have been handled above.
    is_status_bit = field.width == 1 and isinstance(kind, (Flag, Constant, Unused))
    return "status" if is_status_bit else "other"


def _is_parity_of_frame(field: PlacedField, placed_layout: PlacedLayout) -> bool:
    """Return whether a field is the last field, and a parity bit over all other bits that are not always 0."""
    kind = field.field.kind
    # ``over`` limits the parity to some bits of the fields. The last field has its lowest bit at 0.
    if not isinstance(kind, Parity) or kind.over or field.low:
        return False
    covered_names = set(kind.constants)
    for covered_item in kind.of:
        covered_names.update(placed_layout.layout.names_in(covered_item))
    other_fields = [other_field for other_field in placed_layout.fields if other_field is not field]
    return all(other_field.name in covered_names or _is_always_zero(other_field) for other_field in other_fields)


def _is_always_zero(field: PlacedField) -> bool:
    return isinstance(field.field.kind, (Constant, Unused)) and field.field.kind.value == 0


def _position_fields(placed_layout: PlacedLayout, measurement: Measurement) -> list[PlacedField]:
    """Return the fields of the position that exist for the order code, the most significant field first."""
    return placed_layout.find_fields(placed_layout.layout.names_in(measurement.of))


def turn_bits_of_fields(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> dict[str, int]:
    """Return the number of bits that count revolutions in each field of the position, the most significant field first.

    These are the highest bits of the position, even if one of the fields is only partly revolutions.

    Raises:
        NoRecord: No bits of the position are the revolutions.
    """
    fields = _position_fields(placed_layout, measurement)
    turn_bits_left = _turn_bits(measurement, sum(field.width for field in fields), variant)
    turn_bits: dict[str, int] = {}
    for field in fields:
        turn_bits[field.name] = min(field.width, turn_bits_left)
        turn_bits_left -= turn_bits[field.name]
    return turn_bits


def _turn_bits(measurement: Measurement, position_bits: int, variant: Variant) -> int:
    """Return how many of the highest bits of the position count revolutions, or 0 if none do or it is not known.

    No bits count revolutions in a measurement of length, which has no counts per revolution, and in one of a single
    revolution. It is not known if the counts are not a power of two and the number of revolutions is not stated.

    Raises:
        NoRecord: There are several revolutions, of counts that are not a power of two, so no bits are the revolutions.
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
    """Yield the part of a field of the position, or two parts if only its highest bits are revolutions."""
    singleturn_bits = field.width - turn_bits
    if turn_bits:
        turns_name = f"{field.name}_turns" if singleturn_bits else field.name
        yield FramePart(name=turns_name, role="multiturn", bits=turn_bits)
    if singleturn_bits:
        yield FramePart(name=field.name, role="singleturn", bits=singleturn_bits)


def _active_level(field: Field) -> str:
    """Return the level at which a flag is active, ``low`` or ``high``, or an empty string for other fields."""
    if not isinstance(field.kind, Flag):
        return ""
    return "low" if field.kind.active_low else "high"


def parity_of_frame(placed_layout: PlacedLayout, frame_parts: Sequence[FramePart]) -> str:
    """Return ``odd`` or ``even`` for a frame that ends in a parity bit over the whole of it, or else ``none``."""
    kind = placed_layout.fields[-1].field.kind
    if frame_parts[-1].role != "parity" or not isinstance(kind, Parity):
        return "none"
    return "odd" if kind.odd else "even"


def position_coding(placed_layout: PlacedLayout, measurement: Measurement, frame_parts: Sequence[FramePart]) -> str:
    """Return the code of the position: ``binary``, ``gray``, or a variety of Gray code.

    It is ``gray_with_status`` if the bits in Gray code are the position and all status bits, ``gray_excess`` if
    position 0 is sent as another number, and ``other`` if other bits are in Gray code.
    """
    layout: Layout = placed_layout.layout
    if not layout.gray_of or (layout.gray_when and not placed_layout.gray):
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
    return sum(part.bits for part in frame_parts if part.role == role)


def bit_counts(frame_parts: Sequence[FramePart]) -> dict[str, int | None]:
    """Return the numbers of bits of a frame by the names of the items for rules: ``{"crc_bits": 6, ...}``.

    ``left`` in a name means bits sent before the position, and ``right`` means bits sent after it. ``frame_bits``
    leaves out the parity bit.
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
    """Return the parts that are sent before the position, which every frame of a record has."""
    roles = [part.role for part in frame_parts]
    first_indices = [roles.index(role) for role in ("multiturn", "singleturn") if role in roles]
    return frame_parts[: min(first_indices)]


def _parts_after_status(frame_parts: Sequence[FramePart]) -> Sequence[FramePart]:
    """Return the parts from the first status bit on, or none without a status bit."""
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
    """A row of a table.

    With ``is_below``, cable and clock must be below ``metres`` and ``hz``, else at most equal to them.
    """

    metres: int
    hz: int
    is_below: bool

    @property
    def cable(self) -> str:
        limit_words = "shorter than" if self.is_below else "up to"
        return f"{limit_words} {self.metres} m"

    @property
    def text(self) -> str:
        clock_text = f"below {hertz(self.hz)}" if self.is_below else hertz(self.hz)
        return f"{self.cable}: {clock_text}"

    @property
    def highest_hz(self) -> int:
        return self.hz - 1 if self.is_below else self.hz

    def includes(self, metres: int) -> bool:
        """Return whether the row is valid for this cable length."""
        if self.is_below:
            return metres < self.metres
        return metres <= self.metres


@dataclass(frozen=True, slots=True)
class CableTable:
    """The rows, their origin in words, and the names of the errata about them."""

    rows: tuple[CableRow, ...]
    origin: str
    errata: tuple[str, ...]

    def row_of(self, metres: int) -> CableRow | None:
        """Return the row with the fastest clock for this cable length, or None if it exceeds the table."""
        rows_for_length = [row for row in self.rows if row.includes(metres)]
        return max(rows_for_length, key=lambda row: row.hz, default=None)

    def about(self, clock_hz: int) -> str:
        """Return a sentence about the longest cable that allows a clock, or that none does, or "" without a table."""
        if not self.rows:
            return ""
        rows_with_clock = [row for row in self.rows if clock_hz <= row.highest_hz]
        if rows_with_clock:
            longest_row = max(rows_with_clock, key=lambda row: row.metres)
            return f"For a cable {longest_row.cable}, according to the table in {self.origin}."
        fastest_row = max(self.rows, key=lambda row: row.hz)
        limit_words = "below" if fastest_row.is_below else "of at most"
        limit = f"{limit_words} {hertz(fastest_row.hz)}"
        reason = f"a cable {fastest_row.cable} needs a clock {limit}, and a longer one needs a lower clock"
        return f"According to the table in {self.origin}, no cable allows this clock: {reason}."


def _printed_rows(interface: Ssi, code: str) -> list[CableRow]:
    """Return the rows of the table in the manual that apply to an order code, or all rows without an order code."""
    lengths = facts_for_code(interface.cable_lengths, code) if code else interface.cable_lengths
    return [CableRow(metres=length.shorter_than_m, hz=length.below_hz, is_below=True) for length in lengths]


def cable_table(device: Device, interface: Ssi | Biss, code: str = "") -> CableTable:
    """Return the table for an interface: a public table for BiSS, the manual's table for SSI, which may have no rows.

    The rows and errata of a manual's table are the rows and errata for the order code, or all without an order code.
    """
    match interface:
        case Ssi():
            path = f"interfaces.{interface.name}.cable_lengths"
            rows = _printed_rows(interface, code)
            errata = facts_for_code(device.errata, code) if code else device.errata
            errata_names = [erratum.name for erratum in errata if path in erratum.affects]
            return CableTable(rows=tuple(rows), origin=_ORIGIN_MANUAL, errata=tuple(errata_names))
        case Biss():
            rows = [CableRow(metres=metres, hz=hz, is_below=False) for metres, hz in _BISS_CLOCKS]
            return CableTable(rows=tuple(rows), origin=_ORIGIN_PUBLIC, errata=())
        case _:
            assert_never(interface)
