"""Facts that outputs only display, and the worked examples of the manual, which test every output."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from .part import (
    BY_HAND,
    NOTHING,
    STEPS,
    Count,
    Name,
    Names,
    Phrase,
    Text,
    key,
    name_key,
    names_key,
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


@dataclass(frozen=True, slots=True)
class Evidence:
    """Evidence for the facts of a family.

    ``documents`` has the pages that were read, by document. The others name implementations that agree, examples from
    real hardware, and facts that are left out. ``placeholders`` names values that are still the template's.
    """

    grade: str
    documents: Mapping[str, str]
    implementations: tuple[str, ...]
    vectors: tuple[str, ...]
    left_out: tuple[str, ...]
    placeholders: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Edition:
    language: str
    title: str
    revision: str
    date: str


@dataclass(frozen=True, slots=True)
class Revision:
    revision: str
    date: str
    changes: str
    hardware: str
    software: str


@dataclass(frozen=True, slots=True)
class Manual:
    title: str
    revision: str
    date: str
    language: str
    publisher: str
    editions: tuple[Edition, ...]
    history: tuple[Revision, ...]


@dataclass(frozen=True, slots=True)
class LostFigure:
    content: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Timing:
    name: str
    symbol: str
    meaning: str
    at_least_us: int | None
    typical_us: int | None
    at_most_us: int | None
    source: Sources
    only: str = ""


@dataclass(frozen=True, slots=True)
class Supply:
    """Supply voltage that an encoder needs, tolerance included."""

    min_mv: int
    max_mv: int
    source: Sources


@part("An error or a warning.", identity="register field")
class Alarm:
    name: Name = name_key("Name of the alarm.")
    printed_name: Text = printed_name_key(default="")
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
    meaning: Text = key("Event that the alarm signals.", rule="words")
    detected: Text = key("Time at which the encoder checks for the alarm.", default="", rule="words")
    below_mv: Count | None = key(
        "Voltage in millivolts below which the alarm is raised.",
        default=None,
        rule="alarm-rule",
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
    remedy: Text = key("Instructions for clearing the alarm.", default="", rule="words")
    cleared_by: tuple[Name, ...] = key(
        "Procedures that clear the alarm.",
        may_be_empty=True,
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


@dataclass(frozen=True, slots=True)
class Contact:
    contact: str
    signal: str
    only: str


@dataclass(frozen=True, slots=True)
class Connector:
    name: str
    kind: str
    title: str
    interfaces: tuple[str, ...]
    mating: str
    contacts: tuple[Contact, ...]
    note: str
    source: Sources


@part("One state.")
class LedState:
    state: Phrase = key("State that a person sees.")
    meaning: Text = key("Meaning of the state.", data="Meaning.")
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


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity with its bounds. ``where`` is the part that it applies to, if there are several."""

    quantity: str
    where: str
    min: float | None
    typical: float | None
    max: float | None
    unit: str


@dataclass(frozen=True, slots=True)
class Characteristic:
    name: str
    value: str
    values: tuple[Quantity, ...]
    only: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Input:
    """A hardware input. ``inverts`` and ``needs`` refer to register bits as ``register.field``."""

    name: str
    printed_name: str
    names: Mapping[str, str]
    meaning: str
    low: str
    high: str
    pulse_at_least_us: int | None
    inverts: str
    needs: str
    when_unused: str
    note: str
    source: Sources


@dataclass(frozen=True, slots=True)
class Table:
    name: str
    title: str
    columns: tuple[str, ...]
    units: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str
    source: Sources


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


@dataclass(frozen=True, slots=True)
class EditionTest:
    """A register that identifies older encoders: only these can have a value of ``run`` outside ``min`` to ``max``."""

    register: str
    run: str
    min: int
    max: int
    why: str
    source: Sources


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

    @property
    def distribution(self) -> str:
        """Name of the Python package to install, and of the command that it installs."""
        return self.python_package.replace("_", "-")


#: Value of a field, a join or a run of digits in an example.
Values = Mapping[str, int | str | bool]


@dataclass(frozen=True, slots=True)
class Write:
    """A byte written to a register, or the number in a register that is written at once."""

    address: int
    value: int


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
