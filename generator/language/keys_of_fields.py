"""Keys of fields, layouts, groups and registers in specs: the words that each may have. See ``keys_of_specs.py``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from ..model.kinds import Digits, Scale
from ..model.measurement import LayoutRange
from ..model.part import (
    NOTHING,
    PATTERNS,
    AddressRange,
    BitRange,
    Count,
    Formula,
    HexBytes,
    InterfaceName,
    Joins,
    Name,
    NameOrNames,
    Names,
    NumberOrText,
    OtherBits,
    Prose,
    RegisterBit,
    SourceText,
    VerdictOfAnswer,
    key,
    note_key,
    printed_name_key,
)
from .written import LocatedPart, WrittenPart, written

#: Kind of a field without any of ``KIND_KEYS``.
NUMBER = "number"
_FLAGS = ("active",)
#: Named values of a field or register, by name.
Values = Mapping[str, "WrittenValue"]


@written("One value.")
class WrittenValue(WrittenPart):
    value: Count = key("Number that the name stands for.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = key("", default=NOTHING)
    meaning: Prose = key("Meaning or effect.", default="")
    makes_position: Literal["", "not_usable", "usable_with_warning", "usable"] = key(
        "In a frame of the encoder with the position: the verdict on the position while the field has "
        "this value, as for a flag. Default: the value does not affect the verdict. The value is reported like "
        "an active flag, unless makes_position is usable. In a field called field, {too_weak: {value: "
        "2, makes_position: not_usable}} is reported as field_too_weak.",
        default="",
    )
    source: SourceText = key("", default="")


@written("One field of a layout, group or register, or a reference to a group of fields.")
class WrittenField(WrittenPart):
    use: Name = key("Name of a field group whose fields are included here.", default="")
    name: Name = key("Name of the field.", default="")
    printed_name: Prose = printed_name_key(default="")
    names: Names = key("", default=NOTHING)
    bits: Formula | None = key(
        "Width in bits, or a parameter that contains the width. The width is 0 for order codes and settings "
        "without the field. In a frame, this is also possible for a flag or parity bit: {name: error, "
        "bits: error_bits, active: high, makes_position: not_usable}, where each order code sets "
        "error_bits to 1 or 0, and for a CRC. Decoders return an absent number as 0 and an absent flag as inactive, "
        "and encoders reject other values. The verdict is unknown for order codes without any bit that "
        "says whether the position is usable.",
        default=None,
    )
    at: BitRange | None = key(
        "Position as a bit number or a range with the high bit first, as in 7:6. Bit 0 is the least significant.",
        default=None,
    )
    top_bit: int | None = key(
        "Position of the field's highest bit, if its lowest bit depends on the width.",
        minimum=0,
        maximum=1023,
        default=None,
    )
    low_bit: Formula | None = key("Position of the field's lowest bit, if it depends on a parameter.", default=None)
    padded_to: int | None = key(
        "Number of bits in which the field is right-aligned. The bits above it are zero.",
        minimum=1,
        maximum=64,
        default=None,
    )
    constant: Count | None = key(
        "Fixed value of bits that identify a valid frame: a sync code, an ID, or the zeros above a "
        "number. A frame with any other value is rejected.",
        default=None,
    )
    unused: Count | None = key(
        "Documented value of bits that have no meaning in this encoder: reserved bits and fixed status "
        "bits. A frame with any other value is still decoded. The bits are reported, unless makes_position is "
        "usable. If it is set, makes_position gives the verdict on the position of such a frame.",
        default=None,
    )
    active: Literal["", "high", "low"] = key(
        "For a one-bit flag: the active level. A bit for 'not ready' is a flag too: {name: not_ready, "
        "active: high, makes_position: not_usable, when_active: the value is not ready}. If the level "
        "depends on the order code, write two flags, each with 'bits' that is 0 for the other order codes.",
        default="",
    )
    when_active: Prose = key("Meaning of the flag when it is active.", default="", allowed_in=_FLAGS)
    when_inactive: Prose = key("Meaning of the flag when it is inactive.", default="", allowed_in=_FLAGS)
    makes_position: Literal["", "not_usable", "usable_with_warning", "usable"] = key(
        "For a flag in a frame with the position: the verdict on the position while the flag is "
        "active. not_usable: the position is wrong, frozen, 0 or doubtful. usable_with_warning: the position can "
        "be used, but something needs attention. usable: the flag does not affect the position. For unused bits: "
        "the verdict when they differ from the manual (default: usable_with_warning, or unknown if no "
        "flag of the frame says whether the position is usable). Over BiSS, the defaults are "
        "not_usable for error and usable_with_warning for warning. Describe a bit that means 'valid' "
        "as a flag that is active at its level for 'not valid'.",
        default="",
        allowed_in=(*_FLAGS, "unused"),
    )
    makes_position_if: Mapping[Name, VerdictOfAnswer] = key(
        "For a flag with makes_position: another verdict, if the user's answer sets this parameter to "
        "1, as in {low_battery_only: usable_with_warning}. The parameter belongs to an alternative "
        "with a default.",
        most=1,
        default=NOTHING,
        allowed_in=_FLAGS,
    )
    sums_up: tuple[Name, ...] = key(
        "For a flag: the flags that it combines. If a frame also contains the combined flags and one of these is "
        "active, only the combined flags decide the verdict on the position.",
        default=(),
        allowed_in=_FLAGS,
    )
    only: Prose = key(
        "For a flag: the order codes for which the manual explains the flag, as in .../65K...:",
        writing=f"{PATTERNS} For other order codes, an active flag is reported as not explained, and the position is "
        "usable with a warning. A parameter that the order code sets must be 0 for exactly those other order codes.",
        default="",
        allowed_in=_FLAGS,
    )
    remedy: Prose = key(
        "For a flag: instructions for clearing it, if no alarm gives them.", default="", allowed_in=_FLAGS
    )
    by_hand: tuple[Name, ...] = key(
        "For a flag: names of characteristics that list steps for a person. Their values contain the "
        "steps, numbered 1., 2., 3.",
        default=(),
        allowed_in=_FLAGS,
    )
    values: Values = key("Values that the field can take, by name.", default=NOTHING)
    others: Literal["", "reserved"] = key(
        "Write 'reserved' if the manual reserves all unlisted values. Decoders then give unlisted values "
        "names such as reserved_3. Without this key, decoders report unlisted values as errors. The key "
        "needs 'values' next to it, and is allowed only in fields of at most 4 bits that an encoder "
        "sends.",
        default="",
        allowed_in=("values",),
    )
    values_of: Literal["", "data_ids"] = key(
        "The field takes its values from the interface's table of data IDs.", default=""
    )
    crc: Name = key(
        "Name of the CRC in this field, computed over everything sent before the CRC, or over the fields in crc_of. "
        "A frame can end with several CRCs, of which each order code has one or none: {name: crc_6, bits: short_bits, "
        "crc: biss_6} and {name: crc_16, bits: long_bits, crc: biss_16}, where each order code sets short_bits to 6 or "
        "0, and long_bits to 16 or 0.",
        default="",
    )
    crc_of: tuple[Name, ...] = key(
        "With crc, in a frame of bits: the fields that the CRC covers. They must be adjacent, and listed in the order "
        "in which they are sent. The fields can include the request if it shares a line with the reply. A "
        "'note' of the field or of the layout names the other fields with data. Default: everything "
        "sent before the CRC.",
        most=32,
        default=(),
        allowed_in=("crc",),
    )
    parity_of: NameOrNames = key(
        "The field, list of fields or join that this parity bit covers. In a word of bits without a CRC, the parity "
        "bit covers all other fields, unless a 'note' here names the fields that the manual excludes.",
        default=(),
    )
    parity: Literal["", "even", "odd"] = key(
        "With parity_of: parity of the number of ones in the covered fields and the parity bit "
        "together. Default: even. If the parity depends on the order code, write two fields, each with 'bits' "
        "set to 0 for the order codes of the other field.",
        default="",
        allowed_in=("parity_of",),
    )
    over: Literal["", "odd_bits", "even_bits"] = key(
        "With parity_of: the bits of each covered field that count toward the parity. odd_bits: bits 1, 3, 5 and so "
        "on. even_bits: bits 0, 2, 4 and so on. Bit 0 is the least significant bit of the field. Default: "
        "all bits.",
        default="",
        allowed_in=("parity_of",),
    )
    digits: tuple[LocatedPart[Digits], ...] = key(
        "Groups of decimal digits into which the number is split, most significant first.", default=()
    )
    text: Literal["", "ascii"] = key("Character code of the bytes.", default="")
    equals: NumberOrText | None = key(
        "For a number, text or named values: value expected on this device, for identification. It is "
        "text for a text field, otherwise a number or an expression of parameters. Unlike a constant, "
        "the value is compared but not enforced.",
        default=None,
        allowed_in=(NUMBER, "values", "text"),
    )
    signed: bool = key("True if the number is in two's complement.", default=False, allowed_in=(NUMBER,))
    zero_means: Count | None = key(
        "Number that a raw value of 0 represents, if not zero.", default=None, allowed_in=(NUMBER,)
    )
    power_of_two: bool = key("True if only powers of two are accepted.", default=False, allowed_in=(NUMBER,))
    digit_code: Literal["", "bcd"] = key(
        "Code of each decimal digit of a number in a frame, if the number is not binary. bcd: four bits for each "
        "digit, most significant digit first, as in {name: position, bits: 10, digit_code: bcd} for 0 to 399. The "
        "first digit can have fewer bits. Decoders reject all other codes, such as those above 9.",
        default="",
        allowed_in=(NUMBER,),
    )
    byte_order: Literal["", "low_byte_first", "high_byte_first"] = key(
        "In a frame of bytes over RS-485: byte order of this field, if it differs from that of the layout. In MODBUS, "
        "only the CRC is sent low byte first: {name: crc, crc: modbus, byte_order: low_byte_first}. The field fills "
        "two or more whole bytes in every order code.",
        default="",
        allowed_in=(NUMBER, "values", "constant", "digits", "crc"),
    )
    implemented: bool = key("False if this encoder does not implement the field. Default: true.", default=True)
    reserved: Literal["", "maker"] = key("Write 'maker' if only the manufacturer may use this.", default="")
    explained_by: tuple[RegisterBit, ...] = key(
        "Bits in other registers that give details, each as register.field.", default=()
    )
    unit: Prose = key("For a number: unit of one count.", default="", allowed_in=(NUMBER,))
    scale: LocatedPart[Scale] | None = key("", default=None, allowed_in=(NUMBER,))
    default: Count | None = key("Factory default.", default=None)
    meaning: Prose = key("Meaning of the field.", default="")
    note: Prose = note_key(default="")
    source: SourceText = key("", default="")

    @property
    def is_flag(self) -> bool:
        """True if the field has an active level, whether that is valid or not."""
        return "active" in self.data


#: Keys that define the kind of a field, in the order in which they apply. A field without any is a number.
KIND_KEYS = ("constant", "unused", "active", "values", "values_of", "crc", "parity_of", "digits", "text")


@written("Fields that several layouts share.")
class WrittenFieldGroup(WrittenPart):
    name: Name = key("Name that 'use' refers to.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = key("", default=NOTHING)
    bits: int = key("Width of the whole group.", minimum=1, maximum=64)
    other_bits: OtherBits = key("", default="")
    note: Prose = note_key(default="")
    source: SourceText = key("")
    fields: tuple[WrittenField, ...] = key("Fields.", most=512)


@written("The number that is sent in Gray code as one word, and the condition under which this applies.")
class WrittenGray(WrittenPart):
    of: Name = key("Name of the field or join. A join can include flags that are active high.")
    when: Name = key(
        "Parameter that is 1 for Gray and 0 for binary. Omit this key if the number is always in Gray code.", default=""
    )
    excess: Formula | None = key(
        "For Gray excess, where the counts per turn are not a power of two: number that is sent for "
        "position 0. This number is half of the number of unused codes: (2^9 - 360) / 2 = 76 for 360 counts, "
        "152 for 720. Decoders subtract this number, and reject unused codes. It can be a "
        "parameter, which is 0 for order codes with a power of two. Order codes with several turns need another spec.",
        default=None,
    )


@written(
    "Values of several fields in a frame that together decide the verdict on the position, such as "
    "two flags that are both active. The combination is reported like an active flag of this name: {name: "
    "field_out_of_range, when: {increasing: active, decreasing: active}, meaning: The field is out "
    'of its range, makes_position: usable_with_warning, source: "7.1"}. For one flag or one named '
    "value, write makes_position there."
)
class WrittenCombination(WrittenPart):
    name: Name = key("Name of the report.")
    printed_name: Prose = printed_name_key(default="")
    when: Mapping[Name, Name] = key(
        "At least two fields in the frame, each with its value: active or inactive for a flag, "
        "otherwise the name of one of its 'values'. All fields must have these values, as in "
        "{field_increasing: active, field_decreasing: active}.",
        most=16,
    )
    meaning: Prose = key("Meaning of these values together.")
    makes_position: Literal["not_usable", "usable_with_warning"] = key(
        "Verdict on the position while the fields have these values. It must be more severe than the "
        "verdict for each value alone, because the most severe verdict applies."
    )
    remedy: Prose = key("Instructions for leaving this state.", default="")
    note: Prose = note_key(default="")
    source: SourceText = key("")


@written(
    "Named fields, in order, one after the other. The widths add up to the length of the frame, "
    "which over SPI is the word_bits of the exchange, or otherwise of the interface."
)
class WrittenLayout(WrittenPart):
    name: Name = key("The layout's name.")
    printed_name: Prose = printed_name_key(default="")
    from_: Literal["encoder", "master"] = key("Sender of the frame.")
    carried_as: Literal["", "bits", "bytes"] = key(
        "Form on the line: one string of bits, sent most significant bit first, or bytes. "
        "Frames of 65 to 128 bits need bytes, and the same length for all order codes. If a BiSS or SSI "
        "frame is not a whole number of bytes, its first byte begins with zeros that are not sent.",
        default="",
    )
    byte_order: Literal["", "low_byte_first", "high_byte_first"] = key(
        "For bytes: order in which fields are listed and numbers are sent. A single byte needs this key only "
        "if it has several fields without positions. For words over SPI: low_byte_first if joined "
        "numbers are sent low byte first. Describe each byte as a field.",
        default="",
    )
    channel: int | None = key(
        "For BiSS: the data channel that carries the layout, if the encoder has several. A master keeps the "
        "channels separate, so no field is needed to distinguish them.",
        minimum=1,
        maximum=64,
        default=None,
    )
    when: Mapping[Name, tuple[Count, ...]] = key(
        "A field, and the values of this field that distinguish this layout from the same sender's other "
        "layouts. If frames consist of bytes, the field must have the same position in all of them.",
        most=1,
        default=NOTHING,
    )
    fields: tuple[WrittenField, ...] = key("Fields, either in sending order or each with its position.", most=512)
    join: Joins = key("", default=NOTHING)
    gray: WrittenGray | None = key("", default=None)
    combinations: tuple[WrittenCombination, ...] = key(
        "Combination of values in several fields that decides the verdict on the position.",
        most=64,
        least=0,
        default=(),
    )
    position_range: LocatedPart[LayoutRange] | None = key("", default=None)
    other_bits: OtherBits = key("", default="")
    note: Prose = note_key(default="")
    source: SourceText = key("")


@written("Register that must hold a value before this one can be written.")
class WrittenOpenedBy(WrittenPart):
    register: Name = key("Name of that register.")
    field: Name = key(
        "Field of that register that must hold the value, if the register has several fields.", default=""
    )
    value: Name = key("Named value that it must hold.")


@written("One meaning.")
class WrittenRegisterMeaning(WrittenPart):
    name: Name = key("Name of the meaning.")
    when: RegisterBit = key("Bit that selects the meaning, as register.field.")
    is_: Name = key("Named value of that field.")
    min: Formula | None = key("Lowest value with this meaning.", default=None)
    max: Formula | None = key("Highest value with this meaning.", default=None)
    meaning: Prose = key("Effect of a value with this meaning.", default="")
    source: SourceText = key("", default="")


@written("One register of one or more bytes.")
class WrittenRegister(WrittenPart):
    name: Name = key("Name of the register.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = key("", default=NOTHING)
    meaning: Prose = key("Content or effect of the register.", default="")
    interface: InterfaceName | None = key("Interface through which the register is accessed.", default=None)
    address: int = key("Address of the first byte.", minimum=0, maximum=65535)
    length: int = key("Number of bytes.", minimum=1, maximum=64)
    addresses: AddressRange | None = key(
        "First and last address as the manual prints them, as in 0x4B-0x4D, or the address of a single "
        "byte. 'check' compares them with 'address' and 'length'.",
        default=None,
    )
    access: Literal["read_only", "read_write", "write_only"] = key("Access rights of a master.")
    byte_order: Literal["", "low_byte_first", "high_byte_first"] = key(
        "Byte at the first address: low or high. Required for registers of two or more bytes, except "
        "over SPI, which sends a register as one number.",
        default="",
    )
    default: Count | None = key("Factory default, as one number.", default=None)
    min: Formula | None = key("Lowest value that may be written.", default=None)
    max: Formula | None = key("Highest value that may be written.", default=None)
    limits_of: Name = key("Field or join to which min and max apply. Default: the whole register.", default="")
    opened_by: WrittenOpenedBy | None = key("", default=None)
    clears_itself: bool = key("True if the register returns to its default on its own after a write.", default=False)
    wait_at_least_ms: int | None = key(
        "Minimum wait after a write before the next command, in milliseconds.", minimum=1, maximum=3600000, default=None
    )
    above_max: Literal["", "default", "refused"] = key(
        "The encoder's reaction to a value above the maximum.", default=""
    )
    write_clears: tuple[Name, ...] = key("Registers that are set to zero by a write to this one.", default=())
    meanings: tuple[WrittenRegisterMeaning, ...] = key(
        "For a register whose meaning depends on a bit elsewhere: each meaning with its own limits.",
        least=2,
        default=(),
    )
    reserved: Literal["", "maker"] = key("Write 'maker' if only the manufacturer may use this.", default="")
    bank: Count | None = key(
        "For a BiSS register in a banked area: its bank number, which must be selected first in the "
        "register 'bank_select'.",
        default=None,
    )
    volatile: bool = key(
        "True if a value written to the register is lost at power-off unless it is saved.", default=False
    )
    fields: tuple[WrittenField, ...] = key(
        "Fields of the register. Without them, the register is one number.", most=512, default=()
    )
    join: Joins = key("", default=NOTHING)
    other_bits: OtherBits = key("", default="")
    note: Prose = note_key(default="")
    source: SourceText = key("")


@written("A row of the manual's list of defaults: the bytes of a register, or the value of some of its bits.")
class WrittenPrintedDefault(WrittenPart):
    register: Name = key("Name of the register.")
    bytes: HexBytes = key("All bytes of the register, as printed.", default="")
    at: BitRange | None = key(
        "For a row about some bits: the bit number, or a range with the high bit first.", default=None
    )
    field: Name = key("For a row about some bits: their field, if these bits are exactly one field.", default="")
    value: Count | None = key("Number in these bits.", default=None)
    is_: Name = key("Named value of the field, printed next to the number.", default="")
    erratum: Name = key("Erratum that explains an incorrect row.", default="")
    source: SourceText = key("")
