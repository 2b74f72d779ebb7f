"""Pictures of what goes over the lines in time, one for each interface of a family.

The figures of the manuals are lost. What these show are the manuals' words and times; of BiSS C-mode also the public
protocol description. Widths are not to scale.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from ...model import Biss, Constant, CrcValue, Device, Flag, Interface, Layout, Rs485, Ssi, assert_never
from ...say.timing import bounds
from ...say.words import counted, timeout_words
from .svg import card, number, rect, text, width

_HIGH, _ROW, _NAME, _MARGIN = 24.0, 58.0, 70.0, 16.0


class Level(Enum):
    """What a line does for a while."""

    UP = "up"
    DOWN = "down"
    EITHER = "either"
    CLOCK = "clock"
    GAP = "gap"


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a line: a level or so many clock pulses, or a box of data with the ``fill`` of its kind."""

    what: Level
    wide: float
    label: str = ""
    fill: str = ""


@dataclass(frozen=True, slots=True)
class Span:
    """A time between two places below the lines."""

    start: float
    end: float
    label: str


@dataclass(frozen=True, slots=True)
class Wave:
    """Lines one under the other, and times below them; ``told`` is the same in words."""

    title: str
    lines: tuple[tuple[str, tuple[Part, ...]], ...]
    spans: tuple[Span, ...]
    told: str


def wave(device: Device, interface: Interface) -> Wave | None:
    """What goes over the lines; None where the spec has no frame of the interface."""
    if not interface.layouts:
        return None
    match interface:
        case Ssi():
            return _ssi(interface)
        case Biss():
            return _biss(device, interface)
        case Rs485():
            return _rs485(interface)
        case _:
            assert_never(interface)


def _time(interface: Interface, symbol: str) -> str:
    found = next((item for item in interface.timings if item.symbol == symbol), None)
    return f"{symbol}, {bounds(found)}" if found is not None else symbol


def _ssi(interface: Ssi) -> Wave:
    """The word with the clocks that shift it out; the data line stays low after it and then goes high."""
    up, down = Level.UP, Level.DOWN
    first = "most significant bit" if interface.alignment.end == "msb_left" else "zeros, then the position"
    clock = (
        Part(up, 40),
        Part(Level.CLOCK, 72, "3"),
        Part(Level.GAP, 40),
        Part(Level.CLOCK, 72, "3"),
        Part(up, 150),
        Part(Level.CLOCK, 48, "2"),
    )
    # From the first rising edge on, up to the last.
    data = (
        Part(up, 52),
        Part(Level.EITHER, 64, "first bit", "data"),
        Part(Level.EITHER, 32, "…", "data"),
        Part(Level.EITHER, 64, "last bit", "data"),
        Part(down, 60),
        Part(up, 150),
    )
    monoflop, pause = _time(interface, "Tm"), _time(interface, "Tp")
    return Wave(
        "SSI: a word",
        (("Clock", clock), ("Data", data)),
        (Span(212, 272, monoflop), Span(212, 374, pause)),
        "Clock and data are high between words. From the first rising edge of the clock on, each shifts out a bit, "
        f"{first} first. After the last one the data line is low ({monoflop}) and then high again. "
        f"Between two words: {pause}.",
    )


def _biss(device: Device, interface: Biss) -> Wave:
    """A frame: acknowledge, start, CDS, the fields of the single cycle data, time-out."""
    layout = interface.layouts[0]
    fields = list(_fields(layout))
    boxes = [Part(Level.EITHER, max(34.0, width(name, 11) + 10), name, fill) for name, fill in fields]
    data = (
        Part(Level.UP, 76),  # up to the second rising edge of MA
        Part(Level.DOWN, 60, "Ack"),
        Part(Level.UP, 36, "Start"),
        Part(Level.EITHER, 36, "CDS", "choice"),
        *boxes,
        Part(Level.DOWN, 90, "stop"),
        Part(Level.UP, 46),
    )
    total = sum(part.wide for part in data)
    end = total - 136
    clock = (
        Part(Level.UP, 40),
        Part(Level.CLOCK, 96, "4"),
        Part(Level.GAP, 40),
        Part(Level.CLOCK, end - 176, f"{round((end - 176) / 24)}"),
        Part(Level.EITHER, 90, "not CDM", "choice"),
        Part(Level.UP, 46),
    )
    timeout = timeout_words(interface.timeout) if interface.timeout is not None else "not said by the manual"
    names = ", ".join(name for name, _ in fields)
    return Wave(
        "BiSS C-mode: a frame",
        (("MA", clock), ("SLO", data)),
        (Span(end, end + 90, f"time-out: {timeout}"),),
        "MA and SLO are high between frames. From the second rising edge of MA on SLO is low (acknowledge), until the "
        f"start bit, which is high; then the CDS bit, {names}, and a stop bit, low, until the time-out ({timeout}). "
        "During the time-out MA has the inverse of the CDM bit.",
    )


