"""Check measurements against frames: scale, limits, counts, unit, width, range, order and unused bits of positions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple

from ..language.document import Path
from ..language.problems import DocumentReport
from ..model import Device, Interface, Layout, Measurement, Variant
from ..model.expressions import Expression, is_power_of_two
from ..model.keys_and_members import LARGEST
from ..model.record import dataclass
from .position_encoding import KeyProblem, check_gray_positions

#: A power of two minus one is assumed to be the highest count, not the number of counts, if it is at least this number.
_SMALLEST_HIGHEST_COUNT = 15
#: Keys of a measurement that are not numbers of counts. They state the length of a count.
_KEYS_OF_STEP_LENGTHS = ("step_um", "step_nm", "per_counts")
#: Nanometers in the units of a field whose counts are lengths.
_NANOMETERS_PER_UNIT = {"nm": 1, "um": 1000, "µm": 1000, "μm": 1000, "mm": 1_000_000}
_REVOLUTION_UNITS = ("revolution", "revolutions", "turn", "turns")


class _PositionField(NamedTuple):
    """A field of the position, with its width for an order code."""

    name: str
    width: int
    unit: str

    @property
    def counts_revolutions(self) -> bool:
        """True if the unit of the field says that it counts revolutions."""
        return self.unit in _REVOLUTION_UNITS


@dataclass(frozen=True)
class _PositionFrame:
    """One order code with one layout of its interface, for which the numbers of a measurement are checked.

    Attributes:
        device: The device.
        measurement: Description of the position in this layout.
        variant: The order code.
        layout: The layout.
        fields: The fields of the position that this order code has, most significant first.
        numbers: The numbers of the measurement for this order code, by key: counts per turn, turns and so on.
    """

    device: Device
    measurement: Measurement
    variant: Variant
    layout: Layout
    fields: tuple[_PositionField, ...]
    numbers: Mapping[str, int]

    @property
    def width(self) -> int:
        """Number of bits in the position, or 0 if the layout does not contain it."""
        return sum(field.width for field in self.fields)

    @property
    def counts_key(self) -> str:
        """Key with the number of positions, within one turn or, for a length, in total."""
        return "counts_per_turn" if self.measurement.counts_per_turn is not None else "modulus"

    @property
    def counts(self) -> int:
        """Number at ``counts_key``."""
        return self.numbers[self.counts_key]


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
    for frame in _yield_frames(device, interface, measurement):
        problem = _measurement_problem(frame)
        if problem is not None:
            range_path: Path = ("interfaces", interface.name, "layouts", frame.layout.name, "position_range")
            # The layout can have its own range, which replaces numbers of the measurement.
            is_key_of_range = getattr(frame.layout.position_range, problem.key, None) is not None
            yield range_path if is_key_of_range else measurement_path, problem


def _check_scales(device: Device, report: DocumentReport) -> None:
    """Report a ``scale`` for a field of the position, because ``measurement`` already gives its unit."""
    reported_paths: set[Path] = set()
    for interface in device.interfaces:
        measurement = device.measurement_of(interface.name)
        if measurement is None:
            continue
        for layout in interface.layouts:
            layout_path = ("interfaces", interface.name, "layouts", layout.name)
            # The position consists of one or several fields.
            for field in layout.find_fields(layout.field_names_of(measurement.position_name)):
                path_of_owner = ("field_groups", field.group) if field.group else layout_path
                scale_path: Path = (*path_of_owner, "fields", field.name, "scale")
                if field.scale is not None and scale_path not in reported_paths:
                    reported_paths.add(scale_path)
                    message = f"'measurement' already gives the unit of '{field.name}'; remove 'scale'"
                    report.add("scale-of", scale_path, message, at_key=True)


def _yield_frames(device: Device, interface: Interface, measurement: Measurement) -> Iterator[_PositionFrame]:
    """Yield each layout that the encoder sends with each order code of the interface."""
    sent_layouts = [layout for layout in interface.layouts if layout.sender == "encoder"]
    for layout in sent_layouts:
        measurement_in_layout = measurement.within(layout.position_range)
        expression_by_key = _expressions_of(measurement_in_layout)
        position_names = layout.field_names_of(measurement.position_name)
        for variant in device.variants_over(interface.name):
            position_fields: list[_PositionField] = []
            for placed_field in layout.place(variant.parameters).find_fields(position_names):
                position_fields.append(
                    _PositionField(name=placed_field.name, width=placed_field.width, unit=placed_field.field.unit)
                )
            yield _PositionFrame(
                device=device,
                measurement=measurement_in_layout,
                variant=variant,
                layout=layout,
                fields=tuple(position_fields),
                numbers={key: expression.value(variant.parameters) for key, expression in expression_by_key.items()},
            )


def _expressions_of(measurement: Measurement) -> dict[str, Expression]:
    """Return the expressions for the numbers of a measurement, by key, such as ``2^turn_bits`` for ``turns``."""
    expression_by_key: dict[str, Expression] = {}
    for key in ("counts_per_turn", "turns", *_KEYS_OF_STEP_LENGTHS, "modulus"):
        expression = getattr(measurement, key)
        if expression is not None:
            expression_by_key[key] = expression
    return expression_by_key


def _measurement_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the first contradiction between a measurement and a layout for one order code, or None."""
    problem = _limit_problem(frame) or _unit_problem(frame)
    if problem is not None:
        return problem
    position_range = frame.layout.position_range
    never_wraps = position_range is not None and not position_range.wraps
    has_position = frame.width > 0
    has_counts = frame.counts_key in frame.numbers
    if not has_counts or not has_position or never_wraps:
        return None
    return (
        _highest_count_problem(frame)
        or _width_problem(frame)
        or _range_problem(frame)
        or _order_problem(frame)
        or _revolution_problem(frame)
    )


