"""A decoded frame or register, and the findings in it: errors, reports, the verdict, and unexpected values.

A valid frame may contain an unusable position, since an encoder with an error, or a busy one, also sends valid CRCs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ..model import (
    Alarm,
    Choice,
    Constant,
    Decimal,
    Device,
    Fault,
    Field,
    Flag,
    Layout,
    Parity,
    PlacedChannels,
    PlacedField,
    PlacedLayout,
    Scale,
    Sign,
    Unused,
    Variant,
    Verdict,
    cite,
)
from ..model.measurement import PositionRange
from ..model.order_codes import applies_to_code
from ..model.record import dataclass
from ..say import frame_texts
from ..say.commands_and_alarms import alarm_of, alarm_source, meaning, remedy
from .bits_and_values import bits_of_field, parity_bit, signed_or_plain


@dataclass(frozen=True, slots=True)
class FrameProblem:
    """An error in a frame, with the field in error."""

    fault: Fault
    field: str
    message: str


def problems_with_other_fields(
    placed_layout: PlacedLayout, placed_field: PlacedField, sent_value: int, frame: int
) -> Iterator[FrameProblem]:
    """Yield an error if the field is a wrong parity bit, or the selector of a different layout.

    ``sent_value`` are its bits as they are sent in ``frame``. A parity bit also covers the other bits as they are sent,
    before a conversion from Gray code.
    """
    name = placed_field.name
    kind = placed_field.field.kind
    if isinstance(kind, Parity):
        correct_bit = parity_bit(placed_layout, kind, frame)
        if sent_value != correct_bit:
            covered_names = ", ".join(field.name for field in placed_layout.find_fields(kind.of))
            message = frame_texts.wrong_parity_message(name, f"{sent_value}", covered_names, f"{correct_bit}")
            yield FrameProblem(Fault.CONSTANT, field=name, message=message)
    elif name == placed_layout.layout.selector and sent_value not in placed_layout.layout.selects:
        message = frame_texts.other_frame_message(name, f"{sent_value:X}")
        yield FrameProblem(Fault.RANGE, field=name, message=message)


def problems_of_position(device: Device, placed_layout: PlacedLayout, binary_number: int) -> Iterator[FrameProblem]:
    """Yield an error if the position in the frame is outside the range of this encoder.

    ``binary_number`` is the frame with its Gray code converted to binary. A position with separately sent digits, such
    as BCD, is not checked here.
    """
    position_range = device.range_in(placed_layout.layout)
    if position_range is None or any(field.kind.digit_code for field in position_range.fields):
        return
    message = range_message(position_range, placed_layout, binary_number)
    if message:
        yield FrameProblem(Fault.RANGE, field=position_range.name, message=message)


def problems_of_digits(
    device: Device, placed_layout: PlacedLayout, frame: int, binary_number: int
) -> Iterator[FrameProblem]:
    """Yield an error for each number with separately sent digits that has an invalid digit or is too high.

    ``frame`` is the frame as it is sent. In ``binary_number``, the same frame with converted numbers, all bits of a
    number with an invalid digit are 1, which is also too high.
    """
    position_range = device.range_in(placed_layout.layout)
    for placed_field in placed_layout.fields:
        name = placed_field.name
        code = placed_field.field.code_of_digits
        if code is None:
            continue
        highest = code.highest(placed_field.width)
        if position_range is not None and position_range.name == name:
            highest = position_range.highest.value(placed_layout.parameters)
        sent_bits = bits_of_field(placed_field, frame)
        number = bits_of_field(placed_field, binary_number)
        if number > highest:
            message = frame_texts.not_in_code_message(name, f"{sent_bits:#x}", f"{highest}", code.name)
            yield FrameProblem(Fault.RANGE, field=name, message=message)


def range_message(position_range: PositionRange, placed_layout: PlacedLayout, binary_number: int) -> str:
    """Return an error message if a position is outside the range of this encoder, or an empty string if it is inside.

    ``binary_number`` is the frame with its Gray code converted to binary. The result is also empty if the order code
    has no field for the position.
    """
    placed_fields = placed_layout.find_fields([field.name for field in position_range.fields])
    if not placed_fields:
        return ""
    lowest = position_range.lowest.value(placed_layout.parameters)
    highest = position_range.highest.value(placed_layout.parameters)
    position = 0
    for placed_field in placed_fields:
        position = (position << placed_field.width) | bits_of_field(placed_field, binary_number)
    number_kind = position_range.fields[0].number
    is_signed = number_kind.signed
    if is_signed:
        position = signed_or_plain(number_kind, position, placed_fields[0].width)
    if lowest <= position <= highest:
        return ""
    if is_signed:
        return frame_texts.outside_limits_message(f"{position_range.name} {position}", f"{lowest}", f"{highest}")
    return frame_texts.too_high_message(position_range.name, f"{position}", f"{highest}")


def problems_of_value(field: Field, field_bits: int) -> Iterator[FrameProblem]:
    """Yield an error if a field cannot have the value ``field_bits``, regardless of the other fields."""
    name = field.name
    match field.kind:
        case Choice(named_values):
            known_numbers = {named_value.value for named_value in named_values}
            if field_bits not in known_numbers:
                message = frame_texts.unknown_value_message(name, f"{field_bits:#x}")
                yield FrameProblem(Fault.RANGE, field=name, message=message)
        case Constant(constant):
            if field_bits != constant:
                message = frame_texts.wrong_constant_message(name, f"{field_bits:#x}", f"{constant:#x}")
                yield FrameProblem(Fault.CONSTANT, field=name, message=message)
        case Decimal() as decimal:
            if field_bits >= decimal.limit:
                message = frame_texts.too_many_digits_message(name, f"{field_bits}", f"{decimal.digits}")
                yield FrameProblem(Fault.RANGE, field=name, message=message)


class DecodedField(NamedTuple):
    """A field of a decoded frame.

    ``raw`` is the number on the wire. ``value`` is its meaning: a number, a Boolean, the name of a value, or a string.
    ``scale`` converts a number to a quantity.
    """

    name: str
    raw: int
    value: int | str | bool
    unit: str
    meaning: str
    high: int
    low: int
    scale: Scale | None = None


@dataclass(frozen=True, slots=True)
class CrcResult:
    """The CRC in a received frame, and the CRC computed from its other bits."""

    name: str
    received: int
    computed: int
    width: int

    @property
    def has_exchanged_bytes(self) -> bool:
        """True if the CRC is wrong, but would be correct if its bytes were sent in reverse order."""
        if self.ok or self.width % 8:
            return False
        received_bytes = self.received.to_bytes(self.width // 8, "little")
        return int.from_bytes(received_bytes, "big") == self.computed

    @property
    def ok(self) -> bool:
        """True if both are equal."""
        return self.received == self.computed


@dataclass(frozen=True, slots=True)
class DecodedFrame:
    """A decoded frame or register. ``number`` is the frame as it is sent.

    ``layout`` is None if no layout matches. ``crc`` is None without a CRC.
    """

    layout: PlacedLayout | None
    number: int
    fields: tuple[DecodedField, ...]
    crc: CrcResult | None
    problems: tuple[FrameProblem, ...]

    @property
    def values(self) -> dict[str, int | str | bool]:
        """Values of the fields by name."""
        return {field.name: field.value for field in self.fields}


@dataclass(frozen=True, slots=True)
class FrameReport:
    """An active flag, or unused bits that differ from the manual. ``makes_position`` is None without a position."""

    field: str
    printed_name: str
    meaning: str
    remedy: str
    makes_position: Verdict | None
    source: str


@dataclass(frozen=True, slots=True)
class ValueDifference:
    """A value that differs from the manual. ``is_register`` is true if it is in a register."""

    field: str
    actual: int | str
    documented: int | str
    message: str
    is_register: bool


@dataclass(frozen=True, slots=True)
class Findings:
    """Findings in a frame or register. ``verdict`` is None without a position or for an invalid frame."""

    reports: tuple[FrameReport, ...] = ()
    verdict: Verdict | None = None
    differences: tuple[ValueDifference, ...] = ()


def findings(device: Device, variant: Variant, decoded: DecodedFrame) -> Findings:
    """Return the findings in a decoded frame or register: reports, the verdict, and differences from the manual.

    They are empty for an invalid frame, since none of its bits can be trusted, and for a frame that the master sends.
    """
    if decoded.problems or decoded.layout is None:
        return Findings()
    layout = decoded.layout.layout
    if layout.sender == "master":
        return Findings()
    is_register = layout.sender != "encoder"
    decoded_fields = {field.name: field for field in decoded.fields}
    active_fields = _active_fields(decoded.layout, decoded_fields)
    if is_register:
        reports = _reports_of_register(device, variant, active_fields, layout.name)
    else:
        reports = _reports_of_frame(device, variant, active_fields)
    differences = _find_differences(variant, decoded, decoded_fields, is_register)
    verdict = None
    if device.has_verdict(variant.interface, layout):
        verdict = _find_worst_verdict(decoded.layout, active_fields)
    return Findings(reports=tuple(reports), verdict=verdict, differences=tuple(differences))


def _active_fields(placed_layout: PlacedLayout, decoded_fields: Mapping[str, DecodedField]) -> list[Field]:
    """Return the active flags, and the unused bits that differ from the manual.

    Some frames have signs: combinations of values that decide the verdict like a flag. If all values of a sign match,
    its flag, which has no bits, is active as well.
    """
    active_fields: list[Field] = []
    for placed_field in placed_layout.fields:
        if _is_active_field(placed_field, decoded_fields[placed_field.name]):
            active_fields.append(placed_field.field)
    layout = placed_layout.layout
    if layout.sender == "encoder":
        active_signs = [sign for sign in layout.signs if _is_active_sign(sign, layout, decoded_fields)]
        active_fields += [sign.flag for sign in active_signs]
    return active_fields


def _reports_of_frame(device: Device, variant: Variant, active_fields: Sequence[Field]) -> Iterator[FrameReport]:
    """Yield a report for each active flag or unused field, except those with which the position remains usable."""
    for field in active_fields:
        if field.kind.makes_position is not Verdict.USABLE:
            yield _build_report(field, _alarm_for(device, variant, field, register=""))


def _reports_of_register(
    device: Device, variant: Variant, active_fields: Sequence[Field], register: str
) -> Iterator[FrameReport]:
    """Yield a report for each active flag that the manual describes as an alarm.

    Other flags of a register are not reported, because they may mean "ready", for example.
    """
    for field in active_fields:
        alarm = _alarm_for(device, variant, field, register)
        if alarm is not None:
            yield _build_report(field, alarm)


def _alarm_for(device: Device, variant: Variant, field: Field, register: str) -> Alarm | None:
    """Return the alarm that the manual describes for a flag, or None if there is none for this order code.

    ``register`` is the name of the register with the flag, or empty for a flag in a frame.
    """
    alarm = alarm_of(device, field, register)
    if alarm is None or not applies_to_code(alarm.only, variant.code):
        return None
    return alarm


def _is_active_field(placed_field: PlacedField, decoded_field: DecodedField) -> bool:
    """Return whether a flag is active, or unused bits differ from the manual. Return false for all other fields."""
    match placed_field.field.kind:
        case Flag():
            return bool(decoded_field.value)
        case Unused(value):
            # The documented value may have more bits than the field has in this order code.
            return decoded_field.raw != value & placed_field.mask
        case _:
            return False


def _is_active_sign(sign: Sign, layout: Layout, decoded_fields: Mapping[str, DecodedField]) -> bool:
    """Return whether all fields of a sign, a combination of values that decides the verdict, have these values."""
    for name, required_number in sign.conditions:
        if name not in decoded_fields:
            return False
        required_value = _decoded_value(layout.field(name), required_number)
        if decoded_fields[name].value != required_value:
            return False
    return True


def _decoded_value(field: Field, number: int) -> str | bool:
    """Return the decoded form of a number: true or false for a flag, or the name of a named value."""
    if isinstance(field.kind, Flag):
        return bool(number)
    return field.value_of(number).name


def _build_report(field: Field, alarm: Alarm | None) -> FrameReport:
    """Return the report of an active field, with the texts of its alarm, if any."""
    return FrameReport(
        field=field.name,
        printed_name=field.printed_name,
        meaning=meaning(field, alarm),
        remedy=remedy(field, alarm),
        makes_position=field.kind.makes_position,
        source=cite(alarm_source(field, alarm)),
    )


def _find_worst_verdict(placed_layout: PlacedLayout, active_fields: Sequence[Field]) -> Verdict:
    """Return the worst verdict to which the active flags and unused bits of a frame lead.

    If none of them leads to a verdict, the position is USABLE. It is UNKNOWN if the frame has no bits that say whether
    the position is usable.
    """
    active_names = {field.name for field in active_fields}
    verdicts = [Verdict.USABLE if placed_layout.judges_position else Verdict.UNKNOWN]
    for field in active_fields:
        # A flag that combines others, listed in ``sums_up``, adds no information while one of them is active.
        is_redundant = isinstance(field.kind, Flag) and not active_names.isdisjoint(field.kind.sums_up)
        verdict = field.kind.makes_position
        if verdict is not None and not is_redundant:
            verdicts.append(verdict)
    from_worst_to_best = list(Verdict)  # in the order of their definition
    return min(verdicts, key=from_worst_to_best.index)


def _find_differences(
    variant: Variant, decoded: DecodedFrame, decoded_fields: Mapping[str, DecodedField], is_register: bool
) -> Iterator[ValueDifference]:
    """Yield the fields whose value differs from the value that the manual gives for this order code.

    ``is_register`` is true if ``decoded`` is a register. Then the messages name the order code.
    """
    assert decoded.layout is not None
    for placed_field in decoded.layout.fields:
        documented = placed_field.field.documented(variant.parameters)
        if documented is None:
            continue
        decoded_field = decoded_fields[placed_field.name]
        # A documented string is a text or the name of a value. A number equals the number formed by the bits.
        actual = decoded_field.value if isinstance(documented, str) else decoded_field.raw
        if actual == documented:
            continue
        name = placed_field.field.printed_name or placed_field.name
        actual_text, documented_text = _quoted_or_hex(actual), _quoted_or_hex(documented)
        if is_register:
            message = frame_texts.undocumented_content_message(name, actual_text, variant.code, documented_text)
        else:
            message = frame_texts.undocumented_value_message(name, actual_text, documented_text)
        yield ValueDifference(
            field=placed_field.name,
            actual=actual,
            documented=documented,
            message=message,
            is_register=is_register,
        )


@dataclass(frozen=True, slots=True)
class ChannelFindings:
    """Findings in a frame with several data channels.

    ``agree`` is true if the fields that the manual compares between channels match. It is None if the manual compares
    none, or if a channel has an error. ``verdict`` is None if a channel has an error.
    """

    channels: tuple[Findings, ...]
    agree: bool | None
    verdict: Verdict | None


def channel_findings(
    device: Device, variant: Variant, frame: PlacedChannels, decoded_channels: Sequence[DecodedFrame]
) -> ChannelFindings:
    """Return the findings in each channel, and the verdict on the position in the whole frame.

    It is the worst verdict of all channels, or NOT_USABLE if fields that should match in all channels differ. A channel
    without the position counts only if its own verdict is known.
    """
    findings_by_channel = tuple(findings(device, variant, decoded) for decoded in decoded_channels)
    if any(decoded.problems for decoded in decoded_channels):
        return ChannelFindings(channels=findings_by_channel, agree=None, verdict=None)
    agree = None
    if frame.compared:
        agree = frame.agree([decoded.values for decoded in decoded_channels])
    verdicts = []
    if agree is False:  # None means that no fields are compared.
        verdicts.append(Verdict.NOT_USABLE)
    for placed_layout, channel in zip(frame.channels, findings_by_channel, strict=True):
        if channel.verdict is None:
            continue
        has_position = device.sends_position(variant.interface, placed_layout.layout)
        if has_position or channel.verdict is not Verdict.UNKNOWN:
            verdicts.append(channel.verdict)
    from_worst_to_best = list(Verdict)
    worst = min(verdicts, key=from_worst_to_best.index)
    return ChannelFindings(channels=findings_by_channel, agree=agree, verdict=worst)


def _quoted_or_hex(field_value: int | str) -> str:
    """Return a text in double quotes, or a number in hexadecimal, such as ``0x2a``."""
    return f'"{field_value}"' if isinstance(field_value, str) else f"{field_value:#04x}"
