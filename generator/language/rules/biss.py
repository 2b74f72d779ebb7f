"""Rules for facts fixed by BiSS itself (PROT p. 9-15): register addresses, single cycle frame, control frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ...model import Biss, Crc
from ..problems import DocumentReport, Path, quoted
from ..written import LocatedPart
from ..written_codes import WrittenRegister
from ..written_layouts import WrittenField
from ..written_parts import WrittenSpec
from .parts import (
    bank_select_register,
    by_name,
    by_part_name,
    has_erratum_at,
    interface_name_of,
    layouts_of_interfaces,
    position_names,
    with_groups_expanded,
)

#: Registers with a fixed place in BiSS, by their usual name: address, length, and the place in words.
_STANDARD_REGISTERS = {
    "eds_bank": (0x41, 1, "at 41h"),
    "profile_id": (0x42, 2, "at 42h and 43h"),
    "serial_number": (0x44, 4, "at 44h to 47h"),
    "device_id": (0x78, 6, "at 78h to 7Dh"),
    "manufacturer_id": (0x7E, 2, "at 7Eh and 7Fh"),
}
_BANK_SELECT = (0x40, 1, "at 40h")

#: Names of nE and nW in specs.
_ERROR_AND_WARNING = {"error", "warning"}
#: Widths of the parts of a control frame, and the two access directions.
_CONTROL_FRAME_WIDTHS = {"register_address": 7, "address": 7, "rw": 2, "data": 8}
_ACCESS_BITS = {"write": 0b01, "read": 0b10}
#: Widths of the usual CRCs of BiSS, by the number that inverts them.
_CRC_WIDTH_BY_XOROUT = {0x3F: 6, 0xFFFF: 16}


def check_biss_places(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the registers of the BiSS profile, such as ``serial_number``, have the address and length of BiSS.

    The register that selects banks has a fixed address under any name. Other registers in a bank are not checked.
    """
    for register in spec.registers:
        name = register.name
        selects_banks = name == bank_select_register(spec)
        fixed_place = _BANK_SELECT if selects_banks else _STANDARD_REGISTERS.get(name)
        is_in_bank = register.bank is not None
        if fixed_place is None or interface_name_of(register) != Biss.name or (is_in_bank and not selects_banks):
            continue
        address, length, place_text = fixed_place  # Such as 0x40, 1 and "at 40h".
        if register.address != address or is_in_bank:
            problem = f"{quoted(name)} is at {register.address:02X}h, but BiSS has"
            if selects_banks:
                message = f"{problem} the register that selects banks {place_text}"
            else:
                remedy = "correct the address, or rename the register if it is a different one"
                message = f"{problem} it {place_text}; {remedy}"
            report.add("biss-protocol", register.place_of("address"), message)
        elif register.length != length:
            message = f"{quoted(name)} has {register.length} bytes; in BiSS it has {length}, {place_text}"
            report.add("biss-protocol", register.place_of("length"), message)


