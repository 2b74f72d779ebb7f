"""Rules on what BiSS itself lays down (PROT p. 9-15) and no spec can change: places of registers, the control frame."""

from __future__ import annotations

from ...model import Biss
from ..problems import DocumentReport, quoted
from .walk import Spec, bank_select, by_name, explained, interface_of, items, mapping

#: Registers that BiSS has at one place, by the name that manuals give them: address, length, and the place in words.
_PLACES = {
    "eds_bank": (0x41, 1, "at 41h"),
    "profile_id": (0x42, 2, "at 42h and 43h"),
    "serial_number": (0x44, 4, "at 44h to 47h"),
    "device_id": (0x78, 6, "at 78h to 7Dh"),
    "manufacturer_id": (0x7E, 2, "at 7Eh and 7Fh"),
}
_BANK_SELECT = (0x40, 1, "at 40h")

#: Widths of the parts of a control frame, and the two directions of an access.
_WIDTHS = {"register_address": 7, "address": 7, "rw": 2, "data": 8}
_DIRECTIONS = {"write": 0b01, "read": 0b10}
#: The CRC of a control frame: x^4 + x + 1, start 0, sent inverted.
_CONTROL_CRC = {"width": 4, "poly": 0x3, "init": 0, "refin": False, "refout": False, "xorout": 0xF}


def biss_places(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Registers with the names of those that BiSS places lie there."""
    select = bank_select(spec)
    for path, register in items(spec, "registers"):
        name = register["name"]
        placed = _BANK_SELECT if name == select else _PLACES.get(name)
        if placed is None or interface_of(register) != Biss.name or ("bank" in register and name != select):
            continue
        address, length, where = placed
        what, end = "it", "; correct it, or give another register another name"
        if name == select:
            what, end = "the register that selects banks", ""
        if register["address"] != address or "bank" in register:
            report.add(
                "biss-protocol",
                (*path, "address"),
                f"{quoted(name)} is at {register['address']:02X}h; BiSS has {what} {where}{end}",
            )
        elif register["length"] != length:
            report.add(
                "biss-protocol",
                (*path, "length"),
                f"{quoted(name)} has {register['length']} bytes; BiSS has {what} {where}, {length} long",
            )


def biss_byte_order(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What lies at a place of BiSS has its most significant byte first, but where an erratum says why not."""
    for path, register in items(spec, "registers"):
        name = register["name"]
        if name not in _PLACES or interface_of(register) != Biss.name or "bank" in register:
            continue
        if register.get("byte_order") == "low_byte_first" and not explained(raw, "registers", name, "byte_order"):
            report.add(
                "biss-protocol",
                (*path, "byte_order"),
                f"{quoted(name)} has its low byte first; in BiSS the most significant byte has the lowest address."
                f" Where the manual has it so, say it in an erratum that affects registers.{name}.byte_order",
            )


def biss_control(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """The control frame has the widths, the directions and the CRC of BiSS."""
    crcs = by_name(raw, "crcs")
    for here, field in items(spec, "interfaces", Biss.name, "control_data", "fields"):
        name = field.get("name")
        width = _WIDTHS.get(str(name))
        if width is not None and isinstance(field.get("bits"), int) and field["bits"] != width:
            report.add(
                "biss-protocol",
                (*here, "bits"),
                f"{quoted(name)} has {field['bits']} bits; in the control frame of BiSS it has {width}",
            )
        if name == "rw":
            for word, value in mapping(field, "values").items():
                right = _DIRECTIONS.get(word, value["value"])
                if value["value"] != right:
                    wrong = (
                        f"{quoted(word)} is {value['value']:02b}; in the control frame of BiSS 01 writes and 10 reads"
                    )
                    report.add("biss-protocol", (*here, "values", word, "value"), wrong)
        crc = crcs.get(field.get("crc", ""))
        if crc is not None and any(crc.get(key) != value for key, value in _CONTROL_CRC.items()):
            wrong = (
                f"{quoted(field['crc'])} is not the CRC of BiSS's control frame: 4 bits, poly 0x3, init 0, not"
                " reflected, xorout 0xF"
            )
            report.add("biss-protocol", (*here, "crc"), wrong)
