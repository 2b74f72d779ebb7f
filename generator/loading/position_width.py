"""Check that a position of fixed width is as wide as its counts."""

from __future__ import annotations

from ..language.problems import DocumentReport, Path
from ..language.schema_files import is_second
from ..model import Device, Field, Interface, Layout, Measurement, Variant
from ..model.expressions import Expression


def check_position_widths(device: Device, report: DocumentReport) -> None:
    """Report a position with too many bits for its counts, unless a note of the field explains it.

    Whole bytes may begin with zeros, as manuals draw them. So may a position in fewer bits than any order code has.
    """
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
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
    """Return the field that is the whole position, if its width is the same for every order code and unexplained."""
    names = layout.names_in(measurement.of)
    field = next((field for field in layout.fields if list(names) == [field.name]), None)
    if field is None:
        return None
    is_plain = field.width.is_constant and not field.note and not field.number.signed
    return field if is_plain and field.container in (0, field.width.constant) else None


def _check_width(device: Device, interface: Interface, layout: Layout, field: Field, report: DocumentReport) -> None:
    measurement = device.measurement_of(interface.name)
    assert measurement is not None
    width = field.width.constant
    needed_bits = {variant.code: _needed_bits(measurement, variant) for variant in device.variants_over(interface.name)}
    narrow = {code: bits for code, bits in needed_bits.items() if bits is not None and bits < width}
    if not narrow or any(bits is None or bits > width for bits in needed_bits.values()):
        return
    code, bits = next(iter(narrow.items()))
    fills_width = width in needed_bits.values()
    if not fills_width and (width % 8 == 0 or len(set(needed_bits.values())) > 1):
        return
    owner: Path = (
        ("field_groups", field.group) if field.group else ("interfaces", interface.name, "layouts", layout.name)
    )
    message = f"'{field.name}' always has {width} bits, but the counts of {code} need {bits}"
    correct_width = _right_width(measurement, fills_width, bits)
    report.add(
        "measurement-does-not-fit",
        (*owner, "fields", field.name),
        f"{message}; write '{correct_width}', or add a 'note' about the bits above them",
    )


def _right_width(measurement: Measurement, fills_width: bool, bits: int) -> str:
    """Return the width to write: the parameter that is the power of two of the counts, if it differs by order code."""
    counts = measurement.counts_per_turn
    assert counts is not None
    text = counts.render()
    is_power_of_parameter = fills_width and text.startswith("2^") and text[2:].isidentifier()
    if is_power_of_parameter:
        return f"bits: {text[2:]}"
    return "bits: PARAMETER" if fills_width else f"bits: {bits}"


def _needed_bits(measurement: Measurement, variant: Variant) -> int | None:
    """Return the number of bits that the counts of an order code fill, or None if they do not end at a power of two."""
    counts = _value(measurement.counts_per_turn, variant) * _value(measurement.turns, variant)
    return counts.bit_length() - 1 if counts > 0 and not counts & (counts - 1) else None


def _value(expression: Expression | None, variant: Variant) -> int:
    return 1 if expression is None else expression.value(variant.parameters)
