"""The CRC functions of a family in C, over bits or bytes, each with its table and the frames that call it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Crc
from ...model.record import dataclass
from ...plan.crcs import CoveredData, CrcFunction, CrcMethod, byte_table, carrier_of, reflect, word_table
from .about import about_crc
from .codec import StructCodec
from .comments import Paragraph
from .context import HeaderContext
from .names import DeclaredName, unsigned
from .structs import covers_32_bits


@dataclass(frozen=True)
class CrcCode:
    """The function of a CRC over bits or bytes. ``byte_table`` holds the remainder of each byte, if there is a table.

    The function exists only if a frame calls it. Frames that are one number mostly have a CRC function of their own.
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
        return self.function.carrier is CoveredData.BYTES

    @property
    def is_fold(self) -> bool:
        return self.function.form is CrcMethod.FOLD

    @property
    def by_bits(self) -> bool:
        return self.function.form is CrcMethod.TABLE

    @property
    def is_reflected(self) -> bool:
        """True if the table is for a shift register with its bits in reverse order."""
        return self.by_bits and self.in_bytes and self.crc.refin

    @property
    def table_init(self) -> int:
        return reflect(self.crc.init, self.crc.width) if self.is_reflected else self.crc.init

    @property
    def is_turned(self) -> bool:
        """True if that register must be reversed at the end."""
        return self.crc.refout != self.is_reflected


def crc_code(context: HeaderContext, function: CrcFunction, codecs: Sequence[StructCodec]) -> CrcCode:
    """Return the function of a CRC. It has a table only if its form needs one and a codec uses it.

    A codec with a CRC for words does not call the function, and uses only the table.
    """
    users = [codec for codec in codecs if _uses_function(codec, function)]
    return CrcCode(
        name=context.crc_name(function.crc, function.carrier.value),
        function=function,
        about=tuple(about_crc(context.device, function)),
        table=_table_entries(function) if users else (),
        is_called=any(codec.word_crc is None for codec in users),
        data_type=_data_type(function, users),
    )


def _data_type(function: CrcFunction, users: Sequence[StructCodec]) -> str:
    """Return the type of the bits that a CRC covers in these frames: 32 bits if they are enough for all of them."""
    crcs = [frame_crc for codec in users for frame_crc in codec.plan.crcs if frame_crc.crc == function.crc]
    return "uint32_t" if all(map(covers_32_bits, crcs)) else "uint64_t"


def _uses_function(codec: StructCodec, function: CrcFunction) -> bool:
    """Return whether a codec uses this function or its table. Bits in bytes have their own functions, ``bits_crcs``."""
    has_crc = any(frame_crc.crc == function.crc for frame_crc in codec.plan.crcs)
    if not has_crc or codec.bits_crcs:
        return False
    return carrier_of(codec.struct.layout) is function.carrier


def _table_entries(function: CrcFunction) -> tuple[int, ...]:
    """Return the entries of the table of a CRC, if it has one.

    A folded CRC has a table only for frames that are words.
    """
    crc = function.crc
    if function.form is CrcMethod.TABLE:
        is_reflected = function.carrier is CoveredData.BYTES and crc.refin
        return byte_table(crc.width, crc.poly, is_reflected)
    if function.form is CrcMethod.FOLD and function.in_words:
        return word_table(crc.width, crc.poly)
    return ()
