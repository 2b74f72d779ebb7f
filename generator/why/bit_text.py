"""The text of a frame that is one number."""

from __future__ import annotations

from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class BitText:
    """A frame as typed, with ``bits`` bits, or at least that many if the text does not show leading zeros."""

    number: int
    bits: int
    exact: bool
