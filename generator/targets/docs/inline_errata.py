"""Errata where they bite: each with its reason on the spot, and in full on a page of the family and on one of all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any, TypedDict

from ...model import Device, Erratum
from ...say.erratum import errata, erratum
from ...say.markdown import STYLE, anchor, cited, code, link, text
from . import fact_tables
from .page_links import ERRATA, to_erratum

#: The page of all families; no family can be called so.
ALL = "all-errata.md"
#: What is longer on the spot is told without the reason, which is a link away, unless wrong bytes are at stake.
_LONG = 500
Rows = list[tuple[str, ...]]


class ErrataPage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_summary: Annotated[str, "how many errata there are, and how many are open"]
    erratum_links: Annotated[list[tuple[str, list[str]]], "status and stake, and links to the errata of that kind"]
    errata_list: Annotated[list[dict[str, Any]], "the errata in full: erratum, rows"]


class AllErrataPage(TypedDict):
    standings: Annotated[list[dict[str, Any]], "open ones, then settled ones: title, anchor, rows"]


class OnPage:
    """The errata of one page: each is told with its reason where it first bites, and named where it does again."""

    def __init__(self, device: Device, folder: str = "") -> None:
        self._device, self._page, self._told = device, f"{folder}{ERRATA}", set[str]()

    def __call__(self, *paths: str) -> str:
        """Those that are about exactly these paths into the spec, or about something inside them, as a list."""
        found = errata(self._device, *paths, wording=True)
        elsewhere = [item for item in found if item.edition and not self._device.edition]
        own = [item for item in found if item not in elsewhere]
        lines = [self._line(item) for item in own if item.severity != "wording"]
        wording = [item for item in own if item.severity == "wording"]
        if wording:
            lines.append("Wording only: " + ", ".join(self._link(item, code(item.name)) for item in wording))
        if elsewhere:
            lines.append(
                "Otherwise in editions " + ", ".join(self._link(item, text(item.edition)) for item in elsewhere)
            )
        return "\n".join(f"- {line}" for line in lines)

    def named(self, *paths: str) -> str:
        """The same in a cell of a table, which leads to where they are told."""
        found = errata(self._device, *paths, wording=True)
        return ", ".join(f"{badge(item)} {self._link(item, code(item.name))}" for item in found)

    def _link(self, item: Erratum, label: str) -> str:
        return link(label, f"{self._page}#erratum-{item.name}")

    def _line(self, item: Erratum) -> str:
        if item.name in self._told:
            return f"{badge(item)} {link(code(item.name), f'#erratum-{item.name}')}, told above"
        self._told.add(item.name)
        place, said = anchor(f"erratum-{item.name}"), erratum(item, whole=True)
        is_long = item.severity != "wrong_data" and len(STYLE.phrase(said)) > _LONG
        told = STYLE.phrase(erratum(replace(item, why=""), whole=True) if is_long else said)
        name = self._link(item, "Why?" if is_long else "In full")
        return f"{place}{badge(item)} {code(item.name)}: {told} {STYLE.cited(item.source)} {name}"


def badge(item: Erratum) -> str:
    """Whether it is settled, to be seen from afar."""
    return "⚠ **open**" if item.status == "open" else "✓ settled"


def _of_manual(device: Device) -> list[Erratum]:
    return [item for item in device.errata if not (item.overlay or item.edition)]


def page_values(device: Device) -> ErrataPage:
    of_manual = _of_manual(device)
    is_open = [item for item in of_manual if item.status == "open"]
    return {
        "device": device,
        "errata_summary": f"{len(of_manual)} places where the manual cannot be taken literally; "
        f"{len(is_open)} of them are open: only hardware or the manufacturer could decide. The others are settled by "
        "the manual's own evidence or by arithmetic." + fact_tables.changes(len(device.errata) - len(of_manual)),
        "erratum_links": [
            (text(standing), [link(code(item.name), f"#erratum-{item.name}") for item in found])
            for standing, found in _by_standing(device.errata)
        ],
        "errata_list": [
            {
                "erratum": item,
                "rows": [
                    *fact_tables.printed_and_used(item),
                    ("Why", text(item.why)),
                    ("Status", badge(item)),
                    ("At stake", fact_tables.severity(item.severity)),
                    ("Affects", ", ".join(map(code, item.affects))),
                    ("Source", cited(item.source)),
                ],
            }
            for item in device.errata
        ],
    }


def _by_standing(found: Sequence[Erratum]) -> Iterator[tuple[str, list[Erratum]]]:
    """The errata by status and by what is at stake, open ones first and wrong bytes before words."""
    for status in ("open", "settled"):
        for severity in fact_tables.SEVERITIES:
            alike = [item for item in found if (item.status, item.severity) == (status, severity)]
            if alike:
                yield f"{status}, {fact_tables.severity(severity)}", alike


def all_values(devices: Sequence[Device]) -> AllErrataPage:
    titles = {"open": "Open: only hardware or the manufacturer could decide", "settled": "Settled"}
    parts = [
        {"title": title, "anchor": status, "rows": list(_rows(devices, status))} for status, title in titles.items()
    ]
    return {"standings": [part for part in parts if part["rows"]]}


def _rows(devices: Sequence[Device], status: str) -> Iterator[tuple[str, ...]]:
    """What is at stake, family, erratum, what is printed, what is used; wrong bytes before words."""
    for severity in fact_tables.SEVERITIES:
        for device in devices:
            family = link(text(device.name.upper()), f"{device.name}.md")
            for item in _of_manual(device):
                if (item.status, item.severity) == (status, severity):
                    name = to_erratum(device, item.name)
                    yield text(fact_tables.severity(severity)), family, name, text(item.printed), text(item.used)
