"""Statements about a CRC."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Crc, Device
from .erratum import errata, erratum
from .text import Said, said, told
from .words import counted


def crc(device: Device, item: Crc) -> Iterator[Said]:
    """Yield all statements about it in order, for running text."""
    yield head(item)
    yield from told(item.note)
    yield from map(erratum, errata(device, f"crcs.{item.name}"))


def head(item: Crc) -> Said:
    """Return its parameters in one sentence."""
    return said(f"CRC {item.name} of {counted(item.width, 'bit')}: {parameters(item)}", source=item.source)


def parameters(item: Crc) -> str:
    """Return polynomial, start value, reflection and final XOR."""
    start = f"start value {f'0x{item.init:X}' if item.init else 0}"
    turned = {
        (True, True): "input and output reflected",
        (True, False): "input reflected",
        (False, True): "output reflected",
    }
    return ", ".join(filter(None, (item.polynomial, start, turned.get((item.refin, item.refout), ""), sent(item))))


def sent(item: Crc) -> str:
    """Return how the remainder is changed before it is sent."""
    if item.xorout == item.mask:
        return "sent inverted"
    return f"sent after an XOR with 0x{item.xorout:X}" if item.xorout else "sent unchanged"


def inverted(item: Crc) -> str:
    """Return in two words how the remainder is changed before it is sent."""
    return {0: "not inverted", item.mask: "inverted"}.get(item.xorout, f"XOR {item.xorout:#X}")
