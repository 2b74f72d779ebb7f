"""Layouts: sequences of named fields, and the CRCs at their ends.

Bit 0 is the least significant bit everywhere. A number of several bytes is one integer in the layout's byte order.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from enum import Enum
from functools import cached_property
from types import MappingProxyType

from .expressions import Expression
from .fields import Combination, Field, Join, PlacedField, Sign, sign_of_combination, signs_of_values
from .kinds import CrcValue, Flag, Kind, Parity, Unused, Verdict
from .manual import Sources
from .measurement import LayoutRange
from .record import dataclass, member_named


@dataclass(frozen=True)
class Layout:
    """A sequence of named fields: a frame or a register.

    It is sent either ``in_bytes``, with the ``byte_order`` ``low_byte_first`` or ``high_byte_first``, or as bits, most
    significant first. ``fields`` are in transmission order for frames, and start at the most significant bit for
    registers. ``selector`` is the field that identifies the frame, by the values ``selects``. The field or join
    ``gray_of`` is sent in Gray code, always or while the parameter ``gray_when`` is not 0. ``gray_excess`` is the
    number in Gray code for position 0, if it is not 0. ``channel`` is the BiSS data channel if there are several.
    ``position_range`` is the range of its position if it differs from the range of the interface.
    """

    name: str
    printed_name: str
    sender: str
    in_bytes: bool
    byte_order: str
    bits: Expression
    widest: int
    fields: tuple[Field, ...]
    joins: tuple[Join, ...]
    selector: str
    selects: tuple[int, ...]
    gaps: str
    note: str
    source: Sources
    gray_of: str = ""
    gray_when: str = ""
    gray_excess: Expression | None = None
    channel: int | None = None
    combinations: tuple[Combination, ...] = ()
    position_range: LayoutRange | None = None

    def field(self, name: str) -> Field:
        """Return the field with this name, or raise a ``LookupError``."""
        return member_named(self.fields, name, f"field of '{self.name}'")

    @property
    def has_optional_flags(self) -> bool:
        """True if some order codes lack one of its flags."""
        return any(isinstance(field.kind, Flag) and not field.width.is_constant for field in self.fields)

    def find_field(self, name: str) -> Field | None:
        """Return the field with this name, or None if the layout has none."""
        return next((field for field in self.fields if field.name == name), None)

    def find_fields(self, names: Iterable[str]) -> list[Field]:
        """Return the fields with these names that exist in the layout, in the same order."""
        return [field for field in map(self.find_field, names) if field is not None]

    def field_names_of(self, field_or_join: str) -> tuple[str, ...]:
        """Return the names of the fields of a join, most significant first. For a field, this is its own name."""
        return next((join.fields for join in self.joins if join.name == field_or_join), (field_or_join,))

    @cached_property
    def member_names(self) -> frozenset[str]:
        """Names of its fields and joins."""
        field_names = {field.name for field in self.fields}
        return frozenset(field_names.union(join.name for join in self.joins))

    @property
    def carried_as(self) -> str:
        """Keyword in the spec language for ``in_bytes``."""
        return "bytes" if self.in_bytes else "bits"

    @property
    def sent_bits(self) -> Expression:
        """Number of bits on the line, without the zeros that fill the first byte."""
        return self.bits - sum((field.width for field in self.fields if field.fills_byte), Expression(0))

    @property
    def data_fields(self) -> tuple[Field, ...]:
        return tuple(field for field in self.fields if field.carries_data)

    @property
    def spoiling_flags(self) -> tuple[Field, ...]:
        """Flags that make the position in this frame unusable while they are active.

        A flag that only combines other flags of this frame (``sums_up``) is left out, because it is active only
        together with one of them. Flags that the encoder does not implement are left out, too.
        """
        field_names = {field.name for field in self.fields}
        spoiling_flags = []
        for flag_field in self.fields:
            flag = flag_field.kind
            if isinstance(flag, Flag) and flag_field.implemented and flag.makes_position is Verdict.NOT_USABLE:
                only_combines = bool(flag.sums_up) and field_names.issuperset(flag.sums_up)
                if not only_combines:
                    spoiling_flags.append(flag_field)
        return tuple(spoiling_flags)

    @property
    def unused(self) -> tuple[tuple[Field, int], ...]:
        """Fields with unused bits, lowest first, each with the position of its lowest bit in the number ``unused``.

        Decoders return all unused bits of a frame as this number. For bytes, it has one byte for each byte of the frame
        with unused bits, and every bit keeps its position in the byte. For words, or if the order code moves fields,
        the fields are adjacent.
        """
        unused_fields = [field for field in self.fields if isinstance(field.kind, Unused)]
        are_fixed = all(field.low.is_constant and field.width.is_constant for field in unused_fields)
        if self.in_bytes and are_fixed:
            return _pack_by_byte(unused_fields)
        # In a word, the field sent last is the lowest. In bytes with the low byte first, it is the field sent first.
        lowest_first = unused_fields if self.byte_order == "low_byte_first" else unused_fields[::-1]
        return _pack_by_bit(lowest_first)

    @cached_property
    def has_unused(self) -> bool:
        return any(isinstance(field.kind, Unused) for field in self.fields)

    @property
    def unused_width(self) -> int:
        """Number of bits in the decoder's number ``unused``, with the widest form of each field."""
        return max((low_bit + field.widest for field, low_bit in self.unused), default=0)

    @property
    def status_fields(self) -> tuple[Field, ...]:
        """Bits for error and warning: flags, and unused status bits, which are never active and therefore always 1."""
        return tuple(filter(_is_status, self.fields))

    @cached_property
    def judging_fields(self) -> tuple[Field, ...]:
        """Fields that show in every frame whether the position is usable.

        These are flags, and fields with named values or combinations, whose verdict is not *usable* while they are
        active. They must apply to all order codes that have the field.
        """
        judging_names = {field.name for field in self.fields if _is_flag_with_verdict(field.kind)}
        for sign in self.signs:
            if _is_flag_with_verdict(sign.flag.kind):
                # All fields of a combination of values have the same widths for all order codes, so one is enough.
                first_field_name, _ = sign.conditions[0]
                judging_names.add(first_field_name)
        return tuple(field for field in self.fields if field.name in judging_names)

    @cached_property
    def judges_if_positive(self) -> Expression:
        """Expression that is positive for order codes whose frames show whether the position is usable, otherwise 0.

        A field that shows it has the width 0 for order codes without it. If such a field has a constant width, all
        order codes have it, and the expression is 1. Otherwise it is the sum of the different widths.
        """
        # Each width once. A dict keeps their order, which a set does not.
        widths = {field.width: None for field in self.judging_fields}
        if any(width.is_constant for width in widths):
            return Expression(1)
        return sum(widths, Expression(0))

    @property
    def judges_position(self) -> bool:
        """True if at least for some order codes, every frame says whether the position is usable."""
        return self.judges_if_positive != Expression(0)

    def with_unknown_verdicts(self) -> Layout:
        """Return the layout with the verdict UNKNOWN, instead of a warning, while reserved bits have another value."""
        return replace(self, fields=tuple(map(_with_unknown_verdict_if_reserved, self.fields)))

    @cached_property
    def signs(self) -> tuple[Sign, ...]:
        """Named values and combinations with a verdict on the position, each in the form of a flag."""
        signs: list[Sign] = []
        for layout_field in self.fields:
            signs += signs_of_values(layout_field)
        signs += [sign_of_combination(combination, self.fields) for combination in self.combinations]
        return tuple(signs)

    @cached_property
    def crc_fields(self) -> tuple[Field, ...]:
        """CRCs at the end. If there are several, each order code has at most one."""
        return tuple(field for field in self.fields if isinstance(field.kind, CrcValue))

    @property
    def always_has_crc(self) -> bool:
        """True if the frames of all order codes end with the same CRC."""
        return any(field.width.is_constant for field in self.crc_fields)

    @property
    def crc_covers_bytes(self) -> bool:
        """True if the CRC at the end covers whole bytes, and not the bits of a frame of bits in bytes."""
        return self.in_bytes and all(field.widest % 8 == 0 for field in self.crc_fields)

    @cached_property
    def exchanged_bytes(self) -> tuple[tuple[int, int], ...]:
        """First byte of each field with a byte order of its own, and the byte after it, in sending order."""
        byte_ranges: list[tuple[int, int]] = []
        for exchanged_field in self.fields:
            if exchanged_field.byte_order:
                byte_indices = [bit_slice.byte for bit_slice in exchanged_field.bit_slices]
                byte_ranges.append((min(byte_indices), max(byte_indices) + 1))
        return tuple(byte_ranges)

    @property
    def lowest_bits_of_bytes(self) -> list[int]:
        """Lowest bit of each byte in the number that the frame forms, in sending order."""
        lowest_bits = list(range(0, self.widest, 8))
        if self.byte_order != "low_byte_first":
            lowest_bits.reverse()
        for start, stop in self.exchanged_bytes:
            lowest_bits[start:stop] = reversed(lowest_bits[start:stop])
        return lowest_bits

    def exchange_bytes(self, data: bytes) -> bytes:
        """Return a frame with the bytes of each field that has a byte order of its own in reverse order."""
        for start, stop in self.exchanged_bytes:
            data = data[:start] + data[start:stop][::-1] + data[stop:]
        return data

    @property
    def is_converted(self) -> bool:
        """True if some bits are not binary numbers: those in Gray code, and digits that are sent separately."""
        return bool(self.gray_of) or any(field.kind.digit_code for field in self.fields)

    @property
    def has_parity(self) -> bool:
        return any(isinstance(field.kind, Parity) for field in self.fields)

    def is_sent(self, parameters: Mapping[str, int]) -> bool:
        """Return whether a frame has any bits. A layout without bits is absent for these parameters."""
        return self.bits.value(parameters) > 0

    def place(self, parameters: Mapping[str, int]) -> PlacedLayout:
        """Return the layout with numbers as positions, for an order code with these parameters.

        Fields without bits for the order code are left out. A flag that the manual explains only for other order codes
        becomes an unexplained flag.
        """
        placed_fields = (field.place(parameters) for field in self.fields)
        placed_field_by_name = {field.name: field for field in placed_fields if field.width > 0}
        is_gray_enabled = not self.gray_when or bool(parameters.get(self.gray_when))
        unused_fields_with_bits: list[tuple[PlacedField, int]] = []
        for unused_field, low_bit in self.unused:
            if unused_field.name in placed_field_by_name:
                unused_fields_with_bits.append((placed_field_by_name[unused_field.name], low_bit))
        return PlacedLayout(
            layout=self,
            bits=self.bits.value(parameters),
            fields=tuple(placed_field_by_name.values()),
            gray=bool(self.gray_of) and is_gray_enabled,
            unused=tuple(unused_fields_with_bits),
            parameters=parameters,
        )


