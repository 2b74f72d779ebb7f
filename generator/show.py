"""``codewheel list`` and ``codewheel show`` for a person, at most 80 columns wide."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from .decode import bit_place
from .model import Device, Layout, PlacedLayout, Register, Timing, Variant, cite
from .order_codes import Match
from .render import wrapped

_WIDTH = 80
_ACCESS = {"read_only": "ro", "read_write": "rw", "write_only": "wo"}


def list_data(devices: Sequence[Device]) -> dict[str, Any]:
    """The families as plain data."""
    return {
        "version": 1,
        "families": [
            {
                "family": device.name,
                "title": device.title,
                "manufacturer": device.manufacturer.title,
                "interfaces": [item.kind for item in device.interfaces],
                "pattern": device.order_code.pattern,
                "order_codes": [variant.code for variant in device.variants],
                "manual": {"title": device.manual.title, "revision": device.manual.revision, "date": device.manual.date or None},
            }
            for device in devices
        ],
    }


def list_text(devices: Sequence[Device]) -> str:
    """A few lines for each family."""
    lines = []
    for device in devices:
        manual = f"{device.manual.title}, revision {device.manual.revision}" + (f" of {device.manual.date}" if device.manual.date else "")
        lines += [
            wrapped(f"{device.title} ({device.manufacturer.title})", _WIDTH, " " * 10, f"{device.name:<8}  "),
            *_pairs(
                [
                    ("interfaces", ", ".join(item.title for item in device.interfaces)),
                    ("order codes", f"{len(device.variants)}, {device.order_code.pattern}"),
                    ("manual", manual),
                ],
                10,
            ),
            "",
        ]
    return "\n".join(lines).rstrip()


def device_text(device: Device) -> str:
    """A family: what its order codes decide, its interfaces, registers, procedures and errata."""
    lines = [wrapped(f"{device.title} ({device.manufacturer.title})", _WIDTH), *_manual(device), "", f"Order codes: {device.order_code.pattern}"]
    for part in device.order_code.parts:
        lines.append(wrapped(part.meaning, _WIDTH, "    ", f"  {part.name}: "))
        lines += _pairs([(value.text, value.meaning) for value in part.values], 4)
    lines += ["", "Parameters"]
    lines += _pairs([(item.name, item.meaning + (f" (= {item.equals.render()})" if item.equals else "")) for item in device.parameters], 2)
    for interface in device.interfaces:
        lines += ["", *_interface(device, interface.kind)]
        for layout in interface.layouts:
            lines.append(wrapped(f"{layout.name}, from the {layout.sender}, {_bits(layout)}  [{cite(layout.source)}]", _WIDTH, "    ", "  "))
            lines += _pairs([(field.name, f"{field.width.render()} bit") for field in layout.fields], 4)
    lines += _registers(device, device.registers, None)
    lines += _procedures(device, None)
    return "\n".join([*lines, *_errata(device)])


def variant_text(device: Device, match: Match) -> str:
    """One order code: interface, widths, frame pictures, registers and limits."""
    variant = match.variant
    lines = [wrapped(f"{variant.code}: {device.title} ({device.manufacturer.title})", _WIDTH, "  ", "")]
    if match.unlisted:
        lines.append(wrapped(f"not listed in the manual, taken as any other: {', '.join(match.unlisted)}", _WIDTH, "  "))
    if match.tail:
        lines.append(f"  the label goes on with {match.tail}")
    if match.special:
        lines.append(wrapped(device.order_code.special or "A code that ends in /Sxxx may differ from the manual.", _WIDTH, "  "))
    lines += [*_manual(device), "", "Parameters"]
    lines += _pairs([(item.name, f"{variant.parameters[item.name]:,}".replace(",", " ") + f"  {item.meaning}") for item in device.parameters], 2)
    lines += ["", *_interface(device, variant.interface)]
    for layout in device.interface(variant.interface).layouts:
        placed = layout.place(variant.parameters)
        size = f"{placed.bits // 8} bytes" if layout.carried_as == "bytes" else f"{placed.bits} bits"
        title = f"{layout.printed_name or layout.name}, from the {layout.sender}, {size}  [{cite(layout.source)}]"
        lines += ["", wrapped(title, _WIDTH, "  ", ""), *picture(placed)]
    lines += _registers(device, [item for item in device.registers if item.interface == variant.interface], variant)
    lines += _procedures(device, variant)
    others = tuple(f"interfaces.{item.kind}" for item in device.interfaces if item.kind != variant.interface)
    return "\n".join([*lines, *_errata(device, others)])


def picture(placed: PlacedLayout) -> list[str]:
    """The layout as a row of boxes in sending order, broken to the width of a terminal."""
    rows: list[tuple[str, str, str]] = []
    lines: list[str] = []

    def flush() -> None:
        if rows:
            edge = "  +" + "+".join("-" * len(row[0]) for row in rows) + "+"
            lines.extend(["  " + "".join(f" {row[1]}" for row in rows).rstrip(), edge, "  |" + "|".join(row[0] for row in rows) + "|", edge])
            rows.clear()

    used = 3
    for item in placed.fields:
        name = f"={item.field.constant:#x}" if item.field.kind == "constant" and item.name.startswith(("zero", item.field.padding_of + "_pad")) else item.name
        place = bit_place(placed.layout, placed.bits, item.high, item.low)
        width = max(len(name), len(place)) + 2
        if used + width + 1 > _WIDTH:
            flush()
            used = 3
        rows.append((name.center(width), place.center(width), ""))
        used += width + 1
    flush()
    return lines


def _manual(device: Device) -> list[str]:
    date = f" of {device.manual.date}" if device.manual.date else ""
    return [wrapped(f"from the manual {device.manual.title}, revision {device.manual.revision}{date} ({device.manual.language})", _WIDTH, "  ")]


def _bits(layout: Layout) -> str:
    return f"{layout.bits.constant // 8} bytes" if layout.carried_as == "bytes" else f"{layout.bits.render()} bits"


def _interface(device: Device, kind: str) -> list[str]:
    interface = device.interface(kind)
    pairs = []
    if interface.clock_min_hz is not None and interface.clock_max_hz is not None:
        pairs.append(("clock", f"{_hertz(interface.clock_min_hz)} to {_hertz(interface.clock_max_hz)}  [{cite(interface.clock_source)}]"))
    if interface.timeout is not None:
        half = interface.timeout.half_clock_periods
        rule = f"{half / 2:g} clock periods" if half else interface.timeout.rule.replace("_", " ")
        bound = f", at most {interface.timeout.at_most_ns / 1000:g} µs" if interface.timeout.at_most_ns else ""
        pairs.append(("time-out", f"{rule}{bound}  [{cite(interface.timeout.source)}]"))
    if interface.port is not None:
        port = interface.port
        pairs.append(("port", f"{port.baud} Bd, {port.data_bits} data bits, parity {port.parity}, {port.stop_bits} stop bit  [{cite(port.source)}]"))
    if interface.alignment:
        pairs.append(("alignment", interface.alignment.replace("_", " ")))
    if interface.output_code:
        pairs.append(("code", interface.output_code.replace("_", " ")))
    pairs += [(f"max. {_hertz(row.below_hz)}", f"cable shorter than {row.shorter_than_m} m") for row in interface.cable_lengths]
    pairs += [(timing.symbol or timing.name, f"{_bounds(timing)}: {timing.meaning}  [{cite(timing.source)}]") for timing in interface.timings]
    pairs += [(f"ID {item.id:X}", f"control field {item.control:02X}h, {item.meaning}") for item in interface.data_ids]
    return [f"{interface.title}  [{cite(interface.source)}]", *_pairs(pairs, 2)]


def _hertz(value: int) -> str:
    for factor, unit in ((1_000_000, "MHz"), (1_000, "kHz")):
        if value >= factor:
            return f"{value / factor:g} {unit}"
    return f"{value} Hz"


def _bounds(timing: Timing) -> str:
    named = (("at least", timing.at_least_us), ("typically", timing.typical_us), ("at most", timing.at_most_us))
    return ", ".join(f"{word} {_time(value)}" for word, value in named if value is not None)


def _time(microseconds: int) -> str:
    for factor, unit in ((1_000_000, "s"), (1_000, "ms")):
        if microseconds >= factor and microseconds % factor == 0:
            return f"{microseconds // factor} {unit}"
    return f"{microseconds} µs"


def _registers(device: Device, registers: Sequence[Register], variant: Variant | None) -> list[str]:
    if not registers:
        return []
    lines = ["", "Registers (addresses in hex)"]
    for item in registers:
        place = f"{item.address:02X}" if item.length == 1 else f"{item.address:02X}-{item.last_address:02X}"
        facts = [item.byte_order.replace("_", " ")] if item.length > 1 else []
        data = item.default_bytes()
        if data is not None:
            facts.append(f"default {data.hex(' ').upper()}")
        if item.max is not None:
            low = item.min.value(variant.parameters) if item.min and variant else item.min.render() if item.min else 0
            high = item.max.value(variant.parameters) if variant else item.max.render()
            facts.append(f"{item.limits_of} {low} to {high}")
        if item.opened_by:
            facts.append(f"opened by {item.opened_by} = {item.opened_by_value}")
        if item.clears_itself:
            facts.append("clears itself")
        if item.wait_at_least_ms:
            facts.append(f"then wait {item.wait_at_least_ms} ms")
        head = f"  {place:<7} {_ACCESS[item.access]}  {item.name}  "
        lines.append(wrapped("; ".join([*facts, f"[{cite(item.source)}]"]), _WIDTH, " " * 14, head))
        if variant is not None and len(item.layout.fields) > 1:
            placed = item.layout.place(variant.parameters)
            lines += _pairs([(f"{part.high}:{part.low}" if part.width > 1 else str(part.low), part.name) for part in placed.fields], 14)
        lines += _pairs([(f"{value.value:02X}", f"{value.name}: {value.meaning}" if value.meaning else value.name) for value in item.values], 14)
    return lines


def _procedures(device: Device, variant: Variant | None) -> list[str]:
    found = [item for item in device.procedures if variant is None or item.interface == variant.interface]
    if not found:
        return []
    return ["", "Procedures", *_pairs([(item.name, f"{item.title}  [{cite(item.source)}]") for item in found], 2)]


def _errata(device: Device, without: tuple[str, ...] = ()) -> list[str]:
    """The errata, but for those that touch only what begins with one of ``without``."""
    found = [item for item in device.errata if not item.affects or not all(path.startswith(without) for path in item.affects)]
    if not found:
        return []
    lines = ["", "Errata of the manual"]
    for item in found:
        lines.append(wrapped(f"{item.name}: {item.status}, {item.severity.replace('_', ' ')}  [{cite(item.source)}]", _WIDTH, "    ", "  "))
        lines += [wrapped(item.printed, _WIDTH, " " * 13, "    printed: "), wrapped(item.used, _WIDTH, " " * 13, "    used:    ")]
    return lines


def _pairs(pairs: Iterable[tuple[str, str]], indent: int) -> list[str]:
    """Two columns; the second is wrapped in its own place."""
    rows = list(pairs)
    width = min(max((len(name) for name, _ in rows), default=0), 34)
    start = " " * (indent + width + 2)
    return [wrapped(text, _WIDTH, start, f"{' ' * indent}{name.ljust(width)}  ") if text else f"{' ' * indent}{name}" for name, text in rows]
