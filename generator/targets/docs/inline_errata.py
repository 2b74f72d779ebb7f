"""Errata, shown next to the facts that they affect, and in full on a page per family and a page for all families."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any, TypedDict

from ...model import Device, Erratum
from ...say.erratum import errata, erratum
from ...say.markdown import STYLE, anchor, cited, code, link, text
from . import fact_tables
from .page_links import ERRATA, to_erratum

#: File name of the page about all families, which no family can have.
ALL = "all-errata.md"
#: Longest erratum, in characters, that is shown inline with its reason. Errata with wrong data always have it.
_LONG = 500
Rows = list[tuple[str, ...]]


class ErrataPage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_summary: Annotated[str, "number of errata and of open errata"]
    erratum_links: Annotated[list[tuple[str, list[str]]], "status and impact, and links to the errata of that kind"]
    errata_list: Annotated[list[dict[str, Any]], "complete errata: erratum, rows"]


class AllErrataPage(TypedDict):
    standings: Annotated[list[dict[str, Any]], "open errata, then settled ones: title, anchor, rows"]


class OnPage:
    """Errata on one page: in full at the first fact that they affect, and as links after that."""

    def __init__(self, device: Device, folder: str = "") -> None:
        self._device, self._page, self._told = device, f"{folder}{ERRATA}", set[str]()

    def __call__(self, *paths: str) -> str:
        """Return, as a list, the errata about these paths in the spec or about anything inside them."""
        found = errata(self._device, *paths, wording=True)
        elsewhere = [item for item in found if item.edition and not self._device.edition]
        own = [item for item in found if item not in elsewhere]
        lines = [line for item in own if item.severity != "wording" for line in self._lines(item)]
        wording = [item for item in own if item.severity == "wording"]
        if wording:
            links = ", ".join(self._link(item, code(item.name)) for item in wording)
            lines.append(f"- Wording {'mistake' if len(wording) == 1 else 'mistakes'} in the manual: {links}")
        lines += self._of_editions(elsewhere)
        return "\n".join(lines)

    def named(self, *paths: str) -> str:
        """Return the errata about these paths as links for a table cell."""
        found = errata(self._device, *paths, wording=True)
        return ", ".join(f"{badge(item)} {self._link(item, code(item.name))}" for item in found)

    def _link(self, item: Erratum, label: str) -> str:
        return link(label, f"{self._page}#erratum-{item.name}")

    def _lines(self, item: Erratum) -> list[str]:
        if item.name in self._told:
            return [f"- {badge(item)} {link(code(item.name), f'#erratum-{item.name}')}, see above"]
        self._told.add(item.name)
        found = erratum(item, whole=True)
        texts = [STYLE.sentence(part) for part in found.below]
        if item.why and item.severity != "wrong_data" and sum(map(len, texts)) > _LONG:
            texts[-1] = self._link(item, "Why?")
        head = f"{badge(item)} {self._link(item, code(item.name))} {STYLE.cited(item.source)}"
        return [f"- {anchor(f'erratum-{item.name}')}{head}", *(f"  - {text}" for text in texts)]

    def _of_editions(self, found: Sequence[Erratum]) -> Iterator[str]:
        """Yield the differences in other editions, without the reasons, which are on the errata page."""
        again = [item for item in found if item.name in self._told]
        for item in found:
            if item not in again:
                self._told.add(item.name)
                change = erratum(item)
                first, *more = (part for part in change.below if part.label != "Why")
                lead = f"{first.label[0].lower()}{first.label[1:]}"
                texts = [STYLE.sentence(replace(first, label=lead)), *map(STYLE.sentence, more)]
                yield f"- {self._link(item, text(change.label))}, {' '.join(texts)}"
        if again:
            links = (self._link(item, text(erratum(item).label.lower())) for item in again)
            yield f"- Also different {', '.join(dict.fromkeys(links))}, see above"


def badge(item: Erratum) -> str:
    """Return a visible mark for the status."""
    return "⚠ **open**" if item.status == "open" else "✓ settled"


def _of_manual(device: Device) -> list[Erratum]:
    return [item for item in device.errata if not (item.overlay or item.edition)]


def page_values(device: Device) -> ErrataPage:
    of_manual = _of_manual(device)
    is_open = [item for item in of_manual if item.status == "open"]
    return {
        "device": device,
        "errata_summary": f"The manual has {len(of_manual)} known errata. {len(is_open)} of them are open, which means "
        "that only hardware or the manufacturer can settle them. The others are settled by the manual's own evidence "
        "or by arithmetic." + fact_tables.changes(len(device.errata) - len(of_manual)),
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
                    ("Impact", fact_tables.severity(item.severity)),
                    ("Affects", ", ".join(map(code, item.affects))),
                    ("Source", cited(item.source)),
                ],
            }
            for item in device.errata
        ],
    }


def _by_standing(found: Sequence[Erratum]) -> Iterator[tuple[str, list[Erratum]]]:
    """Yield the errata by status and impact, with open ones first and wrong bytes before wording."""
    for status in ("open", "settled"):
        for severity in fact_tables.SEVERITIES:
            alike = [item for item in found if (item.status, item.severity) == (status, severity)]
            if alike:
                yield f"{status}, {fact_tables.severity(severity)}", alike


def all_values(devices: Sequence[Device]) -> AllErrataPage:
    titles = {"open": "Open: only hardware or the manufacturer can decide", "settled": "Settled"}
    parts = [
        {"title": title, "anchor": status, "rows": list(_rows(devices, status))} for status, title in titles.items()
    ]
    return {"standings": [part for part in parts if part["rows"]]}


def _rows(devices: Sequence[Device], status: str) -> Iterator[tuple[str, ...]]:
    """Yield rows of impact, family, name, printed text and value used. Wrong bytes come before wording."""
    for severity in fact_tables.SEVERITIES:
        for device in devices:
            family = link(text(device.name.upper()), f"{device.name}.md")
            for item in _of_manual(device):
                if (item.status, item.severity) == (status, severity):
                    name = to_erratum(device, item.name)
                    yield text(fact_tables.severity(severity)), family, name, text(item.printed), text(item.used)
