"""The data by which a BiSS master identifies a device: the fixed bits of its 64-bit identity, and its profile ID.

The device ID (registers 78h to 7Dh) and the manufacturer ID (7Eh and 7Fh) form one 64-bit number, high byte first,
in the register order of the BiSS C protocol description: bit 63 is the highest of 78h, bit 0 the lowest of 7Fh.

The module also computes the lengths of the single cycle data, the frame that a master receives in every cycle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ...model import Biss, Crc, Device, Field, Layout, PlacedLayout, Register, Variant, answer_combinations
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.frame_checks import only_value

FIRST, LAST = 0x78, 0x7F
PROFILE = 0x42
_IDENTITY_BITS = 8 * (LAST - FIRST + 1)
_MANUFACTURER_BITS = 16


@dataclass(frozen=True, slots=True)
class IdBits:
    """Bits ``high`` to ``low`` of the identity of a device, and their content ``number``.

    ``description`` is the name of these bits with their registers. ``text`` is the content as characters if it is a
    text, and ``register`` is the register in the spec.
    """

    high: int
    low: int
    number: int
    description: str
    text: str = ""
    register: str = ""

    @property
    def digits(self) -> str:
        """All bits as a binary literal with the prefix ``0b``."""
        return f"0b{self.number:0{self._width}b}"

    @property
    def hexadecimal(self) -> str:
        """The content as a hexadecimal number, such as ``4C6Bh``."""
        # A hexadecimal digit for each 4 bits, rounded up.
        digits = (self._width + 3) // 4
        return f"{self.number:0{digits}X}h"

    @property
    def _width(self) -> int:
        return self.high - self.low + 1


@dataclass(frozen=True, slots=True)
class DataLength:
    """The length of the single cycle data of some order codes.

    ``width_by_field`` are the widths of the data fields in transmission order. ``answers`` are the answers to open
    questions that the length applies to.
    """

    codes: tuple[str, ...]
    answers: tuple[str, ...]
    data_bits: int
    status_bits: int
    crc: Crc | None
    width_by_field: Mapping[str, int]

    @property
    def bits_with_status(self) -> int:
        """The number of data and status bits."""
        return self.data_bits + self.status_bits

    @property
    def bits_with_crc(self) -> int:
        """The number of bits with the CRC."""
        return self.bits_with_status + (self.crc.width if self.crc is not None else 0)


def manufacturer_bits(biss_id: int) -> IdBits:
    """Return the manufacturer ID, which is often two ASCII characters."""
    # A byte that is not ASCII becomes a sign that is not ASCII either.
    characters = biss_id.to_bytes(2, "big").decode("ascii", "replace")
    is_text = characters.isprintable() and characters.isascii()
    return IdBits(
        high=_MANUFACTURER_BITS - 1,
        low=0,
        number=biss_id,
        description="64-bit identity: manufacturer ID, registers 7Eh and 7Fh",
        text=characters if is_text else "",
    )


def device_bits(device: Device) -> tuple[IdBits, ...]:
    """Return the fixed bits of the device ID, highest first."""
    device_id: list[IdBits] = []
    for register in filter(_holds_identity, device.registers):
        device_id += [bits for bits in _register_bits(register) if bits.low >= _MANUFACTURER_BITS]
    return tuple(sorted(device_id, key=lambda bits: bits.low, reverse=True))


def _holds_identity(register: Register) -> bool:
    """Return True for a BiSS register at 78h to 7Fh whose bytes are in the order of the 64-bit identity."""
    is_in_identity = register.address >= FIRST and register.last_address <= LAST
    has_high_byte_first = register.length == 1 or register.byte_order == "high_byte_first"
    return register.interface == Biss.name and is_in_identity and has_high_byte_first


def _register_bits(register: Register) -> Iterator[IdBits]:
    """Yield the fixed bits of a register, at their places in the 64-bit identity.

    A field whose place or width depends on the order code is left out.
    """
    # The registers after this one have the lower bits of the identity.
    bits_below = 8 * (LAST - register.last_address)
    for field in register.layout.fields:
        number = _fixed_value(register.layout, field)
        if number is None or not field.low.is_constant or not field.width.is_constant:
            continue
        # The field counts its bits within the register, and the identity from bit 0 of 7Fh.
        low = bits_below + field.low.constant
        high = low + field.width.constant - 1
        first_address, last_address = _address_of_bit(high), _address_of_bit(low)
        registers_in_words = f"register {first_address:02X}h"
        if first_address != last_address:
            registers_in_words = f"registers {first_address:02X}h to {last_address:02X}h"
        yield IdBits(
            high=high,
            low=low,
            number=number,
            description=f"64-bit identity: device ID, {registers_in_words}",
            text=field.equals if isinstance(field.equals, str) else "",
            register=register.name,
        )


def _address_of_bit(bit: int) -> int:
    """Return the address of the register with a bit of the 64-bit identity: 7Fh for bit 0, 78h for bit 63."""
    return FIRST + (_IDENTITY_BITS - 1 - bit) // 8


def _fixed_value(layout: Layout, field: Field) -> int | None:
    """Return the value of a field that is the same in every device of the family, or None if there is none."""
    only = only_value(layout, field)
    if only is not None:
        return only
    if isinstance(field.equals, str):
        return int.from_bytes(field.equals.encode("ascii", "replace"), "big")
    if isinstance(field.equals, Expression):
        return field.equals.constant if field.equals.is_constant else None
    return field.equals


def single_cycle_data(device: Device) -> Layout | None:
    """Return the frame that a BiSS master receives in every cycle: the encoder's first word with a CRC, or None."""
    for interface, layout in device.layouts():
        is_word_of_encoder = layout.sender == "encoder" and not layout.in_bytes
        if isinstance(interface, Biss) and is_word_of_encoder and layout.crc_fields:
            return layout
    return None


