"""Timing diagrams, one for each interface of a family.

The figures in the manuals are not available. The diagrams are drawn from the texts and times in the manuals, and for
BiSS C-mode also from the public protocol description. Widths are not to scale.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from enum import Enum

from ...model import Biss, Device, Interface, Rs485, SendStep, Spi, Ssi, assert_never
from ...model.record import dataclass
from ...plan.codec import Codec, codec_of
from ...plan.values import Active, meaning_of
from ...say.box import DATA, colour
from ...say.evidence import document
from ...say.interface import REPLIES, word_lengths
from ...say.mentions import Subject, mentions
from ...say.name import words
from ...say.timing import bounds_with_codes
from ...say.words import counted, microseconds, timeout_words
from .svg import card, number, rect, text, width

_HIGH, _ROW, _NAME, _MARGIN = 24.0, 58.0, 70.0, 16.0
#: Width of a clock pulse, including its low and high parts.
_PERIOD = 24.0


class Trace(Enum):
    """Behaviour of a line during a part of the diagram."""

    UP = "up"
    DOWN = "down"
    EITHER = "either"
    CLOCK = "clock"
    GAP = "gap"


@dataclass(frozen=True, slots=True)
class Part:
    """Part of a line: a level, clock pulses, or a box of data with its colour class ``fill``."""

    what: Trace
    wide: float
    label: str = ""
    fill: str = ""


@dataclass(frozen=True, slots=True)
class Span:
    """Time span marked below the lines."""

    start: float
    end: float
    label: str


@dataclass(frozen=True, slots=True)
class Wave:
    """Stacked signal lines, with a row of times below them.

    ``told`` is the text alternative, and ``also`` is a further source.
    """

    title: str
    lines: tuple[tuple[str, tuple[Part, ...]], ...]
    spans: tuple[Span, ...]
    told: str
    also: str = ""


def wave(device: Device, interface: Interface) -> Wave | None:
    """Return the timing diagram, or None if the interface has no frame."""
    if not interface.layouts:
        return None
    match interface:
        case Ssi():
            return _ssi(interface)
        case Biss():
            return _biss(device, interface)
        case Rs485():
            return _rs485(device, interface)
        case Spi():
            return _spi(interface)
        case _:
            assert_never(interface)


def _time(interface: Interface, symbol: str) -> str:
    """Return a symbol with its times, each with the order codes to which it applies."""
    timings = [timing for timing in interface.timings if timing.symbol == symbol]
    return ", ".join([symbol, *map(bounds_with_codes, timings)])


def _ssi(interface: Ssi) -> Wave:
    """Return a word with its clocks. After the word, the data line stays low for some time and then goes high."""
    up, down = Trace.UP, Trace.DOWN
    first = "the most significant bit" if interface.alignment.end == "msb_left" else "leading zeros"
    clock = (
        Part(up, 40),
        Part(Trace.CLOCK, 3 * _PERIOD),
        Part(Trace.GAP, 40),
        Part(Trace.CLOCK, 3 * _PERIOD),
        Part(up, 150),
        Part(Trace.CLOCK, 2 * _PERIOD),
    )
    # Data is sent from the first rising edge to the last.
    data = (
        Part(up, 52),
        Part(Trace.EITHER, 64, "first bit", "data"),
        Part(Trace.EITHER, 32, "…", "data"),
        Part(Trace.EITHER, 64, "last bit", "data"),
        Part(down, 60),
        Part(up, 150),
    )
    monoflop, pause = _time(interface, "Tm"), _time(interface, "Tp")
    return Wave(
        "SSI: a word",
        (("Clock", clock), ("Data", data)),
        (Span(212, 272, monoflop), Span(212, 374, pause)),
        "Clock and data are high between words. Each rising edge of the clock shifts out one bit, starting with "
        f"{first}. After the last bit the data line is low ({monoflop}) and then high again. "
        f"Pause between two words: {pause}.",
    )


def _spi(interface: Spi) -> Wave:
    """Return two words, with the request and the reply of each."""
    up, down = Trace.UP, Trace.DOWN
    has_requests = bool(interface.exchanges)
    late = has_requests and interface.reply == "next_word"
    replies = ("reply to the request before", "reply to request 1") if late else ("reply 1", "reply 2")
    select = (Part(up, 40), Part(down, 180), Part(up, 40), Part(down, 180), Part(up, 40))
    clock = (
        Part(down, 56),
        *(Part(Trace.CLOCK, 6 * _PERIOD), Part(down, 76), Part(Trace.CLOCK, 6 * _PERIOD)),
        Part(down, 60),
    )

    def words_of(first: str, second: str) -> tuple[Part, ...]:
        boxes = Part(Trace.EITHER, 172, first, "data"), Part(Trace.EITHER, 172, second, "data")
        return (Part(down, 44), boxes[0], Part(down, 48), boxes[1], Part(down, 44))

    requests = (("MOSI", words_of("request 1", "request 2")),) if has_requests else ()
    return Wave(
        "SPI: two words",
        (("CS", select), ("Clock", clock), *requests, ("MISO", words_of(*replies))),
        (),
        f"Chip select is low during each word of {word_lengths(interface.lengths)}, and high between words. "
        + (
            f"{REPLIES[interface.reply].capitalize()}."
            if has_requests
            else "The encoder ignores the words of the master."
        ),
    )


def _biss(device: Device, interface: Biss) -> Wave:
    """Return a frame: acknowledge, start bit, CDS, the fields of the single cycle data, time-out."""
    fields = list(_fields(codec_of(device, interface.layouts[0]), device.position_names(interface.name)))
    boxes = [Part(Trace.EITHER, max(34.0, width(name, 11) + 10), name, fill) for name, fill in fields]
    data = (
        Part(Trace.UP, 76),  # up to the second rising edge of MA
        Part(Trace.DOWN, 60, "Ack"),
        Part(Trace.UP, 36, "Start"),
        Part(Trace.EITHER, 36, "CDS", "choice"),
        *boxes,
        Part(Trace.DOWN, 90, "stop"),
        Part(Trace.UP, 46),
    )
    total = sum(part.wide for part in data)
    end = total - 136
    clocks = (end - 176) // _PERIOD * _PERIOD
    clock = (
        Part(Trace.UP, 40),
        Part(Trace.CLOCK, 4 * _PERIOD),
        Part(Trace.GAP, end - 136 - clocks),
        Part(Trace.CLOCK, clocks),
        Part(Trace.EITHER, 90, "not CDM", "choice"),
        Part(Trace.UP, 46),
    )
    timeout = timeout_words(interface.timeout) if interface.timeout is not None else _no_timeout(device, interface)
    names = ", ".join(name for name, _ in fields)
    return Wave(
        "BiSS C-mode: a frame",
        (("MA", clock), ("SLO", data)),
        (Span(end, end + 90, f"time-out: {timeout}"),),
        "MA and SLO are high between frames. SLO is low (acknowledge) from the second rising edge of MA until the "
        f"start bit, which is high. The CDS bit, {names} and a low stop bit follow, until the time-out ({timeout}). "
        "During the time-out, MA is the inverse of the CDM bit.",
        "the public protocol description of BiSS C-mode",
    )


def _no_timeout(device: Device, interface: Biss) -> str:
    """Return the words in place of the time-out. A text of the manual may have it."""
    return "see the times" if mentions(device, interface, Subject.TIMEOUT) else f"not in the {document(device)}"


def _fields(codec: Codec, position: Container[str]) -> Iterator[tuple[str, str]]:
    """Yield the name and colour class of each field of the single cycle data, with the position as one field."""
    done = False
    for field in codec.layout.fields:
        if field is codec.layout.crc_field:
            yield "CRC", colour(field)
        elif isinstance(meaning_of(field), Active):
            yield words(field.name), colour(field)
        elif field.name in position:
            if not done:
                yield "position", DATA
            done = True
        elif field.name not in codec.constants:
            yield words(field.name), DATA


def _rs485(device: Device, interface: Rs485) -> Wave:
    """Return a request with its reply, and a repetition of the request."""
    request, reply = _lengths(interface, "master"), _lengths(interface, "encoder")
    request_size = f"{'at least ' if len(request) > 1 else ''}{counted(request[0], 'byte')}"
    label = f"request, {request_size}"
    reply_size = f"{'up to ' if len(reply) > 1 else ''}{counted(reply[-1], 'byte')}"
    master = [Part(Trace.UP, 40), Part(Trace.EITHER, width(label, 11) + 12, label, "choice")]
    asking = sum(part.wide for part in master)
    encoder = [Part(Trace.UP, asking + 40), Part(Trace.EITHER, 170, f"reply, {reply_size}", "data"), Part(Trace.UP, 40)]
    description = f"The master sends a request of {request_size}. The encoder answers with {reply_size}."
    spans: tuple[Span, ...] = ()
    if again := _between_requests(device, interface):
        box, first = 60.0, asking + 270
        between = f"between repeated requests: at least {microseconds(again)}"
        repeated = [Part(Trace.EITHER, box, name, "choice") for name in ("1st", "2nd")]
        master += [Part(Trace.UP, 270), repeated[0], Part(Trace.UP, box), repeated[1], Part(Trace.GAP, 40)]
        encoder.append(Part(Trace.UP, 240))
        spans = (Span(first + box, first + 2 * box, between),)
        description += f" {between.capitalize()}."
    lines = (("Master", tuple(master)), ("Encoder", tuple(encoder)))
    return Wave("RS-485: requests and replies", lines, spans, description)


def _between_requests(device: Device, interface: Interface) -> int:
    """Return the microseconds between the repeated requests of a procedure, or 0 if no procedure repeats a request."""
    steps = (
        step for procedure in device.procedures if procedure.interface == interface.name for step in procedure.steps
    )
    return max((step.microseconds for step in steps if isinstance(step, SendStep)), default=0)


def _lengths(interface: Interface, sender: str) -> list[int]:
    """Return the different lengths in bytes of the frames sent by one side, shortest first."""
    return sorted({layout.widest // 8 for layout in interface.layouts if layout.sender == sender}) or [1]


def drawn(diagram: Wave) -> str:
    """Return the picture of a timing diagram."""
    body: list[str] = []
    right_end = 0.0
    for row, (name, parts) in enumerate(diagram.lines):
        top = _MARGIN + 14 + row * _ROW
        body.append(text(_MARGIN, top + _HIGH - 7, name, 12, "start", bold=True))
        body += _line(parts, _MARGIN + _NAME, top)
        right_end = max(right_end, _MARGIN + _NAME + sum(part.wide for part in parts))
    below = _MARGIN + 14 + len(diagram.lines) * _ROW - 18
    for row, span in enumerate(diagram.spans):
        middle = below + 10 + row * 22
        span_start, end = _MARGIN + _NAME + span.start, _MARGIN + _NAME + span.end
        body.append(
            f'<path d="M{number(span_start)} {number(middle - 6)}v12m0 -6H{number(end)}m0 -6v12" class="line"/>'
        )
        after = end + 8 + width(span.label, 11) <= right_end
        x, anchor = (end + 8, "start") if after else (span_start - 8, "end")
        body.append(text(x, middle + 4, span.label, 11, anchor))
    return card(diagram.title, body, right_end + _MARGIN, below + 10 + 22 * len(diagram.spans) + 4, diagram.told)


def _line(parts: Sequence[Part], part_start: float, top: float) -> Iterator[str]:
    path: list[str] = []
    for part in parts:
        match part.what:
            case Trace.UP | Trace.DOWN:
                y = top if part.what is Trace.UP else top + _HIGH
                path.append(f"{'L' if path else 'M'}{number(part_start)} {number(y)}H{number(part_start + part.wide)}")
                if part.label:
                    yield text(part_start + part.wide / 2, top + _HIGH - 8, part.label, 11, "middle", faint=True)
            case Trace.CLOCK:
                path += _pulses(part_start, top, part, starts=not path)
            case Trace.GAP:
                yield text(part_start + part.wide / 2, top + _HIGH - 7, "· · ·", 12, "middle", faint=True)
                path.append(f"M{number(part_start + part.wide)} {number(top)}")
            case Trace.EITHER:
                yield rect(part_start, top, part.wide, _HIGH, part.fill)
                yield text(part_start + part.wide / 2, top + _HIGH - 8, part.label, 11, "middle")
                path.append(f"M{number(part_start + part.wide)} {number(top)}")
            case _:
                assert_never(part.what)
        part_start += part.wide
    yield f'<path d="{"".join(path)}" class="wave"/>'


def _pulses(pulses_start: float, top: float, part: Part, *, starts: bool) -> Iterator[str]:
    """Yield the path of adjacent pulses. Each pulse is first low and then high."""
    count = round(part.wide / _PERIOD)
    half = part.wide / count / 2
    if starts:
        yield f"M{number(pulses_start)} {number(top)}"
    for index in range(count):
        at = pulses_start + 2 * half * index
        yield f"L{number(at)} {number(top + _HIGH)}H{number(at + half)}V{number(top)}H{number(at + 2 * half)}"
