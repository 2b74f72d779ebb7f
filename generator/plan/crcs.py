"""Plan the CRC functions of a family: their form, and whether they cover bits or bytes."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum

from ..model import Crc, Device, Layout
from ..model.kinds import CrcValue
from ..model.record import dataclass
from .crc_tables import FoldStep, fold_plan

#: Width in bits of the longest word, and of the widest CRC that is folded in such a word.
_WORD, _WIDEST_FOLD = 64, 32


class Form(Enum):
    """Method by which code computes a CRC.

    FOLD is for x^n + x^m + 1 and x^n + 1 with start value 0, most significant bit first. XOR is for x^8 + 1 over whole
    bytes, where the CRC is the XOR of the bytes. TABLE is for all others.
    """

    FOLD = "fold"
    XOR = "xor"
    TABLE = "table"


class Carrier(Enum):
    """Kind of data that a CRC covers."""

    BITS = "bits"
    BYTES = "bytes"


@dataclass(frozen=True, slots=True)
class CrcFunction:
    """Function that computes ``crc``.

    ``alone`` is true if the CRC needs no other function. ``in_words`` is true if the CRC ends frames that are one
    number.
    """

    crc: Crc
    carrier: Carrier
    form: Form
    alone: bool
    in_words: bool

    @property
    def steps(self) -> tuple[FoldStep, ...]:
        """Steps that reduce any 64-bit word to its remainder. Empty if the CRC cannot be folded."""
        return fold_plan(self.crc.width, self.crc.poly, _WORD) if self.form is Form.FOLD else ()


def carriers(device: Device, crc: Crc) -> tuple[Carrier, ...]:
    """Return the carriers of a CRC in frames and registers.

    For an unused CRC, the parameters decide. Reflected input is defined only for bytes, and a width of whole bytes
    suggests bytes.
    """
    layouts = [layout for _, layout in device.layouts()]
    layouts += (register.layout for register in device.registers)
    used = {carrier_of(layout).value for layout in layouts if _ends_in(layout, crc)}
    if not used:
        return (Carrier.BYTES,) if crc.refin or crc.width % 8 == 0 else (Carrier.BITS,)
    return tuple(carrier for carrier in (Carrier.BYTES, Carrier.BITS) if carrier.value in used)


def carrier_of(layout: Layout) -> Carrier:
    """Return the carrier of the CRC at the end of a layout."""
    return Carrier.BYTES if layout.crc_covers_bytes else Carrier.BITS


def crc_functions(device: Device) -> Iterator[CrcFunction]:
    """Yield the functions of a family in the order of its CRCs, those over bytes before those over bits."""
    for crc in device.crcs:
        crc_carriers = carriers(device, crc)
        in_words = any(not layout.in_bytes and _ends_in(layout, crc) for _, layout in device.layouts())
        for carrier in crc_carriers:
            form = Form.TABLE if covers_part(device, crc) else form_of(crc, carrier)
            yield CrcFunction(crc, carrier, form, len(crc_carriers) == 1, in_words)


def function_of(device: Device, layout: Layout) -> CrcFunction | None:
    """Return the function for the CRC at the end of a layout, or None."""
    functions = (function for function in crc_functions(device) if function.carrier is carrier_of(layout))
    return next((function for function in functions if _ends_in(layout, function.crc)), None)


def folds(crc: Crc) -> bool:
    """Return whether a word with this CRC can be reduced to its remainder without a table."""
    has_few_terms = crc.poly & 1 and crc.poly.bit_count() <= 2
    return bool(has_few_terms) and crc.init == 0 and not crc.refin and not crc.refout and not crc.is_xor


def fold_steps(crc: Crc, bits: int) -> tuple[FoldStep, ...]:
    """Return the steps that fold a frame of at most ``bits`` bits, or none if the CRC cannot be folded."""
    return fold_plan(crc.width, crc.poly, bits) if folds(crc) and bits <= _WORD else ()


def divides(crc: Crc, layout: Layout) -> bool:
    """Return whether code checks a word, with its final XOR removed, by dividing it by the polynomial."""
    whole = not layout.in_bytes and crc.init == 0 and not crc.refout
    return whole and (folds(crc) or 8 <= crc.width <= 32)


def form_of(crc: Crc, carrier: Carrier) -> Form:
    """Return the form in which code computes a CRC over this carrier."""
    if carrier is Carrier.BITS:
        return Form.FOLD if folds(crc) and crc.width <= _WIDEST_FOLD else Form.TABLE
    return Form.XOR if crc.is_xor else Form.TABLE


def _ends_in(layout: Layout, crc: Crc) -> bool:
    return any(isinstance(field.kind, CrcValue) and field.kind.crc == crc.name for field in layout.fields)


def covers_part(device: Device, crc: Crc) -> bool:
    """Return whether the CRC covers only a part of some frame."""
    fields = (field for _, layout in device.layouts() for field in layout.fields)
    return any(isinstance(field.kind, CrcValue) and field.kind.crc == crc.name and field.kind.of for field in fields)
