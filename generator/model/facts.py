"""Facts that outputs only display, and the worked examples of the manual, which test every output."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

from .part import (
    BY_HAND,
    NOTHING,
    STEPS,
    Cells,
    Count,
    Date,
    Hex,
    InterfaceName,
    Language,
    Name,
    Names,
    Phrase,
    Prose,
    RegisterBit,
    Unit,
    fact,
    key,
    meaning_key,
    name_key,
    names_key,
    note_key,
    only_key,
    part,
    printed_name_key,
    source_key,
)
from .record import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """Place in a document that states a fact.

    ``document`` is empty for the manual itself, a language code for another edition, or a key of ``documents``.
    """

    document: str
    section: str
    page: int | None

    def __str__(self) -> str:
        parts = (
            f"{self.document}:" if self.document else "",
            self.section,
            "" if self.page is None else f"p.{self.page}",
        )
        return " ".join(part for part in parts if part)


Sources = tuple[Source, ...]


def cite(sources: Sources) -> str:
    """Return the sources as one short text, such as ``6.4 p.35, it: 6.4 p.36``."""
    return ", ".join(map(str, own_first(sources)))


def own_first(sources: Sources) -> Sources:
    """Return the sources with those in the manual itself first, so that they do not seem to be in a named document."""
    return tuple(sorted(sources, key=lambda source: source.document != ""))


@dataclass(frozen=True, slots=True)
class Document:
    key: str
    title: str
    url: str = ""


@part(
    "Evidence for the facts in this file. Every output states its grade.",
    data="Evidence for the facts of a family.",
    is_sourced=False,
)
class Evidence:
    """Evidence for the facts of a family.

    ``documents`` has the pages that were read, by document. The others name implementations that agree, examples from
    real hardware, and facts that are left out. ``placeholders`` names values that are still the template's.
    """

    grade: Literal["manual", "quoted", "corroborated", "corroborated, no hardware frame seen", "uncorroborated"] = key(
        "Grade of the evidence.",
        writing="Manual: the manufacturer's document was read as a whole. Quoted: every fact is in the "
        "manufacturer's words, an independent implementation agrees, and a vector of real hardware "
        "passes. Corroborated: each fact is in the manufacturer's words or in two implementations that "
        "share no code, and such a vector passes. Corroborated, no hardware frame seen: the same "
        "without such a vector. Uncorroborated: less than that.",
        rule="evidence",
        shape="string",
    )
    documents: Mapping[Name, Phrase] = key(
        "Documents of the manufacturer, or texts that quote them, with the pages that were read: "
        "'manual', a language code of another edition, or a key of 'documents'. Write 'all pages' for "
        "a document that was read as a whole.",
        data="Pages that were read, by document.",
        default=NOTHING,
        rule="evidence",
    )
    implementations: tuple[Name, ...] = key(
        "Implementations that agree, as keys of 'documents'. Implementations that share code count as "
        "one: list only one of them.",
        data="Keys of the implementations that agree.",
        default=(),
        rule="evidence",
    )
    vectors: tuple[Name, ...] = key(
        "Examples that come from real hardware, or from a document of the manufacturer.",
        data="Examples from real hardware or from the manufacturer.",
        default=(),
        rule="evidence",
    )
    left_out: tuple[Prose, ...] = key(
        "Facts that no source states, or that the spec language cannot express.",
        data="Facts that are left out.",
        default=(),
        rule="evidence",
    )
    placeholders: tuple[Prose, ...] = fact(
        "Values that are still those of the template, by name.", default=(), rule="evidence"
    )


@part("", data="Another language edition.", is_sourced=False)
class Edition:
    language: Language = key("Language code of the edition.", data="Language code.")
    title: Phrase = key("Title as printed.", default="")
    revision: Phrase = key("Revision as printed.")
    date: Date = key("Release date.", default="", read="history")


@part("", data="A row of the revision table.", is_sourced=False)
class Revision:
    revision: Phrase = key("Revision as printed.")
    date: Date = key("Release date.", default="", read="history")
    changes: Prose = key("Summary of the changes, in our words.", data="Summary of the changes.")
    hardware: Phrase = key(
        "Hardware release, if the table gives one.", data="Hardware release.", default="", read="history"
    )
    software: Phrase = key(
        "Software release, if the table gives one.", data="Software release.", default="", read="history"
    )


@dataclass(frozen=True, slots=True)
class Manual:
    title: str
    revision: str
    date: str
    language: str
    publisher: str
    editions: tuple[Edition, ...]
    history: tuple[Revision, ...]


@part("A figure that was not available.")
class LostFigure:
    source: Sources = source_key()
    content: Prose = key("Content of the figure, and how the spec manages without it.")


@part(
    "A time, given by its bounds in microseconds.",
    data="A time, given by its bounds.",
    identity="at_least_us typical_us at_most_us",
)
class Timing:
    name: Name = name_key("Name of the timing.")
    symbol: Phrase = key("Symbol in the manual.", default="", rule="timing-typical")
    meaning: Prose = key("Meaning of the time.", rule="words")
    at_least_us: Count | None = key("Lower bound in microseconds.", default=None, rule="wait-longer", label="at least")
    typical_us: Count | None = key(
        "Typical value in microseconds.", default=None, rule="timing-typical", label="typically"
    )
    at_most_us: Count | None = key("Upper bound in microseconds.", default=None, rule="time-limit", label="at most")
    only: Phrase = only_key(default="", rule="timing-typical")
    source: Sources = source_key()


@part(
    "Supply voltage that the encoder needs. As a key of the device, it applies to all order codes. "
    "As a key of a value of an order code part, it applies only to the order codes with that value.",
    data="Supply voltage, including tolerance.",
)
class Supply:
    """Supply voltage that an encoder needs, tolerance included."""

    min_mv: int = key(
        "Lowest voltage in millivolts, including tolerance: 4750 for +5 V ±5 %.",
        data="Lowest voltage in millivolts.",
        minimum=1,
        maximum=1000000,
        rule="supply-narrower",
        label="lowest",
    )
    max_mv: int = key(
        "Highest voltage in millivolts, including tolerance.",
        data="Highest voltage in millivolts.",
        minimum=1,
        maximum=1000000,
        rule="supply-narrower",
        label="highest",
    )
    source: Sources = source_key(default=())


@part("An error or a warning.", identity="register field")
class Alarm:
    name: Name = name_key("Name of the alarm.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = names_key(default=NOTHING)
    group: Name = key("Field group that contains the flag.", data="Group of fields that contains the flag.", default="")
    register: Name = key(
        "Register that contains the flag, instead of a group.",
        data="Register that contains the flag.",
        default="",
        rule="alarm-bit",
        refers_to="register",
    )
    field: Name = key(
        "Flag in that group or register.", default="", rule="alarm-bit", label="bit", refers_to="any-field"
    )
    meaning: Prose = key("Event that the alarm signals.", rule="words")
    detected: Prose = key("Time at which the encoder checks for the alarm.", default="", rule="words")
    below_mv: Count | None = key(
        "Voltage in millivolts below which the alarm is raised.",
        default=None,
        rule="alarm-threshold",
        label="threshold",
        read="alarm",
    )
    latch: bool | None = key(
        "True if the alarm remains active until it is reset.",
        reading="null if the manual does not say.",
        default=None,
        rule="alarm-rule",
        label="kept until reset",
        read="alarm",
        noun="latching",
    )
    implemented: bool = key(
        "False if this encoder does not implement it. Default: true.",
        data="True if this encoder implements the item.",
        default=True,
        rule="alarm-rule",
        read="alarm",
        noun="presence in this encoder",
    )
    remedy: Prose = key("Instructions for clearing the alarm.", default="", rule="words")
    cleared_by: tuple[Name, ...] = key(
        "Procedures that clear the alarm.",
        least=0,
        default=(),
        rule="alarm-rule",
        read="alarm",
        noun="clearing procedures",
        refers_to="procedures",
    )
    only: Phrase = only_key(default="", writing="Its flag must have the same patterns.", rule="alarm-rule")
    by_hand: tuple[Name, ...] = key(
        "Names of characteristics that list steps for a person.",
        writing=STEPS,
        data=BY_HAND,
        default=(),
        rule="alarm-rule",
        label="manual steps",
        read="alarm",
    )
    source: Sources = source_key()


@part("One contact.", identity="contact signal")
class Contact:
    contact: Phrase = key("Pin number or wire colour, as text.", data="Pin number or wire colour.")
    signal: Phrase = key("Function as printed.", rule="contact")
    only: Phrase = only_key(
        "Order codes that have it, as in .../65K...:",
        default="",
        data="Order codes that have the contact.",
        rule="contact",
        read="pin",
    )


@part("A connector or a cable.", identity="contacts")
class Connector:
    name: Name = name_key("Name of the connector or cable.")
    kind: Literal["connector", "cable"] = key(
        "A connector with pins, or a cable with coloured wires.", data="Kind: connector or cable.", rule="contact"
    )
    title: Phrase = key("Type and gender as printed.", rule="words")
    interfaces: tuple[InterfaceName, ...] = key(
        "Interfaces that it is wired for.",
        data="Interfaces that the connector is wired for. Empty for all.",
        least=0,
        default=(),
        rule="contact",
        shape="[name]",
    )
    mating: Prose = key("Mating connector.", default="", rule="words")
    contacts: tuple[Contact, ...] = key("Contacts of the connector, or wires of the cable.")
    note: Prose = note_key(default="")
    source: Sources = source_key()


@part("One state.")
class LedState:
    state: Phrase = key("State that a person sees.")
    meaning: Prose = key("Meaning of the state.", data="Meaning.")
    only: Phrase = only_key(default="", read="LED")
    by_hand: tuple[Name, ...] = key(
        "Names of characteristics that list steps for a person.",
        writing=STEPS,
        data=BY_HAND,
        default=(),
        label="steps by hand",
        read="LED",
    )


@part("A diagnostic LED.")
class Led:
    name: Name = name_key("Name of the LED.")
    title: Phrase = key("Label as printed.")
    states: tuple[LedState, ...] = key("States of the LED.")
    source: Sources = source_key()


@part(
    "A quantity with its bounds.", writing="A tolerance is given by the bounds that follow from it.", is_sourced=False
)
class Quantity:
    """A quantity with its bounds. ``where`` is the part that it applies to, if there are several."""

    quantity: Literal[
        "angle",
        "area",
        "battery",
        "bending_radius",
        "clearance",
        "coverage",
        "current",
        "frequency",
        "length",
        "mass",
        "resistance",
        "resistance_per_length",
        "speed",
        "supply",
        "temperature",
        "time",
        "torque",
        "voltage",
    ] = key(
        "Kind of quantity.",
        data="Kind of quantity, such as torque.",
        label="kind",
        read="characteristic",
        shape="string",
    )
    where: Phrase = key(
        "Part or condition that it applies to, if there are several.",
        data="Part or condition that it applies to. Empty if there is only one.",
        default="",
    )
    min: float | None = key("Lower bound.", default=None, label="lower bound", read="characteristic")
    typical: float | None = key("Typical or nominal value.", default=None, label="typical value", read="characteristic")
    max: float | None = key("Upper bound.", default=None, label="upper bound", read="characteristic")
    unit: Literal[
        "%",
        "A",
        "Hz",
        "MHz",
        "MΩ",
        "Nm",
        "V",
        "Vpp",
        "diameters",
        "g",
        "in",
        "kHz",
        "kg",
        "m",
        "m/s",
        "mA",
        "min",
        "mm",
        "mm²",
        "ms",
        "s",
        "°",
        "°C",
        "°F",
        "µm",
        "µs",
        "Ω",
        "Ω/km",
    ] = key("Unit of the numbers.", read="characteristic", shape="string")


@part("A fact that is only displayed, never used in computations.")
class Characteristic:
    name: Name = name_key("Name of the fact.")
    value: Prose = key("The fact, as text.", data="Fact as text.")
    values: tuple[Quantity, ...] = key(
        "The quantities in the text, with units. Each must agree with the text.",
        data="Quantities in the text.",
        default=(),
    )
    only: Phrase = only_key(default="", data="Order codes that the item applies to.", read="characteristic")
    source: Sources = source_key()


@part("A hardware input.", identity="inverts low high")
class Input:
    """A hardware input. ``inverts`` and ``needs`` refer to register bits as ``register.field``."""

    name: Name = name_key("Name of the input.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = names_key(default=NOTHING)
    meaning: Prose = meaning_key("Function of the input.")
    low: Prose = key("Meaning of the low level (0 V).", data="Effect of a low level.", default="", rule="words")
    high: Prose = key("Meaning of the high level (+V).", data="Effect of a high level.", default="", rule="words")
    pulse_at_least_us: Count | None = key(
        "Minimum pulse length in microseconds.",
        default=None,
        rule="input-rule",
        label="pulse of at least",
        read="time",
        noun="pulse",
    )
    inverts: RegisterBit = key(
        "Register bit whose meaning the high level inverts, as register.field.",
        data="register.field whose meaning the high level inverts.",
        default="",
        rule="input-rule",
        read="input",
        noun="inverted bit",
        refers_to="dotted",
    )
    needs: RegisterBit = key(
        "Register bit that enables the input, as register.field.",
        data="register.field that enables the input.",
        default="",
        rule="input-rule",
        read="input",
        noun="enabling bit",
        refers_to="dotted",
    )
    when_unused: Prose = key("Connection of the input when it is not used.", default="", rule="input-rule")
    note: Prose = note_key(default="")
    source: Sources = source_key()


@part("A table as in the manual.", data="A table of the manual that is only displayed, never used in computations.")
class Table:
    name: Name = name_key("Name of the table.")
    title: Phrase = key("Subject of the table.")
    columns: tuple[Prose, ...] = key("Headings, with units.", data="Column headings.", most=12)
    units: tuple[Unit, ...] = key(
        "Units of the columns that contain numbers, in the order of the columns. Empty for a column of text.",
        data="Units of the columns that contain numbers. Empty for a column of text.",
        most=12,
        default=(),
        read="table",
    )
    rows: tuple[Cells, ...] = key("Rows, each with one cell per column.", data="Rows of the table.")
    note: Prose = note_key("Footnotes.", default="")
    source: Sources = source_key()


#: Replacements, in an overlay or another edition, for a fact that is absent or unknown there.
LEFT_OUT, NOT_KNOWN = "left out", "not known"


@dataclass(frozen=True, slots=True)
class Erratum:
    """An error in the manual.

    ``title`` says in one sentence what is wrong. With ``overlay`` or ``edition``, it is a change to the spec instead:
    ``printed`` is the content of the spec, and ``used`` is the replacement, which may be ``LEFT_OUT`` or ``NOT_KNOWN``.
    """

    name: str
    title: str
    printed: str
    used: str
    why: str
    status: str
    severity: str
    affects: tuple[str, ...]
    source: Sources
    overlay: str = ""
    edition: str = ""
    only: str = ""


def layer_in_words(overlay: str, edition: str) -> str:
    """Return the overlay or edition that changes the spec: ``Before edition 1.4``."""
    if overlay:
        return f"Overlay {overlay}"
    if edition.startswith("before "):
        return f"Before edition {edition.removeprefix('before ')}"
    return f"In edition {edition}"


@part(
    "A register that identifies encoders of an earlier edition, because in those encoders it can "
    "hold a value that is impossible in this edition."
)
class EditionTest:
    """A register that identifies older encoders: only these can have a value of ``run`` outside ``min`` to ``max``."""

    register: Name = key("Name of the register.")
    run: Name = key("Field with limits, or a group of digits within such a field.", data="Field or group of digits.")
    min: Count = key("Lowest value in this edition.", data="Lowest value.")
    max: Count = key("Highest value in this edition.", data="Highest value.")
    why: Prose = key("Reason why no other value is possible.")
    source: Sources = source_key()


@dataclass(frozen=True, slots=True)
class ManualEdition:
    """An edition of the manual that users can choose. ``labels`` lists patterns for its labels."""

    revision: str
    date: str
    labels: tuple[str, ...] = ()
    tests: tuple[EditionTest, ...] = ()


@dataclass(frozen=True, slots=True)
class Overlay:
    """Changes to a spec: a correction, or the manufacturer's facts about the models with the suffix ``special``."""

    name: str
    title: str
    special: str


