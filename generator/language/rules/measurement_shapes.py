"""Rules for the keys of a measurement, and of the range of positions that a layout has for itself."""

from __future__ import annotations

from ...model.measurement import LayoutRange, Measurement
from ..problems import DocumentReport, quoted
from ..written import LocatedPart
from ..written_parts import WrittenSpec
from .parts import by_name, interfaces, layouts_of_interfaces, measurements, readable_names

#: Keys of the measurement of an angle, and of a length.
_KEYS_OF_ANGLE: tuple[str, ...] = ("counts_per_turn", "turns")
_KEYS_OF_LENGTH: tuple[str, ...] = ("step_um", "step_nm", "per_counts", "modulus")


def check_measurement_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a measurement has the keys for an angle if the movement is rotary, or for a length if it is linear.

    The size of a count is required. ``highest``, the highest position, also needs ``turns`` or ``modulus``, after which
    the position wraps around.
    """
    movement = spec.movement
    if not movement:
        return
    # ``unit_key`` gives the size of a count. After ``total_key``, the position wraps around.
    if movement == "rotary":
        unit_key, total_key, foreign_keys = "counts_per_turn", "turns", _KEYS_OF_LENGTH
    else:
        unit_key, total_key, foreign_keys = "step_um", "modulus", _KEYS_OF_ANGLE
    raw_measurements = {measurement.path: measurement for measurement in measurements(spec.with_invalid_parts)}
    for measurement in measurements(spec):
        raw_measurement = raw_measurements[measurement.path]
        # A key rejected by the schema was removed. It must not be reported as missing, too.
        is_complete = measurement.data.keys() == raw_measurement.data.keys()
        has_unit = measurement.has(unit_key) or measurement.part.step_nm is not None
        if is_complete and not has_unit:
            unit_text = "'step_um', or 'step_nm' with 'per_counts'," if movement == "linear" else quoted(unit_key)
            message = f"{unit_text} is missing; the measurement of a {movement} encoder needs it"
            report.add("measurement-shape", measurement.path, message, at_key=True)
        for key in foreign_keys:
            if measurement.has(key):
                message = f"{quoted(key)} does not apply to a {movement} encoder"
                report.add("measurement-shape", (*measurement.path, key), message, at_key=True)
        if movement == "linear":
            _check_step(measurement, report)
        if measurement.has("highest") and not raw_measurement.has(total_key):
            problem = f"'highest' has no effect without {quoted(total_key)}; add it, or remove 'highest'"
            report.add("measurement-shape", (*measurement.path, "highest"), problem, at_key=True)


def check_position_range_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a layout with its own range of the position contains the position, and that the range has valid keys.

    The position is the field or joined number that the measurement of the interface or of the device names.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    own_measurements = {name: interface.measurement for name, interface in interfaces(spec.with_invalid_parts)}
    raw_frames = {frame.owner.path: frame for frame in layouts_of_interfaces(spec.with_invalid_parts)}
    for frame in layouts_of_interfaces(spec):
        own_range = frame.layout.position_range if frame.layout is not None else None
        if own_range is None or not own_range.is_given:
            continue
        own_measurement = own_measurements[frame.interface]
        has_own_measurement = own_measurement is not None and own_measurement.is_given
        measurement = own_measurement if has_own_measurement else spec.with_invalid_parts.measurement
        # The path in the file differs if invalid layouts before this one were removed.
        raw_frame = raw_frames[report.document.original(frame.owner.path)]
        if measurement is None or not measurement.is_given:
            problem = "'position_range' needs a 'measurement', which gives the unit of the position"
            message = f"{problem}; add it to the interface or the encoder"
            report.add("measurement-shape", own_range.path, message, at_key=True)
        elif not raw_frame.is_from_encoder or measurement.part.of not in readable_names(raw_frame, groups):
            position_name = quoted(measurement.part.of)
            problem = f"{quoted(raw_frame.name)} does not carry the position, {position_name}, to the master"
            report.add("measurement-shape", own_range.path, f"{problem}; remove 'position_range'", at_key=True)
        _check_range_keys(own_range, measurement, spec.movement, report)


def _check_range_keys(
    own_range: LocatedPart[LayoutRange],
    measurement: LocatedPart[Measurement] | None,
    movement: str,
    report: DocumentReport,
) -> None:
    """Check that the range of a layout has the keys of the movement, and no other keys next to ``wraps: false``.

    ``highest`` needs a number of turns or a modulus, in the range or in the measurement.
    """
    path = own_range.path
    total_key = "turns" if movement == "rotary" else "modulus"
    foreign_key = "modulus" if movement == "rotary" else "turns"
    if own_range.has(foreign_key) and movement in ("rotary", "linear"):
        problem = f"{quoted(foreign_key)} does not apply to a {movement} encoder; write {quoted(total_key)}"
        report.add("measurement-shape", (*path, foreign_key), problem, at_key=True)
    if not own_range.part.wraps:
        contradicting_keys = [key for key in ("turns", "modulus", "highest") if own_range.has(key)]
        if contradicting_keys:
            key = contradicting_keys[0]
            problem = f"{quoted(key)} contradicts 'wraps: false'; remove one of the two"
            report.add("measurement-shape", (*path, key), problem, at_key=True)
        return
    has_total = own_range.has(total_key) or own_range.has("modulus")
    if measurement is not None and not has_total:
        has_total = measurement.has(total_key) or measurement.has("modulus")
    if own_range.has("highest") and not has_total:
        problem = f"'highest' has no effect without {quoted(total_key)}; add it, or remove 'highest'"
        report.add("measurement-shape", (*path, "highest"), problem, at_key=True)


def _check_step(located_measurement: LocatedPart[Measurement], report: DocumentReport) -> None:
    """Check that a length has one step, and that ``per_counts`` belongs to a step in nanometres."""
    measurement = located_measurement.part
    path = located_measurement.path
    has_step_um = measurement.step_um is not None
    has_step_nm = measurement.step_nm is not None
    if has_step_um and has_step_nm:
        problem = "'step_um' and 'step_nm' exclude each other; keep the one that is a whole number"
        report.add("measurement-shape", (*path, "step_nm"), problem, at_key=True)
    elif measurement.per_counts is not None and not has_step_nm:
        problem = "'per_counts' is only for 'step_nm', the number of nanometres for that many counts"
        report.add("measurement-shape", (*path, "per_counts"), problem, at_key=True)
