"""A parsed line: its interface, options and fields, with the column of each field."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

#: Names of the fields that are read as one position.
TURNS, IN_TURN, POSITION = "multiturn", "singleturn", "position"


class LineProblem(NamedTuple):
    """A problem in a line. ``column`` counts characters from 1. The message also says how to correct the line."""

    column: int
    message: str


class LineError(ValueError):
    """The line does not describe an encoder. ``problems`` lists all reasons, sorted by column."""

    def __init__(self, text: str, problems: list[LineProblem]) -> None:
        super().__init__("; ".join(problem.message for problem in problems))
        self.text = text
        self.problems = sorted(set(problems))


@dataclass(frozen=True, slots=True)
class NumberField:
    """A number. ``value`` is set for a constant, which identifies a valid frame."""

    name: str
    bits: int
    column: int
    is_signed: bool = False
    value: int | None = None


@dataclass(frozen=True, slots=True)
class FlagField:
    """A bit with an active level. ``verdict`` is the verdict on the position while the flag is active."""

    name: str
    column: int
    level: Literal["low", "high"]
    verdict: str
    bits: int = 1


@dataclass(frozen=True, slots=True)
class FillerField:
    """Bits that are always zero, or that have no meaning."""

    name: Literal["zero", "unused"]
    bits: int
    column: int


@dataclass(frozen=True, slots=True)
class ParityField:
    """A parity bit over all other fields."""

    name: str
    column: int
    kind: Literal["even", "odd"]
    bits: int = 1


@dataclass(frozen=True, slots=True)
class CrcField:
    """A CRC over everything sent before it. ``poly`` has no top bit.

    ``is_reflected`` is true if it processes each byte from its lowest bit. ``byte_order`` is the order of its bytes, or
    empty if they have the order of the frame.
    """

    name: str
    bits: int
    column: int
    poly: int
    init: int
    is_inverted: bool
    is_reflected: bool = False
    byte_order: str = ""


LineField = NumberField | FlagField | FillerField | ParityField | CrcField


@dataclass(frozen=True, slots=True)
class LineOptions:
    """Words between the interface and the colon. An empty value, None or 0 is a fact that the line does not state."""

    is_gray: bool = False
    alignment: str = ""
    byte_order: str = ""
    mode: int | None = None
    clock_hz: int = 0
    baud: int = 0
    request: bytes = b""
    counts: int = 0
    turns: int = 0


@dataclass(frozen=True, slots=True)
class EncoderLine:
    """An encoder as one line describes it."""

    text: str
    interface: str
    options: LineOptions
    fields: tuple[LineField, ...]

    @property
    def bits(self) -> int:
        """Number of bits of the frame."""
        return sum(field.bits for field in self.fields)

    def has(self, name: str) -> bool:
        """Return whether one of the fields has this name."""
        return any(field.name == name for field in self.fields)

    @property
    def gaps(self) -> Iterator[str]:
        """Facts that a spec needs, but that the line does not state, each as a sentence for the spec."""
        options = self.options
        if self.interface != "rs485" and not options.clock_hz:
            yield "The clock."
        if self.interface == "spi" and options.mode is None:
            yield "The SPI mode. 0 is only a placeholder."
        if self.interface == "ssi" and not options.alignment:
            yield "The alignment of the word. Left is only a placeholder."
        if self.interface == "rs485" and not options.baud:
            yield "The settings of the serial port. 115200 baud without parity is only a placeholder."
        if self.interface == "rs485" and not options.request:
            yield "The request that asks for this reply."
        if self.has(POSITION) and not options.counts:
            yield "The counts per revolution."
        if not any(isinstance(field, FlagField) and field.verdict == "not_usable" for field in self.fields):
            yield "Flags that tell whether the position is usable."
        yield "Registers, alarms, timings, supply and wiring."
