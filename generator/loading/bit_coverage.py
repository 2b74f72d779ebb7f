"""Bits of a layout: which field occupies each bit, overlaps of fields, and bits that belong to no field."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from ..language.problems import Path
from ..model import Constant, Field
from ..model.expressions import Expression
from ..model.record import dataclass
from .fields import (
    LayoutContext,
    SpecPlace,
    build_zero_field,
)
from .spec_parts import Raw

ZERO = Expression(0)


def bits_text(high: int, low: int) -> str:
    """Return a range of bits as text: ``bits 7:4``, or ``bit 7`` for a single bit."""
    return f"bits {high}:{low}" if high != low else f"bit {low}"


def condition_text(parameters: Mapping[str, int], *expressions: Expression) -> str:
    """Return the values of the parameters in expressions as text, such as `` with singleturn_bits = 17``.

    If the expressions contain no parameters, the text is empty.
    """
    parameter_names: dict[str, None] = {}  # A dict, because a set would not keep their order.
    for expression in expressions:
        parameter_names |= dict.fromkeys(expression.parameters)
    values_text = ", ".join(f"{parameter_name} = {parameters[parameter_name]}" for parameter_name in parameter_names)
    return f" with {values_text}" if values_text else ""


def sort_by_place(fields: Sequence[Field], spec_place: SpecPlace) -> list[Field]:
    """Return the fields sorted by their place in the layout, lowest first.

    Places differ between order codes, so the fields are sorted by the sum of their lowest bits over all order codes. If
    the sums are equal, the field with fewer bits comes first.
    """

    def sums_over_order_codes(field: Field) -> tuple[int, int]:
        sum_of_lowest_bits = sum(field.low.value(parameters) for parameters in spec_place.parameter_sets)
        sum_of_widths = sum(field.width.value(parameters) for parameters in spec_place.parameter_sets)
        return sum_of_lowest_bits, sum_of_widths

    return sorted(fields, key=sums_over_order_codes)


def content_of_gaps(raw_layout: Raw, context: LayoutContext) -> str:
    """Return the word for the bits that belong to no field: ``zero``, ``unspecified``, or "" if the spec has none.

    The layout defines it under the key ``other_bits``, or else the first group of fields in the layout does. In a
    frame, only a group can have such bits.
    """
    layout_and_groups = [raw_layout]
    for field in raw_layout.get("fields", ()):
        if field.get("use") in context.group_and_path_by_name:
            raw_group, _group_path = context.group_and_path_by_name[field["use"]]
            layout_and_groups.append(raw_group)
    for layout_or_group in layout_and_groups:
        content = layout_or_group.get("other_bits")
        if content:
            return str(content)
    return ""


class _Gap(NamedTuple):
    """Bits that belong to no field, with the fields below and above.

    ``below`` is None at the lowest bit of the layout, and ``above`` is None at the highest.
    """

    below: Field | None
    above: Field | None
    low: Expression
    width: Expression


def _find_gaps(fields: Sequence[Field], layout_width: Expression) -> Iterable[_Gap]:
    """Yield each gap below, between and above the fields of a layout, beginning with the lowest.

    ``fields`` are sorted by place. A gap may have no bits for some order codes. Its width is negative if the field
    above it begins below the end of the field below it.
    """
    end_of_field_below = ZERO
    field_below = None
    for field in fields:
        gap_width = field.low - end_of_field_below
        if gap_width != ZERO:
            yield _Gap(below=field_below, above=field, low=end_of_field_below, width=gap_width)
        end_of_field_below = field.low + field.width
        field_below = field
    width_of_last_gap = layout_width - end_of_field_below
    if width_of_last_gap != ZERO:
        yield _Gap(below=field_below, above=None, low=end_of_field_below, width=width_of_last_gap)


def check_all_bits_covered(
    fields: Sequence[Field], layout_width: Expression, gap_content: str, spec_place: SpecPlace
) -> bool:
    """Return whether every bit of a layout belongs to a field, for all order codes, and report the first gap if not.

    ``gap_content`` is the content of bits that belong to no field. If the spec defines it, such bits are allowed.
    """
    if gap_content:
        return True
    for parameters in spec_place.parameter_sets:
        gap_text = _first_gap_text(fields, layout_width, parameters)
        if gap_text:
            remedy = "add one, or write 'other_bits: zero' or 'other_bits: unspecified'"
            spec_place.report("bits-without-field", f"no field covers {gap_text}; {remedy}")
            return False
    return True


def _first_gap_text(fields: Sequence[Field], layout_width: Expression, parameters: Mapping[str, int]) -> str:
    """Return the lowest bits that belong to no field for an order code with these parameters, or an empty string.

    An example is ``bits 7:4 with singleturn_bits = 17``.
    """
    # A field with a width of 0 does not exist for this order code.
    present_fields = [field for field in fields if field.width.value(parameters)]
    present_fields.sort(key=lambda field: field.low.value(parameters))
    field_ranges = [(field.low, field.low + field.width) for field in present_fields]
    # The last gap ends at the end of the layout, as if a field began there.
    field_ranges.append((layout_width, layout_width))
    end_of_field_below = ZERO
    for first_bit, end_bit in field_ranges:
        first_uncovered = end_of_field_below.value(parameters)
        next_covered = first_bit.value(parameters)
        if next_covered > first_uncovered:
            return bits_text(next_covered - 1, first_uncovered) + condition_text(
                parameters, first_bit, end_of_field_below
            )
        end_of_field_below = end_bit
    return ""


def fill_first_byte(fields: list[Field], frame_width: Expression) -> tuple[list[Field], Expression]:
    """Return the fields of a bit frame with zeros above them that fill the first byte, and the width of the result.

    If the width of the frame depends on the order code, the fields are returned as they are.
    """
    # In Python, the remainder is not negative: 3 bits are missing after 13, and none after 16.
    missing_bit_count = -frame_width.constant % 8 if frame_width.is_constant else 0
    if not missing_bit_count or not fields:
        return fields, frame_width
    # The fields begin with the lowest one. The highest one is sent first.
    first_sent = fields[-1]
    width = Expression(missing_bit_count)
    zeros_field = Field(
        name=f"zero_before_{first_sent.name}",
        kind=Constant(fills_byte=True),
        low=frame_width,
        width=width,
        widest=missing_bit_count,
        meaning="Zeros that fill the first byte. They are not sent",
        source=first_sent.source,
    )
    return [*fields, zeros_field], frame_width + width


def _name_of_zeros(below: Field | None, above: Field | None) -> str:
    """Return the name of the zeros between two fields, such as ``zero_below_position``."""
    if above is not None:
        return f"zero_below_{above.name}"
    return f"zero_above_{below.name}" if below is not None else "zero"


def fill_gaps_with_zeros(
    fields: Sequence[Field], layout_width: Expression, spec_place: SpecPlace
) -> list[Field] | None:
    """Return the fields of a layout with a field of zeros in every gap.

    If the order of the fields differs between order codes, this is reported, and the result is None.
    """
    constant_zero = Constant(fills_gap=True)
    zero_fields = []
    for gap in _find_gaps(fields, layout_width):
        for parameters in spec_place.parameter_sets:
            is_reversed = gap.width.value(parameters) < 0
            if is_reversed and gap.below is not None and gap.above is not None:
                condition = condition_text(parameters, gap.low, gap.width)
                problem = f"'{gap.above.name}' is not above '{gap.below.name}'{condition}"
                spec_place.report(
                    "bit-overlap", f"{problem}; with 'other_bits: zero' the order of fields must not change"
                )
                return None
        neighbor = gap.above or gap.below or fields[0]
        zeros_field = build_zero_field(
            name=_name_of_zeros(gap.below, gap.above),
            constant=constant_zero,
            low=gap.low,
            width=gap.width,
            spec_place=spec_place,
            source=neighbor.source,
        )
        zero_fields.append(zeros_field)
    return sort_by_place([*fields, *zero_fields], spec_place)


#: More bits than any frame has. Without this limit, a typo could take hours to process.
_MAX_BITS = 100_000


@dataclass(frozen=True)
class UnplacedItem:
    """A field, or a whole group of fields, whose place in the layout may not be known yet."""

    #: Definition in the spec. For a whole group, this has only the key ``group``, with the items of its fields.
    raw: Raw
    path: Path
    #: Name of the group that the field comes from, or "".
    group: str
    width: Expression
    #: Width with padding.
    padded_width: Expression
    #: Lowest bit: in the group for a field of a group, and otherwise in the layout.
    low: Expression = ZERO


def expand_groups(items: Iterable[UnplacedItem]) -> Iterable[UnplacedItem]:
    """Yield individual fields at their places in the layout. A group is replaced by its fields."""
    for field_item in items:
        if "group" not in field_item.raw:
            yield field_item
            continue
        for group_field in field_item.raw["group"]:
            yield replace(group_field, low=field_item.low + group_field.low)


def check_items_fit(items: Sequence[UnplacedItem], layout_width: Expression, spec_place: SpecPlace) -> bool:
    """Return whether every field has a valid width, is inside the layout and overlaps no other field.

    If not, report the problems for the first order code. ``layout_width`` is the width of the layout.
    """
    field_items = list(expand_groups(items))
    for parameters in spec_place.parameter_sets:  # The parameters of each order code, such as {"position_bits": 24}.
        layout_bit_count = layout_width.value(parameters)
        if layout_bit_count > _MAX_BITS:
            problem = f"the fields have {layout_bit_count} bits{condition_text(parameters, layout_width)}"
            spec_place.report("too-long", f"{problem}; the maximum is {_MAX_BITS}")
            return False
        if not _check_fit(field_items, layout_bit_count, parameters, spec_place):
            return False
    return True


def _check_fit(
    field_items: Sequence[UnplacedItem], layout_bit_count: int, parameters: Mapping[str, int], spec_place: SpecPlace
) -> bool:
    """Return whether the fields fit into the layout with the parameters of an order code, and report if not.

    Each overlap of two fields is reported, but only the first field with an invalid width or place.
    """
    has_overlap = False
    checked_items: list[tuple[range, UnplacedItem]] = []
    for field_item in field_items:
        bit_count = field_item.width.value(parameters)
        lowest_bit = field_item.low.value(parameters)
        occupied_bits = range(lowest_bit, lowest_bit + field_item.padded_width.value(parameters))
        condition = condition_text(parameters, field_item.width, field_item.low)
        problem = _range_problem(
            field_item,
            width=bit_count,
            occupied_bits=occupied_bits,
            layout_bit_count=layout_bit_count,
            condition=condition,
        )
        if problem is not None:
            spec_place.context.report.add(problem.rule, field_item.path, problem.message)
            return False
        if bit_count == 0:  # This order code does not have the field.
            continue
        for other_occupied_bits, other_item in checked_items:
            lowest_common = max(occupied_bits.start, other_occupied_bits.start)
            highest_common = min(occupied_bits.stop, other_occupied_bits.stop) - 1
            if lowest_common <= highest_common:
                both_names = f"'{field_item.raw.get('name', '')}' and '{other_item.raw.get('name', '')}'"
                message = f"{both_names} both use {bits_text(highest_common, lowest_common)}{condition}"
                spec_place.context.report.add("bit-overlap", field_item.path, message)
                has_overlap = True
        checked_items.append((occupied_bits, field_item))
    return not has_overlap


class _RangeProblem(NamedTuple):
    """A field that cannot have its bits: the rule and the message."""

    rule: str
    message: str


def _range_problem(
    field_item: UnplacedItem, *, width: int, occupied_bits: range, layout_bit_count: int, condition: str
) -> _RangeProblem | None:
    """Return the problem if a field has an invalid width or is outside the layout, or None.

    ``occupied_bits`` are the bits of the field with its padding. ``condition`` is a text on the parameters, such as
    `` with spare_bits = 3``.
    """
    name = field_item.raw.get("name", "")
    padded_width = occupied_bits.stop - occupied_bits.start
    if width < 0 or width > padded_width:
        padding_text = f", but it is padded to {padded_width}" if width > padded_width else ""
        return _RangeProblem("width-mismatch", f"'{name}' has {width} bits{condition}{padding_text}")
    if occupied_bits.start < 0 or occupied_bits.stop > layout_bit_count:
        occupied_bits_text = bits_text(occupied_bits.stop - 1, occupied_bits.start)
        message = f"'{name}' uses {occupied_bits_text}{condition}, but there are only bits {layout_bit_count - 1} to 0"
        return _RangeProblem("bit-out-of-range", message)
    return None
