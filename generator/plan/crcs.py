"""CRC functions that a family needs: over bits or bytes, and in which form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from ..model import Crc, Device, FoldStep, Form, Layout
from ..model.kinds import CrcValue
from ..reference.crc import fold_plan


class Carrier(Enum):
    """Data that a CRC covers."""

    BITS = "bits"
    BYTES = "bytes"


@dataclass(frozen=True, slots=True)
class CrcFunction:
    """One function for ``crc``.

    ``alone`` is true if the CRC needs no other function, ``in_words`` if it ends frames that are one number.
    """

    crc: Crc
    carrier: Carrier
    form: Form
    alone: bool
    in_words: bool

    @property
    def steps(self) -> tuple[FoldStep, ...]:
        """Steps that reduce any 64-bit word to its remainder, empty unless the CRC folds."""
        return fold_plan(self.crc.width, self.crc.poly, 64) if self.form is Form.FOLD else ()


def carriers(device: Device, crc: Crc) -> tuple[Carrier, ...]:
    """Return the carriers of a CRC in frames and registers.

    If none uses it, its parameters decide: reflected input is defined for bytes only, and a width of whole bytes
    suggests bytes.
    """
    layouts = [layout for _, layout in device.layouts()] + [item.layout for item in device.registers]
    used = {layout.carried_as for layout in layouts if _ends_in(layout, crc)}
    if not used:
        return (Carrier.BYTES,) if crc.refin or crc.width % 8 == 0 else (Carrier.BITS,)
    return tuple(item for item in (Carrier.BYTES, Carrier.BITS) if item.value in used)


def crc_functions(device: Device) -> Iterator[CrcFunction]:
    """Yield the functions of a family in the order of its CRCs, over bytes before over bits."""
    for crc in device.crcs:
        found = carriers(device, crc)
        in_words = any(not layout.in_bytes and _ends_in(layout, crc) for _, layout in device.layouts())
        for carrier in found:
            yield CrcFunction(crc, carrier, _form(crc, carrier), len(found) == 1, in_words)


def function_of(device: Device, layout: Layout) -> CrcFunction | None:
    """Return the function for the CRC at the end of a layout, or None."""
    found = (item for item in crc_functions(device) if item.carrier.value == layout.carried_as)
    return next((item for item in found if _ends_in(layout, item.crc)), None)


def _form(crc: Crc, carrier: Carrier) -> Form:
    if carrier is Carrier.BITS:
        return Form.FOLD if crc.form is Form.FOLD and crc.width <= 32 else Form.TABLE
    return Form.XOR if crc.is_xor else Form.TABLE


def _ends_in(layout: Layout, crc: Crc) -> bool:
    return any(isinstance(item.kind, CrcValue) and item.kind.crc == crc.name for item in layout.fields)
