"""Rules for frames: senders, parity bits, data IDs, and the measurement and Gray code of the position in them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...model import Biss, Rs485, Ssi
from ...model.interfaces import DataId
from ...model.measurement import LayoutRange, Measurement
from ..keys_of_fields import WrittenField, WrittenGray, WrittenLayout
from ..keys_of_order_codes import WrittenRs485, WrittenSsi
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, join_words, quoted
from ..written import LocatedPart
from .parts import (
    FieldList,
    FieldOwner,
    Groups,
    by_name,
    fields_by_name,
    interfaces,
    is_second_reading,
    layouts_of_interfaces,
    measurements,
    position_names,
    readable_names,
    with_groups_expanded,
)

#: Interfaces over which a master sends only a clock, or control data, which are not a layout.
_INTERFACES_WITHOUT_REQUESTS = frozenset((Biss.name, Ssi.name))
#: Purposes of requests that carry an address.
_PURPOSES_WITH_ADDRESS = frozenset(("read", "write"))


def check_layouts_without_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every layout over BiSS and SSI is sent by the encoder, because the master sends no frames there."""
    for frame in layouts_of_interfaces(spec):
        layout = frame.layout
        if layout is not None and frame.interface in _INTERFACES_WITHOUT_REQUESTS and layout.from_ == "master":
            message = f"a master sends no frame over {frame.interface}; write 'from: encoder'"
            report.add("sender", layout.path_of("from"), message)


