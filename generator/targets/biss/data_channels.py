"""The data channels of a device in a BiSS file, and the comments and texts of the file in ASCII.

Only the beginning of one idbiss file is public. Our file uses only the elements and attributes found there. Comments
mark every further interpretation as inferred. Facts with no publicly known place in the format are in the full
description, for which we have our own schema.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import lru_cache

from markupsafe import Markup, escape

from ...dump.xml import without_invalid_characters
from ...model import Biss, Crc, Device, Field, Layout, Variant
from ...model.record import dataclass
from ...order_codes.parameters import run_time_widths
from ...plan.values import ActiveFlag, meaning_of
from ...say import count_with_unit, in_ascii, text_on_one_line
from ...say import order_code as say_order_code
from ...say.errata import describe_erratum, errata_affecting
from ...say.layout import crc_parameters
from ...say.names_and_evidence import field_at
from ...say.order_code import words_for_initial_values
from ...say.text import PLAIN_STYLE
from .identity import DataLength, IdBits, profile_ids

_MAX_LINE = 132
#: Spelling of signs in comments.
_SPELLED_SIGNS = {"±": "+/-", "→": "to", "°": " deg", "\N{OHM SIGN}": "Ohm"}


def ascii_only(text: object) -> str:
    """Return ``text`` in ASCII for comments, where XML allows no character references."""
    return in_ascii(text_on_one_line(text), _SPELLED_SIGNS)


def comment_text(text: object) -> Markup:
    """Return ``text`` for a comment. XML allows neither double hyphens in it nor a hyphen at its end.

    A space separates double hyphens, and follows a hyphen at the end.
    """
    comment_line = ascii_only(text)
    # One pass leaves two adjacent hyphens if there were three.
    while "--" in comment_line:
        comment_line = comment_line.replace("--", "- -")
    if comment_line.endswith("-"):
        comment_line += " "
    return Markup(comment_line)


def comment(text: object, indent: str) -> Markup:
    """Return a complete comment, wrapped if necessary. Line breaks in the text are preserved."""
    paragraphs = str(text).split("\n")
    if len(paragraphs) == 1:
        on_one_line = f"{indent}<!-- {comment_text(paragraphs[0])} -->"
        if len(on_one_line) <= _MAX_LINE:
            return Markup(on_one_line)
    text_indent = f"{indent}     "
    lines = [f"{indent}<!--"]
    for paragraph in paragraphs:
        lines += [text_indent + line for line in _wrapped_lines(paragraph, _MAX_LINE - len(text_indent))]
    lines.append(f"{indent}-->")
    return Markup("\n".join(lines))


# The files for the order codes of a family share most lines.
@lru_cache(maxsize=1024)
def _wrapped_lines(paragraph: str, width: int) -> Sequence[str]:
    """Return a line of a comment, wrapped into lines of this width. An indented line is an item of a list."""
    is_list_item = paragraph.startswith("  ")
    return textwrap.wrap(
        str(comment_text(paragraph)),
        width,
        initial_indent="  " if is_list_item else "",
        subsequent_indent="    " if is_list_item else "",
    )


def ascii_text(text: object) -> Markup:
    """Return ``text`` for an element, in ASCII, with character references such as ``&#176;`` for other characters."""
    valid_text = without_invalid_characters(text_on_one_line(text))
    escaped_text = str(escape(valid_text))
    ascii_bytes = escaped_text.encode("ascii", "xmlcharrefreplace")
    return Markup(ascii_bytes.decode())


