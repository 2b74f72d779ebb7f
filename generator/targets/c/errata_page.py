"""The errata of the manuals of a manufacturer in full, as a page next to the headers that mention them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, TypedDict

from ...model import Device, Erratum, Manufacturer, cite, layer_in_words
from ...model.record import dataclass
from ...say.errata import STATUS_IN_WORDS, consequence, content_before_and_after, paths_in_words
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
