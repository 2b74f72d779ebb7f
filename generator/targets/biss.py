"""The BiSS files: ``idbissXXXX.xml`` of each manufacturer, and a full description of each device.

Of the idbiss format only the opening passage of one file is public. Our file has nothing that is not seen there; every reading beyond it is
named as inferred in a comment. All that the format has no publicly known place for is in the full description, which has a schema of our own.
"""

from __future__ import annotations

import textwrap
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup, escape

from ..biss_identity import DataLength, IdBits, data_lengths, device_bits, manufacturer_bits, single_cycle_data
from ..description import XSD_NAME, clean, to_xml
from ..model import Crc, Device, Interface, Layout, Manufacturer
from ..output import device_dump
from ..render import plain, render
from ..xsd import schema_text
from . import Library

_WIDTH = 132
_ASCII = str.maketrans({"\u2013": "-", "\u2014": "-", "\u2212": "-", "\u2026": "...", "\u00b1": "+/-", "\u00b5": "u", "\u03bc": "u", "\u00d7": "x",
                        "\u2192": "to", "\u201c": '"', "\u201d": '"', "\u2018": "'", "\u2019": "'", "\u00b0": " deg", "\u03a9": "Ohm", "\u2126": "Ohm"})


@dataclass(frozen=True)
class Node:
    """A ``Device`` element: the identity that it stands for, its name, and what is known of its data."""

    ids: tuple[IdBits, ...]
    label: str = ""
    label_position: int = 0
    notes: tuple[str, ...] = ()
    notes_of_data: tuple[str, ...] = ()
    crc_polynomial: str = ""
    length: int = 0
    devices: tuple[Node, ...] = ()


def generate(library: Library) -> dict[str, str]:
    """``biss/idbissXXXX.xml`` for each manufacturer with a BiSS ID, ``biss/<maker>-<device>.xml`` for each device, and the schema of the latter."""
    files = {}
    for maker, devices in library.by_manufacturer():
        if maker.biss_id is not None:
            files[f"biss/idbiss{maker.biss_id:04X}.xml"] = _identifier(maker, maker.biss_id, devices, library)
        files |= {f"biss/{maker.name}-{device.name}.xml": to_xml(device_dump(device)) for device in devices}
    if files:
        files[f"biss/{XSD_NAME}"] = schema_text()
    return files


def ascii_only(text: object) -> str:
    """``text`` in ASCII, for comments, where XML knows no character references."""
    decomposed = unicodedata.normalize("NFKD", plain(text).translate(_ASCII))
    return "".join(character for character in decomposed if not unicodedata.combining(character)).encode("ascii", "replace").decode()


def comment_text(text: object) -> Markup:
    """``text`` for inside a comment, which two hyphens would end."""
    made = ascii_only(text)
    while "--" in made:
        made = made.replace("--", "- -")
    return Markup(made + " " if made.endswith("-") else made)


def comment(text: object, indent: str) -> Markup:
    """A whole comment; on several lines where one is too short. A text with line ends keeps them."""
    lines = [(line.startswith("  "), str(comment_text(line))) for line in str(text).split("\n")]
    if len(lines) == 1 and len(indent) + len(lines[0][1]) + 9 <= _WIDTH:
        return Markup(f"{indent}<!-- {lines[0][1]} -->")
    leads = {False: ("", ""), True: ("  ", "    ")}
    wrapped = [
        piece
        for is_item, line in lines
        for piece in textwrap.wrap(line, _WIDTH - len(indent) - 5, initial_indent=leads[is_item][0], subsequent_indent=leads[is_item][1])
    ]
    return Markup("\n".join([f"{indent}<!--", *(f"{indent}     {line}" for line in wrapped), f"{indent}-->"]))


def ascii_text(text: object) -> Markup:
    """``text`` for an element, in ASCII with character references."""
    return Markup(str(escape(clean(plain(text)))).encode("ascii", "xmlcharrefreplace").decode())


def _identifier(maker: Manufacturer, biss_id: int, devices: Sequence[Device], library: Library) -> str:
    listed = [(device, device_bits(device)) for device in devices if any(item.kind == "biss" for item in device.interfaces)]
    nodes = [node for device, ids in listed if ids for node in [_device(device, ids)] if node is not None]
    left_out = [device.title for device, ids in listed if not ids]
    root = Node((manufacturer_bits(biss_id),), label=maker.title, notes=(_MANUFACTURER_NOTE,), devices=tuple(nodes))
    values: Mapping[str, object] = {
        "notes": [_about(maker), *(f"Trademarks: {text}" for text in maker.trademarks)],
        "root": root,
        "left_out": f"Not listed, for want of a device ID in the spec: {', '.join(left_out)}" if left_out else "",
    }
    filters: Mapping[str, Callable[..., Any]] = {"comment": comment, "comment_text": comment_text, "ascii_text": ascii_text}
    return render("biss", "idbiss.xml.jinja", values, filters, library.own_templates)


