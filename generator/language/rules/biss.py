"""Rules for facts fixed by BiSS itself (PROT p. 9-15): register addresses, single cycle frame, control frame."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ...model import Biss, Crc
from ..keys_of_fields import WrittenField, WrittenRegister
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, Path, quoted
from ..written import LocatedPart
from .parts import (
    bank_select_register,
    by_name,
    by_part_name,
    interface_name_of,
    is_explained_at,
    layouts_of_interfaces,
    position_names,
    with_groups_expanded,
)


class _ProfileRegister(NamedTuple):
    """A register of the BiSS profile: its fixed address, its length, and its address in words."""

    address: int
    byte_count: int
    address_text: str


#: Registers with a fixed address in BiSS, by their usual name.
_PROFILE_REGISTER_BY_NAME = {
    "eds_bank": _ProfileRegister(0x41, 1, "at 41h"),
    "profile_id": _ProfileRegister(0x42, 2, "at 42h and 43h"),
    "serial_number": _ProfileRegister(0x44, 4, "at 44h to 47h"),
    "device_id": _ProfileRegister(0x78, 6, "at 78h to 7Dh"),
    "manufacturer_id": _ProfileRegister(0x7E, 2, "at 7Eh and 7Fh"),
}
#: The register that selects banks.
_BANK_SELECT_REGISTER = _ProfileRegister(0x40, 1, "at 40h")

#: Names of nE and nW in specs.
_BISS_FLAG_NAMES = {"error", "warning"}
#: Widths of the parts of a control frame, and the two access directions.
_BIT_COUNT_BY_CONTROL_FIELD = {"register_address": 7, "address": 7, "rw": 2, "data": 8}
_CODE_BY_ACCESS = {"write": 0b01, "read": 0b10}
#: Widths of the usual CRCs of BiSS, by the number that inverts them.
_CRC_WIDTH_BY_XOROUT = {0x3F: 6, 0xFFFF: 16}


def check_biss_places(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the registers of the BiSS profile, such as ``serial_number``, have the address and length of BiSS.

    The register that selects banks has a fixed address under any name. Other registers in a bank are not checked.
    """
    biss_registers = [register for register in spec.registers if interface_name_of(register) == Biss.name]
    for register in biss_registers:
        name = register.name
        selects_banks = name == bank_select_register(spec)
        is_in_bank = register.bank is not None
        if is_in_bank and not selects_banks:
            continue
        profile_register = _BANK_SELECT_REGISTER if selects_banks else _PROFILE_REGISTER_BY_NAME.get(name)
        if profile_register is None:
            continue
        if register.address != profile_register.address or is_in_bank:
            problem = f"{quoted(name)} is at {register.address:02X}h, but BiSS has"
            if selects_banks:
                message = f"{problem} the register that selects banks {profile_register.address_text}"
            else:
                remedy = "correct the address, or rename the register if it is a different one"
                message = f"{problem} it {profile_register.address_text}; {remedy}"
            report.add("biss-protocol", register.path_of("address"), message)
        elif register.length != profile_register.byte_count:
            message = f"{quoted(name)} has {register.length} bytes; in BiSS it has {profile_register.byte_count}"
            report.add("biss-protocol", register.path_of("length"), f"{message}, {profile_register.address_text}")


