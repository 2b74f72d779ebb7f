"""Draw a card for each family on the start page: its name, its interfaces, and its frame as a row of bits."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.model import Device, Flag, Layout, PlacedField, PlacedLayout, Variant, choices
from codewheel.say.names_and_places import words
from codewheel.say.plain_text import counted

#: Fields with fewer bits have room for a letter only, which the caption explains.
_TEXT = 3


def cards(source: Path) -> list[str]:
    """Return the HTML of the cards of those families that have a page among the pages of ``source``."""
    families, _ = load_library()
    devices = [device for device in families if (source / "generated" / "docs" / f"{device.name}.md").exists()]
    return ['<div class="cards">\n', *(line for device in devices for line in _card(device)), "</div>\n"]


def _card(device: Device) -> Iterator[str]:
    """Yield the card of a family. It has no row of bits if all frames are bytes."""
    interfaces = ", ".join(interface.title for interface in device.interfaces)
    yield f'<div class="card"><h3><a href="generated/docs/{device.name}.md">{escape(device.title)}</a></h3>\n'
    manufacturer = escape(device.manufacturer.title)
    order_codes = counted(len(device.variants), "order code")
    grade = escape(device.evidence.grade)
    yield f'<p class="facts">{manufacturer}. {escape(interfaces)}. {order_codes}. Evidence: {grade}.</p>\n'
    frames = _frames_of_bits(device)
    if frames:
        yield from _picture(device, *max(frames, key=_rank))
    yield "</div>\n"


def _picture(device: Device, variant: Variant, placed: PlacedLayout) -> Iterator[str]:
    """Yield a frame as a row of bits, and the text below it."""
    yield f"{_bits(placed)}\n"
    title = device.interface(variant.interface).title
    letters = [f"{_letter(field)} {words(field.name)}" for field in _left_to_right(placed) if _size(field) < _TEXT]
    legend = f" {', '.join(letters)}." if letters else ""
    frame = escape(f"Frame of {variant.code} over {title}: ")
    yield f'<p class="facts">{frame}{_size_of(device, variant, placed)}.{escape(legend)}</p>\n'


def _size_of(device: Device, variant: Variant, placed: PlacedLayout) -> str:
    """Return the length of a frame, or each length that it can have, with a link to the open question."""
    open_ = device.alternatives_of(placed.layout)
    bits = [placed.layout.place({**variant.parameters, **sets}).bits for _, sets in choices(open_)]
    if len(set(bits)) == 1:
        return f"{placed.bits} bits"
    page = f"generated/docs/{device.name}/{variant.interface}.md#alternative-{open_[0].name}"
    lengths = " or ".join(str(length) for length in dict.fromkeys([placed.bits, *bits]))
    return f'{lengths} bits (<a href="{page}">open question</a>), drawn with {placed.bits}'


def _rank(frame: tuple[Variant, PlacedLayout]) -> tuple[bool, int]:
    """Return the rank of a frame for the card. The longest is best, with a CRC if there is one."""
    _, placed = frame
    return placed.layout.crc_field is not None, placed.bits


def _frames_of_bits(device: Device) -> list[tuple[Variant, PlacedLayout]]:
    """Return the frames of bits that the encoder sends, each with its order code."""
    frames: list[tuple[Variant, PlacedLayout]] = []
    for variant in device.variants:
        layouts = [layout for layout in device.interface(variant.interface).layouts if _is_frame_of_bits(layout)]
        frames += [(variant, layout.place(variant.parameters)) for layout in layouts]
    return frames


def _is_frame_of_bits(layout: Layout) -> bool:
    return not layout.in_bytes and not layout.channel and layout.sender == "encoder"


def _bits(placed: PlacedLayout) -> str:
    fields = _left_to_right(placed)
    spans = "".join(_span(placed, field) for field in fields)
    spoken = ", ".join(f"{words(field.name)} {_places(field)}" for field in fields)
    return f'<div class="bits" role="img" aria-label="{placed.bits} bits: {escape(spoken)}">{spans}</div>'


def _span(placed: PlacedLayout, field: PlacedField) -> str:
    size = _size(field)
    is_flag = size == 1 or isinstance(field.field.kind, Flag)
    kind = "flag" if is_flag else "position"
    if field.field == placed.layout.crc_field:
        kind = "crc"
    label = _letter(field) if size < _TEXT else f"{escape(words(field.name))}<br>{_places(field)}"
    title = f"{words(field.name)}, {_places(field)}"
    return f'<span class="{kind}" style="flex-grow: {size}" title="{escape(title)}">{label}</span>'


def _left_to_right(placed: PlacedLayout) -> list[PlacedField]:
    return sorted((field for field in placed.fields if field.high >= field.low), key=lambda field: -field.high)


def _size(field: PlacedField) -> int:
    return field.high - field.low + 1


def _letter(field: PlacedField) -> str:
    return words(field.name)[0].upper()


def _places(field: PlacedField) -> str:
    return f"{field.high}:{field.low}" if field.high > field.low else f"{field.high}"