def check_parities(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the parity bits of a frame cover all of its fields, except the fields that a note names.

    Frames over RS-485 and frames with a CRC for all order codes are skipped, because the CRC covers them.
    """
    if is_second_reading(report.document):  # Second readings have no notes.
        return
    for frame in layouts_of_interfaces(spec):
        layout = frame.layout
        if layout is None or frame.interface == Rs485.name:
            continue
        # A width that is a text is an expression, which may be 0 for some order codes.
        always_has_crc = any(field.crc and not isinstance(field.bits, str) for field in layout.fields)
        if not always_has_crc:
            for parity_fields in _parities_sent_together(layout):
                _report_uncovered_fields(layout, parity_fields, report)


def _parities_sent_together(layout: WrittenLayout) -> Iterator[list[WrittenField]]:
    """Yield lists of parity bits: the list of all bits that every frame has, then each other bit in its own list.

    The other bits exist only for some order codes.
    """
    parity_fields = [field for field in layout.fields if field.parity_of]
    # A width that is a text is an expression over parameters, so some order codes may have no such bit.
    permanent_fields = [field for field in parity_fields if not isinstance(field.bits, str)]
    if permanent_fields:
        yield permanent_fields
    for field in parity_fields:
        if field not in permanent_fields:
            yield [field]


def _report_uncovered_fields(
    layout: WrittenLayout, parity_fields: Sequence[WrittenField], report: DocumentReport
) -> None:
    """Report the fields of a frame that none of its parity bits covers, unless a note of a parity bit names them."""
    covered_or_noted_names: set[str] = set()
    for parity_field in parity_fields:
        covered_or_noted_names.update(_covered_fields(layout, parity_field.parity_of))
        covered_or_noted_names.update(re.findall(r"\w+", parity_field.note))
    uncovered_names: list[str] = []
    for field in layout.fields:
        if _can_change_parity(field) and covered_or_noted_names.isdisjoint(_name_and_printed_words(field)):
            uncovered_names.append(field.name)
    if uncovered_names:
        parity_field = parity_fields[0]
        pronoun = "it" if len(uncovered_names) == 1 else "them"
        message = (
            f"{quoted(parity_field.name)} does not cover {join_words(map(quoted, uncovered_names))}; "
            f"add {pronoun} to 'parity_of', or name {pronoun} in a 'note' if the manual excludes {pronoun}"
        )
        report.add("parity-coverage", parity_field.path_of("parity_of"), message)


def _name_and_printed_words(field: WrittenField) -> set[str]:
    """Return the name of a field and the words of its printed name."""
    return {field.name, *re.findall(r"\w+", field.printed_name)}


def _can_change_parity(field: WrittenField) -> bool:
    """Return True for a field that a parity bit can cover: any named field except check bits and constant zeros."""
    is_check = bool(field.crc or field.parity_of)
    return bool(field.name) and not is_check and field.constant != 0


def _covered_fields(layout: WrittenLayout, parity_of: Sequence[str]) -> Iterator[str]:
    """Yield the names of the fields that a parity bit covers. A joined number stands for the fields in it."""
    for name in parity_of:
        yield from layout.join.get(name, [name])


def check_layouts_by_data_id(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each data ID of RS-485 has both a request and a reply, or neither.

    A layout lists in ``when`` the data IDs for which it is sent. Nothing is checked if some layout has no such list, or
    if no request or no reply has a data ID.
    """
    rs485 = spec.interfaces.rs485
    if rs485 is None or not rs485.data_ids:
        return
    requests = [layout for layout in rs485.layouts if layout.from_ == "master"]
    replies = [layout for layout in rs485.layouts if layout.from_ == "encoder"]
    requested_ids = set(_data_ids_of_layouts(requests))
    replied_ids = set(_data_ids_of_layouts(replies))
    all_list_data_ids = all(layout.has("when") for layout in rs485.layouts)
    if requested_ids and replied_ids and all_list_data_ids:
        for data_id in rs485.data_ids:
            _report_missing_frame(data_id, requested_ids, replied_ids, report)


def _data_ids_of_layouts(sent_layouts: Sequence[WrittenLayout]) -> Iterator[int]:
    """Yield the numbers of the data IDs for which these layouts are sent, as listed in their ``when``."""
    for layout in sent_layouts:
        for numbers in layout.when.values():
            yield from numbers


def _report_missing_frame(
    data_id: LocatedPart[DataId], requested_ids: set[int], replied_ids: set[int], report: DocumentReport
) -> None:
    """Report a data ID that has only a request or only a reply, unless it reads or writes memory.

    ``requested_ids`` and ``replied_ids`` are the numbers of the data IDs that layouts of requests and replies list.
    """
    number = data_id.part.id
    if not data_id.is_valid("id") or data_id.part.purpose in _PURPOSES_WITH_ADDRESS:
        return
    has_request = number in requested_ids
    has_reply = number in replied_ids
    if has_request != has_reply:
        listed_frame, missing_frame = ("request", "reply") if has_request else ("reply", "request")
        message = (
            f"the data ID {number:#x} of {quoted(data_id.part.name)} has a {listed_frame}, but no {missing_frame}; add"
            f" it to 'when' of the layout of its {missing_frame}"
        )
        report.add("data-id-frames", (*data_id.path, "id"), message)


def check_purposes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a request that reads or writes the memory has more fields than its data ID: it needs an address."""
    rs485 = spec.interfaces.rs485
    if rs485 is None:
        return
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for data_id in rs485.data_ids:
        request = _find_request(data_id, rs485)
        accesses_memory = data_id.part.purpose in _PURPOSES_WITH_ADDRESS
        if request is None or not accesses_memory:
            continue
        has_data = any(_carries_data(field) for field in _fields_with_groups(request, group_by_name))
        if not has_data:
            message = (
                f"{quoted(data_id.part.name)} has the purpose {quoted(data_id.part.purpose)}, but its request"
                f" {quoted(request.name)} carries only the data ID; correct one of the two"
            )
            report.add("request-purpose", (*data_id.path, "purpose"), message)


def _find_request(data_id: LocatedPart[DataId], rs485: WrittenRs485) -> WrittenLayout | None:
    """Return the layout of the request that the master sends for a data ID, or None if no layout lists the data ID."""
    for layout in rs485.layouts:
        if layout.from_ == "master" and data_id.part.id in _data_ids_of_layouts([layout]):
            return layout
    return None


def _fields_with_groups(layout: WrittenLayout, groups: Groups) -> Iterator[WrittenField]:
    """Yield the fields of a layout, including the fields of its groups."""
    field_list = FieldList(FieldOwner.LAYOUT, layout, interface=Rs485.name)
    for _, field in with_groups_expanded(field_list, groups):
        yield field


def _carries_data(field: WrittenField) -> bool:
    """Return True for a field with data. The data ID of the request, fixed bits and check bits are not data."""
    is_fixed = field.constant is not None or field.unused is not None
    is_check = bool(field.crc or field.parity_of)
    return bool(field.name) and not is_fixed and not is_check and not field.values_of


def check_sent_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no step of a procedure sends a request that reads or writes the memory.

    Such a request needs an address, which a step cannot contain.
    """
    rs485 = spec.interfaces.rs485
    data_ids = rs485.data_ids if rs485 is not None else ()
    purpose_by_name = {data_id.part.name: data_id.part.purpose for data_id in data_ids}
    for procedure in spec.procedures:
        for step in procedure.steps:
            purpose = purpose_by_name.get(step.data_id, "")
            if step.do == "send" and purpose in _PURPOSES_WITH_ADDRESS:
                message = (
                    f"{quoted(step.data_id)} has the purpose {quoted(purpose)} and needs an address, which a step"
                    " cannot give; name the data ID of another request"
                )
                report.add("request-purpose", step.path_of("data_id"), message)


def check_memory_accesses(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two rows of ``memory_access`` describe the same reply: the same access with the same busy flag."""
    rs485 = spec.interfaces.rs485
    replies = [reply for reply in rs485.memory_access if reply.is_valid("busy")] if rs485 is not None else []
    earlier_accesses_and_flags: set[tuple[str, int]] = set()  # By the access and the busy flag.
    for reply in replies:
        access, busy_flag = reply.part.access, reply.part.busy
        if (access, busy_flag) in earlier_accesses_and_flags:
            message = f"there is already a row for {access} with 'busy' {busy_flag}; correct one of the two"
            report.add("memory-access-repeated", (*reply.path, "busy"), message)
        earlier_accesses_and_flags.add((access, busy_flag))


#: Placeholder for the name of the position in a message.
_UNKNOWN_POSITION = "POSITION"


def check_output_code(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that ``output_code`` of SSI, Gray or binary, is the code in which its layouts send the position.

    Only the first layout with another code is reported.
    """
    for interface_name, interface in interfaces(spec):
        if not isinstance(interface, WrittenSsi) or not interface.output_code:
            continue
        position_layouts = layouts_with_position(spec, interface_name)
        has_gray = any(gray_of(frame) is not None for frame in position_layouts)
        for frame in position_layouts:
            contradiction = _explain_contradiction(interface.output_code, frame, spec, has_gray=has_gray)
            if contradiction:
                message = f"'output_code' is {interface.output_code}, but {quoted(frame.name)} {contradiction}"
                report.add("output-code", interface.path_of("output_code"), message)
                break


def gray_of(field_list: FieldList) -> WrittenGray | None:
    """Return the key ``gray`` of a layout, which names the number that is sent in Gray code, or None without it."""
    return field_list.layout.gray if field_list.layout is not None else None


def _explain_contradiction(output_code: str, layout: FieldList, spec: WrittenSpec, *, has_gray: bool) -> str:
    """Return how a layout contradicts ``output_code`` of its interface, with the fix. Empty if it does not.

    The key ``gray`` of a layout means that the position is in Gray code, either always or, with ``when``, if that
    parameter of the order code is not 0. ``has_gray`` is True if any layout of the interface has this key.
    """
    gray_key = gray_of(layout)
    if gray_key is None:
        # With ``by_order_code``, it is enough if another layout has the key.
        is_by_order_code = output_code == "by_order_code"
        if output_code == "binary" or (is_by_order_code and has_gray):
            return ""
        position_name = _find_position(layout, spec)
        condition = ", when: PARAMETER" if is_by_order_code else ""
        example = f"'gray: {{of: {position_name}{condition}}}'"
        return f"has no 'gray', so decoders read the position as binary; add {example} to it"
    match output_code:
        case "binary":
            correct_code = "by_order_code" if gray_key.when else "gray"
            return f"has 'gray'; write 'output_code: {correct_code}', or remove 'gray'"
        case "by_order_code" if not gray_key.when:
            return "is always in Gray code; write 'output_code: gray', or add 'when' to 'gray'"
        case "gray" if 0 in _numbers_set_by_codes(spec, layout.interface, gray_key.when):
            return f"is binary where {quoted(gray_key.when)} is 0; write 'output_code: by_order_code'"
    return ""


def layouts_with_position(spec: WrittenSpec, interface_name: str) -> list[FieldList]:
    """Return the layouts that the encoder sends over an interface and that contain the position.

    If no layout has a field with the name of the position, all layouts that the encoder sends are returned.
    """
    layouts = [frame for frame in layouts_of_interfaces(spec) if frame.interface == interface_name]
    sent_layouts = [frame for frame in layouts if frame.is_from_encoder]
    with_position = [frame for frame in sent_layouts if _find_position(frame, spec) != _UNKNOWN_POSITION]
    return with_position or sent_layouts


def _find_position(field_list: FieldList, spec: WrittenSpec) -> str:
    """Return the name of the joined number or field for the position in a layout, or ``POSITION`` if there is none."""
    names_of_position = position_names(spec, field_list.interface)
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    for name in (*field_list.joins, *fields_by_name(field_list, group_by_name)):
        if name in names_of_position:
            return name
    return _UNKNOWN_POSITION


def _numbers_set_by_codes(spec: WrittenSpec, interface_name: str, parameter: str) -> set[int]:
    """Return the numbers to which the order codes for an interface set a parameter.

    A value of an order code that selects no interface applies to every interface.
    """
    numbers: set[int] = set()
    for part in spec.order_code.parts:
        for value in part.values.values():
            applies_to_interface = not value.interface or value.interface == interface_name
            if applies_to_interface and parameter in value.sets:
                numbers.add(value.sets[parameter])
    return numbers


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
    # ``count_size_key`` gives the size of a count. After ``wrap_key``, the position wraps around.
    if movement == "rotary":
        count_size_key, wrap_key, inapplicable_keys = "counts_per_turn", "turns", _KEYS_OF_LENGTH
    else:
        count_size_key, wrap_key, inapplicable_keys = "step_um", "modulus", _KEYS_OF_ANGLE
    measurement_by_path = {measurement.path: measurement for measurement in measurements(spec.with_invalid_parts)}
    for measurement in measurements(spec):
        measurement_with_invalid_keys = measurement_by_path[measurement.path]
        # A key rejected by the schema was removed. It must not be reported as missing, too.
        is_complete = measurement.data.keys() == measurement_with_invalid_keys.data.keys()
        has_count_size = measurement.has(count_size_key) or measurement.part.step_nm is not None
        if is_complete and not has_count_size:
            step_text = "'step_um', or 'step_nm' with 'per_counts',"
            key_text = step_text if movement == "linear" else quoted(count_size_key)
            message = f"{key_text} is missing; the measurement of a {movement} encoder needs it"
            report.add("measurement-shape", measurement.path, message, at_key=True)
        for key in inapplicable_keys:
            if measurement.has(key):
                message = f"{quoted(key)} does not apply to a {movement} encoder"
                report.add("measurement-shape", (*measurement.path, key), message, at_key=True)
        if movement == "linear":
            _check_length_of_count(measurement, report)
        if measurement.has("highest") and not measurement_with_invalid_keys.has(wrap_key):
            problem = f"'highest' has no effect without {quoted(wrap_key)}; add it, or remove 'highest'"
            report.add("measurement-shape", (*measurement.path, "highest"), problem, at_key=True)


def check_position_range_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a layout with its own range of the position contains the position, and that the range has valid keys.

    The position is the field or joined number that the measurement of the interface or of the device names.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    measurement_by_interface = {name: interface.measurement for name, interface in interfaces(spec.with_invalid_parts)}
    frame_by_path = {frame.owner.path: frame for frame in layouts_of_interfaces(spec.with_invalid_parts)}
    for frame in layouts_of_interfaces(spec):
        position_range = frame.layout.position_range if frame.layout is not None else None
        if position_range is None or not position_range.is_given:
            continue
        own_measurement = measurement_by_interface[frame.interface]
        has_own_measurement = own_measurement is not None and own_measurement.is_given
        measurement = own_measurement if has_own_measurement else spec.with_invalid_parts.measurement
        # The path in the file differs if invalid layouts before this one were removed.
        frame_with_invalid_keys = frame_by_path[report.document.path_in_file(frame.owner.path)]
        if measurement is None or not measurement.is_given:
            problem = "'position_range' needs a 'measurement', which gives the unit of the position"
            message = f"{problem}; add it to the interface or the encoder"
            report.add("measurement-shape", position_range.path, message, at_key=True)
        elif not frame_with_invalid_keys.is_from_encoder or measurement.part.of not in readable_names(
            frame_with_invalid_keys, group_by_name
        ):
            position_name = quoted(measurement.part.of)
            problem = (
                f"{quoted(frame_with_invalid_keys.name)} does not carry the position, {position_name}, to the master"
            )
            report.add("measurement-shape", position_range.path, f"{problem}; remove 'position_range'", at_key=True)
        _check_range_keys(position_range, measurement, spec.movement, report)


def _check_range_keys(
    position_range: LocatedPart[LayoutRange],
    measurement: LocatedPart[Measurement] | None,
    movement: str,
    report: DocumentReport,
) -> None:
    """Check that the range of a layout has the keys of the movement, and no other keys next to ``wraps: false``.

    ``highest`` needs a number of turns or a modulus, in the range or in the measurement.
    """
    path = position_range.path
    wrap_key = "turns" if movement == "rotary" else "modulus"
    inapplicable_key = "modulus" if movement == "rotary" else "turns"
    if position_range.has(inapplicable_key) and movement in ("rotary", "linear"):
        problem = f"{quoted(inapplicable_key)} does not apply to a {movement} encoder; write {quoted(wrap_key)}"
        report.add("measurement-shape", (*path, inapplicable_key), problem, at_key=True)
    if not position_range.part.wraps:
        contradicting_keys = [key for key in ("turns", "modulus", "highest") if position_range.has(key)]
        if contradicting_keys:
            key = contradicting_keys[0]
            problem = f"{quoted(key)} contradicts 'wraps: false'; remove one of the two"
            report.add("measurement-shape", (*path, key), problem, at_key=True)
        return
    has_wrap_key = position_range.has(wrap_key) or position_range.has("modulus")
    if measurement is not None and not has_wrap_key:
        has_wrap_key = measurement.has(wrap_key) or measurement.has("modulus")
    if position_range.has("highest") and not has_wrap_key:
        problem = f"'highest' has no effect without {quoted(wrap_key)}; add it, or remove 'highest'"
        report.add("measurement-shape", (*path, "highest"), problem, at_key=True)


def _check_length_of_count(located_measurement: LocatedPart[Measurement], report: DocumentReport) -> None:
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
