"""Members of interfaces and of their settings."""

from __future__ import annotations

from ..clocks import CableLength, Clock, PrintedTimeout, Timeout
from ..data_channels import DataChannels
from ..facts import Supply
from ..interfaces import (
    DataId,
    MemoryAccess,
    Network,
    Port,
)
from .member import MEANING, NAME, NAMES, NOTE, PRINTED_NAME, ModelMember, ModelPart, described_part

INTERFACES = (
    described_part(Clock),
    described_part(Supply),
    described_part(CableLength),
    described_part(Network),
    described_part(PrintedTimeout),
    described_part(Timeout),
    described_part(DataChannels),
    ModelPart(
        "control_field",
        "A field of the BiSS control frame. The manual gives no complete layout of that frame.",
        NAME,
        PRINTED_NAME,
        NAMES,
        ModelMember("bits", "integer", "Width in bits.", "field-width"),
        ModelMember("values", "[value]", "Named values."),
        ModelMember(
            "crc",
            "name",
            "Name of the CRC that the field holds.",
            "field-reads-otherwise",
            "CRC",
            refers_to="crc",
        ),
        MEANING,
        identity="bits crc values",
    ),
    described_part(Port),
    described_part(DataId),
    described_part(MemoryAccess),
    ModelPart(
        "exchange",
        "A request over SPI or RS-485, and the frame that answers it.",
        ModelMember("request", "name", "Frame that the master sends."),
        ModelMember(
            "word_bits",
            "expression?",
            "Number of bits in the request and in its reply over SPI. null if the interface's word_bits applies.",
        ),
        ModelMember("reply", "name", "Frame with which the encoder answers. Empty if it does not answer."),
        ModelMember("purpose", "name", "Effect of the request."),
    ),
    ModelPart(
        "interface",
        "One interface. Members that do not apply to its kind are empty or null.",
        ModelMember("kind", "ssi|biss|rs485|spi", "Short name."),
        ModelMember("title", "string", "Name of the interface.", "words"),
        ModelMember("layouts", "[name]", "Names of the layouts."),
        NOTE,
        ModelMember("clock", "clock?", "Clock frequencies. null if they depend on the order code."),
        ModelMember(
            "clocks",
            "[clock]",
            "Clock frequencies, each with its order codes. Empty if they do not depend on the order code.",
            of="clocks_by_code",
        ),
        ModelMember("signals", "string", "Electrical standard.", "interface-rule"),
        ModelMember(
            "alignment",
            "name",
            "Alignment of the word: the end that is sent with the first clock.",
            "alignment",
            form="word",
            read="position",
            noun="alignment of the word",
        ),
        ModelMember("alignment_source", "source?", "Source of the alignment. null if there is no alignment."),
        ModelMember(
            "output_code",
            "name",
            "Position encoding.",
            "alignment",
            "code",
            form="word",
            read="setting",
            noun="output code",
        ),
        ModelMember("output_code_source", "source?", "Source of the output code. null if there is no output code."),
        ModelMember(
            "cable_lengths",
            "[cable_length]",
            "Highest clock frequency by cable length.",
            "cable-length",
            "clock by cable",
        ),
        ModelMember("profile", "string", "Encoder profile that the manual names.", "interface-rule"),
        ModelMember("network", "network?", "Permitted connections of the encoder.", "interface-rule"),
        ModelMember(
            "timeout",
            "timeout?",
            "Timeout after a frame. null if it depends on the order code.",
        ),
        ModelMember(
            "timeouts",
            "[timeout]",
            "Timeouts after a frame, each with its order codes. Empty if they do not depend on the order code.",
            of="timeouts_by_code",
        ),
        ModelMember("channels", "data_channels?", "Data channels in one frame. null if each is received alone."),
        ModelMember("control_data", "[control_field]", "Fields of the BiSS control frame."),
        ModelMember(
            "control_data_note", "text", "Information about these fields that the manual does not give.", "words"
        ),
        ModelMember(
            "measurement",
            "measurement?",
            "Unit and range of the position for this interface. null if they are the same as for the device.",
        ),
        ModelMember(
            "description_file",
            "string",
            "Description file of the encoder for a master.",
            "interface-rule",
            read="printed name",
        ),
        ModelMember(
            "bank_select",
            "name",
            "Register that selects the bank.",
            "bank-select",
            "bank selected by",
            refers_to="register",
            read="address",
            noun="register that selects the bank",
        ),
        ModelMember("port", "port?", "Settings of the serial port."),
        ModelMember("data_ids", "[data_id]", "Data IDs of requests and replies."),
        ModelMember("mode", "integer?", "SPI mode.", "interface-rule", "SPI mode", read="setting"),
        ModelMember(
            "word_bits", "expression?", "Bits of an SPI word.", "interface-rule", "word length", read="setting"
        ),
        ModelMember("reply", "name", "SPI word that answers a request.", "interface-rule", form="word", read="setting"),
        ModelMember("exchanges", "[exchange]", "Requests over SPI or RS-485 with their replies.", "interface-rule"),
        ModelMember("memory_access", "[memory_access]", "Replies to a memory access.", "interface-rule"),
        ModelMember("timings"),
        # By their names in the model. They are compared by order code.
        ModelMember("clocks"),
        ModelMember("timeouts"),
        of="Ssi Biss Rs485 Spi",
    ),
)