_MANUFACTURER_NOTE = (
    "Inferred: Range counts the bits of the 64-bit identity that device ID (78h to 7Dh) and manufacturer ID (7Eh, 7Fh) form, high byte first: "
    "bit 63 is the highest of 78h, bit 0 the lowest of 7Fh. Publicly it is seen with the 16-bit profile ID only.\n"
    "Inferred: a Device inside a Device refines it, so that all Id on the way down have to hold."
)


def _about(maker: Manufacturer) -> str:
    return (
        f"{maker.title}: encoders with a BiSS C interface.\n"
        "Structure inferred from the public opening of profilebiss.xml; not validated against idbiss.dtd, which is not public, and not tried with any "
        "master. Only elements and attributes that are seen there are used; each reading beyond it is marked as inferred.\n"
        "What the format has no publicly known place for is in the full description of each device, beside this file."
    )


def _device(device: Device, ids: tuple[IdBits, ...]) -> Node | None:
    found = single_cycle_data(device)
    if found is None:
        return None
    layout, crc = found
    lengths = data_lengths(device, layout)
    sizes = {item.data_bits for item in lengths}
    inner: tuple[Node, ...] = ()
    if len(sizes) == 1:
        note = "Inferred: Length counts the data without error, warning and CRC bits, as the profile IDs of sensors do."
        inner = (Node(ids, notes=("The same identity again: CrcPoly and Length are not seen in one SCDS.",), notes_of_data=(note,), length=lengths[0].data_bits),)
    manual = device.manual
    notes = (f"{device.title}; manual {manual.title}, revision {manual.revision}.",)
    polynomial = f"0x{crc.poly_with_top_bit:02X}"
    return Node(ids, f", {device.title}", 1, notes, (_to_tell(device, layout, crc, lengths, ids),), polynomial, devices=inner)


def _to_tell(device: Device, layout: Layout, crc: Crc, lengths: Sequence[DataLength], ids: Sequence[IdBits]) -> str:
    """What the master has to be told besides, as the lines of a comment."""
    sizes = {item.data_bits for item in lengths}
    lines = []
    if len(sizes) > 1:
        lines.append(f"No Length: one device ID stands for {len(sizes)} data lengths. The master must be told the one of the order code:")
    else:
        lines.append("Besides what stands here the master must be told, by order code:")
    for item in lengths:
        parts = " + ".join(f"{name} {width}" for name, width in item.parts.items())
        lines.append(f"  {', '.join(item.codes)}: {parts} = {item.data_bits} bits; with status bits {item.with_status}; with CRC {item.total}")
    flags = [f"{field.name} ({'low' if field.active_low else 'high'} active)" for field in layout.fields if field.kind == "flag"]
    order = ", ".join(field.name for field in layout.fields if field.kind not in ("flag", "crc"))
    lines.append(f"  sent in this order, most significant bit first: {order}; status bits {', '.join(flags) or 'none'}; CRC")
    sent = "sent inverted" if crc.xorout == crc.mask else f"XORed with 0x{crc.xorout:X}" if crc.xorout else "sent as it is"
    lines.append(f"  CRC: {crc.width} bits, {crc.polynomial}, start value {crc.init}, {sent}; CrcPoly is the polynomial with its top bit")
    lines += _clock(device.interface("biss"))
    paths = [f"interfaces.biss.{layout.name}", *dict.fromkeys(f"registers.{item.register}" for item in ids)]
    errata = dict.fromkeys(item for path in paths for item in device.errata_for(path))
    lines += [f"  erratum of the manual, {item.name} ({item.status}). Printed: {_sentence(item.printed)} Used: {_sentence(item.used)}" for item in errata]
    lines.append(f"  registers, procedures and all else: {device.manufacturer.name}-{device.name}.xml")
    return "\n".join(lines)


def _sentence(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else text + "."


def _clock(interface: Interface) -> list[str]:
    lines = []
    if interface.clock_min_hz is not None and interface.clock_max_hz is not None:
        lines.append(f"  clock: {interface.clock_min_hz} Hz to {interface.clock_max_hz} Hz")
    timeout = interface.timeout
    if timeout is not None:
        rule = f"{timeout.half_clock_periods / 2:g} clock periods" if timeout.half_clock_periods is not None else timeout.rule.replace("_", " ")
        bounds = [f"{word} {value} ns" for word, value in (("typically", timeout.typical_ns), ("at most", timeout.at_most_ns)) if value is not None]
        lines.append(f"  time-out: {', '.join([rule, *bounds])}")
    if interface.network is not None and not interface.network.multiple_slaves:
        lines.append("  network: one master and one slave only")
    return lines
