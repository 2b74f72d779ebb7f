"""``codewheel decode``: the text of a frame in, every bit named out, and where it does not fit, what would make it fit."""

from __future__ import annotations

from typing import Any

from . import codec
from .findings import Findings, Report
from .frame_text import FrameTextError, checked, frame_bytes, frame_number
from .model import Device, Layout, PlacedLayout, Variant
from .order_codes import Match
from .relevant import parameters_of
from .render import wrapped
from .run_time import decode_register
from .why import Explanation, Why, explain_bits, explain_bytes, explain_constant
from .words import WORTH, counted, sentence

VERSION = 1


def decode_text(device: Device, variant: Variant, sender: str, text: str, layout: str | None = None) -> codec.Decoded:
    """The frame that ``text`` writes, decoded.

    Args:
        device: The family.
        variant: The order code.
        sender: ``encoder`` or ``master``.
        text: Hex bytes where the line carries bytes; where it carries bits one number, ``0b`` with every digit or ``0x``.
        layout: The layout's name; without it, the one that the frame tells, or else the sender's first.

    Raises:
        FrameTextError: The text cannot be read as a frame, or there is no such layout.
    """
    text = checked(text)
    layouts = [item for item in device.interface(variant.interface).layouts if item.sender == sender]
    if not layouts:
        raise FrameTextError(f"over {device.interface(variant.interface).title} the {sender} sends no frame that the manual describes")
    if layout is None:
        if layouts[0].carried_as == "bytes":
            return codec.decode_bytes(device, variant, sender, frame_bytes(text))
        return _decode_bits(device, layouts[0].place(variant.parameters), text)
    placed = next((item.place(variant.parameters) for item in layouts if item.name == layout), None)
    if placed is None:
        raise FrameTextError(f"{variant.code} has no layout '{layout}' from the {sender}; it has: {', '.join(item.name for item in layouts)}")
    return codec.decode_placed(device, placed, frame_bytes(text)) if placed.layout.carried_as == "bytes" else _decode_bits(device, placed, text)


def decode_register_text(device: Device, variant: Variant, name: str, text: str) -> codec.Decoded:
    """The value of the register ``name`` from hex bytes in ascending order of address.

    Raises:
        FrameTextError: The text is no hex bytes.
        RegisterError: There is no such register, or it has another length.
    """
    return decode_register(device, variant, name, frame_bytes(checked(text)))


def _decode_bits(device: Device, placed: PlacedLayout, text: str) -> codec.Decoded:
    given = frame_number(placed, text)
    if given.exact and given.bits != placed.bits:
        wrong = f"'{placed.name}' has {placed.bits} bits; this has {given.bits}"
        return codec.Decoded(placed, given.number, (), None, (codec.Problem("length", "", wrong),))
    return codec.decode(device, placed, given.number)


def why_text(device: Device, variant: Variant, sender: str, text: str, decoded: codec.Decoded) -> Why | None:
    """What would explain the frame that ``text`` writes, if its CRC, length or a constant is wrong.

    ``decoded`` is what ``decode_text`` made of it.
    """
    placed = decoded.layout
    wrong = {item.kind for item in decoded.problems}
    if placed is not None and placed.layout.carried_as == "bits":
        given = frame_number(placed, text.strip())
        if wrong & {"crc", "length"}:
            return explain_bits(device, variant, placed, given)
        return explain_constant(device, variant, placed, given) if "constant" in wrong else None
    if placed is not None and not wrong & {"crc", "length"}:
        return None
    return explain_bytes(device, variant, sender, placed, frame_bytes(text.strip()))


def decoded_data(
    variant: Variant, sender: str, decoded: codec.Decoded, said: Findings, why: Why | None = None, line: int | None = None
) -> dict[str, Any]:
    """The result as plain data, in the shape of ``decode.schema.json``; ``line`` is that of standard input, if any."""
    return {
        "version": VERSION,
        "line": line,
        "order_code": variant.code,
        "layout": decoded.layout.name if decoded.layout is not None else None,
        "direction": sender,
        "fields": [{"name": item.name, "raw": item.raw, "value": item.value, "unit": item.unit or None, "meaning": item.meaning} for item in decoded.fields],
        "crc": {"received": decoded.crc.received, "computed": decoded.crc.computed, "ok": decoded.crc.ok} if decoded.crc is not None else None,
        "problems": [{"kind": item.kind, "field": item.field or None, "message": item.message} for item in decoded.problems],
        "reports": [_report_data(item) for item in said.reports],
        "verdict": said.verdict or None,
        "differences": [
            {"field": item.field, "found": item.found, "documented": item.documented, "message": item.message}
            for item in said.differences
        ],
        "why": _why_data(why) if why is not None else None,
    }