def check_taken_biss_places(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no register with another name is at an address of the BiSS profile, unless an erratum explains it.

    A part of a register of the profile is accepted: one that is read-only, or whose name begins with the fixed name,
    such as ``profile_id_low``. Manuals use 40h and 41h for other purposes if there are no banks.
    """
    for register in spec.registers:
        name = register.name
        has_profile_name = name in _PROFILE_REGISTER_BY_NAME or name == bank_select_register(spec)
        if has_profile_name or not _is_biss_register_outside_banks(register):
            continue
        profile_name = _find_occupied_profile_register(register)
        if profile_name is None or is_explained_at(report.document, "registers", name, "address"):
            continue
        first_address = register.address
        last_address = register.address + register.length - 1
        is_one_byte = first_address == last_address
        address_text = f"at {first_address:02X}h" if is_one_byte else f"at {first_address:02X}h to {last_address:02X}h"
        profile_register = _PROFILE_REGISTER_BY_NAME[profile_name]
        problem = (
            f"{quoted(name)} is {address_text}, but BiSS has {quoted(profile_name)} {profile_register.address_text}"
        )
        remedy = (
            f"correct the address, or rename the register to {quoted(profile_name)} if that is the one you mean. If"
            f" this is what the manual says, add an erratum that affects registers.{name}.address"
        )
        report.add("biss-protocol", register.path_of("address"), f"{problem}; {remedy}")


def _is_biss_register_outside_banks(register: WrittenRegister) -> bool:
    """Return True for a register that is accessed over BiSS and does not belong to a bank."""
    return interface_name_of(register) == Biss.name and register.bank is None


def _find_occupied_profile_register(register: WrittenRegister) -> str | None:
    """Return the name of the BiSS profile's register at the addresses of ``register``, which has another name.

    The result is None if there is no such register, or if ``register`` may be there: as a part of it, or at 41h.
    """
    addresses = set(range(register.address, register.address + register.length))
    for profile_name, profile_register in _PROFILE_REGISTER_BY_NAME.items():
        profile_addresses = set(range(profile_register.address, profile_register.address + profile_register.byte_count))
        may_be_part = register.access == "read_only" or register.name.startswith(profile_name)
        is_part = may_be_part and addresses <= profile_addresses
        is_free = profile_name == "eds_bank"  # At 41h. Without banks, manuals use it for other purposes.
        if addresses & profile_addresses and not is_part and not is_free:
            return profile_name
    return None


def check_biss_byte_order(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers of the BiSS profile have their highest byte first, unless an erratum explains it."""
    for register in spec.registers:
        name = register.name
        if name not in _PROFILE_REGISTER_BY_NAME or not _is_biss_register_outside_banks(register):
            continue
        is_low_byte_first = register.byte_order == "low_byte_first"
        if is_low_byte_first and not is_explained_at(report.document, "registers", name, "byte_order"):
            message = (
                f"{quoted(name)} has its low byte first, but in BiSS the most significant byte has the lowest address."
                f" If this is what the manual says, add an erratum that affects registers.{name}.byte_order"
            )
            report.add("biss-protocol", register.path_of("byte_order"), message)


def check_biss_frame(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check frames with the error bit nE or the warning bit nW of BiSS.

    Both must be active low and follow the position, nE before nW, and the frame must end with an inverted CRC. An
    erratum explains what the manual prints differently.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    crc_by_name = by_part_name(spec.with_invalid_parts.crcs)
    for frame in layouts_of_interfaces(spec):
        layout = frame.layout
        if layout is None or frame.interface != Biss.name or not frame.is_from_encoder:
            continue
        sent_fields = list(with_groups_expanded(frame, group_by_name))
        if _BISS_FLAG_NAMES.isdisjoint(field.name for _, field in sent_fields):
            continue
        frame_path = f"interfaces.{Biss.name}.{layout.name}"
        names_of_position = position_names(spec, Biss.name)
        contradictions = [
            *_contradictions_of_fields(sent_fields, crc_by_name, frame_path),
            *_contradictions_of_order(sent_fields, layout.path_of("name"), frame_path),
            *_contradictions_of_late_position(sent_fields, names_of_position, frame_path),
        ]
        for contradiction in contradictions:
            affected_path = contradiction.path_for_erratum
            if not is_explained_at(report.document, affected_path):
                hint = f"If this is what the manual says, add an erratum that affects {affected_path}"
                report.add("biss-protocol", contradiction.path, f"{contradiction.problem}. {hint}")


@dataclass(frozen=True, slots=True)
class _Contradiction:
    """A contradiction to BiSS, with its place, and the path that an erratum must affect to explain it."""

    path: Path
    path_for_erratum: str
    problem: str


#: The fields of a frame with their paths, in the order in which they are sent.
SentFields = list[tuple[Path, WrittenField]]


def _contradictions_of_fields(
    sent_fields: SentFields, crc_by_name: Mapping[str, LocatedPart[Crc]], frame_path: str
) -> Iterator[_Contradiction]:
    """Yield the contradictions of single fields of a frame to BiSS.

    These are an nE or nW that is active high, a CRC that covers only some fields (``crc_of``), and other numbers of the
    CRC.
    """
    for path, field in sent_fields:
        name = field.name
        if name in _BISS_FLAG_NAMES and field.active == "high":
            problem = f"{quoted(name)} is active high, but in BiSS it is active low; write 'active: low'"
            yield _Contradiction(
                path=(*path, "active"), path_for_erratum=f"{frame_path}.{name}.active", problem=problem
            )
        if field.crc_of:
            problem = f"{quoted(name)} has 'crc_of', but in BiSS the CRC covers everything before it; remove 'crc_of'"
            yield _Contradiction(path=(*path, "crc_of"), path_for_erratum=f"{frame_path}.{name}", problem=problem)
        if field.crc not in crc_by_name:
            continue
        for key, problem in _contradictions_of_crc(crc_by_name[field.crc]):
            path_for_erratum = f"crcs.{field.crc}.{key}"
            yield _Contradiction(path=(*path, "crc"), path_for_erratum=path_for_erratum, problem=problem)


def _contradictions_of_order(sent_fields: SentFields, path_of_name: Path, frame_path: str) -> Iterator[_Contradiction]:
    """Yield a contradiction to BiSS if a frame has nW before nE, and one if it has no CRC.

    A missing CRC is reported at the name of the frame.
    """
    names_as_sent = [field.name for _, field in sent_fields]
    has_both = "error" in names_as_sent and "warning" in names_as_sent
    is_warning_first = has_both and names_as_sent.index("warning") < names_as_sent.index("error")
    if is_warning_first:
        path, _ = sent_fields[names_as_sent.index("warning")]
        problem = "'warning' is before 'error', but BiSS sends nE before nW; swap the two"
        yield _Contradiction(path=path, path_for_erratum=f"{frame_path}.warning", problem=problem)
    has_crc = any(field.crc for _, field in sent_fields)
    if not has_crc:
        remedy = "add a last field such as {name: crc, crc: NAME}"
        problem = f"the frame has no CRC, but a BiSS frame ends with one; {remedy}"
        yield _Contradiction(path=path_of_name, path_for_erratum=f"{frame_path}.fields", problem=problem)


def _contradictions_of_late_position(
    sent_fields: SentFields, names_of_position: set[str], frame_path: str
) -> Iterator[_Contradiction]:
    """Yield a contradiction to BiSS for the first field of the position that is sent after nE or nW, if there is one.

    ``names_of_position`` are the names of the fields and joined numbers that form the position.
    """
    first_flag_name = ""
    for path, field in sent_fields:
        name = field.name
        if name in _BISS_FLAG_NAMES:
            first_flag_name = first_flag_name or name
        elif first_flag_name and name in names_of_position:
            problem = f"{quoted(name)} is after {quoted(first_flag_name)}, but BiSS sends the position before nE and nW"
            yield _Contradiction(
                path=path,
                path_for_erratum=f"{frame_path}.{name}",
                problem=f"{problem}; move it before {quoted(first_flag_name)}",
            )
            return


def _message_on_inverted_bits(crc: Crc) -> str:
    """Return the message about a CRC whose ``xorout`` inverts 6 or 16 bits, as BiSS does, but has another width."""
    inverted_bits = _CRC_WIDTH_BY_XOROUT[crc.xorout]
    width = crc.width
    statement = f"the CRC {quoted(crc.name)} has 'width' {width}"
    problem = f"{statement}, but its 'xorout' {crc.xorout:#x} inverts {inverted_bits} bits"
    other_remedy = f"'xorout: {_all_ones(width):#x}' if the manual has a CRC of {width} bits"
    return f"{problem}; write 'width: {inverted_bits}', or {other_remedy}"


def _all_ones(width: int) -> int:
    """Return the number whose bits are all 1: 0x3F for a width of 6 bits."""
    return (1 << width) - 1


def _contradictions_of_crc(located_crc: LocatedPart[Crc]) -> Iterator[tuple[str, str]]:
    """Yield each key of a CRC that contradicts BiSS, with a message.

    BiSS inverts all bits of a CRC (``xorout``), and sends it most significant bit first (neither ``refin`` nor
    ``refout``).
    """
    crc = located_crc.part
    has_valid_numbers = 0 < crc.width <= 64 and located_crc.is_valid("xorout")
    # Another rule reports a larger number as too wide.
    if has_valid_numbers and crc.xorout < _all_ones(crc.width):
        if crc.xorout in _CRC_WIDTH_BY_XOROUT:
            yield "xorout", _message_on_inverted_bits(crc)
        else:
            xorout_text = f"{crc.xorout:#x}" if crc.xorout else "0"
            problem = f"the CRC {quoted(crc.name)} has 'xorout' {xorout_text}, but BiSS sends the CRC inverted"
            yield "xorout", f"{problem}; write 'xorout: {_all_ones(crc.width):#x}'"
    for key, is_reflected in (("refin", crc.refin), ("refout", crc.refout)):
        if is_reflected:
            problem = (
                f"the CRC {quoted(crc.name)} has {quoted(key)} true, but BiSS sends the CRC most significant bit first"
            )
            yield key, f"{problem}; write '{key}: false'"


def check_biss_control(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the control frame has the widths, the codes for reading and writing, and the CRC of BiSS.

    Every master relies on them, so a spec has these numbers even if an erratum records others that the manual prints.
    """
    crc_by_name = by_part_name(spec.with_invalid_parts.crcs)
    interface = spec.interfaces.biss
    control_data = interface.control_data if interface is not None else None
    fields = control_data.fields if control_data is not None else ()
    for field in fields:
        width = _BIT_COUNT_BY_CONTROL_FIELD.get(field.name)
        if width is not None and isinstance(field.bits, int) and field.bits != width:
            message = f"{quoted(field.name)} has {field.bits} bits; in the BiSS control frame it has {width}"
            report.add("biss-protocol", field.path_of("bits"), message)
        if field.name == "rw":
            _check_access_codes(field, report)
        crc = crc_by_name.get(field.crc)
        if crc is not None and not _is_control_crc(crc):
            problem = (
                f"{quoted(field.crc)} is not the CRC of the BiSS control frame: 4 bits, poly 0x3, init 0, not"
                " reflected, xorout 0xF; write these numbers. If the manual prints others, add an erratum with both"
            )
            report.add("biss-protocol", field.path_of("crc"), problem)


def _is_control_crc(located_crc: LocatedPart[Crc]) -> bool:
    """Return True for the CRC of the BiSS control frame: x^4 + x + 1 (0x3), start value 0, not reflected, inverted."""
    crc = located_crc.part
    is_complete = all(map(located_crc.is_valid, ("init", "refin", "refout")))
    is_reflected = crc.refin or crc.refout
    has_numbers_of_biss = (crc.width, crc.poly, crc.init, crc.xorout) == (4, 0x3, 0, 0xF)
    return is_complete and not is_reflected and has_numbers_of_biss


def _check_access_codes(field: WrittenField, report: DocumentReport) -> None:
    """Check that the field of a control frame for the kind of access has 01 for ``write`` and 10 for ``read``."""
    for name, value in field.values.items():
        if name in _CODE_BY_ACCESS and value.value != _CODE_BY_ACCESS[name]:
            problem = f"{quoted(name)} is {value.value:02b}; in the BiSS control frame, 01 means write and 10"
            report.add("biss-protocol", value.path_of("value"), f"{problem} means read")


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
    if not is_consistent and not is_explained_at(report.document, affected_path):
        slaves_text = "several slaves" if has_several_slaves else "one slave"
        message = (
            f"the topology is {quoted(topology)}, but the interface has {slaves_text}; correct one of"
            f" them. If this is what the manual says, add an erratum that affects {affected_path}"
        )
        report.add("network-mismatch", (*network.path, "multiple_slaves"), message)


#: Name of a device description file: idbiss and the manufacturer ID in hexadecimal.
_DESCRIPTION_FILE = re.compile(r"idbiss([0-9A-Fa-f]+)\.xml")


def check_description_file(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the file name of the BiSS device description contains the manufacturer ID that the register holds.

    The register holds two ASCII characters, and the file name contains their four hexadecimal digits.
    """
    biss = spec.interfaces.biss
    register = by_name(spec.registers).get("manufacturer_id")
    if biss is None or register is None or interface_name_of(register) != Biss.name:
        return
    file_name_match = _DESCRIPTION_FILE.fullmatch(biss.description_file)
    if file_name_match is None:
        return
    fixed_field_texts = [field.equals for field in register.fields if isinstance(field.equals, str)]
    ascii_texts = [text for text in fixed_field_texts if text.isascii()]
    id_of_register = "".join(ascii_texts).encode("ascii").hex()  # 4c41 for LA.
    id_in_file_name = file_name_match[1]
    is_complete = len(id_of_register) == 4
    if is_complete and id_of_register != id_in_file_name.casefold():
        message = (
            f"the file is for the manufacturer ID {id_in_file_name.upper()}h, but the register 'manufacturer_id' has"
            f" {id_of_register.upper()}h; correct one of the two"
        )
        report.add("description-file", biss.path_of("description_file"), message)
