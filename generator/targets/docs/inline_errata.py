"""Errata, shown next to the facts that they affect, and in full on a page per family and a page for all families."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Annotated, Any, TypedDict

from ...model import Device, Erratum
from ...say.erratum import errata, erratum
from ...say.markdown import STYLE, anchor, cited, code, link, text
from ...say.name import heading
from ...say.words import sentence
from . import fact_tables
from .page_links import ERRATA, to_erratum

#: File name of the page about all families, which no family can have.
ALL = "all-errata.md"
#: Longest text, in characters, that is shown on other pages than that of the errata.
_LONG = 240
Rows = list[tuple[str, ...]]


class ErrataPage(TypedDict):
    device: Annotated[Device, "the family"]
    errata_summary: Annotated[str, "number of errata and of open errata"]
    erratum_links: Annotated[list[tuple[str, list[str]]], "status and impact, and links to the errata of that kind"]
    errata_list: Annotated[list[dict[str, Any]], "complete errata: erratum, title, rows"]


class AllErrataPage(TypedDict):
    standings: Annotated[list[dict[str, Any]], "open errata, then settled ones: title, anchor, rows"]


class OnPage:
    """Errata on one page: a line at the first fact that an erratum affects, then links to it."""

    def __init__(self, device: Device, folder: str = "") -> None:
        self._device, self._page, self._told = device, f"{folder}{ERRATA}", set[str]()

    def __call__(self, *paths: str, exactly: Collection[str] = ()) -> str:
        """Return, as a list, the errata about these paths in the spec or about anything inside them."""
        manual_errata, edition_errata = _by_origin(self._device, *paths, exactly=exactly)
        lines = [self._line(erratum) for erratum in manual_errata if erratum.severity != "wording"]
        wording = [erratum for erratum in manual_errata if erratum.severity == "wording"]
        if wording:
            links = ", ".join(self._link(erratum, text(heading(erratum.name))) for erratum in wording)
            lines.append(f"- Wording {'mistake' if len(wording) == 1 else 'mistakes'} in the manual: {links}")
        lines += self._of_editions(edition_errata)
        return "\n".join(lines)

    def named(self, *paths: str) -> str:
        """Return the errata about these paths as links for a table cell."""
        affecting_errata = errata(self._device, *paths, wording=True)
        return ", ".join(f"{badge(erratum)} {self._link(erratum, code(erratum.name))}" for erratum in affecting_errata)

    def _link(self, erratum: Erratum, label: str) -> str:
        return link(label, f"{self._page}#erratum-{erratum.name}")

    def _line(self, erratum: Erratum) -> str:
        if erratum.name in self._told:
            return f"- {badge(erratum)} {link(text(heading(erratum.name)), f'#erratum-{erratum.name}')}, see above"
        self._told.add(erratum.name)
        return f"- {anchor(f'erratum-{erratum.name}')}{in_one_line(erratum, self._page)}"

    def _of_editions(self, edition_errata: Sequence[Erratum]) -> Iterator[str]:
        """Yield a line with links to the differences in other editions."""
        links = (self._link(difference, text(_edition(difference))) for difference in edition_errata)
        if edition_errata:
            yield f"- Other editions differ: {', '.join(dict.fromkeys(links))}"


class Badges:
    """Errata on the page of an order code: links at the facts that they affect, and a list of one line each."""

    def __init__(self, device: Device) -> None:
        self._device, self._told, self._editions = device, dict[str, Erratum](), dict[str, Erratum]()

    def __call__(self, *paths: str, exactly: Collection[str] = ()) -> str:
        """Return links to the errata about these paths in the spec or about anything inside them, in one line."""
        manual_errata, edition_errata = _by_origin(self._device, *paths, exactly=exactly)
        self._editions |= {difference.name: difference for difference in edition_errata}
        return self._linked([erratum for erratum in manual_errata if erratum.severity != "wording"])

    def of_bytes(self, *paths: str, exactly: Collection[str] = ()) -> str:
        """Return links to those errata about these paths that change bytes on the wire."""
        manual_errata, _ = _by_origin(self._device, *paths, exactly=exactly)
        return self._linked([erratum for erratum in manual_errata if erratum.severity == "wrong_data"])

    def _linked(self, linked_errata: Sequence[Erratum]) -> str:
        self._told |= {erratum.name: erratum for erratum in linked_errata}
        links = [(erratum, link(text(heading(erratum.name)), f"#erratum-{erratum.name}")) for erratum in linked_errata]
        parts = [
            f"{mark} {status}: {', '.join(status_links)}"
            for status, mark in _MARKS.items()
            if (status_links := [erratum_link for erratum, erratum_link in links if erratum.status == status])
        ]
        return " ".join(parts)

    def summary(self) -> str:
        """Return the number of errata on the page so far, by status."""
        counts = {status: [erratum.status for erratum in self._told.values()].count(status) for status in _MARKS}
        no_errata = "none that change these facts" if self._device.errata else "none known"
        return ", ".join(f"{count} {status}" for status, count in counts.items() if count) or no_errata

    def listed(self) -> str:
        """Return the errata on the page so far, open ones first, and links to the differences in other editions."""
        ordered = sorted(self._told.values(), key=lambda erratum: erratum.status != "open")
        lines = [f"- {anchor(f'erratum-{erratum.name}')}{in_one_line(erratum, ERRATA)}" for erratum in ordered]
        editions: dict[str, list[str]] = {}
        for difference in filter(lambda difference: difference.name in self._editions, self._device.errata):
            editions.setdefault(_edition(difference), []).append(f"{ERRATA}#erratum-{difference.name}")
        differ = [
            ", ".join(
                link(text(label) if not index else f"{index + 1}", target) for index, target in enumerate(targets)
            )
            for label, targets in editions.items()
        ]
        return "\n".join([*lines, *([f"- Other editions differ: {'; '.join(differ)}"] if differ else [])])


#: Marks of the links, by status.
_MARKS = {"open": "⚠", "settled": "✓"}


def _by_origin(device: Device, *paths: str, exactly: Collection[str]) -> tuple[list[Erratum], list[Erratum]]:
    """Return the errata of the manual about these paths, and the differences in other editions."""
    affecting_errata = errata(device, *paths, exactly=exactly, wording=True)
    edition_errata = [erratum for erratum in affecting_errata if erratum.edition and not device.edition]
    return [erratum for erratum in affecting_errata if erratum not in edition_errata], edition_errata


def _edition(difference: Erratum) -> str:
    """Return the edition of a difference as a phrase: ``before edition 1.4``."""
    label = erratum(difference).label
    return f"{label[0].lower()}{label[1:]}"


def _title(titled_erratum: Erratum) -> str:
    """Return the title of an erratum. Differences in another edition are numbered."""
    label = erratum(titled_erratum).label
    return (
        f"{label}, difference {titled_erratum.name.rpartition('_')[2]}"
        if titled_erratum.edition
        else heading(titled_erratum.name)
    )


def in_one_line(listed_erratum: Erratum, page: str) -> str:
    """Return the status and title of an erratum, and the value used. The link leads to the full text.

    A change by an overlay has its reason and source, because the user of a special model needs them.
    """
    head = (
        f"{badge(listed_erratum)} {link(text(heading(listed_erratum.name)), f'{page}#erratum-{listed_erratum.name}')}"
    )
    if listed_erratum.overlay:
        return " ".join(
            [f"{head} {STYLE.cited(listed_erratum.source)}:", *map(STYLE.sentence, erratum(listed_erratum).below)]
        )
    used = sentence(listed_erratum.used)
    if len(used) > _LONG:
        used = f"{used[:_LONG].rpartition('. ' if '. ' in used[:_LONG] else ' ')[0]} …"
    return f"{head}: {text(used)}"


def badge(erratum: Erratum) -> str:
    """Return a visible mark for the status."""
    return "⚠ **open**" if erratum.status == "open" else "✓ settled"


def _of_manual(device: Device) -> list[Erratum]:
    return [erratum for erratum in device.errata if not (erratum.overlay or erratum.edition)]


def page_values(device: Device) -> ErrataPage:
    of_manual = _of_manual(device)
    is_open = [erratum for erratum in of_manual if erratum.status == "open"]
    summary = _summary(len(of_manual), len(is_open))
    return {
        "device": device,
        "errata_summary": summary + fact_tables.sentence_on_changes(len(device.errata) - len(of_manual)),
        "erratum_links": [
            (text(standing), [link(code(erratum.name), f"#erratum-{erratum.name}") for erratum in alike_errata])
            for standing, alike_errata in _by_standing(device.errata)
        ],
        "errata_list": [
            {
                "erratum": erratum,
                "title": text(_title(erratum)),
                "rows": [
                    *fact_tables.printed_and_used(erratum),
                    ("Why", text(erratum.why)),
                    ("Status", badge(erratum)),
                    ("Impact", fact_tables.severity_text(erratum.severity)),
                    ("Affects", ", ".join(map(code, erratum.affects))),
                    ("Source", cited(erratum.source)),
                ],
            }
            for erratum in device.errata
        ],
    }


def _summary(count: int, is_open: int) -> str:
    """Return how many errata there are, and the meaning of their status."""
    if not count:
        return "No errata are known."
    parts = ["There is 1 known erratum." if count == 1 else f"There are {count} known errata."]
    if is_open:
        verb = "is" if is_open == 1 else "are"
        parts.append(f"{is_open} {verb} open, which means that only hardware or the manufacturer can decide.")
    if is_open < count:
        verb = "is" if count - is_open == 1 else "are"
        parts.append(f"{count - is_open} {verb} settled by the manual's own evidence or by arithmetic.")
    return " ".join(parts)


def _by_standing(listed_errata: Sequence[Erratum]) -> Iterator[tuple[str, list[Erratum]]]:
    """Yield the errata by status and impact, with open ones first and wrong bytes before wording."""
    for status in ("open", "settled"):
        for severity in fact_tables.SEVERITIES:
            alike = [erratum for erratum in listed_errata if (erratum.status, erratum.severity) == (status, severity)]
            if alike:
                yield f"{status}, {fact_tables.severity_text(severity)}", alike


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
            for manual_erratum in _of_manual(device):
                if (manual_erratum.status, manual_erratum.severity) == (status, severity):
                    name = to_erratum(device, manual_erratum.name)
                    yield (
                        text(fact_tables.severity_text(severity)),
                        family,
                        name,
                        text(manual_erratum.printed),
                        text(manual_erratum.used),
                    )
