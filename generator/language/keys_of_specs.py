"""Keys of a spec and of its parts, as far as their written form differs from the model.

The JSON Schema follows from these classes (see ``schemas.py``), and rules read them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from ..model.facts import (
    Alarm,
    Characteristic,
    Connector,
    Input,
    Led,
    Supply,
    Table,
    Timing,
)
from ..model.fields import Crc
from ..model.manual import Edition, EditionTest, Evidence, LostFigure, Revision, Write
from ..model.measurement import Measurement
from ..model.part import (
    NOTHING,
    PATTERNS,
    Anything,
    Count,
    CrcNumber,
    Date,
    DateOrYear,
    FactPath,
    Heading,
    Headline,
    HexBytes,
    InterfaceName,
    Language,
    LanguageVersion,
    Name,
    PageOfEntry,
    Pages,
    Place,
    Places,
    PrintedWrite,
    Prose,
    Scalar,
    SignedNumber,
    SourceText,
    Url,
    key,
    note_key,
)
from .keys_of_fields import WrittenFieldGroup, WrittenPrintedDefault, WrittenRegister
from .keys_of_order_codes import WrittenAlternative, WrittenInterfaces, WrittenOrderCode, WrittenParameter
from .written import LocatedPart, WrittenPart, written


@written("One value.")
class WrittenArgument(WrittenPart):
    name: Name = key("Name of the value.")
    of: Name = key("Register to which the value is written. The limits of the register apply.")
    as_: Name = key("For a register with several meanings: the meaning whose limits apply.", default="")
    meaning: Prose = key("Meaning of the value.", default="")


@written("One step.")
class WrittenStep(WrittenPart):
    do: Literal["write", "read", "poll", "wait", "send"] = key(
        "Kind of step: write a register, read a register, poll a register bit, wait, or send a request."
    )
    register: Name = key("write, read, poll: name of the register.", default="", needed_by=("write", "read", "poll"))
    value: Name = key(
        "write: a named value of the register, or an argument of the procedure.", default="", needed_by=("write",)
    )
    field: Name = key(
        "write: the only field to set. Other fields keep the value that was read. poll: the field to check.",
        default="",
        needed_by=("poll",),
        allowed_in=("write", "read"),
    )
    until: Count | None = key("poll: the value to wait for.", default=None, needed_by=("poll",))
    at_least_ms: int | None = key(
        "wait: minimum time in milliseconds.", minimum=1, maximum=3600000, default=None, needed_by=("wait",)
    )
    data_id: Name = key("send: name of the data ID of the request.", default="", needed_by=("send",))
    times: int | None = key(
        "send: number of times to send the request.", minimum=1, maximum=1000, default=None, allowed_in=("send",)
    )
    every_at_least_us: int | None = key(
        "send: minimum time from one request to the next, in microseconds.",
        minimum=1,
        maximum=10000000,
        default=None,
        allowed_in=("send",),
    )
    in_succession: bool = key(
        "send: true if no other request, not even a poll, may be sent between the repetitions.",
        default=False,
        allowed_in=("send",),
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
        "Writes as the manual prints them, in order. 'check' compares them with the steps. Write 0x48 = "
        "0x01 for a byte, 0x49 bit 2 = 0 for a single bit, and only the addresses, such as 0x50-0x54, "
        "for a value supplied by the caller.",
        default=(),
    )
    result: Prose = key("State after the procedure.", default="")
    note: Prose = note_key(default="")
    source: SourceText = key("")


@written("A worked example.")
class WrittenExample(WrittenPart):
    name: Name = key("Name of the example, used in the names of the tests.")
    kind: Literal["frame", "register", "crc", "procedure", "measure"] = key(
        "Kind of example. Frame: bits or bytes, and field values. Register: bytes, and field values. "
        "CRC: bytes, and the check value. Procedure: arguments, and the resulting writes. Measured quantity: "
        "a position in counts, and the length of a count."
    )
    source: SourceText = key("")
    order_code: str = key(
        "Order code to which the example applies.",
        longest=100,
        default="",
        needed_by=("measure",),
        allowed_in=("frame", "register", "procedure"),
    )
    counts: Count | None = key("measure: the position in counts.", default=None, needed_by=("measure",))
    micrometres: Count | None = key("measure: the position in micrometres.", default=None, needed_by=("measure",))
    alternatives: Mapping[Name, Name] = key(
        "frame: chosen answers, each under the name of its alternative. Default: the first answer of each.",
        default=NOTHING,
        allowed_in=("frame",),
    )
    layout: Name = key(
        "frame: name of the layout. If the example fits no layout, omit this key and give 'refused'.",
        default="",
        allowed_in=("frame",),
    )
    register: Name = key("register: name of the register.", default="", needed_by=("register",))
    procedure: Name = key("procedure: name of the procedure.", default="", needed_by=("procedure",))
    crc: Name = key("crc: name of the CRC.", default="", needed_by=("crc",))
    from_: Literal["", "encoder", "master"] = key("frame: sender.", default="", allowed_in=("frame",))
    bytes: HexBytes = key("Bytes of the example.", default="", needed_by=("register", "crc"), allowed_in=("frame",))
    bits: str = key(
        "Bits in order of transmission.", pattern=r"^[01]+$", longest=200, default="", allowed_in=("frame",)
    )
    check: CrcNumber | None = key("crc: check value over the bytes.", default=None, needed_by=("crc",))
    arguments: Mapping[Name, SignedNumber] = key(
        "procedure: arguments by name. They may be negative for a signed register.",
        least=0,
        default=NOTHING,
        allowed_in=("procedure",),
    )
    values: Mapping[Name, Scalar] = key(
        "Expected values of fields, joins or groups of digits, by name.",
        least=0,
        default=NOTHING,
        needed_by=("register",),
        allowed_in=("frame",),
    )
    writes: tuple[LocatedPart[Write], ...] = key(
        "procedure: resulting writes, in order.", least=0, default=(), needed_by=("procedure",)
    )
    refused: Literal["", "crc", "constant", "length", "range"] = key(
        "frame: error for which a decoder rejects the frame.", default="", allowed_in=("frame",)
    )
    erratum: Name = key("Erratum that explains an incorrect example.", default="")
    note: Prose = note_key(default="")


@written("")
class WrittenReading(WrittenPart):
    second: Prose = key("The value in the second reading.")
    used: Prose = key("The value in the spec.")


@written("A passage of the manual that must not be followed literally.")
class WrittenErratum(WrittenPart):
    name: Name = key("Name of the erratum.")
    title: Headline = key(
        "Sentence without a full stop that says what is wrong in the manual, as in 'The cable table is "
        "headed G1 instead of BG1'. Outputs show this text instead of the name."
    )
    source: SourceText = key("")
    printed: Prose = key(
        "Printed text, as short as possible. Text in double quotation marks is quoted to the letter, "
        "the rest is a summary."
    )
    used: Prose = key("Fact that the spec uses in place of the printed text.")
    why: Prose = key("Evidence for this choice.")
    only: Prose = key("Order codes to which the erratum applies, as in .../65K...:", writing=PATTERNS, default="")
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
        "and the second reading use different values.",
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
    editions: tuple[LocatedPart[Edition], ...] = key(
        "Other language editions that were also read. A source cites such an edition by its language code.",
        least=0,
        default=(),
    )
    contents: Mapping[Heading, WrittenSection] = key(
        "Contents of the manual: sections by number, or by title if they have none, with the pages on "
        "which they begin. 'check' compares cited sections and pages with them.",
        default=NOTHING,
    )
    history: tuple[LocatedPart[Revision], ...] = key("Revision table, oldest first.", least=0, default=())


@written("A public document.")
class WrittenDocument(WrittenPart):
    title: Prose = key("Title, revision and publisher.")
    url: Url = key("Web address of the document.", default="")
    pages: Pages = key(
        "Pages that this file cites, such as 'p.9-14 and 18'. check reports a source on another page.", default=""
    )


@written("One difference from the spec. It has exactly one of the keys set, add, remove, unknown and also.")
class WrittenChange(WrittenPart):
    set: Places = key("Location or locations whose value changes.", default=())
    to: Anything | None = key("With set: new value.", default=None)
    add: Place = key("A list to which an item is added, or a new key.", default="")
    value: Anything | None = key("With add: new item or value.", default=None)
    remove: Places = key("Location or locations to remove.", default=())
    unknown: Places = key(
        "Locations whose content is unknown. They are removed, and outputs state that they are unknown.",
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
    revision: Prose = key("Revision as printed. It is in the manual's history, or later than the manual's revision.")
    date: Date = key("Date of a later revision, year-month-day.", default="")
    before: tuple[WrittenChange, ...] = key(
        "Changes that lead from the edition of this revision back to the edition before it.", most=100, default=()
    )
    then: tuple[WrittenChange, ...] = key(
        "For a revision later than the manual's: changes that apply from the later one on.", most=100, default=()
    )
    labels: tuple[Prose, ...] = key("Patterns from also_written that identify labels of this edition.", default=())
    tests: tuple[LocatedPart[EditionTest], ...] = key(
        "Registers that identify an encoder of an earlier edition.", default=()
    )


@written(
    "One manual, transcribed: order codes, interfaces, layouts, registers, procedures, examples "
    "and errata of one encoder family."
)
class WrittenSpec(WrittenPart):
    def __init__(self, data: Any, with_invalid_parts: WrittenSpec | None = None) -> None:
        super().__init__(data)
        self._with_invalid_parts = with_invalid_parts

    @property
    def with_invalid_parts(self) -> WrittenSpec:
        """The same spec together with its invalid parts, which rules must not check. By default, it is this spec.

        Rules look up names in it, because a name is still defined if something else about its part is wrong.
        """
        return self if self._with_invalid_parts is None else self._with_invalid_parts

    codewheel: LanguageVersion = key(
        "Version of the spec language, which is 1 since the first release. codewheel migrate updates older specs."
    )
    device: Name = key("Name of the family, the same as the file's stem. Generated modules and prefixes use it.")
    manufacturer: Name = key(
        "Short name of the manufacturer, as given by the key 'manufacturer' in its own file, for example lika."
    )
    title: Prose = key("Name of the family, as used in running text.")
    movement: Literal["rotary", "linear"] = key("Kind of movement: rotary for an angle, linear for a length.")
    evidence: LocatedPart[Evidence] = key("")
    manual: WrittenManual = key("")
    documents: Mapping[Name, WrittenDocument] = key(
        "Public documents other than the manual, each under a short key. A source that begins with the "
        "key and a colon cites that document.",
        least=0,
        default=NOTHING,
    )
    lost_figures: tuple[LocatedPart[LostFigure], ...] = key(
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
    crcs: tuple[LocatedPart[Crc], ...] = key("Cyclic redundancy checks that layouts refer to.", least=0, default=())
    field_groups: tuple[WrittenFieldGroup, ...] = key(
        "Sequences of fields that several layouts share. A layout includes one with 'use'.", least=0, default=()
    )
    interfaces: WrittenInterfaces = key("")
    registers: tuple[WrittenRegister, ...] = key("Registers, in the order of the manual.", least=0, default=())
    alarms: tuple[LocatedPart[Alarm], ...] = key(
        "Error and warning flags: their meanings, whether they latch, and how to clear them.", least=0, default=()
    )
    procedures: tuple[WrittenProcedure, ...] = key(
        "Sequences of register writes, requests and waits that the manual prescribes.", least=0, default=()
    )
    printed_defaults: tuple[WrittenPrintedDefault, ...] = key(
        "The manual's own list of defaults, row by row. 'check' compares it with the registers.", least=0, default=()
    )
    alternatives: tuple[WrittenAlternative, ...] = key(
        "Questions that the manual leaves open, or that other evidence answers differently. The user "
        "must decide. Generated code takes the decision as an argument without a default.",
        least=0,
        default=(),
    )
    timings: tuple[LocatedPart[Timing], ...] = key("Times and rates of the device as a whole.", least=0, default=())
    measurement: LocatedPart[Measurement] | None = key("", default=None)
    supply: LocatedPart[Supply] | None = key("", default=None)
    inputs: tuple[LocatedPart[Input], ...] = key(
        "Hardware inputs that act on the position, and their interaction with register bits.", least=0, default=()
    )
    tables: tuple[LocatedPart[Table], ...] = key(
        "Tables of the manual that are only displayed, never used in computations: speeds, lengths, signals.",
        least=0,
        default=(),
    )
    connectors: tuple[LocatedPart[Connector], ...] = key(
        "Connectors and cables, contact by contact.", least=0, default=()
    )
    leds: tuple[LocatedPart[Led], ...] = key("Diagnostic LEDs and the meaning of each state.", least=0, default=())
    characteristics: tuple[LocatedPart[Characteristic], ...] = key(
        "Facts from the manual that are only displayed, never used in computations: supply, batteries, "
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
        "Changes that each revision of the manual made. They describe the encoders as documented in other editions: "
        "those before the edition transcribed in this file, and any later public ones.",
        least=0,
        default=(),
    )