def _report_data(report: Report) -> dict[str, Any]:
    return {
        "field": report.field,
        "meaning": report.meaning,
        "remedy": report.remedy or None,
        "makes_position": report.makes_position or None,
    }


def _why_data(why: Why) -> dict[str, Any]:
    return {
        "explanations": [
            {"kind": item.kind, "text": item.text, "one_in": item.one_in, "twice": item.twice, "order_codes": list(item.codes), "reads": dict(item.reads)}
            for item in why.explanations
        ],
        "tried": why.tried,
        "coincidence": round(why.coincidence, 4),
        "cannot_see": list(why.cannot_see),
    }


def explain(
    device: Device, match: Match, sender: str, decoded: codec.Decoded, said: Findings = Findings(), why: Why | None = None,
    line: int | None = None,
) -> str:
    """The result for a person, at most 80 columns wide."""
    variant = match.variant
    is_frame = decoded.layout is None or decoded.layout.layout.sender != ""
    start = f"line {line}: " if line is not None else ""
    lines = [f"{start}{variant.code}, {device.interface(variant.interface).title}" + (f", from the {sender}" if is_frame else "")]
    held = [item for item in parameters_of(device, variant.interface) if item.read_from]
    if held:
        state = ", ".join(f"{item.name} = {variant.parameters[item.name]}" for item in held)
        lines.append(wrapped(f"with {state} (from registers; --register changes them)", 80, "  "))
    if match.written_as_in:
        lines.append(wrapped(f"the label is written as in {match.written_as_in}", 80, "  "))
    if match.unlisted:
        lines.append(f"  not listed in the manual, taken as any other: {', '.join(match.unlisted)}")
    if match.special:
        lines.append(wrapped(device.order_code.special or "A code that ends in /Sxxx may differ from the manual.", 80, "  "))
    if decoded.layout is not None:
        title = decoded.layout.layout.printed_name or decoded.layout.name.replace("_", " ")
        channel = f", data channel {decoded.layout.layout.channel}" if decoded.layout.layout.channel else ""
        lines.append(f"{title}, {_size(decoded.layout)}{channel}")
    if decoded.fields:
        lines += ["", *_table(decoded)]
        # An angle in degrees looks too good for a position that is not to be used.
        measured = _measured(device, variant, decoded) if said.verdict not in ("", "not_usable") else ""
        lines += ["", measured] if measured else []
    crc = decoded.crc
    if crc is not None:
        parameters = device.crc(crc.name)
        verdict = "as it has to be" if crc.ok else f"WRONG, over the bits before it the CRC is {crc.computed:#04x}"
        inverted = f", start value {parameters.init:#x}" if parameters.init else ""
        inverted += ", sent inverted" if parameters.xorout == parameters.mask else ""
        lines += ["", wrapped(f"CRC {crc.received:#04x}: {verdict} ({parameters.polynomial}{inverted})", 80, "  ", "")]
    lines.append("")
    lines += [wrapped(f"{item.kind} fault: {item.message}", 80, "  ", "") for item in decoded.problems]
    lines += [wrapped(f"not as documented: {item.message}", 80, "  ", "") for item in said.differences]
    if not decoded.problems:
        lines += _last_words(decoded, said)
    lines += _why_lines(why) if why is not None else []
    return "\n".join(lines)


def _last_words(decoded: codec.Decoded, said: Findings) -> list[str]:
    """How the text on a sound frame or register ends: what the encoder reports, or that nothing is wrong."""
    if said.reports:
        lines = ["the encoder reports:", *(wrapped(_reported(item), 80, " " * 6, "  - ") for item in said.reports)]
        return [*lines, f"so {WORTH[said.verdict]}"] if said.verdict else lines
    is_frame = decoded.layout is not None and decoded.layout.layout.sender != ""
    words = ["no other fault" if said.differences else "no fault"]
    words += ["this frame carries no CRC"] if is_frame and decoded.crc is None else []
    words += [WORTH["not_told"]] if said.verdict == "not_told" else []
    return [wrapped("; ".join(words), 80, "  ", "")]


def _reported(report: Report) -> str:
    name = f"{report.field} ({report.printed_name})" if report.printed_name else report.field
    return f"{name}: {sentence(report.meaning)} {sentence(report.remedy)}" if report.remedy else f"{name}: {report.meaning}"