def _limit_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if a number of a measurement is below 1, or a step is too large for C, or None."""
    for measurement_key, number in frame.numbers.items():
        if number < 1:
            return KeyProblem(
                measurement_key, f"'{measurement_key}' is {number} for {frame.variant.code}; it must be at least 1"
            )
        if measurement_key in _KEYS_OF_STEP_LENGTHS and number > LARGEST:
            return KeyProblem(
                measurement_key,
                f"'{measurement_key}' is {number} for {frame.variant.code}; it must be at most {LARGEST}",
            )
    return None


def is_probably_highest(count: int) -> bool:
    """Return whether a number of counts is probably the highest count, because it is a power of two minus one.

    For example, 4095 is probably the highest of 4096 counts.
    """
    return count >= _SMALLEST_HIGHEST_COUNT and is_power_of_two(count + 1)


def _highest_count_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if a number of counts is probably the highest count, such as 4095, or None.

    Numbers that depend on a register are not checked.
    """
    expression_by_key = _expressions_of(frame.measurement)
    for measurement_key, number in frame.numbers.items():
        is_number_of_counts = measurement_key not in _KEYS_OF_STEP_LENGTHS
        is_fixed = not _at_run_time(frame.device, expression_by_key[measurement_key])
        if is_fixed and is_number_of_counts and is_probably_highest(number):
            message = f"'{measurement_key}' is {number} for {frame.variant.code}, which is the highest count"
            return KeyProblem(measurement_key, f"{message}; including 0 there are {number + 1}")
    return None


