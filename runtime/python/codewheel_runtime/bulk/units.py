# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Units of positions and speeds, and the size of a count in them."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import tau
from typing import Any, Final, Literal

#: Units for positions and speeds.
Unit = Literal["counts", "turns", "degrees", "radians", "micrometres", "millimetres", "metres"]
#: Units of encoders that measure angles, and of those that measure lengths.
AngleUnit = Literal["counts", "turns", "degrees", "radians"]
LengthUnit = Literal["counts", "micrometres", "millimetres", "metres"]
#: Units for speeds: a unit per second, or revolutions per minute.
SpeedUnit = Unit | Literal["rpm"]

#: Size of one turn in each unit of angle, and of each unit of length in micrometers.
_UNITS_PER_TURN: Final[Mapping[str, float]] = {"turns": 1, "degrees": 360, "radians": tau}
_MICROMETERS_PER_UNIT: Final[Mapping[str, int]] = {"micrometres": 1, "millimetres": 1_000, "metres": 1_000_000}
POSITION_UNITS: Final = ("counts", *_UNITS_PER_TURN, *_MICROMETERS_PER_UNIT)


class UnitError(ValueError, AttributeError):
    """The encoder does not measure in this unit. The message lists the units that it measures in."""


def find_unit_size(encoder: Any, unit: str) -> tuple[float, int]:
    """Return the size of one count in a unit, as numerator and denominator: ``(360, 65536)`` for degrees.

    ``encoder`` is the encoder, or None for frames that belong to no encoder.

    Raises:
        UnitError: The unit is a length and the encoder measures angles, or the other way around.
        ValueError: The unit is not a unit of positions.
    """
    if unit == "counts":
        return 1, 1
    if unit in _UNITS_PER_TURN:
        if not hasattr(encoder, "from_turns"):
            raise UnitError(_wrong_unit_message(encoder, unit, _UNITS_PER_TURN))
        counts_per_turn: int = encoder.from_turns(1)
        return _UNITS_PER_TURN[unit], counts_per_turn
    if unit in _MICROMETERS_PER_UNIT:
        if not hasattr(encoder, "micrometres"):
            raise UnitError(_wrong_unit_message(encoder, unit, _MICROMETERS_PER_UNIT))
        micrometers_per_count = Fraction(encoder.micrometres(1))
        micrometers_per_unit = _MICROMETERS_PER_UNIT[unit]
        return micrometers_per_count.numerator, micrometers_per_count.denominator * micrometers_per_unit
    explanation = "; it is a unit of speed" if unit == "rpm" else ""
    raise ValueError(f"'{unit[:40]}' is not a unit of positions{explanation}: use {', '.join(POSITION_UNITS)}")


def _wrong_unit_message(encoder: Any, unit: str, units_of_same_kind: Mapping[str, float]) -> str:
    """Return the message for a unit that the encoder does not support, with the units that it supports.

    ``units_of_same_kind`` contains either all units of angles or all units of lengths, including ``unit``.
    """
    if encoder is None:
        return f"these frames belong to no encoder, so they have no {unit}: use counts"
    is_length = units_of_same_kind is _MICROMETERS_PER_UNIT
    measured = "angles, not lengths" if is_length else "lengths, not angles"
    supported_units = _UNITS_PER_TURN if is_length else _MICROMETERS_PER_UNIT
    units_text = ", ".join(("counts", *supported_units))
    return f"{encoder.code} measures {measured}: use {units_text} instead of {unit}"