def _measured(device: Device, variant: Variant, decoded: codec.Decoded) -> str:
    """The position in degrees or micrometres; of a frame with the angle alone, that."""
    measurement = device.measurement_of(variant.interface)
    if measurement is None:
        return ""
    name = measurement.of
    if name not in decoded.values:
        joins = [join for layout in device.interface(variant.interface).layouts for join in layout.joins]
        name = next((join.fields[-1] for join in joins if join.name == name), name)
    value = decoded.values.get(name)
    if not isinstance(value, int):
        return ""
    terms = (measurement.step_um, measurement.steps_per_turn, measurement.turns)
    step, per_turn, turns = (item.value(variant.parameters) if item is not None else 0 for item in terms)
    if step:
        return f"{name}: {value * step:,} µm"
    if per_turn < 1:
        return ""
    turn, counts = divmod(value, per_turn)
    degrees = f"{counts * 360 / per_turn:.{len(str(per_turn // 360))}f}°"
    return f"{name}: {degrees}" + (f" of revolution {turn:,}" if turns > 1 and name == measurement.of else "")


def _why_lines(why: Why) -> list[str]:
    by_chance = f"{100 * why.coincidence:.0f}" if why.coincidence >= 0.005 else "less than 1"
    tried = f"{why.tried} usual mistake{'s' if why.tried > 1 else ''}"
    noise = f"{tried} tried; of 100 frames of random bits {by_chance} would fit one or more of them"
    if not why.explanations:
        lines = ["", wrapped(f"Nothing usual would make it fit ({noise}).", 80, "  ", "")]
    else:
        twice = "No single mistake would make it fit. Two at once would" if why.explanations[-1].twice else "What would make it fit"
        lines = ["", wrapped(f"{twice}, likeliest first ({noise}):", 80, "  ", "")]
        for item in why.explanations:
            lines.append(wrapped(item.text, 80, " " * 6, "    - "))
            lines.append(wrapped(_beside(item), 80, " " * 6, " " * 6))
    return [*lines, wrapped(f"Such a CRC cannot see {'; nor '.join(why.cannot_see)}.", 80, "  ", "")]


def _beside(item: Explanation) -> str:
    reads = ", ".join(f"{name} {value}" for name, value in item.reads.items())
    return f"by coincidence in {_one_in(item.one_in)} frames" + (f"; it would read {reads}" if reads else "")


def _one_in(number: int) -> str:
    return f"1 of {number:,}" if number < 1_000_000 else "less than 1 of a million"


def _size(placed: PlacedLayout) -> str:
    return counted(placed.bits // 8, "byte") if placed.layout.carried_as == "bytes" else counted(placed.bits, "bit")


def bit_place(layout: Layout, bits: int, high: int, low: int) -> str:
    """Where a field stands, as a person counts: ``bits 46:31``, or ``byte 2 bits 7:4`` with the first byte as 0."""
    if layout.carried_as == "bits":
        return f"{high}:{low}" if high != low else f"{high}"
    last = bits // 8 - 1
    first_byte, last_byte = (low // 8, high // 8) if layout.byte_order == "low_byte_first" else (last - high // 8, last - low // 8)
    if first_byte != last_byte:
        whole = low % 8 == 0 and high % 8 == 7
        return f"bytes {first_byte}-{last_byte}" if whole else f"bytes {first_byte}.{low % 8}-{last_byte}.{high % 8}"
    if high - low == 7:
        return f"byte {first_byte}"
    return f"byte {first_byte}.{high % 8}" + (f":{low % 8}" if high != low else "")


def _table(decoded: codec.Decoded) -> list[str]:
    assert decoded.layout is not None
    rows = []
    for item in decoded.fields:
        place = bit_place(decoded.layout.layout, decoded.layout.bits, item.high, item.low) if item.high >= 0 else ""
        value = {True: "yes", False: "no"}[item.value] if isinstance(item.value, bool) else str(item.value)
        raw = f"{item.raw:#x}" if item.high > item.low or item.high < 0 else str(item.raw)
        unit = f" {item.unit}" if item.unit and not isinstance(item.value, bool) else ""
        rows.append((place, item.name, raw, value + unit, item.meaning))
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    lines = []
    for row in rows:
        start = "  ".join(text.ljust(width) for text, width in zip(row, widths))
        indent = " " * (len(start) + 2)
        if len(indent) > 56:
            lines.append(start.rstrip())
            if row[4]:
                lines.append(wrapped(row[4], 80, " " * 6))
        else:
            lines.append(wrapped(row[4], 80, indent, start + "  ") if row[4] else start.rstrip())
    return lines
