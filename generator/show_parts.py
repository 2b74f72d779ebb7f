"""Parts of what ``codewheel show`` prints: interfaces, frames and registers as lines of at most 80 columns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from .decode import bit_place
from .expressions import Expression
from .model import Device, Field, Interface, Layout, PlacedField, PlacedLayout, Register, Timing, Value, Variant, cite
from .relevant import needed_parameters, run_time_widths
from .render import wrapped
from .words import counted, hertz, microseconds, number, timeout_words

WIDTH = 80
_ACCESS = {"read_only": "ro", "read_write": "rw", "write_only": "wo"}
_ALIGNMENT = {"msb_left": "left: the most significant bit comes first, zeros follow the word", "lsb_right": "right: zeros come before the word"}
_ABOVE_MAX = {"default": "above that the default", "refused": "above that refused"}


def pairs(rows: Iterable[tuple[str, str]], indent: int) -> list[str]:
    """Two columns; the second is wrapped in its own place."""
    listed = list(rows)
    width = min(max((len(name) for name, _ in listed), default=0), 40)
    start = " " * (indent + width + 2)
    return [wrapped(text, WIDTH, start, f"{' ' * indent}{name.ljust(width)}  ") if text else f"{' ' * indent}{name}" for name, text in listed]


def value(expression: Expression, parameters: Mapping[str, int] | None) -> str:
    """An expression as a number; without parameters as it is written, unless it is one."""
    if parameters is None and not expression.is_constant:
        return expression.render()
    return number(expression.value(parameters or {}))


def interface_lines(interface: Interface, code: str = "") -> list[str]:
    """One interface: clock, times, port, data IDs; ``code`` is that of an order code."""
    rows: list[tuple[str, str]] = []
    if interface.clock_min_hz is not None and interface.clock_max_hz is not None:
        rows.append(("clock", f"{hertz(interface.clock_min_hz)} to {hertz(interface.clock_max_hz)}  [{cite(interface.clock_source)}]"))
    rows += [(f"below {hertz(row.below_hz)}", f"with a cable shorter than {row.shorter_than_m} m  [{cite(row.source)}]") for row in interface.cable_lengths]
    if interface.timeout is not None:
        rows.append(("time-out", f"{timeout_words(interface.timeout)}  [{cite(interface.timeout.source)}]"))
    if interface.network is not None and not interface.network.multiple_slaves:
        rows.append(("network", f"one master and one slave only  [{cite(interface.network.source)}]"))
    if interface.port is not None:
        port = interface.port
        parity = f"{port.parity.replace('none', 'no')} parity"
        rows.append(("port", f"{number(port.baud)} Bd, {port.data_bits} data bits, {parity}, {counted(port.stop_bits, 'stop bit')}  [{cite(port.source)}]"))
    if interface.alignment:
        aligned = _ALIGNMENT.get(interface.alignment, interface.alignment)
        rows.append(("alignment", f"{aligned}  [{cite(interface.alignment_source)}]"))
    if code or interface.output_code:
        listed = {"by_order_code": "Gray or binary, by order code", "gray": "Gray"}
        rows.append(("code", f"{code or listed.get(interface.output_code, interface.output_code)}  [{cite(interface.output_code_source)}]"))
    rows += [(timing.symbol or timing.name, f"{_bounds(timing)}: {timing.meaning}  [{cite(timing.source)}]") for timing in interface.timings]
    rows += [(f"data ID {item.id:X}", f"{item.control:02X}h: {item.meaning}  [{cite(item.source)}]") for item in interface.data_ids]
    return [f"{interface.title}  [{cite(interface.source)}]", *pairs(rows, 2)]


def _bounds(timing: Timing) -> str:
    named = (("at least", timing.at_least_us), ("typically", timing.typical_us), ("at most", timing.at_most_us))
    return ", ".join(f"{word} {microseconds(count)}" for word, count in named if count is not None)


# ---------------------------------------------------------------------------------------------------------------- frames


def layout_lines(layout: Layout) -> list[str]:
    """A frame of a family: its fields with their widths, groups of fields in one line."""
    size = counted(layout.bits.constant // 8, "byte") if layout.carried_as == "bytes" else counted(layout.bits.render(), "bit")
    title = f"{layout.name}, from the {layout.sender}, {size}{channel(layout)}  [{cite(layout.source)}]"
    rows: dict[str, list[str]] = {}
    for item in layout.fields:
        width = item.width.constant if item.width.is_constant else item.width.render()
        rows.setdefault(item.group or item.name, []).append(f"{item.name} {width}" if item.group else counted(width, "bit") + _fixed(item))
    return [wrapped(title, WIDTH, "    ", "  "), *pairs(((name, ", ".join(parts)) for name, parts in rows.items()), 4)]


def _fixed(field: Field) -> str:
    return f", always {_constant(field)}" if field.kind == "constant" else ""


def _constant(field: Field) -> str:
    return f"{field.constant}" if field.constant < 10 else f"{field.constant:X}h"


def channel(layout: Layout) -> str:
    return f", data channel {layout.channel}" if layout.channel else ""


def frame_lines(device: Device, layout: Layout, variant: Variant) -> list[str]:
    """A frame of an order code: a title, a picture, and what registers may change of it."""
    placed = layout.place(variant.parameters)
    size = counted(placed.bits // 8, "byte") if layout.carried_as == "bytes" else counted(placed.bits, "bit")
    name = f"{layout.name} ({layout.printed_name})" if layout.printed_name else layout.name
    told = f", {layout.selector.replace('_', ' ')} {', '.join(f'{item:X}' for item in layout.selects)}" if layout.selects else ""
    title = f"{name}, from the {layout.sender}, {size}{channel(layout)}{told}  [{cite(layout.source)}]"
    lines = [wrapped(title, WIDTH, "  ", ""), *picture(placed)]
    widths = run_time_widths(device, layout)
    if widths:
        held = " and ".join(place_of(device, path) for path in widths)
        lines.append(wrapped(f"as delivered: the widths are those in {held}", WIDTH, "  ", "  "))
    if layout.gray_of and layout.gray_when:
        names = needed_parameters(device, layout.gray_when)
        held = ", ".join(place_of(device, item.read_from) for item in device.run_time_parameters if item.name in names)
        decided = f", as delivered ({held})" if held else ""
        lines.append(wrapped(f"{layout.gray_of} in {'Gray code' if placed.gray else 'binary'}{decided}", WIDTH, "  ", "  "))
    return lines


def place_of(device: Device, path: str) -> str:
    """A register field with its addresses: ``register 49, configuration.output_code``."""
    register = device.register(path.partition(".")[0])
    address = f"{register.address:02X}" if register.length == 1 else f"{register.address:02X}-{register.last_address:02X}"
    return f"register {address}, {path}"


def picture(placed: PlacedLayout) -> list[str]:
    """The layout as a row of boxes in sending order, broken to the width of a terminal."""
    rows: list[tuple[str, str]] = []
    lines: list[str] = []

    def flush() -> None:
        if rows:
            edge = "  +" + "+".join("-" * len(name) for name, _ in rows) + "+"
            lines.extend(["  " + "".join(f" {place}" for _, place in rows).rstrip(), edge, "  |" + "|".join(name for name, _ in rows) + "|", edge])
            rows.clear()

    used = 3
    for item in placed.fields:
        name = _box(item.field)
        place = bit_place(placed.layout, placed.bits, item.high, item.low)
        width = max(len(name), len(place)) + 2
        if used + width + 1 > WIDTH:
            flush()
            used = 3
        rows.append((name.center(width), place.center(width)))
        used += width + 1
    flush()
    return lines


def _box(field: Field) -> str:
    """What stands in the box of a field; of a constant its value, and its name where that says more."""
    if field.kind != "constant":
        return field.name
    return _constant(field) if field.padding_of or field.name.startswith("zero") else f"{field.name} = {_constant(field)}"


# ------------------------------------------------------------------------------------------------------------- registers


def register_lines(registers: Sequence[Register], variant: Variant | None) -> list[str]:
    """A register a paragraph; for an order code with its fields."""
    if not registers:
        return []
    parameters = variant.parameters if variant is not None else None
    lines = ["", "Registers (addresses in hex)"]
    for item in registers:
        place = f"{item.address:02X}" if item.length == 1 else f"{item.address:02X}-{item.last_address:02X}"
        head = f"  {place:<7} {_ACCESS[item.access]}  {item.name}  "
        lines.append(wrapped("; ".join([*_facts(item, parameters), f"[{cite(item.source)}]"]), WIDTH, " " * 14, head))
        for meaning in item.meanings:
            span = f" {_span(meaning.min, meaning.max, parameters)}" if meaning.max is not None else ""
            lines.append(wrapped(f"{meaning.name}{span} while {meaning.when} is {meaning.value}", WIDTH, " " * 16, " " * 14))
        if parameters is not None and len(item.layout.fields) > 1:
            placed = item.layout.place(parameters)
            lines += pairs(((f"{part.high}:{part.low}" if part.width > 1 else f"{part.low}", _field(part)) for part in placed.fields), 14)
        lines += pairs(((f"{choice.value:02X}", _choice(choice, variant)) for choice in item.values), 14)
    return lines


def _choice(choice: Value, variant: Variant | None) -> str:
    """A value of a register that is one choice, with the first sentence of its meaning."""
    meaning = choice.meaning.partition(". ")[0]
    return f"{choice.name}: {meaning}" if meaning else choice.name


def _facts(register: Register, parameters: Mapping[str, int] | None) -> Iterator[str]:
    fields = register.layout.fields
    if register.bank is not None:
        yield f"bank {register.bank}"
    if register.length > 1:
        yield register.byte_order.replace("_", " ")
    data = register.default_bytes()
    if data is not None:
        yield f"default {data.hex(' ').upper()}"
    if len(fields) == 1 and fields[0].equals is not None and data is None:
        yield _equal(fields[0], register, parameters)
    if register.max is not None:
        above = f", {_ABOVE_MAX.get(register.above_max, register.above_max)}" if register.above_max else ""
        yield f"{register.limits_of} {_span(register.min, register.max, parameters)}{above}"
    yield from ("powers of two only" for field in fields if field.power_of_two)
    yield from (f"0 means {number(field.zero_means)}" for field in fields if field.zero_means)
    if register.opened_by:
        yield f"opened by {'.'.join(filter(None, (register.opened_by, register.opened_by_field)))} = {register.opened_by_value}"
    if register.write_clears:
        yield f"a write clears {', '.join(register.write_clears)}"
    if register.clears_itself:
        yield "clears itself"
    if register.wait_at_least_ms:
        yield f"then wait {register.wait_at_least_ms} ms"
    if register.reserved:
        yield f"reserved for the {register.reserved}"


def _equal(field: Field, register: Register, parameters: Mapping[str, int] | None) -> str:
    if isinstance(field.equals, Expression):
        if parameters is None and not field.equals.is_constant:
            return f"equals {field.equals.render()}"
        return f"is {field.equals.value(parameters or {}):0{2 * register.length}X}h"
    return f"is {field.equals:0{2 * register.length}X}h" if isinstance(field.equals, int) else f"is {field.equals}"


def _span(low: Expression | None, high: Expression, parameters: Mapping[str, int] | None) -> str:
    return f"{value(low, parameters) if low is not None else 0} to {value(high, parameters)}"


def _field(part: PlacedField) -> str:
    """The name of a field, and its values where they are few words."""
    field = part.field
    if field.kind == "constant":
        return f"always {_constant(field)}" if field.name.startswith(("zero", "unused")) else f"{field.name}, always {_constant(field)}"
    if field.values and part.width < 8:
        default = f"; default {field.default}" if field.default is not None else ""
        return f"{field.name}: " + ", ".join(f"{choice.value} {choice.name}" for choice in field.values) + default
    return f"{field.name}, is {field.equals}" if isinstance(field.equals, str) else field.name
