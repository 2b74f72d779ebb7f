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
    interface_path = ("interfaces", interface)
    layouts = by_name(raw, *interface_path, "layouts")
    exchanges = list(items(spec, *interface_path, "exchanges"))
    for sender, key in KEYS.items():
        names = [name for name, layout in layouts.items() if layout.get("from") == sender]
        for path, exchange in exchanges:
            name = exchange.get(key, "")
            if name not in ("", *names):
                message = f"there is no layout {quoted(name)} from the {sender}{suggestion(name, names)}"
                report.add("undefined-reference", (*path, key), message)
    requests = [exchange["request"] for _, exchange in exchanges]
    for index, (path, exchange) in enumerate(exchanges):
        if exchange["request"] in requests[:index]:
            report.add(rule, (*path, "request"), f"{quoted(exchange['request'])} already has a reply; keep one")
    if "measurement" not in raw and "measurement" not in mapping(raw, *interface_path):
        for path, exchange in exchanges:
            if exchange["purpose"] == "position":
                message = (
                    f"{quoted(exchange['request'])} asks for the position, but the spec has no 'measurement'; add one"
                )
                report.add(rule, (*path, "purpose"), message)
    return exchanges


def report_unused(
    layout: Spec, path: Path, exchanges: list[tuple[Path, Spec]], rule: str, report: DocumentReport
) -> None:
    """Report a frame that no exchange contains."""
    key = KEYS.get(layout.get("from", ""), "")
    if key and layout["name"] not in [exchange.get(key) for _, exchange in exchanges]:
        message = f"no exchange has {quoted(layout['name'])} as its {key}; add one under 'exchanges'"
        report.add(rule, path, message)
