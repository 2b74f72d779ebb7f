"""Text for names and positions: items of a spec, order codes, bits, bytes and addresses. Also the glossary of terms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from ..model import Alternative, Biss, Device, Field, Interface, Layout, Register, Rs485, answer_combinations
from ..model.expressions import Expression
from ..model.record import dataclass
from .errata import answer_names, deciding_alternatives
from .text import CodeText, Reference, Statement, TextPart, join_groups, statement

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
    """Item of the spec, with its name in the spec and its name in the manual."""

    @property
    def name(self) -> str: ...
    @property
    def printed_name(self) -> str: ...


class HasOtherNames(Titled, Protocol):
    """Item that may also have other names in other editions of the manual."""

    @property
    def names(self) -> Mapping[str, str]: ...


def name_in_words(name: str) -> str:
    """Return a name from a spec as words for a sentence: ``encoder_id`` becomes ``encoder ID``."""
    return " ".join(_ACRONYMS.get(word, word) for word in name.split("_"))


def heading(name: str) -> str:
    """Return a name from a spec as a heading: ``encoder_id`` becomes ``Encoder ID``."""
    words = name_in_words(name)
    return words[0].upper() + words[1:]


def title_of(titled: Titled) -> str:
    """Return the name used in the manual or, if the manual gives none, the name from the spec as a heading."""
    return titled.printed_name or heading(titled.name)


def printed_name_of(named: HasOtherNames) -> str:
    """Return the name used in the manual, or else the names used in its other editions, or an empty string."""
    return named.printed_name or ", ".join(named.names.values())


def own_names(named: HasOtherNames) -> str:
    """Return the names used in the manual and its other editions: ``Command, it: Comando``."""
    names = [named.printed_name] if named.printed_name else []
    names += [f"{language}: {name}" for language, name in named.names.items()]
    return ", ".join(names)


def full_title(named: HasOtherNames) -> str:
    """Return the title, followed by different names in editions of other languages: ``Command (it: Comando)``."""
    own_title = title_of(named)
    other_names = [f"{language}: {name}" for language, name in named.names.items() if name != own_title]
    return f"{own_title} ({'; '.join(other_names)})" if other_names else own_title


def register_reference(device: Device, name: str) -> Reference:
    """Return a reference to the register with this name."""
    register = device.register(name)
    return Reference(kind="register", name=name, title=title_of(register))


def register_field(device: Device, path: str) -> Reference:
    """Return a reference to a field of a register, whose path is ``register.field``, or to a register."""
    register_name, _, field_name = path.partition(".")
    if not field_name:
        return register_reference(device, register_name)
    register = device.register(register_name)
    field_title = title_of(register.layout.field(field_name))
    return Reference(kind="register", name=path, title=f"{field_title} in {title_of(register)}")


def order_codes_text(codes: str) -> Iterator[Statement]:
    """Yield the order codes that an item applies to. Nothing is yielded for an empty text, which means all of them."""
    if codes:
        yield statement("This applies only to ", CodeText(codes))


def hexadecimal(value: int, digits: int = 2) -> str:
    """Return a number in the hexadecimal notation of manuals, with at least ``digits`` digits: ``3Fh``."""
    return f"{value:0{digits}X}h"


def addresses_text(register: Register) -> str:
    """Return the addresses of a register as text: ``49h`` or ``11h to 17h``."""
    first_address = hexadecimal(register.address)
    if register.last_address == register.address:
        return first_address
    return f"{first_address} to {hexadecimal(register.last_address)}"


def register_at(register: Register) -> str:
    """Return a register with its addresses as text: ``register 49h`` or ``registers 11h to 17h``."""
    noun = "registers" if register.last_address > register.address else "register"
    return f"{noun} {addresses_text(register)}"


def field_at(device: Device, path: str) -> str:
    """Return the address and path of a field: ``register 49h (configuration.code)``."""
    register_name, _, _ = path.partition(".")
    return f"{register_at(device.register(register_name))} ({path})"


def bit_range(high: int, low: int) -> str:
    """Return bit numbers as text: ``5`` or ``5:3``."""
    return f"{high}" if high == low else f"{high}:{low}"


def bits(high: int, low: int) -> str:
    """Return bits as text: ``bit 5`` or ``bits 5:3``."""
    noun = "bits" if high > low else "bit"
    return f"{noun} {bit_range(high, low)}"


def frame_bytes(layout: Layout, length: int, high: int, low: int) -> str:
    """Return the bytes of a ``length``-bit frame that contain some bits: ``byte 1, bits 7:1`` or ``bytes 2 to 4``.

    ``high`` and ``low`` are the highest and lowest of these bits in the frame as one number. Bytes are counted from 0
    in the order sent. If the bits fill several bytes only in part, the result has their numbers in the whole frame.
    """
    first_byte, last_byte = low // 8, high // 8
    if layout.byte_order != "low_byte_first":
        # The byte with the highest bits is sent first.
        last_byte_of_frame = length // 8 - 1
        first_byte, last_byte = last_byte_of_frame - high // 8, last_byte_of_frame - low // 8
    are_whole_bytes = low % 8 == 0 and high % 8 == 7
    if are_whole_bytes:
        return f"byte {first_byte}" if first_byte == last_byte else f"bytes {first_byte} to {last_byte}"
    if first_byte == last_byte:
        return f"byte {first_byte}, {bits(high % 8, low % 8)}"
    return f"{bits(high, low)} of the frame as one number"


def bit_place(layout: Layout, length: int, high: int, low: int) -> str:
    """Return the position of a field in short: ``46:31``, or ``byte 2.7:4`` for bits 7 to 4 of byte 2.

    ``high`` and ``low`` are its highest and lowest bit in the frame as one number of ``length`` bits. The first byte is
    byte 0. ``bytes 1.3-2.7`` means from bit 3 of byte 1 to bit 7 of byte 2.
    """
    is_one_bit = high == low
    if not layout.in_bytes:
        return f"{high}" if is_one_bit else f"{high}:{low}"
    if layout.byte_order == "low_byte_first":
        first_bit, last_bit = low, high
        first_byte, last_byte = low // 8, high // 8
    else:
        first_bit, last_bit = high, low
        # The byte with the highest bits is sent first.
        last_byte_of_frame = length // 8 - 1
        first_byte, last_byte = last_byte_of_frame - high // 8, last_byte_of_frame - low // 8
    if first_byte != last_byte:
        is_whole_bytes = low % 8 == 0 and high % 8 == 7  # From the lowest bit of a byte to the highest bit of a byte.
        if is_whole_bytes:
            return f"bytes {first_byte}-{last_byte}"
        return f"bytes {first_byte}.{first_bit % 8}-{last_byte}.{last_bit % 8}"
    fills_byte = high - low == 7
    if fills_byte:
        return f"byte {first_byte}"
    place = f"byte {first_byte}.{high % 8}"
    return place if is_one_bit else f"{place}:{low % 8}"


def field_place(layout: Layout, field: Field, alternatives: Sequence[Alternative] = ()) -> Iterator[TextPart]:
    """Yield the location of a field with its padding: in bytes for a frame that consists of bytes, otherwise in bits.

    If only the answers to ``alternatives`` (questions that the manual leaves open) decide the location, each possible
    location is followed by its answers. If other parameters decide it, only the lowest bit is given, as an expression.
    """
    width_with_padding = Expression(field.container) if field.container else field.width
    high = field.low + width_with_padding - Expression(1)
    deciding_parameters = {*field.low.parameters, *high.parameters}
    deciding = deciding_alternatives(alternatives, deciding_parameters)
    if deciding_parameters and not deciding:
        yield from ("starting at bit ", field.low)
        return
    possible_places: list[list[TextPart]] = []
    # If no alternative decides, there is one combination, without answers.
    for answers, answered_parameters in answer_combinations(deciding):
        high_bit = high.value(answered_parameters)
        low_bit = field.low.value(answered_parameters)
        answers_in_parentheses: list[TextPart] = [" (", *answer_names(answers), ")"] if answers else []
        possible_places.append([_place_text(layout, high_bit, low_bit), *answers_in_parentheses])
    yield from join_groups(possible_places, " or ")


def _place_text(layout: Layout, high: int, low: int) -> str:
    """Return the bits from ``high`` to ``low`` as text: ``byte 1, bits 7:1``, ``bits 46:31``, or ``absent`` if none."""
    if high < low:
        return "absent"
    # A register has no sender. Its bits are always numbered as bits of one number.
    is_frame = bool(layout.sender)
    if layout.in_bytes and is_frame:
        return frame_bytes(layout, layout.widest, high, low)
    return bits(high, low)


@dataclass(frozen=True, slots=True)
class GlossaryTerm:
    """Term with its meaning, and where pages explain it.

    A term of one interface has that ``interface`` and the ``section`` of its pages that covers the term. All other
    terms have ``spellings``, which are the names of related fields, registers and times in lowercase.
    """

    name: str
    meaning: str
    spellings: tuple[str, ...] = ()
    interface: type[Interface] | None = None
    section: str = ""


TERMS = (
    GlossaryTerm(
        "ALMC",
        "The byte of an RS-485 reply that has a bit for each alarm. It identifies the alarm when a status bit only "
        "indicates that an alarm is active.",
        ("almc",),
    ),
    GlossaryTerm(
        "Acknowledge, start bit",
        "In a BiSS frame, SLO stays low until the encoder's data is ready. The start bit (high) announces the data.",
        interface=Biss,
        section="timings",
    ),
    GlossaryTerm(
        "Bank",
        "One of several sets of registers at the same addresses. A separate register selects the bank that answers.",
        ("bank", "bank select"),
    ),
    GlossaryTerm(
        "CDM",
        "Control data, master: the bit of control data that the master sends with each BiSS frame. It is the inverse "
        "of the level of MA during the timeout.",
        interface=Biss,
        section="timings",
    ),
    GlossaryTerm(
        "CDS",
        "Control data, slave: the bit of control data that the encoder sends. It directly follows the start bit of a "
        "BiSS frame.",
        interface=Biss,
        section="timings",
    ),
    GlossaryTerm(
        "Control data",
        "A way to access registers over BiSS without interrupting the position data. Each frame carries one bit in "
        "each direction, CDM and CDS, until address, direction, data and their own CRC are complete.",
        interface=Biss,
        section="control-data",
    ),
    GlossaryTerm(
        "Control field, data ID",
        "The first byte of an RS-485 request and its reply. The data ID in this byte selects the requested data.",
        ("control field", "data id"),
    ),
    GlossaryTerm(
        "CRC",
        "A checksum that detects corrupted bits: the remainder of a division of the preceding bits. It is defined by "
        "its polynomial, start value, bit order and final XOR.",
        ("crc",),
    ),
    GlossaryTerm(
        "CRC polynomial",
        "The divisor of a CRC. Masters expect it with its top bit, without its top bit, or without its "
        "trailing 1 (Koopman notation): three numbers for the same polynomial.",
        ("crc",),
    ),
    GlossaryTerm(
        "CRC sent inverted",
        "Each bit of the CRC is sent inverted. Tools call this a final XOR with all ones.",
        ("crc",),
    ),
    GlossaryTerm(
        "CRC reflected",
        "The input or the result of the division is processed least significant bit first, as a serial port sends it.",
        ("crc",),
    ),
    GlossaryTerm(
        "Counts",
        "The steps into which a revolution or a length is divided, used as the unit of a position.",
        ("position", "singleturn"),
    ),
    GlossaryTerm(
        "Device ID, manufacturer ID, profile ID",
        "Registers with the same content in all encoders of a type. A master reads them to identify the encoder.",
        ("device id", "manufacturer id", "profile id"),
    ),
    GlossaryTerm(
        "Error bit, warning bit",
        "Two active-low bits after the position in a BiSS frame: nE (0 = error, do not use the position) and nW "
        "(0 = warning).",
        interface=Biss,
        section="frames",
    ),
    GlossaryTerm(
        "Gray code",
        "A code in which only one bit changes between consecutive numbers. Convert it to binary before you "
        "calculate with it.",
        ("gray",),
    ),
    GlossaryTerm(
        "MA, SLO",
        "The two BiSS lines: clock from the master (MA) and data from the encoder (SLO).",
        interface=Biss,
        section="wiring",
    ),
    GlossaryTerm(
        "MEM BUSY",
        "A bit in replies about the EEPROM. While it is set, the memory is busy and the request is not carried out.",
        ("mem busy",),
    ),
    GlossaryTerm("Multiturn", "The number of whole revolutions, or an encoder that counts them.", ("multiturn",)),
    GlossaryTerm(
        "Offset",
        "A number that the encoder adds to each position.",
        ("offset",),
    ),
    GlossaryTerm(
        "Preset",
        "The value that the encoder reports at the current shaft position once the preset is activated. All other "
        "positions shift accordingly.",
        ("preset",),
    ),
    GlossaryTerm(
        "Profile",
        "A standardized selection and order of the fields in single cycle data.",
        interface=Biss,
        section="frames",
    ),
    GlossaryTerm(
        "Single cycle data, SCD",
        "The data in each BiSS frame: position, error bit, warning bit, and a CRC over them.",
        interface=Biss,
        section="frames",
    ),
    GlossaryTerm(
        "Singleturn", "The position within one revolution, or an encoder without a revolution counter.", ("singleturn",)
    ),
    GlossaryTerm(
        "Status field",
        "The byte of an RS-485 reply that summarizes errors and warnings.",
        ("status field",),
    ),
    GlossaryTerm(
        "Timeout",
        "The pause at the end of a BiSS frame, without clocks on MA, before the encoder is ready for the next frame.",
        interface=Biss,
        section="timings",
    ),
    GlossaryTerm(
        "Tm, monoflop time",
        "SSI: the time for which the data line stays low after the last clock.",
        ("tm",),
    ),
    GlossaryTerm("Tp, pause", "SSI: the minimum time between two words.", ("tp",)),
    GlossaryTerm(
        "Repeated request",
        "RS-485: a reset is a request that is sent several times in succession, with a pause after each request and "
        "no other request in between.",
        interface=Rs485,
        section="procedures",
    ),
)
