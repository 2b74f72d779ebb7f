"""Draw a card for each family on the start page: its name, its interfaces, and its frame as a row of bits."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.model import Device, Flag, PlacedField, PlacedLayout, Variant, choices
from codewheel.say.name import words

#: Fields with fewer bits have room for a letter only, which the caption explains.
_TEXT = 3


def cards(source: Path) -> list[str]:
    """Return the HTML of the cards of those families that have a page among the pages of ``source``."""
    families, _ = load_library()
    shown = [device for device in families if (source / "generated" / "docs" / f"{device.name}.md").exists()]
    return ['<div class="cards">\n', *(line for device in shown for line in _card(device)), "</div>\n"]


def _card(device: Device) -> Iterator[str]:
    variant, placed = _frame(device)
    interfaces = ", ".join(item.title for item in device.interfaces)
    yield f'<div class="card"><h3><a href="generated/docs/{device.name}.md">{escape(device.title)}</a></h3>\n'
    manufacturer = escape(device.manufacturer.title)
    yield f'<p class="facts">{manufacturer}. {escape(interfaces)}. {len(device.variants)} order codes.</p>\n'
    yield f"{_bits(placed)}\n"
    title = device.interface(variant.interface).title
    letters = [f"{_letter(item)} {words(item.name)}" for item in _left_to_right(placed) if _size(item) < _TEXT]
    legend = f" {', '.join(letters)}." if letters else ""
    frame = escape(f"Frame of {variant.code} over {title}: ")
    yield f'<p class="facts">{frame}{_size_of(device, variant, placed)}.{escape(legend)}</p></div>\n'


def _size_of(device: Device, variant: Variant, placed: PlacedLayout) -> str:
    """Return the length of a frame, or each length that it can have, with a link to the open question."""
    open_ = device.alternatives_of(placed.layout)
    bits = [placed.layout.place({**variant.parameters, **sets}).bits for _, sets in choices(open_)]
    if len(set(bits)) == 1:
        return f"{placed.bits} bits"
    page = f"generated/docs/{device.name}/{variant.interface}.md#alternative-{open_[0].name}"
    others = " or ".join(str(item) for item in dict.fromkeys([placed.bits, *bits]))
    return f'{others} bits (<a href="{page}">open question</a>), drawn with {placed.bits}'


def _frame(device: Device) -> tuple[Variant, PlacedLayout]:
    """Return the order code of a family with the longest frame of bits, and this frame. One with a CRC is preferred."""
    found = [
        (item, layout.place(item.parameters))
        for item in device.variants
        for layout in device.interface(item.interface).layouts
        if not layout.in_bytes and not layout.channel and layout.sender == "encoder"
    ]
    return max(found, key=lambda item: (item[1].layout.crc_field is not None, item[1].bits))


def _bits(placed: PlacedLayout) -> str:
    fields = _left_to_right(placed)
    spans = "".join(_span(placed, item) for item in fields)
    spoken = ", ".join(f"{words(item.name)} {_places(item)}" for item in fields)
    return f'<div class="bits" role="img" aria-label="{placed.bits} bits: {escape(spoken)}">{spans}</div>'


def _span(placed: PlacedLayout, item: PlacedField) -> str:
    size = _size(item)
    is_flag = size == 1 or isinstance(item.field.kind, Flag)
    kind = "crc" if item.field == placed.layout.crc_field else "flag" if is_flag else "position"
    label = _letter(item) if size < _TEXT else f"{escape(words(item.name))}<br>{_places(item)}"
    title = f"{words(item.name)}, {_places(item)}"
    return f'<span class="{kind}" style="flex-grow: {size}" title="{escape(title)}">{label}</span>'


def _left_to_right(placed: PlacedLayout) -> list[PlacedField]:
    return sorted((item for item in placed.fields if item.high >= item.low), key=lambda item: -item.high)


def _size(item: PlacedField) -> int:
    return item.high - item.low + 1


def _letter(item: PlacedField) -> str:
    return words(item.name)[0].upper()


def _places(item: PlacedField) -> str:
    return f"{item.high}:{item.low}" if item.high > item.low else f"{item.high}"
