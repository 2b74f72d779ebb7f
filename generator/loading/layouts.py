"""Build a layout with a position for every bit from the fields listed in a spec.

Fields are listed in sending order, or each is placed by bit number. Widths may depend on parameters, so positions are
expressions. Overlaps and negative widths are found with the parameters of every order code.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from ..language.problems import Path
from ..language.rules.shapes import PLACES
from ..model import INTERFACES, Constant, Field, Join, Layout, LayoutRange, Parity
from ..model.expressions import Expression
from ..model.kinds import WIDEST
from ..model.record import dataclass
from .fields import Context, Site, bit_range, build_combinations, expected_value, kind_of, pieces, zero_field
from .frame_kinds import with_unknown_verdicts
from .from_mapping import Raw, record, sources
from .gaps import (
    ZERO,
    bits_text,
    check_all_bits_covered,
    content_of_gaps,
    in_whole_bytes,
    values_text,
    with_places,
    with_zeros,
)
from .layout_rules import check_layout

#: More bits than any frame has. Without this limit, a typo could take hours to process.
_MOST_BITS = 100_000


@dataclass(frozen=True)
class Item:
    """A field in progress: its data and path in the spec, and its place. ``span`` is the width with padding."""

    raw: Raw
    path: Path
    group: str
    width: Expression
    span: Expression
    low: Expression = ZERO


def build_layout(raw: Raw, site: Site, total: int | None = None) -> Layout | None:
    """Build the layout described by ``raw``, or report why it is not valid and return None.

    Args:
        raw: A layout or register whose ``fields`` have passed the schema.
        site: The place and interface of the layout.
        total: The number of bits if given (a register) instead of summed up (a frame).
    """
    byte_order = _byte_order(raw, "bytes" if total is not None else INTERFACES[site.interface].carried_as)
    low_first = byte_order == "low_byte_first"
    arranged = _place_items(raw, site, total, low_first)
    if arranged is None:
        return None
    parts, bits = arranged
    gaps = content_of_gaps(raw, site.context)
    fields = _with_gap_fields(parts, bits, gaps, site)
    if fields is None:
        return None
    if byte_order == "high_byte_first" and total is None and INTERFACES[site.interface].carried_as == "bits":
        fields, bits = in_whole_bytes(fields, bits)
    if byte_order:
        fields = [replace(field, pieces=pieces(field, site.widest(bits) // 8, low_first)) for field in fields]
    fields = _with_joins_covered(raw, fields, site)
    layout = _layout(raw, site, byte_order, bits, _in_order(fields, low_first and total is None), gaps)
    if not check_layout(layout, site, raw.get("byte_order") == "low_byte_first"):
        return None
    return with_unknown_verdicts(layout, raw["fields"], site) if total is None else layout


def _layout(raw: Raw, site: Site, byte_order: str, bits: Expression, fields: Sequence[Field], gaps: str) -> Layout:
    """Return the layout with these fields, in sending order."""
    gray = raw.get("gray", {})
    selector, selects = "", ()
    for name, values in raw.get("when", {}).items():  # At most one.
        selector, selects = name, tuple(values)
    return record(
        Layout,
        raw,
        sender=raw.get("from", ""),
        in_bytes=byte_order != "",
        byte_order=byte_order,
        bits=bits,
        widest=site.widest(bits),
        fields=tuple(fields),
        joins=tuple(Join(name, tuple(members)) for name, members in raw.get("join", {}).items()),
        selector=selector,
        selects=selects,
        gaps=gaps,
        gray_of=gray.get("of", ""),
        gray_when=gray.get("when", ""),
        gray_excess=site.context.expressions(gray, ("excess",))["excess"],
        combinations=build_combinations(raw),
        position_range=_position_range(raw, site.context),
    )


def _with_joins_covered(raw: Raw, fields: Sequence[Field], site: Site) -> list[Field]:
    """Return the fields, with each parity bit over the fields of the joined numbers that it covers."""
    joins = {name: tuple(members) for name, members in raw.get("join", {}).items()}
    constants = {field.name: field.kind.value for field in fields if isinstance(field.kind, Constant)}
    return [_over_fields(field, joins, constants, site) for field in fields]


def _position_range(raw: Raw, context: Context) -> LayoutRange | None:
    if "position_range" not in raw:
        return None
    definition = raw["position_range"]
    numbers = context.expressions(definition, ("turns", "modulus", "highest"))
    return LayoutRange(source=sources(definition) or sources(raw), wraps=definition.get("wraps", True), **numbers)


def _over_fields(field: Field, joins: Mapping[str, tuple[str, ...]], constants: Mapping[str, int], site: Site) -> Field:
    """Return a parity bit with the fields of joined numbers, and with the ones of constants among others counted.

    A parity bit of constants only is a constant itself.
    """
    parity = field.kind
    if not isinstance(parity, Parity):
        return field
    covered_names: list[str] = []
    for name in parity.of:
        if parity.over and name in joins:
            message = f"'over' counts the bits of each field from 0, and '{name}' has several fields; list its fields"
            site.report("parity-of", message, "fields", field.name, "parity_of")
        covered_names += joins.get(name, (name,))
    constant_names = [name for name in covered_names if name in constants]
    if len(covered_names) == 1:
        constant_names = []
    data_names = [name for name in covered_names if name not in constant_names]
    # An odd number of ones in constants inverts the parity of the other fields.
    ones_in_constants = sum((constants[name] & parity.mask).bit_count() for name in constant_names)
    inverts = ones_in_constants % 2 == 1
    is_odd = parity.odd != inverts
    if not data_names:
        return replace(field, kind=Constant(int(is_odd)))
    return replace(field, kind=Parity(tuple(data_names), is_odd, parity.over, tuple(constant_names), inverts))


def _byte_order(raw: Raw, carried_as: str) -> str:
    """Return the order of the bytes, or an empty string for bits. ``carried_as`` is the default for ``raw``."""
    in_bytes = raw.get("carried_as", carried_as) == "bytes"
    order: str = raw.get("byte_order", "high_byte_first") if in_bytes else ""
    return order


def _place_items(raw: Raw, site: Site, total: int | None, low_first: bool) -> tuple[list[Item], Expression] | None:
    """Return the items with their places and the width of the layout, or report why they do not fit."""
    items = _items(raw.get("fields", ()), (*site.path, "fields"), site.context, low_first)
    if items is None:
        return None
    if any(_is_placed(field_item.raw) for field_item in items if not field_item.group):
        bits = Expression(total if total is not None else _highest(items, site) + 1)
    else:
        items, bits = _in_sequence(items, low_first)
        if total is not None and not _sums_up(bits, total, site):
            return None
    return (items, bits) if _check_items_fit(items, bits, site) else None


def _with_gap_fields(items: Sequence[Item], bits: Expression, gaps: str, site: Site) -> list[Field] | None:
    """Return the fields from the lowest up, with zero fields in zero gaps, or None if bits are left over."""
    fields = [field for field_item in items for field in _fields(field_item, site)]
    fields = with_places(fields, site)
    if not check_all_bits_covered(fields, bits, gaps, site):
        return None
    return with_zeros(fields, bits, site) if gaps == "zero" else fields


def _items(raw_fields: Sequence[Raw], path: Path, context: Context, low_first: bool) -> list[Item] | None:
    """Return the fields with groups included, or None if one is not valid, which is reported elsewhere."""
    items = [_item(raw, (*path, index), context, low_first) for index, raw in enumerate(raw_fields)]
    valid_items = [field_item for field_item in items if field_item is not None]
    return valid_items if len(valid_items) == len(items) else None


def _item(raw: Raw, path: Path, context: Context, low_first: bool) -> Item | None:
    """Return a field or group as an item, or None if it is not valid."""
    if "use" in raw:
        return _group_item(raw, path, context, low_first)
    width = _width(raw, context)
    if width is None:
        return None
    low = _low(raw, width, path, context) if _is_placed(raw) else ZERO
    if low is None:
        return None
    span = Expression(raw["padded_to"]) if "padded_to" in raw else width
    return Item(raw, path, group="", width=width, span=span, low=low)


def _group_item(raw: Raw, path: Path, context: Context, low_first: bool) -> Item | None:
    """Return the item that includes a group, with the placed fields of the group under ``group``."""
    if raw["use"] not in context.groups:
        return None
    group, group_path = context.groups[raw["use"]]
    group_items = _group_items(group, group_path, context, low_first)
    if group_items is None:
        return None
    width = Expression(group["bits"])
    return Item({"group": group_items}, path, group=raw["use"], width=width, span=width)


def _group_items(group: Raw, path: Path, context: Context, low_first: bool) -> list[Item] | None:
    """Return the fields of a group, placed from bit 0 of the group."""
    fields = [{"source": group["source"], **raw} for raw in group["fields"]]
    items = _items(fields, (*path, "fields"), context, low_first)
    if items is None:
        return None
    if not any(_is_placed(field_item.raw) for field_item in items):
        items, bits = _in_sequence(items, low_first)
        if bits != Expression(group["bits"]):
            context.report.add(
                "width-mismatch",
                path,
                f"the fields of group '{group['name']}' have {bits.render()} bits, but 'bits' is {group['bits']}",
            )
            return None
    return [replace(field_item, group=group["name"]) for field_item in items]


def _is_placed(raw: Raw) -> bool:
    return any(key in raw for key in PLACES)


def _width(raw: Raw, context: Context) -> Expression | None:
    if "bits" in raw:
        return context.expression(raw["bits"])
    if "at" in raw:
        high, low = bit_range(raw["at"]) or (0, 0)
        return Expression(high - low + 1)
    if "crc" in raw and raw["crc"] in context.crcs:
        return Expression(context.crcs[raw["crc"]].width)
    return Expression(1) if "active" in raw or "parity_of" in raw else None


def _low(raw: Raw, width: Expression, path: Path, context: Context) -> Expression | None:
    if "low_bit" in raw:
        return context.expression(raw["low_bit"])
    if "top_bit" in raw:
        return Expression(raw["top_bit"] + 1) - width
    bounds = bit_range(raw["at"])
    if bounds is None:
        context.report.add(
            "bad-position",
            (*path, "at"),
            f"'{raw['at']}' is not a position; write a bit number, or a range with the high bit first, as in 7:6",
        )
        return None
    return Expression(bounds[1])


def _in_sequence(items: Sequence[Item], low_first: bool) -> tuple[list[Item], Expression]:
    """Return the items placed in sending order, and their total width."""
    from_lowest = list(items) if low_first else list(reversed(items))
    placed, position = [], ZERO
    for field_item in from_lowest:
        placed.append(replace(field_item, low=position))
        position += field_item.span
    in_sending_order = placed if low_first else placed[::-1]
    return in_sending_order, position


def _flatten(items: Iterable[Item]) -> Iterable[Item]:
    """Yield the items with groups expanded, each at its place in the layout."""
    for field_item in items:
        if "group" not in field_item.raw:
            yield field_item
            continue
        for group_field in field_item.raw["group"]:
            yield replace(group_field, low=field_item.low + group_field.low)


def _highest(items: Sequence[Item], site: Site) -> int:
    return max(site.widest(field_item.low + field_item.span) for field_item in _flatten(items)) - 1


def _sums_up(bits: Expression, total: int, site: Site) -> bool:
    """Return True if the fields of a register have as many bits as it for every order code."""
    for parameters in site.sets:
        field_bits = bits.value(parameters)
        if field_bits != total:
            message = f"the fields have {field_bits} bits{values_text(parameters, bits)}, but the register has {total}"
            site.report("width-mismatch", message)
            return False
    return True


def _check_items_fit(items: Sequence[Item], bits: Expression, site: Site) -> bool:
    """Return True if every field has a valid width, is inside the layout and overlaps no other field."""
    flat = list(_flatten(items))
    for parameters in site.sets:
        total = bits.value(parameters)
        if total > _MOST_BITS:
            message = f"the fields have {total} bits{values_text(parameters, bits)}; the maximum is {_MOST_BITS}"
            site.report("too-long", message)
            return False
        if not _fits_with(flat, total, parameters, site):
            return False
    return True


def _fits_with(flat: Sequence[Item], total: int, parameters: Mapping[str, int], site: Site) -> bool:
    """Return True if the fields fit into ``total`` bits with these parameters, otherwise report why not."""
    has_overlap = False
    occupied: list[tuple[range, Item]] = []
    for field_item in flat:
        width, low = field_item.width.value(parameters), field_item.low.value(parameters)
        bits = range(low, low + field_item.span.value(parameters))
        condition = values_text(parameters, field_item.width, field_item.low)
        problem = _range_problem(field_item, width, bits, total, condition)
        if problem is not None:
            rule, message = problem
            site.context.report.add(rule, field_item.path, message)
            return False
        if width == 0:
            continue
        for other_bits, other_item in occupied:
            first, last = max(bits.start, other_bits.start), min(bits.stop, other_bits.stop) - 1
            if first <= last:
                names = f"'{field_item.raw.get('name', '')}' and '{other_item.raw.get('name', '')}'"
                message = f"{names} both use {bits_text(last, first)}{condition}"
                site.context.report.add("bit-overlap", field_item.path, message)
                has_overlap = True
        occupied.append((bits, field_item))
    return not has_overlap


def _range_problem(field_item: Item, width: int, bits: range, total: int, condition: str) -> tuple[str, str] | None:
    """Return the rule and the message if a field has an invalid width or is outside the layout."""
    name, span = field_item.raw.get("name", ""), bits.stop - bits.start
    if width < 0 or width > span:
        padding = f", but it is padded to {span}" if width > span else ""
        return "width-mismatch", f"'{name}' has {width} bits{condition}{padding}"
    if bits.start < 0 or bits.stop > total:
        place = bits_text(bits.stop - 1, bits.start)
        return "bit-out-of-range", f"'{name}' uses {place}{condition}, but there are only bits {total - 1} to 0"
    return None


def _fields(field_item: Item, site: Site) -> Iterable[Field]:
    """Yield the fields of an item: one, two with its padding, or those of a group."""
    for part in _flatten([field_item]):
        raw, width = part.raw, part.width
        widest = site.widest(width)
        container = raw.get("padded_to", 0)
        if "scale" in raw and widest > WIDEST:
            message = f"'{raw['name']}' has {widest} bits; a number with 'scale' has at most {WIDEST}"
            site.context.report.add("scale-of", (*part.path, "scale"), message, at_key=True)
        yield record(
            Field,
            raw,
            kind=kind_of(raw, site.context, site.interface, width),
            low=part.low,
            width=width,
            widest=widest,
            group=part.group,
            container=container,
            equals=expected_value(raw, site.context),
        )
        if container:
            padding_bits = part.span - width
            padding = Constant(padding_of=raw["name"])
            yield zero_field(f"{raw['name']}_padding", padding, part.low + width, padding_bits, site, sources(raw))


def _in_order(fields: Sequence[Field], low_first: bool) -> Sequence[Field]:
    return fields if low_first else list(reversed(fields))
