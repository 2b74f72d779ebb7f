"""Rules for requests with their replies, over SPI and RS-485: every frame is in an exchange, and all names exist."""

from __future__ import annotations

from collections.abc import Mapping

from ..problems import DocumentReport, Path, quoted, suggestion
from .walk import Spec, by_name, items, mapping

#: Senders with the key of their frames in an exchange.
KEYS: Mapping[str, str] = {"master": "request", "encoder": "reply"}


def check_exchanges(
    spec: Spec, raw: Spec, interface: str, rule: str, report: DocumentReport
) -> list[tuple[Path, Spec]]:
    """Check that the frames of exchanges exist, and that each request is in one of them. Return the exchanges.

    A request for the position needs a measurement, because without one no output has a position.
    """
    here = ("interfaces", interface)
    layouts = by_name(raw, *here, "layouts")
    senders = {sender: [n for n, item in layouts.items() if item.get("from") == sender] for sender in KEYS}
    found = list(items(spec, *here, "exchanges"))
    for sender, key in KEYS.items():
        for path, item in found:
            if item.get(key, "") not in ("", *senders[sender]):
                wrong = (
                    f"there is no layout {quoted(item[key])} from the {sender}{suggestion(item[key], senders[sender])}"
                )
                report.add("undefined-reference", (*path, key), wrong)
    requests = [item["request"] for _, item in found]
    for index, (path, item) in enumerate(found):
        if item["request"] in requests[:index]:
            report.add(rule, (*path, "request"), f"{quoted(item['request'])} already has a reply; keep one")
    if "measurement" not in raw and "measurement" not in mapping(raw, *here):
        for path, item in found:
            if item["purpose"] == "position":
                wrong = f"{quoted(item['request'])} asks for the position, but the spec has no 'measurement'; add one"
                report.add(rule, (*path, "purpose"), wrong)
    return found


def report_unused(layout: Spec, path: Path, found: list[tuple[Path, Spec]], rule: str, report: DocumentReport) -> None:
    """Report a frame that no exchange contains."""
    key = KEYS.get(layout.get("from", ""), "")
    if key and layout["name"] not in [item.get(key) for _, item in found]:
        wrong = f"no exchange has {quoted(layout['name'])} as its {key}; add one under 'exchanges'"
        report.add(rule, path, wrong)