def _unit_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if the unit of the position field contradicts the length of a count, or None.

    A position that consists of several fields is not checked.
    """
    if "step_um" in frame.numbers:
        key, stated_step_nm = "step_um", frame.numbers["step_um"] * _NANOMETERS_PER_UNIT["um"]
    elif "step_nm" in frame.numbers:
        key, stated_step_nm = "step_nm", frame.numbers["step_nm"]
    else:
        return None
    if len(frame.fields) != 1:
        return None
    (field,) = frame.fields
    unit = field.unit
    if unit not in _NANOMETERS_PER_UNIT:
        return None
    # The step is the length of ``per_counts`` counts. The unit of the field is the length of one count.
    step_of_unit_nm = _NANOMETERS_PER_UNIT[unit] * frame.numbers.get("per_counts", 1)
    if stated_step_nm == step_of_unit_nm:
        return None
    message = f"'{key}' is {frame.numbers[key]} for {frame.variant.code}, but '{field.name}' has 'unit: {unit}'"
    return KeyProblem(key, f"{message}, so a count is 1 {unit}; correct one of the two, or write 'unit: counts'")


def _width_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if the position has too few bits for its counts, or bits that it never uses, or None.

    If the position consists of several fields, ``highest``, its highest value, must fit too.
    """
    measurement = frame.measurement
    turn_count = frame.numbers.get("turns", 1)
    total_counts = frame.counts * turn_count
    turns_text = f" × {turn_count} turns" if turn_count > 1 else ""
    counts_text = f"{frame.counts} counts{turns_text}"
    width_text = (
        f"'{measurement.position_name}' in '{frame.layout.name}' has {frame.width} bits for {frame.variant.code}"
    )
    # A number whose digits are sent separately is always a single field.
    digit_code = frame.layout.field(frame.fields[0].name).code_of_digits
    highest_that_fits = (1 << frame.width) - 1 if digit_code is None else digit_code.highest(frame.width)
    if total_counts > highest_that_fits + 1:
        range_text = f" for numbers up to {highest_that_fits} in {digit_code.name}" if digit_code is not None else ""
        return KeyProblem(frame.counts_key, f"{counts_text} do not fit, because {width_text}{range_text}")
    if digit_code is not None:
        return None
    if len(frame.fields) > 1 and measurement.highest is not None:
        highest = measurement.highest.value(frame.variant.parameters)
        if highest > highest_that_fits:
            return KeyProblem("highest", f"'highest' is {highest}, but {width_text} and ends at {highest_that_fits}")
    one_bit_less_is_enough = 2 * total_counts <= highest_that_fits + 1
    if one_bit_less_is_enough and _must_use_all_bits(frame, total_counts):
        message = f"{counts_text} need {(total_counts - 1).bit_length()} bits, but {width_text}"
        return KeyProblem(frame.counts_key, f"{message}; define zeros above a position as a separate field")
    return None


def _must_use_all_bits(frame: _PositionFrame, total_counts: int) -> bool:
    """Return whether a position with that many counts must use all bits of its fields.

    A position with a fixed width can begin with zeros, as manuals draw it. If the width depends on the parameters that
    determine the counts, all bits must be used. A length that wraps around at a power of two also uses all bits. Both
    rules have exceptions for positions with ``highest``, which gives the range of the position.
    """
    measurement = frame.measurement
    position_fields = [frame.layout.field(position_field.name) for position_field in frame.fields]
    is_signed = any(field.number.signed for field in position_fields)
    wraps_at_power_of_two = frame.counts_key == "modulus" and is_power_of_two(total_counts)
    if wraps_at_power_of_two and not is_signed and measurement.highest is None:
        return True
    if is_signed and measurement.highest:
        return False
    width_parameters = _determining_parameters(frame.device, *(field.width for field in position_fields))
    expressions_of_counts = (measurement.counts_per_turn, measurement.turns, measurement.modulus)
    stated_expressions = [expression for expression in expressions_of_counts if expression is not None]
    count_parameters = _determining_parameters(frame.device, *stated_expressions)
    return bool(width_parameters) and count_parameters <= width_parameters