@dataclass(frozen=True)
class Node:
    """A ``Device`` element of the file: the bits that identify the device, its name, and facts about its data.

    ``notes`` and ``notes_of_data`` are comments before the name and before the data channel. ``devices`` are the
    elements inside it. ``length`` is 0 and ``crc_polynomial`` is empty if the element does not contain them.
    """

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
    """Return the element with the data length, in a tuple that is empty if order codes differ in the length.

    ``ids`` are the bits that identify the encoder. ``lengths`` are the lengths for its order codes.
    """
    if _number_of_lengths(lengths) != 1:
        return ()
    channel = Node(
        ids=ids,
        notes=("The same identity again, because the public example does not have CrcPoly and Length in one SCDS.",),
        notes_of_data=(_LENGTH_NOTE + _note_on_changing_length(device, layout),),
        length=lengths[0].data_bits,
        data_label=_data_label(device, layout),
    )
    return (channel,)


def _number_of_lengths(lengths: Sequence[DataLength]) -> int:
    """Return the number of different data lengths in bits."""
    return len({length.data_bits for length in lengths})


def _note_on_changing_length(device: Device, layout: Layout) -> str:
    """Return a note on the registers that change the length of the data, or an empty string if no register does."""
    register_fields = [field_at(device, path) for path in run_time_widths(device, layout)]
    if not register_fields:
        return ""
    joined_fields = " and ".join(register_fields)
    values_text = f"{words_for_initial_values(device)} of {joined_fields}"
    return f"\nInferred: Length is that of the {values_text}. It changes with them."


def _length_by_profile(device: Device, lengths: Sequence[DataLength]) -> dict[int, int]:
    """Return the data length by profile ID, such as ``{0x0C18: 24, 0x0C1A: 26}``.

    The result is empty unless there are several profile IDs, each with a single length.
    """
    length_by_profile: dict[int, int] = {}
    for profile_id, order_codes in profile_ids(device).items():
        lengths_of_profile = [length for length in lengths if not set(order_codes).isdisjoint(length.codes)]
        if _number_of_lengths(lengths_of_profile) != 1:
            return {}
        length_by_profile[profile_id] = lengths_of_profile[0].data_bits
    return length_by_profile if len(length_by_profile) > 1 else {}


def _data_label(device: Device, layout: Layout) -> str:
    """Return the label of a data channel: the measured quantity, such as ``position``, or else the frame."""
    measurement = device.measurement_of(Biss.name)
    return measurement.position_name if measurement is not None else text_on_one_line(layout.name.replace("_", " "))


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
    *,
    crc: Crc | None,
    lengths: Sequence[DataLength],
    ids: Sequence[IdBits],
    one_encoder: bool,
) -> str:
    """Return a comment with the further settings of a master: lengths, fields, CRC, times and errata.

    ``crc`` is the CRC of the single cycle data. It is None if order codes differ in it, and each length then states its
    own CRC. ``ids`` are the bits of registers that identify the encoder. ``one_encoder`` is True if the file is for a
    single order code.
    """
    heading = "Further settings of the master:" if one_encoder else _first_settings_line(device, layout, lengths)
    lines = [heading, *_lengths_by_profile(device, lengths)]
    for length in lengths:
        own_crc_text = _own_crc_text(device, length) if crc is None else ""
        lines.append(f"  {_length_line(length)}{own_crc_text}")
    lines.append(f"  sent in this order, most significant bit first: {_sent_fields(layout)}")
    lines.append(f"  code: {_number_code(device, layout)}")
    if crc is not None:
        crc_text = _crc_text(device, crc)
        lines.append(f"  CRC: {crc_text}. CrcPoly is the polynomial with its top bit")
    lines += _other_channels(device, layout)
    for setting in say_order_code.describe_settings(device, device.interface(Biss.name)):
        lines.append(f"  {PLAIN_STYLE.sentence(setting)}")
    lines += _one_profile(device, lengths)
    lines += _errata_lines(device, layout, ids)
    lines.append(f"  registers, procedures and everything else: {device.manufacturer.name}-{device.name}.xml")
    return "\n".join(lines)


def _length_line(length: DataLength) -> str:
    """Return a data length as text, such as ``X-24: position 24 = 24 bits, with status bits 26, with CRC 32``."""
    widths = " + ".join(f"{name} {width}" for name, width in length.width_by_field.items())
    return (
        f"{_codes_and_answers_text(length)}: {widths} = {length.data_bits} bits, "
        f"with status bits {length.bits_with_status}, with CRC {length.bits_with_crc}"
    )


