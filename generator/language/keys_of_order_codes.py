"""Keys of order codes in specs, and of what they select: parameters, interfaces, and answers of the user.

See ``keys_of_specs.py``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from ..model.facts import Supply, Timing
from ..model.interface_parts import CableLength, Clock, DataChannels, Timeout
from ..model.interfaces import DataId, MemoryAccess, Network, Port
from ..model.measurement import Measurement
from ..model.part import (
    NOTHING,
    CodeNumber,
    CodePattern,
    Count,
    Formula,
    InterfaceName,
    Label,
    Name,
    OneOrMore,
    ParameterValue,
    Prose,
    RegisterBit,
    SourceText,
    key,
    note_key,
)
from .keys_of_fields import WrittenField, WrittenLayout
from .written import LocatedPart, WrittenPart, written


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
        "For a parameter that the encoder holds in a register at run time: the register and its field, as "
        "in configuration.output_code. Until the register is read, the register's default applies. If the "
        "register has no default, every order code must set the parameter to match the configuration "
        "it represents.",
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
        "parameter for each code, as in {0: 0, 2: 8, 4: 16}. Other codes are rejected.",
        least=2,
        default=NOTHING,
    )
    source: SourceText = key("", default="")


@written("One value of a part.")
class WrittenCodeValue(WrittenPart):
    meaning: Prose = key("Meaning of this value.", default="")
    interface: InterfaceName | None = key("Interface that the value selects.", default=None)
    meaning_differs: Prose = key(
        "Reason why the printed meaning has numbers or words that differ from the parameters that the value "
        "sets. check then does not compare them.",
        default="",
    )
    sets: Mapping[Name, ParameterValue] = key("Parameters that the value sets.", least=0, default=NOTHING)
    only_with: Mapping[Name, tuple[str, ...]] = key(
        "Values of other parts that this value can be combined with. Default: all.", least=0, default=NOTHING
    )
    supply: LocatedPart[Supply] | None = key("", default=None)
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
        "Regular expression for values beyond those that the manual lists. Such values are accepted, shown "
        "as unlisted, and not counted. Only letters, digits, classes and repetition counts are allowed.",
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
        "given here accepts only these strings. Every other part accepts only the values listed for it.",
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
        "For made-up order codes: the text on the real label, and the meaning of the order code.", default=""
    )
    note: Prose = note_key(default="")
    parts: tuple[WrittenCodePart, ...] = key("Parts of the code, in the order of the pattern.")
    also_written: tuple[WrittenSpelling, ...] = key(
        "Alternative spellings on labels, such as spellings in another edition of the manual. These spellings are "
        "accepted, but not counted as order codes.",
        least=0,
        default=(),
    )


@written("One answer.")
class WrittenAnswer(WrittenPart):
    meaning: Prose = key("Meaning of the answer.")
    sets: Mapping[Name, Count] = key("Value of each parameter that this alternative sets.")
    source: SourceText = key("", default="")


@written("A question that the user must answer. An erratum that affects it gives the reason.")
class WrittenAlternative(WrittenPart):
    name: Name = key("Name of the decision.")
    meaning: Prose = key("Question to the user.")
    default: Name = key(
        "Answer that applies unless the user chooses another answer: the first, which sets the only "
        "parameter to 0. All other answers set it to 1. Only verdicts can depend on this parameter, with "
        "makes_position_if of a flag, so that every frame can be decoded without a choice. The default "
        "must be the safest reading, unless the manual clearly prefers another. Without a default, the "
        "user must decide.",
        default="",
    )
    values: Mapping[Name, WrittenAnswer] = key(
        "At least two answers, which all set the same parameters. If the user cannot be asked, as for "
        "the positions in show --json, the first answer applies.",
        least=2,
    )
    source: SourceText = key("")


_BY_CODE = (
    "If it differs between order codes, it is a list whose entries have 'only'. Each order code matches exactly one"
    " entry."
)
_CLOCK = (
    f"Clock frequencies. {_BY_CODE} For example: [{{max_hz: 700000, only: X-24..., source: '5'}}, {{max_hz: 1300000,"
    " only: X-32..., source: '5'}]."
)


@written("Synchronous serial interface.")
class WrittenSsi(WrittenPart):
    source: SourceText = key("")
    clock: OneOrMore[LocatedPart[Clock]] = key(_CLOCK)
    alignment: Literal["msb_left", "lsb_right"] = key(
        "Alignment of the word: left (MSB with the first clock, zeros after the word) or right (zeros before the word)."
    )
    alignment_source: SourceText = key(
        "Source for this encoder's alignment. Default: the source of the interface.", default=""
    )
    output_code: Literal["", "binary", "gray", "by_order_code"] = key(
        "Position encoding (binary or Gray), as stated in the manual for this interface. Decoders "
        "follow the key gray of a layout, and check compares the two.",
        default="",
    )
    output_code_source: SourceText = key(
        "Source for this encoder's code. Default: the source of the interface.", default=""
    )
    signals: Prose = key("Electrical standard of the signals.", default="")
    cable_lengths: tuple[LocatedPart[CableLength], ...] = key(
        "Highest clock frequency by cable length, as in [{shorter_than_m: 50, at_most_hz: 400000}, "
        "{shorter_than_m: 100, at_most_hz: 300000}]. A row that applies to some order codes has the key 'only'.",
        least=0,
        default=(),
    )
    measurement: LocatedPart[Measurement] | None = key("", default=None)
    timings: tuple[LocatedPart[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Layouts of the word.", most=256)
    note: Prose = note_key(default="")


@written(
    "Fields of the control frame that the manual describes. The fields are not a complete "
    "frame, so no layout is generated."
)
class WrittenControlData(WrittenPart):
    fields: tuple[WrittenField, ...] = key("Fields, in the order of the manual.", most=512)
    note: Prose = key("Information that the manual does not give.", default="")
    source: SourceText = key("")


@written("BiSS C-mode.")
class WrittenBiss(WrittenPart):
    source: SourceText = key("")
    clock: OneOrMore[LocatedPart[Clock]] = key(_CLOCK)
    signals: Prose = key("Electrical standard of the signals.", default="")
    description_file: str = key(
        "Name of the device description file that, according to the manual, is installed in the master.",
        pattern=r"^[A-Za-z0-9_.-]+$",
        longest=64,
        default="",
    )
    bank_select: Name = key("Register that selects the bank of the banked area.", default="")
    profile: Prose = key("Encoder profile that the manual names.", default="")
    network: LocatedPart[Network] | None = key("", default=None)
    timeout: OneOrMore[LocatedPart[Timeout]] = key(f"Timeout after a frame. {_BY_CODE}", default=())
    channels: LocatedPart[DataChannels] | None = key("", default=None)
    control_data: WrittenControlData | None = key("", default=None)
    measurement: LocatedPart[Measurement] | None = key("", default=None)
    timings: tuple[LocatedPart[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Layouts of the single cycle data.", most=256)
    note: Prose = note_key(default="")


@written("One request.")
class WrittenRs485Exchange(WrittenPart):
    request: Name = key("Layout that the master sends.")
    reply: Name = key(
        "Layout that the encoder sends in reply. Omit this key if the encoder does not answer.", default=""
    )
    purpose: Literal["position", "other"] = key("Effect of the request.")
    source: SourceText = key("", default="")


@written(
    "RS-485 with requests and replies. Give either data_ids or exchanges. data_ids: frames like "
    "those of Tamagawa's T-format, whose first byte is a control field with one of up to 32 data "
    "IDs. exchanges: any other requests with their replies, such as an address, a command and a "
    "checksum. So are requests and replies of MODBUS RTU, if each has a fixed length. EnDat, Nikon's A-format and "
    "register banks are not supported."
)
class WrittenRs485(WrittenPart):
    source: SourceText = key("")
    port: LocatedPart[Port] = key("")
    data_ids: tuple[LocatedPart[DataId], ...] = key(
        "Data IDs, each with the control field that the manual prints for it. Required unless there are exchanges.",
        default=(),
    )
    exchanges: tuple[WrittenRs485Exchange, ...] = key(
        "Requests with their replies, if they have no data IDs. The constants in a request "
        "distinguish it from other requests. Values that the reply repeats from the request, such as an "
        "address, are fields with the same name in both.",
        most=64,
        default=(),
    )
    memory_access: tuple[LocatedPart[MemoryAccess], ...] = key(
        "The encoder's replies to a memory access, depending on the busy flag.", least=0, default=()
    )
    measurement: LocatedPart[Measurement] | None = key("", default=None)
    timings: tuple[LocatedPart[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Requests and replies.", most=256)
    note: Prose = note_key(default="")


@written("One request.")
class WrittenSpiExchange(WrittenPart):
    request: Name = key("Layout that the master sends.")
    reply: Name = key("Layout that the encoder sends in reply.")
    purpose: Literal["position", "read", "write", "other"] = key(
        "Effect of the request. read: the field address of the request selects a register, and the field data of "
        "the reply contains the register's value. write: the fields address and data select a register and give "
        "its new value. If address and data are in two words, list the words in order. other: anything else."
    )
    word_bits: Formula | None = key(
        "Number of bits in the request and in its reply, 8 to 64. Default: word_bits of the interface.", default=None
    )
    source: SourceText = key("", default="")


@written(
    "SPI, where each word from the master can be a request, and each word from the encoder can be a reply. "
    "Every layout is word_bits wide, as set in its exchange or in the interface, and is sent most significant bit "
    "first. Each register has a single address, and its value is the field data of a frame. Chip select, and timings "
    "other than those listed, are not described."
)
class WrittenSpi(WrittenPart):
    source: SourceText = key("")
    mode: int = key(
        "SPI mode: in modes 0 and 1 the clock idles low, in modes 2 and 3 it idles high. Modes 0 and 2 sample data "
        "on the first edge, modes 1 and 3 on the second.",
        minimum=0,
        maximum=3,
    )
    word_bits: Formula = key(
        "Bits in a word, during which the chip select stays active: 8 to 64. An exchange can have its own value."
    )
    reply: Literal["same_word", "next_word"] = key(
        "Word in which the encoder answers a request: the same word, or the next word."
    )
    clock: OneOrMore[LocatedPart[Clock]] = key(_CLOCK)
    exchanges: tuple[WrittenSpiExchange, ...] = key(
        "Requests with their replies. Omit this key if the encoder ignores the words that the master sends. "
        "The encoder then has a single layout.",
        most=64,
        default=(),
    )
    measurement: LocatedPart[Measurement] | None = key("", default=None)
    timings: tuple[LocatedPart[Timing], ...] = key("Timings of this interface.", least=0, default=())
    layouts: tuple[WrittenLayout, ...] = key("Requests and replies.", most=64)
    note: Prose = note_key(default="")


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