def _range_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if the range of a position does not fit into its field or cannot be inferred, or None.

    A position that consists of several fields is not checked.
    """
    measurement = frame.measurement
    if measurement.total is None or len(frame.fields) != 1:
        return None
    total_counts = measurement.total.value(frame.variant.parameters)
    (field,) = frame.fields
    field_text = f"'{field.name}' in '{frame.layout.name}'"
    is_signed = frame.layout.field(field.name).number.signed
    if measurement.highest is None:
        message = _message_of_signed_range(frame, field_text, total_counts) if is_signed else ""
        return KeyProblem(frame.counts_key, message) if message else None
    highest = measurement.highest.value(frame.variant.parameters)
    lowest = highest - total_counts + 1
    # In two's complement, half of the numbers are negative.
    lowest_possible = -(1 << (field.width - 1)) if is_signed else 0
    highest_possible = lowest_possible + (1 << field.width) - 1
    if lowest_possible <= lowest and highest <= highest_possible:
        return None
    positions_text = f"positions of {frame.variant.code} are {lowest} to {highest}"
    possible_range_text = f"{field_text} holds {lowest_possible} to {highest_possible}"
    return KeyProblem(
        "highest", f"'highest' is {highest} for {total_counts} counts, so {positions_text}, but {possible_range_text}"
    )


def _message_of_signed_range(frame: _PositionFrame, field_text: str, total_counts: int) -> str:
    """Return the message about a signed position without ``highest``, or "" if it does not need this key.

    It is not needed if the field can hold exactly as many numbers as there are positions.
    """
    if not is_power_of_two(total_counts):
        message = (
            f"{field_text} is signed, and its range does not follow from {total_counts} counts for {frame.variant.code}"
        )
        return f"{message}; add 'highest', from which the lowest position follows: highest - {total_counts} + 1"
    uses_all_numbers = total_counts == 1 << frame.width
    if uses_all_numbers:
        return ""
    message = (
        f"{field_text} is signed and has {frame.width} bits, but the position wraps around after {total_counts} counts"
    )
    remedy = "'position_range: {wraps: false}' if it never wraps around, otherwise give 'highest'"
    return f"{message} for {frame.variant.code}; give that layout {remedy}"


def _order_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if the revolutions are in lower bits than the position within one revolution, or None.

    This can only happen in a frame of bytes, where the transmission order does not show which field is more
    significant.
    """
    if frame.counts_key != "counts_per_turn":
        return None
    for upper, lower in pairwise(frame.fields):
        is_wrong_by_units = lower.counts_revolutions and not upper.counts_revolutions
        if is_wrong_by_units or _is_wrong_by_widths(frame):
            position_name = frame.measurement.position_name
            message = f"'{position_name}' has '{lower.name}', which counts revolutions, below '{upper.name}'"
            return KeyProblem(frame.counts_key, f"{message}; list '{lower.name}' first in its 'join'")
    return None


def _is_wrong_by_widths(frame: _PositionFrame) -> bool:
    """Return whether the counts of a turn fill the upper of two fields without units, and the turns the lower one."""
    have_units = any(field.counts_revolutions for field in frame.fields)
    if have_units or len(frame.fields) != 2:
        return False
    upper, lower = frame.fields
    counts_fill_upper = frame.counts == 1 << upper.width
    turns_fill_lower = frame.numbers.get("turns") == 1 << lower.width
    return upper.width != lower.width and counts_fill_upper and turns_fill_lower


def _revolution_problem(frame: _PositionFrame) -> KeyProblem | None:
    """Return the problem if the fields below the number of revolutions do not count exactly one revolution, or None."""
    if frame.counts_key != "counts_per_turn":
        return None
    for index, field in enumerate(frame.fields[:-1]):
        fields_below = frame.fields[index + 1 :]
        bits_below = sum(field_below.width for field_below in fields_below)
        counts_in_bits_below = 1 << bits_below
        # Without a unit, the upper of two fields counts turns if they fit into it, and the counts fit into the other.
        turns_fit = 1 < frame.numbers.get("turns", 1) <= 1 << field.width
        counts_fit_below = frame.counts < counts_in_bits_below
        fits_turns = len(frame.fields) == 2 and counts_fit_below and turns_fit
        counts_turns = field.counts_revolutions or fits_turns
        if counts_turns and frame.counts != counts_in_bits_below:
            message = (
                f"'{field.name}' counts revolutions, and {bits_below} bits follow it for {frame.variant.code}, so"
                f" a turn must have {counts_in_bits_below} counts, not {frame.counts}"
            )
            remedy = f"; measure '{fields_below[0].name}' alone, with 'turns: 1'" if fits_turns else ""
            return KeyProblem(frame.counts_key, message + remedy)
    return None


def _at_run_time(device: Device, expression: Expression) -> bool:
    """Return whether an expression depends on a parameter that a register holds at run time."""
    names_from_registers = {parameter.name for parameter in device.run_time_parameters}
    return not names_from_registers.isdisjoint(device.needed_parameters(expression.parameters))


def _determining_parameters(device: Device, *expressions: Expression) -> frozenset[str]:
    """Return the parameters that determine these expressions, and that order codes set or registers hold.

    A parameter that a formula calculates is replaced by the parameters in the formula.
    """
    parameter_names: list[str] = []
    for expression in expressions:
        parameter_names += expression.parameters
    return device.needed_parameters(parameter_names) - device.definitions.keys()
