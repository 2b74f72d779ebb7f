"""What the templates of the Python target print: every name chosen, every expression spelled."""

from __future__ import annotations

from dataclasses import dataclass

from ..model import Layout


@dataclass(frozen=True)
class Check:
    """A test in ``decode``: ``condition`` holds when something is wrong, ``error`` is what is raised then."""

    condition: str
    error: str


@dataclass(frozen=True)
class Attribute:
    """An attribute of a frame or register: its type, how ``decode`` gets it and what a reader should know.

    ``usual`` is the value that the manual states for it; it becomes the default where no attribute without one follows.
    """

    name: str
    type: str
    value: str
    meaning: str
    default: str = ""
    usual: str = ""


@dataclass(frozen=True)
class JoinPart:
    """One field of a join in ``from_…``: its attribute, and the expression that takes it out of the whole."""

    name: str
    value: str


@dataclass(frozen=True)
class Joined:
    name: str
    doc: str
    value: str
    width: str
    signature: str
    parts: tuple[JoinPart, ...]
    others: tuple[Attribute, ...]
    uses_variant: bool


@dataclass(frozen=True)
class Codec:
    """A layout in Python: a class, and the lines of its methods."""

    layout: Layout
    name: str
    doc: str
    interface: str
    source: str
    source_type: str
    source_doc: str
    arguments: str
    bits: str
    takes_variant: bool
    attributes: tuple[Attribute, ...]
    properties: tuple[tuple[str, str, str, str], ...]
    joins: tuple[Joined, ...]
    length: str
    length_error: str
    setup: tuple[str, ...]
    crc: Check | None
    crc_setup: str
    checks: tuple[Check, ...]
    locals: tuple[str, ...]
    encode_checks: tuple[str, ...]
    gray: tuple[str, str, str] | None
    number: str
    finish: str
    body: str
    encode_variant: bool
    bit_fields: tuple[str, ...]
    limits: tuple[str, str] | None
    limits_doc: str
    meaning_limits: tuple[tuple[str, str, str, str, str], ...]


@dataclass(frozen=True)
class Enumeration:
    """A set of named values; with ``length`` it is a register of so many bytes and codes itself."""

    name: str
    doc: str
    values: tuple[tuple[str, str, str], ...]
    length: int = 0
    order: str = ""
    low: int = 0


@dataclass(frozen=True)
class CrcFunction:
    name: str
    arguments: str
    doc: str
    value: str


@dataclass(frozen=True)
class Fold:
    name: str
    doc: str
    steps: tuple[tuple[int, str, str], ...]


@dataclass(frozen=True)
class Branch:
    condition: str
    name: str
    arguments: str


@dataclass(frozen=True)
class Dispatch:
    """A function that tells apart what one side sends."""

    name: str
    interface: str
    union: str
    members: tuple[str, ...]
    doc: str
    least: int
    selector: str
    local: str
    value: str
    branches: tuple[Branch, ...]
    allowed: str
    fallback: str


@dataclass(frozen=True)
class Section:
    """One interface in a device module."""

    title: str
    constant: str
    facts: str
    notes: tuple[str, ...]
    codecs: tuple[Codec, ...]
    dispatches: tuple[Dispatch, ...]


@dataclass(frozen=True)
class Function:
    """A procedure; where the encoder is ``optional`` its steps are the same for all, and it is only checked."""

    name: str
    signature: str
    doc: str
    interface: str
    optional: bool
    checks: tuple[str, ...]
    steps: tuple[str, ...]


@dataclass(frozen=True)
class Measure:
    """A method of the variants with an expression by condition on the interface; ``otherwise`` is what is raised where there is none."""

    name: str
    arguments: str
    type: str
    doc: str
    branches: tuple[tuple[str, str], ...]
    otherwise: str


@dataclass(frozen=True)
class FrameKind:
    """What ``Variant.decode`` calls over one interface; ``refuses_bits`` where frames are made of bytes."""

    interface: str
    call: str
    refuses_bits: bool


@dataclass(frozen=True)
class Shown:
    """An example in the README: what is called, and what comes out.

    ``flags`` are those of a frame that tell of a fault; of a frame that is a string of bits there are their number and
    ``digits``.
    """

    code: str
    text: str
    shown: str
    result: str
    flags: tuple[str, ...] = ()
    bits: int = 0
    digits: str = ""

    @property
    def lines(self) -> tuple[str, ...]:
        """What shows the values of a frame: where it has flags, only after a look at them."""
        if not self.flags:
            return (f"print({self.shown})",)
        seen = self.flags[0] if len(self.flags) == 1 else f"({' or '.join(self.flags)})"
        return f"if not {seen}:", f"    print({self.shown})"
