"""Write a found layout as a line, with the other lines that are equal for these frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..say.plain_text import counted
from .checks import CrcForm, FoundCrc
from .fields import Field, is_all_ones
from .frames import Recording
from .search import FoundLayout

_FLAG_NAMES = {1: "error", 2: "error,warning"}


@dataclass(frozen=True, slots=True)
class EqualLine:
    """A line that describes these frames as well, and why the frames cannot decide."""

    line: str
    reason: str


@dataclass(frozen=True, slots=True)
class Answer:
    """A line, the lines that are equal to it for these frames, and notes about it."""

    line: str
    equal_lines: tuple[EqualLine, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Parts:
    """The parts of a line: its options, and its fields before and after the position."""

    options: Sequence[str]
    front: Sequence[str]
    position: str
    behind: Sequence[str]
    crc: str

    def line(self, interface: str) -> str:
        fields = [*self.front, self.position, *self.behind, self.crc]
        return f"{','.join([interface, *self.options])}:{','.join(field for field in fields if field)}"


def answer(recording: Recording, layout: FoundLayout) -> Answer:
    """Return the answer that a layout is."""
    parts = _parts(recording, layout)
    equal_lines = tuple(_equal_lines(recording, layout, parts))
    return Answer(parts.line(recording.interface), equal_lines, tuple(_notes(recording, layout)))


def _parts(recording: Recording, layout: FoundLayout) -> _Parts:
    split = layout.split
    options = ["gray"] if split.is_gray else []
    if split.byte_order:
        options.append(split.byte_order)
    front = [_field_text(field, "before") for field in split.front]
    behind = [_field_text(field, "after") for field in split.behind]
    if layout.parity is not None:
        parity = "parity=odd" if layout.parity.is_odd else "parity=even"
        front, behind = ([parity, *front], behind) if layout.parity.place == 0 else (front, [*behind, parity])
    crc = _crc_text(recording.interface, layout.crc, layout.crc.forms[0]) if layout.crc is not None else ""
    return _Parts(options, _numbered(front), f"position={split.width}", _numbered(behind), crc)


def _field_text(field: Field, name: str) -> str:
    return f"{name}={field.width}" if field.changes else f"unused={field.width}"


def _numbered(fields: Sequence[str]) -> list[str]:
    """Return fields whose names differ: ``before``, ``before_2`` and so on."""
    numbered_fields: list[str] = []
    counts: dict[str, int] = {}
    for field in fields:
        name, _, width = field.partition("=")
        counts[name] = counts.get(name, 0) + 1
        is_repeated = counts[name] > 1 and name != "unused"
        numbered_fields.append(f"{name}_{counts[name]}={width}" if is_repeated else field)
    return numbered_fields


def _crc_text(interface: str, crc: FoundCrc, form: CrcForm) -> str:
    text = f"crc={crc.width}:{crc.polynomial:#x}"
    if form.start:
        text += f":{form.start:#x}"
    if form.is_inverted == (interface == "biss"):
        return text
    return f"{text}:inverted" if form.is_inverted else f"{text}:plain"


def _equal_lines(recording: Recording, layout: FoundLayout, parts: _Parts) -> Iterator[EqualLine]:
    """Yield the lines that differ from the first one only in what the frames cannot show."""
    interface = recording.interface
    if layout.crc is not None:
        reason = "start value and inversion of a CRC cannot be told apart with frames of one length"
        for form in layout.crc.forms[1:]:
            crc = _crc_text(interface, layout.crc, form)
            yield EqualLine(_changed(parts, crc=crc).line(interface), reason)
    if layout.other_code and layout.parity is None:
        options = [option for option in parts.options if option != "gray"]
        options = options if layout.split.is_gray else ["gray", *options]
        reason = "these positions fit Gray code and binary"
        yield EqualLine(_changed(parts, options=options).line(interface), reason)
    leading = _constant_bits_in_position(recording, layout)
    if leading:
        position = f"position={layout.split.width - leading}"
        front = [*parts.front, f"unused={leading}"]
        reason = f"the first {counted(leading, 'bit')} of the position did not change"
        yield EqualLine(_changed(parts, front=front, position=position).line(interface), reason)
    yield from _wider_position(recording, layout, parts)
    yield from _with_flags(recording, layout, parts)


def _changed(
    parts: _Parts,
    *,
    options: Sequence[str] | None = None,
    front: Sequence[str] | None = None,
    position: str = "",
    behind: Sequence[str] | None = None,
    crc: str = "",
) -> _Parts:
    return _Parts(
        parts.options if options is None else options,
        parts.front if front is None else front,
        position or parts.position,
        parts.behind if behind is None else behind,
        crc or parts.crc,
    )


def _constant_bits_in_position(recording: Recording, layout: FoundLayout) -> int:
    """Return the number of bits at the beginning of the position that did not change. Over RS-485, whole bytes."""
    split = layout.split
    changes = recording.changing[split.start : split.end]
    leading = changes.index(True)
    return leading // 8 * 8 if recording.interface == "rs485" else leading


def _wider_position(recording: Recording, layout: FoundLayout, parts: _Parts) -> Iterator[EqualLine]:
    """Yield the line in which constant bits in front of the position are its highest bits."""
    front = layout.split.front
    if front and not front[-1].changes:
        width = layout.split.width + front[-1].width
        reason = "constant bits in front of the position may be its highest bits"
        yield EqualLine(
            _changed(parts, front=parts.front[:-1], position=f"position={width}").line(recording.interface), reason
        )


def _with_flags(recording: Recording, layout: FoundLayout, parts: _Parts) -> Iterator[EqualLine]:
    """Yield the line with the flags of BiSS in place of one or two ones behind the position."""
    last_field = layout.split.behind[-1] if layout.split.behind else None
    if recording.interface != "biss" or last_field is None or last_field.changes:
        return
    if last_field.width in _FLAG_NAMES and is_all_ones(recording, last_field) and layout.parity is None:
        behind = [*parts.behind[:-1], _FLAG_NAMES[last_field.width]]
        yield EqualLine(
            _changed(parts, behind=behind).line("biss"),
            "BiSS usually sends its inactive flags as 1, but any constant fits",
        )


def _notes(recording: Recording, layout: FoundLayout) -> Iterator[str]:
    split, crc = layout.split, layout.crc
    if crc is None:
        yield "no known CRC fits all frames"
    else:
        kind = "" if crc.is_known else ", which is not in the list of known ones"
        yield f"the CRC 0x{crc.polynomial:x}{kind} fits all {len(recording.frames)} frames ({_chance(crc.evidence)})"
    constants = [field for field in (*split.front, *split.behind) if not field.changes]
    if constants:
        places = " and ".join(_place_text(recording, field) for field in constants)
        yield f"{places}. Constant bits cannot be named: they can be error, warning, zero or unused bits"
    if not split.is_smooth:
        yield "the positions do not move smoothly, so its width and code are only the simplest ones"


def _chance(evidence: int) -> str:
    return f"by coincidence, one of 2^{evidence} recordings"


def _place_text(recording: Recording, field: Field) -> str:
    levels = "".join(str(recording.level(place)) for place in range(field.start, field.end))
    high, low = recording.bits - 1 - field.start, recording.bits - field.end
    return f"bits {high}:{low} were always {levels}" if high > low else f"bit {low} was always {levels}"
