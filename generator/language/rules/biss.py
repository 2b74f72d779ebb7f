"""Rules for facts fixed by BiSS itself (PROT p. 9-15): register addresses, single cycle frame, control frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...model import Biss
from ..problems import DocumentReport, Path, quoted
from .bits import position_names
from .walk import Spec, bank_select, by_name, expanded, explained, interface_of, items, layouts, mapping

#: Registers with a fixed place in BiSS, by their usual name: address, length, and the place in words.
_PLACES = {
    "eds_bank": (0x41, 1, "at 41h"),
    "profile_id": (0x42, 2, "at 42h and 43h"),
    "serial_number": (0x44, 4, "at 44h to 47h"),
    "device_id": (0x78, 6, "at 78h to 7Dh"),
    "manufacturer_id": (0x7E, 2, "at 7Eh and 7Fh"),
}
_BANK_SELECT = (0x40, 1, "at 40h")

#: nE and nW.
_FLAGS = {"error", "warning"}
#: Widths of the parts of a control frame, and the two access directions.
_WIDTHS = {"register_address": 7, "address": 7, "rw": 2, "data": 8}
_DIRECTIONS = {"write": 0b01, "read": 0b10}
#: Widths of the usual CRCs of BiSS, by the number that inverts them.
_INVERTED = {0x3F: 6, 0xFFFF: 16}
#: The CRC of a control frame: x^4 + x + 1, start 0, sent inverted.
_CONTROL_CRC = {"width": 4, "poly": 0x3, "init": 0, "refin": False, "refout": False, "xorout": 0xF}


def biss_places(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers with names fixed by BiSS are at their fixed place."""
    select = bank_select(spec)
    for path, register in items(spec, "registers"):
        name = register["name"]
        fixed_place = _BANK_SELECT if name == select else _PLACES.get(name)
        if fixed_place is None or interface_of(register) != Biss.name or ("bank" in register and name != select):
            continue
        address, length, where = fixed_place
        register_words, end = "it", "; correct the address, or rename the register if it is a different one"
        if name == select:
            register_words, end = "the register that selects banks", ""
        if register["address"] != address or "bank" in register:
            report.add(
                "biss-protocol",
                (*path, "address"),
                f"{quoted(name)} is at {register['address']:02X}h, but BiSS has {register_words} {where}{end}",
            )
        elif register["length"] != length:
            report.add(
                "biss-protocol",
                (*path, "length"),
                f"{quoted(name)} has {register['length']} bytes; in BiSS it has {length}, {where}",
            )


