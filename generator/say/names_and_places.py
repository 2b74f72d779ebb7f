"""Names and locations in text: items, order codes, bits of a word, bytes of a frame, addresses of registers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from ..model import Alternative, Device, Field, Layout, Register, choices
from ..model.expressions import Expression
from .errata import answer_names
from .text import Code, Part, Ref, Statement, statement

_ACRONYMS = {
    "biss": "BiSS",
    "crc": "CRC",
    "eeprom": "EEPROM",
    "id": "ID",
    "led": "LED",
    "leds": "LEDs",
    "lsb": "LSB",
    "rs485": "RS-485",
    "scd": "SCD",
    "spi": "SPI",
    "ssi": "SSI",
    "um": "µm",
}


class Titled(Protocol):
    """Item of the spec, with our name and the name used in the manual."""

    @property
    def name(self) -> str: ...
    @property
    def printed_name(self) -> str: ...


class Named(Titled, Protocol):
    """Item that may also have other names in other editions of the manual."""

    @property
    def names(self) -> Mapping[str, str]: ...


def words(name: str) -> str:
    """Return a name as words in a sentence: ``encoder_id`` as ``encoder ID``."""
    return " ".join(_ACRONYMS.get(word, word) for word in name.split("_"))


def heading(name: str) -> str:
    """Return a name as a heading: ``Encoder ID``."""
    text = words(name)
    return text[0].upper() + text[1:]


def title(titled: Titled) -> str:
    """Return the name used in the manual, or our name if the manual has none."""
    return titled.printed_name or heading(titled.name)


def printed(named: Named) -> str:
    """Return the name used in any edition of the manual, or an empty string."""
    return named.printed_name or ", ".join(named.names.values())


def own_names(named: Named) -> str:
    """Return the names used in the manual and its other editions: ``Command, it: Comando``."""
    return ", ".join(filter(None, (named.printed_name, *(f"{key}: {name}" for key, name in named.names.items()))))


def full_title(named: Named) -> str:
    """Return the title, followed by the names used in other editions: ``Command (it: Comando)``."""
    other_names = "; ".join(f"{key}: {name}" for key, name in named.names.items() if name != title(named))
    return title(named) + (f" ({other_names})" if other_names else "")


def register(device: Device, name: str) -> Ref:
    return Ref("register", name, title(device.register(name)))


def register_field(device: Device, path: str) -> Ref:
    """Return a reference to ``register.field``, or to the register if no field is given."""
    name, _, field = path.partition(".")
    if not field:
        return register(device, name)
    owner = device.register(name)
    return Ref("register", path, f"{title(owner.layout.field(field))} in {title(owner)}")


def only(codes: str) -> Iterator[Statement]:
    """Yield the order codes, unless the item applies to all of them."""
    if codes:
        yield statement("Only with ", Code(codes))


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
            yield from (" (", *answer_names(answers), ")")