def _pack_by_byte(fields: Sequence[Field]) -> tuple[tuple[Field, int], ...]:
    """Return fields with fixed bits, lowest first, each with its lowest bit in a number of the bytes that they occupy.

    With unused bits 3 and 17 of a frame, the bytes 0 and 2 are occupied, and the bits have the positions 3 and 9.
    """
    lowest_first = sorted(fields, key=lambda field: field.low.constant)
    occupied_bytes: set[int] = set()
    for unused_field in lowest_first:
        low_bit = unused_field.low.constant
        high_bit = low_bit + unused_field.widest - 1
        occupied_bytes.update(range(low_bit // 8, high_bit // 8 + 1))
    packed_index_by_byte = {byte_index: index for index, byte_index in enumerate(sorted(occupied_bytes))}
    packed_fields = []
    for unused_field in lowest_first:
        byte_index, bit_in_byte = divmod(unused_field.low.constant, 8)
        packed_fields.append((unused_field, 8 * packed_index_by_byte[byte_index] + bit_in_byte))
    return tuple(packed_fields)


def _pack_by_bit(lowest_first: Iterable[Field]) -> tuple[tuple[Field, int], ...]:
    """Return the fields, each with its lowest bit in a number in which they are adjacent, in their widest form."""
    packed_fields = []
    low_bit = 0
    for unused_field in lowest_first:
        packed_fields.append((unused_field, low_bit))
        low_bit += unused_field.widest
    return tuple(packed_fields)


@dataclass(frozen=True)
class PlacedLayout:
    """A layout whose positions are numbers. If ``gray`` is set, the number ``layout.gray_of`` is sent in Gray code.

    ``unused`` lists the unused fields for the order code, each with its position as in ``layout.unused``.
    """

    layout: Layout
    bits: int
    fields: tuple[PlacedField, ...]
    gray: bool = False
    unused: tuple[tuple[PlacedField, int], ...] = ()
    parameters: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}), compare=False)

    @property
    def name(self) -> str:
        return self.layout.name

    @property
    def gray_excess(self) -> int:
        """Number that is sent in Gray code for position 0."""
        excess = self.layout.gray_excess
        return excess.value(self.parameters) if self.gray and excess is not None else 0

    def field(self, name: str) -> PlacedField:
        """Return the field with this name, or raise a ``LookupError``."""
        return member_named(self.fields, name, f"field of '{self.name}'")

    def find_field(self, name: str) -> PlacedField | None:
        """Return the field with this name, or None if the order code or the layout has none."""
        for placed_field in self.fields:  # a generator takes twice as long, and decode - calls this for every line
            if placed_field.field.name == name:
                return placed_field
        return None

    def find_fields(self, names: Iterable[str]) -> list[PlacedField]:
        """Return the fields with these names that exist for the order code, in the same order."""
        return [field for field in map(self.find_field, names) if field is not None]

    @property
    def spoiling_flags(self) -> tuple[Field, ...]:
        """Flags of the order code that make the position unusable, except those that only combine other flags."""
        return tuple(flag for flag in self.layout.spoiling_flags if self.find_field(flag.name) is not None)

    @cached_property
    def judges_position(self) -> bool:
        """True if every frame of the order code says whether the position is usable."""
        return self.layout.judges_if_positive.value(self.parameters) > 0

    @property
    def has_parity(self) -> bool:
        """True if frames of the order code have a parity bit."""
        return any(isinstance(placed_field.field.kind, Parity) for placed_field in self.fields)

    @cached_property
    def crc_field(self) -> PlacedField | None:
        """CRC at the end of the frames of the order code."""
        return next((field for field in self.fields if isinstance(field.field.kind, CrcValue)), None)

    @cached_property
    def covered_lowest_bit_and_width(self) -> tuple[int, int]:
        """Lowest bit and number of bits that the CRC of a frame of bits covers. (0, 0) without a CRC.

        These are the fields that the CRC lists, which are adjacent, or otherwise all bits above the CRC.
        """
        crc_field = self.crc_field
        if crc_field is None or not isinstance(crc_field.field.kind, CrcValue):
            return (0, 0)
        covered_fields = self.find_fields(crc_field.field.kind.of)
        if not covered_fields:
            return crc_field.width, self.bits - crc_field.width
        # They are listed from the highest bits to the lowest ones.
        highest_field, *_ = covered_fields
        *_, lowest_field = covered_fields
        return lowest_field.lowest_bit, highest_field.highest_bit + 1 - lowest_field.lowest_bit

    @property
    def covers_part(self) -> bool:
        """True if the CRC lists the fields that it covers. Otherwise it covers everything before it."""
        crc_field = self.crc_field
        return crc_field is not None and isinstance(crc_field.field.kind, CrcValue) and bool(crc_field.field.kind.of)

    def lowest_bit_and_width_of(self, name: str) -> tuple[int, int]:
        """Return the lowest bit and the width of a field, or of a join of adjacent fields.

        The result is ``(0, 0)`` for a name that does not exist for the order code.
        """
        placed_fields = self.find_fields(self.layout.field_names_of(name))
        if not placed_fields:
            return (0, 0)
        # A join lists its fields from the highest bits to the lowest ones.
        lowest_bit = placed_fields[-1].lowest_bit
        return lowest_bit, sum(placed_field.width for placed_field in placed_fields)


