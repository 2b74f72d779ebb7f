"""Build a layout with a position for every bit from the fields listed in a spec.

Fields are listed in transmission order, or each is placed by bit number. Widths may depend on parameters, so positions
are expressions. Overlaps and negative widths are found with the parameters of every order code.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from ..language.problems import Path
from ..language.rules.shapes import PLACES
from ..model import INTERFACES, Constant, Field, Join, Layout, LayoutRange
from ..model.expressions import Expression
from ..model.kinds import WIDEST
from .bit_coverage import (
    ZERO,
    UnplacedItem,
    check_all_bits_covered,
    check_items_fit,
    condition_text,
    content_of_gaps,
    expand_groups,
    fill_first_byte,
    fill_gaps_with_zeros,
    sort_by_place,
)
from .fields import (
    LayoutContext,
    SpecPlace,
    bit_range,
    bit_slices_of,
    build_combinations,
    build_kind,
    build_zero_field,
    expected_value,
    resolve_parity_bits,
    without_needless_byte_orders,
)
from .layout_rules import check_layout
from .spec_parts import Raw, build_part, sources
from .whole_frame_checks import with_unknown_verdicts


def build_layout(raw_layout: Raw, spec_place: SpecPlace, register_bits: int | None = None) -> Layout | None:
    """Return the layout of a frame or register in a spec, or report why it is not valid and return None.

    Args:
        raw_layout: The frame or register. Its ``fields`` have passed the schema.
        spec_place: The place of the layout in the spec, and its interface.
        register_bits: The number of bits in a register. For a frame, it is None, because the fields determine it.
    """
    is_frame = register_bits is None
    default_carrier = INTERFACES[spec_place.interface].carried_as if is_frame else "bytes"
    byte_order = _byte_order(raw_layout, default_carrier)
    low_byte_first = byte_order == "low_byte_first"
    items_and_width = _place_items(raw_layout, spec_place, register_bits, low_byte_first)
    if items_and_width is None:
        return None
    placed_items, layout_width = items_and_width
    gap_content = content_of_gaps(raw_layout, spec_place.context)
    fields = _with_gap_fields(placed_items, layout_width, gap_content, spec_place)
    if fields is None:
        return None
    if byte_order == "high_byte_first" and is_frame and INTERFACES[spec_place.interface].carried_as == "bits":
        # The interface sends bits, but the frame is carried as bytes, so zeros fill its first byte.
        fields, layout_width = fill_first_byte(fields, layout_width)
    fields = without_needless_byte_orders(fields, byte_order)
    if byte_order:
        byte_count = spec_place.widest(layout_width) // 8
        fields = [replace(field, bit_slices=bit_slices_of(field, byte_count, low_byte_first)) for field in fields]
    fields = resolve_parity_bits(raw_layout, fields, spec_place)
    if not (is_frame and low_byte_first):
        # The lowest bits come first in ``fields``, but last in transmission order.
        fields = fields[::-1]
    layout = _build_layout(
        raw_layout, spec_place, byte_order=byte_order, layout_width=layout_width, fields=fields, gap_content=gap_content
    )
    # A layout that is carried as bits can also send the low byte first.
    states_low_byte_first = raw_layout.get("byte_order") == "low_byte_first"
    if not check_layout(layout, spec_place, states_low_byte_first):
        return None
    return with_unknown_verdicts(layout, raw_layout["fields"], spec_place) if is_frame else layout


def _build_layout(
    raw_layout: Raw,
    spec_place: SpecPlace,
    *,
    byte_order: str,
    layout_width: Expression,
    fields: Sequence[Field],
    gap_content: str,
) -> Layout:
    """Return the layout with these fields, which are in transmission order.

    ``gap_content`` is the content of the bits that belong to no field: ``zero``, ``unspecified`` or "".
    """
    raw_gray = raw_layout.get("gray", {})  # Which number is sent in Gray code.
    selector, selecting_values = "", ()
    # ``when`` has at most one entry: the field that identifies the layout, and the values that select it.
    for field_name, field_values in raw_layout.get("when", {}).items():
        selector, selecting_values = field_name, tuple(field_values)
    return build_part(
        Layout,
        raw_layout,
        sender=raw_layout.get("from", ""),
        in_bytes=byte_order != "",
        byte_order=byte_order,
        bits=layout_width,
        widest=spec_place.widest(layout_width),
        fields=tuple(fields),
        joins=tuple(_joins_of_fields(raw_layout, fields)),
        selector=selector,
        selects=selecting_values,
        gaps=gap_content,
        gray_of=raw_gray.get("of", ""),
        gray_when=raw_gray.get("when", ""),
        gray_excess=spec_place.context.expressions(raw_gray, ("excess",))["excess"],
        combinations=build_combinations(raw_layout),
        position_range=_build_position_range(raw_layout, spec_place.context),
    )


def _joins_of_fields(raw_layout: Raw, fields: Sequence[Field]) -> Iterator[Join]:
    """Yield the joined numbers of a layout, each of which consists of several fields.

    A joined number with a field that does not exist is reported elsewhere, and left out.
    """
    field_names = {field.name for field in fields}
    for joined_name, member_names in raw_layout.get("join", {}).items():
        if field_names.issuperset(member_names):
            yield Join(joined_name, tuple(member_names))


def _build_position_range(raw_layout: Raw, context: LayoutContext) -> LayoutRange | None:
    """Return the range of the position in frames of this layout, or None if the range of the interface applies."""
    if "position_range" not in raw_layout:
        return None
    raw_range = raw_layout["position_range"]
    bounds = context.expressions(raw_range, ("turns", "modulus", "highest"))
    return LayoutRange(source=sources(raw_range) or sources(raw_layout), wraps=raw_range.get("wraps", True), **bounds)


def _byte_order(raw_layout: Raw, carried_as: str) -> str:
    """Return the order of the bytes, ``high_byte_first`` or ``low_byte_first``, or "" if the layout is carried as bits.

    ``carried_as``, either ``bytes`` or ``bits``, applies if the layout does not specify it.
    """
    if raw_layout.get("carried_as", carried_as) == "bits":
        return ""
    byte_order: str = raw_layout.get("byte_order", "high_byte_first")
    return byte_order


def _place_items(
    raw_layout: Raw, spec_place: SpecPlace, register_bits: int | None, low_byte_first: bool
) -> tuple[list[UnplacedItem], Expression] | None:
    """Return the fields of a layout with their places, and the width of the layout.

    If one field states its place, all are placed by bit number. Otherwise, they are in transmission order, and must
    fill the ``register_bits`` of a register. ``low_byte_first`` is true if the lowest byte is sent first. If the fields
    are not valid or do not fit, this is reported, and the result is None.
    """
    field_items = _build_items(
        raw_layout.get("fields", ()), (*spec_place.path, "fields"), spec_place.context, low_byte_first
    )
    if field_items is None:
        return None
    single_fields = [field_item for field_item in field_items if not field_item.group]
    place_by_bit_number = any(_is_placed(field_item.raw) for field_item in single_fields)
    if place_by_bit_number:
        layout_bit_count = _highest_used_bit(field_items, spec_place) + 1 if register_bits is None else register_bits
        layout_width = Expression(layout_bit_count)
    else:
        field_items, layout_width = _place_in_sequence(field_items, low_byte_first)
        if register_bits is not None and not _check_total_width(layout_width, register_bits, spec_place):
            return None
    return (field_items, layout_width) if check_items_fit(field_items, layout_width, spec_place) else None


def _with_gap_fields(
    field_items: Sequence[UnplacedItem], layout_width: Expression, gap_content: str, spec_place: SpecPlace
) -> list[Field] | None:
    """Return the fields of a layout, beginning with the lowest, or report a problem and return None.

    ``gap_content`` is the content of the bits that belong to no field. If it is ``zero``, each gap gets a field of
    zeros, and the order of the fields must be the same for all order codes. If it is "", there must be no such bits.
    """
    fields: list[Field] = []
    for field_item in field_items:
        fields += _build_fields(field_item, spec_place)
    fields = sort_by_place(fields, spec_place)
    if not check_all_bits_covered(fields, layout_width, gap_content, spec_place):
        return None
    return fill_gaps_with_zeros(fields, layout_width, spec_place) if gap_content == "zero" else fields


def _build_items(
    raw_fields: Sequence[Raw], list_path: Path, context: LayoutContext, low_byte_first: bool
) -> list[UnplacedItem] | None:
    """Return the fields and groups of a layout without their places, unless they state them.

    If one of them is not valid, this is reported elsewhere, and the result is None.
    """
    field_items = [
        _build_item(raw_field, (*list_path, index), context, low_byte_first)
        for index, raw_field in enumerate(raw_fields)
    ]
    valid_items = [field_item for field_item in field_items if field_item is not None]
    return valid_items if len(valid_items) == len(field_items) else None


def _build_item(raw_field: Raw, field_path: Path, context: LayoutContext, low_byte_first: bool) -> UnplacedItem | None:
    """Return a field or a whole group of fields, with its width, or None if it is not valid.

    If the field states its place, the result contains it. Otherwise, the place is 0 until it is known. The padded width
    is the number of bits that the field occupies: its width, or ``padded_to`` bits.
    """
    if "use" in raw_field:
        return _build_group_item(raw_field, field_path, context, low_byte_first)
    width = _width_of_field(raw_field, context)
    if width is None:
        return None
    lowest_bit = _lowest_bit_of_field(raw_field, width, field_path, context) if _is_placed(raw_field) else ZERO
    if lowest_bit is None:
        return None
    padded_width = Expression(raw_field["padded_to"]) if "padded_to" in raw_field else width
    return UnplacedItem(raw_field, field_path, group="", width=width, padded_width=padded_width, low=lowest_bit)


def _build_group_item(
    raw_field: Raw, field_path: Path, context: LayoutContext, low_byte_first: bool
) -> UnplacedItem | None:
    """Return a whole group of fields that a layout uses, or None if there is no such group or it is not valid."""
    if raw_field["use"] not in context.group_and_path_by_name:
        return None
    raw_group, group_path = context.group_and_path_by_name[raw_field["use"]]
    group_items = _build_items_of_group(raw_group, group_path, context, low_byte_first)
    if group_items is None:
        return None
    width = Expression(raw_group["bits"])
    return UnplacedItem({"group": group_items}, field_path, group=raw_field["use"], width=width, padded_width=width)


def _build_items_of_group(
    raw_group: Raw, group_path: Path, context: LayoutContext, low_byte_first: bool
) -> list[UnplacedItem] | None:
    """Return the fields of a group with their places in the group, or None if they are not valid.

    Fields that are listed in transmission order must have as many bits as the group states.
    """
    # A field without a citation has the citation of the group.
    raw_fields = [{"source": raw_group["source"], **raw_field} for raw_field in raw_group["fields"]]
    group_items = _build_items(raw_fields, (*group_path, "fields"), context, low_byte_first)
    if group_items is None:
        return None
    if not any(_is_placed(field_item.raw) for field_item in group_items):
        group_items, total_width = _place_in_sequence(group_items, low_byte_first)
        if total_width != Expression(raw_group["bits"]):
            problem = f"the fields of group '{raw_group['name']}' have {total_width.render()} bits"
            context.report.add("width-mismatch", group_path, f"{problem}, but 'bits' is {raw_group['bits']}")
            return None
    return [replace(field_item, group=raw_group["name"]) for field_item in group_items]


def _is_placed(raw_field: Raw) -> bool:
    """Return whether a field states its own place, for example with ``at``."""
    return any(key in raw_field for key in PLACES)


def _width_of_field(raw_field: Raw, context: LayoutContext) -> Expression | None:
    """Return the width of a field, or None if it has no valid one.

    It is given by ``bits`` or the range in ``at``. A CRC has its own width, and flags and parity bits have one bit.
    """
    if "bits" in raw_field:
        return context.expression(raw_field["bits"])
    if "at" in raw_field:
        # A range that is not valid is reported when the lowest bit is determined.
        highest_bit, lowest_bit = bit_range(raw_field["at"]) or (0, 0)
        return Expression(highest_bit - lowest_bit + 1)
    if "crc" in raw_field and raw_field["crc"] in context.crc_by_name:
        return Expression(context.crc_by_name[raw_field["crc"]].width)
    return Expression(1) if "active" in raw_field or "parity_of" in raw_field else None


def _lowest_bit_of_field(
    raw_field: Raw, width: Expression, field_path: Path, context: LayoutContext
) -> Expression | None:
    """Return the lowest bit of a field, which ``low_bit``, ``top_bit`` or ``at`` determines, or None if not valid."""
    if "low_bit" in raw_field:
        return context.expression(raw_field["low_bit"])
    if "top_bit" in raw_field:
        return Expression(raw_field["top_bit"] + 1) - width
    highest_and_lowest_bit = bit_range(raw_field["at"])
    if highest_and_lowest_bit is None:
        context.report.add(
            "bad-position",
            (*field_path, "at"),
            f"'{raw_field['at']}' is not a position; write a bit number, or a range with the high bit first, as in 7:6",
        )
        return None
    _highest_bit, lowest_bit = highest_and_lowest_bit
    return Expression(lowest_bit)


def _place_in_sequence(
    field_items: Sequence[UnplacedItem], low_byte_first: bool
) -> tuple[list[UnplacedItem], Expression]:
    """Return the fields placed next to each other, and their total width. They are and stay in transmission order.

    The field that is sent last begins at bit 0, or, if ``low_byte_first`` is true, the field that is sent first.
    """
    items_from_lowest = list(field_items) if low_byte_first else list(reversed(field_items))
    placed_items = []
    next_lowest_bit = ZERO
    for field_item in items_from_lowest:
        placed_items.append(replace(field_item, low=next_lowest_bit))
        next_lowest_bit += field_item.padded_width
    items_in_sending_order = placed_items if low_byte_first else placed_items[::-1]
    return items_in_sending_order, next_lowest_bit


def _highest_used_bit(items: Sequence[UnplacedItem], spec_place: SpecPlace) -> int:
    """Return the highest bit that a field uses for any order code."""
    return max(spec_place.widest(field_item.low + field_item.padded_width) for field_item in expand_groups(items)) - 1


def _check_total_width(total_width: Expression, register_bits: int, spec_place: SpecPlace) -> bool:
    """Return whether the fields of a register fill its bits for every order code, and report if not."""
    for parameters in spec_place.parameter_sets:
        total_bit_count = total_width.value(parameters)
        if total_bit_count != register_bits:
            problem = f"the fields have {total_bit_count} bits{condition_text(parameters, total_width)}"
            spec_place.report("width-mismatch", f"{problem}, but the register has {register_bits}")
            return False
    return True


def _build_fields(field_item: UnplacedItem, spec_place: SpecPlace) -> Iterable[Field]:
    """Yield a field and its padding, if it has any, or all fields of a group."""
    for single_item in expand_groups([field_item]):
        raw_field = single_item.raw
        width = single_item.width
        widest = spec_place.widest(width)
        padded_bit_count = raw_field.get("padded_to", 0)
        if "scale" in raw_field and widest > WIDEST:
            message = f"'{raw_field['name']}' has {widest} bits; a number with 'scale' has at most {WIDEST}"
            spec_place.context.report.add("scale-of", (*single_item.path, "scale"), message, at_key=True)
        yield build_part(
            Field,
            raw_field,
            kind=build_kind(raw_field, spec_place.context, spec_place.interface, width),
            low=single_item.low,
            width=width,
            widest=widest,
            group=single_item.group,
            container=padded_bit_count,
            equals=expected_value(raw_field, spec_place.context),
        )
        if padded_bit_count:
            padding_width = single_item.padded_width - width
            padding_constant = Constant(padding_of=raw_field["name"])
            yield build_zero_field(
                name=f"{raw_field['name']}_padding",
                constant=padding_constant,
                low=single_item.low + width,
                width=padding_width,
                spec_place=spec_place,
                source=sources(raw_field),
            )
