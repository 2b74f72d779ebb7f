"""The errata of the manuals of a manufacturer in full, as a page next to the headers that mention them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Annotated, TypedDict

from ...model import Device, Erratum, Manufacturer, cite, layer_in_words
from ...model.record import dataclass
from ...say.errata import STATUS_IN_WORDS, changed, consequence, paths_in_words
from .device import manual_title
from .names import errata_page_name

ERRATA_TEMPLATE = "ERRATA.md.jinja"
Rows = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ErratumText:
    """An erratum of a manual. ``standing`` is its name with its status and impact, and each row has a label."""

    title: str
    standing: str
    rows: Rows


@dataclass(frozen=True)
class FamilyErrata:
    """The errata of a family, and the changes by each edition or overlay."""

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
    """Yield the page of each manufacturer, by its path in the C folder."""
    for maker, devices in makers:
        values: ErrataPage = {"maker": maker, "families": [_family_errata(device) for device in devices]}
        yield errata_page_name(maker.name), render(ERRATA_TEMPLATE, values)


def _family_errata(device: Device) -> FamilyErrata:
    """Return the errata of a family, with changes by editions and overlays separate from the errata of its manual.

    ``editions`` contains the name of each edition or overlay with its changes, in the order of the errata.
    """
    errata_of_manual = [erratum for erratum in device.errata if not (erratum.overlay or erratum.edition)]
    # Each of the other errata has its labelled texts as rows, under the name of its edition or overlay.
    changes_by_layer: dict[str, list[Rows]] = {}
    for erratum in device.errata:
        if erratum.overlay or erratum.edition:
            layer = layer_in_words(erratum.overlay, erratum.edition)
            labelled_texts = (*changed(erratum), *_reason_and_source(erratum))
            changes_by_layer.setdefault(layer, []).append(labelled_texts)
    return FamilyErrata(
        title=device.title,
        manual=manual_title(device),
        errata=tuple(map(_erratum_text, errata_of_manual)),
        editions=tuple((layer, tuple(changes)) for layer, changes in changes_by_layer.items()),
    )


def _erratum_text(erratum: Erratum) -> ErratumText:
    """Return the text of an erratum, without empty rows."""
    labelled_texts = (
        ("Affects", paths_in_words(", ".join(erratum.affects))),
        ("Printed", erratum.printed),
        ("Used", erratum.used),
        ("Only with", erratum.only),
    )
    rows = tuple((label, text) for label, text in labelled_texts if text)
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
