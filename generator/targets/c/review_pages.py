"""The errata of the manuals of a manufacturer in full, as a page next to the headers that mention them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, NamedTuple, TypedDict

from ...model import (
    Crc,
    Device,
    Erratum,
    Layout,
    Manufacturer,
    Spi,
    Ssi,
    Verdict,
    answer_combinations,
    channel_frame,
    cite,
    layer_in_words,
)
from ...model.record import dataclass
from ...plan.crcs import UndetectedErrors, residual_of
from ...plan.verdicts import reportings
from ...say.errata import STATUS_IN_WORDS, consequence, content_before_and_after, paths_in_words
from ...say.names_and_places import name_in_words
from .device import manual_title
from .names import errata_page_name

ERRATA_TEMPLATE = "ERRATA.md.jinja"
Rows = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ErratumText:
    """An erratum of a manual, as text.

    ``standing`` is a sentence with its name, status and impact. Each row has a label and a text.
    """

    title: str
    standing: str
    rows: Rows


@dataclass(frozen=True)
class FamilyErrata:
    """The errata of a family, and the changes by each other edition of the manual and by each overlay on the spec."""

    title: str
    manual: str
    errata: tuple[ErratumText, ...]
    editions: tuple[tuple[str, tuple[Rows, ...]], ...]


class ErrataPage(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    families: Annotated[list[FamilyErrata], "the families with their errata"]


def errata_files(
    makers: Iterable[tuple[Manufacturer, Iterable[Device]]], render: Callable[[str, Mapping[str, object]], str]
) -> Iterator[tuple[str, str]]:
    """Yield the path in the C folder and the text of the page with the errata of each manufacturer."""
    for maker, devices in makers:
        values: ErrataPage = {"maker": maker, "families": [_family_errata(device) for device in devices]}
        yield errata_page_name(maker.name), render(ERRATA_TEMPLATE, values)


def _family_errata(device: Device) -> FamilyErrata:
    """Return the errata of the manual of a family, and separately the changes by other editions and overlays.

    ``editions`` contains the name of each edition or overlay with its changes, in the order of the errata.
    """
    errata_of_manual: list[ErratumText] = []
    changes_by_layer: dict[str, list[Rows]] = {}
    for erratum in device.errata:
        if erratum.overlay or erratum.edition:
            layer = layer_in_words(erratum.overlay, erratum.edition)
            labeled_texts = (*content_before_and_after(erratum), *_reason_and_source(erratum))
            changes_by_layer.setdefault(layer, []).append(labeled_texts)
        else:
            errata_of_manual.append(_erratum_text(erratum))
    return FamilyErrata(
        title=device.title,
        manual=manual_title(device),
        errata=tuple(errata_of_manual),
        editions=tuple((layer, tuple(changes)) for layer, changes in changes_by_layer.items()),
    )


def _erratum_text(erratum: Erratum) -> ErratumText:
    """Return the text of an erratum, without empty rows."""
    labeled_texts = (
        ("Affects", paths_in_words(", ".join(erratum.affects))),
        ("Printed", erratum.printed),
        ("Used", erratum.used),
        ("Only with", erratum.only),
    )
    rows = tuple((label, text) for label, text in labeled_texts if text)
    return ErratumText(
        title=erratum.title,
        standing=f"The erratum {erratum.name} is {STATUS_IN_WORDS[erratum.status]}. {consequence(erratum.severity)}.",
        rows=(*rows, *_reason_and_source(erratum)),
    )


def _reason_and_source(erratum: Erratum) -> Iterator[tuple[str, str]]:
    """Yield the rows ``Why`` and ``Source``, if they have content."""
    if erratum.why:
        yield "Why", erratum.why
    if erratum.source:
        yield "Source", cite(erratum.source)


TEMPLATE = "ASSUMPTIONS.md.jinja"


@dataclass(frozen=True)
class FramesWithCrc:
    """Frames of one length whose CRCs have the same polynomial, and the errors that the CRC does not detect in them."""

    crc: Crc
    names: tuple[str, ...]
    residual: UndetectedErrors


class _KindOfFrames(NamedTuple):
    """Frames in which the CRC misses the same errors: of one length, with CRCs of one width and one polynomial."""

    crc_width: int
    polynomial: int
    bits: int


class Assumptions(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    frames: Annotated[list[FramesWithCrc], "the frames with a CRC, by CRC and length"]
    silent: Annotated[list[str], "the frames with a position whose verdict is always unknown"]
    unprotected: Annotated[list[str], "the SSI words with a position that have no CRC"]
    interfaces: Annotated[frozenset[str], "the interfaces of the encoders"]
    later: Annotated[bool, "whether an encoder over SPI answers with the next word"]
    parity: Annotated[list[str], "the frames with a position that have a parity bit and no CRC"]
    compared: Annotated[list[str], "the frames with several data channels whose positions are compared"]


def assumptions_files(
    makers: Iterable[tuple[Manufacturer, tuple[Device, ...]]], render: Callable[[str, Mapping[str, object]], str]
) -> Iterator[tuple[str, str]]:
    """Yield the path in the C folder and the text of each manufacturer's page with assumptions, for safety reviews."""
    for maker, devices in makers:
        interfaces = [interface for device in devices for interface in device.interfaces]
        values: Assumptions = {
            "maker": maker,
            "frames": list(_group_frames_by_crc(devices)),
            "silent": list(_frames_without_verdict(devices)),
            "unprotected": list(_yield_unprotected(devices)),
            "interfaces": frozenset(interface.name for interface in interfaces),
            "later": any(isinstance(interface, Spi) and interface.reply == "next_word" for interface in interfaces),
            "parity": list(_frames_with_parity(devices)),
            "compared": list(_frames_with_comparison(devices)),
        }
        yield f"ASSUMPTIONS-{maker.name}.md", render(TEMPLATE, values)


