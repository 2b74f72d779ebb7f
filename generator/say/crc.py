"""Statements about a CRC."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Crc, Device
from .erratum import errata, erratum
from .text import Statement, spec_text, statement
from .words import counted


def crc(device: Device, checksum: Crc) -> Iterator[Statement]:
    """Yield all statements about it in order, for running text."""
    yield head(device, checksum)
    yield from spec_text(checksum.note)
    yield from map(erratum, errata(device, f"crcs.{checksum.name}"))


def head(device: Device, checksum: Crc) -> Statement:
    """Return its parameters in one sentence."""
    return statement(
        f"CRC {checksum.name} of {counted(checksum.width, 'bit')}: {parameters(device, checksum)}",
        source=checksum.source,
    )


def parameters(device: Device, checksum: Crc) -> str:
    """Return polynomial, start value, reflection and final XOR."""
    start = f"start value {f'0x{checksum.init:X}' if checksum.init else 0}"
    return ", ".join(filter(None, (checksum.polynomial, start, reflected(device, checksum), sent(checksum))))


def reflected(device: Device, checksum: Crc) -> str:
    """Return whether the input and the output are reflected, or an empty string if neither is."""
    sides = {"input": device.reflects_input(checksum), "output": checksum.refout}
    reflected_words = [side for side, is_reflected in sides.items() if is_reflected]
    return f"{' and '.join(reflected_words)} reflected" if reflected_words else ""


def sent(checksum: Crc) -> str:
    """Return how the remainder is changed before it is sent."""
    if checksum.xorout == checksum.mask:
        return "sent inverted"
    return f"sent after an XOR with 0x{checksum.xorout:X}" if checksum.xorout else "sent unchanged"


def inverted(checksum: Crc) -> str:
    """Return in two words how the remainder is changed before it is sent."""
    return {0: "not inverted", checksum.mask: "inverted"}.get(checksum.xorout, f"XOR {checksum.xorout:#X}")
