# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Families in one manufacturer's package. Finds the encoder for a label, and identifies encoders by their registers."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, NamedTuple, NoReturn

from .codec import Data
from .encoder import Encoder
from .order_codes import OrderCodeError, check_label, find_nearest


class Package(NamedTuple):
    """Package of a manufacturer. The modules of its families are loaded on first use.

    Attributes:
        name: Name of the package.
        beginnings: Prefixes of the order codes of each family, without spaces, by the name of its module.
        specials: Modules of special models, each with the suffix of their order codes without the slash.
        identified: Modules of the families that can be identified by registers.
    """

    name: str
    beginnings: Mapping[str, tuple[str, ...]]
    specials: tuple[tuple[str, str], ...] = ()
    identified: tuple[str, ...] = ()

    def lookup(self, label: str) -> Encoder:
        """Return the encoder for a label, from any family of the manufacturer.

        Raises OrderCodeError if no family has this code.
        """
        text = check_label(label)
        # A special model, such as S001, is the text after the last slash of a label. Its families are tried first.
        families = [family for family, special in self.specials if text.upper().endswith(f"/{special}")]
        families += [family for family, prefixes in self.beginnings.items() if text.startswith(prefixes)]
        best_encoder: Encoder | None = None
        for family in families:
            try:
                encoder: Encoder = self._import_module(family).lookup(text)
            except OrderCodeError:
                continue  # Several families can have special models of that name, or codes with that prefix.
            # The tail is the text of the label after the order code. It can be part of the order code of another
            # family, so the encoder with the shortest tail is the best.
            if best_encoder is None or len(encoder.tail) < len(best_encoder.tail):
                best_encoder = encoder
            if not best_encoder.tail:
                return best_encoder
        return best_encoder if best_encoder is not None else self._raise_unknown_label(text)

    def identify(self, read: Mapping[int, int] | Mapping[str, Data]) -> tuple[str, ...]:
        """Return the order codes of all families whose encoders have these values in their registers.

        ``read`` contains bytes by address, or whole registers by name. Raises ValueError if no family has these
        registers.
        """
        codes: list[str] = []
        errors: list[ValueError] = []
        for family in self.identified:
            try:
                codes += self._import_module(family).identify(read)
            except ValueError as error:
                errors.append(error)
        # A family without these registers raises an error. If all do, the registers are wrong.
        if len(errors) == len(self.identified):
            raise errors[0]
        return tuple(codes)

    def _import_module(self, family: str) -> Any:
        """Return the module of a family, which is loaded on first use."""
        return import_module(f".{family}", self.name)

    def _raise_unknown_label(self, text: str) -> NoReturn:
        """Raise OrderCodeError for an unknown label, with the most helpful message.

        The message names the wrong part of an order code, or lists similar order codes.
        """
        modules = [self._import_module(family) for family in self.beginnings]
        for module in modules:
            try:
                module.lookup(text)
            except OrderCodeError as error:
                # The error names the wrong part of a code of this family.
                if error.part:
                    raise
        codes = [code for module in modules for code in module.VARIANTS]
        raise OrderCodeError(text, "", "is not an order code of these encoders", find_nearest(codes, text))
