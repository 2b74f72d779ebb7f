"""Find positions with more bits than their counts need, which are often a mistake in the spec."""

from __future__ import annotations

from ..language.document import Path
from ..language.files import is_second
from ..language.problems import DocumentReport
from ..model import Device, Field, Interface, Layout, Measurement, Variant
from ..model.expressions import Expression, is_power_of_two


def check_position_widths(device: Device, report: DocumentReport) -> None:
    """Report a position with more bits than its counts need, unless a note of the field explains it.

    Zeros above a position are accepted if no order code uses all bits of the field, and the field has whole bytes or
    order codes need different widths.
    """
    # A second reading of the manual only repeats printed facts, without notes.
    if is_second(report.document.file):
        return
    for interface in device.interfaces:
        measurement = device.measurement_of(interface.name)
        if measurement is None or measurement.highest is not None or measurement.counts_per_turn is None:
            continue
        for layout in interface.layouts:
            field = _position_field(layout, measurement)
            if field is not None and layout.sender == "encoder":
                _check_width(device, interface, layout, field, report)


def _position_field(layout: Layout, measurement: Measurement) -> Field | None:
    """Return the field that contains the whole position, if its width can be compared with the counts, or None.

    The field must be unsigned, binary and without padding, with a constant width and without a note.
    """
    names = layout.names_in(measurement.of)
    if len(names) != 1:
        return None
    (position_name,) = names
    field = next((candidate for candidate in layout.fields if candidate.name == position_name), None)
    if field is None:
        return None
    is_binary = not field.number.signed and not field.kind.digit_code
    is_plain = field.width.is_constant and not field.note and is_binary
    # The container is 0 for a field without 'padded_to'.
    is_unpadded = field.container in (0, field.width.constant)
    return field if is_plain and is_unpadded else None


def _check_width(device: Device, interface: Interface, layout: Layout, field: Field, report: DocumentReport) -> None:
    """Report a position field with more bits than the counts of an order code need.

    Nothing is reported if the counts of an order code are not a power of two, or do not fit into the field.
    """
    measurement = device.measurement_of(interface.name)
    assert measurement is not None
    width = field.width.constant
    bits_by_code = {
        variant.code: _needed_bits(measurement, variant) for variant in device.variants_over(interface.name)
    }
    fewer_bits_by_code = {code: bits for code, bits in bits_by_code.items() if bits is not None and bits < width}
    needed_widths = set(bits_by_code.values())
    if not fewer_bits_by_code or any(bits is None or bits > width for bits in needed_widths):
        return
    code, bits = next(iter(fewer_bits_by_code.items()))
    fills_width = width in needed_widths
    is_whole_bytes = width % 8 == 0
    if not fills_width and (is_whole_bytes or len(needed_widths) > 1):
        return
    owner_path: Path = ("interfaces", interface.name, "layouts", layout.name)
    if field.group:
        owner_path = ("field_groups", field.group)
    message = f"'{field.name}' always has {width} bits, but the counts of {code} need {bits}"
    correct_width = _corrected_width(measurement, fills_width, bits)
    report.add(
        "measurement-does-not-fit",
        (*owner_path, "fields", field.name),
        f"{message}; write '{correct_width}', or add a 'note' about the bits above them",
    )


def _corrected_width(measurement: Measurement, fills_width: bool, bits: int) -> str:
    """Return the corrected key of a position field that is too wide, such as ``bits: 24``.

    If another order code uses all bits of the field, the width must be a parameter. For 2^position_bits counts per
    turn, this is position_bits.
    """
    if not fills_width:
        return f"bits: {bits}"
    counts = measurement.counts_per_turn
    assert counts is not None
    counts_text = counts.render()
    is_power_of_parameter = counts_text.startswith("2^") and counts_text[2:].isidentifier()
    return f"bits: {counts_text[2:]}" if is_power_of_parameter else "bits: PARAMETER"


def _needed_bits(measurement: Measurement, variant: Variant) -> int | None:
    """Return the number of bits for all positions of an order code, or None if their number is not a power of two."""
    counts = _value_or_one(measurement.counts_per_turn, variant) * _value_or_one(measurement.turns, variant)
    # The number 2^12 itself has 13 bits, but the positions 0 to 2^12 - 1 need 12 bits.
    return counts.bit_length() - 1 if is_power_of_two(counts) else None


def _value_or_one(expression: Expression | None, variant: Variant) -> int:
    """Return the value of an expression for an order code, or 1 if there is no expression."""
    return 1 if expression is None else expression.value(variant.parameters)
