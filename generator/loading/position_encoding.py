"""Check the codes of positions, such as the excess of Gray code, and positions with more bits than the counts need."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from ..language.document import Path
from ..language.files import is_second
from ..language.problems import DocumentReport
from ..model import Device, Field, Interface, Layout, Measurement, Number, Variant
from ..model.expressions import Expression, is_power_of_two
from ..order_codes.parameters import run_time_names


class KeyProblem(NamedTuple):
    """A problem with one key of ``gray``. If the key is "", the problem is about ``gray`` itself."""

    key: str
    message: str


def check_gray_positions(device: Device, report: DocumentReport) -> None:
    """Report positions in Gray code whose excess does not match their counts per turn.

    If the counts per turn are not a power of two, the encoder adds a number, the excess, before it encodes the
    position: 76 for 360 counts in 9 bits.
    """
    names_at_run_time = run_time_names(device)
    for interface in device.interfaces:
        measurement = device.measurement_of(interface.name)
        for layout in interface.layouts:
            problem = _reason_against_excess(layout, measurement, names_at_run_time)
            if problem is None and measurement is not None and _is_in_gray(layout, measurement):
                variants = _gray_variants(device, interface, layout, names_at_run_time)
                problem = _problem_of_counts(layout, measurement, variants)
            if problem is not None:
                gray_path: Path = ("interfaces", interface.name, "layouts", layout.name, "gray")
                is_about_gray = not problem.key
                problem_path = gray_path if is_about_gray else (*gray_path, problem.key)
                report.add("gray-excess", problem_path, problem.message, at_key=is_about_gray)


def _gray_variants(
    device: Device, interface: Interface, layout: Layout, names_at_run_time: Collection[str]
) -> list[Variant]:
    """Return the order codes whose position is in Gray code, or can be if a register decides it.

    ``gray_when`` is the parameter that decides it. ``names_at_run_time`` are the parameters that registers determine.
    """
    variants = device.variants_over(interface.name)
    if layout.gray_when in names_at_run_time:
        return list(variants)
    return [variant for variant in variants if layout.place(variant.parameters).gray]


def _is_in_gray(layout: Layout, measurement: Measurement) -> bool:
    """Return whether a frame of the encoder sends the lowest bits of the position within a turn in Gray code."""
    if layout.sender != "encoder" or measurement.counts_per_turn is None:
        return False
    if not layout.gray_of or measurement.position_name not in layout.member_names:
        return False
    lowest_name = layout.field_names_of(measurement.position_name)[-1]  # The most significant field is the first.
    return lowest_name in layout.field_names_of(layout.gray_of)


def _is_position_alone(layout: Layout, measurement: Measurement) -> bool:
    """Return whether the number in Gray code is the whole position within one turn, in one unsigned field."""
    coded_names = layout.field_names_of(layout.gray_of)
    is_position = coded_names == layout.field_names_of(measurement.position_name)
    if len(coded_names) != 1 or not is_position or measurement.turns != Expression(1):
        return False
    kind = layout.field(coded_names[0]).kind
    return isinstance(kind, Number) and not kind.signed and not kind.zero_means


def _reason_against_excess(
    layout: Layout, measurement: Measurement | None, names_at_run_time: Collection[str]
) -> KeyProblem | None:
    """Return why a layout with Gray code cannot have the ``excess`` in the spec, or None if it can or has none.

    An excess is only for a position within one turn that starts at 0. It must not depend on a parameter in
    ``names_at_run_time``, which registers determine.
    """
    if layout.gray_excess is None:
        return None
    if measurement is None or not _is_in_gray(layout, measurement) or not _is_position_alone(layout, measurement):
        problem = f"'excess' needs 'counts_per_turn' and 'turns: 1' of '{layout.gray_of}', as one unsigned field"
        return KeyProblem("excess", f"{problem}; measure this field of a frame from the encoder, or remove 'excess'")
    if measurement.highest is not None or layout.position_range is not None:
        problem = "'excess' is only for positions from 0 to 'counts_per_turn' - 1"
        return KeyProblem("excess", f"{problem}; remove 'highest' and 'position_range', or remove 'excess'")
    parameter_names = set(layout.gray_excess.parameters)
    if measurement.counts_per_turn is not None:
        parameter_names.update(measurement.counts_per_turn.parameters)
    variable_names = sorted(parameter_names.intersection(names_at_run_time))
    if variable_names:
        problem = f"'{variable_names[0]}' depends on a register, but the excess of an order code is fixed"
        return KeyProblem(
            "excess", f"{problem}; leave 'gray' and 'measurement' out, and convert the position in your program"
        )
    return None


def _problem_of_counts(layout: Layout, measurement: Measurement, variants: Sequence[Variant]) -> KeyProblem | None:
    """Return the problem with the first order code whose excess does not match its counts per turn, or None.

    The codes in use are in the middle of all Gray codes, so half of the unused codes come before them. For 360 counts
    in 9 bits, the excess is (512 - 360) / 2 = 76.
    """
    assert measurement.counts_per_turn is not None
    counts_by_order_code = {variant.code: measurement.counts_per_turn.value(variant.parameters) for variant in variants}
    have_all_same_counts = len(set(counts_by_order_code.values())) == 1
    for variant in variants:
        counts = counts_by_order_code[variant.code]
        if counts < 1:  # This is reported elsewhere.
            continue
        bit_count = (counts - 1).bit_length()
        correct_excess = ((1 << bit_count) - counts) // 2
        stated_excess = layout.gray_excess.value(variant.parameters) if layout.gray_excess is not None else 0
        has_odd_counts = counts > 1 and counts & 1 == 1
        if stated_excess == correct_excess and not has_odd_counts:
            continue
        needs_excess = not is_power_of_two(counts)
        if needs_excess and (has_odd_counts or not _is_position_alone(layout, measurement)):
            return KeyProblem("", _no_excess_message(layout, variant, counts))
        formula = f"(2^{bit_count} - {counts}) / 2 = {correct_excess}"
        if layout.gray_excess is not None:
            message = f"'excess' is {stated_excess} for {variant.code}; for {counts} counts per turn, it is {formula}"
            return KeyProblem("excess", message)
        remedy = f"write 'excess: {correct_excess}' in 'gray'"
        if not have_all_same_counts:
            values_text = f"{correct_excess} for this order code and 0 for a power of two"
            remedy = f"write 'excess: PARAMETER' in 'gray', which is {values_text}"
        message = f"{_counts_text(layout, variant, counts)}, so it is sent in Gray excess, {formula}; {remedy}"
        return KeyProblem("", message)
    return None


def _counts_text(layout: Layout, variant: Variant, counts: int) -> str:
    """Return the beginning of a message about counts per turn that are not a power of two."""
    return f"'{layout.gray_of}' has {counts} counts per turn for {variant.code}, not a power of two"


def _no_excess_message(layout: Layout, variant: Variant, counts: int) -> str:
    """Return the message for a position in Gray code whose counts are not a power of two and cannot have an excess."""
    reason = "and Gray excess is only for the position within a turn, in one unsigned field"
    if counts & 1:
        reason = "and an odd number of counts cannot be sent in Gray excess"
    remedy = "leave 'gray' and 'measurement' out, call the field 'gray_code', and convert it in your program"
    return f"{_counts_text(layout, variant, counts)}, {reason}; {remedy}"


def check_position_widths(device: Device, report: DocumentReport) -> None:
    """Report a position with more bits than its counts need, unless a note of the field explains it.

    Zeros above a position are accepted if no order code uses all bits of the field, and the field has whole bytes or
    order codes need different widths.
    """
    # The second reading, an independent transcription of the manual, only repeats printed facts, without notes.
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
    field_names = layout.field_names_of(measurement.position_name)
    if len(field_names) != 1:
        return None
    (position_name,) = field_names
    field = next((layout_field for layout_field in layout.fields if layout_field.name == position_name), None)
    if field is None:
        return None
    is_binary = not field.number.signed and not field.kind.digit_code
    is_comparable = field.width.is_constant and not field.note and is_binary
    # The container is 0 for a field without 'padded_to'.
    is_unpadded = field.container in (0, field.width.constant)
    return field if is_comparable and is_unpadded else None


def _check_width(device: Device, interface: Interface, layout: Layout, field: Field, report: DocumentReport) -> None:
    """Report a position field with more bits than the counts of an order code need.

    Nothing is reported if the counts of an order code are not a power of two, or do not fit into the field.
    """
    measurement = device.measurement_of(interface.name)
    assert measurement is not None
    field_width = field.width.constant
    variants = device.variants_over(interface.name)
    needed_bits_by_code = {variant.code: _needed_bits(measurement, variant) for variant in variants}
    fewer_bits_by_code = {
        order_code: needed_bits
        for order_code, needed_bits in needed_bits_by_code.items()
        if needed_bits is not None and needed_bits < field_width
    }
    needed_bit_counts = set(needed_bits_by_code.values())
    if not fewer_bits_by_code or any(
        needed_bits is None or needed_bits > field_width for needed_bits in needed_bit_counts
    ):
        return
    order_code, needed_bits = next(iter(fewer_bits_by_code.items()))
    is_filled_by_some_code = field_width in needed_bit_counts
    has_whole_bytes = field_width % 8 == 0
    if not is_filled_by_some_code and (has_whole_bytes or len(needed_bit_counts) > 1):
        return
    owner_path: Path = ("interfaces", interface.name, "layouts", layout.name)
    if field.group:
        owner_path = ("field_groups", field.group)
    message = f"'{field.name}' always has {field_width} bits, but the counts of {order_code} need {needed_bits}"
    correct_width = _corrected_width(measurement, is_filled_by_some_code, needed_bits)
    report.add(
        "measurement-does-not-fit",
        (*owner_path, "fields", field.name),
        f"{message}; write '{correct_width}', or add a 'note' about the bits above them",
    )


def _corrected_width(measurement: Measurement, is_filled_by_some_code: bool, needed_bits: int) -> str:
    """Return the corrected key of a position field that is too wide, such as ``bits: 24``.

    If another order code uses all bits of the field, the width must be a parameter. For 2^position_bits counts per
    turn, this is position_bits.
    """
    if not is_filled_by_some_code:
        return f"bits: {needed_bits}"
    counts_per_turn = measurement.counts_per_turn
    assert counts_per_turn is not None
    counts_text = counts_per_turn.render()
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
