"""Messages about invalid frames and about values that cannot be encoded. Callers format the numbers."""

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
