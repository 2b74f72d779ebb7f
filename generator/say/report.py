"""Reports of an encoder and errors in a frame: flags, warnings, remedies, and text that is not a valid frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..model import (
    Alarm,
    Device,
    Field,
    Flag,
    Sources,
    Unused,
    member_named,
)
from .commands import remedied, with_steps
from .errata import describe_erratum, errata
from .names_and_places import order_codes_text, register_field, title_of
from .register import short_number
from .text import (
    CodeText,
    Reference,
    Statement,
    TextPart,
    as_sentence,
    join_groups,
    list_parts,
    spec_text,
    statement,
    volts,
)


def describe_alarm(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield all statements about an alarm that follow its name in running text."""
    yield from spec_text(device_alarm.meaning, source=device_alarm.source)
    yield from alarm_facts(device, device_alarm)
    yield from map(describe_erratum, errata(device, f"alarms.{device_alarm.name}"))


def alarm_facts(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield the flag that shows an alarm, its cause, duration and remedy, and the procedures that clear it."""
    if device_alarm.group:
        group = member_named(device.field_groups, device_alarm.group, "field group")
        yield statement(
            CodeText(device_alarm.field), " in ", Reference("group", group.name, title_of(group)), label="Flag"
        )
    elif device_alarm.register:
        # Without a field, the whole register is the flag.
        flag_path = f"{device_alarm.register}.{device_alarm.field}".rstrip(".")
        yield statement(register_field(device, flag_path), label="Flag")
    if not device_alarm.implemented and "not implemented" not in device_alarm.meaning.lower():
        yield statement("Not implemented in this encoder")
    yield from spec_text(device_alarm.detected, label="Detected")
    if device_alarm.below_mv is not None:
        yield statement(f"The alarm is raised below {volts(device_alarm.below_mv)}")
    if device_alarm.latch is True:
        yield statement("The alarm stays active until it is reset")
    elif device_alarm.latch is False:
        yield statement("The alarm clears itself when its cause is gone")
    yield from remedied(device_alarm.remedy, device_alarm.by_hand)
    yield from order_codes_text(device_alarm.only)
    if device_alarm.cleared_by:
        procedures = [Reference("procedure", name, name) for name in device_alarm.cleared_by]
        yield statement(*list_parts(procedures, " or "), label="Cleared by")


def alarm_of(device: Device, field: Field, register: str = "") -> Alarm | None:
    """Return the alarm of a flag, or None if the manual has none.

    ``register`` is the register of the flag, or empty for a flag in a frame, whose alarm is found by its group.
    """
    for alarm in device.alarms:
        if register:
            has_same_owner = alarm.register == register
        else:
            # Alarms in frames belong to the group of their flag.
            has_same_owner = bool(alarm.group) and alarm.group == field.group
        if has_same_owner and alarm.field == field.name:
            return alarm
    return None


def flag_state_meanings(field: Field) -> tuple[str, str]:
    """Return the meanings of the active and the inactive flag, or two empty texts for other fields."""
    if not isinstance(field.kind, Flag):
        return "", ""
    return field.kind.when_active, field.kind.when_inactive


def meaning(field: Field, alarm: Alarm | None) -> str:
    """Return the meaning of an active flag, or of unused bits that differ from the manual.

    For a flag, it is the meaning of its active level, followed by the meaning of the field. If there is neither, it is
    the meaning of the alarm, or ``active``. An active flag that is not implemented contradicts the manual, unless the
    manual explains its active level.
    """
    if isinstance(field.kind, Unused):
        difference = f"unused bits differ from the documented value {short_number(field.kind.value)}"
        return f"{difference}. {as_sentence(field.meaning)}" if field.meaning else difference
    when_active, _ = flag_state_meanings(field)
    if not field.implemented:
        return when_active or "active, although the manual says that this encoder does not have it"
    if when_active and field.meaning:
        return f"{as_sentence(when_active)} {as_sentence(field.meaning)}"
    alarm_meaning = alarm.meaning if alarm is not None else ""
    return when_active or field.meaning or alarm_meaning or "active"


def deciding_bits(field: Field) -> str:
    """Return the bits that lead to the verdict: ``1`` of a flag, ``not 5h`` of unused bits, or "" for other fields.

    They are the active level of a flag, and anything but the documented value of an unused field.
    """
    match field.kind:
        case Flag(active_low=is_active_low):
            return "0" if is_active_low else "1"
        case Unused(value=documented_value):
            is_one_bit = field.widest == 1
            return f"{1 - documented_value}" if is_one_bit else f"not {short_number(documented_value)}"
        case _:
            return ""


def conditions_text(values: Iterable[tuple[Field, int]]) -> Statement:
    """Return the values that together lead to a verdict, such as ``error is 0 and mode is 5h (test)``.

    In ``values``, 1 represents an active flag. The text has its bit.
    """
    phrases = [_condition_parts(field, value) for field, value in values]
    return statement(*join_groups(phrases, " and "))


def _condition_parts(field: Field, value: int) -> tuple[TextPart, ...]:
    """Return a field with its bit or value: ``error is 0`` or ``mode is 5h (test)``.

    ``value`` is 1 for an active flag, whose bit is 0 if it is active low.
    """
    if isinstance(field.kind, Flag):
        is_active = bool(value)
        # The bit is 1 for an active flag that is active high, and for an inactive one that is active low.
        bit = int(is_active != field.kind.active_low)
        return CodeText(field.name), f" is {bit}"
    return CodeText(field.name), f" is {short_number(value)} (", CodeText(field.value_of(value).name), ")"


def remedy(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy with the titles of its manual steps, or an empty string."""
    return with_steps(remedy_text(field, alarm), manual_steps(field, alarm))


def remedy_text(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy without its manual steps."""
    return field.remedy or (alarm.remedy if alarm is not None else "")


def manual_steps(field: Field, alarm: Alarm | None) -> tuple[str, ...]:
    """Return the names of the recommended manual steps."""
    return field.by_hand or (alarm.by_hand if alarm is not None else ())


def alarm_source(field: Field, alarm: Alarm | None) -> Sources:
    """Return the source of the alarm if it has one, otherwise the source of the flag."""
    return alarm.source if alarm is not None and alarm.source else field.source


def wrong_length_message(frame: str, needed: str, actual: str) -> str:
    """Return the message for a wrong length. ``needed`` includes its unit, such as ``45 bits``."""
    return f"'{frame}' has {needed}, got {actual}"


def length_of_channels(channels: str, needed: str, actual: str, difference: str) -> str:
    """Return the message for a wrong length of a frame with several data channels. ``needed`` includes its unit."""
    remedy = "Write all of them, or all bits of a single channel"
    return f"{channels} have {needed} together, got {actual}: {difference}. {remedy}"


def wrong_crc_message(received: str, computed: str) -> str:
    return f"expected CRC {computed}, got {received}"


def constant(name: str, actual: str, always: str) -> str:
    return f"{name} is {actual}, but it must be {always}"


def parity(name: str, actual: str, covered: str, expected: str) -> str:
    return f"{name} is {actual}, but it must be {expected} as the parity of {covered}"


def no_value(name: str, actual: str) -> str:
    """Return the message for a value that a choice does not have."""
    return f"{name} has no value {actual}"


def digits(name: str, actual: str, highest: str) -> str:
    return f"{name} is {actual}, but it has at most {highest} digits"


def too_high(name: str, actual: str, highest: str) -> str:
    """Return the message for a position that the encoder does not have."""
    return f"{name} is {actual}, but the highest is {highest}"


def not_in_code(name: str, sent: str, highest: str, code: str) -> str:
    """Return the message for a number whose digits have no valid code, or that is too high."""
    return f"{name} is sent as {sent}, but it must be {code} of at most {highest}"


def of_other_frame(name: str, actual: str) -> str:
    """Return the message for a selector value that belongs to another frame."""
    return f"{name} {actual} does not belong to this frame"


def too_few_bytes(actual: str) -> str:
    """Return the message for a frame that is too short to identify. ``actual`` includes its unit."""
    return f"{actual}: too short to identify the frame"


def no_frame(selector: str, actual: str, choices: str) -> str:
    """Return the message for a selector value that no frame of the sender has."""
    return f"{selector} is {actual}, but it must be {choices}"


def other_value(name: str, actual: str, documented: str) -> str:
    """Return the message for a frame whose value differs from the manual."""
    return f"{name} is {actual}, but the manual says {documented}"


def other_content(name: str, actual: str, code: str, documented: str) -> str:
    """Return the message for a register whose content differs from the order code."""
    return f"{name}: the register holds {actual}, but {code} has {documented}"


def too_wide(name: str, value: str, bits: str) -> str:
    return f"{name} {value} does not fit into {bits} bits"


def no_power_of_two(name: str, value: str) -> str:
    return f"{name} {value} is not a power of two"


def outside(value: str, low: str, high: str) -> str:
    return f"{value} is outside {low} to {high}"


def of_older_edition(run: str, actual: str, bounds: str, revision: str, register: str, before: str) -> str:
    """Return the message for register digits that are impossible in this edition of the manual."""
    return (
        f"{run} is {actual}, but it must be {bounds}. An encoder older than manual {revision} may hold "
        f"this value. Use --edition {before} to see its {register.replace('_', ' ')}"
    )


#: Highest number of characters in the text of a frame, far more than any frame needs.
LONGEST = 4096
EMPTY = "the frame is empty"
TOO_LONG = "the text is longer than any frame or register"


def not_hex(piece: str) -> str:
    """Return the message for a piece of text, in quotes, among the bytes of a frame."""
    return f"{piece} is not hex. Write the bytes like 02 00 12 34 00 24"


def one_digit(piece: str, digit: str) -> str:
    return f"{piece} is one hex digit. Write 0{digit} if it is a byte"


def odd(piece: str) -> str:
    return f"{piece} has an odd number of hex digits: one is missing or one too many"


def bits_or_bytes(text: str) -> str:
    return f"{text} could be bits or hex bytes. Prefix it with 0b or 0x"


def no_bits(text: str, bits: str, remedy: str) -> str:
    """Return the message for text that is not one number."""
    return f"{text} is not a frame of {bits} bits. {remedy}"


def write_number(bits: str) -> str:
    return f"Write 0b and all {bits} bits in the order sent, or 0x and hex digits"


def write_bits(bits: str, length: str) -> str:
    """Return the remedy for bits of another number, for a frame in ``length`` bytes."""
    return f"Write 0b and all {bits} bits in the order sent, or {length} hex bytes with zeros in front"


def no_order_code(text: str, remedy: str) -> str:
    """Return the message for text that is not a frame, if no order code states its length."""
    return f"{text} is not a frame. {remedy}"


def write_any() -> str:
    return "Write 0b and all bits in the order sent, 0x and hex digits, or the bytes like 02 00 12 34 00 24"


def write_one_of(readings: str) -> str:
    """Return the remedy for digits without a prefix. ``readings`` are their possible meanings, separated by commas."""
    return f"Write {readings}"


def if_decimal(hexadecimal: str) -> str:
    return f"{hexadecimal} if it is decimal"


def if_hex(digits: str) -> str:
    return f"0x{digits} if it is hex"


def if_bits(digits: str) -> str:
    return f"0b{digits} if it is bits"


def also_possible(names: str) -> str:
    """Return the words about a valid frame that also fits other layouts."""
    return f"this can also be another frame: {names}"


def possible_instead(names: str) -> str:
    """Return the words about a wrong frame that can be other frames."""
    return f"this can be another frame: {names}"


def valid_other(name: str) -> str:
    """Return the words about a wrong frame that is a valid frame of another kind."""
    return f"this is a valid {name}"


def register_length(register: str, needed: str, actual: str) -> str:
    """Return the message for a register value of another length. ``needed`` and ``actual`` include the unit."""
    return f"the register '{register}' has {needed}, but the text has {actual}"


def in_gray_code(sent: str, decoded: str) -> str:
    """Return the words about a number in Gray code, both in hexadecimal."""
    return f"sent in Gray code as {sent}, decoded {decoded}"


def explained_together(explained: str, failed: str) -> str:
    """Return the words about the mistakes that explain ``explained`` of the ``failed`` frames with an error."""
    return f"Together, {explained} of {failed} frames with an error have this explanation, most likely first"


def looks_wrong(name: str, readings: str) -> str:
    """Return the words about other readings of a position, separated by commas."""
    return f"Does the position look wrong? The {name} would be {readings}"


def own_request(name: str) -> str:
    """Return the words about a valid word that is also a request."""
    return f"this word is also your own request {name}, as if MISO were connected to MOSI"


def own_requests(names: str) -> str:
    """Return the words about several valid words that all are requests, whose names are separated by commas."""
    return f"each of these words is also your own request, as if MISO were connected to MOSI: {names}"


def no_position(channels: str) -> str:
    """Return the words about a whole frame with an error in the channels with these names."""
    return f"error in {channels}, so the frame has no position"


def bits_around(before: str, after: str) -> str:
    """Return the words about a whole frame with other bits around it."""
    return f"with {before} other bits before the frame and {after} after it"


def other_order(channels: str) -> str:
    """Return the words about a whole frame with its channels in another order."""
    return f"with the channels in the order {channels}"


def all_crcs_correct(reading: str) -> str:
    """Return the sentence about another reading of a whole frame with an error."""
    return f"All CRCs are correct {reading}."


def disturbed(bits: str, *, has_crc: bool) -> str:
    """Return the sentences about one bit that noise may have inverted, or one of several."""
    proof = "the CRC matches" if has_crc else "the frame is valid"
    return (
        f"If only some frames fail, one bit may have been disturbed on the line: {proof} with {bits} inverted. "
        "In that case, no change is needed."
    )


#: Words about explanations of a frame.
ANOTHER_FRAME = (
    "Another frame would help: decode several frames at other positions together, one per line, to see which "
    "explanation fits all of them."
)
UNCERTAIN_READINGS = "Possible readings, most likely first. Each of them is uncertain"
HIDDEN_SHIFT = (
    "A CRC that is not inverted does not detect a shift by one clock in half of all frames. If the position is half or "
    "twice as large as it should be, the frames were also read one clock late or early"
)
NO_EXPLANATION = "No common mistake explains it"


def equal_readings(count: str) -> str:
    """Return the words about readings that nothing in a frame distinguishes."""
    return f"The frame fits {count} of these readings equally well. The likeliest one comes first"


def compared(bits: str, numbers: str, *, agree: bool) -> str:
    """Return the text about the compared bits of several data channels, with the numbers that they form."""
    return f"the highest {bits} bits {'agree' if agree else 'DISAGREE'}: {numbers}"
