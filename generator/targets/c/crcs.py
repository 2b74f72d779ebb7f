"""CRCs in C: without a table if the polynomial has two or three terms, or with one. A macro selects the other form."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import Crc
from ...model.record import dataclass
from ...plan.crcs import Carrier, CrcFunction, Form, carrier_of, reflect, table, word_table
from .about import about_crc
from .codec import StructCodec
from .comments import Paragraph
from .context import Context
from .names import Declared, unsigned


@dataclass(frozen=True)
class CrcCode:
    """The function of a CRC over bits or bytes. ``table`` holds the remainder of each byte, if there is a table.

    The function exists only if a frame calls it. Frames that are one number mostly have a CRC function of their own.
    """

    name: str
    function: CrcFunction
    about: tuple[Paragraph, ...]
    table: tuple[int, ...]
    is_called: bool

    def declared(self) -> Iterator[Declared]:
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
        return self.function.carrier is Carrier.BYTES

    @property
    def is_fold(self) -> bool:
        return self.function.form is Form.FOLD

    @property
    def by_bits(self) -> bool:
        return self.function.form is Form.TABLE

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


def crc_code(context: Context, function: CrcFunction, codecs: Sequence[StructCodec]) -> CrcCode:
    crc = function.crc
    users = [codec for codec in codecs if codec.plan.crc is not None and codec.plan.crc.crc == crc]
    users = [codec for codec in users if carrier_of(codec.struct.layout) is function.carrier and codec.bits_crc is None]
    is_called = any(codec.word_crc is None for codec in users)
    name = context.crc_name(crc, function.carrier.value)
    values: tuple[int, ...] = ()
    if function.form is Form.TABLE:
        values = table(crc.width, crc.poly, function.carrier is Carrier.BYTES and crc.refin)
    elif function.form is Form.FOLD and function.in_words:
        values = word_table(crc.width, crc.poly)
    values = values if users else ()
    return CrcCode(name, function, tuple(about_crc(context.device, function)), values, is_called)
