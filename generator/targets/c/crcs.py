"""CRCs in C: without a table if the polynomial has two or three terms, or with one. A macro selects the other form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ...model import Crc
from ...plan.crc_tables import FoldStep, fold_plan, reflect, table, word_table
from ...plan.crcs import Carrier, CrcFunction, Form
from .about import about_crc
from .comments import Paragraph
from .context import Context
from .folds import FoldOperation, folds
from .names import Declared
from .types import unsigned


@dataclass(frozen=True)
class CrcCode:
    """The function of a CRC over bits or bytes. ``table`` holds the remainder of each byte, if there is a table."""

    name: str
    function: CrcFunction
    about: tuple[Paragraph, ...]
    table: tuple[int, ...]

    def declared(self) -> Iterator[Declared]:
        yield self.name, ("crcs", self.crc.name)
        if self.table:
            yield f"{self.name}_entry", ("crcs", self.crc.name)

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
        """True if the register of the table has its bits in reverse order."""
        return self.by_bits and self.in_bytes and self.crc.refin

    @property
    def table_init(self) -> int:
        return reflect(self.crc.init, self.crc.width) if self.is_reflected else self.crc.init

    @property
    def is_turned(self) -> bool:
        """True if that register must be reversed at the end."""
        return self.crc.refout != self.is_reflected

    @property
    def folds(self) -> Iterator[FoldOperation]:
        """The steps that reduce 64 bits to their remainder."""
        return folds(fold_plan(self.crc.width, self.crc.poly, 64), 64, "data")

    @property
    def raised(self) -> tuple[FoldStep, ...]:
        """The steps that reduce that remainder again after it was shifted left by the width of the CRC."""
        return fold_plan(self.crc.width, self.crc.poly, 2 * self.crc.width)


def crc_code(context: Context, function: CrcFunction) -> CrcCode:
    crc = function.crc
    name = context.crc_name(crc, function.carrier.value)
    values: tuple[int, ...] = ()
    if function.form is Form.TABLE:
        values = table(crc.width, crc.poly, function.carrier is Carrier.BYTES and crc.refin)
    elif function.form is Form.FOLD and function.in_words:
        values = word_table(crc.width, crc.poly)
    return CrcCode(name, function, tuple(about_crc(context.device, function)), values)
