"""``codewheel decode``: decode the text of a frame, and explain why its CRC or length is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ..model import Crc, Device, Fault, Layout, PlacedLayout, Scale, Variant, Verdict
from ..model.layout import have_lengths
from ..order_codes.labels import Match
from ..order_codes.parameters import parameters_of
from ..reference import codec
from ..reference.findings import Findings, Report
from ..reference.registers import decode_register
from ..say.evidence import placeholders
from ..say.lines import WIDTH
from ..say.lines import wrapped as wrapped_anew
from ..say.name import words
from ..say.numbers import decimal, quantity
from ..say.origin import origin
from ..say.text import BY_NAME
from ..say.words import WORTH, counted, sentence, with_unit
from .frame_text import FrameTextError, Line, checked, frame_bytes, frame_number, placed_bytes

if TYPE_CHECKING:
    from ..why.mistakes import Explanation, Why

VERSION = 1
_NOTHING_TAKEN: Mapping[str, str] = MappingProxyType({})
_NO_LINE = Line(None, "", "")
#: Most paragraphs are the same for all frames.
wrapped = lru_cache(maxsize=1024)(wrapped_anew)


def decode_text(device: Device, variant: Variant, sender: str, text: str, layout: str | None = None) -> codec.Decoded:
    """Decode a frame given as text.

    Args:
        device: The family.
        variant: The order code.
        sender: ``encoder`` or ``master``.
        text: Hex bytes for a line that carries bytes. For a line that carries bits, one number: ``0b`` with every
            digit, or ``0x``.
        layout: The layout's name. By default, the one that the frame identifies by its selector or its length, or else
            the sender's first.

    Raises:
        FrameTextError: The text cannot be read as a frame, or there is no such layout.
    """
    return text_decoder(device, variant, sender, layout)(text)


def text_decoder(device: Device, variant: Variant, sender: str, layout: str | None) -> Callable[[str], codec.Decoded]:
    """Return a function that decodes many frames, each like ``decode_text``."""
    layouts = [
        interface_layout
        for interface_layout in device.interface(variant.interface).layouts
        if interface_layout.sender == sender
    ]
    wanted_layouts = (sender_layout for sender_layout in layouts if sender_layout.name == layout or layout is None)
    placed = next((sender_layout.place(variant.parameters) for sender_layout in wanted_layouts), None)
    exact = have_lengths(layouts, sender)

    def decoded(text: str) -> codec.Decoded:
        text = checked(text)
        if not layouts:
            raise FrameTextError(
                f"the manual describes no frame from the {sender} over {device.interface(variant.interface).title}"
            )
        if placed is None:
            known_layouts = ", ".join(layout.name for layout in layouts)
            all_layouts = device.interface(variant.interface).layouts
            from_other = next(
                (
                    f" (add --from {interface_layout.sender})"
                    for interface_layout in all_layouts
                    if interface_layout.name == layout
                ),
                "",
            )
            raise FrameTextError(
                f"{variant.code} has no layout '{layout}' from the {sender}{from_other}; it has: {known_layouts}"
            )
        if placed.layout.in_bytes and layout is None:
            return codec.decode_bytes(device, variant, sender, placed_bytes(placed, variant, text))
        fitting_layout = _of_length(text, placed, layouts, variant) if exact and layout is None else placed
        return decoded_as(device, variant, fitting_layout, text, exact=exact)

    return decoded


def decode_register_text(device: Device, variant: Variant, name: str, text: str) -> codec.Decoded:
    """Decode the value of the register ``name`` from hex bytes in ascending order of address.

    Raises:
        FrameTextError: The text is not hex bytes.
        RegisterError: There is no such register, or it has another length.
    """
    return decode_register(device, variant, name, frame_bytes(checked(text)))


def _of_length(text: str, first: PlacedLayout, layouts: Sequence[Layout], variant: Variant) -> PlacedLayout:
    """Return the only layout that has the length of the text, or ``first`` if that fits or several do."""
    if _has_length(first, text):
        return first
    fitting_layouts = [
        candidate
        for candidate in (layout.place(variant.parameters) for layout in layouts)
        if _has_length(candidate, text)
    ]
    return fitting_layouts[0] if len(fitting_layouts) == 1 else first


def _has_length(placed: PlacedLayout, text: str) -> bool:
    """Return whether bits or bytes are as many as the layout has. A number in hex can have leading zeros."""
    frame, bits = frame_number(placed, text, exact=True), placed.layout.sent_bits.value(placed.parameters)
    return frame.bits == bits if frame.exact else frame.bits <= bits


def decoded_as(device: Device, variant: Variant, placed: PlacedLayout, text: str, *, exact: bool) -> codec.Decoded:
    """Decode ``checked`` text with a known layout. ``exact`` is that of ``frame_number``.

    Raises:
        FrameTextError: The text cannot be read as a frame.
    """
    if placed.layout.in_bytes:
        return codec.decode_placed(device, placed, placed_bytes(placed, variant, text))
    frame = frame_number(placed, text, exact=exact)
    if frame.exact:
        return codec.decode_bits(device, placed, frame.number, frame.bits)
    return codec.decode(device, placed, frame.number)


def why_text(device: Device, variant: Variant, sender: str, text: str, decoded: codec.Decoded) -> Why | None:
    """Return explanations of a frame whose CRC, length or constant is wrong. ``decoded`` is its ``decode_text``."""
    placed = decoded.layout
    faults = {problem.fault for problem in decoded.problems}
    has_no_crc = placed is not None and not faults and decoded.crc is None
    is_flat = placed is not None and not placed.layout.in_bytes and decoded.number in (0, (1 << placed.bits) - 1)
    if placed is not None and not (has_no_crc or is_flat) and not faults & {Fault.CRC, Fault.LENGTH, Fault.CONSTANT}:
        return None
    from ..why.mistakes import explain_bits, explain_bytes, explain_constant

    if placed is not None and not placed.layout.in_bytes:
        exact = have_lengths(device.interface(variant.interface).layouts, sender)
        frame = frame_number(placed, checked(text), exact=exact)
        if faults & {Fault.CRC, Fault.LENGTH} or has_no_crc or is_flat:
            return explain_bits(device, variant, placed, frame, is_valid=not faults)
        return explain_constant(device, variant, placed, frame)
    if placed is not None and not faults & {Fault.CRC, Fault.LENGTH}:
        return None
    text = checked(text)
    data = placed_bytes(placed, variant, text) if placed is not None else frame_bytes(text)
    return explain_bytes(device, variant, sender, placed, data)


def decoded_data(
    device: Device,
    variant: Variant,
    sender: str,
    decoded: codec.Decoded,
    findings: Findings,
    why: Why | None = None,
    line: Line = _NO_LINE,
    answers: Mapping[str, str] = _NOTHING_TAKEN,
    other_layouts: Sequence[PlacedLayout] = (),
) -> dict[str, Any]:
    """Return the result as plain data, in the shape of ``decode.schema.json``.

    ``line`` is the line of standard input, if any. ``answers`` are the answers used to decode the frame.
    ``other_layouts`` are the other layouts that match the frame.
    """
    return {
        "version": VERSION,
        "line": line.number,
        "time": line.time or None,
        "order_code": variant.code,
        "evidence": device.evidence.grade,
        "alternatives": dict(answers),
        "layout": decoded.layout.name if decoded.layout is not None else None,
        "other_layouts": [other_layout.name for other_layout in other_layouts],
        "direction": sender,
        "fields": list(map(_field_data, decoded.fields)),
        "crc": {"received": decoded.crc.received, "computed": decoded.crc.computed, "ok": decoded.crc.ok}
        if decoded.crc is not None
        else None,
        "problems": [
            {"kind": problem.fault.value, "field": problem.field or None, "message": problem.message}
            for problem in decoded.problems
        ],
        "reports": [_report_data(report) for report in findings.reports],
        "verdict": findings.verdict.value if findings.verdict is not None else None,
        "differences": [
            {
                "field": difference.field,
                "found": difference.actual,
                "documented": difference.documented,
                "message": difference.message,
            }
            for difference in findings.differences
        ],
        "why": _why_data(why) if why is not None else None,
    }


def _field_data(field: codec.DecodedField) -> dict[str, Any]:
    return {
        "name": field.name,
        "raw": field.raw,
        "value": field.value,
        "unit": field.unit or None,
        "quantity": _quantity_data(field.scale, field.value) if field.scale is not None else None,
        "meaning": field.meaning,
    }


def _quantity_data(scale: Scale, number: int | str | bool) -> dict[str, Any]:
    exact = scale.quantity(int(number))
    return {
        "decimal": scale.decimal(int(number)),
        "exact": scale.is_exact(int(number)),
        "numerator": exact.numerator,
        "denominator": exact.denominator,
        "unit": scale.unit,
    }


def _report_data(report: Report) -> dict[str, Any]:
    return {
        "field": report.field,
        "meaning": report.meaning,
        "remedy": report.remedy or None,
        "makes_position": report.makes_position.value if report.makes_position is not None else None,
        "source": report.source,
    }


def _why_data(why: Why) -> dict[str, Any]:
    return {
        "explanations": [
            {
                "kind": explanation.kind,
                "text": explanation.text,
                "one_in": explanation.one_in,
                "twice": explanation.twice,
                "order_codes": list(explanation.codes),
                "reads": dict(explanation.reads),
            }
            for explanation in why.explanations
        ],
        "tried": why.tried,
        "coincidence": round(why.coincidence, 4),
        "cannot_see": list(why.cannot_see),
        "disturbed": list(why.disturbed),
    }


_NOTHING_SAID = Findings()


def explain(
    device: Device,
    match: Match,
    sender: str,
    decoded: codec.Decoded,
    findings: Findings = _NOTHING_SAID,
    why: Why | None = None,
    line: Line = _NO_LINE,
    answers: Mapping[str, str] = _NOTHING_TAKEN,
    label: Sequence[str] | None = None,
    other_frames: str = "",
) -> str:
    """Return the result as text, at most 80 columns wide.

    ``label`` are the ``label_lines`` if they are known. ``other_frames`` names the other frames that it can be.
    """
    start = f"line {line.number}: " if line.number is not None else ""
    start = f"{start.removesuffix(': ')} at {line.time}: ".lstrip() if line.time else start
    lines = [
        start + _heading(device, match.variant, sender, decoded),
        *(label_lines(device, match) if label is None else label),
    ]
    if decoded.layout is not None:
        lines += [_layout_line(decoded.layout), *_taken_lines(device, answers)]
    if decoded.fields:
        lines += ["", *_table(decoded)]
        # An angle in degrees would look too trustworthy for an unusable position.
        measured = (
            _measured(device, match.variant, decoded) if findings.verdict not in (None, Verdict.NOT_USABLE) else ""
        )
        lines += ["", measured] if measured else []
    if decoded.crc is not None:
        lines += ["", _crc_line(device.crc(decoded.crc.name), decoded.crc)]
    lines.append("")
    lines += [
        wrapped(f"{problem.fault.value} error: {problem.message}", WIDTH, "  ", "") for problem in decoded.problems
    ]
    lines += [
        wrapped(f"not as documented: {difference.message}", WIDTH, "  ", "") for difference in findings.differences
    ]
    if not decoded.problems:
        lines += _last_words(decoded, findings)
    lines += [wrapped(other_frames, WIDTH, "  ", "")] if other_frames else []
    lines += _why_lines(why, decoded.layout) if why is not None else []
    lines.append(f"evidence: {device.evidence.grade}")
    if device.evidence.placeholders:
        lines.append(wrapped(placeholders(device), WIDTH, "  ", ""))
    return "\n".join(lines)


def _heading(device: Device, variant: Variant, sender: str, decoded: codec.Decoded) -> str:
    is_frame = decoded.layout is None or decoded.layout.layout.sender != ""
    heading = f"{variant.code}, {device.interface(variant.interface).title}"
    return f"{heading}, from the {sender}" if is_frame else heading


def label_lines(device: Device, match: Match) -> Iterator[str]:
    """Yield the state that registers decide, and how the label differs from the codes in the manual."""
    variant = match.variant
    held_parameters = [parameter for parameter in parameters_of(device, variant.interface) if parameter.read_from]
    if held_parameters:
        state = ", ".join(f"{parameter.name} = {variant.parameters[parameter.name]}" for parameter in held_parameters)
        yield wrapped(f"with {state} (from registers; --register changes them)", WIDTH, "  ")
    yield from label_differences(device, replace(match, tail=""))
    for statement in origin(device):
        yield wrapped(BY_NAME.sentence(statement), WIDTH, "  ")


def label_differences(device: Device, match: Match) -> Iterator[str]:
    """Yield how a label differs from the codes in the manual, in lines of at most 80 columns."""
    if match.written_as_in:
        yield wrapped(f"the label is written as in {match.written_as_in}", WIDTH, "  ")
    if match.unlisted:
        yield wrapped(f"accepted, although not listed in the manual: {', '.join(match.unlisted)}", WIDTH, "  ")
    if match.tail:
        yield f"  the label continues with {match.tail}"
    if match.special:
        special = device.order_code.special or "A code that ends in /Sxxx may differ from the manual."
        yield wrapped(special, WIDTH, "  ")


def _layout_line(placed: PlacedLayout) -> str:
    layout = placed.layout
    title = layout.printed_name or words(placed.name)
    channel = f", data channel {layout.channel}" if layout.channel else ""
    return f"{title}, {_size(placed)}{channel}"


def _taken_lines(device: Device, answers: Mapping[str, str]) -> Iterator[str]:
    """Yield the answers to questions that the manual leaves open, and how to choose others than the defaults."""
    for alternative in device.alternatives:
        for index, answer in enumerate(alternative.answers):
            if answers.get(alternative.name) != answer.name:
                continue
            yield wrapped(f"decoded with {alternative.name} = {answer.name}: {answer.meaning}", WIDTH, "  ", "")
            if alternative.default and index == 0:
                other_choices = " or ".join(
                    f"--choose {alternative.name}={answer.name}" for answer in alternative.answers[1:]
                )
                yield wrapped(f"this is the default; for another reading, add {other_choices}", WIDTH, "    ", "  ")


def _crc_line(crc: Crc, crc_result: codec.CrcResult) -> str:
    verdict = "correct" if crc_result.ok else f"WRONG, expected {crc_result.computed:#04x}"
    inverted = f", start value {crc.init:#x}" if crc.init else ""
    inverted += ", sent inverted" if crc.xorout == crc.mask else ""
    return wrapped(f"CRC {crc_result.received:#04x}: {verdict} ({crc.polynomial}{inverted})", WIDTH, "  ", "")


def _last_words(decoded: codec.Decoded, findings: Findings) -> list[str]:
    """Return the last lines about a valid frame or register: the encoder's reports, or that there is no error."""
    if findings.reports:
        lines = [
            "the encoder reports:",
            *(wrapped(_reported(report), WIDTH, " " * 6, "  - ") for report in findings.reports),
        ]
        return [*lines, f"so {WORTH[findings.verdict]}"] if findings.verdict else lines
    is_frame = decoded.layout is not None and decoded.layout.layout.sender != ""
    words = ["no other error" if findings.differences else "no frame error" if is_frame else "the value is valid"]
    if decoded.layout is not None and is_frame and decoded.crc is None:
        words.append(f"this frame has no CRC{', only parity' if decoded.layout.layout.has_parity else ''}")
    words += [WORTH[findings.verdict]] if findings.verdict is not None else []
    return [wrapped("; ".join(words), WIDTH, "  ", "")]


