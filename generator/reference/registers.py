"""Decode registers by name."""

from __future__ import annotations

from ..model import NOT_KNOWN, Device, Erratum, Variant, cite, number_from_bytes
from ..order_codes.parameters import RegisterError
from ..say.frame_text import register_length
from ..say.words import counted
from . import codec


def decode_register(device: Device, variant: Variant, name: str, data: bytes) -> codec.Decoded:
    """Return the value of a register from its bytes in ascending order of address.

    Raises:
        RegisterError: This interface has no such register, or the register has a different length.
    """
    registers = {register.name: register for register in device.registers_over(variant.interface)}
    register = registers.get(name.lower())
    if register is None:
        problem = next(filter(None, (_not_known(device, erratum, name.lower()) for erratum in device.errata)), "")
        if problem:
            raise RegisterError(problem)
        available = f"it has: {', '.join(registers)}" if registers else "it has none"
        raise RegisterError(f"{variant.code} has no register '{name}'; {available}")
    if len(data) != register.length:
        needed, actual = counted(register.length, "byte"), counted(len(data), "byte")
        raise RegisterError(register_length(register.name, needed, actual))
    return codec.decode(device, register.layout.place(variant.parameters), number_from_bytes(register.layout, data))


def _not_known(device: Device, erratum: Erratum, name: str) -> str:
    """Return the message that this edition or overlay does not define a register, or an empty string if it does."""
    scope = (
        f"in edition {device.edition} of the manual"
        if erratum.edition
        else f"according to the overlay {erratum.overlay}"
    )
    if erratum.used != NOT_KNOWN or not (erratum.overlay or device.edition) or name not in erratum.printed.split(", "):
        return ""
    return f"'{name}' is unknown {scope}: {erratum.why} [{cite(erratum.source)}]"