def biss_taken(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no other register is at a place fixed by BiSS, unless an erratum explains it.

    A read-only register inside that place is accepted as a part of it under another name. So is any register with the
    name ``profile_id_low``. Manuals use 40h and 41h for other purposes if there are no banks.
    """
    for path, register in items(spec, "registers"):
        name, first_address = register["name"], register["address"]
        if interface_of(register) != Biss.name or "bank" in register or name in _PLACES or name == bank_select(spec):
            continue
        for fixed, (address, length, where) in _PLACES.items():
            overlaps = first_address < address + length and address < first_address + register["length"]
            is_inside = address <= first_address and first_address + register["length"] <= address + length
            is_part = is_inside and (register["access"] == "read_only" or name.startswith(fixed))
            if fixed == "eds_bank" or not overlaps or is_part:
                continue
            if not explained(report.document, "registers", name, "address"):
                last_address = first_address + register["length"] - 1
                address_text = (
                    f"at {first_address:02X}h"
                    if first_address == last_address
                    else f"at {first_address:02X}h to {last_address:02X}h"
                )
                problem = f"{quoted(name)} is {address_text}, but BiSS has {quoted(fixed)} {where}"
                remedy = (
                    f"correct the address, or rename the register to {quoted(fixed)} if that is the one you mean. If"
                    f" this is what the manual says, add an erratum that affects registers.{name}.address"
                )
                report.add("biss-protocol", (*path, "address"), f"{problem}; {remedy}")
                break


def biss_byte_order(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers fixed by BiSS have their most significant byte first, unless an erratum explains it."""
    for path, register in items(spec, "registers"):
        name = register["name"]
        if name not in _PLACES or interface_of(register) != Biss.name or "bank" in register:
            continue
        if register.get("byte_order") != "low_byte_first":
            continue
        if not explained(report.document, "registers", name, "byte_order"):
            report.add(
                "biss-protocol",
                (*path, "byte_order"),
                f"{quoted(name)} has its low byte first, but in BiSS the most significant byte has the lowest address."
                f" If this is what the manual says, add an erratum that affects registers.{name}.byte_order",
            )


def biss_frame(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that nE and nW are active low, that nE is sent first, and that an inverted CRC ends the frame."""
    groups, crcs = by_name(raw, "field_groups"), by_name(raw, "crcs")
    for fields in layouts(spec):
        layout, sent_fields = fields.owner, list(expanded(fields, groups))
        frame_path = f"interfaces.{Biss.name}.{layout['name']}"
        if fields.interface == Biss.name and layout.get("from") == "encoder" and _FLAGS & _names(sent_fields):
            faults = [*_frame_faults(sent_fields, crcs, (*fields.path, "name"), frame_path)]
            faults += _late_positions(sent_fields, position_names(spec, Biss.name), frame_path)
            for path, affected, problem in faults:
                if not explained(report.document, affected):
                    end = f"If this is what the manual says, add an erratum that affects {affected}"
                    report.add("biss-protocol", path, f"{problem}. {end}")


def _frame_faults(
    sent_fields: list[tuple[Path, Spec]], crcs: Mapping[str, Spec], start: Path, frame_path: str
) -> Iterator[tuple[Path, str, str]]:
    """Yield the errors of a frame: the place, the path that an erratum must affect, and the message."""
    names = [field.get("name") for _, field in sent_fields]
    for path, field in sent_fields:
        name = field.get("name")
        if name in _FLAGS and field.get("active") == "high":
            problem = f"{quoted(name)} is active high, but in BiSS it is active low; write 'active: low'"
            yield (*path, "active"), f"{frame_path}.{name}", problem
        if "crc_of" in field:
            problem = (
                f"{quoted(name)} has 'crc_of', but in BiSS the CRC covers everything before it; leave 'crc_of' out"
            )
            yield (*path, "crc_of"), f"{frame_path}.{name}", problem
        crc = crcs.get(field["crc"], {}) if "crc" in field else {}
        for key, correction, reason in _crc_faults(crc):
            if key == "xorout" and crc[key] in _INVERTED:
                problem = _inverts_another_width(field["crc"], crc, correction)
                yield (*path, "crc"), f"crcs.{field['crc']}.{key}", problem
                continue
            value_text = f"{crc[key]:#x}" if crc[key] and key == "xorout" else str(crc[key]).lower()
            problem = f"the CRC {quoted(field['crc'])} has {quoted(key)} {value_text}, but BiSS sends the CRC {reason}"
            yield (*path, "crc"), f"crcs.{field['crc']}.{key}", f"{problem}; write '{key}: {correction}'"
    if {"error", "warning"} <= set(names) and names.index("error") > names.index("warning"):
        path, _ = sent_fields[names.index("warning")]
        yield path, f"{frame_path}.warning", "'warning' is before 'error', but BiSS sends nE before nW; swap the two"
    if not any("crc" in field for _, field in sent_fields):
        correction = "add a last field such as {name: crc, crc: NAME}"
        yield start, f"{frame_path}.fields", f"the frame has no CRC, but a BiSS frame ends with one; {correction}"


def _late_positions(
    sent_fields: list[tuple[Path, Spec]], positions: set[str], frame_path: str
) -> Iterator[tuple[Path, str, str]]:
    """Yield the first part of the position that is sent after nE or nW, like ``_frame_faults``."""
    flag = ""
    for path, field in sent_fields:
        name = str(field.get("name"))
        if name in _FLAGS:
            flag = flag or name
        elif flag and name in positions:
            problem = f"{quoted(name)} is after {quoted(flag)}, but BiSS sends the position before nE and nW"
            yield path, f"{frame_path}.{name}", f"{problem}; move it before {quoted(flag)}"
            return


def _inverts_another_width(name: str, crc: Spec, expected_xorout: str) -> str:
    """Return the message about a CRC whose width and inversion are those of two CRCs."""
    inverted, width = _INVERTED[crc["xorout"]], crc["width"]
    problem = f"the CRC {quoted(name)} has 'width' {width}, but its 'xorout' {crc['xorout']:#x} inverts {inverted} bits"
    return (
        f"{problem}; write 'width: {inverted}', or 'xorout: {expected_xorout}' if the manual has a CRC of {width} bits"
    )


def _crc_faults(crc: Spec) -> Iterator[tuple[str, str, str]]:
    """Yield the keys of a CRC that contradict BiSS, each with the value to write and the reason."""
    width, xorout = crc.get("width"), crc.get("xorout")
    if isinstance(width, int) and 0 < width <= 64 and isinstance(xorout, int) and xorout < (1 << width) - 1:
        yield "xorout", f"{(1 << width) - 1:#x}", "inverted"
    for key in ("refin", "refout"):
        if crc.get(key) is True:
            yield key, "false", "most significant bit first"


def _names(sent_fields: list[tuple[Path, Spec]]) -> set[str]:
    return {field["name"] for _, field in sent_fields if isinstance(field.get("name"), str)}


def biss_control(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the control frame has the widths, the directions and the CRC of BiSS.

    Every master relies on them, so a spec has these numbers. An erratum records others that the manual prints.
    """
    crcs = by_name(raw, "crcs")
    for field_path, field in items(spec, "interfaces", Biss.name, "control_data", "fields"):
        name = field.get("name")
        width = _WIDTHS.get(str(name))
        if width is not None and isinstance(field.get("bits"), int) and field["bits"] != width:
            report.add(
                "biss-protocol",
                (*field_path, "bits"),
                f"{quoted(name)} has {field['bits']} bits; in the BiSS control frame it has {width}",
            )
        if name == "rw":
            for word, value in mapping(field, "values").items():
                direction_bits = _DIRECTIONS.get(word, value["value"])
                if value["value"] != direction_bits:
                    problem = (
                        f"{quoted(word)} is {value['value']:02b}; in the BiSS control frame, 01 means write and 10"
                        " means read"
                    )
                    report.add("biss-protocol", (*field_path, "values", word, "value"), problem)
        crc = crcs.get(field.get("crc", ""))
        if crc is not None and any(crc.get(key) != value for key, value in _CONTROL_CRC.items()):
            problem = (
                f"{quoted(field['crc'])} is not the CRC of the BiSS control frame: 4 bits, poly 0x3, init 0, not"
                " reflected, xorout 0xF; write these numbers. If the manual prints others, add an erratum with both"
            )
            report.add("biss-protocol", (*field_path, "crc"), problem)
