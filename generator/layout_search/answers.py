"""Write a layout as a line, together with other lines that describe these frames equally well."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ..say import count_with_unit
from .checks import FoundCrc, StartAndInversion
from .fields import MOST_BITS, FoundField, is_all_ones
from .frames import RecordedFrames
from .search import FoundLayout

_FLAG_NAMES = {1: "error", 2: "error,warning"}


@dataclass(frozen=True, slots=True)
class EqualLine:
    """A line that describes these frames equally well, and the reason why the frames do not distinguish them."""

    line: str
    reason: str


@dataclass(frozen=True, slots=True)
class PossibleLine:
    """A line, the lines that these frames cannot distinguish from it, and notes about it."""

    line: str
    equal_lines: tuple[EqualLine, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _LineParts:
    """The parts of a line: its options, and its fields before and after the position."""

    options: Sequence[str]
    fields_before: Sequence[str]
    position: str
    fields_after: Sequence[str]
    crc: str

    def format_line(self, interface: str) -> str:
        """Return the line, such as ``ssi,gray:position=13,parity=even``."""
        head = ",".join([interface, *self.options])
        fields = [*self.fields_before, self.position, *self.fields_after, self.crc]
        return f"{head}:{','.join(field for field in fields if field)}"


def answer_with_lines(recording: RecordedFrames, layout: FoundLayout) -> PossibleLine:
    """Return a layout as a line, with other lines that describe the frames equally well, and with notes on evidence."""
    parts = _parts_of_line(recording, layout)
    return PossibleLine(
        line=parts.format_line(recording.interface),
        equal_lines=tuple(_equal_lines(recording, layout, parts)),
        notes=tuple(_describe_certainty(recording, layout)),
    )


def _parts_of_line(recording: RecordedFrames, layout: FoundLayout) -> _LineParts:
    """Return the parts of the line that describes a layout, with the most usual form of its CRC.

    Fields are texts such as ``before=3``, ``unused=2`` or ``parity=even``, in the order in which they are sent.
    """
    split = layout.frame_split
    options = ["gray"] if split.is_gray else []
    if split.byte_order:
        options.append(split.byte_order)
    fields_before = [text for field in split.fields_before for text in _field_texts(field, "before")]
    fields_after = [text for field in split.fields_after for text in _field_texts(field, "after")]
    if layout.parity is not None:
        parity_field = "parity=odd" if layout.parity.is_odd else "parity=even"
        is_first_bit = layout.parity.bit_index == 0
        if is_first_bit:
            fields_before.insert(0, parity_field)
        else:
            fields_after.append(parity_field)
    return _LineParts(
        options=options,
        fields_before=_with_distinct_names(fields_before),
        position=f"position={split.width}",
        fields_after=_with_distinct_names(fields_after),
        crc=_usual_crc_text(recording.interface, layout.crc),
    )


def _usual_crc_text(interface: str, crc: FoundCrc | None) -> str:
    """Return a CRC as it is written in a line, in its most usual form, or an empty string without a CRC."""
    if crc is None:
        return ""
    if crc.is_modbus:
        return f"crc={crc.width}:{crc.polynomial:#x}:0xffff:reflected:low_byte_first"
    most_usual_parameters = crc.parameter_choices[0]
    return _crc_text(interface, crc, most_usual_parameters)


def _field_texts(field: FoundField, name: str) -> Iterator[str]:
    """Yield a field as it is written in a line, such as ``before=3``. Bits that never change are ``unused``.

    A field of more than 64 bits, which a line cannot have, is split into several.
    """
    for bits_before in range(0, field.width, MOST_BITS):
        width = min(field.width - bits_before, MOST_BITS)
        yield f"{name}={width}" if field.changes else f"unused={width}"


def _with_distinct_names(fields: Sequence[str]) -> list[str]:
    """Return fields such as ``before=3`` with distinct names: ``before``, ``before_2`` and so on.

    Several fields may have the name ``unused``.
    """
    distinct_fields: list[str] = []
    fields_by_name: dict[str, int] = {}
    for field in fields:
        name, _, width = field.partition("=")
        occurrence = fields_by_name.get(name, 0) + 1
        fields_by_name[name] = occurrence
        keeps_name = occurrence == 1 or name == "unused"
        distinct_fields.append(field if keeps_name else f"{name}_{occurrence}={width}")
    return distinct_fields


def _crc_text(interface: str, crc: FoundCrc, parameters: StartAndInversion) -> str:
    """Return a CRC as it is written in a line, such as ``crc=6:0x43``.

    A start value of 0 is omitted, as is ``inverted`` over BiSS and ``plain`` over other interfaces.
    """
    text = f"crc={crc.width}:{crc.polynomial:#x}"
    if parameters.start:
        text += f":{parameters.start:#x}"
    is_inverted_by_default = interface == "biss"
    if parameters.is_inverted == is_inverted_by_default:
        return text
    return f"{text}:inverted" if parameters.is_inverted else f"{text}:plain"


def _equal_lines(recording: RecordedFrames, layout: FoundLayout, line_parts: _LineParts) -> Iterator[EqualLine]:
    """Yield other lines that describe the frames equally well, each with the reason why the frames do not decide.

    ``line_parts`` are the parts of the line for the layout itself.
    """
    interface = recording.interface
    if layout.crc is not None:
        reason = "the start value and inversion of a CRC cannot be determined from frames of one length"
        less_usual_parameters = layout.crc.parameter_choices[1:]
        for parameters in less_usual_parameters:
            crc_field = _crc_text(interface, layout.crc, parameters)
            yield EqualLine(replace(line_parts, crc=crc_field).format_line(interface), reason)
    if layout.may_be_other_code and layout.parity is None:
        options = [option for option in line_parts.options if option != "gray"]
        if not layout.frame_split.is_gray:
            options.insert(0, "gray")
        reason = "these positions fit Gray code and binary"
        yield EqualLine(replace(line_parts, options=options).format_line(interface), reason)
    constant_bits = _constant_bits_in_position(recording, layout)
    if constant_bits:
        position = f"position={layout.frame_split.width - constant_bits}"
        fields_before = [*line_parts.fields_before, f"unused={constant_bits}"]
        reason = f"the first {count_with_unit(constant_bits, 'bit')} of the position did not change"
        yield EqualLine(
            replace(line_parts, fields_before=fields_before, position=position).format_line(interface), reason
        )
    yield from _line_with_wider_position(recording, layout, line_parts)
    yield from _line_with_flags(recording, layout, line_parts)


def _constant_bits_in_position(recording: RecordedFrames, layout: FoundLayout) -> int:
    """Return the number of constant bits with which the position begins, rounded down to whole bytes over RS-485."""
    split = layout.frame_split
    bit_changes = recording.bit_changes[split.position_start : split.position_end]
    constant_bits = bit_changes.index(True)  # At least one bit of a position changes.
    bits_in_whole_bytes = constant_bits // 8 * 8
    return bits_in_whole_bytes if recording.interface == "rs485" else constant_bits


def _line_with_wider_position(
    recording: RecordedFrames, layout: FoundLayout, line_parts: _LineParts
) -> Iterator[EqualLine]:
    """Yield the line in which constant bits before the position are its highest bits, if there are any.

    Nothing is yielded if the position would then have more than 64 bits.
    """
    fields_before = layout.frame_split.fields_before
    if not fields_before:
        return
    last_field_before = fields_before[-1]
    wider_width = layout.frame_split.width + last_field_before.width
    if not last_field_before.changes and wider_width <= MOST_BITS:
        wider_parts = replace(
            line_parts, fields_before=line_parts.fields_before[:-1], position=f"position={wider_width}"
        )
        reason = "constant bits in front of the position may be its highest bits"
        yield EqualLine(wider_parts.format_line(recording.interface), reason)


def _line_with_flags(recording: RecordedFrames, layout: FoundLayout, line_parts: _LineParts) -> Iterator[EqualLine]:
    """Yield the line in which one or two constant 1 bits before the CRC are the error and warning bits of BiSS.

    Nothing is yielded without such bits, over other interfaces, and with a parity bit.
    """
    last_field = layout.frame_split.fields_after[-1] if layout.frame_split.fields_after else None
    if recording.interface != "biss" or last_field is None or last_field.changes:
        return
    if last_field.width in _FLAG_NAMES and is_all_ones(recording, last_field) and layout.parity is None:
        fields_after = [*line_parts.fields_after[:-1], _FLAG_NAMES[last_field.width]]
        reason = "BiSS usually sends its inactive flags as 1, but any constant fits"
        yield EqualLine(replace(line_parts, fields_after=fields_after).format_line("biss"), reason)


def _describe_certainty(recording: RecordedFrames, layout: FoundLayout) -> Iterator[str]:
    """Yield how certain the CRC, the constant bits and the position are."""
    split = layout.frame_split
    crc = layout.crc
    if crc is None:
        yield "no known CRC fits all frames"
    elif crc.is_modbus:
        chance = f"by coincidence, one of 2^{crc.evidence} recordings"
        yield f"CRC-16/MODBUS, low byte first, fits all {len(recording.frames)} frames ({chance})"
    else:
        unlisted = "" if crc.is_known else ", which is not in the list of known ones"
        chance = f"by coincidence, one of 2^{crc.evidence} recordings"
        yield f"the CRC 0x{crc.polynomial:x}{unlisted} fits all {len(recording.frames)} frames ({chance})"
    constant_fields = [field for field in (*split.fields_before, *split.fields_after) if not field.changes]
    if constant_fields:
        constants = " and ".join(_constant_text(recording, field) for field in constant_fields)
        yield f"{constants}. Constant bits cannot be named: they can be error, warning, zero or unused bits"
    if not split.is_smooth:
        yield "the positions do not move smoothly, so its width and code are only the simplest ones"


def _constant_text(recording: RecordedFrames, field: FoundField) -> str:
    """Return a text about the values of a constant field, such as ``bits 7:6 were always 10``."""
    bit_values = "".join(str(recording.bit_value(bit_index)) for bit_index in range(field.start, field.end))
    # ``start`` and ``end`` are counted from the first bit sent, and bit numbers from the last.
    highest_bit = recording.bits - 1 - field.start
    lowest_bit = recording.bits - field.end
    if highest_bit == lowest_bit:
        return f"bit {lowest_bit} was always {bit_values}"
    return f"bits {highest_bit}:{lowest_bit} were always {bit_values}"
