"""CRC functions in C: the general function of each CRC with its table, and the functions of single frames.

templates/c/general_crcs.h.jinja and templates/c/crc_of_frame.h.jinja print them. The function of a frame that is a word
consists of folding steps, or of a table look-up per byte.

32-bit processors are slow at shifting wider numbers. The step after which the number fits in 32 bits therefore
takes the bits above and below its place from the halves of the wide number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Crc
from ...model.record import dataclass
from ...plan.crcs import CoveredData, CrcFunction, CrcMethod, FoldStep, fold_plan, reflect
from .comments import Paragraph
from .names import DeclaredName, unsigned


@dataclass(frozen=True, slots=True)
class FoldWide:
    """A step in 64 bits, from the C expression ``source`` to the variable ``wide``.

    ``is_declared`` is True if an earlier step has declared the variable.
    """

    step: FoldStep
    source: str
    is_declared: bool


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
    """The assignment of ``source``, which fits in 32 bits, to ``v``. ``is_last`` is True if the value is the CRC."""

    source: str
    is_last: bool


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
    # The C expression that has the number before the next step, and the width of this number.
    current_source, current_bits = source, bits
    for step in steps:
        # A step moves the bits from ``shift`` up to two places: to bit 0, and to bit ``second_shift``.
        moved_bits = current_bits - step.shift
        bits_left = max(step.shift, moved_bits + step.second_shift)
        if current_source == "v":
            yield Fold(step)
        elif bits_left > 32 or moved_bits > 32:
            yield FoldWide(step, current_source, is_declared=current_source == "wide")
            current_source = "wide"
        elif current_bits <= 32:
            yield from (Narrow(current_source, is_last=False), Fold(step))
            current_source = "v"
        else:
            yield FoldHalves(step, current_source)
            current_source = "v"
        current_bits = bits_left
    if current_source != "v":
        yield Narrow(current_source, is_last=True)


@dataclass(frozen=True, slots=True)
class ByteInHalf:
    """A byte of a 64-bit word, as a byte of one of its 32-bit halves, which small processors access faster.

    ``half`` is the C variable of the half, ``low`` or ``high``. ``shift`` is the position of the byte's lowest bit in
    it.
    """

    half: str
    shift: int


@dataclass(frozen=True)
class BitsCrc:
    """The function that computes the CRC over the first ``covered_width`` bits of a frame in bytes."""

    name: str
    crc: Crc
    covered_width: int
    type: str
    about: tuple[Paragraph, ...]


@dataclass(frozen=True)
class WordCrc:
    """The function ``name`` that computes the CRC of a whole word of ``word_bits`` bits.

    ``general_function`` is the function for this CRC over any number of bits, whose table is also used here. ``folds``
    are the operations that reduce the word without a table, empty if there are none.
    """

    name: str
    general_function: str
    crc: Crc
    word_bits: int
    folds: tuple[FoldOperation, ...]
    about: tuple[Paragraph, ...]

    @property
    def number_of_initial_bytes(self) -> int:
        """The number of bytes that initially fill the CRC register."""
        bytes_of_crc = max(self.crc.width // 8, 1)
        return min(bytes_of_crc, self._bytes_of_word)

    @property
    def table_bytes(self) -> tuple[ByteInHalf, ...]:
        """The bytes after the initial ones, in the order received. The function looks each of them up in the table."""
        number_of_table_bytes = self._bytes_of_word - self.number_of_initial_bytes
        return tuple(map(_byte_in_half, reversed(range(number_of_table_bytes))))

    @property
    def first_byte(self) -> ByteInHalf:
        """The byte received first, which is the highest of the word."""
        return _byte_in_half(self._bytes_of_word - 1)

    @property
    def uses_high_half(self) -> bool:
        """True if the function takes a single byte from the upper half of the word.

        A CRC of more than 8 bits takes its first bytes from the whole word instead.
        """
        single_bytes = list(self.table_bytes)
        if self.crc.width <= 8:
            single_bytes.append(self.first_byte)
        return any(byte.half == "high" for byte in single_bytes)

    @property
    def last_steps(self) -> tuple[FoldStep, ...]:
        """The steps that reduce the last 8 bits to a CRC of fewer bits, none for a CRC of at least 8 bits."""
        return fold_plan(self.crc.width, self.crc.poly, 8) if self.crc.width < 8 else ()

    @property
    def _bytes_of_word(self) -> int:
        # Bits to bytes, rounded up.
        return (self.word_bits + 7) // 8


def _byte_in_half(byte_index: int) -> ByteInHalf:
    """Return a byte of a word, counted from its lowest one. Bytes 0 to 3 are in ``low``, the others in ``high``."""
    if byte_index > 3:
        return ByteInHalf("high", shift=8 * (byte_index - 4))
    return ByteInHalf("low", shift=8 * byte_index)


@dataclass(frozen=True)
class CrcCode:
    """The general function for a CRC over bits or bytes. ``table`` contains the remainder of each byte, or is empty.

    The function exists only if a frame calls it (``is_called``). Most frames that are one number have a CRC function of
    their own, which may still use the table.
    """

    name: str
    function: CrcFunction
    about: tuple[Paragraph, ...]
    table: tuple[int, ...]
    is_called: bool
    #: The type of the bits that a function over bits takes.
    data_type: str

    def declared(self) -> Iterator[DeclaredName]:
        if self.is_called:
            yield self.name, ("crcs", self.crc.name)
        if self.table:
            yield f"{self.name}_entries", ("crcs", self.crc.name)

    @property
    def type(self) -> str:
        return unsigned(self.crc.width)

    @property
    def crc(self) -> Crc:
        return self.function.crc

    @property
    def in_bytes(self) -> bool:
        return self.function.covered_data is CoveredData.BYTES

    @property
    def is_fold(self) -> bool:
        return self.function.method is CrcMethod.FOLD

    @property
    def can_be_bitwise(self) -> bool:
        """True if the function uses a table, which a macro can replace by a computation bit by bit."""
        return self.function.method is CrcMethod.TABLE

    @property
    def is_reflected(self) -> bool:
        """True if the table is for a CRC register with its bits in reverse order."""
        return self.can_be_bitwise and self.in_bytes and self.crc.refin

    @property
    def table_init(self) -> int:
        """The initial value of the CRC register, in the bit order of the table."""
        return reflect(self.crc.init, self.crc.width) if self.is_reflected else self.crc.init

    @property
    def is_reversed_at_end(self) -> bool:
        """True if the bits of the CRC register must be reversed at the end."""
        return self.crc.refout != self.is_reflected
