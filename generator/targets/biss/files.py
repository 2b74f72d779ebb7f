"""BiSS files: an ``idbissXXXX.xml`` for each manufacturer, and a full description of each device.

Only the beginning of one idbiss file is public. Our file uses only the elements and attributes found there. Comments
mark every further interpretation as inferred. Facts with no publicly known place in the format are in the full
description, for which we have our own schema.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Annotated, TypedDict

from markupsafe import Markup, escape

from ...dump.plain import device_dump, variant_dump
from ...dump.xml import XSD_NAME, clean, schema_text, to_xml
from ...model import (
    Alternative,
    Answer,
    Biss,
    Crc,
    Device,
    Field,
    Layout,
    Manufacturer,
    Variant,
    assert_never,
    choices,
)
from ...model.record import dataclass
from ...order_codes.labels import Match
from ...order_codes.parameters import run_time_widths
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...render import Templates, our_templates
from ...say import interface as say_interface
from ...say.errata import errata, erratum
from ...say.layout import crc_parameters
from ...say.names_and_places import field_at
from ...say.order_code import initial
from ...say.plain_text import in_ascii, plain
from ...say.text import BY_NAME, counted
from .. import NO_OPTIONS, Library, Option, Options, Target
from ..shared_files import licence_in, names_of_codes
from .identity import (
    DataLength,
    IdBits,
    data_lengths,
    device_bits,
    manufacturer_bits,
    profile_ids,
    single_cycle_data,
)

_WIDTH = 132
#: Signs that comments spell in their own way.
_OWN = {"±": "+/-", "→": "to", "°": " deg", "\N{OHM SIGN}": "Ohm"}


_EACH = "each"
_BY_CODE = Option(
    "order-codes",
    "each: also write a file for each order code, with numbers instead of expressions",
    "none",
    ("none", _EACH),
)


@dataclass(frozen=True)
class Node:
    """``Device`` element: its identity, its name, and the known facts about the data of the device."""

    ids: tuple[IdBits, ...]
    label: str = ""
    label_position: int = 0
    notes: tuple[str, ...] = ()
    notes_of_data: tuple[str, ...] = ()
    crc_polynomial: str = ""
    length: int = 0
    data_label: str = ""
    devices: tuple[Node, ...] = ()


class Readme(TypedDict):
    identifiers: Annotated[list[str], "names of the idbiss files in code"]


class Identifier(TypedDict):
    notes: Annotated[list[str], "text of the first comment"]
    root: Annotated[Node, "element of the manufacturer, which contains those of its encoders"]
    left_out: Annotated[str, "a sentence about encoders that are not listed, or an empty string"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return ``biss/idbissXXXX.xml`` for manufacturers with a BiSS ID, ``biss/<maker>-<device>.xml``, and the schema.

    There is no idbiss file without an encoder that a master can identify.

    Also return ``biss/<maker>-<device>/idbiss-<order code>.xml`` for each order code that a master can identify.

    With the option ``order-codes``, also return ``biss/<maker>-<device>/<order code>.xml``, with numbers instead of
    expressions.
    """
    files: dict[str, str] = {}
    identifiers = []
    for maker, devices in library.by_manufacturer():
        nodes, left_out = _identified_nodes(devices)
        if maker.biss_id is not None and nodes:
            name = identifier_name(maker.biss_id)
            identifiers.append(f"`{name}`")
            about = [f"{maker.title}: encoders with a BiSS C interface."]
            files[f"biss/{name}"] = _identifier(maker, maker.biss_id, about, nodes, library, left_out)
        for device in devices:
            files |= library.part(_family, device, options)
    if files:
        readme: Readme = {"identifiers": identifiers}
        files["biss/README.md"] = TEMPLATES.render("README.md.jinja", readme, library.own_templates)
        files |= {f"biss/{XSD_NAME}": schema_text()} | licence_in("biss")
    return files


def identifier_name(biss_id: int) -> str:
    """Return the name of the file that describes the encoders of a manufacturer."""
    return f"idbiss{biss_id:04X}.xml"


def _family(device: Device, library: Library, options: Options) -> dict[str, str]:
    """Return the files of a family by path."""
    maker = device.manufacturer
    files = {f"biss/{maker.name}-{device.name}.xml": to_xml(device_dump(device))}
    if maker.biss_id is not None:
        files |= dict(_of_encoders(maker.biss_id, device, library))
    if options.get(_BY_CODE.name, _BY_CODE.default) == _EACH:
        files |= dict(_by_code(f"biss/{maker.name}-{device.name}", device))
    return files


