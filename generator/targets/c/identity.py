"""Identification in C: the registers that identify an encoder, and the order codes that their contents allow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...model import Interface
from ...model.expressions import Expression
from ...model.record import dataclass
from ...plan.registers import identities
from .context import Context
from .names import Declared
from .registers import RegisterCode


@dataclass(frozen=True, slots=True)
class IdentityCode:
    """The identifying registers of one interface. One with a codec is decoded, one without is compared as a byte."""

    prefix: str
    interface: Interface
    compared: tuple[RegisterCode, ...]

    @property
    def uses_variant(self) -> bool:
        stated = (register.layout.fields[0].equals for register in self.compared if register.codec is None)
        varies = any(isinstance(equals, Expression) and not equals.is_constant for equals in stated)
        return varies or any(register.codec is not None for register in self.compared)

    def declared(self) -> Iterator[Declared]:
        names = ("identity", "could_be", "next_candidate", "read_identity")
        yield from ((f"{self.prefix}_{name}", ()) for name in names)


def identity_codes(context: Context, codes: Mapping[str, RegisterCode]) -> Iterator[IdentityCode]:
    for identity in identities(context.device):
        compared = tuple(codes[comparison.register.name] for comparison in identity.compared)
        yield IdentityCode(context.prefix, context.device.interface(identity.interface), compared)
