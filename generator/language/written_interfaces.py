"""Interfaces with their layouts and requests, as they are written in specs. See ``written_parts.py``."""

from __future__ import annotations

from typing import Literal

from ..model.facts import (
    Timing,
)
from ..model.interface_parts import CableLength, Clock, DataChannels, Timeout
from ..model.interfaces import (
    DataId,
    MemoryAccess,
    Network,
    Port,
)
from ..model.measurement import Measurement
from ..model.part import (
    Formula,
    Name,
    OneOrMore,
    Prose,
    SourceText,
    key,
    note_key,
)
from .written import LocatedPart, WrittenPart, written
from .written_layouts import (
    WrittenField,
    WrittenLayout,
)

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