def _by_code(folder: str, device: Device) -> Iterator[tuple[str, str]]:
    """Yield a description of each listed order code, with numbers instead of expressions."""
    names = names_of_codes(variant.code for variant in device.variants)
    for name, variant in zip(names, device.variants, strict=True):
        yield f"{folder}/{name}.xml", to_xml(variant_dump(device, Match(variant, (), "", special=False)))


def ascii_only(text: object) -> str:
    """Return ``text`` in ASCII for comments, where XML allows no character references."""
    return in_ascii(plain(text), _OWN)


def comment_text(text: object) -> Markup:
    """Return ``text`` for a comment, without double hyphens, which would end it."""
    comment_line = ascii_only(text)
    while "--" in comment_line:
        comment_line = comment_line.replace("--", "- -")
    return Markup(comment_line + " " if comment_line.endswith("-") else comment_line)


def comment(text: object, indent: str) -> Markup:
    """Return a complete comment, wrapped if necessary. Line breaks in the text are preserved."""
    lines = str(text).split("\n")
    if len(lines) == 1 and len(indent) + len(whole := comment_text(lines[0])) + 9 <= _WIDTH:
        return Markup(f"{indent}<!-- {whole} -->")
    wrapped = [piece for line in lines for piece in _wrapped(line, _WIDTH - len(indent) - 5)]
    return Markup("\n".join([f"{indent}<!--", *(f"{indent}     {line}" for line in wrapped), f"{indent}-->"]))


# The files for the order codes of a family have most lines in common.
@lru_cache(maxsize=1024)
def _wrapped(line: str, width: int) -> Sequence[str]:
    """Return the lines of a comment for one line of its text. An indented one is an item of a list."""
    first, indent = ("  ", "    ") if line.startswith("  ") else ("", "")
    return textwrap.wrap(str(comment_text(line)), width, initial_indent=first, subsequent_indent=indent)


def ascii_text(text: object) -> Markup:
    """Return ``text`` for an element, in ASCII and with character references."""
    return Markup(str(escape(clean(plain(text)))).encode("ascii", "xmlcharrefreplace").decode())


def _identified_nodes(devices: Sequence[Device]) -> tuple[list[Node], str]:
    """Return the elements of the encoders that a master can identify, and a sentence about the others."""
    # A master cannot distinguish a special model or another edition from its family.
    families = [device for device in devices if device.find_interface(Biss) is not None and not device.base]
    listed = [(device, device_bits(device)) for device in families]
    nodes = [node for device, ids in listed if ids for node in [_device(device, ids)] if node is not None]
    missing = [device.title for device, ids in listed if not ids]
    left_out = f"Not listed, because the spec has no device ID: {', '.join(missing)}" if missing else ""
    return nodes, left_out


def _of_encoders(biss_id: int, device: Device, library: Library) -> Iterator[tuple[str, str]]:
    """Yield a file for each order code, or for each answer where the manual leaves the length open."""
    ids, cycle_data, maker = device_bits(device), single_cycle_data(device), device.manufacturer
    if not ids or cycle_data is None:
        return
    layout, _ = cycle_data
    open_questions = device.alternatives_of(layout)
    variants = device.variants_over(Biss.name)
    encoders = [(variant, answers) for variant in variants for answers, _ in choices(open_questions)]
    names = names_of_codes(_encoder_name(variant, answers) for variant, answers in encoders)
    for name, (variant, answers) in zip(names, encoders, strict=True):
        decided = dict(zip((question.name for question in open_questions), answers, strict=True))
        node = _device(_one_encoder(device, variant, decided), ids, one_encoder=True)
        about = [f"{maker.title}: {variant.code}.", _ONE_ENCODER_NOTE]
        about += [_about_answer(question, decided[question.name]) for question in open_questions]
        text = _identifier(maker, biss_id, about, [node] if node is not None else [], library)
        yield f"biss/{maker.name}-{device.name}/idbiss-{name}.xml", text


def _encoder_name(variant: Variant, answers: Iterable[Answer]) -> str:
    """Return the order code and the names of the answers."""
    return "-".join((variant.code, *(answer.name for answer in answers)))


