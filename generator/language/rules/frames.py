"""Rules for frames: senders, coverage by parity bits, requests by data ID, memory accesses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...model import Biss, Rs485, Ssi
from ...model.interfaces import DataId
from ..problems import DocumentReport, join_words, quoted
from ..written import LocatedPart
from ..written_interfaces import WrittenRs485
from ..written_layouts import WrittenField, WrittenLayout
from ..written_parts import WrittenSpec
from .parts import (
    FieldList,
    FieldOwner,
    Groups,
    by_name,
    has_erratum_at,
    is_second_reading,
    layouts_of_interfaces,
    with_groups_expanded,
)

#: Interfaces over which a master sends only a clock, or control data, which are not a layout.
_WITHOUT_REQUESTS = frozenset((Biss.name, Ssi.name))
#: Purposes of requests that carry an address.
_PURPOSES_WITH_ADDRESS = frozenset(("read", "write"))


def check_layouts_without_requests(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every layout over BiSS and SSI is sent by the encoder, because the master sends no frames there."""
    for frame in layouts_of_interfaces(spec):
        layout = frame.layout
        if layout is not None and frame.interface in _WITHOUT_REQUESTS and layout.from_ == "master":
            message = f"a master sends no frame over {frame.interface}; write 'from: encoder'"
            report.add("sender", layout.place_of("from"), message)


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
        if _can_change_parity(field) and covered_or_noted_names.isdisjoint(_names_of(field)):
            uncovered_names.append(field.name)
    if uncovered_names:
        parity_field = parity_fields[0]
        pronoun = "it" if len(uncovered_names) == 1 else "them"
        message = (
            f"{quoted(parity_field.name)} does not cover {join_words(map(quoted, uncovered_names))}; "
            f"add {pronoun} to 'parity_of', or name {pronoun} in a 'note' if the manual excludes {pronoun}"
        )
        report.add("parity-coverage", parity_field.place_of("parity_of"), message)


def _names_of(field: WrittenField) -> set[str]:
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


def check_slaves(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a BiSS bus can have several slaves, and a point-to-point connection only one.

    An erratum can explain a manual that says otherwise.
    """
    biss = spec.interfaces.biss
    network = biss.network if biss is not None else None
    if network is None or not network.is_valid("topology") or not network.is_valid("multiple_slaves"):
        return
    topology, has_several_slaves = network.part.topology, network.part.multiple_slaves
    is_consistent = has_several_slaves == (topology == "bus")
    affected_path = ".".join(map(str, network.path))
    if not is_consistent and not has_erratum_at(report.document, affected_path):
        slaves_text = "several slaves" if has_several_slaves else "one slave"
        message = (
            f"the topology is {quoted(topology)}, but the interface has {slaves_text}; correct one of"
            f" them. If this is what the manual says, add an erratum that affects {affected_path}"
        )
        report.add("network-mismatch", (*network.path, "multiple_slaves"), message)


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
    requested_ids = set(_selected_ids(requests))
    replied_ids = set(_selected_ids(replies))
    all_list_data_ids = all(layout.has("when") for layout in rs485.layouts)
    if requested_ids and replied_ids and all_list_data_ids:
        for data_id in rs485.data_ids:
            _report_missing_frame(data_id, requested_ids, replied_ids, report)


def _selected_ids(sent_layouts: Sequence[WrittenLayout]) -> Iterator[int]:
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
    groups = by_name(spec.with_invalid_parts.field_groups)
    for data_id in rs485.data_ids:
        request = _find_request(data_id, rs485)
        accesses_memory = data_id.part.purpose in _PURPOSES_WITH_ADDRESS
        if request is None or not accesses_memory:
            continue
        has_data = any(_carries_data(field) for field in _fields_of(request, groups))
        if not has_data:
            message = (
                f"{quoted(data_id.part.name)} has the purpose {quoted(data_id.part.purpose)}, but its request"
                f" {quoted(request.name)} carries only the data ID; correct one of the two"
            )
            report.add("request-purpose", (*data_id.path, "purpose"), message)


def _find_request(data_id: LocatedPart[DataId], rs485: WrittenRs485) -> WrittenLayout | None:
    """Return the layout of the request that the master sends for a data ID, or None if no layout lists the data ID."""
    for layout in rs485.layouts:
        if layout.from_ == "master" and data_id.part.id in _selected_ids([layout]):
            return layout
    return None


def _fields_of(layout: WrittenLayout, groups: Groups) -> Iterator[WrittenField]:
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
                report.add("request-purpose", step.place_of("data_id"), message)


def check_memory_accesses(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no two rows of ``memory_access`` describe the same reply: the same access with the same busy flag."""
    rs485 = spec.interfaces.rs485
    replies = [reply for reply in rs485.memory_access if reply.is_valid("busy")] if rs485 is not None else []
    earlier_replies: set[tuple[str, int]] = set()  # By the access and the busy flag.
    for reply in replies:
        access, busy_flag = reply.part.access, reply.part.busy
        if (access, busy_flag) in earlier_replies:
            message = f"there is already a row for {access} with 'busy' {busy_flag}; correct one of the two"
            report.add("memory-access-repeated", (*reply.path, "busy"), message)
        earlier_replies.add((access, busy_flag))
