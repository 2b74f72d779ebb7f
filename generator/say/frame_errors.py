"""Messages about invalid frames, values that cannot be encoded, and text that is not a frame."""

from __future__ import annotations


def length(frame: str, needed: str, actual: str) -> str:
    """Return the message for a wrong length. ``needed`` includes its unit, such as ``45 bits``."""
    return f"'{frame}' has {needed}, got {actual}"


def crc(received: str, computed: str) -> str:
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
    """Return the words about a valid frame that can be other frames, too."""
    return f"this can also be another frame: {names}"


def possible_instead(names: str) -> str:
    """Return the words about a wrong frame that can be other frames."""
    return f"this can be another frame: {names}"


def valid_other(name: str) -> str:
    """Return the words about a wrong frame that is a valid one of another kind."""
    return f"this is a valid {name}"


def register_length(register: str, needed: str, actual: str) -> str:
    """Return the message for a register value of another length. ``needed`` and ``actual`` include the unit."""
    return f"the register '{register}' has {needed}, but the text has {actual}"


#: Words about explanations of a frame.
ANOTHER_FRAME = (
    "Another frame would help: decode several frames at other positions together, one per line, to see which "
    "explanation fits all of them."
)
UNCERTAIN_READINGS = "Possible readings, most likely first. Without a CRC, none of them is certain"
