"""The CRC functions of a family in C, over bits or bytes, each with its table and the frames that call it.

``templates/c/crcs.h.jinja`` prints them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Crc
from ...model.record import dataclass
from ...plan.crcs import CoveredData, CrcFunction, CrcMethod, byte_table, covered_data_of, reflect, word_table
from ...plan.operations import FrameCrc
from .about import about_crc
from .codec import StructCodec
from .comments import Paragraph
from .context import HeaderContext
from .names import DeclaredName, unsigned
from .structs import covers_32_bits


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
        return self.function.carrier is CoveredData.BYTES

    @property
    def is_fold(self) -> bool:
        return self.function.form is CrcMethod.FOLD

    @property
    def can_be_bitwise(self) -> bool:
        """True if the function uses a table, which a macro can replace by a computation bit by bit."""
        return self.function.form is CrcMethod.TABLE

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


def crc_code(context: HeaderContext, function: CrcFunction, codecs: Sequence[StructCodec]) -> CrcCode:
    """Return the general function for a CRC, with its table if it has one.

    The table is left out if no frame or register uses it. A frame with its own CRC function for words does not call
    the general function, and only uses its table.
    """
    users = [codec for codec in codecs if _uses_function(codec, function)]
    return CrcCode(
        name=context.crc_name(function.crc, function.carrier.value),
        function=function,
        about=tuple(about_crc(context.device, function)),
        table=_table_entries(function) if users else (),
        is_called=any(codec.word_crc is None for codec in users),
        data_type=_type_of_covered_bits(function, users),
    )


def _type_of_covered_bits(function: CrcFunction, users: Sequence[StructCodec]) -> str:
    """Return the type of the bits that a CRC covers: ``uint32_t`` if 32 bits are enough for all frames."""
    crcs: list[FrameCrc] = []
    for codec in users:
        crcs += [frame_crc for frame_crc in codec.plan.crcs if frame_crc.crc == function.crc]
    return "uint32_t" if all(map(covers_32_bits, crcs)) else "uint64_t"


def _uses_function(codec: StructCodec, function: CrcFunction) -> bool:
    """Return True if the code of a frame uses this CRC function or its table.

    A frame of bits that arrives in bytes has a CRC function of its own (``bits_crcs``).
    """
    has_crc = any(frame_crc.crc == function.crc for frame_crc in codec.plan.crcs)
    has_own_function = bool(codec.bits_crcs)
    return has_crc and not has_own_function and covered_data_of(codec.struct.layout) is function.carrier


def _table_entries(function: CrcFunction) -> tuple[int, ...]:
    """Return the entries of the table of a CRC, one for each byte, or nothing if its function needs no table.

    A CRC in straight-line code (``FOLD``) has a table only for frames that are words.
    """
    crc = function.crc
    if function.form is CrcMethod.TABLE:
        is_reflected = function.carrier is CoveredData.BYTES and crc.refin
        return byte_table(crc.width, crc.poly, is_reflected)
    if function.form is CrcMethod.FOLD and function.in_words:
        return word_table(crc.width, crc.poly)
    return ()
