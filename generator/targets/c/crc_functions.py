"""CRC functions in C, as templates/c/crcs.h.jinja prints them: in folding steps, or with a table look-up per byte.

Processors of 32 bits are slow at shifting wider numbers. The step after which the number fits in 32 bits therefore
takes the bits above and below its place from the halves of the wide number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Crc
from ...model.record import dataclass
from ...plan.crcs import FoldStep, fold_plan
from .comments import Paragraph


@dataclass(frozen=True, slots=True)
class FoldWide:
    """A step in 64 bits from ``source`` to ``wide``. ``again`` is True if ``wide`` is already declared."""

    step: FoldStep
    source: str
    again: bool


@dataclass(frozen=True, slots=True)
class FoldHalves:
    """The step from ``source`` in 64 bits to ``v`` in 32 bits."""

    step: FoldStep
    source: str


@dataclass(frozen=True, slots=True)
class Fold:
    """A step of ``v`` in 32 bits."""

    step: FoldStep


@dataclass(frozen=True, slots=True)
class Narrow:
    """The assignment of ``source``, which fits in 32 bits, to ``v``. ``last`` is True if it is the CRC."""

    source: str
    last: bool


FoldOperation = FoldWide | FoldHalves | Fold | Narrow


def fold_operations(steps: Sequence[FoldStep], bits: int, source: str) -> Iterator[FoldOperation]:
    """Yield the operations that reduce a number to its CRC remainder, which they leave in the C variable ``v``.

    Each step removes the high bits of the number and XORs them into the low ones, which makes the number shorter. An
    operation is in 64 bits, in the variable ``wide``, while more than 32 bits are moved or are left after it. All
    operations from the first shorter one on are in 32 bits, in the variable ``v``.

    Args:
        steps: Steps for the polynomial. See ``FoldStep``.
        bits: Width of the number.
        source: C expression of the number.
    """
    # From here on, ``source`` and ``bits`` are the variable and the width of the number before each step.
    for step in steps:
        # A step moves the bits from ``shift`` up to two places: to bit 0, and to bit ``back``.
        moved_bits = bits - step.shift
        bits_left = max(step.shift, moved_bits + step.back)
        if source == "v":
            yield Fold(step)
        elif bits_left > 32 or moved_bits > 32:
            yield FoldWide(step, source, again=source == "wide")
            source = "wide"
        elif bits <= 32:
            yield from (Narrow(source, last=False), Fold(step))
            source = "v"
        else:
            yield FoldHalves(step, source)
            source = "v"
        bits = bits_left
    if source != "v":
        yield Narrow(source, last=True)


@dataclass(frozen=True, slots=True)
class HalfByte:
    """A byte of a word in one of its halves, ``low`` or ``high``, which small processors access faster.

    ``left`` is the position of its lowest bit in the half.
    """

    half: str
    left: int


@dataclass(frozen=True)
class BitsCrc:
    """The function that computes the CRC over the first ``covered`` bits of a frame in bytes."""

    name: str
    crc: Crc
    covered: int
    type: str
    about: tuple[Paragraph, ...]


@dataclass(frozen=True)
class WordCrc:
    """The function that computes the CRC of a whole word. ``function`` is the function for any number of bits."""

    name: str
    function: str
    crc: Crc
    bits: int
    folds: tuple[FoldOperation, ...]
    about: tuple[Paragraph, ...]

    @property
    def at_once(self) -> int:
        """The number of bytes that initially fill the register."""
        return min(max(self.crc.width // 8, 1), self._register_bytes)

    @property
    def one_by_one(self) -> tuple[HalfByte, ...]:
        """The bytes after them, in the order received, for the table."""
        places = range(self._register_bytes - self.at_once - 1, -1, -1)
        return tuple(_locate_half_byte(place) for place in places)

    @property
    def first(self) -> HalfByte:
        return _locate_half_byte(self._register_bytes - 1)

    @property
    def needs_high(self) -> bool:
        """True if the function takes a single byte from the upper half of the word.

        A CRC of more than 8 bits takes its first bytes from the whole word instead.
        """
        byte_halves = [byte.half for byte in self.one_by_one]
        if self.crc.width <= 8:
            byte_halves.append(self.first.half)
        return "high" in byte_halves

    @property
    def last_steps(self) -> tuple[FoldStep, ...]:
        """The steps that reduce a byte to a CRC of fewer bits, none for a CRC of at least 8 bits."""
        return fold_plan(self.crc.width, self.crc.poly, 8) if self.crc.width < 8 else ()

    @property
    def _register_bytes(self) -> int:
        return (self.bits + 7) // 8


def _locate_half_byte(byte_index: int) -> HalfByte:
    """Return a byte of a word, counted from its lowest one. Bytes 0 to 3 are in ``low``, the others in ``high``."""
    if byte_index > 3:
        return HalfByte("high", left=8 * (byte_index - 4))
    return HalfByte("low", left=8 * byte_index)
