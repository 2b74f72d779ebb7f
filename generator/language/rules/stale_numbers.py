"""Rules for counts, bits and checks in texts that a revision of the spec leaves behind."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ...model import Crc
from ..document import ErratumTargets, Path
from ..problems import DocumentReport, quoted
from ..written_parts import WrittenErratum, WrittenSpec
from .parts import by_part_name, layouts_of_interfaces
from .stale_texts import is_derived

_XOR_OF_BYTES = re.compile(r"\bXOR of (?:all |the )(?:\w+ )?bytes\b")
#: Width and polynomial of the CRC that is the XOR of all bytes: x^8 + 1.
_WIDTH_OF_XOR, _POLY_OF_XOR = 8, 1
_IS_BIT = re.compile(r"(?P<name>[A-Z][^.,;:]*) is bit (?P<bit>\d+)\.")
_NUMBER_WORDS = "two three four five six seven eight".split()
_THESE_BYTES = re.compile(rf"\bthese (?P<count>{'|'.join(_NUMBER_WORDS)}) bytes\b")
_BITS_IN_TEXT = re.compile(r"(?<!\w)[01]{8,}(?!\w)")


def check_xor_of_bytes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a CRC that a text calls the XOR of the bytes is computed so: with the polynomial x^8 + 1."""
    crcs = by_part_name(spec.crcs)
    for path, text, crc in _texts_about_crcs(spec):
        is_xor = (crc.width, crc.poly) == (_WIDTH_OF_XOR, _POLY_OF_XOR)
        match = _XOR_OF_BYTES.search(text)
        if match is not None and not is_xor and crc.name in crcs:
            message = f"the text says {quoted(match[0])}, but {quoted(crc.name)} has {crc.width} bits and 'poly'"
            report.add("left-behind", path, f"{message} {crc.poly:#x}; correct one of the two", cause=crc.name)


def _texts_about_crcs(spec: WrittenSpec) -> Iterator[tuple[Path, str, Crc]]:
    """Yield the note of each CRC, and the texts of errata that affect only one CRC, with their paths."""
    crcs = by_part_name(spec.crcs)
    for located_crc in spec.crcs:
        yield (*located_crc.path, "note"), located_crc.part.note, located_crc.part
    for erratum in spec.errata:
        affected_names = {path.split(".")[1] for path in erratum.affects if path.startswith("crcs.")}
        affected_crcs = [crcs[name].part for name in affected_names if name in crcs]
        if len(affected_crcs) == 1:
            for key in ("used", "why"):
                yield erratum.place_of(key), str(erratum.data.get(key, "")), affected_crcs[0]


def check_bits_of_fields(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the bit in ``used`` of an erratum, such as "Counting direction is bit 6.", is that of the field."""
    if is_derived(report.document):
        return
    targets = ErratumTargets(spec.data)
    for erratum in spec.errata:
        match = _IS_BIT.fullmatch(erratum.used)
        if match is None:
            continue
        for field in _affected_fields(erratum, targets):
            names = (str(field.get("printed_name", "")), str(field.get("name", "")).replace("_", " "))
            is_named = match.group("name").casefold() in map(str.casefold, names)
            if is_named and field["at"] != int(match.group("bit")):
                message = f"the text says bit {match['bit']}, but 'at' of the field is {field['at']}"
                report.add("left-behind", erratum.place_of("used"), f"{message}; correct one of the two")


def _affected_fields(erratum: WrittenErratum, targets: ErratumTargets) -> Iterator[dict[str, object]]:
    """Yield the fields of one bit that an erratum affects."""
    for affected_path in erratum.affects:
        for part in targets.at(affected_path):
            if isinstance(part, dict) and isinstance(part.get("at"), int):
                yield part


def check_bytes_in_notes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a field of a layout has the bytes that its note counts, as in "Some models omit these three bytes"."""
    for field_list in layouts_of_interfaces(spec):
        layout = field_list.owner
        note = str(layout.data.get("note", ""))
        widths = {width for field in field_list.fields for width in (field.bits, field.padded_to)}
        for match in _THESE_BYTES.finditer(note):
            bits = 8 * (2 + _NUMBER_WORDS.index(match.group("count")))
            if bits not in widths:
                message = f"the text says {quoted(match[0])}, but no field of the layout has {bits} bits"
                report.add("left-behind", layout.place_of("note"), f"{message}; correct one of the two")


def check_bits_in_notes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the note of an example has the bits of its bytes, as in "The value is 01100000 in binary"."""
    for example in spec.examples:
        bits = "".join(f"{int(byte, 16):08b}" for byte in example.bytes.split())
        for bits_in_text in _BITS_IN_TEXT.findall(example.note):
            if len(bits_in_text) == len(bits) and bits_in_text != bits:
                message = f"the text has {bits_in_text}, but the bytes of the example are {bits} in binary"
                report.add("left-behind", example.place_of("note"), f"{message}; correct one of the two")
