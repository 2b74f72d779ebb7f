"""Registers, parameters and order codes, as they are written in specs. See ``written_parts.py``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from ..model.facts import (
    Supply,
)
from ..model.part import (
    NOTHING,
    AddressRange,
    BitRange,
    CodeNumber,
    CodePattern,
    Count,
    Formula,
    HexBytes,
    InterfaceName,
    Joins,
    Label,
    Name,
    Names,
    OtherBits,
    ParameterValue,
    Prose,
    RegisterBit,
    SourceText,
    key,
    note_key,
    printed_name_key,
)
from .written import LocatedPart, WrittenPart, written
from .written_layouts import (
    WrittenField,
)


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