def _one_encoder(device: Device, variant: Variant, decided: Mapping[str, Answer]) -> Device:
    """Return the device with one order code, and with one answer to each of the decided questions."""
    alternatives = list(device.alternatives)
    for place, alternative in enumerate(alternatives):
        if alternative.name in decided:
            alternatives[place] = replace(alternative, answers=(decided[alternative.name],))
    return replace(device, variants=(variant,), alternatives=tuple(alternatives))


def _about_answer(question: Alternative, answer: Answer) -> str:
    return (
        f"The manual leaves {question.name} open ({question.meaning}). This file is for {answer.name}: "
        f"{answer.meaning}. There is a file for each answer."
    )


def _identifier(
    maker: Manufacturer, biss_id: int, about: Sequence[str], nodes: Sequence[Node], library: Library, left_out: str = ""
) -> str:
    """Return the file that describes these encoders from one manufacturer. ``about`` begins its first comment."""
    root = Node((manufacturer_bits(biss_id),), label=maker.title, notes=(_MANUFACTURER_NOTE,), devices=tuple(nodes))
    values: Identifier = {
        "notes": [
            _warning(biss_id),
            "\n".join([*about, _ABOUT]),
            *(f"Trademarks: {text}" for text in maker.trademarks),
        ],
        "root": root,
        "left_out": left_out,
    }
    return TEMPLATES.render("idbiss.xml.jinja", values, library.own_templates)


def _warning(biss_id: int) -> str:
    """Return the first comment of a file, which a person reads before installing it."""
    return (
        f"No BiSS master is known to accept this file. A manufacturer may supply its own {identifier_name(biss_id)}. "
        "If you have it, install it in the master, and never replace it with this file."
    )


_MANUFACTURER_NOTE = (
    "Inferred: Range counts the bits of the 64-bit identity that device ID (78h to 7Dh) and manufacturer ID (7Eh, 7Fh) "
    "form, high byte first: "
    "bit 63 is the highest of 78h, bit 0 the lowest of 7Fh. The public example has Range only for the 16-bit profile "
    "ID.\n"
    "Inferred: a Device inside a Device refines it, so that all Id on the way down must match, and the SCDS on the way "
    "describe one data channel.\n"
    "Inferred: Label of a Device names the manufacturer, and inside it the device after a comma. The public example "
    "has Label only for profiles."
)


_ABOUT = (
    "Structure inferred from the public opening of profilebiss.xml. Not validated against idbiss.dtd, which is not "
    "public, and not yet tested with a master. Only elements and attributes from that opening are used. Each "
    "further interpretation is marked as inferred.\n"
    "Everything without a publicly known place in the format is in the full description of each device, biss/*.xml."
)
_ONE_ENCODER_NOTE = (
    "For one order code. Masters identify the encoder by the IDs below, which it can share with other order codes of "
    "its family. A master cannot distinguish them, so give it a single file of a family."
)


def _device(device: Device, ids: tuple[IdBits, ...], one_encoder: bool = False) -> Node | None:
    cycle_data = single_cycle_data(device)
    if cycle_data is None:
        return None
    layout, crc = cycle_data
    lengths = data_lengths(device, layout)
    manual = device.manual
    notes = (f"{device.title}; manual {manual.title}, revision {manual.revision}.",)
    polynomial = f"0x{crc.poly_with_top_bit:02X}"
    changing = not one_encoder and bool(run_time_widths(device, layout))
    inner = () if changing else _by_length(device, layout, ids, lengths)
    return Node(
        ids,
        f", {device.title}",
        1,
        notes,
        (_master_settings(device, layout, crc, lengths, ids, one_encoder),),
        polynomial,
        devices=inner,
    )


def _by_length(
    device: Device, layout: Layout, ids: tuple[IdBits, ...], lengths: Sequence[DataLength]
) -> tuple[Node, ...]:
    """Return the element with the data length if the device ID implies a single length."""
    if len({length.data_bits for length in lengths}) != 1:
        return ()
    notes = ("The same identity again, because the public example does not have CrcPoly and Length in one SCDS.",)
    return (
        Node(
            ids,
            notes=notes,
            notes_of_data=(_LENGTH_NOTE + _at_factory_defaults(device, layout),),
            length=lengths[0].data_bits,
            data_label=_data_label(device, layout),
        ),
    )