def only_crc(device: Device, layout: Layout, lengths: Sequence[DataLength]) -> Crc | None:
    """Return the CRC of the single cycle data, or None if order codes differ in it or none has a CRC."""
    if layout.always_has_crc:
        return device.crcs_of(layout)[0]
    crcs = {length.crc for length in lengths}
    return crcs.pop() if len(crcs) == 1 else None


def data_lengths(device: Device, layout: Layout) -> tuple[DataLength, ...]:
    """Return the lengths of the single cycle data, each with the order codes that have it, in order of length.

    Order codes with the same widths for all fields share a length. Lengths with different widths can have the same
    total. If the manual leaves questions open, there are separate lengths for each combination of answers.
    """
    lengths: list[DataLength] = []
    for answers, parameters_of_answers in answer_combinations(device.alternatives_of(layout)):
        codes_by_widths: dict[tuple[tuple[str, int], ...], list[str]] = {}
        layout_by_widths: dict[tuple[tuple[str, int], ...], PlacedLayout] = {}
        for variant in device.variants_over(Biss.name):
            placed_layout = layout.place({**variant.parameters, **parameters_of_answers})
            widths = tuple((field.name, field.width) for field in placed_layout.fields)
            codes_by_widths.setdefault(widths, []).append(variant.code)
            layout_by_widths.setdefault(widths, placed_layout)
        answer_names = tuple(answer.name for answer in answers)
        for widths, order_codes in codes_by_widths.items():
            length = _data_length(device, layout_by_widths[widths])
            lengths.append(replace(length, codes=tuple(order_codes), answers=answer_names))
    return tuple(sorted(lengths, key=lambda length: (length.data_bits, length.codes)))


def profile_ids(device: Device) -> dict[int, tuple[str, ...]]:
    """Return the order codes with each profile ID (registers 42h and 43h): ``{0x0C18: ("X-24", "X-25")}``.

    If the spec does not give all bits, all order codes have the factory default of the register. The result is empty
    without a default, and without such a register with its high byte first.
    """
    registers = device.registers_over(Biss.name)
    profile_registers = (register for register in registers if register.address == PROFILE and register.length == 2)
    register = next(profile_registers, None)
    if register is None or register.byte_order != "high_byte_first":
        return {}
    variants = device.variants_over(Biss.name)
    if any(not _is_stated(register.layout, field) for field in register.layout.fields):
        # The value of the register as printed in the manual, which does not distinguish the models.
        codes = tuple(variant.code for variant in variants)
        return {} if register.default is None else {register.default: codes}
    codes_by_id: dict[int, list[str]] = {}
    for variant in variants:
        profile_id = 0
        for placed_field in register.layout.place(variant.parameters).fields:
            value = _stated_value(register.layout, placed_field.field, variant)
            profile_id += value << placed_field.lowest_bit
        codes_by_id.setdefault(profile_id, []).append(variant.code)
    return {profile_id: tuple(codes) for profile_id, codes in codes_by_id.items()}


def _is_stated(layout: Layout, field: Field) -> bool:
    """Return True if the spec gives the value of a field, as a constant or as an expression of the order code."""
    return only_value(layout, field) is not None or isinstance(field.equals, (int, Expression))


def _stated_value(layout: Layout, field: Field, variant: Variant) -> int:
    """Return the value that the spec gives for a field and this order code, or 0 if it gives none."""
    if isinstance(field.equals, Expression):
        return field.equals.value(variant.parameters)
    if isinstance(field.equals, int):
        return field.equals
    return only_value(layout, field) or 0


def _data_length(device: Device, placed_layout: PlacedLayout) -> DataLength:
    """Return the length of a frame whose fields have their places: its data bits, its status bits and its CRC.

    The order codes and the answers that it applies to are empty.
    """
    status_names = [field.name for field in placed_layout.layout.status_fields]
    fields_before_crc = [field for field in placed_layout.fields if field != placed_layout.crc_field]
    data_widths = {field.name: field.width for field in fields_before_crc if field.name not in status_names}
    return DataLength(
        codes=(),
        answers=(),
        data_bits=sum(data_widths.values()),
        status_bits=sum(field.width for field in placed_layout.fields if field.name in status_names),
        crc=device.crc_of(placed_layout),
        width_by_field=data_widths,
    )