def _reported(report: Report) -> str:
    name = f"{report.field} ({report.printed_name})" if report.printed_name else report.field
    return (
        f"{name}: {sentence(report.meaning)} {sentence(report.remedy)}"
        if report.remedy
        else f"{name}: {report.meaning}"
    )


def _measured(device: Device, variant: Variant, decoded: codec.Decoded) -> str:
    """Return the position in degrees or micrometres, or only the angle if the frame has no other part of it."""
    measurement = device.measurement_of(variant.interface)
    if measurement is None or decoded.layout is None:
        return ""
    measurement = measurement.within(decoded.layout.layout.position_range)
    name = measurement.of
    if name not in decoded.values:
        joins = [join for layout in device.interface(variant.interface).layouts for join in layout.joins]
        name = next((join.fields[-1] for join in joins if join.name == name), name)
    value = decoded.values.get(name)
    if not isinstance(value, int):
        return ""
    step = measurement.micrometres(variant.parameters)
    if step is not None:
        return f"{name}: {decimal(value * step)} µm"
    terms = (measurement.counts_per_turn, measurement.turns)
    per_turn, turns = (term.value(variant.parameters) if term is not None else 0 for term in terms)
    if per_turn < 1:
        return ""
    turn, counts = divmod(value, per_turn)
    degrees = f"{counts * 360 / per_turn:.{len(str(per_turn // 360))}f}°"
    return f"{name}: {degrees}" + (f" of revolution {turn:,}" if turns > 1 and name == measurement.of else "")


