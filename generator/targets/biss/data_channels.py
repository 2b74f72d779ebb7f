"""Data channels of a device in a BiSS file, and its comments and texts in ASCII.

Only the beginning of one idbiss file is public. Our file uses only the elements and attributes found there. Comments
mark every further interpretation as inferred. Facts with no publicly known place in the format are in the full
description, for which we have our own schema.

Only the beginning of one idbiss file is public. Our file uses only the elements and attributes found there. Comments
mark every further interpretation as inferred. Facts with no publicly known place in the format are in the full
description, for which we have our own schema.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import lru_cache

from markupsafe import Markup, escape

from ...dump.xml import clean
from ...model import Biss, Crc, Device, Field, Layout, assert_never
from ...model.record import dataclass
from ...order_codes.parameters import run_time_widths
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...say import order_code as say_order_code
from ...say.errata import errata, erratum
from ...say.layout import crc_parameters
from ...say.names_and_places import field_at
from ...say.order_code import initial
from ...say.plain_text import counted, in_ascii, plain
from ...say.text import BY_NAME
from .identity import DataLength, IdBits, profile_ids

_WIDTH = 132
#: Signs that comments spell in their own way.
_OWN = {"±": "+/-", "→": "to", "°": " deg", "\N{OHM SIGN}": "Ohm"}


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


def channels_by_length(
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


def master_settings(
    device: Device,
    layout: Layout,
    crc: Crc | None,
    lengths: Sequence[DataLength],
    ids: Sequence[IdBits],
    one_encoder: bool,
) -> str:
    """Return the other master settings as the lines of a comment. ``crc`` is None if order codes differ."""
    about = "Further settings of the master:" if one_encoder else _about_length(device, layout, lengths)
    lines = [about, *_lengths_by_profile(device, lengths)]
    for length in lengths:
        parts = " + ".join(f"{name} {width}" for name, width in length.parts.items())
        lines.append(
            f"  {', '.join(length.codes)}{_answers_text(length)}: {parts} = {length.data_bits} bits, "
            f"with status bits {length.with_status}, with CRC {length.total}"
            f"{_own_crc(device, length) if crc is None else ''}"
        )
    lines.append(f"  sent in this order, most significant bit first: {_order(layout)}")
    lines.append(f"  code: {_code(device, layout)}")
    if crc is not None:
        lines.append(f"  CRC: {_crc_words(device, crc)}. CrcPoly is the polynomial with its top bit")
    lines += _other_channels(device, layout)
    facts = say_order_code.settings(device, device.interface("biss"))
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


def _own_crc(device: Device, length: DataLength) -> str:
    """Return the CRC of a length, which others do not have."""
    return f", CRC of {_crc_words(device, length.crc)}" if length.crc is not None else ", without a CRC"


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
        crcs = device.crcs_of(channel_layout)
        if channel_layout is layout or channel_layout.channel is None or not crcs:
            continue
        fields = (field for field in channel_layout.fields if field not in channel_layout.crc_fields)
        parts = ", ".join(f"{field.name} {field.width.render()}" for field in fields)
        channel = f"  other data channel {channel_layout.channel}, {channel_layout.name}"
        crc_words = " or ".join(_crc_words(device, crc) for crc in crcs)
        lines.append(f"{channel}: {parts} bits, CRC of {crc_words}")
    return lines


def _order(layout: Layout) -> str:
    """Return the names of the fields in the order of transmission, with the level of each status bit."""
    names = []
    for field in layout.fields:
        if field in layout.status_fields:
            names.append(f"{field.name} ({_active_level(field)})")
        elif field not in layout.crc_fields:
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
        excess = f" with an excess of {layout.gray_excess.render()}" if layout.gray_excess is not None else ""
        return f"{layout.gray_of} in Gray code{excess}"
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
