"""Timing diagrams, one for each interface of a family.

The diagrams are based on the texts and times in the manuals, because the figures of the manuals are not available, and
for BiSS C-mode also on the public protocol description. Widths are not to scale.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from enum import Enum

from ...model import Biss, Device, Interface, Rs485, SendStep, Spi, Ssi, assert_never
from ...model.record import dataclass
from ...plan.codec import LayoutPlan, layout_plan_of
from ...plan.values import ActiveFlag, meaning_of
from ...say.layout import DATA, box_colour
from ...say.names_and_evidence import Topic, name_in_words, place_of_mention, word_for_document
from ...say.order_code import REPLIES, bounds_with_codes, timeouts_with_codes, word_lengths
from ...say.text import count_with_unit, time_text
from ..picture_elements import create_picture, draw_box, draw_text, number
from ..picture_elements import text_width as text_width

_SIGNAL_HEIGHT, _ROW_HEIGHT, _NAME_WIDTH, _MARGIN = 24.0, 58.0, 70.0, 16.0
#: Width of a clock pulse in pixels, including its low and its high part.
_PULSE_WIDTH = 24.0


class LineShape(Enum):
    """Shape of a signal line during a part of the diagram."""

    HIGH = "high"
    LOW = "low"
    DATA_BOX = "data box"
    CLOCK = "clock"
    GAP = "gap"


@dataclass(frozen=True, slots=True)
class SignalPart:
    """Part of a signal line: a level, clock pulses, a gap, or a box of data with its color class ``fill``."""

    shape: LineShape
    width: float
    label: str = ""
    fill: str = ""


@dataclass(frozen=True, slots=True)
class Span:
    """Time span that is marked below the signal lines, from ``start`` to ``end`` in pixels."""

    start: float
    end: float
    label: str


@dataclass(frozen=True, slots=True)
class TimingDiagram:
    """Signal lines, one below the other, with time spans below them.

    ``text`` is the text alternative. ``further_source`` is the source that the diagram needs in addition to the manual.
    """

    title: str
    lines: tuple[tuple[str, tuple[SignalPart, ...]], ...]
    spans: tuple[Span, ...]
    text: str
    further_source: str = ""


def timing_diagram(device: Device, interface: Interface) -> TimingDiagram | None:
    """Return the timing diagram of an interface, or None if the interface has no frame."""
    if not interface.layouts:
        return None
    match interface:
        case Ssi():
            return _ssi_diagram(interface)
        case Biss():
            return _biss_diagram(device, interface)
        case Rs485():
            return _rs485_diagram(device, interface)
        case Spi():
            return _spi_diagram(interface)
        case _:
            assert_never(interface)


def _symbol_with_times(interface: Interface, symbol: str) -> str:
    """Return a symbol, such as ``Tp``, with the times that have it: ``Tp, at least 12 µs (only with X-24)``."""
    timings = [timing for timing in interface.timings if timing.symbol == symbol]
    return ", ".join([symbol, *map(bounds_with_codes, timings)])


def _ssi_diagram(interface: Ssi) -> TimingDiagram:
    """Return the diagram of an SSI word with its clocks. After the word, the data line stays low and then goes high."""
    high, low = LineShape.HIGH, LineShape.LOW
    first_bits = "the most significant bit" if interface.alignment.end == "msb_left" else "leading zeros"
    clock_line = (
        SignalPart(high, width=40),
        SignalPart(LineShape.CLOCK, width=3 * _PULSE_WIDTH),
        SignalPart(LineShape.GAP, width=40),
        SignalPart(LineShape.CLOCK, width=3 * _PULSE_WIDTH),
        SignalPart(high, width=150),
        SignalPart(LineShape.CLOCK, width=2 * _PULSE_WIDTH),
    )
    # Data is sent from the first rising edge of the clock to the last one.
    data_line = (
        SignalPart(high, width=52),
        SignalPart(LineShape.DATA_BOX, width=64, label="first bit", fill="data"),
        SignalPart(LineShape.DATA_BOX, width=32, label="…", fill="data"),
        SignalPart(LineShape.DATA_BOX, width=64, label="last bit", fill="data"),
        SignalPart(low, width=60),
        SignalPart(high, width=150),
    )
    # The word ends at 212 pixels, data is low until 272, and the next word begins at 374.
    monoflop = _symbol_with_times(interface, "Tm")
    pause = _symbol_with_times(interface, "Tp")
    return TimingDiagram(
        title="SSI: a word",
        lines=(("Clock", clock_line), ("Data", data_line)),
        spans=(Span(start=212, end=272, label=monoflop), Span(start=212, end=374, label=pause)),
        text="Clock and data are high between words. Each rising edge of the clock shifts out one bit, starting with "
        f"{first_bits}. After the last bit the data line is low ({monoflop}) and then high again. "
        f"Pause between two words: {pause}.",
    )


def _spi_diagram(interface: Spi) -> TimingDiagram:
    """Return the diagram of two SPI words, with the request and the reply in each."""
    high, low = LineShape.HIGH, LineShape.LOW
    has_requests = bool(interface.exchanges)
    # Each word contains the reply to its own request, or to the request in the word before.
    replies = ("reply 1", "reply 2")
    if has_requests and interface.reply == "next_word":
        replies = ("reply to the request before", "reply to request 1")
    select_line = (
        SignalPart(high, width=40),
        SignalPart(low, width=180),
        SignalPart(high, width=40),
        SignalPart(low, width=180),
        SignalPart(high, width=40),
    )
    clock_line = (
        SignalPart(low, width=56),
        SignalPart(LineShape.CLOCK, width=6 * _PULSE_WIDTH),
        SignalPart(low, width=76),
        SignalPart(LineShape.CLOCK, width=6 * _PULSE_WIDTH),
        SignalPart(low, width=60),
    )

    lines: list[tuple[str, tuple[SignalPart, ...]]] = [("CS", select_line), ("Clock", clock_line)]
    sentence_on_requests = "The encoder ignores the words that the master sends."
    if has_requests:
        lines.append(("MOSI", _spi_words("request 1", "request 2")))
        sentence_on_requests = f"{REPLIES[interface.reply].capitalize()}."
    lines.append(("MISO", _spi_words(*replies)))
    lengths = word_lengths(interface.lengths)
    return TimingDiagram(
        title="SPI: two words",
        lines=tuple(lines),
        spans=(),
        text=f"Chip select is low during each word of {lengths}, and high between words. {sentence_on_requests}",
    )


def _spi_words(first_label: str, second_label: str) -> tuple[SignalPart, ...]:
    """Return a data line with two words that have these labels."""
    return (
        SignalPart(LineShape.LOW, width=44),
        SignalPart(LineShape.DATA_BOX, width=172, label=first_label, fill="data"),
        SignalPart(LineShape.LOW, width=48),
        SignalPart(LineShape.DATA_BOX, width=172, label=second_label, fill="data"),
        SignalPart(LineShape.LOW, width=44),
    )


def _biss_diagram(device: Device, interface: Biss) -> TimingDiagram:
    """Return the diagram of a BiSS frame: acknowledge, start bit, CDS, fields of the single cycle data, timeout."""
    # The first layout is the single cycle data.
    cycle_data = layout_plan_of(device, interface.layouts[0])
    position_names = device.position_names(interface.name)
    names_and_fills = list(_data_boxes(cycle_data, position_names))
    data_line = _biss_data_line(names_and_fills)
    # The last two parts of the line, the timeout and the idle level, are together 136 pixels wide.
    timeout_start = sum(part.width for part in data_line) - 136
    clock_line = _biss_clock_line(timeout_start)
    timeout = timeouts_with_codes(interface.timeouts) or _words_for_unknown_timeout(device, interface)
    labels = ", ".join(name for name, _ in names_and_fills)
    return TimingDiagram(
        title="BiSS C-mode: a frame",
        lines=(("MA", clock_line), ("SLO", data_line)),
        spans=(Span(start=timeout_start, end=timeout_start + 90, label=f"timeout: {timeout}"),),
        text="MA and SLO are high between frames. SLO is low (acknowledge) from the second rising edge of MA until the "
        f"start bit, which is high. The CDS bit, {labels} and a low stop bit follow, until the timeout ({timeout}). "
        "During the timeout, MA is the inverse of the CDM bit.",
        further_source="the public protocol description of BiSS C-mode",
    )


def _biss_data_line(names_and_fills: Sequence[tuple[str, str]]) -> tuple[SignalPart, ...]:
    """Return the line SLO of a BiSS frame. Its fields are given with their names and color classes."""
    data_boxes = []
    for name, fill in names_and_fills:
        box_width = max(34.0, text_width(name, 11) + 10)
        data_boxes.append(SignalPart(LineShape.DATA_BOX, width=box_width, label=name, fill=fill))
    return (
        SignalPart(LineShape.HIGH, width=76),  # up to the second rising edge of MA
        SignalPart(LineShape.LOW, width=60, label="Ack"),
        SignalPart(LineShape.HIGH, width=36, label="Start"),
        SignalPart(LineShape.DATA_BOX, width=36, label="CDS", fill="choice"),
        *data_boxes,
        SignalPart(LineShape.LOW, width=90, label="stop"),
        SignalPart(LineShape.HIGH, width=46),
    )


def _biss_clock_line(timeout_start: float) -> tuple[SignalPart, ...]:
    """Return the line MA of a BiSS frame. Its clocks end at the start of the timeout."""
    # The width of a whole number of pulses, after 136 pixels with the first pulses and a gap of at least 40 pixels.
    clocks_width = (timeout_start - 176) // _PULSE_WIDTH * _PULSE_WIDTH
    return (
        SignalPart(LineShape.HIGH, width=40),
        SignalPart(LineShape.CLOCK, width=4 * _PULSE_WIDTH),
        SignalPart(LineShape.GAP, width=timeout_start - 136 - clocks_width),
        SignalPart(LineShape.CLOCK, width=clocks_width),
        SignalPart(LineShape.DATA_BOX, width=90, label="not CDM", fill="choice"),
        SignalPart(LineShape.HIGH, width=46),
    )


def _words_for_unknown_timeout(device: Device, interface: Biss) -> str:
    """Return the words in place of an unknown timeout: where the manual may mention it, or that it does not."""
    place = place_of_mention(device, interface, Topic.TIMEOUT)
    return f"see the {place}" if place else f"not in the {word_for_document(device)}"


def _data_boxes(layout_plan: LayoutPlan, position_names: Container[str]) -> Iterator[tuple[str, str]]:
    """Yield the name and color class of each field in the single cycle data, with the position as one field.

    Constants are omitted.
    """
    has_position = False
    for field in layout_plan.layout.fields:
        if field in layout_plan.layout.crc_fields:
            yield "CRC", box_colour(field)
        elif isinstance(meaning_of(field), ActiveFlag):
            yield name_in_words(field.name), box_colour(field)
        elif field.name in position_names:
            if not has_position:
                yield "position", DATA
            has_position = True
        elif field.name not in layout_plan.constants:
            yield name_in_words(field.name), DATA


def _sizes_of_frames(interface: Rs485) -> tuple[str, str]:
    """Return the sizes of a request and of a reply, such as ``("at least 1 byte", "up to 11 bytes")``."""
    request_lengths = _byte_counts(interface, "master")
    reply_lengths = _byte_counts(interface, "encoder")
    request_size = count_with_unit(request_lengths[0], "byte")
    if len(request_lengths) > 1:
        request_size = f"at least {request_size}"
    reply_size = count_with_unit(reply_lengths[-1], "byte")
    if len(reply_lengths) > 1:
        reply_size = f"up to {reply_size}"
    return request_size, reply_size


def _rs485_diagram(device: Device, interface: Rs485) -> TimingDiagram:
    """Return the diagram of a request with its reply. If a procedure repeats requests, two repetitions follow."""
    request_size, reply_size = _sizes_of_frames(interface)
    request_label = f"request, {request_size}"
    master_parts = [
        SignalPart(LineShape.HIGH, width=40),
        SignalPart(LineShape.DATA_BOX, width=text_width(request_label, 11) + 12, label=request_label, fill="choice"),
    ]
    request_end = sum(part.width for part in master_parts)
    reply_part = SignalPart(LineShape.DATA_BOX, width=170, label=f"reply, {reply_size}", fill="data")
    encoder_parts = [
        SignalPart(LineShape.HIGH, width=request_end + 40),
        reply_part,
        SignalPart(LineShape.HIGH, width=40),
    ]
    description = f"The master sends a request of {request_size}. The encoder answers with {reply_size}."
    spans: tuple[Span, ...] = ()
    pause_us = _pause_between_requests(device, interface)
    if pause_us:
        repetition_width = 60.0
        first_repetition_end = request_end + 270 + repetition_width
        pause_label = f"between repeated requests: at least {time_text(pause_us)}"
        # Both lines end 490 pixels after the request.
        master_parts += [
            SignalPart(LineShape.HIGH, width=270),
            SignalPart(LineShape.DATA_BOX, width=repetition_width, label="1st", fill="choice"),
            SignalPart(LineShape.HIGH, width=repetition_width),
            SignalPart(LineShape.DATA_BOX, width=repetition_width, label="2nd", fill="choice"),
            SignalPart(LineShape.GAP, width=40),
        ]
        encoder_parts.append(SignalPart(LineShape.HIGH, width=240))
        spans = (Span(start=first_repetition_end, end=first_repetition_end + repetition_width, label=pause_label),)
        description += f" Repeated requests are at least {time_text(pause_us)} apart."
    return TimingDiagram(
        title="RS-485: requests and replies",
        lines=(("Master", tuple(master_parts)), ("Encoder", tuple(encoder_parts))),
        spans=spans,
        text=description,
    )


def _pause_between_requests(device: Device, interface: Interface) -> int:
    """Return the longest time in µs between the repeated requests of a procedure, or 0 if no procedure repeats any."""
    procedures = [procedure for procedure in device.procedures if procedure.interface == interface.name]
    steps = [step for procedure in procedures for step in procedure.steps]
    return max((step.microseconds for step in steps if isinstance(step, SendStep)), default=0)


def _byte_counts(interface: Interface, sender: str) -> list[int]:
    """Return the different lengths in bytes of the frames that one side sends, the shortest first.

    If the side sends no frames, the only length is one byte.
    """
    lengths = {layout.widest // 8 for layout in interface.layouts if layout.sender == sender}
    return sorted(lengths) or [1]


def diagram_picture(diagram: TimingDiagram) -> str:
    """Return the picture of a timing diagram."""
    elements: list[str] = []
    lines_left = _MARGIN + _NAME_WIDTH
    lines_right = 0.0
    line_top = _MARGIN + 14
    for line_name, signal_parts in diagram.lines:
        name_baseline = line_top + _SIGNAL_HEIGHT - 7
        elements.append(draw_text(line_name, x=_MARGIN, y=name_baseline, size=12, anchor="start", bold=True))
        elements += _line_elements(signal_parts, left=lines_left, top=line_top)
        line_width = sum(part.width for part in signal_parts)
        lines_right = max(lines_right, lines_left + line_width)
        line_top += _ROW_HEIGHT
    # The first span is closer to the last signal line than another line would be.
    span_middle = line_top - 8
    for span in diagram.spans:
        elements += _span_elements(span, lines_left=lines_left, lines_right=lines_right, middle=span_middle)
        span_middle += 22
    height = span_middle + 4
    return create_picture(diagram.title, elements, width=lines_right + _MARGIN, height=height, description=diagram.text)


def _span_elements(span: Span, *, lines_left: float, lines_right: float, middle: float) -> Iterator[str]:
    """Yield the bar of a time span and its label, which is in front of the bar if there is no space after it.

    ``lines_left`` and ``lines_right`` are the ends of the signal lines, and ``middle`` is the vertical center.
    """
    start, end = lines_left + span.start, lines_left + span.end
    # A line from start to end, with a vertical stroke of 12 pixels at both.
    yield f'<path d="M{number(start)} {number(middle - 6)}v12m0 -6H{number(end)}m0 -6v12" class="line"/>'
    label_right = end + 8 + text_width(span.label, 11)
    if label_right <= lines_right:
        yield draw_text(span.label, x=end + 8, y=middle + 4, size=11, anchor="start")
    else:
        yield draw_text(span.label, x=start - 8, y=middle + 4, size=11, anchor="end")


def _line_elements(signal_parts: Sequence[SignalPart], *, left: float, top: float) -> Iterator[str]:
    """Yield the boxes and labels of a signal line, then its path, which boxes and gaps interrupt."""
    # Commands of an SVG path: M moves to a point without drawing, and L, H and V draw lines.
    path: list[str] = []
    part_left = left
    label_baseline = top + _SIGNAL_HEIGHT - 8
    for part in signal_parts:
        part_right = part_left + part.width
        center = part_left + part.width / 2
        match part.shape:
            case LineShape.HIGH | LineShape.LOW:
                level_y = top if part.shape is LineShape.HIGH else top + _SIGNAL_HEIGHT
                command = "L" if path else "M"
                path.append(f"{command}{number(part_left)} {number(level_y)}H{number(part_right)}")
                if part.label:
                    yield draw_text(part.label, x=center, y=label_baseline, size=11, anchor="middle", faint=True)
            case LineShape.CLOCK:
                if not path:
                    path.append(f"M{number(part_left)} {number(top)}")
                path += _pulse_path(part.width, left=part_left, top=top)
            case LineShape.GAP:
                yield draw_text("· · ·", x=center, y=label_baseline + 1, size=12, anchor="middle", faint=True)
                path.append(f"M{number(part_right)} {number(top)}")
            case LineShape.DATA_BOX:
                yield draw_box(left=part_left, top=top, box_width=part.width, box_height=_SIGNAL_HEIGHT, fill=part.fill)
                yield draw_text(part.label, x=center, y=label_baseline, size=11, anchor="middle")
                path.append(f"M{number(part_right)} {number(top)}")
            case _:
                assert_never(part.shape)
        part_left = part_right
    yield f'<path d="{"".join(path)}" class="wave"/>'


def _pulse_path(pulses_width: float, *, left: float, top: float) -> Iterator[str]:
    """Yield the path commands of consecutive pulses of this total width, each of which is first low and then high."""
    pulse_count = round(pulses_width / _PULSE_WIDTH)
    half_period = pulses_width / pulse_count / 2
    bottom = top + _SIGNAL_HEIGHT
    for index in range(pulse_count):
        falling_edge = left + 2 * half_period * index
        rising_edge = falling_edge + half_period
        pulse_end = left + 2 * half_period * (index + 1)
        low_half = f"L{number(falling_edge)} {number(bottom)}H{number(rising_edge)}"
        high_half = f"V{number(top)}H{number(pulse_end)}"
        yield low_half + high_half