def _at_factory_defaults(device: Device, layout: Layout) -> str:
    register_fields = [field_at(device, path) for path in run_time_widths(device, layout)]
    return (
        f"\nInferred: Length is that of the {initial(device)} of {' and '.join(register_fields)}. It changes with them."
        if register_fields
        else ""
    )


def _length_by_profile(device: Device, lengths: Sequence[DataLength]) -> dict[int, int]:
    """Return the data length for each profile ID, if the profile ID distinguishes the models."""
    length_by_profile: dict[int, int] = {}
    for number, codes in profile_ids(device).items():
        bit_counts = {length.data_bits for length in lengths if not set(codes).isdisjoint(length.codes)}
        if len(bit_counts) != 1:
            return {}
        (length_by_profile[number],) = bit_counts
    return length_by_profile if len(length_by_profile) > 1 else {}


def _data_label(device: Device, layout: Layout) -> str:
    """Return a description of the data channel, without the comma with which the labels of devices start."""
    measurement = device.measurement_of(Biss.name)
    return f"{measurement.of if measurement is not None else plain(layout.name.replace('_', ' '))}"


_LENGTH_NOTE = (
    "Inferred: Length counts all data bits on the line, including zeros next to the position, but not error, warning "
    "and CRC bits. Profile IDs that encode the data length omit those too.\n"
    "Inferred: the Label next to it, which the public example has in this place, names the content of the data channel."
)
_PROFILE_NOTE = (
    "Not listed as inner Devices: an Id for the profile ID would have Range 15:0 as in profilebiss.xml, but the "
    "manufacturer ID further up uses the same Range. Both cannot match."
)


def _master_settings(
    device: Device,
    layout: Layout,
    crc: Crc,
    lengths: Sequence[DataLength],
    ids: Sequence[IdBits],
    one_encoder: bool,
) -> str:
    """Return the other master settings as the lines of a comment."""
    about = "Further settings of the master:" if one_encoder else _about_length(device, layout, lengths)
    lines = [about, *_lengths_by_profile(device, lengths)]
    for length in lengths:
        parts = " + ".join(f"{name} {width}" for name, width in length.parts.items())
        lines.append(
            f"  {', '.join(length.codes)}{_answers_text(length)}: {parts} = {length.data_bits} bits, "
            f"with status bits {length.with_status}, with CRC {length.total}"
        )
    lines.append(f"  sent in this order, most significant bit first: {_order(layout)}")
    lines.append(f"  code: {_code(device, layout)}")
    lines.append(f"  CRC: {_crc_words(device, crc)}. CrcPoly is the polynomial with its top bit")
    lines += _other_channels(device, layout)
    facts = say_interface.settings(device, device.interface("biss"))
    lines += [f"  {BY_NAME.sentence(setting)}" for setting in facts]
    lines += _one_profile(device, lengths)
    paths = [f"interfaces.biss.{layout.name}", *dict.fromkeys(f"registers.{id_bits.register}" for id_bits in ids)]
    for listed_erratum in errata(device, *paths):
        head, *below = BY_NAME.lines(erratum(listed_erratum))
        lines += [f"  {head}", *(f"    {line}" for line in below)]
    lines.append(f"  registers, procedures and everything else: {device.manufacturer.name}-{device.name}.xml")
    return "\n".join(lines)


def _answers_text(length: DataLength) -> str:
    """Return the answers on which a length depends."""
    return f" with {' and '.join(length.answers)}" if length.answers else ""


def _active_level(status: Field) -> str:
    match meaning_of(status):
        case Active(low):
            return "active low" if low else "active high"
        case Raw() | TwosComplement() | ZeroMeans() | Named() | DigitRuns() | Characters():
            return "not used, always 1"
        case meaning:
            assert_never(meaning)


def _lengths_by_profile(device: Device, lengths: Sequence[DataLength]) -> list[str]:
    length_by_profile, profiles = _length_by_profile(device, lengths), profile_ids(device)
    lines = []
    for number, length in length_by_profile.items():
        codes = ", ".join(profiles[number])
        lines.append(f"  profile ID {number:04X}h, registers 42h and 43h ({codes}): {length} bits")
    return [*lines, f"  {_PROFILE_NOTE}"] if lines else []


