"""What is said of a frame that is not sound, and of a value that cannot be encoded; each number as it is shown."""

from __future__ import annotations


def length(frame: str, needed: str, found: str) -> str:
    """A frame of another length; ``needed`` has its unit: ``45 bits``."""
    return f"'{frame}' has {needed}; this has {found}"


def crc(received: str, computed: str) -> str:
    return f"the CRC is {received}; over these bits it has to be {computed}"


def constant(name: str, found: str, always: str) -> str:
    return f"{name} is {found}; it is always {always}"


def parity(name: str, found: str, of: str, right: str) -> str:
    return f"{name} is {found}; for this {of} it has to be {right}"


def no_value(name: str, found: str) -> str:
    """A choice that has no such value."""
    return f"{name} has no value {found}"


def digits(name: str, found: str, most: str) -> str:
    return f"{name} is {found}, which has more than {most} digits"


def of_other_frame(name: str, found: str) -> str:
    """A field that tells frames apart tells another one."""
    return f"{name} {found} does not belong to this frame"


def too_few_bytes(found: str) -> str:
    """``found`` has its unit."""
    return f"{found}: too few to tell the frame by"


def no_frame(selector: str, found: str, choices: str) -> str:
    """No frame of the sender has this in the field that tells them apart."""
    return f"{selector} is {found}; it can be {choices}"


def other_value(name: str, found: str, documented: str) -> str:
    """A frame with another value than the manual has."""
    return f"{name} is {found}, the manual has {documented}"


def other_content(name: str, found: str, code: str, documented: str) -> str:
    """A register with another value than the order code has."""
    return f"{name}: the register holds {found}, {code} has {documented}"


def too_wide(name: str, value: str, bits: str) -> str:
    return f"{name} {value} does not fit into {bits} bits"


def no_power_of_two(name: str, value: str) -> str:
    return f"{name} {value} is no power of two"


def outside(value: str, low: str, high: str) -> str:
    return f"{value} is outside {low} to {high}"


def of_older_edition(run: str, found: str, bounds: str, revision: str, register: str, before: str) -> str:
    """Digits of a register that cannot be what the edition of the manual says."""
    return (
        f"{run} is {found}, and can only be {bounds}. An encoder of before manual {revision} may hold "
        f"this: what its {register.replace('_', ' ')} is, --edition {before} says"
    )