def _own_crc_text(device: Device, length: DataLength) -> str:
    """Return the end of the line of a length with its own CRC: ``, CRC of 6 bits, …`` or ``, without a CRC``."""
    if length.crc is None:
        return ", without a CRC"
    return f", CRC of {_crc_text(device, length.crc)}"


def _codes_and_answers_text(length: DataLength) -> str:
    """Return the order codes with a length, and the answers to open questions that it applies to.

    An example is ``X-24, X-25 with wide``.
    """
    order_codes = ", ".join(length.codes)
    if not length.answers:
        return order_codes
    answers = " and ".join(length.answers)
    return f"{order_codes} with {answers}"


def _errata_lines(device: Device, layout: Layout, ids: Sequence[IdBits]) -> list[str]:
    """Return the errata about the frame and about the identifying registers, as indented lines."""
    register_paths = [f"registers.{id_bits.register}" for id_bits in ids]
    paths = (f"interfaces.biss.{layout.name}", *dict.fromkeys(register_paths))
    indented_lines = []
    for frame_erratum in errata_affecting(device, *paths):
        first_line, *further_lines = PLAIN_STYLE.lines(describe_erratum(frame_erratum))
        indented_lines.append(f"  {first_line}")
        indented_lines += [f"    {line}" for line in further_lines]
    return indented_lines


def _active_level(status: Field) -> str:
    """Return ``active low`` or ``active high`` for a status bit, or ``not used, always 1`` if it is not a flag."""
    # A status bit is a flag or one unused bit that is always 1.
    meaning = meaning_of(status)
    if not isinstance(meaning, ActiveFlag):
        return "not used, always 1"
    return "active low" if meaning.low else "active high"


def _lengths_by_profile(device: Device, lengths: Sequence[DataLength]) -> list[str]:
    """Return a line for each profile ID and a note, or no lines if the profile ID does not determine the data length.

    It determines the length if there are several profile IDs, and the models with each of them have the same length.
    """
    lines = []
    for profile_id, data_bits in _length_by_profile(device, lengths).items():
        order_codes = ", ".join(profile_ids(device)[profile_id])
        lines.append(f"  profile ID {profile_id:04X}h, registers 42h and 43h ({order_codes}): {data_bits} bits")
    if lines:
        lines.append(f"  {_PROFILE_NOTE}")
    return lines


def _one_profile(device: Device, lengths: Sequence[DataLength]) -> list[str]:
    """Return a line about the profile ID that all models share, or no lines unless there is exactly one.

    If the models differ in data length, the line also lists those whose length is the low byte of the profile ID.
    """
    # The order codes by their profile ID.
    profiles = profile_ids(device)
    if len(profiles) != 1:
        return []
    (profile_id,) = profiles
    if profile_id == 0:
        return ["  profile ID, registers 42h and 43h: 0000h, which means no profile"]
    line = f"  profile ID, registers 42h and 43h: {profile_id:04X}h"
    if _number_of_lengths(lengths) > 1:
        low_byte = profile_id & 0xFF
        matching_encoders = [_codes_and_answers_text(length) for length in lengths if length.data_bits == low_byte]
        line += ", for all lengths"
        # In some manuals, the low byte of a profile ID encodes the data length.
        if matching_encoders:
            line += f". Its low byte, {low_byte}, is the data length of {', '.join(matching_encoders)} only"
    return [line]


def _crc_text(device: Device, crc: Crc) -> str:
    """Return a CRC as text: its width and its parameters."""
    return f"{count_with_unit(crc.width, 'bit')}, {crc_parameters(device, crc)}"


