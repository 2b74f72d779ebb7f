"""The manual: sources, other documents, the evidence of a spec, editions, errors in the manual, and worked examples."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

from .part import NOTHING, Count, Date, Hex, Language, Name, Phrase, Prose, fact, key, part, source_key
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
        """Return the source as specs write it: ``it: 6.4 p.36``."""
        document_text = f"{self.document}:" if self.document else ""
        page_text = "" if self.page is None else f"p.{self.page}"
        return " ".join(filter(None, (document_text, self.section, page_text)))


Sources = tuple[Source, ...]


def cite(sources: Sources) -> str:
    """Return the sources as one short text, such as ``6.4 p.35, it: 6.4 p.36``."""
    return ", ".join(map(str, own_first(sources)))


def own_first(sources: Sources) -> Sources:
    """Return the sources with citations of the manual first, so that they do not seem to be in a named document."""
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

    ``documents`` contains the pages that were read, by document. The others name implementations that agree, examples
    from real hardware, and facts that are left out. ``placeholders`` names values that are still the template's.
    """

    grade: Literal["manual", "quoted", "corroborated", "corroborated, no hardware frame seen", "uncorroborated"] = key(
        "Grade of the evidence.",
        writing="Manual: the manufacturer's document was read as a whole. Quoted: every fact is in the "
        "manufacturer's words, an independent implementation agrees, and a vector of real hardware "
        "passes. Corroborated: each fact is in the manufacturer's words or in two implementations that "
        "share no code, and a vector of real hardware passes. Corroborated, no hardware frame seen: the same "
        "without such a vector. Uncorroborated: less than that.",
        rule="evidence",
        data_type="string",
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
