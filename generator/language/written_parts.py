"""The parts of a spec that differ from those of the model, as they are written.

The JSON Schema follows from these classes (see ``part_schema.py``), and rules read them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from ..model.facts import (
    Alarm,
    Characteristic,
    Connector,
    Edition,
    EditionTest,
    Evidence,
    Input,
    Led,
    LostFigure,
    Revision,
    Supply,
    Table,
    Timing,
    Write,
)
from ..model.fields import Crc
from ..model.interfaces import CableLength, Clock, DataId, MemoryAccess, Network, Port, Timeout
from ..model.kinds import Digits, Scale
from ..model.measurement import LayoutRange, Measurement
from ..model.part import (
    NOTHING,
    PATTERNS,
    AddressRange,
    Anything,
    BitRange,
    CodeNumber,
    CodePattern,
    Count,
    CrcNumber,
    Date,
    DateOrYear,
    FactPath,
    Formula,
    Heading,
    Headline,
    HexBytes,
    InterfaceName,
    Joins,
    Label,
    Language,
    LanguageVersion,
    Name,
    NameOrNames,
    Names,
    NumberOrText,
    OtherBits,
    PageOfEntry,
    ParameterValue,
    Place,
    Places,
    PrintedWrite,
    Prose,
    RegisterBit,
    Scalar,
    SignedNumber,
    SourceText,
    Url,
    VerdictOfAnswer,
    key,
)
from .written import Located, WrittenPart, written

#: Named values of a field or register, by name.
Values = Mapping[str, "WrittenValue"]


@written("One value.")
class WrittenValue(WrittenPart):
    value: Count = key("Number that the name stands for.")
    printed_name: Prose = key("Name in the manual.", default="")
    names: Names = key("", default=NOTHING)
    meaning: Prose = key("Meaning or effect.", default="")
    makes_position: Literal["", "not_usable", "usable_with_warning", "usable"] = key(
        "In a frame of the encoder with the position: the verdict on the position while the field has "
        "this value, as for a flag. Default: the value does not affect it. The value is reported like "
        "an active flag, unless makes_position is usable. In a field called field, {too_weak: {value: "
        "2, makes_position: not_usable}} is reported as field_too_weak.",
        default="",
    )
    source: SourceText = key("", default="")


@written("One field of a layout, group or register, or a reference to a group of fields.")
class WrittenField(WrittenPart):
    use: Name = key("Name of a field group whose fields are included here.", default="")
    name: Name = key("Name of the field.", default="")
    printed_name: Prose = key("Name in the manual.", default="")
    names: Names = key("", default=NOTHING)
    bits: Formula | None = key(
        "Width in bits, or a parameter that gives it. The width is 0 for order codes and settings "
        "without the field. In a frame, this is also possible for a flag or parity bit: {name: error, "
        "bits: error_bits, active: high, makes_position: not_usable}, where each order code sets "
        "error_bits to 1 or 0. Decoders return an absent number as 0 and an absent flag as inactive, "
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
        "bits. A frame with any other value is still decoded, and the bits are reported, unless "
        "makes_position is usable. makes_position then gives the verdict on the position.",
        default=None,
    )
    active: Literal["", "high", "low"] = key(
        "For a one-bit flag: the active level. A bit for 'not ready' is a flag too: {name: not_ready, "
        "active: high, makes_position: not_usable, when_active: the value is not ready}.",
        default="",
    )
    when_active: Prose = key("Meaning of the flag when it is active.", default="")
    when_inactive: Prose = key("Meaning of the flag when it is inactive.", default="")
    makes_position: Literal["", "not_usable", "usable_with_warning", "usable"] = key(
        "For a flag in a frame with the position: the verdict on the position while the flag is "
        "active. not_usable: the position is wrong, frozen, 0 or doubtful. usable_with_warning: it can "
        "be used, but something needs attention. usable: the flag does not affect it. For unused bits: "
        "the verdict when they differ from the manual (default: usable_with_warning, or unknown if no "
        "flag of the frame says whether the position is usable). Over BiSS, the defaults are "
        "not_usable for error and usable_with_warning for warning. Describe a bit that means 'valid' "
        "as a flag that is active at its level for 'not valid'.",
        default="",
    )
    makes_position_if: Mapping[Name, VerdictOfAnswer] = key(
        "For a flag with makes_position: another verdict, if the user's answer sets this parameter to "
        "1, as in {low_battery_only: usable_with_warning}. The parameter belongs to an alternative "
        "with a default.",
        most=1,
        default=NOTHING,
    )
    sums_up: tuple[Name, ...] = key(
        "For a flag: the flags that it combines. If a frame also contains these and one of them is "
        "active, only they decide the verdict on the position.",
        default=(),
    )
    only: Prose = key(
        "For a flag: the order codes for which the manual explains it, as in .../65K...:",
        writing=f"{PATTERNS} For other order codes, an active flag is reported as not explained, and the position is "
        "usable with a warning. A parameter that the order code sets must be 0 for exactly those other order codes.",
        default="",
    )
    remedy: Prose = key("For a flag: instructions for clearing it, if no alarm gives them.", default="")
    by_hand: tuple[Name, ...] = key(
        "For a flag: names of characteristics that list steps for a person. Their values contain the "
        "steps, numbered 1., 2., 3.",
        default=(),
    )
    values: Values = key("Values that the field can take, by name.", default=NOTHING)
    others: Literal["", "reserved"] = key(
        "Write 'reserved' if the manual reserves all values that it does not list. Decoders then give "
        "them names such as reserved_3. Without this key, decoders report them as errors. The key "
        "needs 'values' next to it, and is allowed only in fields of at most 4 bits that an encoder "
        "sends.",
        default="",
    )
    values_of: Literal["", "data_ids"] = key(
        "The field takes its values from the interface's table of data IDs.", default=""
    )
    crc: Name = key(
        "Name of the CRC that the field holds, computed over everything sent before it, or over the fields crc_of.",
        default="",
    )
    crc_of: tuple[Name, ...] = key(
        "With crc, in a frame of bits: the fields that the CRC covers, adjacent and in the order in "
        "which they are sent. They can include the request if it shares a line with the reply. A "
        "'note' of the field or of the layout names the other fields with data. Default: everything "
        "sent before the CRC.",
        most=32,
        default=(),
    )
    parity_of: NameOrNames = key(
        "The field, list of fields or join that this parity bit covers. Over SPI without a CRC, it "
        "covers all other fields of the word, unless a 'note' here says otherwise.",
        default=(),
    )
    parity: Literal["", "even", "odd"] = key(
        "With parity_of: parity of the number of ones in the covered fields and the parity bit "
        "together. Default: even.",
        default="",
    )
    over: Literal["", "odd_bits", "even_bits"] = key(
        "With parity_of: the bits of each covered field that count. odd_bits: bits 1, 3, 5 and so on. "
        "even_bits: bits 0, 2, 4 and so on. Bit 0 is the least significant bit of the field. Default: "
        "all bits.",
        default="",
    )
    digits: tuple[Located[Digits], ...] = key(
        "Parts into which the decimal digits of the number are split, most significant first.", default=()
    )
    text: Literal["", "ascii"] = key("Character code of the bytes.", default="")
    equals: NumberOrText | None = key(
        "For a number, text or named values: value expected on this device, for identification. It is "
        "text for a text field, otherwise a number or an expression of parameters. Unlike a constant, "
        "it is compared but not enforced.",
        default=None,
    )
    signed: bool = key("True if the number is in two's complement.", default=False)
    zero_means: Count | None = key("Number that a raw value of 0 represents, if not zero.", default=None)
    power_of_two: bool = key("True if only powers of two are accepted.", default=False)
    implemented: bool = key("False if this encoder does not implement it. Default: true.", default=True)
    reserved: Literal["", "maker"] = key("Write 'maker' if only the manufacturer may use this.", default="")
    explained_by: tuple[RegisterBit, ...] = key(
        "Bits of other registers that give details, each as register.field.", default=()
    )
    unit: Prose = key("For a number: unit of one count.", default="")
    scale: Located[Scale] | None = key("", default=None)
    default: Count | None = key("Factory default.", default=None)
    meaning: Prose = key("Meaning of the field.", default="")
    note: Prose = key("Additional information for the reader.", default="")
    source: SourceText = key("", default="")


@written("Fields that several layouts share.")
class WrittenFieldGroup(WrittenPart):
    name: Name = key("Name that 'use' refers to.")
    printed_name: Prose = key("Name in the manual.", default="")
    names: Names = key("", default=NOTHING)
    bits: int = key("Width of the whole group.", minimum=1, maximum=64)
    other_bits: OtherBits = key("", default="")
    note: Prose = key("Additional information for the reader.", default="")
    source: SourceText = key("")
    fields: tuple[WrittenField, ...] = key("Fields.", most=512)


@written("The number that is sent in Gray code as one word, and the condition under which this applies.")
class WrittenGray(WrittenPart):
    of: Name = key("Name of the field or join. A join can include flags that are active high.")
    when: Name = key(
        "Parameter that is 1 for Gray and 0 for binary. Leave it out if the number is always in Gray code.", default=""
    )
    excess: Formula | None = key(
        "For Gray excess, where the counts per turn are not a power of two: number that is sent for "
        "position 0. It is half of the codes that do not occur: (2^9 - 360) / 2 = 76 for 360 counts, "
        "152 for 720. Decoders subtract it, and reject the codes that do not occur. It can be a "
        "parameter, which is 0 for order codes with a power of two.",
        default=None,
    )


@written(
    "Values of several fields of a frame that together decide the verdict on the position, such as "
    "two flags that are both active. It is reported like an active flag of this name: {name: "
    "field_out_of_range, when: {increasing: active, decreasing: active}, meaning: The field is out "
    'of its range, makes_position: usable_with_warning, source: "7.1"}. For one flag or one named '
    "value, write makes_position there."
)
class WrittenCombination(WrittenPart):
    name: Name = key("Name of the report.")
    printed_name: Prose = key("Name in the manual.", default="")
    when: Mapping[Name, Name] = key(
        "At least two fields of the frame, each with its value: active or inactive for a flag, "
        "otherwise the name of one of its 'values'. All of them must have these values, as in "
        "{field_increasing: active, field_decreasing: active}.",
        most=16,
    )
    meaning: Prose = key("Meaning of these values together.")
    makes_position: Literal["not_usable", "usable_with_warning"] = key(
        "Verdict on the position while the fields have these values. It must be more severe than the "
        "verdict of each of the values alone, since the most severe one applies."
    )
    remedy: Prose = key("Instructions for leaving this state.", default="")
    note: Prose = key("Additional information for the reader.", default="")
    source: SourceText = key("")


@written(
    "Named fields, in order, one after the other. Their widths add up to the length of the frame, "
    "which is word_bits over SPI: that of the exchange, or else of the interface."
)
class WrittenLayout(WrittenPart):
    name: Name = key("The layout's name.")
    printed_name: Prose = key("Name in the manual.", default="")
    from_: Literal["encoder", "master"] = key("Sender of the frame.")
    carried_as: Literal["", "bits", "bytes"] = key(
        "Form on the line: one string of bits, with the most significant one sent first, or bytes. "
        "Frames of 65 to 128 bits need bytes. If a BiSS or SSI frame is not a whole number of bytes, "
        "its first byte begins with zeros that are not sent.",
        default="",
    )
    byte_order: Literal["", "low_byte_first", "high_byte_first"] = key(
        "For bytes: order in which fields are listed and numbers are sent. A single byte needs it only "
        "if it has several fields without positions. For words over SPI: low_byte_first if joined "
        "numbers are sent low byte first. Describe each byte as a field.",
        default="",
    )
    channel: int | None = key(
        "For BiSS: the data channel that carries it, if the encoder has several. A master keeps the "
        "channels separate, so no field is needed to distinguish them.",
        minimum=1,
        maximum=64,
        default=None,
    )
    when: Mapping[Name, tuple[Count, ...]] = key(
        "A field and those of its values that distinguish this layout from the other layouts of the "
        "same sender. If frames consist of bytes, the field must have the same position in all of them.",
        most=1,
        default=NOTHING,
    )
    fields: tuple[WrittenField, ...] = key("Fields, either in sending order or each with its position.", most=512)
    join: Joins = key("", default=NOTHING)
    gray: WrittenGray | None = key("", default=None)
    combinations: tuple[WrittenCombination, ...] = key(
        "Values of several fields that together decide the verdict on the position.", most=64, least=0, default=()
    )
    position_range: Located[LayoutRange] | None = key("", default=None)
    other_bits: OtherBits = key("", default="")
    note: Prose = key("Additional information for the reader.", default="")
    source: SourceText = key("")


@written("Synchronous serial interface.")
class WrittenSsi(WrittenPart):
    source: SourceText = key("")
    clock: Located[Clock] = key("")
    alignment: Literal["msb_left", "lsb_right"] = key(
        "Alignment of the word: left (MSB with the first clock, zeros after the word) or right (zeros before it)."
    )
    alignment_source: SourceText = key(
        "Source for the alignment of this encoder. Default: the source of the interface.", default=""
    )
    output_code: Literal["", "binary", "gray", "by_order_code"] = key(
        "Position encoding (binary or Gray), as stated in the manual for this interface. Decoders "
        "follow the key gray of a layout, and check compares the two.",
        default="",
    )
    output_code_source: SourceText = key(
        "Source for the code of this encoder. Default: the source of the interface.", default=""
    )
    signals: Prose = key("Electrical standard of the signals.", default="")
    cable_lengths: tuple[Located[CableLength], ...] = key("Highest clock by cable length.", least=0, default=())
    measurement: Located[Measurement] | None = key("", default=None)
    timings: tuple[Located[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Layouts of the word.", most=256)
    note: Prose = key("Additional information for the reader.", default="")


@written(
    "Fields of the control frame, as far as the manual describes them. They are not a complete "
    "frame, so no layout is generated."
)
class WrittenControlData(WrittenPart):
    fields: tuple[WrittenField, ...] = key("Fields, in the order of the manual.", most=512)
    note: Prose = key("Information that the manual does not give.", default="")
    source: SourceText = key("")


@written("BiSS C-mode.")
class WrittenBiss(WrittenPart):
    source: SourceText = key("")
    clock: Located[Clock] = key("")
    signals: Prose = key("Electrical standard of the signals.", default="")
    description_file: str = key(
        "Name of the device description file that, according to the manual, is installed in the master.",
        pattern=r"^[A-Za-z0-9_.-]+$",
        longest=64,
        default="",
    )
    bank_select: Name = key("Register that selects the bank of the banked area.", default="")
    profile: Prose = key("Encoder profile that the manual names.", default="")
    network: Located[Network] | None = key("", default=None)
    timeout: Located[Timeout] | None = key("", default=None)
    control_data: WrittenControlData | None = key("", default=None)
    measurement: Located[Measurement] | None = key("", default=None)
    timings: tuple[Located[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Layouts of the single cycle data.", most=256)
    note: Prose = key("Additional information for the reader.", default="")


@written("One request.")
class WrittenRs485Exchange(WrittenPart):
    request: Name = key("Layout that the master sends.")
    reply: Name = key(
        "Layout that the encoder sends in reply. Leave it out if the encoder does not answer.", default=""
    )
    purpose: Literal["position", "other"] = key("Effect of the request.")
    source: SourceText = key("", default="")


@written(
    "RS-485 with requests and replies. Give either data_ids or exchanges. data_ids: frames like "
    "those of Tamagawa's T-format, whose first byte is a control field with one of up to 32 data "
    "IDs. exchanges: any other requests with their replies, such as an address, a command and a "
    "checksum. Modbus, EnDat, Nikon's A-format and register banks are not supported."
)
class WrittenRs485(WrittenPart):
    source: SourceText = key("")
    port: Located[Port] = key("")
    data_ids: tuple[Located[DataId], ...] = key(
        "Data IDs, each with the control field that the manual prints for it. Needed unless there are exchanges.",
        default=(),
    )
    exchanges: tuple[WrittenRs485Exchange, ...] = key(
        "Requests with their replies, if these have no data IDs. The constants in a request "
        "distinguish it from the others. Values that the reply repeats from the request, such as an "
        "address, are fields with the same name in both.",
        most=64,
        default=(),
    )
    memory_access: tuple[Located[MemoryAccess], ...] = key(
        "Replies of the encoder to a memory access, depending on the busy flag.", least=0, default=()
    )
    measurement: Located[Measurement] | None = key("", default=None)
    timings: tuple[Located[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Requests and replies.", most=256)
    note: Prose = key("Additional information for the reader.", default="")


@written("One request.")
class WrittenSpiExchange(WrittenPart):
    request: Name = key("Layout that the master sends.")
    reply: Name = key("Layout that the encoder sends in reply.")
    purpose: Literal["position", "read", "write", "other"] = key(
        "Effect of the request. read: its field address is that of a register, and the reply has its "
        "value in the field data. write: its fields address and data are those of a register. If they "
        "are in two words, list these in order. other: anything else."
    )
    word_bits: Formula | None = key(
        "Bits of the request and of its reply, 8 to 64, if they differ from word_bits of the interface.", default=None
    )
    source: SourceText = key("", default="")


@written(
    "SPI, where each word of the master can be a request and each word of the encoder a reply. "
    "Every layout has word_bits bits, of its exchange or of the interface, most significant first. "
    "A register has a single address, and its value is the field data of a frame. Chip select, and "
    "timings other than those listed, are not described."
)
class WrittenSpi(WrittenPart):
    source: SourceText = key("")
    mode: int = key(
        "SPI mode: 0 and 1 have a clock that idles low, 2 and 3 one that idles high. 0 and 2 take data "
        "on the first edge, 1 and 3 on the second.",
        minimum=0,
        maximum=3,
    )
    word_bits: Formula = key(
        "Bits of a word, during which the chip select stays active: 8 to 64. An exchange can have its own."
    )
    reply: Literal["same_word", "next_word"] = key(
        "Word in which the encoder answers a request: the same one, or the next one."
    )
    clock: Located[Clock] = key("")
    exchanges: tuple[WrittenSpiExchange, ...] = key(
        "Requests with their replies. Leave it out if the encoder ignores the words of the master. It "
        "then has a single layout.",
        most=64,
        default=(),
    )
    measurement: Located[Measurement] | None = key("", default=None)
    timings: tuple[Located[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Requests and replies.", most=64)
    note: Prose = key("Additional information for the reader.", default="")


@written(
    "Interfaces of the family, each with its layouts: clocked words (ssi), BiSS C (biss), requests "
    "and replies as bytes (rs485), or words with requests and replies (spi). Encoders with other "
    "interfaces are not supported.",
    needs_a_key=True,
)
class WrittenInterfaces(WrittenPart):
    ssi: WrittenSsi | None = key("", default=None)
    biss: WrittenBiss | None = key("", default=None)
    rs485: WrittenRs485 | None = key("", default=None)
    spi: WrittenSpi | None = key("", default=None)


@written("Register that must hold a value before this one can be written.")
class WrittenOpenedBy(WrittenPart):
    register: Name = key("Name of that register.")
    field: Name = key("Field of that register that must hold the value, if it has several.", default="")
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
    printed_name: Prose = key("Name in the manual.", default="")
    names: Names = key("", default=NOTHING)
    meaning: Prose = key("Content or effect of the register.", default="")
    interface: InterfaceName | None = key("Interface through which the register is accessed.", default=None)
    address: int = key("Address of the first byte.", minimum=0, maximum=65535)
    length: int = key("Number of bytes.", minimum=1, maximum=64)
    addresses: AddressRange | None = key(
        "First and last address as the manual prints them, as in 0x4B-0x4D, or the address of a single "
        "byte. They are checked against 'address' and 'length'.",
        default=None,
    )
    access: Literal["read_only", "read_write", "write_only"] = key("Access rights of a master.")
    byte_order: Literal["", "low_byte_first", "high_byte_first"] = key(
        "Byte at the first address: low or high. Required for registers of two or more bytes, except "
        "over SPI, which sends them as one number.",
        default="",
    )
    default: Count | None = key("Factory default, as one number.", default=None)
    min: Formula | None = key("Lowest value that may be written.", default=None)
    max: Formula | None = key("Highest value that may be written.", default=None)
    limits_of: Name = key("Field or join that min and max apply to. Default: the whole register.", default="")
    opened_by: WrittenOpenedBy | None = key("", default=None)
    clears_itself: bool = key("True if the register returns to its default on its own after a write.", default=False)
    wait_at_least_ms: int | None = key(
        "Minimum wait after a write before the next command, in milliseconds.", minimum=1, maximum=3600000, default=None
    )
    above_max: Literal["", "default", "refused"] = key(
        "Reaction of the encoder to a value above the maximum.", default=""
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
    note: Prose = key("Additional information for the reader.", default="")
    source: SourceText = key("")


@written("A row of the manual's list of defaults: the bytes of a register, or the value of some of its bits.")
class WrittenPrintedDefault(WrittenPart):
    register: Name = key("Name of the register.")
    bytes: HexBytes = key("All bytes of the register, as printed.", default="")
    at: BitRange | None = key(
        "For a row about some of the bits: the bit number, or a range with the high bit first.", default=None
    )
    field: Name = key("For a row about some of the bits: their field, if these bits are exactly one field.", default="")
    value: Count | None = key("Number in these bits.", default=None)
    is_: Name = key("Named value of the field, printed next to the number.", default="")
    erratum: Name = key("Erratum that explains an incorrect row.", default="")
    source: SourceText = key("")


@written("A quantity that differs between order codes.")
class WrittenParameter(WrittenPart):
    meaning: Prose = key("Meaning of the parameter.")
    unit: Prose = key("Unit of the value.", default="")
    hexadecimal: bool = key(
        "True if the value is a code, such as an ID, and is written in hexadecimal. Default: false.", default=False
    )
    equals: Formula | None = key(
        "For a parameter derived from others: the expression for its value. A parameter without "
        "'equals', 'read_from' and 'alternative' is set by the order code.",
        default=None,
    )
    read_from: RegisterBit = key(
        "For a parameter held in a register of the encoder at run time: the register and its field, as "
        "in configuration.output_code. Until it is read, the register's default applies. If the "
        "register has no default, every order code must set the parameter, for the configuration that "
        "it stands for.",
        default="",
    )
    alternative: Name = key("For a parameter set by an alternative: the name of the alternative.", default="")
    interface: InterfaceName | None = key(
        "Interface to which the parameter is restricted. Default: all interfaces can use it.", default=None
    )
    min: Count | None = key("Smallest value of a parameter read from a register.", default=None)
    max: Count | None = key("Largest value of a parameter read from a register.", default=None)
    by_code: Mapping[CodeNumber, Count] = key(
        "For a parameter read from a register whose field holds a code for it: the value of the "
        "parameter for each code, as in {0: 0, 2: 8, 4: 16}. Other codes are refused.",
        least=2,
        default=NOTHING,
    )
    source: SourceText = key("", default="")


@written("One value of a part.")
class WrittenCodeValue(WrittenPart):
    meaning: Prose = key("Meaning of this value.", default="")
    interface: InterfaceName | None = key("Interface that the value selects.", default=None)
    meaning_differs: Prose = key(
        "Reason why the meaning, as the manual prints it, has other numbers or words than the value "
        "sets. check then does not compare them.",
        default="",
    )
    sets: Mapping[Name, ParameterValue] = key("Parameters that the value sets.", least=0, default=NOTHING)
    only_with: Mapping[Name, tuple[str, ...]] = key(
        "Values of other parts that this one can be combined with. Default: all.", least=0, default=NOTHING
    )
    supply: Located[Supply] | None = key("", default=None)
    source: SourceText = key("", default="")


@written("One part of the order code.")
class WrittenCodePart(WrittenPart):
    name: Name = key("Name of the part, as used in the pattern.")
    meaning: Prose = key("Property of the encoder that the part selects.")
    label_is: Formula | None = key(
        "For a part whose labels are numbers: the number as an expression of the parameters that a "
        "value sets, such as singleturn_bits or 2^multiturn_bits. Each label that consists only of "
        "digits is checked against it.",
        default=None,
    )
    source: SourceText = key("", default="")
    open: str = key(
        "Regular expression for values that the manual leaves open. They are accepted, shown as "
        "unlisted, and not counted. Only letters, digits, classes and repetition counts are allowed.",
        pattern=r"^[A-Za-z0-9\[\]{},?+*-]+$",
        longest=40,
        default="",
    )
    open_only_with: Mapping[Name, tuple[str, ...]] = key(
        "Values of other parts that an open value can be combined with. Default: all.", default=NOTHING
    )
    values: Mapping[Label, WrittenCodeValue] = key("All values that the manual lists, as printed on the label.")


@written("An alternative spelling on labels.")
class WrittenSpelling(WrittenPart):
    pattern: CodePattern = key("Label with all parts of the order code in braces, as in ABC{bits}{interface}.")
    where: Prose = key(
        "Origin of this spelling, in words that can follow 'written as in', such as 'edition 1.1 of the manual'."
    )
    values: Mapping[Name, Mapping[Label, str]] = key(
        "For each part: strings on the label, each with the listed value that it represents. A part "
        "given here accepts only these strings. Any other part accepts its listed values.",
        default=NOTHING,
    )
    then: str = key(
        "Regular expression for a suffix that is ignored, such as [0-9]? for an unexplained digit.",
        pattern=r"^[A-Za-z0-9\[\]{},?+*-]+$",
        longest=40,
        default="",
    )
    source: SourceText = key("")


@written("Structure of an order code, and the properties that each part selects.")
class WrittenOrderCode(WrittenPart):
    pattern: CodePattern = key("Order code with its parts in braces, as in ABC{bits}/{interface}.")
    source: SourceText = key("")
    special: Prose = key("The manual's warning about codes that end in /Sxxx.", default="")
    not_on_label: Prose = key(
        "For made-up order codes: what the label shows instead, and what the code stands for.", default=""
    )
    note: Prose = key("Additional information for the reader.", default="")
    parts: tuple[WrittenCodePart, ...] = key("Parts of the code, in the order of the pattern.")
    also_written: tuple[WrittenSpelling, ...] = key(
        "Alternative spellings on labels, such as those of another edition of the manual. They are "
        "accepted, but not counted as order codes.",
        least=0,
        default=(),
    )


@written("One answer.")
class WrittenAnswer(WrittenPart):
    meaning: Prose = key("Meaning of the answer.")
    sets: Mapping[Name, Count] = key("Value of each parameter that this alternative sets.")
    source: SourceText = key("", default="")


@written("A question that the user must decide. An erratum that affects it gives the reason.")
class WrittenAlternative(WrittenPart):
    name: Name = key("Name of the decision.")
    meaning: Prose = key("Question to the user.")
    default: Name = key(
        "Answer that applies unless the user chooses another one: the first, which sets the only "
        "parameter to 0. The others set it to 1. Only verdicts can depend on this parameter, with "
        "makes_position_if of a flag, so that every frame can be decoded without a choice. The default "
        "must be the most careful reading, unless the manual clearly prefers another. Without it, the "
        "user must decide.",
        default="",
    )
    values: Mapping[Name, WrittenAnswer] = key(
        "At least two answers, which all set the same parameters. If the user cannot be asked, as for "
        "the positions in show --json, the first answer applies.",
        least=2,
    )
    source: SourceText = key("")


@written("One value.")
class WrittenArgument(WrittenPart):
    name: Name = key("Name of the value.")
    of: Name = key("Register that the value is written to. The limits of the register apply.")
    as_: Name = key("For a register with several meanings: the meaning whose limits apply.", default="")
    meaning: Prose = key("Meaning of the value.", default="")


@written("One step.")
class WrittenStep(WrittenPart):
    do: Literal["write", "read", "poll", "wait", "send"] = key(
        "Kind of step: write a register, read one, poll a bit of one, wait, or send a request."
    )
    register: Name = key("write, read, poll: name of the register.", default="")
    value: Name = key("write: a named value of the register, or an argument of the procedure.", default="")
    field: Name = key(
        "write: the only field to set. Other fields keep the value that was read. poll: the field to check.", default=""
    )
    until: Count | None = key("poll: the value to wait for.", default=None)
    at_least_ms: int | None = key("wait: minimum time in milliseconds.", minimum=1, maximum=3600000, default=None)
    data_id: Name = key("send: name of the data ID of the request.", default="")
    times: int | None = key("send: number of times to send the request.", minimum=1, maximum=1000, default=None)
    every_at_least_us: int | None = key(
        "send: minimum time from one request to the next, in microseconds.", minimum=1, maximum=10000000, default=None
    )
    in_succession: bool = key(
        "send: true if no other request, not even a poll, may be sent between the repetitions.", default=False
    )
    meaning: Prose = key("Reason for this step.", default="")
    source: SourceText = key("", default="")


@written("Steps carried out by a master.")
class WrittenProcedure(WrittenPart):
    name: Name = key("Name of the procedure.")
    title: Prose = key("Purpose, in a few words.")
    interface: InterfaceName = key("Interface that the procedure uses.")
    arguments: tuple[WrittenArgument, ...] = key("Values supplied by the caller.", default=())
    precondition: Prose = key("Conditions before the start.", default="")
    steps: tuple[WrittenStep, ...] = key("Steps, in order.")
    printed_writes: tuple[PrintedWrite, ...] = key(
        "Writes as the manual prints them, in order. They are checked against the steps. Write 0x48 = "
        "0x01 for a byte, 0x49 bit 2 = 0 for a single bit, and only the addresses, such as 0x50-0x54, "
        "for a value supplied by the caller.",
        default=(),
    )
    result: Prose = key("State after the procedure.", default="")
    note: Prose = key("Additional information for the reader.", default="")
    source: SourceText = key("")


@written("A worked example.")
class WrittenExample(WrittenPart):
    name: Name = key("Name of the example, used in the names of the tests.")
    kind: Literal["frame", "register", "crc", "procedure", "measure"] = key(
        "Kind of example. Frame: bits or bytes, and field values. Register: bytes, and field values. "
        "CRC: bytes, and the check value. Procedure: arguments, and the resulting writes. Measure: a "
        "position in counts, and its length."
    )
    counts: Count | None = key("measure: the position in counts.", default=None)
    micrometres: Count | None = key("measure: the position in micrometres.", default=None)
    source: SourceText = key("")
    order_code: str = key("Order code that the example applies to.", longest=100, default="")
    alternatives: Mapping[Name, Name] = key(
        "frame: chosen answers, each under the name of its alternative. Default: the first answer of each.",
        default=NOTHING,
    )
    layout: Name = key(
        "frame: name of the layout. If the example fits no layout, omit this key and give 'refused'.", default=""
    )
    register: Name = key("register: name of the register.", default="")
    procedure: Name = key("procedure: name of the procedure.", default="")
    crc: Name = key("crc: name of the CRC.", default="")
    from_: Literal["", "encoder", "master"] = key("frame: sender.", default="")
    bytes: HexBytes = key("Bytes of the example.", default="")
    bits: str = key("Bits in order of transmission.", pattern=r"^[01]+$", longest=200, default="")
    check: CrcNumber | None = key("crc: check value over the bytes.", default=None)
    arguments: Mapping[Name, SignedNumber] = key(
        "procedure: arguments by name. They may be negative for a signed register.", least=0, default=NOTHING
    )
    values: Mapping[Name, Scalar] = key(
        "Expected values of fields, joins or groups of digits, by name.", least=0, default=NOTHING
    )
    writes: tuple[Located[Write], ...] = key("procedure: resulting writes, in order.", least=0, default=())
    refused: Literal["", "crc", "constant", "length", "range"] = key(
        "frame: error for which a decoder rejects the frame.", default=""
    )
    erratum: Name = key("Erratum that explains an incorrect example.", default="")
    note: Prose = key("Additional information for the reader.", default="")


@written("")
class WrittenReading(WrittenPart):
    second: Prose = key("The value in the second reading.")
    used: Prose = key("The value in the spec.")


@written("A place where the manual must not be followed literally.")
class WrittenErratum(WrittenPart):
    name: Name = key("Name of the erratum.")
    title: Headline = key(
        "Sentence without a full stop that says what is wrong in the manual, as in 'The cable table is "
        "headed G1 instead of BG1'. Outputs show it instead of the name."
    )
    source: SourceText = key("")
    printed: Prose = key(
        "Printed text, as short as possible. Text in double quotation marks is quoted to the letter, "
        "the rest is a summary."
    )
    used: Prose = key("Fact that the spec uses instead.")
    why: Prose = key("Evidence for this choice.")
    only: Prose = key("Order codes to which it applies, as in .../65K...:", writing=PATTERNS, default="")
    status: Literal["settled", "open"] = key(
        "settled if the manual's own evidence or arithmetic is decisive. open if only hardware or the "
        "manufacturer could decide."
    )
    severity: Literal["wrong_data", "wrong_limit", "omission", "wording"] = key(
        "Result of following the manual literally: wrong bytes or bits on the wire, a wrong limit or "
        "variant, a missing fact, or no wrong result (wording only)."
    )
    affects: tuple[FactPath, ...] = key(
        "Affected facts, as paths into this spec: registers.preset, interfaces.biss.single_cycle_data, crcs.rs485_8.",
        least=0,
        default=(),
    )
    readings: tuple[WrittenReading, ...] = key(
        "Pairs of values, as check prints them. Needed if the manual prints two values, and the spec "
        "and the second reading use different ones.",
        default=(),
    )


@written("A section.", needs_a_key=True)
class WrittenSection(WrittenPart):
    title: Prose = key("Title of a numbered section.", default="")
    page: int | None = key(
        "Page on which the section begins, if the contents give it.", minimum=1, maximum=9999, default=None
    )
    entries: Mapping[Heading, PageOfEntry] = key(
        "Unnumbered entries of the section, such as registers and alarms, with the pages on which they begin.",
        default=NOTHING,
    )


@written("The manual that this file transcribes.")
class WrittenManual(WrittenPart):
    title: Prose = key("Title as printed.")
    revision: Prose = key("Revision as printed. Put it in quotes so that it remains text.")
    date: DateOrYear = key(
        "Release date of that revision, as year-month-day. If the manual gives only a year, for "
        "example as its copyright year, give only the year.",
        default="",
    )
    language: Language = key("Language code of the edition that sources without a key cite.")
    publisher: Prose = key("Publisher of the manual.", default="")
    editions: tuple[Located[Edition], ...] = key(
        "Other language editions that were also read. Sources use the language code to cite them.", least=0, default=()
    )
    contents: Mapping[Heading, WrittenSection] = key(
        "Contents of the manual: sections by number, or by title if they have none, with the pages on "
        "which they begin. 'check' compares cited sections and pages with them.",
        default=NOTHING,
    )
    history: tuple[Located[Revision], ...] = key("Revision table, oldest first.", least=0, default=())


@written("A public document.")
class WrittenDocument(WrittenPart):
    title: Prose = key("Title, revision and publisher.")
    url: Url = key("Web address of the document.", default="")


@written("One difference from the spec. It has exactly one of the keys set, add, remove, unknown and also.")
class WrittenChange(WrittenPart):
    set: Places = key("Place or places whose value changes.", default=())
    to: Anything | None = key("With set: new value.", default=None)
    add: Place = key("A list to which an item is added, or a new key.", default="")
    value: Anything | None = key("With add: new item or value.", default=None)
    remove: Places = key("Place or places to remove.", default=())
    unknown: Places = key(
        "Place or places whose content is unknown. They are removed, and outputs state that they are unknown.",
        default=(),
    )
    also: str = key("Description of an additional, undocumented item.", shortest=1, longest=500, default="")
    why: str = key("The reason.", shortest=1, longest=2000)
    severity: Literal["", "wrong_data", "wrong_limit", "omission", "wording"] = key(
        "Effect of omitting the change, as for an erratum. Default: wrong_data.", default=""
    )
    source: str = key(
        "Source of the change: section and page of the manual, or a key of documents, a colon, and the "
        "place in that document.",
        shortest=1,
        longest=200,
    )


@written("A revision of the manual and its changes.")
class WrittenManualEdition(WrittenPart):
    revision: Prose = key("Revision as printed. It is in the history, or later than the manual's revision.")
    date: Date = key("Date of a later revision, year-month-day.", default="")
    before: tuple[WrittenChange, ...] = key(
        "Changes that lead from the edition of this revision back to the edition before it.", most=100, default=()
    )
    then: tuple[WrittenChange, ...] = key(
        "For a revision later than that of the manual: changes that apply from that revision on.", most=100, default=()
    )
    labels: tuple[Prose, ...] = key("Patterns from also_written that identify labels of this edition.", default=())
    tests: tuple[Located[EditionTest], ...] = key(
        "Registers that identify an encoder of an earlier edition.", default=()
    )


@written(
    "One manual, transcribed: order codes, interfaces, layouts, registers, procedures, examples "
    "and errata of one encoder family."
)
class WrittenSpec(WrittenPart):
    codewheel: LanguageVersion = key(
        "Version of the spec language. 1 is the language of the first release. codewheel migrate updates older specs."
    )
    device: Name = key("Name of the family, the same as the file's stem. Generated modules and prefixes use it.")
    manufacturer: Name = key(
        "Short name of the manufacturer, as given by the key 'manufacturer' in its own file, for example lika."
    )
    title: Prose = key("Name of the family, as used in running text.")
    movement: Literal["rotary", "linear"] = key("Kind of movement: rotary for an angle, linear for a length.")
    evidence: Located[Evidence] = key("")
    manual: WrittenManual = key("")
    documents: Mapping[Name, WrittenDocument] = key(
        "Public documents other than the manual, each under a short key. A source that begins with the "
        "key and a colon cites that document.",
        least=0,
        default=NOTHING,
    )
    lost_figures: tuple[Located[LostFigure], ...] = key(
        "Facts that the manual gives only in a figure, if the text used for transcription has no figures.",
        least=0,
        default=(),
    )
    parameters: Mapping[Name, WrittenParameter] = key(
        "Quantities that differ between order codes or follow from them. Widths and limits refer to "
        "them by name. Write {} if no quantity differs.",
        most=64,
        least=0,
    )
    order_code: WrittenOrderCode = key("")
    crcs: tuple[Located[Crc], ...] = key("Cyclic redundancy checks that layouts refer to.", least=0, default=())
    field_groups: tuple[WrittenFieldGroup, ...] = key(
        "Sequences of fields that several layouts share. A layout includes one with 'use'.", least=0, default=()
    )
    interfaces: WrittenInterfaces = key("")
    registers: tuple[WrittenRegister, ...] = key("Registers, in the order of the manual.", least=0, default=())
    alarms: tuple[Located[Alarm], ...] = key(
        "Error and warning flags: their meanings, whether they latch, and how to clear them.", least=0, default=()
    )
    procedures: tuple[WrittenProcedure, ...] = key(
        "Sequences of register writes, requests and waits that the manual prescribes.", least=0, default=()
    )
    printed_defaults: tuple[WrittenPrintedDefault, ...] = key(
        "The manual's own list of defaults, row by row. It is checked against the registers.", least=0, default=()
    )
    alternatives: tuple[WrittenAlternative, ...] = key(
        "Questions that the manual leaves open, or answers differently from other evidence. The user "
        "must decide. Generated code takes the decision as an argument without a default.",
        least=0,
        default=(),
    )
    timings: tuple[Located[Timing], ...] = key("Times and rates of the device as a whole.", least=0, default=())
    measurement: Located[Measurement] | None = key("", default=None)
    supply: Located[Supply] | None = key("", default=None)
    inputs: tuple[Located[Input], ...] = key(
        "Hardware inputs that act on the position, and their interaction with register bits.", least=0, default=()
    )
    tables: tuple[Located[Table], ...] = key(
        "Tables of the manual that are only displayed, never used in computations: speeds, lengths, signals.",
        least=0,
        default=(),
    )
    connectors: tuple[Located[Connector], ...] = key("Connectors and cables, contact by contact.", least=0, default=())
    leds: tuple[Located[Led], ...] = key("Diagnostic LEDs and the meaning of each state.", least=0, default=())
    characteristics: tuple[Located[Characteristic], ...] = key(
        "Facts of the manual that are only displayed, never used in computations: supply, batteries, "
        "analogue outputs, cables, mounting.",
        least=0,
        default=(),
    )
    examples: tuple[WrittenExample, ...] = key(
        "Worked examples from the manual or a public source. Each becomes a test of every output.", least=0, default=()
    )
    errata: tuple[WrittenErratum, ...] = key(
        "Errors, contradictions and omissions in the manual, and the facts that the spec uses instead.",
        least=0,
        default=(),
    )
    editions: tuple[WrittenManualEdition, ...] = key(
        "Changes that each revision of the manual made. They describe the encoders of other editions: "
        "editions before the one that this file transcribes, and later ones as far as they are public.",
        least=0,
        default=(),
    )
