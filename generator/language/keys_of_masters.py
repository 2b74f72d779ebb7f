"""Keys of descriptions of masters, as far as rules read them, and the names that these can use.

``master.schema.json`` describes the keys. A test compares them with these classes. The names are those of the items of
a record, which describes an encoder for a master, of data types, and of file formats.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..model.kinds import DIGIT_CODES
from ..model.part import NOTHING, Anything, Formula, Name, NumberOrText, Phrase, Prose, key
from .written import WrittenPart, written


@written("A device of a master with several.")
class WrittenMasterDevice(WrittenPart):
    name: Phrase = key("Name.")
    channels: tuple[Phrase, ...] | None = key("Names of the device's channels, if it has several.", default=None)


@written("A condition on an item of the record, or a limit of it.")
class WrittenCondition(WrittenPart):
    item: Name = key("Item.")
    is_: tuple[NumberOrText, ...] | None = key("Possible words.", default=None)
    at_least: int | None = key("Lowest number.", default=None)
    at_most: int | None = key("Highest number.", default=None)


@written("A place of a setting. Each channel can have its own number or text.")
class WrittenPlace(WrittenPart):
    on: tuple[Phrase, ...] | None = key("Devices.", default=None)
    index: Anything | None = key("Index of the object.", default=None)
    subindex: Anything | None = key("Subindex of the object.", default=None)
    symbol: Anything | None = key("Symbol.", default=None)
    at: NumberOrText | None = key("Bits in the object.", default=None)
    type: Phrase = key("Type of data.")
    min: int | None = key("Lowest number.", default=None)
    max: int | None = key("Highest number.", default=None)


@written("A case of a choice.")
class WrittenCase(WrittenPart):
    is_: NumberOrText = key("Value of the item.")


@written("A number for each value of an item.")
class WrittenChoice(WrittenPart):
    of: Name = key("Item.")
    cases: tuple[WrittenCase, ...] = key("Cases.")


@written("A clock in hertz.")
class WrittenAnyClock(WrittenPart):
    at_least_hz: int | None = key("Lowest clock.", default=None)
    at_most_hz: int | None = key("Highest clock.", default=None)


@written("A field of a text.")
class WrittenMasterField(WrittenPart):
    of: Name = key("Kind of field.")
    text: Phrase = key("Text.")


@written("A text composed of the fields of a frame.")
class WrittenString(WrittenPart):
    start: Phrase = key("Start of the text.", default="")
    fields: tuple[WrittenMasterField, ...] = key("Fields.")


@written("A setting.")
class WrittenSetting(WrittenPart):
    name: Phrase = key("Name.")
    at: Phrase = key("Place in words.", default="")
    value: Formula | None = key("Number.", default=None)
    as_: Phrase = key("Type of the value.", default="")
    bound: Phrase = key("Kind of limit.", default="")
    choice: WrittenChoice | None = key("", default=None)
    any_clock: WrittenAnyClock | None = key("", default=None)
    text: Prose = key("Text.", default="")
    string: WrittenString | None = key("", default=None)


@written("A condition of writing settings.")
class WrittenWriting(WrittenPart):
    of: tuple[Phrase, ...] = key("Settings that are written later.", default=())
    after: tuple[Phrase, ...] = key("Settings that are written first.", default=())


@written("A file that the tool of the master loads.")
class WrittenMasterFile(WrittenPart):
    format: Name = key("Format.")
    on: tuple[Phrase, ...] = key("Devices.", default=())
    names: Mapping[Phrase, Phrase] = key("Names of settings in the file.", default=NOTHING)
    words: Mapping[Phrase, Anything] = key("Words for the values of settings.", default=NOTHING)
    line: Phrase = key("Form of a line.", default="")


@written("A note.")
class WrittenMasterNote(WrittenPart):
    text: Prose = key("Text.")


@written("A master.")
class WrittenMaster(WrittenPart):
    master: Name = key("Name, the same as that of the file.")
    title: Phrase = key("Title.")
    documents: Mapping[Name, Anything] = key("Documents by their key.")
    devices: tuple[WrittenMasterDevice, ...] = key("Devices, if there are several.", default=())
    settings: tuple[WrittenSetting, ...] = key("Settings.", default=())
    writing: tuple[WrittenWriting, ...] = key("Conditions of writing settings.", default=())
    notes: tuple[WrittenMasterNote, ...] = key("Notes.", default=())
    files: tuple[WrittenMasterFile, ...] = key("Files that the master's tool loads.", default=())


#: Items that are words: the meaning of each value. Names of numbers in braces are replaced by the numbers.
WORDS: Mapping[str, Mapping[str, str]] = {
    "interface": {"biss": "BiSS C-mode", "ssi": "SSI"},
    "movement": {"rotary": "rotary", "linear": "linear"},
    "coding": {
        "binary": "binary code",
        "gray": "Gray code",
        "gray_with_status": "Gray code over the position and the status bits",
        "gray_excess": "Gray excess code",
        **{name: code.name for name, code in DIGIT_CODES.items()},
        "other": "Gray code over other bits than the position",
    },
    "status_active": {
        "low": "status bits that are active low",
        "high": "status bits that are active high",
        "mixed": "status bits of both active levels",
        "none": "no status bits",
    },
    "parity": {"none": "no parity bit", "even": "even parity", "odd": "odd parity"},
    "singleturn_codes": {
        "all": "every value of the singleturn bits within a revolution",
        "some": "{counts_per_turn} counts per revolution in {singleturn_bits} singleturn bits",
        "unknown": "an unknown number of counts per revolution",
        "none": "no revolutions",
    },
}

#: Descriptions of the items that are whole numbers, or None if the manual does not say.
NUMBERS: Mapping[str, str] = {
    "multiturn_bits": "multiturn bits",
    "singleturn_bits": "singleturn bits, or all position bits of a linear encoder",
    "position_bits": "position bits, multiturn and singleturn",
    "padding_left": "zero bits before the position",
    "padding_right": "zero bits between position and status",
    "data_bits": "data bits: position and padding",
    "status_bits": "status bits after the data",
    "data_and_status_bits": "data bits and status bits",
    "crc_bits": "CRC bits",
    "other_bits_left": "other bits before the position",
    "other_bits_right": "other bits after the position",
    "other_bits_after_status": "other bits after the first status bit",
    "parity_bits": "1 if a parity bit over the whole frame is its last bit",
    "bits_without_crc": "all bits of the frame, without CRC and parity bit",
    "frame_bits": "all bits of the frame, without the parity bit",
    "crc_polynomial": "CRC polynomial with its top bit, or 0 without a CRC",
    "crc_polynomial_without_top_bit": "CRC polynomial without its top bit",
    "crc_polynomial_without_last_1": "CRC polynomial without its trailing 1 (Koopman notation)",
    "crc_start": "start value of the CRC",
    "crc_inverted": "1 if the CRC is sent inverted",
    "clock_min_hz": "slowest clock of the encoder, in Hz",
    "clock_max_hz": "fastest clock of the encoder, in Hz",
    "timeout_us": "longest timeout of the encoder, in µs, BiSS",
    "busy_us": "longest processing time before the start bit, in µs, BiSS",
    "pause_us": "shortest pause between two readings, in µs, SSI",
    "counts_per_turn": "counts per revolution",
    "turns": "distinguishable revolutions",
    "step_um": "length of one count, in µm",
    "step_pm": "length of one count, in pm",
    "supply_min_mv": "lowest supply voltage of the encoder, in mV",
    "supply_max_mv": "highest supply voltage of the encoder, in mV",
}

#: Lengths of a count, each with its unit. A count is not a whole number of each.
STEPS: Mapping[str, str] = {"step_um": "µm", "step_pm": "pm"}

#: Kind and width in bits of each data type that a master's document names. For some, the width is not given.
TYPES: Mapping[str, tuple[str, int | None]] = {
    **dict.fromkeys(("BOOLEAN", "BOOL", "bool"), ("boolean", 1)),
    **dict.fromkeys(("UINT8", "USINT", "Unsigned8", "uint8_t"), ("unsigned", 8)),
    **dict.fromkeys(("UINT16", "UINT", "Unsigned16", "uint16_t", "u16"), ("unsigned", 16)),
    **dict.fromkeys(("UINT32", "UDINT", "uint32_t", "u32"), ("unsigned", 32)),
    **dict.fromkeys(("UINT64",), ("unsigned", 64)),
    **dict.fromkeys(("INT64",), ("signed", 64)),
    **dict.fromkeys(("int32_t",), ("signed", 32)),
    "bits": ("unsigned", None),
    "signed_number": ("signed", None),
    "float": ("float", None),
    "text": ("text", None),
}

#: Kinds of place that a file format can write, with the members of such a place.
PLACE_KINDS: Mapping[str, str] = {
    "object": "index, subindex and a width in whole bytes",
    "symbol": "symbol",
    "bits": "register or address, with the bits",
    "name": "name in the file",
}


@dataclass(frozen=True, slots=True)
class FileFormat:
    """A file that a tool loads.

    Attributes:
        title: The tool, in running text.
        suffix: Suffix of the file, with its dot.
        comment: Beginning of a comment line, or ``<!--`` in XML.
        kind_of_place: Kind of place that the format can write, a key of ``PLACE_KINDS``.
        reader: Program of the tool that has been seen to read such files, or empty if none is public.
        highest_number: Highest number that the reader accepts, or None.
    """

    title: str
    suffix: str
    comment: str
    kind_of_place: str
    reader: str
    highest_number: int | None = None


_XML = "<!--"
#: The file formats by name. Each has a template of the same name.
FILE_FORMATS: Mapping[str, FileFormat] = {
    "ethercat_driver_ros2": FileFormat(
        "ethercat_driver_ros2, as the key sdo of a slave", ".yaml", "#", "object", "ec_sdo_manager.hpp", (1 << 31) - 1
    ),
    "linuxcnc_ethercat": FileFormat(
        "linuxcnc-ethercat, inside a slave of type generic", ".xml", _XML, "object", "lcec_conf.c"
    ),
    "ecmc": FileFormat(
        "ecmc, as commands for the slave ECMC_EC_SLAVE_NUM", ".cmd", "#-", "object", "the scripts of ecmccomp"
    ),
    "twincat": FileFormat("TwinCAT, as a start-up list for ITcSmTreeItem.ConsumeXml", ".xml", _XML, "object", ""),
    "fastcat": FileFormat("fastcat, as an entry of its device list", ".yaml", "#", "name", "el5042.cc"),
    "conf_set": FileFormat("the configuration tool, as conf set commands", ".cfg", "#", "symbol", "aux_common.h"),
    "hal": FileFormat("the HAL, as loadrt and setp commands", ".hal", "#", "symbol", "abs_encoder.c"),
    "xcf": FileFormat("the configuration tool, as an XCF file", ".xcf", _XML, "symbol", "ingenialink"),
    "c_struct": FileFormat("C, as structure initialisers", ".h", "//", "symbol", ""),
    "c_registers": FileFormat("C, as register values and masks", ".h", "//", "bits", ""),
    "soe_structure": FileFormat("a servo drive parameter, as fields of its structure", ".csv", "#", "bits", ""),
    "dmc": FileFormat("DMC, as a command line", ".dmc", "REM", "name", ""),
}