def _fields(layout: Layout) -> Iterator[tuple[str, str]]:
    """Name and kind of what stands in the single cycle data, the parts of the position as one."""
    position = [name for item in layout.joins for name in item.fields]
    done = False
    for field in layout.fields:
        match field.kind:
            case Constant():
                continue
            case Flag():
                yield field.name.replace("_", " "), "flag"
            case CrcValue():
                yield "CRC", "check"
            case _:
                if field.name not in position:
                    yield field.name.replace("_", " "), "data"
                elif not done:
                    done = True
                    yield "position", "data"


def _rs485(interface: Rs485) -> Wave:
    """A request and its reply, and a request that is repeated."""
    request, reply = _shortest(interface.layouts, "master"), _longest(interface.layouts, "encoder")
    master = (
        Part(Level.UP, 40),
        Part(Level.EITHER, 90, f"request, {counted(request, 'byte')}", "choice"),
        Part(Level.UP, 270),
        Part(Level.EITHER, 60, "1st", "choice"),
        Part(Level.UP, 60),
        Part(Level.EITHER, 60, "2nd", "choice"),
        Part(Level.GAP, 40),
    )
    encoder = (
        Part(Level.UP, 170),
        Part(Level.EITHER, 170, f"reply, up to {counted(reply, 'byte')}", "data"),
        Part(Level.UP, 280),
    )
    between = next((item for item in interface.timings if item.name == "reset_interval"), None)
    spans = (Span(460, 520, f"between the requests of a reset: {bounds(between)}"),) if between is not None else ()
    repeated = f" Requests of a reset are repeated, {bounds(between)} apart." if between is not None else ""
    return Wave(
        "RS-485: requests and replies",
        (("Master", master), ("Encoder", encoder)),
        spans,
        f"The master sends a request of {counted(request, 'byte')}; the encoder answers with up to "
        f"{counted(reply, 'byte')}.{repeated}",
    )


def _shortest(layouts: Sequence[Layout], sender: str) -> int:
    return min((item.widest // 8 for item in layouts if item.sender == sender), default=1)


def _longest(layouts: Sequence[Layout], sender: str) -> int:
    return max((item.widest // 8 for item in layouts if item.sender == sender), default=1)


def drawn(item: Wave) -> str:
    """The picture."""
    body: list[str] = []
    right = 0.0
    for row, (name, parts) in enumerate(item.lines):
        top = _MARGIN + 14 + row * _ROW
        body.append(text(_MARGIN, top + _HIGH - 7, name, 12, "start", bold=True))
        body += _line(parts, _MARGIN + _NAME, top)
        right = max(right, _MARGIN + _NAME + sum(part.wide for part in parts))
    below = _MARGIN + 14 + len(item.lines) * _ROW - 18
    for row, span in enumerate(item.spans):
        middle = below + 10 + row * 22
        left, end = _MARGIN + _NAME + span.start, _MARGIN + _NAME + span.end
        body.append(f'<path d="M{number(left)} {number(middle - 6)}v12m0 -6H{number(end)}m0 -6v12" class="line"/>')
        after = end + 8 + width(span.label, 11) <= right
        x, anchor = (end + 8, "start") if after else (left - 8, "end")
        body.append(text(x, middle + 4, span.label, 11, anchor))
    return card(item.title, body, right + _MARGIN, below + 10 + 22 * len(item.spans) + 4, item.told)


def _line(parts: Sequence[Part], left: float, top: float) -> Iterator[str]:
    path: list[str] = []
    for part in parts:
        match part.what:
            case Level.UP | Level.DOWN:
                y = top if part.what is Level.UP else top + _HIGH
                path.append(f"{'L' if path else 'M'}{number(left)} {number(y)}H{number(left + part.wide)}")
                if part.label:
                    yield text(left + part.wide / 2, top + _HIGH - 8, part.label, 11, "middle", faint=True)
            case Level.CLOCK:
                path += _pulses(left, top, part, starts=not path)
            case Level.GAP:
                yield text(left + part.wide / 2, top + _HIGH - 7, "· · ·", 12, "middle", faint=True)
                path.append(f"M{number(left + part.wide)} {number(top)}")
            case Level.EITHER:
                yield rect(left, top, part.wide, _HIGH, part.fill)
                yield text(left + part.wide / 2, top + _HIGH - 8, part.label, 11, "middle")
                path.append(f"M{number(left + part.wide)} {number(top)}")
            case _:
                assert_never(part.what)
        left += part.wide
    yield f'<path d="{"".join(path)}" class="wave"/>'


def _pulses(left: float, top: float, part: Part, *, starts: bool) -> Iterator[str]:
    """So many pulses, each low first and then high."""
    count = int(part.label)
    half = part.wide / count / 2
    if starts:
        yield f"M{number(left)} {number(top)}"
    for index in range(count):
        at = left + 2 * half * index
        yield f"L{number(at)} {number(top + _HIGH)}H{number(at + half)}V{number(top)}H{number(at + 2 * half)}"
