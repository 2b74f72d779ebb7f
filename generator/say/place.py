"""Locations: bits of a word, bytes of a frame, addresses of registers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..model import Alternative, Device, Field, Layout, Register, choices
from ..model.expressions import Expression
from .alternative import names
from .text import Part


def hexadecimal(value: int, digits: int = 2) -> str:
    """Return a number in the hexadecimal notation of manuals: ``3Fh``."""
    return f"{value:0{digits}X}h"


def addresses(register: Register) -> str:
    """Return the addresses of a register as text: ``49h`` or ``11h to 17h``."""
    first = hexadecimal(register.address)
    return f"{first} to {hexadecimal(register.last_address)}" if register.last_address > register.address else first


def register_at(register: Register) -> str:
    """Return a register with its addresses as text: ``register 49h`` or ``registers 11h to 17h``."""
    return f"register{'s' * (register.last_address > register.address)} {addresses(register)}"


def field_at(device: Device, path: str) -> str:
    """Return the address and path of a field: ``register 49h (configuration.code)``."""
    return f"{register_at(device.register(path.partition('.')[0]))} ({path})"


def bit_range(high: int, low: int) -> str:
    """Return bit numbers as text: ``5`` or ``5:3``."""
    return f"{high}" if high == low else f"{high}:{low}"


def bits(high: int, low: int) -> str:
    """Return bits as text: ``bit 5`` or ``bits 5:3``."""
    return f"bit{'s' * (high > low)} {bit_range(high, low)}"


def frame_bytes(layout: Layout, length: int, high: int, low: int) -> str:
    """Return the bytes of a ``length``-bit frame that contain these bits: ``byte 1, bits 7:1`` or ``bytes 2 to 4``."""
    last = length // 8 - 1
    first_byte, last_byte = low // 8, high // 8
    if layout.byte_order != "low_byte_first":
        first_byte, last_byte = last - last_byte, last - first_byte
    if low % 8 == 0 and high % 8 == 7:
        return f"byte {first_byte}" if first_byte == last_byte else f"bytes {first_byte} to {last_byte}"
    if first_byte == last_byte:
        return f"byte {first_byte}, {bits(high % 8, low % 8)}"
    return f"{bits(high, low)} of the frame as one number"


def field_place(layout: Layout, field: Field, alternatives: Sequence[Alternative] = ()) -> Iterator[Part]:
    """Yield the location of a field with its padding, in bytes for a frame of bytes, otherwise in bits.

    If the location depends on ``alternatives``, each possible location is followed by its answer.
    """
    size = Expression(field.container) if field.container else field.width
    high = field.low + size - Expression(1)
    needed = {*field.low.parameters, *high.parameters}
    deciding = [alternative for alternative in alternatives if not needed.isdisjoint(alternative.answers[0].sets)]
    if not needed.issubset(name for alternative in deciding for name in alternative.answers[0].sets):
        yield from ("starting at bit ", field.low)
        return
    for index, (answers, sets) in enumerate(choices(deciding)):
        first, last = field.low.value(sets), high.value(sets)
        yield " or " if index else ""
        if last < first:
            yield "absent"
        elif layout.in_bytes and layout.sender:
            yield frame_bytes(layout, layout.widest, last, first)
        else:
            yield bits(last, first)
        if answers:
            yield from (" (", *names(answers), ")")
