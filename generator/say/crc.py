"""Statements about a CRC."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Crc, Device
from .erratum import errata, erratum
from .text import Said, said, told
from .words import counted


def crc(device: Device, item: Crc) -> Iterator[Said]:
    """Yield all statements about it in order, for running text."""
    yield head(device, item)
    yield from told(item.note)
    yield from map(erratum, errata(device, f"crcs.{item.name}"))


def head(device: Device, item: Crc) -> Said:
    """Return its parameters in one sentence."""
    return said(f"CRC {item.name} of {counted(item.width, 'bit')}: {parameters(device, item)}", source=item.source)


def parameters(device: Device, item: Crc) -> str:
    """Return polynomial, start value, reflection and final XOR."""
    start = f"start value {f'0x{item.init:X}' if item.init else 0}"
    return ", ".join(filter(None, (item.polynomial, start, reflected(device, item), sent(item))))


def reflected(device: Device, item: Crc) -> str:
    """Return whether the input and the output are reflected, or an empty string if neither is."""
    turned = [words for words, value in (("input", device.reflects_input(item)), ("output", item.refout)) if value]
    return f"{' and '.join(turned)} reflected" if turned else ""


def sent(item: Crc) -> str:
    """Return how the remainder is changed before it is sent."""
    if item.xorout == item.mask:
        return "sent inverted"
    return f"sent after an XOR with 0x{item.xorout:X}" if item.xorout else "sent unchanged"


def inverted(item: Crc) -> str:
    """Return in two words how the remainder is changed before it is sent."""
    return {0: "not inverted", item.mask: "inverted"}.get(item.xorout, f"XOR {item.xorout:#X}")