def _group_frames_by_crc(devices: tuple[Device, ...]) -> Iterator[FramesWithCrc]:
    """Yield the frames that have the same length and the same polynomial, with the errors that the CRC does not detect.

    They are in order of the width of the CRC, of its polynomial and of the length.
    """
    crcs_by_kind: dict[_KindOfFrames, dict[str, Crc]] = {}
    for device in devices:
        for interface, layout in device.layouts():
            name = _frame_name(device, interface=interface.title, layout=layout)
            for crc, bits in _crcs_and_lengths(device, interface.name, layout):
                kind_of_frames = _KindOfFrames(crc.width, crc.poly, bits)
                crcs_by_kind.setdefault(kind_of_frames, {}).setdefault(name, crc)
    for kind_of_frames, crc_by_name in sorted(crcs_by_kind.items()):
        first_crc = next(iter(crc_by_name.values()))
        undetected_errors = residual_of(first_crc, kind_of_frames.bits)
        yield FramesWithCrc(crc=first_crc, names=tuple(crc_by_name), residual=undetected_errors)


def _crcs_and_lengths(device: Device, interface: str, layout: Layout) -> Iterator[tuple[Crc, int]]:
    """Yield each CRC of a frame with each length in bits that the frame can have. A pair can come several times.

    The lengths are those for each order code and each answer to an open question. If all frames have the CRC, the
    longest frame that registers of the encoder can select is included.
    """
    if layout.always_has_crc:
        for crc in device.crcs_of(layout):
            yield crc, layout.widest
    for variant in device.variants_over(interface):
        for _, parameters_of_answers in answer_combinations(device.alternatives):
            placed = layout.place({**variant.parameters, **parameters_of_answers})
            placed_crc = device.crc_of(placed)
            if placed_crc is not None:
                yield placed_crc, placed.bits


def _frames_without_verdict(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with a position whose verdict is always unknown: no flag or unused bit affects it."""
    for device in devices:
        for reporting in reportings(device).values():
            rules = reporting.verdict_rules
            if rules is not None and rules.otherwise is Verdict.UNKNOWN and not rules.worst_first:
                yield _frame_name(device, interface=reporting.interface.title, layout=reporting.codec.layout)


def _yield_unprotected(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames over SSI with a position that have no CRC, at least with some order codes."""
    for device in devices:
        for interface, layout in device.layouts():
            has_position = device.sends_position(interface.name, layout)
            if isinstance(interface, Ssi) and has_position and not layout.always_has_crc:
                yield _frame_name(device, interface=interface.title, layout=layout) + _of_some_codes(layout)


def _frames_with_parity(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with a position that have a parity bit and, at least with some order codes, no CRC."""
    for device in devices:
        for interface, layout in device.layouts():
            has_only_parity = layout.has_parity and not layout.always_has_crc
            if has_only_parity and device.sends_position(interface.name, layout):
                yield _frame_name(device, interface=interface.title, layout=layout) + _of_some_codes(layout)


def _frames_with_comparison(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with several data channels whose positions must agree."""
    for device in devices:
        for interface in device.interfaces:
            frame = channel_frame(interface)
            if frame is not None and frame.compared:
                names = " and ".join(name_in_words(layout.name) for layout in frame.layouts)
                yield f"{device.name.upper()} {interface.title}: {names}"


def _of_some_codes(layout: Layout) -> str:
    """Return the remark that only some order codes have no CRC, or an empty string if this applies to all."""
    return " (some order codes)" if layout.crc_fields else ""


def _frame_name(device: Device, interface: str, layout: Layout) -> str:
    """Return the name of a frame on a page for all families, such as ``X BiSS: position``."""
    return f"{device.name.upper()} {interface}: {name_in_words(layout.name)}"
