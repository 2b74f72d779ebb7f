"""Check that the field of the position has as many bits as its counts and turns need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from ..language.document import Path
from ..language.problems import DocumentReport
from ..model import Device, Field, Interface, Layout, Measurement, Number, Variant
from ..model.expressions import Expression, is_power_of_two
from ..model.key_types import LARGEST
from ..model.record import dataclass
from .gray_positions import KeyProblem, check_gray_positions

#: A power of two minus one is assumed to be the highest count, not the number of counts, if it is at least this number.
_SMALLEST_HIGHEST_COUNT = 15
#: Keys of a measurement that are not numbers of counts. They state the length of a count.
_KEYS_OF_STEP_LENGTHS = ("step_um", "step_nm", "per_counts")
#: Nanometers in the units of a field whose counts are lengths.
_NANOMETERS_PER_UNIT = {"nm": 1, "um": 1000, "µm": 1000, "μm": 1000, "mm": 1_000_000}
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
        """Number of bits in the position, or 0 if the layout does not contain it."""
        return sum(width for _, width in self.fields)


def check_measurements(device: Device, report: DocumentReport) -> None:
    """Check the positions of a device: their scales, their Gray code, and the description of their counts.

    The key ``measurement`` of a device or interface describes the position. For each measurement, only the first
    contradiction is reported.
    """
    # Interfaces without their own measurement share the measurement of the device, which is reported once.
    reported_paths: set[Path] = set()
    _check_scales(device, report)
    check_gray_positions(device, report)
    for interface in device.interfaces:
        # The generator stops at the first problem, without checking other order codes.
        first_problem = next(_problems_of(device, interface), None)
        if first_problem is None:
            continue
        path, problem = first_problem
        if path not in reported_paths:
            reported_paths.add(path)
            report.add("measurement-does-not-fit", (*path, problem.key), problem.message)


def _problems_of(device: Device, interface: Interface) -> Iterator[tuple[Path, KeyProblem]]:
    """Yield the contradictions in the description of the position of an interface.

    Each comes with the path of the ``measurement`` or the ``position_range`` that contains the wrong key.
    """
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
            # The layout can have its own range, which replaces numbers of the measurement.
            range_has_key = getattr(range_of_layout, problem.key, None) is not None
            yield range_path if range_has_key else measurement_path, problem


def _check_scales(device: Device, report: DocumentReport) -> None:
    """Report a ``scale`` for a field of the position, because ``measurement`` already gives its unit."""
    reported: set[Path] = set()
    for interface in device.interfaces:
        measurement = device.measurement_of(interface.name)
        if measurement is None:
            continue
        for layout in interface.layouts:
            owner = ("interfaces", interface.name, "layouts", layout.name)
            # The position consists of one or several fields.
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
    """Return the first contradiction between a measurement and a layout for one order code, or None.

    The measurement describes the position: its counts per turn, turns and so on.
    """
    # The key that states the number of positions, within one turn or, for a length, in total.
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
    has_position = case.width > 0
    if key not in values or not has_position or never_wraps:
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
    """Return the problem if a number of a measurement is below 1, or a step is too large for C, or None."""
    for name, value in values.items():
        if value < 1:
            return KeyProblem(name, f"'{name}' is {value} for {case.variant.code}; it must be at least 1")
        if name in _KEYS_OF_STEP_LENGTHS and value > LARGEST:
            return KeyProblem(name, f"'{name}' is {value} for {case.variant.code}; it must be at most {LARGEST}")
    return None


def is_probably_highest(count: int) -> bool:
    """Return whether a number of counts is probably the highest count, because it is a power of two minus one.

    For example, 4095 is probably the highest of 4096 counts.
    """
    return count >= _SMALLEST_HIGHEST_COUNT and is_power_of_two(count + 1)


def _highest_count_problem(case: _Case, fixed_values: Mapping[str, int]) -> KeyProblem | None:
    """Return the problem if a number of counts is probably the highest count, such as 4095, or None.

    ``fixed_values`` are the numbers of the measurement that do not depend on a register.
    """
    for name, value in fixed_values.items():
        is_number_of_counts = name not in _KEYS_OF_STEP_LENGTHS
        if is_number_of_counts and is_probably_highest(value):
            message = f"'{name}' is {value} for {case.variant.code}, which is the highest count"
            return KeyProblem(name, f"{message}; including 0 there are {value + 1}")
    return None


def _unit_problem(case: _Case, values: Mapping[str, int]) -> KeyProblem | None:
    """Return the problem if the unit of the position field contradicts the length of a count, or None.

    A position that consists of several fields is not checked.
    """
    if "step_um" in values:
        key, step_nm = "step_um", values["step_um"] * _NANOMETERS_PER_UNIT["um"]
    elif "step_nm" in values:
        key, step_nm = "step_nm", values["step_nm"]
    else:
        return None
    if len(case.fields) != 1:
        return None
    position_name, _ = case.fields[0]
    unit = case.layout.field(position_name).unit
    if unit not in _NANOMETERS_PER_UNIT:
        return None
    # The step is the length of ``per_counts`` counts. The unit of the field is the length of one count.
    length_by_unit_nm = _NANOMETERS_PER_UNIT[unit] * values.get("per_counts", 1)
    if step_nm == length_by_unit_nm:
        return None
    message = f"'{key}' is {values[key]} for {case.variant.code}, but '{position_name}' has 'unit: {unit}'"
    return KeyProblem(key, f"{message}, so a count is 1 {unit}; correct one of the two, or write 'unit: counts'")


def _width_problem(
    device: Device, measurement: Measurement, case: _Case, counts_key: str, values: Mapping[str, int]
) -> KeyProblem | None:
    """Return the problem if the position has too few bits for its counts, or bits that it never uses, or None.

    If the position consists of several fields, ``highest``, its highest value, must fit too.
    """
    turns = values.get("turns", 1)
    counts = values[counts_key] * turns
    turns_text = f" × {turns} turns" if turns > 1 else ""
    counts_text = f"{values[counts_key]} counts{turns_text}"
    width_text = f"'{measurement.of}' in '{case.layout.name}' has {case.width} bits for {case.variant.code}"
    fields = [case.layout.field(name) for name, _ in case.fields]
    # A number whose digits are sent separately is always a single field.
    code = fields[0].code_of_digits
    highest_in_bits = (1 << case.width) - 1 if code is None else code.highest(case.width)
    if counts > highest_in_bits + 1:
        end = f" for numbers up to {highest_in_bits} in {code.name}" if code is not None else ""
        return KeyProblem(counts_key, f"{counts_text} do not fit, because {width_text}{end}")
    if code is not None:
        return None
    if len(fields) > 1 and measurement.highest is not None:
        highest = measurement.highest.value(case.variant.parameters)
        if highest > highest_in_bits:
            return KeyProblem("highest", f"'highest' is {highest}, but {width_text} and ends at {highest_in_bits}")
    one_bit_less_is_enough = 2 * counts <= highest_in_bits + 1
    if one_bit_less_is_enough and _must_use_all_bits(device, measurement, fields, counts_key, counts):
        message = f"{counts_text} need {(counts - 1).bit_length()} bits, but {width_text}"
        return KeyProblem(counts_key, f"{message}; define zeros above a position as a separate field")
    return None


def _must_use_all_bits(
    device: Device, measurement: Measurement, fields: Sequence[Field], counts_key: str, counts: int
) -> bool:
    """Return whether a position must use all bits of its fields.

    A position with a fixed width can begin with zeros, as manuals draw it. If the width depends on the parameters that
    determine the counts, all bits must be used. A length that wraps around at a power of two also uses all bits. Both
    rules have exceptions for positions with ``highest``, which gives the range of the position.
    """
    is_signed = any(isinstance(field.kind, Number) and field.kind.signed for field in fields)
    wraps_at_power_of_two = counts_key == "modulus" and is_power_of_two(counts)
    if wraps_at_power_of_two and not is_signed and measurement.highest is None:
        return True
    if is_signed and measurement.highest:
        return False
    width_parameters = _parameters_behind(device, *(field.width for field in fields))
    numbers_of_counts = (measurement.counts_per_turn, measurement.turns, measurement.modulus)
    count_parameters = _parameters_behind(device, *filter(None, numbers_of_counts))
    return bool(width_parameters) and count_parameters <= width_parameters


def _range_problem(measurement: Measurement, case: _Case, counts_key: str) -> KeyProblem | None:
    """Return the problem if the range of a position does not fit into its field or cannot be inferred, or None.

    A position that consists of several fields is not checked.
    """
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
    lowest = highest - total + 1
    # In two's complement, half of the numbers are negative.
    lowest_possible = -(1 << (width - 1)) if is_signed else 0
    highest_possible = lowest_possible + (1 << width) - 1
    if lowest_possible <= lowest and highest <= highest_possible:
        return None
    positions = f"positions of {case.variant.code} are {lowest} to {highest}"
    possible_range = f"{field_text} holds {lowest_possible} to {highest_possible}"
    return KeyProblem("highest", f"'highest' is {highest} for {total} counts, so {positions}, but {possible_range}")


def _message_of_signed_range(case: _Case, field_text: str, total: int) -> str:
    """Return the message about a signed position without ``highest``, or "" if it does not need this key.

    It is not needed if the field can hold exactly as many numbers as there are positions.
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
    """Return the problem if the revolutions are in lower bits than the position within one revolution, or None.

    This can only happen in a frame of bytes, where the transmission order does not show which field is more
    significant.
    """
    if counts_key != "counts_per_turn":
        return None
    names = [name for name, _ in case.fields]
    count_turns = [case.layout.field(name).unit in _REVOLUTION_UNITS for name in names]
    if not any(count_turns) and len(names) == 2:
        # Without units, the order is wrong if the counts of a turn fill the upper field, and the turns the lower one.
        (_, upper_width), (_, lower_width) = case.fields
        counts_fill_upper = values[counts_key] == 1 << upper_width
        turns_fill_lower = values.get("turns") == 1 << lower_width
        count_turns[1] = upper_width != lower_width and counts_fill_upper and turns_fill_lower
    for (above_name, above_counts_turns), (name, counts_turns) in pairwise(zip(names, count_turns, strict=True)):
        if counts_turns and not above_counts_turns:
            message = f"'{measurement.of}' has '{name}', which counts revolutions, below '{above_name}'"
            return KeyProblem(counts_key, f"{message}; list '{name}' first in its 'join'")
    return None


