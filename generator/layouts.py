"""From the fields that a spec lists to a layout with a position for every bit.

Fields are listed in the order in which they are sent, or each is placed by bit number. Widths may depend on parameters, so positions
are expressions; what cannot be seen from those, an overlap or a width below zero, is looked for with every order code's parameters.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from .crc import fold_plan
from .expressions import Expression
from .fields import Context, Raw, bit_range, digits, equals, kind, makes_position, pieces, values, zero_field
from .joins import check_joined
from .model import Field, Join, Layout
from .problems import Path

ZERO = Expression(0)

#: Numbers of frames and registers are held in 64 bits by the generated C.
LARGEST_NUMBER = 64


@dataclass(frozen=True)
class Item:
    """A field on its way: what the spec says, where, and where it goes. ``span`` is the width with padding."""

    raw: Raw
    path: Path
    group: str
    width: Expression
    span: Expression
    low: Expression = ZERO


def build_layout(raw: Raw, path: Path, context: Context, *, interface: str, total: int | None = None) -> Layout | None:
    """The layout that ``raw`` describes, or None after reporting why there is none.

    Args:
        raw: A layout, or a register, whose ``fields`` have passed the schema.
        interface: The interface whose order codes the widths must suit.
        total: The number of bits, where that is given (a register) rather than summed up (a frame).
    """
    default = "bytes" if total is not None or interface == "rs485" else "bits"
    carried_as = raw.get("carried_as", default)
    byte_order = raw.get("byte_order", "high_byte_first") if carried_as == "bytes" else ""
    low_first = byte_order == "low_byte_first"
    items = _items(raw.get("fields", ()), (*path, "fields"), context, low_first)
    if items is None:
        return None
    placed = bool(items) and any(_is_placed(item.raw) for item in items if not item.group)
    if placed:
        bits = Expression(total if total is not None else _highest(items, context, interface) + 1)
    else:
        items, bits = _in_sequence(items, low_first)
        if total is not None and not _sums_up(bits, total, path, context, interface):
            return None
    if not _fits(items, bits, context, interface):
        return None
    fields = [field for item in items for field in _fields(item, context, interface)]
    fields = _with_places(fields, context, interface)
    # In a frame only a group can leave bits without a field; what it says of them holds.
    gaps = raw.get("other_bits") or next((group["other_bits"] for group in _used_groups(raw, context) if "other_bits" in group), "")
    if not _covers(fields, bits, gaps, path, context, interface):
        return None
    if gaps == "zero":
        filled = _with_zeros(fields, bits, path, context, interface)
        if filled is None:
            return None
        fields = filled
    widest = _widest(bits, context, interface)
    if carried_as == "bytes":
        fields = [replace(field, pieces=pieces(field, widest // 8, low_first)) for field in fields]
    crc = next((context.crcs.get(field.crc) for field in fields if field.kind == "crc"), None)
    when = raw.get("when", {})
    layout = Layout(
        name=raw["name"],
        printed_name=raw.get("printed_name", ""),
        sender=raw.get("from", ""),
        carried_as=carried_as,
        byte_order=byte_order,
        bits=bits,
        widest=widest,
        fields=tuple(_in_order(fields, low_first and total is None)),
        joins=tuple(Join(name, tuple(parts)) for name, parts in raw.get("join", {}).items()),
        selector=next(iter(when), ""),
        selects=tuple(next(iter(when.values()), ())),
        gaps=gaps,
        note=raw.get("note", ""),
        source=context.sources(raw),
        gray_of=raw.get("gray", {}).get("of", ""),
        gray_when=raw.get("gray", {}).get("when", ""),
        channel=raw.get("channel"),
        fold=fold_plan(crc.width, crc.poly, widest) if crc is not None and crc.form == "fold" and widest <= LARGEST_NUMBER else (),
    )
    return layout if _is_sound(layout, path, context, interface) else None


def _items(raw_fields: Sequence[Raw], path: Path, context: Context, low_first: bool) -> list[Item] | None:
    """The fields with groups taken in; None when one cannot be understood (reported elsewhere)."""
    items = [_item(raw, (*path, index), context, low_first) for index, raw in enumerate(raw_fields)]
    understood = [item for item in items if item is not None]
    return understood if len(understood) == len(items) else None


def _item(raw: Raw, path: Path, context: Context, low_first: bool) -> Item | None:
    if "use" in raw:
        group = context.groups.get(raw["use"])
        inner = _group_items(*group, context, low_first) if group is not None else None
        if group is None or inner is None:
            return None
        return Item({"group": inner}, path, raw["use"], Expression(group[0]["bits"]), Expression(group[0]["bits"]))
    width = _width(raw, context)
    if width is None:
        return None
    span = Expression(raw["padded_to"]) if "padded_to" in raw else width
    low = _low(raw, width, path, context) if _is_placed(raw) else ZERO
    return Item(raw, path, "", width, span, low) if low is not None else None


def _group_items(group: Raw, path: Path, context: Context, low_first: bool) -> list[Item] | None:
    """The fields of a group, placed from bit 0 of the group on."""
    fields = [{"source": group["source"], **raw} for raw in group["fields"]]
    items = _items(fields, (*path, "fields"), context, low_first)
    if items is None:
        return None
    if not any(_is_placed(item.raw) for item in items):
        items, bits = _in_sequence(items, low_first)
        if bits != Expression(group["bits"]):
            context.report.add("width-mismatch", path, f"the fields of group '{group['name']}' take {bits.render()} bits; 'bits' says {group['bits']}")
            return None
    return [replace(item, group=group["name"]) for item in items]


def _is_placed(raw: Raw) -> bool:
    return "at" in raw or "top_bit" in raw


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
    if "top_bit" in raw:
        return Expression(raw["top_bit"] + 1) - width
    bounds = bit_range(raw["at"])
    if bounds is None:
        context.report.add("bad-position", (*path, "at"), f"'{raw['at']}' is no position; write a bit number, or a range with the high bit first, as in 7:6")
        return None
    return Expression(bounds[1])


def _in_sequence(items: Sequence[Item], low_first: bool) -> tuple[list[Item], Expression]:
    """The items one after the other as they are sent, and their total width."""
    placed, position = [], ZERO
    for item in items if low_first else reversed(items):
        placed.append(replace(item, low=position))
        position += item.span
    return placed if low_first else placed[::-1], position


def _flat(items: Iterable[Item]) -> Iterable[Item]:
    """The items with groups opened, each at its place in the layout."""
    for item in items:
        inner = item.raw.get("group")
        if inner is None:
            yield item
        else:
            yield from (replace(field, low=item.low + field.low) for field in inner)


def _sets(context: Context, interface: str) -> Sequence[Mapping[str, int]]:
    return context.parameter_sets.get(interface, ())


def _widest(expression: Expression, context: Context, interface: str) -> int:
    return max((expression.value(parameters) for parameters in _sets(context, interface)), default=expression.constant)


def _highest(items: Sequence[Item], context: Context, interface: str) -> int:
    return max(_widest(item.low + item.span, context, interface) for item in _flat(items)) - 1


def _sums_up(bits: Expression, total: int, path: Path, context: Context, interface: str) -> bool:
    for parameters in _sets(context, interface):
        if (sum_ := bits.value(parameters)) != total:
            context.report.add("width-mismatch", path, f"the fields take {sum_} bits{_with(parameters, bits)}; the register has {total}")
            return False
    return True


def _bits(high: int, low: int) -> str:
    return f"bits {high}:{low}" if high != low else f"bit {low}"


def _with(parameters: Mapping[str, int], *expressions: Expression) -> str:
    """`` with singleturn_bits = 17`` for the parameters that matter."""
    names = dict.fromkeys(name for expression in expressions for name in expression.parameters)
    return " with " + ", ".join(f"{name} = {parameters[name]}" for name in names) if names else ""


def _fits(items: Sequence[Item], bits: Expression, context: Context, interface: str) -> bool:
    """Whether every field has a possible width, lies inside the layout and on no other field."""
    sound = True
    flat = list(_flat(items))
    for parameters in _sets(context, interface):
        total = bits.value(parameters)
        taken: list[tuple[int, int, Item]] = []
        for item in flat:
            width, low, span = (part.value(parameters) for part in (item.width, item.low, item.span))
            where = _with(parameters, item.width, item.low)
            name = item.raw.get("name", "")
            if width < 0 or width > span:
                wrong = f"'{name}' has {width} bits{where}" + (f"; it is padded to {span}" if width > span else "")
                context.report.add("width-mismatch", item.path, wrong)
                return False
            if low < 0 or low + span > total:
                context.report.add("bit-out-of-range", item.path, f"'{name}' takes {_bits(low + span - 1, low)}{where}; there are bits {total - 1} to 0")
                return False
            for other_low, other_high, other in taken:
                if width and low <= other_high and other_low <= low + span - 1:
                    shared = _bits(min(low + span - 1, other_high), max(low, other_low))
                    context.report.add("bit-overlap", item.path, f"'{name}' and '{other.raw.get('name', '')}' both take {shared}{where}")
                    sound = False
            if width:
                taken.append((low, low + span - 1, item))
        if not sound:
            return False
    return sound


def _fields(item: Item, context: Context, interface: str) -> Iterable[Field]:
    """The fields of an item: one, two with its padding, or those of a group."""
    for part in _flat([item]):
        raw, width = part.raw, part.width
        widest = _widest(width, context, interface)
        container = raw.get("padded_to", 0)
        yield Field(
            name=raw["name"],
            kind=kind(raw),
            low=part.low,
            width=width,
            widest=widest,
            printed_name=raw.get("printed_name", ""),
            names=raw.get("names", {}),
            group=part.group,
            container=container,
            constant=raw.get("constant", 0),
            active_low=raw.get("active") == "low",
            when_active=raw.get("when_active", ""),
            when_inactive=raw.get("when_inactive", ""),
            makes_position=makes_position(raw, interface),
            sums_up=tuple(raw.get("sums_up", ())),
            values=values(raw, context, interface),
            crc=raw.get("crc", ""),
            parity_of=raw.get("parity_of", ""),
            digits=digits(raw),
            equals=equals(raw, context),
            signed=raw.get("signed", False),
            zero_means=raw.get("zero_means", 0),
            power_of_two=raw.get("power_of_two", False),
            implemented=raw.get("implemented", True),
            reserved=raw.get("reserved", ""),
            explained_by=tuple(raw.get("explained_by", ())),
            unit=raw.get("unit", ""),
            default=raw.get("default"),
            meaning=raw.get("meaning", ""),
            note=raw.get("note", ""),
            source=context.sources(raw),
        )
        if container:
            rest = part.span - width
            yield zero_field(f"{raw['name']}_padding", part.low + width, rest, _widest(rest, context, interface), context.sources(raw), padding_of=raw["name"])


def _with_places(fields: Sequence[Field], context: Context, interface: str) -> list[Field]:
    """The fields from the lowest up. All order codes have a say: a field without bits lies where its neighbour does."""
    sets = _sets(context, interface)

    def place(field: Field) -> tuple[int, int]:
        lows = sum(field.low.value(parameters) for parameters in sets)
        return lows, sum(field.width.value(parameters) for parameters in sets)

    return sorted(fields, key=place)


def _in_order(fields: Sequence[Field], low_first: bool) -> Sequence[Field]:
    """Sending order for frames, from the top bit down for registers."""
    return fields if low_first else list(reversed(fields))


def _used_groups(raw: Raw, context: Context) -> list[Raw]:
    return [context.groups[item["use"]][0] for item in raw.get("fields", ()) if item.get("use") in context.groups]


def _gaps(fields: Sequence[Field], bits: Expression) -> Iterable[tuple[Field | None, Field | None, Expression, Expression]]:
    """Bits between neighbours, from the lowest up: the field below, the field above, first bit, width."""
    position, below = ZERO, None
    for field in fields:
        if (rest := field.low - position) != ZERO:
            yield below, field, position, rest
        position, below = field.low + field.width, field
    if (rest := bits - position) != ZERO:
        yield below, None, position, rest


def _covers(fields: Sequence[Field], bits: Expression, gaps: str, path: Path, context: Context, interface: str) -> bool:
    """Whether every bit has a field, or the spec says what the others are."""
    if gaps:
        return True
    for parameters in _sets(context, interface):
        position, below = 0, Expression(0)
        present = [field for field in fields if field.width.value(parameters)]
        for field in (*sorted(present, key=lambda item: item.low.value(parameters)), None):
            low = field.low if field is not None else bits
            if (first := low.value(parameters)) > position:
                where = f"{_bits(first - 1, position)}{_with(parameters, low, below)}"
                wrong = f"no field covers {where}; add one, or say 'other_bits: zero' or 'other_bits: unspecified'"
                context.report.add("bits-without-field", path, wrong)
                return False
            if field is not None:
                below = field.low + field.width
                position = below.value(parameters)
    return True


def _with_zeros(
    fields: Sequence[Field], bits: Expression, path: Path, context: Context, interface: str
) -> list[Field] | None:
    """The fields with a constant zero field in every gap, from the lowest up; None where fields change places."""
    zeros = []
    for below, above, low, width in _gaps(fields, bits):
        for parameters in _sets(context, interface):
            if width.value(parameters) < 0 and below is not None and above is not None:
                where = f"'{above.name}' is not above '{below.name}'{_with(parameters, low, width)}"
                context.report.add("bit-overlap", path, f"{where}; with 'other_bits: zero' fields keep their order")
                return None
        name = f"zero_below_{above.name}" if above is not None else f"zero_above_{below.name}" if below is not None else "zero"
        zeros.append(zero_field(name, low, width, _widest(width, context, interface), (above or below or fields[0]).source))
    return _with_places([*fields, *zeros], context, interface)


def _is_sound(layout: Layout, path: Path, context: Context, interface: str) -> bool:
    """What holds for a layout as a whole: lengths, values that fit, the CRC at the end."""
    before = len(context.report)
    report = context.report
    if layout.carried_as == "bytes" and (not layout.bits.is_constant or layout.bits.constant % 8):
        report.add("width-mismatch", path, f"'{layout.name}' takes {layout.bits.render()} bits, which is no whole number of bytes")
    if layout.carried_as == "bits" and layout.widest > LARGEST_NUMBER:
        report.add("too-long", path, f"'{layout.name}' takes {layout.widest} bits; {LARGEST_NUMBER} is the most")
    for field in layout.fields:
        here = (*path, "fields", field.name)
        narrowest = min((field.width.value(parameters) for parameters in _sets(context, interface)), default=0)
        if field.widest > LARGEST_NUMBER and field.kind != "text" and not field.padding_of and not field.name.startswith("zero_"):
            report.add("too-long", here, f"'{field.name}' takes {field.widest} bits; {LARGEST_NUMBER} is the most")
        # Where the width is a plain number, the rules on the text have looked already.
        if field.kind == "constant" and not field.width.is_constant and field.constant >> narrowest and narrowest:
            report.add("value-too-wide", here, f"the constant {field.constant:#x} does not fit into {narrowest} bits")
        if field.kind in ("flag", "parity") and field.width != Expression(1):
            report.add("width-mismatch", here, f"'{field.name}' is a {field.kind} of one bit; it takes {field.widest}")
        for value in field.values:
            if not field.width.is_constant and value.value >> field.widest:
                report.add("value-too-wide", here, f"the value '{value.name}' = {value.value:#x} does not fit into {field.widest} bits")
        if field.digits and field.digits[0].divisor * field.digits[0].modulus > 1 << field.widest:
            count = sum(run.digits for run in field.digits)
            report.add("value-too-wide", here, f"{count} decimal digits do not fit into {field.widest} bits")
        if field.kind == "text" and (field.widest % 8 or (isinstance(field.equals, str) and 8 * len(field.equals) != field.widest)):
            report.add("width-mismatch", here, f"the text of '{field.name}' does not fill its {field.widest} bits")
        if field.kind == "crc":
            _check_crc_field(layout, field, here, context)
    for selected in layout.selects:
        selector = next((field for field in layout.fields if field.name == layout.selector), None)
        if selector is not None and selector.values and selected not in [item.value for item in selector.values]:
            report.add("undefined-reference", (*path, "when"), f"'{layout.selector}' has no value {selected}")
    check_joined(layout, path, context, _sets(context, interface))
    return len(report) == before


def _check_crc_field(layout: Layout, field: Field, path: Path, context: Context) -> None:
    crc = context.crcs.get(field.crc)
    if crc is None:
        return
    if field.width != Expression(crc.width):
        context.report.add("width-mismatch", path, f"'{field.name}' takes {field.widest} bits; the CRC '{crc.name}' has {crc.width}")
    if field is not layout.fields[-1]:
        context.report.add("crc-not-last", path, f"'{field.name}' covers everything sent before it, so it has to be the last field of '{layout.name}'")
    if layout.carried_as == "bytes" and crc.width % 8:
        context.report.add("width-mismatch", path, f"a CRC of {crc.width} bits does not end a frame of whole bytes")
