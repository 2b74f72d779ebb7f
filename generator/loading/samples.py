"""Make up a frame for every layout that an encoder sends, for programs and pages that show one.

They are encoded by the reference codec, so that no output shows a frame that it has encoded itself.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress

from ..model import (
    Choice,
    Constant,
    CrcExample,
    CrcValue,
    Decimal,
    Device,
    Field,
    Flag,
    Interface,
    Layout,
    MeasureExample,
    Number,
    Parity,
    PlacedLayout,
    Sample,
    Sources,
    Text,
    Unused,
    Values,
    Variant,
    Verdict,
    assert_never,
)
from ..order_codes.labels import UnknownOrderCode
from ..reference import codec
from .examples import example_variant


def samples(device: Device) -> tuple[Sample, ...]:
    """Return the frames of every interface, for the order code that the manual shows most."""
    try:
        return tuple(sample for interface in device.interfaces for sample in _of_interface(device, interface))
    except UnknownOrderCode:  # of an example, which has been reported in the spec that this edition is based on
        return ()


def _of_interface(device: Device, interface: Interface) -> Iterator[Sample]:
    variant = _most_shown(device, interface.name)
    for layout in interface.layouts:
        if variant is not None and layout.sender == "encoder":
            with suppress(codec.EncodeError):
                yield _sample(device, variant, layout)


def _most_shown(device: Device, interface: str) -> Variant | None:
    """Return the order code with the most examples that are used as printed, or the one with the finest resolution."""
    examples = [example for example in device.examples if not isinstance(example, CrcExample)]
    counted = Counter(example_variant(device, example).code for example in examples if not example.erratum)
    return max(
        device.variants_over(interface),
        key=lambda variant: (counted[variant.code], sum(variant.parameters.values())),
        default=None,
    )


def _sample(device: Device, variant: Variant, layout: Layout) -> Sample:
    """Return a frame with the position of a worked example if there is one, or else with made-up values only."""
    placed = layout.place(variant.parameters)
    data_fields = [placed_field for placed_field in placed.fields if placed_field.field.carries_data]
    values = {field.name: _value(field.field, field.width, layout) for field in data_fields}
    measurement = device.measurement_of(variant.interface)
    worked = (example for example in device.examples if isinstance(example, MeasureExample))
    measured = next((example for example in worked if example_variant(device, example) == variant), None)
    if measurement is not None and measured is not None and measurement.of in layout.member_names:
        parts = layout.names_in(measurement.of)
        other_values = {name: value for name, value in values.items() if name not in parts}
        with suppress(codec.EncodeError):  # a position that does not fit
            return _encoded(device, placed, variant, {**other_values, measurement.of: measured.counts}, measured.source)
    return _encoded(device, placed, variant, values)


def _value(field: Field, width: int, layout: Layout) -> int | str | bool:
    """Return an invented value for a field."""
    if field.name == layout.selector:
        return layout.selects[0]
    match field.kind:
        case Number(power_of_two=True):
            return 1 << width // 2
        case Number(signed=signed, zero_means=zero_means):
            return max(_number(width - signed), 1 if zero_means else 0)
        case Flag():
            return False
        case Choice(values):
            harmless = (value for value in values if value.makes_position in (None, Verdict.USABLE))
            return next(harmless, values[0]).value
        case Decimal():
            return 1
        case Text():
            return "A" * (width // 8)
        case Constant() | Unused() | CrcValue() | Parity():
            raise codec.EncodeError(f"'{field.name}' carries no data")
        case kind:
            assert_never(kind)


def _number(bits: int) -> int:
    """Return a number of this width."""
    return 123456789 % (1 << bits) if bits > 16 else min(42, (1 << bits) - 1)


def _encoded(device: Device, placed: PlacedLayout, variant: Variant, values: Values, source: Sources = ()) -> Sample:
    number = codec.encode(device, placed, values)
    plain = codec.from_gray(placed, number)
    flags = placed.layout.spoiling_flags
    fields = {field.name: values[field.name] for field in placed.fields if field.name in values}
    return Sample(
        order_code=variant.code,
        layout=placed.layout.name,
        frame=number,
        values=fields | {join.name: codec.join_value(placed, join, plain) for join in placed.layout.joins},
        spoilt=codec.encode(device, placed, {**values, flags[0].name: True}) if flags else None,
        source=source,
    )
