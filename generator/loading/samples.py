"""Sample frames with made-up values, and devices with only some order codes, which need other sample frames.

The reference codec encodes them, so that no output shows a frame that its own code has encoded.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from ..language.problems import nearest_choice
from ..model import (
    Choice,
    CrcExample,
    Decimal,
    Device,
    Field,
    Flag,
    Interface,
    Layout,
    MeasureExample,
    Number,
    PlacedLayout,
    Sample,
    Sources,
    Text,
    Values,
    Variant,
    Verdict,
)
from ..order_codes.labels import UnknownOrderCode
from ..order_codes.reduction import for_codes
from ..reference.bits_and_values import join_value, to_binary
from ..reference.codec import EncodeError, encode
from .examples import example_variant
from .overlays import Family as Family

#: Position that also fits encoders whose counts per turn are not a power of two.
_LOW_POSITION = 42


def sample_frames(device: Device) -> tuple[Sample, ...]:
    """Return the sample frames of every interface, or ``()`` if an example has an unknown order code."""
    samples_of_all: list[Sample] = []
    try:
        for interface in device.interfaces:
            samples_of_all += _yield_samples(device, interface)
    except UnknownOrderCode:  # The example is reported in the spec that this edition is based on.
        return ()
    return tuple(samples_of_all)


def _yield_samples(device: Device, interface: Interface) -> Iterator[Sample]:
    """Yield a frame for each layout that the encoder sends and that can be encoded, for one order code."""
    variant = _most_used_order_code(device, interface.name)
    if variant is None:
        return
    for layout in interface.layouts:
        if layout.sender == "encoder":
            with suppress(EncodeError):
                yield _build_sample(device, variant, layout)


def _most_used_order_code(device: Device, interface: str) -> Variant | None:
    """Return the order code that most worked examples use, or None if the interface has no order code.

    Examples of CRCs and corrected examples do not count. Of several such codes, the one with the largest sum of
    parameters is returned, which usually has the finest resolution.
    """
    example_count_by_code: Counter[str] = Counter()
    for example in device.examples:
        if not isinstance(example, CrcExample) and not example.erratum:
            example_count_by_code[example_variant(device, example).code] += 1

    def examples_then_resolution(variant: Variant) -> tuple[int, int]:
        return example_count_by_code[variant.code], sum(variant.parameters.values())

    return max(device.variants_over(interface), key=examples_then_resolution, default=None)


def _build_sample(device: Device, variant: Variant, layout: Layout) -> Sample:
    """Return a sample frame with the position of a worked example, if it fits, and made-up values in all other fields.

    Raises:
        EncodeError: The made-up values cannot be encoded.
    """
    placed_layout = layout.place(variant.parameters)
    data_fields = [placed_field for placed_field in placed_layout.fields if placed_field.field.carries_data]
    made_up_values = {field.name: _made_up_value(field.field, field.width, layout) for field in data_fields}
    measurement = device.measurement_of(variant.interface)
    worked_example = _worked_example(device, variant)
    encode_sample = partial(_encoded_sample, device, placed_layout, variant)
    if measurement is None or measurement.position_name not in layout.member_names:
        return encode_sample(made_up_values)
    position_field_names = layout.field_names_of(measurement.position_name)
    # The position may consist of several fields. It replaces their values.
    other_values = {
        field_name: made_up_value
        for field_name, made_up_value in made_up_values.items()
        if field_name not in position_field_names
    }
    if worked_example is not None:
        values_with_position = {**other_values, measurement.position_name: worked_example.counts}
        with suppress(EncodeError):  # The position may not fit.
            return encode_sample(values_with_position, source=worked_example.source)
    with suppress(EncodeError):  # The made-up number may be above the highest position.
        return encode_sample(made_up_values)
    return encode_sample({**other_values, measurement.position_name: _LOW_POSITION})


def _worked_example(device: Device, variant: Variant) -> MeasureExample | None:
    """Return the first worked example of a position with this order code, or None if there is none."""
    for example in device.examples:
        if isinstance(example, MeasureExample) and example_variant(device, example) == variant:
            return example
    return None


def _made_up_value(field: Field, width: int, layout: Layout) -> int | str | bool:
    """Return a made-up value for a field, or raise an ``EncodeError`` if the field carries no data.

    The values are harmless: flags are inactive, and a named value leaves the position usable if the field has such a
    value.
    """
    if field.name == layout.selector:
        return layout.selects[0]
    if not field.carries_data:
        raise EncodeError(f"'{field.name}' carries no data")
    digit_code = field.code_of_digits
    if digit_code is not None:
        return min(_made_up_number(width), digit_code.highest(width))
    match field.kind:
        case Number(power_of_two=True):
            # The power of two in the middle of the range.
            return 1 << (width // 2)
        case Number(signed=is_signed, zero_means=zero_means):
            # A signed field has one bit less for positive numbers.
            magnitude_bit_count = width - 1 if is_signed else width
            number = _made_up_number(magnitude_bit_count)
            # If a stored zero represents a different number, the value of the field is never 0.
            return max(number, 1) if zero_means else number
        case Flag():
            return False
        case Choice(values):
            harmless_values = [value for value in values if value.makes_position in (None, Verdict.USABLE)]
            return (harmless_values or values)[0].value
        case Decimal():
            return 1
        case Text():
            return "A" * (width // 8)
        case _:
            return field.kind.value_at_rest


def _made_up_number(bits: int) -> int:
    """Return a made-up number that fits into ``bits`` bits: 42 if that fits, or a larger one for more than 16 bits."""
    if bits > 16:
        return 123456789 % (1 << bits)
    highest = (1 << bits) - 1
    return min(42, highest)


def _encoded_sample(
    device: Device, placed_layout: PlacedLayout, variant: Variant, value_by_field: Values, source: Sources = ()
) -> Sample:
    """Return a sample frame with these values, and the same frame with an active flag that makes decoders reject it.

    The second frame is None if the layout has no such flag.
    """
    frame_number = encode(device, placed_layout, value_by_field)
    binary_number = to_binary(placed_layout, frame_number)
    decoded_values = {
        field.name: value_by_field[field.name] for field in placed_layout.fields if field.name in value_by_field
    }
    decoded_values |= {join.name: join_value(placed_layout, join, binary_number) for join in placed_layout.layout.joins}
    rejected_frame = None
    if placed_layout.spoiling_flags:
        spoiling_flag = placed_layout.spoiling_flags[0]
        rejected_frame = encode(device, placed_layout, {**value_by_field, spoiling_flag.name: True})
    return Sample(
        order_code=variant.code,
        layout=placed_layout.layout.name,
        frame=frame_number,
        values=decoded_values,
        spoilt=rejected_frame,
        source=source,
    )


class UnknownName(ValueError):
    """A name matches no order code, interface or family. The message lists the existing names or suggests one."""


def narrowed_to(devices: Sequence[Device], selection: str) -> tuple[Device, ...]:
    """Return the devices with only the order codes that a user's selection names, or all devices if it is empty.

    ``selection`` is a list of names, separated by commas: order codes, interfaces, families, or a family with one of
    its interfaces, such as ``x_24_ssi``. Devices without such an order code are left out.

    Raises:
        UnknownName: A name matches no order code, interface or family.
    """
    selected_names = [selected_name.strip() for selected_name in selection.split(",") if selected_name.strip()]
    if not selected_names:
        return tuple(devices)
    known_names: set[str] = set()
    for device in devices:
        for variant in device.variants:
            known_names.update(_names_of_code(device, variant))
    for selected_name in selected_names:
        if selected_name.upper() not in known_names:
            raise UnknownName(_unknown_message(devices, selected_name))
    uppercase_names = {selected_name.upper() for selected_name in selected_names}
    narrowed_devices = []
    for device in devices:
        order_codes = {
            variant.code for variant in device.variants if uppercase_names & set(_names_of_code(device, variant))
        }
        if order_codes:
            narrowed_device = for_codes(device, order_codes)
            # The sample frames in programs and pages must belong to one of the remaining order codes.
            narrowed_devices.append(replace(narrowed_device, samples=sample_frames(narrowed_device)))
    return tuple(narrowed_devices)


def _names_of_code(device: Device, variant: Variant) -> tuple[str, ...]:
    """Return the names by which users can select an order code, in uppercase.

    These are the order code, the interface, the family, and the family with the interface, such as ``X_24_SSI``.
    """
    family_name = device.name.upper()
    interface_name = variant.interface.upper()
    return variant.code.upper(), interface_name, family_name, f"{family_name}_{interface_name}"


def _yield_suggestions(devices: Sequence[Device]) -> Iterator[str]:
    """Yield the names of families, of families with an interface such as ``x_24_ssi``, and of interfaces."""
    interface_names: set[str] = set()
    for device in devices:
        yield device.name
        for interface in device.interfaces:
            interface_names.add(interface.name)
            yield f"{device.name}_{interface.name}"
    yield from sorted(interface_names)


def _unknown_message(devices: Sequence[Device], unknown_name: str) -> str:
    """Return the message about an unknown name, with the nearest name or, if none is similar, the valid names.

    If the word begins with the name of a family, the valid names are the order codes of this family.
    """
    all_codes: list[str] = []
    codes_of_named_families: list[str] = []
    for device in devices:
        order_codes = [variant.code for variant in device.variants]
        all_codes += order_codes
        if unknown_name.upper().startswith(device.name.upper()):
            codes_of_named_families += order_codes
    suggested_names = list(_yield_suggestions(devices))
    lowercase_codes = [code.lower() for code in codes_of_named_families]
    nearest_name = nearest_choice(unknown_name, [*suggested_names, *codes_of_named_families, *lowercase_codes])
    if nearest_name:
        hint = f"did you mean '{nearest_name}'?"
    else:
        example_code = all_codes[0] if all_codes else ""
        valid_names = codes_of_named_families or [f"order codes, such as {example_code}", *suggested_names]
        hint = f"valid are {', '.join(valid_names)}"
    return f"there is no order code, interface or family '{unknown_name}'; {hint}"