def _why_lines(why: Why, placed: PlacedLayout | None) -> list[str]:
    if [explanation.kind for explanation in why.explanations] == ["line_stuck"]:
        text = sentence(why.explanations[0].text)
        return ["", wrapped(text[0].upper() + text[1:], WIDTH, "  ", "")]
    noise = _disturbed_lines(why.disturbed, placed)
    return [*noise, *_mistake_lines(why)]


def _disturbed_lines(disturbed: Sequence[int], placed: PlacedLayout | None) -> list[str]:
    """Return the usual cause if only some frames fail: one bit was inverted in transmission."""
    if not disturbed or placed is None:
        return []
    first, size = disturbed[0], placed.bits // 8
    place = f"bit {first % 8} of byte {size - 1 - first // 8}" if placed.layout.in_bytes else f"bit {first}"
    bits = place if len(disturbed) == 1 else f"one of {len(disturbed)} bits"
    explanation = (
        f"If only some frames fail, one bit may have been disturbed on the line: the CRC matches with {bits} inverted"
    )
    return [
        "",
        wrapped(f"{explanation}. In that case, no change is needed. If all frames fail, read on.", WIDTH, "  ", ""),
    ]


def _mistake_lines(why: Why) -> list[str]:
    by_chance = f"{100 * why.coincidence:.0f}" if why.coincidence >= 0.005 else "less than 1"
    tried = counted(why.tried, "common mistake")
    noise = f"{tried} tried; {by_chance} of 100 random frames would match at least one"
    if not why.explanations:
        lines = ["", wrapped(f"No common mistake explains it ({noise}).", WIDTH, "  ", "")]
    else:
        introduction = (
            "No single mistake explains it. Two at once would"
            if why.explanations[-1].twice
            else "Possible explanations"
        )
        lines = ["", wrapped(f"{introduction}, most likely first ({noise}):", WIDTH, "  ", "")]
        for explanation in why.explanations:
            lines.append(wrapped(explanation.text, WIDTH, " " * 6, "    - "))
            lines.append(wrapped(_beside(explanation), WIDTH, " " * 6, " " * 6))
    return [*lines, wrapped(f"This CRC cannot detect: {'; '.join(why.cannot_see)}.", WIDTH, "  ", "")]


