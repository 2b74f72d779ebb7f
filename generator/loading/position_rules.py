"""Check that the position of a measurement is as wide as its counts and turns need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

from ..language.document import Path
from ..language.problems import DocumentReport
from ..language.schema_files import is_second
from ..model import Device, Field, Interface, Layout, Measurement, Number, Variant
from ..model.expressions import Expression, is_power_of_two
from ..model.key_types import LARGEST
from ..model.record import dataclass
from .gray_positions import KeyProblem, check_gray_positions

#: From this number, a power of two minus one is assumed to be the highest count, not the number of counts.
_LEAST_POWER_OF_TWO = 15
#: Keys of a measurement that are not numbers of counts. They state the length of a count.
_KEYS_OF_STEP_LENGTHS = ("step_um", "step_nm", "per_counts")
#: Nanometres in the units of a field whose counts are lengths.
_NANOMETRES_PER_UNIT = {"nm": 1, "um": 1000, "µm": 1000, "μm": 1000, "mm": 1_000_000}
_REVOLUTION_UNITS = ("revolution", "revolutions", "turn", "turns")


@dataclass(frozen=True)
class _Case:
    """One order code with one layout of its interface, for which the numbers of a measurement are checked."""

    variant: Variant
    layout: Layout
    #: The fields of the position that this order code has, most significant first, each with its width.
    fields: tuple[tuple[str, int], ...]

    @property
    def width(self) -> int:
        return sum(width for _, width in self.fields)


def check_measurements(device: Device, report: DocumentReport) -> None:
    """Check scales and Gray code of positions, and report the first contradiction of each measurement."""
    # Interfaces without a measurement of their own share the measurement of the device, which is reported once.
    reported_paths: set[Path] = set()
    _check_scales(device, report)
    check_gray_positions(device, report)
    for interface in device.interfaces:
        # Only the first problem: the generator checks no further order codes once it has yielded one.
        first_problem = next(_problems_of(device, interface), None)
        if first_problem is None:
            continue
        path, problem = first_problem
        if path not in reported_paths:
            reported_paths.add(path)
            report.add("measurement-does-not-fit", (*path, problem.key), problem.message)


def _problems_of(device: Device, interface: Interface) -> Iterator[tuple[Path, KeyProblem]]:
    """Yield the contradictions of a measurement, each with the path of the measurement or range with the key."""
    measurement = device.measurement_of(interface.name)
    if measurement is None:
        return
    measurement_path: Path = ("measurement",)
    if interface.measurement is not None:
        measurement_path = ("interfaces", interface.name, "measurement")
    for case in _yield_cases(device, interface, measurement):
        range_of_layout = case.layout.position_range
        problem = _measurement_problem(device, measurement.within(range_of_layout), case)
        if problem is not None:
            range_path: Path = ("interfaces", interface.name, "layouts", case.layout.name, "position_range")
            # A number stated by the range of the layout is reported there, other numbers in the measurement.
            is_of_range = getattr(range_of_layout, problem.key, None) is not None
            yield range_path if is_of_range else measurement_path, problem


def _check_scales(device: Device, report: DocumentReport) -> None:
    """Report a part of a position with a ``scale``, because the measurement already gives its unit."""
    reported: set[Path] = set()
    for interface in device.interfaces:
        measurement = device.measurement_of(interface.name)
        if measurement is None:
            continue
        for layout in interface.layouts:
            owner = ("interfaces", interface.name, "layouts", layout.name)
            # The position is one field, or a join of several ones.
            for field in layout.find_fields(layout.names_in(measurement.of)):
                owner_of_field = ("field_groups", field.group) if field.group else owner
                path: Path = (*owner_of_field, "fields", field.name, "scale")
                if field.scale is not None and path not in reported:
                    reported.add(path)
                    message = f"'measurement' already gives the unit of '{field.name}'; remove 'scale'"
                    report.add("scale-of", path, message, at_key=True)


def _yield_cases(device: Device, interface: Interface, measurement: Measurement) -> Iterator[_Case]:
    """Yield each layout that the encoder sends with each order code of the interface."""
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    for layout in sent_layouts:
        names = layout.names_in(measurement.of)
        for variant in device.variants_over(interface.name):
            placed = layout.place(variant.parameters)
            widths = tuple((field.name, field.width) for field in placed.find_fields(names))
            yield _Case(variant, layout, widths)


def _measurement_problem(device: Device, measurement: Measurement, case: _Case) -> KeyProblem | None:
    """Return the wrong key and the message of the first contradiction with the layout of a case, or None."""
    # The key that states the number of positions: per turn, or in all for a length.
    key = "counts_per_turn" if measurement.counts_per_turn is not None else "modulus"
    expressions: dict[str, Expression] = {}
    for name in ("counts_per_turn", "turns", *_KEYS_OF_STEP_LENGTHS, "modulus"):
        expression = getattr(measurement, name)
        if expression is not None:
            expressions[name] = expression
    values = {name: expression.value(case.variant.parameters) for name, expression in expressions.items()}
    problem = _limit_problem(case, values) or _unit_problem(case, values)
    if problem is not None:
        return problem
    position_range = case.layout.position_range
    never_wraps = position_range is not None and not position_range.wraps
    # The width is 0 if a frame lacks the position.
    if key not in values or not case.width or never_wraps:
        return None
    fixed_values = {name: value for name, value in values.items() if not _at_run_time(device, expressions[name])}
    return (
        _highest_count_problem(case, fixed_values)
        or _width_problem(device, measurement, case, key, values)
        or _range_problem(measurement, case, key)
        or _order_problem(measurement, case, key, values)
        or _revolution_problem(case, key, values)
    )


def _limit_problem(case: _Case, values: Mapping[str, int]) -> KeyProblem | None:
    """Return the key and the message if a number of the measurement is below 1, or a step is too large for C."""
    for name, value in values.items():
        if value < 1:
            return KeyProblem(name, f"'{name}' is {value} for {case.variant.code}; it must be at least 1")
        if name in _KEYS_OF_STEP_LENGTHS and value > LARGEST:
            return KeyProblem(name, f"'{name}' is {value} for {case.variant.code}; it must be at most {LARGEST}")
    return None


def is_probably_highest(count: int) -> bool:
    """Return whether a number of counts is all ones, such as 4095, and so probably the highest count."""
    return count >= _LEAST_POWER_OF_TWO and is_power_of_two(count + 1)


def _highest_count_problem(case: _Case, fixed_values: Mapping[str, int]) -> KeyProblem | None:
    """Return the key and the message if a number of counts is all ones, such as 4095, and so the highest count.

    ``fixed_values`` lacks numbers that depend on a register, which may be any.
    """
    for name, value in fixed_values.items():
        is_number_of_counts = name not in _KEYS_OF_STEP_LENGTHS
        if is_number_of_counts and is_probably_highest(value):
            message = f"'{name}' is {value} for {case.variant.code}, which is the highest count"
            return KeyProblem(name, f"{message}; including 0 there are {value + 1}")
    return None


def _unit_problem(case: _Case, values: Mapping[str, int]) -> KeyProblem | None:
    """Return the key and the message if the unit of a single position field contradicts the length of a count."""
    if "step_um" in values:
        key, step_nm = "step_um", values["step_um"] * _NANOMETRES_PER_UNIT["um"]
    elif "step_nm" in values:
        key, step_nm = "step_nm", values["step_nm"]
    else:
        return None
    if len(case.fields) != 1:
        return None
    position_name, _ = case.fields[0]
    unit = case.layout.field(position_name).unit
    if unit not in _NANOMETRES_PER_UNIT:
        return None
    # The step is the length of 'per_counts' counts, and the unit of the field is the length of one count.
    length_by_unit_nm = _NANOMETRES_PER_UNIT[unit] * values.get("per_counts", 1)
    if step_nm == length_by_unit_nm:
        return None
    message = f"'{key}' is {values[key]} for {case.variant.code}, but '{position_name}' has 'unit: {unit}'"
    return KeyProblem(key, f"{message}, so a count is 1 {unit}; correct one of the two, or write 'unit: counts'")


def _width_problem(
    device: Device, measurement: Measurement, case: _Case, counts_key: str, values: Mapping[str, int]
) -> KeyProblem | None:
    """Return the key and the message if the position has too few bits, or unused bits where it must use all.

    A position of several fields also has too few bits if ``highest`` does not fit.
    """
    turns = values.get("turns", 1)
    counts = values[counts_key] * turns
    turns_text = f" × {turns} turns" if turns > 1 else ""
    counts_text = f"{values[counts_key]} counts{turns_text}"
    width_text = f"'{measurement.of}' in '{case.layout.name}' has {case.width} bits for {case.variant.code}"
    if counts > 1 << case.width:
        return KeyProblem(counts_key, f"{counts_text} do not fit, because {width_text}")
    fields = [case.layout.field(name) for name, _ in case.fields]
    is_signed = any(isinstance(field.kind, Number) and field.kind.signed for field in fields)
    end_of_width = 1 << case.width
    if len(fields) > 1 and measurement.highest is not None:
        highest = measurement.highest.value(case.variant.parameters)
        if highest >= end_of_width:
            return KeyProblem("highest", f"'highest' is {highest}, but {width_text} and ends at {end_of_width - 1}")
    width_parameters = _parameters_behind(device, *(field.width for field in fields))
    count_parameters = _parameters_behind(
        device, *filter(None, (measurement.counts_per_turn, measurement.turns, measurement.modulus))
    )
    # A position of fixed width can begin with zeros, as manuals draw it. Decoders reject a position above the counts.
    # A length that wraps around at a power of two uses all bits of its field, unless 'highest' gives another range.
    uses_all_bits = (
        counts_key == "modulus" and is_power_of_two(counts) and not is_signed and measurement.highest is None
    )
    must_fill = uses_all_bits or (
        width_parameters and count_parameters <= width_parameters and not (is_signed and measurement.highest)
    )
    one_bit_less_is_enough = 2 * counts <= 1 << case.width
    if one_bit_less_is_enough and must_fill:
        message = f"{counts_text} need {(counts - 1).bit_length()} bits, but {width_text}"
        return KeyProblem(counts_key, f"{message}; define zeros above a position as a separate field")
    return None


def _range_problem(measurement: Measurement, case: _Case, counts_key: str) -> KeyProblem | None:
    """Return the key and the message if the range of a position does not fit its only field, or is unknown."""
    if measurement.total is None or len(case.fields) != 1:
        return None
    total = measurement.total.value(case.variant.parameters)
    name, width = case.fields[0]
    field_text = f"'{name}' in '{case.layout.name}'"
    is_signed = case.layout.field(name).number.signed
    if measurement.highest is None:
        message = _message_of_signed_range(case, field_text, total) if is_signed else ""
        return KeyProblem(counts_key, message) if message else None
    highest = measurement.highest.value(case.variant.parameters)
    lowest = highest - total + 1  # There are as many positions as counts.
    # In two's complement, half of the numbers are negative.
    lowest_possible = -(1 << (width - 1)) if is_signed else 0
    highest_possible = lowest_possible + (1 << width) - 1
    if lowest_possible <= lowest and highest <= highest_possible:
        return None
    positions = f"positions of {case.variant.code} are {lowest} to {highest}"
    possible_range = f"{field_text} holds {lowest_possible} to {highest_possible}"
    return KeyProblem("highest", f"'highest' is {highest} for {total} counts, so {positions}, but {possible_range}")


def _message_of_signed_range(case: _Case, field_text: str, total: int) -> str:
    """Return the message about a signed position without ``highest``, or an empty string if it needs none.

    It needs no range if it has as many numbers as the encoder has positions.
    """
    if not is_power_of_two(total):
        message = f"{field_text} is signed, and its range does not follow from {total} counts for {case.variant.code}"
        return f"{message}; add 'highest', from which the lowest position follows: highest - {total} + 1"
    uses_all_numbers = total == 1 << case.width
    if uses_all_numbers:
        return ""
    message = f"{field_text} is signed and has {case.width} bits, but the position wraps around after {total} counts"
    remedy = "'position_range: {wraps: false}' if it never wraps around, otherwise give 'highest'"
    return f"{message} for {case.variant.code}; give that layout {remedy}"


def _order_problem(
    measurement: Measurement, case: _Case, counts_key: str, values: Mapping[str, int]
) -> KeyProblem | None:
    """Return the key and the message if the revolutions are in lower bits than the position within one revolution.

    In a frame of bytes, the order in which fields are sent does not show which field is more significant.
    """
    if counts_key != "counts_per_turn":
        return None
    names = [name for name, _ in case.fields]
    count_turns = [case.layout.field(name).unit in _REVOLUTION_UNITS for name in names]
    if not any(count_turns) and len(names) == 2:
        # Without units, the widths tell: the counts of a turn fit the upper field, and the turns the lower one.
        (_, upper_width), (_, lower_width) = case.fields
        counts_fit_upper = values[counts_key] == 1 << upper_width
        turns_fit_lower = values.get("turns") == 1 << lower_width
        count_turns[1] = upper_width != lower_width and counts_fit_upper and turns_fit_lower
    for (above_name, above_counts_turns), (name, counts_turns) in pairwise(zip(names, count_turns, strict=True)):
        if counts_turns and not above_counts_turns:
            message = f"'{measurement.of}' has '{name}', which counts revolutions, below '{above_name}'"
            return KeyProblem(counts_key, f"{message}; list '{name}' first in its 'join'")
    return None


def _revolution_problem(case: _Case, counts_key: str, values: Mapping[str, int]) -> KeyProblem | None:
    """Return the key and the message if the fields below a number of revolutions do not fill one revolution."""
    if counts_key != "counts_per_turn":
        return None
    counts = values[counts_key]
    for index, (name, width) in enumerate(case.fields[:-1]):
        fields_below = case.fields[index + 1 :]
        bits_below = sum(width_below for _, width_below in fields_below)
        # Without a unit, the upper of two fields counts turns if they fit into it, and the counts into the other.
        has_turns_that_fit = 1 < values.get("turns", 1) <= 1 << width
        fits_turns = len(case.fields) == 2 and counts < 1 << bits_below and has_turns_that_fit
        counts_turns = case.layout.field(name).unit in _REVOLUTION_UNITS or fits_turns
        if counts_turns and counts != 1 << bits_below:
            message = (
                f"'{name}' counts revolutions, and {bits_below} bits follow it for {case.variant.code}, so"
                f" a turn must have {1 << bits_below} counts, not {counts}"
            )
            name_below, _ = fields_below[0]
            remedy = f"; measure '{name_below}' alone, with 'turns: 1'" if fits_turns else ""
            return KeyProblem(counts_key, message + remedy)
    return None


def _at_run_time(device: Device, expression: Expression) -> bool:
    """Return True if the expression depends on a register, which may hold any number."""
    names_from_registers = {parameter.name for parameter in device.run_time_parameters}
    return not names_from_registers.isdisjoint(device.needed_parameters(expression.parameters))


def _parameters_behind(device: Device, *expressions: Expression) -> frozenset[str]:
    """Return the parameters behind these expressions: the parameters that order codes set or registers hold."""
    names = (name for expression in expressions for name in expression.parameters)
    return device.needed_parameters(names) - device.definitions.keys()


def check_position_widths(device: Device, report: DocumentReport) -> None:
    """Report a position with too many bits for its counts, unless a note of the field explains it.

    Zeros above a position are accepted if no order code fills the field, and if the field is whole bytes, as manuals
    draw them, or order codes need different widths.
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
    """Return the field that is the whole position if its width can be compared with the counts, else None.

    It must be unsigned and without padding, and have a constant width and no note. A joined position is several fields.
    """
    names = layout.names_in(measurement.of)
    if len(names) != 1:
        return None
    (position_name,) = names
    field = next((candidate for candidate in layout.fields if candidate.name == position_name), None)
    if field is None:
        return None
    is_plain = field.width.is_constant and not field.note and not field.number.signed
    # The container is 0 for a field without 'padded_to'.
    is_unpadded = field.container in (0, field.width.constant)
    return field if is_plain and is_unpadded else None


