"""Draw a card for each family on the start page: its name, its interfaces, and its frame as a row of bits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.model import Device, Flag, Layout, PlacedField, PlacedLayout, Variant, answer_combinations
from codewheel.say.layout import box_colour
from codewheel.say.names_and_evidence import GRADES, name_in_words

#: Fields with fewer bits, or with a smaller part of the frame, have room for a letter only, which the caption explains.
_TEXT, _PART = 3, 9


def cards(source: Path) -> list[str]:
    """Return the HTML of the cards of those families that have a page among the pages of ``source``."""
    families, _ = load_library()
    devices = [device for device in families if (source / "generated" / "docs" / f"{device.name}.md").exists()]
    devices.sort(key=lambda device: (GRADES.index(device.evidence.grade), device.manufacturer.title, device.name))
    families_html = [line for device in devices for line in _card(device)]
    return [*_filters(devices), '<div class="cards gallery">\n', *families_html, "</div>\n"]


def _filters(devices: Sequence[Device]) -> Iterator[str]:
    """Yield the inputs that filter the cards. They are hidden without a script."""
    manufacturers = sorted({device.manufacturer.title for device in devices}, key=str.lower)
    interfaces = dict.fromkeys(interface.title for device in devices for interface in device.interfaces)
    yield '<form class="filters" aria-label="Filter the encoders" hidden>\n'
    yield '<label>Words <input type="text" name="words" placeholder="linear, Gray, 4096" autocomplete="off"></label>\n'
    yield from _menu("Manufacturer", "manufacturer", manufacturers)
    yield from _menu("Interface", "interface", interfaces)
    yield f'<output aria-live="polite">{len(devices)} families</output>\n'
    yield '<p class="none" hidden>No encoder family matches. <button type="button">Clear the filters</button></p>\n'
    yield "</form>\n"


def _menu(title: str, name: str, choices_of: Iterable[str]) -> Iterator[str]:
    options = "".join(f"<option>{escape(choice)}</option>" for choice in choices_of)
    yield f'<label>{title} <select name="{name}"><option value="">all</option>{options}</select></label>\n'


def _card(device: Device) -> Iterator[str]:
    """Yield the card of a family with the picture of a frame, and the words by which it is filtered."""
    manufacturer = escape(device.manufacturer.title)
    interfaces = [escape(interface.title) for interface in device.interfaces]
    data = f'data-manufacturer="{manufacturer}" data-interface="{"|".join(interfaces)}"'
    yield f'<div class="card" {data} data-words="{escape(_words_of(device))}">\n'
    yield f'<h3><a href="generated/docs/{device.name}.md">{escape(device.title)}</a></h3>\n'
    grade = escape(device.evidence.grade)
    badges = "".join(f'<span class="tag">{interface}</span> ' for interface in interfaces)
    yield f'<p class="facts"><b>{manufacturer}</b> {badges}<span class="tag grade">{grade}</span></p>\n'
    frames = _frames_of_bits(device)
    if frames:
        yield from _picture(device, *max(frames, key=_rank))
    else:
        yield from _picture_of_bytes(device)
    yield "</div>\n"


def _words_of(device: Device) -> str:
    """Return the words of a family other than its title: its order codes, kind of movement and code."""
    codes = [variant.code for variant in device.variants]
    is_gray = any(layout.gray_of for _, layout in device.layouts())
    return " ".join([device.name, device.movement, *(["Gray"] if is_gray else []), *codes])


def _picture_of_bytes(device: Device) -> Iterator[str]:
    """Yield the longest reply of an encoder that sends bytes, as a row of its fields."""
    replies = [
        (variant, layout.place(variant.parameters))
        for variant in device.variants
        for layout in device.interface(variant.interface).layouts
        if layout.in_bytes and not layout.channel and layout.sender == "encoder"
    ]
    if replies:
        variant, placed = max(replies, key=_rank)
        yield f"{_bits(placed)}\n"
        title = device.interface(variant.interface).title
        about = f"Reply of {variant.code} over {title}: {placed.bits // 8} bytes.{_legend(placed)}"
        yield f'<p class="facts">{escape(about)}</p>\n'


def _picture(device: Device, variant: Variant, placed: PlacedLayout) -> Iterator[str]:
    """Yield a frame as a row of bits, and the text below it."""
    yield f"{_bits(placed)}\n"
    title = device.interface(variant.interface).title
    frame = escape(f"Frame of {variant.code} over {title}: ")
    yield f'<p class="facts">{frame}{_size_of(device, variant, placed)}.{escape(_legend(placed))}</p>\n'


def _legend(placed: PlacedLayout) -> str:
    """Return the names of the fields that are drawn with a letter."""
    lettered = [field for field in _left_to_right(placed) if _is_narrow(placed, field)]
    letters = [f"{_letter(field)}\u00a0=\u00a0{name_in_words(field.name)}" for field in lettered]
    return f" {', '.join(letters)}." if letters else ""


def _is_narrow(placed: PlacedLayout, field: PlacedField) -> bool:
    return _size(field) < _TEXT or _size(field) * _PART < placed.bits


def _size_of(device: Device, variant: Variant, placed: PlacedLayout) -> str:
    """Return the length of a frame, or each length that it can have, with a link to the open question."""
    open_ = device.alternatives_of(placed.layout)
    bits = [placed.layout.place({**variant.parameters, **sets}).bits for _, sets in answer_combinations(open_)]
    if len(set(bits)) == 1:
        return f"{placed.bits} bits"
    page = f"generated/docs/{device.name}/{variant.interface}.md#alternative-{open_[0].name}"
    lengths = " or ".join(str(length) for length in dict.fromkeys([placed.bits, *bits]))
    return f'{lengths} bits (<a href="{page}">open question</a>), drawn with {placed.bits}'


def _rank(frame: tuple[Variant, PlacedLayout]) -> tuple[bool, int]:
    """Return the rank of a frame for the card. The longest is best, with a CRC if there is one."""
    _, placed = frame
    return placed.crc_field is not None, placed.bits


def _frames_of_bits(device: Device) -> list[tuple[Variant, PlacedLayout]]:
    """Return the frames of bits that the encoder sends, each with its order code."""
    frames: list[tuple[Variant, PlacedLayout]] = []
    for variant in device.variants:
        layouts = [layout for layout in device.interface(variant.interface).layouts if _is_frame_of_bits(layout)]
        frames += [(variant, layout.place(variant.parameters)) for layout in layouts]
    return frames


def _is_frame_of_bits(layout: Layout) -> bool:
    # Of several data channels in a frame, the card shows the first.
    return not layout.in_bytes and layout.channel in (None, 1) and layout.sender == "encoder"


def _bits(placed: PlacedLayout) -> str:
    fields = _left_to_right(placed)
    spans = "".join(_span(placed, field) for field in fields)
    spoken = ", ".join(f"{name_in_words(field.name)} {_places(field)}" for field in fields)
    return f'<div class="bits" role="img" aria-label="{placed.bits} bits: {escape(spoken)}">{spans}</div>'


def _span(placed: PlacedLayout, field: PlacedField) -> str:
    size = _size(field)
    kind = f"bits-{box_colour(field.field)}"
    if size == 1 or isinstance(field.field.kind, Flag):
        kind += " flag"
    label = f"{escape(name_in_words(field.name))}<br>{_places(field)}"
    if _is_narrow(placed, field):
        kind, label = f"{kind} narrow", _letter(field)
    title = f"{name_in_words(field.name)}, {_places(field)}"
    return f'<span class="{kind}" style="flex-grow: {size}" title="{escape(title)}">{label}</span>'


def _left_to_right(placed: PlacedLayout) -> list[PlacedField]:
    """Return the fields in the order in which they are sent. Fields of bytes are described in this order."""
    fields = [field for field in placed.fields if field.highest_bit >= field.lowest_bit]
    return fields if placed.layout.in_bytes else sorted(fields, key=lambda field: -field.highest_bit)


def _size(field: PlacedField) -> int:
    return field.highest_bit - field.lowest_bit + 1


def _letter(field: PlacedField) -> str:
    return name_in_words(field.name)[0].upper()


def _places(field: PlacedField) -> str:
    return f"{field.highest_bit}:{field.lowest_bit}" if field.highest_bit > field.lowest_bit else f"{field.highest_bit}"
