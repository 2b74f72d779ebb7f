"""Rules for RS-485: requests either have data IDs, or they are listed with their replies."""

from __future__ import annotations

from ...model import Rs485
from ..problems import DocumentReport, quoted
from .exchanges import check_exchanges, report_unused
from .walk import Spec, items, mapping

_HERE = ("interfaces", Rs485.name)
_RULE = "rs485-exchange"
#: Keys that belong to data IDs, in the interface and in its layouts.
_OF_DATA_IDS = ("data_ids", "memory_access")


def requests(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each request over RS-485 has a data ID, or is in an exchange with its reply."""
    interface = mapping(spec, *_HERE)
    if not interface:
        return
    if mapping(interface, "port").get("data_bits", 8) != 8:
        message = "frames over RS-485 consist of bytes, so a character has 8 data bits, and its parity bit is 'parity'"
        report.add(_RULE, (*_HERE, "port", "data_bits"), message)
    if "exchanges" not in interface:
        if "data_ids" not in mapping(raw, *_HERE):
            message = "no request is described; add 'data_ids' (for frames like those of the T-format) or 'exchanges'"
            report.add(_RULE, _HERE, message)
        return
    for key in _OF_DATA_IDS:
        if key in interface:
            message = f"{quoted(key)} belongs to frames like those of the T-format; keep either it or 'exchanges'"
            report.add(_RULE, (*_HERE, key), message, at_key=True)
    _check_exchanges(spec, raw, report)


def _check_exchanges(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that one exchange has the position, and that each frame is in an exchange."""
    exchanges = check_exchanges(spec, raw, Rs485.name, _RULE, report)
    positions = [(path, exchange) for path, exchange in exchanges if exchange["purpose"] == "position"]
    for path, exchange in positions:
        if "reply" not in exchange:
            report.add(_RULE, path, f"{quoted(exchange['request'])} asks for the position, so it needs a 'reply'")
    for path, _ in positions[1:]:
        report.add(_RULE, (*path, "purpose"), "a second request asks for the position; use 'other'")
    for path, layout in items(spec, *_HERE, "layouts"):
        report_unused(layout, path, exchanges, _RULE, report)
        if "when" in layout:
            message = "the request decides which frame is the reply; leave 'when' out"
            report.add(_RULE, (*path, "when"), message, at_key=True)
        if layout.get("carried_as") == "bits":
            message = f"{quoted(layout['name'])} is sent over a serial port, as bytes; use 'carried_as: bytes'"
            report.add(_RULE, (*path, "carried_as"), message)