def _check_width(device: Device, interface: Interface, layout: Layout, field: Field, report: DocumentReport) -> None:
    """Report a position field wider than the counts of an order code need, if all counts are powers of two and fit."""
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
    """Return the corrected ``bits``, such as ``bits: 24``. It is a parameter if some order code fills the width.

    With 2^position_bits counts, the parameter is position_bits.
    """
    counts = measurement.counts_per_turn
    assert counts is not None
    counts_text = counts.render()
    is_power_of_parameter = fills_width and counts_text.startswith("2^") and counts_text[2:].isidentifier()
    if is_power_of_parameter:
        return f"bits: {counts_text[2:]}"
    return "bits: PARAMETER" if fills_width else f"bits: {bits}"


def _needed_bits(measurement: Measurement, variant: Variant) -> int | None:
    """Return the bits that the positions of an order code fill, or None if that is not a whole number."""
    counts = _value_or_one(measurement.counts_per_turn, variant) * _value_or_one(measurement.turns, variant)
    # 2^12 has 13 bits itself, but 12 bits count from 0 to 2^12 - 1.
    return counts.bit_length() - 1 if is_power_of_two(counts) else None


def _value_or_one(expression: Expression | None, variant: Variant) -> int:
    """Return the value of an expression for an order code, or 1 if there is none."""
    return 1 if expression is None else expression.value(variant.parameters)
