"""The position of a decoded frame in words, with its angle or length."""

from __future__ import annotations

from ...model import Device, Measurement, Variant, Verdict
from ...model.expressions import Expression
from ...reference import codec
from ...say.plain_text import decimal


def position_text(device: Device, variant: Variant, decoded: codec.DecodedFrame, verdict: Verdict | None) -> str:
    """Return the position in µm or degrees, such as ``position: 90.0°``, or "" if it is not usable or not known.

    If the frame contains only a part of the position, the part with the lowest bits is shown.
    """
    measurement = device.measurement_of(variant.interface)
    if verdict in (None, Verdict.NOT_USABLE) or measurement is None or decoded.layout is None:
        return ""
    measurement = measurement.within(decoded.layout.layout.position_range)
    field_name = measurement.of
    # A frame without the multiturn part of a joined position contains only the part with the lowest bits.
    if field_name not in decoded.values:
        field_name = _lowest_joined_field(device, variant, field_name)
    counts = decoded.values.get(field_name)
    if not isinstance(counts, int):
        return ""
    micrometers_per_count = measurement.micrometres(variant.parameters)
    if micrometers_per_count is not None:
        return f"{field_name}: {decimal(counts * micrometers_per_count)} µm"
    return _angle_text(measurement, variant, field_name, counts)


def _lowest_joined_field(device: Device, variant: Variant, name: str) -> str:
    """Return the field with the lowest bits of a joined number, or ``name`` if it is not a joined number."""
    for layout in device.interface(variant.interface).layouts:
        for join in layout.joins:
            if join.name == name:
                return join.fields[-1]
    return name


def _angle_text(measurement: Measurement, variant: Variant, name: str, counts: int) -> str:
    """Return a position in counts as an angle: ``singleturn: 90.0°``, or ``position: 90.0° of revolution 3``.

    The revolution is only given for the whole position of a multiturn encoder. If the counts per turn are not known,
    the text is "".
    """
    counts_per_turn = _value_or_zero(measurement.counts_per_turn, variant)
    turns = _value_or_zero(measurement.turns, variant)
    if counts_per_turn < 1:
        return ""
    turn, counts_in_turn = divmod(counts, counts_per_turn)
    degrees = counts_in_turn * 360 / counts_per_turn
    # One decimal for each digit of the counts per degree, so that adjacent counts have different texts.
    decimals = len(str(counts_per_turn // 360))
    angle = f"{name}: {degrees:.{decimals}f}°"
    has_revolution = turns > 1 and name == measurement.of
    return f"{angle} of revolution {turn:,}" if has_revolution else angle


def _value_or_zero(expression: Expression | None, variant: Variant) -> int:
    return expression.value(variant.parameters) if expression is not None else 0