def _other_channels(device: Device, layout: Layout) -> list[str]:
    """Return a line about each further data channel with a CRC, for which the file format has no known element."""
    lines = []
    for channel_layout in device.interface(Biss.name).layouts:
        crcs = device.crcs_of(channel_layout)
        if channel_layout is layout or channel_layout.channel is None or not crcs:
            continue
        data_fields = [field for field in channel_layout.fields if field not in channel_layout.crc_fields]
        names_and_widths = ", ".join(f"{field.name} {field.width.render()}" for field in data_fields)
        channel = f"other data channel {channel_layout.channel}, {channel_layout.name}"
        crc_texts = " or ".join(_crc_text(device, crc) for crc in crcs)
        lines.append(f"  {channel}: {names_and_widths} bits, CRC of {crc_texts}")
    return lines


def _sent_fields(layout: Layout) -> str:
    """Return the fields in the order of transmission, such as ``position, error (active low), CRC``.

    Without status bits, it ends in ``CRC, no status bits``.
    """
    texts_in_order = []
    for field in layout.fields:
        if field in layout.status_fields:
            texts_in_order.append(f"{field.name} ({_active_level(field)})")
        elif field not in layout.crc_fields:
            texts_in_order.append(field.name)
    texts_in_order.append("CRC")
    without_status = "" if layout.status_fields else ", no status bits"
    return ", ".join(texts_in_order) + without_status


def _first_settings_line(device: Device, layout: Layout, lengths: Sequence[DataLength]) -> str:
    """Return the first line of the settings, with the reason if the file gives no length.

    The reason is that registers change the length, or that one device ID covers several lengths.
    """
    register_fields = [field_at(device, path) for path in run_time_widths(device, layout)]
    if register_fields:
        joined_fields = " and ".join(register_fields)
        dependence = f"it depends on the current content of {joined_fields}. Set it in the master."
        return f"No Length: {dependence} {words_for_initial_values(device).capitalize()}:"
    number_of_lengths = _number_of_lengths(lengths)
    if number_of_lengths == 1:
        return "Further settings of the master, by order code:"
    sentences = [f"No Length: one device ID covers {number_of_lengths} data lengths"]
    if _length_by_profile(device, lengths):
        sentences.append("The profile ID distinguishes them")
    for alternative in device.alternatives_of(layout):
        sentences.append(f"You choose {alternative.name} ({alternative.meaning})")
    sentences.append("Set the length of the order code in the master:")
    return ". ".join(sentences)


def _number_code(device: Device, layout: Layout) -> str:
    """Return the code of the numbers in a frame, such as ``binary`` or ``position in Gray code``."""
    if not layout.gray_of:
        return "binary"
    if layout.gray_when:
        return _selected_code(device, layout)
    excess = f" with an excess of {layout.gray_excess.render()}" if layout.gray_excess is not None else ""
    return f"{layout.gray_of} in Gray code{excess}"


def _selected_code(device: Device, layout: Layout) -> str:
    """Return the code of a number, Gray or binary, if the order code or a register selects it.

    Examples are ``position Gray`` and ``position in Gray code or binary, selected by FORMAT, factory default binary``.
    """
    factory_codes = {_factory_code(variant, layout) for variant in device.variants_over(Biss.name)}
    factory_code = factory_codes.pop() if len(factory_codes) == 1 else "by order code"
    # The numbers are in Gray code if the parameter ``gray_when`` is not 0. It can be derived from other parameters.
    deciding_parameters = device.needed_parameters([layout.gray_when])
    register_fields = []
    for parameter in device.run_time_parameters:
        if parameter.name in deciding_parameters:
            register_fields.append(field_at(device, parameter.read_from))
    if not register_fields:
        return f"{layout.gray_of} {factory_code}"
    joined_fields = ", ".join(register_fields)
    return f"{layout.gray_of} in Gray code or binary, selected by {joined_fields}, factory default {factory_code}"


def _factory_code(variant: Variant, layout: Layout) -> str:
    """Return the code of the numbers that an order code has as its factory default."""
    return "Gray" if variant.parameters[layout.gray_when] else "binary"