def check_taken_biss_places(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no register with another name is at an address of the BiSS profile, unless an erratum explains it.

    A part of a register of the profile is accepted: one that is read-only, or whose name begins with the fixed name,
    such as ``profile_id_low``. Manuals use 40h and 41h for other purposes if there are no banks.
    """
    for register in spec.registers:
        name = register.name
        has_fixed_name = name in _STANDARD_REGISTERS or name == bank_select_register(spec)
        if interface_name_of(register) != Biss.name or register.bank is not None or has_fixed_name:
            continue
        fixed_name = _profile_register_at(register)
        if fixed_name is None or has_erratum_at(report.document, "registers", name, "address"):
            continue
        first_address = register.address
        last_address = register.address + register.length - 1
        is_one_byte = first_address == last_address
        address_text = f"at {first_address:02X}h" if is_one_byte else f"at {first_address:02X}h to {last_address:02X}h"
        _, _, fixed_place_text = _STANDARD_REGISTERS[fixed_name]
        problem = f"{quoted(name)} is {address_text}, but BiSS has {quoted(fixed_name)} {fixed_place_text}"
        remedy = (
            f"correct the address, or rename the register to {quoted(fixed_name)} if that is the one you mean. If"
            f" this is what the manual says, add an erratum that affects registers.{name}.address"
        )
        report.add("biss-protocol", register.place_of("address"), f"{problem}; {remedy}")


def _profile_register_at(register: WrittenRegister) -> str | None:
    """Return the name of the BiSS profile's register at the addresses of ``register``, which has another name.

    The result is None if there is no such register, or if ``register`` may be there: as a part of it, or at 41h.
    """
    first_address = register.address
    end_address = register.address + register.length
    for fixed_name, (fixed_first, length, _) in _STANDARD_REGISTERS.items():
        fixed_end = fixed_first + length
        overlaps = first_address < fixed_end and fixed_first < end_address
        is_inside = fixed_first <= first_address and end_address <= fixed_end
        is_part = is_inside and (register.access == "read_only" or register.name.startswith(fixed_name))
        may_be_used = fixed_name == "eds_bank"  # At 41h. Without banks, manuals use it for other purposes.
        if not may_be_used and overlaps and not is_part:
            return fixed_name
    return None


def check_biss_byte_order(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers of the BiSS profile have their highest byte first, unless an erratum explains it."""
    for register in spec.registers:
        name = register.name
        if name not in _STANDARD_REGISTERS or interface_name_of(register) != Biss.name or register.bank is not None:
            continue
        is_low_byte_first = register.byte_order == "low_byte_first"
        if is_low_byte_first and not has_erratum_at(report.document, "registers", name, "byte_order"):
            message = (
                f"{quoted(name)} has its low byte first, but in BiSS the most significant byte has the lowest address."
                f" If this is what the manual says, add an erratum that affects registers.{name}.byte_order"
            )
            report.add("biss-protocol", register.place_of("byte_order"), message)


def check_biss_frame(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check frames with the error bit nE or the warning bit nW of BiSS.

    Both must be active low and follow the position, nE before nW, and the frame must end with an inverted CRC. An
    erratum explains what the manual prints differently.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    crcs = by_part_name(spec.with_invalid_parts.crcs)
    for frame in layouts_of_interfaces(spec):
        layout = frame.layout
        if layout is None or frame.interface != Biss.name or not frame.is_from_encoder:
            continue
        sent_fields = list(with_groups_expanded(frame, groups))
        if _ERROR_AND_WARNING.isdisjoint(field.name for _, field in sent_fields):
            continue
        frame_path = f"interfaces.{Biss.name}.{layout.name}"
        contradictions = [
            *_contradictions_of_fields(sent_fields, crcs, frame_path),
            *_contradictions_of_order(sent_fields, layout.place_of("name"), frame_path),
            *_late_positions(sent_fields, position_names(spec, Biss.name), frame_path),
        ]
        for contradiction in contradictions:
            affected_path = contradiction.path_for_erratum
            if not has_erratum_at(report.document, affected_path):
                hint = f"If this is what the manual says, add an erratum that affects {affected_path}"
                report.add("biss-protocol", contradiction.path, f"{contradiction.problem}. {hint}")


@dataclass(frozen=True, slots=True)
class _Contradiction:
    """A contradiction to BiSS, with its place, and the path that an erratum must affect to explain it."""

    path: Path
    path_for_erratum: str
    problem: str


SentFields = list[tuple[Path, WrittenField]]


def _contradictions_of_fields(
    sent_fields: SentFields, crcs: Mapping[str, LocatedPart[Crc]], frame_path: str
) -> Iterator[_Contradiction]:
    """Yield the contradictions of single fields of a frame to BiSS.

    These are an nE or nW that is active high, a CRC that covers only some fields (``crc_of``), and other numbers of the
    CRC.
    """
    for path, field in sent_fields:
        name = field.name
        if name in _ERROR_AND_WARNING and field.active == "high":
            problem = f"{quoted(name)} is active high, but in BiSS it is active low; write 'active: low'"
            yield _Contradiction((*path, "active"), f"{frame_path}.{name}.active", problem)
        if field.crc_of:
            problem = f"{quoted(name)} has 'crc_of', but in BiSS the CRC covers everything before it; remove 'crc_of'"
            yield _Contradiction((*path, "crc_of"), f"{frame_path}.{name}", problem)
        if field.crc not in crcs:
            continue
        for key, problem in _contradictions_of_crc(crcs[field.crc]):
            yield _Contradiction((*path, "crc"), f"crcs.{field.crc}.{key}", problem)


def _contradictions_of_order(sent_fields: SentFields, place_of_name: Path, frame_path: str) -> Iterator[_Contradiction]:
    """Yield a contradiction to BiSS if a frame has nW before nE, and one if it has no CRC.

    A missing CRC is reported at the name of the frame.
    """
    names = [field.name for _, field in sent_fields]
    has_both = "error" in names and "warning" in names
    if has_both and names.index("error") > names.index("warning"):
        path, _ = sent_fields[names.index("warning")]
        problem = "'warning' is before 'error', but BiSS sends nE before nW; swap the two"
        yield _Contradiction(path, f"{frame_path}.warning", problem)
    has_crc = any(field.crc for _, field in sent_fields)
    if not has_crc:
        correction = "add a last field such as {name: crc, crc: NAME}"
        problem = f"the frame has no CRC, but a BiSS frame ends with one; {correction}"
        yield _Contradiction(place_of_name, f"{frame_path}.fields", problem)


def _late_positions(sent_fields: SentFields, names: set[str], frame_path: str) -> Iterator[_Contradiction]:
    """Yield a contradiction to BiSS for the first field of the position that is sent after nE or nW, if there is one.

    ``names`` are the names of the fields and joined numbers that form the position.
    """
    first_flag = ""
    for path, field in sent_fields:
        name = field.name
        if not first_flag:
            # The position may be before the first flag.
            first_flag = name if name in _ERROR_AND_WARNING else ""
        elif name in names and name not in _ERROR_AND_WARNING:
            problem = f"{quoted(name)} is after {quoted(first_flag)}, but BiSS sends the position before nE and nW"
            yield _Contradiction(path, f"{frame_path}.{name}", f"{problem}; move it before {quoted(first_flag)}")
            return


def _message_on_inverted_bits(crc: Crc) -> str:
    """Return the message about a CRC whose ``xorout`` inverts 6 or 16 bits, as BiSS does, but has another width."""
    inverted_bits = _CRC_WIDTH_BY_XOROUT[crc.xorout]
    width = crc.width
    problem = (
        f"the CRC {quoted(crc.name)} has 'width' {width}, but its 'xorout' {crc.xorout:#x} inverts {inverted_bits} bits"
    )
    other_remedy = f"'xorout: {_all_ones(width):#x}' if the manual has a CRC of {width} bits"
    return f"{problem}; write 'width: {inverted_bits}', or {other_remedy}"


def _all_ones(width: int) -> int:
    return (1 << width) - 1


def _contradictions_of_crc(located_crc: LocatedPart[Crc]) -> Iterator[tuple[str, str]]:
    """Yield each key of a CRC that contradicts BiSS, with a message.

    BiSS inverts all bits of a CRC (``xorout``), and sends it most significant bit first (neither ``refin`` nor
    ``refout``).
    """
    crc = located_crc.part
    is_valid = 0 < crc.width <= 64 and located_crc.is_valid("xorout")
    # Another rule reports a larger number as too wide.
    if is_valid and crc.xorout < _all_ones(crc.width):
        if crc.xorout in _CRC_WIDTH_BY_XOROUT:
            yield "xorout", _message_on_inverted_bits(crc)
        else:
            value = f"{crc.xorout:#x}" if crc.xorout else "0"
            problem = f"the CRC {quoted(crc.name)} has 'xorout' {value}, but BiSS sends the CRC inverted"
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
    crcs = by_part_name(spec.with_invalid_parts.crcs)
    interface = spec.interfaces.biss
    control_data = interface.control_data if interface is not None else None
    for field in control_data.fields if control_data is not None else ():
        width = _CONTROL_FRAME_WIDTHS.get(field.name)
        if width is not None and isinstance(field.bits, int) and field.bits != width:
            message = f"{quoted(field.name)} has {field.bits} bits; in the BiSS control frame it has {width}"
            report.add("biss-protocol", field.place_of("bits"), message)
        if field.name == "rw":
            _check_access_codes(field, report)
        crc = crcs.get(field.crc)
        if crc is not None and not _is_control_crc(crc):
            problem = (
                f"{quoted(field.crc)} is not the CRC of the BiSS control frame: 4 bits, poly 0x3, init 0, not"
                " reflected, xorout 0xF; write these numbers. If the manual prints others, add an erratum with both"
            )
            report.add("biss-protocol", field.place_of("crc"), problem)


def _is_control_crc(crc: LocatedPart[Crc]) -> bool:
    """Return True for the CRC of the BiSS control frame: x^4 + x + 1 (0x3), start value 0, not reflected, inverted."""
    part = crc.part
    numbers = (part.width, part.poly, part.init, part.xorout)
    is_reflected = part.refin or part.refout
    is_complete = all(map(crc.is_valid, ("init", "refin", "refout")))
    return is_complete and not is_reflected and numbers == (4, 0x3, 0, 0xF)


def _check_access_codes(field: WrittenField, report: DocumentReport) -> None:
    """Check that the field of a control frame for the kind of access has 01 for ``write`` and 10 for ``read``."""
    for name, value in field.values.items():
        if name in _ACCESS_BITS and value.value != _ACCESS_BITS[name]:
            problem = f"{quoted(name)} is {value.value:02b}; in the BiSS control frame, 01 means write and 10"
            report.add("biss-protocol", value.place_of("value"), f"{problem} means read")
