"""Text for the reports of an encoder (flags, warnings, remedies), and messages about frames with errors."""

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
from .commands import describe_remedy, remedy_with_procedures
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
    """Yield all statements about an alarm except its name."""
    yield from spec_text(device_alarm.meaning, source=device_alarm.source)
    yield from alarm_facts(device, device_alarm)
    yield from map(describe_erratum, errata(device, f"alarms.{device_alarm.name}"))


def alarm_facts(device: Device, device_alarm: Alarm) -> Iterator[Statement]:
    """Yield the flag that shows an alarm, its cause, its duration, its remedy, and the procedures that clear it."""
    if device_alarm.group:
        group = member_named(device.field_groups, device_alarm.group, "field group")
        group_reference = Reference(kind="group", name=group.name, title=title_of(group))
        yield statement(CodeText(device_alarm.field), " in ", group_reference, label="Flag")
    elif device_alarm.register:
        # Without a field, the whole register is the flag, and the path has no period.
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
    yield from describe_remedy(device_alarm.remedy, device_alarm.by_hand)
    yield from order_codes_text(device_alarm.only)
    if device_alarm.cleared_by:
        procedures = [Reference(kind="procedure", name=name, title=name) for name in device_alarm.cleared_by]
        yield statement(*list_parts(procedures, " or "), label="Cleared by")


def alarm_of(device: Device, field: Field, register: str = "") -> Alarm | None:
    """Return the alarm that a flag shows, or None if the manual describes none.

    ``register`` is the name of the register that contains the flag, or empty for a flag in a frame.
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
    """Return the meanings of a flag while it is active and inactive, or two empty texts for any other field."""
    if not isinstance(field.kind, Flag):
        return "", ""
    return field.kind.when_active, field.kind.when_inactive


def meaning(field: Field, alarm: Alarm | None) -> str:
    """Return the meaning of a report: of an active flag, or of unused bits that differ from the manual.

    For a flag, it is the meaning of its active level, followed by the meaning of the field. If the spec states neither,
    it is the meaning of the alarm or, without an alarm, ``active``. An active flag that the encoder does not implement
    contradicts the manual, unless the manual explains its active level.
    """
    if isinstance(field.kind, Unused):
        difference = f"unused bits differ from the documented value {short_number(field.kind.value)}"
        return f"{difference}. {as_sentence(field.meaning)}" if field.meaning else difference
    when_active, _ = flag_state_meanings(field)
    if not field.implemented:
        return when_active or "active, although the manual says that this encoder does not have it"
    if when_active and field.meaning:
        return f"{as_sentence(when_active)} {as_sentence(field.meaning)}"
    meaning_of_flag = when_active or field.meaning
    meaning_of_alarm = alarm.meaning if alarm is not None else ""
    return meaning_of_flag or meaning_of_alarm or "active"


def deciding_value(field: Field) -> str:
    """Return the value of a field that can decide the verdict, or "" for a field without such a value.

    For a flag, this is its active level, such as ``1``. For unused bits, it is any undocumented value: ``not 5h``.
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
    """Return the field values that together decide a verdict, such as ``error is 0 and mode is 5h (test)``.

    For a flag, a value of 1 means that it is active. The text has the level of its bit, which is 0 if it is active low.
    """
    phrases = [_condition_parts(field, value) for field, value in values]
    return statement(*join_groups(phrases, " and "))


def _condition_parts(field: Field, value: int) -> tuple[TextPart, ...]:
    """Return a field with its value: ``error is 0`` for a flag, or ``mode is 5h (test)`` for a named value.

    For a flag, ``value`` is 1 if it is active. The text has the level of its bit, which is 0 if it is active low.
    """
    if isinstance(field.kind, Flag):
        is_active = bool(value)
        # The bit of an active flag is 1, or 0 if the flag is active low. It is inverted while the flag is inactive.
        bit = int(is_active != field.kind.active_low)
        return CodeText(field.name), f" is {bit}"
    value_name = field.value_of(value).name
    return CodeText(field.name), f" is {short_number(value)} (", CodeText(value_name), ")"