def _is_flag_with_verdict(field_kind: Kind) -> bool:
    """Return True if a kind is a flag for all order codes whose verdict on the position is not *usable*.

    The flag of a frame without a position has the verdict None, which counts as not *usable*.
    """
    if not isinstance(field_kind, Flag):
        return False
    is_for_all_codes = not field_kind.only_while
    return is_for_all_codes and field_kind.makes_position is not Verdict.USABLE


def _with_unknown_verdict_if_reserved(field: Field) -> Field:
    """Return a field of unused bits with the verdict UNKNOWN if its verdict is a warning. Return others unchanged."""
    if isinstance(field.kind, Unused) and field.kind.makes_position is Verdict.USABLE_WITH_WARNING:
        return replace(field, kind=replace(field.kind, makes_position=Verdict.UNKNOWN))
    return field


def _is_status(field: Field) -> bool:
    """Return True if a field is a flag, or one unused bit that is always 1."""
    is_unused_one = isinstance(field.kind, Unused) and bool(field.kind.value) and field.widest == 1
    return isinstance(field.kind, Flag) or is_unused_one


def differ_in_length(layouts: Sequence[Layout], sender: str) -> bool:
    """Return True if the sender, ``encoder`` or ``master``, sends frames of different lengths on the same channel.

    The length of a frame in bytes then matters, so leading zeros must not be left out.
    """
    widths_by_channel: dict[int | None, set[Expression]] = {}
    for layout in layouts:
        if layout.sender == sender:
            widths_by_channel.setdefault(layout.channel, set()).add(layout.bits)
    return any(len(widths) > 1 for widths in widths_by_channel.values())


def number_from_bytes(layout: Layout, data: bytes) -> int:
    """Return the bytes of a frame or register as one number, read in the byte order of the layout and its fields."""
    ordered_data = layout.exchange_bytes(data)
    return int.from_bytes(ordered_data, "little" if layout.byte_order == "low_byte_first" else "big")


def number_to_bytes(layout: Layout, number: int, bits: int) -> bytes:
    """Return a number of ``bits`` bits as the bytes of a frame or register, in the byte order of the layout."""
    data = number.to_bytes(bits // 8, "little" if layout.byte_order == "low_byte_first" else "big")
    return layout.exchange_bytes(data)


class Fault(Enum):
    """Frame errors, in the order in which a decoder checks for them."""

    LENGTH = "length"
    CRC = "crc"
    CONSTANT = "constant"
    RANGE = "range"