def _revolution_problem(case: _Case, counts_key: str, values: Mapping[str, int]) -> KeyProblem | None:
    """Return the problem if the fields below the number of revolutions do not count exactly one revolution, or None."""
    if counts_key != "counts_per_turn":
        return None
    counts = values[counts_key]
    for index, (name, width) in enumerate(case.fields[:-1]):
        fields_below = case.fields[index + 1 :]
        bits_below = sum(width_below for _, width_below in fields_below)
        # Without a unit, the upper of two fields counts turns if they fit into it, and the counts fit into the other.
        turns_fit = 1 < values.get("turns", 1) <= 1 << width
        counts_fit_below = counts < 1 << bits_below
        fits_turns = len(case.fields) == 2 and counts_fit_below and turns_fit
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
    """Return whether an expression depends on a parameter that a register holds at run time."""
    names_from_registers = {parameter.name for parameter in device.run_time_parameters}
    return not names_from_registers.isdisjoint(device.needed_parameters(expression.parameters))


def _parameters_behind(device: Device, *expressions: Expression) -> frozenset[str]:
    """Return the parameters that determine these expressions, and that order codes set or registers hold.

    A parameter that a formula calculates is replaced by the parameters in the formula.
    """
    names: list[str] = []
    for expression in expressions:
        names += expression.parameters
    return device.needed_parameters(names) - device.definitions.keys()