def _beside(explanation: Explanation) -> str:
    reads = ", ".join(f"{name} {value}" for name, value in explanation.reads.items())
    return f"matches by chance in {_one_in(explanation.one_in)} frames" + (f", and gives {reads}" if reads else "")


def _one_in(number: int) -> str:
    return f"1 of {number:,}" if number < 1_000_000 else "fewer than 1 of a million"


def _size(placed: PlacedLayout) -> str:
    return counted(placed.bits // 8, "byte") if placed.layout.in_bytes else counted(placed.bits, "bit")


def bit_place(layout: Layout, bits: int, high: int, low: int) -> str:
    """Return a field's position as people write it: ``46:31``, or ``byte 2.7:4`` with the first byte as 0."""
    if not layout.in_bytes:
        return f"{high}:{low}" if high != low else f"{high}"
    last = bits // 8 - 1
    low_first = layout.byte_order == "low_byte_first"
    ends = (low, high) if low_first else (high, low)
    first_byte, last_byte = (end // 8 if low_first else last - end // 8 for end in ends)
    if first_byte != last_byte:
        is_whole_bytes = low % 8 == 0 and high % 8 == 7
        return (
            f"bytes {first_byte}-{last_byte}"
            if is_whole_bytes
            else f"bytes {first_byte}.{ends[0] % 8}-{last_byte}.{ends[1] % 8}"
        )
    if high - low == 7:
        return f"byte {first_byte}"
    return f"byte {first_byte}.{high % 8}" + (f":{low % 8}" if high != low else "")


def _table(decoded: codec.Decoded) -> list[str]:
    assert decoded.layout is not None
    rows = []
    for field in decoded.fields:
        if field.name == codec.UNUSED and field.high < 0:
            continue  # each unused field has a line of its own
        place = bit_place(decoded.layout.layout, decoded.layout.bits, field.high, field.low) if field.high >= 0 else ""
        value = {True: "yes", False: "no"}[field.value] if isinstance(field.value, bool) else str(field.value)
        raw = f"{field.raw:#x}" if field.high > field.low or field.high < 0 else str(field.raw)
        value_text = value if isinstance(field.value, bool) else with_unit(value, field.unit)
        value_text += f" ({quantity(field.scale, int(field.value))})" if field.scale is not None else ""
        rows.append((place, field.name, raw, value_text, field.meaning))
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    lines = []
    for row in rows:
        start = "  ".join(text.ljust(width) for text, width in zip(row[:4], widths, strict=True))
        indent = " " * (len(start) + 2)
        if len(indent) > 56:
            lines.append(start.rstrip())
            if row[4]:
                lines.append(wrapped(row[4], WIDTH, " " * 6))
        else:
            lines.append(wrapped(row[4], WIDTH, indent, start + "  ") if row[4] else start.rstrip())
    return lines
