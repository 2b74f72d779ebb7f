"""The end of a page: worked examples, errata, editions, lost figures, documents, the history of the manual."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from ...model import Device, Erratum
from ...say.markdown import cited, code, link, text
from . import editions, facts

Rows = list[tuple[str, ...]]
Section = dict[str, Any]


class Evidence(editions.EditionRows):
    examples: Annotated[list[Section], "the worked examples: example, rows"]
    errata_summary: Annotated[str, "how many errata there are, and how many are open"]
    erratum_links: Annotated[list[tuple[str, list[str]]], "status and stake, and links to the errata of that kind"]
    errata_list: Annotated[list[Section], "the errata in full: erratum, rows"]
    lost_rows: Annotated[Rows, "the figures that were not available"]
    document_rows: Annotated[Rows, "the documents that sources name"]
    history_rows: Annotated[Rows, "the revisions of the manual"]


def evidence(device: Device) -> Evidence:
    of_manual = [item for item in device.errata if not (item.overlay or item.edition)]
    is_open = [item for item in of_manual if item.status == "open"]
    return {
        "examples": [{"example": item, "rows": facts.example_facts(device, item)} for item in device.examples],
        "errata_summary": f"{len(of_manual)} places where the manual cannot be taken literally; "
        f"{len(is_open)} of them are open: only hardware or the maker could decide. The others are settled by the "
        "manual's own evidence or by arithmetic." + facts.changes(len(device.errata) - len(of_manual)),
        "erratum_links": [
            (text(standing), [link(code(item.name), f"#erratum-{item.name}") for item in found])
            for standing, found in _by_standing(device.errata)
        ],
        "errata_list": [
            {
                "erratum": item,
                "rows": [
                    *facts.printed_and_used(item),
                    ("Why", text(item.why)),
                    ("Status", text(item.status)),
                    ("At stake", facts.severity(item.severity)),
                    ("Affects", ", ".join(map(code, item.affects))),
                    ("Source", cited(item.source)),
                ],
            }
            for item in device.errata
        ],
        **editions.rows_and_tests(device),
        "lost_rows": [(text(item.content), cited(item.source)) for item in device.lost_figures],
        "document_rows": facts.document_rows(device.documents),
        "history_rows": [
            (text(item.revision), item.date, text(item.changes), text(item.hardware), text(item.software))
            for item in device.manual.history
        ],
    }


def _by_standing(errata: Sequence[Erratum]) -> Iterator[tuple[str, list[Erratum]]]:
    """The errata by status and by what is at stake, open ones first and wrong bytes before words."""
    for status in ("open", "settled"):
        for severity in facts.SEVERITIES:
            found = [item for item in errata if (item.status, item.severity) == (status, severity)]
            if found:
                yield f"{status}, {facts.severity(severity)}", found