@dataclass(frozen=True, slots=True)
class Manufacturer:
    name: str
    title: str
    biss_id: int | None
    python_package: str
    version: str
    trademarks: tuple[str, ...]
    main: bool = False
    website: str = ""

    @property
    def distribution(self) -> str:
        """Name of the Python package to install, and of the command that it installs."""
        return self.python_package.replace("_", "-")


#: Value of a field, a join or a run of digits in an example.
Values = Mapping[str, int | str | bool]


@part("One write.", data="One register write.", kw_only=False)
class Write:
    """A byte written to a register, or the number in a register that is written at once."""

    address: Hex = key("Register address.", minimum=0, maximum=65535)
    value: Hex = key("Byte written. Over SPI, the number in the register.", minimum=0, maximum=18446744073709551615)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Example:
    name: str
    erratum: str
    note: str
    source: Sources


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameExample(_Example):
    """A frame, in ``bits`` or in ``bytes``, with its values or the error for which it is ``refused``.

    ``alternatives`` contains the answers that it needs, keyed by the name of the alternative.
    """

    kind: ClassVar[str] = "frame"
    order_code: str
    layout: str
    sender: str
    bytes: bytes
    bits: str
    values: Values
    refused: str
    alternatives: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class RegisterExample(_Example):
    """The bytes of a register and their values."""

    kind: ClassVar[str] = "register"
    order_code: str
    register: str
    bytes: bytes
    values: Values


@dataclass(frozen=True, slots=True, kw_only=True)
class CrcExample(_Example):
    """Bytes and their CRC."""

    kind: ClassVar[str] = "crc"
    crc: str
    bytes: bytes
    check: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcedureExample(_Example):
    """The bytes that a procedure writes for these arguments."""

    kind: ClassVar[str] = "procedure"
    order_code: str
    procedure: str
    arguments: Mapping[str, int]
    writes: tuple[Write, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureExample(_Example):
    """A position in counts and its length."""

    kind: ClassVar[str] = "measure"
    order_code: str
    counts: int
    micrometres: int


#: ``kind`` is the keyword in the spec language, used for printing only.
Example = FrameExample | RegisterExample | CrcExample | ProcedureExample | MeasureExample


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A frame that an encoder with this order code could send, for programs and pages that show one.

    All values are made up, except the position if there is a ``source``. ``spoilt`` is the same frame with an active
    flag that makes its position unusable, or None if it has no such flag.
    """

    order_code: str
    layout: str
    frame: int
    values: Values
    spoilt: int | None
    source: Sources
