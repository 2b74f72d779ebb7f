"""Parts of a frame by their role for a master, their sizes, and those that a master's description does not cover."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..language.keys_of_masters import NUMBERS
from ..language.problems import join_words
from ..model import (
    Constant,
    CrcValue,
    Field,
    Flag,
    Measurement,
    Parity,
    PlacedField,
    PlacedLayout,
    Unused,
    Variant,
)
from ..model.expressions import Expression, is_power_of_two


class NoMasterSettings(ValueError):
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
        NoMasterSettings: No master can read the frame, because some bits have no field, other bits are sent within the
            position, or the revolutions are not the highest bits of the position.
    """
    layout = placed_layout.layout
    turn_bits_by_field = turn_bits_of_fields(placed_layout, measurement, variant)
    position_field_names = tuple(turn_bits_by_field)
    stage = "before"
    unread_bit_count = placed_layout.bits  # Number of bits after the fields so far.
    for field in placed_layout.fields:
        has_gap_before = field.highest_bit + 1 != unread_bit_count
        if has_gap_before:
            raise NoMasterSettings(f"the bits of '{layout.name}' above '{field.name}' have no meaning in the spec")
        unread_bit_count = field.lowest_bit
        role = _role_of_field(field, placed_layout, position_field_names, stage)
        if role == "position":
            yield from _position_parts(field, turn_bits_by_field[field.name])
        else:
            yield _part_without_position(field, role)
        stage = _next_stage(stage, role)
    if unread_bit_count:
        raise NoMasterSettings(f"the last bits of '{layout.name}' have no meaning in the spec")


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
    except NoMasterSettings:
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
        NoMasterSettings: Other bits are sent between the fields of the position.
    """
    if field.name in position_field_names:
        if stage not in ("before", "position"):
            raise NoMasterSettings(f"the position is not in one piece: other bits are sent before '{field.name}'")
        return "position"
    if stage == "position":
        last_position_field = position_field_names[-1]
        lowest_position_bit, _ = placed_layout.lowest_bit_and_width_of(last_position_field)
        is_within_position = field.lowest_bit > lowest_position_bit
        if is_within_position:
            raise NoMasterSettings(f"the position is not in one piece: '{field.name}' is sent within it")
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
    field_kind = field.field.kind
    if isinstance(field_kind, CrcValue):
        return "crc"
    if isinstance(field_kind, (Constant, Unused)) and field_kind.value == 0:
        return "before" if stage == "before" else "after"
    # Constant and unused zeros are handled above.
    is_status_bit = field.width == 1 and isinstance(field_kind, (Flag, Constant, Unused))
    return "status" if is_status_bit else "other"


def _is_parity_of_frame(field: PlacedField, placed_layout: PlacedLayout) -> bool:
    """Return whether a field is a parity bit at the end of the frame that covers all other bits.

    Bits that are always 0 need not be covered.
    """
    field_kind = field.field.kind
    is_last_field = field.lowest_bit == 0
    # With ``over``, the parity covers only the odd or the even bits of each field.
    if not isinstance(field_kind, Parity) or field_kind.over or not is_last_field:
        return False
    covered_names = set(field_kind.constants)
    for covered_item in field_kind.of:
        covered_names.update(placed_layout.layout.field_names_of(covered_item))
    other_fields = [other_field for other_field in placed_layout.fields if other_field is not field]
    return all(other_field.name in covered_names or _is_always_zero(other_field) for other_field in other_fields)


def _is_always_zero(field: PlacedField) -> bool:
    """Return whether a field consists of constant or unused bits that are 0."""
    return isinstance(field.field.kind, (Constant, Unused)) and field.field.kind.value == 0


def _position_fields(placed_layout: PlacedLayout, measurement: Measurement) -> list[PlacedField]:
    """Return the fields that form the position for the order code, most significant first."""
    return placed_layout.find_fields(placed_layout.layout.field_names_of(measurement.position_name))


def turn_bits_of_fields(placed_layout: PlacedLayout, measurement: Measurement, variant: Variant) -> dict[str, int]:
    """Return the number of bits that count revolutions in each field of the position, by the name of the field.

    The revolutions are the highest bits of the position, even if a field contains bits of both parts. The fields are
    sorted, most significant first.

    Raises:
        NoMasterSettings: The revolutions are not the highest bits of the position.
    """
    fields = _position_fields(placed_layout, measurement)
    position_width = sum(field.width for field in fields)
    remaining_turn_bits = _turn_bit_count(measurement, position_width, variant)
    turn_bits_by_field: dict[str, int] = {}
    for field in fields:
        turn_bits_of_field = min(field.width, remaining_turn_bits)
        turn_bits_by_field[field.name] = turn_bits_of_field
        remaining_turn_bits -= turn_bits_of_field
    return turn_bits_by_field


def _turn_bit_count(measurement: Measurement, position_width: int, variant: Variant) -> int:
    """Return how many of the highest bits of the position count revolutions.

    The result is 0 for a length, for a single revolution, and if the spec does not give the number of revolutions and
    the counts per revolution are not a power of two.

    Raises:
        NoMasterSettings: There are several revolutions with counts that are not a power of two, so no
            separate bits count them.
    """
    turns = measurement.turns.value(variant.parameters) if measurement.turns is not None else None
    if measurement.counts_per_turn is None or turns == 1:
        return 0
    counts_per_turn = measurement.counts_per_turn.value(variant.parameters)
    if is_power_of_two(counts_per_turn):
        singleturn_bits = (counts_per_turn - 1).bit_length()
        return max(position_width - singleturn_bits, 0)
    if turns is None:
        return 0
    raise NoMasterSettings(
        f"'{measurement.position_name}' has {counts_per_turn} counts per revolution, so no bits of it are the "
        "revolutions"
    )


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
    kind_of_last_field = placed_layout.fields[-1].field.kind
    last_part = frame_parts[-1]
    if last_part.role != "parity" or not isinstance(kind_of_last_field, Parity):
        return "none"
    return "odd" if kind_of_last_field.is_odd else "even"


def position_coding(placed_layout: PlacedLayout, measurement: Measurement, frame_parts: Sequence[FramePart]) -> str:
    """Return the code in which the position is sent: ``binary``, ``gray``, or the name of a code of digits (``bcd``).

    It is ``gray_with_status`` if position and status bits form one number in Gray code, ``gray_excess`` if a constant
    is added to the position first, and ``other`` if a different set of bits is in Gray code.
    """
    layout = placed_layout.layout
    position_fields = _position_fields(placed_layout, measurement)
    for position_field in position_fields:
        if position_field.field.kind.digit_code:
            return position_field.field.kind.digit_code
    # With ``gray_when``, only some order codes use Gray code.
    is_binary_order_code = bool(layout.gray_when) and not placed_layout.gray
    if not layout.gray_of or is_binary_order_code:
        return "binary"
    gray_names = {field.name for field in placed_layout.find_fields(layout.field_names_of(layout.gray_of))}
    position_names = {field.name for field in position_fields}
    if gray_names == position_names:
        return "gray_excess" if placed_layout.gray_excess else "gray"
    status_names = {part.name for part in frame_parts if part.role == "status"}
    if gray_names == position_names | status_names:
        return "gray_with_status"
    return "other"


def _bit_count_of_role(frame_parts: Sequence[FramePart], role: str) -> int:
    """Return the total number of bits of all parts with this role."""
    return sum(part.bits for part in frame_parts if part.role == role)


def bit_counts(frame_parts: Sequence[FramePart]) -> dict[str, int | None]:
    """Return the numbers of bits of a frame by their names in the rules for masters: ``{"crc_bits": 6, ...}``.

    ``left`` in a name means before the position, and ``right`` means after it. ``frame_bits`` does not include the
    parity bit.
    """
    roles = ("multiturn", "singleturn", "padding", "status", "crc", "other", "parity")
    bit_count_by_role = {role: _bit_count_of_role(frame_parts, role) for role in roles}
    parts_left = _parts_before_position(frame_parts)
    padding_left = _bit_count_of_role(parts_left, "padding")
    other_left = _bit_count_of_role(parts_left, "other")
    position_bits = bit_count_by_role["multiturn"] + bit_count_by_role["singleturn"]
    data_bits = position_bits + bit_count_by_role["padding"]
    return {
        "multiturn_bits": bit_count_by_role["multiturn"],
        "singleturn_bits": bit_count_by_role["singleturn"],
        "position_bits": position_bits,
        "padding_left": padding_left,
        "padding_right": bit_count_by_role["padding"] - padding_left,
        "data_bits": data_bits,
        "status_bits": bit_count_by_role["status"],
        "data_and_status_bits": data_bits + bit_count_by_role["status"],
        "crc_bits": bit_count_by_role["crc"],
        "other_bits_left": other_left,
        "other_bits_right": bit_count_by_role["other"] - other_left,
        "other_bits_after_status": _bit_count_of_role(_parts_after_status(frame_parts), "other"),
        "parity_bits": bit_count_by_role["parity"],
        "bits_without_crc": data_bits + bit_count_by_role["status"] + bit_count_by_role["other"],
        "frame_bits": data_bits + bit_count_by_role["status"] + bit_count_by_role["crc"] + bit_count_by_role["other"],
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


#: Names of facts about the computation of the CRC, such as ``crc_polynomial``.
_FACTS_ABOUT_CRC = {name for name in NUMBERS if name.startswith("crc_")} - {"crc_bits"}
#: Names of facts that do not depend on other bits of the frame.
_FACTS_OF_ANY_FRAME = {
    "multiturn_bits",
    "singleturn_bits",
    "position_bits",
    "status_bits",
    *_FACTS_ABOUT_CRC,
    "crc_bits",
}
#: Names of facts that count bits of the frame, such as ``data_bits``, ``padding_left`` and ``other_bits_right``.
_FACTS_ABOUT_BITS = {name for name in NUMBERS if name.endswith("_bits") or "padding" in name or "bits_" in name}


def depends_on_crc(rules: Any) -> bool:
    """Return whether any rule of a master depends on the parameters of the CRC, such as its polynomial."""
    return not _FACTS_ABOUT_CRC.isdisjoint(_mentioned_facts(rules))


def depends_on_whole_frame(rule: Mapping[str, Any]) -> bool:
    """Return whether parts of the frame that a master's description does not cover can change the value of a setting.

    They cannot if the value depends on no number of bits, or only on one that is independent of the other bits, such as
    ``position_bits``.
    """
    describes_every_part = "string" in rule
    if describes_every_part:
        return True
    facts_in_value = _mentioned_facts({key: rule[key] for key in ("value", "choice") if key in rule})
    # Names in braces, such as "{data_bits}".
    facts_in_text = set(re.findall(r"\{(\w+)\}", rule.get("text", "")))
    facts_about_bits = _FACTS_ABOUT_BITS & (facts_in_value | facts_in_text)
    has_several_facts = len(facts_about_bits) > 1
    return has_several_facts or not facts_about_bits <= _FACTS_OF_ANY_FRAME


def uncovered_parts(rules: Any, frame_parts: Sequence[FramePart]) -> str:
    """Return a text with the unusual parts of the frame that a master's description does not cover.

    The text, such as ``'parity' and 'reserved'``, is empty if there are none. Unusual parts are parity bits and bits
    with the role ``other``. The description covers one if one of its ``rules`` depends on the number of its bits.
    """
    parts_and_facts = zip(frame_parts, _facts_counting_parts(frame_parts), strict=True)
    # For usual parts, the name of the fact is empty.
    fact_by_uncommon_part = {part.name: fact for part, fact in parts_and_facts if fact}
    if not fact_by_uncommon_part:
        return ""
    covered_names = covered_facts(rules)
    uncovered_names = [name for name, fact in fact_by_uncommon_part.items() if fact not in covered_names]
    return join_words(f"'{name}'" for name in uncovered_names)


def covered_facts(rules: Any) -> set[str]:
    """Return the names of the facts about an encoder that the rules of a master cover: ``{"crc_bits", "coding"}``."""
    fact_names = _mentioned_facts(rules)
    # A rule that depends on the kind of parity also covers the parity bit.
    if "parity" in fact_names:
        fact_names.add("parity_bits")
    return fact_names


def _facts_counting_parts(frame_parts: Sequence[FramePart]) -> Iterator[str]:
    """Yield for each part of a frame the name of the fact that counts its bits, such as ``parity_bits``.

    For usual parts, which every master can read, the name is empty.
    """
    is_after_position = False
    for part in frame_parts:
        if part.role in ("multiturn", "singleturn"):
            is_after_position = True
        if part.role == "other":
            yield "other_bits_right" if is_after_position else "other_bits_left"
        elif part.role == "parity":
            yield "parity_bits"
        else:
            yield ""


def _mentioned_facts(rule: Any) -> set[str]:
    """Return the names of the facts about an encoder on which rules depend: ``{"crc_bits", "coding"}``.

    ``rule`` is a rule, a list of rules, or any part of one. The names are the values of the keys ``item`` and ``of``,
    and the parameters of expressions under ``value``, at any depth.
    """
    fact_names: set[str] = set()
    if rule is None or isinstance(rule, (str, bool, int)):
        return fact_names  # Most calls are for plain values, and the test for Mapping is slow.
    if isinstance(rule, (list, tuple)):
        for part_of_rule in rule:
            fact_names |= _mentioned_facts(part_of_rule)
    elif isinstance(rule, Mapping):
        fact_names |= _mentioned_facts(tuple(rule.values()))
        fact_names |= {str(rule[key]) for key in ("item", "of") if key in rule}
        if isinstance(rule.get("value"), str):
            fact_names |= set(Expression.parse(rule["value"]).parameters)
    return fact_names