def _one_profile(device: Device, lengths: Sequence[DataLength]) -> list[str]:
    """Return lines about the profile ID shared by all models, and about models whose data length is its low byte."""
    profiles = profile_ids(device)
    if len(profiles) != 1:
        return []
    number = min(profiles)
    if number == 0:
        return ["  profile ID, registers 42h and 43h: 0000h, which means no profile"]
    line = f"  profile ID, registers 42h and 43h: {number:04X}h"
    if len({length.data_bits for length in lengths}) > 1:
        equal_lengths = (length for length in lengths if length.data_bits == number & 0xFF)
        codes = [f"{', '.join(length.codes)}{_answers_text(length)}" for length in equal_lengths]
        only = f". Its low byte, {number & 0xFF}, is the data length of {', '.join(codes)} only" if codes else ""
        line += f", for all lengths{only}"
    return [line]


def _crc_words(device: Device, crc: Crc) -> str:
    return f"{counted(crc.width, 'bit')}, {crc_parameters(device, crc)}"


def _other_channels(device: Device, layout: Layout) -> list[str]:
    """Return lines about the data channels that do not carry the position. The format has no known place for them."""
    lines = []
    for channel_layout in device.interface(Biss.name).layouts:
        crc = device.crc_of(channel_layout)
        if channel_layout is layout or channel_layout.channel is None or crc is None:
            continue
        fields = (field for field in channel_layout.fields if field is not channel_layout.crc_field)
        parts = ", ".join(f"{field.name} {field.width.render()}" for field in fields)
        channel = f"  other data channel {channel_layout.channel}, {channel_layout.name}"
        lines.append(f"{channel}: {parts} bits, CRC of {_crc_words(device, crc)}")
    return lines


def _order(layout: Layout) -> str:
    """Return the names of the fields in the order of transmission, with the level of each status bit."""
    names = []
    for field in layout.fields:
        if field in layout.status_fields:
            names.append(f"{field.name} ({_active_level(field)})")
        elif field is not layout.crc_field:
            names.append(field.name)
    status = "" if layout.status_fields else ", no status bits"
    return f"{', '.join(names)}, CRC{status}"


def _about_length(device: Device, layout: Layout, lengths: Sequence[DataLength]) -> str:
    sizes = {length.data_bits for length in lengths}
    register_fields = [field_at(device, path) for path in run_time_widths(device, layout)]
    if register_fields:
        now = f"it depends on the current content of {' and '.join(register_fields)}"
        return f"No Length: {now}. Set it in the master. {initial(device).capitalize()}:"
    if len(sizes) == 1:
        return "Further settings of the master, by order code:"
    distinction = ". The profile ID distinguishes them" if _length_by_profile(device, lengths) else ""
    for alternative in device.alternatives_of(layout):
        distinction += f". You choose {alternative.name} ({alternative.meaning})"
    several = f"one device ID covers {len(sizes)} data lengths{distinction}"
    return f"No Length: {several}. Set the length of the order code in the master:"


def _code(device: Device, layout: Layout) -> str:
    if not layout.gray_of:
        return "binary"
    if not layout.gray_when:
        return f"{layout.gray_of} in Gray code"
    needed = device.needed_parameters([layout.gray_when])
    deciding = (parameter for parameter in device.run_time_parameters if parameter.name in needed)
    register_fields = [field_at(device, parameter.read_from) for parameter in deciding]
    delivered = {bool(variant.parameters[layout.gray_when]) for variant in device.variants_over(Biss.name)}
    word = {frozenset({True}): "Gray", frozenset({False}): "binary"}.get(frozenset(delivered), "by order code")
    return (
        f"{layout.gray_of} in Gray code or binary, selected by {', '.join(register_fields)}, factory default {word}"
        if register_fields
        else f"{layout.gray_of} {word}"
    )


TEMPLATES = Templates(
    our_templates("biss"),
    values={"README.md.jinja": Readme, "idbiss.xml.jinja": Identifier},
    filters={"comment": comment, "comment_text": comment_text, "ascii_text": ascii_text},
    autoescape=True,
)
TARGET = Target(
    name="biss",
    summary="idbissXXXX.xml for BiSS masters, and a full description of each family in XML",
    files=generate,
    options=(_BY_CODE,),
    templates=TEMPLATES,
    family=_family,
)