def remedy(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy for a flag or its alarm, with the titles of its manual procedures, or an empty string."""
    return remedy_with_procedures(remedy_text(field, alarm), manual_steps(field, alarm))


def remedy_text(field: Field, alarm: Alarm | None) -> str:
    """Return the remedy for a flag or, if the flag has none, for its alarm, without manual procedures."""
    return field.remedy or (alarm.remedy if alarm is not None else "")


def manual_steps(field: Field, alarm: Alarm | None) -> tuple[str, ...]:
    """Return the names of the manual procedures recommended for a flag or, if it has none, for its alarm."""
    return field.by_hand or (alarm.by_hand if alarm is not None else ())


def alarm_source(field: Field, alarm: Alarm | None) -> Sources:
    """Return the source of a flag's alarm, or the source of the flag if there is no alarm with a source."""
    return alarm.source if alarm is not None and alarm.source else field.source


def wrong_length_message(frame: str, needed: str, actual: str) -> str:
    """Return the message for a wrong length. ``needed`` includes its unit, such as ``45 bits``."""
    return f"'{frame}' has {needed}, got {actual}"


def length_of_channels(channels: str, needed: str, actual: str, difference: str) -> str:
    """Return the message for a wrong length of a frame with several data channels. ``needed`` includes its unit."""
    remedy = "Write all of them, or all bits of a single channel"
    return f"{channels} have {needed} together, got {actual}: {difference}. {remedy}"


def wrong_crc_message(received: str, computed: str) -> str:
    """Return the message for a wrong CRC."""
    return f"expected CRC {computed}, got {received}"


def crc_with_exchanged_bytes(received: str, computed: str) -> str:
    """Return the message for a CRC that would be correct if its bytes were sent in reverse order."""
    return f"{wrong_crc_message(received, computed)}, which is this CRC with its bytes exchanged"


def constant(name: str, actual: str, always: str) -> str:
    """Return the message for a constant with a wrong value. ``always`` is the value that it must have."""
    return f"{name} is {actual}, but it must be {always}"


def parity(name: str, actual: str, covered: str, expected: str) -> str:
    """Return the message for a wrong parity bit. ``covered`` are the names of the fields that it covers."""
    return f"{name} is {actual}, but it must be {expected} as the parity of {covered}"


def no_value(name: str, actual: str) -> str:
    """Return the message for a value that is not one of the named values of a field."""
    return f"{name} has no value {actual}"


def digits(name: str, actual: str, highest: str) -> str:
    """Return the message for a number with too many decimal digits. ``highest`` is the number of digits allowed."""
    return f"{name} is {actual}, but it has at most {highest} digits"


def too_high(name: str, actual: str, highest: str) -> str:
    """Return the message for a position above the highest one of the encoder."""
    return f"{name} is {actual}, but the highest is {highest}"


def not_in_code(name: str, sent: str, highest: str, code: str) -> str:
    """Return the message for a number whose digits are not valid in their code, or that is too high."""
    return f"{name} is sent as {sent}, but it must be {code} of at most {highest}"


def of_other_frame(name: str, actual: str) -> str:
    """Return the message for a selector value that identifies a different frame."""
    return f"{name} {actual} does not belong to this frame"


def too_few_bytes(actual: str) -> str:
    """Return the message for a frame that is too short to identify. ``actual`` includes its unit."""
    return f"{actual}: too short to identify the frame"


def no_frame(selector: str, actual: str, choices: str) -> str:
    """Return the message for a selector value that no frame from this sender has. ``choices`` are the valid values."""
    return f"{selector} is {actual}, but it must be {choices}"


def other_value(name: str, actual: str, documented: str) -> str:
    """Return the message for a field whose value differs from the manual."""
    return f"{name} is {actual}, but the manual says {documented}"


def other_content(name: str, actual: str, code: str, documented: str) -> str:
    """Return the message for a register whose content differs from the documented content for an order code."""
    return f"{name}: the register holds {actual}, but {code} has {documented}"


def too_wide(name: str, value: str, bits: str) -> str:
    """Return the message for a value that needs more bits than its field has."""
    return f"{name} {value} does not fit into {bits} bits"


def no_power_of_two(name: str, value: str) -> str:
    """Return the message for a value that must be a power of two."""
    return f"{name} {value} is not a power of two"


def outside(value: str, low: str, high: str) -> str:
    """Return the message for a value outside its limits."""
    return f"{value} is outside {low} to {high}"


def of_older_edition(run: str, actual: str, bounds: str, revision: str, register: str, before: str) -> str:
    """Return the message for digits of a register that are impossible in this edition of the manual.

    ``run`` is the name of the digits. ``before`` is an edition before ``revision``, whose encoders may have them.
    """
    return (
        f"{run} is {actual}, but it must be {bounds}. An encoder older than manual {revision} may hold "
        f"this value. Use --edition {before} to see its {register.replace('_', ' ')}"
    )


#: Highest number of characters in the text of a frame, far more than any frame needs.
LONGEST = 4096
EMPTY = "the frame is empty"
TOO_LONG = "the text is longer than any frame or register"


def not_hex(piece: str) -> str:
    """Return the message for text that is not a byte in hexadecimal. ``piece`` is this text in quotes."""
    return f"{piece} is not hex. Write the bytes like 02 00 12 34 00 24"


def one_digit(piece: str, digit: str) -> str:
    """Return the message for a single hexadecimal digit where a byte is expected."""
    return f"{piece} is one hex digit. Write 0{digit} if it is a byte"


def odd(piece: str) -> str:
    """Return the message for an odd number of hexadecimal digits."""
    return f"{piece} has an odd number of hex digits: one is missing or one too many"


def decimal_bytes(text: str, meanings: str) -> str:
    """Return the message for several numbers that may be bytes in decimal, and how to write them for each meaning."""
    return f"{text} could be decimal bytes. Write {meanings}"


def bits_or_bytes(text: str) -> str:
    """Return the message for digits that could be bits or bytes in hexadecimal."""
    return f"{text} could be bits or hex bytes. Prefix it with 0b or 0x"


def no_bits(text: str, bits: str, remedy: str) -> str:
    """Return the message for text that is not a frame of ``bits`` bits, followed by a remedy."""
    return f"{text} is not a frame of {bits} bits. {remedy}"


def write_number(bits: str) -> str:
    """Return the remedy for text that is not a frame of ``bits`` bits."""
    return f"Write 0b and all {bits} bits in the order sent, or 0x and hex digits"


def write_separately(bits: str) -> str:
    """Return the remedy for several numbers in the place of one frame of ``bits`` bits."""
    return f"If these are several frames, write each on its own line, as 0b and all {bits} bits, or 0x and hex digits"


def write_bits(bits: str, length: str) -> str:
    """Return the remedy for a wrong number of bits, for a frame of ``bits`` bits in ``length`` bytes."""
    return f"Write 0b and all {bits} bits in the order sent, or {length} hex bytes with zeros in front"


def no_order_code(text: str, remedy: str) -> str:
    """Return the message for text that is not a frame, if no order code is given that states the length."""
    return f"{text} is not a frame. {remedy}"


def write_any() -> str:
    """Return the remedy for text that is not a frame, if the length of the frame is unknown."""
    return "Write 0b and all bits in the order sent, 0x and hex digits, or the bytes like 02 00 12 34 00 24"


def write_one_of(readings: str) -> str:
    """Return the remedy for digits without a prefix. ``readings`` are their possible notations, separated by commas."""
    return f"Write {readings}"


def if_decimal(hexadecimal: str) -> str:
    """Return how to write digits if they are a decimal number."""
    return f"{hexadecimal} if it is decimal"


def if_hex(digits: str) -> str:
    """Return how to write digits if they are hexadecimal."""
    return f"0x{digits} if it is hex"


def if_bits(digits: str) -> str:
    """Return how to write digits if they are bits."""
    return f"0b{digits} if it is bits"


def also_possible(names: str) -> str:
    """Return the note on a valid frame that could also be one of these other frames."""
    return f"this can also be another frame: {names}"


def possible_instead(names: str) -> str:
    """Return the note on a frame with errors that could be one of these other frames."""
    return f"this can be another frame: {names}"


def valid_other(name: str) -> str:
    """Return the note on a frame with errors that is a valid frame of a different kind."""
    return f"this is a valid {name}"


def another_reading(text: str) -> str:
    """Return the note on another way to read a frame, such as ``16 bits, the frame of X-12``."""
    return f"Another reading: {text}"


def register_length(register: str, needed: str, actual: str) -> str:
    """Return the message for a register value of a wrong length. ``needed`` and ``actual`` include their units."""
    return f"the register '{register}' has {needed}, but the text has {actual}"


def in_gray_code(sent: str, decoded: str) -> str:
    """Return the note on a number in Gray code, as sent and as decoded, both in hexadecimal."""
    return f"sent in Gray code as {sent}, decoded {decoded}"


def explained_together(explained: str, failed: str) -> str:
    """Return the introduction to mistakes that explain ``explained`` of the ``failed`` frames with an error."""
    return f"Together, {explained} of {failed} frames with an error have this explanation, most likely first"


def all_explained_together(frames: str) -> str:
    """Return the introduction to mistakes that explain all ``frames`` frames, some of which pass the parity check."""
    return f"Together, all {frames} frames, also the valid ones, have this explanation, most likely first"


def looks_wrong(name: str, readings: str) -> str:
    """Return the question that offers other interpretations of a position. ``readings`` are separated by commas."""
    return f"Does the position look wrong? The {name} would be {readings}"


def own_request(name: str) -> str:
    """Return the note on a valid word that is also a request of the master."""
    return f"this word is also your own request {name}, as if MISO were connected to MOSI"


def own_requests(names: str) -> str:
    """Return the note on several valid words that are all requests of the master. ``names`` are separated by commas."""
    return f"each of these words is also your own request, as if MISO were connected to MOSI: {names}"


def no_position(channels: str) -> str:
    """Return the note on a frame with an error in some of its data channels, whose names are ``channels``."""
    return f"error in {channels}, so the frame has no position"


def bits_around(before: str, after: str) -> str:
    """Return the phrase for a frame with extra bits before and after it."""
    return f"with {before} extra bits before the frame and {after} after it"


def other_order(channels: str) -> str:
    """Return the phrase for a frame with its data channels in a different order."""
    return f"with the channels in the order {channels}"


def all_crcs_correct(reading: str) -> str:
    """Return the sentence about an interpretation of a frame in which all CRCs are correct."""
    return f"All CRCs are correct {reading}."


def disturbed(bits: str, *, has_crc: bool) -> str:
    """Return the sentences about a bit that noise may have inverted. ``bits`` names it, or the bits it may be."""
    proof = "the CRC matches" if has_crc else "the frame is valid"
    return (
        f"If only some frames fail, one bit may have been corrupted on the line: {proof} with {bits} inverted. "
        "In that case, no change is needed."
    )


def disturbed_or_shifted(bits: str) -> str:
    """Return the sentences about a frame whose only check is a parity bit, after ``disturbed``."""
    return (
        "A shift by one clock passes this check in half of all frames, so it is likely if about half of them "
        "fail. If only a few fail, one bit may have been corrupted on the line: the frame is valid with "
        f"{bits} inverted."
    )


#: Sentences about the explanations for a frame with an error.
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
NOT_SEARCHED = "codewheel did not look for mistakes, because the CRC of these bytes does not consist of whole bytes"


def equal_readings(count: str) -> str:
    """Return the note on interpretations that fit a frame equally well. ``count`` is their number."""
    return f"The frame fits {count} of these readings equally well. The likeliest one comes first"


def compared(bits: str, numbers: str, *, agree: bool) -> str:
    """Return whether the compared bits of several data channels agree, with the numbers that they form."""
    return f"the highest {bits} bits {'agree' if agree else 'DISAGREE'}: {numbers}"
