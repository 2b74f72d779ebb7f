"""Text of frames: notations in programs and logs, and messages about frames and registers with errors.

``codewheel decode`` and the decode page accept the same notations, with patterns that Python and JavaScript understand.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType


def wrong_length_message(frame: str, needed: str, actual: str) -> str:
    """Return the message for a wrong length. ``needed`` includes its unit, such as ``45 bits``."""
    return f"'{frame}' has {needed}, got {actual}"


def wrong_length_of_channels_message(channels: str, needed: str, actual: str, difference: str) -> str:
    """Return the message for a wrong length of a frame with several data channels. ``needed`` includes its unit."""
    remedy = "Write all of them, or all bits of a single channel"
    return f"{channels} have {needed} together, got {actual}: {difference}. {remedy}"


def wrong_crc_message(received: str, computed: str) -> str:
    """Return the message for a wrong CRC."""
    return f"expected CRC {computed}, got {received}"


def exchanged_crc_bytes_message(received: str, computed: str) -> str:
    """Return the message for a CRC that would be correct if its bytes were sent in reverse order."""
    return f"{wrong_crc_message(received, computed)}, which is this CRC with its bytes exchanged"


def wrong_constant_message(name: str, actual: str, always: str) -> str:
    """Return the message for a constant with a wrong value. ``always`` is the value that it must have."""
    return f"{name} is {actual}, but it must be {always}"


def wrong_parity_message(name: str, actual: str, covered: str, expected: str) -> str:
    """Return the message for a wrong parity bit. ``covered`` are the names of the fields that it covers."""
    return f"{name} is {actual}, but it must be {expected} as the parity of {covered}"


def unknown_value_message(name: str, actual: str) -> str:
    """Return the message for a value that is not one of the named values of a field."""
    return f"{name} has no value {actual}"


def too_many_digits_message(name: str, actual: str, highest: str) -> str:
    """Return the message for a number with too many decimal digits. ``highest`` is the number of digits allowed."""
    return f"{name} is {actual}, but it has at most {highest} digits"


def too_high_message(name: str, actual: str, highest: str) -> str:
    """Return the message for a position above the highest one of the encoder."""
    return f"{name} is {actual}, but the highest is {highest}"


def not_in_code_message(name: str, sent: str, highest: str, code: str) -> str:
    """Return the message for a number whose digits are not valid in their code, or that is too high."""
    return f"{name} is sent as {sent}, but it must be {code} of at most {highest}"


def other_frame_message(name: str, actual: str) -> str:
    """Return the message for a selector value that identifies a different frame."""
    return f"{name} {actual} does not belong to this frame"


def too_few_bytes_message(actual: str) -> str:
    """Return the message for a frame that is too short to identify. ``actual`` includes its unit."""
    return f"{actual}: too short to identify the frame"


def no_frame_message(selector: str, actual: str, choices: str) -> str:
    """Return the message for a selector value that no frame from this sender has. ``choices`` are the valid values."""
    return f"{selector} is {actual}, but it must be {choices}"


def undocumented_value_message(name: str, actual: str, documented: str) -> str:
    """Return the message for a field whose value differs from the manual."""
    return f"{name} is {actual}, but the manual says {documented}"


def undocumented_content_message(name: str, actual: str, code: str, documented: str) -> str:
    """Return the message for a register whose content differs from the documented content for an order code."""
    return f"{name}: the register holds {actual}, but {code} has {documented}"


def too_wide_message(name: str, value: str, bits: str) -> str:
    """Return the message for a value that needs more bits than its field has."""
    return f"{name} {value} does not fit into {bits} bits"


def no_power_of_two_message(name: str, value: str) -> str:
    """Return the message for a value that must be a power of two."""
    return f"{name} {value} is not a power of two"


def outside_limits_message(value: str, low: str, high: str) -> str:
    """Return the message for a value outside its limits."""
    return f"{value} is outside {low} to {high}"


def older_edition_message(run: str, actual: str, bounds: str, revision: str, register: str, before: str) -> str:
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


def not_hex_message(piece: str) -> str:
    """Return the message for text that is not a byte in hexadecimal. ``piece`` is this text in quotes."""
    return f"{piece} is not hex. Write the bytes like 02 00 12 34 00 24"


def one_digit_message(piece: str, digit: str) -> str:
    """Return the message for a single hexadecimal digit where a byte is expected."""
    return f"{piece} is one hex digit. Write 0{digit} if it is a byte"


def odd_digits_message(piece: str) -> str:
    """Return the message for an odd number of hexadecimal digits."""
    return f"{piece} has an odd number of hex digits: one is missing or one too many"


def above_byte_message(piece: str) -> str:
    """Return the message for a number in a list of bytes that is too large for one."""
    return f"{piece} is not a byte: it is above 255 in decimal, and has an odd number of hex digits"


def decimal_bytes_message(text: str, meanings: str) -> str:
    """Return the message for several numbers that may be bytes in decimal, and how to write them for each meaning."""
    return f"{text} could be decimal bytes. Write {meanings}"


def bits_or_bytes_message(text: str) -> str:
    """Return the message for digits that could be bits or bytes in hexadecimal."""
    return f"{text} could be bits or hex bytes. Prefix it with 0b or 0x"


def no_bits_message(text: str, bits: str, remedy: str) -> str:
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


def no_order_code_message(text: str, remedy: str) -> str:
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


def register_length_message(register: str, needed: str, actual: str) -> str:
    """Return the message for a register value of a wrong length. ``needed`` and ``actual`` include their units."""
    return f"the register '{register}' has {needed}, but the text has {actual}"


def gray_code_note(sent: str, decoded: str) -> str:
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


def own_request_note(name: str) -> str:
    """Return the note on a valid word that is also a request of the master."""
    return f"this word is also your own request {name}, as if MISO were connected to MOSI"


def own_requests_note(names: str) -> str:
    """Return the note on several valid words that are all requests of the master. ``names`` are separated by commas."""
    return f"each of these words is also your own request, as if MISO were connected to MOSI: {names}"


def no_position_note(channels: str) -> str:
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


def inverted_bit_note(bits: str, *, has_crc: bool) -> str:
    """Return the sentences about a bit that noise may have inverted. ``bits`` names it, or the bits it may be."""
    proof = "the CRC matches" if has_crc else "the frame is valid"
    return (
        f"If only some frames fail, one bit may have been corrupted on the line: {proof} with {bits} inverted. "
        "In that case, no change is needed."
    )


def inverted_or_shifted_note(bits: str) -> str:
    """Return the sentences about a frame whose only check is a parity bit, after ``inverted_bit_note``."""
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


def compared_bits_note(bits: str, numbers: str, *, agree: bool) -> str:
    """Return whether the compared bits of several data channels agree, with the numbers that they form."""
    return f"the highest {bits} bits {'agree' if agree else 'DISAGREE'}: {numbers}"


#: Patterns for text from programs and logs, with their replacements. In this order: a label such as ``RX: `` with a
#: letter that is not a hex digit, ``uint8_t rx[2] =`` in C, ``b'..'`` in Python, ``\x1F``, brackets and quotes,
#: ``1F-2A``, ``1Fh``, and ``0x1FUL`` in C.
PASTED: tuple[tuple[str, str], ...] = (
    (r"^\s*(?=[^:]*[G-Zg-z])[A-Za-z_][A-Za-z0-9_ ]{0,39}:\s+", ""),
    (r"^\s*[A-Za-z_][A-Za-z0-9_ ]{0,39}\[[0-9A-Z_a-z]{0,20}\]\s*=\s*(?=\{)", ""),
    (r"\bb(?=['\"])", ""),
    (r"\\x([0-9A-Fa-f]{2})", r" 0x\1 "),
    (r"[\[\](){}<>\"',;:]", " "),
    (r"(?<![0-9A-Za-z])([0-9A-Fa-f]{2})-(?=[0-9A-Fa-f]{2}(?![0-9A-Za-z]))", r"\1 "),
    (r"(?<![0-9A-Za-z])(?:0[xX])?([0-9A-Fa-f]+)[hH](?![0-9A-Za-z])", r"0x\1"),
    (r"(?<![0-9A-Za-z])(0[xXbB][0-9A-Fa-f_]+)[uUlL]+(?![0-9A-Za-z])", r"\1"),
)
#: White space that only Python or only JavaScript strips from a text: the separators of ASCII, the next-line character
#: of Latin-1, and the byte order mark at the beginning of a file.
ODD_BLANKS = r"[\x1c-\x1f\x85\ufeff]"
#: A time in front of a frame: with a decimal point, a unit, or hours, minutes and seconds. An arrow may follow, as in
#: the serial monitor of Arduino.
TIME = (
    r"\[?((?:[0-9]{4}-[0-9]{2}-[0-9]{2}[T ])?[0-9]{1,2}:[0-9]{2}:[0-9]{2}(?:[.,][0-9]+)?Z?"
    r"|[0-9]+[.][0-9]+(?: ?(?:s|ms|us|µs))?|[0-9]+ ?(?:s|ms|us|µs))\]?[ \t,;]+(?:->[ \t]*)?(?=[^ \t])"
)
#: Digits without a prefix, by their meaning. A decimal number has no leading zero. A long number is too large for the
#: frame, but may be a frame with extra bits.
DIGITS: Mapping[str, str] = MappingProxyType(
    {
        "decimal": r"0|[1-9][0-9]{0,39}",
        "hexadecimal": r"[0-9A-Fa-f]{1,40}",
        "bits": r"[01]{1,160}",
        "long_number": r"[1-9][0-9]{0,19}",
    }
)
